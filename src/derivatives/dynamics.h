#ifndef RBDI_DERIVATIVES_DYNAMICS_H
#define RBDI_DERIVATIVES_DYNAMICS_H
#include "dynamics/pivots.h"
#include "derivatives/memory.h"
#include "derivatives/solve_two.h"

/* ---- derivatives of inverse dynamics [inverse dynamics code] ---- */

RBDI_API rbd_status rbd_id_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                       rbd_real *dtau_dq, rbd_real *dtau_dv, rbd_real *M) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && a);
    if (status) return status;
    rbdi_common(m, d, q, v, a, d->work->gravity, f_ext, RBDI_NEED_V | RBDI_NEED_WRENCH | RBDI_NEED_WHOLE);
    if (dtau_dq) rbdi_columns_by_q(d);
    rbdi_put_entries(m, d, dtau_dq, dtau_dv, M, 1);
    return RBD_OK;
}

RBDI_API rbd_status rbd_gravity_torque_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                                   rbd_real *dg_dq) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && dg_dq);
    if (status) return status;
    return rbd_id_derivatives(m, d, q, d->work->zero, d->work->zero, NULL, dg_dq, NULL, NULL);
}

RBDI_API rbd_status rbd_keep_zeros(rbd_derivatives *d, int keep) {
    if (!d) return RBD_ERR_NULL;
    d->keep_zeros = keep;
    return RBD_OK;
}

/* ---- derivatives of forward dynamics [forward dynamics code] ----
   The columns are computed at a = 0. They give the bias c, c_i = S_i' f_i, and M, and these give a. Then the
   effect of a is added, which is linear: dA to the accelerations, and I dA_p + (sum over the subtree of F_j
   a_j) to the wrench of dof i's subtree, with dA_p of the parent.

   a is computed from the factor even if M^-1 is requested. The product M^-1 (tau - c) takes 5 % fewer
   instructions but loses digits: in chains of 48 links the error of M a is 80 times as large, of da/dq 20
   times. If each of 24 links is twice as heavy as its parent, da/dq has no correct digit; by the factor it
   has six.

   With a free base, v and gravity enter only the base's A. The unknowns are y = (w_dot; v_dot + w x v -
   gravity; accelerations of the joints), at v = 0 and without gravity. y does not depend on the position,
   attitude and linear velocity of the base. From y follows a:

       v_dot = y - w x v - up      by w: dy - e x v      by v: -w x e      by theta: e x up                */

#ifndef RBD_NO_CHOLESKY
/* Writes M as a packed matrix. The model has no mimic joints. */
RBDI_PART void rbdi_put_packed(const rbd_model *m, const rbd_derivatives *d, rbd_real *H) {
    const rbdi_order *o = m->order;
    const rbdi_entry *e = d->entry;
    if (d->base) rbdi_base_columns(d, RBDI_WANT_M);
    for (int i = 0; i < d->n; ++i) {
        const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(RBDI_OF(d, i, S), RBDI_BATCH);
        rbd_real *row = H + o[i].row, *pivot = row + m->dof[o[i].dof].depth, *to = pivot;
        if (d->base) rbdi_store_force(row, 1, F); /* over the end of a base's row goes the next row */
        for (int k = e[i].parent; k >= d->base; k = e[k].parent)
            *--to = rbdi_power(rbdi_load_motion(RBDI_OF(d, k, S), RBDI_BATCH), F);
        *pivot = rbdi_power(S, F) + m->dof[o[i].dof].armature;
    }
}

/* Whether a pivot of M is in doubt because of the common frame: M_kk is a difference of inertias about the
   common origin, as large as the subtree's tr(Sigma), and its error is eps times that. */
RBDI_PART rbdi_mask rbdi_far_pivots(const rbd_derivatives *d) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int k = d->base; k < d->n; ++k) {
        const rbdi_entry *e = &d->entry[k];
        const rbd_real *sum = RBDI_OF(d, k, sum), trace = sum[0] + sum[3 * RBDI_BATCH] + sum[5 * RBDI_BATCH];
        const rbd_const rho = ((const rbd_const *)&d->constants[e->batch].rho)[e->lane];
        doubt = rbdi_or(doubt, rbdi_less(d->work->pivot[e->source], trace * (rho * RBDI_DOUBT)));
    }
    return doubt;
}

/* Factors M anew, computed in the links' frames, and checks its pivots. */
RBDI_COLD void rbdi_factor_again(const rbd_model *m, rbd_work *w) {
    rbdi_mask doubt;
    RBDI_NOTE_DOUBT(w, 1);
    rbdi_crba_of_joints(m, w, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_check_factor(m, w, w->H, doubt);
}

/* x = tau - c. */
RBDI_PART void rbdi_net_torque(const rbd_model *m, rbd_derivatives *d, const rbd_real *tau, rbd_real *x) {
    rbd_real *bias = rbdi_mimics(m) ? d->work->tx : x;
    for (int b = d->base ? d->behind : 0; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        c->qdd = rbdi_b_power(c->S, c->sum.f);
    }
    if (d->base) rbdi_store_force(bias, 1, rbdi_load_force(RBDI_OF(d, d->base - 1, sum.f), RBDI_BATCH));
    for (int k = d->base; k < d->n; ++k) bias[d->entry[k].source] = *RBDI_OF(d, k, qdd);
    rbdi_reduce_tau(m, d->work->tx, x);
    for (int k = 0; k < m->nv; ++k) x[k] = tau[k] - x[k];
}

/* Adds the effect of a to A_p and f of all dofs. */
RBDI_PART void rbdi_add_acceleration(const rbd_model *m, rbd_derivatives *d, const rbd_real *a) {
    const int base = d->base, first = base ? d->behind : 0;
    rbdi_spread(d, base, rbdi_expand_v(m, a, d->work->ax), (rbd_real *)&d->columns->qdd);
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        c->dA = rbdi_b_motion_scale(c->qdd, c->S);
        c->E.n = rbdi_b_scale(c->qdd, c->F.n), c->E.f = rbdi_b_scale(c->qdd, c->F.f);
    }
    rbdi_sum_ancestors(d, base, (rbd_real *)&d->columns->Phi, -6 * RBDI_BATCH,
                       base ? rbdi_load_motion(a, 1) : rbdi_motion0(), 0);
    rbdi_sum_components(d, d->segment, (rbd_real *)&d->columns->E, 6);
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        const rbdi_bforce f =
            rbdi_b_force_add(rbdi_inertia_times(&c->sum, d->constants[b].subtree, c->Phi), c->E);
        c->sum.f = rbdi_b_force_add(c->sum.f, f);
        c->Ap = rbdi_b_motion_add(c->Ap, c->Phi);
    }
    rbdi_columns_by_q(d);
}

/* Adds [s]x to three rows and columns of a matrix that has nv columns. */
RBDI_INLINE void rbdi_add_skew(rbd_real *out, ptrdiff_t nv, rbdi_v3 s) {
    const rbd_real x[3] = {s.x, s.y, s.z};
    for (int i = 0; i < 3; ++i, out += nv) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[j] = out[j] - x[k], out[k] = out[k] + x[j];
    }
}
/* Replaces y, in d->a, by a, and the derivatives of y by those of a. Either may be NULL. v: velocity of the
   base. */
RBDI_PART void rbdi_from_base(const rbd_model *m, const rbd_derivatives *d, const rbd_real *v, rbd_real *by_q,
                              rbd_real *by_v) {
    const ptrdiff_t nv = m->nv;
    const rbdi_v3 w = rbdi_load_vec(v, 1), u = rbdi_load_vec(v + 3, 1),
                  g = rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(d->work->gravity)),
                  y = rbdi_load_vec(d->a + 3, 1);
    rbd_real *turn[3];
    if (by_v) rbdi_place_turns(by_q, by_v, turn);
    for (ptrdiff_t r = 0; r < nv * nv; r += nv) {
        if (by_v) {
            rbdi_store_vec(by_v + r, 1, rbdi_vec(turn[0][r], turn[1][r], turn[2][r]));
            rbdi_store_vec(by_v + r + 3, 1, rbdi_vec0());
        }
        if (by_q) rbdi_clear(by_q + r, 6);
    }
    rbdi_store_vec(d->a + 3, 1, rbdi_add(rbdi_sub(y, rbdi_cross(w, u)), g));
    if (by_q) rbdi_add_skew(by_q + 3 * nv, nv, g);
    if (by_v)
        rbdi_add_skew(by_v + 3 * nv, nv, u), rbdi_add_skew(by_v + 3 * nv + 3, nv, rbdi_sub(rbdi_vec0(), w));
}

RBDI_API rbd_status rbd_fd_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *da_dq, rbd_real *da_dv, rbd_real *Minv) {
    const int nv = m ? m->nv : 0, need = RBDI_NEED_WRENCH | (da_dq || da_dv ? RBDI_NEED_V : 0);
    rbd_real *const result[3] = {da_dq, da_dv, Minv};
    rbd_real *sides[2];
    rbdi_mask doubt;
    int count = 0, unsolved = 0; /* unsolved: number of first columns, see rbdi_place_turns */
    rbd_status status = rbdi_check_derivatives(m, d, q && v && tau);
    if (status) return status;
    if (rbdi_mimics(m)) rbd_crba_packed(m, d->work, q, d->work->H);
    rbdi_common(m, d, q, v, d->work->zero, d->work->gravity, f_ext, need);
    if (!rbdi_mimics(m)) rbdi_put_packed(m, d, d->work->H);
    rbdi_net_torque(m, d, tau, d->a);
    doubt = rbdi_factor(m, d->work, d->work->H);
    if (!rbdi_mimics(m)) doubt = rbdi_or(doubt, rbdi_far_pivots(d));
    d->work->singular = -1;
    if (rbdi_any(doubt)) rbdi_factor_again(m, d->work);
    if (Minv) rbdi_invert(m, d->work, d->work->H, Minv);
    rbdi_solve(m, d->work, d->work->H, d->a);
    if (rbdi_any(doubt)) status = rbdi_pivot_status(m, d->work, d->a, nv);
    if (da_dq) rbdi_add_acceleration(m, d, d->a);
    if (da_dq || da_dv) rbdi_put_entries(m, d, da_dq, da_dv, NULL, 0);
    if (d->base) rbdi_put_turns(d, da_dq, da_dv);
    if (d->base) unsolved = !da_dv ? 6 : da_dq ? 4 : 3;
    if (da_dq) sides[count++] = da_dq + unsolved;
    if (da_dv) sides[count++] = da_dv + unsolved;
    if (count == 1) rbdi_solve_columns(m, d->work, d->work->H, -1, nv, nv - unsolved, sides[0]);
    if (count == 2) rbdi_solve_two(m, d->work, d->work->H, -1, nv, nv - unsolved, sides[0], sides[1]);
    if (d->base) rbdi_from_base(m, d, v, da_dq, da_dv);
    for (int k = 0; a && k < nv; ++k) a[k] = d->a[k];
    if (status && a) (void)rbdi_pivot_status(m, d->work, a, nv);
    for (int k = 0; status && k < 3; ++k)
        if (result[k]) (void)rbdi_pivot_status(m, d->work, result[k], nv * nv);
    return status;
}
#endif

#endif
