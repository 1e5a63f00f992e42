#ifndef RBDI_ESTIMATE_OBSERVER_H
#define RBDI_ESTIMATE_OBSERVER_H
#include "api/dynamics.h"
#include "base/pieces.h"
#include "base/memory.h"
#include "estimate/check.h"

/* ---- observer [observer code] ---- */

RBDI_API size_t rbd_observer_size(const rbd_model *m) { return m ? RBDI_EST_OBSERVER_BYTES(m->nv) : 0; }

RBDI_API rbd_status rbd_observer_init(const rbd_model *m, const rbd_observer_options *options, void *memory,
                                      size_t size, rbd_observer **observer, rbd_estimate_fault *fault) {
    unsigned char *at = rbdi_aligned(memory);
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    rbd_observer *o;
    if (observer) *observer = NULL;
    if (!m || !options || !memory || !observer) return RBD_ERR_NULL;
    status = rbdi_est_check_observer_options(options, m->nv, fault);
    if (status) return status;
    if (size < rbd_observer_size(m)) return RBD_ERR_MEMORY;

    o = RBDI_CUT(rbd_observer, 1);
    for (int k = 0; k < RBDI_SHAPE; ++k) o->shape[k] = m->shape[k];
    o->options = *options;
    if (!(o->options.slow > 0)) o->options.slow = rbdi_set(RBDI_EST_OBSERVER_SLOW);

    o->p = (rbd_real *)at;
    o->rate = o->p + m->nv;
    o->r = o->rate + m->nv;
    o->band = o->r + m->nv;
    o->side = o->band + m->nv;
    o->p_next = o->side + m->nv;
    o->rate_next = o->p_next + m->nv;
    o->gravity = o->rate_next + m->nv;
    o->r_next = o->gravity + m->nv;
    o->band_next = o->r_next + m->nv;

    *observer = o;
    return rbd_observer_reset(o);
}

RBDI_API rbd_status rbd_observer_reset(rbd_observer *observer) {
    if (!observer) return RBD_ERR_NULL;
    observer->begun = 0;
    return RBD_OK;
}

/* -1 or 1, the way a dof moves, or 0 at rest. */
RBDI_INLINE rbd_real rbdi_est_way_of(rbd_real v, rbd_real slow) {
    return rbdi_set(v > slow ? RBD_C(1) : v < -slow ? RBD_C(-1) : RBD_C(0));
}

/* p and C'v - g of the state. */
RBDI_LOCAL rbd_status rbdi_est_observe_state(const rbd_model *m, rbd_work *w, rbd_observer *o,
                                             const rbd_real *q, const rbd_real *v) {
    rbd_status status = rbd_generalized_momentum(m, w, q, v, o->p_next, o->rate_next);
    if (!status) status = rbd_gravity_torque(m, w, q, o->gravity);
    for (int i = 0; i < m->nv && !status; ++i) o->rate_next[i] = o->rate_next[i] - o->gravity[i];
    return status;
}

/* The friction of dof i that is subtracted from the motor's torque, and the bound of what this lacks. */
RBDI_LOCAL rbd_real rbdi_est_observed_friction(const rbd_observer *o, int i, rbd_real v, rbd_real *bound) {
    const rbd_joint_friction *f = o->options.friction ? &o->options.friction[i] : NULL;
    const rbd_real side = rbdi_est_way_of(v, o->options.slow);
    const int moves = side * o->side[i] > 0;

    *bound = o->options.least;
    if (!f) return rbdi_zero();

    *bound = *bound + o->options.share * (f->coulomb + f->viscous * rbdi_abs(v));
    if (!moves) {
        *bound = *bound + f->coulomb;
        return f->offset + f->viscous * v;
    }
    return f->offset + f->viscous * v + side * f->coulomb;
}

/* r_next = (r + gain (p_next - p - dt x)) / (1 + gain dt), and the band by the same step. The first step has
   no past: both are 0. */
RBDI_LOCAL void rbdi_est_observe(rbd_observer *o, int nv, const rbd_real *v, const rbd_real *tau,
                                 rbd_real dt) {
    const rbd_real gain = o->options.gain;
    const rbd_real all = 1 + gain * dt;

    for (int i = 0; i < nv; ++i) {
        rbd_real x, friction, bound;
        if (!o->begun) {
            o->r_next[i] = rbdi_zero();
            o->band_next[i] = rbdi_zero();
            continue;
        }

        friction = rbdi_est_observed_friction(o, i, v[i], &bound);
        x = tau[i] - friction + (o->rate[i] + o->rate_next[i]) * RBD_C(0.5);
        o->r_next[i] = (o->r[i] + gain * (o->p_next[i] - o->p[i] - dt * x)) / all;
        o->band_next[i] = (o->band[i] + gain * dt * bound) / all;
    }
}

/* Whether nothing overflowed. */
RBDI_LOCAL rbd_status rbdi_est_check_observed(const rbd_observer *o, int nv, rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_check_finite(o->p_next, nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(o->rate_next, nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(o->r_next, nv, "r", fault);
    return status ? status : rbdi_est_check_finite(o->band_next, nv, "band", fault);
}

/* Nothing was refused: the next state becomes the last. */
RBDI_LOCAL void rbdi_est_observer_commit(rbd_observer *o, int nv, const rbd_real *v) {
    for (int i = 0; i < nv; ++i) {
        o->r[i] = o->r_next[i];
        o->band[i] = o->band_next[i];
        o->p[i] = o->p_next[i];
        o->rate[i] = o->rate_next[i];
        o->side[i] = rbdi_est_way_of(v[i], o->options.slow);
    }
    o->begun = 1;
}

RBDI_LOCAL rbd_status rbdi_est_check_observer_step(const rbd_model *m, const rbd_work *w,
                                                   const rbd_observer *o, const rbd_real *q,
                                                   const rbd_real *v, const rbd_real *tau, rbd_real dt,
                                                   rbd_estimate_fault *fault) {
    rbd_status status = rbdi_check(m, w, o && q && v && tau);
    if (!status) status = rbdi_est_check_shape(m, o->shape);
    if (!status && !(dt > 0 && dt <= RBDI_EST_LARGE)) status = rbdi_est_fault(fault, RBD_ERR_RANGE, "dt", -1);
    if (!status) status = rbdi_est_check_finite(q, m->nq, "q", fault);
    if (!status) status = rbdi_est_check_finite(v, m->nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(tau, m->nv, "tau", fault);
    return status ? status : rbdi_est_check_friction(o->options.friction, m->nv, fault);
}

RBDI_API rbd_status rbd_observer_step(const rbd_model *m, rbd_work *w, rbd_observer *o, const rbd_real *q,
                                      const rbd_real *v, const rbd_real *tau, rbd_real dt, rbd_real *r,
                                      rbd_real *band, rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    status = rbdi_est_check_observer_step(m, w, o, q, v, tau, dt, fault);
    if (!status) status = rbdi_est_observe_state(m, w, o, q, v);
    if (status) return status;

    rbdi_est_observe(o, m->nv, v, tau, dt);
    status = rbdi_est_check_observed(o, m->nv, fault);
    if (status) return status;

    rbdi_est_observer_commit(o, m->nv, v);
    if (r)
        for (int i = 0; i < m->nv; ++i) r[i] = o->r[i];
    if (band)
        for (int i = 0; i < m->nv; ++i) band[i] = o->band[i];
    return RBD_OK;
}

#endif
