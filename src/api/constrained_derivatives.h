#ifndef RBDI_API_CONSTRAINED_DERIVATIVES_H
#define RBDI_API_CONSTRAINED_DERIVATIVES_H
#include "api/derivatives.h"
#include "api/constraints.h"

/* ---- derivatives [derivatives] ----
   Declared where rbd_derivatives.h was included before, and is not left out in parts: RBD_NO_DERIVATIVES and
   RBD_NO_POINTS leave this out too. */

/* Derivatives of rbd_constrained_fd: what a step of q (column k: q moves with unit velocity of dof k), v or
   tau changes of a, nv x nv, and of lambda, rows x nv. f_ext stays fixed in its bodies' axes.
   d            of the same work
   a, lambda    as rbd_constrained_fd gives them; each may be NULL
   da_...       each with its dlambda_..., both or neither NULL, also where there are no rows; no two the
                same array
   Of dependent rows the rank shall stay as it is. da is then unique; dlambda the change of least norm, of all
   that go with da: the solution of least norm changes by that and by a null vector of J'.
   Errors: as rbd_constrained_fd; RBD_ERR_WORK also if d has another work; RBD_ERR_NULL. Section 5 of
   Carpentier, Budhiraja and Mansard (2021), and [derivatives code]. */
RBD_API rbd_status rbd_constrained_derivatives(const rbd_model *m, rbd_constraints *c, rbd_derivatives *d,
                                               const rbd_real *q, const rbd_real *v, const rbd_real *tau,
                                               const rbd_real *f_ext, rbd_real *a, rbd_real *lambda,
                                               rbd_real *da_dq, rbd_real *da_dv, rbd_real *da_dtau,
                                               rbd_real *dlambda_dq, rbd_real *dlambda_dv,
                                               rbd_real *dlambda_dtau);

#endif
