/* five_bar.c - a five-bar mechanism on a microcontroller: two motors lead the tip of a closed loop along a
   circle by computed torque and rbd_constrained_id. Model and loop are tables in flash.
   SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "control.h"
#include "cost.h"
#define FIVE_BAR_MODEL_IMPLEMENTATION
#include "models/five_bar_model.h"
#include "../larger.h"

enum { NV = FIVE_BAR_NV, STEPS = 2000000 / PERIOD_US }; /* two seconds: one round */

static const rbd_real ground = 0.2f, crank = 0.25f, rod = 0.35f, radius = 0.05f, pi = 3.14159265f; /* m */

static unsigned char work_memory[FIVE_BAR_WORK_SIZE], loop_memory[RBD_CONSTRAINT_SET_SIZE(NV, FIVE_BAR_ROWS)];
static rbd_work *w;
static rbd_constraint_set *loop;

/* Accelerations of the joints with which the tip has x, z, and each side by itself: two equations each. */
static void follow(const rbd_real *q, const rbd_real *v, rbd_real x, rbd_real z, rbd_real *a) {
    for (int side = 0; side < NV; side += 2) {
        const rbd_real first = q[side], both = first + q[side + 1], ca = crank * cosf(first),
                       sa = crank * sinf(first), cb = rod * cosf(both), sb = rod * sinf(both);
        const rbd_real wa = v[side], wb = wa + v[side + 1];
        const rbd_real ex = x + wa * wa * ca + wb * wb * cb, ez = z + wa * wa * sa + wb * wb * sb;
        const rbd_real D = sa * cb - ca * sb;
        a[side] = -(cb * ex + sb * ez) / D;
        a[side + 1] = (ca * ex + sa * ez) / D - a[side];
    }
}

/* The tip and its velocity, by the left side. */
static void tip(const rbd_real *q, const rbd_real *v, rbd_real at[2], rbd_real moves[2]) {
    const rbd_real a = q[0], b = q[0] + q[1], wb = v[0] + v[1];
    at[0] = -ground / 2 + crank * cosf(a) + rod * cosf(b);
    at[1] = crank * sinf(a) + rod * sinf(b);
    moves[0] = -crank * sinf(a) * v[0] - rod * sinf(b) * wb;
    moves[1] = crank * cosf(a) * v[0] + rod * cosf(b) * wb;
}

/* Torques of both motors at time t; off: by how much the tip is away from where it shall be, m. */
static rbd_status control(rbd_real t, const rbd_real *q, const rbd_real *v, rbd_real *tau, rbd_real *off) {
    static const unsigned char motors[NV] = {1, 0, 1, 0};
    const rbd_real s = sinf(pi * t), c = cosf(pi * t), speed = pi * radius, turn = pi * speed;
    const rbd_real x = radius * s, z = 0.45f - radius * c;
    rbd_real at[2], moves[2], a[NV];
    tip(q, v, at, moves);
    *off = hypotf(at[0] - x, at[1] - z);
    follow(q, v, -turn * s + 20 * (speed * c - moves[0]) + 100 * (x - at[0]),
           turn * c + 20 * (speed * s - moves[1]) + 100 * (z - at[1]), a);
    return rbd_constrained_id(&five_bar_model, loop, q, v, a, NULL, motors, NULL, tau, NULL);
}

/* The mechanism, in place of encoders and motors. */
static rbd_status move(rbd_real *q, rbd_real *v, const rbd_real *tau) {
    rbd_real a[NV];
    const rbd_status status = rbd_constrained_fd(&five_bar_model, loop, q, v, tau, NULL, a, NULL);
    for (int i = 0; i < NV; i++) v[i] += PERIOD * a[i];
    return status == RBD_OK ? rbd_integrate(&five_bar_model, q, v, PERIOD, q) : status;
}

int main(void) {
    static const rbd_real guess[NV] = {2.2f, -1.2f, 0.9f, 1.2f};
    rbd_real q[NV], v[NV] = {0}, tau[NV], e[FIVE_BAR_ROWS], open = 0, passive = 0, late_off = 0, off = 0;
    uint32_t torques = 0, motion = 0;
    int late = 0;
    rbd_status status = rbd_work_init(&five_bar_model, work_memory, sizeof work_memory, &w);
    if (status == RBD_OK)
        status = rbd_constraint_set_init(&five_bar_model, w, five_bar_constraints, FIVE_BAR_CONSTRAINTS,
                                         loop_memory, sizeof loop_memory, &loop, NULL);
    if (status == RBD_OK) status = rbd_assemble(&five_bar_model, loop, guess, NULL, NULL, q, NULL);
    cost_stack(0);
    if (status == RBD_OK) status = control(0, q, v, tau, &off);
    if (status == RBD_OK) status = rbd_constrained_fd(&five_bar_model, loop, q, v, tau, NULL, tau, NULL);
    const uint32_t stack = cost_stack(1);
    board_start();
    uint32_t start = board_now();
    for (int step = 0; step < STEPS && status == RBD_OK; step++) {
        uint32_t part = board_now(), ticks;
        status = control((rbd_real)step * PERIOD, q, v, tau, &off);
        ticks = cost_since(&part), torques = ticks > torques ? ticks : torques;
        passive = largerf(passive, largerf(fabsf(tau[1]), fabsf(tau[3])));
        tau[1] = tau[3] = 0;
        part = board_now();
        if (status == RBD_OK) status = move(q, v, tau);
        ticks = cost_since(&part), motion = ticks > motion ? ticks : motion;
        if (status == RBD_OK) status = rbd_constraint_jacobian(&five_bar_model, loop, q, v, NULL, NULL, e);
        open = largerf(open, hypotf(e[0], e[1]));
        if (step >= STEPS / 2) late_off = largerf(late_off, off);
        late += !board_wait(&start, BOARD_TICKS(PERIOD_US));
    }
    printf(
        "five-bar: %d periods of %d us, %d late; torques %lu instructions at worst, the mechanism %lu; stack "
        "%lu bytes, loop %u, work %u; it opens by %d um, the tip is off by %d um, %d uN m are missing: %s\n",
        STEPS, PERIOD_US, late, (unsigned long)COST_INSTRUCTIONS(torques),
        (unsigned long)COST_INSTRUCTIONS(motion), (unsigned long)stack, (unsigned)sizeof loop_memory,
        (unsigned)sizeof work_memory, (int)(open * 1e6f), (int)(late_off * 1e6f), (int)(passive * 1e6f),
        rbd_status_string(status));
    return !(status == RBD_OK && late == 0 && open < 2e-4f && late_off < 2e-3f && passive < 1e-3f);
}
