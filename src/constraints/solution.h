#ifndef RBDI_CONSTRAINTS_SOLUTION_H
#define RBDI_CONSTRAINTS_SOLUTION_H
#include "dynamics/packed.h"
#include "constraints/factor.h"

/* ---- solution [solution] ----
   By the factor of M: the sweeps with L on both sides of [factor] or [rank]. */

/* Y_u -= l_u y, for n dofs whose rows of Y start at path[u]. */
RBDI_INLINE void rbdi_subtract_path(rbd_real *Y, const int32_t *path, const rbd_real *l, rbdi_batch y,
                                    int n) {
    RBDI_UNROLL_TWO for (int u = 0; u < n; ++u) {
        rbdi_batch *row = (rbdi_batch *)&Y[path[u]];
        *row = *row - y * l[u];
    }
}

/* Y = L^-T Y, if there is an L, of a batch of a constraint's rows, and b = target - Y'x. The bodies' own
   parts of the path, which do not know each other, come before what they share. The lanes behind the rows
   are those of the next constraint, and still zero. */
RBDI_INLINE void rbdi_sweep_up(const rbd_model *m, const rbd_constraint_set *c, const rbdi_constraint *k,
                               int r, const rbd_real *L, int n) {
    const int one = k->tip[0] < 0 ? 0 : m->dof[k->tip[0]].depth + 1;
    const rbdi_dof *dof = m->dof;
    const int32_t *path = c->path;
    rbd_real *Y = c->Y + r;
    rbdi_batch b = *(const rbdi_batch *)&c->target[r], demand = b * b;
    int t = n - 1;
    for (int side = 1; side >= 0; --side)
        for (int i = k->tip[side], end = side ? one : 0; t >= end; --t, i = dof[i].lambda) {
            const rbdi_batch y = *(const rbdi_batch *)&Y[path[t]], term = y * c->x[i];
            b = b - term;
            demand = demand + term * term;
            if (!L) continue;
            rbdi_subtract_path(Y, path, L + dof[i].row, y, side ? k->trunk : t);
            if (side) rbdi_subtract_path(Y, path + one, L + dof[i].row + k->trunk, y, t - one);
        }
    *(rbdi_batch *)&c->b[r] = b;
    *(rbdi_batch *)&c->demand[r] = demand;
}

/* Of a constraint: L^-T J' from J', and b. */
static void rbdi_reduce_constraint(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *k,
                                   const rbd_real *L) {
    const int n = rbdi_list_dofs(c, k, 1);
    for (int r = k->row; r < k->row + k->rows; r += RBDI_BATCH) rbdi_sweep_up(m, c, k, r, L, n);
}

/* x = D^-1 L^-T x. Depth first, what is behind a dof comes right after it: one array, of a dof's path by
   depth, has all that the dof loses. */
static void rbdi_sweep_back(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbd_real *x = c->x, *stack = c->stack;
    rbdi_clear(stack, m->nv);
    for (int n = m->nv - 1; n >= 0; --n) {
        const int k = c->order[n], d = m->dof[k].depth;
        const rbd_real *l = &L[m->dof[k].row], y = x[k] + stack[d];
        stack[d] = rbdi_zero();
        rbdi_subtract(stack, y, l, d);
        x[k] = y * l[d];
        c->D_inverse[k] = l[d];
    }
}

/* Y'lambda / D of dof k, whose rows are s. */
RBDI_INLINE rbd_real rbdi_rows_push(const rbd_constraint_set *c, int k, rbdi_span s) {
    const rbd_real *y = &c->Y[k * c->stride], *lambda = c->lambda;
    rbdi_batch sum = *(const rbdi_batch *)&y[s.first] * *(const rbdi_batch *)&lambda[s.first];
    for (int r = s.first + RBDI_BATCH; r < s.end; r += RBDI_BATCH)
        sum = sum + *(const rbdi_batch *)&y[r] * *(const rbdi_batch *)&lambda[r];
    return rbdi_sum_lanes(sum) * c->D_inverse[k];
}

/* x = L^-1 (x + D^-1 Y lambda), if there is an L. The stack has what of x is on the path to the dof. */
static void rbdi_sweep_down(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbd_real *x = c->x, *stack = c->stack;
    for (int n = 0; n < m->nv; ++n) {
        const int k = c->order[n], depth = m->dof[k].depth;
        x[k] = x[k] + rbdi_rows_push(c, k, c->span[k]);
        if (L) x[k] = x[k] - rbdi_rows_product(L + m->dof[k].row, stack, depth);
        stack[depth] = x[k];
    }
}

#endif
