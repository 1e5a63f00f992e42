#ifndef RBDI_IK_SEARCH_H
#define RBDI_IK_SEARCH_H
#include "ik/step.h"
#include "ik/curvature.h"

/* ---- search [search] ---- */

/* Whether there are evaluations left, but for the last one, which judges. */
RBDI_INLINE int rbdi_ik_may_go_on(const rbdi_ik *ik) {
    return ik->result->evaluations == 0 || ik->result->evaluations < ik->options.evaluations - 1;
}

/* Whether the errors of the last evaluation are within the tolerances. */
RBDI_INLINE int rbdi_ik_is_reached(const rbdi_ik *ik) {
    return ik->result->metres <= ik->options.metres && ik->result->radians <= ik->options.radians &&
           ik->cost < RBDI_IK_OVERFLOW;
}

/* Keeps the place q of the last evaluation if it is the best so far. */
RBDI_LOCAL void rbdi_ik_keep(rbdi_ik *ik, const rbd_real *q) {
    if (!(ik->cost < ik->best_cost)) return;
    ik->best_cost = ik->cost;
    rbdi_ik_copy(q, ik->m->nq, ik->best);
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

/* How far from q starts are drawn where limits are wide. An angle goes as far as one turn, a slide as far as
   RBDI_IK_WIDE lengths. If joints mimic this one at a smaller ratio, the slowest of them goes as far. A screw
   of little pitch goes on until it has slid as far as a slide. */
RBDI_LOCAL rbd_real rbdi_ik_wide(const rbdi_ik *ik, const rbdi_ik_dof *f) {
    const rbdi_frame *u = &ik->m->frame[ik->m->dof[f->dof].body];
    const rbd_real slide = RBDI_IK_WIDE * ik->options.length,
                   pitch = rbdi_abs(rbdi_set(ik->m->link[u->link].kappa));
    rbd_real most = f->turns ? rbdi_set(2 * RBDI_PI(rbd_const)) : slide;
    rbd_real least = rbdi_set(RBD_C(1)); /* of the ratios */

    for (int j = 0; j < rbdi_mimics(ik->m); ++j)
        if (ik->m->mimic[j].source_v == f->dof)
            least = rbdi_smaller(least, rbdi_abs(rbdi_set(ik->m->mimic[j].ratio)));

    if (f->turns && most * pitch < slide && pitch > 0) most = slide / pitch;
    return most < RBDI_IK_MOST * least ? most / least : rbdi_set(RBDI_IK_MOST);
}

/* A share of what a start may take of the limits of dof f, from ik->q: see [method]. */
RBDI_LOCAL rbd_real rbdi_ik_draw(const rbdi_ik *ik, const rbdi_ik_dof *f, rbd_real share) {
    const rbd_real q = ik->q[f->at];
    const rbd_real most = rbdi_ik_wide(ik, f);
    rbd_real lower = f->lower, upper = f->upper;

    if (upper - lower > most + most) {
        lower = rbdi_larger(lower, q - most);
        upper = rbdi_smaller(upper, q + most);
    }

    return lower + share * (upper - lower) - q;
}

/* q of a start: the caller's; then share frac(1/2 + start golden^-(i + 1)) of the range of the ith dof. Any
   number of first starts is spread evenly (Roberts 2018). */
RBDI_LOCAL void rbdi_ik_start(rbdi_ik *ik, int start) {
    const rbd_real pi = rbdi_set(RBDI_PI(rbd_const));
    rbd_real golden, part = rbdi_set((rbd_const)start);

    rbdi_ik_copy(ik->from, ik->m->nq, ik->q);
    if (start == 0 || ik->dofs == 0) return;

    golden = rbdi_ik_golden(ik->dofs);
    for (int i = 0; i < ik->dofs; ++i) {
        rbdi_ik_dof *f = &ik->dof[i];
        rbd_real share;

        part = part / golden;
        share = part + RBD_C(0.5);
        share = share - (rbd_const)(int)share;

        f->hold = RBDI_IK_FREE;
        ik->d[i] = f->turns ? (share + share - RBD_C(1)) * pi : rbdi_zero();
        if (f->at >= 0) ik->d[i] = rbdi_ik_draw(ik, f, share);
    }
    rbdi_ik_move(ik, rbdi_set(RBD_C(1)), ik->q);
}

/* A start of the search. Returns whether it reaches the targets. */
RBDI_LOCAL int rbdi_ik_search(rbdi_ik *ik) {
    const rbd_real distant = RBDI_IK_FAR * ik->options.length * ik->options.length;
    rbd_real mark = rbdi_set(RBDI_IK_OVERFLOW);
    int stalled = 0;

    for (int step = 0; step < RBDI_IK_STEPS && rbdi_ik_may_go_on(ik); ++step) {
        rbd_real damping, least;

        rbdi_ik_errors(ik, ik->q);
        rbdi_ik_keep(ik, ik->q);
        if (rbdi_ik_is_reached(ik)) return 1;

        /* a start that gains too little is given up */
        if (ik->cost < RBD_C(0.25) * mark) {
            mark = ik->cost;
            stalled = 0;
        } else if (++stalled >= RBDI_IK_STALL) {
            return 0;
        }

        rbdi_ik_jacobian(ik);
        least = RBDI_IK_FLOOR * rbdi_ik_normal(ik) + RBDI_TINY;
        damping = RBDI_IK_DAMPING * (ik->cost < distant ? ik->cost : distant);
        rbdi_ik_step(ik, damping, least);
        rbdi_ik_move(ik, rbdi_ik_share(ik), ik->q);
    }

    return 0;
}

/* g, and H with the curvature, at the place of the last evaluation. Returns the share of H that is
   rounding. */
RBDI_LOCAL rbd_real rbdi_ik_quadratic(rbdi_ik *ik) {
    rbd_real least;

    rbdi_ik_jacobian(ik);
    least = RBDI_IK_FLOOR * rbdi_ik_normal(ik) + RBDI_TINY;
    rbdi_ik_curve(ik);
    return least;
}

/* How much the step should bring |e|^2 down by the quadratic model with H of [curvature]: 2 g'd - d'H d. */
RBDI_LOCAL rbd_real rbdi_ik_expected(const rbdi_ik *ik) {
    rbd_real sum = rbdi_zero();
    const rbd_real *H = ik->H;

    for (int i = 0; i < ik->dofs; ++i) {
        rbd_real Hd = RBD_C(0.5) * *H++ * ik->d[i];
        for (int j = i + 1; j < ik->dofs; ++j) Hd = Hd + *H++ * ik->d[j];
        sum = sum + ik->d[i] * (ik->g[i] - Hd);
    }

    return sum + sum;
}

/* By how much the damping changes after a step that has brought |e|^2 down by this share of what was expected
   (Nielsen 1999): 1 at a half. */
RBDI_LOCAL rbd_real rbdi_ik_relax(rbd_real share) {
    const rbd_real x = share + share - RBD_C(1);
    const rbd_real factor = rbdi_larger(rbdi_set(RBD_C(1) / 3), RBD_C(1) - x * x * x);
    return factor < 2 ? factor : rbdi_set(RBD_C(2));
}

/* Goes down from q by at most so many steps, with the damping of Levenberg and Marquardt, until one brings
   |e|^2 down by less than a share `end`. Returns whether it reaches the targets. */
RBDI_LOCAL int rbdi_ik_descend(rbdi_ik *ik, int steps, rbd_const end) {
    const rbd_real square = ik->options.length * ik->options.length;
    const rbd_real most = RBDI_IK_STIFF * square;
    rbd_real damping = RBDI_IK_DAMPING * square;
    rbd_real factor = rbdi_set(RBD_C(2));
    rbd_real least = rbdi_zero();
    rbd_real cost;
    int fresh = 1;
    if (!rbdi_ik_may_go_on(ik)) return 0;

    rbdi_ik_errors(ik, ik->q);
    cost = ik->cost;
    rbdi_ik_keep(ik, ik->q);
    if (rbdi_ik_is_reached(ik)) return 1;

    for (int step = 0; step < steps && rbdi_ik_may_go_on(ik) && damping < most; ++step) {
        rbd_real drop = rbdi_zero();
        if (fresh) least = rbdi_ik_quadratic(ik);

        if (rbdi_ik_step(ik, damping, least)) {
            rbdi_ik_move(ik, rbdi_set(RBD_C(1)), ik->trial);
            rbdi_ik_errors(ik, ik->trial);
            drop = cost - ik->cost;
        }

        /* the next damping; a step that brings nothing is not taken */
        fresh = drop > 0;
        damping = damping * (fresh ? rbdi_ik_relax(drop / rbdi_ik_expected(ik)) : factor);
        factor = fresh ? rbdi_set(RBD_C(2)) : factor + factor;
        if (!fresh) continue;

        rbdi_ik_keep(ik, ik->trial);
        rbdi_ik_copy(ik->trial, ik->m->nq, ik->q);
        if (rbdi_ik_is_reached(ik)) return 1;
        if (drop < end * cost) break;
        cost = ik->cost;
    }

    return 0;
}

/* Where g is 0 and H has a negative direction, as of a stretched arm that could fold, q is no nearest place:
   a small motion of all dofs leaves it. Returns whether the best place is such a one, q then being beside
   it. */
RBDI_LOCAL int rbdi_ik_leave_saddle(rbdi_ik *ik) {
    if (!rbdi_ik_may_go_on(ik)) return 0;

    rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
    rbdi_ik_errors(ik, ik->q);
    if (rbdi_ik_step(ik, rbdi_zero(), rbdi_ik_quadratic(ik))) return 0;

    for (int i = 0; i < ik->dofs; ++i) {
        const rbd_real aside =
            ik->dof[i].turns ? rbdi_set(RBDI_IK_ASIDE) : RBDI_IK_ASIDE * ik->options.length;
        ik->d[i] = i % 2 ? rbdi_zero() - aside : aside;
        ik->dof[i].hold = RBDI_IK_FREE;
    }

    rbdi_ik_move(ik, rbdi_set(RBD_C(1)), ik->q);
    return 1;
}

/* Descents from the best place and from the first starts, then a long one from the best of all, and another
   if that ends on a saddle. Returns whether one reaches the targets. */
RBDI_LOCAL int rbdi_ik_find_nearest(rbdi_ik *ik) {
    const int descents = ik->options.starts < RBDI_IK_DESCENTS ? ik->options.starts : RBDI_IK_DESCENTS;

    for (int i = 0; i < descents; ++i) {
        if (i > 0) {
            rbdi_ik_start(ik, i);
        } else {
            rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
        }

        if (rbdi_ik_descend(ik, RBDI_IK_STEPS, RBDI_IK_COARSE)) return 1;
    }

    rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
    if (rbdi_ik_descend(ik, RBDI_IK_LAST * RBDI_IK_STEPS, RBDI_IK_FINE)) return 1;
    return rbdi_ik_leave_saddle(ik) && rbdi_ik_descend(ik, RBDI_IK_LAST * RBDI_IK_STEPS, RBDI_IK_FINE);
}

/* Says why the targets are not reached at q: by g = J'e, as a share of |e| and the longest column of J. */
RBDI_LOCAL rbd_ik_status rbdi_ik_judge(rbdi_ik *ik) {
    rbd_real longest = rbdi_zero();
    rbd_real most = rbdi_zero();
    rbd_real left = rbdi_zero();
    rbd_real size;

    rbdi_ik_errors(ik, ik->q);
    rbdi_ik_jacobian(ik);
    rbdi_ik_normal(ik);
    for (int i = 0; i < ik->dofs; ++i) longest = rbdi_larger(longest, ik->H[rbdi_ik_row(ik->dofs, i)]);
    size = rbdi_sqrt(longest * ik->cost);

    for (int i = 0; i < ik->dofs; ++i) {
        const rbd_real slope = rbdi_abs(ik->g[i]);
        if (!rbdi_ik_pressed(ik, i)) {
            left = rbdi_larger(left, slope);
        } else if (slope > RBDI_IK_PRESSED * size) {
            ++ik->result->limits;
            if (slope > most) ik->result->limit = ik->dof[i].dof;
            most = rbdi_larger(most, slope);
        }
    }

    if (left > RBDI_IK_SETTLED * size) return RBD_IK_EVALUATIONS;
    return ik->result->limits > 0 ? RBD_IK_AT_LIMIT : RBD_IK_NEAREST;
}

#endif
