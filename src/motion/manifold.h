#ifndef RBDI_MOTION_MANIFOLD_H
#define RBDI_MOTION_MANIFOLD_H
#include "api/manifold.h"
#include "model/joint_types.h"
#include "model/joints.h"

/* Interface: rbdi_difference_joint, rbdi_joint_motion, rbdi_joint_turns, rbdi_put_joint_motion,
   rbdi_step_joint */

/* ---- configuration manifold [manifold code] ---- */

/* Whether the joint of a body turns: rbdi_type_turns. */
RBDI_INLINE int rbdi_joint_turns(const rbdi_frame *u) { return rbdi_type_turns(u->type); }

/* The motion in body axes from the joint's components in v, which are a stride apart, and back. */
RBDI_LOCAL rbdi_motion rbdi_joint_motion(const rbdi_frame *u, const rbd_real *v, ptrdiff_t stride) {
    rbd_real array[6];
    for (int k = 0; k < 6; ++k) array[k] = rbdi_zero();
    for (int k = 0; k < u->nv; ++k) array[rbdi_first_axis(u->type) + k] = v[k * stride];
    return rbdi_load_motion(array, 1);
}

RBDI_LOCAL void rbdi_put_joint_motion(const rbdi_frame *u, rbdi_motion V, rbd_real *v, ptrdiff_t stride) {
    rbd_real array[6];
    rbdi_store_motion(array, 1, V);
    for (int k = 0; k < u->nv; ++k) v[k * stride] = array[rbdi_first_axis(u->type) + k];
}

/* The coordinates of the origin p: back from rbdi_joint_origin. */
RBDI_LOCAL void rbdi_put_origin(const rbdi_frame *u, rbdi_v3 p, rbd_real *q) {
    if (u->type == RBD_PLANAR) {
        q[0] = p.x;
        q[1] = p.y;
    }
    if (u->type == RBD_FLOATING) rbdi_store_vec(q, 1, p);
}

/* E of a joint of the description, compiled once. */
RBDI_PART rbdi_mat rbdi_attitude_of(const rbdi_frame *u, const rbd_real *q) {
    return rbdi_joint_attitude(u->type, q);
}

/* q_next of a joint that turns by e in its own axes, with its origin moved by the shift in the axes of q:
   p_next = p + E' shift, and the turn. */
RBDI_LOCAL void rbdi_turn_joint(const rbdi_frame *u, const rbd_real *q, rbdi_exp e, rbdi_v3 turn,
                                rbdi_v3 shift, rbd_real *q_next) {
    shift = rbdi_mul_t(rbdi_attitude_of(u, q), shift);
    rbdi_put_origin(u, rbdi_add(rbdi_joint_origin(u->type, q), shift), q_next);
    if (u->type == RBD_PLANAR)
        q_next[2] = q[2] + turn.z;
    else
        rbdi_quaternion_step(&q[u->nq - 4], e, turn, &q_next[u->nq - 4]);
}

/* q_next = q (+) d for one joint of the description: along a screw. */
RBDI_LOCAL void rbdi_step_joint(const rbdi_frame *u, const rbd_real *q, const rbd_real *d, rbd_real *q_next) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real c, s, cd, sd, next[2];
        rbdi_unit_cs(q, &c, &s);
        rbdi_sincos(d[0], &sd, &cd);
        next[0] = c * cd - s * sd;
        next[1] = s * cd + c * sd;
        rbdi_unit_cs(next, &q_next[0], &q_next[1]);
    } else if (rbdi_joint_turns(u)) {
        const rbdi_motion step = rbdi_joint_motion(u, d, 1);
        const rbdi_exp e = rbdi_exp_of(step.omega);
        rbdi_turn_joint(u, q, e, step.omega, rbdi_exp_shift(e, step.omega, step.v), q_next);
    } else {
        for (int k = 0; k < u->nv; ++k) q_next[k] = q[k] + d[k];
    }
}

/* The same angle in [-pi, pi], but unchanged, to the bit, if it is there already. */
RBDI_LOCAL rbd_real rbdi_within_half_turn(rbd_real angle) {
    const rbd_real pi2 = rbdi_set(RBDI_PI(rbd_const) * RBDI_PI(rbd_const));
    rbd_real c, s;
    rbdi_sincos(angle, &s, &c);
    return rbdi_select(rbdi_less(pi2, angle * angle), rbdi_signed_angle(s, c), angle);
}

/* d with q0 (+) d = q1, for one joint. */
RBDI_LOCAL void rbdi_difference_joint(const rbdi_frame *u, const rbd_real *q0, const rbd_real *q1,
                                      rbd_real *d) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real c, s, c1, s1;
        rbdi_unit_cs(q0, &c, &s);
        rbdi_unit_cs(q1, &c1, &s1);
        d[0] = rbdi_signed_angle(c * s1 - s * c1, c * c1 + s * s1);
    } else if (rbdi_joint_turns(u)) {
        const rbdi_v3 shift = rbdi_sub(rbdi_joint_origin(u->type, q1), rbdi_joint_origin(u->type, q0));
        rbdi_motion step;

        /* omega: the turn from q0 to q1; v: the shift of the screw that leads to E (p1 - p0) */
        step.omega = u->type == RBD_PLANAR
                         ? rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_within_half_turn(q1[2] - q0[2]))
                         : rbdi_quaternion_difference(&q0[u->nq - 4], &q1[u->nq - 4]);
        step.v = rbdi_mul(rbdi_attitude_of(u, q0), shift);
        step.v = rbdi_log_shift(rbdi_exp_of(step.omega), step.omega, step.v);
        rbdi_put_joint_motion(u, step, d, 1);
    } else {
        for (int k = 0; k < u->nv; ++k) d[k] = q1[k] - q0[k];
    }
}

/* 1 / |q| of a quaternion or (cos, sin) with this unit one of the same direction; 0 if q is shorter than
   1e-15. */
RBDI_LOCAL rbd_real rbdi_inverse_length(const rbd_real *q, const rbd_real *unit, int n) {
    rbdi_mask bad = rbdi_less(*q, *q);
    rbd_real length = rbdi_zero();
    for (int k = 0; k < n; ++k) length = length + q[k] * unit[k];
    return rbdi_reciprocal(length, RBD_C(1e-15), &bad);
}

/* rbd_rates_from_velocity of one joint. */
RBDI_LOCAL void rbdi_joint_rates(const rbdi_frame *u, const rbd_real *q, const rbd_real *v, rbd_real *rates) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rates[0] = -(q[1] * v[0]);
        rates[1] = q[0] * v[0];
    } else if (rbdi_joint_turns(u)) {
        const rbdi_motion V = rbdi_joint_motion(u, v, 1);
        rbd_real turn[4];

        /* dp/dt = E' v, d quaternion/dt = quaternion (omega/2, 0) */
        rbdi_put_origin(u, rbdi_mul_t(rbdi_attitude_of(u, q), V.v), rates);
        rbdi_store_vec(turn, 1, rbdi_scale(rbdi_set(RBD_C(0.5)), V.omega));
        turn[3] = rbdi_zero();
        if (u->type == RBD_PLANAR)
            rates[2] = V.omega.z;
        else
            rbdi_quaternion_product(&q[u->nq - 4], turn, &rates[u->nq - 4]);
    } else {
        for (int k = 0; k < u->nv; ++k) rates[k] = v[k];
    }
}

/* Angular velocity from a quaternion of any length and its rates. */
RBDI_LOCAL rbdi_v3 rbdi_quaternion_velocity(const rbd_real *q, const rbd_real *rates) {
    rbd_real unit[4], inverse;
    rbdi_unit_quaternion(q, unit);
    inverse = rbdi_inverse_length(q, unit, 4);
    for (int k = 0; k < 3; ++k) unit[k] = -unit[k];
    rbdi_quaternion_product(unit, rates, unit);
    return rbdi_scale(inverse + inverse, rbdi_load_vec(unit, 1));
}

/* rbd_velocity_from_rates of one joint. */
RBDI_LOCAL void rbdi_joint_velocity(const rbdi_frame *u, const rbd_real *q, const rbd_real *rates,
                                    rbd_real *v) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real unit[2];
        rbdi_unit_cs(q, &unit[0], &unit[1]);
        v[0] = (unit[0] * rates[1] - unit[1] * rates[0]) * rbdi_inverse_length(q, unit, 2);
    } else if (rbdi_joint_turns(u)) {
        rbdi_motion V;
        V.v = rbdi_mul(rbdi_attitude_of(u, q), rbdi_joint_origin(u->type, rates));
        V.omega = u->type == RBD_PLANAR ? rbdi_vec(rbdi_zero(), rbdi_zero(), rates[2])
                                        : rbdi_quaternion_velocity(&q[u->nq - 4], &rates[u->nq - 4]);
        rbdi_put_joint_motion(u, V, v, 1);
    } else {
        for (int k = 0; k < u->nv; ++k) v[k] = rates[k];
    }
}

RBDI_API rbd_status rbd_rates_from_velocity(const rbd_model *m, const rbd_real *q, const rbd_real *v,
                                            rbd_real *rates) {
    if (!m || !q || !v || !rates) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_joint_rates(u, &q[u->iq], &v[u->iv], &rates[u->iq]);
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_velocity_from_rates(const rbd_model *m, const rbd_real *q, const rbd_real *rates,
                                            rbd_real *v) {
    if (!m || !q || !rates || !v) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_joint_velocity(u, &q[u->iq], &rates[u->iq], &v[u->iv]);
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_integrate(const rbd_model *m, const rbd_real *q, const rbd_real *v, rbd_real dt,
                                  rbd_real *q_next) {
    if (!m || !q || !v || !q_next) return RBD_ERR_NULL;

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real d[6];
        for (int k = 0; k < u->nv; ++k) d[k] = v[u->iv + k] * dt;
        if (u->nv > 0) rbdi_step_joint(u, &q[u->iq], d, &q_next[u->iq]);
    }

    return RBD_OK;
}

RBDI_API rbd_status rbd_difference(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real *d) {
    if (!m || !q0 || !q1 || !d) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_difference_joint(u, &q0[u->iq], &q1[u->iq], &d[u->iv]);
    }
    return RBD_OK;
}

/* q = q0 (+) s (q1 (-) q0) for one joint. At s = 1 it is q1 (+) 0, without rounding of the difference. */
RBDI_LOCAL void rbdi_interpolate_joint(const rbdi_frame *u, const rbd_real *q0, const rbd_real *q1,
                                       rbd_real s, rbd_real *q) {
    const rbd_real one = rbdi_set(RBD_C(1));
    const rbdi_mask within = rbdi_or(rbdi_less(s, one), rbdi_less(one, s)); /* neither of NaN */
    const rbd_real share = rbdi_select(within, s, s - one);
    rbd_real from[7], d[6];

    rbdi_difference_joint(u, q0, q1, d);
    for (int k = 0; k < u->nv; ++k) d[k] = d[k] * share;
    for (int k = 0; k < u->nq; ++k) from[k] = rbdi_select(within, q0[k], q1[k]);

    rbdi_step_joint(u, from, d, q);
}

RBDI_API rbd_status rbd_interpolate(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real s,
                                    rbd_real *q) {
    if (!m || !q0 || !q1 || !q) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_interpolate_joint(u, &q0[u->iq], &q1[u->iq], s, &q[u->iq]);
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_distance(const rbd_model *m, const rbd_real *q0, const rbd_real *q1,
                                 const rbd_const *weight, rbd_real *distance) {
    rbd_real sum = rbdi_zero();
    if (!m || !q0 || !q1 || !distance) return RBD_ERR_NULL;

    for (int k = 0; weight && k < m->nv; ++k)
        if (!(weight[k] >= 0)) return RBD_ERR_RANGE;

    /* the sum of weight_k d_k^2 */
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real d[6];
        if (u->nv > 0) rbdi_difference_joint(u, &q0[u->iq], &q1[u->iq], d);
        for (int k = 0; k < u->nv; ++k) sum = sum + d[k] * d[k] * (weight ? weight[u->iv + k] : RBD_C(1));
    }

    *distance = rbdi_sqrt(sum);
    return RBD_OK;
}

/* The zero of one joint, whose q is 0 before. */
RBDI_LOCAL void rbdi_neutral_joint(const rbdi_frame *u, rbd_real *q) {
    if (u->type == RBD_CONTINUOUS_CS) q[0] = rbdi_set(RBD_C(1));
    if (rbdi_has_quaternion(u->type)) q[u->nq - 1] = rbdi_set(RBD_C(1));
}

RBDI_API rbd_status rbd_neutral(const rbd_model *m, rbd_real *q) {
    if (!m || !q) return RBD_ERR_NULL;
    for (int k = 0; k < m->nq; ++k) q[k] = rbdi_zero();
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_neutral_joint(u, &q[u->iq]);
    }
    return RBD_OK;
}

/* A number uniform in [0, 1), with 24 bits, which every scalar has, by splitmix64 (Steele, Lea and Flood
   2014). */
RBDI_LOCAL rbd_const rbdi_uniform(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (rbd_const)(int32_t)(z >> 40) * RBD_C(5.9604644775390625e-8);
}

/* A number uniform between two bounds; each lane draws its own. */
RBDI_COLD rbd_real rbdi_draw(uint64_t *seed, rbd_const lower, rbd_const upper) {
#ifdef RBD_LANES
    rbd_real x = rbdi_zero();

    for (int i = 0; i < RBD_LANES; ++i) {
        const rbd_const share = rbdi_uniform(seed);
        x[i] = lower * (1 - share) + upper * share;
    }

    return x;
#else
    const rbd_const share = rbdi_uniform(seed);

    return rbdi_set(lower * (1 - share) + upper * share);
#endif
}

/* A uniform orientation: two points on circles with radii sqrt(x), sqrt(1 - x), x uniform (Shoemake 1992). */
RBDI_COLD void rbdi_draw_quaternion(uint64_t *seed, rbd_real *q) {
    rbd_real x = rbdi_draw(seed, RBD_C(0), RBD_C(1)), radius = rbdi_sqrt(x), c, s;

    rbdi_sincos(rbdi_draw(seed, -RBDI_PI(rbd_const), RBDI_PI(rbd_const)), &s, &c);
    q[0] = radius * s;
    q[1] = radius * c;
    radius = rbdi_sqrt(rbdi_set(RBD_C(1)) - x);
    rbdi_sincos(rbdi_draw(seed, -RBDI_PI(rbd_const), RBDI_PI(rbd_const)), &s, &c);
    q[2] = radius * s;
    q[3] = radius * c;
}

/* Random coordinates of one joint: within its limits, or angles in [-pi, pi), lengths in [-1, 1) and uniform
   orientations. */
RBDI_COLD void rbdi_random_joint(const rbdi_frame *u, uint64_t *seed, rbd_real *q) {
    const rbd_const pi = RBDI_PI(rbd_const), one = RBD_C(1);
    const int numbers = u->nq - (rbdi_has_quaternion(u->type) ? 4 : 0);
    if (u->nv == 1 && u->lower < u->upper) {
        q[0] = rbdi_draw(seed, u->lower, u->upper);
        return;
    }

    for (int k = 0; k < numbers && k < u->nv; ++k)
        q[k] = rbdi_is_length(u->type, k) ? rbdi_draw(seed, -one, one) : rbdi_draw(seed, -pi, pi);

    if (u->type == RBD_CONTINUOUS_CS) {
        const rbd_real angle = q[0];
        rbdi_sincos(angle, &q[1], &q[0]);
    }
    if (rbdi_has_quaternion(u->type)) rbdi_draw_quaternion(seed, q + u->nq - 4);
}

RBDI_API rbd_status rbd_random(const rbd_model *m, uint64_t *seed, rbd_real *q) {
    if (!m || !seed || !q) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->nv > 0) rbdi_random_joint(u, seed, &q[u->iq]);
    }
    return RBD_OK;
}

#endif
