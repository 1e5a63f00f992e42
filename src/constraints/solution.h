#ifndef RBDI_CONSTRAINTS_SOLUTION_H
#define RBDI_CONSTRAINTS_SOLUTION_H
#include "dynamics/packed.h"
#include "constraints/layout.h"

/* Interface: rbdi_reduce_rows, rbdi_sweep_back, rbdi_sweep_down */

/* ---- solution [solution] ----
   The steps by the factor of M, before and after [factor] or [rank]. L = NULL means L = 1. */

/* x = L^-T x; D^-1. */
static void rbdi_sweep_back(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbdi_solve_up(m, c->w, L, 1, 1, c->x);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = L[m->dof[k].row + m->dof[k].depth];
}

/* Y = L^-T Y and b = target - Y' D^-1 x. Lanes behind a dof's span are 0. */
static void rbdi_reduce_rows(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    if (L) rbdi_solve_up(m, c->w, L, c->stride, c->rows, c->Y);
    for (int r = 0; r < c->rows; r += RBDI_BATCH) {
        const rbdi_batch b = *(const rbdi_batch *)&c->target[r];
        *(rbdi_batch *)&c->b[r] = b, *(rbdi_batch *)&c->demand[r] = b * b;
    }
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real x = c->x[k] * c->D_inverse[k];
        for (int r = c->span[k].first; r < c->span[k].end; r += RBDI_BATCH) {
            const rbdi_batch term = *(const rbdi_batch *)&c->Y[k * c->stride + r] * x;
            rbdi_batch *b = (rbdi_batch *)&c->b[r], *demand = (rbdi_batch *)&c->demand[r];
            *b = *b - term;
            *demand = *demand + term * term;
        }
    }
}

/* Entry k of Y lambda. */
RBDI_INLINE rbd_real rbdi_rows_push(const rbd_constraint_set *c, int k) {
    const rbdi_span s = c->span[k];
    const rbd_real *y = &c->Y[k * c->stride], *lambda = c->lambda;
    rbdi_sum sum = rbdi_sum_of_none();
    for (int r = s.first; r < s.end; r += RBDI_BATCH)
        sum = rbdi_sum_and(sum, *(const rbdi_batch *)&y[r] * *(const rbdi_batch *)&lambda[r]);
    return rbdi_sum_value(sum);
}

/* x = L^-1 D^-1 (x + Y lambda). */
static void rbdi_sweep_down(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    for (int k = 0; k < m->nv; ++k) {
        c->x[k] = c->x[k] + rbdi_rows_push(c, k);
        if (!L) c->x[k] = c->x[k] * c->D_inverse[k];
    }
    if (L) rbdi_solve_down(m, c->w, L, 1, 1, 1, c->x);
}

#endif
