#ifndef RBDI_MODEL_WIDE_H
#define RBDI_MODEL_WIDE_H
#include "api/status.h"
#include "model/layout.h"
#include "base/scalar.h"

/* Interface: rbdi_all_zero, rbdi_finite, rbdi_finite_positive, rbdi_is_rotation, rbdi_orthonormalise,
   rbdi_refuse, rbdi_refuse_saying, rbdi_semidefinite, rbdi_unit, rbdi_w_apply, rbdi_w_basis, rbdi_w_identity,
   rbdi_w_product, rbdi_w_transpose, rbdi_widen */

/* ---- descriptions [descriptions] ----
   To read a description, here and in other headers: checks, and algebra in the build's arithmetic (w_). */

#include <math.h>

#if RBDI_KIND(RBDI_WIDE) == 3
#define RBDI_WIDE_LIBM(name) name##q
#elif RBDI_KIND(RBDI_WIDE) == 2
#define RBDI_WIDE_LIBM(name) name##f
#else
#define RBDI_WIDE_LIBM(name) name
#endif

RBDI_PART void rbdi_widen(const double *x, int n, rbdi_wide *y) {
    for (int k = 0; k < n; ++k) y[k] = (rbdi_wide)x[k];
}

RBDI_PART void rbdi_w_identity(rbdi_wide A[9]) {
    for (int k = 0; k < 9; ++k) A[k] = k % 4 == 0;
}

RBDI_PART void rbdi_w_apply(const rbdi_wide A[9], const rbdi_wide x[3], rbdi_wide y[3]) {
    rbdi_wide z[3];
    for (int i = 0; i < 3; ++i) z[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
    for (int i = 0; i < 3; ++i) y[i] = z[i];
}

RBDI_PART void rbdi_w_transpose(const rbdi_wide A[9], rbdi_wide B[9]) {
    for (int i = 0; i < 9; ++i) B[i] = A[i % 3 * 3 + i / 3];
}

/* AB may be A or B. */
RBDI_PART void rbdi_w_product(const rbdi_wide A[9], const rbdi_wide B[9], rbdi_wide AB[9]) {
    rbdi_wide C[9];
    for (int i = 0; i < 9; ++i)
        C[i] = A[i / 3 * 3] * B[i % 3] + A[i / 3 * 3 + 1] * B[i % 3 + 3] + A[i / 3 * 3 + 2] * B[i % 3 + 6];
    for (int i = 0; i < 9; ++i) AB[i] = C[i];
}

RBDI_PART void rbdi_w_turn_z(rbdi_wide c, rbdi_wide s, rbdi_wide A[9]) {
    rbdi_w_identity(A);
    A[0] = c;
    A[1] = s;
    A[3] = -s;
    A[4] = c;
}

RBDI_PART void rbdi_w_turn_x(rbdi_wide c, rbdi_wide s, rbdi_wide A[9]) {
    rbdi_w_identity(A);
    A[4] = c;
    A[5] = s;
    A[7] = -s;
    A[8] = c;
}

/* E = Rz(gamma) Rx(alpha) Rz(beta) from the cosines and sines. */
RBDI_PART void rbdi_w_zxz(rbdi_wide cg, rbdi_wide sg, rbdi_wide ca, rbdi_wide sa, rbdi_wide cb, rbdi_wide sb,
                          rbdi_wide E[9]) {
    rbdi_wide turn[9];
    rbdi_w_turn_z(cg, sg, E);
    rbdi_w_turn_x(ca, sa, turn);
    rbdi_w_product(E, turn, E);
    rbdi_w_turn_z(cb, sb, turn);
    rbdi_w_product(E, turn, E);
}

/* Pose of C in A, from that of C in B and of B in A. */
RBDI_PART rbdi_wide_pose rbdi_w_compose(const rbdi_wide_pose *CB, const rbdi_wide_pose *BA) {
    rbdi_wide_pose X;
    rbdi_wide T[9];
    rbdi_w_transpose(BA->E, T);
    rbdi_w_product(CB->E, BA->E, X.E);
    rbdi_w_apply(T, CB->r, X.r);
    for (int k = 0; k < 3; ++k) X.r[k] += BA->r[k];
    return X;
}

/* Pose of C in B, from those of both in A. */
RBDI_PART rbdi_wide_pose rbdi_w_relative(const rbdi_wide_pose *CA, const rbdi_wide_pose *BA) {
    rbdi_wide_pose X;
    rbdi_wide T[9];
    rbdi_w_transpose(BA->E, T);
    rbdi_w_product(CA->E, T, X.E);
    for (int k = 0; k < 3; ++k) X.r[k] = CA->r[k] - BA->r[k];
    rbdi_w_apply(BA->E, X.r, X.r);
    return X;
}

RBDI_PART rbdi_wide rbdi_w_dot(const rbdi_wide a[3], const rbdi_wide b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

RBDI_PART rbdi_wide rbdi_w_abs(rbdi_wide x) { return x < 0 ? -x : x; }
RBDI_PART rbdi_wide rbdi_w_length(const rbdi_wide a[3]) {
    return RBDI_WIDE_LIBM(rbdi_root)(rbdi_w_dot(a, a));
}

/* Whether n numbers are finite, in the model's scalar too. */
RBDI_PART int rbdi_finite(const double *x, int n) {
    for (int k = 0; k < n; ++k) { /* by bits, which is right with -ffinite-math-only too */
        union {
            double x;
            uint64_t bits;
        } u;
        u.x = (double)RBD_C(x[k]);
        if ((u.bits >> 52 & 0x7ff) == 0x7ff) return 0;
    }

    return 1;
}

RBDI_PART int rbdi_finite_positive(const double *x, int n) {
    for (int k = 0; k < n; ++k)
        if (!rbdi_finite(&x[k], 1) || x[k] < 0) return 0;
    return 1;
}

RBDI_PART int rbdi_all_zero(const double *x, int n) {
    for (int k = 0; k < n; ++k)
        if ((rbdi_wide)x[k] < 0 || (rbdi_wide)x[k] > 0) return 0;
    return 1;
}

/* y = x scaled to unit length, of any length but 0: by the largest component first, so that nothing
   overflows. */
RBDI_PART void rbdi_unit(const rbdi_wide x[3], rbdi_wide y[3]) {
    rbdi_wide largest = 0, length;
    for (int k = 0; k < 3; ++k)
        if (rbdi_w_abs(x[k]) > largest) largest = rbdi_w_abs(x[k]);
    for (int k = 0; k < 3; ++k) y[k] = x[k] / largest;
    length = rbdi_w_length(y);
    for (int k = 0; k < 3; ++k) y[k] /= length;
}

/* Axes, the rows of E, with this unit vector for z. */
RBDI_PART void rbdi_w_basis(const rbdi_wide z[3], rbdi_wide E[9]) {
    rbdi_wide length;
    int least = 0;
    for (int k = 1; k < 3; ++k)
        if (rbdi_w_abs(z[k]) < rbdi_w_abs(z[least])) least = k;

    /* x: the unit vector that is farthest from z, less its part along z; y = z x x */
    for (int k = 0; k < 3; ++k) E[k] = (k == least) - z[least] * z[k];
    length = rbdi_w_length(E);
    for (int k = 0; k < 3; ++k) {
        E[k] /= length;
        E[6 + k] = z[k];
    }
    for (int k = 0; k < 3; ++k) E[3 + k] = z[(k + 1) % 3] * E[(k + 2) % 3] - z[(k + 2) % 3] * E[(k + 1) % 3];
}

/* Makes a nearly orthonormal matrix orthonormal, rows first to last (Gram and Schmidt). An exact one
   stays. */
RBDI_PART void rbdi_orthonormalise(rbdi_wide R[9]) {
    rbdi_wide along;
    rbdi_unit(&R[0], &R[0]);
    along = rbdi_w_dot(&R[0], &R[3]);
    for (int k = 0; k < 3; ++k) R[3 + k] -= along * R[k];
    rbdi_unit(&R[3], &R[3]);
    for (int k = 0; k < 3; ++k)
        R[6 + k] = R[(k + 1) % 3] * R[3 + (k + 2) % 3] - R[(k + 2) % 3] * R[3 + (k + 1) % 3];
}

/* Whether a matrix is a rotation, or 0, which stands for the identity. */
RBDI_PART int rbdi_is_rotation(const double R[9]) {
    rbdi_wide A[9], T[9], product[9];
    if (!rbdi_finite(R, 9)) return 0;
    if (rbdi_all_zero(R, 9)) return 1;

    rbdi_widen(R, 9, A);
    rbdi_w_transpose(A, T);
    rbdi_w_product(A, T, product);
    for (int k = 0; k < 9; ++k)
        if (!(rbdi_w_abs(product[k] - (k % 4 == 0)) < (rbdi_wide)RBDI_ORTHONORMAL)) return 0;
    return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
               A[2] * (A[3] * A[7] - A[4] * A[6]) >
           0;
}

/* Whether no eigenvalue of the symmetric matrix (xx xy xz yy yz zz) is below -RBDI_SEMIDEFINITE size: by the
   pivots of Gauss of the matrix with RBDI_SEMIDEFINITE size on the diagonal added. */
RBDI_PART int rbdi_semidefinite(const double A[6], double size) {
    const double added = RBDI_SEMIDEFINITE * size, xx = A[0] + added, yy = A[3] + added - A[1] / xx * A[1],
                 yz = A[4] - A[1] / xx * A[2];
    if (!(xx > 0) || !(yy > 0)) return 0;
    return A[5] + added - A[2] / xx * A[2] - yz * yz / yy > 0;
}

/* Makes this the error of a report. Returns the status. */
RBDI_PART rbd_status rbdi_refuse(rbd_report *report, rbd_status status, int body, const char *name,
                                 const char *field) {
    rbd_finding *f = &report->error;
    f->status = status;
    f->body = body;
    f->name = name;
    f->field = field;
    f->text = NULL;
    return status;
}

/* The same, with a sentence in place of the status's. */
RBDI_PART rbd_status rbdi_refuse_saying(rbd_report *report, rbd_status status, int body, const char *name,
                                        const char *field, const char *sentence) {
    rbdi_refuse(report, status, body, name, field);
    report->error.text = sentence;
    return status;
}

#endif
