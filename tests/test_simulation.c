/* test_simulation.c - the whole at work: closed-form robots, energy over a swing, power balance. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

#include "models/cart_pole.h"
#include "models/double_pendulum.h"
#include "models/pendulum.h"

/* ---- equations of motion in closed form (the models' URDF files have them) ---- */

static const double gravity_of_earth = 9.81;

static void pendulum_torque(const double *q, const double *v, const double *a, double *tau) {
    const double m = 1.2, l = 0.5, I = 0.1;
    (void)v;
    tau[0] = (I + m * l * l) * a[0] + m * gravity_of_earth * l * sin(q[0]);
}

static void double_pendulum_torque(const double *q, const double *v, const double *a, double *tau) {
    const double m1 = 1.2, r1 = 0.5, I1 = 0.1;
    const double m2 = 1, r2 = 0.3, I2 = 0.03;
    const double l1 = 1, g = gravity_of_earth;
    const double A = I1 + m1 * r1 * r1 + I2 + m2 * (l1 * l1 + r2 * r2), B = m2 * l1 * r2,
                 D = I2 + m2 * r2 * r2;
    const double c = cos(q[1]), s = sin(q[1]), lower = m2 * r2 * g * sin(q[0] + q[1]);
    tau[0] = (A + 2 * B * c) * a[0] + (D + B * c) * a[1] - B * s * (2 * v[0] * v[1] + v[1] * v[1]) +
             (m1 * r1 + m2 * l1) * g * sin(q[0]) + lower;
    tau[1] = (D + B * c) * a[0] + D * a[1] + B * s * v[0] * v[0] + lower;
}

static void cart_pole_torque(const double *q, const double *v, const double *a, double *tau) {
    const double mc = 1.2, mp = 0.5, l = 0.3, I = 0.015;
    const double c = cos(q[1]), s = sin(q[1]);
    tau[0] = (mc + mp) * a[0] + mp * l * c * a[1] - mp * l * s * v[1] * v[1];
    tau[1] = mp * l * c * a[0] + (I + mp * l * l) * a[1] + mp * gravity_of_earth * l * s;
}

typedef void closed_form(const double *q, const double *v, const double *a, double *tau);

static const struct {
    const char *name;
    const rbd_body *bodies;
    int nb;
    closed_form *torque;
} simple_robots[3] = {{"pendulum", pendulum_bodies, PENDULUM_NB, pendulum_torque},
                      {"double pendulum", double_pendulum_bodies, DOUBLE_PENDULUM_NB, double_pendulum_torque},
                      {"cart-pole", cart_pole_bodies, CART_POLE_NB, cart_pole_torque}};

static robot build_simple(int i) {
    return robot_build(simple_robots[i].name, simple_robots[i].bodies, simple_robots[i].nb);
}

START_TEST(simple_robots_obey_their_equations_of_motion) {
    for (int i = 0; i < 3; i++) {
        robot r = build_simple(i);
        uint64_t seed = 7;
        for (int number = 0; number < 200; number++) {
            state s;
            double tau[2], expected[2], a[2];
            draw_state(&r, &seed, &s);
            ck_assert_int_eq(rbd_set_gravity(r.w, earth), RBD_OK);
            simple_robots[i].torque(s.q, s.v, s.a, expected);
            ck_assert_int_eq(rbd_rnea(r.m, r.w, s.q, s.v, s.a, NULL, tau), RBD_OK);
            expect_close("closed form, rnea", &r, number, tau, expected, r.nv, 1e-13);
            ck_assert_int_eq(rbd_aba(r.m, r.w, s.q, s.v, expected, NULL, a), RBD_OK);
            expect_close("closed form, aba", &r, number, a, s.a, r.nv, 1e-12);
            ck_assert_int_eq(rbd_fd_cholesky(r.m, r.w, s.q, s.v, expected, NULL, a), RBD_OK);
            expect_close("closed form, fd_cholesky", &r, number, a, s.a, r.nv, 1e-12);
        }
        robot_free(&r);
    }
}
END_TEST

/* ---- energy ---- */

static double energy(const robot *r, const double *q, const double *v) {
    double kinetic, potential;
    ck_assert_int_eq(rbd_kinematics(r->m, r->w, q, v, NULL), RBD_OK);
    ck_assert_int_eq(rbd_energy(r->m, r->w, &kinetic, &potential), RBD_OK);
    return kinetic + potential;
}

/* Rates of the coordinates at q for v: quaternions by q w / 2, planar by its turned velocity. */
static void coordinate_rates(const rbd_body *bodies, int nb, const double *q, const double *v, double *rate) {
    for (int i = 0; i < nb; i++) {
        const int nq = tb_nq(&bodies[i]), nv = tb_nv(&bodies[i]);
        const double *u = q + (bodies[i].type == RBD_FLOATING ? 3 : 0); /* quaternion (x, y, z, w) */
        double *u_rate = rate + (u - q);
        switch (bodies[i].type) {
        case RBD_FLOATING: {
            const double t[3] = {2 * (u[1] * v[5] - u[2] * v[4]), 2 * (u[2] * v[3] - u[0] * v[5]),
                                 2 * (u[0] * v[4] - u[1] * v[3])}; /* R v = v + w t + u x t, t = 2 u x v */
            rate[0] = v[3] + u[3] * t[0] + u[1] * t[2] - u[2] * t[1];
            rate[1] = v[4] + u[3] * t[1] + u[2] * t[0] - u[0] * t[2];
            rate[2] = v[5] + u[3] * t[2] + u[0] * t[1] - u[1] * t[0];
        } /* fall through */
        case RBD_SPHERICAL:
            u_rate[0] = (u[3] * v[0] + u[1] * v[2] - u[2] * v[1]) / 2;
            u_rate[1] = (u[3] * v[1] + u[2] * v[0] - u[0] * v[2]) / 2;
            u_rate[2] = (u[3] * v[2] + u[0] * v[1] - u[1] * v[0]) / 2;
            u_rate[3] = -(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / 2;
            break;
        case RBD_CONTINUOUS_CS:
            rate[0] = -q[1] * v[0];
            rate[1] = q[0] * v[0];
            break;
        case RBD_PLANAR:
            rate[0] = cos(q[2]) * v[1] - sin(q[2]) * v[2];
            rate[1] = sin(q[2]) * v[1] + cos(q[2]) * v[2];
            rate[2] = v[0];
            break;
        default:
            for (int k = 0; k < nq; k++) rate[k] = v[k];
        }
        q += nq;
        v += nv;
        rate += nq;
    }
}

/* x = (q, v); rates for no torque at all */
static void state_rates(const robot *r, const double *x, double *rate) {
    const double zero[MAX_V] = {0};
    coordinate_rates(r->bodies, r->nb, x, x + r->nq, rate);
    ck_assert_int_eq(rbd_aba(r->m, r->w, x, x + r->nq, zero, NULL, rate + r->nq), RBD_OK);
}

/* One step of the classical Runge-Kutta method. */
static void runge_kutta(const robot *r, double h, double *x) {
    const double at[3] = {h / 2, h / 2, h};
    const int n = r->nq + r->nv;
    double k[4][MAX_Q + MAX_V], y[MAX_Q + MAX_V];
    state_rates(r, x, k[0]);
    for (int stage = 1; stage < 4; stage++) {
        for (int i = 0; i < n; i++) y[i] = x[i] + at[stage - 1] * k[stage - 1][i];
        state_rates(r, y, k[stage]);
    }
    for (int i = 0; i < n; i++) x[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* Swings freely for one second; energy is constant, speed is not. */
static void check_swing(const robot *r, double *x, double h, double bound) {
    const double before = energy(r, x, x + r->nq), kinetic = energy(r, x, x + r->nq) - energy(r, x, NULL);
    double exchanged = 0;
    for (int i = 0; i < (int)(1 / h + 0.5); i++) {
        runge_kutta(r, h, x);
        exchanged = larger(exchanged, fabs(energy(r, x, x + r->nq) - energy(r, x, NULL) - kinetic));
    }
    const double drift = fabs(energy(r, x, x + r->nq) - before);
    ck_assert_msg(exchanged > 1e-2, "%s: kinetic energy changes by %g only", r->name, exchanged);
    expect_small("energy drift of a swing", r, 0, drift / exchanged, bound);
}

START_TEST(simple_robots_keep_their_energy_over_a_swing) {
    for (int i = 0; i < 3; i++) {
        robot r = build_simple(i);
        double x[4] = {0.3, 2.0, 0.5, -1.0};
        check_swing(&r, x, 1e-3, 1e-9);
        robot_free(&r);
    }
}
END_TEST

/* All reference trees, whose joints are of all kinds, from a gentle start. */
START_TEST(trees_keep_their_energy_over_a_swing) {
    for (int i = 3; i < reference_count; i++) {
        const ref_model *model = reference_model(i);
        robot r = robot_build(model->name, model->bodies, model->nb);
        double x[MAX_Q + MAX_V];
        memcpy(x, model->states[0].q, (size_t)r.nq * sizeof *x);
        for (int k = 0; k < r.nv; k++) x[r.nq + k] = model->states[0].v[k] / 4;
        check_swing(&r, x, 5e-4, 1e-6);
        robot_free(&r);
    }
}
END_TEST

/* dE/dt = v . tau + sum velocity . wrench, dE/dt by central differences extrapolated (Richardson). */
static void check_power(const robot *r, const state *s, int number) {
    double a[MAX_V], rate[2], expected, velocity[6];
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, a));
    const double size = fmax(1, largest(a, r->nv)); /* a stiff state changes fast: smaller steps */
    for (int half = 0; half < 2; half++) {
        const double h = (half ? 1e-3 : 2e-3) / size;
        double E[2];
        for (int side = 0; side < 2; side++) {
            double q[MAX_Q], v[MAX_V];
            const double t = side ? h : -h;
            RUN(rbd_integrate(r->m, s->q, s->v, t, q));
            for (int k = 0; k < r->nv; k++) v[k] = s->v[k] + t * a[k];
            E[side] = energy(r, q, v);
        }
        rate[half] = (E[1] - E[0]) / (2 * h);
    }
    rate[1] += (rate[1] - rate[0]) / 3;
    expected = dot(s->v, s->tau, r->nv);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    for (int i = 0; i < r->nb; i++) {
        RUN(rbd_body_velocity(r->m, r->w, i, velocity));
        expected += dot(velocity, s->f_ext + 6 * i, 6);
    }
    expect_small("power balance", r, number, fabs(rate[1] - expected) / (1 + fabs(expected)) / size, 1e-8);
}

START_TEST(power_goes_into_energy) {
    for_random_states(5, check_power);
    for (int i = 0; i < 3; i++) {
        robot r = build_simple(i);
        uint64_t seed = 9;
        for (int number = 0; number < 20; number++) {
            state s;
            draw_state(&r, &seed, &s);
            check_power(&r, &s, number);
        }
        robot_free(&r);
    }
}
END_TEST

Suite *simulation_suite(void) {
    Suite *suite = suite_create("simulation");
    TCase *c = tcase_create("simulation");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, simple_robots_obey_their_equations_of_motion);
    tcase_add_test(c, simple_robots_keep_their_energy_over_a_swing);
    tcase_add_test(c, trees_keep_their_energy_over_a_swing);
    tcase_add_test(c, power_goes_into_energy);
    suite_add_tcase(suite, c);
    return suite;
}
