/* compile_time.h - straight-line calls for one robot, by the pattern at RBD_LOCAL_WORK in rbd.h.
   SPDX-License-Identifier: MIT */
#define RBD_NO_BUILD
#define RBD_STATIC
#define RBD_SPECIALISE
#define RBD_IMPLEMENTATION
#include "../bench.h"
#include ROBOT_HEADER

#define VARIANT COMPILE_TIME
#define N_LANES 1
#define ONLY_ROBOT ROBOT
#define WIDTH 1

/* Gravity is as unknown to the compiler as it is for the other variants; the work is a local one of each
 * call. */
static rbd_const gravity_now[3];
#define WORK \
    RBD_LOCAL_WORK(w, ROBOT_MODEL, ROBOT_WORK_SIZE); \
    (void)model, (void)work, (void)n; \
    rbd_set_gravity(w, gravity_now)

static rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t size, const void **model,
                              char *text) {
    (void)bodies, (void)nb, (void)memory, (void)size, (void)text;
    *model = &ROBOT_MODEL;
    return RBD_OK;
}

static size_t model_size(const rbd_body *bodies, int nb) {
    (void)bodies, (void)nb;
    return 1;
}

static rbd_status work_init(const void *model, void *memory, size_t size, void **work) {
    (void)model, (void)size;
    *work = memory;
    return RBD_OK;
}

static size_t work_size(const void *model) {
    (void)model;
    return 1;
}

static rbd_status set_gravity(void *work, const double gravity[3]) {
    (void)work;
    for (int i = 0; i < 3; i++) gravity_now[i] = (rbd_const)gravity[i];
    return RBD_OK;
}

static rbd_status call_id(const void *model, void *work, int n, const void *q, const void *v, const void *a,
                          void *tau) {
    WORK;
    return rbd_rnea(&ROBOT_MODEL, w, q, v, a, NULL, tau);
}

static rbd_status call_mm(const void *model, void *work, int n, const void *q, const void *v, const void *x,
                          void *M) {
    WORK;
    (void)v, (void)x;
    return rbd_crba(&ROBOT_MODEL, w, q, M);
}

static rbd_status call_mm_packed(const void *model, void *work, int n, const void *q, const void *v,
                                 const void *x, void *H) {
    WORK;
    (void)v, (void)x;
    return rbd_crba_packed(&ROBOT_MODEL, w, q, H);
}

static rbd_status call_fd(const void *model, void *work, int n, const void *q, const void *v, const void *tau,
                          void *a) {
    WORK;
    return rbd_aba(&ROBOT_MODEL, w, q, v, tau, NULL, a);
}

static rbd_status call_fd_cholesky(const void *model, void *work, int n, const void *q, const void *v,
                                   const void *tau, void *a) {
    WORK;
    return rbd_fd_cholesky(&ROBOT_MODEL, w, q, v, tau, NULL, a);
}

#define CAN NULL
#define CALLS \
    [ID] = call_id, [MM] = call_mm, [MM_PACKED] = call_mm_packed, [FD] = call_fd, \
    [FD_CHOLESKY] = call_fd_cholesky
