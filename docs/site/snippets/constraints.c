#include "rbd_derivatives.h"

#include "rbd_constraints.h"

#include "models/hyq_model.h"

#include <stdio.h>

enum { FEET = 2, ROWS = 3 * FEET, NV = HYQ_NV };
const rbd_model *m = &hyq_model;
unsigned char work_memory[HYQ_WORK_SIZE], memory[RBD_CONSTRAINT_SET_SIZE(NV, ROWS)];
unsigned char derivatives_memory[RBD_DERIVATIVES_SIZE(HYQ_NB, NV)];
rbd_work *w;
rbd_derivatives *d;
rbd_constraint_set *c;
rbd_status status;
double q[HYQ_NQ], v[NV], a[NV], tau[NV], lambda[ROWS];

void example_rbd_constraint_set_init(void) {
    const double toe[3] = {0.33, 0, 0};
    const rbd_constraint feet[FEET] = {rbd_point_contact(HYQ_BODY_LF_LOWERLEG, toe, NULL),
                                       rbd_point_contact(HYQ_BODY_RH_LOWERLEG, toe, NULL)};
    rbd_report report;
    char text[240];
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    if (status == RBD_OK) status = rbd_neutral(m, q);
    for (int i = 7; i < HYQ_NQ; i++) q[i] = 0.5 + 0.05 * i; /* bent knees */
    if (status == RBD_OK)
        status = rbd_constraint_set_init(m, w, feet, FEET, memory, sizeof memory, &c, &report);
    if (status != RBD_OK) rbd_constraint_finding_text(&report.error, text, sizeof text);
    if (rbd_constraint_set_size(m, feet, FEET) > sizeof memory) status = RBD_ERR_MEMORY;
}

void example_rbd_constraint_rows(void) {
    const int rows = rbd_constraint_rows(c), first = rbd_constraint_first(c, 1); /* 6 and 3 */
    for (int i = first; i < rows; i++) printf("push of the second foot: %g N\n", lambda[i]);
}

void example_rbd_constraint_jacobian(void) {
    double J[ROWS * NV], gamma[ROWS], e[ROWS];
    status = rbd_constraint_jacobian(m, c, q, v, J, gamma, e);
}

void example_rbd_constrained_fd(void) {
    status = rbd_constrained_fd(m, c, q, v, tau, NULL, a, lambda); /* lambda[2]: how the first foot pushes */
    if (status == RBD_ERR_INFEASIBLE) printf("row %d contradicts another\n", rbd_infeasible_row(c));
    if (rbd_constraint_rank(c) < ROWS) puts("some rows depend on others: lambda is the least of many");
}

void example_rbd_impact(void) {
    double v_plus[NV], impulse[ROWS];
    status = rbd_impact(m, c, q, v, 0, v_plus, impulse); /* restitution 0: the feet stay */
}

void example_rbd_constrained_id(void) {
    status = rbd_constrained_id(m, c, q, v, a, NULL, NULL, NULL, tau, lambda); /* all joints have motors */
}

void example_rbd_assemble(void) {
    double q_near[HYQ_NQ], v_near[NV];
    status = rbd_assemble(m, c, q, v, NULL, q_near, v_near);
}

void example_rbd_constrained_fd_derivatives(void) {
    static double a_q[NV * NV], l_q[ROWS * NV];
    const rbd_constrained_fd_results out = {.a = a, .lambda = lambda, .da_dq = a_q, .dlambda_dq = l_q};
    status = rbd_derivatives_init(m, w, derivatives_memory, sizeof derivatives_memory, &d);
    if (status == RBD_OK) status = rbd_constrained_fd_derivatives(m, c, d, q, v, tau, NULL, &out);
}

void example_rbd_hinge_loop(void) {
    const double pin[3] = {0.35, 0, 0}, axis[3] = {0, 1, 0};
    const rbd_constraint loops[3] = {rbd_hinge_loop(1, pin, axis, 2, pin, axis),
                                     rbd_ball_loop(1, pin, 2, pin), rbd_flat_contact(1, pin, NULL)};
    for (int i = 0; i < 3; i++) { /* 5 axes are held, 3, and 6 */
        int rows = 0;
        for (int k = 0; k < 6; k++) rows += loops[i].axes[k];
        printf("constraint %d holds %d axes\n", i, rows);
    }
}
