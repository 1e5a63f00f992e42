/* whole_body.c - firmware and robot in the loop in one image: HyQ stands on a slippery floor and is pushed
   from the side. The firmware is rbd_tasks_acceleration, which keeps forces within friction; the robot is
   rbd_contact_step. SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#define HYQ_MODEL_IMPLEMENTATION
#include "cost.h"
#include "rbd_contact.h"
#include "rbd_tasks.h"
#include "models/hyq_model.h"
#include "../larger.h"

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, STEPS = 1000 };

/* A Cortex-M7 at 480 MHz with 1.5 cycles per instruction, an estimate. */
static const uint32_t instructions_per_second = 320000000;
static const rbd_real dt = 1e-3f, gain = 10, mu = 0.4f; /* s, 1/s, of the floor */

static unsigned char control_memory[HYQ_WORK_SIZE], robot_memory[HYQ_WORK_SIZE],
    contact_memory[RBD_CONTACT_SET_SIZE(NV, FEET, 0)], tasks_memory[RBD_TASKS_SIZE(NV, 6 + NV, FEET, 0)];
static rbd_work *w, *robot_w;
static rbd_contact_set *ground;
static rbd_real q[NQ], v[NV], home[NQ], damping[NV];

/* What the controller wants: the trunk at home, joints near home, feet that hold. */
static rbd_task wishes[2];
static rbd_task_contact feet[FEET];
static rbd_tasks problem;

static void wish(void) {
    wishes[0].kind = RBD_TASK_POSE;
    wishes[0].gain = gain;
    for (int i = 0; i < 3; i++) wishes[0].position[i] = home[i];
    wishes[1].kind = RBD_TASK_POSTURE;
    wishes[1].q = home;
    wishes[1].gain = gain;
    wishes[1].weight = 1e-3f;

    for (int i = 0; i < FEET; i++) {
        feet[i].body = HYQ_BODY_LF_LOWERLEG + i;
        feet[i].point[0] = 0.33f;
        feet[i].friction = 0.9f * mu;
        feet[i].least = 5;
        feet[i].most = 1500;
    }
    problem.task = wishes;
    problem.tasks = 2;
    problem.contact = feet;
    problem.contacts = FEET;
    problem.dt = dt;
}

static rbd_status prepare(void) {
    rbd_contact foot[FEET] = {{0}};
    rbd_real at[3];
    const rbd_real toe[3] = {0.33f, 0, 0};
    rbd_status status = rbd_work_init(&hyq_model, control_memory, sizeof control_memory, &w);
    if (status == RBD_OK) status = rbd_work_init(&hyq_model, robot_memory, sizeof robot_memory, &robot_w);
    rbd_neutral(&hyq_model, home);
    for (int i = 0; i < FEET; i++) {
        home[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7f : -0.7f;
        home[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4f : 1.4f;
        foot[i].body1 = HYQ_BODY_LF_LOWERLEG + i;
        foot[i].body2 = -1;
        foot[i].point[0] = 0.33;
        foot[i].friction = 0.4;
    }
    if (status == RBD_OK)
        status = rbd_contact_set_init(&hyq_model, robot_w, foot, FEET, NULL, 0, NULL, contact_memory,
                                      sizeof contact_memory, &ground, NULL);
    if (status == RBD_OK) status = rbd_kinematics(&hyq_model, w, home, NULL, NULL);
    rbd_point_position(&hyq_model, w, HYQ_BODY_LF_LOWERLEG, toe, at);
    home[HYQ_Q_ROOT_Z] = -at[2];
    for (int i = 0; i < NQ; i++) q[i] = home[i];
    wish();
    return status;
}

int main(void) {
    static rbd_real a[NV], tau[NV], forces[3 * FEET], wrench[6 * HYQ_NB];
    uint64_t sum[2] = {0, 0};
    uint32_t worst[3] = {0, 0, 0}, stack = 0; /* instructions: controller, robot, both; bytes */
    rbd_real aside = 0;
    int steps = 0, most_steps = 0, unsolved = 0, slips = 0;
    rbd_status status = prepare();
    board_start();

    for (int i = 0; i < STEPS && status == RBD_OK; i++) {
        rbd_tasks_result result;
        uint32_t took[3];
        wrench[4] = i >= 100 && i < 200 ? 300 : 0; /* N, to the trunk's left */

        cost_stack(0);
        uint32_t start = board_now();
        const rbd_tasks_status solved = rbd_tasks_acceleration(&hyq_model, w, &problem, q, v, tasks_memory,
                                                               sizeof tasks_memory, a, forces, tau, &result);
        took[0] = COST_INSTRUCTIONS(cost_since(&start));
        status = rbd_contact_step(&hyq_model, ground, q, v, tau, wrench, damping, dt, q, v);
        took[1] = COST_INSTRUCTIONS(cost_since(&start));
        const uint32_t used = cost_stack(1);

        problem.warm = solved >= RBD_TASKS_OK;
        unsolved += solved != RBD_TASKS_OK;
        steps += result.steps;
        most_steps = result.steps > most_steps ? result.steps : most_steps;
        took[2] = took[0] + took[1];
        stack = used > stack ? used : stack;
        for (int k = 0; k < 2; k++) sum[k] += took[k];
        for (int k = 0; k < 3; k++) worst[k] = took[k] > worst[k] ? took[k] : worst[k];
        for (int k = 0; k < FEET; k++) slips += rbd_contact_get(ground, k, NULL, NULL) == RBD_SLIPS;
        aside = largerf(aside, q[HYQ_Q_ROOT_Y]);
    }

    const int back = fabsf(q[HYQ_Q_ROOT_Y]) < 2e-3f && fabsf(q[HYQ_Q_ROOT_Z] - home[HYQ_Q_ROOT_Z]) < 2e-3f;
    printf("HyQ and its firmware: %d ticks of 1 ms: controller %lu instructions, %lu at worst, robot %lu, "
           "%lu at worst, both %lu Hz at 320 million a second; ",
           STEPS, (unsigned long)(sum[0] / STEPS), (unsigned long)worst[0], (unsigned long)(sum[1] / STEPS),
           (unsigned long)worst[1], (unsigned long)(instructions_per_second / worst[2]));
    printf(
        "tasks %u, stack %lu bytes; %d steps of the QPs, %d at most, %d unsolved; the trunk gave way by %d "
        "mm, %d times a foot slipped; stands: %s: %s\n",
        (unsigned)sizeof tasks_memory, (unsigned long)stack, steps, most_steps, unsolved, (int)(aside * 1e3f),
        slips, back ? "yes" : "no", rbd_status_string(status));
    return !(status == RBD_OK && back && unsolved == 0 && slips == 0);
}
