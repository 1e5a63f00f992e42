/* hyq_robot.h - HyQ in place of the real one, on a level ground with friction: heavier than the controller
   thinks, and pushed. Here the feet stand as long as they push, and land when they meet the ground, whatever
   a plan says. SPDX-License-Identifier: MIT */
#ifndef HYQ_ROBOT_H
#define HYQ_ROBOT_H

#include "hyq_feet.h"
#include "../larger.h"

static const double robot_dt = 1e-3;       /* s */
static const double ground_friction = 0.7; /* more than the plan counts on */

typedef struct robot {
    unsigned char model_memory[RBD_MODEL_SIZE(HYQ_NB)], work_memory[RBD_WORK_SIZE(HYQ_NB, NV)],
        set_memory[RBD_CONSTRAINT_SET_SIZE(NV, ROWS)];
    const rbd_model *m;
    rbd_work *w;
    double q[NQ], v[NV];
    int standing;       /* feet, bit by bit */
    double force[ROWS]; /* under the feet, 0 of those in the air; of an impact its impulse over a tick */
    double steepest;    /* the worst so far of forces, along the ground over up, but for the impacts */
} robot;

/* q: where it stands; payload: on the trunk, kg. */
static void robot_start(robot *r, const double *q, double payload) {
    rbd_body bodies[HYQ_NB];
    for (int i = 0; i < HYQ_NB; i++) check(rbd_describe(&hyq_model, i, &bodies[i]));
    bodies[HYQ_BODY_BASE_LINK_0].mass += payload;
    check(rbd_model_build(bodies, HYQ_NB, r->model_memory, sizeof r->model_memory, &r->m, NULL));
    check(rbd_work_init(r->m, r->work_memory, sizeof r->work_memory, &r->w));
    memcpy(r->q, q, sizeof r->q);
    memset(r->v, 0, sizeof r->v);
    r->standing = 15, r->steepest = 0;
}

/* out: the accelerations or, with landing, the velocities after the impact, with the feet that push: one
   that would have to pull does not stand, and the others are asked again. */
static void robot_push(robot *r, const double *tau, const double *push, int landing, double *out) {
    for (;;) {
        double lambda[ROWS];
        rbd_constraint list[FEET];
        rbd_constraint_set *c;
        int n = 0, worst = -1;
        for (int i = 0; i < FEET; i++)
            if (r->standing >> i & 1) {
                list[n] = rbd_point_contact(leg[i], toe, NULL);
                list[n++].kd = 1 / robot_dt;
            }
        check(rbd_constraint_set_init(r->m, r->w, list, n, r->set_memory, sizeof r->set_memory, &c, NULL));
        check(landing ? rbd_impact(r->m, c, r->q, r->v, 0, out, lambda)
                      : rbd_constrained_fd(r->m, c, r->q, r->v, tau, push, out, lambda));
        memset(r->force, 0, sizeof r->force);
        for (int i = 0, k = 0; i < FEET; i++) {
            if (!(r->standing >> i & 1)) continue;
            for (int j = 0; j < 3; j++) r->force[3 * i + j] = lambda[k++] / (landing ? tick : 1);
            if (r->force[3 * i + 2] < 0 && (worst < 0 || r->force[3 * i + 2] < r->force[3 * worst + 2]))
                worst = i;
        }
        if (worst < 0) break;
        r->standing &= ~(1 << worst);
    }
    for (int i = 0; i < ROWS && !landing; i += 3)
        for (int j = 0; j < 2 && r->standing >> i / 3 & 1; j++)
            r->steepest = larger(r->steepest, fabs(r->force[i + j]) / r->force[i + 2]);
}

/* Feet that have come down to the ground stand from now on. Returns whether there was one. */
static int robot_lands(robot *r) {
    const int before = r->standing;
    check(rbd_kinematics(r->m, r->w, r->q, r->v, NULL));
    for (int i = 0; i < FEET; i++) {
        double at[3], velocity[6];
        check(rbd_point_position(r->m, r->w, leg[i], toe, at));
        check(rbd_point_velocity(r->m, r->w, leg[i], toe, RBD_WORLD_AXES, velocity));
        if (at[2] <= 0 && velocity[5] < 0) r->standing |= 1 << i;
    }
    return r->standing != before;
}

/* One step with the torques u; push: wrenches on the bodies, or NULL. */
static void robot_step(robot *r, const double *u, const double *push) {
    double tau[NV], a[NV];
    torques(u, tau);
    if (robot_lands(r)) robot_push(r, NULL, NULL, 1, r->v);
    robot_push(r, tau, push, 0, a);
    check(rbd_step(r->m, r->q, r->v, a, robot_dt, r->q, r->v));
}

#endif
