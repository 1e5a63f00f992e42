/* hyq.h - HyQ, on a floating joint: the description that rbd_model_build takes.
   Include rbd.h before. SPDX-License-Identifier: MIT.
   Written by from_facts.py from facts/hyq.csv: change those instead. Figures from
   Istituto Italiano di Tecnologia, DLS lab, hyq-description (no sensors). */
#ifndef HYQ_H
#define HYQ_H

#define HYQ_NB 13 /* bodies */
#define HYQ_NQ 19 /* length of q */
#define HYQ_NV 18 /* degrees of freedom */

/* clang-format off */
/* A row: {link, joint, parent, type,
           axis, axis2, pitch,
           position,
           rotation,
           mass, com,
           inertia,
           armature, damping, friction,
           lower, upper, velocity, effort,
           mimic, mimic_ratio, mimic_offset}, as rbd_body says. */
static const rbd_body hyq_bodies[HYQ_NB] = {
    {"base_link_0", "root", -1, RBD_FLOATING, /* body 0, parent world */
     {0, 0, 0}, {0, 0, 0}, 0,
     {0, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     60.978, {0.05606913313, 0.0214936829676, 0.0036081141592},
     {1.57276516929, 0.0284651872099, -0.203540381128, 8.50274303052, -0.00442532384229, 9.19648634293},
     {0}, {0}, {0},
     0, 0, 0, 0,
     NULL, 0, 0},
    {"lf_hipassembly", "lf_haa_joint", 0, RBD_REVOLUTE, /* body 1, parent base_link_0 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.3735, 0.207, 0},
     {0, 0, -1, 0, -1, 0, -1, 0, 0},
     2.93, {0.04263, 0, 0.16931},
     {0.05071, -4e-05, -0.00159, 0.05486, -5e-05, 0.00571},
     {0}, {0}, {0},
     -1.2217304764, 0.436332312999, 12, 150,
     NULL, 0, 0},
    {"rf_hipassembly", "rf_haa_joint", 0, RBD_REVOLUTE, /* body 2, parent base_link_0 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.3735, -0.207, 0},
     {0, 0, 1, 0, 1, 0, -1, 0, 0},
     2.93, {0.04263, 0, -0.16931},
     {0.05071, 4e-05, 0.00159, 0.05486, -5e-05, 0.00571},
     {0}, {0}, {0},
     -1.2217304764, 0.436332312999, 12, 150,
     NULL, 0, 0},
    {"lh_hipassembly", "lh_haa_joint", 0, RBD_REVOLUTE, /* body 3, parent base_link_0 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {-0.3735, 0.207, 0},
     {0, 0, -1, 0, -1, 0, -1, 0, 0},
     2.93, {0.04263, 0, -0.16931},
     {0.05071, 4e-05, 0.00159, 0.05486, -5e-05, 0.00571},
     {0}, {0}, {0},
     -1.2217304764, 0.436332312999, 12, 150,
     NULL, 0, 0},
    {"rh_hipassembly", "rh_haa_joint", 0, RBD_REVOLUTE, /* body 4, parent base_link_0 */
     {0, 0, 1}, {0, 0, 0}, 0,
     {-0.3735, -0.207, 0},
     {0, 0, 1, 0, 1, 0, -1, 0, 0},
     2.93, {0.04263, 0, 0.16931},
     {0.05071, -4e-05, -0.00159, 0.05486, -5e-05, 0.00571},
     {0}, {0}, {0},
     -1.2217304764, 0.436332312999, 12, 150,
     NULL, 0, 0},
    {"lf_upperleg", "lf_hfe_joint", 1, RBD_REVOLUTE, /* body 5, parent lf_hipassembly */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.08, 0, 0},
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     2.638, {0.15074, -0.02625, 0},
     {0.00368, -0.00302, 0.0001, 0.02719, 2e-05, 0.02811},
     {0}, {0}, {0},
     -0.872664625997, 1.2217304764, 12, 150,
     NULL, 0, 0},
    {"rf_upperleg", "rf_hfe_joint", 2, RBD_REVOLUTE, /* body 6, parent rf_hipassembly */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.08, 0, 0},
     {1, 0, 0, 0, 0, 1, 0, -1, 0},
     2.638, {0.15074, -0.02625, 0},
     {0.00368, -0.00302, 0.0001, 0.02719, 2e-05, 0.02811},
     {0}, {0}, {0},
     -0.872664625997, 1.2217304764, 12, 150,
     NULL, 0, 0},
    {"lh_upperleg", "lh_hfe_joint", 3, RBD_REVOLUTE, /* body 7, parent lh_hipassembly */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.08, 0, 0},
     {1, 0, 0, 0, 0, -1, 0, 1, 0},
     2.638, {0.15074, 0.02625, 0},
     {0.00368, 0.00302, -0.0001, 0.02719, 2e-05, 0.02811},
     {0}, {0}, {0},
     -1.2217304764, 0.872664625997, 12, 150,
     NULL, 0, 0},
    {"rh_upperleg", "rh_hfe_joint", 4, RBD_REVOLUTE, /* body 8, parent rh_hipassembly */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.08, 0, 0},
     {1, 0, 0, 0, 0, 1, 0, -1, 0},
     2.638, {0.15074, 0.02625, 0},
     {0.00368, 0.00302, -0.0001, 0.02719, 2e-05, 0.02811},
     {0}, {0}, {0},
     -1.2217304764, 0.872664625997, 12, 150,
     NULL, 0, 0},
    {"lf_lowerleg", "lf_kfe_joint", 5, RBD_REVOLUTE, /* body 9, parent lf_upperleg */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.35, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.881, {0.1254, 4e-05, -0.0001},
     {0.00047, 6e-05, -1e-05, 0.01256, 0, 0.01233},
     {0}, {0}, {0},
     -2.44346095279, -0.349065850399, 12, 150,
     NULL, 0, 0},
    {"rf_lowerleg", "rf_kfe_joint", 6, RBD_REVOLUTE, /* body 10, parent rf_upperleg */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.35, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.881, {0.1254, 4e-05, -0.0001},
     {0.00047, 6e-05, -1e-05, 0.01256, 0, 0.01233},
     {0}, {0}, {0},
     -2.44346095279, -0.349065850399, 12, 150,
     NULL, 0, 0},
    {"lh_lowerleg", "lh_kfe_joint", 7, RBD_REVOLUTE, /* body 11, parent lh_upperleg */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.35, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.881, {0.1254, -4e-05, 0.0001},
     {0.00047, -6e-05, 1e-05, 0.01256, 0, 0.01233},
     {0}, {0}, {0},
     0.349065850399, 2.44346095279, 12, 150,
     NULL, 0, 0},
    {"rh_lowerleg", "rh_kfe_joint", 8, RBD_REVOLUTE, /* body 12, parent rh_upperleg */
     {0, 0, 1}, {0, 0, 0}, 0,
     {0.35, 0, 0},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     0.881, {0.1254, -4e-05, 0.0001},
     {0.00047, -6e-05, 1e-05, 0.01256, 0, 0.01233},
     {0}, {0}, {0},
     0.349065850399, 2.44346095279, 12, 150,
     NULL, 0, 0},
};
/* clang-format on */

#endif
