#ifndef RBDI_DYNAMICS_ABA_H
#define RBDI_DYNAMICS_ABA_H
#include "dynamics/state.h"

/* Interface: rbdi_aba_pass2, rbdi_aba_pass3, rbdi_aba_velocities, rbdi_free_base */

/* ---- aba [aba] ----
   RBDA table 7.1, its c, pA and a classical ([design]):

       pass 1   omega_i, c_i,  pA_i = wrench with omega_dot = acc = 0   rbdi_aba_velocity, rbdi_wrench
                pA_i -= X* f_ext                                    rbdi_external
       pass 2   U = IA S,  D = S' U,  u = tau - S' pA               rbdi_aba_eliminate
                Ia = IA - U U'/D,  pa = pA + Ia c + U u/D
                IA_p += X' Ia X,  pA_p += X' pa                     rbdi_abi_up, rbdi_force_up
       pass 3   y = X y_p + c,  qdd = (u - U' y)/D,  y += S qdd     rbdi_aba_down

   IA = [I H; H' M]. A revolute joint without armature leaves S' Ia = U' - (D/D) U' = 0: row z of I and H is
   zero and stays zero through the shift along z and the turn about it: rbdi_aba_eliminate and
   rbdi_abi_shift_z rely on that. Also S' pa = S' pA + S' Ia c + (S' U/D) u = S' pA + u = tau: the moment on
   the parent about the joint's axis is the torque. */

/* Articulated-body inertia of a one-axis link, to the parent's axes and origin. */
RBDI_INLINE rbdi_abi rbdi_abi_up(const rbdi_link *l, int flags, rbdi_trig t, rbdi_abi IA) {
    if (flags & RBDI_SHIFT_Z) IA = rbdi_abi_shift_z(t.d, flags & (RBDI_SLIDES | RBDI_ARMATURE), IA);
    IA = rbdi_abi_up_z(0, t.c, t.s, IA);
    IA = rbdi_abi_up_z(flags, rbdi_set(l->ca), rbdi_set(l->sa), rbdi_abi_cycle(IA));
    if (!(flags & RBDI_SHIFT_R)) return rbdi_abi_uncycle(IA);
    if (!(flags & RBDI_SHIFT_XYZ)) return rbdi_abi_uncycle(rbdi_abi_shift_z(rbdi_set(l->r.x), 1, IA));
    IA = rbdi_abi_uncycle(IA);
    if (flags & RBDI_BRANCH_TURN) IA = rbdi_abi_up_z(0, rbdi_set(l->cb), rbdi_set(l->sb), IA);
    return rbdi_abi_shift(rbdi_vec_c(l->r), IA);
}
RBDI_INLINE rbdi_abi rbdi_abi_up_block(const rbdi_pose *X, rbdi_abi IA) {
    IA.I = rbdi_sym_up(X->E, IA.I);
    IA.H = rbdi_mat_up(X->E, IA.H);
    IA.M = rbdi_sym_up(X->E, IA.M);
    return rbdi_abi_shift(X->r, IA);
}

/* IA plus the link's own inertia [tr(Sigma) - Sigma, [h]x; ., m]. */
RBDI_INLINE rbdi_abi rbdi_abi_add_link(const rbdi_link *l, int flags, rbdi_abi IA) {
    const rbdi_csym Sigma = l->Sigma;
    IA.I.xx = IA.I.xx + (Sigma.yy + Sigma.zz), IA.I.xy = IA.I.xy - Sigma.xy, IA.I.xz = IA.I.xz - Sigma.xz;
    IA.I.yy = IA.I.yy + (Sigma.xx + Sigma.zz), IA.I.yz = IA.I.yz - Sigma.yz,
    IA.I.zz = IA.I.zz + (Sigma.xx + Sigma.yy);
    IA.H.xz = IA.H.xz + l->h.y, IA.H.zx = IA.H.zx - l->h.y;
    IA.H.yz = IA.H.yz - l->h.x, IA.H.zy = IA.H.zy + l->h.x;
    if (flags & RBDI_MASS_KEPT) {
        IA.H.xy = IA.H.xy - l->h.z, IA.H.yx = IA.H.yx + l->h.z;
        IA.M.xx = IA.M.xx + l->mass, IA.M.yy = IA.M.yy + l->mass, IA.M.zz = IA.M.zz + l->mass;
    }
    return IA;
}

/* Pass 1, one-axis link: velocity omega (in: the parent's) and velocity-product acceleration c. */
RBDI_INLINE rbdi_motion rbdi_aba_velocity(const rbdi_link *l, int flags, rbdi_trig t, rbd_real qd,
                                          rbdi_v3 *omega) {
    const int screw = flags & RBDI_SLIDES;
    rbd_real turn = screw ? qd * l->rho : qd;
    rbdi_motion c = rbdi_motion0();
    if (flags & RBDI_ROOT) {
        *omega = rbdi_vec(rbdi_zero(), rbdi_zero(), turn);
        return c;
    }
    if (flags & RBDI_SHIFT_R)
        c.v = rbdi_down(l, flags, t, rbdi_cross(*omega, rbdi_cross_shift(l, flags, *omega)));
    *omega = rbdi_down(l, flags, t, *omega);
    c.omega.x = turn * omega->y;
    c.omega.y = -(turn * omega->x);
    if (flags & RBDI_SHIFT_Z) {
        c.v.x = c.v.x + t.d * (omega->x * omega->z);
        c.v.y = c.v.y + t.d * (omega->y * omega->z);
        c.v.z = c.v.z - t.d * (omega->x * omega->x + omega->y * omega->y);
    }
    if (screw) {
        rbd_real k = (qd + qd) * l->kappa;
        c.v.x = c.v.x + k * omega->y;
        c.v.y = c.v.y - k * omega->x;
    }
    omega->z = omega->z + turn;
    return c;
}
RBDI_INLINE rbdi_motion rbdi_aba_velocity_block(const rbdi_link *l, const rbdi_block *b, const rbdi_pose *X,
                                                const rbd_real *v, rbdi_v3 *omega) {
    rbdi_motion J = rbdi_block_motion(b, v), c = rbdi_motion0();
    rbdi_v3 turned;
    if (rbdi_on_world(l)) { /* the world does not turn */
        *omega = J.omega;
        c.v = rbdi_cross(J.omega, J.v);
        return c;
    }
    turned = rbdi_mul(X->E, *omega);
    c = rbdi_joint_product(turned, J);
    c.v = rbdi_add(c.v, rbdi_mul(X->E, rbdi_cross(*omega, rbdi_cross(*omega, X->r))));
    *omega = rbdi_add(turned, J.omega);
    return c;
}

/* Pass 1, link i, with the wrench that the velocity takes; omega: that of link i - 1 becomes link i's. */
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
        w->branch[l->branch].I = rbdi_abi_zero();
    }
    return omega;
}

/* keep: stores omega in each link's kin. */
RBDI_INLINE void rbdi_aba_velocities(const rbd_model *m, rbd_work *w, const rbd_real *v, int keep) {
    rbdi_v3 omega = rbdi_vec0();
    for (int i = 0; i < m->nl; ++i) {
        RBDI_BY_FLAGS(flags, &m->link[i], omega = rbdi_aba_pass1_step(m, w, i, flags, v, omega));
        if (keep) w->kin[i].state.omega = omega;
    }
}

/* U = IA S. */
RBDI_INLINE rbdi_force rbdi_abi_axis(const rbdi_link *l, int flags, const rbdi_abi *IA) {
    rbdi_force U;
    U.n = rbdi_vec(IA->I.xz, IA->I.yz, IA->I.zz);
    U.f = rbdi_vec(IA->H.zx, IA->H.zy, IA->H.zz);
    if (flags & RBDI_SLIDES) {
        U.n = rbdi_add(rbdi_scale(rbdi_set(l->rho), U.n),
                       rbdi_scale(rbdi_set(l->kappa), rbdi_vec(IA->H.xz, IA->H.yz, IA->H.zz)));
        U.f = rbdi_add(rbdi_scale(rbdi_set(l->rho), U.f),
                       rbdi_scale(rbdi_set(l->kappa), rbdi_vec(IA->M.xz, IA->M.yz, IA->M.zz)));
    }
    return U;
}

/* Pass 2, one-axis link: eliminates the joint's force. IA becomes Ia = IA - U U'/D, pA becomes pa = pA + Ia c
   + U u/D. For a revolute joint without armature (full = 0) row z of Ia is zero and the moment of pa about z
   is tau, see [aba]. c.omega.z is always 0. */
RBDI_INLINE void rbdi_aba_eliminate(const rbd_model *m, rbd_work *w, int i, int flags, rbd_real tau,
                                    rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const int full = flags & (RBDI_SLIDES | RBDI_ARMATURE);
    const rbdi_link *l = &m->link[i];
    const rbdi_dof *dof = &m->dof[l->iv];
    rbdi_scratch *own = &w->scratch[i];
    const rbdi_motion *c = &own->c;
    rbdi_force U, U_D;
    rbd_real D, inverse, u_D;
    U = rbdi_abi_axis(l, flags, IA);
    D = rbdi_along_axis(l, flags, U);
    if (full) D = D + dof->armature;
    w->pivot[l->iv] = D;
    inverse = rbdi_pivot_inverse(D, dof->scale, doubt);
    u_D = (tau - rbdi_along_axis(l, flags, *pA)) * inverse;
    U_D.n.x = inverse * U.n.x;
    U_D.n.y = inverse * U.n.y;
    U_D.f = rbdi_scale(inverse, U.f);
    own->U_D.n.x = U_D.n.x;
    own->U_D.n.y = U_D.n.y;
    own->U_D.f = U_D.f;
    own->u_D = u_D;

    IA->I.xx = IA->I.xx - U.n.x * U_D.n.x;
    IA->I.xy = IA->I.xy - U.n.x * U_D.n.y;
    IA->I.yy = IA->I.yy - U.n.y * U_D.n.y;
    IA->H.xx = IA->H.xx - U.n.x * U_D.f.x, IA->H.xy = IA->H.xy - U.n.x * U_D.f.y,
    IA->H.xz = IA->H.xz - U.n.x * U_D.f.z;
    IA->H.yx = IA->H.yx - U.n.y * U_D.f.x, IA->H.yy = IA->H.yy - U.n.y * U_D.f.y,
    IA->H.yz = IA->H.yz - U.n.y * U_D.f.z;
    IA->M.xx = IA->M.xx - U.f.x * U_D.f.x, IA->M.xy = IA->M.xy - U.f.x * U_D.f.y,
    IA->M.xz = IA->M.xz - U.f.x * U_D.f.z;
    IA->M.yy = IA->M.yy - U.f.y * U_D.f.y, IA->M.yz = IA->M.yz - U.f.y * U_D.f.z,
    IA->M.zz = IA->M.zz - U.f.z * U_D.f.z;
    pA->n.x = pA->n.x + (IA->I.xx * c->omega.x + IA->I.xy * c->omega.y) + U.n.x * u_D;
    pA->n.y = pA->n.y + (IA->I.xy * c->omega.x + IA->I.yy * c->omega.y) + U.n.y * u_D;
    pA->n.x = pA->n.x + (IA->H.xx * c->v.x + IA->H.xy * c->v.y + IA->H.xz * c->v.z);
    pA->n.y = pA->n.y + (IA->H.yx * c->v.x + IA->H.yy * c->v.y + IA->H.yz * c->v.z);
    pA->f.x = pA->f.x + (IA->H.xx * c->omega.x + IA->H.yx * c->omega.y) + U.f.x * u_D;
    pA->f.y = pA->f.y + (IA->H.xy * c->omega.x + IA->H.yy * c->omega.y) + U.f.y * u_D;
    pA->f.z = pA->f.z + (IA->H.xz * c->omega.x + IA->H.yz * c->omega.y) + U.f.z * u_D;
    pA->f = rbdi_add(pA->f, rbdi_mul_sym(IA->M, c->v));
    if (full) {
        own->U_D.n.z = U_D.n.z = inverse * U.n.z;
        IA->I.xz = IA->I.xz - U.n.x * U_D.n.z;
        IA->I.yz = IA->I.yz - U.n.y * U_D.n.z;
        IA->I.zz = IA->I.zz - U.n.z * U_D.n.z;
        IA->H.zx = IA->H.zx - U.n.z * U_D.f.x;
        IA->H.zy = IA->H.zy - U.n.z * U_D.f.y;
        IA->H.zz = IA->H.zz - U.n.z * U_D.f.z;
        pA->n.z = pA->n.z + (IA->I.xz * c->omega.x + IA->I.yz * c->omega.y) + U.n.z * u_D;
        pA->n.z = pA->n.z + (IA->H.zx * c->v.x + IA->H.zy * c->v.y + IA->H.zz * c->v.z);
    } else {
        IA->I.xz = IA->I.yz = IA->I.zz = IA->H.zx = IA->H.zy = IA->H.zz = rbdi_zero();
        pA->n.z = tau;
    }
}

/* Adds IA and pA to the sums of the parent, a branch point, unless it is link i - 1, which takes them from
   registers. */
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

/* A floating base on the world, without armature. */
RBDI_INLINE int rbdi_free_base(const rbdi_link *l, const rbdi_block *b) {
    return rbdi_on_world(l) && b->n == 6 && !(rbdi_flags(l) & RBDI_ARMATURE);
}
/* Pass 2, block link: eliminates its axes one by one, the last first, so that the pivots are those of M =
   L'DL. Only the lower triangle is kept; for a free base, which has no parent, only the part for the axes
   before. */
RBDI_PART void rbdi_aba_up_block(const rbd_model *m, rbd_work *w, int i_link, const rbd_real *tau,
                                 rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i_link];
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_motion c = w->scratch[i_link].c;
    rbdi_block_work *bw = &w->block[l->block];
    rbd_real A[6][6], P[6];
    rbdi_abi Ia;
    rbdi_force pa;
    rbdi_abi_to_array(rbdi_abi_add_link(l, RBDI_MASS_KEPT, *IA), A);
    rbdi_store_force(P, 1, *pA);
    for (int k = b->n - 1; k >= 0; --k) {
        const rbdi_dof *dof = &m->dof[l->iv + k];
        const int s = b->first + k, end = rbdi_free_base(l, b) ? s : 6;
        rbd_real *U_D = bw->U_D[k], D = A[s][s] + dof->armature,
                 inverse = rbdi_pivot_inverse(D, dof->scale, doubt);
        w->pivot[l->iv + k] = D;
        bw->u_D[k] = (tau[l->iv + k] - P[s]) * inverse;
        for (int i = 0; i < end; ++i) {
            const rbd_real U = i < s ? A[s][i] : A[i][s];
            U_D[i] = U * inverse;
            for (int j = 0; j <= i; ++j) A[i][j] = A[i][j] - U * U_D[j];
            P[i] = P[i] + U * bw->u_D[k];
        }
    }
    if (rbdi_on_world(l)) return;
    Ia = rbdi_abi_from_array(A);
    pa = rbdi_load_force(P, 1);
    pa.n = rbdi_add(pa.n, rbdi_add(rbdi_mul_sym(Ia.I, c.omega), rbdi_mul(Ia.H, c.v)));
    pa.f = rbdi_add(pa.f, rbdi_add(rbdi_mul_t(Ia.H, c.omega), rbdi_mul_sym(Ia.M, c.v)));
    *IA = rbdi_abi_up_block(&bw->X, Ia);
    *pA = rbdi_force_up_block(&bw->X, pa);
}

/* Pass 2, one-axis link: IA and pA, summed over the children, become the contribution to the parent. */
RBDI_INLINE void rbdi_aba_up(const rbd_model *m, rbd_work *w, int i, int flags, const rbd_real *tau,
                             rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const rbdi_trig t = rbdi_trig_of(m, w, i, flags);
    *IA = rbdi_abi_add_link(l, flags, *IA);
    rbdi_aba_eliminate(m, w, i, flags, tau[l->iv], IA, pA, doubt);
    if (flags & RBDI_ROOT) return;
    *IA = rbdi_abi_up(l, flags, t, *IA);
    *pA = rbdi_force_up(l, flags, t, *pA);
}

/* Pass 2, link i: IA and pA, the contribution of link i + 1, become that of link i. */
RBDI_INLINE void rbdi_aba_pass2_step(const rbd_model *m, rbd_work *w, int i, int flags, const rbd_real *tau,
                                     rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;
    if (off_chain && l->branch >= 0) *IA = rbdi_abi_add(*IA, w->branch[l->branch].I);
    *pA = rbdi_force_add(*pA, w->scratch[i].f);
    if (rbdi_block_link(
            l, flags)) { /* copies: without an address taken IA and pA of other links stay in registers */
        rbdi_abi copy_IA = *IA;
        rbdi_force copy_pA = *pA;
        rbdi_mask copy_doubt = *doubt;
        rbdi_aba_up_block(m, w, i, tau, &copy_IA, &copy_pA, &copy_doubt);
        *IA = copy_IA, *pA = copy_pA, *doubt = copy_doubt;
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

/* Whether a joint has slid so far that dof.scale of the turning joint before it, taken at q = 0, is no
   bound: the slide squared times the mass that slides is above RBDI_FAR times that. */
RBDI_PART rbdi_mask rbdi_slid_far(const rbd_model *m, const rbd_work *w) {
    rbdi_mask slid = rbdi_less(rbdi_zero(), rbdi_zero());
    if (!(RBDI_FEATURES & m->features & (RBDI_SLIDES | RBDI_OTHER_BLOCKS))) return slid;

    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        const int block = rbdi_is(l, RBDI_BLOCK);
        rbd_real square;
        int turn = l->parent;
        if (!block && !(rbdi_flags(l) & RBDI_SLIDES)) continue;
        while (turn >= 0 && !rbdi_turns_first(m, turn)) turn = m->link[turn].parent;
        if (turn < 0) continue;

        square = block ? rbdi_dot(w->block[l->block].X.r, w->block[l->block].X.r) : w->d[i] * w->d[i];
        slid = rbdi_or(
            slid, rbdi_less(rbdi_set(m->dof[m->link[turn].iv].scale * RBDI_FAR), square * l->subtree_mass));
    }
    return slid;
}

/* Pass 2, leaves first. Returns whether a pivot is in doubt. */
RBDI_PART rbdi_mask rbdi_aba_pass2(const rbd_model *m, rbd_work *w, const rbd_real *tau) {
    rbdi_abi IA = rbdi_abi_zero();
    rbdi_force pA = rbdi_force0();
    rbdi_mask doubt = rbdi_slid_far(m, w);
    for (int i = m->nl - 1; i >= 0; --i) {
        RBDI_BY_FLAGS(flags, &m->link[i], rbdi_aba_pass2_step(m, w, i, flags, tau, &IA, &pA, &doubt));
    }
    return doubt;
}

/* Pass 3: X y, for the parent's y = (omega_dot, classical acceleration minus gravity). */
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
RBDI_INLINE rbdi_motion rbdi_aba_carry_block(const rbd_work *w, const rbdi_link *l, rbdi_motion y) {
    const rbdi_pose *X = &w->block[l->block].X;
    y.v = rbdi_mul(X->E, rbdi_add(y.v, rbdi_cross(y.omega, X->r)));
    y.omega = rbdi_mul(X->E, y.omega);
    return y;
}

/* qdd = u/D - (U/D)' y. For a revolute joint without armature U_z/D = 1: x is the link's omega_dot_z. */
RBDI_INLINE rbdi_motion rbdi_aba_down(const rbd_model *m, const rbd_work *w, int i, int flags, rbdi_motion y,
                                      rbd_real *a) {
    const rbdi_link *l = &m->link[i];
    const rbdi_scratch *own = &w->scratch[i];
    rbd_real x, qdd;
    y = rbdi_motion_add(rbdi_aba_carry(m, w, i, flags, y), own->c);
    x = own->u_D - (own->U_D.n.x * y.omega.x + own->U_D.n.y * y.omega.y) - rbdi_dot(own->U_D.f, y.v);
    if (!(flags & (RBDI_SLIDES | RBDI_ARMATURE))) {
        a[l->iv] = x - y.omega.z;
        y.omega.z = x;
        return y;
    }
    qdd = x - own->U_D.n.z * y.omega.z;
    if (flags & RBDI_SLIDES) {
        y.omega.z = y.omega.z + qdd * l->rho;
        y.v.z = y.v.z + qdd * l->kappa;
    } else {
        y.omega.z = y.omega.z + qdd;
    }
    a[l->iv] = qdd;
    return y;
}
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

/* Pass 3, link i: y of link i - 1, or of the parent, becomes link i's. */
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

/* Pass 3. world: its acceleration, minus gravity. */
RBDI_PART void rbdi_aba_pass3(const rbd_model *m, rbd_work *w, rbdi_v3 world, rbd_real *a) {
    rbdi_motion root = rbdi_motion0(), y;
    root.v = world;
    y = root;
    for (int i = 0; i < m->nl; ++i)
        RBDI_BY_FLAGS(flags, &m->link[i], y = rbdi_aba_pass3_step(m, w, i, flags, &root, y, a));
}

#endif
