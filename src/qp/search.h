#ifndef RBDI_QP_SEARCH_H
#define RBDI_QP_SEARCH_H
#include "qp/active.h"

/* ---- search [search] ---- */

/* A row that x misses. */
typedef struct rbdi_qp_miss {
    int row, side;
    rbd_real by; /* in the row's units */
} rbdi_qp_miss;

RBDI_PART void rbdi_qp_reached(rbdi_qp *s, const rbd_real *x) {
    s->furthest = rbdi_qp_larger(s->furthest, rbdi_qp_largest(x, s->n));
    rbdi_qp_raise(s->reach, x, RBDI_QP_KEEP * s->furthest, s->n);
}

/* By how much a value misses the lower side, or the upper one; negative if it does not. */
RBDI_INLINE rbd_real rbdi_qp_below(const rbdi_qp *s, int row, rbd_real value) {
    const rbd_real lower = s->given.lower[row];
    return lower > -RBDI_QP_NONE ? lower - value : -RBDI_QP_NONE;
}
RBDI_INLINE rbd_real rbdi_qp_above(const rbdi_qp *s, int row, rbd_real value) {
    const rbd_real upper = s->given.upper[row];
    return upper < RBDI_QP_NONE ? value - upper : -RBDI_QP_NONE;
}

/* Whether x misses a row by more than rounding explains, and by how much. */
RBDI_PART int rbdi_qp_misses(const rbdi_qp *s, int row, rbd_real accuracy, rbdi_qp_miss *miss) {
    const rbd_real value = s->value[row];
    const rbd_real below = rbdi_qp_below(s, row, value), above = rbdi_qp_above(s, row, value);
    const rbd_real by = rbdi_qp_larger(below, above);
    const rbd_real side = below > above ? s->given.lower[row] : s->given.upper[row];
    if (!(by > accuracy * rbdi_qp_terms(s, row, side))) return 0;

    miss->row = row;
    miss->side = below > above ? -1 : 1;
    miss->by = by;
    return 1;
}

/* Values at x of the watched rows; without `all` of those that are not active, for those of the others come
   with the residuals. */
RBDI_PART void rbdi_qp_evaluate(rbdi_qp *s, const rbd_real *x, int all) {
    for (int i = 0; i < s->watches; ++i) {
        const int row = s->watched[i];
        if (all || !s->side[row]) s->value[row] = rbdi_qp_row_times(s, row, x);
    }
}

/* By how much x misses a row, in lengths of it; 0 of an active one. */
RBDI_INLINE rbd_real rbdi_qp_score(const rbdi_qp *s, int row) {
    const rbd_real value = s->value[row];
    if (s->side[row]) return 0;
    return s->unit[row] * rbdi_qp_larger(s->given.lower[row] - value, value - s->given.upper[row]);
}

/* The inactive row that x misses most, in lengths of the row, beyond what rounding explains: row -1 if there
   is none. */
RBDI_PART rbdi_qp_miss rbdi_qp_most_missed(const rbdi_qp *s, rbd_real accuracy) {
    rbdi_qp_miss worst = {-1, 0, 0};
    rbd_real most = 0;
    int first = -1;

    for (int i = 0; i < s->watches; ++i) {
        const rbd_real score = rbdi_qp_score(s, s->watched[i]);
        if (!(score > most)) continue;
        most = score;
        first = s->watched[i];
    }
    if (first < 0 || rbdi_qp_misses(s, first, accuracy, &worst)) return worst;

    most = 0;
    for (int i = 0; i < s->watches; ++i) {
        const int row = s->watched[i];
        const rbd_real score = rbdi_qp_score(s, row);
        if (score > most && rbdi_qp_misses(s, row, accuracy, &worst)) most = score;
    }
    return worst;
}

/* The active inequality whose multiplier falls to 0 first on the way r, or -1; *step: where. */
RBDI_PART int rbdi_qp_first_to_leave(const rbdi_qp *s, rbd_real *step) {
    int first = -1;

    *step = 0;
    for (int j = 0; j < s->q; ++j) {
        if (!(s->r[j] * s->length[j] > RBDI_QP_DEPENDENT * s->own)) continue;
        if (rbdi_qp_is_equality(s, s->active[j]) || (first >= 0 && !(s->u[j] < *step * s->r[j]))) continue;
        *step = rbdi_qp_larger(s->u[j], 0) / s->r[j];
        first = j;
    }
    return first;
}

#define RBDI_QP_ROUNDING (64 * RBDI_EPS) /* of a row's length in the metric of H^-1 */

/* Whether a soft row is among the active ones that the last row depends on: then these do not contradict. */
RBDI_PART int rbdi_qp_gives_way(const rbdi_qp *s) {
    for (int j = 0; j < s->q; ++j)
        if (rbdi_qp_weight(s, s->active[j]) > 0 &&
            rbdi_qp_abs(s->r[j]) * s->length[j] > RBDI_QP_DEPENDENT * s->own)
            return 1;
    return 0;
}

/* Takes in a row that is missed. Each turn goes as far as the multipliers of the active rows stay positive,
   at most until the row holds:

       x += step z,   u -= step r,   the row's multiplier += step,   the miss -= step |d2|^2

   and then a row leaves, or the row joins. A row that depends on the active ones, and with which none can
   leave, contradicts them. */
RBDI_PART rbd_qp_status rbdi_qp_take_in(rbdi_qp *s, rbd_real *x, rbdi_qp_miss miss) {
    rbd_real u = 0;

    s->own = rbdi_qp_enter(s, miss.row, miss.side);
    while (s->result.steps < s->options.steps) {
        const rbd_real square = rbdi_qp_free_part(s);
        int dependent = rbdi_qp_depends(s, miss.row, square);
        rbd_real step;
        int leaves;

        rbdi_qp_copy(s->d, s->r, s->q);
        rbdi_qp_solve_r(s, s->r);
        leaves = rbdi_qp_first_to_leave(s, &step);
        if (dependent && leaves < 0) {
            const rbd_real rounding = RBDI_QP_ROUNDING * s->own;
            if (square <= rounding * rounding || !rbdi_qp_gives_way(s)) return RBD_QP_INFEASIBLE;
            dependent = 0;
        }

        if (!dependent) {
            rbdi_qp_way(s);
            if (leaves < 0 || miss.by <= step * square) {
                step = miss.by / square;
                leaves = -1;
            }
            rbdi_qp_add(step, s->z, x, s->n);
            miss.by = miss.by - step * square;
        }
        rbdi_qp_add(-step, s->r, s->u, s->q);
        u = u + step;

        if (leaves < 0) {
            s->result.steps++;
            rbdi_qp_join(s, miss.row, miss.side, u, square);
            return RBD_QP_OK;
        }
        rbdi_qp_leave(s, leaves);
    }
    return RBD_QP_ITERATIONS;
}

#endif
