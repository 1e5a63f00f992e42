/* bench.h - what the files of rbd-bench share.
   SPDX-License-Identifier: MIT */
#ifndef BENCH_H
#define BENCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include "rbd.h"
#include "../tests/data/reference.h"

/* ---- options.c ---- */

enum format { FORMAT_TABLE, FORMAT_CSV, FORMAT_JSON };

struct options {
    int robot;     /* index of a robot, or ALL */
    int algorithm; /* index of an algorithm, or ALL */
    int samples;
    int experiments;
    uint64_t seed;
    bool gravity;
    enum format format;
    const char *output; /* file name, NULL = standard output */
};

enum { ALL = -1 };
enum { MAX_ROBOTS = 8 };
enum { EXIT_USAGE = 2 }; /* exit status for bad arguments; 1 is for failed verification */

/* Reads the command line. Returns -1 to go on, or the exit status to end with. */
int options_read(struct options *o, int argc, char **argv);

/* Prints "rbd-bench: " and the message to stderr, and returns the exit status EXIT_USAGE. */
int usage_error(const char *format, ...);

/* ---- robots.c ---- */

/* States one after another: sample k begins at q[k * nq], v[k * nv] and so on. */
struct states {
    const double *q, *v, *a, *tau;
};

struct robot {
    const char *name;  /* on the command line and in CSV */
    const char *title; /* for people */
    int nq, nv;
    const rbd_model *model;
    rbd_work *work;
    struct states states; /* the random ones */
    double *out;          /* room for the results of one call */
    const ref_model *reference;
    void *model_memory, *work_memory, *state_memory;
};

extern const char *const robot_names[]; /* ended by NULL */

/* Builds robot number index and draws its random states. Returns 0, or -1 after a message. */
int robot_open(struct robot *r, int index, int samples, uint64_t seed);
void robot_close(struct robot *r);

/* ---- algorithms.c ---- */

enum { ID, MM, FD, FD_CHOLESKY, ALGORITHMS };

/* An algorithm as it is timed: computes samples first .. first + count - 1 and leaves the results of
   the last one in out. Another library to compare with would be one more table of these. */
struct algorithm {
    const char *name;  /* on the command line and in CSV */
    const char *title; /* for people */
    rbd_status (*run)(const struct robot *r, const struct states *s, int first, int count, double *out);
};

extern const struct algorithm algorithms[ALGORITHMS];

/* One line of the report: a robot and an algorithm. */
struct row {
    const struct robot *robot;
    int algorithm;
    double max_error;         /* by verify */
    double mean, stddev, min; /* by measure: over the experiments, ns per call */
};

/* ---- verify.c ---- */

/* Compares the rows' results with the stored references, and checks identities on their random states,
   with the gravity given, which stays set. Returns 0, or -1 after a message. */
int verify(struct row *rows, int n, const double gravity[3], int samples);

/* ---- measure.c ---- */

/* Times all rows; experiments of a row never follow each other if there is another row.
   Returns 0, or -1 after a message. */
int measure(struct row *rows, int n, int samples, int experiments);

/* ---- report.c ---- */

/* Shows a line that the next one replaces, if stderr is a terminal; an empty one erases it. */
void progress(const char *format, ...);

/* Finds out, before the hours of measuring, whether the report can be written. Returns 0, or -1. */
int report_check_output(const char *output);

/* Writes the report; a file is there wholly or not at all. Returns 0, or -1. */
int report_write(const struct options *o, const struct row *rows, int n);

#endif
