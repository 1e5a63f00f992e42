/* double_pendulum_model.h - the built model of double_pendulum, for flash: include rbd.h before, pass &double_pendulum_model.
   Written by rbd-model from double_pendulum.urdf: change that instead.
       rbd-model --c-model double_pendulum double_pendulum.urdf
   The table lies in the file that defines RBD_IMPLEMENTATION, or DOUBLE_PENDULUM_MODEL_IMPLEMENTATION, before it
   includes this; in all others this declares it. */
#ifndef DOUBLE_PENDULUM_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */
#define DOUBLE_PENDULUM_FEATURES 0x7fff20u
#endif

#ifdef RBD_H
#ifndef DOUBLE_PENDULUM_MODEL_H
#define DOUBLE_PENDULUM_MODEL_H

#if RBD_MODEL_VERSION != 6
#error "double_pendulum_model.h was written for another version of rbd.h: write it again"
#elif defined RBD_FEATURES && (DOUBLE_PENDULUM_FEATURES) & ~(RBD_FEATURES + 0u)
#error "RBD_FEATURES lacks some of DOUBLE_PENDULUM_FEATURES"
#endif

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

/* Bytes for rbd_work_init, exactly. */
#define DOUBLE_PENDULUM_WORK_SIZE RBDI_WORK_BYTES(2, 0, 0, 2, 0, 2, 3)

#define double_pendulum_model RBDI_TABLE_SYMBOL(double_pendulum_model)
RBDI_TABLE_DECLARATION(double_pendulum_model)

#endif

#if (defined RBD_IMPLEMENTATION || defined DOUBLE_PENDULUM_MODEL_IMPLEMENTATION) && !defined DOUBLE_PENDULUM_MODEL_TABLE
#define DOUBLE_PENDULUM_MODEL_TABLE

/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */

/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin alpha | cos sin beta |
   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */
static RBDI_THERE const rbdi_link double_pendulum_links[2] = {
    {-1, 0, 0, -1, -1, 0, 2, RBDI_REVOLUTE, /* 0: upper_rod */
     RBDI_ROOT | RBDI_OFF_CHAIN,
     0, 1, 1, 0, 0, -1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(1.3995), 0, 0, RBD_C(0.0005000000000000004), 0, 0},
     {RBD_C(1.6), 0, 0}, 0, 0},
    {0, 1, 1, -1, -1, 1, 2, RBDI_REVOLUTE, /* 1: lower_rod */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {1, 0, 0}, 0, 1, 0,
     {RBD_C(0.1195), 0, 0, RBD_C(0.0005000000000000004), 0, 0},
     {RBD_C(0.3), 0, 0}, 0, 0},
};

/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |
   armature, damping, friction | inertia of what it moves */
static RBDI_THERE const rbdi_dof double_pendulum_dofs[2] = {
    {0, -1, 0, 0, -1, 0, 0, 0, 0, RBD_C(2.120500075353057)},
    {1, 0, 1, 1, 0, 1, 0, 0, 0, RBD_C(0.12000000428101998)},
};

/* the dofs as the solver meets them: dof, its row */
static RBDI_THERE const rbdi_order double_pendulum_order[2] = {
    {0, 0}, {1, 1},
};

/* the dofs of the matrix depth first: dof, descendants, row */
static RBDI_THERE const rbdi_node double_pendulum_nodes[2] = {
    {0, 1, 0}, {1, 0, 1},
};

/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |
   inertia about the com | lower, upper, velocity, effort */
static RBDI_THERE const rbdi_frame double_pendulum_frames[2] = {
    {"upper_rod", "shoulder", 0, -1, 2, 0, 1, 0, 1, /* 0 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, RBD_C(1.2), {0, 0, RBD_C(-0.5)},
     {RBD_C(0.1), 0, 0, RBD_C(0.1), 0, RBD_C(0.001)},
     0, 0, 10, 50},
    {"lower_rod", "elbow", 1, 0, 2, 1, 1, 1, 1, /* 1 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, 1, {0, 0, RBD_C(-0.3)},
     {RBD_C(0.03), 0, 0, RBD_C(0.03), 0, RBD_C(0.001)},
     0, 0, 10, 50},
};

RBDI_TABLE const rbd_model double_pendulum_model = {
    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), 2, 2, 2, /* nb, nq, nv */
    2, 0, 0, 0, 3, 0, /* links, blocks, branch points, mimics, packed entries, those behind */
    {0, 0, RBD_C(-9.81)},
    double_pendulum_links, NULL, double_pendulum_dofs, double_pendulum_order, double_pendulum_nodes, NULL, double_pendulum_frames,
    DOUBLE_PENDULUM_FEATURES,
    {UINT64_C(0x2000200020002), UINT64_C(0x0), UINT64_C(0x300000000)}, /* lengths of a work's arrays */
};

#endif
#elif !defined RBD_FEATURES
#error "include rbd.h before double_pendulum_model.h"
#endif
