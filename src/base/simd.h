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
    return x - zero; /* x + zero would lose the sign of -0 */
#else
    return x;
#endif
}

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
RBDI_INLINE rbdi_sum rbdi_sum_of_none(void) { return rbdi_all_lanes(rbdi_zero()); }
RBDI_INLINE rbdi_sum rbdi_sum_and(rbdi_sum sum, rbdi_batch x) { return sum + x; }
RBDI_INLINE rbd_real rbdi_sum_value(rbdi_sum x) {
    rbd_real sum = x[0];
    for (int j = 1; j < RBDI_BATCH; ++j) sum = sum + x[j];
    return sum;
}
#endif

#endif
