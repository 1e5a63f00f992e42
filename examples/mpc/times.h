/* times.h - what an iteration of ilqr.h takes, in parts. Define _POSIX_C_SOURCE as 199309L before the first
   header: clock_gettime. SPDX-License-Identifier: MIT */
#ifndef ILQR_TIMES_H
#define ILQR_TIMES_H

#include <math.h>
#include <stdio.h>
#include <time.h>

#include "ilqr.h"

static inline double ilqr_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* At the trajectory that there is. */
static inline void ilqr_print_times(ilqr *s, const char *when) {
    enum { LINEARISE, BACKWARD, ROLLOUT, COST, PARTS };
    const ilqr_problem *p = s->p;
    double least[PARTS] = {1e9, 1e9, 1e9, 1e9};
    for (int i = 0; i < 100; i++) {
        double t[PARTS + 1];
        rbd_real l;
        t[LINEARISE] = ilqr_now(), ilqr_linearise(s);
        t[BACKWARD] = ilqr_now(), ilqr_backward(s);
        t[ROLLOUT] = ilqr_now(), ilqr_rollout(s, 0, &l);
        t[COST] = ilqr_now();
        for (int k = 0; k <= s->knots; k++)
            p->cost(p->user, k, s->q + k * s->nq, s->v + k * s->nv, k < s->knots ? s->u + k * s->nu : NULL,
                    &l, s->Q_z, s->Q_zz);
        t[PARTS] = ilqr_now();
        for (int j = 0; j < PARTS; j++) least[j] = fmin(least[j], t[j + 1] - t[j]);
    }
    printf("%s: milliseconds, the least of 100; %d knots, %d degrees of freedom, %d motors\n", when, s->knots,
           s->nv, s->nu);
    printf("%6.2f  derivatives of the dynamics\n", least[LINEARISE]);
    printf("%6.2f  backward pass, of which the cost's derivatives are %.2f\n", least[BACKWARD], least[COST]);
    printf("%6.2f  dynamics and cost, once in a line search whose first step is good\n", least[ROLLOUT]);
    printf("%6.2f  an iteration\n", least[LINEARISE] + least[BACKWARD] + least[ROLLOUT]);
    printf("%6.2f  a tick of a control loop, which starts from a measured state besides\n",
           least[LINEARISE] + least[BACKWARD] + 2 * least[ROLLOUT]);
}

#endif
