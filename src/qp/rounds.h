#ifndef RBDI_QP_ROUNDS_H
#define RBDI_QP_ROUNDS_H
#include "qp/search.h"
#include "qp/refine.h"

/* ---- rounds [rounds] ----
   If H is semidefinite, each round of the proximal method (Rockafellar 1976) has the cost rho |x - centre|^2
   / 2 beside it, and the next one is centred at its solution. J, R and the active rows stay. */

#define RBDI_QP_STILL (64 * RBDI_EPS) /* without H and f, x that moves by less of itself moves by rounding */

/* x0: optimum on the equalities alone. */
RBDI_PART void rbdi_qp_optimum_on_equalities(rbdi_qp *s) {
    for (int k = 0; k < s->n; ++k) s->x0[k] = -s->g[k];
    rbdi_qp_forth(s, s->equalities, s->x0);
    rbdi_qp_onto_equalities(s, 0, s->x0);
}

/* The soft equalities, and with `warm` the soft rows of the guess, join without a step: none depends on
   others. Rows that pull leave then, so that the dual method may begin here. */
RBDI_PART void rbdi_qp_first_soft_rows(rbdi_qp *s) {
    for (int row = 0; row < s->all && s->soft; ++row) {
        int side;
        if (!(rbdi_qp_weight(s, row) > 0)) continue;

        if (rbdi_qp_is_equality(s, row)) s->side[row] = 1;
        side = !rbdi_qp_can_hold(s, row) ? 0 : s->side[row] > 0 ? 1 : -1;
        s->side[row] = 0;
        if (!side) continue;

        s->own = rbdi_qp_enter(s, row, side);
        rbdi_qp_way(s);
        rbdi_qp_join(s, row, side, 0, rbdi_qp_free_part(s));
    }
}

#define RBDI_QP_HOPELESS \
    ((rbd_real)1e-3) /* accuracy beyond which rows that seem to contradict are left missed */

/* Writes the proof that the last row contradicts active ones: n = N r + A'u. Returns whether it holds:
   lambda' rows is 0 to the accuracy, and the sum of lambda times the sides is below what that leaves for any
   x so far. */
RBDI_PART int rbdi_qp_proven(rbdi_qp *s, rbdi_qp_miss miss) {
    rbd_real sum = 0, terms = 0, left = 0, largest = 0;

    for (int row = 0; row < s->all; ++row) s->lambda[row] = 0;
    s->lambda[miss.row] = (rbd_real)miss.side;
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        if (rbdi_qp_abs(s->r[j]) * s->length[j] > RBDI_QP_DEPENDENT * s->own)
            s->lambda[row] = s->side[row] > 0 ? -s->r[j] : s->r[j];
    }
    rbdi_qp_clear(s->t, s->n);
    for (int row = 0; row < s->all; ++row) {
        if (s->lambda[row] == 0) continue;
        rbdi_qp_add_row(s, row, -s->lambda[row], s->t);
        largest = rbdi_qp_larger(largest, rbdi_qp_abs(s->lambda[row]) / s->unit[row]);
    }
    rbdi_qp_balance(s, s->t, s->z);
    for (int e = 0; e < s->equalities; ++e) s->lambda[s->equality[e]] = -s->u_equal[e];

    for (int row = 0; row < s->all; ++row) {
        const rbd_real lambda = s->lambda[row];
        const rbd_real side = lambda > 0 ? s->given.upper[row] : s->given.lower[row];
        if (lambda == 0) continue;
        if (rbdi_qp_weight(s, row) > 0) return 0; /* it gives way */
        sum = sum + lambda * side;
        terms = terms + rbdi_qp_abs(lambda * side);
    }
    for (int k = 0; k < s->n; ++k) {
        if (!(rbdi_qp_abs(s->t[k]) <= 10 * s->options.accuracy * largest)) return 0;
        left = left + rbdi_qp_abs(s->t[k]) * s->furthest;
    }
    return sum < -(10 * s->options.accuracy * terms + left);
}

/* The solution for this centre. */
RBDI_PART rbd_qp_status rbdi_qp_round(rbdi_qp *s, rbd_real *x, rbdi_qp_miss *miss) {
    int refined = 0;

    rbdi_qp_reached(s, s->x0);
    rbdi_qp_push(s);
    while (s->result.steps < s->options.steps && rbdi_qp_release(s, 0)) rbdi_qp_push(s);
    rbdi_qp_point(s, x);
    rbdi_qp_reached(s, x);
    rbdi_qp_evaluate(s, x, 0);

    for (;;) {
        rbd_qp_status status;
        *miss = rbdi_qp_most_missed(s, s->accuracy);
        if (miss->row < 0 && refined) return RBD_QP_OK;
        if (s->result.steps >= s->options.steps) return RBD_QP_ITERATIONS;

        if (miss->row < 0) {
            int moved = rbdi_qp_refine(s, x);
            refined = 1;
            if (rbdi_qp_release(s, s->accuracy)) {
                rbdi_qp_point(s, x);
                refined = 0;
                moved = 1;
            }
            if (moved) rbdi_qp_evaluate(s, x, 0);
            /* x is exact now: what has cancelled before counts no more. */
            rbdi_qp_clear(s->reach, s->n);
            rbdi_qp_raise(s->reach, x, RBDI_QP_KEEP * rbdi_qp_size(s, x), s->n);
            continue;
        }

        if (s->result.steps >= s->loosen) {
            s->accuracy = 10 * s->accuracy;
            s->loosen = s->loosen + 2 * (s->n + s->all);
        }
        status = rbdi_qp_take_in(s, x, *miss);
        rbdi_qp_reached(s, x);
        rbdi_qp_evaluate(s, x, 0);
        refined = 0;
        if (status == RBD_QP_INFEASIBLE && !rbdi_qp_proven(s, *miss)) {
            if (s->accuracy > RBDI_QP_HOPELESS) return RBD_QP_INACCURATE;
            s->accuracy = 10 * s->accuracy;
            s->doubtful = 1;
            continue;
        }
        if (status != RBD_QP_OK) return status;
    }
}

#define RBDI_QP_BENT (8 * RBDI_EPS) /* of H times a way, for each variable: less is rounding */

/* z = x, or x - from; whether the value falls on this way, and H does not bend it, but for rounding. */
RBDI_PART int rbdi_qp_straight(rbdi_qp *s, const rbd_real *x, const rbd_real *from) {
    rbd_real down = 0, curvature = 0, length = 0, largest = 0, rounding, terms;

    for (int k = 0; k < s->n; ++k) {
        s->z[k] = from ? x[k] - from[k] : x[k];
        down = down + s->given.f[k] * s->z[k];
        length = rbdi_qp_larger(length, rbdi_qp_abs(s->z[k]));
        largest = rbdi_qp_larger(largest, s->given.H[k * s->n + k]);
    }
    for (int k = 0; k < s->n; ++k)
        curvature = rbdi_qp_larger(curvature, rbdi_qp_abs(rbdi_qp_h_times(s, k, s->z, &terms)));
    rounding = RBDI_QP_BENT * (rbd_real)s->n * largest * length;
    return down < 0 && curvature <= rounding;
}

/* Whether the value falls on the way z by more than rounding of H and f explains, where the weights of a sum
   of squares are far apart. */
RBDI_PART int rbdi_qp_falls(const rbdi_qp *s) {
    rbd_real terms;
    const rbd_real down = rbdi_qp_dot_and_terms(s->given.f, s->z, s->n, &terms);
    return -down > RBDI_QP_FALL * terms;
}

/* Whether no row ends the way z. */
RBDI_PART int rbdi_qp_endless(const rbdi_qp *s) {
    const rbd_real length = rbdi_qp_largest(s->z, s->n);

    for (int row = 0; row < s->all; ++row) {
        const rbd_real by = rbdi_qp_row_times(s, row, s->z);
        const rbd_real side = by < 0 ? s->given.lower[row] : s->given.upper[row];
        if (rbdi_qp_abs(side) < RBDI_QP_NONE && rbdi_qp_abs(by) > s->options.accuracy / s->unit[row] * length)
            return 0;
    }
    return 1;
}

/* Rounds until x stays where it is: rho |x - centre| within the accuracy of H x and f. On a straight way each
   centre lies twice as far ahead as the one before. */
RBDI_PART rbd_qp_status rbdi_qp_rounds(rbdi_qp *s, rbd_real *x, rbdi_qp_miss *miss) {
    rbd_real ahead = 1;

    for (;; s->result.rounds++) {
        rbd_real moved = 0, furthest = 0, size;
        rbd_qp_status status;

        /* The centre is all that a round has of those before it. */
        rbdi_qp_clear(s->reach, s->n);
        s->furthest = rbdi_qp_largest(s->centre, s->n);

        rbdi_qp_optimum_on_equalities(s);
        if (s->result.rounds == 0) rbdi_qp_first_soft_rows(s);
        status = rbdi_qp_round(s, x, miss);
        if (status != RBD_QP_OK || !(s->rho > 0)) return status;

        size = rbdi_qp_gradient(s, x, s->t);
        for (int k = 0; k < s->n; ++k) {
            moved = rbdi_qp_larger(moved, s->rho * rbdi_qp_abs(x[k] - s->centre[k]));
            furthest = rbdi_qp_larger(furthest, s->rho * rbdi_qp_abs(x[k]));
        }
        if (moved <= RBDI_QP_ENOUGH * s->options.accuracy * size ||
            (!(size > 0) && moved <= RBDI_QP_STILL * furthest))
            return RBD_QP_OK;
        if (s->result.rounds >= s->options.rounds) return RBD_QP_ITERATIONS;

        /* Far away x itself points along the way, also where the last round went along rows that end. */
        ahead = rbdi_qp_straight(s, x, s->centre) ? 2 * ahead : 1;
        if (ahead > 4 && (rbdi_qp_endless(s) || (rbdi_qp_straight(s, x, NULL) && rbdi_qp_endless(s))))
            return rbdi_qp_falls(s) ? RBD_QP_UNBOUNDED : RBD_QP_INACCURATE;
        for (int k = 0; k < s->n; ++k) {
            s->centre[k] = s->centre[k] + ahead * (x[k] - s->centre[k]);
            s->g[k] = s->given.f[k] - s->rho * s->centre[k];
        }
    }
}

#endif
