#ifndef RBDI_API_CONSTRAINTS_BATCH_H
#define RBDI_API_CONSTRAINTS_BATCH_H
#include "api/batch.h"
#include "api/constraints.h"

/* ---- batches [batch] ----
   As [batch] of rbd.h, in whose file this header is then included instead: n states one after the other, the
   constraints the same for all. */

typedef struct rbd_batch_constraints rbd_batch_constraints; /* scratch of one thread */

RBDI_EXTERN_C_BEGIN
/* Bytes that rbd_batch_constraints_init needs, and the call itself: as rbd_constraints_size and _init, of a
   batch b of the model instead of a work. */
RBD_BATCH_API size_t rbd_batch_constraints_size(const rbd_model *m, const rbd_constraint *list, int n);
RBD_BATCH_API rbd_status rbd_batch_constraints_init(const rbd_model *m, rbd_batch *b,
                                                    const rbd_constraint *list, int n, void *memory,
                                                    size_t size, rbd_batch_constraints **c,
                                                    rbd_report *report);

/* rbd_constrained_fd. Singular states as elsewhere in batches; RBD_ERR_INFEASIBLE if one has contradicting
   rows, and none after it is singular. */
RBD_BATCH_API rbd_status rbd_batch_constrained_fd(const rbd_model *m, rbd_batch_constraints *c, int n,
                                                  const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                  const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *lambda);
RBDI_EXTERN_C_CLOSE

#endif
