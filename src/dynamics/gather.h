#ifndef RBDI_DYNAMICS_GATHER_H
#define RBDI_DYNAMICS_GATHER_H
#include "dynamics/packed.h"

/* Interface: rbdi_factor_invert, rbdi_gather_rows, rbdi_gathered, rbdi_index, rbdi_solve_sides, RBDI_GATHER,
   RBDI_PLAIN */

#if RBDI_BATCH > 1 || defined RBD_LANES
#define RBDI_GATHER
/* The same, of models whose matrix has the tree of the mechanism, with rows that are gathered: each is
   a sum of rows that stay in memory, and is itself in registers meanwhile, up to RBDI_ROW batches of
   columns of it. The columns go by whole batches from the first on, but for the last batch, which ends
   with the last column; fewer columns than a batch go one by one. The row made just before comes last,
   for it has to be waited for. */
#define RBDI_ROW 12
typedef int32_t rbdi_index __attribute__((may_alias));

typedef struct rbdi_gathered { /* n rows, row t at X + at[t], with the factor x[t] */
    const rbd_real *X, *Y, *x; /* Y: a second set of rows, or NULL */
    const rbdi_index *at, *from;
    int n, d;
} rbdi_gathered;

/* y less the sum of the rows; with RBDI_OWN their factors are x[t] times the row's own entry d, with
   RBDI_COLUMN x[from[t]]. RBDI_SCALED: k y less the sum; RBDI_FRESH: -k times the sum. Of two sets the second
   gives z. Written once for T = one scalar and T = a batch of them. */
enum { RBDI_PLAIN, RBDI_OWN, RBDI_COLUMN, RBDI_SCALED, RBDI_FRESH };
#define RBDI_OF_ROW(T, row) (*(T *)&(row)[b < blocks - 1 ? b * (int)(sizeof(T) / sizeof *(row)) : last])
#define RBDI_BY_BLOCKS(blocks, n, call) \
    switch (n) { \
        RBDI_OF_BLOCKS(blocks, 1, call) \
        RBDI_OF_BLOCKS(blocks, 2, call) \
        RBDI_OF_BLOCKS(blocks, 3, call) \
        RBDI_OF_BLOCKS(blocks, 4, call) \
        RBDI_OF_BLOCKS(blocks, 5, call) \
        RBDI_OF_BLOCKS(blocks, 6, call) \
        RBDI_OF_BLOCKS(blocks, 7, call) \
        RBDI_OF_BLOCKS(blocks, 8, call) \
        RBDI_OF_BLOCKS(blocks, 9, call) \
        RBDI_OF_BLOCKS(blocks, 10, call) \
        RBDI_OF_BLOCKS(blocks, 11, call) \
    default: { \
        enum { blocks = RBDI_ROW }; \
        call; \
    } break; \
    }
#define RBDI_OF_BLOCKS(blocks, n, call) \
    case n: { \
        enum { blocks = n }; \
        call; \
    } break;
#define RBDI_DEFINE_GATHER(name, T) \
    RBDI_INLINE void name##_blocks(rbdi_gathered g, int mode, rbd_real k, int sets, int blocks, int last, \
                                   rbd_real *y, rbd_real *z) { \
        const T zero = {0}; \
        T sum[2][RBDI_ROW]; \
        RBDI_UNROLL_ROW for (int s = 0; s < sets; ++s) RBDI_UNROLL_ROW for (int b = 0; b < blocks; ++b) { \
            const rbd_real *from = s > 0 ? z : y; \
            sum[s][b] = zero; \
            if (mode != RBDI_FRESH) sum[s][b] = RBDI_OF_ROW(const T, from); \
            if (mode == RBDI_SCALED) sum[s][b] = sum[s][b] * k; \
        } \
        RBDI_UNROLL_TWO for (int t = 0; t < g.n; ++t) { \
            const rbd_real *row = g.X + g.at[t], *other = sets > 1 ? g.Y + g.at[t] : row; \
            const rbd_real x = mode == RBDI_COLUMN ? g.x[g.from[t]] \
                               : mode == RBDI_OWN  ? g.x[t] * row[g.d] \
                                                   : g.x[t]; \
            RBDI_ONE_INDEX(row); \
            if (sets > 1) RBDI_ONE_INDEX(other); \
            RBDI_UNROLL_ROW for (int s = 0; s < sets; ++s) \
                RBDI_UNROLL_ROW for (int b = 0; b < blocks; ++b) { \
                const rbd_real *from = s > 0 ? other : row; \
                sum[s][b] = sum[s][b] - RBDI_OF_ROW(const T, from) * x; \
            } \
        } \
        RBDI_UNROLL_ROW for (int s = 0; s < sets; ++s) RBDI_UNROLL_ROW for (int b = 0; b < blocks; ++b) { \
            rbd_real *to = s > 0 ? z : y; \
            if (mode == RBDI_FRESH) sum[s][b] = sum[s][b] * k; \
            RBDI_OF_ROW(T, to) = sum[s][b]; \
        } \
    } \
    RBDI_INLINE void name(rbdi_gathered g, int mode, rbd_real k, int columns, rbd_real *y) { \
        const int width = (int)(sizeof(T) / sizeof *y), last = columns - width; \
        RBDI_BY_BLOCKS(blocks, (columns + width - 1) / width, \
                       name##_blocks(g, mode, k, 1, blocks, last, y, y)) \
    }
RBDI_DEFINE_GATHER(rbdi_gather_scalars, rbd_real)
#if RBDI_BATCH > 1
RBDI_DEFINE_GATHER(rbdi_gather_batches, rbdi_batch)
#endif

RBDI_INLINE void rbdi_gather_sets(rbdi_gathered g, int mode, rbd_real k, int wide, int sets, int blocks,
                                  int last, rbd_real *y, rbd_real *z) {
#if RBDI_BATCH > 1
    if (wide) {
        rbdi_gather_batches_blocks(g, mode, k, sets, blocks, last, y, z);
        return;
    }
#endif
    (void)wide;
    rbdi_gather_scalars_blocks(g, mode, k, sets, blocks, last, y, z);
}
/* Both sets at once if there are registers for them. */
RBDI_INLINE void rbdi_gather_blocks(rbdi_gathered g, int mode, rbd_real k, int wide, int sets, int blocks,
                                    int last, rbd_real *y, rbd_real *z) {
    const int split = sets > 1 && 2 * blocks > RBDI_ROW;
    rbdi_gather_sets(g, mode, k, wide, split ? 1 : sets, blocks, last, y, z);
    g.X = g.Y;
    if (split) rbdi_gather_sets(g, mode, k, wide, 1, blocks, last, z, z);
}

/* The same for the first n columns. */
RBDI_INLINE void rbdi_gather_rows(rbdi_gathered g, int mode, rbd_real k, int n, rbd_real *y) {
    for (int columns; n > 0; n -= columns, y += columns, g.X += columns, g.d -= columns) {
#if RBDI_BATCH > 1
        if (n >= RBDI_BATCH) {
            columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;
            rbdi_gather_batches(g, mode, k, columns, y);
            continue;
        }
#endif
        columns = n < RBDI_ROW ? n : RBDI_ROW;
        rbdi_gather_scalars(g, mode, k, columns, y);
    }
}

/* U = D L in place on packed rows, 1/D on the diagonal: U_i is row i of M less L_ki U_k of all dofs k
   behind i, which in the solver's order stand together. */
RBDI_PART rbdi_mask rbdi_factor_gather(const rbd_model *m, rbd_work *w, rbd_real *H) {
    const int n = m->nv;
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    const rbdi_order *order = m->order;
    const rbdi_link *l = m->link + m->nl - 1;
    rbdi_index *at = (rbdi_index *)w->bias; /* rows and inverse pivots, last dof first */
    rbd_real *inverse = w->F;
    for (int done = 0; done < n; ++done) {
        const rbdi_order o = order[n - 1 - done];
        const rbdi_dof *dof = &m->dof[o.dof];
        rbd_real *row = &H[o.row];
        rbdi_gathered g;
        if (n - 1 - done < l->first) --l;
        g.X = H, g.x = inverse + n - l->end, g.at = at + n - l->end;
        g.n = done - (n - l->end), g.d = dof->depth;
        if (g.n > 0) rbdi_gather_rows(g, RBDI_OWN, rbdi_zero(), g.d + 1, row);
        at[done] = o.row;
        w->pivot[o.dof] = row[g.d];
        inverse[done] = row[g.d] = rbdi_pivot_inverse(row[g.d], dof->scale, &doubt);
    }
    return doubt;
}

/* The rows of the dofs on the path to dof k, root first, k's row being at k stride; at has that of the
   dof before, n of them, as long as it is the same. */
RBDI_INLINE int rbdi_gather_path(const rbdi_dof *dof, int k, int stride, int n, rbdi_index *at) {
    int t = dof[k].depth;
    for (int i = dof[k].lambda; t > 0 && (t > n || at[t - 1] != i * stride); --t, i = dof[i].lambda)
        at[t - 1] = i * stride;
    return dof[k].depth;
}

/* X = sign M^-1 X for one set of columns or two, so many blocks each: L' X = X, gathering from the dofs
   behind, then L X = sign D^-1 X, gathering from those on the path, which the last dofs up to each depth
   are. */
RBDI_INLINE void rbdi_sweep_blocks(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                   int sign, rbd_real *X, rbd_real *Y, int wide, int sets, int blocks,
                                   int last) {
    const int n = m->nv;
    const rbdi_dof *dof = m->dof;
    const rbdi_order *order = m->order;
    const rbdi_link *l = m->link + m->nl - 1;
    rbdi_index *at = (rbdi_index *)w->bias; /* rows of X and of L, last dof first */
    rbdi_index *from = (rbdi_index *)w->F, *path = from + n;
    rbdi_gathered g;
    g.X = X, g.Y = Y, g.from = from, g.d = 0;
    for (int done = 0; done < n; ++done) {
        const rbdi_order o = order[n - 1 - done];
        const ptrdiff_t row = o.dof * stride;
        if (n - 1 - done < l->first) --l;
        g.x = L + dof[o.dof].depth;
        g.at = at + n - l->end, g.from = from + n - l->end, g.n = done - (n - l->end);
        if (g.n > 0)
            rbdi_gather_blocks(g, RBDI_COLUMN, rbdi_zero(), wide, sets, blocks, last, X + row, Y + row);
        at[done] = (rbdi_index)row, from[done] = o.row;
    }
    g.at = path;
    for (int done = n - 1; done >= 0; --done) {
        const rbdi_order o = order[n - 1 - done];
        g.x = L + o.row, g.n = dof[o.dof].depth;
        path[g.n] = at[done];
        rbdi_gather_blocks(g, RBDI_SCALED, sign < 0 ? -g.x[g.n] : g.x[g.n], wide, sets, blocks, last,
                           X + at[done], Y + at[done]);
    }
}
RBDI_PART void rbdi_sweep_gather(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                 int sign, int n, rbd_real *X) {
#if RBDI_BATCH > 1
    if (n >= RBDI_BATCH) {
        RBDI_BY_BLOCKS(blocks, (n + RBDI_BATCH - 1) / RBDI_BATCH,
                       rbdi_sweep_blocks(m, w, L, stride, sign, X, X, 1, 1, blocks, n - RBDI_BATCH))
        return;
    }
#endif
    RBDI_BY_BLOCKS(blocks, n, rbdi_sweep_blocks(m, w, L, stride, sign, X, X, 0, 1, blocks, n - 1))
}
RBDI_PART void rbdi_sweep_both(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride, int sign,
                               int n, rbd_real *X, rbd_real *Y) {
#if RBDI_BATCH > 1
    if (n >= RBDI_BATCH) {
        RBDI_BY_BLOCKS(blocks, (n + RBDI_BATCH - 1) / RBDI_BATCH,
                       rbdi_sweep_blocks(m, w, L, stride, sign, X, Y, 1, 2, blocks, n - RBDI_BATCH))
        return;
    }
#endif
    RBDI_BY_BLOCKS(blocks, n, rbdi_sweep_blocks(m, w, L, stride, sign, X, Y, 0, 2, blocks, n - 1))
}

/* L from U. */
RBDI_PART void rbdi_scale_rows(const rbd_model *m, rbd_real *U) {
    for (int k = 0; k < m->nv; ++k)
        rbdi_multiply(&U[m->dof[k].row], U[m->dof[k].row + m->dof[k].depth], m->dof[k].depth);
}

/* Column k of Z, n x n, from what its row has up to the diagonal. */
RBDI_INLINE void rbdi_mirror(const rbd_real *row, ptrdiff_t n, int k, rbd_real *column) {
    const rbd_real *end = row + k;
    for (; end - row >= 4; row += 4, column += 4 * n)
        column[0] = row[0], column[n] = row[1], column[2 * n] = row[2], column[3 * n] = row[3];
    for (; row != end; ++row, column += n) *column = *row;
}

/* Sum of entries of a column, each times its factor. */
RBDI_INLINE rbd_real rbdi_gather_column(rbdi_gathered g) {
    rbd_real a = rbdi_zero(), b = a;
    RBDI_ONE_INDEX(g.X);
    for (; g.n > 1; g.n -= 2, g.x += 2, g.at += 2)
        a = a + g.x[0] * g.X[g.at[0]], b = b + g.x[1] * g.X[g.at[1]];
    return g.n > 0 ? a + g.x[0] * g.X[g.at[0]] + b : a + b;
}

RBDI_PART void rbdi_inverse_gather(const rbd_model *m, rbd_work *w, const rbd_real *U, rbd_real *Z) {
    const int n = m->nv;
    rbdi_index *at = (rbdi_index *)w->bias;
    rbd_real *row = Z;
    rbdi_gathered g;
    g.at = at, g.n = g.d = 0;
    for (int k = 0; k < n; ++k, row += n) {
        g.n = rbdi_gather_path(m->dof, k, n, g.n, at);
        g.X = Z, g.x = &U[m->dof[k].row];
        rbdi_gather_rows(g, RBDI_FRESH, g.x[g.n], k, row);
        rbdi_mirror(row, n, k, Z + k);
        g.X = Z + k;
        row[k] = g.x[g.n] - g.x[g.n] * rbdi_gather_column(g);
    }
}
#endif

/* X = sign M^-1 X for count (at most 2) sets of n columns, of rows a stride apart. */
RBDI_PART void rbdi_solve_sides(const rbd_model *m, rbd_work *w, const rbd_real *L, ptrdiff_t stride,
                                int sign, int n, rbd_real *const *X, int count) {
#ifdef RBDI_GATHER
    if (!m->nmimic && m->nv * stride <= INT32_MAX) {
        const int most = RBDI_ROW * RBDI_BATCH;
        for (int k = 0, columns; count > 0 && k < n; k += columns) {
            columns = n - k < most ? n - k : most;
            if (count > 1)
                rbdi_sweep_both(m, w, L, stride, sign, columns, X[0] + k, X[1] + k);
            else
                rbdi_sweep_gather(m, w, L, stride, sign, columns, X[0] + k);
        }
        return;
    }
#endif
    (void)w;
    for (int j = 0; j < count; ++j) rbdi_solve_rows(m, L, stride, sign, n, X[j]);
}

/* Factors H in place, as rbdi_factor, and gives Z = M^-1 if Z is not NULL. */
RBDI_PART rbdi_mask rbdi_factor_invert(const rbd_model *m, rbd_work *w, rbd_real *H, rbd_real *Z) {
    rbdi_mask doubt;
#ifdef RBDI_GATHER
    if (!m->nmimic) {
        doubt = rbdi_factor_gather(m, w, H);
        if (Z) rbdi_inverse_gather(m, w, H, Z);
        rbdi_scale_rows(m, H);
        return doubt;
    }
#endif
    doubt = rbdi_factor(m, w, H);
    if (Z) rbdi_inverse(m, H, Z);
    return doubt;
}

#endif
