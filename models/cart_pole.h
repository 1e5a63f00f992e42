/* cart_pole.h - a cart on rails with a pole hinged to it: the description that rbd_model_build takes.
   Include rbd.h before. SPDX-License-Identifier: MIT.

   q0 moves the cart along the x axis. At q1 = 0 the pole hangs straight down, at q1 = pi it stands;
   q1 turns it about the negative y axis, its lower end towards positive x. Equations of motion, with
   masses mc of the cart and mp of the pole, distance l from the hinge to the pole's centre of mass,
   inertia I about it, and gravity (0, 0, -g):

       (mc + mp) a0 + mp l cos(q1) a1 - mp l sin(q1) v1^2 = tau0
       mp l cos(q1) a0 + (I + mp l^2) a1 + mp g l sin q1  = tau1 */
#ifndef CART_POLE_H
#define CART_POLE_H

#define CART_POLE_NB 2 /* bodies */
#define CART_POLE_NQ 2 /* length of q */
#define CART_POLE_NV 2 /* degrees of freedom */

#define CART_POLE_MC 1.2  /* kg */
#define CART_POLE_MP 0.5  /* kg */
#define CART_POLE_L 0.3   /* m: the pole is 0.6 m long */
#define CART_POLE_I 0.015 /* kg m^2: of a thin rod */

/* clang-format off */
static const rbd_body cart_pole_bodies[CART_POLE_NB] = {
    {"cart", "rail", -1, RBD_PRISMATIC, /* link, joint, parent, type */
     {1, 0, 0}, {0, 0, 0}, 0,           /* axis, axis2, pitch */
     {0, 0, 0},                         /* position */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},       /* rotation */
     CART_POLE_MC, {0, 0, 0},           /* mass, com */
     {0.002, 0, 0, 0.005, 0, 0.005},    /* inertia */
     {0}, {0}, {0},                     /* armature, damping, friction */
     -2, 2, 5, 100,                     /* lower, upper, velocity, effort */
     NULL, 0, 0},                       /* mimic, mimic_ratio, mimic_offset */
    {"pole", "hinge", 0, RBD_CONTINUOUS,
     {0, -1, 0}, {0, 0, 0}, 0,
     {0, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     CART_POLE_MP, {0, 0, -CART_POLE_L},
     {CART_POLE_I, 0, 0, CART_POLE_I, 0, 0.001},
     {0}, {0}, {0},
     0, 0, 10, 50,
     NULL, 0, 0},
};
/* clang-format on */

#endif
