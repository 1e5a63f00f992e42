#ifndef RBDI_DYNAMICS_PIVOTS_H
#define RBDI_DYNAMICS_PIVOTS_H
#include "dynamics/crba.h"
#include "dynamics/packed.h"

/* Interface: rbdi_check_state, rbdi_pivot_status, rbdi_status_of */

/* ---- pivots [pivots] ----
   One function decides for all calls whether M is singular: rbdi_check_pivots, from the pivots D of M = L'DL.

   D_k = y' M y for the motion y in which dof k moves by 1 and the dofs behind it give way: column k of L^-1.
   Two kinds of rounding reach it.

   Arithmetic. Entry M_jj is a sum of terms as large as K_jj, and is off by eps K_jj. So D_k is off by eps e,
   e = sum over j of y_j^2 K_jj, where K_jj is M_jj, the inertia of each link about its own origin along the
   dof, and a quarter of dof.scale, the inertia of the stretched robot.

   Description. An axis is off by eps, and so is a position or a centre of mass by eps of its lever. These
   errors move a mass m that should stand still by eps L. Its share of D is m (eps L)^2, exactly computed: the
   error of such a pivot is all of it. dof.scale has a part RBDI_ROD of m L^2 in it (rbdi_build_scale), so
   that K_jj covers it.

   A pivot counts as zero unless D > RBDI_NOISE (e + armature) + RBDI_TINY.

   Calls that compute pivots only test D > RBDI_DOUBT dof.scale. If all pivots pass, M is regular: a
   rounding error reaches that size only if it is magnified by more than RBDI_DOUBT / eps, and then an
   earlier pivot was small beside its own scale; RBDI_DOUBT is at least sqrt(eps), so that one of the two
   fails the test. Otherwise the state is in doubt: rbdi_check_state computes M from the joints' transforms,
   factors it and checks its pivots. If M is regular, the call's results are kept.

   With RBD_NO_CHOLESKY there is no factor to check, and a state in doubt is singular. */

/* Replaces a pivot by 1 if it is above its noise or no pivot of the state is in doubt, by 0 if not, by -1 if
   it is not a number. */
RBDI_PART void rbdi_check_pivot(rbd_work *w, int k, rbd_real noise, rbdi_mask doubt) {
    const rbd_real D = w->pivot[k], one = rbdi_set(RBD_C(1));
    const rbdi_mask number = rbdi_or(rbdi_less(D, one), rbdi_less(rbdi_zero(), D));
    const rbd_real bad = rbdi_select(number, rbdi_zero(), -one);
    w->pivot[k] = rbdi_select(rbdi_or(rbdi_not(doubt), rbdi_less(noise, D)), one, bad);
}

/* The status after the checks. w->singular becomes the first bad pivot in the order of elimination; the n
   results x of its lanes become 0. */
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

/* Adds to K, for each dof, the inertia of the bodies of its own link about the link's origin. The build's
   rounding counts as well. It turns a rod on an axis, and is relative to the trace of the inertia about the
   link's origin and about the user's, which is at r of the joint's body. */
static void rbdi_add_links(const rbd_model *m, rbd_real *K) {
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->link < 0) continue;
        const rbdi_link *l = &m->link[u->link];
        const rbdi_mat E = rbdi_mat_c(u->E);
        const rbdi_v3 user = rbdi_vec_c(m->frame[m->dof[l->iv].body].r), r = rbdi_vec_c(u->r),
                      c = rbdi_mul_t(E, rbdi_vec_c(u->com)), p = rbdi_add(r, c);
        const rbd_real mass = rbdi_set(u->mass), xx = p.x * p.x * mass, yy = p.y * p.y * mass,
                       zz = p.z * p.z * mass;
        const rbdi_sym S = rbdi_sym_up(E, rbdi_sym_c(u->I));
        const rbdi_v3 I = rbdi_vec(rbdi_abs(S.xx), rbdi_abs(S.yy), rbdi_abs(S.zz));
        const rbd_real trace =
                           I.x + I.y + I.z + mass * (rbdi_dot(r, r) + rbdi_dot(c, c) + rbdi_dot(user, user)),
                       rounding = trace * RBDI_BUILD;
        const rbd_real own[6] = {
            I.x + yy + zz + rounding, I.y + xx + zz + rounding, I.z + xx + yy + rounding, mass, mass, mass};
        const int iv = rbdi_source(m, l->iv);
        const rbd_real ratio = rbdi_ratio(m, l->iv);
        if (!rbdi_is(l, RBDI_BLOCK))
            K[iv] = K[iv] + (own[2] * l->rho + mass * (l->kappa * l->kappa)) * (ratio * ratio);
        else
            for (int k = 0, s = rbdi_block_of(m, l)->first; k < rbdi_link_dofs(m, l); ++k)
                K[iv + k] = K[iv + k] + own[s + k];
    }
}

/* Checks the pivots of M. L is its packed factor, doubt what rbdi_factor returned. M_jj = sum of L_kj^2
   D_k; column k of L^-1, zero but for k and what is behind it, by substitution. */
RBDI_COLD void rbdi_check_pivots(const rbd_model *m, rbd_work *w, const rbd_real *L, rbdi_mask doubt) {
    const int n = m->nv;
    rbd_real *K = w->F, *y = w->F + n; /* the scratch of crba */
    for (int k = 0; k < n; ++k) K[k] = rbdi_abs(w->pivot[k]) + RBD_C(0.25) * m->dof[k].scale;
    for (int k = 0; k < n; ++k)
        for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda) {
            const rbd_real factor = L[m->dof[k].row + t];
            K[i] = K[i] + factor * factor * rbdi_abs(w->pivot[k]);
        }
    rbdi_add_links(m, K);
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
        rbdi_check_pivot(w, k, e * RBDI_NOISE + RBDI_TINY, doubt);
    }
}

/* Checks the pivots of M at the state of the last rbdi_joints. The factor is left in w->H. */
RBDI_COLD void rbdi_check_state(const rbd_model *m, rbd_work *w) {
    RBDI_NOTE_DOUBT(w, 1);
#ifndef RBD_NO_CHOLESKY
    rbdi_crba_of_joints(m, w, w->H);
    rbdi_check_pivots(m, w, w->H, rbdi_factor(m, w, w->H));
#else
    for (int k = 0; k < m->nv; ++k)
        rbdi_check_pivot(w, k, rbdi_set(m->dof[k].scale * RBDI_DOUBT),
                         rbdi_less(rbdi_zero(), rbdi_set(RBD_C(1))));
#endif
}

/* The status of a call with pivots. doubt: whether any is in doubt; x: the n results. */
RBDI_INLINE rbd_status rbdi_status_of(const rbd_model *m, rbd_work *w, rbdi_mask doubt, rbd_real *x, int n) {
    w->singular = -1;
    if (!rbdi_any(doubt)) return RBD_OK;
    rbdi_check_state(m, w);
    return rbdi_pivot_status(m, w, x, n);
}

#endif
