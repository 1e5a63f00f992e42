/* lanes.h - the batch calls of rbd.h: RBD_LANES states in each SIMD instruction.
   SPDX-License-Identifier: MIT */
#define RBD_BATCH_IMPLEMENTATION
#include "../bench.h"

#define VARIANT LANES
#define N_LANES RBD_LANES
#define ONLY_ROBOT NULL
#define WIDTH BATCH

static rbd_status work_init(const void *model, void *memory, size_t size, void **work) {
    rbd_batch *b = NULL;
    rbd_status status = rbd_batch_init(model, memory, size, &b);
    *work = b;
    return status;
}

static size_t work_size(const void *model) { return rbd_batch_size(model); }

static rbd_status set_gravity(void *work, const double gravity[3]) {
    const rbd_const g[3] = {(rbd_const)gravity[0], (rbd_const)gravity[1], (rbd_const)gravity[2]};
    return rbd_batch_set_gravity(work, g);
}

static rbd_status call_id(const void *model, void *work, int n, const void *q, const void *v, const void *a,
                          void *tau) {
    return rbd_batch_rnea(model, work, n, q, v, a, NULL, tau);
}

static rbd_status call_mm(const void *model, void *work, int n, const void *q, const void *v, const void *x,
                          void *M) {
    (void)v, (void)x;
    return rbd_batch_crba(model, work, n, q, M);
}

static rbd_status call_mm_packed(const void *model, void *work, int n, const void *q, const void *v,
                                 const void *x, void *H) {
    (void)v, (void)x;
    return rbd_batch_crba_packed(model, work, n, q, H);
}

static rbd_status call_fd(const void *model, void *work, int n, const void *q, const void *v, const void *tau,
                          void *a) {
    return rbd_batch_aba(model, work, n, q, v, tau, NULL, a);
}

static rbd_status call_fd_cholesky(const void *model, void *work, int n, const void *q, const void *v,
                                   const void *tau, void *a) {
    return rbd_batch_fd_cholesky(model, work, n, q, v, tau, NULL, a);
}

#define CALLS \
    [ID] = call_id, [MM] = call_mm, [MM_PACKED] = call_mm_packed, [FD] = call_fd, \
    [FD_CHOLESKY] = call_fd_cholesky
