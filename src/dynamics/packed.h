#ifndef RBDI_DYNAMICS_PACKED_H
#define RBDI_DYNAMICS_PACKED_H
#include "model/work.h"
#include "base/memory.h"
#include "dynamics/row_sums.h"

/* Interface: rbdi_factor, rbdi_invert, rbdi_mirror, rbdi_solve, rbdi_solve_columns, rbdi_solve_forward,
   rbdi_solve_half, rbdi_solve_transposed, rbdi_vector_forward, rbdi_vector_transposed */

/* -- the factor, and what it solves -- */

/* M = L'DL in place, RBDA table 6.3. First U = D L from the leaves to the root: its row i is row i of M less
   L_ki U_k for all descendants k. Then L = D^-1 U. Returns whether a pivot is in doubt. */
RBDI_PART rbdi_mask rbdi_factor(const rbd_model *m, rbd_work *w, rbd_real *H) {
    const rbdi_node *node = m->node;
    rbd_real *inverse = w->F; /* 1/D, by node */
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
#ifdef RBDI_ROWS /* rbd-codegen: sums of rows are not recorded scalar by scalar */
    if (RBDI_ROWS(factor)(m, w, H)) return doubt;
#endif

    for (int s = m->nv - 1; s >= 0; --s) {
        const rbdi_dof *dof = &m->dof[node[s].dof];
        rbd_real *row = &H[node[s].row];
        const rbd_real whole = row[dof->depth]; /* M_kk */
        rbdi_terms g;

        /* U_i = M_i - sum of L_ki U_k, L_ki = U_ki / D_k */
        g.X = H;
        g.x = inverse + s + 1;
        g.node = node + s + 1;
        g.n = node[s].descendants;
        g.d = dof->depth;
        if (g.n > 0) rbdi_subtract_columns(g, RBDI_ELIMINATED, dof->depth + 1, row);

        doubt = rbdi_or(doubt, rbdi_less(row[dof->depth], whole * RBDI_DOUBT));
        w->pivot[node[s].dof] = row[dof->depth];
        inverse[s] = row[dof->depth] = rbdi_pivot_inverse(row[dof->depth], dof->scale, &doubt);
    }

    /* L = D^-1 U */
    for (int k = 0; k < m->nv; ++k)
        rbdi_multiply(&H[m->dof[k].row], H[m->dof[k].row + m->dof[k].depth], m->dof[k].depth);
    return doubt;
}

/* One vector has functions of its own: its batches are entries of a row, those of many columns below are
   columns. */

/* Solves L' y = x, in place, from the leaves: y_i = x_i - sum over the descendants k of L_ki y_k. `path`, by
   depth on a dof's path, has the sums that its descendants subtract. It is stored as it is loaded, in batches
   and then scalars: the processor would wait for a batch that was stored as scalars. */
RBDI_PART void rbdi_vector_transposed(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    const rbdi_dof *dof = m->dof;
    rbd_real *path = w->F;

    rbdi_clear(path, m->nv + RBDI_BATCH);
    for (const rbdi_node *node = m->node + m->nv - 1; node >= m->node; --node) {
        const int d = dof[node->dof].depth;
        const rbd_real *l = L + node->row, y = x[node->dof] + path[d];
        int t = 0;

        x[node->dof] = y;
#if RBDI_BATCH > 1
        for (; t + RBDI_BATCH <= d; t += RBDI_BATCH)
            *(rbdi_batch *)&path[t] = *(const rbdi_batch *)&path[t] - *(const rbdi_batch *)&l[t] * y;

        if (node->row + t <= m->nh - RBDI_BATCH) {
            rbdi_batch *rest = (rbdi_batch *)&path[t];
            *rest = rbdi_first_lanes(*rest - *(const rbdi_batch *)&l[t] * y, d - t);
            continue;
        }
#endif

        for (; t < d; ++t) path[t] = path[t] - l[t] * y;
        path[d] = rbdi_zero();
    }
}

/* Solves L x = y / D, in place, from the root: x_i = y_i / D_i - sum over the path of L_ij x_j. `path` has
   the results on the path. */
RBDI_PART void rbdi_vector_forward(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    const rbdi_dof *dof = m->dof;
    rbd_real *path = w->F;

    for (const rbdi_node *node = m->node, *end = node + m->nv; node < end; ++node) {
        const int d = dof[node->dof].depth;
        const rbd_real *l = L + node->row;
        rbd_real even = x[node->dof] * l[d], odd = rbdi_zero(); /* two sums: none waits for the other */
        int t = 0;

        for (; t + 1 < d; t += 2) {
            even = even - path[t] * l[t];
            odd = odd - path[t + 1] * l[t + 1];
        }

        if (t < d) even = even - path[t] * l[t];
        x[node->dof] = even + odd;
        path[d] = x[node->dof];
    }
}

RBDI_PART void rbdi_solve(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    rbdi_vector_transposed(m, w, L, x);
    rbdi_vector_forward(m, w, L, x);
}

/* X = L'^-1 X, and with two matrices Y = L'^-1 Y: n columns, in so many batches or, with batches = 0, one
   matrix in scalars. */
RBDI_INLINE void rbdi_columns_transposed(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                         int matrices, int batches, int n, rbd_real *X, rbd_real *Y) {
    ptrdiff_t *start = w->start; /* by node */
    rbdi_terms g;

    g.X = X;
    g.Y = Y;

    for (int s = m->nv - 1; s >= 0; --s) {
        const rbdi_node node = m->node[s];

        start[s] = node.dof * stride;
        g.node = m->node + s + 1;
        g.start = start + s + 1;
        g.x = L + m->dof[node.dof].depth;
        g.n = node.descendants;
        if (g.n == 0) continue;

        if (batches > 0)
            rbdi_subtract_batches(g, RBDI_DESCENDANTS, matrices, batches, n - RBDI_BATCH, X + start[s],
                                  Y + start[s]);
        else
            rbdi_subtract_scalars(g, RBDI_DESCENDANTS, n, X + start[s]);
    }
}

/* Then X = sign L^-1 D^-1 X, and Y likewise. */
RBDI_INLINE void rbdi_columns_forward(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                      ptrdiff_t stride, int matrices, int batches, int n, rbd_real *X,
                                      rbd_real *Y) {
    ptrdiff_t *path = w->start; /* of a dof's path, by depth */
    rbdi_terms g;

    g.X = X;
    g.Y = Y;
    g.start = path;

    for (int s = 0; s < m->nv; ++s) {
        const rbdi_node node = m->node[s];
        const ptrdiff_t own = node.dof * stride;

        g.x = L + node.row;
        g.n = m->dof[node.dof].depth;
        g.scale = sign < 0 ? -g.x[g.n] : g.x[g.n];
        path[g.n] = own;

        if (batches > 0)
            rbdi_subtract_batches(g, RBDI_PATH, matrices, batches, n - RBDI_BATCH, X + own, Y + own);
        else
            rbdi_subtract_scalars(g, RBDI_PATH, n, X + own);
    }
}

/* One of the two. */
RBDI_INLINE void rbdi_columns_half(const rbd_model *m, rbd_work *w, const rbd_real *L, int transposed,
                                   int sign, ptrdiff_t stride, int matrices, int batches, int n, rbd_real *X,
                                   rbd_real *Y) {
    if (transposed)
        rbdi_columns_transposed(m, w, L, stride, matrices, batches, n, X, Y);
    else
        rbdi_columns_forward(m, w, L, sign, stride, matrices, batches, n, X, Y);
}

/* The same for any number n of columns: of one matrix, or of two whose rows have at most RBDI_ROW / 2
   batches. */
RBDI_INLINE void rbdi_solve_half(const rbd_model *m, rbd_work *w, const rbd_real *L, int transposed, int sign,
                                 ptrdiff_t stride, int matrices, int n, rbd_real *X, rbd_real *Y) {
    while (n > 0) {
        const int columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;

        if (matrices > 1 || columns >= RBDI_BATCH)
            RBDI_BY_NUMBER(
                const int batches, RBDI_ROW / matrices, (columns + RBDI_BATCH - 1) / RBDI_BATCH,
                rbdi_columns_half(m, w, L, transposed, sign, stride, matrices, batches, columns, X, Y))
        else
            RBDI_BY_NUMBER(const int scalars, RBDI_BATCH - 1, columns,
                           rbdi_columns_half(m, w, L, transposed, sign, stride, 1, 0, scalars, X, X))
        n -= columns;
        X += columns;
        Y += columns;
    }
}

/* X = L'^-1 X: n columns, with rows a stride apart. */
RBDI_PART void rbdi_solve_transposed(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                     int n, rbd_real *X) {
    rbdi_solve_half(m, w, L, 1, 1, stride, 1, n, X, X);
}

/* X = sign L^-1 D^-1 X. */
RBDI_PART void rbdi_solve_forward(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                  ptrdiff_t stride, int n, rbd_real *X) {
    rbdi_solve_half(m, w, L, 0, sign, stride, 1, n, X, X);
}

/* X = sign M^-1 X: n columns, with rows a stride apart. */
RBDI_PART void rbdi_solve_columns(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                  ptrdiff_t stride, int n, rbd_real *X) {
#ifdef RBDI_ROWS
    if (RBDI_ROWS(solve)(m, L, sign, stride, n, X, NULL)) return;
#endif

    rbdi_solve_transposed(m, w, L, stride, n, X);
    rbdi_solve_forward(m, w, L, sign, stride, n, X);
}

/* Copies k entries of a row into a column of a matrix with n columns. */
RBDI_INLINE void rbdi_mirror(const rbd_real *row, ptrdiff_t n, int k, rbd_real *column) {
    const rbd_real *end = row + k;

    for (; end - row >= 4; row += 4, column += 4 * n) {
        column[0] = row[0];
        column[n] = row[1];
        column[2 * n] = row[2];
        column[3 * n] = row[3];
    }

    for (; row != end; ++row, column += n) *column = *row;
}

/* Z = M^-1. L Z = D^-1 L'^-1 is upper triangular with the diagonal 1/D. So row k of Z, up to the diagonal, is
   a sum over the rows i of the path: Z_kj = - sum L_ki Z_ij for j < k, Z_kk = 1/D_k - sum L_ki Z_ik. */
RBDI_PART void rbdi_invert(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *Z) {
    const int n = m->nv;
    ptrdiff_t *path = w->start; /* of a dof's path, root first */
    rbd_real *row = Z;
    int before = 0;
#ifdef RBDI_ROWS
    if (RBDI_ROWS(invert)(m, L, Z)) return;
#endif

    for (int k = 0; k < n; ++k, row += n) {
        const rbd_real *l = &L[m->dof[k].row];
        const int d = m->dof[k].depth;
        rbd_real even = l[d], odd = rbdi_zero();
        rbdi_terms g;
        int i = m->dof[k].lambda, t = d;

        /* the path differs from that of dof k - 1 in its last entries alone */
        for (; t > 0 && (t > before || path[t - 1] != i * n); i = m->dof[i].lambda) path[--t] = i * n;
        before = d;

        /* Z_kj for j < k, and column k */
        g.X = Z;
        g.start = path;
        g.x = l;
        g.n = d;
        g.d = 0;
        rbdi_subtract_columns(g, RBDI_FRESH, k, row);
        rbdi_mirror(row, n, k, Z + k);

        /* Z_kk */
        for (t = 0; t + 1 < d; t += 2) {
            even = even - l[t] * Z[path[t] + k];
            odd = odd - l[t + 1] * Z[path[t + 1] + k];
        }
        if (t < d) even = even - l[t] * Z[path[t] + k];
        row[k] = even + odd;
    }
}

#endif
