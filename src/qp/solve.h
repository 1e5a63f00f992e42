#ifndef RBDI_QP_SOLVE_H
#define RBDI_QP_SOLVE_H
#include "qp/rounds.h"

/* Interface: rbdi_qp_solve, RBDI_QP_MOST */

/* ---- solve [solve code] ---- */

#define RBDI_QP_MOST 20000 /* variables with soft rows, rows: their matrices have ints for an index */
#if RBDI_REAL_KIND == 2
#define RBDI_QP_ASYMMETRY 1e-4f
#else
#define RBDI_QP_ASYMMETRY 1e-8 /* of H, as a share of its diagonal */
#endif

RBDI_PART rbd_qp_status rbdi_qp_refuse(rbdi_qp *s, rbd_qp_status status, int at, const char *field) {
    s->result.at = at;
    s->result.field = field;
    return status;
}

RBDI_ONCE int rbdi_qp_finite(rbd_real x) { return rbdi_qp_abs(x) < RBDI_QP_NONE; }

/* Whether numbers, pointers and options make sense; completes the options. */
RBDI_PART rbd_qp_status rbdi_qp_check_problem(rbdi_qp *s) {
    const rbd_qp_problem *p = &s->given;
    rbd_qp_options *o = &s->options;

    if (p->n < 1 || p->n > RBDI_QP_MOST) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "n");
    if (p->bounds < 0 || p->bounds > p->n) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "bounds");
    if (p->rows < 0 || p->rows > RBDI_QP_MOST) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "rows");
    s->n = p->n;
    s->all = p->bounds + p->rows;

    if (!p->H) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "H");
    if (!p->f) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "f");
    if (p->rows && !p->C) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "C");
    if (s->all && !p->lower) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "lower");
    if (s->all && !p->upper) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "upper");

    if (o->steps < 0) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "steps");
    if (o->rounds < 0) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "rounds");
    if (!(o->accuracy >= 0 && o->accuracy < 1)) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "accuracy");
    if (!o->steps) o->steps = 10 * (s->n + s->all);
    if (!o->rounds) o->rounds = 50;
    if (!(o->accuracy > 0)) o->accuracy = RBDI_QP_ACCURACY;

    for (int row = 0; row < s->all && p->soft; ++row) {
        if (!(p->soft[row] >= 0 && rbdi_qp_finite(p->soft[row])))
            return rbdi_qp_refuse(s, RBD_QP_RANGE, row, "soft");
        s->soft += p->soft[row] > 0;
    }
    if (s->n + s->soft > RBDI_QP_MOST) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "soft");
    return RBD_QP_OK;
}

/* H_ij and H_ji differ, or one is not a number. */
RBDI_PART rbd_qp_status rbdi_qp_refuse_pair(rbdi_qp *s, int i, int j) {
    const rbd_real *H = s->given.H;
    if (!rbdi_qp_finite(H[i * s->n + j])) return rbdi_qp_refuse(s, RBD_QP_NAN, i, "H");
    if (!rbdi_qp_finite(H[j * s->n + i])) return rbdi_qp_refuse(s, RBD_QP_NAN, j, "H");
    return rbdi_qp_refuse(s, RBD_QP_SYMMETRIC, i, "H");
}

/* H and f: finite, symmetric. A sum of squares is symmetric, and finite if its diagonal is. */
RBDI_PART rbd_qp_status rbdi_qp_check_value(rbdi_qp *s) {
    const rbd_real *H = s->given.H;
    const int n = s->n;

    for (int i = 0; i < n; ++i) {
        const rbd_real diagonal = H[i * n + i], own = RBDI_QP_ASYMMETRY * diagonal;
        if (!rbdi_qp_finite(s->given.f[i])) return rbdi_qp_refuse(s, RBD_QP_NAN, i, "f");
        if (!rbdi_qp_finite(diagonal)) return rbdi_qp_refuse(s, RBD_QP_NAN, i, "H");
        if (diagonal < 0) return rbdi_qp_refuse(s, RBD_QP_CONVEX, i, "H");
        s->t[i] = own;
        for (int j = 0; j < i && !s->shape.symmetric; ++j) {
            const rbd_real apart = rbdi_qp_abs(H[i * n + j] - H[j * n + i]);
            if (!(apart <= own) && !(apart <= own + s->t[j])) return rbdi_qp_refuse_pair(s, i, j);
        }
    }
    return RBD_QP_OK;
}

/* H is not definite: each two variables alone must be semidefinite. */
RBDI_PART rbd_qp_status rbdi_qp_check_pairs(rbdi_qp *s) {
    const rbd_real *H = s->given.H;
    const int n = s->n;

    for (int i = 0; i < s->shape.coupled; ++i) {
        for (int j = 0; j < i; ++j) {
            const rbd_real minor = H[i * n + i] * H[j * n + j];
            if (!(H[i * n + j] * H[i * n + j] <= minor + RBDI_QP_ASYMMETRY * minor))
                return rbdi_qp_refuse(s, RBD_QP_CONVEX, i, "H");
        }
    }
    return RBD_QP_OK;
}

/* The rows: finite, lower <= upper; where each begins and ends, its length, and whether x may miss it. */
RBDI_PART rbd_qp_status rbdi_qp_check_rows(rbdi_qp *s) {
    const rbd_qp_problem *p = &s->given;
    const int n = s->n;

    s->watches = 0;
    s->zeros = 0;
    for (int row = 0; row < s->all; ++row) {
        const rbd_real lower = p->lower[row], upper = p->upper[row];
        int from = row, to = row + 1;
        rbd_real square = 1;

        if (lower != lower || lower >= RBDI_QP_NONE) return rbdi_qp_refuse(s, RBD_QP_NAN, row, "lower");
        if (upper != upper || upper <= -RBDI_QP_NONE) return rbdi_qp_refuse(s, RBD_QP_NAN, row, "upper");
        if (row >= p->bounds) {
            const int of_c = row - p->bounds;
            const rbd_real *c = p->C + of_c * n;
            to = of_c < s->shape.heads ? s->shape.coupled : n;
            from = of_c >= s->shape.tails && of_c < s->shape.rest ? s->shape.coupled : 0;
            while (to > from && c[to - 1] == 0) --to;
            while (from < to && c[from] == 0) ++from;
            square = rbdi_qp_dot(c + from, c + from, to - from);
            if (!(square - square == 0)) return rbdi_qp_refuse(s, RBD_QP_NAN, row, "C");
        }
        s->from[row] = from;
        s->to[row] = to;
        s->value[row] = 0;
        s->zeros += from == to;
        s->unit[row] = square > 0 ? 1 / rbdi_sqrt(square) : RBDI_QP_NONE;
        if (lower > upper) return rbdi_qp_refuse(s, RBD_QP_SIDES, row, "lower");
        if (from < to && (lower > -RBDI_QP_NONE || upper < RBDI_QP_NONE)) s->watched[s->watches++] = row;
    }
    return RBD_QP_OK;
}

/* The least curvature w |row|^2 that a soft row gives the cost; 0: there is none. */
RBDI_PART rbd_real rbdi_qp_least_curvature(const rbdi_qp *s) {
    rbd_real least = 0;

    for (int row = 0; row < s->all; ++row) {
        const rbd_real curvature = rbdi_qp_weight(s, row) / (s->unit[row] * s->unit[row]);
        if (curvature > 0 && s->from[row] < s->to[row] && !(least > 0 && least <= curvature))
            least = curvature;
    }
    return least;
}

/* rho of the proximal method. Without H it has the units of soft rows or of f: the smaller of the two. */
RBDI_PART rbd_real rbdi_qp_proximal(const rbdi_qp *s) {
    rbd_real diagonal = 0, slope = 0, of_soft, of_slope;

    for (int i = 0; i < s->n; ++i) {
        diagonal = rbdi_qp_larger(diagonal, s->given.H[i * s->n + i]);
        slope = rbdi_qp_larger(slope, rbdi_qp_abs(s->given.f[i]));
    }
    if (diagonal > 0) return (rbd_real)RBDI_QP_PROXIMAL * diagonal;

    of_soft = (rbd_real)RBDI_QP_PROXIMAL * rbdi_qp_least_curvature(s);
    of_slope = slope / RBDI_QP_WAY;
    if (of_soft > 0 && of_slope > 0) return of_soft < of_slope ? of_soft : of_slope;
    return of_soft > 0 ? of_soft : of_slope > 0 ? of_slope : 1;
}

/* Factors H; if it is semidefinite, H + rho 1. */
RBDI_PART rbd_qp_status rbdi_qp_factor_any(rbdi_qp *s) {
    int at = rbdi_qp_factor(s);
    if (at == s->n) return RBD_QP_OK;
    if (rbdi_qp_check_pairs(s) != RBD_QP_OK) return RBD_QP_CONVEX;

    s->rho = rbdi_qp_proximal(s);
    at = rbdi_qp_factor(s);
    return at == s->n ? RBD_QP_OK : rbdi_qp_refuse(s, RBD_QP_CONVEX, at, "H");
}

/* Multipliers of what holds; one that is below 0 by rounding becomes 0. Returns whether none is. A proof that
   did not hold may stand there. */
RBDI_PART int rbdi_qp_multipliers(rbdi_qp *s, rbd_real *lambda) {
    int as_found = 1;

    for (int row = 0; row < s->all; ++row) lambda[row] = 0;
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        const int pulls = s->u[j] < 0 && !rbdi_qp_is_equality(s, row);
        const rbd_real u = pulls ? 0 : s->u[j];
        lambda[row] = s->side[row] > 0 ? u : -u;
        as_found = as_found && !pulls;
    }
    for (int e = 0; e < s->equalities; ++e) lambda[s->equality[e]] = -s->u_equal[e];

    /* Rows of zeros: e = u/w is what 0 misses. */
    for (int row = 0; row < s->all && s->zeros; ++row) {
        const rbd_real below = rbdi_qp_larger(s->given.lower[row], 0);
        const rbd_real above = rbdi_qp_larger(-s->given.upper[row], 0);
        if (s->from[row] < s->to[row]) continue;
        lambda[row] = rbdi_qp_weight(s, row) * (above - below);
        s->side[row] = (signed char)(lambda[row] > 0 ? 1 : lambda[row] < 0 ? -1 : 0);
    }
    return as_found;
}

/* result.primal of x and lambda, by the values of the rows: of each row the miss, or where it pushes the
   distance from the side, as a share of its terms. */
RBDI_PART void rbdi_qp_verify_rows(rbdi_qp *s, const rbd_real *x, const rbd_real *lambda) {
    const rbd_real furthest = rbdi_qp_largest(x, s->n);
    const rbd_real of_zero = rbdi_qp_size(s, x);

    s->result.primal = 0;
    for (int k = 0; k < s->n; ++k) s->reach[k] = 1;

    for (int row = 0; row < s->all; ++row) {
        const rbd_real weight = rbdi_qp_weight(s, row), miss = weight > 0 ? lambda[row] / weight : 0;
        const rbd_real value = s->value[row] - miss;
        if (lambda[row] == 0 && value >= s->given.lower[row] && value <= s->given.upper[row]) continue;
        const rbd_real below = rbdi_qp_below(s, row, value), above = rbdi_qp_above(s, row, value);
        const int at_upper = lambda[row] > 0 || (!(lambda[row] < 0) && above > below);
        const rbd_real by = rbdi_qp_abs(at_upper ? above : below);
        const rbd_real side = rbdi_qp_abs(at_upper ? s->given.upper[row] : s->given.lower[row]);
        const rbd_real size = side > 0 ? furthest : of_zero;

        /* its terms are more than this, for a sum is more than a root of squares */
        if (by <= 0 || by <= s->result.primal * (side + size / s->unit[row])) continue;
        const rbd_real share = by / (side + size * rbdi_qp_terms(s, row, 0) + rbdi_qp_abs(miss));
        if (rbdi_qp_finite(share))
            s->result.primal = rbdi_qp_larger(s->result.primal, share);
        else
            s->doubtful = 1;
    }
}

/* result.dual and s->balance of x and lambda, whatever they came from. */
RBDI_PART void rbdi_qp_verify_optimum(rbdi_qp *s, const rbd_real *x, const rbd_real *lambda) {
    rbd_real size = rbdi_qp_gradient(s, x, s->t), push = 0;
    if (!(size > 0)) size = s->rho * rbdi_qp_size(s, x); /* multipliers are rounding of this */

    for (int row = 0; row < s->all; ++row) {
        if (lambda[row] == 0 || s->from[row] == s->to[row]) continue;
        const rbd_real term = rbdi_qp_abs(lambda[row]) / s->unit[row];
        rbdi_qp_add_row(s, row, lambda[row], s->t);
        if (rbdi_qp_weight(s, row) > 0) size = rbdi_qp_larger(size, term);
        push = rbdi_qp_larger(push, term);
    }
    rbdi_qp_judge(s, size, push);
}

/* The verdict on x and lambda. `ended`: x is as rbdi_qp_refine left it, with the values of the rows; if no
   multiplier had to be set to 0 and there is no rho, so is result.dual. */
RBDI_PART void rbdi_qp_verify(rbdi_qp *s, int ended, const rbd_real *x, rbd_real *lambda) {
    rbd_real size = 0, push = 0;
    int as_refined;

    if (!ended) { /* the equalities may have no multipliers yet */
        rbdi_qp_residuals(s, x, &size, &push);
        rbdi_qp_balance(s, s->t, s->z);
        rbdi_qp_evaluate(s, x, 1);
    }
    as_refined = rbdi_qp_multipliers(s, lambda) && ended && !(s->rho > 0);
    rbdi_qp_verify_rows(s, x, lambda);
    if (!as_refined) rbdi_qp_verify_optimum(s, x, lambda);
}

/* A hard row of zeros contradicts itself, or asks for nothing. */
RBDI_PART rbd_qp_status rbdi_qp_zero_rows(rbdi_qp *s, rbdi_qp_miss *miss) {
    for (int row = 0; row < s->all && s->zeros; ++row) {
        const rbd_real lower = s->given.lower[row], upper = s->given.upper[row];
        if (s->from[row] < s->to[row] || rbdi_qp_weight(s, row) > 0 || (lower <= 0 && upper >= 0)) continue;
        miss->row = row;
        miss->side = lower > 0 ? -1 : 1;
        s->lambda[row] = (rbd_real)miss->side;
        return RBD_QP_INFEASIBLE;
    }
    return RBD_QP_OK;
}

RBDI_PART rbd_qp_status rbdi_qp_run(rbdi_qp *s, rbd_real *x, rbd_real *lambda) {
    rbdi_qp_miss miss = {-1, 0, 0};
    rbd_qp_status status = rbdi_qp_check_value(s);
    if (status == RBD_QP_OK) status = rbdi_qp_check_rows(s);
    if (status == RBD_QP_OK) status = rbdi_qp_factor_any(s);
    if (status != RBD_QP_OK) return status;

    rbdi_qp_eliminate_all(s, 0);
    if (s->options.warm) rbdi_qp_eliminate_all(s, 1);
    rbdi_qp_take_guess(s);
    s->columns = s->n - s->equalities;
    for (int k = 0; k < s->n; ++k) {
        s->centre[k] = s->options.warm && s->rho > 0 ? x[k] : 0;
        s->g[k] = s->given.f[k] - s->rho * s->centre[k];
    }

    s->accuracy = s->options.accuracy;
    s->loosen = 2 * (s->n + s->all);
    status = rbdi_qp_zero_rows(s, &miss);
    if (status == RBD_QP_OK) status = rbdi_qp_rounds(s, x, &miss);
    if (status == RBD_QP_INFEASIBLE) {
        rbdi_qp_refuse(s, RBD_QP_INFEASIBLE, miss.row, miss.side < 0 ? "lower" : "upper");
    } else {
        rbdi_qp_verify(s, status == RBD_QP_OK, x, lambda);
    }
    if (status == RBD_QP_OK &&
        (s->doubtful || !(rbdi_qp_larger(s->result.primal, s->result.dual) <= 10 * s->options.accuracy)))
        status = RBD_QP_INACCURATE;
    s->result.active = s->q + s->equalities;
    return status;
}

/* x and lambda are finite, whatever happened: what is not becomes 0, and the status says so. */
RBDI_PART rbd_qp_status rbdi_qp_bound_result(rbdi_qp *s, rbd_qp_status status, rbd_real *x,
                                             rbd_real *lambda) {
    for (int row = 0; row < s->all; ++row) {
        if (lambda[row] - lambda[row] == 0) continue;
        lambda[row] = 0;
        status = rbdi_qp_refuse(s, RBD_QP_NAN, row, "lambda");
    }
    for (int k = 0; k < s->n; ++k) {
        if (rbdi_qp_finite(x[k])) continue;
        x[k] = 0;
        status = rbdi_qp_refuse(s, RBD_QP_NAN, k, NULL);
    }
    if (!(s->result.dual - s->result.dual == 0)) s->result.dual = RBDI_QP_NONE;
    if (!(s->balance - s->balance == 0)) s->balance = RBDI_QP_NONE;
    return status;
}

/* Solves a problem. s: what it leaves there and in the memory stays for the caller to read. */
RBDI_PART rbd_qp_status rbdi_qp_solve(rbdi_qp *s, const rbd_qp_problem *problem,
                                      const rbd_qp_options *options, const rbdi_qp_shape *shape, void *memory,
                                      size_t size, rbd_real *x, rbd_real *lambda, signed char *side) {
    static const rbd_qp_options defaults = {0, 0, 0, 0};
    static const rbd_qp_result none = {0, 0, 0, 0, 0, -1, NULL};
    rbd_qp_status status;
    int warm;

    rbdi_require_ieee();
    s->result = none;
    if (!problem || !memory || !x) return RBD_QP_NULL;
    s->given = *problem;
    s->options = options ? *options : defaults;
    s->shape = *shape;
    s->side = side;
    s->lambda = lambda;
    s->soft = 0;
    s->q = 0;
    s->equalities = 0;
    s->reflections = 0;
    s->rho = 0;
    s->doubtful = 0;
    s->furthest = 0;
    s->balance = 0;
    status = rbdi_qp_check_problem(s);
    if (status == RBD_QP_OK && s->all && (!lambda || !side)) status = RBD_QP_NULL;
    if (status == RBD_QP_OK && size < RBD_QP_SIZE(s->n, problem->bounds, problem->rows, s->soft))
        status = RBD_QP_MEMORY;
    if (status != RBD_QP_OK) return status;

    warm = s->options.warm;
    for (int k = 0; k < s->n; ++k)
        if (!warm || !rbdi_qp_finite(x[k])) x[k] = 0;
    for (int row = 0; row < s->all; ++row) {
        lambda[row] = 0;
        if (!warm) side[row] = 0;
    }
    rbdi_qp_place(s, memory);
    s->J = NULL;
    status = rbdi_qp_run(s, x, lambda);
    return rbdi_qp_bound_result(s, status, x, lambda);
}

RBDI_API rbd_qp_status rbd_qp_solve(const rbd_qp_problem *problem, const rbd_qp_options *options,
                                    void *memory, size_t size, rbd_real *x, rbd_real *lambda,
                                    signed char *side, rbd_qp_result *result) {
    const rbdi_qp_shape any = {0, problem ? problem->n : 0, 0, 0, 0};
    rbdi_qp s;
    const rbd_qp_status status = rbdi_qp_solve(&s, problem, options, &any, memory, size, x, lambda, side);
    if (result) *result = s.result;
    return status;
}

#endif
