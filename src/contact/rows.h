#ifndef RBDI_CONTACT_ROWS_H
#define RBDI_CONTACT_ROWS_H
#include "constraints/set.h"
#include "contact/bounded.h"

/* ---- contact rows [contact rows] ----
   The rows of a step: contacts first, three each, then held constraints, limits, bounded rows. By the factor
   M + dt damping = L'DL of [packed matrix], with Y = L^-T J' and x = L^-T dt (tau - ID - damping v):

       Delta = Y' D^-1 Y,   J nu_0 = J v + Y' D^-1 x,   nu = v + L^-1 D^-1 (x + Y p)                      (4)

   where v, M and J are those of the middle of the step, [step code], J of the place of contact. The laws
   hold for the velocity of the end

       u = J nu + dt/2 gamma,   gamma = dJ/dt v with classical accelerations 0

   The place of contact is l below the centre of a ball, against the normal n, and moves over the body. With
   the motion of the body relative to the plane, the centre has velocity v and acceleration a, and

       u = v - l omega x n,   gamma = a - l domega/dt x n - l' omega x n

   Of a ball, or of a point, l is the radius, and l' = 0: the point of a wheel accelerates upward, its gap
   does not. This is where an impact acts. But places of one body at different heights over a plane have
   different velocities along it when the body turns: three of them could not all stick. So where three
   contacts or more of two bodies touch, the place of each is the foot of its centre on the plane: l is the
   radius plus the gap, l' the rate of the gap. */

/* World axes of the normal of a constraint. */
RBDI_INLINE rbdi_v3 rbdi_contact_normal(const rbd_constraint_set *s, const rbdi_constraint *con) {
    const rbdi_v3 normal =
        rbdi_vec(rbdi_set(con->held[0][2]), rbdi_set(con->held[1][2]), rbdi_set(con->held[2][2]));
    return con->link[1] < 0 ? normal : rbdi_mul_t(s->w->kin[con->link[1]].X.E, normal);
}

/* World axes of a vector along the rows of a contact. */
RBDI_INLINE rbdi_v3 rbdi_contact_vector(const rbd_constraint_set *s, const rbdi_constraint *con,
                                        const rbd_real *x) {
    rbdi_v3 local;
    local.x = con->held[0][0] * x[0] + con->held[0][1] * x[1] + con->held[0][2] * x[2];
    local.y = con->held[1][0] * x[0] + con->held[1][1] * x[1] + con->held[1][2] * x[2];
    local.z = con->held[2][0] * x[0] + con->held[2][1] * x[1] + con->held[2][2] * x[2];
    return con->link[1] < 0 ? local : rbdi_mul_t(s->w->kin[con->link[1]].X.E, local);
}

/* A gap from that of the middle, with its first and second rate there. If the velocity then was u - half
   gamma, and u = 0 at the end, second order gives its way back and onward. */
RBDI_INLINE rbdi_gap rbdi_gap_of(rbd_real middle, rbd_real rate, rbd_real gamma, rbd_real half) {
    rbdi_gap gap;
    gap.rate = rate - half * gamma;
    gap.reach = middle - half * half / 2 * gamma;
    gap.start = gap.reach - half * gap.rate;
    return gap;
}

/* Moves frame 1 of the constraint to the place of contact, l below the centre. normal: world axes. */
RBDI_LOCAL void rbdi_place_below(const rbd_constraint_set *s, rbdi_constraint *con,
                                 const rbdi_contact *contact, rbdi_v3 normal) {
    const rbdi_v3 local = con->link[0] < 0 ? normal : rbdi_mul(s->w->kin[con->link[0]].X.E, normal);
    con->position[0].x = contact->point.x - (rbd_const)(contact->below * local.x);
    con->position[0].y = contact->point.y - (rbd_const)(contact->below * local.y);
    con->position[0].z = contact->point.z - (rbd_const)(contact->below * local.z);
}

/* Computes motion and gap, with the place of contact on the ball:

       gamma = acc + l omega x (omega x n) */
RBDI_LOCAL void rbdi_contact_gap(const rbd_contact_set *c, rbdi_constraint *con, rbdi_contact *contact) {
    const rbd_constraint_set *s = c->rows;
    const rbdi_v3 normal = rbdi_contact_normal(s, con);
    rbdi_relative_motion relative;
    rbdi_v3 omega, roll;

    contact->on_plane = 0;
    contact->below = rbdi_set(contact->radius);
    rbdi_place_below(s, con, contact, normal);
    relative = rbdi_relative_motion_of(s, con);

    omega = relative.velocity.omega;
    roll = rbdi_scale(contact->below, rbdi_cross(omega, rbdi_cross(omega, normal)));
    contact->velocity = relative.velocity;
    contact->rate = relative.rate;
    contact->rate.v = rbdi_add(relative.rate.v, roll);

    contact->middle = rbdi_dot(normal, rbdi_sub(relative.body[0].p, rbdi_frame_origin(s, con, 1)));
    contact->gap = rbdi_gap_of(contact->middle, rbdi_dot(normal, contact->velocity.v),
                               rbdi_dot(normal, contact->rate.v), c->half);
}

/* Moves the place of contact along n from the ball to the plane: l grows by the gap, and l' is n'v. For the
   point of the body at the new place

       v := v - gap omega x n,   gamma := gamma - gap domega/dt x n - l' omega x n */
RBDI_LOCAL void rbdi_place_on_plane(const rbd_constraint_set *s, rbdi_constraint *con,
                                    rbdi_contact *contact) {
    const rbdi_v3 normal = rbdi_contact_normal(s, con);
    const rbdi_v3 v = contact->velocity.v;
    const rbdi_v3 turn = rbdi_cross(contact->velocity.omega, normal);
    const rbdi_v3 faster = rbdi_cross(contact->rate.omega, normal);

    contact->on_plane = 1;
    contact->below = contact->below + contact->middle;
    rbdi_place_below(s, con, contact, normal);

    contact->velocity.v = rbdi_sub(v, rbdi_scale(contact->middle, turn));
    contact->rate.v = rbdi_sub(contact->rate.v, rbdi_scale(contact->middle, faster));
    contact->rate.v = rbdi_sub(contact->rate.v, rbdi_scale(rbdi_dot(normal, v), turn));
}

/* Whether this gap may become 0 within two steps, or is at most the margin, or not a number. */
RBDI_INLINE int rbdi_may_touch(rbdi_gap gap, rbd_real dt, rbd_real margin) {
    return !(gap.start > margin && gap.start + 2 * dt * gap.rate > 0);
}

/* Whether three contacts or more of the bodies of contact i touch in the step, or arrive at their speed. */
RBDI_LOCAL int rbdi_touch_widely(const rbd_contact_set *c, int i) {
    const rbdi_constraint *own = &c->rows->constraint[i];
    int n = 0;
    for (int j = 0; j < c->n; ++j) {
        const rbdi_constraint *con = &c->rows->constraint[j];
        if (con->link[0] != own->link[0] || con->link[1] != own->link[1]) continue;
        n += rbdi_may_touch(c->contact[j].gap, c->dt, RBD_C(c->options.slop));
    }
    return n >= 3;
}

/* Computes all gaps, and the places of contacts that may be rows. */
RBDI_LOCAL void rbdi_find_places(const rbd_contact_set *c) {
    for (int i = 0; i < c->n; ++i) rbdi_contact_gap(c, &c->rows->constraint[i], &c->contact[i]);
    for (int i = 0; i < c->n; ++i) {
        if (!rbdi_may_touch(c->contact[i].gap, c->dt, RBD_C(c->options.margin))) continue;
        if (rbdi_touch_widely(c, i)) rbdi_place_on_plane(c->rows, &c->rows->constraint[i], &c->contact[i]);
    }
}

/* Computes the gap to the limit. Returns whether it may be reached. */
RBDI_LOCAL int rbdi_find_limit(const rbd_contact_set *c, rbdi_limit_row *limit, const rbd_real *q,
                               const rbd_real *v) {
    rbdi_gap *gap = &limit->gap;
    gap->start = limit->side > 0 ? q[limit->iq] - limit->lower : limit->upper - q[limit->iq];
    gap->rate = limit->side * v[limit->dof];
    gap->reach = gap->start + c->half * gap->rate;
    return rbdi_may_touch(*gap, c->dt, rbdi_set(RBDI_NEAR_LIMIT));
}

/* Appends n rows, of this place and those behind it, with entries in these dofs. Returns the first. */
RBDI_LOCAL int rbdi_open_rows(rbd_contact_set *c, int place, int n, const int16_t *dof, int dofs) {
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
RBDI_LOCAL int rbdi_list_rows(const rbd_model *m, rbd_contact_set *c, const rbd_real *q, const rbd_real *v) {
    rbd_constraint_set *s = c->rows;
    const rbd_real dt = c->dt, ratio = dt / c->last_dt;
    int place = 0, contacts;

    for (int k = 0; k < m->nv; ++k) s->span[k].first = s->span[k].end = 0;
    s->rows = 0;

    rbdi_find_places(c);
    for (int i = 0; i < c->n; ++i, place += 3) {
        rbdi_constraint *con = &s->constraint[i];
        rbdi_contact *contact = &c->contact[i];
        contact->row = con->row = -1;
        contact->rebounds = 0;
        contact->state = RBD_APART;
        if (!rbdi_may_touch(contact->gap, dt, RBD_C(c->options.margin))) continue;
        c->friction[s->rows / 3] = rbdi_set(contact->friction);
        contact->row = con->row = (int16_t)rbdi_open_rows(c, place, 3, con->dof, con->dofs);
    }
    contacts = s->rows / 3;

    for (rbdi_constraint *con = s->constraint + c->n; con < s->constraint + s->n; place += con++->rows) {
        con->row = (int16_t)rbdi_open_rows(c, place, con->rows, con->dof, con->dofs);
        for (int r = con->row - 3 * contacts; r < s->rows - 3 * contacts; ++r) {
            c->upper[r] = rbdi_set(RBDI_UNBOUNDED);
            c->lower[r] = -c->upper[r];
        }
    }

    for (int i = 0; i < c->limits; ++i, ++place) {
        rbdi_limit_row *limit = &c->limit[i];
        const int r = s->rows - 3 * contacts, acts = rbdi_find_limit(c, limit, q, v);
        limit->rebounds = 0;
        limit->row = acts ? rbdi_open_rows(c, place, 1, s->path, rbdi_path_to(m, s, limit->dof)) : -1;
        if (!acts) continue;
        c->lower[r] = rbdi_zero();
        c->upper[r] = rbdi_set(RBDI_UNBOUNDED);
    }

    for (int i = 0; i < c->bounds; ++i, ++place) {
        rbdi_bounded_row *row = &c->bound[i];
        const int r = s->rows - 3 * contacts, acts = rbdi_bounded_acts(row);
        row->turn = rbdi_zero();
        row->row = acts ? rbdi_open_rows(c, place, 1, s->path, rbdi_paths_to(m, s, &row->law)) : -1;
        if (!acts) continue;
        c->lower[r] = dt * row->law.lower;
        c->upper[r] = dt * row->law.upper;
    }

    s->stride = rbdi_row_stride(s->rows);
    rbdi_clear(s->lambda, s->stride);
    for (int r = 0; r < s->rows; ++r) s->lambda[r] = c->impulse[c->place[r]] * ratio;
    return contacts;
}

/* Y = J', J v_mid and gamma of a contact. */
RBDI_LOCAL void rbdi_write_contact(const rbd_model *m, rbd_constraint_set *s, const rbdi_constraint *con,
                                   const rbdi_contact *contact) {
    const rbdi_v3 none = rbdi_vec0();
    rbdi_axes_held h;
    rbdi_set_axes(s, con, &h);
    rbdi_add_held(con, &h, none, contact->velocity.v, &s->velocity[con->row]);
    rbdi_add_held(con, &h, none, contact->rate.v, &s->gamma[con->row]);
    rbdi_constraint_columns(m, s, con, &h, rbdi_frame_origin(s, con, 0));
}

/* Y = J', and target = -J v_mid - dt/2 gamma. */
RBDI_LOCAL void rbdi_write_rows(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    rbdi_clear(s->Y, m->nv * s->stride);
    rbdi_clear(s->target, (int)(s->e - s->target) + s->stride); /* J v and gamma too */
    for (int i = 0; i < c->n; ++i)
        if (c->contact[i].row >= 0) rbdi_write_contact(m, s, &s->constraint[i], &c->contact[i]);
    for (int i = c->n; i < s->n; ++i) rbdi_constraint_rows(m, s, &s->constraint[i], 1);

    for (int i = 0; i < c->limits; ++i) {
        const rbdi_limit_row *limit = &c->limit[i];
        if (limit->row < 0) continue;
        s->Y[limit->dof * s->stride + limit->row] = limit->side;
        s->velocity[limit->row] = limit->side * c->v_mid[limit->dof];
    }

    for (int i = 0; i < c->bounds; ++i) rbdi_write_bounded(c, &c->bound[i]);

    for (int r = 0; r < s->rows; ++r) s->target[r] = -s->velocity[r] - c->half * s->gamma[r];
}

/* How a contact falls without impulses, and whether its spring acts: where it is in the plane, or would
   be. */
RBDI_LOCAL void rbdi_find_falls(rbd_contact_set *c) {
    for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        rbd_real u;
        contact->springs = 0;
        contact->falls = rbdi_zero();
        if (contact->row < 0) continue;
        u = -c->rows->b[contact->row + 2];
        contact->falls = u - contact->gap.rate;
        contact->springs =
            contact->stiffness > 0 && (contact->gap.reach <= 0 || contact->gap.reach + c->way * u < 0);
    }
}

/* Makes of the upper triangle of a symmetric matrix, in rows of this stride, all of it in rows of n: moves
   the rows, then copies each into the column below the diagonal. The last batch of a row writes up to a batch
   beyond it, which no later row is read from: rbdi_row_stride is longer than n by more. */
RBDI_LOCAL void rbdi_close_up(rbd_real *x, int stride, int n) {
    for (int r = 0; r < n; ++r)
        for (int t = r; t < n; t += RBDI_BATCH)
            *(rbdi_batch *)&x[r * n + t] = *(const rbdi_batch *)&x[r * stride + t];

    for (int r = 0; r < n - 1; ++r) rbdi_mirror(&x[r * n + r + 1], n, n - 1 - r, &x[(r + 1) * n + r]);
}

/* Delta of (4), rows x rows, in s->R; first the upper triangle, in rows of s->stride. Rows that rounding
   alone moves get 0 on the diagonal: no impulse changes their velocity. Slip and compliance come last. */
RBDI_LOCAL void rbdi_write_delta(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    const int n = s->rows;
    rbd_real *delta = s->R;

    rbdi_bound_noise(m, s);
    for (const rbdi_constraint *con = s->constraint; con < s->constraint + s->n; ++con)
        if (con->row >= 0) rbdi_delta(s, con->dof, con->dofs, con->row, con->rows);
    for (int i = 0; i < c->limits; ++i) {
        const rbdi_limit_row *limit = &c->limit[i];
        if (limit->row >= 0) rbdi_delta(s, s->path, rbdi_path_to(m, s, limit->dof), limit->row, 1);
    }
    for (int i = 0; i < c->bounds; ++i) {
        const rbdi_bounded_row *row = &c->bound[i];
        if (row->row >= 0) rbdi_delta(s, s->path, rbdi_paths_to(m, s, &row->law), row->row, 1);
    }
    rbdi_close_up(delta, s->stride, n);

    for (int r = 0; r < n; ++r)
        if (delta[r * n + r] <= s->noise) delta[r * n + r] = rbdi_zero();

    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        if (contact->row < 0) continue;
        for (int j = 0; j < 2; ++j) {
            rbd_real *d = &delta[(contact->row + j) * (n + 1)];
            *d = *d + RBD_C(c->options.slip) / c->dt;
        }
    }

    for (const rbdi_bounded_row *row = c->bound; row < c->bound + c->bounds; ++row)
        if (row->row >= 0) delta[row->row * (n + 1)] = delta[row->row * (n + 1)] + row->law.compliance;
}

/* Adds springs to the normals of Delta and of the solver's laws. Where nothing moves along the normal, the
   spring alone has the force. */
RBDI_LOCAL void rbdi_add_springs(rbd_contact_set *c) {
    const int n = c->rows->rows;
    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        const int normal = contact->row + 2;
        rbdi_contact_law *law;
        if (contact->row < 0 || !contact->springs) continue;
        law = &c->solver.law[contact->row / 3];
        law->d = law->d + 2 / (c->dt * (c->way * contact->stiffness + 2 * contact->damping));
        c->rows->R[normal * (n + 1)] = law->d;
        if (law->state == RBD_APART) law->rigid = law->d;
        law->state = RBD_OPENS;
        rbdi_contact_axes(law);
    }
}

#endif
