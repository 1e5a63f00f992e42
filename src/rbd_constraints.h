/* rbd_constraints.h - contacts, closed loops and impacts, on rbd.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   A set of constraints is described and checked once. One call then gives accelerations and constraint
   forces, another one the velocities after an impact. Implemented by the same RBD_IMPLEMENTATION as rbd.h,
   in the same file. A foot that stands:

       #define RBD_IMPLEMENTATION
       #include "rbd_constraints.h"

       const double foot[3] = {0.33, 0, 0};
       rbd_constraint rows[1] = {rbd_point_contact(rbd_body_index(m, "lf_lowerleg"), foot, NULL)};
       unsigned char memory[RBD_CONSTRAINT_SET_SIZE(NV, 3)];
       rbd_constraint_set *c;
       rbd_constraint_set_init(m, w, rows, 1, memory, sizeof memory, &c, NULL);
       rbd_constrained_fd(m, c, q, v, tau, NULL, a, lambda);

   CONTENTS (search for the tag)
     [conventions] [configuration] [limits]
     [description] [set] [calls] [derivatives]
     --- stop here if you only use it ---
     [layout]
     [design] [tolerances] [kinematics] [rows] [factor] [rank] [solution]
     [refinement] [articulated]
     [call code] [weights] [assembly] [set code] [derivatives code]

   [conventions] Beyond those of rbd.h:
     frames       frame 1 is fixed in body 1, frame 2 in body 2, which may be the world. R_1, p_1, w_1, v_1
                  are the orientation and origin of frame 1 in the world, its angular velocity and that of its
                  origin; E = R_2' turns world vectors into the axes of frame 2; s = p_1 - p_2
     position     R = E R_1, r = E s: frame 1 seen from frame 2
     velocity     (E (w_1 - w_2); dr/dt), dr/dt = E (v_1 - v_2 - w_2 x s)
     rows         the components of the velocity whose axes are held, in the order omega_x .. v_z, constraint
                  after constraint: J v
     gamma        dJ/dt v: J a + gamma is the time derivative of J v, on the constraint and off it
     e            the position error. For linear rows it is r, and its rate is J v. For three angular axes
                  it is log R, for two z x (R z), z the unit vector of the free axis; their rate is J v at
                  e = 0. For a single angular axis it is its component of log R, useful for small turns only
     lambda       (moment about the origin of frame 1; force) in the axes of frame 2 that body 2 puts on body
                  1, the held components; the opposite acts on body 2, at the same place: J' lambda

   [configuration] That of rbd.h, without RBD_NO_CHOLESKY.

   [limits]
     A constraint pulls as well as it pushes. rbd_contact.h has contacts that open and slip, with friction.
     Constraints of velocities alone (rolling, knife edges) are not described. M must be regular, also where
     the constraints would make up for it.
*/
#include "rbd.h"
#if defined RBD_DERIVATIVES_H && !defined RBDI_JOINS_DERIVATIVES /* implemented with it: [derivatives] */
#include "rbd_derivatives.h"
#endif

#ifndef RBD_CONSTRAINTS_H
#define RBD_CONSTRAINTS_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_constraints.h is of another version than rbd.h"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/constraints.h"

RBDI_EXTERN_C_END

#endif /* RBD_CONSTRAINTS_H */

#if defined RBD_DERIVATIVES_H && !defined RBD_NO_CHOLESKY && !defined RBDI_CONSTRAINED_DERIVATIVES
#define RBDI_CONSTRAINED_DERIVATIVES
RBDI_EXTERN_C_BEGIN

#include "api/constrained_derivatives.h"

RBDI_EXTERN_C_END
#endif

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_CONSTRAINTS_LAYOUT
#define RBDI_CONSTRAINTS_LAYOUT

#include "constraints/layout.h"

#endif /* RBDI_CONSTRAINTS_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_CONSTRAINTS_IMPLEMENTED && !defined RBDI_JOINS_DERIVATIVES
#define RBDI_CONSTRAINTS_IMPLEMENTED

/* ---- design [design] ----
   There are two ways. Dynamics and impacts use articulated bodies, [articulated]: the work grows with the
   links, and with the lengths of the paths times the squares of their rows. The factor of M costs the squares
   of the paths as well. It serves derivatives, models with mimic joints, sets with more rows than can be
   independent, and each state in which a pivot of the other way is in doubt; [rank] then decides which rows
   are independent.
   HyQ on four points and Atlas on two flat feet, 12 rows each, instructions (gcc 12, -O3 -march=haswell):

                               HyQ     Atlas
       rbd_aba                8394     17426
       articulated bodies    18602     27733
       factor of M           25854     45899

   By the factor: the two equations, with M = L'DL ([packed matrix] of rbd.h), Y = L^-T J' and
   z = D^-1 L^-T (tau - c):

       Delta lambda = r - gamma - Y'z,   Delta = J M^-1 J' = Y' D^-1 Y        r: the wanted J a + gamma
       L a = z + D^-1 Y lambda

   Row k of Y is that of dof k, its columns are the rows of the constraints, so that the entries of one dof
   are contiguous and loops run over batches of rows. A dof has entries only in rows of constraints on a body
   that it moves: its span.

   Gains in time steps. Along a row, de/dt = u = J v and du/dt = -kd u - kp e. Semi-implicit steps make of it

       u+ = (1 - kd dt) u - kp dt e,   e+ = e + dt u+

   whose eigenvalues z solve z^2 - (2 - kd dt - kp dt^2) z + 1 - kd dt = 0. By Jury's test both lie within the
   unit circle if kd dt < 2, kp > 0, kd > 0 and, at z = -1, 4 - 2 kd dt - kp dt^2 > 0. */

RBDI_CODE_BEGIN

#ifdef RBD_NO_CHOLESKY
#error "rbd: rbd_constraints.h needs RBD_NO_CHOLESKY undefined"
#endif

#include "constraints/tolerances.h"
#include "constraints/kinematics.h"
#include "constraints/rows.h"
#include "constraints/factor.h"
#include "constraints/rank.h"
#include "constraints/solution.h"
#include "constraints/refinement.h"
#include "constraints/articulated.h"
#include "constraints/calls.h"
#include "constraints/weights.h"
#include "constraints/assembly.h"

#include "constraints/set.h"

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#if defined RBD_IMPLEMENTATION && defined RBDI_CONSTRAINTS_IMPLEMENTED && \
    defined RBDI_CONSTRAINED_DERIVATIVES && !defined RBDI_CONSTRAINED_DERIVATIVES_IMPLEMENTED
#define RBDI_CONSTRAINED_DERIVATIVES_IMPLEMENTED

RBDI_CODE_BEGIN

#include "constraints/derivatives.h"

RBDI_CODE_END

#endif

#include "base/letters_end.h"
