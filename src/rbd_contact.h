/* rbd_contact.h - contacts that push only and slip: a time step of a simulation, on rbd_constraints.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Points and balls on bodies touch planes of the world or of other bodies, with friction. A step finds the
   impulses by the exact laws of Signorini and Coulomb, with those of joint limits, of dry friction of joints
   and of bounded rows of yours, and moves the robot. Implemented by the same RBD_IMPLEMENTATION as rbd.h, in
   the same file. A box of which two corners may touch the ground:

       #define RBD_IMPLEMENTATION
       #include "rbd_contact.h"

       const rbd_contact corners[2] = {
           {.body1 = 0, .body2 = -1, .point = {0.2, 0.1, -0.1}, .friction = 0.5},
           {.body1 = 0, .body2 = -1, .point = {0.2, -0.1, -0.1}, .friction = 0.5}};
       size_t size = rbd_contact_set_size(m, 2, NULL, 0, NULL);
       rbd_contact_set *c;
       rbd_contact_set_init(m, w, corners, 2, NULL, 0, NULL, malloc(size), size, &c, NULL);
       for (int i = 0; i < 1000; i++)
           rbd_contact_step(m, c, q, v, tau, NULL, NULL, 1e-3, q, v);

   CONTENTS (search for the tag)
     [conventions] [configuration] [limits]
     [solver] [set] [step] [step derivatives]
     --- stop here if you only use it ---
     [layout] [tolerances] [one contact] [laws] [newton] [solver code]
     [joints] [bounded rows] [set code] [contact rows] [biases] [row reduction]
     [momentum code] [step code]
     [step derivatives code]

   [conventions] Beyond those of rbd.h:
     u            velocity of body 1's point of contact less that of body 2's at this place, m/s
     place        of contact: the point, or that of the ball next to the plane; where three contacts or more
                  of the same two bodies touch, its foot on the plane
     p            impulse on body 1 at this place, N s; the opposite acts on body 2
     rows         of a contact: two tangents, then the normal, out of body 2 into body 1
     gap          distance of point or ball from the plane, m; below 0 in penetration
     laws         normal: p_n >= 0, u_n >= 0, p_n u_n = 0; friction: |p_t| <= mu p_n, and where a contact
                  slips u_t = -alpha p_t, alpha > 0, |p_t| = mu p_n. Stewart and Trinkle (1996), Anitescu and
                  Potra (1997), here with the round cone. Of a bounded row: lower <= p <= upper; u > 0 only
                  at the lower bound, u < 0 only at the upper one

   [configuration] That of rbd.h, without RBD_NO_CHOLESKY, RBD_LANES and RBD_REAL_CUSTOM: the solver branches
     on its data.

   [limits]
     No collision detection, no rolling and torsional friction, no batches; planes are infinite. Convergence
     of the solver is not proven, nor is the solution unique where friction is large; the residual says what
     was reached. The step is of second order between impacts, of first order in impacts, in dampers and in
     what a controller samples. Energy is made by O(dt^2) at most, some 1e-6 of it at 1 ms, but for rebounds
     with friction: they follow Newton's law, which may gain energy in known examples.
*/
#include "rbd_constraints.h"

#ifndef RBD_CONTACT_H
#define RBD_CONTACT_H

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_contact.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/contact.h"

RBDI_EXTERN_C_END

#endif /* RBD_CONTACT_H */

#if defined RBD_DERIVATIVES_H && !defined RBDI_CONTACT_DERIVATIVES
#define RBDI_CONTACT_DERIVATIVES
RBDI_EXTERN_C_BEGIN

#include "api/contact_derivatives.h"

RBDI_EXTERN_C_END
#endif

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_CONTACT_LAYOUT
#define RBDI_CONTACT_LAYOUT

#include "contact/layout.h"

#endif /* RBDI_CONTACT_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_CONTACT_IMPLEMENTED && !defined RBDI_JOINS_DERIVATIVES
#define RBDI_CONTACT_IMPLEMENTED

RBDI_CODE_BEGIN

#include "contact/tolerances.h"
#include "contact/one_contact.h"
#include "contact/laws.h"
#include "contact/newton.h"
#include "contact/solver.h"
#include "contact/joints.h"
#include "contact/bounded.h"
#include "contact/set.h"
#include "contact/rows.h"
#include "contact/biases.h"
#include "contact/reduction.h"
#include "contact/momentum.h"
#include "contact/step.h"

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#if defined RBD_IMPLEMENTATION && defined RBDI_CONTACT_IMPLEMENTED && defined RBDI_CONTACT_DERIVATIVES && \
    !defined RBDI_CONTACT_DERIVATIVES_IMPLEMENTED
#define RBDI_CONTACT_DERIVATIVES_IMPLEMENTED

RBDI_CODE_BEGIN

#include "contact/rho.h"
#include "contact/sigma.h"
#include "contact/derivatives.h"

RBDI_CODE_END

#endif

#include "base/letters_end.h"
