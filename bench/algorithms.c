/* The scalars and algorithms, and the calls that are timed. SPDX-License-Identifier: MIT */
#include "bench.h"

extern const struct library library_double, library_float, library_quad;

const struct library *const libraries[LIBRARIES] = {
    [DOUBLE] = &library_double,
    [FLOAT] = &library_float,
#ifdef BENCH_QUAD
    [QUAD] = &library_quad,
#endif
};

const struct algorithm algorithms[ALGORITHMS] = {
    [ID] = {"id", "inverse dynamics (RNEA)"},
    [MM] = {"mm", "mass matrix (CRBA)"},
    [FD] = {"fd", "forward dynamics (ABA)"},
    [FD_CHOLESKY] = {"fd_cholesky", "forward dynamics (Cholesky)"},
};

rbd_status algorithm_run(int algorithm, const struct instance *r, const struct states *s, int first,
                         int count, void *out) {
    library_call *call = r->library->call[algorithm];
    const size_t q_size = (size_t)r->robot->nq * r->library->size;
    const size_t v_size = (size_t)r->robot->nv * r->library->size;
    const size_t end = (size_t)first + (size_t)count;
    const char *q = s->q, *v = s->v, *x = algorithm == ID ? s->a : s->tau;
    for (size_t k = (size_t)first; k < end; k++) {
        rbd_status status = call(r->model, r->work, q + k * q_size, v + k * v_size, x + k * v_size, out);
        if (status != RBD_OK)
            return status;
    }
    return RBD_OK;
}

int algorithm_results(int algorithm, const struct robot *r) {
    return algorithm == MM ? r->nv * r->nv : r->nv;
}
