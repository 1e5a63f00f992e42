#ifndef RBDI_DERIVATIVES_JACOBIANS_H
#define RBDI_DERIVATIVES_JACOBIANS_H
#include "motion/points.h"
#include "api/derivatives.h"

/* ---- derivatives of Jacobians [jacobians code] ----
   Let s be an axis of the joint of link i, in world axes, p the link's origin and r the point. s is fixed in
   the link, which turns with omega_i. A column of J and its rate are

       turning      (s; s x (r - p))      (ds/dt; ds/dt x (r - p) + s x (dr/dt - dp/dt)),  ds/dt = omega_i x s
       sliding      (0; s)                (0; ds/dt)
       screw        rho and kappa times these, summed

   In the axes E of a body that turns with omega a column c becomes E c, with the rate
   E (dc/dt - omega x c). */

/* The point of a Jacobian and its velocity, in world axes; the axes of the result, E with their angular
   velocity in world axes, unless these are the world's. */
typedef struct rbdi_observer {
    rbdi_v3 r, r_dot, omega;
    rbdi_mat E;
    int turns;
} rbdi_observer;

/* Rate of the column of a link's spatial unit axis. */
RBDI_LOCAL rbdi_motion rbdi_column_rate(const rbdi_link *l, const rbdi_kin *k, int axis,
                                        const rbdi_observer *o) {
    const rbdi_v3 s = rbdi_unit_axis(&k->X, axis);
    const rbdi_v3 arm = rbdi_sub(o->r, k->X.r);
    const rbdi_v3 arm_dot = rbdi_sub(o->r_dot, rbdi_mul_t(k->X.E, k->v));
    const rbdi_v3 s_dot = rbdi_cross(rbdi_mul_t(k->X.E, k->state.omega), s);
    const rbd_const rho = rbdi_is(l, RBDI_SCREW) ? l->rho : RBD_C(axis < 3);
    rbdi_motion rate = rbdi_axis_motion(l, axis, s_dot, arm), column;

    rate.v = rbdi_add(rate.v, rbdi_scale(rbdi_set(rho), rbdi_cross(s, arm_dot)));
    if (!o->turns) return rate;

    /* E (dc/dt - omega x c) */
    column = rbdi_axis_motion(l, axis, s, arm);
    rate.omega = rbdi_mul(o->E, rbdi_sub(rate.omega, rbdi_cross(o->omega, column.omega)));
    rate.v = rbdi_mul(o->E, rbdi_sub(rate.v, rbdi_cross(o->omega, column.v)));
    return rate;
}

/* Adds sign times the rates of the columns of link i and of its ancestors up to link `end`, without `end`. */
RBDI_LOCAL void rbdi_add_rates(const rbd_model *m, const rbd_work *w, int i, int end, const rbdi_observer *o,
                               int sign, rbd_real *J_dot) {
    for (; i != end; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const rbd_real factor = rbdi_ratio(m, l->iv) * (rbd_const)sign;
        const int first = rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first : 2;

        for (int k = 0; k < rbdi_link_dofs(m, l); ++k) {
            rbd_real *to = &J_dot[rbdi_source(m, l->iv) + k];
            const rbdi_motion rate = rbdi_column_rate(l, &w->kin[i], first + k, o);
            rbdi_motion sum;

            sum.omega = rbdi_add(rbdi_load_vec(to, m->nv), rbdi_scale(factor, rate.omega));
            sum.v = rbdi_add(rbdi_load_vec(to + 3 * m->nv, m->nv), rbdi_scale(factor, rate.v));
            rbdi_store_motion(to, m->nv, sum);
        }
    }
}

/* The derivative of rbdi_put_jacobian's matrix, with the same arguments. */
RBDI_LOCAL void rbdi_put_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                             const rbd_real *point, int reference, int axes,
                                             rbd_real *J_dot) {
    const int link = m->frame[body].link, other = reference < 0 ? -1 : m->frame[reference].link;
    const int common = rbdi_common_link(m, link, other);
    const rbdi_kin k = rbdi_body_kin(m, w, body);
    rbdi_observer o;

    rbdi_clear(J_dot, 6 * m->nv);
    if (!w->moving) return; /* v = 0: the work has no velocities */

    o.r = rbdi_point_position(m, w, body, point);
    o.r_dot = rbdi_mul_t(k.X.E, rbdi_point_v(&k, point ? rbdi_load_vec(point, 1) : rbdi_vec0()));
    o.turns = axes >= 0;
    if (o.turns) {
        const rbdi_kin seen_from = rbdi_body_kin(m, w, axes);
        o.E = seen_from.X.E;
        o.omega = rbdi_mul_t(o.E, seen_from.state.omega);
    }

    rbdi_add_rates(m, w, link, common, &o, 1, J_dot);
    rbdi_add_rates(m, w, other, common, &o, -1, J_dot);
}

RBDI_API rbd_status rbd_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                            const rbd_real point[3], rbd_axes axes, rbd_real *J_dot) {
    const rbd_status status = rbdi_check_body_call(m, w, body, J_dot != NULL);
    if (status) return status;
    rbdi_put_jacobian_derivative(m, w, body, point, -1, axes == RBD_LINK_AXES ? body : -1, J_dot);
    return RBD_OK;
}

RBDI_API rbd_status rbd_relative_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                                     const rbd_real point[3], int reference, rbd_axes axes,
                                                     rbd_real *J_dot) {
    rbd_status status;
    if (reference == -1) return rbd_jacobian_derivative(m, w, body, point, RBD_WORLD_AXES, J_dot);
    status = rbdi_check_body_call(m, w, body, J_dot != NULL);
    if (!status) status = rbdi_check_body_call(m, w, reference, 1);
    if (status) return status;
    rbdi_put_jacobian_derivative(m, w, body, point, reference, axes == RBD_LINK_AXES ? reference : -1, J_dot);
    return RBD_OK;
}

#endif
