/* test_guarded.c - whatever the library is given, and its model, ends or begins at a page that may not be
   touched: a loop one too far, or one too early, ends the test. */
#define _DEFAULT_SOURCE
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "rbd_derivatives.h"

#include "plain_calls.h"
#include "suites.h"
#include "support.h"

/* ---- memory with a fence ---- */

typedef enum fence { FENCE_BEHIND, FENCE_BEFORE, FENCES } fence;

typedef struct pen {
    void *pages;
    size_t size;
} pen;

static pen pens[1200];
static int pen_count;
static fence side;

/* size bytes, on the side of the fence */
static void *fenced(size_t size) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), used = (size + page - 1) / page * page;
    ck_assert_int_lt(pen_count, LENGTH(pens));
    unsigned char *p = mmap(NULL, used + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ck_assert(p != MAP_FAILED);
    memset(p, 0xff, used + page); /* what is not written is NaN */
    ck_assert_int_eq(mprotect(side == FENCE_BEHIND ? p + used : p, page, PROT_NONE), 0);
    pens[pen_count].pages = p;
    pens[pen_count++].size = used + page;
    return side == FENCE_BEHIND ? p + used - size : p + page;
}

static void *fenced_copy(const void *data, int count, size_t size) {
    void *copy = fenced((size_t)count * size);
    if (count > 0) memcpy(copy, data, (size_t)count * size);
    return copy;
}

static void free_all(void) {
    while (pen_count > 0) {
        --pen_count;
        munmap(pens[pen_count].pages, pens[pen_count].size);
    }
}

static double *numbers(int n) { return fenced((size_t)n * sizeof(double)); }
static const double *inputs(const double *x, int n) { return fenced_copy(x, n, sizeof(double)); }

/* A model whose tables have a fence each, and a work with one. */
static robot fenced_robot(const robot *r) {
    const rbd_body *bodies = fenced_copy(r->bodies, r->nb, sizeof *bodies);
    const size_t size = rbd_model_size(bodies, r->nb);
    const rbd_model *built;
    robot out = *r;
    ck_assert_int_eq(rbd_model_build(bodies, r->nb, fenced(size), size, &built, NULL), RBD_OK);
    rbd_model *m = fenced_copy(built, 1, sizeof *built);
    m->link = fenced_copy(built->link, built->nl, sizeof *built->link);
    m->block = fenced_copy(built->block, built->nblock, sizeof *built->block);
    m->dof = fenced_copy(built->dof, built->nv + built->nmimic, sizeof *built->dof);
    m->mimic = fenced_copy(built->mimic, built->nmimic, sizeof *built->mimic);
    m->frame = fenced_copy(built->frame, built->nb, sizeof *built->frame);
    out.m = m;
    ck_assert_int_eq(rbd_work_init(m, fenced(rbd_work_size(m)), rbd_work_size(m), &out.w), RBD_OK);
    return out;
}

/* ---- every call ---- */

static void expect_same(const char *what, const robot *r, int number, const double *found,
                        const double *expected, int n) {
    expect_close(what, r, number, found, expected, n, 1e-12);
}

/* Runs a call with the fenced robot and with the other: the results are the same. */
#define BOTH(call_fenced, call_plain, found, n) \
    do { \
        double expected[MAX_V * MAX_V]; \
        double *plain = expected; \
        const rbd_status status = call_plain; \
        ck_assert_int_eq(call_fenced, status); \
        if (status == RBD_OK) expect_same(#call_fenced, r, number, found, plain, n); \
    } while (0)

/* ---- the plain calls: of one robot, and of the other ---- */

enum { MOST_COPIES = 64, MOST_RESULTS = 4 * MAX_V * MAX_V + 10 * MAX_BODIES * MAX_V };

/* One side of a comparison. Its inputs are fenced copies, or the numbers themselves. */
typedef struct guarded {
    const robot *r;
    const state *s;
    rbd_derivatives *d;
    int fenced, copies, results;
    double q1[MAX_Q], weights[MAX_V], at_point[2][6];
    const double *of[MOST_COPIES], *copy[MOST_COPIES];
    int length[MOST_COPIES];
    double *out[4], plain[MOST_RESULTS];
    int at[4], n[4];
} guarded;

/* n numbers of x: on the fenced side one copy for all calls */
static const double *give(guarded *g, const double *x, int n) {
    if (!g->fenced) return x;

    for (int i = 0; i < g->copies; i++)
        if (g->of[i] == x && g->length[i] == n) return g->copy[i];
    ck_assert_int_lt(g->copies, MOST_COPIES);
    g->of[g->copies] = x;
    g->length[g->copies] = n;
    return g->copy[g->copies++] = inputs(x, n);
}

/* The k-th input of n numbers: v, a, tau, v; wrenches; or a point and the wrench at it, for which v may be
   too short. */
static const double *input(guarded *g, int k, int n) {
    const double *x[4] = {g->s->v, g->s->a, g->s->tau, g->s->v};
    if (n == 6 * g->r->nb) return give(g, g->s->f_ext, n);
    if (n == g->r->nv) return give(g, x[k], n);

    ck_assert(k < 2 && n <= 6);
    return give(g, g->at_point[k], n);
}

static double *results(guarded *g, int at, int n) {
    if (!g->fenced) return g->plain + at;

    const int i = g->results++;
    g->at[i] = at;
    g->n[i] = n;
    return g->out[i] = numbers(n);
}

static void expect_both(const char *what, guarded *f, guarded *g, int number, rbd_status found,
                        rbd_status expected) {
    ck_assert_msg(found == expected, "%s: %d, not %d", what, found, expected);
    for (int i = 0; i < f->results && found == RBD_OK; i++)
        expect_same(what, g->r, number, f->out[i], g->plain + f->at[i], f->n[i]);
}

#define MODEL x->r->m
#define WORK x->r->w
#define DERIVATIVES x->d
#define BODY b
#define OTHER_BODY (b + x->r->nb / 2) % x->r->nb
#define AXES (b % 2 ? RBD_LINK_AXES : RBD_WORLD_AXES)
#define NUMBER 0.1
#define NQ x->r->nq
#define NV x->r->nv
#define NB x->r->nb
#define NH rbd_packed_size(x->r->m)
#define Q(k) give(x, k ? x->q1 : x->s->q, x->r->nq)
#define IN(k, n) input(x, k, n)
#define WEIGHTS(n) give(x, x->weights, n)
#define OUT(at, n) results(x, at, n)
#define GUARD(header, name, may_fail, arguments, total) \
    { \
        rbd_status status[2]; \
        for (int side_ = 0; side_ < 2; side_++) { \
            guarded *x = side_ ? g : f; \
            x->results = 0; \
            ck_assert_int_eq(rbd_kinematics(MODEL, WORK, Q(0), IN(0, NV), IN(1, NV)), RBD_OK); \
            status[side_] = name arguments; \
        } \
        ck_assert(may_fail || status[0] == RBD_OK); \
        expect_both(#name, f, g, number, status[0], status[1]); \
    }

static void call_plain(guarded *f, guarded *g, int number) {
    PLAIN_CALLS(GUARD)
    for (int b = 0; b < g->r->nb; b++) {
        BODY_CALLS(GUARD)
    }
}

/* ---- the other calls, and outputs that are left out ---- */

static void call_dynamics(const robot *r, const robot *f, const state *s, int number) {
    const int nq = r->nq, nv = r->nv, nh = rbd_packed_size(r->m);
    const double *q = inputs(s->q, nq), *v = inputs(s->v, nv), *tau = inputs(s->tau, nv);
    const double *f_ext = inputs(s->f_ext, 6 * r->nb);
    double *x = numbers(nv), *M = numbers(nv * nv), *H = numbers(nh);
    BOTH(rbd_generalized_momentum(f->m, f->w, q, v, NULL, x),
         rbd_generalized_momentum(r->m, r->w, q, v, NULL, plain), x, nv);
    BOTH(rbd_generalized_momentum(f->m, f->w, q, v, x, NULL),
         rbd_generalized_momentum(r->m, r->w, q, v, plain, NULL), x, nv);
    for (int way = 0; way < 2; way++) { /* a base alone free; every second dof */
        unsigned char *given = fenced((size_t)nv);
        double *fa = numbers(nv), *ft = numbers(nv), pa[MAX_V];
        for (int k = 0; k < nv; k++)
            given[k] = way ? k % 2 == 0 : r->bodies[rbd_dof_body(r->m, k)].parent >= 0;
        memcpy(fa, s->a, (size_t)nv * sizeof *fa);
        memcpy(pa, s->a, (size_t)nv * sizeof *pa);
        memcpy(ft, s->tau, (size_t)nv * sizeof *ft);
        BOTH(
            rbd_hybrid(f->m, f->w, q, v, given, fa, ft, f_ext),
            rbd_hybrid(r->m, r->w, q, v, given, pa, memcpy(plain, s->tau, (size_t)nv * sizeof *plain), f_ext),
            ft, nv);
        expect_same("hybrid, a", r, number, fa, pa, nv);
    }
    RUN(rbd_crba(f->m, f->w, q, M));
    RUN(rbd_crba_packed(f->m, f->w, q, H));
    BOTH(rbd_cholesky_factor_packed(f->m, f->w, H), rbd_cholesky_factor(r->m, r->w, M, plain), H, nh);
    BOTH(rbd_cholesky_factor(f->m, f->w, M, H), rbd_cholesky_factor(r->m, r->w, M, plain), H, nh);
    BOTH(rbd_cholesky_solve(f->m, f->w, H, tau, x), rbd_cholesky_solve(r->m, r->w, H, tau, plain), x, nv);
    BOTH(rbd_cholesky_solve_many(f->m, f->w, H, nv, M, M),
         rbd_cholesky_solve_many(r->m, r->w, H, nv, M, plain), M, nv * nv);
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++)
            ck_assert_int_eq(rbd_packed_index(f->m, i, j), rbd_packed_index(r->m, i, j));
}

static void call_kinematics(const robot *r, const robot *f, const state *s, int number) {
    const double *q = inputs(s->q, r->nq), *v = inputs(s->v, r->nv), *a = inputs(s->a, r->nv);
    double *R = numbers(9), *p = numbers(3), *x = numbers(6), *com = numbers(3);
    RUN(rbd_kinematics(f->m, f->w, q, v, a));
    RUN(rbd_kinematics(r->m, r->w, q, v, a));
    for (int b = 0; b < r->nb; b++) {
        BOTH(rbd_body_pose(f->m, f->w, b, R, NULL), rbd_body_pose(r->m, r->w, b, plain, NULL), R, 9);
        BOTH(rbd_body_pose(f->m, f->w, b, NULL, p), rbd_body_pose(r->m, r->w, b, NULL, plain), p, 3);
    }
    BOTH(rbd_com(f->m, f->w, com, NULL, NULL), rbd_com(r->m, r->w, plain, NULL, NULL), com, 3);
    BOTH(rbd_com(f->m, f->w, NULL, com, NULL), rbd_com(r->m, r->w, NULL, plain, NULL), com, 3);
    BOTH(rbd_com(f->m, f->w, NULL, NULL, com), rbd_com(r->m, r->w, NULL, NULL, plain), com, 3);
    BOTH(rbd_momentum(f->m, f->w, x, NULL), rbd_momentum(r->m, r->w, plain, NULL), x, 6);
    BOTH(rbd_momentum(f->m, f->w, NULL, x), rbd_momentum(r->m, r->w, NULL, plain), x, 6);
    ck_assert_double_eq(rbd_mass(f->m), rbd_mass(r->m));
}

static void call_manifold(const robot *r, const robot *f, const state *s, int number) {
    const double *q = inputs(s->q, r->nq), *v = inputs(s->v, r->nv);
    double *next = numbers(r->nq), *d = numbers(r->nv);
    uint64_t seed = 5, again = 5;
    BOTH(rbd_random(f->m, &seed, next), rbd_random(r->m, &again, plain), next, r->nq);
    RUN(rbd_rates_from_velocity(f->m, q, v, next));
    BOTH(rbd_velocity_from_rates(f->m, q, next, d), rbd_velocity_from_rates(r->m, q, next, plain), d, r->nv);
}

static void call_lookup(const robot *r, const robot *f) {
    ck_assert_int_eq(rbd_body_index(f->m, "nobody"), -1);
    ck_assert_int_eq(rbd_joint_index(f->m, "nothing"), -1);
    for (int b = 0; b < r->nb; b++) {
        rbd_joint_info info;
        rbd_body row;
        ck_assert_int_eq(rbd_describe(f->m, b, &row), RBD_OK);
        ck_assert_int_eq(rbd_joint(f->m, b, &info), RBD_OK);
        ck_assert_ptr_eq(rbd_body_name(f->m, b), rbd_body_name(r->m, b));
        ck_assert_ptr_eq(rbd_joint_name(f->m, b), rbd_joint_name(r->m, b));
    }
    for (int k = 0; k < r->nv; k++) ck_assert_int_eq(rbd_dof_body(f->m, k), rbd_dof_body(r->m, k));
}

static void check_fenced(const robot *r, const state *s, int number) {
    const size_t size = rbd_derivatives_size(r->m);
    void *memory = malloc(size);
    static guarded sides[2]; /* the fenced one, and the other */
    for (side = FENCE_BEHIND; side < FENCES; side++) {
        const robot f = fenced_robot(r);
        memset(sides, 0, sizeof sides);
        for (int i = 0; i < 2; i++) {
            guarded *x = &sides[i];
            x->fenced = i == 0;
            x->r = x->fenced ? &f : r;
            x->s = s;
            RUN(rbd_derivatives_init(x->r->m, x->r->w, x->fenced ? fenced(size) : memory, size, &x->d));
            RUN(rbd_integrate(r->m, s->q, s->v, 0.1, x->q1));
            for (int k = 0; k < r->nv; k++) x->weights[k] = s->v[k] * s->v[k];
            for (int k = 0; k < 6; k++) {
                x->at_point[0][k] = 0.3 - 0.1 * k;
                x->at_point[1][k] = 0.2 + 0.1 * k;
            }
        }
        ck_assert_int_eq(rbd_set_gravity(f.w, inputs(s->gravity, 3)), RBD_OK);
        call_plain(&sides[0], &sides[1], number);
        call_dynamics(r, &f, s, number);
        call_kinematics(r, &f, s, number);
        call_manifold(r, &f, s, number);
        call_lookup(r, &f);
        free_all();
    }
    free(memory);
}

START_TEST(no_call_reaches_beyond_what_it_is_given) {
    for_random_states(1, check_fenced);
    for_random_trees(40, check_fenced);
}
END_TEST

/* Every joint with rotors alone, so that its last coordinate and degree of freedom are the last of all. */
START_TEST(no_joint_with_armature_reaches_beyond_its_own) {
    for (int type = RBD_REVOLUTE; type < RBD_JOINT_TYPES; type++) {
        uint64_t seed = 91;
        rbd_body b[1];
        state s;
        random_joint(&seed, b, 0, (rbd_joint_type)type);
        random_mass(&seed, &b[0]);
        for (int k = 0; k < 6; k++) b[0].armature[k] = 0.1 + 0.1 * k;
        robot r = BUILD(b);
        draw_state(&r, &seed, &s);
        check_fenced(&r, &s, type);
        robot_free(&r);
    }
}
END_TEST

/* A refused description is not read beyond its end either: by the checks, and in names without the expected
   end. */
START_TEST(no_refusal_reaches_beyond_the_description) {
    for (side = FENCE_BEHIND; side < FENCES; side++)
        for (int i = 0; i < reference_count; i++) {
            const ref_model *model = reference_model(i);
            rbd_body *b = fenced_copy(model->bodies, model->nb, sizeof *b);
            const size_t size = rbd_model_size(b, model->nb);
            void *memory = fenced(size);
            const rbd_model *m;
            const int last = model->nb - 1;
            b[last].mimic = "nobody";
            b[last].type = RBD_REVOLUTE;
            b[last].axis[2] = 1;
            ck_assert_int_eq(rbd_model_build(b, model->nb, memory, size, &m, NULL), RBD_ERR_MIMIC);
            b[last].mimic = NULL;
            b[last].mass = 0;
            memset(b[last].inertia, 0, sizeof b[last].inertia);
            memset(b[last].armature, 0, sizeof b[last].armature);
            ck_assert_int_eq(rbd_model_build(b, model->nb, memory, size, &m, NULL), RBD_ERR_LEAF);
            free_all();
        }
}
END_TEST

Suite *guarded_suite(void) {
    Suite *suite = suite_create("guarded");
    TCase *c = tcase_create("guarded");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, no_call_reaches_beyond_what_it_is_given);
    tcase_add_test(c, no_joint_with_armature_reaches_beyond_its_own);
    tcase_add_test(c, no_refusal_reaches_beyond_the_description);
    suite_add_tcase(suite, c);
    return suite;
}
