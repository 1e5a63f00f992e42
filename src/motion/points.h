#ifndef RBDI_MOTION_POINTS_H
#define RBDI_MOTION_POINTS_H
#include "dynamics/crba.h"
#include "motion/kinematics.h"

/* Interface: rbdi_column */

/* ---- points and momentum [points code] ---- */

/* Position of a point in the world. */
static rbdi_v3 rbdi_point_position(const rbd_model *m, const rbd_work *w, int body, const rbd_real *point) {
    const rbdi_frame *u = &m->frame[body];
    rbdi_v3 r = rbdi_vec_c(u->r);
    if (point) r = rbdi_add(r, rbdi_mul_t(rbdi_mat_c(u->E), rbdi_load_vec(point, 1)));
    return u->link < 0 ? r : rbdi_point_p(&w->kin[u->link], r);
}

/* E of a body: from world axes to its own. */
static rbdi_mat rbdi_axes_of(const rbd_model *m, const rbd_work *w, int body) {
    const rbdi_frame *u = &m->frame[body];
    const rbdi_mat E = rbdi_mat_c(u->E);
    return u->link < 0 ? E : rbdi_mul_mat(E, w->kin[u->link].X.E);
}

/* The axis of a link that its spatial unit axis, omega_x .. omega_z, v_x .. v_z, has, in world axes. */
RBDI_INLINE rbdi_v3 rbdi_unit_axis(const rbdi_pose *X, int axis) {
    return rbdi_load_vec((const rbd_real *)&X->E + 3 * (axis < 3 ? axis : axis - 3), 1);
}

/* Motion, world axes, of the point of link i that is at r, for unit velocity of the link's dof k. Its axis
   a goes through the origin p: (a; a x (r - p)), or (0; a) if it slides. */
RBDI_INLINE rbdi_motion rbdi_column(const rbd_model *m, const rbd_work *w, int i, int k, rbdi_v3 r) {
    const rbdi_link *l = &m->link[i];
    const rbdi_pose *X = &w->kin[i].X;
    const int axis = rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first + k : 2;
    rbdi_motion c;
    c.omega = rbdi_unit_axis(X, axis);
    c.v = axis < 3 ? rbdi_cross(c.omega, rbdi_sub(r, X->r)) : c.omega;
    if (rbdi_is(l, RBDI_SCREW)) {
        c.v = rbdi_add(rbdi_scale(rbdi_set(l->rho), c.v), rbdi_scale(rbdi_set(l->kappa), c.omega));
        c.omega = rbdi_scale(rbdi_set(l->rho), c.omega);
    }
    if (axis >= 3) c.omega = rbdi_vec0();
    return c;
}

/* Adds ratio times such a motion to a column of J: (0; a), or (a; a x arm) with arm = r - p. */
RBDI_INLINE void rbdi_add_slide(rbd_real *J, ptrdiff_t nv, rbd_real ratio, rbdi_v3 a) {
    rbdi_store_vec(J + 3 * nv, nv, rbdi_add(rbdi_load_vec(J + 3 * nv, nv), rbdi_scale(ratio, a)));
}
RBDI_INLINE void rbdi_add_turn(rbd_real *J, ptrdiff_t nv, rbd_real ratio, rbdi_v3 a, rbdi_v3 arm) {
    rbdi_store_vec(J, nv, rbdi_add(rbdi_load_vec(J, nv), rbdi_scale(ratio, a)));
    rbdi_add_slide(J, nv, ratio, rbdi_cross(a, arm));
}

/* Adds to J, times sign, the columns of link i and of its ancestors up to link `end`, which has none; E, if
   any, turns them. */
RBDI_PART void rbdi_add_path(const rbd_model *m, const rbd_work *w, int i, int end, rbdi_v3 r,
                             const rbdi_mat *E, rbd_const sign, rbd_real *J) {
    const ptrdiff_t nv = m->nv;
    for (; i != end; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const rbdi_pose *X = &w->kin[i].X;
        const rbdi_block *b;
        rbd_real *to = &J[rbdi_source(m, l->iv)], ratio = rbdi_ratio(m, l->iv) * sign;
        rbdi_v3 arm = rbdi_sub(r, X->r), a;
        if (E) arm = rbdi_mul(*E, arm);
        if (!rbdi_is(l, RBDI_BLOCK)) {
            a = rbdi_unit_axis(X, 2);
            if (E) a = rbdi_mul(*E, a);
            if (rbdi_is(l, RBDI_SCREW)) rbdi_add_slide(to, nv, ratio * l->kappa, a), ratio = ratio * l->rho;
            rbdi_add_turn(to, nv, ratio, a, arm);
            continue;
        }
        b = rbdi_block_of(m, l);
        for (int axis = b->first; axis < b->first + b->n; ++axis, ++to) {
            a = rbdi_unit_axis(X, axis);
            if (E) a = rbdi_mul(*E, a);
            if (axis >= 3)
                rbdi_add_slide(to, nv, ratio, a);
            else
                rbdi_add_turn(to, nv, ratio, a, arm);
        }
    }
}

/* Jacobian of a point of `body` minus that of the same place fixed in `reference` (-1 = the world), in the
   axes of the body `axes` (-1 = the world's). */
static rbd_status rbdi_put_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real *point,
                                    int reference, int axes, rbd_real *J) {
    const rbd_status status = rbdi_check_body_call(m, w, body, J != NULL);
    rbdi_v3 r;
    rbdi_mat E;
    int link, other, common;
    if (status) return status;
    if (reference < -1 || reference >= m->nb) return RBD_ERR_INDEX;
    if (reference >= 0 && rbdi_have_kinematics(m, w, reference)) return RBD_ERR_ORDER;
    r = rbdi_point_position(m, w, body, point);
    link = m->frame[body].link, other = reference < 0 ? -1 : m->frame[reference].link;
    if (axes >= 0) E = rbdi_axes_of(m, w, axes);
    rbdi_clear(J, 6 * m->nv);
    for (common = other; common >= 0 && (link < 0 || !rbdi_carries(m, common, link));)
        common = m->link[common].parent;
    rbdi_add_path(m, w, link, common, r, axes >= 0 ? &E : NULL, RBD_C(1), J);
    rbdi_add_path(m, w, other, common, r, axes >= 0 ? &E : NULL, RBD_C(-1), J);
    return RBD_OK;
}

RBDI_API rbd_status rbd_relative_jacobian(const rbd_model *m, const rbd_work *w, int body,
                                          const rbd_real point[3], int reference, rbd_axes axes,
                                          rbd_real *J) {
    return rbdi_put_jacobian(m, w, body, point, reference, axes == RBD_LINK_AXES ? reference : -1, J);
}

RBDI_API rbd_status rbd_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                 rbd_axes axes, rbd_real *J) {
    return rbdi_put_jacobian(m, w, body, point, -1, axes == RBD_LINK_AXES ? body : -1, J);
}

RBDI_API rbd_status rbd_jacobian_transpose(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, const rbd_real f[6],
                                           rbd_real *tau) {
    const rbd_status status = rbdi_check_body_call(m, w, body, f && tau);
    rbdi_v3 r;
    rbdi_force F;
    if (status) return status;
    F = rbdi_load_force(f, 1);
    if (axes == RBD_LINK_AXES) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        F.n = rbdi_mul_t(E, F.n), F.f = rbdi_mul_t(E, F.f);
    }
    r = rbdi_point_position(m, w, body, point);
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
    const rbd_status status = rbdi_check_body_call(m, w, body, f && row);
    rbdi_force F;
    if (status) return status;
    F = rbdi_load_force(f, 1);
    if (axes != RBD_LINK_AXES) {
        const rbdi_mat E = rbdi_axes_of(m, w, body);
        F.n = rbdi_mul(E, F.n), F.f = rbdi_mul(E, F.f);
    }
    if (point) F.n = rbdi_add(F.n, rbdi_cross(rbdi_load_vec(point, 1), F.f));
    rbdi_store_force(row, 1, F);
    return RBD_OK;
}

RBDI_API rbd_status rbd_point_position(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_real position[3]) {
    const rbd_status status = rbdi_check_body_call(m, w, body, position != NULL);
    if (status) return status;
    rbdi_store_vec(position, 1, rbdi_point_position(m, w, body, point));
    return RBD_OK;
}

#endif
