/* test_rnea.c - [rnea]: inverse dynamics, bias force, gravity torque. */
#include <string.h>

#include "suites.h"
#include "support.h"

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const int nv = model->nv;
    double tau[MAX_V];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->vdot, NULL, tau));
    expect_close("rnea", r, number, tau, s->tau_rnea, nv, 1e-14);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->vdot, s->f_ext, tau));
    expect_close("rnea, wrenches", r, number, tau, s->tau_rnea_ext, nv, 1e-14);
    RUN(rbd_bias(r->m, r->w, s->q, s->v, NULL, tau));
    expect_close("bias", r, number, tau, s->c, nv, 1e-12); /* iiwa at rest: hardly any torque */
    RUN(rbd_gravity_torque(r->m, r->w, s->q, tau));
    expect_close("gravity", r, number, tau, s->g, nv, 1e-12);
}

START_TEST(inverse_dynamics_match_the_reference) { for_reference_states(check_reference); }
END_TEST

static void check_textbook(const robot *r, const state *s, int number) {
    const double zero[MAX_V] = {0};
    double tau[MAX_V];
    tb_real expected[TB_MAX_DOFS];
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, s->a, s->f_ext, expected, NULL);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, tau));
    expect_close_tb("rnea, textbook", r, number, tau, expected, r->nv, 1e-13);
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, zero, s->f_ext, expected, NULL);
    RUN(rbd_bias(r->m, r->w, s->q, s->v, s->f_ext, tau));
    expect_close_tb("bias, textbook", r, number, tau, expected, r->nv, 1e-13);
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, zero, zero, NULL, expected, NULL);
    RUN(rbd_gravity_torque(r->m, r->w, s->q, tau));
    expect_close_tb("gravity, textbook", r, number, tau, expected, r->nv, 1e-13);
}

START_TEST(inverse_dynamics_match_the_textbook_on_random_trees) { for_random_trees(400, check_textbook); }
END_TEST

static void check_bias(const robot *r, const state *s, int number) {
    const double zero[MAX_V] = {0};
    double tau[MAX_V], c[MAX_V], g[MAX_V];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, zero, s->f_ext, tau));
    RUN(rbd_bias(r->m, r->w, s->q, s->v, s->f_ext, c));
    expect_close("bias = rnea at a = 0", r, number, c, tau, r->nv, 1e-13);
    RUN(rbd_rnea(r->m, r->w, s->q, zero, zero, NULL, tau));
    RUN(rbd_gravity_torque(r->m, r->w, s->q, g));
    expect_close("gravity = rnea at rest", r, number, g, tau, r->nv, 1e-13);
}

START_TEST(bias_and_gravity_are_inverse_dynamics_at_rest) { for_random_states(20, check_bias); }
END_TEST

/* tau(no wrench) - tau(wrench) = sum J' f: component k is the power of the wrenches at v = e_k. */
static void check_virtual_work(const robot *r, const state *s, int number) {
    double plain[MAX_V], loaded[MAX_V], difference[MAX_V], power[MAX_V], unit[MAX_V] = {0}, velocity[6];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, NULL, plain));
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, loaded));
    for (int k = 0; k < r->nv; k++) {
        unit[k] = 1;
        RUN(rbd_kinematics(r->m, r->w, s->q, unit, NULL));
        unit[k] = 0;
        power[k] = 0;
        for (int i = 0; i < r->nb; i++) {
            RUN(rbd_body_velocity(r->m, r->w, i, velocity));
            power[k] += dot(velocity, s->f_ext + 6 * i, 6);
        }
        difference[k] = plain[k] - loaded[k];
    }
    expect_close("wrench by virtual work", r, number, difference, power, r->nv, 1e-11);
}

START_TEST(wrenches_act_by_virtual_work) {
    for_random_states(3, check_virtual_work);
    for_random_trees(50, check_virtual_work);
}
END_TEST

static void check_null_wrench(const robot *r, const state *s, int number) {
    const double none[6 * MAX_BODIES] = {0};
    double without[MAX_V], with[MAX_V];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, NULL, without));
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, none, with));
    expect_close("rnea, zero wrench", r, number, with, without, r->nv, 1e-15);
}

START_TEST(null_wrench_is_zero_wrench) { for_random_states(3, check_null_wrench); }
END_TEST

static void check_in_place(const robot *r, const state *s, int number) {
    const size_t size = (size_t)r->nv * sizeof(double);
    double apart[MAX_V], same[MAX_V];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, apart));
    memcpy(same, s->a, size);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, same, s->f_ext, same));
    ck_assert_msg(memcmp(same, apart, size) == 0, "%s: tau may be a", r->name);
    memcpy(same, s->v, size);
    RUN(rbd_rnea(r->m, r->w, s->q, same, s->a, s->f_ext, same));
    ck_assert_msg(memcmp(same, apart, size) == 0, "%s: tau may be v", r->name);
    RUN(rbd_bias(r->m, r->w, s->q, s->v, NULL, apart));
    memcpy(same, s->v, size);
    RUN(rbd_bias(r->m, r->w, s->q, same, NULL, same));
    ck_assert_msg(memcmp(same, apart, size) == 0, "%s: c may be v", r->name);
}

START_TEST(output_may_be_an_input) {
    for_random_states(3, check_in_place);
    for_random_trees(40, check_in_place);
}
END_TEST

/* The same call gives the same bits, whatever ran between. */
static void check_repeatable(const robot *r, const state *s, int number) {
    double first[MAX_V], again[MAX_V], between[MAX_V], M[MAX_V * MAX_V];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, NULL, first));
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_kinematics(r->m, r->w, s->q, s->a, s->v));
    RUN(rbd_gravity_torque(r->m, r->w, s->q, between));
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, NULL, again));
    ck_assert_msg(memcmp(first, again, (size_t)r->nv * sizeof(double)) == 0, "%s: other bits", r->name);
}

START_TEST(same_call_gives_same_bits) { for_random_states(3, check_repeatable); }
END_TEST

START_TEST(null_arguments_are_refused) {
    robot r = robot_build("atlas", reference_model(0)->bodies, reference_model(0)->nb);
    const double x[MAX_Q] = {0};
    double out[MAX_V];
    ck_assert_int_eq(rbd_rnea(NULL, r.w, x, x, x, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rnea(r.m, NULL, x, x, x, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rnea(r.m, r.w, NULL, x, x, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rnea(r.m, r.w, x, NULL, x, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rnea(r.m, r.w, x, x, NULL, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rnea(r.m, r.w, x, x, x, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_bias(NULL, r.w, x, x, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_bias(r.m, NULL, x, x, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_bias(r.m, r.w, NULL, x, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_bias(r.m, r.w, x, NULL, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_bias(r.m, r.w, x, x, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_gravity_torque(NULL, r.w, x, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_gravity_torque(r.m, NULL, x, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, NULL, out), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, x, NULL), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

Suite *rnea_suite(void) {
    Suite *suite = suite_create("rnea");
    TCase *c = tcase_create("rnea");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, inverse_dynamics_match_the_reference);
    tcase_add_test(c, inverse_dynamics_match_the_textbook_on_random_trees);
    tcase_add_test(c, bias_and_gravity_are_inverse_dynamics_at_rest);
    tcase_add_test(c, wrenches_act_by_virtual_work);
    tcase_add_test(c, null_wrench_is_zero_wrench);
    tcase_add_test(c, output_may_be_an_input);
    tcase_add_test(c, same_call_gives_same_bits);
    tcase_add_test(c, null_arguments_are_refused);
    suite_add_tcase(suite, c);
    return suite;
}
