#ifndef RBDI_CONSTRAINTS_SOLUTION_H
#define RBDI_CONSTRAINTS_SOLUTION_H
#include "algebra/vectors.h"
#include "dynamics/packed.h"
#include "constraints/layout.h"

/* ---- solution [solution] ---- */

/* y_t -= l_t x, batches one behind the other. */
RBDI_INLINE void rbdi_subtract_path(rbd_real *y, const rbd_real *l, rbdi_batch x, int n) {
    RBDI_UNROLL_TWO for (int t = 0; t < n; ++t) {
        rbdi_batch *row = (rbdi_batch *)&y[t * RBDI_BATCH];
        *row = *row - x * l[t];
    }
}

/* The dofs that a constraint's rows of L^-T J' reach, root first: the path to body 1, then what is only on
   that to body 2. Returns their number. */
RBDI_INLINE int rbdi_lay_path(const rbd_model *m, const rbd_constraints *c, const rbdi_constraint *k) {
    int n = 0;
    for (int side = 0; side < 2; ++side) {
        const int first = side ? k->trunk : 0, base = n - first;
        for (int i = k->tip[side]; i >= 0 && m->dof[i].depth >= first; i = m->dof[i].lambda, ++n)
            c->path[base + m->dof[i].depth] = (int32_t)(i * c->stride),
                           c->stack[base + m->dof[i].depth] = c->D_inverse[i];
    }
    return n;
}

/* Y = L^-T Y, if there is an L, of a batch of a constraint's rows, and b = target - Y'x. The bodies' own
   parts of the path, which do not know each other, come before what they share. The lanes behind the rows
   are those of the next constraint, and still zero. */
RBDI_INLINE void rbdi_sweep_up(const rbd_model *m, const rbd_constraints *c, const rbdi_constraint *k, int r,
                               const rbd_real *L, int n) {
    const int one = k->tip[0] < 0 ? 0 : m->dof[k->tip[0]].depth + 1;
    const rbdi_dof *dof = m->dof;
    const rbd_real *x = c->x;
    const int32_t *path = c->path;
    rbd_real *Y = c->Y + r, *P = c->P;
    rbdi_batch b = *(const rbdi_batch *)&c->target[r], demand = b * b;
    int t = n - 1;
    for (int u = 0; u < n; ++u) *(rbdi_batch *)&P[u * RBDI_BATCH] = *(const rbdi_batch *)&Y[path[u]];
    for (int side = 1; side >= 0; --side)
        for (int i = k->tip[side], end = side ? one : 0; t >= end; --t, i = dof[i].lambda) {
            const rbdi_batch y = *(const rbdi_batch *)&P[t * RBDI_BATCH];
            b = b - y * x[i];
            demand = demand + (y * x[i]) * (y * x[i]);
            if (!L) continue;
            *(rbdi_batch *)&Y[path[t]] = y;
            rbdi_subtract_path(P, L + dof[i].row, y, side ? k->trunk : t);
            if (side) rbdi_subtract_path(&P[one * RBDI_BATCH], L + dof[i].row + k->trunk, y, t - one);
        }
    *(rbdi_batch *)&c->b[r] = b;
    *(rbdi_batch *)&c->demand[r] = demand;
}

/* Adds the squares of a constraint's levers, from above. */
RBDI_INLINE void rbdi_add_levers(rbd_constraints *c, const rbdi_constraint *k) {
    for (int side = 0; side < 2; ++side)
        if (k->link[side] >= 0)
            c->levers = c->levers + rbdi_dot(c->w->kin[k->link[side]].X.r, c->w->kin[k->link[side]].X.r);
}

/* Of a constraint: L^-T J' from J', and b. */
static void rbdi_reduce_constraint(const rbd_model *m, rbd_constraints *c, const rbdi_constraint *k,
                                   const rbd_real *L) {
    const int n = rbdi_lay_path(m, c, k);
    for (int r = k->row; r < k->row + k->rows; r += RBDI_BATCH) rbdi_sweep_up(m, c, k, r, L, n);
}

/* sum of x_k y_k */
RBDI_INLINE rbd_real rbdi_rows_product(const rbd_real *x, const rbd_real *y, int n) {
    rbdi_batch lanes = rbdi_zero_batch();
    rbd_real sum = rbdi_zero();
    int k = 0;
    for (; k + RBDI_BATCH <= n; k += RBDI_BATCH)
        lanes = lanes + *(const rbdi_batch *)&x[k] * *(const rbdi_batch *)&y[k];
    if (k > 0) sum = rbdi_sum_lanes(lanes);
    for (; k < n; ++k) sum = sum + x[k] * y[k];
    return sum;
}

/* x = D^-1 L^-T x. Depth first, what is behind a dof comes right after it: one array, of a dof's path by
   depth, has all that the dof loses. */
static void rbdi_sweep_back(const rbd_model *m, rbd_constraints *c, const rbd_real *L) {
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

/* x = L^-1 (x + D^-1 Y lambda), if there is an L. The stack has what of x is on the path to the dof. */
static void rbdi_sweep_down(const rbd_model *m, rbd_constraints *c, const rbd_real *L) {
    rbd_real *x = c->x, *stack = c->stack;
    for (int n = 0; n < m->nv; ++n) {
        const int k = c->order[n], depth = m->dof[k].depth, d = L ? depth : 0;
        const rbdi_span s = c->span[k];
        const rbd_real *y = &c->Y[k * c->stride + s.first], *lambda = &c->lambda[s.first],
                       *l = L ? L + m->dof[k].row : NULL;
        rbdi_batch sum = rbdi_zero_batch();
        rbd_real rest = x[k];
        int t = 0;
        for (int r = 0; r < s.n; r += RBDI_BATCH)
            sum = sum + *(const rbdi_batch *)&y[r] * *(const rbdi_batch *)&lambda[r];
        sum = sum * c->D_inverse[k];
        for (; t + RBDI_BATCH <= d; t += RBDI_BATCH)
            sum = sum - *(const rbdi_batch *)&l[t] * *(const rbdi_batch *)&stack[t];
        for (; t < d; ++t) rest = rest - l[t] * stack[t];
        stack[depth] = x[k] = rest + rbdi_sum_lanes(sum);
    }
}

#endif
