/* mpc_iiwa.c - model predictive control of an arm: the hand of an iiwa catches up with a target that goes
   round in a circle, and follows it, planning 0.4 s ahead 125 times a second. SPDX-License-
   Identifier: MIT */
#include <math.h>
#include <stdio.h>

#define ILQR_NV 7
#define ILQR_NU 7
#define REACH_KNOTS 20
#define IIWA_MODEL_IMPLEMENTATION
#include "control.h"
#include "mpc.h"
#include "examples/mpc/reach.h"
#include "../larger.h"

enum { NV = REACH_NV, N = REACH_N, RATE = 125, STEPS = 2 * RATE, PERIODS = 1000000 / PERIOD_US / RATE };

static unsigned char work_memory[IIWA_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(IIWA_NB, NV)];
static rbd_real reals[ILQR_REALS(NV, NV, NV, N)], dt[N];
static reach problem;
static const ilqr_problem p = {.m = &iiwa_model,
                               .knots = N,
                               .nu = NV,
                               .dt = dt,
                               .lower = reach_least,
                               .upper = reach_limit,
                               .user = &problem,
                               .step = reach_step,
                               .derivatives = reach_derivatives,
                               .cost = reach_cost};
static ilqr s;

static rbd_status prepare(const rbd_real *q, const rbd_real *v) {
    problem.p = &p, problem.dt = 0.02f;
    for (int k = 0; k < N; k++) dt[k] = problem.dt;
    rbd_status status = rbd_work_init(&iiwa_model, work_memory, sizeof work_memory, &problem.w);
    if (status == RBD_OK)
        status = rbd_derivatives_init(&iiwa_model, problem.w, memory, sizeof memory, &problem.d);
    if (status == RBD_OK) status = ilqr_init(&s, &p, reals, sizeof reals / sizeof *reals);
    s.rollouts = 2;
    if (status == RBD_OK) status = reach_aim(&problem, 0, q);
    for (int k = 0; k < N; k++)
        memcpy(s.u + k * NV, problem.hold, sizeof problem.hold); /* first guess: stay */
    return status == RBD_OK ? ilqr_start(&s, q, v) : status;
}

static rbd_real distance(rbd_real time, const rbd_real *q) {
    rbd_real target[3], hand[3], sum = 0;
    reach_target(time, target);
    rbd_kinematics(&iiwa_model, problem.w, q, NULL, NULL);
    rbd_point_position(&iiwa_model, problem.w, IIWA_BODY_LBR_IIWA_LINK_7, reach_hand, hand);
    for (int i = 0; i < 3; i++) sum += (hand[i] - target[i]) * (hand[i] - target[i]);
    return sqrtf(sum);
}

int main(void) {
    static rbd_real q[NV] = {1.5f, 0.2f, 0, -1.8f, 0, 0.6f, 0}, v[NV], scratch[NV];
    static mpc_cost cost;
    rbd_real beyond = 0, away = 0;
    rbd_status status = prepare(q, v);
    board_start();
    for (int i = 0; i < STEPS && status == RBD_OK; i++) {
        const rbd_real time = (rbd_real)i / RATE;
        cost_stack(0);
        status = reach_aim(&problem, time, q);
        if (status == RBD_OK) status = mpc_tick(&s, 1 / (RATE * problem.dt), q, v, &cost);
        const uint32_t stack = cost_stack(1);
        cost.stack = stack > cost.stack ? stack : cost.stack;
        for (int j = 0; j < NV; j++) beyond = largerf(beyond, fabsf(s.u[j]) - reach_limit[j]);
        if (i >= RATE) away = largerf(away, distance(time, q));
        for (int j = 0; j < PERIODS && status == RBD_OK; j++)
            status = simulate(&iiwa_model, problem.w, q, v, s.u, NULL, scratch);
    }
    const int in_time = mpc_report("iiwa", &cost, RATE, N);
    printf("after a second within %d um of the target; limits held: %s: %s\n", (int)(away * 1e6f),
           beyond <= 0 ? "yes" : "no", rbd_status_string(status));
    return !(in_time && status == RBD_OK && beyond <= 0 && away < 0.01f);
}
