/* test_specialised.c - a model known to the compiler gives the results of one known at run time. */
#include "quiet_check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rbd.h"

#include "specialised.h"

enum { MAX_V = 40, MAX_F = 6 * 40, STATES = 200 };

static double uniform(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) / 9007199254740992.0 * 2 - 1;
}

/* Largest difference over the largest entry. */
static double difference(const double *x, const double *y, int n) {
    double largest = 0, worst = 0;
    for (int k = 0; k < n; k++) {
        const double d = fabs(x[k] - y[k]);
        if (fabs(y[k]) > largest) largest = fabs(y[k]);
        if (!(d <= worst)) worst = d;
    }
    return worst / largest;
}

static void expect_close(const char *what, int state, const double *x, const double *y, int n, double bound) {
    const double error = difference(x, y, n);
    ck_assert_msg(error <= bound, "%s, state %d: %.2e > %.2e", what, state, error, bound);
}

START_TEST(straight_line_calls_give_the_results_of_the_generic_ones) {
    const rbd_model *m = special_model();
    const int nv = rbd_nv(m), nb = rbd_nb(m);
    void *memory = malloc(rbd_work_size(m));
    rbd_work *w;
    uint64_t seed = 7;
    ck_assert_int_eq(rbd_work_init(m, memory, rbd_work_size(m), &w), RBD_OK);
    for (int s = 0; s < STATES; s++) {
        static double q[MAX_V + 1], v[MAX_V], a[MAX_V], f[MAX_F], x[MAX_V * MAX_V], y[MAX_V * MAX_V];
        const double *f_ext = s % 2 ? f : NULL;
        ck_assert_int_eq(rbd_random(m, &seed, q), RBD_OK);
        for (int k = 0; k < nv; k++) {
            v[k] = uniform(&seed);
            a[k] = uniform(&seed);
        }
        for (int k = 0; k < 6 * nb; k++) f[k] = uniform(&seed);
        ck_assert_int_eq(special_rnea(q, v, a, f_ext, x), RBD_OK);
        ck_assert_int_eq(rbd_rnea(m, w, q, v, a, f_ext, y), RBD_OK);
        expect_close("rnea", s, x, y, nv, 1e-14);
        ck_assert_int_eq(special_crba(q, x), RBD_OK);
        ck_assert_int_eq(rbd_crba(m, w, q, y), RBD_OK);
        expect_close("crba", s, x, y, nv * nv, 1e-14);
        ck_assert_int_eq(special_aba(q, v, a, f_ext, x), RBD_OK);
        ck_assert_int_eq(rbd_aba(m, w, q, v, a, f_ext, y), RBD_OK);
        expect_close("aba", s, x, y, nv, 1e-11);
    }
    free(memory);
}
END_TEST

#ifdef ROBOT_HYBRID
/* Of each second dof the acceleration; a row is what is known of both, tau behind a. */
static void draw_hybrid(int nv, uint64_t *seed, unsigned char *given, double *x) {
    for (int k = 0; k < nv; k++) {
        given[k] = k % 2 == 0;
        x[k] = x[MAX_V + k] = uniform(seed);
    }
}

START_TEST(straight_line_hybrid_dynamics_are_the_generic_ones) {
    const rbd_model *m = special_model();
    const int nv = rbd_nv(m);
    void *memory = malloc(rbd_work_size(m));
    rbd_work *w;
    uint64_t seed = 8;
    ck_assert_int_eq(rbd_work_init(m, memory, rbd_work_size(m), &w), RBD_OK);
    for (int s = 0; s < 20; s++) {
        double q[MAX_V + 1], v[MAX_V], x[2 * MAX_V], y[2 * MAX_V];
        unsigned char given[MAX_V];
        ck_assert_int_eq(rbd_random(m, &seed, q), RBD_OK);
        for (int k = 0; k < nv; k++) v[k] = uniform(&seed);
        draw_hybrid(nv, &seed, given, x);
        memcpy(y, x, sizeof y);
        ck_assert_int_eq(special_hybrid(q, v, given, x, x + MAX_V), RBD_OK);
        ck_assert_int_eq(rbd_hybrid(m, w, q, v, given, NULL, y, y + MAX_V), RBD_OK);
        expect_close("hybrid, a", s, x, y, nv, 1e-11);
        expect_close("hybrid, tau", s, x + MAX_V, y + MAX_V, nv, 1e-11);
    }
    free(memory);
}
END_TEST
#endif

int main(void) {
    Suite *suite = suite_create("specialised");
    TCase *c = tcase_create("specialised");
    SRunner *runner;
    int failed;
    tcase_add_test(c, straight_line_calls_give_the_results_of_the_generic_ones);
#ifdef ROBOT_HYBRID
    tcase_add_test(c, straight_line_hybrid_dynamics_are_the_generic_ones);
#endif
    suite_add_tcase(suite, c);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
