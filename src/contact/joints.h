#ifndef RBDI_CONTACT_JOINTS_H
#define RBDI_CONTACT_JOINTS_H
#include "model/limits.h"

/* ---- joints [joints] ----
   Friction and damping of the description along dof k. A joint that mimics it, x = ratio q_k + offset, has no
   dof of its own: its torques act on q_k as rbd_passive has them,

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

/* Limits of the coordinate of a joint with one dof, those of its followers included. */
RBDI_LOCAL rbdi_limits rbdi_joint_limits(const rbd_model *m, const rbdi_frame *u) {
    rbdi_limits all = rbdi_limits_of(u);

    for (int i = 0; i < m->nmimic; ++i)
        if (m->mimic[i].source_v == u->iv) all = rbdi_both_limits(all, rbdi_limits_of_mimic(m, i));

    return all;
}

#endif
