/* standing.c - firmware and robot in the loop in one image: HyQ stands on four feet and is pushed from the
   side. The robot is rbd_contact_step, so its feet may slip and lift; the controller has the motors alone.
   SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#define HYQ_MODEL_IMPLEMENTATION
#include "cost.h"
#include "rbd_contact.h"
#include "models/hyq_model.h"
#include "../larger.h"

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, LEG = HYQ_DOF_LF_HAA_JOINT, LEGS = NV - LEG, STEPS = 1200 };

/* A Cortex-M7 at 480 MHz with 1.5 cycles per instruction, an estimate. */
static const uint32_t instructions_per_second = 320000000;
static const rbd_real dt = 1e-3f, kp = 1000, kd = 30; /* s, N m/rad, N m s/rad */
static const rbd_real stance[LEGS] = {0,     0,     0,     0,     0.7f, 0.7f,
                                      -0.7f, -0.7f, -1.4f, -1.4f, 1.4f, 1.4f}; /* rad */
static const rbd_real toe[3] = {0.33f, 0, 0};

static unsigned char control_memory[HYQ_WORK_SIZE], robot_memory[HYQ_WORK_SIZE],
    contact_memory[RBD_CONTACT_SET_SIZE(NV, FEET, 0)];
static rbd_work *w, *robot_w;
static rbd_contact_set *ground;
static rbd_real q[NQ], v[NV], damping[NV];

static rbd_status prepare(void) {
    rbd_contact foot[FEET];
    rbd_real at[3];
    rbd_status status = rbd_work_init(&hyq_model, control_memory, sizeof control_memory, &w);
    if (status == RBD_OK) status = rbd_work_init(&hyq_model, robot_memory, sizeof robot_memory, &robot_w);
    for (int i = 0; i < FEET; i++)
        foot[i] =
            (rbd_contact){.body1 = HYQ_BODY_LF_LOWERLEG + i, .body2 = -1, .point = {0.33}, .friction = 0.7};
    if (status == RBD_OK)
        status = rbd_contact_set_init(&hyq_model, robot_w, foot, FEET, NULL, 0, NULL, contact_memory,
                                      sizeof contact_memory, &ground, NULL);
    for (int k = LEG; k < NV; k++) damping[k] = kd + dt * kp / 2; /* implicit */
    rbd_neutral(&hyq_model, q);
    for (int k = 0; k < LEGS; k++) q[HYQ_Q_LF_HAA_JOINT + k] = stance[k];
    if (status == RBD_OK) status = rbd_kinematics(&hyq_model, w, q, NULL, NULL);
    rbd_point_position(&hyq_model, w, HYQ_BODY_LF_LOWERLEG, toe, at);
    q[HYQ_Q_ROOT_Z] = -at[2];
    return status;
}

/* Torques: springs to the stance, and what holds the weight if each foot carries a quarter of it. The dampers
   of the motors' drives are the robot's, in damping. */
static rbd_status control(rbd_real *tau) {
    const rbd_real push[6] = {0, 0, 0, 0, 0, -9.81f / FEET * rbd_mass(&hyq_model)};
    rbd_real share[NV];
    rbd_status status = rbd_kinematics(&hyq_model, w, q, NULL, NULL);
    for (int k = LEG; k < NV; k++) tau[k] = kp * (stance[k - LEG] - q[k + NQ - NV]);
    for (int i = 0; i < FEET && status == RBD_OK; i++) {
        status =
            rbd_jacobian_transpose(&hyq_model, w, HYQ_BODY_LF_LOWERLEG + i, toe, RBD_WORLD_AXES, push, share);
        for (int k = LEG; k < NV; k++) tau[k] += share[k];
    }
    return status;
}

int main(void) {
    static rbd_real tau[NV], wrench[6 * HYQ_NB];
    static uint32_t took[2]; /* ticks of the board's timer: controller, robot */
    uint64_t sum[2] = {0, 0};
    uint32_t worst = 0, stack = 0;
    rbd_real residual = 0, away = 0, force = 0;
    int fewest = FEET;
    rbd_status status = prepare();
    board_start();
    for (int i = 0; i < STEPS && status == RBD_OK; i++) {
        int standing = 0;
        wrench[4] = i >= 300 && i < 400 ? 500 : 0; /* N, to the trunk's left */
        cost_stack(0);
        uint32_t start = board_now(), all = start;
        status = control(tau);
        took[0] = cost_since(&start);
        if (status == RBD_OK)
            status = rbd_contact_step(&hyq_model, ground, q, v, tau, wrench, damping, dt, q, v);
        took[1] = cost_since(&start);
        all = cost_since(&all);
        const uint32_t used = cost_stack(1);
        stack = used > stack ? used : stack;
        worst = all > worst ? all : worst;
        for (int k = 0; k < 2; k++) sum[k] += COST_INSTRUCTIONS(took[k]);
        residual = largerf(residual, rbd_contact_last(ground).residual);
        force = 0;
        for (int k = 0; k < FEET; k++) {
            rbd_real f[3];
            standing += rbd_contact_get(ground, k, NULL, f) >= RBD_STICKS;
            force += f[2];
        }
        fewest = i > 100 && standing < fewest ? standing : fewest;
        away = largerf(away, fabsf(q[HYQ_Q_ROOT_Y]));
    }
    const uint32_t controller = (uint32_t)(sum[0] / STEPS), robot = (uint32_t)(sum[1] / STEPS);
    const int stands = q[HYQ_Q_ROOT_Z] > 0.5f && fabsf(q[HYQ_Q_ROOT_Y]) < 0.03f &&
                       fabsf(force - 9.81f * rbd_mass(&hyq_model)) < 10;
    const uint32_t most = COST_INSTRUCTIONS(worst), rate = instructions_per_second / most;
    printf("HyQ and its firmware: %d ticks of 1 ms: controller %lu, robot %lu instructions, %lu at worst, "
           "%lu Hz at 320 million a second; set %u, stack %lu bytes; ",
           STEPS, (unsigned long)controller, (unsigned long)robot, (unsigned long)most, (unsigned long)rate,
           (unsigned)sizeof contact_memory, (unsigned long)stack);
    printf("pushed away by %d mm, %d feet on the ground at least, residual %d um/s; stands: %s: %s\n",
           (int)(away * 1e3f), fewest, (int)(residual * 1e6f), stands ? "yes" : "no",
           rbd_status_string(status));
    return !(status == RBD_OK && stands && residual < 1e-3f);
}
