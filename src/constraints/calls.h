#ifndef RBDI_CONSTRAINTS_CALLS_H
#define RBDI_CONSTRAINTS_CALLS_H
#include "dynamics/rnea.h"
#include "constraints/articulated.h"

/* Interface: rbdi_check_constrained, rbdi_check_constraints, rbdi_constraint_bias */

/* ---- call code [call code] ---- */

RBDI_LOCAL rbd_status rbdi_check_constraints(const rbd_model *m, const rbd_constraint_set *c, int arrays) {
    if (!m || !c || !arrays) return RBD_ERR_NULL;
    if (!rbdi_has_shape(m, c->shape)) return RBD_ERR_WORK;
    return rbdi_check(m, c->w, 1);
}

/* The same of a call that needs masses. */
RBDI_LOCAL rbd_status rbdi_check_constrained(const rbd_model *m, const rbd_constraint_set *c, int arrays) {
    const rbd_status status = rbdi_check_constraints(m, c, arrays);
    return status ? status : rbdi_check_dynamics(m, c->w, 1);
}

/* x += D^-1 Y lambda, with lambda of least norm so that Y' x = target. check: whether to note a row that
   contradicts others. Returns whether rows may not hold yet, so that rbdi_check_held must look at them.

       b = target - Y' x,   Delta lambda = b */
RBDI_LOCAL int rbdi_multipliers(const rbd_model *m, rbd_constraint_set *c, int check) {
    rbdi_rest_of_rows(c);
    c->pivoted = 0;
    c->infeasible = -1;

    if (rbdi_any(rbdi_factor_delta(m, c))) {
        RBDI_NOTE_DOUBT(c->w, 1);
        c->pivoted = 1;
        rbdi_orthogonalise(m, c);
        rbdi_null_space(c);
        if (check) rbdi_check_rows(c);
        for (int r = 0; r < c->rows; ++r) c->lambda[r] = c->b[r];
        rbdi_delta_solve(c, c->lambda, 1);
    } else {
        rbdi_back_substitute(c);
    }

    return rbdi_refine(m, c, rbdi_add_forces(m, c, c->lambda)) || c->pivoted;
}

/* Targets of a constraint's rows: -gamma - kd J v - kp e; with a restitution, the change of velocity in an
   impact, -J v - restitution J v. */
RBDI_LOCAL void rbdi_set_target(rbd_constraint_set *c, const rbdi_constraint *con,
                                const rbd_real *restitution) {
    for (int r = con->row; r < con->row + con->rows; r += RBDI_BATCH) {
        const rbdi_batch v = *(const rbdi_batch *)&c->velocity[r];
        rbdi_batch target =
            rbdi_all_lanes(rbdi_zero()) - (restitution ? v : *(const rbdi_batch *)&c->gamma[r]);

        if (restitution) target = target - v * *restitution;
        if (!restitution && con->kd > 0) target = target - v * con->kd;
        if (!restitution && con->kp > 0) target = target - *(const rbdi_batch *)&c->e[r] * con->kp;

        *(rbdi_batch *)&c->target[r] = target;
    }
}

/* Computes the accelerations x and lambda by articulated bodies. With a restitution x is the change of
   velocity in an impact, by the same steps without gravity, velocity products and forces. Returns 0, x
   untouched, if a pivot is in doubt. */
RBDI_LOCAL int rbdi_articulated_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                   const rbd_real *restitution, rbd_real *x) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_work *w = c->w;
    if (c->factored) return 0;

    /* the articulated bodies; in an impact without velocity products */
    rbdi_articulated_start(m, c, q, v, restitution ? none : w->gravity, c->moving || restitution);
    for (int i = 0; restitution && i < m->nl; ++i) {
        w->scratch[i].f = rbdi_force0();
        w->scratch[i].c = rbdi_motion0();
    }
    rbdi_external(m, w, f_ext);
    if (rbdi_any(rbdi_aba_pass2(m, w, tau))) return 0;

    rbdi_path_inverse(m, c);
    if (c->dirty) rbdi_clear_rows(m, c);
    c->dirty = 0;
    rbdi_clear(c->velocity, 3 * c->stride); /* gamma and e are behind it */

    /* the rows */
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        rbdi_axes_held h;
        rbdi_v3 p;
        rbdi_set_axes(c, con, &h);
        p = rbdi_constraint_motion(c, con, &h, !restitution && con->kp > 0);
        rbdi_set_target(c, con, restitution);
        for (int r = 0; r < con->rows; r += RBDI_BATCH) rbdi_rows_to_world(m, c, con, r, &h, p);
    }

    return rbdi_articulated_solve(m, c, x);
}

/* Writes M to w->H, M a + bias - sum J_b' f_ext to w->bias, and the state of all links. a: with the joints
   that mimic. */
RBDI_LOCAL void rbdi_constraint_bias(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                     rbdi_c3 gravity) {
    rbd_work *w = c->w;
    rbd_crba_packed(m, w, q, w->H);
    rbdi_constraint_state(m, c, rbdi_expand_v(m, v, w->vx), a, gravity, 1);

    rbdi_external(m, w, f_ext);
    rbdi_rnea_sweep(m, w, a, rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
}

/* As rbdi_articulated_fd, by the factor M = L'DL, in every state. Returns the status of M's pivots.

       f = L^-T (tau - bias),   Y = L^-T J',   L a = D^-1 (f + Y lambda) */
RBDI_LOCAL rbd_status rbdi_factored_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       const rbd_real *restitution, rbd_real *x) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_work *w = c->w;
    rbdi_mask doubt;

    /* f */
    rbdi_constraint_bias(m, c, q, v, w->zero, f_ext, restitution ? none : w->gravity);
    for (int k = 0; k < m->nv; ++k) c->x[k] = restitution ? rbdi_zero() : tau[k] - w->bias[k];
    doubt = rbdi_factor(m, w, w->H);
    rbdi_sweep_back(m, c, w->H);

    /* Y */
    rbdi_clear_rows(m, c);
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        rbdi_constraint_rows(m, c, con, !restitution && con->kp > 0);
        rbdi_set_target(c, con, restitution);
    }
    rbdi_solve_transposed(m, w, w->H, c->stride, c->rows, c->Y);

    /* L a = D^-1 (f + Y lambda) */
    for (int k = 0; k < m->nv; ++k) c->x[k] = c->x[k] * c->D_inverse[k];
    if (rbdi_multipliers(m, c, !restitution)) /* an impact's targets, J v, are in the range of J */
        rbdi_check_held(m, c);

    /* a, from D L a */
    for (int k = 0; k < m->nv; ++k) x[k] = c->x[k] * w->pivot[k];
    rbdi_solve_forward(m, w, w->H, 1, 1, 1, x);
    return rbdi_factor_status(m, w, w->H, doubt, x, m->nv);
}

/* Computes x and lambda by articulated bodies or, if these are in doubt, by the factor of M. Returns the
   status of the call. */
RBDI_LOCAL rbd_status rbdi_constrained(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       const rbd_real *restitution, rbd_real *x, rbd_real *lambda) {
    rbd_status status = RBD_OK;

    if (!rbdi_articulated_fd(m, c, q, v, tau, f_ext, restitution, x)) {
        if (!c->factored) RBDI_NOTE_DOUBT(c->w, 1);
        status = rbdi_factored_fd(m, c, q, v, tau, f_ext, restitution, x);
    }

    return rbdi_constrained_status(m, c, status, lambda);
}

RBDI_API rbd_status rbd_constrained_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *lambda) {
    const rbd_status status = rbdi_check_constrained(m, c, q && v && tau && a);
    return status ? status : rbdi_constrained(m, c, q, v, tau, f_ext, NULL, a, lambda);
}

/* Whether 0 <= restitution <= 1. */
RBDI_LOCAL int rbdi_restitution_fits(rbd_real restitution) {
    const rbd_real one = rbdi_set(RBD_C(1)), two = one + one; /* to refuse NaN, which is not below it */
    const rbdi_mask above = rbdi_or(rbdi_less(one, restitution), rbdi_not(rbdi_less(restitution, two)));

    return !rbdi_any(rbdi_or(above, rbdi_less(restitution, rbdi_zero())));
}

RBDI_API rbd_status rbd_impact(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                               const rbd_real *v, rbd_real restitution, rbd_real *v_plus, rbd_real *impulse) {
    rbd_status status = rbdi_check_constrained(m, c, q && v && v_plus);
    if (status) return status;
    if (!rbdi_restitution_fits(restitution)) return RBD_ERR_RANGE;

    status = rbdi_constrained(m, c, q, v, c->w->zero, NULL, &restitution, c->x, impulse);
    for (int k = 0; k < m->nv; ++k) v_plus[k] = v[k] + c->x[k];

    if (status && status != RBD_ERR_INFEASIBLE) (void)rbdi_pivot_status(m, c->w, v_plus, m->nv);
    return status;
}

/* Computes J, J v, gamma and, if `errors`, e as rbdi_constraint_rows, and the motion of all links without
   gravity. v: NULL = 0. */
RBDI_LOCAL void rbdi_constraint_rows_at(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                        const rbd_real *v, int errors) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbdi_joints(m, c->w, rbdi_expand_q(m, c->w, q));
    rbdi_constraint_state(m, c, v ? rbdi_expand_v(m, v, c->w->vx) : c->w->zero, c->w->zero, none, 0);

    rbdi_clear_rows(m, c);
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        rbdi_constraint_rows(m, c, con, errors);
}

RBDI_API rbd_status rbd_constraint_jacobian(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                            const rbd_real *v, rbd_real *J, rbd_real *gamma, rbd_real *e) {
    const rbd_status status = rbdi_check_constraints(m, c, q != NULL);
    if (status) return status;

    rbdi_constraint_rows_at(m, c, q, v, e != NULL);
    for (int r = 0; r < c->rows; ++r) {
        for (int k = 0; J && k < m->nv; ++k) J[r * m->nv + k] = c->Y[k * c->stride + r];
        if (gamma) gamma[r] = c->gamma[r];
        if (e) e[r] = c->e[r];
    }
    return RBD_OK;
}

#endif
