#ifndef RBDI_IK_SEARCH_H
#define RBDI_IK_SEARCH_H
#include "ik/targets.h"

/* ---- search [search] ---- */

RBDI_LOCAL void rbdi_ik_copy(const rbd_real *from, int n, rbd_real *to) {
    for (int i = 0; i < n; ++i) to[i] = from[i];
}

/* Whether there are evaluations left. */
RBDI_INLINE int rbdi_ik_may_go_on(const rbdi_ik *k) {
    return k->result->evaluations < k->options.evaluations;
}

/* Whether the errors of the last evaluation are within the tolerances. */
RBDI_INLINE int rbdi_ik_is_reached(const rbdi_ik *k) {
    return k->result->metres <= k->options.metres && k->result->radians <= k->options.radians &&
           k->cost < RBDI_IK_OVERFLOW;
}

/* Keeps the place q of the last evaluation if it is the best so far. */
RBDI_LOCAL void rbdi_ik_keep(rbdi_ik *k, const rbd_real *q) {
    if (!(k->cost < k->best_cost)) return;
    k->best_cost = k->cost;
    rbdi_ik_copy(q, k->m->nq, k->best);
}

/* The root above 1 of x^(n + 1) = x + 1, by Newton's method. It comes from above: (1 + 1/n)^n >= 2. */
RBDI_LOCAL rbd_real rbdi_ik_golden(int n) {
    const rbd_real one = rbdi_set(RBD_C(1)), count = rbdi_set((rbd_const)n);
    rbd_real x = one + one / count;

    for (int i = 0; i < RBDI_IK_NEWTON; ++i) {
        rbd_real power = one; /* x^n */
        for (int j = 0; j < n; ++j) power = power * x;
        x = x - (power * x - x - one) / ((count + one) * power - one);
    }

    return x;
}

/* q of a start: the caller's; then share frac(1/2 + start golden^-(i + 1)) of the range of the ith dof. Any
   number of first starts is spread evenly (Roberts 2018). */
RBDI_LOCAL void rbdi_ik_start(rbdi_ik *k, int start) {
    const rbd_real pi = rbdi_set(RBDI_PI(rbd_const));
    rbd_real golden, part = rbdi_set((rbd_const)start);

    rbdi_ik_copy(k->from, k->m->nq, k->q);
    if (start == 0 || k->dofs == 0) return;

    golden = rbdi_ik_golden(k->dofs);
    for (int i = 0; i < k->dofs; ++i) {
        rbdi_ik_dof *f = &k->dof[i];
        rbd_real share;

        part = part / golden;
        share = part + RBD_C(0.5);
        share = share - (rbd_const)(int)share;

        f->hold = RBDI_IK_FREE;
        k->d[i] = f->turns ? (share + share - RBD_C(1)) * pi : rbdi_zero();
        if (f->at >= 0) k->d[i] = f->lower + share * (f->upper - f->lower) - k->q[f->at];
    }
    rbdi_ik_move(k, rbdi_set(RBD_C(1)), k->q);
}

/* A start of the search. Returns whether it reaches the targets. */
RBDI_LOCAL int rbdi_ik_search(rbdi_ik *k) {
    const rbd_real far = RBDI_IK_FAR * k->options.length * k->options.length;
    rbd_real mark = rbdi_set(RBDI_IK_OVERFLOW);
    int stalled = 0;

    for (int step = 0; step < RBDI_IK_STEPS && rbdi_ik_may_go_on(k); ++step) {
        rbd_real damping, least;
        rbdi_ik_errors(k, k->q);
        rbdi_ik_keep(k, k->q);
        if (rbdi_ik_is_reached(k)) return 1;

        if (k->cost < RBD_C(0.25) * mark) {
            mark = k->cost;
            stalled = 0;
        } else if (++stalled >= RBDI_IK_STALL) {
            return 0;
        }

        rbdi_ik_jacobian(k);
        least = RBDI_IK_FLOOR * rbdi_ik_normal(k) + RBDI_TINY;
        damping = RBDI_IK_DAMPING * (k->cost < far ? k->cost : far);
        rbdi_ik_step(k, damping, least);
        rbdi_ik_move(k, rbdi_ik_share(k), k->q);
    }

    return 0;
}

/* Goes down from q by at most so many steps that bring the error down, until one does by less than a share
   `end`. Returns whether it reaches the targets. The damping follows Marquardt (1963). */
RBDI_LOCAL int rbdi_ik_descend(rbdi_ik *k, int steps, rbd_const end) {
    const rbd_real square = k->options.length * k->options.length;
    rbd_real damping = RBD_C(0.01) * square, cost, least = rbdi_zero();
    int fresh = 1;

    rbdi_ik_errors(k, k->q);
    cost = k->cost;
    rbdi_ik_keep(k, k->q);

    for (int step = 0; step < steps && rbdi_ik_may_go_on(k) && damping < RBD_C(1e9) * square; ++step) {
        if (rbdi_ik_is_reached(k)) return 1;
        if (fresh) {
            rbdi_ik_jacobian(k);
            least = RBDI_IK_FLOOR * rbdi_ik_normal(k) + RBDI_TINY;
        }

        rbdi_ik_step(k, damping, least);
        rbdi_ik_move(k, rbdi_set(RBD_C(1)), k->trial);
        rbdi_ik_errors(k, k->trial);
        fresh = k->cost < cost;
        damping = damping * RBD_C(fresh ? 0.2 : 5);
        if (!fresh) continue;

        rbdi_ik_keep(k, k->trial);
        rbdi_ik_copy(k->trial, k->m->nq, k->q);
        if (cost - k->cost < end * cost) break;
        cost = k->cost;
    }

    return rbdi_ik_is_reached(k);
}

/* Descents from the best place and from the first starts, then a long one from the best of all. Returns
   whether one reaches the targets. */
RBDI_LOCAL int rbdi_ik_find_nearest(rbdi_ik *k) {
    const int descents = k->options.starts < RBDI_IK_DESCENTS ? k->options.starts : RBDI_IK_DESCENTS;

    for (int i = 0; i < descents; ++i) {
        if (i > 0)
            rbdi_ik_start(k, i);
        else
            rbdi_ik_copy(k->best, k->m->nq, k->q);
        if (rbdi_ik_descend(k, RBDI_IK_STEPS, RBDI_IK_COARSE)) return 1;
    }

    rbdi_ik_copy(k->best, k->m->nq, k->q);
    return rbdi_ik_descend(k, RBDI_IK_LAST * RBDI_IK_STEPS, RBDI_IK_FINE);
}

/* Says why the targets are not reached at q: by the cosines of the angles between e and the columns of J. */
RBDI_LOCAL rbd_ik_status rbdi_ik_judge(rbdi_ik *k) {
    rbd_real most = rbdi_zero(), left = rbdi_zero();

    rbdi_ik_errors(k, k->q);
    rbdi_ik_jacobian(k);
    rbdi_ik_normal(k);

    for (int i = 0; i < k->dofs; ++i) {
        const rbd_real size = rbdi_sqrt(k->H[rbdi_ik_row(i) + i] * k->cost);
        const rbd_real cosine = size > 0 ? rbdi_abs(k->g[i]) / size : rbdi_zero();

        if (!rbdi_ik_pressed(k, i)) {
            left = rbdi_ik_larger(left, cosine);
        } else if (cosine > RBDI_IK_PRESSED) {
            ++k->result->limits;
            if (cosine > most) k->result->limit = k->dof[i].dof;
            most = rbdi_ik_larger(most, cosine);
        }
    }

    if (left > RBDI_IK_SETTLED) return RBD_IK_EVALUATIONS;
    return k->result->limits > 0 ? RBD_IK_AT_LIMIT : RBD_IK_NEAREST;
}

#endif
