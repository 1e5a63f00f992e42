/* test_jacobians.c - derivatives of Jacobians of rbd_derivatives.h. */
#include <math.h>
#include <string.h>

#include "rbd_derivatives.h"

#include "suites.h"
#include "support.h"

enum { MAX_J = 6 * MAX_V, WAYS = 4 };

/* A body and a point of it, and the body that it is seen from. */
typedef struct place {
    int body, reference;
    double point[3];
} place;

static place draw_place(const robot *r, int number) {
    uint64_t seed = 71 * (uint64_t)number + (uint64_t)r->nb;
    place at;
    for (int k = 0; k < 3; k++) at.point[k] = uniform(&seed, -1, 1);
    at.body = below(&seed, r->nb);
    at.reference = below(&seed, r->nb);
    return at;
}

/* The Jacobians, and their derivatives, in the axes of the world and of the link, of the world and of another
   body. */
static rbd_status jacobian_of(const robot *r, const place *at, int way, double *J) {
    const rbd_axes axes = (rbd_axes)(way % 2);
    return way < 2 ? rbd_jacobian(r->m, r->w, at->body, at->point, axes, J)
                   : rbd_relative_jacobian(r->m, r->w, at->body, at->point, at->reference, axes, J);
}
static rbd_status derivative_of(const robot *r, const place *at, int way, double *J_dot) {
    const rbd_axes axes = (rbd_axes)(way % 2);
    memset(J_dot, 0xff, sizeof *J_dot * 6 * (size_t)r->nv); /* NaN: each entry must be written */
    return way < 2 ? rbd_jacobian_derivative(r->m, r->w, at->body, at->point, axes, J_dot)
                   : rbd_relative_jacobian_derivative(r->m, r->w, at->body, at->point, at->reference, axes,
                                                      J_dot);
}

/* J along q moved by v t, by differences, Richardson from steps h and h / 2. */
static void check_differences(const robot *r, const state *s, int number) {
    const int n = 6 * r->nv;
    const place at = draw_place(r, number);
    double found[MAX_J], rate[2][MAX_J], side[2][MAX_J];
    for (int way = 0; way < WAYS; way++) {
        for (int half = 0; half < 2; half++) {
            const double h = half ? 5e-4 : 1e-3;
            for (int i = 0; i < 2; i++) {
                double q[MAX_Q];
                RUN(rbd_integrate(r->m, s->q, s->v, i ? h : -h, q));
                RUN(rbd_kinematics(r->m, r->w, q, NULL, NULL));
                RUN(jacobian_of(r, &at, way, side[i]));
            }
            for (int i = 0; i < n; i++) rate[half][i] = (side[1][i] - side[0][i]) / (2 * h);
        }
        for (int i = 0; i < n; i++) rate[1][i] += (rate[1][i] - rate[0][i]) / 3;

        RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
        RUN(derivative_of(r, &at, way, found));
        const double scale = 1 + largest(rate[1], n);
        for (int i = 0; i < n; i++)
            expect_small("dJ/dt by differences", r, number, fabs(found[i] - rate[1][i]) / scale, 1e-9);
    }
}

START_TEST(derivative_is_that_of_the_jacobian) {
    for_random_trees(120, check_differences);
    for_random_states(2, check_differences);
}
END_TEST

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* dJ/dt v is the point's acceleration at a = 0: the classical one in world axes, the rate of the components
   of its velocity in link axes. */
static void check_acceleration(const robot *r, const state *s, int number) {
    const place at = draw_place(r, number);
    double J_dot[MAX_J], found[6], expected[6], motion[6], turned[3];
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    for (int axes = RBD_WORLD_AXES; axes <= RBD_LINK_AXES; axes++) {
        RUN(derivative_of(r, &at, axes, J_dot));
        multiply(J_dot, s->v, 6, r->nv, found);
        RUN(rbd_point_acceleration(r->m, r->w, at.body, at.point, (rbd_axes)axes, expected));
        RUN(rbd_point_velocity(r->m, r->w, at.body, at.point, (rbd_axes)axes, motion));
        cross(motion, motion + 3, turned);
        const double scale = 1 + largest(expected, 6) + largest(turned, 3);
        for (int k = 0; k < 3 && axes == RBD_LINK_AXES; k++) expected[3 + k] -= turned[k];
        for (int k = 0; k < 6; k++)
            expect_small("dJ/dt v", r, number, fabs(found[k] - expected[k]) / scale, 1e-12);
    }

    /* of the link's origin it is the spatial acceleration */
    RUN(rbd_jacobian_derivative(r->m, r->w, at.body, NULL, RBD_LINK_AXES, J_dot));
    multiply(J_dot, s->v, 6, r->nv, found);
    RUN(rbd_body_acceleration(r->m, r->w, at.body, expected));
    const double scale = 1 + largest(expected, 6);
    for (int k = 0; k < 6; k++)
        expect_small("dJ/dt v, spatial", r, number, fabs(found[k] - expected[k]) / scale, 1e-12);
}

START_TEST(derivative_times_v_is_the_acceleration) {
    for_random_trees(200, check_acceleration);
    for_random_states(3, check_acceleration);
}
END_TEST

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    double J_dot[MAX_J], found[6];
    (void)model;
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->vdot));
    RUN(rbd_jacobian_derivative(r->m, r->w, s->jac_body, NULL, RBD_WORLD_AXES, J_dot));
    multiply(J_dot, s->v, 6, r->nv, found);
    expect_close("dJ/dt v, world axes", r, number, found, s->Jdot_v_world, 6, 1e-12);
}

START_TEST(derivative_matches_the_reference) { for_reference_states(check_reference); }
END_TEST

/* One body and its ancestors are enough; between a body and itself nothing moves. */
static void check_path(const robot *r, const state *s, int number) {
    const place at = draw_place(r, number);
    double whole[MAX_J], path[MAX_J];
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(derivative_of(r, &at, RBD_LINK_AXES, whole));
    RUN(rbd_body_kinematics(r->m, r->w, at.body, s->q, s->v, NULL));
    RUN(derivative_of(r, &at, RBD_LINK_AXES, path));
    expect_close("dJ/dt of a path", r, number, path, whole, 6 * r->nv, 1e-13);
    for (int axes = RBD_WORLD_AXES; axes <= RBD_LINK_AXES; axes++) {
        RUN(rbd_relative_jacobian_derivative(r->m, r->w, at.body, at.point, at.body, (rbd_axes)axes, path));
        ck_assert(!(largest(path, 6 * r->nv) > 0));
    }
    RUN(rbd_kinematics(r->m, r->w, s->q, NULL, NULL)); /* at rest, in a work that has velocities of before */
    for (int way = 0; way < WAYS; way++) {
        RUN(derivative_of(r, &at, way, path));
        ck_assert(!(largest(path, 6 * r->nv) > 0));
    }
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_relative_jacobian_derivative(r->m, r->w, at.body, at.point, -1, RBD_LINK_AXES, path));
    RUN(rbd_jacobian_derivative(r->m, r->w, at.body, at.point, RBD_WORLD_AXES, whole));
    ck_assert(memcmp(path, whole, 6 * (size_t)r->nv * sizeof *path) == 0);
}

START_TEST(paths_suffice) { for_random_trees(60, check_path); }
END_TEST

/* The tip of a pendulum of length 2 that turns about z: J = (0 0 1; -2 sin q, 2 cos q, 0) in world axes, and
   constant in its own. */
START_TEST(pendulum_has_a_closed_form) {
    const rbd_body rod[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}}};
    const double q[1] = {0.7}, v[1] = {3}, a[1] = {5}, tip[3] = {2, 0, 0};
    const double expected[6] = {0, 0, 0, -2 * cos(0.7) * 3, -2 * sin(0.7) * 3, 0};
    robot r = BUILD(rod);
    double J_dot[6];
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, v, a), RBD_OK);
    ck_assert_int_eq(rbd_jacobian_derivative(r.m, r.w, 0, tip, RBD_WORLD_AXES, J_dot), RBD_OK);
    for (int k = 0; k < 6; k++) ck_assert(fabs(J_dot[k] - expected[k]) < 1e-14);
    ck_assert_int_eq(rbd_jacobian_derivative(r.m, r.w, 0, tip, RBD_LINK_AXES, J_dot), RBD_OK);
    for (int k = 0; k < 6; k++) ck_assert(fabs(J_dot[k]) < 1e-14);

    /* at rest it is 0, also with accelerations, and after a call that left velocities in the work */
    for (int with_a = 0; with_a < 2; with_a++) {
        memset(J_dot, 0xff, sizeof J_dot);
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, with_a ? a : NULL), RBD_OK);
        ck_assert_int_eq(rbd_jacobian_derivative(r.m, r.w, 0, tip, RBD_WORLD_AXES, J_dot), RBD_OK);
        for (int k = 0; k < 6; k++) ck_assert(fabs(J_dot[k]) <= 0);
    }
    robot_free(&r);
}
END_TEST

#define EXPECT_BOTH(status, m, w, b) \
    do { \
        ck_assert_int_eq(rbd_jacobian_derivative(m, w, b, NULL, RBD_WORLD_AXES, x), status); \
        ck_assert_int_eq(rbd_relative_jacobian_derivative(m, w, b, NULL, 0, RBD_WORLD_AXES, x), status); \
    } while (0)

START_TEST(errors_have_their_names) {
    const ref_model *iiwa = reference_model(2), *hyq = reference_model(1);
    robot r = robot_build(iiwa->name, iiwa->bodies, iiwa->nb);
    robot other = robot_build(hyq->name, hyq->bodies, hyq->nb);
    const double q[MAX_Q] = {0};
    double x[42];
    EXPECT_BOTH(RBD_ERR_ORDER, r.m, r.w, 0);
    ck_assert_int_eq(rbd_body_kinematics(r.m, r.w, 2, q, q, NULL), RBD_OK);
    EXPECT_BOTH(RBD_OK, r.m, r.w, 2);
    EXPECT_BOTH(RBD_ERR_ORDER, r.m, r.w, 6);
    ck_assert_int_eq(rbd_relative_jacobian_derivative(r.m, r.w, 2, NULL, 6, RBD_LINK_AXES, x), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, q, NULL), RBD_OK);
    EXPECT_BOTH(RBD_OK, r.m, r.w, 6);
    EXPECT_BOTH(RBD_ERR_NULL, NULL, r.w, 0);
    EXPECT_BOTH(RBD_ERR_NULL, r.m, NULL, 0);
    EXPECT_BOTH(RBD_ERR_WORK, other.m, r.w, 0);
    EXPECT_BOTH(RBD_ERR_INDEX, r.m, r.w, -1);
    EXPECT_BOTH(RBD_ERR_INDEX, r.m, r.w, 7);
    for (int reference = -2; reference <= 7; reference += 9)
        ck_assert_int_eq(rbd_relative_jacobian_derivative(r.m, r.w, 0, NULL, reference, RBD_LINK_AXES, x),
                         RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_jacobian_derivative(r.m, r.w, 0, NULL, RBD_WORLD_AXES, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_relative_jacobian_derivative(r.m, r.w, 0, NULL, 1, RBD_WORLD_AXES, NULL),
                     RBD_ERR_NULL);
    robot_free(&r);
    robot_free(&other);
}
END_TEST

Suite *jacobians_suite(void) {
    Suite *suite = suite_create("jacobians");
    TCase *c = tcase_create("jacobians");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, derivative_is_that_of_the_jacobian);
    tcase_add_test(c, derivative_times_v_is_the_acceleration);
    tcase_add_test(c, derivative_matches_the_reference);
    tcase_add_test(c, paths_suffice);
    tcase_add_test(c, pendulum_has_a_closed_form);
    tcase_add_test(c, errors_have_their_names);
    suite_add_tcase(suite, c);
    return suite;
}
