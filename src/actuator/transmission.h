#ifndef RBDI_ACTUATOR_TRANSMISSION_H
#define RBDI_ACTUATOR_TRANSMISSION_H
#include "actuator/rods.h"

/* ---- transmission [transmission code] ---- */

/* The inverse of G, n x n. Gauss and Jordan's method with row pivots. */
RBDI_LOCAL int rbdi_act_invert_small(const rbd_real *G, int n, rbd_real *inverse) {
    rbd_real a[9], largest = rbdi_zero();
    for (int i = 0; i < n * n; ++i) {
        a[i] = G[i];
        inverse[i] = rbdi_set(i % (n + 1) ? RBD_C(0) : RBD_C(1));
        if (rbdi_abs(a[i]) > largest) largest = rbdi_abs(a[i]);
    }

    for (int k = 0; k < n; ++k) {
        rbd_real pivot;
        int best = k;
        for (int i = k + 1; i < n; ++i)
            if (rbdi_abs(a[n * i + k]) > rbdi_abs(a[n * best + k])) best = i;
        if (!(rbdi_abs(a[n * best + k]) > RBDI_ACTUATOR_DEAD * largest) || largest < RBDI_ACTUATOR_DEAD)
            return 0;

        for (int j = 0; j < n; ++j) {
            const rbd_real x = a[n * k + j], y = inverse[n * k + j];
            a[n * k + j] = a[n * best + j];
            inverse[n * k + j] = inverse[n * best + j];
            a[n * best + j] = x;
            inverse[n * best + j] = y;
        }

        pivot = 1 / a[n * k + k];
        for (int j = 0; j < n; ++j) {
            a[n * k + j] = pivot * a[n * k + j];
            inverse[n * k + j] = pivot * inverse[n * k + j];
        }
        for (int i = 0; i < n; ++i) {
            const rbd_real factor = a[n * i + k];
            for (int j = 0; j < n && i != k; ++j) {
                a[n * i + j] = a[n * i + j] - factor * a[n * k + j];
                inverse[n * i + j] = inverse[n * i + j] - factor * inverse[n * k + j];
            }
        }
    }
    return 1;
}

/* G, its inverse, shaft angles and speeds of a group; bias: dG/dt v. */
RBDI_LOCAL rbd_status rbdi_act_map_group(const rbd_actuators *a, rbdi_act_group *g, const rbd_real *q,
                                         const rbd_real *v) {
    rbdi_act_shaft *s = &a->shaft[g->first];
    rbd_real angle[3] = {0, 0, 0};
    const int n = g->n;
    if (g->by->kind == RBD_BY_RODS) {
        const rbd_status status = rbdi_act_map_rods(g, q, angle);
        if (status) return status;
        if (!rbdi_act_invert_small(g->G, n, g->inverse)) return RBD_ERR_SINGULAR;
    }

    for (int i = 0; i < n; ++i) {
        s[i].phi = angle[i];
        s[i].x = rbdi_zero();
        s[i].bias = rbdi_zero();
        for (int j = 0; j < n; ++j) {
            if (g->by->kind != RBD_BY_RODS) s[i].phi = s[i].phi + g->G[n * i + j] * q[g->at[j]];
            if (v) s[i].x = s[i].x + g->G[n * i + j] * v[g->dof[j]];
            for (int k = 0; k < n && v && g->by->kind == RBD_BY_RODS; ++k)
                s[i].bias = s[i].bias + g->H[(n * i + j) * n + k] * v[g->dof[j]] * v[g->dof[k]];
        }
    }
    return RBD_OK;
}

/* Whether all are finite and can be computed with: their squares' sum is; not of NaN. */
RBDI_PART int rbdi_act_all_moderate(const rbd_real *x, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + x[i] * x[i];
    return sum <= RBDI_ACTUATOR_MOST * RBDI_ACTUATOR_MOST;
}

/* Angles and speeds of all shafts; v may be NULL. */
RBDI_LOCAL rbd_status rbdi_act_map(rbd_actuators *a, const rbd_real *q, const rbd_real *v) {
    a->fault = -1;
    if (!rbdi_act_all_moderate(q, a->nq) || (v && !rbdi_act_all_moderate(v, a->nv))) return RBD_ERR_NAN;

    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        if (s->dof < 0) continue;
        s->phi = q[s->at];
        s->x = v ? v[s->dof] : rbdi_zero();
    }
    for (int i = 0; i < a->groups; ++i) {
        const rbd_status status = rbdi_act_map_group(a, &a->group[i], q, v);
        if (status) a->fault = i;
        if (status) return status;
    }
    return RBD_OK;
}

/* Speed of shaft i of a group at joint speeds v. */
RBDI_INLINE rbd_real rbdi_act_shaft_speed(const rbdi_act_group *g, int i, const rbd_real *v) {
    rbd_real x = rbdi_zero();
    for (int j = 0; j < g->n; ++j) x = x + g->G[g->n * i + j] * v[g->dof[j]];
    return x;
}

RBDI_API rbd_status rbd_actuators_map(rbd_actuators *a, const rbd_real *q, const rbd_real *v, rbd_real *angle,
                                      rbd_real *speed) {
    rbd_status status;
    if (!a || !q) return RBD_ERR_NULL;
    if (a->begun) return RBD_ERR_ORDER;
    status = rbdi_act_map(a, q, v);
    for (int i = 0; i < a->n && !status; ++i) {
        if (angle) angle[i] = a->shaft[i].phi;
        if (speed) speed[i] = a->shaft[i].x;
    }
    return status;
}

RBDI_API int rbd_actuators_fault(const rbd_actuators *a) { return a ? a->fault : -1; }

#endif
