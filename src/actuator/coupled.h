#ifndef RBDI_ACTUATOR_COUPLED_H
#define RBDI_ACTUATOR_COUPLED_H
#include "actuator/transmission.h"
#include "actuator/search.h"

/* ---- coupled shafts [coupled shafts] ----
   If there are transmissions, the motion of the joints is learnt for all n shafts of the robot together. At
   the speeds x of the shafts the joints ask of them the torques

       T = seen_T + M / dt (x - seen_x)

   with speeds and torques (seen_x, seen_T) of a step that was made, and a mass M, n x n, symmetric and
   positive definite. */

/* Speed of joint j of a group where its shafts have those of their points. */
RBDI_INLINE rbd_real rbdi_act_joint_speed(const rbdi_act_group *g, int j, const rbdi_act_shaft *s) {
    rbd_real v = rbdi_zero();
    for (int i = 0; i < g->n; ++i) v = v + g->inverse[g->n * j + i] * s[i].point;
    return v;
}

/* Tells the joints of a group torques and dampings with which they have the torques G'T at the speeds x of
   the shafts' points. The dampings are a diagonal D that is at least A = G' diag(smooth) G:

       D_jj = sum |A_jk|,   start = G'T + D G^-1 x */
RBDI_LOCAL void rbdi_act_tell_group(const rbd_actuators *a, rbdi_act_group *g) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    const int n = g->n;
    for (int j = 0; j < n; ++j) {
        rbd_real torque = rbdi_zero(), bound = rbdi_zero();
        for (int i = 0; i < n; ++i) torque = torque + g->G[n * i + j] * s[i].base;
        for (int k = 0; k < n; ++k) {
            rbd_real A = rbdi_zero();
            for (int i = 0; i < n; ++i) A = A + g->G[n * i + j] * s[i].smooth * g->G[n * i + k];
            bound = bound + rbdi_abs(A);
        }
        g->start[j] = torque + bound * rbdi_act_joint_speed(g, j, s);
        g->damping[j] = bound;
    }
}

/* Notes speeds and torques of a group's shafts at joint speeds v, and how large the terms of both are. */
RBDI_LOCAL void rbdi_act_note_group(const rbd_actuators *a, const rbdi_act_group *g, const rbd_real *v) {
    rbdi_act_shaft *s = &a->shaft[g->first];
    for (int i = 0; i < g->n; ++i) {
        s[i].next = rbdi_act_shaft_speed(g, i, v);
        s[i].force = s[i].scale = s[i].size = rbdi_zero();
        for (int j = 0; j < g->n; ++j) {
            const rbd_real share = g->inverse[g->n * j + i];
            s[i].force = s[i].force + share * (g->start[j] - g->damping[j] * v[g->dof[j]]);
            s[i].size = s[i].size + rbdi_abs(share * g->start[j]);
            s[i].scale = s[i].scale + rbdi_abs(g->G[g->n * i + j] * v[g->dof[j]]);
        }
    }
}

/* Notes the rounding of the set: of speeds and, after those, of torques, which all round each other by the
   joints. The size of a coupled shaft's torque is that of its law, of what its joints were told, and of their
   momentum. */
RBDI_LOCAL void rbdi_act_note_rounding(rbd_actuators *a) {
    a->speed_rounding = a->torque_rounding = rbdi_zero();
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        if (s->dof >= 0) {
            s->scale = rbdi_abs(s->next);
            s->size = rbdi_zero();
        }
        a->speed_rounding = a->speed_rounding + RBDI_ACTUATOR_ROUNDING * s->scale;
    }
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->size = s->size + rbdi_act_size(&a->motor[i], s, a);
        a->torque_rounding = a->torque_rounding + RBDI_ACTUATOR_ROUNDING * s->size;
        if (s->dof >= 0) continue;
        s->size = s->size + s->smooth * s->scale;
        for (int k = 0; k < a->n && a->known; ++k)
            s->size = s->size + rbdi_abs(a->mass[a->n * i + k]) / a->dt * a->shaft[k].scale;
    }
}

/* ---- foretelling [foretelling] ----
   The speeds at which the joints, by what was learnt of them, ask for the torques of all laws: the method of
   the repeats, with this motion in place of a step. */

/* Solves A x = b by L D L', A = a->system symmetric and positive definite; b becomes x. Returns 0 if A is not
   positive definite. */
RBDI_LOCAL int rbdi_act_solve_system(const rbd_actuators *a, rbd_real *b) {
    const int n = a->n;
    rbd_real *A = a->system;
    for (int k = 0; k < n; ++k) {
        if (!(A[n * k + k] > 0)) return 0;
        for (int i = k + 1; i < n; ++i) {
            const rbd_real factor = A[n * i + k] / A[n * k + k];
            for (int j = k + 1; j <= i; ++j) A[n * i + j] = A[n * i + j] - factor * A[n * j + k];
            b[i] = b[i] - factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j) b[k] = b[k] - A[n * j + k] * b[j];
        b[k] = b[k] / A[n * k + k];
    }
    return 1;
}

/* The pieces of all shafts at their points. */
RBDI_LOCAL void rbdi_act_take_pieces(rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        const rbdi_act_piece piece = rbdi_act_law(&a->motor[i], s, s->point, a);
        s->start = piece.start;
        s->slope = piece.slope;
    }
}

/* Finds the speeds, `next`, at which the joints ask for the torques of the pieces, `force`. Returns 0 if
   there are none within bounds.

       (M / dt + slope) x = start - seen_T + M / dt seen_x */
RBDI_LOCAL int rbdi_act_solve_pieces(rbd_actuators *a) {
    const int n = a->n;
    rbd_real *x = a->solution;
    for (int i = 0; i < n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        x[i] = s->start - s->seen_T;
        for (int k = 0; k < n; ++k) {
            a->system[n * i + k] = a->mass[n * i + k] / a->dt;
            x[i] = x[i] + a->system[n * i + k] * a->shaft[k].seen_x;
        }
        a->system[(n + 1) * i] = a->system[(n + 1) * i] + s->slope;
    }
    if (!rbdi_act_solve_system(a, x)) return 0;

    for (int i = 0; i < n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->next = x[i];
        s->force = s->seen_T;
        for (int k = 0; k < n; ++k)
            s->force = s->force + a->mass[n * i + k] / a->dt * (x[k] - a->shaft[k].seen_x);
        if (!(rbdi_abs(s->force) <= RBDI_ACTUATOR_LARGEST && rbdi_abs(s->next) <= RBDI_ACTUATOR_MOST))
            return 0;
    }
    return 1;
}

/* Whether the laws have at `next` the torques of the pieces. */
RBDI_LOCAL int rbdi_act_pieces_hold(const rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        const rbd_motor *m = &a->motor[i];
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real law = rbdi_act_law_at(m, s, s->next, a);
        const rbd_real off = rbdi_abs(s->start - s->slope * s->next - law);
        if (off > RBDI_ACTUATOR_SETTLED * rbdi_act_size(m, s, a)) return 0;
    }
    return 1;
}

/* Moves the points to where, by what was learnt, the step ends: there the joints ask for `base`. A search
   stops at the bend of one law at least, and most laws have one that matters. Returns 0 without a solution
   within bounds. */
RBDI_LOCAL int rbdi_act_foretell(rbd_actuators *a) {
    for (int k = 0; k < a->n + RBDI_ACTUATOR_SEARCHES; ++k) {
        int held;
        rbdi_act_take_pieces(a);
        if (!rbdi_act_solve_pieces(a)) return 0;
        held = rbdi_act_pieces_hold(a);
        rbdi_act_move_points(a, !held);
        if (held) break;
    }
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->base = s->base - rbdi_act_off(&a->motor[i], s, s->base, s->point, a);
    }
    return 1;
}

#endif
