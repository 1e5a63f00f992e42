#ifndef RBDI_CONSTRAINTS_SOLUTION_H
#define RBDI_CONSTRAINTS_SOLUTION_H
#include "dynamics/packed.h"
#include "constraints/layout.h"

/* Interface: rbdi_reduce_rows, rbdi_sweep_back, rbdi_sweep_down */

/* ---- solution [solution] ----
   The steps by the factor M = L'DL, before and after [factor] or [rank]. L = NULL: the identity. */

/* x = L^-T x, and c->D_inverse from the factor. */
static void rbdi_sweep_back(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbdi_solve_up(m, c->w, L, 1, 1, c->x);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = L[m->dof[k].row + m->dof[k].depth];
}

/* Y = L^-T Y, b = target - Y' D^-1 x, and the squares of b's terms. Batches may reach beyond a dof's span:
   entries there are 0. */
static void rbdi_reduce_rows(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    if (L) rbdi_solve_up(m, c->w, L, c->stride, c->rows, c->Y);
    for (int r = 0; r < c->rows; r += RBDI_BATCH) {
        const rbdi_batch b = *(const rbdi_batch *)&c->target[r];
        *(rbdi_batch *)&c->b[r] = b, *(rbdi_batch *)&c->slack[r] = b * b;
    }
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real z = c->x[k] * c->D_inverse[k];
        for (int r = c->span[k].first; r < c->span[k].end; r += RBDI_BATCH) {
            const rbdi_batch term = *(const rbdi_batch *)&c->Y[k * c->stride + r] * z;
            rbdi_batch *b = (rbdi_batch *)&c->b[r], *squares = (rbdi_batch *)&c->slack[r];
            *b = *b - term;
            *squares = *squares + term * term;
        }
    }
}

/* Entry of dof k of Y lambda. */
RBDI_INLINE rbd_real rbdi_y_lambda(const rbd_constraint_set *c, int k) {
    const rbdi_span span = c->span[k];
    const rbd_real *y = &c->Y[k * c->stride], *lambda = c->lambda;
    rbdi_sum sum = rbdi_sum_of_none();
    for (int r = span.first; r < span.end; r += RBDI_BATCH)
        sum = rbdi_sum_and(sum, *(const rbdi_batch *)&y[r] * *(const rbdi_batch *)&lambda[r]);
    return rbdi_sum_value(sum);
}

/* x = L^-1 D^-1 (x + Y lambda). */
static void rbdi_sweep_down(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    for (int k = 0; k < m->nv; ++k) {
        c->x[k] = c->x[k] + rbdi_y_lambda(c, k);
        if (!L) c->x[k] = c->x[k] * c->D_inverse[k];
    }
    if (L) rbdi_solve_down(m, c->w, L, 1, 1, 1, c->x);
}

#endif
