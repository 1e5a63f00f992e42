/* test_batch.c - rbd_batch.h: the calls of batch.c against
   the single calls of rbd.c and the reference. Built for several BATCH_LANES, with double and with
   -DRBD_REAL=float; each is a program of its own. `batch_PROGRAM --errors` also prints the largest difference
   between both. */
#include "larger.h"
#include "quiet_check.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rbd_derivatives.h"

#include "rbd_constraints.h"
#include "rbd_batch.h"

#include "reference.h"

enum { IS_FLOAT = sizeof(RBD_REAL) == sizeof(float) };

/* Half the distance from 1 to the next number. */
#define ROUNDING (0.5 * (IS_FLOAT ? (double)FLT_EPSILON : DBL_EPSILON))
/* Batch against single calls, relative to the largest entry of a state's result. Where the compiler contracts
   to FMA, it does so in other places with lanes: a few roundings, some more with the common frame's sums,
   which forward dynamics multiply by the condition number of M, up to some thousands, and what is derived
   from their result once more. */
#define FEW_ROUNDINGS (40 * ROUNDING)
#define MORE_ROUNDINGS (100 * ROUNDING)
#define BOUND(call) \
    ((call) < MOMENTUM_MATRIX  ? FEW_ROUNDINGS \
     : (call) < ABA            ? MORE_ROUNDINGS \
     : (call) < CONSTRAINED_FD ? 1e4 * ROUNDING \
                               : 3e5 * ROUNDING)
/* Against the reference, as in scalars.c. */
#define DIRECT fmax(100 * ROUNDING, 1e-14)
#define INVERSE(condition) (DIRECT + 100 * ROUNDING * (condition))
#define CANCELLED (1e-12 + 1000 * DIRECT)

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))
#define BOX .mass = 1, .com = {0.1, -0.2, 0.15}, .inertia = {0.2, 0.01, -0.02, 0.25, 0.03, 0.3}
#define HALF_PI 1.57079632679489661923

enum { FEW = 2 * BATCH_LANES + 1, MANY = 131 }; /* states */

static const RBD_REAL canary = (RBD_REAL)1234.5;

/* ---- a robot with the memory of both kinds of calls, and states ---- */

typedef struct robot {
    const char *name;
    int nb, nq, nv;
    const rbd_model *m;
    rbd_work *w;
    rbd_batch *b;
    rbd_derivatives *single;
    rbd_batch_derivatives *d;
    rbd_constraint_set *held; /* the hand at an x, or nothing where it cannot move */
    rbd_batch_constraint_set *k;
    void *memory[7];
} robot;

/* Full of NaN, so that what was never written shows. */
static void *allocate(size_t size) {
    void *memory = malloc(size ? size : 1);
    ck_assert_ptr_nonnull(memory);
    return memset(memory, 0xff, size);
}

static RBD_REAL *numbers(int rows, int width) {
    return (RBD_REAL *)allocate((size_t)rows * (size_t)width * sizeof(RBD_REAL));
}

/* The constraint of a robot. */
static rbd_constraint holding(const robot *r) {
    const double at[3] = {0.1, -0.2, 0.3}, place[3] = {0.5, 0, 0};
    rbd_constraint k = rbd_point_contact(r->nb - 1, at, place);
    k.axes[4] = k.axes[5] = 0;
    k.kp = 10, k.kd = 3;
    return k;
}

static int rows_held(const robot *r) { return rbd_constraint_rows(r->held); }

static robot build(const char *name, const rbd_body *bodies, int nb) {
    robot r = {.name = name, .nb = nb};
    size_t size = rbd_model_size(bodies, nb);
    r.memory[0] = allocate(size);
    ck_assert_int_eq(rbd_model_build(bodies, nb, r.memory[0], size, &r.m, NULL), RBD_OK);
    r.nq = rbd_nq(r.m);
    r.nv = rbd_nv(r.m);
    size = rbd_work_size(r.m);
    r.memory[1] = allocate(size);
    ck_assert_int_eq(rbd_work_init(r.m, r.memory[1], size, &r.w), RBD_OK);
    size = rbd_batch_size(r.m);
    r.memory[2] = allocate(size);
    ck_assert_int_eq(rbd_batch_init(r.m, r.memory[2], size, &r.b), RBD_OK);
    size = rbd_derivatives_size(r.m);
    r.memory[3] = allocate(size);
    ck_assert_int_eq(rbd_derivatives_init(r.m, r.w, r.memory[3], size, &r.single), RBD_OK);
    size = rbd_batch_derivatives_size(r.m);
    r.memory[4] = allocate(size);
    ck_assert_int_eq(rbd_batch_derivatives_init(r.m, r.b, r.memory[4], size, &r.d), RBD_OK);
    const rbd_constraint k = holding(&r);
    size = rbd_constraint_set_size(r.m, &k, 1);
    r.memory[5] = allocate(size);
    const int n = rbd_constraint_set_init(r.m, r.w, &k, 1, r.memory[5], size, &r.held, NULL) == RBD_OK;
    if (n == 0)
        ck_assert_int_eq(rbd_constraint_set_init(r.m, r.w, &k, 0, r.memory[5], size, &r.held, NULL), RBD_OK);
    size = rbd_batch_constraint_set_size(r.m, &k, n);
    r.memory[6] = allocate(size);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, &k, n, r.memory[6], size, &r.k, NULL), RBD_OK);
    return r;
}

static robot build_reference(const ref_model *model) { return build(model->name, model->bodies, model->nb); }

static void release(robot *r) {
    for (int i = 0; i < LENGTH(r->memory); i++) free(r->memory[i]);
}

static void set_gravity(const robot *r, const double gravity[3]) {
    const rbd_const g[3] = {(rbd_const)gravity[0], (rbd_const)gravity[1], (rbd_const)gravity[2]};
    ck_assert_int_eq(rbd_set_gravity(r->w, g), RBD_OK);
    ck_assert_int_eq(rbd_batch_set_gravity(r->b, g), RBD_OK);
}

/* States one after the other; f_ext may be NULL. */
typedef struct states {
    RBD_REAL *q, *v, *a, *tau, *f_ext;
} states;

static states states_new(const robot *r, int n) {
    const states x = {numbers(n, r->nq), numbers(n, r->nv), numbers(n, r->nv), numbers(n, r->nv),
                      numbers(n, 6 * r->nb)};
    return x;
}

static void states_free(states *x) {
    free(x->q);
    free(x->v);
    free(x->a);
    free(x->tau);
    free(x->f_ext);
}

/* The states from s on. */
static states states_from(const robot *r, const states *x, int s) {
    const states from = {x->q + s * r->nq, x->v + s * r->nv, x->a + s * r->nv, x->tau + s * r->nv,
                         x->f_ext ? x->f_ext + s * 6 * r->nb : NULL};
    return from;
}

static RBD_REAL *copy_of(const RBD_REAL *x, int rows, int width) {
    RBD_REAL *copy = numbers(rows, width);
    memcpy(copy, x, (size_t)rows * (size_t)width * sizeof(RBD_REAL));
    return copy;
}

/* The first n states in memory of that size: the sanitizer sees who reads on. */
static states states_cut(const robot *r, const states *x, int n) {
    const states cut = {copy_of(x->q, n, r->nq), copy_of(x->v, n, r->nv), copy_of(x->a, n, r->nv),
                        copy_of(x->tau, n, r->nv), x->f_ext ? copy_of(x->f_ext, n, 6 * r->nb) : NULL};
    return cut;
}

static void draw(uint64_t *seed, double size, RBD_REAL *x, int n) {
    for (int i = 0; i < n; i++) {
        *seed ^= *seed << 13; /* Marsaglia's xorshift */
        *seed ^= *seed >> 7;
        *seed ^= *seed << 17;
        x[i] = (RBD_REAL)(size * ((double)(*seed >> 11) / 4503599627370496.0 - 1));
    }
}

/* Random states within a step of size 1 from the neutral one: far from gimbal lock, singular in float. */
static states states_draw(const robot *r, int n) {
    states x = states_new(r, n);
    RBD_REAL *neutral = numbers(1, r->nq), *step = numbers(1, r->nv);
    uint64_t seed = 2027;
    ck_assert_int_eq(rbd_neutral(r->m, neutral), RBD_OK);
    for (int s = 0; s < n; s++) {
        draw(&seed, 1, step, r->nv);
        ck_assert_int_eq(rbd_integrate(r->m, neutral, step, 1, x.q + s * r->nq), RBD_OK);
    }
    draw(&seed, 2, x.v, n * r->nv);
    draw(&seed, 3, x.a, n * r->nv);
    draw(&seed, 20, x.tau, n * r->nv);
    draw(&seed, 10, x.f_ext, n * 6 * r->nb);
    free(neutral);
    free(step);
    return x;
}

/* ---- the calls by number ---- */

typedef enum call {
    RNEA,
    BIAS,
    CRBA,
    CRBA_PACKED,
    JACOBIAN,
    MOMENTUM,
    MOMENTUM_MATRIX,
    CORIOLIS,
    RNEA_DERIVATIVES,
    REGRESSOR,
    ABA, /* from here on with the inverse of M */
    FD_CHOLESKY,
    MINVERSE,
    CONSTRAINED_FD,
    FD_DERIVATIVES,
    CALLS
} call;

static const char *const call_name[CALLS] = {"rnea",
                                             "bias",
                                             "crba",
                                             "crba_packed",
                                             "jacobian",
                                             "momentum",
                                             "momentum_matrix",
                                             "coriolis",
                                             "rnea_derivatives",
                                             "regressor",
                                             "aba",
                                             "fd_cholesky",
                                             "minverse",
                                             "constrained_fd",
                                             "fd_derivatives"};

enum { PARTS = 4 };

/* The outputs of a call, one after the other in its row here: their widths, and that of the row. */
static int parts_of(const robot *r, call c, int width[PARTS]) {
    const int nv = r->nv, square = nv * nv, packed = rbd_packed_size(r->m);
    const int widths[CALLS][PARTS] = {{nv, 0, 0, 0},
                                      {nv, 0, 0, 0},
                                      {square, 0, 0, 0},
                                      {packed, 0, 0, 0},
                                      {6 * nv, 0, 0, 0},
                                      {6, 6, 0, 0},
                                      {6 * nv, 6, 0, 0},
                                      {square, 0, 0, 0},
                                      {square, square, square, 0},
                                      {10 * r->nb * nv, 0, 0, 0},
                                      {nv, 0, 0, 0},
                                      {nv, 0, 0, 0},
                                      {square, 0, 0, 0},
                                      {nv, rows_held(r), 0, 0},
                                      {nv, square, square, square}};
    int row = 0;
    for (int k = 0; k < PARTS; k++) row += width[k] = widths[c][k];
    return row;
}

static int width_of(const robot *r, call c) {
    int width[PARTS];
    return parts_of(r, c, width);
}

static int reads_q_alone(call c) { return c == CRBA || c == CRBA_PACKED || c == JACOBIAN || c == MINVERSE; }
static int reads_f_ext(call c) {
    return c <= BIAS || c == RNEA_DERIVATIVES || c == ABA || c == FD_CHOLESKY || c >= CONSTRAINED_FD;
}

static int outputs_may_be_null(call c) {
    return c == MOMENTUM || c == RNEA_DERIVATIVES || c == FD_DERIVATIVES;
}

static const RBD_REAL point[3] = {(RBD_REAL)0.3, (RBD_REAL)-0.2, (RBD_REAL)0.1};
static int hand_of(const robot *r) { return r->nb - 1; }

static rbd_status run_single(const robot *r, call c, const states *x, RBD_REAL *out) {
    const int square = r->nv * r->nv;
    const rbd_model *m = r->m;
    switch (c) {
    case RNEA: return rbd_rnea(m, r->w, x->q, x->v, x->a, x->f_ext, out);
    case BIAS: return rbd_bias(m, r->w, x->q, x->v, x->f_ext, out);
    case CRBA: return rbd_crba(m, r->w, x->q, out);
    case CRBA_PACKED: return rbd_crba_packed(m, r->w, x->q, out);
    case JACOBIAN:
        ck_assert_int_eq(rbd_kinematics(m, r->w, x->q, NULL, NULL), RBD_OK);
        return rbd_jacobian(m, r->w, hand_of(r), point, RBD_LINK_AXES, out);
    case MOMENTUM:
        ck_assert_int_eq(rbd_kinematics(m, r->w, x->q, x->v, x->a), RBD_OK);
        return rbd_momentum(m, r->w, out, out + 6);
    case MOMENTUM_MATRIX: return rbd_momentum_matrix(m, r->single, x->q, x->v, out, out + 6 * r->nv);
    case CORIOLIS: return rbd_coriolis(m, r->single, x->q, x->v, out);
    case RNEA_DERIVATIVES:
        return rbd_id_derivatives(m, r->single, x->q, x->v, x->a, x->f_ext, out, out + square,
                                  out + 2 * square);
    case REGRESSOR: return rbd_regressor(m, r->single, x->q, x->v, x->a, out);
    case ABA: return rbd_aba(m, r->w, x->q, x->v, x->tau, x->f_ext, out);
    case FD_CHOLESKY: return rbd_fd_cholesky(m, r->w, x->q, x->v, x->tau, x->f_ext, out);
    case MINVERSE: return rbd_minverse(m, r->w, x->q, out);
    case CONSTRAINED_FD:
        return rbd_constrained_fd(m, r->held, x->q, x->v, x->tau, x->f_ext, out, out + r->nv);
    default:
        return rbd_fd_derivatives(m, r->single, x->q, x->v, x->tau, x->f_ext, out, out + r->nv,
                                  out + r->nv + square, out + r->nv + 2 * square);
    }
}

/* A batch call with an array for each output. */
static rbd_status run_parts(const robot *r, call c, int n, const states *x, RBD_REAL *const y[PARTS]) {
    const rbd_model *m = r->m;
    switch (c) {
    case RNEA: return rbd_batch_rnea(m, r->b, n, x->q, x->v, x->a, x->f_ext, y[0]);
    case BIAS: return rbd_batch_bias(m, r->b, n, x->q, x->v, x->f_ext, y[0]);
    case CRBA: return rbd_batch_crba(m, r->b, n, x->q, y[0]);
    case CRBA_PACKED: return rbd_batch_crba_packed(m, r->b, n, x->q, y[0]);
    case JACOBIAN: return rbd_batch_jacobian(m, r->b, n, x->q, hand_of(r), point, RBD_LINK_AXES, y[0]);
    case MOMENTUM: return rbd_batch_momentum(m, r->b, n, x->q, x->v, x->a, y[0], y[1]);
    case MOMENTUM_MATRIX: return rbd_batch_momentum_matrix(m, r->d, n, x->q, x->v, y[0], y[1]);
    case CORIOLIS: return rbd_batch_coriolis(m, r->d, n, x->q, x->v, y[0]);
    case RNEA_DERIVATIVES:
        return rbd_batch_id_derivatives(m, r->d, n, x->q, x->v, x->a, x->f_ext, y[0], y[1], y[2]);
    case REGRESSOR: return rbd_batch_regressor(m, r->d, n, x->q, x->v, x->a, y[0]);
    case ABA: return rbd_batch_aba(m, r->b, n, x->q, x->v, x->tau, x->f_ext, y[0]);
    case FD_CHOLESKY: return rbd_batch_fd_cholesky(m, r->b, n, x->q, x->v, x->tau, x->f_ext, y[0]);
    case MINVERSE: return rbd_batch_minverse(m, r->b, n, x->q, y[0]);
    case CONSTRAINED_FD:
        return rbd_batch_constrained_fd(m, r->k, n, x->q, x->v, x->tau, x->f_ext, y[0], y[1]);
    default:
        return rbd_batch_fd_derivatives(m, r->d, n, x->q, x->v, x->tau, x->f_ext, y[0], y[1], y[2], y[3]);
    }
}

/* The same with the outputs of a state in one row; nothing is written beyond n of them. */
static rbd_status run_batch(const robot *r, call c, int n, const states *x, RBD_REAL *out) {
    int width[PARTS];
    const int row = r->m && out ? parts_of(r, c, width) : 0;
    RBD_REAL *y[PARTS] = {out, NULL, NULL, NULL}, *to = out;
    if (row == 0 || width[1] == 0) return run_parts(r, c, n, x, y);
    for (int k = 0; k < PARTS; k++) {
        y[k] = k == 0 || width[k] ? numbers(n + 1, width[k]) : NULL;
        for (int i = 0; i < width[k]; i++) y[k][n * width[k] + i] = canary;
    }
    const rbd_status status = run_parts(r, c, n, x, y);
    for (int s = 0; s < n && status != RBD_ERR_NULL && status != RBD_ERR_WORK; s++)
        for (int k = 0; k < PARTS; to += width[k++])
            if (width[k]) memcpy(to, y[k] + s * width[k], (size_t)width[k] * sizeof(RBD_REAL));
    for (int k = 0; k < PARTS; k++) {
        for (int i = 0; i < width[k]; i++)
            if (!(y[k][n * width[k] + i] == canary))
                ck_abort_msg("%s: writes beyond %d states", call_name[c], n);
        free(y[k]);
    }
    return status;
}

/* ---- comparison ---- */

static double largest_error[CALLS]; /* of batch against single calls */

/* One state's result against another's; the error is relative to the largest entry, or to 1e-3. */
static double expect_row(const char *what, const robot *r, int state, const RBD_REAL *found,
                         const RBD_REAL *expected, int n, double bound) {
    double difference = 0, size = 1e-3;
    for (int i = 0; i < n; i++) {
        const double x = (double)found[i], y = (double)expected[i];
        difference = larger(difference, fabs(x - y));
        size = larger(size, fabs(y));
    }
    if (!(difference / size <= bound))
        ck_abort_msg("%s: %s, state %d: error %.3g exceeds %.3g", what, r->name, state, difference / size,
                     bound);
    return difference / size;
}

/* The same for each of a call's outputs. */
static double expect_parts(const robot *r, call c, int state, const RBD_REAL *found,
                           const RBD_REAL *expected) {
    int width[PARTS];
    double largest = 0;
    parts_of(r, c, width);
    for (int k = 0; k < PARTS; found += width[k], expected += width[k], k++)
        largest = larger(largest, expect_row(call_name[c], r, state, found, expected, width[k], BOUND(c)));
    return largest;
}

/* The single calls' results of n states. */
static RBD_REAL *single_results(const robot *r, call c, const states *x, int n) {
    const int width = width_of(r, c);
    RBD_REAL *out = numbers(n, width);
    for (int s = 0; s < n; s++) {
        const states one = states_from(r, x, s);
        ck_assert_int_eq(run_single(r, c, &one, out + s * width), RBD_OK);
    }
    return out;
}

/* A batch of n states: the rows are as expected, and what lies beyond is not touched. */
static void expect_batch(const robot *r, call c, const states *x, int n, const RBD_REAL *expected) {
    const int width = width_of(r, c), beyond = (n + 2) * width;
    RBD_REAL *out = numbers(n + 2, width);
    for (int i = 0; i < beyond; i++) out[i] = canary;
    ck_assert_msg(run_batch(r, c, n, x, out) == RBD_OK, "%s: %s, %d states", call_name[c], r->name, n);
    for (int s = 0; s < n; s++)
        largest_error[c] =
            larger(largest_error[c], expect_parts(r, c, s, out + s * width, expected + s * width));
    for (int i = n * width; i < beyond; i++)
        if (!(out[i] == canary)) ck_abort_msg("%s: %s: writes beyond %d states", call_name[c], r->name, n);
    ck_assert_int_eq(rbd_batch_singular(r->b, NULL), -1);
    free(out);
}

/* ---- robots: the references and a tree with every type of joint, with and without mimic joints ---- */

typedef void robot_check(const robot *r);

static void check_one(robot r, robot_check *check) {
    check(&r);
    release(&r);
}

static rbd_body body_of_type(rbd_joint_type type, int parent) {
    const double length = type == RBD_FIXED ? 0 : 1;
    const rbd_body b = {.parent = parent,
                        .type = type,
                        .axis = {0.6 * length, 0, 0.8 * length},
                        .axis2 = {0, 1, 0},
                        .position = {0.3, -0.1, 0.2},
                        BOX,
                        .pitch = type == RBD_HELICAL ? 0.3 : 0};
    return b;
}

/* A chain with a branch at every third body. */
static void check_every_joint(int mimic, robot_check *check) {
    rbd_body bodies[RBD_JOINT_TYPES + 2];
    for (int i = 0; i < RBD_JOINT_TYPES; i++)
        bodies[i] = body_of_type((rbd_joint_type)((i + 1) % RBD_JOINT_TYPES), i - 1 - (i > 2 && i % 3 == 0));
    bodies[0].joint = "leader";
    for (int i = RBD_JOINT_TYPES; i < LENGTH(bodies); i++) {
        bodies[i] = body_of_type(i & 1 ? RBD_PRISMATIC : RBD_REVOLUTE, i - 3);
        if (mimic) {
            bodies[i].mimic = "leader";
            bodies[i].mimic_ratio = i & 1 ? 0.5 : -1.5;
            bodies[i].mimic_offset = 0.2;
        }
    }
    check_one(build(mimic ? "every joint, mimic" : "every joint", bodies, LENGTH(bodies)), check);
}

/* Fingers that aba takes as one joint. */
static void check_hand(robot_check *check) {
    rbd_body bodies[5] = {body_of_type(RBD_FLOATING, -1)};
    for (int i = 1; i < LENGTH(bodies); i++) {
        bodies[i] = body_of_type(i & 1 ? RBD_REVOLUTE : RBD_HELICAL, i == 3 ? 2 : 0);
        bodies[i].mimic = i == 2 ? NULL : "finger";
        bodies[i].mimic_ratio = 0.5 - i;
    }
    bodies[2].joint = "finger";
    check_one(build("hand", bodies, LENGTH(bodies)), check);
}

static void for_robots(robot_check *check) {
    const rbd_body plate[1] = {{.parent = -1, .type = RBD_FIXED, BOX}};
    for (int i = 0; i < reference_count; i++) check_one(build_reference(reference_model(i)), check);
    check_every_joint(0, check);
    check_every_joint(1, check);
    check_hand(check);
    check_one(build("no degree of freedom", plate, LENGTH(plate)), check);
}

/* ---- tests ---- */

START_TEST(lanes_are_as_compiled) { ck_assert_int_eq(rbd_batch_lanes(), BATCH_LANES); }
END_TEST

static int is_long(call c) { return c >= MOMENTUM_MATRIX && c != ABA && c != FD_CHOLESKY; }

/* Every number of lanes left over; of the long calls not twice, nor of any where there are many lanes. */
static void check_counts(const robot *r, call c, const states *x) {
    const int many = is_long(c) ? FEW : MANY, once = is_long(c) || BATCH_LANES > 8 ? BATCH_LANES + 1 : FEW;
    RBD_REAL *expected = single_results(r, c, x, many);
    for (int n = 0; n <= many; n = n == once && n < FEW ? FEW : n == FEW ? MANY : n + 1) {
        states cut = states_cut(r, x, n);
        expect_batch(r, c, &cut, n, expected);
        states_free(&cut);
    }
    free(expected);
}

static void check_any_number(const robot *r) {
    states x = states_draw(r, MANY), alone = x;
    alone.f_ext = NULL;
    for (call c = RNEA; c < CALLS; c++) {
        check_counts(r, c, &x);
        if (!reads_f_ext(c)) continue;
        if (!is_long(c)) check_counts(r, c, &alone);
        RBD_REAL *expected = single_results(r, c, &alone, 1);
        expect_batch(r, c, &alone, 1, expected);
        free(expected);
    }
    states_free(&x);
}

START_TEST(any_number_of_states_gives_the_single_results) { for_robots(check_any_number); }
END_TEST

/* Angles beyond where the library computes sines itself: in one state of many, and in the first. */
START_TEST(large_angles_give_the_single_results) {
    robot r = build_reference(reference_model(2));
    states x = states_draw(&r, FEW);
    x.q[0] = x.q[(BATCH_LANES + 1) * r.nq + 3] = (RBD_REAL)3e6;
    for (call c = RNEA; c < CALLS; c++) {
        RBD_REAL *expected = single_results(&r, c, &x, FEW);
        expect_batch(&r, c, &x, FEW, expected);
        free(expected);
    }
    states_free(&x);
    release(&r);
}
END_TEST

static void check_gravity(const robot *r) {
    const double gravity[2][3] = {{1, -2, 3}, {0, 0, 0}};
    states x = states_draw(r, FEW);
    for (int i = 0; i < 2; i++) {
        set_gravity(r, gravity[i]);
        for (call c = RNEA; c < CALLS; c++) {
            RBD_REAL *expected = single_results(r, c, &x, FEW);
            expect_batch(r, c, &x, FEW, expected);
            free(expected);
        }
    }
    states_free(&x);
}

START_TEST(gravity_can_be_set) { for_robots(check_gravity); }
END_TEST

/* a may be tau or v, tau may be a or v, c may be v: the same bits as apart. */
static void check_in_place(const robot *r) {
    const call calls[4] = {RNEA, BIAS, ABA, FD_CHOLESKY};
    for (int i = 0; i < LENGTH(calls); i++) {
        const call c = calls[i];
        const size_t size = (size_t)(FEW * r->nv) * sizeof(RBD_REAL);
        states x = states_draw(r, FEW);
        RBD_REAL *apart = numbers(FEW, r->nv);
        ck_assert_int_eq(run_batch(r, c, FEW, &x, apart), RBD_OK);
        RBD_REAL *const inputs[2] = {c == RNEA ? x.a : x.tau, x.v};
        for (int k = c == BIAS; k < 2; k++) {
            RBD_REAL *before = copy_of(inputs[k], FEW, r->nv);
            ck_assert_int_eq(run_batch(r, c, FEW, &x, inputs[k]), RBD_OK);
            ck_assert_msg(memcmp(inputs[k], apart, size) == 0, "%s: %s, in place", call_name[c], r->name);
            memcpy(inputs[k], before, size);
            free(before);
        }
        free(apart);
        states_free(&x);
    }
}

START_TEST(output_may_be_an_input) { for_robots(check_in_place); }
END_TEST

/* ---- singular states among good ones ---- */

/* A robot that can be made singular in two ways: by coordinate lock[i] at this value. */
typedef struct trap {
    robot r;
    int lock[2];
    double value;
} trap;

/* An arm that turns about z with a bead that slides on it: singular where the bead is on the axis. */
#define ARM(at) {.joint = "turn" #at, .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}}
#define BEAD(on) {.parent = on, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1}

static trap beads(void) {
    const rbd_body bodies[4] = {ARM(0), BEAD(0), ARM(2), BEAD(2)};
    const trap t = {build("two beads", bodies, LENGTH(bodies)), {1, 3}, 0};
    return t;
}

static trap gimbals(void) {
    const rbd_body bodies[2] = {{.parent = -1, .type = RBD_EULER_ZYX, BOX},
                                {.parent = -1, .type = RBD_EULER_XYZ, BOX}};
    const trap t = {build("two gimbals", bodies, LENGTH(bodies)), {1, 4}, HALF_PI};
    return t;
}

static trap gimbals_with_mimic(void) {
    const rbd_body bodies[4] = {
        {.parent = -1, .type = RBD_EULER_ZYX, BOX},
        {.joint = "leader", .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, BOX},
        {.parent = 1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, BOX, .mimic = "leader", .mimic_ratio = 2},
        {.parent = -1, .type = RBD_EULER_XYZ, BOX}};
    const trap t = {build("gimbals and mimic", bodies, LENGTH(bodies)), {1, 5}, HALF_PI};
    return t;
}

/* Not singular, but no number. */
static trap no_numbers(void) {
    trap t = gimbals();
    t.value = NAN;
    return t;
}

/* Runs what needs the inverse of M on states of which those with way[s] >= 0 are singular in
   that way: they become zero. */
static void expect_first_singular(const trap *t, const states *good, const int way[FEW], call end) {
    const robot *r = &t->r;
    const rbd_status error = isnan(t->value) ? RBD_ERR_NAN : RBD_ERR_SINGULAR;
    const int row = width_of(r, FD_DERIVATIVES); /* the longest */
    RBD_REAL *expected = numbers(1, row), *found = numbers(FEW, row);
    for (call c = ABA; c < end; c++) {
        const int n = width_of(r, c);
        states x = states_cut(r, good, FEW);
        int first = -1, first_dof = -1, dof = -2;
        for (int s = 0; s < FEW; s++)
            if (way[s] >= 0) x.q[s * r->nq + t->lock[way[s]]] = (RBD_REAL)t->value;
        const rbd_status status = run_batch(r, c, FEW, &x, found);
        for (int s = 0; s < FEW; s++) {
            const states one = states_from(r, &x, s);
            const rbd_status single = run_single(r, c, &one, expected);
            ck_assert_int_eq(single, way[s] < 0 ? RBD_OK : error);
            if (single && first < 0) {
                first = s;
                first_dof = rbd_singular_dof(r->w);
            }
            if (!single) expect_parts(r, c, s, found + s * n, expected);
            for (int k = 0; k < n; k++)
                ck_assert_msg(way[s] < 0 ? isfinite((double)found[s * n + k]) : found[s * n + k] == 0,
                              "%s, state %d: neither right nor zero", r->name, s);
        }
        ck_assert_int_eq(status, first < 0 ? RBD_OK : error);
        ck_assert_int_eq(rbd_batch_singular(r->b, NULL), first);
        ck_assert_int_eq(rbd_batch_singular(r->b, &dof), first);
        ck_assert_int_eq(dof, first_dof);
        states_free(&x);
    }
    free(expected);
    free(found);
}

/* One point shall be in two places at once. */
START_TEST(contradictions_are_told) {
    robot r = build_reference(reference_model(0));
    states x = states_draw(&r, FEW);
    const double at[3] = {0, 0, 0.1}, here[3] = {0, 0, 0}, there[3] = {1, 2, 3};
    rbd_constraint list[2] = {rbd_point_contact(r.nb - 1, at, here), rbd_point_contact(r.nb - 1, at, there)};
    list[1].kp = 10;
    const size_t size = rbd_batch_constraint_set_size(r.m, list, 2);
    void *memory = allocate(size);
    rbd_batch_constraint_set *k;
    RBD_REAL *a = numbers(FEW, r.nv), *lambda = numbers(FEW, 6);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, list, 2, memory, size, &k, NULL), RBD_OK);
    ck_assert_int_eq(rbd_batch_constrained_fd(r.m, k, FEW, x.q, x.v, x.tau, NULL, a, lambda),
                     RBD_ERR_INFEASIBLE);
    for (int i = 0; i < FEW * r.nv; i++) ck_assert(isfinite((double)a[i]));
    free(a);
    free(lambda);
    free(memory);
    states_free(&x);
    release(&r);
}
END_TEST

/* A hand that a ball joint holds is a loop: three rows, in batches of rows or one by one. */
START_TEST(held_hand_is_the_same_in_lanes) {
    robot r = build_reference(reference_model(2));
    states x = states_draw(&r, FEW);
    const double at[3] = {0, 0, 0.1};
    const rbd_constraint ball = rbd_point_contact(r.nb - 1, at, at);
    const size_t size = rbd_constraint_set_size(r.m, &ball, 1),
                 batch = rbd_batch_constraint_set_size(r.m, &ball, 1);
    void *memory[2] = {allocate(size), allocate(batch)};
    rbd_constraint_set *c;
    rbd_batch_constraint_set *k;
    RBD_REAL *a = numbers(FEW, r.nv), *lambda = numbers(FEW, 3), *alone = numbers(1, r.nv + 3);
    ck_assert_int_eq(rbd_constraint_set_init(r.m, r.w, &ball, 1, memory[0], size, &c, NULL), RBD_OK);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, &ball, 1, memory[1], batch, &k, NULL), RBD_OK);
    ck_assert_int_eq(rbd_batch_constrained_fd(r.m, k, FEW, x.q, x.v, x.tau, NULL, a, lambda), RBD_OK);
    for (int s = 0; s < FEW; s++) {
        double size_of_a = 1, error = 0;
        ck_assert_int_eq(rbd_constrained_fd(r.m, c, x.q + s * r.nq, x.v + s * r.nv, x.tau + s * r.nv, NULL,
                                            alone, alone + r.nv),
                         RBD_OK);
        for (int i = 0; i < r.nv; i++) {
            size_of_a = larger(size_of_a, fabs((double)alone[i]));
            error = larger(error, fabs((double)(a[s * r.nv + i] - alone[i])));
        }
        ck_assert_msg(error < (sizeof(RBD_REAL) == 4 ? 1e-3 : 1e-11) * size_of_a, "%s, state %d: %g of %g",
                      r.name, s, error, size_of_a);
    }
    free(memory[0]);
    free(memory[1]);
    free(a);
    free(lambda);
    free(alone);
    states_free(&x);
    release(&r);
}
END_TEST

/* No singular state, every one alone, and with each that is 1, 2, 4... behind it, as lanes are exchanged: its
   neighbour, and the same lane of the next batch (but for the longest call); in one way each. */
static void check_trap(trap t) {
    states good = states_draw(&t.r, FEW);
    int way[FEW];
    for (int s = 0; s < FEW; s++) way[s] = -1;
    for (int i = 0; i < FEW; i++) {
        way[i] = i & 1;
        expect_first_singular(&t, &good, way, CALLS);
        for (int apart = 1; i + apart < FEW; apart *= 2) {
            const int k = i + apart;
            way[k] = !way[i];
            expect_first_singular(&t, &good, way, FD_DERIVATIVES);
            way[i] = !way[i];
            way[k] = !way[i];
            expect_first_singular(&t, &good, way, FD_DERIVATIVES);
            way[k] = -1;
        }
        way[i] = -1;
        expect_first_singular(&t, &good, way, CALLS); /* and the call after is clean */
    }
    states_free(&good);
    release(&t.r);
}

START_TEST(first_singular_state_is_named_and_the_others_stand) {
    check_trap(beads());
    check_trap(gimbals());
    check_trap(gimbals_with_mimic());
    check_trap(no_numbers());
}
END_TEST

/* A later call without a singular state forgets, whatever it computes. */
START_TEST(singular_state_is_of_the_last_call) {
    trap t = beads();
    const double locked[4] = {0.1, 0, 0.2, 0.3};
    states x = states_draw(&t.r, 1);
    RBD_REAL out[1024];
    for (call c = RNEA; c < CALLS; c++) {
        int dof = -2;
        RBD_REAL *q = copy_of(x.q, 1, t.r.nq);
        for (int k = 0; k < LENGTH(locked); k++) x.q[k] = (RBD_REAL)locked[k];
        ck_assert_int_eq(run_batch(&t.r, ABA, 1, &x, out), RBD_ERR_SINGULAR);
        ck_assert_int_eq(rbd_batch_singular(t.r.b, &dof), 0);
        ck_assert_int_eq(dof, 0);
        free(x.q);
        x.q = q;
        ck_assert_int_eq(run_batch(&t.r, c, 1, &x, out), RBD_OK);
        ck_assert_int_eq(rbd_batch_singular(t.r.b, &dof), -1);
        ck_assert_int_eq(dof, -1);
    }
    states_free(&x);
    release(&t.r);
}
END_TEST

/* ---- layouts ---- */

/* An array of whole blocks for n states, some numbers beyond a multiple of 64 bytes. */
typedef struct blocks {
    int n, width, size; /* size: with what stands beyond the states */
    RBD_REAL *x;
    void *memory;
} blocks;

static RBD_REAL *entry(const blocks *b, int s, int k) {
    return &b->x[(s / BATCH_LANES * b->width + k) * BATCH_LANES + s % BATCH_LANES];
}

static blocks blocks_of(const RBD_REAL *rows, int n, int width, int offset, RBD_REAL elsewhere) {
    blocks b = {.n = n, .width = width, .size = (n / BATCH_LANES + 2) * BATCH_LANES * width};
    b.memory = allocate((size_t)(b.size + offset) * sizeof(RBD_REAL) + 64);
    b.x = (RBD_REAL *)(((uintptr_t)b.memory + 63) / 64 * 64) + offset;
    for (int i = 0; i < b.size; i++) b.x[i] = elsewhere;
    for (int s = 0; rows && s < n; s++)
        for (int k = 0; k < width; k++) *entry(&b, s, k) = rows[s * width + k];
    return b;
}

/* The rows' bits, and nothing written beyond them. */
static void expect_blocks(const robot *r, call c, blocks *b, const RBD_REAL *rows) {
    for (int s = 0; s < b->n; s++)
        for (int k = 0; k < b->width; k++) {
            if (memcmp(entry(b, s, k), &rows[s * b->width + k], sizeof(RBD_REAL)) != 0)
                ck_abort_msg("%s: %s, state %d of %d, component %d differs between rows and blocks",
                             call_name[c], r->name, s, b->n, k);
            *entry(b, s, k) = canary;
        }
    for (int i = 0; i < b->size; i++)
        if (!(b->x[i] == canary))
            ck_abort_msg("%s: %s: writes beyond %d states in blocks", call_name[c], r->name, b->n);
}

/* A call on n states in rows and in blocks: the same bits, and errors. Where there is no state stands no
   number. */
static void expect_same_in_blocks(const robot *r, call c, int n, const states *x, int offset) {
    int width[PARTS], state[2], dof[2];
    RBD_REAL *rows[PARTS] = {NULL, NULL, NULL, NULL}, *out[PARTS] = {NULL, NULL, NULL, NULL};
    blocks found[PARTS],
        in[5] = {blocks_of(x->q, n, r->nq, offset, NAN), blocks_of(x->v, n, r->nv, offset, NAN),
                 blocks_of(x->a, n, r->nv, offset, NAN), blocks_of(x->tau, n, r->nv, offset, NAN),
                 blocks_of(x->f_ext, n, 6 * r->nb, offset, NAN)};
    const states y = {in[0].x, in[1].x, in[2].x, in[3].x, x->f_ext ? in[4].x : NULL};
    parts_of(r, c, width);
    for (int k = 0; k < PARTS; k++) {
        found[k] = blocks_of(NULL, n, width[k], offset, canary);
        if (k == 0 || width[k]) rows[k] = numbers(n, width[k]), out[k] = found[k].x;
    }
    const rbd_status status = run_parts(r, c, n, x, rows);
    state[0] = rbd_batch_singular(r->b, &dof[0]);
    ck_assert_int_eq(rbd_batch_set_layout(r->b, RBD_BLOCKS), RBD_OK);
    ck_assert_int_eq(run_parts(r, c, n, &y, out), status);
    state[1] = rbd_batch_singular(r->b, &dof[1]);
    ck_assert_int_eq(rbd_batch_set_layout(r->b, RBD_ROWS), RBD_OK);
    ck_assert_int_eq(state[1], state[0]);
    ck_assert_int_eq(dof[1], dof[0]);
    for (int k = 0; k < PARTS; k++) {
        if (rows[k]) expect_blocks(r, c, &found[k], rows[k]);
        free(rows[k]);
        free(found[k].memory);
    }
    for (int k = 0; k < LENGTH(in); k++) free(in[k].memory);
}

/* No state, a block that is not full, one that is, and several; where lanes may stand and where not. */
static void check_blocks(const robot *r) {
    const int counts[4] = {0, 1, BATCH_LANES, FEW};
    states x = states_draw(r, FEW), alone = x;
    alone.f_ext = NULL;
    for (call c = RNEA; c < CALLS; c++)
        for (int i = 0; i < LENGTH(counts); i++)
            for (int offset = 0; offset < 2; offset++)
                expect_same_in_blocks(r, c, counts[i], offset ? &alone : &x, offset);
    states_free(&x);
}

START_TEST(blocks_give_the_bits_of_rows) { for_robots(check_blocks); }
END_TEST

/* Each state alone is singular in one of two ways. */
START_TEST(blocks_name_the_singular_state_of_rows) {
    trap t = gimbals();
    for (int i = 0; i < FEW; i++) {
        states x = states_draw(&t.r, FEW);
        x.q[i * t.r.nq + t.lock[i & 1]] = (RBD_REAL)t.value;
        for (call c = ABA; c < CALLS; c++) expect_same_in_blocks(&t.r, c, FEW, &x, 0);
        states_free(&x);
    }
    release(&t.r);
}
END_TEST

/* As output_may_be_an_input, where the call works on the caller's memory itself. */
START_TEST(output_may_be_an_input_in_blocks) {
    robot r = build_reference(reference_model(2));
    const call calls[2] = {RNEA, ABA};
    for (int i = 0; i < LENGTH(calls); i++) {
        states x = states_draw(&r, FEW);
        RBD_REAL *apart = numbers(FEW, r.nv), *const in = calls[i] == RNEA ? x.a : x.tau;
        blocks q = blocks_of(x.q, FEW, r.nq, 0, NAN), v = blocks_of(x.v, FEW, r.nv, 0, NAN),
               both = blocks_of(in, FEW, r.nv, 0, canary), f = blocks_of(x.f_ext, FEW, 6 * r.nb, 0, NAN);
        const states y = {q.x, v.x, both.x, both.x, f.x};
        ck_assert_int_eq(run_batch(&r, calls[i], FEW, &x, apart), RBD_OK);
        ck_assert_int_eq(rbd_batch_set_layout(r.b, RBD_BLOCKS), RBD_OK);
        ck_assert_int_eq(run_batch(&r, calls[i], FEW, &y, both.x), RBD_OK);
        ck_assert_int_eq(rbd_batch_set_layout(r.b, RBD_ROWS), RBD_OK);
        expect_blocks(&r, calls[i], &both, apart);
        free(apart);
        free(q.memory);
        free(v.memory);
        free(both.memory);
        free(f.memory);
        states_free(&x);
    }
    release(&r);
}
END_TEST

/* ---- arguments and memory ---- */

START_TEST(null_arguments_are_refused) {
    robot r = build_reference(reference_model(2));
    states x = states_draw(&r, 1);
    RBD_REAL out[4096];
    for (call c = RNEA; c < CALLS; c++) {
        robot no_model = r, no_batch = r;
        states no_q = x, no_v = x, no_third = x;
        no_model.m = NULL;
        no_batch.b = NULL;
        no_batch.d = NULL;
        no_batch.k = NULL;
        no_q.q = no_v.v = no_third.a = no_third.tau = NULL;
        ck_assert_int_eq(run_batch(&no_model, c, 1, &x, out), RBD_ERR_NULL);
        ck_assert_int_eq(run_batch(&no_batch, c, 1, &x, out), RBD_ERR_NULL);
        ck_assert_int_eq(run_batch(&r, c, 1, &no_q, out), RBD_ERR_NULL);
        ck_assert_int_eq(run_batch(&r, c, 1, &x, NULL), outputs_may_be_null(c) ? RBD_OK : RBD_ERR_NULL);
        if (!reads_q_alone(c))
            ck_assert_int_eq(run_batch(&r, c, 1, &no_v, out), c == MOMENTUM ? RBD_OK : RBD_ERR_NULL);
        if (reads_f_ext(c) && c != BIAS) ck_assert_int_eq(run_batch(&r, c, 1, &no_third, out), RBD_ERR_NULL);
    }
    int dof = 0;
    ck_assert_int_eq(rbd_batch_singular(NULL, NULL), -1);
    ck_assert_int_eq(rbd_batch_singular(NULL, &dof), -1);
    ck_assert_int_eq(dof, -1);
    const rbd_const gravity[3] = {0, 0, 0};
    ck_assert_int_eq(rbd_batch_set_gravity(NULL, gravity), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_set_gravity(r.b, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_set_layout(NULL, RBD_BLOCKS), RBD_ERR_NULL);
    const size_t size = rbd_batch_size(r.m);
    ck_assert_uint_eq(rbd_batch_size(NULL), 0);
    rbd_batch *b = r.b;
    ck_assert_int_eq(rbd_batch_init(NULL, r.memory[2], size, &b), RBD_ERR_NULL);
    ck_assert_ptr_null(b);
    b = r.b;
    ck_assert_int_eq(rbd_batch_init(r.m, NULL, size, &b), RBD_ERR_NULL);
    ck_assert_ptr_null(b);
    ck_assert_int_eq(rbd_batch_init(r.m, r.memory[2], size, NULL), RBD_ERR_NULL);
    const size_t more = rbd_batch_derivatives_size(r.m);
    robot other = build_reference(reference_model(0));
    rbd_batch_derivatives *d = r.d;
    ck_assert_int_eq(rbd_batch_derivatives_init(r.m, other.b, r.memory[4], more, &d), RBD_ERR_WORK);
    ck_assert_ptr_null(d);
    release(&other);
    ck_assert_uint_eq(rbd_batch_derivatives_size(NULL), 0);
    ck_assert_int_eq(rbd_batch_derivatives_init(NULL, r.b, r.memory[4], more, &d), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_derivatives_init(r.m, NULL, r.memory[4], more, &d), RBD_ERR_NULL);
    d = r.d;
    ck_assert_int_eq(rbd_batch_derivatives_init(r.m, r.b, NULL, more, &d), RBD_ERR_NULL);
    ck_assert_ptr_null(d);
    ck_assert_int_eq(rbd_batch_derivatives_init(r.m, r.b, r.memory[4], more, NULL), RBD_ERR_NULL);
    const rbd_constraint k = holding(&r);
    const size_t third = rbd_batch_constraint_set_size(r.m, &k, 1);
    rbd_constraint strange = k;
    strange.body1 = -2;
    ck_assert_uint_eq(rbd_batch_constraint_set_size(NULL, &k, 1), 0);
    ck_assert_uint_eq(rbd_batch_constraint_set_size(r.m, NULL, 1), 0);
    ck_assert_int_eq(rbd_batch_constraint_set_init(NULL, r.b, &k, 1, r.memory[6], third, &r.k, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, NULL, &k, 1, r.memory[6], third, &r.k, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, NULL, 1, r.memory[6], third, &r.k, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, &k, 1, NULL, third, &r.k, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, &k, 1, r.memory[6], third, NULL, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, &strange, 1, r.memory[6], third, &r.k, NULL),
                     RBD_ERR_INDEX);
    states_free(&x);
    release(&r);
}
END_TEST

/* Each output alone is what it is with the others; the Jacobian of no point is that of the origin. */
START_TEST(outputs_may_be_left_out) {
    robot r = build_reference(reference_model(2));
    states x = states_draw(&r, FEW);
    for (call c = MOMENTUM; c < CALLS; c++) {
        int width[PARTS];
        parts_of(&r, c, width);
        if (width[1] == 0) continue;
        RBD_REAL *all[PARTS] = {NULL, NULL, NULL, NULL};
        for (int k = 0; k < PARTS; k++)
            if (width[k]) all[k] = numbers(FEW, width[k]);
        ck_assert_int_eq(run_parts(&r, c, FEW, &x, all), RBD_OK);
        const int needed = c == MOMENTUM_MATRIX || c == CONSTRAINED_FD; /* the first */
        for (int k = needed; k < PARTS && width[k]; k++) {
            RBD_REAL *one[PARTS] = {needed ? all[0] : NULL, NULL, NULL, NULL};
            one[k] = numbers(FEW, width[k]);
            ck_assert_int_eq(run_parts(&r, c, FEW, &x, one), RBD_OK);
            for (int s = 0; s < FEW; s++)
                expect_row(call_name[c], &r, s, one[k] + s * width[k], all[k] + s * width[k], width[k],
                           BOUND(c));
            free(one[k]);
        }
        for (int k = 0; k < PARTS; k++) free(all[k]);
    }
    const RBD_REAL origin[3] = {0, 0, 0};
    RBD_REAL *J[2] = {numbers(FEW, 6 * r.nv), numbers(FEW, 6 * r.nv)};
    ck_assert_int_eq(rbd_batch_jacobian(r.m, r.b, FEW, x.q, 0, NULL, RBD_WORLD_AXES, J[0]), RBD_OK);
    ck_assert_int_eq(rbd_batch_jacobian(r.m, r.b, FEW, x.q, 0, origin, RBD_WORLD_AXES, J[1]), RBD_OK);
    ck_assert_int_eq(memcmp(J[0], J[1], (size_t)(FEW * 6 * r.nv) * sizeof(RBD_REAL)), 0);
    ck_assert_int_eq(rbd_batch_jacobian(r.m, r.b, FEW, x.q, -1, NULL, RBD_WORLD_AXES, J[0]), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_batch_jacobian(r.m, r.b, FEW, x.q, r.nb, NULL, RBD_WORLD_AXES, J[0]), RBD_ERR_INDEX);
    free(J[0]);
    free(J[1]);
    states_free(&x);
    release(&r);
}
END_TEST

START_TEST(model_of_another_version_is_refused) {
    robot r = build_reference(reference_model(2));
    rbd_model other = *r.m;
    rbd_batch *b = r.b;
    other.version++;
    ck_assert_int_eq(rbd_batch_init(&other, r.memory[2], rbd_batch_size(r.m), &b), RBD_ERR_VERSION);
    ck_assert_ptr_null(b);
    release(&r);
}
END_TEST

START_TEST(batch_of_another_model_is_refused) {
    robot r = build_reference(reference_model(2)), small = build_reference(reference_model(0));
    states x = states_draw(&r, 1);
    RBD_REAL out[1] = {0};
    robot mixed = r;
    mixed.b = small.b;
    mixed.d = small.d;
    mixed.k = small.k;
    for (call c = RNEA; c < CALLS; c++) ck_assert_int_eq(run_batch(&mixed, c, 1, &x, out), RBD_ERR_WORK);
    states_free(&x);
    release(&small);
    release(&r);
}
END_TEST

/* A fixed body more, in the same memory: f_ext is longer, all else is as before. */
START_TEST(batch_of_a_model_built_over_is_refused) {
    const rbd_body bodies[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, 1}},
        {.parent = 0, .position = {0, 0, 1}}};
    robot r = build("rod", bodies, 1);
    const size_t size = rbd_model_size(bodies, 2), batch_size = rbd_batch_size(r.m);
    void *memory = allocate(size);
    ck_assert_int_eq(rbd_model_build(bodies, 1, memory, size, &r.m, NULL), RBD_OK);
    ck_assert_int_eq(rbd_batch_init(r.m, r.memory[2], batch_size, &r.b), RBD_OK);
    ck_assert_int_eq(rbd_batch_derivatives_init(r.m, r.b, r.memory[4], rbd_batch_derivatives_size(r.m), &r.d),
                     RBD_OK);
    const rbd_constraint kept = holding(&r);
    ck_assert_int_eq(rbd_batch_constraint_set_init(r.m, r.b, &kept, 1, r.memory[6],
                                                   rbd_batch_constraint_set_size(r.m, &kept, 1), &r.k, NULL),
                     RBD_OK);
    ck_assert_int_eq(rbd_model_build(bodies, 2, memory, size, &r.m, NULL), RBD_OK);
    r.nb = 2;
    states x = states_draw(&r, 1);
    RBD_REAL out[1] = {0};
    for (call c = RNEA; c < CALLS; c++) ck_assert_int_eq(run_batch(&r, c, 1, &x, out), RBD_ERR_WORK);
    states_free(&x);
    free(memory);
    release(&r);
}
END_TEST

/* Memory that ends where it may, begins anywhere and holds no useful numbers. */
static void check_memory(const robot *r) {
    const int offsets[5] = {0, 1, 8, 31, 63};
    const rbd_constraint k = holding(r);
    const size_t size = rbd_batch_size(r->m), more = rbd_batch_derivatives_size(r->m),
                 third = rbd_batch_constraint_set_size(r->m, &k, rows_held(r));
    states x = states_draw(r, FEW);
    RBD_REAL *expected[CALLS];
    for (call c = RNEA; c < CALLS; c++) expected[c] = single_results(r, c, &x, FEW);

    for (int i = 0; i < LENGTH(offsets); i++) {
        const size_t offset = (size_t)offsets[i];
        unsigned char *memory = (unsigned char *)allocate(offset + size),
                      *derivatives = (unsigned char *)allocate(offset + more),
                      *constraints = (unsigned char *)allocate(offset + third);
        robot moved = *r;
        memset(memory, 0xff, offset + size);
        memset(derivatives, 0xff, offset + more);
        memset(constraints, 0xff, offset + third);
        ck_assert_int_eq(rbd_batch_init(r->m, memory + offset, size - 1, &moved.b), RBD_ERR_MEMORY);
        ck_assert_int_eq(rbd_batch_init(r->m, memory + offset, size, &moved.b), RBD_OK);
        ck_assert_int_eq(rbd_batch_singular(moved.b, NULL), -1);
        ck_assert_int_eq(rbd_batch_derivatives_init(r->m, moved.b, derivatives + offset, more - 1, &moved.d),
                         RBD_ERR_MEMORY);
        ck_assert_int_eq(rbd_batch_derivatives_init(r->m, moved.b, derivatives + offset, more, &moved.d),
                         RBD_OK);
        ck_assert_int_eq(rbd_batch_constraint_set_init(r->m, moved.b, &k, rows_held(r), constraints + offset,
                                                       third - 1, &moved.k, NULL),
                         RBD_ERR_MEMORY);
        ck_assert_ptr_null(moved.k);
        ck_assert_int_eq(rbd_batch_constraint_set_init(r->m, moved.b, &k, rows_held(r), constraints + offset,
                                                       third, &moved.k, NULL),
                         RBD_OK);
        for (call c = RNEA; c < CALLS; c++) expect_batch(&moved, c, &x, FEW, expected[c]);
        for (size_t j = 0; j < offset; j++)
            ck_assert_uint_eq(memory[j] & derivatives[j] & constraints[j], 0xff);
        free(memory);
        free(derivatives);
        free(constraints);
    }

    for (call c = RNEA; c < CALLS; c++) free(expected[c]);
    states_free(&x);
}

START_TEST(memory_of_the_stated_size_is_enough_and_less_is_refused) { for_robots(check_memory); }
END_TEST

/* ---- the reference ---- */

/* State k and those after it that have the same gravity; k again where another has not. */
static const ref_state *pick(const ref_model *model, int k, int lane) {
    const ref_state *s = &model->states[k], *other = &model->states[(k + lane) % model->nstates];
    return memcmp(s->gravity, other->gravity, 3 * sizeof(double)) ? s : other;
}

static void put(RBD_REAL *x, const double *values, int n) {
    for (int i = 0; i < n; i++) x[i] = (RBD_REAL)values[i];
}

static void compare(const robot *r, call c, const states *x, int row, const double *expected, double bound) {
    const int width = width_of(r, c);
    RBD_REAL *found = numbers(FEW, width), *rounded = numbers(1, width);
    put(rounded, expected, width);
    ck_assert_int_eq(run_batch(r, c, FEW, x, found), RBD_OK);
    expect_row(call_name[c], r, row, found + row * width, rounded, width, bound);
    free(found);
    free(rounded);
}

static void check_reference(const robot *r, const ref_model *model, int k) {
    states x = states_new(r, FEW);
    for (int s = 0; s < FEW; s++) {
        const ref_state *state = pick(model, k, s);
        const states one = states_from(r, &x, s);
        put(one.q, state->q, r->nq);
        put(one.v, state->v, r->nv);
        put(one.a, state->vdot, r->nv);
        put(one.tau, state->tau, r->nv);
        put(one.f_ext, state->f_ext, 6 * r->nb);
    }
    set_gravity(r, model->states[k].gravity);
    for (int s = 0; s < FEW; s++) {
        const ref_state *state = pick(model, k, s);
        const double inverse = INVERSE(state->cond_M);
        states alone = x;
        alone.f_ext = NULL;
        compare(r, RNEA, &x, s, state->tau_rnea_ext, DIRECT);
        compare(r, RNEA, &alone, s, state->tau_rnea, DIRECT);
        compare(r, BIAS, &alone, s, state->c, CANCELLED);
        compare(r, CRBA, &x, s, state->M, DIRECT);
        compare(r, ABA, &x, s, state->qdd_ext, inverse);
        compare(r, ABA, &alone, s, state->qdd, inverse);
        compare(r, FD_CHOLESKY, &x, s, state->qdd_ext, inverse);
        compare(r, FD_CHOLESKY, &alone, s, state->qdd, inverse);
    }
    states_free(&x);
}

START_TEST(results_match_the_reference) {
    for (int i = 0; i < reference_count; i++) {
        const ref_model *model = reference_model(i);
        robot r = build_reference(model);
        for (int k = 0; k < model->nstates; k++) check_reference(&r, model, k);
        release(&r);
    }
}
END_TEST

int main(int argc, char **argv) {
    const int errors = argc > 1 && strcmp(argv[1], "--errors") == 0;
    Suite *suite = suite_create("batch");
    TCase *c = tcase_create("batch");
    tcase_set_timeout(c, 120);
    tcase_add_test(c, lanes_are_as_compiled);
    tcase_add_test(c, any_number_of_states_gives_the_single_results);
    tcase_add_test(c, large_angles_give_the_single_results);
    tcase_add_test(c, gravity_can_be_set);
    tcase_add_test(c, output_may_be_an_input);
    tcase_add_test(c, first_singular_state_is_named_and_the_others_stand);
    tcase_add_test(c, singular_state_is_of_the_last_call);
    tcase_add_test(c, contradictions_are_told);
    tcase_add_test(c, held_hand_is_the_same_in_lanes);
    tcase_add_test(c, blocks_give_the_bits_of_rows);
    tcase_add_test(c, blocks_name_the_singular_state_of_rows);
    tcase_add_test(c, output_may_be_an_input_in_blocks);
    tcase_add_test(c, null_arguments_are_refused);
    tcase_add_test(c, outputs_may_be_left_out);
    tcase_add_test(c, model_of_another_version_is_refused);
    tcase_add_test(c, batch_of_another_model_is_refused);
    tcase_add_test(c, batch_of_a_model_built_over_is_refused);
    tcase_add_test(c, memory_of_the_stated_size_is_enough_and_less_is_refused);
    tcase_add_test(c, results_match_the_reference);
    suite_add_tcase(suite, c);
    SRunner *runner = srunner_create(suite);
    if (errors) srunner_set_fork_status(runner, CK_NOFORK); /* the errors are kept in this process */
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    for (call i = RNEA; errors && i < CALLS; i++) printf("%-16s %.1e\n", call_name[i], largest_error[i]);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
