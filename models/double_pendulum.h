/* double_pendulum.h - double_pendulum, fixed to the world: the description that rbd_model_build takes.
   Written by rbd-model from double_pendulum.urdf: change that instead.
       rbd-model --c double_pendulum double_pendulum.urdf
   Include rbd.h before. */
#ifndef DOUBLE_PENDULUM_H
#define DOUBLE_PENDULUM_H

/* clang-format off */

#define DOUBLE_PENDULUM_NB 2 /* bodies */
#define DOUBLE_PENDULUM_NQ 2 /* length of q */
#define DOUBLE_PENDULUM_NV 2 /* degrees of freedom: length of v, a and tau */

#ifndef DOUBLE_PENDULUM_INDICES /* the description and the built model have the same */
#define DOUBLE_PENDULUM_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    DOUBLE_PENDULUM_BODY_UPPER_ROD = 0,
    DOUBLE_PENDULUM_BODY_LOWER_ROD = 1,
    DOUBLE_PENDULUM_Q_SHOULDER = 0,
    DOUBLE_PENDULUM_Q_ELBOW = 1,
    DOUBLE_PENDULUM_DOF_SHOULDER = 0,
    DOUBLE_PENDULUM_DOF_ELBOW = 1,
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
static const rbd_body double_pendulum_bodies[DOUBLE_PENDULUM_NB] = {
    {"upper_rod", "shoulder", -1, RBD_CONTINUOUS, /* body 0, parent world */
     {0, 1, 0}, {0, 0, 0}, 0,
     {0, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     1.2, {0, 0, -0.5},
     {0.1, 0, 0, 0.1, 0, 0.001},
     {0}, {0}, {0},
     0, 0, 10, 50,
     NULL, 0, 0},
    {"lower_rod", "elbow", 0, RBD_CONTINUOUS, /* body 1, parent upper_rod */
     {0, 1, 0}, {0, 0, 0}, 0,
     {0, 0, -1},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     1, {0, 0, -0.3},
     {0.03, 0, 0, 0.03, 0, 0.001},
     {0}, {0}, {0},
     0, 0, 10, 50,
     NULL, 0, 0},
};
/* clang-format on */

#endif
