/* Verification of what is about to be timed, by the very calls that are timed.
   SPDX-License-Identifier: MIT */
#include "bench.h"
#include <math.h>
#include <stdlib.h>

/* How many of the random states the identities are checked on. */
enum { IDENTITY_SAMPLES = 1000 };

/* Bounds of relative errors. Forward dynamics loses digits as the condition number of the mass matrix
   grows: known for the reference states, taken as ten times their worst for the random states. */
static const double bound_plain = 1e-11;
static const double bound_per_condition = 1e-15;
static const double condition_margin = 10;

struct check {
    const struct robot *robot;
    int algorithm;
    double max_error;
    char where[80];           /* the state that is being checked */
    double *M, *x, *y, *zero; /* nv x nv, nv, nv, nv */
};

/* Largest difference / largest entry of the expected array (at least 1e-3); infinite if not a number. */
static double relative_error(const double *x, const double *expected, int n) {
    double difference = 0, largest = 1e-3;
    for (int i = 0; i < n; i++) {
        if (!isfinite(x[i]) || !isfinite(expected[i]))
            return HUGE_VAL;
        difference = fmax(difference, fabs(x[i] - expected[i]));
        largest = fmax(largest, fabs(expected[i]));
    }
    return difference / largest;
}

static int fail(const struct check *c, const char *what) {
    progress("");
    fprintf(stderr, "rbd-bench: %s, %s: %s, %s\n", c->robot->title, algorithms[c->algorithm].title, c->where,
            what);
    return -1;
}

/* Takes the error of one comparison; fails if it is above the bound. */
static int accept(struct check *c, const char *what, double error, double bound) {
    c->max_error = fmax(c->max_error, error);
    if (error <= bound)
        return 0;
    char text[160];
    snprintf(text, sizeof text, "%s: relative error %.2g, bound %.2g", what, error, bound);
    return fail(c, text);
}

static int run(const struct check *c, int algorithm, struct states s, double *out) {
    rbd_status status = algorithms[algorithm].run(c->robot, &s, 0, 1, out);
    return status == RBD_OK ? 0 : fail(c, rbd_status_string(status));
}

static bool inverts(int algorithm) {
    return algorithm == FD || algorithm == FD_CHOLESKY;
}

static double bound_for(int algorithm, double condition) {
    return inverts(algorithm) ? fmax(bound_plain, bound_per_condition * condition) : bound_plain;
}

/* ---- against the stored results ---- */

static int check_reference(struct check *c, const ref_state *state) {
    const int nv = c->robot->nv;
    const double *const expected[ALGORITHMS] = {
        [ID] = state->tau_rnea, [MM] = state->M, [FD] = state->qdd, [FD_CHOLESKY] = state->qdd};
    const struct states s = {state->q, state->v, state->vdot, state->tau};
    rbd_set_gravity(c->robot->work, state->gravity);
    if (run(c, c->algorithm, s, c->robot->out) != 0)
        return -1;
    double error = relative_error(c->robot->out, expected[c->algorithm], c->algorithm == MM ? nv * nv : nv);
    return accept(c, "against the reference", error, bound_for(c->algorithm, state->cond_M));
}

static int check_references(struct check *c, int samples) {
    (void)samples; /* random ones, not used here */
    const ref_model *reference = c->robot->reference;
    for (int i = 0; i < reference->nstates; i++) {
        snprintf(c->where, sizeof c->where, "reference state %d", i);
        if (check_reference(c, &reference->states[i]) != 0)
            return -1;
    }
    return 0;
}

/* ---- identities ---- */

/* M a + c = tau of inverse dynamics, where c is inverse dynamics at a = 0. */
static int check_equation_of_motion(struct check *c, struct states s) {
    const int nv = c->robot->nv;
    double *tau = c->robot->out;
    const struct states at_rest = {s.q, s.v, c->zero, s.tau};
    if (run(c, ID, s, tau) != 0 || run(c, ID, at_rest, c->x) != 0 || run(c, MM, s, c->M) != 0)
        return -1;
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++)
            c->x[i] += c->M[i * nv + j] * s.a[j];
    return accept(c, "M a + c = tau", relative_error(c->x, tau, nv), bound_plain);
}

static int check_symmetry(struct check *c, struct states s) {
    const int nv = c->robot->nv;
    double *transposed = c->robot->out;
    if (run(c, MM, s, c->M) != 0)
        return -1;
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++)
            transposed[i * nv + j] = c->M[j * nv + i];
    return accept(c, "M = transpose of M", relative_error(transposed, c->M, nv * nv), bound_plain);
}

/* Forward dynamics of the torque that inverse dynamics gives for a is a. */
static int check_round_trip(struct check *c, struct states s, double bound) {
    if (run(c, ID, s, c->x) != 0)
        return -1;
    const struct states given = {s.q, s.v, s.a, c->x};
    if (run(c, c->algorithm, given, c->y) != 0)
        return -1;
    return accept(c, "forward undoes inverse dynamics", relative_error(c->y, s.a, c->robot->nv), bound);
}

static int check_agreement(struct check *c, struct states s, double bound) {
    if (run(c, FD, s, c->x) != 0 || run(c, FD_CHOLESKY, s, c->y) != 0)
        return -1;
    return accept(c, "ABA agrees with Cholesky", relative_error(c->x, c->y, c->robot->nv), bound);
}

static int check_sample(struct check *c, struct states s, double condition) {
    const double bound = bound_for(c->algorithm, condition);
    if (inverts(c->algorithm))
        return check_round_trip(c, s, bound) != 0 ? -1 : check_agreement(c, s, bound);
    if (c->algorithm == MM && check_symmetry(c, s) != 0)
        return -1;
    return check_equation_of_motion(c, s);
}

/* The condition number to expect of random states. */
static double expected_condition(const ref_model *reference) {
    double worst = 1;
    for (int i = 0; i < reference->nstates; i++)
        worst = fmax(worst, reference->states[i].cond_M);
    return condition_margin * worst;
}

static int check_identities(struct check *c, int samples) {
    const struct robot *r = c->robot;
    const size_t nq = (size_t)r->nq, nv = (size_t)r->nv;
    const size_t n = (size_t)(samples < IDENTITY_SAMPLES ? samples : IDENTITY_SAMPLES);
    const double condition = expected_condition(r->reference);
    const struct states all = r->states;
    for (size_t k = 0; k < n; k++) {
        const struct states s = {all.q + k * nq, all.v + k * nv, all.a + k * nv, all.tau + k * nv};
        snprintf(c->where, sizeof c->where, "random state %d", (int)k);
        if (check_sample(c, s, condition) != 0)
            return -1;
    }
    return 0;
}

/* ---- together ---- */

static int verify_row(struct row *row, int check(struct check *c, int samples), int samples) {
    const size_t nv = (size_t)row->robot->nv;
    struct check c = {
        .robot = row->robot, .algorithm = row->algorithm, .max_error = row->max_error, .where = "set-up"};
    c.M = calloc(nv * nv + 3 * nv, sizeof *c.M);
    if (!c.M)
        return fail(&c, "not enough memory");
    c.x = c.M + nv * nv;
    c.y = c.x + nv;
    c.zero = c.y + nv;
    progress("verifying: %s, %s", row->robot->title, algorithms[row->algorithm].title);
    int status = check(&c, samples);
    row->max_error = c.max_error;
    free(c.M);
    return status;
}

int verify(struct row *rows, int n, const double gravity[3], int samples) {
    /* An identity takes several algorithms: the references first, so that the right one is blamed. */
    for (int i = 0; i < n; i++)
        if (verify_row(&rows[i], check_references, samples) != 0)
            return -1;
    for (int i = 0; i < n; i++) {
        rbd_set_gravity(rows[i].robot->work, gravity);
        if (verify_row(&rows[i], check_identities, samples) != 0)
            return -1;
    }
    return 0;
}
