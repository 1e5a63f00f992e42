#ifndef RBDI_CONSTRAINTS_REFINEMENT_H
#define RBDI_CONSTRAINTS_REFINEMENT_H
#include "constraints/rank.h"
#include "constraints/solution.h"

/* ---- refinement [refinement] ----
   Accelerations x = D^-1 (f + Y lambda) lose digits where both terms are larger by far than their sum. An
   example is a link of tiny inertia that a constraint holds: without the constraint its acceleration would
   be torque / inertia. The rows then miss their targets by rounding of these terms. Iterative refinement
   (Higham, Accuracy and Stability of Numerical Algorithms, chapter 12) finds the digits:

       b = target - Y' x,   Delta delta = b,   x += D^-1 Y delta,   lambda += delta

   until b is small beside its own terms. In most states it is so from the start. Dependent rows can only
   meet the part of b that has no component along their null vectors.

   At the end all rows must hold: b is at most RBDI_HELD of the terms that the row's length and that of x
   allow. Only rows that truly depend on each other may contradict each other by more, because positions
   drift: their null vectors n have J' n = 0. Rounding can hide a row, too. If a link of tiny inertia is on
   its path, its part along the other joints is lost beside the huge terms 1/D of that link. [rank] drops the
   row, but J' n is not 0. In this case, or if refinement stalls, the call is an error that names the row. */

/* Largest magnitude of n numbers. */
RBDI_LOCAL rbd_real rbdi_largest(const rbd_real *x, int n) {
    rbd_real largest = rbdi_zero();
    for (int k = 0; k < n; ++k) {
        const rbd_real size = rbdi_abs(x[k]);
        largest = rbdi_select(rbdi_less(largest, size), size, largest);
    }
    return largest;
}

/* b = target - Y' x, and the squares of its terms. A batch may reach into the rows of the next constraint,
   which come after, or behind the last row, where all is 0. */
RBDI_LOCAL void rbdi_rest_of_rows(rbd_constraint_set *c) {
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        for (int r = con->row; r < con->row + con->rows; r += RBDI_BATCH) {
            const rbd_real *Y = &c->Y[r];
            rbdi_batch b = *(const rbdi_batch *)&c->target[r], squares = b * b;
            for (int t = 0; t < con->dofs; ++t) {
                const int k = con->dof[t];
                const rbdi_batch term = *(const rbdi_batch *)&Y[k * c->stride] * c->x[k];
                b = b - term;
                squares = squares + term * term;
            }
            *(rbdi_batch *)&c->b[r] = b;
            *(rbdi_batch *)&c->slack[r] = squares;
        }

    /* behind the last row nothing is left of a call before, which may have had NaN */
    rbdi_clear(&c->b[c->rows], c->stride - c->rows);
}

/* Computes b and whether an entry of it is more than rounding of its terms. */
RBDI_LOCAL rbdi_mask rbdi_rows_miss(rbd_constraint_set *c) {
    rbdi_mask miss = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_rest_of_rows(c);
    if (c->pivoted) {
        rbdi_permute(c, c->b, 1, 0);
        rbdi_project_columns(c, c->b, 1);
        rbdi_permute(c, c->b, 1, 1);
    }

    for (int r = 0; r < c->rows; ++r) {
        const rbd_real least = c->slack[r] * (RBDI_MISSED * RBDI_MISSED) + RBDI_STILL * RBDI_STILL;
        miss = rbdi_or(miss, rbdi_not(rbdi_less(c->b[r] * c->b[r], least)));
    }
    return miss;
}

/* Adds entry k of D^-1 Y lambda to x. Returns whether the sum lost so many digits that rows may miss. */
RBDI_INLINE rbdi_mask rbdi_add_force(const rbd_constraint_set *c, const rbd_real *lambda, int k,
                                     rbd_real *x) {
    const rbd_real change = rbdi_y_lambda(c, lambda, k) * c->D_inverse[k], sum = *x + change;
    *x = sum;
    return rbdi_less(rbdi_abs(sum) * (1 / RBDI_LOST), rbdi_abs(change));
}

/* The same for all dofs, in c->x. */
RBDI_LOCAL rbdi_mask rbdi_add_forces(const rbd_model *m, rbd_constraint_set *c, const rbd_real *lambda) {
    rbdi_mask lost = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) lost = rbdi_or(lost, rbdi_add_force(c, lambda, k, &c->x[k]));
    return lost;
}

/* y = x where `mask`. */
RBDI_LOCAL void rbdi_copy_where(rbdi_mask mask, const rbd_real *x, int n, rbd_real *y) {
    for (int k = 0; k < n; ++k) y[k] = rbdi_select(mask, x[k], y[k]);
}

/* Refines x and lambda where `miss` says so, which rbdi_rows_miss returned. A step may exchange an error for
   one along other rows that is larger, by eps / inertia of a tiny link, and the next one removes that. So
   from the second step on a step must halve b of two steps before, or the best x and lambda so far are the
   result. */
RBDI_COLD void rbdi_refine_steps(const rbd_model *m, rbd_constraint_set *c, rbdi_mask miss) {
    rbd_real *best_x = c->of_dofs.best_x, *best_lambda = c->of_rows.best_lambda;
    rbd_real size = rbdi_largest(c->b, c->rows), best = size, last = size;
    rbdi_mask stalled = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_copy_where(miss, c->x, m->nv, best_x);
    rbdi_copy_where(miss, c->lambda, c->rows, best_lambda);

    for (int step = 0; step < RBDI_REFINEMENTS && rbdi_any(miss); ++step) {
        const rbd_real before = last;
        rbdi_mask better;
        last = size;

        rbdi_delta_solve(c, c->b, 1);
        for (int r = 0; r < c->rows; ++r) {
            c->b[r] = rbdi_select(miss, c->b[r], rbdi_zero());
            c->lambda[r] = c->lambda[r] + c->b[r];
        }
        (void)rbdi_add_forces(m, c, c->b);

        miss = rbdi_and(miss, rbdi_rows_miss(c));
        size = rbdi_largest(c->b, c->rows);
        better = rbdi_and(miss, rbdi_less(size, best));
        best = rbdi_select(better, size, best);
        rbdi_copy_where(better, c->x, m->nv, best_x);
        rbdi_copy_where(better, c->lambda, c->rows, best_lambda);

        if (step > 0) stalled = rbdi_or(stalled, rbdi_and(miss, rbdi_not(rbdi_less(size + size, before))));
        miss = rbdi_and(miss, rbdi_not(stalled));
    }

    stalled = rbdi_or(stalled, miss);
    rbdi_copy_where(stalled, best_x, m->nv, c->x);
    rbdi_copy_where(stalled, best_lambda, c->rows, c->lambda);
}

#ifndef RBDI_NOTE_REFINED /* tests of generated code, which does not refine, count these states */
#define RBDI_NOTE_REFINED() ((void)0)
#endif

/* Refines x and lambda where rows miss their targets. lost: what the additions to x returned. Returns whether
   any row missed. */
RBDI_LOCAL int rbdi_refine(const rbd_model *m, rbd_constraint_set *c, rbdi_mask lost) {
    rbdi_mask miss;
    if (!c->pivoted && !rbdi_any(lost)) return 0;

    miss = rbdi_rows_miss(c);
    if (!rbdi_any(miss)) return 0;
    RBDI_NOTE_REFINED();
    rbdi_refine_steps(m, c, miss);
    return 1;
}

/* -- do all rows hold? -- */

/* Lengths of the rows of J L^-1: the root of the sum of Y_kr^2. */
RBDI_LOCAL void rbdi_row_lengths(const rbd_model *m, const rbd_constraint_set *c, rbd_real *length) {
    for (int r = 0; r < c->rows; r += RBDI_BATCH) {
        rbdi_batch sum = rbdi_all_lanes(rbdi_zero());

        for (int k = 0; k < m->nv; ++k) {
            const rbdi_batch y = *(const rbdi_batch *)&c->Y[k * c->stride + r];
            sum = sum + y * y;
        }

        *(rbdi_batch *)&length[r] = sum;
    }

    for (int r = 0; r < c->rows; ++r) length[r] = rbdi_sqrt(length[r]);
}

/* Whether dropped row t depends on the rows taken whatever D is: each entry of Y n, n its null vector, is
   rounding of sum |n_j| length_j. */
RBDI_LOCAL rbdi_mask rbdi_row_depends(const rbd_model *m, const rbd_constraint_set *c, int t,
                                      const rbd_real *length) {
    const rbd_real *null = rbdi_null_vector(c, t);
    rbd_real *n = c->square, bound = rbdi_zero();
    rbdi_mask depends = rbdi_dropped(c, t);

    /* n in the caller's order */
    rbdi_clear(n, c->stride);
    for (int i = 0; i <= t; ++i) n[i] = null[i];
    rbdi_permute(c, n, 1, 1);

    for (int r = 0; r < c->rows; ++r) bound = bound + rbdi_abs(n[r]) * (length[r] + RBD_C(1));
    bound = bound * RBDI_DEPENDENT;
    for (int k = 0; k < m->nv; ++k)
        depends = rbdi_and(depends, rbdi_less(rbdi_abs(rbdi_y_lambda(c, n, k)), bound));

    return depends;
}

/* b loses the part by which rows that depend on each other contradict each other. */
RBDI_LOCAL void rbdi_forgive_drift(const rbd_model *m, const rbd_constraint_set *c, const rbd_real *length) {
    rbdi_permute(c, c->b, 1, 0);
    for (int t = 0; t < c->rows; ++t)
        if (rbdi_any(rbdi_dropped(c, t))) rbdi_project_along(c, t, rbdi_row_depends(m, c, t, length), c->b);
    rbdi_permute(c, c->b, 1, 1);
}

/* The first row that x, of this length, misses by b; -1 = none:

       |b_r| > RBDI_HELD (|target_r| + length_r |x|) + noise of the target

   A NaN is no miss: these calls only look for NaN in M. */
RBDI_LOCAL int rbdi_first_missed(const rbd_constraint_set *c, const rbd_real *length, rbd_real size) {
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        const rbd_real noise = rbdi_motion_size(c, con) * RBDI_NOISE + RBDI_STILL;
        for (int r = con->row; r < con->row + con->rows; ++r) {
            const rbd_real terms = rbdi_abs(c->target[r]) + length[r] * size;
            if (rbdi_any(rbdi_less(terms * RBDI_HELD + noise, rbdi_abs(c->b[r])))) return r;
        }
    }
    return -1;
}

/* Notes a row that x, the solution, does not meet, unless a row is noted already. */
RBDI_COLD void rbdi_check_held(const rbd_model *m, rbd_constraint_set *c) {
    rbd_real *length = c->of_rows.length, size = rbdi_zero();
    if (c->infeasible >= 0) return;

    rbdi_rest_of_rows(c);
    rbdi_row_lengths(m, c, length);
    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) size = size + c->x[k] * c->x[k];
    size = rbdi_sqrt(size);

    c->infeasible = rbdi_first_missed(c, length, size);
    if (c->infeasible < 0 || !c->pivoted) return;

    rbdi_forgive_drift(m, c, length);
    c->infeasible = rbdi_first_missed(c, length, size);
}

#endif
