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
    int scalar;    /* index of a scalar, or ALL */
    int variant;   /* RUN_TIME and so on, or ALL */
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

enum { ID, MM, MM_PACKED, FD, FD_CHOLESKY, ALGORITHMS };

/* How a library is called; a batch is BATCH states. THREADS is no library: it is LANES on several threads. */
enum { RUN_TIME, COMPILE_TIME, LANES, THREADS, VARIANTS };
enum { BATCH = 64 };

/* One call of an algorithm, for n states (1 to width) that stand one after the other. All arrays are of the
   library's scalar; x: the acceleration (ID) or the torque (FD, FD_CHOLESKY); MM and MM_PACKED read q alone.
 */
typedef rbd_status library_call(const void *model, void *work, int n, const void *q, const void *v,
                                const void *x, void *out);

/* The library, instantiated for one scalar and variant. */
struct library {
    const char *scalar; /* on the command line and in the report */
    int variant, lanes; /* lanes: states in a SIMD instruction; 1 but with LANES */
    const char *robot;  /* the name of the only one it knows; NULL: any */
    int width;          /* states a call takes at most */
    size_t size;        /* bytes of a number in its arrays */
    double epsilon;     /* distance from 1 to the next number */
    rbd_status (*model_build)(const rbd_body *bodies, int nb, void *memory, size_t size, const void **model,
                              rbd_report *report);
    size_t (*model_size)(const rbd_body *bodies, int nb);
    rbd_status (*work_init)(const void *model, void *memory, size_t size, void **work);
    size_t (*work_size)(const void *model);
    rbd_status (*set_gravity)(void *work, const double gravity[3]);
    library_call *call[ALGORITHMS]; /* NULL: it lacks this algorithm */
    void (*from_double)(const double *x, size_t n, void *out);
    void (*to_double)(const void *x, size_t n, double *out);
    /* Largest difference / largest entry of the expected array (at least 1e-3), computed in the library's
       scalar; infinite if something is not finite. */
    double (*relative_error)(const double *x, const void *expected, int n);
};

/* Those before TIMED are timed; QUAD, NULL if the compiler has no __float128, judges them. */
enum {
    DOUBLE,
    FLOAT,
    SCALARS,
    IIWA = SCALARS, /* known at compile time */
    HYQ,
    ATLAS,
    LANES_DOUBLE,
    LANES_FLOAT,
    TIMED,
    QUAD = TIMED,
    LIBRARIES
};
extern const struct library *const libraries[LIBRARIES];

/* ---- robots.c ---- */

/* States one after another: sample k begins at element k * nq of q, k * nv of v and so on. */
struct states {
    const void *q, *v, *a, *tau;
};

struct robot;

/* What one thread needs of its own. */
struct worker {
    void *work, *memory;
    void *out; /* room for the results of one call */
};

/* A robot in a library. */
struct instance {
    const struct robot *robot;
    const struct library *library; /* NULL: not open */
    const void *model;
    struct worker *worker; /* one for each thread, if the variant is LANES; else one */
    int workers;
    struct states states; /* the random ones, rounded to the scalar; none for QUAD */
    struct states input;  /* a single one, for instance_take_sample */
    void *model_memory, *state_memory, *input_memory; /* state_memory: NULL if another's states serve */
};

struct robot {
    const char *name;  /* on the command line and in CSV */
    const char *title; /* for people */
    const rbd_body *bodies;
    int nb, nq, nv;
    int packed; /* entries of the packed mass matrix */
    const ref_model *reference;
    double *numbers;                      /* scratch of conversions: nv x nv, or a state */
    struct instance instances[LIBRARIES]; /* DOUBLE and, if there is one, QUAD are always open */
};

extern const char *const robot_names[]; /* ended by NULL */

/* Builds robot number index for the libraries that the options ask for, and draws its random states.
   Returns 0, or -1 after a message. */
int robot_open(struct robot *r, int index, const struct options *o);
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

extern const char *const scalar_names[]; /* ended by NULL, like those below */
extern const char *const variant_names[];

/* Whether the options ask for this library: it is of the scalar and variant, and knows the robot. */
bool library_wanted(const struct library *library, const struct robot *r, const struct options *o);

/* Computes samples first .. first + count - 1, as many a call as the library takes, and leaves the results of
   the last call in w->out. */
rbd_status algorithm_run(int algorithm, const struct instance *r, const struct worker *w,
                         const struct states *s, int first, int count);

/* Numbers in its result for one state. */
int algorithm_results(int algorithm, const struct robot *r);

/* One line of the report: a robot, an algorithm, and how it is called. */
struct row {
    const struct instance *instance;
    int algorithm;
    int variant;
    int threads;              /* 1 but with THREADS */
    double max_error;         /* by verify */
    double quad_error;        /* by measure_accuracy; negative: unknown */
    double mean, stddev, min; /* by measure: over the experiments, ns per call */
};

/* ---- threads.c ---- */

/* Cores that threads can use; 1 if this build has no threads. */
int threads_available(void);

/* The loop that is timed: algorithm_run, or each thread its share of the samples. */
rbd_status row_run(const struct row *row, int first, int count);

/* The first sample, counted from 0, of thread t when threads share so many; thread t + 1's ends it. */
int thread_share(int count, int t, int threads);

/* ---- verify.c ---- */

/* Compares the rows' results with the stored references, checks identities on their random states, with
   the gravity given, which stays set, and compares other scalars with double. Returns 0, or -1 after a
   message. */
int verify(struct row *rows, int n, const double gravity[3], int samples);

/* ---- accuracy.c ---- */

/* Runs the row on samples first .. first + count - 1, at most width for each thread, and sets *error to the
   largest relative error of the results, the arbiter given the same input. */
rbd_status block_error(const struct row *row, const struct instance *arbiter, int first, int count,
                       double *error);

/* The largest number of samples for block_error. */
int block_length(const struct row *row);

/* Sets the rows' quad_error. Returns 0, or -1 after a message. */
int measure_accuracy(struct row *rows, int n, int samples);

/* ---- measure.c ---- */

/* Times all rows; experiments of a row never follow each other if there is another row.
   Returns 0, or -1 after a message. */
int measure(struct row *rows, int n, int samples, int experiments);

/* ---- report.c ---- */

#define TEXT(x) TEXT_OF(x)
#define TEXT_OF(x) #x

/* "run-time", "lanes 8", "threads 2" and so on; returns text. */
const char *row_variant(const struct row *row, char text[32]);

/* Prints where something went wrong and what, to stderr. Returns -1. */
int row_error(const struct row *row, const char *format, ...);

/* Shows a line that the next one replaces, if stderr is a terminal; an empty one erases it. */
void progress(const char *format, ...);

/* Finds out, before the hours of measuring, whether the report can be written. Returns 0, or -1. */
int report_check_output(const char *output);

/* Writes the report; a file is there wholly or not at all. Returns 0, or -1. */
int report_write(const struct options *o, const struct row *rows, int n);

#endif
