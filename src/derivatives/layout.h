#ifndef RBDI_DERIVATIVES_LAYOUT_H
#define RBDI_DERIVATIVES_LAYOUT_H
#include "model/work.h"
#include "api/derivatives.h"

/* ---- layout [layout] ----
   Open for sizes at compile time only. */

typedef struct rbdi_columns rbdi_columns;     /* a batch of dofs: what depends on the state */
typedef struct rbdi_constants rbdi_constants; /* and what does not */

/* Dofs whose parent is the one before them each, or those of one block. */
typedef struct rbdi_run {
    int16_t first, end; /* dofs first .. end - 1, in the solver's order as everywhere here */
    int16_t parent;     /* dof before the first towards the root, -1 = none */
    int16_t block;      /* whether they are those of a block */
    int16_t link;       /* that has the first */
    int16_t origin;     /* first of a root: end of the dofs up to the common origin's link, else 0 */
} rbdi_run;

/* Dof k of the solver. */
typedef struct rbdi_entry {
    int16_t user;   /* the caller's dof: row and column of results */
    int16_t end;    /* end of its subtree */
    int16_t joint;  /* end of the dofs of its link */
    int16_t source; /* what has its velocity: index into v with those of mimic joints appended */
    int16_t parent; /* the dof before it towards the root, -1 = none */
    int16_t batch, lane;
    int16_t laid; /* the dof whose source is the index of this one: dofs in the order of the lanes */
    int32_t at;   /* where its lane of the first component is, in scalars */
    int32_t row;  /* where the caller's row starts in a square matrix */
} rbdi_entry;

/* Of a batch the lanes that have relatives of a dof: bits of those on its path, and behind them of its
   subtree. */
typedef struct rbdi_relatives {
    int32_t at;     /* where the batch is, in scalars; -1 ends a list */
    int16_t row;    /* and in a row of entries */
    int16_t whole;  /* in a dof's first: there is no other batch behind a free base */
    uint64_t lanes; /* as wide as a lane of doubles, which they are compared in */
} rbdi_relatives;
enum { RBDI_ON_PATH = 0, RBDI_IN_SUBTREE = 16 }; /* their first bits: a batch has at most 16 lanes */

struct rbd_derivatives {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    const rbd_model *model;
    rbd_work *work;
    int n, batches, runs;  /* dofs, those of mimic joints too */
    int keep_zeros;        /* of the caller's matrices */
    int base, behind;      /* dofs of a free base, if it is one; batch that begins with the dof behind them */
    rbdi_motion V;         /* of the base, its axes */
    rbdi_v3 up;            /* - gravity there */
    rbdi_columns *columns; /* batches */
    rbdi_constants *constants;
    rbd_real *a;         /* n: acceleration of forward dynamics */
    rbdi_entry *entry;   /* n */
    rbdi_run *run;       /* runs */
    int16_t *origin;     /* nl: the root link whose tree has its origin in this link, else -1 */
    rbdi_relatives *kin; /* n x 3 lists: batches with dofs on a dof's path, with both, of its subtree */
    rbd_const mass;      /* of all bodies that a joint moves */
};

#define RBDI_COLUMN_SIZE 110 /* scalars of a dof in rbdi_columns */
#define RBDI_CONSTANT 17     /* in rbdi_constants */
#if defined RBD_LANES || !(defined __x86_64__ || defined __i386__ || defined __aarch64__ || defined _M_X64)
#define RBDI_SURPLUS 0
#define RBDI_KIN(n, padded) 0
#else
#define RBDI_SURPLUS (2 * RBDI_CHUNK - 2) /* those of a free base and the others to whole batches */
#define RBDI_KIN(n, padded) \
    ((size_t)(n) * ((size_t)(padded) / 2 + 3) * sizeof(rbdi_relatives)) /* from 2 lanes on */
#endif

/* Bytes for nl links and n dofs, padded. */
#define RBDI_DERIVATIVES_BYTES(nl, n, padded) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_derivatives)) + \
     (size_t)(padded) * (RBDI_COLUMN_SIZE * sizeof(rbd_real) + RBDI_CONSTANT * sizeof(rbd_const)) + \
     (size_t)(n) * (sizeof(rbd_real) + sizeof(rbdi_entry)) + \
     (size_t)(nl) * (sizeof(rbdi_run) + sizeof(int16_t)) + RBDI_KIN(n, padded))

/* Bytes that suffice for any model with nb bodies and nv degrees of freedom, without or with mimic joints
   (compile-time bounds; rbd_derivatives_size is exact, and less). */
#define RBD_DERIVATIVES_SIZE(nb, nv) RBDI_DERIVATIVES_BYTES(RBDI_LINKS(nb, nv), nv, (nv) + RBDI_SURPLUS)
#define RBD_DERIVATIVES_SIZE_MIMIC(nb, nv) \
    RBDI_DERIVATIVES_BYTES(RBDI_LINKS(nb, nv), (nb) + (nv), (nb) + (nv) + RBDI_SURPLUS)

#endif
