#ifndef RBDI_BASE_MEMORY_H
#define RBDI_BASE_MEMORY_H
#include "base/simd.h"

/* ---- common [common] ----
   Small functions that several sections call. */

/* Sets the n scalars of x to 0, a batch at a time. A call of memset would take longer. */
RBDI_PART void rbdi_clear(rbd_real *x, int n) {
#if RBDI_BATCH > 1 || defined RBD_LANES
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());

    for (rbdi_batch *p; n >= 8 * RBDI_BATCH; n -= 8 * RBDI_BATCH, x += 8 * RBDI_BATCH) {
        RBDI_ONE_INDEX(x); /* without it the compiler calls memset all the same */
        p = (rbdi_batch *)x;
        p[0] = p[1] = p[2] = p[3] = p[4] = p[5] = p[6] = p[7] = zero;
    }

    for (; n >= RBDI_BATCH; n -= RBDI_BATCH, x += RBDI_BATCH) {
        RBDI_ONE_INDEX(x);
        *(rbdi_batch *)x = zero;
    }
#else
    for (; n >= 4; n -= 4, x += 4) {
        x[0] = rbdi_zero();
        x[1] = rbdi_zero();
        x[2] = rbdi_zero();
        x[3] = rbdi_zero();
    }
#endif

    for (; n > 0; --n, ++x) *x = rbdi_zero();
}

/* Whether two names are equal; NULL equals none. */
RBDI_PART int rbdi_same(const char *a, const char *b) {
    if (!a || !b) return 0;
    while (*a && *a == *b) {
        ++a;
        ++b;
    }
    return *a == *b;
}

/* The first address in the memory with the alignment of RBDI_ALIGN. */
RBDI_PART unsigned char *rbdi_aligned(void *memory) {
    return (unsigned char *)(((uintptr_t)memory + RBDI_ALIGN - 1) / RBDI_ALIGN * RBDI_ALIGN);
}

#endif
