#ifndef RBDI_API_CONTACT_DERIVATIVES_H
#define RBDI_API_CONTACT_DERIVATIVES_H
#include "api/derivatives.h"
#include "api/contact.h"

#define rbd_contact_step_derivatives RBDI_SYMBOL(rbd_contact_step_derivatives)

/* ---- derivatives [step derivatives] ----
   Declared where rbd_derivatives.h is included too. */

/* Arrays for the results of rbd_contact_step_derivatives. NULL: not wanted. */
typedef struct rbd_contact_step_results {
    rbd_real *q_next, *v_next;                        /* nq, nv: as rbd_contact_step gives them */
    rbd_real *dq_next_dq, *dq_next_dv, *dq_next_dtau; /* nv x nv */
    rbd_real *dv_next_dq, *dv_next_dv, *dv_next_dtau; /* nv x nv */
} rbd_contact_step_results;

/* Makes a step and differentiates q_next (row k: along its dof k) and v_next by q (column k: q moves with
   unit velocity of dof k), v and tau. f_ext stays fixed in its bodies' axes, planes of the world and damping
   as they are. The state of each contact and bounded row is held: where one is about to change, these are the
   derivatives on one side.
   c            with the option `derivatives`
   d            of the same work
   out          dq_next_... each with its dv_next_..., both or neither NULL; no two the same array
   The step and its derivatives are those without the option `momentum`. Beyond two radians a step, where the
   corrections of velocity terms diverge, derivatives are those without the sum of their series.
   If redundant points slip and turn at once, the motion depends on shares of force that are not unique: these
   are derivatives for one choice.
   Errors: as rbd_contact_step; RBD_ERR_WORK also if d has another work; RBD_ERR_MEMORY without the option;
   RBD_ERR_SINGULAR also where impulses have no derivative. Then q_next is q, and all else is 0. */
RBDI_API rbd_status rbd_contact_step_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                                 const rbd_real *q, const rbd_real *v, const rbd_real *tau,
                                                 const rbd_real *f_ext, const rbd_real *damping, rbd_real dt,
                                                 const rbd_contact_step_results *out);

#endif
