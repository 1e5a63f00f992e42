#ifndef RBDI_CONTACT_BIASES_H
#define RBDI_CONTACT_BIASES_H
#include "contact/rows.h"

/* ---- biases [biases] ----
   The bias is added to u_n, so that p_n >= 0, u_n >= 0, p_n u_n = 0 is the law in each case. With h the time
   for which the solution moves q, c->way, the gap at the end is reach + h u_n:

     apart      reach / h: the gap is at least 0 at the end
     rigid      0; for positions, what the first half of the step has added to the depth, over h (all of the
                depth, if there was none before), and the option `correction` times the depth below the slop
     stiff      k (min(start, 0) + reach) / (h k + 2 d), and 2 / (dt (h k + 2 d)) on Delta's diagonal:
                together p_n = -dt (k (min(start, 0) + gap at the end) / 2 + d u_n). The spring has the mean
                of its ends: along a straight way, where the gap changes by dt times the mean of u, it gives
                what it took, whatever k and dt are. Where a body turns, the end is off by up to
                r (omega dt)^2 / 8. The damper is implicit. Stable at every dt
     rebounds   for velocities, restitution times the speed with which it hits: that of the beginning, and
                what it still falls until the gap is 0
     leaves     for velocities, if another contact rebounds: the speed at which it leaves, where that is more
                than its bias

   Without friction a rebound makes no energy then, whatever the restitutions are: impulses do the work
   p'(u+ + u-)/2, of approach and end. A contact that pushes has u+ = -e u- if it rebounds or leaves (e = 1),
   or u+ = -reach / h; in each case u+ + u- <= 0.

   The option `slip` adds a damper along the plane: slip / dt on the diagonal, so that u_t + slip p_t / dt is
   the velocity that sticks or slips. */

enum { RBDI_FOR_POSITIONS, RBDI_FOR_VELOCITIES };

/* A bias, m/s, and its derivatives by the gap's start, rate and reach, and by how it falls. */
typedef struct rbdi_bias {
    rbd_real value, by_start, by_rate, by_reach, by_falls;
} rbdi_bias;

RBDI_INLINE rbdi_bias rbdi_no_bias(void) {
    rbdi_bias x;
    x.value = x.by_start = x.by_rate = x.by_reach = x.by_falls = rbdi_zero();
    return x;
}

/* The bias of a rigid row. */
RBDI_INLINE rbdi_bias rbdi_rigid_bias(const rbd_contact_set *c, int purpose, const rbdi_gap *gap) {
    const rbd_real inverse = 1 / c->way, slop = RBD_C(c->options.slop), least = -slop * RBDI_LEFT_OF_SLOP,
                   made = gap->reach - gap->start, deeper = gap->start + slop;
    rbdi_bias x = rbdi_no_bias();

    if (!(gap->reach <= 0)) {
        x.value = gap->reach * inverse;
        x.by_reach = inverse;
    } else if (purpose == RBDI_FOR_POSITIONS && gap->start > 0) {
        if (gap->reach < least) {
            x.value = gap->reach * inverse;
            x.by_reach = inverse;
        }
    } else if (purpose == RBDI_FOR_POSITIONS) {
        if (made < least) {
            x.value = made * inverse;
            x.by_reach = inverse;
            x.by_start = -inverse;
        }
        if (deeper < 0) {
            const rbd_real share = RBD_C(c->options.correction) * inverse;
            x.value = x.value + share * deeper;
            x.by_start = x.by_start + share;
        }
    }
    return x;
}

RBDI_INLINE rbdi_bias rbdi_spring_bias(const rbd_contact_set *c, const rbdi_contact *contact) {
    const rbdi_gap *gap = &contact->gap;
    rbdi_bias x = rbdi_no_bias();
    x.by_reach = contact->stiffness / (c->way * contact->stiffness + 2 * contact->damping);
    if (gap->start < 0) x.by_start = x.by_reach;
    x.value = gap->reach * x.by_reach + gap->start * x.by_start;
    return x;
}

/* Of a row that leaves: its rate. */
RBDI_INLINE rbdi_bias rbdi_leaving_bias(const rbdi_gap *gap) {
    rbdi_bias x = rbdi_no_bias();
    x.value = gap->rate;
    x.by_rate = rbdi_set(RBD_C(1));
    return x;
}

/* -restitution sqrt(rate^2 - 2 start falls / dt) */
RBDI_INLINE rbdi_bias rbdi_rebound_bias(const rbd_contact_set *c, const rbdi_contact *contact) {
    const rbdi_gap *gap = &contact->gap;
    const int further = gap->start > 0 && contact->falls < 0;
    rbd_real square = gap->rate * gap->rate, share;
    rbdi_bias x = rbdi_no_bias();
    if (gap->rate > 0) return rbdi_leaving_bias(gap);

    if (further) square = square - 2 * gap->start * contact->falls / c->dt;
    x.value = -contact->restitution * rbdi_sqrt(square);

    share = contact->restitution * contact->restitution / x.value;
    x.by_rate = share * gap->rate;
    if (further) {
        x.by_start = -share * contact->falls / c->dt;
        x.by_falls = -share * gap->start / c->dt;
    }
    return x;
}

RBDI_LOCAL rbdi_bias rbdi_contact_bias(const rbd_contact_set *c, int purpose, const rbdi_contact *contact) {
    if (purpose == RBDI_FOR_VELOCITIES && contact->rebounds) return rbdi_rebound_bias(c, contact);
    return contact->springs ? rbdi_spring_bias(c, contact) : rbdi_rigid_bias(c, purpose, &contact->gap);
}

RBDI_LOCAL rbdi_bias rbdi_limit_bias(const rbd_contact_set *c, int purpose, const rbdi_limit_row *limit) {
    if (purpose == RBDI_FOR_VELOCITIES && limit->rebounds) return rbdi_leaving_bias(&limit->gap);
    return rbdi_rigid_bias(c, purpose, &limit->gap);
}

/* Whether a rigid row leaves, faster than it may close its gap. */
RBDI_LOCAL int rbdi_leaves(const rbd_contact_set *c, const rbdi_gap *gap) {
    return gap->rate > 0 && gap->rate > rbdi_rigid_bias(c, RBDI_FOR_VELOCITIES, gap).value;
}

/* Finds the contacts that rebound by the first solution, and then those that leave. */
RBDI_LOCAL void rbdi_find_rebounds(rbd_contact_set *c) {
    int any = 0;
    for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        contact->pushes = contact->row >= 0 && c->rows->lambda[contact->row + 2] > 0;
        contact->rebounds =
            contact->pushes && contact->restitution > 0 && contact->gap.rate < -RBD_C(c->options.bounce);
        any |= contact->rebounds;
    }

    if (any) {
        for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact)
            if (contact->row >= 0 && !contact->springs && rbdi_leaves(c, &contact->gap))
                contact->rebounds = 1;
    }

    for (rbdi_limit_row *limit = c->limit; limit < c->limit + c->limits; ++limit)
        limit->rebounds = any && limit->row >= 0 && rbdi_leaves(c, &limit->gap);
}

/* The bias of a held row: its error counts as a penetration on either side. */
RBDI_LOCAL rbdi_bias rbdi_held_bias(const rbd_contact_set *c, int purpose, int row) {
    const rbd_constraint_set *s = c->rows;
    const rbdi_gap gap = rbdi_gap_of(s->e[row], s->velocity[row], s->gamma[row], c->half);
    const rbd_real inverse = 1 / c->way, slop = RBD_C(c->options.slop), made = gap.reach - gap.start,
                   over = rbdi_abs(gap.start) - slop, share = RBD_C(c->options.correction) * inverse;
    rbdi_bias x = rbdi_no_bias();
    if (purpose != RBDI_FOR_POSITIONS) return x;

    if (rbdi_abs(made) > slop * RBDI_LEFT_OF_SLOP) {
        x.value = made * inverse;
        x.by_reach = inverse;
        x.by_start = -inverse;
    }
    if (!(over > 0)) return x;

    x.value = x.value + share * (gap.start > 0 ? over : -over);
    x.by_start = x.by_start + share;
    return x;
}

/* c->b = J nu_0 + bias of a row, where J nu_0 = -s->b. Returns the larger of `most` and the change. */
RBDI_INLINE rbd_real rbdi_write_bias(rbd_contact_set *c, int row, rbd_real bias, rbd_real most) {
    const rbd_real before = c->b[row];
    rbd_real change;
    c->b[row] = bias - c->rows->b[row];
    change = rbdi_abs(c->b[row] - before);
    return change > most ? change : most;
}

/* Writes c->b of all rows. Returns by how much it changes at most. */
RBDI_LOCAL rbd_real rbdi_write_biases(rbd_contact_set *c, int purpose) {
    const rbd_constraint_set *s = c->rows;
    rbd_real most = rbdi_zero();
    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact)
        if (contact->row >= 0)
            most = rbdi_write_bias(c, contact->row + 2, rbdi_contact_bias(c, purpose, contact).value, most);
    for (const rbdi_constraint *con = s->constraint + c->n; con < s->constraint + s->n; ++con)
        for (int r = con->row; r < con->row + con->rows; ++r)
            most = rbdi_write_bias(c, r, rbdi_held_bias(c, purpose, r).value, most);
    for (const rbdi_limit_row *limit = c->limit; limit < c->limit + c->limits; ++limit)
        if (limit->row >= 0)
            most = rbdi_write_bias(c, limit->row, rbdi_limit_bias(c, purpose, limit).value, most);
    for (const rbdi_bounded_row *row = c->bound; row < c->bound + c->bounds; ++row)
        if (row->row >= 0) most = rbdi_write_bias(c, row->row, row->law.bias + row->turn, most);
    return most;
}

#endif
