/* cart_pole_model.h - the built model of cart_pole, for flash: include rbd.h before, pass &cart_pole_model.
   Written by rbd-model from cart_pole.urdf: change that instead.
       rbd-model --c-model cart_pole cart_pole.urdf
   The table lies in the file that defines RBD_IMPLEMENTATION, or CART_POLE_MODEL_IMPLEMENTATION, before it
   includes this; in all others this declares it. */
#ifndef CART_POLE_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */
#define CART_POLE_FEATURES 0x17bfeefu
#endif

#ifdef RBD_H
#ifndef CART_POLE_MODEL_H
#define CART_POLE_MODEL_H

#if RBD_MODEL_VERSION != 6
#error "cart_pole_model.h was written for another version of rbd.h: write it again"
#elif defined RBD_FEATURES && (CART_POLE_FEATURES) & ~(RBD_FEATURES + 0u)
#error "RBD_FEATURES lacks some of CART_POLE_FEATURES"
#endif

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

/* Bytes for rbd_work_init, exactly. */
#define CART_POLE_WORK_SIZE RBDI_WORK_BYTES(2, 0, 0, 2, 0, 2, 3)

#define cart_pole_model RBDI_TABLE_SYMBOL(cart_pole_model)
RBDI_TABLE_DECLARATION(cart_pole_model)

#endif

#if (defined RBD_IMPLEMENTATION || defined CART_POLE_MODEL_IMPLEMENTATION) && !defined CART_POLE_MODEL_TABLE
#define CART_POLE_MODEL_TABLE

/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */

/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin alpha | cos sin beta |
   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */
static RBDI_THERE const rbdi_link cart_pole_links[2] = {
    {-1, 0, 0, -1, -1, 0, 2, RBDI_SCREW, /* 0: cart */
     RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ | RBDI_SHIFT_Z | RBDI_MASS_KEPT | RBDI_ROOT | RBDI_SLIDES | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, -1, 3, 0, 0, 1, 0, 1,
     {0, 0, 0}, 0, 0, 1,
     {0, 0, 0, 0, 0, 0},
     {0, 0, 0}, RBD_C(1.7), RBD_C(1.7)},
    {0, 1, 1, -1, -1, 1, 2, RBDI_REVOLUTE, /* 1: pole */
     RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.0595), 0, 0, RBD_C(0.0005000000000000004), 0, 0},
     {RBD_C(0.15), 0, 0}, 0, 0},
};

/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |
   armature, damping, friction | inertia of what it moves */
static RBDI_THERE const rbdi_dof cart_pole_dofs[2] = {
    {0, -1, 0, 0, -1, 0, 0, 0, 0, RBD_C(1.7)},
    {1, 0, 1, 1, 0, 1, 0, 0, 0, RBD_C(0.06000000214939177)},
};

/* the dofs as the solver meets them: dof, its row */
static RBDI_THERE const rbdi_order cart_pole_order[2] = {
    {0, 0}, {1, 1},
};

/* the dofs of the matrix depth first: dof, descendants, row */
static RBDI_THERE const rbdi_node cart_pole_nodes[2] = {
    {0, 1, 0}, {1, 0, 1},
};

/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |
   inertia about the com | lower, upper, velocity, effort */
static RBDI_THERE const rbdi_frame cart_pole_frames[2] = {
    {"cart", "rail", 0, -1, 4, 0, 1, 0, 1, /* 0 */
     {0, 0, 1, 0, 1, 0, -1, 0, 0},
     {0, 0, 0}, RBD_C(1.2), {0, 0, 0},
     {RBD_C(0.002), 0, 0, RBD_C(0.005), 0, RBD_C(0.005)},
     -2, 2, 5, 100},
    {"pole", "hinge", 1, 0, 2, 1, 1, 1, 1, /* 1 */
     {0, 1, 0, 0, 0, -1, -1, 0, 0},
     {0, 0, 0}, RBD_C(0.5), {0, 0, RBD_C(-0.3)},
     {RBD_C(0.015), 0, 0, RBD_C(0.015), 0, RBD_C(0.001)},
     0, 0, 10, 50},
};

RBDI_TABLE const rbd_model cart_pole_model = {
    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), 2, 2, 2, /* nb, nq, nv */
    2, 0, 0, 0, 3, 0, /* links, blocks, branch points, mimics, packed entries, those behind */
    {0, 0, RBD_C(-9.81)},
    cart_pole_links, NULL, cart_pole_dofs, cart_pole_order, cart_pole_nodes, NULL, cart_pole_frames,
    CART_POLE_FEATURES,
    {UINT64_C(0x2000200020002), UINT64_C(0x0), UINT64_C(0x300000000)}, /* lengths of a work's arrays */
};

#endif
#elif !defined RBD_FEATURES
#error "include rbd.h before cart_pole_model.h"
#endif
