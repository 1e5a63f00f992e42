#ifndef RBDI_QP_VECTORS_H
#define RBDI_QP_VECTORS_H
#include "qp/layout.h"

/* Interface: rbdi_qp_dot, rbdi_qp_largest */

/* ---- vectors [vectors] ----
   Loops over rows of n scalars, four at a time. A dot product has four sums and one for the rest, which are
   added in one order everywhere, so that RBD_REPRODUCIBLE holds with every SIMD unit.

   A pack: as many scalars as a SIMD register has, two or four. A group: like components of RBDI_QP_GROUP
   vectors side by side, in a pack; without a SIMD unit two of them, as the parts of a complex number, for
   which compilers take two registers. Groups are added, and multiplied by real numbers alone, so that no part
   reaches the other; and a loop over components has no sum across lanes. So each vector comes out as if it
   were alone. vectors_of.h and reflections_of.h have each loop once: for vectors, and, by other names, for
   groups. */

#if RBDI_GNU && RBDI_SIMD > 0
#if RBDI_REAL_KIND == 2 || RBDI_SIMD == 4
#define RBDI_QP_PACK 4
#else
#define RBDI_QP_PACK 2
#endif
#define RBDI_QP_GROUP RBDI_QP_PACK
typedef rbd_real rbdi_pack
    __attribute__((vector_size(RBDI_QP_PACK * sizeof(rbd_real)), aligned(sizeof(rbd_real)), may_alias));
typedef __typeof__(*(rbdi_pack *)0 < *(rbdi_pack *)0) rbdi_pack_bits; /* integers as wide */
typedef rbdi_pack rbdi_qp_group;
#elif RBDI_GNU && RBDI_FOR_SPEED && !RBDI_GPU
#define RBDI_QP_PACK 1
#define RBDI_QP_GROUP 2
#if RBDI_REAL_KIND == 2
__extension__ typedef float _Complex rbdi_qp_group __attribute__((may_alias));
#else
__extension__ typedef double _Complex rbdi_qp_group __attribute__((may_alias));
#endif
#else
#define RBDI_QP_PACK 1
#define RBDI_QP_GROUP 1
typedef rbd_real rbdi_qp_group;
#endif

#if RBDI_QP_GROUP > 1
#define RBDI_T rbdi_qp_group
#define rbdi_qp_dot rbdi_qp_group_dot
#define rbdi_qp_dots rbdi_qp_group_dots
#define rbdi_qp_add rbdi_qp_group_add
#define rbdi_qp_adds rbdi_qp_group_adds
#include "qp/vectors_of.h"
#undef RBDI_T
#undef rbdi_qp_dot
#undef rbdi_qp_dots
#undef rbdi_qp_add
#undef rbdi_qp_adds
#endif

#if RBDI_QP_PACK > 1
RBDI_INLINE rbdi_pack rbdi_qp_load(const rbd_real *a) { return *(const rbdi_pack *)a; }

/* The sum of four sums: s0 and s2 first, s1 and s3. Packs of two: a has s0 and s1, b the others. */
RBDI_INLINE rbd_real rbdi_qp_total(rbdi_pack a, rbdi_pack b) {
#if RBDI_QP_PACK == 4
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
        if (RBDI_QP_PACK == 2) more = more + rbdi_qp_load(a + i + 2) * rbdi_qp_load(b + i + 2);
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
        if (RBDI_QP_PACK == 2) {
            const rbdi_pack next = rbdi_qp_load(a + i + 2) * rbdi_qp_load(b + i + 2);
            more = more + next;
            more_size = more_size + (rbdi_pack)((rbdi_pack_bits)next & size);
        }
    }
    for (; i < n; ++i) {
        rest = rest + a[i] * b[i];
        rest_size = rest_size + rbdi_qp_abs(a[i] * b[i]);
    }
    *terms = rbdi_qp_total(sum_size, more_size) + rest_size;
    return rbdi_qp_total(sum, more) + rest;
}

/* b += k a */
RBDI_INLINE void rbdi_qp_add(rbd_real k, const rbd_real *a, rbd_real *b, int n) {
    const rbdi_pack zero = {0}, all = k - zero;
    int i = 0;

    for (; i + RBDI_QP_PACK <= n; i += RBDI_QP_PACK)
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

    for (; i + RBDI_QP_PACK <= n; i += RBDI_QP_PACK)
        *(rbdi_pack *)(t + i) =
            rbdi_qp_load(t + i) + all_k * rbdi_qp_load(a + i) + all_l * rbdi_qp_load(b + i);
    for (; i < n; ++i) t[i] = t[i] + k * a[i] + l * b[i];
}

/* (a, b) becomes (cosine a + sine b, cosine b - sine a). */
RBDI_INLINE void rbdi_qp_rotate(rbd_real *a, rbd_real *b, int n, rbd_real cosine, rbd_real sine) {
    const rbdi_pack zero = {0}, c = cosine - zero, s = sine - zero, minus = -sine - zero;
    const rbd_real less = -sine;
    int i = 0;

    for (; i + RBDI_QP_PACK <= n; i += RBDI_QP_PACK) {
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
#define RBDI_T rbd_real
#include "qp/vectors_of.h"
#undef RBDI_T

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
        t0 = t0 + rbdi_qp_abs(p0);
        t1 = t1 + rbdi_qp_abs(p1);
        t2 = t2 + rbdi_qp_abs(p2);
        t3 = t3 + rbdi_qp_abs(p3);
    }
    for (; i < n; ++i) {
        rest = rest + a[i] * b[i];
        rest_size = rest_size + rbdi_qp_abs(a[i] * b[i]);
    }
    *terms = ((t0 + t2) + (t1 + t3)) + rest_size;
    return ((s0 + s2) + (s1 + s3)) + rest;
}

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
    for (int i = 0; i < n; ++i) largest = rbdi_qp_larger(largest, rbdi_qp_abs(a[i]));
    return largest;
}
/* a_i becomes the largest of a_i, |x_i| and least. */
RBDI_PART void rbdi_qp_raise(rbd_real *a, const rbd_real *x, rbd_real least, int n) {
    for (int i = 0; i < n; ++i) a[i] = rbdi_qp_larger(rbdi_qp_larger(a[i], rbdi_qp_abs(x[i])), least);
}

RBDI_ONCE void rbdi_qp_clear(rbd_real *a, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        a[i] = 0;
        a[i + 1] = 0;
        a[i + 2] = 0;
        a[i + 3] = 0;
    }
    for (; i < n; ++i) a[i] = 0;
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
