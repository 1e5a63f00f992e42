/* pivots.h - what pivots.c and the builds of pivots_call.c share. SPDX-License-Identifier: MIT */
#ifndef PIVOTS_H
#define PIVOTS_H

#include "rbd.h"

enum { PIVOTS_MAX_BODIES = 200, PIVOTS_MAX_Q = 4 * PIVOTS_MAX_BODIES, PIVOTS_MAX_V = 3 * PIVOTS_MAX_BODIES };

typedef struct pivots_system {
    rbd_body bodies[PIVOTS_MAX_BODIES];
    int nb, nq, nv;
    int kind;         /* of singularity */
    double deviation; /* from it */
    double q[PIVOTS_MAX_Q], v[PIVOTS_MAX_V], tau[PIVOTS_MAX_V];
} pivots_system;

/* Accelerations by rbd_aba or rbd_fd_cholesky; returns its status. */
typedef int pivots_call(const pivots_system *s, int cholesky, double *a);

/* The builds: as users have them, those that take any positive pivot, and that in quad precision, the
 * arbiter. */
pivots_call pivots_double, pivots_float, pivots_double_any, pivots_float_any, pivots_quad_any;

#endif
