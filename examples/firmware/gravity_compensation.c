/* gravity_compensation.c - HyQ hangs in a gantry that carries its trunk; the motors carry the legs, at a
   fixed period, without a heap. Its weight must come out right, what is pushed must stay where it stops, and
   what is not must not move. SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "control.h"
#define HYQ_MODEL_IMPLEMENTATION /* the built model: const, in flash */
#include "models/hyq_model.h"
#include "../larger.h"

enum { NV = HYQ_NV, TRUNK = HYQ_DOF_LF_HAA_JOINT, LEGS = 4, STEPS = 1000000 / PERIOD_US }; /* one second */

static const rbd_real damping = 1; /* N m s/rad, by the motors */
static const rbd_real gantry_damping = 60;
static const rbd_real push = 0.5f; /* rad/s, of the first leg joint */

/* g: gravity torque, whose first six are the wrench of the gantry; tau: that, and dampers against what moves.
 */
static rbd_status control(rbd_work *w, const rbd_real *q, const rbd_real *v, rbd_real *g, rbd_real *tau) {
    rbd_status status = rbd_gravity_torque(&hyq_model, w, q, g);
    for (int i = 0; i < NV; i++) tau[i] = g[i] - (i < TRUNK ? gantry_damping : damping) * v[i];
    return status;
}

/* Relative: the force that carries the trunk against what the model weighs. */
static rbd_real weight_error(const rbd_real *g) {
    const rbd_real *f = &g[HYQ_DOF_ROOT_VX];
    const rbd_real force = sqrtf(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    return fabsf(force / (9.81f * rbd_mass(&hyq_model)) - 1);
}

int main(void) {
    static unsigned char memory[HYQ_WORK_SIZE];
    static rbd_real q[HYQ_NQ], v[NV], g[NV], tau[NV], scratch[NV];
    rbd_work *w;
    rbd_status status = rbd_work_init(&hyq_model, memory, sizeof memory, &w);
    rbd_real weight = 0, fastest = 0;
    int late = 0;
    rbd_neutral(&hyq_model, q);
    for (int leg = 0; leg < LEGS; leg++) { /* crouching, rad */
        q[HYQ_Q_LF_HAA_JOINT + leg] = 0.1f;
        q[HYQ_Q_LF_HFE_JOINT + leg] = 0.7f;
        q[HYQ_Q_LF_KFE_JOINT + leg] = -1.4f;
    }
    v[HYQ_DOF_LF_HAA_JOINT] = push;
    board_start();
    uint32_t start = board_now();
    for (int step = 0; step < STEPS && status == RBD_OK; step++) {
        status = control(w, q, v, g, tau);
        weight = largerf(weight, weight_error(g));
        if (status == RBD_OK) status = simulate(&hyq_model, w, q, v, tau, NULL, scratch);
        late += !board_wait(&start, BOARD_TICKS(PERIOD_US));
    }
    for (int i = 0; i < NV; i++) fastest = largerf(fastest, fabsf(v[i]));
    printf("gravity compensation, HyQ: %d periods of %d us, %d late; weight off by %d ppm at worst; %d "
           "urad/s left "
           "of a push of %d: %s\n",
           STEPS, PERIOD_US, late, (int)(weight * 1e6f), (int)(fastest * 1e6f), (int)(push * 1e6f),
           rbd_status_string(status));
    return !(status == RBD_OK && late == 0 && weight <= 1e-6f && fastest <= 0.05f * push);
}
