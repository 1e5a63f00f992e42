/* The counter sources against loops whose counts are known. Without arguments: perf.c, as far as this machine
   has counters. --names: whether libpfm4 knows our events. --callgrind: marks the loops for callgrind;
   test_workload.py runs that. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "../counters/perf.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef BENCH_VALGRIND
#include <valgrind/callgrind.h>
#endif
#ifdef BENCH_PFM
#include <perfmon/pfmlib.h>
#endif

enum { LOOP = 100000 };

static int failures;

static void expect(int truth, const char *what, double found) {
    if (!truth) {
        fprintf(stderr, "test_counters: %s, found %g\n", what, found);
        failures++;
    }
}

/* ---- loops ---- */

#ifdef __x86_64__
#define HAVE_LOOPS 1
static void multiply_scalars(int n) {
    double x = 1, y = 1;
    for (int i = 0; i < n; i++) __asm__ volatile("mulsd %1, %0" : "+x"(x) : "x"(y));
}

static void multiply_pairs(int n) {
    double x __attribute__((vector_size(16))) = {1, 1}, y __attribute__((vector_size(16))) = {1, 1};
    for (int i = 0; i < n; i++) __asm__ volatile("mulpd %1, %0" : "+x"(x) : "x"(y));
}
#else
#define HAVE_LOOPS 0
static void multiply_scalars(int n) {
    volatile double x = 1;
    for (int i = 0; i < n; i++) x = x * 1.0;
}
#endif

/* ---- perf ---- */

static void check_scaling(void) {
    expect(perf_scaled(1000, 50, 50) == 1000, "an event counted all the time is as it is",
           perf_scaled(1000, 50, 50));
    expect(perf_scaled(1000, 50, 25) == 2000, "one counted half the time is doubled",
           perf_scaled(1000, 50, 25));
    expect(perf_scaled(1000, 50, 0) == 0, "one never counted is 0, not NaN", perf_scaled(1000, 50, 0));
}

/* Counts the loop by one group; false if it opens none of its events. */
static bool count_loop(const struct perf_group *group, struct perf_run *r) {
    bool opened = false;
    perf_open(r, group);
    for (int i = 0; i < PERF_GROUP; i++) opened = opened || r->fd[i] >= 0;
    perf_start(r);
    multiply_scalars(LOOP);
    perf_stop(r);
    perf_close(r);
    return opened;
}

/* Checks a counter's value for the loop. */
static void check_counter(const char *name, double count) {
    const bool x86 = HAVE_LOOPS;
    if (strcmp(name, "task_clock_ns") == 0)
        expect(count > 0.1 * LOOP && count < 1e10,
               "the loop takes more than 0.1 ns a round and less than 10 s", count);
    else if (strcmp(name, "instructions") == 0)
        expect(count >= 2 * LOOP, "at least a multiplication and a branch a round", count);
    else if (strcmp(name, "fp_scalar") == 0 && x86)
        expect(fabs(count - LOOP) <= 0.01 * LOOP, "one scalar multiplication a round", count);
    else if (strcmp(name, "fp_256") == 0 && x86)
        expect(count <= 0.01 * LOOP, "no packed one", count);
}

static void check_perf(void) {
    char text[256];
    printf("%s\n", perf_available(text, sizeof text) ? "with hardware counters" : text);
    expect(strchr(text, '\n') == NULL && strlen(text) > 20, "availability in one line", (double)strlen(text));
    for (int g = 0; g < perf_group_count; g++) {
        struct perf_run r;
        if (perf_groups[g].scalar && strcmp(perf_groups[g].scalar, "double") != 0) continue;
        if (!count_loop(&perf_groups[g], &r)) continue;
        expect(r.share > 0 && r.share <= 1.001, "the share of time is in (0, 1]", r.share);
        for (int i = 0; i < PERF_GROUP; i++)
            if (r.fd[i] >= 0) {
                printf("%s %.0f in %d rounds\n", perf_groups[g].counter[i].name, r.count[i], LOOP);
                check_counter(perf_groups[g].counter[i].name, r.count[i]);
            }
    }
}

/* ---- libpfm4's names ---- */

#ifdef BENCH_PFM
/* Whether some processor has the event. */
static bool is_known(const char *event) {
    for (int p = 0; p < PFM_PMU_MAX; p++) {
        char name[160];
        pfm_pmu_info_t pmu;
        memset(&pmu, 0, sizeof pmu);
        pmu.size = sizeof pmu;
        if (pfm_get_pmu_info((pfm_pmu_t)p, &pmu) != PFM_SUCCESS) continue;
        snprintf(name, sizeof name, "%s::%s", pmu.name, event);
        if (pfm_find_event(name) >= 0) return true;
    }
    return false;
}

static int check_names(void) {
    setenv("LIBPFM_ENCODE_INACTIVE", "1", 1); /* those of processors that are not here */
    expect(pfm_initialize() == PFM_SUCCESS, "libpfm4 starts", 0);
    expect(!is_known("FP_ARITH:NO_SUCH_WIDTH"), "an unknown event is not found", 1);
    for (int g = 0; g < perf_group_count; g++)
        for (int i = 0; i < PERF_GROUP; i++)
            for (int k = 0; k < 4 && perf_groups[g].counter[i].event[k]; k++)
                expect(is_known(perf_groups[g].counter[i].event[k]), perf_groups[g].counter[i].event[k], 0);
    return failures ? 1 : 0;
}
#else
static int check_names(void) {
    puts("skipped: built without libpfm4: ./run deps test");
    return 77;
}
#endif

/* ---- callgrind ---- */

static int mark_loops(void) {
#if defined BENCH_VALGRIND && HAVE_LOOPS
    CALLGRIND_ZERO_STATS;
    CALLGRIND_TOGGLE_COLLECT;
    multiply_scalars(LOOP);
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT("loop,1,scalars,double,none,none,100000");
    CALLGRIND_ZERO_STATS;
    CALLGRIND_TOGGLE_COLLECT;
    multiply_pairs(LOOP);
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT("loop,1,pairs,double,none,none,100000");
    return 0;
#else
    puts("skipped: built without valgrind's header, or not for x86-64: ./run deps count");
    return 77;
#endif
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "--callgrind") == 0) return mark_loops();
    if (argc > 1 && strcmp(argv[1], "--names") == 0) return check_names();
    check_scaling();
    check_perf();
    return failures ? 1 : 0;
}
