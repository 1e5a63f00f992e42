#ifndef RBDI_CONTACT_STEP_H
#define RBDI_CONTACT_STEP_H
#include "motion/manifold.h"
#include "constraints/calls.h"
#include "contact/solver.h"
#include "contact/rows.h"

/* ---- step code [step code] ---- */

/* The state, w->H = L'DL of M + dt damping, and c->x = L^-T dt (tau - c - damping v). */
static rbd_status rbdi_contact_free(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                    const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                    const rbd_real *damping, rbd_real dt) {
    rbd_constraint_set *s = c->rows;
    rbd_work *w = s->w;
    rbdi_mask doubt;
    rbd_crba_packed(m, w, q, w->H);
    rbdi_constraint_state(m, s, rbdi_expand_v(m, v, w->vx), w->zero, w->gravity, 1);
    rbdi_external(m, w, f_ext);
    rbdi_rnea_sweep(m, w, w->zero, rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_glide(u, &v[u->iv], dt, &c->start[u->iv]);
    }
    for (int k = 0; k < m->nv; ++k) {
        rbd_real *diagonal = &w->H[m->dof[k].row + m->dof[k].depth];
        rbd_real d = damping ? damping[k] : rbdi_zero();
        if (c->options.joint_damping) d = d + m->dof[k].damping;
        *diagonal = *diagonal + dt * d;
        s->x[k] = dt * (tau[k] - w->bias[k] - d * c->start[k]);
    }
    doubt = rbdi_factor(m, w, w->H);
    rbdi_sweep_back(m, s, w->H);
    return rbdi_status_of(m, w, doubt, s->x, m->nv);
}

/* nu from the impulses: (4). */
static void rbdi_contact_respond(const rbd_model *m, rbd_contact_set *c, rbd_real *nu) {
    rbd_constraint_set *s = c->rows;
    for (int k = 0; k < m->nv; ++k) s->x[k] = c->x[k];
    rbdi_sweep_down(m, s, s->w->H);
    for (int k = 0; k < m->nv; ++k) nu[k] = c->start[k] + s->x[k];
}

/* Keeps impulses, states and forces. */
static void rbdi_keep_impulses(rbd_contact_set *c, rbd_real dt) {
    const rbd_constraint_set *s = c->rows;
    c->last_dt = dt;
    for (int i = 0; i < c->n; ++i) {
        rbdi_contact *a = &c->contact[i];
        rbdi_axes_held h;
        for (int j = 0; j < 3; ++j) a->impulse[j] = a->force[j] = rbdi_zero();
        if (a->row < 0) continue;
        a->state = c->solver.law[a->row / 3].state;
        rbdi_set_axes(s, &s->constraint[i], &h);
        for (int r = 0; r < 3; ++r) {
            a->impulse[r] = s->lambda[a->row + r];
            for (int j = 0; j < 3; ++j) a->force[j] = a->force[j] + h.x[3 + j][r] * a->impulse[r] / dt;
        }
    }
    for (rbd_real *p = c->held_impulse; p < c->lower; ++p)
        *p = s->lambda[3 * c->solver.given.contacts + (int)(p - c->held_impulse)];
    for (int i = 0; i < c->dof_rows; ++i)
        c->dof_row[i].impulse = c->dof_row[i].row < 0 ? rbdi_zero() : s->lambda[c->dof_row[i].row];
}

/* c->moved and c->nu: velocities of the positions and of the end, in the axes of the beginning. First the
   former. */
static rbd_status rbdi_solve_positions(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       const rbd_real *damping, rbd_real dt) {
    rbd_constraint_set *s = c->rows;
    rbd_contact_problem given;
    const rbd_status status = rbdi_contact_free(m, c, q, v, tau, f_ext, damping, dt);
    if (status) return status;
    given.contacts = rbdi_list_rows(m, c, q, v, dt);
    given.bounded = s->rows - 3 * given.contacts;
    rbdi_write_rows(m, c);
    rbdi_reduce_rows(m, s, s->w->H);
    rbdi_write_delta(m, c);
    rbdi_begin_rows(c, given.contacts, dt);
    rbdi_write_biases(c, dt, RBDI_FOR_POSITIONS);
    for (int k = 0; k < m->nv; ++k) c->x[k] = s->x[k];
    given.delta = s->R, given.b = c->b, given.friction = c->friction;
    given.lower = c->lower, given.upper = c->upper;
    given.tolerance = RBD_C(c->options.tolerance), given.iterations = c->options.iterations;
    rbdi_contact_begin(&c->solver, &given, s->lambda);
    rbdi_contact_iterate(&c->solver);
    rbdi_contact_respond(m, c, c->moved);
    return RBD_OK;
}

/* Then the latter. Returns whether it is another. */
static int rbdi_solve_velocities(const rbd_model *m, rbd_contact_set *c, rbd_real dt) {
    const rbd_contact_solution first = c->solver.solution;
    const int differ = rbdi_needs_velocities(c, dt);
    for (int k = 0; k < m->nv; ++k) c->nu[k] = c->moved[k];
    if (differ) {
        rbdi_write_biases(c, dt, RBDI_FOR_VELOCITIES);
        rbdi_contact_iterate(&c->solver);
        rbdi_contact_respond(m, c, c->nu);
        c->solver.solution.residual = rbdi_worse(first.residual, c->solver.solution.residual);
        c->solver.solution.sweeps += first.sweeps;
        c->solver.solution.newton_steps += first.newton_steps;
    }
    rbdi_keep_impulses(c, dt);
    return differ;
}

/* Whether velocities and steps are numbers; a set that overflowed forgets its impulses. */
static rbd_status rbdi_contact_status(const rbd_model *m, rbd_contact_set *c, rbd_real dt) {
    for (int k = 0; k < m->nv; ++k)
        if (!(rbdi_abs(c->nu[k]) < RBDI_FASTEST && rbdi_abs(dt * c->moved[k]) < RBDI_FASTEST)) {
            rbd_contact_reset(c);
            return RBD_ERR_NAN;
        }
    return RBD_OK;
}

/* The state after the step; after an error q and 0. */
static void rbdi_contact_move(const rbd_model *m, const rbd_contact_set *c, rbd_status status,
                              const rbd_real *q, rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    for (int b = 0; b < m->nb && !status; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv == 0) continue;
        rbdi_move_straight(u, &q[u->iq], &c->moved[u->iv], dt, &q_next[u->iq]);
        rbdi_turn_velocity(u, &c->moved[u->iv], dt, &c->nu[u->iv], &v_next[u->iv]);
    }
    if (!status) return;
    for (int k = 0; k < m->nq; ++k) q_next[k] = q[k];
    rbdi_clear(v_next, m->nv);
}

static rbd_status rbdi_check_step(const rbd_model *m, const rbd_contact_set *c, int arrays, rbd_real dt) {
    const rbd_status status = c ? rbdi_check_constraints(m, c->rows, arrays) : RBD_ERR_NULL;
    if (status) return status;
    return dt > 1 / RBDI_UNBOUNDED && dt < RBDI_UNBOUNDED ? RBD_OK : RBD_ERR_RANGE;
}

RBDI_API rbd_status rbd_contact_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                     const rbd_real *damping, rbd_real dt, rbd_real *q_next,
                                     rbd_real *v_next) {
    rbd_status status = rbdi_check_step(m, c, q && v && tau && q_next && v_next, dt);
    if (status) return status;
    status = rbdi_solve_positions(m, c, q, v, tau, f_ext, damping, dt);
    if (!status) {
        (void)rbdi_solve_velocities(m, c, dt);
        status = rbdi_contact_status(m, c, dt);
    }
    rbdi_contact_move(m, c, status, q, dt, q_next, v_next);
    return status;
}

RBDI_API rbd_status rbd_contact_fd(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                   const rbd_real *damping, rbd_real dt, rbd_real *a) {
    rbd_status status = rbdi_check_step(m, c, q && v && tau && a, dt);
    if (status) return status;
    status = rbdi_solve_positions(m, c, q, v, tau, f_ext, damping, dt);
    if (!status) {
        (void)rbdi_solve_velocities(m, c, dt);
        status = rbdi_contact_status(m, c, dt);
    }
    for (int k = 0; k < m->nv; ++k) a[k] = status ? rbdi_zero() : (c->nu[k] - c->start[k]) / dt;
    return status;
}

RBDI_API rbd_contact_state rbd_contact_get(const rbd_contact_set *c, int i, rbd_real *gap,
                                           rbd_real force[3]) {
    const int there = c && i >= 0 && i < c->n;
    if (gap) *gap = there ? c->contact[i].gap : rbdi_zero();
    for (int j = 0; force && j < 3; ++j) force[j] = there ? c->contact[i].force[j] : rbdi_zero();
    return there ? c->contact[i].state : RBD_APART;
}

RBDI_API rbd_contact_solution rbd_contact_last(const rbd_contact_set *c) {
    const rbd_contact_solution none = {0, 0, 0};
    return c ? c->solver.solution : none;
}

#endif
