#ifndef RBDI_DERIVATIVES_BASE_ENTRIES_H
#define RBDI_DERIVATIVES_BASE_ENTRIES_H
#include "derivatives/subtrees.h"
#include "derivatives/entries.h"

/* ---- entries of a free base [base entries] ----
   The frame has the axes of the base, and the S of its dofs are unit vectors. So the entries of its rows are
   components of F_j, D_j, E_j. With the velocity (w; v) of the base, its turn theta, the world's acceleration
   minus_g, and (n; f) = F_j, its dofs have

       U = (w; -v) x S,   Phi = (0; minus_g x S_omega)

   and the base's columns of the other rows are

       dtau_j/dw = T_j + n_j x w - f_j x v
       dtau_j/dv = f_j x w
       dtau_j/dtheta = f_j x minus_g

   The position of the base has no effect. Without this, derivatives of inverse dynamics take 50 % more
   instructions for HyQ, 17 % for Atlas. */

/* The wanted columns F, D, E of a free base's dofs, with the sums of the whole tree:

       F = I S,   D = B S + I U,   E = I Phi = (h x Phi_v; m Phi_v) */
RBDI_INLINE void rbdi_base_columns(const rbd_derivatives *d, int want) {
    const int last = d->base - 1;
    const rbdi_b3 minus_g = rbdi_b_all(d->minus_g);
    rbdi_bmotion V;
    rbdi_sums s;
    V.omega = rbdi_b_all(d->V.omega);
    V.v = rbdi_b_all(rbdi_sub(rbdi_vec0(), d->V.v));

    /* the sums in all lanes */
    s.xx = rbdi_all_lanes(*RBDI_OF(d, last, sum.xx));
    s.xy = rbdi_all_lanes(*RBDI_OF(d, last, sum.xy));
    s.xz = rbdi_all_lanes(*RBDI_OF(d, last, sum.xz));
    s.yy = rbdi_all_lanes(*RBDI_OF(d, last, sum.yy));
    s.yz = rbdi_all_lanes(*RBDI_OF(d, last, sum.yz));
    s.zz = rbdi_all_lanes(*RBDI_OF(d, last, sum.zz));
    s.h = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.h), RBDI_BATCH));
    if (want & RBDI_WANT_V) {
        s.Xx = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.Xx), RBDI_BATCH));
        s.Xy = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.Xy), RBDI_BATCH));
        s.Xz = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.Xz), RBDI_BATCH));
        s.P = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.P), RBDI_BATCH));
    }

    for (int b = 0; b < d->behind; ++b) {
        const rbdi_cbatch mass = d->constants[b].subtree;
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion S = cols->S;
        const rbdi_b3 Phi_v = rbdi_b_cross(minus_g, S.omega);

        if (want & RBDI_WANT_M) cols->F = rbdi_inertia_times(&s, mass, S);
        if (want & RBDI_WANT_V)
            cols->D =
                rbdi_subtree_B_add(rbdi_inertia_times(&s, mass, rbdi_b_motion_cross(V, S)), &s, S.omega);
        if (want & RBDI_WANT_Q) {
            cols->stage.by_q.E.n = rbdi_b_cross(s.h, Phi_v);
            cols->stage.by_q.E.f = rbdi_b_vec(Phi_v.x * mass, Phi_v.y * mass, Phi_v.z * mass);
        }
    }
}

/* Stores n components of a field of all dofs as rows of a matrix. x: the first scalar of the field in
   d->columns. A batch may overwrite the beginning of the next row, which is stored later, but does not pass
   end, the number of the matrix's entries. Only the last row compares with it, so that two rows must not be
   shorter than a batch. */
RBDI_INLINE void rbdi_put_components(const rbd_derivatives *d, const rbd_real *x, int n, ptrdiff_t end,
                                     rbd_real *out) {
    const ptrdiff_t nv = d->model->nv, base = d->base, behind = d->behind;

    for (ptrdiff_t b = d->batches - 1; b >= behind; --b) {
        const rbdi_batch *in = (const rbdi_batch *)x + b * RBDI_COLUMN_SIZE;
        rbd_real *to = out + base + (b - behind) * RBDI_BATCH;

        RBDI_UNROLL_SIX for (int k = 0; k < n; ++k, to += nv) {
            if (RBDI_BATCH == 1 || k < n - 1 || to - out <= end - RBDI_BATCH)
                *(rbdi_batch *)to = in[k];
            else
                rbdi_copy((const rbd_real *)&in[k], (int)(end - (to - out)), to);
        }
    }

    if (!base) return;
    for (int k = 0; k < n; ++k, x += RBDI_BATCH, out += nv) {
        RBDI_UNROLL_SIX for (int j = 0; j < 6; j += RBDI_BATCH)
            rbdi_copy_batch(&x[j * RBDI_COLUMN_SIZE], 6 - j, &out[j]);
    }
}

/* Stores (n; f) of a batch of dofs as the base's columns of their rows. */
RBDI_INLINE void rbdi_put_base_columns(const rbd_derivatives *d, int b, rbdi_b3 n, rbdi_b3 f, rbd_real *out) {
    const rbdi_batch x[6] = {n.x, n.y, n.z, f.x, f.y, f.z};
    const ptrdiff_t nv = d->model->nv, first = d->base + (b - d->behind) * RBDI_BATCH;

    out += first * nv;
    RBDI_UNROLL_SIX for (int k = 0; k < RBDI_BATCH; ++k) {
        if (k < nv - first) {
            RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
                out[k * nv + j] = ((const rbd_real *)&x[j])[k];
        }
    }
}

/* The base's columns of the rows of all other dofs. */
RBDI_INLINE void rbdi_put_base(const rbd_derivatives *d, int want, rbdi_wanted out) {
    const rbdi_b3 w = rbdi_b_all(d->V.omega), minus_v = rbdi_b_all(rbdi_sub(rbdi_vec0(), d->V.v)),
                  minus_g = rbdi_b_all(d->minus_g);

    for (int b = d->behind; b < d->batches; ++b) {
        const rbdi_b3 T = d->columns[b].T;
        const rbdi_bforce F = d->columns[b].F;

        if (want & RBDI_WANT_M) rbdi_put_base_columns(d, b, F.n, F.f, out.at[RBDI_MASS]);
        if (want & RBDI_WANT_V)
            rbdi_put_base_columns(d, b, rbdi_b_cross_add(rbdi_b_cross_add(T, F.n, w), F.f, minus_v),
                                  rbdi_b_cross(F.f, w), out.at[RBDI_BY_V]);
        if (want & RBDI_WANT_Q)
            rbdi_put_base_columns(d, b, rbdi_b_cross(F.f, minus_g), rbdi_b_all(rbdi_vec0()),
                                  out.at[RBDI_BY_Q]);
    }
}

/* For rbd_fd_derivatives, which leaves out v of the base and gravity: of the base's columns only the three
   by w are not 0. They take places of the others, so that both matrices are solved from the same column on:

       both matrices   by_v[4], by_v[5], by_q[5]   solved from column 4 on, by_q[4] for nothing
       by_v alone      by_v[3], by_v[4], by_v[5]   from column 3 on
       by_q alone      none                        from column 6 on

   turn: where the three columns begin. */
RBDI_INLINE void rbdi_place_turns(rbd_real *by_q, rbd_real *by_v, rbd_real *turn[3]) {
    turn[0] = by_v + (by_q ? 4 : 3);
    turn[1] = turn[0] + 1;
    turn[2] = by_q ? by_q + 5 : by_v + 5;
}

/* The first column to solve for; without a base all are. */
RBDI_INLINE int rbdi_first_solved(const rbd_derivatives *d, const rbd_real *by_q, const rbd_real *by_v) {
    if (!d->base) return 0;
    if (!by_v) return 6;
    return by_q ? 4 : 3;
}

/* Stores the three columns by w: of the base's rows D, of the others T + n x w. */
RBDI_PART void rbdi_put_turns(const rbd_derivatives *d, rbd_real *by_q, rbd_real *by_v) {
    const ptrdiff_t nv = d->model->nv;
    const rbdi_b3 w = rbdi_b_all(d->V.omega);
    ptrdiff_t row = d->base * nv;
    rbd_real *turn[3];
    if (!by_v) return;

    rbdi_place_turns(by_q, by_v, turn);

    /* rows of the base */
    for (int j = 0; j < 3; ++j) rbdi_store_force(turn[j], nv, rbdi_load_force(RBDI_OF(d, j, D), RBDI_BATCH));

    /* the other rows */
    for (int b = d->behind; b < d->batches; ++b) {
        const rbdi_b3 column = rbdi_b_cross_add(d->columns[b].T, d->columns[b].F.n, w);
        const rbd_real *x = (const rbd_real *)&column;
        for (int k = 0; k < RBDI_BATCH && row < nv * nv; ++k, row += nv)
            for (int j = 0; j < 3; ++j) turn[j][row] = x[j * RBDI_BATCH + k];
    }
}

/* ---- matrices [matrices] ---- */

/* All entries of the wanted matrices: results, or right-hand sides in rbd_fd_derivatives. */
RBDI_PART void rbdi_put_entries(const rbd_model *m, const rbd_derivatives *d, rbd_real *by_q, rbd_real *by_v,
                                rbd_real *M, int results) {
    const int want = (by_q ? RBDI_WANT_Q : 0) | (by_v ? RBDI_WANT_V : 0) | (M ? RBDI_WANT_M : 0);
    const int zeros = !results || !d->keep_zeros;
    const int branched = m->nh < m->nv * (m->nv + 1) / 2;
    rbdi_wanted out;
    out.at[RBDI_BY_Q] = by_q;
    out.at[RBDI_BY_V] = by_v;
    out.at[RBDI_MASS] = M;

    /* unless every entry is written: batches go into whole rows */
    if (rbdi_mimics(m) || (RBDI_BATCH == 1 && zeros && (m->nblock || branched)))
        for (int r = 0; r < RBDI_RESULTS; ++r)
            if (out.at[r]) rbdi_clear(out.at[r], m->nv * m->nv);

    /* the rows of a free base */
    if (d->base) {
        rbdi_base_columns(d, want);
        if (by_q) rbdi_put_components(d, RBDI_FIELD(d, stage.by_q.E), 6, PTRDIFF_MAX, by_q);
        if (by_v) rbdi_put_components(d, RBDI_FIELD(d, D), 6, PTRDIFF_MAX, by_v);
        if (M) rbdi_put_components(d, RBDI_FIELD(d, F), 6, PTRDIFF_MAX, M);
    }

    /* the other rows: the most common of `want` as constants */
    if (RBDI_FOR_SPEED && want == (RBDI_WANT_Q | RBDI_WANT_V))
        rbdi_put_rows(d, RBDI_WANT_Q | RBDI_WANT_V, zeros, out);
    else if (RBDI_FOR_SPEED && want == RBDI_WANT_V)
        rbdi_put_rows(d, RBDI_WANT_V, zeros, out);
#if RBDI_BATCH > 1
    else if (RBDI_FOR_SPEED && want == (RBDI_WANT_Q | RBDI_WANT_V | RBDI_WANT_M))
        rbdi_put_rows(d, RBDI_WANT_Q | RBDI_WANT_V | RBDI_WANT_M, zeros, out);
#endif
    else
        rbdi_put_rows(d, want, zeros, out);

    if (d->base && results) rbdi_put_base(d, want, out);
    if (by_q) rbdi_put_block_entries(d, by_q);
    if (M) rbdi_add_armature(d, M);
}

#endif
