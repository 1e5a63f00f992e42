/* five_bar_model.h - the built model of five_bar, for flash: include rbd.h before, pass &five_bar_model.
   Written by rbd-model from five_bar.urdf: change that instead.
       rbd-model --constraints five_bar_loop.csv --c-model five_bar five_bar.urdf
   The table lies in the file that defines RBD_IMPLEMENTATION, or FIVE_BAR_MODEL_IMPLEMENTATION, before it
   includes this; in all others this declares it. */
#ifndef FIVE_BAR_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */
#define FIVE_BAR_FEATURES 0x6fffa0u
#endif

#ifdef RBD_H
#ifndef FIVE_BAR_MODEL_H
#define FIVE_BAR_MODEL_H

#if RBD_MODEL_VERSION != 6
#error "five_bar_model.h was written for another version of rbd.h: write it again"
#elif defined RBD_FEATURES && (FIVE_BAR_FEATURES) & ~(RBD_FEATURES + 0u)
#error "RBD_FEATURES lacks some of FIVE_BAR_FEATURES"
#endif

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

/* Bytes for rbd_work_init, exactly. */
#define FIVE_BAR_WORK_SIZE RBDI_WORK_BYTES(4, 0, 0, 4, 0, 4, 6)

#define five_bar_model RBDI_TABLE_SYMBOL(five_bar_model)
RBDI_TABLE_DECLARATION(five_bar_model)

#endif

#if (defined RBD_IMPLEMENTATION || defined FIVE_BAR_MODEL_IMPLEMENTATION) && !defined FIVE_BAR_MODEL_TABLE
#define FIVE_BAR_MODEL_TABLE

/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */

/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin alpha | cos sin beta |
   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */
static RBDI_THERE const rbdi_link five_bar_links[4] = {
    {-1, 0, 0, -1, -1, 0, 2, RBDI_REVOLUTE, /* 0: left_crank */
     RBDI_ROOT | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     1, 0, 0, 0, 0, 1, 1, 0,
     {RBD_C(-0.1), 0, 0}, 0, 1, 0,
     {RBD_C(0.031245), 0, 0, RBD_C(4.999999999999796e-06), 0, 0},
     {RBD_C(0.15), 0, 0}, 0, 0},
    {0, 1, 1, -1, -1, 1, 2, RBDI_REVOLUTE, /* 1: left_rod */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.25), 0, 0}, 0, 1, 0,
     {RBD_C(0.012244999999999999), 0, 0, RBD_C(4.999999999999796e-06), 0, 0},
     {RBD_C(0.0525), 0, 0}, 0, 0},
    {-1, 2, 2, -1, -1, 2, 4, RBDI_REVOLUTE, /* 2: right_crank */
     RBDI_ROOT | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     1, 0, 0, 0, 0, 1, 1, 0,
     {RBD_C(0.1), 0, 0}, 0, 1, 0,
     {RBD_C(0.031245), 0, 0, RBD_C(4.999999999999796e-06), 0, 0},
     {RBD_C(0.15), 0, 0}, 0, 0},
    {2, 3, 3, -1, -1, 3, 4, RBDI_REVOLUTE, /* 3: right_rod */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.25), 0, 0}, 0, 1, 0,
     {RBD_C(0.012244999999999999), 0, 0, RBD_C(4.999999999999796e-06), 0, 0},
     {RBD_C(0.0525), 0, 0}, 0, 0},
};

/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |
   armature, damping, friction | inertia of what it moves */
static RBDI_THERE const rbdi_dof five_bar_dofs[4] = {
    {0, -1, 0, 0, -1, 0, 0, 0, 0, RBD_C(0.06975500247837306)},
    {1, 0, 1, 1, 0, 1, 0, 0, 0, RBD_C(0.01225000043538506)},
    {2, -1, 3, 0, -1, 0, 0, 0, 0, RBD_C(0.06975500247837306)},
    {3, 2, 4, 1, 2, 1, 0, 0, 0, RBD_C(0.01225000043538506)},
};

/* the dofs as the solver meets them: dof, its row */
static RBDI_THERE const rbdi_order five_bar_order[4] = {
    {0, 0}, {1, 1}, {2, 3}, {3, 4},
};

/* the dofs of the matrix depth first: dof, descendants, row */
static RBDI_THERE const rbdi_node five_bar_nodes[4] = {
    {0, 1, 0}, {1, 0, 1}, {2, 1, 3}, {3, 0, 4},
};

/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |
   inertia about the com | lower, upper, velocity, effort */
static RBDI_THERE const rbdi_frame five_bar_frames[4] = {
    {"left_crank", "left_motor", 0, -1, 2, 0, 1, 0, 1, /* 0 */
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     {0, 0, 0}, RBD_C(0.6), {RBD_C(0.125), 0, 0},
     {RBD_C(1e-05), 0, 0, RBD_C(0.003125), 0, RBD_C(0.003125)},
     0, 0, 20, 10},
    {"left_rod", "left_elbow", 1, 0, 2, 1, 1, 1, 1, /* 1 */
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     {0, 0, 0}, RBD_C(0.3), {RBD_C(0.175), 0, 0},
     {RBD_C(1e-05), 0, 0, RBD_C(0.0030625), 0, RBD_C(0.0030625)},
     0, 0, 20, 0},
    {"right_crank", "right_motor", 2, -1, 2, 2, 1, 2, 1, /* 2 */
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     {0, 0, 0}, RBD_C(0.6), {RBD_C(0.125), 0, 0},
     {RBD_C(1e-05), 0, 0, RBD_C(0.003125), 0, RBD_C(0.003125)},
     0, 0, 20, 10},
    {"right_rod", "right_elbow", 3, 2, 2, 3, 1, 3, 1, /* 3 */
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     {0, 0, 0}, RBD_C(0.3), {RBD_C(0.175), 0, 0},
     {RBD_C(1e-05), 0, 0, RBD_C(0.0030625), 0, RBD_C(0.0030625)},
     0, 0, 20, 0},
};

RBDI_TABLE const rbd_model five_bar_model = {
    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), 4, 4, 4, /* nb, nq, nv */
    4, 0, 0, 0, 6, 0, /* links, blocks, branch points, mimics, packed entries, those behind */
    {0, 0, RBD_C(-9.81)},
    five_bar_links, NULL, five_bar_dofs, five_bar_order, five_bar_nodes, NULL, five_bar_frames,
    FIVE_BAR_FEATURES,
    {UINT64_C(0x4000400040004), UINT64_C(0x0), UINT64_C(0x600000000)}, /* lengths of a work's arrays */
};

#endif
#elif !defined RBD_FEATURES
#error "include rbd.h before five_bar_model.h"
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
