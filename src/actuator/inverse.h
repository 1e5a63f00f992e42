#ifndef RBDI_ACTUATOR_INVERSE_H
#define RBDI_ACTUATOR_INVERSE_H
#include "actuator/motor.h"
#include "actuator/transmission.h"

/* ---- inverse [inverse code] ---- */

/* What the joints ask of a shaft. side: direction of its friction, -1 to 1. */
typedef struct rbdi_act_wanted {
    rbd_real torque, speed, acceleration, side;
} rbdi_act_wanted;

/* Newton's method for u = base + side F(u, -t), F the level at rest share S. It is linear in pieces but for
   the squares: two steps do as a rule, and each further one passes a bend of the level, of which there are
   fewer than eight. Writes the slopes by t, base and so on. */
RBDI_PART rbd_real rbdi_act_carry_load(const rbd_gear_friction *f, rbd_real S, const rbdi_act_wanted *want,
                                       rbd_real base, rbd_real *slope, rbd_real *by_torque) {
    const rbd_real t = want->torque, one = rbdi_set(RBD_C(1));
    rbd_real u = base;
    *slope = one;
    *by_torque = one;
    for (int k = 0; k < 8; ++k) {
        const rbd_real error = u - base - want->side * rbdi_act_level(f, S, u, -t);
        const rbd_real moving = (rbd_real)rbdi_act_sign(f->load_joint * t + f->load_motor * u);
        const rbd_real resting = S * (rbd_real)rbdi_act_sign(f->rest_joint * t + f->rest_motor * u);
        const int driven = t * u > 0 && rbdi_abs(u) < rbdi_abs(t);
        const int drives = t * u > 0 && rbdi_abs(u) > rbdi_abs(t);
        const rbd_real of_u = moving * f->load_motor + resting * f->rest_motor +
                              (driven ? 2 * S * f->square_motor * u : rbdi_zero());
        const rbd_real of_t = moving * f->load_joint + resting * f->rest_joint +
                              (drives ? 2 * S * f->square_joint * t : rbdi_zero());

        *slope = one - want->side * of_u;
        if (*slope < RBDI_ACTUATOR_SLOPE) *slope = rbdi_set(RBDI_ACTUATOR_SLOPE);
        *by_torque = one + want->side * of_t;
        if (!(rbdi_abs(error) > 4 * RBDI_EPS * (rbdi_abs(u) + rbdi_abs(base)))) break;
        u = u - error / *slope;
    }
    return u;
}

/* How far the motor's side of a spring is ahead of the joint's where it gives torque t: it is beyond half of
   the play. */
RBDI_PART rbd_real rbdi_act_winding_of(const rbd_motor *m, rbd_real t) {
    if (!(m->stiffness > 0)) return rbdi_zero();
    return t / m->stiffness + (rbd_real)rbdi_act_sign(t) * (m->backlash / 2);
}

/* One shaft: u = t + J x' + viscous x + side F - cogging, within the limits. */
RBDI_ONCE void rbdi_act_invert_shaft(const rbd_motor *m, const rbdi_act_shaft *s, const rbdi_act_wanted *want,
                                     rbd_real air, rbd_drive *drive) {
    const rbd_gear_friction *f = &m->friction;
    const rbd_real constant = rbdi_act_torque_constant(m), J = rbdi_act_rotor_inertia(m),
                   winding = s->winding + air;
    rbd_real u = want->torque + J * want->acceleration + f->viscous * want->speed;
    rbd_real slope = rbdi_set(RBD_C(1)), by_torque = slope, current, lower, upper;

    if (f->load_motor > 0 || f->load_joint > 0 || rbdi_act_has_rest(f)) {
        const rbd_real S = rbdi_act_rest_share(f, want->speed);
        u = rbdi_act_carry_load(f, S, want, u, &slope, &by_torque);
    } else {
        u = u + want->side * f->coulomb;
    }
    drive->by_torque = by_torque / slope;
    drive->by_speed = f->viscous / slope;
    drive->by_acceleration = J / slope;
    drive->angle = s->phi + rbdi_act_winding_of(m, want->torque);

    if (m->cogging > 0) u = u - rbdi_act_cogging(m, drive->angle);
    current = u / constant;
    rbdi_act_current_range(m, winding, want->speed, &lower, &upper);
    drive->saturated = 0;
    if (current > upper) {
        drive->saturated = constant > 0 ? 1 : -1;
        current = upper;
    }
    if (current < lower) {
        drive->saturated = constant > 0 ? -1 : 1;
        current = lower;
    }
    drive->current = current;
    drive->torque = drive->saturated ? current * constant : u;
    drive->voltage = rbdi_act_resistance(m, winding) * current + constant * want->speed;
}

/* The direction of friction at a planned speed. */
RBDI_INLINE rbd_real rbdi_act_side(const rbd_gear_friction *f, rbd_real x) {
    if (!(f->still > 0)) return (rbd_real)rbdi_act_sign(x);
    return rbdi_act_clamp(x / f->still, rbdi_set(RBD_C(-1)), rbdi_set(RBD_C(1)));
}

/* Of the shaft in the mapped state, where the joints ask for this torque and acceleration. */
RBDI_LOCAL void rbdi_act_invert_at(const rbd_actuators *a, int i, rbd_real torque, rbd_real acceleration,
                                   rbd_drive *drives) {
    const rbdi_act_shaft *s = &a->shaft[i];
    rbdi_act_wanted want;
    want.torque = torque;
    want.speed = s->x;
    want.acceleration = acceleration;
    want.side = rbdi_act_side(&a->motor[i].friction, s->x);
    rbdi_act_invert_shaft(&a->motor[i], s, &want, a->air, &drives[i]);
}

/* The shafts of a transmission: t = G^-T tau, x' = G v' + bias. */
RBDI_LOCAL void rbdi_act_invert_group(const rbd_actuators *a, const rbdi_act_group *g, const rbd_real *acc,
                                      const rbd_real *tau, rbd_drive *drives) {
    for (int i = 0; i < g->n; ++i) {
        const rbd_real acceleration = a->shaft[g->first + i].bias + rbdi_act_shaft_speed(g, i, acc);
        rbd_real torque = rbdi_zero();
        for (int j = 0; j < g->n; ++j) torque = torque + g->inverse[g->n * j + i] * tau[g->dof[j]];
        rbdi_act_invert_at(a, g->first + i, torque, acceleration, drives);
    }
}

RBDI_API rbd_status rbd_actuators_inverse(rbd_actuators *a, const rbd_real *q, const rbd_real *v,
                                          const rbd_real *acc, const rbd_real *tau, rbd_drive *drives) {
    rbd_status status;
    if (!a || !q || !v || !acc || !tau || !drives) return RBD_ERR_NULL;
    if (a->begun) return RBD_ERR_ORDER;
    status = rbdi_act_map(a, q, v);
    if (status) return status;
    if (!rbdi_act_all_moderate(acc, a->nv) || !rbdi_act_all_moderate(tau, a->nv)) return RBD_ERR_NAN;

    for (int i = 0; i < a->n; ++i) {
        const int dof = a->shaft[i].dof;
        if (dof >= 0) rbdi_act_invert_at(a, i, tau[dof], acc[dof], drives);
    }
    for (int i = 0; i < a->groups; ++i) rbdi_act_invert_group(a, &a->group[i], acc, tau, drives);
    return RBD_OK;
}

#endif
