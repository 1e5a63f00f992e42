#ifndef RBDI_CONTACT_DERIVATIVES_H
#define RBDI_CONTACT_DERIVATIVES_H
#include "derivatives/steps.h"
#include "constraints/derivatives.h"
#include "api/contact_derivatives.h"
#include "contact/step.h"

/* ---- derivatives [step derivatives code] ----
   Derivatives of (4), with the states of the solution held. x is a component of q, v or tau, v~ = c->start,
   a = (nu - v~) / dt, and M has dt damping on its diagonal:

       M dnu/dx = J' dp/dx - rho,     rho = dt dID/dx - d(J' p)/dx at fixed a and p; by v also -M dv~/dv
       du/dx = J dnu/dx + sigma,      sigma = d(J nu + bias)/dx at fixed nu

   and rho = -dt by tau. rbd_id_derivatives gives d ID; d(J nu) and d(J' p) are as in [derivatives code] but
   for balls, over which the place of contact rolls. With Z = L^-T rho and the S, T and G of [newton]

       G y = -T' (sigma - Y' D^-1 Z),   dp = S y,   dnu = -L^-1 D^-1 (Z - Y dp)                         (5) */

/* Writes rho without d(J' p) for each of the three that is not NULL. */
static void rbdi_write_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *q,
                           const rbd_real *v, const rbd_real *nu, const rbd_real *f_ext,
                           rbd_real *const rho[3]) {
    const int n = m->nv;
    rbd_real *M = c->sigma + c->max_rows * n;
    for (int k = 0; k < n; ++k) d->a[k] = (nu[k] - c->start[k]) / c->dt;
    for (int x = 0; x < 3; ++x) /* rbd_keep_zeros leaves entries out */
        if (rho[x]) rbdi_clear(rho[x], n * n);
    rbdi_clear(M, n * n);
    (void)rbd_id_derivatives(m, d, q, v, d->a, f_ext, rho[0], rho[1], rho[1] ? M : NULL);
    rbdi_unforced_columns(m, v, c->dt, M);
    for (int k = 0; k < n * n; ++k) {
        if (rho[0]) rho[0][k] = rho[0][k] * c->dt;
        if (rho[1]) rho[1][k] = rho[1][k] * c->dt - M[k];
        if (rho[2] && k % (n + 1) == 0) rho[2][k] = -c->dt;
    }
}

/* Adds to sigma, for each row of a constraint, `factor` times the derivative of J nu by q and `gain` times
   the derivative of the gap or error, which is J. Leaves the S of the dofs in d. */
static void rbdi_row_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                           const rbdi_constraint *con, const rbdi_pair_motion *pair, const rbd_real *factor,
                           const rbd_real *gain) {
    RBDI_FOR_PATHS(m, con, link, sign) {
        const rbdi_link *l = &m->link[link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_motion_derivatives by = rbdi_differentiate_motion(m, c->rows, pair, sign < 0, link, j);
            rbd_real sum[2][RBDI_SIX_ROWS], *to = &c->sigma[con->row * m->nv + rbdi_source(m, l->iv + j)];
            rbdi_store_motion(RBDI_OF(d, l->first + j, Phi), RBDI_BATCH, by.S);
            rbdi_clear(sum[0], 2 * RBDI_SIX_ROWS);
            rbdi_add_held(con, &pair->h, by.velocity_q.omega, by.velocity_q.v, sum[0]);
            rbdi_add_held(con, &pair->h, rbdi_differentiate_error(con, pair, by.S.omega), by.S.v, sum[1]);
            for (int r = 0; r < con->rows; ++r, to += m->nv)
                *to = *to + factor[r] * sum[0][r] + gain[r] * sum[1][r];
        }
    }
}

/* Adds the terms of contacts and held constraints by q: to sigma, and -d(J' p) to rho. Or, if `rebounds`,
   those of rebounds, by q (x = 0) or v (x = 1), to sigma: restitution J nu, of nu before the step. */
static void rbdi_constraint_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                                  const rbd_real *nu, int purpose, int rebounds, int x, rbd_real *rho) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_constraint_set *s = c->rows;
    rbdi_constraint_state(m, s, rbdi_expand_v(m, nu, s->w->vx), s->w->zero, none, 0);
    for (int i = 0; i < s->n; ++i) {
        const rbdi_constraint *con = &s->constraint[i];
        const rbdi_contact *contact = i < c->n ? &c->contact[i] : NULL;
        rbd_real factor[6], gain[6];
        rbdi_pair_motion pair;
        if (con->row < 0 || (rebounds && !(contact && contact->rebounds))) continue;
        for (int r = 0; r < con->rows; ++r) {
            factor[r] = rbdi_set(RBD_C(!rebounds));
            gain[r] = contact ? rbdi_zero() : rbdi_held_bias(c, purpose, s->e[con->row + r]).gain;
        }
        if (contact) gain[2] = rbdi_contact_bias(c, purpose, contact).gain;
        if (rebounds) (x == 0 ? factor : gain)[2] = rbdi_set(rbdi_rebound_share(contact));
        pair = rbdi_pair_motion_of(s, con);
        if (contact) pair.roll_radius = rbdi_scale(rbdi_set(contact->radius), rbdi_contact_normal(s, con));
        rbdi_row_terms(m, c, d, con, &pair, factor, gain);
        if (!rebounds) rbdi_differentiate_forces(m, d, con, &pair, rho);
    }
}

/* The derivative of a limit's bias by q (x = 0) or v (x = 1) of its dof. */
static rbd_real rbdi_limit_gain(const rbd_contact_set *c, int purpose, const rbdi_dof_row *limit, int x) {
    if (x == 0) return limit->side * rbdi_limit_bias(c, purpose, limit).gain;
    return purpose == RBDI_FOR_VELOCITIES && limit->rebounds ? limit->side : rbdi_zero();
}

/* Replaces rho by dnu of (5). Returns 0 if the impulses have no derivative. */
static int rbdi_solve_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_real *rho) {
    rbd_constraint_set *s = c->rows;
    rbdi_contact_solver solver = c->solver;
    const int n = m->nv;
    int solved;
    rbdi_solve_up(m, s->w, s->w->H, n, n, rho);
    for (int r = 0; r < s->rows; ++r) {
        for (int k = 0; k < n; ++k) s->x[k] = s->Y[k * s->stride + r] * s->D_inverse[k];
        rbdi_subtract_product(s->x, rho, n, n, &c->sigma[r * n]);
    }
    solver.G = c->sigma + c->max_rows * n, solver.sides = n;
    rbdi_list_unknowns(&solver);
    rbdi_newton_matrix(&solver, RBDI_SIDES_PROXIMAL, c->sigma);
    solved = rbdi_newton_solve(&solver);
    rbdi_clear(c->sigma, s->rows * n);
    rbdi_add_increments(&solver, c->sigma);
    for (int k = 0; k < n; ++k)
        rbdi_subtract_product(&s->Y[k * s->stride], c->sigma, s->rows, n, &rho[k * n]);
    rbdi_solve_down(m, s->w, s->w->H, -1, n, n, rho);
    return solved;
}

/* Writes the derivatives of the solution nu by q, v and tau, unless NULL. Returns 0 if one does not exist. */
static int rbdi_differentiate_solution(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                       const rbd_real *q, const rbd_real *v, const rbd_real *nu,
                                       const rbd_real *f_ext, int purpose, rbd_real *const dnu[3]) {
    int solved = 1;
    rbdi_write_rho(m, c, d, q, v, nu, f_ext, dnu);
    for (int x = 0; x < 3; ++x) {
        if (!dnu[x]) continue;
        rbdi_clear(c->sigma, c->rows->rows * m->nv);
        if (x < 2 && purpose == RBDI_FOR_VELOCITIES) rbdi_constraint_terms(m, c, d, v, purpose, 1, x, NULL);
        if (x == 0) rbdi_constraint_terms(m, c, d, nu, purpose, 0, x, dnu[0]);
        for (const rbdi_dof_row *limit = c->dof_row; x < 2 && limit < c->dof_row + c->dof_rows; ++limit)
            if (limit->row >= 0)
                c->sigma[limit->row * m->nv + limit->dof] = rbdi_limit_gain(c, purpose, limit, x);
        solved &= rbdi_solve_derivatives(m, c, dnu[x]);
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
    int pairs = !to.q_next == !to.v_next, solved, size;
    rbd_status status;
    for (int x = 0; x < 3; ++x) pairs &= !dq[x] == !dv[x];
    status = rbdi_check_step(m, c, d && q && v && tau && out && pairs, dt);
    if (!status) status = rbdi_check_derivatives(m, d, 1);
    if (status) return status;
    if (d->work != c->rows->w) return RBD_ERR_WORK;
    if (!c->sigma) return RBD_ERR_MEMORY;
    size = m->nv * m->nv;
    status = rbdi_solve_positions(m, c, q, v, tau, f_ext, damping, dt);
    if (!status) {
        solved = rbdi_differentiate_solution(m, c, d, q, v, c->moved, f_ext, RBDI_FOR_POSITIONS, dq);
        status = rbdi_solve_velocities(m, c);
        if (c->differ)
            solved &= rbdi_differentiate_solution(m, c, d, q, v, c->nu, f_ext, RBDI_FOR_VELOCITIES, dv);
        for (int x = 0; x < 3; ++x) {
            if (!dq[x]) continue;
            for (int k = 0; !c->differ && k < size; ++k) dv[x][k] = dq[x][k];
            rbdi_move_columns(m, c->moved, c->nu, dt, x == 0, dq[x], dv[x]);
            solved &= rbdi_all_finite(dq[x], size) & rbdi_all_finite(dv[x], size);
        }
        if (!status && !solved) status = RBD_ERR_SINGULAR;
    }
    for (int x = 0; status && x < 3; ++x)
        if (dq[x]) rbdi_clear(dq[x], size), rbdi_clear(dv[x], size);
    if (to.q_next) rbdi_contact_move(m, c, status, q, to.q_next, to.v_next);
    return status;
}

#endif
