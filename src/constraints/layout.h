#ifndef RBDI_CONSTRAINTS_LAYOUT_H
#define RBDI_CONSTRAINTS_LAYOUT_H
#include "model/work.h"
#include "api/constraints.h"

/* ---- layout [layout] ---- */

/* Scalars in the widest SIMD register that the file with the implementation may be compiled for. */
#if defined RBD_LANES || RBDI_REAL_KIND % 3 == 0 || \
    !(defined __x86_64__ || defined __i386__ || defined __aarch64__ || defined _M_X64)
#define RBDI_ROW_BATCH 1
#else
#define RBDI_ROW_BATCH (8 * RBDI_REAL_KIND)
#endif

#define RBDI_SIX_ROWS (RBDI_ROW_BATCH > 6 ? RBDI_ROW_BATCH : 6) /* a constraint's rows, padded to batches */

/* A constraint between two links. */
typedef struct rbdi_constraint {
    rbd_const R[2][9]; /* frame vectors into link axes, row-major */
    rbdi_c3 p[2];
    rbd_const held[3][RBDI_SIX_ROWS]; /* the axis that each row holds, a column of R[1], by component */
    rbd_const kp, kd;
    int16_t link[2];   /* -1 = world */
    int16_t index;     /* in the caller's list */
    int16_t ancestor;  /* nearest link that carries both or is one of them, -1 = the world */
    int16_t row, rows; /* the first, and how many */
    int16_t angular;   /* how many of them are angular; they come first */
    int16_t axis[6];   /* of each row: 0 .. 5 */
    int16_t tip[2];    /* last dof of the path to each body, -1 = none */
    int16_t trunk;     /* number of dofs that both paths begin with */
    int16_t low, end;  /* first row, and behind the last, that move a joint that these move: [articulated] */
    int16_t dofs;      /* number of: */
    int16_t *dof;      /* the path to body 1, root first, then what is only on that to body 2 */
    int16_t block[2];  /* first row block on each side; the world has none */
} rbdi_constraint;

/* Up to a batch of a constraint's rows, on the way from one of its bodies to the common ancestor:
   [articulated]. */
typedef struct rbdi_row_block {
    int16_t row, rows;              /* the first, and how many */
    int16_t at;                     /* link */
    rbd_real K[6 * RBDI_ROW_BATCH]; /* 6 x batch: wrench of each row on that link, its axes */
} rbdi_row_block;

/* The rows that a dof may have entries in, first .. end - 1; what lies beside them is zero. */
typedef struct rbdi_span {
    int16_t first, end;
} rbdi_span;

struct rbd_constraint_set {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbd_work *w;
    int n, rows, stride;          /* stride: of rows, padded */
    int links;                    /* on a path */
    int blocks;                   /* row blocks */
    int infeasible;               /* row of the caller's, -1 = none */
    int exchanged;                /* whether the rows of R are in another order, `chosen` */
    int factored;                 /* whether the factor of M is used always */
    int dirty;                    /* whether Y and R have entries that articulated bodies do not write */
    int moving;                   /* whether velocities of links' origins are wanted, but for impacts */
    rbdi_constraint *constraint;  /* n; a common ancestor farther from the world comes before */
    rbdi_row_block *block;        /* by constraint, side, row */
    int16_t *at;                  /* rows: where each row of the caller's is */
    int16_t *link;                /* those on a path to a body, ascending; none with mimic joints */
    rbdi_span *span, *passed;     /* nv each: rows of the paths from the world; from the common ancestor */
    int32_t *path;                /* nv: of dofs, where their rows of Y start */
    rbd_real *Y;                  /* nv x stride: J' by dofs, then L^-T J'; or S' K of [articulated] */
    rbd_real *R;                  /* [factor]: rows x stride; [rank]: first nv x stride */
    rbd_real *W;                  /* rows x 6: [articulated] */
    rbd_real *x, *stack, *before; /* nv each: solution; of a path, by depth; the last step of assembly */
    rbd_real *D_inverse;          /* nv: 1/D of M = L'DL */
    rbd_real *b, *lambda, *u, *gamma, *e, *target; /* stride each: right-hand side, solution, J v, gamma,
                                                      position error, wanted J a */
    rbd_real *demand; /* stride: sum of the squares of b's terms, a measure of its rounding */
    rbd_real *square, *share,
        *chosen;       /* stride each, [rank]: what is independent, 1 / what there is; exchanges */
    rbd_real *inverse; /* stride: 1 / R_tt, 0 where a row depends on those before it */
    rbd_real levers;   /* 1 + sum of the squares of the links' places */
    rbd_real give;     /* sum of 1/D of the dofs that rows have to do with */
    rbdi_v3 world;     /* acceleration of the world */
};

/* n constraints with so many row blocks at most. */
#define RBDI_CONSTRAINTS_BYTES(nv, n, rows, stride, blocks) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_constraint_set)) + \
     RBDI_ROUND((size_t)(n) * sizeof(rbdi_constraint)) + \
     RBDI_ROUND((size_t)(blocks) * sizeof(rbdi_row_block)) + \
     RBDI_ROUND(((size_t)(nv) * ((size_t)(n) + 1) + (size_t)(rows)) * sizeof(int16_t)) + \
     RBDI_ROUND(2 * (size_t)(nv) * sizeof(rbdi_span)) + RBDI_ROUND((size_t)(nv) * sizeof(int32_t)) + \
     sizeof(rbd_real) * ((size_t)(nv) * ((size_t)(stride) + 4) + RBDI_LARGER(rows, nv) * (size_t)(stride) + \
                         6 * (size_t)(rows) + 11 * (size_t)(stride)))
#define RBDI_LARGER(a, b) ((size_t)(a) > (size_t)(b) ? (size_t)(a) : (size_t)(b))

/* Bytes that suffice for any n constraints that hold this many axes together; and for any number of them. */
#define RBD_CONSTRAINT_SET_SIZE_OF(nv, n, rows) \
    RBDI_CONSTRAINTS_BYTES(nv, n, rows, (rows) + 4 * RBDI_ROW_BATCH, 2 * (rows))
#define RBD_CONSTRAINT_SET_SIZE(nv, rows) RBD_CONSTRAINT_SET_SIZE_OF(nv, rows, rows)

#endif
