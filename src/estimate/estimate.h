#ifndef RBDI_ESTIMATE_ESTIMATE_H
#define RBDI_ESTIMATE_ESTIMATE_H
#include "base/pieces.h"
#include "estimate/check.h"
#include "estimate/newton.h"
#include "estimate/friction.h"

/* ---- estimate [estimate code] ---- */

RBDI_API size_t rbd_estimate_size(const rbd_model *m) { return m ? RBDI_EST_BYTES(m->nv) : 0; }

/* Lays out the arrays in the memory. */
RBDI_LOCAL rbd_estimate *rbdi_est_lay_out(int nv, void *memory) {
    unsigned char *at = rbdi_aligned(memory);
    rbd_estimate *e = RBDI_CUT(rbd_estimate, 1);

    e->kind = RBDI_CUT(unsigned char, nv);
    e->certain = (rbd_real *)at;
    e->joint = e->certain + nv;
    e->row = e->joint + nv * RBDI_EST_JOINT_TRIANGLE;
    e->y = e->row + nv * RBDI_EST_WHOLE_ROW;
    e->left = e->y + nv * RBDI_EST_TEN;
    return e;
}

/* The option, or its default. */
RBDI_INLINE rbd_real rbdi_est_option(rbd_real given, rbd_const otherwise) {
    return given > 0 ? given : rbdi_set(otherwise);
}

RBDI_LOCAL void rbdi_est_take_options(rbd_estimate *e, const rbd_estimate_options *given) {
    const rbd_real none = rbdi_zero();
    const rbd_real reach = rbdi_est_option(given ? given->reach : none, RBDI_EST_REACH);

    e->scale[0] = rbdi_est_option(given ? given->mass : none, RBDI_EST_MASS);
    e->scale[1] = e->scale[0] * reach;
    e->scale[2] = e->scale[1] * reach;
    e->stiff = 1 / rbdi_est_option(given ? given->friction : none, RBDI_EST_FRICTION);
    e->kept = rbdi_sqrt(rbdi_est_option(given ? given->forgetting : none, RBDI_EST_FORGETTING));
    e->slow = rbdi_est_option(given ? given->slow : none, RBDI_EST_SLOW);

    for (int i = 0; i < e->nv; ++i)
        e->certain[i] = 1 / rbdi_est_option(given && given->noise ? given->noise[i] : none, RBDI_EST_NOISE);
}

/* Which dofs have friction, and which are left out. */
RBDI_LOCAL void rbdi_est_find_kinds(rbd_estimate *e, const rbd_model *m, const unsigned char *left_out) {
    for (int i = 0; i < m->nv; ++i) e->kind[i] = RBDI_EST_RUBS;
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        for (int k = 0; k < u->nv && u->type == RBD_FLOATING; ++k) e->kind[u->iv + k] = RBDI_EST_PLAIN;
    for (int i = 0; i < m->nv; ++i)
        if (left_out && left_out[i]) e->kind[i] = RBDI_EST_LEFT_OUT;
}

/* An unknown payload, of which no sample tells yet. */
RBDI_LOCAL void rbdi_est_begin_load(rbd_estimate *e) {
    rbdi_clear(e->load, RBDI_EST_LOAD_TRIANGLE);
    rbdi_est_begin_ball(e->P);
    e->squares = rbdi_zero();
    e->samples = rbdi_zero();
}

RBDI_API rbd_status rbd_estimate_init(const rbd_model *m, int body, const rbd_estimate_options *options,
                                      void *memory, size_t size, rbd_estimate **estimate,
                                      rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    rbd_estimate *e;
    if (estimate) *estimate = NULL;
    if (!m || !memory || !estimate) return RBD_ERR_NULL;
    if (body < -1 || body >= m->nb) return rbdi_est_fault(fault, RBD_ERR_INDEX, "body", -1);
    if (options) status = rbdi_est_check_options(options, m->nv, fault);
    if (status) return status;
    if (size < rbd_estimate_size(m)) return RBD_ERR_MEMORY;

    e = rbdi_est_lay_out(m->nv, memory);
    for (int k = 0; k < RBDI_SHAPE; ++k) e->shape[k] = m->shape[k];
    e->nv = m->nv;
    e->body = body;
    e->known = body < 0;

    rbdi_est_take_options(e, options);
    rbdi_est_find_kinds(e, m, options ? options->left_out : NULL);
    rbdi_clear(e->joint, m->nv * RBDI_EST_JOINT_TRIANGLE);
    rbdi_est_begin_load(e);
    *estimate = e;
    return RBD_OK;
}

RBDI_API rbd_status rbd_estimate_solve(rbd_estimate *e, rbd_const payload[10], rbd_joint_friction *friction,
                                       rbd_real *misfit) {
    if (!e) return RBD_ERR_NULL;
    if (!e->known) rbdi_est_find_load(e);

    if (payload) rbdi_est_parameters_of(e->P, e->scale, payload);
    for (int k = 0; k < RBDI_EST_TEN && payload && e->known; ++k) payload[k] = RBD_C(0);
    for (int i = 0; i < e->nv && friction; ++i) rbdi_est_solve_friction(e, i, &friction[i]);
    if (misfit) *misfit = e->samples > 0 ? rbdi_sqrt(e->squares / e->samples) : rbdi_zero();
    return RBD_OK;
}

/* The deviations of the parameters are those of sums of entries of P: of the sum c'p |T'^-1 c|. */
RBDI_LOCAL void rbdi_est_load_deviations(const rbd_estimate *e, const rbd_real T[RBDI_EST_LOAD_TRIANGLE],
                                         rbd_const pi[10]) {
    for (int k = 0; k < RBDI_EST_TEN; ++k) {
        rbd_real y[10], c[RBDI_EST_TEN];
        for (int j = 0; j < 10; ++j) y[j] = rbdi_set(j == k ? RBD_C(1) : RBD_C(0));
        rbdi_est_pseudo_factors(y, e->scale, c);
        rbdi_est_solve_lower(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, c);
        pi[k] = (rbd_const)rbdi_sqrt(rbdi_est_sum_of_squares(c, RBDI_EST_TEN));
    }
}

RBDI_API rbd_status rbd_estimate_deviations(const rbd_estimate *e, rbd_const payload[10],
                                            rbd_joint_friction *friction) {
    rbd_real T[RBDI_EST_LOAD_TRIANGLE], deviation[RBDI_EST_FRICTIONS];
    if (!e) return RBD_ERR_NULL;

    for (int k = 0; k < RBDI_EST_TEN && payload && e->known; ++k) payload[k] = RBD_C(0);
    if (!e->known) rbdi_est_load_triangle(e, T);
    if (!e->known && payload) rbdi_est_load_deviations(e, T, payload);

    for (int i = 0; i < e->nv && friction; ++i) {
        rbdi_est_friction_deviations(e, i, T, deviation);
        friction[i].offset = deviation[0];
        friction[i].coulomb = deviation[1];
        friction[i].viscous = deviation[2];
    }
    return RBD_OK;
}

/* Forgets the payload, not the friction, which is kept for the payload that the samples so far tell of. */
RBDI_LOCAL void rbdi_est_forget_load(rbd_estimate *e) {
    rbd_real T[RBDI_EST_LOAD_TRIANGLE];
    rbdi_est_find_load(e);
    rbdi_est_load_triangle(e, T);
    for (int i = 0; i < e->nv; ++i) rbdi_est_forget_load_of(e, i, T);
}

RBDI_LOCAL rbd_status rbdi_est_change_load(rbd_estimate *e, int known) {
    if (!e) return RBD_ERR_NULL;
    if (e->body < 0) return RBD_ERR_INDEX;

    if (!e->known) rbdi_est_forget_load(e);
    rbdi_est_begin_load(e);
    e->known = known;
    return RBD_OK;
}

RBDI_API rbd_status rbd_estimate_grip(rbd_estimate *e) { return rbdi_est_change_load(e, 0); }

RBDI_API rbd_status rbd_estimate_release(rbd_estimate *e) { return rbdi_est_change_load(e, 1); }

#endif
