/* constraints.c - the fuzzer of rbd_constraints.h: random problems (problems.c) against dense matrices in
   long double (dense.c). It prints the worst error of each quantity in each class; docs/accuracy_tables.md
   says what is measured.
       constraints [--seconds N | --problems N]   for so long, or so many problems of all classes together;
       10000
                   [--from N]                     begins with problem N of each class
                   [--class NAME]                 of this class only
                   [--publish]                    prints the rows of docs/accuracy_tables.md
                   [--hold FILE]                  fails if an error exceeds that of the document's table
       constraints --one CLASS NUMBER             shows one problem, as C source, and its errors */
#include "rbd_derivatives.h"

#include "rbd_constraints.h"
#include "rbd_batch.h"

#include "../larger.h"
#include "dense.h"
#include "problems.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- what is measured ---- */

enum {
    JACOBIAN,
    GAMMA,
    ERROR,
    EQUATION,
    ROWS,
    ROWS_UNCLEAR,
    ACCELERATION,
    LAMBDA,
    ORDER,
    ORDER_UNCLEAR,
    BATCH,
    IMPACT_EQUATION,
    IMPACT_ROWS,
    V_PLUS,
    IMPULSE,
    ID_EQUATION,
    ID_LAMBDA,
    DA,
    DLAMBDA,
    CLOSED,
    CLOSED_V,
    NEAREST_V,
    NEAREST_Q,
    QUANTITIES
};

/* Where an error above the bound is a failure, whatever docs/accuracy_tables.md says. */
static const struct quantity {
    const char *name;
    double bound;
} quantities[QUANTITIES] = {{"J", 1e-13},
                            {"gamma", 1e-13},
                            {"e", 1e-13},
                            {"equation of motion", 1e-9},
                            {"rows", 1e-9},
                            {"rows, rank unclear", 1e-5},
                            {"a / condition", 1e-13},
                            {"lambda / condition", 1e-13},
                            {"order / condition", 1e-13},
                            {"order, rank unclear", 1e-9},
                            {"batch / condition", 1e-13},
                            {"impact: equation", 1e-9},
                            {"impact: rows", 1e-9},
                            {"v_plus / condition", 1e-13},
                            {"impulse / condition", 1e-13},
                            {"constrained_id: equation", 1e-9},
                            {"constrained_id: lambda / condition", 1e-13},
                            {"da / condition", 1e-11},
                            {"dlambda / condition", 1e-11},
                            {"assemble: e", 1e-8},
                            {"assemble: J v", 1e-9},
                            {"assemble: v / condition", 1e-11},
                            {"assemble: q", 1e-5}};

/* Failures that are no matter of size. */
enum {
    NOT_BUILT = QUANTITIES,
    NOT_FINITE,
    SINGULAR,        /* RBD_ERR_SINGULAR or _NAN, M being regular */
    REFUSED,         /* RBD_ERR_INFEASIBLE, the rows being consistent */
    REFUSED_IMPACT,  /* the same of an impact, which is never infeasible */
    REFUSED_CLOSING, /* of rbd_assemble, close to a solution */
    NOT_REFUSED,     /* RBD_OK, rows contradicting each other */
    WRONG_RANK,      /* where it is clear */
    WRONG_ROW,       /* rbd_infeasible_row names one that depends on no others */
    ORDER_DECIDES,   /* rank or status, where they are clear, by the order of the constraints */
    NOT_REPEATED,    /* the same call gives other bits */
    OTHER_STATUS,
    KINDS
};
static const char *const kind_names[KINDS - QUANTITIES] = {"not built",
                                                           "not finite",
                                                           "singular without reason",
                                                           "infeasible without reason",
                                                           "impact: infeasible",
                                                           "assemble: infeasible",
                                                           "not refused",
                                                           "rank",
                                                           "rbd_infeasible_row",
                                                           "order decides",
                                                           "not repeated",
                                                           "status"};

static const char *name_of(int kind) {
    return kind < QUANTITIES ? quantities[kind].name : kind_names[kind - QUANTITIES];
}

typedef struct worst {
    double error;
    int number;
} worst;
static worst worst_of[PROBLEM_CLASSES][QUANTITIES];
static double current[QUANTITIES];
static long failed[PROBLEM_CLASSES][KINDS], failures, done[PROBLEM_CLASSES];
static long of_class[PROBLEM_CLASSES], of_quantity[QUANTITIES]; /* comparisons */
static int class_number, problem_number, shown = 3;

enum { CLEAR, UNCLEAR, INFEASIBLE, DERIVATIVES, ASSEMBLED, NEAR_SINGULAR, COUNTS };
static const char *const count_names[COUNTS] = {"rank clear",  "rank unclear", "infeasible",
                                                "derivatives", "assembled",    "M near singular"};
static long counts[PROBLEM_CLASSES][COUNTS];

static void fail(int kind, double value) {
    failures++;
    if (failed[class_number][kind]++ < shown)
        printf("FAIL %s (%.2g): --one %s %d\n", name_of(kind), value, problem_names[class_number],
               problem_number);
}

static void record(int quantity, quad value) {
    const double error = value >= 0 ? (double)value : HUGE_VAL; /* not a number */
    worst *w = &worst_of[class_number][quantity];
    of_class[class_number]++;
    of_quantity[quantity]++;
    current[quantity] = larger(current[quantity], error);
    if (error > w->error) *w = (worst){error, problem_number};
    if (!(error <= quantities[quantity].bound)) fail(quantity, error);
}

static quad magnitude(quad x) { return x < 0 ? -x : x; }

/* Relative to the size of what was added; where nothing was, the result must be exactly so. */
static quad relative(quad error, quad size) { return error <= 0 && error >= 0 ? 0 : magnitude(error) / size; }

/* ---- a problem in the library ---- */

static problem now;
static int nv, nq, rows;
static const rbd_model *model;
static rbd_work *work;
static rbd_derivatives *derivatives;
static void *model_memory, *work_memory, *derivatives_memory;
static const double *f_ext; /* or NULL */

typedef struct set {
    rbd_constraint_set *c;
    void *memory;
} set;

/* Exactly as much memory as the library asks for, filled with what is not a number. */
static void *memory_of(size_t size) { return memset(malloc(size), 0xff, size); }

static int build_set(const rbd_constraint *list, set *s) {
    const size_t size = rbd_constraint_set_size(model, list, now.n);
    s->memory = memory_of(size);
    return rbd_constraint_set_init(model, work, list, now.n, s->memory, size, &s->c, NULL) == RBD_OK;
}

static int build(void) {
    const rbd_body *bodies = now.robot.bodies;
    const size_t size = rbd_model_size(bodies, now.robot.nb);
    model_memory = memory_of(size);
    if (rbd_model_build(bodies, now.robot.nb, model_memory, size, &model, NULL)) return 0;
    work_memory = memory_of(rbd_work_size(model));
    if (rbd_work_init(model, work_memory, rbd_work_size(model), &work)) return 0;
    derivatives_memory = memory_of(rbd_derivatives_size(model));
    if (rbd_derivatives_init(model, work, derivatives_memory, rbd_derivatives_size(model), &derivatives))
        return 0;
    rbd_set_gravity(work, now.state.gravity);
    return rbd_nv(model) == now.robot.nv && rbd_nq(model) == now.robot.nq;
}

static void release(void) {
    free(model_memory);
    free(work_memory);
    free(derivatives_memory);
    model_memory = work_memory = derivatives_memory = NULL;
}

static int finite(const double *x, int n) {
    for (int i = 0; i < n; i++)
        if (!isfinite(x[i])) {
            fail(NOT_FINITE, x[i]);
            return 0;
        }
    return 1;
}

/* ---- the truth ---- */

static world truth;
static dense_rows J;
static dense exact;
static quad q[WORLD_COORDINATES], v[WORLD_DOFS], tau[WORLD_DOFS], wrench[6 * WORLD_BODIES], gravity[3];
static quad M[WORLD_DOFS * WORLD_DOFS], M_size[WORLD_DOFS], bias[WORLD_DOFS], bias_size[WORLD_DOFS];
static int clear_rank, rank, regular; /* of J M^-1 J', and whether M is */

static void widen(const double *x, int n, quad *y) {
    for (int i = 0; i < n; i++) y[i] = x[i];
}

static void find_truth(void) {
    const sample_state *x = &now.state;
    widen(x->q, nq, q);
    widen(x->v, nv, v);
    widen(x->tau, nv, tau);
    widen(x->f_ext, 6 * now.robot.nb, wrench);
    widen(x->gravity, 3, gravity);
    world_move(&truth, now.robot.bodies, now.robot.nb, q, v, NULL);
    world_torques(&truth, gravity, NULL, f_ext ? wrench : NULL, bias, bias_size);
    world_mass_matrix(&truth, M, M_size);
    dense_rows_of(&truth, now.list, now.n, v, &J);
    regular = dense_factor(&exact, &J, M, M_size, nv, 1) && exact.distance > (quad)1e-9L;
    rank = dense_rank(&exact, 1e-4);
    clear_rank = regular && rank == dense_rank(&exact, 1e-12) && exact.least_share > (quad)1e-4L;
}

/* Takes from v what the constraints do not allow; and gains of position from constraints that are half a
   turn off: either sign of that is right. */
static void adapt_problem(void) {
    find_truth();
    for (int i = 0, row = 0; i < now.n; i++)
        for (int j = 0; j < 6; j++) {
            if (!now.list[i].axes[j]) continue;
            if (J.e_size[row++] > (quad)DBL_MAX) now.list[i].kp = 0;
        }
    if (now.motion != HELD || !clear_rank) return;
    quad b[DENSE_ROWS] = {0}, x[WORLD_DOFS], lambda[DENSE_ROWS], rest[DENSE_ROWS];
    dense_solve(&exact, &J, rank, v, b, x, lambda, rest);
    for (int k = 0; k < nv; k++) now.state.v[k] = (double)x[k];
}

/* The equations that an answer must meet: M (x - x0) = J' lambda, J x = b. */
typedef struct question {
    quad x0[WORLD_DOFS], b[DENSE_ROWS], b_size[DENSE_ROWS];
    quad x[WORLD_DOFS], lambda[DENSE_ROWS];
    quad size, condition; /* what errors of x and lambda, in the norm of M, are measured by */
    int feasible;         /* 1, -1, or 0 where that is for rounding to say */
} question;

/* Residual of dependent rows over the sum of their terms: rounding below the first, a contradiction above the
   second. */
static const quad consistent = 1e-11L, contradictory = 1e-3L;

/* Where nothing is asked for, the rows agree whatever their rank. */
static void answer_question(question *k, quad x0_size) {
    quad rest[DENSE_ROWS], y[WORLD_DOFS], b_size = 0;
    double most = 0;
    int nothing = 1;
    dense_solve(&exact, &J, rank, k->x0, k->b, k->x, k->lambda, rest);
    k->size = x0_size;
    for (int i = 0; i < nv; i++) y[i] = k->x[i] - k->x0[i];
    k->size += dense_norm(&exact, y);
    for (int i = 0; i < rows; i++) {
        const quad size = k->b_size[i] + exact.scale[i] * k->size;
        b_size += k->b_size[i] / exact.scale[i];
        nothing &= k->b[i] <= 0 && k->b[i] >= 0;
        most = larger(most, (double)relative(rest[i] * exact.scale[i], size));
    }
    k->size += b_size;
    const quad least = (rank > 0 ? exact.sigma[rank - 1] : 1) * exact.least_share;
    k->condition = 1 / (exact.distance * least * least);
    k->feasible = nothing;
    if (clear_rank && most < consistent && k->condition < (quad)1e12L) k->feasible = 1;
    if (clear_rank && !nothing && most > contradictory) k->feasible = -1;
}

static void ask_dynamics(question *k) {
    quad f[WORLD_DOFS], size = 0;
    for (int i = 0; i < nv; i++) {
        f[i] = tau[i] - bias[i];
        const quad s = magnitude(tau[i]) + bias_size[i];
        size += s * s * exact.inverse[i];
    }
    dense_inverse(&exact, f, k->x0);
    for (int i = 0; i < rows; i++) {
        k->b[i] = -J.gamma[i] - J.kd[i] * J.Jv[i] - J.kp[i] * J.e[i];
        k->b_size[i] = J.gamma_size[i] + J.kd[i] * J.Jv_size[i] + (J.kp[i] > 0 ? J.kp[i] * J.e_size[i] : 0);
    }
    answer_question(k, world_sqrt(size));
}

static void ask_impact(question *k, double restitution) {
    memcpy(k->x0, v, sizeof k->x0);
    for (int i = 0; i < rows; i++) {
        k->b[i] = -(quad)restitution * J.Jv[i];
        k->b_size[i] = magnitude(k->b[i]);
    }
    answer_question(k, dense_norm(&exact, v));
    k->feasible = 1;
}

/* ---- checks of an answer ---- */

typedef struct answer {
    rbd_status status;
    int rank;
    double x[WORLD_DOFS], lambda[DENSE_ROWS];
} answer;

/* Of the levers that make a term, beside the term itself: its own rounding. */
static const quad little = 1e-6L;

/* f - J' lambda = 0, by rows, relative to what is added up. */
static void check_equation(int quantity, const quad *f, const quad *size, const double *lambda) {
    double worst_row = 0;
    for (int k = 0; k < nv; k++) {
        quad error = f[k], all = size[k];
        for (int i = 0; i < rows; i++) {
            error -= J.J[i][k] * lambda[i];
            all += (magnitude(J.J[i][k]) + little * J.J_size[i][k]) * magnitude(lambda[i]);
        }
        const quad off = relative(error, all);
        worst_row = larger(worst_row, (double)off);
    }
    record(quantity, worst_row);
}

static void check_rows(int quantity, const question *k, const double *x) {
    quad change[WORLD_DOFS];
    double worst_row = 0;
    for (int j = 0; j < nv; j++) change[j] = x[j] - k->x0[j];
    const quad size = k->size + dense_norm(&exact, change);
    for (int i = 0; i < rows; i++) {
        quad error = -k->b[i], all = k->b_size[i] + exact.scale[i] * size;
        for (int j = 0; j < nv; j++) {
            error += J.J[i][j] * x[j];
            all += magnitude(J.J[i][j]) * magnitude(x[j]) + magnitude(J.J[i][j]) * magnitude(k->x0[j]);
        }
        const quad off = relative(error, all);
        worst_row = larger(worst_row, (double)off);
    }
    record(quantity, worst_row);
}

static quad distance_between(const double *x, const quad *y) {
    quad d[WORLD_DOFS];
    for (int k = 0; k < nv; k++) d[k] = x[k] - y[k];
    return dense_norm(&exact, d);
}

/* Of forces, in the norm of what they move. */
static quad force_distance(const double *x, const quad *y) {
    quad square = 0;
    for (int i = 0; i < rows; i++) {
        const quad d = (x[i] - y[i]) * exact.scale[i];
        square += d * d;
    }
    return world_sqrt(square);
}

/* Status, rank and the two unknowns, where they are clear. Returns whether x and lambda can be compared. */
static int check_answer(const question *k, const answer *found, int x_quantity, int lambda_quantity,
                        int refused) {
    if (found->status == RBD_ERR_INFEASIBLE && k->feasible > 0) fail(refused, found->rank);
    if (found->status == RBD_OK && k->feasible < 0) fail(NOT_REFUSED, found->rank);
    if (clear_rank && found->rank != rank) fail(WRONG_RANK, found->rank - rank);
    if (!clear_rank || found->status != RBD_OK || k->feasible <= 0 || found->rank != rank) return 0;
    record(x_quantity, relative(distance_between(found->x, k->x), k->size * k->condition));
    record(lambda_quantity, relative(force_distance(found->lambda, k->lambda), k->size * k->condition));
    return 1;
}

static int usable(rbd_status status) {
    if (status == RBD_OK || status == RBD_ERR_INFEASIBLE) return 1;
    if (status != RBD_ERR_SINGULAR)
        fail(OTHER_STATUS, status);
    else if (regular)
        fail(SINGULAR, (double)exact.distance);
    return 0;
}

/* ---- the calls ---- */

static void check_jacobian(const set *s) {
    static double found[DENSE_ROWS * WORLD_DOFS], gamma[DENSE_ROWS], e[DENSE_ROWS];
    double worst_J = 0, worst_gamma = 0, worst_e = 0;
    const rbd_status status = rbd_constraint_jacobian(model, s->c, now.state.q, now.state.v, found, gamma, e);
    if (status != RBD_OK) {
        fail(OTHER_STATUS, status);
        return;
    }
    if (!finite(found, rows * nv) || !finite(gamma, rows) || !finite(e, rows)) return;
    for (int i = 0; i < rows; i++) {
        for (int k = 0; k < nv; k++)
            worst_J = larger(worst_J, (double)relative(found[i * nv + k] - J.J[i][k], J.J_size[i][k]));
        worst_gamma = larger(worst_gamma, (double)relative(gamma[i] - J.gamma[i], J.gamma_size[i]));
        worst_e = larger(worst_e, (double)relative(e[i] - J.e[i], J.e_size[i]));
    }
    record(JACOBIAN, worst_J);
    record(GAMMA, worst_gamma);
    record(ERROR, worst_e);
}

static void solve(const set *s, answer *out) {
    out->status =
        rbd_constrained_fd(model, s->c, now.state.q, now.state.v, now.state.tau, f_ext, out->x, out->lambda);
    out->rank = rbd_constraint_rank(s->c);
}

/* Terms of row k of M x. */
static quad moved_by(int k, const quad *x) {
    quad sum = 0;
    for (int j = 0; j < nv; j++) sum += magnitude(M[k * nv + j] * x[j]);
    return sum;
}

/* M a + c - tau of accelerations, and its terms. */
static void forces_of(const double *a, quad *f, quad *size) {
    quad wide[WORLD_DOFS];
    static world moved;
    widen(a, nv, wide);
    world_move(&moved, now.robot.bodies, now.robot.nb, q, v, wide);
    world_torques(&moved, gravity, wide, f_ext ? wrench : NULL, f, size);
    for (int k = 0; k < nv; k++) {
        f[k] -= tau[k];
        size[k] = little * size[k] + magnitude(bias[k]) + magnitude(tau[k]) + moved_by(k, wide);
    }
}

static int check_motion(const question *k, const answer *found) {
    quad f[WORLD_DOFS], size[WORLD_DOFS];
    if (!usable(found->status)) return 0;
    if (!finite(found->x, nv) || !finite(found->lambda, rows)) return 0;
    forces_of(found->x, f, size);
    check_equation(EQUATION, f, size, found->lambda);
    if (!regular) return 0;
    if (found->status == RBD_OK && k->feasible >= 0)
        check_rows(clear_rank && k->feasible > 0 ? ROWS : ROWS_UNCLEAR, k, found->x);
    return check_answer(k, found, ACCELERATION, LAMBDA, REFUSED);
}

/* The row that is named takes part in a combination of rows that vanishes. */
static void check_infeasible(const set *s, const answer *found) {
    const int row = rbd_infeasible_row(s->c);
    if (found->status == RBD_OK && row != -1) fail(WRONG_ROW, row);
    if (found->status != RBD_ERR_INFEASIBLE) return;
    counts[class_number][INFEASIBLE]++;
    if (row < 0 || row >= rows || (clear_rank && !dense_depends(&exact, rank, row))) fail(WRONG_ROW, row);
}

/* The constraints in another order; the answer put into the first. */
static void check_order(const question *k, const answer *first, int comparable) {
    rbd_constraint list[PROBLEM_CONSTRAINTS];
    int at[PROBLEM_CONSTRAINTS], start[PROBLEM_CONSTRAINTS];
    answer found, sorted;
    set s;
    for (int i = 0, row = 0; i < now.n; i++) {
        at[i] = i, start[i] = row;
        for (int j = 0; j < 6; j++) row += now.list[i].axes[j];
    }
    for (int i = now.n - 1; i > 0; i--) {
        const int j = below(&now.seed, i + 1), x = at[i];
        at[i] = at[j], at[j] = x;
    }
    for (int i = 0; i < now.n; i++) list[i] = now.list[at[i]];
    if (!build_set(list, &s)) {
        fail(NOT_BUILT, 0);
        free(s.memory);
        return;
    }
    solve(&s, &found);
    sorted = found;
    for (int i = 0, row = 0; i < now.n; i++)
        for (int j = 0, r = 0; j < 6; j++)
            if (list[i].axes[j]) sorted.lambda[start[at[i]] + r++] = found.lambda[row++];
    free(s.memory);
    const int as_well = check_motion(k, &sorted) && comparable;
    if (as_well || (!clear_rank && regular && first->rank == found.rank && first->status == RBD_OK &&
                    found.status == RBD_OK)) {
        quad x[WORLD_DOFS], lambda[DENSE_ROWS];
        widen(first->x, nv, x);
        widen(first->lambda, rows, lambda);
        const quad off = distance_between(sorted.x, x) + force_distance(sorted.lambda, lambda);
        if (as_well)
            record(ORDER, relative(off, k->size * k->condition));
        else {
            const quad least = (found.rank > 0 ? exact.sigma[found.rank - 1] : 1) * exact.least_share;
            record(ORDER_UNCLEAR, relative(off * exact.distance * least * least,
                                           k->size + distance_between(first->x, k->x0)));
        }
    }
    if (clear_rank && (first->rank != found.rank || (k->feasible && first->status != found.status)))
        fail(ORDER_DECIDES, found.rank - first->rank);
}

/* The state beside two others, whose rows may have other ranks, in one batch. */
static void check_batch(const question *k, const answer *first, int comparable) {
    enum { STATES = 3 };
    static double at[STATES * WORLD_COORDINATES], rates[STATES * WORLD_DOFS], torques[STATES * WORLD_DOFS],
        wrenches[STATES * 6 * WORLD_BODIES], a[STATES * WORLD_DOFS], lambda[STATES * DENSE_ROWS];
    const size_t size = rbd_batch_size(model),
                 set_size = rbd_batch_constraint_set_size(model, now.list, now.n);
    const int nb = now.robot.nb, own = below(&now.seed, STATES);
    void *memory = memory_of(size), *set_memory = memory_of(set_size);
    rbd_batch *b;
    rbd_batch_constraint_set *c;
    answer found;
    for (int i = 0; i < STATES; i++) {
        double step[WORLD_DOFS];
        for (int j = 0; j < nv; j++) step[j] = i == own ? 0 : uniform(&now.seed, -0.3, 0.3);
        rbd_integrate(model, now.state.q, step, 1, at + i * nq);
        if (i == own) memcpy(at + i * nq, now.state.q, sizeof *at * (size_t)nq);
        for (int j = 0; j < nv; j++) rates[i * nv + j] = i == own ? now.state.v[j] : 0;
        memcpy(torques + i * nv, now.state.tau, sizeof *torques * (size_t)nv);
        memcpy(wrenches + i * 6 * nb, now.state.f_ext, sizeof *wrenches * 6 * (size_t)nb);
    }
    if (rbd_batch_init(model, memory, size, &b) || rbd_batch_set_gravity(b, now.state.gravity) ||
        rbd_batch_constraint_set_init(model, b, now.list, now.n, set_memory, set_size, &c, NULL)) {
        fail(NOT_BUILT, 0);
    } else {
        found.status = rbd_batch_constrained_fd(model, c, STATES, at, rates, torques, f_ext ? wrenches : NULL,
                                                a, lambda);
        if (found.status == RBD_OK && k->feasible < 0) fail(NOT_REFUSED, found.status);
        if (usable(found.status) && usable(first->status)) {
            quad f[WORLD_DOFS], terms[WORLD_DOFS], x[WORLD_DOFS], y[DENSE_ROWS];
            memcpy(found.x, a + own * nv, sizeof *a * (size_t)nv);
            memcpy(found.lambda, lambda + own * rows, sizeof *lambda * (size_t)rows);
            if (finite(a, STATES * nv) && finite(lambda, STATES * rows)) {
                forces_of(found.x, f, terms);
                check_equation(EQUATION, f, terms, found.lambda);
                widen(first->x, nv, x);
                widen(first->lambda, rows, y);
                if (comparable)
                    record(BATCH, relative(distance_between(found.x, x) + force_distance(found.lambda, y),
                                           k->size * k->condition));
            }
        }
    }
    free(memory);
    free(set_memory);
}

static void check_impact(const set *s, double restitution) {
    question k;
    answer found;
    quad d[WORLD_DOFS], f[WORLD_DOFS], size[WORLD_DOFS];
    found.status = rbd_impact(model, s->c, now.state.q, now.state.v, restitution, found.x, found.lambda);
    found.rank = rbd_constraint_rank(s->c);
    if (!usable(found.status)) return;
    if (!finite(found.x, nv) || !finite(found.lambda, rows)) return;
    for (int i = 0; i < nv; i++) d[i] = found.x[i] - v[i];
    for (int i = 0; i < nv; i++) {
        f[i] = 0, size[i] = moved_by(i, v) + moved_by(i, d);
        for (int j = 0; j < nv; j++) {
            f[i] += M[i * nv + j] * d[j];
            size[i] += little * world_sqrt(M_size[i] * M_size[j]) * (magnitude(d[j]) + magnitude(v[j]));
        }
    }
    check_equation(IMPACT_EQUATION, f, size, found.lambda);
    if (found.status == RBD_ERR_INFEASIBLE && regular) fail(REFUSED_IMPACT, found.rank);
    if (!regular) return;
    ask_impact(&k, restitution);
    if (found.status == RBD_OK) check_rows(clear_rank ? IMPACT_ROWS : ROWS_UNCLEAR, &k, found.x);
    check_answer(&k, &found, V_PLUS, IMPULSE, REFUSED_IMPACT);
}

/* ---- constrained_id ---- */

static int actuated_of(unsigned char *actuated, int given) {
    int free_dofs = 0;
    for (int i = 0, iv = 0; i < now.robot.nb; i++) {
        const rbd_body *b = &now.robot.bodies[i];
        const int base = b->type == RBD_FLOATING;
        for (int j = 0; j < world_nv(b); j++, iv++) actuated[iv] = given ? below(&now.seed, 3) > 0 : !base;
    }
    for (int k = 0; k < nv; k++) free_dofs += !actuated[k];
    return free_dofs;
}

/* J_U' lambda = h_U at the dofs without motors, as rows of a problem whose unknowns are sqrt(weight) lambda.
   */
static void check_inverse_dynamics(const set *s, const double *a) {
    static dense_rows B;
    static dense inverse;
    static quad one[WORLD_DOFS * WORLD_DOFS], unit[WORLD_DOFS];
    quad f[WORLD_DOFS], size[WORLD_DOFS], wanted[DENSE_ROWS],
        x0[WORLD_DOFS] = {0}, x[WORLD_DOFS], unused[DENSE_ROWS], rest[DENSE_ROWS], error = 0, scale = 0;
    double torque[WORLD_DOFS], lambda[DENSE_ROWS], weight[DENSE_ROWS];
    unsigned char actuated[WORLD_DOFS];
    const int given = below(&now.seed, 2), weighted = below(&now.seed, 2);
    const int free_dofs = actuated_of(actuated, given);
    for (int i = 0; i < rows; i++) weight[i] = weighted ? uniform(&now.seed, 0.1, 10) : 1;
    const rbd_status status =
        rbd_constrained_id(model, s->c, now.state.q, now.state.v, a, f_ext, given ? actuated : NULL,
                           weighted ? weight : NULL, torque, lambda);
    if (!usable(status)) return;
    if (!finite(torque, nv) || !finite(lambda, rows)) return;
    forces_of(a, f, size);
    for (int k = 0; k < nv; k++) f[k] += tau[k] - torque[k], size[k] += magnitude(torque[k]);
    check_equation(ID_EQUATION, f, size, lambda);
    if (free_dofs == 0 || free_dofs > DENSE_ROWS || rows > WORLD_DOFS) return;
    memset(&B, 0, sizeof B);
    memset(one, 0, sizeof one);
    B.nv = rows;
    for (int k = 0; k < nv; k++) {
        if (actuated[k]) continue;
        for (int i = 0; i < rows; i++) {
            B.J[B.rows][i] = J.J[i][k] / world_sqrt((quad)weight[i]);
            B.J_size[B.rows][i] = J.J_size[i][k] / world_sqrt((quad)weight[i]);
        }
        wanted[B.rows++] = f[k] + torque[k];
        scale += size[k] * size[k];
    }
    for (int i = 0; i < rows; i++) one[i * (rows + 1)] = unit[i] = 1;
    if (!dense_factor(&inverse, &B, one, unit, rows, 0)) return;
    const double most = (double)inverse.sigma[0];
    /* Clear only if no singular value is near rounding, 2e-13 in the library: stretched 53191 has 7e-13. */
    const int r = dense_rank(&inverse, most * 1e-3);
    if (r != dense_rank(&inverse, most * 1e-14) || inverse.least_share < (quad)1e-4L || r == 0) return;
    dense_solve(&inverse, &B, r, x0, wanted, x, unused, rest);
    quad largest = 0;
    for (int i = 0; i < rows; i++) {
        const quad d = lambda[i] * world_sqrt((quad)weight[i]) - x[i];
        error += d * d, largest += x[i] * x[i];
    }
    const quad least = inverse.sigma[r - 1] * inverse.least_share, condition = inverse.sigma[0] / least;
    record(ID_LAMBDA,
           world_sqrt(error) / ((world_sqrt(largest) + world_sqrt(scale) / least) * condition * condition));
}

/* ---- derivatives ---- */

/* q after a step of size h in the direction of dof k. */
static void step_along(int k, quad h, quad *out) {
    quad d[WORLD_DOFS] = {0}, size[8];
    d[k] = h;
    for (int i = 0, iq = 0, iv = 0; i < now.robot.nb; i++) {
        const rbd_body *b = &now.robot.bodies[i];
        if (b->mimic) continue;
        world_step(b, q + iq, d + iv, out + iq, size);
        iq += world_nq(b), iv += world_nv(b);
    }
}

/* M a + c - J' lambda and J a + gamma + kd J v + kp e at another state. */
static void residuals(const quad *at_q, const quad *at_v, const quad *a, const double *lambda, quad *f,
                      quad *g) {
    static world moved;
    static dense_rows at;
    quad size[WORLD_DOFS];
    world_move(&moved, now.robot.bodies, now.robot.nb, at_q, at_v, NULL);
    dense_rows_of(&moved, now.list, now.n, at_v, &at);
    world_move(&moved, now.robot.bodies, now.robot.nb, at_q, at_v, a);
    world_torques(&moved, gravity, a, f_ext ? wrench : NULL, f, size);
    for (int i = 0; i < rows; i++) {
        g[i] = at.gamma[i] + at.kd[i] * at.Jv[i] + at.kp[i] * at.e[i];
        for (int k = 0; k < nv; k++) {
            g[i] += at.J[i][k] * a[k];
            f[k] -= at.J[i][k] * lambda[i];
        }
    }
}

/* f and g by q (order 4) or by v (both quadratic in it) along dof k. */
static void slopes(int by_v, int k, const quad *a, const double *lambda, quad *f, quad *g) {
    static const int weights[4] = {1, -8, 8, -1}, places[4] = {-2, -1, 1, 2};
    const quad h = by_v ? 1 : (quad)1e-3L;
    quad f1[WORLD_DOFS], g1[DENSE_ROWS], moved[WORLD_COORDINATES];
    for (int i = 0; i < nv; i++) f[i] = 0;
    for (int i = 0; i < rows; i++) g[i] = 0;
    for (int n = 0; n < 4; n++) {
        if (by_v && (n == 0 || n == 3)) continue;
        if (by_v) {
            memcpy(moved, v, sizeof v);
            moved[k] += places[n] * h;
        } else {
            step_along(k, places[n] * h, moved);
        }
        residuals(by_v ? q : moved, by_v ? moved : v, a, lambda, f1, g1);
        const quad w = by_v ? (quad)places[n] / (2 * h) : weights[n] / (12 * h);
        for (int i = 0; i < nv; i++) f[i] += w * f1[i];
        for (int i = 0; i < rows; i++) g[i] += w * g1[i];
    }
}

static void check_derivatives(const set *s, const question *k, const answer *first) {
    static double da[3][WORLD_DOFS * WORLD_DOFS], dlambda[3][DENSE_ROWS * WORLD_DOFS];
    answer found;
    quad a[WORLD_DOFS], worst_a = 0, worst_lambda = 0;
    found.status = rbd_constrained_fd_derivatives(model, s->c, derivatives, now.state.q, now.state.v,
                                                  now.state.tau, f_ext,
                                                  &(rbd_constrained_fd_results){.a = found.x,
                                                                                .lambda = found.lambda,
                                                                                .da_dq = da[0],
                                                                                .da_dv = da[1],
                                                                                .da_dtau = da[2],
                                                                                .dlambda_dq = dlambda[0],
                                                                                .dlambda_dv = dlambda[1],
                                                                                .dlambda_dtau = dlambda[2]});
    found.rank = rbd_constraint_rank(s->c);
    counts[class_number][DERIVATIVES]++;
    if (!check_motion(k, &found)) return;
    (void)first;
    for (int x = 0; x < 3; x++)
        if (!finite(da[x], nv * nv) || !finite(dlambda[x], rows * nv)) return;
    widen(found.x, nv, a);
    for (int x = 0; x < 3; x++) {
        quad size = 0, error_a = 0, error_lambda = 0;
        int agree = 1;
        for (int j = 0; j < nv && agree; j++) {
            quad f[WORLD_DOFS] = {0}, b[DENSE_ROWS] = {0}, x0[WORLD_DOFS], change[WORLD_DOFS],
                 force[DENSE_ROWS], rest[DENSE_ROWS];
            double column[WORLD_DOFS], rows_column[DENSE_ROWS];
            if (x == 2)
                f[j] = -1;
            else
                slopes(x == 1, j, a, found.lambda, f, b);
            for (int i = 0; i < nv; i++) f[i] = -f[i];
            for (int i = 0; i < rows; i++) b[i] = -b[i];
            dense_inverse(&exact, f, x0);
            dense_solve(&exact, &J, rank, x0, b, change, force, rest);
            quad largest = dense_norm(&exact, x0) + dense_norm(&exact, change);
            for (int i = 0; i < rows; i++) largest += magnitude(b[i]) / exact.scale[i];
            for (int i = 0; i < rows; i++) agree &= magnitude(rest[i]) <= (quad)1e-8L * largest;
            for (int i = 0; i < nv; i++) column[i] = da[x][i * nv + j];
            for (int i = 0; i < rows; i++) rows_column[i] = dlambda[x][i * nv + j];
            const quad off = distance_between(column, change), off_force = force_distance(rows_column, force);
            size = largest > size ? largest : size;
            error_a = larger(error_a, (double)off);
            error_lambda = larger(error_lambda, (double)off_force);
        }
        if (!agree) continue; /* the rank changes here */
        const quad off = error_a / (size + k->size), off_force = error_lambda / (size + k->size);
        worst_a = larger(worst_a, (double)off);
        worst_lambda = larger(worst_lambda, (double)off_force);
    }
    record(DA, worst_a / k->condition);
    record(DLAMBDA, worst_lambda / k->condition);
}

/* ---- assembly ---- */

/* Factors the rows at another place. Returns 0 if M is not positive definite. */
static int factor_at(const double *place, const rbd_constraint *list, const quad *M_there,
                     const quad *size_of_M, dense *there) {
    static world moved;
    static dense_rows at;
    quad wide[WORLD_COORDINATES];
    widen(place, nq, wide);
    world_move(&moved, now.robot.bodies, now.robot.nb, wide, NULL, NULL);
    dense_rows_of(&moved, list, now.n, NULL, &at);
    return dense_factor(there, &at, M_there, size_of_M, nv, 1);
}

/* Whether the rank is that of the state at another place too, and far from a smaller one at both. */
static int regular_at(const double *place, const rbd_constraint *list) {
    static dense there;
    return clear_rank && dense_rank(&exact, 0.01) == rank && factor_at(place, list, M, M_size, &there) &&
           dense_rank(&there, 0.01) == rank && dense_rank(&there, 1e-12) == rank;
}

/* Whether a step along x, which the rows leave free at a place, makes one more of them independent: then the
   place is singular, as where a leg is stretched. Such a row's singular value grows with the step; that of a
   row that depends on others wherever the constraints hold grows with the step's square: after a step of 1e-6
   it was 3e-7 in stretched 5620, and at most 5e-12 in 11000 problems that are compared. */
static int singular_along(const quad *x, const double *place, const rbd_constraint *list, const dense *near,
                          const quad *W, const quad *unit) {
    static dense beside;
    const quad length = dense_norm(near, x) + (quad)1e-12L; /* no step where x is rounding */
    double step[WORLD_DOFS], end[WORLD_COORDINATES];
    for (int k = 0; k < nv; k++) step[k] = (double)(x[k] / length);
    rbd_integrate(model, place, step, 1e-6, end);
    return factor_at(end, list, W, unit, &beside) && dense_rank(&beside, 1e-9) > dense_rank(near, 1e-9);
}

/* The constraints hold at the state; from a place beside it rbd_assemble must come to one where they hold. */
static void check_assembly(void) {
    static const double steps[4] = {0.3, 0.1, 0.01, 1e-4};
    static dense_rows at;
    static dense near;
    static world moved;
    static quad W[WORLD_DOFS * WORLD_DOFS], unit[WORLD_DOFS];
    rbd_constraint list[PROBLEM_CONSTRAINTS];
    double step[WORLD_DOFS], weight[WORLD_DOFS], start[WORLD_COORDINATES], q_near[WORLD_COORDINATES],
        v_near[WORLD_DOFS], d[WORLD_DOFS];
    quad wide_q[WORLD_COORDINATES], wide_v[WORLD_DOFS], x[WORLD_DOFS], lambda[DENSE_ROWS], rest[DENSE_ROWS],
        g[WORLD_DOFS], zero[DENSE_ROWS] = {0}, none[WORLD_DOFS] = {0}, worst_e = 0, worst_v = 0,
                       length_of_v = 0;
    const double length = steps[below(&now.seed, 4)];
    const int weighted = below(&now.seed, 2);
    set s;
    world_move(&moved, now.robot.bodies, now.robot.nb, q, NULL, NULL);
    for (int i = 0; i < now.n; i++) {
        list[i] = now.list[i];
        dense_close(&moved, &list[i]);
    }
    for (int k = 0; k < nv; k++) {
        step[k] = uniform(&now.seed, -length, length);
        weight[k] = weighted ? uniform(&now.seed, 0.3, 3) : 1;
    }
    rbd_integrate(model, now.state.q, step, 1, start);
    if (!build_set(list, &s)) {
        fail(NOT_BUILT, 0);
        free(s.memory);
        return;
    }
    const rbd_status status =
        rbd_assemble(model, s.c, start, now.state.v, weighted ? weight : NULL, q_near, v_near);
    free(s.memory);
    if (status == RBD_ERR_INFEASIBLE && length < 0.05 && regular_at(start, list))
        fail(REFUSED_CLOSING, length);
    if (status != RBD_OK) {
        if (status != RBD_ERR_INFEASIBLE) fail(OTHER_STATUS, status);
        return;
    }
    if (!finite(q_near, nq) || !finite(v_near, nv)) return;
    counts[class_number][ASSEMBLED]++;
    widen(q_near, nq, wide_q);
    widen(v_near, nv, wide_v);
    for (int k = 0; k < nv; k++) length_of_v += v[k] * v[k];
    length_of_v = world_sqrt(length_of_v);
    world_move(&moved, now.robot.bodies, now.robot.nb, wide_q, wide_v, NULL);
    dense_rows_of(&moved, list, now.n, wide_v, &at);
    for (int i = 0; i < rows; i++) {
        quad size = 0;
        for (int k = 0; k < nv; k++) size += at.J_size[i][k] * at.J_size[i][k];
        const quad off = magnitude(at.e[i]), off_v = relative(at.Jv[i], world_sqrt(size) * length_of_v);
        worst_e = larger(worst_e, (double)off);
        worst_v = larger(worst_v, (double)off_v);
    }
    record(CLOSED, worst_e);
    memset(W, 0, sizeof W);
    for (int k = 0; k < nv; k++) W[k * (nv + 1)] = unit[k] = weight[k];
    if (!dense_factor(&near, &at, W, unit, nv, 1)) return;
    const int r = dense_rank(&near, 1e-4);
    const int clear = r == dense_rank(&near, 1e-12) && near.least_share > (quad)1e-4L;
    record(clear ? CLOSED_V : ROWS_UNCLEAR, worst_v);
    if (!clear || r == 0) return;
    dense_solve(&near, &at, r, v, zero, x, lambda, rest);
    for (int k = 0; k < nv; k++) x[k] -= v_near[k];
    const quad least = near.sigma[r - 1] * near.least_share;
    record(NEAREST_V, relative(dense_norm(&near, x) * least * least, dense_norm(&near, v)));
    /* A singular place: no forces of constraints hold the distance there. Or one beside it, 1e-4 m off, where
       Newton's method converges slowly: stretched 20037, 45384. */
    if (r != rank) return;
    dense_slopes_of(&moved, list, now.n, &at);
    if (!dense_factor(&near, &at, W, unit, nv, 1)) return;
    rbd_difference(model, start, q_near, d);
    widen(d, nv, g);
    dense_solve(&near, &at, r, g, none, x, lambda, rest);
    if (singular_along(x, q_near, list, &near, W, unit)) return;
    record(NEAREST_Q, relative(dense_norm(&near, x), dense_norm(&near, g) + (quad)1e-3L));
}

/* ---- one problem ---- */

static void run_problem(int class_of, int number) {
    set s = {NULL, NULL};
    class_number = class_of, problem_number = number;
    memset(current, 0, sizeof current);
    draw_problem(&now, class_of, number);
    nv = now.robot.nv, nq = now.robot.nq, rows = now.rows;
    f_ext = below(&now.seed, 3) ? now.state.f_ext : NULL;
    done[class_number]++;
    if (now.n == 0) return;
    adapt_problem();
    find_truth();
    if (!build() || !build_set(now.list, &s) || rbd_constraint_rows(s.c) != rows) {
        fail(NOT_BUILT, 0);
    } else {
        question k;
        answer found, again;
        counts[class_number][!regular ? NEAR_SINGULAR : clear_rank ? CLEAR : UNCLEAR]++;
        check_jacobian(&s);
        ask_dynamics(&k);
        solve(&s, &found);
        check_infeasible(&s, &found);
        const int comparable = check_motion(&k, &found);
        check_order(&k, &found, comparable);
        check_batch(&k, &found, comparable);
        check_impact(&s, below(&now.seed, 2) ? 0 : uniform(&now.seed, 0, 1));
        if (usable(found.status)) check_inverse_dynamics(&s, found.x);
        if (comparable && !below(&now.seed, 2)) check_derivatives(&s, &k, &found);
        check_assembly();
        solve(&s, &again);
        if (again.status != found.status || memcmp(again.x, found.x, sizeof *found.x * (size_t)nv) ||
            memcmp(again.lambda, found.lambda, sizeof *found.lambda * (size_t)rows))
            fail(NOT_REPEATED, 0);
    }
    free(s.memory);
    release();
}

/* ---- tables ---- */

static void print_row(const char *name) { printf("\n%-36s", name); }

static void print_worst(void) {
    printf("%-36s", "");
    for (int c = 0; c < PROBLEM_CLASSES; c++) printf(" %15s", problem_names[c]);
    for (int k = 0; k < QUANTITIES; k++) {
        print_row(quantities[k].name);
        for (int c = 0; c < PROBLEM_CLASSES; c++)
            printf(" %7.1e %7d", worst_of[c][k].error, worst_of[c][k].number);
    }
    print_row("problems");
    for (int c = 0; c < PROBLEM_CLASSES; c++) printf(" %15ld", done[c]);
    for (int k = 0; k < COUNTS; k++) {
        print_row(count_names[k]);
        for (int c = 0; c < PROBLEM_CLASSES; c++) printf(" %15ld", counts[c][k]);
    }
    printf("\n");
    for (int k = 0; k < KINDS; k++) {
        long all = 0;
        for (int c = 0; c < PROBLEM_CLASSES; c++) all += failed[c][k];
        if (all == 0) continue;
        printf("failed: %-28s", name_of(k));
        for (int c = 0; c < PROBLEM_CLASSES; c++) printf(" %15ld", failed[c][k]);
        printf("\n");
    }
    printf("%ld failures\n", failures);
}

static int class_of(const char *name) {
    for (int c = 0; c < PROBLEM_CLASSES; c++)
        if (strcmp(problem_names[c], name) == 0) return c;
    printf("no such class: %s\n", name);
    exit(2);
}

static void show_one(int class_of_problem, int number) {
    shown = 1000;
    run_problem(class_of_problem, number);
    print_problem(&now);
    printf("rank %d (%s), distance of M from a singular matrix %.2g, singular values", rank,
           clear_rank ? "clear" : "unclear", (double)exact.distance);
    for (int k = 0; k < exact.rows; k++) printf(" %.2g", (double)exact.sigma[k]);
    printf("\nleast share of a row in what its levers allow %.2g\n", (double)exact.least_share);
    for (int k = 0; k < QUANTITIES; k++) printf("%-36s %.2e\n", quantities[k].name, current[k]);
}

/* The published bound: twice the worst error, to one digit, rounded up; at least the rounding unit. */
static double bound_of(double error) {
    char text[32];
    const double bound = fmax(2 * error, DBL_EPSILON / 2);
    snprintf(text, sizeof text, "%.0e", bound);
    if (strtod(text, NULL) < bound)
        snprintf(text, sizeof text, "%.0e", bound + pow(10, floor(log10(bound))) / 2);
    return strtod(text, NULL);
}

static void print_rows(void) {
    for (int k = 0; k < QUANTITIES; k++) {
        printf("| %s |", quantities[k].name);
        for (int c = 0; c < PROBLEM_CLASSES; c++) printf(" %.0e |", bound_of(worst_of[c][k].error));
        printf("\n");
    }
}

static int quantity_of(const char *row) {
    for (int k = 0; k < QUANTITIES; k++) {
        const size_t n = strlen(quantities[k].name);
        if (strncmp(row, "| ", 2) == 0 && strncmp(row + 2, quantities[k].name, n) == 0 &&
            strncmp(row + 2 + n, " |", 2) == 0)
            return k;
    }
    return -1;
}

static void hold_row(int quantity, const char *row) {
    const char *at = strchr(row + 2, '|');
    for (int c = 0; c < PROBLEM_CLASSES; c++) {
        char *end = NULL;
        const double bound = at ? strtod(at + 1, &end) : -1;
        const worst *w = &worst_of[c][quantity];
        at = end ? strchr(end, '|') : NULL;
        if (!(w->error <= bound)) {
            printf("FAIL %s: %.2e exceeds %.0e: --one %s %d\n", quantities[quantity].name, w->error, bound,
                   problem_names[c], w->number);
            failures++;
        }
    }
}

static void expect_compared(const char *what, long comparisons) {
    if (comparisons > 0) return;
    printf("FAIL %s: nothing is compared\n", what);
    failures++;
}

/* Compares with the rows behind the mark. */
static void hold(const char *path) {
    char line[400];
    int here = 0, held = 0;
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        const int quantity = quantity_of(line);
        if (strncmp(line, "<!-- ", 5) == 0) here = strcmp(line, "<!-- constraints -->\n") == 0;
        if (here && quantity >= 0) {
            hold_row(quantity, line);
            held++;
        }
    }
    if (file) fclose(file);
    for (int c = 0; c < PROBLEM_CLASSES; c++) expect_compared(problem_names[c], of_class[c]);
    for (int k = 0; k < QUANTITIES; k++) expect_compared(quantities[k].name, of_quantity[k]);
    if (held != QUANTITIES) {
        printf("FAIL %s: %d rows of constraints instead of %d\n", path, held, (int)QUANTITIES);
        failures++;
    }
}

int main(int argc, char **argv) {
    int problems = 10000, from = 0, only = -1, publish = 0;
    double seconds = 0;
    long all = 0;
    const char *document = NULL;
    for (int i = 1; i < argc; i++) {
        const int more = argc - 1 - i;
        if (strcmp(argv[i], "--publish") == 0)
            publish = 1;
        else if (more > 0 && strcmp(argv[i], "--hold") == 0)
            document = argv[++i];
        else if (more > 0 && strcmp(argv[i], "--seconds") == 0)
            seconds = atof(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--problems") == 0)
            problems = atoi(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--from") == 0)
            from = atoi(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--class") == 0)
            only = class_of(argv[++i]);
        else if (more > 1 && strcmp(argv[i], "--one") == 0) {
            show_one(class_of(argv[i + 1]), atoi(argv[i + 2]));
            return failures > 0;
        } else {
            printf("usage: see the head of constraints.c\n");
            return 2;
        }
    }
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ); /* a failure shows when it is found */
    const time_t start = time(NULL);
    const int each = problems / (only < 0 ? PROBLEM_CLASSES : 1);
    for (int number = from; seconds > 0 ? difftime(time(NULL), start) < seconds : number < from + each;
         number++)
        for (int c = 0; c < PROBLEM_CLASSES; c++)
            if (only < 0 || c == only) run_problem(c, number);
    if (publish)
        print_rows();
    else
        print_worst();
    if (document) hold(document);
    for (int c = 0; c < PROBLEM_CLASSES; c++) all += done[c];
    return failures > 0 || all == 0;
}
