#ifndef RBDI_DYNAMICS_FORWARD_H
#define RBDI_DYNAMICS_FORWARD_H
#include "dynamics/rnea.h"
#include "dynamics/hybrid.h"
#include "dynamics/pivots.h"

/* ---- forward dynamics [forward dynamics code] ---- */

#ifndef RBD_NO_ABA
RBD_API rbd_status rbd_aba(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                           const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check(m, w, q && v && tau && a);
    if (status) return status;
#ifndef RBDI_NO_FD_CHOLESKY
    if (m->nmimic) return rbd_fd_cholesky(m, w, q, v, tau, f_ext, a);
#endif
    rbdi_joints(m, w, q);
    rbdi_aba_pass1(m, w, v);
    rbdi_external(m, w, f_ext);
    doubt = rbdi_aba_pass2(m, w, tau);
    rbdi_aba_pass3(m, w, a);
    return rbdi_status_of(m, w, doubt, a, m->nv);
}
#endif

#if !defined RBD_NO_ABA && !defined RBD_NO_HYBRID
/* Which joints have a dof that is not held: 0 none, 1 only some on the world, 2 others as well. */
static int rbdi_reach(const rbd_model *m, const unsigned char *given) {
    int reach = 0;
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        for (int k = 0; k < rbdi_link_dofs(m, l); ++k)
            if (!given[l->iv + k] && reach < 2) reach = l->parent < 0 ? 1 : 2;
    }
    return reach;
}

/* What hybrid dynamics returns; a and tau become 0 where a pivot is not sound. */
static rbd_status rbdi_hybrid_status(const rbd_model *m, rbd_work *w, rbdi_mask doubt,
                                     const unsigned char *given, rbd_real *a, rbd_real *tau) {
    w->singular = -1;
    if (!rbdi_any(doubt)) return RBD_OK;
    rbdi_judge_state(m, w, given);
    for (int k = 0; k < m->nv; ++k)
        if (given[k]) w->pivot[k] = rbdi_set(RBD_C(1)); /* none: sound */
    (void)rbdi_verdict(m, w, tau, m->nv);
    return rbdi_verdict(m, w, a, m->nv);
}

#ifndef RBDI_NO_FD_CHOLESKY
/* With mimic joints: the rows and columns of M of held dofs become those of the unit matrix, and a of the
   others solves M a = tau - c, c with the given a in it. */
static rbd_status rbdi_hybrid_mimic(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                    const rbdi_given *given, const rbd_real *f_ext, rbd_real *a,
                                    rbd_real *tau) {
    rbdi_mask doubt;
    const rbd_real *vx = rbdi_expand_v(m, v, w->vx);
    rbd_crba_packed(m, w, q, w->H);
    rbdi_hold_rows(m, given->dof, w->H);
    for (int k = 0; k < m->nv; ++k)
        if (!given->dof[k]) a[k] = rbdi_zero();
    doubt = rbdi_factor(m, w, w->H);
    rbdi_rnea(m, w, vx, rbdi_expand_v(m, a, w->ax), f_ext, w->tx);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int k = 0; k < m->nv; ++k) w->bias[k] = given->dof[k] ? rbdi_zero() : tau[k] - w->bias[k];
    rbdi_solve(m, w->H, w->bias);
    for (int k = 0; k < m->nv; ++k)
        if (!given->dof[k]) a[k] = w->bias[k];
    rbdi_rnea(m, w, vx, rbdi_expand_v(m, a, w->ax), f_ext, w->tx);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int k = 0; k < m->nv; ++k)
        if (given->dof[k]) tau[k] = w->bias[k];
    return rbdi_hybrid_status(m, w, doubt, given->dof, a, tau);
}
#endif

RBD_API rbd_status rbd_hybrid(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                              const unsigned char *given, const rbd_real *f_ext, rbd_real *a, rbd_real *tau) {
    const rbd_status status = rbdi_check(m, w, q && v && given && a && tau);
    rbdi_given held;
    rbdi_mask doubt;
    int reach;
    if (status) return status;
    held.dof = given, held.a = a;
#ifndef RBDI_NO_FD_CHOLESKY
    if (m->nmimic) return rbdi_hybrid_mimic(m, w, q, v, &held, f_ext, a, tau);
#endif
    rbdi_joints(m, w, q);
    reach = rbdi_reach(m, given);
    w->singular = -1;
    if (reach == 0) {
        rbdi_rnea(m, w, v, a, f_ext, tau);
        return RBD_OK;
    }
    if (reach == 1) {
        for (int k = 0; k < m->nv; ++k)
            if (!given[k]) a[k] = rbdi_zero();
        rbdi_rnea(m, w, v, a, f_ext, w->bias);
        doubt = rbdi_rigid_up_all(m, w, &held, w->bias, a, tau);
        rbdi_rigid_down_all(m, w, w->bias, tau);
    } else {
        rbdi_aba_velocities(m, w, v, 0);
        rbdi_external(m, w, f_ext);
        doubt = rbdi_hybrid_pass2(m, w, &held, tau);
        rbdi_hybrid_pass3(m, w, &held, a, tau);
    }
    return rbdi_hybrid_status(m, w, doubt, given, a, tau);
}
#endif

#ifndef RBDI_NO_FD_CHOLESKY
RBD_API rbd_status rbd_fd_cholesky(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                   const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check(m, w, q && v && tau && a);
    if (status) return status;
    rbd_crba_packed(m, w, q, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_rnea(m, w, rbdi_expand_v(m, v, w->vx), w->zero, f_ext, m->nmimic ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int k = 0; k < m->nv; ++k) a[k] = tau[k] - w->bias[k];
    rbdi_solve(m, w->H, a);
    return rbdi_status_of(m, w, doubt, a, m->nv);
}
#endif

#endif
