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
    int16_t meet;      /* last link that the paths to both bodies share, -1 = the world */
    int16_t row, rows; /* the first, and how many */
    int16_t angular;   /* how many of them are angular; they come first */
    int16_t axis[6];   /* of each row: 0 .. 5 */
    int16_t tip[2];    /* last dof of the path to each body, -1 = none */
    int16_t trunk;     /* number of dofs that both paths begin with */
    int16_t low;       /* first row that a link between the bodies has to do with */
    int16_t near_low;  /* the same of a limb, else low */
    int16_t strand;    /* its first strand */
} rbdi_constraint;

/* A batch of a constraint's rows, from one of its bodies to where the two sides meet: [articulated]. Side 2
   stands after side 1. */
typedef struct rbdi_strand {
    rbd_real *K;       /* 6 x batch: wrench of each row on the link at hand */
    int16_t row, rows; /* the first, and how many */
    int16_t link;      /* of the body, -1 = world */
    int16_t meet;      /* that of the constraint */
    int16_t open;      /* 0: its limb has taken its rows */
} rbdi_strand;

/* What the strands at a link share: the dofs whose part of Lambda is summed together, its own being one block
   or one of up to six axes in a row that the same strands pass. */
typedef struct rbdi_piece {
    int16_t strands;  /* that pass the link */
    int16_t dofs, at; /* of the piece; where among them the link's begin */
    int16_t posed;    /* whether strands begin on the link or behind it */
} rbdi_piece;

/* Links that only contacts with the world pass, all of them up to the link where these end or other rows come
   in: [limbs]. */
typedef struct rbdi_limb {
    int16_t link;        /* that it hangs on */
    int16_t row, rows;   /* the first, and how many */
    int16_t strand, end; /* strands, of side 1 every other: first, and behind the last */
    int16_t taken;       /* whether its rows have been eliminated there */
} rbdi_limb;

/* The rows that a dof may have entries in, first .. end - 1; what lies beside them is zero. n: in batches. */
typedef struct rbdi_span {
    int16_t first, end, n;
} rbdi_span;

struct rbd_constraints {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbd_work *w;
    int n, rows, stride; /* stride: of rows, padded */
    int strands, limbs;
    int posed;      /* links up to the last that a strand or a link behind it needs the pose of */
    int infeasible; /* row, -1 = none */
    int moving;     /* whether velocities of links' origins are wanted, but for impacts */
    int exchanged;  /* whether the rows of R are in another order, c->chosen */
    int factored;   /* whether the factor of M is used always */
    int used;       /* D may be filled everywhere: by the factor of M, with all poses, or never cleared */
    rbdi_constraint *constraint; /* n, those that meet nearest to the world first */
    int16_t *at;                 /* rows: where each row of the caller's is */
    rbdi_strand *strand;         /* two for each batch of each constraint */
    int16_t *route;              /* for each link, the last first, the strands that pass it */
    rbdi_piece *piece;           /* nl */
    rbdi_limb *limb;             /* n at most, by their links */
    rbd_real *wrench;            /* rows x 8: K where the sides have met, less that of rows before; of limbs
                                    also b and 1/d */
    rbdi_span *span;             /* nv */
    int16_t *order;              /* nv: dofs, depth first */
    int32_t *path;               /* nv: of dofs, where their rows of Y start */
    rbd_real *Y;                 /* nv x stride: J' by dofs, then L^-T J' */
    rbd_real *D; /* Lambda of [articulated], then D L, rows x stride; or R of [rank], nv x stride */
    rbd_real *P; /* nv x RBDI_BATCH: rows of Y, by the path */
    rbd_real *x, *stack,
        *before;         /* nv each: solution; of it what is on a path, by depth; the last step of assembly */
    rbd_real *D_inverse; /* nv: 1/D of M = L'DL */
    rbd_real *b, *lambda, *u, *gamma, *e, *target; /* stride each: right-hand side, solution, J v, gamma,
                                                      position error, wanted J a */
    rbd_real *demand;   /* stride: sum of the squares of b's terms, a measure of its rounding */
    rbd_real *inverse;  /* rows: of the pivots, 0 where a row depends on those before it */
    rbd_real *diagonal; /* rows: of Lambda */
    rbd_real *square, *share,
        *chosen;     /* stride each, [rank]: what is independent, 1 / what there is; exchanges */
    rbd_real levers; /* 1 + sum of the squares of the bodies' places */
    rbd_real give;   /* sum of 1/D of the dofs that rows have to do with */
    rbdi_v3 world;   /* acceleration of the world */
};

/* n constraints; batches: of the rows of each; padded: rows in whole batches. */
#define RBDI_CONSTRAINTS_BYTES(nv, n, rows, stride, batches, padded, batch) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_constraints)) + RBDI_ROUND((size_t)(n) * sizeof(rbdi_constraint)) + \
     RBDI_ROUND(2 * (size_t)(batches) * sizeof(rbdi_strand)) + \
     RBDI_ROUND((size_t)(nv) * sizeof(rbdi_span)) + RBDI_ROUND((size_t)(nv) * sizeof(rbdi_piece)) + \
     RBDI_ROUND((size_t)(n) * sizeof(rbdi_limb)) + \
     RBDI_ROUND(((size_t)(nv) * ((size_t)(batches) + 1) + (size_t)(rows)) * sizeof(int16_t)) + \
     RBDI_ROUND((size_t)(nv) * sizeof(int32_t)) + \
     sizeof(rbd_real) * \
         ((size_t)(nv) * (RBDI_LARGER(stride, padded) + 4 + (batch)) + 12 * (size_t)(padded) + \
          RBDI_LARGER(rows, nv) * (size_t)(stride) + 10 * (size_t)(rows) + 10 * (size_t)(stride)))
#define RBDI_LARGER(a, b) ((size_t)(a) > (size_t)(b) ? (size_t)(a) : (size_t)(b))

/* Bytes that suffice for any n constraints that hold this many axes together; and for any number of them. */
#define RBD_CONSTRAINTS_SIZE_OF(nv, n, rows) \
    RBDI_CONSTRAINTS_BYTES(nv, n, rows, (rows) + 3 * RBDI_ROW_BATCH - 2, rows, \
                           (rows) + (n) * (RBDI_ROW_BATCH - 1), RBDI_ROW_BATCH)
#define RBD_CONSTRAINTS_SIZE(nv, rows) RBD_CONSTRAINTS_SIZE_OF(nv, rows, rows)

#endif
