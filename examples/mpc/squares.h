/* squares.h - costs for ilqr.h that are sums of weighted squares, weight r^2 / 2, with their gradient
   and Gauss-Newton Hessian. SPDX-License-Identifier: MIT */
#ifndef ILQR_SQUARES_H
#define ILQR_SQUARES_H

#include "ilqr.h"

typedef struct squares { /* the outputs of a cost: l_z and l_zz may be NULL */
    double *l, *l_z, *l_zz;
    int nz;
} squares;

/* Adds that of r, whose derivative by z is row, count entries from the first-th on, and 0 elsewhere. */
static inline void squares_add(const squares *s, double weight, double r, const double *row, int first,
                               int count) {
    *s->l += weight * r * r / 2;
    if (!s->l_z) return;
    for (int i = 0; i < count; i++) {
        double *to = s->l_zz + (first + i) * s->nz + first;
        s->l_z[first + i] += weight * r * row[i];
        for (int j = i; j < count; j++) to[j] += weight * row[i] * row[j];
    }
}

/* Of r = z_j but for a constant. */
static inline void squares_entry(const squares *s, double weight, double r, int j) {
    const double one = 1;
    squares_add(s, weight, r, &one, j, 1);
}

/* Of what z_j exceeds its limits by. */
static inline void squares_beyond(const squares *s, double weight, double z_j, double lower, double upper,
                                  int j) {
    if (z_j < lower) squares_entry(s, weight, z_j - lower, j);
    if (z_j > upper) squares_entry(s, weight, z_j - upper, j);
}

/* Of the way from goal to q, with a floating base in the first six and one-axis joints behind it; weight,
   difference: nv; D: nv x nv, scratch. */
static inline rbd_status squares_way(const squares *s, const rbd_model *m, const double *weight,
                                     const double *goal, const double *q, double *difference, double *D) {
    const int n = rbd_nv(m);
    rbd_status status = rbd_difference(m, goal, q, difference);
    if (s->l_z && status == RBD_OK) status = rbd_difference_derivatives(m, goal, q, NULL, D);
    for (int i = 0; i < 6; i++) squares_add(s, weight[i], difference[i], D + i * n, 0, 6);
    for (int i = 6; i < n; i++) squares_entry(s, weight[i], difference[i], i);
    return status;
}

#endif
