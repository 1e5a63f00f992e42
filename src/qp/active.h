#ifndef RBDI_QP_ACTIVE_H
#define RBDI_QP_ACTIVE_H
#include "qp/factor.h"

/* Interface: rbdi_qp_terms */

/* ---- active rows [active rows] ---- */

/* d = J'n of a row that wants to join at this side. A soft row brings its slack as a column. Returns the
   length of the row in the metric of H^-1. */
RBDI_PART rbd_real rbdi_qp_enter(rbdi_qp *s, int row, int side) {
    const rbd_real weight = rbdi_qp_weight(s, row), sign = rbdi_qp_sign(side);

    rbdi_qp_basis(s);
    if (row < s->given.bounds) {
        for (int j = 0; j < s->columns; ++j) s->d[j] = sign * rbdi_qp_j(s, j)[row];
    } else {
        const rbd_real *c = rbdi_qp_c(s, row);
        const int from = s->from[row], length = s->to[row] - from;
        for (int j = 0; j < s->columns; ++j) s->d[j] = sign * rbdi_qp_dot(rbdi_qp_j(s, j) + from, c, length);
    }

    if (weight > 0) {
        rbdi_qp_clear(rbdi_qp_j(s, s->columns), s->n);
        s->d[s->columns] = 1 / rbdi_sqrt(weight);
        s->columns++;
    }
    if (!s->equalities) return rbdi_sqrt(rbdi_qp_dot(s->d, s->d, s->columns));
    rbdi_qp_spread(s, row, s->z);
    return rbdi_sqrt(rbdi_qp_dot(s->z, s->z, s->n));
}

/* |d2|^2 */
RBDI_INLINE rbd_real rbdi_qp_free_part(const rbdi_qp *s) {
    return rbdi_qp_dot(s->d + s->q, s->d + s->q, s->columns - s->q);
}

/* Whether a hard row, with d as it is, depends on the active ones; square: |d2|^2. A soft row never does. */
RBDI_INLINE int rbdi_qp_depends(const rbdi_qp *s, int row, rbd_real square) {
    const rbd_real least = RBDI_QP_DEPENDENT * s->own;
    return !(rbdi_qp_weight(s, row) > 0) && square <= least * least;
}

/* z = J2 d2 */
RBDI_PART void rbdi_qp_way(rbdi_qp *s) {
    rbdi_qp_clear(s->z, s->n);
    rbdi_qp_add_columns(s, s->q, s->columns, s->d, s->z);
}

/* The row joins, with d and z = J2 d2 as they are; square: |d2|^2. A reflection turns d2 onto its first
   axis, a: with y = (z - a J_q) / (|d2| (|d2| + |d_q|)),

       J_j -= d_j y for j > q,   J_q -= (d_q - a) y,   the new column of R is (d1, a). */
RBDI_PART void rbdi_qp_join(rbdi_qp *s, int row, int side, rbd_real u, rbd_real square) {
    const int n = s->n, q = s->q;
    rbd_real *column = rbdi_qp_column(s, q), *J_q = rbdi_qp_j(s, q);
    rbd_real a = s->d[q];

    if (q < s->columns - 1) {
        const rbd_real length = rbdi_sqrt(square);
        const rbd_real scale = 1 / (length * (length + rbdi_qp_abs(a)));
        const rbd_real onto = a > 0 ? -length : length;

        for (int k = 0; k < n; ++k) s->z[k] = scale * (s->z[k] - onto * J_q[k]);
        rbdi_qp_add(onto - a, s->z, J_q, n);
        for (int j = q + 1; j < s->columns; ++j) rbdi_qp_add(-s->d[j], s->z, rbdi_qp_j(s, j), n);
        a = onto;
    }

    rbdi_qp_copy(s->d, column, q);
    column[q] = 1 / a;
    s->active[q] = row;
    s->u[q] = u;
    s->length[q] = s->own;
    s->side[row] = (signed char)side;
    s->q = q + 1;
}

/* Removes the slack column of a soft row that has left: its components in the columns of J2, (leaving, 0,
   ...) - J2'n, are reflected into the last column, with J2 and d, and that is deleted. */
RBDI_PART void rbdi_qp_drop_slack(rbdi_qp *s, int row, rbd_real sign) {
    const int n = s->n, q = s->q, last = s->columns - 1;
    rbd_real *slack = s->leaving, square = 0;

    for (int j = q; j <= last; ++j) {
        const rbd_real carried = j == q ? slack[j] : 0;
        slack[j] = carried - sign * rbdi_qp_row_times(s, row, rbdi_qp_j(s, j));
        square = square + slack[j] * slack[j];
    }
    s->columns = last;
    if (q >= last || !(square > 0)) return;

    const rbd_real length = rbdi_sqrt(square);
    const rbd_real scale = 1 / (length * (length + rbdi_qp_abs(slack[last])));

    slack[last] = slack[last] + (slack[last] > 0 ? length : -length);
    const rbd_real along = rbdi_qp_dot(slack + q, s->d + q, last + 1 - q);

    rbdi_qp_clear(s->z, n);
    rbdi_qp_add_columns(s, q, last + 1, slack, s->z);
    for (int j = q; j < last; ++j) {
        rbdi_qp_add(-scale * slack[j], s->z, rbdi_qp_j(s, j), n);
        s->d[j] = s->d[j] - scale * along * slack[j];
    }
}

/* Active row l leaves. R's columns behind it move one place to the left; plane rotations of its rows k and k
   + 1 make it triangular again. They turn the columns of J and d with it. */
RBDI_PART void rbdi_qp_leave(rbdi_qp *s, int l) {
    const int n = s->n, row = s->active[l];
    const rbd_real *gone = rbdi_qp_column(s, l);
    const rbd_real sign = rbdi_qp_sign(s->side[row]);

    for (int k = 0; k < l; ++k) s->leaving[k] = gone[k];
    s->leaving[l] = 1 / gone[l];
    for (int k = l + 1; k < s->q; ++k) s->leaving[k] = 0;

    for (int k = l; k < s->q - 1; ++k) {
        const rbd_real *from = rbdi_qp_column(s, k + 1);
        rbd_real *to = rbdi_qp_column(s, k);
        const rbd_real x = from[k], y = 1 / from[k + 1];
        const rbd_real inverse = 1 / rbdi_sqrt(x * x + y * y);
        const rbd_real cosine = x * inverse, sine = y * inverse;

        rbdi_qp_copy(from, to, k);
        to[k] = inverse;
        for (int j = k + 2; j < s->q; ++j) {
            rbd_real *column = rbdi_qp_column(s, j);
            rbdi_qp_rotate(column + k, column + k + 1, 1, cosine, sine);
        }
        rbdi_qp_rotate(rbdi_qp_j(s, k), rbdi_qp_j(s, k + 1), n, cosine, sine);
        rbdi_qp_rotate(s->d + k, s->d + k + 1, 1, cosine, sine);
        rbdi_qp_rotate(s->leaving + k, s->leaving + k + 1, 1, cosine, sine);
        s->active[k] = s->active[k + 1];
        s->u[k] = s->u[k + 1];
        s->length[k] = s->length[k + 1];
    }
    s->side[row] = 0;
    s->q = s->q - 1;
    s->result.steps++;
    if (rbdi_qp_weight(s, row) > 0) rbdi_qp_drop_slack(s, row, sign);
}

/* y := R^-1 y */
RBDI_PART void rbdi_qp_solve_r(const rbdi_qp *s, rbd_real *y) {
    for (int k = s->q - 1; k >= 0; --k) {
        const rbd_real *column = rbdi_qp_column(s, k);
        y[k] = y[k] * column[k];
        rbdi_qp_add(-y[k], column, y, k);
    }
}
/* y := R'^-1 y */
RBDI_PART void rbdi_qp_solve_r_transposed(const rbdi_qp *s, rbd_real *y) {
    for (int k = 0; k < s->q; ++k) {
        const rbd_real *column = rbdi_qp_column(s, k);
        y[k] = (y[k] - rbdi_qp_dot(column, y, k)) * column[k];
    }
}

/* r = y and u of the active rows: R' y = b - N'x0, u = R^-1 y. */
RBDI_PART void rbdi_qp_push(rbdi_qp *s) {
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        const rbd_real missed = rbdi_qp_side(s, row) - rbdi_qp_row_times(s, row, s->x0);
        s->r[j] = rbdi_qp_sign(s->side[row]) * missed;
    }
    rbdi_qp_solve_r_transposed(s, s->r);
    rbdi_qp_copy(s->r, s->u, s->q);
    rbdi_qp_solve_r(s, s->u);
}

/* x and u of the active rows: x = x0 + J1 y. */
RBDI_PART void rbdi_qp_point(rbdi_qp *s, rbd_real *x) {
    rbdi_qp_push(s);
    rbdi_qp_copy(s->x0, x, s->n);
    if (s->q) rbdi_qp_add_columns(s, 0, s->q, s->r, x);
}

/* The scale of a row's miss: its side, and its terms with the largest x so far. */
RBDI_PART rbd_real rbdi_qp_terms(const rbdi_qp *s, int row, rbd_real side) {
    rbd_real terms;
    const rbd_real *c;

    if (row < s->given.bounds) return rbdi_qp_abs(side) + s->reach[row];
    c = rbdi_qp_c(s, row);
    rbdi_qp_dot_and_terms(c, s->reach + s->from[row], s->to[row] - s->from[row], &terms);
    return rbdi_qp_abs(side) + terms;
}

/* The largest |x_k|; where x is nothing but what has cancelled, a share of the largest x so far. That is so
   if x = 0 is right: all hard rows that hold have the side 0. */
RBDI_PART rbd_real rbdi_qp_size(const rbdi_qp *s, const rbd_real *x) {
    const rbd_real size = rbdi_qp_largest(x, s->n);
    int zero = size <= RBDI_QP_CANCELLED * s->furthest;

    for (int j = 0; j < s->q && zero; ++j) {
        const int row = s->active[j];
        zero = rbdi_qp_side(s, row) == 0 || rbdi_qp_weight(s, row) > 0;
    }
    for (int e = 0; e < s->equalities && zero; ++e) zero = s->given.upper[s->equality[e]] == 0;
    return zero ? RBDI_QP_CANCELLED * s->furthest : size;
}

/* How far u < 0 of active row j may be rounding, in its length: a share of the largest multiplier; of a soft
   row also such a share of its terms that e = u/w misses. */
RBDI_PART rbd_real rbdi_qp_slight(const rbdi_qp *s, int j, rbd_real share, rbd_real largest) {
    const int row = s->active[j];
    const rbd_real weight = rbdi_qp_weight(s, row), slight = share * largest;
    rbd_real of_terms;

    if (!(weight > 0)) return slight;
    of_terms = share * rbdi_qp_terms(s, row, rbdi_qp_side(s, row)) * weight * s->length[j];
    return of_terms < slight ? of_terms : slight;
}

/* Active row l leaves before there is J: the reflections of the rows behind it are made anew. */
RBDI_PART void rbdi_qp_forget(rbdi_qp *s, int l) {
    const int end = s->q;

    s->side[s->active[l]] = 0;
    s->q = l;
    s->reflections = s->equalities + l;
    for (int j = l + 1; j < end; j += RBDI_QP_GROUP)
        rbdi_qp_eliminate(s, s->active + j, end - j < RBDI_QP_GROUP ? end - j : RBDI_QP_GROUP);
    rbdi_qp_take_guess(s);
    s->result.steps++;
}

/* The active inequality that pulls most, u < 0 by more than what share may be rounding, leaves. Returns
   whether one does. */
RBDI_PART int rbdi_qp_release(rbdi_qp *s, rbd_real share) {
    rbd_real least = 0, largest = 0;
    int worst = -1;

    for (int j = 0; j < s->q; ++j) largest = rbdi_qp_larger(largest, rbdi_qp_abs(s->u[j] * s->length[j]));
    for (int j = 0; j < s->q; ++j) {
        const rbd_real u = s->u[j] * s->length[j];
        if (!(u < least) || rbdi_qp_is_equality(s, s->active[j])) continue;
        if (-u <= rbdi_qp_slight(s, j, share, largest)) continue;
        least = u;
        worst = j;
    }
    if (worst < 0) return 0;
    if (s->J)
        rbdi_qp_leave(s, worst);
    else
        rbdi_qp_forget(s, worst);
    return 1;
}

#endif
