/* rbd_actuator.h - what stands between a motor's command and a joint's torque, on rbd.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Motors with limits and heat, drives, gears with friction, springs and play, transmissions by matrix or
   rods, as const tables. One way for controllers: from wanted joint torques to currents. The other way for
   simulations: from commands to joint torques. Implemented by the same RBD_IMPLEMENTATION as rbd.h, in the
   same file. The currents that move an arm as planned:

       #define RBD_IMPLEMENTATION
       #include "rbd_actuator.h"

       static const rbd_motor motors[2] = {
           {.joint = "shoulder", .gear = 50, .constant = RBD_C(0.06), .inertia = RBD_C(1e-5),
            .friction = {.coulomb = RBD_C(0.4), .viscous = RBD_C(0.1)}},
           {.joint = "elbow", .gear = 30, .constant = RBD_C(0.06), .inertia = RBD_C(1e-5),
            .friction = {.coulomb = RBD_C(0.2), .viscous = RBD_C(0.05)}}};
       static unsigned char memory[RBD_ACTUATORS_SIZE(2, 0, 0)];
       rbd_actuators *a;
       rbd_drive drives[2];
       rbd_actuators_init(m, motors, 2, NULL, 0, memory, sizeof memory, &a, &report);

       rbd_rnea(m, w, q, v, acc, NULL, tau);   // of the plan
       rbd_actuators_inverse(a, q, v, acc, tau, drives);
       send(drives[0].current, drives[1].current);

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [tables] [actuators] [inverse] [forward] [rotors]
     --- stop here if you only use it ---
     [method] [exponential] [friction code] [motor code] [cogging] [drive code] [rods] [transmission code]
     [inverse code] [laws of shafts] [search] [coupled shafts] [foretelling] [learning] [forward code]
     [derivatives code] [checks] [tables code] [rotors code] [text code]

   [conventions] Those of rbd.h, beyond them:
     shaft        the output of one motor's gear, in the data sheet's coordinate. Its angle times gear is the
                  rotor's. Torques, speeds, friction and gains of a motor are those at its shaft
     joint side   of a shaft: behind its spring, or the shaft itself if it is rigid. Without a transmission it
                  is the joint, with the same sign
     rigid        without a stiffness

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it: friction branches on its
     data. With __float128 the part of friction at rest has the accuracy of double.

   [guarantees]
     Finite input gives finite output. Friction, springs and play add no energy in a step that settles,
     whatever its order and length are, but for rounding. No motor passes its limits at the step's end. A
     rotor that friction holds on a spring stays to the bit. The bits are the same on every machine with
     RBD_REPRODUCIBLE.

   [limits]
     A rigid shaft that its friction holds creeps by 1e-9 rad/s at most (float: 1e-6), in the step that stops
     it also by a rounding of its speed, 2e-15 of it (float: 1e-6), in the step in which it turns back by a
     thousandth, or gives way as its bristle says. The level of friction is that of the state before a step,
     and of the loads of the last one. Steps settle by repeats, of which there are 50 at most: then the last
     speeds count, which are finite, and some shaft has not the torque of its law. Cogging gives its own
     height of energy at most while teeth gear^2 cogging dt^2 is below twice the inertia that the shaft moves,
     and a drive's kd up to dt kd v^2 / 8, v the speed before, in a step of second order in which a shaft
     turns around. Not here: inductance, whose time constant is a millisecond or less, and the dynamics of the
     current's loop, rods with mass, tendons with slack, hysteresis of strain-wave gears, friction by
     temperature. That actuators belong to another robot cannot be seen: no call but the first takes a model.
*/
#include "rbd.h"

#ifndef RBD_ACTUATOR_H
#define RBD_ACTUATOR_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_actuator.h is of another version than rbd.h"
#endif

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_actuator.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/actuator.h"

RBDI_EXTERN_C_END

#endif /* RBD_ACTUATOR_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_ACTUATOR_LAYOUT
#define RBDI_ACTUATOR_LAYOUT

#include "actuator/layout.h"

#endif /* RBDI_ACTUATOR_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_ACTUATOR_IMPLEMENTED
#define RBDI_ACTUATOR_IMPLEMENTED

RBDI_CODE_BEGIN

#include "actuator/exponential.h"
#include "actuator/friction.h"
#include "actuator/motor.h"
#include "actuator/rods.h"
#include "actuator/transmission.h"
#include "actuator/inverse.h"
#include "actuator/laws.h"
#include "actuator/search.h"
#include "actuator/coupled.h"
#include "actuator/learning.h"
#include "actuator/step.h"
#include "actuator/derivatives.h"
#include "actuator/check.h"
#include "actuator/init.h"
#include "actuator/rotor.h"
#include "actuator/text.h"

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#include "base/letters_end.h"
