#ifndef RBDI_CONSTRAINTS_SOLUTION_H
#define RBDI_CONSTRAINTS_SOLUTION_H
#include "base/simd.h"
#include "constraints/layout.h"

/* Interface: rbdi_reduce_rows, rbdi_sweep_back, rbdi_sweep_down */

/* ---- solution [solution] ----
   The steps by the factor of M before and after [factor] or [rank]. L = NULL: L = 1. */

/* x = D^-1 L^-T x; D^-1. */
static void rbdi_sweep_back(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    for (int k = m->nv - 1; k >= 0; --k) {
        const rbd_real *l = &L[m->dof[k].row], x = c->x[k];
        const int d = m->dof[k].depth;
        for (int t = d - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda)
            c->x[i] = c->x[i] - l[t] * x;
        c->x[k] = x * l[d];
        c->D_inverse[k] = l[d];
    }
}

/* Y = L^-T Y and b = target - Y'x. Lanes behind a dof's span are 0. */
static void rbdi_reduce_rows(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    for (int r = 0; r < c->rows; r += RBDI_BATCH) {
        const rbdi_batch b = *(const rbdi_batch *)&c->target[r];
        *(rbdi_batch *)&c->b[r] = b, *(rbdi_batch *)&c->demand[r] = b * b;
    }
    for (int k = m->nv - 1; k >= 0; --k)
        for (int r = c->span[k].first; r < c->span[k].end; r += RBDI_BATCH) {
            const rbd_real *l = L ? &L[m->dof[k].row] : NULL;
            const rbdi_batch y = *(const rbdi_batch *)&c->Y[k * c->stride + r], term = y * c->x[k];
            rbdi_batch *b = (rbdi_batch *)&c->b[r], *demand = (rbdi_batch *)&c->demand[r];
            *b = *b - term;
            *demand = *demand + term * term;
            for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; l && t >= 0; --t, i = m->dof[i].lambda) {
                rbdi_batch *to = (rbdi_batch *)&c->Y[i * c->stride + r];
                *to = *to - y * l[t];
            }
        }
}

/* Entry k of D^-1 Y lambda. */
RBDI_INLINE rbd_real rbdi_rows_push(const rbd_constraint_set *c, int k) {
    const rbdi_span s = c->span[k];
    const rbd_real *y = &c->Y[k * c->stride], *lambda = c->lambda;
    rbdi_batch sum = *(const rbdi_batch *)&y[s.first] * *(const rbdi_batch *)&lambda[s.first];
    for (int r = s.first + RBDI_BATCH; r < s.end; r += RBDI_BATCH)
        sum = sum + *(const rbdi_batch *)&y[r] * *(const rbdi_batch *)&lambda[r];
    return rbdi_sum_lanes(sum) * c->D_inverse[k];
}

/* x = L^-1 (x + D^-1 Y lambda). */
static void rbdi_sweep_down(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real *l = L ? &L[m->dof[k].row] : NULL;
        rbd_real x = c->x[k] + rbdi_rows_push(c, k);
        for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; l && t >= 0; --t, i = m->dof[i].lambda)
            x = x - l[t] * c->x[i];
        c->x[k] = x;
    }
}

#endif
