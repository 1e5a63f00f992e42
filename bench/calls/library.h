/* library.h - what a library must give to be verified and timed by rbd-bench: C and C++.
   SPDX-License-Identifier: MIT */
#ifndef BENCH_LIBRARY_H
#define BENCH_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>
#include "rbd.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    ID,
    MM,
    MM_PACKED,
    FD,
    FD_CHOLESKY,
    HYBRID,
    FREE_BASE,
    MINV,
    JACOBIAN,
    BODY_JACOBIAN,
    MOMENTUM_MATRIX,
    CORIOLIS,
    REGRESSOR,
    ID_DERIVATIVES,
    ID_DERIVATIVES_MM, /* the same with M asked for */
    FD_DERIVATIVES,
    CONSTRAINED, /* and those behind it: robots/contacts.h */
    CONSTRAINED_HAND,
    ALGORITHMS
};

/* How a library is called; a batch is BATCH states. THREADS is no library: it is LANES on several threads. */
enum {
    RUN_TIME,
    GENERATED,
    LANES,
    BLOCKS, /* this and GENERATED_BLOCKS: the lanes, on states that stand lane by lane */
    GENERATED_LANES,
    GENERATED_BLOCKS,
    THREADS,
    VARIANTS
};
enum { BATCH = 64 };

/* One call of an algorithm, for n states (1 to width) that stand one after the other, or lane by lane if the
   library has blocks. All arrays are of its scalar; x: the acceleration or the torque, as the table of
   algorithms says. A result of several parts (see algorithm_parts) stands part after part, each with room for
   width states. */
typedef rbd_status library_call(const void *model, void *work, int n, const void *q, const void *v,
                                const void *x, void *out);

/* The work of rbd's run-time variants and batches. */
struct rbd_memory {
    void *work;        /* rbd_work, rbd_batch */
    void *derivatives; /* rbd_derivatives, rbd_batch_derivatives */
    void
        *constraints[ALGORITHMS - CONSTRAINED]; /* rbd_constraint_set, rbd_batch_constraint_set; NULL: none */
};

/* A state in rbd's conventions, and in double. */
struct state {
    double *q, *v, *a, *tau;
};

/* The conventions of another library. All its arrays are of double. */
struct conventions {
    /* Lengths of its q and v. */
    void (*size)(const void *model, int *nq, int *nv);
    void (*state)(const void *model, const struct state *rbd, const struct state *its);
    /* The result of an algorithm as rbd would give it. */
    void (*result)(const void *model, int algorithm, const struct state *rbd, const double *its,
                   double *result);
    double bound;                  /* largest relative error of a result */
    const char *calls[ALGORITHMS]; /* what is timed, in a line */
    const char *build;             /* compiler and flags of what is timed */
};

/* A library, for one scalar and variant. */
struct library {
    const char *name; /* on the command line and in the report */
    const char *version;
    const char
        *form; /* of another library that has several rows: how this one is called or compiled; or NULL */
    const char *scalar;
    int variant, lanes; /* lanes: states in a SIMD instruction */
    bool blocks;        /* states and results stand lane by lane: number_place */
    const char *robot;  /* the name of the only one it knows; NULL: any */
    bool fixed_base;    /* it knows that one as --fixed-base makes it, and no other */
    int width;          /* states a call takes at most */
    size_t size;        /* bytes of a number in its arrays */
    double epsilon;     /* distance from 1 to the next number */
    /* The model of the bodies, in memory of this size, which is freed after model_free. Another status than
       RBD_OK: the library cannot have this robot, text (160 bytes) says why. */
    rbd_status (*model_build)(const rbd_body *bodies, int nb, void *memory, size_t size, const void **model,
                              char *text);
    size_t (*model_size)(const rbd_body *bodies, int nb);
    void (*model_free)(const void *model); /* NULL: nothing to do */
    rbd_status (*work_init)(const void *model, void *memory, size_t size, void **work);
    size_t (*work_size)(const void *model);
    void (*work_free)(void *work); /* NULL: nothing to do */
    rbd_status (*set_gravity)(void *work, const double gravity[3]);
    library_call *call[ALGORITHMS]; /* NULL: it lacks this algorithm */
    /* Whether it can compute the algorithm for this model; NULL: it can. */
    int (*can)(const void *model, int algorithm);
    const struct conventions *conventions; /* NULL: those of rbd */
    void (*from_double)(const double *x, size_t n, void *out);
    void (*to_double)(const void *x, size_t n, double *out);
    /* Largest difference / largest entry of the expected array (at least 1e-3), computed in the library's
       scalar; infinite if something is not finite. NULL: it is no judge of others. */
    double (*relative_error)(const double *x, const void *expected, int n);
};

#ifdef __cplusplus
}
#endif
#endif
