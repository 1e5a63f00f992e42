#ifndef RBDI_ESTIMATE_PSEUDO_INERTIA_H
#define RBDI_ESTIMATE_PSEUDO_INERTIA_H
#include "base/scalar.h"
#include "estimate/layout.h"

/* ---- pseudo-inertia [pseudo-inertia] ----
   P is packed by rows of the lower triangle: S_xx, S_xy, S_yy, S_xz, S_yz, S_zz, h_x, h_y, h_z, m. */

/* The index of entry (i, j), j <= i. */
RBDI_INLINE int rbdi_est_packed_at(int i, int j) { return i * (i + 1) / 2 + j; }

/* Entry (i, j) of a lower triangle, 0 above the diagonal; and of a symmetric matrix. */
RBDI_INLINE rbd_real rbdi_est_lower(const rbd_real A[RBDI_EST_TEN], int i, int j) {
    return j <= i ? A[rbdi_est_packed_at(i, j)] : rbdi_zero();
}

RBDI_INLINE rbd_real rbdi_est_symmetric(const rbd_real A[RBDI_EST_TEN], int i, int j) {
    return A[j <= i ? rbdi_est_packed_at(i, j) : rbdi_est_packed_at(j, i)];
}

/* P = L L'. Returns whether every pivot is above its rounding. */
RBDI_PART int rbdi_est_factor_pseudo(const rbd_real P[RBDI_EST_TEN], rbd_real L[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) {
            rbd_real x = P[rbdi_est_packed_at(i, j)];
            for (int k = 0; k < j; ++k) x = x - L[rbdi_est_packed_at(i, k)] * L[rbdi_est_packed_at(j, k)];

            if (j < i) {
                L[rbdi_est_packed_at(i, j)] = x / L[rbdi_est_packed_at(j, j)];
                continue;
            }
            if (!(x > RBDI_EST_FLOOR && x > RBDI_EST_RIM * P[rbdi_est_packed_at(i, i)])) return 0;
            L[rbdi_est_packed_at(i, i)] = rbdi_sqrt(x);
        }
    return 1;
}

/* G = L^-1. */
RBDI_PART void rbdi_est_invert_lower(const rbd_real L[RBDI_EST_TEN], rbd_real G[RBDI_EST_TEN]) {
    for (int j = 0; j < 4; ++j) {
        G[rbdi_est_packed_at(j, j)] = 1 / L[rbdi_est_packed_at(j, j)];
        for (int i = j + 1; i < 4; ++i) {
            rbd_real x = rbdi_zero();
            for (int k = j; k < i; ++k) x = x - L[rbdi_est_packed_at(i, k)] * G[rbdi_est_packed_at(k, j)];
            G[rbdi_est_packed_at(i, j)] = x / L[rbdi_est_packed_at(i, i)];
        }
    }
}

/* G'G, which is P^-1. */
RBDI_PART void rbdi_est_square(const rbd_real G[RBDI_EST_TEN], rbd_real inverse[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) {
            rbd_real sum = rbdi_zero();
            for (int k = i; k < 4; ++k) sum = sum + G[rbdi_est_packed_at(k, i)] * G[rbdi_est_packed_at(k, j)];
            inverse[rbdi_est_packed_at(i, j)] = sum;
        }
}

/* The ten parameters, from a pseudo-inertia in units: I = tr(S) 1 - S. */
RBDI_PART void rbdi_est_parameters_of(const rbd_real P[RBDI_EST_TEN], const rbd_real scale[3],
                                      rbd_const pi[10]) {
    const rbd_real S = scale[2];

    pi[0] = (rbd_const)(scale[0] * P[9]);
    pi[1] = (rbd_const)(scale[1] * P[6]);
    pi[2] = (rbd_const)(scale[1] * P[7]);
    pi[3] = (rbd_const)(scale[1] * P[8]);
    pi[4] = (rbd_const)(S * (P[2] + P[5]));
    pi[5] = (rbd_const)(-S * P[1]);
    pi[6] = (rbd_const)(-S * P[3]);
    pi[7] = (rbd_const)(S * (P[0] + P[5]));
    pi[8] = (rbd_const)(-S * P[4]);
    pi[9] = (rbd_const)(S * (P[0] + P[2]));
}

/* The factors of the entries of P, from those of the ten parameters: the transpose of the above. */
RBDI_PART void rbdi_est_pseudo_factors(const rbd_real y[10], const rbd_real scale[3],
                                       rbd_real x[RBDI_EST_TEN]) {
    const rbd_real S = scale[2];

    x[0] = S * (y[7] + y[9]);
    x[1] = -S * y[5];
    x[2] = S * (y[4] + y[9]);
    x[3] = -S * y[6];
    x[4] = -S * y[8];
    x[5] = S * (y[4] + y[7]);
    x[6] = scale[1] * y[1];
    x[7] = scale[1] * y[2];
    x[8] = scale[1] * y[3];
    x[9] = scale[0] * y[0];
}

/* Where the estimate begins. */
RBDI_PART void rbdi_est_begin_ball(rbd_real P[RBDI_EST_TEN]) {
    const rbd_const mass = RBDI_EST_BALL;
    const rbd_const second = mass * mass * mass;

    for (int k = 0; k < RBDI_EST_TEN; ++k) P[k] = rbdi_zero();
    for (int i = 0; i < 3; ++i) P[rbdi_est_packed_at(i, i)] = rbdi_set(second);
    P[rbdi_est_packed_at(3, 3)] = rbdi_set(mass);
}

#endif
