/* run_time.h - the calls of rbd.h for a model known at run time: one state each.
   SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "../bench.h"

#define VARIANT RUN_TIME
#define N_LANES 1
#define ONLY_ROBOT NULL
#define WIDTH 1

static rbd_status work_init(const void *model, void *memory, size_t size, void **work) {
    rbd_work *w = NULL;
    rbd_status status = rbd_work_init(model, memory, size, &w);
    *work = w;
    return status;
}

static size_t work_size(const void *model) { return rbd_work_size(model); }

static rbd_status set_gravity(void *work, const double gravity[3]) {
    const rbd_const g[3] = {(rbd_const)gravity[0], (rbd_const)gravity[1], (rbd_const)gravity[2]};
    return rbd_set_gravity(work, g);
}

static rbd_status call_id(const void *model, void *work, int n, const void *q, const void *v, const void *a,
                          void *tau) {
    (void)n;
    return rbd_rnea(model, work, q, v, a, NULL, tau);
}

static rbd_status call_mm(const void *model, void *work, int n, const void *q, const void *v, const void *x,
                          void *M) {
    (void)n, (void)v, (void)x;
    return rbd_crba(model, work, q, M);
}

static rbd_status call_mm_packed(const void *model, void *work, int n, const void *q, const void *v,
                                 const void *x, void *H) {
    (void)n, (void)v, (void)x;
    return rbd_crba_packed(model, work, q, H);
}

static rbd_status call_fd(const void *model, void *work, int n, const void *q, const void *v, const void *tau,
                          void *a) {
    (void)n;
    return rbd_aba(model, work, q, v, tau, NULL, a);
}

static rbd_status call_fd_cholesky(const void *model, void *work, int n, const void *q, const void *v,
                                   const void *tau, void *a) {
    (void)n;
    return rbd_fd_cholesky(model, work, q, v, tau, NULL, a);
}
