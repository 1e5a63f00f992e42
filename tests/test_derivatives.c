/* test_derivatives.c - rbd_derivatives.h: momentum and Coriolis matrix, derivatives of inverse dynamics. */
#include <math.h>
#include <string.h>

#include "rbd_derivatives.h"

#include "suites.h"
#include "support.h"

enum { MAX_M = MAX_V * MAX_V };
#define REFERENCE 1e-11 /* relative to the largest entry: CONTRIBUTING.md */
/* Differences of order 8: rounding over the step h, and h^8 times a ninth derivative. One joint at a time,
   and all along v, where angles add up that turn faster. */
#define H_ONE 0.02
#define H_ALL 0.004
#define BY_ONE 1e-11
#define BY_ALL 1e-9

static void *d_memory;

static rbd_derivatives *derivatives_of(const robot *r) {
    const size_t size = rbd_derivatives_size(r->m);
    rbd_derivatives *d;
    d_memory = malloc(size); /* exact, so that a sanitizer sees the byte beyond */
    memset(d_memory, 0xff, size);
    ck_assert_int_eq(rbd_derivatives_init(r->m, r->w, d_memory, size, &d), RBD_OK);
    return d;
}

/* ---- against the references ---- */

static void parameters(const robot *r, double *pi) {
    for (int b = 0; b < r->nb; b++) ck_assert_int_eq(rbd_body_parameters(r->m, b, pi + 10 * b), RBD_OK);
}

static void check_regressors(const robot *r, rbd_derivatives *d, const ref_control_state *s, int number) {
    const int nv = r->nv, n = 10 * r->nb;
    static double Y[MAX_V * 10 * MAX_BODIES + 1];
    double kinetic[10 * MAX_BODIES], potential[10 * MAX_BODIES];
    Y[nv * n] = 7; /* behind it */
    RUN(rbd_regressor(r->m, d, s->q, s->v, s->vdot, Y));
    ck_assert_double_eq(Y[nv * n], 7);
    if (s->Y) expect_close("regressor", r, number, Y, s->Y, nv * n, REFERENCE);
    RUN(rbd_energy_regressors(r->m, d, s->q, s->v, kinetic, potential));
    expect_close("kinetic regressor", r, number, kinetic, s->Y_kinetic, n, REFERENCE);
    expect_close("potential regressor", r, number, potential, s->Y_potential, n, REFERENCE);
    RUN(rbd_energy_regressors(r->m, d, s->q, s->v, Y, NULL));
    expect_close("kinetic regressor alone", r, number, Y, kinetic, n, 0);
    RUN(rbd_energy_regressors(r->m, d, s->q, NULL, NULL, Y));
    expect_close("potential regressor alone", r, number, Y, potential, n, 0);
}

static void check_control(const robot *r, const ref_control_state *s, int number) {
    const int nv = r->nv;
    rbd_derivatives *d = derivatives_of(r);
    double by_q[MAX_M], by_v[MAX_M], M[MAX_M], out[6];
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->vdot, NULL, by_q, by_v, M));
    expect_close("dtau/dq", r, number, by_q, s->dtau_dq, nv * nv, REFERENCE);
    expect_close("dtau/dv", r, number, by_v, s->dtau_dv, nv * nv, REFERENCE);
    expect_close("M of the derivatives", r, number, M, s->M, nv * nv, REFERENCE);
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->vdot, s->f_ext, by_q, by_v, NULL));
    expect_close("dtau/dq, wrenches", r, number, by_q, s->dtau_dq_ext, nv * nv, REFERENCE);
    expect_close("dtau/dv, wrenches", r, number, by_v, s->dtau_dv_ext, nv * nv, REFERENCE);
    RUN(rbd_coriolis(r->m, d, s->q, s->v, M));
    expect_close("coriolis", r, number, M, s->C, nv * nv, REFERENCE);
    RUN(rbd_momentum_matrix(r->m, d, s->q, s->v, M, out));
    expect_close("momentum matrix", r, number, M, s->A_h, 6 * nv, REFERENCE);
    expect_close("momentum bias", r, number, out, s->A_h_dot_v, 6, REFERENCE);
    RUN(rbd_com_jacobian(r->m, d, s->q, M));
    expect_close("com jacobian", r, number, M, s->J_com, 3 * nv, REFERENCE);
    check_regressors(r, d, s, number);
    RUN(rbd_integrate_derivatives(r->m, s->integrate_d, 1, by_q, by_v));
    expect_close("integrate by q", r, number, by_q, s->integrate_d_dq, nv * nv, REFERENCE);
    expect_close("integrate by d", r, number, by_v, s->integrate_d_dd, nv * nv, REFERENCE);
    RUN(rbd_difference_derivatives(r->m, s->q, s->difference_q1, by_q, by_v));
    expect_close("difference by q0", r, number, by_q, s->difference_d_dq0, nv * nv, REFERENCE);
    expect_close("difference by q1", r, number, by_v, s->difference_d_dq1, nv * nv, REFERENCE);
    free(d_memory);
}

START_TEST(results_match_the_control_data) { for_control_states(check_control); }
END_TEST

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const int nv = model->nv;
    rbd_derivatives *d = derivatives_of(r);
    double by_q[MAX_M], by_v[MAX_M];
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->vdot, NULL, by_q, by_v, NULL));
    expect_close("dtau/dq", r, number, by_q, s->dtau_dq, nv * nv, REFERENCE);
    expect_close("dtau/dv", r, number, by_v, s->dtau_dv, nv * nv, REFERENCE);
    free(d_memory);
}

START_TEST(derivatives_match_the_reference) { for_reference_states(check_reference); }
END_TEST

static void expect_forward(const robot *r, const double *q, const double *v, const double *tau,
                           const double *f_ext, int number, const double *const expected[4],
                           double condition) {
    const char *const what[4] = {"a", "da/dq", "da/dv", "da/dtau"};
    static double x[4][MAX_M];
    rbd_derivatives *d = derivatives_of(r);
    memset(x, 0xff, sizeof x); /* as double: NaN */
    RUN(rbd_fd_derivatives(r->m, d, q, v, tau, f_ext, x[0], x[1], x[2], x[3]));
    for (int k = 0; k < 4; k++)
        expect_close(what[k], r, number, x[k], expected[k], k == 0 ? r->nv : r->nv * r->nv,
                     inverse_bound(condition));
    free(d_memory);
}

static void check_forward_control(const robot *r, const ref_control_state *s, int number) {
    const double *const plain[4] = {s->qdd, s->dqdd_dq, s->dqdd_dv, s->Minv};
    const double *const pushed[4] = {s->qdd_ext, s->dqdd_dq_ext, s->dqdd_dv_ext, s->Minv};
    expect_forward(r, s->q, s->v, s->tau, NULL, number, plain, s->cond_M);
    expect_forward(r, s->q, s->v, s->tau, s->f_ext, number, pushed, s->cond_M);
}

START_TEST(forward_derivatives_match_the_control_data) { for_control_states(check_forward_control); }
END_TEST

static void check_forward_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const double *const expected[4] = {s->qdd, s->dqdd_dq, s->dqdd_dv, s->Minv};
    (void)model;
    expect_forward(r, s->q, s->v, s->tau, NULL, number, expected, s->cond_M);
}

START_TEST(forward_derivatives_match_the_reference) { for_reference_states(check_forward_reference); }
END_TEST

/* ---- on random trees of every joint type, with mimic joints, rotors and several roots ---- */

/* d/dt at 0 of a function of the configuration q moved by t step: differences of order 8. */
typedef void image(const robot *r, const state *s, const double *q, double *out);
static void differentiate(const robot *r, const state *s, const double *step, double h, image *f, int n,
                          double *out) {
    const double weight[4] = {4. / 5, -1. / 5, 4. / 105, -1. / 280};
    static double ahead[MAX_M], behind[MAX_M];
    double q[MAX_Q];
    for (int i = 0; i < n; i++) out[i] = 0;
    for (int k = 0; k < 4; k++) {
        ck_assert_int_eq(rbd_integrate(r->m, s->q, step, (k + 1) * h, q), RBD_OK);
        f(r, s, q, ahead);
        ck_assert_int_eq(rbd_integrate(r->m, s->q, step, -(k + 1) * h, q), RBD_OK);
        f(r, s, q, behind);
        for (int i = 0; i < n; i++) out[i] += weight[k] / h * (ahead[i] - behind[i]);
    }
}

static void torque(const robot *r, const state *s, const double *q, double *out) {
    ck_assert_int_eq(rbd_rnea(r->m, r->w, q, s->v, s->a, s->f_ext, out), RBD_OK);
}
static void gravity_torque(const robot *r, const state *s, const double *q, double *out) {
    (void)s;
    ck_assert_int_eq(rbd_gravity_torque(r->m, r->w, q, out), RBD_OK);
}
static void mass_matrix(const robot *r, const state *s, const double *q, double *out) {
    (void)s;
    ck_assert_int_eq(rbd_crba(r->m, r->w, q, out), RBD_OK);
}

static void put_column(double *out, int nv, int k, const double *x) {
    for (int i = 0; i < nv; i++) out[i * nv + k] = x[i];
}

/* tau is of second degree in v: a difference of any step is exact. */
static void velocity_differences(const robot *r, const state *s, double *out) {
    state moved = *s;
    double ahead[MAX_V], behind[MAX_V];
    for (int k = 0; k < r->nv; k++) {
        moved.v[k] = s->v[k] + 1;
        torque(r, &moved, s->q, ahead);
        moved.v[k] = s->v[k] - 1;
        torque(r, &moved, s->q, behind);
        moved.v[k] = s->v[k];
        for (int i = 0; i < r->nv; i++) ahead[i] = (ahead[i] - behind[i]) / 2;
        put_column(out, r->nv, k, ahead);
    }
}

static void check_derivatives(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    static double by_q[MAX_M], by_v[MAX_M], M[MAX_M], expected[MAX_M];
    double column[MAX_V], step[MAX_V] = {0};
    rbd_derivatives *d = derivatives_of(r);
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->a, s->f_ext, by_q, by_v, M));
    velocity_differences(r, s, expected);
    expect_close("dtau/dv, differences", r, number, by_v, expected, nv * nv, 1e-12);
    RUN(rbd_crba(r->m, r->w, s->q, expected));
    expect_close("M of the derivatives", r, number, M, expected, nv * nv, 1e-13);
    for (int k = 0; k < nv; k++) {
        step[k] = 1;
        differentiate(r, s, step, H_ONE, torque, nv, column);
        step[k] = 0;
        put_column(expected, nv, k, column);
    }
    expect_close("dtau/dq, differences", r, number, by_q, expected, nv * nv, BY_ONE);
    free(d_memory);
}

START_TEST(derivatives_match_differences_on_random_trees) { for_random_trees(150, check_derivatives); }
END_TEST

/* M da/dx = -dtau/dx at the a of aba; each alone gives what it gives with the others, and a may be tau or v.
   Where the system is singular, all is zero. */
static void check_forward(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    static double x[3][MAX_M], by[2][MAX_M], product[MAX_M], M[MAX_M], alone[MAX_M];
    double a[MAX_V], own[MAX_V], aba[MAX_V];
    tb_real expected[TB_MAX_DOFS];
    rbd_derivatives *d = derivatives_of(r);
    const tb_real condition =
        tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, expected);
    const int regular = condition > 0 && condition < 1e10L;
    memcpy(own, s->tau, sizeof own);
    const rbd_status status = rbd_fd_derivatives(r->m, d, s->q, s->v, s->tau, s->f_ext, a, x[0], x[1], x[2]);
    ck_assert(status == RBD_OK || (status == RBD_ERR_SINGULAR && !regular));
    for (int k = 0; k < 3; k++) {
        double *const to[3] = {k == 0 ? alone : NULL, k == 1 ? alone : NULL, k == 2 ? alone : NULL};
        ck_assert_int_eq(rbd_fd_derivatives(r->m, d, s->q, s->v, s->tau, s->f_ext, NULL, to[0], to[1], to[2]),
                         status);
        expect_close("fd_derivatives, one of them", r, number, alone, x[k], nv * nv, 0);
        if (status) ck_assert_msg(largest(x[k], nv * nv) == 0, "%s: not zero", r->name);
    }
    ck_assert_int_eq(rbd_fd_derivatives(r->m, d, s->q, s->v, own, s->f_ext, own, NULL, NULL, NULL), status);
    expect_close("fd_derivatives, a = tau", r, number, own, a, nv, 0);
    memcpy(own, s->v, sizeof own);
    ck_assert_int_eq(rbd_fd_derivatives(r->m, d, s->q, own, s->tau, s->f_ext, own, by[0], by[1], NULL),
                     status);
    expect_close("fd_derivatives, a = v", r, number, own, a, nv, 0);
    expect_close("da/dq, a = v", r, number, by[0], x[0], nv * nv, 0);
    expect_close("da/dv, a = v", r, number, by[1], x[1], nv * nv, 0);
    if (regular) {
        const double bound = inverse_bound((double)condition);
        RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, aba));
        expect_close("a of the derivatives", r, number, a, aba, nv, bound);
        RUN(rbd_id_derivatives(r->m, d, s->q, s->v, a, s->f_ext, by[0], by[1], M));
        for (int k = 0; k < 2; k++) {
            for (int j = 0; j < nv * nv; j++) {
                product[j] = 0;
                for (int i = 0; i < nv; i++) product[j] -= M[j / nv * nv + i] * x[k][i * nv + j % nv];
            }
            expect_close("-M da/dx = dtau/dx", r, number, product, by[k], nv * nv, bound);
        }
        RUN(rbd_minverse(r->m, r->w, s->q, product));
        expect_close("da/dtau = M^-1", r, number, x[2], product, nv * nv, bound);
    }
    free(d_memory);
}

START_TEST(forward_derivatives_on_random_trees) { for_random_trees(150, check_forward); }
END_TEST

/* A free base that all hangs on, with rotors: at its shifts they feel v_dot, not its sum with w x v. */
START_TEST(free_base_may_have_rotors) {
    for (int dof = 0; dof < 6; dof++) {
        rbd_body bodies[MAX_BODIES];
        uint64_t seed = 5;
        state s;
        memset(bodies, 0, sizeof bodies);
        for (int i = 0; i < 3; i++) {
            random_joint(&seed, bodies, i, i ? RBD_REVOLUTE : RBD_FLOATING);
            random_mass(&seed, &bodies[i]);
            bodies[i].parent = i - 1;
        }
        bodies[0].armature[dof] = 0.5;
        robot r = robot_build("base with a rotor", bodies, 3);
        draw_state(&r, &seed, &s);
        check_forward(&r, &s, dof);
        check_derivatives(&r, &s, dof);
        robot_free(&r);
    }
}
END_TEST

/* Legs of two joints, hips before knees in the description, in order or with neighbours' knees exchanged. */
START_TEST(limbs_may_be_alike) {
    for (int crossed = 0; crossed < 2; crossed++) {
        static rbd_body bodies[MAX_BODIES];
        uint64_t seed = 7;
        state s;
        memset(bodies, 0, sizeof bodies);
        for (int i = 0; i < 17; i++) {
            random_joint(&seed, bodies, i, i ? RBD_REVOLUTE : RBD_FLOATING);
            random_mass(&seed, &bodies[i]);
            bodies[i].parent = i == 0 ? -1 : i < 9 ? 0 : 1 + ((i - 9) ^ crossed);
        }
        robot r = robot_build("limbs alike", bodies, 17);
        draw_state(&r, &seed, &s);
        check_forward(&r, &s, crossed);
        check_derivatives(&r, &s, crossed);
        robot_free(&r);
    }
}
END_TEST

static void check_gravity(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    static double by_q[MAX_M], expected[MAX_M], same[MAX_M], by_v[MAX_M], zero[MAX_M];
    double column[MAX_V], step[MAX_V] = {0}, rest[MAX_V] = {0};
    rbd_derivatives *d = derivatives_of(r);
    RUN(rbd_gravity_torque_derivatives(r->m, d, s->q, by_q));
    for (int k = 0; k < nv; k++) {
        step[k] = 1;
        differentiate(r, s, step, H_ONE, gravity_torque, nv, column);
        step[k] = 0;
        put_column(expected, nv, k, column);
    }
    expect_close("dg/dq, differences", r, number, by_q, expected, nv * nv, BY_ONE);
    RUN(rbd_id_derivatives(r->m, d, s->q, rest, rest, NULL, same, by_v, NULL));
    expect_close("dg/dq", r, number, by_q, same, nv * nv, 0);
    expect_close("dtau/dv at rest", r, number, by_v, zero, nv * nv, 0);
    free(d_memory);
}

START_TEST(gravity_derivatives_match_differences) { for_random_trees(60, check_gravity); }
END_TEST

/* C v = c - g, and dM/dt = C + C'. */
static void check_coriolis(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    static double C[MAX_M], sum[MAX_M], rate[MAX_M];
    double found[MAX_V], expected[MAX_V], g[MAX_V];
    rbd_derivatives *d = derivatives_of(r);
    RUN(rbd_coriolis(r->m, d, s->q, s->v, C));
    multiply(C, s->v, nv, nv, found);
    RUN(rbd_bias(r->m, r->w, s->q, s->v, NULL, expected));
    RUN(rbd_gravity_torque(r->m, r->w, s->q, g));
    for (int i = 0; i < nv; i++) expected[i] -= g[i];
    expect_close("C v", r, number, found, expected, nv, 1e-11);
    for (int i = 0; i < nv * nv; i++) sum[i] = C[i] + C[i % nv * nv + i / nv];
    differentiate(r, s, s->v, H_ALL, mass_matrix, nv * nv, rate);
    expect_close("C + C' = dM/dt", r, number, sum, rate, nv * nv, BY_ALL);
    free(d_memory);
}

START_TEST(coriolis_matrix_is_one) { for_random_trees(150, check_coriolis); }
END_TEST

/* Of a, given but on the floating joints of the world, and of the torque of these that goes with it the rest
   comes back; or the error of rbd_hybrid. */
static void expect_free_base(const robot *r, const state *s, int number, const double *torque,
                             double condition) {
    const int nv = r->nv;
    double a[MAX_V], tau[MAX_V], x[MAX_V], y[MAX_V];
    unsigned char given[MAX_V];
    rbd_derivatives *d = derivatives_of(r);
    for (int k = 0; k < nv; k++) {
        const rbd_body *body = &r->bodies[rbd_dof_body(r->m, k)];
        int parent = body->parent;
        while (parent >= 0 && r->bodies[parent].type == RBD_FIXED) parent = r->bodies[parent].parent;
        given[k] = parent >= 0 || body->type != RBD_FLOATING;
        a[k] = x[k] = given[k] ? s->a[k] : (double)NAN;
        tau[k] = y[k] = given[k] ? (double)NAN : torque[k];
    }
    const rbd_status status = rbd_hybrid(r->m, r->w, s->q, s->v, given, x, y, s->f_ext);
    const int dof = rbd_singular_dof(r->w);
    ck_assert_int_eq(rbd_id_free_base(r->m, d, s->q, s->v, a, tau, s->f_ext), status);
    ck_assert_int_eq(rbd_singular_dof(r->w), dof);
    free(d_memory);
    if (status != RBD_OK) {
        ck_assert(largest(a, nv) == 0 && largest(tau, nv) == 0);
        return;
    }
    for (int k = 0; k < nv; k++)
        ck_assert(given[k] ? memcmp(&a[k], &s->a[k], sizeof *a) == 0
                           : memcmp(&tau[k], &torque[k], sizeof *a) == 0);
    expect_close("free base, tau", r, number, tau, torque, nv, 1e-11);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, a, s->f_ext, x));
    expect_close("free base, tau of a", r, number, x, torque, nv, 1e-11);
    if (condition > 0) expect_close("free base, a", r, number, a, s->a, nv, fmax(1e-11, 1e-15 * condition));
}

static void check_free_base(const robot *r, const state *s, int number) {
    double tau[MAX_V];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, tau));
    expect_free_base(r, s, number, tau, 0);
}

static void check_free_base_reference(const robot *r, const ref_model *model, const ref_state *s,
                                      int number) {
    state x;
    (void)model;
    memcpy(x.q, s->q, (size_t)r->nq * sizeof *s->q);
    memcpy(x.v, s->v, (size_t)r->nv * sizeof *s->v);
    memcpy(x.a, s->vdot, (size_t)r->nv * sizeof *s->vdot);
    memcpy(x.f_ext, s->f_ext, (size_t)r->nb * 6 * sizeof *s->f_ext);
    expect_free_base(r, &x, number, s->tau_rnea_ext, s->cond_M);
}

START_TEST(a_free_base_matches_the_reference) { for_reference_states(check_free_base_reference); }
END_TEST

START_TEST(a_free_base_gives_way) { for_random_trees(150, check_free_base); }
END_TEST

/* A point on a stick turns freely about it: the base without a wrench has no acceleration. */
START_TEST(a_free_base_may_be_singular) {
    const rbd_body point[2] = {
        {.parent = -1, .type = RBD_FLOATING, .mass = 1, .com = {0.1, 0.2, 0.3}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {0.4, 0.5, 0.6}}};
    robot r = BUILD(point);
    rbd_derivatives *d = derivatives_of(&r);
    const double q[8] = {0, 0, 0, 0, 0, 0, 1, 0.3};
    double v[7] = {0}, a[7] = {1, 1, 1, 1, 1, 1, 1}, tau[7] = {1};
    ck_assert_int_eq(rbd_id_free_base(r.m, d, q, v, a, tau, NULL), RBD_ERR_SINGULAR);
    ck_assert(largest(a, 7) == 0 && largest(tau, 7) == 0);
    free(d_memory);
    robot_free(&r);
}
END_TEST

/* Centroidal momentum, body by body, from the textbook's motion. */
static void textbook_momentum(const robot *r, const double *q, const double *v, double h[6]) {
    static tb_motion motion;
    const double none[3] = {0, 0, 0}, rest[MAX_V] = {0};
    tb_real tau[TB_MAX_DOFS], sum[6] = {0};
    tb_rnea(r->bodies, r->nb, none, q, v, rest, NULL, tau, &motion);
    for (int b = 0; b < r->nb; b++) {
        const rbd_body *body = &r->bodies[b];
        const double *I = body->inertia, *c = body->com;
        const tb_real *w = motion.velocity[b], *u = w + 3, *R = motion.R[b];
        const tb_real p[3] = {(u[0] + w[1] * c[2] - w[2] * c[1]) * body->mass,
                              (u[1] + w[2] * c[0] - w[0] * c[2]) * body->mass,
                              (u[2] + w[0] * c[1] - w[1] * c[0]) * body->mass};
        const tb_real l[3] = {I[0] * w[0] + I[1] * w[1] + I[2] * w[2],
                              I[1] * w[0] + I[3] * w[1] + I[4] * w[2],
                              I[2] * w[0] + I[4] * w[1] + I[5] * w[2]};
        tb_real at[3], f[3];
        for (int i = 0; i < 3; i++) {
            at[i] =
                motion.p[b][i] - motion.com[i] + R[3 * i] * c[0] + R[3 * i + 1] * c[1] + R[3 * i + 2] * c[2];
            f[i] = R[3 * i] * p[0] + R[3 * i + 1] * p[1] + R[3 * i + 2] * p[2];
            sum[i] += R[3 * i] * l[0] + R[3 * i + 1] * l[1] + R[3 * i + 2] * l[2];
            sum[3 + i] += f[i];
        }
        for (int i = 0; i < 3; i++)
            sum[i] += at[(i + 1) % 3] * f[(i + 2) % 3] - at[(i + 2) % 3] * f[(i + 1) % 3];
    }
    for (int i = 0; i < 6; i++) h[i] = (double)sum[i];
}

static void momentum(const robot *r, const state *s, const double *q, double *h) {
    textbook_momentum(r, q, s->v, h);
}

static void check_momentum(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    static double A[6 * MAX_V], J[6 * MAX_V];
    double h[6], expected[6], bias[6], mass;
    rbd_derivatives *d = derivatives_of(r);
    RUN(rbd_momentum_matrix(r->m, d, s->q, s->v, A, bias));
    multiply(A, s->v, 6, nv, h);
    momentum(r, s, s->q, expected);
    expect_close("A v", r, number, h, expected, 6, 1e-12);
    differentiate(r, s, s->v, H_ALL, momentum, 6, expected);
    expect_close("dA/dt v", r, number, bias, expected, 6, BY_ALL);
    RUN(rbd_com_jacobian(r->m, d, s->q, J));
    mass = rbd_mass(r->m);
    for (int i = 0; i < 3 * nv; i++) J[i] *= mass;
    expect_close("m J_com", r, number, J, A + 3 * nv, 3 * nv, 1e-14);
    RUN(rbd_momentum_matrix(r->m, d, s->q, NULL, J, NULL));
    expect_close("A without v", r, number, J, A, 6 * nv, 0);
    free(d_memory);
}

START_TEST(momentum_is_that_of_the_bodies) { for_random_trees(100, check_momentum); }
END_TEST

/* tau = Y pi + armature a, and the energies likewise. */
static void check_identification(const robot *r, const state *s, int number) {
    const int nv = r->nv, n = 10 * r->nb;
    static double Y[MAX_V * 10 * MAX_BODIES];
    double pi[10 * MAX_BODIES], found[MAX_V], expected[MAX_V], kinetic, potential, none[MAX_V] = {0},
                                                                                   q[MAX_V];
    const double rest[3] = {0, 0, 0};
    rbd_derivatives *d = derivatives_of(r);
    parameters(r, pi);
    RUN(rbd_regressor(r->m, d, s->q, s->v, s->a, Y));
    multiply(Y, pi, nv, n, found);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, NULL, expected));
    for (int b = 0, k = 0; b < r->nb; b++) /* of those that do not mimic */
        for (int j = 0; j < tb_nv(&r->bodies[b]); j++, k++) found[k] += r->bodies[b].armature[j] * s->a[k];
    for (int b = 0; b < r->nb; b++)
        if (r->bodies[b].mimic) {
            int source = 0;
            rbd_joint_info info;
            while (!r->bodies[source].joint || strcmp(r->bodies[source].joint, r->bodies[b].mimic)) source++;
            RUN(rbd_joint(r->m, source, &info));
            found[info.iv] += r->bodies[b].armature[0] * s->a[info.iv] * r->bodies[b].mimic_ratio *
                              r->bodies[b].mimic_ratio;
        }
    expect_close("Y pi", r, number, found, expected, nv, 1e-12);
    RUN(rbd_energy_regressors(r->m, d, s->q, s->v, Y, Y + n));
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_energy(r->m, r->w, &kinetic, &potential));
    kinetic -= dot(Y, pi, n); /* what is left is the rotors' */
    RUN(rbd_set_gravity(r->w, rest));
    RUN(rbd_rnea(r->m, r->w, s->q, none, s->v, NULL, expected));
    RUN(rbd_regressor(r->m, d, s->q, none, s->v, Y + 2 * n));
    multiply(Y + 2 * n, pi, nv, n, q);
    for (int i = 0; i < nv; i++) kinetic -= (expected[i] - q[i]) * s->v[i] / 2;
    expect_small("Y_kinetic pi", r, number, kinetic / (1 + dot(Y, pi, n)), 1e-12);
    expect_close("Y_potential pi", r, number, (const double[]){dot(Y + n, pi, n)}, &potential, 1, 1e-11);
    free(d_memory);
}

START_TEST(torques_and_energies_are_linear_in_the_parameters) { for_random_trees(100, check_identification); }
END_TEST

/* Also with a body that is fixed to the world. */
START_TEST(energies_with_a_body_on_the_world) {
    static const rbd_body bodies[] = {
        {.parent = -1,
         .position = {0.1, 0.2, 0.3},
         .mass = 2,
         .com = {0, 0.1, 0},
         .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, -1}}};
    robot r = BUILD(bodies);
    uint64_t seed = 3;
    state s;
    draw_state(&r, &seed, &s);
    check_identification(&r, &s, 0);
    robot_free(&r);
}
END_TEST

/* ---- steps ---- */

/* A step along v of any length, and back: by the chain rule, d(q, q (+) d) = d is the same for all d and q.
   */
static void check_steps(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    static double next_q[MAX_M], next_v[MAX_M], back_0[MAX_M], back_1[MAX_M], found[MAX_M], one[MAX_M];
    double q1[MAX_Q];
    const double lengths[6] = {0, 1e-9, 1e-4, 0.1, 0.45, 0.9}; /* of turns that come back */
    for (int i = 0; i < nv * nv; i++) one[i] = i % (nv + 1) == 0;
    for (int l = 0; l < 6; l++) {
        const double dt = lengths[l];
        RUN(rbd_integrate_derivatives(r->m, s->v, dt, next_q, next_v));
        RUN(rbd_integrate(r->m, s->q, s->v, dt, q1));
        RUN(rbd_difference_derivatives(r->m, s->q, q1, back_0, back_1));
        for (int i = 0; i < nv; i++)
            for (int j = 0; j < nv; j++) {
                double v = 0, q = back_0[i * nv + j];
                for (int k = 0; k < nv; k++) {
                    v += back_1[i * nv + k] * next_v[k * nv + j];
                    q += back_1[i * nv + k] * next_q[k * nv + j];
                }
                found[i * nv + j] = v - (i == j ? dt : 0) + one[i * nv + j];
                expect_small("difference after integrate, by q", r, number, q, 1e-12);
            }
        expect_close("difference after integrate, by v", r, number, found, one, nv * nv, 1e-12);
    }
}

START_TEST(steps_come_back) { for_random_trees(40, check_steps); }
END_TEST

/* Columns of both against differences. */
static void check_step_columns(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    const double h = 0.02, weight[4] = {4. / 5, -1. / 5, 4. / 105, -1. / 280};
    static double by_q[MAX_M], by_v[MAX_M], expected_q[MAX_M], expected_v[MAX_M];
    double q1[MAX_Q], moved[MAX_Q], v[MAX_V], step[MAX_V] = {0}, d[MAX_V];
    RUN(rbd_integrate_derivatives(r->m, s->v, 0.3, by_q, by_v));
    RUN(rbd_integrate(r->m, s->q, s->v, 0.3, q1));
    memset(expected_q, 0, sizeof expected_q);
    memset(expected_v, 0, sizeof expected_v);
    for (int k = 0; k < nv; k++)
        for (int j = -4; j <= 4; j++) {
            if (j == 0) continue;
            const double factor = (j > 0 ? 1 : -1) * weight[abs(j) - 1] / h;
            step[k] = 1;
            RUN(rbd_integrate(r->m, s->q, step, j * h, moved));
            step[k] = 0;
            RUN(rbd_integrate(r->m, moved, s->v, 0.3, moved));
            RUN(rbd_difference(r->m, q1, moved, d));
            for (int i = 0; i < nv; i++) expected_q[i * nv + k] += factor * d[i];
            memcpy(v, s->v, sizeof v);
            v[k] += j * h;
            RUN(rbd_integrate(r->m, s->q, v, 0.3, moved));
            RUN(rbd_difference(r->m, q1, moved, d));
            for (int i = 0; i < nv; i++) expected_v[i * nv + k] += factor * d[i];
        }
    expect_close("integrate by q, differences", r, number, by_q, expected_q, nv * nv, BY_ONE);
    expect_close("integrate by v, differences", r, number, by_v, expected_v, nv * nv, BY_ONE);
}

START_TEST(step_derivatives_match_differences) { for_random_trees(40, check_step_columns); }
END_TEST

/* ---- inertial parameters ---- */

START_TEST(parameters_and_back) {
    uint64_t seed = 5;
    for (int number = 0; number < 100; number++) {
        rbd_body body[1], again = {.parent = -1};
        double pi[10];
        random_joint(&seed, body, 0, RBD_FLOATING);
        random_mass(&seed, body);
        struct robot one = BUILD(body), *r = &one;
        RUN(rbd_body_parameters(r->m, 0, pi));
        RUN(rbd_check_parameters(pi));
        RUN(rbd_set_parameters(&again, pi));
        expect_close("mass", r, number, &again.mass, &body->mass, 1, 1e-15);
        expect_close("com", r, number, again.com, body->com, 3, 1e-14);
        expect_close("inertia", r, number, again.inertia, body->inertia, 6, 1e-13);
        robot_free(r);
    }
}
END_TEST

/* A payload taken off, and rotors without a body. */
START_TEST(parameters_without_or_with_negative_mass) {
    const double off[10] = {-2, 1, 0, -0.5, 1, 0, 0, 1, 0, 1}, rotor[10] = {0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
    rbd_body body = {.parent = -1};
    ck_assert_int_eq(rbd_set_parameters(&body, off), RBD_OK);
    ck_assert(body.mass == -2 && body.com[0] == -0.5 && body.com[1] == 0 && body.com[2] == 0.25);
    ck_assert_int_eq(rbd_set_parameters(&body, rotor), RBD_OK);
    ck_assert(body.mass == 0 && body.com[0] == 0 && body.com[2] == 0 && body.inertia[0] == 1);
}
END_TEST

START_TEST(no_mass_has_no_centre) {
    const rbd_body rotor[1] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}}};
    const double q[1] = {0.3};
    double J[3] = {1, 1, 1};
    struct robot one = BUILD(rotor), *r = &one;
    rbd_derivatives *d = derivatives_of(r);
    ck_assert_int_eq(rbd_com_jacobian(r->m, d, q, J), RBD_OK);
    ck_assert(J[0] == 0 && J[1] == 0 && J[2] == 0);
    free(d_memory);
    robot_free(r);
}
END_TEST

static int status_of(double m, double x, double y, double z, double xx, double xy, double xz, double yy,
                     double yz, double zz) {
    const double pi[10] = {m, x, y, z, xx, xy, xz, yy, yz, zz};
    return rbd_check_parameters(pi);
}

START_TEST(what_no_body_can_have_is_refused) {
    ck_assert_int_eq(rbd_check_parameters(NULL), RBD_ERR_NULL);
    ck_assert_int_eq(status_of(0, 0, 0, 0, 0, 0, 0, 0, 0, 0), RBD_OK);
    ck_assert_int_eq(status_of(1, 0, 0, 0, 0, 0, 0, 0, 0, 0), RBD_OK);
    ck_assert_int_eq(status_of(2, 2e3, 0, 0, 0, 0, 0, 2e6, 0, 2e6), RBD_OK);        /* a far point mass */
    ck_assert_int_eq(status_of(1, 0, 0, 0.1, 0.01, 0, 0, 0.01, 0, 0), RBD_OK);      /* a near one */
    ck_assert_int_eq(status_of(1, 0, 0, 0, 1, 0, 0, 1, 0, 2), RBD_OK);              /* a disc */
    ck_assert_int_eq(status_of(1, 0, 0, 0, 1, 0, 0, 1, 0, 2.001), RBD_ERR_INERTIA); /* more than that */
    ck_assert_int_eq(status_of(1, 0, 0, 0, 1, 0.6, 0, 1, 0, 1), RBD_ERR_INERTIA);   /* 1.6 > 1 + 0.4 */
    ck_assert_int_eq(status_of(1, 0, 0, 0, 1, 0.49, 0, 1, 0, 1), RBD_OK);
    ck_assert_int_eq(status_of(1, 0, 0, 0.1, 0.009, 0, 0, 0.009, 0, 0),
                     RBD_ERR_INERTIA); /* less than m c^2 */
    ck_assert_int_eq(status_of(-1, 0, 0, 0, 1, 0, 0, 1, 0, 1), RBD_ERR_MASS);
    ck_assert_int_eq(status_of(NAN, 0, 0, 0, 1, 0, 0, 1, 0, 1), RBD_ERR_MASS);
    ck_assert_int_eq(status_of(HUGE_VAL, 0, 0, 0, 1, 0, 0, 1, 0, 1), RBD_ERR_MASS);
    ck_assert_int_eq(status_of(0, 0, 1, 0, 1, 0, 0, 1, 0, 1), RBD_ERR_COM);
    ck_assert_int_eq(status_of(0, 0, -1, 0, 1, 0, 0, 1, 0, 1), RBD_ERR_COM);
    ck_assert_int_eq(status_of(1, 0, 0, NAN, 1, 0, 0, 1, 0, 1), RBD_ERR_COM);
    for (int k = 4; k < 10; k++) {
        double pi[10] = {1, 0, 0, 0, 1, 0, 0, 1, 0, 1};
        pi[k] = NAN;
        ck_assert_int_eq(rbd_check_parameters(pi), RBD_ERR_INERTIA);
        pi[k] = HUGE_VAL;
        ck_assert_int_eq(rbd_check_parameters(pi), RBD_ERR_INERTIA);
        pi[k] = -1;
        ck_assert_int_eq(rbd_check_parameters(pi), RBD_ERR_INERTIA);
    }
}
END_TEST

/* ---- identities ---- */

/* A base that can be moved anywhere: translations change nothing, exactly. */
static void check_floating(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    static double by_q[MAX_M], by_v[MAX_M];
    rbd_derivatives *d = derivatives_of(r);
    if (r->bodies[0].type == RBD_FLOATING) {
        RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->a, s->f_ext, by_q, by_v, NULL));
        for (int i = 0; i < nv; i++)
            for (int k = 3; k < 6; k++) expect_small("dtau/dposition", r, number, by_q[i * nv + k], 0);
    }
    free(d_memory);
}

START_TEST(place_of_a_floating_base_does_not_matter) { for_random_states(3, check_floating); }
END_TEST

/* The n x n entries before those of further dofs, rows of nv, put together. */
static void cut(double *x, int n, int nv) {
    for (int i = 0; i < n; i++) memmove(x + i * n, x + i * nv, (size_t)n * sizeof *x);
}

/* A free base's dofs have closed forms in its own axes. With a second root beside it they go the general way,
   which gives the same. */
static void check_ways(const robot *r, const state *s, int number) {
    const int nv = r->nv, n = nv * nv;
    const rbd_body root = {.parent = -1,
                           .type = RBD_REVOLUTE,
                           .axis = {0, 1, 0},
                           .mass = 1,
                           .com = {0.1, 0.2, 0.3},
                           .inertia = {1, 0, 0, 1, 0, 1}};
    static double x[2][6][MAX_M], a[2][MAX_V];
    static rbd_body bodies[MAX_BODIES];
    static state both;
    tb_real expected[TB_MAX_DOFS];
    const double condition =
        (double)tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, expected);
    rbd_derivatives *d = derivatives_of(r);
    const int base = d->base;
    robot two;
    free(d_memory);
    if (!base || nv == MAX_V || r->nb == MAX_BODIES || !(condition > 0 && condition < 1e10)) return;
    memcpy(bodies, r->bodies, (size_t)r->nb * sizeof *bodies);
    bodies[r->nb] = root;
    two = robot_build("with a second root", bodies, r->nb + 1);
    ck_assert_int_eq(rbd_set_gravity(two.w, s->gravity), RBD_OK);
    both = *s;
    both.q[r->nq] = both.v[nv] = both.a[nv] = both.tau[nv] = 0.5;
    for (int k = 0; k < 6; k++) both.f_ext[6 * r->nb + k] = 0;
    for (int k = 0; k < 2; k++) {
        const robot *of = k == 0 ? r : &two;
        double(*y)[MAX_M] = x[k], M[MAX_M];
        d = derivatives_of(of);
        ck_assert_int_eq(d->base, k == 0 ? 6 : 0);
        RUN(rbd_id_derivatives(of->m, d, both.q, both.v, both.a, both.f_ext, y[0], y[1], M));
        RUN(rbd_coriolis(of->m, d, both.q, both.v, y[3]));
        RUN(rbd_fd_derivatives(of->m, d, both.q, both.v, both.tau, both.f_ext, a[k], y[4], y[5], y[2]));
        for (int j = 0; j < 6; j++) cut(y[j], nv, of->nv);
        free(d_memory);
    }
    expect_close("dtau/dq, both ways", r, number, x[0][0], x[1][0], n, 1e-12);
    expect_close("dtau/dv, both ways", r, number, x[0][1], x[1][1], n, 1e-12);
    expect_close("C, both ways", r, number, x[0][3], x[1][3], n, 1e-12);
    expect_close("a, both ways", r, number, a[0], a[1], nv, inverse_bound(condition));
    for (int j = 4; j < 6; j++)
        expect_close("da/dq, da/dv, both ways", r, number, x[0][j], x[1][j], n, inverse_bound(condition));
    expect_close("M^-1, both ways", r, number, x[0][2], x[1][2], n, inverse_bound(condition));
    robot_free(&two);
}

START_TEST(closed_forms_of_a_free_base) {
    for_random_states(3, check_ways);
    for_random_trees(150, check_ways);
}
END_TEST

/* Nor do a far place and a great velocity of the root cost digits. */
static void travel(rbd_joint_type type, int position, int velocity, int star) {
    rbd_body bodies[4];
    uint64_t seed = 77;
    for (int i = 0; i < 4; i++) {
        random_joint(&seed, bodies, i, i == 0 ? type : RBD_REVOLUTE);
        random_mass(&seed, &bodies[i]);
        bodies[i].parent = star && i > 0 ? 0 : i - 1;
    }
    struct robot one = BUILD(bodies), *r = &one;
    const int number = (int)type, nv = r->nv;
    double near_q[MAX_M], near_v[MAX_M], far_q[MAX_M], far_v[MAX_M];
    state s;
    draw_state(r, &seed, &s);
    rbd_derivatives *d = derivatives_of(r);
    for (int k = 0; k < nv; k++) s.f_ext[k] = 0;
    RUN(rbd_id_derivatives(r->m, d, s.q, s.v, s.a, NULL, near_q, near_v, NULL));
    for (int k = 0; k < 3; k++) {
        s.q[position + k % (type == RBD_PRISMATIC ? 1 : 2)] += 1e6;
        if (velocity >= 0) s.v[velocity] += 1e6; /* in world axes: of joints that do not turn */
    }
    RUN(rbd_id_derivatives(r->m, d, s.q, s.v, s.a, NULL, far_q, far_v, NULL));
    expect_close("dtau/dq far away", r, number, far_q, near_q, nv * nv, 1e-12);
    expect_close("dtau/dv far away", r, number, far_v, near_v, nv * nv, 1e-12);
    free(d_memory);
    robot_free(r);
}

START_TEST(distance_and_speed_of_the_root_cost_no_digits) {
    for (int star = 0; star < 2; star++) {
        travel(RBD_FLOATING, 0, -1, star);
        travel(RBD_PLANAR, 0, -1, star);
        travel(RBD_TRANSLATION, 0, 0, star);
        travel(RBD_PRISMATIC, 0, 0, star);
    }
}
END_TEST

/* ---- arguments and memory ---- */

#define EXPECT(status, call) ck_assert_int_eq(call, status)

START_TEST(bad_arguments_are_refused) {
    robot r = robot_build("iiwa", reference_model(0)->bodies, reference_model(0)->nb);
    const rbd_body other[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}}};
    robot o = BUILD(other);
    const size_t size = rbd_derivatives_size(r.m);
    rbd_derivatives *d = derivatives_of(&r), *e;
    double q[MAX_Q] = {0}, v[MAX_V] = {0}, x[6 * MAX_M], *none = NULL;
    void *memory = d_memory;
    e = d;
    EXPECT(RBD_ERR_NULL, rbd_derivatives_init(NULL, r.w, memory, size, &e));
    ck_assert_ptr_null(e);
    EXPECT(RBD_ERR_NULL, rbd_derivatives_init(r.m, NULL, memory, size, &e));
    EXPECT(RBD_ERR_NULL, rbd_derivatives_init(r.m, r.w, NULL, size, &e));
    EXPECT(RBD_ERR_NULL, rbd_derivatives_init(r.m, r.w, memory, size, NULL));
    EXPECT(RBD_ERR_WORK, rbd_derivatives_init(o.m, r.w, memory, size, &e));
    e = d;
    EXPECT(RBD_ERR_MEMORY, rbd_derivatives_init(r.m, r.w, memory, size - 1, &e));
    ck_assert_ptr_null(e);
    ck_assert_uint_eq(rbd_derivatives_size(NULL), 0);
    EXPECT(RBD_ERR_WORK, rbd_coriolis(o.m, d, q, v, x));
    EXPECT(RBD_ERR_NULL, rbd_coriolis(r.m, NULL, q, v, x));
    EXPECT(RBD_ERR_NULL, rbd_coriolis(NULL, d, q, v, x));
    EXPECT(RBD_ERR_NULL, rbd_coriolis(r.m, d, none, v, x));
    EXPECT(RBD_ERR_NULL, rbd_coriolis(r.m, d, q, none, x));
    EXPECT(RBD_ERR_NULL, rbd_coriolis(r.m, d, q, v, none));
    EXPECT(RBD_ERR_NULL, rbd_id_derivatives(r.m, d, none, v, v, NULL, x, x, NULL));
    EXPECT(RBD_ERR_NULL, rbd_id_derivatives(r.m, d, q, none, v, NULL, x, x, NULL));
    EXPECT(RBD_ERR_NULL, rbd_id_derivatives(r.m, d, q, v, none, NULL, x, x, NULL));
    EXPECT(RBD_OK, rbd_id_derivatives(r.m, d, q, v, v, NULL, NULL, NULL, NULL));
    EXPECT(RBD_ERR_WORK, rbd_id_derivatives(o.m, d, q, v, v, NULL, x, x, NULL));
    EXPECT(RBD_ERR_NULL, rbd_gravity_torque_derivatives(r.m, d, none, x));
    EXPECT(RBD_ERR_NULL, rbd_keep_zeros(NULL, 1));
    EXPECT(RBD_ERR_NULL, rbd_fd_derivatives(NULL, d, q, v, v, NULL, x, x, x, x));
    EXPECT(RBD_ERR_NULL, rbd_fd_derivatives(r.m, NULL, q, v, v, NULL, x, x, x, x));
    EXPECT(RBD_ERR_NULL, rbd_fd_derivatives(r.m, d, none, v, v, NULL, x, x, x, x));
    EXPECT(RBD_ERR_NULL, rbd_fd_derivatives(r.m, d, q, none, v, NULL, x, x, x, x));
    EXPECT(RBD_ERR_NULL, rbd_fd_derivatives(r.m, d, q, v, none, NULL, x, x, x, x));
    EXPECT(RBD_ERR_WORK, rbd_fd_derivatives(o.m, d, q, v, v, NULL, x, x, x, x));
    EXPECT(RBD_OK, rbd_fd_derivatives(r.m, d, q, v, v, NULL, NULL, NULL, NULL, NULL));
    EXPECT(RBD_ERR_NULL, rbd_gravity_torque_derivatives(r.m, d, q, none));
    EXPECT(RBD_ERR_NULL, rbd_momentum_matrix(r.m, d, none, v, x, NULL));
    EXPECT(RBD_ERR_NULL, rbd_momentum_matrix(r.m, d, q, none, x, x));
    EXPECT(RBD_ERR_NULL, rbd_momentum_matrix(r.m, d, q, v, none, x));
    EXPECT(RBD_ERR_NULL, rbd_id_free_base(r.m, d, none, v, x, x + MAX_V, NULL));
    EXPECT(RBD_ERR_NULL, rbd_id_free_base(r.m, d, q, none, x, x + MAX_V, NULL));
    EXPECT(RBD_ERR_NULL, rbd_id_free_base(r.m, d, q, v, none, x, NULL));
    EXPECT(RBD_ERR_NULL, rbd_id_free_base(r.m, d, q, v, x, none, NULL));
    EXPECT(RBD_ERR_WORK, rbd_id_free_base(o.m, d, q, v, x, x + MAX_V, NULL));
    EXPECT(RBD_ERR_NULL, rbd_com_jacobian(r.m, d, none, x));
    EXPECT(RBD_ERR_NULL, rbd_com_jacobian(r.m, d, q, none));
    EXPECT(RBD_ERR_NULL, rbd_regressor(r.m, d, none, v, v, x));
    EXPECT(RBD_ERR_NULL, rbd_regressor(r.m, d, q, none, v, x));
    EXPECT(RBD_ERR_NULL, rbd_regressor(r.m, d, q, v, none, x));
    EXPECT(RBD_ERR_NULL, rbd_regressor(r.m, d, q, v, v, none));
    EXPECT(RBD_ERR_NULL, rbd_regressor(NULL, d, q, v, v, x));
    EXPECT(RBD_ERR_NULL, rbd_energy_regressors(r.m, d, none, v, x, x));
    EXPECT(RBD_ERR_NULL, rbd_energy_regressors(r.m, d, q, none, x, NULL));
    EXPECT(RBD_ERR_NULL, rbd_integrate_derivatives(NULL, v, 1, x, x));
    EXPECT(RBD_ERR_NULL, rbd_integrate_derivatives(r.m, none, 1, x, x));
    EXPECT(RBD_OK, rbd_integrate_derivatives(r.m, v, 1, NULL, NULL));
    EXPECT(RBD_ERR_NULL, rbd_difference_derivatives(NULL, q, q, x, x));
    EXPECT(RBD_ERR_NULL, rbd_difference_derivatives(r.m, none, q, x, x));
    EXPECT(RBD_ERR_NULL, rbd_difference_derivatives(r.m, q, none, x, x));
    EXPECT(RBD_OK, rbd_difference_derivatives(r.m, q, q, NULL, NULL));
    EXPECT(RBD_ERR_NULL, rbd_body_parameters(NULL, 0, x));
    EXPECT(RBD_ERR_NULL, rbd_body_parameters(r.m, 0, none));
    EXPECT(RBD_ERR_INDEX, rbd_body_parameters(r.m, -1, x));
    EXPECT(RBD_ERR_INDEX, rbd_body_parameters(r.m, r.nb, x));
    EXPECT(RBD_ERR_NULL, rbd_set_parameters(NULL, x));
    EXPECT(RBD_ERR_NULL, rbd_set_parameters(&(rbd_body){.parent = -1}, none));
    free(memory);
    robot_free(&r);
    robot_free(&o);
}
END_TEST

static void check_size(const robot *r, const state *s, int number) {
    const size_t nb = (size_t)r->nb, nv = (size_t)r->nv, size = rbd_derivatives_size(r->m);
    int mimics = 0;
    (void)s, (void)number;
    for (int i = 0; i < r->nb; i++) mimics += r->bodies[i].mimic != NULL;
    ck_assert_msg(size <= (mimics ? RBD_DERIVATIVES_SIZE_MIMIC(nb, nv) : RBD_DERIVATIVES_SIZE(nb, nv)), "%s",
                  r->name);
}

/* The pointer is the same, the model is not. */
START_TEST(derivatives_of_a_model_built_over_are_refused) {
    const ref_model *large = reference_model(0);
    const rbd_body rod[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}}};
    robot r = robot_build(large->name, large->bodies, large->nb);
    rbd_derivatives *d = derivatives_of(&r);
    const rbd_model *m;
    double q[MAX_Q] = {0}, v[MAX_V] = {0}, x[MAX_M];
    EXPECT(RBD_OK, rbd_coriolis(r.m, d, q, v, x));
    EXPECT(RBD_OK, rbd_model_build(rod, 1, r.memory[0], rbd_model_size(large->bodies, large->nb), &m, NULL));
    ck_assert_ptr_eq(m, r.m);
    EXPECT(RBD_ERR_WORK, rbd_coriolis(m, d, q, v, x));
    free(d_memory);
    robot_free(&r);
}
END_TEST

START_TEST(size_at_compile_time_suffices) { for_random_trees(200, check_size); }
END_TEST

/* Each output of rbd_id_derivatives alone is what it is together with the others. */
static void check_alone(const robot *r, const state *s, int number) {
    const int size = r->nv * r->nv;
    static double all[3][MAX_M], one[3][MAX_M];
    rbd_derivatives *d = derivatives_of(r);
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->a, s->f_ext, all[0], all[1], all[2]));
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->a, s->f_ext, one[0], NULL, NULL));
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->a, s->f_ext, NULL, one[1], NULL));
    RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->a, s->f_ext, NULL, NULL, one[2]));
    for (int k = 0; k < 3; k++) expect_close("one output alone", r, number, one[k], all[k], size, 0);
    free(d_memory);
}

/* Entries that a call leaves as they were are zero in the whole matrix; it writes all others. */
static void check_kept(const robot *r, const state *s, int number) {
    enum { MATRICES = 5 };
    static double whole[MATRICES][10 * MAX_M], kept[MATRICES][10 * MAX_M];
    rbd_derivatives *d = derivatives_of(r);
    const int square = r->nv * r->nv, size[MATRICES] = {square, square, square, square, r->nv * 10 * r->nb};
    int left = 0, mimics = 0;
    for (int i = 0; i < r->nb; i++) mimics += r->bodies[i].mimic != NULL;
    for (int keep = 0; keep < 2; keep++) {
        double(*x)[10 * MAX_M] = keep ? kept : whole;
        for (int k = 0; k < MATRICES; k++)
            for (int i = 0; i < size[k]; i++) x[k][i] = 7;
        RUN(rbd_keep_zeros(d, keep));
        RUN(rbd_id_derivatives(r->m, d, s->q, s->v, s->a, s->f_ext, x[0], x[1], x[2]));
        RUN(rbd_coriolis(r->m, d, s->q, s->v, x[3]));
        RUN(rbd_regressor(r->m, d, s->q, s->v, s->a, x[4]));
    }
    for (int k = 0; k < MATRICES; k++) {
        left = 0;
        for (int i = 0; i < size[k]; i++) {
            const int same = fabs(kept[k][i] - whole[k][i]) <= 0, is_left = fabs(kept[k][i] - 7) <= 0;
            ck_assert_msg(same || (is_left && fabs(whole[k][i]) <= 0),
                          "%s %d: matrix %d, entry %d: %g, not %g", r->name, number, k, i, kept[k][i],
                          whole[k][i]);
            left += is_left;
        }
        if (mimics) ck_assert_int_eq(left, 0);
        if (!mimics && rbd_packed_size(r->m) < r->nv * (r->nv + 1) / 2) ck_assert_int_gt(left, 0);
    }
    free(d_memory);
}

START_TEST(zeros_may_be_kept) { for_random_trees(60, check_kept); }
END_TEST

START_TEST(each_output_may_be_left_out) { for_random_trees(30, check_alone); }
END_TEST

/* Slides and turns 20 km from the first link that turns: M in the common frame has no digit of them. */
START_TEST(far_from_the_common_frame_the_inverse_is_that_of_rbd_minverse) {
    uint64_t seed = 95;
    for (int i = 0; i < 50; i++) {
        rbd_body b[7];
        double M[2][49];
        state s;
        for (int k = 0; k < 7; k++) {
            random_joint(&seed, b, k, k > 1 && k % 2 == 1 ? RBD_PRISMATIC : RBD_REVOLUTE);
            random_mass(&seed, &b[k]);
            b[k].parent = k - 1;
        }
        b[1].position[0] = 2e4;
        robot r = robot_build("far arm", b, 7);
        rbd_derivatives *d = derivatives_of(&r);
        draw_state(&r, &seed, &s);
        expect_ok("fd_derivatives", &r, i,
                  rbd_fd_derivatives(r.m, d, s.q, s.v, s.tau, NULL, NULL, NULL, NULL, M[0]));
        expect_ok("minverse", &r, i, rbd_minverse(r.m, r.w, s.q, M[1]));
        expect_close("far arm, inverse", &r, i, M[0], M[1], 49, 1e-8); /* some eps / 1e-7 */
        free(d_memory);
        robot_free(&r);
    }
}
END_TEST

Suite *derivatives_suite(void) {
    Suite *s = suite_create("derivatives");
    TCase *c = tcase_create("derivatives");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, results_match_the_control_data);
    tcase_add_test(c, derivatives_match_the_reference);
    tcase_add_test(c, derivatives_match_differences_on_random_trees);
    tcase_add_test(c, forward_derivatives_match_the_control_data);
    tcase_add_test(c, forward_derivatives_match_the_reference);
    tcase_add_test(c, forward_derivatives_on_random_trees);
    tcase_add_test(c, free_base_may_have_rotors);
    tcase_add_test(c, limbs_may_be_alike);
    tcase_add_test(c, gravity_derivatives_match_differences);
    tcase_add_test(c, coriolis_matrix_is_one);
    tcase_add_test(c, a_free_base_matches_the_reference);
    tcase_add_test(c, a_free_base_gives_way);
    tcase_add_test(c, a_free_base_may_be_singular);
    tcase_add_test(c, momentum_is_that_of_the_bodies);
    tcase_add_test(c, torques_and_energies_are_linear_in_the_parameters);
    tcase_add_test(c, energies_with_a_body_on_the_world);
    tcase_add_test(c, steps_come_back);
    tcase_add_test(c, step_derivatives_match_differences);
    tcase_add_test(c, parameters_and_back);
    tcase_add_test(c, what_no_body_can_have_is_refused);
    tcase_add_test(c, place_of_a_floating_base_does_not_matter);
    tcase_add_test(c, closed_forms_of_a_free_base);
    tcase_add_test(c, distance_and_speed_of_the_root_cost_no_digits);
    tcase_add_test(c, parameters_without_or_with_negative_mass);
    tcase_add_test(c, no_mass_has_no_centre);
    tcase_add_test(c, bad_arguments_are_refused);
    tcase_add_test(c, derivatives_of_a_model_built_over_are_refused);
    tcase_add_test(c, size_at_compile_time_suffices);
    tcase_add_test(c, zeros_may_be_kept);
    tcase_add_test(c, each_output_may_be_left_out);
    tcase_add_test(c, far_from_the_common_frame_the_inverse_is_that_of_rbd_minverse);
    suite_add_tcase(s, c);
    return s;
}
