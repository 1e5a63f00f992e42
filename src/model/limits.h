#ifndef RBDI_MODEL_LIMITS_H
#define RBDI_MODEL_LIMITS_H
#include "model/layout.h"
#include "base/compiler.h"
#include "base/tolerances.h"

/* Interface: rbdi_both_limits, rbdi_limits, rbdi_limits_of, rbdi_limits_of_mimic */

/* ---- limits of joints [joint limits] ----
   A joint that mimics another, x = ratio q + offset, has no coordinate of its own: its limits bound that of
   the other. */

/* lower <= q <= upper; RBDI_UNBOUNDED and more is none. */
typedef struct rbdi_limits {
    rbd_const lower, upper;
} rbdi_limits;

/* The stricter of two pairs of limits. */
RBDI_PART rbdi_limits rbdi_both_limits(rbdi_limits x, rbdi_limits y) {
    rbdi_limits both;
    both.lower = x.lower > y.lower ? x.lower : y.lower;
    both.upper = x.upper < y.upper ? x.upper : y.upper;
    return both;
}

/* Limits of a body's joint, in its own coordinate; both 0 means none. */
RBDI_PART rbdi_limits rbdi_limits_of(const rbdi_frame *u) {
    const rbdi_limits none = {-RBDI_UNBOUNDED, RBDI_UNBOUNDED};
    rbdi_limits x;
    x.lower = u->lower;
    x.upper = u->upper;
    return x.lower < x.upper ? x : none;
}

/* Limits of mimic joint i in the coordinate of the joint that it follows: q = (x - offset) / ratio. */
RBDI_PART rbdi_limits rbdi_limits_of_mimic(const rbd_model *m, int i) {
    const rbdi_mimic *mimic = &m->mimic[i];
    const rbdi_limits own = rbdi_limits_of(&m->frame[m->dof[m->nv + i].body]);
    const int turned = mimic->ratio < 0;
    rbdi_limits led;
    if (own.lower <= -RBDI_UNBOUNDED) return own;

    led.lower = ((turned ? own.upper : own.lower) - mimic->offset) / mimic->ratio;
    led.upper = ((turned ? own.lower : own.upper) - mimic->offset) / mimic->ratio;
    return led;
}

#endif
