#ifndef RBDI_CONSTRAINTS_FACTOR_H
#define RBDI_CONSTRAINTS_FACTOR_H
#include "base/sincos.h"
#include "algebra/vectors.h"
#include "constraints/layout.h"
#include "constraints/tolerances.h"

/* ---- factor [factor] ----
   Delta = Y' D^-1 Y of both ways of [design] and its Cholesky factor:

       Delta = R'R,   R' beta = b,   R lambda = beta

   Row t of R needs the rows before it alone, so articulated bodies add rows as they become known. beta is
   column `rows` of R, as Delta has b there. Columns behind it are 0. */

/* sum of x_k y_k */
RBDI_INLINE rbd_real rbdi_rows_product(const rbd_real *x, const rbd_real *y, int n) {
    rbdi_batch lanes = rbdi_zero_batch();
    rbd_real sum = rbdi_zero();
    int k = 0;
    for (; k + RBDI_BATCH <= n; k += RBDI_BATCH)
        lanes = lanes + *(const rbdi_batch *)&x[k] * *(const rbdi_batch *)&y[k];
    if (k > 0) sum = rbdi_sum_lanes(lanes);
    for (; k < n; ++k) sum = sum + x[k] * y[k];
    return sum;
}

/* The sum of the squares of the distances of a constraint's links from the world's origin. */
RBDI_INLINE void rbdi_add_levers(rbd_constraint_set *c, const rbdi_constraint *k) {
    for (int side = 0; side < 2; ++side)
        if (k->link[side] >= 0)
            c->levers = c->levers + rbdi_dot(c->w->kin[k->link[side]].X.r, c->w->kin[k->link[side]].X.r);
}

/* The square that rounding of J's entries may give a row: RBDI_MOTIONLESS of their levers. */
static rbd_real rbdi_row_noise(const rbd_constraint_set *c) {
    return c->levers * c->give * (RBDI_MOTIONLESS * RBDI_MOTIONLESS);
}

/* Where the dofs that move a constraint's rows have their rows of Y, and 1/D: c->path, c->stack. whole: of
   the paths from the world; else from the common ancestor. Returns their number. */
RBDI_INLINE int rbdi_list_dofs(const rbd_constraint_set *c, const rbdi_constraint *k, int whole) {
    const int first = whole ? 0 : k->trunk, n = k->dofs - first, stride = c->stride;
    const int16_t *dof = k->dof + first;
    int32_t *path = c->path;
    rbd_real *inverse = c->stack;
    for (int t = 0; t < n; ++t) path[t] = (int32_t)(dof[t] * stride), inverse[t] = c->D_inverse[dof[t]];
    return n;
}

/* Rows i .. i + n - 1 of Delta from the diagonal on, of so many dofs. */
RBDI_INLINE void rbdi_delta_rows(const rbd_constraint_set *c, int i, int n, const rbdi_span *span,
                                 const int16_t *dof, int dofs) {
    const rbd_real *inverse = c->stack, *Y = c->Y;
    const int32_t *path = c->path;
    const int stride = c->stride;
    rbd_real *R = c->R + i * stride;
    for (int j = i; j <= c->rows; j += 2 * RBDI_BATCH) {
        rbdi_batch x[6], y[6];
        RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) { x[r] = y[r] = rbdi_zero_batch(); }
        while (dofs > 0 && span[dof[dofs - 1]].end <= j) --dofs; /* its rows of Y end there */
        for (int t = 0; t < dofs; ++t) {
            const rbd_real *own = Y + path[t];
            const rbdi_batch u = *(const rbdi_batch *)&own[j] * inverse[t],
                             v = *(const rbdi_batch *)&own[j + RBDI_BATCH] * inverse[t];
            RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
                x[r] = x[r] + u * own[i + r];
                y[r] = y[r] + v * own[i + r];
            }
        }
        RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
            *(rbdi_batch *)&R[r * stride + j] = x[r];
            *(rbdi_batch *)&R[r * stride + j + RBDI_BATCH] = y[r];
        }
    }
    for (int r = 0; r < n; ++r) R[r * stride + c->rows] = c->b[i + r];
}
static void rbdi_delta(const rbd_constraint_set *c, const rbdi_constraint *k, int whole) {
    const int dofs = rbdi_list_dofs(c, k, whole), stop = k->row + k->rows;
    const rbdi_span *span = whole ? c->span : c->passed;
    const int16_t *dof = k->dof + k->dofs - dofs;
    for (int i = k->row, n; i < stop; i += n) {
        n = stop - i >= 6 ? 6 : stop - i >= 3 ? 3 : 1;
        if (n == 6)
            rbdi_delta_rows(c, i, 6, span, dof, dofs);
        else if (n == 3)
            rbdi_delta_rows(c, i, 3, span, dof, dofs);
        else
            rbdi_delta_rows(c, i, 1, span, dof, dofs);
    }
}

/* Two batches of row t, from column j on, less what rows low .. t - 1 take. */
typedef struct rbdi_batches {
    rbdi_batch x, y;
} rbdi_batches;
RBDI_INLINE rbdi_batches rbdi_less_rows(const rbd_constraint_set *c, int t, int low, int j) {
    const int stride = c->stride;
    const rbd_real *r = &c->R[low * stride], *row = &c->R[t * stride];
    rbdi_batches b = {*(const rbdi_batch *)&row[j], *(const rbdi_batch *)&row[j + RBDI_BATCH]};
    for (; r < row; r += stride) {
        b.x = b.x - *(const rbdi_batch *)&r[j] * r[t];
        b.y = b.y - *(const rbdi_batch *)&r[j + RBDI_BATCH] * r[t];
    }
    return b;
}

/* Row t of R, and beta, in place of that of Delta. Returns whether its pivot is in doubt. */
RBDI_INLINE rbdi_mask rbdi_factor_row(rbd_constraint_set *c, int t, int low, int end, rbd_real noise) {
    rbd_real *R = &c->R[t * c->stride], inverse;
    const rbd_real least = (R[t] + noise) * RBDI_CLEAR;
    rbdi_mask none = rbdi_less(least, least), doubt;
    rbdi_batches b = rbdi_less_rows(c, t, low, t);
    *(rbdi_batch *)&R[t] = b.x;
    doubt = rbdi_not(rbdi_less(least, R[t]));
    c->inverse[t] = inverse = rbdi_sqrt(rbdi_reciprocal(R[t], RBDI_TINY, &none));
    for (int j = t;;) {
        *(rbdi_batch *)&R[j] = b.x * inverse, *(rbdi_batch *)&R[j + RBDI_BATCH] = b.y * inverse;
        if (j == c->rows || (j += 2 * RBDI_BATCH) > c->rows) return doubt;
        if (j >= end) j = c->rows; /* beta */
        b = rbdi_less_rows(c, t, low, j);
    }
}

/* lambda of rows first .. last - 1, that of the rows behind them being known up to `end`. */
static void rbdi_back_substitute(rbd_constraint_set *c, int first, int last, int end) {
    for (int t = last - 1; t >= first; --t) {
        const rbd_real *R = &c->R[t * c->stride];
        rbdi_batch sum = rbdi_zero_batch();
        for (int j = t + 1; j < end; j += RBDI_BATCH)
            sum = sum + *(const rbdi_batch *)&R[j] * *(const rbdi_batch *)&c->lambda[j];
        c->lambda[t] = c->inverse[t] * (R[c->rows] - rbdi_sum_lanes(sum));
    }
}

/* Rows of R and beta of a constraint. whole: as rbdi_list_dofs. Returns whether a pivot is in doubt. */
static rbdi_mask rbdi_factor_rows(rbd_constraint_set *c, const rbdi_constraint *k, int whole) {
    const rbd_real noise = rbdi_row_noise(c) * (1 / RBDI_CLEAR);
    const int low = whole ? 0 : k->low, end = whole ? c->rows : k->end;
    rbdi_mask doubt = rbdi_less(noise, noise);
    rbdi_delta(c, k, whole);
    for (int t = k->row; t < k->row + k->rows; ++t)
        doubt = rbdi_or(doubt, rbdi_factor_row(c, t, low, end, noise));
    return doubt;
}

#endif
