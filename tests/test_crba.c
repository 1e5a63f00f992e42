/* test_crba.c - [crba]: the mass matrix, full and packed. */
#include <math.h>
#include <stdlib.h>

#include "suites.h"
#include "support.h"

enum { MAX_M = MAX_V * MAX_V };

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    double M[MAX_M];
    RUN(rbd_crba(r->m, r->w, s->q, M));
    expect_close("crba", r, number, M, s->M, model->nv * model->nv, 1e-14);
}

START_TEST(mass_matrix_matches_the_reference) { for_reference_states(check_reference); }
END_TEST

static void check_textbook(const robot *r, const state *s, int number) {
    double M[MAX_M];
    tb_real expected[MAX_M];
    RUN(rbd_crba(r->m, r->w, s->q, M));
    tb_mass_matrix(r->bodies, r->nb, s->q, expected);
    expect_close_tb("crba, textbook", r, number, M, expected, r->nv * r->nv, 1e-13);
}

START_TEST(mass_matrix_matches_the_textbook_on_random_trees) { for_random_trees(200, check_textbook); }
END_TEST

static void check_columns(const robot *r, const state *s, int number) {
    const double none[3] = {0, 0, 0};
    const int nv = r->nv;
    double M[MAX_M], columns[MAX_M], rest[MAX_V] = {0}, unit[MAX_V] = {0}, tau[MAX_V];
    RUN(rbd_set_gravity(r->w, none));
    RUN(rbd_crba(r->m, r->w, s->q, M));
    for (int k = 0; k < nv; k++) {
        unit[k] = 1;
        RUN(rbd_rnea(r->m, r->w, s->q, rest, unit, NULL, tau));
        unit[k] = 0;
        for (int i = 0; i < nv; i++) columns[i * nv + k] = tau[i];
    }
    expect_close("crba = columns of rnea", r, number, M, columns, nv * nv, 1e-13);
}

START_TEST(columns_are_torques_of_unit_accelerations) { for_random_states(5, check_columns); }
END_TEST

static void check_definite(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    double M[MAX_M];
    tb_real copy[MAX_M], inverse[MAX_M];
    RUN(rbd_crba(r->m, r->w, s->q, M));
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            ck_assert_msg(!(M[i * nv + j] < M[j * nv + i]) && !(M[i * nv + j] > M[j * nv + i]),
                          "%s, state %d: M is not symmetric at %d, %d", r->name, number, i, j);
            copy[i * nv + j] = M[i * nv + j];
        }
    ck_assert_msg(tb_invert(copy, nv, inverse), "%s, state %d: M is not positive definite", r->name, number);
}

START_TEST(mass_matrix_is_symmetric_and_positive_definite) { for_random_states(20, check_definite); }
END_TEST

static int is_ancestor_body(const robot *r, int ancestor, int body) {
    while (body > ancestor) body = r->bodies[body].parent;
    return body == ancestor;
}

static int has_mimic(const robot *r) {
    for (int i = 0; i < r->nb; i++)
        if (r->bodies[i].mimic) return 1;
    return 0;
}

/* Rows one after the other, in each row the columns in rising order, the diagonal last. */
static void check_layout(const robot *r) {
    int next = 0;
    for (int i = 0; i < r->nv; i++)
        for (int j = 0; j < r->nv; j++) {
            const int index = rbd_packed_index(r->m, i, j);
            if (index < 0)
                ck_assert_msg(i != j, "%s: no diagonal at %d", r->name, i);
            else if (j <= i)
                ck_assert_msg(index == next++, "%s: (%d, %d) lies at %d", r->name, i, j, index);
            if (j <= i && !has_mimic(r)) /* a mimic joint couples its leader with other branches */
                ck_assert_msg((index >= 0) ==
                                  is_ancestor_body(r, rbd_dof_body(r->m, j), rbd_dof_body(r->m, i)),
                              "%s: entry (%d, %d), index %d", r->name, i, j, index);
        }
    ck_assert_msg(next == rbd_packed_size(r->m), "%s: %d entries", r->name, next);
    ck_assert_int_le(next, r->nv * (r->nv + 1) / 2);
    ck_assert_int_eq(rbd_packed_index(r->m, -1, 0), -1);
    ck_assert_int_eq(rbd_packed_index(r->m, 0, -1), -1);
    ck_assert_int_eq(rbd_packed_index(r->m, r->nv, 0), -1);
    ck_assert_int_eq(rbd_packed_index(r->m, 0, r->nv), -1);
}

static void check_packed(const robot *r, const state *s, int number) {
    const int nv = r->nv;
    double M[MAX_M], H[MAX_M], unpacked[MAX_M];
    check_layout(r);
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_crba_packed(r->m, r->w, s->q, H));
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            const int index = rbd_packed_index(r->m, i > j ? i : j, i > j ? j : i);
            unpacked[i * nv + j] = index < 0 ? 0 : H[index];
        }
    expect_close("crba packed = full", r, number, unpacked, M, nv * nv, 1e-15);
}

START_TEST(packed_matrix_is_the_full_one) {
    for_random_states(3, check_packed);
    for_random_trees(200, check_packed);
}
END_TEST

/* More degrees of freedom than rbdi_crba has a fixed stride for, on branches: columns and packed entries. */
START_TEST(large_trees_have_the_columns_of_inverse_dynamics) {
    enum { N = 80 };
    static double M[N * N], H[N * N], q[N], tau[N], rest[N], unit[N];
    const double none[3] = {0, 0, 0};
    rbd_body bodies[N];
    uint64_t seed = 7;
    for (int i = 0; i < N; i++) {
        random_joint(&seed, bodies, i, i % 5 == 3 ? RBD_PRISMATIC : RBD_REVOLUTE);
        bodies[i].parent = i % 20 == 13 ? i - 9 : i - 1;
        random_mass(&seed, &bodies[i]);
        q[i] = uniform(&seed, -2, 2);
    }
    const size_t size = rbd_model_size(bodies, N);
    robot r = {.name = "large tree"};
    r.memory[0] = malloc(size);
    ck_assert_int_eq(rbd_model_build(bodies, N, r.memory[0], size, &r.m, NULL), RBD_OK);
    r.memory[1] = malloc(rbd_work_size(r.m));
    ck_assert_int_eq(rbd_work_init(r.m, r.memory[1], rbd_work_size(r.m), &r.w), RBD_OK);
    ck_assert_int_eq(rbd_nv(r.m), N);
    ck_assert_int_eq(rbd_set_gravity(r.w, none), RBD_OK);
    ck_assert_int_eq(rbd_crba(r.m, r.w, q, M), RBD_OK);
    ck_assert_int_eq(rbd_crba_packed(r.m, r.w, q, H), RBD_OK);
    for (int k = 0; k < N; k++) {
        double column[N];
        unit[k] = 1;
        ck_assert_int_eq(rbd_rnea(r.m, r.w, q, rest, unit, NULL, tau), RBD_OK);
        unit[k] = 0;
        for (int i = 0; i < N; i++) {
            const int packed = rbd_packed_index(r.m, i, k);
            column[i] = M[i * N + k];
            ck_assert(M[i * N + k] == (packed < 0 ? 0 : H[packed]));
        }
        expect_close("crba, large tree", &r, k, column, tau, N, 1e-12);
    }
    robot_free(&r);
}
END_TEST

START_TEST(null_arguments_are_refused) {
    robot r = robot_build("atlas", reference_model(0)->bodies, reference_model(0)->nb);
    const double q[MAX_Q] = {0};
    double M[MAX_M];
    ck_assert_int_eq(rbd_crba(NULL, r.w, q, M), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_crba(r.m, NULL, q, M), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_crba(r.m, r.w, NULL, M), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_crba(r.m, r.w, q, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_crba_packed(NULL, r.w, q, M), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_crba_packed(r.m, NULL, q, M), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_crba_packed(r.m, r.w, NULL, M), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_crba_packed(r.m, r.w, q, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_packed_size(NULL), 0);
    ck_assert_int_eq(rbd_packed_index(NULL, 0, 0), -1);
    robot_free(&r);
}
END_TEST

Suite *crba_suite(void) {
    Suite *suite = suite_create("crba");
    TCase *c = tcase_create("crba");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, mass_matrix_matches_the_reference);
    tcase_add_test(c, mass_matrix_matches_the_textbook_on_random_trees);
    tcase_add_test(c, columns_are_torques_of_unit_accelerations);
    tcase_add_test(c, mass_matrix_is_symmetric_and_positive_definite);
    tcase_add_test(c, packed_matrix_is_the_full_one);
    tcase_add_test(c, large_trees_have_the_columns_of_inverse_dynamics);
    tcase_add_test(c, null_arguments_are_refused);
    suite_add_tcase(suite, c);
    return suite;
}
