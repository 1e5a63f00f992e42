#ifndef RBDI_IK_STEP_H
#define RBDI_IK_STEP_H
#include "api/manifold.h"
#include "base/scalar.h"
#include "ik/layout.h"

/* ---- step [step] ---- */

/* The larger of two. */
RBDI_INLINE rbd_real rbdi_ik_larger(rbd_real a, rbd_real b) { return a < b ? b : a; }

/* The place of row i in a packed lower triangle. */
RBDI_INLINE ptrdiff_t rbdi_ik_row(int i) { return (ptrdiff_t)i * (i + 1) / 2; }

RBDI_INLINE rbd_real rbdi_ik_product(const rbd_real *a, const rbd_real *b, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + a[i] * b[i];
    return sum;
}

/* H = J'J and g = J'e. Returns the trace of H. */
RBDI_LOCAL rbd_real rbdi_ik_normal(rbdi_ik *k) {
    rbd_real trace = rbdi_zero();

    for (int i = 0; i < k->dofs; ++i) {
        const rbd_real *column = &k->J[i * k->rows];
        rbd_real *row = &k->H[rbdi_ik_row(i)];
        for (int j = 0; j <= i; ++j) row[j] = rbdi_ik_product(column, &k->J[j * k->rows], k->rows);
        k->g[i] = rbdi_ik_product(column, k->e, k->rows);
        trace = trace + row[i];
    }

    return trace;
}

/* The limit of dof i at which q is and g presses, or RBDI_IK_FREE. */
RBDI_INLINE int rbdi_ik_pressed(const rbdi_ik *k, int i) {
    const rbdi_ik_dof *f = &k->dof[i];
    if (f->at < 0) return RBDI_IK_FREE;
    if (k->g[i] < 0 && !(k->q[f->at] > f->lower)) return RBDI_IK_LOWER;
    if (k->g[i] > 0 && !(k->q[f->at] < f->upper)) return RBDI_IK_UPPER;
    return RBDI_IK_FREE;
}

/* Entry (i, j) of H. */
RBDI_INLINE rbd_real rbdi_ik_entry(const rbdi_ik *k, int i, int j) {
    return i >= j ? k->H[rbdi_ik_row(i) + j] : k->H[rbdi_ik_row(j) + i];
}

/* The equations of the n free dofs: the lower triangle of H + damping 1, and in x g - H d of the others. */
RBDI_LOCAL void rbdi_ik_gather(rbdi_ik *k, int n, rbd_real damping) {
    for (int a = 0; a < n; ++a) {
        const int i = k->place[a];
        rbd_real *row = &k->factor[rbdi_ik_row(a)];
        for (int b = 0; b <= a; ++b) row[b] = k->H[rbdi_ik_row(i) + k->place[b]];
        row[a] = row[a] + damping;

        k->x[a] = k->g[i];
        for (int j = 0; j < k->dofs; ++j)
            if (k->dof[j].hold > RBDI_IK_STAYS) k->x[a] = k->x[a] - rbdi_ik_entry(k, i, j) * k->d[j];
    }
}

/* Solves the equations by Cholesky's factor, whose diagonal is inverted. A pivot is at least `least`. */
RBDI_LOCAL void rbdi_ik_solve(rbdi_ik *k, int n, rbd_real least) {
    rbd_real *x = k->x;

    /* L_ij = (A_ij - sum L_ik L_jk) / L_jj, and L y = x */
    for (int i = 0; i < n; ++i) {
        rbd_real *row = &k->factor[rbdi_ik_row(i)];
        for (int j = 0; j < i; ++j) {
            const rbd_real *other = &k->factor[rbdi_ik_row(j)];
            row[j] = (row[j] - rbdi_ik_product(row, other, j)) * other[j];
        }
        row[i] = RBD_C(1) / rbdi_sqrt(rbdi_ik_larger(row[i] - rbdi_ik_product(row, row, i), least));
        x[i] = (x[i] - rbdi_ik_product(row, x, i)) * row[i];
    }

    /* L'x = y */
    for (int i = n - 1; i >= 0; --i) {
        const rbd_real *row = &k->factor[rbdi_ik_row(i)];
        x[i] = x[i] * row[i];
        for (int j = 0; j < i; ++j) x[j] = x[j] - row[j] * x[i];
    }
}

/* Takes the n free dofs' part of the step; those that would pass a limit are set on it. Returns whether there
   were any. */
RBDI_LOCAL int rbdi_ik_set_on_limits(rbdi_ik *k, int n) {
    int any = 0;

    for (int a = 0; a < n; ++a) {
        const int i = k->place[a];
        rbdi_ik_dof *f = &k->dof[i];
        k->d[i] = k->x[a];
        if (f->at < 0) continue;

        if (k->q[f->at] + k->d[i] > f->upper) {
            k->d[i] = f->upper - k->q[f->at];
            f->hold = RBDI_IK_UPPER;
            any = 1;
        } else if (k->q[f->at] + k->d[i] < f->lower) {
            k->d[i] = f->lower - k->q[f->at];
            f->hold = RBDI_IK_LOWER;
            any = 1;
        }
    }

    return any;
}

/* The step d from q: see [method]. H and g are those of q; least: a share of H that is rounding. */
RBDI_LOCAL void rbdi_ik_step(rbdi_ik *k, rbd_real damping, rbd_real least) {
    int more = 1;

    for (int i = 0; i < k->dofs; ++i) {
        k->d[i] = rbdi_zero();
        k->dof[i].hold = (int16_t)(rbdi_ik_pressed(k, i) ? RBDI_IK_STAYS : RBDI_IK_FREE);
    }

    while (more) {
        int n = 0;
        for (int i = 0; i < k->dofs; ++i)
            if (k->dof[i].hold == RBDI_IK_FREE) k->place[n++] = (int16_t)i;
        rbdi_ik_gather(k, n, damping + least);
        rbdi_ik_solve(k, n, least);
        more = rbdi_ik_set_on_limits(k, n);
    }
}

/* The share of the step at which no dof turns by more than RBDI_IK_TURN. */
RBDI_LOCAL rbd_real rbdi_ik_share(const rbdi_ik *k) {
    rbd_real most = rbdi_set(RBDI_IK_TURN);
    for (int i = 0; i < k->dofs; ++i)
        if (k->dof[i].turns) most = rbdi_ik_larger(most, rbdi_abs(k->d[i]));
    return RBDI_IK_TURN / most;
}

/* Moves q by a share of the step to q_next, which may be q. Limits hold to the bit. */
RBDI_LOCAL void rbdi_ik_move(rbdi_ik *k, rbd_real share, rbd_real *q_next) {
    for (int i = 0; i < k->dofs; ++i) k->v[k->dof[i].dof] = k->d[i];
    rbd_integrate(k->m, k->q, k->v, share, q_next);

    for (const rbdi_ik_dof *f = k->dof; f < k->dof + k->dofs; ++f) {
        rbd_real *x = &q_next[f->at < 0 ? 0 : f->at];
        if (f->at < 0) continue;
        if (*x > f->upper || (f->hold == RBDI_IK_UPPER && !(share < 1))) *x = f->upper;
        if (*x < f->lower || (f->hold == RBDI_IK_LOWER && !(share < 1))) *x = f->lower;
    }
}

#endif
