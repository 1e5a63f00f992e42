/* rbd_ik.h - inverse kinematics: joint positions for a tool, feet or a centre of mass, on rbd.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Finds joint positions within the joints' limits for which points, poses and axes of bodies, and the centre
   of mass, are where they shall be; for all joint types, floating bases and mimic joints. Implemented by the
   same RBD_IMPLEMENTATION as rbd.h, in the same file. A tool, 0.1 m in front of the last link of an arm:

       #define RBD_IMPLEMENTATION
       #include "rbd_ik.h"

       const rbd_ik_target tool = {.kind = RBD_IK_POSE, .body = 6, .point = {0, 0, 0.1},
                                   .position = {0.5, 0.2, 0.4}, .rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1}};
       static unsigned char memory[RBD_IK_SIZE(7, 7, 1)];
       rbd_ik_result result;
       double q[7] = {0};   // where the robot is
       rbd_ik_status status = rbd_ik(m, w, &tool, 1, NULL, memory, sizeof memory, q, &result);
       if (status != RBD_IK_REACHED) puts(rbd_ik_text(status, &result, text, sizeof text));

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [targets] [inverse kinematics]
     --- stop here if you only use it ---
     [method] [step] [targets code] [curvature] [dofs] [search] [checks]
     [inverse kinematics code] [text code]

   [conventions] Those of rbd.h, beyond them:
     target       a point, rotation or axis of a body in the world; all rows of all targets count together
     limits       of joints with one dof, as rbd_joint has them. A mimic joint's limits bind what it follows,
                  but those that leave it nothing do not count
     angle        of a rotation: that of the shortest turn; of an axis: that to its direction

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it: the search branches on its
     data.

   [guarantees]
     Deterministic: starts come from a fixed sequence. RBD_IK_ERROR leaves q as it was. With any other status
     q is finite, and the joints that it moved are within their limits, to the bit; mimic joints to rounding.
     RBD_IK_REACHED says that the errors at q were computed and are within the tolerances. The bits are the
     same on every machine with RBD_REPRODUCIBLE.

   [limits]
     An evaluation costs kinematics, a Jacobian and the solution of a linear system; the option `evaluations`
     bounds their number. Poses in reach of an arm take 15 to 25 in the mean and some hundred at worst, as
     ./run fuzz --ik counts. That a target is out of reach is known after all starts and descents: a thousand.
     That no place is nearer is not proven, nor that a target that is not reached cannot be. A redundant arm
     may take any of its postures. Where limits are wide, starts are within a turn, or 10 times `length` of a
     slide, of the caller's q. No collisions. Robots need no masses, but for their centre of mass:
     rbd_model_build_kinematic builds one without.
*/
#include "rbd.h"

#ifndef RBD_IK_H
#define RBD_IK_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_ik.h is of another version than rbd.h"
#endif

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_ik.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/ik.h"

RBDI_EXTERN_C_END

#endif /* RBD_IK_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_IK_LAYOUT
#define RBDI_IK_LAYOUT

#include "ik/layout.h"

#endif /* RBDI_IK_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_IK_IMPLEMENTED
#define RBDI_IK_IMPLEMENTED

RBDI_CODE_BEGIN

#include "ik/step.h"
#include "ik/targets.h"
#include "ik/curvature.h"
#include "ik/dofs.h"
#include "ik/search.h"
#include "ik/check.h"
#include "ik/solve.h"
#include "ik/text.h"

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#include "base/letters_end.h"
