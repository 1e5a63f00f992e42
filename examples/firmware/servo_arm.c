/* servo_arm.c - an arm whose motors have friction: gravity, inertia and friction are compensated by the table
   of its motors, in one image with the arm and the same motors, simulated. The plan alone commands, without
   feedback: what the table does not know shows. SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#define IIWA_MODEL_IMPLEMENTATION
#include "cost.h"
#include "rbd_actuator.h"
#include "models/iiwa_model.h"
#include "../larger.h"

enum { NV = IIWA_NV, TICKS = 500, MOST_INSTRUCTIONS = 2000 };
static const rbd_real period = 1e-3f;

/* In flash. Shoulder, elbow and wrist; joint 7 is weaker. */
#define MOTOR(number, torque, dry, oil) \
    {.joint = "lbr_iiwa_joint_" #number, \
     .gear = 100, \
     .constant = 0.05f, \
     .inertia = 1e-5f, \
     .resistance = 0.4f, \
     .current = torque / 5.0f, \
     .friction = {.coulomb = dry, .viscous = oil, .still = 0.001f}}
static const rbd_motor motors[NV] = {
    MOTOR(1, 200, 3, 1),    MOTOR(2, 200, 3, 1),      MOTOR(3, 150, 2, 0.8f),  MOTOR(4, 150, 2, 0.8f),
    MOTOR(5, 100, 1, 0.5f), MOTOR(6, 60, 0.8f, 0.3f), MOTOR(7, 60, 0.5f, 0.2f)};

static unsigned char work_memory[IIWA_WORK_SIZE];
static unsigned char robot_memory[RBD_ACTUATORS_SIZE(NV, 0, 0)], own_memory[RBD_ACTUATORS_SIZE(NV, 0, 0)];
static rbd_work *w;

/* A slow wave of all joints, from rest. */
static void plan(rbd_real t, rbd_real *q, rbd_real *v, rbd_real *a) {
    for (int k = 0; k < NV; k++) {
        const rbd_real rate = 2 + 0.3f * (rbd_real)k, size = k % 2 ? 0.25f : -0.2f;
        q[k] = (k % 2 ? -0.9f : 0.2f) + size * (1 - cosf(rate * t));
        v[k] = size * rate * sinf(rate * t);
        a[k] = size * rate * rate * cosf(rate * t);
    }
}

/* The motors and the arm, for a period. */
static rbd_status simulate(rbd_actuators *robot, const rbd_drive *drives, rbd_real *q, rbd_real *v) {
    rbd_command command[NV] = {{0}};
    rbd_real tau[NV], damping[NV], q_next[NV], v_next[NV];
    rbd_status status;
    for (int k = 0; k < NV; k++) command[k].torque = drives[k].current * motors[k].gear * motors[k].constant;
    status = rbd_actuators_begin(robot, command, q, v, period, 0, tau, damping);
    do {
        if (status == RBD_OK)
            status = rbd_free_step(&iiwa_model, w, q, v, tau, NULL, damping, period, q_next, v_next);
    } while (status == RBD_OK && rbd_actuators_again(robot, v_next, tau, damping));
    for (int k = 0; k < NV; k++) {
        q[k] = q_next[k];
        v[k] = v_next[k];
    }
    return status;
}

/* How far the arm is off its plan, in rad, if the controller has this table; the instructions of the inverse.
   */
static rbd_real follow(const rbd_motor *table, uint32_t *instructions) {
    static rbd_real q[NV], v[NV], q_plan[NV], v_plan[NV], acc[NV], tau[NV];
    rbd_actuators *robot, *own;
    rbd_drive drives[NV];
    rbd_real off = 0;
    rbd_status status =
        rbd_actuators_init(&iiwa_model, motors, NV, NULL, 0, robot_memory, sizeof robot_memory, &robot, NULL);
    if (status == RBD_OK)
        status =
            rbd_actuators_init(&iiwa_model, table, NV, NULL, 0, own_memory, sizeof own_memory, &own, NULL);
    plan(0, q, v, acc);
    for (int tick = 0; tick < TICKS && status == RBD_OK; tick++) {
        plan(((rbd_real)tick + 0.5f) * period, q_plan, v_plan, acc);
        rbd_rnea(&iiwa_model, w, q_plan, v_plan, acc, NULL, tau);
        uint32_t start = board_now();
        status = rbd_actuators_inverse(own, q_plan, v_plan, acc, tau, drives);
        const uint32_t took = COST_INSTRUCTIONS(cost_since(&start));
        *instructions = took > *instructions ? took : *instructions;
        if (status == RBD_OK) status = simulate(robot, drives, q, v);
        plan(((rbd_real)tick + 1) * period, q_plan, v_plan, acc);
        for (int k = 0; k < NV; k++) off = largerf(off, fabsf(q[k] - q_plan[k]));
    }
    return status == RBD_OK ? off : (rbd_real)INFINITY;
}

int main(void) {
    static rbd_motor smooth[NV]; /* a table that knows no friction */
    uint32_t inverse = 0, other = 0;
    if (rbd_work_init(&iiwa_model, work_memory, sizeof work_memory, &w) != RBD_OK) return 1;
    board_start();
    for (int k = 0; k < NV; k++) {
        smooth[k] = motors[k];
        smooth[k].friction = (rbd_gear_friction){0};
    }
    const rbd_real known = follow(motors, &inverse), unknown = follow(smooth, &other);
    printf(
        "servo arm, iiwa: currents of seven motors from torques %u instructions at worst; half a second of "
        "feed-forward ends %d urad off with friction in the table, %d without; memory %u bytes\n",
        (unsigned)inverse, (int)(known * 1e6f), (int)(unknown * 1e6f), (unsigned)sizeof own_memory);
    return !(inverse < MOST_INSTRUCTIONS && known < 0.005f && unknown > 20 * known);
}
