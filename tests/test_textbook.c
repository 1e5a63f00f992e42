/* test_textbook.c - the arbiter itself against the reference: two independent sources agree. */
#include <math.h>

#include "suites.h"
#include "support.h"

enum { MAX_M = MAX_V * MAX_V };

static void textbook(const char *what, const robot *r, int number, const tb_real *found,
                     const double *expected, int n, double bound) {
    double rounded[MAX_M];
    for (int i = 0; i < n; i++) rounded[i] = (double)found[i];
    expect_close(what, r, number, rounded, expected, n, bound);
}

static void check_dynamics(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const double rest[MAX_V] = {0};
    const rbd_body *b = model->bodies;
    const int nb = model->nb, nv = model->nv;
    tb_real tau[TB_MAX_DOFS], M[MAX_M];
    tb_rnea(b, nb, s->gravity, s->q, s->v, s->vdot, NULL, tau, NULL);
    textbook("textbook rnea", r, number, tau, s->tau_rnea, nv, 5e-15);
    tb_rnea(b, nb, s->gravity, s->q, s->v, s->vdot, s->f_ext, tau, NULL);
    textbook("textbook rnea, wrenches", r, number, tau, s->tau_rnea_ext, nv, 5e-15);
    tb_rnea(b, nb, s->gravity, s->q, s->v, rest, NULL, tau, NULL);
    textbook("textbook bias", r, number, tau, s->c, nv, 5e-13); /* iiwa at rest: nearly zero */
    tb_mass_matrix(b, nb, s->q, M);
    textbook("textbook mass matrix", r, number, M, s->M, nv * nv, 5e-15);
    tb_real condition = tb_forward(b, nb, s->gravity, s->q, s->v, s->tau, NULL, tau);
    ck_assert(condition > 0);
    textbook("textbook qdd", r, number, tau, s->qdd, nv, 2e-14);
}

START_TEST(textbook_dynamics_match_the_reference) { for_reference_states(check_dynamics); }
END_TEST

static void check_motion(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const int nb = model->nb;
    tb_real tau[TB_MAX_DOFS];
    tb_motion m;
    tb_rnea(model->bodies, nb, s->gravity, s->q, s->v, s->vdot, NULL, tau, &m);
    textbook("textbook rotation", r, number, m.R[0], s->body_R, 9 * nb, 5e-15);
    textbook("textbook position", r, number, m.p[0], s->body_p, 3 * nb, 5e-15);
    textbook("textbook velocity", r, number, m.velocity[0], s->body_vel, 6 * nb, 5e-15);
    textbook("textbook acceleration", r, number, m.acceleration[0], s->body_acc, 6 * nb, 5e-15);
    for (int i = 0; i < nb; i++)
        textbook("textbook classical", r, number, m.classical[i] + 3, s->body_acc_classical + 3 * i, 3,
                 5e-15);
    textbook("textbook kinetic", r, number, &m.kinetic, &s->kinetic, 1, 1e-14);
    textbook("textbook potential", r, number, &m.potential, &s->potential, 1, 5e-14);
    textbook("textbook mass", r, number, &m.mass, &s->mass, 1, 5e-15);
    textbook("textbook com", r, number, m.com, s->com, 3, 5e-15);
    textbook("textbook com velocity", r, number, m.com_velocity, s->com_vel, 3, 5e-15);
    textbook("textbook com acceleration", r, number, m.com_acceleration, s->com_acc, 3, 5e-15);
}

START_TEST(textbook_motion_matches_the_reference) { for_reference_states(check_motion); }
END_TEST

/* Two ways from one book; and rbd's, whose passes are the table's. */
static int articulated_trees;

static void check_articulated(const robot *r, const state *s, int number) {
    tb_real expected[TB_MAX_DOFS], found[TB_MAX_DOFS];
    double rounded[MAX_V], a[MAX_V];
    const tb_real condition =
        tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, expected);
    for (int i = 0; i < r->nb; i++)
        if (r->bodies[i].mimic) return;
    if (!(condition > 0 && condition < 1e12L)) /* long double keeps seven digits of the inverse */
        return;
    articulated_trees++;
    ck_assert(tb_aba(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, found));
    for (int i = 0; i < r->nv; i++) rounded[i] = (double)found[i];
    expect_close_tb("textbook aba", r, number, rounded, expected, r->nv,
                    fmax(1e-15, 1e-18 * (double)condition));
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, a));
    expect_close_tb("aba, textbook aba", r, number, a, found, r->nv, inverse_bound((double)condition));
}

START_TEST(articulated_bodies_of_the_textbook_agree) {
    articulated_trees = 0;
    for_random_trees(300, check_articulated);
    for_random_states(5, check_articulated);
    ck_assert_int_gt(articulated_trees, OF_TREES(300));
}
END_TEST

static void check_articulated_reference(const robot *r, const ref_model *model, const ref_state *s,
                                        int number) {
    tb_real a[TB_MAX_DOFS];
    ck_assert(tb_aba(model->bodies, model->nb, s->gravity, s->q, s->v, s->tau, NULL, a));
    textbook("textbook aba", r, number, a, s->qdd, model->nv, 2e-14);
    ck_assert(tb_aba(model->bodies, model->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, a));
    textbook("textbook aba, wrenches", r, number, a, s->qdd_ext, model->nv, 2e-14);
}

START_TEST(articulated_bodies_of_the_textbook_match_the_reference) {
    for_reference_states(check_articulated_reference);
}
END_TEST

Suite *textbook_suite(void) {
    Suite *suite = suite_create("textbook");
    TCase *c = tcase_create("textbook");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, textbook_dynamics_match_the_reference);
    tcase_add_test(c, textbook_motion_matches_the_reference);
    tcase_add_test(c, articulated_bodies_of_the_textbook_agree);
    tcase_add_test(c, articulated_bodies_of_the_textbook_match_the_reference);
    suite_add_tcase(suite, c);
    return suite;
}
