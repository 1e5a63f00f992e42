/* test_manifold.c - [manifold]: neutral, integrate, difference, random configurations. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

static const double pi = 3.14159265358979323846;

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    double q[MAX_Q], d[MAX_V], expected[MAX_V];
    RUN(rbd_integrate(r->m, s->q, s->v, s->dt, q));
    expect_close("integrate", r, number, q, s->q_next, model->nq, 1e-14);
    RUN(rbd_difference(r->m, s->q, s->q_next, d));
    for (int k = 0; k < model->nv; k++) expected[k] = s->v[k] * s->dt;
    expect_close("difference", r, number, d, expected, model->nv, 1e-13);
}

START_TEST(integrate_and_difference_match_the_reference) { for_reference_states(check_reference); }
END_TEST

/* Steps of all sizes below half a turn, down to those that rounding nearly swallows. */
static void check_round_trip(const robot *r, const state *s, int number) {
    const double sizes[6] = {1, 0.3, 1e-3, 1e-6, 1e-9, 0};
    for (int i = 0; i < 6; i++) {
        double step[MAX_V], q[MAX_Q], d[MAX_V], again[MAX_Q];
        for (int k = 0; k < r->nv; k++)
            step[k] = sizes[i] * s->v[k] / 2; /* within (-1, 1): a rotation below 1.8 rad */
        RUN(rbd_integrate(r->m, s->q, step, 1, q));
        RUN(rbd_difference(r->m, s->q, q, d));
        expect_close("difference undoes integrate", r, number, d, step, r->nv, 3e-12);
        RUN(rbd_integrate(r->m, s->q, d, 1, again));
        expect_close("integrate undoes difference", r, number, again, q, r->nq, 1e-14);
    }
}

START_TEST(difference_undoes_integrate) {
    for_random_states(10, check_round_trip);
    for_random_trees(100, check_round_trip);
}
END_TEST

/* Quaternions and (cos, sin) point the same way, other coordinates are equal. */
static void expect_same_place(const char *what, const robot *r, int number, const double *a,
                              const double *b) {
    double d[MAX_V];
    RUN(rbd_difference(r->m, a, b, d));
    expect_small(what, r, number, largest(d, r->nv), 1e-13);
}

/* A constant velocity in body axes is a one-parameter group: two half steps are one whole step. */
static void check_halves(const robot *r, const state *s, int number) {
    double whole[MAX_Q], half[MAX_Q], back[MAX_Q];
    RUN(rbd_integrate(r->m, s->q, s->v, 1, whole));
    RUN(rbd_integrate(r->m, s->q, s->v, 0.5, half));
    RUN(rbd_integrate(r->m, half, s->v, 0.5, half)); /* in place */
    expect_same_place("two half steps", r, number, whole, half);
    RUN(rbd_integrate(r->m, whole, s->v, -1, back));
    expect_same_place("a step back", r, number, s->q, back);
}

START_TEST(steps_add_up) {
    for_random_states(10, check_halves);
    for_random_trees(100, check_halves);
}
END_TEST

static void check_difference(const robot *r, const state *s, int number) {
    uint64_t seed = 77 + (uint64_t)number;
    state other;
    double d[MAX_V], reached[MAX_Q];
    draw_state(r, &seed, &other);
    RUN(rbd_difference(r->m, s->q, other.q, d));
    RUN(rbd_integrate(r->m, s->q, d, 1, reached));
    expect_same_place("integrate(q0, q1 - q0) = q1", r, number, reached, other.q);
    for (int i = 0; i < r->nb; i++) {
        const rbd_joint_type type = r->bodies[i].type;
        rbd_joint_info info;
        RUN(rbd_joint(r->m, i, &info));
        if (type == RBD_SPHERICAL || type == RBD_FLOATING) {
            const double *w = d + info.iv;
            ck_assert_msg(sqrt(dot(w, w, 3)) <= pi + 1e-12, "%s: not the shortest rotation", r->name);
        } else if (type == RBD_CONTINUOUS_CS && info.nv == 1) {
            ck_assert_msg(fabs(d[info.iv]) <= pi + 1e-12, "%s: not the shortest turn", r->name);
        }
    }
}

START_TEST(difference_leads_from_any_place_to_any_other) {
    for_random_states(10, check_difference);
    for_random_trees(100, check_difference);
}
END_TEST

/* The pose after a small step moves with the body's velocity: integrate agrees with kinematics. */
static void check_pose(const robot *r, const state *s, int number) {
    const double h = 1e-5;
    double ahead[MAX_Q], behind[MAX_Q], p[2][3], R[9], velocity[6], rate[3], expected[3];
    RUN(rbd_integrate(r->m, s->q, s->v, h, ahead));
    RUN(rbd_integrate(r->m, s->q, s->v, -h, behind));
    for (int i = 0; i < r->nb; i++) {
        RUN(rbd_kinematics(r->m, r->w, ahead, NULL, NULL));
        RUN(rbd_body_pose(r->m, r->w, i, NULL, p[0]));
        RUN(rbd_kinematics(r->m, r->w, behind, NULL, NULL));
        RUN(rbd_body_pose(r->m, r->w, i, NULL, p[1]));
        RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
        RUN(rbd_body_pose(r->m, r->w, i, R, NULL));
        RUN(rbd_body_velocity(r->m, r->w, i, velocity));
        multiply(R, velocity + 3, 3, 3, expected);
        for (int k = 0; k < 3; k++) rate[k] = (p[0][k] - p[1][k]) / (2 * h) - expected[k];
        expect_small("origin velocity after a step", r, number, largest(rate, 3), 1e-7);
    }
}

START_TEST(integrate_moves_bodies_by_their_velocity) { for_random_states(2, check_pose); }
END_TEST

/* The rates of q along v are those of steps of rbd_integrate; and v comes back from them. */
static void check_rates(const robot *r, const state *s, int number) {
    double q[MAX_Q], rates[MAX_Q], expected[MAX_Q], v[MAX_V], unit[MAX_Q], zero[MAX_V] = {0};
    double side[2][2][MAX_Q];
    RUN(rbd_integrate(r->m, s->q, zero, 1, unit)); /* makes quaternions unit */
    for (int half = 0; half < 2; half++)
        for (int i = 0; i < 2; i++) {
            const double h = half ? 5e-4 : 1e-3;
            RUN(rbd_integrate(r->m, unit, s->v, i ? h : -h, side[half][i]));
        }
    for (int k = 0; k < r->nq; k++) {
        const double coarse = (side[0][1][k] - side[0][0][k]) / 2e-3,
                     fine = (side[1][1][k] - side[1][0][k]) / 1e-3;
        expected[k] = fine + (fine - coarse) / 3;
    }
    RUN(rbd_rates_from_velocity(r->m, unit, s->v, rates));
    expect_close("rates by differences", r, number, rates, expected, r->nq, 1e-9);
    memcpy(q, s->q, sizeof q); /* of other lengths */
    for (int i = 0; i < r->nb; i++) {
        rbd_joint_info info;
        RUN(rbd_joint(r->m, i, &info));
        if (info.nq > info.nv)
            for (int k = info.nq - (info.type == RBD_CONTINUOUS_CS ? 2 : 4); k < info.nq; k++)
                q[info.iq + k] *= 1.5;
    }
    RUN(rbd_rates_from_velocity(r->m, q, s->v, rates));
    RUN(rbd_velocity_from_rates(r->m, q, rates, v));
    expect_close("velocity from rates", r, number, v, s->v, r->nv, 1e-14);
    for (int i = 0; i < r->nb; i++) { /* a change of length is no motion */
        rbd_joint_info info;
        RUN(rbd_joint(r->m, i, &info));
        if (info.nq > info.nv)
            for (int k = info.nq - (info.type == RBD_CONTINUOUS_CS ? 2 : 4); k < info.nq; k++)
                rates[info.iq + k] += 0.7 * q[info.iq + k];
    }
    RUN(rbd_velocity_from_rates(r->m, q, rates, v));
    expect_close("velocity from rates that stretch", r, number, v, s->v, r->nv, 1e-14);
}

START_TEST(rates_are_derivatives_of_the_coordinates) {
    for_random_states(5, check_rates);
    for_random_trees(100, check_rates);
}
END_TEST

static const rbd_body one_of_each[] = {
    {.joint = "floating", .parent = -1, .type = RBD_FLOATING, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
    {.joint = "spherical", .type = RBD_SPHERICAL, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
    {.joint = "cs", .parent = 1, .type = RBD_CONTINUOUS_CS, .axis = {0, 0, 1}, .mass = 1},
    {.joint = "planar", .parent = 2, .type = RBD_PLANAR, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
    {.joint = "hinge",
     .parent = 3,
     .type = RBD_REVOLUTE,
     .axis = {1, 0, 0},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1},
     .lower = 0.5,
     .upper = 0.75},
    {.joint = "slide", .parent = 4, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1},
};
enum { FLOATING_Q = 0, SPHERICAL_Q = 7, CS_Q = 11, PLANAR_Q = 13, HINGE_Q = 16, SLIDE_Q = 17, EACH_NQ = 18 };

START_TEST(neutral_is_zero_with_identity_rotations) {
    const double expected[EACH_NQ] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0};
    double q[EACH_NQ];
    robot r = BUILD(one_of_each);
    ck_assert_int_eq(r.nq, EACH_NQ);
    ck_assert_int_eq(rbd_neutral(r.m, q), RBD_OK);
    expect_close("neutral", &r, 0, q, expected, EACH_NQ, 0);
    robot_free(&r);
}
END_TEST

START_TEST(rates_of_any_length_are_finite) {
    const double lengths[4] = {1e-140, 1, 1e140, 1e300};
    double q[EACH_NQ], rates[EACH_NQ], v[15], back[15];
    uint64_t seed = 9;
    robot r = BUILD(one_of_each);
    for (int k = 0; k < 15; k++) v[k] = uniform(&seed, -2, 2);
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(rbd_random(r.m, &seed, q), RBD_OK);
        for (int k = 0; k < 4; k++) q[FLOATING_Q + 3 + k] *= lengths[i], q[SPHERICAL_Q + k] *= lengths[i];
        for (int k = 0; k < 2; k++) q[CS_Q + k] *= lengths[i];
        ck_assert_int_eq(rbd_rates_from_velocity(r.m, q, v, rates), RBD_OK);
        ck_assert_int_eq(rbd_velocity_from_rates(r.m, q, rates, back), RBD_OK);
        if (i > 0) /* the first is too short for a direction */
            expect_close("velocity from rates, any length", &r, i, back, v, 15, 1e-14);
        ck_assert(largest(rates, EACH_NQ) < 1e301 && largest(back, 15) < 10);
    }
    robot_free(&r);
}
END_TEST

START_TEST(rates_without_a_direction_are_zero) {
    const double q[EACH_NQ] = {0}, v[15] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    double rates[EACH_NQ], back[15];
    robot r = BUILD(one_of_each);
    ck_assert_int_eq(rbd_rates_from_velocity(r.m, q, v, rates), RBD_OK);
    for (int k = 0; k < 4; k++) ck_assert(!(fabs(rates[3 + k]) > 0) && !(fabs(rates[SPHERICAL_Q + k]) > 0));
    for (int k = 0; k < EACH_NQ; k++) rates[k] = 1;
    ck_assert_int_eq(rbd_velocity_from_rates(r.m, q, rates, back), RBD_OK);
    for (int k = 0; k < 15; k++)
        ck_assert_msg(k < 3 || (k >= 6 && k < 10) ? !(fabs(back[k]) > 0) : fabs(back[k] - 1) < 1e-15,
                      "dof %d: %g", k, back[k]);
    ck_assert_int_eq(rbd_rates_from_velocity(NULL, q, v, rates), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rates_from_velocity(r.m, NULL, v, rates), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rates_from_velocity(r.m, q, NULL, rates), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rates_from_velocity(r.m, q, v, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_velocity_from_rates(NULL, q, rates, back), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_velocity_from_rates(r.m, NULL, rates, back), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_velocity_from_rates(r.m, q, NULL, back), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_velocity_from_rates(r.m, q, rates, NULL), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

/* Only the direction of a quaternion counts, and q and -q are the same rotation. */
START_TEST(difference_ignores_length_and_sign_of_quaternions) {
    const double d0[14] = {0.1, -0.2, 0.3, 1, 2, 3, 0.5, 0.6, -0.4, 0.3, 0.2, 0.1, -0.3, 0.2};
    double neutral[EACH_NQ], q[EACH_NQ], d[14];
    robot r = BUILD(one_of_each);
    ck_assert_int_eq(r.nv, 14 + 1);
    double step[15] = {0};
    memcpy(step, d0, sizeof d0);
    ck_assert_int_eq(rbd_neutral(r.m, neutral), RBD_OK);
    ck_assert_int_eq(rbd_integrate(r.m, neutral, step, 1, q), RBD_OK);
    for (int k = 0; k < 4; k++) {
        q[FLOATING_Q + 3 + k] *= -2;
        q[SPHERICAL_Q + k] *= 0.125;
    }
    double all[15];
    ck_assert_int_eq(rbd_difference(r.m, neutral, q, all), RBD_OK);
    memcpy(d, all, sizeof d);
    expect_close("difference of scaled quaternions", &r, 0, d, d0, 14, 1e-14);
    robot_free(&r);
}
END_TEST

/* Half a turn is where the shortest rotation changes side: the result stays a rotation by pi. */
START_TEST(difference_holds_up_to_half_a_turn) {
    const rbd_body ball[1] = {
        {.parent = -1, .type = RBD_SPHERICAL, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}}};
    robot r = BUILD(ball);
    const double identity[4] = {0, 0, 0, 1}, u[3] = {2. / 3, -1. / 3, 2. / 3};
    const double angles[6] = {3.14, 3.1415926, 3.14159265358979, 0.1, 1e-8, 1e-160};
    for (int i = 0; i < 6; i++) {
        double step[3], q[4], d[3];
        for (int k = 0; k < 3; k++) step[k] = angles[i] * u[k];
        ck_assert_int_eq(rbd_integrate(r.m, identity, step, 1, q), RBD_OK);
        ck_assert_int_eq(rbd_difference(r.m, identity, q, d), RBD_OK);
        for (int k = 0; k < 3; k++) d[k] /= angles[i];
        expect_close("difference near half a turn", &r, i, d, u, 3, 1e-13);
    }
    const double half_turn[4] = {2. / 3, -1. / 3, 2. / 3, 0};
    double d[3];
    ck_assert_int_eq(rbd_difference(r.m, identity, half_turn, d), RBD_OK);
    const double length = sqrt(dot(d, d, 3));
    expect_close("half a turn", &r, 0, &length, &pi, 1, 1e-14);
    robot_free(&r);
}
END_TEST

START_TEST(integrate_keeps_quaternions_of_unit_length) {
    double q[EACH_NQ], v[15];
    uint64_t seed = 5;
    robot r = BUILD(one_of_each);
    ck_assert_int_eq(rbd_random(r.m, &seed, q), RBD_OK);
    for (int i = 0; i < 10000; i++) {
        for (int k = 0; k < 15; k++) v[k] = uniform(&seed, -5, 5);
        ck_assert_int_eq(rbd_integrate(r.m, q, v, 0.01, q), RBD_OK);
    }
    ck_assert(fabs(dot(q + FLOATING_Q + 3, q + FLOATING_Q + 3, 4) - 1) < 1e-12);
    ck_assert(fabs(dot(q + SPHERICAL_Q, q + SPHERICAL_Q, 4) - 1) < 1e-12);
    ck_assert(fabs(dot(q + CS_Q, q + CS_Q, 2) - 1) < 1e-12);
    robot_free(&r);
}
END_TEST

START_TEST(random_stays_in_its_ranges_and_fills_them) {
    double q[EACH_NQ], low[EACH_NQ], high[EACH_NQ];
    uint64_t seed = 1;
    robot r = BUILD(one_of_each);
    for (int k = 0; k < EACH_NQ; k++) {
        low[k] = 100;
        high[k] = -100;
    }
    for (int i = 0; i < 3000; i++) {
        ck_assert_int_eq(rbd_random(r.m, &seed, q), RBD_OK);
        ck_assert(fabs(dot(q + FLOATING_Q + 3, q + FLOATING_Q + 3, 4) - 1) < 1e-14);
        ck_assert(fabs(dot(q + SPHERICAL_Q, q + SPHERICAL_Q, 4) - 1) < 1e-14);
        ck_assert(fabs(dot(q + CS_Q, q + CS_Q, 2) - 1) < 1e-14);
        for (int k = 0; k < EACH_NQ; k++) {
            low[k] = fmin(low[k], q[k]);
            high[k] = larger(high[k], q[k]);
        }
    }
    for (int k = 0; k < EACH_NQ; k++) {
        const int angle = k == PLANAR_Q + 2;
        const double from = k == HINGE_Q ? 0.5 : angle ? -pi : -1, to = k == HINGE_Q ? 0.75 : angle ? pi : 1;
        ck_assert_msg(from <= low[k] && high[k] <= to, "q[%d] in (%g, %g)", k, low[k], high[k]);
        ck_assert_msg(high[k] - low[k] > 0.95 * (to - from), "q[%d] only in (%g, %g)", k, low[k], high[k]);
    }
    robot_free(&r);
}
END_TEST

/* The same of the joints that are not above: a slide along an angle's axis is a length, a (cos, sin) is of
   unit length whatever its limits say. */
START_TEST(random_knows_angles_from_lengths) {
    const rbd_body b[4] = {
        {.parent = -1, .type = RBD_CYLINDRICAL, .axis = {0, 0, 1}, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
        {.type = RBD_TRANSLATION, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 1,
         .type = RBD_UNIVERSAL,
         .axis = {1, 0, 0},
         .axis2 = {0, 1, 0},
         .mass = 1,
         .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 2,
         .type = RBD_CONTINUOUS_CS,
         .axis = {0, 0, 1},
         .mass = 1,
         .inertia = {1, 0, 0, 1, 0, 1},
         .lower = 2,
         .upper = 3}};
    enum { NQ = 9, LIMITED = 7 };
    const double range[NQ] = {pi, 1, 1, 1, 1, pi, pi, 1, 1};
    double low[NQ] = {0}, high[NQ] = {0}, q[MAX_Q];
    uint64_t seed = 8;
    robot r = BUILD(b);
    ck_assert_int_eq(r.nq, NQ);
    for (int i = 0; i < 2000; i++) {
        ck_assert_int_eq(rbd_random(r.m, &seed, q), RBD_OK);
        ck_assert(fabs(hypot(q[LIMITED], q[LIMITED + 1]) - 1) < 1e-15);
        for (int k = 0; k < NQ; k++) {
            low[k] = fmin(low[k], q[k]);
            high[k] = larger(high[k], q[k]);
        }
    }
    for (int k = 0; k < NQ; k++) {
        ck_assert_msg(-range[k] <= low[k] && high[k] <= range[k], "q[%d] in (%g, %g)", k, low[k], high[k]);
        ck_assert_msg(high[k] - low[k] > 1.9 * range[k], "q[%d] only in (%g, %g)", k, low[k], high[k]);
    }
    robot_free(&r);
}
END_TEST

/* A quaternion or angle vector of length zero is the identity, as in the dynamics. */
START_TEST(zero_quaternions_and_angles_are_the_identity) {
    const rbd_body b[3] = {{.parent = -1, .type = RBD_FLOATING, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
                           {.type = RBD_SPHERICAL, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
                           {.parent = 1,
                            .type = RBD_CONTINUOUS_CS,
                            .axis = {0, 0, 1},
                            .mass = 1,
                            .inertia = {1, 0, 0, 1, 0, 1}}};
    enum { NQ = 13, NV = 10 };
    const double none[NQ] = {0.1, 0.2, 0.3}, step[NV] = {0.3, -0.2, 0.1, 1, 2, 3, 0.4, 0.5, -0.6, 0.7};
    double identity[NQ], moved[NQ], expected[NQ], d[NV], back[NV];
    robot r = BUILD(b);
    ck_assert_int_eq(rbd_neutral(r.m, identity), RBD_OK);
    memcpy(identity, none, 3 * sizeof *none);
    ck_assert_int_eq(rbd_integrate(r.m, none, step, 1, moved), RBD_OK);
    ck_assert_int_eq(rbd_integrate(r.m, identity, step, 1, expected), RBD_OK);
    expect_close("integrate from zero", &r, 0, moved, expected, NQ, 1e-15);
    ck_assert_int_eq(rbd_difference(r.m, none, expected, d), RBD_OK);
    expect_close("difference from zero", &r, 0, d, step, NV, 1e-14);
    ck_assert_int_eq(rbd_difference(r.m, expected, none, d), RBD_OK);
    ck_assert_int_eq(rbd_difference(r.m, expected, identity, back), RBD_OK);
    expect_close("difference to zero", &r, 0, d, back, NV, 1e-15);
    ck_assert(largest(back, NV) > 0.5);
    robot_free(&r);
}
END_TEST

/* NaN is not length zero, which would be the identity. */
START_TEST(quaternion_or_angle_with_nan_is_nan) {
    const rbd_body b[3] = {
        {.parent = -1, .type = RBD_FLOATING, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
        {.type = RBD_SPHERICAL, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 1, .type = RBD_CONTINUOUS_CS, .axis = {1, 0, 0}, .mass = 1, .com = {0, 1, 0}}};
    enum { NQ = 13, NV = 10 };
    const int first[3] = {3, 7, 11}, length[3] = {4, 4, 2}, dof[3] = {0, 6, 9};
    const double v[NV] = {0.3, -0.2, 0.1, 1, 2, 3, 0.4, 0.5, -0.6, 0.7}, rates[NQ] = {0};
    double neutral[NQ], q[NQ], next[NQ], d[NV], tau[NV];
    robot r = BUILD(b);
    ck_assert_int_eq(rbd_neutral(r.m, neutral), RBD_OK);
    for (int joint = 0; joint < 3; joint++)
        for (int k = 0; k < length[joint]; k++) {
            memcpy(q, neutral, sizeof q);
            q[first[joint] + k] = NAN;
            ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, q, tau), RBD_OK);
            ck_assert(isnan(tau[NV - 1]));
            ck_assert_int_eq(rbd_integrate(r.m, q, v, 1, next), RBD_OK);
            for (int j = 0; j < length[joint]; j++) ck_assert(isnan(next[first[joint] + j]));
            ck_assert_int_eq(rbd_difference(r.m, q, neutral, d), RBD_OK);
            ck_assert(isnan(d[dof[joint]]));
            ck_assert_int_eq(rbd_difference(r.m, neutral, q, d), RBD_OK);
            ck_assert(isnan(d[dof[joint]]));
            ck_assert_int_eq(rbd_velocity_from_rates(r.m, q, rates, d), RBD_OK);
            ck_assert(isnan(d[dof[joint]]));
        }
    robot_free(&r);
}
END_TEST

/* Uniform orientation: each component of the quaternion has mean 0 and mean square 1/4. */
START_TEST(random_orientations_are_uniform) {
    const int count = 20000;
    double q[EACH_NQ], mean[4] = {0}, square[4] = {0};
    uint64_t seed = 42;
    robot r = BUILD(one_of_each);
    for (int i = 0; i < count; i++) {
        ck_assert_int_eq(rbd_random(r.m, &seed, q), RBD_OK);
        for (int k = 0; k < 4; k++) {
            mean[k] += q[SPHERICAL_Q + k] / count;
            square[k] += q[SPHERICAL_Q + k] * q[SPHERICAL_Q + k] / count;
        }
    }
    for (int k = 0; k < 4; k++) {
        ck_assert_msg(fabs(mean[k]) < 0.02, "mean %g", mean[k]); /* 5 standard deviations: 0.018 */
        ck_assert_msg(fabs(square[k] - 0.25) < 0.01, "mean square %g", square[k]);
    }
    robot_free(&r);
}
END_TEST

START_TEST(random_is_repeatable_from_any_seed) {
    const uint64_t seeds[4] = {0, 1, UINT64_MAX, UINT64_C(0x9e3779b97f4a7c15)};
    robot r = BUILD(one_of_each);
    double first[EACH_NQ], again[EACH_NQ], next[EACH_NQ], other[4][EACH_NQ];
    for (int i = 0; i < 4; i++) {
        uint64_t a = seeds[i], b = seeds[i];
        ck_assert_int_eq(rbd_random(r.m, &a, first), RBD_OK);
        ck_assert_int_eq(rbd_random(r.m, &b, again), RBD_OK);
        ck_assert_mem_eq(first, again, sizeof first);
        ck_assert(a == b && a != seeds[i]);
        ck_assert_int_eq(rbd_random(r.m, &a, next), RBD_OK);
        ck_assert(memcmp(first, next, sizeof first) != 0);
        memcpy(other[i], first, sizeof first);
        for (int k = 0; k < i; k++) ck_assert(memcmp(other[k], first, sizeof first) != 0);
    }
    robot_free(&r);
}
END_TEST

START_TEST(null_arguments_are_refused) {
    robot r = BUILD(one_of_each);
    double q[EACH_NQ], v[15] = {0};
    uint64_t seed = 1;
    ck_assert_int_eq(rbd_neutral(NULL, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_neutral(r.m, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_neutral(r.m, q), RBD_OK);
    ck_assert_int_eq(rbd_integrate(NULL, q, v, 1, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_integrate(r.m, NULL, v, 1, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_integrate(r.m, q, NULL, 1, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_integrate(r.m, q, v, 1, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_step(NULL, q, v, v, 1, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_step(r.m, NULL, v, v, 1, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_step(r.m, q, NULL, v, 1, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_step(r.m, q, v, NULL, 1, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_step(r.m, q, v, v, 1, NULL, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_step(r.m, q, v, v, 1, q, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_difference(NULL, q, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_difference(r.m, NULL, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_difference(r.m, q, NULL, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_difference(r.m, q, q, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_random(NULL, &seed, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_random(r.m, NULL, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_random(r.m, &seed, NULL), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

/* ---- rbd_interpolate, rbd_distance ---- */

/* The ends are reached to the bit; between them the way is that of rbd_integrate, at constant velocity, and
   the parts of the distance add up. */
static void check_way(const robot *r, const state *s, int number) {
    const double shares[4] = {0.25, 0.75, -0.5, 1.5};
    uint64_t seed = 91 + (uint64_t)number;
    state other;
    double q[MAX_Q], expected[MAX_Q], d[MAX_V], weight[MAX_V], zero[MAX_V] = {0}, whole, part, rest, sum = 0;
    draw_state(r, &seed, &other);
    for (int end = 0; end < 2; end++) {
        RUN(rbd_interpolate(r->m, s->q, other.q, end, q));
        RUN(rbd_integrate(r->m, end ? other.q : s->q, zero, 1, expected));
        ck_assert_msg(memcmp(q, expected, sizeof *q * (size_t)r->nq) == 0, "%s, %d: end %d", r->name, number,
                      end);
    }
    RUN(rbd_difference(r->m, s->q, other.q, d));
    for (int k = 0; k < r->nv; k++) weight[k] = uniform(&seed, 0, 3), sum += weight[k] * d[k] * d[k];
    RUN(rbd_distance(r->m, s->q, other.q, weight, &whole));
    expect_small("weighted distance", r, number, fabs(whole - sqrt(sum)) / (1 + whole), 1e-14);
    RUN(rbd_distance(r->m, s->q, other.q, NULL, &whole));
    expect_small("distance", r, number, fabs(whole - sqrt(dot(d, d, r->nv))) / (1 + whole), 1e-14);
    RUN(rbd_distance(r->m, other.q, s->q, NULL, &part));
    expect_small("distance back", r, number, fabs(whole - part) / (1 + whole), 1e-13);
    for (int i = 0; i < 4; i++) {
        RUN(rbd_interpolate(r->m, s->q, other.q, shares[i], q));
        RUN(rbd_integrate(r->m, s->q, d, shares[i], expected));
        expect_same_place("a part of the way", r, number, q, expected);
        if (shares[i] < 0 || shares[i] > 1) continue; /* farther than half a turn another way is shorter */
        RUN(rbd_distance(r->m, s->q, q, NULL, &part));
        RUN(rbd_distance(r->m, q, other.q, NULL, &rest));
        expect_small("share of the distance", r, number, fabs(part - shares[i] * whole) / (1 + whole), 1e-13);
        expect_small("rest of the distance", r, number, fabs(part + rest - whole) / (1 + whole), 1e-13);
    }
    for (int from = 0; from < 2; from++) { /* in place */
        RUN(rbd_interpolate(r->m, s->q, other.q, 0.25, expected));
        memcpy(q, from ? other.q : s->q, sizeof q);
        RUN(rbd_interpolate(r->m, from ? s->q : q, from ? q : other.q, 0.25, q));
        ck_assert(memcmp(q, expected, sizeof *q * (size_t)r->nq) == 0);
    }
}

START_TEST(ways_lead_from_end_to_end) {
    for_random_states(10, check_way);
    for_random_trees(100, check_way);
}
END_TEST

/* Shoemake's slerp, of quaternions of any length and sign. */
START_TEST(orientations_take_the_great_circle) {
    const rbd_body ball[1] = {
        {.parent = -1, .type = RBD_SPHERICAL, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}}};
    robot r = BUILD(ball);
    uint64_t seed = 17;
    for (int i = 0; i < 100; i++) {
        double a[4], b[4], long_a[4], q[4], distance;
        const double s = i % 11 / 10.;
        expect_ok("ball", &r, i, rbd_random(r.m, &seed, a));
        expect_ok("ball", &r, i, rbd_random(r.m, &seed, b));
        const double cosine = dot(a, b, 4), sign = cosine < 0 ? -1 : 1, angle = acos(fabs(cosine));
        const double from = sin((1 - s) * angle) / sin(angle), to = sign * sin(s * angle) / sin(angle);
        for (int k = 0; k < 4; k++) long_a[k] = a[k] * (i % 3 ? 1 : 40);
        expect_ok("ball", &r, i, rbd_interpolate(r.m, long_a, b, s, q));
        const double side = s < 1 ? 1 : sign; /* at the end it is b itself */
        for (int k = 0; k < 4; k++)
            ck_assert_msg(fabs(q[k] - side * (from * a[k] + to * b[k])) < 1e-12, "%d: component %d", i, k);
        expect_ok("ball", &r, i, rbd_distance(r.m, a, b, NULL, &distance));
        ck_assert_msg(fabs(distance - 2 * angle) < 1e-12, "%d: distance %g", i, distance);
    }
    robot_free(&r);
}
END_TEST

/* An unbounded angle does not know of turns, (cos, sin) takes the short way, and a planar joint too. */
START_TEST(angles_take_the_way_of_their_joint) {
    const rbd_body rows[3] = {
        {.parent = -1, .type = RBD_CONTINUOUS, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}},
        {.parent = -1, .type = RBD_CONTINUOUS_CS, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}},
        {.parent = -1, .type = RBD_PLANAR, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}}};
    const double turn = 2 * pi, q0[6] = {0.25, cos(0.25), sin(0.25), 0, 0, 0.25},
                 q1[6] = {0.25 + turn - 1, cos(-0.75), sin(-0.75), 0, 0, 0.25 + turn - 1};
    const double half[6] = {0.25 + (turn - 1) / 2, cos(-0.25), sin(-0.25), 0, 0, -0.25};
    const double weights[5] = {0, 1, 4, 0, 0}; /* of v: continuous; (cos, sin); planar omega, vx, vy */
    double q[6], distance;
    robot r = BUILD(rows);
    ck_assert_int_eq(rbd_interpolate(r.m, q0, q1, 0.5, q), RBD_OK);
    expect_close("half way", &r, 0, q, half, 6, 1e-14);
    ck_assert_int_eq(rbd_interpolate(r.m, q0, q1, 1, q), RBD_OK);
    ck_assert(!(fabs(q[0] - q1[0]) > 0) && !(fabs(q[5] - q1[5]) > 0));
    ck_assert_int_eq(rbd_distance(r.m, q0, q1, NULL, &distance), RBD_OK);
    ck_assert(fabs(distance - sqrt(2 + (turn - 1) * (turn - 1))) < 1e-13);
    ck_assert_int_eq(rbd_distance(r.m, q0, q1, weights, &distance), RBD_OK);
    ck_assert(fabs(distance - sqrt(1 + 4)) < 1e-13);
    robot_free(&r);
}
END_TEST

START_TEST(bad_shares_and_weights_are_seen) {
    const double bad[2] = {-1e-300, NAN};
    double q0[EACH_NQ], q1[EACH_NQ], q[EACH_NQ], weight[15], distance = 5;
    uint64_t seed = 3;
    robot r = BUILD(one_of_each);
    ck_assert_int_eq(rbd_random(r.m, &seed, q0), RBD_OK);
    ck_assert_int_eq(rbd_random(r.m, &seed, q1), RBD_OK);
    ck_assert_int_eq(rbd_interpolate(r.m, q0, q1, NAN, q), RBD_OK);
    for (int k = 0; k < EACH_NQ; k++) ck_assert(isnan(q[k]));
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < EACH_NQ; k++) { /* a coordinate that is NaN reaches its joint, at both ends too */
            const double was = q0[k];
            int found = 0;
            q0[k] = NAN;
            ck_assert_int_eq(rbd_interpolate(r.m, q0, q1, end, q), RBD_OK);
            for (int j = 0; j < EACH_NQ; j++) found += isnan(q[j]) != 0;
            ck_assert(found > 0);
            ck_assert_int_eq(rbd_distance(r.m, q0, q1, NULL, &distance), RBD_OK);
            ck_assert(isnan(distance));
            q0[k] = was;
        }
    for (int k = 0; k < 15; k++) weight[k] = 0;
    ck_assert_int_eq(rbd_distance(r.m, q0, q1, weight, &distance), RBD_OK);
    ck_assert(!(fabs(distance) > 0));
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 15; k++) {
            weight[k] = bad[i];
            ck_assert_int_eq(rbd_distance(r.m, q0, q1, weight, &distance), RBD_ERR_RANGE);
            weight[k] = 0;
        }
    ck_assert_int_eq(rbd_interpolate(NULL, q0, q1, 0, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_interpolate(r.m, NULL, q1, 0, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_interpolate(r.m, q0, NULL, 0, q), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_interpolate(r.m, q0, q1, 0, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_distance(NULL, q0, q1, NULL, &distance), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_distance(r.m, NULL, q1, NULL, &distance), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_distance(r.m, q0, NULL, NULL, &distance), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_distance(r.m, q0, q1, NULL, NULL), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

/* ---- rbd_step ---- */

/* A body that turns about its centre of mass, without forces: its velocity in the world stays at any dt. */
START_TEST(step_of_a_free_body_is_exact) {
    for (int planar = 0; planar < 2; planar++) {
        const rbd_body body[1] = {{.parent = -1,
                                   .type = planar ? RBD_PLANAR : RBD_FLOATING,
                                   .mass = 2,
                                   .inertia = {0.1, 0, 0, 0.1, 0, 0.1}}};
        robot r = BUILD(body);
        const double none[3] = {0, 0, 0}, dt = 0.05, v0[6] = {3, -2, 4, 1, 2, -1}, zero[6] = {0};
        double q[7], v[6], a[6], velocity[6], at_first[6], p[3];
        rbd_set_gravity(r.w, none);
        rbd_neutral(r.m, q);
        memcpy(v, v0, sizeof v);
        rbd_kinematics(r.m, r.w, q, v, NULL);
        rbd_point_velocity(r.m, r.w, 0, none, RBD_WORLD_AXES, at_first);
        for (int n = 1; n <= 100; n++) {
            ck_assert_int_eq(rbd_aba(r.m, r.w, q, v, zero, NULL, a), RBD_OK);
            ck_assert_int_eq(rbd_step(r.m, q, v, a, dt, q, v), RBD_OK);
            rbd_kinematics(r.m, r.w, q, v, NULL);
            rbd_point_velocity(r.m, r.w, 0, none, RBD_WORLD_AXES, velocity);
            rbd_point_position(r.m, r.w, 0, none, p);
            for (int j = 0; j < 6; j++) ck_assert(fabs(velocity[j] - at_first[j]) < 1e-11);
            for (int j = 0; j < 3; j++) ck_assert(fabs(p[j] - n * dt * at_first[3 + j]) < 1e-11);
        }
        robot_free(&r);
    }
}
END_TEST

/* Of each type: 'L' where a coordinate is a length, from -1 to 1, 'A' where it is an angle. */
START_TEST(random_lengths_and_angles) {
    static const char *const coordinates[RBD_JOINT_TYPES] = {
        [RBD_REVOLUTE] = "A",    [RBD_CONTINUOUS] = "A",   [RBD_PRISMATIC] = "L",
        [RBD_HELICAL] = "A",     [RBD_CYLINDRICAL] = "AL", [RBD_UNIVERSAL] = "AA",
        [RBD_EULER_ZYX] = "AAA", [RBD_EULER_XYZ] = "AAA",  [RBD_EULER_YXZ] = "AAA",
        [RBD_EULER_ZXY] = "AAA", [RBD_PLANAR] = "LLA",     [RBD_TRANSLATION] = "LLL",
        [RBD_FLOATING] = "LLL",  [RBD_CONTINUOUS_CS] = "", [RBD_SPHERICAL] = ""};

    for (int type = RBD_FIXED + 1; type < RBD_JOINT_TYPES; type++) {
        const rbd_body body[1] = {{.parent = -1,
                                   .type = (rbd_joint_type)type,
                                   .axis = {0, 0, 1},
                                   .axis2 = {1, 0, 0},
                                   .mass = 1,
                                   .inertia = {1, 0, 0, 1, 0, 1}}};
        robot r = BUILD(body);
        double most[3] = {0};
        uint64_t seed = 5;
        ck_assert_msg(coordinates[type] != NULL, "type %d has no row here", type);
        for (int k = 0; k < 300; k++) {
            double q[7];
            ck_assert_int_eq(rbd_random(r.m, &seed, q), RBD_OK);
            for (int i = 0; coordinates[type][i]; i++) most[i] = larger(most[i], fabs(q[i]));
        }
        for (int i = 0; coordinates[type][i]; i++) {
            const double end = coordinates[type][i] == 'L' ? 1 : 3.14159265358979;
            ck_assert_msg(most[i] <= end && most[i] > 0.9 * end, "type %d, q[%d]: up to %g", type, i,
                          most[i]);
        }
        robot_free(&r);
    }
}
END_TEST

/* To first order it is v + dt a and rbd_integrate; where no joint has body axes, exactly. */
static void check_step(const robot *r, const state *s, int number) {
    const double sizes[2] = {1e-7, 0.1};
    int plain = 1;
    for (int b = 0; b < r->nb; b++) {
        const rbd_joint_type type = r->bodies[b].type;
        plain &= type != RBD_FLOATING && type != RBD_PLANAR && type != RBD_SPHERICAL;
    }
    for (int i = 0; i < 2; i++) {
        double v[MAX_V], q[MAX_Q], v_next[MAX_V], q_next[MAX_Q];
        if (i == 1 && !plain) continue;
        for (int k = 0; k < r->nv; k++) v[k] = s->v[k] + sizes[i] * s->a[k];
        RUN(rbd_integrate(r->m, s->q, v, sizes[i], q));
        RUN(rbd_step(r->m, s->q, s->v, s->a, sizes[i], q_next, v_next));
        expect_close("step", r, number, q_next, q, r->nq, 1e-11);
        expect_close("step, v", r, number, v_next, v, r->nv, plain ? 1e-11 : 1e-5);
    }
}
START_TEST(step_is_first_order) { for_random_trees(50, check_step); }
END_TEST

Suite *manifold_suite(void) {
    Suite *suite = suite_create("manifold");
    TCase *c = tcase_create("manifold");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, integrate_and_difference_match_the_reference);
    tcase_add_test(c, difference_undoes_integrate);
    tcase_add_test(c, steps_add_up);
    tcase_add_test(c, difference_leads_from_any_place_to_any_other);
    tcase_add_test(c, integrate_moves_bodies_by_their_velocity);
    tcase_add_test(c, rates_are_derivatives_of_the_coordinates);
    tcase_add_test(c, rates_of_any_length_are_finite);
    tcase_add_test(c, rates_without_a_direction_are_zero);
    tcase_add_test(c, neutral_is_zero_with_identity_rotations);
    tcase_add_test(c, difference_ignores_length_and_sign_of_quaternions);
    tcase_add_test(c, difference_holds_up_to_half_a_turn);
    tcase_add_test(c, integrate_keeps_quaternions_of_unit_length);
    tcase_add_test(c, random_stays_in_its_ranges_and_fills_them);
    tcase_add_test(c, random_knows_angles_from_lengths);
    tcase_add_test(c, zero_quaternions_and_angles_are_the_identity);
    tcase_add_test(c, quaternion_or_angle_with_nan_is_nan);
    tcase_add_test(c, random_orientations_are_uniform);
    tcase_add_test(c, random_is_repeatable_from_any_seed);
    tcase_add_test(c, ways_lead_from_end_to_end);
    tcase_add_test(c, orientations_take_the_great_circle);
    tcase_add_test(c, angles_take_the_way_of_their_joint);
    tcase_add_test(c, bad_shares_and_weights_are_seen);
    tcase_add_test(c, step_of_a_free_body_is_exact);
    tcase_add_test(c, step_is_first_order);
    tcase_add_test(c, null_arguments_are_refused);
    tcase_add_test(c, random_lengths_and_angles);
    suite_add_tcase(suite, c);
    return suite;
}
