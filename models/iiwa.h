/* iiwa.h - iiwa, fixed to the world: the description that rbd_model_build takes.
   Written by rbd-model from iiwa.urdf: change that instead.
       rbd-model --c iiwa iiwa.urdf
   Include rbd.h before. */
#ifndef IIWA_H
#define IIWA_H

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

/* A row: {link, joint, parent, type,
           axis, axis2, pitch,
           position,
           rotation,
           mass, com,
           inertia,
           armature, damping, friction,
           lower, upper, velocity, effort,
           mimic, mimic_ratio, mimic_offset}, as rbd_body says. */
static const rbd_body iiwa_bodies[IIWA_NB] = {
    {"lbr_iiwa_link_1", "lbr_iiwa_joint_1", -1, RBD_REVOLUTE, /* body 0, parent world */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0, 0, 0.1575},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     4, {0, -0.03, 0.12},
     {0.1, 0, 0, 0.09, 0, 0.02},
     {0}, {0}, {0},
     -2.96705972839, 2.96705972839, 10, 300,
     NULL, 0, 0},
    {"lbr_iiwa_link_2", "lbr_iiwa_joint_2", 0, RBD_REVOLUTE, /* body 1, parent lbr_iiwa_link_1 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0, 0, 0.2025},
     {-1, 0, 0, 0, 0, 1, 0, 1, 0},
     4, {0.0003, 0.059, 0.042},
     {0.05, 0, 0, 0.018, 0, 0.044},
     {0}, {0}, {0},
     -2.09439510239, 2.09439510239, 10, 300,
     NULL, 0, 0},
    {"lbr_iiwa_link_3", "lbr_iiwa_joint_3", 1, RBD_REVOLUTE, /* body 2, parent lbr_iiwa_link_2 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0, 0.2045, 0},
     {-1, 0, 0, 0, 0, 1, 0, 1, 0},
     3, {0, 0.03, 0.13},
     {0.08, 0, 0, 0.075, 0, 0.01},
     {0}, {0}, {0},
     -2.96705972839, 2.96705972839, 10, 300,
     NULL, 0, 0},
    {"lbr_iiwa_link_4", "lbr_iiwa_joint_4", 2, RBD_REVOLUTE, /* body 3, parent lbr_iiwa_link_3 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0, 0, 0.2155},
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     2.7, {0, 0.067, 0.034},
     {0.03, 0, 0, 0.01, 0, 0.029},
     {0}, {0}, {0},
     -2.09439510239, 2.09439510239, 10, 300,
     NULL, 0, 0},
    {"lbr_iiwa_link_5", "lbr_iiwa_joint_5", 3, RBD_REVOLUTE, /* body 4, parent lbr_iiwa_link_4 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0, 0.1845, 0},
     {-1, 0, 0, 0, 0, 1, 0, 1, 0},
     1.7, {0.0001, 0.021, 0.076},
     {0.02, 0, 0, 0.018, 0, 0.005},
     {0}, {0}, {0},
     -2.96705972839, 2.96705972839, 10, 300,
     NULL, 0, 0},
    {"lbr_iiwa_link_6", "lbr_iiwa_joint_6", 4, RBD_REVOLUTE, /* body 5, parent lbr_iiwa_link_5 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0, 0, 0.2155},
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     1.8, {0, 0.0006, 0.0004},
     {0.005, 0, 0, 0.0036, 0, 0.0047},
     {0}, {0}, {0},
     -2.09439510239, 2.09439510239, 10, 300,
     NULL, 0, 0},
    {"lbr_iiwa_link_7", "lbr_iiwa_joint_7", 5, RBD_REVOLUTE, /* body 6, parent lbr_iiwa_link_6 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0, 0.081, 0},
     {-1, 0, 0, 0, 0, 1, 0, 1, 0},
     0.3, {0, 0, 0.02},
     {0.001, 0, 0, 0.001, 0, 0.001},
     {0}, {0}, {0},
     -3.05432619099, 3.05432619099, 10, 300,
     NULL, 0, 0},
};
/* clang-format on */

#endif
