#ifndef RBDI_DYNAMICS_ABA_H
#define RBDI_DYNAMICS_ABA_H
#include "dynamics/state.h"
#include "dynamics/aba_elimination.h"

/* Interface: rbdi_aba_pass2, rbdi_aba_pass3, rbdi_aba_velocities */

/* -- the three passes -- */

/* Pass 1, one-axis link: its velocity-product acceleration c, and omega: the parent's becomes the link's.
   With E, z, turn and slide as in [state], omega_p of the parent and omega_E = E omega_p:

       c_omega = omega_E x z turn
       c_v     = E (omega_p x (omega_p x r)) + omega_E x (omega_E x d z) + 2 omega_E x z slide
       omega   = omega_E + z turn */
RBDI_INLINE rbdi_motion rbdi_aba_velocity(const rbdi_link *l, int flags, rbdi_trig t, rbd_real qd,
                                          rbdi_v3 *omega) {
    const int screw = flags & RBDI_SLIDES;
    const rbdi_v3 omega_p = *omega;
    rbd_real turn = screw ? qd * l->rho : qd;
    rbdi_motion c = rbdi_motion0();
    rbdi_v3 omega_E;

    if (flags & RBDI_ROOT) {
        *omega = rbdi_vec(rbdi_zero(), rbdi_zero(), turn);
        return c;
    }

    if (flags & RBDI_SHIFT_R)
        c.v = rbdi_down(l, flags, t, rbdi_cross(omega_p, rbdi_cross_shift(l, flags, omega_p)));
    omega_E = rbdi_down(l, flags, t, omega_p);
    c.omega.x = turn * omega_E.y;
    c.omega.y = -(turn * omega_E.x);

    if (flags & RBDI_SHIFT_Z) {
        c.v.x = c.v.x + t.d * (omega_E.x * omega_E.z);
        c.v.y = c.v.y + t.d * (omega_E.y * omega_E.z);
        c.v.z = c.v.z - t.d * (omega_E.x * omega_E.x + omega_E.y * omega_E.y);
    }

    if (screw) {
        rbd_real twice_slide = (qd + qd) * l->kappa;
        c.v.x = c.v.x + twice_slide * omega_E.y;
        c.v.y = c.v.y - twice_slide * omega_E.x;
    }

    *omega = rbdi_vec(omega_E.x, omega_E.y, omega_E.z + turn);
    return c;
}

/* The same of a block: with J = S v, the velocity of its joint,

       c = (omega_E x J_omega; E (omega_p x (omega_p x r)) + (2 omega_E + J_omega) x J_v) */
RBDI_INLINE rbdi_motion rbdi_aba_velocity_block(const rbdi_link *l, const rbdi_block *b, const rbdi_pose *X,
                                                const rbd_real *v, rbdi_v3 *omega) {
    const rbdi_v3 omega_p = *omega;
    rbdi_motion J = rbdi_block_motion(b, v), c = rbdi_motion0();
    rbdi_v3 omega_E;

    if (rbdi_on_world(l)) { /* the world does not turn */
        *omega = J.omega;
        c.v = rbdi_cross(J.omega, J.v);
        return c;
    }

    omega_E = rbdi_mul(X->E, omega_p);
    c = rbdi_joint_product(omega_E, J);
    c.v = rbdi_add(c.v, rbdi_mul(X->E, rbdi_cross(omega_p, rbdi_cross(omega_p, X->r))));
    *omega = rbdi_add(omega_E, J.omega);
    return c;
}

/* Pass 1, link i: its c, and in scratch.f its pA without external wrenches: the wrench that moves the link
   where omega_dot = acc = 0. Takes omega of link i - 1, returns that of link i. A root does not read it. */
RBDI_INLINE rbdi_v3 rbdi_aba_pass1_step(const rbd_model *m, rbd_work *w, int i, int flags, const rbd_real *v,
                                        rbdi_v3 omega) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;
    rbdi_motion *c = &w->scratch[i].c;

    if (off_chain && l->parent != i - 1 && l->parent >= 0)
        omega = w->branch[m->link[l->parent].branch].state.omega;
    if (rbdi_block_link(l, flags))
        *c = rbdi_aba_velocity_block(l, rbdi_block_of(m, l), &w->block[l->block].X, &v[l->iv], &omega);
    else
        *c = rbdi_aba_velocity(l, flags, rbdi_trig_of(m, w, i, flags), v[l->iv], &omega);

    w->scratch[i].f = rbdi_wrench(l, flags, rbdi_omega_steady(omega), NULL);
    if (off_chain && l->branch >= 0) {
        w->branch[l->branch].state.omega = omega;
        w->branch[l->branch].I = rbdi_abi_zero(); /* for the sum of pass 2 */
    }

    return omega;
}

/* Pass 1, root to leaves. keep: stores omega in each link's kin. */
RBDI_INLINE void rbdi_aba_velocities(const rbd_model *m, rbd_work *w, const rbd_real *v, int keep) {
    rbdi_v3 omega = rbdi_vec0();
    for (int i = 0; i < m->nl; ++i) {
        RBDI_BY_FLAGS(const int flags, &m->link[i], omega = rbdi_aba_pass1_step(m, w, i, flags, v, omega));
        if (keep) w->kin[i].state.omega = omega;
    }
}

/* Hands the contribution of link i to its parent. Link i - 1 takes IA and pA as they are, from registers. Any
   other parent is a branch point: they are added to its sums, and what link i - 1 takes becomes 0. */
RBDI_INLINE void rbdi_aba_to_parent(const rbd_model *m, rbd_work *w, int i, rbdi_abi *IA, rbdi_force *pA) {
    const int parent = m->link[i].parent;
    if (parent == i - 1) return;

    if (parent >= 0) {
        rbdi_branch *branch = &w->branch[m->link[parent].branch];
        branch->I = rbdi_abi_add(branch->I, *IA);
        w->scratch[parent].f = rbdi_force_add(w->scratch[parent].f, *pA);
    }

    *IA = rbdi_abi_zero();
    *pA = rbdi_force0();
}

/* Pass 2, link i. IA and pA come with the contribution of link i + 1, or 0 if that is no child of link i, and
   become what link i - 1 takes from link i. The link's own pA stands in scratch.f, with the contributions of
   its other children. */
RBDI_INLINE void rbdi_aba_pass2_step(const rbd_model *m, rbd_work *w, int i, int flags, const rbd_real *tau,
                                     rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;

    if (off_chain && l->branch >= 0) *IA = rbdi_abi_add(*IA, w->branch[l->branch].I);
    *pA = rbdi_force_add(*pA, w->scratch[i].f);

    if (rbdi_block_link(l, flags)) {
        /* copies: without an address taken IA and pA of other links stay in registers */
        rbdi_abi copy_IA = *IA;
        rbdi_force copy_pA = *pA;
        rbdi_mask copy_doubt = *doubt;
        rbdi_aba_up_block(m, w, i, tau, &copy_IA, &copy_pA, &copy_doubt);
        *IA = copy_IA;
        *pA = copy_pA;
        *doubt = copy_doubt;
    } else {
        rbdi_aba_up(m, w, i, flags, tau, IA, pA, doubt);
    }

    if (off_chain) rbdi_aba_to_parent(m, w, i, IA, pA);
}

/* Whether the first dof of link i turns. */
RBDI_INLINE int rbdi_turns_first(const rbd_model *m, int i) {
    const rbdi_link *l = &m->link[i];
    return rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first < 3 : l->rho > 0;
}

/* Whether a joint has slid so far that dof.scale of the nearest turning joint before it is no bound, because
   it is taken at q = 0:

       slide^2 times the mass of the subtree that slides > RBDI_FAR dof.scale */
RBDI_PART rbdi_mask rbdi_slid_far(const rbd_model *m, const rbd_work *w) {
    rbdi_mask slid = rbdi_less(rbdi_zero(), rbdi_zero());
    if (!(RBDI_FEATURES & m->features & (RBDI_SLIDES | RBDI_OTHER_BLOCKS))) return slid;

    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        const int block = rbdi_is(l, RBDI_BLOCK);
        rbd_real square;
        rbd_const scale;
        int turning = l->parent;
        if (!block && !(rbdi_flags(l) & RBDI_SLIDES)) continue;

        while (turning >= 0 && !rbdi_turns_first(m, turning)) turning = m->link[turning].parent;
        if (turning < 0) continue;

        square = block ? rbdi_dot(w->block[l->block].X.r, w->block[l->block].X.r) : w->d[i] * w->d[i];
        scale = m->dof[m->link[turning].iv].scale;
        slid = rbdi_or(slid, rbdi_less(rbdi_set(scale * RBDI_FAR), square * l->subtree_mass));
    }

    return slid;
}

/* Pass 2, leaves first. Returns whether a pivot is in doubt. */
RBDI_PART rbdi_mask rbdi_aba_pass2(const rbd_model *m, rbd_work *w, const rbd_real *tau) {
    rbdi_abi IA = rbdi_abi_zero();
    rbdi_force pA = rbdi_force0();
    rbdi_mask doubt = rbdi_slid_far(m, w);
    for (int i = m->nl - 1; i >= 0; --i) {
        RBDI_BY_FLAGS(const int flags, &m->link[i],
                      rbdi_aba_pass2_step(m, w, i, flags, tau, &IA, &pA, &doubt));
    }
    return doubt;
}

/* Pass 3: X y, for the parent's y = (omega_dot; acc), acc the classical acceleration minus gravity:

       X y = (E omega_dot; E (acc + omega_dot x r) + (E omega_dot) x d z) */
RBDI_INLINE rbdi_motion rbdi_aba_carry(const rbd_model *m, const rbd_work *w, int i, int flags,
                                       rbdi_motion y) {
    const rbdi_link *l = &m->link[i];
    const rbdi_trig t = rbdi_trig_of(m, w, i, flags);

    if (!(flags & RBDI_ROOT) && (flags & RBDI_SHIFT_R))
        y.v = rbdi_add(y.v, rbdi_cross_shift(l, flags, y.omega));
    y.omega = rbdi_down(l, flags, t, y.omega);
    y.v = rbdi_down(l, flags, t, y.v);

    if (flags & RBDI_SHIFT_Z) {
        y.v.x = y.v.x + t.d * y.omega.y;
        y.v.y = y.v.y - t.d * y.omega.x;
    }

    return y;
}

/* The same of a block, whose d is 0. */
RBDI_INLINE rbdi_motion rbdi_aba_carry_block(const rbd_work *w, const rbdi_link *l, rbdi_motion y) {
    const rbdi_pose *X = &w->block[l->block].X;
    y.v = rbdi_mul(X->E, rbdi_add(y.v, rbdi_cross(y.omega, X->r)));
    y.omega = rbdi_mul(X->E, y.omega);
    return y;
}

/* Pass 3, one-axis link:

       y = X y_p + c,   qdd = u/D - (U/D)' y,   y += S qdd

   x is qdd without the term of y.omega.z. A revolute joint without armature has U_z/D = 1, so that
   qdd = x - y.omega.z: its new y.omega.z is x. */
RBDI_INLINE rbdi_motion rbdi_aba_down(const rbd_model *m, const rbd_work *w, int i, int flags, rbdi_motion y,
                                      rbd_real *a) {
    const rbdi_link *l = &m->link[i];
    const rbdi_scratch *scratch = &w->scratch[i];
    const rbdi_force *U_D = &scratch->U_D;
    rbd_real x, qdd;

    y = rbdi_motion_add(rbdi_aba_carry(m, w, i, flags, y), scratch->c);
    x = scratch->u_D - (U_D->n.x * y.omega.x + U_D->n.y * y.omega.y) - rbdi_dot(U_D->f, y.v);

    if (!rbdi_keeps_row_z(flags)) {
        a[l->iv] = x - y.omega.z;
        y.omega.z = x;
        return y;
    }

    qdd = x - U_D->n.z * y.omega.z;
    if (flags & RBDI_SLIDES) {
        y.omega.z = y.omega.z + qdd * l->rho;
        y.v.z = y.v.z + qdd * l->kappa;
    } else {
        y.omega.z = y.omega.z + qdd;
    }

    a[l->iv] = qdd;
    return y;
}

/* The same of a block, its axes one by one, the first first. all: y as an array. A free base keeps U/D only
   for the axes before: for its own axis it is 1, for those behind 0. So its qdd is x - y_k, and x the new
   y_k. */
RBDI_PART rbdi_motion rbdi_aba_down_block(const rbd_model *m, const rbd_work *w, int i, rbdi_motion y,
                                          rbd_real *a) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block_work *bw = &w->block[l->block];
    const rbdi_block *b = rbdi_block_of(m, l);
    rbd_real all[6];

    rbdi_store_motion(all, 1, rbdi_motion_add(rbdi_aba_carry_block(w, l, y), w->scratch[i].c));
    if (rbdi_free_base(l, b)) {
        RBDI_UNROLL_SIX for (int k = 0; k < 6; ++k) {
            rbd_real x = bw->u_D[k];
            RBDI_UNROLL_SIX for (int j = 0; j < k; ++j)
                x = x - bw->U_D[k][j] * all[j];
            a[l->iv + k] = x - all[k];
            all[k] = x;
        }
        return rbdi_load_motion(all, 1);
    }

    for (int k = 0; k < b->n; ++k) {
        rbd_real qdd = bw->u_D[k];
        RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
            qdd = qdd - bw->U_D[k][j] * all[j];
        all[b->first + k] = all[b->first + k] + qdd;
        a[l->iv + k] = qdd;
    }

    return rbdi_load_motion(all, 1);
}

/* Pass 3, link i: takes y of link i - 1, returns that of link i. world: y of the world. */
RBDI_INLINE rbdi_motion rbdi_aba_pass3_step(const rbd_model *m, rbd_work *w, int i, int flags,
                                            const rbdi_motion *world, rbdi_motion y, rbd_real *a) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;

    if (off_chain && l->parent < 0)
        y = *world;
    else if (off_chain && l->parent != i - 1)
        y = w->branch[m->link[l->parent].branch].y;

    if (rbdi_block_link(l, flags))
        y = rbdi_aba_down_block(m, w, i, y, a);
    else
        y = rbdi_aba_down(m, w, i, flags, y, a);

    if (off_chain && l->branch >= 0) w->branch[l->branch].y = y;
    return y;
}

/* Pass 3, root to leaves. minus_g: acceleration of the world, minus gravity. */
RBDI_PART void rbdi_aba_pass3(const rbd_model *m, rbd_work *w, rbdi_v3 minus_g, rbd_real *a) {
    rbdi_motion world = rbdi_motion0(), y;

    world.v = minus_g;
    y = world;
    for (int i = 0; i < m->nl; ++i)
        RBDI_BY_FLAGS(const int flags, &m->link[i], y = rbdi_aba_pass3_step(m, w, i, flags, &world, y, a));
}

#endif
