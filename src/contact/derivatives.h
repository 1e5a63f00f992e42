#ifndef RBDI_CONTACT_DERIVATIVES_H
#define RBDI_CONTACT_DERIVATIVES_H
#include "derivatives/steps.h"
#include "constraints/derivatives.h"
#include "api/contact_derivatives.h"
#include "contact/step.h"

/* ---- derivatives [step derivatives code] ----
   Derivatives of [step code], with the states of each solution held. x is a component of q_mid, v_mid or tau,
   a = (nu - v_mid) / dt + a(w), w = (v_mid + nu before) / 2, M without damping:

       K dnu/dx = J' dp/dx - rho,     rho = dt dID(q_mid, w, a)/dx - d(J' p)/dx at fixed nu and p
       du/dx = J dnu/dx + sigma,      sigma = d(J nu + dt/2 gamma + bias)/dx at fixed nu

   where dID has, by w, also a(w); by v_mid, -M of a, and -A of the caller's matrix; by tau, rho = -dt. Each
   solution's dnu enters the next by w. rbd_id_derivatives gives d ID; d(J nu), d gamma and d(J' p) are as in
   [derivatives code] but for balls, over which the place of contact rolls. With Z = L^-T rho and the S, T
   and G of [newton]

       G y = -T' (sigma - Y' D^-1 Z),   dp = S y,   dnu = -L^-1 D^-1 (Z - Y dp)                         (5)

   Last, the half of the step before takes derivatives by q_mid and v_mid to those by q and v. */

/* Arrays for derivatives by q_mid, v_mid and tau, nv x nv each, in turns of one solution and the next.
   NULL: not wanted. In the end: of c->moved and c->nu. */
typedef struct rbdi_step_columns {
    rbd_real *dq[3], *dv[3];
} rbdi_step_columns;

/* Parts of the memory for derivatives, behind c->sigma: M, later G; two matrices; two for columns that the
   caller does not want; derivatives of J nu without impulses, a row for each contact, by three x. */
RBDI_LOCAL rbd_real *rbdi_side(const rbd_model *m, const rbd_contact_set *c, int k) {
    const int nv = m->nv, shared = RBDI_CONTACT_SHARED(nv, c->max_rows);
    return c->sigma + c->max_rows * nv + (k > 0 ? shared + (k - 1) * nv * nv : 0);
}

/* B = dt dID(q_mid, w, a(w))/dw and M, both without contacts; if Q is not NULL, dt dID/dq_mid. */
RBDI_LOCAL void rbdi_write_sides(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                 const rbd_real *nu, const rbd_real *f_ext, rbd_real *Q, rbd_real *B,
                                 rbd_real *M) {
    const int size = m->nv * m->nv;
    rbdi_straight_acceleration(m, c->points, c->at, c->straight);
    for (int k = 0; k < m->nv; ++k) d->a[k] = (nu[k] - c->v_mid[k]) / c->dt + c->straight[k];
    if (Q) rbdi_clear(Q, size); /* rbd_keep_zeros leaves entries out */
    if (B) rbdi_clear(B, size), rbdi_clear(M, size);
    (void)rbd_id_derivatives(m, d, c->q_mid, c->at, d->a, f_ext, Q, B, M);
    if (Q) rbdi_multiply(Q, c->dt, size);
}

/* X -= A, packed, of which X has all entries. */
RBDI_LOCAL void rbdi_subtract_packed(const rbd_model *m, const rbd_real *A, rbd_real *X) {
    for (int i = 0; i < m->nv; ++i) {
        const rbd_real *entry = &A[m->dof[i].row + m->dof[i].depth];
        for (int j = i; j >= 0; j = m->dof[j].lambda, --entry) {
            X[i * m->nv + j] = X[i * m->nv + j] - *entry;
            if (j < i) X[j * m->nv + i] = X[j * m->nv + i] - *entry;
        }
    }
}

/* Adds rho without the terms by q_mid at fixed w, which come into Q, and without d(J' p). last: dnu of the
   solution before, NULL = w is v_mid. */
RBDI_LOCAL void rbdi_add_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *nu,
                             const rbd_real *f_ext, rbd_real *const *last, rbd_real *const rho[3]) {
    const rbd_real half = rbdi_set(RBD_C(0.5));
    const int n = m->nv;
    rbd_real *M = rbdi_side(m, c, 0), *B = rbdi_side(m, c, 1), *Q = rho[0] ? rbdi_side(m, c, 2) : NULL;
    rbdi_write_sides(m, c, d, nu, f_ext, Q, B, M);
    for (int k = 0; k < n * n; ++k) {
        B[k] = B[k] * c->dt + M[k];
        if (rho[1]) rho[1][k] = rho[1][k] - M[k];
        if (rho[2] && k % (n + 1) == 0) rho[2][k] = rho[2][k] - c->dt;
    }
    if (c->added && rho[1]) rbdi_subtract_packed(m, c->added, rho[1]);
    rbdi_unforced_columns(m, c->points, c->at, c->dt, n, M);
    for (int k = 0; k < n * n; ++k) {
        B[k] = last ? (B[k] - M[k]) * half : B[k] - M[k];
        if (rho[1]) rho[1][k] = rho[1][k] + B[k];
    }
    rbdi_multiply(B, -rbdi_set(RBD_C(1)), n * n);
    if (!last) return;

    for (int x = 0; x < 3; ++x) {
        if (!rho[x]) continue;
        for (int k = 0; k < n; ++k) rbdi_subtract_product(&B[k * n], last[x], n, n, &rho[x][k * n]);
    }
}

/* The same in place of what was there. */
RBDI_LOCAL void rbdi_write_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *nu,
                               const rbd_real *f_ext, rbd_real *const *last, rbd_real *const rho[3]) {
    for (int x = 0; x < 3; ++x)
        if (rho[x]) rbdi_clear(rho[x], m->nv * m->nv);
    rbdi_add_rho(m, c, d, nu, f_ext, last, rho);
}

/* Adds Q, the terms by q_mid at fixed w. */
RBDI_LOCAL void rbdi_add_side(const rbd_model *m, const rbd_contact_set *c, rbd_real *const rho[3]) {
    if (rho[0]) rbdi_subtract(rho[0], -rbdi_set(RBD_C(1)), rbdi_side(m, c, 2), m->nv * m->nv);
}

/* Factors of a row in sigma: of derivatives of J nu and, of the middle of the step, of the gap or error, its
   rate and its gamma. */
typedef struct rbdi_row_factors {
    rbd_real velocity[6], gap[6], rate[6];
} rbdi_row_factors;

/* Adds to the derivatives of gamma by a dof what the place of contact has beyond the point of the body: with
   r = roll_radius and the normal n of the plane on which the place stays, if it does,

       gamma = acc + omega x (omega x r) - rate (omega x n),   rate = n . velocity

   By q the place moves over the body by its roll, and r by n (n . s): together by z x r. */
RBDI_LOCAL void rbdi_roll_rates(const rbdi_pair_motion *pair, rbdi_motion_derivatives *by) {
    const rbdi_v3 omega = pair->motion.velocity.omega, r = pair->roll_radius, n = pair->normal;
    const rbdi_v3 z = by->S.omega, dw = by->velocity_q.omega;
    const rbdi_v3 across = rbdi_cross(omega, r), shift = rbdi_cross(z, r), turn = rbdi_cross(omega, n);
    const rbd_real rate = rbdi_dot(n, pair->motion.velocity.v), rate_q = rbdi_dot(n, by->velocity_q.v),
                   rate_v = rbdi_dot(n, by->S.v);

    by->rate_q.v = rbdi_cross_add(by->rate_q.v, pair->motion.rate.omega, rbdi_roll(pair, by->S));
    by->rate_q.v = rbdi_cross_add(by->rate_q.v, dw, across);
    by->rate_q.v = rbdi_cross_add(by->rate_q.v, omega, rbdi_add(rbdi_cross(dw, r), rbdi_cross(omega, shift)));
    by->rate_q.v = rbdi_sub(by->rate_q.v, rbdi_scale(rate_q, turn));
    by->rate_q.v = rbdi_sub(by->rate_q.v, rbdi_scale(rate, rbdi_cross(dw, n)));

    by->rate_v.v = rbdi_cross_add(rbdi_cross_add(by->rate_v.v, z, across), omega, shift);
    by->rate_v.v = rbdi_sub(by->rate_v.v, rbdi_scale(rate_v, turn));
    by->rate_v.v = rbdi_sub(by->rate_v.v, rbdi_scale(rate, rbdi_cross(z, n)));
}

/* Adds a constraint's terms to sigma, by q_mid or v_mid (x = 0, 1). With f->velocity by v_mid, J takes the
   place of the derivative of J nu. Leaves the S of the dofs in d. */
RBDI_LOCAL void rbdi_row_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                               const rbdi_constraint *con, const rbdi_pair_motion *pair,
                               const rbdi_row_factors *f, int x) {
    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            rbdi_motion_derivatives by = rbdi_differentiate_motion(m, c->rows, pair, walk.side, walk.link, j);
            rbd_real sum[3][RBDI_SIX_ROWS], *to = &c->sigma[con->row * m->nv + rbdi_source(m, l->iv + j)];
            rbdi_motion velocity, rate;
            rbdi_store_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH, by.S);
            rbdi_roll_rates(pair, &by);
            velocity = x == 0 ? by.velocity_q : by.S;
            rate = x == 0 ? by.rate_q : by.rate_v;
            rbdi_clear(sum[0], 3 * RBDI_SIX_ROWS);
            rbdi_add_held(con, &pair->h, velocity.omega, velocity.v, sum[0]);
            rbdi_add_held(con, &pair->h, rbdi_differentiate_error(con, pair, by.S.omega), by.S.v, sum[1]);
            rbdi_add_held(con, &pair->h, rate.omega, rate.v, sum[2]);
            for (int r = 0; r < con->rows; ++r, to += m->nv)
                *to = *to + f->velocity[r] * sum[0][r] + f->gap[r] * sum[1][r] + f->rate[r] * sum[2][r];
        }
    }
}

RBDI_LOCAL rbdi_pair_motion rbdi_contact_pair(const rbd_contact_set *c, int i) {
    const rbdi_constraint *con = &c->rows->constraint[i];
    rbdi_pair_motion pair = rbdi_pair_motion_of(c->rows, con);
    if (i < c->n) {
        const rbdi_v3 normal = rbdi_contact_normal(c->rows, con);
        pair.roll_radius = rbdi_scale(c->contact[i].below, normal);
        if (c->contact[i].on_plane) pair.normal = normal;
    }
    return pair;
}

/* The bias of row r of a constraint. */
RBDI_LOCAL rbdi_bias rbdi_bias_of(const rbd_contact_set *c, int i, int purpose, int r) {
    if (i >= c->n) return rbdi_held_bias(c, purpose, c->rows->constraint[i].row + r);
    return r == 2 ? rbdi_contact_bias(c, purpose, &c->contact[i]) : rbdi_no_bias();
}

/* Adds the terms by q_mid at the velocity nu: of J nu and of the gap to sigma, -d(J' p) to rho. */
RBDI_LOCAL void rbdi_velocity_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                                    const rbd_real *nu, int purpose, rbd_real *rho) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_constraint_set *s = c->rows;
    rbdi_constraint_state(m, s, rbdi_expand_v(m, nu, s->w->vx), s->w->zero, none, 0);
    for (int i = 0; i < s->n; ++i) {
        const rbdi_constraint *con = &s->constraint[i];
        rbdi_row_factors f;
        rbdi_pair_motion pair;
        if (con->row < 0) continue;
        for (int r = 0; r < con->rows; ++r) {
            const rbdi_bias bias = rbdi_bias_of(c, i, purpose, r);
            f.velocity[r] = rbdi_set(RBD_C(1));
            f.rate[r] = rbdi_zero();
            f.gap[r] = bias.by_start + bias.by_reach;
        }
        pair = rbdi_contact_pair(c, i);
        rbdi_row_terms(m, c, d, con, &pair, &f, 0);
        rbdi_differentiate_forces(m, d, con, &pair, rho);
    }
}

/* Adds to sigma the terms of gamma and, in the bias, of the rate in the middle of the step, by q_mid or v_mid
   (x = 0, 1). gamma holds the classical accelerations by v, so by v_mid it has J da/dv beyond the rate. */
RBDI_LOCAL void rbdi_middle_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                                  int purpose, int x) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    const rbd_real half = c->half;
    rbd_constraint_set *s = c->rows;
    rbdi_straight_acceleration(m, c->points, c->v_mid, c->straight);
    rbdi_constraint_state(m, s, rbdi_expand_v(m, c->v_mid, s->w->vx), rbdi_expand_v(m, c->straight, s->w->ax),
                          none, 0);
    for (int pass = x == 0; pass < 2; ++pass) { /* 0: -J, which becomes -J - J dW/dv */
        for (int i = 0; i < s->n; ++i) {
            const rbdi_constraint *con = &s->constraint[i];
            rbdi_row_factors f;
            rbdi_pair_motion pair;
            if (con->row < 0) continue;
            for (int r = 0; r < con->rows; ++r) {
                const rbdi_bias bias = rbdi_bias_of(c, i, purpose, r);
                const rbd_real gamma = half + half * half / 2 * (bias.by_start - bias.by_reach) -
                                       half * bias.by_rate + 2 * half * bias.by_falls;
                f.gap[r] = rbdi_zero();
                f.rate[r] = pass ? gamma : rbdi_zero();
                f.velocity[r] = pass ? bias.by_rate - half * bias.by_start - bias.by_falls : -gamma;
                if (pass && x == 1) f.velocity[r] = f.velocity[r] + gamma;
            }
            pair = rbdi_contact_pair(c, i);
            rbdi_row_terms(m, c, d, con, &pair, &f, x);
        }
        if (pass == 0) rbdi_unforced_columns(m, c->points, c->v_mid, rbdi_set(RBD_C(1)), s->rows, c->sigma);
    }
}

/* Where the derivatives of J nu by x are, nu without impulses, of contact i. */
RBDI_LOCAL rbd_real *rbdi_fall_columns(const rbd_model *m, const rbd_contact_set *c, int i, int x) {
    return rbdi_side(m, c, 5) + (x * c->n + i) * m->nv;
}

/* Writes them, of contacts that may rebound. dnu: of nu without impulses, by x. */
RBDI_LOCAL void rbdi_write_falls(const rbd_model *m, rbd_contact_set *c, const rbd_real *nu,
                                 rbd_real *const dnu[3]) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_constraint_set *s = c->rows;
    rbdi_constraint_state(m, s, rbdi_expand_v(m, nu, s->w->vx), s->w->zero, none, 0);
    for (int i = 0; i < c->n; ++i) {
        const rbdi_constraint *con = &s->constraint[i];
        rbdi_pair_motion pair;
        if (con->row < 0 || !(c->contact[i].restitution > 0)) continue;
        pair = rbdi_contact_pair(c, i);
        for (int x = 0; x < 3; ++x) rbdi_clear(rbdi_fall_columns(m, c, i, x), m->nv);
        for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);)
            for (int j = 0; j < rbdi_link_dofs(m, &m->link[walk.link]); ++j) {
                const rbdi_motion_derivatives by =
                    rbdi_differentiate_motion(m, s, &pair, walk.side, walk.link, j);
                const int k = rbdi_source(m, m->link[walk.link].iv + j);
                const rbdi_v3 normal = rbdi_contact_normal(s, con);
                rbd_real *own = &rbdi_fall_columns(m, c, i, 0)[k];
                *own = *own + rbdi_dot(normal, by.velocity_q.v);
                for (int x = 0; x < 3; ++x)
                    if (dnu[x])
                        rbdi_subtract(rbdi_fall_columns(m, c, i, x), -rbdi_dot(normal, by.S.v),
                                      &dnu[x][k * m->nv], m->nv);
            }
    }
}

/* Adds the terms of what contacts that rebound fall, by any x, of limits, by q_mid and v_mid, and of dry
   friction that turns around, by v_mid. */
RBDI_LOCAL void rbdi_other_terms(const rbd_model *m, rbd_contact_set *c, int purpose, int x) {
    for (int i = 0; i < c->n; ++i) {
        const rbdi_contact *contact = &c->contact[i];
        rbd_real by_falls;
        if (contact->row < 0 || !contact->rebounds) continue;
        by_falls = rbdi_rebound_bias(c, contact).by_falls;
        if (by_falls > 0)
            rbdi_subtract(&c->sigma[(contact->row + 2) * m->nv], -by_falls, rbdi_fall_columns(m, c, i, x),
                          m->nv);
    }
    for (const rbdi_limit_row *limit = c->limit; x < 2 && limit < c->limit + c->limits; ++limit) {
        rbdi_bias bias;
        if (limit->row < 0) continue;
        bias = rbdi_limit_bias(c, purpose, limit);
        c->sigma[limit->row * m->nv + limit->dof] =
            limit->side * (x == 0 ? bias.by_start + bias.by_reach : bias.by_rate - c->half * bias.by_start);
    }
    for (const rbdi_bounded_row *row = c->bound; x == 1 && row < c->bound + c->bounds; ++row) {
        if (row->row < 0 || !(rbdi_abs(row->turn) > 0)) continue;
        for (int j = 0; j < row->law.dofs; ++j)
            c->sigma[row->row * m->nv + row->law.dof[j]] = row->law.jacobian[j];
    }
}

/* Replaces rho by dnu of (5). Returns 0 if the impulses have no derivative. */
RBDI_LOCAL int rbdi_solve_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_real *rho) {
    rbd_constraint_set *s = c->rows;
    rbdi_contact_solver solver = c->solver;
    const int n = m->nv;
    int solved;
    rbdi_solve_transposed(m, s->w, s->w->H, n, n, rho);
    for (int r = 0; r < s->rows; ++r) {
        for (int k = 0; k < n; ++k) s->x[k] = s->Y[k * s->stride + r] * s->D_inverse[k];
        rbdi_subtract_product(s->x, rho, n, n, &c->sigma[r * n]);
    }
    solver.G = c->sigma + c->max_rows * n;
    solver.sides = n;
    rbdi_list_unknowns(&solver);
    rbdi_newton_matrix(&solver, RBDI_SIDES_PROXIMAL, c->sigma);
    solved = rbdi_newton_solve(&solver);
    rbdi_clear(c->sigma, s->rows * n);
    rbdi_add_increments(&solver, c->sigma);
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
    rbdi_copy_columns(m, to->dq, to->dv);
    rbdi_add_side(m, c, to->dv);
    for (int x = 0; x < 3; ++x)
        if (to->dv[x]) rbdi_multiply(to->dv[x], -rbdi_set(RBD_C(1)), size);
    solved = rbdi_differentiate_solution(m, c, d, c->moved, RBDI_FOR_VELOCITIES, to->dq);

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

    for (int k = 0; k < m->nv; ++k) nu[k] = c->x[RBDI_X_UNCORRECTED][k];
    rbdi_solve_forward(m, w, w->H, 1, 1, 1, nu);
    for (int k = 0; k < m->nv; ++k) nu[k] = c->v_mid[k] + nu[k];
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
    rbdi_differentiate_falls(m, c, d, f_ext, to->dq);
    rbdi_solve_first(m, c, first_order ? RBDI_FOR_POSITIONS : RBDI_FOR_VELOCITIES);
    rbdi_write_rho(m, c, d, c->moved, f_ext, NULL, to->dq);
    if (!first_order) {
        solved = rbdi_differentiate_corrections(m, c, d, tau, f_ext, to);
        rbdi_write_rho(m, c, d, c->moved, f_ext, to->dv, to->dq);
    }

    rbdi_copy_columns(m, to->dq, to->dv);
    positions = rbdi_differentiate_solution(m, c, d, c->moved, RBDI_FOR_POSITIONS, to->dq);
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
    size = m->nv * m->nv;
    if (by.dq[1] && !by.dq[0]) {
        by.dq[0] = rbdi_side(m, c, 3);
        by.dv[0] = rbdi_side(m, c, 4);
    }
    rbdi_choose_scheme(c, dt, c->options.first_order);
    status = rbdi_begin_step(m, c, q, v, tau, f_ext, damping);
    if (!status) solved = rbdi_differentiate_step(m, c, d, tau, f_ext, &by, &status);
    for (int x = 0; x < 3 && !status; ++x)
        if (by.dq[x]) rbdi_move_columns(m, c->points, c->moved, c->nu, c->way, x == 0, by.dq[x], by.dv[x]);
    if (by.dq[0] && !status) {
        rbdi_columns_before(m, c->points, v, c->half, by.dq[0], by.dq[1]);
        rbdi_columns_before(m, c->points, v, c->half, by.dv[0], by.dv[1]);
    }
    for (int x = 0; x < 3; ++x)
        if (by.dq[x]) solved &= rbdi_all_finite(by.dq[x], size) & rbdi_all_finite(by.dv[x], size);
    if (!status && !solved) status = RBD_ERR_SINGULAR;
    if (status) rbd_contact_reset(c);
    for (int x = 0; x < 3; ++x)
        if (status && by.dq[x]) rbdi_clear(by.dq[x], size);
    for (int x = 0; x < 3; ++x)
        if (status && by.dv[x]) rbdi_clear(by.dv[x], size);
    if (to.q_next) rbdi_contact_move(m, c, status, q, to.q_next, to.v_next);
    return status;
}

#endif
