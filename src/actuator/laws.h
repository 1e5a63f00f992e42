#ifndef RBDI_ACTUATOR_LAWS_H
#define RBDI_ACTUATOR_LAWS_H
#include "actuator/motor.h"

/* ---- laws [laws of shafts] ----
   A rigid shaft, whose rotor turns with the joint. At the end's speed x it gives the torque

       t - (braking + viscous) x - J ((x - x_0) / dt + bias) - w,   w = clamp(b + dt k x, -F, F)

   with the motor's torque t, the level F, a bristle of stiffness k that now has the torque b. Without a
   bristle w = clamp(F x / creep, -F, F): what sticks creeps, at most by RBDI_ACTUATOR_CREEP.

   A shaft with a spring, whose rotor has an angle and a speed y of its own. With delta = angle - g, play 2 h,
   K = dt k + d, r = y - x the joint gets the impulse

       p = max(0, dt k (delta - h) + dt K r) + min(0, dt k (delta + h) + dt K r)
       J (y - y_0) = dt (t - (braking + viscous) y) - p + p_f,   p_f = -dt F sign(y), or less at y = 0

   Both are solved exactly: first with y = 0; if friction cannot hold the rotor so, with p_f = +-dt F. */

/* Torque of dry friction by speed where it does not slide. */
RBDI_INLINE rbd_real rbdi_act_stiction(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real dt) {
    return m->friction.bristle > 0 ? dt * m->friction.bristle : s->level / RBDI_ACTUATOR_CREEP;
}

/* The branch of the friction of a rigid shaft at speed x: 1 or -1 where it slides. */
RBDI_PART int rbdi_act_rigid_branch(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x, rbd_real dt) {
    const rbd_real w = s->bristle + rbdi_act_stiction(m, s, dt) * x;
    const int branch = w > s->level ? 1 : w < -s->level ? -1 : 0;
    return branch * s->branch < 0 ? 0 : branch;
}

/* Tells the step the piece of the branch. */
RBDI_PART void rbdi_act_rigid_law(const rbd_motor *m, rbdi_act_shaft *s, rbd_real dt) {
    const rbd_real J = rbdi_act_rotor_inertia(m);
    s->s = s->t + J * (s->x / dt - s->bias);
    s->slope = s->braking + m->friction.viscous + J / dt;
    if (s->branch) {
        s->s = s->s - (rbd_real)s->branch * s->level;
    } else {
        s->s = s->s - s->bristle;
        s->slope = s->slope + rbdi_act_stiction(m, s, dt);
    }
}

/* What a spring does: the impulse on the joint, its slope by -x, the rotor's speed. */
typedef struct rbdi_act_spring {
    rbd_real p, slope, y;
} rbdi_act_spring;

/* The spring where the rotor's speed would be r + x without it, and falls by e for each unit of p. */
RBDI_PART rbd_real rbdi_act_mesh(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real r, rbd_real e,
                                 rbd_real dt) {
    const rbd_real delta = s->angle - s->g, half = m->backlash / 2, K = dt * m->stiffness + m->damping;
    const rbd_real up = dt * (m->stiffness * (delta - half) + K * r) / (1 + dt * K * e);
    const rbd_real down = dt * (m->stiffness * (delta + half) + K * r) / (1 + dt * K * e);
    return up > 0 ? up : down < 0 ? down : rbdi_zero();
}

/* The spring's law at joint speed x. */
RBDI_PART rbdi_act_spring rbdi_act_spring_at(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                             rbd_real dt) {
    const rbd_real J = rbdi_act_rotor_inertia(m), J_t = J + dt * (s->braking + m->friction.viscous);
    const rbd_real K = dt * m->stiffness + m->damping, given = J * s->speed + dt * s->t;
    rbdi_act_spring spring;
    rbd_real friction, most = dt * s->level;

    spring.y = rbdi_zero();
    spring.slope = K;
    spring.p = rbdi_act_mesh(m, s, -x, rbdi_zero(), dt);
    if (rbdi_abs(spring.p - given) > most) {
        friction = spring.p > given ? most : -most;
        spring.slope = K / (1 + dt * K / J_t);
        spring.p = rbdi_act_mesh(m, s, (given + friction) / J_t - x, 1 / J_t, dt);
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
RBDI_PART void rbdi_act_elastic_law(const rbd_motor *m, rbdi_act_shaft *s, rbd_real dt) {
    const rbdi_act_spring spring = rbdi_act_spring_at(m, s, s->told, dt);
    s->branch = (int16_t)rbdi_act_spring_branch(&spring);
    s->slope = spring.slope;
    s->s = spring.p / dt + spring.slope * s->told;
}

/* ---- what a step is told, and what it answers ---- */

RBDI_INLINE void rbdi_act_tell(const rbd_motor *m, rbdi_act_shaft *s, rbd_real dt) {
    if (m->stiffness > 0)
        rbdi_act_elastic_law(m, s, dt);
    else
        rbdi_act_rigid_law(m, s, dt);
}

/* Whether the shaft is on its branch at speed x. If not, takes the branch there, or half way. */
RBDI_PART int rbdi_act_stays(const rbd_motor *m, rbdi_act_shaft *s, rbd_real x, int repeats, rbd_real dt) {
    if (m->stiffness > 0) {
        const rbdi_act_spring spring = rbdi_act_spring_at(m, s, x, dt);
        s->told = repeats > RBDI_ACTUATOR_SOFT ? (s->told + x) / 2 : x;
        return rbdi_act_spring_branch(&spring) == s->branch;
    }
    if (s->level > 0 || m->friction.bristle > 0) {
        const int branch = rbdi_act_rigid_branch(m, s, x, dt), same = branch == s->branch;
        s->branch = (int16_t)branch;
        return same;
    }
    return 1;
}

/* The state of the shaft at the end of the step, where the joint's side has speed x. */
RBDI_PART void rbdi_act_end_shaft(const rbd_motor *m, rbdi_act_shaft *s, rbd_real x, rbd_real air,
                                  rbd_real dt) {
    rbd_real current;
    if (m->stiffness > 0) {
        const rbdi_act_spring spring = rbdi_act_spring_at(m, s, x, dt);
        s->joint = spring.p / dt;
        s->speed = spring.y;
        s->angle = s->angle + dt * spring.y;
    } else {
        const rbd_real w = s->bristle + rbdi_act_stiction(m, s, dt) * x;
        s->joint = s->s - s->slope * x;
        s->speed = x;
        s->angle = s->g + dt * x;
        if (m->friction.bristle > 0) s->bristle = rbdi_act_clamp(w, -s->level, s->level);
    }
    s->motor = s->t - s->braking * s->speed;
    current = (s->motor - s->cogging) / rbdi_act_torque_constant(m);
    rbdi_act_heat(m, s, current, air, dt);
}

#endif
