#ifndef RBDI_ESTIMATE_NEWTON_H
#define RBDI_ESTIMATE_NEWTON_H
#include "base/memory.h"
#include "estimate/triangles.h"
#include "estimate/pseudo_inertia.h"

/* ---- newton [newton] ----
   The primal-dual method of interior points of Helmberg, Rendl, Vanderbei and Wolkowicz (1996). Beside P
   stands a multiplier Z, positive definite, which ends at weight P^-1. To second order, with P = L L',
   G = L^-1 and Z = Q Q', a step E of P minimises

       |R p - z|^2 / 2 + |p|^2 / 2 + |G E Q|^2 / 2 - weight tr(P^-1 E)   at p + E,
       while Z takes the step   weight P^-1 - Z - (P^-1 E Z + Z E P^-1) / 2,

   that is triangles again: the rows G E Q come to those of the samples. Where Z = weight P^-1 it is Newton's
   step; elsewhere it is better near the rim. */

/* An iterate. P is in the estimate. */
typedef struct rbdi_interior {
    rbd_real Z[RBDI_TEN];
    rbd_real inverse[RBDI_TEN];                              /* of P */
    rbd_real all[RBDI_LOAD_TRIANGLE], T[RBDI_LOAD_TRIANGLE]; /* of samples and prior; of a round */
    rbd_real P_step[RBDI_TEN], Z_step[RBDI_TEN];
    rbd_real weight, share; /* share of the last step that was taken */
} rbdi_interior;

/* The payload's triangle with the prior in it, T p = z. */
RBDI_PART void rbdi_load_triangle(const rbd_estimate *e, rbd_real T[RBDI_LOAD_TRIANGLE]) {
    rbd_real x[RBDI_TEN_ROW];
    for (int k = 0; k < RBDI_LOAD_TRIANGLE; ++k) T[k] = e->load[k];
    for (int k = 0; k < RBDI_TEN; ++k)
        rbdi_absorb_one(T, RBDI_TEN, RBDI_TEN_ROW, k, rbdi_set(RBD_C(1)), rbdi_zero(), x);
}

/* Its right side at P: T E = z - T P for the step E. */
RBDI_LOCAL void rbdi_triangle_at(const rbd_real all[RBDI_LOAD_TRIANGLE], const rbd_real P[RBDI_TEN],
                                 rbd_real T[RBDI_LOAD_TRIANGLE]) {
    for (int k = 0; k < RBDI_LOAD_TRIANGLE; ++k) T[k] = all[k];
    for (int k = 0; k < RBDI_TEN; ++k) {
        rbd_real *row = T + k * RBDI_TEN_ROW;
        for (int j = k; j < RBDI_TEN; ++j) row[RBDI_TEN] = row[RBDI_TEN] - row[j] * P[j];
    }
}

/* Takes the rows G E Q = 0 into T, by the entries of E; those below the diagonal stand for two. */
RBDI_LOCAL void rbdi_absorb_barrier(const rbd_real G[RBDI_TEN], const rbd_real Q[RBDI_TEN],
                                    rbd_real T[RBDI_LOAD_TRIANGLE]) {
    rbd_real x[RBDI_TEN_ROW];
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j <= i; ++j) {
                    rbd_real sum = rbdi_lower(G, a, i) * rbdi_lower(Q, j, b);
                    if (j < i) sum = sum + rbdi_lower(G, a, j) * rbdi_lower(Q, i, b);
                    x[rbdi_packed_at(i, j)] = sum;
                }

            x[RBDI_TEN] = rbdi_zero();
            rbdi_absorb(T, RBDI_TEN, RBDI_TEN_ROW, x);
        }
}

/* The step E for C: T'T E = T'r + the gradient of tr(C E). */
RBDI_LOCAL void rbdi_step_of(const rbd_real T[RBDI_LOAD_TRIANGLE], const rbd_real C[RBDI_TEN],
                             rbd_real E[RBDI_TEN]) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j)
            E[rbdi_packed_at(i, j)] = C[rbdi_packed_at(i, j)] * (j < i ? RBD_C(2) : RBD_C(1));

    rbdi_solve_lower(T, RBDI_TEN, RBDI_TEN_ROW, E);
    for (int k = 0; k < RBDI_TEN; ++k) E[k] = E[k] + T[k * RBDI_TEN_ROW + RBDI_TEN];
    rbdi_solve_upper(T, RBDI_TEN, RBDI_TEN_ROW, E);
}

/* C -= (X + X') / 2, X = A E F, of symmetric matrices. */
RBDI_LOCAL void rbdi_subtract_mean(const rbd_real A[RBDI_TEN], const rbd_real E[RBDI_TEN],
                                   const rbd_real F[RBDI_TEN], rbd_real C[RBDI_TEN]) {
    rbd_real Y[4][4], X[4][4];
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            Y[i][j] = rbdi_zero();
            for (int k = 0; k < 4; ++k) Y[i][j] = Y[i][j] + rbdi_symmetric(E, i, k) * rbdi_symmetric(F, k, j);
        }
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            X[i][j] = rbdi_zero();
            for (int k = 0; k < 4; ++k) X[i][j] = X[i][j] + rbdi_symmetric(A, i, k) * Y[k][j];
        }

    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) {
            const int at = rbdi_packed_at(i, j);
            C[at] = C[at] - (X[i][j] + X[j][i]) * RBD_C(0.5);
        }
}

/* x += step, or nearly as much of it as leaves it positive definite, by bisection. Returns the share. */
RBDI_LOCAL rbd_real rbdi_move_inside(rbd_real x[RBDI_TEN], const rbd_real step[RBDI_TEN]) {
    rbd_real inside = rbdi_zero(), outside = rbdi_set(RBD_C(2)), next[RBDI_TEN], L[RBDI_TEN];
    for (int cut = 0; cut <= RBDI_ESTIMATE_CUTS && inside < 1; ++cut) {
        const rbd_real share = (inside + outside) * RBD_C(0.5);
        for (int k = 0; k < RBDI_TEN; ++k) next[k] = x[k] + share * step[k];
        if (rbdi_factor_pseudo(next, L)) {
            inside = share;
        } else {
            outside = share;
        }
    }

    if (inside < 1) inside = inside * RBDI_ESTIMATE_SHORT;
    for (int k = 0; k < RBDI_TEN; ++k) x[k] = x[k] + inside * step[k];
    return inside;
}

/* tr(P Z) / 4. */
RBDI_LOCAL rbd_real rbdi_mean_product(const rbd_real P[RBDI_TEN], const rbd_real Z[RBDI_TEN]) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) sum = sum + rbdi_symmetric(P, i, j) * rbdi_symmetric(Z, i, j);
    return sum * RBD_C(0.25);
}

/* A share of tr(P Z) / 4: a tenth after full steps, nearly all of it after short ones. */
RBDI_LOCAL rbd_real rbdi_next_weight(const rbd_estimate *e, const rbdi_interior *s) {
    const rbd_real rest = 1 - s->share, least = rbdi_set(RBDI_ESTIMATE_LESS);
    const rbd_real weight = (least + (1 - least) * rest * rest) * rbdi_mean_product(e->P, s->Z);
    return weight > RBDI_ESTIMATE_LEAST ? weight : rbdi_set(RBDI_ESTIMATE_LEAST);
}

/* Whether a step changes no entry of the diagonal much. */
RBDI_LOCAL int rbdi_is_small_step(const rbd_real P[RBDI_TEN], const rbd_real step[RBDI_TEN]) {
    for (int i = 0; i < 4; ++i) {
        const int at = rbdi_packed_at(i, i);
        if (rbdi_abs(step[at]) > RBDI_ESTIMATE_SMALL * P[at]) return 0;
    }
    return 1;
}

/* One round. Returns whether it was the last: a small step at the least weight, or rounding has brought Z to
   the rim. */
RBDI_LOCAL int rbdi_round(rbd_estimate *e, rbdi_interior *s) {
    rbd_real L[RBDI_TEN], G[RBDI_TEN], Q[RBDI_TEN], C[RBDI_TEN], P_share, Z_share;
    if (!rbdi_factor_pseudo(e->P, L) || !rbdi_factor_pseudo(s->Z, Q)) return 1;

    rbdi_invert_lower(L, G);
    rbdi_square(G, s->inverse);
    rbdi_triangle_at(s->all, e->P, s->T);
    rbdi_absorb_barrier(G, Q, s->T);

    s->weight = rbdi_next_weight(e, s);
    for (int k = 0; k < RBDI_TEN; ++k) C[k] = s->weight * s->inverse[k];
    rbdi_step_of(s->T, C, s->P_step);
    for (int k = 0; k < RBDI_TEN; ++k) s->Z_step[k] = C[k] - s->Z[k];
    rbdi_subtract_mean(s->inverse, s->P_step, s->Z, s->Z_step);

    P_share = rbdi_move_inside(e->P, s->P_step);
    Z_share = rbdi_move_inside(s->Z, s->Z_step);
    s->share = P_share < Z_share ? P_share : Z_share;
    if (s->share < RBDI_ESTIMATE_JAM) /* the products of P and Z differ too much: make them equal */
        for (int k = 0; k < RBDI_TEN; ++k) s->Z[k] = s->weight * s->inverse[k];
    return !(s->weight > RBDI_ESTIMATE_LEAST) && rbdi_is_small_step(e->P, s->P_step);
}

/* Z = weight P^-1 at the ball. The weight is on the way from the least to one that counts as much as the
   samples. */
RBDI_LOCAL void rbdi_begin_interior(rbd_estimate *e, rbdi_interior *s) {
    rbd_real weight = rbdi_set(RBD_C(1));
    for (int k = 0; k < RBDI_TEN; ++k) {
        const rbd_real pivot = e->load[k * (RBDI_TEN_ROW + 1)];
        weight = weight + pivot;
    }

    s->share = rbdi_zero();
    rbdi_begin_ball(e->P);
    rbdi_clear(s->Z, RBDI_TEN);
    for (int i = 0; i < 4; ++i) s->Z[rbdi_packed_at(i, i)] = weight / e->P[rbdi_packed_at(i, i)];
}

/* The optimum without a barrier. Returns whether it is a body. */
RBDI_LOCAL int rbdi_find_free_load(rbd_estimate *e, const rbd_real all[RBDI_LOAD_TRIANGLE]) {
    rbd_real P[RBDI_TEN], L[RBDI_TEN];
    for (int k = 0; k < RBDI_TEN; ++k) P[k] = all[k * RBDI_TEN_ROW + RBDI_TEN];
    rbdi_solve_upper(all, RBDI_TEN, RBDI_TEN_ROW, P);
    if (!rbdi_factor_pseudo(P, L)) return 0;

    for (int k = 0; k < RBDI_TEN; ++k) e->P[k] = P[k];
    return 1;
}

/* The optimum: without a barrier, if that is a body; else inside. */
RBDI_PART void rbdi_find_load(rbd_estimate *e) {
    rbdi_interior s;
    rbdi_load_triangle(e, s.all);
    if (rbdi_find_free_load(e, s.all)) return;

    rbdi_begin_interior(e, &s);
    for (int k = 0; k < RBDI_ESTIMATE_ROUNDS; ++k)
        if (rbdi_round(e, &s)) return;
}

#endif
