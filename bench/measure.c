/* Timing. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"
#include <math.h>
#include <time.h>

/* Calls before each experiment that are not timed: the row before has left caches and branch
   predictors to another robot. */
enum { WARM_UP_CALLS = 1000 };

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* One experiment: sets *ns to the time of a call, mean of all samples. */
static rbd_status experiment(const struct row *row, int samples, double *ns) {
    const int warm_up = samples < WARM_UP_CALLS ? samples : WARM_UP_CALLS;
    rbd_status status = row_run(row, 0, warm_up);
    if (status != RBD_OK)
        return status;
    double start = now_ns();
    status = row_run(row, 0, samples);
    *ns = (now_ns() - start) / samples;
    return status;
}

/* Takes one more time into the row; n: how many it has with this one. Until summarise, stddev holds
   the sum of the squared deviations (Welford's method). */
static void take_time(struct row *row, int n, double ns) {
    double deviation = ns - row->mean;
    row->mean += deviation / n;
    row->stddev += deviation * (ns - row->mean);
    row->min = n == 1 || ns < row->min ? ns : row->min;
}

int measure(struct row *rows, int n, int samples, int experiments) {
    for (int i = 0; i < n; i++)
        rows[i].mean = rows[i].stddev = rows[i].min = 0;
    for (int e = 1; e <= experiments; e++) {
        for (int i = 0; i < n; i++) {
            const struct instance *r = rows[i].instance;
            char variant[32];
            progress("experiment %d of %d: %s, %s, %s, %s", e, experiments, r->robot->title,
                     r->library->scalar, algorithms[rows[i].algorithm].title, row_variant(&rows[i], variant));
            double ns = 0;
            rbd_status status = experiment(&rows[i], samples, &ns);
            if (status != RBD_OK)
                return row_error(&rows[i], "%s", rbd_status_string(status));
            take_time(&rows[i], e, ns);
        }
    }
    progress("");
    for (int i = 0; i < n; i++)
        rows[i].stddev = experiments > 1 ? sqrt(rows[i].stddev / (experiments - 1)) : 0;
    return 0;
}
