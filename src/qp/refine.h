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

/* y = H x + f. Returns the largest of the sums |f_k| + |H_k1 x_1| + ... */
RBDI_PART rbd_real rbdi_qp_gradient(const rbdi_qp *s, const rbd_real *x, rbd_real *y) {
    rbd_real largest = 0, terms;

    for (int k = 0; k < s->n; ++k) {
        const rbd_real f = s->given.f[k];
        y[k] = rbdi_qp_h_times(s, k, x, &terms) + f;
        largest = rbdi_qp_larger(largest, rbdi_qp_abs(f) + terms);
    }
    return largest;
}

/* t = r1 without the equalities' part, r = r2, and the values of these rows at x. Returns the largest |r2|,
   as a share of its row's length; raises *size to the largest term of the cost in r1, *push to that of all
   rows. */
RBDI_PART rbd_real rbdi_qp_residuals(rbdi_qp *s, const rbd_real *x, rbd_real *size, rbd_real *push) {
    rbd_real missed = 0;

    *size = rbdi_qp_larger(*size, rbdi_qp_gradient(s, x, s->t));
    for (int i = 0; i < s->n; ++i) s->t[i] = s->rho * (s->centre[i] - x[i]) - s->t[i];

    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        const rbd_real sign = rbdi_qp_sign(s->side[row]), weight = rbdi_qp_weight(s, row);

        s->value[row] = rbdi_qp_row_times(s, row, x);
        s->r[j] = sign * (rbdi_qp_side(s, row) - s->value[row]);
        if (weight > 0) s->r[j] = s->r[j] - s->u[j] / weight;
        missed = rbdi_qp_larger(missed, rbdi_qp_abs(s->r[j]) * s->unit[row]);
        const rbd_real term = rbdi_qp_abs(s->u[j]) / s->unit[row];
        if (weight > 0) *size = rbdi_qp_larger(*size, term);
        *push = rbdi_qp_larger(*push, term);
        rbdi_qp_add_row(s, row, sign * s->u[j], s->t);
    }
    for (int e = 0; e < s->equalities; ++e) {
        const int row = s->equality[e];
        s->value[row] = rbdi_qp_row_times(s, row, x);
        missed = rbdi_qp_larger(missed, rbdi_qp_abs(s->value[row] - s->given.upper[row]) * s->unit[row]);
    }
    return missed;
}

/* result.dual: the largest |t_k|, where t is what Hx + f + C'lambda leaves, as a share of `size`, the largest
   term of the cost: of Hx + f, and lambda of a soft row. Not of a hard row, whose largest is `push`: where
   rows nearly depend on each other, their lambda may be so large that its rounding, which counts, is all of
   the gradient. s->balance is the share of the larger of the two. Both are not a number if a t_k is none. */
RBDI_PART void rbdi_qp_judge(rbdi_qp *s, rbd_real size, rbd_real push) {
    const rbd_real larger = rbdi_qp_larger(size, push);
    rbd_real worst = rbdi_qp_largest(s->t, s->n), sum = 0;

    for (int k = 0; k < s->n; ++k) sum = sum + s->t[k];
    worst = worst + (sum - sum);
    s->balance = larger > 0 ? worst / larger : worst;

    worst = worst + RBDI_EPS * (larger - size);
    s->result.dual = size > 0 ? worst / size : worst;
}

/* One correction, from t = r1 and r = r2. */
RBDI_PART void rbdi_qp_correct(rbdi_qp *s, rbd_real *x) {
    const int n = s->n;

    rbdi_qp_clear(s->z, n);
    if (s->equalities) rbdi_qp_onto_equalities(s, 1, s->z);
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        s->r[j] = s->r[j] - rbdi_qp_sign(s->side[row]) * rbdi_qp_row_times(s, row, s->z);
    }

    /* d = (y1; y2), r = R^-1 (y1 - J1'r1) */
    rbdi_qp_project(s, s->t, s->d);
    rbdi_qp_solve_r_transposed(s, s->r);
    for (int j = 0; j < s->q; ++j) {
        const rbd_real y = s->r[j];
        s->r[j] = y - s->d[j];
        s->d[j] = y;
    }
    rbdi_qp_solve_r(s, s->r);

    for (int k = 0; k < n; ++k) x[k] = x[k] + s->z[k];
    rbdi_qp_add_columns(s, 0, s->columns, s->d, x);
    for (int j = 0; j < s->q; ++j) s->u[j] = s->u[j] + s->r[j];
}

/* The multipliers of the equalities; result.dual; and corrections where the residuals exceed rounding of x,
   which may be far less than it was on the way. Returns whether x has changed. */
RBDI_PART int rbdi_qp_refine(rbdi_qp *s, rbd_real *x) {
    for (int corrections = 0;; ++corrections) {
        const rbd_real furthest = rbdi_qp_size(s, x);
        rbd_real size = s->rho * furthest, push = 0;
        const rbd_real missed = rbdi_qp_residuals(s, x, &size, &push);

        rbdi_qp_balance(s, s->t, s->z);
        for (int e = 0; e < s->equalities; ++e)
            push = rbdi_qp_larger(push, rbdi_qp_abs(s->u_equal[e]) / s->unit[s->equality[e]]);
        rbdi_qp_judge(s, size, push);

        if (s->balance <= RBDI_QP_REFINED && missed <= RBDI_QP_REFINED * furthest) return corrections > 0;
        if (corrections == RBDI_QP_REFINEMENTS) return 1;
        rbdi_qp_correct(s, x);
    }
}

#endif
