/* rbd-scaling with a mistake, which it must catch: FAULT is nan (in a result of one state), infinite, or
   status (of a call that is timed). SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "rbd.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VERIFIED = 16 }; /* calls before the first that is timed: one for each state */

static rbd_status broken_aba(const rbd_model *m, rbd_work *w, const double *q, const double *v,
                             const double *tau, const double *f_ext, double *out) {
    static int calls;
    const char *fault = getenv("FAULT");
    const rbd_status status = rbd_aba(m, w, q, v, tau, f_ext, out);
    calls++;
    if (strcmp(fault, "nan") == 0 && calls == VERIFIED) out[0] = nan("");
    if (strcmp(fault, "infinite") == 0 && calls == VERIFIED) out[0] = HUGE_VAL;
    return strcmp(fault, "status") == 0 && calls > VERIFIED ? RBD_ERR_SINGULAR : status;
}

#undef rbd_aba
#define rbd_aba broken_aba
#include "../timing/scaling.c"
