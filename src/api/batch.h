#ifndef RBDI_API_BATCH_H
#define RBDI_API_BATCH_H
#include "api/points.h"

#define rbd_batch_lanes RBDI_OF_SCALAR(rbd_batch_lanes)
#define rbd_batch_size RBDI_OF_SCALAR(rbd_batch_size)
#define rbd_batch_init RBDI_OF_SCALAR(rbd_batch_init)
#define rbd_batch_set_gravity RBDI_OF_SCALAR(rbd_batch_set_gravity)
#define rbd_batch_set_layout RBDI_OF_SCALAR(rbd_batch_set_layout)
#define rbd_batch_rnea RBDI_OF_SCALAR(rbd_batch_rnea)
#define rbd_batch_bias RBDI_OF_SCALAR(rbd_batch_bias)
#define rbd_batch_crba RBDI_OF_SCALAR(rbd_batch_crba)
#define rbd_batch_crba_packed RBDI_OF_SCALAR(rbd_batch_crba_packed)
#define rbd_batch_aba RBDI_OF_SCALAR(rbd_batch_aba)
#define rbd_batch_fd_cholesky RBDI_OF_SCALAR(rbd_batch_fd_cholesky)
#define rbd_batch_minverse RBDI_OF_SCALAR(rbd_batch_minverse)
#define rbd_batch_jacobian RBDI_OF_SCALAR(rbd_batch_jacobian)
#define rbd_batch_momentum RBDI_OF_SCALAR(rbd_batch_momentum)
#define rbd_batch_singular RBDI_OF_SCALAR(rbd_batch_singular)

#define RBDI_BATCH_API RBDI_EXTENSION extern

/* ---- the calls of rbd.h [batch] ---- */

typedef struct rbd_batch rbd_batch; /* scratch of one thread */

/* The order of the states in the arrays of a batch call, inputs and results. Rows are transposed before and
   after the computation; blocks are not. A block has L = rbd_batch_lanes() states, each in a lane:
   component k of state s of a quantity of this width (nq, nv, 6 nb, nv nv and so on) is

       x[(s / L * width + k) * L + s % L]

   An array has whole blocks, n / L rounded up; entries of states beyond the n-th are not read or written.
   Calls are fastest with arrays at multiples of L * sizeof(RBD_REAL) bytes. */
typedef enum rbd_layout {
    RBD_ROWS,  /* x[s * width + k] */
    RBD_BLOCKS /* as above */
} rbd_layout;

RBDI_BATCH_API int rbd_batch_lanes(void); /* the number of states in one block, RBD_LANES */

/* As rbd_work_size, rbd_work_init and rbd_set_gravity, of a batch instead of a work. */
RBDI_BATCH_API size_t rbd_batch_size(const rbd_model *m);
RBDI_BATCH_API rbd_status rbd_batch_init(const rbd_model *m, void *memory, size_t size, rbd_batch **batch);
RBDI_BATCH_API rbd_status rbd_batch_set_gravity(rbd_batch *b, const rbd_const gravity[3]);

/* Sets the layout of all arrays for the calls that follow; it is RBD_ROWS after rbd_batch_init. Both give the
   same bits. Error: RBD_ERR_NULL. */
RBDI_BATCH_API rbd_status rbd_batch_set_layout(rbd_batch *b, rbd_layout layout);

/* As the calls without _batch, for n states. */
RBDI_BATCH_API rbd_status rbd_batch_rnea(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *a, const RBD_REAL *f_ext,
                                         RBD_REAL *tau);
RBDI_BATCH_API rbd_status rbd_batch_bias(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *f_ext, RBD_REAL *c);
RBDI_BATCH_API rbd_status rbd_batch_crba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         RBD_REAL *mass_matrix);
RBDI_BATCH_API rbd_status rbd_batch_crba_packed(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                RBD_REAL *packed);
RBDI_BATCH_API rbd_status rbd_batch_aba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                        const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                        RBD_REAL *a);
RBDI_BATCH_API rbd_status rbd_batch_fd_cholesky(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                                RBD_REAL *a);
RBDI_BATCH_API rbd_status rbd_batch_minverse(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             RBD_REAL *Minv); /* n x nv x nv */

/* rbd_kinematics and then rbd_jacobian, rbd_momentum, with the same body and point in all states. jacobian is
   n x 6 x nv; h and h_dot are n x 6, and each may be NULL. */
RBDI_BATCH_API rbd_status rbd_batch_jacobian(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             int body, const RBD_REAL point[3], rbd_axes axes,
                                             RBD_REAL *jacobian);
RBDI_BATCH_API rbd_status rbd_batch_momentum(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             const RBD_REAL *v, const RBD_REAL *a, RBD_REAL *h,
                                             RBD_REAL *h_dot);

/* Returns, after RBD_ERR_SINGULAR, the first singular state of the last call, else -1. dof, which may be
   NULL, receives its singular degree of freedom, as from rbd_singular_dof. */
RBDI_BATCH_API int rbd_batch_singular(const rbd_batch *b, int *dof);

#endif
