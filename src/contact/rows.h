#ifndef RBDI_CONTACT_ROWS_H
#define RBDI_CONTACT_ROWS_H
#include "dynamics/packed.h"
#include "constraints/factor.h"
#include "constraints/set.h"
#include "contact/layout.h"
#include "contact/tolerances.h"

/* ---- contact rows [contact rows] ----
   The rows of a step: contacts first, three each, then what is held, then single dofs. By the factor M = L'DL
   of [packed matrix], with Y = L^-T J' and x = L^-T dt (tau - c):

       Delta = Y' D^-1 Y,   J nu_0 = J v + Y' D^-1 x,   nu = v + L^-1 D^-1 (x + Y p)                      (4)

   where v has the axes of the step's beginning, [manifold code]. J is that of the place of contact at q. The
   place moves over a ball, so nothing of dJ/dt has a part in this: a wheel's point accelerates upward, its
   gap does not. */

/* World axes of the normal of constraint k. */
RBDI_INLINE rbdi_v3 rbdi_contact_normal(const rbd_constraint_set *s, const rbdi_constraint *k) {
    const rbdi_v3 n = rbdi_vec(rbdi_set(k->held[0][2]), rbdi_set(k->held[1][2]), rbdi_set(k->held[2][2]));
    return k->link[1] < 0 ? n : rbdi_mul_t(s->w->kin[k->link[1]].X.E, n);
}

/* Gap and velocity of approach of a contact; the frame of its constraint comes to the place of contact. */
static void rbdi_contact_gap(const rbd_constraint_set *s, rbdi_constraint *k, rbdi_contact *a) {
    const rbdi_v3 n = rbdi_contact_normal(s, k);
    rbdi_station one, two;
    k->p[0] = a->point;
    one = rbdi_station_of(s, k, 0);
    a->gap = rbdi_dot(n, rbdi_sub(one.p, rbdi_station_of(s, k, 1).p)) - a->radius;
    if (a->radius > 0) {
        const rbdi_v3 x = k->link[0] < 0 ? n : rbdi_mul(s->w->kin[k->link[0]].X.E, n);
        k->p[0].x = a->point.x - a->radius * (rbd_const)x.x;
        k->p[0].y = a->point.y - a->radius * (rbd_const)x.y;
        k->p[0].z = a->point.z - a->radius * (rbd_const)x.z;
        one = rbdi_station_of(s, k, 0);
    }
    two = rbdi_station_at(s, k->link[1], one.p);
    a->approach = rbdi_dot(n, rbdi_sub(one.v, two.v));
}

/* Whether something at this distance may be reached within two steps, or is nearer than the margin. */
RBDI_INLINE int rbdi_may_touch(rbd_real distance, rbd_real rate, rbd_real dt, rbd_real margin) {
    return distance <= margin || distance + 2 * dt * rate <= 0;
}

/* The row of a limit that is near, or of dry friction; -1 if it is none. */
static int rbdi_dof_row_at(rbdi_dof_row *a, int row, const rbd_real *q, const rbd_real *v, rbd_real dt) {
    rbd_real below, above;
    a->row = row, a->distance = rbdi_zero(), a->side = rbdi_set(RBD_C(1));
    if (a->iq < 0) return 1;
    below = q[a->iq] - a->lower, above = a->upper - q[a->iq];
    if (above < below) a->side = -a->side;
    a->distance = above < below ? above : below;
    if (rbdi_may_touch(a->distance, a->side * v[a->dof], dt, rbdi_set(RBDI_NEAR_LIMIT))) return 1;
    a->row = -1;
    return 0;
}

/* Adds n rows from number `row` on to those that a dof has entries in. */
RBDI_INLINE void rbdi_widen_span(rbdi_span *span, int row, int n) {
    if (span->end == 0) span->first = (int16_t)row;
    span->end = (int16_t)(row + n);
}

static void rbdi_open_rows(rbd_constraint_set *s, rbdi_constraint *k, int row) {
    k->row = (int16_t)row;
    for (int t = 0; t < k->dofs; ++t) rbdi_widen_span(&s->span[k->dof[t]], row, k->rows);
}

/* Lists the rows of the step; returns the number of contacts among them. */
static int rbdi_list_rows(const rbd_model *m, rbd_contact_set *c, const rbd_real *q, const rbd_real *v,
                          rbd_real dt) {
    rbd_constraint_set *s = c->rows;
    int row = 0, contacts;
    for (int k = 0; k < m->nv; ++k) s->span[k].first = s->span[k].end = 0;
    for (int i = 0; i < c->n; ++i) {
        rbdi_contact *a = &c->contact[i];
        rbdi_contact_gap(s, &s->constraint[i], a);
        a->row = -1, a->state = RBD_APART;
        if (!rbdi_may_touch(a->gap, a->approach, dt, RBD_C(c->options.margin))) continue;
        a->row = row;
        c->friction[row / 3] = rbdi_set(a->friction);
        rbdi_open_rows(s, &s->constraint[i], row);
        row += 3;
    }
    contacts = row / 3;
    for (int i = c->n; i < c->n + c->held; row += s->constraint[i++].rows)
        rbdi_open_rows(s, &s->constraint[i], row);
    for (int i = 0; i < c->dof_rows; ++i) {
        rbdi_dof_row *a = &c->dof_row[i];
        if (!rbdi_dof_row_at(a, row, q, v, dt)) continue;
        for (int k = a->dof; k >= 0; k = m->dof[k].lambda) rbdi_widen_span(&s->span[k], row, 1);
        ++row;
    }
    s->rows = row, s->stride = rbdi_row_stride(row);
    return contacts;
}

/* Y = J', and target = -J v of the velocity c->start. */
static void rbdi_write_rows(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    rbdi_clear(s->Y, m->nv * s->stride);
    rbdi_clear(s->target, s->stride);
    rbdi_clear(s->u, s->stride);
    rbdi_clear(s->gamma, s->stride);
    rbdi_clear(s->e, s->stride);
    for (int i = 0; i < c->n; ++i)
        if (c->contact[i].row >= 0) rbdi_constraint_rows(m, s, &s->constraint[i], 0);
    for (int i = c->n; i < c->n + c->held; ++i) rbdi_constraint_rows(m, s, &s->constraint[i], 1);
    for (int i = 0; i < c->dof_rows; ++i)
        if (c->dof_row[i].row >= 0)
            s->Y[c->dof_row[i].dof * s->stride + c->dof_row[i].row] = c->dof_row[i].side;
    for (int k = 0; k < m->nv; ++k) {
        const rbdi_span span = s->span[k];
        rbdi_subtract(&s->target[span.first], c->start[k], &s->Y[k * s->stride + span.first],
                      span.end - span.first);
    }
}

/* Delta of (4), rows x rows, in s->R; first the upper triangle, in rows of s->stride. A row that
   rounding alone moves gets 0 on the diagonal: nothing gives way there. */
static void rbdi_write_delta(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    const int n = s->rows;
    rbd_real *delta = s->R;
    rbdi_bound_noise(m, s);
    for (int i = 0; i < c->n + c->held; ++i) {
        const rbdi_constraint *k = &s->constraint[i];
        if (i >= c->n || c->contact[i].row >= 0) rbdi_delta(s, k->dof, k->dofs, k->row, k->rows);
    }
    for (int i = 0; i < c->dof_rows; ++i) {
        const int dof = c->dof_row[i].dof, depth = m->dof[dof].depth;
        if (c->dof_row[i].row < 0) continue;
        for (int t = depth, k = dof; t >= 0; --t, k = m->dof[k].lambda) s->path[t] = (int16_t)k;
        rbdi_delta(s, s->path, depth + 1, c->dof_row[i].row, 1);
    }
    for (int r = 0; r < n; ++r) {
        for (int t = 0; t < r; ++t) delta[r * n + t] = delta[t * n + r];
        for (int t = r; t < n; ++t) delta[r * n + t] = delta[r * s->stride + t];
        if (delta[r * n + r] <= s->noise) delta[r * n + r] = rbdi_zero();
    }
}

/* Impulses of the last step, which a step of another length takes a share of; bounds of the rows behind the
   contacts; what stiffness adds to Delta. */
static void rbdi_begin_rows(rbd_contact_set *c, int contacts, rbd_real dt) {
    rbd_constraint_set *s = c->rows;
    const rbd_real share = c->last_dt > 0 ? dt / c->last_dt : rbdi_zero();
    const int held = (int)(c->lower - c->held_impulse);
    rbdi_clear(s->lambda, s->stride);
    for (int i = 0; i < c->n; ++i) {
        const rbdi_contact *a = &c->contact[i];
        if (a->row < 0) continue;
        for (int j = 0; j < 3; ++j) s->lambda[a->row + j] = a->impulse[j] * share;
        for (int j = 0; j < 3; ++j) {
            rbd_real *d = &s->R[(a->row + j) * (s->rows + 1)];
            if (j < 2)
                *d = *d + RBD_C(c->options.slip) / dt;
            else if (a->stiffness > 0 && a->gap <= 0)
                *d = *d + 1 / (dt * (dt * a->stiffness + a->damping));
        }
    }
    for (int i = 0; i < held; ++i) {
        s->lambda[3 * contacts + i] = c->held_impulse[i] * share;
        c->upper[i] = rbdi_set(RBDI_UNBOUNDED), c->lower[i] = -c->upper[i];
    }
    for (int i = 0; i < c->dof_rows; ++i) {
        const rbdi_dof_row *a = &c->dof_row[i];
        const int r = a->row - 3 * contacts;
        if (a->row < 0) continue;
        s->lambda[a->row] = a->impulse * share;
        c->lower[r] = a->iq < 0 ? dt * a->lower : rbdi_zero();
        c->upper[r] = a->iq < 0 ? dt * a->upper : rbdi_set(RBDI_UNBOUNDED);
    }
}

/* ---- biases [biases] ----
   The bias is added to u_n, so that 0 <= p_n, u_n >= 0 is the law in each case:

     apart      gap / dt: it may just touch at the end
     rigid      0; deeper than the slop, for positions, a share of the depth over dt
     stiff      k gap / (dt k + d), and 1 / (dt (dt k + d)) on Delta's diagonal: together the implicit spring
                and damper p_n = -dt (k (gap + dt u_n) + d u_n), stable at every dt
     rebounds   for velocities, restitution times the approach

   The option `slip` is the same along the plane: slip / dt on the diagonal, so that u_t + slip p_t / dt
   is what sticks or slips. */

enum { RBDI_FOR_POSITIONS, RBDI_FOR_VELOCITIES };

/* Velocity that takes a penetration back, m/s, and its derivative by the gap, which is negative then. */
RBDI_INLINE rbd_real rbdi_correction_gain(const rbd_contact_set *c, rbd_real gap, rbd_real dt) {
    return gap + RBD_C(c->options.slop) < 0 ? RBD_C(c->options.correction) / dt : rbdi_zero();
}
RBDI_INLINE rbd_real rbdi_correction(const rbd_contact_set *c, rbd_real gap, rbd_real dt) {
    return rbdi_correction_gain(c, gap, dt) * (gap + RBD_C(c->options.slop));
}

/* Whether a contact that pushed rebounds. */
RBDI_INLINE int rbdi_rebounds(const rbd_contact_set *c, const rbdi_contact *a) {
    return a->restitution > 0 && a->approach < -RBD_C(c->options.bounce) && c->rows->lambda[a->row + 2] > 0;
}

/* Derivative of a contact's bias by the gap, and the bias. */
static rbd_real rbdi_gap_gain(const rbd_contact_set *c, const rbdi_contact *a, rbd_real dt, int purpose) {
    if (purpose == RBDI_FOR_VELOCITIES && a->rebounds) return rbdi_zero();
    if (a->gap > 0) return 1 / dt;
    if (a->stiffness > 0) return a->stiffness / (dt * a->stiffness + a->damping);
    return purpose == RBDI_FOR_POSITIONS ? rbdi_correction_gain(c, a->gap, dt) : rbdi_zero();
}
static rbd_real rbdi_contact_bias(const rbd_contact_set *c, const rbdi_contact *a, rbd_real dt, int purpose) {
    const rbd_real slop = a->gap > 0 || a->stiffness > 0 ? rbdi_zero() : RBD_C(c->options.slop);
    if (purpose == RBDI_FOR_VELOCITIES && a->rebounds) return a->approach * a->restitution;
    return rbdi_gap_gain(c, a, dt, purpose) * (a->gap + slop);
}

/* The same of a joint's limit. */
static rbd_real rbdi_limit_gain(const rbd_contact_set *c, const rbdi_dof_row *a, rbd_real dt, int purpose) {
    if (a->iq < 0) return rbdi_zero();
    if (a->distance > 0) return 1 / dt;
    return purpose == RBDI_FOR_POSITIONS ? rbdi_correction_gain(c, a->distance, dt) : rbdi_zero();
}

/* Of a held row with the error e. */
RBDI_INLINE rbd_real rbdi_held_bias(const rbd_contact_set *c, rbd_real e, rbd_real dt) {
    return e > 0 ? -rbdi_correction(c, -e, dt) : rbdi_correction(c, e, dt);
}

/* c->b, from J nu_0 = -s->b. */
static void rbdi_write_biases(rbd_contact_set *c, rbd_real dt, int purpose) {
    const rbd_constraint_set *s = c->rows;
    for (int r = 0; r < s->rows; ++r) c->b[r] = -s->b[r];
    for (int i = 0; i < c->n; ++i) {
        const rbdi_contact *a = &c->contact[i];
        if (a->row >= 0) c->b[a->row + 2] = c->b[a->row + 2] + rbdi_contact_bias(c, a, dt, purpose);
    }
    for (int i = c->n; i < c->n + c->held && purpose == RBDI_FOR_POSITIONS; ++i)
        for (int r = s->constraint[i].row; r < s->constraint[i].row + s->constraint[i].rows; ++r)
            c->b[r] = c->b[r] + rbdi_held_bias(c, s->e[r], dt);
    for (int i = 0; i < c->dof_rows; ++i) {
        const rbdi_dof_row *a = &c->dof_row[i];
        const rbd_real slop = a->distance > 0 ? rbdi_zero() : RBD_C(c->options.slop);
        if (a->row < 0) continue;
        c->b[a->row] = c->b[a->row] + rbdi_limit_gain(c, a, dt, purpose) * (a->distance + slop);
    }
}

/* Whether positions and velocities have different biases; notes who rebounds. */
static int rbdi_needs_velocities(rbd_contact_set *c, rbd_real dt) {
    const rbd_constraint_set *s = c->rows;
    int differ = 0;
    for (int i = 0; i < c->n; ++i) {
        rbdi_contact *a = &c->contact[i];
        if (a->row < 0) continue;
        a->rebounds = rbdi_rebounds(c, a);
        differ |= a->rebounds || (!(a->stiffness > 0) && rbdi_correction(c, a->gap, dt) < 0);
    }
    for (int i = c->n; i < c->n + c->held; ++i)
        for (int r = s->constraint[i].row; r < s->constraint[i].row + s->constraint[i].rows; ++r)
            differ |= rbdi_correction(c, -rbdi_abs(s->e[r]), dt) < 0;
    for (int i = 0; i < c->dof_rows; ++i)
        differ |= c->dof_row[i].row >= 0 && rbdi_correction(c, c->dof_row[i].distance, dt) < 0;
    return differ;
}

#endif
