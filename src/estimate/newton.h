#ifndef RBDI_ESTIMATE_NEWTON_H
#define RBDI_ESTIMATE_NEWTON_H
#include "estimate/pseudo_inertia.h"
#include "estimate/triangles.h"

/* ---- newton [newton] ---- */

/* The payload's triangle with the prior in it, T; its right side is that of p - P. */
RBDI_PART void rbdi_load_triangle(const rbd_estimate *e, rbd_real T[RBDI_LOAD_TRIANGLE]) {
    rbd_real x[RBDI_TEN_ROW];
    for (int k = 0; k < RBDI_LOAD_TRIANGLE; ++k) T[k] = e->load[k];

    for (int k = 0; k < RBDI_TEN; ++k) {
        rbd_real *row = T + k * RBDI_TEN_ROW;
        for (int j = k; j < RBDI_TEN; ++j) row[RBDI_TEN] = row[RBDI_TEN] - row[j] * e->P[j];
    }
    for (int k = 0; k < RBDI_TEN; ++k)
        rbdi_absorb_one(T, RBDI_TEN, RBDI_TEN_ROW, k, rbdi_set(RBD_C(1)), -e->P[k], x);
}

/* Adds weight (|D|^2 / 2 - tr D) as rows: root D_aa = root, root sqrt(2) D_ab = 0, root = sqrt(weight). */
RBDI_LOCAL void rbdi_absorb_barrier(const rbd_estimate *e, const rbd_real L[RBDI_TEN],
                                    rbd_real T[RBDI_LOAD_TRIANGLE]) {
    const rbd_real root = rbdi_sqrt(e->weight), twice = rbdi_sqrt(2 * e->weight);
    rbd_real G[RBDI_TEN], x[RBDI_TEN_ROW];
    rbdi_invert_pseudo(L, G);

    for (int a = 0; a < 4; ++a)
        for (int b = 0; b <= a; ++b) {
            rbdi_barrier_row(G, a, b, a == b ? root : twice, x);
            x[RBDI_TEN] = a == b ? root : rbdi_zero();
            rbdi_absorb(T, RBDI_TEN, RBDI_TEN_ROW, x);
        }
}

/* The weight after a step that was cut, or a full one. */
RBDI_LOCAL rbd_real rbdi_next_weight(rbd_real weight, int cut) {
    const rbd_real next = weight * (cut ? RBDI_ESTIMATE_MORE : RBDI_ESTIMATE_LESS);
    if (next > RBDI_ESTIMATE_MOST) return rbdi_set(RBDI_ESTIMATE_MOST);
    return next > RBDI_ESTIMATE_LEAST ? next : rbdi_set(RBDI_ESTIMATE_LEAST);
}

/* Moves along the step as far as the result is a body, not quite to the rim. */
RBDI_LOCAL void rbdi_move_inside(rbd_estimate *e, const rbd_real step[RBDI_TEN]) {
    rbd_real share = rbdi_set(RBD_C(1)), P[RBDI_TEN], L[RBDI_TEN];

    for (int cut = 0; cut <= RBDI_ESTIMATE_CUTS; ++cut) {
        for (int k = 0; k < RBDI_TEN; ++k) P[k] = e->P[k] + share * step[k];
        if (rbdi_factor_pseudo(P, L)) {
            for (int k = 0; k < RBDI_TEN; ++k) e->P[k] = P[k];
            e->weight = rbdi_next_weight(e->weight, cut > 0);
            return;
        }
        share = share * (cut ? RBD_C(0.5) : RBDI_ESTIMATE_SHORT * RBD_C(0.5));
    }
    e->weight = rbdi_next_weight(e->weight, 1);
}

/* One step of Newton's method. */
RBDI_PART void rbdi_improve_load(rbd_estimate *e) {
    rbd_real T[RBDI_LOAD_TRIANGLE], L[RBDI_TEN], step[RBDI_TEN];
    if (!rbdi_factor_pseudo(e->P, L)) return; /* never: it is inside */

    rbdi_load_triangle(e, T);
    rbdi_absorb_barrier(e, L, T);
    for (int k = 0; k < RBDI_TEN; ++k) step[k] = T[k * RBDI_TEN_ROW + RBDI_TEN];
    rbdi_solve_upper(T, RBDI_TEN, RBDI_TEN_ROW, step);
    rbdi_move_inside(e, step);
}

#endif
