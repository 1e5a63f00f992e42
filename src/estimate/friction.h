#ifndef RBDI_ESTIMATE_FRICTION_H
#define RBDI_ESTIMATE_FRICTION_H
#include "base/memory.h"
#include "estimate/layout.h"
#include "estimate/triangles.h"

/* ---- friction of a dof [friction code] ----
   The unknowns are offset, coulomb and viscous, in this order: so the last two rows of a triangle are those
   of coulomb and viscous with the offset eliminated. */

/* The triangle of a dof with the prior in it, T. */
RBDI_PART void rbdi_est_joint_triangle(const rbd_estimate *e, int i, rbd_real T[RBDI_EST_JOINT_TRIANGLE]) {
    rbd_real x[RBDI_EST_WHOLE_ROW];
    for (int k = 0; k < RBDI_EST_JOINT_TRIANGLE; ++k) T[k] = e->joint[i * RBDI_EST_JOINT_TRIANGLE + k];
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k)
        rbdi_est_absorb_one(T, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, k, e->stiff, rbdi_zero(), x);
}

/* The largest x >= 0 of a single unknown, ax = b in the sense of least squares with square = a'a, and the
   share of the right side that it explains. */
RBDI_INLINE rbd_real rbdi_est_one_unknown(rbd_real product, rbd_real square, rbd_real *explained) {
    *explained = product > 0 ? product * product / square : rbdi_zero();
    return product > 0 ? product / square : rbdi_zero();
}

/* Minimises |U (c, v) - (r, s)|^2 with c, v >= 0, U = [a b; 0 d], a, d > 0: free, or one of them is 0. */
RBDI_PART void rbdi_est_bounded_pair(rbd_real a, rbd_real b, rbd_real d, rbd_real r, rbd_real s, rbd_real *c,
                                     rbd_real *v) {
    rbd_real c_explains, v_explains, c_alone, v_alone;
    *v = s / d;
    *c = (r - b * *v) / a;
    if (*c >= 0 && *v >= 0) return;

    c_alone = rbdi_est_one_unknown(a * r, a * a, &c_explains);
    v_alone = rbdi_est_one_unknown(b * r + d * s, b * b + d * d, &v_explains);
    *c = c_explains >= v_explains ? c_alone : rbdi_zero();
    *v = c_explains >= v_explains ? rbdi_zero() : v_alone;
}

/* The friction of dof i for the payload as it is. */
RBDI_PART void rbdi_est_solve_friction(const rbd_estimate *e, int i, rbd_joint_friction *f) {
    rbd_real T[RBDI_EST_JOINT_TRIANGLE], z[RBDI_EST_FRICTIONS];
    rbdi_est_joint_triangle(e, i, T);

    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        const rbd_real *row = T + k * RBDI_EST_WHOLE_ROW;
        z[k] = row[RBDI_EST_WHOLE_ROW - 1];
        for (int j = 0; j < RBDI_EST_TEN && !e->known; ++j)
            z[k] = z[k] - row[RBDI_EST_FRICTIONS + j] * e->P[j];
    }

    rbdi_est_bounded_pair(T[RBDI_EST_WHOLE_ROW + 1], T[RBDI_EST_WHOLE_ROW + 2], T[2 * RBDI_EST_WHOLE_ROW + 2],
                          z[1], z[2], &f->coulomb, &f->viscous);
    f->offset = (z[0] - T[1] * f->coulomb - T[2] * f->viscous) / T[0];
}

/* The variance of u'F p, |load'^-1 F'u|^2, of a payload p with the triangle `load`. F: of a dof's triangle
   T. */
RBDI_PART rbd_real rbdi_est_load_variance(const rbd_real T[RBDI_EST_JOINT_TRIANGLE],
                                          const rbd_real load[RBDI_EST_LOAD_TRIANGLE],
                                          const rbd_real u[RBDI_EST_FRICTIONS]) {
    rbd_real x[RBDI_EST_TEN];
    for (int j = 0; j < RBDI_EST_TEN; ++j) {
        x[j] = rbdi_zero();
        for (int r = 0; r < RBDI_EST_FRICTIONS; ++r)
            x[j] = x[j] + T[r * RBDI_EST_WHOLE_ROW + RBDI_EST_FRICTIONS + j] * u[r];
    }

    rbdi_est_solve_lower(load, RBDI_EST_TEN, RBDI_EST_TEN_ROW, x);
    return rbdi_est_sum_of_squares(x, RBDI_EST_TEN);
}

/* Standard deviations: T f = z - F p, with p's triangle `load`, which nothing reads of a known payload. Of
   unknown k with u = T'^-1 e_k the variance is u'u and that of u'F p. */
RBDI_PART void rbdi_est_friction_deviations(const rbd_estimate *e, int i,
                                            const rbd_real load[RBDI_EST_LOAD_TRIANGLE],
                                            rbd_real deviation[RBDI_EST_FRICTIONS]) {
    rbd_real T[RBDI_EST_JOINT_TRIANGLE];
    rbdi_est_joint_triangle(e, i, T);

    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        rbd_real u[RBDI_EST_FRICTIONS], variance;
        for (int j = 0; j < RBDI_EST_FRICTIONS; ++j) u[j] = rbdi_set(j == k ? RBD_C(1) : RBD_C(0));
        rbdi_est_solve_lower(T, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, u);

        variance = rbdi_est_sum_of_squares(u, RBDI_EST_FRICTIONS);
        if (!e->known) variance = variance + rbdi_est_load_variance(T, load, u);
        deviation[k] = rbdi_sqrt(variance);
    }
}

/* Replaces the rows R f = z - F p of dof i, where p is the estimate with the covariance of `load`, by rows of
   f alone: with B = 1 + F C F' = L L', L^-1 R f = L^-1 (z - F p). */
RBDI_PART void rbdi_est_forget_load_of(rbd_estimate *e, int i, const rbd_real load[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real *R = e->joint + i * RBDI_EST_JOINT_TRIANGLE, x[RBDI_EST_FRICTIONS][RBDI_EST_WHOLE_ROW],
             F[RBDI_EST_FRICTIONS][RBDI_EST_TEN], B[RBDI_EST_FRICTIONS * RBDI_EST_FRICTIONS];

    /* the rows, and F load^-1 */
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        for (int j = 0; j < RBDI_EST_WHOLE_ROW; ++j) x[k][j] = R[k * RBDI_EST_WHOLE_ROW + j];
        for (int j = 0; j < RBDI_EST_TEN; ++j) {
            F[k][j] = x[k][RBDI_EST_FRICTIONS + j];
            x[k][RBDI_EST_WHOLE_ROW - 1] = x[k][RBDI_EST_WHOLE_ROW - 1] - F[k][j] * e->P[j];
            x[k][RBDI_EST_FRICTIONS + j] = rbdi_zero();
        }
        rbdi_est_solve_lower(load, RBDI_EST_TEN, RBDI_EST_TEN_ROW, F[k]);
    }

    /* L' by turns: B is the sum of squares of 1 and of the columns of F */
    for (int k = 0; k < RBDI_EST_FRICTIONS * RBDI_EST_FRICTIONS; ++k)
        B[k] = rbdi_set(k % (RBDI_EST_FRICTIONS + 1) ? RBD_C(0) : RBD_C(1));
    for (int j = 0; j < RBDI_EST_TEN; ++j) {
        rbd_real column[RBDI_EST_FRICTIONS];
        for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) column[k] = F[k][j];
        rbdi_est_absorb(B, RBDI_EST_FRICTIONS, RBDI_EST_FRICTIONS, column);
    }

    /* x = L^-1 x, which is a triangle no more */
    rbdi_clear(R, RBDI_EST_JOINT_TRIANGLE);
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        for (int j = 0; j < RBDI_EST_WHOLE_ROW; ++j) {
            for (int r = 0; r < k; ++r) x[k][j] = x[k][j] - B[r * RBDI_EST_FRICTIONS + k] * x[r][j];
            x[k][j] = x[k][j] / B[k * RBDI_EST_FRICTIONS + k];
        }
    }
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k)
        rbdi_est_absorb(R, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, x[k]);
}

#endif
