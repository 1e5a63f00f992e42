/* rbd_tasks.h - whole-body control: tasks, contacts and limits in one QP, on rbd.h, rbd_ik.h and rbd_qp.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Finds, at each tick of a controller, the velocities, or the accelerations with contact forces and torques,
   that do what tasks ask for as well as contacts, friction and limits allow. For all joint types, floating
   and fixed bases, and mimic joints. Implemented by the same RBD_IMPLEMENTATION as rbd.h, in the same file. A
   robot on four feet that holds its trunk still:

       #define RBD_IMPLEMENTATION
       #include "rbd_tasks.h"

       const rbd_task wishes[2] = {
           {.kind = RBD_TASK_POSE, .body = 0, .position = {0, 0, 0.6}, .gain = 10},
           {.kind = RBD_TASK_POSTURE, .q = home, .gain = 10, .weight = 1e-3}};
       rbd_task_contact feet[4] = {{.body = 4, .point = {0.33, 0, 0}, .friction = 0.6}, ...};
       rbd_tasks problem = {.task = wishes, .tasks = 2, .contact = feet, .contacts = 4, .dt = 1e-3};
       static unsigned char memory[RBD_TASKS_SIZE(NV, 6 + NV, 4, 0)];
       rbd_tasks_result result;
       for (;;) {   // each millisecond
           status = rbd_tasks_acceleration(m, w, &problem, q, v, memory, sizeof memory, a, f, tau, &result);
           problem.warm = status >= 0;
           if (status < 0) puts(rbd_tasks_text(status, &result, text, sizeof text));
       }

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [tasks] [problem of tasks] [solve of tasks]
     --- stop here if you only use it ---
     [method of tasks] [limits of motion] [checks of tasks] [contacts and dynamics] [rows of tasks] [levels]
     [contradictions] [code of tasks] [text of tasks]

   [conventions] Those of rbd.h and rbd_qp.h, beyond them:
     x            velocities; or accelerations, then forces of closed contacts
     level        tasks of level 0 come first, by weights among themselves; level 1 has what they leave
     hard, soft   what must hold; what may be missed at a cost

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it.

   [guarantees]
     Those of rbd.h: no allocation, reentrant. With RBD_TASKS_OK contacts are held, hard limits kept and the
     equations of motion solved to result->primal, a share of each row's terms that is at most 1e-7 (float
     1e-3), and mostly some roundings. With a status below 0 all outputs stay as they were. Outputs are
     finite. The bits are the same on every machine with RBD_REPRODUCIBLE.

   [limits]
     A tick costs kinematics, the mass matrix, a Jacobian for each task and contact, and a QP of nv + 3
     contacts variables for each level: see rbd_qp.h; the option `steps` bounds it. A level misses what it
     could do by what motion_cost and force_cost take: a share of some motion_cost / weight. Tasks in float
     should differ by at most three decades in weight; levels are better, and a momentum, whose rows are as
     large as masses, is best with a weight of 1 / mass^2. Friction of contacts is that of
     points: a flat foot has several, and their forces share its torsion. Contacts may contradict each other
     or limits, as where a joint is at its stop: RBD_TASKS_INFEASIBLE. Soft limits, an open contact or a lower
     `least` help. Closed loops of rbd_constraints.h are not known here; RBD_TASK_ROWS can state them softly.
     Passive joints other than floating ones must be named. Velocities look one tick ahead: they may end where
     another posture would reach further, which rbd_ik finds.
*/
#include "rbd_ik.h"
#include "rbd_qp.h"

#ifndef RBD_TASKS_H
#define RBD_TASKS_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_tasks.h is of another version than rbd.h"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/tasks.h"

RBDI_EXTERN_C_END

#endif /* RBD_TASKS_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_TASKS_LAYOUT
#define RBDI_TASKS_LAYOUT

#include "tasks/layout.h"

#endif /* RBDI_TASKS_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_TASKS_IMPLEMENTED
#define RBDI_TASKS_IMPLEMENTED

RBDI_CODE_BEGIN

#include "tasks/bounds.h"
#include "tasks/check.h"
#include "tasks/contacts.h"
#include "tasks/rows.h"
#include "tasks/levels.h"
#include "tasks/blame.h"
#include "tasks/solve.h"
#include "tasks/text.h"

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#include "base/letters_end.h"
