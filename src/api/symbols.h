#ifndef RBDI_API_SYMBOLS_H
#define RBDI_API_SYMBOLS_H
#include "api/configuration.h"

/* The symbols name the scalar and the lanes, which determine the layout of arguments, so that files which
   differ in them do not link: rbd_rnea is rbd_rnea_double, or rbd_rnea_double_8 with 8 lanes. The batch
   calls, which take ordinary arrays, do not name the lanes. The mangled names of C++ tell classes apart. */
#define RBDI_PASTE_OF(a, b) a##_##b
#define RBDI_PASTE(a, b) RBDI_PASTE_OF(a, b)
#if RBDI_REAL_KIND == 3 && RBDI_KIND(RBD_CONST) != 3
#define RBDI_OF_SCALAR(name) RBDI_PASTE(RBDI_PASTE(name, RBD_REAL), RBD_CONST)
#else
#define RBDI_OF_SCALAR(name) RBDI_PASTE(name, RBD_CONST)
#endif
#ifdef RBD_LANES
#define RBDI_SYMBOL(name) RBDI_PASTE(RBDI_OF_SCALAR(name), RBD_LANES)
#else
#define RBDI_SYMBOL(name) RBDI_OF_SCALAR(name)
#endif
#define rbd_model_build RBDI_SYMBOL(rbd_model_build)
#define rbd_model_size RBDI_SYMBOL(rbd_model_size)
#define rbd_add_payload RBDI_SYMBOL(rbd_add_payload)
#define rbd_lock_joints RBDI_SYMBOL(rbd_lock_joints)
#define rbd_work_init RBDI_SYMBOL(rbd_work_init)
#define rbd_work_size RBDI_SYMBOL(rbd_work_size)
#define rbd_set_gravity RBDI_SYMBOL(rbd_set_gravity)
#define rbd_get_gravity RBDI_SYMBOL(rbd_get_gravity)
#define rbd_singular_dof RBDI_SYMBOL(rbd_singular_dof)
#define rbd_rnea RBDI_SYMBOL(rbd_rnea)
#define rbd_bias RBDI_SYMBOL(rbd_bias)
#define rbd_gravity_torque RBDI_SYMBOL(rbd_gravity_torque)
#define rbd_generalized_momentum RBDI_SYMBOL(rbd_generalized_momentum)
#define rbd_crba RBDI_SYMBOL(rbd_crba)
#define rbd_crba_packed RBDI_SYMBOL(rbd_crba_packed)
#define rbd_packed_size RBDI_SYMBOL(rbd_packed_size)
#define rbd_packed_index RBDI_SYMBOL(rbd_packed_index)
#define rbd_aba RBDI_SYMBOL(rbd_aba)
#define rbd_hybrid RBDI_SYMBOL(rbd_hybrid)
#define rbd_fd_cholesky RBDI_SYMBOL(rbd_fd_cholesky)
#define rbd_cholesky_factor RBDI_SYMBOL(rbd_cholesky_factor)
#define rbd_cholesky_factor_packed RBDI_SYMBOL(rbd_cholesky_factor_packed)
#define rbd_cholesky_solve RBDI_SYMBOL(rbd_cholesky_solve)
#define rbd_cholesky_solve_many RBDI_SYMBOL(rbd_cholesky_solve_many)
#define rbd_minverse RBDI_SYMBOL(rbd_minverse)
#define rbd_passive RBDI_SYMBOL(rbd_passive)
#define rbd_kinematics RBDI_SYMBOL(rbd_kinematics)
#define rbd_body_kinematics RBDI_SYMBOL(rbd_body_kinematics)
#define rbd_body_pose RBDI_SYMBOL(rbd_body_pose)
#define rbd_body_velocity RBDI_SYMBOL(rbd_body_velocity)
#define rbd_body_acceleration RBDI_SYMBOL(rbd_body_acceleration)
#define rbd_body_acceleration_classical RBDI_SYMBOL(rbd_body_acceleration_classical)
#define rbd_joint_wrench RBDI_SYMBOL(rbd_joint_wrench)
#define rbd_energy RBDI_SYMBOL(rbd_energy)
#define rbd_com RBDI_SYMBOL(rbd_com)
#define rbd_mass RBDI_SYMBOL(rbd_mass)
#define rbd_jacobian RBDI_SYMBOL(rbd_jacobian)
#define rbd_relative_jacobian RBDI_SYMBOL(rbd_relative_jacobian)
#define rbd_jacobian_transpose RBDI_SYMBOL(rbd_jacobian_transpose)
#define rbd_point_position RBDI_SYMBOL(rbd_point_position)
#define rbd_point_velocity RBDI_SYMBOL(rbd_point_velocity)
#define rbd_point_acceleration RBDI_SYMBOL(rbd_point_acceleration)
#define rbd_point_wrench RBDI_SYMBOL(rbd_point_wrench)
#define rbd_momentum RBDI_SYMBOL(rbd_momentum)
#define rbd_neutral RBDI_SYMBOL(rbd_neutral)
#define rbd_integrate RBDI_SYMBOL(rbd_integrate)
#define rbd_step RBDI_SYMBOL(rbd_step)
#define rbd_difference RBDI_SYMBOL(rbd_difference)
#define rbd_interpolate RBDI_SYMBOL(rbd_interpolate)
#define rbd_distance RBDI_SYMBOL(rbd_distance)
#define rbd_random RBDI_SYMBOL(rbd_random)
#define rbd_rates_from_velocity RBDI_SYMBOL(rbd_rates_from_velocity)
#define rbd_velocity_from_rates RBDI_SYMBOL(rbd_velocity_from_rates)
#define rbd_nb RBDI_SYMBOL(rbd_nb)
#define rbd_nq RBDI_SYMBOL(rbd_nq)
#define rbd_nv RBDI_SYMBOL(rbd_nv)
#define rbd_body_index RBDI_SYMBOL(rbd_body_index)
#define rbd_joint_index RBDI_SYMBOL(rbd_joint_index)
#define rbd_body_name RBDI_SYMBOL(rbd_body_name)
#define rbd_joint_name RBDI_SYMBOL(rbd_joint_name)
#define rbd_joint RBDI_SYMBOL(rbd_joint)
#define rbd_dof_body RBDI_SYMBOL(rbd_dof_body)
#define rbd_describe RBDI_SYMBOL(rbd_describe)

#endif
