#ifndef RBDI_CONSTRAINTS_SOLUTION_H
#define RBDI_CONSTRAINTS_SOLUTION_H
#include "dynamics/packed.h"
#include "constraints/layout.h"

/* Interface: rbdi_y_lambda */

/* ---- solution [solution] ----
   The steps by the factor M = L'DL, before and after [factor] or [rank]. */

/* x = L^-T x, and c->D_inverse from the factor. */
RBDI_LOCAL void rbdi_sweep_back(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbdi_solve_transposed(m, c->w, L, 1, 1, c->x);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = L[m->dof[k].row + m->dof[k].depth];
}

/* Entry of dof k of Y lambda. */
RBDI_INLINE rbd_real rbdi_y_lambda(const rbd_constraint_set *c, const rbd_real *lambda, int k) {
    const rbdi_span span = c->span[k];
    const rbd_real *y = &c->Y[k * c->stride];
    rbdi_sum sum = rbdi_sum_of_none();
    for (int r = span.first; r < span.end; r += RBDI_BATCH)
        sum = rbdi_sum_and(sum, *(const rbdi_batch *)&y[r] * *(const rbdi_batch *)&lambda[r]);
    return rbdi_sum_value(sum);
}

#endif
