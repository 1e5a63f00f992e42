/* test_guarded.c - whatever the library is given, and its model, ends or begins at a page that may not be
   touched: a loop one too far, or one too early, ends the test. */
#define _DEFAULT_SOURCE
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "rbd_derivatives.h"

#include "suites.h"
#include "support.h"

/* ---- memory with a fence ---- */

typedef enum fence { FENCE_BEHIND, FENCE_BEFORE, FENCES } fence;

typedef struct pen {
    void *pages;
    size_t size;
} pen;

static pen pens[250];
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

static void call_dynamics(const robot *r, const robot *f, const state *s, int number) {
    const int nq = r->nq, nv = r->nv, nh = rbd_packed_size(r->m);
    const double *q = inputs(s->q, nq), *v = inputs(s->v, nv), *a = inputs(s->a, nv),
                 *tau = inputs(s->tau, nv);
    const double *f_ext = inputs(s->f_ext, 6 * r->nb);
    double *x = numbers(nv), *M = numbers(nv * nv), *H = numbers(nh);
    BOTH(rbd_rnea(f->m, f->w, q, v, a, f_ext, x), rbd_rnea(r->m, r->w, q, v, a, f_ext, plain), x, nv);
    BOTH(rbd_bias(f->m, f->w, q, v, f_ext, x), rbd_bias(r->m, r->w, q, v, f_ext, plain), x, nv);
    BOTH(rbd_gravity_torque(f->m, f->w, q, x), rbd_gravity_torque(r->m, r->w, q, plain), x, nv);
    BOTH(rbd_generalized_momentum(f->m, f->w, q, v, NULL, x),
         rbd_generalized_momentum(r->m, r->w, q, v, NULL, plain), x, nv);
    BOTH(rbd_generalized_momentum(f->m, f->w, q, v, x, NULL),
         rbd_generalized_momentum(r->m, r->w, q, v, plain, NULL), x, nv);
    BOTH(rbd_crba(f->m, f->w, q, M), rbd_crba(r->m, r->w, q, plain), M, nv * nv);
    BOTH(rbd_crba_packed(f->m, f->w, q, H), rbd_crba_packed(r->m, r->w, q, plain), H, nh);
    BOTH(rbd_aba(f->m, f->w, q, v, tau, f_ext, x), rbd_aba(r->m, r->w, q, v, tau, f_ext, plain), x, nv);
    BOTH(rbd_fd_cholesky(f->m, f->w, q, v, tau, f_ext, x),
         rbd_fd_cholesky(r->m, r->w, q, v, tau, f_ext, plain), x, nv);
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
    BOTH(rbd_passive(f->m, f->w, v, x), rbd_passive(r->m, r->w, v, plain), x, nv);
    BOTH(rbd_cholesky_factor_packed(f->m, f->w, H), rbd_cholesky_factor(r->m, r->w, M, plain), H, nh);
    BOTH(rbd_cholesky_factor(f->m, f->w, M, H), rbd_cholesky_factor(r->m, r->w, M, plain), H, nh);
    BOTH(rbd_cholesky_solve(f->m, f->w, H, tau, x), rbd_cholesky_solve(r->m, r->w, H, tau, plain), x, nv);
    BOTH(rbd_cholesky_solve_many(f->m, f->w, H, nv, M, M),
         rbd_cholesky_solve_many(r->m, r->w, H, nv, M, plain), M, nv * nv);
    BOTH(rbd_minverse(f->m, f->w, q, M), rbd_minverse(r->m, r->w, q, plain), M, nv * nv);
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++)
            ck_assert_int_eq(rbd_packed_index(f->m, i, j), rbd_packed_index(r->m, i, j));
}

static void call_kinematics(const robot *r, const robot *f, const state *s, int number) {
    const double *q = inputs(s->q, r->nq), *v = inputs(s->v, r->nv), *a = inputs(s->a, r->nv);
    double *R = numbers(9), *p = numbers(3), *x = numbers(6), *com = numbers(3);
    const double *f_ext = inputs(s->f_ext, 6 * r->nb);
    double *wrench = numbers(6 * r->nb);
    BOTH(rbd_joint_wrench(f->m, f->w, q, v, a, f_ext, wrench),
         rbd_joint_wrench(r->m, r->w, q, v, a, f_ext, plain), wrench, 6 * r->nb);
    RUN(rbd_kinematics(f->m, f->w, q, v, a));
    RUN(rbd_kinematics(r->m, r->w, q, v, a));
    for (int b = 0; b < r->nb; b++) {
        BOTH(rbd_body_pose(f->m, f->w, b, R, p), rbd_body_pose(r->m, r->w, b, plain, NULL), R, 9);
        BOTH(rbd_body_pose(f->m, f->w, b, R, p), rbd_body_pose(r->m, r->w, b, NULL, plain), p, 3);
        BOTH(rbd_body_velocity(f->m, f->w, b, x), rbd_body_velocity(r->m, r->w, b, plain), x, 6);
        BOTH(rbd_body_acceleration(f->m, f->w, b, x), rbd_body_acceleration(r->m, r->w, b, plain), x, 6);
        BOTH(rbd_body_acceleration_classical(f->m, f->w, b, x),
             rbd_body_acceleration_classical(r->m, r->w, b, plain), x, 6);
    }
    BOTH(rbd_energy(f->m, f->w, x, x + 1), rbd_energy(r->m, r->w, plain, plain + 1), x, 2);
    BOTH(rbd_com(f->m, f->w, com, NULL, NULL), rbd_com(r->m, r->w, plain, NULL, NULL), com, 3);
    BOTH(rbd_com(f->m, f->w, NULL, com, NULL), rbd_com(r->m, r->w, NULL, plain, NULL), com, 3);
    BOTH(rbd_com(f->m, f->w, NULL, NULL, com), rbd_com(r->m, r->w, NULL, NULL, plain), com, 3);
    ck_assert_double_eq(rbd_mass(f->m), rbd_mass(r->m));
}

static void call_points(const robot *r, const robot *f, const state *s, int number) {
    const double *q = inputs(s->q, r->nq), *v = inputs(s->v, r->nv), *a = inputs(s->a, r->nv);
    const double *point = inputs(s->v, 3), *wrench = inputs(s->f_ext, 6);
    double *J = numbers(6 * r->nv), *x = numbers(6), *tau = numbers(r->nv);
    RUN(rbd_kinematics(f->m, f->w, q, v, a));
    RUN(rbd_kinematics(r->m, r->w, q, v, a));
    for (int b = 0; b < r->nb; b++) {
        const rbd_axes axes = b % 2 ? RBD_LINK_AXES : RBD_WORLD_AXES;
        const int other = (b + r->nb / 2) % r->nb;
        BOTH(rbd_jacobian(f->m, f->w, b, point, axes, J), rbd_jacobian(r->m, r->w, b, point, axes, plain), J,
             6 * r->nv);
        BOTH(rbd_relative_jacobian(f->m, f->w, b, point, other, axes, J),
             rbd_relative_jacobian(r->m, r->w, b, point, other, axes, plain), J, 6 * r->nv);
        BOTH(rbd_jacobian_transpose(f->m, f->w, b, point, axes, wrench, tau),
             rbd_jacobian_transpose(r->m, r->w, b, point, axes, wrench, plain), tau, r->nv);
        BOTH(rbd_point_position(f->m, f->w, b, point, x), rbd_point_position(r->m, r->w, b, point, plain), x,
             3);
        BOTH(rbd_point_velocity(f->m, f->w, b, point, axes, x),
             rbd_point_velocity(r->m, r->w, b, point, axes, plain), x, 6);
        BOTH(rbd_point_acceleration(f->m, f->w, b, point, axes, x),
             rbd_point_acceleration(r->m, r->w, b, point, axes, plain), x, 6);
        BOTH(rbd_point_wrench(f->m, f->w, b, point, axes, wrench, x),
             rbd_point_wrench(r->m, r->w, b, point, axes, wrench, plain), x, 6);
    }
    BOTH(rbd_momentum(f->m, f->w, x, NULL), rbd_momentum(r->m, r->w, plain, NULL), x, 6);
    BOTH(rbd_momentum(f->m, f->w, NULL, x), rbd_momentum(r->m, r->w, NULL, plain), x, 6);
}

static void call_manifold(const robot *r, const robot *f, const state *s, int number) {
    const double *q = inputs(s->q, r->nq), *v = inputs(s->v, r->nv);
    double *next = numbers(r->nq), *d = numbers(r->nv), *between = numbers(r->nq), squares[MAX_V];
    uint64_t seed = 5, again = 5;
    BOTH(rbd_neutral(f->m, next), rbd_neutral(r->m, plain), next, r->nq);
    BOTH(rbd_random(f->m, &seed, next), rbd_random(r->m, &again, plain), next, r->nq);
    BOTH(rbd_integrate(f->m, q, v, 0.1, next), rbd_integrate(r->m, q, v, 0.1, plain), next, r->nq);
    BOTH(rbd_difference(f->m, q, next, d), rbd_difference(r->m, q, next, plain), d, r->nv);
    for (int k = 0; k < r->nv; k++) squares[k] = s->v[k] * s->v[k];
    const double *weight = inputs(squares, r->nv);
    BOTH(rbd_distance(f->m, q, next, weight, d), rbd_distance(r->m, q, next, weight, plain), d, 1);
    BOTH(rbd_interpolate(f->m, next, q, 0.25, between), rbd_interpolate(r->m, next, q, 0.25, plain), between,
         r->nq);
    BOTH(rbd_rates_from_velocity(f->m, q, v, next), rbd_rates_from_velocity(r->m, q, v, plain), next, r->nq);
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

static void call_derivatives(const robot *r, const robot *f, const state *s, int number) {
    const int nv = r->nv;
    const size_t size = rbd_derivatives_size(r->m);
    const double *q = inputs(s->q, r->nq), *v = inputs(s->v, nv), *a = inputs(s->a, nv);
    const double *f_ext = inputs(s->f_ext, 6 * r->nb);
    double *x = numbers(nv * nv), *y = numbers(nv * nv), *M = numbers(nv * nv), *A = numbers(6 * nv),
           *J = numbers(3 * nv), *h = numbers(6), other[MAX_V * MAX_V];
    void *memory = malloc(size);
    rbd_derivatives *d, *e;
    RUN(rbd_derivatives_init(f->m, f->w, fenced(size), size, &d));
    RUN(rbd_derivatives_init(r->m, r->w, memory, size, &e));
    BOTH(rbd_id_derivatives(f->m, d, q, v, a, f_ext, x, y, M),
         rbd_id_derivatives(r->m, e, q, v, a, f_ext, plain, other, NULL), x, nv * nv);
    BOTH(rbd_id_derivatives(f->m, d, q, v, a, f_ext, x, y, M),
         rbd_id_derivatives(r->m, e, q, v, a, f_ext, other, plain, NULL), y, nv * nv);
    BOTH(rbd_gravity_torque_derivatives(f->m, d, q, x), rbd_gravity_torque_derivatives(r->m, e, q, plain), x,
         nv * nv);
    BOTH(rbd_fd_derivatives(f->m, d, q, v, v, f_ext, numbers(nv), x, y, M),
         rbd_fd_derivatives(r->m, e, q, v, v, f_ext, NULL, plain, NULL, NULL), x, nv * nv);
    BOTH(rbd_coriolis(f->m, d, q, v, x), rbd_coriolis(r->m, e, q, v, plain), x, nv * nv);
    BOTH(rbd_momentum_matrix(f->m, d, q, v, A, h), rbd_momentum_matrix(r->m, e, q, v, plain, other), A,
         6 * nv);
    BOTH(rbd_momentum_matrix(f->m, d, q, v, A, h), rbd_momentum_matrix(r->m, e, q, v, other, plain), h, 6);
    BOTH(rbd_com_jacobian(f->m, d, q, J), rbd_com_jacobian(r->m, e, q, plain), J, 3 * nv);
    RUN(rbd_kinematics(f->m, f->w, q, v, NULL));
    RUN(rbd_kinematics(r->m, r->w, q, v, NULL));
    for (int b = 0; b < r->nb; b++) {
        const rbd_axes axes = b % 2 ? RBD_LINK_AXES : RBD_WORLD_AXES;
        const int from = (b + r->nb / 2) % r->nb;
        BOTH(rbd_jacobian_derivative(f->m, f->w, b, f_ext, axes, A),
             rbd_jacobian_derivative(r->m, r->w, b, f_ext, axes, plain), A, 6 * nv);
        BOTH(rbd_relative_jacobian_derivative(f->m, f->w, b, f_ext, from, axes, A),
             rbd_relative_jacobian_derivative(r->m, r->w, b, f_ext, from, axes, plain), A, 6 * nv);
    }
    const double *next = inputs(s->q, r->nq);
    BOTH(rbd_integrate_derivatives(f->m, v, 0.1, x, y), rbd_integrate_derivatives(r->m, v, 0.1, plain, other),
         x, nv * nv);
    BOTH(rbd_difference_derivatives(f->m, q, next, x, y),
         rbd_difference_derivatives(r->m, q, next, other, plain), y, nv * nv);
    double *Y = numbers(nv * 10 * r->nb), *kinetic = numbers(10 * r->nb), *potential = numbers(10 * r->nb);
    static double same[MAX_V * 10 * MAX_BODIES];
    RUN(rbd_regressor(f->m, d, q, v, a, Y));
    RUN(rbd_regressor(r->m, e, q, v, a, same));
    expect_same("rbd_regressor", r, number, Y, same, nv * 10 * r->nb);
    BOTH(rbd_energy_regressors(f->m, d, q, v, kinetic, potential),
         rbd_energy_regressors(r->m, e, q, v, plain, NULL), kinetic, 10 * r->nb);
    BOTH(rbd_energy_regressors(f->m, d, q, v, kinetic, potential),
         rbd_energy_regressors(r->m, e, q, v, NULL, plain), potential, 10 * r->nb);
    free(memory);
}

static void check_fenced(const robot *r, const state *s, int number) {
    for (side = FENCE_BEHIND; side < FENCES; side++) {
        const robot f = fenced_robot(r);
        ck_assert_int_eq(rbd_set_gravity(f.w, inputs(s->gravity, 3)), RBD_OK);
        call_dynamics(r, &f, s, number);
        call_kinematics(r, &f, s, number);
        call_points(r, &f, s, number);
        call_manifold(r, &f, s, number);
        call_lookup(r, &f);
        call_derivatives(r, &f, s, number);
        free_all();
    }
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
