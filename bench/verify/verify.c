/* Verification of what is about to be timed, by the very calls that are timed.
   SPDX-License-Identifier: MIT */
#include "../bench.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How many of the random states the identities are checked on. */
enum { IDENTITY_SAMPLES = 1000 };

/* Bounds of relative errors. Forward dynamics loses digits as the condition number of the mass matrix
   grows: known for the reference states, taken as ten times their worst for the random states. */
static const double bound_plain = 1e-11;
static const double bound_per_condition = 1e-15;
static const double condition_margin = 10;

/* Another scalar or variant of rbd against the run-time model in double: 3.6e-5 for float, 6.7e-14 for
   double. The worst of 80000 states is 4e-6 for float. */
static const double bound_in_epsilons = 300;

struct check {
    const struct row *row;
    const struct robot *robot;
    const struct instance *instance; /* the robot in double */
    int algorithm;
    double max_error;
    char where[80];           /* the state that is being checked */
    double *M, *x, *y, *zero; /* nv x nv, nv, nv, nv */
    double *packed;           /* nv x nv suffice */
};

static double relative_error(const double *x, const double *expected, int n) {
    return libraries[DOUBLE]->relative_error(x, expected, n);
}

static int fail(const struct check *c, const char *what) {
    return row_error(c->row, "%s, %s", c->where, what);
}

/* Takes the error of one comparison; fails if it is above the bound. */
static int accept(struct check *c, const char *what, double error, double bound) {
    c->max_error = fmax(c->max_error, error);
    if (error <= bound) return 0;
    char text[160];
    snprintf(text, sizeof text, "%s: relative error %.2g, bound %.2g", what, error, bound);
    return fail(c, text);
}

static int run(const struct check *c, int algorithm, struct states s, double *out) {
    const struct worker *w = &c->instance->worker[0];
    rbd_status status = algorithm_run(algorithm, c->instance, w, &s, 0, 1);
    if (status != RBD_OK) return fail(c, rbd_status_string(status));
    if (out != w->out) memcpy(out, w->out, (size_t)algorithm_results(algorithm, c->robot) * sizeof *out);
    return 0;
}

static bool is_matrix(int algorithm) { return algorithm == MM || algorithm == MM_PACKED; }

static void unpack(const struct check *c, const double *H, double *M) {
    const int nv = c->robot->nv;
    for (int i = 0; i < nv; i++) {
        for (int j = 0; j <= i; j++) {
            const int k = rbd_packed_index(c->instance->model, i, j);
            M[i * nv + j] = M[j * nv + i] = k < 0 ? 0 : H[k];
        }
    }
}

/* The full mass matrix by the algorithm that is checked, else by CRBA. */
static int run_matrix(const struct check *c, struct states s, double *M) {
    if (c->algorithm != MM_PACKED) return run(c, MM, s, M);
    if (run(c, MM_PACKED, s, c->packed) != 0) return -1;
    unpack(c, c->packed, M);
    return 0;
}

static bool inverts(int algorithm) { return algorithm == FD || algorithm == FD_CHOLESKY; }

static double bound_for(int algorithm, double condition) {
    return inverts(algorithm) ? fmax(bound_plain, bound_per_condition * condition) : bound_plain;
}

/* ---- against the stored results ---- */

static int check_reference(struct check *c, const ref_state *state) {
    const int nv = c->robot->nv, algorithm = c->algorithm;
    const double *const expected = algorithm == ID        ? state->tau_rnea
                                   : is_matrix(algorithm) ? state->M
                                                          : state->qdd;
    const struct states s = {state->q, state->v, state->vdot, state->tau};
    robot_set_gravity(c->robot, state->gravity);
    if ((is_matrix(algorithm) ? run_matrix(c, s, c->M) : run(c, algorithm, s, c->M)) != 0) return -1;
    const double error = relative_error(c->M, expected, is_matrix(algorithm) ? nv * nv : nv);
    return accept(c, "against the reference", error, bound_for(algorithm, state->cond_M));
}

static int check_references(struct check *c, int samples) {
    (void)samples; /* random ones, not used here */
    const ref_model *reference = c->robot->reference;
    for (int i = 0; reference && i < reference->nstates; i++) {
        snprintf(c->where, sizeof c->where, "reference state %d", i);
        if (check_reference(c, &reference->states[i]) != 0) return -1;
    }
    return 0;
}

/* ---- identities ---- */

/* M a + c = tau of inverse dynamics, where c is inverse dynamics at a = 0. */
static int check_equation_of_motion(struct check *c, struct states s) {
    const int nv = c->robot->nv;
    const double *a = s.a;
    double *tau = c->y;
    const struct states at_rest = {s.q, s.v, c->zero, s.tau};
    if (run(c, ID, s, tau) != 0 || run(c, ID, at_rest, c->x) != 0 || run_matrix(c, s, c->M) != 0) return -1;
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) c->x[i] += c->M[i * nv + j] * a[j];
    return accept(c, "M a + c = tau", relative_error(c->x, tau, nv), bound_plain);
}

static int check_symmetry(struct check *c, struct states s) {
    const int nv = c->robot->nv;
    double *transposed = c->packed;
    if (run(c, MM, s, c->M) != 0) return -1;
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) transposed[i * nv + j] = c->M[j * nv + i];
    return accept(c, "M = transpose of M", relative_error(transposed, c->M, nv * nv), bound_plain);
}

/* Forward dynamics of the torque that inverse dynamics gives for a is a. */
static int check_round_trip(struct check *c, struct states s, double bound) {
    if (run(c, ID, s, c->x) != 0) return -1;
    const struct states given = {s.q, s.v, s.a, c->x};
    if (run(c, c->algorithm, given, c->y) != 0) return -1;
    return accept(c, "forward undoes inverse dynamics", relative_error(c->y, s.a, c->robot->nv), bound);
}

static int check_agreement(struct check *c, struct states s, double bound) {
    if (run(c, FD, s, c->x) != 0 || run(c, FD_CHOLESKY, s, c->y) != 0) return -1;
    return accept(c, "ABA agrees with Cholesky", relative_error(c->x, c->y, c->robot->nv), bound);
}

static int check_sample(struct check *c, struct states s, double condition) {
    const double bound = bound_for(c->algorithm, condition);
    if (inverts(c->algorithm)) return check_round_trip(c, s, bound) != 0 ? -1 : check_agreement(c, s, bound);
    if (c->algorithm == MM && check_symmetry(c, s) != 0) return -1;
    return check_equation_of_motion(c, s);
}

/* An upper bound of the condition number of M in random state k: trace M times trace M^-1, one at least. */
static double sample_condition(struct check *c, int k) {
    const int nv = c->robot->nv;
    double trace = 0, inverse = 0;
    const rbd_model *m = c->instance->model;
    rbd_work *w = c->instance->worker[0].work;
    instance_take_sample(c->instance, c->instance, k);
    if (rbd_crba(m, w, c->instance->input.q, c->M) != RBD_OK ||
        rbd_cholesky_factor(m, w, c->M, c->packed) != RBD_OK)
        return HUGE_VAL;
    for (int i = 0; i < nv; i++) {
        memset(c->x, 0, (size_t)nv * sizeof *c->x);
        c->x[i] = 1;
        rbd_cholesky_solve(m, w, c->packed, c->x, c->y);
        trace += c->M[i * nv + i];
        inverse += c->y[i];
    }
    return fmax(1, trace * inverse);
}

/* The condition number to expect of random states: from the reference, or from some of them. */
static double expected_condition(struct check *c, int samples) {
    const ref_model *reference = c->robot->reference;
    double worst = 1;
    for (int i = 0; reference && i < reference->nstates; i++)
        worst = fmax(worst, reference->states[i].cond_M);
    for (int k = 0; !reference && k < samples && k < 10; k++) worst = fmax(worst, sample_condition(c, k));
    return condition_margin * worst;
}

static int check_identities(struct check *c, int samples) {
    const double condition = expected_condition(c, samples);
    for (int k = 0; k < samples && k < IDENTITY_SAMPLES; k++) {
        snprintf(c->where, sizeof c->where, "random state %d", k);
        instance_take_sample(c->instance, c->instance, k);
        if (check_sample(c, c->instance->input, condition) != 0) return -1;
    }
    return 0;
}

/* ---- another scalar, variant or library against double ---- */

static int check_against_double(struct check *c, int samples) {
    const struct library *library = c->row->instance->library;
    double bound = library->conventions ? library->conventions->bound : bound_in_epsilons * library->epsilon;
    if (!c->robot->reference && inverts(c->algorithm)) /* a robot that nobody has looked at */
        bound = fmax(bound, library->epsilon * expected_condition(c, samples));
    const int end = samples < IDENTITY_SAMPLES ? samples : IDENTITY_SAMPLES, length = block_length(c->row);
    for (int k = 0; k < end; k += length) {
        double error = HUGE_VAL;
        const int count = end - k < length ? end - k : length;
        snprintf(c->where, sizeof c->where, "random states %d to %d", k, k + count - 1);
        rbd_status status = block_error(c->row, c->instance, k, count, &error);
        if (status != RBD_OK) return fail(c, rbd_status_string(status));
        if (accept(c, "against rbd's run-time model in double", error, bound) != 0) return -1;
    }
    return 0;
}

/* ---- together ---- */

static int verify_row(struct row *row, int check(struct check *c, int samples), int samples) {
    const struct robot *r = row->instance->robot;
    const size_t nv = (size_t)r->nv;
    struct check c = {.row = row,
                      .robot = r,
                      .instance = &r->instances[DOUBLE],
                      .algorithm = row->algorithm,
                      .max_error = row->max_error,
                      .where = "set-up"};
    c.M = calloc(2 * nv * nv + 3 * nv, sizeof *c.M);
    if (!c.M) return fail(&c, "not enough memory");
    c.packed = c.M + nv * nv;
    c.x = c.packed + nv * nv;
    c.y = c.x + nv;
    c.zero = c.y + nv;
    progress("verifying: %s, %s", r->title, algorithms[row->algorithm].title);
    int status = check(&c, samples);
    row->max_error = c.max_error;
    free(c.M);
    return status;
}

/* The row of the run-time model in double, which judges the row. */
static struct row judge(const struct row *row) {
    return (struct row){.instance = &row->instance->robot->instances[DOUBLE],
                        .algorithm = row->algorithm,
                        .variant = RUN_TIME,
                        .threads = 1};
}

/* Whether one of the rows before has the same judge. */
static bool judge_is_known(const struct row *rows, int i) {
    for (int k = 0; k < i; k++)
        if (rows[k].instance->robot == rows[i].instance->robot && rows[k].algorithm == rows[i].algorithm)
            return true;
    return false;
}

/* Checks the judges of the rows, and gives the rows that are judges themselves their errors. */
static int verify_judges(struct row *rows, int n, int check(struct check *c, int samples), int samples) {
    for (int i = 0; i < n; i++) {
        struct row r = judge(&rows[i]);
        if (judge_is_known(rows, i)) continue;
        if (verify_row(&r, check, samples) != 0) return -1;
        for (int k = i; k < n; k++)
            if (rows[k].instance == r.instance && rows[k].algorithm == r.algorithm)
                rows[k].max_error = fmax(rows[k].max_error, r.max_error);
    }
    return 0;
}

int verify(struct row *rows, int n, const double gravity[3], int samples) {
    /* An identity takes several algorithms: the references first, so that the right one is blamed. */
    if (verify_judges(rows, n, check_references, samples) != 0) return -1;
    for (int i = 0; i < n; i++) robot_set_gravity(rows[i].instance->robot, gravity);
    if (verify_judges(rows, n, check_identities, samples) != 0) return -1;
    for (int i = 0; i < n; i++)
        if (rows[i].instance->library != libraries[DOUBLE] &&
            verify_row(&rows[i], check_against_double, samples) != 0)
            return -1;
    return 0;
}
