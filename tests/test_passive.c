/* test_passive.c - rbd_passive: damping and friction of the joints. */
#include <math.h>

#include "suites.h"
#include "support.h"

static const rbd_body chain[] = {
    {.joint = "a",
     .parent = -1,
     .type = RBD_REVOLUTE,
     .axis = {0, 1, 0},
     .position = {1, 0, 0},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1},
     .damping = {0.5},
     .friction = {2}},
    {.joint = "b",
     .parent = 0,
     .type = RBD_SPHERICAL,
     .position = {1, 0, 0},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1},
     .damping = {1, 2, 3},
     .friction = {0, 10, 0}},
    {.joint = "c",
     .parent = 0,
     .type = RBD_PRISMATIC,
     .axis = {1, 0, 0},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1},
     .damping = {4},
     .friction = {0.25},
     .mimic = "a",
     .mimic_ratio = -3},
    {.parent = 2, .type = RBD_FIXED, .damping = {9}, .friction = {9}},
};

/* The follower moves at -3 v: its torque -4 (-3 v) - 0.25 sign(-3 v) comes back times -3. */
START_TEST(damping_and_friction_oppose_the_motion) {
    const double v[3][4] = {{2, 1, -1, 0.5}, {-0.5, 0, 0, 0}, {0, 0, 1, -1e-300}};
    const double expected[3][4] = {{-0.5 * 2 - 2 - 9 * 4 * 2 - 3 * 0.25, -1, 2 + 10, -1.5},
                                   {0.5 * 0.5 + 2 + 9 * 4 * 0.5 + 3 * 0.25, 0, 0, 0},
                                   {0, 0, -2 - 10, 3e-300}};
    robot r = BUILD(chain);
    double tau[4];
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(rbd_passive(r.m, r.w, v[i], tau), RBD_OK);
        expect_close("passive torque", &r, i, tau, expected[i], 4, 1e-15);
    }
    double same[4] = {2, 1, -1, 0.5};
    ck_assert_int_eq(rbd_passive(r.m, r.w, same, same), RBD_OK);
    expect_close("passive torque in place", &r, 0, same, expected[0], 4, 1e-15);
    robot_free(&r);
}
END_TEST

static void check_frictionless(const robot *r, const state *s, int number) {
    double tau[MAX_V];
    RUN(rbd_passive(r->m, r->w, s->v, tau));
    ck_assert_msg(!(largest(tau, r->nv) > 0), "%s", r->name);
}

START_TEST(joints_without_friction_have_none) { for_random_states(1, check_frictionless); }
END_TEST

/* No algorithm applies them by itself. */
START_TEST(dynamics_leave_damping_and_friction_out) {
    rbd_body slippery[LENGTH(chain)];
    for (int i = 0; i < LENGTH(chain); i++) {
        slippery[i] = chain[i];
        for (int k = 0; k < 6; k++) slippery[i].damping[k] = slippery[i].friction[k] = 0;
    }
    robot with = BUILD(chain), without = BUILD(slippery);
    const double q[5] = {0.3, 0, 0, 0.6, 0.8}, v[4] = {1, -2, 3, 4}, zero[4] = {0};
    double a[2][4];
    ck_assert_int_eq(rbd_rnea(with.m, with.w, q, v, zero, NULL, a[0]), RBD_OK);
    ck_assert_int_eq(rbd_rnea(without.m, without.w, q, v, zero, NULL, a[1]), RBD_OK);
    ck_assert_mem_eq(a[0], a[1], sizeof a[0]);
    ck_assert_int_eq(rbd_aba(with.m, with.w, q, v, zero, NULL, a[0]), RBD_OK);
    ck_assert_int_eq(rbd_aba(without.m, without.w, q, v, zero, NULL, a[1]), RBD_OK);
    ck_assert_mem_eq(a[0], a[1], sizeof a[0]);
    robot_free(&with);
    robot_free(&without);
}
END_TEST

START_TEST(null_arguments_are_refused) {
    robot r = BUILD(chain);
    double x[4] = {0};
    ck_assert_int_eq(rbd_passive(NULL, r.w, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_passive(r.m, NULL, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_passive(r.m, r.w, NULL, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_passive(r.m, r.w, x, NULL), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

Suite *passive_suite(void) {
    Suite *suite = suite_create("passive");
    TCase *c = tcase_create("passive");
    tcase_add_test(c, damping_and_friction_oppose_the_motion);
    tcase_add_test(c, joints_without_friction_have_none);
    tcase_add_test(c, dynamics_leave_damping_and_friction_out);
    tcase_add_test(c, null_arguments_are_refused);
    suite_add_tcase(suite, c);
    return suite;
}
