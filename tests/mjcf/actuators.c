/* actuators.c - motors of rbd_actuator.h beside MuJoCo's, on actuators.xml: a position actuator with kp, kd
   and gear, and the joint's armature, damping and frictionloss. SPDX-License-Identifier: MIT

   Where both have the same model they agree to rounding: a drive of speeds, viscous and dry friction of a
   wheel that turns. They differ, and are compared as dt gets smaller:

   - MuJoCo's integrator "implicit" has the actuator's kd and the damping at the step's end, kp at its
     beginning; rbd has both at the end, and is stable for every kp. The difference is of first order in dt.
   - MuJoCo's frictionloss is a soft constraint: what it holds creeps under a load; rbd's by 1e-9 rad/s.
   - MuJoCo's gains are at the actuator, which turns gear times the joint; rbd's at the joint: gear^2 of them.

   usage: actuators actuators.xml */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>

#include "../larger.h"
#include "rbd_actuator.h"
#include "rbd_contact.h"

enum { N = 3, WHEEL = 2 };

static const rbd_body bodies[N] = {{.name = "upper",
                                    .joint = "shoulder",
                                    .parent = -1,
                                    .type = RBD_REVOLUTE,
                                    .axis = {0, 1, 0},
                                    .mass = 3,
                                    .com = {0.02, 0, -0.2},
                                    .inertia = {0.05, 0, 0, 0.04, 0, 0.01}},
                                   {.name = "lower",
                                    .joint = "elbow",
                                    .parent = 0,
                                    .type = RBD_REVOLUTE,
                                    .axis = {0, 1, 0},
                                    .position = {0, 0, -0.4},
                                    .mass = 1,
                                    .com = {0, 0, -0.15},
                                    .inertia = {0.01, 0, 0, 0.012, 0, 0.002}},
                                   {.name = "wheel",
                                    .joint = "axle",
                                    .parent = -1,
                                    .type = RBD_REVOLUTE,
                                    .axis = {0, 0, 1},
                                    .position = {0, 1, 0},
                                    .mass = 1,
                                    .inertia = {0.1, 0, 0, 0.1, 0, 0.1}}};

/* Each motor has the gear of its actuator, and the rotor that makes the joint's armature. */
static const rbd_motor motors[N] = {
    {.joint = "shoulder", .gear = 5, .constant = 1, .inertia = 0.04 / 25, .friction = {.viscous = 0.3}},
    {.joint = "elbow", .gear = -3, .constant = 1, .inertia = 0.01 / 9, .friction = {.viscous = 0.2}},
    {.joint = "axle",
     .gear = 4,
     .constant = 1,
     .inertia = 0.05 / 16,
     .friction = {.viscous = 0.1, .coulomb = 0.4}}};
static const double kp[N] = {8, 6, 0}, kd[N] = {0.3, 0.2, 0.05}, feed[N] = {0, 0, 1};

static unsigned char model_memory[40000], work_memory[40000], set_memory[100000],
    memory[RBD_ACTUATORS_SIZE(N, 0, 0)];
static const rbd_model *m;
static rbd_work *w;
static rbd_contact_set *set;
static rbd_actuators *a;
static int failures;

static void expect(int holds, const char *what, double x, double y) {
    printf("%s: %g, %g%s\n", what, x, y, holds ? "" : ": FAILED");
    failures += !holds;
}

static void build(void) {
    const rbd_contact_options options = {.first_order = 1};
    if (rbd_model_build(bodies, N, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK ||
        rbd_contact_set_init(m, w, NULL, 0, NULL, 0, &options, set_memory, sizeof set_memory, &set, NULL) !=
            RBD_OK ||
        rbd_actuators_init(m, motors, N, NULL, 0, memory, sizeof memory, &a, NULL) != RBD_OK)
        exit(2);
}

/* One step of rbd under MuJoCo's controls. */
static void step(const double *control, double dt, double *q, double *v) {
    rbd_command command[N];
    double tau[N], damping[N], q_next[N], v_next[N];
    memset(command, 0, sizeof command);
    for (int i = 0; i < N; i++) {
        const double gear = (double)motors[i].gear;
        command[i].kp = gear * gear * kp[i];
        command[i].kd = gear * gear * kd[i];
        command[i].q = control[i] / gear;
        command[i].torque = gear * feed[i] * control[i];
    }
    if (rbd_actuators_begin(a, command, q, v, dt, 1, tau, damping) != RBD_OK) exit(2);
    do {
        if (rbd_contact_step(m, set, q, v, tau, NULL, damping, dt, q_next, v_next) != RBD_OK) exit(2);
    } while (rbd_actuators_again(a, v_next, tau, damping));
    memcpy(q, q_next, sizeof q_next);
    memcpy(v, v_next, sizeof v_next);
}

/* Both from the same state. */
typedef struct pair {
    mjModel *model;
    mjData *data;
    double q[N], v[N], control[N];
} pair;

static void start(pair *p, double dt, const double *q, const double *v) {
    p->model->opt.timestep = dt;
    mj_resetData(p->model, p->data);
    memset(p->control, 0, sizeof p->control);
    for (int i = 0; i < N; i++) {
        p->q[i] = p->data->qpos[i] = q[i];
        p->v[i] = p->data->qvel[i] = v[i];
    }
    rbd_actuators_reset(a, p->q, 25);
}

static void both(pair *p) {
    for (int i = 0; i < N; i++) p->data->ctrl[i] = p->control[i];
    mj_step(p->model, p->data);
    step(p->control, p->model->opt.timestep, p->q, p->v);
}

/* A drive of speeds turns the wheel one way and back; then dry friction stops it, and holds half of its
   level. */
static void check_wheel(pair *p) {
    const double q[N] = {0}, v[N] = {0, 0, 5};
    double off = 0;
    int turns = 0;
    start(p, 1e-3, q, v);
    for (int k = 0; k < 2000; k++) {
        p->control[WHEEL] = 1.5 * sin(4e-3 * k);
        both(p);
        if (fabs(p->v[WHEEL]) < 0.2 || p->v[WHEEL] < 0) break; /* until friction turns around */
        off = larger(off, fabs(p->v[WHEEL] - p->data->qvel[WHEEL]));
        turns++;
    }
    expect(off < 1e-9 && turns > 500, "a wheel that turns, rad/s and steps", off, turns);

    start(p, 1e-3, q, v);
    for (int k = 0; k < 3000; k++) {
        p->control[WHEEL] = 0.05; /* 0.2 N m */
        both(p);
    }
    const double held = p->q[WHEEL], mujoco_held = p->data->qpos[WHEEL];
    expect(fabs(held - mujoco_held) < 0.02, "stopped by friction, rad", held, mujoco_held);
    for (int k = 0; k < 3000; k++) both(p);
    expect(fabs(p->q[WHEEL] - held) < 1e-8, "creep in three seconds, rad", p->q[WHEEL] - held,
           p->data->qpos[WHEEL] - mujoco_held);
}

/* How far the positions of an arm under position control are apart, in a second of steps dt. */
static double apart(pair *p, double dt) {
    const double q[N] = {0.3, -0.5, 0}, v[N] = {1, -1, 0};
    double off = 0;
    start(p, dt, q, v);
    for (int k = 0; k * dt < 1; k++) {
        p->control[0] = 5 * (0.3 + 0.4 * sin(6 * k * dt));
        p->control[1] = -3 * (-0.5 + 0.5 * sin(9 * k * dt));
        both(p);
        for (int i = 0; i < WHEEL; i++) off = larger(off, fabs(p->q[i] - p->data->qpos[i]));
    }
    return off;
}

int main(int count, char **arguments) {
    char error[500];
    pair p;
    memset(&p, 0, sizeof p);
    p.model = count == 2 ? mj_loadXML(arguments[1], NULL, error, sizeof error) : NULL;
    if (!p.model) return 2;
    p.model->opt.integrator = mjINT_IMPLICIT;
    p.model->opt.tolerance = 0;
    p.model->opt.iterations = 100;
    p.data = mj_makeData(p.model);
    build();

    check_wheel(&p);
    const double coarse = apart(&p, 1e-3), fine = apart(&p, 2.5e-4);
    expect(coarse < 0.01 && fine < 0.3 * coarse, "an arm under position control, rad at 1 and 0.25 ms",
           coarse, fine);

    mj_deleteData(p.data);
    mj_deleteModel(p.model);
    printf("%s\n", failures ? "FAILED" : "motors beside MuJoCo: ok");
    return failures > 0;
}
