#ifndef RBDI_MODEL_DESCRIBE_H
#define RBDI_MODEL_DESCRIBE_H
#include "api/lookup.h"
#include "model/features.h"
#include "model/joint_types.h"
#include "model/wide.h"

/* How many axes the description of a joint has: none, axis, or axis and axis2. */
RBDI_PART int rbdi_described_axes(int type) {
    const char *axes = rbdi_joint_facts(type)->axes;
    return (rbdi_axis_name(axes[0]) == 'a') + (rbdi_axis_name(axes[1]) == 'b');
}

/* A pose of the model in the build's arithmetic. */
RBDI_PART rbdi_wide_pose rbdi_widen_pose(const rbd_const E[9], rbdi_c3 r) {
    rbdi_wide_pose X;
    for (int k = 0; k < 9; ++k) X.E[k] = (rbdi_wide)E[k];
    X.r[0] = (rbdi_wide)r.x;
    X.r[1] = (rbdi_wide)r.y;
    X.r[2] = (rbdi_wide)r.z;
    return X;
}

/* Pose of link l in its parent at q = 0. */
RBDI_PART rbdi_wide_pose rbdi_link_place(const rbd_model *m, const rbdi_link *l) {
    static const rbd_const none[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    rbdi_wide_pose X = rbdi_widen_pose(l->kind == RBDI_BLOCK ? rbdi_block_of(m, l)->E : none, l->r);
    if (l->kind == RBDI_BLOCK) return X;
    rbdi_w_zxz((rbdi_wide)l->cg, (rbdi_wide)l->sg, (rbdi_wide)l->ca, (rbdi_wide)l->sa, (rbdi_wide)l->cb,
               (rbdi_wide)l->sb, X.E);
    for (int k = 0; k < 3; ++k) X.r[k] += (rbdi_wide)l->d * X.E[6 + k];
    return X;
}

/* Writes the pose of a body's joint, its axes, which are the links' z, and its parent; returns its first
   dof. */
RBDI_LOCAL int rbdi_describe_joint(const rbd_model *m, int body, rbd_body *row) {
    const rbdi_frame *u = &m->frame[body];
    const int axes = rbdi_described_axes(u->type);
    rbdi_wide_pose X = rbdi_widen_pose(u->E, u->r), parent;
    rbdi_wide R[9], axis[3] = {0, 0, 0}, axis2[3] = {0, 0, 0};
    int i = u->link, dof = 0;

    for (; i >= 0 && m->dof[m->link[i].iv].body == body; i = m->link[i].parent) {
        for (int k = 0; k < 3; ++k) {
            axis2[k] = axis[k];
            axis[k] = X.E[3 * k + 2];
        }
        parent = rbdi_link_place(m, &m->link[i]);
        X = rbdi_w_compose(&X, &parent);
        dof = m->link[i].iv;
    }

    row->parent = -1;
    if (i >= 0) { /* from that link to the body whose joint moves it */
        row->parent = m->dof[m->link[i].iv].body;
        parent = rbdi_widen_pose(m->frame[row->parent].E, m->frame[row->parent].r);
        X = rbdi_w_relative(&X, &parent);
    }

    rbdi_w_transpose(X.E, R);
    for (int k = 0; k < 9; ++k) row->rotation[k] = (double)R[k];

    for (int k = 0; k < 3; ++k) {
        row->position[k] = (double)X.r[k];
        row->axis[k] = axes > 0 ? (double)axis[k] : 0;
        row->axis2[k] = axes > 1 ? (double)axis2[k] : 0;
    }

    row->pitch = u->type == RBD_HELICAL ? (double)m->link[u->link].kappa : 0;
    return dof;
}

RBDI_API rbd_status rbd_describe(const rbd_model *m, int body, rbd_body *row) {
    const rbdi_frame *u;
    const rbdi_dof *dof;
    int first;
    if (!m || !row) return RBD_ERR_NULL;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    u = &m->frame[body];
    row->name = u->name;
    row->joint = u->joint;
    row->type = (rbd_joint_type)u->type;
    first = rbdi_describe_joint(m, body, row);

    row->mass = (double)u->mass;
    row->com[0] = (double)u->com.x;
    row->com[1] = (double)u->com.y;
    row->com[2] = (double)u->com.z;
    row->inertia[0] = (double)u->I.xx;
    row->inertia[1] = (double)u->I.xy;
    row->inertia[2] = (double)u->I.xz;
    row->inertia[3] = (double)u->I.yy;
    row->inertia[4] = (double)u->I.yz;
    row->inertia[5] = (double)u->I.zz;

    row->lower = (double)u->lower;
    row->upper = (double)u->upper;
    row->velocity = (double)u->velocity;
    row->effort = (double)u->effort;

    row->mimic = NULL;
    row->mimic_ratio = row->mimic_offset = 0;
    if (u->type != RBD_FIXED && first >= m->nv) {
        const rbdi_mimic *mimic = &m->mimic[first - m->nv];
        row->mimic = m->frame[m->dof[mimic->source_v].body].joint;
        row->mimic_ratio = (double)mimic->ratio;
        row->mimic_offset = (double)mimic->offset;
    }

    dof = &m->dof[first];
    for (int k = 0; k < 6; ++k) {
        const int has = k < u->nv || (row->mimic && k == 0);
        row->armature[k] = has ? (double)dof[k].armature : 0;
        row->damping[k] = has ? (double)dof[k].damping : 0;
        row->friction[k] = has ? (double)dof[k].friction : 0;
    }

    return RBD_OK;
}

#endif
