#ifndef RBDI_CONSTRAINTS_LIMBS_H
#define RBDI_CONSTRAINTS_LIMBS_H
#include "dynamics/aba.h"
#include "constraints/rank.h"

/* ---- limbs [limbs] ----
   Contacts with the world that have a limb to themselves are eliminated where it ends, on the link that it
   hangs on: then the feet of a robot do not meet in its base. That is no loss of rank: of n with
   J'n = 0 the part n_e of a limb leaves its joints without force, Y n_e = 0, and Lambda n_e = 0 makes it 0.
   But a limb near the end of its reach is a strut, of which Lambda^-1 is large, and so is what it adds to IA:
   where pivots or IA would lose digits its rows pass on to the world, in all lanes ([tolerances]). */

/* A row K' b, in SIMD registers; and what rows add to the inertia and bias wrench of a link: [IA pA]. */
#ifdef RBDI_FOURS
typedef rbdi_four rbdi_row_part;
#define RBDI_ROW_PARTS 2
#else
typedef rbd_real rbdi_row_part;
#define RBDI_ROW_PARTS 7
#endif
#define RBDI_ROW_PART_SIZE ((int)(sizeof(rbdi_row_part) / sizeof(rbd_real)))
typedef struct rbdi_limb_row {
    rbdi_row_part x[RBDI_ROW_PARTS];
} rbdi_limb_row;
RBDI_INLINE rbd_real rbdi_row_entry(const rbdi_limb_row *row, int j) { return ((const rbd_real *)row->x)[j]; }

/* The rows of a strand, which stand in lanes. */
RBDI_INLINE void rbdi_rows_of_strand(const rbd_constraints *c, const rbdi_strand *s,
                                     rbdi_limb_row row[RBDI_BATCH]) {
    const rbdi_batch *K = (const rbdi_batch *)s->K;
#ifdef RBDI_FOURS
    const rbdi_batch rest[4] = {K[4], K[5], *(const rbdi_batch *)&c->b[s->row], rbdi_zero_batch()};
    rbdi_four x[RBDI_BATCH], y[RBDI_BATCH];
    rbdi_fours_of_lanes(K, x);
    rbdi_fours_of_lanes(rest, y);
    for (int r = 0; r < RBDI_BATCH; ++r) row[r].x[0] = x[r], row[r].x[1] = y[r];
#else
    for (int r = 0; r < RBDI_BATCH; ++r) {
        for (int j = 0; j < 6; ++j) row[r].x[j] = ((const rbd_real *)&K[j])[r];
        row[r].x[6] = c->b[s->row + r];
    }
#endif
}

/* Of n rows from `first` on Lambda = L'DL: w = L^-T [K' b], and Lambda^-1 [K' b]. Returns 0 if a pivot is not
   above `sound` of its diagonal entry, in any lane. */
RBDI_INLINE int rbdi_limb_factor(rbd_constraints *c, int first, int n, rbd_const sound, rbdi_limb_row *w,
                                 rbdi_limb_row *solved) {
    const rbd_real noise = rbdi_row_noise(c) * (1 / RBDI_CLEAR);
    const int stride = c->stride;
    const rbd_real *D = &c->D[first * stride + first];
    rbd_real *inverse = &c->inverse[first], A[6][6];
    rbdi_mask none = rbdi_less(rbdi_zero(), rbdi_zero()), weak = none;
    RBDI_UNROLL_SIX for (int i = 0; i < n; ++i) {
        const rbd_real *row = D + i * stride;
        RBDI_UNROLL_SIX for (int j = 0; j <= i; ++j) { A[i][j] = row[j]; }
    }
    RBDI_UNROLL_SIX for (int k = n - 1; k >= 0; --k) {
        const rbd_real whole = c->diagonal[first + k] + D[k * stride + k] + noise;
        inverse[k] = rbdi_reciprocal(A[k][k], RBDI_TINY, &none);
        weak = rbdi_or(weak, rbdi_not(rbdi_less(whole * sound, A[k][k])));
        RBDI_UNROLL_SIX for (int i = 0; i < k; ++i) {
            const rbd_real l = A[k][i] * inverse[k];
            RBDI_UNROLL_SIX for (int j = 0; j <= i; ++j) { A[i][j] = A[i][j] - l * A[k][j]; }
            for (int j = 0; j < RBDI_ROW_PARTS; ++j) w[i].x[j] = w[i].x[j] - w[k].x[j] * l;
        }
    }
    RBDI_UNROLL_SIX for (int i = 0; i < n; ++i) {
        for (int j = 0; j < RBDI_ROW_PARTS; ++j) {
            rbdi_row_part x = w[i].x[j];
            RBDI_UNROLL_SIX for (int k = 0; k < i; ++k) { x = x - solved[k].x[j] * A[i][k]; }
            solved[i].x[j] = x * inverse[i];
        }
    }
    return !rbdi_any(weak);
}

/* Whether what n rows add to a link's inertia, of which most[6] is a multiple, leaves enough digits of it. */
RBDI_INLINE int rbdi_adds_little(const rbdi_limb_row *w, const rbdi_limb_row *share, int n,
                                 const rbd_real *most) {
    rbdi_mask little = rbdi_less(rbdi_zero(), most[0]);
    rbdi_limb_row added;
    for (int j = 0; j < RBDI_ROW_PARTS; ++j) {
        rbdi_row_part x = w[0].x[j] * share[0].x[j];
        RBDI_UNROLL_SIX for (int r = 1; r < n; ++r) { x = x + w[r].x[j] * share[r].x[j]; }
        added.x[j] = x;
    }
    RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) {
        little = rbdi_and(little, rbdi_less(rbdi_row_entry(&added, j), most[j]));
    }
    return !rbdi_any(rbdi_not(little));
}

/* Adds [IA pA] of n rows, w' share. */
RBDI_INLINE void rbdi_limb_sum(const rbdi_limb_row *w, const rbdi_limb_row *share, int n,
                               rbdi_limb_row sum[6]) {
    RBDI_UNROLL_SIX for (int i = 0; i < 6; ++i) {
        for (int j = i / RBDI_ROW_PART_SIZE; j < RBDI_ROW_PARTS; ++j) {
            rbdi_row_part x = sum[i].x[j];
            RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) { x = x + w[r].x[j] * rbdi_row_entry(&share[r], i); }
            sum[i].x[j] = x;
        }
    }
}

/* What is summed there goes to a link. */
RBDI_INLINE void rbdi_add_sum(const rbdi_limb_row sum[6], rbdi_abi *IA, rbdi_force *pA) {
    rbd_real A[6][6];
    for (int i = 0; i < 6; ++i)
        for (int j = i; j < 6; ++j) A[i][j] = rbdi_row_entry(&sum[i], j);
    *IA = rbdi_abi_add(*IA, rbdi_abi_from_array(A));
    pA->n = rbdi_sub(
        pA->n, rbdi_vec(rbdi_row_entry(&sum[0], 6), rbdi_row_entry(&sum[1], 6), rbdi_row_entry(&sum[2], 6)));
    pA->f = rbdi_sub(
        pA->f, rbdi_vec(rbdi_row_entry(&sum[3], 6), rbdi_row_entry(&sum[4], 6), rbdi_row_entry(&sum[5], 6)));
}

/* The n rows of a limb, of so many strands, are eliminated where it ends, if they can be. */
RBDI_INLINE void rbdi_take_rows(rbd_constraints *c, rbdi_limb *e, int n, int strands, const rbd_real *most,
                                rbdi_limb_row sum[6]) {
    const rbdi_strand *s = c->strand + e->strand;
    rbdi_limb_row *solved = (rbdi_limb_row *)&c->wrench[8 * e->row], w[6], share[6], own[RBDI_BATCH];
    rbdi_rows_of_strand(c, s, own);
    RBDI_UNROLL_SIX for (int r = 0, i = 0; r < n; ++r, ++i) {
        if (i == RBDI_BATCH || (strands > 1 && i == s->rows)) rbdi_rows_of_strand(c, s += 2, own), i = 0;
        w[r] = own[i];
    }
    e->taken = (int16_t)rbdi_limb_factor(c, e->row, n, RBDI_SOUND, w, solved);
    RBDI_UNROLL_SIX for (int r = 0; r < 6; ++r) {
        const rbd_real inverse = c->inverse[e->row + (r < n ? r : 0)];
        for (int j = 0; j < RBDI_ROW_PARTS; ++j) share[r].x[j] = w[r < n ? r : 0].x[j] * inverse;
    }
    e->taken = e->taken && rbdi_adds_little(w, share, n, most);
    if (!e->taken) {
        for (int r = e->row; r < e->row + n; ++r) rbdi_clear(&c->D[r * c->stride], e->row);
        return;
    }
    rbdi_limb_sum(w, share, n, sum);
    for (int k = 0; k < strands; ++k) c->strand[e->strand + 2 * k].open = 0;
}

/* The limbs first .. end - 1, which hang on one link; IA and pA become what it then feels of its children. */
static void rbdi_take_limbs(const rbd_model *m, rbd_constraints *c, int first, int end, rbdi_abi *IA,
                            rbdi_force *pA) {
    const rbdi_link *l = &m->link[c->limb[first].link];
    rbdi_abi own = l->slot < 0 ? *IA : rbdi_abi_add(*IA, c->w->slot[l->slot].I);
    rbdi_limb_row sum[6];
    rbd_real most[6];
    own = rbdi_abi_add_link(l, RBDI_MASS_KEPT, own);
    most[0] = own.I.xx * RBDI_ADDED, most[1] = own.I.yy * RBDI_ADDED, most[2] = own.I.zz * RBDI_ADDED;
    most[3] = own.M.xx * RBDI_ADDED, most[4] = own.M.yy * RBDI_ADDED, most[5] = own.M.zz * RBDI_ADDED;
    rbdi_clear((rbd_real *)sum, 6 * RBDI_ROW_PARTS * RBDI_ROW_PART_SIZE);
    for (rbdi_limb *e = c->limb + first; e < c->limb + end; ++e) {
        const int strands = (e->end - e->strand) / 2;
        if (e->rows == 3)
            rbdi_take_rows(c, e, 3, strands, most, sum);
        else if (e->rows == 6)
            rbdi_take_rows(c, e, 6, strands, most, sum);
        else
            rbdi_take_rows(c, e, e->rows % 6, strands, most, sum); /* 1 .. 5, as the compiler sees */
    }
    rbdi_add_sum(sum, IA, pA);
}

/* lambda of n rows from the acceleration of the link where they were eliminated. */
RBDI_INLINE void rbdi_rows_lambda(rbd_constraints *c, int first, int n, const rbd_real y[6]) {
    const rbdi_limb_row *solved = (const rbdi_limb_row *)&c->wrench[8 * first];
    for (int r = 0; r < n; ++r) {
        rbd_real x = rbdi_row_entry(&solved[r], 6);
        RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) { x = x - rbdi_row_entry(&solved[r], j) * y[j]; }
        c->lambda[first + r] = x;
    }
}

/* The same of a limb. */
static void rbdi_solve_limb(rbd_constraints *c, const rbdi_limb *e, const rbd_real y[6]) {
    if (!e->taken) return;
    rbdi_rows_lambda(c, e->row, e->rows, y);
    for (rbdi_strand *s = c->strand + e->strand; s < c->strand + e->end; s += 2) s->open = 1;
}

/* Of the limbs before `end` the first that hangs where the last does. */
static int rbdi_limbs_together(const rbd_constraints *c, int end) {
    int first = end;
    while (first > 0 && c->limb[first - 1].link == c->limb[end - 1].link) --first;
    return first;
}

#endif
