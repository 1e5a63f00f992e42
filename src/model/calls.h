#ifndef RBDI_MODEL_CALLS_H
#define RBDI_MODEL_CALLS_H
#include "api/status.h"
#include "model/work.h"
#include "model/features.h"

/* Interface: rbdi_check, rbdi_check_dynamics, rbdi_has_shape, rbdi_stride */

/* Whether memory that was made for a model of this shape has the arrays' lengths that the model needs.
   The model's address is not compared: another model may have been built there, and one table may stand
   at two. */
RBDI_INLINE int rbdi_has_shape(const rbd_model *m, const uint64_t shape[RBDI_SHAPE]) {
    return m->shape[0] == shape[0] && m->shape[1] == shape[1] && m->shape[2] == shape[2];
}

/* The first check of every call with a model and a work. arrays: none of the caller's required ones is
   NULL. The program must support the model, and the work must fit it. */
RBDI_INLINE rbd_status rbdi_check(const rbd_model *m, const rbd_work *w, int arrays) {
    if (!m || !w || !arrays) return RBD_ERR_NULL;
    return rbdi_supported(m) && rbdi_has_shape(m, w->shape) ? RBD_OK : RBD_ERR_WORK;
}

/* Why a model's dynamics cannot be computed. */
RBDI_COLD rbd_status rbdi_no_dynamics(const rbd_model *m, const rbd_work *w) {
    const rbd_status status = rbdi_check(m, w, 1);
    return status ? status : RBD_ERR_MASSLESS;
}

/* rbdi_check of a call that needs masses. */
RBDI_INLINE rbd_status rbdi_check_dynamics(const rbd_model *m, const rbd_work *w, int arrays) {
    if (!m || !w || !arrays) return RBD_ERR_NULL;
    if (!rbdi_missing(m) && rbdi_has_shape(m, w->shape)) return RBD_OK;
    return rbdi_no_dynamics(m, w);
}

/* From one component of the wrenches in w->F to the next. */
RBDI_INLINE ptrdiff_t rbdi_stride(const rbd_model *m) { return RBDI_STRIDE(m->nv + m->nmimic); }

#endif
