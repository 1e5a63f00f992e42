/* cart_pole.h - cart_pole, fixed to the world: the description that rbd_model_build takes.
   Written by rbd-model from cart_pole.urdf: change that instead.
       rbd-model --c cart_pole cart_pole.urdf
   Include rbd.h before. */
#ifndef CART_POLE_H
#define CART_POLE_H

/* clang-format off */

#define CART_POLE_NB 2 /* bodies */
#define CART_POLE_NQ 2 /* length of q */
#define CART_POLE_NV 2 /* degrees of freedom: length of v, a and tau */

#ifndef CART_POLE_INDICES /* the description and the built model have the same */
#define CART_POLE_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    CART_POLE_BODY_CART = 0,
    CART_POLE_BODY_POLE = 1,
    CART_POLE_Q_RAIL = 0,
    CART_POLE_Q_HINGE = 1,
    CART_POLE_DOF_RAIL = 0,
    CART_POLE_DOF_HINGE = 1,
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
static const rbd_body cart_pole_bodies[CART_POLE_NB] = {
    {"cart", "rail", -1, RBD_PRISMATIC, /* body 0, parent world */
     {1, 0, 0}, {0, 0, 0}, 0,
     {0, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     1.2, {0, 0, 0},
     {0.002, 0, 0, 0.005, 0, 0.005},
     {0}, {0}, {0},
     -2, 2, 5, 100,
     NULL, 0, 0},
    {"pole", "hinge", 0, RBD_CONTINUOUS, /* body 1, parent cart */
     {0, -1, 0}, {0, 0, 0}, 0,
     {0, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.5, {0, 0, -0.3},
     {0.015, 0, 0, 0.015, 0, 0.001},
     {0}, {0}, {0},
     0, 0, 10, 50,
     NULL, 0, 0},
};
/* clang-format on */

#endif
