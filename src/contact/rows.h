#ifndef RBDI_CONTACT_ROWS_H
#define RBDI_CONTACT_ROWS_H
#include "dynamics/packed.h"
#include "constraints/factor.h"
#include "constraints/set.h"
#include "contact/layout.h"
#include "contact/tolerances.h"

/* ---- contact rows [contact rows] ----
   The rows of a step: contacts first, three each, then held constraints, then single dofs. By the factor
   M + dt damping = L'DL of [packed matrix], with Y = L^-T J' and x = L^-T dt (tau - c - damping v):

       Delta = Y' D^-1 Y,   J nu_0 = J v + Y' D^-1 x,   nu = v + L^-1 D^-1 (x + Y p)                      (4)

   where v is in the axes of the step's beginning, [manifold code]. J is that of the place of contact at q.
   The place moves over a ball, so dJ/dt of a point fixed in it has no part in this: the point of a wheel
   accelerates upward, its gap does not. */

/* World axes of the normal of a constraint. */
RBDI_INLINE rbdi_v3 rbdi_contact_normal(const rbd_constraint_set *s, const rbdi_constraint *con) {
    const rbdi_v3 normal =
        rbdi_vec(rbdi_set(con->held[0][2]), rbdi_set(con->held[1][2]), rbdi_set(con->held[2][2]));
    return con->link[1] < 0 ? normal : rbdi_mul_t(s->w->kin[con->link[1]].X.E, normal);
}

/* Computes gap and velocity of approach, and moves frame 1 of the constraint to the place of contact. */
static void rbdi_contact_gap(const rbd_constraint_set *s, rbdi_constraint *con, rbdi_contact *contact) {
    const rbdi_v3 normal = rbdi_contact_normal(s, con),
                  local = con->link[0] < 0 ? normal : rbdi_mul(s->w->kin[con->link[0]].X.E, normal);
    rbdi_relative_motion relative;
    con->position[0].x = contact->point.x - contact->radius * (rbd_const)local.x;
    con->position[0].y = contact->point.y - contact->radius * (rbd_const)local.y;
    con->position[0].z = contact->point.z - contact->radius * (rbd_const)local.z;
    relative = rbdi_relative_motion_of(s, con);
    contact->gap = rbdi_dot(normal, rbdi_sub(relative.body[0].p, rbdi_frame_origin(s, con, 1)));
    contact->approach = rbdi_dot(normal, relative.velocity.v);
}

/* Whether this distance may become 0 within two steps, or is at most the margin, or not a number. */
RBDI_INLINE int rbdi_may_touch(rbd_real distance, rbd_real rate, rbd_real dt, rbd_real margin) {
    return !(distance > margin && distance + 2 * dt * rate > 0);
}

/* Computes the distance to the limit. Returns whether it may be reached; dry friction always acts. */
static int rbdi_find_limit(rbdi_dof_row *limit, const rbd_real *q, const rbd_real *v, rbd_real dt) {
    limit->distance = rbdi_zero();
    if (limit->iq < 0) return 1;
    limit->distance = limit->side > 0 ? q[limit->iq] - limit->lower : limit->upper - q[limit->iq];
    return rbdi_may_touch(limit->distance, limit->side * v[limit->dof], dt, rbdi_set(RBDI_NEAR_LIMIT));
}

/* Writes a dof and its ancestors, ascending, to s->path. Returns how many. */
static int rbdi_path_to(const rbd_model *m, const rbd_constraint_set *s, int dof) {
    const int n = m->dof[dof].depth + 1;
    for (int t = n - 1; t >= 0; --t, dof = m->dof[dof].lambda) s->path[t] = (int16_t)dof;
    return n;
}

/* Appends n rows, of this place and those behind it, with entries in these dofs. Returns the first. */
static int rbdi_open_rows(rbd_contact_set *c, int place, int n, const int16_t *dof, int dofs) {
    rbd_constraint_set *s = c->rows;
    const int row = s->rows;
    for (int r = 0; r < n; ++r) c->place[s->rows++] = (int16_t)(place + r);
    for (int t = 0; t < dofs; ++t) {
        rbdi_span *span = &s->span[dof[t]];
        if (span->end == 0) span->first = (int16_t)row;
        span->end = (int16_t)s->rows;
    }
    return row;
}

/* Lists the rows of the step with their bounds, and the impulses of the last step, times dt over its dt, to
   begin with. Returns the number of contacts. */
static int rbdi_list_rows(const rbd_model *m, rbd_contact_set *c, const rbd_real *q, const rbd_real *v) {
    rbd_constraint_set *s = c->rows;
    const rbd_real dt = c->dt, ratio = dt / c->last_dt;
    int place = 0, contacts;
    for (int k = 0; k < m->nv; ++k) s->span[k].first = s->span[k].end = 0;
    s->rows = 0;
    for (int i = 0; i < c->n; ++i, place += 3) {
        rbdi_constraint *con = &s->constraint[i];
        rbdi_contact *contact = &c->contact[i];
        rbdi_contact_gap(s, con, contact);
        contact->row = con->row = -1, contact->state = RBD_APART;
        if (!rbdi_may_touch(contact->gap, contact->approach, dt, RBD_C(c->options.margin))) continue;
        c->friction[s->rows / 3] = rbdi_set(contact->friction);
        contact->row = con->row = (int16_t)rbdi_open_rows(c, place, 3, con->dof, con->dofs);
    }
    contacts = s->rows / 3;
    for (rbdi_constraint *con = s->constraint + c->n; con < s->constraint + s->n; place += con++->rows) {
        con->row = (int16_t)rbdi_open_rows(c, place, con->rows, con->dof, con->dofs);
        for (int r = con->row - 3 * contacts; r < s->rows - 3 * contacts; ++r)
            c->upper[r] = rbdi_set(RBDI_UNBOUNDED), c->lower[r] = -c->upper[r];
    }
    for (int i = 0; i < c->dof_rows; ++i) {
        rbdi_dof_row *limit = &c->dof_row[i];
        const int r = s->rows - 3 * contacts, acts = rbdi_find_limit(limit, q, v, dt);
        limit->row = acts ? rbdi_open_rows(c, place + i, 1, s->path, rbdi_path_to(m, s, limit->dof)) : -1;
        if (!acts) continue;
        c->lower[r] = limit->iq < 0 ? dt * limit->lower : rbdi_zero();
        c->upper[r] = limit->iq < 0 ? dt * limit->upper : rbdi_set(RBDI_UNBOUNDED);
    }
    s->stride = rbdi_row_stride(s->rows);
    rbdi_clear(s->lambda, s->stride);
    for (int r = 0; r < s->rows; ++r) s->lambda[r] = c->impulse[c->place[r]] * ratio;
    return contacts;
}

/* Y = J', and target = -J c->start. */
static void rbdi_write_rows(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    rbdi_clear(s->Y, m->nv * s->stride);
    rbdi_clear(s->target, (int)(s->e - s->target) + s->stride); /* u and gamma too */
    for (int i = 0; i < s->n; ++i)
        if (s->constraint[i].row >= 0) rbdi_constraint_rows(m, s, &s->constraint[i], i >= c->n);
    for (int i = 0; i < c->dof_rows; ++i)
        if (c->dof_row[i].row >= 0)
            s->Y[c->dof_row[i].dof * s->stride + c->dof_row[i].row] = c->dof_row[i].side;
    for (int k = 0; k < m->nv; ++k) {
        const rbdi_span span = s->span[k];
        rbdi_subtract(&s->target[span.first], c->start[k], &s->Y[k * s->stride + span.first],
                      span.end - span.first);
    }
}

/* Delta of (4), rows x rows, in s->R; first the upper triangle, in rows of s->stride. Rows that rounding
   alone moves get 0 on the diagonal: no impulse changes their velocity. Slip and stiffness are added last. */
static void rbdi_write_delta(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    const int n = s->rows;
    rbd_real *delta = s->R;
    rbdi_bound_noise(m, s);
    for (const rbdi_constraint *con = s->constraint; con < s->constraint + s->n; ++con)
        if (con->row >= 0) rbdi_delta(s, con->dof, con->dofs, con->row, con->rows);
    for (int i = 0; i < c->dof_rows; ++i) {
        const rbdi_dof_row *limit = &c->dof_row[i];
        if (limit->row >= 0) rbdi_delta(s, s->path, rbdi_path_to(m, s, limit->dof), limit->row, 1);
    }
    for (int r = 0; r < n; ++r) {
        for (int t = 0; t < r; ++t) delta[r * n + t] = delta[t * n + r];
        for (int t = r; t < n; ++t) delta[r * n + t] = delta[r * s->stride + t];
        if (delta[r * n + r] <= s->noise) delta[r * n + r] = rbdi_zero();
    }
    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact)
        for (int j = 0; j < 3 && contact->row >= 0; ++j) {
            rbd_real *d = &delta[(contact->row + j) * (n + 1)];
            if (j < 2)
                *d = *d + RBD_C(c->options.slip) / c->dt;
            else if (contact->stiffness > 0 && contact->gap <= 0)
                *d = *d + 1 / (c->dt * (c->dt * contact->stiffness + contact->damping));
        }
}

/* ---- biases [biases] ----
   The bias is added to u_n, so that p_n >= 0, u_n >= 0, p_n u_n = 0 is the law in each case:

     apart      gap / dt: the gap is at least 0 at the end
     rigid      0; for positions, below the slop, the option `correction` times the depth below it over dt
     stiff      k gap / (dt k + d), and 1 / (dt (dt k + d)) on Delta's diagonal: together the implicit spring
                and damper p_n = -dt (k (gap + dt u_n) + d u_n), stable at every dt
     rebounds   for velocities, restitution times the approach
     leaves     for velocities, if another contact rebounds: the speed at which it leaves, where that is more
                than its gap / dt

   Without friction a rebound makes no energy then, whatever the restitutions are: impulses do the work
   p'(u+ + u-)/2, of approach and end. A contact that pushes has u+ = -e u- if it rebounds or leaves (e = 1),
   or u+ = -gap / dt; in each case u+ + u- <= 0.

   The option `slip` adds a damper along the plane: slip / dt on the diagonal, so that u_t + slip p_t / dt is
   the velocity that sticks or slips. */

enum { RBDI_FOR_POSITIONS, RBDI_FOR_VELOCITIES };

/* A bias, m/s, and its derivative by the gap. */
typedef struct rbdi_bias {
    rbd_real value, gain;
} rbdi_bias;

/* The bias at this gap of a contact, or distance of a limit. Dry friction, at 0, has none. */
static rbdi_bias rbdi_bias_at(const rbd_contact_set *c, int purpose, rbd_real gap, rbd_const stiffness,
                              rbd_const damping) {
    const rbd_real dt = c->dt, deeper = gap + RBD_C(c->options.slop);
    rbdi_bias x = {gap, rbdi_zero()};
    if (gap > 0)
        x.gain = 1 / dt;
    else if (stiffness > 0)
        x.gain = stiffness / (dt * stiffness + damping);
    else if (purpose == RBDI_FOR_POSITIONS && deeper < 0)
        x.value = deeper, x.gain = RBD_C(c->options.correction) / dt;
    x.value = x.value * x.gain;
    return x;
}

/* The share of the approach that a contact returns with: all of it if it leaves. */
static rbd_const rbdi_rebound_share(const rbdi_contact *contact) {
    return contact->approach > 0 ? RBD_C(1) : contact->restitution;
}

static rbdi_bias rbdi_contact_bias(const rbd_contact_set *c, int purpose, const rbdi_contact *contact) {
    const rbdi_bias rebound = {contact->approach * rbdi_rebound_share(contact), rbdi_zero()};
    if (purpose == RBDI_FOR_VELOCITIES && contact->rebounds) return rebound;
    return rbdi_bias_at(c, purpose, contact->gap, contact->stiffness, contact->damping);
}

static rbdi_bias rbdi_limit_bias(const rbd_contact_set *c, int purpose, const rbdi_dof_row *limit) {
    const rbdi_bias rebound = {limit->rate, rbdi_zero()};
    if (purpose == RBDI_FOR_VELOCITIES && limit->rebounds) return rebound;
    return rbdi_bias_at(c, purpose, limit->distance, 0, 0);
}

/* Whether a rigid row leaves, faster than it may close its gap. */
static int rbdi_leaves(const rbd_contact_set *c, rbd_real gap, rbd_real rate) {
    return rate > 0 && rate > rbdi_bias_at(c, RBDI_FOR_VELOCITIES, gap, 0, 0).value;
}

/* Finds the contacts that rebound by the first solution, and then those that leave. */
static void rbdi_find_rebounds(rbd_contact_set *c) {
    int any = 0;
    for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        contact->rebounds = contact->row >= 0 && contact->restitution > 0 &&
                            contact->approach < -RBD_C(c->options.bounce) &&
                            c->rows->lambda[contact->row + 2] > 0;
        any |= contact->rebounds;
    }

    for (rbdi_contact *contact = c->contact; any && contact < c->contact + c->n; ++contact) {
        const int springs = contact->stiffness > 0 && contact->gap <= 0;
        if (contact->row >= 0 && !springs && rbdi_leaves(c, contact->gap, contact->approach))
            contact->rebounds = 1;
    }
    for (rbdi_dof_row *limit = c->dof_row; limit < c->dof_row + c->dof_rows; ++limit) {
        limit->rate = limit->side * c->start[limit->dof];
        limit->rebounds =
            any && limit->row >= 0 && limit->iq >= 0 && rbdi_leaves(c, limit->distance, limit->rate);
    }
}

/* The bias of a held row with the error e, which counts as a penetration on either side. */
static rbdi_bias rbdi_held_bias(const rbd_contact_set *c, int purpose, rbd_real e) {
    rbdi_bias x = rbdi_bias_at(c, purpose, -rbdi_abs(e), 0, 0);
    if (e > 0) x.value = -x.value;
    return x;
}

/* c->b = J nu_0 + bias of a row, where J nu_0 = -s->b. Returns whether it changes. */
RBDI_INLINE int rbdi_write_bias(rbd_contact_set *c, int row, rbd_real bias) {
    const rbd_real before = c->b[row];
    c->b[row] = bias - c->rows->b[row];
    return c->b[row] < before || c->b[row] > before;
}

/* Writes c->b of all rows. Returns whether it changes. */
static int rbdi_write_biases(rbd_contact_set *c, int purpose) {
    const rbd_constraint_set *s = c->rows;
    int changed = 0;
    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact)
        if (contact->row >= 0)
            changed |= rbdi_write_bias(c, contact->row + 2, rbdi_contact_bias(c, purpose, contact).value);
    for (const rbdi_constraint *con = s->constraint + c->n; con < s->constraint + s->n; ++con)
        for (int r = con->row; r < con->row + con->rows; ++r)
            changed |= rbdi_write_bias(c, r, rbdi_held_bias(c, purpose, s->e[r]).value);
    for (const rbdi_dof_row *limit = c->dof_row; limit < c->dof_row + c->dof_rows; ++limit)
        if (limit->row >= 0)
            changed |= rbdi_write_bias(c, limit->row, rbdi_limit_bias(c, purpose, limit).value);
    return changed;
}

#endif
