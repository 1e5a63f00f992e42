#ifndef RBDI_QP_FACTOR_H
#define RBDI_QP_FACTOR_H
#include "base/scalar.h"
#include "qp/vectors.h"

/* ---- factor and equalities [factor] ----
   L is kept in the envelope of H, each row from its first entry that is not 0 on: a diagonal H, or one of
   blocks, costs next to nothing. */

/* L L' = H + rho 1. Returns the first variable whose pivot is too small, or n. */
RBDI_PART int rbdi_qp_factor(rbdi_qp *s) {
    const int n = s->n;

    for (int i = 0; i < n; ++i) {
        const rbd_real *h = s->given.H + i * n;
        const rbd_real diagonal = h[i] + s->rho;
        rbd_real *l = s->L + i * (i + 1) / 2;
        rbd_real pivot;
        int start = 0;

        while (start < i && h[start] == 0) l[start++] = 0;
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
    return n;
}

/* t := L^-1 t, where t is 0 before `from`. */
RBDI_PART void rbdi_qp_solve_lower(const rbdi_qp *s, rbd_real *t, int from) {
    for (int i = from; i < s->n; ++i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i] > from ? s->first[i] : from;
        t[i] = (t[i] - rbdi_qp_dot(l + k, t + k, i - k)) * l[i];
    }
}

/* t := L'^-1 t */
RBDI_PART void rbdi_qp_solve_upper(const rbdi_qp *s, rbd_real *t) {
    for (int i = s->n - 1; i >= 0; --i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i];
        if (t[i] == 0) continue;
        t[i] = t[i] * l[i];
        rbdi_qp_add(-t[i], l + k, t + k, i - k);
    }
}

/* t := L^-1 row' */
RBDI_PART void rbdi_qp_spread(const rbdi_qp *s, int row, rbd_real *t) {
    rbdi_qp_clear(t, s->n);
    if (row < s->given.bounds)
        t[row] = 1;
    else
        rbdi_qp_copy(rbdi_qp_c(s, row), t + s->from[row], s->to[row] - s->from[row]);
    rbdi_qp_solve_lower(s, t, s->from[row]);
}

/* t := (1 - beta v v') t, of reflection e. */
RBDI_PART void rbdi_qp_reflect(const rbdi_qp *s, int e, rbd_real *t) {
    const rbd_real *v = s->V + e * s->n + e;
    const int length = s->end[e] - e;
    const rbd_real a = s->beta[e] * rbdi_qp_dot(v, t + e, length);

    if (a != 0) rbdi_qp_add(-a, v, t + e, length);
}
RBDI_PART void rbdi_qp_reflect_all(const rbdi_qp *s, rbd_real *t) {
    for (int e = 0; e < s->equalities; ++e) rbdi_qp_reflect(s, e, t);
}
RBDI_PART void rbdi_qp_reflect_back(const rbdi_qp *s, rbd_real *t) {
    for (int e = s->equalities - 1; e >= 0; --e) rbdi_qp_reflect(s, e, t);
}

/* Eliminates an equality by a reflection (Householder 1958): L^-1 row', behind the earlier reflections, goes
   onto axis e. One that depends on the earlier ones is set aside; whether it agrees with them is seen later,
   like any row. Sparse rows first make the vectors short. */
RBDI_PART void rbdi_qp_eliminate(rbdi_qp *s, int row) {
    const int n = s->n, e = s->equalities;
    rbd_real *v = s->V + e * n;
    rbd_real whole, rest, length;
    if (e == n) return;

    rbdi_qp_spread(s, row, v);
    whole = rbdi_qp_dot(v, v, n);
    rbdi_qp_reflect_all(s, v);
    rest = rbdi_qp_dot(v + e, v + e, n - e);
    if (rest <= RBDI_QP_DEPENDENT * RBDI_QP_DEPENDENT * whole) return;

    /* v - (-+|v|) on axis e: no difference of like numbers. */
    length = rbdi_sqrt(rest);
    s->beta[e] = 1 / (length * (length + rbdi_abs(v[e])));
    s->diagonal[e] = v[e] > 0 ? -length : length;
    v[e] = v[e] - s->diagonal[e];

    s->end[e] = n;
    while (s->end[e] > e + 1 && v[s->end[e] - 1] == 0) s->end[e]--;
    s->equality[e] = row;
    s->side[row] = 1;
    s->equalities = e + 1;
}

/* t := L'^-1 Q t of a group, which is 0 behind component `to`. */
RBDI_PART void rbdi_qp_basis_of(const rbdi_qp *s, rbdi_qp_group *t, int to) {
    /* t -= v (beta v't) */
    for (int e = s->equalities - 1; e >= 0; --e) {
        const rbd_real *v = s->V + e * s->n;
        rbdi_qp_group sum = v[e] * t[e];
        for (int k = e + 1; k < s->end[e]; ++k) sum = sum + v[k] * t[k];
        sum = s->beta[e] * sum;
        for (int k = e; k < s->end[e]; ++k) t[k] = t[k] - v[k] * sum;
    }
    for (int i = to - 1; i >= 0; --i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        t[i] = l[i] * t[i];
        for (int k = s->first[i]; k < i; ++k) t[k] = t[k] - l[k] * t[i];
    }
}

/* J = L'^-1 Q [0; 1], for no active row. The memory of R and what follows is not in use yet: a group lies
   there. */
RBDI_PART void rbdi_qp_basis(rbdi_qp *s) {
    const int n = s->n, k = s->equalities;
    rbdi_qp_group *t = (rbdi_qp_group *)s->R;

    s->J = s->V + k * n;
    s->columns = n - k;
    s->q = 0;
    for (int j = 0; j < s->columns; j += RBDI_QP_GROUP) {
        const int left = s->columns - j, lanes = left < RBDI_QP_GROUP ? left : RBDI_QP_GROUP;
        const int to = k ? n : j + lanes;

        rbdi_qp_clear((rbd_real *)t, n * RBDI_QP_GROUP);
        for (int lane = 0; lane < lanes; ++lane) ((rbd_real *)t)[(k + j + lane) * RBDI_QP_GROUP + lane] = 1;
        rbdi_qp_basis_of(s, t, to);
        for (int lane = 0; lane < lanes; ++lane)
            for (int i = 0; i < n; ++i)
                rbdi_qp_j(s, j + lane)[i] = ((const rbd_real *)t)[i * RBDI_QP_GROUP + lane];
    }
}

/* t := L'^-1 Q (y; t2), R' y = b - A x, for the equalities A x = b; x NULL: 0. t2: t from there on. */
RBDI_PART void rbdi_qp_onto_equalities(const rbdi_qp *s, const rbd_real *x, rbd_real *t) {
    for (int e = 0; e < s->equalities; ++e) {
        const int row = s->equality[e];
        rbd_real b = s->given.upper[row];
        if (x) b = b - rbdi_qp_row_times(s, row, x);
        t[e] = (b - rbdi_qp_dot(s->V + e * s->n, t, e)) / s->diagonal[e];
    }
    rbdi_qp_reflect_back(s, t);
    rbdi_qp_solve_upper(s, t);
}

/* Multipliers u_equal of the equalities that balance y best; y += A' u_equal. t: scratch, n. */
RBDI_PART void rbdi_qp_balance(rbdi_qp *s, rbd_real *y, rbd_real *t) {
    if (!s->equalities) return;
    rbdi_qp_copy(y, t, s->n);
    rbdi_qp_solve_lower(s, t, 0);
    rbdi_qp_reflect_all(s, t);

    /* R u = -t */
    for (int e = s->equalities - 1; e >= 0; --e) {
        t[e] = t[e] / s->diagonal[e];
        s->u_equal[e] = -t[e];
        rbdi_qp_add(-t[e], s->V + e * s->n, t, e);
    }
    for (int e = 0; e < s->equalities; ++e) rbdi_qp_add_row(s, s->equality[e], s->u_equal[e], y);
}

#endif
