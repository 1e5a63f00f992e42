/* control.h - what the examples share: rate, and the robot that stands in for the real one.
   SPDX-License-Identifier: MIT */
#ifndef CONTROL_H
#define CONTROL_H

#include "board.h"
#include "rbd.h"

/* Under QEMU as run here a core executes 62.5 million instructions a second, and simulates the robot too. */
#if defined __ARM_FP || defined __riscv_flen
#define PERIOD_US 1000
#elif __ARM_ARCH >= 7
#define PERIOD_US 8000
#else
#define PERIOD_US 16000
#endif
#define PERIOD ((rbd_real)PERIOD_US * 1e-6f)

/* The robot, in place of encoders and motors: holds tau, and f_ext or NULL, for one period, moving q and v.
   next: nv scalars of scratch. */
static inline rbd_status simulate(const rbd_model *m, rbd_work *w, rbd_real *q, rbd_real *v,
                                  const rbd_real *tau, const rbd_real *f_ext, rbd_real *next) {
    rbd_status status = rbd_aba(m, w, q, v, tau, f_ext, next);
    for (int i = 0; i < rbd_nv(m); i++) { /* next: the acceleration, then the mean velocity of the period */
        const rbd_real change = PERIOD * next[i];
        next[i] = v[i] + change / 2;
        v[i] += change;
    }
    return status == RBD_OK ? rbd_integrate(m, q, next, PERIOD, q) : status;
}

#endif
