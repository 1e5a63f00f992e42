/* Verification of what is about to be timed, by the very calls that are timed.
   SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../tests/larger.h"
#include "check.h"

/* How many of the random states the identities are checked on. */
enum { IDENTITY_SAMPLES = 1000 };

static const double bound_plain = 1e-11;
static const double bound_per_condition = 1e-15;

/* Another scalar or variant of rbd against the run-time model in double: 3.6e-5 for float, 6.7e-14 for
   double. The worst of 80000 states is 4e-6 for float. Derivatives of forward dynamics: 1000; 2.8e-5 of 1000
   states. */
static double bound_in_epsilons(int algorithm) { return algorithm == FD_DERIVATIVES ? 1000 : 300; }

double relative_error(const double *x, const double *expected, int n) {
    return libraries[DOUBLE]->relative_error(x, expected, n);
}

int check_fail(const struct check *c, const char *what) {
    return row_error(c->row, "%s, %s", c->where, what);
}

int check_accept(struct check *c, const char *what, double error, double bound) {
    c->max_error = larger(c->max_error, error);
    if (error <= bound) return 0;
    char text[160];
    snprintf(text, sizeof text, "%s: relative error %.2g, bound %.2g", what, error, bound);
    return check_fail(c, text);
}

int check_run(const struct check *c, int algorithm, struct states s, double *out) {
    const struct worker *w = &c->instance->worker[0];
    rbd_status status = algorithm_run(algorithm, c->instance, w, &s, 0, 1);
    if (status != RBD_OK) return check_fail(c, rbd_status_string(status));
    if (out != w->out) memcpy(out, w->out, (size_t)algorithm_results(algorithm, c->robot) * sizeof *out);
    return 0;
}

static void unpack(const struct check *c, const double *H, double *M) {
    const int nv = c->robot->nv;
    for (int i = 0; i < nv; i++) {
        for (int j = 0; j <= i; j++) {
            const int k = rbd_packed_index(c->instance->model, i, j);
            M[i * nv + j] = M[j * nv + i] = k < 0 ? 0 : H[k];
        }
    }
}

int check_run_matrix(const struct check *c, struct states s, double *M) {
    if (c->algorithm != MM_PACKED) return check_run(c, MM, s, M);
    if (check_run(c, MM_PACKED, s, c->packed) != 0) return -1;
    unpack(c, c->packed, M);
    return 0;
}

bool inverts(int algorithm) {
    return algorithm == FD || algorithm == FD_CHOLESKY || algorithm == HYBRID || algorithm == FREE_BASE ||
           algorithm == MINV || algorithm == FD_DERIVATIVES || algorithm >= CONSTRAINED;
}

double bound_for(int algorithm, double condition) {
    return inverts(algorithm) ? fmax(bound_plain, bound_per_condition * condition) : bound_plain;
}

/* ---- against the stored results ---- */

enum { PARTS = 3 };

/* A stored array of n numbers; n = 0: none. */
struct part {
    const double *expected;
    int n;
};

/* The stored result of an algorithm, part after part; for a packed matrix the full one. */
static void stored(const struct check *c, const ref_state *s, struct part part[PARTS]) {
    const int nv = c->robot->nv, n = nv * nv, last = c->robot->nb - 1;
    const struct part parts[ALGORITHMS][PARTS] = {
        [ID] = {{s->tau_rnea, nv}},
        [MM] = {{s->M, n}},
        [MM_PACKED] = {{s->M, n}},
        [FD] = {{s->qdd, nv}},
        [FD_CHOLESKY] = {{s->qdd, nv}},
        [MINV] = {{s->Minv, n}},
        [JACOBIAN] = {{s->J_world, s->jac_body == last ? 6 * nv : 0}},
        [BODY_JACOBIAN] = {{s->J_world, s->jac_body == last ? 6 * nv : 0}},
        [MOMENTUM_MATRIX] = {{s->A_h, 6 * nv}},
        [REGRESSOR] = {{s->Y, nv * 10 * c->robot->nb}},
        [ID_DERIVATIVES] = {{s->dtau_dq, n}, {s->dtau_dv, n}},
        [ID_DERIVATIVES_MM] = {{s->dtau_dq, n}, {s->dtau_dv, n}, {s->M, n}},
        [FD_DERIVATIVES] = {{s->dqdd_dq, n}, {s->dqdd_dv, n}, {s->Minv, n}},
    };
    memcpy(part, parts[c->algorithm], sizeof parts[c->algorithm]);
}

static int check_reference(struct check *c, const ref_state *state) {
    const struct states s = {state->q, state->v, state->vdot, state->tau};
    const double *x = c->algorithm == MM_PACKED ? c->M : c->result;
    struct part part[PARTS];
    stored(c, state, part);
    if (part[0].n == 0) return 0;
    robot_set_gravity(c->robot, state->gravity);
    if ((c->algorithm == MM_PACKED ? check_run_matrix(c, s, c->M)
                                   : check_run(c, c->algorithm, s, c->result)) != 0)
        return -1;
    for (int i = 0; i < PARTS; x += part[i++].n)
        if (part[i].n > 0 &&
            check_accept(c, "against the reference", relative_error(x, part[i].expected, part[i].n),
                         bound_for(c->algorithm, state->cond_M)) != 0)
            return -1;
    return 0;
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
    double bound = library->conventions ? library->conventions->bound
                                        : bound_in_epsilons(c->algorithm) * library->epsilon;
    if (!c->robot->reference && inverts(c->algorithm)) /* a robot that nobody has looked at */
        bound = fmax(bound, library->epsilon * expected_condition(c, samples));
    const int end = samples < IDENTITY_SAMPLES ? samples : IDENTITY_SAMPLES, length = block_length(c->row);
    for (int k = 0; k < end; k += length) {
        double error = HUGE_VAL;
        const int count = end - k < length ? end - k : length;
        snprintf(c->where, sizeof c->where, "random states %d to %d", k, k + count - 1);
        rbd_status status = block_error(c->row, c->instance, k, count, &error);
        if (status != RBD_OK) return check_fail(c, rbd_status_string(status));
        if (check_accept(c, "against rbd's run-time model in double", error, bound) != 0) return -1;
    }
    return 0;
}

/* ---- together ---- */

static int verify_row(struct row *row, int check(struct check *c, int samples), int samples) {
    const struct robot *r = row->instance->robot;
    const size_t nv = (size_t)r->nv, largest = (size_t)algorithm_largest(r);
    struct check c = {.row = row,
                      .robot = r,
                      .instance = &r->instances[DOUBLE],
                      .algorithm = row->algorithm,
                      .max_error = row->max_error,
                      .where = "set-up"};
    c.M = calloc(2 * nv * nv + 3 * nv + 2 * largest, sizeof *c.M);
    if (!c.M) return check_fail(&c, "not enough memory");
    c.packed = c.M + nv * nv;
    c.x = c.packed + nv * nv;
    c.y = c.x + nv;
    c.zero = c.y + nv;
    c.result = c.zero + nv;
    c.other = c.result + largest;
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
                rows[k].max_error = larger(rows[k].max_error, r.max_error);
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
