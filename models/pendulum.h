/* pendulum.h - pendulum, fixed to the world: the description that rbd_model_build takes.
   Written by rbd-model from pendulum.urdf: change that instead.
       rbd-model --c pendulum pendulum.urdf
   Include rbd.h before. */
#ifndef PENDULUM_H
#define PENDULUM_H

/* clang-format off */

#define PENDULUM_NB 1 /* bodies */
#define PENDULUM_NQ 1 /* length of q */
#define PENDULUM_NV 1 /* degrees of freedom: length of v, a and tau */

#ifndef PENDULUM_INDICES /* the description and the built model have the same */
#define PENDULUM_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    PENDULUM_BODY_ROD = 0,
    PENDULUM_Q_HINGE = 0,
    PENDULUM_DOF_HINGE = 0,
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
static const rbd_body pendulum_bodies[PENDULUM_NB] = {
    {"rod", "hinge", -1, RBD_CONTINUOUS, /* body 0, parent world */
     {0, 1, 0}, {0, 0, 0}, 0,
     {0, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     1.2, {0, 0, -0.5},
     {0.1, 0, 0, 0.1, 0, 0.001},
     {0}, {0}, {0},
     0, 0, 10, 50,
     NULL, 0, 0},
};
/* clang-format on */

#endif
