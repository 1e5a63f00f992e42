#ifndef RBDI_DYNAMICS_FORWARD_H
#define RBDI_DYNAMICS_FORWARD_H
#include "dynamics/rnea.h"
#include "dynamics/aba.h"
#include "dynamics/pivots.h"

/* ---- forward dynamics [forward dynamics code] ---- */

RBDI_API rbd_status rbd_aba(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                            const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check(m, w, q && v && tau && a);
    if (status) return status;
#ifndef RBD_NO_CHOLESKY
    if (m->nmimic) return rbd_fd_cholesky(m, w, q, v, tau, f_ext, a);
#endif
    rbdi_joints(m, w, q);
    rbdi_aba_velocities(m, w, v, 0);
    rbdi_external(m, w, f_ext);
    doubt = rbdi_aba_pass2(m, w, tau);
    rbdi_aba_pass3(m, w, a);
    return rbdi_status_of(m, w, doubt, a, m->nv);
}

#ifndef RBD_NO_CHOLESKY
RBDI_API rbd_status rbd_fd_cholesky(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check(m, w, q && v && tau && a);
    if (status) return status;
    rbd_crba_packed(m, w, q, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_rnea(m, w, rbdi_expand_v(m, v, w->vx), w->zero, f_ext, m->nmimic ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int k = 0; k < m->nv; ++k) a[k] = tau[k] - w->bias[k];
    rbdi_solve(m, w, w->H, a);
    return rbdi_status_of(m, w, doubt, a, m->nv);
}
#endif

#endif
