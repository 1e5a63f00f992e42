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
typedef struct rbdi_est_interior {
    rbd_real Z[RBDI_EST_TEN];
    rbd_real inverse[RBDI_EST_TEN];                                  /* of P */
    rbd_real all[RBDI_EST_LOAD_TRIANGLE], T[RBDI_EST_LOAD_TRIANGLE]; /* of samples and prior; of a round */
    rbd_real P_step[RBDI_EST_TEN], Z_step[RBDI_EST_TEN];
    rbd_real weight, share; /* share of the last step that was taken */
} rbdi_est_interior;

/* The payload's triangle with the prior in it, T p = z. */
RBDI_PART void rbdi_est_load_triangle(const rbd_estimate *e, rbd_real T[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real x[RBDI_EST_TEN_ROW];
    for (int k = 0; k < RBDI_EST_LOAD_TRIANGLE; ++k) T[k] = e->load[k];
    for (int k = 0; k < RBDI_EST_TEN; ++k)
        rbdi_est_absorb_one(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, k, rbdi_set(RBD_C(1)), rbdi_zero(), x);
}

/* Its right side at P: T E = z - T P for the step E. */
RBDI_LOCAL void rbdi_est_triangle_at(const rbd_real all[RBDI_EST_LOAD_TRIANGLE],
                                     const rbd_real P[RBDI_EST_TEN], rbd_real T[RBDI_EST_LOAD_TRIANGLE]) {
    for (int k = 0; k < RBDI_EST_LOAD_TRIANGLE; ++k) T[k] = all[k];
    for (int k = 0; k < RBDI_EST_TEN; ++k) {
        rbd_real *row = T + k * RBDI_EST_TEN_ROW;
        for (int j = k; j < RBDI_EST_TEN; ++j) row[RBDI_EST_TEN] = row[RBDI_EST_TEN] - row[j] * P[j];
    }
}

/* Takes the rows G E Q = 0 into T, by the entries of E; those below the diagonal stand for two. */
RBDI_LOCAL void rbdi_est_absorb_barrier(const rbd_real G[RBDI_EST_TEN], const rbd_real Q[RBDI_EST_TEN],
                                        rbd_real T[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real x[RBDI_EST_TEN_ROW];
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j <= i; ++j) {
                    rbd_real sum = rbdi_est_lower(G, a, i) * rbdi_est_lower(Q, j, b);
                    if (j < i) sum = sum + rbdi_est_lower(G, a, j) * rbdi_est_lower(Q, i, b);
                    x[rbdi_est_packed_at(i, j)] = sum;
                }

            x[RBDI_EST_TEN] = rbdi_zero();
            rbdi_est_absorb(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, x);
        }
}

/* The step E for C: T'T E = T'r + the gradient of tr(C E). */
RBDI_LOCAL void rbdi_est_step_of(const rbd_real T[RBDI_EST_LOAD_TRIANGLE], const rbd_real C[RBDI_EST_TEN],
                                 rbd_real E[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j)
            E[rbdi_est_packed_at(i, j)] = C[rbdi_est_packed_at(i, j)] * (j < i ? RBD_C(2) : RBD_C(1));

    rbdi_est_solve_lower(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, E);
    for (int k = 0; k < RBDI_EST_TEN; ++k) E[k] = E[k] + T[k * RBDI_EST_TEN_ROW + RBDI_EST_TEN];
    rbdi_est_solve_upper(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, E);
}

/* C -= (X + X') / 2, X = A E F, of symmetric matrices. */
RBDI_LOCAL void rbdi_est_subtract_mean(const rbd_real A[RBDI_EST_TEN], const rbd_real E[RBDI_EST_TEN],
                                       const rbd_real F[RBDI_EST_TEN], rbd_real C[RBDI_EST_TEN]) {
    rbd_real Y[4][4], X[4][4];
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            Y[i][j] = rbdi_zero();
            for (int k = 0; k < 4; ++k)
                Y[i][j] = Y[i][j] + rbdi_est_symmetric(E, i, k) * rbdi_est_symmetric(F, k, j);
        }
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            X[i][j] = rbdi_zero();
            for (int k = 0; k < 4; ++k) X[i][j] = X[i][j] + rbdi_est_symmetric(A, i, k) * Y[k][j];
        }

    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) {
            const int at = rbdi_est_packed_at(i, j);
            C[at] = C[at] - (X[i][j] + X[j][i]) * RBD_C(0.5);
        }
}

/* x += step, or nearly as much of it as leaves it positive definite, by bisection. Returns the share. */
RBDI_LOCAL rbd_real rbdi_est_move_inside(rbd_real x[RBDI_EST_TEN], const rbd_real step[RBDI_EST_TEN]) {
    rbd_real inside = rbdi_zero(), outside = rbdi_set(RBD_C(2)), next[RBDI_EST_TEN], L[RBDI_EST_TEN];
    for (int cut = 0; cut <= RBDI_EST_CUTS && inside < 1; ++cut) {
        const rbd_real share = (inside + outside) * RBD_C(0.5);
        for (int k = 0; k < RBDI_EST_TEN; ++k) next[k] = x[k] + share * step[k];
        if (rbdi_est_factor_pseudo(next, L)) {
            inside = share;
        } else {
            outside = share;
        }
    }

    if (inside < 1) inside = inside * RBDI_EST_SHORT;
    for (int k = 0; k < RBDI_EST_TEN; ++k) x[k] = x[k] + inside * step[k];
    return inside;
}

/* tr(P Z) / 4. */
RBDI_LOCAL rbd_real rbdi_est_mean_product(const rbd_real P[RBDI_EST_TEN], const rbd_real Z[RBDI_EST_TEN]) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) sum = sum + rbdi_est_symmetric(P, i, j) * rbdi_est_symmetric(Z, i, j);
    return sum * RBD_C(0.25);
}

/* A share of tr(P Z) / 4: a tenth after full steps, nearly all of it after short ones. */
RBDI_LOCAL rbd_real rbdi_est_next_weight(const rbd_estimate *e, const rbdi_est_interior *s) {
    const rbd_real rest = 1 - s->share, least = rbdi_set(RBDI_EST_LESS);
    const rbd_real weight = (least + (1 - least) * rest * rest) * rbdi_est_mean_product(e->P, s->Z);
    return weight > RBDI_EST_LEAST ? weight : rbdi_set(RBDI_EST_LEAST);
}

/* Whether a step changes no entry of the diagonal much. */
RBDI_LOCAL int rbdi_est_is_small_step(const rbd_real P[RBDI_EST_TEN], const rbd_real step[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i) {
        const int at = rbdi_est_packed_at(i, i);
        if (rbdi_abs(step[at]) > RBDI_EST_SMALL * P[at]) return 0;
    }
    return 1;
}

/* One round. Returns whether it was the last: a small step at the least weight, or rounding has brought Z to
   the rim. */
RBDI_LOCAL int rbdi_est_round(rbd_estimate *e, rbdi_est_interior *s) {
    rbd_real L[RBDI_EST_TEN], G[RBDI_EST_TEN], Q[RBDI_EST_TEN], C[RBDI_EST_TEN], P_share, Z_share;
    if (!rbdi_est_factor_pseudo(e->P, L) || !rbdi_est_factor_pseudo(s->Z, Q)) return 1;

    rbdi_est_invert_lower(L, G);
    rbdi_est_square(G, s->inverse);
    rbdi_est_triangle_at(s->all, e->P, s->T);
    rbdi_est_absorb_barrier(G, Q, s->T);

    s->weight = rbdi_est_next_weight(e, s);
    for (int k = 0; k < RBDI_EST_TEN; ++k) C[k] = s->weight * s->inverse[k];
    rbdi_est_step_of(s->T, C, s->P_step);
    for (int k = 0; k < RBDI_EST_TEN; ++k) s->Z_step[k] = C[k] - s->Z[k];
    rbdi_est_subtract_mean(s->inverse, s->P_step, s->Z, s->Z_step);

    P_share = rbdi_est_move_inside(e->P, s->P_step);
    Z_share = rbdi_est_move_inside(s->Z, s->Z_step);
    s->share = P_share < Z_share ? P_share : Z_share;
    if (s->share < RBDI_EST_JAM) /* the products of P and Z differ too much: make them equal */
        for (int k = 0; k < RBDI_EST_TEN; ++k) s->Z[k] = s->weight * s->inverse[k];
    return !(s->weight > RBDI_EST_LEAST) && rbdi_est_is_small_step(e->P, s->P_step);
}

/* Z = weight P^-1 at the ball. The weight is on the way from the least to one that counts as much as the
   samples. */
RBDI_LOCAL void rbdi_est_begin_interior(rbd_estimate *e, rbdi_est_interior *s) {
    rbd_real weight = rbdi_set(RBD_C(1));
    for (int k = 0; k < RBDI_EST_TEN; ++k) {
        const rbd_real pivot = e->load[k * (RBDI_EST_TEN_ROW + 1)];
        weight = weight + pivot;
    }

    s->share = rbdi_zero();
    rbdi_est_begin_ball(e->P);
    rbdi_clear(s->Z, RBDI_EST_TEN);
    for (int i = 0; i < 4; ++i) s->Z[rbdi_est_packed_at(i, i)] = weight / e->P[rbdi_est_packed_at(i, i)];
}

/* The optimum without a barrier. Returns whether it is a body. */
RBDI_LOCAL int rbdi_est_find_free_load(rbd_estimate *e, const rbd_real all[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real P[RBDI_EST_TEN], L[RBDI_EST_TEN];
    for (int k = 0; k < RBDI_EST_TEN; ++k) P[k] = all[k * RBDI_EST_TEN_ROW + RBDI_EST_TEN];
    rbdi_est_solve_upper(all, RBDI_EST_TEN, RBDI_EST_TEN_ROW, P);
    if (!rbdi_est_factor_pseudo(P, L)) return 0;

    for (int k = 0; k < RBDI_EST_TEN; ++k) e->P[k] = P[k];
    return 1;
}

/* The optimum: without a barrier, if that is a body; else inside. */
RBDI_PART void rbdi_est_find_load(rbd_estimate *e) {
    rbdi_est_interior s;
    rbdi_est_load_triangle(e, s.all);
    if (rbdi_est_find_free_load(e, s.all)) return;

    rbdi_est_begin_interior(e, &s);
    for (int k = 0; k < RBDI_EST_ROUNDS; ++k)
        if (rbdi_est_round(e, &s)) return;
}

#endif
