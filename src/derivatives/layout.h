#ifndef RBDI_DERIVATIVES_LAYOUT_H
#define RBDI_DERIVATIVES_LAYOUT_H
#include "model/work.h"
#include "api/derivatives.h"

/* ---- layout [layout] ----
   Users see it because RBD_DERIVATIVES_SIZE needs its sizes; they need no more of it. */

typedef struct rbdi_columns rbdi_columns;     /* of a batch of dofs: quantities that depend on the state */
typedef struct rbdi_constants rbdi_constants; /* of a batch of dofs: constants */

/* A chain of dofs without branches, each the parent of the next; or the dofs of one block. In this header
   dofs are numbered in the solver's order. */
typedef struct rbdi_segment {
    int16_t first, end; /* its dofs are first .. end - 1 */
    int16_t parent;     /* parent of the first dof, -1 = none */
    int16_t block;      /* whether it is a block */
    int16_t link;       /* link of the first dof */
    int16_t origin;     /* of a root: end of the dofs from it to the link of the common origin; else 0 */
} rbdi_segment;

/* A dof: its entries in the results, and its place among the lanes. */
typedef struct rbdi_entry {
    int16_t user;   /* the caller's dof: row and column of the results */
    int16_t end;    /* end of the dofs of its subtree */
    int16_t joint;  /* end of the dofs of its link */
    int16_t source; /* index of its velocity in v with mimic joints appended */
    int16_t parent; /* -1 = none */
    int16_t batch, lane;
    int16_t of_source; /* inverse of source: the dof whose source is this index */
    int32_t at;        /* index of its scalar in the first field of rbdi_columns, counted from d->columns */
    int32_t row;       /* index of its row in a square matrix */
} rbdi_entry;

/* A batch that has relatives of a dof, ancestors or dofs of its subtree, with a bit for the lane of each. */
typedef struct rbdi_relatives {
    int32_t batch;  /* -1 ends a list */
    int16_t row;    /* index of the batch's first scalar in a row of entries */
    int16_t whole;  /* in the first of a dof's three lists: they have all batches but those of a free base */
    uint64_t lanes; /* as wide as a lane of doubles, with which it is compared */
} rbdi_relatives;
enum { RBDI_ON_PATH = 0, RBDI_IN_SUBTREE = 16 }; /* first bits: a batch has at most 16 lanes */

struct rbd_derivatives {
    uint64_t shape[RBDI_SHAPE]; /* of the model */
    const rbd_model *model;
    rbd_work *work;
    int n;                 /* dofs, with those of mimic joints */
    int batches, segments; /* their numbers */
    int keep_zeros;        /* rbd_keep_zeros */
    int base;              /* dofs of a free base: 6 or 0 */
    int behind;            /* first batch of the dofs behind the base */
    rbdi_motion V;         /* velocity of the base, in its axes; linear 0 where a call leaves it out */
    rbdi_v3 minus_g;       /* -gravity, in the base's axes; 0 where a call leaves it out */
    rbdi_columns *columns; /* batches */
    rbdi_constants *constants;
    rbd_real *a;           /* n, forward dynamics: tau less the bias force, then the acceleration */
    rbdi_entry *entry;     /* n */
    rbdi_segment *segment; /* segments */
    int16_t *origin;       /* nl: root of the tree that has the common origin in this link, else -1 */
    rbdi_relatives
        *relatives;       /* n x 3 lists: batches with dofs on the path only, with both, in the subtree */
    uint64_t *lanes;      /* batches: bits as in rbdi_relatives, of one dof, while the lists are made */
    unsigned char *given; /* n: argument of rbd_hybrid in rbd_id_free_base */
    rbd_const mass;       /* of all bodies that a joint moves */
};

#define RBDI_COLUMN_SIZE 116 /* scalars of a dof in rbdi_columns */
#define RBDI_CONSTANT 17     /* in rbdi_constants */
#if defined RBD_LANES || RBDI_WIDEST_SIMD == 0
#define RBDI_SURPLUS 0
#define RBDI_RELATIVES(n, padded) 0
#else
#define RBDI_SURPLUS (2 * RBDI_CHUNK - 2) /* those of a free base and the others to whole batches */
#define RBDI_RELATIVES(n, padded) \
    ((size_t)(n) * ((size_t)(padded) / 2 + 3) * sizeof(rbdi_relatives) + \
     (size_t)(padded) / 2 * sizeof(uint64_t)) /* from 2 lanes on */
#endif

/* Bytes for nl links and n dofs, padded. */
#define RBDI_DERIVATIVES_BYTES(nl, n, padded) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_derivatives)) + \
     (size_t)(padded) * (RBDI_COLUMN_SIZE * sizeof(rbd_real) + RBDI_CONSTANT * sizeof(rbd_const)) + \
     (size_t)(n) * (sizeof(rbd_real) + sizeof(rbdi_entry) + 1) + \
     (size_t)(nl) * (sizeof(rbdi_segment) + sizeof(int16_t)) + RBDI_RELATIVES(n, padded))

/* Bytes that suffice for any model with nb bodies and nv degrees of freedom, without or with mimic joints
   (compile-time bounds; rbd_derivatives_size is exact, and less). */
#define RBD_DERIVATIVES_SIZE(nb, nv) RBDI_DERIVATIVES_BYTES(RBDI_LINKS(nb, nv), nv, (nv) + RBDI_SURPLUS)
#define RBD_DERIVATIVES_SIZE_MIMIC(nb, nv) \
    RBDI_DERIVATIVES_BYTES(RBDI_LINKS(nb, nv), (nb) + (nv), (nb) + (nv) + RBDI_SURPLUS)

#endif
