#ifndef RBDI_CONTACT_DERIVATIVES_H
#define RBDI_CONTACT_DERIVATIVES_H
#include "api/contact_derivatives.h"
#include "contact/step.h"
#include "contact/sigma.h"

/* -- dnu of [step derivatives code] -- */

/* Arrays for derivatives by q_mid, v_mid and tau, nv x nv each, in turns of one solution and the next.
   NULL: not wanted. In the end: of c->moved and c->nu. */
typedef struct rbdi_step_columns {
    rbd_real *dq[3], *dv[3];
} rbdi_step_columns;

/* Replaces rho by dnu of (5). Returns 0 if the impulses have no derivative. */
RBDI_LOCAL int rbdi_solve_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_real *rho) {
    rbd_constraint_set *s = c->rows;
    rbdi_contact_solver solver = c->solver;
    const int n = m->nv;
    int solved;

    /* Z = L^-T rho, in place, and sigma - Y' D^-1 Z */
    rbdi_solve_transposed(m, s->w, s->w->H, n, n, rho);
    for (int r = 0; r < s->rows; ++r) {
        for (int k = 0; k < n; ++k) s->x[k] = s->Y[k * s->stride + r] * s->D_inverse[k];
        rbdi_subtract_product(s->x, rho, n, n, &c->sigma[r * n]);
    }

    /* G y = -T' (...),  dp = S y */
    solver.G = c->sigma + c->max_rows * n;
    solver.sides = n;
    rbdi_list_unknowns(&solver);
    rbdi_newton_matrix(&solver, RBDI_SIDES_PROXIMAL, c->sigma);
    solved = rbdi_newton_solve(&solver);
    rbdi_clear(c->sigma, s->rows * n);
    rbdi_add_increments(&solver, c->sigma);

    /* dnu = -L^-1 D^-1 (Z - Y dp) */
    for (int k = 0; k < n; ++k)
        rbdi_subtract_product(&s->Y[k * s->stride], c->sigma, s->rows, n, &rho[k * n]);
    rbdi_solve_forward(m, s->w, s->w->H, -1, n, n, rho);
    return solved;
}

/* Replaces rho, without d(J' p), by dnu of the solution that has just been found. Returns 0 if one does not
   exist. */
RBDI_LOCAL int rbdi_differentiate_solution(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                           const rbd_real *nu, int purpose, rbd_real *const rho[3]) {
    int solved = 1;

    rbdi_add_side(m, c, rho);
    for (int x = 0; x < 3; ++x) {
        if (!rho[x]) continue;

        rbdi_clear(c->sigma, c->rows->rows * m->nv);
        if (x < 2) rbdi_middle_terms(m, c, d, purpose, x);
        if (x == 0) rbdi_velocity_terms(m, c, d, nu, purpose, rho[0]);
        rbdi_other_terms(m, c, purpose, x);
        solved &= rbdi_solve_derivatives(m, c, rho[x]);
    }
    return solved;
}

RBDI_LOCAL void rbdi_copy_columns(const rbd_model *m, rbd_real *const from[3], rbd_real *const to[3]) {
    for (int x = 0; x < 3; ++x)
        if (from[x])
            for (int k = 0; k < m->nv * m->nv; ++k) to[x][k] = from[x][k];
}

/* Solves for the corrections of the velocity terms. to->dq: rho of the first solution. to->dv becomes dnu
   with the first correction, which has the impulses of the first solution:

       K (dnu_1 - dnu_0) = rho_0 - rho_1    without d(J' p)

   Returns whether they exist. */
RBDI_LOCAL int rbdi_differentiate_corrections(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                              const rbd_real *tau, const rbd_real *f_ext,
                                              const rbdi_step_columns *to) {
    const int size = m->nv * m->nv;
    rbd_work *w = c->rows->w;
    int solved, changed;

    /* dv = -rho_0,  dq = dnu_0 */
    rbdi_copy_columns(m, to->dq, to->dv);
    rbdi_add_side(m, c, to->dv);
    for (int x = 0; x < 3; ++x)
        if (to->dv[x]) rbdi_multiply(to->dv[x], -rbdi_set(RBD_C(1)), size);
    solved = rbdi_differentiate_solution(m, c, d, c->moved, RBDI_FOR_VELOCITIES, to->dq);

    /* dv = dnu_1 = dnu_0 - K^-1 (rho_1 - rho_0) */
    changed = rbdi_solve_between(m, c, tau, f_ext);
    rbdi_add_rho(m, c, d, c->moved, f_ext, to->dq, to->dv);
    rbdi_add_side(m, c, to->dv);
    for (int x = 0; x < 3; ++x) {
        if (!to->dv[x]) continue;
        rbdi_solve_columns(m, w, w->H, -1, m->nv, m->nv, to->dv[x]);
        rbdi_subtract(to->dv[x], -rbdi_set(RBD_C(1)), to->dq[x], size);
    }

    rbdi_solve_again(m, c, tau, f_ext, changed);
    return solved;
}

/* Derivatives of what contacts that may rebound fall: by dnu of the velocities without contacts. */
RBDI_LOCAL void rbdi_differentiate_falls(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                         const rbd_real *f_ext, rbd_real *const dnu[3]) {
    rbd_work *w = c->rows->w;
    rbd_real *nu = c->rows->x;
    int any = 0;

    for (int i = 0; i < c->n; ++i) any |= c->contact[i].row >= 0 && c->contact[i].restitution > 0;
    if (!any) return;

    /* nu = v_mid + L^-1 D^-1 x */
    for (int k = 0; k < m->nv; ++k) nu[k] = c->x[RBDI_X_UNCORRECTED][k];
    rbdi_solve_forward(m, w, w->H, 1, 1, 1, nu);
    for (int k = 0; k < m->nv; ++k) nu[k] = c->v_mid[k] + nu[k];

    /* dnu = -K^-1 rho */
    rbdi_write_rho(m, c, d, nu, f_ext, NULL, dnu);
    rbdi_add_side(m, c, dnu);
    for (int x = 0; x < 3; ++x)
        if (dnu[x]) rbdi_solve_columns(m, w, w->H, -1, m->nv, m->nv, dnu[x]);
    rbdi_write_falls(m, c, nu, dnu);
}

/* Makes the step, and writes derivatives of c->moved and c->nu. Returns whether they exist. */
RBDI_LOCAL int rbdi_differentiate_step(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                       const rbd_real *tau, const rbd_real *f_ext,
                                       const rbdi_step_columns *to, rbd_status *status) {
    const int first_order = !(c->half > 0);
    int solved = 1, positions, velocities;

    /* the first solution, and the corrections */
    rbdi_differentiate_falls(m, c, d, f_ext, to->dq);
    rbdi_solve_first(m, c, first_order ? RBDI_FOR_POSITIONS : RBDI_FOR_VELOCITIES);
    rbdi_write_rho(m, c, d, c->moved, f_ext, NULL, to->dq);
    if (!first_order) {
        solved = rbdi_differentiate_corrections(m, c, d, tau, f_ext, to);
        rbdi_write_rho(m, c, d, c->moved, f_ext, to->dv, to->dq);
    }

    /* c->moved */
    rbdi_copy_columns(m, to->dq, to->dv);
    positions = rbdi_differentiate_solution(m, c, d, c->moved, RBDI_FOR_POSITIONS, to->dq);

    /* c->nu; of a contact that jams c->moved too */
    *status = rbdi_solve_velocities(m, c);
    if (!c->differ) {
        rbdi_copy_columns(m, to->dq, to->dv);
        return solved & positions;
    }

    if (to->dv[0]) rbdi_write_sides(m, c, d, c->nu, f_ext, rbdi_side(m, c, 2), NULL, NULL);
    velocities = rbdi_differentiate_solution(m, c, d, c->nu, RBDI_FOR_VELOCITIES, to->dv);
    if (!c->jams) return solved & positions & velocities;

    rbdi_copy_columns(m, to->dv, to->dq);
    return solved & velocities;
}

RBDI_API rbd_status rbd_contact_step_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                                 const rbd_real *q, const rbd_real *v, const rbd_real *tau,
                                                 const rbd_real *f_ext, const rbd_real *damping, rbd_real dt,
                                                 const rbd_contact_step_results *out) {
    const rbd_contact_step_results none_wanted = {NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
    const rbd_contact_step_results to = out ? *out : none_wanted;
    rbdi_step_columns by = {{to.dq_next_dq, to.dq_next_dv, to.dq_next_dtau},
                            {to.dv_next_dq, to.dv_next_dv, to.dv_next_dtau}};
    int pairs = !to.q_next == !to.v_next, solved = 1, size;
    rbd_status status;

    for (int x = 0; x < 3; ++x) pairs &= !by.dq[x] == !by.dv[x];
    status = rbdi_check_step(m, c, d && q && v && tau && out && pairs, dt);
    if (!status) status = rbdi_check_derivatives(m, d, 1);
    if (status) return status;
    if (d->work != c->rows->w) return RBD_ERR_WORK;
    if (!c->sigma) return RBD_ERR_MEMORY;

    /* those by v need those by q */
    size = m->nv * m->nv;
    if (by.dq[1] && !by.dq[0]) {
        by.dq[0] = rbdi_side(m, c, 3);
        by.dv[0] = rbdi_side(m, c, 4);
    }

    rbdi_choose_scheme(c, dt, c->options.first_order);
    status = rbdi_begin_step(m, c, q, v, tau, f_ext, damping);
    if (!status) solved = rbdi_differentiate_step(m, c, d, tau, f_ext, &by, &status);

    /* the half of the step behind q_mid, and the half before */
    for (int x = 0; x < 3; ++x)
        if (by.dq[x] && !status)
            rbdi_move_columns(m, c->points, c->moved, c->nu, c->way, x == 0, by.dq[x], by.dv[x]);
    if (by.dq[0] && !status) {
        rbdi_columns_before(m, c->points, v, c->half, by.dq[0], by.dq[1]);
        rbdi_columns_before(m, c->points, v, c->half, by.dv[0], by.dv[1]);
    }

    for (int x = 0; x < 3; ++x)
        if (by.dq[x]) solved &= rbdi_all_finite(by.dq[x], size) & rbdi_all_finite(by.dv[x], size);
    if (!status && !solved) status = RBD_ERR_SINGULAR;

    /* after an error all are 0 */
    if (status) rbd_contact_reset(c);
    for (int x = 0; x < 3; ++x)
        if (status && by.dq[x]) rbdi_clear(by.dq[x], size);
    for (int x = 0; x < 3; ++x)
        if (status && by.dv[x]) rbdi_clear(by.dv[x], size);

    if (to.q_next) rbdi_contact_move(m, c, status, q, to.q_next, to.v_next);
    return status;
}

#endif
