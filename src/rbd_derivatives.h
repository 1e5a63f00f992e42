/* rbd_derivatives.h - momentum and Coriolis matrix and first derivatives of a robot's dynamics, for rbd.h.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   All calls support every joint type, external wrenches, rotors, mimic joints and several roots. Include it
   as rbd.h: in ONE file

       #define RBD_IMPLEMENTATION
       #include "rbd_derivatives.h"

   and plain #include "rbd_derivatives.h" everywhere else; it includes rbd.h. [conventions], [configuration]
   and [guarantees] are those of rbd.h. Derivatives of the inverse dynamics at a state:

       unsigned char memory[RBD_DERIVATIVES_SIZE(NB, NV)];
       rbd_derivatives *d;
       rbd_derivatives_init(m, w, memory, sizeof memory, &d);
       rbd_id_derivatives(m, d, q, v, a, NULL, dtau_dq, dtau_dv, NULL);

   CONTENTS (search for the tag)
     [memory] [momentum] [jacobians] [coriolis] [free base] [inverse dynamics] [forward dynamics]
     [identification] [steps]
     --- stop here if you only use it ---
     [layout]
     [common frame] [batches] [common motion] [subtrees] [entries] [base entries] [matrices] [memory code]
     [momentum code] [coriolis code] [jacobians code]
     [free base code] [inverse dynamics code] [forward dynamics code] [identification code] [steps code]

   Begin with [common frame]: it has the formulas, and the fields of rbdi_columns are their numbers. Two
   sweeps fill these for every call: [common motion] from the roots to the leaves, [subtrees] back. Each
   call is then a loop over the columns.
*/
#include "rbd.h"

#ifndef RBD_DERIVATIVES_H
#define RBD_DERIVATIVES_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd_derivatives.h: belongs to another version of rbd.h"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/derivatives.h"

RBDI_EXTERN_C_END

#endif /* RBD_DERIVATIVES_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#ifndef RBDI_DERIVATIVES_LAYOUT
#define RBDI_DERIVATIVES_LAYOUT

#include "derivatives/layout.h"

#endif /* RBDI_DERIVATIVES_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_DERIVATIVES_IMPLEMENTED
#define RBDI_DERIVATIVES_IMPLEMENTED

RBDI_CODE_BEGIN

#include "algebra/batch_vectors.h"
#include "derivatives/columns.h"
#include "derivatives/common_frame.h"
#include "derivatives/subtrees.h"
#include "derivatives/entries.h"
#include "derivatives/base_entries.h"
#include "derivatives/memory.h"
#include "derivatives/momentum.h"
#include "derivatives/jacobians.h"
#include "derivatives/free_base.h"
#include "derivatives/solve_two.h"
#include "derivatives/dynamics.h"
#include "derivatives/regressors.h"
#include "derivatives/steps.h"

RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#include "base/letters_end.h"

/* Headers that stand before this one declare their derivatives now. They implement them if they themselves
   are implemented in this file. */
#ifndef RBDI_JOINS_DERIVATIVES
#define RBDI_JOINS_DERIVATIVES
#if defined RBD_CONTACT_H && !defined RBDI_CONTACT_DERIVATIVES
#include "rbd_contact.h"
#elif defined RBD_CONSTRAINTS_H && !defined RBDI_CONSTRAINED_DERIVATIVES
#include "rbd_constraints.h"
#endif
#undef RBDI_JOINS_DERIVATIVES
#endif
