/* test_aba.c - [aba]: forward dynamics by articulated bodies, and its agreement with the other way. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const double bound = 1e-13;
    double a[MAX_V];
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, NULL, a));
    expect_close("aba", r, number, a, s->qdd, model->nv, bound);
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, a));
    expect_close("aba, wrenches", r, number, a, s->qdd_ext, model->nv, bound);
    ck_assert_int_eq(rbd_singular_dof(r->w), -1);
}

START_TEST(forward_dynamics_match_the_reference) { for_reference_states(check_reference); }
END_TEST

static void check_textbook(const robot *r, const state *s, int number) {
    expect_textbook_forward("aba, textbook", rbd_aba, r, s, number);
}

START_TEST(forward_dynamics_match_the_textbook_on_random_trees) { for_random_trees(300, check_textbook); }
END_TEST

static double condition_of(const robot *r, const state *s) {
    tb_real a[TB_MAX_DOFS];
    return (double)tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, NULL, a);
}

/* Twice the bound of one inversion: tau is rounded, which M^-1 amplifies, and then aba rounds. */
static void check_round_trip(const robot *r, const state *s, int number) {
    double tau[MAX_V], a[MAX_V];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, tau));
    RUN(rbd_aba(r->m, r->w, s->q, s->v, tau, s->f_ext, a));
    expect_close("aba undoes rnea", r, number, a, s->a, r->nv, 2 * inverse_bound(condition_of(r, s)));
}

START_TEST(forward_undoes_inverse_dynamics) { for_random_states(10, check_round_trip); }
END_TEST

/* tau = M a + c, compared at the size of the largest term. */
static void check_equation(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    double M[MAX_V * MAX_V], c[MAX_V], a[MAX_V], Ma[MAX_V], expected[MAX_V];
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, a));
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_bias(r->m, r->w, s->q, s->v, s->f_ext, c));
    multiply(M, a, nv, nv, Ma);
    for (int i = 0; i < nv; i++) expected[i] = s->tau[i] - c[i];
    expect_close("M a + c = tau", r, number, Ma, expected, nv, 1e-11);
}

START_TEST(acceleration_solves_the_equation_of_motion) { for_random_states(20, check_equation); }
END_TEST

static void check_agreement(const robot *r, const state *s, int number) {
    double articulated[MAX_V], factored[MAX_V];
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, articulated));
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, s->f_ext, factored));
    expect_close("aba = fd_cholesky", r, number, articulated, factored, r->nv,
                 inverse_bound(condition_of(r, s)));
}

START_TEST(both_forward_dynamics_agree) { for_random_states(10, check_agreement); }
END_TEST

static void check_in_place(const robot *r, const state *s, int number) {
    const size_t size = (size_t)r->nv * sizeof(double);
    double apart[MAX_V], same[MAX_V];
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, apart));
    memcpy(same, s->tau, size);
    RUN(rbd_aba(r->m, r->w, s->q, s->v, same, s->f_ext, same));
    ck_assert_msg(memcmp(same, apart, size) == 0, "%s: a may be tau", r->name);
    memcpy(same, s->v, size);
    RUN(rbd_aba(r->m, r->w, s->q, same, s->tau, s->f_ext, same));
    ck_assert_msg(memcmp(same, apart, size) == 0, "%s: a may be v", r->name);
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, s->f_ext, apart));
    memcpy(same, s->tau, size);
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, same, s->f_ext, same));
    ck_assert_msg(memcmp(same, apart, size) == 0, "%s: a may be tau, fd_cholesky", r->name);
    memcpy(same, s->v, size);
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, same, s->tau, s->f_ext, same));
    ck_assert_msg(memcmp(same, apart, size) == 0, "%s: a may be v, fd_cholesky", r->name);
}

START_TEST(output_may_be_an_input) { for_random_states(3, check_in_place); }
END_TEST

START_TEST(null_arguments_are_refused) {
    forward_dynamics *const functions[2] = {rbd_aba, rbd_fd_cholesky};
    robot r = robot_build("atlas", reference_model(0)->bodies, reference_model(0)->nb);
    const double x[MAX_Q] = {0};
    double a[MAX_V];
    for (int i = 0; i < 2; i++) {
        forward_dynamics *forward = functions[i];
        ck_assert_int_eq(forward(NULL, r.w, x, x, x, NULL, a), RBD_ERR_NULL);
        ck_assert_int_eq(forward(r.m, NULL, x, x, x, NULL, a), RBD_ERR_NULL);
        ck_assert_int_eq(forward(r.m, r.w, NULL, x, x, NULL, a), RBD_ERR_NULL);
        ck_assert_int_eq(forward(r.m, r.w, x, NULL, x, NULL, a), RBD_ERR_NULL);
        ck_assert_int_eq(forward(r.m, r.w, x, x, NULL, NULL, a), RBD_ERR_NULL);
        ck_assert_int_eq(forward(r.m, r.w, x, x, x, NULL, NULL), RBD_ERR_NULL);
    }
    robot_free(&r);
}
END_TEST

Suite *aba_suite(void) {
    Suite *suite = suite_create("aba");
    TCase *c = tcase_create("aba");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, forward_dynamics_match_the_reference);
    tcase_add_test(c, forward_dynamics_match_the_textbook_on_random_trees);
    tcase_add_test(c, forward_undoes_inverse_dynamics);
    tcase_add_test(c, acceleration_solves_the_equation_of_motion);
    tcase_add_test(c, both_forward_dynamics_agree);
    tcase_add_test(c, output_may_be_an_input);
    tcase_add_test(c, null_arguments_are_refused);
    suite_add_tcase(suite, c);
    return suite;
}
