#ifndef RBDI_ACTUATOR_STEP_H
#define RBDI_ACTUATOR_STEP_H
#include "base/memory.h"
#include "actuator/coupled.h"
#include "actuator/learning.h"

/* ---- forward [forward code] ---- */

/* All shafts at rest at their angles phi, as warm as the air. */
RBDI_LOCAL void rbdi_act_rest(rbd_actuators *a, rbd_real air) {
    a->air = air;
    a->begun = 0;
    a->repeats = a->noted = a->pairs = 0;
    a->speed_rounding = a->torque_rounding = rbdi_zero();
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        s->angle = s->phi;
        s->speed = s->winding = s->housing = s->bristle = rbdi_zero();
        s->motor = s->joint = s->current = s->level = rbdi_zero();
        s->cogging = s->cogging_slope = s->lent = rbdi_zero();
        s->t = s->now = s->braking = s->gain = s->rate = rbdi_zero();
        s->most = s->stall = s->droop = s->pass = rbdi_zero();
        s->start = s->slope = s->point = s->base = s->next = s->force = s->scale = rbdi_zero();
        s->branch = s->saturated = s->oldest = 0;
    }
    a->known = 0;
    for (int i = 0; i < a->n * a->ring; ++i) {
        rbd_command *c = &a->commands[i];
        c->q = c->v = c->kp = c->kd = c->torque = c->voltage = rbdi_zero();
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
    s->arrived = *given;
    if (a->motor[i].delay < 1) return *given;
    s->arrived = *oldest;
    *oldest = *given;
    s->oldest = (int16_t)((s->oldest + 1) % a->motor[i].delay);
    return s->arrived;
}

/* Puts the commands back of a step that has not ended: the oldest into the ring, the new one out. */
RBDI_LOCAL void rbdi_act_take_back(rbd_actuators *a) {
    for (int i = 0; i < a->n && a->begun; ++i) {
        const int delay = a->motor[i].delay;
        rbdi_act_shaft *s = &a->shaft[i];
        if (delay < 1) continue;
        s->oldest = (int16_t)((s->oldest + delay - 1) % delay);
        a->commands[i * a->ring + s->oldest] = s->arrived;
    }
    a->begun = 0;
}

/* Whether a command suits the motor: finite, no negative gain, no torque by voltage and no voltage else. */
RBDI_LOCAL int rbdi_act_is_command(const rbd_motor *m, const rbd_command *c) {
    const rbd_real other = m->by_voltage ? c->torque : c->voltage;
    const rbd_real x[6] = {c->q, c->v, c->kp, c->kd, c->torque, c->voltage};
    return rbdi_act_all_moderate(x, 6) && c->kp >= 0 && c->kd >= 0 && other >= 0 && other <= 0;
}

/* Tells the step the pieces of all shafts at their points or, if the mass is known, at the speeds that will
   come out. */
RBDI_LOCAL void rbdi_act_tell_all(rbd_actuators *a, rbd_real *tau, rbd_real *damping) {
    a->known = a->known && rbdi_act_foretell(a);
    rbdi_act_take_pieces(a);
    rbdi_clear(tau, a->nv);
    rbdi_clear(damping, a->nv);
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        const rbd_motor *m = &a->motor[i];
        if (s->dof < 0) {
            s->smooth = m->stiffness > 0 ? s->slope : rbdi_act_rigid_without(m, s, s->point, a).slope;
            if (!a->known) s->base = s->start - s->slope * s->point;
        } else {
            tau[s->dof] = s->start;
            damping[s->dof] = s->slope;
        }
    }
    for (rbdi_act_group *g = a->group; g < a->group + a->groups; ++g) {
        rbdi_act_tell_group(a, g);
        for (int j = 0; j < g->n; ++j) {
            tau[g->dof[j]] = g->start[j];
            damping[g->dof[j]] = g->damping[j];
        }
    }
}

RBDI_API rbd_status rbd_actuators_begin(rbd_actuators *a, const rbd_command *commands, const rbd_real *q,
                                        const rbd_real *v, rbd_real dt, int first_order, rbd_real *tau,
                                        rbd_real *damping) {
    rbd_status status;
    if (!a || !commands || !q || !v || !tau || !damping) return RBD_ERR_NULL;
    rbdi_act_take_back(a);
    if (!(dt >= RBD_C(1e-9) && dt <= RBD_C(1e3))) return RBD_ERR_RANGE;
    for (int i = 0; i < a->n; ++i)
        if (!rbdi_act_is_command(&a->motor[i], &commands[i])) return RBD_ERR_RANGE;
    status = rbdi_act_map(a, q, v);
    if (status) return status;

    a->dt = dt;
    a->share = rbdi_set(first_order ? RBD_C(1) : RBD_C(0.5));
    a->begun = 1;
    a->repeats = a->noted = a->pairs = 0;
    for (int i = 0; i < a->n; ++i) {
        const rbd_motor *m = &a->motor[i];
        rbdi_act_shaft *s = &a->shaft[i];
        const rbd_command c = rbdi_act_delay(a, i, &commands[i]);
        if (!(m->stiffness > 0)) {
            s->angle = s->phi;
            s->speed = s->x;
        }
        rbdi_act_drive_motor(m, s, &c, a->air, dt, m->stiffness > 0 ? rbdi_set(RBD_C(1)) : a->share);
        s->level = rbd_friction_level(&m->friction, s->speed, s->motor, -s->joint);
        s->point = s->seen_x = s->x;
        s->seen_T = s->base;
        s->branch = (int16_t)rbdi_act_slides(m, s, a);
    }
    for (rbdi_act_group *g = a->group; g < a->group + a->groups; ++g)
        for (int j = 0; j < g->n; ++j) g->v[j] = v[g->dof[j]];
    rbdi_act_tell_all(a, tau, damping);
    return RBD_OK;
}

/* Notes the shafts' speeds at joint speeds v, and the torques that the joints have there. */
RBDI_LOCAL void rbdi_act_note_speeds(rbd_actuators *a, const rbd_real *v) {
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        if (s->dof < 0) continue;
        s->next = v[s->dof];
        s->force = s->start - s->slope * s->next;
    }
    for (int i = 0; i < a->groups; ++i) rbdi_act_note_group(a, &a->group[i], v);
    if (a->groups > 0) rbdi_act_note_rounding(a);
}

/* By how much the torque of a shaft may differ from its law, N m: by rounding and, where it was told a slope,
   by that of the speed. */
RBDI_LOCAL rbd_real rbdi_act_bound(const rbd_actuators *a, int i) {
    const rbdi_act_shaft *s = &a->shaft[i];
    if (s->dof < 0) return RBDI_ACTUATOR_SETTLED * s->size + a->torque_rounding;
    return RBDI_ACTUATOR_ROUNDING * rbdi_act_size(&a->motor[i], s, a) +
           s->slope * rbdi_act_speed_rounding(s) + a->torque_rounding;
}

/* Whether all shafts have the torques of their laws at the new speeds. */
RBDI_LOCAL int rbdi_act_all_settle(const rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real off = rbdi_act_off(&a->motor[i], s, s->force, s->next, a);
        if (rbdi_abs(off) > rbdi_act_bound(a, i)) return 0;
    }
    return 1;
}

/* Ends the step at the speeds that were noted. */
RBDI_LOCAL void rbdi_act_end_step(rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) rbdi_act_end_shaft(&a->motor[i], &a->shaft[i], a->shaft[i].next, a);
    if (a->known) rbdi_act_foresee(a);
}

/* Learns from the new speeds, moves the points there, and tells the step the pieces. */
RBDI_LOCAL void rbdi_act_repeat(rbd_actuators *a, rbd_real *tau, rbd_real *damping) {
    ++a->repeats;
    ++a->noted;
    if (a->groups > 0 && !a->known)
        rbdi_act_guess_mass(a);
    else if (a->groups > 0 && a->noted > 1)
        rbdi_act_learn(a);
    rbdi_act_move_points(a, a->groups == 0 && a->noted > 1);
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        s->seen_x = s->point;
        s->seen_T = s->base;
    }
    rbdi_act_tell_all(a, tau, damping);
}

/* Begins the step anew without the masses that were learnt, which made speeds without bound. Returns 0 if
   there are none. */
RBDI_LOCAL int rbdi_act_forget(rbd_actuators *a, rbd_real *tau, rbd_real *damping) {
    if (!a->known) return 0;
    a->known = 0;
    ++a->repeats;
    a->noted = a->pairs = 0;
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) s->point = s->x;
    rbdi_act_tell_all(a, tau, damping);
    return 1;
}

RBDI_API int rbd_actuators_again(rbd_actuators *a, const rbd_real *v_next, rbd_real *tau, rbd_real *damping) {
    if (!a || !v_next || !tau || !damping || !a->begun) return 0;
    if (!rbdi_act_all_moderate(v_next, a->nv)) {
        if (a->repeats < RBDI_ACTUATOR_REPEATS && rbdi_act_forget(a, tau, damping)) return 1;
        rbdi_act_take_back(a);
        return 0;
    }

    rbdi_act_note_speeds(a, v_next);
    if (a->repeats < RBDI_ACTUATOR_REPEATS && !rbdi_act_all_settle(a)) {
        rbdi_act_repeat(a, tau, damping);
        return 1;
    }
    rbdi_act_end_step(a);
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
    state->current = s->current;
    state->winding = s->winding + a->air;
    state->housing = s->housing + a->air;
    state->saturated = s->saturated;
    state->repeats = a->repeats;
    return RBD_OK;
}

#endif
