#ifndef RBDI_ESTIMATE_TRIANGLES_H
#define RBDI_ESTIMATE_TRIANGLES_H
#include "base/scalar.h"

/* ---- triangles [triangles] ----
   Upper triangles of least squares, full rows of n entries: row k is 0 before entry k. */

/* Turns row x into the first `rows` rows of R. x keeps what they do not take. */
RBDI_PART void rbdi_est_absorb(rbd_real *R, int rows, int n, rbd_real *x) {
    for (int k = 0; k < rows; ++k, R += n) {
        const rbd_real square = R[k] * R[k] + x[k] * x[k];
        rbd_real size, c, s;
        if (!(square > RBDI_TINY)) continue;

        /* (R_k, x_k) becomes (size, 0) */
        size = rbdi_sqrt(square);
        c = R[k] / size;
        s = x[k] / size;
        R[k] = size;
        x[k] = rbdi_zero();

        for (int j = k + 1; j < n; ++j) {
            const rbd_real kept = R[j];
            R[j] = c * kept + s * x[j];
            x[j] = c * x[j] - s * kept;
        }
    }
}

/* Takes in factor x_k = value. x: n scalars of scratch. */
RBDI_PART void rbdi_est_absorb_one(rbd_real *R, int rows, int n, int k, rbd_real factor, rbd_real value,
                                   rbd_real *x) {
    for (int j = 0; j < n; ++j) x[j] = rbdi_zero();
    x[k] = factor;
    x[n - 1] = value;
    rbdi_est_absorb(R, rows, n, x);
}

/* x = R^-1 x of the first `rows` columns. */
RBDI_PART void rbdi_est_solve_upper(const rbd_real *R, int rows, int n, rbd_real *x) {
    for (int k = rows - 1; k >= 0; --k) {
        for (int j = k + 1; j < rows; ++j) x[k] = x[k] - R[k * n + j] * x[j];
        x[k] = x[k] / R[k * n + k];
    }
}

/* x = R'^-1 x. */
RBDI_PART void rbdi_est_solve_lower(const rbd_real *R, int rows, int n, rbd_real *x) {
    for (int k = 0; k < rows; ++k) {
        x[k] = x[k] / R[k * n + k];
        for (int j = k + 1; j < rows; ++j) x[j] = x[j] - R[k * n + j] * x[k];
    }
}

RBDI_PART rbd_real rbdi_est_sum_of_squares(const rbd_real *x, int n) {
    rbd_real sum = rbdi_zero();
    for (int k = 0; k < n; ++k) sum = sum + x[k] * x[k];
    return sum;
}

RBDI_PART void rbdi_est_scale_all(rbd_real *x, int n, rbd_real factor) {
    for (int k = 0; k < n; ++k) x[k] = x[k] * factor;
}

#endif
