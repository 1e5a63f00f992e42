/* test_ilqr.c - examples/mpc/ilqr.h: what it refuses, by name, and that nothing of it stays behind. On a
   cart that slides, v_next = v + dt u, whose best controls are known to the solver after one iteration. */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#define RBD_IMPLEMENTATION
#include "examples/mpc/ilqr.h"

enum { N = 20, REALS = (int)ILQR_REALS(1, 1, 1, N) };

static unsigned char memory_of_model[RBD_MODEL_SIZE(1)];
static rbd_real dt[N], lower, upper, reals[REALS];
static ilqr_problem problem;
static ilqr s;

/* Which of the caller's functions gives a number that is not one, at the knot `at`, and the number. */
enum { NOTHING, V_NEXT, F_Z, COST, GRADIENT, HESSIAN };
static int wrong, at;
static rbd_real number;

static rbd_real spoilt(int what, int k, rbd_real x) { return what == wrong && k == at ? number : x; }

static rbd_status step(void *user, int k, const rbd_real *q, const rbd_real *v, const rbd_real *u,
                       rbd_real *v_next) {
    (void)user, (void)q;
    *v_next = spoilt(V_NEXT, k, *v + dt[k] * *u);
    return RBD_OK;
}

static rbd_status derivatives(void *user, const rbd_real *q, const rbd_real *v, const rbd_real *u,
                              rbd_real *f_z) {
    (void)user, (void)q, (void)v, (void)u;
    for (int k = 0; k < N; k++, f_z += 3) f_z[0] = 0, f_z[1] = 1, f_z[2] = spoilt(F_Z, k, dt[k]);
    return RBD_OK;
}

/* Half of (q - 1)^2 + v^2 + u^2 / 100. */
static rbd_status cost(void *user, int k, const rbd_real *q, const rbd_real *v, const rbd_real *u,
                       rbd_real *l, rbd_real *l_z, rbd_real *l_zz) {
    const rbd_real z[3] = {*q - 1, *v, u ? *u : 0}, weight[3] = {1, 1, u ? (rbd_real)0.01 : 0};
    (void)user;
    *l = 0;
    for (int i = 0; i < 3; i++) {
        *l += weight[i] * z[i] * z[i] / 2;
        if (l_z) l_z[i] = weight[i] * z[i], l_zz[4 * i] = weight[i];
    }
    *l = spoilt(COST, k, *l);
    if (l_z) l_z[u ? 2 : 0] = spoilt(GRADIENT, k, l_z[u ? 2 : 0]);
    if (l_z) l_zz[u ? 8 : 0] = spoilt(HESSIAN, k, l_zz[u ? 8 : 0]);
    return RBD_OK;
}

static void setup(void) {
    static const rbd_body cart = {.parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1};
    const rbd_model *m;
    ck_assert_int_eq(rbd_model_build(&cart, 1, memory_of_model, sizeof memory_of_model, &m, NULL), RBD_OK);
    for (int k = 0; k < N; k++) dt[k] = (rbd_real)0.05;
    lower = -10, upper = 10, wrong = NOTHING;
    problem = (ilqr_problem){.m = m,
                             .knots = N,
                             .nu = 1,
                             .dt = dt,
                             .lower = &lower,
                             .upper = &upper,
                             .step = step,
                             .derivatives = derivatives,
                             .cost = cost};
}

static rbd_status init(void) { return ilqr_init(&s, &problem, reals, REALS); }

static rbd_status start(rbd_real q, rbd_real v) { return ilqr_start(&s, &q, &v); }

/* The best controls from rest at 0, and what they cost. */
static rbd_real solve(void) {
    int better;
    ck_assert_int_eq(start(0, 0), RBD_OK);
    do ck_assert_int_eq(ilqr_iterate(&s, &better), RBD_OK);
    while (better);
    ck_assert(isfinite((double)s.cost));
    return s.cost;
}

static void refused(rbd_status status, rbd_status expected, const char *what) {
    ck_assert_msg(status == expected, "%s: %s, not %s", what, rbd_status_string(status),
                  rbd_status_string(expected));
    ck_assert_msg(s.refused && strcmp(s.refused, what) == 0, "%s, not %s", s.refused ? s.refused : "nothing",
                  what);
}

/* ---- sizes and limits ---- */

START_TEST(sizes) {
    problem.knots = 0, refused(init(), RBD_ERR_COUNT, "knots");
    problem.knots = -1, refused(init(), RBD_ERR_COUNT, "knots");
    problem.knots = INT_MAX, refused(init(), RBD_ERR_COUNT, "knots");
    problem.knots = INT_MAX / 8, refused(init(), RBD_ERR_COUNT, "knots"); /* 18 scalars a knot */
    problem.knots = N, problem.nu = 0, refused(init(), RBD_ERR_COUNT, "nu");
    problem.nu = -1, refused(init(), RBD_ERR_COUNT, "nu");
    problem.nu = 2, refused(init(), RBD_ERR_COUNT, "nu");
    problem.nu = 1, problem.curved = -1, refused(init(), RBD_ERR_COUNT, "curved");
    problem.curved = 2, refused(init(), RBD_ERR_COUNT, "curved");
    problem.curved = 0;
    refused(ilqr_init(&s, &problem, reals, REALS - 1), RBD_ERR_MEMORY, "memory");
    ck_assert_int_eq(init(), RBD_OK);
    ck_assert_ptr_null(s.refused);
}
END_TEST

START_TEST(missing) {
    ck_assert_int_eq(ilqr_init(NULL, &problem, reals, REALS), RBD_ERR_NULL);
    refused(ilqr_init(&s, NULL, reals, REALS), RBD_ERR_NULL, "problem");
    refused(ilqr_init(&s, &problem, NULL, REALS), RBD_ERR_NULL, "memory");
    problem.lower = NULL, refused(init(), RBD_ERR_NULL, "dt, lower, upper");
    problem.lower = &lower, problem.dt = NULL, refused(init(), RBD_ERR_NULL, "dt, lower, upper");
    problem.dt = dt, problem.step = NULL, refused(init(), RBD_ERR_NULL, "step, derivatives, cost");
    problem.step = step, problem.m = NULL, refused(init(), RBD_ERR_NULL, "m");
}
END_TEST

START_TEST(limits_and_times) {
    const rbd_real infinite = (rbd_real)INFINITY, nan = (rbd_real)NAN;
    const rbd_real crossed[5][2] = {{1, -1}, {nan, 1}, {-1, nan}, {nan, nan}, {infinite, -infinite}};
    for (int i = 0; i < 5; i++) {
        lower = crossed[i][0], upper = crossed[i][1];
        refused(init(), RBD_ERR_LIMITS, "lower, upper");
    }
    lower = upper = infinite, refused(init(), RBD_ERR_LIMITS, "lower");
    lower = upper = -infinite, refused(init(), RBD_ERR_LIMITS, "upper");
    lower = upper = 0;
    ck_assert_int_eq(init(), RBD_OK);
    lower = -infinite, upper = infinite; /* none */
    ck_assert_int_eq(init(), RBD_OK);
    const rbd_real best = solve();
    lower = -1000, upper = 1000;
    ck_assert(solve() == best);
    const rbd_real times[4] = {nan, infinite, -infinite, -1};
    for (int i = 0; i < 4; i++) {
        dt[N - 1] = times[i];
        refused(init(), RBD_ERR_LIMITS, "dt");
    }
    dt[N - 1] = 0;
    ck_assert_int_eq(init(), RBD_OK);
}
END_TEST

/* ---- numbers ---- */

/* The whole of the trajectory and its cost, and that the gains are finite. */
typedef struct kept {
    rbd_real q[N + 1], v[N + 1], u[N], cost;
} kept;

static kept keep(void) {
    kept k;
    memset(&k, 0, sizeof k);
    memcpy(k.q, s.q, sizeof k.q);
    memcpy(k.v, s.v, sizeof k.v);
    memcpy(k.u, s.u, sizeof k.u);
    k.cost = s.cost;
    ck_assert(ilqr_finite(2 * N, s.K));
    return k;
}

static void unchanged(const kept *before) {
    const kept now = keep();
    ck_assert_mem_eq(&now, before, sizeof now);
}

static const rbd_real numbers[3] = {(rbd_real)NAN, (rbd_real)INFINITY, -(rbd_real)INFINITY};

START_TEST(a_measured_state_that_is_not_finite) {
    ck_assert_int_eq(init(), RBD_OK);
    const rbd_real best = solve();
    const kept before = keep();
    for (int i = 0; i < 3; i++) {
        const rbd_real x = numbers[i];
        refused(start(x, 0), RBD_ERR_NAN, "q");
        unchanged(&before);
        refused(start(0, x), RBD_ERR_NAN, "v");
        unchanged(&before);
        refused(ilqr_shift(&s, x), RBD_ERR_NAN, "fraction");
        unchanged(&before);
    }
    ck_assert_int_eq(ilqr_start(&s, NULL, s.v), RBD_ERR_NULL);
    ck_assert(solve() == best);
}
END_TEST

START_TEST(controls_that_are_not_finite) {
    ck_assert_int_eq(init(), RBD_OK);
    s.u[3] = (rbd_real)NAN;
    refused(start(0, 0), RBD_ERR_NAN, "u");
    s.u[3] = 0;
    solve();
}
END_TEST

/* In a rollout, and in an iteration, in each of a few knots; then all is well again. */
START_TEST(functions_that_give_no_numbers) {
    static const struct {
        int what, in_iteration;
        const char *name;
    } cases[] = {
        {V_NEXT, 0, "v_next"}, {COST, 0, "l"}, {F_Z, 1, "f_z"}, {GRADIENT, 1, "l_z"}, {HESSIAN, 1, "l_zz"}};
    const int knots[4] = {0, 1, N - 1, N};
    ck_assert_int_eq(init(), RBD_OK);
    const rbd_real best = solve();
    ck_assert_int_eq(start((rbd_real)0.1, 0), RBD_OK);
    const kept before = keep();
    for (int c = 0; c < 5; c++)
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 3; i++) {
                int better = 1;
                if (knots[k] == N && (cases[c].what == V_NEXT || cases[c].what == F_Z)) continue;
                wrong = cases[c].what, at = knots[k], number = numbers[i];
                if (!cases[c].in_iteration) {
                    refused(start(0, 0), RBD_ERR_NAN, cases[c].name);
                } else {
                    refused(ilqr_iterate(&s, &better), RBD_ERR_NAN, cases[c].name);
                    ck_assert_int_eq(better, 0);
                }
                unchanged(&before);
                wrong = NOTHING;
                ck_assert_int_eq(start((rbd_real)0.1, 0), RBD_OK);
            }
    ck_assert(fabs((double)(solve() - best)) <= 1e-5 * fabs((double)best));
}
END_TEST

/* Finite, but so large that the gains overflow. */
START_TEST(overflow) {
    int better;
    ck_assert_int_eq(init(), RBD_OK);
    ck_assert_int_eq(start(0, 0), RBD_OK);
    const kept before = keep();
    wrong = F_Z, at = 0, number = sizeof(rbd_real) == sizeof(float) ? (rbd_real)1e38 : (rbd_real)1e308;
    refused(ilqr_iterate(&s, &better), RBD_ERR_NAN, "k, K");
    unchanged(&before);
    wrong = NOTHING;
    refused(start(number, number), RBD_ERR_NAN, "l");
    solve();
}
END_TEST

int main(void) {
    Suite *suite = suite_create("ilqr");
    TCase *c = tcase_create("refused");
    tcase_add_checked_fixture(c, setup, NULL);
    tcase_add_test(c, sizes);
    tcase_add_test(c, missing);
    tcase_add_test(c, limits_and_times);
    tcase_add_test(c, a_measured_state_that_is_not_finite);
    tcase_add_test(c, controls_that_are_not_finite);
    tcase_add_test(c, functions_that_give_no_numbers);
    tcase_add_test(c, overflow);
    suite_add_tcase(suite, c);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
