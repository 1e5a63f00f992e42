#ifndef RBDI_DERIVATIVES_FREE_BASE_H
#define RBDI_DERIVATIVES_FREE_BASE_H
#include "derivatives/subtrees.h"
#include "derivatives/memory.h"

/* ---- inverse dynamics with a free base [free base code] ----
   If A = 0 at the base, the wrenches of the links add up to f. The missing wrench tau - f gives A = y of the
   base: I y = tau - f, with I the inertia of the whole tree, by Newton's and Euler's laws about the centre of
   mass. In the common frame the A of all links increases by y. The torques are S' f + F' y, with f of the
   subtree and F = I S. Gravity and the base's linear velocity are in the linear part y_v of y only:
   v_dot = y_v - w x v + gravity. rbd_hybrid serves other models, and states in which y is in doubt. */

#ifndef RBD_NO_CHOLESKY
/* M^-1 x for the 3 x 3 matrix M of turns, by pivots from the end, as in [packed matrix]: M = L'DL. z, y: 1/D
   of these rows. */
RBDI_INLINE rbdi_v3 rbdi_solve_turns(const rbd_model *m, rbdi_sym M, rbdi_v3 x, rbdi_mask *doubt) {
    const rbd_real z = rbdi_pivot_inverse(M.zz, m->dof[2].scale, doubt);
    const rbd_real L_zy = M.yz * z;
    const rbd_real L_zx = M.xz * z;
    const rbd_real xy = M.xy - L_zx * M.yz;
    const rbd_real y = rbdi_pivot_inverse(M.yy - L_zy * M.yz, m->dof[1].scale, doubt);
    const rbd_real L_yx = xy * y;
    rbdi_v3 s;

    x.y = x.y - L_zy * x.z;
    x.x = x.x - L_zx * x.z - L_yx * x.y;

    s.x = x.x * rbdi_pivot_inverse(M.xx - L_zx * M.xz - L_yx * xy, m->dof[0].scale, doubt);
    s.y = x.y * y - L_yx * s.x;
    s.z = x.z * z - L_zx * s.x - L_zy * s.y;
    return s;
}

/* y = (omega_dot; y_v) from the missing wrench F = (n; f):

       com = h / mass,   I_com omega_dot = n - com x f,   mass y_v = f - omega_dot x h */
RBDI_PART rbdi_motion rbdi_base_motion(const rbd_model *m, const rbd_derivatives *d, rbdi_force F,
                                       rbdi_mask *doubt) {
    const rbd_real mass_inverse = rbdi_pivot_inverse(rbdi_set(d->mass), m->dof[3].scale, doubt);
    const int last = d->base - 1;
    const rbdi_v3 h = rbdi_load_vec(RBDI_OF(d, last, sum.h), RBDI_BATCH), com = rbdi_scale(mass_inverse, h);
    rbdi_rbi C; /* Sigma - com h' about the centre of mass, h about the base's origin */
    rbdi_motion y;

    C.h = h;
    C.Sigma.xx = *RBDI_OF(d, last, sum.xx) - com.x * h.x;
    C.Sigma.xy = *RBDI_OF(d, last, sum.xy) - com.x * h.y;
    C.Sigma.xz = *RBDI_OF(d, last, sum.xz) - com.x * h.z;
    C.Sigma.yy = *RBDI_OF(d, last, sum.yy) - com.y * h.y;
    C.Sigma.yz = *RBDI_OF(d, last, sum.yz) - com.y * h.z;
    C.Sigma.zz = *RBDI_OF(d, last, sum.zz) - com.z * h.z;

    y.omega = rbdi_solve_turns(m, rbdi_abi_of_rbi(C, d->mass).I, rbdi_sub(F.n, rbdi_cross(com, F.f)), doubt);
    y.v = rbdi_scale(mass_inverse, rbdi_sub(F.f, rbdi_cross(y.omega, h)));
    return y;
}

/* Torques of the joints at A = y of the base: S' f + F' y + armature a. */
RBDI_PART void rbdi_put_torques(const rbd_model *m, const rbd_derivatives *d, rbdi_motion y,
                                const rbd_real *a, rbd_real *tau) {
    for (int b = d->behind, k = d->base; b < d->batches; ++b, k += RBDI_BATCH) {
        const rbdi_columns *cols = &d->columns[b];
        const rbdi_batch x = rbdi_b_power(cols->S, cols->sum.f) + rbdi_b_force_dot(cols->F, y);
        rbdi_copy_batch((const rbd_real *)&x, m->nv - k, tau + k);
    }

    for (int k = d->base; k < m->nv; ++k) tau[k] = tau[k] + a[k] * m->dof[k].armature;
}

/* rbd_id_free_base by rbd_hybrid, for any model. */
RBDI_COLD rbd_status rbdi_hybrid_free_base(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                           const rbd_real *v, const rbd_real *f_ext, rbd_real *a,
                                           rbd_real *tau) {
    unsigned char *given = d->given;
    int bases = 0;

    for (int k = 0; k < m->nv; ++k) given[k] = 1;
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        if (l->parent >= 0 || rbdi_link_dofs(m, l) != 6) continue;

        for (int k = 0; k < 6; ++k) given[l->iv + k] = 0;
        ++bases;
    }

    if (bases == 0) return rbd_rnea(m, d->work, q, v, a, f_ext, tau);
    return rbd_hybrid(m, d->work, q, v, given, a, tau, f_ext);
}

RBDI_API rbd_status rbd_id_free_base(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                     const rbd_real *v, rbd_real *a, rbd_real *tau, const rbd_real *f_ext) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && a && tau);
    rbdi_force f;
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_motion y;
    if (status) return status;
    if (!d->base) return rbdi_hybrid_free_base(m, d, q, v, f_ext, a, tau);

    rbdi_clear(a, 6);
    rbdi_common(m, d, q, v, a, rbdi_no_gravity(), f_ext, RBDI_NEED_WRENCH);
    f = rbdi_load_force(RBDI_OF(d, d->base - 1, sum.f), RBDI_BATCH);
    y = rbdi_base_motion(m, d, rbdi_force_sub(rbdi_load_force(tau, 1), f), &doubt);
    if (rbdi_any(doubt)) return rbdi_hybrid_free_base(m, d, q, v, f_ext, a, tau);
    rbdi_put_torques(m, d, y, a, tau);

    /* v_dot = y_v - w x v + gravity */
    y.v = rbdi_add(y.v, rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(d->work->gravity)));
    y.v = rbdi_sub(y.v, rbdi_cross(d->V.omega, rbdi_load_vec(v + 3, 1)));
    rbdi_store_motion(a, 1, y);
    d->work->singular = -1;
    return RBD_OK;
}
#endif

#endif
