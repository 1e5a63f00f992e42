/* Timing. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "../bench.h"
#include "least.h"
#include <math.h>
#include <stdlib.h>
#include <time.h>

/* Calls before each experiment that are not timed: the row before has left caches and branch
   predictors to another robot. */
enum { WARM_UP_CALLS = 1000 };

/* A row whose least time has not come twice has up to so many times as many experiments again. */
enum { MORE = 2 };

/* The chunks of a row: the two least times of each, in ns for all its states; and the time of an experiment
   by the first look. */
struct timing {
    struct least *chunk;
    int count;
    double expected;
};

/* ---- the clock ---- */

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static rbd_status time_states(const struct row *row, int first, int count, double *ns) {
    const double start = now_ns();
    const rbd_status status = row_run(row, first, count);
    *ns = now_ns() - start;
    return status;
}

/* ---- a row ---- */

/* The first state of chunk i. */
static int chunk_begin(const struct timing *t, int i, int samples) {
    const int batches = (samples + BATCH - 1) / BATCH, begin = thread_share(batches, i, t->count) * BATCH;
    return begin < samples ? begin : samples;
}

/* Decides on the chunks, by a first look at the time of a call. Threads are not interrupted by chunks. */
static rbd_status timing_open(struct timing *t, const struct row *row, int samples, timer *time_of) {
    const int calls = samples < WARM_UP_CALLS ? samples : WARM_UP_CALLS, batches = samples / BATCH;
    double ns = 0;
    rbd_status status = time_of(row, 0, calls, &ns); /* caches are cold: */
    if (status == RBD_OK) status = time_of(row, 0, calls, &ns);
    const double chunks = row->threads > 1 ? 1 : ns / calls * samples / CHUNK_NS;
    t->expected = ns / calls * (samples + calls);
    t->count = chunks < 1 ? 1 : chunks < batches ? (int)chunks : batches > 1 ? batches : 1;
    t->chunk = malloc((size_t)t->count * sizeof *t->chunk);
    for (int i = 0; t->chunk && i < t->count; i++) t->chunk[i] = LEAST_NONE;
    return status != RBD_OK || t->chunk ? status : RBD_ERR_MEMORY;
}

/* One experiment: sets *ns to the time of a call, mean of all samples. */
static rbd_status experiment(struct timing *t, const struct row *row, int samples, timer *time_of,
                             double *ns) {
    const int warm_up = samples < WARM_UP_CALLS ? samples : WARM_UP_CALLS;
    double sum = 0, time = 0;
    rbd_status status = time_of(row, 0, warm_up, &time);
    for (int i = 0; i < t->count && status == RBD_OK; i++) {
        const int begin = chunk_begin(t, i, samples), end = chunk_begin(t, i + 1, samples);
        status = time_of(row, begin, end - begin, &time);
        least_take(&t->chunk[i], time);
        sum += time;
    }
    *ns = sum / samples;
    return status;
}

/* Sets the row's least time, and whether it has not come twice. */
static void settle(struct row *row, const struct timing *t, int samples) {
    struct least sum = {0, 0};
    for (int i = 0; i < t->count; i++) {
        sum.first += t->chunk[i].first;
        sum.second += t->chunk[i].second;
    }
    row->min = sum.first / samples;
    row->disturbed = !least_repeats(sum);
}

/* Takes one more time into mean and deviation; n: how many there are with this one. Until the end, stddev
   holds the sum of the squared deviations (Welford's method). */
static void take_time(struct row *row, int n, double ns) {
    const double deviation = ns - row->mean;
    row->mean += deviation / n;
    row->stddev += deviation * (ns - row->mean);
}

/* ---- all of them ---- */

static void show(const struct row *row, const char *what, int e, int experiments) {
    char variant[NAME_SIZE];
    const struct instance *r = row->instance;
    progress("%s %d of %d: %s, %s, %s, %s", what, e, experiments, r->robot->title, r->library->scalar,
             algorithms[row->algorithm].title, row_variant(row, variant));
}

/* Says how long all will take, if it is worth it. */
static void announce(const struct timing *timings, int n, int experiments) {
    double seconds = 0;
    for (int i = 0; i < n; i++) seconds += 1e-9 * timings[i].expected * experiments;
    if (seconds < 10) return;
    progress("");
    const bool brief = seconds < 100;
    fprintf(stderr,
            "rbd-bench: verified; timing takes about %.0f %s, up to %d times that if times do not repeat\n",
            brief ? seconds : seconds / 60, brief ? "seconds" : "minutes", 1 + MORE);
}

/* Each row's experiment in turn. */
static int round_of(struct row *rows, struct timing *timings, int n, int samples, int e, int experiments,
                    timer *time_of) {
    for (int i = 0; i < n; i++) {
        double ns;
        const bool more =
            e > experiments; /* for the least alone: mean and deviation are of as many for all */
        if (more && !rows[i].disturbed) continue;
        show(&rows[i], more ? "disturbed, once more:" : "experiment", more ? e - experiments : e,
             more ? MORE * experiments : experiments);
        const rbd_status status = experiment(&timings[i], &rows[i], samples, time_of, &ns);
        if (status != RBD_OK) return row_error(&rows[i], "%s", rbd_status_string(status));
        if (!more) take_time(&rows[i], e, ns);
        settle(&rows[i], &timings[i], samples);
    }
    return 0;
}

static int measure_into(struct row *rows, struct timing *timings, int n, int samples, int experiments,
                        timer *time_of) {
    const int rounds = experiments > 1 ? (1 + MORE) * experiments : 1;
    for (int i = 0; i < n; i++) {
        rows[i].mean = rows[i].stddev = rows[i].min = 0;
        const rbd_status status = timing_open(&timings[i], &rows[i], samples, time_of);
        if (status != RBD_OK) return row_error(&rows[i], "%s", rbd_status_string(status));
    }
    announce(timings, n, experiments);
    for (int e = 1; e <= rounds; e++)
        if (round_of(rows, timings, n, samples, e, experiments, time_of) != 0) return -1;
    for (int i = 0; i < n; i++) {
        rows[i].stddev = experiments > 1 ? sqrt(rows[i].stddev / (experiments - 1)) : 0;
        rows[i].disturbed = rows[i].disturbed && experiments > 1; /* of one time nothing can be told */
    }
    return 0;
}

int measure_by(struct row *rows, int n, int samples, int experiments, timer *time_of) {
    struct timing *timings = calloc((size_t)n, sizeof *timings);
    if (!timings) {
        fprintf(stderr, "rbd-bench: not enough memory\n");
        return -1;
    }
    const int status = measure_into(rows, timings, n, samples, experiments, time_of);
    for (int i = 0; i < n; i++) free(timings[i].chunk);
    free(timings);
    progress("");
    return status;
}

int measure(struct row *rows, int n, int samples, int experiments) {
    return measure_by(rows, n, samples, experiments, time_states);
}
