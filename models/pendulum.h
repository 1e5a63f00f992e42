/* pendulum.h - a rod that swings about a fixed axis: the description that rbd_model_build takes.
   Include rbd.h before. SPDX-License-Identifier: MIT.

   At q = 0 the rod hangs straight down; q turns it about the y axis. Equation of motion, with
   mass m, distance l from the axis to the centre of mass, inertia I about the centre of mass, and
   gravity (0, 0, -g):

       (I + m l^2) a + m g l sin q = tau */
#ifndef PENDULUM_H
#define PENDULUM_H

#define PENDULUM_NB 1 /* bodies */
#define PENDULUM_NQ 1 /* length of q */
#define PENDULUM_NV 1 /* degrees of freedom */

#define PENDULUM_M 1.2 /* kg */
#define PENDULUM_L 0.5 /* m: the rod is 1 m long */
#define PENDULUM_I 0.1 /* kg m^2: of a thin rod */

/* clang-format off */
static const rbd_body pendulum_bodies[PENDULUM_NB] = {
    {"rod", "hinge", -1, RBD_CONTINUOUS,       /* link, joint, parent, type */
     {0, 1, 0}, {0, 0, 0}, 0,                  /* axis, axis2, pitch */
     {0, 0, 0},                                /* position */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},              /* rotation */
     PENDULUM_M, {0, 0, -PENDULUM_L},          /* mass, com */
     {PENDULUM_I, 0, 0, PENDULUM_I, 0, 0.001}, /* inertia */
     {0}, {0}, {0},                            /* armature, damping, friction */
     0, 0, 10, 50,                             /* lower, upper, velocity, effort */
     NULL, 0, 0},                              /* mimic, mimic_ratio, mimic_offset */
};
/* clang-format on */

#endif
