#ifndef RBDI_DYNAMICS_RNEA_H
#define RBDI_DYNAMICS_RNEA_H
#include "api/dynamics.h"
#include "model/calls.h"
#include "dynamics/state.h"

/* Interface: rbdi_rnea, rbdi_rnea_sweep */

/* ---- rnea [rnea] ----
   RBDA table 5.1. Down: v_i, a_i ([state]), and f_i = I_i a_i + v_i x* I_i v_i - X* f_ext from them, here
   by Omega (rbdi_wrench). Up: tau_i = S_i' f_i, f_p += X' f_i for the parent p. The table has no armature
   and one external wrench a link; here each body has one, in its own frame. Gravity is an acceleration of
   the world. */

/* tau of a one-axis joint from the force F on its link. Returns F at the parent's origin, in its axes. */
RBDI_INLINE rbdi_force rbdi_rnea_up(const rbd_model *m, const rbd_work *w, int i, int flags, rbdi_force F,
                                    const rbd_real *a, rbd_real *tau) {
    const rbdi_link *l = &m->link[i];
    rbd_real torque = rbdi_along_axis(l, flags, F);
    if (flags & RBDI_ARMATURE) torque = torque + a[l->iv] * m->dof[l->iv].armature;
    tau[l->iv] = torque; /* which may be a */
    return flags & RBDI_ROOT ? F : rbdi_force_up(l, flags, rbdi_trig_of(m, w, i, flags), F);
}

/* The same of a block; F becomes the parent's. */
RBDI_PART void rbdi_rnea_up_block(const rbd_model *m, const rbd_work *w, const rbdi_link *l,
                                  const rbd_real *a, rbd_real *tau, rbdi_force *F) {
    const rbdi_block *b = rbdi_block_of(m, l);
    rbd_real array[6];

    rbdi_store_force(array, 1, *F);
    for (int k = 0; k < b->n; ++k) {
        rbd_real torque = array[b->first + k];
        if (rbdi_flags(l) & RBDI_ARMATURE) torque = torque + a[l->iv + k] * m->dof[l->iv + k].armature;
        tau[l->iv + k] = torque;
    }

    if (!rbdi_on_world(l)) *F = rbdi_force_up_block(&w->block[l->block].X, *F);
}

/* One step of the sweep up: takes the force from link i + 1, returns that for link i - 1. */
RBDI_INLINE rbdi_force rbdi_rnea_step(const rbd_model *m, const rbd_work *w, int i, int flags,
                                      rbdi_force carried, const rbd_real *a, rbd_real *tau) {
    const rbdi_link *l = &m->link[i];
    rbdi_force F = rbdi_force_add(w->scratch[i].f, carried);

    if (rbdi_block_link(l, flags)) {
        rbdi_force block = F; /* an address of F would keep it in memory */
        rbdi_rnea_up_block(m, w, l, a, tau, &block);
        F = block;
    } else {
        F = rbdi_rnea_up(m, w, i, flags, F, a, tau);
    }
    if (!(flags & RBDI_OFF_CHAIN) || l->parent == i - 1) return F;

    if (l->parent >= 0) w->scratch[l->parent].f = rbdi_force_add(w->scratch[l->parent].f, F);
    return rbdi_force0();
}

/* Torques from the wrenches that move the links. */
RBDI_PART void rbdi_rnea_sweep(const rbd_model *m, const rbd_work *w, const rbd_real *a, rbd_real *tau) {
    rbdi_force carried = rbdi_force0();
    for (int i = m->nl - 1; i >= 0; --i)
        RBDI_BY_FLAGS(const int flags, &m->link[i],
                      carried = rbdi_rnea_step(m, w, i, flags, carried, a, tau));
}

/* RBDA table 5.1 in classical accelerations, after rbdi_joints. */
RBDI_PART void rbdi_rnea(const rbd_model *m, rbd_work *w, const rbd_real *v, const rbd_real *a,
                         const rbd_real *f_ext, rbd_real *tau) {
    const rbdi_state world = rbdi_world_state(w->gravity);
    rbdi_forward(m, w, 0, m->nl, &world, v, a, 1, 0);
    rbdi_external(m, w, f_ext);
    rbdi_rnea_sweep(m, w, a, tau);
}

RBDI_API rbd_status rbd_rnea(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *a, const rbd_real *f_ext, rbd_real *tau) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && a && tau);
    if (status) return status;

    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    v = rbdi_expand_v(m, v, w->vx);
    a = rbdi_expand_v(m, a, w->ax);
    rbdi_rnea(m, w, v, a, f_ext, rbdi_mimics(m) ? w->tx : tau);
    rbdi_reduce_tau(m, w->tx, tau);
    return RBD_OK;
}

RBDI_API rbd_status rbd_bias(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *f_ext, rbd_real *c) {
    if (!w) return RBD_ERR_NULL;
    return rbd_rnea(m, w, q, v, w->zero, f_ext, c);
}

RBDI_API rbd_status rbd_gravity_torque(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *g) {
    if (!w) return RBD_ERR_NULL;
    return rbd_rnea(m, w, q, w->zero, w->zero, NULL, g);
}

/* Table 5.1 with v in the place of a, without velocity and gravity: then the accelerations are velocities V_i
   = (omega_dot; acc), kept in scratch.c, and the wrenches on the links are their momenta. Up, with the
   momenta h_i of the subtrees: p_i = S_i' h_i, (C' v)_i = (dS_i/dt)' h_i = (V_i x S_i)' h_i = -S_i' (V_i x*
   h_i). */
RBDI_PART void rbdi_momenta(const rbd_model *m, rbd_work *w, const rbd_real *v, rbd_real *p, rbd_real *ctv) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    const rbdi_state world = rbdi_world_state(none);
    rbdi_state s = world;

    /* down: V_i, and the momenta of the links */
    for (int i = 0; i < m->nl; ++i) {
        s = rbdi_forward_step(m, w, i, rbdi_flags(&m->link[i]), &world, w->zero, v, s, 1);
        w->scratch[i].c.omega = s.omega_dot;
        w->scratch[i].c.v = s.acc;
    }

    /* up: p_i = S_i' h_i, (C' v)_i = -S_i' (V_i x* h_i) */
    for (int i = m->nl - 1; i >= 0; --i) {
        const rbdi_link *l = &m->link[i];
        const rbdi_motion V = w->scratch[i].c;
        rbdi_force h = w->scratch[i].f, h_x_V; /* -V x* h */

        h_x_V.n = rbdi_add(rbdi_cross(h.n, V.omega), rbdi_cross(h.f, V.v));
        h_x_V.f = rbdi_cross(h.f, V.omega);

        if (rbdi_is(l, RBDI_BLOCK)) {
            rbdi_rnea_up_block(m, w, l, v, p, &h);
            rbdi_rnea_up_block(m, w, l, w->zero, ctv, &h_x_V);
        } else {
            h = rbdi_rnea_up(m, w, i, rbdi_flags(l), h, v, p);
            rbdi_rnea_up(m, w, i, rbdi_flags(l) | RBDI_ROOT, h_x_V, w->zero, ctv);
        }

        if (l->parent >= 0) w->scratch[l->parent].f = rbdi_force_add(w->scratch[l->parent].f, h);
    }
}

RBDI_API rbd_status rbd_generalized_momentum(const rbd_model *m, rbd_work *w, const rbd_real *q,
                                             const rbd_real *v, rbd_real *p, rbd_real *ctv) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && v);
    if (status) return status;

    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    if (!p) p = w->bias;
    if (!ctv) ctv = w->bias;
    rbdi_momenta(m, w, rbdi_expand_v(m, v, w->vx), rbdi_mimics(m) ? w->tx : p, rbdi_mimics(m) ? w->ax : ctv);
    rbdi_reduce_tau(m, w->tx, p);
    rbdi_reduce_tau(m, w->ax, ctv);
    return RBD_OK;
}

RBDI_API rbd_status rbd_passive(const rbd_model *m, rbd_work *w, const rbd_real *v, rbd_real *tau) {
    const rbd_real *vx;
    rbd_real *tx;
    const rbd_status status = rbdi_check(m, w, v && tau);
    if (status) return status;

    /* tau = -damping v - friction sign(v) */
    vx = rbdi_expand_v(m, v, w->vx);
    tx = rbdi_mimics(m) ? w->tx : tau;
    for (int k = 0; k < m->nv + rbdi_mimics(m); ++k) {
        rbd_real o = rbdi_zero(), f = rbdi_set(m->dof[k].friction), x = vx[k];
        rbd_real sign = rbdi_select(rbdi_less(x, o), f, rbdi_select(rbdi_less(o, x), -f, o));
        tx[k] = sign - x * m->dof[k].damping;
    }

    rbdi_reduce_tau(m, tx, tau);
    return RBD_OK;
}

#endif
