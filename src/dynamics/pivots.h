#ifndef RBDI_DYNAMICS_PIVOTS_H
#define RBDI_DYNAMICS_PIVOTS_H
#include "dynamics/crba.h"

/* Interface: rbdi_check_factor, rbdi_factor_status, rbdi_pivot_status */

/* ---- pivots [pivots] ----
   M = L'DL is singular if one of its pivots D is rounding. Each call checks the pivots that it computes, in
   two steps.

   First, in every call: is D > RBDI_DOUBT dof.scale, and > RBDI_DOUBT M_kk where M is there? If all pivots
   pass, M is regular: a rounding error reaches that size only if it is magnified by more than RBDI_DOUBT /
   eps, and then an earlier pivot was small beside its own scale; RBDI_DOUBT is at least sqrt(eps), so that
   one of the two fails. dof.scale is taken at q = 0. A joint that has slid too far from there is a doubt as
   well (rbdi_slid_far).

   Then, if a pivot is in doubt: is D > RBDI_NOISE e + RBDI_TINY, for all pivots? eps e bounds the error of
   D. Let y be column k of L^-1: the motion in which dof k moves by 1 and the dofs behind it give way. Then
   D_k = y' M y, and

       e_k = sum over j of y_j^2 K_jj + armature

   By the factor, K_jj are the terms of M_jj: M_jj, the inertia of each link about its own origin along the
   dof, and a quarter of dof.scale, the inertia of the stretched robot. Articulated bodies have smaller
   terms: each link's inertia along its motion in y and, for dof j, G_j = D_j + RBDI_SHARE dof.scale +
   armature. So rbd_aba is right in long chains whose M has lost its digits.

   Both have a part of dof.scale, because descriptions round too. An axis is off by eps, a position or a
   centre of mass by eps of its lever L. These errors move a mass m that should stand still by eps L. So D
   has a part m (eps L)^2. It is computed exactly, and all of it is error. dof.scale has RBDI_ROD m L^2 in it
   (rbdi_build_scale). */

/* Replaces pivot k by its verdict: 1 if it is above its noise or no pivot of the state is in doubt, 0 if not,
   -1 if it is not a number. e: the bound of its terms. */
RBDI_PART void rbdi_check_pivot(rbd_work *w, int k, rbd_real e, rbdi_mask doubt) {
    const rbd_real noise = e * RBDI_NOISE + RBDI_TINY;
    const rbd_real D = w->pivot[k], one = rbdi_set(RBD_C(1));
    const rbdi_mask number = rbdi_or(rbdi_less(D, one), rbdi_less(rbdi_zero(), D));
    const rbd_real bad = rbdi_select(number, rbdi_zero(), -one);
    w->pivot[k] = rbdi_select(rbdi_or(rbdi_not(doubt), rbdi_less(noise, D)), one, bad);
}

/* The status by the verdicts in w->pivot. w->singular becomes the first bad pivot in the order of
   elimination. The n results x become 0 in the lanes that have a bad pivot. */
RBDI_PART rbd_status rbdi_pivot_status(const rbd_model *m, rbd_work *w, rbd_real *x, int n) {
    const rbd_real half = rbdi_set(RBD_C(0.5)), o = rbdi_zero();
    rbdi_mask good = rbdi_less(o, half), number = good;

    w->singular = -1;
    for (int k = m->nv - 1; k >= 0; --k) {
        const rbdi_mask ok = rbdi_less(half, w->pivot[k]);
        good = rbdi_and(good, ok);
        if (w->singular >= 0 || !rbdi_any(rbdi_not(ok))) continue;
        w->singular = k;
        number = rbdi_less(-half, w->pivot[k]);
    }

    for (int k = 0; k < n; ++k) x[k] = rbdi_select(good, x[k], o);
    if (w->singular < 0) return RBD_OK;

    return rbdi_any(rbdi_not(number)) ? RBD_ERR_NAN : RBD_ERR_SINGULAR;
}

/* The inertia of body b about the origin of its link, along each of the link's axes: moments, then masses.
   The rounding of the build is added, because it may tilt a rod that lies on an axis. It is relative to the
   trace of the inertia, about the link's origin and about that of the user's frame, r of the joint's body. */
RBDI_COLD void rbdi_body_inertia(const rbd_model *m, int b, rbd_real inertia[6]) {
    const rbdi_frame *u = &m->frame[b];
    const rbdi_mat E = rbdi_mat_c(u->E);
    const rbdi_v3 user = rbdi_vec_c(m->frame[m->dof[m->link[u->link].iv].body].r);
    const rbdi_v3 r = rbdi_vec_c(u->r), com = rbdi_mul_t(E, rbdi_vec_c(u->com)), p = rbdi_add(r, com);
    const rbd_real mass = rbdi_set(u->mass);
    const rbd_real levers = rbdi_dot(r, r) + rbdi_dot(com, com) + rbdi_dot(user, user);

    const rbdi_sym S = rbdi_sym_up(E, rbdi_sym_c(u->I));
    const rbd_real xx = rbdi_abs(S.xx), yy = rbdi_abs(S.yy), zz = rbdi_abs(S.zz);
    const rbd_real rounding = (xx + yy + zz + mass * levers) * RBDI_BUILD;

    inertia[0] = xx + mass * (p.y * p.y + p.z * p.z) + rounding;
    inertia[1] = yy + mass * (p.x * p.x + p.z * p.z) + rounding;
    inertia[2] = zz + mass * (p.x * p.x + p.y * p.y) + rounding;
    inertia[3] = inertia[4] = inertia[5] = mass;
}

#ifndef RBD_NO_CHOLESKY
/* -- by the factor -- */

/* Adds to K, for each dof, the inertia of the bodies of its own link about the link's origin. */
RBDI_COLD void rbdi_add_links(const rbd_model *m, rbd_real *K) {
    for (int b = 0; b < m->nb; ++b) {
        const int i = m->frame[b].link;
        const rbdi_link *l;
        rbd_real inertia[6], ratio;
        int iv;
        if (i < 0) continue; /* fixed to the world */

        l = &m->link[i];
        iv = rbdi_source(m, l->iv);
        ratio = rbdi_ratio(m, l->iv);
        rbdi_body_inertia(m, b, inertia);

        if (!rbdi_is(l, RBDI_BLOCK)) {
            K[iv] = K[iv] + (inertia[2] * l->rho + inertia[5] * (l->kappa * l->kappa)) * (ratio * ratio);
            continue;
        }
        for (int k = 0, s = rbdi_block_of(m, l)->first; k < rbdi_link_dofs(m, l); ++k)
            K[iv + k] = K[iv + k] + inertia[s + k];
    }
}

/* Checks the pivots of the matrix whose packed factor is L:

       K_jj = |D_j| + sum over the descendants k of L_kj^2 |D_k| + dof.scale / 4 + inertias of the links
       y_j = -sum of L_ji y_i,   i from k on, on the path of j;   y_k = 1, and y is 0 before k

   The first two terms of K_jj are M_jj, y is column k of L^-1. */
RBDI_COLD void rbdi_check_factor(const rbd_model *m, rbd_work *w, const rbd_real *L, rbdi_mask doubt) {
    const int n = m->nv;
    rbd_real *K = w->F, *y = w->F + n; /* the scratch of crba */

    /* K_jj */
    for (int k = 0; k < n; ++k) K[k] = rbdi_abs(w->pivot[k]) + RBD_C(0.25) * m->dof[k].scale;
    for (int k = 0; k < n; ++k)
        for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) {
            const rbd_real factor = L[m->dof[k].row + t];
            K[i] = K[i] + factor * factor * rbdi_abs(w->pivot[k]);
        }

    rbdi_add_links(m, K);

    /* e_k = sum of y_j^2 K_jj + armature */
    for (int k = 0; k < n; ++k) {
        rbd_real e = K[k] + m->dof[k].armature;

        y[k] = rbdi_set(RBD_C(1));
        for (int j = k + 1; j < n; ++j) {
            const rbd_real *row = &L[m->dof[j].row];
            y[j] = rbdi_zero();
            for (int t = m->dof[j].depth - 1, i = m->dof[j].lambda; i >= k; --t, i = m->dof[i].lambda)
                y[j] = y[j] - row[t] * y[i];
            e = e + y[j] * y[j] * K[j];
        }

        rbdi_check_pivot(w, k, e, doubt);
    }
}

/* The status of a call that factored a matrix, L packed. doubt: whether a pivot is in doubt; x: the n
   results. */
RBDI_INLINE rbd_status rbdi_factor_status(const rbd_model *m, rbd_work *w, const rbd_real *L, rbdi_mask doubt,
                                          rbd_real *x, int n) {
    w->singular = -1;
    if (!rbdi_any(doubt)) return RBD_OK;
    rbdi_check_factor(m, w, L, doubt);
    return rbdi_pivot_status(m, w, x, n);
}
#endif

#endif
