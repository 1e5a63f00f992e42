#ifndef RBDI_CONTACT_NEWTON_H
#define RBDI_CONTACT_NEWTON_H
#include "base/memory.h"
#include "contact/laws.h"

/* ---- newton [newton] ----
   Newton's method on p = P(z), whose states are held during a step. With kappa = mu z_n/|z_t| and t across e:

     opens    p = 0                 no unknown
     sticks   u = 0                 three unknowns
     slips    u_n = 0,  t'u + alpha t'p = 0,  alpha = (1 - kappa) d / kappa;  dp = (mu e + n) dp_n + t ds
     bounded  u = 0                 one, none at a bound                                                  (2)

   The second equation of a slip is the linearised direction: friction turns as u turns. With the columns S
   and the rows T of (2)

     G dx = -T'u,   G = T' Delta S + diag(alpha) + proximal diag(trace D),   p += S dx                    (3)

   `proximal` keeps G regular. Points on one rigid foot make Delta singular; with rounding alone on the
   diagonal a step moves far along its null space, and the states never settle. It acts on the increments, not
   on p, so the solution still obeys the laws. S has mu e where T has 0, so G is not symmetric: Gauss
   eliminates it, with row pivots. If nothing slips, S = T: Cholesky takes half of the time. */

/* A new unknown of so many rows from row `first` on. Its equation is u = 0 in the first of them. */
RBDI_INLINE rbdi_contact_unknown *rbdi_new_unknown(rbdi_contact_solver *s, int first, int rows,
                                                   rbd_real scale) {
    rbdi_contact_unknown *x = &s->unknown[s->unknowns++];
    x->first = first;
    x->rows = rows;
    x->scale = scale;
    x->alpha = rbdi_zero();
    for (int j = 0; j < 3; ++j) x->column[j] = x->row[j] = rbdi_set(RBD_C(j == 0));
    return x;
}

/* The scale of a normal: that of the contact, unless its d is far smaller, as under a heavy body on light
   slides, and `proximal` of it would stop the normal. */
RBDI_INLINE rbd_real rbdi_normal_scale(const rbdi_contact_law *law) {
    const rbd_real most = law->d * RBDI_SCALE_SPREAD;
    return most < law->trace ? most : law->trace;
}

/* Lists the unknowns (2). The right-hand sides follow G's columns; rows end with a whole batch. */
RBDI_PART void rbdi_list_unknowns(rbdi_contact_solver *s) {
    s->symmetric = 1;
    s->unknowns = 0;
    for (int i = 0; i < s->given.contacts; ++i) {
        const rbdi_contact_law *law = &s->law[i];
        rbdi_contact_unknown *x;
        if (law->state == RBD_STICKS)
            for (int j = 0; j < 3; ++j)
                (void)rbdi_new_unknown(s, 3 * i + j, 1, j < 2 ? law->trace : rbdi_normal_scale(law));
        if (law->state != RBD_SLIPS) continue;

        /* mu e + n, and u_n = 0 */
        s->symmetric = 0;
        x = rbdi_new_unknown(s, 3 * i, 3, rbdi_normal_scale(law));
        x->column[0] = law->friction * law->e[0];
        x->column[1] = law->friction * law->e[1];
        x->row[0] = rbdi_zero();
        x->column[2] = x->row[2] = rbdi_set(RBD_C(1));
        if (!(law->friction > 0)) continue;

        /* t, and t'u + alpha t'p = 0 */
        x = rbdi_new_unknown(s, 3 * i, 3, law->trace);
        x->column[0] = x->row[0] = -law->e[1];
        x->column[1] = x->row[1] = law->e[0];
        x->alpha = law->alpha;
    }

    for (int i = 0, r = 3 * s->given.contacts; i < s->given.bounded; ++i, ++r)
        if (s->bound[i] == RBD_STICKS) (void)rbdi_new_unknown(s, r, 1, s->given.delta[r * s->rows + r]);

    s->stride = (s->unknowns + s->sides + RBDI_BATCH - 1) / RBDI_BATCH * RBDI_BATCH;
}

/* An unknown's row of T' Delta: one of Delta's, or a sum of three, in s->scratch. */
RBDI_INLINE const rbd_real *rbdi_newton_row(rbdi_contact_solver *s, const rbdi_contact_unknown *x) {
    const rbd_real *delta = &s->given.delta[x->first * s->rows];
    if (x->rows == 1) return delta;
    for (int j = 0; j < s->rows; ++j)
        s->scratch[j] =
            x->row[0] * delta[j] + x->row[1] * delta[s->rows + j] + x->row[2] * delta[2 * s->rows + j];
    return s->scratch;
}

/* y -= factor x, of n right-hand sides: one, but for derivatives. */
RBDI_INLINE void rbdi_subtract_sides(rbd_real *y, rbd_real factor, const rbd_real *x, int n) {
    if (n == 1)
        y[0] = y[0] - factor * x[0];
    else
        rbdi_subtract(y, factor, x, n);
}

/* Row i of G. Where all contacts stick, each unknown is one row: G is symmetric, and its upper triangle is
   enough. One that slips moves three rows by one unknown. */
RBDI_PART void rbdi_newton_row_of_G(rbdi_contact_solver *s, int i, rbd_real *g) {
    const rbdi_contact_unknown *y = s->unknown;
    const rbd_real *row = rbdi_newton_row(s, &s->unknown[i]);

    if (s->symmetric) {
        for (int k = i; k < s->unknowns; ++k) g[k] = row[y[k].first];
        return;
    }
    for (int k = 0; k < s->unknowns; ++k, ++y) {
        g[k] = row[y->first];
        if (y->rows == 3)
            g[k] = g[k] * y->column[0] + row[y->first + 1] * y->column[1] + row[y->first + 2] * y->column[2];
    }
}

/* G, followed by -T'u. u: rows x sides. */
RBDI_PART void rbdi_newton_matrix(rbdi_contact_solver *s, rbd_const proximal, const rbd_real *u) {
    const int n = s->unknowns, stride = s->stride, sides = s->sides;
    rbdi_clear(s->G, n * stride);
    for (int i = 0; i < n; ++i) {
        const rbdi_contact_unknown *x = &s->unknown[i];
        rbd_real *g = &s->G[i * stride];

        rbdi_newton_row_of_G(s, i, g);
        g[i] = g[i] + x->alpha + x->scale * proximal;
        for (int j = 0; j < x->rows; ++j)
            rbdi_subtract_sides(&g[n], x->row[j], &u[(x->first + j) * sides], sides);
    }
}

/* Brings the largest entry of column k on or below the diagonal to the diagonal. Returns 0 if all are 0. */
RBDI_PART int rbdi_newton_pivot(rbdi_contact_solver *s, int k) {
    rbd_real *own = &s->G[k * s->stride], *best = own, largest = rbdi_zero();
    for (rbd_real *g = own; g < &s->G[s->unknowns * s->stride]; g += s->stride) {
        const rbd_real size = rbdi_abs(g[k]);
        if (!(size > largest)) continue;
        best = g;
        largest = size;
    }

    if (best != own) {
        for (int j = k; j < s->unknowns + s->sides; ++j) {
            const rbd_real old = own[j];
            own[j] = best[j];
            best[j] = old;
        }
    }

    return largest > 0;
}

/* Eliminates the entries below the diagonal. Returns 0 if G is singular. Rows are changed in whole batches;
   entries before column k are not read again. */
RBDI_PART int rbdi_newton_gauss(rbdi_contact_solver *s) {
    const int n = s->unknowns, stride = s->stride;
    for (int k = 0; k < n; ++k) {
        const rbd_real *own = &s->G[k * stride];
        const int from = k / RBDI_BATCH * RBDI_BATCH;
        rbd_real inverse;
        if (!rbdi_newton_pivot(s, k)) return 0;

        inverse = 1 / own[k];
        for (int i = k + 1; i < n; ++i) {
            rbd_real *g = &s->G[i * stride];
            rbdi_subtract(g + from, g[k] * inverse, own + from, stride - from);
        }
    }
    return 1;
}

/* R of a symmetric G = R'R, and R'^-1 times the right-hand sides. Returns 0 if G is not positive definite. */
RBDI_PART int rbdi_newton_cholesky(rbdi_contact_solver *s) {
    const int stride = s->stride;
    for (int k = 0; k < s->unknowns; ++k) {
        rbd_real *own = &s->G[k * stride];
        const int from = k / RBDI_BATCH * RBDI_BATCH;
        for (int j = from; j < stride; j += RBDI_BATCH) {
            rbdi_batch out = *(const rbdi_batch *)&own[j];
            for (const rbd_real *g = s->G; g < own; g += stride)
                out = out - *(const rbdi_batch *)&g[j] * g[k];
            *(rbdi_batch *)&own[j] = out;
        }
        if (!(own[k] > 0)) return 0;
        rbdi_multiply(own + from, 1 / rbdi_sqrt(own[k]), stride - from);
    }
    return 1;
}

/* Replaces the right-hand sides by dx. Returns 0 if G is singular. */
RBDI_PART int rbdi_newton_solve(rbdi_contact_solver *s) {
    const int n = s->unknowns, stride = s->stride, sides = s->sides;

    if (!(s->symmetric ? rbdi_newton_cholesky(s) : rbdi_newton_gauss(s))) return 0;

    for (int k = n - 1; k >= 0; --k) {
        rbd_real *g = &s->G[k * stride];
        const rbd_real *x = g + stride + n;
        for (int j = k + 1; j < n; ++j, x += stride) rbdi_subtract_sides(&g[n], g[j], x, sides);
        rbdi_multiply(&g[n], 1 / g[k], sides);
    }
    return 1;
}

/* Moves p to where the states have it: 0 for open contacts, on the cone along e for slipping ones, at the
   bound for rows at a bound. u must be that of p. */
RBDI_PART void rbdi_onto_cones(rbdi_contact_solver *s) {
    for (int i = 0; i < s->given.contacts; ++i) {
        const rbdi_contact_law *law = &s->law[i];
        rbd_real *p = &s->p[3 * i];
        if (law->state == RBD_OPENS) p[0] = p[1] = p[2] = rbdi_zero();
        if (law->state != RBD_SLIPS) continue;
        for (int j = 0; j < 2; ++j) p[j] = law->friction * p[2] * law->e[j];
    }
    for (int i = 0; i < s->given.bounded; ++i)
        if (s->bound[i] != RBD_STICKS)
            s->p[3 * s->given.contacts + i] = rbdi_project_bounded(s, i, &s->bound[i]);
}

/* p += S dx. p: rows x sides. */
RBDI_PART void rbdi_add_increments(const rbdi_contact_solver *s, rbd_real *p) {
    const int n = s->unknowns, sides = s->sides;
    for (int i = 0; i < n; ++i) {
        const rbdi_contact_unknown *x = &s->unknown[i];
        for (int j = 0; j < x->rows; ++j)
            rbdi_subtract_sides(&p[(x->first + j) * sides], -x->column[j], &s->G[i * s->stride + n], sides);
    }
}

RBDI_INLINE void rbdi_copy_rows(const rbdi_contact_solver *s, const rbd_real *from, rbd_real *to) {
    for (int r = 0; r < s->rows; ++r) to[r] = from[r];
}

/* Computes s->full, p after a step of full length. Returns 0 if G is singular. */
RBDI_PART int rbdi_full_step(rbdi_contact_solver *s, rbd_const proximal) {
    rbdi_onto_cones(s);
    rbdi_contact_velocities(s);

    rbdi_list_unknowns(s);
    rbdi_newton_matrix(s, proximal, s->u);
    if (!rbdi_newton_solve(s)) return 0;

    rbdi_add_increments(s, s->p);
    rbdi_copy_rows(s, s->p, s->full);
    return 1;
}

/* The share of the full step at which the first contact opens or the first row reaches its bound. */
RBDI_PART rbd_real rbdi_share_to_bound(const rbdi_contact_solver *s) {
    const int first = 3 * s->given.contacts;
    rbd_real share = rbdi_set(RBD_C(1));
    for (int r = first > 0 ? 2 : 0; r < s->rows; r += r < first - 1 ? 3 : 1) {
        const rbd_real from = s->start[r], step = s->full[r] - from;
        rbd_real bound = step < 0 ? rbdi_zero() : rbdi_set(RBDI_UNBOUNDED);
        if (r >= first) bound = step < 0 ? s->given.lower[r - first] : s->given.upper[r - first];
        if (rbdi_abs(step) * share > rbdi_abs(bound - from)) share = (bound - from) / step;
    }
    return share;
}

/* Takes a Newton step that reduces the residual to less than `gain` of it: the full step, the step up to the
   first bound, or a share of the full step. If none does, returns 0, with p, u and states as they were. */
RBDI_PART int rbdi_newton_step(rbdi_contact_solver *s, rbd_const proximal) {
    const rbd_const gain[4] = {RBD_C(0.98), RBD_C(1), RBD_C(0.9), RBD_C(0.9)},
                    shorter[4] = {RBD_C(1), RBD_C(1), RBD_C(0.3), RBD_C(0.09)};
    const rbd_real before = s->solution.residual;
    rbdi_copy_rows(s, s->p, s->start);

    for (int i = rbdi_full_step(s, proximal) ? 0 : 4; i < 4; ++i) {
        const rbd_real share = i == 1 ? rbdi_share_to_bound(s) : rbdi_set(shorter[i]);

        if (i > 0) { /* p is the full step already */
            for (int r = 0; r < s->rows; ++r) s->p[r] = s->start[r] + (s->full[r] - s->start[r]) * share;
        }
        (void)rbdi_into_cones(s, 0);
        rbdi_contact_residual(s);
        if (s->solution.residual < before * gain[i]) return 1;
    }

    rbdi_copy_rows(s, s->start, s->p);
    rbdi_contact_residual(s);
    return 0;
}

#endif
