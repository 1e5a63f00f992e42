#ifndef RBDI_DYNAMICS_ROW_SUMS_H
#define RBDI_DYNAMICS_ROW_SUMS_H
#include "model/layout.h"
#include "base/simd.h"

/* Interface: rbdi_multiply, rbdi_subtract, rbdi_subtract_product, RBDI_ROW */

/* ---- packed matrix of a tree [packed matrix] ----
   M is symmetric, and entry (i, j) is zero unless one dof is on the path of the other to the root. Row k is
   packed: it has the dofs on k's path only, root first, the diagonal last (dof[k].row, dof[k].depth). M =
   L'DL with L unit lower triangular, RBDA section 6.5: the leaves are eliminated first, so that no zero
   fills. The factor replaces M: L below the diagonal, 1/D on it.

     rbdi_factor            M = L'DL, in place; the pivots D go to w->pivot
     rbdi_solve             x = M^-1 x
     rbdi_solve_columns     X = M^-1 X or -M^-1 X, n columns
     rbdi_invert            Z = M^-1, full
     rbdi_subtract_product  y -= X' x
     rbdi_subtract          y -= factor x
     rbdi_multiply          y *= factor

   A solution has two halves: _transposed, L' y = x from the leaves to the root, then _forward, L x = y / D
   from the root to the leaves. The scratch is w->F and, for places of rows, w->start.

   In depth-first order, m->node, the descendants of a dof follow it. Every result is a row less a sum of
   other rows times factors: the rows of the descendants (factor, first half of a solution) or of the path
   (second half, inverse). The result stays in registers, up to RBDI_ROW batches of it, and the others are
   read from memory; the row computed just before comes last, because the processor must wait for it.
   Batches are counted from the first column; the last one ends with the last column and may overlap the one
   before it. Fewer columns than a batch are computed one by one.

   This room has the sums of rows, packed.h the factor and what it solves. */

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

/* Batches of a row that stay in registers. */
#if RBDI_BATCH > 1 || defined RBD_LANES
#define RBDI_ROW 8
#else
#define RBDI_ROW 4
#endif
/* RBDI_BY_NUMBER(const int batches, most, n, call) makes the call with n in a constant that it declares, here
   `batches`, which the compiler knows; 1 <= n <= most <= RBDI_ROW. Each number is a copy of the code. */
#if RBDI_FOR_SPEED
#define RBDI_BY_NUMBER(constant, most, n, call) \
    switch (n) { \
        RBDI_OF_NUMBER(constant, most, 1, call) \
        RBDI_OF_NUMBER(constant, most, 2, call) \
        RBDI_OF_NUMBER(constant, most, 3, call) \
        RBDI_OF_NUMBER(constant, most, 4, call) \
        RBDI_OF_NUMBER(constant, most, 5, call) \
        RBDI_OF_NUMBER(constant, most, 6, call) \
        RBDI_OF_NUMBER(constant, most, 7, call) \
        RBDI_OF_NUMBER(constant, most, 8, call) \
    }
#define RBDI_OF_NUMBER(constant, most, n, call) \
    case n: { \
        constant = n <= (most) ? n : 1; \
        if (n <= (most)) call; \
    } break;
#else
#define RBDI_BY_NUMBER(constant, most, n, call) \
    do { \
        constant = n; \
        call; \
    } while (0);
#endif

/* n rows and their factors, to be subtracted from a row y. Row t and its factor are, for

     RBDI_ELIMINATED   rbdi_factor: at X + node[t].row; factor x[t] times the row's entry in column d
     RBDI_DESCENDANTS  the first half of a solution: at X + start[t]; factor x[node[t].row]
     RBDI_PATH         the second half: at X + start[t]; factor x[t]; y is multiplied by scale before
     RBDI_FRESH        rbdi_invert: the same, y is 0 before
     RBDI_EQUIDISTANT  rbdi_subtract_product: at X + t stride; factor x[t]

   Each sets the fields that it uses. Y: a second matrix with its rows at the same places. */
enum { RBDI_ELIMINATED, RBDI_DESCENDANTS, RBDI_PATH, RBDI_FRESH, RBDI_EQUIDISTANT };

typedef struct rbdi_terms {
    const rbd_real *X, *Y; /* the matrices with the rows */
    const rbd_real *x;     /* factors */
    const rbdi_node *node;
    const ptrdiff_t *start; /* where rows start */
    ptrdiff_t stride;
    rbd_real scale;
    int n, d;
} rbdi_terms;

/* Where row t starts, and its factor. */
RBDI_INLINE ptrdiff_t rbdi_start_of(const rbdi_terms *g, int which, int t) {
    if (which == RBDI_EQUIDISTANT) return t * g->stride;
    return which == RBDI_ELIMINATED ? g->node[t].row : g->start[t];
}

RBDI_INLINE rbd_real rbdi_factor_of(const rbdi_terms *g, int which, int t, const rbd_real *row) {
    if (which == RBDI_ELIMINATED) return g->x[t] * row[g->d];
    return g->x[which == RBDI_DESCENDANTS ? g->node[t].row : t];
}

/* y less the rows of X and, with two matrices, z less those of Y: so many batches, the last of which begins
   with column `last`. Descendants come last to first: the row computed just before is the last one. */
RBDI_INLINE void rbdi_subtract_batches(rbdi_terms g, int which, int matrices, int batches, int last,
                                       rbd_real *y, rbd_real *z) {
    rbdi_batch sum[2][RBDI_ROW];

    /* y and z, or 0 */
    RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) {
        RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
            const rbd_real *from = (a > 0 ? z : y) + (b < batches - 1 ? b * RBDI_BATCH : last);
            sum[a][b] = which == RBDI_FRESH ? rbdi_all_lanes(rbdi_zero()) : *(const rbdi_batch *)from;
            if (which == RBDI_PATH) sum[a][b] = sum[a][b] * g.scale;
        }
    }

    /* less x times each row */
    RBDI_UNROLL_TWO for (int i = 0; i < g.n; ++i) {
        const int t = which == RBDI_ELIMINATED || which == RBDI_DESCENDANTS ? g.n - 1 - i : i;
        const rbd_real *row = g.X + rbdi_start_of(&g, which, t),
                       *other = matrices > 1 ? g.Y + rbdi_start_of(&g, which, t) : row;
        const rbd_real x = rbdi_factor_of(&g, which, t, row);

        RBDI_ONE_INDEX(row);
        if (matrices > 1) RBDI_ONE_INDEX(other);

        RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) {
            RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
                const rbd_real *from = (a > 0 ? other : row) + (b < batches - 1 ? b * RBDI_BATCH : last);
                sum[a][b] = sum[a][b] - *(const rbdi_batch *)from * x;
            }
        }
    }

    RBDI_UNROLL_ROW for (int a = 0; a < matrices; ++a) {
        RBDI_UNROLL_ROW for (int b = 0; b < batches; ++b) {
            rbd_real *to = (a > 0 ? z : y) + (b < batches - 1 ? b * RBDI_BATCH : last);
            *(rbdi_batch *)to = sum[a][b];
        }
    }
}

/* The same of one matrix with n columns, fewer than a batch. */
RBDI_INLINE void rbdi_subtract_scalars(rbdi_terms g, int which, int n, rbd_real *y) {
    rbd_real sum[RBDI_BATCH];

    RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) {
        sum[b] = which == RBDI_FRESH ? rbdi_zero() : y[b];
        if (which == RBDI_PATH) sum[b] = sum[b] * g.scale;
    }

    RBDI_UNROLL_TWO for (int i = 0; i < g.n; ++i) {
        const int t = which == RBDI_ELIMINATED || which == RBDI_DESCENDANTS ? g.n - 1 - i : i;
        const rbd_real *row = g.X + rbdi_start_of(&g, which, t), x = rbdi_factor_of(&g, which, t, row);
        RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) sum[b] = sum[b] - row[b] * x;
    }

    RBDI_UNROLL_ROW for (int b = 0; b < n; ++b) y[b] = sum[b];
}

/* The same for any number of columns. */
RBDI_INLINE void rbdi_subtract_columns(rbdi_terms g, int which, int n, rbd_real *y) {
    while (n > 0) {
        const int columns = n < RBDI_ROW * RBDI_BATCH ? n : RBDI_ROW * RBDI_BATCH;
        if (columns >= RBDI_BATCH)
            RBDI_BY_NUMBER(const int batches, RBDI_ROW, (columns + RBDI_BATCH - 1) / RBDI_BATCH,
                           rbdi_subtract_batches(g, which, 1, batches, columns - RBDI_BATCH, y, y))
        else
            RBDI_BY_NUMBER(const int scalars, RBDI_BATCH - 1, columns,
                           rbdi_subtract_scalars(g, which, scalars, y))

        n -= columns;
        y += columns;
        g.X += columns;
        g.d -= columns;
    }
}

/* y -= X' x, for the count x n matrix X. */
RBDI_PART void rbdi_subtract_product(const rbd_real *x, const rbd_real *X, int count, int n, rbd_real *y) {
    rbdi_terms g;
    g.X = X;
    g.x = x;
    g.n = count;
    g.d = 0;
    g.stride = n;
    rbdi_subtract_columns(g, RBDI_EQUIDISTANT, n, y);
}

#endif
