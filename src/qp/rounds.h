#ifndef RBDI_QP_ROUNDS_H
#define RBDI_QP_ROUNDS_H
#include "qp/search.h"
#include "qp/refine.h"

/* ---- rounds [rounds] ----
   If H is semidefinite, each round of the proximal method (Rockafellar 1976) has the cost rho |x - centre|^2
   / 2 beside it, and the next one is centred at its solution. J, R and the active rows stay. */

#define RBDI_QP_STILL (64 * RBDI_EPS) /* x that moves by a smaller share of itself moves by rounding */

/* x0: optimum on the equalities alone. */
RBDI_PART void rbdi_qp_optimum_on_equalities(rbdi_qp *s) {
    for (int k = 0; k < s->n; ++k) s->x0[k] = -s->g[k];
    rbdi_qp_solve_lower(s, s->x0, 0);
    rbdi_qp_reflect_all(s, s->x0);
    rbdi_qp_onto_equalities(s, NULL, s->x0);
}

/* Joins a row without a step, if it is independent of the active ones. */
RBDI_PART void rbdi_qp_guess(rbdi_qp *s, int row, int side) {
    const int hard = !(rbdi_qp_weight(s, row) > 0);
    const rbd_real bound = side > 0 ? s->given.upper[row] : s->given.lower[row];
    rbd_real square, least;

    if (rbdi_abs(bound) >= RBDI_QP_NONE || (hard && s->q >= s->columns)) return;
    s->own = rbdi_qp_enter(s, row, side);
    square = rbdi_qp_free_part(s);
    least = RBDI_QP_DEPENDENT * s->own;
    if (hard && square <= least * least) return;
    rbdi_qp_way(s);
    rbdi_qp_join(s, row, side, 0, square);
}

/* The soft equalities, and with `warm` the rows of the guess. Those that pull leave, so that the dual method
   may begin here. */
RBDI_PART void rbdi_qp_first_rows(rbdi_qp *s) {
    for (int row = 0; row < s->all; ++row) {
        const int equal = rbdi_qp_is_equality(s, row), soft = rbdi_qp_weight(s, row) > 0;
        const int side = equal || s->options.warm ? s->side[row] : 0;
        if (equal && !soft) continue;
        s->side[row] = 0;
        if (equal || side) rbdi_qp_guess(s, row, equal || side > 0 ? 1 : -1);
    }
}

/* The solution for this centre. */
RBDI_PART rbd_qp_status rbdi_qp_round(rbdi_qp *s, rbd_real *x, rbdi_qp_miss *miss) {
    int refined = 0;

    rbdi_qp_reached(s, s->x0);
    rbdi_qp_point(s, x);
    while (s->result.steps < s->options.steps && rbdi_qp_release(s, 0)) rbdi_qp_point(s, x);
    rbdi_qp_reached(s, x);

    for (;;) {
        rbd_qp_status status;
        *miss = rbdi_qp_most_missed(s, x, s->accuracy);
        if (miss->row < 0 && refined) return RBD_QP_OK;
        if (s->result.steps >= s->options.steps) return RBD_QP_ITERATIONS;

        if (miss->row < 0) {
            rbdi_qp_refine(s, x);
            refined = 1;
            if (rbdi_qp_release(s, s->accuracy)) {
                rbdi_qp_point(s, x);
                refined = 0;
            }
            /* x is exact now: less of what has cancelled before still counts. */
            for (int k = 0; k < s->n; ++k)
                s->reach[k] = rbdi_qp_larger(rbdi_abs(x[k]), RBDI_QP_KEEP * s->reach[k]);
            continue;
        }

        if (s->result.steps >= s->loosen) {
            s->accuracy = 10 * s->accuracy;
            s->loosen = s->loosen + 2 * (s->n + s->all);
        }
        status = rbdi_qp_take_in(s, x, *miss);
        rbdi_qp_reached(s, x);
        refined = 0;
        if (status == RBD_QP_INFEASIBLE && miss->share <= 10 * s->options.accuracy) {
            s->accuracy = 10 * s->accuracy; /* may be rounding: no proof */
            s->doubtful = 1;
            continue;
        }
        if (status != RBD_QP_OK) return status;
    }
}

/* z = x - centre; whether the value falls on this way, and H does not bend it. */
RBDI_PART int rbdi_qp_straight(rbdi_qp *s, const rbd_real *x, rbd_real size) {
    rbd_real down = 0, curvature = 0, length = 0, largest = 0, rounding;

    for (int k = 0; k < s->n; ++k) {
        s->z[k] = x[k] - s->centre[k];
        down = down + s->given.f[k] * s->z[k];
        length = rbdi_qp_larger(length, rbdi_abs(s->z[k]));
        largest = rbdi_qp_larger(largest, s->given.H[k * s->n + k]);
    }
    for (int k = 0; k < s->n; ++k)
        curvature = rbdi_qp_larger(curvature, rbdi_abs(rbdi_qp_dot(s->given.H + k * s->n, s->z, s->n)));
    rounding = 64 * RBDI_EPS * (rbd_real)s->n * largest * length;
    return down < 0 && (curvature <= s->options.accuracy * size || curvature <= rounding);
}

/* Whether no row ends the way z. */
RBDI_PART int rbdi_qp_endless(const rbdi_qp *s) {
    rbd_real length = 0;
    for (int k = 0; k < s->n; ++k) length = rbdi_qp_larger(length, rbdi_abs(s->z[k]));

    for (int row = 0; row < s->all; ++row) {
        const rbd_real by = rbdi_qp_row_times(s, row, s->z);
        const rbd_real side = by < 0 ? s->given.lower[row] : s->given.upper[row];
        if (rbdi_abs(side) < RBDI_QP_NONE && rbdi_abs(by) > s->options.accuracy * s->norm[row] * length)
            return 0;
    }
    return 1;
}

/* Rounds until x stays where it is: rho |x - centre| within the accuracy of H x and f. On a straight way each
   centre lies twice as far ahead as the one before. */
RBDI_PART rbd_qp_status rbdi_qp_rounds(rbdi_qp *s, rbd_real *x, rbdi_qp_miss *miss) {
    rbd_real ahead = 1;

    for (;; s->result.rounds++) {
        rbd_real moved = 0, size = 0, far = 0;
        rbd_qp_status status;

        rbdi_qp_optimum_on_equalities(s);
        if (s->result.rounds == 0) rbdi_qp_first_rows(s);
        status = rbdi_qp_round(s, x, miss);
        if (status != RBD_QP_OK || !(s->rho > 0)) return status;

        for (int k = 0; k < s->n; ++k) {
            const rbd_real h = rbdi_qp_dot(s->given.H + k * s->n, x, s->n);
            moved = rbdi_qp_larger(moved, s->rho * rbdi_abs(x[k] - s->centre[k]));
            far = rbdi_qp_larger(far, s->rho * rbdi_abs(x[k]));
            size = rbdi_qp_larger(size, rbdi_qp_larger(rbdi_abs(h), rbdi_abs(s->given.f[k])));
        }
        if (size > 0) s->result.dual = rbdi_qp_larger(s->result.dual, moved / size);
        if (moved <= s->options.accuracy * size || moved <= RBDI_QP_STILL * far) return RBD_QP_OK;
        if (s->result.rounds >= s->options.rounds) return RBD_QP_ITERATIONS;

        ahead = rbdi_qp_straight(s, x, size) ? 2 * ahead : 1;
        if (ahead > 4 && rbdi_qp_endless(s)) return RBD_QP_UNBOUNDED;
        for (int k = 0; k < s->n; ++k) {
            s->centre[k] = s->centre[k] + ahead * (x[k] - s->centre[k]);
            s->g[k] = s->given.f[k] - s->rho * s->centre[k];
        }
    }
}

#endif
