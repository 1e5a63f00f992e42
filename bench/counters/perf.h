/* perf.h - counters of the processor and the kernel, by perf_event_open. SPDX-License-Identifier: MIT */
#ifndef BENCH_PERF_H
#define BENCH_PERF_H

#include <stdbool.h>
#include <stdint.h>

/* One counter of a group. Events are tried in turn: libpfm4's names, then the kernel's generic one. */
struct perf_counter {
    const char *name;     /* in the output */
    const char *event[4]; /* for libpfm4; NULL ends them */
    bool generic;         /* whether the next two are one of the kernel's events */
    uint32_t type;
    uint64_t config;
    double factor; /* what one event stands for */
};

enum { PERF_GROUP = 4 };

/* Counters that are read together, for the same run; name NULL ends them. */
struct perf_group {
    const char *scalar; /* only for this one; NULL: any */
    struct perf_counter counter[PERF_GROUP];
};

extern const struct perf_group perf_groups[];
extern const int perf_group_count;

/* A group being counted. */
struct perf_run {
    const struct perf_group *group;
    int fd[PERF_GROUP]; /* -1: this machine has no such event */
    double count[PERF_GROUP];
    double share; /* of the time that the group was counted; below 1 the counts are scaled up */
};

/* Whether there are hardware counters; if not, says why and what to do, in one line of text. */
bool perf_available(char *text, int size);

void perf_open(struct perf_run *r, const struct perf_group *group);
void perf_start(const struct perf_run *r);
void perf_stop(struct perf_run *r); /* sets count and share */
void perf_close(struct perf_run *r);

/* The count of an event that was counted for `running` of `enabled` nanoseconds. */
double perf_scaled(uint64_t count, uint64_t enabled, uint64_t running);

#endif
