#ifndef RBDI_ACTUATOR_MOTOR_H
#define RBDI_ACTUATOR_MOTOR_H
#include "base/sincos.h"
#include "actuator/friction.h"

/* ---- motor [motor code] ---- */

/* Torque at the shaft for an ampere; volts for a rad/s. */
RBDI_INLINE rbd_real rbdi_act_torque_constant(const rbd_motor *m) { return (rbd_real)m->gear * m->constant; }

/* Inertia of the rotor at the shaft. */
RBDI_INLINE rbd_real rbdi_act_rotor_inertia(const rbd_motor *m) {
    return (rbd_real)m->gear * m->gear * m->inertia;
}

/* Resistance of a winding of so many degrees. A cold one keeps a tenth of it: the line of copper would be 0
   at -231 degrees, and no motor works below -200. */
RBDI_INLINE rbd_real rbdi_act_resistance(const rbd_motor *m, rbd_real winding) {
    const rbd_real factor = 1 + m->copper * (winding - RBDI_ACTUATOR_WARM);
    return m->resistance * (factor > RBD_C(0.1) ? factor : rbdi_set(RBD_C(0.1)));
}

/* The limit of current at a temperature of the winding. */
RBDI_PART rbd_real rbdi_act_most_current(const rbd_motor *m, rbd_real winding) {
    const rbd_real most = m->current > 0 ? m->current : RBDI_ACTUATOR_UNLIMITED;
    if (!(m->hottest > m->hot)) return most;
    return most *
           rbdi_act_clamp((m->hottest - winding) / (m->hottest - m->hot), rbdi_zero(), rbdi_set(RBD_C(1)));
}

/* Least and largest current at shaft speed x: |I| <= most and |R I + K x| <= voltage. */
RBDI_PART void rbdi_act_current_range(const rbd_motor *m, rbd_real winding, rbd_real x, rbd_real *lower,
                                      rbd_real *upper) {
    const rbd_real most = rbdi_act_most_current(m, winding);
    const rbd_real back = rbdi_act_torque_constant(m) * x;
    *lower = -most;
    *upper = most;
    if (m->voltage > 0) {
        const rbd_real conductance = 1 / rbdi_act_resistance(m, winding);
        *lower = rbdi_act_clamp((-m->voltage - back) * conductance, -most, most);
        *upper = rbdi_act_clamp((m->voltage - back) * conductance, -most, most);
    }
}

/* ---- cogging [cogging] ----
   The torque gear cogging sin(theta), theta = teeth gear angle + phase, is that of the potential
   cogging / teeth cos(theta). In a step its work is what the potential loses if it is its mean over the way
   dt x of the shaft,

       gear cogging sin(theta + d/2) sin(d/2) / (d/2),   d = teeth gear dt x

   It is told at the speed x before the step and, where it holds the rotor back and d is within a radian, so
   that the torque changes evenly, implicit. The step's own way differs, and the work with it. The difference,
   s->lent, is paid back: above a tenth of a tooth's height, cogging has no torque in steps where it would add
   to that. So what it gives beyond its potential is bounded by a tooth's height while teeth gear^2 cogging
   dt^2 is below twice the inertia that the shaft moves (tests/test_actuator.c). */

/* Torque of cogging at the shaft. */
RBDI_PART rbd_real rbdi_act_cogging(const rbd_motor *m, rbd_real angle) {
    rbd_real sine, cosine;
    if (!(m->cogging > 0)) return rbdi_zero();
    rbdi_sincos((rbd_real)m->teeth * m->gear * angle + m->phase, &sine, &cosine);
    return (rbd_real)m->gear * m->cogging * sine;
}

/* How much energy cogging takes from its least to its largest, J. */
RBDI_INLINE rbd_real rbdi_act_tooth(const rbd_motor *m) { return 2 * (rbd_real)m->cogging / m->teeth; }

/* Adds to s->lent the work of cogging on the way from the shaft's angle, less what its potential loses. */
RBDI_PART void rbdi_act_lend(const rbd_motor *m, rbdi_act_shaft *s, rbd_real way) {
    const rbd_real rate = (rbd_real)m->teeth * m->gear;
    const rbd_real begin = rate * s->angle + m->phase;
    const rbd_real torque = s->cogging - s->cogging_slope * s->speed;
    rbd_real sine, before, after;
    if (!(m->cogging > 0)) return;

    rbdi_sincos(begin, &sine, &before);
    rbdi_sincos(begin + rate * way, &sine, &after);
    s->lent = s->lent + torque * way - rbdi_act_tooth(m) / 2 * (before - after);
}

/* Cogging in a step. */
RBDI_PART void rbdi_act_cog(const rbd_motor *m, rbdi_act_shaft *s, rbd_real dt, rbd_real share) {
    const rbd_real most = (rbd_real)m->gear * m->cogging;
    const rbd_real rate = (rbd_real)m->teeth * m->gear;
    const rbd_real half = rate * dt * s->speed / 2;
    rbd_real sine, cosine, mean = rbdi_set(RBD_C(1));
    s->cogging = s->cogging_slope = rbdi_zero();
    if (!(m->cogging > 0)) return;

    if (rbdi_abs(half) > 0) {
        rbdi_sincos(half, &sine, &cosine);
        mean = sine / half;
    }
    rbdi_sincos(rate * s->angle + m->phase + half, &sine, &cosine);
    s->cogging = most * sine * mean;

    if (rbdi_abs(s->lent) > rbdi_act_tooth(m) / 10 && s->lent * s->cogging * s->speed > 0) {
        s->cogging = rbdi_zero();
        return;
    }
    if (!(rate * most * cosine < 0) || rbdi_abs(half) > RBD_C(0.5)) return;
    s->cogging_slope = -most * rate * cosine * dt * share / 2;
    s->cogging = s->cogging + s->cogging_slope * s->speed;
}

/* A step of heat by implicit Euler; C_w, C_c capacities, g_w, g_c conductances, T above the air:

       C_w (T_w' - T_w) / dt = I^2 R - g_w (T_w' - T_c')
       C_c (T_c' - T_c) / dt = g_w (T_w' - T_c') - g_c T_c' */
RBDI_PART void rbdi_act_heat(const rbd_motor *m, rbdi_act_shaft *s, rbd_real current, rbd_real air,
                             rbd_real dt) {
    const rbd_real most = rbdi_set(RBDI_ACTUATOR_MOST), hottest = rbdi_set(RBDI_ACTUATOR_HOTTEST);
    rbd_real power, g_w, g_c, a_ww, a_cc, b_w, b_c, determinant;
    if (!(m->heat_winding > 0)) return;

    current = rbdi_act_clamp(current, -most, most);
    power = current * current * rbdi_act_resistance(m, s->winding + air);
    g_w = 1 / (rbd_real)m->flow_winding;
    a_ww = m->heat_winding / dt + g_w;
    b_w = m->heat_winding / dt * s->winding + power;
    if (!(m->heat_case > 0)) {
        s->winding = rbdi_act_clamp(b_w / a_ww, -hottest, hottest);
        return;
    }

    g_c = 1 / (rbd_real)m->flow_case;
    a_cc = m->heat_case / dt + g_w + g_c;
    b_c = m->heat_case / dt * s->housing;
    determinant = m->heat_winding / dt * a_cc + g_w * (m->heat_case / dt + g_c); /* a_ww a_cc - g_w^2 */
    s->winding = rbdi_act_clamp((a_cc * b_w + g_w * b_c) / determinant, -hottest, hottest);
    s->housing = rbdi_act_clamp((g_w * b_w + a_ww * b_c) / determinant, -hottest, hottest);
}

/* ---- drive [drive code] ---- */

/* What the encoder says: (angle + offset) in whole steps. */
RBDI_PART rbd_real rbdi_act_encoder(const rbd_motor *m, rbd_real angle) {
    const rbd_real seen = angle + m->offset;
    rbd_real steps;
    if (!(m->step > 0)) return seen;

    steps = seen / m->step;
    if (!(rbdi_abs(steps) < RBD_C(1e9))) return seen; /* beyond int32_t */
    return (rbd_real)(int32_t)(steps + (steps < 0 ? RBD_C(-0.5) : RBD_C(0.5))) * m->step;
}

/* A line t - braking x of a motor's torque by its speed. */
typedef struct rbdi_act_line {
    rbd_real t, braking;
    int saturated; /* as in rbd_drive */
} rbdi_act_line;

/* The line within the limits at speed x, which all fall with the speed:

       |t| <= most,   |t + droop x| <= stall */
RBDI_PART rbdi_act_line rbdi_act_limit(const rbdi_act_shaft *s, rbdi_act_line line, rbd_real x) {
    const rbd_real asked = line.t - line.braking * x;
    rbd_real given;
    line.saturated = 0;
    if (asked > s->stall - s->droop * x) line.saturated = 1;
    if (asked < -s->stall - s->droop * x) line.saturated = -1;
    if (line.saturated) {
        line.t = (rbd_real)line.saturated * s->stall;
        line.braking = s->droop;
    }

    given = line.t - line.braking * x;
    if (given <= s->most && given >= -s->most) return line;
    if (!line.saturated) line.saturated = given > 0 ? 1 : -1;
    line.t = given > 0 ? s->most : -s->most;
    line.braking = rbdi_zero();
    return line;
}

/* The motor's line at the speed x of its shaft at the step's end, without cogging. */
RBDI_PART rbdi_act_line rbdi_act_motor_at(const rbdi_act_shaft *s, rbd_real x) {
    rbdi_act_line line;
    line.t = s->t;
    line.braking = s->braking;
    line.saturated = 0;
    return rbdi_act_limit(s, line, x);
}

/* The limits at the winding's temperature. */
RBDI_PART void rbdi_act_note_limits(const rbd_motor *m, rbdi_act_shaft *s, rbd_real winding) {
    const rbd_real constant = rbdi_abs(rbdi_act_torque_constant(m));
    s->most = constant * rbdi_act_most_current(m, winding);
    s->stall = constant * RBDI_ACTUATOR_UNLIMITED;
    s->droop = rbdi_zero();
    if (m->voltage > 0 || m->by_voltage)
        s->droop = rbdi_act_clamp(constant * constant / rbdi_act_resistance(m, winding), rbdi_zero(),
                                  rbdi_set(RBDI_ACTUATOR_UNLIMITED));
    if (m->voltage > 0) s->stall = constant * m->voltage / rbdi_act_resistance(m, winding);
}

/* The torque that the drive asks for, at the angle and speed of its rotor:

       torque + kp (q - angle) + kd (v - speed)

   A drive by voltage sets volts, which are the torque K volts / R - droop speed. A quick drive has the angle
   and the speed of the step's end, angle + dt ((1 - share) speed + share x); one that samples those of its
   beginning. */
RBDI_PART void rbdi_act_drive_motor(const rbd_motor *m, rbdi_act_shaft *s, const rbd_command *c, rbd_real air,
                                    rbd_real dt, rbd_real share) {
    const rbd_real winding = s->winding + air, constant = rbdi_act_torque_constant(m);
    rbd_real kp = c->kp, kd = c->kd, droop = rbdi_zero(), feed = c->torque;
    rbdi_act_line line;

    rbdi_act_cog(m, s, dt, share);
    rbdi_act_note_limits(m, s, winding);
    s->pass = rbdi_set(RBD_C(1));
    if (m->by_voltage) {
        const rbd_real conductance = 1 / rbdi_act_resistance(m, winding);
        s->pass = constant * conductance;
        feed = s->pass * c->voltage;
        kp = rbdi_abs(s->pass) * kp;
        kd = rbdi_abs(s->pass) * kd;
        droop = s->droop;
    }

    s->t = feed + kp * (c->q - rbdi_act_encoder(m, s->angle)) + kd * c->v;
    s->now = s->t - (kd + droop) * s->speed;
    s->gain = kp;
    s->rate = kd + droop;
    if (m->sampled) {
        s->t = s->t - kd * s->speed;
        s->braking = droop;
    } else {
        s->t = s->t - kp * dt * (1 - share) * s->speed;
        s->braking = kd + droop + kp * dt * share;
    }

    /* in continuous time, at the step's beginning */
    line.t = s->now;
    line.braking = rbdi_zero();
    line = rbdi_act_limit(s, line, s->speed);
    s->now = line.t - line.braking * s->speed + s->cogging;
    if (!line.saturated) return;
    s->pass = s->gain = rbdi_zero();
    s->rate = line.braking;
}

#endif
