#ifndef RBDI_API_BATCH_H
#define RBDI_API_BATCH_H
#include "api/points.h"

/* ---- batches [batch] ----
   Many states at once, RBD_LANES of them by each SIMD instruction, from and to ordinary arrays. A file of
   its own implements them, compiled for the SIMD unit at hand:

       #define RBD_LANES 8               (double: 8 with AVX-512, 4 with AVX, 2 else; float: twice that)
       #define RBD_BATCH_IMPLEMENTATION
       #include "rbd.h"

   All other files include rbd.h as ever. In every call n states stand one after the other (unless
   rbd_batch_set_layout says otherwise): q is n x nq, v, a, tau n x nv, f_ext n x nb x 6 or NULL,
   mass_matrix n x nv x nv, packed n x rbd_packed_size(m). With n <= 0 nothing is done.
   Results are those of the single calls, to rounding. Errors: as there; with RBD_ERR_SINGULAR the other
   states' results stand, and rbd_batch_singular names the first that is singular. */

typedef struct rbd_batch rbd_batch; /* scratch of one thread */

/* How the states stand in the arrays of a batch call, inputs and results alike. Rows are transposed on the
   way in and out; blocks are not. A block holds L = rbd_batch_lanes() states lane by lane: component k of
   state s of a quantity of this width (nq, nv, 6 nb, nv nv and so on) is

       x[(s / L * width + k) * L + s % L]

   An array is of whole blocks, n / L rounded up; beyond the n-th state nothing is read or written. Quickest
   at an address that L * sizeof(RBD_REAL) divides. */
typedef enum rbd_layout {
    RBD_ROWS,  /* x[s * width + k] */
    RBD_BLOCKS /* as above */
} rbd_layout;

RBDI_EXTERN_C_BEGIN
RBDI_BATCH_API int rbd_batch_lanes(void); /* how many states go together */

/* Bytes that rbd_batch_init needs for this model, and the call itself: as rbd_work_size, rbd_work_init. */
RBDI_BATCH_API size_t rbd_batch_size(const rbd_model *m);
RBDI_BATCH_API rbd_status rbd_batch_init(const rbd_model *m, void *memory, size_t size, rbd_batch **batch);
RBDI_BATCH_API rbd_status rbd_batch_set_gravity(rbd_batch *b, const rbd_const gravity[3]);

/* The layout of all arrays of the calls that follow, RBD_ROWS after rbd_batch_init. Results are the same bits
   in both. Error: RBD_ERR_NULL. */
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

/* After RBD_ERR_SINGULAR: the first singular state of the last call, else -1; *dof: where (may be NULL). */
RBDI_BATCH_API int rbd_batch_singular(const rbd_batch *b, int *dof);
RBDI_EXTERN_C_CLOSE

#endif
