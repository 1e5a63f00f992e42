#ifndef RBDI_MODEL_CALLS_H
#define RBDI_MODEL_CALLS_H
#include "api/status.h"
#include "model/work.h"
#include "model/features.h"

/* Interface: rbdi_check, rbdi_fits, rbdi_stride */

/* Whether this program supports the model and the work's arrays are as long as it needs them. Not by the
   model's address: another model may have been built there, and the same table may stand at another. */
RBDI_INLINE int rbdi_fits(const rbd_model *m, const rbd_work *w) {
    return rbdi_supported(m) && m->shape[0] == w->shape[0] && m->shape[1] == w->shape[1] &&
           m->shape[2] == w->shape[2];
}

/* Every call with a model and a work asks this first; arrays: none of the caller's required ones is NULL. */
RBDI_INLINE rbd_status rbdi_check(const rbd_model *m, const rbd_work *w, int arrays) {
    if (!m || !w || !arrays) return RBD_ERR_NULL;
    return rbdi_fits(m, w) ? RBD_OK : RBD_ERR_WORK;
}

/* From one component of the wrenches in w->F to the next. */
RBDI_INLINE ptrdiff_t rbdi_stride(const rbd_model *m) { return RBDI_STRIDE(m->nv + m->nmimic); }

#endif
