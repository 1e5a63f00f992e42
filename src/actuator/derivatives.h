#ifndef RBDI_ACTUATOR_DERIVATIVES_H
#define RBDI_ACTUATOR_DERIVATIVES_H
#include "base/memory.h"
#include "actuator/layout.h"

/* ---- derivatives [derivatives code] ---- */

/* The torque on the joint's side of a shaft, and how it falls with its angle and speed there. */
typedef struct rbdi_act_slopes {
    rbd_real torque, by_angle, by_speed;
} rbdi_act_slopes;

RBDI_LOCAL rbdi_act_slopes rbdi_act_slopes_of(const rbd_motor *m, const rbdi_act_shaft *s) {
    rbdi_act_slopes out;
    if (m->stiffness > 0) {
        const rbd_real k = m->stiffness, d = m->damping, half = m->backlash / 2;
        const rbd_real free = k * (s->angle - s->phi) + d * (s->speed - s->x);
        const int side = free > k * half ? 1 : free < -k * half ? -1 : 0;
        out.torque = side ? free - (rbd_real)side * k * half : rbdi_zero();
        out.by_angle = side ? k : rbdi_zero();
        out.by_speed = side ? d : rbdi_zero();
        return out;
    }
    out.by_angle = s->gain;
    out.by_speed = s->rate + m->friction.viscous;
    out.torque = s->now - m->friction.viscous * s->x;
    if (s->branch) out.torque = out.torque - (rbd_real)s->branch * s->level;
    return out;
}

/* Of a transmission: with slopes K by angle, D by speed and torques t of its shafts

       dtau/dq = sum t_i H_i - G' (K G + D H v),   dtau/dv = -G' D G,   dtau/dcommand = G' */
RBDI_LOCAL void rbdi_act_group_derivatives(const rbd_actuators *a, const rbdi_act_group *g, int j, int k,
                                           rbd_real *dq, rbd_real *dv) {
    const int n = g->n;
    *dq = *dv = rbdi_zero();
    for (int i = 0; i < n; ++i) {
        const int at = g->first + i;
        const rbdi_act_slopes s = rbdi_act_slopes_of(&a->motor[at], &a->shaft[at]);
        const rbd_real G_ij = g->G[n * i + j], G_ik = g->G[n * i + k];
        rbd_real H_v = rbdi_zero();
        if (g->by->kind == RBD_BY_RODS) {
            for (int l = 0; l < n; ++l) H_v = H_v + g->H[(n * i + l) * n + k] * g->v[l];
            *dq = *dq + s.torque * g->H[(n * i + j) * n + k];
        }
        *dq = *dq - G_ij * (s.by_angle * G_ik + s.by_speed * H_v);
        *dv = *dv - G_ij * s.by_speed * G_ik;
    }
}

/* How the joint's torque changes with the torque or voltage of a command, in the same step: 0 if a spring
   lies between, a limit cuts the command, or it arrives later. */
RBDI_LOCAL rbd_real rbdi_act_passes(const rbd_actuators *a, int i) {
    const rbd_motor *m = &a->motor[i];
    return m->stiffness > 0 || m->delay > 0 ? rbdi_zero() : a->shaft[i].pass;
}

RBDI_API rbd_status rbd_actuators_derivatives(const rbd_actuators *a, rbd_real *dq, rbd_real *dv,
                                              rbd_real *dcommand) {
    if (!a) return RBD_ERR_NULL;
    if (!a->begun || a->repeats) return RBD_ERR_ORDER;
    if (dq) rbdi_clear(dq, a->nv * a->nv);
    if (dv) rbdi_clear(dv, a->nv * a->nv);
    if (dcommand) rbdi_clear(dcommand, a->nv * a->n);

    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbdi_act_slopes slopes = rbdi_act_slopes_of(&a->motor[i], s);
        if (s->dof < 0) continue;
        if (dq) dq[(a->nv + 1) * s->dof] = -slopes.by_angle;
        if (dv) dv[(a->nv + 1) * s->dof] = -slopes.by_speed;
        if (dcommand) dcommand[a->n * s->dof + i] = rbdi_act_passes(a, i);
    }
    for (const rbdi_act_group *g = a->group; g < a->group + a->groups; ++g)
        for (int j = 0; j < g->n; ++j)
            for (int k = 0; k < g->n; ++k) {
                rbd_real by_q, by_v;
                rbdi_act_group_derivatives(a, g, j, k, &by_q, &by_v);
                if (dq) dq[a->nv * g->dof[j] + g->dof[k]] = by_q;
                if (dv) dv[a->nv * g->dof[j] + g->dof[k]] = by_v;
                if (dcommand)
                    dcommand[a->n * g->dof[j] + g->first + k] =
                        rbdi_act_passes(a, g->first + k) * g->G[g->n * k + j];
            }
    return RBD_OK;
}

#endif
