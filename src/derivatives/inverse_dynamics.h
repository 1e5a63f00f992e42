#ifndef RBDI_DERIVATIVES_INVERSE_DYNAMICS_H
#define RBDI_DERIVATIVES_INVERSE_DYNAMICS_H
#include "derivatives/subtrees.h"
#include "derivatives/memory.h"

/* ---- derivatives of inverse dynamics [inverse dynamics code] ---- */

RBDI_API rbd_status rbd_id_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                       rbd_real *dtau_dq, rbd_real *dtau_dv, rbd_real *M) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && a);
    if (status) return status;
    rbdi_common(m, d, q, v, a, d->work->gravity, f_ext, RBDI_NEED_V | RBDI_NEED_WRENCH | RBDI_NEED_WHOLE);
    if (dtau_dq) rbdi_columns_by_q(d);
    rbdi_put_entries(m, d, dtau_dq, dtau_dv, M, RBDI_ENTRIES);
    rbdi_put_base_block(d, dtau_dq, dtau_dv, M);
    return RBD_OK;
}

RBDI_API rbd_status rbd_gravity_torque_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                                   rbd_real *dg_dq) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && dg_dq);
    if (status) return status;
    rbdi_common(m, d, q, d->work->zero, d->work->zero, d->work->gravity, NULL,
                RBDI_NEED_V | RBDI_NEED_WRENCH | RBDI_NEED_WHOLE);
    rbdi_columns_by_q(d);
    rbdi_put_entries(m, d, dg_dq, NULL, NULL, RBDI_ENTRIES);
    rbdi_put_base_block(d, dg_dq, NULL, NULL);
    return RBD_OK;
}

RBDI_API rbd_status rbd_keep_zeros(rbd_derivatives *d, int keep) {
    if (!d) return RBD_ERR_NULL;
    d->keep_zeros = keep;
    return RBD_OK;
}

#endif
