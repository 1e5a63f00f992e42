#ifndef RBDI_DYNAMICS_PACKED_H
#define RBDI_DYNAMICS_PACKED_H
#include "model/work.h"
#include "base/sincos.h"
#include "base/memory.h"

/* Interface: rbdi_inverse, rbdi_multiply, rbdi_solve, rbdi_subtract */

/* ---- cholesky [cholesky] ----
   M = L' D L, L unit lower triangular, RBDA section 6.5 and table 6.3: eliminating the last dof first, row k
   changes only the rows of the dofs on its path to the root, so nothing fills. A packed row holds just that
   path, root first, the diagonal last; after the factorisation L, and 1/D on the diagonal. */

/* y *= k, a batch at a time. */
RBDI_INLINE void rbdi_multiply(rbd_real *y, rbd_real k, int n) {
    int j = 0;
#if RBDI_BATCH > 1
    for (; j + RBDI_BATCH <= n; j += RBDI_BATCH) *(rbdi_batch *)&y[j] = *(const rbdi_batch *)&y[j] * k;
#endif
    for (; j < n; ++j) y[j] = y[j] * k;
}

/* y -= k x, a batch at a time. */
RBDI_INLINE void rbdi_subtract(rbd_real *y, rbd_real k, const rbd_real *x, int n) {
    int j = 0;
#if RBDI_BATCH > 1
    for (; j + RBDI_BATCH <= n; j += RBDI_BATCH)
        *(rbdi_batch *)&y[j] = *(const rbdi_batch *)&y[j] - *(const rbdi_batch *)&x[j] * k;
#endif
    for (; j < n; ++j) y[j] = y[j] - k * x[j];
}

/* RBDA table 6.3, M = L'DL, in place on packed rows: row i of the ancestor at position t of row k has
   the same first t + 1 columns, so that the update is a multiple of one row on another. */
RBDI_PART rbdi_mask rbdi_factor(const rbd_model *m, rbd_work *w, rbd_real *H) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int k = m->nv - 1; k >= 0; --k) {
        rbd_real *hk = &H[m->dof[k].row];
        int d = m->dof[k].depth, i = m->dof[k].lambda;
        rbd_real inverse = rbdi_pivot_inverse(hk[d], m->dof[k].scale, &doubt);
        w->pivot[k] = hk[d];
        hk[d] = inverse;
        for (int t = d - 1; t >= 0; --t, i = m->dof[i].lambda) {
            const rbd_real x = hk[t] * inverse;
            rbdi_subtract(&H[m->dof[i].row], x, hk, t + 1);
            hk[t] = x;
        }
    }
    return doubt;
}

/* x = M^-1 x by L' y = x, z = y / D, L x = z. */
RBDI_PART void rbdi_solve(const rbd_model *m, const rbd_real *L, rbd_real *x) {
    for (int k = m->nv - 1; k >= 0; --k) {
        const rbd_real *l = &L[m->dof[k].row], y = x[k];
        int d = m->dof[k].depth;
        for (int t = d - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) x[i] = x[i] - l[t] * y;
    }
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real *l = &L[m->dof[k].row];
        int d = m->dof[k].depth;
        rbd_real y = x[k] * l[d];
        for (int t = d - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) y = y - l[t] * x[i];
        x[k] = y;
    }
}

/* X = sign M^-1 X for so few columns of the rows X, X + stride ... that those of a row stay in registers. */
#define RBDI_COLUMNS 8
RBDI_INLINE void rbdi_solve_columns(const rbd_model *m, const rbd_real *L, ptrdiff_t stride, int sign, int n,
                                    rbd_real *X) {
    rbd_real y[RBDI_COLUMNS];
    for (int k = m->nv - 1; k >= 0; --k) {
        const rbd_real *l = &L[m->dof[k].row];
        RBDI_UNROLL_ROW for (int j = 0; j < n; ++j) y[j] = X[k * stride + j];
        for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) {
            const rbd_real a = l[t];
            rbd_real *x = &X[i * stride];
            RBDI_ONE_INDEX(x);
            RBDI_UNROLL_ROW for (int j = 0; j < n; ++j) x[j] = x[j] - a * y[j];
        }
    }
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real *l = &L[m->dof[k].row];
        const int d = m->dof[k].depth;
        const rbd_real inverse = sign < 0 ? -l[d] : l[d];
        RBDI_UNROLL_ROW for (int j = 0; j < n; ++j) y[j] = X[k * stride + j] * inverse;
        for (int t = d - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) {
            const rbd_real a = l[t], *x = &X[i * stride];
            RBDI_ONE_INDEX(x);
            RBDI_UNROLL_ROW for (int j = 0; j < n; ++j) y[j] = y[j] - a * x[j];
        }
        RBDI_UNROLL_ROW for (int j = 0; j < n; ++j) X[k * stride + j] = y[j];
    }
}

/* The same for n columns. */
RBDI_PART void rbdi_solve_rows(const rbd_model *m, const rbd_real *L, ptrdiff_t stride, int sign, int n,
                               rbd_real *X) {
    for (; n > 0; n -= RBDI_COLUMNS, X += RBDI_COLUMNS) {
#if RBDI_FOR_SPEED
#define RBDI_OF_COLUMNS(n) \
    case n: rbdi_solve_columns(m, L, stride, sign, n, X); break
        switch (n) {
            RBDI_OF_COLUMNS(1);
            RBDI_OF_COLUMNS(2);
            RBDI_OF_COLUMNS(3);
            RBDI_OF_COLUMNS(4);
            RBDI_OF_COLUMNS(5);
            RBDI_OF_COLUMNS(6);
            RBDI_OF_COLUMNS(7);
        default: rbdi_solve_columns(m, L, stride, sign, RBDI_COLUMNS, X); break;
        }
#else
        rbdi_solve_columns(m, L, stride, sign, n < RBDI_COLUMNS ? n : RBDI_COLUMNS, X);
#endif
    }
}

/* Z = M^-1, full. L Z = D^-1 L'^-1 is upper triangular with the diagonal 1/D, so that row k of Z, up to the
   diagonal, is a sum over the rows of the dofs on its path: Z_kj = - sum L_ki Z_ij for j < k, Z_kk = 1/D_k -
   sum L_ki Z_ik. */
RBDI_PART void rbdi_inverse(const rbd_model *m, const rbd_real *L, rbd_real *Z) {
    const ptrdiff_t n = m->nv;
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real *l = &L[m->dof[k].row];
        const int d = m->dof[k].depth;
        rbd_real *row = &Z[k * n], z = l[d];
        rbdi_clear(row, k);
        for (int t = d - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda)
            rbdi_subtract(row, l[t], &Z[i * n], k);
        for (int t = d - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) z = z - l[t] * row[i];
        row[k] = z;
        for (int j = 0; j < k; ++j) Z[j * n + k] = row[j];
    }
}

#endif
