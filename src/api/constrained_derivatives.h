#ifndef RBDI_API_CONSTRAINED_DERIVATIVES_H
#define RBDI_API_CONSTRAINED_DERIVATIVES_H
#include "api/derivatives.h"
#include "api/constraints.h"

/* ---- derivatives [derivatives] ----
   Declared where rbd_derivatives.h is included too. */

/* Arrays for the results of rbd_constrained_fd_derivatives. NULL: not wanted. */
typedef struct rbd_constrained_fd_results {
    rbd_real *a, *lambda;                             /* nv, rows: as rbd_constrained_fd gives them */
    rbd_real *da_dq, *da_dv, *da_dtau;                /* nv x nv */
    rbd_real *dlambda_dq, *dlambda_dv, *dlambda_dtau; /* rows x nv */
} rbd_constrained_fd_results;

/* Derivatives of the results of rbd_constrained_fd, a (nv x nv) and lambda (rows x nv), by q (column k: q
   moves with unit velocity of dof k), v and tau. f_ext stays fixed in its bodies' axes.
   d            of the same work
   out          da_... each with its dlambda_..., both or neither NULL, also where there are no rows; no two
                the same array
   If rows depend on each other, their rank is taken as constant. da is then unique, and dlambda is the
   change of least norm that belongs to it: the lambda of least norm changes by that and by a null vector of
   J'. Errors: as rbd_constrained_fd; RBD_ERR_INFEASIBLE also if rounding keeps a column of da from meeting
   the derivative of a row, which rbd_infeasible_row names; RBD_ERR_WORK also if d has another work;
   RBD_ERR_NULL. Section 5 of Carpentier, Budhiraja and Mansard (2021), and [derivatives code]. */
RBDI_API rbd_status rbd_constrained_fd_derivatives(const rbd_model *m, rbd_constraint_set *c,
                                                   rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                                                   const rbd_real *tau, const rbd_real *f_ext,
                                                   const rbd_constrained_fd_results *out);

#endif
