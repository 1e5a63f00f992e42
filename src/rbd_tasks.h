/* rbd_tasks.h - whole-body control: tasks, contacts and limits in one QP, on rbd.h, rbd_ik.h and rbd_qp.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Finds, at each tick of a controller, the velocities or the accelerations, contact forces and torques that do
   what tasks ask for as well as contacts, friction and limits allow; for all joint types, floating and fixed
   bases, and mimic joints. Implemented by the same RBD_IMPLEMENTATION as rbd.h, in the same file. A robot on
   four feet that holds its trunk still:

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
           status = rbd_tasks_acceleration(m, w, &problem, q, v, memory, sizeof memory, a, forces, tau, &result);
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
     level        tasks of level 0 count first, by weights among themselves; those of level 1 have what is left
     hard, soft   what must hold; what may be missed at a cost

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it.

   [guarantees]
     No allocation. With RBD_TASKS_OK all contacts are held, all limits kept and all equations of motion solved
     to result->primal. Below 0 outputs stay as they were. Outputs are finite. The bits are the same on every
     machine with RBD_REPRODUCIBLE.

   [limits]
     The work of a tick is that of a QP of nv + 3 contacts variables a level: see rbd_qp.h.
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
