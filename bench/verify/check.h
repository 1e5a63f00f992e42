/* check.h - one row under verification. SPDX-License-Identifier: MIT */
#ifndef BENCH_CHECK_H
#define BENCH_CHECK_H

#include "../bench.h"

struct check {
    const struct row *row;
    const struct robot *robot;
    const struct instance *instance; /* the robot in double */
    int algorithm;
    double max_error;
    char where[80];           /* the state that is being checked */
    double *M, *x, *y, *zero; /* nv x nv, nv, nv, nv zeros */
    double *packed;           /* nv x nv suffice */
    double *result, *other;   /* of any algorithm */
};

/* Bounds of relative errors. Forward dynamics loses digits as the condition number of the mass matrix
   grows: known for the reference states, taken as ten times their worst for the random states. */
double bound_for(int algorithm, double condition);

/* Whether the algorithm solves with the mass matrix. */
bool inverts(int algorithm);

/* Prints where the check failed and what; returns -1. */
int check_fail(const struct check *c, const char *what);

/* Takes the error of one comparison; fails if it is above the bound. */
int check_accept(struct check *c, const char *what, double error, double bound);

/* Runs an algorithm in double for the first of the states, and copies the result to out. */
int check_run(const struct check *c, int algorithm, struct states s, double *out);

/* The full mass matrix by the algorithm that is checked, else by CRBA. */
int check_run_matrix(const struct check *c, struct states s, double *M);

/* Largest difference over the largest expected entry. */
double relative_error(const double *x, const double *expected, int n);

/* ---- identities.c ---- */

/* The identities that tell of the algorithm, on one state; condition: of its mass matrix. */
int check_sample(struct check *c, struct states s, double condition);

/* The condition number to expect of random states: from the reference, or from some of them. */
double expected_condition(struct check *c, int samples);

#endif
