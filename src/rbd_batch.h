/* rbd_batch.h - many states at once, in the lanes of SIMD instructions, for rbd.h and the headers on it.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Each call computes n states, RBD_LANES of them by each instruction, from and to ordinary arrays. A separate
   file implements the calls, compiled for the SIMD unit that is there:

       #define RBD_LANES 8               (double: 8 with AVX-512, 4 with AVX, 2 else; float: twice that)
       #define RBD_BATCH_IMPLEMENTATION
       #include "rbd_batch.h"

   Other files include rbd_batch.h without these macros; one of them implements rbd.h. Where rbd_derivatives.h
   or rbd_constraints.h is included before rbd_batch.h, its batch calls are declared, and implemented, too.
   Forward dynamics of 1000 states:

       rbd_batch *b;
       rbd_batch_init(m, memory, rbd_batch_size(m), &b);
       rbd_batch_aba(m, b, 1000, q, v, tau, NULL, a);

   CONTENTS (search for the tag)
     [conventions]
     [batch] [derivatives] [constraints]
     --- stop here if you only use it ---
     [lanes] [tasks] [batch code] [derivatives code] [constraints code]

   [conventions] Beyond those of rbd.h:
     states       n states are one after the other, unless rbd_batch_set_layout changes this: q is n x nq,
                  v, a, tau n x nv, f_ext n x nb x 6 or NULL, mass_matrix n x nv x nv, packed
                  n x rbd_packed_size(m). With n <= 0 a call does nothing
     results      those of the single calls, to rounding. An output may be NULL, or an input, as there
     errors       those of the single calls. With RBD_ERR_SINGULAR the results of the other states stand, and
                  rbd_batch_singular names the first singular state
*/
#include "rbd.h"

#ifndef RBD_BATCH_H
#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd_batch.h: belongs to another version of rbd.h"
#endif
#ifdef RBD_BATCH_IMPLEMENTATION
#ifndef RBD_LANES
#error "rbd: RBD_BATCH_IMPLEMENTATION needs RBD_LANES"
#undef RBD_BATCH_IMPLEMENTATION
#elif defined RBD_NO_CHOLESKY
#error "rbd: the batch calls need RBD_NO_CHOLESKY undefined"
#undef RBD_BATCH_IMPLEMENTATION
#elif !defined RBDI_IMPLEMENTED
#error "rbd: define RBD_BATCH_IMPLEMENTATION before the first header of rbd is included"
#undef RBD_BATCH_IMPLEMENTATION
#endif
#endif
#endif

#if defined __cplusplus && !defined RBD_REAL_CUSTOM /* with RBD_STATIC too: other files call them */
extern "C" {
#endif

#ifndef RBD_BATCH_H
#define RBD_BATCH_H
#include "api/batch.h"
#endif

#if defined RBD_DERIVATIVES_H && !defined RBDI_BATCH_DERIVATIVES
#define RBDI_BATCH_DERIVATIVES
#include "api/batch_derivatives.h"
#endif

#if defined RBD_CONSTRAINTS_H && !defined RBDI_BATCH_CONSTRAINTS
#define RBDI_BATCH_CONSTRAINTS
#include "api/batch_constraints.h"
#endif

#if defined __cplusplus && !defined RBD_REAL_CUSTOM
}
#endif

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

#include "base/letters_begin.h"

#if defined RBD_BATCH_IMPLEMENTATION && !defined RBDI_BATCH_IMPLEMENTED
#define RBDI_BATCH_IMPLEMENTED
#include "batch/lanes.h"
#include "batch/tasks.h"
#include "batch/calls.h"
#endif

#if defined RBD_BATCH_IMPLEMENTATION && defined RBDI_BATCH_DERIVATIVES && \
    !defined RBDI_BATCH_DERIVATIVES_IMPLEMENTED
#define RBDI_BATCH_DERIVATIVES_IMPLEMENTED
#include "batch/derivatives.h"
#endif

#if defined RBD_BATCH_IMPLEMENTATION && defined RBDI_BATCH_CONSTRAINTS && \
    !defined RBDI_BATCH_CONSTRAINTS_IMPLEMENTED
#define RBDI_BATCH_CONSTRAINTS_IMPLEMENTED
#include "batch/constraints.h"
#endif

#include "base/letters_end.h"
