/* hyq_model.h - the built model of hyq, for flash: include rbd.h before, pass &hyq_model.
   Written by rbd-model from hyq.urdf: change that instead.
       rbd-model --floating --c-model hyq hyq.urdf
   The table lies in the file that defines RBD_IMPLEMENTATION, or HYQ_MODEL_IMPLEMENTATION, before it
   includes this; in all others this declares it. */
#ifndef HYQ_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */
#define HYQ_FEATURES 0x27fffabu
#endif

#ifdef RBD_H
#ifndef HYQ_MODEL_H
#define HYQ_MODEL_H

#if RBD_MODEL_VERSION != 6
#error "hyq_model.h was written for another version of rbd.h: write it again"
#elif defined RBD_FEATURES && (HYQ_FEATURES) & ~(RBD_FEATURES + 0u)
#error "RBD_FEATURES lacks some of HYQ_FEATURES"
#endif

/* clang-format off */

#define HYQ_NB 13 /* bodies */
#define HYQ_NQ 19 /* length of q */
#define HYQ_NV 18 /* degrees of freedom: length of v, a and tau */

#ifndef HYQ_INDICES /* the description and the built model have the same */
#define HYQ_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    HYQ_BODY_BASE_LINK_0 = 0,
    HYQ_BODY_LF_HIPASSEMBLY = 1,
    HYQ_BODY_RF_HIPASSEMBLY = 2,
    HYQ_BODY_LH_HIPASSEMBLY = 3,
    HYQ_BODY_RH_HIPASSEMBLY = 4,
    HYQ_BODY_LF_UPPERLEG = 5,
    HYQ_BODY_RF_UPPERLEG = 6,
    HYQ_BODY_LH_UPPERLEG = 7,
    HYQ_BODY_RH_UPPERLEG = 8,
    HYQ_BODY_LF_LOWERLEG = 9,
    HYQ_BODY_RF_LOWERLEG = 10,
    HYQ_BODY_LH_LOWERLEG = 11,
    HYQ_BODY_RH_LOWERLEG = 12,
    HYQ_Q_ROOT_X = 0,
    HYQ_Q_ROOT_Y = 1,
    HYQ_Q_ROOT_Z = 2,
    HYQ_Q_ROOT_QX = 3,
    HYQ_Q_ROOT_QY = 4,
    HYQ_Q_ROOT_QZ = 5,
    HYQ_Q_ROOT_QW = 6,
    HYQ_Q_LF_HAA_JOINT = 7,
    HYQ_Q_RF_HAA_JOINT = 8,
    HYQ_Q_LH_HAA_JOINT = 9,
    HYQ_Q_RH_HAA_JOINT = 10,
    HYQ_Q_LF_HFE_JOINT = 11,
    HYQ_Q_RF_HFE_JOINT = 12,
    HYQ_Q_LH_HFE_JOINT = 13,
    HYQ_Q_RH_HFE_JOINT = 14,
    HYQ_Q_LF_KFE_JOINT = 15,
    HYQ_Q_RF_KFE_JOINT = 16,
    HYQ_Q_LH_KFE_JOINT = 17,
    HYQ_Q_RH_KFE_JOINT = 18,
    HYQ_DOF_ROOT_WX = 0,
    HYQ_DOF_ROOT_WY = 1,
    HYQ_DOF_ROOT_WZ = 2,
    HYQ_DOF_ROOT_VX = 3,
    HYQ_DOF_ROOT_VY = 4,
    HYQ_DOF_ROOT_VZ = 5,
    HYQ_DOF_LF_HAA_JOINT = 6,
    HYQ_DOF_RF_HAA_JOINT = 7,
    HYQ_DOF_LH_HAA_JOINT = 8,
    HYQ_DOF_RH_HAA_JOINT = 9,
    HYQ_DOF_LF_HFE_JOINT = 10,
    HYQ_DOF_RF_HFE_JOINT = 11,
    HYQ_DOF_LH_HFE_JOINT = 12,
    HYQ_DOF_RH_HFE_JOINT = 13,
    HYQ_DOF_LF_KFE_JOINT = 14,
    HYQ_DOF_RF_KFE_JOINT = 15,
    HYQ_DOF_LH_KFE_JOINT = 16,
    HYQ_DOF_RH_KFE_JOINT = 17,
};
#endif

/* Bytes for rbd_work_init, exactly. */
#define HYQ_WORK_SIZE RBDI_WORK_BYTES(13, 1, 1, 18, 0, 18, 117)

#define hyq_model RBDI_TABLE_SYMBOL(hyq_model)
RBDI_TABLE_DECLARATION(hyq_model)

#endif

#if (defined RBD_IMPLEMENTATION || defined HYQ_MODEL_IMPLEMENTATION) && !defined HYQ_MODEL_TABLE
#define HYQ_MODEL_TABLE

/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */

/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin alpha | cos sin beta |
   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */
static RBDI_THERE const rbdi_link hyq_links[13] = {
    {-1, 0, 0, 0, 0, 0, 18, RBDI_BLOCK, /* 0: base_link_0 */
     RBDI_MASS_KEPT | RBDI_ROOT | RBDI_OFF_CHAIN,
     0, 0, 0, 0, 0, 0, 0, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(10.906933697209752), RBD_C(0.04502136235994825), RBD_C(0.21587646426523668), RBD_C(2.266757564183247), RBD_C(0.009154269078503287), RBD_C(0.44030476978820265)},
     {RBD_C(3.4189836000011398), RBD_C(1.3106417999983129), RBD_C(0.2200155851996976)}, RBD_C(86.774), RBD_C(86.774)},
    {0, 7, 6, -1, -1, 6, 9, RBDI_REVOLUTE, /* 1: lf_hipassembly */
     RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, -1, 3, 0, 0, 1, 0, -1,
     {RBD_C(0.3735), RBD_C(0.207), 0}, 0, 1, 0,
     {RBD_C(0.032776338517), RBD_C(4.7048e-05), RBD_C(0.022737817929000002), RBD_C(0.002510008809999995), RBD_C(5e-05), 0},
     {RBD_C(0.4064259), RBD_C(8.81e-05), 0}, 0, 0},
    {1, 11, 10, -1, -1, 7, 9, RBDI_REVOLUTE, /* 2: lf_upperleg */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     1, 0, 0, 0, 0, 1, 1, 0,
     {RBD_C(0.08), 0, 0}, 0, 1, 0,
     {RBD_C(0.1936745805688), RBD_C(-0.00741836815), RBD_C(-0.000130835), RBD_C(0.004117746875), RBD_C(-2e-05), 0},
     {RBD_C(0.70600212), RBD_C(-0.06924749999999999), 0}, 0, 0},
    {2, 15, 14, -1, -1, 8, 9, RBDI_REVOLUTE, /* 3: lf_lowerleg */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.35), 0, 0}, 0, 1, 0,
     {RBD_C(0.02606386596), RBD_C(-5.5580904e-05), RBD_C(-1.0477400000000013e-06), RBD_C(0.00012000140960000031), RBD_C(-3.5240000000000002e-09), 0},
     {RBD_C(0.11047740000000002), RBD_C(3.524e-05), 0}, 0, 0},
    {0, 8, 7, -1, -1, 9, 12, RBDI_REVOLUTE, /* 4: rf_hipassembly */
     RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, 1, 1, 0, 0, 1, 0, 1,
     {RBD_C(0.3735), RBD_C(-0.207), 0}, 0, 1, 0,
     {RBD_C(0.032776338517), RBD_C(-4.7048e-05), RBD_C(0.022737817929000002), RBD_C(0.002510008809999995), RBD_C(-5e-05), 0},
     {RBD_C(-0.4064259), RBD_C(8.81e-05), 0}, 0, 0},
    {4, 12, 11, -1, -1, 10, 12, RBDI_REVOLUTE, /* 5: rf_upperleg */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.08), 0, 0}, 0, 1, 0,
     {RBD_C(0.1936745805688), RBD_C(-0.00741836815), RBD_C(-0.000130835), RBD_C(0.004117746875), RBD_C(-2e-05), 0},
     {RBD_C(0.70600212), RBD_C(-0.06924749999999999), 0}, 0, 0},
    {5, 16, 15, -1, -1, 11, 12, RBDI_REVOLUTE, /* 6: rf_lowerleg */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.35), 0, 0}, 0, 1, 0,
     {RBD_C(0.02606386596), RBD_C(-5.5580904e-05), RBD_C(-1.0477400000000013e-06), RBD_C(0.00012000140960000031), RBD_C(-3.5240000000000002e-09), 0},
     {RBD_C(0.11047740000000002), RBD_C(3.524e-05), 0}, 0, 0},
    {0, 9, 8, -1, -1, 12, 15, RBDI_REVOLUTE, /* 7: lh_hipassembly */
     RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, -1, 3, 0, 0, 1, 0, -1,
     {RBD_C(-0.3735), RBD_C(0.207), 0}, 0, 1, 0,
     {RBD_C(0.032776338517), RBD_C(-4.7048e-05), RBD_C(-0.022737817929000002), RBD_C(0.002510008809999995), RBD_C(5e-05), 0},
     {RBD_C(0.4064259), RBD_C(-8.81e-05), 0}, 0, 0},
    {7, 13, 12, -1, -1, 13, 15, RBDI_REVOLUTE, /* 8: lh_upperleg */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     1, 0, 0, 0, 0, 1, 1, 0,
     {RBD_C(0.08), 0, 0}, 0, 1, 0,
     {RBD_C(0.1936745805688), RBD_C(0.00741836815), RBD_C(0.000130835), RBD_C(0.004117746875), RBD_C(-2e-05), 0},
     {RBD_C(0.70600212), RBD_C(0.06924749999999999), 0}, 0, 0},
    {8, 17, 16, -1, -1, 14, 15, RBDI_REVOLUTE, /* 9: lh_lowerleg */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.35), 0, 0}, 0, 1, 0,
     {RBD_C(0.02606386596), RBD_C(5.5580904e-05), RBD_C(1.0477400000000013e-06), RBD_C(0.00012000140960000031), RBD_C(-3.5240000000000002e-09), 0},
     {RBD_C(0.11047740000000002), RBD_C(-3.524e-05), 0}, 0, 0},
    {0, 10, 9, -1, -1, 15, 18, RBDI_REVOLUTE, /* 10: rh_hipassembly */
     RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, 1, 1, 0, 0, 1, 0, 1,
     {RBD_C(-0.3735), RBD_C(-0.207), 0}, 0, 1, 0,
     {RBD_C(0.032776338517), RBD_C(4.7048e-05), RBD_C(-0.022737817929000002), RBD_C(0.002510008809999995), RBD_C(-5e-05), 0},
     {RBD_C(-0.4064259), RBD_C(-8.81e-05), 0}, 0, 0},
    {10, 14, 13, -1, -1, 16, 18, RBDI_REVOLUTE, /* 11: rh_upperleg */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.08), 0, 0}, 0, 1, 0,
     {RBD_C(0.1936745805688), RBD_C(0.00741836815), RBD_C(0.000130835), RBD_C(0.004117746875), RBD_C(-2e-05), 0},
     {RBD_C(0.70600212), RBD_C(0.06924749999999999), 0}, 0, 0},
    {11, 18, 17, -1, -1, 17, 18, RBDI_REVOLUTE, /* 12: rh_lowerleg */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.35), 0, 0}, 0, 1, 0,
     {RBD_C(0.02606386596), RBD_C(5.5580904e-05), RBD_C(1.0477400000000013e-06), RBD_C(0.00012000140960000031), RBD_C(-3.5240000000000002e-09), 0},
     {RBD_C(0.11047740000000002), RBD_C(-3.524e-05), 0}, 0, 0},
};

/* joint type, first axis, axes, identity | E */
static RBDI_THERE const rbdi_block hyq_blocks[1] = {
    {15, 0, 6, 1, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
};

/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |
   armature, damping, friction | inertia of what it moves */
static RBDI_THERE const rbdi_dof hyq_dofs[18] = {
    {0, -1, 0, 0, -1, 0, 0, 0, 0, RBD_C(22.4880826478447)},
    {0, 0, 1, 1, 0, 1, 0, 0, 0, RBD_C(22.4880826478447)},
    {0, 1, 3, 2, 1, 2, 0, 0, 0, RBD_C(22.4880826478447)},
    {0, 2, 6, 3, 2, 3, 0, 0, 0, RBD_C(86.774)},
    {0, 3, 10, 4, 3, 4, 0, 0, 0, RBD_C(86.774)},
    {0, 4, 15, 5, 4, 5, 0, 0, 0, RBD_C(86.774)},
    {1, 5, 21, 6, 5, 6, 0, 0, 0, RBD_C(0.4681910027066958)},
    {2, 5, 28, 6, 5, 6, 0, 0, 0, RBD_C(0.4681910027066958)},
    {3, 5, 35, 6, 5, 6, 0, 0, 0, RBD_C(0.4681910027066958)},
    {4, 5, 42, 6, 5, 6, 0, 0, 0, RBD_C(0.4681910027066958)},
    {5, 6, 49, 7, 6, 7, 0, 0, 0, RBD_C(0.30166042291315737)},
    {6, 7, 57, 7, 7, 7, 0, 0, 0, RBD_C(0.30166042291315737)},
    {7, 8, 65, 7, 8, 7, 0, 0, 0, RBD_C(0.30166042291315737)},
    {8, 9, 73, 7, 9, 7, 0, 0, 0, RBD_C(0.30166042291315737)},
    {9, 10, 81, 8, 10, 8, 0, 0, 0, RBD_C(0.02618386831227265)},
    {10, 11, 90, 8, 11, 8, 0, 0, 0, RBD_C(0.02618386831227265)},
    {11, 12, 99, 8, 12, 8, 0, 0, 0, RBD_C(0.02618386831227265)},
    {12, 13, 108, 8, 13, 8, 0, 0, 0, RBD_C(0.02618386831227265)},
};

/* the dofs as the solver meets them: dof, its row */
static RBDI_THERE const rbdi_order hyq_order[18] = {
    {0, 0}, {1, 1}, {2, 3}, {3, 6}, {4, 10}, {5, 15}, {6, 21}, {10, 49},
    {14, 81}, {7, 28}, {11, 57}, {15, 90}, {8, 35}, {12, 65}, {16, 99}, {9, 42},
    {13, 73}, {17, 108},
};

/* the dofs of the matrix depth first: dof, descendants, row */
static RBDI_THERE const rbdi_node hyq_nodes[18] = {
    {0, 17, 0}, {1, 16, 1}, {2, 15, 3}, {3, 14, 6}, {4, 13, 10}, {5, 12, 15},
    {6, 2, 21}, {10, 1, 49}, {14, 0, 81}, {7, 2, 28}, {11, 1, 57}, {15, 0, 90},
    {8, 2, 35}, {12, 1, 65}, {16, 0, 99}, {9, 2, 42}, {13, 1, 73}, {17, 0, 108},
   
};

/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |
   inertia about the com | lower, upper, velocity, effort */
static RBDI_THERE const rbdi_frame hyq_frames[13] = {
    {"base_link_0", "root", 0, -1, 15, 0, 7, 0, 6, /* 0 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(60.978), {RBD_C(0.05606913313), RBD_C(0.0214936829676), RBD_C(0.0036081141592)},
     {RBD_C(1.57276516929), RBD_C(0.0284651872099), RBD_C(-0.203540381128), RBD_C(8.50274303052), RBD_C(-0.00442532384229), RBD_C(9.19648634293)},
     0, 0, 0, 0},
    {"lf_hipassembly", "lf_haa_joint", 1, 0, 1, 7, 1, 6, 1, /* 1 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.93), {RBD_C(0.04263), 0, RBD_C(0.16931)},
     {RBD_C(0.05071), RBD_C(-4e-05), RBD_C(-0.00159), RBD_C(0.05486), RBD_C(-5e-05), RBD_C(0.00571)},
     RBD_C(-1.2217304764), RBD_C(0.436332312999), 12, 150},
    {"rf_hipassembly", "rf_haa_joint", 4, 0, 1, 8, 1, 7, 1, /* 2 */
     {-1, 0, 0, 0, -1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.93), {RBD_C(0.04263), 0, RBD_C(-0.16931)},
     {RBD_C(0.05071), RBD_C(4e-05), RBD_C(0.00159), RBD_C(0.05486), RBD_C(-5e-05), RBD_C(0.00571)},
     RBD_C(-1.2217304764), RBD_C(0.436332312999), 12, 150},
    {"lh_hipassembly", "lh_haa_joint", 7, 0, 1, 9, 1, 8, 1, /* 3 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.93), {RBD_C(0.04263), 0, RBD_C(-0.16931)},
     {RBD_C(0.05071), RBD_C(4e-05), RBD_C(0.00159), RBD_C(0.05486), RBD_C(-5e-05), RBD_C(0.00571)},
     RBD_C(-1.2217304764), RBD_C(0.436332312999), 12, 150},
    {"rh_hipassembly", "rh_haa_joint", 10, 0, 1, 10, 1, 9, 1, /* 4 */
     {-1, 0, 0, 0, -1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.93), {RBD_C(0.04263), 0, RBD_C(0.16931)},
     {RBD_C(0.05071), RBD_C(-4e-05), RBD_C(-0.00159), RBD_C(0.05486), RBD_C(-5e-05), RBD_C(0.00571)},
     RBD_C(-1.2217304764), RBD_C(0.436332312999), 12, 150},
    {"lf_upperleg", "lf_hfe_joint", 2, 1, 1, 11, 1, 10, 1, /* 5 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.638), {RBD_C(0.15074), RBD_C(-0.02625), 0},
     {RBD_C(0.00368), RBD_C(-0.00302), RBD_C(0.0001), RBD_C(0.02719), RBD_C(2e-05), RBD_C(0.02811)},
     RBD_C(-0.872664625997), RBD_C(1.2217304764), 12, 150},
    {"rf_upperleg", "rf_hfe_joint", 5, 2, 1, 12, 1, 11, 1, /* 6 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.638), {RBD_C(0.15074), RBD_C(-0.02625), 0},
     {RBD_C(0.00368), RBD_C(-0.00302), RBD_C(0.0001), RBD_C(0.02719), RBD_C(2e-05), RBD_C(0.02811)},
     RBD_C(-0.872664625997), RBD_C(1.2217304764), 12, 150},
    {"lh_upperleg", "lh_hfe_joint", 8, 3, 1, 13, 1, 12, 1, /* 7 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.638), {RBD_C(0.15074), RBD_C(0.02625), 0},
     {RBD_C(0.00368), RBD_C(0.00302), RBD_C(-0.0001), RBD_C(0.02719), RBD_C(2e-05), RBD_C(0.02811)},
     RBD_C(-1.2217304764), RBD_C(0.872664625997), 12, 150},
    {"rh_upperleg", "rh_hfe_joint", 11, 4, 1, 14, 1, 13, 1, /* 8 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(2.638), {RBD_C(0.15074), RBD_C(0.02625), 0},
     {RBD_C(0.00368), RBD_C(0.00302), RBD_C(-0.0001), RBD_C(0.02719), RBD_C(2e-05), RBD_C(0.02811)},
     RBD_C(-1.2217304764), RBD_C(0.872664625997), 12, 150},
    {"lf_lowerleg", "lf_kfe_joint", 3, 5, 1, 15, 1, 14, 1, /* 9 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(0.881), {RBD_C(0.1254), RBD_C(4e-05), RBD_C(-0.0001)},
     {RBD_C(0.00047), RBD_C(6e-05), RBD_C(-1e-05), RBD_C(0.01256), 0, RBD_C(0.01233)},
     RBD_C(-2.44346095279), RBD_C(-0.349065850399), 12, 150},
    {"rf_lowerleg", "rf_kfe_joint", 6, 6, 1, 16, 1, 15, 1, /* 10 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(0.881), {RBD_C(0.1254), RBD_C(4e-05), RBD_C(-0.0001)},
     {RBD_C(0.00047), RBD_C(6e-05), RBD_C(-1e-05), RBD_C(0.01256), 0, RBD_C(0.01233)},
     RBD_C(-2.44346095279), RBD_C(-0.349065850399), 12, 150},
    {"lh_lowerleg", "lh_kfe_joint", 9, 7, 1, 17, 1, 16, 1, /* 11 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(0.881), {RBD_C(0.1254), RBD_C(-4e-05), RBD_C(0.0001)},
     {RBD_C(0.00047), RBD_C(-6e-05), RBD_C(1e-05), RBD_C(0.01256), 0, RBD_C(0.01233)},
     RBD_C(0.349065850399), RBD_C(2.44346095279), 12, 150},
    {"rh_lowerleg", "rh_kfe_joint", 12, 8, 1, 18, 1, 17, 1, /* 12 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(0.881), {RBD_C(0.1254), RBD_C(-4e-05), RBD_C(0.0001)},
     {RBD_C(0.00047), RBD_C(-6e-05), RBD_C(1e-05), RBD_C(0.01256), 0, RBD_C(0.01233)},
     RBD_C(0.349065850399), RBD_C(2.44346095279), 12, 150},
};

RBDI_TABLE const rbd_model hyq_model = {
    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), 13, 19, 18, /* nb, nq, nv */
    13, 1, 1, 0, 117, 0, /* links, blocks, branch points, mimics, packed entries, those behind */
    {0, 0, RBD_C(-9.81)},
    hyq_links, hyq_blocks, hyq_dofs, hyq_order, hyq_nodes, NULL, hyq_frames,
    HYQ_FEATURES,
    {UINT64_C(0xd00130012000d), UINT64_C(0x100010000), UINT64_C(0x7500000000)}, /* lengths of a work's arrays */
};

#endif
#elif !defined RBD_FEATURES
#error "include rbd.h before hyq_model.h"
#endif
