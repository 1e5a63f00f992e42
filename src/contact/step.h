#ifndef RBDI_CONTACT_STEP_H
#define RBDI_CONTACT_STEP_H
#include "motion/free_step.h"
#include "contact/biases.h"
#include "contact/reduction.h"
#include "contact/momentum.h"

/* ---- step code [step code] ----
   The midpoint scheme of Moreau (1999), with two corrections of the velocity terms. Half of the way is made
   by v: to q_mid, and v_mid is v in its axes. There all matrices are made, once. Then nu is solved for, and
   makes the other half of the way:

       K = M + A + dt d,   nu = v_mid + K^-1 (dt (tau - ID(q_mid, at, a(at)) - d v_mid) + J' p)

   with the matrix A that the caller adds, the damping d, and the accelerations a(at) of [straight moves]. The
   velocity terms are those of the mean velocity: first at = v_mid, then twice at = (v_mid + nu) / 2 of the nu
   before. Contacts are solved for the first and the last time; the nu between has the impulses of the first.
   Without these, light links that the ground holds would race away. For a vector that turns by x a step the
   length grows in order x^4 / 8 with one correction, and falls in that order with two; from x = 1.4 on
   rbdi_guard_solution sums the series. Energy then changes by half of p'(u before + u after). */

/* x = L^-T dt (tau - w->bias - damping v_mid). */
RBDI_LOCAL void rbdi_free_impulse(const rbd_model *m, const rbd_contact_set *c, const rbd_real *tau,
                                  rbd_real *x) {
    rbd_work *w = c->rows->w;
    const rbd_real *bias = w->bias;
    for (int k = 0; k < m->nv; ++k) x[k] = c->dt * (tau[k] - bias[k] - c->damping[k] * c->v_mid[k]);
    rbdi_vector_transposed(m, w, w->H, x);
}

/* Adds the caller's matrix and the damping to M, and factors the sum. Returns whether a pivot is in doubt. */
RBDI_LOCAL rbdi_mask rbdi_factor_damped(const rbd_model *m, rbd_contact_set *c, const rbd_real *damping) {
    rbd_constraint_set *s = c->rows;
    rbd_work *w = s->w;
    rbdi_mask doubt;

    /* K = M + A + dt d */
    if (c->added)
        for (int k = 0; k < m->nh; ++k) w->H[k] = w->H[k] + c->added[k];
    for (int k = 0; k < m->nv; ++k) {
        rbd_real *diagonal = &w->H[m->dof[k].row + m->dof[k].depth];
        c->damping[k] = damping ? damping[k] : rbdi_zero();
        if (c->options.joint_damping) c->damping[k] = c->damping[k] + rbdi_joint_damping(m, k);
        *diagonal = *diagonal + c->dt * c->damping[k];
    }

    doubt = rbdi_factor(m, w, w->H);
    for (int k = 0; k < m->nv; ++k) s->D_inverse[k] = w->H[m->dof[k].row + m->dof[k].depth];
    return doubt;
}

/* The middle of the step (or, with c->half = 0, its beginning): state, rows, factor, and x without
   corrections. */
RBDI_LOCAL rbd_status rbdi_begin_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                      const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                      const rbd_real *damping) {
    rbd_constraint_set *s = c->rows;
    rbd_work *w = s->w;
    rbdi_mask doubt;

    if (c->added && !rbdi_all_finite(c->added, m->nh)) return RBD_ERR_NAN;

    rbdi_move_joints(m, c->points, q, v, v, c->half, c->q_mid, c->v_mid);
    for (int k = 0; k < m->nv; ++k) c->at[k] = c->v_mid[k];
    rbdi_straight_acceleration(m, c->points, c->at, c->straight);
    rbdi_constraint_bias(m, s, c->q_mid, c->at, rbdi_expand_v(m, c->straight, w->ax), f_ext, w->gravity);

    c->contacts = rbdi_list_rows(m, c, q, v);
    rbdi_write_rows(m, c);

    if (c->options.momentum) rbdi_note_centres(m, c);
    doubt = rbdi_factor_damped(m, c, damping);
    rbdi_free_impulse(m, c, tau, c->x[RBDI_X_UNCORRECTED]);
    return rbdi_factor_status(m, w, w->H, doubt, c->x[RBDI_X_UNCORRECTED], m->nv);
}

/* x of the velocity terms of at = (v_mid + nu) / 2, in c->at. */
RBDI_LOCAL void rbdi_correct(const rbd_model *m, rbd_contact_set *c, const rbd_real *nu, const rbd_real *tau,
                             const rbd_real *f_ext, rbd_real *x) {
    rbd_work *w = c->rows->w;
    for (int k = 0; k < m->nv; ++k) c->at[k] = (c->v_mid[k] + nu[k]) / 2;

    rbdi_straight_acceleration(m, c->points, c->at, c->straight);
    rbdi_rnea(m, w, rbdi_expand_v(m, c->at, w->vx), rbdi_expand_v(m, c->straight, w->ax), f_ext,
              rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    rbdi_free_impulse(m, c, tau, x);
}

/* nu of x and the impulses p:

       nu = v_mid + L^-1 D^-1 (x + Y p) */
RBDI_LOCAL void rbdi_contact_respond(const rbd_model *m, rbd_contact_set *c, const rbd_real *x,
                                     rbd_real *nu) {
    rbd_constraint_set *s = c->rows;
    for (int k = 0; k < m->nv; ++k) nu[k] = x[k] + rbdi_y_lambda(s, s->lambda, k);
    rbdi_vector_forward(m, s->w, s->w->H, nu);
    for (int k = 0; k < m->nv; ++k) nu[k] = c->v_mid[k] + nu[k];
}

/* Gives the rows of the step to the solver, with biases, springs, and the impulses to begin with. */
RBDI_LOCAL void rbdi_pose_problem(rbd_contact_set *c, int purpose) {
    const rbd_constraint_set *s = c->rows;
    rbd_contact_problem given;
    (void)rbdi_write_biases(c, purpose);

    given.contacts = c->contacts;
    given.bounded = s->rows - 3 * c->contacts;
    given.delta = s->R;
    given.b = c->b;
    given.friction = c->friction;
    given.lower = c->lower;
    given.upper = c->upper;
    given.tolerance = RBD_C(c->options.tolerance);
    given.iterations = c->options.iterations;

    rbdi_contact_begin(&c->solver, &given, s->lambda);
    if (purpose == RBDI_FOR_VELOCITIES) c->solver.given.tolerance = c->solver.given.tolerance * RBDI_LOOSE;
    rbdi_add_springs(c);
}

/* Solves for the first time, without corrections and with these biases. Computes c->moved. */
RBDI_LOCAL void rbdi_solve_first(const rbd_model *m, rbd_contact_set *c, int purpose) {
    rbd_constraint_set *s = c->rows;

    for (int k = 0; k < m->nv; ++k) s->x[k] = c->x[RBDI_X_UNCORRECTED][k];
    if (s->rows > 0) {
        rbdi_reduce_rows(m, s, s->w->H);
        rbdi_write_delta(m, c);
    }
    rbdi_find_falls(c);
    for (int r = 0; r < s->rows; ++r) c->b[r] = -s->b[r];

    rbdi_pose_problem(c, purpose);
    rbdi_contact_iterate(&c->solver);
    rbdi_contact_respond(m, c, c->x[RBDI_X_UNCORRECTED], c->moved);
}

/* Corrects the velocity terms for the first time: c->x[RBDI_X_CORRECTED], and c->moved with the impulses as
   they are. Returns whether velocities change by more than rounding: they do not at rest, or where nothing
   turns. Speeds count as the solver's tolerance at least. */
RBDI_LOCAL int rbdi_solve_between(const rbd_model *m, rbd_contact_set *c, const rbd_real *tau,
                                  const rbd_real *f_ext) {
    rbd_real *change = c->rows->x; /* of velocities, by the first correction */
    rbd_real changes = rbdi_zero();
    rbd_real speeds = c->solver.given.tolerance;

    rbdi_correct(m, c, c->moved, tau, f_ext, c->x[RBDI_X_CORRECTED]);
    for (int k = 0; k < m->nv; ++k) change[k] = c->x[RBDI_X_CORRECTED][k] - c->x[RBDI_X_UNCORRECTED][k];
    rbdi_vector_forward(m, c->rows->w, c->rows->w->H, change);

    for (int k = 0; k < m->nv; ++k) {
        changes = changes + rbdi_abs(change[k]);
        speeds = speeds + rbdi_abs(c->moved[k]);
        c->moved[k] = c->moved[k] + change[k];
    }
    return !(changes <= RBDI_EPS * speeds);
}

/* Corrects them again: c->x[RBDI_X_CORRECTED_TWICE], and the velocities without impulses. */
RBDI_LOCAL void rbdi_correct_again(const rbd_model *m, rbd_contact_set *c, const rbd_real *tau,
                                   const rbd_real *f_ext) {
    rbd_constraint_set *s = c->rows;
    rbdi_correct(m, c, c->moved, tau, f_ext, c->x[RBDI_X_CORRECTED_TWICE]);
    rbdi_guard_solution(m, s->w->H, c->x[RBDI_X_UNCORRECTED], c->x[RBDI_X_CORRECTED],
                        c->x[RBDI_X_CORRECTED_TWICE]);

    for (int k = 0; k < m->nv; ++k) {
        const rbdi_span span = s->span[k];
        rbdi_subtract(&s->b[span.first],
                      (c->x[RBDI_X_CORRECTED_TWICE][k] - c->x[RBDI_X_UNCORRECTED][k]) * s->D_inverse[k],
                      &s->Y[k * s->stride + span.first], span.end - span.first);
    }
    for (int r = 0; r < s->rows; ++r) c->b[r] = -s->b[r];
}

/* Corrects again, if the first correction changed anything; solves with the biases of positions, and computes
   c->moved. Where neither correction nor biases changed anything, the first solution stays if it is good
   enough. c->early keeps the impulses of the first solution for rbdi_solve_apart. */
RBDI_LOCAL void rbdi_solve_again(const rbd_model *m, rbd_contact_set *c, const rbd_real *tau,
                                 const rbd_real *f_ext, int changed) {
    const rbd_contact_solution first = c->solver.solution;
    const rbd_constraint_set *s = c->rows;

    if (changed) {
        rbdi_correct_again(m, c, tau, f_ext);
    } else {
        for (int k = 0; k < m->nv; ++k) c->x[RBDI_X_CORRECTED_TWICE][k] = c->x[RBDI_X_CORRECTED][k];
    }

    for (int r = 0; r < s->rows; ++r) c->early[r] = s->lambda[r];
    c->solver.given.tolerance = c->solver.given.tolerance / RBDI_LOOSE;
    for (int i = 0; i < c->bounds; ++i) rbdi_find_turn(c, &c->bound[i]);
    changed |= rbdi_write_biases(c, RBDI_FOR_POSITIONS) > 0;

    if (changed || !(first.residual <= c->solver.given.tolerance)) {
        rbdi_contact_iterate(&c->solver);
        c->solver.solution.sweeps += first.sweeps;
        c->solver.solution.newton_steps += first.newton_steps;
    }

    /* anew: a change that c->moved rounds away would be missing in each step */
    rbdi_contact_respond(m, c, c->x[RBDI_X_CORRECTED_TWICE], c->moved);
}

/* Chooses the scheme: half of the way by v, or all of it by the solution. */
RBDI_LOCAL void rbdi_choose_scheme(rbd_contact_set *c, rbd_real dt, int first_order) {
    c->dt = dt;
    c->way = first_order ? dt : dt / 2;
    c->half = first_order ? rbdi_zero() : c->way;
    c->points = first_order ? RBDI_ORIGINS : RBDI_CENTRES;
}

/* Computes c->moved, the velocities by which positions change. */
RBDI_LOCAL rbd_status rbdi_solve_positions(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                           const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                           const rbd_real *damping) {
    const int first_order = !(c->half > 0);
    const rbd_status status = rbdi_begin_step(m, c, q, v, tau, f_ext, damping);
    int changed;
    if (status) return status;

    rbdi_solve_first(m, c, first_order ? RBDI_FOR_POSITIONS : RBDI_FOR_VELOCITIES);
    if (first_order) return RBD_OK;

    changed = rbdi_solve_between(m, c, tau, f_ext);
    rbdi_solve_again(m, c, tau, f_ext, changed);
    return RBD_OK;
}

/* Keeps impulses, states and forces for the next step and the caller. */
RBDI_LOCAL void rbdi_keep_impulses(rbd_contact_set *c) {
    const rbd_constraint_set *s = c->rows;
    const rbd_real inverse = 1 / c->dt;

    c->last_dt = c->dt;
    rbdi_clear(c->impulse, c->max_rows);
    for (int r = 0; r < s->rows; ++r) c->impulse[c->place[r]] = s->lambda[r];

    for (int i = 0; i < c->n; ++i) {
        rbdi_contact *contact = &c->contact[i];
        rbdi_v3 impulse;
        rbdi_clear(contact->force, 3);
        if (contact->row < 0) continue;

        contact->state = c->solver.law[contact->row / 3].state;
        contact->pushes |= s->lambda[contact->row + 2] > 0;
        impulse = rbdi_contact_vector(s, &s->constraint[i], &s->lambda[contact->row]);
        rbdi_store_vec(contact->force, 1, rbdi_scale(inverse, impulse));
    }

    for (int i = 0; i < c->bounds; ++i) rbdi_keep_bounded(c, &c->bound[i]);
}

/* Solves for c->nu with biases that differ from those of the positions by `asked` at most, m/s. If positions
   had no solution, their impulses may be huge: then those of rbdi_solve_first are the better beginning. A
   contact that jams, because friction presses it into the plane, cannot be lifted: what is left of the laws
   is as much as the corrections ask for. Then positions of all dofs move by c->nu, without corrections, or
   the contact would creep through the plane. */
RBDI_LOCAL void rbdi_solve_apart(const rbd_model *m, rbd_contact_set *c, rbd_real asked) {
    const rbd_contact_solution first = c->solver.solution;
    const int again = c->half > 0 && first.residual > c->solver.given.tolerance;

    if (again)
        for (int r = 0; r < c->rows->rows; ++r) c->rows->lambda[r] = c->early[r];

    rbdi_contact_iterate(&c->solver);
    rbdi_contact_respond(m, c, c->half > 0 ? c->x[RBDI_X_CORRECTED_TWICE] : c->x[RBDI_X_UNCORRECTED], c->nu);

    c->jams = again && first.residual > RBDI_JAMS * asked && c->solver.solution.residual < first.residual;
    if (c->jams)
        for (int k = 0; k < m->nv; ++k) c->moved[k] = c->nu[k];

    c->solver.solution.residual = rbdi_worse(first.residual, c->solver.solution.residual);
    c->solver.solution.sweeps += first.sweeps;
    c->solver.solution.newton_steps += first.newton_steps;
}

/* Computes c->nu, the velocities at the end, in the axes of the beginning. They differ from c->moved if
   penetration was corrected, or a contact that pushed rebounds. */
RBDI_LOCAL rbd_status rbdi_solve_velocities(const rbd_model *m, rbd_contact_set *c) {
    int finite = rbdi_all_finite(c->b, c->rows->rows) && rbdi_all_finite(c->q_mid, m->nq);
    rbd_real asked;

    /* nu is c->moved, unless biases differ */
    rbdi_find_rebounds(c);
    for (int k = 0; k < m->nv; ++k) c->nu[k] = c->moved[k];
    asked = rbdi_write_biases(c, RBDI_FOR_VELOCITIES);
    c->differ = asked > 0;
    c->jams = 0;
    if (c->differ) rbdi_solve_apart(m, c, asked);
    rbdi_keep_impulses(c);

    for (int k = 0; k < m->nv; ++k)
        finite &= rbdi_abs(c->nu[k]) < RBDI_FASTEST && rbdi_abs(c->dt * c->moved[k]) < RBDI_FASTEST;
    for (int i = 0; i < c->n; ++i) {
        finite &= rbdi_all_finite(c->contact[i].force, 3);
        finite &= rbdi_all_finite(&c->contact[i].gap.start, 1);
    }

    return finite ? RBD_OK : RBD_ERR_NAN;
}

/* Computes c->moved and c->nu. After an error the set has no impulses, and all gaps are 0. */
RBDI_LOCAL rbd_status rbdi_solve_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                      const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                      const rbd_real *damping) {
    rbd_status status = rbdi_solve_positions(m, c, q, v, tau, f_ext, damping);
    if (!status) status = rbdi_solve_velocities(m, c);
    if (status) rbd_contact_reset(c);
    return status;
}

/* Writes the state after the step; after an error, q and v = 0. */
RBDI_LOCAL void rbdi_contact_move(const rbd_model *m, const rbd_contact_set *c, rbd_status status,
                                  const rbd_real *q, rbd_real *q_next, rbd_real *v_next) {
    if (!status) {
        rbdi_move_joints(m, c->points, c->q_mid, c->moved, c->nu, c->way, q_next, v_next);
        return;
    }

    for (int k = 0; k < m->nq; ++k) q_next[k] = q[k];
    rbdi_clear(v_next, m->nv);
}

RBDI_LOCAL rbd_status rbdi_check_step(const rbd_model *m, const rbd_contact_set *c, int arrays, rbd_real dt) {
    const rbd_status status = c ? rbdi_check_constrained(m, c->rows, arrays) : RBD_ERR_NULL;
    if (status) return status;
    return dt > 1 / RBDI_UNBOUNDED && dt < RBDI_UNBOUNDED ? RBD_OK : RBD_ERR_RANGE;
}

RBDI_API rbd_status rbd_contact_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                     const rbd_real *damping, rbd_real dt, rbd_real *q_next,
                                     rbd_real *v_next) {
    rbd_status status = rbdi_check_step(m, c, q && v && tau && q_next && v_next, dt);
    int flies;
    if (status) return status;

    rbdi_choose_scheme(c, dt, c->options.first_order);
    status = rbdi_solve_step(m, c, q, v, tau, f_ext, damping);

    flies = !status && c->options.momentum && rbdi_any_flies(m, c);
    if (flies) rbdi_wanted_momentum(m, c, q, v, tau, f_ext);
    rbdi_contact_move(m, c, status, q, q_next, v_next);
    if (flies) rbdi_restore_momentum(m, c, q_next, v_next);
    return status;
}

RBDI_API rbd_status rbd_contact_fd(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                   const rbd_real *damping, rbd_real dt, rbd_real *a) {
    rbd_status status = rbdi_check_step(m, c, q && v && tau && a, dt);
    if (status) return status;

    rbdi_choose_scheme(c, dt, 1);
    status = rbdi_solve_step(m, c, q, v, tau, f_ext, damping);

    /* a = (nu - v_mid) / dt + a(at), by [straight moves] */
    for (int k = 0; k < m->nv; ++k) a[k] = (c->nu[k] - c->v_mid[k]) / dt + c->straight[k];
    if (!status && !rbdi_all_finite(a, m->nv)) status = RBD_ERR_NAN;
    if (status) rbdi_clear(a, m->nv);
    return status;
}

RBDI_API rbd_contact_state rbd_contact_get(const rbd_contact_set *c, int i, rbd_real *gap,
                                           rbd_real force[3]) {
    const int there = c && i >= 0 && i < c->n;
    if (gap) *gap = there ? c->contact[i].gap.start : rbdi_zero();
    if (force)
        for (int j = 0; j < 3; ++j) force[j] = there ? c->contact[i].force[j] : rbdi_zero();
    return there ? c->contact[i].state : RBD_APART;
}

RBDI_API rbd_contact_solution rbd_contact_last(const rbd_contact_set *c) {
    const rbd_contact_solution none = {0, 0, 0};
    return c ? c->solver.solution : none;
}

#endif
