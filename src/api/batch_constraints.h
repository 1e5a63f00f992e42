#ifndef RBDI_API_BATCH_CONSTRAINTS_H
#define RBDI_API_BATCH_CONSTRAINTS_H
#include "api/constraints.h"
#include "api/batch.h"

#define rbd_batch_constraint_set_size RBDI_OF_SCALAR(rbd_batch_constraint_set_size)
#define rbd_batch_constraint_set_init RBDI_OF_SCALAR(rbd_batch_constraint_set_init)
#define rbd_batch_constrained_fd RBDI_OF_SCALAR(rbd_batch_constrained_fd)

/* ---- the calls of rbd_constraints.h [constraints] ----
   All states have the same constraints. */

typedef struct rbd_batch_constraint_set rbd_batch_constraint_set; /* scratch of one thread */

/* Bytes that rbd_batch_constraint_set_init needs, and the call itself: as rbd_constraint_set_size and _init,
   of a batch b of the model instead of a work. */
RBDI_BATCH_API size_t rbd_batch_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n);
RBDI_BATCH_API rbd_status rbd_batch_constraint_set_init(const rbd_model *m, rbd_batch *b,
                                                        const rbd_constraint *list, int n, void *memory,
                                                        size_t size, rbd_batch_constraint_set **c,
                                                        rbd_report *report);

/* rbd_constrained_fd. Singular states as in [conventions]; RBD_ERR_INFEASIBLE if a state has contradicting
   rows and none after it is singular. */
RBDI_BATCH_API rbd_status rbd_batch_constrained_fd(const rbd_model *m, rbd_batch_constraint_set *c, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *lambda);

#endif
