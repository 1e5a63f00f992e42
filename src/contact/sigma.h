#ifndef RBDI_CONTACT_SIGMA_H
#define RBDI_CONTACT_SIGMA_H
#include "constraints/derivatives.h"
#include "contact/biases.h"
#include "contact/rho.h"

/* -- sigma of [step derivatives code] -- */

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
    const rbdi_v3 omega = pair->motion.velocity.omega;
    const rbdi_v3 r = pair->roll_radius;
    const rbdi_v3 n = pair->normal;
    const rbdi_v3 z = by->S.omega;
    const rbdi_v3 dw = by->velocity_q.omega;
    const rbdi_v3 across = rbdi_cross(omega, r);
    const rbdi_v3 shift = rbdi_cross(z, r);
    const rbdi_v3 turn = rbdi_cross(omega, n);
    const rbd_real rate = rbdi_dot(n, pair->motion.velocity.v);
    const rbd_real rate_q = rbdi_dot(n, by->velocity_q.v);
    const rbd_real rate_v = rbdi_dot(n, by->S.v);

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

            /* of J nu, of the gap or error, and of gamma */
            rbdi_clear(sum[0], 3 * RBDI_SIX_ROWS);
            rbdi_add_held(con, &pair->h, velocity.omega, velocity.v, sum[0]);
            rbdi_add_held(con, &pair->h, rbdi_differentiate_error(con, pair, by.S.omega), by.S.v, sum[1]);
            rbdi_add_held(con, &pair->h, rate.omega, rate.v, sum[2]);

            for (int r = 0; r < con->rows; ++r, to += m->nv)
                *to = *to + f->velocity[r] * sum[0][r] + f->gap[r] * sum[1][r] + f->rate[r] * sum[2][r];
        }
    }
}

/* Motion of constraint i's two bodies; of a contact with the place that rolls over them. */
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

    /* pass 0, by v_mid alone: -J, which becomes -J - J dW/dv; pass 1: the rest */
    for (int pass = x == 0; pass < 2; ++pass) {
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

        /* each dof k: n . d(J nu)/dq_k, and n . J_k dnu_k/dx */
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
    if (x == 2) return;

    for (const rbdi_limit_row *limit = c->limit; limit < c->limit + c->limits; ++limit) {
        rbdi_bias bias;
        if (limit->row < 0) continue;

        bias = rbdi_limit_bias(c, purpose, limit);
        c->sigma[limit->row * m->nv + limit->dof] =
            limit->side * (x == 0 ? bias.by_start + bias.by_reach : bias.by_rate - c->half * bias.by_start);
    }
    if (x == 0) return;

    for (const rbdi_bounded_row *row = c->bound; row < c->bound + c->bounds; ++row) {
        if (row->row < 0 || !(rbdi_abs(row->turn) > 0)) continue;
        for (int j = 0; j < row->law.dofs; ++j)
            c->sigma[row->row * m->nv + row->law.dof[j]] = row->law.jacobian[j];
    }
}

#endif
