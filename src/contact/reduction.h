#ifndef RBDI_CONTACT_REDUCTION_H
#define RBDI_CONTACT_REDUCTION_H
#include "dynamics/packed.h"
#include "constraints/layout.h"

/* ---- row reduction [row reduction] ----
   The steps from the rows to Delta lambda = b by the factor M = L'DL. */

/* Y = L^-T Y, and b = target - Y' D^-1 x. Batches may reach beyond a dof's span: entries there are 0. */
RBDI_LOCAL void rbdi_reduce_rows(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbdi_solve_transposed(m, c->w, L, c->stride, c->rows, c->Y);

    for (int r = 0; r < c->rows; r += RBDI_BATCH) {
        *(rbdi_batch *)&c->b[r] = *(const rbdi_batch *)&c->target[r];
    }

    for (int k = 0; k < m->nv; ++k) {
        const rbd_real z = c->x[k] * c->D_inverse[k];
        for (int r = c->span[k].first; r < c->span[k].end; r += RBDI_BATCH) {
            rbdi_batch *b = (rbdi_batch *)&c->b[r];
            *b = *b - *(const rbdi_batch *)&c->Y[k * c->stride + r] * z;
        }
    }
}

#endif
