#ifndef RBDI_QP_REFINE_H
#define RBDI_QP_REFINE_H
#include "qp/active.h"

/* ---- refinement [refinement] ----
   The residuals of the optimum on the active rows,

       r1 = -(H x + rho x + g) + N u + A'u_equal,   r2 = b - N'x - u/w   (0 for a hard row's u/w)

   and their correction by the factors at hand:

       x_E = L'^-1 Q (R_E'^-1 r2_E; 0),   y1 = R'^-1 (r2 - N'x_E),   y2 = J2'r1,
       x += x_E + J (y1; y2),   u += R^-1 (y1 - J1'r1) */

#define RBDI_QP_REFINED (16 * RBDI_EPS) /* shares below this are rounding */
#define RBDI_QP_REFINEMENTS 2

/* t = r1 without the equalities' part, r = r2. Returns the largest |r2|, as a share of its row's length;
   *size: the largest term of r1. */
RBDI_PART rbd_real rbdi_qp_residuals(rbdi_qp *s, const rbd_real *x, rbd_real *size) {
    const int n = s->n;
    rbd_real missed = 0;

    *size = 0;
    for (int i = 0; i < n; ++i) {
        const rbd_real h = rbdi_qp_h_times(s, i, x);
        s->t[i] = -(h + s->rho * x[i] + s->g[i]);
        *size = rbdi_qp_larger(*size, rbdi_qp_larger(rbdi_abs(h), rbdi_abs(s->g[i])));
    }
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        const rbd_real sign = rbdi_qp_sign(s->side[row]), weight = rbdi_qp_weight(s, row);

        s->r[j] = sign * (rbdi_qp_side(s, row) - rbdi_qp_row_times(s, row, x));
        if (weight > 0) s->r[j] = s->r[j] - s->u[j] / weight;
        missed = rbdi_qp_larger(missed, rbdi_abs(s->r[j]) * s->unit[row]);
        *size = rbdi_qp_larger(*size, rbdi_abs(s->u[j]) / s->unit[row]);
        rbdi_qp_add_row(s, row, sign * s->u[j], s->t);
    }
    for (int e = 0; e < s->equalities; ++e) {
        const int row = s->equality[e];
        const rbd_real by = rbdi_qp_row_times(s, row, x) - s->given.upper[row];
        missed = rbdi_qp_larger(missed, rbdi_abs(by) * s->unit[row]);
    }
    return missed;
}

/* One correction, from t = r1 and r = r2. */
RBDI_PART void rbdi_qp_correct(rbdi_qp *s, rbd_real *x) {
    const int n = s->n;

    rbdi_qp_clear(s->z, n);
    if (s->equalities) rbdi_qp_onto_equalities(s, x, s->z);
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        s->r[j] = s->r[j] - rbdi_qp_sign(s->side[row]) * rbdi_qp_row_times(s, row, s->z);
    }

    /* d = (y1; y2), r = R^-1 (y1 - J1'r1) */
    for (int j = 0; j < s->columns; ++j) s->d[j] = rbdi_qp_dot(rbdi_qp_j(s, j), s->t, n);
    rbdi_qp_solve_r_transposed(s, s->r);
    for (int j = 0; j < s->q; ++j) {
        const rbd_real y = s->r[j];
        s->r[j] = y - s->d[j];
        s->d[j] = y;
    }
    rbdi_qp_solve_r(s, s->r);

    for (int k = 0; k < n; ++k) x[k] = x[k] + s->z[k];
    rbdi_qp_add_columns(s, 0, s->d, x);
    for (int j = 0; j < s->q; ++j) s->u[j] = s->u[j] + s->r[j];
}

/* The multipliers of the equalities; result.dual; and corrections where the residuals exceed rounding of x,
   which may be far less than it was on the way. */
RBDI_PART void rbdi_qp_refine(rbdi_qp *s, rbd_real *x) {
    for (int corrections = 0;; ++corrections) {
        rbd_real size, worst;
        const rbd_real missed = rbdi_qp_residuals(s, x, &size);
        const rbd_real furthest = rbdi_qp_larger(rbdi_qp_largest(x, s->n), RBDI_QP_CANCELLED * s->furthest);

        rbdi_qp_balance(s, s->t, s->z);
        worst = rbdi_qp_largest(s->t, s->n);
        s->result.dual = size > 0 ? worst / size : worst;

        if (s->result.dual <= RBDI_QP_REFINED && missed <= RBDI_QP_REFINED * furthest) return;
        if (corrections == RBDI_QP_REFINEMENTS) return;
        rbdi_qp_correct(s, x);
    }
}

#endif
