#ifndef RBDI_IK_DOFS_H
#define RBDI_IK_DOFS_H
#include "dynamics/crba.h"
#include "ik/layout.h"

/* ---- dofs [dofs] ---- */

/* Marks the dofs that move link i: 1, or 2 if they turn. With mimic joints those that they follow. */
RBDI_LOCAL void rbdi_ik_mark(const rbd_model *m, int i, int16_t *mark) {
    for (; i >= 0; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const int block = rbdi_is(l, RBDI_BLOCK);
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const int slides = block ? rbdi_block_of(m, l)->first + j >= 3
                                     : rbdi_is(l, RBDI_SCREW) && !(l->rho < 0 || l->rho > 0);
            int16_t *to = &mark[rbdi_source(m, l->iv + j)];
            if (!slides)
                *to = 2;
            else if (*to == 0)
                *to = 1;
        }
    }
}

/* Narrows the limits of dof f to those of a joint that mimics it. Limits that leave nothing do not count. */
RBDI_LOCAL void rbdi_ik_mimic_limits(const rbdi_mimic *mimic, const rbdi_frame *u, rbdi_ik_dof *f) {
    const rbd_const a = (u->lower - mimic->offset) / mimic->ratio,
                    b = (u->upper - mimic->offset) / mimic->ratio;
    const rbd_real lower = rbdi_set(a < b ? a : b), upper = rbdi_set(a < b ? b : a);
    if (f->at >= 0 && !(lower <= f->upper && f->lower <= upper)) return;
    if (f->at < 0 || lower > f->lower) f->lower = lower;
    if (f->at < 0 || upper < f->upper) f->upper = upper;
    f->at = mimic->source_q;
}

/* The limits of a dof: those of its joint and of joints that mimic it. */
RBDI_LOCAL void rbdi_ik_limits(const rbd_model *m, rbdi_ik_dof *f) {
    const rbdi_frame *u = &m->frame[m->dof[f->dof].body];
    f->at = (int16_t)(u->lower < u->upper ? u->iq : -1);
    f->lower = rbdi_set(u->lower);
    f->upper = rbdi_set(u->upper);

    for (int j = 0; j < rbdi_mimics(m); ++j) {
        const rbdi_frame *other = &m->frame[m->dof[m->nv + j].body];
        if (m->mimic[j].source_v == f->dof && other->lower < other->upper)
            rbdi_ik_mimic_limits(&m->mimic[j], other, f);
    }
}

/* The dofs that move a target and are not held. */
RBDI_LOCAL void rbdi_ik_find_dofs(rbdi_ik *k) {
    const rbd_model *m = k->m;
    int16_t *mark = k->mark;

    for (int i = 0; i < m->nv; ++i) mark[i] = 0;
    for (const rbd_ik_target *t = k->target; t < k->target + k->n; ++t) {
        if (t->kind != RBD_IK_COM) rbdi_ik_mark(m, m->frame[t->body].link, mark);
        for (int i = 0; t->kind == RBD_IK_COM && i < m->nl; ++i) rbdi_ik_mark(m, i, mark);
    }

    k->dofs = 0;
    for (int i = 0; i < m->nv; ++i) {
        rbdi_ik_dof *f = &k->dof[k->dofs];
        if (mark[i] == 0 || (k->options.held && k->options.held[i])) continue;
        f->dof = (int16_t)i;
        f->turns = mark[i] == 2;
        rbdi_ik_limits(m, f);
        ++k->dofs;
    }
}

/* Puts q within the limits of these dofs. */
RBDI_LOCAL void rbdi_ik_put_within(const rbdi_ik *k, rbd_real *q) {
    for (const rbdi_ik_dof *f = k->dof; f < k->dof + k->dofs; ++f) {
        if (f->at < 0) continue;
        if (q[f->at] > f->upper) q[f->at] = f->upper;
        if (q[f->at] < f->lower) q[f->at] = f->lower;
    }
}

#endif
