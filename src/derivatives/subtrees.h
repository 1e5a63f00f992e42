#ifndef RBDI_DERIVATIVES_SUBTREES_H
#define RBDI_DERIVATIVES_SUBTREES_H
#include "derivatives/common_frame.h"

/* Sums so many components, from x on, over subtrees, for the segments from root on: at most 14 of the 27, for
   which there are registers. All dofs of a block get the sum of the block. Segments are taken one after the
   other: equal limbs as lanes, such as HyQ's legs, took more time. */
RBDI_INLINE void rbdi_sum_components(rbd_derivatives *d, const rbdi_segment *root, rbd_real *x, int count) {
    for (const rbdi_segment *seg = d->segment + d->segments - 1; seg >= root; --seg) {
        const rbdi_entry *e = d->entry + seg->end - 1, *first = d->entry + seg->first;
        const rbd_real *last = x + e->at;
        rbd_real sum[14], *out;
        RBDI_ONE_INDEX(last);
        RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) sum[j] = last[j * RBDI_BATCH];
        while (e > first) {
            out = x + (--e)->at;
            RBDI_ONE_INDEX(out);
            RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) out[j * RBDI_BATCH] = sum[j] =
                sum[j] + out[j * RBDI_BATCH];
        }
        for (e = first + 1; seg->block && e < d->entry + seg->end; ++e) {
            out = x + e->at;
            RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) out[j * RBDI_BATCH] = sum[j];
        }
        if (seg->parent < 0) continue;
        out = x + d->entry[seg->parent].at;
        RBDI_ONE_INDEX(out);
        RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) out[j * RBDI_BATCH] = out[j * RBDI_BATCH] + sum[j];
    }
}
RBDI_INLINE void rbdi_sum_subtrees(rbd_derivatives *d, const rbdi_segment *root, int need) {
    rbd_real *x = RBDI_FIELD(d, sum);
    if (!(need & RBDI_NEED_V)) {
        rbdi_sum_components(d, root, x, 9);
        if (need & RBDI_NEED_WRENCH) rbdi_sum_components(d, root, x + 21 * RBDI_BATCH, 6);
        return;
    }
    rbdi_sum_components(d, root, x, 14);
    rbdi_sum_components(d, root, x + 14 * RBDI_BATCH, need & RBDI_NEED_WRENCH ? 13 : 7);
}

/* I V of a subtree. */
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
/* F + B (w; any) = F + (G w / 2; w x P). */
RBDI_INLINE rbdi_bforce rbdi_subtree_B_add(rbdi_bforce F, const rbdi_sums *s, rbdi_b3 w) {
    const rbdi_b3 x = s->Xx, y = s->Xy, z = s->Xz;
    F.n = rbdi_b_vec(F.n.x + (y.y + z.z) * w.x - x.y * w.y - x.z * w.z,
                     F.n.y + (x.x + z.z) * w.y - y.x * w.x - y.z * w.z,
                     F.n.z + (x.x + y.y) * w.z - z.x * w.x - z.y * w.y);
    F.f = rbdi_b_cross_add(F.f, w, s->P);
    return F;
}
/* Moment of B' S. */
RBDI_INLINE rbdi_b3 rbdi_subtree_B_t(const rbdi_sums *s, rbdi_bmotion S) {
    const rbdi_b3 x = s->Xx, y = s->Xy, z = s->Xz, w = S.omega;
    const rbdi_b3 n =
        rbdi_b_vec((y.y + z.z) * w.x - y.x * w.y - z.x * w.z, (x.x + z.z) * w.y - x.y * w.x - z.y * w.z,
                   (x.x + y.y) * w.z - x.z * w.x - y.z * w.y);
    return rbdi_b_cross_add(n, s->P, S.v);
}
RBDI_INLINE rbdi_bforce rbdi_b_force_add(rbdi_bforce a, rbdi_bforce b) {
    a.n = rbdi_b_add(a.n, b.n);
    a.f = rbdi_b_add(a.f, b.f);
    return a;
}

/* Phi and E of the dofs behind a free base, from A_p and f. */
RBDI_PART void rbdi_columns_by_q(rbd_derivatives *d) {
    for (int b = d->base ? d->behind : 0; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        const rbdi_sums *s = &c->sum;
        const rbdi_bmotion S = c->S,
                           Phi = rbdi_b_motion_cross_add(rbdi_b_motion_cross(c->A.p, S), c->V.p, c->Psi);
        const rbdi_bforce f = s->f;
        rbdi_bforce E =
            rbdi_subtree_B_add(rbdi_inertia_times(s, d->constants[b].subtree, Phi), s, c->Psi.omega);
        E.n = rbdi_b_cross_add(rbdi_b_cross_add(E.n, S.omega, f.n), S.v, f.f);
        E.f = rbdi_b_cross_add(E.f, S.omega, f.f);
        c->stage.by_q.Phi = Phi, c->stage.by_q.E = E;
    }
}
/* F and, if needed, D and T of a batch of dofs. */
RBDI_INLINE void rbdi_force_columns(rbdi_columns *c, const rbdi_constants *own, int need) {
    const rbdi_sums *s = &c->sum;
    const rbdi_bmotion S = c->S;
    if (need & RBDI_NEED_V) {
        c->T = rbdi_subtree_B_t(s, S);
        c->D = rbdi_subtree_B_add(rbdi_inertia_times(s, own->subtree, c->U), s, S.omega);
    }
    c->F = rbdi_inertia_times(s, own->subtree, S);
}

/* Sweep towards the leaves: the motion of all dofs. Reads v, a and gravity only if need asks for them. */
RBDI_INLINE void rbdi_common_motion(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *q,
                                    const rbd_real *v, const rbd_real *a, rbdi_c3 gravity, int need) {
    rbdi_joints(m, d->work, rbdi_expand_q(m, d->work, q));
    if (base && need) d->V.omega = rbdi_load_vec(v, 1), d->V.v = d->up = rbdi_vec0();
    if (base && need & RBDI_NEED_WHOLE) {
        d->V.v = rbdi_load_vec(v + 3, 1);
        d->up = rbdi_sub(d->up, rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(gravity)));
    }
    rbdi_poses(m, d, base);
    rbdi_motion_columns(d, base ? d->behind : 0);
    if (need) rbdi_velocities(m, d, base, v, need);
    if (need & RBDI_NEED_WRENCH) rbdi_accelerations(m, d, base, a, gravity);
}

/* The first batch with a link's inertia, which the link's last dof has. */
RBDI_INLINE int rbdi_first_inertia(const rbd_derivatives *d, int base) {
    return base ? d->entry[base - 1].batch : 0;
}
/* Inertias, momenta and wrenches of the links, each alone. */
RBDI_INLINE void rbdi_own_sums(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *f_ext,
                               int need) {
    for (int b = rbdi_first_inertia(d, base); b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        rbdi_bmotion V;
        rbdi_sums s; /* not in place: what lies in memory is read again after every store */
        rbdi_own_inertia(c, own, &s);
        if (need) V = rbdi_b_motion_add(c->V.p, c->V.joint);
        if (need & RBDI_NEED_WRENCH) rbdi_own_wrench(V, rbdi_b_motion_add(c->A.p, c->A.joint), own, &s);
        if (need & RBDI_NEED_V)
            rbdi_own_momentum(need & RBDI_NEED_CORIOLIS ? V : rbdi_b_motion_add(V, V), own, &s);
        rbdi_store_sums(&s, need, &c->sum);
    }
    if (need & RBDI_NEED_WRENCH) rbdi_common_external(m, d, f_ext);
}

/* The whole computation for one need, a constant unless at -Os: motion, then inertias, momenta and wrenches,
   their sums over subtrees, and the columns F, D and T. */
RBDI_INLINE void rbdi_common_of(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *q,
                                const rbd_real *v, const rbd_real *a, rbdi_c3 gravity, const rbd_real *f_ext,
                                int need, int more) {
    rbdi_common_motion(m, d, base, q, v, a, gravity, need | more);
    rbdi_own_sums(m, d, base, f_ext, need);
    rbdi_sum_subtrees(d, d->segment + (base > 0), need);
    for (int b = base ? d->behind : 0; b < d->batches; ++b)
        rbdi_force_columns(&d->columns[b], &d->constants[b], need);
}

/* The same for any need: q alone, C, the wrench alone, or all. With a free base all is in the base's axes
   and, unless need has RBDI_NEED_WHOLE, at v = 0 of the base and without gravity. */
RBDI_PART void rbdi_common(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                           const rbd_real *a, rbdi_c3 gravity, const rbd_real *f_ext, int need) {
    const int coriolis = RBDI_NEED_V | RBDI_NEED_CORIOLIS, all = RBDI_NEED_V | RBDI_NEED_WRENCH;
    const int base = d->base, more = need & RBDI_NEED_WHOLE;
    need &= ~more;
    if (RBDI_FOR_SPEED && !need)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, 0, 0);
    else if (RBDI_FOR_SPEED && need == coriolis)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, coriolis, 0);
    else if (RBDI_FOR_SPEED && need == RBDI_NEED_WRENCH)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, RBDI_NEED_WRENCH, more);
    else
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, RBDI_FOR_SPEED ? all : need, more);
}

#endif
