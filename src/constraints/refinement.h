#ifndef RBDI_CONSTRAINTS_REFINEMENT_H
#define RBDI_CONSTRAINTS_REFINEMENT_H
#include "constraints/rank.h"
#include "constraints/solution.h"

/* ---- refinement [refinement] ----
   Accelerations x = D^-1 (f + Y lambda) lose digits where both terms are larger by far than their sum. So it
   is for a link of tiny inertia that a constraint holds: without the constraint its acceleration would be
   torque / inertia. The rows then miss their targets by rounding of these terms. Iterative refinement
   (Higham, Accuracy and Stability of Numerical Algorithms, chapter 12) finds the digits:

       b = target - Y' x,   Delta delta = b,   x += D^-1 Y delta,   lambda += delta

   until b is small beside its own terms. In most states it is so from the start. Dependent rows can only meet
   what of b has no component along their null vectors. */

/* Largest magnitude of n numbers. */
static rbd_real rbdi_largest(const rbd_real *x, int n) {
    rbd_real largest = rbdi_zero();
    for (int k = 0; k < n; ++k) {
        const rbd_real size = rbdi_abs(x[k]);
        largest = rbdi_select(rbdi_less(largest, size), size, largest);
    }
    return largest;
}

/* b = target - Y' x, and the squares of its terms. A batch may reach into the rows of the next constraint,
   which come after, or behind the last row, where all is 0. */
static void rbdi_rest_of_rows(rbd_constraint_set *c) {
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
static rbdi_mask rbdi_rows_miss(rbd_constraint_set *c) {
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
static rbdi_mask rbdi_add_forces(const rbd_model *m, rbd_constraint_set *c, const rbd_real *lambda) {
    rbdi_mask lost = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) lost = rbdi_or(lost, rbdi_add_force(c, lambda, k, &c->x[k]));
    return lost;
}

/* y = x where `mask`. */
static void rbdi_copy_where(rbdi_mask mask, const rbd_real *x, int n, rbd_real *y) {
    for (int k = 0; k < n; ++k) y[k] = rbdi_select(mask, x[k], y[k]);
}

/* Refines x and lambda where `miss` says so, which rbdi_rows_miss returned. A step may exchange an error for
   one along other rows that is as large, and the next one removes that. So a step must halve b of two steps
   before, or the best x and lambda so far are the result. */
RBDI_COLD void rbdi_refine_steps(const rbd_model *m, rbd_constraint_set *c, rbdi_mask miss) {
    rbd_real *best_x = c->of_dofs.best_x, *best_lambda = c->of_rows.best_lambda;
    rbd_real size = rbdi_largest(c->b, c->rows), best = size, last = size * RBDI_FIRST_GROWTH;
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

        stalled = rbdi_or(stalled, rbdi_and(miss, rbdi_not(rbdi_less(size + size, before))));
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
static int rbdi_refine(const rbd_model *m, rbd_constraint_set *c, rbdi_mask lost) {
    rbdi_mask miss;
    if (!c->pivoted && !rbdi_any(lost)) return 0;

    miss = rbdi_rows_miss(c);
    if (!rbdi_any(miss)) return 0;
    RBDI_NOTE_REFINED();
    rbdi_refine_steps(m, c, miss);
    return 1;
}

#endif
