#ifndef RBDI_ACTUATOR_FRICTION_H
#define RBDI_ACTUATOR_FRICTION_H
#include "actuator/layout.h"
#include "actuator/exponential.h"

/* ---- friction [friction code] ---- */

RBDI_INLINE rbd_real rbdi_act_clamp(rbd_real x, rbd_real lower, rbd_real upper) {
    return x < lower ? lower : x > upper ? upper : x;
}

/* -1, 0 or 1. */
RBDI_INLINE int rbdi_act_sign(rbd_real x) { return (x > 0) - (x < 0); }

/* Whether friction at rest differs from that of motion. */
RBDI_INLINE int rbdi_act_has_rest(const rbd_gear_friction *f) {
    return f->rest > 0 || f->rest_motor > 0 || f->rest_joint > 0 || f->square_motor > 0 ||
           f->square_joint > 0;
}

/* S = exp(-|x / speed|^power) = exp(-exp(power log |x / speed|)): the share of friction at rest. The
   logarithm takes 1e-30 to 1e30. Below, S is 1: with the least power, 0.1, it is 1e-3 off. Where the power
   of the ratio is above exp(5), S is below exp(-148), 0 in float and nothing beside 1. */
RBDI_PART rbd_real rbdi_act_rest_share(const rbd_gear_friction *f, rbd_real x) {
    rbd_real ratio;
    if (!rbdi_act_has_rest(f)) return rbdi_zero();
    ratio = rbdi_abs(x) / f->speed;
    if (!(ratio > RBD_C(1e-30))) return rbdi_set(RBD_C(1));
    if (ratio > RBD_C(1e30)) return rbdi_zero();
    ratio = f->power * rbdi_act_logarithm(ratio);
    return ratio > 5 ? rbdi_zero() : rbdi_act_exponential(-rbdi_act_exponential(ratio));
}

/* The level of rbd_gear_friction, where S is known. */
RBDI_PART rbd_real rbdi_act_level(const rbd_gear_friction *f, rbd_real S, rbd_real motor, rbd_real joint) {
    const rbd_real most = rbdi_set(RBDI_ACTUATOR_LARGEST);
    const rbd_real t_m = rbdi_act_clamp(motor, -most, most), t_x = rbdi_act_clamp(joint, -most, most);
    rbd_real level = f->coulomb + rbdi_abs(f->load_joint * t_x - f->load_motor * t_m);
    rbd_real rest;
    if (!(S > 0)) return level;

    rest = f->rest + rbdi_abs(f->rest_joint * t_x - f->rest_motor * t_m);
    if (rbdi_act_sign(t_x) != rbdi_act_sign(t_m)) {
        if (rbdi_abs(t_x) < rbdi_abs(t_m)) rest = rest + f->square_joint * t_x * t_x;
        if (rbdi_abs(t_x) > rbdi_abs(t_m)) rest = rest + f->square_motor * t_m * t_m;
    }
    level = level + S * rest;
    return level < most ? level : most;
}

RBDI_API rbd_real rbd_friction_level(const rbd_gear_friction *friction, rbd_real speed, rbd_real motor,
                                     rbd_real joint) {
    if (!friction) return rbdi_zero();
    return rbdi_act_level(friction, rbdi_act_rest_share(friction, speed), motor, joint);
}

#endif
