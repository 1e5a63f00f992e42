/* mpc.h - one tick of a model predictive controller on a microcontroller, and what it takes: instructions
   by part, and stack. SPDX-License-Identifier: MIT */
#ifndef MPC_H
#define MPC_H

#include <stdio.h>

#include "cost.h"
#include "examples/mpc/ilqr.h"

/* A Cortex-M7 at 480 MHz with 1.5 cycles per instruction, an estimate. */
#define MPC_INSTRUCTIONS_PER_SECOND 320000000u

enum { MPC_DYNAMICS, MPC_DERIVATIVES, MPC_RICCATI, MPC_PARTS };

typedef struct mpc_cost {    /* worst: in ticks of the board's timer; stack: bytes, painted */
    uint64_t sum[MPC_PARTS]; /* instructions */
    uint32_t worst, stack;
    int steps;
} mpc_cost;

/* The plan moves on by a fraction of a knot, starts from the measured state, and gets one iteration, that of
   ilqr_iterate with one try. */
static inline rbd_status mpc_tick(ilqr *s, rbd_real fraction, const rbd_real *q, const rbd_real *v,
                                  mpc_cost *cost) {
    uint32_t part[MPC_PARTS], start = board_now(), all = start;
    rbd_status status = ilqr_shift(s, fraction);
    if (status == RBD_OK) status = ilqr_start(s, q, v);
    part[MPC_DYNAMICS] = cost_since(&start);
    if (status == RBD_OK) status = ilqr_linearise(s);
    part[MPC_DERIVATIVES] = cost_since(&start);
    if (status == RBD_OK) status = ilqr_backward(s);
    part[MPC_RICCATI] = cost_since(&start);
    if (status == RBD_OK) ilqr_line_search(s);
    part[MPC_DYNAMICS] += cost_since(&start);
    for (int i = 0; i < MPC_PARTS; i++) cost->sum[i] += COST_INSTRUCTIONS(part[i]);
    all = cost_since(&all);
    cost->worst = all > cost->worst ? all : cost->worst;
    cost->steps++;
    return status;
}

/* Prints what a tick took. Returns whether the worst one leaves time for this rate. */
static inline int mpc_report(const char *name, const mpc_cost *cost, uint32_t rate, int knots) {
    static const char *const part[MPC_PARTS] = {"dynamics and cost", "derivatives", "Riccati step"};
    const uint32_t worst = COST_INSTRUCTIONS(cost->worst);
    uint32_t all = 0;
    printf("predictive control, %s: %d ticks of one iteration, %d knots:", name, cost->steps, knots);
    for (int i = 0; i < MPC_PARTS; i++) {
        const uint32_t mean = (uint32_t)(cost->sum[i] / (uint32_t)cost->steps);
        printf(" %s %lu,", part[i], (unsigned long)mean);
        all += mean;
    }
    printf(" together %lu instructions, %lu at worst, %lu Hz at %lu million a second; stack %lu bytes; ",
           (unsigned long)all, (unsigned long)worst, (unsigned long)(MPC_INSTRUCTIONS_PER_SECOND / worst),
           MPC_INSTRUCTIONS_PER_SECOND / 1000000ul, (unsigned long)cost->stack);
    return worst <= MPC_INSTRUCTIONS_PER_SECOND / rate;
}

#endif
