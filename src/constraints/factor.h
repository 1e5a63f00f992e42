#ifndef RBDI_CONSTRAINTS_FACTOR_H
#define RBDI_CONSTRAINTS_FACTOR_H
#include "base/simd.h"
#include "algebra/vectors.h"
#include "constraints/layout.h"
#include "constraints/tolerances.h"

/* Interface: rbdi_bound_noise, rbdi_delta */

/* ---- factor [factor] ----
   Both ways of [design] factor Delta = Y' D^-1 Y by Cholesky and solve Delta lambda = b:

       Delta = R'R,   R' beta = b,   R lambda = beta

   b stands in column `rows` of Delta's array, and becomes beta while R replaces Delta. */

/* x'y */
RBDI_INLINE rbd_real rbdi_rows_product(const rbd_real *x, const rbd_real *y, int n) {
    rbdi_sum batches = rbdi_sum_of_none();
    rbd_real sum;
    int k = 0;

    for (; k + RBDI_BATCH <= n; k += RBDI_BATCH)
        batches = rbdi_sum_and(batches, *(const rbdi_batch *)&x[k] * *(const rbdi_batch *)&y[k]);

    sum = rbdi_sum_value(batches);
    for (; k < n; ++k) sum = sum + x[k] * y[k];
    return sum;
}

/* Computes c->noise. Rounding in an entry of J is a share of its lever arm, here the distance r of a link
   from the world's origin; Delta has its square times 1/D:

       noise = RBDI_MOTIONLESS^2 (1 + sum r^2) sum 1/D */
RBDI_LOCAL void rbdi_bound_noise(const rbd_model *m, rbd_constraint_set *c) {
    rbd_real levers = rbdi_set(RBD_C(1)), inverse = rbdi_zero();

    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        for (int side = 0; side < 2; ++side)
            if (con->link[side] >= 0)
                levers = levers + rbdi_dot(c->w->kin[con->link[side]].X.r, c->w->kin[con->link[side]].X.r);

    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) inverse = inverse + c->D_inverse[k];

    c->noise = levers * inverse * (RBDI_MOTIONLESS * RBDI_MOTIONLESS);
}

/* Two consecutive batches of a row. */
typedef struct rbdi_batches {
    rbdi_batch first, second;
} rbdi_batches;

/* Rows i .. i + n - 1 of Delta = Y' D^-1 Y from the diagonal on, and b behind them. dof: where they have
   entries. */
RBDI_INLINE void rbdi_delta_rows(const rbd_constraint_set *c, const int16_t *dof, int dofs, int i, int n) {
    const int stride = c->stride;
    rbd_real *R = c->R + i * stride;
    for (int j = i; j <= c->rows; j += 2 * RBDI_BATCH) {
        rbdi_batches sum[6];
        RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
            sum[r].first = sum[r].second = rbdi_all_lanes(rbdi_zero());
        }

        while (dofs > 0 && c->span[dof[dofs - 1]].end <= j) --dofs; /* its rows of Y end there */
        for (int t = 0; t < dofs; ++t) {
            const rbd_real *own = c->Y + dof[t] * stride, inverse = c->D_inverse[dof[t]];
            const rbdi_batch first = *(const rbdi_batch *)&own[j] * inverse,
                             second = *(const rbdi_batch *)&own[j + RBDI_BATCH] * inverse;

            RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
                sum[r].first = sum[r].first + first * own[i + r];
                sum[r].second = sum[r].second + second * own[i + r];
            }
        }

        RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
            *(rbdi_batch *)&R[r * stride + j] = sum[r].first;
            *(rbdi_batch *)&R[r * stride + j + RBDI_BATCH] = sum[r].second;
        }
    }

    for (int r = 0; r < n; ++r) R[r * stride + c->rows] = c->b[i + r];
}

/* The same for any number of rows, in blocks of 6 and 3 as constants for the compiler. dof: ascending. */
RBDI_LOCAL void rbdi_delta(const rbd_constraint_set *c, const int16_t *dof, int dofs, int row, int rows) {
    for (int i = row, n; i < row + rows; i += n) {
        n = row + rows - i >= 6 ? 6 : row + rows - i >= 3 ? 3 : 1;

        if (RBDI_FOR_SPEED && n == 6)
            rbdi_delta_rows(c, dof, dofs, i, 6);
        else if (RBDI_FOR_SPEED && n == 3)
            rbdi_delta_rows(c, dof, dofs, i, 3);
        else
            rbdi_delta_rows(c, dof, dofs, i, n);
    }
}

/* Two batches of row t of Delta from column j on, minus the products of the rows of R before it:

       Delta_tj - sum_(i < t) R_it R_ij */
RBDI_INLINE rbdi_batches rbdi_less_rows(const rbd_constraint_set *c, int t, int j) {
    const int stride = c->stride;
    const rbd_real *row = &c->R[t * stride];
    rbdi_batches two = {*(const rbdi_batch *)&row[j], *(const rbdi_batch *)&row[j + RBDI_BATCH]};

    for (const rbd_real *before = c->R; before < row; before += stride) {
        two.first = two.first - *(const rbdi_batch *)&before[j] * before[t];
        two.second = two.second - *(const rbdi_batch *)&before[j + RBDI_BATCH] * before[t];
    }

    return two;
}

/* Replaces row t of Delta by that of R, and b_t by beta_t. noise: c->noise / RBDI_CLEAR. Returns whether the
   pivot is in doubt. */
RBDI_INLINE rbdi_mask rbdi_factor_row(rbd_constraint_set *c, int t, rbd_real noise) {
    rbd_real *R = &c->R[t * c->stride], inverse;
    const rbd_real least = (R[t] + noise) * RBDI_CLEAR;
    rbdi_mask none = rbdi_less(least, least), doubt;
    rbdi_batches two = rbdi_less_rows(c, t, t);

    /* the pivot R_tt^2 beside Delta_tt */
    *(rbdi_batch *)&R[t] = two.first;
    doubt = rbdi_not(rbdi_less(least, R[t]));
#ifdef RBDI_ROWS /* rbd-codegen: the verdict comes behind what is recorded */
    RBDI_ROWS(pivot)(R[t], least);
#endif

    /* the row over its root, and beta_t in its column `rows` */
    inverse = rbdi_sqrt(rbdi_reciprocal(R[t], RBDI_TINY, &none));
    c->R_inverse[t] = inverse;
    for (int j = t;;) {
        *(rbdi_batch *)&R[j] = two.first * inverse;
        *(rbdi_batch *)&R[j + RBDI_BATCH] = two.second * inverse;
        j += 2 * RBDI_BATCH;
        if (j > c->rows) return doubt;
        two = rbdi_less_rows(c, t, j);
    }
}

/* Solves R lambda = beta: lambda_t = (beta_t - sum_(j > t) R_tj lambda_j) / R_tt. Entries of lambda behind
   the last row are 0. */
RBDI_LOCAL void rbdi_back_substitute(rbd_constraint_set *c) {
    for (int t = c->rows - 1; t >= 0; --t) {
        const rbd_real *R = &c->R[t * c->stride];
        rbdi_sum sum = rbdi_sum_of_none();
        for (int j = t + 1; j < c->rows; j += RBDI_BATCH)
            sum = rbdi_sum_and(sum, *(const rbdi_batch *)&R[j] * *(const rbdi_batch *)&c->lambda[j]);
        c->lambda[t] = c->R_inverse[t] * (R[c->rows] - rbdi_sum_value(sum));
    }
}

/* Computes R and beta from Y, D and b. Returns whether a pivot is in doubt. */
RBDI_LOCAL rbdi_mask rbdi_factor_delta(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    rbd_real noise;
    rbdi_bound_noise(m, c);
    noise = c->noise * (1 / RBDI_CLEAR);

    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        rbdi_delta(c, con->dof, con->dofs, con->row, con->rows);
        for (int t = con->row; t < con->row + con->rows; ++t)
            doubt = rbdi_or(doubt, rbdi_factor_row(c, t, noise));
    }

    return doubt;
}

#endif
