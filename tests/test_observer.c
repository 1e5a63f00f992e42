/* test_observer.c - generalized momentum M v and C' v. */
#include <math.h>
#include <string.h>

#include "rbd_derivatives.h"

#include "suites.h"
#include "support.h"

enum { MAX_M = MAX_V * MAX_V };

/* out = C' v */
static void transposed(const double *C, const double *v, int n, double *out) {
    for (int i = 0; i < n; i++) {
        out[i] = 0;
        for (int k = 0; k < n; k++) out[i] += C[k * n + i] * v[k];
    }
}

static void check_reference(const robot *r, const ref_control_state *s, int number) {
    double p[MAX_V], ctv[MAX_V], expected[MAX_V];
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, p, ctv));
    multiply(s->M, s->v, r->nv, r->nv, expected);
    expect_close("M v", r, number, p, expected, r->nv, 1e-11);
    transposed(s->C, s->v, r->nv, expected);
    expect_close("C' v", r, number, ctv, expected, r->nv, 1e-11);
}

START_TEST(results_match_the_reference) { for_control_states(check_reference); }
END_TEST

/* p = M v by the textbook's matrix; C' v = dM/dt v - C v, C v = c - g, and dM/dt v by a difference of order
   four along v, which mimic joints take too. */
static void check_textbook(const robot *r, const state *s, int number) {
    static tb_real M[TB_MAX_DOFS * TB_MAX_DOFS];
    const double none[MAX_V] = {0}, h = 1e-3, weight[4] = {1. / 12, -2. / 3, 2. / 3, -1. / 12},
                 step[4] = {-2, -1, 1, 2};
    double p[MAX_V], ctv[MAX_V], q[MAX_Q];
    tb_real expected[TB_MAX_DOFS], rate[TB_MAX_DOFS], c[TB_MAX_DOFS], g[TB_MAX_DOFS];
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, p, ctv));
    tb_mass_matrix(r->bodies, r->nb, s->q, M);
    for (int i = 0; i < r->nv; i++) {
        expected[i] = rate[i] = 0;
        for (int k = 0; k < r->nv; k++) expected[i] += M[i * r->nv + k] * s->v[k];
    }
    expect_close_tb("M v, textbook", r, number, p, expected, r->nv, 1e-11);
    for (int j = 0; j < 4; j++) {
        RUN(rbd_integrate(r->m, s->q, s->v, step[j] * h, q));
        tb_mass_matrix(r->bodies, r->nb, q, M);
        for (int i = 0; i < r->nv; i++)
            for (int k = 0; k < r->nv; k++) rate[i] += weight[j] / (tb_real)h * M[i * r->nv + k] * s->v[k];
    }
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, none, NULL, c, NULL);
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, none, none, NULL, g, NULL);
    for (int i = 0; i < r->nv; i++) expected[i] = rate[i] - (c[i] - g[i]);
    expect_close_tb("C' v, textbook", r, number, ctv, expected, r->nv, 1e-8); /* of the difference */
}

START_TEST(results_match_the_textbook_on_random_trees) { for_random_trees(40, check_textbook); }
END_TEST

static void check_coriolis(const robot *r, const state *s, int number) {
    double p[MAX_V], ctv[MAX_V], expected[MAX_V], C[MAX_M];
    rbd_derivatives *d;
    void *memory = malloc(rbd_derivatives_size(r->m));
    RUN(rbd_derivatives_init(r->m, r->w, memory, rbd_derivatives_size(r->m), &d));
    RUN(rbd_coriolis(r->m, d, s->q, s->v, C));
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, p, ctv));
    transposed(C, s->v, r->nv, expected);
    expect_close("C' v by rbd_coriolis", r, number, ctv, expected, r->nv, 1e-11);
    free(memory);
}

START_TEST(results_match_the_coriolis_matrix) { for_random_trees(300, check_coriolis); }
END_TEST

/* One alone; in the place of v. */
static void check_outputs(const robot *r, const state *s, int number) {
    const size_t size = (size_t)r->nv * sizeof(double);
    double p[MAX_V], ctv[MAX_V], x[MAX_V];
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, p, ctv));
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, x, NULL));
    ck_assert_msg(memcmp(x, p, size) == 0, "%s: p alone", r->name);
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, NULL, x));
    ck_assert_msg(memcmp(x, ctv, size) == 0, "%s: C' v alone", r->name);
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, NULL, NULL));
    memcpy(x, s->v, size);
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, x, x, NULL));
    ck_assert_msg(memcmp(x, p, size) == 0, "%s: p may be v", r->name);
    memcpy(x, s->v, size);
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, x, p, x));
    ck_assert_msg(memcmp(x, ctv, size) == 0, "%s: C' v may be v", r->name);
    RUN(rbd_generalized_momentum(r->m, r->w, s->q, s->v, x, NULL));
    ck_assert_msg(memcmp(x, p, size) == 0, "%s: p of it", r->name);
}

START_TEST(outputs_may_be_missing_or_an_input) { for_random_states(3, check_outputs); }
END_TEST

START_TEST(errors_have_their_names) {
    robot r = robot_build("atlas", reference_model(0)->bodies, reference_model(0)->nb),
          other = robot_build("other", reference_model(3)->bodies, reference_model(3)->nb);
    const double x[MAX_Q] = {0};
    double p[MAX_V], ctv[MAX_V];
    ck_assert_int_eq(rbd_generalized_momentum(NULL, r.w, x, x, p, ctv), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_generalized_momentum(r.m, NULL, x, x, p, ctv), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_generalized_momentum(r.m, r.w, NULL, x, p, ctv), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_generalized_momentum(r.m, r.w, x, NULL, p, ctv), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_generalized_momentum(r.m, other.w, x, x, p, ctv), RBD_ERR_WORK);
    robot_free(&r);
    robot_free(&other);
}
END_TEST

Suite *observer_suite(void) {
    Suite *suite = suite_create("observer");
    TCase *c = tcase_create("observer");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, results_match_the_reference);
    tcase_add_test(c, results_match_the_textbook_on_random_trees);
    tcase_add_test(c, results_match_the_coriolis_matrix);
    tcase_add_test(c, outputs_may_be_missing_or_an_input);
    tcase_add_test(c, errors_have_their_names);
    suite_add_tcase(suite, c);
    return suite;
}
