/* The library for one scalar, as a table. This file is compiled once for each (see meson.build): LIBRARY
   names the table, RBD_REAL and RBD_CONST choose the scalar. The one for double is the library as a program
   has it; the others are RBD_STATIC, since a program can have the names of rbd.h only once.
   SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "bench.h"
#include <float.h>
#include <math.h>

extern const struct library LIBRARY;

static rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t size, const void **model,
                              rbd_report *report) {
    const rbd_model *m = NULL;
    rbd_status status = rbd_model_build(bodies, nb, memory, size, &m, report);
    *model = m;
    return status;
}

static rbd_status work_init(const void *model, void *memory, size_t size, void **work) {
    rbd_work *w = NULL;
    rbd_status status = rbd_work_init(model, memory, size, &w);
    *work = w;
    return status;
}

static size_t work_size(const void *model) {
    return rbd_work_size(model);
}

static rbd_status set_gravity(void *work, const double gravity[3]) {
    const rbd_const g[3] = {(rbd_const)gravity[0], (rbd_const)gravity[1], (rbd_const)gravity[2]};
    return rbd_set_gravity(work, g);
}

/* ---- algorithms: one state a call; here is the place for functions that take several ---- */

static rbd_status call_id(const void *model, void *work, const void *q, const void *v, const void *a,
                          void *tau) {
    return rbd_rnea(model, work, q, v, a, NULL, tau);
}

static rbd_status call_mm(const void *model, void *work, const void *q, const void *v, const void *x,
                          void *M) {
    (void)v;
    (void)x;
    return rbd_crba(model, work, q, M);
}

static rbd_status call_fd(const void *model, void *work, const void *q, const void *v, const void *tau,
                          void *a) {
    return rbd_aba(model, work, q, v, tau, NULL, a);
}

static rbd_status call_fd_cholesky(const void *model, void *work, const void *q, const void *v,
                                   const void *tau, void *a) {
    return rbd_fd_cholesky(model, work, q, v, tau, NULL, a);
}

/* ---- numbers ---- */

static void from_double(const double *x, size_t n, void *out) {
    rbd_real *y = out;
    for (size_t i = 0; i < n; i++)
        y[i] = (rbd_real)x[i];
}

static void to_double(const void *x, size_t n, double *out) {
    const rbd_real *y = x;
    for (size_t i = 0; i < n; i++)
        out[i] = (double)y[i];
}

static rbd_real magnitude(rbd_real x) {
    return x < 0 ? -x : x;
}

static rbd_real larger(rbd_real a, rbd_real b) {
    return a < b ? b : a;
}

static double relative_error(const double *x, const void *expected, int n) {
    const rbd_real *e = expected;
    rbd_real difference = 0, largest = (rbd_real)1e-3;
    for (int i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite((double)e[i]))
            return HUGE_VAL;
        difference = larger(difference, magnitude((rbd_real)x[i] - e[i]));
        largest = larger(largest, magnitude(e[i]));
    }
    return (double)(difference / largest);
}

const struct library LIBRARY = {
    .scalar = TEXT(RBD_REAL),
    .size = sizeof(rbd_real),
    .epsilon = sizeof(rbd_real) == sizeof(float) ? (double)FLT_EPSILON : DBL_EPSILON,
    .model_build = model_build,
    .model_size = rbd_model_size,
    .work_init = work_init,
    .work_size = work_size,
    .set_gravity = set_gravity,
    .call = {[ID] = call_id, [MM] = call_mm, [FD] = call_fd, [FD_CHOLESKY] = call_fd_cholesky},
    .from_double = from_double,
    .to_double = to_double,
    .relative_error = relative_error,
};
