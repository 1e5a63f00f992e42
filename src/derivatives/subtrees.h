#ifndef RBDI_DERIVATIVES_SUBTREES_H
#define RBDI_DERIVATIVES_SUBTREES_H
#include "derivatives/common_frame.h"

/* ---- links, subtrees, columns [subtrees] ----
   From the motion of all dofs to their columns F, D, T, E: the inertia, momentum and wrench of each link,
   their sums over subtrees, and products of these with S, U, Psi, Phi. */

/* h = R h_b + m x, Sigma = R Sigma_b R' + x (R h_b)' + h x' of the links. col_x, col_y, col_z: R Sigma_b. */
RBDI_INLINE void rbdi_own_inertia(const rbdi_columns *cols, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 ex = cols->ex, ey = cols->ey, ez = cols->ez, x = cols->x;
    const rbdi_b3 h = rbdi_b_rotate(cols, own->hx, own->hy, own->hz),
                  col_x = rbdi_b_rotate(cols, own->xx, own->xy, own->xz),
                  col_y = rbdi_b_rotate(cols, own->xy, own->yy, own->yz),
                  col_z = rbdi_b_rotate(cols, own->xz, own->yz, own->zz);

    s->h = rbdi_b_vec(h.x + x.x * own->m, h.y + x.y * own->m, h.z + x.z * own->m);

    s->xx = col_x.x * ex.x + col_y.x * ey.x + col_z.x * ez.x + x.x * h.x + s->h.x * x.x;
    s->xy = col_x.x * ex.y + col_y.x * ey.y + col_z.x * ez.y + x.x * h.y + s->h.x * x.y;
    s->xz = col_x.x * ex.z + col_y.x * ey.z + col_z.x * ez.z + x.x * h.z + s->h.x * x.z;
    s->yy = col_x.y * ex.y + col_y.y * ey.y + col_z.y * ez.y + x.y * h.y + s->h.y * x.y;
    s->yz = col_x.y * ex.z + col_y.y * ey.z + col_z.y * ez.z + x.y * h.z + s->h.y * x.z;
    s->zz = col_x.z * ex.z + col_y.z * ey.z + col_z.z * ez.z + x.z * h.z + s->h.z * x.z;
}

/* X = [w]x Sigma + v h', P = m v + w x h of the links, W = (w; v). */
RBDI_INLINE void rbdi_own_momentum(rbdi_bmotion W, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 w = W.omega, v = W.v, h = s->h;
    const rbdi_b3 sx = rbdi_b_vec(s->xx, s->xy, s->xz), sy = rbdi_b_vec(s->xy, s->yy, s->yz),
                  sz = rbdi_b_vec(s->xz, s->yz, s->zz);

    s->Xx = rbdi_b_vec(w.y * sz.x - w.z * sy.x + v.x * h.x, w.y * sz.y - w.z * sy.y + v.x * h.y,
                       w.y * sz.z - w.z * sy.z + v.x * h.z);
    s->Xy = rbdi_b_vec(w.z * sx.x - w.x * sz.x + v.y * h.x, w.z * sx.y - w.x * sz.y + v.y * h.y,
                       w.z * sx.z - w.x * sz.z + v.y * h.z);
    s->Xz = rbdi_b_vec(w.x * sy.x - w.y * sx.x + v.z * h.x, w.x * sy.y - w.y * sx.y + v.z * h.y,
                       w.x * sy.z - w.y * sx.z + v.z * h.z);

    s->P = rbdi_b_cross_add(rbdi_b_vec(v.x * own->m, v.y * own->m, v.z * own->m), w, h);
}

/* Omega = [omega_dot]x + [omega]x [omega]x: rbdi_omega for batches, whose matrices are rows of vectors. */
RBDI_INLINE rbdi_b33 rbdi_b_omega(rbdi_b3 w, rbdi_b3 w_dot) {
    rbdi_b33 O;
    O.x = rbdi_b_vec(-(w.y * w.y + w.z * w.z), w.x * w.y - w_dot.z, w.x * w.z + w_dot.y);
    O.y = rbdi_b_vec(w.x * w.y + w_dot.z, -(w.x * w.x + w.z * w.z), w.y * w.z - w_dot.x);
    O.z = rbdi_b_vec(w.x * w.z - w_dot.y, w.y * w.z + w_dot.x, -(w.x * w.x + w.y * w.y));
    return O;
}

/* acc = a + omega x v. */
RBDI_INLINE rbdi_b3 rbdi_b_classical(rbdi_bmotion V, rbdi_bmotion A) {
    return rbdi_b_cross_add(A.v, V.omega, V.v);
}

/* The wrench that moves each link. rbdi_wrench has the same formula for one link with the model's constants,
   whose zeros it leaves out; here h and Sigma are about the common origin, and none is 0:

       f = Omega h + m acc,   n = (K_zy - K_yz; K_xz - K_zx; K_yx - K_xy),   K = Omega Sigma + acc h' */
RBDI_INLINE void rbdi_own_wrench(rbdi_bmotion V, rbdi_bmotion A, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 h = s->h, acc = rbdi_b_classical(V, A);
    const rbdi_b33 O = rbdi_b_omega(V.omega, A.omega);
    const rbdi_b3 n =
        rbdi_b_vec(O.z.x * s->xy + O.z.y * s->yy + (O.z.z - O.y.y) * s->yz - O.y.x * s->xz - O.y.z * s->zz,
                   O.x.y * s->yz + (O.x.x - O.z.z) * s->xz + O.x.z * s->zz - O.z.x * s->xx - O.z.y * s->xy,
                   O.y.x * s->xx + (O.y.y - O.x.x) * s->xy + O.y.z * s->xz - O.x.y * s->yy - O.x.z * s->yz);

    s->f.n = rbdi_b_cross_add(n, h, acc);
    s->f.f = rbdi_b_vec(O.x.x * h.x + O.x.y * h.y + O.x.z * h.z + acc.x * own->m,
                        O.y.x * h.x + O.y.y * h.y + O.y.z * h.z + acc.y * own->m,
                        O.z.x * h.x + O.z.y * h.y + O.z.z * h.z + acc.z * own->m);
}

/* Stores the sums that need asks for. */
RBDI_INLINE void rbdi_store_sums(const rbdi_sums *s, int need, rbdi_sums *out) {
    out->xx = s->xx;
    out->xy = s->xy;
    out->xz = s->xz;
    out->yy = s->yy;
    out->yz = s->yz;
    out->zz = s->zz;
    out->h = s->h;

    if (need & RBDI_NEED_V) {
        out->Xx = s->Xx;
        out->Xy = s->Xy;
        out->Xz = s->Xz;
        out->P = s->P;
    }

    if (need & RBDI_NEED_WRENCH) out->f = s->f;
}

/* Subtracts external wrenches from those of the links. */
RBDI_PART void rbdi_common_external(const rbd_model *m, rbd_derivatives *d, const rbd_real *f_ext) {
    const int bodies = f_ext ? m->nb : 0;

    for (int body = 0; body < bodies; ++body) {
        const rbdi_frame *u = &m->frame[body];
        rbdi_pose pose;
        rbdi_force F;
        rbd_real *out;
        if (u->link < 0) continue;

        /* from the body to its link, then to the common frame */
        pose.E = rbdi_mat_c(u->E);
        pose.r = rbdi_vec_c(u->r);
        F = rbdi_force_up_block(&pose, rbdi_load_force(f_ext + 6 * body, 1));
        pose = rbdi_common_pose(m, d, u->link);
        F = rbdi_force_up_block(&pose, F);

        out = RBDI_OF(d, rbdi_last_dof(m, u->link), sum.f);
        rbdi_store_force(out, RBDI_BATCH, rbdi_force_sub(rbdi_load_force(out, RBDI_BATCH), F));
    }
}

/* The first batch with a link's inertia, which the link's last dof has. */
RBDI_INLINE int rbdi_first_inertia(const rbd_derivatives *d, int base) {
    return base ? d->entry[base - 1].batch : 0;
}

/* Inertias, momenta and wrenches of the links, each alone. */
RBDI_INLINE void rbdi_own_sums(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *f_ext,
                               int need) {
    for (int b = rbdi_first_inertia(d, base); b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        rbdi_bmotion V;
        rbdi_sums s; /* not in place: what lies in memory is read again after every store */

        rbdi_own_inertia(cols, own, &s);
        if (need) V = rbdi_b_motion_add(cols->V.p, cols->V.joint);
        if (need & RBDI_NEED_WRENCH) rbdi_own_wrench(V, rbdi_b_motion_add(cols->A.p, cols->A.joint), own, &s);
        if (need & RBDI_NEED_V)
            rbdi_own_momentum(need & RBDI_NEED_CORIOLIS ? V : rbdi_b_motion_add(V, V), own, &s);
        rbdi_store_sums(&s, need, &cols->sum);
    }

    if (need & RBDI_NEED_WRENCH) rbdi_common_external(m, d, f_ext);
}

/* Sums so many components of a field over subtrees, for the segments from root on: at most 14, for which
   there are registers. x: the field's first scalar in d->columns. All dofs of a block get the sum of the
   block. Segments are taken one after the other: equal limbs as lanes, as HyQ's legs, took more time. */
RBDI_INLINE void rbdi_sum_components(rbd_derivatives *d, const rbdi_segment *root, rbd_real *x, int count) {
    for (const rbdi_segment *seg = d->segment + d->segments - 1; seg >= root; --seg) {
        const rbdi_entry *e = d->entry + seg->end - 1, *first = d->entry + seg->first;
        const rbd_real *last = x + e->at;
        rbd_real sum[14], *out;

        /* up the segment: each dof adds what it has */
        RBDI_ONE_INDEX(last);
        RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) sum[j] = last[j * RBDI_BATCH];
        while (e > first) {
            out = x + (--e)->at;
            RBDI_ONE_INDEX(out);
            RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) {
                sum[j] = sum[j] + out[j * RBDI_BATCH];
                out[j * RBDI_BATCH] = sum[j];
            }
        }

        /* a block: all of its dofs have the sum */
        if (seg->block) {
            for (e = first + 1; e < d->entry + seg->end; ++e) {
                out = x + e->at;
                RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) out[j * RBDI_BATCH] = sum[j];
            }
        }

        /* the parent's segment takes the sum too */
        if (seg->parent < 0) continue;
        out = x + d->entry[seg->parent].at;
        RBDI_ONE_INDEX(out);
        RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) out[j * RBDI_BATCH] = out[j * RBDI_BATCH] + sum[j];
    }
}

/* Sums all that need asks for. With all of it the 27 components go in two halves. */
RBDI_INLINE void rbdi_sum_subtrees(rbd_derivatives *d, const rbdi_segment *root, int need) {
    const int all = RBDI_INERTIA_SUMS + RBDI_MOMENTUM_SUMS + RBDI_WRENCH_SUMS, half = 14;
    const int wrench = need & RBDI_NEED_WRENCH;
    rbd_real *x = RBDI_FIELD(d, sum);

    if (need & RBDI_NEED_V) {
        rbdi_sum_components(d, root, x, half);
        rbdi_sum_components(d, root, x + half * RBDI_BATCH, all - half - (wrench ? 0 : RBDI_WRENCH_SUMS));
        return;
    }

    rbdi_sum_components(d, root, x, RBDI_INERTIA_SUMS);
    if (wrench) rbdi_sum_components(d, root, RBDI_FIELD(d, sum.f), RBDI_WRENCH_SUMS);
}

/* I V of a subtree, with V = (w; v) and tr(Sigma) - Sigma in I:

       n = (tr(Sigma) - Sigma) w + h x v,   f = m v + w x h */
RBDI_INLINE rbdi_bforce rbdi_inertia_times(const rbdi_sums *s, rbdi_cbatch mass, rbdi_bmotion V) {
    const rbdi_b3 w = V.omega, v = V.v;
    rbdi_bforce F;

    F.n = rbdi_b_vec((s->yy + s->zz) * w.x - s->xy * w.y - s->xz * w.z,
                     (s->xx + s->zz) * w.y - s->xy * w.x - s->yz * w.z,
                     (s->xx + s->yy) * w.z - s->xz * w.x - s->yz * w.y);
    F.n = rbdi_b_cross_add(F.n, s->h, v);
    F.f = rbdi_b_cross_add(rbdi_b_vec(v.x * mass, v.y * mass, v.z * mass), w, s->h);
    return F;
}

/* F + B S, which needs only w of S = (w; v): n + (tr(X) - X) w and f + w x P. */
RBDI_INLINE rbdi_bforce rbdi_subtree_B_add(rbdi_bforce F, const rbdi_sums *s, rbdi_b3 w) {
    const rbdi_b3 x = s->Xx, y = s->Xy, z = s->Xz;

    F.n = rbdi_b_vec(F.n.x + (y.y + z.z) * w.x - x.y * w.y - x.z * w.z,
                     F.n.y + (x.x + z.z) * w.y - y.x * w.x - y.z * w.z,
                     F.n.z + (x.x + y.y) * w.z - z.x * w.x - z.y * w.y);
    F.f = rbdi_b_cross_add(F.f, w, s->P);
    return F;
}

/* The moment of B' S: (tr(X) - X)' w + P x v of S = (w; v). */
RBDI_INLINE rbdi_b3 rbdi_subtree_B_t(const rbdi_sums *s, rbdi_bmotion S) {
    const rbdi_b3 x = s->Xx, y = s->Xy, z = s->Xz, w = S.omega;
    const rbdi_b3 n =
        rbdi_b_vec((y.y + z.z) * w.x - y.x * w.y - z.x * w.z, (x.x + z.z) * w.y - x.y * w.x - z.y * w.z,
                   (x.x + y.y) * w.z - x.z * w.x - y.z * w.y);

    return rbdi_b_cross_add(n, s->P, S.v);
}

/* F = I S and, if needed, T = B' S and D = B S + I U of a batch of dofs. */
RBDI_INLINE void rbdi_force_columns(rbdi_columns *cols, const rbdi_constants *own, int need) {
    const rbdi_sums *s = &cols->sum;
    const rbdi_bmotion S = cols->S;

    if (need & RBDI_NEED_V) {
        cols->T = rbdi_subtree_B_t(s, S);
        cols->D = rbdi_subtree_B_add(rbdi_inertia_times(s, own->subtree, cols->U), s, S.omega);
    }

    cols->F = rbdi_inertia_times(s, own->subtree, S);
}

/* Phi = A_p x S + V_p x Psi and E = B Psi + I Phi + S x* f of the dofs behind a free base, where
   S x* f = (S_omega x n + S_v x f; S_omega x f). */
RBDI_PART void rbdi_columns_by_q(rbd_derivatives *d) {
    for (int b = d->base ? d->behind : 0; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_sums *s = &cols->sum;
        const rbdi_bmotion S = cols->S, Phi = rbdi_b_motion_cross_add(rbdi_b_motion_cross(cols->A.p, S),
                                                                      cols->V.p, cols->Psi);
        const rbdi_bforce f = s->f;
        rbdi_bforce E =
            rbdi_subtree_B_add(rbdi_inertia_times(s, d->constants[b].subtree, Phi), s, cols->Psi.omega);

        E.n = rbdi_b_cross_add(rbdi_b_cross_add(E.n, S.omega, f.n), S.v, f.f);
        E.f = rbdi_b_cross_add(E.f, S.omega, f.f);

        cols->stage.by_q.Phi = Phi;
        cols->stage.by_q.E = E;
    }
}

/* The whole computation for one need, a constant unless at -Os: motion, then inertias, momenta and wrenches,
   their sums over subtrees, and the columns F, D and T. */
RBDI_INLINE void rbdi_common_of(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *q,
                                const rbd_real *v, const rbd_real *a, rbdi_c3 gravity, const rbd_real *f_ext,
                                int need, int whole) {
    rbdi_common_motion(m, d, base, q, v, a, gravity, need | whole);
    rbdi_own_sums(m, d, base, f_ext, need);
    rbdi_sum_subtrees(d, d->segment + (base > 0), need);

    for (int b = base ? d->behind : 0; b < d->batches; ++b)
        rbdi_force_columns(&d->columns[b], &d->constants[b], need);
}

/* The same for any need: q alone, C, the wrench alone, or all. With a free base the frame has its axes.
   Unless need has RBDI_NEED_WHOLE, the base's linear velocity and gravity are left out. */
RBDI_PART void rbdi_common(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                           const rbd_real *a, rbdi_c3 gravity, const rbd_real *f_ext, int need) {
    const int coriolis = RBDI_NEED_V | RBDI_NEED_CORIOLIS, all = RBDI_NEED_V | RBDI_NEED_WRENCH;
    const int base = d->base, whole = need & RBDI_NEED_WHOLE;
    need &= ~whole;

    if (RBDI_FOR_SPEED && !need)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, 0, 0);
    else if (RBDI_FOR_SPEED && need == coriolis)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, coriolis, 0);
    else if (RBDI_FOR_SPEED && need == RBDI_NEED_WRENCH)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, RBDI_NEED_WRENCH, whole);
    else
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, RBDI_FOR_SPEED ? all : need, whole);
}

/* The call's argument gravity without any. */
RBDI_INLINE rbdi_c3 rbdi_no_gravity(void) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    return none;
}

#endif
