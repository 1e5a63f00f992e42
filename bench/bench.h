/* bench.h - what the files of rbd-bench share.
   SPDX-License-Identifier: MIT */
#ifndef BENCH_H
#define BENCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include "rbd.h"
#include "calls/library.h"
#include "../tests/data/reference.h"

/* ---- options.c ---- */

enum count { COUNT_NONE, COUNT_PERF, COUNT_CALLGRIND };
enum format { FORMAT_TABLE, FORMAT_CSV, FORMAT_JSON };

struct options {
    int robot;         /* index of a robot, or ALL */
    const char *model; /* URDF file of the robot instead, or NULL */
    bool floating;     /* its root link is on a floating joint */
    bool fixed_base;   /* robots with a floating base have it held still */
    int algorithm;     /* index of an algorithm, or ALL */
    int scalar;        /* index of a scalar, or ALL */
    int variant;       /* RUN_TIME and so on, or ALL */
    int library;       /* index in library_names, or ALL */
    int samples;
    int experiments;
    uint64_t seed;
    bool gravity;
    bool cold;        /* every call out of cold caches */
    bool no_quad;     /* without the error against quad precision */
    enum count count; /* instead of timing */
    bool states;      /* the states and results are written instead */
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

/* ---- libraries: calls/library.h has what one must give ---- */

/* Those before TIMED are timed; QUAD judges them. NULL: this build lacks it. */
enum {
    DOUBLE,
    FLOAT,
    SCALARS,
    IIWA_CODE = SCALARS, /* rbd-codegen's */
    HYQ_CODE,
    ATLAS_CODE,
    IIWA_FIXED, /* in float, the bases fixed */
    HYQ_FIXED,
    ATLAS_FIXED,
    LANES_DOUBLE,
    LANES_DOUBLE_4, /* where LANES_DOUBLE has 8 */
    LANES_FLOAT,
    BLOCKS_DOUBLE,
    BLOCKS_FLOAT,
    IIWA_CODE_LANES,
    HYQ_CODE_LANES,
    ATLAS_CODE_LANES,
    IIWA_CODE_BLOCKS,
    HYQ_CODE_BLOCKS,
    ATLAS_CODE_BLOCKS,
    MUJOCO, /* those of others: peers/ */
    KDL,
    RBDL,
    PINOCCHIO,
    PINOCCHIO_PV,
    PINOCCHIO_AVX512F,
    PINOCCHIO_PV_AVX512F,
    PINOCCHIO_CODE_IIWA,
    PINOCCHIO_CODE_HYQ,
    PINOCCHIO_CODE_ATLAS,
    DYNIBO,
    ROBCOGEN_IIWA,
    ROBCOGEN_HYQ,
    ROBCOGEN_ATLAS,
    TIMED,
    QUAD = TIMED,
    LIBRARIES
};
extern const struct library *const libraries[LIBRARIES];

/* ---- robots/robots.c ---- */

/* Where number i of state k stands, in an array of so many numbers a state. */
size_t number_place(const struct library *l, int numbers, int k, int i);

/* All numbers of a state, from an array of the library's. */
void take_numbers(const struct library *l, const void *array, int numbers, int k, double *x);

/* States one after another: sample k begins at element k * nq of q, k * nv of v and so on; or in blocks. */
struct states {
    const void *q, *v, *a, *tau;
};

struct robot;

/* Memory of one thread. */
struct worker {
    void *work, *memory;
    void *out; /* room for the results of one call */
};

/* A robot in a library. */
struct instance {
    const struct robot *robot;
    const struct library *library; /* NULL: not open */
    const void *model;
    int nq, nv;            /* lengths of q and v in its conventions */
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
    rbd_body *held; /* the same with the base fixed to the world, or NULL */
    int nb, nq, nv;
    int packed; /* entries of the packed mass matrix */
    int samples;
    const ref_model *reference;           /* NULL: there is none of a robot from a file */
    double *numbers;                      /* scratch of conversions: a result, or a state */
    struct instance instances[LIBRARIES]; /* DOUBLE and, if there is one, QUAD are always open */
};

extern const char *const robot_names[]; /* ended by NULL */

/* Sets nq and nv by building the model once. Returns 0, or -1. */
int robot_take_lengths(struct robot *r);

/* Loads the robot of o->model. Returns 0, or -1 after a message. (robots/model_file.c) */
int robot_load(struct robot *r, const struct options *o);

/* Builds robot number index, or that of o->model, for the libraries that the options ask for, and draws its
   random states. Returns 0, or -1 after a message. */
int robot_open(struct robot *r, int index, const struct options *o);
void robot_close(struct robot *r);

/* The work of a run-time instance of rbd in double. */
rbd_work *instance_work(const struct instance *r);

/* For all algorithms and scalars. */
void robot_set_gravity(const struct robot *r, const double gravity[3]);

/* Random state k, in rbd's conventions. */
struct state robot_state(const struct robot *r, int k);

/* Makes random state k of one instance the input of another of the same robot. */
void instance_take_sample(const struct instance *to, const struct instance *from, int k);

/* ---- robots/states_file.c ---- */

struct row;

/* For another program: the states, and rbd's results of them, of the rows of its run-time model in double.
   Returns 0, or -1 after a message. */
int write_states(FILE *f, const struct options *o, const struct row *rows, int n);

/* ---- timing/algorithms.c ---- */

enum input { NOTHING, ACCELERATION, TORQUE };

struct algorithm {
    const char *name;  /* on the command line and in CSV */
    const char *title; /* for people */
    enum input input;  /* what it takes besides q and v */
};

extern const struct algorithm algorithms[ALGORITHMS];

extern const char *const scalar_names[]; /* ended by NULL, like those below */
extern const char *const variant_names[];
extern const char *const library_names[];

/* Whether the options ask for this library (NULL: no): it is of the scalar and variant, and knows the robot.
 */
bool library_wanted(const struct library *library, const struct robot *r, const struct options *o);

/* Whether the library is rbd, and not another in its own conventions. */
bool library_is_ours(const struct library *library);

/* Computes samples first .. first + count - 1, as many a call as the library takes, and leaves the results of
   the last call in w->out. */
rbd_status algorithm_run(int algorithm, const struct instance *r, const struct worker *w,
                         const struct states *s, int first, int count);

/* The parts of its result: HYBRID and FREE_BASE a and tau; ID_DERIVATIVES d tau/dq and d tau/dv,
   ID_DERIVATIVES_MM M as well; FD_DERIVATIVES da/dq, da/dv and M^-1; CONSTRAINED a and lambda. Sets their
   sizes for one state, and returns how many there are. */
enum { MAX_PARTS = 3 };
int algorithm_parts(int algorithm, const struct robot *r, int size[MAX_PARTS]);

/* Numbers in all parts; the largest such number. */
int algorithm_results(int algorithm, const struct robot *r);
int algorithm_largest(const struct robot *r);

/* One line of the report: a robot, an algorithm, and how it is called. */
struct row {
    const struct instance *instance;
    int algorithm;
    int variant;
    int threads;              /* 1 but with THREADS */
    double max_error;         /* by verify */
    double quad_error;        /* by measure_accuracy; negative: unknown */
    double mean, stddev, min; /* by measure: over the experiments, ns per call */
    bool disturbed;           /* by measure: the least time has not come twice, and may be too large */
};

/* ---- timing/threads.c ---- */

/* Cores that threads can use; 1 if this build has no threads. */
int threads_available(void);

/* The loop that is timed: algorithm_run, or each thread its share of the samples. */
rbd_status row_run(const struct row *row, int first, int count);

/* The first sample, counted from 0, of thread t when threads share so many; thread t + 1's ends it. */
int thread_share(int count, int t, int threads);

/* ---- verify/verify.c ---- */

/* Compares the rows' results with the stored references, checks identities on their random states, with
   the gravity given, which stays set, and compares other scalars with double. Returns 0, or -1 after a
   message. */
int verify(struct row *rows, int n, const double gravity[3], int samples);

/* ---- verify/accuracy.c ---- */

/* Runs the row on samples first .. first + count - 1, at most width for each thread, and sets *error to the
   largest relative error of the results, the arbiter given the same input. */
rbd_status block_error(const struct row *row, const struct instance *arbiter, int first, int count,
                       double *error);

/* The largest number of samples for block_error. */
int block_length(const struct row *row);

/* Sets the rows' quad_error: unknown if samples is 0. Returns 0, or -1 after a message. */
int measure_accuracy(struct row *rows, int n, int samples);

/* ---- timing/measure.c ---- */

/* An experiment is timed in chunks of about so long, of whole batches: a busy system takes the processor away
   for milliseconds, after a few, and most chunks come through undisturbed where no whole experiment would. */
#define CHUNK_NS 2e5

/* Times all rows; experiments of a row never follow each other if there is another row. A row whose least
   time has not come twice is timed again, until it has or there were too many. Returns 0, or -1 after a
   message. */
int measure(struct row *rows, int n, int samples, int experiments);

/* Sets *ns to the time that the row's samples first .. first + count - 1 take. */
typedef rbd_status timer(const struct row *row, int first, int count, double *ns);

/* That of single calls, each after other data and code have filled the caches up to level 2
   (timing/cold.c). */
timer time_cold;

/* The same by another clock. */
int measure_by(struct row *rows, int n, int samples, int experiments, timer *time_of);

/* ---- report.c ---- */

#define TEXT(x) TEXT_OF(x)
#define TEXT_OF(x) #x

enum { NAME_SIZE = 64 };

/* "run-time", "lanes 8", "threads 2", "run-time pv" and so on; returns text. */
const char *row_variant(const struct row *row, char text[NAME_SIZE]);

/* Prints where something went wrong and what, to stderr. Returns -1. */
int row_error(const struct row *row, const char *format, ...);

/* Shows a line that the next one replaces, if stderr is a terminal; an empty one erases it. */
void progress(const char *format, ...);

/* Finds out, before the hours of measuring, whether the report can be written. Returns 0, or -1. */
int report_check_output(const char *output);

/* Writes rows to a file; returns 0, or -1 after a message. */
typedef int report_writer(FILE *f, const struct options *o, const struct row *rows, int n);

/* Times and errors, as table, CSV or JSON. */
report_writer report_times;

/* Has this writer write to the output that is asked for; a file is there wholly or not at all. Returns 0, or
   -1. */
int report_by(report_writer *write, const struct options *o, const struct row *rows, int n);

/* ---- counters/count.c ---- */

/* Counts the events of each row with the processor's counters, and writes them as CSV; without hardware
   counters, software ones alone and a message. */
report_writer count_by_perf;

/* Has callgrind, under which the program must run, dump the counts of each row: "KEY,SAMPLES" is the trigger.
 */
int count_by_callgrind(const struct row *rows, int n, int samples);

#endif
