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
    int scalar;    /* index of a timed library, or ALL */
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

/* ---- library.c ---- */

enum { ID, MM, FD, FD_CHOLESKY, ALGORITHMS };

/* One call of an algorithm. All arrays are of the library's scalar; x: the acceleration (ID) or the
   torque (FD, FD_CHOLESKY); MM reads q alone. */
typedef rbd_status library_call(const void *model, void *work, const void *q, const void *v, const void *x,
                                void *out);

/* The library, instantiated for one scalar. */
struct library {
    const char *scalar; /* on the command line and in the report */
    size_t size;        /* bytes of a number in its arrays */
    double epsilon;     /* distance from 1 to the next number */
    rbd_status (*model_build)(const rbd_body *bodies, int nb, void *memory, size_t size, const void **model,
                              rbd_report *report);
    size_t (*model_size)(const rbd_body *bodies, int nb);
    rbd_status (*work_init)(const void *model, void *memory, size_t size, void **work);
    size_t (*work_size)(const void *model);
    rbd_status (*set_gravity)(void *work, const double gravity[3]);
    library_call *call[ALGORITHMS];
    void (*from_double)(const double *x, size_t n, void *out);
    void (*to_double)(const void *x, size_t n, double *out);
    /* Largest difference / largest entry of the expected array (at least 1e-3), computed in the library's
       scalar; infinite if something is not finite. */
    double (*relative_error)(const double *x, const void *expected, int n);
};

/* Those before TIMED are timed; QUAD, NULL if the compiler has no __float128, judges them. */
enum { DOUBLE, FLOAT, TIMED, QUAD = TIMED, LIBRARIES };
extern const struct library *const libraries[LIBRARIES];

/* ---- robots.c ---- */

/* States one after another: sample k begins at element k * nq of q, k * nv of v and so on. */
struct states {
    const void *q, *v, *a, *tau;
};

struct robot;

/* A robot in the scalar of a library. */
struct instance {
    const struct robot *robot;
    const struct library *library; /* NULL: not open */
    const void *model;
    void *work;
    struct states states; /* the random ones, rounded to the scalar; none for QUAD */
    struct states input;  /* a single one, for instance_take_sample */
    void *out;            /* room for the results of one call */
    void *model_memory, *work_memory, *state_memory, *input_memory;
};

struct robot {
    const char *name;  /* on the command line and in CSV */
    const char *title; /* for people */
    const rbd_body *bodies;
    int nb, nq, nv;
    const ref_model *reference;
    double *numbers;                      /* scratch of conversions: nv x nv, or a state */
    struct instance instances[LIBRARIES]; /* DOUBLE and, if there is one, QUAD are always open */
};

extern const char *const robot_names[]; /* ended by NULL */

/* Builds robot number index and draws its random states, for the library asked for, or ALL that are timed.
   Returns 0, or -1 after a message. */
int robot_open(struct robot *r, int index, int library, int samples, uint64_t seed);
void robot_close(struct robot *r);

/* For all algorithms and scalars. */
void robot_set_gravity(const struct robot *r, const double gravity[3]);

/* Makes random state k of one instance the input of another of the same robot. */
void instance_take_sample(const struct instance *to, const struct instance *from, int k);

/* ---- algorithms.c ---- */

struct algorithm {
    const char *name;  /* on the command line and in CSV */
    const char *title; /* for people */
};

extern const struct algorithm algorithms[ALGORITHMS];

/* The loop that is timed: computes samples first .. first + count - 1 and leaves the results of the last
   one in out. */
rbd_status algorithm_run(int algorithm, const struct instance *r, const struct states *s, int first,
                         int count, void *out);

/* Length of its result. */
int algorithm_results(int algorithm, const struct robot *r);

/* One line of the report: a robot, a scalar and an algorithm. */
struct row {
    const struct instance *instance;
    int algorithm;
    double max_error;         /* by verify */
    double quad_error;        /* by measure_accuracy; negative: unknown */
    double mean, stddev, min; /* by measure: over the experiments, ns per call */
};

/* ---- verify.c ---- */

/* Compares the rows' results with the stored references, checks identities on their random states, with
   the gravity given, which stays set, and compares other scalars with double. Returns 0, or -1 after a
   message. */
int verify(struct row *rows, int n, const double gravity[3], int samples);

/* ---- accuracy.c ---- */

/* Sets *error to the relative error of a result on random state k, the same input given to the arbiter. */
rbd_status sample_error(const struct instance *tested, const struct instance *arbiter, int algorithm, int k,
                        double *error);

/* Sets the rows' quad_error. Returns 0, or -1 after a message. */
int measure_accuracy(struct row *rows, int n, int samples);

/* ---- measure.c ---- */

/* Times all rows; experiments of a row never follow each other if there is another row.
   Returns 0, or -1 after a message. */
int measure(struct row *rows, int n, int samples, int experiments);

/* ---- report.c ---- */

#define TEXT(x) TEXT_OF(x)
#define TEXT_OF(x) #x

/* Prints where something went wrong and what, to stderr. Returns -1. */
int row_error(const struct row *row, const char *format, ...);

/* Shows a line that the next one replaces, if stderr is a terminal; an empty one erases it. */
void progress(const char *format, ...);

/* Finds out, before the hours of measuring, whether the report can be written. Returns 0, or -1. */
int report_check_output(const char *output);

/* Writes the report; a file is there wholly or not at all. Returns 0, or -1. */
int report_write(const struct options *o, const struct row *rows, int n);

#endif
