#ifndef RBDI_QP_FACTOR_H
#define RBDI_QP_FACTOR_H
#include "base/scalar.h"
#include "qp/vectors.h"

/* ---- factor and equalities [factor] ----
   L is kept in the envelope of H, each row from its first entry that is not 0 on: a diagonal H, or one of
   blocks, costs next to nothing. Rows and right sides begin at a multiple of four, so that dot products have
   the same four sums whatever other vectors share a group. */

/* Scratch for a group of vectors, while d, r, leaving and z have no use. */
#define RBDI_QP_GROUP_OF(s) ((rbdi_qp_group *)(s)->d)

/* How many rows of L have more than their diagonal; and where the rows of H end: row k with the last row of L
   that reaches to k, for H is symmetric. */
RBDI_PART void rbdi_qp_find_ends(rbdi_qp *s) {
    int k = s->n;

    s->coupled = s->n;
    while (s->coupled > 0 && s->first[s->coupled - 1] == s->coupled - 1) s->coupled--;
    for (int i = s->n - 1; i >= 0; --i) {
        const int end = (i + 4) / 4 * 4;
        while (k > s->first[i]) s->last[--k] = end < s->n ? end : s->n;
    }
}

/* Component i of H x, and of |H| |x|: with the sums of all of the row, for its ends are multiples of four. */
RBDI_PART rbd_real rbdi_qp_h_times(const rbdi_qp *s, int i, const rbd_real *x, rbd_real *terms) {
    const int from = s->first[i] / 4 * 4;
    const rbd_real *h = s->given.H + i * s->n;

    if (i < s->coupled) return rbdi_qp_dot_and_terms(h + from, x + from, s->last[i] - from, terms);
    *terms = rbdi_qp_abs(h[i] * x[i]);
    return h[i] * x[i];
}

/* L L' = H + rho 1. Returns the first variable whose pivot is too small, or n. */
RBDI_PART int rbdi_qp_factor(rbdi_qp *s) {
    const int n = s->n;

    for (int i = 0; i < n; ++i) {
        const rbd_real *h = s->given.H + i * n;
        const rbd_real diagonal = h[i] + s->rho;
        rbd_real *l = s->L + i * (i + 1) / 2;
        rbd_real pivot;
        int start = i < s->shape.coupled ? 0 : i;

        while (start < i && h[start] == 0) start++;
        if (start < i) start = start / 4 * 4;
        s->first[i] = start;

        /* L_ij = (H_ij - sum_k L_ik L_jk) / L_jj */
        for (int j = start; j < i; ++j) {
            const int k = s->first[j] > start ? s->first[j] : start;
            const rbd_real *lj = s->L + j * (j + 1) / 2;
            l[j] = (h[j] - rbdi_qp_dot(l + k, lj + k, j - k)) * lj[j];
        }

        pivot = diagonal - rbdi_qp_dot(l + start, l + start, i - start);
        if (!(pivot > RBDI_QP_PIVOT * diagonal)) return i; /* nor if diagonal <= 0: pivot <= diagonal */
        l[i] = 1 / rbdi_sqrt(pivot);
    }
    rbdi_qp_find_ends(s);
    return n;
}

/* Solutions by L and reflections, of one vector; and the same of a group. */
#define RBDI_T rbd_real
#include "qp/reflections_of.h"
#undef RBDI_T

#if RBDI_QP_GROUP > 1
#define RBDI_T rbdi_qp_group
#define rbdi_qp_dot rbdi_qp_group_dot
#define rbdi_qp_dots rbdi_qp_group_dots
#define rbdi_qp_add rbdi_qp_group_add
#define rbdi_qp_adds rbdi_qp_group_adds
#define rbdi_qp_solve_lower rbdi_qp_group_solve_lower
#define rbdi_qp_solve_upper rbdi_qp_group_solve_upper
#define rbdi_qp_reflect rbdi_qp_group_reflect
#define rbdi_qp_reflect_two rbdi_qp_group_reflect_two
#define rbdi_qp_reflect_back rbdi_qp_group_reflect_back
#include "qp/reflections_of.h"
#undef RBDI_T
#undef rbdi_qp_dot
#undef rbdi_qp_dots
#undef rbdi_qp_add
#undef rbdi_qp_adds
#undef rbdi_qp_solve_lower
#undef rbdi_qp_solve_upper
#undef rbdi_qp_reflect
#undef rbdi_qp_reflect_two
#undef rbdi_qp_reflect_back
#else
#define rbdi_qp_group_solve_lower rbdi_qp_solve_lower
#define rbdi_qp_group_reflect_two rbdi_qp_reflect_two
#define rbdi_qp_group_reflect_back rbdi_qp_reflect_back
#define rbdi_qp_group_solve_upper rbdi_qp_solve_upper
#endif

/* t := L^-1 row' */
RBDI_PART void rbdi_qp_spread(const rbdi_qp *s, int row, rbd_real *t) {
    rbdi_qp_clear(t, s->n);
    if (row < s->given.bounds)
        t[row] = 1;
    else
        rbdi_qp_copy(rbdi_qp_c(s, row), t + s->from[row], s->to[row] - s->from[row]);
    rbdi_qp_solve_lower(s, t, s->from[row] / 4 * 4, s->to[row]);
}

/* t := Q'L^-1 t, of the first k reflections, two at a time */
RBDI_PART void rbdi_qp_forth(const rbdi_qp *s, int k, rbd_real *t) {
    rbdi_qp_solve_lower(s, t, 0, s->n);
    for (int e = 0; e + 1 < k; e += 2) rbdi_qp_reflect_two(s, e, 0, t);
    if (k % 2) rbdi_qp_reflect(s, k - 1, t);
}

/* t := L'^-1 Q t, of the first k reflections */
RBDI_PART void rbdi_qp_back(const rbdi_qp *s, int k, rbd_real *t) {
    rbdi_qp_reflect_back(s, k, t);
    rbdi_qp_solve_upper(s, t, s->n);
}

/* Reflection e = s->reflections of a row, whose L^-1 row', behind the earlier reflections, is v. Returns 0 if
   the row depends on the earlier ones: that is set aside, and whether it agrees with them is seen later, like
   any row. Sparse rows first make the vectors short. */
RBDI_PART int rbdi_qp_make_reflection(rbdi_qp *s, int row, rbd_real *v) {
    const int n = s->n, e = s->reflections;
    rbd_real gone, rest, length, onto;
    int end = n;

    while (end > e + 1 && v[end - 1] == 0) end--;
    gone = rbdi_qp_dot(v, v, e);
    rest = rbdi_qp_dot(v + e, v + e, end - e);
    if (rest <= RBDI_QP_DEPENDENT * RBDI_QP_DEPENDENT * (gone + rest)) return 0;

    /* v - (-+|v|) on axis e: no difference of like numbers. */
    length = rbdi_sqrt(rest);
    onto = v[e] > 0 ? -length : length;
    s->beta[e] = 1 / (length * (length + rbdi_qp_abs(v[e])));
    s->diagonal[e] = 1 / onto;
    v[e] = v[e] - onto;

    s->end[e] = end;
    if (e % 2) s->cross[e - 1] = rbdi_qp_dot(v + e - n, v + e, end - e);
    s->reflections = e + 1;

    if (rbdi_qp_is_equality(s, row)) {
        s->equality[s->equalities++] = row;
        s->side[row] = 1;
    } else {
        s->active[s->q] = row;
        s->length[s->q++] = rbdi_sqrt(gone + rest);
    }
    return 1;
}

/* Reflects rows (Householder 1958), a group of them: L^-1 row' of each goes onto an axis. */
RBDI_PART void rbdi_qp_eliminate(rbdi_qp *s, const int *rows, int lanes) {
    const int n = s->n;
    rbdi_qp_group *t = RBDI_QP_GROUP_OF(s);
    int from = n, to = 0;

    rbdi_qp_clear((rbd_real *)t, n * RBDI_QP_GROUP);
    for (int lane = 0; lane < lanes; ++lane) {
        const int row = rows[lane], begin = s->from[row], end = s->to[row];
        const rbd_real one = 1, *c = row < s->given.bounds ? &one : rbdi_qp_c(s, row);
        rbd_real *own = (rbd_real *)t + begin * RBDI_QP_GROUP + lane;

        from = begin < from ? begin : from;
        to = end > to ? end : to;
        for (int k = 0; k < end - begin; ++k) own[k * RBDI_QP_GROUP] = c[k];
    }
    from = from / 4 * 4;
    rbdi_qp_group_solve_lower(s, t, from, to);
    for (int e = 0; e + 1 < s->reflections; e += 2)
        if (s->end[e] > from || s->end[e + 1] > from) rbdi_qp_group_reflect_two(s, e, 0, t);

    for (int lane = 0; lane < lanes; ++lane) {
        const int e = s->reflections;
        rbd_real *v = s->V + e * n;
        int made = 0;

        if (e < n) {
            for (int k = 0; k < n; ++k) v[k] = ((const rbd_real *)t)[k * RBDI_QP_GROUP + lane];
            if (e % 2) rbdi_qp_reflect(s, e - 1, v);
            made = rbdi_qp_make_reflection(s, rows[lane], v);
        }
        if (!made) s->side[rows[lane]] = 0;
        if (made && e % 2 && lane + 1 < lanes) rbdi_qp_group_reflect_two(s, e - 1, 0, t);
    }
}

/* Whether a row can hold at the side of the guess. */
RBDI_PART int rbdi_qp_can_hold(const rbdi_qp *s, int row) {
    return s->side[row] && s->from[row] < s->to[row] && rbdi_qp_abs(rbdi_qp_side(s, row)) < RBDI_QP_NONE;
}

/* Eliminates the equalities, or then the rows of the guess. Soft rows have no part in it. */
RBDI_PART void rbdi_qp_eliminate_all(rbdi_qp *s, int guess) {
    int rows[RBDI_QP_GROUP], lanes = 0;

    for (int row = 0; row < s->all; ++row) {
        if (guess && !s->side[row]) continue;
        if (rbdi_qp_is_equality(s, row) == guess || rbdi_qp_weight(s, row) > 0) continue;
        if (guess && !rbdi_qp_can_hold(s, row)) {
            s->side[row] = 0;
            continue;
        }
        rows[lanes++] = row;
        if (lanes < RBDI_QP_GROUP) continue;
        rbdi_qp_eliminate(s, rows, lanes);
        lanes = 0;
    }
    if (lanes) rbdi_qp_eliminate(s, rows, lanes);
}

/* R of the rows of the guess: their reflections' diagonals, and what stands above. */
RBDI_PART void rbdi_qp_take_guess(rbdi_qp *s) {
    const int k = s->equalities;

    for (int j = 0; j < s->q; ++j) {
        const int side = s->side[s->active[j]] > 0 ? 1 : -1;
        const rbd_real sign = rbdi_qp_sign(side), *above = s->V + (k + j) * s->n + k;
        rbd_real *column = rbdi_qp_column(s, j);

        for (int i = 0; i < j; ++i) column[i] = sign * above[i];
        column[j] = sign * s->diagonal[k + j];
        s->side[s->active[j]] = (signed char)side;
        s->u[j] = 0;
    }
}

/* J = L'^-1 Q [0; 1], if it is not there yet, the last columns first: they come to lie where the vectors of
   the guess were, which the columns before have no use for. */
RBDI_PART void rbdi_qp_basis(rbdi_qp *s) {
    const int n = s->n, k = s->equalities;
    rbdi_qp_group *t = RBDI_QP_GROUP_OF(s);
    if (s->J) return;

    s->J = s->V + k * n;
    for (int j = (s->columns - 1) / RBDI_QP_GROUP * RBDI_QP_GROUP; j >= 0; j -= RBDI_QP_GROUP) {
        const int left = s->columns - j, lanes = left < RBDI_QP_GROUP ? left : RBDI_QP_GROUP;
        const int end = k + j + lanes, count = end < s->reflections ? end : s->reflections;

        rbdi_qp_clear((rbd_real *)t, n * RBDI_QP_GROUP);
        for (int lane = 0; lane < lanes; ++lane) ((rbd_real *)t)[(k + j + lane) * RBDI_QP_GROUP + lane] = 1;
        rbdi_qp_group_reflect_back(s, count, t);
        rbdi_qp_group_solve_upper(s, t, count ? n : end);
        for (int lane = 0; lane < lanes; ++lane)
            for (int i = 0; i < n; ++i)
                rbdi_qp_j(s, j + lane)[i] = ((const rbd_real *)t)[i * RBDI_QP_GROUP + lane];
    }
}

/* d = J'y; y is lost. Without J it goes by the factors. */
RBDI_PART void rbdi_qp_project(const rbdi_qp *s, rbd_real *y, rbd_real *d) {
    if (s->J) {
        for (int j = 0; j < s->columns; ++j) d[j] = rbdi_qp_dot(rbdi_qp_j(s, j), y, s->n);
        return;
    }
    rbdi_qp_forth(s, s->reflections, y);
    rbdi_qp_copy(y + s->equalities, d, s->columns);
}

/* y += J d of the columns from `from` to before `to`, two at a time; without J by the factors, with t as
   scratch. */
RBDI_PART void rbdi_qp_add_columns(const rbdi_qp *s, int from, int to, const rbd_real *d, rbd_real *y) {
    int j = from;

    if (!s->J) {
        rbdi_qp_clear(s->t, s->n);
        rbdi_qp_copy(d + from, s->t + s->equalities + from, to - from);
        rbdi_qp_back(s, s->reflections, s->t);
        rbdi_qp_add(1, s->t, y, s->n);
        return;
    }
    for (; j + 2 <= to; j += 2) rbdi_qp_adds(d[j], rbdi_qp_j(s, j), d[j + 1], rbdi_qp_j(s, j + 1), y, s->n);
    if (j < to) rbdi_qp_add(d[j], rbdi_qp_j(s, j), y, s->n);
}

/* t := L'^-1 Q (y; t2), R' y = b, for the equalities A x = b; `further`: R' y = b - A x, from the values of
   these rows. t2: t from there on. */
RBDI_PART void rbdi_qp_onto_equalities(const rbdi_qp *s, int further, rbd_real *t) {
    for (int e = 0; e < s->equalities; ++e) {
        const int row = s->equality[e];
        rbd_real b = s->given.upper[row];
        if (further) b = b - s->value[row];
        t[e] = (b - rbdi_qp_dot(s->V + e * s->n, t, e)) * s->diagonal[e];
    }
    rbdi_qp_back(s, s->equalities, t);
}

/* Multipliers u_equal of the equalities that balance y best; y += A' u_equal. t: scratch, n. */
RBDI_PART void rbdi_qp_balance(rbdi_qp *s, rbd_real *y, rbd_real *t) {
    if (!s->equalities) return;
    rbdi_qp_copy(y, t, s->n);
    rbdi_qp_forth(s, s->equalities, t);

    /* R u = -t */
    for (int e = s->equalities - 1; e >= 0; --e) {
        t[e] = t[e] * s->diagonal[e];
        s->u_equal[e] = -t[e];
        rbdi_qp_add(-t[e], s->V + e * s->n, t, e);
    }
    for (int e = 0; e < s->equalities; ++e) rbdi_qp_add_row(s, s->equality[e], s->u_equal[e], y);
}

#endif
