/* test_hybrid.c - [hybrid]: of some degrees of freedom the acceleration is given, of others the torque. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

enum { MAX_M = MAX_V * MAX_V };

/* ---- which are given ---- */

typedef enum pattern { NONE, ALL, ALL_BUT_ROOTS, ALL_BUT_SOME_OF_ROOTS, HALF, FEW, MOST, PATTERNS } pattern;

/* Whether a dof belongs to a joint on the world. */
static int on_world(const robot *r, int dof) { return r->bodies[rbd_dof_body(r->m, dof)].parent < 0; }

static void draw_given(const robot *r, pattern p, uint64_t *seed, unsigned char *given) {
    for (int k = 0; k < r->nv; k++) {
        given[k] = p == ALL;
        if (p == ALL_BUT_ROOTS) given[k] = !on_world(r, k);
        if (p == ALL_BUT_SOME_OF_ROOTS) given[k] = (unsigned char)(!on_world(r, k) || below(seed, 2));
        if (p == HALF) given[k] = (unsigned char)(2 * below(seed, 2)); /* any value but 0 is yes */
        if (p == FEW) given[k] = (unsigned char)(below(seed, 5) == 0);
        if (p == MOST) given[k] = (unsigned char)(below(seed, 5) != 0);
    }
}

/* The given entries of a and tau, and NaN in the places of the unknown ones. */
static void blank(int nv, const unsigned char *given, const double *a, const double *tau, double *x,
                  double *y) {
    for (int k = 0; k < nv; k++) {
        x[k] = given[k] ? a[k] : (double)NAN;
        y[k] = given[k] ? (double)NAN : tau[k];
    }
}

static void expect_kept(const robot *r, int number, const unsigned char *given, const double *a,
                        const double *tau, const double *x, const double *y) {
    for (int k = 0; k < r->nv; k++)
        ck_assert_msg(given[k] ? memcmp(&x[k], &a[k], sizeof *x) == 0
                               : memcmp(&y[k], &tau[k], sizeof *y) == 0,
                      "%s, state %d: what was given changed", r->name, number);
}

/* ---- against independent results ---- */

static void check_reference(const robot *r, const ref_control_state *s, int number) {
    const double bound = fmax(1e-11, 1e-15 * s->cond_M);
    unsigned char given[MAX_V];
    double a[MAX_V], tau[MAX_V];
    for (int k = 0; k < r->nv; k++) given[k] = (unsigned char)s->hybrid_given[k];
    blank(r->nv, given, s->vdot, s->tau, a, tau);
    RUN(rbd_hybrid(r->m, r->w, s->q, s->v, given, a, tau, NULL));
    expect_close("hybrid, a", r, number, a, s->hybrid_a, r->nv, bound);
    expect_close("hybrid, tau", r, number, tau, s->hybrid_tau, r->nv, bound);
    expect_kept(r, number, given, s->vdot, s->tau, a, tau);
}

START_TEST(results_match_the_reference) { for_control_states(check_reference); }
END_TEST

/* The textbook's a and tau by M_ff a_f = tau_f - c_f - M_fg a_g; returns the condition number of M_ff in the
   1-norm, or -1. */
static double by_textbook(const robot *r, const state *s, const unsigned char *given, tb_real *a,
                          tb_real *tau) {
    static tb_real M[MAX_M], part[MAX_M], inverse[MAX_M], c[TB_MAX_DOFS], norm[2];
    double none[MAX_V] = {0};
    int n = 0, index[MAX_V];
    tb_mass_matrix(r->bodies, r->nb, s->q, M);
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, none, s->f_ext, c, NULL);
    for (int k = 0; k < r->nv; k++)
        if (!given[k]) index[n++] = k;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) part[i * n + j] = M[index[i] * r->nv + index[j]];
    if (n > 0 && !tb_invert(part, n, inverse)) return -1;
    for (int k = 0; k < r->nv; k++) a[k] = given[k] ? s->a[k] : 0;
    norm[0] = norm[1] = n > 0 ? 0 : 1;
    for (int i = 0; i < n; i++) {
        tb_real sum[2] = {0, 0}, x = 0;
        for (int j = 0; j < n; j++) {
            tb_real right = s->tau[index[j]] - c[index[j]];
            for (int k = 0; k < r->nv; k++)
                if (given[k]) right -= M[index[j] * r->nv + k] * a[k];
            x += inverse[i * n + j] * right;
            sum[0] += fabsl(part[i * n + j]);
            sum[1] += fabsl(inverse[i * n + j]);
        }
        for (int k = 0; k < 2; k++) norm[k] = larger((double)norm[k], (double)sum[k]);
        a[index[i]] = x;
    }
    for (int i = 0; i < r->nv; i++) {
        tau[i] = c[i];
        for (int k = 0; k < r->nv; k++) tau[i] += M[i * r->nv + k] * a[k];
    }
    return (double)(norm[0] * norm[1]);
}

/* Or an error, where M_ff is singular: random trees may be. */
static void check_pattern(const robot *r, const state *s, int number, pattern p) {
    uint64_t seed = (uint64_t)number * PATTERNS + p;
    unsigned char given[MAX_V];
    tb_real expected[2][TB_MAX_DOFS];
    double a[MAX_V], tau[MAX_V];
    draw_given(r, p, &seed, given);
    blank(r->nv, given, s->a, s->tau, a, tau);
    const double condition = by_textbook(r, s, given, expected[0], expected[1]);
    const rbd_status status = rbd_hybrid(r->m, r->w, s->q, s->v, given, a, tau, s->f_ext);
    if (condition > 0 && condition < 1e12) { /* below it, doubles keep some digits of the inverse */
        const double bound = inverse_bound(condition);
        expect_ok("hybrid", r, number, status);
        ck_assert_int_eq(rbd_singular_dof(r->w), -1);
        expect_close_tb("hybrid, textbook, a", r, number, a, expected[0], r->nv, bound);
        expect_close_tb("hybrid, textbook, tau", r, number, tau, expected[1], r->nv, bound);
        expect_kept(r, number, given, s->a, s->tau, a, tau);
    } else if (condition < 0 || condition > 1e18) {
        ck_assert_msg(status == RBD_ERR_SINGULAR, "%s, state %d, pattern %d: %s", r->name, number, p,
                      rbd_status_string(status));
        ck_assert_msg(!given[rbd_singular_dof(r->w)], "%s: a held dof is not singular", r->name);
        ck_assert_msg(largest(a, r->nv) == 0 && largest(tau, r->nv) == 0, "%s: not zero", r->name);
    }
}

static void check_textbook(const robot *r, const state *s, int number) {
    for (int p = 0; p < PATTERNS; p++) check_pattern(r, s, number, (pattern)p);
}

START_TEST(results_match_the_textbook_on_random_trees) { for_random_trees(60, check_textbook); }
END_TEST

/* ---- identities ---- */

static void check_ends(const robot *r, const state *s, int number) {
    unsigned char given[MAX_V];
    double a[MAX_V], tau[MAX_V], expected[MAX_V];
    memset(given, 1, sizeof given);
    blank(r->nv, given, s->a, s->tau, a, tau);
    RUN(rbd_hybrid(r->m, r->w, s->q, s->v, given, a, tau, s->f_ext));
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, expected));
    expect_close("hybrid, all given: rnea", r, number, tau, expected, r->nv, 1e-13);
    memset(given, 0, sizeof given);
    blank(r->nv, given, s->a, s->tau, a, tau);
    RUN(rbd_hybrid(r->m, r->w, s->q, s->v, given, a, tau, s->f_ext));
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, expected));
    expect_close("hybrid, none given: aba", r, number, a, expected, r->nv, 1e-11);
}

START_TEST(all_given_is_rnea_and_none_is_aba) { for_random_states(5, check_ends); }
END_TEST

/* ---- singular systems, errors ---- */

/* Forward dynamics fails for the second joint, which turns nothing; held, it is no matter. */
START_TEST(what_is_held_is_not_singular) {
    const rbd_body bead[2] = {
        {.parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {0, 0, 0.3}}};
    const double q[2] = {0.1, 0.2}, v[2] = {0.3, -0.4};
    double a[2] = {0, 0.5}, tau[2] = {3, 4};
    robot r = BUILD(bead);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, q, v, (const unsigned char[2]){0, 1}, a, tau, NULL), RBD_OK);
    ck_assert(fabs(a[0] - 1.5) < 1e-14 && fabs(tau[1]) < 1e-14);
    ck_assert_int_eq(rbd_singular_dof(r.w), -1);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, q, v, (const unsigned char[2]){1, 0}, a, tau, NULL),
                     RBD_ERR_SINGULAR);
    ck_assert_int_eq(rbd_singular_dof(r.w), 1);
    ck_assert(largest(a, 2) == 0 && largest(tau, 2) == 0);
    robot_free(&r);
}
END_TEST

/* One dof of a block is singular, and held or not. */
START_TEST(part_of_a_joint_may_be_held) {
    const rbd_body rod[2] = {
        {.parent = -1,
         .type = RBD_FLOATING,
         .mass = 1,
         .com = {0.1, 0.2, 0.3},
         .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 0, .type = RBD_SPHERICAL, .mass = 1, .com = {0, 0, 0.5}, .inertia = {0.1, 0, 0, 0.1}}};
    const double q[11] = {1, 2, 3, 0.1, 0.2, 0.3, 0.4, 0.4, 0.3, 0.2, 0.1}, v[9] = {1, 2, 3};
    unsigned char given[9] = {0, 1, 0, 0, 1, 0, 0, 0, 1};
    double a[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9}, tau[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9}, check[9];
    robot r = BUILD(rod);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, q, v, given, a, tau, NULL), RBD_OK);
    ck_assert_int_eq(rbd_rnea(r.m, r.w, q, v, a, NULL, check), RBD_OK);
    expect_close("part of a joint", &r, 0, check, tau, 9, 1e-12);
    given[8] = 0;
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, q, v, given, a, tau, NULL), RBD_ERR_SINGULAR);
    ck_assert_int_eq(rbd_singular_dof(r.w), 8);
    robot_free(&r);
}
END_TEST

static void expect_nan(const robot *r, const unsigned char *given) {
    double q[MAX_Q], a[MAX_V], tau[MAX_V];
    const double v[MAX_V] = {0};
    for (int k = 0; k < r->nq; k++) q[k] = (double)NAN;
    for (int k = 0; k < r->nv; k++) a[k] = tau[k] = 1;
    ck_assert_int_eq(rbd_hybrid(r->m, r->w, q, v, given, a, tau, NULL), RBD_ERR_NAN);
    ck_assert_int_ge(rbd_singular_dof(r->w), 0);
    ck_assert(largest(a, r->nv) == 0 && largest(tau, r->nv) == 0);
}

START_TEST(errors_have_their_names) {
    const rbd_body arm[3] = {
        {.parent = -1, .joint = "a", .type = RBD_REVOLUTE, .axis = {1, 0, 0}, .mass = 1, .com = {0, 0, 0.3}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0.1, 0.3}},
        {.parent = 1,
         .type = RBD_REVOLUTE,
         .axis = {0, 1, 0},
         .position = {0, 0, 1},
         .mass = 1,
         .com = {0, 0.1, 0.3},
         .mimic = "a",
         .mimic_ratio = 2}};
    robot r = robot_build("arm", arm, 2), other = robot_build("follower", arm, 3);
    const double x[MAX_Q] = {0};
    const unsigned char given[2] = {1, 0};
    double a[MAX_V], tau[MAX_V];
    ck_assert_int_eq(rbd_hybrid(NULL, r.w, x, x, given, a, tau, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_hybrid(r.m, NULL, x, x, given, a, tau, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, NULL, x, given, a, tau, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, x, NULL, given, a, tau, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, x, x, NULL, a, tau, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, x, x, given, NULL, tau, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_hybrid(r.m, r.w, x, x, given, a, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_hybrid(r.m, other.w, x, x, given, a, tau, NULL), RBD_ERR_WORK);
    expect_nan(&r, (const unsigned char[2]){0, 1}); /* the other joint's inertia is a constant */
    expect_nan(&other, (const unsigned char[2]){0, 1});
    robot_free(&r);
    robot_free(&other);
}
END_TEST

Suite *hybrid_suite(void) {
    Suite *suite = suite_create("hybrid");
    TCase *c = tcase_create("hybrid");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, results_match_the_reference);
    tcase_add_test(c, results_match_the_textbook_on_random_trees);
    tcase_add_test(c, all_given_is_rnea_and_none_is_aba);
    tcase_add_test(c, what_is_held_is_not_singular);
    tcase_add_test(c, part_of_a_joint_may_be_held);
    tcase_add_test(c, errors_have_their_names);
    suite_add_tcase(suite, c);
    return suite;
}
