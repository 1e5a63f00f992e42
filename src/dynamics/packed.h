#ifndef RBDI_DYNAMICS_PACKED_H
#define RBDI_DYNAMICS_PACKED_H
#include "model/work.h"
#include "base/memory.h"

/* Interface: rbdi_factor, rbdi_invert, rbdi_multiply, rbdi_solve, rbdi_solve_columns, rbdi_solve_down,
   rbdi_solve_up, rbdi_subtract, rbdi_subtract_product, rbdi_vector_down, rbdi_vector_up */

/* ---- packed matrix of a tree [packed matrix] ----
   M is symmetric, and entry (i, j) is zero unless one dof is on the path of the other to the root. Row k is
   packed: it has the dofs on k's path only, root first, the diagonal last (dof[k].row, dof[k].depth). M =
   L'DL with L unit lower triangular, RBDA section 6.5: the leaves are eliminated first, so that no zero
   fills. The factor replaces M: L below the diagonal, 1/D on it.

     rbdi_factor          M = L'DL, in place; the pivots D go to w->pivot
     rbdi_solve           x = M^-1 x
     rbdi_solve_columns   X = M^-1 X or -M^-1 X, n columns of one matrix or of two
     rbdi_invert          Z = M^-1, full
     rbdi_subtract_product  y -= X' x
     rbdi_subtract        y -= factor x
     rbdi_multiply        y *= factor
   Their scratch is w->F and, for places of rows, w->start.

   In depth-first order, m->node, the descendants of a dof follow it. Every result is a row less a sum of
   other rows times factors: the rows of the descendants (factor, first half of a solution) or of the path
   (second half, inverse). The result stays in registers, up to RBDI_ROW batches of it, and the others are
   read from memory; the row computed just before comes last, because the processor must wait for it.
   Batches are counted from the first column; the last one ends with the last column and may overlap the one
   before it. Fewer columns than a batch are computed one by one. */

/* y *= factor, a batch at a time. */
RBDI_INLINE void rbdi_multiply(rbd_real *y, rbd_real factor, int n) {
    int j = 0;
#if RBDI_BATCH > 1
    for (; j + RBDI_BATCH <= n; j += RBDI_BATCH) *(rbdi_batch *)&y[j] = *(const rbdi_batch *)&y[j] * factor;
#endif
    for (; j < n; ++j) y[j] = y[j] * factor;
}

/* y -= factor x, a batch at a time. */
RBDI_INLINE void rbdi_subtract(rbd_real *y, rbd_real factor, const rbd_real *x, int n) {
    int j = 0;
#if RBDI_BATCH > 1
    for (; j + RBDI_BATCH <= n; j += RBDI_BATCH)
        *(rbdi_batch *)&y[j] = *(const rbdi_batch *)&y[j] - *(const rbdi_batch *)&x[j] * factor;
#endif
    for (; j < n; ++j) y[j] = y[j] - factor * x[j];
}

#if RBDI_BATCH > 1 || defined RBD_LANES
#define RBDI_ROW 8
#else
#define RBDI_ROW 4
#endif
/* Dispatches on n, 1 <= n <= most <= RBDI_ROW, so that each call compiles with a constant number = n. */
#if RBDI_FOR_SPEED
#define RBDI_BY_NUMBER(number, most, n, call) \
    switch (n) { \
        RBDI_OF_NUMBER(number, most, 1, call) \
        RBDI_OF_NUMBER(number, most, 2, call) \
        RBDI_OF_NUMBER(number, most, 3, call) \
        RBDI_OF_NUMBER(number, most, 4, call) \
        RBDI_OF_NUMBER(number, most, 5, call) \
        RBDI_OF_NUMBER(number, most, 6, call) \
        RBDI_OF_NUMBER(number, most, 7, call) \
        RBDI_OF_NUMBER(number, most, 8, call) \
    }
#define RBDI_OF_NUMBER(number, most, n, call) \
    case n: { \
        enum { number = n <= (most) ? n : 1 }; \
        if (n <= (most)) call; \
    } break;
#else
#define RBDI_BY_NUMBER(number, most, n, call) \
    do { \
        const int number = n; \
        call; \
    } while (0);
#endif

/* n rows and their factors, to be subtracted from a row y. Row t and its factor are
     RBDI_OWN          at X + node[t].row; factor x[t] times the row's entry in column d
     RBDI_DESCENDANTS  at X + start[t]; factor x[node[t].row]
     RBDI_PATH         at X + start[t]; factor x[t]; y is multiplied by scale before
     RBDI_FRESH        the same, y is 0 before
     RBDI_EQUIDISTANT  at X + t stride; factor x[t]
   Y: a second matrix with its rows at the same places. */
enum { RBDI_OWN, RBDI_DESCENDANTS, RBDI_PATH, RBDI_FRESH, RBDI_EQUIDISTANT };
typedef struct rbdi_terms {
    const rbd_real *X, *Y, *x;
    const rbdi_node *node;
    const ptrdiff_t *start; /* where rows start */
    ptrdiff_t stride;
    rbd_real scale;
    int n, d;
} rbdi_terms;

RBDI_INLINE ptrdiff_t rbdi_start_of(const rbdi_terms *g, int which, int t) {
    if (which == RBDI_EQUIDISTANT) return t * g->stride;
    return which == RBDI_OWN ? g->node[t].row : g->start[t];
}
RBDI_INLINE rbd_real rbdi_factor_of(const rbdi_terms *g, int which, int t, const rbd_real *row) {
    if (which == RBDI_OWN) return g->x[t] * row[g->d];
    return g->x[which == RBDI_DESCENDANTS ? g->node[t].row : t];
}

/* y less the rows of X and, with two matrices, z less those of Y: so many batches, the last of which begins
   with column `last`. */
RBDI_INLINE void rbdi_subtract_batches(rbdi_terms g, int which, int matrices, int batches, int last,
                                       rbd_real *y, rbd_real *z) {
    rbdi_batch sum[2][RBDI_ROW];
    RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
        const rbd_real *from = (a > 0 ? z : y) + (b < batches - 1 ? b * RBDI_BATCH : last);
        sum[a][b] = which == RBDI_FRESH ? rbdi_zero_batch() : *(const rbdi_batch *)from;
        if (which == RBDI_PATH) sum[a][b] = sum[a][b] * g.scale;
    }
    RBDI_UNROLL_TWO for (int i = 0; i < g.n; ++i) {
        const int t = which == RBDI_OWN || which == RBDI_DESCENDANTS ? g.n - 1 - i : i;
        const rbd_real *row = g.X + rbdi_start_of(&g, which, t),
                       *other = matrices > 1 ? g.Y + rbdi_start_of(&g, which, t) : row;
        const rbd_real x = rbdi_factor_of(&g, which, t, row);
        RBDI_ONE_INDEX(row);
        if (matrices > 1) RBDI_ONE_INDEX(other);
        RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
            const rbd_real *from = (a > 0 ? other : row) + (b < batches - 1 ? b * RBDI_BATCH : last);
            sum[a][b] = sum[a][b] - *(const rbdi_batch *)from * x;
        }
    }
    RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) *
        (rbdi_batch *)((a > 0 ? z : y) + (b < batches - 1 ? b * RBDI_BATCH : last)) = sum[a][b];
}
/* The same of one matrix with n columns, fewer than a batch. */
RBDI_INLINE void rbdi_subtract_scalars(rbdi_terms g, int which, int n, rbd_real *y) {
    rbd_real sum[RBDI_BATCH];
    RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) {
        sum[b] = which == RBDI_FRESH ? rbdi_zero() : y[b];
        if (which == RBDI_PATH) sum[b] = sum[b] * g.scale;
    }
    RBDI_UNROLL_TWO for (int i = 0; i < g.n; ++i) {
        const int t = which == RBDI_OWN || which == RBDI_DESCENDANTS ? g.n - 1 - i : i;
        const rbd_real *row = g.X + rbdi_start_of(&g, which, t), x = rbdi_factor_of(&g, which, t, row);
        RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) sum[b] = sum[b] - row[b] * x;
    }
    RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) y[b] = sum[b];
}

/* The same for any number of columns. */
RBDI_INLINE void rbdi_subtract_columns(rbdi_terms g, int which, int n, rbd_real *y) {
    for (int columns; n > 0; n -= columns, y += columns, g.X += columns, g.d -= columns) {
        columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;
        if (columns >= RBDI_BATCH)
            RBDI_BY_NUMBER(batches, RBDI_ROW, (columns + RBDI_BATCH - 1) / RBDI_BATCH,
                           rbdi_subtract_batches(g, which, 1, batches, columns - RBDI_BATCH, y, y))
        else
            RBDI_BY_NUMBER(scalars, RBDI_BATCH - 1, columns, rbdi_subtract_scalars(g, which, scalars, y))
    }
}

/* y -= X' x, for the count x n matrix X. */
RBDI_PART void rbdi_subtract_product(const rbd_real *x, const rbd_real *X, int count, int n, rbd_real *y) {
    rbdi_terms g;
    g.X = X, g.x = x, g.n = count, g.d = 0, g.stride = n;
    rbdi_subtract_columns(g, RBDI_EQUIDISTANT, n, y);
}

/* First U = D L: its row i is row i of M less L_ki U_k for all descendants k. Returns whether a pivot is in
   doubt. */
RBDI_PART rbdi_mask rbdi_factor(const rbd_model *m, rbd_work *w, rbd_real *H) {
    const rbdi_node *node = m->node;
    rbd_real *inverse = w->F; /* 1/D, by node */
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
#ifdef RBDI_ROWS /* rbd-codegen: sums of rows are not recorded scalar by scalar */
    if (RBDI_ROWS(factor)(m, w, H)) return doubt;
#endif
    for (int s = m->nv - 1; s >= 0; --s) {
        const rbdi_dof *dof = &m->dof[node[s].dof];
        rbd_real *row = &H[node[s].row], whole; /* M_kk */
        rbdi_terms g;
        g.X = H, g.x = inverse + s + 1, g.node = node + s + 1, g.n = node[s].descendants, g.d = dof->depth;
        whole = row[dof->depth];
        if (g.n > 0) rbdi_subtract_columns(g, RBDI_OWN, dof->depth + 1, row);
        doubt = rbdi_or(doubt, rbdi_less(row[dof->depth], whole * RBDI_DOUBT));
        w->pivot[node[s].dof] = row[dof->depth];
        inverse[s] = row[dof->depth] = rbdi_pivot_inverse(row[dof->depth], dof->scale, &doubt);
    }
    for (int k = 0; k < m->nv; ++k)
        rbdi_multiply(&H[m->dof[k].row], H[m->dof[k].row + m->dof[k].depth], m->dof[k].depth);
    return doubt;
}

/* Solves L' y = x, then L x = y / D. One array, by depth on a dof's path, has first the sums that its
   descendants subtract, then the results on the path. It is stored as it is loaded, in batches and then
   scalars: the processor would wait for a batch that was stored as scalars. */
RBDI_PART void rbdi_vector_up(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
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
RBDI_PART void rbdi_vector_down(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    const rbdi_dof *dof = m->dof;
    rbd_real *path = w->F;
    for (const rbdi_node *node = m->node, *end = node + m->nv; node < end; ++node) {
        const int d = dof[node->dof].depth;
        const rbd_real *l = L + node->row;
        rbd_real even = x[node->dof] * l[d], odd = rbdi_zero(); /* two sums: none waits for the other */
        int t = 0;
        for (; t + 1 < d; t += 2) even = even - path[t] * l[t], odd = odd - path[t + 1] * l[t + 1];
        path[d] = x[node->dof] = t < d ? even - path[t] * l[t] + odd : even + odd;
    }
}
RBDI_PART void rbdi_solve(const rbd_model *m, rbd_work *w, const rbd_real *L, rbd_real *x) {
    rbdi_vector_up(m, w, L, x);
    rbdi_vector_down(m, w, L, x);
}

/* X = L'^-1 X, and so Y: n columns of one matrix or two, by so many batches, or (batches = 0) of one by
   scalars. */
RBDI_INLINE void rbdi_columns_up(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                 int matrices, int batches, int n, rbd_real *X, rbd_real *Y) {
    ptrdiff_t *start = w->start; /* by node */
    rbdi_terms g;
    g.X = X, g.Y = Y;
    for (int s = m->nv - 1; s >= 0; --s) {
        const rbdi_node node = m->node[s];
        start[s] = node.dof * stride;
        g.node = m->node + s + 1, g.start = start + s + 1, g.x = L + m->dof[node.dof].depth;
        g.n = node.descendants;
        if (g.n == 0) continue;
        if (batches > 0)
            rbdi_subtract_batches(g, RBDI_DESCENDANTS, matrices, batches, n - RBDI_BATCH, X + start[s],
                                  Y + start[s]);
        else
            rbdi_subtract_scalars(g, RBDI_DESCENDANTS, n, X + start[s]);
    }
}
/* Then X = sign L^-1 D^-1 X, and so Y. */
RBDI_INLINE void rbdi_columns_down(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                   ptrdiff_t stride, int matrices, int batches, int n, rbd_real *X,
                                   rbd_real *Y) {
    ptrdiff_t *path = w->start; /* of a dof's path, by depth */
    rbdi_terms g;
    g.X = X, g.Y = Y, g.start = path;
    for (int s = 0; s < m->nv; ++s) {
        const rbdi_node node = m->node[s];
        const ptrdiff_t own = node.dof * stride;
        g.x = L + node.row, g.n = m->dof[node.dof].depth;
        g.scale = sign < 0 ? -g.x[g.n] : g.x[g.n];
        path[g.n] = own;
        if (batches > 0)
            rbdi_subtract_batches(g, RBDI_PATH, matrices, batches, n - RBDI_BATCH, X + own, Y + own);
        else
            rbdi_subtract_scalars(g, RBDI_PATH, n, X + own);
    }
}
/* The two of one matrix with any number of columns. */
RBDI_PART void rbdi_solve_up(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride, int n,
                             rbd_real *X) {
    for (int columns; n > 0; n -= columns, X += columns) {
        columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;
        if (columns >= RBDI_BATCH)
            RBDI_BY_NUMBER(batches, RBDI_ROW, (columns + RBDI_BATCH - 1) / RBDI_BATCH,
                           rbdi_columns_up(m, w, L, stride, 1, batches, columns, X, X))
        else
            RBDI_BY_NUMBER(scalars, RBDI_BATCH - 1, columns,
                           rbdi_columns_up(m, w, L, stride, 1, 0, scalars, X, X))
    }
}
RBDI_PART void rbdi_solve_down(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign, ptrdiff_t stride,
                               int n, rbd_real *X) {
    for (int columns; n > 0; n -= columns, X += columns) {
        columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;
        if (columns >= RBDI_BATCH)
            RBDI_BY_NUMBER(batches, RBDI_ROW, (columns + RBDI_BATCH - 1) / RBDI_BATCH,
                           rbdi_columns_down(m, w, L, sign, stride, 1, batches, columns, X, X))
        else
            RBDI_BY_NUMBER(scalars, RBDI_BATCH - 1, columns,
                           rbdi_columns_down(m, w, L, sign, stride, 1, 0, scalars, X, X))
    }
}
/* Both of two matrices with at most half of RBDI_ROW batches of columns. */
RBDI_PART void rbdi_solve_two(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign, ptrdiff_t stride,
                              int n, rbd_real *X, rbd_real *Y) {
    RBDI_BY_NUMBER(batches, RBDI_ROW / 2, (n + RBDI_BATCH - 1) / RBDI_BATCH,
                   (rbdi_columns_up(m, w, L, stride, 2, batches, n, X, Y),
                    rbdi_columns_down(m, w, L, sign, stride, 2, batches, n, X, Y)));
}

/* X = sign M^-1 X, and Y likewise unless it is NULL: n columns, with rows a stride apart. */
RBDI_PART void rbdi_solve_columns(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign,
                                  ptrdiff_t stride, int n, rbd_real *X, rbd_real *Y) {
#ifdef RBDI_ROWS
    if (RBDI_ROWS(solve)(m, L, sign, stride, n, X, Y)) return;
#endif
    if (Y && n >= RBDI_BATCH && 2 * n <= RBDI_ROW * RBDI_BATCH) {
        rbdi_solve_two(m, w, L, sign, stride, n, X, Y);
        return;
    }
    rbdi_solve_up(m, w, L, stride, n, X);
    rbdi_solve_down(m, w, L, sign, stride, n, X);
    if (Y) rbdi_solve_up(m, w, L, stride, n, Y);
    if (Y) rbdi_solve_down(m, w, L, sign, stride, n, Y);
}

/* Copies k entries of a row into a column of a matrix with n columns. */
RBDI_INLINE void rbdi_mirror(const rbd_real *row, ptrdiff_t n, int k, rbd_real *column) {
    const rbd_real *end = row + k;
    for (; end - row >= 4; row += 4, column += 4 * n)
        column[0] = row[0], column[n] = row[1], column[2 * n] = row[2], column[3 * n] = row[3];
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
        for (; t > 0 && (t > before || path[t - 1] != i * n); i = m->dof[i].lambda) path[--t] = i * n;
        before = d;
        g.X = Z, g.start = path, g.x = l, g.n = d, g.d = 0;
        rbdi_subtract_columns(g, RBDI_FRESH, k, row);
        rbdi_mirror(row, n, k, Z + k);
        for (t = 0; t + 1 < d; t += 2)
            even = even - l[t] * Z[path[t] + k], odd = odd - l[t + 1] * Z[path[t + 1] + k];
        row[k] = t < d ? even - l[t] * Z[path[t] + k] + odd : even + odd;
    }
}

#endif
