#ifndef RBDI_MODEL_LOOKUP_H
#define RBDI_MODEL_LOOKUP_H
#include "api/lookup.h"
#include "model/layout.h"
#include "base/memory.h"

/* ---- lookup [lookup code] ---- */

RBDI_API int rbd_nb(const rbd_model *m) { return m ? m->nb : 0; }
RBDI_API int rbd_nq(const rbd_model *m) { return m ? m->nq : 0; }
RBDI_API int rbd_nv(const rbd_model *m) { return m ? m->nv : 0; }

RBDI_API int rbd_body_index(const rbd_model *m, const char *name) {
    for (int b = 0; b < rbd_nb(m); ++b)
        if (rbdi_same(m->frame[b].name, name)) return b;
    return -1;
}

RBDI_API int rbd_joint_index(const rbd_model *m, const char *name) {
    for (int b = 0; b < rbd_nb(m); ++b)
        if (rbdi_same(m->frame[b].joint, name)) return b;
    return -1;
}

RBDI_API const char *rbd_body_name(const rbd_model *m, int body) {
    return m && body >= 0 && body < m->nb ? m->frame[body].name : NULL;
}

RBDI_API const char *rbd_joint_name(const rbd_model *m, int body) {
    return m && body >= 0 && body < m->nb ? m->frame[body].joint : NULL;
}

RBDI_API rbd_status rbd_joint(const rbd_model *m, int body, rbd_joint_info *info) {
    const rbdi_frame *u;
    if (!m || !info) return RBD_ERR_NULL;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    u = &m->frame[body];
    info->type = (rbd_joint_type)u->type;
    info->nq = u->nq;
    info->nv = u->nv;
    info->iq = u->nv > 0 ? u->iq : -1;
    info->iv = u->nv > 0 ? u->iv : -1;
    info->lower = u->lower;
    info->upper = u->upper;
    info->velocity = u->velocity;
    info->effort = u->effort;
    return RBD_OK;
}

RBDI_API int rbd_dof_body(const rbd_model *m, int dof) {
    return m && dof >= 0 && dof < m->nv ? m->dof[dof].body : -1;
}

#endif
