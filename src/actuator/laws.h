#ifndef RBDI_ACTUATOR_LAWS_H
#define RBDI_ACTUATOR_LAWS_H
#include "actuator/motor.h"

/* ---- laws [laws of shafts] ----
   A rigid shaft, whose rotor turns with the joint. At the end's speed x it gives the torque

       t - (braking + viscous) x - J ((x - x_0) / dt + bias) - w,   w = clamp(b + k dt x_m, -F, F)

   with the motor's torque t, the level F, a bristle of stiffness k that now has the torque b, and the mean
   speed x_m by which the joint moves, (1 - share) x_0 + share x. Without a bristle w = clamp(F x / creep, -F,
   F): what sticks creeps, at most by RBDI_ACTUATOR_CREEP.

   A shaft with a spring, whose rotor has an angle and a speed y of its own. With delta = angle - g, play 2 h,
   K = dt k + d, r = y - x_m the joint gets the impulse

       p = max(0, dt k (delta - h) + dt K r) + min(0, dt k (delta + h) + dt K r)
       J (y - y_0) = dt (t - (braking + viscous) y) - p + p_f,   p_f = -dt F sign(y), or less at y = 0

   Both are solved exactly: first with y = 0; if friction cannot hold the rotor so, with p_f = +-dt F. The
   energy of the spring changes by p r at most, that of the joints by p x_m, and that of the rotor by (p_f -
   p) y at most: together they do not grow. */

/* Mean speed of a step on the joint's side. */
RBDI_INLINE rbd_real rbdi_act_mean(const rbd_actuators *a, const rbdi_act_shaft *s, rbd_real x) {
    return (1 - a->share) * s->x + a->share * x;
}

/* Torque of dry friction where it does not slide: w = offset + slope x. */
typedef struct rbdi_act_stiction {
    rbd_real offset, slope;
} rbdi_act_stiction;

RBDI_PART rbdi_act_stiction rbdi_act_sticks(const rbd_motor *m, const rbdi_act_shaft *s,
                                            const rbd_actuators *a) {
    rbdi_act_stiction w;
    w.offset = rbdi_zero();
    w.slope = s->level / RBDI_ACTUATOR_CREEP;
    if (m->friction.bristle > 0) {
        w.offset = s->bristle + m->friction.bristle * a->dt * (1 - a->share) * s->x;
        w.slope = m->friction.bristle * a->dt * a->share;
    }
    return w;
}

/* The branch of the friction of a rigid shaft at speed x: 1 or -1 where it slides. */
RBDI_PART int rbdi_act_rigid_branch(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                    const rbd_actuators *a) {
    const rbdi_act_stiction sticks = rbdi_act_sticks(m, s, a);
    const rbd_real w = sticks.offset + sticks.slope * x;
    const int branch = w > s->level ? 1 : w < -s->level ? -1 : 0;
    return branch * s->branch < 0 ? 0 : branch;
}

/* Tells the step the piece of the branch. */
RBDI_PART void rbdi_act_rigid_law(const rbd_motor *m, rbdi_act_shaft *s, const rbd_actuators *a) {
    const rbd_real J = rbdi_act_rotor_inertia(m);
    s->s = s->t + J * (s->x / a->dt - s->bias);
    s->slope = s->braking + m->friction.viscous + J / a->dt;
    if (s->branch) {
        s->s = s->s - (rbd_real)s->branch * s->level;
    } else {
        const rbdi_act_stiction sticks = rbdi_act_sticks(m, s, a);
        s->s = s->s - sticks.offset;
        s->slope = s->slope + sticks.slope;
    }
}

/* What a spring does: the impulse on the joint, its slope by -x_m, the rotor's speed. */
typedef struct rbdi_act_spring {
    rbd_real p, slope, y;
} rbdi_act_spring;

/* The spring where the rotor's speed would be r + x_m without it, and falls by e for each unit of p. */
RBDI_PART rbd_real rbdi_act_mesh(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real r, rbd_real e,
                                 rbd_real dt) {
    const rbd_real delta = s->angle - s->g;
    const rbd_real half = m->backlash / 2;
    const rbd_real K = dt * m->stiffness + m->damping;
    const rbd_real up = dt * (m->stiffness * (delta - half) + K * r) / (1 + dt * K * e);
    const rbd_real down = dt * (m->stiffness * (delta + half) + K * r) / (1 + dt * K * e);
    return up > 0 ? up : down < 0 ? down : rbdi_zero();
}

/* The spring's law at the speed x of the joint's side. */
RBDI_PART rbdi_act_spring rbdi_act_spring_at(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                             const rbd_actuators *a) {
    const rbd_real dt = a->dt, x_m = rbdi_act_mean(a, s, x), most = dt * s->level;
    const rbd_real J = rbdi_act_rotor_inertia(m), J_t = J + dt * (s->braking + m->friction.viscous);
    const rbd_real K = dt * m->stiffness + m->damping;
    const rbd_real given = J * s->speed + dt * s->t;
    rbdi_act_spring spring;

    spring.y = rbdi_zero();
    spring.slope = K;
    spring.p = rbdi_act_mesh(m, s, -x_m, rbdi_zero(), dt);
    if (rbdi_abs(spring.p - given) > most) {
        const rbd_real friction = spring.p > given ? most : -most;
        spring.slope = K / (1 + dt * K / J_t);
        spring.p = rbdi_act_mesh(m, s, (given + friction) / J_t - x_m, 1 / J_t, dt);
        spring.y = (given + friction - spring.p) / J_t;
    }
    if (!(rbdi_abs(spring.p) > 0)) spring.slope = rbdi_zero();
    return spring;
}

/* Its branch: the side of the play that touches, and the rotor's direction. */
RBDI_INLINE int rbdi_act_spring_branch(const rbdi_act_spring *spring) {
    return rbdi_act_sign(spring->p) + 3 * rbdi_act_sign(spring->y);
}

/* Tells the step the piece at the speed s->told. */
RBDI_PART void rbdi_act_elastic_law(const rbd_motor *m, rbdi_act_shaft *s, const rbd_actuators *a) {
    const rbdi_act_spring spring = rbdi_act_spring_at(m, s, s->told, a);
    s->branch = (int16_t)rbdi_act_spring_branch(&spring);
    s->slope = a->share * spring.slope;
    s->s = spring.p / a->dt + s->slope * s->told;
}

RBDI_INLINE void rbdi_act_tell(const rbd_motor *m, rbdi_act_shaft *s, const rbd_actuators *a) {
    if (m->stiffness > 0)
        rbdi_act_elastic_law(m, s, a);
    else
        rbdi_act_rigid_law(m, s, a);
}

/* Whether the shaft is on its branch at speed x. If not, takes the branch there, or half way. */
RBDI_PART int rbdi_act_stays(const rbd_motor *m, rbdi_act_shaft *s, rbd_real x, const rbd_actuators *a) {
    int branch, same;
    if (m->stiffness > 0) {
        const rbdi_act_spring spring = rbdi_act_spring_at(m, s, x, a);
        s->told = a->repeats > RBDI_ACTUATOR_SOFT ? (s->told + x) / 2 : x;
        return rbdi_act_spring_branch(&spring) == s->branch;
    }
    branch = rbdi_act_rigid_branch(m, s, x, a);
    same = branch == s->branch;
    s->branch = (int16_t)branch;
    return same;
}

/* The state of the shaft at the end of the step, where the joint's side has speed x. */
RBDI_PART void rbdi_act_end_shaft(const rbd_motor *m, rbdi_act_shaft *s, rbd_real x, const rbd_actuators *a) {
    if (m->stiffness > 0) {
        const rbdi_act_spring spring = rbdi_act_spring_at(m, s, x, a);
        s->joint = spring.p / a->dt;
        s->speed = spring.y;
        s->angle = s->angle + a->dt * spring.y;
    } else {
        const rbdi_act_stiction sticks = rbdi_act_sticks(m, s, a);
        s->joint = s->s - s->slope * x;
        s->speed = x;
        s->angle = s->g + a->dt * rbdi_act_mean(a, s, x);
        if (m->friction.bristle > 0)
            s->bristle = rbdi_act_clamp(sticks.offset + sticks.slope * x, -s->level, s->level);
    }
    s->motor = s->t - s->braking * s->speed;
    s->cogging = s->cogging - s->cogging_slope * s->speed;
    rbdi_act_heat(m, s, (s->motor - s->cogging) / rbdi_act_torque_constant(m), a->air, a->dt);
}

#endif
