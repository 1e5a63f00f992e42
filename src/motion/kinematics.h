#ifndef RBDI_MOTION_KINEMATICS_H
#define RBDI_MOTION_KINEMATICS_H
#include "api/kinematics.h"
#include "api/points.h"
#include "api/lookup.h"
#include "model/calls.h"
#include "dynamics/state.h"
#include "motion/axes.h"

/* Interface: rbdi_axes_of, rbdi_body_kin, rbdi_check_body_call, rbdi_kin_links, rbdi_point_p,
   rbdi_point_position, rbdi_point_v */

/* ---- kinematics [kinematics code] ---- */

/* Whether link j is in the subtree of link i. */
RBDI_INLINE int rbdi_carries(const rbd_model *m, int i, int j) {
    return i <= j && m->link[j].first < m->link[i].end;
}

/* Velocity of the parent-fixed point at r, both in the parent's axes. */
RBDI_INLINE rbdi_v3 rbdi_parent_velocity(const rbd_work *w, const rbdi_link *l, rbdi_v3 r) {
    const rbdi_kin *parent = &w->kin[l->parent < 0 ? 0 : l->parent];
    return l->parent < 0 ? rbdi_vec0() : rbdi_add(parent->v, rbdi_cross(parent->state.omega, r));
}

/* World pose of a one-axis link from its parent's, p. If moving, the velocity of its origin too, from its
   angular velocity, which rbdi_kin_states has set. */
RBDI_INLINE rbdi_pose rbdi_kin_axis(const rbd_work *w, const rbdi_link *l, rbdi_kin *k, int flags,
                                    rbdi_trig t, const rbd_real *v, int moving, rbdi_pose p) {
    p = rbdi_pose_step(l, flags & ~RBDI_ROOT, t, p);
    k->X = p;
    if (!moving) return p;

    k->v = rbdi_down(l, flags, t, rbdi_parent_velocity(w, l, rbdi_vec_c(l->r)));
    if (flags & RBDI_SHIFT_Z) {
        k->v.x = k->v.x + t.d * k->state.omega.y;
        k->v.y = k->v.y - t.d * k->state.omega.x;
    }
    if (flags & RBDI_SLIDES) k->v.z = k->v.z + v[l->iv] * l->kappa;
    return p;
}

/* The same of the links first .. end - 1, blocks too. */
RBDI_LOCAL void rbdi_kin_links(const rbd_model *m, rbd_work *w, int first, int end, const rbd_real *v,
                               int moving) {
    rbdi_pose p = rbdi_world_pose();

    for (int i = first; i < end; ++i) {
        const rbdi_link *l = &m->link[i];
        rbdi_kin *k = &w->kin[i];

        if (l->parent < 0)
            p = rbdi_world_pose();
        else if (l->parent != i - 1)
            p = w->kin[l->parent].X;

        if (rbdi_is(l, RBDI_BLOCK)) {
            const rbdi_pose *X = &w->block[l->block].X;
            p = rbdi_on_world(l) ? *X : rbdi_pose_block(X, p);
            k->X = p;
            if (moving)
                k->v = rbdi_add(rbdi_mul(X->E, rbdi_parent_velocity(w, l, X->r)),
                                rbdi_block_motion(rbdi_block_of(m, l), &v[l->iv]).v);
        } else {
            RBDI_BY_FLAGS(const int flags, l,
                          p = rbdi_kin_axis(w, l, k, flags, rbdi_trig_of(m, w, i, flags), v, moving, p));
        }
    }
}

/* States of the links first .. end - 1, after those of their ancestors. v, a: with mimics. */
RBDI_LOCAL void rbdi_kin_states(const rbd_model *m, rbd_work *w, int first, int end, const rbd_real *v,
                                const rbd_real *a) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    const rbdi_state world = rbdi_world_state(none);
    rbdi_forward(m, w, first, end, &world, v, a, 0, 1);
}

RBDI_API rbd_status rbd_kinematics(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                   const rbd_real *a) {
    const rbd_status status = rbdi_check(m, w, q != NULL);
    if (status) return status;

    w->moving = v || a;
    v = v ? rbdi_expand_v(m, v, w->vx) : w->zero;
    a = a ? rbdi_expand_v(m, a, w->ax) : w->zero;

    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    if (w->moving) rbdi_kin_states(m, w, 0, m->nl, v, a);
    rbdi_kin_links(m, w, 0, m->nl, v, w->moving);

    /* kinetic energy of the rotors */
    *w->rotors = rbdi_zero();
    if (w->moving)
        for (int i = 0; i < m->nv + rbdi_mimics(m); ++i)
            *w->rotors = *w->rotors + v[i] * v[i] * (RBD_C(0.5) * m->dof[i].armature);

    w->kinematics_of = m->nl;
    return RBD_OK;
}

RBDI_API rbd_status rbd_body_kinematics(const rbd_model *m, rbd_work *w, int body, const rbd_real *q,
                                        const rbd_real *v, const rbd_real *a) {
    const rbd_status status = rbdi_check(m, w, q != NULL);
    const rbdi_link *l;
    int last, leaf;
    if (status) return status;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    last = m->frame[body].link;
    w->moving = v || a;
    v = v ? rbdi_expand_v(m, v, w->vx) : w->zero;
    a = a ? rbdi_expand_v(m, a, w->ax) : w->zero;
    q = rbdi_expand_q(m, w, q);
    l = m->link;

    /* a dof of the subtrees of all links on the path, and of no others */
    leaf = last < 0 ? 0 : l[last].first;

    /* each run of links on the path, first .. end - 1. The links between do not move the body */
    for (int first = 0, end; first <= last; first = end) {
        for (; l->end <= leaf; ++l) ++first;
        for (end = first; end <= last && l->end > leaf; ++l) ++end;

        rbdi_range_joints(m, w, first, end, q);
        if (w->moving) rbdi_kin_states(m, w, first, end, v, a);
        rbdi_kin_links(m, w, first, end, v, w->moving);
    }

    w->kinematics_of = (int16_t)last;
    return RBD_OK;
}

/* Of a point x of a link, link axes: its position in the world; its velocity and acceleration, link axes. */
RBDI_INLINE rbdi_v3 rbdi_point_p(const rbdi_kin *k, rbdi_v3 x) {
    return rbdi_add(k->X.r, rbdi_mul_t(k->X.E, x));
}

RBDI_INLINE rbdi_v3 rbdi_point_v(const rbdi_kin *k, rbdi_v3 x) {
    return rbdi_add(k->v, rbdi_cross(k->state.omega, x));
}

RBDI_INLINE rbdi_v3 rbdi_point_acc(const rbdi_kin *k, rbdi_v3 x) {
    return rbdi_add(k->state.acc, rbdi_mul(rbdi_omega(k->state.omega, k->state.omega_dot), x));
}

/* Position of a point in the world. */
RBDI_ONCE rbdi_v3 rbdi_point_position(const rbd_model *m, const rbd_work *w, int body,
                                      const rbd_real *point) {
    const rbdi_frame *u = &m->frame[body];
    rbdi_v3 r = rbdi_vec_c(u->r);
    if (point) r = rbdi_add(r, rbdi_mul_t(rbdi_mat_c(u->E), rbdi_load_vec(point, 1)));
    return u->link < 0 ? r : rbdi_point_p(&w->kin[u->link], r);
}

/* E of a body: from world axes to its own. */
RBDI_PART rbdi_mat rbdi_axes_of(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_mat E = rbdi_mat_c(u->E);
    return u->link < 0 ? E : rbdi_mul_mat(E, w->kin[u->link].X.E);
}

/* Pose and state of a body of the description, in its own frame. */
RBDI_LOCAL rbdi_kin rbdi_body_kin(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_mat E = rbdi_mat_c(u->E);
    const rbdi_v3 r = rbdi_vec_c(u->r);
    rbdi_kin k;

    k.v = k.state.omega = k.state.omega_dot = k.state.acc = rbdi_vec0();
    if (w->moving && u->link >= 0) {
        k = w->kin[u->link];
        k.v = rbdi_mul(E, rbdi_point_v(&k, r));
        k.state.acc = rbdi_mul(E, rbdi_point_acc(&k, r));
        k.state.omega = rbdi_mul(E, k.state.omega);
        k.state.omega_dot = rbdi_mul(E, k.state.omega_dot);
    }

    k.X.E = rbdi_axes_of(m, w, body);
    k.X.r = rbdi_point_position(m, w, body, NULL);
    return k;
}

/* RBD_ERR_ORDER unless kinematics of this body, or of all with body -1, have been computed. */
RBDI_LOCAL rbd_status rbdi_have_kinematics(const rbd_model *m, const rbd_work *w, int body) {
    const int last = w->kinematics_of, link = body < 0 ? m->nl : m->frame[body].link;
    if (last == m->nl || link < 0) return last == RBDI_NO_KINEMATICS ? RBD_ERR_ORDER : RBD_OK;
    return rbdi_carries(m, link, last) ? RBD_OK : RBD_ERR_ORDER;
}

/* arrays: none of the caller's required ones is NULL. */
RBDI_LOCAL rbd_status rbdi_check_body_call(const rbd_model *m, const rbd_work *w, int body, int arrays) {
    const rbd_status status = rbdi_check(m, w, arrays);
    if (status) return status;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;
    return rbdi_have_kinematics(m, w, body);
}

RBDI_LOCAL rbd_status rbdi_check_robot_call(const rbd_model *m, const rbd_work *w) {
    const rbd_status status = rbdi_check_dynamics(m, w, 1);
    return status ? status : rbdi_have_kinematics(m, w, -1);
}

RBDI_API rbd_status rbd_body_pose(const rbd_model *m, const rbd_work *w, int body, rbd_real R[9],
                                  rbd_real p[3]) {
    const rbd_status status = rbdi_check_body_call(m, w, body, 1);
    if (status) return status;

    if (R) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        rbdi_store_vec(R, 1, rbdi_vec(E.xx, E.yx, E.zx));
        rbdi_store_vec(R + 3, 1, rbdi_vec(E.xy, E.yy, E.zy));
        rbdi_store_vec(R + 6, 1, rbdi_vec(E.xz, E.yz, E.zz));
    }

    if (p) rbdi_store_vec(p, 1, rbdi_point_position(m, w, body, NULL));
    return RBD_OK;
}

enum { RBDI_VELOCITY, RBDI_CLASSICAL_ACCELERATION, RBDI_SPATIAL_ACCELERATION };

/* Velocity, or classical or spatial acceleration, of a point of a body. */
RBDI_LOCAL rbd_status rbdi_point_motion(const rbd_model *m, const rbd_work *w, int body,
                                        const rbd_real *point, rbd_axes axes, int quantity, rbd_real *out) {
    const rbd_status status = rbdi_check_body_call(m, w, body, out != NULL);
    const rbdi_v3 x = point ? rbdi_load_vec(point, 1) : rbdi_vec0();
    rbdi_motion V;
    rbdi_kin k;
    if (status) return status;

    k = rbdi_body_kin(m, w, body);
    V.omega = quantity == RBDI_VELOCITY ? k.state.omega : k.state.omega_dot;
    V.v = quantity == RBDI_VELOCITY ? rbdi_point_v(&k, x) : rbdi_point_acc(&k, x);
    if (quantity == RBDI_SPATIAL_ACCELERATION) V.v = rbdi_sub(V.v, rbdi_cross(k.state.omega, k.v));

    if (axes != RBD_LINK_AXES) {
        V.omega = rbdi_mul_t(k.X.E, V.omega);
        V.v = rbdi_mul_t(k.X.E, V.v);
    }

    rbdi_store_motion(out, 1, V);
    return RBD_OK;
}

RBDI_API rbd_status rbd_body_velocity(const rbd_model *m, const rbd_work *w, int body, rbd_real velocity[6]) {
    return rbdi_point_motion(m, w, body, NULL, RBD_LINK_AXES, RBDI_VELOCITY, velocity);
}

RBDI_API rbd_status rbd_body_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                          rbd_real acceleration[6]) {
    return rbdi_point_motion(m, w, body, NULL, RBD_LINK_AXES, RBDI_SPATIAL_ACCELERATION, acceleration);
}

RBDI_API rbd_status rbd_body_acceleration_classical(const rbd_model *m, const rbd_work *w, int body,
                                                    rbd_real acceleration[6]) {
    return rbdi_point_motion(m, w, body, NULL, RBD_LINK_AXES, RBDI_CLASSICAL_ACCELERATION, acceleration);
}

RBDI_API rbd_status rbd_point_velocity(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_axes axes, rbd_real velocity[6]) {
    return rbdi_point_motion(m, w, body, point, axes, RBDI_VELOCITY, velocity);
}

RBDI_API rbd_status rbd_point_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, rbd_real acceleration[6]) {
    return rbdi_point_motion(m, w, body, point, axes, RBDI_CLASSICAL_ACCELERATION, acceleration);
}

RBDI_API rbd_const rbd_mass(const rbd_model *m) {
    rbd_const mass = RBD_C(0);
    for (int body = 0; body < rbd_nb(m); ++body)
        if (m->frame[body].link >= 0) mass += m->frame[body].mass;
    return mass;
}

/* The motion of a body, in its own axes: its centre of mass com, with velocity v and acceleration acc; its
   angular momentum L about com, with its rate. */
typedef struct rbdi_moving {
    rbdi_kin k;
    rbd_real mass;
    rbdi_v3 com, v, acc, L, L_dot;
} rbdi_moving;

RBDI_LOCAL rbdi_moving rbdi_moving_body(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_sym I = rbdi_sym_c(u->I);
    rbdi_moving b;

    b.k = rbdi_body_kin(m, w, body);
    b.mass = rbdi_set(u->mass);
    b.com = rbdi_vec_c(u->com);
    b.v = rbdi_point_v(&b.k, b.com);
    b.acc = rbdi_point_acc(&b.k, b.com);
    b.L = rbdi_mul_sym(I, b.k.state.omega);
    b.L_dot = rbdi_add(rbdi_mul_sym(I, b.k.state.omega_dot), rbdi_cross(b.k.state.omega, b.L));
    return b;
}

/* Sums over all bodies that a joint moves, world axes: momentum h about their centre of mass, with its
   rate; kinetic energy without that of the rotors. */
typedef struct rbdi_total {
    rbdi_force h, h_dot;
    rbdi_v3 com, arm; /* of the centre of mass, from the world's origin and the first link's */
    rbd_real mass, inverse_mass, kinetic;
} rbdi_total;

/* Adds to h the momentum of a body at r with linear velocity v and angular momentum L; or, with their
   rates, to h_dot. */
RBDI_INLINE void rbdi_add_momentum(const rbdi_moving *b, rbdi_v3 r, rbdi_v3 v, rbdi_v3 L, rbdi_force *h) {
    const rbdi_v3 f = rbdi_scale(b->mass, rbdi_mul_t(b->k.X.E, v));
    h->f = rbdi_add(h->f, f);
    h->n = rbdi_add(h->n, rbdi_add(rbdi_mul_t(b->k.X.E, L), rbdi_cross(r, f)));
}

/* Sums the momenta about the first link's origin o, which rounds less than about a far world origin, then
   moves them to the centre of mass: n - arm x f. com is not o + arm: bodies may be far from o. */
RBDI_LOCAL rbdi_total rbdi_add_bodies(const rbd_model *m, const rbd_work *w) {
    const rbd_const mass = rbd_mass(m);
    const rbdi_v3 o = mass > 0 ? w->kin[0].X.r : rbdi_vec0();
    rbdi_total s;

    s.mass = rbdi_set(mass);
    s.inverse_mass = rbdi_set(mass > 0 ? RBD_C(1) / mass : RBD_C(0));
    s.kinetic = rbdi_zero();
    s.com = s.arm = rbdi_vec0();
    s.h = s.h_dot = rbdi_force0();

    for (int body = 0; body < m->nb; ++body) {
        rbdi_moving b;
        rbdi_v3 p, r;
        if (m->frame[body].link < 0) continue;

        b = rbdi_moving_body(m, w, body);
        p = rbdi_point_p(&b.k, b.com);
        r = rbdi_sub(p, o);
        s.com = rbdi_add(s.com, rbdi_scale(b.mass * s.inverse_mass, p));
        s.arm = rbdi_add(s.arm, rbdi_scale(b.mass * s.inverse_mass, r));
        rbdi_add_momentum(&b, r, b.v, b.L, &s.h);
        rbdi_add_momentum(&b, r, b.acc, b.L_dot, &s.h_dot);
        s.kinetic = s.kinetic + RBD_C(0.5) * (b.mass * rbdi_dot(b.v, b.v) + rbdi_dot(b.k.state.omega, b.L));
    }

    s.h.n = rbdi_sub(s.h.n, rbdi_cross(s.arm, s.h.f));
    s.h_dot.n = rbdi_sub(s.h_dot.n, rbdi_cross(s.arm, s.h_dot.f));
    return s;
}

RBDI_API rbd_status rbd_com(const rbd_model *m, const rbd_work *w, rbd_real position[3], rbd_real velocity[3],
                            rbd_real acceleration[3]) {
    const rbd_status status = rbdi_check_robot_call(m, w);
    rbdi_total s;
    if (status) return status;

    s = rbdi_add_bodies(m, w);
    if (position) rbdi_store_vec(position, 1, s.com);
    if (velocity) rbdi_store_vec(velocity, 1, rbdi_scale(s.inverse_mass, s.h.f));
    if (acceleration) rbdi_store_vec(acceleration, 1, rbdi_scale(s.inverse_mass, s.h_dot.f));
    return RBD_OK;
}

RBDI_API rbd_status rbd_energy(const rbd_model *m, const rbd_work *w, rbd_real *kinetic,
                               rbd_real *potential) {
    const rbd_status status = rbdi_check_robot_call(m, w);
    rbdi_total s;
    if (status) return status;
    s = rbdi_add_bodies(m, w);
    if (kinetic) *kinetic = *w->rotors + s.kinetic;
    if (potential) *potential = -(s.mass * rbdi_dot(rbdi_vec_c(w->gravity), s.com));
    return RBD_OK;
}

RBDI_API rbd_status rbd_momentum(const rbd_model *m, const rbd_work *w, rbd_real h[6], rbd_real h_dot[6]) {
    const rbd_status status = rbdi_check_robot_call(m, w);
    rbdi_total s;
    if (status) return status;
    s = rbdi_add_bodies(m, w);
    if (h) rbdi_store_force(h, 1, s.h);
    if (h_dot) rbdi_store_force(h_dot, 1, s.h_dot);
    return RBD_OK;
}

/* A wrench on a body, in its own axes, to the parent's origin and axes. */
RBDI_LOCAL rbdi_force rbdi_wrench_to_parent(const rbd_model *m, const rbd_work *w, const rbdi_frame *u,
                                            rbdi_force F) {
    const rbdi_frame *parent = &m->frame[u->parent];
    const rbdi_mat E = rbdi_mat_c(parent->E);
    rbdi_pose X;

    X.E = rbdi_mat_c(u->E);
    X.r = rbdi_vec_c(u->r);
    F = rbdi_force_up_block(&X, F);

    for (int i = u->link; i != parent->link; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        if (rbdi_is(l, RBDI_BLOCK))
            F = rbdi_force_up_block(&w->block[l->block].X, F);
        else
            F = rbdi_force_up(l, rbdi_flags(l), rbdi_trig_of(m, w, i, rbdi_flags(l)), F);
    }

    F.n = rbdi_mul(E, rbdi_sub(F.n, rbdi_cross(rbdi_vec_c(parent->r), F.f)));
    F.f = rbdi_mul(E, F.f);
    return F;
}

RBDI_API rbd_status rbd_joint_wrench(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                     const rbd_real *a, const rbd_real *f_ext, rbd_real *wrench) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && wrench);
    if (status) return status;

    rbd_kinematics(m, w, q, v, a);

    for (int body = 0; body < m->nb; ++body) {
        const rbdi_moving b = rbdi_moving_body(m, w, body);
        rbdi_force F;
        F.f = rbdi_scale(b.mass, rbdi_sub(b.acc, rbdi_mul(b.k.X.E, rbdi_vec_c(w->gravity))));
        F.n = rbdi_add(b.L_dot, rbdi_cross(b.com, F.f));
        if (f_ext) F = rbdi_force_sub(F, rbdi_load_force(f_ext + 6 * body, 1));
        rbdi_store_force(wrench + 6 * body, 1, F);
    }

    for (int body = m->nb - 1; body >= 0; --body) {
        const rbdi_frame *u = &m->frame[body];
        rbd_real *to;
        rbdi_force F;
        if (u->parent < 0) continue;
        to = wrench + 6 * u->parent;
        F = rbdi_wrench_to_parent(m, w, u, rbdi_load_force(wrench + 6 * body, 1));
        rbdi_store_force(to, 1, rbdi_force_add(rbdi_load_force(to, 1), F));
    }

    return RBD_OK;
}

#endif
