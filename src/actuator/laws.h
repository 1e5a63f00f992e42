#ifndef RBDI_ACTUATOR_LAWS_H
#define RBDI_ACTUATOR_LAWS_H
#include "actuator/motor.h"

/* ---- laws [laws of shafts] ----
   The motor's torque m(y) at its speed y of the step's end is what the drive asks for within its limits,
   rbdi_act_motor_at, and cogging; it falls with y. A rigid shaft, whose rotor turns with the joint, gives at
   the end's speed x = y the torque

       m(x) - J ((x - x_0) / dt + bias) - viscous (x - still) - dry,   dry = clamp(F (x - still) / w, -F, F)

   with the level F and the speed before the step x_0. Its work is that times the mean speed by which the
   joint moves, x_m = (1 - share) x_0 + share x. In a step of first order, share = 1, still is 0. Else
   friction at the end's speed makes energy where a shaft turns around: there x and x_m are against each
   other. So

       still = clamp(x, -turn, 0) or clamp(x, 0, -turn),   turn = x_0 (1 - share) / share

   which lies between the speeds at which x and x_m vanish: friction is 0 or against both of them, so that it
   takes dt friction x_m >= 0 whatever dt is. In between the shaft coasts. It is the law of the bounded rows
   of rbd_contact_step, but for the width w: what sticks creeps here, at most by w = RBDI_ACTUATOR_CREEP, and
   what turned around, still = -turn, has w = RBDI_ACTUATOR_BEND turn more. A bristle of stiffness k that has
   the torque b makes dry = clamp(b + k dt x_m, -F, F).

   A shaft with a spring, whose rotor has an angle and a speed y of its own. With delta = angle - phi,
   play 2 h, K = dt k + d, r = y - x_m the joint gets the impulse

       p = max(0, dt k (delta - h) + dt K r) + min(0, dt k (delta + h) + dt K r)
       J (y - y_0) = dt (m(y) - viscous y) - p + p_f,   p_f = -dt F sign(y), or less at y = 0

   Both are solved exactly for each line of m: first with y = 0; if friction cannot hold the rotor so, with
   p_f = +-dt F. The line is the right one if it is that of m at the y that comes out. The energy of the
   spring changes by p r at most, that of the joints by p x_m, and that of the rotor by (p_f - p) y at most:
   together they do not grow. */

/* A piece of a law: the torque start - slope x. */
typedef struct rbdi_act_piece {
    rbd_real start, slope;
} rbdi_act_piece;

RBDI_INLINE rbd_real rbdi_act_torque_of(rbdi_act_piece piece, rbd_real x) {
    return piece.start - piece.slope * x;
}

/* Mean speed of a step on the joint's side. */
RBDI_INLINE rbd_real rbdi_act_mean(const rbd_actuators *a, const rbdi_act_shaft *s, rbd_real x) {
    return (1 - a->share) * s->x + a->share * x;
}

/* The speed `still` of [laws of shafts], and whether the shaft coasts. */
typedef struct rbdi_act_turning {
    rbd_real still;
    int coasts;
} rbdi_act_turning;

RBDI_INLINE rbdi_act_turning rbdi_act_turning_at(const rbd_actuators *a, const rbdi_act_shaft *s,
                                                 rbd_real x) {
    const rbd_real turned = -s->x * (1 - a->share) / a->share;
    const rbd_real least = turned < 0 ? turned : rbdi_zero();
    const rbd_real most = turned > 0 ? turned : rbdi_zero();
    rbdi_act_turning turning;
    turning.still = rbdi_act_clamp(x, least, most);
    turning.coasts = x > least && x < most;
    return turning;
}

/* How well a step that begins with the shaft's speed tells the speed of its end. */
RBDI_INLINE rbd_real rbdi_act_speed_rounding(const rbdi_act_shaft *s) {
    return RBDI_ACTUATOR_ROUNDING * rbdi_abs(s->x);
}

/* The dry friction of a rigid shaft at speed x. */
RBDI_PART rbdi_act_piece rbdi_act_dry(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                      const rbd_actuators *a) {
    const rbdi_act_turning turning = rbdi_act_turning_at(a, s, x);
    rbdi_act_piece dry;
    rbd_real torque;
    if (m->friction.bristle > 0) {
        dry.start = -(s->bristle + m->friction.bristle * a->dt * (1 - a->share) * s->x);
        dry.slope = m->friction.bristle * a->dt * a->share;
    } else {
        const rbd_real width =
            RBDI_ACTUATOR_CREEP + rbdi_act_speed_rounding(s) + RBDI_ACTUATOR_BEND * rbdi_abs(turning.still);
        dry.slope = turning.coasts ? rbdi_zero() : s->level / width;
        dry.start = dry.slope * turning.still;
    }

    torque = rbdi_act_torque_of(dry, x);
    if (torque <= s->level && torque >= -s->level) return dry;
    dry.start = torque > 0 ? s->level : -s->level;
    dry.slope = rbdi_zero();
    return dry;
}

/* -1 or 1 where dry friction slides at the speed before the step, 0 where it sticks. */
RBDI_PART int rbdi_act_slides(const rbd_motor *m, const rbdi_act_shaft *s, const rbd_actuators *a) {
    const rbdi_act_piece dry = rbdi_act_dry(m, s, s->x, a);
    return dry.slope > 0 ? 0 : -rbdi_act_sign(dry.start);
}

/* A rigid shaft without its dry friction. */
RBDI_PART rbdi_act_piece rbdi_act_rigid_without(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                                const rbd_actuators *a) {
    const rbdi_act_line line = rbdi_act_motor_at(s, x);
    const rbdi_act_turning turning = rbdi_act_turning_at(a, s, x);
    const rbd_real viscous = turning.coasts ? rbdi_zero() : rbdi_set(m->friction.viscous);
    const rbd_real J = rbdi_act_rotor_inertia(m);
    rbdi_act_piece piece;
    piece.start = line.t + s->cogging + viscous * turning.still + J * (s->x / a->dt - s->bias);
    piece.slope = line.braking + s->cogging_slope + viscous + J / a->dt;
    return piece;
}

RBDI_PART rbdi_act_piece rbdi_act_rigid_law(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                            const rbd_actuators *a) {
    const rbdi_act_piece dry = rbdi_act_dry(m, s, x, a);
    rbdi_act_piece piece = rbdi_act_rigid_without(m, s, x, a);
    piece.start = piece.start + dry.start;
    piece.slope = piece.slope + dry.slope;
    return piece;
}

/* What a spring does: the impulse on the joint, its slope by -x_m, the rotor's speed. */
typedef struct rbdi_act_spring {
    rbd_real p, slope, y;
} rbdi_act_spring;

/* K of [laws of shafts]: what the spring's torque gains in a step by each rad/s. */
RBDI_INLINE rbd_real rbdi_act_spring_slope(const rbd_motor *m, rbd_real dt) {
    return dt * m->stiffness + m->damping;
}

/* How far the spring is wound beyond the play, on its side 1 or -1. */
RBDI_INLINE rbd_real rbdi_act_wound(const rbd_motor *m, const rbdi_act_shaft *s, int side) {
    return s->angle - s->phi - (rbd_real)side * (m->backlash / 2);
}

/* The spring where the rotor's speed would be r + x_m without it, and falls by e for each unit of p. */
RBDI_PART rbd_real rbdi_act_mesh(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real r, rbd_real e,
                                 rbd_real dt) {
    const rbd_real K = rbdi_act_spring_slope(m, dt);
    const rbd_real up = dt * (m->stiffness * rbdi_act_wound(m, s, 1) + K * r) / (1 + dt * K * e);
    const rbd_real down = dt * (m->stiffness * rbdi_act_wound(m, s, -1) + K * r) / (1 + dt * K * e);
    return up > 0 ? up : down < 0 ? down : rbdi_zero();
}

/* The speed y of a rotor that gets the impulse `given` and gives p to the spring: with w, what the spring is
   wound,

       J_t y = given - p,   p = dt (k w + K (y - x_m))

   If it is light and the spring is stiff, the difference given - p is rounding. So p is put in. */
RBDI_PART rbd_real rbdi_act_meshed_speed(const rbd_motor *m, const rbdi_act_shaft *s,
                                         const rbdi_act_spring *spring, rbd_real given, rbd_real J_t,
                                         rbd_real x_m, rbd_real dt) {
    const int side = rbdi_act_sign(spring->p);
    const rbd_real wound = rbdi_act_wound(m, s, side);
    const rbd_real K = rbdi_act_spring_slope(m, dt);
    return side ? (given + dt * (K * x_m - m->stiffness * wound)) / (J_t + dt * K) : given / J_t;
}

/* The spring's law at the speed x of the joint's side, if this is the motor's line. */
RBDI_PART rbdi_act_spring rbdi_act_spring_by(const rbd_motor *m, const rbdi_act_shaft *s, rbdi_act_line line,
                                             rbd_real x, const rbd_actuators *a) {
    const rbd_real dt = a->dt, x_m = rbdi_act_mean(a, s, x), most = dt * s->level;
    const rbd_real t = line.t + s->cogging;
    const rbd_real braking = line.braking + s->cogging_slope;
    const rbd_real J = rbdi_act_rotor_inertia(m);
    const rbd_real J_t = J + dt * (braking + m->friction.viscous);
    const rbd_real K = rbdi_act_spring_slope(m, dt);
    const rbd_real given = J * s->speed + dt * t;
    rbdi_act_spring spring;

    spring.y = rbdi_zero();
    spring.slope = K;
    spring.p = rbdi_act_mesh(m, s, -x_m, rbdi_zero(), dt);
    if (rbdi_abs(spring.p - given) > most) {
        const rbd_real friction = spring.p > given ? most : -most;
        spring.slope = K / (1 + dt * K / J_t);
        spring.p = rbdi_act_mesh(m, s, (given + friction) / J_t - x_m, 1 / J_t, dt);
        spring.y = rbdi_act_meshed_speed(m, s, &spring, given + friction, J_t, x_m, dt);
    }
    if (!(rbdi_abs(spring.p) > 0)) spring.slope = rbdi_zero();
    return spring;
}

/* The lines of a motor: what the drive asks for, the limits of the current and of the voltage. */
RBDI_PART rbdi_act_line rbdi_act_line_of(const rbdi_act_shaft *s, int number) {
    rbdi_act_line line;
    line.saturated = number == 0 ? 0 : number % 2 ? 1 : -1;
    line.t = number == 0 ? s->t : (rbd_real)line.saturated * (number > 2 ? s->stall : s->most);
    line.braking = number == 0 ? s->braking : number > 2 ? s->droop : rbdi_zero();
    return line;
}

/* With the line that is the motor's at the rotor's speed. As all laws are monotone, one is. */
RBDI_PART rbdi_act_spring rbdi_act_spring_at(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                             const rbd_actuators *a) {
    rbdi_act_spring best;
    rbd_real least = rbdi_zero();
    for (int k = 0; k < 5; ++k) {
        const rbdi_act_line line = rbdi_act_line_of(s, k);
        const rbdi_act_spring spring = rbdi_act_spring_by(m, s, line, x, a);
        const rbdi_act_line there = rbdi_act_motor_at(s, spring.y);
        const rbd_real off =
            rbdi_abs(line.t - line.braking * spring.y - (there.t - there.braking * spring.y));
        if (k == 0 || off < least) {
            least = off;
            best = spring;
        }
        if (!(least > 0)) break;
    }
    return best;
}

/* The piece of a shaft's law at the speed x of its joint's side. */
RBDI_PART rbdi_act_piece rbdi_act_law(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                      const rbd_actuators *a) {
    rbdi_act_piece piece;
    rbdi_act_spring spring;
    if (!(m->stiffness > 0)) return rbdi_act_rigid_law(m, s, x, a);

    spring = rbdi_act_spring_at(m, s, x, a);
    piece.slope = a->share * spring.slope;
    piece.start = spring.p / a->dt + piece.slope * x;
    return piece;
}

/* The torque of a shaft's law at the speed x of its joint's side. */
RBDI_PART rbd_real rbdi_act_law_at(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                   const rbd_actuators *a) {
    return rbdi_act_torque_of(rbdi_act_law(m, s, x, a), x);
}

/* By how much the joint's torque T at speed x is not that of the law. The speed is known to its rounding in
   a step that begins with s->x and, of coupled shafts, to a->speed_rounding. A coupled shaft may have any
   torque within the level of friction while it sticks: there x is rounding. */
RBDI_PART rbd_real rbdi_act_off(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real T, rbd_real x,
                                const rbd_actuators *a) {
    const int sticks = s->dof < 0 && !(m->stiffness > 0) && !(m->friction.bristle > 0);
    const rbd_real creep = sticks ? RBDI_ACTUATOR_CREEP * (1 + s->scale) : rbdi_zero();
    const rbd_real rounding = a->speed_rounding + rbdi_act_speed_rounding(s);
    const rbd_real slower = x - rounding;
    const rbd_real faster = x + rounding;
    rbd_real least, most;
    if (!sticks) {
        least = rbdi_act_law_at(m, s, faster, a);
        most = rbdi_act_law_at(m, s, slower, a);
    } else {
        least = rbdi_act_torque_of(rbdi_act_rigid_without(m, s, faster, a), faster) +
                rbdi_act_torque_of(rbdi_act_dry(m, s, faster + creep, a), faster + creep);
        most = rbdi_act_torque_of(rbdi_act_rigid_without(m, s, slower, a), slower) +
               rbdi_act_torque_of(rbdi_act_dry(m, s, slower - creep, a), slower - creep);
    }
    return T - rbdi_act_clamp(T, least, most);
}

/* The size of what the law adds up at the new speed, N m; not so small that rounding is another. A spring
   passes on the share slope / (dt stiffness + damping) of what it adds up. */
RBDI_PART rbd_real rbdi_act_size(const rbd_motor *m, const rbdi_act_shaft *s, const rbd_actuators *a) {
    const rbdi_act_piece law = rbdi_act_law(m, s, s->next, a);
    const rbd_real wound = rbdi_abs(s->angle - s->phi) + m->backlash;
    const rbd_real speeds = rbdi_abs(s->x) + rbdi_abs(s->next) + rbdi_abs(s->speed);
    const rbd_real K = rbdi_act_spring_slope(m, a->dt);
    rbd_real size = rbdi_abs(law.start) + rbdi_abs(law.slope * s->next) + rbdi_abs(s->force) +
                    rbdi_abs(s->t) + rbdi_abs(s->cogging) + s->level + RBDI_ACTUATOR_NOTHING;
    if (K > 0) size = size + law.slope / (a->share * K) * (m->stiffness * wound + K * speeds);
    return size;
}

/* The state of the shaft at the end of the step, where the joint's side has speed x and gets s->force. */
RBDI_PART void rbdi_act_end_shaft(const rbd_motor *m, rbdi_act_shaft *s, rbd_real x, const rbd_actuators *a) {
    rbdi_act_line line;
    rbd_real t, way;
    s->joint = s->force;
    if (m->stiffness > 0) {
        const rbdi_act_spring spring = rbdi_act_spring_at(m, s, x, a);
        s->joint = spring.p / a->dt;
        s->speed = spring.y;
        way = a->dt * spring.y;
    } else {
        s->speed = x;
        way = a->dt * rbdi_act_mean(a, s, x);
        if (m->friction.bristle > 0) s->bristle = -rbdi_act_torque_of(rbdi_act_dry(m, s, x, a), x);
    }

    rbdi_act_lend(m, s, way);
    s->angle = s->angle + way;

    line = rbdi_act_motor_at(s, s->speed);
    t = line.t - line.braking * s->speed;
    s->saturated = (int16_t)line.saturated;
    s->motor = t + (s->cogging - s->cogging_slope * s->speed);
    s->current = t / rbdi_act_torque_constant(m);
    rbdi_act_heat(m, s, s->current, a->air, a->dt);
}

#endif
