/* By made-up clocks: a disturbed row is timed again until its least time has come twice, or marked; others
   are not. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "../bench.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* An experiment takes as long as some chunks and a half, which noise makes neither more nor fewer; a warm-up
   precedes them, and a first look at the time of a call precedes it all. */
#define MEAN_NS 999.5
enum {
    EXPERIMENTS = 10,
    LOOK = 2,
    CHUNKS = 32,
    CALLS = 1 + CHUNKS,
    SAMPLES = (int)((CHUNKS + 0.5) * CHUNK_NS / MEAN_NS)
};

static double work_of_state(int k) { return MEAN_NS - 99.5 + k % 200; /* ns */ }

static double work_of(int first, int count) {
    double ns = 0;
    for (int k = first; k < first + count; k++) ns += work_of_state(k);
    return ns;
}

static void expect(bool fact, const char *what) {
    if (fact) return;
    fprintf(stderr, "not so: %s\n", what);
    exit(EXIT_FAILURE);
}

static int calls; /* of the clock, for the row at hand */

/* On an idle machine: 1 % of noise. */
static rbd_status idle(const struct row *row, int first, int count, double *ns) {
    (void)row;
    *ns = work_of(first, count) * (1 + 0.01 * (++calls % 5) / 5);
    return RBD_OK;
}

/* Half of all chunks are interrupted for as long again; of the whole experiments every one is. */
static rbd_status busy(const struct row *row, int first, int count, double *ns) {
    static unsigned random = 1;
    (void)row;
    random = random * 1664525u + 1013904223u;
    *ns = work_of(first, count) * (random >> 31 ? 2 : 1);
    calls++;
    return RBD_OK;
}

/* No two times are alike: after the first look, each is longer than the one before. */
static rbd_status hopeless(const struct row *row, int first, int count, double *ns) {
    (void)row;
    *ns = work_of(first, count) * pow(1.05, calls < LOOK ? 0 : calls);
    calls++;
    return RBD_OK;
}

/* Disturbed as long as the usual experiments last, then idle. */
static rbd_status late(const struct row *row, int first, int count, double *ns) {
    const int early = LOOK + EXPERIMENTS * CALLS;
    (void)row;
    *ns = work_of(first, count) * (calls >= LOOK && calls < early ? 3 + 0.5 * (calls / CALLS) : 1);
    calls++;
    return RBD_OK;
}

static struct row measured(timer *clock, int threads, int experiments) {
    static const struct robot robot = {.title = "none"};
    static const struct library library = {.name = "rbd", .scalar = "double"};
    static const struct instance instance = {.robot = &robot, .library = &library};
    struct row row = {.instance = &instance, .variant = threads > 1 ? THREADS : RUN_TIME, .threads = threads};
    calls = 0;
    expect(measure_by(&row, 1, SAMPLES, experiments, clock) == 0, "it is measured");
    return row;
}

/* As idle, a thousand times as slow. */
static rbd_status slow(const struct row *row, int first, int count, double *ns) {
    const rbd_status status = idle(row, first, count, ns);
    *ns *= 1000;
    return status;
}

/* The text that measuring with this clock prints to stderr. */
static const char *printed(timer *clock, char text[256]) {
    int ends[2];
    const int saved = dup(STDERR_FILENO);
    expect(pipe(ends) == 0 && saved >= 0 && dup2(ends[1], STDERR_FILENO) >= 0, "stderr is a pipe");
    measured(clock, 1, EXPERIMENTS);
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(ends[1]);
    const ssize_t size = read(ends[0], text, 255);
    close(ends[0]);
    text[size > 0 ? size : 0] = 0;
    return text;
}

static bool near(double x, double y) { return fabs(x - y) <= 1e-9 * y; }

int main(void) {
    const double truth = work_of(0, SAMPLES) / SAMPLES;
    struct row row = measured(idle, 1, EXPERIMENTS);
    const int usual = LOOK + EXPERIMENTS * CALLS;
    expect(!row.disturbed && row.min >= truth && row.min < 1.01 * truth,
           "an idle machine's time is the work's");
    expect(calls == usual, "experiments are timed in chunks, and no more than asked for");

    row = measured(busy, 1, EXPERIMENTS);
    expect(!row.disturbed && near(row.min, truth), "interruptions do not reach the least time");
    expect(row.mean > 1.3 * truth, "but the mean");

    row = measured(hopeless, 1, EXPERIMENTS);
    expect(row.disturbed, "what never repeats is marked");
    expect(calls == LOOK + 3 * EXPERIMENTS * CALLS, "after twice as many experiments more");

    row = measured(late, 1, EXPERIMENTS);
    expect(!row.disturbed && near(row.min, truth), "further experiments find the least time");
    expect(calls == usual + 2 * CALLS, "and end when it has come twice");
    expect(row.mean > 3 * truth, "mean and deviation are of the usual ones");

    row = measured(hopeless, 2, EXPERIMENTS);
    expect(calls == LOOK + 3 * EXPERIMENTS * 2, "threads are timed without interruption");

    /* 10 experiments of 32.5 chunks and 1000 states, each a thousand times 0.2 ms or 1 us */
    char text[256];
    expect(strstr(printed(slow, text), "timing takes about 75 seconds, up to 3 times"),
           "what takes long says beforehand how long");
    expect(!*printed(idle, text), "what does not says nothing, and a pipe sees no progress");

    row = measured(hopeless, 1, 1);
    expect(!row.disturbed && calls == LOOK + CALLS, "one experiment stays one");
    return EXIT_SUCCESS;
}
