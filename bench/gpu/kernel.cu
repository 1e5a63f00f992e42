/* kernel.cu - ALGORITHM of ROBOT in SCALAR, by the kernel of its generated code. SPDX-License-Identifier:
   MIT */
#include "kernel.h"

#include REFERENCE_HEADER

namespace robot = ROBOT;

enum { Q = robot::NQ, V = robot::NV, M = V * V, FLOATING = Q != V };

#ifndef CONSTRAINT_ROWS
#define CONSTRAINT_ROWS 1 /* of constraints */
#endif

/* Lengths of the arguments, and 1 for the status. */
#define SIZES_id Q, V, V, V
#define SIZES_mm Q, M
#define SIZES_minv Q, M, 1
#define SIZES_fd Q, V, V, V, 1
#define SIZES_fd_cholesky Q, V, V, V, 1
#define SIZES_id_derivatives Q, V, V, M, M
#define SIZES_fd_derivatives Q, V, V, V, M, M, M, 1
#define SIZES_constrained Q, V, V, V, CONSTRAINT_ROWS, 1

static const int sizes[] = {PASTE(SIZES_, ALGORITHM)};

static bool run(const options &o) {
    const double tolerance = sizeof(SCALAR) == 4 ? 5e-3 : 1e-7;
    const auto reference = REFERENCE(ALGORITHM);
    bool right = true;
#define MEASURE(layout) \
    right &= measure<rbd::layout>(o, TEXT(ALGORITHM), #layout, \
                                  robot::PASTE(ALGORITHM, _kernel)<rbd::layout>, sizes, FLOATING, reference, \
                                  tolerance)
#ifdef WITH_ROWS
    MEASURE(rows);
#endif
    MEASURE(blocks);
#ifdef WITH_COLUMNS
    MEASURE(columns);
#endif
    return right;
}

static void launch_in_blocks(int n, const void *const *arguments) {
    launch_with(robot::PASTE(ALGORITHM, _kernel)<rbd::blocks>, n, arguments);
}

static blocks_kernel own_kernel(TEXT(ALGORITHM), launch_in_blocks);
static measurement own(TEXT(ALGORITHM), run);
