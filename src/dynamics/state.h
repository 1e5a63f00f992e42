#ifndef RBDI_DYNAMICS_STATE_H
#define RBDI_DYNAMICS_STATE_H
#include "model/joints.h"

/* Interface: rbdi_expand_q, rbdi_expand_v, rbdi_external, rbdi_forward, rbdi_reduce_tau, rbdi_world_state */

/* ---- state [state] ----
   Velocity and acceleration of a link from its parent's, p: RBDA section 5.3 with classical accelerations. E
   = down, z the joint's axis, Omega as in [design]:

       omega     = E omega_p + z turn                         turn, slide = rho, kappa times qd
       omega_dot = E omega_dot_p + (E omega_p) x z turn + z turn_dot
       acc       = E (acc_p + Omega_p r) + Omega d z + 2 (E omega_p) x z slide + z slide_dot

   Table 5.1 has a_i = X a_p + S qdd + c with c = v x S qd. The terms of c with linear velocity are in Omega
   here. */

/* Velocity-product terms that a joint with velocity J adds to (omega_dot; acc), with omega_E = E omega_p:

       (omega_E x J_omega; (2 omega_E + J_omega) x J_v) */
RBDI_INLINE rbdi_motion rbdi_joint_product(rbdi_v3 omega_E, rbdi_motion J) {
    rbdi_motion c;
    c.omega = rbdi_cross(omega_E, J.omega);
    c.v = rbdi_cross(rbdi_add(rbdi_add(omega_E, omega_E), J.omega), J.v);
    return c;
}

/* Acceleration, relative to the parent's origin, of the point r where the joint sits: Omega r. */
RBDI_INLINE rbdi_v3 rbdi_shift_acceleration(const rbdi_link *l, int flags, rbdi_state p) {
    const rbdi_mat O = rbdi_omega(p.omega, p.omega_dot);
    if (flags & RBDI_SHIFT_XYZ) return rbdi_mul(O, rbdi_vec_c(l->r));
    return rbdi_vec(O.xx * l->r.x, O.yx * l->r.x, O.zx * l->r.x);
}

/* Velocity and acceleration of a one-axis link from its parent's, p, by the formulas of [state]. The linear
   velocity never appears. */
RBDI_INLINE rbdi_state rbdi_forward_axis(const rbdi_link *l, int flags, rbdi_trig t, rbdi_state p,
                                         rbd_real qd, rbd_real qdd) {
    const int screw = flags & RBDI_SLIDES;
    rbd_real turn = screw ? qd * l->rho : qd, turn_rate = screw ? qdd * l->rho : qdd;
    rbdi_v3 omega_E = rbdi_vec0(); /* E omega_p */
    rbdi_state s;

    /* omega, omega_dot, acc_p + Omega_p r */
    if (flags & RBDI_ROOT) {
        s.omega = rbdi_vec(rbdi_zero(), rbdi_zero(), turn);
        s.omega_dot = rbdi_vec(rbdi_zero(), rbdi_zero(), turn_rate);
    } else {
        omega_E = rbdi_down(l, flags, t, p.omega);
        s.omega_dot = rbdi_down(l, flags, t, p.omega_dot);
        s.omega_dot = rbdi_vec(s.omega_dot.x + turn * omega_E.y, s.omega_dot.y - turn * omega_E.x,
                               s.omega_dot.z + turn_rate);
        s.omega = rbdi_vec(omega_E.x, omega_E.y, omega_E.z + turn);
        if (flags & RBDI_SHIFT_R) p.acc = rbdi_add(p.acc, rbdi_shift_acceleration(l, flags, p));
    }

    /* acc = E (acc_p + Omega_p r) + Omega d z + 2 (E omega_p) x z slide + z slide_dot */
    s.acc = rbdi_down(l, flags, t, p.acc);
    if (flags & RBDI_SHIFT_Z) { /* Omega z is also that of the parent: the axis is fixed in both bodies */
        const rbdi_mat O = rbdi_omega(s.omega, s.omega_dot);
        s.acc.x = s.acc.x + t.d * O.xz;
        s.acc.y = s.acc.y + t.d * O.yz;
        s.acc.z = s.acc.z + t.d * O.zz;
    }

    if (screw) {
        rbd_real twice_slide = (qd + qd) * l->kappa;
        s.acc.x = s.acc.x + twice_slide * omega_E.y;
        s.acc.y = s.acc.y - twice_slide * omega_E.x;
        s.acc.z = s.acc.z + qdd * l->kappa;
    }

    return s;
}

/* The same of a block. s: the parent's state, which becomes the link's. With J = S v, Jd = S a, omega_E =
   E omega_p and c of rbdi_joint_product:

       omega     = omega_E + J_omega
       omega_dot = E omega_dot_p + c_omega + Jd_omega
       acc       = E (acc_p + Omega_p r) + c_v + Jd_v */
RBDI_PART void rbdi_forward_block(const rbd_model *m, const rbd_work *w, const rbdi_link *l,
                                  const rbd_real *v, const rbd_real *a, rbdi_state *s) {
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_pose *X = &w->block[l->block].X;
    const rbdi_motion J = rbdi_block_motion(b, &v[l->iv]), Jd = rbdi_block_motion(b, &a[l->iv]);
    rbdi_motion c;
    rbdi_v3 omega_E = rbdi_vec0();
    rbdi_v3 omega_dot = omega_E;
    rbdi_v3 acc = s->acc;

    if (!rbdi_on_world(l)) { /* the world does not turn */
        omega_E = rbdi_mul(X->E, s->omega);
        omega_dot = rbdi_mul(X->E, s->omega_dot);
        acc = rbdi_add(acc, rbdi_mul(rbdi_omega(s->omega, s->omega_dot), X->r));
    }

    c = rbdi_joint_product(omega_E, J);
    s->omega = rbdi_add(omega_E, J.omega);
    s->omega_dot = rbdi_add(omega_dot, rbdi_add(c.omega, Jd.omega));
    s->acc = rbdi_add(rbdi_mul(X->E, acc), rbdi_add(c.v, Jd.v));
}

/* The state that the world gives to the roots: gravity as an upward acceleration. */
RBDI_INLINE rbdi_state rbdi_world_state(rbdi_c3 gravity) {
    rbdi_state s;
    s.omega = s.omega_dot = rbdi_vec0();
    s.acc = rbdi_sub(rbdi_vec0(), rbdi_vec_c(gravity));
    return s;
}

/* Wrench that moves a link, with O = Omega:

       f = Omega h + m acc,   n = (K_zy - K_yz; K_xz - K_zx; K_yx - K_xy),   K = Omega Sigma + acc h'

   A regrouped revolute link has m = h_z = Sigma_zz = 0. acc = NULL means zero. */
RBDI_INLINE rbdi_force rbdi_wrench(const rbdi_link *l, int flags, rbdi_mat O, const rbdi_v3 *acc) {
    const rbdi_csym Sigma = l->Sigma;
    const rbdi_c3 h = l->h;
    rbdi_force F;

    /* Omega h and Omega Sigma, without h_z and Sigma_zz */
    F.f.x = O.xx * h.x + O.xy * h.y;
    F.f.y = O.yx * h.x + O.yy * h.y;
    F.f.z = O.zx * h.x + O.zy * h.y;
    F.n.x = O.zx * Sigma.xy + O.zy * Sigma.yy + (O.zz - O.yy) * Sigma.yz - O.yx * Sigma.xz;
    F.n.y = O.xy * Sigma.yz + (O.xx - O.zz) * Sigma.xz - O.zx * Sigma.xx - O.zy * Sigma.xy;
    F.n.z = O.yx * Sigma.xx + (O.yy - O.xx) * Sigma.xy + O.yz * Sigma.xz - O.xy * Sigma.yy - O.xz * Sigma.yz;

    /* acc h', without h_z */
    if (acc) {
        F.n.x = F.n.x + acc->z * h.y;
        F.n.y = F.n.y - acc->z * h.x;
        F.n.z = F.n.z + (acc->y * h.x - acc->x * h.y);
    }

    /* the terms of m, h_z and Sigma_zz */
    if (flags & RBDI_MASS_KEPT) {
        F.f.x = F.f.x + O.xz * h.z;
        F.f.y = F.f.y + O.yz * h.z;
        F.f.z = F.f.z + O.zz * h.z;
        F.n.x = F.n.x - O.yz * Sigma.zz;
        F.n.y = F.n.y + O.xz * Sigma.zz;

        if (acc) {
            F.f.x = F.f.x + acc->x * l->mass;
            F.f.y = F.f.y + acc->y * l->mass;
            F.f.z = F.f.z + acc->z * l->mass;
            F.n.x = F.n.x - acc->y * h.z;
            F.n.y = F.n.y + acc->x * h.z;
        }
    }

    return F;
}

/* One step of the sweep root to leaf: the state of link i from that of link i - 1, or from the parent's kept
   state; and the wrench that moves the link, if wanted. */
RBDI_INLINE rbdi_state rbdi_forward_step(const rbd_model *m, rbd_work *w, int i, int flags,
                                         const rbdi_state *world, const rbd_real *v, const rbd_real *a,
                                         rbdi_state s, int wrench) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;

    if (off_chain && l->parent != i - 1)
        s = l->parent < 0 ? *world : w->branch[m->link[l->parent].branch].state;
    if (rbdi_block_link(l, flags)) {
        rbdi_state block = s; /* an address of s would keep it in memory */
        rbdi_forward_block(m, w, l, v, a, &block);
        s = block;
    } else {
        s = rbdi_forward_axis(l, flags, rbdi_trig_of(m, w, i, flags), s, v[l->iv], a[l->iv]);
    }

    if (wrench) w->scratch[i].f = rbdi_wrench(l, flags, rbdi_omega(s.omega, s.omega_dot), &s.acc);
    if (off_chain && l->branch >= 0) w->branch[l->branch].state = s;
    return s;
}

/* The states of the links first .. end - 1, after those of their ancestors, with the wrenches if wanted;
   keep: stored in kin as well. */
RBDI_INLINE void rbdi_forward(const rbd_model *m, rbd_work *w, int first, int end, const rbdi_state *world,
                              const rbd_real *v, const rbd_real *a, int wrench, int keep) {
    rbdi_state s = *world;
    for (int i = first; i < end; ++i) {
        RBDI_BY_FLAGS(const int flags, &m->link[i],
                      s = rbdi_forward_step(m, w, i, flags, world, v, a, s, wrench));
        if (keep) w->kin[i].state = s;
    }
}

/* With mimic joints the algorithms run on coordinates with the mimics' appended; without, on the
   caller's own arrays. */
RBDI_PART const rbd_real *rbdi_expand_q(const rbd_model *m, rbd_work *w, const rbd_real *q) {
    if (rbdi_mimics(m) == 0) return q;
    for (int k = 0; k < m->nq; ++k) w->qx[k] = q[k];
    for (int k = 0; k < rbdi_mimics(m); ++k)
        w->qx[m->nq + k] = q[m->mimic[k].source_q] * m->mimic[k].ratio + m->mimic[k].offset;
    return w->qx;
}

RBDI_PART const rbd_real *rbdi_expand_v(const rbd_model *m, const rbd_real *v, rbd_real *vx) {
    if (rbdi_mimics(m) == 0) return v;
    for (int k = 0; k < m->nv; ++k) vx[k] = v[k];
    for (int k = 0; k < rbdi_mimics(m); ++k) vx[m->nv + k] = v[m->mimic[k].source_v] * m->mimic[k].ratio;
    return vx;
}

/* tau = G' tau_x, for v_x = G v. */
RBDI_PART void rbdi_reduce_tau(const rbd_model *m, const rbd_real *tx, rbd_real *tau) {
    if (rbdi_mimics(m) == 0) return;
    for (int k = 0; k < m->nv; ++k) tau[k] = tx[k];
    for (int k = 0; k < rbdi_mimics(m); ++k)
        tau[m->mimic[k].source_v] = tau[m->mimic[k].source_v] + tx[m->nv + k] * m->mimic[k].ratio;
}

/* Subtracts the external wrenches, given in the user's frames, from those of the links. */
RBDI_PART void rbdi_external(const rbd_model *m, rbd_work *w, const rbd_real *f_ext) {
    const int bodies = f_ext ? m->nb : 0;

    for (int body = 0; body < bodies; ++body) {
        const rbdi_frame *u = &m->frame[body];
        rbdi_pose X;
        if (u->link < 0) continue;
        X.E = rbdi_mat_c(u->E);
        X.r = rbdi_vec_c(u->r);
        w->scratch[u->link].f = rbdi_force_sub(w->scratch[u->link].f,
                                               rbdi_force_up_block(&X, rbdi_load_force(f_ext + 6 * body, 1)));
    }
}

#endif
