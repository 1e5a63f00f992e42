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

/* Resistance of a winding of so many degrees. A cold one keeps a tenth of it. */
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

/* Torque of cogging at the shaft. */
RBDI_PART rbd_real rbdi_act_cogging(const rbd_motor *m, rbd_real angle) {
    rbd_real sine, cosine;
    if (!(m->cogging > 0)) return rbdi_zero();
    rbdi_sincos((rbd_real)m->teeth * m->gear * angle + m->phase, &sine, &cosine);
    return (rbd_real)m->gear * m->cogging * sine;
}

/* Cogging in a step, whose work is what its potential loses: its mean over the way dt x of the shaft,

       gear cogging sin(theta + d/2) sin(d/2) / (d/2)
       theta = teeth gear angle + phase,   d = teeth gear dt x

   at the speed x before the step and, where it holds the rotor back and the way is short, implicit. */
RBDI_PART void rbdi_act_cog(const rbd_motor *m, rbdi_act_shaft *s, rbd_real dt, rbd_real share) {
    const rbd_real most = (rbd_real)m->gear * m->cogging;
    const rbd_real rate = (rbd_real)m->teeth * m->gear;
    const rbd_real half = rate * dt * s->speed / 2;
    rbd_real sine, cosine, mean = rbdi_set(RBD_C(1));
    s->cogging = s->cogging_slope = rbdi_zero();
    if (!(m->cogging > 0)) return;

    if (rbdi_abs(half) > RBD_C(1e-4)) {
        rbdi_sincos(half, &sine, &cosine);
        mean = sine / half;
    }
    rbdi_sincos(rate * s->angle + m->phase + half, &sine, &cosine);
    s->cogging = most * sine * mean;
    if (!(rate * most * cosine < 0) || rbdi_abs(half) > RBD_C(0.5)) return;
    s->cogging_slope = -most * rate * cosine * dt * share / 2;
    s->cogging = s->cogging + s->cogging_slope * s->speed;
}

/* A step of heat by implicit Euler; C_w, C_c capacities, g_w, g_c conductances, T above the air:

       C_w (T_w' - T_w) / dt = I^2 R - g_w (T_w' - T_c'),   C_c (T_c' - T_c) / dt = g_w (T_w' - T_c') - g_c
       T_c' */
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
    if (!(rbdi_abs(steps) < RBD_C(1e9))) return seen; /* no int has the number */
    return (rbd_real)(int32_t)(steps + (steps < 0 ? RBD_C(-0.5) : RBD_C(0.5))) * m->step;
}

/* A limit cuts the torque: t and braking are its. That of the current is constant. That of the voltage falls
   with the speed, (K^2 / R) x, and acts implicitly: with the speed before the step it would not be stable. */
RBDI_PART void rbdi_act_saturate(const rbd_motor *m, rbdi_act_shaft *s, rbd_real winding, rbd_real limit,
                                 int side) {
    const rbd_real constant = rbdi_abs(rbdi_act_torque_constant(m));
    s->saturated = (int16_t)side;
    s->t = limit;
    s->now = limit;
    s->braking = rbdi_zero();
    s->gain = rbdi_zero();

    if (m->voltage > 0 && rbdi_abs(limit) < constant * rbdi_act_most_current(m, winding)) {
        const rbd_real resistance = rbdi_act_resistance(m, winding);
        s->t = (rbd_real)side * constant * m->voltage / resistance;
        s->braking = constant * constant / resistance;
    }
    s->rate = s->braking;
}

/* The motor's torque t - braking x under a command, at the angle and speed of its rotor. An implicit drive
   has the angle of the step's end: angle + dt ((1 - share) speed + share x). */
RBDI_PART void rbdi_act_drive_motor(const rbd_motor *m, rbdi_act_shaft *s, const rbd_command *c, rbd_real air,
                                    rbd_real dt, rbd_real share) {
    const rbd_real winding = s->winding + air, constant = rbdi_act_torque_constant(m);
    rbd_real lower, upper;

    rbdi_act_cog(m, s, dt, share);
    s->saturated = 0;
    s->gain = c->kp;
    s->rate = c->kd;
    s->t = c->torque + c->kp * (c->q - rbdi_act_encoder(m, s->angle)) + c->kd * c->v;
    s->now = s->t - c->kd * s->speed;
    if (m->sampled) {
        s->t = s->now;
        s->braking = rbdi_zero();
    } else {
        s->t = s->t - c->kp * dt * (1 - share) * s->speed;
        s->braking = c->kd + c->kp * dt * share;
    }

    rbdi_act_current_range(m, winding, s->speed, &lower, &upper);
    lower = lower * constant;
    upper = upper * constant;
    if (s->now > (lower > upper ? lower : upper))
        rbdi_act_saturate(m, s, winding, lower > upper ? lower : upper, 1);
    if (s->now < (lower > upper ? upper : lower))
        rbdi_act_saturate(m, s, winding, lower > upper ? upper : lower, -1);
    s->t = s->t + s->cogging;
    s->braking = s->braking + s->cogging_slope;
    s->now = s->now + s->cogging;
}

#endif
