#ifndef RBDI_DYNAMICS_CRBA_H
#define RBDI_DYNAMICS_CRBA_H
#include "api/dynamics.h"
#include "base/memory.h"
#include "model/calls.h"
#include "dynamics/state.h"

/* Interface: rbdi_crba_of_joints, rbdi_crba_up_block, rbdi_ratio, rbdi_source */

/* ---- crba [crba] ----
   RBDA table 6.2: I^c_i = I_i + sum over the children of X' I^c X; F = I^c_i S_i; H_ii = S_i' F; and for
   every j on the path to the root F = X' F, H_ij = F' S_j. Here the wrenches of all dofs of link i's subtree
   stand side by side, by component, in link i's frame: the entries of its dof with all of them are one
   component (the moment about z; of a screw two, of a block n). Then all take the step to the parent
   together, a batch at a time. Of I^c only Sigma and h depend on q: the subtree's mass is a constant. */

/* Composite body of a link, to the parent's axes and origin. */
RBDI_INLINE rbdi_rbi rbdi_rbi_up(const rbdi_link *l, int flags, rbdi_trig t, rbdi_rbi C) {
    if (flags & RBDI_SHIFT_Z) C = rbdi_rbi_shift_z(t.d, l->subtree_mass, C);
    C = rbdi_rbi_up_z(0, t.c, t.s, C);
    C = rbdi_rbi_up_z(flags, rbdi_set(l->ca), rbdi_set(l->sa), rbdi_rbi_cycle(C));
    if (!(flags & RBDI_SHIFT_R)) return rbdi_rbi_uncycle(C);
    if (!(flags & RBDI_SHIFT_XYZ))
        return rbdi_rbi_uncycle(rbdi_rbi_shift_z(rbdi_set(l->r.x), l->subtree_mass, C));

    C = rbdi_rbi_uncycle(C);
    if (flags & RBDI_BRANCH_TURN) C = rbdi_rbi_up_z(0, rbdi_set(l->cb), rbdi_set(l->sb), C);
    return rbdi_rbi_shift(rbdi_vec_c(l->r), l->subtree_mass, C);
}

RBDI_INLINE rbdi_rbi rbdi_rbi_up_block(const rbdi_pose *X, rbd_const mass, rbdi_rbi C) {
    C.Sigma = rbdi_sym_up(X->E, C.Sigma);
    C.h = rbdi_mul_t(X->E, C.h);
    return rbdi_rbi_shift(X->r, mass, C);
}

/* C plus the link's own body. */
RBDI_INLINE rbdi_rbi rbdi_rbi_add_link(const rbdi_link *l, rbdi_rbi C) {
    C.Sigma = rbdi_sym_add(C.Sigma, rbdi_sym_c(l->Sigma));
    C.h = rbdi_add(C.h, rbdi_vec_c(l->h));
    return C;
}

/* Wrench that gives the composite body C unit acceleration along spatial axis k: column k of
   [I [h]x; -[h]x mass], I = tr(Sigma) - Sigma. */
RBDI_INLINE rbdi_force rbdi_rbi_column(rbdi_rbi C, rbd_const subtree_mass, int k) {
    const rbd_real o = rbdi_zero(), mass = rbdi_set(subtree_mass);
    rbdi_force F;

    switch (k) {
    case 0:
        F.n = rbdi_vec(C.Sigma.yy + C.Sigma.zz, -C.Sigma.xy, -C.Sigma.xz);
        F.f = rbdi_vec(o, -C.h.z, C.h.y);
        break;
    case 1:
        F.n = rbdi_vec(-C.Sigma.xy, C.Sigma.xx + C.Sigma.zz, -C.Sigma.yz);
        F.f = rbdi_vec(C.h.z, o, -C.h.x);
        break;
    case 2:
        F.n = rbdi_vec(-C.Sigma.xz, -C.Sigma.yz, C.Sigma.xx + C.Sigma.yy);
        F.f = rbdi_vec(-C.h.y, C.h.x, o);
        break;
    case 3:
        F.n = rbdi_vec(o, C.h.z, -C.h.y);
        F.f = rbdi_vec(mass, o, o);
        break;
    case 4:
        F.n = rbdi_vec(-C.h.z, o, C.h.x);
        F.f = rbdi_vec(o, mass, o);
        break;
    default:
        F.n = rbdi_vec(C.h.y, -C.h.x, o);
        F.f = rbdi_vec(o, o, mass);
        break;
    }

    return F;
}

/* The same along the axis of a one-axis link: C S. */
RBDI_INLINE rbdi_force rbdi_rbi_axis(const rbdi_link *l, int slides, rbdi_rbi C) {
    rbdi_force own = rbdi_rbi_column(C, l->subtree_mass, 2);
    if (slides) {
        rbdi_force slide = rbdi_rbi_column(C, l->subtree_mass, 5);
        own.n = rbdi_add(rbdi_scale(rbdi_set(l->rho), own.n), rbdi_scale(rbdi_set(l->kappa), slide.n));
        own.f = rbdi_add(rbdi_scale(rbdi_set(l->rho), own.f), rbdi_scale(rbdi_set(l->kappa), slide.f));
    }
    return own;
}

/* Moves the wrenches of the dofs of link i's subtree to the parent's frame: those in w->F, and `own` of its
   own dof, which is not there yet. They are kept by component, so that a batch of them moves at once. Batches
   count from the last dof down. The last one may reach below the first dof, where nothing is set yet. `own`
   goes directly into the batch: to load a batch where scalars were just stored makes the processor wait. */
RBDI_INLINE void rbdi_crba_up(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                              rbdi_force own) {
    const rbdi_link *l = &m->link[i];
    const rbdi_trig t = rbdi_trig_of(m, w, i, flags);
#if RBDI_BATCH > 1
    rbd_real F[6];

    rbdi_store_force(F, 1, own);
    for (int k = l->end - RBDI_BATCH; k > l->first - RBDI_BATCH; k -= RBDI_BATCH) {
        rbdi_batch x[6];
        rbd_real *moment = &w->F[k], *force = moment + 3 * stride;

        RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) {
            x[j] = *(const rbdi_batch *)&moment[j * stride];
            x[j + 3] = *(const rbdi_batch *)&force[j * stride];
        }

        if (k <= l->first) {
            RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
                x[j] = rbdi_insert(x[j], l->first - k, F[j]);
        }

        rbdi_batch_up(l, flags, t, x);
        RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) {
            *(rbdi_batch *)&moment[j * stride] = x[j];
            *(rbdi_batch *)&force[j * stride] = x[j + 3];
        }
    }
#else
    rbdi_store_force(&w->F[l->first], stride, own);
    for (int k = l->first; k < l->end; ++k)
        rbdi_store_force(&w->F[k], stride, rbdi_force_up(l, flags, t, rbdi_load_force(&w->F[k], stride)));
#endif
}

RBDI_PART void rbdi_crba_up_block(const rbdi_pose *X, rbd_real *F, ptrdiff_t stride, int n) {
    for (int k = 0; k < n; ++k)
        rbdi_store_force(&F[k], stride, rbdi_force_up_block(X, rbdi_load_force(&F[k], stride)));
}

/* Where the entries of an ancestor dof k go: the column of packed rows at its depth, or row and column k of
   the full matrix. */
typedef struct rbdi_entries {
    int full, nv;
    rbd_real *H, *row, *column; /* packed: H, full: the others */
    const rbdi_order *order;
} rbdi_entries;

RBDI_INLINE rbdi_entries rbdi_crba_column(const rbd_model *m, int k, int depth, rbd_real *H, rbd_real *M) {
    rbdi_entries e;

    e.full = M != NULL;
    e.H = M ? NULL : H + depth;
    e.row = M ? M + (ptrdiff_t)k * m->nv : NULL;
    e.column = M ? M + k : NULL;
    e.order = m->order;
    e.nv = m->nv;
    return e;
}

/* Stores the entry of the solver's dof j. */
RBDI_INLINE void rbdi_crba_put(rbdi_entries e, int j, rbd_real x) {
    if (!e.full) {
        e.H[e.order[j].row] = x;
        return;
    }
    e.column[(ptrdiff_t)e.order[j].dof * e.nv] = x;
    e.row[e.order[j].dof] = x;
}

/* Block link: the wrenches F that unit accelerations of its own n dofs take, and the entries S' F of these
   and of all dofs of its subtree. */
RBDI_INLINE void rbdi_crba_entries_block(const rbd_model *m, const rbd_work *w, const rbdi_link *l, int first,
                                         int n, ptrdiff_t stride, rbdi_rbi C, rbd_real *H, rbd_real *M) {
    const int iv = l->iv, depth = m->dof[iv].level;
    const rbd_real *F = &w->F[stride * first];

    RBDI_UNROLL_SIX for (int k = 0; k < n; ++k) {
        const rbdi_force own = rbdi_rbi_column(C, l->subtree_mass, first + k);
        rbd_real all[6];
        rbdi_store_force(all, 1, own);
        if (!rbdi_on_world(l)) rbdi_store_force(&w->F[l->first + k], stride, own);
        all[first + k] = all[first + k] + m->dof[iv + k].armature;
        RBDI_UNROLL_SIX for (int j = 0; j <= k; ++j)
            rbdi_crba_put(rbdi_crba_column(m, iv + j, depth + j, H, M), l->first + k, all[first + j]);
    }

    for (int j = l->first + n; j < l->end; ++j) {
        RBDI_UNROLL_SIX for (int k = 0; k < n; ++k)
            rbdi_crba_put(rbdi_crba_column(m, iv + k, depth + k, H, M), j, F[stride * k + j]);
    }
}

/* One-axis link: the entries of its own dof, whose wrench is `own`, and of all others of its subtree. */
RBDI_INLINE void rbdi_crba_entries(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                                   rbdi_force own, rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const rbdi_dof *dof = &m->dof[l->iv];
    const rbdi_entries e = rbdi_crba_column(m, l->iv, dof->level, H, M);
    const rbd_real *n_z = &w->F[2 * stride], *f_z = &w->F[5 * stride];
    rbd_real D = rbdi_along_axis(l, flags, own);

    if (flags & (RBDI_SLIDES | RBDI_ARMATURE)) D = D + dof->armature;
    rbdi_crba_put(e, l->first, D);

    for (int j = l->first + 1; j < l->end; ++j) {
        rbd_real x = n_z[j];
        if (flags & RBDI_SLIDES) x = x * l->rho + f_z[j] * l->kappa;
        rbdi_crba_put(e, j, x);
    }
}

/* The rows and columns of one link's dofs; its composite body and all wrenches of its subtree, to the
   parent's axes and origin. */
RBDI_INLINE rbdi_rbi rbdi_crba_axis(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                                    rbdi_rbi C, rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const rbdi_force own = rbdi_rbi_axis(l, flags & RBDI_SLIDES, C);
    rbdi_crba_entries(m, w, i, flags, stride, own, H, M);
    if (flags & RBDI_ROOT) return C;
    rbdi_crba_up(m, w, i, flags, stride, own);
    return rbdi_rbi_up(l, flags, rbdi_trig_of(m, w, i, flags), C);
}

RBDI_PART void rbdi_crba_block(const rbd_model *m, const rbd_work *w, int i, ptrdiff_t stride, rbdi_rbi *C,
                               rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block *b = rbdi_block_of(m, l);
    const ptrdiff_t usual = RBDI_FIXED_STRIDE ? RBDI_FIXED_STRIDE : stride; /* known to the compiler */

    if (b->n < 6 || stride != usual)
        rbdi_crba_entries_block(m, w, l, b->first, b->n, stride, *C, H, M);
    else if (M)
        rbdi_crba_entries_block(m, w, l, 0, 6, usual, *C, NULL, M);
    else
        rbdi_crba_entries_block(m, w, l, 0, 6, usual, *C, H, NULL);

    if (rbdi_on_world(l)) return;

    rbdi_crba_up_block(&w->block[l->block].X, &w->F[l->first], stride, l->end - l->first);
    *C = rbdi_rbi_up_block(&w->block[l->block].X, l->subtree_mass, *C);
}

/* One step of the sweep leaf to root: takes the composite body carried from link i + 1, returns the one that
   link i passes to link i - 1. */
RBDI_INLINE rbdi_rbi rbdi_crba_step(const rbd_model *m, const rbd_work *w, int i, int flags, ptrdiff_t stride,
                                    rbdi_rbi carried, rbd_real *H, rbd_real *M) {
    const rbdi_link *l = &m->link[i];
    const int off_chain = flags & RBDI_OFF_CHAIN;
    rbdi_rbi C = rbdi_rbi_add_link(l, carried);

    if (off_chain && l->branch >= 0) C = rbdi_rbi_add(C, w->branch[l->branch].C);
    if (rbdi_block_link(l, flags)) {
        rbdi_rbi block = C; /* an address of C would keep it in memory */
        rbdi_crba_block(m, w, i, stride, &block, H, M);
        C = block;
    } else {
        C = rbdi_crba_axis(m, w, i, flags, stride, C, H, M);
    }
    if (!off_chain || l->parent == i - 1) return C;

    if (l->parent >= 0) {
        rbdi_branch *branch = &w->branch[m->link[l->parent].branch];
        branch->C = rbdi_rbi_add(branch->C, C);
    }
    return rbdi_rbi_zero();
}

/* The same with flags and stride that the compiler does not know: for models of more dofs than
   RBDI_FIXED_STRIDE. */
RBDI_PART void rbdi_crba_link(const rbd_model *m, const rbd_work *w, int i, ptrdiff_t stride,
                              rbdi_rbi *carried, rbd_real *H, rbd_real *M) {
    *carried = rbdi_crba_step(m, w, i, rbdi_flags(&m->link[i]), stride, *carried, H, M);
}

/* RBDA table 6.2, into the packed tree matrix H or, if M is given, into the full matrix, which is zero
   before. With mimic joints into H and the rows behind it, which rbdi_reduce_H adds up. `full` is M != NULL,
   known to the compiler: at -Os the full matrix has code for common flags, which saves a fifth of its
   instructions. The packed one has none: there it is a part of larger calls. */
RBDI_INLINE void rbdi_crba(const rbd_model *m, rbd_work *w, rbd_real *H, rbd_real *M, int full) {
    const rbd_model model = *m; /* copies, which no store into H or w->F can be thought to change */
    const rbd_work work = *w;
    const ptrdiff_t stride = rbdi_stride(m), usual = RBDI_FIXED_STRIDE ? RBDI_FIXED_STRIDE : stride;
    rbdi_rbi carried = rbdi_rbi_zero(), any = carried; /* an address of carried would keep it in memory */

    for (int i = 0; i < m->nbranch; ++i) w->branch[i].C = carried;

    /* more dofs than the fixed stride is for */
    for (int i = m->nl - 1; RBDI_FIXED_STRIDE && stride != RBDI_FIXED_STRIDE && i >= 0; --i)
        rbdi_crba_link(&model, &work, i, stride, &any, H, M);
    if (RBDI_FIXED_STRIDE && stride != RBDI_FIXED_STRIDE) return;

    for (int i = m->nl - 1; i >= 0; --i)
        if (RBDI_FOR_SPEED || full)
            RBDI_BY_FLAGS_OF(RBDI_CASES, const int flags, &model.link[i],
                             carried = rbdi_crba_step(&model, &work, i, flags, usual, carried, H, M));
        else
            RBDI_BY_FLAGS_OF(RBDI_NO_CASES, const int flags, &model.link[i],
                             carried = rbdi_crba_step(&model, &work, i, flags, usual, carried, H, M));
}

/* The dof whose velocity dof k has, itself unless it mimics, and its ratio to that. */
RBDI_INLINE int rbdi_source(const rbd_model *m, int k) {
    return k < m->nv ? k : m->mimic[k - m->nv].source_v;
}

RBDI_INLINE rbd_real rbdi_ratio(const rbd_model *m, int k) {
    return rbdi_set(k < m->nv ? RBD_C(1) : m->mimic[k - m->nv].ratio);
}

/* With mimic joints M = G' M_x G for v_x = G v: adds M_x, whose rows stand behind H, to H, which is zero. Off
   its diagonal M_x has every entry twice. */
RBDI_PART void rbdi_reduce_H(const rbd_model *m, rbd_real *H) {
    for (int s = 0; s < m->nv + rbdi_mimics(m); ++s) {
        const int i = m->order[s].dof, a = rbdi_source(m, i);
        const rbd_real *h = &H[m->order[s].row + m->dof[i].level], k = rbdi_ratio(m, i);

        rbd_real *diagonal = &H[m->dof[a].row + m->dof[a].depth];

        *diagonal = *diagonal + *h * k * k;
        for (int j = m->dof[i].before; j >= 0; j = m->dof[j].before) {
            const int b = rbdi_source(m, j);
            rbd_real *entry = &H[m->dof[a > b ? a : b].row + m->dof[a > b ? b : a].depth], x;
            --h;
            x = *h * k;
            if (j >= m->nv) x = x * rbdi_ratio(m, j);
            *entry = *entry + (a == b ? x + x : x);
        }
    }
}

/* M packed, from the joints' transforms. */
RBDI_PART void rbdi_crba_of_joints(const rbd_model *m, rbd_work *w, rbd_real *H) {
    const int mimics = rbdi_mimics(m);

    if (mimics) rbdi_clear(w->H, m->nh);
    rbdi_crba(m, w, mimics ? w->H : H, NULL, 0);
    if (!mimics) return;

    rbdi_reduce_H(m, w->H);
    for (int k = 0; k < m->nh; ++k) H[k] = w->H[k];
}

RBDI_API rbd_status rbd_crba_packed(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *H) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && H);
    if (status) return status;
    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    rbdi_crba_of_joints(m, w, H);
    return RBD_OK;
}

RBDI_API rbd_status rbd_crba(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *M) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && M);
    if (status) return status;

    if (m->nh < m->nv * (m->nv + 1) / 2) rbdi_clear(M, m->nv * m->nv);
    if (rbdi_mimics(m)) {
        rbd_crba_packed(m, w, q, w->H);
        for (int i = 0; i < m->nv; ++i)
            for (int j = i, k = m->dof[i].row + m->dof[i].depth; j >= 0; j = m->dof[j].lambda, --k)
                M[i * m->nv + j] = M[j * m->nv + i] = w->H[k];
        return RBD_OK;
    }

    rbdi_joints(m, w, q);
    rbdi_crba(m, w, NULL, M, 1);
    return RBD_OK;
}

RBDI_API int rbd_packed_size(const rbd_model *m) { return m ? m->nh : 0; }

RBDI_API int rbd_packed_index(const rbd_model *m, int i, int j) {
    int row = i > j ? i : j, column = i > j ? j : i, t;
    if (!m || column < 0 || row >= m->nv) return -1;
    t = m->dof[row].depth;
    for (int k = row; k >= column; k = m->dof[k].lambda, --t)
        if (k == column) return m->dof[row].row + t;
    return -1;
}

#endif
