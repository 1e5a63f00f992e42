#ifndef RBDI_CONSTRAINTS_ARTICULATED_H
#define RBDI_CONSTRAINTS_ARTICULATED_H
#include "dynamics/aba.h"
#include "constraints/rank.h"

/* ---- articulated bodies [articulated] ----
   Rows as wrenches w of unit force (moment), from body 1 with one sign and body 2 with the other, go down the
   tree with pass 2 of [aba]: a strand each. Where a joint lets go, with y = X y_p + c from here on its link's
   acceleration but for S qdd,

       Y = S' K,   K -= U/D Y,   Lambda += Y Y'/D,   epsilon += Y u/D + K' c,   K_p = X' K

   so that w' (acceleration of the tip) = K' y + epsilon + Lambda lambda. Where the two strands of a
   constraint meet, all that could move it has let go: the rows are eliminated there,

       Lambda lambda = b - K' y,  b = r - epsilon     IA += K Lambda^-1 K',   pA -= K Lambda^-1 b

   and from Lambda, K and b of the rows that pass on. Rows that depend on others vanish, K too: of n with
   Lambda n = 0 all Y'n = 0. In pass 3 lambda follows from y where the strands met, then u/D += Y'lambda / D
   behind it.

   HyQ on four points, batches of four: each contact has a strand of three rows, that of body 1, and an empty
   one, the world's. A leg's three joints are a piece, which one strand passes; the base is another, which all
   four do: its route. Each leg is a limb, [limbs]. */

#if RBDI_BATCH > 1
#define rbdi_rows_up rbdi_batch_up
#else
#define rbdi_rows_up rbdi_array_up
#endif

static int rbdi_whole_batches(int n) { return (n + RBDI_BATCH - 1) / RBDI_BATCH * RBDI_BATCH; }

/* Where a sweep is: in the strands' order, and in Y, which here has each dof of a link by strand. */
typedef struct rbdi_cursor {
    const int16_t *route;
    rbd_real *Y;
} rbdi_cursor;

/* Wrenches of forces that are `arm` from a link's origin, its axes. */
RBDI_INLINE void rbdi_set_wrenches(const rbdi_batch f[3], rbdi_v3 arm, rbdi_batch K[6]) {
    for (int j = 0; j < 3; ++j) K[3 + j] = f[j];
    K[0] = f[2] * arm.y - f[1] * arm.z;
    K[1] = f[0] * arm.z - f[2] * arm.x;
    K[2] = f[1] * arm.x - f[0] * arm.y;
}

/* Wrenches on the link of a side, of a constraint at the place `arm` from its origin, link axes. */
RBDI_INLINE void rbdi_start_strand(const rbd_constraints *c, const rbdi_constraint *k,
                                   const rbdi_axes_held *h, rbdi_v3 arm, int side) {
    const rbdi_kin *kin = &c->w->kin[k->link[side]];
    const rbd_real sign = rbdi_set(side ? RBD_C(-1) : RBD_C(1));
    const rbdi_v3 axis[3] = {rbdi_scale(sign, rbdi_vec(kin->X.E.xx, kin->X.E.xy, kin->X.E.xz)),
                             rbdi_scale(sign, rbdi_vec(kin->X.E.yx, kin->X.E.yy, kin->X.E.yz)),
                             rbdi_scale(sign, rbdi_vec(kin->X.E.zx, kin->X.E.zy, kin->X.E.zz))};
    for (int r = 0; r < k->rows; r += RBDI_BATCH) {
        rbdi_batch f[3], *K = (rbdi_batch *)c->strand[k->strand + 2 * (r / RBDI_BATCH) + side].K;
        for (int j = 0; j < 3; ++j)
            f[j] = *(const rbdi_batch *)&h->x[3][r] * axis[j].x +
                   *(const rbdi_batch *)&h->x[4][r] * axis[j].y +
                   *(const rbdi_batch *)&h->x[5][r] * axis[j].z;
        rbdi_set_wrenches(f, arm, K);
        for (int j = 0; k->angular && j < 3; ++j)
            K[j] = K[j] + *(const rbdi_batch *)&h->x[0][r] * axis[j].x +
                   *(const rbdi_batch *)&h->x[1][r] * axis[j].y +
                   *(const rbdi_batch *)&h->x[2][r] * axis[j].z;
    }
}

/* What a sweep up carries of a strand: wrenches K' of its rows, and b. */
typedef struct rbdi_carried {
    rbdi_batch x[6], b;
} rbdi_carried;

/* One-axis link i: what a strand has left when the joint has let go, in the parent's axes; Y = S' K. */
RBDI_INLINE void rbdi_strand_axis(const rbd_model *m, const rbd_work *w, int i, int form, rbdi_carried *k,
                                  rbdi_batch *Y) {
    const rbdi_link *l = &m->link[i];
    const rbdi_scratch *own = &w->scratch[i];
    rbdi_batch *x = k->x, y = x[2], z = x[2], term;
    if (form & RBDI_SLIDES) y = x[2] * l->rho + x[5] * l->kappa;
    *Y = y;
    x[0] = x[0] - y * own->U_D.n.x, x[1] = x[1] - y * own->U_D.n.y;
    x[2] = rbdi_zero_batch(); /* U_z/D = 1 */
    if (form & (RBDI_SLIDES | RBDI_ARMATURE)) x[2] = z - y * own->U_D.n.z;
    x[3] = x[3] - y * own->U_D.f.x, x[4] = x[4] - y * own->U_D.f.y, x[5] = x[5] - y * own->U_D.f.z;
    term = y * own->u_D + x[0] * own->c.omega.x + x[1] * own->c.omega.y;
    term = term + x[3] * own->c.v.x + x[4] * own->c.v.y + x[5] * own->c.v.z;
    k->b = k->b - term;
    rbdi_rows_up(l, form, rbdi_trig_of(m, w, i, form), x);
}

/* The same of the n links from i on. */
RBDI_INLINE void rbdi_strand_axes(const rbd_model *m, rbd_constraints *c, int i, int n, const rbdi_strand *on,
                                  rbdi_batch *Y) {
    rbdi_batch *K = (rbdi_batch *)on->K, *b = (rbdi_batch *)&c->b[on->row];
    rbdi_carried k;
    RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) { k.x[j] = K[j]; }
    k.b = *b;
    for (int t = n - 1; t >= 0; --t)
        RBDI_BY_FORM(form, &m->link[i + t], rbdi_strand_axis(m, c->w, i + t, form, &k, &Y[t]));
    RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) { K[j] = k.x[j]; }
    *b = k.b;
}

/* The dofs of a block let go; of a free base x keeps what those before have to give. Returns Y u/D. */
RBDI_INLINE rbdi_batch rbdi_strand_release(const rbdi_block_work *bw, int first, int n, int free_base,
                                           rbdi_batch x[6], rbdi_batch *Y) {
    rbdi_batch term = rbdi_zero_batch();
    RBDI_UNROLL_SIX for (int d = n - 1; d >= 0; --d) {
        const rbdi_batch y = x[first + d];
        const int end = free_base ? d : 6;
        Y[d] = y;
        term = term + y * bw->u_D[d];
        RBDI_UNROLL_SIX for (int j = 0; j < end; ++j) { x[j] = x[j] - y * bw->U_D[d][j]; }
    }
    return term;
}

/* x = X' x of a block. */
RBDI_INLINE void rbdi_strand_up_block(const rbdi_pose *X, rbdi_batch x[6]) {
    const rbdi_mat E = X->E;
    const rbdi_v3 r = X->r;
    for (int j = 0; j < 6; j += 3) {
        const rbdi_batch a = x[j], b = x[j + 1], c = x[j + 2];
        x[j] = a * E.xx + b * E.yx + c * E.zx;
        x[j + 1] = a * E.xy + b * E.yy + c * E.zy;
        x[j + 2] = a * E.xz + b * E.yz + c * E.zz;
    }
    x[0] = x[0] + x[5] * r.y - x[4] * r.z;
    x[1] = x[1] + x[3] * r.z - x[5] * r.x;
    x[2] = x[2] + x[4] * r.x - x[3] * r.y;
}

/* The same of block link i. A free base leaves nothing. */
static void rbdi_strand_block(const rbd_model *m, rbd_constraints *c, int i, const rbdi_strand *on,
                              rbdi_batch *Y) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_block_work *bw = &c->w->block[l->block];
    rbdi_batch *K = (rbdi_batch *)on->K, x[6], term;
    RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) { x[j] = K[j]; }
    if (rbdi_free_base(l, b)) {
        term = rbdi_strand_release(bw, 0, 6, 1, x, Y);
        for (int j = 3; j < 6; ++j) x[j] = rbdi_zero_batch();
    } else {
        rbd_real C[6];
        rbdi_motion_to_array(c->w->scratch[i].c, C);
        term = rbdi_strand_release(bw, b->first, b->n, 0, x, Y);
        for (int j = 0; j < 6; ++j) term = term + x[j] * C[j];
        rbdi_strand_up_block(&bw->X, x);
    }
    *(rbdi_batch *)&c->b[on->row] = *(const rbdi_batch *)&c->b[on->row] - term;
    RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) { K[j] = x[j]; }
}

/* Lambda += Y D^-1 Y' of a piece's n dofs, for a row of a and those of b, which stands before it or is a. */
RBDI_INLINE void rbdi_share_row(rbd_real *D, const rbd_real *ya, const rbdi_batch *zb, int n) {
    rbdi_batch sum = *(const rbdi_batch *)D;
    RBDI_UNROLL_SIX for (int t = 0; t < n; ++t) { sum = sum + zb[t] * ya[t * RBDI_BATCH]; }
    *(rbdi_batch *)D = sum;
}

/* 1/D of the n dofs of the piece that begins at link i. */
RBDI_INLINE void rbdi_piece_inverse(const rbd_model *m, rbd_constraints *c, int i, int n, rbd_real *inverse) {
    const rbdi_link *l = &m->link[i];
    const rbd_work *w = c->w;
    const int block = l->kind == RBDI_BLOCK;
    rbdi_mask none = rbdi_less(rbdi_zero(), rbdi_zero());
    rbd_real give = c->give;
    RBDI_UNROLL_SIX for (int t = 0; t < n; ++t) {
        const int k = block ? l->iv + t : l[t].iv;
        c->D_inverse[k] = inverse[t] = rbdi_reciprocal(w->pivot[k], RBDI_TINY, &none);
        give = give + inverse[t];
    }
    c->give = give;
}

/* rbdi_share_row of all pairs of strands. */
RBDI_INLINE void rbdi_share_piece(const rbd_model *m, rbd_constraints *c, int i, const int16_t *route,
                                  int strands, const rbd_real *Y, int n) {
    const rbdi_strand *strand = c->strand;
    const int stride = c->stride;
    rbd_real *D = c->D, inverse[6];
    rbdi_piece_inverse(m, c, i, n, inverse);
    for (int t = 0; t < strands; ++t) {
        const rbdi_strand *b = &strand[route[t]];
        const rbd_real *ya = Y + t * n * RBDI_BATCH;
        rbdi_batch z[6];
        RBDI_UNROLL_SIX for (int d = 0; d < n; ++d) { z[d] = ((const rbdi_batch *)ya)[d] * inverse[d]; }
        for (int s = t; s < strands; ++s, ya += n * RBDI_BATCH) {
            const rbdi_strand *a = &strand[route[s]];
            rbd_real *to = &D[a->row * stride + b->row];
            for (int r = 0, rows = a->rows; r < rows; ++r, to += stride) rbdi_share_row(to, ya + r, z, n);
        }
    }
}

/* Whether any strand has rows that wait. */
RBDI_INLINE int rbdi_any_open(const rbd_constraints *c, const int16_t *route, int n) {
    for (int s = 0; s < n; ++s)
        if (c->strand[route[s]].open) return 1;
    return 0;
}

/* The strands of the piece that begins at link i, whose joints have let go. */
RBDI_INLINE void rbdi_piece_up(const rbd_model *m, rbd_constraints *c, int i, rbdi_cursor *at) {
    const rbdi_link *l = &m->link[i];
    const int n = c->piece[i].strands, dofs = c->piece[i].dofs;
    const int16_t *route = at->route;
    rbd_real *Y = at->Y;
    at->route += n;
    if (!rbdi_any_open(c, route, n)) return;
    at->Y += n * dofs * RBDI_BATCH;
    for (int s = 0; s < n; ++s) {
        const rbdi_strand *on = &c->strand[route[s]];
        rbdi_batch *own = (rbdi_batch *)Y + s * dofs;
        if (!on->open)
            rbdi_clear(Y + s * dofs * RBDI_BATCH, dofs * RBDI_BATCH);
        else if (l->kind == RBDI_BLOCK)
            rbdi_strand_block(m, c, i, on, own);
        else
            rbdi_strand_axes(m, c, i, dofs, on, own);
    }
    if (dofs == 1)
        rbdi_share_piece(m, c, i, route, n, Y, 1);
    else if (dofs == 3)
        rbdi_share_piece(m, c, i, route, n, Y, 3);
    else
        rbdi_share_piece(m, c, i, route, n, Y, 6);
}

/* Y'lambda of a dof of n strands; Y: stride apart. */
RBDI_INLINE rbd_real rbdi_strands_sum(const rbd_constraints *c, const int16_t *route, int n,
                                      const rbdi_batch *Y, int stride) {
    const rbdi_strand *strand = c->strand;
    const rbd_real *lambda = c->lambda;
    rbdi_batch sum = *Y * *(const rbdi_batch *)&lambda[strand[route[0]].row];
    for (int s = 1; s < n; ++s)
        sum = sum + Y[s * stride] * *(const rbdi_batch *)&lambda[strand[route[s]].row];
    return rbdi_sum_lanes(sum);
}

/* u/D of the links first .. end - 1, once lambda of their strands is known. */
RBDI_INLINE void rbdi_strands_down(const rbd_model *m, rbd_constraints *c, int first, int end,
                                   rbdi_cursor *at) {
    for (int i = first, links; i < end; i += links) {
        const rbdi_link *l = &m->link[i];
        const int n = c->piece[i].strands, dofs = c->piece[i].dofs;
        const rbdi_batch *Y;
        links = l->kind == RBDI_BLOCK ? 1 : dofs;
        at->route -= n;
        if (!rbdi_any_open(c, at->route, n)) continue;
        at->Y -= n * dofs * RBDI_BATCH;
        Y = (const rbdi_batch *)at->Y;
        if (l->kind == RBDI_BLOCK) {
            rbd_real *u_D = c->w->block[l->block].u_D;
            for (int t = 0; t < dofs; ++t)
                u_D[t] = u_D[t] + rbdi_strands_sum(c, at->route, n, Y + t, dofs) * c->D_inverse[l->iv + t];
        } else {
            rbdi_scratch *own = &c->w->scratch[i];
            for (int t = 0; t < dofs; ++t)
                own[t].u_D =
                    own[t].u_D + rbdi_strands_sum(c, at->route, n, Y + t, dofs) * c->D_inverse[l[t].iv];
        }
    }
}

/* Rows that are eliminated together, and the first of those before them that they know. carried: their sides
   meet on a link, and elimination goes on in c->wrench. */
typedef struct rbdi_rows {
    int first, end, low, carried;
} rbdi_rows;

/* 1/d of row k; in doubt if d is small beside what it is the difference of. */
RBDI_INLINE rbd_real rbdi_lambda_pivot(const rbd_constraints *c, int k, rbd_real noise, rbdi_mask *doubt) {
    rbdi_mask none = rbdi_less(rbdi_zero(), rbdi_zero());
    const rbd_real d = c->D[k * c->stride + k];
    *doubt = rbdi_or(*doubt, rbdi_not(rbdi_less((c->diagonal[k] + noise) * RBDI_CLEAR, d)));
    return c->inverse[k] = rbdi_reciprocal(d, RBDI_TINY, &none);
}

/* Lambda = L'DL, D L in place of Lambda, and b = L^-T b. Rows k and k - 1 are taken from those before them
   together: these are read and written half as often. c->diagonal has what rows have lost before. */
static void rbdi_lambda_factor(rbd_constraints *c, rbdi_rows g, rbdi_mask *doubt) {
    const rbd_real noise = rbdi_row_noise(c) * (1 / RBDI_CLEAR);
    const int stride = c->stride, low = g.low;
    rbd_real *D = c->D, *b = c->b, *w = c->wrench;
    for (int i = g.first; i < g.end; ++i) c->diagonal[i] = c->diagonal[i] + D[i * stride + i];
    for (int k = g.end - 1; k >= g.first; k -= 2) {
        const rbd_real *u = &D[k * stride], first = rbdi_lambda_pivot(c, k, noise, doubt);
        rbd_real *v, l, second;
        if (k == g.first) return;
        v = &D[(k - 1) * stride], l = u[k - 1] * first;
        rbdi_subtract_two(&v[low], l, &u[low], rbdi_zero(), &u[low], k - low);
        b[k - 1] = b[k - 1] - l * b[k];
        if (g.carried) rbdi_subtract(&w[8 * (k - 1)], l, &w[8 * k], 6);
        second = rbdi_lambda_pivot(c, k - 1, noise, doubt);
        for (int i = k - 2; i >= g.first; --i) {
            const rbd_real n = v[i] * second;
            l = u[i] * first;
            rbdi_subtract_two(&D[i * stride + low], l, &u[low], n, &v[low], i + 1 - low);
            b[i] = b[i] - l * b[k] - n * b[k - 1];
            if (!g.carried) continue;
            rbdi_subtract(&w[8 * i], l, &w[8 * k], 6);
            rbdi_subtract(&w[8 * i], n, &w[8 * (k - 1)], 6);
        }
    }
}

/* lambda = L^-1 D^-1 b. */
static void rbdi_lambda_solve(rbd_constraints *c, rbdi_rows g) {
    for (int i = g.first; i < g.end; ++i)
        c->lambda[i] = c->inverse[i] * (c->b[i] - rbdi_rows_product(&c->D[i * c->stride + g.low],
                                                                    &c->lambda[g.low], i - g.low));
}

/* The rows of the constraints first .. end - 1, which meet on one link or in the world. */
static rbdi_rows rbdi_rows_between(const rbd_constraints *c, int first, int end) {
    rbdi_rows g = {0, 0, 0, 0};
    g.carried = c->constraint[first].meet >= 0;
    g.first = g.low = c->constraint[first].row;
    g.end = c->constraint[end - 1].row + c->constraint[end - 1].rows;
    for (int k = first; k < end; ++k)
        if (c->constraint[k].low < g.low) g.low = c->constraint[k].low;
    return g;
}

/* What row r, eliminated, takes from the n strands that pass on; those that begin here do not know it. */
static void rbdi_pass_on(rbd_constraints *c, int r, int meet, const int16_t *route, int n) {
    const rbd_real *d = &c->D[r * c->stride], *w = &c->wrench[8 * r];
    for (int s = 0; s < n; ++s) {
        const rbdi_strand a = c->strand[route[s]];
        for (int i = 0; a.link != meet && i < a.rows; ++i) {
            const int row = a.row + i;
            const rbd_real l = d[row] * c->inverse[r];
            c->diagonal[row] = c->diagonal[row] + l * d[row];
            c->b[row] = c->b[row] - l * c->b[r];
            for (int j = 0; j < 6; ++j) a.K[j * RBDI_BATCH + i] = a.K[j * RBDI_BATCH + i] - l * w[j];
            for (int t = 0; t <= s; ++t) {
                const rbdi_strand b = c->strand[route[t]];
                rbd_real *to = &c->D[row * c->stride + b.row];
                for (int j = 0; j < b.rows; ++j) to[j] = to[j] - l * d[b.row + j];
            }
        }
    }
}

/* Eliminates rows whose sides meet on a link; IA and pA become what it then feels of its children. */
static void rbdi_eliminate_rows(rbd_constraints *c, int first, int end, rbdi_abi *IA, rbdi_force *pA,
                                rbdi_mask *doubt) {
    const rbdi_rows g = rbdi_rows_between(c, first, end);
    const rbdi_strand *stop = c->strand + (end < c->n ? c->constraint[end].strand : c->strands);
    rbd_real A[6][6], P[6];
    for (const rbdi_strand *s = c->strand + c->constraint[first].strand; s < stop; s += 2)
        for (int r = 0; r < s->rows; ++r)
            for (int j = 0; j < 6; ++j)
                c->wrench[8 * (s->row + r) + j] = s[0].K[j * RBDI_BATCH + r] + s[1].K[j * RBDI_BATCH + r];
    rbdi_lambda_factor(c, g, doubt);
    rbdi_abi_to_array(*IA, A);
    rbdi_store_force(P, 1, *pA);
    for (int r = g.first; r < g.end; ++r) {
        const rbd_real *w = &c->wrench[8 * r];
        RBDI_UNROLL_SIX for (int i = 0; i < 6; ++i) {
            const rbd_real l = w[i] * c->inverse[r];
            P[i] = P[i] - l * c->b[r];
            RBDI_UNROLL_SIX for (int j = i; j < 6; ++j)
                A[i][j] = A[i][j] + l * w[j];
        }
    }
    *IA = rbdi_abi_from_array(A);
    *pA = rbdi_load_force(P, 1);
}

/* So, and the strands that pass on lose what these rows take. */
static void rbdi_eliminate(rbd_constraints *c, int first, int end, const rbdi_cursor *at, rbdi_abi *IA,
                           rbdi_force *pA, rbdi_mask *doubt) {
    const rbdi_rows g = rbdi_rows_between(c, first, end);
    const int meet = c->constraint[first].meet;
    rbdi_eliminate_rows(c, first, end, IA, pA, doubt);
    for (int r = g.end - 1; r >= g.first && c->piece[meet].strands > 0; --r)
        rbdi_pass_on(c, r, meet, at->route, c->piece[meet].strands);
}

#endif
