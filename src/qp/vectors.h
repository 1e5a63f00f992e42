#ifndef RBDI_QP_VECTORS_H
#define RBDI_QP_VECTORS_H
#include "qp/layout.h"

/* ---- vectors [vectors] ----
   Loops over rows of n scalars, four at a time. A dot product has four sums and one for the rest, which are
   added in one order everywhere, so that RBD_REPRODUCIBLE holds with every SIMD unit. */

#if RBDI_GNU && RBDI_SIMD > 0
typedef rbd_real rbdi_quad
    __attribute__((vector_size(4 * sizeof(rbd_real)), aligned(sizeof(rbd_real)), may_alias));

/* sum of a_i b_i */
RBDI_INLINE rbd_real rbdi_qp_dot(const rbd_real *a, const rbd_real *b, int n) {
    rbdi_quad sum = {0};
    rbd_real rest = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) sum = sum + *(const rbdi_quad *)(a + i) * *(const rbdi_quad *)(b + i);
    for (; i < n; ++i) rest = rest + a[i] * b[i];
    return ((sum[0] + sum[2]) + (sum[1] + sum[3])) + rest;
}

/* b += k a */
RBDI_INLINE void rbdi_qp_add(rbd_real k, const rbd_real *a, rbd_real *b, int n) {
    const rbdi_quad zero = {0}, all = k - zero;
    int i = 0;

    for (; i + 4 <= n; i += 4)
        *(rbdi_quad *)(b + i) = *(const rbdi_quad *)(b + i) + all * *(const rbdi_quad *)(a + i);
    for (; i < n; ++i) b[i] = b[i] + k * a[i];
}

/* (a, b) becomes (cosine a + sine b, cosine b - sine a). */
RBDI_INLINE void rbdi_qp_rotate(rbd_real *a, rbd_real *b, int n, rbd_real cosine, rbd_real sine) {
    const rbdi_quad zero = {0}, c = cosine - zero, s = sine - zero, minus = -sine - zero;
    const rbd_real less = -sine;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        const rbdi_quad x = *(const rbdi_quad *)(a + i);
        const rbdi_quad y = *(const rbdi_quad *)(b + i);
        *(rbdi_quad *)(a + i) = c * x + s * y;
        *(rbdi_quad *)(b + i) = c * y + minus * x;
    }
    for (; i < n; ++i) {
        const rbd_real x = a[i];
        const rbd_real y = b[i];
        a[i] = cosine * x + sine * y;
        b[i] = cosine * y + less * x; /* GCC 12 fuses a sum and a difference even without contraction */
    }
}
#else
RBDI_INLINE rbd_real rbdi_qp_dot(const rbd_real *a, const rbd_real *b, int n) {
    rbd_real s0 = 0, s1 = 0, s2 = 0, s3 = 0, rest = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        s0 = s0 + a[i] * b[i];
        s1 = s1 + a[i + 1] * b[i + 1];
        s2 = s2 + a[i + 2] * b[i + 2];
        s3 = s3 + a[i + 3] * b[i + 3];
    }
    for (; i < n; ++i) rest = rest + a[i] * b[i];
    return ((s0 + s2) + (s1 + s3)) + rest;
}
RBDI_INLINE void rbdi_qp_add(rbd_real k, const rbd_real *a, rbd_real *b, int n) {
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        b[i] = b[i] + k * a[i];
        b[i + 1] = b[i + 1] + k * a[i + 1];
        b[i + 2] = b[i + 2] + k * a[i + 2];
        b[i + 3] = b[i + 3] + k * a[i + 3];
    }
    for (; i < n; ++i) b[i] = b[i] + k * a[i];
}
RBDI_INLINE void rbdi_qp_rotate(rbd_real *a, rbd_real *b, int n, rbd_real cosine, rbd_real sine) {
    const rbd_real less = -sine;

    for (int i = 0; i < n; ++i) {
        const rbd_real x = a[i];
        const rbd_real y = b[i];
        a[i] = cosine * x + sine * y;
        b[i] = cosine * y + less * x;
    }
}
#endif

/* A group: like components of RBDI_QP_GROUP vectors side by side. A loop over its components has no sum
   across lanes, so that each vector comes out as if it were alone. */
#if RBDI_GNU && RBDI_SIMD > 0
#define RBDI_QP_GROUP 4
typedef rbdi_quad rbdi_qp_group;
#else
#define RBDI_QP_GROUP 1
typedef rbd_real rbdi_qp_group;
#endif

RBDI_INLINE void rbdi_qp_clear(rbd_real *a, int n) {
    for (int i = 0; i < n; ++i) a[i] = 0;
}
RBDI_INLINE void rbdi_qp_copy(const rbd_real *from, rbd_real *to, int n) {
    for (int i = 0; i < n; ++i) to[i] = from[i];
}

/* A row times x. */
RBDI_INLINE rbd_real rbdi_qp_row_times(const rbdi_qp *s, int row, const rbd_real *x) {
    if (row < s->given.bounds) return x[row];
    return rbdi_qp_dot(rbdi_qp_c(s, row), x + s->from[row], s->to[row] - s->from[row]);
}
/* y += k row' */
RBDI_INLINE void rbdi_qp_add_row(const rbdi_qp *s, int row, rbd_real k, rbd_real *y) {
    if (row < s->given.bounds)
        y[row] = y[row] + k;
    else
        rbdi_qp_add(k, rbdi_qp_c(s, row), y + s->from[row], s->to[row] - s->from[row]);
}

#endif
