/* iiwa_model.h - the built model of iiwa, for flash: include rbd.h before, pass &iiwa_model.
   Written by rbd-model from iiwa.urdf: change that instead.
       rbd-model --c-model iiwa iiwa.urdf
   The table lies in the file that defines RBD_IMPLEMENTATION, or IIWA_MODEL_IMPLEMENTATION, before it
   includes this; in all others this declares it. */
#ifndef IIWA_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */
#define IIWA_FEATURES 0x7fffa6u
#endif

#ifdef RBD_H
#ifndef IIWA_MODEL_H
#define IIWA_MODEL_H

#if RBD_MODEL_VERSION != 6
#error "iiwa_model.h was written for another version of rbd.h: write it again"
#elif defined RBD_FEATURES && (IIWA_FEATURES) & ~(RBD_FEATURES + 0u)
#error "RBD_FEATURES lacks some of IIWA_FEATURES"
#endif

/* clang-format off */

#define IIWA_NB 7 /* bodies */
#define IIWA_NQ 7 /* length of q */
#define IIWA_NV 7 /* degrees of freedom: length of v, a and tau */

#ifndef IIWA_INDICES /* the description and the built model have the same */
#define IIWA_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    IIWA_BODY_LBR_IIWA_LINK_1 = 0,
    IIWA_BODY_LBR_IIWA_LINK_2 = 1,
    IIWA_BODY_LBR_IIWA_LINK_3 = 2,
    IIWA_BODY_LBR_IIWA_LINK_4 = 3,
    IIWA_BODY_LBR_IIWA_LINK_5 = 4,
    IIWA_BODY_LBR_IIWA_LINK_6 = 5,
    IIWA_BODY_LBR_IIWA_LINK_7 = 6,
    IIWA_Q_LBR_IIWA_JOINT_1 = 0,
    IIWA_Q_LBR_IIWA_JOINT_2 = 1,
    IIWA_Q_LBR_IIWA_JOINT_3 = 2,
    IIWA_Q_LBR_IIWA_JOINT_4 = 3,
    IIWA_Q_LBR_IIWA_JOINT_5 = 4,
    IIWA_Q_LBR_IIWA_JOINT_6 = 5,
    IIWA_Q_LBR_IIWA_JOINT_7 = 6,
    IIWA_DOF_LBR_IIWA_JOINT_1 = 0,
    IIWA_DOF_LBR_IIWA_JOINT_2 = 1,
    IIWA_DOF_LBR_IIWA_JOINT_3 = 2,
    IIWA_DOF_LBR_IIWA_JOINT_4 = 3,
    IIWA_DOF_LBR_IIWA_JOINT_5 = 4,
    IIWA_DOF_LBR_IIWA_JOINT_6 = 5,
    IIWA_DOF_LBR_IIWA_JOINT_7 = 6,
};
#endif

/* Bytes for rbd_work_init, exactly. */
#define IIWA_WORK_SIZE RBDI_WORK_BYTES(7, 0, 0, 7, 0, 7, 28)

#define iiwa_model RBDI_TABLE_SYMBOL(iiwa_model)
RBDI_TABLE_DECLARATION(iiwa_model)

#endif

#if (defined RBD_IMPLEMENTATION || defined IIWA_MODEL_IMPLEMENTATION) && !defined IIWA_MODEL_TABLE
#define IIWA_MODEL_TABLE

/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */

/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin alpha | cos sin beta |
   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */
static RBDI_THERE const rbdi_link iiwa_links[7] = {
    {-1, 0, 0, -1, -1, 0, 7, RBDI_REVOLUTE, /* 0: lbr_iiwa_link_1 */
     RBDI_SHIFT_XYZ | RBDI_ROOT | RBDI_TWIST_0 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     -1, 0, 2, 0, 1, 0, 1, 0,
     {0, 0, RBD_C(0.36)}, 0, 1, 0,
     {RBD_C(0.0049999999999999906), 0, 0, RBD_C(0.037656), RBD_C(-0.009900000000000003), 0},
     {0, RBD_C(-0.048000000000000015), 0}, 0, 0},
    {0, 1, 1, -1, -1, 1, 7, RBDI_REVOLUTE, /* 1: lbr_iiwa_link_2 */
     RBDI_TWIST_90,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.006000359999999998), RBD_C(7.079999999999999e-05), RBD_C(-5.04e-05), RBD_C(1.60669475), RBD_C(-0.009912), 0},
     {RBD_C(-0.0012), RBD_C(-3.9695), 0}, 0, 0},
    {1, 2, 2, -1, -1, 2, 7, RBDI_REVOLUTE, /* 2: lbr_iiwa_link_3 */
     RBDI_SHIFT_Z | RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, RBD_C(0.42), 1, 0,
     {RBD_C(0.0025000000000000022), 0, 0, RBD_C(0.01882120000000001), RBD_C(-0.007694999999999999), 0},
     {0, RBD_C(-0.00180000000000001), 0}, 0, 0},
    {2, 3, 3, -1, -1, 3, 7, RBDI_REVOLUTE, /* 3: lbr_iiwa_link_4 */
     RBDI_TWIST_90,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.004500000000000004), 0, 0, RBD_C(0.504482725), RBD_C(-0.006150600000000002), 0},
     {0, RBD_C(-1.46375), 0}, 0, 0},
    {3, 4, 4, -1, -1, 4, 7, RBDI_REVOLUTE, /* 4: lbr_iiwa_link_5 */
     RBDI_SHIFT_Z | RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, RBD_C(0.4), 1, 0,
     {RBD_C(0.0015000169999999978), RBD_C(3.5700000000000005e-06), RBD_C(-2.3715000000000006e-05), RBD_C(0.006199987999999999), RBD_C(-0.004980150000000001), 0},
     {RBD_C(0.00017), RBD_C(0.034980000000000004), 0}, 0, 0},
    {4, 5, 5, -1, -1, 5, 7, RBDI_REVOLUTE, /* 5: lbr_iiwa_link_6 */
     RBDI_TWIST_90,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.0016499999999999996), 0, 0, RBD_C(0.006610947999999999), RBD_C(-4.32e-07), 0},
     {0, RBD_C(-0.03138), 0}, 0, 0},
    {5, 6, 6, -1, -1, 6, 7, RBDI_REVOLUTE, /* 6: lbr_iiwa_link_7 */
     RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.0005), 0, 0, RBD_C(0.0005), 0, 0},
     {0, 0, 0}, 0, 0},
};

/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |
   armature, damping, friction | inertia of what it moves */
static RBDI_THERE const rbdi_dof iiwa_dofs[7] = {
    {0, -1, 0, 0, -1, 0, 0, 0, 0, RBD_C(4.94870369856475)},
    {1, 0, 1, 1, 0, 1, 0, 0, 0, RBD_C(4.906047384232507)},
    {2, 1, 3, 2, 1, 2, 0, 0, 0, RBD_C(1.035037900681548)},
    {3, 2, 6, 3, 2, 3, 0, 0, 0, RBD_C(1.0137165833254782)},
    {4, 3, 10, 4, 3, 4, 0, 0, 0, RBD_C(0.018929275825431267)},
    {5, 4, 15, 5, 4, 5, 0, 0, 0, RBD_C(0.01122924913958662)},
    {6, 5, 21, 6, 5, 6, 0, 0, 0, RBD_C(0.0010000004762590322)},
};

/* the dofs as the solver meets them: dof, its row */
static RBDI_THERE const rbdi_order iiwa_order[7] = {
    {0, 0}, {1, 1}, {2, 3}, {3, 6}, {4, 10}, {5, 15}, {6, 21},
};

/* the dofs of the matrix depth first: dof, descendants, row */
static RBDI_THERE const rbdi_node iiwa_nodes[7] = {
    {0, 6, 0}, {1, 5, 1}, {2, 4, 3}, {3, 3, 6}, {4, 2, 10}, {5, 1, 15},
    {6, 0, 21},
};

/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |
   inertia about the com | lower, upper, velocity, effort */
static RBDI_THERE const rbdi_frame iiwa_frames[7] = {
    {"lbr_iiwa_link_1", "lbr_iiwa_joint_1", 0, -1, 1, 0, 1, 0, 1, /* 0 */
     {-1, 0, 0, 0, -1, 0, 0, 0, 1},
     {0, 0, RBD_C(-0.2025)}, 4, {0, RBD_C(-0.03), RBD_C(0.12)},
     {RBD_C(0.1), 0, 0, RBD_C(0.09), 0, RBD_C(0.02)},
     RBD_C(-2.96705972839), RBD_C(2.96705972839), 10, 300},
    {"lbr_iiwa_link_2", "lbr_iiwa_joint_2", 1, 0, 1, 1, 1, 1, 1, /* 1 */
     {-1, 0, 0, 0, -1, 0, 0, 0, 1},
     {0, 0, 0}, 4, {RBD_C(0.0003), RBD_C(0.059), RBD_C(0.042)},
     {RBD_C(0.05), 0, 0, RBD_C(0.018), 0, RBD_C(0.044)},
     RBD_C(-2.09439510239), RBD_C(2.09439510239), 10, 300},
    {"lbr_iiwa_link_3", "lbr_iiwa_joint_3", 2, 1, 1, 2, 1, 2, 1, /* 2 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, RBD_C(-0.2155)}, 3, {0, RBD_C(0.03), RBD_C(0.13)},
     {RBD_C(0.08), 0, 0, RBD_C(0.075), 0, RBD_C(0.01)},
     RBD_C(-2.96705972839), RBD_C(2.96705972839), 10, 300},
    {"lbr_iiwa_link_4", "lbr_iiwa_joint_4", 3, 2, 1, 3, 1, 3, 1, /* 3 */
     {-1, 0, 0, 0, -1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.7), {0, RBD_C(0.067), RBD_C(0.034)},
     {RBD_C(0.03), 0, 0, RBD_C(0.01), 0, RBD_C(0.029)},
     RBD_C(-2.09439510239), RBD_C(2.09439510239), 10, 300},
    {"lbr_iiwa_link_5", "lbr_iiwa_joint_5", 4, 3, 1, 4, 1, 4, 1, /* 4 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, RBD_C(-0.2155)}, RBD_C(1.7), {RBD_C(0.0001), RBD_C(0.021), RBD_C(0.076)},
     {RBD_C(0.02), 0, 0, RBD_C(0.018), 0, RBD_C(0.005)},
     RBD_C(-2.96705972839), RBD_C(2.96705972839), 10, 300},
    {"lbr_iiwa_link_6", "lbr_iiwa_joint_6", 5, 4, 1, 5, 1, 5, 1, /* 5 */
     {-1, 0, 0, 0, -1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(1.8), {0, RBD_C(0.0006), RBD_C(0.0004)},
     {RBD_C(0.005), 0, 0, RBD_C(0.0036), 0, RBD_C(0.0047)},
     RBD_C(-2.09439510239), RBD_C(2.09439510239), 10, 300},
    {"lbr_iiwa_link_7", "lbr_iiwa_joint_7", 6, 5, 1, 6, 1, 6, 1, /* 6 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, RBD_C(0.081)}, RBD_C(0.3), {0, 0, RBD_C(0.02)},
     {RBD_C(0.001), 0, 0, RBD_C(0.001), 0, RBD_C(0.001)},
     RBD_C(-3.05432619099), RBD_C(3.05432619099), 10, 300},
};

RBDI_TABLE const rbd_model iiwa_model = {
    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), 7, 7, 7, /* nb, nq, nv */
    7, 0, 0, 0, 28, 0, /* links, blocks, branch points, mimics, packed entries, those behind */
    {0, 0, RBD_C(-9.81)},
    iiwa_links, NULL, iiwa_dofs, iiwa_order, iiwa_nodes, NULL, iiwa_frames,
    IIWA_FEATURES,
    {UINT64_C(0x7000700070007), UINT64_C(0x0), UINT64_C(0x1c00000000)}, /* lengths of a work's arrays */
};

#endif
#elif !defined RBD_FEATURES
#error "include rbd.h before iiwa_model.h"
#endif
