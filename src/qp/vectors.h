#ifndef RBDI_QP_VECTORS_H
#define RBDI_QP_VECTORS_H
#include "base/scalar.h"
#include "qp/layout.h"

/* Interface: rbdi_qp_dot, rbdi_qp_largest */

/* ---- vectors [vectors] ----
   Loops over rows of n scalars, four at a time. A dot product has four sums and one for the rest, which are
   added in one order everywhere, so that RBD_REPRODUCIBLE holds with every SIMD unit.

   A pack: as many scalars as a SIMD register has, two or four. A group: like components of RBDI_QP_GROUP
   vectors side by side, in a pack. A loop over its components has no sum across lanes, so that each vector
   comes out as if it were alone. */

#if RBDI_GNU && RBDI_SIMD > 0
#if RBDI_REAL_KIND == 2 || RBDI_SIMD == 4
#define RBDI_QP_GROUP 4
#else
#define RBDI_QP_GROUP 2
#endif
typedef rbd_real rbdi_pack
    __attribute__((vector_size(RBDI_QP_GROUP * sizeof(rbd_real)), aligned(sizeof(rbd_real)), may_alias));
typedef __typeof__(*(rbdi_pack *)0 < *(rbdi_pack *)0) rbdi_pack_bits; /* integers as wide */
typedef rbdi_pack rbdi_qp_group;
#else
#define RBDI_QP_GROUP 1
typedef rbd_real rbdi_qp_group;
#endif

/* sum of a_i t_i, of each vector t of a group */
RBDI_ONCE rbdi_qp_group rbdi_qp_group_dot(const rbd_real *a, const rbdi_qp_group *t, int n) {
    const rbdi_qp_group zero = {0};
    rbdi_qp_group s0 = zero, s1 = zero, s2 = zero, s3 = zero, rest = zero;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        s0 = s0 + a[i] * t[i];
        s1 = s1 + a[i + 1] * t[i + 1];
        s2 = s2 + a[i + 2] * t[i + 2];
        s3 = s3 + a[i + 3] * t[i + 3];
    }
    for (; i < n; ++i) rest = rest + a[i] * t[i];
    return ((s0 + s2) + (s1 + s3)) + rest;
}

/* The sums of a_i t_i and of b_i t_i. */
RBDI_ONCE void rbdi_qp_group_dots(const rbd_real *a, const rbd_real *b, const rbdi_qp_group *t, int n,
                                  rbdi_qp_group *with_a, rbdi_qp_group *with_b) {
    const rbdi_qp_group zero = {0};
    rbdi_qp_group a0 = zero, a1 = zero, a2 = zero, a3 = zero, rest_a = zero;
    rbdi_qp_group b0 = zero, b1 = zero, b2 = zero, b3 = zero, rest_b = zero;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        const rbdi_qp_group t0 = t[i], t1 = t[i + 1], t2 = t[i + 2], t3 = t[i + 3];
        a0 = a0 + a[i] * t0;
        b0 = b0 + b[i] * t0;
        a1 = a1 + a[i + 1] * t1;
        b1 = b1 + b[i + 1] * t1;
        a2 = a2 + a[i + 2] * t2;
        b2 = b2 + b[i + 2] * t2;
        a3 = a3 + a[i + 3] * t3;
        b3 = b3 + b[i + 3] * t3;
    }
    for (; i < n; ++i) {
        rest_a = rest_a + a[i] * t[i];
        rest_b = rest_b + b[i] * t[i];
    }
    *with_a = ((a0 + a2) + (a1 + a3)) + rest_a;
    *with_b = ((b0 + b2) + (b1 + b3)) + rest_b;
}

/* t += k a + l b. */
RBDI_ONCE void rbdi_qp_group_adds(rbdi_qp_group k, const rbd_real *a, rbdi_qp_group l, const rbd_real *b,
                                  rbdi_qp_group *t, int n) {
    for (int i = 0; i < n; ++i) t[i] = t[i] + k * a[i] + l * b[i];
}

/* t += k a, of each vector t of a group, with its k */
RBDI_ONCE void rbdi_qp_group_add(rbdi_qp_group k, const rbd_real *a, rbdi_qp_group *t, int n) {
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        t[i] = t[i] + k * a[i];
        t[i + 1] = t[i + 1] + k * a[i + 1];
        t[i + 2] = t[i + 2] + k * a[i + 2];
        t[i + 3] = t[i + 3] + k * a[i + 3];
    }
    for (; i < n; ++i) t[i] = t[i] + k * a[i];
}

#if RBDI_QP_GROUP > 1
RBDI_INLINE rbdi_pack rbdi_qp_load(const rbd_real *a) { return *(const rbdi_pack *)a; }

/* The sum of four sums: s0 and s2 first, s1 and s3. Packs of two: a has s0 and s1, b the others. */
RBDI_INLINE rbd_real rbdi_qp_total(rbdi_pack a, rbdi_pack b) {
#if RBDI_QP_GROUP == 4
    (void)b;
    return (a[0] + a[2]) + (a[1] + a[3]);
#else
    a = a + b;
    return a[0] + a[1];
#endif
}

/* sum of a_i b_i */
RBDI_INLINE rbd_real rbdi_qp_dot(const rbd_real *a, const rbd_real *b, int n) {
    rbdi_pack sum = {0}, more = {0};
    rbd_real rest = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        sum = sum + rbdi_qp_load(a + i) * rbdi_qp_load(b + i);
        if (RBDI_QP_GROUP == 2) more = more + rbdi_qp_load(a + i + 2) * rbdi_qp_load(b + i + 2);
    }
    for (; i < n; ++i) rest = rest + a[i] * b[i];
    return rbdi_qp_total(sum, more) + rest;
}

/* sum of a_i b_i; *terms: sum of |a_i b_i| */
RBDI_INLINE rbd_real rbdi_qp_dot_and_terms(const rbd_real *a, const rbd_real *b, int n, rbd_real *terms) {
    const rbdi_pack zero = {0};
    const rbdi_pack_bits size = ~(rbdi_pack_bits)-zero; /* all but the sign */
    rbdi_pack sum = zero, more = zero, sum_size = zero, more_size = zero;
    rbd_real rest = 0, rest_size = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        const rbdi_pack product = rbdi_qp_load(a + i) * rbdi_qp_load(b + i);
        sum = sum + product;
        sum_size = sum_size + (rbdi_pack)((rbdi_pack_bits)product & size);
        if (RBDI_QP_GROUP == 2) {
            const rbdi_pack next = rbdi_qp_load(a + i + 2) * rbdi_qp_load(b + i + 2);
            more = more + next;
            more_size = more_size + (rbdi_pack)((rbdi_pack_bits)next & size);
        }
    }
    for (; i < n; ++i) {
        rest = rest + a[i] * b[i];
        rest_size = rest_size + rbdi_abs(a[i] * b[i]);
    }
    *terms = rbdi_qp_total(sum_size, more_size) + rest_size;
    return rbdi_qp_total(sum, more) + rest;
}

/* b += k a */
RBDI_INLINE void rbdi_qp_add(rbd_real k, const rbd_real *a, rbd_real *b, int n) {
    const rbdi_pack zero = {0}, all = k - zero;
    int i = 0;

    for (; i + RBDI_QP_GROUP <= n; i += RBDI_QP_GROUP)
        *(rbdi_pack *)(b + i) = rbdi_qp_load(b + i) + all * rbdi_qp_load(a + i);
    for (; i < n; ++i) b[i] = b[i] + k * a[i];
}

RBDI_INLINE void rbdi_qp_dots(const rbd_real *a, const rbd_real *b, const rbd_real *t, int n,
                              rbd_real *with_a, rbd_real *with_b) {
    *with_a = rbdi_qp_dot(a, t, n);
    *with_b = rbdi_qp_dot(b, t, n);
}
RBDI_INLINE void rbdi_qp_adds(rbd_real k, const rbd_real *a, rbd_real l, const rbd_real *b, rbd_real *t,
                              int n) {
    const rbdi_pack zero = {0}, all_k = k - zero, all_l = l - zero;
    int i = 0;

    for (; i + RBDI_QP_GROUP <= n; i += RBDI_QP_GROUP)
        *(rbdi_pack *)(t + i) =
            rbdi_qp_load(t + i) + all_k * rbdi_qp_load(a + i) + all_l * rbdi_qp_load(b + i);
    for (; i < n; ++i) t[i] = t[i] + k * a[i] + l * b[i];
}

/* (a, b) becomes (cosine a + sine b, cosine b - sine a). */
RBDI_INLINE void rbdi_qp_rotate(rbd_real *a, rbd_real *b, int n, rbd_real cosine, rbd_real sine) {
    const rbdi_pack zero = {0}, c = cosine - zero, s = sine - zero, minus = -sine - zero;
    const rbd_real less = -sine;
    int i = 0;

    for (; i + RBDI_QP_GROUP <= n; i += RBDI_QP_GROUP) {
        const rbdi_pack x = rbdi_qp_load(a + i), y = rbdi_qp_load(b + i);
        *(rbdi_pack *)(a + i) = c * x + s * y;
        *(rbdi_pack *)(b + i) = c * y + minus * x;
    }
    for (; i < n; ++i) {
        const rbd_real x = a[i], y = b[i];
        a[i] = cosine * x + sine * y;
        b[i] = cosine * y + less * x; /* GCC 12 fuses a sum and a difference even without contraction */
    }
}
#else
RBDI_INLINE rbd_real rbdi_qp_dot(const rbd_real *a, const rbd_real *b, int n) {
    return rbdi_qp_group_dot(a, b, n);
}
RBDI_PART rbd_real rbdi_qp_dot_and_terms(const rbd_real *a, const rbd_real *b, int n, rbd_real *terms) {
    rbd_real s0 = 0, s1 = 0, s2 = 0, s3 = 0, rest = 0, t0 = 0, t1 = 0, t2 = 0, t3 = 0, rest_size = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        const rbd_real p0 = a[i] * b[i], p1 = a[i + 1] * b[i + 1];
        const rbd_real p2 = a[i + 2] * b[i + 2], p3 = a[i + 3] * b[i + 3];
        s0 = s0 + p0;
        s1 = s1 + p1;
        s2 = s2 + p2;
        s3 = s3 + p3;
        t0 = t0 + rbdi_abs(p0);
        t1 = t1 + rbdi_abs(p1);
        t2 = t2 + rbdi_abs(p2);
        t3 = t3 + rbdi_abs(p3);
    }
    for (; i < n; ++i) {
        rest = rest + a[i] * b[i];
        rest_size = rest_size + rbdi_abs(a[i] * b[i]);
    }
    *terms = ((t0 + t2) + (t1 + t3)) + rest_size;
    return ((s0 + s2) + (s1 + s3)) + rest;
}
RBDI_INLINE void rbdi_qp_add(rbd_real k, const rbd_real *a, rbd_real *b, int n) {
    rbdi_qp_group_add(k, a, b, n);
}
#define rbdi_qp_dots rbdi_qp_group_dots
#define rbdi_qp_adds rbdi_qp_group_adds
RBDI_ONCE void rbdi_qp_rotate(rbd_real *a, rbd_real *b, int n, rbd_real cosine, rbd_real sine) {
    const rbd_real less = -sine;

    for (int i = 0; i < n; ++i) {
        const rbd_real x = a[i];
        const rbd_real y = b[i];
        a[i] = cosine * x + sine * y;
        b[i] = cosine * y + less * x;
    }
}
#endif

/* The largest |a_i|. */
RBDI_PART rbd_real rbdi_qp_largest(const rbd_real *a, int n) {
    rbd_real largest = 0;
    for (int i = 0; i < n; ++i) largest = rbdi_qp_larger(largest, rbdi_abs(a[i]));
    return largest;
}
/* a_i becomes the largest of a_i, |x_i| and least. */
RBDI_PART void rbdi_qp_raise(rbd_real *a, const rbd_real *x, rbd_real least, int n) {
    for (int i = 0; i < n; ++i) a[i] = rbdi_qp_larger(rbdi_qp_larger(a[i], rbdi_abs(x[i])), least);
}

RBDI_ONCE void rbdi_qp_clear(rbd_real *a, int n) {
    for (int i = 0; i < n; ++i) a[i] = 0;
}
RBDI_ONCE void rbdi_qp_copy(const rbd_real *from, rbd_real *to, int n) {
    for (int i = 0; i < n; ++i) to[i] = from[i];
}

/* A row times x. */
RBDI_ONCE rbd_real rbdi_qp_row_times(const rbdi_qp *s, int row, const rbd_real *x) {
    if (row < s->given.bounds) return x[row];
    return rbdi_qp_dot(rbdi_qp_c(s, row), x + s->from[row], s->to[row] - s->from[row]);
}
/* y += k row' */
RBDI_ONCE void rbdi_qp_add_row(const rbdi_qp *s, int row, rbd_real k, rbd_real *y) {
    if (row < s->given.bounds)
        y[row] = y[row] + k;
    else
        rbdi_qp_add(k, rbdi_qp_c(s, row), y + s->from[row], s->to[row] - s->from[row]);
}

#endif
