#ifndef RBDI_CONSTRAINTS_CALLS_H
#define RBDI_CONSTRAINTS_CALLS_H
#include "dynamics/rnea.h"
#include "constraints/rank.h"
#include "constraints/articulated.h"

/* ---- call code [call code] ---- */

static rbd_status rbdi_check_constraints(const rbd_model *m, const rbd_constraint_set *c, int arrays) {
    if (!m || !c || !arrays) return RBD_ERR_NULL;
    for (int k = 0; k < RBDI_SHAPE; ++k)
        if (c->shape[k] != m->shape[k]) return RBD_ERR_WORK;
    return rbdi_check(m, c->w, 1);
}

/* x += M^-1 J' lambda with lambda of least norm so that J x = target, from Y = J' and x = D^-1 L^-T
   (right-hand side); L = 1 if NULL. check: whether targets may contradict each other. */
static void rbdi_multipliers(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L, int check) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_reduce_rows(m, c, L);
    c->give = rbdi_zero();
    c->levers = rbdi_set(RBD_C(1));
    for (int k = 0; k < c->n; ++k) rbdi_add_levers(c, &c->constraint[k]);
    for (int k = 0; k < m->nv; ++k) c->give = c->give + c->D_inverse[k];
    c->exchanged = 0, c->infeasible = -1;
    rbdi_clear(c->lambda, c->stride);
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
        doubt = rbdi_or(doubt, rbdi_factor_rows(c, k, 1));
    if (rbdi_any(doubt))
        rbdi_solve_dependent(m, c, check);
    else
        rbdi_back_substitute(c, 0, c->rows, c->rows);
    rbdi_sweep_down(m, c, L);
}

/* M = L'DL of the work's H, and x = D^-1 L^-T x. */
static rbdi_mask rbdi_constrained_factor(const rbd_model *m, rbd_constraint_set *c) {
    const rbdi_mask doubt = rbdi_factor(m, c->w, c->w->H);
    rbdi_sweep_back(m, c, c->w->H);
    return doubt;
}

/* M x = x + J' lambda, J x = target, once the rows are set: the status, and lambda. */
static rbd_status rbdi_constrained_solve(const rbd_model *m, rbd_constraint_set *c, rbdi_mask doubt,
                                         int check, rbd_real *lambda) {
    rbdi_multipliers(m, c, c->w->H, check);
    return rbdi_constrained_status(m, c, rbdi_status_of(m, c->w, doubt, c->x, m->nv), lambda);
}

/* r - gamma, by Baumgarte. */
RBDI_INLINE void rbdi_stabilise(rbd_constraint_set *c, const rbdi_constraint *k) {
    for (int r = k->row; r < k->row + k->rows; r += RBDI_BATCH) {
        rbdi_batch x = rbdi_zero_batch() - *(const rbdi_batch *)&c->gamma[r];
        if (k->kd > 0) x = x - *(const rbdi_batch *)&c->u[r] * k->kd;
        if (k->kp > 0) x = x - *(const rbdi_batch *)&c->e[r] * k->kp;
        *(rbdi_batch *)&c->target[r] = x;
    }
}

static int rbdi_stabilisation(const rbdi_constraint *k) {
    return (k->kd > 0 ? RBDI_HELD_RATES : 0) | (k->kp > 0 ? RBDI_HELD_ERRORS : 0);
}

/* By M = L'DL. */
static rbd_status rbdi_factored_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext, rbd_real *a,
                                   rbd_real *lambda) {
    rbd_work *w = c->w;
    rbdi_mask doubt;
    rbd_status status;
    rbd_crba_packed(m, w, q, w->H);
    rbdi_constraint_state(m, c, rbdi_expand_v(m, v, w->vx), w->zero, w->gravity, 1);
    rbdi_external(m, w, f_ext);
    rbdi_rnea_sweep(m, w, w->zero, m->nmimic ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int k = 0; k < m->nv; ++k) c->x[k] = tau[k] - w->bias[k];
    doubt = rbdi_constrained_factor(m, c);
    rbdi_clear_rows(m, c);
    rbdi_clear(c->u, 3 * c->stride); /* gamma and e too */
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k) {
        rbdi_constraint_rows(m, c, k, rbdi_stabilisation(k));
        rbdi_stabilise(c, k);
    }
    status = rbdi_constrained_solve(m, c, doubt, 1, lambda);
    for (int k = 0; k < m->nv; ++k) a[k] = c->x[k];
    return status;
}

/* By articulated bodies. Returns 0, a untouched, if a pivot is in doubt. */
static int rbdi_articulated_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                               const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext, rbd_real *a) {
    if (c->factored) return 0;
    rbdi_articulated_start(m, c, q, v, c->w->gravity, c->moving);
    rbdi_external(m, c->w, f_ext);
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k) {
        rbdi_articulated_rows(c, k, rbdi_stabilisation(k));
        rbdi_stabilise(c, k);
    }
    return rbdi_articulated_solve(m, c, tau, a);
}

RBDI_API rbd_status rbd_constrained_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *lambda) {
    const rbd_status status = rbdi_check_constraints(m, c, q && v && tau && a);
    if (status) return status;
    if (!rbdi_articulated_fd(m, c, q, v, tau, f_ext, a))
        return rbdi_factored_fd(m, c, q, v, tau, f_ext, a, lambda);
    return rbdi_constrained_status(m, c, RBD_OK, lambda);
}

/* The motion of all links without gravity. */
static void rbdi_constraint_state_at(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                     const rbd_real *v) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbdi_joints(m, c->w, rbdi_expand_q(m, c->w, q));
    rbdi_constraint_state(m, c, v ? rbdi_expand_v(m, v, c->w->vx) : c->w->zero, c->w->zero, none, 0);
    rbdi_clear_rows(m, c);
    rbdi_clear(c->u, 3 * c->stride); /* gamma and e too */
}

/* The rows there. */
static void rbdi_constraint_rows_at(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                    const rbd_real *v, int want) {
    rbdi_constraint_state_at(m, c, q, v);
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
        rbdi_constraint_rows(m, c, k, want);
}

/* J v of a constraint after an impact less that before. */
static void rbdi_rebound(rbd_constraint_set *c, const rbdi_constraint *k, rbd_real restitution) {
    for (int r = k->row; r < k->row + k->rows; ++r) c->target[r] = -(c->u[r] + restitution * c->u[r]);
}

static int rbdi_restitution_fits(rbd_real x) {
    const rbd_real one = rbdi_set(RBD_C(1)), two = one + one; /* NaN is not below it */
    const rbdi_mask above = rbdi_or(rbdi_less(one, x), rbdi_not(rbdi_less(x, two)));
    return !rbdi_any(rbdi_or(above, rbdi_less(x, rbdi_zero())));
}

static rbd_status rbdi_factored_impact(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, rbd_real restitution, rbd_real *impulse) {
    rbdi_mask doubt;
    rbd_crba_packed(m, c->w, q, c->w->H);
    rbdi_clear(c->x, m->nv);
    doubt = rbdi_constrained_factor(m, c);
    rbdi_constraint_state_at(m, c, q, v);
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k) {
        rbdi_constraint_rows(m, c, k, RBDI_HELD_RATES);
        rbdi_rebound(c, k, restitution);
    }
    return rbdi_constrained_solve(m, c, doubt, 0, impulse); /* J v is in the range of J */
}

/* By articulated bodies. Returns 0, c->x unknown, if a pivot is in doubt. */
static int rbdi_articulated_impact(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                   const rbd_real *v, rbd_real restitution) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    if (c->factored) return 0;
    rbdi_articulated_start(m, c, q, v, none, 1);
    for (int i = 0; i < m->nl; ++i) c->w->scratch[i].f = rbdi_force0(), c->w->scratch[i].c = rbdi_motion0();
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k) {
        rbdi_articulated_rows(c, k, RBDI_HELD_RATES);
        rbdi_rebound(c, k, restitution);
    }
    return rbdi_articulated_solve(m, c, c->w->zero, c->x);
}

RBDI_API rbd_status rbd_impact(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                               const rbd_real *v, rbd_real restitution, rbd_real *v_plus, rbd_real *impulse) {
    rbd_status status = rbdi_check_constraints(m, c, q && v && v_plus);
    if (status) return status;
    if (!rbdi_restitution_fits(restitution)) return RBD_ERR_RANGE;
    if (rbdi_articulated_impact(m, c, q, v, restitution))
        status = rbdi_constrained_status(m, c, RBD_OK, impulse);
    else
        status = rbdi_factored_impact(m, c, q, v, restitution, impulse);
    for (int k = 0; k < m->nv; ++k) v_plus[k] = v[k] + c->x[k];
    if (status) (void)rbdi_verdict(m, c->w, v_plus, m->nv);
    return status;
}

RBDI_API rbd_status rbd_constraint_jacobian(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                            const rbd_real *v, rbd_real *J, rbd_real *gamma, rbd_real *e) {
    const rbd_status status = rbdi_check_constraints(m, c, q != NULL);
    if (status) return status;
    rbdi_constraint_rows_at(m, c, q, v, e ? RBDI_HELD_ERRORS : 0);
    for (int r = 0; r < c->rows; ++r) {
        for (int k = 0; J && k < m->nv; ++k) J[r * m->nv + k] = c->Y[k * c->stride + c->at[r]];
        if (gamma) gamma[r] = c->gamma[c->at[r]];
        if (e) e[r] = c->e[c->at[r]];
    }
    return RBD_OK;
}

#endif
