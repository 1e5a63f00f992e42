/* rbd_qp.h - small convex quadratic programs, for control, in one C99 header. Version 0.4.0.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end.

   Minimises x'Hx/2 + f'x within bounds of x and of C x, without allocation, dependency, global or NaN. It
   stands alone; rbd.h may stand beside it. In ONE file of the program:

       #define RBD_IMPLEMENTATION
       #include "rbd_qp.h"

   and plain #include "rbd_qp.h" everywhere else. The nearest point to (1, 0.5) with x + y <= 1 and x >= 0:

       const double H[4] = {1, 0, 0, 1}, f[2] = {-1, -0.5}, C[2] = {1, 1};
       const double lower[2] = {0, -RBD_QP_NONE}, upper[2] = {RBD_QP_NONE, 1};
       const rbd_qp_problem p = {.n = 2, .bounds = 1, .rows = 1, .H = H, .f = f, .C = C,
                                 .lower = lower, .upper = upper};
       unsigned char memory[RBD_QP_SIZE(2, 1, 1, 0)];
       double x[2], lambda[2];
       signed char side[2];
       rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, side, NULL);   // x = (0.75, 0.25)

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits] [cost]
     [problem] [solve]
     --- stop here if you only use it ---
     [layout] [compiler] [tolerances] [scalar] [pieces]
     [method] [vectors] [factor] [active rows] [search] [refinement] [rounds] [solve code]
     [text code]
     [licence]

   [conventions]
     rows         first the bounds of x, then the rows of C; an equality has lower = upper
     soft         a row with a weight w may be missed by e, at a cost of w e^2/2
     lambda       Hx + f + C'lambda = 0; above 0 where the upper side holds. Arrays and signs are DAQP's
     matrices     row-major

   [configuration] That of rbd.h. RBD_REAL is double or float; RBD_LANES and RBD_REAL_CUSTOM do not go with
   it.

   [guarantees]
     No allocation, recursion, VLA, global, stdio, locale or errno. Reentrant. From libm only sqrt. The number
     of steps is bounded: options->steps. A result with RBD_QP_OK satisfies the conditions of Karush, Kuhn and
     Tucker to the shares that result->primal and ->dual state, at most ten times options->accuracy. x is
     finite with every status, but after RBD_QP_NULL, _RANGE and _MEMORY it is as it was. The bits are the
     same on every machine with RBD_REPRODUCIBLE, as of rbd.h.

   [limits]
     Dense matrices, of up to some hundred variables: a step costs about 3 n^2 products, and one for each
     entry of C. H must be convex. If it is only semidefinite, a proximal method takes some rounds, and the
     optimum is exact to the accuracy, not to rounding. Squares of the entries of a row must be normal
     numbers. result->dual is a share of the cost's largest term: what is 1e8 times weaker (float: 1e3) is
     less exact. Rows at an angle of less than 1e-6 (float: 1e-2) may have multipliers too large to be exact:
     RBD_QP_INACCURATE. Weights of soft rows more than 1e14 above H (float: 1e4) may end in RBD_QP_ITERATIONS
     or _INACCURATE, never in _INFEASIBLE: hard rows are better there. Linear programs whose vertices lie far
     apart, as those of Klee and Minty do from 7 variables on (float: 5), may end in RBD_QP_ITERATIONS: more
     options->rounds. In float RBD_QP_UNBOUNDED is said where f falls by a tenth of its terms; less is
     RBD_QP_INACCURATE. Of problems without H (all 0) that are unbounded a few of a thousand end in
     RBD_QP_ITERATIONS or _NAN instead, of those with soft rows alone a few of a hundred.

   [cost] Flash for a Cortex-M4F at -Os: 13.6 kB of rbd_qp_solve. Contact forces of HyQ without a warm
   start, by gcc 12.2 -O2: instructions of a Cortex-M4F in float, the mean of 32 problems; microseconds of a
   PC in double, the mean of 400, with -march=native (AVX-512) and without. More in docs/qp.md:

                                              instructions    native   without
     12 forces, 28 rows, few limits reached         37,685       3.0       3.3
     the same, many                                 97,040       8.0       8.9
     18 accelerations too, 46 rows, few            118,976       8.7      10.1
     the same, many                                204,902      13.6      16.5
*/

#include "api/configuration.h"

/* The caller's macros of single letters, such as I of complex.h, are set aside and come back at the end. */

#include "base/letters_begin.h"

#ifndef RBD_QP_H
#define RBD_QP_H

#if RBD_VERSION_NUMBER < 400
#error "rbd_qp.h: needs a newer rbd.h"
#endif

#if defined RBD_LANES || RBDI_REAL_KIND % 3 == 0
#error "rbd: rbd_qp.h needs RBD_REAL double or float, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

#include "api/qp.h"

RBDI_EXTERN_C_END

#endif /* RBD_QP_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

#if defined RBD_IMPLEMENTATION && !defined RBDI_QP_IMPLEMENTED
#define RBDI_QP_IMPLEMENTED

#include "base/types.h"
#include "base/compiler.h"

RBDI_CODE_BEGIN

#include "base/tolerances.h"
#include "base/scalar.h"
#include "base/pieces.h"
#include "qp/layout.h"
#include "qp/vectors.h"
#include "qp/factor.h"
#include "qp/active.h"
#include "qp/search.h"
#include "qp/refine.h"
#include "qp/rounds.h"
#include "qp/solve.h"
#include "qp/text.h"

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
