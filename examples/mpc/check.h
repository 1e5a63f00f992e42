/* check.h - are the derivatives of a problem right? By central differences along the manifold, at the
   trajectory of a solver: do this once before you wonder why it does not converge. And do controls at
   their limits reach them? SPDX-License-Identifier: MIT */
#ifndef ILQR_CHECK_H
#define ILQR_CHECK_H

#include <math.h>

#include "ilqr.h"
#include "../larger.h"

/* A knot's state and control moved by t along component j of z = (q, v, u): out is q (nq), v (nv), u (nu). */
static inline void ilqr_moved(const ilqr *s, int k, int j, rbd_real t, rbd_real *out) {
    const int nq = s->nq, n = s->nv;
    memset(s->dx, 0, sizeof t * (size_t)n);
    if (j < n) s->dx[j] = 1;
    rbd_integrate(s->p->m, s->q + k * nq, s->dx, t, out);
    memcpy(out + nq, s->v + k * n, sizeof t * (size_t)n);
    if (k < s->knots) memcpy(out + nq + n, s->u + k * s->nu, sizeof t * (size_t)s->nu);
    if (j >= n) out[nq + j - n] += t;
}

/* Largest error of f_z and of l_z, relative to the largest entry of that knot and kind, 1 at least; or
   that of the calls. memory: 2 (nq + 2 nv + nu) scalars. */
static inline rbd_real ilqr_derivative_error(ilqr *s, rbd_real *memory) {
    const ilqr_problem *p = s->p;
    const int nq = s->nq, n = s->nv, m = s->nu, nz = 2 * n + m, size = nq + 2 * n + m;
    const rbd_real h = sizeof h > 4 ? (rbd_real)1e-5 : (rbd_real)3e-3;
    rbd_real worst = ilqr_linearise(s) == RBD_OK ? 0 : (rbd_real)1e9;
    for (int k = 0; k <= s->knots; k++) {
        const int end = k == s->knots;
        const rbd_real *f_z = s->f_z + k * n * nz;
        rbd_real l[2] = {0}, error = 0, error_l = 0, largest = 1, largest_l = 1;
        memset(s->Q_z, 0, sizeof h * (size_t)nz);
        memset(s->Q_zz, 0, sizeof h * (size_t)(nz * nz));
        p->cost(p->user, k, s->q + k * nq, s->v + k * n, end ? NULL : s->u + k * m, l, s->Q_z, s->Q_zz);
        for (int j = 0; j < (end ? 2 * n : nz); j++) {
            rbd_real *x[2] = {memory, memory + size};
            for (int side = 0; side < 2; side++) {
                rbd_real *q = x[side], *v = q + nq, *u = v + n;
                ilqr_moved(s, k, j, side ? h : -h, q);
                if (!end && p->step(p->user, k, q, v, u, u + m) != RBD_OK) return (rbd_real)1e9;
                p->cost(p->user, k, q, v, end ? NULL : u, &l[side], NULL, NULL);
            }
            for (int i = 0; i < n && !end; i++) {
                const rbd_real difference = (x[1][size - n + i] - x[0][size - n + i]) / (2 * h);
                largest = (rbd_real)larger((double)largest, fabs((double)difference));
                error += (rbd_real)fabs((double)(difference - f_z[i * nz + j]));
            }
            const rbd_real difference = (l[1] - l[0]) / (2 * h);
            largest_l = (rbd_real)larger((double)largest_l, fabs((double)difference));
            error_l += (rbd_real)fabs((double)(difference - s->Q_z[j]));
        }
        error = error / largest + error_l / largest_l;
        worst = (rbd_real)larger((double)worst, (double)error);
    }
    return worst;
}

/* Of -1 to 1. */
static inline rbd_real ilqr_random(unsigned long *seed) {
    *seed = (*seed * 1103515245ul + 12345ul) & 0x7ffffffful;
    return (rbd_real)*seed / (rbd_real)0x40000000ul - 1;
}

/* A knot's quadratic cost of the controls, and controls u within their limits. */
static inline void ilqr_draw_box(ilqr *s, unsigned long *seed, rbd_real *u) {
    const int m = s->nu, nx = 2 * s->nv, nz = nx + m;
    rbd_real *Q_uu = s->Q_zz + nx * nz + nx;
    memset(s->Q_zz, 0, sizeof *u * (size_t)(nz * nz));
    for (int r = 0; r < m; r++) {
        for (int i = 0; i < m; i++) s->trial[i] = ilqr_random(seed);
        for (int i = 0; i < m; i++)
            for (int j = 0; j < m; j++) Q_uu[i * nz + j] += s->trial[i] * s->trial[j];
    }
    for (int i = 0; i < m; i++) {
        const rbd_real lower = s->p->lower[i], upper = s->p->upper[i];
        Q_uu[i * nz + i] += (rbd_real)1e-4;
        s->Q_z[nx + i] = (upper - lower) * ilqr_random(seed);
        u[i] = ilqr_clamp((upper + lower) / 2 + ilqr_random(seed) * (upper - lower), lower, upper);
    }
}

/* Whether in so many random boxes no control comes to stand beside its limit, as near as a rounding: it would
   count as free, and what is found would be another thing. u, k: nu scalars each. */
static inline int ilqr_meets_limits(ilqr *s, int boxes, rbd_real *u, rbd_real *k) {
    unsigned long seed = 1;
    int meets = 1;
    for (int box = 0; box < boxes; box++) {
        ilqr_draw_box(s, &seed, u);
        meets = meets && ilqr_box(s, u, k);
        for (int i = 0; i < s->nu; i++) {
            const rbd_real lower = s->p->lower[i] - u[i], upper = s->p->upper[i] - u[i],
                           near = (upper - lower) * (sizeof near > 4 ? (rbd_real)1e-13 : (rbd_real)1e-5);
            const int at_lower = k[i] <= lower + near, at_upper = k[i] >= upper - near;
            meets = meets && k[i] >= lower && k[i] <= upper;
            meets = meets && !(at_lower && k[i] > lower) && !(at_upper && k[i] < upper);
        }
    }
    return meets;
}

#endif
