#ifndef RBDI_ESTIMATE_SAMPLES_H
#define RBDI_ESTIMATE_SAMPLES_H
#include "derivatives/regressors.h"
#include "estimate/triangles.h"
#include "estimate/check.h"
#include "estimate/pseudo_inertia.h"

/* ---- samples [samples] ---- */

/* Whether dof i tells something: it is measured, and moves if it has friction. */
RBDI_INLINE int rbdi_est_tells(const rbd_estimate *e, int i, rbd_real v) {
    return e->kind[i] == RBDI_EST_PLAIN || (e->kind[i] == RBDI_EST_RUBS && rbdi_abs(v) > e->slow);
}

/* The row of dof i, over its noise. */
RBDI_LOCAL void rbdi_est_sample_row(const rbd_estimate *e, int i, rbd_real v, rbd_real *x) {
    const rbd_real certain = e->certain[i];
    const int rubs = e->kind[i] == RBDI_EST_RUBS;

    x[0] = rbdi_set(rubs ? RBD_C(1) : RBD_C(0));
    x[1] = rbdi_set(!rubs ? RBD_C(0) : v > 0 ? RBD_C(1) : RBD_C(-1));
    x[2] = rubs ? v : rbdi_zero();
    rbdi_est_pseudo_factors(e->y + 10 * i, e->scale, x + RBDI_EST_FRICTIONS);
    x[RBDI_EST_WHOLE_ROW - 1] = e->left[i];
    rbdi_est_scale_all(x, RBDI_EST_WHOLE_ROW, certain);
}

/* The rows of all dofs that tell something; refuses what is too large. */
RBDI_LOCAL rbd_status rbdi_est_sample_rows(const rbd_estimate *e, const rbd_real *v,
                                           rbd_estimate_fault *fault) {
    for (int i = 0; i < e->nv; ++i) {
        rbd_real *x = e->row + i * RBDI_EST_WHOLE_ROW;
        if (!rbdi_est_tells(e, i, v[i])) continue;

        rbdi_est_sample_row(e, i, v[i], x);
        for (int k = 0; k < RBDI_EST_WHOLE_ROW; ++k)
            if (!rbdi_est_between(x[k], -RBDI_EST_LARGE, RBDI_EST_LARGE))
                return rbdi_est_fault(fault, RBD_ERR_RANGE, "tau", i);
    }
    return RBD_OK;
}

/* What the robot without payload and friction leaves of tau, and the regressor of the payload. */
RBDI_LOCAL rbd_status rbdi_est_sample(const rbd_model *m, rbd_derivatives *d, const rbd_estimate *e,
                                      const rbd_real *q, const rbd_real *v, const rbd_real *a,
                                      const rbd_real *tau) {
    const rbd_status status = rbd_rnea(m, d->work, q, v, a, NULL, e->left);
    if (status) return status;
    for (int i = 0; i < m->nv; ++i) e->left[i] = tau[i] - e->left[i];

    rbdi_clear(e->y, 10 * m->nv);
    if (e->known || m->frame[e->body].link < 0) return RBD_OK;
    rbdi_regressor_motion(m, d, q, v, a);
    rbdi_regress_body(m, d, &m->frame[e->body], e->y, 10);
    return RBD_OK;
}

/* Takes in the rows. What is known fades only where new rows come. */
RBDI_LOCAL void rbdi_est_take_rows(rbd_estimate *e, const rbd_real *v) {
    int rows = 0;
    for (int i = 0; i < e->nv; ++i) {
        rbd_real *x = e->row + i * RBDI_EST_WHOLE_ROW, *joint = e->joint + i * RBDI_EST_JOINT_TRIANGLE;
        if (!rbdi_est_tells(e, i, v[i])) continue;

        if (rows++ == 0) {
            rbdi_est_scale_all(e->load, RBDI_EST_LOAD_TRIANGLE, e->kept);
            e->squares = e->squares * e->kept * e->kept;
            e->samples = e->samples * e->kept * e->kept;
        }
        rbdi_est_scale_all(joint, RBDI_EST_JOINT_TRIANGLE, e->kept);

        rbdi_est_absorb(joint, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, x);
        rbdi_est_absorb(e->load, RBDI_EST_TEN, RBDI_EST_TEN_ROW, x + RBDI_EST_FRICTIONS);
        e->squares = e->squares + x[RBDI_EST_WHOLE_ROW - 1] * x[RBDI_EST_WHOLE_ROW - 1];
        e->samples = e->samples + 1;
    }
}

RBDI_LOCAL rbd_status rbdi_est_check_sample(const rbd_model *m, const rbd_derivatives *d,
                                            const rbd_estimate *e, const rbd_real *q, const rbd_real *v,
                                            const rbd_real *a, const rbd_real *tau,
                                            rbd_estimate_fault *fault) {
    rbd_status status = rbdi_check_derivatives(m, d, e && q && v && a && tau);
    if (!status) status = rbdi_est_check_shape(m, e->shape);
    if (!status) status = rbdi_est_check_finite(q, m->nq, "q", fault);
    if (!status) status = rbdi_est_check_finite(v, m->nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(a, m->nv, "a", fault);
    return status ? status : rbdi_est_check_finite(tau, m->nv, "tau", fault);
}

RBDI_API rbd_status rbd_estimate_add(const rbd_model *m, rbd_derivatives *d, rbd_estimate *e,
                                     const rbd_real *q, const rbd_real *v, const rbd_real *a,
                                     const rbd_real *tau, rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    status = rbdi_est_check_sample(m, d, e, q, v, a, tau, fault);
    if (!status) status = rbdi_est_sample(m, d, e, q, v, a, tau);
    if (!status) status = rbdi_est_sample_rows(e, v, fault);
    if (!status) rbdi_est_take_rows(e, v);
    return status;
}

#endif
