/* The library for one scalar and variant, as a table. This file is compiled once for each (see meson.build):
   LIBRARY names the table; RBD_REAL and RBD_CONST choose the scalar; RBD_LANES makes its calls batches; CODE
   makes them calls of code generated for one robot, in CODE_REAL. With LIBRARY alone it is the library as a
   program has it; the others are RBD_STATIC, since a program can have the names of rbd.h only once.
   SPDX-License-Identifier: MIT */
#if defined CODE
#include "generated.h"
#elif defined RBD_LANES
#include "lanes.h"
#else
#include "run_time.h"
#endif
#include <float.h>
#include <math.h>

#ifndef CODE
#define SCALAR RBD_REAL
#define FIXED_BASE false
#endif
typedef SCALAR number; /* of the arrays: rbd_real may be a vector of them */

#ifdef ALONE /* in a shared object that shows nothing else */
__attribute__((visibility("default")))
#endif
extern const struct library LIBRARY;
#ifdef BLOCKS_LIBRARY /* the same calls on states that stand lane by lane */
extern const struct library BLOCKS_LIBRARY;
#endif

static rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t size, const void **model,
                              char *text) {
    const rbd_model *m = NULL;
    rbd_report report;
    rbd_status status = rbd_model_build(bodies, nb, memory, size, &m, &report);
    if (status != RBD_OK) rbd_finding_text(&report.error, text, 160);
    *model = m;
    return status;
}

static size_t model_size(const rbd_body *bodies, int nb) { return rbd_model_size(bodies, nb); }

/* ---- numbers ---- */

static void from_double(const double *x, size_t n, void *out) {
    number *y = out;
    for (size_t i = 0; i < n; i++) y[i] = (number)x[i];
}

static void to_double(const void *x, size_t n, double *out) {
    const number *y = x;
    for (size_t i = 0; i < n; i++) out[i] = (double)y[i];
}

static number magnitude(number x) { return x < 0 ? -x : x; }

static number larger(number a, number b) { return a < b ? b : a; }

static double relative_error(const double *x, const void *expected, int n) {
    const number *e = expected;
    number difference = 0, largest = (number)1e-3;
    for (int i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite((double)e[i])) return HUGE_VAL;
        difference = larger(difference, magnitude((number)x[i] - e[i]));
        largest = larger(largest, magnitude(e[i]));
    }
    return (double)(difference / largest);
}

#define TABLE(variant_, blocks_, work_init_) \
    { \
        .name = "rbd", \
        .version = RBD_VERSION, \
        .scalar = TEXT(SCALAR), \
        .variant = variant_, \
        .lanes = N_LANES, \
        .blocks = blocks_, \
        .robot = ONLY_ROBOT, \
        .fixed_base = FIXED_BASE, \
        .width = WIDTH, \
        .size = sizeof(number), \
        .epsilon = sizeof(number) == sizeof(float) ? (double)FLT_EPSILON : DBL_EPSILON, \
        .model_build = model_build, \
        .model_size = model_size, \
        .work_init = work_init_, \
        .work_size = work_size, \
        .set_gravity = set_gravity, \
        .call = {CALLS}, \
        .can = CAN, \
        .from_double = from_double, \
        .to_double = to_double, \
        .relative_error = relative_error, \
    }
const struct library LIBRARY = TABLE(VARIANT, false, work_init);
#ifdef BLOCKS_LIBRARY
const struct library BLOCKS_LIBRARY = TABLE(BLOCKS_VARIANT, true, work_init_blocks);
#endif
