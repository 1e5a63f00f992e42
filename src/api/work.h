#ifndef RBDI_API_WORK_H
#define RBDI_API_WORK_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- work [work] ---- */

/* Prepares the memory that the algorithms work in; one per thread and model. With a model that needs arrays
   of other lengths, every call returns RBD_ERR_WORK, be it another one or what was built in the memory of
   this one since (a copy of the same model will do).
   memory   size bytes of any alignment; RBD_WORK_SIZE(nb, nv) always suffices, with mimic joints
            RBD_WORK_SIZE_MIMIC(nb, nv)
   work     receives the work structure, which lies inside memory: do not move it
   Errors: RBD_ERR_NULL, _MEMORY, _VERSION, _LEFT_OUT. */
RBDI_API rbd_status rbd_work_init(const rbd_model *m, void *memory, size_t size, rbd_work **work);

/* Bytes that rbd_work_init needs for this model. */
RBDI_API size_t rbd_work_size(const rbd_model *m);

/* Sets gravity, 3 components in the world frame, m/s^2, for the calls that follow. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_set_gravity(rbd_work *w, const rbd_const gravity[3]);

/* What it is set to. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_get_gravity(const rbd_work *w, rbd_const gravity[3]);

/* After RBD_ERR_SINGULAR or RBD_ERR_NAN: the degree of freedom (index into v) whose pivot is not above its
   rounding, or not a number; of several the last. After RBD_ERR_NAN the cause is q of a joint that this dof
   carries, or of its own joint if that has several dofs, or an overflow there. -1 after a call that factors M
   and finds no fault; calls that do not factor it leave it as it is. With lanes: of all states together. */
RBDI_API int rbd_singular_dof(const rbd_work *w);

#endif
