#ifndef RBDI_BASE_SIMD_H
#define RBDI_BASE_SIMD_H
#include "base/scalar.h"

/* A batch has as many scalars as one SIMD instruction takes: one if there is no SIMD, or if the scalar is a
   vector already. It gathers like quantities: the joints' angles, the wrenches of a subtree. */
#if RBDI_GNU && RBDI_SIMD > 0 && RBDI_REAL_KIND % 3 != 0 && !defined RBD_LANES
#define RBDI_BATCH (RBDI_SIMD * RBDI_REAL_KIND) /* the kind of double is 1, of float 2 */
typedef rbd_real rbdi_batch
    __attribute__((vector_size(RBDI_BATCH * sizeof(rbd_real)), aligned(sizeof(rbd_real)), may_alias));
#else
#define RBDI_BATCH 1
#ifndef RBD_LANES
#define RBDI_BATCH_SCALAR
#endif
typedef rbd_real rbdi_batch;
#endif
#if RBDI_BATCH > RBDI_CHUNK
#error "rbd: RBDI_CHUNK, the padding of rows, must hold a batch"
#endif

#if RBDI_REAL_KIND == 1
typedef uint64_t rbdi_bit;
#elif RBDI_REAL_KIND == 2
typedef uint32_t rbdi_bit;
#endif
/* x in all lanes. */
RBDI_INLINE rbdi_batch rbdi_all_lanes(rbd_real x) {
#if RBDI_BATCH > 1
    const rbdi_batch zero = {0};
    return x - zero;
#else
    return x;
#endif
}

RBDI_INLINE rbdi_batch rbdi_zero_batch(void) { return rbdi_all_lanes(rbdi_zero()); }

#if RBDI_BATCH > 1
typedef rbdi_bit rbdi_bits __attribute__((vector_size(RBDI_BATCH * sizeof(rbd_real))));

/* The batch with x as its k-th scalar. */
RBDI_INLINE rbdi_batch rbdi_insert(rbdi_batch batch, int k, rbd_real x) {
    const rbdi_batch all = rbdi_all_lanes(x);
    rbdi_bits lane;
    for (int i = 0; i < RBDI_BATCH; ++i) lane[i] = (rbdi_bit)i;
    lane = (rbdi_bits)(lane == (rbdi_bit)k);
    return (rbdi_batch)(((rbdi_bits)batch & ~lane) | ((rbdi_bits)all & lane));
}

/* The first n scalars of the batch, and zeros. */
RBDI_INLINE rbdi_batch rbdi_first_lanes(rbdi_batch batch, int n) {
    rbdi_batch lane;
    for (int i = 0; i < RBDI_BATCH; ++i) lane[i] = (rbd_real)i;
    return (rbdi_batch)((rbdi_bits)batch & (rbdi_bits)(lane < (rbd_real)n));
}
#endif

RBDI_INLINE rbd_real rbdi_first_lane(rbdi_batch x) {
#if RBDI_BATCH > 1
    return x[0];
#else
    return x;
#endif
}

/* A sum over all scalars of several batches: lane by lane and, at the end, over the lanes. With
   RBD_REPRODUCIBLE one scalar after the other, so that it does not depend on the length of a batch. */
#if RBDI_REPRODUCIBLE || RBDI_BATCH == 1
typedef rbd_real rbdi_sum;
RBDI_INLINE rbdi_sum rbdi_sum_of_none(void) { return rbdi_zero(); }
RBDI_INLINE rbdi_sum rbdi_sum_and(rbdi_sum sum, rbdi_batch x) {
#if RBDI_BATCH > 1
    for (int j = 0; j < RBDI_BATCH; ++j) sum = sum + x[j];
    return sum;
#else
    return sum + x;
#endif
}

RBDI_INLINE rbd_real rbdi_sum_value(rbdi_sum sum) { return sum; }
#else
typedef rbdi_batch rbdi_sum;
RBDI_INLINE rbdi_sum rbdi_sum_of_none(void) { return rbdi_zero_batch(); }
RBDI_INLINE rbdi_sum rbdi_sum_and(rbdi_sum sum, rbdi_batch x) { return sum + x; }
RBDI_INLINE rbd_real rbdi_sum_value(rbdi_sum x) {
    rbd_real sum = x[0];
    for (int j = 1; j < RBDI_BATCH; ++j) sum = sum + x[j];
    return sum;
}
#endif

/* Four scalars that go together: an axis or origin with a fourth that is not used, or parameters of a body.
   They are passed by address, because clang without AVX warns of vectors of four doubles as values. GCC would
   move a vector that is wider than a batch through memory. put: y[0] .. y[2] = x, where y[3] may become
   anything; scale: y = factor x; add: y += factor x. */
#if RBDI_BATCH >= 4 || (RBDI_BATCH > 1 && RBDI_CLANG)
typedef rbd_real rbdi_four
    __attribute__((vector_size(4 * sizeof(rbd_real)), aligned(sizeof(rbd_real)), may_alias));
RBDI_INLINE rbd_real rbdi_one_of(const rbdi_four *x, int k) { return (*x)[k]; }
RBDI_INLINE void rbdi_set_four(rbdi_four *y, rbd_real a, rbd_real b, rbd_real c, rbd_real d) {
    const rbdi_four x = {a, b, c, d};
    *y = x;
}

RBDI_INLINE void rbdi_put_four(rbd_real *y, const rbdi_four *x) { *(rbdi_four *)y = *x; }
RBDI_INLINE void rbdi_scale_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) { *y = *x * factor; }
RBDI_INLINE void rbdi_add_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) { *y = *y + *x * factor; }
#else
typedef struct rbdi_four {
    rbd_real x, y, z, w;
} rbdi_four;
RBDI_INLINE rbd_real rbdi_one_of(const rbdi_four *x, int k) {
    return k == 0 ? x->x : k == 1 ? x->y : k == 2 ? x->z : x->w;
}

RBDI_INLINE void rbdi_set_four(rbdi_four *y, rbd_real a, rbd_real b, rbd_real c, rbd_real d) {
    y->x = a;
    y->y = b;
    y->z = c;
    y->w = d;
}

RBDI_INLINE void rbdi_put_four(rbd_real *y, const rbdi_four *x) {
    y[0] = x->x;
    y[1] = x->y;
    y[2] = x->z;
}

RBDI_INLINE void rbdi_scale_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) {
    rbdi_set_four(y, x->x * factor, x->y * factor, x->z * factor, x->w * factor);
}

RBDI_INLINE void rbdi_add_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) {
    rbdi_set_four(y, y->x + x->x * factor, y->y + x->y * factor, y->z + x->z * factor, y->w + x->w * factor);
}
#endif
/* Transposes: four batches, a component each, become one four for each lane. */
#if RBDI_BATCH == 4 && RBDI_HAS_SHUFFLE
RBDI_INLINE void rbdi_fours_of_lanes(const rbdi_batch x[4], rbdi_four y[RBDI_BATCH]) {
    const rbdi_batch a = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6),
                     b = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7),
                     c = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6),
                     d = __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);

    y[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    y[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    y[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    y[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
#else
RBDI_INLINE void rbdi_fours_of_lanes(const rbdi_batch x[4], rbdi_four y[RBDI_BATCH]) {
    for (int k = 0; k < RBDI_BATCH; ++k)
        for (int j = 0; j < 4; ++j) ((rbd_real *)&y[k])[j] = ((const rbd_real *)&x[j])[k];
}
#endif

#endif
