#ifndef RBDI_BATCH_LANES_H
#define RBDI_BATCH_LANES_H
#include "base/compiler.h"

/* ---- lanes [lanes] ---- */

/* Transposes RBD_LANES vectors in place. Of each two vectors that are 1, 2, 4 apart it exchanges the blocks
   of as many lanes that are off the diagonal: with lanes a b of the one and c d of the other these become a
   c and b d. */
#if RBDI_HAS_SHUFFLE && (RBD_LANES == 2 || RBD_LANES == 4 || RBD_LANES == 8)
#if RBD_LANES == 2
#define RBDI_EACH_LANE(f, step) f(0, step), f(1, step)
#elif RBD_LANES == 4
#define RBDI_EACH_LANE(f, step) f(0, step), f(1, step), f(2, step), f(3, step)
#else
#define RBDI_EACH_LANE(f, step) \
    f(0, step), f(1, step), f(2, step), f(3, step), f(4, step), f(5, step), f(6, step), f(7, step)
#endif

/* Lane i of the new vectors: a lane of the first one, or RBD_LANES + a lane of the second one. */
#define RBDI_LOW_BLOCKS(i, step) ((i) & (step) ? RBD_LANES + (i) - (step) : (i))
#define RBDI_HIGH_BLOCKS(i, step) ((i) & (step) ? RBD_LANES + (i) : (i) + (step))

RBDI_INLINE void rbdi_exchange_lanes(rbd_real *x, rbd_real *y) {
    const rbd_real a = *x, b = *y;
    *x = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_LOW_BLOCKS, 1));
    *y = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_HIGH_BLOCKS, 1));
}

#if RBD_LANES >= 4
RBDI_INLINE void rbdi_exchange_pairs(rbd_real *x, rbd_real *y) {
    const rbd_real a = *x, b = *y;
    *x = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_LOW_BLOCKS, 2));
    *y = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_HIGH_BLOCKS, 2));
}
#endif

#if RBD_LANES >= 8
RBDI_INLINE void rbdi_exchange_fours(rbd_real *x, rbd_real *y) {
    const rbd_real a = *x, b = *y;
    *x = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_LOW_BLOCKS, 4));
    *y = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_HIGH_BLOCKS, 4));
}
#endif

RBDI_INLINE void rbdi_transpose_lanes(rbd_real x[RBD_LANES]) {
    for (int i = 0; i < RBD_LANES; i += 2) rbdi_exchange_lanes(&x[i], &x[i + 1]);
#if RBD_LANES >= 4
    for (int i = 0; i < RBD_LANES; ++i)
        if (!(i & 2)) rbdi_exchange_pairs(&x[i], &x[i + 2]);
#endif
#if RBD_LANES >= 8
    for (int i = 0; i < 4; ++i) rbdi_exchange_fours(&x[i], &x[i + 4]);
#endif
}
#else
RBDI_INLINE void rbdi_transpose_lanes(rbd_real x[RBD_LANES]) {
    for (int i = 0; i < RBD_LANES; ++i)
        for (int j = 0; j < i; ++j) {
            const RBD_REAL old = x[i][j];
            x[i][j] = x[j][i];
            x[j][i] = old;
        }
}
#endif

typedef RBD_REAL rbdi_lane_row
    __attribute__((vector_size(sizeof(rbd_real)), aligned(sizeof(RBD_REAL)), may_alias));

/* Lane s of x[k] becomes component k of state s. A state has `width` components, and `rest` states are in the
   array; lanes beyond these repeat the last one. blocks: whether the layout is RBD_BLOCKS.

   In rows, RBD_LANES components of RBD_LANES states are transposed at a time; the last components may overlap
   those before. The rows of the next states are prefetched, because the processor does not predict so many
   streams. */
RBDI_LOCAL void rbdi_gather(const RBD_REAL *in, int width, int blocks, int rest, rbd_real *x) {
    const int last = (rest < RBD_LANES ? rest : RBD_LANES) - 1;
    const int across = blocks ? 1 : width, along = blocks ? RBD_LANES : 1;
    const RBD_REAL *next = rest < 2 * RBD_LANES ? in : in + RBD_LANES * width;

    if (blocks || width < RBD_LANES) {
        for (int k = 0; k < width; ++k)
            if (blocks && rest >= RBD_LANES)
                x[k] = *(const rbdi_lane_row *)&in[k * RBD_LANES];
            else
                for (int s = 0; s < RBD_LANES; ++s) x[k][s] = in[k * along + (s < last ? s : last) * across];
        return;
    }

    for (int k = 0; k < width; k += RBD_LANES) {
        const int at = k + RBD_LANES <= width ? k : width - RBD_LANES;
        rbd_real block[RBD_LANES];

        for (int s = 0; s < RBD_LANES; ++s)
            block[s] = *(const rbdi_lane_row *)&in[(s < last ? s : last) * width + at];
        for (int s = 0; s < RBD_LANES; ++s)
            if (s <= last) __builtin_prefetch(&next[s * width + at]);

        rbdi_transpose_lanes(block);
        for (int s = 0; s < RBD_LANES; ++s) x[at + s] = block[s];
    }
}

/* The reverse, for the first count states. */
RBDI_LOCAL void rbdi_scatter(const rbd_real *x, int width, int blocks, int count, RBD_REAL *out) {
    const int across = blocks ? 1 : width, along = blocks ? RBD_LANES : 1;

    if (blocks || width < RBD_LANES) {
        for (int k = 0; k < width; ++k)
            if (blocks && count == RBD_LANES)
                *(rbdi_lane_row *)&out[k * RBD_LANES] = x[k];
            else
                for (int s = 0; s < count; ++s) out[k * along + s * across] = x[k][s];
        return;
    }

    for (int k = 0; k < width; k += RBD_LANES) {
        const int at = k + RBD_LANES <= width ? k : width - RBD_LANES;
        rbd_real block[RBD_LANES];

        for (int s = 0; s < RBD_LANES; ++s) block[s] = x[at + s];
        rbdi_transpose_lanes(block);
        for (int s = 0; s < RBD_LANES; ++s)
            if (s < count) *(rbdi_lane_row *)&out[s * width + at] = block[s];
    }
}

#endif
