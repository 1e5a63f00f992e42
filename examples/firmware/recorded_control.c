/* recorded_control.c - an iiwa whose controller keeps its last two seconds. The encoder of joint 4 has a
   loose plug. When a torque passes its limit, the controller stops and dumps what it kept.
   SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "recorded_controller.h"
#include "control.h"
#include "cost.h"
#include "../larger.h"

#ifndef RECORDED_TICKS
#define RECORDED_TICKS 500
#endif
enum { STEPS = 4000 / PERIOD_US };                  /* of the simulated robot in a tick */
enum { LOOSE_JOINT = 3, LOOSE = 800, LAST = 2000 }; /* the tick when its plug comes loose; the last one */

static const rbd_real torque_limit = 80; /* N m */

static rbd_real ring[RECORDER_SIZE(INPUTS, STATES, OUTPUTS, RECORDED_TICKS)];
static recorder record = {
    .ring = ring, .inputs = INPUTS, .states = STATES, .outputs = OUTPUTS, .ticks = RECORDED_TICKS};

/* Between -1 and 1: xorshift (Marsaglia 2003). */
static rbd_real noise(void) {
    static uint32_t x = 2463534242u;
    x ^= x << 13, x ^= x >> 17, x ^= x << 5;
    return (rbd_real)(int32_t)x * (1 / 2147483648.0f);
}

/* Where joint i shall be; comes from elsewhere on a real robot. */
static void wanted(int i, int tick, rbd_real *q, rbd_real *v) {
    const rbd_real size = 0.4f, rate = 1 + 0.2f * (rbd_real)i, t = (rbd_real)tick * gains[PERIOD_S];
    *q = size * sinf(rate * t);
    *v = size * rate * cosf(rate * t);
}

/* Encoders with noise. Of the loose one every eighth reading is wrong, each time by more. */
static void measure(int tick, const rbd_real *q, const rbd_real *v, rbd_real *in) {
    for (int i = 0; i < N; i++) {
        in[Q + i] = q[i] + 2e-4f * noise();
        in[V + i] = v[i] + 5e-3f * noise();
        wanted(i, tick, &in[WANTED_Q + i], &in[WANTED_V + i]);
    }
    if (tick > LOOSE && tick % 8 == 0) in[Q + LOOSE_JOINT] += 0.02f * (rbd_real)((tick - LOOSE) / 8);
}

/* The first joint whose torque is too large or not a number, else -1. */
static int beyond(const rbd_real *tau) {
    for (int i = 0; i < N; i++)
        if (!(fabsf(tau[i]) < torque_limit)) return i;
    return -1;
}

int main(void) {
    static unsigned char memory[IIWA_WORK_SIZE];
    static rbd_real q[N], v[N], in[INPUTS], integral[STATES], scratch[N];
    rbd_work *w;
    rbd_status status = rbd_work_init(&iiwa_model, memory, sizeof memory, &w);
    rbd_real worst = 0;
    uint32_t pushing = 0, controlling = 0; /* ticks of the board's timer */
    int tick = 0, bad = -1;
    record.model = recorder_model(&iiwa_model);
    record.configuration = controller_configuration();
    for (int i = 0; i < N; i++) wanted(i, 0, &q[i], &v[i]);
    board_start();
    for (; tick < LAST && status == RBD_OK; tick++) {
        measure(tick, q, v, in);
        uint32_t start = board_now();
        rbd_real *tau = recorder_push(&record, in, integral);
        pushing = cost_since(&start);
        status = controller_tick(w, in, integral, tau);
        controlling = cost_since(&start);
        bad = beyond(tau);
        if (bad >= 0) break;
        for (int i = 0; i < STEPS && status == RBD_OK; i++)
            status = simulate(&iiwa_model, w, q, v, tau, NULL, scratch);
        for (int i = 0; i < N && tick < LOOSE; i++)
            worst = largerf(worst, fabsf(in[WANTED_Q + i] - in[Q + i]));
    }
    printf("recorded control, iiwa: error %d urad at worst, then joint %d beyond %d N m in tick %d; a push "
           "takes "
           "%lu, the controller %lu instructions, the ring %u bytes: %s\n",
           (int)(worst * 1e6f), bad + 1, (int)torque_limit, tick, (unsigned long)COST_INSTRUCTIONS(pushing),
           (unsigned long)COST_INSTRUCTIONS(controlling), (unsigned)sizeof ring, rbd_status_string(status));
    recorder_dump(&record, putchar);
    return !(status == RBD_OK && worst < 0.02f && bad >= 0 && tick > LOOSE);
}
