/* ik_robots.h - arms for tests of inverse kinematics: an iiwa, and tables of a UR10e, a Panda and a hobby arm
   of five axes, from lengths and limits that their makers publish. They have no masses: inverse kinematics
   needs none. */
#ifndef TESTS_IK_ROBOTS_H
#define TESTS_IK_ROBOTS_H

#include "rbd_ik.h"

/* A revolute joint about an axis, m and rad. armature: what a last body without mass needs. */
#define ARM_JOINT(number, x, y, z, ax, ay, az, low, high) \
    {.parent = (number) - 1, \
     .type = RBD_REVOLUTE, \
     .axis = {ax, ay, az}, \
     .position = {x, y, z}, \
     .armature = {1}, \
     .lower = low, \
     .upper = high}

/* Three parallel axes, an offset wrist, two turns each way. */
static const rbd_body ur10e[6] = {
    ARM_JOINT(0, 0, 0, 0.1807, 0, 0, 1, -6.28318, 6.28318),
    ARM_JOINT(1, 0, 0.176, 0, 0, 1, 0, -6.28318, 6.28318),
    ARM_JOINT(2, 0, -0.137, 0.6127, 0, 1, 0, -3.14159, 3.14159),
    ARM_JOINT(3, 0, 0, 0.57155, 0, 1, 0, -6.28318, 6.28318),
    ARM_JOINT(4, 0, 0.13515, 0, 0, 0, 1, -6.28318, 6.28318),
    ARM_JOINT(5, 0, 0, 0.11985, 0, 1, 0, -6.28318, 6.28318),
};

/* Seven axes, elbow and wrist offset; all frames upright at q = 0. */
static const rbd_body panda[7] = {
    ARM_JOINT(0, 0, 0, 0.333, 0, 0, 1, -2.8973, 2.8973),
    ARM_JOINT(1, 0, 0, 0, 0, 1, 0, -1.7628, 1.7628),
    ARM_JOINT(2, 0, 0, 0.316, 0, 0, 1, -2.8973, 2.8973),
    ARM_JOINT(3, 0.0825, 0, 0, 0, -1, 0, -3.0718, -0.0698),
    ARM_JOINT(4, -0.0825, 0, 0.384, 0, 0, 1, -2.8973, 2.8973),
    ARM_JOINT(5, 0, 0, 0, 0, -1, 0, -0.0175, 3.7525),
    ARM_JOINT(6, 0.088, 0, 0, 0, 0, -1, -2.8973, 2.8973),
};

/* The lengths of an SO-101 without its gripper: pan, lift, elbow, flex, roll. */
static const rbd_body hobby_arm[5] = {
    ARM_JOINT(0, 0.04, 0, 0.062, 0, 0, 1, -1.92, 1.92),
    ARM_JOINT(1, 0.03, -0.018, 0.054, 0, 1, 0, -1.75, 1.75),
    ARM_JOINT(2, 0.028, 0, 0.113, 0, 1, 0, -1.69, 1.69),
    ARM_JOINT(3, 0.135, 0.005, 0, 0, 1, 0, -1.66, 1.66),
    ARM_JOINT(4, 0.061, 0.018, 0, 1, 0, 0, -2.74, 2.84),
};

/* Tools, link axes of the last body. */
static const rbd_real ur10e_tool[3] = {0, (rbd_real)0.11655, 0}, panda_tool[3] = {0, 0, (rbd_real)-0.107},
                      hobby_tool[3] = {(rbd_real)0.1, 0, 0}, iiwa_tool[3] = {0, 0, (rbd_real)0.15};

#endif
