/* pendulum_model.h - the built model of pendulum, for flash: include rbd.h before, pass &pendulum_model.
   Written by rbd-model from pendulum.urdf: change that instead.
       rbd-model --c-model pendulum pendulum.urdf
   The table lies in the file that defines RBD_IMPLEMENTATION, or PENDULUM_MODEL_IMPLEMENTATION, before it
   includes this; in all others this declares it. */
#ifndef PENDULUM_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */
#define PENDULUM_FEATURES 0x5efc20u
#endif

#ifdef RBD_H
#ifndef PENDULUM_MODEL_H
#define PENDULUM_MODEL_H

#if RBD_MODEL_VERSION != 6
#error "pendulum_model.h was written for another version of rbd.h: write it again"
#elif defined RBD_FEATURES && (PENDULUM_FEATURES) & ~(RBD_FEATURES + 0u)
#error "RBD_FEATURES lacks some of PENDULUM_FEATURES"
#endif

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

/* Bytes for rbd_work_init, exactly. */
#define PENDULUM_WORK_SIZE RBDI_WORK_BYTES(1, 0, 0, 1, 0, 1, 1)

#define pendulum_model RBDI_TABLE_SYMBOL(pendulum_model)
RBDI_TABLE_DECLARATION(pendulum_model)

#endif

#if (defined RBD_IMPLEMENTATION || defined PENDULUM_MODEL_IMPLEMENTATION) && !defined PENDULUM_MODEL_TABLE
#define PENDULUM_MODEL_TABLE

/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */

/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin alpha | cos sin beta |
   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */
static RBDI_THERE const rbdi_link pendulum_links[1] = {
    {-1, 0, 0, -1, -1, 0, 1, RBDI_REVOLUTE, /* 0: rod */
     RBDI_ROOT | RBDI_OFF_CHAIN,
     1, 0, 0, 0, 0, -1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.0005000000000000004), 0, 0, RBD_C(0.39949999999999997), 0, 0},
     {0, RBD_C(0.6), 0}, 0, 0},
};

/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |
   armature, damping, friction | inertia of what it moves */
static RBDI_THERE const rbdi_dof pendulum_dofs[1] = {
    {0, -1, 0, 0, -1, 0, 0, 0, 0, RBD_C(0.40000001422861825)},
};

/* the dofs as the solver meets them: dof, its row */
static RBDI_THERE const rbdi_order pendulum_order[1] = {
    {0, 0},
};

/* the dofs of the matrix depth first: dof, descendants, row */
static RBDI_THERE const rbdi_node pendulum_nodes[1] = {
    {0, 0, 0},
};

/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |
   inertia about the com | lower, upper, velocity, effort */
static RBDI_THERE const rbdi_frame pendulum_frames[1] = {
    {"rod", "hinge", 0, -1, 2, 0, 1, 0, 1, /* 0 */
     {1, 0, 0, 0, 0, 1, 0, -1, 0},
     {0, 0, 0}, RBD_C(1.2), {0, 0, RBD_C(-0.5)},
     {RBD_C(0.1), 0, 0, RBD_C(0.1), 0, RBD_C(0.001)},
     0, 0, 10, 50},
};

RBDI_TABLE const rbd_model pendulum_model = {
    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), 1, 1, 1, /* nb, nq, nv */
    1, 0, 0, 0, 1, 0, /* links, blocks, branch points, mimics, packed entries, those behind */
    {0, 0, RBD_C(-9.81)},
    pendulum_links, NULL, pendulum_dofs, pendulum_order, pendulum_nodes, NULL, pendulum_frames,
    PENDULUM_FEATURES,
    {UINT64_C(0x1000100010001), UINT64_C(0x0), UINT64_C(0x100000000)}, /* lengths of a work's arrays */
};

#endif
#elif !defined RBD_FEATURES
#error "include rbd.h before pendulum_model.h"
#endif
