#include "rbd_estimate.h"

#include "models/iiwa_model.h"

const rbd_model *m = &iiwa_model;
unsigned char work_memory[IIWA_WORK_SIZE], derivatives_memory[RBD_DERIVATIVES_SIZE(IIWA_NB, IIWA_NV)];
rbd_work *w;
rbd_derivatives *d;
rbd_observer *observer;
rbd_estimate *e;
rbd_estimate_fault fault;
rbd_status status;
double q[IIWA_NV], v[IIWA_NV], a[IIWA_NV], tau[IIWA_NV], r[IIWA_NV], band[IIWA_NV];
rbd_joint_friction friction[IIWA_NV];
int pushed, known;

/* An observer that follows within 25 ms, and knows the friction to a fifth. */
void example_rbd_observer_init(void) {
    static unsigned char memory[RBD_OBSERVER_SIZE(IIWA_NV)];
    const rbd_observer_options options = {.gain = 40, .share = 0.2, .least = 0.5, .friction = friction};
    char text[100];
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    if (status == RBD_OK) status = rbd_observer_init(m, &options, memory, sizeof memory, &observer, &fault);
    if (status != RBD_OK) rbd_estimate_text(status, &fault, text, sizeof text);
}

/* Memory at run time. */
void example_rbd_observer_size(void) {
    if (rbd_observer_size(m) > RBD_OBSERVER_SIZE(IIWA_NV)) status = RBD_ERR_MEMORY;
}

/* Each millisecond: which joint is pushed? */
void example_rbd_observer_step(void) {
    status = rbd_observer_step(m, w, observer, q, v, tau, 0.001, r, band, NULL);
    pushed = -1;
    for (int i = 0; i < IIWA_NV; i++)
        if (r[i] > band[i] || r[i] < -band[i]) pushed = i;
}

/* After a pause of the motors. */
void example_rbd_observer_reset(void) { status = rbd_observer_reset(observer); }

/* Friction of each joint, and what the last link carries, 3 kg at most. */
void example_rbd_estimate_init(void) {
    static unsigned char memory[RBD_ESTIMATE_SIZE(IIWA_NV)];
    const rbd_estimate_options options = {.mass = 3, .forgetting = 0.999};
    status = rbd_derivatives_init(m, w, derivatives_memory, sizeof derivatives_memory, &d);
    if (status == RBD_OK)
        status = rbd_estimate_init(m, IIWA_NB - 1, &options, memory, sizeof memory, &e, &fault);
}

/* Memory at run time. */
void example_rbd_estimate_size(void) {
    if (rbd_estimate_size(m) > RBD_ESTIMATE_SIZE(IIWA_NV)) status = RBD_ERR_MEMORY;
}

/* Each tick: a sample. */
void example_rbd_estimate_add(void) { status = rbd_estimate_add(m, d, e, q, v, a, tau, &fault); }

/* Ten times a second: the estimate, as a payload for the model. */
void example_rbd_estimate_solve(void) {
    rbd_const payload[10];
    rbd_body load = {.mass = 0};
    double misfit;
    status = rbd_estimate_solve(e, payload, friction, &misfit);
    if (status == RBD_OK) status = rbd_set_parameters(&load, payload);
}

/* How well it is known. */
void example_rbd_estimate_deviations(void) {
    rbd_const deviation[10];
    status = rbd_estimate_deviations(e, deviation, NULL);
    known = status == RBD_OK && deviation[0] < 0.1; /* kg; else move more */
}

/* The gripper has closed; it has opened. */
void example_rbd_estimate_grip(void) { status = rbd_estimate_grip(e); }
void example_rbd_estimate_release(void) { status = rbd_estimate_release(e); }

/* What was wrong. */
void example_rbd_estimate_text(void) {
    char text[100];
    rbd_estimate_text(status, &fault, text, sizeof text); /* "tau[3]: not finite" */
}
