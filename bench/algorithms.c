/* The calls that are timed. SPDX-License-Identifier: MIT */
#include "bench.h"

/* Takes a number from every result, so that no call is without effect. */
static volatile double sink;

typedef rbd_status dynamics(const rbd_model *m, rbd_work *w, const double *q, const double *v,
                            const double *x, const double *f_ext, double *out);

/* The three algorithms that take q, v and a third vector x of the size of v. */
static rbd_status run_dynamics(dynamics *function, const struct robot *r, const struct states *s,
                               const double *x, int first, int count, double *out) {
    const size_t nq = (size_t)r->nq, nv = (size_t)r->nv, end = (size_t)first + (size_t)count;
    double sum = 0;
    for (size_t k = (size_t)first; k < end; k++) {
        rbd_status status = function(r->model, r->work, s->q + k * nq, s->v + k * nv, x + k * nv, NULL, out);
        if (status != RBD_OK)
            return status;
        sum += out[0];
    }
    sink = sum;
    return RBD_OK;
}

static rbd_status run_id(const struct robot *r, const struct states *s, int first, int count, double *tau) {
    return run_dynamics(rbd_rnea, r, s, s->a, first, count, tau);
}

static rbd_status run_fd(const struct robot *r, const struct states *s, int first, int count, double *a) {
    return run_dynamics(rbd_aba, r, s, s->tau, first, count, a);
}

static rbd_status run_fd_cholesky(const struct robot *r, const struct states *s, int first, int count,
                                  double *a) {
    return run_dynamics(rbd_fd_cholesky, r, s, s->tau, first, count, a);
}

static rbd_status run_mm(const struct robot *r, const struct states *s, int first, int count, double *M) {
    const size_t nq = (size_t)r->nq, end = (size_t)first + (size_t)count;
    double sum = 0;
    for (size_t k = (size_t)first; k < end; k++) {
        rbd_status status = rbd_crba(r->model, r->work, s->q + k * nq, M);
        if (status != RBD_OK)
            return status;
        sum += M[0];
    }
    sink = sum;
    return RBD_OK;
}

const struct algorithm algorithms[ALGORITHMS] = {
    [ID] = {"id", "inverse dynamics (RNEA)", run_id},
    [MM] = {"mm", "mass matrix (CRBA)", run_mm},
    [FD] = {"fd", "forward dynamics (ABA)", run_fd},
    [FD_CHOLESKY] = {"fd_cholesky", "forward dynamics (Cholesky)", run_fd_cholesky},
};
