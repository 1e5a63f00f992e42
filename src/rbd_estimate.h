/* rbd_estimate.h - what a robot learns about itself: external torques, friction and payload, on rbd.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   A momentum observer feels what pushes a robot, from motors and encoders alone. A recursive estimate finds
   the friction of each joint and the payload of the hand, one sample a tick, as a body that can exist at each
   tick. For all joint types, floating bases and mimic joints; each call takes constant time. Implemented by
   the same RBD_IMPLEMENTATION as rbd.h, in the same file. An alarm of an arm of 7 joints:

       #define RBD_IMPLEMENTATION
       #include "rbd_estimate.h"

       const rbd_observer_options options = {.gain = 40, .share = 0.2, .least = 0.5, .friction = friction};
       static unsigned char memory[RBD_OBSERVER_SIZE(7)];
       rbd_observer *observer;
       rbd_observer_init(m, &options, memory, sizeof memory, &observer, NULL);
       // each tick:
       rbd_observer_step(m, w, observer, q, v, tau, dt, r, band, NULL);
       for (int i = 0; i < 7; i++) if (fabs(r[i]) > band[i]) stop();

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [friction] [observer] [estimate]
     --- stop here if you only use it ---
     [method] [triangles] [estimate checks] [observer code] [pseudo-inertia] [samples] [newton]
     [friction code] [estimate code] [estimate text]

   [conventions] Those of rbd.h. Friction acts against the motor: tau = rbd_rnea + friction. In floating
     joints there is none.

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it: it branches on its data.

   [guarantees]
     Input that is refused changes nothing. Finite input gives finite output, or an error. A payload is always
     physical: mass above 0 and a positive definite pseudo-inertia; Coulomb and viscous friction are 0 or
     more. The bits are the same on every machine with RBD_REPRODUCIBLE.

   [limits]
     At rest friction hides every torque below it from the observer, and all samples from the estimate. The
     payload shows only in motions that excite it: rbd_estimate_deviations says how well. Friction is Coulomb,
     viscous and an offset. One payload, of one body. Errors of the model itself go to both. A change of the
     payload that nobody tells is forgotten with the samples; rbd_estimate_grip is quicker.
     Where samples tell little of the payload, as of an empty hand, rbd_estimate_solve takes some twenty times
     as long as else, and fifty at most; call rbd_estimate_release for an empty hand.
*/
#include "rbd_derivatives.h"

#ifndef RBD_ESTIMATE_H
#define RBD_ESTIMATE_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_estimate.h is of another version than rbd.h"
#endif

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_estimate.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/estimate.h"

RBDI_EXTERN_C_END

#endif /* RBD_ESTIMATE_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_ESTIMATE_LAYOUT
#define RBDI_ESTIMATE_LAYOUT

#include "estimate/layout.h"

#endif /* RBDI_ESTIMATE_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_ESTIMATE_IMPLEMENTED
#define RBDI_ESTIMATE_IMPLEMENTED

RBDI_CODE_BEGIN

#include "estimate/triangles.h"
#include "estimate/check.h"
#include "estimate/observer.h"
#include "estimate/pseudo_inertia.h"
#include "estimate/samples.h"
#include "estimate/newton.h"
#include "estimate/friction.h"
#include "estimate/estimate.h"
#include "estimate/text.h"

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#include "base/letters_end.h"
