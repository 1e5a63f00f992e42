#ifndef RBDI_IK_TARGETS_H
#define RBDI_IK_TARGETS_H
#include "motion/points.h"
#include "ik/layout.h"

/* Interface: rbdi_ik_across, rbdi_ik_axis, rbdi_ik_body_com, rbdi_ik_com_jacobian, rbdi_ik_part_across,
   rbdi_ik_turn, rbdi_ik_turn_to, rbdi_ik_unit, rbdi_ik_way */

/* ---- targets [targets code] ---- */

RBDI_INLINE int rbdi_ik_turns_body(rbd_ik_kind kind) {
    return kind == RBD_IK_POSE || kind == RBD_IK_ROTATION;
}

RBDI_INLINE int rbdi_ik_moves_point(rbd_ik_kind kind) { return kind == RBD_IK_POSE || kind == RBD_IK_POINT; }

/* Rows of a kind of target. */
RBDI_INLINE int rbdi_ik_rows_of(rbd_ik_kind kind) { return kind == RBD_IK_POSE ? 6 : 3; }

/* Of a target's rows: the root of its weight. */
RBDI_INLINE rbd_real rbdi_ik_factor(const rbd_ik_target *t) {
    return t->weight > 0 ? rbdi_sqrt(t->weight) : rbdi_set(RBD_C(1));
}

/* R, 3 x 3 by rows; all 0 is the identity. */
RBDI_LOCAL rbdi_mat rbdi_ik_rotation(const rbd_real *R) {
    const rbd_real o = rbdi_zero(), one = rbdi_set(RBD_C(1));
    rbd_real sum = o;
    for (int i = 0; i < 9; ++i) sum = sum + R[i] * R[i];
    if (sum > 0) return rbdi_mat_of(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]);
    return rbdi_mat_of(one, o, o, o, one, o, o, o, one);
}

/* A vector of unit length. */
RBDI_LOCAL rbdi_v3 rbdi_ik_unit(const rbd_real *x) {
    const rbdi_v3 v = rbdi_load_vec(x, 1);
    return rbdi_scale(RBD_C(1) / rbdi_sqrt(rbdi_dot(v, v)), v);
}

/* A unit vector across the unit vector s. */
RBDI_LOCAL rbdi_v3 rbdi_ik_across(rbdi_v3 s) {
    const rbd_real o = rbdi_zero(), one = rbdi_set(RBD_C(1));
    const rbdi_v3 x = rbdi_vec(one, o, o), y = rbdi_vec(o, one, o);
    const rbdi_v3 v = rbdi_cross(s, s.x * s.x < RBD_C(0.5) ? x : y);
    return rbdi_scale(one / rbdi_sqrt(rbdi_dot(v, v)), v);
}

/* The shortest turn that leads from s to t, of unit length; from s = -t about any axis across. */
RBDI_LOCAL rbdi_v3 rbdi_ik_turn(rbdi_v3 s, rbdi_v3 t) {
    const rbdi_v3 across = rbdi_cross(s, t);
    const rbd_real cosine = rbdi_dot(s, t), sine = rbdi_sqrt(rbdi_dot(across, across));
    if (sine > 0) return rbdi_scale(rbdi_angle(sine, cosine) / sine, across);
    if (cosine > 0) return rbdi_vec0();
    return rbdi_scale(rbdi_set(RBDI_PI(rbd_const)), rbdi_ik_across(s));
}

/* The turn, in the axes that E leads from, of a body with the axes E to the rotation R, 3 x 3. */
RBDI_LOCAL rbdi_v3 rbdi_ik_turn_to(const rbd_real *R, rbdi_mat E) {
    return rbdi_log_rotation(rbdi_mul_mat(rbdi_ik_rotation(R), E));
}

/* An axis of a body, of unit length, world axes. */
RBDI_LOCAL rbdi_v3 rbdi_ik_axis(const rbd_model *m, const rbd_work *w, int body, const rbd_real *axis) {
    return rbdi_mul_t(rbdi_axes_of(m, w, body), rbdi_ik_unit(axis));
}

/* The part of v across the unit vector s. A turn about s itself does not move it. */
RBDI_LOCAL rbdi_v3 rbdi_ik_part_across(rbdi_v3 v, rbdi_v3 s) {
    return rbdi_sub(v, rbdi_scale(rbdi_dot(s, v), s));
}

/* The way from a point to a place. */
RBDI_LOCAL rbdi_v3 rbdi_ik_way(const rbd_real *place, rbdi_v3 p) {
    return rbdi_sub(rbdi_load_vec(place, 1), p);
}

/* The turn, world axes, that a target wants. */
RBDI_LOCAL rbdi_v3 rbdi_ik_wanted_turn(const rbdi_ik *ik, const rbd_ik_target *t) {
    if (t->kind == RBD_IK_AXIS)
        return rbdi_ik_turn(rbdi_ik_axis(ik->m, ik->w, t->body, t->axis), rbdi_ik_unit(t->direction));
    return rbdi_ik_turn_to(t->rotation, rbdi_axes_of(ik->m, ik->w, t->body));
}

/* Centre of mass of one body. */
RBDI_LOCAL rbdi_v3 rbdi_ik_body_com(const rbd_model *m, const rbd_work *w, const rbdi_frame *u) {
    rbd_real com[3];
    rbdi_store_vec(com, 1, rbdi_vec_c(u->com));
    return rbdi_point_position(m, w, (int)(u - m->frame), com);
}

/* Centre of mass of all bodies that a joint moves. */
RBDI_LOCAL rbdi_v3 rbdi_ik_com(const rbdi_ik *ik) {
    const rbd_model *m = ik->m;
    rbdi_v3 sum = rbdi_vec0();

    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->link >= 0)
            sum = rbdi_add(sum, rbdi_scale(rbdi_set(u->mass / ik->all), rbdi_ik_body_com(m, ik->w, u)));

    return sum;
}

/* Appends an error to e, with its weight; returns its length. */
RBDI_LOCAL rbd_real rbdi_ik_append(rbdi_ik *ik, int *row, rbd_real factor, rbdi_v3 error) {
    const rbdi_v3 scaled = rbdi_scale(factor, error);
    rbdi_store_vec(&ik->e[*row], 1, scaled);
    *row += 3;
    ik->cost = ik->cost + rbdi_dot(scaled, scaled);
    return rbdi_sqrt(rbdi_dot(error, error));
}

/* e and |e|^2 at q, angles before lengths; also the largest distance and angle. */
RBDI_LOCAL void rbdi_ik_errors(rbdi_ik *ik, const rbd_real *q) {
    int row = 0;

    if (ik->alone >= 0)
        rbd_body_kinematics(ik->m, ik->w, ik->alone, q, NULL, NULL);
    else
        rbd_kinematics(ik->m, ik->w, q, NULL, NULL);

    ++ik->result->evaluations;
    ik->cost = rbdi_zero();
    ik->result->metres = rbdi_zero();
    ik->result->radians = rbdi_zero();

    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        const rbd_real factor = rbdi_ik_factor(t);

        if (rbdi_ik_turns_body(t->kind) || t->kind == RBD_IK_AXIS) {
            const rbdi_v3 turn = rbdi_ik_wanted_turn(ik, t);
            const rbd_real angle = rbdi_ik_append(ik, &row, factor * ik->options.length, turn);
            ik->result->radians = rbdi_larger(ik->result->radians, angle);
        }

        if (rbdi_ik_moves_point(t->kind) || t->kind == RBD_IK_COM) {
            const rbdi_v3 at = t->kind == RBD_IK_COM ? rbdi_ik_com(ik)
                                                     : rbdi_point_position(ik->m, ik->w, t->body, t->point);
            const rbd_real distance = rbdi_ik_append(ik, &row, factor, rbdi_ik_way(t->position, at));
            ik->result->metres = rbdi_larger(ik->result->metres, distance);
        }
    }
}

/* Masses and first moments of the subtrees of all links, the moments about the origin of the first link.
   sums: nl x 4. */
RBDI_LOCAL void rbdi_ik_subtrees(const rbd_model *m, const rbd_work *w, rbd_real *sums) {
    const rbdi_v3 o = w->kin[0].X.r;

    rbdi_clear(sums, 4 * m->nl);
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        const rbd_real mass = rbdi_set(u->mass);
        rbdi_v3 moment;
        rbd_real *sum;
        if (u->link < 0) continue;

        moment = rbdi_scale(mass, rbdi_sub(rbdi_ik_body_com(m, w, u), o));
        sum = &sums[4 * u->link];
        sum[0] = sum[0] + mass;
        rbdi_store_vec(sum + 1, 1, rbdi_add(rbdi_load_vec(sum + 1, 1), moment));
    }

    for (int i = m->nl - 1; i > 0; --i)
        for (int j = 0; j < 4 && m->link[i].parent >= 0; ++j) {
            rbd_real *sum = &sums[4 * m->link[i].parent + j];
            *sum = *sum + sums[4 * i + j];
        }
}

/* Jacobian of the centre of mass, 3 x nv: a joint moves the centre of mass of its subtree, whose share of the
   whole is that of its mass. all: kg, the robot's mass. sums: nl x 4, scratch. */
RBDI_LOCAL void rbdi_ik_com_jacobian(const rbd_model *m, const rbd_work *w, rbd_const all, rbd_real *sums,
                                     rbd_real *J) {
    const rbd_real whole = rbdi_set(all);
    const rbdi_v3 o = w->kin[0].X.r;

    rbdi_ik_subtrees(m, w, sums);
    rbdi_clear(J, 3 * m->nv);
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        const rbd_real mass = sums[4 * i];
        rbdi_v3 centre;
        if (!(mass > 0)) continue;

        centre = rbdi_add(o, rbdi_scale(RBD_C(1) / mass, rbdi_load_vec(&sums[4 * i + 1], 1)));
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbd_real share = rbdi_ratio(m, l->iv + j) * mass / whole;
            const rbdi_v3 v = rbdi_scale(share, rbdi_column(m, w, i, j, centre).v);
            rbd_real *to = &J[rbdi_source(m, l->iv + j)];
            rbdi_store_vec(to, m->nv, rbdi_add(rbdi_load_vec(to, m->nv), v));
        }
    }
}

/* Copies three rows of ik->columns into J from `row` on; without the part along `off`, if there is any. */
RBDI_LOCAL void rbdi_ik_put_rows(rbdi_ik *ik, int *row, rbd_real factor, int from, const rbdi_v3 *off) {
    const ptrdiff_t nv = ik->m->nv;

    for (int i = 0; i < ik->dofs; ++i) {
        rbdi_v3 c = rbdi_load_vec(&ik->columns[from * nv + ik->dof[i].dof], nv);
        if (off) c = rbdi_ik_part_across(c, *off);
        rbdi_store_vec(&ik->J[i * ik->rows + *row], 1, rbdi_scale(factor, c));
    }

    *row += 3;
}

/* J at the place of the last rbdi_ik_errors. A turn e of length angle changes by dangle = -n omega, n along
   e: so g = J'e is exact, and J without the part along the axis. */
RBDI_LOCAL void rbdi_ik_jacobian(rbdi_ik *ik) {
    int row = 0;

    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        const rbd_real factor = rbdi_ik_factor(t);

        if (t->kind == RBD_IK_COM)
            rbdi_ik_com_jacobian(ik->m, ik->w, ik->all, ik->mass, &ik->columns[3 * ik->m->nv]);
        else
            rbd_jacobian(ik->m, ik->w, t->body, t->point, RBD_WORLD_AXES, ik->columns);

        if (t->kind == RBD_IK_AXIS) {
            const rbdi_v3 axis = rbdi_ik_axis(ik->m, ik->w, t->body, t->axis);
            rbdi_ik_put_rows(ik, &row, factor * ik->options.length, 0, &axis);
        }
        if (rbdi_ik_turns_body(t->kind)) rbdi_ik_put_rows(ik, &row, factor * ik->options.length, 0, NULL);
        if (rbdi_ik_moves_point(t->kind) || t->kind == RBD_IK_COM)
            rbdi_ik_put_rows(ik, &row, factor, 3, NULL);
    }
}

#endif
