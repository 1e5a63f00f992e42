/* five_bar.h - five_bar, fixed to the world: the description that rbd_model_build takes.
   Written by rbd-model from five_bar.urdf: change that instead.
       rbd-model --constraints five_bar_loop.csv --c five_bar five_bar.urdf
   Include rbd.h before. */
#ifndef FIVE_BAR_H
#define FIVE_BAR_H

/* clang-format off */

#define FIVE_BAR_NB 4 /* bodies */
#define FIVE_BAR_NQ 4 /* length of q */
#define FIVE_BAR_NV 4 /* degrees of freedom: length of v, a and tau */

#ifndef FIVE_BAR_INDICES /* the description and the built model have the same */
#define FIVE_BAR_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    FIVE_BAR_BODY_LEFT_CRANK = 0,
    FIVE_BAR_BODY_LEFT_ROD = 1,
    FIVE_BAR_BODY_RIGHT_CRANK = 2,
    FIVE_BAR_BODY_RIGHT_ROD = 3,
    FIVE_BAR_Q_LEFT_MOTOR = 0,
    FIVE_BAR_Q_LEFT_ELBOW = 1,
    FIVE_BAR_Q_RIGHT_MOTOR = 2,
    FIVE_BAR_Q_RIGHT_ELBOW = 3,
    FIVE_BAR_DOF_LEFT_MOTOR = 0,
    FIVE_BAR_DOF_LEFT_ELBOW = 1,
    FIVE_BAR_DOF_RIGHT_MOTOR = 2,
    FIVE_BAR_DOF_RIGHT_ELBOW = 3,
};
#endif

/* A row: {link, joint, parent, type,
           axis, axis2, pitch,
           position,
           rotation,
           mass, com,
           inertia,
           armature, damping, friction,
           lower, upper, velocity, effort,
           mimic, mimic_ratio, mimic_offset}, as rbd_body says. */
static const rbd_body five_bar_bodies[FIVE_BAR_NB] = {
    {"left_crank", "left_motor", -1, RBD_CONTINUOUS, /* body 0, parent world */
     {0, -1, 0}, {0, 0, 0}, 0,
     {-0.1, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.6, {0.125, 0, 0},
     {1e-05, 0, 0, 0.003125, 0, 0.003125},
     {0}, {0}, {0},
     0, 0, 20, 10,
     NULL, 0, 0},
    {"left_rod", "left_elbow", 0, RBD_CONTINUOUS, /* body 1, parent left_crank */
     {0, -1, 0}, {0, 0, 0}, 0,
     {0.25, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.3, {0.175, 0, 0},
     {1e-05, 0, 0, 0.0030625, 0, 0.0030625},
     {0}, {0}, {0},
     0, 0, 20, 0,
     NULL, 0, 0},
    {"right_crank", "right_motor", -1, RBD_CONTINUOUS, /* body 2, parent world */
     {0, -1, 0}, {0, 0, 0}, 0,
     {0.1, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.6, {0.125, 0, 0},
     {1e-05, 0, 0, 0.003125, 0, 0.003125},
     {0}, {0}, {0},
     0, 0, 20, 10,
     NULL, 0, 0},
    {"right_rod", "right_elbow", 2, RBD_CONTINUOUS, /* body 3, parent right_crank */
     {0, -1, 0}, {0, 0, 0}, 0,
     {0.25, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.3, {0.175, 0, 0},
     {1e-05, 0, 0, 0.0030625, 0, 0.0030625},
     {0}, {0}, {0},
     0, 0, 20, 0,
     NULL, 0, 0},
};
/* clang-format on */

#endif

#ifndef FIVE_BAR_CONSTRAINTS_H
#define FIVE_BAR_CONSTRAINTS_H
#include "rbd_constraints.h"

/* clang-format off */
/* A row: {name, body1, body2,
           rotation1, position1,
           rotation2, position2,
           axes, kp, kd}, as rbd_constraint says. */
enum { FIVE_BAR_CONSTRAINTS = 1, FIVE_BAR_ROWS = 2 };
static const rbd_constraint five_bar_constraints[] = {
    {NULL, 1, 3,
     {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.35, 0, 0}, /* left_rod */
     {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.35, 0, 0}, /* right_rod */
     {0, 0, 0, 1, 0, 1}, 400, 40},
};
/* clang-format on */

#endif
