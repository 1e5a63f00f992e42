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

/* A constraint between two links. */
typedef struct rbdi_constraint {
    rbd_const R[2][9]; /* frame vectors into link axes, row-major */
    rbdi_c3 p[2];
    rbd_const held[3][RBDI_SIX_ROWS]; /* the axis that each row holds, a column of R[1], by component */
    rbd_const kp, kd;
    int16_t link[2];   /* -1 = world */
    int16_t ancestor;  /* nearest link that carries both or is one of them, -1 = the world */
    int16_t row, rows; /* the first, and how many */
    int16_t angular;   /* number of angular rows, which come first */
    int16_t axis[6];   /* of each row: 0 .. 5 */
    int16_t dofs;      /* number of entries of: */
    int16_t *dof;      /* dofs on the path to one body or both, ascending */
} rbdi_constraint;

/* The rows that a dof may have entries in, first .. end - 1. All others are zero. */
typedef struct rbdi_span {
    int16_t first, end;
} rbdi_span;

struct rbd_constraint_set {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbd_work *w;
    int n, rows, stride;          /* stride: of rows, padded */
    int links;                    /* number of links on a path */
    int infeasible;               /* row, -1 = none */
    int exchanged;                /* whether R is that of [rank], its rows in another order, `chosen` */
    int factored;                 /* whether the factor of M is always used */
    int dirty;                    /* whether Y and R have entries that articulated bodies do not write */
    int moving;                   /* whether dynamics need the velocities of the links' origins */
    rbdi_constraint *constraint;  /* n */
    int16_t *link;                /* links on a path to a body, ascending; none with mimic joints */
    rbdi_span *span;              /* nv: the rows of the constraints whose paths have the dof */
    int16_t *path;                /* nv: scratch, of dofs */
    rbd_real *Y;                  /* nv x stride: J' by dofs, then L^-T J'; or S' K of [articulated] */
    rbd_real *R;                  /* [factor]: rows x stride; [rank]: first nv x stride */
    rbd_real *x, *stack, *before; /* nv each: solution; scratch; the last step of assembly */
    rbd_real *D_inverse;          /* nv: 1/D of M = L'DL */
    rbd_real *b, *lambda, *u, *gamma, *e, *target; /* stride each: right-hand side, solution, J v, gamma,
                                                      position error, wanted J a */
    rbd_real *demand;  /* stride: sum of the squares of b's terms, a measure of its rounding */
    rbd_real *square;  /* stride, [rank]: the square of a row's part that is independent of the rows taken */
    rbd_real *share;   /* stride, [rank]: 1 / the square of the whole row */
    rbd_real *chosen;  /* stride, [rank]: the row with which row t was exchanged */
    rbd_real *inverse; /* stride: 1 / R_tt, 0 where a row depends on those before it */
    rbd_real noise;    /* the square that rounding of J's entries may give a row */
    rbdi_v3 world;     /* acceleration of the world */
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
