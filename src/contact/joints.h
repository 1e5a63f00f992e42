#ifndef RBDI_CONTACT_JOINTS_H
#define RBDI_CONTACT_JOINTS_H
#include "model/layout.h"
#include "base/compiler.h"
#include "contact/tolerances.h"

/* ---- joints [joints] ----
   Limits, friction and damping of the description along dof k. A joint that mimics it, x = ratio q_k +
   offset, has no dof of its own: its limits bound q_k, and its torques act on it as rbd_passive has them,

       friction  |ratio| friction_x,   damping  ratio^2 damping_x */

RBDI_LOCAL rbd_const rbdi_joint_friction(const rbd_model *m, int k) {
    rbd_const sum = m->dof[k].friction;

    for (int i = 0; i < m->nmimic; ++i) {
        const rbd_const ratio = m->mimic[i].ratio;
        if (m->mimic[i].source_v == k) sum = sum + (ratio < 0 ? -ratio : ratio) * m->dof[m->nv + i].friction;
    }

    return sum;
}

RBDI_LOCAL rbd_const rbdi_joint_damping(const rbd_model *m, int k) {
    rbd_const sum = m->dof[k].damping;

    for (int i = 0; i < m->nmimic; ++i) {
        const rbd_const ratio = m->mimic[i].ratio;
        if (m->mimic[i].source_v == k) sum = sum + ratio * ratio * m->dof[m->nv + i].damping;
    }

    return sum;
}

/* The limits lower <= q <= upper of a coordinate. */
typedef struct rbdi_limits {
    rbd_const lower, upper;
} rbdi_limits;

/* The stricter of two pairs of limits. */
RBDI_LOCAL rbdi_limits rbdi_both_limits(rbdi_limits x, rbdi_limits y) {
    rbdi_limits both;
    both.lower = x.lower > y.lower ? x.lower : y.lower;
    both.upper = x.upper < y.upper ? x.upper : y.upper;
    return both;
}

/* Limits of a body's joint, in its own coordinate; both 0 means none. */
RBDI_LOCAL rbdi_limits rbdi_limits_of(const rbdi_frame *u) {
    const rbdi_limits none = {-RBDI_UNBOUNDED, RBDI_UNBOUNDED};
    rbdi_limits x;
    x.lower = u->lower;
    x.upper = u->upper;
    return x.lower < x.upper ? x : none;
}

/* Limits of the coordinate of a joint with one dof, those of its followers included. */
RBDI_LOCAL rbdi_limits rbdi_joint_limits(const rbd_model *m, const rbdi_frame *u) {
    rbdi_limits all = rbdi_limits_of(u);

    for (int i = 0; i < m->nmimic; ++i) {
        const rbdi_mimic *mimic = &m->mimic[i];
        const rbdi_limits own = rbdi_limits_of(&m->frame[m->dof[m->nv + i].body]);
        const int turned = mimic->ratio < 0;
        rbdi_limits led;
        if (mimic->source_v != u->iv || own.lower <= -RBDI_UNBOUNDED) continue;

        /* q = (x - offset) / ratio */
        led.lower = ((turned ? own.upper : own.lower) - mimic->offset) / mimic->ratio;
        led.upper = ((turned ? own.lower : own.upper) - mimic->offset) / mimic->ratio;
        all = rbdi_both_limits(all, led);
    }

    return all;
}

#endif
