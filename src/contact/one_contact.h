#ifndef RBDI_CONTACT_ONE_CONTACT_H
#define RBDI_CONTACT_ONE_CONTACT_H
#include "base/scalar.h"
#include "contact/layout.h"
#include "contact/tolerances.h"

/* ---- one contact [one contact] ----
   Solves the laws of one contact exactly, with all other impulses held. w = u - D p is its velocity without
   its own impulse, D = [A c; c' d].

     w_n >= 0             p = 0: it opens
     slip                 u_n = 0 and u_t = -alpha p_t: with p0 = -w_n/d > 0, S = A - c c'/d, s = w_t + c p0

       (S + alpha) p_t = -s,   p_n = p0 - (c/d)'p_t,   |p_t(alpha)| = mu p_n(alpha),   alpha > 0         (1)

     stick                the same with alpha = 0, where p is within the cone

   Along the eigenvectors of S, p_t takes two divisions. g(alpha) = |p_t| - mu p_n is above 0 at alpha = 0,
   because stick was refused, and not above 0 at |s| (1 + mu (|k_1| + |k_2|)) / (mu p0), k = c/d along the
   eigenvectors: a root is between. Newton's method finds it as a root of 1/|p_t| - 1/(mu p_n). This is linear
   in alpha if S has equal eigenvalues and c = 0. A step out of the bracket becomes a halving. With strong
   coupling there may be more roots (Painleve); each obeys the laws, and the bracket decides. */

/* Eigenvalues l and eigenvectors of S = A - c c'/d, and k. With S = [xx xy; xy yy] and

       mean = (xx + yy)/2,   half = (xx - yy)/2,   radius = sqrt(half^2 + xy^2)

   l = mean +- radius. The first eigenvector is (half + radius, xy) or (xy, radius - half), the longer one. */
RBDI_PART void rbdi_contact_axes(rbdi_contact_law *law) {
    const rbd_real x = law->c[0] / law->d, y = law->c[1] / law->d, least = law->trace * RBDI_UNMOVED;
    const rbd_real xx = law->A[0] - x * law->c[0], xy = law->A[1] - x * law->c[1],
                   yy = law->A[2] - y * law->c[1];
    const rbd_real mean = (xx + yy) / 2, half = (xx - yy) / 2, radius = rbdi_sqrt(half * half + xy * xy);

    law->axis[0] = rbdi_set(RBD_C(1));
    law->axis[1] = rbdi_zero();
    if (radius > 4 * RBDI_EPS * mean) {
        const rbd_real ax = half >= 0 ? half + radius : xy, ay = half >= 0 ? xy : radius - half;
        const rbd_real length = rbdi_sqrt(ax * ax + ay * ay);
        law->axis[0] = ax / length;
        law->axis[1] = ay / length;
    }

    law->l[0] = mean + radius > least ? mean + radius : least;
    law->l[1] = mean - radius > least ? mean - radius : least;
    law->k[0] = law->axis[0] * x + law->axis[1] * y;
    law->k[1] = law->axis[0] * y - law->axis[1] * x;
}

/* Prepares a contact whose block of Delta begins at D, with rows that are `stride` apart. */
RBDI_PART void rbdi_contact_prepare(rbdi_contact_law *law, const rbd_real *D, int stride, rbd_real friction) {
    const rbd_real *y = D + stride, *n = y + stride, trace = D[0] + y[1] + n[2];
    law->trace = trace;
    law->friction = friction;

    /* D = [A c; c' d] */
    law->A[0] = D[0] + trace * RBDI_UNMOVED;
    law->A[1] = D[1];
    law->A[2] = y[1] + trace * RBDI_UNMOVED;
    law->c[0] = n[0];
    law->c[1] = n[1];
    law->d = law->rigid = n[2];

    law->alpha = law->e[0] = law->e[1] = rbdi_zero();
    law->state = law->d > trace * (RBDI_UNMOVED * RBDI_UNMOVED) ? RBD_OPENS : RBD_APART;
    if (law->state != RBD_APART) rbdi_contact_axes(law);
}

/* D p */
RBDI_INLINE void rbdi_own_velocity(const rbdi_contact_law *law, const rbd_real p[3], rbd_real u[3]) {
    u[0] = law->A[0] * p[0] + law->A[1] * p[1] + law->c[0] * p[2];
    u[1] = law->A[1] * p[0] + law->A[2] * p[1] + law->c[1] * p[2];
    u[2] = law->c[0] * p[0] + law->c[1] * p[1] + law->d * p[2];
}

/* The impulse (1) at some alpha: tangents along the eigenvectors of S. */
typedef struct rbdi_contact_trial {
    rbd_real t[2], normal, size; /* size: |p_t| */
} rbdi_contact_trial;

RBDI_INLINE rbdi_contact_trial rbdi_contact_try(const rbdi_contact_law *law, const rbd_real s[2], rbd_real p0,
                                                rbd_real alpha) {
    rbdi_contact_trial trial;
    trial.t[0] = -s[0] / (law->l[0] + alpha);
    trial.t[1] = -s[1] / (law->l[1] + alpha);
    trial.normal = p0 - law->k[0] * trial.t[0] - law->k[1] * trial.t[1];
    trial.size = rbdi_sqrt(trial.t[0] * trial.t[0] + trial.t[1] * trial.t[1]);
    return trial;
}

/* Newton increment of alpha for 1/|p_t| - 1/(mu p_n) = 0. Rates are derivatives by alpha, r = -p_t':

       r_i = t_i / (l_i + alpha),   |p_t|' = -t'r / |p_t|,   (mu p_n)' = mu k'r */
RBDI_INLINE rbd_real rbdi_slip_newton(const rbdi_contact_law *law, const rbdi_contact_trial *trial,
                                      rbd_real alpha) {
    const rbd_real size = trial->size, bound = law->friction * trial->normal;
    const rbd_real r0 = trial->t[0] / (law->l[0] + alpha), r1 = trial->t[1] / (law->l[1] + alpha);
    const rbd_real size_rate = -(trial->t[0] * r0 + trial->t[1] * r1) / size;
    const rbd_real bound_rate = law->friction * (law->k[0] * r0 + law->k[1] * r1);

    return (1 / size - 1 / bound) / (size_rate / (size * size) - bound_rate / (bound * bound));
}

/* Finds the root of (1). law->alpha is the first guess, and becomes the root. Neither s nor mu is 0. */
RBDI_PART rbdi_contact_trial rbdi_slip_root(rbdi_contact_law *law, const rbd_real s[2], rbd_real p0) {
    const rbd_real mu = law->friction, size = rbdi_sqrt(s[0] * s[0] + s[1] * s[1]);
    rbd_real low = rbdi_zero(), alpha = law->alpha,
             high = size * (1 + mu * (rbdi_abs(law->k[0]) + rbdi_abs(law->k[1]))) / (mu * p0);
    rbdi_contact_trial trial;

    /* the first guess; else the root without coupling */
    if (!(alpha > 0 && alpha < high)) alpha = size / (mu * p0) - law->l[0];
    if (!(alpha > 0 && alpha < high)) alpha = rbdi_zero();
    trial = rbdi_contact_try(law, s, p0, alpha);
    for (int i = 0; i < RBDI_ROOT_STEPS; ++i) {
        const rbd_real excess = trial.size - mu * trial.normal;
        rbd_real next = alpha;

        /* the bracket */
        low = excess > 0 ? alpha : low;
        high = excess > 0 ? high : alpha;
        if (rbdi_abs(excess) <= 8 * RBDI_EPS * trial.size || high - low <= 2 * RBDI_EPS * high) break;

        /* Newton's step; out of the bracket, its middle */
        if (trial.normal > 0) next = alpha + rbdi_slip_newton(law, &trial, alpha);
        if (!(next > low && next < high))
            next = low > 0 && high > 16 * low ? rbdi_sqrt(low) * rbdi_sqrt(high) : (low + high) / 2;

        alpha = next;
        trial = rbdi_contact_try(law, s, p0, alpha);
    }

    law->alpha = alpha;
    return trial;
}

/* The impulse of a contact from w, and its state. */
RBDI_PART void rbdi_contact_impulse(rbdi_contact_law *law, const rbd_real w[3], rbd_real p[3]) {
    const rbd_real mu = law->friction, p0 = -w[2] / law->d;

    /* s = w_t + c p0, along the eigenvectors */
    const rbd_real x = w[0] + law->c[0] * p0, y = w[1] + law->c[1] * p0;
    const rbd_real s[2] = {law->axis[0] * x + law->axis[1] * y, law->axis[0] * y - law->axis[1] * x};
    rbdi_contact_trial best;

    p[0] = p[1] = p[2] = rbdi_zero();
    law->state = RBD_OPENS;
    if (!(w[2] < 0)) return;

    best = rbdi_contact_try(law, s, p0, rbdi_zero());
    law->state = best.normal > 0 && best.size <= mu * best.normal ? RBD_STICKS : RBD_SLIPS;
    if (law->state == RBD_SLIPS) {
        rbd_real share;

        p[2] = p0;
        if (!(mu > 0)) return;

        best = rbdi_slip_root(law, s, p0);
        if (!(best.normal > 0)) best.normal = rbdi_zero();

        share = best.size > 0 ? mu * best.normal / best.size : rbdi_zero(); /* onto the cone exactly */
        best.t[0] = best.t[0] * share;
        best.t[1] = best.t[1] * share;
    }

    p[0] = law->axis[0] * best.t[0] - law->axis[1] * best.t[1];
    p[1] = law->axis[1] * best.t[0] + law->axis[0] * best.t[1];
    p[2] = best.normal;
}

#endif
