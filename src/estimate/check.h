#ifndef RBDI_ESTIMATE_CHECK_H
#define RBDI_ESTIMATE_CHECK_H
#include "base/scalar.h"
#include "model/calls.h"
#include "estimate/layout.h"

/* ---- estimate checks [estimate checks] ---- */

/* Notes what was refused, unless nobody asks; returns the error. */
RBDI_PART rbd_status rbdi_est_fault(rbd_estimate_fault *fault, rbd_status error, const char *field, int at) {
    if (fault) {
        fault->field = field;
        fault->at = at;
    }
    return error;
}

/* Whether low <= x <= high; not of NaN. */
RBDI_INLINE int rbdi_est_between(rbd_real x, rbd_const low, rbd_const high) { return x >= low && x <= high; }

/* Whether an array is finite. */
RBDI_PART rbd_status rbdi_est_check_finite(const rbd_real *x, int n, const char *name,
                                           rbd_estimate_fault *fault) {
    for (int i = 0; i < n; ++i)
        if (!rbdi_is_finite(x[i])) return rbdi_est_fault(fault, RBD_ERR_NAN, name, i);
    return RBD_OK;
}

/* Whether memory of a model with this shape fits the model. */
RBDI_PART rbd_status rbdi_est_check_shape(const rbd_model *m, const uint64_t shape[RBDI_SHAPE]) {
    return rbdi_has_shape(m, shape) ? RBD_OK : RBD_ERR_WORK;
}

RBDI_PART rbd_status rbdi_est_check_friction(const rbd_joint_friction *f, int n, rbd_estimate_fault *fault) {
    if (!f) return RBD_OK;

    for (int i = 0; i < n; ++i, ++f) {
        if (!rbdi_est_between(f->coulomb, 0, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "coulomb", i);
        if (!rbdi_est_between(f->viscous, 0, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "viscous", i);
        if (!rbdi_est_between(f->offset, -RBDI_EST_LARGE, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "offset", i);
    }
    return RBD_OK;
}

RBDI_PART rbd_status rbdi_est_check_observer_options(const rbd_observer_options *o, int nv,
                                                     rbd_estimate_fault *fault) {
    if (!(o->gain > 0 && o->gain <= RBDI_EST_LARGE)) return rbdi_est_fault(fault, RBD_ERR_RANGE, "gain", -1);
    if (!rbdi_est_between(o->slow, 0, RBDI_EST_LARGE))
        return rbdi_est_fault(fault, RBD_ERR_RANGE, "slow", -1);
    if (!rbdi_est_between(o->share, 0, 1)) return rbdi_est_fault(fault, RBD_ERR_RANGE, "share", -1);
    if (!rbdi_est_between(o->least, 0, RBDI_EST_LARGE))
        return rbdi_est_fault(fault, RBD_ERR_RANGE, "least", -1);
    return rbdi_est_check_friction(o->friction, nv, fault);
}

/* An option is 0, or neither too little nor too large to divide by. */
RBDI_PART rbd_status rbdi_est_check_options(const rbd_estimate_options *o, int nv,
                                            rbd_estimate_fault *fault) {
    const rbd_real values[4] = {o->mass, o->reach, o->friction, o->slow};
    const char *const names[4] = {"mass", "reach", "friction", "slow"};
    const rbd_const little = RBD_C(1) / RBDI_EST_LARGE;

    for (int i = 0; i < 4; ++i)
        if (!rbdi_est_between(values[i], 0, RBDI_EST_LARGE) || (values[i] > 0 && values[i] < little))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, names[i], -1);
    if (!rbdi_est_between(o->forgetting, 0, 1) || (o->forgetting > 0 && o->forgetting < RBD_C(0.5)))
        return rbdi_est_fault(fault, RBD_ERR_RANGE, "forgetting", -1);

    if (!o->noise) return RBD_OK;
    for (int i = 0; i < nv; ++i)
        if (!rbdi_est_between(o->noise[i], little, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "noise", i);
    return RBD_OK;
}

#endif
