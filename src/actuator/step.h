#ifndef RBDI_ACTUATOR_STEP_H
#define RBDI_ACTUATOR_STEP_H
#include "base/memory.h"
#include "actuator/transmission.h"
#include "actuator/laws.h"

/* ---- forward [forward code] ---- */

/* All shafts at rest at their angles g, as warm as the air. */
RBDI_LOCAL void rbdi_act_rest(rbd_actuators *a, rbd_real air) {
    a->air = air;
    a->begun = 0;
    a->repeats = 0;
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        s->angle = s->g;
        s->speed = s->winding = s->housing = s->bristle = rbdi_zero();
        s->motor = s->joint = s->level = rbdi_zero();
        s->cogging = s->cogging_slope = rbdi_zero();
        s->t = s->now = s->braking = s->gain = s->rate = rbdi_zero();
        s->s = s->slope = s->told = rbdi_zero();
        s->branch = s->saturated = s->oldest = 0;
    }
    for (int i = 0; i < a->n * a->ring; ++i) {
        rbd_command *c = &a->commands[i];
        c->q = c->v = c->kp = c->kd = c->torque = rbdi_zero();
    }
}

RBDI_API rbd_status rbd_actuators_reset(rbd_actuators *a, const rbd_real *q, rbd_real air) {
    rbd_status status;
    if (!a || !q) return RBD_ERR_NULL;
    if (!(air >= -273 && air <= 1000)) return RBD_ERR_RANGE;
    status = rbdi_act_map(a, q, NULL);
    if (!status) rbdi_act_rest(a, air);
    return status;
}

/* Puts a command into the motor's ring, and takes out the one that arrives. */
RBDI_LOCAL rbd_command rbdi_act_delay(rbd_actuators *a, int i, const rbd_command *given) {
    rbdi_act_shaft *s = &a->shaft[i];
    rbd_command *oldest = &a->commands[i * a->ring + s->oldest];
    rbd_command arrives;
    if (a->motor[i].delay < 1) return *given;
    arrives = *oldest;
    *oldest = *given;
    s->oldest = (int16_t)((s->oldest + 1) % a->motor[i].delay);
    return arrives;
}

RBDI_LOCAL int rbdi_act_is_command(const rbd_command *c) {
    const rbd_real x[5] = {c->q, c->v, c->kp, c->kd, c->torque};
    return rbdi_act_all_moderate(x, 5) && c->kp >= 0 && c->kd >= 0;
}

/* What the shafts of a group tell: with A = G' diag(slope) G, L_jj = sum |A_jk| and their last speeds v

       damping = L,   tau = G's + (L - A) v */
RBDI_LOCAL void rbdi_act_tell_group(const rbd_actuators *a, const rbdi_act_group *g, rbd_real *tau,
                                    rbd_real *damping) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    const int n = g->n;
    for (int j = 0; j < n; ++j) {
        rbd_real sum = rbdi_zero(), bound = rbdi_zero();
        for (int i = 0; i < n; ++i) sum = sum + g->G[n * i + j] * s[i].s;
        for (int k = 0; k < n; ++k) {
            rbd_real A = rbdi_zero();
            for (int i = 0; i < n; ++i) A = A + g->G[n * i + j] * s[i].slope * g->G[n * i + k];
            bound = bound + rbdi_abs(A);
            sum = sum - A * g->v[k];
        }
        tau[g->dof[j]] = sum + bound * g->v[j];
        damping[g->dof[j]] = bound;
    }
}

/* What all shafts tell the step. */
RBDI_LOCAL void rbdi_act_tell_all(const rbd_actuators *a, rbd_real *tau, rbd_real *damping) {
    rbdi_clear(tau, a->nv);
    rbdi_clear(damping, a->nv);
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        rbdi_act_tell(&a->motor[i], s, a);
        if (s->dof < 0) continue;
        tau[s->dof] = s->s;
        damping[s->dof] = s->slope;
    }
    for (int i = 0; i < a->groups; ++i) rbdi_act_tell_group(a, &a->group[i], tau, damping);
}

/* Notes the speeds of a group. Whether what it told for its last speeds holds for these. */
RBDI_LOCAL int rbdi_act_group_settles(const rbd_actuators *a, rbdi_act_group *g, const rbd_real *v) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    const int n = g->n;
    rbd_real change[3];
    int settled = 1;
    for (int j = 0; j < n; ++j) {
        change[j] = v[g->dof[j]] - g->v[j];
        g->v[j] = v[g->dof[j]];
    }

    for (int j = 0; j < n; ++j) {
        rbd_real error = rbdi_zero(), size = rbdi_zero();
        for (int k = 0; k < n; ++k) {
            rbd_real A = rbdi_zero();
            for (int i = 0; i < n; ++i) A = A + g->G[n * i + j] * s[i].slope * g->G[n * i + k];
            error = error + rbdi_abs(A) * change[j] - A * change[k];
            size = size + rbdi_abs(A) * (rbdi_abs(g->v[j]) + rbdi_abs(g->v[k]));
        }
        for (int i = 0; i < n; ++i) size = size + rbdi_abs(g->G[n * i + j] * s[i].s);
        settled &= rbdi_abs(error) <= RBDI_ACTUATOR_SETTLED * size;
    }
    return settled;
}

RBDI_API rbd_status rbd_actuators_begin(rbd_actuators *a, const rbd_command *commands, const rbd_real *q,
                                        const rbd_real *v, rbd_real dt, int first_order, rbd_real *tau,
                                        rbd_real *damping) {
    rbd_status status;
    if (!a || !commands || !q || !v || !tau || !damping) return RBD_ERR_NULL;
    a->begun = 0;
    if (!(dt >= RBD_C(1e-9) && dt <= RBD_C(1e3))) return RBD_ERR_RANGE;
    for (int i = 0; i < a->n; ++i)
        if (!rbdi_act_is_command(&commands[i])) return RBD_ERR_RANGE;
    status = rbdi_act_map(a, q, v);
    if (status) return status;

    a->dt = dt;
    a->share = rbdi_set(first_order ? RBD_C(1) : RBD_C(0.5));
    a->begun = 1;
    a->repeats = 0;
    for (int i = 0; i < a->n; ++i) {
        const rbd_motor *m = &a->motor[i];
        rbdi_act_shaft *s = &a->shaft[i];
        const rbd_command c = rbdi_act_delay(a, i, &commands[i]);
        if (!(m->stiffness > 0)) {
            s->angle = s->g;
            s->speed = s->x;
        }
        rbdi_act_drive_motor(m, s, &c, a->air, dt, m->stiffness > 0 ? rbdi_set(RBD_C(1)) : a->share);
        s->level = rbd_friction_level(&m->friction, s->speed, s->motor, -s->joint);
        s->told = s->x;
        if (!(m->stiffness > 0)) s->branch = (int16_t)rbdi_act_rigid_branch(m, s, s->x, a);
    }
    for (int i = 0; i < a->groups; ++i)
        for (int j = 0; j < a->group[i].n; ++j) a->group[i].v[j] = v[a->group[i].dof[j]];
    rbdi_act_tell_all(a, tau, damping);
    return RBD_OK;
}

/* Calls for each shaft with its speed at joint speeds v; whether all settle. */
RBDI_LOCAL int rbdi_act_settles(rbd_actuators *a, const rbd_real *v) {
    int settled = 1;
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        if (s->dof >= 0) settled &= rbdi_act_stays(&a->motor[i], s, v[s->dof], a);
    }
    for (int k = 0; k < a->groups; ++k) {
        rbdi_act_group *g = &a->group[k];
        settled &= rbdi_act_group_settles(a, g, v);
        for (int i = 0; i < g->n; ++i) {
            const int at = g->first + i;
            settled &= rbdi_act_stays(&a->motor[at], &a->shaft[at], rbdi_act_shaft_speed(g, i, v), a);
        }
    }
    return settled;
}

/* Ends the step at joint speeds v. */
RBDI_LOCAL void rbdi_act_end_step(rbd_actuators *a, const rbd_real *v) {
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        if (s->dof >= 0) rbdi_act_end_shaft(&a->motor[i], s, v[s->dof], a);
    }
    for (int k = 0; k < a->groups; ++k) {
        const rbdi_act_group *g = &a->group[k];
        for (int i = 0; i < g->n; ++i) {
            const int at = g->first + i;
            rbdi_act_end_shaft(&a->motor[at], &a->shaft[at], rbdi_act_shaft_speed(g, i, v), a);
        }
    }
}

RBDI_API int rbd_actuators_again(rbd_actuators *a, const rbd_real *v_next, rbd_real *tau, rbd_real *damping) {
    int finite;
    if (!a || !v_next || !tau || !damping || !a->begun) return 0;
    finite = rbdi_act_all_moderate(v_next, a->nv);
    if (finite && !rbdi_act_settles(a, v_next) && a->repeats < RBDI_ACTUATOR_REPEATS) {
        ++a->repeats;
        rbdi_act_tell_all(a, tau, damping);
        return 1;
    }
    if (finite) rbdi_act_end_step(a, v_next);
    a->begun = 0;
    return 0;
}

RBDI_API rbd_status rbd_actuators_get(const rbd_actuators *a, int motor, rbd_actuator_state *state) {
    const rbdi_act_shaft *s;
    if (!a || !state) return RBD_ERR_NULL;
    if (motor < 0 || motor >= a->n) return RBD_ERR_INDEX;

    s = &a->shaft[motor];
    state->angle = s->angle;
    state->speed = s->speed;
    state->motor = s->motor;
    state->joint = s->joint;
    state->friction = s->level;
    state->current = (s->motor - s->cogging) / rbdi_act_torque_constant(&a->motor[motor]);
    state->winding = s->winding + a->air;
    state->housing = s->housing + a->air;
    state->saturated = s->saturated;
    state->repeats = a->repeats;
    return RBD_OK;
}

#endif
