#ifndef RBDI_MOTION_POINTS_H
#define RBDI_MOTION_POINTS_H
#include "api/points.h"
#include "dynamics/crba.h"
#include "motion/kinematics.h"

/* Interface: rbdi_column */

/* ---- points and momentum [points code] ---- */

/* Place of a point in the world. */
static rbdi_v3 rbdi_point_place(const rbd_model *m, const rbd_work *w, int body, const rbd_real *point) {
    const rbdi_frame *u = &m->frame[body];
    rbdi_v3 r = rbdi_vec_c(u->r);
    if (point) r = rbdi_add(r, rbdi_mul_t(rbdi_mat_c(u->E), rbdi_vec(point[0], point[1], point[2])));
    return u->link < 0 ? r : rbdi_point_p(&w->kin[u->link], r);
}

/* Turns world vectors into the axes of a body. */
static rbdi_mat rbdi_axes_of(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_mat E = rbdi_mat_c(u->E);
    return u->link < 0 ? E : rbdi_mul_mat(E, w->kin[u->link].X.E);
}

/* Motion, world axes, of the place r, were it fixed in link i, for unit velocity of the link's dof k: of its
   axis a through the origin p it is (a; a x (r - p)), or (0; a). */
RBDI_INLINE rbdi_motion rbdi_column(const rbd_model *m, const rbd_work *w, int i, int k, rbdi_v3 r) {
    const rbdi_link *l = &m->link[i];
    const rbdi_kin *s = &w->kin[i];
    const int axis = l->kind == RBDI_BLOCK ? rbdi_block_of(m, l)->first + k : 2;
    rbdi_motion c;
    c.omega = axis % 3 == 0   ? rbdi_vec(s->X.E.xx, s->X.E.xy, s->X.E.xz)
              : axis % 3 == 1 ? rbdi_vec(s->X.E.yx, s->X.E.yy, s->X.E.yz)
                              : rbdi_vec(s->X.E.zx, s->X.E.zy, s->X.E.zz);
    c.v = axis < 3 ? rbdi_cross(c.omega, rbdi_sub(r, s->X.r)) : c.omega;
    if (l->kind == RBDI_SCREW) {
        c.v = rbdi_add(rbdi_scale(rbdi_set(l->rho), c.v), rbdi_scale(rbdi_set(l->kappa), c.omega));
        c.omega = rbdi_scale(rbdi_set(l->rho), c.omega);
    }
    if (axis >= 3) c.omega = rbdi_vec0();
    return c;
}

/* Adds to J, times sign, the columns of link i and its ancestors below `end`; E, if any, turns them. */
static void rbdi_add_columns(const rbd_model *m, const rbd_work *w, int i, int end, rbdi_v3 r,
                             const rbdi_mat *E, rbd_const sign, rbd_real *J) {
    for (; i != end; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        for (int k = 0; k < rbdi_link_dofs(m, l); ++k) {
            const rbd_real share = rbdi_ratio(m, l->iv + k) * sign;
            rbd_real *to = &J[rbdi_source(m, l->iv + k)], column[6];
            rbdi_motion c = rbdi_column(m, w, i, k, r);
            if (E) c.omega = rbdi_mul(*E, c.omega), c.v = rbdi_mul(*E, c.v);
            rbdi_motion_to_array(c, column);
            RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
                to[j * m->nv] = to[j * m->nv] + column[j] * share;
        }
    }
}

/* Jacobian of a point of `body` minus that of the same place fixed in `reference` (-1 = the world), in the
   axes of the body `axes` (-1 = the world's). */
static void rbdi_put_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real *point,
                              int reference, int axes, rbd_real *J) {
    const rbdi_v3 r = rbdi_point_place(m, w, body, point);
    const int link = m->frame[body].link, other = reference < 0 ? -1 : m->frame[reference].link;
    int common = other < 0 ? -1 : link;
    rbdi_mat E;
    if (axes >= 0) E = rbdi_axes_of(m, w, axes);
    for (int i = other; common != i;) { /* parents stand before their children */
        if (common > i)
            common = m->link[common].parent;
        else
            i = m->link[i].parent;
    }
    rbdi_clear(J, 6 * m->nv);
    rbdi_add_columns(m, w, link, common, r, axes >= 0 ? &E : NULL, RBD_C(1), J);
    rbdi_add_columns(m, w, other, common, r, axes >= 0 ? &E : NULL, RBD_C(-1), J);
}

RBDI_API rbd_status rbd_relative_jacobian(const rbd_model *m, const rbd_work *w, int body,
                                          const rbd_real point[3], int reference, rbd_axes axes,
                                          rbd_real *J) {
    const rbd_status status = rbdi_check_body_call(m, w, body);
    if (status) return status;
    if (!J) return RBD_ERR_NULL;
    if (reference < -1 || reference >= m->nb) return RBD_ERR_INDEX;
    rbdi_put_jacobian(m, w, body, point, reference, axes == RBD_LINK_AXES ? reference : -1, J);
    return RBD_OK;
}

RBDI_API rbd_status rbd_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                 rbd_axes axes, rbd_real *J) {
    const rbd_status status = rbdi_check_body_call(m, w, body);
    if (status) return status;
    if (!J) return RBD_ERR_NULL;
    rbdi_put_jacobian(m, w, body, point, -1, axes == RBD_LINK_AXES ? body : -1, J);
    return RBD_OK;
}

RBDI_API rbd_status rbd_jacobian_transpose(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, const rbd_real f[6],
                                           rbd_real *tau) {
    const rbd_status status = rbdi_check_body_call(m, w, body);
    rbdi_v3 r;
    rbdi_force F;
    if (status) return status;
    if (!f || !tau) return RBD_ERR_NULL;
    F = rbdi_load_force(f, 1);
    if (axes == RBD_LINK_AXES) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        F.n = rbdi_mul_t(E, F.n), F.f = rbdi_mul_t(E, F.f);
    }
    r = rbdi_point_place(m, w, body, point);
    rbdi_clear(tau, m->nv);
    for (int i = m->frame[body].link; i >= 0; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        for (int k = 0; k < rbdi_link_dofs(m, l); ++k) {
            const rbdi_motion c = rbdi_column(m, w, i, k, r);
            rbd_real *to = &tau[rbdi_source(m, l->iv + k)];
            *to = *to + (rbdi_dot(c.omega, F.n) + rbdi_dot(c.v, F.f)) * rbdi_ratio(m, l->iv + k);
        }
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_point_wrench(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                     rbd_axes axes, const rbd_real f[6], rbd_real row[6]) {
    const rbd_status status = rbdi_check_body_call(m, w, body);
    rbdi_force F;
    if (status) return status;
    if (!f || !row) return RBD_ERR_NULL;
    F = rbdi_load_force(f, 1);
    if (axes != RBD_LINK_AXES) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        F.n = rbdi_mul(E, F.n), F.f = rbdi_mul(E, F.f);
    }
    if (point) F.n = rbdi_add(F.n, rbdi_cross(rbdi_vec(point[0], point[1], point[2]), F.f));
    rbdi_store_force(row, 1, F);
    return RBD_OK;
}

RBDI_API rbd_status rbd_point_position(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_real position[3]) {
    const rbd_status status = rbdi_check_body_call(m, w, body);
    if (status) return status;
    if (!position) return RBD_ERR_NULL;
    rbdi_store(rbdi_point_place(m, w, body, point), position);
    return RBD_OK;
}

/* Velocity, or acceleration, of a point. */
static rbd_status rbdi_point_motion(const rbd_model *m, const rbd_work *w, int body, const rbd_real *point,
                                    rbd_axes axes, int acceleration, rbd_real *out) {
    const rbd_status status = rbdi_check_body_call(m, w, body);
    rbdi_v3 x = rbdi_vec0();
    rbdi_motion V;
    rbdi_kin k;
    if (status) return status;
    if (!out) return RBD_ERR_NULL;
    k = rbdi_body_kin(m, w, body);
    if (point) x = rbdi_vec(point[0], point[1], point[2]);
    V.omega = acceleration ? k.state.omega_dot : k.state.omega;
    V.v = acceleration ? rbdi_point_acc(&k, x) : rbdi_point_v(&k, x);
    if (axes != RBD_LINK_AXES) V.omega = rbdi_mul_t(k.X.E, V.omega), V.v = rbdi_mul_t(k.X.E, V.v);
    rbdi_motion_to_array(V, out);
    return RBD_OK;
}

RBDI_API rbd_status rbd_point_velocity(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_axes axes, rbd_real velocity[6]) {
    return rbdi_point_motion(m, w, body, point, axes, 0, velocity);
}

RBDI_API rbd_status rbd_point_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, rbd_real acceleration[6]) {
    return rbdi_point_motion(m, w, body, point, axes, 1, acceleration);
}

/* About a place o of the robot, then about the centre of mass c: n_c = n_o - (c - o) x f. */
RBDI_API rbd_status rbd_momentum(const rbd_model *m, const rbd_work *w, rbd_real h[6], rbd_real h_dot[6]) {
    const rbd_status status = rbdi_check_body_call(m, w, 0);
    rbdi_force H = rbdi_force0(), rate = H;
    rbdi_v3 o, c = H.n;
    rbd_const mass = rbd_mass(m);
    if (status) return status;
    o = m->nl > 0 ? w->kin[0].X.r : c;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        const rbdi_mat E = rbdi_mat_c(u->E);
        const rbdi_sym I = rbdi_sym_c(u->I);
        const rbdi_v3 com = rbdi_add(rbdi_vec_c(u->r), rbdi_mul_t(E, rbdi_vec_c(u->com))); /* link axes */
        const rbdi_kin *k;
        rbdi_v3 r, f, n;
        if (u->link < 0) continue;
        k = &w->kin[u->link];
        r = rbdi_scale(rbdi_set(u->mass), rbdi_sub(rbdi_point_p(k, com), o));
        c = rbdi_add(c, r);
        f = rbdi_mul_t(k->X.E, rbdi_point_v(k, com));
        n = rbdi_mul_t(E, rbdi_mul_sym(I, rbdi_mul(E, k->state.omega)));
        H.n = rbdi_add(H.n, rbdi_add(rbdi_mul_t(k->X.E, n), rbdi_cross(r, f)));
        H.f = rbdi_add(H.f, rbdi_scale(rbdi_set(u->mass), f));
        f = rbdi_mul_t(k->X.E, rbdi_point_acc(k, com));
        n = rbdi_cross(k->state.omega, n);
        n = rbdi_add(n, rbdi_mul_t(E, rbdi_mul_sym(I, rbdi_mul(E, k->state.omega_dot))));
        rate.n = rbdi_add(rate.n, rbdi_add(rbdi_mul_t(k->X.E, n), rbdi_cross(r, f)));
        rate.f = rbdi_add(rate.f, rbdi_scale(rbdi_set(u->mass), f));
    }
    c = rbdi_scale(rbdi_set(mass > 0 ? RBD_C(1) / mass : RBD_C(0)), c);
    H.n = rbdi_sub(H.n, rbdi_cross(c, H.f));
    rate.n = rbdi_sub(rate.n, rbdi_cross(c, rate.f));
    if (h) rbdi_store_force(h, 1, H);
    if (h_dot) rbdi_store_force(h_dot, 1, rate);
    return RBD_OK;
}

#endif
