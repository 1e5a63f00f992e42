#include "rbd_derivatives.h"

#include "rbd_contact.h"

#include "models/hyq_model.h"

#include <stdio.h>

enum { NV = HYQ_NV };
const rbd_model *m = &hyq_model;
unsigned char work_memory[HYQ_WORK_SIZE], derivatives_memory[RBD_DERIVATIVES_SIZE(HYQ_NB, NV)],
    memory[200000];
rbd_work *w;
rbd_derivatives *d;
rbd_contact_set *c;
rbd_status status;
double q[HYQ_NQ], v[NV], a[NV], tau[NV];

void example_rbd_contact_set_init(void) {
    static const rbd_contact feet[2] = {{.name = "left fore foot",
                                         .body1 = HYQ_BODY_LF_LOWERLEG,
                                         .body2 = -1,
                                         .point = {0.33, 0, 0},
                                         .radius = 0.02,
                                         .friction = 0.7},
                                        {.name = "right fore foot",
                                         .body1 = HYQ_BODY_RF_LOWERLEG,
                                         .body2 = -1,
                                         .point = {0.33, 0, 0},
                                         .radius = 0.02,
                                         .friction = 0.7}};
    const rbd_contact_options options = {.joint_limits = 1, .joint_friction = 1, .derivatives = 1, .rows = 1};
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    if (status == RBD_OK) status = rbd_neutral(m, q);
    q[2] = 0.5;
    if (rbd_contact_set_size(m, 2, NULL, 0, &options) > sizeof memory) status = RBD_ERR_MEMORY;
    rbd_report report;
    char text[200];
    if (status == RBD_OK)
        status = rbd_contact_set_init(m, w, feet, 2, NULL, 0, &options, memory, sizeof memory, &c, &report);
    if (status != RBD_OK) rbd_contact_finding_text(&report.error, 2, text, sizeof text);
}

void example_rbd_contact_step(void) {
    status = rbd_contact_step(m, c, q, v, tau, NULL, NULL, 1e-3, q, v);
    if (rbd_contact_last(c).residual > 1e-6) puts("contacts obey their laws less well than asked for");
}

void example_rbd_contact_get(void) {
    double gap, force[3];
    if (rbd_contact_get(c, 0, &gap, force) == RBD_SLIPS)
        printf("foot 0 slips; the floor gives %g N up\n", force[2]);
}

void example_rbd_contact_fd(void) { status = rbd_contact_fd(m, c, q, v, tau, NULL, NULL, 1e-3, a); }

void example_rbd_contact_plane(void) {
    const double slope[3] = {-0.1, 0, 1};
    status = rbd_contact_plane(m, c, 0, slope, 0.05); /* terrain under foot 0 from the next step on */
}

void example_rbd_contact_friction(void) {
    status = rbd_contact_friction(m, c, 6, 1.5);  /* the hip's motor is warm: N m, from the next step on */
    if (status == RBD_ERR_INDEX) status = RBD_OK; /* no friction in the description: take a bounded row */
}

void example_rbd_contact_row_set(void) {
    /* shaft 0 turns with two joints of a leg, and has friction */
    const rbd_contact_row shaft = {
        .dofs = 2, .dof = {6, 10}, .jacobian = {1, -1}, .lower = -0.8, .upper = 0.8};
    status = rbd_contact_row_set(m, c, 0, &shaft);
}

void example_rbd_contact_row_get(void) {
    double force;
    if (rbd_contact_row_get(c, 0, &force) == RBD_STICKS) tau[6] += force; /* N m, within the bounds */
}

void example_rbd_contact_inertia(void) {
    static double added[NV * (NV + 1) / 2]; /* kept: 0 but where two joints share a rotor of 0.02 kg m^2 */
    added[rbd_packed_index(m, 10, 6)] = -0.02;
    added[rbd_packed_index(m, 6, 6)] = added[rbd_packed_index(m, 10, 10)] = 0.02;
    status = rbd_contact_inertia(m, c, added);
}

void example_rbd_contact_reset(void) {
    q[2] = 0.6; /* the state jumps */
    rbd_contact_reset(c);
}

void example_rbd_contact_step_derivatives(void) {
    static double q_q[NV * NV], v_q[NV * NV];
    const rbd_contact_step_results out = {.q_next = q, .v_next = v, .dq_next_dq = q_q, .dv_next_dq = v_q};
    status = rbd_derivatives_init(m, w, derivatives_memory, sizeof derivatives_memory, &d);
    if (status == RBD_OK) status = rbd_contact_step_derivatives(m, c, d, q, v, tau, NULL, NULL, 1e-3, &out);
}

void example_rbd_contact_solve(void) {
    static const double delta[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, b[3] = {0.1, 0, -1}, mu[1] = {0.5};
    const rbd_contact_problem problem = {.contacts = 1, .delta = delta, .b = b, .friction = mu};
    static unsigned char scratch[4000];
    double p[3] = {0};
    rbd_contact_state state;
    rbd_contact_solution solution;
    if (rbd_contact_solve_size(1, 0) > sizeof scratch) status = RBD_ERR_MEMORY;
    if (status == RBD_OK) status = rbd_contact_solve(&problem, scratch, sizeof scratch, p, &state, &solution);
}
