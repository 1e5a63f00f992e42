/* rbd.h - rigid-body dynamics of robots, in one C99 header. Version 0.4.0.
   Made by src/amalgamate.py from src/rbd.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end.

   Inverse dynamics (RNEA), mass matrix (CRBA) and forward dynamics (ABA, or Cholesky) of any
   tree of bodies, without allocation, dependency, global or NaN. In ONE file of the program:

       #define RBD_IMPLEMENTATION
       #include "rbd.h"

   and plain #include "rbd.h" everywhere else. Quick start, a pendulum:

       static const rbd_body bodies[1] = {{.name = "rod", .joint = "hinge", .parent = -1,
           .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, -0.5},
           .inertia = {1. / 12, 0, 0, 1. / 12, 0, 0}}};
       unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)];
       const rbd_model *m; rbd_work *w;
       rbd_model_build(bodies, 1, model_memory, sizeof model_memory, &m, NULL);
       rbd_work_init(m, work_memory, sizeof work_memory, &w);
       double q[1] = {0.5}, v[1] = {0}, tau[1] = {0}, a[1];
       rbd_aba(m, w, q, v, tau, NULL, a);          // a[0] = -1.5 g sin(q)

   CONTENTS (search for the tag)
     [conventions] [configuration] [GPU] [guarantees] [limits]
     [types] [status] [build] [work] [dynamics] [kinematics] [points] [manifold] [lookup]
     --- stop here if you only use it ---
     [layout]
     [design] [compiler] [tolerances] [scalar] [reduction] [spatial algebra] [pieces] [common] [features]
     [joint types] [joints] [joint limits] [state] [rnea] [crba] [aba] [packed matrix] [pivots] [hybrid]
     [forward dynamics code] [axes] [kinematics code] [points code] [manifold code] [straight moves]
     [free step] [work code] [lookup code] [text code]
     [descriptions] [model build]
     [licence]

   [conventions]
     units             SI: m, kg, s, rad, N, N m
     spatial vectors   Featherstone's: angular first; motion (omega; v), force (moment; force)
     frames            a body's quantities are in its own link frame (the user's, as in a URDF),
                       at that frame's origin
     order of q, v     the order of the bodies in the description
     matrices          row-major
     gravity           a vector in the world frame, (0, 0, -9.81) unless rbd_set_gravity is called
     f_ext             nb x 6: the wrench (moment; force) acting ON each body, in its axes, at its
                       origin; NULL = none
     joint             q                             v
     revolute          angle                         its rate
     continuous        angle, unbounded              its rate
     continuous_cs     (cos, sin)                    rate of the angle
     prismatic         length                        its rate
     helical           angle; length = pitch angle   its rate
     cylindrical       (angle, length)               their rates
     universal         2 angles: axis, then axis2    their rates
     spherical         (qx, qy, qz, qw)              omega, body axes
     euler_zyx etc.    3 angles in the order named   their rates
     planar            (x, y, angle)                 (omega, vx, vy), body axes
     translation       (x, y, z)                     their rates, joint axes
     floating          (x, y, z, qx, qy, qz, qw)     (omega; v), body axes
     Quaternions turn body vectors into the joint frame. They need not be of unit length (only
     their direction counts); one shorter than 1e-15 is read as the identity.
     a = dv/dt component by component (floating: the spatial acceleration in body axes).

   [configuration] Define before including; the same in every file that includes. Files that differ in the
   scalar do not link: the symbols carry it (rbd_rnea is rbd_rnea_double to the linker), and with GCC on ELF
   systems (Linux, firmware) the linker compares all files that include this header: see RBD_CHECK_SCALAR.
     RBD_REAL         scalar of states and results, one of these words: double (default), float,
                      __float128
     RBD_LANES n      the scalar becomes a GCC/Clang vector of n RBD_REAL: one call, n states
     RBD_REAL_CUSTOM  RBD_REAL is a C++ class with + - * / unary -, < and a constructor from
                      RBD_CONST; sin, cos, sqrt are found by argument-dependent lookup
     RBD_MASK         the result type of < of such a class, if not bool (for a class that records): with ! | &
                      and a conversion to int, whether any holds; select(mask, a, b) is found like sin
     RBD_CONST        scalar of the model's constants; default: RBD_REAL, double for a class
     RBD_SIN(x) RBD_COS(x)   replace rbd's own sine and cosine (scalar builds)
     RBD_SQRT(x)      replaces libm's square root
     RBD_STATIC       every function is static. Under nvcc, clang for CUDA and hipcc it is code of the GPU as
                      well (__host__ __device__), for kernels of yours in that file: see [GPU]
     RBD_CHECK_SCALAR 1: the linker compares RBD_REAL, RBD_CONST, RBD_LANES and RBD_REPRODUCIBLE of this file
                      with those of all other files that have 1; costs nothing at run time and no memory.
                      Default: 1 with GCC on ELF systems, 0 with RBD_STATIC, a class, or another compiler. Say
                      0 in a file whose scalar differs on purpose; 1 with clang, where it does no link-time
                      optimisation
     RBD_BATCH_IMPLEMENTATION   with RBD_LANES: this file implements the calls of rbd_batch.h
     RBD_FEATURES     the features of the program's robots, in the file with RBD_IMPLEMENTATION: the
                      ..._FEATURES of their tables, with | between. The compiler leaves out all other code,
                      which halves the flash. rbd_work_init refuses other models: RBD_ERR_LEFT_OUT. Included
                      before rbd.h, a table defines its features only, after it the rest:
                          #define RBD_IMPLEMENTATION
                          #define RBD_FEATURES ARM_FEATURES
                          #include "arm_model.h"
                          #include "rbd.h"
                          #include "arm_model.h"
     RBD_REPRODUCIBLE the same bits on every machine: see [guarantees]. From the include to the end of the
                      file no product and sum are contracted to FMA, nor are those of your own code
     RBD_NO_BUILD     leaves out rbd_model_build and the other calls on descriptions (add_payload, describe):
                      models come from generated tables only. Constraints are set up in RBD_CONST instead of
                      double. The file compiles in less time
     RBD_NO_CHOLESKY  leaves out cholesky_..., minverse, fd_cholesky, hybrid, id_free_base and fd_derivatives.
                      rbd_aba, which uses the factor for models with mimic joints, then takes less flash:
                      rbd_work_init refuses such models, RBD_ERR_LEFT_OUT
                      The linker leaves out all other calls that are not used: compile with
                      -ffunction-sections, link with --gc-sections

   [GPU] Kernels call rbd, one state a thread, whose memory is an array of the kernel's:

       #define RBD_REAL float
       #define RBD_STATIC
       #define RBD_IMPLEMENTATION
       #include "rbd.h"

       __global__ void torques(int n, const rbd_model *m, const float *q, float *tau) { // of gravity, n arms
           const int i = blockIdx.x * blockDim.x + threadIdx.x;
           unsigned char memory[RBD_WORK_SIZE(7, 7)];
           rbd_work *w;
           if (i >= n || rbd_work_init(m, memory, sizeof memory, &w) != RBD_OK) return;
           rbd_gravity_torque(m, w, q + 7 * i, tau + 7 * i);
       }

     The model is a table, which host and GPU both have (&arm_model), or rbd_model_build made it in memory
     that both see: RBD_MODEL_SIZE(nb) bytes of cudaMallocManaged. Names in such a model are the host's alone.
     rbd_derivatives.h, rbd_constraints.h, rbd_contact.h, rbd_ik.h, rbd_actuator.h, rbd_tasks.h and rbd_qp.h
     are called in the same way; rbd_batch.h is for lanes of a CPU. Compile without --use_fast_math, which
     nvcc does not tell.

   [guarantees]
     No allocation, recursion, VLA, global, stdio, locale or errno. Reentrant: calls change the caller's
     rbd_work and outputs only. Only rbd_add_payload writes to the model, which may be const data in flash.
     Finite input gives finite output, as long as nothing overflows: a singular system is an error that names
     the degree of freedom. Each call decides by its own pivots whether a system is singular. All refuse one
     whose M is singular but for rounding. Near one they may differ: the armature that makes such a joint
     sound is for rbd_aba up to 70 times that of the calls by the factor, or any part of it; where rbd_aba
     computes and they refuse, M has lost its digits, as of float chains of 100 rods. Calls with constraints
     may find there that rounding keeps them from holding their rows: RBD_ERR_INFEASIBLE.
     Input is not searched for NaN: one that reaches the mass matrix is RBD_ERR_NAN in forward dynamics, one
     in q or a gap in rbd_contact_step; any other reaches all results that depend on it, with RBD_OK. From
     libm only sqrt; sin and cos for __float128 and classes, and with excess precision (x87). The same input
     gives the same bits on every call of one build; between builds, contraction to FMA and the order of sums
     change last bits.
     With RBD_REPRODUCIBLE every call gives the same bits in double, and in float, on every machine that
     rounds to nearest as IEEE 754 does and keeps denormals, whatever the compiler, its -O and its SIMD unit.
     Sums have one order, and sine is rbd's own. Compile without -ffast-math and its parts, and with clang
     without -ffp-contract=fast; sqrt must round correctly, as rbd_work_init checks; a 32-bit x86 needs
     SSE2 (x87 does not compile).

   [limits]
     Contacts and closed loops are in rbd_constraints.h. No flexible bodies, no integrator beyond one
     step on the configuration manifold (stages of Runge-Kutta need a correction there to keep an
     order above 2: examples/integrator.c). Damping and friction are described but no algorithm
     applies them by itself: see rbd_passive. Joint limits are kept for the user, not enforced.
*/

#ifndef RBD_H
#define RBD_H

/* ==== src/api/configuration.h ==== */
#ifndef RBDI_API_CONFIGURATION_H
#define RBDI_API_CONFIGURATION_H
#ifdef RBD_BATCH_IMPLEMENTATION /* all but the calls of rbd_batch.h is static: another file implements it */
#define RBD_IMPLEMENTATION
#define RBD_STATIC
#endif

#include <stddef.h>
#include <stdint.h>

#define RBD_VERSION "0.4.0"
#define RBD_VERSION_NUMBER 400 /* 10000 major + 100 minor + patch: for headers that build on this one */
#define RBD_MODEL_VERSION 6    /* layout of the built model; generated tables check it */

/* The macros of [configuration], checked and completed. */

/* Code of a GPU: nvcc, clang for CUDA and hipcc compile a file for the host and for the GPU. Each function is
   code of both then, and all memory has the same layout there. Without RBD_STATIC such a file has
   declarations alone, of code that another file compiles for the host. */
#if (defined __CUDACC__ || defined __CUDA__ || defined __HIP__) && defined RBD_STATIC
#define RBDI_GPU 1
#else
#define RBDI_GPU 0
#endif

/* A wrong macro gives one #error. It is then replaced by a value that works, so that no other message
   follows. */
#if !defined __cplusplus && (!defined __STDC_VERSION__ || __STDC_VERSION__ < 199901L)
#error "rbd: needs C99 or later: compile with -std=c99, c11, c17 or a gnu dialect of them"
#undef RBD_IMPLEMENTATION
#elif (defined __CUDACC__ || defined __CUDA__ || defined __HIP__) && defined RBD_IMPLEMENTATION && !RBDI_GPU
#error "rbd: code of a GPU lies in the file that calls it: define RBD_STATIC in each file that implements rbd"
#undef RBD_IMPLEMENTATION
#endif

#ifndef RBD_REAL
#define RBD_REAL double
#endif
#if !defined RBD_CONST && defined RBD_REAL_CUSTOM
#define RBD_CONST double
#elif !defined RBD_CONST
#define RBD_CONST RBD_REAL
#endif

#define RBDI_KIND_double 1
#define RBDI_KIND_float 2
#define RBDI_KIND___float128 3
#define RBDI_KIND_long 0 && /* long double, that the words behind it count as 0 */
#define RBDI_KIND_OF(type) RBDI_KIND_##type
#define RBDI_KIND(type) RBDI_KIND_OF(type)
#ifdef RBD_REAL_CUSTOM
#define RBDI_REAL_KIND 0
#elif (RBDI_KIND(RBD_REAL)) /* RBD_REAL: double, float or __float128; a class needs RBD_REAL_CUSTOM too */
#define RBDI_REAL_KIND RBDI_KIND(RBD_REAL)
#else
#error "rbd: RBD_REAL must be double, float or __float128 (for a C++ class define RBD_REAL_CUSTOM as well)"
#undef RBD_REAL
#undef RBD_CONST
#define RBD_REAL double
#define RBD_CONST double
#define RBDI_REAL_KIND 1
#endif
#if !(RBDI_KIND(RBD_CONST)) || (RBDI_REAL_KIND != RBDI_KIND(RBD_CONST) && RBDI_REAL_KIND % 3 != 0)
#error "rbd: RBD_CONST must be RBD_REAL; where that is __float128 or a class: double, float or __float128"
#undef RBD_CONST
#define RBD_CONST RBD_REAL
#endif

#if defined RBD_LANES && (RBD_LANES + 0 < 2 || (RBD_LANES + 0 & RBD_LANES + -1) != 0)
#error "rbd: RBD_LANES must be 2, 4, 8 or another power of two; leave it undefined for one state at a time"
#undef RBD_LANES
#define RBD_LANES 2
#endif
#if defined RBD_LANES && RBDI_GPU
#error "rbd: code of a GPU has one state a thread: leave RBD_LANES undefined"
#undef RBD_LANES
#elif defined RBD_LANES && (!defined __GNUC__ || RBDI_REAL_KIND % 3 == 0)
#error "rbd: RBD_LANES needs GCC or clang, and RBD_REAL double or float"
#undef RBD_LANES
#endif

/* From here to the end of the file, also in functions that are inlined. clang obeys unless
   -ffp-contract=fast is on its command line. */
#ifdef RBD_REPRODUCIBLE
#if RBDI_REAL_KIND % 3 == 0
#error "rbd: RBD_REPRODUCIBLE needs RBD_REAL double or float"
#undef RBD_REPRODUCIBLE
#elif RBDI_GPU
#error "rbd: RBD_REPRODUCIBLE has no meaning for code of a GPU: compile it with -fmad=false instead"
#undef RBD_REPRODUCIBLE
#elif defined __clang__
#pragma clang fp contract(off)
#elif defined __GNUC__
#pragma GCC optimize("fp-contract=off")
#else
#pragma STDC FP_CONTRACT OFF
#endif
#endif
#ifdef RBD_REPRODUCIBLE
#define RBDI_REPRODUCIBLE 1
#else
#define RBDI_REPRODUCIBLE 0
#endif

/* Functions and tables of host and GPU. A table is the GPU's own in that compiler's pass for it alone. */
#if RBDI_GPU && defined __clang__
#define RBDI_BOTH __attribute__((host, device))
#define RBDI_THERE __attribute__((device))
#elif RBDI_GPU
#define RBDI_BOTH __host__ __device__
#define RBDI_THERE __device__
#else
#define RBDI_BOTH
#endif
#if !RBDI_GPU || !(defined __CUDA_ARCH__ || defined __HIP_DEVICE_COMPILE__)
#undef RBDI_THERE
#define RBDI_THERE
#endif
#ifdef RBD_STATIC
#define RBDI_API static RBDI_BOTH RBDI_UNUSED
#else
#define RBDI_API extern
#endif
#if defined __GNUC__ || defined __clang__ /* clang for Windows is no __GNUC__ */
#define RBDI_UNUSED __attribute__((unused))
#define RBDI_EXTENSION __extension__
#else
#define RBDI_UNUSED
#define RBDI_EXTENSION
#endif

/* Every file has a symbol whose value encodes the scalar. The linker accepts it several times if all values
   are equal, else it refuses; in link-time optimisation the assembler does. It has no section, so that it
   takes no memory and is never removed. clang's link-time optimisation would refuse equal values too. */
#ifndef RBD_CHECK_SCALAR
#if defined __GNUC__ && !defined __clang__ && defined __ELF__ && !defined RBD_STATIC && \
    !defined RBD_REAL_CUSTOM
#define RBD_CHECK_SCALAR 1
#else
#define RBD_CHECK_SCALAR 0
#endif
#endif
#if RBD_CHECK_SCALAR
#define RBDI_QUOTE_OF(x) #x
#define RBDI_QUOTE(x) RBDI_QUOTE_OF(x)
#ifdef RBD_LANES
#define RBDI_SCALAR_LANES RBD_LANES
#else
#define RBDI_SCALAR_LANES 1
#endif
#define RBDI_SCALAR "rbd_files_differ_in_RBD_REAL_RBD_CONST_RBD_LANES_or_RBD_REPRODUCIBLE"
#define RBDI_SCALAR_VALUE \
    "(" RBDI_QUOTE(RBDI_KIND(RBD_REAL)) "+4*" RBDI_QUOTE(RBDI_KIND(RBD_CONST)) "+16*" RBDI_QUOTE( \
        RBDI_REPRODUCIBLE) "+32*" RBDI_QUOTE(RBDI_SCALAR_LANES) ")"
__asm__(".ifndef " RBDI_SCALAR "\n"
        ".globl " RBDI_SCALAR "\n"
        ".hidden " RBDI_SCALAR "\n" RBDI_SCALAR " = " RBDI_SCALAR_VALUE "\n"
        ".elseif " RBDI_SCALAR " - " RBDI_SCALAR_VALUE "\n"
        ".error \"" RBDI_SCALAR "\"\n"
        ".endif\n");
#endif

#define RBDI_PASTE_OF(a, b) a##_##b
#define RBDI_PASTE(a, b) RBDI_PASTE_OF(a, b)

RBDI_EXTENSION typedef RBD_CONST rbd_const; /* constants of the model */
#define RBD_C(x) ((rbd_const)(x))           /* a literal as a constant of the model, without a warning */
#ifdef RBD_LANES
typedef RBD_REAL rbd_real __attribute__((vector_size(RBD_LANES * sizeof(RBD_REAL))));
#else
RBDI_EXTENSION typedef RBD_REAL rbd_real; /* states and results */
#endif

#if defined __cplusplus && !defined RBD_REAL_CUSTOM && !defined RBD_STATIC
#define RBDI_EXTERN_C_BEGIN extern "C" {
#define RBDI_EXTERN_C_END }
#else
#define RBDI_EXTERN_C_BEGIN
#define RBDI_EXTERN_C_END
#endif
#endif

/* ==== src/rbd.h ==== */
RBDI_EXTERN_C_BEGIN

/* ==== src/api/symbols.h ==== */
/* The symbols name the scalar and the lanes, which determine the layout of arguments, so that files which
   differ in them do not link: rbd_rnea is rbd_rnea_double, or rbd_rnea_double_8 with 8 lanes. The batch
   calls, which take ordinary arrays, do not name the lanes. The mangled names of C++ tell classes apart. */
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
#define rbd_model_build_kinematic RBDI_SYMBOL(rbd_model_build_kinematic)
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
#define rbd_fd_cholesky RBDI_SYMBOL(rbd_fd_cholesky)
#define rbd_hybrid RBDI_SYMBOL(rbd_hybrid)
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
#define rbd_energy RBDI_SYMBOL(rbd_energy)
#define rbd_com RBDI_SYMBOL(rbd_com)
#define rbd_mass RBDI_SYMBOL(rbd_mass)
#define rbd_joint_wrench RBDI_SYMBOL(rbd_joint_wrench)
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
#define rbd_free_step RBDI_SYMBOL(rbd_free_step)
#define rbd_difference RBDI_SYMBOL(rbd_difference)
#define rbd_interpolate RBDI_SYMBOL(rbd_interpolate)
#define rbd_distance RBDI_SYMBOL(rbd_distance)
#define rbd_rates_from_velocity RBDI_SYMBOL(rbd_rates_from_velocity)
#define rbd_velocity_from_rates RBDI_SYMBOL(rbd_velocity_from_rates)
#define rbd_random RBDI_SYMBOL(rbd_random)
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

/* ==== src/api/types.h ==== */
/* ---- types [types] ---- */

/* Joint types; [conventions] has their coordinates. All but fixed may stand anywhere in the tree. Built
   models and generated tables hold these numbers: another order takes another RBD_MODEL_VERSION. */
typedef enum rbd_joint_type {
    RBD_FIXED,         /* merged into the parent; the body remains as a named frame */
    RBD_REVOLUTE,      /* about axis */
    RBD_CONTINUOUS,    /* about axis, no limits */
    RBD_CONTINUOUS_CS, /* about axis, q = (cos, sin) */
    RBD_PRISMATIC,     /* along axis */
    RBD_HELICAL,       /* about axis, and pitch metres per radian along it */
    RBD_CYLINDRICAL,   /* about and along axis, independently */
    RBD_UNIVERSAL,     /* about axis, then about axis2, which the first turn moves */
    RBD_SPHERICAL,     /* quaternion */
    RBD_EULER_ZYX,     /* R = Rz(q0) Ry(q1) Rx(q2) */
    RBD_EULER_XYZ,     /* R = Rx(q0) Ry(q1) Rz(q2) */
    RBD_EULER_YXZ,     /* R = Ry(q0) Rx(q1) Rz(q2) */
    RBD_EULER_ZXY,     /* R = Rz(q0) Rx(q1) Ry(q2) */
    RBD_PLANAR,        /* in the x-y plane of the joint frame */
    RBD_TRANSLATION,   /* along x, y, z of the joint frame */
    RBD_FLOATING,      /* free */
    RBD_JOINT_TYPES    /* how many there are */
} rbd_joint_type;

/* One body and the joint that carries it: a row of the description. Zero is a sensible default for
   every field but parent (-1 = world), type (0 is fixed), mass, axis where the joint has one, and
   mimic_ratio of a joint that mimics. */
typedef struct rbd_body {
    const char *name;    /* of the link; unique, NULL = nameless */
    const char *joint;   /* name of the joint; unique, NULL = nameless */
    int parent;          /* index of an earlier body, or -1 for the world */
    rbd_joint_type type; /* of the joint */
    double axis[3];      /* in the joint frame; need not be of unit length */
    double axis2[3];     /* universal: the second axis */
    double pitch;        /* helical: m/rad */
    double position[3];  /* of the joint frame's origin in the parent's link frame */
    double rotation[9];  /* 3 x 3, joint-frame vectors into parent-frame vectors; all 0 = identity */
    double mass;         /* kg */
    double com[3];       /* centre of mass, link frame */
    double inertia[6];   /* xx xy xz yy yz zz about the centre of mass, link axes, kg m^2 */
    double armature[6];  /* per degree of freedom, entries beyond are ignored: rotor inertia seen at the
                             joint, kg m^2 or kg; in M, rnea, fd */
    double damping[6];   /* per degree of freedom, N m s or N s/m: see rbd_passive */
    double friction[6];  /* per degree of freedom, N m or N: see rbd_passive */
    double lower, upper; /* limits of a revolute, prismatic or helical joint, rad or m; both 0 = none */
    double velocity;     /* limit, rad/s or m/s, 0 = none; kept for the user */
    double effort;       /* limit, N m or N, 0 = none; kept for the user */
    const char *mimic;   /* name of the joint that this one follows, NULL = none; one-dof joints only */
    double mimic_ratio;  /* q = ratio * (q of that joint) + offset; not 0 */
    double mimic_offset; /* rad or m */
} rbd_body;

typedef struct rbd_model rbd_model; /* constants: see rbd_model_build */
typedef struct rbd_work rbd_work;   /* scratch and results of one thread: see rbd_work_init */

/* ==== src/api/status.h ==== */
/* ---- status [status] ---- */

/* The result of most functions: 0, or a negative error. An error of the build names body and field. */
typedef enum rbd_status {
    RBD_OK = 0,
    RBD_ERR_NULL = -1,        /* a required pointer is NULL */
    RBD_ERR_MEMORY = -2,      /* the memory given is too small */
    RBD_ERR_VERSION = -3,     /* the built model is of another version or scalar */
    RBD_ERR_INDEX = -4,       /* no such body */
    RBD_ERR_ORDER = -5,       /* rbd_kinematics must be called first */
    RBD_ERR_SINGULAR = -6,    /* the mass matrix is singular: rbd_singular_dof says where */
    RBD_ERR_COUNT = -7,       /* number of bodies below 1 or above RBD_MAX_BODIES, or that of constraints */
    RBD_ERR_NAME = -8,        /* a name stands twice */
    RBD_ERR_PARENT = -9,      /* parent is not an earlier body or -1 */
    RBD_ERR_TYPE = -10,       /* unknown joint type, or missing: fixed, but with an axis */
    RBD_ERR_AXIS = -11,       /* axis zero or not finite; universal: axes parallel */
    RBD_ERR_PITCH = -12,      /* not finite */
    RBD_ERR_POSITION = -13,   /* not finite */
    RBD_ERR_ROTATION = -14,   /* not finite or not orthonormal and right-handed */
    RBD_ERR_MASS = -15,       /* not finite or negative */
    RBD_ERR_COM = -16,        /* not finite */
    RBD_ERR_INERTIA = -17,    /* not finite */
    RBD_ERR_LEAF = -18,       /* a movable leaf without mass, inertia and armature */
    RBD_ERR_ARMATURE = -19,   /* not finite or negative */
    RBD_ERR_DAMPING = -20,    /* not finite or negative */
    RBD_ERR_FRICTION = -21,   /* not finite or negative */
    RBD_ERR_LIMITS = -22,     /* not finite, or a negative velocity or effort limit */
    RBD_ERR_MIMIC = -23,      /* not a one-dof joint, what it follows is missing or follows too, or ratio 0 */
    RBD_ERR_WORK = -24,       /* the work, or batch, is of another model; the set, of another work */
    RBD_ERR_NAN = -25,        /* NaN in q (rbd_singular_dof says where), v, a force or a gap; or overflow */
    RBD_ERR_RANGE = -26,      /* a gain, weight, restitution, friction, dt, option or q is out of range */
    RBD_ERR_INFEASIBLE = -27, /* constraints contradict each other */
    RBD_ERR_LEFT_OUT = -28,   /* the model needs code that RBD_FEATURES or RBD_NO_CHOLESKY leave out */
    RBD_ERR_ARITHMETIC = -29, /* RBD_REPRODUCIBLE, and arithmetic does not round as in [guarantees] */
    RBD_ERR_MASSLESS = -30,   /* built for kinematics alone, and this call needs the mass that a joint moves:
                                 rbd_singular_dof says which joint has none */
    /* warnings of the build: dynamics computes with such a body, but no real one is like this */
    RBD_WARN_INERTIA_NEGATIVE = 1, /* inertia has a negative eigenvalue */
    RBD_WARN_INERTIA_TRIANGLE = 2, /* one principal moment exceeds the sum of the others */
    RBD_WARN_INERTIA_ZERO = 3,     /* mass, but no inertia about the centre of mass */
    RBD_WARN_MASS_ZERO = 4,        /* inertia, but no mass */
    RBD_WARN_LIMITS = 5 /* lower >= upper, or limits of another type of joint: read as none; or a joint that
                           mimics another has limits that contradict the other's */
} rbd_status;

/* One sentence for a status, English, static. */
RBDI_API const char *rbd_status_string(rbd_status status);

/* One finding of the build. */
typedef struct rbd_finding {
    rbd_status status;
    int body;          /* index in the description, -1 = the whole model */
    const char *name;  /* of that body, NULL if nameless; points into the description */
    const char *field; /* of rbd_body, e.g. "inertia" */
    const char *text;  /* a sentence where the status's says too little, else NULL */
} rbd_finding;

#define RBD_MAX_WARNINGS 16
/* Findings of the build: the first error, and the warnings, of which the first RBD_MAX_WARNINGS are kept. */
typedef struct rbd_report {
    rbd_finding error; /* error.status is RBD_OK if there is none */
    int warnings;      /* number of all */
    rbd_finding warning[RBD_MAX_WARNINGS];
} rbd_report;

/* Writes a finding as a sentence, e.g. "body 3 'left_foot', field 'mass': negative or not finite",
   cut to fit, always terminated. text: size bytes. Returns text. */
RBDI_API char *rbd_finding_text(const rbd_finding *finding, char *text, size_t size);

/* ==== src/api/model.h ==== */
/* ---- build [build] ---- */

#define RBD_MAX_BODIES 1000

#ifndef RBD_NO_BUILD

/* Builds a model from a description into the caller's memory.
   bodies   nb rows, parents first; only its strings must outlive the model
   memory   size bytes of any alignment; RBD_MODEL_SIZE(nb) always suffices
   model    receives the model, which lies inside memory: do not move it; NULL after an error
   report   receives the error and the warnings; may be NULL
   Errors: RBD_ERR_NULL, _MEMORY, _COUNT, and all from RBD_ERR_NAME on, with body and field. */
RBDI_API rbd_status rbd_model_build(const rbd_body *bodies, int nb, void *memory, size_t size,
                                    const rbd_model **model, rbd_report *report);

/* The same for kinematics alone: joints may move no mass, as in a robot whose file has geometry only. If each
   joint moves mass, inertia or armature, or one does that mimics it, the model is that of rbd_model_build.
   Otherwise all calls that need masses return RBD_ERR_MASSLESS, and rbd_singular_dof says which joint moves
   none. Poses, velocities, accelerations, Jacobians, inverse kinematics, coordinates, rows of constraints and
   rbd_assemble are computed as for any model. Errors: those of rbd_model_build but RBD_ERR_LEAF. */
RBDI_API rbd_status rbd_model_build_kinematic(const rbd_body *bodies, int nb, void *memory, size_t size,
                                              const rbd_model **model, rbd_report *report);

/* Bytes that rbd_model_build needs for this description; 0 if nb is out of range. */
RBDI_API size_t rbd_model_size(const rbd_body *bodies, int nb);

/* Adds a payload, such as an object in the hand, to a body of a built model. Later results are those of a new
   build, to rounding. It costs a step for each link on the way to the root. To take the payload off, add it
   with mass and inertia negated. Every rbd_work and set of constraints stays valid; but make a set anew after
   taking off mass that the model was built with. Make every rbd_derivatives anew: it has copies of masses. A
   model for kinematics alone stays one: if its joints move mass now, build it anew. No other call may use the
   model meanwhile. A model in a table of constants cannot be changed.
   memory   the memory that was given to rbd_model_build
   mass     kg, may be negative
   com      centre of mass of the payload, link frame, m
   inertia  xx xy xz yy yz zz about that, link axes, kg m^2; NULL = a point mass
   Errors, which leave the model as it was: RBD_ERR_NULL, _VERSION (no model there), _INDEX; _MASS, _COM,
   _INERTIA if not finite; _MASS if the body's mass would be negative, _INERTIA if its inertia would have a
   negative eigenvalue. */
RBDI_API rbd_status rbd_add_payload(void *memory, int body, double mass, const double com[3],
                                    const double inertia[6]);

/* Holds joints of a description still. The row of each joint whose flag is set, and of those that mimic it,
   becomes a fixed joint at the pose that the joint has at q. All bodies stay, with their names and indices.
   The new model's q and v are those of the joints that still move, in the same order. Its dynamics is that of
   the whole model with v = a = 0 of the held joints.
   bodies   nb rows, as for rbd_model_build; those of a built model come from rbd_describe
   locked   nb flags: not 0 where the body's joint shall be held; without effect on a fixed one
   q        nq, of all joints of the description. Only those of held joints, and of joints that these mimic,
            are read. Limits do not count
   rows     nb rows, receives the description with fixed joints; may be bodies. An error leaves it as it was
   report   receives the error and the warnings; may be NULL
   Errors: RBD_ERR_NULL, _COUNT; RBD_ERR_RANGE, with the body, if a coordinate of a held joint is not finite;
   all of rbd_model_build that one row can have, with body and field. */
RBDI_API rbd_status rbd_lock_joints(const rbd_body *bodies, int nb, const unsigned char *locked,
                                    const double *q, rbd_body *rows, rbd_report *report);

#endif

/* ---- work [work] ---- */

/* Prepares the memory that the algorithms work in; one per thread and model. It serves every model with
   arrays of the same lengths, such as a copy. With a model of other lengths, including one rebuilt in
   the same memory, each call returns RBD_ERR_WORK.
   memory   size bytes of any alignment; RBD_WORK_SIZE(nb, nv) always suffices, with mimic joints
            RBD_WORK_SIZE_MIMIC(nb, nv)
   work     receives the work structure, which lies inside memory: do not move it; NULL after an error
   Errors: RBD_ERR_NULL, _MEMORY, _VERSION, _LEFT_OUT, _ARITHMETIC. */
RBDI_API rbd_status rbd_work_init(const rbd_model *m, void *memory, size_t size, rbd_work **work);

/* Bytes that rbd_work_init needs for this model. */
RBDI_API size_t rbd_work_size(const rbd_model *m);

/* Sets gravity, a vector in the world frame, m/s^2, for the calls that follow. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_set_gravity(rbd_work *w, const rbd_const gravity[3]);

/* Reads the gravity that is set, m/s^2. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_get_gravity(const rbd_work *w, rbd_const gravity[3]);

/* Returns, after RBD_ERR_SINGULAR or RBD_ERR_NAN, the degree of freedom (index into v) whose pivot is not
   above its rounding, or not a number; of several the last. After RBD_ERR_NAN the cause is q of a joint
   that this dof moves, or of its own joint if that has several dofs, or an overflow there. -1 after a call
   that factors M and finds it regular: then RBD_ERR_NAN of rbd_contact_step came from v, tau, f_ext, damping,
   a gap, or a coordinate that M does not depend on, as the place of a floating root. Other calls do not
   change it. With lanes: of all states together. After RBD_ERR_MASSLESS the first degree of freedom that
   moves no mass. */
RBDI_API int rbd_singular_dof(const rbd_work *w);

/* ==== src/api/dynamics.h ==== */
/* ---- dynamics [dynamics] ----
   q: nq, v, a, tau: nv, f_ext: nb x 6 or NULL. An output may be the same array as an input of the
   same shape, but must not overlap otherwise. All include armature; none includes damping and
   friction. Errors: RBD_ERR_NULL, RBD_ERR_WORK, and RBD_ERR_SINGULAR where said; there RBD_ERR_NAN too, and
   after either all results are 0.

   M is singular if one of its pivots is not above the rounding of the description and of the call's own
   terms: [guarantees]. A pivot below 1e-7 (float: 1e-3) of the largest inertia that its joint can move is
   in doubt. Then the call bounds its rounding to decide: rbd_aba takes up to six times as long. */

/* Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext. Recursive Newton-Euler, RBDA table 5.1. */
RBDI_API rbd_status rbd_rnea(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *a, const rbd_real *f_ext, rbd_real *tau);

/* Bias force c, the part of inverse dynamics that does not depend on a: velocity terms, gravity, minus
   external wrenches. rbd_rnea gives it at a = 0. */
RBDI_API rbd_status rbd_bias(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *f_ext, rbd_real *c);

/* Gravity torque g, which holds the robot still. rbd_rnea gives it at v = a = 0, without f_ext. */
RBDI_API rbd_status rbd_gravity_torque(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *g);

/* Generalized momentum p = M v and C' v, for a momentum observer, which detects contacts by dp/dt = tau +
   C' v - g + sum J' f_ext (De Luca and Mattone 2005). C is the Coriolis matrix of rbd_coriolis, for which
   dM/dt - 2 C is skew. No matrix is computed: p_i = S_i' h_i, (C' v)_i = (dS_i/dt)' h_i, h_i the momenta of
   the subtrees.
   p, ctv: nv; each may be NULL, not the same array. */
RBDI_API rbd_status rbd_generalized_momentum(const rbd_model *m, rbd_work *w, const rbd_real *q,
                                             const rbd_real *v, rbd_real *p, rbd_real *ctv);

/* Mass matrix M, nv x nv, both triangles. Composite rigid bodies, RBDA table 6.2. */
RBDI_API rbd_status rbd_crba(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *mass_matrix);

/* Mass matrix packed: rows of the lower triangle one after the other, rbd_packed_size(m) entries. Row i has
   the columns of its ancestors in the tree, root first, then i: all others are zero. With mimic joints the
   tree is the matrix's elimination tree, and some entries may be zero. */
RBDI_API rbd_status rbd_crba_packed(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *packed);

/* Number of entries of a packed matrix, at most nv (nv + 1) / 2. */
RBDI_API int rbd_packed_size(const rbd_model *m);

/* Index of entry (i, j) in a packed matrix; -1 if the tree makes it zero, or there is no such dof. */
RBDI_API int rbd_packed_index(const rbd_model *m, int i, int j);

/* Forward dynamics a = M^-1 (tau - c + sum J' f_ext). Articulated bodies, RBDA table 7.1. Also
   RBD_ERR_SINGULAR. Models with mimic joints are solved by rbd_fd_cholesky. */
RBDI_API rbd_status rbd_aba(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                            const rbd_real *tau, const rbd_real *f_ext, rbd_real *a);

#ifndef RBD_NO_CHOLESKY
/* Forward dynamics by mass matrix, bias and branch-sparse L'DL, RBDA ch. 6. Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_fd_cholesky(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *tau, const rbd_real *f_ext, rbd_real *a);

/* Hybrid dynamics, M a + c = tau + sum J' f_ext: of each degree of freedom either the acceleration or the
   torque is given, and the other computed. By the mass matrix, RBDA section 9.1. Of the dofs of one joint
   some may have a given, the others tau. If only a floating base's torque is given, rbd_id_free_base of
   rbd_derivatives.h is faster.
   given   nv flags: not 0 where a is given, 0 where tau is
   a, tau  in: what is given; out: all. Not the same array.
   Also RBD_ERR_SINGULAR, of the degrees of freedom whose torque is given; then a and tau are 0. */
RBDI_API rbd_status rbd_hybrid(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                               const unsigned char *given, rbd_real *a, rbd_real *tau, const rbd_real *f_ext);

/* Factors M = L' D L keeping the tree's zeros, RBDA section 6.5.
   mass_matrix   nv x nv, of this model's sparsity (as from rbd_crba; only the lower triangle is read)
   factor        packed like rbd_crba_packed: L below the diagonal, 1/D on it; rbd_packed_size(m) entries
   Both may be the same array. Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_cholesky_factor(const rbd_model *m, rbd_work *w, const rbd_real *mass_matrix,
                                        rbd_real *factor);

/* The same on a packed matrix, in place. Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_cholesky_factor_packed(const rbd_model *m, rbd_work *w, rbd_real *packed);

/* Solves M x = b with the factor. b, x: nv; may be the same. */
RBDI_API rbd_status rbd_cholesky_solve(const rbd_model *m, rbd_work *w, const rbd_real *factor,
                                       const rbd_real *b, rbd_real *x);

/* Solves M x = b for n right-hand sides, the columns of b. b, x: nv x n; may be the same. With n <= 0 it does
   nothing. With b = J', for a Jacobian J, J x is J M^-1 J'; columns of the identity give those of M^-1. */
RBDI_API rbd_status rbd_cholesky_solve_many(const rbd_model *m, rbd_work *w, const rbd_real *factor, int n,
                                            const rbd_real *b, rbd_real *x);

/* Inverse M^-1 of the mass matrix, nv x nv, both triangles, which are equal to the bit. From the factor of M,
   row by row (Takahashi, Fagan and Chin 1973). Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_minverse(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *Minv);
#endif

/* Passive torque of the joints, tau_k = -damping_k v_k - friction_k sign(v_k), sign(0) = 0: add it to
   the tau given to forward dynamics, subtract it from the tau that inverse dynamics gives.
   A mimic joint's torque acts on the joint that it follows. v, tau: nv; may be the same array.
   Errors: RBD_ERR_NULL, _WORK. */
RBDI_API rbd_status rbd_passive(const rbd_model *m, rbd_work *w, const rbd_real *v, rbd_real *tau);

/* ==== src/api/kinematics.h ==== */
/* ---- kinematics [kinematics] ---- */

/* Computes poses, velocities and accelerations of all bodies, for the functions below.
   q: nq; v, a: nv, or NULL for zero. The results stay until the next call of rbd_kinematics,
   rbd_body_kinematics, rbd_joint_wrench, or of rbd_constraints.h or rbd_contact.h with the same work.
   Errors: RBD_ERR_NULL, _WORK. */
RBDI_API rbd_status rbd_kinematics(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                   const rbd_real *a);

/* Computes poses, velocities and accelerations of one body, and of the bodies between it and the world, as
   rbd_kinematics does of all. For other bodies, and for sums over all bodies, the functions below then return
   RBD_ERR_ORDER. q: nq; v, a: nv, or NULL for zero.
   Errors: RBD_ERR_NULL, _WORK, _INDEX. */
RBDI_API rbd_status rbd_body_kinematics(const rbd_model *m, rbd_work *w, int body, const rbd_real *q,
                                        const rbd_real *v, const rbd_real *a);

/* Pose of a body: rotation, 3 x 3, from link axes to world axes; p, the link origin in the world, m. Each
   may be NULL. Errors of these four: RBD_ERR_NULL, _WORK, _INDEX, _ORDER. */
RBDI_API rbd_status rbd_body_pose(const rbd_model *m, const rbd_work *w, int body, rbd_real rotation[9],
                                  rbd_real p[3]);

/* Spatial velocity of a body (omega; v of the link origin), link axes. */
RBDI_API rbd_status rbd_body_velocity(const rbd_model *m, const rbd_work *w, int body, rbd_real velocity[6]);

/* Spatial acceleration of a body, link axes, without gravity: d/dt of the components of the velocity. */
RBDI_API rbd_status rbd_body_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                          rbd_real acceleration[6]);

/* Classical acceleration of a body (domega/dt; acceleration of the link origin), link axes, without gravity:
   an accelerometer at the origin measures it minus gravity. */
RBDI_API rbd_status rbd_body_acceleration_classical(const rbd_model *m, const rbd_work *w, int body,
                                                    rbd_real acceleration[6]);

/* Kinetic energy (rotors' included) and potential energy (zero at the world origin), of all bodies
   that a joint moves, J; after rbd_kinematics. Either may be NULL. Errors of these two: RBD_ERR_NULL,
   _WORK, _ORDER. */
RBDI_API rbd_status rbd_energy(const rbd_model *m, const rbd_work *w, rbd_real *kinetic, rbd_real *potential);

/* Centre of mass of all bodies that a joint moves, its velocity and acceleration, world frame; after
   rbd_kinematics. Each may be NULL. Zero if there is no mass. */
RBDI_API rbd_status rbd_com(const rbd_model *m, const rbd_work *w, rbd_real position[3], rbd_real velocity[3],
                            rbd_real acceleration[3]);

/* Mass of all bodies that a joint moves, kg; 0 without a model. */
RBDI_API rbd_const rbd_mass(const rbd_model *m);

/* The wrench (moment; force) that each body's joint transmits, fixed joints too: it loads gears and bearings,
   and a force sensor there measures it. It acts on the body, from its parent, in link axes at the link's
   origin. RBDA table 5.1 with the bodies' own inertias; along the axis it is tau - armature a.
   It calls rbd_kinematics with q, v, a. f_ext: as for rbd_rnea. wrench: nb x 6.
   Errors: RBD_ERR_NULL, _WORK. */
RBDI_API rbd_status rbd_joint_wrench(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                     const rbd_real *a, const rbd_real *f_ext, rbd_real *wrench);

/* ==== src/api/points.h ==== */
/* ---- points and momentum [points] ----
   After rbd_kinematics or, for its bodies, rbd_body_kinematics, at its q, v and a. A point is fixed in a
   body: 3 components in link axes, NULL for the link origin. Its motion: (omega of the body; velocity of the
   point), along world axes or link axes.
   Errors: RBD_ERR_NULL, _WORK, _INDEX, _ORDER. */

typedef enum rbd_axes { RBD_WORLD_AXES, RBD_LINK_AXES } rbd_axes;

/* Jacobian of a point, 6 x nv: its motion is J v. Columns of dofs that do not move the body are zero.
   Siciliano, Sciavicco, Villani and Oriolo, Robotics (2009), section 3.1. */
RBDI_API rbd_status rbd_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                 rbd_axes axes, rbd_real *jacobian);

/* Jacobian of a point of a body relative to another body, the reference (-1: the world), 6 x nv: J v is
   the motion of the point less that of the reference's point at the same place. RBD_LINK_AXES: the
   reference's. */
RBDI_API rbd_status rbd_relative_jacobian(const rbd_model *m, const rbd_work *w, int body,
                                          const rbd_real point[3], int reference, rbd_axes axes,
                                          rbd_real *jacobian);

/* tau = J' f, nv, for a wrench f (moment about the point; force) along these axes, without computing J. */
RBDI_API rbd_status rbd_jacobian_transpose(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, const rbd_real f[6],
                                           rbd_real *tau);

/* Position of a point in the world, m. */
RBDI_API rbd_status rbd_point_position(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_real position[3]);

/* Motion of a point, J v. */
RBDI_API rbd_status rbd_point_velocity(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_axes axes, rbd_real velocity[6]);

/* (domega/dt; classical acceleration of the point), without gravity: J a + dJ/dt v, J along world axes.
   With a = NULL in rbd_kinematics it is the bias dJ/dt v. */
RBDI_API rbd_status rbd_point_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, rbd_real acceleration[6]);

/* Converts a wrench f (moment about the point; force) along these axes to a row of f_ext, that of the body:
   f_ext + 6 body. Add up the rows of several points. row may be f. */
RBDI_API rbd_status rbd_point_wrench(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                     rbd_axes axes, const rbd_real f[6], rbd_real row[6]);

/* Centroidal momentum h (angular, about the centre of mass; linear) of all bodies that a joint moves, and its
   rate h_dot, world axes. Either may be NULL. Rotors (armature) have none. Orin, Goswami and Lee (2013).
   The wrench of the world on the robot, without gravity, is n = h_dot[0..2] about the centre of mass and f =
   h_dot[3..5] - rbd_mass(m) gravity. On a ground z = 0 the zero-moment point is (c_x - (n_y + c_z f_x) / f_z,
   c_y + (n_x - c_z f_y) / f_z, 0), with c from rbd_com. */
RBDI_API rbd_status rbd_momentum(const rbd_model *m, const rbd_work *w, rbd_real h[6], rbd_real h_dot[6]);

/* ==== src/api/manifold.h ==== */
/* ---- configuration manifold [manifold] ----
   q: nq, v and d: nv, in the coordinates of [conventions]. Errors: RBD_ERR_NULL. */

/* The neutral configuration: zeros, identity quaternions, (cos, sin) = (1, 0). */
RBDI_API rbd_status rbd_neutral(const rbd_model *m, rbd_real *q);

/* q_next = q moved by the tangent step v dt: exponentials in body axes for spherical (SO(3)), planar
   (SE(2)) and floating (SE(3)) joints, addition for the others. q_next may be q. */
RBDI_API rbd_status rbd_integrate(const rbd_model *m, const rbd_real *q, const rbd_real *v, rbd_real dt,
                                  rbd_real *q_next);

/* One step of semi-implicit Euler from the accelerations a of forward dynamics: nu = v + dt a, then q moves
   by nu dt. The velocities of floating, planar and spherical joints have body axes; their step is made in
   the axes of its beginning: the origin has its classical acceleration and moves straight, and v_next is nu
   in the axes of the end. So a free body keeps its linear momentum, and a rolling ball its energy, at any
   dt; v + dt a by components and rbd_integrate gain some. It is of first order: it takes a as it is at q and
   v, so bodies and robots that turn fast gain energy by their velocity terms, a box at 30 rad/s two thirds
   in ten seconds at 1 ms. rbd_free_step does not. q_next may be q, v_next may be v or a. */
RBDI_API rbd_status rbd_step(const rbd_model *m, const rbd_real *q, const rbd_real *v, const rbd_real *a,
                             rbd_real dt, rbd_real *q_next, rbd_real *v_next);

#ifndef RBD_NO_CHOLESKY
/* One step of second order from torques, without contacts: the midpoint scheme of rbd_contact_step, which
   keeps energy and momentum of what turns to second order in dt. Of a single body it takes some energy where
   it turns by more than a quarter of a radian a step, and is stable up to two radians; joints that turn by
   more than a twentieth of a radian a step may gain energy. The option `momentum` of rbd_contact_step, also
   of a set without contacts, keeps momentum to rounding. Some three times the work of rbd_aba and rbd_step.
   tau, damping   nv. damping is implicit: tau acts as tau - damping v_next. NULL: 0
   f_ext          nb x 6 or NULL: in the axes that bodies have in the middle of the step
   dt             s; any finite number
   q_next may be q, v_next may be v. Errors: as rbd_fd_cholesky; also RBD_ERR_NAN if a velocity changes by
   1e12 or more, or by NaN. After RBD_ERR_SINGULAR and RBD_ERR_NAN forces and velocity terms count as 0.
   Moreau 1999; Hairer, Lubich and Wanner, Geometric Numerical Integration, VII. */
RBDI_API rbd_status rbd_free_step(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                  const rbd_real *tau, const rbd_real *f_ext, const rbd_real *damping,
                                  rbd_real dt, rbd_real *q_next, rbd_real *v_next);
#endif

/* The tangent step d, nv, for which rbd_integrate(q0, d, 1) is q1, with the shortest rotation. */
RBDI_API rbd_status rbd_difference(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real *d);

/* The part s of the way from q0 to q1: q, nq, is rbd_integrate(q0, rbd_difference(q0, q1), s). It turns by
   the shortest rotation, at constant velocity. s = 0 gives q0 and s = 1 gives q1 exactly, with quaternions
   and (cos, sin) made unit. s below 0 or above 1 goes on along the same way. Before s = 1 a quaternion may be
   near -q1, and a planar angle whole turns from q1. q may be q0 or q1. */
RBDI_API rbd_status rbd_interpolate(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real s,
                                    rbd_real *q);

/* Distance between two configurations: the square root of the sum of weight_k d_k^2, d =
   rbd_difference(q0, q1). Pinocchio's distance, if weight is NULL.
   weight     nv, not below 0; 0: the dof does not count. NULL: 1, that is, a metre counts as much as a radian
   distance   one number, in radians if lengths have weights of 1 / length^2 (or 0) and angles 1
   Also RBD_ERR_RANGE, a weight that is below 0 or not a number. */
RBDI_API rbd_status rbd_distance(const rbd_model *m, const rbd_real *q0, const rbd_real *q1,
                                 const rbd_const *weight, rbd_real *distance);

/* Rates q' of the coordinates, nq, from the velocity, for filters and ODE solvers: a quaternion's is
   q (omega; 0) / 2, a (cos, sin)'s (-sin, cos) v; their lengths stay. */
RBDI_API rbd_status rbd_rates_from_velocity(const rbd_model *m, const rbd_real *q, const rbd_real *v,
                                            rbd_real *rates);

/* The velocity, nv, from such rates. A change of length of a quaternion or (cos, sin) does not count. */
RBDI_API rbd_status rbd_velocity_from_rates(const rbd_model *m, const rbd_real *q, const rbd_real *rates,
                                            rbd_real *v);

/* A random configuration: uniform within the limits of a joint that has them, else angles in (-pi, pi),
   lengths in (-1, 1) m, orientations uniform. seed: any value; the call advances it. */
RBDI_API rbd_status rbd_random(const rbd_model *m, uint64_t *seed, rbd_real *q);

/* ==== src/api/lookup.h ==== */
/* ---- lookup [lookup] ---- */

RBDI_API int rbd_nb(const rbd_model *m); /* number of bodies */
RBDI_API int rbd_nq(const rbd_model *m); /* length of q */
RBDI_API int rbd_nv(const rbd_model *m); /* length of v, a, tau: degrees of freedom */

/* Index of the body with this name of its link, or of its joint; -1 if there is none. */
RBDI_API int rbd_body_index(const rbd_model *m, const char *name);
RBDI_API int rbd_joint_index(const rbd_model *m, const char *name);

/* Names of a body's link and of its joint; NULL if it is nameless or there is no such body. */
RBDI_API const char *rbd_body_name(const rbd_model *m, int body);
RBDI_API const char *rbd_joint_name(const rbd_model *m, int body);

/* The joint of a body: its type, its entries of q and v, its limits. Errors: RBD_ERR_NULL, _INDEX. */
typedef struct rbd_joint_info {
    rbd_joint_type type;
    int iq, nq, iv, nv;     /* q[iq] .. q[iq + nq - 1], v likewise; mimic, fixed: nq = nv = 0, iq = iv = -1 */
    rbd_const lower, upper; /* rad or m; both 0: none */
    rbd_const velocity, effort; /* as in rbd_body */
} rbd_joint_info;
RBDI_API rbd_status rbd_joint(const rbd_model *m, int body, rbd_joint_info *info);

/* The body whose joint has this degree of freedom, -1 if there is none. */
RBDI_API int rbd_dof_body(const rbd_model *m, int dof);

#ifndef RBD_NO_BUILD /* because it computes in double */
/* Reads a body back from any model, tables too, as a row from which rbd_model_build makes the same, to
   rounding. Its parent is the next body towards the root whose joint moves; bodies fixed between them are
   left out. Axes have unit length. Errors: RBD_ERR_NULL, _INDEX. */
RBDI_API rbd_status rbd_describe(const rbd_model *m, int body, rbd_body *row);
#endif

/* ==== src/rbd.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* Below, names of one letter are those of the formulas. The caller's macros of these names (I of complex.h, F
   of Arduino) are set aside, and restored at the end. */

/* ==== src/base/letters_begin.h ==== */
#pragma push_macro("A")
#undef A
#pragma push_macro("B")
#undef B
#pragma push_macro("C")
#undef C
#pragma push_macro("D")
#undef D
#pragma push_macro("E")
#undef E
#pragma push_macro("F")
#undef F
#pragma push_macro("G")
#undef G
#pragma push_macro("H")
#undef H
#pragma push_macro("I")
#undef I
#pragma push_macro("J")
#undef J
#pragma push_macro("K")
#undef K
#pragma push_macro("L")
#undef L
#pragma push_macro("M")
#undef M
#pragma push_macro("N")
#undef N
#pragma push_macro("O")
#undef O
#pragma push_macro("P")
#undef P
#pragma push_macro("R")
#undef R
#pragma push_macro("S")
#undef S
#pragma push_macro("T")
#undef T
#pragma push_macro("U")
#undef U
#pragma push_macro("V")
#undef V
#pragma push_macro("X")
#undef X
#pragma push_macro("Y")
#undef Y
#pragma push_macro("Z")
#undef Z

/* ==== src/rbd.h ==== */
#ifndef RBDI_LAYOUT
#define RBDI_LAYOUT

/* ==== src/base/types.h ==== */
#ifndef RBDI_BASE_TYPES_H
#define RBDI_BASE_TYPES_H
/* ---- layout [layout] ----
   The built model and the work, laid open for sizes at compile time and for generated tables only. */

/* Arithmetic of the build: double at least, whatever the model's scalar. Firmware, which does not build, sets
   constraints up in its own scalar. */
#if RBDI_KIND(RBD_CONST) == 3 || (defined RBD_NO_BUILD && !RBDI_REPRODUCIBLE)
#define RBDI_WIDE RBD_CONST
#else
#define RBDI_WIDE double
#endif
RBDI_EXTENSION typedef RBDI_WIDE rbdi_wide;

#define RBDI_CHUNK 16 /* padding of rows: at least a batch */

/* Doubles in the widest SIMD register for which any file of a program may be compiled, 0 without. Memory is
   sized for it: the file with the implementation may have other options than the file that gives memory. */
#if RBDI_GPU
#define RBDI_WIDEST_SIMD 0
#elif defined __x86_64__ || defined __i386__ || defined __aarch64__ || defined _M_X64 || defined __wasm__
#define RBDI_WIDEST_SIMD 8
#else
#define RBDI_WIDEST_SIMD 0
#endif
#define RBDI_ALIGN ((size_t)(sizeof(rbd_real) > 64 ? sizeof(rbd_real) : 64))
#define RBDI_ROUND(bytes) (((size_t)(bytes) + RBDI_ALIGN - 1) / RBDI_ALIGN * RBDI_ALIGN)
#endif

/* ==== src/algebra/types.h ==== */
/* Flags of a link whose twist has a known angle. Macros, because C++20 warns where enumerators of two
   enumerations are combined. */
#define RBDI_TWIST_90 128 /* 90 degrees */
#define RBDI_TWIST_0 256  /* 0 */

/* c: of constants of the model. */
typedef struct rbdi_c3 {
    rbd_const x, y, z;
} rbdi_c3;

typedef struct rbdi_csym {
    rbd_const xx, xy, xz, yy, yz, zz;
} rbdi_csym;

typedef struct rbdi_v3 {
    rbd_real x, y, z;
} rbdi_v3;

typedef struct rbdi_sym { /* symmetric 3 x 3 */
    rbd_real xx, xy, xz, yy, yz, zz;
} rbdi_sym;

typedef struct rbdi_mat { /* 3 x 3 */
    rbd_real xx, xy, xz, yx, yy, yz, zx, zy, zz;
} rbdi_mat;

typedef struct rbdi_motion { /* angular, linear */
    rbdi_v3 omega, v;
} rbdi_motion;

typedef struct rbdi_force { /* moment, force */
    rbdi_v3 n, f;
} rbdi_force;

/* Velocity and classical acceleration of a link, in its own axes at its origin. */
typedef struct rbdi_state {
    rbdi_v3 omega, omega_dot, acc;
} rbdi_state;

typedef struct rbdi_rbi { /* composite rigid body; its mass is the constant subtree_mass */
    rbdi_sym Sigma;
    rbdi_v3 h;
} rbdi_rbi;

typedef struct rbdi_abi { /* articulated-body inertia [I H; H' M] */
    rbdi_sym I;
    rbdi_mat H;
    rbdi_sym M;
} rbdi_abi;

typedef struct rbdi_trig { /* cosine and sine of the joint angle; the slide d + kappa q */
    rbd_real c, s, d;
} rbdi_trig;

typedef struct rbdi_pose { /* x_child = E (x_parent - r) */
    rbdi_mat E;
    rbdi_v3 r;
} rbdi_pose;

/* ==== src/model/layout.h ==== */
/* Interface: rbdi_block, rbdi_dof, rbdi_frame, rbdi_link, rbdi_node, rbdi_order, RBDI_ARMATURE, RBDI_BLOCK,
   RBDI_BRANCH_TURN, RBDI_MASS_KEPT, RBDI_OFF_CHAIN, RBDI_REVOLUTE, RBDI_REVOLUTE_CS, RBDI_ROOT, RBDI_SCREW,
   RBDI_SHAPE, RBDI_SHIFT_R, RBDI_SHIFT_XYZ, RBDI_SHIFT_Z, RBDI_SLIDES */

/* Pose of a frame B in a frame A: x_B = E (x_A - r), in the build's arithmetic. */
typedef struct rbdi_wide_pose {
    rbdi_wide E[9], r[3];
} rbdi_wide_pose;

/* A link during the build. Later steps overwrite fields of earlier ones. */
typedef struct rbdi_build_link {
    rbdi_wide_pose X;               /* in the parent's frame at q = 0; r is without the slide d */
    rbdi_wide Sigma[6], h[3], mass; /* second, first and zeroth moment of mass */
    rbdi_wide_pose solver;          /* solver frame in the user's link frame */
    rbdi_wide axis[3], rho, kappa;
    rbdi_wide cg, sg, ca, sa, cb, sb, d;
    rbdi_wide all_mass, radius, lever; /* of the subtree: mass, radius of gyration and first moment */
    rbdi_wide trace, moment;           /* of the subtree: bounds of its moments of mass */
    rbdi_wide scale, reach;            /* of the pivot; of the user's frames: see rbdi_build_scale */
    rbdi_wide subtree_mass;            /* regrouped */
    int parent, kind, type, iq, iv;    /* parent: index among the links being built */
    int body, joint_dof;               /* its body; its first dof among those of the body's joint */
    int size, favourite;  /* number of links in the subtree; the child that is next in the solver's order */
    int position, cursor; /* in the solver's order: its own; that of its next child */
    int order;            /* the link whose position is this one's index */
    int dh;               /* whether it has Denavit and Hartenberg's form: beta = 0, r along x */
} rbdi_build_link;

/* A body of the description during the build. */
typedef struct rbdi_place {
    rbdi_wide_pose X; /* in its link */
    int link;         /* that carries it, -1 = world */
    int moves;        /* whether its joint moves mass, inertia or armature */
    int iq, iv;
} rbdi_place;

/* Kinds of links: those that move about and along their z, and blocks, see rbdi_block. */
enum { RBDI_REVOLUTE, RBDI_REVOLUTE_CS, RBDI_SCREW, RBDI_BLOCK };

/* Flags for operations that a link's constants make necessary. The algorithms take the flags as an argument:
   the common combinations are compiled with constant flags (see RBDI_BY_FLAGS). */
enum {
    RBDI_BRANCH_TURN = 1, /* the frame is turned about the parent's z before the twist */
    RBDI_SHIFT_XYZ = 2,   /* RBDI_BRANCH_TURN, or the parent-side shift has a y or z component */
    RBDI_SHIFT_Z = 4,     /* the shift along the link's z is not always zero */
    RBDI_MASS_KEPT = 8,   /* Sigma_zz, h_z or m were not regrouped away */
    RBDI_ARMATURE = 16,   /* some degree of freedom of the joint has armature */
    RBDI_ROOT = 32,       /* the parent is the world */
    RBDI_SLIDES = 64,     /* kind is RBDI_SCREW; 128 and 256: RBDI_TWIST_90 and RBDI_TWIST_0, of alpha */
    RBDI_SHIFT_R = 512,   /* the parent-side shift is not zero */
    RBDI_OFF_CHAIN = 1024 /* not a simple link of a chain: a root, a block, a branch point, a link i whose
                               parent is not link i - 1, or one without Denavit and Hartenberg's form */
};

/* A moving link, see [design]. From the parent's frame: shift by r, turn by beta about z, twist by alpha
   about x, turn by rho q + gamma about z, slide by d + kappa q along z. A block has its pose in an
   rbdi_block. */
typedef struct rbdi_link {
    int16_t parent; /* an earlier link, -1 = world */
    int16_t iq, iv; /* first coordinate and degree of freedom */
    int16_t block;  /* index into blocks, -1 = none */
    int16_t branch; /* a branch point's index into rbd_work.branch; -1: its child, if any, is the next link */
    int16_t first, end; /* dofs of the subtree: rbd_model.order[first] .. [end - 1], its own first */
    int16_t kind, flags;
    rbd_const cg, sg;          /* cosine and sine of the joint angle at q = 0 */
    rbd_const quarters, gamma; /* that angle: 0 to 3 right angles, and the rest, at most 45 degrees */
    rbd_const ca, sa, cb, sb;  /* cosines and sines of alpha and beta */
    rbdi_c3 r;                 /* parent axes; y = z = 0 unless RBDI_SHIFT_XYZ */
    rbd_const d;               /* along the link's z */
    rbd_const rho, kappa;      /* turn and slide per unit of q */
    rbdi_csym Sigma;           /* regrouped second moment of mass about the origin, link axes */
    rbdi_c3 h;                 /* regrouped first moment */
    rbd_const mass;            /* regrouped mass */
    rbd_const subtree_mass;    /* its sum over the subtree */
} rbdi_link;

/* A joint whose motion axes are unit spatial axes first .. first + n - 1 of the link frame. */
typedef struct rbdi_block {
    int16_t type;     /* rbd_joint_type: spherical, planar, translation or floating */
    int16_t first, n; /* axes are counted omega_x .. omega_z, v_x .. v_z */
    int16_t identity; /* E is the identity */
    rbd_const E[9];   /* turns parent vectors into the joint frame, row-major */
} rbdi_block;

/* A degree of freedom; those that mimic others follow the nv that do not. */
typedef struct rbdi_dof {
    int16_t body;   /* index in the description */
    int16_t lambda; /* parent in the matrix's elimination tree, -1 = none (RBDA 6.5; see rbdi_emit_tree) */
    int32_t row;    /* where its row starts in the packed tree matrix; the diagonal is its last entry */
    int16_t depth; /* number of ancestors in that tree. Of mimic dofs lambda, row and depth have no meaning */
    int16_t before, level; /* parent and number of ancestors in the mechanism, of mimic dofs too */
    rbd_const armature, damping, friction;
    rbd_const scale; /* bound of the inertia that it moves; a pivot below RBDI_DOUBT scale is in doubt */
} rbdi_dof;

/* The dof at this index of the solver's order, depth first, and where the row of level + 1 entries begins
   that crba writes for it: the dof's own row or, with mimic joints, one behind the packed matrix. */
typedef struct rbdi_order {
    int16_t dof;
    int32_t row;
} rbdi_order;

/* A dof of the packed matrix, in a depth-first order of its tree: its descendants follow it. */
typedef struct rbdi_node {
    int16_t dof, descendants;
    int32_t row; /* dof[].row */
} rbdi_node;

/* A mimic joint: coordinate iq = ratio * q[source_q] + offset. */
typedef struct rbdi_mimic {
    int16_t source_q, source_v;
    rbd_const ratio, offset;
} rbdi_mimic;

/* A body of the description as seen by the user: its frame on a link, and its own inertia. */
typedef struct rbdi_frame {
    const char *name, *joint;
    int16_t link;   /* that carries it, -1 = world */
    int16_t parent; /* body, -1 = world */
    int16_t type;   /* rbd_joint_type */
    int16_t iq, nq, iv, nv;
    rbd_const E[9]; /* turns link vectors into body vectors, row-major */
    rbdi_c3 r;      /* origin in the link frame */
    rbd_const mass;
    rbdi_c3 com; /* body frame */
    rbdi_csym I; /* about the centre of mass, body axes */
    rbd_const lower, upper, velocity, effort;
} rbdi_frame;

#define RBDI_SHAPE 3 /* words of rbd_model.shape */

struct rbd_model {
    int16_t version, scalar; /* RBD_MODEL_VERSION, sizeof(rbd_const) */
    int16_t nb, nq, nv;      /* bodies, coordinates, degrees of freedom */
    int16_t nl, nblock, nbranch, nmimic;
    int32_t nh;              /* entries of the packed tree matrix */
    int32_t nhx;             /* with mimic joints: entries of the rows behind it, for the mechanism's dofs */
    rbdi_c3 gravity;         /* world frame */
    const rbdi_link *link;   /* nl, depth first */
    const rbdi_block *block; /* nblock */
    const rbdi_dof *dof;     /* nv + nmimic */
    const rbdi_order *order; /* nv + nmimic */
    const rbdi_node *node;   /* nv */
    const rbdi_mimic *mimic; /* nmimic */
    const rbdi_frame *frame; /* nb, in the description's order */
    uint32_t features;       /* rbdi_features */
    uint64_t shape[RBDI_SHAPE]; /* determines the sizes of a work and a batch: rbdi_shape */
};

/* For a built model as a table, which rbd-model writes: declared in every file, defined in one. */
#define RBDI_TABLE_SYMBOL(name) RBDI_PASTE(name, RBD_CONST)
#ifdef RBD_STATIC
#define RBDI_TABLE static RBDI_THERE
#define RBDI_TABLE_DECLARATION(name)
#elif defined __cplusplus
#define RBDI_TABLE
#define RBDI_TABLE_DECLARATION(name) extern "C" const rbd_model name;
#else
#define RBDI_TABLE
#define RBDI_TABLE_DECLARATION(name) extern const rbd_model name;
#endif

/* ==== src/model/work.h ==== */
/* Interface: rbdi_block_work, rbdi_branch, rbdi_kin, rbdi_scratch, RBDI_FIXED_STRIDE, RBDI_LINKS,
   RBDI_NOTE_DOUBT, RBDI_NO_KINEMATICS */

typedef struct rbdi_scratch { /* per link, during one call */
    rbdi_force f;             /* rnea: wrench; aba: pA; children that are not the next link add theirs */
    rbdi_motion c;            /* aba: velocity-product acceleration; rbdi_momenta: velocity */
    rbdi_force U_D;           /* aba: U / D */
    rbd_real u_D;             /* aba: u / D */
} rbdi_scratch;

typedef struct rbdi_branch { /* per branch point: a link with a child that is not the next link; [design] */
    rbdi_state state;        /* for those children, in rnea and kinematics; aba's pass 1: omega */
    rbdi_motion y;           /* for them, in aba's pass 3 */
    rbdi_abi I; /* sum of their IA, in aba's pass 2; pass 1 clears it; rbdi_check_bodies: of their K */
    rbdi_rbi C; /* sum of their composite bodies, in crba */
} rbdi_branch;

typedef struct rbdi_block_work { /* per block */
    rbdi_pose X;
    rbd_real U_D[6][6], u_D[6]; /* aba: U / D and u / D of each of its dofs */
} rbdi_block_work;

typedef struct rbdi_kin { /* per link, kept for the calls after rbd_kinematics */
    rbdi_pose X;          /* axes and origin in the world */
    rbdi_v3 v;            /* velocity of the origin, link axes */
    rbdi_state state;     /* without gravity */
} rbdi_kin;

/* The arrays of a work: type, name, length. nl links, nblock blocks, nbranch branch points; ndof dofs and
   nqx coordinates with those of mimic joints (nqx = 0 without mimic joints), nv dofs without them; nh
   packed entries. */
#define RBDI_WORK_ARRAYS(ARRAY, nl, nblock, nbranch, ndof, nqx, nv, nh) \
    ARRAY(rbd_real, angle, RBDI_PADDED(nl))         /* joint angles less these right angles */ \
    ARRAY(rbd_real, quarters, RBDI_PADDED(nl))      /* right angles */ \
    ARRAY(rbd_real, cosine, RBDI_PADDED(nl))        /* of the whole angles */ \
    ARRAY(rbd_real, sine, RBDI_PADDED(nl))          /* of the whole angles */ \
    ARRAY(ptrdiff_t, start, RBDI_PADDED_STARTS(nv)) /* [packed matrix]: where rows of a matrix begin */ \
    ARRAY(rbdi_branch, branch, nbranch) \
    ARRAY(rbdi_block_work, block, nblock) \
    ARRAY(rbd_real, d, nl) /* slides of screw links */ \
    ARRAY(rbdi_scratch, scratch, nl) \
    ARRAY(rbdi_kin, kin, nl) \
    ARRAY(rbd_real, rotors, 1)   /* kinetic energy of the armatures */ \
    ARRAY(rbd_real, zero, ndof)  /* zeros */ \
    ARRAY(rbd_real, pivot, ndof) /* pivots of the last factorisation or, where one is in doubt, verdicts */ \
    ARRAY(rbd_real, bias, nv) \
    ARRAY(rbd_real, F, 6 * RBDI_STRIDE(ndof)) /* scratch of a call, behind RBDI_CHUNK zeros */ \
    ARRAY(rbd_real, H, nh) \
    ARRAY(rbd_real, qx, nqx) /* coordinates with the mimics' appended */ \
    ARRAY(rbd_real, vx, (nqx) > 0 ? (ndof) : 0) \
    ARRAY(rbd_real, ax, (nqx) > 0 ? (ndof) : 0) \
    ARRAY(rbd_real, tx, (nqx) > 0 ? (ndof) : 0)
#define RBDI_PADDED(n) (RBDI_ROUND((size_t)(n) * sizeof(rbd_real)) / sizeof(rbd_real))
#define RBDI_PADDED_STARTS(n) (RBDI_ROUND((size_t)(n) * sizeof(ptrdiff_t)) / sizeof(ptrdiff_t))
#define RBDI_ARRAY_FIELD(type, name, length) type *name;
#define RBDI_ARRAY_BYTES(type, name, length) +(size_t)(length) * sizeof(type)

enum { RBDI_NO_KINEMATICS = -2 };

struct rbd_work {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbdi_c3 gravity;
    int singular;          /* dof, -1 = none */
    int16_t kinematics_of; /* kin: of this link and its ancestors; nl: of all; -1: of the world alone */
    int16_t moving;        /* whether kin has velocities and accelerations; else rbdi_body_kin makes them 0 */
#if RBDI_REPRODUCIBLE
    int doubt; /* a pivot or a rank has been in doubt: see rbdi_batch_singly */
#endif
    RBDI_WORK_ARRAYS(RBDI_ARRAY_FIELD, 0, 0, 0, 0, 0, 0, 0)
};

#if RBDI_REPRODUCIBLE
#define RBDI_NOTE_DOUBT(w, x) (w)->doubt = (x)
#else
#define RBDI_NOTE_DOUBT(w, x) (void)(w)
#endif

/* From one component of crba's wrenches to the next, of n dofs. Where memory is plenty it is a constant for
   up to 64 dofs, which saves a tenth of the mass matrix's time, a fifth in lanes. */
#if (defined __x86_64__ || defined __aarch64__) && RBDI_REAL_KIND % 3
#define RBDI_FIXED_STRIDE 80
#else
#define RBDI_FIXED_STRIDE 0
#endif
#define RBDI_STRIDE(n) ((n) + RBDI_CHUNK > RBDI_FIXED_STRIDE ? (n) + RBDI_CHUNK : RBDI_FIXED_STRIDE)
#define RBDI_WORK_BYTES(nl, nblock, nbranch, ndof, nqx, nv, nh) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_work)) \
                      RBDI_WORK_ARRAYS(RBDI_ARRAY_BYTES, nl, nblock, nbranch, ndof, nqx, nv, nh))

/* Most links that nb bodies with nv dofs can have: universal and cylindrical joints have two, Euler joints
   three. Branch points have at least two children, blocks at least three dofs. */
#define RBDI_LINKS(nb, nv) ((nb) + 2 * (nv) / 3)

/* Bytes that suffice for the work of any model with nb bodies and nv degrees of freedom, without or with
   mimic joints (a compile-time bound; rbd_work_size is exact). */
#define RBD_WORK_SIZE(nb, nv) \
    RBDI_WORK_BYTES(RBDI_LINKS(nb, nv), (nv) / 3, RBDI_LINKS(nb, nv) / 2, nv, 0, nv, RBDI_TRIANGLE(nv))
#define RBD_WORK_SIZE_MIMIC(nb, nv) \
    RBDI_WORK_BYTES(RBDI_LINKS(nb, nv), (nv) / 3, RBDI_LINKS(nb, nv) / 2, (nb) + (nv), (nb) + 2 * (nv) + 1, \
                    nv, RBDI_TRIANGLE(nv) + RBDI_TRIANGLE((nb) + (nv)))
#define RBDI_TRIANGLE(n) ((size_t)(n) * ((size_t)(n) + 1) / 2)

/* The arrays of a model of nb bodies, and of its build: type, name, length. */
#define RBDI_MODEL_ARRAYS(ARRAY, nb, nl, nblock, ndof, nmimic) \
    ARRAY(rbdi_link, link, nl) \
    ARRAY(rbdi_block, block, nblock) \
    ARRAY(rbdi_dof, dof, ndof) \
    ARRAY(rbdi_order, order, ndof) \
    ARRAY(rbdi_node, node, ndof) \
    ARRAY(rbdi_mimic, mimic, nmimic) \
    ARRAY(rbdi_frame, frame, nb) \
    ARRAY(rbdi_build_link, links, nl) \
    ARRAY(rbdi_place, place, nb)
#define RBDI_ROUNDED_BYTES(type, name, length) +RBDI_ROUND((size_t)(length) * sizeof(type))
#define RBDI_MODEL_BYTES(nb, nl, nblock, ndof, nmimic) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_model)) \
                      RBDI_MODEL_ARRAYS(RBDI_ROUNDED_BYTES, nb, nl, nblock, ndof, nmimic))

/* Bytes that suffice to build any model of nb bodies (a compile-time bound; rbd_model_size is exact). */
#define RBD_MODEL_SIZE(nb) RBDI_MODEL_BYTES(nb, 3 * (nb), nb, 6 * (nb), nb)

/* ==== src/rbd.h ==== */
#endif /* RBDI_LAYOUT */

/* rbd_spatial.h uses the sections before [common], in files without the implementation too. */
#if defined RBD_IMPLEMENTATION || defined RBDI_WITH_ALGEBRA
#ifndef RBDI_ALGEBRA
#define RBDI_ALGEBRA

/* ---- design [design] ----
   Featherstone, Rigid Body Dynamics Algorithms (2008), is "the book", or RBDA, below. The algorithms are its
   tables 5.1, 6.2, 6.3 and 7.1. The build computes their constants once, in frames that make them fast:

   Frames. Every link of a one-axis joint has its axis on z. Turning its frame about z or shifting it along z
   changes no result. The build uses this freedom to give the transform from the parent the form of Denavit
   and Hartenberg (Khalil and Dombre 2002, ch. 3): shift by r = (a, 0, 0) along the parent's x, twist by alpha
   about x, turn by rho q + gamma about z, slide by d + kappa q along z. A turn about one axis costs four
   multiplications, by 90 or 0 degrees none; -90 degrees become 90 with the parent's frame turned by 180
   about its z. Only one child of a link can have this form, and no child of the world or of a block, nor one
   whose axis is nearly parallel. The others keep a general shift r and a turn by beta about the parent's z
   before the twist. The user's frame of a body is a constant pose on its link (rbdi_frame).

   Second moments. Inertia is kept as Sigma = integral of x x' dm = tr(I)/2 - I, with h = integral of x dm =
   m c and the mass: [Sigma h; h' m] changes frame like x x' itself, and the wrench of a link costs less in
   Sigma than in I.

   Regrouping (Khalil and Gautier 1990; Gautier 1990). Inertia that a joint's motion does not change moves to
   the parent: of a revolute link Sigma_zz, h_z and m (seven of ten constants remain), of a sliding one all of
   Sigma (four remain); others: rbdi_build_regroup. M, c and tau are the same. Afterwards m and Sigma of a
   link may be zero or negative.

   Classical accelerations. The state of a link is omega, its rate, and the acceleration of the frame's origin
   as a point (gravity: the world accelerates upward). A point x of the link accelerates by acc + Omega x,
   Omega = [omega_dot]x + [omega]x [omega]x. The wrench for this is f = Omega h + m acc, n = axial part of
   (Omega Sigma + acc h'). No linear velocity is needed, because Omega has omega x (omega x r).
   rbd_body_acceleration subtracts omega x v, which gives the spatial acceleration. For floating and planar
   joints, whose v is in body axes, c contains it (rbdi_joint_product).

   Cyclic axes. The turn about x is the turn about z with the axes renamed, (x, y, z) -> (y, z, x): _cycle
   renames, _uncycle renames back.

   Order. Links are in depth-first order. After each link comes its child with the largest subtree (under a
   one-axis link a one-axis child before blocks). So the parent is mostly link i - 1, and the quantities
   passed between the two stay in registers: up F, IA and pA, or the composite C (`carried` in rnea and crba),
   down s, y or omega. A link with further children is a branch point. Its rbdi_branch in memory keeps state
   and y for them and sums their IA and C. Their wrenches are added to the parent's scratch.f:

             0 -- 1 -- 2          links 0 .. 5; parents -1 0 1 1 0 4
             |    '--- 3          links 0 and 1 are branch points, for 4 and 3
             '--- 4 -- 5          through registers: 1, 2, 5; through memory: 3, 4

   So the dofs of a subtree are contiguous in the solver's order, order[]: link.first .. end - 1.

   Blocks. A joint with several axes through one point (spherical, planar, translation, floating) is a block:
   its pose is computed per state, and its functions are called name_block. Universal, cylindrical and Euler
   joints are chains of one-axis links, massless but for the last. "down" takes a vector from the parent's
   frame to the child's, "up" back. rnea: one pass down (forward), one up. aba: pass 1 down (velocities), pass
   2 up (articulated inertias), pass 3 down (accelerations).

   Headers that build on this one are implemented in the same file by the same RBD_IMPLEMENTATION. They keep
   memory of their own and check RBD_VERSION_NUMBER and RBD_MODEL_VERSION. They use what the comments
   "Interface" below name, and all of base/ and algebra/.

   To write a new algorithm, begin with a copy of rbdi_rnea: first rbdi_joints; down rbdi_forward; up one pass
   with rbdi_force_up or _block, which passes forces to link i - 1 or adds them at link[i].parent. For linear
   velocities see rbdi_kin.v.

     the book               here
     i, lambda(i)           i, link[i].parent
     S_i                    z; of a screw rho, kappa; of a block axes first .. first + n - 1
     iX_lambda(i)           rbdi_down (vectors), rbdi_pose; transposed: rbdi_force_up, _rbi_up, _abi_up
     v_i, a_i               rbdi_state: omega, omega_dot, acc (no linear v); aba's pass 3: y
     I_i, I^c_i             Sigma, h, mass of rbdi_link; rbdi_rbi and subtree_mass
     I^A_i, p^A_i           IA = [I H; H' M] (rbdi_abi), pA
     U_i, D_i, u_i          U, D, u; kept as U_D = U/D, u_D = u/D
     c_i (7.1), f_i, tau_i  scratch.c, scratch.f (aba: pA_i), tau
     H, L, D (chapter 6)    packed rows: dof[k].row, by the path to the root
     lambda(k) (6.5)        dof[k].lambda

   In IA = [I H; H' M], H and M are blocks; elsewhere M is the mass matrix and H its packed rows. A prime is
   the transpose. */

/* ==== src/base/compiler.h ==== */
#ifndef RBDI_BASE_COMPILER_H
#define RBDI_BASE_COMPILER_H
#include <float.h>

/* ---- compiler [compiler] ----
   Only this section and [configuration], for vector types and C99, depend on the compiler and its target. */

/* Options that void results. Other parts of -ffast-math do no harm: -freciprocal-math, -fno-signed-zeros,
   -fno-trapping-math, -fno-math-errno. */
#if defined __FAST_MATH__ || defined __ASSOCIATIVE_MATH__ || defined _M_FP_FAST || \
    (defined __USE_FAST_MATH__ && __USE_FAST_MATH__ + 0) /* NVRTC has 0 or 1 */
#error \
    "rbd: -ffast-math or -funsafe-math-optimizations reassociates the sine's argument reduction and voids \
the pivot checks; use -O3 -ffp-contract=fast instead"
#elif defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0
#error "rbd: -ffinite-math-only removes the checks for NaN and overflow; compile without it"
#elif RBDI_REPRODUCIBLE && (defined __RECIPROCAL_MATH__ || defined __NO_SIGNED_ZEROS__)
#error "rbd: RBD_REPRODUCIBLE: -freciprocal-math and -fno-signed-zeros change bits; compile without them"
#endif

#ifdef __GNUC__ /* GCC's extensions, which clang has too: attributes, vectors, assembly */
#define RBDI_GNU 1
#else
#define RBDI_GNU 0
#endif
#ifdef __clang__
#define RBDI_CLANG 1
#else
#define RBDI_CLANG 0
#endif
#define RBDI_GCC (RBDI_GNU && !RBDI_CLANG && !RBDI_GPU)

/* GCC has no macro for -fsingle-precision-constant, which rounds constants to float. It does no harm if
   rbd_real is float. */
#if RBDI_REAL_KIND != 2
typedef char rbd_needs_no_fsingle_precision_constant[sizeof 1.0 == sizeof(double) ? 1 : -1];
#endif

/* rbdi_require_ieee() does not compile where sums are reassociated, or NaN or infinity has no meaning. clang
   has no macro for most of this, and GCC's pragmas set none in C++. A compiler that optimises then knows
   beforehand what (x + 1) - x is, that x <= x, or that x is not infinite. One that does not optimise changes
   nothing. */
#if RBDI_GNU && !RBDI_GPU && defined __OPTIMIZE__ && defined __has_attribute
#if __has_attribute(error)
#define RBDI_SHOWS_OPTIONS 1
#endif
#endif
#ifdef RBDI_SHOWS_OPTIONS
#if RBDI_CLANG
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wunknown-warning-option"
#pragma clang diagnostic ignored "-Wnan-infinity-disabled" /* says the same, but does not stop */
#endif
__attribute__((error(
    "rbd: -fassociative-math, part of -funsafe-math-optimizations, voids the sine and the checks"))) void
rbdi_sums_are_reassociated(void);
__attribute__((error(
    "rbd: -ffinite-math-only, -fno-honor-nans and -fno-honor-infinities remove the checks for NaN"))) void
rbdi_nan_is_lost(void);

static inline void rbdi_require_ieee(void) {
    const volatile double unknown = 0;
    const double x = unknown;
    if (__builtin_constant_p((x + 1) - x)) rbdi_sums_are_reassociated();
    if (__builtin_constant_p(x <= x) || __builtin_constant_p(__builtin_isinf_sign(x))) rbdi_nan_is_lost();
}
#if RBDI_CLANG
#pragma clang diagnostic pop
#endif
#else
static inline RBDI_BOTH void rbdi_require_ieee(void) {}
#endif

#if defined __OPTIMIZE__ && !defined __OPTIMIZE_SIZE__
#define RBDI_FOR_SPEED 1
#else
#define RBDI_FOR_SPEED 0
#endif
#ifdef __SOFTFP__ /* without a floating-point unit each operation is a call */
#define RBDI_HARD_FLOAT 0
#else
#define RBDI_HARD_FLOAT 1
#endif

/* Doubles in one SIMD register, 0 without SIMD. With AVX-512 half a register: the rows of one state are
   short, and whole registers made single calls slower (Intel, Cholesky of Atlas by a third). Lanes may be
   longer: RBD_LANES. */
#if RBDI_GPU
#define RBDI_SIMD 0
#elif defined __AVX__
#define RBDI_SIMD 4
#elif defined __SSE2__ || (defined __ARM_NEON && defined __aarch64__) || defined __wasm_simd128__
#define RBDI_SIMD 2
#else
#define RBDI_SIMD 0
#endif
#if RBDI_SIMD > RBDI_WIDEST_SIMD
#error "rbd: RBDI_WIDEST_SIMD, for which memory is sized, must be at least RBDI_SIMD"
#endif
#ifdef __has_builtin
#if __has_builtin(__builtin_shufflevector)
#define RBDI_HAS_SHUFFLE 1
#endif
#endif
#ifndef RBDI_HAS_SHUFFLE
#define RBDI_HAS_SHUFFLE 0
#endif

/* Whether products and sums are rounded to the scalar. FLT_EVAL_METHOD -1 and 2 keep more digits, 1 rounds
   double alone. Other values concern types that are not used here, such as 16 in GCC's default dialects for a
   half precision unit. tcc does not define it. */
#ifdef __FLT_EVAL_METHOD__
#define RBDI_EVALUATION __FLT_EVAL_METHOD__
#elif defined FLT_EVAL_METHOD
#define RBDI_EVALUATION FLT_EVAL_METHOD
#elif defined __TINYC__ && !defined __i386__
#define RBDI_EVALUATION 0
#else
#define RBDI_EVALUATION -1
#endif
#if RBDI_EVALUATION == 0 || RBDI_EVALUATION > 2 || (RBDI_EVALUATION == 1 && RBDI_REAL_KIND == 1)
#define RBDI_ROUNDS 1
#else
#define RBDI_ROUNDS 0
#if RBDI_REPRODUCIBLE
#error "rbd: RBD_REPRODUCIBLE: x87 keeps more digits (use SSE2), and s390x those of double (use -std=gnu99)"
#endif
#endif

#if RBDI_REPRODUCIBLE
#define RBDI_CONTRACTION "fp-contract=off"
#else
#define RBDI_CONTRACTION "fp-contract=fast"
#endif
/* GCC's vectoriser packs the scalars of 3-vectors, which costs time. GCC turns loops that clear a few numbers
   into calls of memset, and its ISO modes switch contraction to FMA off. clang needs none of this. */
#if RBDI_GCC && defined __OPTIMIZE__
#define RBDI_PRAGMA(text) _Pragma(#text)
#define RBDI_OPTIMIZE_WITH(level, contraction) \
    RBDI_PRAGMA(GCC optimize(level "no-tree-slp-vectorize,no-tree-vectorize," \
                                   "no-tree-loop-distribute-patterns," contraction))
#define RBDI_OPTIMIZE(level) RBDI_OPTIMIZE_WITH(level, RBDI_CONTRACTION)
#define RBDI_CODE_BEGIN _Pragma("GCC push_options") RBDI_OPTIMIZE("")
#define RBDI_CODE_END _Pragma("GCC pop_options")
#else
#define RBDI_CODE_BEGIN
#define RBDI_CODE_END
#endif

/* Dynamics at -Os: no code is compiled for special cases (RBDI_FOR_SPEED), which halves it. GCC's level 2
   then makes it 6 % larger and saves a fifth of the instructions. All options stand in one list, because a
   level undoes earlier ones. */
#if RBDI_GCC && defined __OPTIMIZE_SIZE__
#define RBDI_DYNAMICS_BEGIN _Pragma("GCC push_options") RBDI_OPTIMIZE("O2,")
#else
#define RBDI_DYNAMICS_BEGIN RBDI_CODE_BEGIN
#endif

/* The build of a model, which runs once: at GCC's -Os it is a third smaller. It has the contraction of the
   command line. */
#if RBDI_GCC && RBDI_FOR_SPEED && RBDI_REPRODUCIBLE
#define RBDI_BUILD_BEGIN _Pragma("GCC push_options") RBDI_PRAGMA(GCC optimize("Os,fp-contract=off"))
#elif RBDI_GCC && RBDI_FOR_SPEED
#define RBDI_BUILD_BEGIN _Pragma("GCC push_options") RBDI_PRAGMA(GCC optimize("Os"))
#elif RBDI_GCC && defined __OPTIMIZE__
#define RBDI_BUILD_BEGIN _Pragma("GCC push_options")
#else
#define RBDI_BUILD_BEGIN
#endif

/* RBDI_INLINE: vector algebra, and the steps that are compiled once for each common set of link flags. Where
   the compiler optimises it always inlines them: to pass vectors in memory would take ten times as long at
   -Os, and save a fifth of the code. RBDI_PART: all others; a build may leave them unused. */
#if RBDI_GNU && (defined __OPTIMIZE__ || RBDI_GPU)
#define RBDI_INLINE static inline RBDI_BOTH __attribute__((always_inline, unused))
#else
#define RBDI_INLINE static inline RBDI_BOTH RBDI_UNUSED
#endif
/* RBDI_ONCE: inlined where the compiler optimises for speed; at -Os there is one copy for all callers. */
#if RBDI_FOR_SPEED
#define RBDI_ONCE RBDI_INLINE
#else
#define RBDI_ONCE RBDI_PART
#endif
#if RBDI_GNU
#define RBDI_COLD static RBDI_BOTH __attribute__((noinline, cold, unused)) /* hardly ever called */
#else
#define RBDI_COLD static RBDI_BOTH RBDI_UNUSED
#endif
#if RBDI_GPU && RBDI_GNU /* nvcc would inline them everywhere: three times the code */
#define RBDI_PART static RBDI_BOTH __attribute__((noinline, unused))
#else
#define RBDI_PART static RBDI_UNUSED
#endif
/* RBDI_LOCAL: steps of a room that something calls wherever the room is compiled; a compiler warns where
   nothing does. */
#define RBDI_LOCAL static RBDI_BOTH
/* For a function that returns one of many texts. GCC would keep them in an array, which is linked even if
   nothing calls the function, as soon as the file has any other text, such as a model's names. */
#if RBDI_GCC
#define RBDI_MESSAGES __attribute__((optimize("no-tree-switch-conversion")))
#else
#define RBDI_MESSAGES
#endif
/* Unrolls short loops, such as those over six components; clang does so by itself. */
#if RBDI_GCC && RBDI_FOR_SPEED
#define RBDI_UNROLL_SIX _Pragma("GCC unroll 6")
#define RBDI_UNROLL_ROW _Pragma("GCC unroll 8")
#define RBDI_UNROLL_TWO _Pragma("GCC unroll 2")
#else
#define RBDI_UNROLL_SIX
#define RBDI_UNROLL_ROW
#define RBDI_UNROLL_TWO
#endif
/* Keeps one address for all columns of a row. Without it the compiler computes one for each column. */
#if RBDI_GNU && !RBDI_GPU
#define RBDI_ONE_INDEX(row) __asm__("" : "+r"(row))
#else
#define RBDI_ONE_INDEX(row) (void)(row)
#endif
#endif

/* ==== src/rbd.h ==== */
RBDI_CODE_BEGIN

/* ==== src/base/tolerances.h ==== */
#ifndef RBDI_BASE_TOLERANCES_H
#define RBDI_BASE_TOLERANCES_H
/* ---- tolerances [tolerances] ----
   RBDI_EPS is one rounding of the scalar, RBDI_TINY the least pivot whose inverse is finite;
   RBDI_LEAST_SCALE is so large that every pivot up to RBDI_TINY is in doubt.

   A pivot below RBDI_DOUBT times dof.scale, the largest inertia that its joint can move, is in doubt. Such a
   pivot must exceed RBDI_NOISE times e, a bound of the terms whose difference it is, or it is singular: 32
   roundings, because a pivot is a sum of many terms. The largest pivot that was rounding in 20,000 singular
   models had 15 of rbd_aba and 4.3 of the factor (tests/one_word.c). [pivots] derives the rest.

   An exact pivot can be rounding too: an axis that should go through a mass m misses it by L eps, L the
   distance to the frame that it is described in, and the pivot is m (L eps)^2. dof.scale has RBDI_ROD m L^2
   in it. With RBDI_ROD = 16 eps / RBDI_DOUBT a pivot up to 16 eps m L^2 is in doubt, and one up to
   RBDI_NOISE RBDI_SHARE RBDI_ROD m L^2 is singular: 2.5e-26 m L^2, far above the 5e-32 m L^2 of a rounding,
   and far below any real robot, whose radius of gyration would be 2e-13 L. In float 1e-21 m L^2, for
   descriptions are double. The factor has a quarter in place of RBDI_SHARE.

   RBDI_SHARE: of dof.scale in rbd_aba's e. A chain of n rods has a dof.scale of n^3/3 rods: with a much
   larger share float chains of 200 rods are refused, with a much smaller one the rounding of a description
   passes.
   RBDI_TURN: a change of frame rounds by this share of RBDI_NOISE, a third of eps. It compounds along a
   chain: a larger one refuses float chains of 200 rods.
   RBDI_FAR: a joint that has slid by more than 4 times the size of what it moves is a doubt, see
   rbdi_slid_far. Ten times more lets rounding of 160 eps dof.scale pass, far below RBDI_DOUBT dof.scale; ten
   times less costs time alone.

   Tests see RBDI_DOUBT by the verdicts of RBDI_ROD. A larger one costs time alone otherwise. */

#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_EPS 2.220446049250313e-16
#define RBDI_DOUBT 1e-7
#define RBDI_SHARE 1e-4
#define RBDI_TINY 2.2250738585072014e-308
#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_EPS 1.1920929e-7f
#define RBDI_DOUBT 1e-3f
#define RBDI_SHARE 1e-4f
#define RBDI_TINY 1.17549435e-38f
#else
#define RBDI_EPS RBD_C(1.925929944387236e-34)
#define RBDI_DOUBT RBD_C(1.4e-17)
#define RBDI_SHARE RBD_C(0.25) /* descriptions are double, their rounding is far above eps */
#define RBDI_TINY RBD_C(2.2250738585072014e-308)
#endif
#define RBDI_LEAST_SCALE (RBDI_TINY / RBDI_DOUBT)
#ifndef RBDI_NOISE                 /* tests/fuzz/pivots.c sets it to 0 */
#define RBDI_NOISE (32 * RBDI_EPS) /* of its bound a pivot must exceed this */
#endif
#ifndef RBDI_TURN /* tests/test_bounds.c sets it to 0 */
#define RBDI_TURN RBD_C(0.01)
#endif
#define RBDI_FAR RBD_C(16) /* a square */
#define RBDI_BUILD \
    RBD_C(2.220446049250313e-16 / (double)RBDI_EPS) /* the build's rounding: descriptions are double */
#define RBDI_ROD (16 * (rbdi_wide)2.220446049250313e-16 / (rbdi_wide)RBDI_DOUBT) /* see rbdi_build_scale */

#define RBDI_FASTEST RBD_C(1e12)   /* m/s or rad/s: a step that makes more has overflowed, or would */
#define RBDI_UNBOUNDED RBD_C(1e30) /* as a bound or limit: none; as a residual: none could be computed */
#define RBDI_SHORT RBD_C(1e-30)    /* square of the shortest quaternion or (cos, sin) that has a direction */
#define RBDI_NO_ANGLE RBD_C(1e-30) /* added to squares of angles: quotients stay finite, no digit changes */
#define RBDI_TAIL_TERMS 15         /* of the series of sine and cosine for |x| < 1: 1/33! is below 1e-36 */
#define RBDI_ANGLE_START 0.43 /* t (2 - 0.43 t^2) for 2 atan(t), |t| < 1: within 0.02, cubed four times */
#define RBDI_SNAP \
    ((rbdi_wide)1e-12) /* rad: angles this close to a multiple of 90 degrees are taken as that */
#define RBDI_PARALLEL \
    ((rbdi_wide)1e-6)          /* sine of the angle below which axes of a universal joint are parallel */
#define RBDI_ORTHONORMAL 4e-6  /* of products of the rows of a rotation: six decimals in a file will do */
#define RBDI_SEMIDEFINITE 1e-9 /* share of an inertia by which a principal moment may seem negative */
#endif

/* ==== src/base/scalar.h ==== */
#ifndef RBDI_BASE_SCALAR_H
#define RBDI_BASE_SCALAR_H
/* ---- scalar [scalar] ---- */

#if RBDI_REAL_KIND == 3 || RBDI_KIND(RBD_CONST) == 3
#ifdef __cplusplus
extern "C" {
#endif
RBDI_EXTENSION __float128 sinq(__float128 x);
RBDI_EXTENSION __float128 cosq(__float128 x);
RBDI_EXTENSION __float128 sqrtq(__float128 x);
#ifdef __cplusplus
}
#endif
#endif
#include <math.h>

#if RBDI_REAL_KIND == 2
#define RBDI_LIBM(name) name##f
#elif RBDI_REAL_KIND == 3
#define RBDI_LIBM(name) name##q
#else
#define RBDI_LIBM(name) name
#endif
#ifdef RBD_SIN
#define RBDI_OWN_SINCOS
#if RBDI_REPRODUCIBLE
#error "rbd: RBD_REPRODUCIBLE needs rbd's own sine: leave RBD_SIN and RBD_COS undefined"
#endif
#else
#define RBD_SIN(x) RBDI_LIBM(sin)(x)
#define RBD_COS(x) RBDI_LIBM(cos)(x)
#endif

/* MinGW's square root computes in 80 bits and rounds twice, the processor's own once. */
#if defined __MINGW32__ && defined __SSE2__ && RBDI_REAL_KIND != 0
#include <emmintrin.h>
RBDI_INLINE double rbdi_root(double x) { return _mm_cvtsd_f64(_mm_sqrt_sd(_mm_set_sd(x), _mm_set_sd(x))); }
RBDI_INLINE float rbdi_rootf(float x) { return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))); }
#else
#define rbdi_root sqrt
#define rbdi_rootf sqrtf
#endif
#define rbdi_rootq sqrtq
#ifndef RBD_SQRT
#define RBD_SQRT(x) RBDI_LIBM(rbdi_root)(x)
#endif

/* pi to quad precision, as a sum of doubles: a longer literal would be rounded to double. */
#define RBDI_PI(type) \
    ((type)3.141592653589793116 + (type)1.2246467991473532e-16 + (type) - 2.9947698097183397e-33)

/* A scalar is one number or, with RBD_LANES, a vector with a number for each state. A mask is the result of a
   comparison; with lanes it holds in some and not in others. */
#ifdef RBD_LANES
#if RBDI_REAL_KIND == 2
typedef int32_t rbdi_int;
#else
typedef int64_t rbdi_int;
#endif
typedef rbdi_int rbdi_mask __attribute__((vector_size(sizeof(rbd_real)))); /* per lane 0 or -1 */

RBDI_INLINE rbd_real rbdi_set(rbd_const c) {
    rbd_real zero = {0};
    return zero + c;
}

RBDI_INLINE rbdi_mask rbdi_less(rbd_real a, rbd_real b) { return (rbdi_mask)(a < b); }
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask a) { return ~a; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) {
    return (rbd_real)(((rbdi_mask)a & mask) | ((rbdi_mask)b & ~mask));
}

RBDI_INLINE int rbdi_any(rbdi_mask mask) {
    rbdi_int any = 0;
    for (int i = 0; i < RBD_LANES; ++i) any |= mask[i];
    return any != 0;
}

RBDI_INLINE rbd_real rbdi_sqrt(rbd_real x) {
    for (int i = 0; i < RBD_LANES; ++i) x[i] = RBD_SQRT(x[i]);
    return x;
}
#else
#ifdef RBD_MASK
typedef RBD_MASK rbdi_mask;
#else
typedef int rbdi_mask;
#endif
RBDI_INLINE rbd_real rbdi_set(rbd_const c) { return (rbd_real)(c); }
RBDI_INLINE rbdi_mask rbdi_less(rbd_real a, rbd_real b) { return a < b; }
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask a) { return !a; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
#ifdef RBD_MASK
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) { return select(mask, a, b); }
#else
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) { return mask ? a : b; }
#endif
RBDI_INLINE int rbdi_any(rbdi_mask mask) { return mask; }
RBDI_INLINE rbd_real rbdi_sqrt(rbd_real x) { return RBD_SQRT(x); }
#endif
RBDI_INLINE rbd_real rbdi_zero(void) { return rbdi_set(RBD_C(0)); }
RBDI_INLINE rbd_real rbdi_abs(rbd_real x) { return rbdi_select(rbdi_less(x, rbdi_zero()), -x, x); }

/* The larger and the smaller of two. If one is NaN these are a and b. */
RBDI_INLINE rbd_real rbdi_larger(rbd_real a, rbd_real b) { return rbdi_select(rbdi_less(a, b), b, a); }
RBDI_INLINE rbd_real rbdi_smaller(rbd_real a, rbd_real b) { return rbdi_select(rbdi_less(a, b), a, b); }

/* Whether x is a finite number, in all lanes. Of infinity and of NaN x - x is NaN. */
RBDI_INLINE int rbdi_is_finite(rbd_real x) {
    return !rbdi_any(rbdi_not(rbdi_less(x - x, rbdi_set(RBD_C(1)))));
}

/* 1 / D if D > threshold, else 0, and bad is set: no division gives infinity. */
RBDI_INLINE rbd_real rbdi_reciprocal(rbd_real D, rbd_const threshold, rbdi_mask *bad) {
    rbdi_mask good = rbdi_less(rbdi_set(threshold), D);
    *bad = rbdi_or(*bad, rbdi_not(good));
    return rbdi_select(good, rbdi_set(RBD_C(1)) / rbdi_select(good, D, rbdi_set(RBD_C(1))), rbdi_zero());
}

/* 1 / D of a pivot, 0 where that would overflow. The pivot is in doubt if it is small beside scale, the
   inertia that it came from: see [tolerances]. */
RBDI_INLINE rbd_real rbdi_pivot_inverse(rbd_real D, rbd_const scale, rbdi_mask *doubt) {
    rbdi_mask tiny = rbdi_less(D, D); /* not asked: such a pivot is in doubt as well */
    *doubt = rbdi_or(*doubt, rbdi_not(rbdi_less(rbdi_set(scale * RBDI_DOUBT), D)));
    return rbdi_reciprocal(D, RBDI_TINY, &tiny);
}
#endif

/* ==== src/base/simd.h ==== */
/* A batch has as many scalars as one SIMD instruction takes: one if there is no SIMD, or if the scalar is a
   vector already. It gathers like quantities: the joints' angles, the wrenches of a subtree. */
#if RBDI_GNU && RBDI_SIMD > 0 && RBDI_REAL_KIND % 3 != 0 && !defined RBD_LANES
#define RBDI_BATCH (RBDI_SIMD * RBDI_REAL_KIND) /* the kind of double is 1, of float 2 */
typedef rbd_real rbdi_batch
    __attribute__((vector_size(RBDI_BATCH * sizeof(rbd_real)), aligned(sizeof(rbd_real)), may_alias));
#else
#define RBDI_BATCH 1
#ifndef RBD_LANES
#define RBDI_BATCH_SCALAR
#endif
typedef rbd_real rbdi_batch;
#endif
#if RBDI_BATCH > RBDI_CHUNK
#error "rbd: RBDI_CHUNK, the padding of rows, must hold a batch"
#endif

#if RBDI_REAL_KIND == 1
typedef uint64_t rbdi_bit;
#elif RBDI_REAL_KIND == 2
typedef uint32_t rbdi_bit;
#endif
/* x in all lanes. */
RBDI_INLINE rbdi_batch rbdi_all_lanes(rbd_real x) {
#if RBDI_BATCH > 1
    const rbdi_batch zero = {0};
    return x - zero; /* x + zero would lose the sign of -0 */
#else
    return x;
#endif
}

#if RBDI_BATCH > 1
typedef rbdi_bit rbdi_bits __attribute__((vector_size(RBDI_BATCH * sizeof(rbd_real))));

/* The batch with x as its k-th scalar. */
RBDI_INLINE rbdi_batch rbdi_insert(rbdi_batch batch, int k, rbd_real x) {
    const rbdi_batch all = rbdi_all_lanes(x);
    rbdi_bits lane;
    for (int i = 0; i < RBDI_BATCH; ++i) lane[i] = (rbdi_bit)i;
    lane = (rbdi_bits)(lane == (rbdi_bit)k);
    return (rbdi_batch)(((rbdi_bits)batch & ~lane) | ((rbdi_bits)all & lane));
}

/* The first n scalars of the batch, and zeros. */
RBDI_INLINE rbdi_batch rbdi_first_lanes(rbdi_batch batch, int n) {
    rbdi_batch lane;
    for (int i = 0; i < RBDI_BATCH; ++i) lane[i] = (rbd_real)i;
    return (rbdi_batch)((rbdi_bits)batch & (rbdi_bits)(lane < (rbd_real)n));
}
#endif

RBDI_INLINE rbd_real rbdi_first_lane(rbdi_batch x) {
#if RBDI_BATCH > 1
    return x[0];
#else
    return x;
#endif
}

/* A sum over all scalars of several batches: lane by lane and, at the end, over the lanes. With
   RBD_REPRODUCIBLE one scalar after the other, so that it does not depend on the length of a batch. */
#if RBDI_REPRODUCIBLE || RBDI_BATCH == 1
typedef rbd_real rbdi_sum;
RBDI_INLINE rbdi_sum rbdi_sum_of_none(void) { return rbdi_zero(); }
RBDI_INLINE rbdi_sum rbdi_sum_and(rbdi_sum sum, rbdi_batch x) {
#if RBDI_BATCH > 1
    for (int j = 0; j < RBDI_BATCH; ++j) sum = sum + x[j];
    return sum;
#else
    return sum + x;
#endif
}

RBDI_INLINE rbd_real rbdi_sum_value(rbdi_sum sum) { return sum; }
#else
typedef rbdi_batch rbdi_sum;
RBDI_INLINE rbdi_sum rbdi_sum_of_none(void) { return rbdi_all_lanes(rbdi_zero()); }
RBDI_INLINE rbdi_sum rbdi_sum_and(rbdi_sum sum, rbdi_batch x) { return sum + x; }
RBDI_INLINE rbd_real rbdi_sum_value(rbdi_sum x) {
    rbd_real sum = x[0];
    for (int j = 1; j < RBDI_BATCH; ++j) sum = sum + x[j];
    return sum;
}
#endif

/* ==== src/base/reduction.h ==== */
/* ---- reduction [reduction] ----
   Angles of any size: x = n pi/2 + r with |r| <= pi/4, after Payne and Hanek (1983). |x| is N 2^(32 a), N a
   whole number of three words of 32 bits. Of 2/pi = sum b_k 2^(-32 k) the words before b_a contribute
   multiples of 4 to x 2/pi. The words behind b_(a + RBDI_REDUCTION + 3) contribute less than rounding does,
   also where x is near a multiple of pi/2. */

#if RBDI_REAL_KIND % 3 != 0 && !defined RBDI_OWN_SINCOS && RBDI_ROUNDS
#define RBDI_POLYNOMIAL_SINCOS
#if RBDI_REAL_KIND == 1
#define RBDI_SINCOS_LIMIT 1e6
#define RBDI_REDUCTION 4 /* words of the fraction of x 2/pi */
#define RBDI_MANTISSA 52
#else
#define RBDI_SINCOS_LIMIT 1e4f
#define RBDI_REDUCTION 2
#define RBDI_MANTISSA 23
#endif

/* The integer part of |x| 2/pi modulo 2^32, in part[0], and its fraction, in the words from part[1] on. */
RBDI_COLD void rbdi_turns(RBD_REAL x, uint32_t part[RBDI_REDUCTION + 2]) {
    /* words of 2/pi, from b_1 on */
    static const uint32_t two_over_pi[] = {
#if RBDI_REAL_KIND == 1
        0xa2f9836eu, 0x4e441529u, 0xfc2757d1u, 0xf534ddc0u, 0xdb629599u, 0x3c439041u, 0xfe5163abu,
        0xdebbc561u, 0xb7246e3au, 0x424dd2e0u, 0x06492eeau, 0x09d1921cu, 0xfe1deb1cu, 0xb129a73eu,
        0xe88235f5u, 0x2ebb4484u, 0xe99c7026u, 0xb45f7e41u, 0x3991d639u, 0x835339f4u, 0x9c845f8bu,
        0xbdf9283bu, 0x1ff897ffu, 0xde05980fu, 0xef2f118bu, 0x5a0a6d1fu, 0x6d367ecfu, 0x27cb09b7u,
        0x4f463f66u, 0x9e5fea2du, 0x7527bac7u, 0xebe5f17bu, 0x3d0739f7u, 0x8a5292eau, 0x6bfb5fb1u,
        0x1f8d5d08u, 0x56033046u
#else
        0xa2f9836eu, 0x4e441529u, 0xfc2757d1u, 0xf534ddc0u, 0xdb629599u,
        0x3c439041u, 0xfe5163abu, 0xdebbc561u
#endif
    };

    union {
        RBD_REAL x;
        rbdi_bit bits;
    } u = {x < 0 ? -x : x};
    const rbdi_bit one = (rbdi_bit)1 << RBDI_MANTISSA;
    const uint64_t mantissa = (u.bits & (one - 1)) | one;
    const int bias = (1 << (8 * (int)sizeof(x) - 2 - RBDI_MANTISSA)) - 1; /* of the exponent */

    /* |x| = N 2^(32 a) */
    const int e = (int)(u.bits >> RBDI_MANTISSA) - bias - RBDI_MANTISSA + 64;
    const int a = e / 32 - 2, shift = e % 32;
    const uint64_t low = (mantissa & UINT32_MAX) << shift, high = ((mantissa >> 32) << shift) + (low >> 32);
    const uint32_t N[3] = {(uint32_t)low, (uint32_t)high, (uint32_t)(high >> 32)};

    /* part += b_k N_i 2^(32 (a + i - k)), with carries */
    for (int j = 0; j <= RBDI_REDUCTION + 1; ++j) part[j] = 0;
    for (int k = a > 1 ? a : 1; k <= a + RBDI_REDUCTION + 3; ++k)
        for (int i = 0; i < 3; ++i) {
            uint64_t carry = (uint64_t)two_over_pi[k - 1] * N[i];
            if (k - a - i > RBDI_REDUCTION + 1) continue;
            for (int j = k - a - i; j >= 0; --j, carry >>= 32) {
                carry += part[j];
                part[j] = (uint32_t)carry;
            }
        }
}

/* Returns r, for x finite or not, and adds n modulo 4 to the quarters: right angles. */
RBDI_COLD RBD_REAL rbdi_reduce_angle(RBD_REAL x, RBD_REAL *quarters) {
    const RBD_REAL word = (RBD_REAL)(1 / 4294967296.), right_angle = (RBD_REAL)1.57079632679489661923;
    uint32_t part[RBDI_REDUCTION + 2], flip;
    RBD_REAL r = 0;
    if (!(x - x == 0)) return x - x; /* not a number */

    /* |x| 2/pi = part[0] + fraction; r = (fraction, less 1 if above a half) pi/2 */
    rbdi_turns(x, part);
    flip = part[1] >> 31 ? UINT32_MAX : 0; /* a fraction over a half counts from the next multiple */
    for (int j = RBDI_REDUCTION + 1; j > 0; --j) r = (r + (RBD_REAL)(part[j] ^ flip)) * word;
    r = r * (flip ? -right_angle : right_angle);

    part[0] = (part[0] + (flip & 1)) & 3;
    *quarters = *quarters + (RBD_REAL)(x < 0 ? 4 - part[0] : part[0]);
    return x < 0 ? -r : r;
}
#endif

/* ==== src/base/sincos.h ==== */
#ifdef RBDI_POLYNOMIAL_SINCOS
#ifdef RBDI_BATCH_SCALAR
typedef rbdi_bit rbdi_bits;
typedef union rbdi_pun {
    rbd_real x;
    rbdi_bits bits;
} rbdi_pun;
RBDI_INLINE rbdi_bits rbdi_to_bits(rbdi_batch x) {
    rbdi_pun u;
    u.x = x;
    return u.bits;
}

RBDI_INLINE rbdi_batch rbdi_from_bits(rbdi_bits bits) {
    rbdi_pun u;
    u.bits = bits;
    return u.x;
}
#else
#if RBDI_BATCH == 1 /* lanes */
typedef rbdi_bit rbdi_bits __attribute__((vector_size(RBDI_BATCH * sizeof(rbd_real))));
#endif
RBDI_INLINE rbdi_bits rbdi_to_bits(rbdi_batch x) { return (rbdi_bits)x; }
RBDI_INLINE rbdi_batch rbdi_from_bits(rbdi_bits bits) { return (rbdi_batch)bits; }
#endif

/* Sine and cosine of x + quarters pi/2, |x| <= RBDI_SINCOS_LIMIT, without a branch. x = n pi/2 + r, n from
   adding and subtracting 1.5 * 2^(mantissa bits), with pi/2 split in three (Cody and Waite 1980). Minimax
   polynomials in z = r^2 on |r| <= pi/4. The low bits of the sum have the quadrant, to which the quarters are
   added exactly; it swaps sine and cosine and gives their signs. */
RBDI_INLINE void rbdi_sincos_batch(rbdi_batch x, rbdi_batch quarters, rbdi_batch *s, rbdi_batch *c) {
#if RBDI_CLANG /* which does not tell by a macro that it may reassociate */
#pragma clang fp reassociate(off)
#endif

    /* n, r, and the polynomials ps = (sin r / r - 1) / z, pc = (cos r - 1 + z/2) / z^2 */
#if RBDI_REAL_KIND == 1
    const rbdi_batch magic = quarters + 6755399441055744.0;
    rbdi_batch shifted = x * 0.63661977236758134308 + magic, n = shifted - magic;
    rbdi_batch r =
        ((x - n * 1.57079632673412561417) - n * 6.07710050630396597660e-11) - n * 2.02226624879595063154e-21;
    rbdi_batch z = r * r;
    rbdi_batch ps =
        ((((z * 1.5896987541673679574e-10 + -2.5050761807404846211e-8) * z + 2.7557313718766776671e-6) * z +
          -0.0001984126982989857878) *
             z +
         0.0083333333333225528993) *
            z +
        -0.16666666666666632772;
    rbdi_batch pc =
        ((((z * -1.1361303896065947874e-11 + 2.0875758075722807366e-9) * z + -2.755731463445455091e-7) * z +
          2.4801587290576460775e-5) *
             z +
         -0.0013888888888876133562) *
            z +
        0.041666666666666613249;
    const int top = 62;
#else
    const rbdi_batch magic = quarters + 12582912.0f;
    rbdi_batch shifted = x * 0.636619772f + magic, n = shifted - magic;
    rbdi_batch r = ((x - n * 1.5703125f) - n * 4.837512969971e-4f) - n * 7.549789954892e-8f;
    rbdi_batch z = r * r;
    rbdi_batch ps = (z * -0.000195175284f + 0.00833218040f) * z + -0.166666550f;
    rbdi_batch pc = (z * 2.44394104e-5f + -0.00138873773f) * z + 0.0416666471f;
    const int top = 30;
#endif

    /* sine and cosine of r, swapped and with the signs of the quadrant */
    rbdi_batch sine = z * r * ps + r;
    rbdi_batch cosine = z * z * pc + (RBD_C(1) - RBD_C(0.5) * z);
    rbdi_bits quadrant = rbdi_to_bits(shifted), bs = rbdi_to_bits(sine), bc = rbdi_to_bits(cosine);
    rbdi_bits swap = (bs ^ bc) & (0u - (quadrant & 1u));

    *s = rbdi_from_bits((bs ^ swap) ^ ((quadrant & 2u) << top));
    *c = rbdi_from_bits((bc ^ swap) ^ (((quadrant + 1u) & 2u) << top));
}

/* Sine and cosine of one angle x of any size plus so many right angles. */
RBDI_PART void rbdi_sincos_one(rbd_real x, rbd_real quarters, rbd_real *s, rbd_real *c) {
    rbdi_batch sine, cosine;
#ifdef RBD_LANES
    for (int i = 0; i < RBD_LANES; ++i) {
        RBD_REAL sum = quarters[i];
        if (!(x[i] * x[i] < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT)) x[i] = rbdi_reduce_angle(x[i], &sum);
        quarters[i] = sum;
    }
#else
    if (!(x * x < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT)) x = rbdi_reduce_angle(x, &quarters);
#endif

    rbdi_sincos_batch(rbdi_all_lanes(x), rbdi_all_lanes(quarters), &sine, &cosine);
    *s = rbdi_first_lane(sine);
    *c = rbdi_first_lane(cosine);
}

/* Sines and cosines of the angles first .. end - 1 plus right angles, in the least number of batches, which
   are aligned where that takes no more. Entries that share a batch with them are written too. The arrays are
   padded. The error is below 2.3e-16 (double), 1.0e-7 (float) up to the limit, and twice as much beyond it.
   */
RBDI_PART void rbdi_sincos_array(const rbd_real *x, const rbd_real *quarters, int first, int end, rbd_real *s,
                                 rbd_real *c) {
    const int size = (end - first + RBDI_BATCH - 1) / RBDI_BATCH * RBDI_BATCH;
    int start = first / RBDI_BATCH * RBDI_BATCH;                                     /* aligned */
    rbdi_bits within = (rbdi_bits)(rbdi_all_lanes(rbdi_zero()) < RBDI_SINCOS_LIMIT); /* all are */
    rbdi_bit all;

    if (start + size < end) start = end - size;
    for (int i = start; i < end; i += RBDI_BATCH) {
        const rbdi_batch angle = *(const rbdi_batch *)&x[i];
        within &= (rbdi_bits)(angle * angle < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT);
        rbdi_sincos_batch(angle, *(const rbdi_batch *)&quarters[i], (rbdi_batch *)&s[i], (rbdi_batch *)&c[i]);
    }

#ifdef RBDI_BATCH_SCALAR
    all = within;
#else
    all = within[0];
    for (int i = 1; i < (int)(sizeof within / sizeof all); ++i) all &= within[i];
#endif
    if (all) return;

    /* with a large angle, or one that is no number, all anew, one by one */
    for (int i = first; i < end; ++i) rbdi_sincos_one(x[i], quarters[i], &s[i], &c[i]);
}
#endif

/* Sine and cosine of one angle, by libm where rbd has no polynomial. */
RBDI_INLINE void rbdi_sincos(rbd_real x, rbd_real *s, rbd_real *c) {
#ifdef RBDI_POLYNOMIAL_SINCOS
    rbdi_sincos_one(x, rbdi_zero(), s, c);
#elif defined RBD_LANES
    for (int i = 0; i < RBD_LANES; ++i) {
        (*s)[i] = RBD_SIN(x[i]);
        (*c)[i] = RBD_COS(x[i]);
    }
#else
    *s = RBD_SIN(x);
    *c = RBD_COS(x);
#endif
}

/* ==== src/algebra/vectors.h ==== */
/* ---- spatial algebra [spatial algebra] ----
   Frames: "down" goes from parent to child, "up" from child to parent. Everything is built from the
   turn about z and the shift along z; those about and along x are the same after the cyclic change
   of axes (x, y, z) -> (y, z, x). */

/* Vectors, motions and forces; algebra/batch_vectors.h has the same of batches. */
#define RBDI_T rbd_real
RBDI_INLINE rbdi_v3 rbdi_vec(RBDI_T x, RBDI_T y, RBDI_T z) {
    const rbdi_v3 v = {x, y, z};
    return v;
}

RBDI_INLINE rbdi_v3 rbdi_add(rbdi_v3 a, rbdi_v3 b) { return rbdi_vec(a.x + b.x, a.y + b.y, a.z + b.z); }
RBDI_INLINE rbdi_v3 rbdi_scale(RBDI_T k, rbdi_v3 a) { return rbdi_vec(k * a.x, k * a.y, k * a.z); }
RBDI_INLINE rbdi_v3 rbdi_cross(rbdi_v3 a, rbdi_v3 b) {
    return rbdi_vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

RBDI_INLINE rbdi_motion rbdi_motion_add(rbdi_motion a, rbdi_motion b) {
    a.omega = rbdi_add(a.omega, b.omega);
    a.v = rbdi_add(a.v, b.v);
    return a;
}

RBDI_INLINE rbdi_force rbdi_force_add(rbdi_force a, rbdi_force b) {
    a.n = rbdi_add(a.n, b.n);
    a.f = rbdi_add(a.f, b.f);
    return a;
}

/* S' f. */
RBDI_INLINE RBDI_T rbdi_power(rbdi_motion S, rbdi_force f) {
    return (f.n.x * S.omega.x + f.n.y * S.omega.y + f.n.z * S.omega.z) +
           (f.f.x * S.v.x + f.f.y * S.v.y + f.f.z * S.v.z);
}
#undef RBDI_T

/* A vector to and from an array, whose components are a stride apart. */
RBDI_INLINE void rbdi_store_vec(rbd_real *array, ptrdiff_t stride, rbdi_v3 v) {
    array[0] = v.x;
    array[stride] = v.y;
    array[2 * stride] = v.z;
}

RBDI_INLINE rbdi_v3 rbdi_load_vec(const rbd_real *array, ptrdiff_t stride) {
    return rbdi_vec(array[0], array[stride], array[2 * stride]);
}

/* _c: from constants of the model. */
RBDI_INLINE rbdi_v3 rbdi_vec_c(rbdi_c3 a) { return rbdi_vec(rbdi_set(a.x), rbdi_set(a.y), rbdi_set(a.z)); }
RBDI_INLINE rbdi_v3 rbdi_vec0(void) { return rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_zero()); }
RBDI_INLINE rbdi_v3 rbdi_sub(rbdi_v3 a, rbdi_v3 b) { return rbdi_vec(a.x - b.x, a.y - b.y, a.z - b.z); }
RBDI_INLINE rbd_real rbdi_dot(rbdi_v3 a, rbdi_v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

RBDI_INLINE rbdi_v3 rbdi_cycle(rbdi_v3 v) { return rbdi_vec(v.y, v.z, v.x); }
RBDI_INLINE rbdi_v3 rbdi_uncycle(rbdi_v3 v) { return rbdi_vec(v.z, v.x, v.y); }

/* A matrix by rows. */
RBDI_INLINE rbdi_mat rbdi_mat_of(rbd_real xx, rbd_real xy, rbd_real xz, rbd_real yx, rbd_real yy, rbd_real yz,
                                 rbd_real zx, rbd_real zy, rbd_real zz) {
    const rbdi_mat A = {xx, xy, xz, yx, yy, yz, zx, zy, zz};
    return A;
}

RBDI_INLINE rbdi_mat rbdi_mat_c(const rbd_const A[9]) {
    rbdi_mat B;

    B.xx = rbdi_set(A[0]);
    B.xy = rbdi_set(A[1]);
    B.xz = rbdi_set(A[2]);
    B.yx = rbdi_set(A[3]);
    B.yy = rbdi_set(A[4]);
    B.yz = rbdi_set(A[5]);
    B.zx = rbdi_set(A[6]);
    B.zy = rbdi_set(A[7]);
    B.zz = rbdi_set(A[8]);
    return B;
}

RBDI_INLINE rbdi_sym rbdi_sym_c(rbdi_csym A) {
    rbdi_sym B;

    B.xx = rbdi_set(A.xx);
    B.xy = rbdi_set(A.xy);
    B.xz = rbdi_set(A.xz);
    B.yy = rbdi_set(A.yy);
    B.yz = rbdi_set(A.yz);
    B.zz = rbdi_set(A.zz);
    return B;
}

/* A v, A' v, A B, and A v of a symmetric matrix. */
RBDI_INLINE rbdi_v3 rbdi_mul(rbdi_mat A, rbdi_v3 v) {
    return rbdi_vec(A.xx * v.x + A.xy * v.y + A.xz * v.z, A.yx * v.x + A.yy * v.y + A.yz * v.z,
                    A.zx * v.x + A.zy * v.y + A.zz * v.z);
}

RBDI_INLINE rbdi_mat rbdi_transpose(rbdi_mat A) {
    return rbdi_mat_of(A.xx, A.yx, A.zx, A.xy, A.yy, A.zy, A.xz, A.yz, A.zz);
}

RBDI_INLINE rbdi_v3 rbdi_mul_t(rbdi_mat A, rbdi_v3 v) { return rbdi_mul(rbdi_transpose(A), v); }
RBDI_INLINE rbdi_mat rbdi_mul_mat(rbdi_mat A, rbdi_mat B) {
    rbdi_v3 x = rbdi_mul(A, rbdi_vec(B.xx, B.yx, B.zx)), y = rbdi_mul(A, rbdi_vec(B.xy, B.yy, B.zy)),
            z = rbdi_mul(A, rbdi_vec(B.xz, B.yz, B.zz));
    rbdi_mat C;

    C.xx = x.x;
    C.xy = y.x;
    C.xz = z.x;
    C.yx = x.y;
    C.yy = y.y;
    C.yz = z.y;
    C.zx = x.z;
    C.zy = y.z;
    C.zz = z.z;
    return C;
}

RBDI_INLINE rbdi_v3 rbdi_mul_sym(rbdi_sym A, rbdi_v3 v) {
    return rbdi_vec(A.xx * v.x + A.xy * v.y + A.xz * v.z, A.xy * v.x + A.yy * v.y + A.yz * v.z,
                    A.xz * v.x + A.yz * v.y + A.zz * v.z);
}

/* Change of axes by a turn about z with cosine c and sine s. rbdi_turn_z: from the axes before the turn to
   those after it, as from a parent's to its child's; rbdi_turn_up_z: back. flags: RBDI_TWIST_0 if (c, s) is
   (1, 0), RBDI_TWIST_90 if (0, 1), else neither. */
RBDI_INLINE rbdi_v3 rbdi_turn_z(int flags, rbd_real c, rbd_real s, rbdi_v3 v) {
    if (flags & RBDI_TWIST_0) return v;
    if (flags & RBDI_TWIST_90) return rbdi_vec(v.y, -v.x, v.z);
    return rbdi_vec(c * v.x + s * v.y, c * v.y - s * v.x, v.z);
}

RBDI_INLINE rbdi_v3 rbdi_turn_up_z(int flags, rbd_real c, rbd_real s, rbdi_v3 v) {
    if (flags & RBDI_TWIST_0) return v;
    if (flags & RBDI_TWIST_90) return rbdi_vec(-v.y, v.x, v.z);
    return rbdi_vec(c * v.x - s * v.y, c * v.y + s * v.x, v.z);
}

/* E' A E of a symmetric matrix A, for the turn E: from the axes after the turn to those before it. The block
   (x, y) takes four multiplications, the plain product twelve. */
RBDI_INLINE rbdi_sym rbdi_sym_up_z(int flags, rbd_real c, rbd_real s, rbdi_sym A) {
    rbd_real t;
    rbdi_sym B;
    if (flags & RBDI_TWIST_0) return A;

    B.zz = A.zz;
    if (flags & RBDI_TWIST_90) {
        B.xx = A.yy;
        B.yy = A.xx;
        B.xy = -A.xy;
        B.xz = -A.yz;
        B.yz = A.xz;
        return B;
    }

    /* t = s (A_yy - A_xx) - 2 c A_xy:  xx += s t,  yy -= s t,  xy = -c t - A_xy */
    t = s * (A.yy - A.xx) - (c + c) * A.xy;
    B.xx = A.xx + s * t;
    B.yy = A.yy - s * t;
    B.xy = -(c * t) - A.xy;
    B.xz = c * A.xz - s * A.yz;
    B.yz = s * A.xz + c * A.yz;
    return B;
}

RBDI_INLINE rbdi_sym rbdi_sym_cycle(rbdi_sym A) {
    rbdi_sym B;

    B.xx = A.yy;
    B.xy = A.yz;
    B.xz = A.xy;
    B.yy = A.zz;
    B.yz = A.xz;
    B.zz = A.xx;
    return B;
}

/* The same of any matrix. */
RBDI_INLINE rbdi_mat rbdi_mat_up_z(int flags, rbd_real c, rbd_real s, rbdi_mat A) {
    rbd_real t;
    rbdi_mat B;
    if (flags & RBDI_TWIST_0) return A;

    B.zz = A.zz;
    if (flags & RBDI_TWIST_90) {
        B.xx = A.yy;
        B.yy = A.xx;
        B.xy = -A.yx;
        B.yx = -A.xy;
        B.xz = -A.yz;
        B.yz = A.xz;
        B.zx = -A.zy;
        B.zy = A.zx;
        return B;
    }

    /* t = s (A_yy - A_xx) - c (A_xy + A_yx):  xx += s t,  yy -= s t,  xy = -c t - A_yx,  yx = -c t - A_xy */
    t = s * (A.yy - A.xx) - c * (A.xy + A.yx);
    B.xx = A.xx + s * t;
    B.yy = A.yy - s * t;
    B.xy = -(c * t) - A.yx;
    B.yx = -(c * t) - A.xy;
    B.xz = c * A.xz - s * A.yz;
    B.yz = s * A.xz + c * A.yz;
    B.zx = c * A.zx - s * A.zy;
    B.zy = s * A.zx + c * A.zy;
    return B;
}

RBDI_INLINE rbdi_mat rbdi_mat_cycle(rbdi_mat A) {
    rbdi_mat B;

    B.xx = A.yy;
    B.xy = A.yz;
    B.xz = A.yx;
    B.yx = A.zy;
    B.yy = A.zz;
    B.yz = A.zx;
    B.zx = A.xy;
    B.zy = A.xz;
    B.zz = A.xx;
    return B;
}

/* ==== src/algebra/spatial.h ==== */
RBDI_INLINE rbdi_sym rbdi_sym_add(rbdi_sym A, rbdi_sym B) {
    A.xx = A.xx + B.xx;
    A.xy = A.xy + B.xy;
    A.xz = A.xz + B.xz;
    A.yy = A.yy + B.yy;
    A.yz = A.yz + B.yz;
    A.zz = A.zz + B.zz;
    return A;
}

/* E' A E: to the parent's axes, for E from these to the child's. */
RBDI_INLINE rbdi_mat rbdi_mat_up(rbdi_mat E, rbdi_mat A) {
    return rbdi_mul_mat(rbdi_transpose(E), rbdi_mul_mat(A, E));
}

RBDI_INLINE rbdi_sym rbdi_sym_up(rbdi_mat E, rbdi_sym A) {
    rbdi_mat full;
    rbdi_sym B;

    full.xx = A.xx;
    full.xy = A.xy;
    full.xz = A.xz;
    full.yx = A.xy;
    full.yy = A.yy;
    full.yz = A.yz;
    full.zx = A.xz;
    full.zy = A.yz;
    full.zz = A.zz;
    full = rbdi_mat_up(E, full);
    B.xx = full.xx;
    B.xy = full.xy;
    B.xz = full.xz;
    B.yy = full.yy;
    B.yz = full.yz;
    B.zz = full.zz;
    return B;
}

/* [omega]x [omega]x = omega omega' - omega'omega 1. */
RBDI_INLINE rbdi_mat rbdi_omega_steady(rbdi_v3 omega) {
    rbd_real xx = omega.x * omega.x, yy = omega.y * omega.y, zz = omega.z * omega.z;
    rbdi_mat O;

    O.xx = -(yy + zz);
    O.yy = -(xx + zz);
    O.zz = -(xx + yy);
    O.xy = O.yx = omega.x * omega.y;
    O.xz = O.zx = omega.x * omega.z;
    O.yz = O.zy = omega.y * omega.z;
    return O;
}

/* Omega = [omega_dot]x + [omega]x [omega]x: a point x of the body has the acceleration acc + Omega x. */
RBDI_INLINE rbdi_mat rbdi_omega(rbdi_v3 omega, rbdi_v3 omega_dot) {
    rbdi_mat O = rbdi_omega_steady(omega);

    O.xy = O.xy - omega_dot.z;
    O.yx = O.yx + omega_dot.z;
    O.xz = O.xz + omega_dot.y;
    O.zx = O.zx - omega_dot.y;
    O.yz = O.yz - omega_dot.x;
    O.zy = O.zy + omega_dot.x;
    return O;
}

RBDI_INLINE rbdi_force rbdi_force_sub(rbdi_force A, rbdi_force B) {
    A.n = rbdi_sub(A.n, B.n);
    A.f = rbdi_sub(A.f, B.f);
    return A;
}

RBDI_INLINE rbdi_force rbdi_force0(void) {
    rbdi_force F;
    F.n = F.f = rbdi_vec0();
    return F;
}

RBDI_INLINE rbdi_motion rbdi_motion0(void) {
    rbdi_motion V;
    V.omega = V.v = rbdi_vec0();
    return V;
}

/* -- composite bodies: (Sigma, h) and a mass m -- */

/* To a frame whose origin is at -r, r = d z: h_new = h + m r, Sigma_new = Sigma + r h' + h_new r'. */
RBDI_INLINE rbdi_rbi rbdi_rbi_shift_z(rbd_real d, rbd_const m, rbdi_rbi C) {
    rbd_real h_new = C.h.z + d * m;
    C.Sigma.xz = C.Sigma.xz + d * C.h.x;
    C.Sigma.yz = C.Sigma.yz + d * C.h.y;
    C.Sigma.zz = C.Sigma.zz + d * (C.h.z + h_new);
    C.h.z = h_new;
    return C;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_up_z(int flags, rbd_real c, rbd_real s, rbdi_rbi C) {
    C.Sigma = rbdi_sym_up_z(flags, c, s, C.Sigma);
    C.h = rbdi_turn_up_z(flags, c, s, C.h);
    return C;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_cycle(rbdi_rbi C) {
    C.Sigma = rbdi_sym_cycle(C.Sigma);
    C.h = rbdi_cycle(C.h);
    return C;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_uncycle(rbdi_rbi C) { return rbdi_rbi_cycle(rbdi_rbi_cycle(C)); }
RBDI_INLINE rbdi_rbi rbdi_rbi_add(rbdi_rbi A, rbdi_rbi B) {
    A.Sigma = rbdi_sym_add(A.Sigma, B.Sigma);
    A.h = rbdi_add(A.h, B.h);
    return A;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_zero(void) {
    const rbd_real o = rbdi_zero();
    rbdi_rbi C;
    C.Sigma.xx = C.Sigma.xy = C.Sigma.xz = C.Sigma.yy = C.Sigma.yz = C.Sigma.zz = o;
    C.h = rbdi_vec0();
    return C;
}

/* By any shift r, an axis after the other. */
RBDI_INLINE rbdi_rbi rbdi_rbi_shift(rbdi_v3 r, rbd_const m, rbdi_rbi C) {
    C = rbdi_rbi_shift_z(r.x, m, rbdi_rbi_cycle(C));
    C = rbdi_rbi_shift_z(r.y, m, rbdi_rbi_cycle(C));
    return rbdi_rbi_shift_z(r.z, m, rbdi_rbi_cycle(C));
}

/* -- articulated-body inertias [I H; H' M] -- */

/* To a frame whose origin is at -r, r = d z: H_new = H + [r]x M, I_new = I - H [r]x + [r]x H_new'. full = 0:
   row z of I and H is zero, and stays zero. */
RBDI_INLINE rbdi_abi rbdi_abi_shift_z(rbd_real d, int full, rbdi_abi IA) {
    rbdi_abi shifted = IA;

    shifted.H.xx = IA.H.xx - d * IA.M.xy;
    shifted.H.xy = IA.H.xy - d * IA.M.yy;
    shifted.H.xz = IA.H.xz - d * IA.M.yz;
    shifted.H.yx = IA.H.yx + d * IA.M.xx;
    shifted.H.yy = IA.H.yy + d * IA.M.xy;
    shifted.H.yz = IA.H.yz + d * IA.M.xz;

    shifted.I.xx = IA.I.xx - d * (IA.H.xy + shifted.H.xy);
    shifted.I.xy = IA.I.xy + d * (IA.H.xx - shifted.H.yy);
    shifted.I.yy = IA.I.yy + d * (IA.H.yx + shifted.H.yx);

    if (full) {
        shifted.I.xz = IA.I.xz - d * IA.H.zy;
        shifted.I.yz = IA.I.yz + d * IA.H.zx;
    }

    return shifted;
}

RBDI_INLINE rbdi_abi rbdi_abi_up_z(int flags, rbd_real c, rbd_real s, rbdi_abi IA) {
    IA.I = rbdi_sym_up_z(flags, c, s, IA.I);
    IA.H = rbdi_mat_up_z(flags, c, s, IA.H);
    IA.M = rbdi_sym_up_z(flags, c, s, IA.M);
    return IA;
}

RBDI_INLINE rbdi_abi rbdi_abi_cycle(rbdi_abi IA) {
    IA.I = rbdi_sym_cycle(IA.I);
    IA.H = rbdi_mat_cycle(IA.H);
    IA.M = rbdi_sym_cycle(IA.M);
    return IA;
}

RBDI_INLINE rbdi_abi rbdi_abi_uncycle(rbdi_abi IA) { return rbdi_abi_cycle(rbdi_abi_cycle(IA)); }
RBDI_INLINE rbdi_abi rbdi_abi_add(rbdi_abi A, rbdi_abi B) {
    A.I = rbdi_sym_add(A.I, B.I);
    A.M = rbdi_sym_add(A.M, B.M);
    A.H.xx = A.H.xx + B.H.xx;
    A.H.xy = A.H.xy + B.H.xy;
    A.H.xz = A.H.xz + B.H.xz;
    A.H.yx = A.H.yx + B.H.yx;
    A.H.yy = A.H.yy + B.H.yy;
    A.H.yz = A.H.yz + B.H.yz;
    A.H.zx = A.H.zx + B.H.zx;
    A.H.zy = A.H.zy + B.H.zy;
    A.H.zz = A.H.zz + B.H.zz;
    return A;
}

RBDI_INLINE rbdi_abi rbdi_abi_zero(void) {
    const rbd_real o = rbdi_zero();
    rbdi_abi IA;
    IA.I.xx = IA.I.xy = IA.I.xz = IA.I.yy = IA.I.yz = IA.I.zz = o;
    IA.H.xx = IA.H.xy = IA.H.xz = IA.H.yx = IA.H.yy = IA.H.yz = IA.H.zx = IA.H.zy = IA.H.zz = o;
    IA.M.xx = IA.M.xy = IA.M.xz = IA.M.yy = IA.M.yz = IA.M.zz = o;
    return IA;
}

/* By any shift r, an axis after the other. */
RBDI_INLINE rbdi_abi rbdi_abi_shift(rbdi_v3 r, rbdi_abi IA) {
    IA = rbdi_abi_shift_z(r.x, 1, rbdi_abi_cycle(IA));
    IA = rbdi_abi_shift_z(r.y, 1, rbdi_abi_cycle(IA));
    return rbdi_abi_shift_z(r.z, 1, rbdi_abi_cycle(IA));
}

/* IA of a composite body of mass m: I = tr(Sigma) 1 - Sigma, H = [h]x, M = m 1. */
RBDI_INLINE rbdi_abi rbdi_abi_of_rbi(rbdi_rbi C, rbd_const m) {
    const rbd_real trace = C.Sigma.xx + C.Sigma.yy + C.Sigma.zz;
    rbdi_abi IA = rbdi_abi_zero();

    IA.I.xx = trace - C.Sigma.xx;
    IA.I.xy = -C.Sigma.xy;
    IA.I.xz = -C.Sigma.xz;
    IA.I.yy = trace - C.Sigma.yy;
    IA.I.yz = -C.Sigma.yz;
    IA.I.zz = trace - C.Sigma.zz;
    IA.H.xy = -C.h.z;
    IA.H.xz = C.h.y;
    IA.H.yz = -C.h.x;
    IA.H.yx = C.h.z;
    IA.H.zx = -C.h.y;
    IA.H.zy = C.h.x;
    IA.M.xx = IA.M.yy = IA.M.zz = rbdi_set(m);
    return IA;
}

/* The lower triangle of [I H; H' M]. */
RBDI_INLINE void rbdi_abi_to_array(rbdi_abi IA, rbd_real A[6][6]) {
    A[0][0] = IA.I.xx;
    A[1][0] = IA.I.xy;
    A[1][1] = IA.I.yy;
    A[2][0] = IA.I.xz;
    A[2][1] = IA.I.yz;
    A[2][2] = IA.I.zz;
    A[3][0] = IA.H.xx;
    A[3][1] = IA.H.yx;
    A[3][2] = IA.H.zx;
    A[3][3] = IA.M.xx;
    A[4][0] = IA.H.xy;
    A[4][1] = IA.H.yy;
    A[4][2] = IA.H.zy;
    A[4][3] = IA.M.xy;
    A[4][4] = IA.M.yy;
    A[5][0] = IA.H.xz;
    A[5][1] = IA.H.yz;
    A[5][2] = IA.H.zz;
    A[5][3] = IA.M.xz;
    A[5][4] = IA.M.yz;
    A[5][5] = IA.M.zz;
}

RBDI_INLINE rbdi_abi rbdi_abi_from_array(rbd_real A[6][6]) {
    rbdi_abi IA;

    IA.I.xx = A[0][0];
    IA.I.xy = A[1][0];
    IA.I.yy = A[1][1];
    IA.I.xz = A[2][0];
    IA.I.yz = A[2][1];
    IA.I.zz = A[2][2];
    IA.H.xx = A[3][0];
    IA.H.yx = A[3][1];
    IA.H.zx = A[3][2];
    IA.M.xx = A[3][3];
    IA.H.xy = A[4][0];
    IA.H.yy = A[4][1];
    IA.H.zy = A[4][2];
    IA.M.xy = A[4][3];
    IA.M.yy = A[4][4];
    IA.H.xz = A[5][0];
    IA.H.yz = A[5][1];
    IA.H.zz = A[5][2];
    IA.M.xz = A[5][3];
    IA.M.yz = A[5][4];
    IA.M.zz = A[5][5];
    return IA;
}

/* Spatial vectors to and from arrays, whose six components are a stride apart. */
RBDI_INLINE void rbdi_store_motion(rbd_real *array, ptrdiff_t stride, rbdi_motion V) {
    rbdi_store_vec(array, stride, V.omega);
    rbdi_store_vec(array + 3 * stride, stride, V.v);
}

RBDI_INLINE rbdi_motion rbdi_load_motion(const rbd_real *array, ptrdiff_t stride) {
    rbdi_motion V;
    V.omega = rbdi_load_vec(array, stride);
    V.v = rbdi_load_vec(array + 3 * stride, stride);
    return V;
}

RBDI_INLINE void rbdi_store_force(rbd_real *array, ptrdiff_t stride, rbdi_force F) {
    rbdi_store_vec(array, stride, F.n);
    rbdi_store_vec(array + 3 * stride, stride, F.f);
}

RBDI_INLINE rbdi_force rbdi_load_force(const rbd_real *array, ptrdiff_t stride) {
    rbdi_force F;
    F.n = rbdi_load_vec(array, stride);
    F.f = rbdi_load_vec(array + 3 * stride, stride);
    return F;
}

/* ==== src/algebra/rotations.h ==== */
/* Quaternions and angles. */

/* A power of two. It is so small that the square of no finite number times it overflows, and so large that a
   number whose square overflows stays above 1e-15. */
#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_SHORTEN 2.9134143481250808e-157 /* 2^-520 */
#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_SHORTEN 8.47032947e-22f /* 2^-70 */
#else
#define RBDI_SQUARE(x) ((x) * (x))
#define RBDI_SHORTEN /* 2^-8208 */ \
    RBDI_SQUARE(RBDI_SQUARE(RBDI_SQUARE(RBDI_SQUARE(RBD_C(3.7291703656001034e-155)))))
#endif

/* u = q, shortened if the sum of the n squares would overflow. Returns 1 / (sum of the squares of u), or 0
   with bad set if that sum is below RBDI_SHORT; of NaN it returns NaN, so that no direction is made up. */
RBDI_INLINE rbd_real rbdi_inverse_square(const rbd_real *q, int n, rbd_real *u, rbdi_mask *bad) {
    const rbd_real one = rbdi_set(RBD_C(1)), limit = rbdi_set(RBD_C(1e-12) / RBDI_SHORTEN / RBDI_SHORTEN);
    rbd_real sum = q[0] * q[0], factor;

    RBDI_UNROLL_SIX for (int i = 1; i < n; ++i)
        sum = sum + q[i] * q[i];
    factor = rbdi_select(rbdi_less(limit, sum), rbdi_set(RBDI_SHORTEN), one);
    RBDI_UNROLL_SIX for (int i = 0; i < n; ++i)
        u[i] = q[i] * factor;
    sum = u[0] * u[0];
    RBDI_UNROLL_SIX for (int i = 1; i < n; ++i)
        sum = sum + u[i] * u[i];
    *bad = rbdi_less(sum, rbdi_set(RBDI_SHORT));
    return rbdi_select(*bad, rbdi_zero(), one / rbdi_select(*bad, one, sum));
}

/* E of a quaternion (x, y, z, w) of any length, from joint-frame axes to body axes; zero gives the
   identity. */
RBDI_INLINE rbdi_mat rbdi_quaternion_down(const rbd_real *q) {
    rbdi_mask bad;
    rbd_real u[4], twice = rbdi_inverse_square(q, 4, u, &bad), x, y, z;
    rbdi_mat E;

    /* E = 1 - 2 (v'v 1 - v v' + w [v]x) / q'q, for q = (v; w) */
    twice = twice + twice;
    x = twice * u[0];
    y = twice * u[1];
    z = twice * u[2];

    E.xx = rbdi_set(RBD_C(1)) - (y * u[1] + z * u[2]);
    E.yy = rbdi_set(RBD_C(1)) - (x * u[0] + z * u[2]);
    E.zz = rbdi_set(RBD_C(1)) - (x * u[0] + y * u[1]);
    E.xy = x * u[1] + z * u[3];
    E.yx = x * u[1] - z * u[3];
    E.xz = x * u[2] - y * u[3];
    E.zx = x * u[2] + y * u[3];
    E.yz = y * u[2] + x * u[3];
    E.zy = y * u[2] - x * u[3];
    return E;
}

/* (cos, sin) scaled to unit length, (1, 0) if both vanish. */
RBDI_INLINE void rbdi_unit_cs(const rbd_real *q, rbd_real *c, rbd_real *s) {
    rbdi_mask bad;
    rbd_real u[2], factor = rbdi_sqrt(rbdi_inverse_square(q, 2, u, &bad));
    *c = rbdi_select(bad, rbdi_set(RBD_C(1)), u[0] * factor);
    *s = rbdi_select(bad, rbdi_zero(), u[1] * factor);
}

/* sum over k of (-x)^k / (n + 2k)!: the tails of sine (n odd) and cosine (n even), for 0 <= x < 1. */
RBDI_PART rbd_real rbdi_tail(rbd_real x, int n) {
    rbd_real sum = rbdi_set(RBD_C(1));
    int factorial = 1;
    for (int k = RBDI_TAIL_TERMS; k > 0; --k)
        sum = rbdi_set(RBD_C(1)) - x * sum * (RBD_C(1) / (rbd_const)((n + 2 * k - 1) * (n + 2 * k)));
    for (int k = 2; k <= n; ++k) factorial *= k;
    return sum * (RBD_C(1) / (rbd_const)factorial);
}

/* Coefficients of the exponential map for a turn by theta. Here and below A = sin(theta) / theta. */
typedef struct rbdi_exp {
    rbd_real x;           /* theta^2 */
    rbd_real half_sine;   /* sin(theta / 2) / theta */
    rbd_real half_cosine; /* cos(theta / 2) */
    rbd_real B, C;        /* (1 - cos theta) / theta^2, (theta - sin theta) / theta^3 */
} rbdi_exp;

RBDI_PART rbdi_exp rbdi_exp_of(rbdi_v3 turn) {
    rbdi_exp e;
    rbd_real theta, sine, A;
    rbdi_mask near_zero;

    e.x = rbdi_dot(turn, turn) + RBDI_NO_ANGLE;
    theta = rbdi_sqrt(e.x);
    rbdi_sincos(theta * RBD_C(0.5), &sine, &e.half_cosine);
    e.half_sine = sine / theta;
    e.B = (e.half_sine + e.half_sine) * e.half_sine;
    A = (e.half_sine + e.half_sine) * e.half_cosine;
    near_zero = rbdi_less(e.x, rbdi_set(RBD_C(1)));
    e.C = rbdi_select(near_zero, rbdi_tail(rbdi_select(near_zero, e.x, rbdi_zero()), 3),
                      (rbdi_set(RBD_C(1)) - A) / e.x);
    return e;
}

/* The shift p of a screw motion (omega; v): p = v + B omega x v + C omega x (omega x v). */
RBDI_PART rbdi_v3 rbdi_exp_shift(rbdi_exp e, rbdi_v3 omega, rbdi_v3 v) {
    rbdi_v3 across = rbdi_cross(omega, v);
    return rbdi_add(v, rbdi_add(rbdi_scale(e.B, across), rbdi_scale(e.C, rbdi_cross(omega, across))));
}

/* Its inverse: v = p - omega x p / 2 + D omega x (omega x p), D = (1 - A / (2 B)) / theta^2. */
RBDI_PART rbdi_v3 rbdi_log_shift(rbdi_exp e, rbdi_v3 omega, rbdi_v3 p) {
    rbdi_v3 across = rbdi_cross(omega, p);
    rbd_real one = rbdi_set(RBD_C(1)), twice_B = e.B + e.B, A = (e.half_sine + e.half_sine) * e.half_cosine;
    rbdi_mask near_zero = rbdi_less(e.x, one);
    rbd_real x = rbdi_select(near_zero, e.x, rbdi_zero()), tail = rbdi_tail(x, 4);
    rbd_real D =
        rbdi_select(near_zero, (rbdi_tail(x, 3) - (tail + tail)) / twice_B, (one - A / twice_B) / e.x);

    p = rbdi_add(p, rbdi_scale(D, rbdi_cross(omega, across)));
    return rbdi_sub(p, rbdi_scale(rbdi_set(RBD_C(0.5)), across));
}

/* Angle in [0, pi] with sine s >= 0 and cosine c, s^2 + c^2 = 1, by sine and cosine alone: from a cubic guess
   by Newton steps, each of which cubes the error. */
RBDI_PART rbd_real rbdi_angle(rbd_real s, rbd_real c) {
    rbd_real one = rbdi_set(RBD_C(1)), t, angle, sine, cosine;
    rbdi_mask obtuse = rbdi_less(c, rbdi_zero());
    rbd_real positive = rbdi_select(obtuse, -c, c);

    t = s / (positive + one); /* tan(angle / 2) in [0, 1] */
    angle = t * (rbdi_set(RBD_C(2)) - t * t * RBD_C(RBDI_ANGLE_START));

    for (int k = 0; k < 4; ++k) {
        rbdi_sincos(angle, &sine, &cosine);
        angle = angle + (s * cosine - positive * sine);
    }

    return rbdi_select(obtuse, rbdi_set(RBDI_PI(rbd_const)) - angle, angle);
}

/* The same with the sign of s, in [-pi, pi]. */
RBDI_PART rbd_real rbdi_signed_angle(rbd_real s, rbd_real c) {
    rbdi_mask negative = rbdi_less(s, rbdi_zero());
    rbd_real angle = rbdi_angle(rbdi_select(negative, -s, s), c);
    return rbdi_select(negative, -angle, angle);
}

/* Unit quaternion of the same direction; identity for zero. */
RBDI_PART void rbdi_unit_quaternion(const rbd_real *q, rbd_real *u) {
    rbdi_mask bad;
    rbd_real factor = rbdi_sqrt(rbdi_inverse_square(q, 4, u, &bad));
    for (int i = 0; i < 4; ++i) u[i] = u[i] * factor;
    u[3] = rbdi_select(bad, rbdi_set(RBD_C(1)), u[3]);
}

/* out = a b, Hamilton's product of (x, y, z, w). */
RBDI_PART void rbdi_quaternion_product(const rbd_real *a, const rbd_real *b, rbd_real *out) {
    rbdi_v3 va = rbdi_load_vec(a, 1), vb = rbdi_load_vec(b, 1);
    rbd_real w = a[3] * b[3] - rbdi_dot(va, vb);
    rbdi_store_vec(out, 1,
                   rbdi_add(rbdi_cross(va, vb), rbdi_add(rbdi_scale(a[3], vb), rbdi_scale(b[3], va))));
    out[3] = w;
}

/* out = q exp(turn), normalised; e: the coefficients for the turn. */
RBDI_PART void rbdi_quaternion_step(const rbd_real *q, rbdi_exp e, rbdi_v3 turn, rbd_real *out) {
    rbd_real step[4], unit[4];
    rbdi_store_vec(step, 1, rbdi_scale(e.half_sine, turn));
    step[3] = e.half_cosine;
    rbdi_unit_quaternion(q, unit);
    rbdi_quaternion_product(unit, step, unit);
    rbdi_unit_quaternion(unit, out);
}

/* A quaternion, of any length, of the rotation R: the row of 4 q q' with the largest diagonal entry, whose
   entries are sums of those of R (Shepperd 1978), without a branch. */
RBDI_PART void rbdi_quaternion_of(rbdi_mat R, rbd_real q[4]) {
    const rbd_real one = rbdi_set(RBD_C(1)), x = R.zy - R.yz, y = R.xz - R.zx, z = R.yx - R.xy;
    const rbd_real xy = R.xy + R.yx, yz = R.yz + R.zy, xz = R.xz + R.zx;
    const rbd_real rows[4][4] = {{one + R.xx - R.yy - R.zz, xy, xz, x},
                                 {xy, one - R.xx + R.yy - R.zz, yz, y},
                                 {xz, yz, one - R.xx - R.yy + R.zz, z},
                                 {x, y, z, one + R.xx + R.yy + R.zz}};
    rbd_real best = rows[3][3];

    for (int k = 0; k < 4; ++k) q[k] = rows[3][k];
    for (int i = 0; i < 3; ++i) {
        const rbdi_mask more = rbdi_less(best, rows[i][i]);
        best = rbdi_select(more, rows[i][i], best);
        for (int k = 0; k < 4; ++k) q[k] = rbdi_select(more, rows[i][k], q[k]);
    }
}

/* The turn (body axes, at most pi) that leads from q0 to q1. */
RBDI_PART rbdi_v3 rbdi_quaternion_difference(const rbd_real *q0, const rbd_real *q1) {
    rbd_real a[4], b[4], step[4], sine, cosine, angle;
    rbdi_v3 v;
    rbdi_mask back;

    rbdi_unit_quaternion(q0, a);
    rbdi_unit_quaternion(q1, b);
    for (int i = 0; i < 3; ++i) a[i] = -a[i];
    rbdi_quaternion_product(a, b, step);
    v = rbdi_load_vec(step, 1);
    back = rbdi_less(step[3], rbdi_zero());
    cosine = rbdi_select(back, -step[3], step[3]);
    sine = rbdi_sqrt(rbdi_dot(v, v) + RBDI_NO_ANGLE);
    angle = rbdi_angle(sine, cosine);
    angle = (angle + angle) / sine;
    return rbdi_scale(rbdi_select(back, -angle, angle), v);
}

/* log R: the shortest turn, of length at most pi, whose exponential is R. */
RBDI_PART rbdi_v3 rbdi_log_rotation(rbdi_mat R) {
    const rbd_real o = rbdi_zero();
    const rbd_real identity[4] = {o, o, o, rbdi_set(RBD_C(1))};
    rbd_real q[4];
    rbdi_quaternion_of(R, q);
    return rbdi_quaternion_difference(identity, q);
}

/* ==== src/rbd.h ==== */
RBDI_CODE_END
#endif
#endif

#if defined RBD_IMPLEMENTATION && !defined RBDI_IMPLEMENTED
#define RBDI_IMPLEMENTED
RBDI_CODE_BEGIN

/* ==== src/base/pieces.h ==== */
#ifndef RBDI_BASE_PIECES_H
#define RBDI_BASE_PIECES_H
/* ---- pieces [pieces] ----
   Pieces of a caller's memory, and of a sentence. */

/* Takes count objects of size bytes from the front of the memory. */
RBDI_PART void *rbdi_take(unsigned char **memory, int count, size_t size) {
    unsigned char *taken = *memory;
    *memory += (size_t)count * size;
    return taken;
}

/* Takes n objects from the memory at `at`, a variable of the caller. */
#define RBDI_CUT(type, n) ((type *)rbdi_take(&at, 1, RBDI_ROUND((size_t)(n) * sizeof(type))))

/* Writes n, which is not negative, into the end of `digits`; returns where it begins. */
RBDI_PART const char *rbdi_decimal(int n, char digits[12]) {
    int at = 11;

    digits[at] = 0;
    do {
        digits[--at] = (char)('0' + n % 10);
        n = n / 10;
    } while (n);
    return &digits[at];
}

/* Writes n pieces one behind the other, cut to fit in size bytes, always terminated. Returns text. */
RBDI_PART char *rbdi_join(const char *const *piece, int n, char *text, size_t size) {
    size_t at = 0;

    for (int k = 0; k < n; ++k)
        for (const char *c = piece[k]; *c && at + 1 < size; ++c) text[at++] = *c;
    text[at] = 0;
    return text;
}
#endif

/* ==== src/base/memory.h ==== */
/* ---- common [common] ----
   Small functions that several sections call. */

/* Sets the n scalars of x to 0, a batch at a time. A call of memset would take longer. */
RBDI_PART void rbdi_clear(rbd_real *x, int n) {
#if RBDI_BATCH > 1 || defined RBD_LANES
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());

    for (rbdi_batch *p; n >= 8 * RBDI_BATCH; n -= 8 * RBDI_BATCH, x += 8 * RBDI_BATCH) {
        RBDI_ONE_INDEX(x); /* without it the compiler calls memset all the same */
        p = (rbdi_batch *)x;
        p[0] = p[1] = p[2] = p[3] = p[4] = p[5] = p[6] = p[7] = zero;
    }

    for (; n >= RBDI_BATCH; n -= RBDI_BATCH, x += RBDI_BATCH) {
        RBDI_ONE_INDEX(x);
        *(rbdi_batch *)x = zero;
    }
#else
    for (; n >= 4; n -= 4, x += 4) {
        x[0] = rbdi_zero();
        x[1] = rbdi_zero();
        x[2] = rbdi_zero();
        x[3] = rbdi_zero();
    }
#endif

    for (; n > 0; --n, ++x) *x = rbdi_zero();
}

/* Whether two names are equal; NULL equals none. */
RBDI_PART int rbdi_same(const char *a, const char *b) {
    if (!a || !b) return 0;
    while (*a && *a == *b) {
        ++a;
        ++b;
    }
    return *a == *b;
}

/* The first address in the memory with the alignment of RBDI_ALIGN. */
RBDI_PART unsigned char *rbdi_aligned(void *memory) {
    return (unsigned char *)(((uintptr_t)memory + RBDI_ALIGN - 1) / RBDI_ALIGN * RBDI_ALIGN);
}

/* ==== src/model/features.h ==== */
/* Interface: rbdi_block_of, rbdi_flags, rbdi_is, rbdi_massless_dof, rbdi_mimics, rbdi_on_world,
   rbdi_supported, RBDI_FEATURES, RBDI_OTHER_BLOCKS */

/* ---- features [features] ----
   The features of a model, as bits: flags that some link has, flags that some link has not, kinds of links,
   mimic joints, and blocks other than floating bases. RBD_FEATURES are those of all models of the program;
   its default is all. The algorithms get flags, kinds, mimic joints and blocks from these functions, so that
   the compiler drops code that no model needs. */

#define RBDI_FLAGS 2047u /* all flags of links */
#define RBDI_LACKS(flags) ((uint32_t)(flags) << 11)
#define RBDI_KIND_BIT(kind) (UINT32_C(1) << (22 + (kind)))
#define RBDI_MIMICS (UINT32_C(1) << 26)
#define RBDI_OTHER_BLOCKS (UINT32_C(1) << 27) /* not floating on the world, in its axes */
#define RBDI_ALL_FEATURES UINT32_C(0xfffffff)
#define RBDI_MASSLESS (UINT32_C(1) << 28) /* a joint moves no mass: no code, and none of dynamics */
#ifdef RBD_FEATURES
#define RBDI_FEATURES ((uint32_t)(RBD_FEATURES))
#else
#define RBDI_FEATURES RBDI_ALL_FEATURES
#endif

/* Flags of a link. The compiler knows those that all links of all models have, and those that none has. */
RBDI_INLINE int rbdi_flags(const rbdi_link *l) {
    const uint32_t some = RBDI_FEATURES & RBDI_FLAGS, all = some & ~(RBDI_FEATURES >> 11);
    if (RBDI_FEATURES == RBDI_ALL_FEATURES) return l->flags;
    return (int)(((uint32_t)l->flags & some) | all);
}

/* Whether a link is of this kind. */
RBDI_INLINE int rbdi_is(const rbdi_link *l, int kind) {
    const uint32_t kinds = RBDI_FEATURES >> 22 & 15u;
    return kinds == 1u << kind || ((kinds >> kind & 1u) && l->kind == kind);
}

/* The block of a link: a constant if all blocks of the program are floating bases on the world, in its
   axes. */
RBDI_INLINE const rbdi_block *rbdi_block_of(const rbd_model *m, const rbdi_link *l) {
    static const rbdi_block floating = {RBD_FLOATING, 0, 6, 1, {0}};
    return RBDI_FEATURES & RBDI_OTHER_BLOCKS ? &m->block[l->block] : &floating;
}

/* Whether the parent of a block is the world. */
RBDI_INLINE int rbdi_on_world(const rbdi_link *block) {
    return RBDI_FEATURES & RBDI_OTHER_BLOCKS ? block->parent < 0 : 1;
}

/* Features of the model that this program lacks. RBDI_MASSLESS is always one of them: no program computes
   dynamics without masses. Without Cholesky's factor mimic joints are one, because rbd_aba needs it for
   them. */
RBDI_INLINE uint32_t rbdi_missing(const rbd_model *m) {
#ifdef RBD_NO_CHOLESKY
    if (m->nmimic) return RBDI_MIMICS;
#endif
    return m->features & ~(RBDI_FEATURES & ~RBDI_MASSLESS);
}

/* Whether this program can compute the model's kinematics. */
RBDI_INLINE int rbdi_supported(const rbd_model *m) { return (rbdi_missing(m) & ~RBDI_MASSLESS) == 0; }

/* The first dof that moves no mass, -1 if there is none. It is part of the shape, so that no work of another
   model is taken: rbd_singular_dof reads it there. */
RBDI_INLINE int rbdi_massless_dof(const rbd_model *m) { return (int)(m->shape[1] >> 48) - 1; }

/* Number of mimic joints. */
RBDI_INLINE int rbdi_mimics(const rbd_model *m) { return RBDI_FEATURES & RBDI_MIMICS ? m->nmimic : 0; }

/* The features of a model. */
RBDI_PART uint32_t rbdi_features(const rbd_model *m) {
    uint32_t features = m->nmimic ? RBDI_MIMICS : 0;

    for (int i = 0; i < m->nblock; ++i)
        if (m->block[i].type != RBD_FLOATING || !m->block[i].identity) features |= RBDI_OTHER_BLOCKS;
    for (int i = 0; i < m->nl; ++i) {
        const uint32_t flags = (uint32_t)m->link[i].flags;
        features |= flags | RBDI_LACKS(~flags & RBDI_FLAGS) | RBDI_KIND_BIT(m->link[i].kind);
        if (m->link[i].kind == RBDI_BLOCK && m->link[i].parent >= 0) features |= RBDI_OTHER_BLOCKS;
    }

    return features;
}

/* ==== src/model/joint_types.h ==== */
/* Interface: rbdi_first_axis, rbdi_has_quaternion, rbdi_is_length, rbdi_type_turns */

/* ---- joint types [joint types] ----
   The differences between joint types. A type is a chain of one-axis links, one for each letter of its axes,
   or, if it has none, a block: a joint with several axes through one point. To add a type:

     always      its name in api/types.h, its q and v in [conventions], its row in rbdi_joint_facts
     a chain     of links that turn or slide needs that row alone. For links of another kind, as screws:
                 model/links.h: rbdi_build_joint
     a block     rbdi_first_axis and rbdi_is_length, below; model/joints.h: rbdi_joint_attitude,
                 rbdi_joint_origin, rbdi_block_pose; model/regroup.h: moments of mass that its motion leaves,
                 and whether it slides; model/lock.h: rbdi_block_motion_at; derivatives/memory.h: whether it
                 only slides
     v is not    rbdi_type_turns, below, if its step is an exponential of a motion in body axes, and
     the rate    rbdi_has_quaternion; else motion/manifold.h: rbdi_step_joint, rbdi_difference_joint,
     of q        rbdi_joint_rates, rbdi_joint_velocity, rbdi_neutral_joint, rbdi_random_joint
     its fields  model/describe.h: rbdi_describe_joint, if a description has fields for it other than axis and
                 axis2

   Floating joints are known in more places, as bases of robots: model/features.h, constraints/weights.h,
   contact/momentum.h, estimate/estimate.h, tasks/contacts.h. model/check.h asks whether a joint is fixed. No
   other room names a type: the test `rooms` compares. */

/* Numbers of coordinates and dofs, and the axes of one-axis links, in order: 'a' axis, 'b' axis2, 'x' 'y' 'z'
   those of the joint frame. A link turns about a small letter, and slides along a capital one. A type without
   axes is a block. */
typedef struct rbdi_joint_fact {
    signed char nq, nv;
    char axes[4];
} rbdi_joint_fact;

RBDI_PART const rbdi_joint_fact *rbdi_joint_facts(int type) {
    static const rbdi_joint_fact facts[RBD_JOINT_TYPES] = {
        {0, 0, ""},    /* fixed */
        {1, 1, "a"},   /* revolute */
        {1, 1, "a"},   /* continuous */
        {2, 1, "a"},   /* continuous_cs */
        {1, 1, "A"},   /* prismatic */
        {1, 1, "a"},   /* helical */
        {2, 2, "aA"},  /* cylindrical */
        {2, 2, "ab"},  /* universal */
        {4, 3, ""},    /* spherical */
        {3, 3, "zyx"}, /* Euler zyx */
        {3, 3, "xyz"}, /* xyz */
        {3, 3, "yxz"}, /* yxz */
        {3, 3, "zxy"}, /* zxy */
        {3, 3, ""},    /* planar */
        {3, 3, ""},    /* translation */
        {7, 6, ""},    /* floating */
    };

    return &facts[type > RBD_FIXED && type < RBD_JOINT_TYPES ? type : RBD_FIXED];
}

/* Whether a letter of rbdi_joint_fact.axes is that of a link that slides; and as a small letter. */
RBDI_INLINE int rbdi_axis_slides(char letter) { return !(letter & ('a' ^ 'A')); }
RBDI_INLINE char rbdi_axis_name(char letter) { return (char)(letter | ('a' ^ 'A')); }

/* The first spatial unit axis, omega_x .. omega_z, v_x .. v_z, of a block's dofs. The others follow it. */
RBDI_INLINE int rbdi_first_axis(int type) {
    if (type == RBD_PLANAR) return 2;
    return type == RBD_TRANSLATION ? 3 : 0;
}

/* Whether v has components of a motion in body axes, and a step is its exponential. Coordinates of other
   joints add up. */
RBDI_INLINE int rbdi_type_turns(int type) {
    return type == RBD_SPHERICAL || type == RBD_PLANAR || type == RBD_FLOATING;
}

/* Whether the last four coordinates are a quaternion. */
RBDI_INLINE int rbdi_has_quaternion(int type) { return type == RBD_SPHERICAL || type == RBD_FLOATING; }

/* Whether coordinate k, which is no part of a quaternion, is a length. Those of a block come first. */
RBDI_PART int rbdi_is_length(int type, int k) {
    const rbdi_joint_fact *fact = rbdi_joint_facts(type);
    if (fact->axes[0]) return rbdi_axis_slides(fact->axes[k]);

    return type == RBD_PLANAR ? k < 2 : type != RBD_SPHERICAL;
}

/* Number of links of a joint: of a chain one for each dof, of a block one. */
RBDI_PART int rbdi_links_of(int type) {
    const rbdi_joint_fact *fact = rbdi_joint_facts(type);
    return fact->axes[0] ? fact->nv : fact->nv > 0;
}

RBDI_PART int rbdi_can_mimic(int type) {
    return type == RBD_REVOLUTE || type == RBD_CONTINUOUS || type == RBD_PRISMATIC || type == RBD_HELICAL;
}

RBDI_PART int rbdi_has_limits(int type) {
    return type == RBD_REVOLUTE || type == RBD_PRISMATIC || type == RBD_HELICAL;
}

/* ==== src/model/calls.h ==== */
/* Interface: rbdi_check, rbdi_check_dynamics, rbdi_has_shape, rbdi_stride */

/* Whether memory that was made for a model of this shape has the arrays' lengths that the model needs.
   The model's address is not compared: another model may have been built there, and one table may stand
   at two. */
RBDI_INLINE int rbdi_has_shape(const rbd_model *m, const uint64_t shape[RBDI_SHAPE]) {
    return m->shape[0] == shape[0] && m->shape[1] == shape[1] && m->shape[2] == shape[2];
}

/* The first check of every call with a model and a work. arrays: none of the caller's required ones is
   NULL. The program must support the model, and the work must fit it. */
RBDI_INLINE rbd_status rbdi_check(const rbd_model *m, const rbd_work *w, int arrays) {
    if (!m || !w || !arrays) return RBD_ERR_NULL;
    return rbdi_supported(m) && rbdi_has_shape(m, w->shape) ? RBD_OK : RBD_ERR_WORK;
}

/* Why a model's dynamics cannot be computed. */
RBDI_COLD rbd_status rbdi_no_dynamics(const rbd_model *m, const rbd_work *w) {
    return rbdi_check(m, w, 1) ? RBD_ERR_WORK : RBD_ERR_MASSLESS;
}

/* rbdi_check of a call that needs masses. */
RBDI_INLINE rbd_status rbdi_check_dynamics(const rbd_model *m, const rbd_work *w, int arrays) {
    if (!m || !w || !arrays) return RBD_ERR_NULL;
    if (!rbdi_missing(m) && rbdi_has_shape(m, w->shape)) return RBD_OK;
    return rbdi_no_dynamics(m, w);
}

/* From one component of the wrenches in w->F to the next. */
RBDI_INLINE ptrdiff_t rbdi_stride(const rbd_model *m) { return RBDI_STRIDE(m->nv + m->nmimic); }

/* ==== src/rbd.h ==== */
RBDI_CODE_END
RBDI_DYNAMICS_BEGIN

/* ==== src/model/joints.h ==== */
/* Interface: rbdi_along_axis, rbdi_array_up, rbdi_batch_up, rbdi_block_link, rbdi_block_motion,
   rbdi_cross_shift, rbdi_down, rbdi_force_up, rbdi_force_up_block, rbdi_joint_attitude, rbdi_joint_origin,
   rbdi_joints, rbdi_link_dofs, rbdi_range_joints, rbdi_trig_of, RBDI_BY_FLAGS, RBDI_BY_FLAGS_OF, RBDI_CASES,
   RBDI_NO_CASES */

/* ---- joints [joints] ----
   Transforms of joints at q, and what the algorithms do with them. [joint types] lists the places where joint
   types differ. */

/* Whether a link is a block. All have RBDI_MASS_KEPT, so that with the common flags this is a constant. */
RBDI_INLINE int rbdi_block_link(const rbdi_link *l, int flags) {
    return (flags & RBDI_MASS_KEPT) && rbdi_is(l, RBDI_BLOCK);
}

/* Number of dofs of a link. */
RBDI_INLINE int rbdi_link_dofs(const rbd_model *m, const rbdi_link *l) {
    return rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->n : 1;
}

/* E of a block that turns: from the axes of the joint frame to those of the body. */
RBDI_INLINE rbdi_mat rbdi_joint_attitude(int type, const rbd_real *q) {
    const rbd_real o = rbdi_zero();
    rbd_real c, s;
    if (type == RBD_SPHERICAL) return rbdi_quaternion_down(q);
    if (type != RBD_PLANAR) return rbdi_quaternion_down(q + 3);

    rbdi_sincos(q[2], &s, &c);
    return rbdi_mat_of(c, s, o, -s, c, o, o, o, rbdi_set(RBD_C(1)));
}

/* The body's origin in the joint frame of a block, or its rates if q are the rates of the coordinates. */
RBDI_INLINE rbdi_v3 rbdi_joint_origin(int type, const rbd_real *q) {
    if (type == RBD_SPHERICAL) return rbdi_vec0();
    return rbdi_vec(q[0], q[1], type == RBD_PLANAR ? rbdi_zero() : q[2]);
}

/* Pose of a block: E from parent to link, r = the link's origin in parent axes. */
RBDI_INLINE rbdi_pose rbdi_block_pose(const rbdi_link *l, const rbdi_block *b, const rbd_real *q) {
    const int slides = b->type == RBD_TRANSLATION;
    rbdi_pose X;

    X.r = rbdi_joint_origin(b->type, q);
    X.E = slides ? rbdi_mat_c(b->E) : rbdi_joint_attitude(b->type, q);

    if (!b->identity) {
        const rbdi_mat joint = rbdi_mat_c(b->E);
        if (!slides) X.E = rbdi_mul_mat(X.E, joint);
        X.r = rbdi_mul_t(joint, X.r);
    }

    X.r = rbdi_add(rbdi_vec_c(l->r), X.r);
    return X;
}

/* Sine and cosine of a link's joint angle, where rbdi_sincos_array is not there. */
RBDI_PART void rbdi_sincos_link(const rbdi_link *l, rbd_real angle, rbd_real *sine, rbd_real *cosine) {
    rbd_real s, c;

    rbdi_sincos(angle, &s, &c);
    switch ((int)l->quarters) {
    case 1:
        *sine = c;
        *cosine = -s;
        break;
    case 2:
        *sine = -s;
        *cosine = -c;
        break;
    case 3:
        *sine = -c;
        *cosine = s;
        break;
    default:
        *sine = s;
        *cosine = c;
        break;
    }
}

/* Computes all quantities of the links first .. end - 1 that depend on q alone: slides, poses of blocks,
   sines and cosines. Those of other links are lost: rbdi_sincos_array writes whole batches. The
   angle q + gamma is rounded before its sine is computed: by one more rounding of q, 6e-11 rad at q = 1e6 in
   double, or not at all if gamma is 0, because the joint angle at q = 0 is a multiple of 90 degrees. */
RBDI_PART void rbdi_range_joints(const rbd_model *m, rbd_work *w, int first, int end, const rbd_real *q) {
    int plain = 1;    /* whether no link slides or has (cos, sin) as coordinates */
    int from = first; /* of the sines: blocks at the beginning have none */

    /* angles of turning links, slides, poses of blocks */
    for (int i = first; i < end; ++i) {
        const rbdi_link *l = &m->link[i];
        w->quarters[i] = rbdi_set(l->quarters);

        if (rbdi_is(l, RBDI_REVOLUTE)) {
            w->angle[i] = q[l->iq] + l->gamma;
        } else if (rbdi_is(l, RBDI_BLOCK)) {
            from += i == from;
            w->angle[i] = rbdi_zero();
            w->block[l->block].X = rbdi_block_pose(l, rbdi_block_of(m, l), &q[l->iq]);
        } else {
            plain = 0;
            w->angle[i] = rbdi_zero();
            if (l->rho > 0 && rbdi_is(l, RBDI_SCREW)) w->angle[i] = q[l->iq] + l->gamma;
            if (rbdi_is(l, RBDI_SCREW)) w->d[i] = q[l->iq] * l->kappa + l->d;
        }
    }

#ifdef RBDI_POLYNOMIAL_SINCOS
    rbdi_sincos_array(w->angle, w->quarters, from, end, w->sine, w->cosine);
#elif defined RBDI_SINCOS /* rbd-codegen records the two for itself */
    for (int i = from; i < end; ++i)
        RBDI_SINCOS(w->angle[i], (int)m->link[i].quarters, &w->sine[i], &w->cosine[i]);
#else
    for (int i = from; i < end; ++i) rbdi_sincos_link(&m->link[i], w->angle[i], &w->sine[i], &w->cosine[i]);
#endif
    if (plain) return;

    /* joints whose q is (cos, sin), and links that only slide */
    for (int i = from; i < end; ++i) {
        const rbdi_link *l = &m->link[i];

        if (rbdi_is(l, RBDI_REVOLUTE_CS)) {
            rbd_real c, s;
            rbdi_unit_cs(&q[l->iq], &c, &s);
            w->cosine[i] = c * l->cg - s * l->sg;
            w->sine[i] = c * l->sg + s * l->cg;
        } else if (rbdi_is(l, RBDI_SCREW) && !(l->rho > 0)) {
            w->cosine[i] = rbdi_set(l->cg);
            w->sine[i] = rbdi_set(l->sg);
        }
    }
}

/* The same of all links. */
RBDI_INLINE void rbdi_joints(const rbd_model *m, rbd_work *w, const rbd_real *q) {
    rbdi_range_joints(m, w, 0, m->nl, q);
}

/* The state of a one-axis joint after rbdi_joints or rbdi_range_joints. */
RBDI_INLINE rbdi_trig rbdi_trig_of(const rbd_model *m, const rbd_work *w, int i, int flags) {
    rbdi_trig t;
    t.c = w->cosine[i];
    t.s = w->sine[i];
    t.d = flags & RBDI_SLIDES ? w->d[i] : rbdi_set(m->link[i].d);
    return t;
}

/* RBDI_BY_FLAGS(const int flags, link, call) makes the call with the link's flags in a constant that it
   declares, here `flags`. It dispatches on them, so that the most common ones are known to the compiler:
   revolute links without armature in Denavit and Hartenberg's form, parallel to their parent or at a right
   angle, and the first links of a branch at such an angle. Each case is a copy of the code. Targets without
   SIMD, such as microcontrollers, have one case for right angles, which tests the shifts. Its empty assembly
   hides from clang that shifts_ equals flags_: clang would replace it, and lose the constants. Targets
   without a floating-point unit have no case, which would save two per cent there. */
#define RBDI_CASE(known, constant, call) \
    case known: { \
        constant = known; \
        call; \
    } break;
#if !defined __OPTIMIZE__ || !RBDI_HARD_FLOAT || RBDI_REAL_KIND % 3 == 0
#define RBDI_CASES(constant, call)
#elif RBDI_SIMD > 0 && RBDI_FOR_SPEED
#define RBDI_CASES(constant, call) \
    RBDI_CASE(RBDI_TWIST_90, constant, call) \
    RBDI_CASE(RBDI_TWIST_90 | RBDI_SHIFT_Z, constant, call) \
    RBDI_CASE(RBDI_TWIST_90 | RBDI_SHIFT_R, constant, call) \
    RBDI_CASE(RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_SHIFT_Z, constant, call) \
    RBDI_CASE(RBDI_TWIST_0 | RBDI_SHIFT_R, constant, call) \
    RBDI_CASE(RBDI_OFF_CHAIN | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_SHIFT_XYZ | RBDI_BRANCH_TURN, constant, \
              call) \
    RBDI_CASE(RBDI_OFF_CHAIN | RBDI_TWIST_0 | RBDI_SHIFT_R | RBDI_SHIFT_XYZ, constant, call)
#else
#define RBDI_CASES(constant, call) \
    case RBDI_TWIST_90: \
    case RBDI_TWIST_90 | RBDI_SHIFT_Z: \
    case RBDI_TWIST_90 | RBDI_SHIFT_R: \
    case RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_SHIFT_Z: { \
        int shifts_ = flags_; \
        RBDI_ONE_INDEX(shifts_); \
        constant = RBDI_TWIST_90 | (shifts_ & (RBDI_SHIFT_R | RBDI_SHIFT_Z)); \
        call; \
    } break; \
        RBDI_CASE(RBDI_TWIST_0 | RBDI_SHIFT_R, constant, call)
#endif
#define RBDI_NO_CASES(constant, call)
#define RBDI_BY_FLAGS_OF(cases, constant, link, call) \
    do { \
        const int flags_ = rbdi_flags(link); \
        switch (flags_) { \
        default: { \
            constant = flags_; \
            call; \
        } break; \
            cases(constant, call) \
        } \
    } while (0)
#if RBDI_FOR_SPEED
#define RBDI_BY_FLAGS(constant, link, call) RBDI_BY_FLAGS_OF(RBDI_CASES, constant, link, call)
#else
#define RBDI_BY_FLAGS(constant, link, call) RBDI_BY_FLAGS_OF(RBDI_NO_CASES, constant, link, call)
#endif

/* The vector x from the parent's axes to those of a one-axis link. */
RBDI_INLINE rbdi_v3 rbdi_down(const rbdi_link *l, int flags, rbdi_trig t, rbdi_v3 x) {
    if (flags & RBDI_BRANCH_TURN) x = rbdi_turn_z(0, rbdi_set(l->cb), rbdi_set(l->sb), x);
    x = rbdi_uncycle(rbdi_turn_z(flags, rbdi_set(l->ca), rbdi_set(l->sa), rbdi_cycle(x)));
    return rbdi_turn_z(0, t.c, t.s, x);
}

/* omega x r, for the parent-side shift r. */
RBDI_INLINE rbdi_v3 rbdi_cross_shift(const rbdi_link *l, int flags, rbdi_v3 omega) {
    rbdi_v3 x = rbdi_vec(rbdi_zero(), omega.z * l->r.x, -(omega.y * l->r.x));
    if (flags & RBDI_SHIFT_XYZ) {
        x.x = omega.y * l->r.z - omega.z * l->r.y;
        x.y = x.y - omega.x * l->r.z;
        x.z = x.z + omega.x * l->r.y;
    }
    return x;
}

/* The force F of a one-axis link to the parent's axes and origin: rbdi_array_up of six scalars, rbdi_batch_up
   of six batches. */
#define RBDI_T rbd_real
/* Turns (x, y) back by an angle with cosine c and sine s, or as the flags say: see rbdi_turn_up_z. */
RBDI_INLINE void rbdi_array_turn(int flags, rbd_real c, rbd_real s, RBDI_T *x, RBDI_T *y) {
    const RBDI_T x0 = *x, y0 = *y;
    if (flags & RBDI_TWIST_0) return;

    *x = -y0;
    *y = x0;
    if (flags & RBDI_TWIST_90) return;

    *x = x0 * c - y0 * s;
    *y = x0 * s + y0 * c;
}

/* F = (n; f), each of its six components an RBDI_T: the moment of the slide d, the turns by q, alpha and
   beta, the moment of the shift r. n += r x f. */
RBDI_INLINE void rbdi_array_up(const rbdi_link *l, int flags, rbdi_trig t, RBDI_T *F) {
    if (flags & RBDI_SHIFT_Z) {
        F[0] = F[0] - F[4] * t.d;
        F[1] = F[1] + F[3] * t.d;
    }

    RBDI_UNROLL_SIX for (int k = 0; k < 6; k += 3) {
        rbdi_array_turn(0, t.c, t.s, &F[k], &F[k + 1]);
        rbdi_array_turn(flags, rbdi_set(l->ca), rbdi_set(l->sa), &F[k + 1], &F[k + 2]);
        if (flags & RBDI_BRANCH_TURN) rbdi_array_turn(0, rbdi_set(l->cb), rbdi_set(l->sb), &F[k], &F[k + 1]);
    }
    if (!(flags & RBDI_SHIFT_R)) return;

    F[1] = F[1] - F[5] * l->r.x;
    F[2] = F[2] + F[4] * l->r.x;
    if (flags & RBDI_SHIFT_XYZ) {
        F[0] = F[0] + (F[5] * l->r.y - F[4] * l->r.z);
        F[1] = F[1] + F[3] * l->r.z;
        F[2] = F[2] - F[3] * l->r.y;
    }
}
#undef RBDI_T
#if RBDI_BATCH > 1
#define RBDI_T rbdi_batch
#define rbdi_array_turn rbdi_batch_turn
#define rbdi_array_up rbdi_batch_up
/* Turns (x, y) back by an angle with cosine c and sine s, or as the flags say: see rbdi_turn_up_z. */
RBDI_INLINE void rbdi_array_turn(int flags, rbd_real c, rbd_real s, RBDI_T *x, RBDI_T *y) {
    const RBDI_T x0 = *x, y0 = *y;
    if (flags & RBDI_TWIST_0) return;

    *x = -y0;
    *y = x0;
    if (flags & RBDI_TWIST_90) return;

    *x = x0 * c - y0 * s;
    *y = x0 * s + y0 * c;
}

/* F = (n; f), each of its six components an RBDI_T: the moment of the slide d, the turns by q, alpha and
   beta, the moment of the shift r. n += r x f. */
RBDI_INLINE void rbdi_array_up(const rbdi_link *l, int flags, rbdi_trig t, RBDI_T *F) {
    if (flags & RBDI_SHIFT_Z) {
        F[0] = F[0] - F[4] * t.d;
        F[1] = F[1] + F[3] * t.d;
    }

    RBDI_UNROLL_SIX for (int k = 0; k < 6; k += 3) {
        rbdi_array_turn(0, t.c, t.s, &F[k], &F[k + 1]);
        rbdi_array_turn(flags, rbdi_set(l->ca), rbdi_set(l->sa), &F[k + 1], &F[k + 2]);
        if (flags & RBDI_BRANCH_TURN) rbdi_array_turn(0, rbdi_set(l->cb), rbdi_set(l->sb), &F[k], &F[k + 1]);
    }
    if (!(flags & RBDI_SHIFT_R)) return;

    F[1] = F[1] - F[5] * l->r.x;
    F[2] = F[2] + F[4] * l->r.x;
    if (flags & RBDI_SHIFT_XYZ) {
        F[0] = F[0] + (F[5] * l->r.y - F[4] * l->r.z);
        F[1] = F[1] + F[3] * l->r.z;
        F[2] = F[2] - F[3] * l->r.y;
    }
}
#undef rbdi_array_up
#undef rbdi_array_turn
#undef RBDI_T
#endif

RBDI_INLINE rbdi_force rbdi_force_up(const rbdi_link *l, int flags, rbdi_trig t, rbdi_force F) {
    rbd_real array[6];
    rbdi_store_force(array, 1, F);
    rbdi_array_up(l, flags, t, array);
    return rbdi_load_force(array, 1);
}

/* The same of a block. */
RBDI_INLINE rbdi_force rbdi_force_up_block(const rbdi_pose *X, rbdi_force F) {
    F.f = rbdi_mul_t(X->E, F.f);
    F.n = rbdi_add(rbdi_mul_t(X->E, F.n), rbdi_cross(X->r, F.f));
    return F;
}

/* S' F of a one-axis joint. */
RBDI_INLINE rbd_real rbdi_along_axis(const rbdi_link *l, int flags, rbdi_force F) {
    return flags & RBDI_SLIDES ? F.n.z * l->rho + F.f.z * l->kappa : F.n.z;
}

/* S v of a block. */
RBDI_INLINE rbdi_motion rbdi_block_motion(const rbdi_block *b, const rbd_real *v) {
    rbd_real array[6];
    if (b->n == 6) return rbdi_load_motion(v, 1);
    for (int k = 0; k < 6; ++k) array[k] = rbdi_zero();
    for (int k = 0; k < b->n; ++k) array[b->first + k] = v[k];
    return rbdi_load_motion(array, 1);
}

/* ==== src/model/limits.h ==== */
/* Interface: rbdi_both_limits, rbdi_limits, rbdi_limits_of, rbdi_limits_of_mimic */

/* ---- limits of joints [joint limits] ----
   A joint that mimics another, x = ratio q + offset, has no coordinate of its own: its limits bound that of
   the other. */

/* lower <= q <= upper; RBDI_UNBOUNDED and more is none. */
typedef struct rbdi_limits {
    rbd_const lower, upper;
} rbdi_limits;

/* The stricter of two pairs of limits. */
RBDI_PART rbdi_limits rbdi_both_limits(rbdi_limits x, rbdi_limits y) {
    rbdi_limits both;
    both.lower = x.lower > y.lower ? x.lower : y.lower;
    both.upper = x.upper < y.upper ? x.upper : y.upper;
    return both;
}

/* Limits of a body's joint, in its own coordinate; both 0 means none. */
RBDI_PART rbdi_limits rbdi_limits_of(const rbdi_frame *u) {
    const rbdi_limits none = {-RBDI_UNBOUNDED, RBDI_UNBOUNDED};
    rbdi_limits x;
    x.lower = u->lower;
    x.upper = u->upper;
    return x.lower < x.upper ? x : none;
}

/* Limits of mimic joint i in the coordinate of the joint that it follows: q = (x - offset) / ratio. */
RBDI_PART rbdi_limits rbdi_limits_of_mimic(const rbd_model *m, int i) {
    const rbdi_mimic *mimic = &m->mimic[i];
    const rbdi_limits own = rbdi_limits_of(&m->frame[m->dof[m->nv + i].body]);
    const int turned = mimic->ratio < 0;
    rbdi_limits led;
    if (own.lower <= -RBDI_UNBOUNDED) return own;

    led.lower = ((turned ? own.upper : own.lower) - mimic->offset) / mimic->ratio;
    led.upper = ((turned ? own.lower : own.upper) - mimic->offset) / mimic->ratio;
    return led;
}

/* ==== src/dynamics/state.h ==== */
/* Interface: rbdi_expand_q, rbdi_expand_v, rbdi_external, rbdi_forward, rbdi_reduce_tau, rbdi_world_state */

/* ---- state [state] ----
   Velocity and acceleration of a link from its parent's, p: RBDA section 5.3 with classical accelerations. E
   = down, z the joint's axis, Omega as in [design]:

       omega     = E omega_p + z turn                         turn, slide = rho, kappa times qd
       omega_dot = E omega_dot_p + (E omega_p) x z turn + z turn_dot
       acc       = E (acc_p + Omega_p r) + Omega d z + 2 (E omega_p) x z slide + z slide_dot

   Table 5.1 has a_i = X a_p + S qdd + c with c = v x S qd. The terms of c with linear velocity are in Omega
   here. */

/* Velocity-product terms that a joint with velocity J adds to (omega_dot; acc), with omega_E = E omega_p:

       (omega_E x J_omega; (2 omega_E + J_omega) x J_v) */
RBDI_INLINE rbdi_motion rbdi_joint_product(rbdi_v3 omega_E, rbdi_motion J) {
    rbdi_motion c;
    c.omega = rbdi_cross(omega_E, J.omega);
    c.v = rbdi_cross(rbdi_add(rbdi_add(omega_E, omega_E), J.omega), J.v);
    return c;
}

/* Acceleration, relative to the parent's origin, of the point r where the joint sits: Omega r. */
RBDI_INLINE rbdi_v3 rbdi_shift_acceleration(const rbdi_link *l, int flags, rbdi_state p) {
    const rbdi_mat O = rbdi_omega(p.omega, p.omega_dot);
    if (flags & RBDI_SHIFT_XYZ) return rbdi_mul(O, rbdi_vec_c(l->r));
    return rbdi_vec(O.xx * l->r.x, O.yx * l->r.x, O.zx * l->r.x);
}

/* Velocity and acceleration of a one-axis link from its parent's, p, by the formulas of [state]. The linear
   velocity never appears. */
RBDI_INLINE rbdi_state rbdi_forward_axis(const rbdi_link *l, int flags, rbdi_trig t, rbdi_state p,
                                         rbd_real qd, rbd_real qdd) {
    const int screw = flags & RBDI_SLIDES;
    rbd_real turn = screw ? qd * l->rho : qd, turn_rate = screw ? qdd * l->rho : qdd;
    rbdi_v3 omega_E = rbdi_vec0(); /* E omega_p */
    rbdi_state s;

    /* omega, omega_dot, acc_p + Omega_p r */
    if (flags & RBDI_ROOT) {
        s.omega = rbdi_vec(rbdi_zero(), rbdi_zero(), turn);
        s.omega_dot = rbdi_vec(rbdi_zero(), rbdi_zero(), turn_rate);
    } else {
        omega_E = rbdi_down(l, flags, t, p.omega);
        s.omega_dot = rbdi_down(l, flags, t, p.omega_dot);
        s.omega_dot = rbdi_vec(s.omega_dot.x + turn * omega_E.y, s.omega_dot.y - turn * omega_E.x,
                               s.omega_dot.z + turn_rate);
        s.omega = rbdi_vec(omega_E.x, omega_E.y, omega_E.z + turn);
        if (flags & RBDI_SHIFT_R) p.acc = rbdi_add(p.acc, rbdi_shift_acceleration(l, flags, p));
    }

    /* acc = E (acc_p + Omega_p r) + Omega d z + 2 (E omega_p) x z slide + z slide_dot */
    s.acc = rbdi_down(l, flags, t, p.acc);
    if (flags & RBDI_SHIFT_Z) { /* Omega z is also that of the parent: the axis is fixed in both bodies */
        const rbdi_mat O = rbdi_omega(s.omega, s.omega_dot);
        s.acc.x = s.acc.x + t.d * O.xz;
        s.acc.y = s.acc.y + t.d * O.yz;
        s.acc.z = s.acc.z + t.d * O.zz;
    }

    if (screw) {
        rbd_real twice_slide = (qd + qd) * l->kappa;
        s.acc.x = s.acc.x + twice_slide * omega_E.y;
        s.acc.y = s.acc.y - twice_slide * omega_E.x;
        s.acc.z = s.acc.z + qdd * l->kappa;
    }

    return s;
}

/* The same of a block. s: the parent's state, which becomes the link's. With J = S v, Jd = S a, omega_E =
   E omega_p and c of rbdi_joint_product:

       omega     = omega_E + J_omega
       omega_dot = E omega_dot_p + c_omega + Jd_omega
       acc       = E (acc_p + Omega_p r) + c_v + Jd_v */
RBDI_PART void rbdi_forward_block(const rbd_model *m, const rbd_work *w, const rbdi_link *l,
                                  const rbd_real *v, const rbd_real *a, rbdi_state *s) {
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_pose *X = &w->block[l->block].X;
    const rbdi_motion J = rbdi_block_motion(b, &v[l->iv]), Jd = rbdi_block_motion(b, &a[l->iv]);
    rbdi_motion c;
    rbdi_v3 omega_E = rbdi_vec0();
    rbdi_v3 omega_dot = omega_E;
    rbdi_v3 acc = s->acc;

    if (!rbdi_on_world(l)) { /* the world does not turn */
        omega_E = rbdi_mul(X->E, s->omega);
        omega_dot = rbdi_mul(X->E, s->omega_dot);
        acc = rbdi_add(acc, rbdi_mul(rbdi_omega(s->omega, s->omega_dot), X->r));
    }

    c = rbdi_joint_product(omega_E, J);
    s->omega = rbdi_add(omega_E, J.omega);
    s->omega_dot = rbdi_add(omega_dot, rbdi_add(c.omega, Jd.omega));
    s->acc = rbdi_add(rbdi_mul(X->E, acc), rbdi_add(c.v, Jd.v));
}

/* The state that the world gives to the roots: gravity as an upward acceleration. */
RBDI_INLINE rbdi_state rbdi_world_state(rbdi_c3 gravity) {
    rbdi_state s;
    s.omega = s.omega_dot = rbdi_vec0();
    s.acc = rbdi_sub(rbdi_vec0(), rbdi_vec_c(gravity));
    return s;
}

/* Wrench that moves a link, with O = Omega:

       f = Omega h + m acc,   n = (K_zy - K_yz; K_xz - K_zx; K_yx - K_xy),   K = Omega Sigma + acc h'

   A regrouped revolute link has m = h_z = Sigma_zz = 0. acc = NULL means zero. */
RBDI_INLINE rbdi_force rbdi_wrench(const rbdi_link *l, int flags, rbdi_mat O, const rbdi_v3 *acc) {
    const rbdi_csym Sigma = l->Sigma;
    const rbdi_c3 h = l->h;
    rbdi_force F;

    /* Omega h and Omega Sigma, without h_z and Sigma_zz */
    F.f.x = O.xx * h.x + O.xy * h.y;
    F.f.y = O.yx * h.x + O.yy * h.y;
    F.f.z = O.zx * h.x + O.zy * h.y;
    F.n.x = O.zx * Sigma.xy + O.zy * Sigma.yy + (O.zz - O.yy) * Sigma.yz - O.yx * Sigma.xz;
    F.n.y = O.xy * Sigma.yz + (O.xx - O.zz) * Sigma.xz - O.zx * Sigma.xx - O.zy * Sigma.xy;
    F.n.z = O.yx * Sigma.xx + (O.yy - O.xx) * Sigma.xy + O.yz * Sigma.xz - O.xy * Sigma.yy - O.xz * Sigma.yz;

    /* acc h', without h_z */
    if (acc) {
        F.n.x = F.n.x + acc->z * h.y;
        F.n.y = F.n.y - acc->z * h.x;
        F.n.z = F.n.z + (acc->y * h.x - acc->x * h.y);
    }

    /* the terms of m, h_z and Sigma_zz */
    if (flags & RBDI_MASS_KEPT) {
        F.f.x = F.f.x + O.xz * h.z;
        F.f.y = F.f.y + O.yz * h.z;
        F.f.z = F.f.z + O.zz * h.z;
        F.n.x = F.n.x - O.yz * Sigma.zz;
        F.n.y = F.n.y + O.xz * Sigma.zz;

        if (acc) {
            F.f.x = F.f.x + acc->x * l->mass;
            F.f.y = F.f.y + acc->y * l->mass;
            F.f.z = F.f.z + acc->z * l->mass;
            F.n.x = F.n.x - acc->y * h.z;
            F.n.y = F.n.y + acc->x * h.z;
        }
    }

    return F;
}

/* One step of the sweep root to leaf: the state of link i from that of link i - 1, or from the parent's kept
   state; and the wrench that moves the link, if wanted. */
RBDI_INLINE rbdi_state rbdi_forward_step(const rbd_model *m, rbd_work *w, int i, int flags,
                                         const rbdi_state *world, const rbd_real *v, const rbd_real *a,
                                         rbdi_state s, int wrench) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;

    if (off_chain && l->parent != i - 1)
        s = l->parent < 0 ? *world : w->branch[m->link[l->parent].branch].state;
    if (rbdi_block_link(l, flags)) {
        rbdi_state block = s; /* an address of s would keep it in memory */
        rbdi_forward_block(m, w, l, v, a, &block);
        s = block;
    } else {
        s = rbdi_forward_axis(l, flags, rbdi_trig_of(m, w, i, flags), s, v[l->iv], a[l->iv]);
    }

    if (wrench) w->scratch[i].f = rbdi_wrench(l, flags, rbdi_omega(s.omega, s.omega_dot), &s.acc);
    if (off_chain && l->branch >= 0) w->branch[l->branch].state = s;
    return s;
}

/* The states of the links first .. end - 1, after those of their ancestors, with the wrenches if wanted;
   keep: stored in kin as well. */
RBDI_INLINE void rbdi_forward(const rbd_model *m, rbd_work *w, int first, int end, const rbdi_state *world,
                              const rbd_real *v, const rbd_real *a, int wrench, int keep) {
    rbdi_state s = *world;
    for (int i = first; i < end; ++i) {
        RBDI_BY_FLAGS(const int flags, &m->link[i],
                      s = rbdi_forward_step(m, w, i, flags, world, v, a, s, wrench));
        if (keep) w->kin[i].state = s;
    }
}

/* With mimic joints the algorithms run on coordinates with the mimics' appended; without, on the
   caller's own arrays. */
RBDI_PART const rbd_real *rbdi_expand_q(const rbd_model *m, rbd_work *w, const rbd_real *q) {
    if (rbdi_mimics(m) == 0) return q;
    for (int k = 0; k < m->nq; ++k) w->qx[k] = q[k];
    for (int k = 0; k < rbdi_mimics(m); ++k)
        w->qx[m->nq + k] = q[m->mimic[k].source_q] * m->mimic[k].ratio + m->mimic[k].offset;
    return w->qx;
}

RBDI_PART const rbd_real *rbdi_expand_v(const rbd_model *m, const rbd_real *v, rbd_real *vx) {
    if (rbdi_mimics(m) == 0) return v;
    for (int k = 0; k < m->nv; ++k) vx[k] = v[k];
    for (int k = 0; k < rbdi_mimics(m); ++k) vx[m->nv + k] = v[m->mimic[k].source_v] * m->mimic[k].ratio;
    return vx;
}

/* tau = G' tau_x, for v_x = G v. */
RBDI_PART void rbdi_reduce_tau(const rbd_model *m, const rbd_real *tx, rbd_real *tau) {
    if (rbdi_mimics(m) == 0) return;
    for (int k = 0; k < m->nv; ++k) tau[k] = tx[k];
    for (int k = 0; k < rbdi_mimics(m); ++k)
        tau[m->mimic[k].source_v] = tau[m->mimic[k].source_v] + tx[m->nv + k] * m->mimic[k].ratio;
}

/* Subtracts the external wrenches, given in the user's frames, from those of the links. */
RBDI_PART void rbdi_external(const rbd_model *m, rbd_work *w, const rbd_real *f_ext) {
    const int bodies = f_ext ? m->nb : 0;

    for (int body = 0; body < bodies; ++body) {
        const rbdi_frame *u = &m->frame[body];
        rbdi_pose X;
        if (u->link < 0) continue;
        X.E = rbdi_mat_c(u->E);
        X.r = rbdi_vec_c(u->r);
        w->scratch[u->link].f = rbdi_force_sub(w->scratch[u->link].f,
                                               rbdi_force_up_block(&X, rbdi_load_force(f_ext + 6 * body, 1)));
    }
}

/* ==== src/dynamics/rnea.h ==== */
/* Interface: rbdi_rnea, rbdi_rnea_sweep */

/* ---- rnea [rnea] ----
   RBDA table 5.1. Down: v_i, a_i ([state]), and f_i = I_i a_i + v_i x* I_i v_i - X* f_ext from them, here
   by Omega (rbdi_wrench). Up: tau_i = S_i' f_i, f_p += X' f_i for the parent p. The table has no armature
   and one external wrench a link; here each body has one, in its own frame. Gravity is an acceleration of
   the world. */

/* tau of a one-axis joint from the force F on its link. Returns F at the parent's origin, in its axes. */
RBDI_INLINE rbdi_force rbdi_rnea_up(const rbd_model *m, const rbd_work *w, int i, int flags, rbdi_force F,
                                    const rbd_real *a, rbd_real *tau) {
    const rbdi_link *l = &m->link[i];
    rbd_real torque = rbdi_along_axis(l, flags, F);
    if (flags & RBDI_ARMATURE) torque = torque + a[l->iv] * m->dof[l->iv].armature;
    tau[l->iv] = torque; /* which may be a */
    return flags & RBDI_ROOT ? F : rbdi_force_up(l, flags, rbdi_trig_of(m, w, i, flags), F);
}

/* The same of a block; F becomes the parent's. */
RBDI_PART void rbdi_rnea_up_block(const rbd_model *m, const rbd_work *w, const rbdi_link *l,
                                  const rbd_real *a, rbd_real *tau, rbdi_force *F) {
    const rbdi_block *b = rbdi_block_of(m, l);
    rbd_real array[6];

    rbdi_store_force(array, 1, *F);
    for (int k = 0; k < b->n; ++k) {
        rbd_real torque = array[b->first + k];
        if (rbdi_flags(l) & RBDI_ARMATURE) torque = torque + a[l->iv + k] * m->dof[l->iv + k].armature;
        tau[l->iv + k] = torque;
    }

    if (!rbdi_on_world(l)) *F = rbdi_force_up_block(&w->block[l->block].X, *F);
}

/* One step of the sweep up: takes the force from link i + 1, returns that for link i - 1. */
RBDI_INLINE rbdi_force rbdi_rnea_step(const rbd_model *m, const rbd_work *w, int i, int flags,
                                      rbdi_force carried, const rbd_real *a, rbd_real *tau) {
    const rbdi_link *l = &m->link[i];
    rbdi_force F = rbdi_force_add(w->scratch[i].f, carried);

    if (rbdi_block_link(l, flags)) {
        rbdi_force block = F; /* an address of F would keep it in memory */
        rbdi_rnea_up_block(m, w, l, a, tau, &block);
        F = block;
    } else {
        F = rbdi_rnea_up(m, w, i, flags, F, a, tau);
    }
    if (!(flags & RBDI_OFF_CHAIN) || l->parent == i - 1) return F;

    if (l->parent >= 0) w->scratch[l->parent].f = rbdi_force_add(w->scratch[l->parent].f, F);
    return rbdi_force0();
}

/* Torques from the wrenches that move the links. */
RBDI_PART void rbdi_rnea_sweep(const rbd_model *m, const rbd_work *w, const rbd_real *a, rbd_real *tau) {
    rbdi_force carried = rbdi_force0();
    for (int i = m->nl - 1; i >= 0; --i)
        RBDI_BY_FLAGS(const int flags, &m->link[i],
                      carried = rbdi_rnea_step(m, w, i, flags, carried, a, tau));
}

/* RBDA table 5.1 in classical accelerations, after rbdi_joints. */
RBDI_PART void rbdi_rnea(const rbd_model *m, rbd_work *w, const rbd_real *v, const rbd_real *a,
                         const rbd_real *f_ext, rbd_real *tau) {
    const rbdi_state world = rbdi_world_state(w->gravity);
    rbdi_forward(m, w, 0, m->nl, &world, v, a, 1, 0);
    rbdi_external(m, w, f_ext);
    rbdi_rnea_sweep(m, w, a, tau);
}

RBDI_API rbd_status rbd_rnea(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *a, const rbd_real *f_ext, rbd_real *tau) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && a && tau);
    if (status) return status;

    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    v = rbdi_expand_v(m, v, w->vx);
    a = rbdi_expand_v(m, a, w->ax);
    rbdi_rnea(m, w, v, a, f_ext, rbdi_mimics(m) ? w->tx : tau);
    rbdi_reduce_tau(m, w->tx, tau);
    return RBD_OK;
}

RBDI_API rbd_status rbd_bias(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *f_ext, rbd_real *c) {
    if (!w) return RBD_ERR_NULL;
    return rbd_rnea(m, w, q, v, w->zero, f_ext, c);
}

RBDI_API rbd_status rbd_gravity_torque(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *g) {
    if (!w) return RBD_ERR_NULL;
    return rbd_rnea(m, w, q, w->zero, w->zero, NULL, g);
}

/* Table 5.1 with v in the place of a, without velocity and gravity: then the accelerations are velocities V_i
   = (omega_dot; acc), kept in scratch.c, and the wrenches on the links are their momenta. Up, with the
   momenta h_i of the subtrees: p_i = S_i' h_i, (C' v)_i = (dS_i/dt)' h_i = (V_i x S_i)' h_i = -S_i' (V_i x*
   h_i). */
RBDI_PART void rbdi_momenta(const rbd_model *m, rbd_work *w, const rbd_real *v, rbd_real *p, rbd_real *ctv) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    const rbdi_state world = rbdi_world_state(none);
    rbdi_state s = world;

    /* down: V_i, and the momenta of the links */
    for (int i = 0; i < m->nl; ++i) {
        s = rbdi_forward_step(m, w, i, rbdi_flags(&m->link[i]), &world, w->zero, v, s, 1);
        w->scratch[i].c.omega = s.omega_dot;
        w->scratch[i].c.v = s.acc;
    }

    /* up: p_i = S_i' h_i, (C' v)_i = -S_i' (V_i x* h_i) */
    for (int i = m->nl - 1; i >= 0; --i) {
        const rbdi_link *l = &m->link[i];
        const rbdi_motion V = w->scratch[i].c;
        rbdi_force h = w->scratch[i].f, h_x_V; /* -V x* h */

        h_x_V.n = rbdi_add(rbdi_cross(h.n, V.omega), rbdi_cross(h.f, V.v));
        h_x_V.f = rbdi_cross(h.f, V.omega);

        if (rbdi_is(l, RBDI_BLOCK)) {
            rbdi_rnea_up_block(m, w, l, v, p, &h);
            rbdi_rnea_up_block(m, w, l, w->zero, ctv, &h_x_V);
        } else {
            h = rbdi_rnea_up(m, w, i, rbdi_flags(l), h, v, p);
            rbdi_rnea_up(m, w, i, rbdi_flags(l) | RBDI_ROOT, h_x_V, w->zero, ctv);
        }

        if (l->parent >= 0) w->scratch[l->parent].f = rbdi_force_add(w->scratch[l->parent].f, h);
    }
}

RBDI_API rbd_status rbd_generalized_momentum(const rbd_model *m, rbd_work *w, const rbd_real *q,
                                             const rbd_real *v, rbd_real *p, rbd_real *ctv) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && v);
    if (status) return status;

    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    if (!p) p = w->bias;
    if (!ctv) ctv = w->bias;
    rbdi_momenta(m, w, rbdi_expand_v(m, v, w->vx), rbdi_mimics(m) ? w->tx : p, rbdi_mimics(m) ? w->ax : ctv);
    rbdi_reduce_tau(m, w->tx, p);
    rbdi_reduce_tau(m, w->ax, ctv);
    return RBD_OK;
}

RBDI_API rbd_status rbd_passive(const rbd_model *m, rbd_work *w, const rbd_real *v, rbd_real *tau) {
    const rbd_real *vx;
    rbd_real *tx;
    const rbd_status status = rbdi_check(m, w, v && tau);
    if (status) return status;

    /* tau = -damping v - friction sign(v) */
    vx = rbdi_expand_v(m, v, w->vx);
    tx = rbdi_mimics(m) ? w->tx : tau;
    for (int k = 0; k < m->nv + rbdi_mimics(m); ++k) {
        rbd_real o = rbdi_zero(), f = rbdi_set(m->dof[k].friction), x = vx[k];
        rbd_real sign = rbdi_select(rbdi_less(x, o), f, rbdi_select(rbdi_less(o, x), -f, o));
        tx[k] = sign - x * m->dof[k].damping;
    }

    rbdi_reduce_tau(m, tx, tau);
    return RBD_OK;
}

/* ==== src/dynamics/crba.h ==== */
/* Interface: rbdi_crba_of_joints, rbdi_crba_up_block, rbdi_ratio, rbdi_source */

/* ---- crba [crba] ----
   RBDA table 6.2: I^c_i = I_i + sum over the children of X' I^c X; F = I^c_i S_i; H_ii = S_i' F; and for
   every j on the path to the root F = X' F, H_ij = F' S_j. Here the wrenches of all dofs of link i's subtree
   stand side by side, by component, in link i's frame: the entries of its dof with all of them are one
   component (the moment about z; of a screw two, of a block n). Then all take the step to the parent
   together, a batch at a time. Of I^c only Sigma and h depend on q: the subtree's mass is a constant. */

/* Composite body of a link, to the parent's axes and origin. */
RBDI_INLINE rbdi_rbi rbdi_rbi_up(const rbdi_link *l, int flags, rbdi_trig t, rbdi_rbi C) {
    if (flags & RBDI_SHIFT_Z) C = rbdi_rbi_shift_z(t.d, l->subtree_mass, C);
    C = rbdi_rbi_up_z(0, t.c, t.s, C);
    C = rbdi_rbi_up_z(flags, rbdi_set(l->ca), rbdi_set(l->sa), rbdi_rbi_cycle(C));
    if (!(flags & RBDI_SHIFT_R)) return rbdi_rbi_uncycle(C);
    if (!(flags & RBDI_SHIFT_XYZ))
        return rbdi_rbi_uncycle(rbdi_rbi_shift_z(rbdi_set(l->r.x), l->subtree_mass, C));

    C = rbdi_rbi_uncycle(C);
    if (flags & RBDI_BRANCH_TURN) C = rbdi_rbi_up_z(0, rbdi_set(l->cb), rbdi_set(l->sb), C);
    return rbdi_rbi_shift(rbdi_vec_c(l->r), l->subtree_mass, C);
}

RBDI_INLINE rbdi_rbi rbdi_rbi_up_block(const rbdi_pose *X, rbd_const mass, rbdi_rbi C) {
    C.Sigma = rbdi_sym_up(X->E, C.Sigma);
    C.h = rbdi_mul_t(X->E, C.h);
    return rbdi_rbi_shift(X->r, mass, C);
}

/* C plus the link's own body. */
RBDI_INLINE rbdi_rbi rbdi_rbi_add_link(const rbdi_link *l, rbdi_rbi C) {
    C.Sigma = rbdi_sym_add(C.Sigma, rbdi_sym_c(l->Sigma));
    C.h = rbdi_add(C.h, rbdi_vec_c(l->h));
    return C;
}

/* Wrench that gives the composite body C unit acceleration along spatial axis k: column k of
   [I [h]x; -[h]x mass], I = tr(Sigma) - Sigma. */
RBDI_INLINE rbdi_force rbdi_rbi_column(rbdi_rbi C, rbd_const subtree_mass, int k) {
    const rbd_real o = rbdi_zero(), mass = rbdi_set(subtree_mass);
    rbdi_force F;

    switch (k) {
    case 0:
        F.n = rbdi_vec(C.Sigma.yy + C.Sigma.zz, -C.Sigma.xy, -C.Sigma.xz);
        F.f = rbdi_vec(o, -C.h.z, C.h.y);
        break;
    case 1:
        F.n = rbdi_vec(-C.Sigma.xy, C.Sigma.xx + C.Sigma.zz, -C.Sigma.yz);
        F.f = rbdi_vec(C.h.z, o, -C.h.x);
        break;
    case 2:
        F.n = rbdi_vec(-C.Sigma.xz, -C.Sigma.yz, C.Sigma.xx + C.Sigma.yy);
        F.f = rbdi_vec(-C.h.y, C.h.x, o);
        break;
    case 3:
        F.n = rbdi_vec(o, C.h.z, -C.h.y);
        F.f = rbdi_vec(mass, o, o);
        break;
    case 4:
        F.n = rbdi_vec(-C.h.z, o, C.h.x);
        F.f = rbdi_vec(o, mass, o);
        break;
    default:
        F.n = rbdi_vec(C.h.y, -C.h.x, o);
        F.f = rbdi_vec(o, o, mass);
        break;
    }

    return F;
}

/* The same along the axis of a one-axis link: C S. */
RBDI_INLINE rbdi_force rbdi_rbi_axis(const rbdi_link *l, int slides, rbdi_rbi C) {
    rbdi_force own = rbdi_rbi_column(C, l->subtree_mass, 2);
    if (slides) {
        rbdi_force slide = rbdi_rbi_column(C, l->subtree_mass, 5);
        own.n = rbdi_add(rbdi_scale(rbdi_set(l->rho), own.n), rbdi_scale(rbdi_set(l->kappa), slide.n));
        own.f = rbdi_add(rbdi_scale(rbdi_set(l->rho), own.f), rbdi_scale(rbdi_set(l->kappa), slide.f));
    }
    return own;
}

/* Moves the wrenches of the dofs of link i's subtree to the parent's frame: those in w->F, and `own` of its
   own dof, which is not there yet. They are kept by component, so that a batch of them moves at once. Batches
   count from the last dof down. The last one may reach below the first dof, where nothing is set yet. `own`
   goes directly into the batch: to load a batch where scalars were just stored makes the processor wait. */
RBDI_INLINE void rbdi_crba_up(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                              rbdi_force own) {
    const rbdi_link *l = &m->link[i];
    const rbdi_trig t = rbdi_trig_of(m, w, i, flags);
#if RBDI_BATCH > 1
    rbd_real F[6];

    rbdi_store_force(F, 1, own);
    for (int k = l->end - RBDI_BATCH; k > l->first - RBDI_BATCH; k -= RBDI_BATCH) {
        rbdi_batch x[6];
        rbd_real *moment = &w->F[k], *force = moment + 3 * stride;

        RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) {
            x[j] = *(const rbdi_batch *)&moment[j * stride];
            x[j + 3] = *(const rbdi_batch *)&force[j * stride];
        }

        if (k <= l->first) {
            RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
                x[j] = rbdi_insert(x[j], l->first - k, F[j]);
        }

        rbdi_batch_up(l, flags, t, x);
        RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) {
            *(rbdi_batch *)&moment[j * stride] = x[j];
            *(rbdi_batch *)&force[j * stride] = x[j + 3];
        }
    }
#else
    rbdi_store_force(&w->F[l->first], stride, own);
    for (int k = l->first; k < l->end; ++k)
        rbdi_store_force(&w->F[k], stride, rbdi_force_up(l, flags, t, rbdi_load_force(&w->F[k], stride)));
#endif
}

RBDI_PART void rbdi_crba_up_block(const rbdi_pose *X, rbd_real *F, ptrdiff_t stride, int n) {
    for (int k = 0; k < n; ++k)
        rbdi_store_force(&F[k], stride, rbdi_force_up_block(X, rbdi_load_force(&F[k], stride)));
}

/* Where the entries of an ancestor dof k go: the column of packed rows at its depth, or row and column k of
   the full matrix. */
typedef struct rbdi_entries {
    int full, nv;
    rbd_real *H, *row, *column; /* packed: H, full: the others */
    const rbdi_order *order;
} rbdi_entries;

RBDI_INLINE rbdi_entries rbdi_crba_column(const rbd_model *m, int k, int depth, rbd_real *H, rbd_real *M) {
    rbdi_entries e;

    e.full = M != NULL;
    e.H = M ? NULL : H + depth;
    e.row = M ? M + (ptrdiff_t)k * m->nv : NULL;
    e.column = M ? M + k : NULL;
    e.order = m->order;
    e.nv = m->nv;
    return e;
}

/* Stores the entry of the solver's dof j. */
RBDI_INLINE void rbdi_crba_put(rbdi_entries e, int j, rbd_real x) {
    if (!e.full) {
        e.H[e.order[j].row] = x;
        return;
    }
    e.column[(ptrdiff_t)e.order[j].dof * e.nv] = x;
    e.row[e.order[j].dof] = x;
}

/* Block link: the wrenches F that unit accelerations of its own n dofs take, and the entries S' F of these
   and of all dofs of its subtree. */
RBDI_INLINE void rbdi_crba_entries_block(const rbd_model *m, const rbd_work *w, const rbdi_link *l, int first,
                                         int n, ptrdiff_t stride, rbdi_rbi C, rbd_real *H, rbd_real *M) {
    const int iv = l->iv, depth = m->dof[iv].level;
    const rbd_real *F = &w->F[stride * first];

    RBDI_UNROLL_SIX for (int k = 0; k < n; ++k) {
        const rbdi_force own = rbdi_rbi_column(C, l->subtree_mass, first + k);
        rbd_real all[6];
        rbdi_store_force(all, 1, own);
        if (!rbdi_on_world(l)) rbdi_store_force(&w->F[l->first + k], stride, own);
        all[first + k] = all[first + k] + m->dof[iv + k].armature;
        RBDI_UNROLL_SIX for (int j = 0; j <= k; ++j)
            rbdi_crba_put(rbdi_crba_column(m, iv + j, depth + j, H, M), l->first + k, all[first + j]);
    }

    for (int j = l->first + n; j < l->end; ++j) {
        RBDI_UNROLL_SIX for (int k = 0; k < n; ++k)
            rbdi_crba_put(rbdi_crba_column(m, iv + k, depth + k, H, M), j, F[stride * k + j]);
    }
}

/* One-axis link: the entries of its own dof, whose wrench is `own`, and of all others of its subtree. */
RBDI_INLINE void rbdi_crba_entries(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                                   rbdi_force own, rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const rbdi_dof *dof = &m->dof[l->iv];
    const rbdi_entries e = rbdi_crba_column(m, l->iv, dof->level, H, M);
    const rbd_real *n_z = &w->F[2 * stride], *f_z = &w->F[5 * stride];
    rbd_real D = rbdi_along_axis(l, flags, own);

    if (flags & (RBDI_SLIDES | RBDI_ARMATURE)) D = D + dof->armature;
    rbdi_crba_put(e, l->first, D);

    for (int j = l->first + 1; j < l->end; ++j) {
        rbd_real x = n_z[j];
        if (flags & RBDI_SLIDES) x = x * l->rho + f_z[j] * l->kappa;
        rbdi_crba_put(e, j, x);
    }
}

/* The rows and columns of one link's dofs; its composite body and all wrenches of its subtree, to the
   parent's axes and origin. */
RBDI_INLINE rbdi_rbi rbdi_crba_axis(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                                    rbdi_rbi C, rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const rbdi_force own = rbdi_rbi_axis(l, flags & RBDI_SLIDES, C);
    rbdi_crba_entries(m, w, i, flags, stride, own, H, M);
    if (flags & RBDI_ROOT) return C;
    rbdi_crba_up(m, w, i, flags, stride, own);
    return rbdi_rbi_up(l, flags, rbdi_trig_of(m, w, i, flags), C);
}

RBDI_PART void rbdi_crba_block(const rbd_model *m, const rbd_work *w, int i, ptrdiff_t stride, rbdi_rbi *C,
                               rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block *b = rbdi_block_of(m, l);
    const ptrdiff_t usual = RBDI_FIXED_STRIDE ? RBDI_FIXED_STRIDE : stride; /* known to the compiler */

    if (b->n < 6 || stride != usual)
        rbdi_crba_entries_block(m, w, l, b->first, b->n, stride, *C, H, M);
    else if (M)
        rbdi_crba_entries_block(m, w, l, 0, 6, usual, *C, NULL, M);
    else
        rbdi_crba_entries_block(m, w, l, 0, 6, usual, *C, H, NULL);

    if (rbdi_on_world(l)) return;

    rbdi_crba_up_block(&w->block[l->block].X, &w->F[l->first], stride, l->end - l->first);
    *C = rbdi_rbi_up_block(&w->block[l->block].X, l->subtree_mass, *C);
}

/* One step of the sweep leaf to root: takes the composite body carried from link i + 1, returns the one that
   link i passes to link i - 1. */
RBDI_INLINE rbdi_rbi rbdi_crba_step(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                                    rbdi_rbi carried, rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;
    rbdi_rbi C = rbdi_rbi_add_link(l, carried);

    if (off_chain && l->branch >= 0) C = rbdi_rbi_add(C, w->branch[l->branch].C);
    if (rbdi_block_link(l, flags)) {
        rbdi_rbi block = C; /* an address of C would keep it in memory */
        rbdi_crba_block(m, w, i, stride, &block, H, M);
        C = block;
    } else {
        C = rbdi_crba_axis(m, w, i, flags, stride, C, H, M);
    }
    if (!off_chain || l->parent == i - 1) return C;

    if (l->parent >= 0) {
        rbdi_branch *branch = &w->branch[m->link[l->parent].branch];
        branch->C = rbdi_rbi_add(branch->C, C);
    }
    return rbdi_rbi_zero();
}

/* The same with flags and stride that the compiler does not know: for models of more dofs than
   RBDI_FIXED_STRIDE. */
RBDI_PART void rbdi_crba_link(const rbd_model *m, const rbd_work *w, int i, ptrdiff_t stride,
                              rbdi_rbi *carried, rbd_real *H, rbd_real *M) {
    *carried = rbdi_crba_step(m, w, i, rbdi_flags(&m->link[i]), stride, *carried, H, M);
}

/* RBDA table 6.2, into the packed tree matrix H or, if M is given, into the full matrix, which is zero
   before. With mimic joints into H and the rows behind it, which rbdi_reduce_H adds up. `full` is M != NULL,
   known to the compiler: at -Os the full matrix has code for common flags, which saves a fifth of its
   instructions. The packed one has none: there it is a part of larger calls. */
RBDI_INLINE void rbdi_crba(const rbd_model *m, rbd_work *w, rbd_real *H, rbd_real *M, int full) {
    const rbd_model model = *m; /* copies, which no store into H or w->F can be thought to change */
    const rbd_work work = *w;
    const ptrdiff_t stride = rbdi_stride(m), usual = RBDI_FIXED_STRIDE ? RBDI_FIXED_STRIDE : stride;
    rbdi_rbi carried = rbdi_rbi_zero(), any = carried; /* an address of carried would keep it in memory */

    for (int i = 0; i < m->nbranch; ++i) w->branch[i].C = carried;

    /* more dofs than the fixed stride is for */
    for (int i = m->nl - 1; RBDI_FIXED_STRIDE && stride != RBDI_FIXED_STRIDE && i >= 0; --i)
        rbdi_crba_link(&model, &work, i, stride, &any, H, M);
    if (RBDI_FIXED_STRIDE && stride != RBDI_FIXED_STRIDE) return;

    for (int i = m->nl - 1; i >= 0; --i)
        if (RBDI_FOR_SPEED || full)
            RBDI_BY_FLAGS_OF(RBDI_CASES, const int flags, &model.link[i],
                             carried = rbdi_crba_step(&model, &work, i, flags, usual, carried, H, M));
        else
            RBDI_BY_FLAGS_OF(RBDI_NO_CASES, const int flags, &model.link[i],
                             carried = rbdi_crba_step(&model, &work, i, flags, usual, carried, H, M));
}

/* The dof whose velocity dof k has, itself unless it mimics, and its ratio to that. */
RBDI_INLINE int rbdi_source(const rbd_model *m, int k) {
    return k < m->nv ? k : m->mimic[k - m->nv].source_v;
}

RBDI_INLINE rbd_real rbdi_ratio(const rbd_model *m, int k) {
    return rbdi_set(k < m->nv ? RBD_C(1) : m->mimic[k - m->nv].ratio);
}

/* With mimic joints M = G' M_x G for v_x = G v: adds M_x, whose rows stand behind H, to H, which is zero. Off
   its diagonal M_x has every entry twice. */
RBDI_PART void rbdi_reduce_H(const rbd_model *m, rbd_real *H) {
    for (int s = 0; s < m->nv + rbdi_mimics(m); ++s) {
        const int i = m->order[s].dof, a = rbdi_source(m, i);
        const rbd_real *h = &H[m->order[s].row + m->dof[i].level], k = rbdi_ratio(m, i);

        rbd_real *diagonal = &H[m->dof[a].row + m->dof[a].depth];

        *diagonal = *diagonal + *h * k * k;
        for (int j = m->dof[i].before; j >= 0; j = m->dof[j].before) {
            const int b = rbdi_source(m, j);
            rbd_real *entry = &H[m->dof[a > b ? a : b].row + m->dof[a > b ? b : a].depth], x;
            --h;
            x = *h * k;
            if (j >= m->nv) x = x * rbdi_ratio(m, j);
            *entry = *entry + (a == b ? x + x : x);
        }
    }
}

/* M packed, from the joints' transforms. */
RBDI_PART void rbdi_crba_of_joints(const rbd_model *m, rbd_work *w, rbd_real *H) {
    const int mimics = rbdi_mimics(m);

    if (mimics) rbdi_clear(w->H, m->nh);
    rbdi_crba(m, w, mimics ? w->H : H, NULL, 0);
    if (!mimics) return;

    rbdi_reduce_H(m, w->H);
    for (int k = 0; k < m->nh; ++k) H[k] = w->H[k];
}

RBDI_API rbd_status rbd_crba_packed(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *H) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && H);
    if (status) return status;
    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    rbdi_crba_of_joints(m, w, H);
    return RBD_OK;
}

RBDI_API rbd_status rbd_crba(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *M) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && M);
    if (status) return status;

    if (m->nh < m->nv * (m->nv + 1) / 2) rbdi_clear(M, m->nv * m->nv);
    if (rbdi_mimics(m)) {
        rbd_crba_packed(m, w, q, w->H);
        for (int i = 0; i < m->nv; ++i)
            for (int j = i, k = m->dof[i].row + m->dof[i].depth; j >= 0; j = m->dof[j].lambda, --k)
                M[i * m->nv + j] = M[j * m->nv + i] = w->H[k];
        return RBD_OK;
    }

    rbdi_joints(m, w, q);
    rbdi_crba(m, w, NULL, M, 1);
    return RBD_OK;
}

RBDI_API int rbd_packed_size(const rbd_model *m) { return m ? m->nh : 0; }

RBDI_API int rbd_packed_index(const rbd_model *m, int i, int j) {
    int row = i > j ? i : j, column = i > j ? j : i, t;
    if (!m || column < 0 || row >= m->nv) return -1;
    t = m->dof[row].depth;
    for (int k = row; k >= column; k = m->dof[k].lambda, --t)
        if (k == column) return m->dof[row].row + t;
    return -1;
}

/* ==== src/dynamics/aba_elimination.h ==== */
/* Interface: rbdi_free_base */

/* ---- aba [aba] ----
   RBDA table 7.1, its c, pA and a classical ([design]):

       pass 1   omega_i, c_i,  pA_i = wrench with omega_dot = acc = 0   rbdi_aba_velocity, rbdi_wrench
                pA_i -= X* f_ext                                    rbdi_external
       pass 2   U = IA S,  D = S' U,  u = tau - S' pA               rbdi_aba_eliminate
                Ia = IA - U U'/D,  pa = pA + Ia c + U u/D           rbdi_aba_subtract, rbdi_aba_add_bias
                IA_p += X' Ia X,  pA_p += X' pa                     rbdi_abi_up, rbdi_force_up
       pass 3   y = X y_p + c,  qdd = (u - U' y)/D,  y += S qdd     rbdi_aba_carry, rbdi_aba_down

   IA = [I H; H' M]. A revolute joint without armature leaves S' Ia = U' - (D/D) U' = 0: row z of I and H is
   zero and stays zero through the shift along z and the turn about it: rbdi_aba_row_z and rbdi_abi_shift_z
   rely on that. Also S' pa = S' pA + S' Ia c + (S' U/D) u = S' pA + u = tau: the moment on the parent about
   the joint's axis is the torque.

   This room has what pass 2 does with one link, aba.h the three passes. */

/* Whether row z of I and H is not zero after the joint of a one-axis link is eliminated. */
RBDI_INLINE int rbdi_keeps_row_z(int flags) { return flags & (RBDI_SLIDES | RBDI_ARMATURE); }

/* Articulated-body inertia of a one-axis link, to the parent's axes and origin: X' IA X, as the slide d, the
   turns by q, alpha and beta, and the shift r. */
RBDI_INLINE rbdi_abi rbdi_abi_up(const rbdi_link *l, int flags, rbdi_trig t, rbdi_abi IA) {
    if (flags & RBDI_SHIFT_Z) IA = rbdi_abi_shift_z(t.d, rbdi_keeps_row_z(flags), IA);
    IA = rbdi_abi_up_z(0, t.c, t.s, IA);
    IA = rbdi_abi_up_z(flags, rbdi_set(l->ca), rbdi_set(l->sa), rbdi_abi_cycle(IA));
    if (!(flags & RBDI_SHIFT_R)) return rbdi_abi_uncycle(IA);
    if (!(flags & RBDI_SHIFT_XYZ)) return rbdi_abi_uncycle(rbdi_abi_shift_z(rbdi_set(l->r.x), 1, IA));

    IA = rbdi_abi_uncycle(IA);
    if (flags & RBDI_BRANCH_TURN) IA = rbdi_abi_up_z(0, rbdi_set(l->cb), rbdi_set(l->sb), IA);
    return rbdi_abi_shift(rbdi_vec_c(l->r), IA);
}

/* The same of a block. */
RBDI_INLINE rbdi_abi rbdi_abi_up_block(const rbdi_pose *X, rbdi_abi IA) {
    IA.I = rbdi_sym_up(X->E, IA.I);
    IA.H = rbdi_mat_up(X->E, IA.H);
    IA.M = rbdi_sym_up(X->E, IA.M);
    return rbdi_abi_shift(X->r, IA);
}

/* IA plus the link's own inertia [tr(Sigma) - Sigma, [h]x; -[h]x, m]. */
RBDI_INLINE rbdi_abi rbdi_abi_add_link(const rbdi_link *l, int flags, rbdi_abi IA) {
    const rbdi_csym Sigma = l->Sigma;
    const rbdi_c3 h = l->h;

    IA.I.xx = IA.I.xx + (Sigma.yy + Sigma.zz);
    IA.I.xy = IA.I.xy - Sigma.xy;
    IA.I.xz = IA.I.xz - Sigma.xz;
    IA.I.yy = IA.I.yy + (Sigma.xx + Sigma.zz);
    IA.I.yz = IA.I.yz - Sigma.yz;
    IA.I.zz = IA.I.zz + (Sigma.xx + Sigma.yy);

    IA.H.xz = IA.H.xz + h.y;
    IA.H.zx = IA.H.zx - h.y;
    IA.H.yz = IA.H.yz - h.x;
    IA.H.zy = IA.H.zy + h.x;
    if (!(flags & RBDI_MASS_KEPT)) return IA;

    IA.H.xy = IA.H.xy - h.z;
    IA.H.yx = IA.H.yx + h.z;
    IA.M.xx = IA.M.xx + l->mass;
    IA.M.yy = IA.M.yy + l->mass;
    IA.M.zz = IA.M.zz + l->mass;
    return IA;
}

/* U = IA S. */
RBDI_INLINE rbdi_force rbdi_abi_axis(const rbdi_link *l, int flags, const rbdi_abi *IA) {
    rbdi_force U;

    U.n = rbdi_vec(IA->I.xz, IA->I.yz, IA->I.zz);
    U.f = rbdi_vec(IA->H.zx, IA->H.zy, IA->H.zz);

    if (flags & RBDI_SLIDES) {
        U.n = rbdi_add(rbdi_scale(rbdi_set(l->rho), U.n),
                       rbdi_scale(rbdi_set(l->kappa), rbdi_vec(IA->H.xz, IA->H.yz, IA->H.zz)));
        U.f = rbdi_add(rbdi_scale(rbdi_set(l->rho), U.f),
                       rbdi_scale(rbdi_set(l->kappa), rbdi_vec(IA->M.xz, IA->M.yz, IA->M.zz)));
    }

    return U;
}

/* IA becomes Ia = IA - U U'/D, without row z of I and H. U_D = U/D. */
RBDI_INLINE void rbdi_aba_subtract(rbdi_force U, rbdi_force U_D, rbdi_abi *IA) {
    IA->I.xx = IA->I.xx - U.n.x * U_D.n.x;
    IA->I.xy = IA->I.xy - U.n.x * U_D.n.y;
    IA->I.yy = IA->I.yy - U.n.y * U_D.n.y;

    IA->H.xx = IA->H.xx - U.n.x * U_D.f.x;
    IA->H.xy = IA->H.xy - U.n.x * U_D.f.y;
    IA->H.xz = IA->H.xz - U.n.x * U_D.f.z;
    IA->H.yx = IA->H.yx - U.n.y * U_D.f.x;
    IA->H.yy = IA->H.yy - U.n.y * U_D.f.y;
    IA->H.yz = IA->H.yz - U.n.y * U_D.f.z;

    IA->M.xx = IA->M.xx - U.f.x * U_D.f.x;
    IA->M.xy = IA->M.xy - U.f.x * U_D.f.y;
    IA->M.xz = IA->M.xz - U.f.x * U_D.f.z;
    IA->M.yy = IA->M.yy - U.f.y * U_D.f.y;
    IA->M.yz = IA->M.yz - U.f.y * U_D.f.z;
    IA->M.zz = IA->M.zz - U.f.z * U_D.f.z;
}

/* pA becomes pa = pA + Ia c + U u/D, without the moment about z:

       n += I c_omega + H c_v + U_n u/D,   f += H' c_omega + M c_v + U_f u/D

   u_D = u/D. c.omega.z is always 0. */
RBDI_INLINE void rbdi_aba_add_bias(const rbdi_abi *Ia, const rbdi_motion *c, rbdi_force U, rbd_real u_D,
                                   rbdi_force *pA) {
    pA->n.x = pA->n.x + (Ia->I.xx * c->omega.x + Ia->I.xy * c->omega.y) + U.n.x * u_D;
    pA->n.y = pA->n.y + (Ia->I.xy * c->omega.x + Ia->I.yy * c->omega.y) + U.n.y * u_D;
    pA->n.x = pA->n.x + (Ia->H.xx * c->v.x + Ia->H.xy * c->v.y + Ia->H.xz * c->v.z);
    pA->n.y = pA->n.y + (Ia->H.yx * c->v.x + Ia->H.yy * c->v.y + Ia->H.yz * c->v.z);

    pA->f.x = pA->f.x + (Ia->H.xx * c->omega.x + Ia->H.yx * c->omega.y) + U.f.x * u_D;
    pA->f.y = pA->f.y + (Ia->H.xy * c->omega.x + Ia->H.yy * c->omega.y) + U.f.y * u_D;
    pA->f.z = pA->f.z + (Ia->H.xz * c->omega.x + Ia->H.yz * c->omega.y) + U.f.z * u_D;
    pA->f = rbdi_add(pA->f, rbdi_mul_sym(Ia->M, c->v));
}

/* The rest of the two, for a joint that keeps row z: row z of I and H in Ia, and the moment of pa about z. */
RBDI_INLINE void rbdi_aba_row_z(const rbdi_motion *c, rbdi_force U, rbdi_force U_D, rbd_real u_D,
                                rbdi_abi *IA, rbdi_force *pA) {
    IA->I.xz = IA->I.xz - U.n.x * U_D.n.z;
    IA->I.yz = IA->I.yz - U.n.y * U_D.n.z;
    IA->I.zz = IA->I.zz - U.n.z * U_D.n.z;
    IA->H.zx = IA->H.zx - U.n.z * U_D.f.x;
    IA->H.zy = IA->H.zy - U.n.z * U_D.f.y;
    IA->H.zz = IA->H.zz - U.n.z * U_D.f.z;

    pA->n.z = pA->n.z + (IA->I.xz * c->omega.x + IA->I.yz * c->omega.y) + U.n.z * u_D;
    pA->n.z = pA->n.z + (IA->H.zx * c->v.x + IA->H.zy * c->v.y + IA->H.zz * c->v.z);
}

/* Pass 2, one-axis link: eliminates the joint's force. IA becomes Ia, pA becomes pa. */
RBDI_INLINE void rbdi_aba_eliminate(const rbd_model *m, rbd_work *w, int i, int flags, rbd_real tau,
                                    rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const int row_z = rbdi_keeps_row_z(flags);
    const rbdi_link *l = &m->link[i];
    const rbdi_dof *dof = &m->dof[l->iv];
    rbdi_scratch *scratch = &w->scratch[i];
    rbdi_force U, U_D;
    rbd_real D, inverse, u_D;

    /* U = IA S,  D = S' U + armature,  u = tau - S' pA */
    U = rbdi_abi_axis(l, flags, IA);
    D = rbdi_along_axis(l, flags, U);
    if (row_z) D = D + dof->armature;
    w->pivot[l->iv] = D;

    /* U/D and u/D */
    inverse = rbdi_pivot_inverse(D, dof->scale, doubt);
    u_D = (tau - rbdi_along_axis(l, flags, *pA)) * inverse;
    U_D.n.x = inverse * U.n.x;
    U_D.n.y = inverse * U.n.y;
    U_D.f = rbdi_scale(inverse, U.f);

    /* kept for pass 3 */
    scratch->U_D.n.x = U_D.n.x;
    scratch->U_D.n.y = U_D.n.y;
    scratch->U_D.f = U_D.f;
    scratch->u_D = u_D;

    /* Ia = IA - U U'/D,  pa = pA + Ia c + U u/D */
    rbdi_aba_subtract(U, U_D, IA);
    rbdi_aba_add_bias(IA, &scratch->c, U, u_D, pA);
    if (row_z) {
        U_D.n.z = inverse * U.n.z;
        scratch->U_D.n.z = U_D.n.z;
        rbdi_aba_row_z(&scratch->c, U, U_D, u_D, IA, pA);
        return;
    }

    /* row z of I and H is 0, the moment about z is tau: see [aba] */
    IA->I.xz = IA->I.yz = IA->I.zz = rbdi_zero();
    IA->H.zx = IA->H.zy = IA->H.zz = rbdi_zero();
    pA->n.z = tau;
}

/* Pass 2, one-axis link: IA and pA, summed over the children, become the contribution to the parent. */
RBDI_INLINE void rbdi_aba_up(const rbd_model *m, rbd_work *w, int i, int flags, const rbd_real *tau,
                             rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const rbdi_trig t = rbdi_trig_of(m, w, i, flags);

    *IA = rbdi_abi_add_link(l, flags, *IA);
    rbdi_aba_eliminate(m, w, i, flags, tau[l->iv], IA, pA, doubt);
    if (flags & RBDI_ROOT) return;

    *IA = rbdi_abi_up(l, flags, t, *IA);
    *pA = rbdi_force_up(l, flags, t, *pA);
}

/* A floating base on the world, without armature. */
RBDI_INLINE int rbdi_free_base(const rbdi_link *l, const rbdi_block *b) {
    return rbdi_on_world(l) && b->n == 6 && !(rbdi_flags(l) & RBDI_ARMATURE);
}

/* Pass 2, block link: eliminates its axes s one by one, the last first, so that the pivots are those of M =
   L'DL. A and P are IA and pA as arrays, of A only the lower triangle. U/D is kept for all six axes; a free
   base, which has no parent, needs it for the axes before s only. */
RBDI_PART void rbdi_aba_up_block(const rbd_model *m, rbd_work *w, int link, const rbd_real *tau, rbdi_abi *IA,
                                 rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[link];
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_motion c = w->scratch[link].c;
    rbdi_block_work *bw = &w->block[l->block];
    rbd_real A[6][6], P[6];
    rbdi_abi Ia;
    rbdi_force pa;

    rbdi_abi_to_array(rbdi_abi_add_link(l, RBDI_MASS_KEPT, *IA), A);
    rbdi_store_force(P, 1, *pA);

    /* each axis s: A -= U U'/D,  P += U u/D */
    for (int k = b->n - 1; k >= 0; --k) {
        const rbdi_dof *dof = &m->dof[l->iv + k];
        const int s = b->first + k, end = rbdi_free_base(l, b) ? s : 6;
        rbd_real *U_D = bw->U_D[k], D = A[s][s] + dof->armature;
        const rbd_real inverse = rbdi_pivot_inverse(D, dof->scale, doubt);

        w->pivot[l->iv + k] = D;
        bw->u_D[k] = (tau[l->iv + k] - P[s]) * inverse;
        for (int i = 0; i < end; ++i) {
            const rbd_real U = i < s ? A[s][i] : A[i][s];
            U_D[i] = U * inverse;
            for (int j = 0; j <= i; ++j) A[i][j] = A[i][j] - U * U_D[j];
            P[i] = P[i] + U * bw->u_D[k];
        }
    }
    if (rbdi_on_world(l)) return;

    /* pa = P + Ia c,  then Ia and pa to the parent */
    Ia = rbdi_abi_from_array(A);
    pa = rbdi_load_force(P, 1);
    pa.n = rbdi_add(pa.n, rbdi_add(rbdi_mul_sym(Ia.I, c.omega), rbdi_mul(Ia.H, c.v)));
    pa.f = rbdi_add(pa.f, rbdi_add(rbdi_mul_t(Ia.H, c.omega), rbdi_mul_sym(Ia.M, c.v)));
    *IA = rbdi_abi_up_block(&bw->X, Ia);
    *pA = rbdi_force_up_block(&bw->X, pa);
}

/* ==== src/dynamics/aba.h ==== */
/* Interface: rbdi_aba_pass2, rbdi_aba_pass3, rbdi_aba_velocities */

/* -- the three passes -- */

/* Pass 1, one-axis link: its velocity-product acceleration c, and omega: the parent's becomes the link's.
   With E, z, turn and slide as in [state], omega_p of the parent and omega_E = E omega_p:

       c_omega = omega_E x z turn
       c_v     = E (omega_p x (omega_p x r)) + omega_E x (omega_E x d z) + 2 omega_E x z slide
       omega   = omega_E + z turn */
RBDI_INLINE rbdi_motion rbdi_aba_velocity(const rbdi_link *l, int flags, rbdi_trig t, rbd_real qd,
                                          rbdi_v3 *omega) {
    const int screw = flags & RBDI_SLIDES;
    const rbdi_v3 omega_p = *omega;
    rbd_real turn = screw ? qd * l->rho : qd;
    rbdi_motion c = rbdi_motion0();
    rbdi_v3 omega_E;

    if (flags & RBDI_ROOT) {
        *omega = rbdi_vec(rbdi_zero(), rbdi_zero(), turn);
        return c;
    }

    if (flags & RBDI_SHIFT_R)
        c.v = rbdi_down(l, flags, t, rbdi_cross(omega_p, rbdi_cross_shift(l, flags, omega_p)));
    omega_E = rbdi_down(l, flags, t, omega_p);
    c.omega.x = turn * omega_E.y;
    c.omega.y = -(turn * omega_E.x);

    if (flags & RBDI_SHIFT_Z) {
        c.v.x = c.v.x + t.d * (omega_E.x * omega_E.z);
        c.v.y = c.v.y + t.d * (omega_E.y * omega_E.z);
        c.v.z = c.v.z - t.d * (omega_E.x * omega_E.x + omega_E.y * omega_E.y);
    }

    if (screw) {
        rbd_real twice_slide = (qd + qd) * l->kappa;
        c.v.x = c.v.x + twice_slide * omega_E.y;
        c.v.y = c.v.y - twice_slide * omega_E.x;
    }

    *omega = rbdi_vec(omega_E.x, omega_E.y, omega_E.z + turn);
    return c;
}

/* The same of a block: with J = S v, the velocity of its joint,

       c = (omega_E x J_omega; E (omega_p x (omega_p x r)) + (2 omega_E + J_omega) x J_v) */
RBDI_INLINE rbdi_motion rbdi_aba_velocity_block(const rbdi_link *l, const rbdi_block *b, const rbdi_pose *X,
                                                const rbd_real *v, rbdi_v3 *omega) {
    const rbdi_v3 omega_p = *omega;
    rbdi_motion J = rbdi_block_motion(b, v), c = rbdi_motion0();
    rbdi_v3 omega_E;

    if (rbdi_on_world(l)) { /* the world does not turn */
        *omega = J.omega;
        c.v = rbdi_cross(J.omega, J.v);
        return c;
    }

    omega_E = rbdi_mul(X->E, omega_p);
    c = rbdi_joint_product(omega_E, J);
    c.v = rbdi_add(c.v, rbdi_mul(X->E, rbdi_cross(omega_p, rbdi_cross(omega_p, X->r))));
    *omega = rbdi_add(omega_E, J.omega);
    return c;
}

/* Pass 1, link i: its c, and in scratch.f its pA without external wrenches: the wrench that moves the link
   where omega_dot = acc = 0. Takes omega of link i - 1, returns that of link i. A root does not read it. */
RBDI_INLINE rbdi_v3 rbdi_aba_pass1_step(const rbd_model *m, rbd_work *w, int i, int flags, const rbd_real *v,
                                        rbdi_v3 omega) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;
    rbdi_motion *c = &w->scratch[i].c;

    if (off_chain && l->parent != i - 1 && l->parent >= 0)
        omega = w->branch[m->link[l->parent].branch].state.omega;
    if (rbdi_block_link(l, flags))
        *c = rbdi_aba_velocity_block(l, rbdi_block_of(m, l), &w->block[l->block].X, &v[l->iv], &omega);
    else
        *c = rbdi_aba_velocity(l, flags, rbdi_trig_of(m, w, i, flags), v[l->iv], &omega);

    w->scratch[i].f = rbdi_wrench(l, flags, rbdi_omega_steady(omega), NULL);
    if (off_chain && l->branch >= 0) {
        w->branch[l->branch].state.omega = omega;
        w->branch[l->branch].I = rbdi_abi_zero(); /* for the sum of pass 2 */
    }

    return omega;
}

/* Pass 1, root to leaves. keep: stores omega in each link's kin. */
RBDI_INLINE void rbdi_aba_velocities(const rbd_model *m, rbd_work *w, const rbd_real *v, int keep) {
    rbdi_v3 omega = rbdi_vec0();
    for (int i = 0; i < m->nl; ++i) {
        RBDI_BY_FLAGS(const int flags, &m->link[i], omega = rbdi_aba_pass1_step(m, w, i, flags, v, omega));
        if (keep) w->kin[i].state.omega = omega;
    }
}

/* Hands the contribution of link i to its parent. Link i - 1 takes IA and pA as they are, from registers. Any
   other parent is a branch point: they are added to its sums, and what link i - 1 takes becomes 0. */
RBDI_INLINE void rbdi_aba_to_parent(const rbd_model *m, rbd_work *w, int i, rbdi_abi *IA, rbdi_force *pA) {
    const int parent = m->link[i].parent;
    if (parent == i - 1) return;

    if (parent >= 0) {
        rbdi_branch *branch = &w->branch[m->link[parent].branch];
        branch->I = rbdi_abi_add(branch->I, *IA);
        w->scratch[parent].f = rbdi_force_add(w->scratch[parent].f, *pA);
    }

    *IA = rbdi_abi_zero();
    *pA = rbdi_force0();
}

/* Pass 2, link i. IA and pA come with the contribution of link i + 1, or 0 if that is no child of link i, and
   become what link i - 1 takes from link i. The link's own pA stands in scratch.f, with the contributions of
   its other children. */
RBDI_INLINE void rbdi_aba_pass2_step(const rbd_model *m, rbd_work *w, int i, int flags, const rbd_real *tau,
                                     rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;

    if (off_chain && l->branch >= 0) *IA = rbdi_abi_add(*IA, w->branch[l->branch].I);
    *pA = rbdi_force_add(*pA, w->scratch[i].f);

    if (rbdi_block_link(l, flags)) {
        /* copies: without an address taken IA and pA of other links stay in registers */
        rbdi_abi copy_IA = *IA;
        rbdi_force copy_pA = *pA;
        rbdi_mask copy_doubt = *doubt;
        rbdi_aba_up_block(m, w, i, tau, &copy_IA, &copy_pA, &copy_doubt);
        *IA = copy_IA;
        *pA = copy_pA;
        *doubt = copy_doubt;
    } else {
        rbdi_aba_up(m, w, i, flags, tau, IA, pA, doubt);
    }

    if (off_chain) rbdi_aba_to_parent(m, w, i, IA, pA);
}

/* Whether the first dof of link i turns. */
RBDI_INLINE int rbdi_turns_first(const rbd_model *m, int i) {
    const rbdi_link *l = &m->link[i];
    return rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first < 3 : l->rho > 0;
}

/* Whether a joint has slid so far that dof.scale of the nearest turning joint before it is no bound, because
   it is taken at q = 0:

       slide^2 times the mass of the subtree that slides > RBDI_FAR dof.scale */
RBDI_PART rbdi_mask rbdi_slid_far(const rbd_model *m, const rbd_work *w) {
    rbdi_mask slid = rbdi_less(rbdi_zero(), rbdi_zero());
    if (!(RBDI_FEATURES & m->features & (RBDI_SLIDES | RBDI_OTHER_BLOCKS))) return slid;

    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        const int block = rbdi_is(l, RBDI_BLOCK);
        rbd_real square;
        rbd_const scale;
        int turning = l->parent;
        if (!block && !(rbdi_flags(l) & RBDI_SLIDES)) continue;

        while (turning >= 0 && !rbdi_turns_first(m, turning)) turning = m->link[turning].parent;
        if (turning < 0) continue;

        square = block ? rbdi_dot(w->block[l->block].X.r, w->block[l->block].X.r) : w->d[i] * w->d[i];
        scale = m->dof[m->link[turning].iv].scale;
        slid = rbdi_or(slid, rbdi_less(rbdi_set(scale * RBDI_FAR), square * l->subtree_mass));
    }

    return slid;
}

/* Pass 2, leaves first. Returns whether a pivot is in doubt. */
RBDI_PART rbdi_mask rbdi_aba_pass2(const rbd_model *m, rbd_work *w, const rbd_real *tau) {
    rbdi_abi IA = rbdi_abi_zero();
    rbdi_force pA = rbdi_force0();
    rbdi_mask doubt = rbdi_slid_far(m, w);
    for (int i = m->nl - 1; i >= 0; --i) {
        RBDI_BY_FLAGS(const int flags, &m->link[i],
                      rbdi_aba_pass2_step(m, w, i, flags, tau, &IA, &pA, &doubt));
    }
    return doubt;
}

/* Pass 3: X y, for the parent's y = (omega_dot; acc), acc the classical acceleration minus gravity:

       X y = (E omega_dot; E (acc + omega_dot x r) + (E omega_dot) x d z) */
RBDI_INLINE rbdi_motion rbdi_aba_carry(const rbd_model *m, const rbd_work *w, int i, int flags,
                                       rbdi_motion y) {
    const rbdi_link *l = &m->link[i];
    const rbdi_trig t = rbdi_trig_of(m, w, i, flags);

    if (!(flags & RBDI_ROOT) && (flags & RBDI_SHIFT_R))
        y.v = rbdi_add(y.v, rbdi_cross_shift(l, flags, y.omega));
    y.omega = rbdi_down(l, flags, t, y.omega);
    y.v = rbdi_down(l, flags, t, y.v);

    if (flags & RBDI_SHIFT_Z) {
        y.v.x = y.v.x + t.d * y.omega.y;
        y.v.y = y.v.y - t.d * y.omega.x;
    }

    return y;
}

/* The same of a block, whose d is 0. */
RBDI_INLINE rbdi_motion rbdi_aba_carry_block(const rbd_work *w, const rbdi_link *l, rbdi_motion y) {
    const rbdi_pose *X = &w->block[l->block].X;
    y.v = rbdi_mul(X->E, rbdi_add(y.v, rbdi_cross(y.omega, X->r)));
    y.omega = rbdi_mul(X->E, y.omega);
    return y;
}

/* Pass 3, one-axis link:

       y = X y_p + c,   qdd = u/D - (U/D)' y,   y += S qdd

   x is qdd without the term of y.omega.z. A revolute joint without armature has U_z/D = 1, so that
   qdd = x - y.omega.z: its new y.omega.z is x. */
RBDI_INLINE rbdi_motion rbdi_aba_down(const rbd_model *m, const rbd_work *w, int i, int flags, rbdi_motion y,
                                      rbd_real *a) {
    const rbdi_link *l = &m->link[i];
    const rbdi_scratch *scratch = &w->scratch[i];
    const rbdi_force *U_D = &scratch->U_D;
    rbd_real x, qdd;

    y = rbdi_motion_add(rbdi_aba_carry(m, w, i, flags, y), scratch->c);
    x = scratch->u_D - (U_D->n.x * y.omega.x + U_D->n.y * y.omega.y) - rbdi_dot(U_D->f, y.v);

    if (!rbdi_keeps_row_z(flags)) {
        a[l->iv] = x - y.omega.z;
        y.omega.z = x;
        return y;
    }

    qdd = x - U_D->n.z * y.omega.z;
    if (flags & RBDI_SLIDES) {
        y.omega.z = y.omega.z + qdd * l->rho;
        y.v.z = y.v.z + qdd * l->kappa;
    } else {
        y.omega.z = y.omega.z + qdd;
    }

    a[l->iv] = qdd;
    return y;
}

/* The same of a block, its axes one by one, the first first. all: y as an array. A free base keeps U/D only
   for the axes before: for its own axis it is 1, for those behind 0. So its qdd is x - y_k, and x the new
   y_k. */
RBDI_PART rbdi_motion rbdi_aba_down_block(const rbd_model *m, const rbd_work *w, int i, rbdi_motion y,
                                          rbd_real *a) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block_work *bw = &w->block[l->block];
    const rbdi_block *b = rbdi_block_of(m, l);
    rbd_real all[6];

    rbdi_store_motion(all, 1, rbdi_motion_add(rbdi_aba_carry_block(w, l, y), w->scratch[i].c));
    if (rbdi_free_base(l, b)) {
        RBDI_UNROLL_SIX for (int k = 0; k < 6; ++k) {
            rbd_real x = bw->u_D[k];
            RBDI_UNROLL_SIX for (int j = 0; j < k; ++j)
                x = x - bw->U_D[k][j] * all[j];
            a[l->iv + k] = x - all[k];
            all[k] = x;
        }
        return rbdi_load_motion(all, 1);
    }

    for (int k = 0; k < b->n; ++k) {
        rbd_real qdd = bw->u_D[k];
        RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
            qdd = qdd - bw->U_D[k][j] * all[j];
        all[b->first + k] = all[b->first + k] + qdd;
        a[l->iv + k] = qdd;
    }

    return rbdi_load_motion(all, 1);
}

/* Pass 3, link i: takes y of link i - 1, returns that of link i. world: y of the world. */
RBDI_INLINE rbdi_motion rbdi_aba_pass3_step(const rbd_model *m, rbd_work *w, int i, int flags,
                                            const rbdi_motion *world, rbdi_motion y, rbd_real *a) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;

    if (off_chain && l->parent < 0)
        y = *world;
    else if (off_chain && l->parent != i - 1)
        y = w->branch[m->link[l->parent].branch].y;

    if (rbdi_block_link(l, flags))
        y = rbdi_aba_down_block(m, w, i, y, a);
    else
        y = rbdi_aba_down(m, w, i, flags, y, a);

    if (off_chain && l->branch >= 0) w->branch[l->branch].y = y;
    return y;
}

/* Pass 3, root to leaves. minus_g: acceleration of the world, minus gravity. */
RBDI_PART void rbdi_aba_pass3(const rbd_model *m, rbd_work *w, rbdi_v3 minus_g, rbd_real *a) {
    rbdi_motion world = rbdi_motion0(), y;

    world.v = minus_g;
    y = world;
    for (int i = 0; i < m->nl; ++i)
        RBDI_BY_FLAGS(const int flags, &m->link[i], y = rbdi_aba_pass3_step(m, w, i, flags, &world, y, a));
}

/* ==== src/dynamics/row_sums.h ==== */
/* Interface: rbdi_multiply, rbdi_subtract, rbdi_subtract_product, RBDI_ROW */

/* ---- packed matrix of a tree [packed matrix] ----
   M is symmetric, and entry (i, j) is zero unless one dof is on the path of the other to the root. Row k is
   packed: it has the dofs on k's path only, root first, the diagonal last (dof[k].row, dof[k].depth). M =
   L'DL with L unit lower triangular, RBDA section 6.5: the leaves are eliminated first, so that no zero
   fills. The factor replaces M: L below the diagonal, 1/D on it.

     rbdi_factor            M = L'DL, in place; the pivots D go to w->pivot
     rbdi_solve             x = M^-1 x
     rbdi_solve_columns     X = M^-1 X or -M^-1 X, n columns
     rbdi_invert            Z = M^-1, full
     rbdi_subtract_product  y -= X' x
     rbdi_subtract          y -= factor x
     rbdi_multiply          y *= factor

   A solution has two halves: _transposed, L' y = x from the leaves to the root, then _forward, L x = y / D
   from the root to the leaves. The scratch is w->F and, for places of rows, w->start.

   In depth-first order, m->node, the descendants of a dof follow it. Every result is a row less a sum of
   other rows times factors: the rows of the descendants (factor, first half of a solution) or of the path
   (second half, inverse). The result stays in registers, up to RBDI_ROW batches of it, and the others are
   read from memory; the row computed just before comes last, because the processor must wait for it.
   Batches are counted from the first column; the last one ends with the last column and may overlap the one
   before it. Fewer columns than a batch are computed one by one.

   This room has the sums of rows, packed.h the factor and what it solves. */

/* y *= factor, a batch at a time. */
RBDI_INLINE void rbdi_multiply(rbd_real *y, rbd_real factor, int n) {
    int j = 0;
#if RBDI_BATCH > 1
    for (; j + RBDI_BATCH <= n; j += RBDI_BATCH) *(rbdi_batch *)&y[j] = *(const rbdi_batch *)&y[j] * factor;
#endif
    for (; j < n; ++j) y[j] = y[j] * factor;
}

/* y -= factor x, a batch at a time. */
RBDI_INLINE void rbdi_subtract(rbd_real *y, rbd_real factor, const rbd_real *x, int n) {
    int j = 0;
#if RBDI_BATCH > 1
    for (; j + RBDI_BATCH <= n; j += RBDI_BATCH)
        *(rbdi_batch *)&y[j] = *(const rbdi_batch *)&y[j] - *(const rbdi_batch *)&x[j] * factor;
#endif
    for (; j < n; ++j) y[j] = y[j] - factor * x[j];
}

/* Batches of a row that stay in registers. */
#if RBDI_BATCH > 1 || defined RBD_LANES
#define RBDI_ROW 8
#else
#define RBDI_ROW 4
#endif
/* RBDI_BY_NUMBER(const int batches, most, n, call) makes the call with n in a constant that it declares, here
   `batches`, which the compiler knows; 1 <= n <= most <= RBDI_ROW. Each number is a copy of the code. */
#if RBDI_FOR_SPEED
#define RBDI_BY_NUMBER(constant, most, n, call) \
    switch (n) { \
        RBDI_OF_NUMBER(constant, most, 1, call) \
        RBDI_OF_NUMBER(constant, most, 2, call) \
        RBDI_OF_NUMBER(constant, most, 3, call) \
        RBDI_OF_NUMBER(constant, most, 4, call) \
        RBDI_OF_NUMBER(constant, most, 5, call) \
        RBDI_OF_NUMBER(constant, most, 6, call) \
        RBDI_OF_NUMBER(constant, most, 7, call) \
        RBDI_OF_NUMBER(constant, most, 8, call) \
    }
#define RBDI_OF_NUMBER(constant, most, n, call) \
    case n: { \
        constant = n <= (most) ? n : 1; \
        if (n <= (most)) call; \
    } break;
#else
#define RBDI_BY_NUMBER(constant, most, n, call) \
    do { \
        constant = n; \
        call; \
    } while (0);
#endif

/* n rows and their factors, to be subtracted from a row y. Row t and its factor are, for

     RBDI_ELIMINATED   rbdi_factor: at X + node[t].row; factor x[t] times the row's entry in column d
     RBDI_DESCENDANTS  the first half of a solution: at X + start[t]; factor x[node[t].row]
     RBDI_PATH         the second half: at X + start[t]; factor x[t]; y is multiplied by scale before
     RBDI_FRESH        rbdi_invert: the same, y is 0 before
     RBDI_EQUIDISTANT  rbdi_subtract_product: at X + t stride; factor x[t]

   Each sets the fields that it uses. Y: a second matrix with its rows at the same places. */
enum { RBDI_ELIMINATED, RBDI_DESCENDANTS, RBDI_PATH, RBDI_FRESH, RBDI_EQUIDISTANT };

typedef struct rbdi_terms {
    const rbd_real *X, *Y; /* the matrices with the rows */
    const rbd_real *x;     /* factors */
    const rbdi_node *node;
    const ptrdiff_t *start; /* where rows start */
    ptrdiff_t stride;
    rbd_real scale;
    int n, d;
} rbdi_terms;

/* Where row t starts, and its factor. */
RBDI_INLINE ptrdiff_t rbdi_start_of(const rbdi_terms *g, int which, int t) {
    if (which == RBDI_EQUIDISTANT) return t * g->stride;
    return which == RBDI_ELIMINATED ? g->node[t].row : g->start[t];
}

RBDI_INLINE rbd_real rbdi_factor_of(const rbdi_terms *g, int which, int t, const rbd_real *row) {
    if (which == RBDI_ELIMINATED) return g->x[t] * row[g->d];
    return g->x[which == RBDI_DESCENDANTS ? g->node[t].row : t];
}

/* y less the rows of X and, with two matrices, z less those of Y: so many batches, the last of which begins
   with column `last`. Descendants come last to first: the row computed just before is the last one. */
RBDI_INLINE void rbdi_subtract_batches(rbdi_terms g, int which, int matrices, int batches, int last,
                                       rbd_real *y, rbd_real *z) {
    rbdi_batch sum[2][RBDI_ROW];

    /* y and z, or 0 */
    RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) {
        RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
            const rbd_real *from = (a > 0 ? z : y) + (b < batches - 1 ? b * RBDI_BATCH : last);
            sum[a][b] = which == RBDI_FRESH ? rbdi_all_lanes(rbdi_zero()) : *(const rbdi_batch *)from;
            if (which == RBDI_PATH) sum[a][b] = sum[a][b] * g.scale;
        }
    }

    /* less x times each row */
    RBDI_UNROLL_TWO for (int i = 0; i < g.n; ++i) {
        const int t = which == RBDI_ELIMINATED || which == RBDI_DESCENDANTS ? g.n - 1 - i : i;
        const rbd_real *row = g.X + rbdi_start_of(&g, which, t),
                       *other = matrices > 1 ? g.Y + rbdi_start_of(&g, which, t) : row;
        const rbd_real x = rbdi_factor_of(&g, which, t, row);

        RBDI_ONE_INDEX(row);
        if (matrices > 1) RBDI_ONE_INDEX(other);

        RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) {
            RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
                const rbd_real *from = (a > 0 ? other : row) + (b < batches - 1 ? b * RBDI_BATCH : last);
                sum[a][b] = sum[a][b] - *(const rbdi_batch *)from * x;
            }
        }
    }

    RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) {
        RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
            rbd_real *to = (a > 0 ? z : y) + (b < batches - 1 ? b * RBDI_BATCH : last);
            *(rbdi_batch *)to = sum[a][b];
        }
    }
}

/* The same of one matrix with n columns, fewer than a batch. */
RBDI_INLINE void rbdi_subtract_scalars(rbdi_terms g, int which, int n, rbd_real *y) {
    rbd_real sum[RBDI_BATCH];

    RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) {
        sum[b] = which == RBDI_FRESH ? rbdi_zero() : y[b];
        if (which == RBDI_PATH) sum[b] = sum[b] * g.scale;
    }

    RBDI_UNROLL_TWO for (int i = 0; i < g.n; ++i) {
        const int t = which == RBDI_ELIMINATED || which == RBDI_DESCENDANTS ? g.n - 1 - i : i;
        const rbd_real *row = g.X + rbdi_start_of(&g, which, t), x = rbdi_factor_of(&g, which, t, row);
        RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) sum[b] = sum[b] - row[b] * x;
    }

    RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) y[b] = sum[b];
}

/* The same for any number of columns. */
RBDI_INLINE void rbdi_subtract_columns(rbdi_terms g, int which, int n, rbd_real *y) {
    while (n > 0) {
        const int columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;
        if (columns >= RBDI_BATCH)
            RBDI_BY_NUMBER(const int batches, RBDI_ROW, (columns + RBDI_BATCH - 1) / RBDI_BATCH,
                           rbdi_subtract_batches(g, which, 1, batches, columns - RBDI_BATCH, y, y))
        else
            RBDI_BY_NUMBER(const int scalars, RBDI_BATCH - 1, columns,
                           rbdi_subtract_scalars(g, which, scalars, y))

        n -= columns;
        y += columns;
        g.X += columns;
        g.d -= columns;
    }
}

/* y -= X' x, for the count x n matrix X. */
RBDI_PART void rbdi_subtract_product(const rbd_real *x, const rbd_real *X, int count, int n, rbd_real *y) {
    rbdi_terms g;
    g.X = X;
    g.x = x;
    g.n = count;
    g.d = 0;
    g.stride = n;
    rbdi_subtract_columns(g, RBDI_EQUIDISTANT, n, y);
}

/* ==== src/dynamics/packed.h ==== */
/* Interface: rbdi_factor, rbdi_invert, rbdi_mirror, rbdi_solve, rbdi_solve_columns, rbdi_solve_forward,
   rbdi_solve_half, rbdi_solve_transposed, rbdi_vector_forward, rbdi_vector_transposed */

/* -- the factor, and what it solves -- */

/* M = L'DL in place, RBDA table 6.3. First U = D L from the leaves to the root: its row i is row i of M less
   L_ki U_k for all descendants k. Then L = D^-1 U. Returns whether a pivot is in doubt. */
RBDI_PART rbdi_mask rbdi_factor(const rbd_model *m, rbd_work *w, rbd_real *H) {
    const rbdi_node *node = m->node;
    rbd_real *inverse = w->F; /* 1/D, by node */
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
#ifdef RBDI_ROWS /* rbd-codegen: sums of rows are not recorded scalar by scalar */
    if (RBDI_ROWS(factor)(m, w, H)) return doubt;
#endif

    for (int s = m->nv - 1; s >= 0; --s) {
        const rbdi_dof *dof = &m->dof[node[s].dof];
        rbd_real *row = &H[node[s].row];
        const rbd_real whole = row[dof->depth]; /* M_kk */
        rbdi_terms g;

        /* U_i = M_i - sum of L_ki U_k, L_ki = U_ki / D_k */
        g.X = H;
        g.x = inverse + s + 1;
        g.node = node + s + 1;
        g.n = node[s].descendants;
        g.d = dof->depth;
        if (g.n > 0) rbdi_subtract_columns(g, RBDI_ELIMINATED, dof->depth + 1, row);

        doubt = rbdi_or(doubt, rbdi_less(row[dof->depth], whole * RBDI_DOUBT));
        w->pivot[node[s].dof] = row[dof->depth];
        inverse[s] = row[dof->depth] = rbdi_pivot_inverse(row[dof->depth], dof->scale, &doubt);
    }

    /* L = D^-1 U */
    for (int k = 0; k < m->nv; ++k)
        rbdi_multiply(&H[m->dof[k].row], H[m->dof[k].row + m->dof[k].depth], m->dof[k].depth);
    return doubt;
}

/* One vector has functions of its own: its batches are entries of a row, those of many columns below are
   columns. */

/* Solves L' y = x, in place, from the leaves: y_i = x_i - sum over the descendants k of L_ki y_k. `path`, by
   depth on a dof's path, has the sums that its descendants subtract. It is stored as it is loaded, in batches
   and then scalars: the processor would wait for a batch that was stored as scalars. */
RBDI_PART void rbdi_vector_transposed(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    const rbdi_dof *dof = m->dof;
    rbd_real *path = w->F;

    rbdi_clear(path, m->nv + RBDI_BATCH);
    for (const rbdi_node *node = m->node + m->nv - 1; node >= m->node; --node) {
        const int d = dof[node->dof].depth;
        const rbd_real *l = L + node->row, y = x[node->dof] + path[d];
        int t = 0;

        x[node->dof] = y;
#if RBDI_BATCH > 1
        for (; t + RBDI_BATCH <= d; t += RBDI_BATCH)
            *(rbdi_batch *)&path[t] = *(const rbdi_batch *)&path[t] - *(const rbdi_batch *)&l[t] * y;

        if (node->row + t <= m->nh - RBDI_BATCH) {
            rbdi_batch *rest = (rbdi_batch *)&path[t];
            *rest = rbdi_first_lanes(*rest - *(const rbdi_batch *)&l[t] * y, d - t);
            continue;
        }
#endif

        for (; t < d; ++t) path[t] = path[t] - l[t] * y;
        path[d] = rbdi_zero();
    }
}

/* Solves L x = y / D, in place, from the root: x_i = y_i / D_i - sum over the path of L_ij x_j. `path` has
   the results on the path. */
RBDI_PART void rbdi_vector_forward(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    const rbdi_dof *dof = m->dof;
    rbd_real *path = w->F;

    for (const rbdi_node *node = m->node, *end = node + m->nv; node < end; ++node) {
        const int d = dof[node->dof].depth;
        const rbd_real *l = L + node->row;
        rbd_real even = x[node->dof] * l[d], odd = rbdi_zero(); /* two sums: none waits for the other */
        int t = 0;

        for (; t + 1 < d; t += 2) {
            even = even - path[t] * l[t];
            odd = odd - path[t + 1] * l[t + 1];
        }

        if (t < d) even = even - path[t] * l[t];
        x[node->dof] = even + odd;
        path[d] = x[node->dof];
    }
}

RBDI_PART void rbdi_solve(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    rbdi_vector_transposed(m, w, L, x);
    rbdi_vector_forward(m, w, L, x);
}

/* X = L'^-1 X, and with two matrices Y = L'^-1 Y: n columns, in so many batches or, with batches = 0, one
   matrix in scalars. */
RBDI_INLINE void rbdi_columns_transposed(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                         int matrices, int batches, int n, rbd_real *X, rbd_real *Y) {
    ptrdiff_t *start = w->start; /* by node */
    rbdi_terms g;

    g.X = X;
    g.Y = Y;

    for (int s = m->nv - 1; s >= 0; --s) {
        const rbdi_node node = m->node[s];

        start[s] = node.dof * stride;
        g.node = m->node + s + 1;
        g.start = start + s + 1;
        g.x = L + m->dof[node.dof].depth;
        g.n = node.descendants;
        if (g.n == 0) continue;

        if (batches > 0)
            rbdi_subtract_batches(g, RBDI_DESCENDANTS, matrices, batches, n - RBDI_BATCH, X + start[s],
                                  Y + start[s]);
        else
            rbdi_subtract_scalars(g, RBDI_DESCENDANTS, n, X + start[s]);
    }
}

/* Then X = sign L^-1 D^-1 X, and Y likewise. */
RBDI_INLINE void rbdi_columns_forward(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                      ptrdiff_t stride, int matrices, int batches, int n, rbd_real *X,
                                      rbd_real *Y) {
    ptrdiff_t *path = w->start; /* of a dof's path, by depth */
    rbdi_terms g;

    g.X = X;
    g.Y = Y;
    g.start = path;

    for (int s = 0; s < m->nv; ++s) {
        const rbdi_node node = m->node[s];
        const ptrdiff_t own = node.dof * stride;

        g.x = L + node.row;
        g.n = m->dof[node.dof].depth;
        g.scale = sign < 0 ? -g.x[g.n] : g.x[g.n];
        path[g.n] = own;

        if (batches > 0)
            rbdi_subtract_batches(g, RBDI_PATH, matrices, batches, n - RBDI_BATCH, X + own, Y + own);
        else
            rbdi_subtract_scalars(g, RBDI_PATH, n, X + own);
    }
}

/* One of the two. */
RBDI_INLINE void rbdi_columns_half(const rbd_model *m, rbd_work *w, const rbd_real *L, int transposed,
                                   int sign, ptrdiff_t stride, int matrices, int batches, int n, rbd_real *X,
                                   rbd_real *Y) {
    if (transposed)
        rbdi_columns_transposed(m, w, L, stride, matrices, batches, n, X, Y);
    else
        rbdi_columns_forward(m, w, L, sign, stride, matrices, batches, n, X, Y);
}

/* The same for any number n of columns: of one matrix, or of two whose rows have at most RBDI_ROW / 2
   batches. */
RBDI_INLINE void rbdi_solve_half(const rbd_model *m, rbd_work *w, const rbd_real *L, int transposed, int sign,
                                 ptrdiff_t stride, int matrices, int n, rbd_real *X, rbd_real *Y) {
    while (n > 0) {
        const int columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;

        if (matrices > 1 || columns >= RBDI_BATCH)
            RBDI_BY_NUMBER(
                const int batches, RBDI_ROW / matrices, (columns + RBDI_BATCH - 1) / RBDI_BATCH,
                rbdi_columns_half(m, w, L, transposed, sign, stride, matrices, batches, columns, X, Y))
        else
            RBDI_BY_NUMBER(const int scalars, RBDI_BATCH - 1, columns,
                           rbdi_columns_half(m, w, L, transposed, sign, stride, 1, 0, scalars, X, X))
        n -= columns;
        X += columns;
        Y += columns;
    }
}

/* X = L'^-1 X: n columns, with rows a stride apart. */
RBDI_PART void rbdi_solve_transposed(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                     int n, rbd_real *X) {
    rbdi_solve_half(m, w, L, 1, 1, stride, 1, n, X, X);
}

/* X = sign L^-1 D^-1 X. */
RBDI_PART void rbdi_solve_forward(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                  ptrdiff_t stride, int n, rbd_real *X) {
    rbdi_solve_half(m, w, L, 0, sign, stride, 1, n, X, X);
}

/* X = sign M^-1 X: n columns, with rows a stride apart. */
RBDI_PART void rbdi_solve_columns(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                  ptrdiff_t stride, int n, rbd_real *X) {
#ifdef RBDI_ROWS
    if (RBDI_ROWS(solve)(m, L, sign, stride, n, X, NULL)) return;
#endif

    rbdi_solve_transposed(m, w, L, stride, n, X);
    rbdi_solve_forward(m, w, L, sign, stride, n, X);
}

/* Copies k entries of a row into a column of a matrix with n columns. */
RBDI_INLINE void rbdi_mirror(const rbd_real *row, ptrdiff_t n, int k, rbd_real *column) {
    const rbd_real *end = row + k;

    for (; end - row >= 4; row += 4, column += 4 * n) {
        column[0] = row[0];
        column[n] = row[1];
        column[2 * n] = row[2];
        column[3 * n] = row[3];
    }

    for (; row != end; ++row, column += n) *column = *row;
}

/* Z = M^-1. L Z = D^-1 L'^-1 is upper triangular with the diagonal 1/D. So row k of Z, up to the diagonal, is
   a sum over the rows i of the path: Z_kj = - sum L_ki Z_ij for j < k, Z_kk = 1/D_k - sum L_ki Z_ik. */
RBDI_PART void rbdi_invert(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *Z) {
    const int n = m->nv;
    ptrdiff_t *path = w->start; /* of a dof's path, root first */
    rbd_real *row = Z;
    int before = 0;
#ifdef RBDI_ROWS
    if (RBDI_ROWS(invert)(m, L, Z)) return;
#endif

    for (int k = 0; k < n; ++k, row += n) {
        const rbd_real *l = &L[m->dof[k].row];
        const int d = m->dof[k].depth;
        rbd_real even = l[d], odd = rbdi_zero();
        rbdi_terms g;
        int i = m->dof[k].lambda, t = d;

        /* the path differs from that of dof k - 1 in its last entries alone */
        for (; t > 0 && (t > before || path[t - 1] != i * n); i = m->dof[i].lambda) path[--t] = i * n;
        before = d;

        /* Z_kj for j < k, and column k */
        g.X = Z;
        g.start = path;
        g.x = l;
        g.n = d;
        g.d = 0;
        rbdi_subtract_columns(g, RBDI_FRESH, k, row);
        rbdi_mirror(row, n, k, Z + k);

        /* Z_kk */
        for (t = 0; t + 1 < d; t += 2) {
            even = even - l[t] * Z[path[t] + k];
            odd = odd - l[t + 1] * Z[path[t + 1] + k];
        }
        if (t < d) even = even - l[t] * Z[path[t] + k];
        row[k] = even + odd;
    }
}

/* ==== src/dynamics/pivots.h ==== */
/* Interface: rbdi_check_factor, rbdi_factor_status, rbdi_pivot_status */

/* ---- pivots [pivots] ----
   M = L'DL is singular if one of its pivots D is rounding. Each call checks the pivots that it computes, in
   two steps.

   First, in every call: is D > RBDI_DOUBT dof.scale, and > RBDI_DOUBT M_kk where M is there? If all pivots
   pass, M is regular: a rounding error reaches that size only if it is magnified by more than RBDI_DOUBT /
   eps, and then an earlier pivot was small beside its own scale; RBDI_DOUBT is at least sqrt(eps), so that
   one of the two fails. dof.scale is taken at q = 0. A joint that has slid too far from there is a doubt as
   well (rbdi_slid_far).

   Then, if a pivot is in doubt: is D > RBDI_NOISE e + RBDI_TINY, for all pivots? eps e bounds the error of
   D. Let y be column k of L^-1: the motion in which dof k moves by 1 and the dofs behind it give way. Then
   D_k = y' M y, and

       e_k = sum over j of y_j^2 K_jj + armature

   By the factor, K_jj are the terms of M_jj: M_jj, the inertia of each link about its own origin along the
   dof, and a quarter of dof.scale, the inertia of the stretched robot. Articulated bodies have smaller
   terms: each link's inertia along its motion in y and, for dof j, G_j = D_j + RBDI_SHARE dof.scale +
   armature. So rbd_aba is right in long chains whose M has lost its digits.

   Both have a part of dof.scale, because descriptions round too. An axis is off by eps, a position or a
   centre of mass by eps of its lever L. These errors move a mass m that should stand still by eps L. So D
   has a part m (eps L)^2. It is computed exactly, and all of it is error. dof.scale has RBDI_ROD m L^2 in it
   (rbdi_build_scale). */

/* Replaces pivot k by its verdict: 1 if it is above its noise or no pivot of the state is in doubt, 0 if not,
   -1 if it is not a number. e: the bound of its terms. */
RBDI_PART void rbdi_check_pivot(rbd_work *w, int k, rbd_real e, rbdi_mask doubt) {
    const rbd_real noise = e * RBDI_NOISE + RBDI_TINY;
    const rbd_real D = w->pivot[k], one = rbdi_set(RBD_C(1));
    const rbdi_mask number = rbdi_or(rbdi_less(D, one), rbdi_less(rbdi_zero(), D));
    const rbd_real bad = rbdi_select(number, rbdi_zero(), -one);
    w->pivot[k] = rbdi_select(rbdi_or(rbdi_not(doubt), rbdi_less(noise, D)), one, bad);
}

/* The status by the verdicts in w->pivot. w->singular becomes the first bad pivot in the order of
   elimination. The n results x become 0 in the lanes that have a bad pivot. */
RBDI_PART rbd_status rbdi_pivot_status(const rbd_model *m, rbd_work *w, rbd_real *x, int n) {
    const rbd_real half = rbdi_set(RBD_C(0.5)), o = rbdi_zero();
    rbdi_mask good = rbdi_less(o, half), number = good;

    w->singular = -1;
    for (int k = m->nv - 1; k >= 0; --k) {
        const rbdi_mask ok = rbdi_less(half, w->pivot[k]);
        good = rbdi_and(good, ok);
        if (w->singular >= 0 || !rbdi_any(rbdi_not(ok))) continue;
        w->singular = k;
        number = rbdi_less(-half, w->pivot[k]);
    }

    for (int k = 0; k < n; ++k) x[k] = rbdi_select(good, x[k], o);
    if (w->singular < 0) return RBD_OK;

    return rbdi_any(rbdi_not(number)) ? RBD_ERR_NAN : RBD_ERR_SINGULAR;
}

/* The inertia of body b about the origin of its link, along each of the link's axes: moments, then masses.
   The rounding of the build is added, because it may tilt a rod that lies on an axis. It is relative to the
   trace of the inertia, about the link's origin and about that of the user's frame, r of the joint's body. */
RBDI_COLD void rbdi_body_inertia(const rbd_model *m, int b, rbd_real inertia[6]) {
    const rbdi_frame *u = &m->frame[b];
    const rbdi_mat E = rbdi_mat_c(u->E);
    const rbdi_v3 user = rbdi_vec_c(m->frame[m->dof[m->link[u->link].iv].body].r);
    const rbdi_v3 r = rbdi_vec_c(u->r), com = rbdi_mul_t(E, rbdi_vec_c(u->com)), p = rbdi_add(r, com);
    const rbd_real mass = rbdi_set(u->mass);
    const rbd_real levers = rbdi_dot(r, r) + rbdi_dot(com, com) + rbdi_dot(user, user);

    const rbdi_sym S = rbdi_sym_up(E, rbdi_sym_c(u->I));
    const rbd_real xx = rbdi_abs(S.xx), yy = rbdi_abs(S.yy), zz = rbdi_abs(S.zz);
    const rbd_real rounding = (xx + yy + zz + mass * levers) * RBDI_BUILD;

    inertia[0] = xx + mass * (p.y * p.y + p.z * p.z) + rounding;
    inertia[1] = yy + mass * (p.x * p.x + p.z * p.z) + rounding;
    inertia[2] = zz + mass * (p.x * p.x + p.y * p.y) + rounding;
    inertia[3] = inertia[4] = inertia[5] = mass;
}

#ifndef RBD_NO_CHOLESKY
/* -- by the factor -- */

/* Adds to K, for each dof, the inertia of the bodies of its own link about the link's origin. */
RBDI_COLD void rbdi_add_links(const rbd_model *m, rbd_real *K) {
    for (int b = 0; b < m->nb; ++b) {
        const int i = m->frame[b].link;
        const rbdi_link *l;
        rbd_real inertia[6], ratio;
        int iv;
        if (i < 0) continue; /* fixed to the world */

        l = &m->link[i];
        iv = rbdi_source(m, l->iv);
        ratio = rbdi_ratio(m, l->iv);
        rbdi_body_inertia(m, b, inertia);

        if (!rbdi_is(l, RBDI_BLOCK)) {
            K[iv] = K[iv] + (inertia[2] * l->rho + inertia[5] * (l->kappa * l->kappa)) * (ratio * ratio);
            continue;
        }
        for (int k = 0, s = rbdi_block_of(m, l)->first; k < rbdi_link_dofs(m, l); ++k)
            K[iv + k] = K[iv + k] + inertia[s + k];
    }
}

/* Checks the pivots of the matrix whose packed factor is L:

       K_jj = |D_j| + sum over the descendants k of L_kj^2 |D_k| + dof.scale / 4 + inertias of the links
       y_j = -sum of L_ji y_i,   i from k on, on the path of j;   y_k = 1, and y is 0 before k

   The first two terms of K_jj are M_jj, y is column k of L^-1. */
RBDI_COLD void rbdi_check_factor(const rbd_model *m, rbd_work *w, const rbd_real *L, rbdi_mask doubt) {
    const int n = m->nv;
    rbd_real *K = w->F, *y = w->F + n; /* the scratch of crba */

    /* K_jj */
    for (int k = 0; k < n; ++k) K[k] = rbdi_abs(w->pivot[k]) + RBD_C(0.25) * m->dof[k].scale;
    for (int k = 0; k < n; ++k)
        for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) {
            const rbd_real factor = L[m->dof[k].row + t];
            K[i] = K[i] + factor * factor * rbdi_abs(w->pivot[k]);
        }

    rbdi_add_links(m, K);

    /* e_k = sum of y_j^2 K_jj + armature */
    for (int k = 0; k < n; ++k) {
        rbd_real e = K[k] + m->dof[k].armature;

        y[k] = rbdi_set(RBD_C(1));
        for (int j = k + 1; j < n; ++j) {
            const rbd_real *row = &L[m->dof[j].row];
            y[j] = rbdi_zero();
            for (int t = m->dof[j].depth - 1, i = m->dof[j].lambda; i >= k; --t, i = m->dof[i].lambda)
                y[j] = y[j] - row[t] * y[i];
            e = e + y[j] * y[j] * K[j];
        }

        rbdi_check_pivot(w, k, e, doubt);
    }
}

/* The status of a call that factored a matrix, L packed. doubt: whether a pivot is in doubt; x: the n
   results. */
RBDI_INLINE rbd_status rbdi_factor_status(const rbd_model *m, rbd_work *w, const rbd_real *L, rbdi_mask doubt,
                                          rbd_real *x, int n) {
    w->singular = -1;
    if (!rbdi_any(doubt)) return RBD_OK;
    rbdi_check_factor(m, w, L, doubt);
    return rbdi_pivot_status(m, w, x, n);
}
#endif

/* ==== src/dynamics/aba_pivots.h ==== */
/* -- by articulated bodies --
   The bound e_k of [pivots], summed from the leaves to the root. K of a link is for IA what e is for a pivot:
   a bound of the terms whose sum it is. K obeys the recursion of IA. With V = U/D, a joint that gives way
   leaves its link P = 1 - S V' of the parent's motion, so that

       Ia = P' IA P + V armature V'        which is IA - U U'/D
       Ka = P' K P + V G V'                with G of [pivots] for the armature
       K_p += X' (Ka + rounding) X         a change of frame rounds each entry by a share of the largest
       e = S' K S + G

   K begins with the inertias of the link's bodies. */

/* S of dof k of link i, and its V = U/D, as pass 2 left it. Pass 2 does not store V_z of a revolute joint
   without armature, which is 1, nor V of a free base but for the axes before S. */
RBDI_COLD void rbdi_pivot_axis(const rbd_model *m, const rbd_work *w, int i, int k, rbd_real S[6],
                               rbd_real V[6]) {
    const rbdi_link *l = &m->link[i];

    for (int j = 0; j < 6; ++j) S[j] = rbdi_zero();

    if (rbdi_is(l, RBDI_BLOCK)) {
        const rbdi_block *b = rbdi_block_of(m, l);
        const int s = b->first + k, end = rbdi_free_base(l, b) ? s : 6;
        S[s] = rbdi_set(RBD_C(1));
        for (int j = 0; j < 6; ++j) V[j] = j < end ? w->block[l->block].U_D[k][j] : S[j];
        return;
    }

    S[2] = rbdi_set(l->rho);
    S[5] = rbdi_set(l->kappa);
    rbdi_store_force(V, 1, w->scratch[i].U_D);
    if (!rbdi_keeps_row_z(rbdi_flags(l))) V[2] = rbdi_set(RBD_C(1));
}

/* K becomes P' K P + V G V', P = 1 - S V'. Returns s = S' K S. Multiplied out:

       P' K P + V G V' = K - V (K S)' - (K S) V' + (s + G) V V' */
RBDI_COLD rbd_real rbdi_give_way(rbd_real K[6][6], const rbd_real S[6], const rbd_real V[6], rbd_real G) {
    rbd_real KS[6], s = rbdi_zero();

    /* K S and S' K S */
    for (int i = 0; i < 6; ++i) {
        KS[i] = rbdi_zero();
        for (int j = 0; j < 6; ++j) KS[i] = KS[i] + K[i][j] * S[j];
        s = s + S[i] * KS[i];
    }

    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) K[i][j] = K[i][j] + ((s + G) * V[i] - KS[i]) * V[j] - V[i] * KS[j];
    return s;
}

/* K becomes X' (K + rounding) X. The rounding of a change of frame is a share of the largest moment, and of
   the largest mass. X' takes a wrench to the parent's frame: first each column of K, then each row. */
RBDI_COLD void rbdi_carry_up(const rbd_model *m, const rbd_work *w, int i, rbd_real K[6][6]) {
    const rbdi_link *l = &m->link[i];

    for (int first = 0; first < 6; first += 3) {
        rbd_real most = rbdi_zero();
        for (int j = first; j < first + 3; ++j) most = rbdi_select(rbdi_less(most, K[j][j]), K[j][j], most);
        for (int j = first; j < first + 3; ++j) K[j][j] = K[j][j] + most * RBDI_TURN;
    }

    for (int j = 0; j < 12; ++j) {
        rbd_real *wrench = j < 6 ? &K[0][j] : K[j - 6];
        const int stride = j < 6 ? 6 : 1;
        rbdi_force F = rbdi_load_force(wrench, stride);

        if (rbdi_is(l, RBDI_BLOCK))
            F = rbdi_force_up_block(&w->block[l->block].X, F);
        else
            F = rbdi_force_up(l, rbdi_flags(l), rbdi_trig_of(m, w, i, rbdi_flags(l)), F);
        rbdi_store_force(wrench, stride, F);
    }
}

/* Checks the pivots of link i. K, the sum over its children, becomes its contribution to the parent's K. */
RBDI_COLD void rbdi_check_link(const rbd_model *m, rbd_work *w, int i, rbdi_mask doubt, rbd_real K[6][6]) {
    const rbdi_link *l = &m->link[i];
    rbd_real inertia[6], S[6], V[6];

    /* the inertias of the link's bodies */
    for (int b = 0; b < m->nb; ++b) {
        if (m->frame[b].link != i) continue;
        rbdi_body_inertia(m, b, inertia);
        for (int j = 0; j < 6; ++j) K[j][j] = K[j][j] + inertia[j];
    }

    /* each dof: e = S' K S + G, its verdict, K = P' K P + V G V' */
    for (int k = rbdi_link_dofs(m, l) - 1; k >= 0; --k) {
        const rbdi_dof *dof = &m->dof[l->iv + k];
        const rbd_real G = rbdi_abs(w->pivot[l->iv + k]) + dof->scale * RBDI_SHARE + dof->armature;
        rbd_real e;

        rbdi_pivot_axis(m, w, i, k, S, V);
        e = rbdi_give_way(K, S, V, G) + G;
        rbdi_check_pivot(w, l->iv + k, e, doubt);
    }

    if (l->parent >= 0) rbdi_carry_up(m, w, i, K);
}

/* Checks the pivots of the last pass 2, leaves first. The sums of branch points' K stand where those of IA
   did. */
RBDI_COLD void rbdi_check_bodies(const rbd_model *m, rbd_work *w, rbdi_mask doubt) {
    rbd_real K[6][6];

    for (int k = 0; k < m->nbranch; ++k) w->branch[k].I = rbdi_abi_zero();
    rbdi_clear(K[0], 36);

    for (int i = m->nl - 1; i >= 0; --i) {
        const rbdi_link *l = &m->link[i];

        if (l->branch >= 0) {
            rbd_real others[6][6]; /* the lower triangle of the other children's sum */

            rbdi_abi_to_array(w->branch[l->branch].I, others);
            for (int r = 0; r < 6; ++r)
                for (int s = 0; s < 6; ++s) K[r][s] = K[r][s] + others[r > s ? r : s][r > s ? s : r];
        }

        rbdi_check_link(m, w, i, doubt, K);
        if (l->parent == i - 1) continue;

        if (l->parent >= 0) {
            rbdi_branch *branch = &w->branch[m->link[l->parent].branch];
            branch->I = rbdi_abi_add(branch->I, rbdi_abi_from_array(K));
        }

        rbdi_clear(K[0], 36);
    }
}

/* ==== src/dynamics/hybrid.h ==== */
#ifndef RBD_NO_CHOLESKY
/* ---- hybrid dynamics [hybrid] ----
   RBDA section 9.1. f: the dofs whose torque is given; p: those whose acceleration is prescribed. With c =
   tau at a_p and a_f = 0:

       M_ff a_f = tau_f - c_f,   tau_p = c_p + M_pf a_f

   M_ff = L'DL is factored in place within the packed M, from the last dof to the first. M_pf stays. */

/* L and 1/D replace M_ff in H, x_f becomes L^-T x_f. Returns whether a pivot is in doubt. */
RBDI_PART rbdi_mask rbdi_eliminate_free(const rbd_model *m, rbd_work *w, const unsigned char *prescribed,
                                        rbd_real *H, rbd_real *x) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());

    for (int k = m->nv - 1; k >= 0; --k) {
        const rbdi_dof *dof = &m->dof[k];
        rbd_real *row = &H[dof->row], inverse;
        if (prescribed[k]) continue;

        w->pivot[k] = row[dof->depth];
        inverse = rbdi_pivot_inverse(w->pivot[k], dof->scale, &doubt);
        row[dof->depth] = inverse;

        /* of each free dof i on the path: l = L_ki, row i -= l row k, x_i -= l x_k */
        for (int t = dof->depth - 1, i = dof->lambda; t >= 0; --t, i = m->dof[i].lambda) {
            rbd_real *to = &H[m->dof[i].row];
            const rbd_real l = row[t] * inverse;
            if (prescribed[i]) continue;
            for (int s = t, j = i; s >= 0; --s, j = m->dof[j].lambda)
                if (!prescribed[j]) to[s] = to[s] - l * row[s];
            row[t] = l;
            x[i] = x[i] - l * x[k];
        }
    }

    return doubt;
}

/* a_f = L^-1 D^-1 x_f, tau_p = x_p + M_pf a_f. */
RBDI_PART void rbdi_substitute_free(const rbd_model *m, const unsigned char *prescribed, const rbd_real *H,
                                    const rbd_real *x, rbd_real *a, rbd_real *tau) {
    for (int k = 0; k < m->nv; ++k) {
        const rbdi_dof *dof = &m->dof[k];
        const rbd_real *row = &H[dof->row];
        rbd_real sum = rbdi_zero();

        for (int t = dof->depth - 1, i = dof->lambda; t >= 0; --t, i = m->dof[i].lambda)
            if (!prescribed[i]) sum = sum + row[t] * a[i];
        if (prescribed[k]) {
            tau[k] = x[k] + sum;
            continue;
        }

        a[k] = x[k] * row[dof->depth] - sum; /* x_k / D_k - sum of L_ki a_i */
        for (int t = dof->depth - 1, i = dof->lambda; t >= 0; --t, i = m->dof[i].lambda)
            if (prescribed[i]) tau[i] = tau[i] + row[t] * a[k];
    }
}

/* Checks the pivots of M_ff: those of M with the rows and columns p of the unit matrix, whose factor H
   becomes. */
RBDI_COLD rbd_status rbdi_check_free(const rbd_model *m, rbd_work *w, const unsigned char *prescribed,
                                     rbdi_mask doubt, rbd_real *a, rbd_real *tau) {
    for (int k = 0; k < m->nv; ++k) {
        rbd_real *row = &w->H[m->dof[k].row];
        if (prescribed[k]) w->pivot[k] = rbdi_set(RBD_C(1));
        for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda)
            if (prescribed[k] || prescribed[i]) row[t] = rbdi_zero();
    }

    rbdi_check_factor(m, w, w->H, doubt);
    for (int k = 0; k < m->nv; ++k)
        if (prescribed[k]) w->pivot[k] = rbdi_set(RBD_C(1)); /* good */
    (void)rbdi_pivot_status(m, w, tau, m->nv);
    return rbdi_pivot_status(m, w, a, m->nv);
}

RBDI_API rbd_status rbd_hybrid(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                               const unsigned char *given, rbd_real *a, rbd_real *tau,
                               const rbd_real *f_ext) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && given && a && tau);
    rbdi_mask doubt;
    if (status) return status;

    /* c = tau at a_p and a_f = 0 */
    for (int k = 0; k < m->nv; ++k)
        if (!given[k]) a[k] = rbdi_zero();
    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    rbdi_rnea(m, w, rbdi_expand_v(m, v, w->vx), rbdi_expand_v(m, a, w->ax), f_ext,
              rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);

    /* M_ff a_f = tau_f - c_f,  tau_p = c_p + M_pf a_f */
    for (int k = 0; k < m->nv; ++k)
        if (!given[k]) w->bias[k] = tau[k] - w->bias[k];
    rbdi_crba_of_joints(m, w, w->H);
    doubt = rbdi_eliminate_free(m, w, given, w->H, w->bias);
    rbdi_substitute_free(m, given, w->H, w->bias, a, tau);

    w->singular = -1;
    return rbdi_any(doubt) ? rbdi_check_free(m, w, given, doubt, a, tau) : RBD_OK;
}
#endif

/* ==== src/dynamics/forward.h ==== */
/* ---- forward dynamics [forward dynamics code] ---- */

RBDI_API rbd_status rbd_aba(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                            const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && tau && a);
    if (status) return status;
#ifndef RBD_NO_CHOLESKY
    /* a joint and its mimic are one dof at two links, which no sweep can eliminate at one of them */
    if (rbdi_mimics(m)) return rbd_fd_cholesky(m, w, q, v, tau, f_ext, a);
#endif

    rbdi_joints(m, w, q);
    rbdi_aba_velocities(m, w, v, 0);
    rbdi_external(m, w, f_ext);
    doubt = rbdi_aba_pass2(m, w, tau);
    rbdi_aba_pass3(m, w, rbdi_world_state(w->gravity).acc, a);

    w->singular = -1;
    if (!rbdi_any(doubt)) return RBD_OK;
    rbdi_check_bodies(m, w, doubt);
    return rbdi_pivot_status(m, w, a, m->nv);
}

#ifndef RBD_NO_CHOLESKY
RBDI_API rbd_status rbd_fd_cholesky(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && tau && a);
    if (status) return status;

    rbd_crba_packed(m, w, q, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_rnea(m, w, rbdi_expand_v(m, v, w->vx), w->zero, f_ext, rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int k = 0; k < m->nv; ++k) a[k] = tau[k] - w->bias[k];
    rbdi_solve(m, w, w->H, a);
    return rbdi_factor_status(m, w, w->H, doubt, a, m->nv);
}

RBDI_API rbd_status rbd_cholesky_factor_packed(const rbd_model *m, rbd_work *w, rbd_real *H) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, H != NULL);
    if (status) return status;
    doubt = rbdi_factor(m, w, H);
    return rbdi_factor_status(m, w, H, doubt, H, rbd_packed_size(m));
}

RBDI_API rbd_status rbd_cholesky_factor(const rbd_model *m, rbd_work *w, const rbd_real *M, rbd_real *L) {
    const rbd_status status = rbdi_check_dynamics(m, w, M && L);
    if (status) return status;

    for (int i = 0; i < m->nv; ++i) { /* L may be M, because packed rows end before the full ones do */
        const int depth = m->dof[i].depth;
        rbd_real *row = &L[m->dof[i].row];
        for (int t = depth, j = i; t >= 0; --t, j = m->dof[j].lambda) w->bias[t] = M[i * m->nv + j];
        for (int t = 0; t <= depth; ++t) row[t] = w->bias[t];
    }

    return rbd_cholesky_factor_packed(m, w, L);
}

RBDI_API rbd_status rbd_cholesky_solve(const rbd_model *m, rbd_work *w, const rbd_real *L, const rbd_real *b,
                                       rbd_real *x) {
    const rbd_status status = rbdi_check(m, w, L && b && x);
    if (status) return status;
    for (int k = 0; k < m->nv; ++k) x[k] = b[k];
    rbdi_solve(m, w, L, x);
    return RBD_OK;
}

RBDI_API rbd_status rbd_cholesky_solve_many(const rbd_model *m, rbd_work *w, const rbd_real *L, int n,
                                            const rbd_real *B, rbd_real *X) {
    const rbd_status status = rbdi_check(m, w, L && B && X);
    if (status) return status;
    if (n <= 0) return RBD_OK;
    if (X != B)
        for (ptrdiff_t k = 0; k < (ptrdiff_t)m->nv * n; ++k) X[k] = B[k];
    rbdi_solve_columns(m, w, L, 1, n, n, X);
    return RBD_OK;
}

RBDI_API rbd_status rbd_minverse(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *Minv) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, q && Minv);
    if (status) return status;
    rbd_crba_packed(m, w, q, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_invert(m, w, w->H, Minv);
    return rbdi_factor_status(m, w, w->H, doubt, Minv, m->nv * m->nv);
}
#endif

RBDI_API int rbd_singular_dof(const rbd_work *w) { return w ? w->singular : -1; }

/* ==== src/rbd.h ==== */
RBDI_CODE_END
RBDI_CODE_BEGIN

/* ==== src/motion/axes.h ==== */
/* Interface: rbdi_pose_block, rbdi_pose_step, rbdi_world_pose */

/* ---- axes and origins of links [axes] ----
   Poses of links in one frame, that of the world or of a base: the rows of E are a link's axes, r is its
   origin. */

/* The pose of that frame itself. */
RBDI_INLINE rbdi_pose rbdi_world_pose(void) {
    const rbd_real o = rbdi_zero(), one = rbdi_set(RBD_C(1));
    rbdi_pose p;
    p.E = rbdi_mat_of(one, o, o, o, one, o, o, o, one);
    p.r = rbdi_vec0();
    return p;
}

/* The pose of a one-axis link from its parent's, p: E = turns E_p, r = r_p + E_p' r_l + E' d z. A root keeps
   the origin. */
RBDI_INLINE rbdi_pose rbdi_pose_step(const rbdi_link *l, int flags, rbdi_trig t, rbdi_pose p) {
    rbdi_v3 x = rbdi_vec(p.E.xx, p.E.yx, p.E.zx); /* the columns of E: the frame's axes in the link's */
    rbdi_v3 y = rbdi_vec(p.E.xy, p.E.yy, p.E.zy);
    rbdi_v3 z = rbdi_vec(p.E.xz, p.E.yz, p.E.zz);

    if ((flags & RBDI_SHIFT_R) && !(flags & RBDI_ROOT)) {
        p.r = rbdi_add(p.r, rbdi_scale(rbdi_set(l->r.x), rbdi_vec(p.E.xx, p.E.xy, p.E.xz)));
        if (flags & RBDI_SHIFT_XYZ) {
            p.r = rbdi_add(p.r, rbdi_scale(rbdi_set(l->r.y), rbdi_vec(p.E.yx, p.E.yy, p.E.yz)));
            p.r = rbdi_add(p.r, rbdi_scale(rbdi_set(l->r.z), rbdi_vec(p.E.zx, p.E.zy, p.E.zz)));
        }
    }

    x = rbdi_down(l, flags, t, x);
    y = rbdi_down(l, flags, t, y);
    z = rbdi_down(l, flags, t, z);
    p.E = rbdi_mat_of(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z);

    if ((flags & RBDI_SHIFT_Z) && !(flags & RBDI_ROOT))
        p.r = rbdi_add(p.r, rbdi_scale(t.d, rbdi_vec(p.E.zx, p.E.zy, p.E.zz)));
    return p;
}

/* The same of a block with the pose X in its parent. */
RBDI_INLINE rbdi_pose rbdi_pose_block(const rbdi_pose *X, rbdi_pose p) {
    p.r = rbdi_add(p.r, rbdi_mul_t(p.E, X->r));
    p.E = rbdi_mul_mat(X->E, p.E);
    return p;
}

/* ==== src/motion/kinematics.h ==== */
/* Interface: rbdi_axes_of, rbdi_body_kin, rbdi_check_body_call, rbdi_kin_links, rbdi_point_p,
   rbdi_point_position, rbdi_point_v */

/* ---- kinematics [kinematics code] ---- */

/* Whether link j is in the subtree of link i. */
RBDI_INLINE int rbdi_carries(const rbd_model *m, int i, int j) {
    return i <= j && m->link[j].first < m->link[i].end;
}

/* Velocity of the parent-fixed point at r, both in the parent's axes. */
RBDI_INLINE rbdi_v3 rbdi_parent_velocity(const rbd_work *w, const rbdi_link *l, rbdi_v3 r) {
    const rbdi_kin *parent = &w->kin[l->parent < 0 ? 0 : l->parent];
    return l->parent < 0 ? rbdi_vec0() : rbdi_add(parent->v, rbdi_cross(parent->state.omega, r));
}

/* World pose of a one-axis link from its parent's, p. If moving, the velocity of its origin too, from its
   angular velocity, which rbdi_kin_states has set. */
RBDI_INLINE rbdi_pose rbdi_kin_axis(const rbd_work *w, const rbdi_link *l, rbdi_kin *k, int flags,
                                    rbdi_trig t, const rbd_real *v, int moving, rbdi_pose p) {
    p = rbdi_pose_step(l, flags & ~RBDI_ROOT, t, p);
    k->X = p;
    if (!moving) return p;

    k->v = rbdi_down(l, flags, t, rbdi_parent_velocity(w, l, rbdi_vec_c(l->r)));
    if (flags & RBDI_SHIFT_Z) {
        k->v.x = k->v.x + t.d * k->state.omega.y;
        k->v.y = k->v.y - t.d * k->state.omega.x;
    }
    if (flags & RBDI_SLIDES) k->v.z = k->v.z + v[l->iv] * l->kappa;
    return p;
}

/* The same of the links first .. end - 1, blocks too. */
RBDI_LOCAL void rbdi_kin_links(const rbd_model *m, rbd_work *w, int first, int end, const rbd_real *v,
                               int moving) {
    rbdi_pose p = rbdi_world_pose();

    for (int i = first; i < end; ++i) {
        const rbdi_link *l = &m->link[i];
        rbdi_kin *k = &w->kin[i];

        if (l->parent < 0)
            p = rbdi_world_pose();
        else if (l->parent != i - 1)
            p = w->kin[l->parent].X;

        if (rbdi_is(l, RBDI_BLOCK)) {
            const rbdi_pose *X = &w->block[l->block].X;
            p = rbdi_on_world(l) ? *X : rbdi_pose_block(X, p);
            k->X = p;
            if (moving)
                k->v = rbdi_add(rbdi_mul(X->E, rbdi_parent_velocity(w, l, X->r)),
                                rbdi_block_motion(rbdi_block_of(m, l), &v[l->iv]).v);
        } else {
            RBDI_BY_FLAGS(const int flags, l,
                          p = rbdi_kin_axis(w, l, k, flags, rbdi_trig_of(m, w, i, flags), v, moving, p));
        }
    }
}

/* States of the links first .. end - 1, after those of their ancestors. v, a: with mimics. */
RBDI_LOCAL void rbdi_kin_states(const rbd_model *m, rbd_work *w, int first, int end, const rbd_real *v,
                                const rbd_real *a) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    const rbdi_state world = rbdi_world_state(none);
    rbdi_forward(m, w, first, end, &world, v, a, 0, 1);
}

RBDI_API rbd_status rbd_kinematics(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                   const rbd_real *a) {
    const rbd_status status = rbdi_check(m, w, q != NULL);
    if (status) return status;

    w->moving = v || a;
    v = v ? rbdi_expand_v(m, v, w->vx) : w->zero;
    a = a ? rbdi_expand_v(m, a, w->ax) : w->zero;

    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    if (w->moving) rbdi_kin_states(m, w, 0, m->nl, v, a);
    rbdi_kin_links(m, w, 0, m->nl, v, w->moving);

    /* kinetic energy of the rotors */
    *w->rotors = rbdi_zero();
    if (w->moving)
        for (int i = 0; i < m->nv + rbdi_mimics(m); ++i)
            *w->rotors = *w->rotors + v[i] * v[i] * (RBD_C(0.5) * m->dof[i].armature);

    w->kinematics_of = m->nl;
    return RBD_OK;
}

RBDI_API rbd_status rbd_body_kinematics(const rbd_model *m, rbd_work *w, int body, const rbd_real *q,
                                        const rbd_real *v, const rbd_real *a) {
    const rbd_status status = rbdi_check(m, w, q != NULL);
    const rbdi_link *l;
    int last, leaf;
    if (status) return status;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    last = m->frame[body].link;
    w->moving = v || a;
    v = v ? rbdi_expand_v(m, v, w->vx) : w->zero;
    a = a ? rbdi_expand_v(m, a, w->ax) : w->zero;
    q = rbdi_expand_q(m, w, q);
    l = m->link;

    /* a dof of the subtrees of all links on the path, and of no others */
    leaf = last < 0 ? 0 : l[last].first;

    /* each run of links on the path, first .. end - 1. The links between do not move the body */
    for (int first = 0, end; first <= last; first = end) {
        for (; l->end <= leaf; ++l) ++first;
        for (end = first; end <= last && l->end > leaf; ++l) ++end;

        rbdi_range_joints(m, w, first, end, q);
        if (w->moving) rbdi_kin_states(m, w, first, end, v, a);
        rbdi_kin_links(m, w, first, end, v, w->moving);
    }

    w->kinematics_of = (int16_t)last;
    return RBD_OK;
}

/* Of a point x of a link, link axes: its position in the world; its velocity and acceleration, link axes. */
RBDI_INLINE rbdi_v3 rbdi_point_p(const rbdi_kin *k, rbdi_v3 x) {
    return rbdi_add(k->X.r, rbdi_mul_t(k->X.E, x));
}

RBDI_INLINE rbdi_v3 rbdi_point_v(const rbdi_kin *k, rbdi_v3 x) {
    return rbdi_add(k->v, rbdi_cross(k->state.omega, x));
}

RBDI_INLINE rbdi_v3 rbdi_point_acc(const rbdi_kin *k, rbdi_v3 x) {
    return rbdi_add(k->state.acc, rbdi_mul(rbdi_omega(k->state.omega, k->state.omega_dot), x));
}

/* Position of a point in the world. */
RBDI_ONCE rbdi_v3 rbdi_point_position(const rbd_model *m, const rbd_work *w, int body,
                                      const rbd_real *point) {
    const rbdi_frame *u = &m->frame[body];
    rbdi_v3 r = rbdi_vec_c(u->r);
    if (point) r = rbdi_add(r, rbdi_mul_t(rbdi_mat_c(u->E), rbdi_load_vec(point, 1)));
    return u->link < 0 ? r : rbdi_point_p(&w->kin[u->link], r);
}

/* E of a body: from world axes to its own. */
RBDI_PART rbdi_mat rbdi_axes_of(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_mat E = rbdi_mat_c(u->E);
    return u->link < 0 ? E : rbdi_mul_mat(E, w->kin[u->link].X.E);
}

/* Pose and state of a body of the description, in its own frame. */
RBDI_LOCAL rbdi_kin rbdi_body_kin(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_mat E = rbdi_mat_c(u->E);
    const rbdi_v3 r = rbdi_vec_c(u->r);
    rbdi_kin k;

    k.v = k.state.omega = k.state.omega_dot = k.state.acc = rbdi_vec0();
    if (w->moving && u->link >= 0) {
        k = w->kin[u->link];
        k.v = rbdi_mul(E, rbdi_point_v(&k, r));
        k.state.acc = rbdi_mul(E, rbdi_point_acc(&k, r));
        k.state.omega = rbdi_mul(E, k.state.omega);
        k.state.omega_dot = rbdi_mul(E, k.state.omega_dot);
    }

    k.X.E = rbdi_axes_of(m, w, body);
    k.X.r = rbdi_point_position(m, w, body, NULL);
    return k;
}

/* RBD_ERR_ORDER unless kinematics of this body, or of all with body -1, have been computed. */
RBDI_LOCAL rbd_status rbdi_have_kinematics(const rbd_model *m, const rbd_work *w, int body) {
    const int last = w->kinematics_of, link = body < 0 ? m->nl : m->frame[body].link;
    if (last == m->nl || link < 0) return last == RBDI_NO_KINEMATICS ? RBD_ERR_ORDER : RBD_OK;
    return rbdi_carries(m, link, last) ? RBD_OK : RBD_ERR_ORDER;
}

/* arrays: none of the caller's required ones is NULL. */
RBDI_LOCAL rbd_status rbdi_check_body_call(const rbd_model *m, const rbd_work *w, int body, int arrays) {
    const rbd_status status = rbdi_check(m, w, arrays);
    if (status) return status;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;
    return rbdi_have_kinematics(m, w, body);
}

RBDI_LOCAL rbd_status rbdi_check_robot_call(const rbd_model *m, const rbd_work *w) {
    const rbd_status status = rbdi_check_dynamics(m, w, 1);
    return status ? status : rbdi_have_kinematics(m, w, -1);
}

RBDI_API rbd_status rbd_body_pose(const rbd_model *m, const rbd_work *w, int body, rbd_real R[9],
                                  rbd_real p[3]) {
    const rbd_status status = rbdi_check_body_call(m, w, body, 1);
    if (status) return status;

    if (R) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        rbdi_store_vec(R, 1, rbdi_vec(E.xx, E.yx, E.zx));
        rbdi_store_vec(R + 3, 1, rbdi_vec(E.xy, E.yy, E.zy));
        rbdi_store_vec(R + 6, 1, rbdi_vec(E.xz, E.yz, E.zz));
    }

    if (p) rbdi_store_vec(p, 1, rbdi_point_position(m, w, body, NULL));
    return RBD_OK;
}

enum { RBDI_VELOCITY, RBDI_CLASSICAL_ACCELERATION, RBDI_SPATIAL_ACCELERATION };

/* Velocity, or classical or spatial acceleration, of a point of a body. */
RBDI_LOCAL rbd_status rbdi_point_motion(const rbd_model *m, const rbd_work *w, int body,
                                        const rbd_real *point, rbd_axes axes, int quantity, rbd_real *out) {
    const rbd_status status = rbdi_check_body_call(m, w, body, out != NULL);
    const rbdi_v3 x = point ? rbdi_load_vec(point, 1) : rbdi_vec0();
    rbdi_motion V;
    rbdi_kin k;
    if (status) return status;

    k = rbdi_body_kin(m, w, body);
    V.omega = quantity == RBDI_VELOCITY ? k.state.omega : k.state.omega_dot;
    V.v = quantity == RBDI_VELOCITY ? rbdi_point_v(&k, x) : rbdi_point_acc(&k, x);
    if (quantity == RBDI_SPATIAL_ACCELERATION) V.v = rbdi_sub(V.v, rbdi_cross(k.state.omega, k.v));

    if (axes != RBD_LINK_AXES) {
        V.omega = rbdi_mul_t(k.X.E, V.omega);
        V.v = rbdi_mul_t(k.X.E, V.v);
    }

    rbdi_store_motion(out, 1, V);
    return RBD_OK;
}

RBDI_API rbd_status rbd_body_velocity(const rbd_model *m, const rbd_work *w, int body, rbd_real velocity[6]) {
    return rbdi_point_motion(m, w, body, NULL, RBD_LINK_AXES, RBDI_VELOCITY, velocity);
}

RBDI_API rbd_status rbd_body_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                          rbd_real acceleration[6]) {
    return rbdi_point_motion(m, w, body, NULL, RBD_LINK_AXES, RBDI_SPATIAL_ACCELERATION, acceleration);
}

RBDI_API rbd_status rbd_body_acceleration_classical(const rbd_model *m, const rbd_work *w, int body,
                                                    rbd_real acceleration[6]) {
    return rbdi_point_motion(m, w, body, NULL, RBD_LINK_AXES, RBDI_CLASSICAL_ACCELERATION, acceleration);
}

RBDI_API rbd_status rbd_point_velocity(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_axes axes, rbd_real velocity[6]) {
    return rbdi_point_motion(m, w, body, point, axes, RBDI_VELOCITY, velocity);
}

RBDI_API rbd_status rbd_point_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, rbd_real acceleration[6]) {
    return rbdi_point_motion(m, w, body, point, axes, RBDI_CLASSICAL_ACCELERATION, acceleration);
}

RBDI_API rbd_const rbd_mass(const rbd_model *m) {
    rbd_const mass = RBD_C(0);
    for (int body = 0; body < rbd_nb(m); ++body)
        if (m->frame[body].link >= 0) mass += m->frame[body].mass;
    return mass;
}

/* The motion of a body, in its own axes: its centre of mass com, with velocity v and acceleration acc; its
   angular momentum L about com, with its rate. */
typedef struct rbdi_moving {
    rbdi_kin k;
    rbd_real mass;
    rbdi_v3 com, v, acc, L, L_dot;
} rbdi_moving;

RBDI_LOCAL rbdi_moving rbdi_moving_body(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_sym I = rbdi_sym_c(u->I);
    rbdi_moving b;

    b.k = rbdi_body_kin(m, w, body);
    b.mass = rbdi_set(u->mass);
    b.com = rbdi_vec_c(u->com);
    b.v = rbdi_point_v(&b.k, b.com);
    b.acc = rbdi_point_acc(&b.k, b.com);
    b.L = rbdi_mul_sym(I, b.k.state.omega);
    b.L_dot = rbdi_add(rbdi_mul_sym(I, b.k.state.omega_dot), rbdi_cross(b.k.state.omega, b.L));
    return b;
}

/* Sums over all bodies that a joint moves, world axes: momentum h about their centre of mass, with its
   rate; kinetic energy without that of the rotors. */
typedef struct rbdi_total {
    rbdi_force h, h_dot;
    rbdi_v3 com, arm; /* of the centre of mass, from the world's origin and the first link's */
    rbd_real mass, inverse_mass, kinetic;
} rbdi_total;

/* Adds to h the momentum of a body at r with linear velocity v and angular momentum L; or, with their
   rates, to h_dot. */
RBDI_INLINE void rbdi_add_momentum(const rbdi_moving *b, rbdi_v3 r, rbdi_v3 v, rbdi_v3 L, rbdi_force *h) {
    const rbdi_v3 f = rbdi_scale(b->mass, rbdi_mul_t(b->k.X.E, v));
    h->f = rbdi_add(h->f, f);
    h->n = rbdi_add(h->n, rbdi_add(rbdi_mul_t(b->k.X.E, L), rbdi_cross(r, f)));
}

/* Sums the momenta about the first link's origin o, which rounds less than about a far world origin, then
   moves them to the centre of mass: n - arm x f. com is not o + arm: bodies may be far from o. */
RBDI_LOCAL rbdi_total rbdi_add_bodies(const rbd_model *m, const rbd_work *w) {
    const rbd_const mass = rbd_mass(m);
    const rbdi_v3 o = mass > 0 ? w->kin[0].X.r : rbdi_vec0();
    rbdi_total s;

    s.mass = rbdi_set(mass);
    s.inverse_mass = rbdi_set(mass > 0 ? RBD_C(1) / mass : RBD_C(0));
    s.kinetic = rbdi_zero();
    s.com = s.arm = rbdi_vec0();
    s.h = s.h_dot = rbdi_force0();

    for (int body = 0; body < m->nb; ++body) {
        rbdi_moving b;
        rbdi_v3 p, r;
        if (m->frame[body].link < 0) continue;

        b = rbdi_moving_body(m, w, body);
        p = rbdi_point_p(&b.k, b.com);
        r = rbdi_sub(p, o);
        s.com = rbdi_add(s.com, rbdi_scale(b.mass * s.inverse_mass, p));
        s.arm = rbdi_add(s.arm, rbdi_scale(b.mass * s.inverse_mass, r));
        rbdi_add_momentum(&b, r, b.v, b.L, &s.h);
        rbdi_add_momentum(&b, r, b.acc, b.L_dot, &s.h_dot);
        s.kinetic = s.kinetic + RBD_C(0.5) * (b.mass * rbdi_dot(b.v, b.v) + rbdi_dot(b.k.state.omega, b.L));
    }

    s.h.n = rbdi_sub(s.h.n, rbdi_cross(s.arm, s.h.f));
    s.h_dot.n = rbdi_sub(s.h_dot.n, rbdi_cross(s.arm, s.h_dot.f));
    return s;
}

RBDI_API rbd_status rbd_com(const rbd_model *m, const rbd_work *w, rbd_real position[3], rbd_real velocity[3],
                            rbd_real acceleration[3]) {
    const rbd_status status = rbdi_check_robot_call(m, w);
    rbdi_total s;
    if (status) return status;

    s = rbdi_add_bodies(m, w);
    if (position) rbdi_store_vec(position, 1, s.com);
    if (velocity) rbdi_store_vec(velocity, 1, rbdi_scale(s.inverse_mass, s.h.f));
    if (acceleration) rbdi_store_vec(acceleration, 1, rbdi_scale(s.inverse_mass, s.h_dot.f));
    return RBD_OK;
}

RBDI_API rbd_status rbd_energy(const rbd_model *m, const rbd_work *w, rbd_real *kinetic,
                               rbd_real *potential) {
    const rbd_status status = rbdi_check_robot_call(m, w);
    rbdi_total s;
    if (status) return status;
    s = rbdi_add_bodies(m, w);
    if (kinetic) *kinetic = *w->rotors + s.kinetic;
    if (potential) *potential = -(s.mass * rbdi_dot(rbdi_vec_c(w->gravity), s.com));
    return RBD_OK;
}

RBDI_API rbd_status rbd_momentum(const rbd_model *m, const rbd_work *w, rbd_real h[6], rbd_real h_dot[6]) {
    const rbd_status status = rbdi_check_robot_call(m, w);
    rbdi_total s;
    if (status) return status;
    s = rbdi_add_bodies(m, w);
    if (h) rbdi_store_force(h, 1, s.h);
    if (h_dot) rbdi_store_force(h_dot, 1, s.h_dot);
    return RBD_OK;
}

/* A wrench on a body, in its own axes, to the parent's origin and axes. */
RBDI_LOCAL rbdi_force rbdi_wrench_to_parent(const rbd_model *m, const rbd_work *w, const rbdi_frame *u,
                                            rbdi_force F) {
    const rbdi_frame *parent = &m->frame[u->parent];
    const rbdi_mat E = rbdi_mat_c(parent->E);
    rbdi_pose X;

    X.E = rbdi_mat_c(u->E);
    X.r = rbdi_vec_c(u->r);
    F = rbdi_force_up_block(&X, F);

    for (int i = u->link; i != parent->link; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        if (rbdi_is(l, RBDI_BLOCK))
            F = rbdi_force_up_block(&w->block[l->block].X, F);
        else
            F = rbdi_force_up(l, rbdi_flags(l), rbdi_trig_of(m, w, i, rbdi_flags(l)), F);
    }

    F.n = rbdi_mul(E, rbdi_sub(F.n, rbdi_cross(rbdi_vec_c(parent->r), F.f)));
    F.f = rbdi_mul(E, F.f);
    return F;
}

RBDI_API rbd_status rbd_joint_wrench(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                     const rbd_real *a, const rbd_real *f_ext, rbd_real *wrench) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && wrench);
    if (status) return status;

    rbd_kinematics(m, w, q, v, a);

    for (int body = 0; body < m->nb; ++body) {
        const rbdi_moving b = rbdi_moving_body(m, w, body);
        rbdi_force F;
        F.f = rbdi_scale(b.mass, rbdi_sub(b.acc, rbdi_mul(b.k.X.E, rbdi_vec_c(w->gravity))));
        F.n = rbdi_add(b.L_dot, rbdi_cross(b.com, F.f));
        if (f_ext) F = rbdi_force_sub(F, rbdi_load_force(f_ext + 6 * body, 1));
        rbdi_store_force(wrench + 6 * body, 1, F);
    }

    for (int body = m->nb - 1; body >= 0; --body) {
        const rbdi_frame *u = &m->frame[body];
        rbd_real *to;
        rbdi_force F;
        if (u->parent < 0) continue;
        to = wrench + 6 * u->parent;
        F = rbdi_wrench_to_parent(m, w, u, rbdi_load_force(wrench + 6 * body, 1));
        rbdi_store_force(to, 1, rbdi_force_add(rbdi_load_force(to, 1), F));
    }

    return RBD_OK;
}

/* ==== src/motion/points.h ==== */
/* Interface: rbdi_axis_motion, rbdi_column, rbdi_common_link, rbdi_unit_axis */

/* ---- points and momentum [points code] ---- */

/* The axis of a link that its spatial unit axis, omega_x .. omega_z, v_x .. v_z, has, in world axes. */
RBDI_INLINE rbdi_v3 rbdi_unit_axis(const rbdi_pose *X, int axis) {
    return rbdi_load_vec((const rbd_real *)&X->E + 3 * (axis < 3 ? axis : axis - 3), 1);
}

/* Motion of a point of a link for unit velocity of its spatial unit axis, which is a: (a; a x arm) or, if it
   slides, (0; a); a screw: rho and kappa times these. arm: from the link's origin to the point. */
RBDI_INLINE rbdi_motion rbdi_axis_motion(const rbdi_link *l, int axis, rbdi_v3 a, rbdi_v3 arm) {
    rbdi_motion c;

    c.omega = axis < 3 ? a : rbdi_vec0();
    c.v = axis < 3 ? rbdi_cross(a, arm) : a;

    if (rbdi_is(l, RBDI_SCREW)) {
        c.omega = rbdi_scale(rbdi_set(l->rho), a);
        c.v = rbdi_add(rbdi_scale(rbdi_set(l->rho), c.v), rbdi_scale(rbdi_set(l->kappa), a));
    }

    return c;
}

/* The same for unit velocity of dof k of link i, of the point at r, world axes. */
RBDI_INLINE rbdi_motion rbdi_column(const rbd_model *m, const rbd_work *w, int i, int k, rbdi_v3 r) {
    const rbdi_link *l = &m->link[i];
    const rbdi_pose *X = &w->kin[i].X;
    const int axis = rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first + k : 2;
    return rbdi_axis_motion(l, axis, rbdi_unit_axis(X, axis), rbdi_sub(r, X->r));
}

/* Stores a link's column in J, in the axes E if given; with a factor adds factor times the column. */
RBDI_INLINE void rbdi_put_column(const rbdi_link *l, const rbdi_pose *X, int axis, rbdi_v3 arm,
                                 const rbdi_mat *E, const rbd_real *factor, rbd_real *J, ptrdiff_t nv) {
    rbdi_v3 a = rbdi_unit_axis(X, axis);
    rbdi_motion c;

    if (E) a = rbdi_mul(*E, a);
    c = rbdi_axis_motion(l, axis, a, arm);

    if (factor) {
        c.omega = rbdi_add(rbdi_load_vec(J, nv), rbdi_scale(*factor, c.omega));
        c.v = rbdi_add(rbdi_load_vec(J + 3 * nv, nv), rbdi_scale(*factor, c.v));
    }

    rbdi_store_motion(J, nv, c);
}

/* Writes into J the columns of link i and of its ancestors up to link `end`, which has none, in the axes E if
   there are any. If sign is not 0, they are added times sign, as other links may have part in a column. */
RBDI_ONCE void rbdi_put_path(const rbd_model *m, const rbd_work *w, int i, int end, rbdi_v3 r,
                             const rbdi_mat *E, int sign, rbd_real *J) {
    const ptrdiff_t nv = m->nv;

    for (; i != end; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const rbdi_pose *X = &w->kin[i].X;
        const rbd_real ratio = sign ? rbdi_ratio(m, l->iv) * (rbd_const)sign : rbdi_zero();
        const rbd_real *factor = sign ? &ratio : NULL;
        rbd_real *to = &J[sign ? rbdi_source(m, l->iv) : l->iv];
        rbdi_v3 arm = rbdi_sub(r, X->r);

        if (E) arm = rbdi_mul(*E, arm);
        if (!rbdi_is(l, RBDI_BLOCK)) {
            rbdi_put_column(l, X, 2, arm, E, factor, to, nv);
        } else {
            const rbdi_block *b = rbdi_block_of(m, l);
            for (int axis = b->first; axis < b->first + b->n; ++axis, ++to)
                rbdi_put_column(l, X, axis, arm, E, factor, to, nv);
        }
    }
}

/* The last link that carries both of two links, -1 if there is none. Its joint moves both alike. */
RBDI_LOCAL int rbdi_common_link(const rbd_model *m, int link, int other) {
    int common = other;
    while (common >= 0 && !rbdi_carries(m, common, link)) common = m->link[common].parent;
    return common;
}

/* Jacobian of a point of `body` minus that of the same place fixed in `reference` (-1 = the world), in the
   axes of the body `axes` (-1 = the world's). */
RBDI_LOCAL void rbdi_put_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real *point,
                                  int reference, int axes, rbd_real *J) {
    const rbdi_v3 r = rbdi_point_position(m, w, body, point);
    const int link = m->frame[body].link, other = reference < 0 ? -1 : m->frame[reference].link;
    const int common = rbdi_common_link(m, link, other);
    rbdi_mat E;

    if (axes >= 0) E = rbdi_axes_of(m, w, axes);
    rbdi_clear(J, 6 * m->nv);
    for (int sign = 1; sign >= -1; sign -= 2)
        rbdi_put_path(m, w, sign > 0 ? link : other, common, r, axes >= 0 ? &E : NULL, sign, J);
}

RBDI_API rbd_status rbd_relative_jacobian(const rbd_model *m, const rbd_work *w, int body,
                                          const rbd_real point[3], int reference, rbd_axes axes,
                                          rbd_real *J) {
    rbd_status status;
    if (reference == -1) return rbd_jacobian(m, w, body, point, RBD_WORLD_AXES, J);
    status = rbdi_check_body_call(m, w, body, J != NULL);
    if (!status) status = rbdi_check_body_call(m, w, reference, 1);
    if (status) return status;
    rbdi_put_jacobian(m, w, body, point, reference, axes == RBD_LINK_AXES ? reference : -1, J);
    return RBD_OK;
}

RBDI_API rbd_status rbd_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                 rbd_axes axes, rbd_real *J) {
    const rbd_status status = rbdi_check_body_call(m, w, body, J != NULL);
    if (status) return status;

    if (axes == RBD_LINK_AXES || rbdi_mimics(m)) {
        rbdi_put_jacobian(m, w, body, point, -1, axes == RBD_LINK_AXES ? body : -1, J);
    } else { /* apart for speed: this loop has half of the instructions */
        rbdi_clear(J, 6 * m->nv);
        rbdi_put_path(m, w, m->frame[body].link, -1, rbdi_point_position(m, w, body, point), NULL, 0, J);
    }

    return RBD_OK;
}

RBDI_API rbd_status rbd_jacobian_transpose(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, const rbd_real f[6],
                                           rbd_real *tau) {
    const rbd_status status = rbdi_check_body_call(m, w, body, f && tau);
    rbdi_v3 r;
    rbdi_force F;
    if (status) return status;

    F = rbdi_load_force(f, 1);
    if (axes == RBD_LINK_AXES) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        F.n = rbdi_mul_t(E, F.n);
        F.f = rbdi_mul_t(E, F.f);
    }

    r = rbdi_point_position(m, w, body, point);
    rbdi_clear(tau, m->nv);

    for (int i = m->frame[body].link; i >= 0; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        for (int k = 0; k < rbdi_link_dofs(m, l); ++k) {
            const rbdi_motion c = rbdi_column(m, w, i, k, r);
            rbd_real *to = &tau[rbdi_source(m, l->iv + k)];
            *to = *to + (rbdi_dot(c.omega, F.n) + rbdi_dot(c.v, F.f)) * rbdi_ratio(m, l->iv + k);
        }
    }

    return RBD_OK;
}

RBDI_API rbd_status rbd_point_wrench(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                     rbd_axes axes, const rbd_real f[6], rbd_real row[6]) {
    const rbd_status status = rbdi_check_body_call(m, w, body, f && row);
    rbdi_force F;
    if (status) return status;

    F = rbdi_load_force(f, 1);
    if (axes != RBD_LINK_AXES) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        F.n = rbdi_mul(E, F.n);
        F.f = rbdi_mul(E, F.f);
    }

    if (point) F.n = rbdi_add(F.n, rbdi_cross(rbdi_load_vec(point, 1), F.f));
    rbdi_store_force(row, 1, F);
    return RBD_OK;
}

RBDI_API rbd_status rbd_point_position(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_real position[3]) {
    const rbd_status status = rbdi_check_body_call(m, w, body, position != NULL);
    if (status) return status;
    rbdi_store_vec(position, 1, rbdi_point_position(m, w, body, point));
    return RBD_OK;
}

/* ==== src/motion/manifold.h ==== */
/* Interface: rbdi_difference_joint, rbdi_joint_motion, rbdi_joint_turns, rbdi_put_joint_motion,
   rbdi_step_joint */

/* ---- configuration manifold [manifold code] ---- */

/* Whether the joint of a body turns: rbdi_type_turns. */
RBDI_INLINE int rbdi_joint_turns(const rbdi_frame *u) { return rbdi_type_turns(u->type); }

/* The motion in body axes from the joint's components in v, which are a stride apart, and back. */
RBDI_LOCAL rbdi_motion rbdi_joint_motion(const rbdi_frame *u, const rbd_real *v, ptrdiff_t stride) {
    rbd_real array[6];
    for (int k = 0; k < 6; ++k) array[k] = rbdi_zero();
    for (int k = 0; k < u->nv; ++k) array[rbdi_first_axis(u->type) + k] = v[k * stride];
    return rbdi_load_motion(array, 1);
}

RBDI_LOCAL void rbdi_put_joint_motion(const rbdi_frame *u, rbdi_motion V, rbd_real *v, ptrdiff_t stride) {
    rbd_real array[6];
    rbdi_store_motion(array, 1, V);
    for (int k = 0; k < u->nv; ++k) v[k * stride] = array[rbdi_first_axis(u->type) + k];
}

/* The coordinates of the origin p: back from rbdi_joint_origin. */
RBDI_LOCAL void rbdi_put_origin(const rbdi_frame *u, rbdi_v3 p, rbd_real *q) {
    if (u->type == RBD_PLANAR) {
        q[0] = p.x;
        q[1] = p.y;
    }
    if (u->type == RBD_FLOATING) rbdi_store_vec(q, 1, p);
}

/* E of a joint of the description, compiled once. */
RBDI_PART rbdi_mat rbdi_attitude_of(const rbdi_frame *u, const rbd_real *q) {
    return rbdi_joint_attitude(u->type, q);
}

/* q_next of a joint that turns by e in its own axes, with its origin moved by the shift in the axes of q:
   p_next = p + E' shift, and the turn. */
RBDI_LOCAL void rbdi_turn_joint(const rbdi_frame *u, const rbd_real *q, rbdi_exp e, rbdi_v3 turn,
                                rbdi_v3 shift, rbd_real *q_next) {
    shift = rbdi_mul_t(rbdi_attitude_of(u, q), shift);
    rbdi_put_origin(u, rbdi_add(rbdi_joint_origin(u->type, q), shift), q_next);
    if (u->type == RBD_PLANAR)
        q_next[2] = q[2] + turn.z;
    else
        rbdi_quaternion_step(&q[u->nq - 4], e, turn, &q_next[u->nq - 4]);
}

/* q_next = q (+) d for one joint of the description: along a screw. */
RBDI_LOCAL void rbdi_step_joint(const rbdi_frame *u, const rbd_real *q, const rbd_real *d, rbd_real *q_next) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real c, s, cd, sd, next[2];
        rbdi_unit_cs(q, &c, &s);
        rbdi_sincos(d[0], &sd, &cd);
        next[0] = c * cd - s * sd;
        next[1] = s * cd + c * sd;
        rbdi_unit_cs(next, &q_next[0], &q_next[1]);
    } else if (rbdi_joint_turns(u)) {
        const rbdi_motion step = rbdi_joint_motion(u, d, 1);
        const rbdi_exp e = rbdi_exp_of(step.omega);
        rbdi_turn_joint(u, q, e, step.omega, rbdi_exp_shift(e, step.omega, step.v), q_next);
    } else {
        for (int k = 0; k < u->nv; ++k) q_next[k] = q[k] + d[k];
    }
}

/* The same angle in [-pi, pi], but unchanged, to the bit, if it is there already. */
RBDI_LOCAL rbd_real rbdi_within_half_turn(rbd_real angle) {
    const rbd_real pi2 = rbdi_set(RBDI_PI(rbd_const) * RBDI_PI(rbd_const));
    rbd_real c, s;
    rbdi_sincos(angle, &s, &c);
    return rbdi_select(rbdi_less(pi2, angle * angle), rbdi_signed_angle(s, c), angle);
}

/* d with q0 (+) d = q1, for one joint. */
RBDI_LOCAL void rbdi_difference_joint(const rbdi_frame *u, const rbd_real *q0, const rbd_real *q1,
                                      rbd_real *d) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real c, s, c1, s1;
        rbdi_unit_cs(q0, &c, &s);
        rbdi_unit_cs(q1, &c1, &s1);
        d[0] = rbdi_signed_angle(c * s1 - s * c1, c * c1 + s * s1);
    } else if (rbdi_joint_turns(u)) {
        const rbdi_v3 shift = rbdi_sub(rbdi_joint_origin(u->type, q1), rbdi_joint_origin(u->type, q0));
        rbdi_motion step;

        /* omega: the turn from q0 to q1; v: the shift of the screw that leads to E (p1 - p0) */
        step.omega = u->type == RBD_PLANAR
                         ? rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_within_half_turn(q1[2] - q0[2]))
                         : rbdi_quaternion_difference(&q0[u->nq - 4], &q1[u->nq - 4]);
        step.v = rbdi_mul(rbdi_attitude_of(u, q0), shift);
        step.v = rbdi_log_shift(rbdi_exp_of(step.omega), step.omega, step.v);
        rbdi_put_joint_motion(u, step, d, 1);
    } else {
        for (int k = 0; k < u->nv; ++k) d[k] = q1[k] - q0[k];
    }
}

/* 1 / |q| of a quaternion or (cos, sin) with this unit one of the same direction; 0 if q is shorter than
   1e-15. */
RBDI_LOCAL rbd_real rbdi_inverse_length(const rbd_real *q, const rbd_real *unit, int n) {
    rbdi_mask bad = rbdi_less(*q, *q);
    rbd_real length = rbdi_zero();
    for (int k = 0; k < n; ++k) length = length + q[k] * unit[k];
    return rbdi_reciprocal(length, RBD_C(1e-15), &bad);
}

/* rbd_rates_from_velocity of one joint. */
RBDI_LOCAL void rbdi_joint_rates(const rbdi_frame *u, const rbd_real *q, const rbd_real *v, rbd_real *rates) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rates[0] = -(q[1] * v[0]);
        rates[1] = q[0] * v[0];
    } else if (rbdi_joint_turns(u)) {
        const rbdi_motion V = rbdi_joint_motion(u, v, 1);
        rbd_real turn[4];

        /* dp/dt = E' v, d quaternion/dt = quaternion (omega/2, 0) */
        rbdi_put_origin(u, rbdi_mul_t(rbdi_attitude_of(u, q), V.v), rates);
        rbdi_store_vec(turn, 1, rbdi_scale(rbdi_set(RBD_C(0.5)), V.omega));
        turn[3] = rbdi_zero();
        if (u->type == RBD_PLANAR)
            rates[2] = V.omega.z;
        else
            rbdi_quaternion_product(&q[u->nq - 4], turn, &rates[u->nq - 4]);
    } else {
        for (int k = 0; k < u->nv; ++k) rates[k] = v[k];
    }
}

/* Angular velocity from a quaternion of any length and its rates. */
RBDI_LOCAL rbdi_v3 rbdi_quaternion_velocity(const rbd_real *q, const rbd_real *rates) {
    rbd_real unit[4], inverse;
    rbdi_unit_quaternion(q, unit);
    inverse = rbdi_inverse_length(q, unit, 4);
    for (int k = 0; k < 3; ++k) unit[k] = -unit[k];
    rbdi_quaternion_product(unit, rates, unit);
    return rbdi_scale(inverse + inverse, rbdi_load_vec(unit, 1));
}

/* rbd_velocity_from_rates of one joint. */
RBDI_LOCAL void rbdi_joint_velocity(const rbdi_frame *u, const rbd_real *q, const rbd_real *rates,
                                    rbd_real *v) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real unit[2];
        rbdi_unit_cs(q, &unit[0], &unit[1]);
        v[0] = (unit[0] * rates[1] - unit[1] * rates[0]) * rbdi_inverse_length(q, unit, 2);
    } else if (rbdi_joint_turns(u)) {
        rbdi_motion V;
        V.v = rbdi_mul(rbdi_attitude_of(u, q), rbdi_joint_origin(u->type, rates));
        V.omega = u->type == RBD_PLANAR ? rbdi_vec(rbdi_zero(), rbdi_zero(), rates[2])
                                        : rbdi_quaternion_velocity(&q[u->nq - 4], &rates[u->nq - 4]);
        rbdi_put_joint_motion(u, V, v, 1);
    } else {
        for (int k = 0; k < u->nv; ++k) v[k] = rates[k];
    }
}

RBDI_API rbd_status rbd_rates_from_velocity(const rbd_model *m, const rbd_real *q, const rbd_real *v,
                                            rbd_real *rates) {
    if (!m || !q || !v || !rates) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_joint_rates(u, &q[u->iq], &v[u->iv], &rates[u->iq]);
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_velocity_from_rates(const rbd_model *m, const rbd_real *q, const rbd_real *rates,
                                            rbd_real *v) {
    if (!m || !q || !rates || !v) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_joint_velocity(u, &q[u->iq], &rates[u->iq], &v[u->iv]);
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_integrate(const rbd_model *m, const rbd_real *q, const rbd_real *v, rbd_real dt,
                                  rbd_real *q_next) {
    if (!m || !q || !v || !q_next) return RBD_ERR_NULL;

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real d[6];
        for (int k = 0; k < u->nv; ++k) d[k] = v[u->iv + k] * dt;
        if (u->nv > 0) rbdi_step_joint(u, &q[u->iq], d, &q_next[u->iq]);
    }

    return RBD_OK;
}

RBDI_API rbd_status rbd_difference(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real *d) {
    if (!m || !q0 || !q1 || !d) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_difference_joint(u, &q0[u->iq], &q1[u->iq], &d[u->iv]);
    }
    return RBD_OK;
}

/* q = q0 (+) s (q1 (-) q0) for one joint. At s = 1 it is q1 (+) 0, without rounding of the difference. */
RBDI_LOCAL void rbdi_interpolate_joint(const rbdi_frame *u, const rbd_real *q0, const rbd_real *q1,
                                       rbd_real s, rbd_real *q) {
    const rbd_real one = rbdi_set(RBD_C(1));
    const rbdi_mask within = rbdi_or(rbdi_less(s, one), rbdi_less(one, s)); /* neither of NaN */
    const rbd_real share = rbdi_select(within, s, s - one);
    rbd_real from[7], d[6];

    rbdi_difference_joint(u, q0, q1, d);
    for (int k = 0; k < u->nv; ++k) d[k] = d[k] * share;
    for (int k = 0; k < u->nq; ++k) from[k] = rbdi_select(within, q0[k], q1[k]);

    rbdi_step_joint(u, from, d, q);
}

RBDI_API rbd_status rbd_interpolate(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real s,
                                    rbd_real *q) {
    if (!m || !q0 || !q1 || !q) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_interpolate_joint(u, &q0[u->iq], &q1[u->iq], s, &q[u->iq]);
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_distance(const rbd_model *m, const rbd_real *q0, const rbd_real *q1,
                                 const rbd_const *weight, rbd_real *distance) {
    rbd_real sum = rbdi_zero();
    if (!m || !q0 || !q1 || !distance) return RBD_ERR_NULL;

    if (weight)
        for (int k = 0; k < m->nv; ++k)
            if (!(weight[k] >= 0)) return RBD_ERR_RANGE;

    /* the sum of weight_k d_k^2 */
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real d[6];
        if (u->nv > 0) rbdi_difference_joint(u, &q0[u->iq], &q1[u->iq], d);
        for (int k = 0; k < u->nv; ++k) sum = sum + d[k] * d[k] * (weight ? weight[u->iv + k] : RBD_C(1));
    }

    *distance = rbdi_sqrt(sum);
    return RBD_OK;
}

/* The zero of one joint, whose q is 0 before. */
RBDI_LOCAL void rbdi_neutral_joint(const rbdi_frame *u, rbd_real *q) {
    if (u->type == RBD_CONTINUOUS_CS) q[0] = rbdi_set(RBD_C(1));
    if (rbdi_has_quaternion(u->type)) q[u->nq - 1] = rbdi_set(RBD_C(1));
}

RBDI_API rbd_status rbd_neutral(const rbd_model *m, rbd_real *q) {
    if (!m || !q) return RBD_ERR_NULL;
    for (int k = 0; k < m->nq; ++k) q[k] = rbdi_zero();
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_neutral_joint(u, &q[u->iq]);
    }
    return RBD_OK;
}

/* A number uniform in [0, 1), with 24 bits, which every scalar has, by splitmix64 (Steele, Lea and Flood
   2014). */
RBDI_LOCAL rbd_const rbdi_uniform(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (rbd_const)(int32_t)(z >> 40) * RBD_C(5.9604644775390625e-8);
}

/* A number uniform between two bounds; each lane draws its own. */
RBDI_COLD rbd_real rbdi_draw(uint64_t *seed, rbd_const lower, rbd_const upper) {
#ifdef RBD_LANES
    rbd_real x = rbdi_zero();

    for (int i = 0; i < RBD_LANES; ++i) {
        const rbd_const share = rbdi_uniform(seed);
        x[i] = lower * (1 - share) + upper * share;
    }

    return x;
#else
    const rbd_const share = rbdi_uniform(seed);

    return rbdi_set(lower * (1 - share) + upper * share);
#endif
}

/* A uniform orientation: two points on circles with radii sqrt(x), sqrt(1 - x), x uniform (Shoemake 1992). */
RBDI_COLD void rbdi_draw_quaternion(uint64_t *seed, rbd_real *q) {
    rbd_real x = rbdi_draw(seed, RBD_C(0), RBD_C(1)), radius = rbdi_sqrt(x), c, s;

    rbdi_sincos(rbdi_draw(seed, -RBDI_PI(rbd_const), RBDI_PI(rbd_const)), &s, &c);
    q[0] = radius * s;
    q[1] = radius * c;
    radius = rbdi_sqrt(rbdi_set(RBD_C(1)) - x);
    rbdi_sincos(rbdi_draw(seed, -RBDI_PI(rbd_const), RBDI_PI(rbd_const)), &s, &c);
    q[2] = radius * s;
    q[3] = radius * c;
}

/* Random coordinates of one joint: within its limits, or angles in [-pi, pi), lengths in [-1, 1) and uniform
   orientations. */
RBDI_COLD void rbdi_random_joint(const rbdi_frame *u, uint64_t *seed, rbd_real *q) {
    const rbd_const pi = RBDI_PI(rbd_const), one = RBD_C(1);
    const int numbers = u->nq - (rbdi_has_quaternion(u->type) ? 4 : 0);
    if (u->nv == 1 && u->lower < u->upper) {
        q[0] = rbdi_draw(seed, u->lower, u->upper);
        return;
    }

    for (int k = 0; k < numbers && k < u->nv; ++k)
        q[k] = rbdi_is_length(u->type, k) ? rbdi_draw(seed, -one, one) : rbdi_draw(seed, -pi, pi);

    if (u->type == RBD_CONTINUOUS_CS) {
        const rbd_real angle = q[0];
        rbdi_sincos(angle, &q[1], &q[0]);
    }
    if (rbdi_has_quaternion(u->type)) rbdi_draw_quaternion(seed, q + u->nq - 4);
}

RBDI_API rbd_status rbd_random(const rbd_model *m, uint64_t *seed, rbd_real *q) {
    if (!m || !seed || !q) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_random_joint(u, seed, &q[u->iq]);
    }
    return RBD_OK;
}

/* ==== src/motion/step.h ==== */
/* Interface: rbdi_motion_of_point, rbdi_move_joints, rbdi_straight_acceleration, rbdi_straight_point,
   rbdi_turn_back, RBDI_CENTRES, RBDI_ORIGINS */

/* ---- steps of joints [straight moves] ----
   A body that floats, or moves on a plane, has a point that moves straight while the body turns: with the
   velocity V = (omega; v) of its origin, the point c of the body has v + omega x c, and after dt

       q_next   turned by dt omega, with c moved by dt (v + omega x c)
       v_next   the world velocities of c and of the turn, in the axes of q_next

   rbd_step moves the origin straight, c = 0. Steps of second order move the centre of mass: as nothing
   accelerates it in free flight, linear momentum of a body stays to rounding, and no result depends on where
   the origin is in the body. */

/* Which points of bodies move straight. */
enum { RBDI_ORIGINS, RBDI_CENTRES };

/* That point in body axes: the centre of mass of the link, with the masses that regrouping moved to it. It
   counts only for joints that turn freely. u: the frame of a body with dofs of its own. */
RBDI_INLINE rbdi_v3 rbdi_straight_point(const rbd_model *m, const rbdi_frame *u, int points) {
    const rbdi_link *l;
    rbd_real inverse;
    if (points == RBDI_ORIGINS) return rbdi_vec0();
    l = &m->link[u->link];
    if (!(l->mass > 0)) return rbdi_vec0();

    /* E (h / mass - r) */
    inverse = rbdi_set(1 / l->mass);
    return rbdi_mul(rbdi_mat_c(u->E), rbdi_sub(rbdi_scale(inverse, rbdi_vec_c(l->h)), rbdi_vec_c(u->r)));
}

/* The motion of the body's point c in place of that of its origin, and back with -c. */
RBDI_INLINE rbdi_motion rbdi_motion_of_point(rbdi_motion V, rbdi_v3 c) {
    V.v = rbdi_add(V.v, rbdi_cross(V.omega, c));
    return V;
}

/* The vector r turned by -turn: r - A turn x r + B turn x (turn x r). */
RBDI_LOCAL rbdi_v3 rbdi_turn_back(rbdi_exp e, rbdi_v3 turn, rbdi_v3 r) {
    const rbdi_v3 across = rbdi_cross(turn, r);
    const rbdi_v3 inward = rbdi_cross(turn, across);
    r = rbdi_sub(r, rbdi_scale((e.half_sine + e.half_sine) * e.half_cosine, across));
    return rbdi_add(r, rbdi_scale(e.B, inward));
}

/* Moves one joint that turns: q by `moved` for dt with its point c straight, and nu to the axes of the end.
   With turn = dt omega and exp(turn) c = c + S, S the shift of a screw (turn; turn x c), the origin moves by

       dt v + turn x c - S */
RBDI_LOCAL void rbdi_move_turning(const rbdi_frame *u, rbdi_v3 c, const rbd_real *q, const rbd_real *moved,
                                  const rbd_real *nu, rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    const rbdi_motion V = rbdi_joint_motion(u, moved, 1);
    const rbdi_v3 turn = rbdi_scale(dt, V.omega), across = rbdi_cross(turn, c);
    const rbdi_exp e = rbdi_exp_of(turn);
    const rbdi_v3 shift = rbdi_sub(across, rbdi_exp_shift(e, turn, across));
    rbdi_motion end = rbdi_motion_of_point(rbdi_joint_motion(u, nu, 1), c);

    rbdi_turn_joint(u, q, e, turn, rbdi_add(rbdi_scale(dt, V.v), shift), q_next);

    end.omega = rbdi_turn_back(e, turn, end.omega);
    end.v = rbdi_turn_back(e, turn, end.v);
    rbdi_put_joint_motion(u, rbdi_motion_of_point(end, rbdi_sub(rbdi_vec0(), c)), v_next, 1);
}

/* Moves all joints, for a scheme of its own: q by `moved` for dt, and nu to the axes of the end. points:
   RBDI_ORIGINS or RBDI_CENTRES move straight. An output may be the input of its name. */
RBDI_PART void rbdi_move_joints(const rbd_model *m, int points, const rbd_real *q, const rbd_real *moved,
                                const rbd_real *nu, rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        if (u->nv == 1 && u->nq == 1) { /* the most */
            q_next[u->iq] = q[u->iq] + moved[u->iv] * dt;
            v_next[u->iv] = nu[u->iv];
        } else if (rbdi_joint_turns(u)) {
            rbdi_move_turning(u, rbdi_straight_point(m, u, points), &q[u->iq], &moved[u->iv], &nu[u->iv], dt,
                              &q_next[u->iq], &v_next[u->iv]);
        } else if (u->nv > 0) {
            rbd_real d[6];
            for (int k = 0; k < u->nv; ++k) d[k] = moved[u->iv + k] * dt;
            for (int k = u->iv; k < u->iv + u->nv; ++k) v_next[k] = nu[k];
            rbdi_step_joint(u, &q[u->iq], d, &q_next[u->iq]);
        }
    }
}

/* a by which these points move straight and turns keep their axis: the linear part is
   (v + omega x c) x omega, all else 0. a: 0 before, but where this call writes. */
RBDI_PART void rbdi_straight_acceleration(const rbd_model *m, int points, const rbd_real *v, rbd_real *a) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        rbdi_motion V;
        if (!rbdi_joint_turns(u)) continue;
        V = rbdi_motion_of_point(rbdi_joint_motion(u, &v[u->iv], 1), rbdi_straight_point(m, u, points));
        V.v = rbdi_cross(V.v, V.omega);
        V.omega = rbdi_vec0();
        rbdi_put_joint_motion(u, V, &a[u->iv], 1);
    }
}

/* v of one joint after dt if a is 0, in the axes of the step's beginning: linear velocities in body axes
   gain dt omega x v, the others stay. */
RBDI_LOCAL void rbdi_unforced_velocity(const rbdi_frame *u, const rbd_real *v, rbd_real dt, rbd_real *nu) {
    rbdi_motion V;
    for (int k = 0; k < u->nv; ++k) nu[k] = v[k];
    if (!rbdi_joint_turns(u)) return;
    V = rbdi_joint_motion(u, v, 1);
    V.v = rbdi_add(V.v, rbdi_scale(dt, rbdi_cross(V.omega, V.v)));
    rbdi_put_joint_motion(u, V, nu, 1);
}

RBDI_API rbd_status rbd_step(const rbd_model *m, const rbd_real *q, const rbd_real *v, const rbd_real *a,
                             rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    if (!m || !q || !v || !a || !q_next || !v_next) return RBD_ERR_NULL;

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real nu[6];
        if (u->nv == 0) continue;
        rbdi_unforced_velocity(u, &v[u->iv], dt, nu);
        for (int k = 0; k < u->nv; ++k) v_next[u->iv + k] = nu[k] + dt * a[u->iv + k];
    }
    rbdi_move_joints(m, RBDI_ORIGINS, q, v_next, v_next, dt, q_next, v_next);
    return RBD_OK;
}

/* ==== src/motion/free_step.h ==== */
/* Interface: rbdi_guard_solution */

/* ---- free step [free step] ----
   Half of the way by v, to q_mid, where v_mid is v in its axes. There, with damping d, K = M + dt d and the
   accelerations a(w) of [straight moves],

       nu = v_mid + K^-1 dt (tau - c(w) - d v_mid),   c(w) = ID(q_mid, w, a(w)),   w = (v_mid + nu) / 2

   by three solutions, the first with w = v_mid; then the other half by nu. For a vector that turns by x in a
   step, the square of the length is magnified by 1 + x^2 with one solution, by 1 + x^4/4 with two, by
   1 - x^4/4 + x^6/16 with three: the least number that is stable, up to x = 2. Near that and beyond, where
   the solutions diverge, see rbdi_guard_solution. */

#ifndef RBD_NO_CHOLESKY
/* Of three solutions y = L^-T K (nu - v_mid), K = L'DL, changes the third if the second change is large
   beside the first, measured by D^-1, which makes it twice a kinetic energy:

       y_3 -= t s (y_3 - y_1),   s = r / (1 + r),   r = |y_3 - y_2|^2 / |y_2 - y_1|^2

   If the changes are a series of one frequency, with the ratio i x/2, then r = x^2/4, and with t = 1 that is
   its sum: the implicit midpoint, which keeps energy at any x. Where several frequencies act on each other
   the sum may make energy, and three solutions take some up to x = 2. So t grows from 0 at r = 1/2 to 1 at
   r = 1, without a jump: of one frequency each such mean of both takes energy or keeps it. */
RBDI_PART void rbdi_guard_solution(const rbd_model *m, const rbd_real *L, const rbd_real *first,
                                   const rbd_real *second, rbd_real *third) {
    const rbd_real one = rbdi_set(RBD_C(1));
    rbd_real before = rbdi_zero(), after = before, t, kept;
    rbdi_mask grows;
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real inverse = L[m->dof[k].row + m->dof[k].depth], old = second[k] - first[k],
                       change = third[k] - second[k];
        before = before + old * old * inverse;
        after = after + change * change * inverse;
    }

    grows = rbdi_less(before, after + after);
    if (!rbdi_any(grows)) return;

    /* t = 2 r - 1, at most 1 */
    t = (after + after) / before - one;
    t = rbdi_select(rbdi_less(one, t), one, t);

    /* y_3 = y_1 + (1 - t s) (y_3 - y_1): without a difference of large numbers where r is large */
    kept = (before + (one - t) * after) / (before + after);
    for (int k = 0; k < m->nv; ++k)
        third[k] = rbdi_select(grows, first[k] + kept * (third[k] - first[k]), third[k]);
}

/* Columns of w->F, behind the scratch of a solution: three solutions, velocities, and accelerations. */
RBDI_LOCAL rbd_real *rbdi_free_vector(const rbd_model *m, rbd_work *w, int k) {
    return w->F + (1 + k) * rbdi_stride(m);
}

/* y = L^-T dt (tau - c(at) - d v_mid). */
RBDI_LOCAL void rbdi_free_solution(const rbd_model *m, rbd_work *w, const rbd_real *v_mid, const rbd_real *at,
                                   const rbd_real *tau, const rbd_real *f_ext, const rbd_real *damping,
                                   rbd_real dt, rbd_real *y) {
    rbd_real *a = rbdi_free_vector(m, w, 4);
    rbdi_clear(a, m->nv);
    rbdi_straight_acceleration(m, RBDI_CENTRES, at, a);
    rbdi_rnea(m, w, rbdi_expand_v(m, at, w->vx), rbdi_expand_v(m, a, w->ax), f_ext,
              rbdi_mimics(m) ? w->tx : y);
    rbdi_reduce_tau(m, w->tx, y);
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real d = damping ? damping[k] : rbdi_zero();
        y[k] = dt * (tau[k] - y[k] - d * v_mid[k]);
    }
    rbdi_vector_transposed(m, w, w->H, y);
}

/* x = nu - v_mid, by three solutions. */
RBDI_LOCAL void rbdi_free_change(const rbd_model *m, rbd_work *w, const rbd_real *v_mid, const rbd_real *tau,
                                 const rbd_real *f_ext, const rbd_real *damping, rbd_real dt, rbd_real *x) {
    const rbd_real half = rbdi_set(RBD_C(0.5));
    rbd_real *at = rbdi_free_vector(m, w, 3);
    rbdi_clear(x, m->nv);
    for (int i = 0; i < 3; ++i) {
        rbd_real *y = rbdi_free_vector(m, w, i);
        for (int k = 0; k < m->nv; ++k) at[k] = v_mid[k] + half * x[k];
        rbdi_free_solution(m, w, v_mid, at, tau, f_ext, damping, dt, y);
        if (i == 2) rbdi_guard_solution(m, w->H, rbdi_free_vector(m, w, 0), rbdi_free_vector(m, w, 1), y);
        for (int k = 0; k < m->nv; ++k) x[k] = y[k];
        rbdi_vector_forward(m, w, w->H, x);
    }
}

/* Whether the changes x of the velocities are numbers below RBDI_FASTEST. In lanes where one is not, x
   becomes 0. */
RBDI_LOCAL int rbdi_bound_change(const rbd_model *m, rbd_real *x) {
    const rbd_real fastest = rbdi_set(RBDI_FASTEST);
    rbdi_mask good = rbdi_less(rbdi_zero(), fastest);
    for (int k = 0; k < m->nv; ++k) good = rbdi_and(good, rbdi_less(rbdi_abs(x[k]), fastest));

    for (int k = 0; k < m->nv; ++k) x[k] = rbdi_select(good, x[k], rbdi_zero());
    return !rbdi_any(rbdi_not(good));
}

RBDI_API rbd_status rbd_free_step(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                  const rbd_real *tau, const rbd_real *f_ext, const rbd_real *damping,
                                  rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    const rbd_real half = dt * RBD_C(0.5);
    rbd_real *nu;
    rbdi_mask doubt;
    rbd_status status = rbdi_check_dynamics(m, w, q && v && tau && q_next && v_next);
    if (status) return status;

    /* q_mid and v_mid, and K there */
    rbdi_move_joints(m, RBDI_CENTRES, q, v, v, half, q_next, v_next);
    rbd_crba_packed(m, w, q_next, w->H);
    if (damping) {
        for (int k = 0; k < m->nv; ++k) {
            rbd_real *diagonal = &w->H[m->dof[k].row + m->dof[k].depth];
            *diagonal = *diagonal + dt * damping[k];
        }
    }

    doubt = rbdi_factor(m, w, w->H);

    nu = w->bias;
    rbdi_free_change(m, w, v_next, tau, f_ext, damping, dt, nu);
    status = rbdi_factor_status(m, w, w->H, doubt, nu, m->nv);
    if (!rbdi_bound_change(m, nu) && !status) status = RBD_ERR_NAN;
    for (int k = 0; k < m->nv; ++k) nu[k] = v_next[k] + nu[k];

    rbdi_move_joints(m, RBDI_CENTRES, q_next, nu, nu, half, q_next, v_next);
    return status;
}
#endif

/* ==== src/model/work_init.h ==== */
/* ---- work [work code] ---- */

RBDI_API size_t rbd_work_size(const rbd_model *m) {
    if (!m) return 0;
    return RBDI_WORK_BYTES(m->nl, m->nblock, m->nbranch, m->nv + m->nmimic, m->nmimic ? m->nq + m->nmimic : 0,
                           m->nv, m->nh + m->nhx);
}

#if RBDI_REPRODUCIBLE
/* Whether products, sums and roots are rounded one by one and to nearest, and denormals are numbers.
   1 - x low finds libgcc's double sums on ARMv7-M: they are wrong if one exponent is 33 above the other and
   that of the result is lower. The root of 1 + 3 eps is 1 + 3/2 eps - 9/8 eps^2: one that is rounded to 80
   bits before loses the last term, and then is 1 + 2 eps. */
RBDI_COLD int rbdi_rounds(void) {
    const volatile RBD_REAL given[5] = {1, RBDI_EPS, 1 + RBDI_EPS, 1 + 2 * RBDI_EPS, RBDI_TINY};
    const RBD_REAL one = given[0], e = given[1], x = given[2], square = given[3], tiny = given[4];
    const volatile RBD_REAL half = tiny * (RBD_REAL)0.5, low = e * 524288 /* double: 2^-33 */;
    const volatile RBD_REAL root = RBD_SQRT(one + 3 * e);
    return root == x && x * x - square == 0 && one + e * (RBD_REAL)0.75 == x &&
           one + e * (RBD_REAL)0.25 == one && half > 0 && half + half == tiny && one - x * low == one - low;
}
#endif

RBDI_API rbd_status rbd_work_init(const rbd_model *m, void *memory, size_t size, rbd_work **work) {
    unsigned char *p;
    rbd_work *w;
    int n, nqx;

    if (work) *work = NULL;
    if (!m || !memory || !work) return RBD_ERR_NULL;
    if (m->version != RBD_MODEL_VERSION || m->scalar != (int)sizeof(rbd_const)) return RBD_ERR_VERSION;
    if (!rbdi_supported(m)) return RBD_ERR_LEFT_OUT;
#if RBDI_REPRODUCIBLE
    if (!rbdi_rounds()) return RBD_ERR_ARITHMETIC;
#endif
    if (size < rbd_work_size(m)) return RBD_ERR_MEMORY;

    n = m->nv + m->nmimic;
    nqx = m->nmimic ? m->nq + m->nmimic : 0;

    p = rbdi_aligned(memory);
    w = (rbd_work *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_work)));
    for (int k = 0; k < RBDI_SHAPE; ++k) w->shape[k] = m->shape[k];
    w->gravity = m->gravity;
    rbdi_require_ieee();
    w->singular = rbdi_massless_dof(m);
    w->kinematics_of = RBDI_NO_KINEMATICS;
#define RBDI_TAKE(type, name, length) w->name = (type *)rbdi_take(&p, (int)(length), sizeof(type));
    RBDI_WORK_ARRAYS(RBDI_TAKE, m->nl, m->nblock, m->nbranch, n, nqx, m->nv, m->nh + m->nhx)
#undef RBDI_TAKE

    for (int k = 0; k < n; ++k) w->zero[k] = rbdi_zero();
    for (int k = 0; k < 6 * RBDI_STRIDE(n); ++k) w->F[k] = rbdi_zero();
    for (int k = 0; k < (int)RBDI_PADDED(m->nl); ++k) w->angle[k] = w->quarters[k] = rbdi_zero();
    w->F += RBDI_CHUNK;
    *work = w;
    return RBD_OK;
}

RBDI_API rbd_status rbd_set_gravity(rbd_work *w, const rbd_const gravity[3]) {
    if (!w || !gravity) return RBD_ERR_NULL;
    w->gravity.x = gravity[0];
    w->gravity.y = gravity[1];
    w->gravity.z = gravity[2];
    return RBD_OK;
}

RBDI_API rbd_status rbd_get_gravity(const rbd_work *w, rbd_const gravity[3]) {
    if (!w || !gravity) return RBD_ERR_NULL;
    gravity[0] = w->gravity.x;
    gravity[1] = w->gravity.y;
    gravity[2] = w->gravity.z;
    return RBD_OK;
}

/* ==== src/model/lookup.h ==== */
/* ---- lookup [lookup code] ---- */

RBDI_API int rbd_nb(const rbd_model *m) { return m ? m->nb : 0; }
RBDI_API int rbd_nq(const rbd_model *m) { return m ? m->nq : 0; }
RBDI_API int rbd_nv(const rbd_model *m) { return m ? m->nv : 0; }

RBDI_API int rbd_body_index(const rbd_model *m, const char *name) {
    for (int b = 0; b < rbd_nb(m); ++b)
        if (rbdi_same(m->frame[b].name, name)) return b;
    return -1;
}

RBDI_API int rbd_joint_index(const rbd_model *m, const char *name) {
    for (int b = 0; b < rbd_nb(m); ++b)
        if (rbdi_same(m->frame[b].joint, name)) return b;
    return -1;
}

RBDI_API const char *rbd_body_name(const rbd_model *m, int body) {
    return m && body >= 0 && body < m->nb ? m->frame[body].name : NULL;
}

RBDI_API const char *rbd_joint_name(const rbd_model *m, int body) {
    return m && body >= 0 && body < m->nb ? m->frame[body].joint : NULL;
}

RBDI_API rbd_status rbd_joint(const rbd_model *m, int body, rbd_joint_info *info) {
    const rbdi_frame *u;
    if (!m || !info) return RBD_ERR_NULL;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    u = &m->frame[body];
    info->type = (rbd_joint_type)u->type;
    info->nq = u->nq;
    info->nv = u->nv;
    info->iq = u->nv > 0 ? u->iq : -1;
    info->iv = u->nv > 0 ? u->iv : -1;
    info->lower = u->lower;
    info->upper = u->upper;
    info->velocity = u->velocity;
    info->effort = u->effort;
    return RBD_OK;
}

RBDI_API int rbd_dof_body(const rbd_model *m, int dof) {
    return m && dof >= 0 && dof < m->nv ? m->dof[dof].body : -1;
}

/* ==== src/model/text.h ==== */
/* Interface: rbdi_write_finding */

/* ---- text [text code] ---- */

RBDI_MESSAGES RBDI_API const char *rbd_status_string(rbd_status status) {
    switch (status) {
    case RBD_OK: return "no error";
    case RBD_ERR_NULL: return "a required pointer is NULL, as a work or set is until its _init succeeds";
    case RBD_ERR_MEMORY:
        return "the memory given is too small: rbd_model_size, rbd_work_size or another _size has the figure";
    case RBD_ERR_VERSION: return "the built model is of another version or scalar than this rbd.h";
    case RBD_ERR_INDEX: return "no such body";
    case RBD_ERR_ORDER: return "rbd_kinematics must be called first";
    case RBD_ERR_SINGULAR: return "the mass matrix is singular";
    case RBD_ERR_COUNT: return "the number of bodies, or of constraints, is out of range";
    case RBD_ERR_NAME: return "the name stands twice";
    case RBD_ERR_PARENT: return "not the index of an earlier body, nor -1 for the world";
    case RBD_ERR_TYPE: return "unknown joint type, or missing";
    case RBD_ERR_AXIS: return "zero or not finite; axis2 of a universal joint also if parallel to axis";
    case RBD_ERR_PITCH: return "not finite";
    case RBD_ERR_POSITION: return "not finite";
    case RBD_ERR_ROTATION: return "not finite, or not an orthonormal right-handed matrix";
    case RBD_ERR_MASS: return "negative or not finite";
    case RBD_ERR_COM: return "not finite";
    case RBD_ERR_INERTIA: return "not finite";
    case RBD_ERR_LEAF:
        return "a movable leaf needs mass, inertia or armature: forward dynamics would be singular";
    case RBD_ERR_ARMATURE:
    case RBD_ERR_DAMPING:
    case RBD_ERR_FRICTION: return "negative or not finite";
    case RBD_ERR_LIMITS: return "not a number, or a negative limit";
    case RBD_ERR_MIMIC:
        return "ratio 0 or not finite, offset not finite, not a one-dof joint, or it follows one that is "
               "missing or mimics too";
    case RBD_ERR_WORK: return "made for another model or another work";
    case RBD_ERR_NAN: return "NaN in q (rbd_singular_dof says where), v, a force or a gap; or overflow";
    case RBD_ERR_RANGE: return "negative, not finite or out of range";
    case RBD_ERR_INFEASIBLE: return "the constraints contradict each other";
    case RBD_ERR_ARITHMETIC:
        return "RBD_REPRODUCIBLE: results are contracted, rounded twice or not to nearest, or denormals are "
               "0";
    case RBD_ERR_MASSLESS: return "dynamics needs masses, a joint moves none: rbd_singular_dof says which";
    case RBD_ERR_LEFT_OUT: return "the model needs code that RBD_FEATURES or RBD_NO_CHOLESKY leave out";
    case RBD_WARN_INERTIA_NEGATIVE: return "has a negative principal moment: no real body is like this";
    case RBD_WARN_INERTIA_TRIANGLE:
        return "one principal moment exceeds the sum of the others: no real body is like this";
    case RBD_WARN_INERTIA_ZERO: return "zero for a body with mass: no real body is like this";
    case RBD_WARN_MASS_ZERO: return "zero for a body with inertia: no real body is like this";
    case RBD_WARN_LIMITS: return "limits that mean none: not below upper, or of a joint that has no limits";
    }
    return "unknown status";
}

/* Writes a finding as a sentence; what: the word for a row of the description. */
RBDI_LOCAL char *rbdi_write_finding(const rbd_finding *finding, const char *what, char *text, size_t size) {
    const char *piece[12];
    char digits[12];
    int n = 0;
    if (!finding || !text || size == 0) return text;

    if (finding->body >= 0) {
        piece[n++] = what;
        piece[n++] = " ";
        piece[n++] = rbdi_decimal(finding->body, digits);

        if (finding->name) {
            piece[n++] = " '";
            piece[n++] = finding->name;
            piece[n++] = "'";
        }
        piece[n++] = ", ";
    }

    if (finding->field) {
        piece[n++] = "field '";
        piece[n++] = finding->field;
        piece[n++] = "': ";
    }

    piece[n++] = finding->text ? finding->text : rbd_status_string(finding->status);
    return rbdi_join(piece, n, text, size);
}

RBDI_API char *rbd_finding_text(const rbd_finding *finding, char *text, size_t size) {
    return rbdi_write_finding(finding, "body", text, size);
}

/* ==== src/rbd.h ==== */
RBDI_CODE_END
RBDI_BUILD_BEGIN

/* ==== src/model/wide.h ==== */
/* Interface: rbdi_all_zero, rbdi_finite, rbdi_finite_positive, rbdi_is_rotation, rbdi_orthonormalise,
   rbdi_refuse, rbdi_refuse_saying, rbdi_semidefinite, rbdi_unit, rbdi_w_apply, rbdi_w_basis, rbdi_w_identity,
   rbdi_w_product, rbdi_w_transpose, rbdi_widen */

/* ---- descriptions [descriptions] ----
   To read a description, here and in other headers: checks, and algebra in the build's arithmetic (w_). */

#include <math.h>

#if RBDI_KIND(RBDI_WIDE) == 3
#define RBDI_WIDE_LIBM(name) name##q
#elif RBDI_KIND(RBDI_WIDE) == 2
#define RBDI_WIDE_LIBM(name) name##f
#else
#define RBDI_WIDE_LIBM(name) name
#endif

RBDI_PART void rbdi_widen(const double *x, int n, rbdi_wide *y) {
    for (int k = 0; k < n; ++k) y[k] = (rbdi_wide)x[k];
}

RBDI_PART void rbdi_w_identity(rbdi_wide A[9]) {
    for (int k = 0; k < 9; ++k) A[k] = k % 4 == 0;
}

RBDI_PART void rbdi_w_apply(const rbdi_wide A[9], const rbdi_wide x[3], rbdi_wide y[3]) {
    rbdi_wide z[3];
    for (int i = 0; i < 3; ++i) z[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
    for (int i = 0; i < 3; ++i) y[i] = z[i];
}

RBDI_PART void rbdi_w_transpose(const rbdi_wide A[9], rbdi_wide B[9]) {
    for (int i = 0; i < 9; ++i) B[i] = A[i % 3 * 3 + i / 3];
}

/* AB may be A or B. */
RBDI_PART void rbdi_w_product(const rbdi_wide A[9], const rbdi_wide B[9], rbdi_wide AB[9]) {
    rbdi_wide C[9];
    for (int i = 0; i < 9; ++i)
        C[i] = A[i / 3 * 3] * B[i % 3] + A[i / 3 * 3 + 1] * B[i % 3 + 3] + A[i / 3 * 3 + 2] * B[i % 3 + 6];
    for (int i = 0; i < 9; ++i) AB[i] = C[i];
}

RBDI_PART void rbdi_w_turn_z(rbdi_wide c, rbdi_wide s, rbdi_wide A[9]) {
    rbdi_w_identity(A);
    A[0] = c;
    A[1] = s;
    A[3] = -s;
    A[4] = c;
}

RBDI_PART void rbdi_w_turn_x(rbdi_wide c, rbdi_wide s, rbdi_wide A[9]) {
    rbdi_w_identity(A);
    A[4] = c;
    A[5] = s;
    A[7] = -s;
    A[8] = c;
}

/* E = Rz(gamma) Rx(alpha) Rz(beta) from the cosines and sines. */
RBDI_PART void rbdi_w_zxz(rbdi_wide cg, rbdi_wide sg, rbdi_wide ca, rbdi_wide sa, rbdi_wide cb, rbdi_wide sb,
                          rbdi_wide E[9]) {
    rbdi_wide turn[9];
    rbdi_w_turn_z(cg, sg, E);
    rbdi_w_turn_x(ca, sa, turn);
    rbdi_w_product(E, turn, E);
    rbdi_w_turn_z(cb, sb, turn);
    rbdi_w_product(E, turn, E);
}

/* Pose of C in A, from that of C in B and of B in A. */
RBDI_PART rbdi_wide_pose rbdi_w_compose(const rbdi_wide_pose *CB, const rbdi_wide_pose *BA) {
    rbdi_wide_pose X;
    rbdi_wide T[9];
    rbdi_w_transpose(BA->E, T);
    rbdi_w_product(CB->E, BA->E, X.E);
    rbdi_w_apply(T, CB->r, X.r);
    for (int k = 0; k < 3; ++k) X.r[k] += BA->r[k];
    return X;
}

/* Pose of C in B, from those of both in A. */
RBDI_PART rbdi_wide_pose rbdi_w_relative(const rbdi_wide_pose *CA, const rbdi_wide_pose *BA) {
    rbdi_wide_pose X;
    rbdi_wide T[9];
    rbdi_w_transpose(BA->E, T);
    rbdi_w_product(CA->E, T, X.E);
    for (int k = 0; k < 3; ++k) X.r[k] = CA->r[k] - BA->r[k];
    rbdi_w_apply(BA->E, X.r, X.r);
    return X;
}

RBDI_PART rbdi_wide rbdi_w_dot(const rbdi_wide a[3], const rbdi_wide b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

RBDI_PART rbdi_wide rbdi_w_abs(rbdi_wide x) { return x < 0 ? -x : x; }
RBDI_PART rbdi_wide rbdi_w_length(const rbdi_wide a[3]) {
    return RBDI_WIDE_LIBM(rbdi_root)(rbdi_w_dot(a, a));
}

/* Whether n numbers are finite, in the model's scalar too. */
RBDI_PART int rbdi_finite(const double *x, int n) {
    for (int k = 0; k < n; ++k) { /* by bits, which is right with -ffinite-math-only too */
        union {
            double x;
            uint64_t bits;
        } u;
        u.x = (double)RBD_C(x[k]);
        if ((u.bits >> 52 & 0x7ff) == 0x7ff) return 0;
    }

    return 1;
}

RBDI_PART int rbdi_finite_positive(const double *x, int n) {
    for (int k = 0; k < n; ++k)
        if (!rbdi_finite(&x[k], 1) || x[k] < 0) return 0;
    return 1;
}

RBDI_PART int rbdi_all_zero(const double *x, int n) {
    for (int k = 0; k < n; ++k)
        if ((rbdi_wide)x[k] < 0 || (rbdi_wide)x[k] > 0) return 0;
    return 1;
}

/* y = x scaled to unit length, of any length but 0: by the largest component first, so that nothing
   overflows. */
RBDI_PART void rbdi_unit(const rbdi_wide x[3], rbdi_wide y[3]) {
    rbdi_wide largest = 0, length;
    for (int k = 0; k < 3; ++k)
        if (rbdi_w_abs(x[k]) > largest) largest = rbdi_w_abs(x[k]);
    for (int k = 0; k < 3; ++k) y[k] = x[k] / largest;
    length = rbdi_w_length(y);
    for (int k = 0; k < 3; ++k) y[k] /= length;
}

/* Axes, the rows of E, with this unit vector for z. */
RBDI_PART void rbdi_w_basis(const rbdi_wide z[3], rbdi_wide E[9]) {
    rbdi_wide length;
    int least = 0;
    for (int k = 1; k < 3; ++k)
        if (rbdi_w_abs(z[k]) < rbdi_w_abs(z[least])) least = k;

    /* x: the unit vector that is farthest from z, less its part along z; y = z x x */
    for (int k = 0; k < 3; ++k) E[k] = (k == least) - z[least] * z[k];
    length = rbdi_w_length(E);
    for (int k = 0; k < 3; ++k) {
        E[k] /= length;
        E[6 + k] = z[k];
    }
    for (int k = 0; k < 3; ++k) E[3 + k] = z[(k + 1) % 3] * E[(k + 2) % 3] - z[(k + 2) % 3] * E[(k + 1) % 3];
}

/* Makes a nearly orthonormal matrix orthonormal, rows first to last (Gram and Schmidt). An exact one
   stays. */
RBDI_PART void rbdi_orthonormalise(rbdi_wide R[9]) {
    rbdi_wide along;
    rbdi_unit(&R[0], &R[0]);
    along = rbdi_w_dot(&R[0], &R[3]);
    for (int k = 0; k < 3; ++k) R[3 + k] -= along * R[k];
    rbdi_unit(&R[3], &R[3]);
    for (int k = 0; k < 3; ++k)
        R[6 + k] = R[(k + 1) % 3] * R[3 + (k + 2) % 3] - R[(k + 2) % 3] * R[3 + (k + 1) % 3];
}

/* Whether a matrix is a rotation, or 0, which stands for the identity. */
RBDI_PART int rbdi_is_rotation(const double R[9]) {
    rbdi_wide A[9], T[9], product[9];
    if (!rbdi_finite(R, 9)) return 0;
    if (rbdi_all_zero(R, 9)) return 1;

    rbdi_widen(R, 9, A);
    rbdi_w_transpose(A, T);
    rbdi_w_product(A, T, product);
    for (int k = 0; k < 9; ++k)
        if (!(rbdi_w_abs(product[k] - (k % 4 == 0)) < (rbdi_wide)RBDI_ORTHONORMAL)) return 0;
    return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
               A[2] * (A[3] * A[7] - A[4] * A[6]) >
           0;
}

/* Whether no eigenvalue of the symmetric matrix (xx xy xz yy yz zz) is below -RBDI_SEMIDEFINITE size: by the
   pivots of Gauss of the matrix with RBDI_SEMIDEFINITE size on the diagonal added. */
RBDI_PART int rbdi_semidefinite(const double A[6], double size) {
    const double added = RBDI_SEMIDEFINITE * size, xx = A[0] + added, yy = A[3] + added - A[1] / xx * A[1],
                 yz = A[4] - A[1] / xx * A[2];
    if (!(xx > 0) || !(yy > 0)) return 0;
    return A[5] + added - A[2] / xx * A[2] - yz * yz / yy > 0;
}

/* Makes this the error of a report. Returns the status. */
RBDI_PART rbd_status rbdi_refuse(rbd_report *report, rbd_status status, int body, const char *name,
                                 const char *field) {
    rbd_finding *f = &report->error;
    f->status = status;
    f->body = body;
    f->name = name;
    f->field = field;
    f->text = NULL;
    return status;
}

/* The same, with a sentence in place of the status's. */
RBDI_PART rbd_status rbdi_refuse_saying(rbd_report *report, rbd_status status, int body, const char *name,
                                        const char *field, const char *sentence) {
    rbdi_refuse(report, status, body, name, field);
    report->error.text = sentence;
    return status;
}

/* ==== src/rbd.h ==== */
#ifndef RBD_NO_BUILD

/* ==== src/model/describe.h ==== */
/* How many axes the description of a joint has: none, axis, or axis and axis2. */
RBDI_PART int rbdi_described_axes(int type) {
    const char *axes = rbdi_joint_facts(type)->axes;
    return (rbdi_axis_name(axes[0]) == 'a') + (rbdi_axis_name(axes[1]) == 'b');
}

/* A pose of the model in the build's arithmetic. */
RBDI_PART rbdi_wide_pose rbdi_widen_pose(const rbd_const E[9], rbdi_c3 r) {
    rbdi_wide_pose X;
    for (int k = 0; k < 9; ++k) X.E[k] = (rbdi_wide)E[k];
    X.r[0] = (rbdi_wide)r.x;
    X.r[1] = (rbdi_wide)r.y;
    X.r[2] = (rbdi_wide)r.z;
    return X;
}

/* Pose of link l in its parent at q = 0. */
RBDI_PART rbdi_wide_pose rbdi_link_place(const rbd_model *m, const rbdi_link *l) {
    static const rbd_const none[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    rbdi_wide_pose X = rbdi_widen_pose(l->kind == RBDI_BLOCK ? rbdi_block_of(m, l)->E : none, l->r);
    if (l->kind == RBDI_BLOCK) return X;
    rbdi_w_zxz((rbdi_wide)l->cg, (rbdi_wide)l->sg, (rbdi_wide)l->ca, (rbdi_wide)l->sa, (rbdi_wide)l->cb,
               (rbdi_wide)l->sb, X.E);
    for (int k = 0; k < 3; ++k) X.r[k] += (rbdi_wide)l->d * X.E[6 + k];
    return X;
}

/* Writes the pose of a body's joint, its axes, which are the links' z, and its parent; returns its first
   dof. */
RBDI_LOCAL int rbdi_describe_joint(const rbd_model *m, int body, rbd_body *row) {
    const rbdi_frame *u = &m->frame[body];
    const int axes = rbdi_described_axes(u->type);
    rbdi_wide_pose X = rbdi_widen_pose(u->E, u->r), parent;
    rbdi_wide R[9], axis[3] = {0, 0, 0}, axis2[3] = {0, 0, 0};
    int i = u->link, dof = 0;

    for (; i >= 0 && m->dof[m->link[i].iv].body == body; i = m->link[i].parent) {
        for (int k = 0; k < 3; ++k) {
            axis2[k] = axis[k];
            axis[k] = X.E[3 * k + 2];
        }
        parent = rbdi_link_place(m, &m->link[i]);
        X = rbdi_w_compose(&X, &parent);
        dof = m->link[i].iv;
    }

    row->parent = -1;
    if (i >= 0) { /* from that link to the body whose joint moves it */
        row->parent = m->dof[m->link[i].iv].body;
        parent = rbdi_widen_pose(m->frame[row->parent].E, m->frame[row->parent].r);
        X = rbdi_w_relative(&X, &parent);
    }

    rbdi_w_transpose(X.E, R);
    for (int k = 0; k < 9; ++k) row->rotation[k] = (double)R[k];

    for (int k = 0; k < 3; ++k) {
        row->position[k] = (double)X.r[k];
        row->axis[k] = axes > 0 ? (double)axis[k] : 0;
        row->axis2[k] = axes > 1 ? (double)axis2[k] : 0;
    }

    row->pitch = u->type == RBD_HELICAL ? (double)m->link[u->link].kappa : 0;
    return dof;
}

RBDI_API rbd_status rbd_describe(const rbd_model *m, int body, rbd_body *row) {
    const rbdi_frame *u;
    const rbdi_dof *dof;
    int first;
    if (!m || !row) return RBD_ERR_NULL;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    u = &m->frame[body];
    row->name = u->name;
    row->joint = u->joint;
    row->type = (rbd_joint_type)u->type;
    first = rbdi_describe_joint(m, body, row);

    row->mass = (double)u->mass;
    row->com[0] = (double)u->com.x;
    row->com[1] = (double)u->com.y;
    row->com[2] = (double)u->com.z;
    row->inertia[0] = (double)u->I.xx;
    row->inertia[1] = (double)u->I.xy;
    row->inertia[2] = (double)u->I.xz;
    row->inertia[3] = (double)u->I.yy;
    row->inertia[4] = (double)u->I.yz;
    row->inertia[5] = (double)u->I.zz;

    row->lower = (double)u->lower;
    row->upper = (double)u->upper;
    row->velocity = (double)u->velocity;
    row->effort = (double)u->effort;

    row->mimic = NULL;
    row->mimic_ratio = row->mimic_offset = 0;
    if (u->type != RBD_FIXED && first >= m->nv) {
        const rbdi_mimic *mimic = &m->mimic[first - m->nv];
        row->mimic = m->frame[m->dof[mimic->source_v].body].joint;
        row->mimic_ratio = (double)mimic->ratio;
        row->mimic_offset = (double)mimic->offset;
    }

    dof = &m->dof[first];
    for (int k = 0; k < 6; ++k) {
        const int has = k < u->nv || (row->mimic && k == 0);
        row->armature[k] = has ? (double)dof[k].armature : 0;
        row->damping[k] = has ? (double)dof[k].damping : 0;
        row->friction[k] = has ? (double)dof[k].friction : 0;
    }

    return RBD_OK;
}

/* ==== src/model/check.h ==== */
/* ---- model build [model build] ----
   From the description to the model, in the caller's memory. Steps:
     checks   rbdi_check_body; after step 2 rbdi_check_moves: the first error ends the build
     1, 2     rbdi_build_joint, rbdi_build_mass: the links of each joint, in the user's frames; their moments
     3, 4     rbdi_build_axis: joint axis on z; rbdi_build_order: depth first, favourite child next
     5        rbdi_build_measure: mass and moments of each subtree
     6        rbdi_build_normalise: root to leaves, Denavit and Hartenberg's form where it loses no digit
     7, 8     rbdi_build_scale: bounds of the pivots; rbdi_build_regroup: leaves to root, base parameters
     9, 10    rbdi_emit_link, rbdi_emit_tree, called by rbdi_emit: constants, dofs, packed rows, frames */

/* -- small dense algebra of the build -- */

RBDI_LOCAL int rbdi_nonzero(rbdi_wide x) { return x < 0 || x > 0; }

/* Scales (c, s) to the unit circle, and moves it to the nearest right angle if one is as close as this,
   rad. */
RBDI_LOCAL void rbdi_w_snap(rbdi_wide *c, rbdi_wide *s, rbdi_wide close) {
    rbdi_wide length = RBDI_WIDE_LIBM(rbdi_root)(*c * *c + *s * *s);

    *c /= length;
    *s /= length;

    if (rbdi_w_abs(*s) <= close) {
        *c = *c > 0 ? 1 : -1;
        *s = 0;
    }

    if (rbdi_w_abs(*c) <= close) {
        *s = *s > 0 ? 1 : -1;
        *c = 0;
    }
}

/* Sine and cosine of an angle of at most 90 degrees, to 1e-29: sums of their series, which give the same bits
   everywhere. */
RBDI_LOCAL void rbdi_w_series(rbdi_wide x, rbdi_wide *sine, rbdi_wide *cosine) {
    const rbdi_wide x2 = x * x;
    rbdi_wide sum_c = 1, sum_s = 1;

    for (int k = RBDI_TAIL_TERMS; k > 0; --k) {
        sum_c = 1 - sum_c * x2 / (2 * k * (2 * k - 1));
        sum_s = 1 - sum_s * x2 / (2 * k * (2 * k + 1));
    }

    *sine = x * sum_s;
    *cosine = sum_c;
}

/* Angle, at most 45 degrees, from its cosine and sine: rbdi_signed_angle in the build's arithmetic. */
RBDI_LOCAL rbdi_wide rbdi_w_angle(rbdi_wide c, rbdi_wide s) {
    rbdi_wide sine = rbdi_w_abs(s), t = sine / (1 + c);
    rbdi_wide angle = t * (2 - (rbdi_wide)RBDI_ANGLE_START * t * t);

    for (int i = 0; i < 4; ++i) {
        rbdi_wide sine_of, cosine_of;
        rbdi_w_series(angle, &sine_of, &cosine_of);
        angle += sine * cosine_of - c * sine_of;
    }

    return s < 0 ? -angle : angle;
}

/* Adds moments of mass (Sigma, h, mass) to those of a link, in whose frame a point x is A x + t: h_new = A h
   + mass t, Sigma_new = A Sigma A' + t (A h)' + h_new t'. */
RBDI_LOCAL void rbdi_add_moments(rbdi_build_link *to, const rbdi_wide A[9], const rbdi_wide t[3],
                                 const rbdi_wide Sigma[6], const rbdi_wide h[3], rbdi_wide mass) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    rbdi_wide full[9], turned[9], Ah[3], T[9];

    for (int k = 0; k < 6; ++k) full[3 * row[k] + column[k]] = full[3 * column[k] + row[k]] = Sigma[k];
    rbdi_w_product(A, full, turned);
    rbdi_w_transpose(A, T);
    rbdi_w_product(turned, T, full);
    rbdi_w_apply(A, h, Ah);

    for (int k = 0; k < 6; ++k) {
        int i = row[k], j = column[k];
        to->Sigma[k] += full[3 * i + j] + t[i] * Ah[j] + (Ah[i] + mass * t[i]) * t[j];
    }

    for (int i = 0; i < 3; ++i) to->h[i] += Ah[i] + mass * t[i];
    to->mass += mass;
}

/* Changes a link's frame, and so its moments: the point x becomes A x + t. */
RBDI_LOCAL void rbdi_change_moments(rbdi_build_link *l, const rbdi_wide A[9], const rbdi_wide t[3]) {
    rbdi_build_link old = *l;
    for (int k = 0; k < 6; ++k) l->Sigma[k] = 0;
    for (int k = 0; k < 3; ++k) l->h[k] = 0;
    l->mass = 0;
    rbdi_add_moments(l, A, t, old.Sigma, old.h, old.mass);
}

/* -- the checks -- */

RBDI_LOCAL int rbdi_parallel(const double axis[3], const double axis2[3]) {
    rbdi_wide x[3], y[3], cross[3];
    rbdi_widen(axis, 3, x);
    rbdi_widen(axis2, 3, y);
    rbdi_unit(x, x);
    rbdi_unit(y, y);
    for (int k = 0; k < 3; ++k) cross[k] = x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3];
    return !(rbdi_w_length(cross) > RBDI_PARALLEL);
}

RBDI_LOCAL int rbdi_is_axis(const double axis[3]) { return rbdi_finite(axis, 3) && !rbdi_all_zero(axis, 3); }

RBDI_LOCAL void rbdi_warn_saying(rbd_report *report, rbd_status status, int body, const char *name,
                                 const char *field, const char *sentence) {
    if (report->warnings < RBD_MAX_WARNINGS) {
        rbd_finding *f = &report->warning[report->warnings];
        f->status = status;
        f->body = body;
        f->name = name;
        f->field = field;
        f->text = sentence;
    }

    ++report->warnings;
}

RBDI_LOCAL void rbdi_warn(rbd_report *report, rbd_status status, int body, const char *name,
                          const char *field) {
    rbdi_warn_saying(report, status, body, name, field, NULL);
}

/* Warns of an inertia that no real body has. I must be positive semi-definite, and so must Sigma = tr(I)/2 -
   I (the triangle inequalities of the principal moments). Dynamics computes with others too. */
RBDI_LOCAL void rbdi_check_inertia(const rbd_body *b, int i, rbd_report *report) {
    const double *I = b->inertia, trace = I[0] + I[3] + I[5];
    double size = 0, Sigma[6];

    for (int k = 0; k < 6; ++k) {
        size += I[k] < 0 ? -I[k] : I[k];
        Sigma[k] = (k == 0 || k == 3 || k == 5 ? trace / 2 : 0) - I[k];
    }

    if (!(size > 0)) {
        if (b->mass > 0) rbdi_warn(report, RBD_WARN_INERTIA_ZERO, i, b->name, "inertia");
        return;
    }

    if (!(b->mass > 0)) rbdi_warn(report, RBD_WARN_MASS_ZERO, i, b->name, "mass");
    if (!rbdi_semidefinite(I, size))
        rbdi_warn(report, RBD_WARN_INERTIA_NEGATIVE, i, b->name, "inertia");
    else if (!rbdi_semidefinite(Sigma, size))
        rbdi_warn(report, RBD_WARN_INERTIA_TRIANGLE, i, b->name, "inertia");
}

/* Whether a joint has limits as the model stores them: in float they may be equal. */
RBDI_LOCAL int rbdi_is_limited(const rbd_body *b) {
    return rbdi_has_limits((int)b->type) && RBD_C(b->lower) < RBD_C(b->upper);
}

/* Warns of limits that are set and mean none. */
RBDI_LOCAL void rbdi_check_limits(const rbd_body *b, int i, rbd_report *report) {
    const char *sentence = "not below upper: read as no limits";
    if (rbdi_all_zero(&b->lower, 1) && rbdi_all_zero(&b->upper, 1)) return;
    if (rbdi_is_limited(b)) return;

    if (b->lower < b->upper) sentence = "as near to upper as rounding: read as no limits";
    if (!rbdi_has_limits((int)b->type)) sentence = "limits of a joint whose type has none: read as none";
    rbdi_warn_saying(report, RBD_WARN_LIMITS, i, b->name, "lower", sentence);
}

/* A limit x of a body's joint as a limit of the joint that it mimics, if any: x = ratio q + offset. */
RBDI_LOCAL rbd_const rbdi_source_limit(const rbd_body *b, double x) {
    return b->mimic ? (RBD_C(x) - RBD_C(b->mimic_offset)) / RBD_C(b->mimic_ratio) : RBD_C(x);
}

/* Whether two joints with limits, of which one mimics the other or both mimic a third one, cannot both be
   within their limits. */
RBDI_LOCAL int rbdi_limits_contradict(const rbd_body *one, const rbd_body *two) {
    const rbd_body *of[2] = {one, two};
    rbd_const lower[2], upper[2];
    if (!rbdi_is_limited(one) || !rbdi_is_limited(two)) return 0;

    for (int k = 0; k < 2; ++k) {
        const int turned = of[k]->mimic && of[k]->mimic_ratio < 0;
        lower[k] = rbdi_source_limit(of[k], turned ? of[k]->upper : of[k]->lower);
        upper[k] = rbdi_source_limit(of[k], turned ? of[k]->lower : of[k]->upper);
    }

    return upper[0] < lower[1] || upper[1] < lower[0];
}

/* Warns of each joint that mimics another if its limits contradict those of that joint, or of a joint before
   it that mimics the same one. Ranges of one coordinate have a place in common if each two of them have. */
RBDI_LOCAL void rbdi_check_followers(const rbd_body *bodies, int nb, rbd_report *report) {
    for (int i = 0; i < nb; ++i) {
        const rbd_body *b = &bodies[i];
        int contradicts = 0;
        if (!b->mimic) continue;

        for (int j = 0; j < nb; ++j) {
            const int source = j != i && rbdi_same(bodies[j].joint, b->mimic);
            const int beside = j < i && rbdi_same(bodies[j].mimic, b->mimic);
            if (source || beside) contradicts |= rbdi_limits_contradict(b, &bodies[j]);
        }

        if (contradicts)
            rbdi_warn_saying(report, RBD_WARN_LIMITS, i, b->name, "lower",
                             "no place of the joint that it mimics is within the limits of all");
    }
}

/* Index of the body whose joint body i mimics, -1 if there is none that can be followed. */
RBDI_LOCAL int rbdi_mimic_source(const rbd_body *bodies, int nb, int i) {
    for (int j = 0; j < nb; ++j)
        if (j != i && rbdi_same(bodies[j].joint, bodies[i].mimic))
            return rbdi_can_mimic((int)bodies[j].type) && !bodies[j].mimic ? j : -1;
    return -1;
}

/* -- a row of the description: the first condition that fails is the report's error -- */

RBDI_LOCAL rbd_status rbdi_check_names(const rbd_body *bodies, int i, rbd_report *report) {
    const rbd_body *b = &bodies[i];
    for (int j = 0; j < i; ++j) {
        if (rbdi_same(b->name, bodies[j].name)) return rbdi_refuse(report, RBD_ERR_NAME, i, b->name, "name");
        if (rbdi_same(b->joint, bodies[j].joint))
            return rbdi_refuse(report, RBD_ERR_NAME, i, b->name, "joint");
    }
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_check_joint(const rbd_body *b, int i, rbd_report *report) {
    const int type = (int)b->type;
    int axes;
    if (b->parent < -1 || b->parent >= i) return rbdi_refuse(report, RBD_ERR_PARENT, i, b->name, "parent");
    if (type < 0 || type >= RBD_JOINT_TYPES) return rbdi_refuse(report, RBD_ERR_TYPE, i, b->name, "type");
    if (type == RBD_FIXED && !rbdi_all_zero(b->axis, 3))
        return rbdi_refuse_saying(report, RBD_ERR_TYPE, i, b->name, "type",
                                  "missing? it is 0, fixed, but the joint has an axis");

    axes = rbdi_described_axes(type);
    if (axes > 0 && !rbdi_is_axis(b->axis)) return rbdi_refuse(report, RBD_ERR_AXIS, i, b->name, "axis");
    if (axes > 1 && (!rbdi_is_axis(b->axis2) || rbdi_parallel(b->axis, b->axis2)))
        return rbdi_refuse(report, RBD_ERR_AXIS, i, b->name, "axis2");

    if (!rbdi_finite(&b->pitch, 1)) return rbdi_refuse(report, RBD_ERR_PITCH, i, b->name, "pitch");
    if (!rbdi_finite(b->position, 3)) return rbdi_refuse(report, RBD_ERR_POSITION, i, b->name, "position");
    if (!rbdi_is_rotation(b->rotation)) return rbdi_refuse(report, RBD_ERR_ROTATION, i, b->name, "rotation");
    return RBD_OK;
}

/* The body's inertia, and the armature, damping, friction and limits of its joint. */
RBDI_LOCAL rbd_status rbdi_check_numbers(const rbd_body *b, int i, rbd_report *report) {
    if (!rbdi_finite_positive(&b->mass, 1)) return rbdi_refuse(report, RBD_ERR_MASS, i, b->name, "mass");
    if (!rbdi_finite(b->com, 3)) return rbdi_refuse(report, RBD_ERR_COM, i, b->name, "com");
    if (!rbdi_finite(b->inertia, 6)) return rbdi_refuse(report, RBD_ERR_INERTIA, i, b->name, "inertia");

    if (!rbdi_finite_positive(b->armature, 6))
        return rbdi_refuse(report, RBD_ERR_ARMATURE, i, b->name, "armature");
    if (!rbdi_finite_positive(b->damping, 6))
        return rbdi_refuse(report, RBD_ERR_DAMPING, i, b->name, "damping");
    if (!rbdi_finite_positive(b->friction, 6))
        return rbdi_refuse(report, RBD_ERR_FRICTION, i, b->name, "friction");

    if (!rbdi_finite(&b->lower, 1)) return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "lower");
    if (!rbdi_finite(&b->upper, 1)) return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "upper");
    if (!rbdi_finite_positive(&b->velocity, 1))
        return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "velocity");
    if (!rbdi_finite_positive(&b->effort, 1))
        return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "effort");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_check_mimic(const rbd_body *bodies, int nb, int i, rbd_report *report) {
    const rbd_body *b = &bodies[i];
    if (!b->mimic) return RBD_OK;
    if (!rbdi_can_mimic((int)b->type) || rbdi_mimic_source(bodies, nb, i) < 0)
        return rbdi_refuse(report, RBD_ERR_MIMIC, i, b->name, "mimic");
    if (!rbdi_finite(&b->mimic_ratio, 1))
        return rbdi_refuse_saying(report, RBD_ERR_MIMIC, i, b->name, "mimic_ratio", "not finite");
    if (!(RBD_C(b->mimic_ratio) < 0 || RBD_C(b->mimic_ratio) > 0))
        return rbdi_refuse_saying(report, RBD_ERR_MIMIC, i, b->name, "mimic_ratio",
                                  "missing or 0: a joint that shall stand still is a fixed joint");
    if (!rbdi_finite(&b->mimic_offset, 1))
        return rbdi_refuse(report, RBD_ERR_MIMIC, i, b->name, "mimic_offset");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_check_body(const rbd_body *bodies, int nb, int i, rbd_report *report) {
    rbd_status status = rbdi_check_names(bodies, i, report);
    if (!status) status = rbdi_check_joint(&bodies[i], i, report);
    if (!status) status = rbdi_check_numbers(&bodies[i], i, report);
    if (!status) status = rbdi_check_mimic(bodies, nb, i, report);
    if (status) return status;

    rbdi_check_inertia(&bodies[i], i, report);
    rbdi_check_limits(&bodies[i], i, report);
    return RBD_OK;
}

/* Every joint must move mass, inertia or armature: of its body, of bodies fixed to it or moved with it, or of
   joints that mimic it. */
RBDI_LOCAL rbd_status rbdi_check_moves(const rbd_body *bodies, int nb, rbdi_place *place,
                                       rbd_report *report) {
    rbd_status status = RBD_OK;

    for (int i = 0; i < nb; ++i) place[i].moves = bodies[i].mimic != NULL;
    for (int i = 0; i < nb; ++i)
        if (bodies[i].mimic) place[rbdi_mimic_source(bodies, nb, i)].moves = 1;

    for (int i = nb - 1; i >= 0; --i) {
        const rbd_body *b = &bodies[i];
        const int fixed = b->type == RBD_FIXED;
        if (b->mass > 0 || !rbdi_all_zero(b->inertia, 6)) place[i].moves = 1;
        if (!rbdi_all_zero(b->armature, rbdi_joint_facts((int)b->type)->nv)) place[i].moves = 1;
        if (!fixed && !place[i].moves) status = rbdi_refuse(report, RBD_ERR_LEAF, i, b->name, "mass");
        if (b->parent >= 0 && (!fixed || place[i].moves)) place[b->parent].moves = 1;
    }

    return status;
}

/* Marks the bodies whose joint moves mass or inertia, or has armature; or such a joint mimics it, or it
   mimics one. Unlike rbdi_check_moves this is strict: armature of a joint is none of the joints that carry
   it. */
RBDI_LOCAL void rbdi_mark_movers(const rbd_body *bodies, int nb, rbdi_place *place) {
    for (int i = 0; i < nb; ++i) place[i].moves = bodies[i].mass > 0 || !rbdi_all_zero(bodies[i].inertia, 6);
    for (int i = nb - 1; i >= 0; --i)
        if (bodies[i].parent >= 0 && place[i].moves) place[bodies[i].parent].moves = 1;

    for (int i = 0; i < nb; ++i)
        if (!rbdi_all_zero(bodies[i].armature, rbdi_joint_facts((int)bodies[i].type)->nv)) place[i].moves = 1;

    for (int i = 0; i < nb; ++i)
        if (bodies[i].mimic && place[i].moves) place[rbdi_mimic_source(bodies, nb, i)].moves = 1;
    for (int i = 0; i < nb; ++i)
        if (bodies[i].mimic) place[i].moves = place[rbdi_mimic_source(bodies, nb, i)].moves;
}

/* The first dof of the first body whose joint moves no mass, or of the joint that it mimics; -1 if there is
   none. */
RBDI_LOCAL int rbdi_massless_dof_of(const rbd_body *bodies, int nb, rbdi_place *place) {
    rbdi_mark_movers(bodies, nb, place);
    for (int i = 0; i < nb; ++i)
        if (bodies[i].type != RBD_FIXED && !place[i].moves)
            return place[bodies[i].mimic ? rbdi_mimic_source(bodies, nb, i) : i].iv;
    return -1;
}

/* -- the steps of the build -- */

/* Lengths of the model's arrays. */
typedef struct rbdi_counts {
    int nl, nblock, ndof, nmimic, nq, nv;
} rbdi_counts;

/* A build: the description, the model with its arrays, and scratch behind them. */
typedef struct rbdi_build {
    const rbd_body *bodies;
    int nb;
    rbdi_counts n;
    int massless; /* the first dof that moves no mass, -1: none */
    rbd_model *m;
    RBDI_MODEL_ARRAYS(RBDI_ARRAY_FIELD, 0, 0, 0, 0, 0)
} rbdi_build;

RBDI_LOCAL rbdi_counts rbdi_count(const rbd_body *bodies, int nb) {
    rbdi_counts n = {0, 0, 0, 0, 0, 0};

    for (int i = 0; i < nb; ++i) {
        const rbdi_joint_fact *fact = rbdi_joint_facts((int)bodies[i].type);

        n.nl += rbdi_links_of((int)bodies[i].type);
        n.nblock += fact->nv > 0 && !fact->axes[0];
        n.ndof += fact->nv;
        n.nmimic += bodies[i].mimic != NULL;

        if (!bodies[i].mimic) {
            n.nq += fact->nq;
            n.nv += fact->nv;
        }
    }

    return n;
}

/* ==== src/model/links.h ==== */
/* The axis of a letter of rbdi_joint_fact.axes, of unit length, joint frame. */
RBDI_LOCAL void rbdi_link_axis(const rbd_body *b, char letter, rbdi_wide axis[3]) {
    const char name = rbdi_axis_name(letter);
    const double *described = name == 'a' ? b->axis : b->axis2;
    for (int k = 0; k < 3; ++k) axis[k] = name < 'x' ? (rbdi_wide)described[k] : name == 'x' + k;
    rbdi_unit(axis, axis);
}

RBDI_LOCAL void rbdi_clear_link(rbdi_build_link *l) {
    unsigned char *p = (unsigned char *)l;
    for (size_t k = 0; k < sizeof *l; ++k) p[k] = 0;
}

RBDI_LOCAL void rbdi_build_reach(rbdi_build_link *l, rbdi_wide reach) {
    if (l->reach < reach) l->reach = reach;
}

/* Step 1: the pose of body i, and the links of its joint, in the user's frames. Universal, cylindrical and
   Euler joints become chains of one-axis links; only the last has mass. */
RBDI_LOCAL void rbdi_build_joint(const rbdi_build *build, int i, int *nl) {
    const rbd_body *b = &build->bodies[i];
    rbdi_place *place = build->place;
    const int type = (int)b->type, n = rbdi_links_of(type);
    const char *axes = rbdi_joint_facts(type)->axes;
    rbdi_wide R[9];
    rbdi_wide_pose X;
    int parent = -1;

    rbdi_widen(b->rotation, 9, R);
    if (rbdi_all_zero(b->rotation, 9)) rbdi_w_identity(R);
    rbdi_orthonormalise(R);
    rbdi_w_transpose(R, X.E);
    rbdi_widen(b->position, 3, X.r);

    if (b->parent >= 0) {
        parent = place[b->parent].link;
        X = rbdi_w_compose(&X, &place[b->parent].X);
    }

    for (int k = 0; k < n; ++k) {
        rbdi_build_link *l = &build->links[*nl];

        rbdi_clear_link(l);
        l->parent = parent;
        l->type = type;
        l->body = i;
        l->joint_dof = k;
        l->iq = place[i].iq + k;
        l->iv = place[i].iv + k;
        l->favourite = -1;
        l->X = X;
        l->rho = 1;
        l->kind = RBDI_REVOLUTE;

        if (!axes[0]) {
            l->kind = RBDI_BLOCK;
        } else {
            rbdi_link_axis(b, axes[k], l->axis);
            if (type == RBD_CONTINUOUS_CS) l->kind = RBDI_REVOLUTE_CS;
            if (type == RBD_HELICAL) {
                l->kind = RBDI_SCREW;
                l->kappa = (rbdi_wide)b->pitch;
            }
            if (rbdi_axis_slides(axes[k])) {
                l->kind = RBDI_SCREW;
                l->rho = 0;
                l->kappa = 1;
            }
        }

        parent = (*nl)++;
        rbdi_w_identity(X.E);
        X.r[0] = X.r[1] = X.r[2] = 0;
    }

    place[i].link = parent;
    place[i].X = X;
    if (parent >= 0) rbdi_build_reach(&build->links[parent], rbdi_w_length(X.r));
}

/* Step 2: adds the body's moments of mass to its link's. About the centre of mass Sigma = tr(I)/2 - I. */
RBDI_LOCAL void rbdi_build_mass(const rbd_body *b, const rbdi_place *place, rbdi_build_link *links) {
    rbdi_wide Sigma[6], T[9], com[3], none[3] = {0, 0, 0}, half;
    if (place->link < 0) return;

    rbdi_widen(b->inertia, 6, Sigma);
    half = (Sigma[0] + Sigma[3] + Sigma[5]) / 2;
    for (int k = 0; k < 6; ++k) Sigma[k] = (k == 0 || k == 3 || k == 5 ? half : 0) - Sigma[k];
    rbdi_widen(b->com, 3, com);
    rbdi_w_transpose(place->X.E, T);
    rbdi_w_apply(T, com, com);
    for (int k = 0; k < 3; ++k) com[k] += place->X.r[k];
    rbdi_add_moments(&links[place->link], T, com, Sigma, none, (rbdi_wide)b->mass);
}

/* Step 3: solver frames, with the joint's axis on z. */
RBDI_LOCAL void rbdi_build_axis(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i];
    rbdi_w_identity(l->solver.E);
    if (l->kind != RBDI_BLOCK) rbdi_w_basis(l->axis, l->solver.E);
    l->X = rbdi_w_compose(&l->solver, &l->X);
    if (l->parent >= 0) l->X = rbdi_w_relative(&l->X, &links[l->parent].solver);
    rbdi_change_moments(l, l->solver.E, l->solver.r);
}

/* Of the children of a link the one with the highest rank comes first, its favourite: that with the largest
   subtree; under a one-axis parent one-axis children before blocks, because only they can have Denavit and
   Hartenberg's form. */
RBDI_LOCAL int rbdi_build_rank(const rbdi_build_link *links, int nl, int i) {
    const int one_axis = links[i].kind != RBDI_BLOCK && links[links[i].parent].kind != RBDI_BLOCK;
    return links[i].size + (one_axis ? nl : 0);
}

/* Step 4: depth-first positions. */
RBDI_LOCAL void rbdi_build_order(rbdi_build_link *links, int nl) {
    int next_root = 0;

    for (int i = 0; i < nl; ++i) links[i].size = 1;
    for (int i = nl - 1; i >= 0; --i)
        if (links[i].parent >= 0) links[links[i].parent].size += links[i].size;

    for (int i = 0; i < nl; ++i) {
        int *favourite;
        if (links[i].parent < 0) continue;
        favourite = &links[links[i].parent].favourite;
        if (*favourite < 0 || rbdi_build_rank(links, nl, i) > rbdi_build_rank(links, nl, *favourite))
            *favourite = i;
    }

    for (int i = 0; i < nl; ++i) {
        rbdi_build_link *l = &links[i];

        if (l->parent < 0) {
            l->position = next_root;
            next_root += l->size;
        } else if (links[l->parent].favourite == i) {
            l->position = links[l->parent].position + 1;
        } else {
            l->position = links[l->parent].cursor;
            links[l->parent].cursor += l->size;
        }

        l->cursor = l->position + 1 + (l->favourite >= 0 ? links[l->favourite].size : 0);
        links[l->position].order = i;
    }
}

/* Turns the frame of link i about its joint axis z by (c, s) and shifts it along z by t. The joint's motion
   and all results stay; the constants around it change. */
RBDI_LOCAL void rbdi_build_turn(rbdi_build_link *links, int nl, int i, rbdi_wide c, rbdi_wide s,
                                rbdi_wide t) {
    rbdi_build_link *l = &links[i];
    const rbdi_wide down[3] = {0, 0, -t};
    rbdi_wide_pose turn;

    rbdi_w_turn_z(c, s, turn.E);
    turn.r[0] = turn.r[1] = 0;
    turn.r[2] = t;
    for (int j = i + 1; j < nl; ++j)
        if (links[j].parent == i) links[j].X = rbdi_w_relative(&links[j].X, &turn);
    rbdi_change_moments(l, turn.E, down);
    l->solver = rbdi_w_compose(&turn, &l->solver);

    if (l->dh) {
        l->d += t;
        turn.r[2] = 0;
    }

    l->X = rbdi_w_compose(&turn, &l->X);
}

/* Angles of E = Rz(gamma) Rx(alpha) Rz(beta), |beta| <= 90 degrees, snapped to right angles. E is computed
   anew from them, so that poses and dynamics have the same model. */
RBDI_LOCAL void rbdi_build_angles(rbdi_build_link *l) {
    rbdi_wide *E = l->X.E, sigma = RBDI_WIDE_LIBM(rbdi_root)(E[6] * E[6] + E[7] * E[7]);

    l->cb = 1;
    l->sb = 0;
    l->ca = E[8] > 0 ? 1 : -1;
    l->sa = 0;

    if (sigma > RBDI_SNAP) {
        l->cb = -E[7] / sigma;
        l->sb = E[6] / sigma;
        l->ca = E[8];
        l->sa = sigma;
        rbdi_w_snap(&l->ca, &l->sa, RBDI_SNAP);
        rbdi_w_snap(&l->cb, &l->sb, RBDI_SNAP);

        if (l->cb < 0 && (rbdi_nonzero(l->ca) || !rbdi_nonzero(l->sb))) {
            l->cb = -l->cb;
            l->sb = -l->sb;
            l->sa = -l->sa;
        }
    }

    l->cg = E[0] * l->cb + E[1] * l->sb;
    l->sg = (E[1] * l->cb - E[0] * l->sb) * l->ca + E[2] * l->sa;
    rbdi_w_snap(&l->cg, &l->sg, RBDI_SNAP / 1000); /* removes rounding alone: any gamma costs the same */
    rbdi_w_zxz(l->cg, l->sg, l->ca, l->sa, l->cb, l->sb, E);
}

/* Bounds of the moments of mass, sums of m |x|^2 and of m |x|, of the subtree of link l about a point at this
   distance from l's origin: with its links stretched out away from the point. */
RBDI_LOCAL rbdi_wide rbdi_build_second_moment(const rbdi_build_link *l, rbdi_wide distance) {
    return l->all_mass * (l->radius + distance) * (l->radius + distance);
}

RBDI_LOCAL rbdi_wide rbdi_build_first_moment(const rbdi_build_link *l, rbdi_wide distance) {
    return l->lever + l->all_mass * distance;
}

/* Step 5, leaves to root: mass, radius of gyration and first moment of the stretched subtree about the link's
   own origin. */
RBDI_LOCAL void rbdi_build_measure(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i];
    const rbdi_wide own = l->Sigma[0] + l->Sigma[3] + l->Sigma[5];

    if (own > 0) l->radius += own; /* not positive: no real body is like this */
    if (own > 0 && l->mass > 0) l->lever += RBDI_WIDE_LIBM(rbdi_root)(own * l->mass);
    l->all_mass += l->mass;
    l->radius = l->all_mass > 0 ? RBDI_WIDE_LIBM(rbdi_root)(l->radius / l->all_mass) : 0;
    if (l->parent < 0) return;

    /* until the parent is measured its radius is the sum of the second moments */
    links[l->parent].radius += rbdi_build_second_moment(l, rbdi_w_length(l->X.r));
    links[l->parent].lever += rbdi_build_first_moment(l, rbdi_w_length(l->X.r));
    links[l->parent].all_mass += l->all_mass;
}

/* Whether the frame of link i, l, may move by t along its axis, so that its favourite child f is at this
   distance from it. Inertias about a far point are large, and the algorithms subtract them from each other:
   rounding errors grow with them. So the moments of this subtree may become at most 4 times those about the
   origin that the user chose. Right-angled and parallel axes pass (1.1 times at most in iiwa, HyQ, Atlas). */
RBDI_LOCAL int rbdi_build_near(const rbdi_build_link *links, int nl, int i, rbdi_wide t, rbdi_wide distance) {
    const rbdi_build_link *l = &links[i], *f = &links[l->favourite];
    const rbdi_wide rest = l->all_mass - f->all_mass, before = rbdi_w_length(f->X.r), step = rbdi_w_abs(t);

    for (int j = i + 1; j < nl; ++j) {
        const rbdi_build_link *child = &links[j];
        rbdi_wide r[3] = {child->X.r[0], child->X.r[1], child->X.r[2] - t};
        if (child->parent == i && child != f && child->all_mass > 0 &&
            child->radius + rbdi_w_length(r) > 4 * (child->radius + rbdi_w_length(child->X.r)))
            return 0;
    }

    return rest * t * t + rbdi_build_second_moment(f, distance) - rbdi_build_second_moment(f, before) <
               3 * rbdi_build_second_moment(l, 0) &&
           rest * step + rbdi_build_first_moment(f, distance) - rbdi_build_first_moment(f, before) <
               3 * rbdi_build_first_moment(l, 0);
}

/* Step 6, root to leaves: gives the favourite child of link i Denavit and Hartenberg's form, beta = 0 and r =
   (a, 0, 0), by a turn and shift of link i's frame. Without such a child gamma and d become 0 instead. Nearly
   parallel axes have their common normal far away and would lose digits: they keep a general r and beta. */
RBDI_LOCAL void rbdi_build_normalise(rbdi_build_link *links, int nl, int i) {
    rbdi_build_link *l = &links[i], *f;
    rbdi_wide r[3], Z[9], a, d = 0, t;
    if (l->kind == RBDI_BLOCK) return;
#ifdef RBDI_NO_FAVOURITE /* rbd-codegen --limbs: equal limbs get equal constants */
    if (l->favourite >= 0 && RBDI_NO_FAVOURITE(links, nl, i)) l->favourite = -1;
#endif
    if (l->favourite < 0 || links[l->favourite].kind == RBDI_BLOCK) {
        /* this saves no more than the shift d: the subtree may get at most 4 times farther away */
        const rbdi_wide moved = rbdi_build_second_moment(l, rbdi_w_abs(l->d));
        const int moves = l->dh && moved <= 16 * rbdi_build_second_moment(l, 0);
        rbdi_build_angles(l);
        rbdi_build_turn(links, nl, i, l->cg, -l->sg, moves ? -l->d : 0);
        return;
    }

    f = &links[l->favourite];
    rbdi_build_angles(l);
    rbdi_build_angles(f);

    if (rbdi_w_abs(f->sa) > 0) {
        /* the axes cross or pass each other: their common normal becomes x */

        /* beta or beta + 180 degrees: so that alpha is 90 degrees, or else l's gamma within 90 degrees */
        if (rbdi_nonzero(f->ca) ? l->cg * f->cb - l->sg * f->sb < 0 : f->sa < 0) {
            f->cb = -f->cb;
            f->sb = -f->sb;
            f->sa = -f->sa;
        }

        /* in axes turned by beta: r = (a, 0, t) + d (row z of Rx(alpha)) */
        rbdi_w_turn_z(f->cb, f->sb, Z);
        rbdi_w_apply(Z, f->X.r, r);
        a = r[0];
        d = -r[1] / f->sa;
        t = r[2] - d * f->ca;
        if (!rbdi_build_near(links, nl, i, t, RBDI_WIDE_LIBM(rbdi_root)(a * a + d * d))) return;
        rbdi_build_turn(links, nl, i, f->cb, f->sb, t);
    } else {
        /* the axes are parallel: x leads from one to the other */
        a = RBDI_WIDE_LIBM(rbdi_root)(f->X.r[0] * f->X.r[0] + f->X.r[1] * f->X.r[1]);
        t = f->X.r[2];
        if (!rbdi_build_near(links, nl, i, t, a)) {
            d = t * f->ca;
            t = 0;
        }
        rbdi_build_turn(links, nl, i, a > 0 ? f->X.r[0] / a : 1, a > 0 ? f->X.r[1] / a : 0, t);
    }

    f->dh = 1;
    f->X.r[0] = a;
    f->X.r[1] = f->X.r[2] = 0;
    f->d = d;
}

/* Origin of a link in its parent's frame at q = 0. */
RBDI_LOCAL void rbdi_build_origin(const rbdi_build_link *l, rbdi_wide r[3]) {
    for (int k = 0; k < 3; ++k) r[k] = l->X.r[k] + l->d * l->X.E[6 + k];
}

/* ==== src/model/regroup.h ==== */
/* Step 7, leaves to root: scale, a bound of the inertia that the joint moves, in any configuration: that of
   the subtree about the link's origin, but of the link's own only the part about the axis. A pivot is the
   difference of numbers of this size.

   RBDI_ROD of the inertia about all axes is added. Otherwise a pivot of 16 roundings of the description would
   not be in doubt where nothing should turn about the axis, as with a thin rod on it. This inertia is taken
   about points as far away as the user's frames: solver.r, from the link's origin to the user's, and reach,
   to the farthest body fixed to this link or to a later one. A sliding joint is assumed to move by 1 m. */
RBDI_LOCAL void rbdi_build_scale(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i], *parent;
    rbdi_wide r[3], distance, reach,
        trace = l->Sigma[0] + l->Sigma[3] + l->Sigma[5] + l->mass * rbdi_w_dot(l->solver.r, l->solver.r);

    l->scale = l->trace + (l->kind == RBDI_BLOCK ? trace : l->Sigma[0] + l->Sigma[3]);
    l->trace += trace;
    l->moment += rbdi_w_length(l->h);
    reach = l->reach += rbdi_w_length(l->solver.r);
    l->scale += RBDI_ROD * (l->trace + 2 * l->moment * reach + l->all_mass * reach * reach);
    if (l->parent < 0) return;

    parent = &links[l->parent];
    rbdi_build_origin(l, r);
    distance = rbdi_w_length(r);
    parent->trace += l->trace + 2 * l->moment * distance + l->all_mass * distance * distance;
    parent->moment += l->moment + l->all_mass * distance;

    /* a joint that slides */
    if (l->kind == RBDI_BLOCK ? l->type != RBD_SPHERICAL : rbdi_nonzero(l->kappa)) reach += 1;
    rbdi_build_reach(parent, reach);
}

/* Step 8, leaves to root: regrouping ([design]). Moments of mass that the joint's motion does not change go
   to the parent: of a revolute link m, h_z and Sigma_zz, of a sliding one Sigma, of a spherical one m, of a
   helical or planar one Sigma_zz. */
RBDI_LOCAL void rbdi_build_regroup(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i];
    rbdi_wide Sigma[6] = {0, 0, 0, 0, 0, 0}, h[3] = {0, 0, 0}, mass = 0, r[3], T[9];
    int slides = l->type == RBD_TRANSLATION || (l->kind == RBDI_SCREW && !(l->rho > 0));
    if (l->type == RBD_FLOATING) return;

    if (l->type == RBD_SPHERICAL) {
        mass = l->mass;
        l->mass = 0;
    } else if (slides) {
        for (int k = 0; k < 6; ++k) {
            Sigma[k] = l->Sigma[k];
            l->Sigma[k] = 0;
        }
    } else {
        Sigma[5] = l->Sigma[5];
        l->Sigma[5] = 0;
        if (l->kind == RBDI_REVOLUTE || l->kind == RBDI_REVOLUTE_CS) {
            h[2] = l->h[2];
            l->h[2] = 0;
            mass = l->mass;
            l->mass = 0;
        }
    }
    if (l->parent < 0) return;

    rbdi_build_origin(l, r);
    rbdi_w_transpose(l->X.E, T);
    rbdi_add_moments(&links[l->parent], T, r, Sigma, h, mass);
}

/* ==== src/model/emit.h ==== */
/* Three and six numbers of the build as constants of the model. */
RBDI_LOCAL rbdi_c3 rbdi_round3(const rbdi_wide x[3]) {
    rbdi_c3 out;
    out.x = RBD_C(x[0]);
    out.y = RBD_C(x[1]);
    out.z = RBD_C(x[2]);
    return out;
}

RBDI_LOCAL rbdi_csym rbdi_round6(const rbdi_wide x[6]) {
    rbdi_csym out;

    out.xx = RBD_C(x[0]);
    out.xy = RBD_C(x[1]);
    out.xz = RBD_C(x[2]);
    out.yy = RBD_C(x[3]);
    out.yz = RBD_C(x[4]);
    out.zz = RBD_C(x[5]);
    return out;
}

/* The joint angle at q = 0. Its right angles are kept apart, because a multiple of pi would be rounded. */
RBDI_LOCAL void rbdi_emit_angle(const rbdi_build_link *l, rbdi_link *out) {
    rbdi_wide c = l->cg, s = l->sg, minus_c;
    int quarters = 0;

    out->cg = RBD_C(c);
    out->sg = RBD_C(s);

    for (; quarters < 3 && c < rbdi_w_abs(s); ++quarters) {
        minus_c = 0 - c;
        c = s;
        s = minus_c;
    }

    out->quarters = RBD_C(quarters);
    out->gamma = l->kind == RBDI_BLOCK ? RBD_C(0) : RBD_C(rbdi_w_angle(c, s));
}

/* The flags of a link: the operations that its constants make necessary. */
RBDI_LOCAL int rbdi_emit_flags(const rbdi_build *build, const rbdi_build_link *l) {
    const rbd_body *b = &build->bodies[l->body];
    const int block = l->kind == RBDI_BLOCK;
    int flags = 0;

    if (!block && rbdi_nonzero(l->sb)) flags |= RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ;
    if (rbdi_nonzero(l->X.r[1]) || rbdi_nonzero(l->X.r[2])) flags |= RBDI_SHIFT_XYZ;
    if ((flags & RBDI_SHIFT_XYZ) || rbdi_nonzero(l->X.r[0])) flags |= RBDI_SHIFT_R;
    if (rbdi_nonzero(l->d) || rbdi_nonzero(l->kappa)) flags |= RBDI_SHIFT_Z;
    if (block || l->kind == RBDI_SCREW) flags |= RBDI_MASS_KEPT;
    if (!rbdi_all_zero(b->armature, rbdi_joint_facts(l->type)->nv)) flags |= RBDI_ARMATURE;
    if (l->parent < 0) flags |= RBDI_ROOT;
    if (l->kind == RBDI_SCREW) flags |= RBDI_SLIDES;
    if (!block && !rbdi_nonzero(l->ca) && l->sa > 0) flags |= RBDI_TWIST_90;
    if (!block && !rbdi_nonzero(l->sa) && l->ca > 0) flags |= RBDI_TWIST_0;
    return flags;
}

/* Step 9: the constants of the link at position p. */
RBDI_LOCAL rbdi_link rbdi_emit_link(const rbdi_build *build, int p) {
    const rbdi_build_link *links = build->links, *l = &links[links[p].order];
    rbdi_link out;

    out.parent = (int16_t)(l->parent < 0 ? -1 : links[l->parent].position);
    out.iq = (int16_t)l->iq;
    out.iv = (int16_t)l->iv;
    out.block = out.branch = -1;
    out.first = out.end = 0;
    out.kind = (int16_t)l->kind;
    out.flags = (int16_t)rbdi_emit_flags(build, l);

    rbdi_emit_angle(l, &out);
    out.ca = RBD_C(l->ca);
    out.sa = RBD_C(l->sa);
    out.cb = RBD_C(l->cb);
    out.sb = RBD_C(l->sb);
    out.r = rbdi_round3(l->X.r);
    out.d = RBD_C(l->d);
    out.rho = RBD_C(l->rho);
    out.kappa = RBD_C(l->kappa);

    out.Sigma = rbdi_round6(l->Sigma);
    out.h = rbdi_round3(l->h);
    out.mass = RBD_C(l->mass);
    out.subtree_mass = RBD_C(l->subtree_mass);
    return out;
}

/* The same of a block: its joint. */
RBDI_LOCAL rbdi_block rbdi_emit_block(const rbdi_build_link *l) {
    const rbdi_joint_fact *fact = rbdi_joint_facts(l->type);
    rbdi_block out;

    out.type = (int16_t)l->type;
    out.first = (int16_t)rbdi_first_axis(l->type);
    out.n = (int16_t)fact->nv;
    out.identity = 1;

    for (int k = 0; k < 9; ++k) {
        out.E[k] = RBD_C(l->X.E[k]);
        if (rbdi_nonzero(l->X.E[k] - (k % 4 == 0))) out.identity = 0;
    }

    return out;
}

/* Bound of the inertia that the link's k-th dof moves. */
RBDI_LOCAL rbdi_wide rbdi_build_dof_scale(const rbdi_build_link *l, int k) {
    if (l->kind != RBDI_BLOCK) return l->rho * l->scale + l->kappa * l->kappa * l->all_mass;
    return rbdi_first_axis(l->type) + k < 3 ? l->scale : l->all_mass;
}

/* The dofs of the link at position p. */
RBDI_LOCAL void rbdi_emit_dofs(const rbdi_build *build, int p) {
    const rbdi_build_link *l = &build->links[build->links[p].order];
    const rbd_body *b = &build->bodies[l->body];
    const rbdi_link *link = &build->link[p];
    rbdi_dof *dof = build->dof;
    const int n = l->kind == RBDI_BLOCK ? rbdi_joint_facts(l->type)->nv : 1;

    for (int k = 0; k < n; ++k) {
        rbdi_dof *out = &dof[link->iv + k];

        out->body = (int16_t)l->body;
        out->before = -1;

        if (k > 0) {
            out->before = (int16_t)(link->iv + k - 1);
        } else if (link->parent >= 0) {
            const rbdi_link *parent = &build->link[link->parent];
            out->before = (int16_t)(parent->iv + rbdi_link_dofs(build->m, parent) - 1);
        }

        out->level = (int16_t)(out->before < 0 ? 0 : dof[out->before].level + 1);
        out->armature = RBD_C(b->armature[l->joint_dof + k]);
        out->damping = RBD_C(b->damping[l->joint_dof + k]);
        out->friction = RBD_C(b->friction[l->joint_dof + k]);
        out->scale = RBD_C(rbdi_build_dof_scale(l, k)) + out->armature + RBDI_LEAST_SCALE;
    }
}

/* Body i in the user's frame. */
RBDI_LOCAL rbdi_frame rbdi_emit_frame(const rbdi_build *build, int i) {
    const rbd_body *b = &build->bodies[i];
    const rbdi_place *place = &build->place[i];
    rbdi_wide_pose X = place->X;
    rbdi_wide com[3], I[6];
    rbdi_frame out;

    rbdi_widen(b->com, 3, com);
    rbdi_widen(b->inertia, 6, I);
    out.link = -1;

    if (place->link >= 0) {
        out.link = (int16_t)build->links[place->link].position;
        X = rbdi_w_relative(&X, &build->links[place->link].solver);
    }

    out.name = b->name;
    out.joint = b->joint;
    out.parent = (int16_t)b->parent;
    out.type = (int16_t)b->type;
    out.iq = (int16_t)place->iq;
    out.iv = (int16_t)place->iv;
    out.nq = out.nv = 0;

    if (!b->mimic) {
        out.nq = (int16_t)rbdi_joint_facts((int)b->type)->nq;
        out.nv = (int16_t)rbdi_joint_facts((int)b->type)->nv;
    }

    for (int k = 0; k < 9; ++k) out.E[k] = RBD_C(X.E[k]);
    out.r = rbdi_round3(X.r);
    out.mass = RBD_C(b->mass);
    out.com = rbdi_round3(com);
    out.I = rbdi_round6(I);
    const int limited = rbdi_is_limited(b);
    out.lower = limited ? RBD_C(b->lower) : RBD_C(0);
    out.upper = limited ? RBD_C(b->upper) : RBD_C(0);
    out.velocity = RBD_C(b->velocity);
    out.effort = RBD_C(b->effort);
    return out;
}

/* Steps 3 to 8: from the user's frames to those of [design]. */
RBDI_LOCAL void rbdi_build_solve(rbdi_build_link *links, int nl) {
    for (int i = 0; i < nl; ++i) rbdi_build_axis(links, i);
    rbdi_build_order(links, nl);
    for (int p = nl - 1; p >= 0; --p) rbdi_build_measure(links, links[p].order);
    for (int p = 0; p < nl; ++p) rbdi_build_normalise(links, nl, links[p].order);
    for (int i = 0; i < nl; ++i)
        if (links[i].kind != RBDI_BLOCK) rbdi_build_angles(&links[i]);
    for (int p = nl - 1; p >= 0; --p) rbdi_build_scale(links, links[p].order);
    for (int p = nl - 1; p >= 0; --p) rbdi_build_regroup(links, links[p].order);

    for (int p = nl - 1; p >= 0; --p) {
        rbdi_build_link *l = &links[links[p].order];
        l->subtree_mass += l->mass;
        if (l->parent >= 0) links[l->parent].subtree_mass += l->subtree_mass;
    }
}

/* Coordinates and dofs: in the order of the bodies; those of mimic joints behind all others. */
RBDI_LOCAL void rbdi_place_coordinates(const rbdi_build *build) {
    int iq = 0, iv = 0, mimic = 0;

    for (int i = 0; i < build->nb; ++i) {
        const rbdi_joint_fact *fact = rbdi_joint_facts((int)build->bodies[i].type);
        rbdi_place *place = &build->place[i];

        place->iq = iq;
        place->iv = iv;

        if (build->bodies[i].mimic) {
            place->iq = build->n.nq + mimic;
            place->iv = build->n.nv + mimic;
            ++mimic;
        } else {
            iq += fact->nq;
            iv += fact->nv;
        }
    }
}

/* All numbers that rbd_work_size and rbd_batch_size depend on, side by side in few words to compare; and the
   first dof that moves no mass, see rbdi_massless_dof. */
RBDI_LOCAL void rbdi_shape(const rbd_model *m, int massless, uint64_t shape[RBDI_SHAPE]) {
    shape[0] = (uint64_t)m->nb << 48 | (uint64_t)m->nq << 32 | (uint64_t)m->nv << 16 | (uint64_t)m->nl;
    shape[1] = (uint64_t)(massless + 1) << 48 | (uint64_t)m->nblock << 32 | (uint64_t)m->nbranch << 16 |
               (uint64_t)m->nmimic;
    shape[2] = (uint64_t)m->nh << 32 | (uint64_t)m->nhx;
}

/* Entry (i, j) of the matrix is not zero: so one of the two must be on the other's path to the root. The
   elimination of a row fills the row of its lambda in all its other columns (RBDA 6.5): so from there on the
   two paths become one. */
RBDI_LOCAL void rbdi_couple(rbdi_dof *dof, int i, int j) {
    while (i != j) {
        const int high = i > j ? i : j, low = i > j ? j : i, next = dof[high].lambda;
        if (next < low) dof[high].lambda = (int16_t)low;
        i = low;
        j = next;
    }
}

/* The nv dofs of the matrix in depth-first order. Meanwhile dof.depth is the number of descendants, and
   dof.row where the next child goes. */
RBDI_LOCAL void rbdi_emit_nodes(rbdi_dof *dof, int nv, rbdi_node *node) {
    int32_t next = 0;

    for (int k = 0; k < nv; ++k) dof[k].depth = 0;
    for (int k = nv - 1; k >= 0; --k)
        if (dof[k].lambda >= 0) dof[dof[k].lambda].depth += (int16_t)(dof[k].depth + 1);

    for (int k = 0; k < nv; ++k) {
        int32_t *place = dof[k].lambda < 0 ? &next : &dof[dof[k].lambda].row;
        node[*place].dof = (int16_t)k;
        node[*place].descendants = dof[k].depth;
        dof[k].row = *place + 1;
        *place += dof[k].depth + 1;
    }
}

/* Step 10: the tree of the matrix. Without mimic joints it is that of the mechanism. A mimic dof couples the
   dof that it follows with those on its path to the root, and with those whose path it is on. */
RBDI_LOCAL void rbdi_emit_tree(const rbdi_build *build) {
    const int nv = build->n.nv, n = build->n.ndof;
    const rbdi_mimic *mimic = build->mimic;
    rbdi_dof *dof = build->dof;

    for (int k = 0; k < n; ++k) {
        int before = dof[k].before;
        while (before >= nv) before = dof[before].before;
        dof[k].lambda = (int16_t)(k < nv ? before : -1);
    }

    for (int k = 0; k < n; ++k)
        for (int j = dof[k].before; j >= 0; j = dof[j].before)
            if (k >= nv || j >= nv)
                rbdi_couple(dof, k < nv ? k : mimic[k - nv].source_v, j < nv ? j : mimic[j - nv].source_v);

    rbdi_emit_nodes(dof, nv, build->node);
    build->m->nh = 0;

    for (int k = 0; k < n; ++k) {
        dof[k].depth = (int16_t)(dof[k].lambda < 0 ? 0 : dof[dof[k].lambda].depth + 1);
        dof[k].row = build->m->nh;
        if (k < nv) build->m->nh += dof[k].depth + 1;
    }

    for (int k = 0; k < nv; ++k) build->node[k].row = dof[build->node[k].dof].row;
}

/* Links, blocks, branch points and dofs, in the solver's order. */
RBDI_LOCAL void rbdi_emit_links(const rbdi_build *build) {
    rbd_model *m = build->m;
    int block = 0;

    m->nbranch = 0;
    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *out = &build->link[p];

        *out = rbdi_emit_link(build, p);
        if (out->kind == RBDI_BLOCK) {
            out->block = (int16_t)block;
            build->block[block++] = rbdi_emit_block(&build->links[build->links[p].order]);
        }

        if (out->parent >= 0 && out->parent != p - 1 && build->link[out->parent].branch < 0)
            build->link[out->parent].branch = m->nbranch++;
        rbdi_emit_dofs(build, p);
    }

    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *out = &build->link[p];
        if (out->kind == RBDI_BLOCK || out->branch >= 0 || out->parent < 0 || out->parent != p - 1 ||
            (out->flags & RBDI_SHIFT_XYZ))
            out->flags |= RBDI_OFF_CHAIN;
    }
}

/* Frames of the bodies, and mimic joints, whose inertia adds to the scale of the joint that they follow. */
RBDI_LOCAL void rbdi_emit_frames(const rbdi_build *build) {
    int next = 0;

    for (int i = 0; i < build->nb; ++i) {
        build->frame[i] = rbdi_emit_frame(build, i);
        if (!build->bodies[i].mimic) continue;

        const rbdi_place *source = &build->place[rbdi_mimic_source(build->bodies, build->nb, i)];
        rbdi_mimic *out = &build->mimic[next++];

        out->source_q = (int16_t)source->iq;
        out->source_v = (int16_t)source->iv;
        out->ratio = RBD_C(build->bodies[i].mimic_ratio);
        out->offset = RBD_C(build->bodies[i].mimic_offset);
        build->dof[out->source_v].scale += out->ratio * out->ratio * build->dof[build->place[i].iv].scale;
    }
}

/* The solver's order of the dofs, with the rows that crba writes; the range of each link's subtree in it. */
RBDI_LOCAL void rbdi_emit_order(const rbdi_build *build) {
    rbd_model *m = build->m;
    int next = 0;

    m->nhx = 0;
    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *out = &build->link[p];
        out->first = (int16_t)next;
        for (int k = 0; k < rbdi_link_dofs(m, out); ++k, ++next) {
            const rbdi_dof *dof = &build->dof[out->iv + k];
            build->order[next].dof = (int16_t)(out->iv + k);
            build->order[next].row = m->nmimic ? m->nh + m->nhx : dof->row;
            if (m->nmimic) m->nhx += dof->level + 1;
        }
    }

    for (int p = 0; p < m->nl; ++p) {
        const int behind = p + build->links[build->links[p].order].size;
        build->link[p].end = behind < m->nl ? build->link[behind].first : (int16_t)next;
    }
}

/* Steps 9 and 10. */
RBDI_LOCAL void rbdi_emit(const rbdi_build *build) {
    rbd_model *m = build->m;

    m->link = build->link;
    m->block = build->block;
    m->dof = build->dof;
    m->order = build->order;
    m->node = build->node;
    m->mimic = build->mimic;
    m->frame = build->frame;

    m->version = RBD_MODEL_VERSION;
    m->scalar = (int16_t)sizeof(rbd_const);
    m->nb = (int16_t)build->nb;
    m->nq = (int16_t)build->n.nq;
    m->nv = (int16_t)build->n.nv;
    m->nl = (int16_t)build->n.nl;
    m->nblock = (int16_t)build->n.nblock;
    m->nmimic = (int16_t)build->n.nmimic;
    m->gravity.x = m->gravity.y = RBD_C(0);
    m->gravity.z = RBD_C(-9.81);

    rbdi_emit_links(build);
    rbdi_emit_frames(build);
    rbdi_emit_tree(build);
    rbdi_emit_order(build);
    m->features = rbdi_features(m) | (build->massless < 0 ? 0 : RBDI_MASSLESS);
    rbdi_shape(m, build->massless, m->shape);
}

/* ==== src/model/build.h ==== */
/* Takes the model and the scratch of the build from the memory. */
RBDI_LOCAL void rbdi_build_take(rbdi_build *b, void *memory) {
    unsigned char *p = rbdi_aligned(memory);
    b->m = (rbd_model *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_model)));
#define RBDI_TAKE(type, name, length) \
    b->name = (type *)rbdi_take(&p, 1, RBDI_ROUND((size_t)(length) * sizeof(type)));
    RBDI_MODEL_ARRAYS(RBDI_TAKE, b->nb, b->n.nl, b->n.nblock, b->n.ndof, b->n.nmimic)
#undef RBDI_TAKE
}

RBDI_API size_t rbd_model_size(const rbd_body *bodies, int nb) {
    rbdi_counts n;
    if (!bodies || nb < 1 || nb > RBD_MAX_BODIES) return 0;
    n = rbdi_count(bodies, nb);
    return RBDI_MODEL_BYTES(nb, n.nl, n.nblock, n.ndof, n.nmimic);
}

/* Builds a model. kinematic: joints may move no mass. */
RBDI_LOCAL rbd_status rbdi_build_model(const rbd_body *bodies, int nb, int kinematic, void *memory,
                                       size_t size, const rbd_model **model, rbd_report *report) {
    rbd_report own;

    if (!report) report = &own;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (model) *model = NULL;
    if (!bodies || !memory || !model) return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (nb < 1 || nb > RBD_MAX_BODIES) return rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);

    for (int i = 0; i < nb; ++i) {
        const rbd_status status = rbdi_check_body(bodies, nb, i, report);
        if (status) return status;
    }
    rbdi_check_followers(bodies, nb, report);

    rbdi_build b;
    b.bodies = bodies;
    b.nb = nb;
    b.n = rbdi_count(bodies, nb);
    if (size < rbd_model_size(bodies, nb)) return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);

    rbdi_build_take(&b, memory);
    rbdi_place_coordinates(&b);

    for (int i = 0, nl = 0; i < nb; ++i) {
        rbdi_build_joint(&b, i, &nl);
        rbdi_build_mass(&bodies[i], &b.place[i], b.links);
    }

    b.massless = kinematic ? rbdi_massless_dof_of(bodies, nb, b.place) : -1;
    if (!kinematic && rbdi_check_moves(bodies, nb, b.place, report)) return RBD_ERR_LEAF;

    rbdi_build_solve(b.links, b.n.nl);
    rbdi_emit(&b);
    *model = b.m;
    return RBD_OK;
}

RBDI_API rbd_status rbd_model_build(const rbd_body *bodies, int nb, void *memory, size_t size,
                                    const rbd_model **model, rbd_report *report) {
    return rbdi_build_model(bodies, nb, 0, memory, size, model, report);
}

RBDI_API rbd_status rbd_model_build_kinematic(const rbd_body *bodies, int nb, void *memory, size_t size,
                                              const rbd_model **model, rbd_report *report) {
    return rbdi_build_model(bodies, nb, 1, memory, size, model, report);
}

/* ==== src/model/payload.h ==== */
/* -- a payload -- */

/* The inertia of a body with a payload: the sum of the masses, the centre of mass c, the moments about it. */
RBDI_LOCAL rbd_status rbdi_payload_frame(rbdi_frame *u, const rbd_body *load) {
    const rbdi_wide mass[2] = {(rbdi_wide)u->mass, (rbdi_wide)load->mass}, sum = mass[0] + mass[1];
    const rbdi_wide com[2][3] = {{(rbdi_wide)u->com.x, (rbdi_wide)u->com.y, (rbdi_wide)u->com.z},
                                 {(rbdi_wide)load->com[0], (rbdi_wide)load->com[1], (rbdi_wide)load->com[2]}};
    const rbdi_wide noise = 8 * (rbdi_wide)RBDI_EPS * (rbdi_w_abs(mass[0]) + rbdi_w_abs(mass[1]));
    const rbdi_wide total = rbdi_w_abs(sum) > noise ? sum : 0;
    rbdi_wide c[3], I[6] = {(rbdi_wide)u->I.xx, (rbdi_wide)u->I.xy, (rbdi_wide)u->I.xz,
                            (rbdi_wide)u->I.yy, (rbdi_wide)u->I.yz, (rbdi_wide)u->I.zz};
    double whole[6], size = 0;
    if (total < 0) return RBD_ERR_MASS;

    for (int k = 0; k < 3; ++k)
        c[k] = total > 0 ? (mass[0] * com[0][k] + mass[1] * com[1][k]) / total : com[0][k];
    for (int k = 0; k < 6; ++k) {
        size += (double)(rbdi_w_abs(I[k]) + rbdi_w_abs((rbdi_wide)load->inertia[k]));
        I[k] += (rbdi_wide)load->inertia[k];
    }

    for (int part = 0; part < 2; ++part) {
        const rbdi_wide r[3] = {com[part][0] - c[0], com[part][1] - c[1], com[part][2] - c[2]},
                        rr = rbdi_w_dot(r, r);
        for (int k = 0, i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j, ++k) I[k] += mass[part] * ((i == j ? rr : 0) - r[i] * r[j]);
        size += (double)(rbdi_w_abs(mass[part]) * rr);
    }

    for (int k = 0; k < 6; ++k) whole[k] = (double)I[k];
    size *= 1 + 16 * (double)RBDI_EPS / RBDI_SEMIDEFINITE;
    if (!rbdi_finite(whole, 6) || (size > 0 && !rbdi_semidefinite(whole, size))) return RBD_ERR_INERTIA;

    u->mass = RBD_C(total);
    u->com = rbdi_round3(c);
    u->I = rbdi_round6(I);
    return RBD_OK;
}

/* Prepares a step of the build from link i of the model to its parent, for the payload alone: pair[1] becomes
   link i with the moments of mass that pair[0] has, pair[0] its parent, empty. */
RBDI_LOCAL void rbdi_payload_step(const rbd_model *m, int i, rbdi_build_link pair[2]) {
    const rbdi_link *l = &m->link[i];

    pair[1] = pair[0];
    pair[1].parent = l->parent < 0 ? -1 : 0;
    pair[1].kind = l->kind;
    pair[1].type = l->kind == RBDI_BLOCK ? m->block[l->block].type : 0;
    pair[1].rho = (rbdi_wide)l->rho;
    pair[1].kappa = (rbdi_wide)l->kappa;
    pair[1].X = rbdi_link_place(m, l);
    rbdi_clear_link(&pair[0]);
    pair[0].all_mass = pair[1].all_mass;
}

/* Adds x to a dof's scale. */
RBDI_LOCAL void rbdi_payload_scale(rbdi_dof *dof, rbdi_wide x) {
    dof->scale = RBD_C((rbdi_wide)dof->scale + x);
    if (dof->scale < dof->armature + RBDI_LEAST_SCALE) dof->scale = dof->armature + RBDI_LEAST_SCALE;
}

/* Step 7, the bounds of pivots, for a payload that is added (sign = 1) or taken off (-1). */
RBDI_LOCAL void rbdi_payload_bounds(const rbd_model *m, int i, rbd_body load, const rbdi_place *place) {
    rbdi_dof *dof = (rbdi_dof *)m->dof;
    const double sign = load.mass < 0 || load.inertia[0] + load.inertia[3] + load.inertia[5] < 0 ? -1 : 1;
    rbdi_build_link pair[2];

    load.mass *= sign;
    for (int k = 0; k < 6; ++k) load.inertia[k] *= sign;
    rbdi_clear_link(&pair[0]);
    rbdi_build_mass(&load, place, pair);
    pair[0].all_mass = pair[0].mass;

    for (; i >= 0; i = m->link[i].parent) {
        const int iv = m->link[i].iv;

        rbdi_payload_step(m, i, pair);
        for (int body = 0; body < m->nb; ++body) {
            const rbdi_c3 at = m->frame[body].r;
            const rbdi_wide r[3] = {(rbdi_wide)at.x, (rbdi_wide)at.y, (rbdi_wide)at.z};
            if (m->frame[body].link == i) rbdi_build_reach(&pair[1], rbdi_w_length(r));
        }

        rbdi_build_scale(pair, 1);
        for (int k = 0; k < rbdi_link_dofs(m, &m->link[i]); ++k) {
            const rbdi_wide x = (rbdi_wide)sign * rbdi_build_dof_scale(&pair[1], k);
            rbdi_payload_scale(&dof[iv + k], x);
            if (iv >= m->nv) { /* which has one dof */
                const rbdi_mimic *mimic = &m->mimic[iv - m->nv];
                const rbdi_wide ratio = (rbdi_wide)mimic->ratio;
                rbdi_payload_scale(&dof[mimic->source_v], ratio * ratio * x);
            }
        }
    }
}

/* Step 8, regrouping, for the payload alone, because it is linear: on the way to the root each link keeps a
   part. */
RBDI_LOCAL void rbdi_payload_links(const rbd_model *m, int i, const rbd_body *load, const rbdi_place *place) {
    rbdi_link *link = (rbdi_link *)m->link;
    rbdi_build_link pair[2];
    rbdi_wide kept = 0;

    rbdi_clear_link(&pair[0]);
    rbdi_build_mass(load, place, pair);

    for (; i >= 0; i = link[i].parent) {
        rbdi_csym *Sigma = &link[i].Sigma, add;

        rbdi_payload_step(m, i, pair);
        rbdi_build_regroup(pair, 1);

        add = rbdi_round6(pair[1].Sigma);
        Sigma->xx += add.xx;
        Sigma->xy += add.xy;
        Sigma->xz += add.xz;
        Sigma->yy += add.yy;
        Sigma->yz += add.yz;
        Sigma->zz += add.zz;

        link[i].h.x += RBD_C(pair[1].h[0]);
        link[i].h.y += RBD_C(pair[1].h[1]);
        link[i].h.z += RBD_C(pair[1].h[2]);
        link[i].mass += RBD_C(pair[1].mass);
        kept += pair[1].mass;
        link[i].subtree_mass += RBD_C(kept);
    }
}

RBDI_API rbd_status rbd_add_payload(void *memory, int body, double mass, const double com[3],
                                    const double inertia[6]) {
    const rbd_model *m = memory ? (const rbd_model *)rbdi_aligned(memory) : NULL;
    rbd_status status;
    rbdi_frame *u;
    rbd_body load;
    rbdi_place place;
    if (!m || !com) return RBD_ERR_NULL;
    if (m->version != RBD_MODEL_VERSION || m->scalar != (int)sizeof(rbd_const)) return RBD_ERR_VERSION;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    load.mass = mass;
    for (int k = 0; k < 3; ++k) load.com[k] = com[k];
    for (int k = 0; k < 6; ++k) load.inertia[k] = inertia ? inertia[k] : 0;
    if (!rbdi_finite(&load.mass, 1)) return RBD_ERR_MASS;
    if (!rbdi_finite(load.com, 3)) return RBD_ERR_COM;
    if (!rbdi_finite(load.inertia, 6)) return RBD_ERR_INERTIA;

    u = (rbdi_frame *)&m->frame[body];
    status = rbdi_payload_frame(u, &load);
    if (status || u->link < 0) return status;

    place.link = 0;
    place.X = rbdi_widen_pose(u->E, u->r);
    rbdi_payload_links(m, u->link, &load, &place);
    rbdi_payload_bounds(m, u->link, load, &place);
    return RBD_OK;
}

/* ==== src/model/lock.h ==== */
/* -- joints held still -- */

/* Sine and cosine of an angle of any size. Long division by the right angle gives the number of right angles
   and the rest. Only the right angle is rounded, so the error is at most that of one more rounding of x. */
RBDI_LOCAL void rbdi_w_sincos(rbdi_wide x, rbdi_wide *s, rbdi_wide *c) {
    const rbdi_wide right_angle = RBDI_PI(rbdi_wide) / 2;
    rbdi_wide rest = rbdi_w_abs(x), part = right_angle, sine, cosine;
    int quarters = 0;

    while (part <= rest / 2) part += part;
    for (; part >= right_angle; part /= 2) {
        quarters = 2 * quarters & 3;
        if (rest < part) continue;
        rest -= part;
        ++quarters;
    }

    rbdi_w_series(rest, &sine, &cosine);
    *s = quarters & 1 ? cosine : sine;
    *c = quarters & 1 ? sine : cosine;
    if (((quarters & 2) != 0) != (x < 0)) *s = -*s;
    if ((quarters + 1) & 2) *c = -*c;
}

/* u = q, n numbers, of unit length; if q is shorter than 1e-15, component `one` is 1 and the others are 0. */
RBDI_LOCAL void rbdi_w_direction(const double *q, int n, int one, rbdi_wide *u) {
    rbdi_wide largest = 0, sum = 0, length;

    for (int k = 0; k < n; ++k)
        if (rbdi_w_abs(q[k]) > largest) largest = rbdi_w_abs(q[k]);
    for (int k = 0; k < n; ++k) u[k] = largest > 0 ? q[k] / largest : 0;
    for (int k = 0; k < n; ++k) sum += u[k] * u[k];
    length = RBDI_WIDE_LIBM(rbdi_root)(sum);

    if (largest * length < (rbdi_wide)1e-15) {
        for (int k = 0; k < n; ++k) u[k] = k == one;
        return;
    }

    for (int k = 0; k < n; ++k) u[k] /= length;
}

/* E of a turn about a unit vector n: c 1 + (1 - c) n n' - s [n]x (Rodrigues, transposed). */
RBDI_LOCAL void rbdi_w_turn(const rbdi_wide n[3], rbdi_wide c, rbdi_wide s, rbdi_wide E[9]) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        E[4 * i] = c + (1 - c) * n[i] * n[i];
        E[3 * i + j] = (1 - c) * n[i] * n[j] + s * n[k];
        E[3 * i + k] = (1 - c) * n[i] * n[k] - s * n[j];
    }
}

/* E of a quaternion (v; w) of any length: a turn about v with cosine w w - v'v and sine 2 w |v|. */
RBDI_LOCAL void rbdi_w_quaternion(const double *q, rbdi_wide E[9]) {
    rbdi_wide u[4], length;
    rbdi_w_direction(q, 4, 3, u);
    length = rbdi_w_length(u);
    for (int k = 0; k < 3 && length > 0; ++k) u[k] /= length;
    rbdi_w_turn(u, u[3] * u[3] - length * length, 2 * u[3] * length, E);
}

/* Motion of a link by its joint: its pose at q in its frame at q = 0. */
RBDI_LOCAL rbdi_wide_pose rbdi_axis_motion_at(const rbdi_build_link *l, const double *q) {
    rbdi_wide_pose X;
    rbdi_wide u[2], c, s;

    if (l->kind == RBDI_REVOLUTE_CS) {
        rbdi_w_direction(q, 2, 0, u);
        c = u[0];
        s = u[1];
    } else {
        rbdi_w_sincos(l->rho * q[l->iq], &s, &c);
    }

    rbdi_w_turn(l->axis, c, s, X.E);
    for (int k = 0; k < 3; ++k) X.r[k] = l->kappa * q[l->iq] * l->axis[k];
    return X;
}

RBDI_LOCAL rbdi_wide_pose rbdi_block_motion_at(int type, const double *q) {
    rbdi_wide_pose X;
    rbdi_wide c, s;

    rbdi_w_identity(X.E);
    for (int k = 0; k < 3; ++k) X.r[k] = type == RBD_SPHERICAL || (type == RBD_PLANAR && k == 2) ? 0 : q[k];
    if (type == RBD_SPHERICAL) rbdi_w_quaternion(q, X.E);
    if (type == RBD_FLOATING) rbdi_w_quaternion(q + 3, X.E);

    if (type == RBD_PLANAR) {
        rbdi_w_sincos(q[2], &s, &c);
        rbdi_w_turn_z(c, s, X.E);
    }

    return X;
}

/* Pose of a body in its parent at the coordinates q of its joint: that at q = 0, then the motion of each link
   that the joint has in the build. */
RBDI_LOCAL rbdi_wide_pose rbdi_body_pose_at(const rbd_body *b, const double *q) {
    rbd_body alone = *b;
    rbdi_build_link links[3];
    rbdi_place place;
    rbdi_build build;
    rbdi_wide_pose X;
    int n = 0;

    alone.parent = -1;
    place.iq = place.iv = 0;
    build.bodies = &alone;
    build.links = links;
    build.place = &place;
    rbdi_build_joint(&build, 0, &n);

    X = links[0].X;
    for (int k = 0; k < n; ++k) {
        const rbdi_wide_pose motion = links[k].kind == RBDI_BLOCK ? rbdi_block_motion_at(links[k].type, q)
                                                                  : rbdi_axis_motion_at(&links[k], q);
        X = rbdi_w_compose(&motion, &X);
    }

    return X;
}

/* Where the coordinates of body i begin in q. */
RBDI_LOCAL int rbdi_first_coordinate(const rbd_body *bodies, int i) {
    int iq = 0;
    for (int k = 0; k < i; ++k)
        if (!bodies[k].mimic) iq += rbdi_joint_facts((int)bodies[k].type)->nq;
    return iq;
}

/* The coordinates at q of body i's joint, of one that mimics from those of the joint that it follows; returns
   their number. */
RBDI_LOCAL int rbdi_own_coordinates(const rbd_body *bodies, int nb, int i, const double *q, double own[7]) {
    const rbd_body *b = &bodies[i];
    const int from = b->mimic ? rbdi_mimic_source(bodies, nb, i) : i;
    const int first = rbdi_first_coordinate(bodies, from), n = rbdi_joint_facts((int)b->type)->nq;
    for (int k = 0; k < n; ++k) own[k] = q[first + k];
    if (b->mimic) own[0] = b->mimic_ratio * own[0] + b->mimic_offset;
    return n;
}

/* Whether body i's joint shall be held: its flag is set, or that of the joint that it mimics. */
RBDI_LOCAL int rbdi_is_held(const rbd_body *bodies, int nb, int i, const unsigned char *locked) {
    if (bodies[i].type == RBD_FIXED) return 0;
    return locked[i] || (bodies[i].mimic && locked[rbdi_mimic_source(bodies, nb, i)]);
}

/* Makes the joint of a row fixed at its coordinates q. */
RBDI_LOCAL void rbdi_hold(rbd_body *row, const double *q) {
    const rbdi_wide_pose X = rbdi_body_pose_at(row, q);
    rbdi_wide R[9];

    rbdi_w_transpose(X.E, R);
    for (int k = 0; k < 9; ++k) row->rotation[k] = (double)R[k];

    for (int k = 0; k < 3; ++k) {
        row->position[k] = (double)X.r[k];
        row->axis[k] = row->axis2[k] = 0;
    }

    for (int k = 0; k < 6; ++k) row->armature[k] = row->damping[k] = row->friction[k] = 0;
    row->type = RBD_FIXED;
    row->pitch = row->lower = row->upper = row->velocity = row->effort = 0;
    row->mimic = NULL;
    row->mimic_ratio = row->mimic_offset = 0;
}

RBDI_API rbd_status rbd_lock_joints(const rbd_body *bodies, int nb, const unsigned char *locked,
                                    const double *q, rbd_body *rows, rbd_report *report) {
    rbd_report own;
    double x[7];

    if (!report) report = &own;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);

    if (!bodies || !locked || !q || !rows) return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (nb < 1 || nb > RBD_MAX_BODIES) return rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);

    for (int i = 0; i < nb; ++i) {
        const rbd_status status = rbdi_check_body(bodies, nb, i, report);
        if (status) return status;
    }

    for (int i = 0; i < nb; ++i) {
        if (!rbdi_is_held(bodies, nb, i, locked)) continue;
        if (rbdi_finite(x, rbdi_own_coordinates(bodies, nb, i, q, x))) continue;
        return rbdi_refuse_saying(report, RBD_ERR_RANGE, i, bodies[i].name, "q",
                                  "a coordinate of its joint, which shall be held, is not finite");
    }

    /* Followers first, then from the last to the first: of each row those that it depends on are still as
       they were, even if rows is bodies. */
    for (int i = 0; i < nb; ++i) rows[i] = bodies[i];

    for (int followers = 1; followers >= 0; --followers)
        for (int i = nb - 1; i >= 0; --i) {
            if ((rows[i].mimic != NULL) != followers || !rbdi_is_held(rows, nb, i, locked)) continue;
            (void)rbdi_own_coordinates(rows, nb, i, q, x);
            rbdi_hold(&rows[i], x);
        }

    return RBD_OK;
}

/* ==== src/rbd.h ==== */
#endif /* RBD_NO_BUILD */

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("B")
#pragma pop_macro("C")
#pragma pop_macro("D")
#pragma pop_macro("E")
#pragma pop_macro("F")
#pragma pop_macro("G")
#pragma pop_macro("H")
#pragma pop_macro("I")
#pragma pop_macro("J")
#pragma pop_macro("K")
#pragma pop_macro("L")
#pragma pop_macro("M")
#pragma pop_macro("N")
#pragma pop_macro("O")
#pragma pop_macro("P")
#pragma pop_macro("R")
#pragma pop_macro("S")
#pragma pop_macro("T")
#pragma pop_macro("U")
#pragma pop_macro("V")
#pragma pop_macro("X")
#pragma pop_macro("Y")
#pragma pop_macro("Z")

/* ==== src/rbd.h ==== */
/* ---- licence [licence] ----

   MIT License

   Copyright (c) 2026 the rbd authors

   Permission is hereby granted, free of charge, to any person obtaining a copy
   of this software and associated documentation files (the "Software"), to deal
   in the Software without restriction, including without limitation the rights
   to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
   copies of the Software, and to permit persons to whom the Software is
   furnished to do so, subject to the following conditions:

   The above copyright notice and this permission notice shall be included in all
   copies or substantial portions of the Software.

   THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
   IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
   FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
   AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
   LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
   OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
   SOFTWARE.
*/
