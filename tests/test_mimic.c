/* test_mimic.c - trees with many mimic joints: followers before and behind what they follow, in its own chain
   and in other branches, on other roots; every dynamics function against the textbook, and the packed
   matrix's tree. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "suites.h"
#include "support.h"

enum { TREES = 400, MAX_M = MAX_V * MAX_V };

static int can_follow(const rbd_body *b) {
    return b->type == RBD_REVOLUTE || b->type == RBD_CONTINUOUS || b->type == RBD_PRISMATIC ||
           b->type == RBD_HELICAL;
}

/* Every second joint that can follows another, wherever that is. */
static void let_follow(uint64_t *seed, rbd_body *bodies, int nb) {
    int leads[MAX_BODIES] = {0};
    for (int i = 0; i < nb; i++) bodies[i].mimic = NULL;
    for (int i = 0; i < nb; i++) {
        const int leader = below(seed, nb);
        if (leader == i || leads[i] || below(seed, 2) || bodies[leader].mimic || !can_follow(&bodies[i]) ||
            !can_follow(&bodies[leader]))
            continue;
        leads[leader] = 1;
        bodies[i].mimic = bodies[leader].joint;
        bodies[i].mimic_ratio = uniform(seed, -2, 2);
        bodies[i].mimic_offset = uniform(seed, -1, 1);
    }
}

/* Hands: joints on one parent and behind one another that follow one of them, whichever. */
static void let_hold(uint64_t *seed, rbd_body *bodies, int nb) {
    int hand[MAX_BODIES] = {0};
    for (int i = 0; i < nb; i++) bodies[i].mimic = NULL;
    for (int i = 0; i < nb; i++) {
        int leader = i;
        if (hand[i] || !can_follow(&bodies[i])) continue;
        hand[i] = i + 1;
        for (int j = i + 1; j < nb; j++) {
            const int up = bodies[j].parent;
            if (hand[j] || !can_follow(&bodies[j]) || below(seed, 4) == 0) continue;
            if (up != bodies[i].parent && (up < 0 || hand[up] != i + 1)) continue;
            hand[j] = i + 1;
            if (below(seed, 2)) leader = j;
        }
        for (int j = i; j < nb; j++) {
            if (hand[j] != i + 1 || j == leader) continue;
            bodies[j].mimic = bodies[leader].joint;
            bodies[j].mimic_ratio = uniform(seed, -2, 2);
            bodies[j].mimic_offset = uniform(seed, -1, 1);
        }
    }
}

typedef void follow(uint64_t *seed, rbd_body *bodies, int nb);

static void for_trees(follow *let, state_check *check) {
    for (int i = 0; i < TREES; i++) {
        uint64_t seed = 5000 + (uint64_t)i;
        rbd_body bodies[MAX_BODIES];
        char name[32];
        state s;
        const int nb = 2 + below(&seed, 20);
        random_tree(&seed, bodies, nb);
        let(&seed, bodies, nb);
        snprintf(name, sizeof name, "mimic tree %d", i);
        robot r = robot_build(name, bodies, nb);
        draw_state(&r, &seed, &s);
        check(&r, &s, i);
        robot_free(&r);
    }
}

static void for_mimic_trees(state_check *check) { for_trees(let_follow, check); }

static void check_inverse(const robot *r, const state *s, int number) {
    tb_real expected[TB_MAX_DOFS];
    double found[MAX_V];
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, s->a, s->f_ext, expected, NULL);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, found));
    expect_close_tb("mimic: rnea", r, number, found, expected, r->nv, 1e-11);
}

START_TEST(inverse_dynamics) { for_mimic_trees(check_inverse); }
END_TEST

/* The full matrix, and the packed one wherever it has an entry; where it has none the entry is zero. */
static void check_matrix(const robot *r, const state *s, int number) {
    static tb_real expected[MAX_M];
    static double M[MAX_M], H[MAX_M], unpacked[MAX_M];
    const int nv = r->nv;
    tb_mass_matrix(r->bodies, r->nb, s->q, expected);
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_crba_packed(r->m, r->w, s->q, H));
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            const int index = rbd_packed_index(r->m, i, j);
            ck_assert_msg(index == rbd_packed_index(r->m, j, i) && index < rbd_packed_size(r->m),
                          "%s: entry (%d, %d) at %d", r->name, i, j, index);
            unpacked[i * nv + j] = index < 0 ? 0 : H[index];
        }
    expect_close_tb("mimic: crba", r, number, M, expected, nv * nv, 1e-11);
    expect_close_tb("mimic: crba packed", r, number, unpacked, expected, nv * nv, 1e-11);
}

START_TEST(mass_matrix) { for_mimic_trees(check_matrix); }
END_TEST

static void check_forward(const robot *r, const state *s, int number) {
    expect_textbook_forward("mimic: aba", rbd_aba, r, s, number);
    expect_textbook_forward("mimic: fd_cholesky", rbd_fd_cholesky, r, s, number);
}

START_TEST(forward_dynamics_by_both_ways) { for_mimic_trees(check_forward); }
END_TEST

static int followers(const robot *r) {
    int n = 0;
    for (int i = 0; i < r->nb; i++) n += r->bodies[i].mimic != NULL;
    return n;
}

static int hands;

/* aba solves by fd_cholesky where joints follow others: results have the same bits. */
static void check_hands(const robot *r, const state *s, int number) {
    double by_aba[MAX_V], by_cholesky[MAX_V];
    expect_textbook_forward("mimic: aba, hands", rbd_aba, r, s, number);
    if (followers(r) == 0) return;
    hands++;
    rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, by_aba);
    rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, s->f_ext, by_cholesky);
    ck_assert_mem_eq(by_aba, by_cholesky, (size_t)r->nv * sizeof *by_aba);
}

START_TEST(hands_go_by_fd_cholesky) {
    hands = 0;
    for_trees(let_hold, check_hands);
    ck_assert_int_gt(hands, TREES / 2);
}
END_TEST

/* Two fingers without mass: nothing tells how they move. */
START_TEST(hands_without_mass_are_singular) {
    rbd_body b[4] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {1, 0, 0}, .joint = "finger"},
        {.parent = 0, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mimic = "finger", .mimic_ratio = 2},
        {.parent = 2, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mimic = "finger", .mimic_ratio = 1}};
    uint64_t seed = 3;
    state s;
    double a[2];
    random_mass(&seed, &b[0]);
    robot r = BUILD(b);
    draw_state(&r, &seed, &s);
    ck_assert_int_eq(rbd_aba(r.m, r.w, s.q, s.v, s.tau, NULL, a), RBD_ERR_SINGULAR);
    ck_assert_int_eq(rbd_singular_dof(r.w), 1);
    robot_free(&r);
    b[3].armature[0] = 1e-3; /* which moves as the finger does */
    r = BUILD(b);
    draw_state(&r, &seed, &s);
    expect_textbook_forward("mimic: aba, armature", rbd_aba, &r, &s, 0);
    robot_free(&r);
}
END_TEST

/* M x is what solve is given. */
static void check_solve(const robot *r, const state *s, int number) {
    static double M[MAX_M], L[MAX_M];
    double b[MAX_V], x[MAX_V];
    tb_real a[TB_MAX_DOFS];
    const int nv = r->nv;
    const tb_real condition = tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, a);
    if (!(condition > 0 && condition < 1e12L)) return;
    RUN(rbd_crba(r->m, r->w, s->q, M));
    multiply(M, s->a, nv, nv, b);
    RUN(rbd_cholesky_factor(r->m, r->w, M, L));
    RUN(rbd_cholesky_solve(r->m, r->w, L, b, x));
    expect_close("mimic: solve", r, number, x, s->a, nv, inverse_bound((double)condition));
    RUN(rbd_cholesky_solve_many(r->m, r->w, L, nv, M, M)); /* M^-1 M = 1 */
    for (int k = 0; k < nv; k++) M[k * (nv + 1)] -= 1;
    expect_small("mimic: solve_many", r, number, largest(M, nv * nv), inverse_bound((double)condition));
    RUN(rbd_minverse(r->m, r->w, s->q, M));
    multiply(M, b, nv, nv, x);
    expect_close("mimic: minverse", r, number, x, s->a, nv, inverse_bound((double)condition));
}

START_TEST(factor_and_solve) { for_mimic_trees(check_solve); }
END_TEST

/* ---- the packed matrix's tree is that of elimination, and no larger ---- */

static int joint_of(const rbd_body *bodies, int nb, const char *name) {
    int i = 0;
    while (i < nb && strcmp(bodies[i].joint, name) != 0) i++;
    return i;
}

/* The body whose joint moves body i's: itself, or what it follows. */
static int mover(const robot *r, int i) {
    return r->bodies[i].mimic ? joint_of(r->bodies, r->nb, r->bodies[i].mimic) : i;
}

static void couple(const robot *r, const int *iv, int a, int b, char (*full)[MAX_V]) {
    const int i = mover(r, a), j = mover(r, b);
    for (int k = 0; k < tb_nv(&r->bodies[i]); k++)
        for (int l = 0; l < tb_nv(&r->bodies[j]); l++)
            full[iv[i] + k][iv[j] + l] = full[iv[j] + l][iv[i] + k] = 1;
}

/* Elimination from the last row on fills, for each row, the pairs of its columns. */
static void check_tree(const robot *r, const state *s, int number) {
    static char full[MAX_V][MAX_V];
    int iv[MAX_BODIES], lambda[MAX_V], nv = 0, entries = 0;
    (void)s;
    (void)number;
    memset(full, 0, sizeof full);
    for (int i = 0; i < r->nb; i++) {
        iv[i] = nv;
        nv += tb_nv(&r->bodies[i]);
    }
    for (int i = 0; i < r->nb; i++)
        for (int j = i; j >= 0; j = r->bodies[j].parent) couple(r, iv, i, j, full);
    for (int k = nv - 1; k >= 0; k--) {
        lambda[k] = -1;
        for (int i = 0; i < k; i++)
            for (int j = 0; full[k][i] && j < k; j++) full[i][j] |= full[k][j];
        for (int i = 0; i < k; i++)
            if (full[k][i]) lambda[k] = i;
    }
    for (int k = 0; k < nv; k++) {
        char column[MAX_V] = {0};
        for (int i = k; i >= 0; i = lambda[i], entries++) column[i] = 1;
        for (int i = 0; i <= k; i++)
            ck_assert_msg((rbd_packed_index(r->m, k, i) >= 0) == column[i] && column[i] >= full[k][i],
                          "%s: entry (%d, %d)", r->name, k, i);
    }
    ck_assert_msg(entries == rbd_packed_size(r->m), "%s: %d entries", r->name, entries);
}

START_TEST(the_tree_is_that_of_elimination) { for_mimic_trees(check_tree); }
END_TEST

/* A gripper: fingers that follow one of them couple nothing but themselves with the arm. */
START_TEST(a_gripper_stays_as_sparse_as_without) {
    rbd_body b[12];
    memset(b, 0, sizeof b);
    for (int i = 0; i < 12; i++) {
        b[i].parent = i - 1;
        b[i].type = RBD_REVOLUTE;
        b[i].axis[i % 3] = 1;
        b[i].position[2] = 0.1;
        random_mass(&(uint64_t){17}, &b[i]);
    }
    b[3].parent = 0; /* another branch of the arm, and fingers 6 to 11 on the palm 5 */
    b[4].parent = 2;
    b[6].joint = "finger";
    for (int i = 7; i < 12; i++) {
        b[i].parent = 5;
        b[i].mimic = "finger";
        b[i].mimic_ratio = -1;
    }
    robot with = BUILD(b), without = robot_build("no followers", b, 7);
    ck_assert_int_eq(rbd_packed_size(with.m), rbd_packed_size(without.m));
    robot_free(&with);
    robot_free(&without);
}
END_TEST

Suite *mimic_suite(void) {
    Suite *suite = suite_create("mimic");
    TCase *c = tcase_create("mimic");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, inverse_dynamics);
    tcase_add_test(c, mass_matrix);
    tcase_add_test(c, forward_dynamics_by_both_ways);
    tcase_add_test(c, hands_go_by_fd_cholesky);
    tcase_add_test(c, hands_without_mass_are_singular);
    tcase_add_test(c, factor_and_solve);
    tcase_add_test(c, the_tree_is_that_of_elimination);
    tcase_add_test(c, a_gripper_stays_as_sparse_as_without);
    suite_add_tcase(suite, c);
    return suite;
}
