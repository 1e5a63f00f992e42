#ifndef RBDI_BASE_MEMORY_H
#define RBDI_BASE_MEMORY_H
#include "api/status.h"
#include "base/simd.h"

/* ---- common [common] ----
   What several sections call. */

/* x = 0, a batch at a time: a call of memset costs more than it stores. */
RBDI_PART void rbdi_clear(rbd_real *x, int n) {
    int k = 0;
#if RBDI_BATCH > 1
    const rbdi_batch zero = {0};
    for (; k + RBDI_BATCH <= n; k += RBDI_BATCH) {
        rbdi_batch *p = (rbdi_batch *)&x[k];
        __asm__("" : "+r"(p)); /* or the compiler sees through it */
        *p = zero;
    }
#endif
    for (; k < n; ++k) x[k] = rbdi_zero();
}

/* From one component of the wrenches in w->F to the next. */
RBDI_INLINE ptrdiff_t rbdi_stride(const rbd_model *m) { return RBDI_STRIDE(m->nv + m->nmimic); }

RBDI_PART int rbdi_same(const char *a, const char *b) {
    if (!a || !b) return 0;
    while (*a && *a == *b) ++a, ++b;
    return *a == *b;
}

/* Cuts count objects of size bytes off the front of the memory. */
RBDI_PART void *rbdi_take(unsigned char **memory, int count, size_t size) {
    unsigned char *p = *memory;
    *memory += (size_t)count * size;
    return p;
}

RBDI_PART unsigned char *rbdi_aligned(void *memory) {
    return (unsigned char *)(((uintptr_t)memory + RBDI_ALIGN - 1) / RBDI_ALIGN * RBDI_ALIGN);
}

/* Whether a work's arrays are as long as this model needs them. Not by the model's address: another model may
   have been built there meanwhile, and the same table may stand at another. */
RBDI_INLINE int rbdi_fits(const rbd_model *m, const rbd_work *w) {
    return m->shape[0] == w->shape[0] && m->shape[1] == w->shape[1] && m->shape[2] == w->shape[2];
}

/* What every call with a model and a work asks first; arrays: none of the caller's required ones is NULL. */
RBDI_INLINE rbd_status rbdi_check(const rbd_model *m, const rbd_work *w, int arrays) {
    if (!m || !w || !arrays) return RBD_ERR_NULL;
    return rbdi_fits(m, w) ? RBD_OK : RBD_ERR_WORK;
}

#endif
