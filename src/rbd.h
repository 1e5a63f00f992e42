/* rbd.h - rigid-body dynamics of robots, in one C99 header. Version 0.4.0.
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

#include "api/configuration.h"

RBDI_EXTERN_C_BEGIN

#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"
#include "api/model.h"
#include "api/dynamics.h"
#include "api/kinematics.h"
#include "api/points.h"
#include "api/manifold.h"
#include "api/lookup.h"

RBDI_EXTERN_C_END

#endif /* RBD_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* Below, names of one letter are those of the formulas. The caller's macros of these names (I of complex.h, F
   of Arduino) are set aside, and restored at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_LAYOUT
#define RBDI_LAYOUT

#include "base/types.h"
#include "algebra/types.h"
#include "model/layout.h"
#include "model/work.h"

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

#include "base/compiler.h"

RBDI_CODE_BEGIN

#include "base/tolerances.h"
#include "base/scalar.h"
#include "base/simd.h"
#include "base/reduction.h"
#include "base/sincos.h"
#include "algebra/vectors.h"
#include "algebra/spatial.h"
#include "algebra/rotations.h"

RBDI_CODE_END
#endif
#endif

#if defined RBD_IMPLEMENTATION && !defined RBDI_IMPLEMENTED
#define RBDI_IMPLEMENTED
RBDI_CODE_BEGIN

#include "base/pieces.h"
#include "base/memory.h"
#include "model/features.h"
#include "model/joint_types.h"
#include "model/calls.h"

RBDI_CODE_END
RBDI_DYNAMICS_BEGIN

#include "model/joints.h"
#include "model/limits.h"
#include "dynamics/state.h"
#include "dynamics/rnea.h"
#include "dynamics/crba.h"
#include "dynamics/aba_elimination.h"
#include "dynamics/aba.h"
#include "dynamics/row_sums.h"
#include "dynamics/packed.h"
#include "dynamics/pivots.h"
#include "dynamics/aba_pivots.h"
#include "dynamics/hybrid.h"
#include "dynamics/forward.h"

RBDI_CODE_END
RBDI_CODE_BEGIN

#include "motion/axes.h"
#include "motion/kinematics.h"
#include "motion/points.h"
#include "motion/manifold.h"
#include "motion/step.h"
#include "motion/free_step.h"
#include "model/work_init.h"
#include "model/lookup.h"
#include "model/text.h"

RBDI_CODE_END
RBDI_BUILD_BEGIN

#include "model/wide.h"

#ifndef RBD_NO_BUILD
#include "model/describe.h"
#include "model/check.h"
#include "model/links.h"
#include "model/regroup.h"
#include "model/emit.h"
#include "model/build.h"
#include "model/payload.h"
#include "model/lock.h"
#endif /* RBD_NO_BUILD */

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#include "base/letters_end.h"

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
