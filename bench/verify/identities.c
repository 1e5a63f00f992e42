/* Identities that the results of random states must satisfy. SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>
#include "../../tests/larger.h"
#include "check.h"
#include "rbd_constraints.h"
#include "rbd_derivatives.h"

static const double condition_margin = 10;

/* Of a difference quotient: the step's square, and rounding divided by it. */
static const double bound_of_difference = 1e-7;

/* ---- condition numbers ---- */

/* An upper bound of the condition number of M in random state k: trace M times trace M^-1, one at least. */
static double sample_condition(struct check *c, int k) {
    const int nv = c->robot->nv;
    double trace = 0, inverse = 0;
    const rbd_model *m = c->instance->model;
    rbd_work *w = instance_work(c->instance);
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

double expected_condition(struct check *c, int samples) {
    const ref_model *reference = c->robot->reference;
    double worst = 1;
    for (int i = 0; reference && i < reference->nstates; i++)
        worst = larger(worst, reference->states[i].cond_M);
    for (int k = 0; !reference && k < samples && k < 10; k++) worst = larger(worst, sample_condition(c, k));
    return condition_margin * worst;
}

/* ---- dynamics ---- */

/* y = A x for a matrix of nv columns, with what was in y times scale added. */
static void multiply(const struct check *c, const double *A, int rows, const double *x, double *y,
                     double scale) {
    for (int i = 0; i < rows; i++) {
        y[i] *= scale;
        for (int j = 0; j < c->robot->nv; j++) y[i] += A[i * c->robot->nv + j] * x[j];
    }
}

/* M a + c = tau of inverse dynamics, where c is inverse dynamics at a = 0. */
static int check_equation_of_motion(struct check *c, struct states s) {
    const int nv = c->robot->nv;
    const struct states at_rest = {s.q, s.v, c->zero, s.tau};
    if (check_run(c, ID, s, c->y) != 0 || check_run(c, ID, at_rest, c->x) != 0 ||
        check_run_matrix(c, s, c->M) != 0)
        return -1;
    multiply(c, c->M, nv, s.a, c->x, 1);
    return check_accept(c, "M a + c = tau", relative_error(c->x, c->y, nv), bound_for(ID, 1));
}

static int check_symmetry(struct check *c, struct states s) {
    const int nv = c->robot->nv;
    double *transposed = c->packed;
    if (check_run(c, MM, s, c->M) != 0) return -1;
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) transposed[i * nv + j] = c->M[j * nv + i];
    return check_accept(c, "M = transpose of M", relative_error(transposed, c->M, nv * nv), bound_for(MM, 1));
}

static int check_matrix(struct check *c, struct states s, double bound) {
    (void)bound;
    if (c->algorithm == MM && check_symmetry(c, s) != 0) return -1;
    return check_equation_of_motion(c, s);
}

/* Forward dynamics of the torque that inverse dynamics gives for a is a. */
static int check_round_trip(struct check *c, struct states s, double bound) {
    if (check_run(c, ID, s, c->x) != 0) return -1;
    const struct states given = {s.q, s.v, s.a, c->x};
    if (check_run(c, c->algorithm, given, c->y) != 0) return -1;
    return check_accept(c, "forward undoes inverse dynamics", relative_error(c->y, s.a, c->robot->nv), bound);
}

static int check_forward(struct check *c, struct states s, double bound) {
    if (check_round_trip(c, s, bound) != 0 || check_run(c, FD, s, c->x) != 0 ||
        check_run(c, FD_CHOLESKY, s, c->y) != 0)
        return -1;
    return check_accept(c, "ABA agrees with Cholesky", relative_error(c->x, c->y, c->robot->nv), bound);
}

/* Inverse dynamics of the acceleration is the torque. */
static int check_hybrid(struct check *c, struct states s, double bound) {
    const int nv = c->robot->nv;
    if (check_run(c, c->algorithm, s, c->result) != 0) return -1;
    const struct states found = {s.q, s.v, c->result, s.tau};
    if (check_run(c, ID, found, c->x) != 0) return -1;
    return check_accept(c, "torque of the acceleration", relative_error(c->result + nv, c->x, nv), bound);
}

static int check_inverse(struct check *c, struct states s, double bound) {
    const int nv = c->robot->nv;
    if (check_run(c, MINV, s, c->result) != 0 || check_run(c, MM, s, c->M) != 0) return -1;
    for (int k = 0; k < nv; k++) { /* row k of M^-1 times M, which is its transpose */
        memset(c->y, 0, (size_t)nv * sizeof *c->y);
        memset(c->x, 0, (size_t)nv * sizeof *c->x);
        c->y[k] = 1;
        multiply(c, c->M, nv, c->result + k * nv, c->x, 0);
        if (check_accept(c, "M^-1 M = 1", relative_error(c->x, c->y, nv), bound) != 0) return -1;
    }
    return 0;
}

/* ---- kinematics and momentum: each matrix times v ---- */

static int kinematics(const struct check *c, struct states s) {
    rbd_status status = rbd_kinematics(c->instance->model, instance_work(c->instance), s.q, s.v, NULL);
    return status == RBD_OK ? 0 : check_fail(c, rbd_status_string(status));
}

/* The velocity of the last body, world axes. */
static void last_velocity(const struct check *c, double velocity[6]) {
    const rbd_model *m = c->instance->model;
    const rbd_work *w = instance_work(c->instance);
    const int body = c->robot->nb - 1;
    double R[9], p[3], local[6];
    rbd_body_pose(m, w, body, R, p);
    rbd_body_velocity(m, w, body, local);
    for (int i = 0; i < 6; i++) {
        const double *row = R + 3 * (i % 3), *x = local + i / 3 * 3;
        velocity[i] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2];
    }
}

static int check_jacobian(struct check *c, struct states s, double bound) {
    double expected[6], velocity[6] = {0};
    if (check_run(c, JACOBIAN, s, c->result) != 0 || kinematics(c, s) != 0) return -1;
    last_velocity(c, expected);
    multiply(c, c->result, 6, s.v, velocity, 0);
    return check_accept(c, "J v = velocity", relative_error(velocity, expected, 6), bound);
}

static int check_body_jacobian(struct check *c, struct states s, double bound) {
    const int n = 6 * c->robot->nv;
    if (check_run(c, BODY_JACOBIAN, s, c->result) != 0 || check_run(c, JACOBIAN, s, c->other) != 0 ||
        kinematics(c, s) != 0)
        return -1;
    rbd_body_pose(c->instance->model, instance_work(c->instance), c->robot->nb - 1, c->other + n,
                  c->other + n + 9);
    return check_accept(c, "J and pose are those of all kinematics",
                        relative_error(c->result, c->other, n + 12), bound);
}

static int check_momentum(struct check *c, struct states s, double bound) {
    double expected[6], h[6] = {0};
    if (check_run(c, MOMENTUM_MATRIX, s, c->result) != 0 || kinematics(c, s) != 0) return -1;
    rbd_momentum(c->instance->model, instance_work(c->instance), expected, NULL);
    multiply(c, c->result, 6, s.v, h, 0);
    return check_accept(c, "A v = momentum", relative_error(h, expected, 6), bound);
}

/* ---- what is linear in inverse dynamics ---- */

/* x = the velocity's part of inverse dynamics at a = 0: tau(q, v) - tau(q, 0). */
static int velocity_torque(struct check *c, struct states s) {
    const struct states moving = {s.q, s.v, c->zero, s.tau}, still = {s.q, c->zero, c->zero, s.tau};
    if (check_run(c, ID, moving, c->x) != 0 || check_run(c, ID, still, c->y) != 0) return -1;
    for (int i = 0; i < c->robot->nv; i++) c->x[i] -= c->y[i];
    return 0;
}

static int check_coriolis(struct check *c, struct states s, double bound) {
    if (velocity_torque(c, s) != 0 || check_run(c, CORIOLIS, s, c->result) != 0) return -1;
    multiply(c, c->result, c->robot->nv, s.v, c->y, 0);
    return check_accept(c, "C v = velocity's torque", relative_error(c->y, c->x, c->robot->nv), bound);
}

/* At a = 0, since the torque has that of the rotors, which are no parameters of the bodies. */
static int check_regressor(struct check *c, struct states s, double bound) {
    const int nv = c->robot->nv, columns = 10 * c->robot->nb;
    const struct states at_rest = {s.q, s.v, c->zero, s.tau};
    if (check_run(c, ID, at_rest, c->x) != 0 || check_run(c, REGRESSOR, at_rest, c->result) != 0) return -1;
    memset(c->y, 0, (size_t)nv * sizeof *c->y);
    for (int b = 0; b < c->robot->nb; b++) {
        double pi[10];
        rbd_body_parameters(c->instance->model, b, pi);
        for (int i = 0; i < nv; i++)
            for (int k = 0; k < 10; k++) c->y[i] += c->result[i * columns + 10 * b + k] * pi[k];
    }
    return check_accept(c, "Y pi = tau", relative_error(c->y, c->x, nv), bound);
}

/* ---- derivatives ---- */

/* Inverse dynamics is quadratic in v, so that d tau/dv v is twice the velocity's torque (Euler). */
static int check_id_dv(struct check *c, struct states s, double bound) {
    const int nv = c->robot->nv;
    if (velocity_torque(c, s) != 0 || check_run(c, c->algorithm, s, c->result) != 0) return -1;
    for (int i = 0; i < nv; i++) c->x[i] *= 2;
    multiply(c, c->result + nv * nv, nv, s.v, c->y, 0);
    return check_accept(c, "d tau/dv v = 2 velocity's torque", relative_error(c->y, c->x, nv), bound);
}

/* Along v: a difference quotient. */
static int check_id_dq(struct check *c, struct states s, double bound) {
    const int nv = c->robot->nv;
    const double step = 1e-5;
    double *q = c->other, *difference = c->x;
    (void)bound;
    for (int sign = -1; sign <= 1; sign += 2) {
        const struct states there = {q, s.v, s.a, s.tau};
        rbd_integrate(c->instance->model, s.q, s.v, sign * step, q);
        if (check_run(c, ID, there, sign < 0 ? c->x : c->y) != 0) return -1;
    }
    for (int i = 0; i < nv; i++) difference[i] = (c->y[i] - c->x[i]) / (2 * step);
    multiply(c, c->result, nv, s.v, c->y, 0);
    const double error = relative_error(c->y, difference, nv);
    return error <= bound_of_difference ? 0 : check_fail(c, "d tau/dq v against a difference");
}

static int check_id_derivatives(struct check *c, struct states s, double bound) {
    return check_id_dv(c, s, bound) != 0 ? -1 : check_id_dq(c, s, bound);
}

/* The same, and the mass matrix beside them is that of MM. */
static int check_id_derivatives_mm(struct check *c, struct states s, double bound) {
    const int n = c->robot->nv * c->robot->nv;
    if (check_id_derivatives(c, s, bound) != 0 || check_run(c, MM, s, c->M) != 0) return -1;
    return check_accept(c, "d tau/da = M", relative_error(c->result + 2 * n, c->M, n), bound);
}

/* M da = -d tau at the acceleration of forward dynamics. */
static int check_fd_derivatives(struct check *c, struct states s, double bound) {
    const int nv = c->robot->nv, n = nv * nv;
    if (check_run(c, FD, s, c->x) != 0) return -1;
    const struct states at = {s.q, s.v, c->x, s.tau};
    if (check_run(c, ID_DERIVATIVES, at, c->other) != 0 || check_run(c, FD_DERIVATIVES, s, c->result) != 0 ||
        check_run(c, MM, s, c->M) != 0)
        return -1;
    for (int part = 0; part < 2; part++) {
        double *sum = c->packed; /* -M da */
        for (int i = 0; i < n; i++) {
            sum[i] = 0;
            for (int k = 0; k < nv; k++)
                sum[i] -= c->M[i / nv * nv + k] * c->result[part * n + k * nv + i % nv];
        }
        if (check_accept(c, "M da = -d tau", relative_error(sum, c->other + part * n, n), bound) != 0)
            return -1;
    }
    return 0;
}

/* ---- constraints ---- */

/* Sums that should vanish, against the largest sum of their terms' magnitudes. */
struct vanishing {
    double sum, largest;
};

static void take_sum(struct vanishing *x, double first, const double *a, int stride, const double *b, int n) {
    double sum = first, terms = fabs(first);
    for (int k = 0; k < n; k++) {
        sum += a[k * stride] * b[k];
        terms += fabs(a[k * stride] * b[k]);
    }
    x->sum = larger(x->sum, fabs(sum));
    x->largest = larger(x->largest, terms);
}

/* J a + gamma = 0, and tau + J' lambda = M a + c, which inverse dynamics gives. */
static int check_constrained(struct check *c, struct states s, double bound) {
    enum { MOST_ROWS = 24 };
    const struct rbd_memory *memory = c->instance->worker[0].work;
    rbd_constraint_set *set = memory->constraints[c->algorithm - CONSTRAINED];
    const int nv = c->robot->nv, rows = rbd_constraint_rows(set);
    const double *tau = s.tau;
    double gamma[MOST_ROWS], *const a = c->result, *const lambda = a + nv, *const J = c->other;
    struct vanishing motion = {0, 1e-3}, force = {0, 1e-3};
    if (rows > MOST_ROWS || check_run(c, c->algorithm, s, a) != 0) return -1;
    const struct states found = {s.q, s.v, a, s.tau};
    if (check_run(c, ID, found, c->x) != 0) return -1;
    const rbd_status status = rbd_constraint_jacobian(c->instance->model, set, s.q, s.v, J, gamma, NULL);
    if (status != RBD_OK) return check_fail(c, rbd_status_string(status));
    for (int k = 0; k < rows; k++) take_sum(&motion, gamma[k], J + k * nv, 1, a, nv);
    for (int j = 0; j < nv; j++) take_sum(&force, tau[j] - c->x[j], J + j, nv, lambda, rows);
    if (check_accept(c, "J a + gamma = 0", motion.sum / motion.largest, bound) != 0) return -1;
    return check_accept(c, "tau + J' lambda = M a + c", force.sum / force.largest, bound);
}

/* ---- together ---- */

int check_sample(struct check *c, struct states s, double condition) {
    static int (*const checks[ALGORITHMS])(struct check *c, struct states s, double bound) = {
        [ID] = check_matrix,
        [MM] = check_matrix,
        [MM_PACKED] = check_matrix,
        [FD] = check_forward,
        [FD_CHOLESKY] = check_forward,
        [HYBRID] = check_hybrid,
        [FREE_BASE] = check_hybrid,
        [MINV] = check_inverse,
        [JACOBIAN] = check_jacobian,
        [BODY_JACOBIAN] = check_body_jacobian,
        [MOMENTUM_MATRIX] = check_momentum,
        [CORIOLIS] = check_coriolis,
        [REGRESSOR] = check_regressor,
        [ID_DERIVATIVES] = check_id_derivatives,
        [ID_DERIVATIVES_MM] = check_id_derivatives_mm,
        [FD_DERIVATIVES] = check_fd_derivatives,
        [CONSTRAINED] = check_constrained,
        [CONSTRAINED_HAND] = check_constrained,
    };
    return checks[c->algorithm](c, s, bound_for(c->algorithm, condition));
}
