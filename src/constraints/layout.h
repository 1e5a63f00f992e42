#ifndef RBDI_CONSTRAINTS_LAYOUT_H
#define RBDI_CONSTRAINTS_LAYOUT_H
#include "model/work.h"
#include "api/constraints.h"

/* Interface: rbdi_constraint, rbdi_span, RBDI_CONSTRAINTS_BYTES, RBDI_LARGER, RBDI_ROW_BATCH, RBDI_SIX_ROWS
   */

/* ---- layout [layout] ---- */

/* Scalars in the widest SIMD register for which the file with the implementation may be compiled. */
#if defined RBD_LANES || RBDI_REAL_KIND % 3 == 0 || RBDI_WIDEST_SIMD == 0
#define RBDI_ROW_BATCH 1
#else
#define RBDI_ROW_BATCH (RBDI_WIDEST_SIMD * RBDI_REAL_KIND)
#endif

#define RBDI_SIX_ROWS (RBDI_ROW_BATCH > 6 ? RBDI_ROW_BATCH : 6) /* a constraint's rows, padded to batches */

/* A constraint between two links. Arrays of two: of frame 1 and of frame 2. */
typedef struct rbdi_constraint {
    rbd_const rotation[2][9];         /* vectors of the frame into those of the link, row-major */
    rbdi_c3 position[2];              /* of its origin, link axes */
    rbd_const held[3][RBDI_SIX_ROWS]; /* x, y and z of the axis that each row holds, axes of link 2 */
    rbd_const kp, kd;
    int16_t link[2];   /* -1 = world */
    int16_t ancestor;  /* the nearest common ancestor of the two links, -1 = the world */
    int16_t row, rows; /* the first row in the set, and how many */
    int16_t angular;   /* number of angular rows, which come first */
    int16_t axis[6];   /* of each row: 0 .. 5 */
    int16_t dofs;      /* number of entries of `dof` */
    int16_t *dof;      /* dofs on the path to one body or both, ascending */
} rbdi_constraint;

/* Rows in which a dof may have entries: first .. end - 1. In all others its entries are 0. */
typedef struct rbdi_span {
    int16_t first, end;
} rbdi_span;

/* Scratch with an entry for each dof, and for each row. Its users never need it at the same time. */
typedef union rbdi_dof_scratch {
    rbd_real *reflection; /* [rank]: Householder's vector */
    rbd_real *best_x;     /* [refinement] */
} rbdi_dof_scratch;

typedef union rbdi_row_scratch {
    rbd_real *inverse_square; /* [rank]: 1 / the square of the whole row */
    rbd_real *contradicts;    /* [rank]: 1 if a dropped row contradicts those before it */
    rbd_real *best_lambda;    /* [refinement] */
    rbd_real *length;         /* [refinement]: of rows, of J L^-1 */
} rbdi_row_scratch;

struct rbd_constraint_set {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbd_work *w;
    int n, rows, stride; /* constraints; rows; distance of arrays with an entry for each row, padded */
    int links;           /* number of entries of `link` */
    int infeasible;      /* row, -1 = none */
    int pivoted;         /* whether R is that of [rank], its rows in the order of `pivot_row` */
    int factored;        /* whether the factor of M is always used */
    int dirty;           /* whether Y and R have entries that articulated bodies do not write */
    int moving;          /* whether dynamics need the velocities of the links' origins */
    rbdi_constraint *constraint; /* n */
    int16_t *link;               /* links on a path to a body, ascending; none with mimic joints */
    rbdi_span *span;             /* nv: the rows of the constraints whose paths have the dof */
    int16_t *path;               /* nv: scratch, of dofs */
    rbd_real *Y;                 /* nv x stride: J' by dofs, then L^-T J'; or S' K of [articulated] */
    rbd_real *R;                 /* Cholesky factor of Delta, rows x stride; in [rank] first Z, nv x stride */
    rbd_real *x;                 /* nv: right-hand side, then solution */
    rbdi_dof_scratch of_dofs;    /* nv */
    rbd_real *last_step;         /* nv: of assembly */
    rbd_real *D_inverse;         /* nv: 1/D of M = L'DL */
    rbd_real *b, *lambda;        /* stride each: right-hand side and solution of Delta lambda = b */
    rbd_real *velocity, *gamma;  /* stride each: J v; gamma */
    rbd_real *e;                 /* stride: position error */
    rbd_real *target;            /* stride: wanted J x */
    rbd_real *slack;          /* stride: sum of the squares of b's terms; [rank] makes it a tolerance of b */
    rbd_real *square;         /* stride: of a row's part that is independent of those before; a column */
    rbdi_row_scratch of_rows; /* stride */
    rbd_real *pivot_row;      /* stride, [rank]: the row with which row t was exchanged */
    rbd_real *R_inverse;      /* stride: 1 / R_tt, 0 where a row depends on those before it */
    rbd_real noise;           /* a square below which a row's entries may be rounding of J's */
    rbdi_v3 world;            /* acceleration of the world */
};

#define RBDI_CONSTRAINTS_BYTES(nv, n, rows, stride) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_constraint_set)) + \
     RBDI_ROUND((size_t)(n) * sizeof(rbdi_constraint)) + \
     RBDI_ROUND((size_t)(nv) * ((size_t)(n) + 1) * sizeof(int16_t)) + \
     RBDI_ROUND((size_t)(nv) * sizeof(rbdi_span)) + RBDI_ROUND((size_t)(nv) * sizeof(int16_t)) + \
     sizeof(rbd_real) * ((size_t)(nv) * ((size_t)(stride) + 4) + RBDI_LARGER(rows, nv) * (size_t)(stride) + \
                         11 * (size_t)(stride)))
#define RBDI_LARGER(a, b) ((size_t)(a) > (size_t)(b) ? (size_t)(a) : (size_t)(b))

/* Bytes that suffice for any n constraints that hold this many axes together; and for any number of them. */
#define RBD_CONSTRAINT_SET_SIZE_OF(nv, n, rows) \
    RBDI_CONSTRAINTS_BYTES(nv, n, rows, (rows) + 4 * RBDI_ROW_BATCH)
#define RBD_CONSTRAINT_SET_SIZE(nv, rows) RBD_CONSTRAINT_SET_SIZE_OF(nv, rows, rows)

#endif
