#ifndef RBDI_API_BUILD_H
#define RBDI_API_BUILD_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- build [build] ---- */

#define RBD_MAX_BODIES 1000

#ifndef RBD_NO_BUILD

/* Builds a model from a description into the caller's memory.
   bodies   nb rows, parents first; only its strings must outlive the model
   memory   size bytes of any alignment; RBD_MODEL_SIZE(nb) always suffices
   model    receives the model, which lies inside memory: do not move it; NULL after an error
   report   receives the error and the warnings; may be NULL
   Errors: RBD_ERR_NULL, _MEMORY, _COUNT, and all from RBD_ERR_NAME on, with body and field. */
RBDI_API rbd_status rbd_model_build(const rbd_body *bodies, int nb, void *memory, size_t size,
                                    const rbd_model **model, rbd_report *report);

/* Bytes that rbd_model_build needs for this description; 0 if nb is out of range. */
RBDI_API size_t rbd_model_size(const rbd_body *bodies, int nb);

/* Adds mass to a body of a built model, as a new build would see it, at the cost of the way to the root:
   what a hand took up. With what was added negated, takes it off again, to rounding. A rbd_work stays good;
   no call may run meanwhile. A model in a table of constants cannot be changed.
   memory   that was given to rbd_model_build
   mass     kg, may be negative
   com      of the payload, link frame
   inertia  xx xy xz yy yz zz about its com, link axes; NULL = a point
   Errors, the model as it was: RBD_ERR_NULL, _VERSION (no model there), _INDEX; not finite, or of the whole
   then RBD_ERR_MASS negative, RBD_ERR_INERTIA with a negative eigenvalue; RBD_ERR_COM. */
RBDI_API rbd_status rbd_add_payload(void *memory, int body, double mass, const double com[3],
                                    const double inertia[6]);

#endif

#endif
