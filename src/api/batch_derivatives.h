#ifndef RBDI_API_BATCH_DERIVATIVES_H
#define RBDI_API_BATCH_DERIVATIVES_H
#include "api/batch.h"

#define rbd_batch_derivatives_size RBDI_OF_SCALAR(rbd_batch_derivatives_size)
#define rbd_batch_derivatives_init RBDI_OF_SCALAR(rbd_batch_derivatives_init)
#define rbd_batch_momentum_matrix RBDI_OF_SCALAR(rbd_batch_momentum_matrix)
#define rbd_batch_coriolis RBDI_OF_SCALAR(rbd_batch_coriolis)
#define rbd_batch_id_derivatives RBDI_OF_SCALAR(rbd_batch_id_derivatives)
#define rbd_batch_fd_derivatives RBDI_OF_SCALAR(rbd_batch_fd_derivatives)
#define rbd_batch_regressor RBDI_OF_SCALAR(rbd_batch_regressor)

/* ---- the calls of rbd_derivatives.h [derivatives] ---- */

typedef struct rbd_batch_derivatives rbd_batch_derivatives; /* scratch of one thread */

/* Bytes that rbd_batch_derivatives_init needs, and the call itself: as rbd_derivatives_size and _init, of a
   batch b of the model instead of a work. */
RBDI_BATCH_API size_t rbd_batch_derivatives_size(const rbd_model *m);
RBDI_BATCH_API rbd_status rbd_batch_derivatives_init(const rbd_model *m, rbd_batch *b, void *memory,
                                                     size_t size, rbd_batch_derivatives **d);
RBDI_BATCH_API rbd_status rbd_batch_momentum_matrix(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                    const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *matrix,
                                                    RBD_REAL *A_dot_v);
RBDI_BATCH_API rbd_status rbd_batch_coriolis(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                             const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *matrix);
RBDI_BATCH_API rbd_status rbd_batch_id_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                                   const RBD_REAL *f_ext, RBD_REAL *dtau_dq,
                                                   RBD_REAL *dtau_dv, RBD_REAL *mass_matrix);
RBDI_BATCH_API rbd_status rbd_batch_fd_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *da_dq,
                                                   RBD_REAL *da_dv, RBD_REAL *Minv);
RBDI_BATCH_API rbd_status rbd_batch_regressor(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                              const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                              RBD_REAL *regressor);

#endif
