#include "rbd_actuator.h"
#include "rbd_contact.h"

#include "models/iiwa_model.h"

const rbd_model *m = &iiwa_model;
unsigned char work_memory[IIWA_WORK_SIZE];
rbd_work *w;
rbd_status status;
double q[IIWA_NQ], v[IIWA_NV], acc[IIWA_NV], tau[IIWA_NV], damping[IIWA_NV], q_next[IIWA_NQ], v_next[IIWA_NV];
rbd_contact_set *c;
rbd_actuators *a;
unsigned char memory[RBD_ACTUATORS_SIZE(2, 0, 2)];
rbd_command commands[2];

/* Two of an arm's motors. */
const rbd_motor motors[2] = {{.name = "shoulder",
                              .joint = "lbr_iiwa_joint_2",
                              .gear = 100,
                              .constant = 0.1,
                              .inertia = 1e-4,
                              .current = 15,
                              .friction = {.coulomb = 4, .viscous = 2}},
                             {.name = "elbow",
                              .joint = "lbr_iiwa_joint_4",
                              .gear = 100,
                              .constant = 0.08,
                              .inertia = 5e-5,
                              .delay = 2,
                              .friction = {.coulomb = 2, .viscous = 1}}};

/* The level at 0.1 rad/s, where the motor lifts a load of 20 N m. */
void example_rbd_friction_level(void) {
    const double level = rbd_friction_level(&motors[0].friction, 0.1, 25, -20);
    if (!(level > 0)) status = RBD_ERR_RANGE;
}

/* A wrong table says where. */
void example_rbd_actuators_init(void) {
    rbd_report report;
    char text[120];
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    if (rbd_actuators_init(m, motors, 2, NULL, 0, memory, sizeof memory, &a, &report) != RBD_OK) {
        rbd_actuators_finding_text(&report.error, 2, text, sizeof text);
        status = report.error.status;
    }
}

/* Memory at run time. */
void example_rbd_actuators_size(void) {
    if (rbd_actuators_size(2, 0, 2) > sizeof memory) status = RBD_ERR_MEMORY;
}

void example_rbd_actuators_finding_text(void) {
    const rbd_finding finding = {.status = RBD_ERR_RANGE, .body = 1, .name = "elbow", .field = "gear"};
    char text[120];
    rbd_actuators_finding_text(&finding, 2, text, sizeof text);
}

/* Where encoders on the shafts are. */
void example_rbd_actuators_map(void) {
    double angle[2], speed[2];
    status = rbd_actuators_map(a, q, v, angle, speed);
}

/* Which rods do not reach. */
void example_rbd_actuators_fault(void) {
    if (rbd_actuators_map(a, q, NULL, NULL, NULL) == RBD_ERR_INFEASIBLE && rbd_actuators_fault(a) >= 0)
        status = RBD_ERR_INFEASIBLE;
}

/* Currents for a planned motion. */
void example_rbd_actuators_inverse(void) {
    rbd_drive drives[2];
    status = rbd_rnea(m, w, q, v, acc, NULL, tau);
    if (status == RBD_OK) status = rbd_actuators_inverse(a, q, v, acc, tau, drives);
}

void example_rbd_actuators_reset(void) { status = rbd_actuators_reset(a, q, 20); }

/* A millisecond of the arm, whose shoulder holds a position. */
void example_rbd_actuators_begin(void) {
    commands[0].kp = 500;
    commands[0].kd = 20;
    status = rbd_actuators_begin(a, commands, q, v, 1e-3, 0, tau, damping);
}

void example_rbd_actuators_again(void) {
    do status = rbd_free_step(m, w, q, v, tau, NULL, damping, 1e-3, q_next, v_next);
    while (status == RBD_OK && rbd_actuators_again(a, v_next, tau, damping));
}

void example_rbd_actuators_get(void) {
    rbd_actuator_state state;
    status = rbd_actuators_get(a, 0, &state);
    if (state.saturated) status = RBD_ERR_RANGE;
}

/* Between begin and again. */
void example_rbd_actuators_derivatives(void) {
    double dq[IIWA_NV * IIWA_NV], dv[IIWA_NV * IIWA_NV];
    status = rbd_actuators_begin(a, commands, q, v, 1e-3, 0, tau, damping);
    if (status == RBD_OK) status = rbd_actuators_derivatives(a, dq, dv, NULL);
}

/* The shoulder's rotor sits on the first link, about the joint's axis. */
void example_rbd_rotor_torque(void) {
    const rbd_rotor rotor = {.body = 0, .dof = 1, .axis = {0, 1, 0}, .gear = 100, .inertia = 1e-4};
    double f_ext[6 * IIWA_NB] = {0};
    status = rbd_rotor_torque(m, w, &rotor, 1, q, v, acc, f_ext, tau);
}
