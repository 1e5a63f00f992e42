#ifndef RBDI_MOTION_POINTS_H
#define RBDI_MOTION_POINTS_H
#include "dynamics/crba.h"
#include "motion/kinematics.h"

/* Interface: rbdi_axis_motion, rbdi_column, rbdi_common_link, rbdi_unit_axis */

/* ---- points and momentum [points code] ---- */

/* The axis of a link that its spatial unit axis, omega_x .. omega_z, v_x .. v_z, has, in world axes. */
RBDI_INLINE rbdi_v3 rbdi_unit_axis(const rbdi_pose *X, int axis) {
    return rbdi_load_vec((const rbd_real *)&X->E + 3 * (axis < 3 ? axis : axis - 3), 1);
}

/* Motion of a point of a link for unit velocity of its spatial unit axis, which is a: (a; a x arm) or, if it
   slides, (0; a); a screw: rho and kappa times these. arm: from the link's origin to the point. */
RBDI_INLINE rbdi_motion rbdi_axis_motion(const rbdi_link *l, int axis, rbdi_v3 a, rbdi_v3 arm) {
    rbdi_motion c;

    c.omega = axis < 3 ? a : rbdi_vec0();
    c.v = axis < 3 ? rbdi_cross(a, arm) : a;

    if (rbdi_is(l, RBDI_SCREW)) {
        c.omega = rbdi_scale(rbdi_set(l->rho), a);
        c.v = rbdi_add(rbdi_scale(rbdi_set(l->rho), c.v), rbdi_scale(rbdi_set(l->kappa), a));
    }

    return c;
}

/* The same for unit velocity of dof k of link i, of the point at r, world axes. */
RBDI_INLINE rbdi_motion rbdi_column(const rbd_model *m, const rbd_work *w, int i, int k, rbdi_v3 r) {
    const rbdi_link *l = &m->link[i];
    const rbdi_pose *X = &w->kin[i].X;
    const int axis = rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first + k : 2;
    return rbdi_axis_motion(l, axis, rbdi_unit_axis(X, axis), rbdi_sub(r, X->r));
}

/* Stores a link's column in J, in the axes E if given; with a factor adds factor times the column. */
RBDI_INLINE void rbdi_put_column(const rbdi_link *l, const rbdi_pose *X, int axis, rbdi_v3 arm,
                                 const rbdi_mat *E, const rbd_real *factor, rbd_real *J, ptrdiff_t nv) {
    rbdi_v3 a = rbdi_unit_axis(X, axis);
    rbdi_motion c;

    if (E) a = rbdi_mul(*E, a);
    c = rbdi_axis_motion(l, axis, a, arm);

    if (factor) {
        c.omega = rbdi_add(rbdi_load_vec(J, nv), rbdi_scale(*factor, c.omega));
        c.v = rbdi_add(rbdi_load_vec(J + 3 * nv, nv), rbdi_scale(*factor, c.v));
    }

    rbdi_store_motion(J, nv, c);
}

/* Writes into J the columns of link i and of its ancestors up to link `end`, which has none, in the axes E if
   there are any. If sign is not 0, they are added times sign, as other links may have part in a column. */
RBDI_ONCE void rbdi_put_path(const rbd_model *m, const rbd_work *w, int i, int end, rbdi_v3 r,
                             const rbdi_mat *E, int sign, rbd_real *J) {
    const ptrdiff_t nv = m->nv;

    for (; i != end; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const rbdi_pose *X = &w->kin[i].X;
        const rbd_real ratio = sign ? rbdi_ratio(m, l->iv) * (rbd_const)sign : rbdi_zero();
        const rbd_real *factor = sign ? &ratio : NULL;
        rbd_real *to = &J[sign ? rbdi_source(m, l->iv) : l->iv];
        rbdi_v3 arm = rbdi_sub(r, X->r);

        if (E) arm = rbdi_mul(*E, arm);
        if (!rbdi_is(l, RBDI_BLOCK)) {
            rbdi_put_column(l, X, 2, arm, E, factor, to, nv);
        } else {
            const rbdi_block *b = rbdi_block_of(m, l);
            for (int axis = b->first; axis < b->first + b->n; ++axis, ++to)
                rbdi_put_column(l, X, axis, arm, E, factor, to, nv);
        }
    }
}

/* The last link that carries both of two links, -1 if there is none. Its joint moves both alike. */
RBDI_LOCAL int rbdi_common_link(const rbd_model *m, int link, int other) {
    int common = other;
    while (common >= 0 && !rbdi_carries(m, common, link)) common = m->link[common].parent;
    return common;
}

/* Jacobian of a point of `body` minus that of the same place fixed in `reference` (-1 = the world), in the
   axes of the body `axes` (-1 = the world's). */
RBDI_LOCAL void rbdi_put_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real *point,
                                  int reference, int axes, rbd_real *J) {
    const rbdi_v3 r = rbdi_point_position(m, w, body, point);
    const int link = m->frame[body].link, other = reference < 0 ? -1 : m->frame[reference].link;
    const int common = rbdi_common_link(m, link, other);
    rbdi_mat E;

    if (axes >= 0) E = rbdi_axes_of(m, w, axes);
    rbdi_clear(J, 6 * m->nv);
    for (int sign = 1; sign >= -1; sign -= 2)
        rbdi_put_path(m, w, sign > 0 ? link : other, common, r, axes >= 0 ? &E : NULL, sign, J);
}

RBDI_API rbd_status rbd_relative_jacobian(const rbd_model *m, const rbd_work *w, int body,
                                          const rbd_real point[3], int reference, rbd_axes axes,
                                          rbd_real *J) {
    rbd_status status;
    if (reference == -1) return rbd_jacobian(m, w, body, point, RBD_WORLD_AXES, J);
    status = rbdi_check_body_call(m, w, body, J != NULL);
    if (!status) status = rbdi_check_body_call(m, w, reference, 1);
    if (status) return status;
    rbdi_put_jacobian(m, w, body, point, reference, axes == RBD_LINK_AXES ? reference : -1, J);
    return RBD_OK;
}

RBDI_API rbd_status rbd_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                 rbd_axes axes, rbd_real *J) {
    const rbd_status status = rbdi_check_body_call(m, w, body, J != NULL);
    if (status) return status;

    if (axes == RBD_LINK_AXES || rbdi_mimics(m)) {
        rbdi_put_jacobian(m, w, body, point, -1, axes == RBD_LINK_AXES ? body : -1, J);
    } else { /* apart for speed: this loop has half of the instructions */
        rbdi_clear(J, 6 * m->nv);
        rbdi_put_path(m, w, m->frame[body].link, -1, rbdi_point_position(m, w, body, point), NULL, 0, J);
    }

    return RBD_OK;
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
        F.n = rbdi_mul_t(E, F.n);
        F.f = rbdi_mul_t(E, F.f);
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
        F.n = rbdi_mul(E, F.n);
        F.f = rbdi_mul(E, F.f);
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
