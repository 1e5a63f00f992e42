/* test_control.c - the models of the control data, by calls that other suites test more; and that the data of
   a state belong together, so that a slip of convert.py shows here. */
#include <math.h>

#include "suites.h"
#include "support.h"

static void check_calls(const robot *r, const ref_control_state *s, int number) {
    const int nv = r->nv;
    double out[MAX_V * MAX_V], q[MAX_Q], velocity[3], expected[3];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->vdot, NULL, out));
    expect_close("rnea, control", r, number, out, s->tau_rnea, nv, 1e-13);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->vdot, s->f_ext, out));
    expect_close("rnea, wrenches, control", r, number, out, s->tau_rnea_ext, nv, 1e-13);
    RUN(rbd_gravity_torque(r->m, r->w, s->q, out));
    expect_close("gravity, control", r, number, out, s->g, nv, 1e-12);
    RUN(rbd_crba(r->m, r->w, s->q, out));
    expect_close("crba, control", r, number, out, s->M, nv * nv, 1e-13);
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, NULL, out));
    expect_close("aba, control", r, number, out, s->qdd, nv, inverse_bound(s->cond_M));
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, out));
    expect_close("aba, wrenches, control", r, number, out, s->qdd_ext, nv, inverse_bound(s->cond_M));
    RUN(rbd_integrate(r->m, s->q, s->integrate_d, 1, q));
    expect_close("integrate, control", r, number, q, s->integrate_q_plus, r->nq, 1e-14);
    RUN(rbd_difference(r->m, s->q, s->difference_q1, out));
    expect_close("difference, control", r, number, out, s->difference_d, nv, 1e-12);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_com(r->m, r->w, NULL, velocity, NULL));
    multiply(s->J_com, s->v, 3, nv, expected);
    expect_close("velocity of the com, control", r, number, velocity, expected, 3, 1e-13);
}

START_TEST(calls_match_the_control_data) { for_control_states(check_calls); }
END_TEST

static void check_dynamics(const robot *r, const ref_control_state *s, int number) {
    const int nv = r->nv;
    double left[MAX_V * MAX_V], right[MAX_V * MAX_V];
    multiply(s->C, s->v, nv, nv, left);
    for (int i = 0; i < nv; i++) right[i] = s->c[i] - s->g[i];
    expect_close("data: C v = c - g", r, number, left, right, nv, 1e-11);
    for (int i = 0; i < nv * nv; i++) left[i] = s->C[i] + s->C[i % nv * nv + i / nv];
    expect_close("data: C + C' = Mdot", r, number, left, s->Mdot, nv * nv, 1e-12);
    multiply(s->M, s->hybrid_a, nv, nv, left);
    for (int i = 0; i < nv; i++) {
        left[i] += s->c[i];
        if (s->hybrid_given[i])
            ck_assert(!(s->hybrid_a[i] < s->vdot[i]) && !(s->hybrid_a[i] > s->vdot[i]));
        else
            ck_assert(!(s->hybrid_tau[i] < s->tau[i]) && !(s->hybrid_tau[i] > s->tau[i]));
    }
    expect_close("data: hybrid", r, number, left, s->hybrid_tau, nv, 1e-12);
    multiply(s->A_h, s->v, 6, nv, left);
    expect_close("data: A_h v = h", r, number, left, s->h, 6, 1e-12);
    multiply(s->A_h, s->vdot, 6, nv, left);
    for (int i = 0; i < 6; i++) left[i] += s->A_h_dot_v[i];
    expect_close("data: A_h vdot + A_h_dot v = h_dot", r, number, left, s->h_dot, 6, 1e-12);
}

static void check_points_and_constraints(const robot *r, const ref_control_state *s, int number) {
    const int nv = r->nv;
    double out[MAX_V], acceleration[6];
    for (int i = 0; i < s->npoints; i++) {
        const ref_point *point = &s->points[i];
        ck_assert(point->body >= 0 && point->body < r->nb);
        multiply(point->point_J, s->v, 6, nv, out);
        expect_close("data: J v of a point", r, number, out, point->point_vel, 6, 1e-12);
        multiply(point->point_J, s->vdot, 6, nv, acceleration);
        for (int k = 0; k < 6; k++) acceleration[k] += point->point_bias[k];
        expect_close("data: acceleration of a point", r, number, acceleration, point->point_acc_classical, 6,
                     1e-12);
    }
    for (int i = 0; i < s->nconstraint_sets; i++) {
        const ref_constraint_set *set = &s->constraint_sets[i];
        int rows = 0;
        for (int k = 0; k < set->count; k++)
            for (int axis = 0; axis < 6; axis++) rows += set->constraints[k].axes[axis];
        ck_assert_int_eq(rows, set->rows);
        ck_assert((set->dqdd_c_dq != NULL) == (set->rank == set->rows));
        for (int k = 0; k < rows; k++)
            expect_small("data: J a + gamma = 0", r, number,
                         fabs(dot(set->J_c + k * nv, set->qdd_c, nv) + set->gamma[k]),
                         1e-11 * fmax(1, largest(set->qdd_c, nv)));
    }
}

START_TEST(control_data_belong_together) {
    for_control_states(check_dynamics);
    for_control_states(check_points_and_constraints);
}
END_TEST

Suite *control_suite(void) {
    Suite *suite = suite_create("control");
    TCase *c = tcase_create("control");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, calls_match_the_control_data);
    tcase_add_test(c, control_data_belong_together);
    suite_add_tcase(suite, c);
    return suite;
}
