/* A peer for the test of the verification: rbd itself, by an adapter that exchanges the last two joints on
   the way in (if SWAP) and not on the way out. It takes MuJoCo's place. SPDX-License-Identifier: MIT */
#include "../bench.h"
#include <string.h>

extern const struct library library_double, library_mujoco;

static void size(const void *model, int *nq, int *nv) {
    *nq = rbd_nq(model);
    *nv = rbd_nv(model);
}

static void swap_last(double *x, int n) {
    const double last = x[n - 1];
    x[n - 1] = x[n - 2];
    x[n - 2] = last;
}

static void state(const void *model, const struct state *rbd, const struct state *its) {
    const int nq = rbd_nq(model), nv = rbd_nv(model);
    memcpy(its->q, rbd->q, (size_t)nq * sizeof(double));
    memcpy(its->v, rbd->v, (size_t)nv * sizeof(double));
    memcpy(its->a, rbd->a, (size_t)nv * sizeof(double));
    memcpy(its->tau, rbd->tau, (size_t)nv * sizeof(double));
    if (!SWAP) return;
    swap_last(its->q, nq);
    swap_last(its->v, nv);
    swap_last(its->a, nv);
    swap_last(its->tau, nv);
}

static void result(const void *model, int algorithm, const struct state *rbd, const double *its, double *x) {
    const int nv = rbd_nv(model);
    (void)rbd;
    memcpy(x, its, (size_t)(algorithm == MM ? nv * nv : nv) * sizeof(double));
}

static const struct conventions others = {
    .size = size, .state = state, .result = result, .bound = 1e-10, .build = "as rbd"};

/* The calls of library_double, by functions since its table is no constant of the compiler. */
static rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t bytes, const void **model,
                              char *text) {
    return library_double.model_build(bodies, nb, memory, bytes, model, text);
}

static size_t model_size(const rbd_body *bodies, int nb) { return library_double.model_size(bodies, nb); }

static rbd_status work_init(const void *model, void *memory, size_t bytes, void **work) {
    return library_double.work_init(model, memory, bytes, work);
}

static size_t work_size(const void *model) { return library_double.work_size(model); }

static rbd_status set_gravity(void *work, const double gravity[3]) {
    return library_double.set_gravity(work, gravity);
}

static rbd_status call_fd(const void *model, void *work, int n, const void *q, const void *v, const void *tau,
                          void *a) {
    return library_double.call[FD](model, work, n, q, v, tau, a);
}

const struct library library_mujoco = {.name = "MuJoCo",
                                       .version = "swapped",
                                       .scalar = "double",
                                       .variant = RUN_TIME,
                                       .lanes = 1,
                                       .width = 1,
                                       .size = sizeof(double),
                                       .epsilon = 2.220446049250313e-16,
                                       .model_build = model_build,
                                       .model_size = model_size,
                                       .work_init = work_init,
                                       .work_size = work_size,
                                       .set_gravity = set_gravity,
                                       .call = {[FD] = call_fd},
                                       .conventions = &others};
