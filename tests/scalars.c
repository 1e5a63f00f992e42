/* scalars.c - the library with another scalar against the reference. One source for all scalars:
       -DSCALAR_FLOAT, -DSCALAR_QUAD, -DRBD_LANES=4, -DRBD_LANES=8, nothing (double);
   test_class.cpp includes it with a C++ class. In a build of n lanes each lane has a state of its own. */
#if defined SCALAR_FLOAT
#define RBD_REAL float
#define SCALAR_NAME "float"
#define SCALAR_EPSILON 6e-8
#define SCALAR_LARGEST FLT_MAX
#define SCALAR_EXPONENT 128
#elif defined SCALAR_QUAD
#define RBD_REAL __float128
#define SCALAR_NAME "__float128"
#define SCALAR_EPSILON 1e-34
#define SCALAR_EXPONENT 16384
#elif !defined SCALAR_NAME
#define SCALAR_NAME "double"
#endif
#ifndef SCALAR_EPSILON
#define SCALAR_EPSILON 1.1e-16
#endif
#ifndef SCALAR_EXPONENT /* 2^this overflows */
#define SCALAR_EXPONENT 1024
#endif
#ifndef SCALAR_LARGEST /* that a description can have */
#define SCALAR_LARGEST DBL_MAX
#endif

#define RBD_IMPLEMENTATION
#include "larger.h"
#include "rbd_derivatives.h"
#include "rbd_constraints.h"

#include "reference.h"

#include "quiet_check.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bounds of relative errors, stated in rounding units of the scalar; the reference has 17 digits.
   DIRECT: what needs no inverse. INVERSE: times the condition number; the round trip likewise. */
#define FLOOR 1e-14
#define DIRECT (100 * SCALAR_EPSILON)
#define INVERSE(condition) (DIRECT + 100 * SCALAR_EPSILON * (condition))
/* Results that may vanish by cancellation: iiwa's neutral state has hardly any gravity torque and bias. */
#define CANCELLED (1e-12 + 1000 * DIRECT)

enum { MAX_B = 40, MAX_V = 64, MAX_Q = 80, MAX_M = MAX_V * MAX_V };

/* ---- lanes ---- */

#ifdef RBD_LANES
enum { LANES = RBD_LANES };
static void put(rbd_real *x, int lane, double value) { (*x)[lane] = value; }
static double get(rbd_real x, int lane) { return x[lane]; }
#else
enum { LANES = 1 };
static void put(rbd_real *x, int lane, double value) {
    (void)lane;
    *x = (rbd_real)value;
}
#ifndef SCALAR_GET
#define SCALAR_GET(x) ((double)(x))
#endif
static double get(rbd_real x, int lane) {
    (void)lane;
    return SCALAR_GET(x);
}
#endif

/* ---- a model in this scalar, and a state in each lane ---- */

static const ref_model *reference;
static const ref_state *lane_state[LANES]; /* all with the same gravity: the even ones */
static const rbd_model *model;
static rbd_work *work;
static rbd_real q[MAX_Q], v[MAX_V], a[MAX_V], tau[MAX_V], f_ext[6 * MAX_B], found[MAX_M];

static void succeed(const char *what, rbd_status status) {
    ck_assert_msg(status == RBD_OK, "%s, %s: %s", SCALAR_NAME, what, rbd_status_string(status));
}
#define RUN(call) succeed(#call, call)

static void load(const ref_state *s, int lane) {
    for (int i = 0; i < reference->nq; i++) put(&q[i], lane, s->q[i]);
    for (int i = 0; i < reference->nv; i++) {
        put(&v[i], lane, s->v[i]);
        put(&a[i], lane, s->vdot[i]);
        put(&tau[i], lane, s->tau[i]);
    }
    for (int i = 0; i < 6 * reference->nb; i++) put(&f_ext[i], lane, s->f_ext[i]);
}

static void load_lanes(int first) {
    const int even = (reference->nstates + 1) / 2;
    rbd_const gravity[3];
    for (int lane = 0; lane < LANES; lane++) {
        lane_state[lane] = &reference->states[2 * ((first + lane) % even)];
        load(lane_state[lane], lane);
    }
    for (int k = 0; k < 3; k++) gravity[k] = (rbd_const)lane_state[0]->gravity[k];
    RUN(rbd_set_gravity(work, gravity));
}

/* Runs check for every model and its states. */
static void for_models(void (*check)(void)) {
    for (int i = 0; i < reference_count; i++) {
        reference = reference_model(i);
        const size_t size = rbd_model_size(reference->bodies, reference->nb);
        void *model_memory = malloc(size);
        RUN(rbd_model_build(reference->bodies, reference->nb, model_memory, size, &model, NULL));
        void *work_memory = malloc(rbd_work_size(model));
        RUN(rbd_work_init(model, work_memory, rbd_work_size(model), &work));
        for (int first = 0; first < (reference->nstates + 1) / 2; first++) {
            load_lanes(first);
            check();
        }
        free(model_memory);
        free(work_memory);
    }
}

/* ---- comparison ---- */

static void judge(const char *what, int lane, double error, double bound) {
    const int number = (int)(lane_state[lane] - reference->states);
    bound = fmax(bound, FLOOR);
    ck_assert_msg(error <= bound, "%s, %s: %s, state %d, lane %d: error %.3g exceeds %.3g", SCALAR_NAME, what,
                  reference->name, number, lane, error, bound);
}

/* One lane of x against n numbers: largest difference, relative to the largest of them. */
static double error_of(int lane, const rbd_real *x, const double *expected, int n) {
    double difference = 0, size = 1e-3;
    for (int i = 0; i < n; i++) {
        const double value = get(x[i], lane);
        difference = larger(difference, fabs(value - expected[i]));
        size = larger(size, fabs(expected[i]));
    }
    return difference / size;
}

static void compare(const char *what, int lane, const rbd_real *x, const double *expected, int n,
                    double bound) {
    judge(what, lane, error_of(lane, x, expected, n), bound);
}

#define EACH_LANE for (int lane = 0; lane < LANES; lane++)
/* All lanes of x against a member of their states. */
#define COMPARE(what, x, member, n, bound) \
    EACH_LANE compare(what, lane, x, lane_state[lane]->member, n, bound)

/* ---- checks ---- */

static void check_inverse(void) {
    const int nv = reference->nv;
    RUN(rbd_rnea(model, work, q, v, a, NULL, found));
    COMPARE("rnea", found, tau_rnea, nv, DIRECT);
    RUN(rbd_rnea(model, work, q, v, a, f_ext, found));
    COMPARE("rnea, wrenches", found, tau_rnea_ext, nv, DIRECT);
    RUN(rbd_gravity_torque(model, work, q, found));
    COMPARE("gravity", found, g, nv, CANCELLED);
    RUN(rbd_bias(model, work, q, v, NULL, found));
    COMPARE("bias", found, c, nv, CANCELLED);
    RUN(rbd_crba(model, work, q, found));
    COMPARE("crba", found, M, nv * nv, DIRECT);
    RUN(rbd_generalized_momentum(model, work, q, v, found, NULL));
    EACH_LANE {
        double expected[MAX_V] = {0};
        for (int i = 0; i < nv * nv; i++)
            expected[i / nv] += lane_state[lane]->M[i] * lane_state[lane]->v[i % nv];
        compare("M v", lane, found, expected, nv, DIRECT);
    }
}

START_TEST(inverse_dynamics_and_mass_matrix_match_the_reference) { for_models(check_inverse); }
END_TEST

static void check_forward(void) {
    const int nv = reference->nv;
    RUN(rbd_aba(model, work, q, v, tau, NULL, found));
    COMPARE("aba", found, qdd, nv, INVERSE(lane_state[lane]->cond_M));
    RUN(rbd_aba(model, work, q, v, tau, f_ext, found));
    COMPARE("aba, wrenches", found, qdd_ext, nv, INVERSE(lane_state[lane]->cond_M));
    RUN(rbd_fd_cholesky(model, work, q, v, tau, f_ext, found));
    COMPARE("fd_cholesky, wrenches", found, qdd_ext, nv, INVERSE(lane_state[lane]->cond_M));
}

START_TEST(forward_dynamics_match_the_reference) { for_models(check_forward); }
END_TEST

/* Of every second dof, then of all but those on the world, the reference's acceleration, of the others its
   torque: both come back. */
static void check_hybrid(void) {
    static rbd_real x[MAX_V], torque[MAX_V];
    const int nv = reference->nv;
    RUN(rbd_rnea(model, work, q, v, a, f_ext, torque));
    for (int way = 0; way < 2; way++) {
        unsigned char given[MAX_V];
        for (int k = 0; k < nv; k++) {
            given[k] = way ? k % 2 == 0 : reference->bodies[rbd_dof_body(model, k)].parent >= 0;
            EACH_LANE put(given[k] ? &found[k] : &x[k], lane, 7);
            if (given[k])
                x[k] = a[k];
            else
                found[k] = torque[k];
        }
        RUN(rbd_hybrid(model, work, q, v, given, x, found, f_ext));
        COMPARE("hybrid, a", x, vdot, nv, INVERSE(lane_state[lane]->cond_M));
        COMPARE("hybrid, tau", found, tau_rnea_ext, nv, INVERSE(lane_state[lane]->cond_M));
    }
}

START_TEST(hybrid_dynamics_match_the_reference) { for_models(check_hybrid); }
END_TEST

/* M times its inverse, in the scalar's own precision. */
static void compare_with_one(const char *what, int lane, const rbd_real *M, const rbd_real *inverse) {
    static rbd_real one;
    const int nv = reference->nv;
    double error = 0;
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            put(&one, lane, i == j);
            rbd_real sum = M[i * nv] * inverse[j];
            for (int k = 1; k < nv; k++) sum = sum + M[i * nv + k] * inverse[k * nv + j];
            error = larger(error, fabs(get(sum - one, lane)));
        }
    judge(what, lane, error, INVERSE(lane_state[lane]->cond_M));
}

/* The reference's inverse has an error of its own. */
static void check_minverse(void) {
    static rbd_real M[MAX_M], L[MAX_M];
    const int nv = reference->nv;
    RUN(rbd_crba(model, work, q, M));
    RUN(rbd_minverse(model, work, q, found));
    COMPARE("minverse", found, Minv, nv * nv, fmax(1e-12, INVERSE(lane_state[lane]->cond_M)));
    EACH_LANE compare_with_one("M minverse", lane, M, found);
    RUN(rbd_cholesky_factor(model, work, M, L));
    for (int k = 0; k < nv * nv; k++) EACH_LANE put(&found[k], lane, k % (nv + 1) == 0);
    RUN(rbd_cholesky_solve_many(model, work, L, nv, found, found));
    EACH_LANE compare_with_one("M times the solutions for 1", lane, M, found);
}

START_TEST(minverse_and_many_solutions_match_the_reference) { for_models(check_minverse); }
END_TEST

/* Compared in the scalar's own precision: shows that nothing on the way is rounded to double. */
static void check_round_trip(void) {
    const int nv = reference->nv;
    static rbd_real torque[MAX_V], back[MAX_V];
    RUN(rbd_rnea(model, work, q, v, a, f_ext, torque));
    RUN(rbd_aba(model, work, q, v, torque, f_ext, back));
    EACH_LANE {
        double difference = 0, size = 1e-3;
        for (int i = 0; i < nv; i++) {
            difference = larger(difference, fabs(get(back[i] - a[i], lane)));
            size = larger(size, fabs(get(a[i], lane)));
        }
        const double bound = INVERSE(lane_state[lane]->cond_M);
        const int number = (int)(lane_state[lane] - reference->states);
        ck_assert_msg(difference / size <= bound,
                      "%s, round trip: %s, state %d, lane %d: error %.3g exceeds %.3g", SCALAR_NAME,
                      reference->name, number, lane, difference / size, bound);
    }
}

START_TEST(forward_undoes_inverse_dynamics_in_full_precision) { for_models(check_round_trip); }
END_TEST

static void check_motion(void) {
    static rbd_real R[9], p[3], velocity[6], acceleration[6], kinetic, potential, com[3], rate[3];
    RUN(rbd_kinematics(model, work, q, v, a));
    for (int i = 0; i < reference->nb; i++) {
        RUN(rbd_body_pose(model, work, i, R, p));
        RUN(rbd_body_velocity(model, work, i, velocity));
        RUN(rbd_body_acceleration(model, work, i, acceleration));
        COMPARE("R", R, body_R + 9 * i, 9, DIRECT);
        COMPARE("p", p, body_p + 3 * i, 3, 100 * DIRECT);
        COMPARE("velocity", velocity, body_vel + 6 * i, 6, 100 * DIRECT);
        COMPARE("acceleration", acceleration, body_acc + 6 * i, 6, 100 * DIRECT);
    }
    RUN(rbd_joint_wrench(model, work, q, v, a, NULL, found));
    for (int i = 0; i < reference->nb; i++)
        if (reference->bodies[i].type == RBD_FLOATING)
            EACH_LANE compare("joint wrench", lane, found + 6 * i,
                              lane_state[lane]->tau_rnea + reference->body_iv[i], 6, 100 * DIRECT);
    RUN(rbd_energy(model, work, &kinetic, &potential));
    EACH_LANE compare("kinetic energy", lane, &kinetic, &lane_state[lane]->kinetic, 1, DIRECT);
    EACH_LANE compare("potential energy", lane, &potential, &lane_state[lane]->potential, 1, CANCELLED);
    RUN(rbd_com(model, work, com, rate, NULL));
    COMPARE("com", com, com, 3, DIRECT);
    COMPARE("com velocity", rate, com_vel, 3, 10 * DIRECT);
}

START_TEST(kinematics_match_the_reference) { for_models(check_motion); }
END_TEST

/* The reference has one body in each state; the lanes share one. */
#define COMPARE_OF_BODY(what, x, member, n, bound) \
    EACH_LANE if (lane_state[lane]->jac_body == b) compare(what, lane, x, lane_state[lane]->member, n, bound)

/* Each lane has a point of its own. */
static void check_points(void) {
    static rbd_real J[6 * MAX_V], J2[6 * MAX_V], h[6], rate[6], x[6], torque[MAX_V], point[3];
    const int nv = reference->nv, b = lane_state[0]->jac_body;
    RUN(rbd_kinematics(model, work, q, v, a));
    RUN(rbd_momentum(model, work, h, rate));
    COMPARE("momentum", h, h, 6, CANCELLED);
    COMPARE("momentum rate", rate, h_dot, 6, CANCELLED);
    RUN(rbd_kinematics(model, work, q, v, NULL));
    RUN(rbd_jacobian(model, work, b, NULL, RBD_LINK_AXES, J));
    COMPARE_OF_BODY("J, link axes", J, J_local, 6 * nv, DIRECT);
    RUN(rbd_jacobian(model, work, b, NULL, RBD_WORLD_AXES, J));
    COMPARE_OF_BODY("J, world axes", J, J_world, 6 * nv, DIRECT);
    RUN(rbd_relative_jacobian(model, work, b, NULL, -1, RBD_WORLD_AXES, J));
    COMPARE_OF_BODY("J, relative to the world", J, J_world, 6 * nv, DIRECT);
    RUN(rbd_point_acceleration(model, work, b, NULL, RBD_WORLD_AXES, x));
    COMPARE_OF_BODY("dJ/dt v", x, Jdot_v_world, 6, CANCELLED);
    RUN(rbd_jacobian_derivative(model, work, b, NULL, RBD_WORLD_AXES, J));
    EACH_LANE {
        double rate[6] = {0};
        for (int i = 0; i < 6; i++)
            for (int k = 0; k < nv; k++) rate[i] += get(J[i * nv + k], lane) * lane_state[lane]->v[k];
        if (lane_state[lane]->jac_body == b) compare("dJ/dt v, by dJ/dt", lane, x, rate, 6, CANCELLED);
    }
    for (int k = 0; k < 3; k++) EACH_LANE put(&point[k], lane, 0.1 * (lane + 1) - 0.3 * k);
    RUN(rbd_jacobian(model, work, b, point, RBD_LINK_AXES, J));
    RUN(rbd_relative_jacobian(model, work, b, point, b, RBD_LINK_AXES, J2));
    RUN(rbd_point_velocity(model, work, b, point, RBD_LINK_AXES, x));
    RUN(rbd_point_wrench(model, work, b, point, RBD_LINK_AXES, x, h));
    RUN(rbd_jacobian_transpose(model, work, b, NULL, RBD_LINK_AXES, h, torque));
    EACH_LANE {
        double motion[6] = {0}, power = 0, expected;
        for (int i = 0; i < 6; i++) {
            for (int k = 0; k < nv; k++) motion[i] += get(J[i * nv + k], lane) * lane_state[lane]->v[k];
            for (int k = 0; k < nv; k++) ck_assert(fabs(get(J2[i * nv + k], lane)) <= 0);
        }
        compare("velocity of a point", lane, x, motion, 6, CANCELLED);
        expected = motion[0] * motion[0] + motion[1] * motion[1] + motion[2] * motion[2] +
                   motion[3] * motion[3] + motion[4] * motion[4] + motion[5] * motion[5];
        for (int k = 0; k < nv; k++) power += get(torque[k], lane) * lane_state[lane]->v[k];
        judge("power at a point", lane, fabs(power - expected) / (1 + expected), CANCELLED);
    }
}

START_TEST(points_match_the_reference) { for_models(check_points); }
END_TEST

/* Each lane goes a part of its own: none, all of the way, parts. */
static void check_way(const rbd_real *q1) {
    static rbd_real way[MAX_Q], expected[MAX_Q], d[MAX_V], s, distance;
    const int nq = reference->nq, nv = reference->nv;
    EACH_LANE put(&s, lane, lane % 4 * 0.375 - (lane % 4 == 3 ? 0.125 : 0));
    RUN(rbd_interpolate(model, q, q1, s, way));
    RUN(rbd_difference(model, q, q1, d));
    RUN(rbd_distance(model, q, q1, NULL, &distance));
    RUN(rbd_integrate(model, q, d, s, expected));
    EACH_LANE {
        double of[MAX_Q], sum = 0, length;
        for (int k = 0; k < nq; k++) of[k] = get(expected[k], lane);
        compare("interpolate", lane, way, of, nq, DIRECT);
        for (int k = 0; k < nv; k++) sum += get(d[k], lane) * get(d[k], lane);
        length = sqrt(sum);
        compare("distance", lane, &distance, &length, 1, DIRECT);
    }
}

static void check_steps(void) {
    static rbd_real next[MAX_Q], step[MAX_V], dt;
    EACH_LANE put(&dt, lane, lane_state[lane]->dt);
    RUN(rbd_integrate(model, q, v, dt, next));
    COMPARE("integrate", next, q_next, reference->nq, DIRECT);
    RUN(rbd_difference(model, q, next, step));
    EACH_LANE {
        double expected[MAX_V];
        for (int k = 0; k < reference->nv; k++) expected[k] = lane_state[lane]->v[k] * lane_state[lane]->dt;
        compare("difference", lane, step, expected, reference->nv, 10 * DIRECT);
    }
    check_way(next);
    RUN(rbd_rates_from_velocity(model, q, v, next));
    RUN(rbd_velocity_from_rates(model, q, next, step));
    COMPARE("velocity from rates", step, v, reference->nv, DIRECT);
}

START_TEST(integrate_and_difference_match_the_reference) { for_models(check_steps); }
END_TEST

static void check_derivatives(void) {
    const int nv = reference->nv;
    static rbd_real by_v[MAX_M], M[MAX_M];
    rbd_derivatives *d;
    void *memory = malloc(rbd_derivatives_size(model));
    RUN(rbd_derivatives_init(model, work, memory, rbd_derivatives_size(model), &d));
    RUN(rbd_id_derivatives(model, d, q, v, a, NULL, found, by_v, M));
    COMPARE("dtau/dq", found, dtau_dq, nv * nv, DIRECT);
    COMPARE("dtau/dv", by_v, dtau_dv, nv * nv, CANCELLED);
    COMPARE("M of the derivatives", M, M, nv * nv, DIRECT);
    RUN(rbd_keep_zeros(d, 1)); /* those that stand there */
    RUN(rbd_id_derivatives(model, d, q, v, a, NULL, found, by_v, NULL));
    COMPARE("dtau/dq, zeros kept", found, dtau_dq, nv * nv, DIRECT);
    COMPARE("dtau/dv, zeros kept", by_v, dtau_dv, nv * nv, CANCELLED);
    RUN(rbd_keep_zeros(d, 0));
    RUN(rbd_fd_derivatives(model, d, q, v, tau, NULL, NULL, found, by_v, M));
    COMPARE("da/dq", found, dqdd_dq, nv * nv, fmax(1e-11, INVERSE(lane_state[lane]->cond_M)));
    COMPARE("da/dv", by_v, dqdd_dv, nv * nv, fmax(1e-11, INVERSE(lane_state[lane]->cond_M)));
    COMPARE("da/dtau", M, Minv, nv * nv, fmax(1e-11, INVERSE(lane_state[lane]->cond_M)));
    static rbd_real x[MAX_V];
    for (int k = 0; k < nv; k++) x[k] = a[k];
    RUN(rbd_rnea(model, work, q, v, a, f_ext, found));
    RUN(rbd_id_free_base(model, d, q, v, x, found, f_ext));
    COMPARE("free base, a", x, vdot, nv, INVERSE(lane_state[lane]->cond_M));
    COMPARE("free base, tau", found, tau_rnea_ext, nv, INVERSE(lane_state[lane]->cond_M));
    RUN(rbd_momentum_matrix(model, d, q, NULL, found, NULL));
    COMPARE("momentum matrix", found, A_h, 6 * nv, DIRECT);
    RUN(rbd_coriolis(model, d, q, v, M));
    EACH_LANE {
        double c[MAX_V], size = 1;
        for (int i = 0; i < nv; i++) size = larger(size, fabs(lane_state[lane]->c[i]));
        for (int i = 0; i < nv; i++) {
            c[i] = lane_state[lane]->g[i] - lane_state[lane]->c[i];
            for (int k = 0; k < nv; k++) c[i] += get(M[i * nv + k] * v[k], lane);
            judge("C v = c - g", lane, isfinite(c[i]) ? fabs(c[i]) / size : HUGE_VAL, CANCELLED);
        }
    }
    static rbd_real Y[MAX_V * 10 * MAX_B], next[MAX_Q];
    RUN(rbd_regressor(model, d, q, v, a, Y));
    COMPARE("regressor", Y, Y, 10 * nv * reference->nb, DIRECT);
    RUN(rbd_integrate(model, q, v, v[0], next));
    RUN(rbd_integrate_derivatives(model, v, v[0], found, by_v));
    RUN(rbd_difference_derivatives(model, q, next, by_v, M)); /* of which the product with found is 0 */
    EACH_LANE for (int i = 0; i < nv * nv; i++) {
        double sum = get(by_v[i], lane), size = 1;
        for (int k = 0; k < nv; k++) {
            const double x = get(M[i / nv * nv + k] * found[k * nv + i % nv], lane);
            sum += x, size = larger(size, fabs(x));
        }
        judge("difference undoes integrate", lane, isfinite(sum) ? fabs(sum) / size : HUGE_VAL, 10 * DIRECT);
    }
    free(memory);
}

START_TEST(momentum_and_derivatives_match_the_reference) { for_models(check_derivatives); }
END_TEST

/* ---- outputs that may be left out ---- */

enum { OUTPUTS = 4, BETWEEN = 32 }; /* numbers between two outputs, which nobody writes */
typedef struct choice {
    const char *what;
    rbd_status (*call)(rbd_real *const *y);
    int size[OUTPUTS]; /* 0: there is none */
    int inverse;       /* whether the inverse of M is in them */
} choice;

static rbd_derivatives *derivatives;

static rbd_status of_rnea(rbd_real *const *y) {
    return rbd_id_derivatives(model, derivatives, q, v, a, f_ext, y[0], y[1], y[2]);
}
static rbd_status of_fd(rbd_real *const *y) {
    return rbd_fd_derivatives(model, derivatives, q, v, tau, f_ext, y[0], y[1], y[2], y[3]);
}
static rbd_status of_momentum_matrix(rbd_real *const *y) {
    static rbd_real must[6 * MAX_V];
    return rbd_momentum_matrix(model, derivatives, q, v, y[0] ? y[0] : must, y[1]);
}
static rbd_status of_energies(rbd_real *const *y) {
    return rbd_energy_regressors(model, derivatives, q, v, y[0], y[1]);
}
static rbd_status of_integrate(rbd_real *const *y) {
    return rbd_integrate_derivatives(model, v, a[0], y[0], y[1]);
}
static rbd_status of_difference(rbd_real *const *y) {
    return rbd_difference_derivatives(model, found, q, y[0], y[1]);
}
static rbd_status of_generalized_momentum(rbd_real *const *y) {
    return rbd_generalized_momentum(model, work, q, v, y[0], y[1]);
}
static rbd_status of_momentum(rbd_real *const *y) {
    const rbd_status status = rbd_kinematics(model, work, q, v, a);
    return status ? status : rbd_momentum(model, work, y[0], y[1]);
}

/* The outputs that are wanted, bit by bit, one behind the other, all numbers being 7 before. */
static rbd_status choose(const choice *c, int wanted, rbd_real *x) {
    rbd_real *y[OUTPUTS] = {NULL, NULL, NULL, NULL}, *at = x + BETWEEN;
    int length = BETWEEN;
    for (int k = 0; k < OUTPUTS; at += c->size[k++] + BETWEEN) {
        if (wanted >> k & 1) y[k] = at;
        length += c->size[k] + BETWEEN;
    }
    for (int i = 0; i < length; i++) EACH_LANE put(&x[i], lane, 7);
    return c->call(y);
}

/* Every choice of outputs gives what the call gives for all of them, and writes nothing else. */
static void check_choice(const choice *c) {
    static rbd_real all[OUTPUTS * (MAX_M + BETWEEN)], some[OUTPUTS * (MAX_M + BETWEEN)];
    int every = 0;
    for (int k = 0; k < OUTPUTS; k++) every |= (c->size[k] > 0) << k;
    succeed(c->what, choose(c, every, all));
    for (int wanted = 0; wanted < every; wanted++) {
        if (wanted & ~every) continue;
        succeed(c->what, choose(c, wanted, some));
        for (int k = 0, i = 0; k <= OUTPUTS; k++) {
            const int begin = i + BETWEEN, end = begin + (k < OUTPUTS ? c->size[k] : 0);
            const int written = k < OUTPUTS && wanted >> k & 1;
            for (; i < end; i++) EACH_LANE
            ck_assert_msg((written && i >= begin) || fabs(get(some[i], lane) - 7) <= 0,
                          "%s, %s: %s, outputs %d, lane %d: writes beside them", SCALAR_NAME, reference->name,
                          c->what, wanted, lane);
            EACH_LANE if (written) {
                const double bound = c->inverse ? INVERSE(lane_state[lane]->cond_M) : DIRECT;
                double size = 0, error = 0;
                for (int j = begin; j < end; j++) {
                    error = larger(error, fabs(get(some[j] - all[j], lane)));
                    size = larger(size, fabs(get(all[j], lane)));
                }
                ck_assert_msg(error <= bound * size && size < HUGE_VAL,
                              "%s, %s: %s, outputs %d, lane %d: number %d differs by %g", SCALAR_NAME,
                              reference->name, c->what, wanted, lane, k, error);
            }
        }
    }
}

static void check_choices(void) {
    const int nv = reference->nv, square = nv * nv, ten = 10 * reference->nb;
    const choice choices[] = {{"rnea_derivatives", of_rnea, {square, square, square, 0}, 0},
                              {"fd_derivatives", of_fd, {nv, square, square, square}, 1},
                              {"momentum_matrix", of_momentum_matrix, {6 * nv, 6, 0, 0}, 0},
                              {"energy_regressors", of_energies, {ten, ten, 0, 0}, 0},
                              {"integrate_derivatives", of_integrate, {square, square, 0, 0}, 0},
                              {"difference_derivatives", of_difference, {square, square, 0, 0}, 0},
                              {"generalized_momentum", of_generalized_momentum, {nv, nv, 0, 0}, 0},
                              {"momentum", of_momentum, {6, 6, 0, 0}, 0}};
    void *memory = malloc(rbd_derivatives_size(model));
    RUN(rbd_derivatives_init(model, work, memory, rbd_derivatives_size(model), &derivatives));
    RUN(rbd_integrate(model, q, v, a[0], found));
    for (int k = 0; k < (int)(sizeof choices / sizeof *choices); k++) check_choice(&choices[k]);
    free(memory);
}

START_TEST(outputs_may_be_left_out) { for_models(check_choices); }
END_TEST

/* ---- constraints ---- */

static rbd_constraint_set *set_of(const ref_constraint_set *from, void **memory) {
    rbd_constraint list[16];
    rbd_constraint_set *c;
    ck_assert_int_le(from->count, 16);
    for (int i = 0; i < from->count; i++) {
        const ref_constraint *k = &from->constraints[i];
        memset(&list[i], 0, sizeof list[i]);
        list[i].body1 = k->body1, list[i].body2 = k->body2;
        memcpy(list[i].rotation1, k->R1, sizeof k->R1);
        memcpy(list[i].position1, k->p1, sizeof k->p1);
        memcpy(list[i].rotation2, k->R2, sizeof k->R2);
        memcpy(list[i].position2, k->p2, sizeof k->p2);
        memcpy(list[i].axes, k->axes, sizeof k->axes);
    }
    *memory = malloc(rbd_constraint_set_size(model, list, from->count));
    RUN(rbd_constraint_set_init(model, work, list, from->count, *memory,
                                rbd_constraint_set_size(model, list, from->count), &c, NULL));
    return c;
}

/* Wrenches in every other lane. */
static void check_set(const ref_model *r, const ref_control_state *s, const ref_constraint_set *set) {
    static rbd_real lambda[64];
    void *memory;
    rbd_constraint_set *c = set_of(set, &memory);
    EACH_LANE {
        for (int i = 0; i < r->nq; i++) put(&q[i], lane, s->q[i]);
        for (int i = 0; i < r->nv; i++) {
            put(&v[i], lane, s->v[i]);
            put(&tau[i], lane, s->tau[i]);
        }
        for (int i = 0; i < 6 * r->nb; i++) put(&f_ext[i], lane, lane % 2 ? 0 : s->f_ext[i]);
    }
    RUN(rbd_constrained_fd(model, c, q, v, tau, f_ext, found, lambda));
    EACH_LANE {
        const double bound = fmax(FLOOR, INVERSE(s->cond_M + set->cond));
        const double a = error_of(lane, found, lane % 2 ? set->qdd_c : set->qdd_c_ext, r->nv);
        const double force = error_of(lane, lambda, lane % 2 ? set->lambda : set->lambda_ext, set->rows);
        ck_assert_int_eq(rbd_constraint_rank(c), set->rank);
        ck_assert_msg(a <= bound && force <= bound, "%s, %s: %s, lane %d: a %.3g, lambda %.3g exceed %.3g",
                      SCALAR_NAME, r->name, set->name, lane, a, force, bound);
    }
    free(memory);
}

/* Without wrenches. The reference's derivatives are good to 1.5e-13. */
static void check_set_derivatives(const ref_model *r, const ref_control_state *s,
                                  const ref_constraint_set *set) {
    static rbd_real of_a[3][40 * 40], of_lambda[3][24 * 40];
    const double *const a[3] = {set->dqdd_c_dq, set->dqdd_c_dv, set->dqdd_c_dtau}, *const lambda[3] = {
                                                                                       set->dlambda_dq,
                                                                                       set->dlambda_dv,
                                                                                       set->dlambda_dtau};
    const double bound = fmax(1e-12, INVERSE(s->cond_M + set->cond));
    void *memory, *scratch = malloc(rbd_derivatives_size(model));
    rbd_constraint_set *c = set_of(set, &memory);
    rbd_derivatives *d;
    RUN(rbd_derivatives_init(model, work, scratch, rbd_derivatives_size(model), &d));
    const rbd_constrained_fd_results results = {NULL,    NULL,         of_a[0],      of_a[1],
                                                of_a[2], of_lambda[0], of_lambda[1], of_lambda[2]};
    RUN(rbd_constrained_fd_derivatives(model, c, d, q, v, tau, NULL, &results));
    EACH_LANE {
        for (int x = 0; x < 3 && a[x]; x++) {
            const double by_a = error_of(lane, of_a[x], a[x], r->nv * r->nv),
                         by_lambda = error_of(lane, of_lambda[x], lambda[x], set->rows * r->nv);
            ck_assert_msg(by_a <= bound && by_lambda <= bound,
                          "%s, %s: %s, lane %d: derivatives %d of a %.3g, lambda %.3g exceed %.3g",
                          SCALAR_NAME, r->name, set->name, lane, x, by_a, by_lambda, bound);
        }
    }
    free(scratch);
    free(memory);
}

START_TEST(constrained_dynamics_match_the_reference) {
    for (int i = 0; i < control_count; i++) {
        const ref_control *control = reference_control(i);
        const ref_model *r = control->model;
        void *model_memory = malloc(rbd_model_size(r->bodies, r->nb));
        RUN(rbd_model_build(r->bodies, r->nb, model_memory, rbd_model_size(r->bodies, r->nb), &model, NULL));
        void *work_memory = malloc(rbd_work_size(model));
        RUN(rbd_work_init(model, work_memory, rbd_work_size(model), &work));
        for (int k = 0; k < control->nstates; k++) {
            rbd_const gravity[3];
            for (int j = 0; j < 3; j++) gravity[j] = (rbd_const)control->states[k].gravity[j];
            RUN(rbd_set_gravity(work, gravity));
            for (int j = 0; j < control->states[k].nconstraint_sets; j++) {
                check_set(r, &control->states[k], &control->states[k].constraint_sets[j]);
                check_set_derivatives(r, &control->states[k], &control->states[k].constraint_sets[j]);
            }
        }
        free(work_memory);
        free(model_memory);
    }
}
END_TEST

/* ---- models of one body ---- */

static rbd_body massive_body(rbd_joint_type type) {
    rbd_body b;
    memset(&b, 0, sizeof b);
    b.parent = -1;
    b.type = type;
    b.axis[2] = 1;
    b.mass = b.inertia[0] = b.inertia[3] = b.inertia[5] = 1;
    return b;
}

/* A tree whose branches share batches of sines: angles by cosine and sine, large ones, and sliders askew. */
START_TEST(kinematics_of_one_body_are_those_of_all) {
    enum { BODIES = 9 };
    static const rbd_joint_type types[] = {RBD_REVOLUTE, RBD_CONTINUOUS_CS, RBD_PRISMATIC};
    static unsigned char memory[RBD_MODEL_SIZE(BODIES)];
    static rbd_real R[2][9], p[2][3], neutral[MAX_Q];
    rbd_body bodies[BODIES];
    void *work_memory;
    for (int i = 0; i < BODIES; i++) {
        bodies[i] = massive_body(types[i % 3]);
        bodies[i].parent = i == 0 ? -1 : i < 6 ? 0 : i - 4;
        for (int k = 0; k < 3; k++) bodies[i].axis[k] = 1 + (i + k) % 3, bodies[i].position[k] = 0.1 * k;
    }
    RUN(rbd_model_build(bodies, BODIES, memory, sizeof memory, &model, NULL));
    work_memory = malloc(rbd_work_size(model));
    RUN(rbd_work_init(model, work_memory, rbd_work_size(model), &work));
    EACH_LANE {
        for (int i = 0, k = 0; i < BODIES; i++) {
            if (types[i % 3] == RBD_CONTINUOUS_CS) put(&q[k++], lane, cos(1.0 + i));
            put(&q[k++], lane, types[i % 3] == RBD_REVOLUTE ? 2e6 + i + lane : sin(1.0 + i));
        }
    }
    rbd_neutral(model, neutral);
    for (int i = 0; i < BODIES; i++) {
        RUN(rbd_kinematics(model, work, q, NULL, NULL));
        RUN(rbd_body_pose(model, work, i, R[0], p[0]));
        RUN(rbd_kinematics(model, work, neutral, NULL, NULL));
        RUN(rbd_body_kinematics(model, work, i, q, NULL, NULL));
        RUN(rbd_body_pose(model, work, i, R[1], p[1]));
        EACH_LANE {
            double error = 0;
            for (int k = 0; k < 9; k++) error += fabs(get(R[1][k], lane) - get(R[0][k], lane));
            for (int k = 0; k < 3; k++) error += fabs(get(p[1][k], lane) - get(p[0][k], lane));
            ck_assert_msg(error <= fmax(100 * DIRECT, FLOOR), "body %d, lane %d: error %.3g", i, lane, error);
        }
    }
    free(work_memory);
}
END_TEST

static rbd_status build(const rbd_body *bodies, int nb) {
    static unsigned char memory[RBD_MODEL_SIZE(2)];
    return rbd_model_build(bodies, nb, memory, sizeof memory, &model, NULL);
}

static void load_body(const rbd_body *body) {
    static unsigned char memory[RBD_WORK_SIZE(1, 6)];
    RUN(build(body, 1));
    RUN(rbd_work_init(model, memory, sizeof memory, &work));
}

/* Axes along and across the coordinates. */
static const double axes[4][3] = {{0, 0, 1}, {1, 0, 0}, {0.6, 0, -0.8}, {1. / 3, 2. / 3, 2. / 3}};

/* A rod of 1 kg, 1 m and this radius that turns about its own axis. */
static void load_rod(const double axis[3], double radius) {
    rbd_body b = massive_body(RBD_REVOLUTE);
    const double along = radius * radius / 2, across = (3 * radius * radius + 1) / 12;
    int entry = 0;
    for (int i = 0; i < 3; i++) {
        b.axis[i] = axis[i];
        b.com[i] = axis[i] / 2;
        for (int j = i; j < 3; j++)
            b.inertia[entry++] = (i == j ? across : 0) + (along - across) * axis[i] * axis[j];
    }
    load_body(&b);
}

static void check_rod(const char *what, rbd_status status, double expected) {
    ck_assert_msg(status == RBD_OK, "%s, %s: %s", SCALAR_NAME, what, rbd_status_string(status));
    EACH_LANE {
        const double error = fabs(get(found[0], lane) / expected - 1);
        ck_assert_msg(error <= DIRECT + 1e-8, "%s, %s: relative error %.3g", SCALAR_NAME, what, error);
    }
}

/* About its axis the rod has 1 / 170000 of its inertia across: little, but no rounding of zero. */
START_TEST(thin_rod_turns_about_its_axis) {
    const double radius = 1e-3, torque = 1e-6, expected = torque / (radius * radius / 2);
    for (int i = 0; i < 4; i++) {
        load_rod(axes[i], radius);
        EACH_LANE {
            put(&q[0], lane, 0.3 + lane);
            put(&v[0], lane, 1);
            put(&tau[0], lane, torque);
        }
        check_rod("aba", rbd_aba(model, work, q, v, tau, NULL, found), expected);
        check_rod("fd_cholesky", rbd_fd_cholesky(model, work, q, v, tau, NULL, found), expected);
    }
}
END_TEST

START_TEST(point_mass_on_the_axis_is_singular) {
    for (int i = 0; i < 4; i++) {
        rbd_body b = massive_body(RBD_REVOLUTE);
        memset(b.inertia, 0, sizeof b.inertia);
        for (int k = 0; k < 3; k++) {
            b.axis[k] = axes[i][k];
            b.com[k] = 0.7 * axes[i][k];
        }
        load_body(&b);
        EACH_LANE {
            put(&q[0], lane, 0.3 + lane);
            put(&v[0], lane, 1);
        }
        ck_assert_int_eq(rbd_aba(model, work, q, v, v, NULL, found), RBD_ERR_SINGULAR);
        ck_assert_int_eq(rbd_singular_dof(work), 0);
        ck_assert_int_eq(rbd_fd_cholesky(model, work, q, v, v, NULL, found), RBD_ERR_SINGULAR);
        ck_assert_int_eq(rbd_singular_dof(work), 0);
    }
}
END_TEST

/* The tip of an arm of two rods, held where it is: stretched, only one direction is held, in this lane
   alone. */
START_TEST(rank_may_differ_from_lane_to_lane) {
    static unsigned char model_memory[RBD_MODEL_SIZE(2)], work_memory[RBD_WORK_SIZE(2, 2)],
        memory[RBD_CONSTRAINT_SET_SIZE(2, 2)];
    const double tip[3] = {1, 0, 0};
    rbd_body arm[2] = {massive_body(RBD_REVOLUTE), massive_body(RBD_REVOLUTE)};
    rbd_constraint k = rbd_point_contact(1, tip, NULL);
    rbd_constraint_set *c;
    rbd_real lambda[2], J[4], held;
    arm[1].parent = 0;
    arm[1].position[0] = 1;
    k.axes[5] = 0;
    RUN(rbd_model_build(arm, 2, model_memory, sizeof model_memory, &model, NULL));
    RUN(rbd_work_init(model, work_memory, sizeof work_memory, &work));
    RUN(rbd_constraint_set_init(model, work, &k, 1, memory, sizeof memory, &c, NULL));
    for (int shift = 0; shift < 2; shift++) {
        EACH_LANE {
            put(&q[0], lane, 0);
            put(&q[1], lane, (lane + shift) % 2 ? 0.7 : 0);
            put(&v[0], lane, 0);
            put(&v[1], lane, 0);
            put(&tau[0], lane, 3);
            put(&tau[1], lane, -5);
        }
        RUN(rbd_constrained_fd(model, c, q, v, tau, NULL, found, lambda));
        RUN(rbd_constraint_jacobian(model, c, q, NULL, J, NULL, NULL));
        EACH_LANE {
            ck_assert_int_eq(rbd_constraint_rank(c), LANES > 1 ? 1 : 1 + shift % 2);
            for (int row = 0; row < 2; row++) {
                held = J[2 * row] * found[0] + J[2 * row + 1] * found[1];
                ck_assert(fabs(get(held, lane)) <= 1e4 * SCALAR_EPSILON + FLOOR);
            }
            ck_assert((lane + shift) % 2 || fabs(get(lambda[0], lane)) <= 1e4 * SCALAR_EPSILON + FLOOR);
            ck_assert(fabs(get(lambda[1], lane)) >= 0.1);
        }
    }
}
END_TEST

/* Results that depend on q, by every call that reads it: torque, pose, a step, the difference from the
   neutral configuration. */
static int images(const rbd_real *at, rbd_real *x) {
    static rbd_real neutral[7], next[7];
    int n = rbd_nv(model);
    for (int k = 0; k < n; k++) EACH_LANE put(&v[k], lane, 0.3 - 0.2 * k);
    RUN(rbd_neutral(model, neutral));
    RUN(rbd_rnea(model, work, at, v, v, NULL, x));
    RUN(rbd_difference(model, neutral, at, x + n));
    RUN(rbd_difference(model, at, neutral, x + 2 * n));
    RUN(rbd_integrate(model, at, v, v[0], next));
    for (int k = 0; k < rbd_nq(model); k++) x[3 * n + k] = next[k];
    n = 3 * n + rbd_nq(model);
    RUN(rbd_kinematics(model, work, at, NULL, NULL));
    RUN(rbd_body_pose(model, work, 0, x + n, x + n + 9));
    return n + 12;
}

/* The length of q from coordinate first on is a power of two times ever greater, up to the largest number:
   nothing changes, not even by rounding. */
static void stretch(rbd_joint_type type, int first) {
    const double along[4] = {0.5, -0.625, 0.375, 0.8125};
    rbd_body b = massive_body(type);
    rbd_real expected[40], stretched[40], sixteen;
    b.axis[0] = 1;
    b.com[0] = 0.2, b.com[1] = 0.5;
    load_body(&b);
    EACH_LANE {
        put(&sixteen, lane, 65536);
        for (int k = 0; k < rbd_nq(model); k++) put(&q[k], lane, k < first ? 0.7 : along[k - first]);
    }
    const int n = images(q, expected);
    for (int exponent = 16; exponent <= SCALAR_EXPONENT; exponent += 16) {
        for (int k = first; k < rbd_nq(model); k++) q[k] = q[k] * sixteen;
        images(q, stretched);
        for (int k = 0; k < n; k++)
            EACH_LANE ck_assert_msg(fabs(get(stretched[k] - expected[k], lane)) <= 0,
                                    "%s, joint type %d, 2^%d: image %d changes by %.3g", SCALAR_NAME,
                                    (int)type, exponent, k, get(stretched[k] - expected[k], lane));
    }
}

START_TEST(only_directions_count_at_any_length) {
    stretch(RBD_SPHERICAL, 0);
    stretch(RBD_FLOATING, 3);
    stretch(RBD_CONTINUOUS_CS, 0);
}
END_TEST

/* Limits whose difference overflows still have configurations between them. */
START_TEST(widest_limits_give_finite_configurations) {
    rbd_body b = massive_body(RBD_REVOLUTE);
    uint64_t seed = 5;
    int negative = 0, positive = 0;
    b.lower = -(double)SCALAR_LARGEST;
    b.upper = (double)SCALAR_LARGEST;
    load_body(&b);
    for (int i = 0; i < 1000; i++) {
        RUN(rbd_random(model, &seed, q));
        EACH_LANE {
            const double x = get(q[0], lane);
            ck_assert(isfinite(x) && fabs(x) <= b.upper);
            negative += x < 0;
            positive += x > 0;
        }
    }
    ck_assert_int_gt(negative, 300);
    ck_assert_int_gt(positive, 300);
}
END_TEST

#ifdef SCALAR_FLOAT
#define REFUSES(status, field) \
    do { \
        rbd_body b = massive_body(RBD_HELICAL); \
        b.field = 1e300; \
        ck_assert_msg(build(&b, 1) == status, "%s: %d", #field, build(&b, 1)); \
    } while (0)

/* Numbers that are finite in the description and not in the model's scalar. */
START_TEST(figures_beyond_the_scalar_are_refused) {
    REFUSES(RBD_ERR_PITCH, pitch);
    REFUSES(RBD_ERR_POSITION, position[0]);
    REFUSES(RBD_ERR_MASS, mass);
    REFUSES(RBD_ERR_COM, com[1]);
    REFUSES(RBD_ERR_INERTIA, inertia[5]);
    REFUSES(RBD_ERR_ARMATURE, armature[0]);
    REFUSES(RBD_ERR_DAMPING, damping[0]);
    REFUSES(RBD_ERR_FRICTION, friction[0]);
    REFUSES(RBD_ERR_LIMITS, lower);
    REFUSES(RBD_ERR_LIMITS, upper);
    REFUSES(RBD_ERR_LIMITS, velocity);
    REFUSES(RBD_ERR_LIMITS, effort);
}
END_TEST

/* A ratio too small for the scalar would freeze the follower. */
START_TEST(ratio_that_becomes_zero_is_refused) {
    rbd_body b[2];
    b[0] = b[1] = massive_body(RBD_REVOLUTE);
    b[0].joint = "lead";
    b[1].mimic = "lead";
    b[1].mimic_ratio = 1e-40;
    ck_assert_int_eq(build(b, 2), RBD_OK);
    b[1].mimic_ratio = -1e-60;
    ck_assert_int_eq(build(b, 2), RBD_ERR_MIMIC);
}
END_TEST
#endif

#ifdef RBD_LANES
typedef rbd_status forward_dynamics(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *tau, const rbd_real *f_ext, rbd_real *a);

/* A state without an acceleration in one lane: the call says so; zeros there, the others stand. */
static void check_bad_lane(forward_dynamics *call, double bad, rbd_status error) {
    const rbd_body gimbal = massive_body(RBD_EULER_ZYX);
    double good[3];
    load_body(&gimbal);
    for (int locked = -1; locked < LANES; locked++) {
        EACH_LANE {
            put(&q[0], lane, 0.1);
            put(&q[1], lane, lane == locked ? bad : 0.2);
            put(&q[2], lane, 0.3);
            for (int k = 0; k < 3; k++) put(&v[k], lane, 1 + k);
        }
        ck_assert_int_eq(call(model, work, q, v, v, NULL, found), locked < 0 ? RBD_OK : error);
        ck_assert((rbd_singular_dof(work) >= 0) == (locked >= 0));
        EACH_LANE for (int k = 0; k < 3; k++) {
            if (locked < 0) good[k] = get(found[k], lane);
            ck_assert(good[k] != 0);
            ck_assert(get(found[k], lane) == (lane == locked ? 0 : good[k]));
        }
    }
}

START_TEST(one_bad_lane_is_reported) {
    forward_dynamics *const calls[2] = {rbd_aba, rbd_fd_cholesky};
    for (int i = 0; i < 2; i++) {
        check_bad_lane(calls[i], 1.57079632679489661923, RBD_ERR_SINGULAR);
        check_bad_lane(calls[i], NAN, RBD_ERR_NAN);
    }
}
END_TEST

/* A step of which one lane is singular and another too fast: the first is the error, both keep their
   speed. */
START_TEST(bad_lanes_of_a_step_stay) {
    const rbd_body gimbal = massive_body(RBD_EULER_ZYX);
    rbd_real q_next[3], v_next[3];
    load_body(&gimbal);
    for (int bad = 0; bad < 4; bad++) {
        const int locked = bad & 1, fast = bad & 2;
        EACH_LANE {
            put(&q[0], lane, 0.1);
            put(&q[1], lane, lane == 0 && locked ? 1.57079632679489661923 : 0.2);
            put(&q[2], lane, 0.3);
            for (int k = 0; k < 3; k++) {
                put(&v[k], lane, 0);
                put(&tau[k], lane, lane == 1 && fast ? 1e30 : 1);
            }
        }
        ck_assert_int_eq(rbd_free_step(model, work, q, v, tau, NULL, NULL, rbdi_set(1e-3), q_next, v_next),
                         locked ? RBD_ERR_SINGULAR
                         : fast ? RBD_ERR_NAN
                                : RBD_OK);
        EACH_LANE for (int k = 0; k < 3; k++) {
            const int stays = (lane == 0 && locked) || (lane == 1 && fast);
            ck_assert(isfinite(get(v_next[k], lane)));
            ck_assert((get(v_next[k], lane) == 0) == stays);
            ck_assert(!stays || get(q_next[k], lane) == get(q[k], lane));
        }
    }
}
END_TEST
#endif

static TCase *scalar_tests(void) {
    TCase *c = tcase_create(SCALAR_NAME);
    tcase_set_timeout(c, 60);
    tcase_add_test(c, inverse_dynamics_and_mass_matrix_match_the_reference);
    tcase_add_test(c, forward_dynamics_match_the_reference);
    tcase_add_test(c, hybrid_dynamics_match_the_reference);
    tcase_add_test(c, minverse_and_many_solutions_match_the_reference);
    tcase_add_test(c, forward_undoes_inverse_dynamics_in_full_precision);
    tcase_add_test(c, kinematics_match_the_reference);
    tcase_add_test(c, kinematics_of_one_body_are_those_of_all);
    tcase_add_test(c, points_match_the_reference);
    tcase_add_test(c, integrate_and_difference_match_the_reference);
    tcase_add_test(c, momentum_and_derivatives_match_the_reference);
    tcase_add_test(c, outputs_may_be_left_out);
    tcase_add_test(c, thin_rod_turns_about_its_axis);
    tcase_add_test(c, point_mass_on_the_axis_is_singular);
    tcase_add_test(c, constrained_dynamics_match_the_reference);
    tcase_add_test(c, rank_may_differ_from_lane_to_lane);
    tcase_add_test(c, only_directions_count_at_any_length);
    tcase_add_test(c, widest_limits_give_finite_configurations);
#ifdef SCALAR_FLOAT
    tcase_add_test(c, figures_beyond_the_scalar_are_refused);
    tcase_add_test(c, ratio_that_becomes_zero_is_refused);
#endif
#ifdef RBD_LANES
    tcase_add_test(c, one_bad_lane_is_reported);
    tcase_add_test(c, bad_lanes_of_a_step_stay);
#endif
    return c;
}

#ifndef SCALAR_CLASS
static void add_more_tests(TCase *c) { (void)c; }
#else
static void add_more_tests(TCase *c);
#endif

int main(void) {
    Suite *suite = suite_create("scalars");
    TCase *c = scalar_tests();
    add_more_tests(c);
    suite_add_tcase(suite, c);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
