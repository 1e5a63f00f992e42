#ifndef RBDI_DERIVATIVES_ENTRIES_H
#define RBDI_DERIVATIVES_ENTRIES_H
#include "dynamics/crba.h"
#include "derivatives/subtrees.h"

/* ---- entries [entries] ----
   For dof j and every dof i of an ancestor link, or of j's own link if not said otherwise:

       M_ij = S_i' F_j                M_ji = M_ij
       dtau_i/dv_j = S_i' D_j         dtau_j/dv_i = T_j' S_i + F_j' U_i
       dtau_i/dq_j = S_i' E_j         dtau_j/dq_i = T_j' Psi_i + F_j' Phi_i

   and 0 for dofs of different branches. Within a joint the axes of i do not turn with those of j: there
   dtau_i/dq_j is the second formula of the last line with i and j exchanged. C is as dtau/dv, from halved
   columns. Rows are computed one at a time, with dofs as lanes: the entries of dofs on the path to dof i by
   the formulas on the right, those of dofs in its subtree by the formulas on the left. */

/* S' F. */
RBDI_INLINE rbd_real rbdi_power(rbdi_motion S, rbdi_force F) {
    return rbdi_dot(S.omega, F.n) + rbdi_dot(S.v, F.f);
}

/* The caller's matrices: derivatives by q and by v (or C), and M. Bits for those that are wanted. */
enum { RBDI_BY_Q, RBDI_BY_V, RBDI_MASS, RBDI_RESULTS };
enum { RBDI_WANT_Q = 1 << RBDI_BY_Q, RBDI_WANT_V = 1 << RBDI_BY_V, RBDI_WANT_M = 1 << RBDI_MASS };
typedef struct rbdi_wanted {
    rbd_real *at[RBDI_RESULTS];
} rbdi_wanted;

/* a' x of a batch of vectors a and one vector x, and with c added. */
RBDI_INLINE rbdi_batch rbdi_b_dot(rbdi_b3 a, rbdi_v3 x) { return a.x * x.x + a.y * x.y + a.z * x.z; }
RBDI_INLINE rbdi_batch rbdi_b_dot_add(rbdi_batch c, rbdi_b3 a, rbdi_v3 x) {
    return c + a.x * x.x + a.y * x.y + a.z * x.z;
}
/* S' F of a batch of motions and one force, and of a batch of forces and one motion. */
RBDI_INLINE rbdi_batch rbdi_b_motion_dot(rbdi_bmotion S, rbdi_force F) {
    return rbdi_b_dot_add(rbdi_b_dot(S.omega, F.n), S.v, F.f);
}
RBDI_INLINE rbdi_batch rbdi_b_force_dot(rbdi_bforce F, rbdi_motion S) {
    return rbdi_b_dot_add(rbdi_b_dot(F.n, S.omega), F.f, S.v);
}

/* Entries of a dof, whose columns are F and T, with a batch of dofs on its path. */
RBDI_INLINE void rbdi_entries_before(const rbdi_columns *c, int want, rbdi_force F, rbdi_v3 T,
                                     rbdi_batch y[RBDI_RESULTS]) {
    if (want & RBDI_WANT_Q)
        y[RBDI_BY_Q] = rbdi_b_dot(c->Psi.omega, T) + rbdi_b_motion_dot(c->stage.by_q.Phi, F);
    if (want & RBDI_WANT_V) y[RBDI_BY_V] = rbdi_b_dot(c->S.omega, T) + rbdi_b_motion_dot(c->U, F);
    if (want & RBDI_WANT_M) y[RBDI_MASS] = rbdi_b_motion_dot(c->S, F);
}
/* Entries of a dof, whose column is S, with a batch of dofs in its subtree. */
RBDI_INLINE void rbdi_entries_behind(const rbdi_columns *c, int want, rbdi_motion S,
                                     rbdi_batch y[RBDI_RESULTS]) {
    if (want & RBDI_WANT_Q) y[RBDI_BY_Q] = rbdi_b_force_dot(c->stage.by_q.E, S);
    if (want & RBDI_WANT_V) y[RBDI_BY_V] = rbdi_b_force_dot(c->D, S);
    if (want & RBDI_WANT_M) y[RBDI_MASS] = rbdi_b_force_dot(c->F, S);
}

/* Adds the entries y of two dofs, which are `stride` apart, to those of the joints that they follow: with
   mimic joints a result is G' (.) G, G = dv/dv of all joints by those of the caller. */
RBDI_PART void rbdi_add_entry(const rbd_model *m, const rbdi_entry *row, const rbdi_entry *column,
                              const rbd_real *y, ptrdiff_t stride, rbdi_wanted out) {
    const rbd_real ratio = rbdi_ratio(m, row->source) * rbdi_ratio(m, column->source);
    for (int r = 0; r < RBDI_RESULTS; ++r) {
        rbd_real *to = out.at[r] ? out.at[r] + row->row + column->user : NULL;
        if (to) *to = *to + y[r * stride] * ratio;
    }
}

#if RBDI_BATCH > 1
/* Length of a dof's three lists, which follow one another. */
RBDI_INLINE int rbdi_relatives_length(const rbd_derivatives *d) { return d->batches - d->behind + 3; }
RBDI_INLINE rbdi_relatives *rbdi_relatives_of(const rbd_derivatives *d, int i) {
    return d->relatives + d->entry[i].source * rbdi_relatives_length(d);
}

/* Mask of the lanes whose bits begin at first. */
RBDI_INLINE rbdi_bits rbdi_lanes_of(const rbdi_relatives *rel, int first) {
    rbdi_bits lanes;
    for (int j = 0; j < RBDI_BATCH; ++j) lanes[j] = (rbdi_bit)1 << (first + j);
    return (rbdi_bits)((lanes & (rbdi_bit)rel->lanes) == lanes); /* no table: loads take the time here */
}
/* Stores the wanted entries of a batch into a row, 0 in the other lanes. */
RBDI_INLINE void rbdi_put_lanes(const rbdi_batch *y, rbdi_bits lanes, int want, rbdi_wanted row,
                                ptrdiff_t at) {
    RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
        if (want >> r & 1) *(rbdi_batch *)(row.at[r] + at) = (rbdi_batch)((rbdi_bits)y[r] & lanes);
    }
}

/* The row of the dof at e, from the columns behind a free base on: the batches of its relatives. */
RBDI_INLINE void rbdi_put_row(const rbdi_columns *columns, const rbdi_entry *e, const rbdi_relatives *rel,
                              int want, rbdi_wanted row) {
    const rbd_real *own = (const rbd_real *)columns + e->at;
    const rbdi_batch zero = rbdi_zero_batch();
    rbdi_batch y[RBDI_RESULTS] = {zero, zero, zero}, z[RBDI_RESULTS] = {zero, zero, zero};
    if (rel->batch >= 0) {
        const rbdi_force F = rbdi_load_force(own + RBDI_PLACE(F), RBDI_BATCH);
        const rbdi_v3 T = rbdi_load_vec(own + RBDI_PLACE(T), RBDI_BATCH);
        do {
            rbdi_entries_before(columns + rel->batch, want, F, T, y);
            rbdi_put_lanes(y, rbdi_lanes_of(rel, RBDI_ON_PATH), want, row, rel->row);
        } while ((++rel)->batch >= 0);
    }
    for (++rel; rel->batch >= 0; ++rel) {
        const rbdi_columns *c = columns + rel->batch;
        const rbdi_force F = rbdi_load_force(own + RBDI_PLACE(F), RBDI_BATCH);
        const rbdi_v3 T = rbdi_load_vec(own + RBDI_PLACE(T), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(own + RBDI_PLACE(S), RBDI_BATCH);
        const rbdi_bits before = rbdi_lanes_of(rel, RBDI_ON_PATH),
                        behind = rbdi_lanes_of(rel, RBDI_IN_SUBTREE);
        rbdi_entries_before(c, want, F, T, y);
        rbdi_entries_behind(c, want, S, z);
        RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
            if (want >> r & 1) y[r] = (rbdi_batch)(((rbdi_bits)y[r] & before) | ((rbdi_bits)z[r] & behind));
            if (want >> r & 1) *(rbdi_batch *)(row.at[r] + rel->row) = y[r];
        }
    }
    if ((++rel)->batch >= 0) {
        const rbdi_motion S = rbdi_load_motion(own + RBDI_PLACE(S), RBDI_BATCH);
        do {
            rbdi_entries_behind(columns + rel->batch, want, S, y);
            rbdi_put_lanes(y, rbdi_lanes_of(rel, RBDI_IN_SUBTREE), want, row, rel->row);
        } while ((++rel)->batch >= 0);
    }
}
RBDI_INLINE void rbdi_clear_row(int n, int want, rbdi_wanted row) {
    const rbdi_batch zero = rbdi_zero_batch();
    for (int k = 0; k < n; k += RBDI_BATCH) RBDI_UNROLL_SIX
        for (int r = 0; r < RBDI_RESULTS; ++r)
            if (want >> r & 1) *(rbdi_batch *)(row.at[r] + k) = zero;
}

/* Stores the rows of all dofs behind a free base. The last batch of a row may overwrite the beginning of
   the next row, which is stored later, as are the columns of a base. A row whose last batch would pass the
   end of the matrix is computed in scratch memory and copied. */
RBDI_INLINE void rbdi_put_rows_in_place(const rbd_derivatives *d, int want, int zeros, rbdi_wanted out) {
    const int base = d->base, n = d->n - base, last = d->n * d->n - (d->batches - d->behind) * RBDI_BATCH;
    const ptrdiff_t length = rbdi_relatives_length(d), stride = rbdi_stride(d->model);
    const rbdi_columns *columns = d->columns; /* copies: the compiler cannot know that no store changes d */
    const rbdi_entry *entry = d->entry;
    const rbdi_relatives *list = d->relatives + base * length;
    rbd_real *spare = d->work->F;
    for (const rbdi_entry *p = entry + base, *end = entry + d->n; p < end; ++p, list += length) {
        const rbdi_entry *e = entry + p->of_source;
        const int at = e->row + base, fits = at <= last;
        rbdi_wanted row = out;
        RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
            if (want >> r & 1) row.at[r] = fits ? out.at[r] + at : spare + r * stride;
        }
        if (!list->whole && (zeros || !fits)) rbdi_clear_row(n, want, row);
        rbdi_put_row(columns, e, list, want, row);
        if (fits) continue;
        RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
            if (want >> r & 1) rbdi_copy(row.at[r], n, out.at[r] + at);
        }
    }
}
/* The same with mimic joints: entries are added to those of the sources. */
RBDI_PART void rbdi_add_rows(const rbd_derivatives *d, int want, rbdi_wanted out) {
    const ptrdiff_t stride = rbdi_stride(d->model);
    const rbd_real *x = d->work->F;
    rbdi_wanted row = out;
    for (int r = 0; r < RBDI_RESULTS; ++r) row.at[r] = d->work->F + r * stride;
    for (int i = 0; i < d->n; ++i) {
        const rbdi_entry *e = d->entry + i;
        rbdi_put_row(d->columns, e, rbdi_relatives_of(d, i), want, row);
        for (int k = e->parent; k >= 0; k = d->entry[k].parent)
            rbdi_add_entry(d->model, e, d->entry + k, x + d->entry[k].source, stride, out);
        for (int k = i; k < e->end; ++k)
            rbdi_add_entry(d->model, e, d->entry + k, x + d->entry[k].source, stride, out);
    }
}
RBDI_INLINE void rbdi_put_rows(const rbd_derivatives *d, int want, int zeros, rbdi_wanted out) {
    if (rbdi_mimics(d->model))
        rbdi_add_rows(d, want, out);
    else
        rbdi_put_rows_in_place(d, want, zeros, out);
}
#else
/* Stores or, with mimic joints, adds the entries y of two dofs. */
RBDI_INLINE void rbdi_put_entry(const rbd_model *m, const rbdi_entry *row, const rbdi_entry *column, int want,
                                const rbd_real *y, rbdi_wanted out) {
    if (rbdi_mimics(m))
        rbdi_add_entry(m, row, column, y, 1, out);
    else RBDI_UNROLL_SIX
        for (int r = 0; r < RBDI_RESULTS; ++r)
            if (want >> r & 1) (out.at[r] + row->row)[column->user] = y[r];
}
RBDI_INLINE void rbdi_put_rows(const rbd_derivatives *d, int want, int zeros, rbdi_wanted out) {
    const rbdi_entry *e = d->entry;
    const rbd_real o = rbdi_zero();
    (void)zeros; /* they are there */
    for (int i = d->base; i < d->n; ++i) {
        const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), 1);
        const rbdi_v3 T = rbdi_load_vec(RBDI_OF(d, i, T), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(RBDI_OF(d, i, S), RBDI_BATCH);
        rbd_real y[RBDI_RESULTS] = {o, o, o};
        for (int k = e[i].parent; k >= d->base; k = e[k].parent) {
            rbdi_entries_before(&d->columns[e[k].batch], want, F, T, y);
            rbdi_put_entry(d->model, e + i, e + k, want, y, out);
        }
        for (int k = i; k < e[i].end; ++k) {
            rbdi_entries_behind(&d->columns[e[k].batch], want, S, y);
            rbdi_put_entry(d->model, e + i, e + k, want, y, out);
        }
    }
}
#endif

/* A free base. The frame has its axes, and its S are unit vectors, so the entries of its rows are components
   of F_j, D_j, E_j. The columns by its velocity (w; v) and its turn theta are, with (n; f) = F_j,

       dtau_j/dw = T_j + n_j x w - f_j x v      dtau_j/dv = f_j x w      dtau_j/dtheta = f_j x up

   Its position has no effect. Without this, derivatives of inverse dynamics take 50 % more instructions for
   HyQ, 17 % for Atlas. */
/* The wanted columns F, D, E of a free base's dofs, with the sums of the whole tree. */
RBDI_INLINE void rbdi_base_columns(const rbd_derivatives *d, int want) {
    const rbd_real *whole = RBDI_OF(d, d->base - 1, sum);
    const rbdi_b3 up = rbdi_b_all(d->up);
    rbdi_bmotion V; /* U = (w; -v) x S */
    rbdi_sums s;
    rbdi_batch *x = (rbdi_batch *)&s;
    V.omega = rbdi_b_all(d->V.omega), V.v = rbdi_b_all(rbdi_sub(rbdi_vec0(), d->V.v));
    RBDI_UNROLL_SUMS for (int j = 0; j < 9; ++j) x[j] = rbdi_all_lanes(whole[j * RBDI_BATCH]);
    if (want & RBDI_WANT_V) {
        RBDI_UNROLL_SUMS for (int j = 9; j < 21; ++j) x[j] = rbdi_all_lanes(whole[j * RBDI_BATCH]);
    }
    for (int b = 0; b < d->behind; ++b) {
        const rbdi_cbatch mass = d->constants[b].subtree;
        rbdi_columns *c = &d->columns[b];
        const rbdi_bmotion S = c->S;
        const rbdi_b3 a = rbdi_b_cross(up, S.omega); /* Phi = (0; a) */
        if (want & RBDI_WANT_M) c->F = rbdi_inertia_times(&s, mass, S);
        if (want & RBDI_WANT_V)
            c->D = rbdi_subtree_B_add(rbdi_inertia_times(&s, mass, rbdi_b_motion_cross(V, S)), &s, S.omega);
        if (want & RBDI_WANT_Q)
            c->stage.by_q.E.n = rbdi_b_cross(s.h, a),
            c->stage.by_q.E.f = rbdi_b_vec(a.x * mass, a.y * mass, a.z * mass);
    }
}
/* Stores n components of all dofs, from x on, as rows of a matrix. A batch may overwrite the beginning of
   the next row, which is stored later, but does not pass end, the number of the matrix's entries. Only the
   last row asks for it: two rows must be as long as a batch. */
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
    for (int k = 0; base && k < n; ++k, x += RBDI_BATCH, out += nv) {
        RBDI_UNROLL_SIX for (int j = 0; j < 6; j += RBDI_BATCH)
            rbdi_copy(&x[j * RBDI_COLUMN_SIZE], 6 - j < RBDI_BATCH ? 6 - j : RBDI_BATCH, &out[j]);
    }
}
/* Stores (n; f) of a batch of dofs as the base's columns of their rows. */
RBDI_INLINE void rbdi_put_base_columns(const rbd_derivatives *d, int b, rbdi_b3 n, rbdi_b3 f, rbd_real *out) {
    const rbdi_batch x[6] = {n.x, n.y, n.z, f.x, f.y, f.z};
    const ptrdiff_t nv = d->model->nv, first = d->base + (b - d->behind) * RBDI_BATCH;
    rbdi_four row[2][RBDI_BATCH]; /* components 0 to 3 and 2 to 5 */
    rbdi_fours_of_lanes(x, row[0]), rbdi_fours_of_lanes(x + 2, row[1]);
    out += first * nv;
    RBDI_UNROLL_SIX for (int k = 0; k < RBDI_BATCH; ++k)
        if (k < nv - first)
            *(rbdi_four *)&out[k * nv] = row[0][k], *(rbdi_four *)&out[k * nv + 2] = row[1][k];
}
RBDI_INLINE void rbdi_put_base(const rbd_derivatives *d, int want, rbdi_wanted out) {
    const rbdi_b3 w = rbdi_b_all(d->V.omega), minus_v = rbdi_b_all(rbdi_sub(rbdi_vec0(), d->V.v)),
                  up = rbdi_b_all(d->up);
    for (int b = d->behind; b < d->batches; ++b) {
        const rbdi_b3 T = d->columns[b].T;
        const rbdi_bforce F = d->columns[b].F;
        if (want & RBDI_WANT_M) rbdi_put_base_columns(d, b, F.n, F.f, out.at[RBDI_MASS]);
        if (want & RBDI_WANT_V)
            rbdi_put_base_columns(d, b, rbdi_b_cross_add(rbdi_b_cross_add(T, F.n, w), F.f, minus_v),
                                  rbdi_b_cross(F.f, w), out.at[RBDI_BY_V]);
        if (want & RBDI_WANT_Q)
            rbdi_put_base_columns(d, b, rbdi_b_cross(F.f, up), rbdi_b_all(rbdi_vec0()), out.at[RBDI_BY_Q]);
    }
}

/* For rbd_fd_derivatives, at v = 0 and without gravity: only the base's columns by w are needed. They take
   the places of its other columns, so that both matrices have the same number of columns to solve for. */
RBDI_INLINE void rbdi_place_turns(rbd_real *by_q, rbd_real *by_v, rbd_real *turn[3]) {
    turn[0] = by_v + (by_q ? 4 : 3);
    turn[1] = turn[0] + 1;
    turn[2] = by_q ? by_q + 5 : by_v + 5;
}
RBDI_PART void rbdi_put_turns(const rbd_derivatives *d, rbd_real *by_q, rbd_real *by_v) {
    const ptrdiff_t nv = d->model->nv;
    const rbdi_b3 w = rbdi_b_all(d->V.omega);
    ptrdiff_t row = d->base * nv;
    rbd_real *turn[3];
    if (!by_v) return;
    rbdi_place_turns(by_q, by_v, turn);
    for (int j = 0; j < 3; ++j) rbdi_store_force(turn[j], nv, rbdi_load_force(RBDI_OF(d, j, D), RBDI_BATCH));
    for (int b = d->behind; b < d->batches; ++b) {
        const rbdi_b3 column = rbdi_b_cross_add(d->columns[b].T, d->columns[b].F.n, w);
        const rbd_real *x = (const rbd_real *)&column;
        for (int k = 0; k < RBDI_BATCH && row < nv * nv; ++k, row += nv)
            for (int j = 0; j < 3; ++j) turn[j][row] = x[j * RBDI_BATCH + k];
    }
}

/* dtau_i/dq_j of dofs i before j of one block. */
RBDI_PART void rbdi_put_block_entries(const rbd_derivatives *d, rbd_real *by_q) {
    for (const rbdi_segment *seg = d->segment + (d->base > 0); seg < d->segment + d->segments; ++seg)
        for (int i = seg->first; seg->block && i < seg->end; ++i) {
            const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
            const rbdi_v3 T = rbdi_load_vec(RBDI_OF(d, i, T), RBDI_BATCH);
            for (int j = i + 1; j < seg->end; ++j)
                by_q[d->entry[i].row + d->entry[j].user] =
                    rbdi_dot(T, rbdi_load_vec(RBDI_OF(d, j, Psi.omega), RBDI_BATCH)) +
                    rbdi_power(rbdi_load_motion(RBDI_OF(d, j, stage.by_q.Phi), RBDI_BATCH), F);
        }
}
/* Adds the rotors' inertias to the diagonal of M. */
RBDI_PART void rbdi_add_armature(const rbd_derivatives *d, rbd_real *M) {
    for (int k = d->base; k < d->n; ++k) {
        const rbdi_entry *e = &d->entry[k];
        const rbd_real ratio = rbdi_ratio(d->model, e->source);
        M[e->row + e->user] = M[e->row + e->user] + ratio * ratio * d->model->dof[e->source].armature;
    }
}

/* All entries of the wanted matrices: results, or right-hand sides in rbd_fd_derivatives. */
RBDI_PART void rbdi_put_entries(const rbd_model *m, const rbd_derivatives *d, rbd_real *by_q, rbd_real *by_v,
                                rbd_real *M, int results) {
    const int want = (by_q ? RBDI_WANT_Q : 0) | (by_v ? RBDI_WANT_V : 0) | (M ? RBDI_WANT_M : 0);
    const int zeros = !results || !d->keep_zeros;
    rbdi_wanted out;
    out.at[RBDI_BY_Q] = by_q, out.at[RBDI_BY_V] = by_v, out.at[RBDI_MASS] = M;
    if (rbdi_mimics(m) || (RBDI_BATCH == 1 && zeros && (m->nblock || m->nh < m->nv * (m->nv + 1) / 2)))
        for (int r = 0; r < RBDI_RESULTS; ++r) /* unless every entry is written: batches go into whole rows */
            if (out.at[r]) rbdi_clear(out.at[r], m->nv * m->nv);
    if (d->base) {
        rbdi_base_columns(d, want);
        if (by_q) rbdi_put_components(d, RBDI_FIELD(d, stage.by_q.E), 6, PTRDIFF_MAX, by_q);
        if (by_v) rbdi_put_components(d, RBDI_FIELD(d, D), 6, PTRDIFF_MAX, by_v);
        if (M) rbdi_put_components(d, RBDI_FIELD(d, F), 6, PTRDIFF_MAX, M);
    }
    if (RBDI_FOR_SPEED && want == (RBDI_WANT_Q | RBDI_WANT_V)) /* the most common ones, as constants */
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
