#ifndef RBDI_DYNAMICS_HYBRID_H
#define RBDI_DYNAMICS_HYBRID_H
#include "dynamics/aba.h"

/* ---- hybrid dynamics [hybrid] ----
   RBDA section 9.2. Where a joint's acceleration is given it is held: it transmits all. Like [aba], but for
   such joints in pass 2 Ia = IA, pa = pA + IA (c + S qdd), and in pass 3 y = X y_p + c + S qdd, tau = S' (IA
   y + pA) = U' y + S' pA, of which U and S' pA wait in U_D and u_D. The pivots are those of M without the
   rows and columns of what is held.

   Where that is all but joints on the world, what hangs on these is a rigid body as to their motion, and
   section 9.3's way is shorter: [rnea] with their accelerations 0, which leaves M_bb y = tau_b - tau0_b, and
   tau = tau0 + S' C X y of the others, C the composite bodies. */

typedef struct rbdi_given {
    const unsigned char *dof; /* nv flags: held */
    const rbd_real *a;
} rbdi_given;

/* Whether any dof of a link is held. */
RBDI_INLINE int rbdi_any_held(const rbd_model *m, const rbdi_link *l, const rbdi_given *given) {
    int held = 0;
    for (int k = 0; k < rbdi_link_dofs(m, l); ++k) held |= given->dof[l->iv + k];
    return held;
}

/* Pass 2, one-axis link that is held: U and S' pA for pass 3; c becomes c + S qdd. */
RBDI_INLINE rbdi_motion rbdi_hold(const rbd_model *m, rbd_work *w, int i, int form, rbd_real a, rbdi_force U,
                                  rbdi_force pA) {
    const rbdi_link *l = &m->link[i];
    rbdi_scratch *own = &w->scratch[i];
    const int slides = form & RBDI_SLIDES;
    own->U_D = U;
    own->u_D = rbdi_along_axis(l, form, pA);
    if (form & RBDI_ARMATURE) own->u_D = own->u_D + a * m->dof[l->iv].armature;
    own->c.omega.z = own->c.omega.z + (slides ? a * l->rho : a);
    if (slides) own->c.v.z = own->c.v.z + a * l->kappa;
    return own->c;
}

/* Pass 2, one-axis link: as rbdi_aba_up. What is held leaves no row of zeros: all of IA is moved. */
RBDI_INLINE void rbdi_hybrid_up(const rbd_model *m, rbd_work *w, int i, int form, const rbdi_given *given,
                                const rbd_real *tau, rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const rbdi_trig t = rbdi_trig_of(m, w, i, form);
    *IA = rbdi_abi_add_link(l, form, *IA);
    if (given->dof[l->iv]) {
        const rbdi_motion c = rbdi_hold(m, w, i, form, given->a[l->iv], rbdi_abi_axis(l, form, IA), *pA);
        *pA = rbdi_force_add(*pA, rbdi_abi_times(IA, c));
    } else {
        rbdi_aba_release(m, w, i, form, tau[l->iv], IA, pA, doubt);
    }
    if (form & RBDI_ROOT) return;
    *IA = rbdi_abi_up(l, form | RBDI_ARMATURE, t, *IA);
    *pA = rbdi_force_up(l, form, t, *pA);
}

/* Pass 2, block link; any of its axes may be held. */
RBDI_PART void rbdi_hybrid_up_block(const rbd_model *m, rbd_work *w, int i, const rbdi_given *given,
                                    const rbd_real *tau, rbdi_abi *IA, rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block *b = rbdi_block_of(m, l);
    rbdi_block_work *bw = &w->block[l->block];
    rbd_real A[6][6], P[6];
    rbdi_abi_to_array(rbdi_abi_add_link(l, RBDI_MASS_KEPT, *IA), A);
    rbdi_store_force(P, 1, *pA);
    for (int k = b->n - 1; k >= 0; --k) {
        const int s = b->first + k;
        const rbd_real a = given->a[l->iv + k];
        if (!given->dof[l->iv + k]) {
            rbdi_aba_release_axis(m, w, l, bw, b->first, k, 1, tau, A, P, doubt);
            continue;
        }
        bw->u_D[k] = P[s] + a * m->dof[l->iv + k].armature;
        for (int j = 0; j < 6; ++j) {
            bw->U_D[k][j] = A[s][j];
            P[j] = P[j] + A[s][j] * a;
        }
    }
    if (l->parent < 0) return;
    *IA = rbdi_abi_from_array(A);
    *pA = rbdi_force_add(rbdi_load_force(P, 1), rbdi_abi_times(IA, w->scratch[i].c));
    *pA = rbdi_force_up_block(&bw->X, *pA);
    *IA = rbdi_abi_up_block(&bw->X, *IA);
}

RBDI_PART rbdi_mask rbdi_hybrid_pass2(const rbd_model *m, rbd_work *w, const rbdi_given *given,
                                      const rbd_real *tau) {
    rbdi_abi IA = rbdi_abi_zero();
    rbdi_force pA = rbdi_force0();
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int i = m->nl - 1; i >= 0; --i) {
        const rbdi_link *l = &m->link[i];
        if (l->slot >= 0) IA = rbdi_abi_add(IA, w->slot[l->slot].I);
        pA = rbdi_force_add(pA, w->scratch[i].f);
        if (l->kind == RBDI_BLOCK)
            rbdi_hybrid_up_block(m, w, i, given, tau, &IA, &pA, &doubt);
        else
            RBDI_BY_FORM(form, l, rbdi_hybrid_up(m, w, i, form, given, tau, &IA, &pA, &doubt));
        rbdi_aba_hand_on(m, w, i, &IA, &pA);
    }
    return doubt;
}

/* Pass 3: as rbdi_aba_down. */
RBDI_INLINE rbdi_motion rbdi_hybrid_down(const rbd_model *m, const rbd_work *w, int i, int form,
                                         const rbdi_given *given, rbdi_motion y, rbd_real *a, rbd_real *tau) {
    const int iv = m->link[i].iv;
    const rbdi_force U = w->scratch[i].U_D;
    if (!given->dof[iv]) return rbdi_aba_down(m, w, i, form, y, a);
    y = rbdi_motion_add(rbdi_aba_carry(m, w, i, form, y), w->scratch[i].c);
    tau[iv] = w->scratch[i].u_D + rbdi_dot(U.n, y.omega) + rbdi_dot(U.f, y.v);
    return y;
}
RBDI_PART rbdi_motion rbdi_hybrid_down_block(const rbd_model *m, const rbd_work *w, int i,
                                             const rbdi_given *given, rbdi_motion y, rbd_real *a,
                                             rbd_real *tau) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block_work *bw = &w->block[l->block];
    const rbdi_block *b = rbdi_block_of(m, l);
    rbd_real all[6];
    rbdi_motion_to_array(rbdi_motion_add(rbdi_aba_carry_block(w, l, y), w->scratch[i].c), all);
    for (int k = 0; k < b->n; ++k) {
        const int held = given->dof[l->iv + k];
        rbd_real *y_s = &all[b->first + k], f = rbdi_zero();
        if (held) *y_s = *y_s + a[l->iv + k];
        RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
            f = f + bw->U_D[k][j] * all[j];
        if (held) {
            tau[l->iv + k] = bw->u_D[k] + f;
        } else {
            a[l->iv + k] = bw->u_D[k] - f;
            *y_s = *y_s + a[l->iv + k];
        }
    }
    return rbdi_motion_from_array(all);
}

RBDI_PART void rbdi_hybrid_pass3(const rbd_model *m, rbd_work *w, const rbdi_given *given, rbd_real *a,
                                 rbd_real *tau) {
    rbdi_motion world = rbdi_motion0(), y;
    world.v = rbdi_world_state(w->gravity).acc;
    y = world;
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        if (l->parent < 0)
            y = world;
        else if (l->parent != i - 1)
            y = w->slot[m->link[l->parent].slot].y;
        if (l->kind == RBDI_BLOCK)
            y = rbdi_hybrid_down_block(m, w, i, given, y, a, tau);
        else
            RBDI_BY_FORM(form, l, y = rbdi_hybrid_down(m, w, i, form, given, y, a, tau));
        if (l->slot >= 0) w->slot[l->slot].y = y;
    }
}

/* All but joints on the world held: what the composite body C of a root gives way to tau - tau0, as a motion
   y beyond that of rnea, kept in its scratch c. */
RBDI_INLINE rbdi_motion rbdi_rigid_root(const rbd_model *m, rbd_work *w, int i, rbdi_rbi C,
                                        const rbd_real *tau0, const rbd_real *tau, rbd_real *a,
                                        rbdi_mask *doubt) {
    const rbdi_link *l = &m->link[i];
    const rbdi_dof *dof = &m->dof[l->iv];
    const rbdi_force U = rbdi_rbi_axis(l, l->flags & RBDI_SLIDES, C);
    const rbd_real D = rbdi_along_axis(l, l->flags, U) + dof->armature,
                   inverse = rbdi_pivot_inverse(D, dof->scale, doubt);
    rbdi_motion y = rbdi_motion0();
    w->pivot[l->iv] = D;
    w->scratch[i].U_D.n = rbdi_scale(inverse, U.n);
    w->scratch[i].U_D.f = rbdi_scale(inverse, U.f);
    a[l->iv] = (tau[l->iv] - tau0[l->iv]) * inverse;
    y.omega.z = a[l->iv] * l->rho;
    y.v.z = a[l->iv] * l->kappa;
    return y;
}
RBDI_PART rbdi_motion rbdi_rigid_root_block(const rbd_model *m, rbd_work *w, const rbdi_link *l,
                                            const rbdi_given *given, rbdi_rbi C, const rbd_real *tau0,
                                            rbd_real *a, rbd_real *tau, rbdi_mask *doubt) {
    const rbdi_block *b = rbdi_block_of(m, l);
    const unsigned char *held = &given->dof[l->iv];
    rbdi_block_work *bw = &w->block[l->block];
    rbd_real A[6][6], P[6], y[6];
    rbdi_abi_to_array(rbdi_abi_of_rbi(C, l->subtree_mass), A);
    RBDI_UNROLL_SIX for (int k = 0; k < 6; ++k)
        P[k] = y[k] = rbdi_zero();
    for (int k = 0; k < b->n; ++k) P[b->first + k] = tau0[l->iv + k];
    if (!rbdi_any_held(m, l, given) && rbdi_free_base(l, b)) {
        rbdi_aba_release_block(m, w, l, 0, 6, 0, tau, A, P, doubt);
    } else {
        for (int k = 0; k < b->n; ++k)
            for (int j = 0; j < 6; ++j) bw->U_D[k][j] = A[b->first + k][j];
        for (int k = b->n - 1; k >= 0; --k)
            if (!held[k]) rbdi_aba_release_axis(m, w, l, bw, b->first, k, 1, tau, A, P, doubt);
    }
    for (int k = 0; k < b->n; ++k) {
        rbd_real *y_s = &y[b->first + k];
        if (held[k]) continue;
        *y_s = bw->u_D[k];
        for (int j = 0; j < b->first + k; ++j) *y_s = *y_s - bw->U_D[k][j] * y[j];
        a[l->iv + k] = *y_s;
    }
    for (int k = 0; k < b->n; ++k) {
        if (!held[k]) continue;
        tau[l->iv + k] = tau0[l->iv + k];
        for (int j = 0; j < 6; ++j) tau[l->iv + k] = tau[l->iv + k] + bw->U_D[k][j] * y[j];
    }
    return rbdi_motion_from_array(y);
}

/* Composite bodies, and of held joints U = C S, leaves to root; a root's motion as soon as its C is known. */
RBDI_INLINE rbdi_rbi rbdi_rigid_up(const rbd_model *m, rbd_work *w, int i, int form, rbdi_rbi C) {
    const rbdi_link *l = &m->link[i];
    w->scratch[i].U_D = rbdi_rbi_axis(l, form & RBDI_SLIDES, C);
    return rbdi_rbi_up(l, form, rbdi_trig_of(m, w, i, form), C);
}
RBDI_PART rbdi_rbi rbdi_rigid_up_block(const rbd_model *m, rbd_work *w, const rbdi_link *l, rbdi_rbi C) {
    const rbdi_block *b = rbdi_block_of(m, l);
    for (int k = 0; k < b->n; ++k)
        rbdi_store_force(w->block[l->block].U_D[k], 1, rbdi_rbi_column(C, l->subtree_mass, b->first + k));
    return rbdi_rbi_up_block(&w->block[l->block].X, l->subtree_mass, C);
}
RBDI_PART rbdi_mask rbdi_rigid_up_all(const rbd_model *m, rbd_work *w, const rbdi_given *given,
                                      const rbd_real *tau0, rbd_real *a, rbd_real *tau) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_rbi C = rbdi_rbi_zero();
    for (int i = 0; i < m->nslot; ++i) w->slot[i].C = C;
    for (int i = m->nl - 1; i >= 0; --i) {
        const rbdi_link *l = &m->link[i];
        C = rbdi_rbi_add_link(l, C);
        if (l->slot >= 0) C = rbdi_rbi_add(C, w->slot[l->slot].C);
        if (l->parent < 0) {
            w->scratch[i].c = rbdi_motion0();
            if (l->kind == RBDI_BLOCK)
                w->scratch[i].c = rbdi_rigid_root_block(m, w, l, given, C, tau0, a, tau, &doubt);
            else if (!given->dof[l->iv])
                w->scratch[i].c = rbdi_rigid_root(m, w, i, C, tau0, tau, a, &doubt);
            else
                tau[l->iv] = tau0[l->iv];
        } else if (l->kind == RBDI_BLOCK) {
            C = rbdi_rigid_up_block(m, w, l, C);
        } else {
            RBDI_BY_FORM(form, l, C = rbdi_rigid_up(m, w, i, form, C));
        }
        if (l->parent >= 0 && l->parent == i - 1) continue;
        if (l->parent >= 0)
            w->slot[m->link[l->parent].slot].C = rbdi_rbi_add(w->slot[m->link[l->parent].slot].C, C);
        C = rbdi_rbi_zero();
    }
    return doubt;
}

/* What y costs the held joints behind the roots: tau = tau0 + U' y. */
RBDI_INLINE rbdi_motion rbdi_rigid_down(const rbd_model *m, const rbd_work *w, int i, int form, rbdi_motion y,
                                        const rbd_real *tau0, rbd_real *tau) {
    const int iv = m->link[i].iv;
    const rbdi_force U = w->scratch[i].U_D;
    y = rbdi_aba_carry(m, w, i, form, y);
    tau[iv] = tau0[iv] + rbdi_dot(U.n, y.omega) + rbdi_dot(U.f, y.v);
    return y;
}
RBDI_PART void rbdi_rigid_down_all(const rbd_model *m, rbd_work *w, const rbd_real *tau0, rbd_real *tau) {
    rbdi_motion y = rbdi_motion0();
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        if (l->parent >= 0 && l->parent != i - 1) y = w->slot[m->link[l->parent].slot].y;
        if (l->parent < 0) {
            y = w->scratch[i].c;
        } else if (l->kind == RBDI_BLOCK) {
            y = rbdi_aba_carry_block(w, l, y);
            for (int k = 0; k < rbdi_block_of(m, l)->n; ++k) {
                const rbdi_force U = rbdi_load_force(w->block[l->block].U_D[k], 1);
                tau[l->iv + k] = tau0[l->iv + k] + rbdi_dot(U.n, y.omega) + rbdi_dot(U.f, y.v);
            }
        } else {
            RBDI_BY_FORM(form, l, y = rbdi_rigid_down(m, w, i, form, y, tau0, tau));
        }
        if (l->slot >= 0) w->slot[l->slot].y = y;
    }
}

#endif
