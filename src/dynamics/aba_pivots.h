#ifndef RBDI_DYNAMICS_ABA_PIVOTS_H
#define RBDI_DYNAMICS_ABA_PIVOTS_H
#include "dynamics/aba_elimination.h"
#include "dynamics/pivots.h"

/* -- by articulated bodies --
   The bound e_k of [pivots], summed from the leaves to the root. K of a link is for IA what e is for a pivot:
   a bound of the terms whose sum it is. K obeys the recursion of IA. With V = U/D, a joint that gives way
   leaves its link P = 1 - S V' of the parent's motion, so that

       Ia = P' IA P + V armature V'        which is IA - U U'/D
       Ka = P' K P + V G V'                with G of [pivots] for the armature
       K_p += X' (Ka + rounding) X         a change of frame rounds each entry by a share of the largest
       e = S' K S + G

   K begins with the inertias of the link's bodies. */

/* S of dof k of link i, and its V = U/D, as pass 2 left it. Pass 2 does not store V_z of a revolute joint
   without armature, which is 1, nor V of a free base but for the axes before S. */
RBDI_COLD void rbdi_pivot_axis(const rbd_model *m, const rbd_work *w, int i, int k, rbd_real S[6],
                               rbd_real V[6]) {
    const rbdi_link *l = &m->link[i];

    for (int j = 0; j < 6; ++j) S[j] = rbdi_zero();

    if (rbdi_is(l, RBDI_BLOCK)) {
        const rbdi_block *b = rbdi_block_of(m, l);
        const int s = b->first + k, end = rbdi_free_base(l, b) ? s : 6;
        S[s] = rbdi_set(RBD_C(1));
        for (int j = 0; j < 6; ++j) V[j] = j < end ? w->block[l->block].U_D[k][j] : S[j];
        return;
    }

    S[2] = rbdi_set(l->rho);
    S[5] = rbdi_set(l->kappa);
    rbdi_store_force(V, 1, w->scratch[i].U_D);
    if (!rbdi_keeps_row_z(rbdi_flags(l))) V[2] = rbdi_set(RBD_C(1));
}

/* K becomes P' K P + V G V', P = 1 - S V'. Returns s = S' K S. Multiplied out:

       P' K P + V G V' = K - V (K S)' - (K S) V' + (s + G) V V' */
RBDI_COLD rbd_real rbdi_give_way(rbd_real K[6][6], const rbd_real S[6], const rbd_real V[6], rbd_real G) {
    rbd_real KS[6], s = rbdi_zero();

    /* K S and S' K S */
    for (int i = 0; i < 6; ++i) {
        KS[i] = rbdi_zero();
        for (int j = 0; j < 6; ++j) KS[i] = KS[i] + K[i][j] * S[j];
        s = s + S[i] * KS[i];
    }

    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) K[i][j] = K[i][j] + ((s + G) * V[i] - KS[i]) * V[j] - V[i] * KS[j];
    return s;
}

/* K becomes X' (K + rounding) X. The rounding of a change of frame is a share of the largest moment, and of
   the largest mass. X' takes a wrench to the parent's frame: first each column of K, then each row. */
RBDI_COLD void rbdi_carry_up(const rbd_model *m, const rbd_work *w, int i, rbd_real K[6][6]) {
    const rbdi_link *l = &m->link[i];

    for (int first = 0; first < 6; first += 3) {
        rbd_real most = rbdi_zero();
        for (int j = first; j < first + 3; ++j) most = rbdi_select(rbdi_less(most, K[j][j]), K[j][j], most);
        for (int j = first; j < first + 3; ++j) K[j][j] = K[j][j] + most * RBDI_TURN;
    }

    for (int j = 0; j < 12; ++j) {
        rbd_real *wrench = j < 6 ? &K[0][j] : K[j - 6];
        const int stride = j < 6 ? 6 : 1;
        rbdi_force F = rbdi_load_force(wrench, stride);

        if (rbdi_is(l, RBDI_BLOCK))
            F = rbdi_force_up_block(&w->block[l->block].X, F);
        else
            F = rbdi_force_up(l, rbdi_flags(l), rbdi_trig_of(m, w, i, rbdi_flags(l)), F);
        rbdi_store_force(wrench, stride, F);
    }
}

/* Checks the pivots of link i. K, the sum over its children, becomes its contribution to the parent's K. */
RBDI_COLD void rbdi_check_link(const rbd_model *m, rbd_work *w, int i, rbdi_mask doubt, rbd_real K[6][6]) {
    const rbdi_link *l = &m->link[i];
    rbd_real inertia[6], S[6], V[6];

    /* the inertias of the link's bodies */
    for (int b = 0; b < m->nb; ++b) {
        if (m->frame[b].link != i) continue;
        rbdi_body_inertia(m, b, inertia);
        for (int j = 0; j < 6; ++j) K[j][j] = K[j][j] + inertia[j];
    }

    /* each dof: e = S' K S + G, its verdict, K = P' K P + V G V' */
    for (int k = rbdi_link_dofs(m, l) - 1; k >= 0; --k) {
        const rbdi_dof *dof = &m->dof[l->iv + k];
        const rbd_real G = rbdi_abs(w->pivot[l->iv + k]) + dof->scale * RBDI_SHARE + dof->armature;
        rbd_real e;

        rbdi_pivot_axis(m, w, i, k, S, V);
        e = rbdi_give_way(K, S, V, G) + G;
        rbdi_check_pivot(w, l->iv + k, e, doubt);
    }

    if (l->parent >= 0) rbdi_carry_up(m, w, i, K);
}

/* Checks the pivots of the last pass 2, leaves first. The sums of branch points' K stand where those of IA
   did. */
RBDI_COLD void rbdi_check_bodies(const rbd_model *m, rbd_work *w, rbdi_mask doubt) {
    rbd_real K[6][6];

    for (int k = 0; k < m->nbranch; ++k) w->branch[k].I = rbdi_abi_zero();
    rbdi_clear(K[0], 36);

    for (int i = m->nl - 1; i >= 0; --i) {
        const rbdi_link *l = &m->link[i];

        if (l->branch >= 0) {
            rbd_real others[6][6]; /* the lower triangle of the other children's sum */

            rbdi_abi_to_array(w->branch[l->branch].I, others);
            for (int r = 0; r < 6; ++r)
                for (int s = 0; s < 6; ++s) K[r][s] = K[r][s] + others[r > s ? r : s][r > s ? s : r];
        }

        rbdi_check_link(m, w, i, doubt, K);
        if (l->parent == i - 1) continue;

        if (l->parent >= 0) {
            rbdi_branch *branch = &w->branch[m->link[l->parent].branch];
            branch->I = rbdi_abi_add(branch->I, rbdi_abi_from_array(K));
        }

        rbdi_clear(K[0], 36);
    }
}

#endif
