#ifndef RBDI_DYNAMICS_ABA_ELIMINATION_H
#define RBDI_DYNAMICS_ABA_ELIMINATION_H
#include "model/joints.h"

/* Interface: rbdi_free_base */

/* ---- aba [aba] ----
   RBDA table 7.1, its c, pA and a classical ([design]):

       pass 1   omega_i, c_i,  pA_i = wrench with omega_dot = acc = 0   rbdi_aba_velocity, rbdi_wrench
                pA_i -= X* f_ext                                    rbdi_external
       pass 2   U = IA S,  D = S' U,  u = tau - S' pA               rbdi_aba_eliminate
                Ia = IA - U U'/D,  pa = pA + Ia c + U u/D           rbdi_aba_subtract, rbdi_aba_add_bias
                IA_p += X' Ia X,  pA_p += X' pa                     rbdi_abi_up, rbdi_force_up
       pass 3   y = X y_p + c,  qdd = (u - U' y)/D,  y += S qdd     rbdi_aba_carry, rbdi_aba_down

   IA = [I H; H' M]. A revolute joint without armature leaves S' Ia = U' - (D/D) U' = 0: row z of I and H is
   zero and stays zero through the shift along z and the turn about it: rbdi_aba_row_z and rbdi_abi_shift_z
   rely on that. Also S' pa = S' pA + S' Ia c + (S' U/D) u = S' pA + u = tau: the moment on the parent about
   the joint's axis is the torque.

   This room has what pass 2 does with one link, aba.h the three passes. */

/* Whether row z of I and H is not zero after the joint of a one-axis link is eliminated. */
RBDI_INLINE int rbdi_keeps_row_z(int flags) { return flags & (RBDI_SLIDES | RBDI_ARMATURE); }

/* Articulated-body inertia of a one-axis link, to the parent's axes and origin: X' IA X, as the slide d, the
   turns by q, alpha and beta, and the shift r. */
RBDI_INLINE rbdi_abi rbdi_abi_up(const rbdi_link *l, int flags, rbdi_trig t, rbdi_abi IA) {
    if (flags & RBDI_SHIFT_Z) IA = rbdi_abi_shift_z(t.d, rbdi_keeps_row_z(flags), IA);
    IA = rbdi_abi_up_z(0, t.c, t.s, IA);
    IA = rbdi_abi_up_z(flags, rbdi_set(l->ca), rbdi_set(l->sa), rbdi_abi_cycle(IA));
    if (!(flags & RBDI_SHIFT_R)) return rbdi_abi_uncycle(IA);
    if (!(flags & RBDI_SHIFT_XYZ)) return rbdi_abi_uncycle(rbdi_abi_shift_z(rbdi_set(l->r.x), 1, IA));

    IA = rbdi_abi_uncycle(IA);
    if (flags & RBDI_BRANCH_TURN) IA = rbdi_abi_up_z(0, rbdi_set(l->cb), rbdi_set(l->sb), IA);
    return rbdi_abi_shift(rbdi_vec_c(l->r), IA);
}

/* The same of a block. */
RBDI_INLINE rbdi_abi rbdi_abi_up_block(const rbdi_pose *X, rbdi_abi IA) {
    IA.I = rbdi_sym_up(X->E, IA.I);
    IA.H = rbdi_mat_up(X->E, IA.H);
    IA.M = rbdi_sym_up(X->E, IA.M);
    return rbdi_abi_shift(X->r, IA);
}

/* IA plus the link's own inertia [tr(Sigma) - Sigma, [h]x; -[h]x, m]. */
RBDI_INLINE rbdi_abi rbdi_abi_add_link(const rbdi_link *l, int flags, rbdi_abi IA) {
    const rbdi_csym Sigma = l->Sigma;
    const rbdi_c3 h = l->h;

    IA.I.xx = IA.I.xx + (Sigma.yy + Sigma.zz);
    IA.I.xy = IA.I.xy - Sigma.xy;
    IA.I.xz = IA.I.xz - Sigma.xz;
    IA.I.yy = IA.I.yy + (Sigma.xx + Sigma.zz);
    IA.I.yz = IA.I.yz - Sigma.yz;
    IA.I.zz = IA.I.zz + (Sigma.xx + Sigma.yy);

    IA.H.xz = IA.H.xz + h.y;
    IA.H.zx = IA.H.zx - h.y;
    IA.H.yz = IA.H.yz - h.x;
    IA.H.zy = IA.H.zy + h.x;
    if (!(flags & RBDI_MASS_KEPT)) return IA;

    IA.H.xy = IA.H.xy - h.z;
    IA.H.yx = IA.H.yx + h.z;
    IA.M.xx = IA.M.xx + l->mass;
    IA.M.yy = IA.M.yy + l->mass;
    IA.M.zz = IA.M.zz + l->mass;
    return IA;
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

/* IA becomes Ia = IA - U U'/D, without row z of I and H. U_D = U/D. */
RBDI_INLINE void rbdi_aba_subtract(rbdi_force U, rbdi_force U_D, rbdi_abi *IA) {
    IA->I.xx = IA->I.xx - U.n.x * U_D.n.x;
    IA->I.xy = IA->I.xy - U.n.x * U_D.n.y;
    IA->I.yy = IA->I.yy - U.n.y * U_D.n.y;

    IA->H.xx = IA->H.xx - U.n.x * U_D.f.x;
    IA->H.xy = IA->H.xy - U.n.x * U_D.f.y;
    IA->H.xz = IA->H.xz - U.n.x * U_D.f.z;
    IA->H.yx = IA->H.yx - U.n.y * U_D.f.x;
    IA->H.yy = IA->H.yy - U.n.y * U_D.f.y;
    IA->H.yz = IA->H.yz - U.n.y * U_D.f.z;

    IA->M.xx = IA->M.xx - U.f.x * U_D.f.x;
    IA->M.xy = IA->M.xy - U.f.x * U_D.f.y;
    IA->M.xz = IA->M.xz - U.f.x * U_D.f.z;
    IA->M.yy = IA->M.yy - U.f.y * U_D.f.y;
    IA->M.yz = IA->M.yz - U.f.y * U_D.f.z;
    IA->M.zz = IA->M.zz - U.f.z * U_D.f.z;
}

/* pA becomes pa = pA + Ia c + U u/D, without the moment about z:

       n += I c_omega + H c_v + U_n u/D,   f += H' c_omega + M c_v + U_f u/D

   u_D = u/D. c.omega.z is always 0. */
RBDI_INLINE void rbdi_aba_add_bias(const rbdi_abi *Ia, const rbdi_motion *c, rbdi_force U, rbd_real u_D,
                                   rbdi_force *pA) {
    pA->n.x = pA->n.x + (Ia->I.xx * c->omega.x + Ia->I.xy * c->omega.y) + U.n.x * u_D;
    pA->n.y = pA->n.y + (Ia->I.xy * c->omega.x + Ia->I.yy * c->omega.y) + U.n.y * u_D;
    pA->n.x = pA->n.x + (Ia->H.xx * c->v.x + Ia->H.xy * c->v.y + Ia->H.xz * c->v.z);
    pA->n.y = pA->n.y + (Ia->H.yx * c->v.x + Ia->H.yy * c->v.y + Ia->H.yz * c->v.z);

    pA->f.x = pA->f.x + (Ia->H.xx * c->omega.x + Ia->H.yx * c->omega.y) + U.f.x * u_D;
    pA->f.y = pA->f.y + (Ia->H.xy * c->omega.x + Ia->H.yy * c->omega.y) + U.f.y * u_D;
    pA->f.z = pA->f.z + (Ia->H.xz * c->omega.x + Ia->H.yz * c->omega.y) + U.f.z * u_D;
    pA->f = rbdi_add(pA->f, rbdi_mul_sym(Ia->M, c->v));
}

/* The rest of the two, for a joint that keeps row z: row z of I and H in Ia, and the moment of pa about z. */
RBDI_INLINE void rbdi_aba_row_z(const rbdi_motion *c, rbdi_force U, rbdi_force U_D, rbd_real u_D,
                                rbdi_abi *IA, rbdi_force *pA) {
    IA->I.xz = IA->I.xz - U.n.x * U_D.n.z;
    IA->I.yz = IA->I.yz - U.n.y * U_D.n.z;
    IA->I.zz = IA->I.zz - U.n.z * U_D.n.z;
    IA->H.zx = IA->H.zx - U.n.z * U_D.f.x;
    IA->H.zy = IA->H.zy - U.n.z * U_D.f.y;
    IA->H.zz = IA->H.zz - U.n.z * U_D.f.z;

    pA->n.z = pA->n.z + (IA->I.xz * c->omega.x + IA->I.yz * c->omega.y) + U.n.z * u_D;
    pA->n.z = pA->n.z + (IA->H.zx * c->v.x + IA->H.zy * c->v.y + IA->H.zz * c->v.z);
}

/* Pass 2, one-axis link: eliminates the joint's force. IA becomes Ia, pA becomes pa. */
RBDI_INLINE void rbdi_aba_eliminate(const rbd_model *m, rbd_work *w, int i, int flags, rbd_real tau,
                                    rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const int row_z = rbdi_keeps_row_z(flags);
    const rbdi_link *l = &m->link[i];
    const rbdi_dof *dof = &m->dof[l->iv];
    rbdi_scratch *scratch = &w->scratch[i];
    rbdi_force U, U_D;
    rbd_real D, inverse, u_D;

    /* U = IA S,  D = S' U + armature,  u = tau - S' pA */
    U = rbdi_abi_axis(l, flags, IA);
    D = rbdi_along_axis(l, flags, U);
    if (row_z) D = D + dof->armature;
    w->pivot[l->iv] = D;

    /* U/D and u/D */
    inverse = rbdi_pivot_inverse(D, dof->scale, doubt);
    u_D = (tau - rbdi_along_axis(l, flags, *pA)) * inverse;
    U_D.n.x = inverse * U.n.x;
    U_D.n.y = inverse * U.n.y;
    U_D.f = rbdi_scale(inverse, U.f);

    /* kept for pass 3 */
    scratch->U_D.n.x = U_D.n.x;
    scratch->U_D.n.y = U_D.n.y;
    scratch->U_D.f = U_D.f;
    scratch->u_D = u_D;

    /* Ia = IA - U U'/D,  pa = pA + Ia c + U u/D */
    rbdi_aba_subtract(U, U_D, IA);
    rbdi_aba_add_bias(IA, &scratch->c, U, u_D, pA);
    if (row_z) {
        U_D.n.z = inverse * U.n.z;
        scratch->U_D.n.z = U_D.n.z;
        rbdi_aba_row_z(&scratch->c, U, U_D, u_D, IA, pA);
        return;
    }

    /* row z of I and H is 0, the moment about z is tau: see [aba] */
    IA->I.xz = IA->I.yz = IA->I.zz = rbdi_zero();
    IA->H.zx = IA->H.zy = IA->H.zz = rbdi_zero();
    pA->n.z = tau;
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

/* A floating base on the world, without armature. */
RBDI_INLINE int rbdi_free_base(const rbdi_link *l, const rbdi_block *b) {
    return rbdi_on_world(l) && b->n == 6 && !(rbdi_flags(l) & RBDI_ARMATURE);
}

/* Pass 2, block link: eliminates its axes s one by one, the last first, so that the pivots are those of M =
   L'DL. A and P are IA and pA as arrays, of A only the lower triangle. U/D is kept for all six axes; a free
   base, which has no parent, needs it for the axes before s only. */
RBDI_PART void rbdi_aba_up_block(const rbd_model *m, rbd_work *w, int link, const rbd_real *tau, rbdi_abi *IA,
                                 rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[link];
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_motion c = w->scratch[link].c;
    rbdi_block_work *bw = &w->block[l->block];
    rbd_real A[6][6], P[6];
    rbdi_abi Ia;
    rbdi_force pa;

    rbdi_abi_to_array(rbdi_abi_add_link(l, RBDI_MASS_KEPT, *IA), A);
    rbdi_store_force(P, 1, *pA);

    /* each axis s: A -= U U'/D,  P += U u/D */
    for (int k = b->n - 1; k >= 0; --k) {
        const rbdi_dof *dof = &m->dof[l->iv + k];
        const int s = b->first + k, end = rbdi_free_base(l, b) ? s : 6;
        rbd_real *U_D = bw->U_D[k], D = A[s][s] + dof->armature;
        const rbd_real inverse = rbdi_pivot_inverse(D, dof->scale, doubt);

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

    /* pa = P + Ia c,  then Ia and pa to the parent */
    Ia = rbdi_abi_from_array(A);
    pa = rbdi_load_force(P, 1);
    pa.n = rbdi_add(pa.n, rbdi_add(rbdi_mul_sym(Ia.I, c.omega), rbdi_mul(Ia.H, c.v)));
    pa.f = rbdi_add(pa.f, rbdi_add(rbdi_mul_t(Ia.H, c.omega), rbdi_mul_sym(Ia.M, c.v)));
    *IA = rbdi_abi_up_block(&bw->X, Ia);
    *pA = rbdi_force_up_block(&bw->X, pa);
}

#endif
