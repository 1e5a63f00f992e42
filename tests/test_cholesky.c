/* test_cholesky.c - [cholesky]: M = L' D L, solving with it, and forward dynamics by it. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

enum { MAX_M = MAX_V * MAX_V };

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const double bound = 1e-13;
    const int nv = model->nv;
    double a[MAX_V], L[MAX_M], x[MAX_V], unit[MAX_V] = {0}, inverse[MAX_M];
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, NULL, a));
    expect_close("fd_cholesky", r, number, a, s->qdd, nv, bound);
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, s->f_ext, a));
    expect_close("fd_cholesky, wrenches", r, number, a, s->qdd_ext, nv, bound);
    RUN(rbd_cholesky_factor(r->m, r->w, s->M, L));
    for (int k = 0; k < nv; k++) {
        unit[k] = 1;
        RUN(rbd_cholesky_solve(r->m, r->w, L, unit, x));
        unit[k] = 0;
        for (int i = 0; i < nv; i++) inverse[i * nv + k] = x[i];
    }
    expect_close("factor, solve", r, number, inverse, s->Minv, nv * nv, inverse_bound(s->cond_M));
    RUN(rbd_minverse(r->m, r->w, s->q, inverse));
    expect_close("minverse", r, number, inverse, s->Minv, nv * nv, inverse_bound(s->cond_M));
}

START_TEST(factor_and_forward_dynamics_match_the_reference) { for_reference_states(check_reference); }
END_TEST

static void check_textbook(const robot *r, const state *s, int number) {
    expect_textbook_forward("fd_cholesky, textbook", rbd_fd_cholesky, r, s, number);
}

START_TEST(forward_dynamics_match_the_textbook_on_random_trees) { for_random_trees(300, check_textbook); }
END_TEST

/* Unpacks L (unit diagonal) and D, and multiplies. */
static void check_product(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    double M[MAX_M], packed[MAX_M], L[MAX_M] = {0}, D[MAX_V], product[MAX_M];
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_cholesky_factor(r->m, r->w, M, packed));
    for (int i = 0; i < nv; i++)
        for (int j = 0; j <= i; j++) {
            const int index = rbd_packed_index(r->m, i, j);
            if (i == j) D[i] = 1 / packed[index];
            L[i * nv + j] = i == j ? 1 : index < 0 ? 0 : packed[index];
        }
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            product[i * nv + j] = 0;
            for (int k = 0; k < nv; k++) product[i * nv + j] += L[k * nv + i] * D[k] * L[k * nv + j];
        }
    expect_close("L' D L = M", r, number, product, M, nv * nv, 1e-13);
}

START_TEST(factors_multiply_to_the_matrix) { for_random_states(5, check_product); }
END_TEST

static void check_variants(const robot *r, const state *s, int number) {
    const size_t size = (size_t)rbd_packed_size(r->m) * sizeof(double);
    double M[MAX_M], H[MAX_M], L[MAX_M], x[MAX_V], same[MAX_V];
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_crba_packed(r->m, r->w, s->q, H));
    RUN(rbd_cholesky_factor(r->m, r->w, M, L));
    RUN(rbd_cholesky_factor_packed(r->m, r->w, H));
    expect_close("factor packed = full", r, number, H, L, rbd_packed_size(r->m), 1e-13);
    RUN(rbd_cholesky_factor(r->m, r->w, M, M));
    ck_assert_msg(memcmp(M, L, size) == 0, "%s, state %d: L may be M", r->name, number);
    memcpy(same, s->tau, sizeof same);
    RUN(rbd_cholesky_solve(r->m, r->w, L, s->tau, x));
    RUN(rbd_cholesky_solve(r->m, r->w, L, same, same));
    ck_assert_msg(memcmp(x, same, (size_t)r->nv * sizeof(double)) == 0, "%s: x may be b", r->name);
}

START_TEST(packed_and_in_place_variants_agree) { for_random_states(5, check_variants); }
END_TEST

static void check_lower_triangle(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    double M[MAX_M], L[MAX_M], from_lower[MAX_M];
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_cholesky_factor(r->m, r->w, M, L));
    for (int i = 0; i < nv; i++)
        for (int j = i + 1; j < nv; j++) M[i * nv + j] = NAN;
    RUN(rbd_cholesky_factor(r->m, r->w, M, from_lower));
    expect_close("factor of the lower triangle", r, number, from_lower, L, rbd_packed_size(r->m), 0);
}

START_TEST(only_the_lower_triangle_is_read) { for_random_states(2, check_lower_triangle); }
END_TEST

/* M M^-1 = 1 where the textbook can invert M; else an error, and zeros. Between, to the error of the solver:
   |M| |M^-1| eps n. Symmetric to the bit, and so where the trees of several roots make it zero. */
static void check_inverse(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    double M[MAX_M], inverse[MAX_M], product[MAX_M];
    tb_real a[TB_MAX_DOFS];
    const tb_real condition = tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, a);
    for (int k = 0; k < nv * nv; k++) inverse[k] = NAN;
    const rbd_status status = rbd_minverse(r->m, r->w, s->q, inverse);
    ck_assert(status == RBD_OK || status == RBD_ERR_SINGULAR);
    if (status != RBD_OK) ck_assert_msg(largest(inverse, nv * nv) == 0, "%s: not zero", r->name);
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < i; j++)
            ck_assert_msg(memcmp(&inverse[i * nv + j], &inverse[j * nv + i], sizeof(double)) == 0,
                          "%s, state %d: not symmetric at %d, %d", r->name, number, i, j);
    if (!(condition > 0 && condition < 1e12L)) return;
    ck_assert_msg(status == RBD_OK, "%s, state %d: %d", r->name, number, status);
    RUN(rbd_crba(r->m, r->w, s->q, M));
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            product[i * nv + j] = i == j ? -1 : 0;
            for (int k = 0; k < nv; k++) product[i * nv + j] += M[i * nv + k] * inverse[k * nv + j];
        }
    expect_small("M minverse - 1", r, number, largest(product, nv * nv), inverse_bound((double)condition));
}

START_TEST(minverse_is_the_inverse_on_random_trees) { for_random_trees(400, check_inverse); }
END_TEST

/* A trunk with leaves at its end: more degrees of freedom than columns of a row stay in registers. Armatures
   keep the condition small. */
static void check_large_inverse(int trunk, int leaves) {
    rbd_body bodies[MAX_V] = {{0}};
    double q[MAX_V], M[MAX_M], inverse[MAX_M], error = 0;
    const int n = trunk + leaves;
    for (int i = 0; i < n; i++) {
        rbd_body *b = &bodies[i];
        b->parent = i < trunk ? i - 1 : trunk - 1;
        b->type = RBD_REVOLUTE, b->axis[i % 3] = 1, b->armature[0] = 1;
        b->position[(i + 1) % 3] = b->com[(i + 2) % 3] = 0.1;
        b->mass = 0.1, b->inertia[0] = b->inertia[3] = b->inertia[5] = 0.01;
        q[i] = sin(i);
    }
    robot r = robot_build_any("large tree", bodies, n);
    ck_assert_int_eq(rbd_crba(r.m, r.w, q, M), RBD_OK);
    ck_assert_int_eq(rbd_minverse(r.m, r.w, q, inverse), RBD_OK);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = i == j ? -1 : 0;
            for (int k = 0; k < n; k++) sum += M[i * n + k] * inverse[k * n + j];
            error = larger(error, isfinite(sum) ? fabs(sum) : HUGE_VAL);
            ck_assert(memcmp(&inverse[i * n + j], &inverse[j * n + i], sizeof(double)) == 0);
        }
    expect_small("M minverse - 1", &r, trunk, error, 1e-12);
    robot_free(&r);
}

START_TEST(minverse_is_the_inverse_on_large_trees) {
    check_large_inverse(63, 0);
    check_large_inverse(32, 31);
    check_large_inverse(1, 0);
}
END_TEST

/* Columns of any number, apart and in place, are those of single solutions; nothing is written behind. */
static void check_many(const robot *r, const state *s, int number) {
    enum { MOST = 19 };
    static double B[MAX_V * MOST], X[MAX_V * MOST + 1], expected[MAX_V * MOST];
    const int nv = r->nv;
    double M[MAX_M], L[MAX_M], x[MAX_V];
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_cholesky_factor(r->m, r->w, M, L));
    for (int n = 0; n <= MOST; n++) {
        for (int k = 0; k < nv * n; k++) B[k] = sin(k + 1) + s->tau[k % nv];
        for (int j = 0; j < n; j++) {
            for (int i = 0; i < nv; i++) x[i] = B[i * n + j];
            RUN(rbd_cholesky_solve(r->m, r->w, L, x, x));
            for (int i = 0; i < nv; i++) expected[i * n + j] = x[i];
        }
        X[nv * n] = 5;
        RUN(rbd_cholesky_solve_many(r->m, r->w, L, n, B, X));
        expect_close("solve_many", r, number, X, expected, nv * n, 1e-11);
        RUN(rbd_cholesky_solve_many(r->m, r->w, L, n, B, B));
        ck_assert_msg(memcmp(X, B, (size_t)(nv * n) * sizeof(double)) == 0, "%s: X may be B", r->name);
        ck_assert_double_eq(X[nv * n], 5);
    }
    X[0] = 5;
    RUN(rbd_cholesky_solve_many(r->m, r->w, L, -1, B, X));
    ck_assert_double_eq(X[0], 5);
}

START_TEST(many_solutions_are_single_ones_side_by_side) { for_random_states(3, check_many); }
END_TEST

START_TEST(null_arguments_are_refused) {
    robot r = robot_build("iiwa", reference_model(2)->bodies, reference_model(2)->nb);
    const ref_state *s = &reference_model(2)->states[0];
    double L[MAX_M], x[MAX_V] = {0};
    ck_assert_int_eq(rbd_cholesky_factor(NULL, r.w, s->M, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_factor(r.m, NULL, s->M, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_factor(r.m, r.w, NULL, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_factor(r.m, r.w, s->M, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_factor_packed(NULL, r.w, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_factor_packed(r.m, NULL, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_factor_packed(r.m, r.w, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_factor(r.m, r.w, s->M, L), RBD_OK);
    ck_assert_int_eq(rbd_cholesky_solve(NULL, r.w, L, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve(r.m, NULL, L, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve(r.m, r.w, NULL, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve(r.m, r.w, L, NULL, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve(r.m, r.w, L, x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve_many(NULL, r.w, L, 1, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve_many(r.m, NULL, L, 1, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve_many(r.m, r.w, NULL, 1, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve_many(r.m, r.w, L, 1, NULL, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_cholesky_solve_many(r.m, r.w, L, 1, x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_minverse(NULL, r.w, s->q, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_minverse(r.m, NULL, s->q, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_minverse(r.m, r.w, NULL, L), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_minverse(r.m, r.w, s->q, NULL), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

Suite *cholesky_suite(void) {
    Suite *suite = suite_create("cholesky");
    TCase *c = tcase_create("cholesky");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, factor_and_forward_dynamics_match_the_reference);
    tcase_add_test(c, forward_dynamics_match_the_textbook_on_random_trees);
    tcase_add_test(c, factors_multiply_to_the_matrix);
    tcase_add_test(c, packed_and_in_place_variants_agree);
    tcase_add_test(c, only_the_lower_triangle_is_read);
    tcase_add_test(c, minverse_is_the_inverse_on_random_trees);
    tcase_add_test(c, minverse_is_the_inverse_on_large_trees);
    tcase_add_test(c, many_solutions_are_single_ones_side_by_side);
    tcase_add_test(c, null_arguments_are_refused);
    suite_add_tcase(suite, c);
    return suite;
}
