/* double_pendulum.h - two rods in a row: the description that rbd_model_build takes.
   Include rbd.h before. SPDX-License-Identifier: MIT.

   At q = 0 both rods hang straight down; q0 turns the upper one about the y axis, q1 the lower one
   relative to the upper. Equations of motion, with masses m1, m2, distances r1, r2 from each rod's
   joint to its centre of mass, inertias I1, I2 about the centres of mass, length l1 of the upper rod,
   and gravity (0, 0, -g):

       M a + c + g = tau

       M = [ A + 2 B cos q1    D + B cos q1 ]      A = I1 + m1 r1^2 + I2 + m2 (l1^2 + r2^2)
           [ D + B cos q1      D            ]      B = m2 l1 r2
                                                   D = I2 + m2 r2^2
       c = [ -B sin q1 (2 v0 v1 + v1^2) ]
           [  B sin q1 v0^2             ]

       g = [ (m1 r1 + m2 l1) g sin q0 + m2 r2 g sin(q0 + q1) ]
           [                            m2 r2 g sin(q0 + q1) ] */
#ifndef DOUBLE_PENDULUM_H
#define DOUBLE_PENDULUM_H

#define DOUBLE_PENDULUM_NB 2 /* bodies */
#define DOUBLE_PENDULUM_NQ 2 /* length of q */
#define DOUBLE_PENDULUM_NV 2 /* degrees of freedom */

#define DOUBLE_PENDULUM_M1 1.2 /* kg */
#define DOUBLE_PENDULUM_R1 0.5 /* m */
#define DOUBLE_PENDULUM_I1 0.1 /* kg m^2: of a thin rod */
#define DOUBLE_PENDULUM_L1 1.0 /* m */
#define DOUBLE_PENDULUM_M2 1.0
#define DOUBLE_PENDULUM_R2 0.3
#define DOUBLE_PENDULUM_I2 0.03

/* clang-format off */
static const rbd_body double_pendulum_bodies[DOUBLE_PENDULUM_NB] = {
    {"upper_rod", "shoulder", -1, RBD_CONTINUOUS,              /* link, joint, parent, type */
     {0, 1, 0}, {0, 0, 0}, 0,                                  /* axis, axis2, pitch */
     {0, 0, 0},                                                /* position */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},                              /* rotation */
     DOUBLE_PENDULUM_M1, {0, 0, -DOUBLE_PENDULUM_R1},          /* mass, com */
     {DOUBLE_PENDULUM_I1, 0, 0, DOUBLE_PENDULUM_I1, 0, 0.001}, /* inertia */
     {0}, {0}, {0},                                            /* armature, damping, friction */
     0, 0, 10, 50,                                             /* lower, upper, velocity, effort */
     NULL, 0, 0},                                              /* mimic, mimic_ratio, mimic_offset */
    {"lower_rod", "elbow", 0, RBD_CONTINUOUS,
     {0, 1, 0}, {0, 0, 0}, 0,
     {0, 0, -DOUBLE_PENDULUM_L1},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     DOUBLE_PENDULUM_M2, {0, 0, -DOUBLE_PENDULUM_R2},
     {DOUBLE_PENDULUM_I2, 0, 0, DOUBLE_PENDULUM_I2, 0, 0.001},
     {0}, {0}, {0},
     0, 0, 10, 50,
     NULL, 0, 0},
};
/* clang-format on */

#endif
