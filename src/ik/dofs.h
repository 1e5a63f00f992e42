#ifndef RBDI_IK_DOFS_H
#define RBDI_IK_DOFS_H
#include "model/limits.h"
#include "dynamics/crba.h"
#include "ik/layout.h"

/* Interface: rbdi_ik_limits */

/* ---- dofs [dofs] ---- */

/* Marks the dofs that move link i: 1, or 2 if they turn. With mimic joints those that they follow. */
RBDI_LOCAL void rbdi_ik_mark(const rbd_model *m, int i, int16_t *mark) {
    for (; i >= 0; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const int block = rbdi_is(l, RBDI_BLOCK);
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const int slides =
                block ? rbdi_block_of(m, l)->first + j >= 3 : rbdi_is(l, RBDI_SCREW) && !(l->rho > 0);
            int16_t *to = &mark[rbdi_source(m, l->iv + j)];
            if (!slides)
                *to = 2;
            else if (*to == 0)
                *to = 1;
        }
    }
}

/* The limits of a dof: those of its joint, and of joints that mimic it unless they leave nothing. */
RBDI_LOCAL void rbdi_ik_limits(const rbd_model *m, rbdi_ik_dof *f) {
    const rbdi_frame *u = &m->frame[m->dof[f->dof].body];
    rbdi_limits all = rbdi_limits_of(u);

    for (int i = 0; i < rbdi_mimics(m); ++i) {
        const rbdi_limits both = rbdi_both_limits(all, rbdi_limits_of_mimic(m, i));
        if (m->mimic[i].source_v == f->dof && both.lower <= both.upper) all = both;
    }

    f->at = (int16_t)(all.lower > -RBDI_UNBOUNDED || all.upper < RBDI_UNBOUNDED ? u->iq : -1);
    f->lower = rbdi_set(all.lower);
    f->upper = rbdi_set(all.upper);
}

/* The dofs that move a target and are not held. */
RBDI_LOCAL void rbdi_ik_find_dofs(rbdi_ik *ik) {
    const rbd_model *m = ik->m;
    int16_t *mark = ik->mark;

    for (int i = 0; i < m->nv; ++i) mark[i] = 0;
    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        if (t->kind != RBD_IK_COM) rbdi_ik_mark(m, m->frame[t->body].link, mark);
        for (int i = 0; t->kind == RBD_IK_COM && i < m->nl; ++i) rbdi_ik_mark(m, i, mark);
    }

    ik->dofs = 0;
    for (int i = 0; i < m->nv; ++i) {
        rbdi_ik_dof *f = &ik->dof[ik->dofs];
        if (mark[i] == 0 || (ik->options.held && ik->options.held[i])) continue;
        f->dof = (int16_t)i;
        f->turns = mark[i] == 2;
        rbdi_ik_limits(m, f);
        ++ik->dofs;
    }
}

/* Puts q within the limits of these dofs. */
RBDI_LOCAL void rbdi_ik_put_within(const rbdi_ik *ik, rbd_real *q) {
    for (const rbdi_ik_dof *f = ik->dof; f < ik->dof + ik->dofs; ++f) {
        if (f->at < 0) continue;
        if (q[f->at] > f->upper) q[f->at] = f->upper;
        if (q[f->at] < f->lower) q[f->at] = f->lower;
    }
}

#endif
