#ifndef RBDI_DERIVATIVES_DYNAMICS_H
#define RBDI_DERIVATIVES_DYNAMICS_H
#include "dynamics/pivots.h"
#include "derivatives/base_entries.h"
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
   With the acceleration a of M a = tau - c, where c is the bias force,

       da/dx = -M^-1 dtau/dx,   dtau/dx: of inverse dynamics, at a.

   rbd_fd_derivatives computes, in this order:

     1. the columns at a = 0. They give M, and the bias force c_i = S_i' f_i of the subtree's wrench f
     2. M = L'DL and a
     3. the effect of a, which is linear: A_p' on the acceleration A_p of dof i's parent, f' on the wrench f

            A_p' = sum over the parent and its ancestors of S_j a_j
            f' = I A_p' + sum over the subtree of F_j a_j

     4. Phi and E from A_p + A_p' and f + f', and with them dtau/dq and dtau/dv
     5. the solution of M X = -dtau/dx

   a is computed from the factor even if M^-1 is requested. The product M^-1 (tau - c) takes 5 % fewer
   instructions but loses digits: in chains of 48 links the error of M a is 80 times as large, of da/dq 20
   times. If each of 24 links is twice as heavy as its parent, da/dq has no correct digit; by the factor it
   has six.

   With a free base, gravity and the base's linear velocity enter the dynamics only by the A of the base. The
   call leaves both out. Its unknowns are y = (A of the base; accelerations of the joints). y does not depend
   on position, attitude and linear velocity of the base. At the end v_dot and its derivatives follow from the
   linear part y_v of A and its derivatives. With the velocity (w; u) of the base,

       v_dot = y_v - w x u + gravity
       by w: dy_v/dw + [u]x     by u: -[w]x     by the turn theta: [gravity]x     by joints: those of y_v */

#ifndef RBD_NO_CHOLESKY
/* Writes M as a packed matrix, M_ik = S_k' F_i on the path of i. The model has no mimic joints. */
RBDI_PART void rbdi_put_packed(const rbd_model *m, const rbd_derivatives *d, rbd_real *H) {
    const rbdi_order *o = m->order;
    const rbdi_entry *e = d->entry;
    if (d->base) rbdi_base_columns(d, RBDI_WANT_M);

    for (int i = 0; i < d->n; ++i) {
        const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(RBDI_OF(d, i, S), RBDI_BATCH);
        rbd_real *row = H + o[i].row, *pivot = row + m->dof[o[i].dof].depth, *to = pivot;

        /* S_k of a base are unit vectors. A row shorter than six spills into the next, which comes later */
        if (d->base) rbdi_store_force(row, 1, F);
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
        const rbd_real trace = *RBDI_OF(d, k, sum.xx) + *RBDI_OF(d, k, sum.yy) + *RBDI_OF(d, k, sum.zz);
        const rbd_const rho = *RBDI_CONSTANT_OF(d, k, rho);
        doubt = rbdi_or(doubt, rbdi_less(d->work->pivot[d->entry[k].source], trace * (rho * RBDI_DOUBT)));
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

/* x = tau - c, with c_i = S_i' f_i; of a free base c = f. A batch of lanes is a piece of c: both have the
   caller's order. */
RBDI_PART void rbdi_net_torque(const rbd_model *m, rbd_derivatives *d, const rbd_real *tau, rbd_real *x) {
    rbd_real *bias = rbdi_mimics(m) ? d->work->tx : x;

    for (int b = d->behind, k = d->base; b < d->batches; ++b, k += RBDI_BATCH) {
        const rbdi_columns *cols = &d->columns[b];
        const rbdi_batch bias_b = rbdi_b_power(cols->S, cols->sum.f);
        rbdi_copy_batch((const rbd_real *)&bias_b, d->n - k, bias + k);
    }
    if (d->base) rbdi_store_force(bias, 1, rbdi_load_force(RBDI_OF(d, d->base - 1, sum.f), RBDI_BATCH));

    rbdi_reduce_tau(m, d->work->tx, x);
    for (int k = 0; k < m->nv; ++k) x[k] = tau[k] - x[k];
}

/* Steps 3 and, by q, 4: adds the effect of a to A_p and f of all dofs; then Phi and E. */
RBDI_PART void rbdi_add_acceleration(const rbd_model *m, rbd_derivatives *d, const rbd_real *a) {
    const int base = d->base, first = base ? d->behind : 0;
    const rbdi_motion A = base ? rbdi_load_motion(a, 1) : rbdi_motion0();

    /* S a and F a of each dof, then their sums: A_p' and that of F a */
    rbdi_spread(d, base, rbdi_expand_v(m, a, d->work->ax), RBDI_FIELD(d, qdd));
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        cols->stage.response.A.joint = rbdi_b_motion_scale(cols->qdd, cols->S);
        cols->stage.response.F_qdd.n = rbdi_b_scale(cols->qdd, cols->F.n);
        cols->stage.response.F_qdd.f = rbdi_b_scale(cols->qdd, cols->F.f);
    }

    rbdi_sum_ancestors(d, base, RBDI_FIELD(d, stage.response.A), A, 0);
    rbdi_sum_components(d, d->segment, RBDI_FIELD(d, stage.response.F_qdd), RBDI_WRENCH_SUMS);

    /* A_p += A_p',  f += I A_p' + sum of F a */
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion A_p = cols->stage.response.A.p;
        const rbdi_bforce I_A_p = rbdi_inertia_times(&cols->sum, d->constants[b].subtree, A_p);

        cols->sum.f = rbdi_b_force_add(cols->sum.f, rbdi_b_force_add(I_A_p, cols->stage.response.F_qdd));
        cols->A.p = rbdi_b_motion_add(cols->A.p, A_p);
    }

    rbdi_columns_by_q(d);
}

/* Adds [s]x to three rows and columns of a matrix that has nv columns. */
RBDI_INLINE void rbdi_add_skew(rbd_real *out, ptrdiff_t nv, rbdi_v3 s) {
    const rbd_real x[3] = {s.x, s.y, s.z};

    for (int i = 0; i < 3; ++i, out += nv) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[j] = out[j] - x[k];
        out[k] = out[k] + x[j];
    }
}

/* Replaces y, in d->a, by a, and the derivatives by_q and by_v of y, either of which may be NULL, by those of
   a. v: its first six are (w; u) of the base. The formulas are those of [forward dynamics code]. */
RBDI_PART void rbdi_from_base(const rbd_model *m, const rbd_derivatives *d, const rbd_real *v, rbd_real *by_q,
                              rbd_real *by_v) {
    const ptrdiff_t nv = m->nv;
    const rbdi_v3 w = rbdi_load_vec(v, 1), u = rbdi_load_vec(v + 3, 1),
                  g = rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(d->work->gravity)),
                  y_v = rbdi_load_vec(d->a + 3, 1);
    rbd_real *turn[3];

    /* the columns by w from the places of rbdi_place_turns to their own; the base's others are 0 */
    if (by_v) rbdi_place_turns(by_q, by_v, turn);
    for (ptrdiff_t r = 0; r < nv * nv; r += nv) {
        if (by_v) {
            rbdi_store_vec(by_v + r, 1, rbdi_vec(turn[0][r], turn[1][r], turn[2][r]));
            rbdi_store_vec(by_v + r + 3, 1, rbdi_vec0());
        }
        if (by_q) rbdi_clear(by_q + r, 6);
    }

    /* v_dot, and what its rows have beyond those of y_v */
    rbdi_store_vec(d->a + 3, 1, rbdi_add(rbdi_sub(y_v, rbdi_cross(w, u)), g));
    if (by_q) rbdi_add_skew(by_q + 3 * nv, nv, g);
    if (by_v) {
        rbdi_add_skew(by_v + 3 * nv, nv, u);
        rbdi_add_skew(by_v + 3 * nv + 3, nv, rbdi_sub(rbdi_vec0(), w));
    }
}

/* Steps 1 and 2: the columns, the factor of M in w->H, and a (of a free base y) in d->a. need: what of the
   columns is needed. Returns whether a pivot is in doubt. */
RBDI_INLINE rbdi_mask rbdi_solve_acceleration(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                              const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                              int need, rbd_real *Minv) {
    rbd_work *w = d->work;
    rbdi_mask doubt;

    /* columns, M and tau - c; with mimic joints M is not that of the columns' dofs */
    if (rbdi_mimics(m)) rbd_crba_packed(m, w, q, w->H);
    rbdi_common(m, d, q, v, w->zero, w->gravity, f_ext, need);
    if (!rbdi_mimics(m)) rbdi_put_packed(m, d, w->H);
    rbdi_net_torque(m, d, tau, d->a);

    doubt = rbdi_factor(m, w, w->H);
    if (!rbdi_mimics(m)) doubt = rbdi_or(doubt, rbdi_far_pivots(d));

    /* in doubt, M anew from the links' frames; then w->pivot has the verdicts for rbdi_pivot_status */
    w->singular = -1;
    if (rbdi_any(doubt)) rbdi_factor_again(m, w);

    if (Minv) rbdi_invert(m, w, w->H, Minv);
    rbdi_solve(m, w, w->H, d->a);
    return doubt;
}

/* The rest of step 4, and step 5: da/dq and da/dv, one of them or both; of a free base those of y. */
RBDI_INLINE void rbdi_acceleration_derivatives(const rbd_model *m, rbd_derivatives *d, rbd_real *da_dq,
                                               rbd_real *da_dv) {
    const int first = rbdi_first_solved(d, da_dq, da_dv);
    rbd_real *one = da_dq ? da_dq + first : da_dv + first, *other = da_dq && da_dv ? da_dv + first : NULL;

    rbdi_put_entries(m, d, da_dq, da_dv, NULL, 0);
    if (d->base) rbdi_put_turns(d, da_dq, da_dv);

    if (other)
        rbdi_solve_two(m, d->work, d->work->H, -1, m->nv, m->nv - first, one, other);
    else
        rbdi_solve_columns(m, d->work, d->work->H, -1, m->nv, m->nv - first, one);
}

RBDI_API rbd_status rbd_fd_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *da_dq, rbd_real *da_dv, rbd_real *Minv) {
    const int nv = m ? m->nv : 0, need = RBDI_NEED_WRENCH | (da_dq || da_dv ? RBDI_NEED_V : 0);
    rbd_real *const result[3] = {da_dq, da_dv, Minv};
    rbdi_mask doubt;
    rbd_status status = rbdi_check_derivatives(m, d, q && v && tau);
    if (status) return status;

    /* d->a = a, or y of a free base */
    doubt = rbdi_solve_acceleration(m, d, q, v, tau, f_ext, need, Minv);
    if (rbdi_any(doubt)) status = rbdi_pivot_status(m, d->work, d->a, nv);

    if (da_dq) rbdi_add_acceleration(m, d, d->a);
    if (da_dq || da_dv) rbdi_acceleration_derivatives(m, d, da_dq, da_dv);

    /* from y to a */
    if (d->base) rbdi_from_base(m, d, v, da_dq, da_dv);
    if (a)
        for (int k = 0; k < nv; ++k) a[k] = d->a[k];
    if (!status) return RBD_OK;

    /* the results become 0 in the lanes that have an error */
    if (a) (void)rbdi_pivot_status(m, d->work, a, nv);
    for (int k = 0; k < 3; ++k)
        if (result[k]) (void)rbdi_pivot_status(m, d->work, result[k], nv * nv);
    return status;
}
#endif

#endif
