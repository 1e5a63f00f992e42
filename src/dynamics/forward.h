#ifndef RBDI_DYNAMICS_FORWARD_H
#define RBDI_DYNAMICS_FORWARD_H
#include "api/model.h"
#include "dynamics/rnea.h"
#include "dynamics/aba.h"
#include "dynamics/packed.h"
#include "dynamics/aba_pivots.h"

/* ---- forward dynamics [forward dynamics code] ---- */

RBDI_API rbd_status rbd_aba(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                            const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && tau && a);
    if (status) return status;
#ifndef RBD_NO_CHOLESKY
    /* a joint and its mimic are one dof at two links, which no sweep can eliminate at one of them */
    if (rbdi_mimics(m)) return rbd_fd_cholesky(m, w, q, v, tau, f_ext, a);
#endif

    rbdi_joints(m, w, q);
    rbdi_aba_velocities(m, w, v, 0);
    rbdi_external(m, w, f_ext);
    doubt = rbdi_aba_pass2(m, w, tau);
    rbdi_aba_pass3(m, w, rbdi_world_state(w->gravity).acc, a);

    w->singular = -1;
    if (!rbdi_any(doubt)) return RBD_OK;
    rbdi_check_bodies(m, w, doubt);
    return rbdi_pivot_status(m, w, a, m->nv);
}

#ifndef RBD_NO_CHOLESKY
RBDI_API rbd_status rbd_fd_cholesky(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && tau && a);
    if (status) return status;

    rbd_crba_packed(m, w, q, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_rnea(m, w, rbdi_expand_v(m, v, w->vx), w->zero, f_ext, rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int k = 0; k < m->nv; ++k) a[k] = tau[k] - w->bias[k];
    rbdi_solve(m, w, w->H, a);
    return rbdi_factor_status(m, w, w->H, doubt, a, m->nv);
}

RBDI_API rbd_status rbd_cholesky_factor_packed(const rbd_model *m, rbd_work *w, rbd_real *H) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, H != NULL);
    if (status) return status;
    doubt = rbdi_factor(m, w, H);
    return rbdi_factor_status(m, w, H, doubt, H, rbd_packed_size(m));
}

RBDI_API rbd_status rbd_cholesky_factor(const rbd_model *m, rbd_work *w, const rbd_real *M, rbd_real *L) {
    const rbd_status status = rbdi_check_dynamics(m, w, M && L);
    if (status) return status;

    for (int i = 0; i < m->nv; ++i) { /* L may be M, because packed rows end before the full ones do */
        const int depth = m->dof[i].depth;
        rbd_real *row = &L[m->dof[i].row];
        for (int t = depth, j = i; t >= 0; --t, j = m->dof[j].lambda) w->bias[t] = M[i * m->nv + j];
        for (int t = 0; t <= depth; ++t) row[t] = w->bias[t];
    }

    return rbd_cholesky_factor_packed(m, w, L);
}

RBDI_API rbd_status rbd_cholesky_solve(const rbd_model *m, rbd_work *w, const rbd_real *L, const rbd_real *b,
                                       rbd_real *x) {
    const rbd_status status = rbdi_check(m, w, L && b && x);
    if (status) return status;
    for (int k = 0; k < m->nv; ++k) x[k] = b[k];
    rbdi_solve(m, w, L, x);
    return RBD_OK;
}

RBDI_API rbd_status rbd_cholesky_solve_many(const rbd_model *m, rbd_work *w, const rbd_real *L, int n,
                                            const rbd_real *B, rbd_real *X) {
    const rbd_status status = rbdi_check(m, w, L && B && X);
    if (status) return status;
    if (n <= 0) return RBD_OK;
    if (X != B)
        for (ptrdiff_t k = 0; k < (ptrdiff_t)m->nv * n; ++k) X[k] = B[k];
    rbdi_solve_columns(m, w, L, 1, n, n, X);
    return RBD_OK;
}

RBDI_API rbd_status rbd_minverse(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *Minv) {
    rbdi_mask doubt;
    const rbd_status status = rbdi_check_dynamics(m, w, q && Minv);
    if (status) return status;
    rbd_crba_packed(m, w, q, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_invert(m, w, w->H, Minv);
    return rbdi_factor_status(m, w, w->H, doubt, Minv, m->nv * m->nv);
}
#endif

RBDI_API int rbd_singular_dof(const rbd_work *w) { return w ? w->singular : -1; }

#endif
