/* recorded_servos.c - an arm of servos, arm and motors simulated in the same image, whose controller keeps
   its last ticks. The gear of joint 4 begins to run dry. When a joint is too far off its path, the controller
   stops and dumps what it kept. SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "servo_controller.h"
#include "board.h"
#include "cost.h"
#include "../larger.h"

#ifndef RECORDED_TICKS
#define RECORDED_TICKS 500
#endif
enum { DRY_JOINT = 3, DRY = 600, LAST = 1600 }; /* the tick when its gear begins to run dry; the last one */
static const rbd_real too_far = 0.03f;          /* rad */

static rbd_real ring[RECORDER_SIZE(INPUTS, STATES, OUTPUTS, RECORDED_TICKS)];
static recorder record = {
    .ring = ring, .inputs = INPUTS, .states = STATES, .outputs = OUTPUTS, .ticks = RECORDED_TICKS};

static rbd_motor motors[N]; /* of the simulated arm: in RAM, since one of them wears */
static unsigned char work_memory[IIWA_WORK_SIZE], robot_memory[RBD_ACTUATORS_SIZE(N, 0, 0)];

/* Where joint i shall be; comes from elsewhere on a real robot. */
static void wanted(int i, int tick, rbd_real *q, rbd_real *v) {
    const rbd_real rate = 1 + 0.3f * (rbd_real)i, size = i % 2 ? 0.25f : -0.2f;
    const rbd_real t = (rbd_real)tick * gains[PERIOD_S];
    *q = (i % 2 ? -0.9f : 0.2f) + size * (1 - cosf(rate * t));
    *v = size * rate * sinf(rate * t);
}

/* The arm and its motors, for a tick. */
static rbd_status simulate(rbd_actuators *robot, rbd_work *w, const rbd_real *currents, rbd_real *q,
                           rbd_real *v) {
    rbd_command command[N] = {{0}};
    rbd_real tau[N], damping[N], q_next[N], v_next[N];
    rbd_status status;
    for (int i = 0; i < N; i++) command[i].torque = currents[i] * motors[i].gear * motors[i].constant;
    status = rbd_actuators_begin(robot, command, q, v, gains[PERIOD_S], 0, tau, damping);
    do {
        if (status == RBD_OK)
            status = rbd_free_step(&iiwa_model, w, q, v, tau, NULL, damping, gains[PERIOD_S], q_next, v_next);
    } while (status == RBD_OK && rbd_actuators_again(robot, v_next, tau, damping));
    for (int i = 0; i < N && status == RBD_OK; i++) {
        q[i] = q_next[i];
        v[i] = v_next[i];
    }
    return status;
}

int main(void) {
    static rbd_real q[N], v[N], in[INPUTS], integral[STATES];
    rbd_actuators *robot;
    rbd_work *w;
    rbd_status status = rbd_work_init(&iiwa_model, work_memory, sizeof work_memory, &w);
    rbd_real worst = 0;
    uint32_t controlling = 0; /* ticks of the board's timer */
    int tick = 0, bad = -1;
    for (int i = 0; i < N; i++) motors[i] = servos[i];
    if (status == RBD_OK) status = controller_start();
    if (status == RBD_OK)
        status = rbd_actuators_init(&iiwa_model, motors, N, NULL, 0, robot_memory, sizeof robot_memory,
                                    &robot, NULL);
    record.model = recorder_model(&iiwa_model);
    record.configuration = controller_configuration();
    for (int i = 0; i < N; i++) wanted(i, 0, &q[i], &v[i]);
    board_start();

    for (; tick < LAST && status == RBD_OK && bad < 0; tick++) {
        for (int i = 0; i < N; i++) {
            in[Q + i] = q[i];
            in[V + i] = v[i];
            wanted(i, tick, &in[WANTED_Q + i], &in[WANTED_V + i]);
        }
        rbd_real *currents = recorder_push(&record, in, integral);
        uint32_t start = board_now();
        status = controller_tick(w, in, integral, currents);
        controlling = cost_since(&start);
        if (tick > DRY) motors[DRY_JOINT].friction.coulomb += 0.05f;
        if (status == RBD_OK) status = simulate(robot, w, currents, q, v);
        for (int i = 0; i < N; i++) {
            const rbd_real error = fabsf(in[WANTED_Q + i] - in[Q + i]);
            if (tick < DRY) worst = largerf(worst, error);
            if (!(error < too_far)) bad = i;
        }
    }
    printf(
        "recorded servos, iiwa: error %d urad at worst, then joint %d more than %d mrad off in tick %d; the "
        "controller %lu instructions: %s\n",
        (int)(worst * 1e6f), bad + 1, (int)(too_far * 1e3f), tick,
        (unsigned long)COST_INSTRUCTIONS(controlling), rbd_status_string(status));
    recorder_dump(&record, putchar);
    return !(status == RBD_OK && worst < 0.01f && bad == DRY_JOINT && tick > DRY);
}
