#ifndef RBDI_DERIVATIVES_ENTRIES_H
#define RBDI_DERIVATIVES_ENTRIES_H
#include "dynamics/crba.h"
#include "derivatives/columns.h"

/* ---- entries [entries] ----
   For dof j and every dof i of an ancestor link, or of j's own link if not said otherwise:

       M_ij = S_i' F_j                M_ji = M_ij
       dtau_i/dv_j = S_i' D_j         dtau_j/dv_i = T_j' S_i + F_j' U_i
       dtau_i/dq_j = S_i' E_j         dtau_j/dq_i = T_j' Psi_i + F_j' Phi_i

   and 0 for dofs of different branches. Within a joint the axes of i do not turn with those of j: there
   dtau_i/dq_j is the second formula of the last line with i and j exchanged (rbdi_put_block_entries). C has
   the formulas of dtau/dv, with columns of W = V, not 2 V: [columns].

   Rows are computed one at a time, with dofs as lanes. The entries of row i with dofs on the path from i to
   the root have the formulas on the right, those with dofs in i's subtree the formulas on the left. */

/* The caller's matrices: derivatives by q and by v (or C), and M. Bits for those that are wanted. */
enum { RBDI_BY_Q, RBDI_BY_V, RBDI_MASS, RBDI_RESULTS };
enum { RBDI_WANT_Q = 1 << RBDI_BY_Q, RBDI_WANT_V = 1 << RBDI_BY_V, RBDI_WANT_M = 1 << RBDI_MASS };
typedef struct rbdi_wanted {
    rbd_real *at[RBDI_RESULTS];
} rbdi_wanted;

/* Entries of a dof, whose columns are F and T, with a batch of dofs on its path. */
RBDI_INLINE void rbdi_entries_before(const rbdi_columns *cols, int want, rbdi_force F, rbdi_v3 T,
                                     rbdi_batch y[RBDI_RESULTS]) {
    if (want & RBDI_WANT_Q) {
        const rbdi_by_q *by_q = &cols->stage.by_q;
        y[RBDI_BY_Q] = rbdi_b_dot(cols->Psi.omega, T) + rbdi_b_motion_dot(by_q->Phi, F);
    }
    if (want & RBDI_WANT_V) y[RBDI_BY_V] = rbdi_b_dot(cols->S.omega, T) + rbdi_b_motion_dot(cols->U, F);
    if (want & RBDI_WANT_M) y[RBDI_MASS] = rbdi_b_motion_dot(cols->S, F);
}

/* Entries of a dof, whose column is S, with a batch of dofs in its subtree. */
RBDI_INLINE void rbdi_entries_behind(const rbdi_columns *cols, int want, rbdi_motion S,
                                     rbdi_batch y[RBDI_RESULTS]) {
    if (want & RBDI_WANT_Q) y[RBDI_BY_Q] = rbdi_b_force_dot(cols->stage.by_q.E, S);
    if (want & RBDI_WANT_V) y[RBDI_BY_V] = rbdi_b_force_dot(cols->D, S);
    if (want & RBDI_WANT_M) y[RBDI_MASS] = rbdi_b_force_dot(cols->F, S);
}

/* Adds the entries y of two dofs, one of each result, `stride` apart, to those of the joints that they
   follow. With mimic joints the velocities of all joints are G v, and each result is G' (.) G. */
RBDI_PART void rbdi_add_entry(const rbd_model *m, const rbdi_entry *row, const rbdi_entry *column,
                              const rbd_real *y, ptrdiff_t stride, rbdi_wanted out) {
    const rbd_real ratio = rbdi_ratio(m, row->source) * rbdi_ratio(m, column->source);

    for (int r = 0; r < RBDI_RESULTS; ++r) {
        rbd_real *to = out.at[r] ? out.at[r] + row->row + column->user : NULL;
        if (to) *to = *to + y[r * stride] * ratio;
    }
}

/* Replaces dtau_i/dq_j of dofs i before j of one block by T_i' Psi_j + F_i' Phi_j. */
RBDI_PART void rbdi_put_block_entries(const rbd_derivatives *d, rbd_real *by_q) {
    for (const rbdi_segment *seg = d->segment + (d->base > 0); seg < d->segment + d->segments; ++seg) {
        if (!seg->block) continue;

        for (int i = seg->first; i < seg->end; ++i) {
            const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
            const rbdi_v3 T = rbdi_load_vec(RBDI_OF(d, i, T), RBDI_BATCH);

            for (int j = i + 1; j < seg->end; ++j)
                by_q[d->entry[i].row + d->entry[j].user] =
                    rbdi_dot(T, rbdi_load_vec(RBDI_OF(d, j, Psi.omega), RBDI_BATCH)) +
                    rbdi_power(rbdi_load_motion(RBDI_OF(d, j, stage.by_q.Phi), RBDI_BATCH), F);
        }
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

#if RBDI_BATCH > 1
/* Length of a dof's three lists, which follow one another. */
RBDI_INLINE int rbdi_relatives_length(const rbd_derivatives *d) { return d->batches - d->behind + 3; }

RBDI_INLINE rbdi_relatives *rbdi_relatives_of(const rbd_derivatives *d, int i) {
    return d->relatives + d->entry[i].source * rbdi_relatives_length(d);
}

/* Mask of the lanes on the path (first = RBDI_ON_PATH), or of those in the subtree. */
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

/* The same of a batch in which some lanes are on the path, with entries y, others in the subtree, with z. */
RBDI_INLINE void rbdi_put_both(const rbdi_batch *y, const rbdi_batch *z, const rbdi_relatives *rel, int want,
                               rbdi_wanted row) {
    const rbdi_bits before = rbdi_lanes_of(rel, RBDI_ON_PATH), behind = rbdi_lanes_of(rel, RBDI_IN_SUBTREE);

    RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
        if (want >> r & 1)
            *(rbdi_batch *)(row.at[r] + rel->row) =
                (rbdi_batch)(((rbdi_bits)y[r] & before) | ((rbdi_bits)z[r] & behind));
    }
}

/* The row of the dof at e, from the columns behind a free base on. rel: its three lists, in a row. */
RBDI_INLINE void rbdi_put_row(const rbdi_columns *columns, const rbdi_entry *e, const rbdi_relatives *rel,
                              int want, rbdi_wanted row) {
    const rbd_real *own = (const rbd_real *)columns + e->at;
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());
    rbdi_batch y[RBDI_RESULTS] = {zero, zero, zero}, z[RBDI_RESULTS] = {zero, zero, zero};

    /* batches with dofs on the path only */
    if (rel->batch >= 0) {
        const rbdi_force F = rbdi_load_force(own + RBDI_PLACE(F), RBDI_BATCH);
        const rbdi_v3 T = rbdi_load_vec(own + RBDI_PLACE(T), RBDI_BATCH);
        do {
            rbdi_entries_before(columns + rel->batch, want, F, T, y);
            rbdi_put_lanes(y, rbdi_lanes_of(rel, RBDI_ON_PATH), want, row, rel->row);
        } while ((++rel)->batch >= 0);
    }

    /* with both */
    for (++rel; rel->batch >= 0; ++rel) {
        const rbdi_force F = rbdi_load_force(own + RBDI_PLACE(F), RBDI_BATCH);
        const rbdi_v3 T = rbdi_load_vec(own + RBDI_PLACE(T), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(own + RBDI_PLACE(S), RBDI_BATCH);
        rbdi_entries_before(columns + rel->batch, want, F, T, y);
        rbdi_entries_behind(columns + rel->batch, want, S, z);
        rbdi_put_both(y, z, rel, want, row);
    }

    /* with dofs in the subtree only */
    if ((++rel)->batch >= 0) {
        const rbdi_motion S = rbdi_load_motion(own + RBDI_PLACE(S), RBDI_BATCH);
        do {
            rbdi_entries_behind(columns + rel->batch, want, S, y);
            rbdi_put_lanes(y, rbdi_lanes_of(rel, RBDI_IN_SUBTREE), want, row, rel->row);
        } while ((++rel)->batch >= 0);
    }
}

/* 0 in n entries of a row, up to whole batches. */
RBDI_INLINE void rbdi_clear_row(int n, int want, rbdi_wanted row) {
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());

    for (int k = 0; k < n; k += RBDI_BATCH) {
        RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
            if (want >> r & 1) *(rbdi_batch *)(row.at[r] + k) = zero;
        }
    }
}

/* Stores the rows of all dofs behind a free base, in the caller's order. The last batch of a row may
   overwrite the beginning of the next row, which is stored later, as are the columns of a base. A row whose
   last batch would pass the end of the matrix is computed in scratch memory and copied. */
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

/* Stores the rows of all dofs behind a free base. zeros: also the entries of dofs on different branches,
   which are 0. */
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
    if (rbdi_mimics(m)) {
        rbdi_add_entry(m, row, column, y, 1, out);
        return;
    }

    RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
        if (want >> r & 1) (out.at[r] + row->row)[column->user] = y[r];
    }
}

/* Stores the rows of all dofs behind a free base. The other entries are 0 already. */
RBDI_INLINE void rbdi_put_rows(const rbd_derivatives *d, int want, int zeros, rbdi_wanted out) {
    const rbdi_entry *e = d->entry;
    const rbd_real o = rbdi_zero();
    (void)zeros;

    for (int i = d->base; i < d->n; ++i) {
        const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
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

#endif
