#ifndef RBDI_IK_STEP_H
#define RBDI_IK_STEP_H
#include "motion/manifold.h"
#include "ik/layout.h"

/* Interface: rbdi_ik_copy */

/* ---- step [step] ---- */

RBDI_LOCAL void rbdi_ik_copy(const rbd_real *from, int n, rbd_real *to) {
    for (int i = 0; i < n; ++i) to[i] = from[i];
}

/* Where row i of a packed upper triangle of n rows begins: with its diagonal entry. */
RBDI_INLINE ptrdiff_t rbdi_ik_row(int n, int i) { return (ptrdiff_t)i * (2 * n - i + 1) / 2; }

/* Product of two columns of J, in three sums: one would wait for each product. Rows come in threes. */
RBDI_INLINE rbd_real rbdi_ik_product(const rbd_real *a, const rbd_real *b, int rows) {
    rbdi_v3 sum = rbdi_vec0();

    for (int r = 0; r < rows; r += 3) {
        sum.x = sum.x + a[r] * b[r];
        sum.y = sum.y + a[r + 1] * b[r + 1];
        sum.z = sum.z + a[r + 2] * b[r + 2];
    }

    return sum.x + sum.y + sum.z;
}

/* H = J'J and g = J'e. Returns the trace of H. */
RBDI_LOCAL rbd_real rbdi_ik_normal(rbdi_ik *ik) {
    rbd_real trace = rbdi_zero(), *to = ik->H;

    for (int i = 0; i < ik->dofs; ++i) {
        const rbd_real *column = &ik->J[i * ik->rows];
        const rbd_real *diagonal = to;
        ik->g[i] = rbdi_ik_product(column, ik->e, ik->rows);
        for (int j = i; j < ik->dofs; ++j) *to++ = rbdi_ik_product(column, &ik->J[j * ik->rows], ik->rows);
        trace = trace + *diagonal;
    }

    return trace;
}

/* The limit of dof i at which q is and g presses, or RBDI_IK_FREE. */
RBDI_INLINE int rbdi_ik_pressed(const rbdi_ik *ik, int i) {
    const rbdi_ik_dof *f = &ik->dof[i];
    if (f->at < 0) return RBDI_IK_FREE;
    if (ik->g[i] < 0 && !(ik->q[f->at] > f->lower)) return RBDI_IK_LOWER;
    if (ik->g[i] > 0 && !(ik->q[f->at] < f->upper)) return RBDI_IK_UPPER;
    return RBDI_IK_FREE;
}

/* Entry (i, j) of H. */
RBDI_INLINE rbd_real rbdi_ik_entry(const rbdi_ik *ik, int i, int j) {
    return i <= j ? ik->H[rbdi_ik_row(ik->dofs, i) + j - i] : ik->H[rbdi_ik_row(ik->dofs, j) + i - j];
}

/* The equations of the n free dofs: the upper triangle of H + damping 1, and in x g - H d of the others. */
RBDI_LOCAL void rbdi_ik_gather(rbdi_ik *ik, int n, rbd_real damping) {
    rbd_real *to = ik->factor;

    for (int a = 0; a < n; ++a) {
        const int i = ik->solved[a];
        const rbd_real *row = &ik->H[rbdi_ik_row(ik->dofs, i) - i];
        *to++ = row[i] + damping;
        for (int b = a + 1; b < n; ++b) *to++ = row[ik->solved[b]];
        ik->x[a] = ik->g[i];
    }

    for (int j = 0; j < ik->dofs; ++j) {
        if (ik->dof[j].hold <= RBDI_IK_STAYS) continue; /* its d is solved for, or 0 */
        for (int a = 0; a < n; ++a) ik->x[a] = ik->x[a] - rbdi_ik_entry(ik, ik->solved[a], j) * ik->d[j];
    }
}

/* Solves the equations by elimination, A = L D L'. A pivot is at least `least`; its inverse takes its place.
   Returns whether all were positive. */
RBDI_LOCAL int rbdi_ik_solve(rbdi_ik *ik, int n, rbd_real least) {
    rbd_real *row = ik->factor, *x = ik->x;
    int definite = 1;

    /* A_ij = A_ij - A_ci A_cj / D_c, and so x */
    for (int c = 0; c < n; ++c) {
        rbd_real *to = row + n - c;
        const rbd_real inverse = RBD_C(1) / rbdi_larger(row[0], least);

        if (!(row[0] > 0)) definite = 0;
        row[0] = inverse;
        for (int i = 1; i < n - c; ++i) {
            const rbd_real share = row[i] * inverse;
            for (int j = i; j < n - c; ++j, ++to) *to = *to - share * row[j];
            x[c + i] = x[c + i] - share * x[c];
        }
        row += n - c;
    }

    /* x_c = (x_c - sum A_ci x_i) / D_c */
    for (int c = n - 1; c >= 0; --c) {
        row -= n - c;
        for (int i = 1; i < n - c; ++i) x[c] = x[c] - row[i] * x[c + i];
        x[c] = x[c] * row[0];
    }

    return definite;
}

/* Takes the n free dofs' part of the step; those that would pass a limit are set on it. Returns whether there
   were any. */
RBDI_LOCAL int rbdi_ik_set_on_limits(rbdi_ik *ik, int n) {
    int any = 0;

    for (int a = 0; a < n; ++a) {
        const int i = ik->solved[a];
        rbdi_ik_dof *f = &ik->dof[i];
        ik->d[i] = ik->x[a];
        if (f->at < 0) continue;

        if (ik->q[f->at] + ik->d[i] > f->upper) {
            ik->d[i] = f->upper - ik->q[f->at];
            f->hold = RBDI_IK_UPPER;
            any = 1;
        } else if (ik->q[f->at] + ik->d[i] < f->lower) {
            ik->d[i] = f->lower - ik->q[f->at];
            f->hold = RBDI_IK_LOWER;
            any = 1;
        }
    }

    return any;
}

/* The step d from q: see [method]. H and g are those of q; least: a share of H that is rounding. Returns
   whether H + damping was definite. */
RBDI_LOCAL int rbdi_ik_step(rbdi_ik *ik, rbd_real damping, rbd_real least) {
    int more = 1, definite = 1;

    for (int i = 0; i < ik->dofs; ++i) {
        ik->d[i] = rbdi_zero();
        ik->dof[i].hold = (int16_t)(rbdi_ik_pressed(ik, i) ? RBDI_IK_STAYS : RBDI_IK_FREE);
    }

    /* each round sets more dofs on limits, until none is left or none passes one */
    while (more) {
        int n = 0;
        for (int i = 0; i < ik->dofs; ++i)
            if (ik->dof[i].hold == RBDI_IK_FREE) ik->solved[n++] = (int16_t)i;

        rbdi_ik_gather(ik, n, damping + least);
        definite &= rbdi_ik_solve(ik, n, least);
        more = rbdi_ik_set_on_limits(ik, n);
    }

    return definite;
}

/* The share of the step at which no dof turns by more than RBDI_IK_TURN. */
RBDI_LOCAL rbd_real rbdi_ik_share(const rbdi_ik *ik) {
    rbd_real most = rbdi_set(RBDI_IK_TURN);
    for (int i = 0; i < ik->dofs; ++i)
        if (ik->dof[i].turns) most = rbdi_larger(most, rbdi_abs(ik->d[i]));
    return RBDI_IK_TURN / most;
}

/* q_next = q (+) share d of the joints that move a target; the others are as in q. */
RBDI_LOCAL void rbdi_ik_move_joints(rbdi_ik *ik, rbd_real share, rbd_real *q_next) {
    const rbdi_frame *last = NULL;

    rbdi_ik_copy(ik->q, ik->m->nq, q_next);
    for (int i = 0; i < ik->dofs; ++i) ik->v[ik->dof[i].dof] = ik->d[i] * share;

    for (int i = 0; i < ik->dofs; ++i) {
        const rbdi_frame *u = &ik->m->frame[ik->m->dof[ik->dof[i].dof].body];
        if (u->nq == 1) /* the most */
            q_next[u->iq] = ik->q[u->iq] + ik->v[u->iv];
        else if (u != last)
            rbdi_step_joint(u, &ik->q[u->iq], &ik->v[u->iv], &q_next[u->iq]);
        last = u;
    }
}

/* Moves q by a share of the step to q_next, which may be q. Limits hold to the bit. */
RBDI_LOCAL void rbdi_ik_move(rbdi_ik *ik, rbd_real share, rbd_real *q_next) {
    const int whole = !(share < 1);

    rbdi_ik_move_joints(ik, share, q_next);
    for (const rbdi_ik_dof *f = ik->dof; f < ik->dof + ik->dofs; ++f) {
        rbd_real *x;
        if (f->at < 0) continue;

        x = &q_next[f->at];
        if (*x > f->upper || (f->hold == RBDI_IK_UPPER && whole)) *x = f->upper;
        if (*x < f->lower || (f->hold == RBDI_IK_LOWER && whole)) *x = f->lower;
    }
}

#endif
