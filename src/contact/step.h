#ifndef RBDI_CONTACT_STEP_H
#define RBDI_CONTACT_STEP_H
#include "motion/manifold.h"
#include "constraints/calls.h"
#include "contact/solver.h"
#include "contact/joints.h"
#include "contact/rows.h"
#include "contact/reduction.h"

/* ---- step code [step code] ---- */

/* Computes the state, the factor w->H of M + dt damping, and s->x = L^-T dt (tau - c - damping v). */
static rbd_status rbdi_contact_free(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                    const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                    const rbd_real *damping) {
    rbd_constraint_set *s = c->rows;
    rbd_work *w = s->w;
    rbdi_mask doubt;
    rbdi_constraint_bias(m, s, q, v, f_ext, w->gravity);
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->nv > 0) rbdi_unforced_velocity(u, &v[u->iv], c->dt, &c->start[u->iv]);
    for (int k = 0; k < m->nv; ++k) {
        rbd_real *diagonal = &w->H[m->dof[k].row + m->dof[k].depth];
        rbd_real d = damping ? damping[k] : rbdi_zero();
        if (c->options.joint_damping) d = d + rbdi_joint_damping(m, k);
        *diagonal = *diagonal + c->dt * d;
        s->x[k] = c->dt * (tau[k] - w->bias[k] - d * c->start[k]);
    }
    doubt = rbdi_factor(m, w, w->H);
    rbdi_sweep_back(m, s, w->H);
    return rbdi_factor_status(m, w, w->H, doubt, s->x, m->nv);
}

/* nu of the impulses by (4). */
static void rbdi_contact_respond(const rbd_model *m, rbd_contact_set *c, rbd_real *nu) {
    rbd_constraint_set *s = c->rows;
    for (int k = 0; k < m->nv; ++k) s->x[k] = c->x[k];
    rbdi_sweep_down(m, s, s->w->H);
    for (int k = 0; k < m->nv; ++k) nu[k] = c->start[k] + s->x[k];
}

/* Computes c->moved, the velocities by which positions change. */
static rbd_status rbdi_solve_positions(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       const rbd_real *damping, rbd_real dt) {
    rbd_constraint_set *s = c->rows;
    rbd_contact_problem given;
    rbd_status status;
    c->dt = dt;
    status = rbdi_contact_free(m, c, q, v, tau, f_ext, damping);
    if (status) return status;
    given.contacts = rbdi_list_rows(m, c, q, v);
    given.bounded = s->rows - 3 * given.contacts;
    rbdi_write_rows(m, c);
    rbdi_reduce_rows(m, s, s->w->H);
    rbdi_write_delta(m, c);
    for (int r = 0; r < s->rows; ++r) c->b[r] = -s->b[r];
    (void)rbdi_write_biases(c, RBDI_FOR_POSITIONS);
    for (int k = 0; k < m->nv; ++k) c->x[k] = s->x[k];
    given.delta = s->R, given.b = c->b, given.friction = c->friction;
    given.lower = c->lower, given.upper = c->upper;
    given.tolerance = RBD_C(c->options.tolerance), given.iterations = c->options.iterations;
    rbdi_contact_begin(&c->solver, &given, s->lambda);
    rbdi_contact_iterate(&c->solver);
    rbdi_contact_respond(m, c, c->moved);
    return RBD_OK;
}

/* Keeps impulses, states and forces for the next step and the caller. */
static void rbdi_keep_impulses(rbd_contact_set *c) {
    const rbd_constraint_set *s = c->rows;
    c->last_dt = c->dt;
    rbdi_clear(c->impulse, c->max_rows);
    for (int r = 0; r < s->rows; ++r) c->impulse[c->place[r]] = s->lambda[r];
    for (int i = 0; i < c->n; ++i) {
        rbdi_contact *contact = &c->contact[i];
        rbdi_axes_held h;
        for (int j = 0; j < 3; ++j) contact->force[j] = rbdi_zero();
        if (contact->row < 0) continue;
        contact->state = c->solver.law[contact->row / 3].state;
        rbdi_set_axes(s, &s->constraint[i], &h);
        for (int r = 0; r < 3; ++r)
            for (int j = 0; j < 3; ++j)
                contact->force[j] =
                    contact->force[j] + h.axis[3 + j][r] * s->lambda[contact->row + r] / c->dt;
    }
}

/* Computes c->nu, the velocities at the end, in the axes of the beginning. They differ from c->moved if
   penetration was corrected, or a contact that pushed rebounds. Overflow and NaN clear the set's impulses. */
static rbd_status rbdi_solve_velocities(const rbd_model *m, rbd_contact_set *c) {
    const rbd_contact_solution first = c->solver.solution;
    int finite = rbdi_all_finite(c->b, c->rows->rows);
    rbdi_find_rebounds(c);
    for (int k = 0; k < m->nv; ++k) c->nu[k] = c->moved[k];
    c->differ = rbdi_write_biases(c, RBDI_FOR_VELOCITIES);
    if (c->differ) {
        rbdi_contact_iterate(&c->solver);
        rbdi_contact_respond(m, c, c->nu);
        c->solver.solution.residual = rbdi_worse(first.residual, c->solver.solution.residual);
        c->solver.solution.sweeps += first.sweeps;
        c->solver.solution.newton_steps += first.newton_steps;
    }
    rbdi_keep_impulses(c);
    for (int k = 0; k < m->nv; ++k)
        finite &= rbdi_abs(c->nu[k]) < RBDI_FASTEST && rbdi_abs(c->dt * c->moved[k]) < RBDI_FASTEST;
    for (int i = 0; i < c->n; ++i) finite &= rbdi_all_finite(c->contact[i].force, 3);
    if (!finite) rbd_contact_reset(c);
    return finite ? RBD_OK : RBD_ERR_NAN;
}

/* Writes the state after the step; after an error, q and v = 0. */
static void rbdi_contact_move(const rbd_model *m, const rbd_contact_set *c, rbd_status status,
                              const rbd_real *q, rbd_real *q_next, rbd_real *v_next) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb && !status; ++u) {
        if (u->nv == 0) continue;
        rbdi_move_straight(u, &q[u->iq], &c->moved[u->iv], c->dt, &q_next[u->iq]);
        rbdi_turn_velocity(u, &c->moved[u->iv], c->dt, &c->nu[u->iv], &v_next[u->iv]);
    }
    for (int k = 0; status && k < m->nq; ++k) q_next[k] = q[k];
    if (status) rbdi_clear(v_next, m->nv);
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
    if (!status) status = rbdi_solve_velocities(m, c);
    rbdi_contact_move(m, c, status, q, q_next, v_next);
    return status;
}

RBDI_API rbd_status rbd_contact_fd(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                   const rbd_real *damping, rbd_real dt, rbd_real *a) {
    rbd_status status = rbdi_check_step(m, c, q && v && tau && a, dt);
    if (status) return status;
    status = rbdi_solve_positions(m, c, q, v, tau, f_ext, damping, dt);
    if (!status) status = rbdi_solve_velocities(m, c);
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
