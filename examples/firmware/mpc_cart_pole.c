/* mpc_cart_pole.c - model predictive control at 1 kHz: a cart swings up the pole that hangs from it, with
   a motor too weak to push it up at once, planning 0.8 s ahead in each millisecond. SPDX-License-
   Identifier: MIT */
#include <math.h>
#include <stdio.h>

#define ILQR_NV 2
#define ILQR_NU 1
#define SWING_UP_KNOTS 20
#define CART_POLE_MODEL_IMPLEMENTATION
#include "control.h"
#include "mpc.h"
#include "examples/mpc/swing_up.h"
#include "../larger.h"

enum { NQ = CART_POLE_NQ, NV = SWING_UP_NV, NU = SWING_UP_NU, N = SWING_UP_N, RATE = 1000, STEPS = 4500 };

static unsigned char work_memory[CART_POLE_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(CART_POLE_NB, NV)];
static rbd_real reals[ILQR_REALS(NQ, NV, NU, N)], dt[N];
static swing_up problem;
static const ilqr_problem p = {.m = &cart_pole_model,
                               .knots = N,
                               .nu = NU,
                               .dt = dt,
                               .lower = &swing_up_least,
                               .upper = &swing_up_most,
                               .user = &problem,
                               .step = swing_up_step,
                               .derivatives = swing_up_derivatives,
                               .cost = swing_up_cost};
static ilqr s;

static rbd_status prepare(const rbd_real *q, const rbd_real *v) {
    problem.p = &p;
    for (int k = 0; k < N; k++) dt[k] = 0.04f;
    rbd_status status = rbd_work_init(&cart_pole_model, work_memory, sizeof work_memory, &problem.w);
    if (status == RBD_OK)
        status = rbd_derivatives_init(&cart_pole_model, problem.w, memory, sizeof memory, &problem.d);
    if (status == RBD_OK) status = ilqr_init(&s, &p, reals, sizeof reals / sizeof *reals);
    s.rollouts = 2;
    return status == RBD_OK ? ilqr_start(&s, q, v) : status;
}

int main(void) {
    static rbd_real q[NQ], v[NV], tau[NV], scratch[NV];
    static mpc_cost cost;
    rbd_real most = 0, away = 0;
    rbd_status status = prepare(q, v);
    board_start();
    for (int i = 0; i < STEPS && status == RBD_OK; i++) {
        cost_stack(0);
        status = mpc_tick(&s, 1 / (RATE * dt[0]), q, v, &cost);
        const uint32_t stack = cost_stack(1);
        cost.stack = stack > cost.stack ? stack : cost.stack;
        tau[0] = s.u[0];
        most = largerf(most, fabsf(tau[0]));
        if (status == RBD_OK) status = simulate(&cart_pole_model, problem.w, q, v, tau, NULL, scratch);
        away = largerf(fabsf(q[0]), fabsf(q[1] - swing_up_angle));
    }
    const int in_time = mpc_report("cart and pole", &cost, RATE, N);
    printf("in the end %d um or urad away from upright, %d mN at most: %s\n", (int)(away * 1e6f),
           (int)(most * 1e3f), rbd_status_string(status));
    return !(in_time && status == RBD_OK && most <= swing_up_most && away < 0.02f);
}
