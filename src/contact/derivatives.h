#ifndef RBDI_CONTACT_DERIVATIVES_H
#define RBDI_CONTACT_DERIVATIVES_H
#include "constraints/derivatives.h"
#include "api/contact_derivatives.h"
#include "contact/step.h"

/* ---- derivatives [step derivatives code] ----
   Of (4), with the states of the solution held. x is a component of q, v or tau, v~ = c->start, a =
   (nu - v~) / dt, and M has dt damping on its diagonal:

       M dnu/dx = J' dp/dx - rho,     rho = dt dID/dx - d(J' p)/dx at fixed a and p; by v also -M dv~/dv
       du/dx = J dnu/dx + sigma,      sigma = d(J nu + bias)/dx at fixed nu

   and rho = -dt by tau. d ID is rbd_id_derivatives; d(J nu) and d(J' p) are as in [derivatives code], for a
   place that rolls over the body if it is a ball's. With Z = L^-T rho and the S, T and G of [newton]

       G y = -T' (sigma - Y' D^-1 Z),   dp = S y,   dnu = -L^-1 D^-1 (Z - Y dp)                         (5) */

/* rho without d(J' p), of those that are not NULL. */
static void rbdi_write_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *q,
                           const rbd_real *v, const rbd_real *nu, const rbd_real *f_ext, rbd_real dt,
                           rbd_real *const rho[3]) {
    const int n = m->nv;
    rbd_real *M = rho[1] ? c->sigma + c->most * n : NULL;
    for (int k = 0; k < n; ++k) d->a[k] = (nu[k] - c->start[k]) / dt;
    for (int x = 0; x < 3; ++x) /* rbd_keep_zeros leaves entries out */
        if (rho[x]) rbdi_clear(rho[x], n * n);
    if (M) rbdi_clear(M, n * n);
    (void)rbd_id_derivatives(m, d, q, v, d->a, f_ext, rho[0], rho[1], M);
    if (M) rbdi_glide_columns(m, v, dt, M);
    for (int k = 0; rho[0] && k < n * n; ++k) rho[0][k] = rho[0][k] * dt;
    for (int k = 0; M && k < n * n; ++k) rho[1][k] = rho[1][k] * dt - M[k];
    for (int k = 0; rho[2] && k < n; ++k) rho[2][k * (n + 1)] = -dt;
}

/* Writes the links' motion with the velocities nu into the work. */
static void rbdi_meet_at(const rbd_model *m, rbd_contact_set *c, const rbd_real *nu) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbdi_constraint_state(m, c->rows, rbdi_expand_v(m, nu, c->rows->w->vx), c->rows->w->zero, none, 0);
}
/* Constraint i in that motion, and its impulses. */
static rbdi_pair_motion rbdi_contact_motion(const rbd_contact_set *c, int i) {
    const rbdi_constraint *k = &c->rows->constraint[i];
    rbdi_pair_motion x = rbdi_pair_motion_of(c->rows, k);
    if (i < c->n) x.rolls = rbdi_scale(rbdi_set(c->contact[i].radius), rbdi_contact_normal(c->rows, k));
    return x;
}

/* Adds to sigma, for each row of a constraint, `share` times the derivative of J nu by q and `gain` times
   that of the gap or error, which is J. Leaves the dofs' motions in d. */
static void rbdi_change_rows(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                             const rbdi_constraint *k, const rbdi_pair_motion *x, const rbd_real *share,
                             const rbd_real *gain) {
    RBDI_FOR_PATHS(m, k, link, sign) {
        const rbdi_link *l = &m->link[link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_change by = rbdi_change_of(m, c->rows, x, sign < 0, link, j);
            rbd_real sum[2][RBDI_SIX_ROWS], *to = &c->sigma[k->row * m->nv + rbdi_source(m, l->iv + j)];
            rbdi_store_motion(RBDI_OF(d, l->first + j, Phi), RBDI_BATCH, by.S);
            rbdi_clear(sum[0], 2 * RBDI_SIX_ROWS);
            rbdi_add_held(k, &x->h, by.velocity.omega, by.velocity.v, sum[0]);
            rbdi_add_held(k, &x->h, rbdi_error_turn(k, x, by.S.omega), by.S.v, sum[1]);
            for (int r = 0; r < k->rows; ++r, to += m->nv)
                *to = *to + share[r] * sum[0][r] + gain[r] * sum[1][r];
        }
    }
}

/* sigma of rebounds, whose bias is restitution J v: by q or, x = 1, by v. */
static void rbdi_change_rebounds(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                                 const rbd_real *v, int x) {
    rbdi_meet_at(m, c, v);
    for (int i = 0; i < c->n; ++i) {
        rbd_real of[2][3] = {{rbdi_zero()}, {rbdi_zero()}}; /* share, gain */
        rbdi_pair_motion met;
        if (c->contact[i].row < 0 || !c->contact[i].rebounds) continue;
        of[x][2] = rbdi_set(c->contact[i].restitution);
        met = rbdi_contact_motion(c, i);
        rbdi_change_rows(m, c, d, &c->rows->constraint[i], &met, of[0], of[1]);
    }
}

/* sigma, and d(J' p) in rho, by q. */
static void rbdi_change_by_q(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                             const rbd_real *nu, rbd_real dt, int purpose, rbd_real *rho) {
    const rbd_constraint_set *s = c->rows;
    rbdi_meet_at(m, c, nu);
    for (int i = 0; i < c->n + c->held; ++i) {
        const rbdi_constraint *k = &s->constraint[i];
        const rbdi_contact *a = i < c->n ? &c->contact[i] : NULL;
        rbd_real share[6], gain[6];
        rbdi_pair_motion x;
        if (a && a->row < 0) continue;
        for (int r = 0; r < k->rows; ++r) {
            share[r] = rbdi_set(RBD_C(1)), gain[r] = rbdi_zero();
            if (a && r == 2) gain[r] = rbdi_gap_gain(c, a, dt, purpose);
            if (!a && purpose == RBDI_FOR_POSITIONS)
                gain[r] = rbdi_correction_gain(c, -rbdi_abs(s->e[k->row + r]), dt);
        }
        x = rbdi_contact_motion(c, i);
        rbdi_change_rows(m, c, d, k, &x, share, gain);
        rbdi_change_forces(m, d, k, &x, rho);
    }
    for (int i = 0; i < c->dof_rows; ++i) {
        const rbdi_dof_row *a = &c->dof_row[i];
        if (a->row >= 0) c->sigma[a->row * m->nv + a->dof] = a->side * rbdi_limit_gain(c, a, dt, purpose);
    }
}

/* (5): dnu in place of rho. Returns 0 if the impulses have no derivative. */
static int rbdi_solve_change(const rbd_model *m, rbd_contact_set *c, rbd_real *rho) {
    rbd_constraint_set *s = c->rows;
    rbdi_contact_solver solver = c->solver;
    const int n = m->nv, unknowns = rbdi_list_unknowns(&solver);
    int solved;
    rbdi_solve_up(m, s->w, s->w->H, n, n, rho);
    for (int r = 0; r < s->rows; ++r) {
        for (int k = 0; k < n; ++k) s->x[k] = s->Y[k * s->stride + r] * s->D_inverse[k];
        rbdi_subtract_product(s->x, rho, n, n, &c->sigma[r * n]);
    }
    solver.G = c->sigma + c->most * n, solver.sides = n;
    rbdi_newton_matrix(&solver, unknowns, RBDI_SIDES_PROXIMAL, c->sigma);
    solved = rbdi_newton_solve(&solver, unknowns);
    rbdi_clear(c->sigma, s->rows * n);
    rbdi_add_increments(&solver, unknowns, c->sigma);
    for (int k = 0; k < n; ++k)
        rbdi_subtract_product(&s->Y[k * s->stride], c->sigma, s->rows, n, &rho[k * n]);
    rbdi_solve_down(m, s->w, s->w->H, -1, n, n, rho);
    return solved;
}

/* Derivatives of the solution nu by q, v and tau, of those that are not NULL. Returns 0 if one has none. */
static int rbdi_differentiate_solution(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                       const rbd_real *q, const rbd_real *v, const rbd_real *nu,
                                       const rbd_real *f_ext, rbd_real dt, int purpose,
                                       rbd_real *const dnu[3]) {
    int solved = 1;
    rbdi_write_rho(m, c, d, q, v, nu, f_ext, dt, dnu);
    for (int x = 0; x < 3; ++x) {
        if (!dnu[x]) continue;
        rbdi_clear(c->sigma, c->rows->rows * m->nv);
        if (x < 2 && purpose == RBDI_FOR_VELOCITIES) rbdi_change_rebounds(m, c, d, v, x);
        if (x == 0) rbdi_change_by_q(m, c, d, nu, dt, purpose, dnu[0]);
        solved &= rbdi_solve_change(m, c, dnu[x]);
    }
    return solved;
}

RBDI_API rbd_status rbd_contact_step_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                                 const rbd_real *q, const rbd_real *v, const rbd_real *tau,
                                                 const rbd_real *f_ext, const rbd_real *damping, rbd_real dt,
                                                 const rbd_contact_step_results *out) {
    const rbd_contact_step_results none_wanted = {NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
    const rbd_contact_step_results to = out ? *out : none_wanted;
    rbd_real *const dq[3] = {to.dq_next_dq, to.dq_next_dv, to.dq_next_dtau};
    rbd_real *const dv[3] = {to.dv_next_dq, to.dv_next_dv, to.dv_next_dtau};
    const int nv = m ? m->nv : 0;
    int pairs = !to.q_next == !to.v_next, solved, differ;
    rbd_status status;
    for (int x = 0; x < 3; ++x) pairs &= !dq[x] == !dv[x];
    status = rbdi_check_step(m, c, d && q && v && tau && out && pairs, dt);
    if (!status) status = rbdi_check_derivatives(m, d, 1);
    if (status) return status;
    if (d->work != c->rows->w) return RBD_ERR_WORK;
    if (!c->sigma) return RBD_ERR_MEMORY;
    status = rbdi_solve_positions(m, c, q, v, tau, f_ext, damping, dt);
    if (!status) {
        solved = rbdi_differentiate_solution(m, c, d, q, v, c->moved, f_ext, dt, RBDI_FOR_POSITIONS, dq);
        differ = rbdi_solve_velocities(m, c, dt);
        if (differ)
            solved &= rbdi_differentiate_solution(m, c, d, q, v, c->nu, f_ext, dt, RBDI_FOR_VELOCITIES, dv);
        for (int x = 0; x < 3; ++x) {
            if (!dq[x]) continue;
            for (int k = 0; !differ && k < nv * nv; ++k) dv[x][k] = dq[x][k];
            rbdi_move_columns(m, c->moved, c->nu, dt, x == 0, dq[x], dv[x]);
            solved &= rbdi_all_finite(dq[x], nv * nv) & rbdi_all_finite(dv[x], nv * nv);
        }
        if (!solved) status = RBD_ERR_SINGULAR;
        if (rbdi_contact_status(m, c, dt)) status = RBD_ERR_NAN;
    }
    for (int x = 0; status && x < 3; ++x)
        if (dq[x]) rbdi_clear(dq[x], nv * nv), rbdi_clear(dv[x], nv * nv);
    if (to.q_next) rbdi_contact_move(m, c, status, q, dt, to.q_next, to.v_next);
    return status;
}

#endif
