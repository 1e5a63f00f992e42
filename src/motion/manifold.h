#ifndef RBDI_MOTION_MANIFOLD_H
#define RBDI_MOTION_MANIFOLD_H
#include "api/manifold.h"
#include "model/joints.h"

/* Interface: rbdi_difference_joint, rbdi_glide, rbdi_joint_motion, rbdi_joint_turns, rbdi_move_straight,
   rbdi_put_joint_motion, rbdi_turn_back, rbdi_turn_velocity */

/* ---- configuration manifold [manifold code] ---- */

/* Spherical, planar and floating joints turn: their velocity is a motion in body axes, of which v has one
   component, three or all, and their step is an exponential. The coordinates of other joints just add. */
RBDI_INLINE int rbdi_joint_turns(const rbdi_frame *u) {
    return u->type == RBD_SPHERICAL || u->type == RBD_PLANAR || u->type == RBD_FLOATING;
}
/* The motion from its components, which are `stride` apart, and back. */
static rbdi_motion rbdi_joint_motion(const rbdi_frame *u, const rbd_real *x, ptrdiff_t stride) {
    rbd_real a[6];
    for (int k = 0; k < 6; ++k) a[k] = rbdi_zero();
    for (int k = 0; k < u->nv; ++k) a[(u->type == RBD_PLANAR ? 2 : 0) + k] = x[k * stride];
    return rbdi_load_motion(a, 1);
}
static void rbdi_put_joint_motion(const rbdi_frame *u, rbdi_motion V, rbd_real *x, ptrdiff_t stride) {
    rbd_real a[6];
    rbdi_store_motion(a, 1, V);
    for (int k = 0; k < u->nv; ++k) x[k * stride] = a[(u->type == RBD_PLANAR ? 2 : 0) + k];
}
/* From rbdi_joint_origin back to the coordinates. */
static void rbdi_put_origin(const rbdi_frame *u, rbdi_v3 x, rbd_real *q) {
    if (u->type == RBD_PLANAR) q[0] = x.x, q[1] = x.y;
    if (u->type == RBD_FLOATING) rbdi_store_vec(q, 1, x);
}

/* q_next = q (+) d for one joint of the description; straight: the origin moves by the linear part of d, in
   the axes of the beginning, not along a screw. */
static void rbdi_step_joint(const rbdi_frame *u, const rbd_real *q, const rbd_real *d, int straight,
                            rbd_real *q_next) {
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
        rbdi_v3 x = straight ? step.v : rbdi_exp_shift(e, step.omega, step.v);
        x = rbdi_mul_t(rbdi_joint_attitude(u->type, q), x);
        rbdi_put_origin(u, rbdi_add(rbdi_joint_origin(u->type, q), x), q_next);
        if (u->type == RBD_PLANAR)
            q_next[2] = q[2] + step.omega.z;
        else
            rbdi_quaternion_step(&q[u->nq - 4], e, step.omega, &q_next[u->nq - 4]);
    } else {
        for (int k = 0; k < u->nv; ++k) q_next[k] = q[k] + d[k];
    }
}

/* The step of rbd_step in three parts, of one joint. First v after dt without a, in the axes of the
   beginning: linear velocities in body axes gain dt omega x v, the others stay. */
static void rbdi_glide(const rbdi_frame *u, const rbd_real *v, rbd_real dt, rbd_real *nu) {
    rbdi_motion V;
    for (int k = 0; k < u->nv; ++k) nu[k] = v[k];
    if (!rbdi_joint_turns(u)) return;
    V = rbdi_joint_motion(u, v, 1);
    V.v = rbdi_add(V.v, rbdi_scale(dt, rbdi_cross(V.omega, V.v)));
    rbdi_put_joint_motion(u, V, nu, 1);
}

/* q moved by nu dt, whose axes stay: origins of floating and planar joints move straight. */
static void rbdi_move_straight(const rbdi_frame *u, const rbd_real *q, const rbd_real *nu, rbd_real dt,
                               rbd_real *q_next) {
    rbd_real d[6];
    for (int k = 0; k < u->nv; ++k) d[k] = nu[k] * dt;
    rbdi_step_joint(u, q, d, 1, q_next);
}

/* x turned by -turn: x - A turn x x + B turn x (turn x x). */
static rbdi_v3 rbdi_turn_back(rbdi_exp e, rbdi_v3 turn, rbdi_v3 x) {
    const rbdi_v3 across = rbdi_cross(turn, x);
    const rbdi_v3 inward = rbdi_cross(turn, across);
    x = rbdi_sub(x, rbdi_scale((e.half_sine + e.half_sine) * e.half_cosine, across));
    return rbdi_add(x, rbdi_scale(e.B, inward));
}

/* nu in the axes of the end, which have turned by those of moved dt. v_next may be nu. */
static void rbdi_turn_velocity(const rbdi_frame *u, const rbd_real *moved, rbd_real dt, const rbd_real *nu,
                               rbd_real *v_next) {
    rbdi_motion V;
    rbdi_v3 turn;
    rbdi_exp e;
    if (!rbdi_joint_turns(u)) {
        for (int k = 0; k < u->nv; ++k) v_next[k] = nu[k];
        return;
    }
    turn = rbdi_scale(dt, rbdi_joint_motion(u, moved, 1).omega);
    e = rbdi_exp_of(turn);
    V = rbdi_joint_motion(u, nu, 1);
    V.omega = rbdi_turn_back(e, turn, V.omega), V.v = rbdi_turn_back(e, turn, V.v);
    rbdi_put_joint_motion(u, V, v_next, 1);
}

/* An angle beyond a half turn becomes the equal one within. */
static rbd_real rbdi_within_half_turn(rbd_real angle) {
    const rbd_real pi2 = rbdi_set(RBDI_PI(rbd_const) * RBDI_PI(rbd_const));
    rbd_real c, s;
    rbdi_sincos(angle, &s, &c);
    return rbdi_select(rbdi_less(pi2, angle * angle), rbdi_signed_angle(s, c), angle);
}

static void rbdi_difference_joint(const rbdi_frame *u, const rbd_real *q0, const rbd_real *q1, rbd_real *d) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real c, s, c1, s1;
        rbdi_unit_cs(q0, &c, &s);
        rbdi_unit_cs(q1, &c1, &s1);
        d[0] = rbdi_signed_angle(c * s1 - s * c1, c * c1 + s * s1);
    } else if (rbdi_joint_turns(u)) {
        const rbdi_v3 x = rbdi_sub(rbdi_joint_origin(u->type, q1), rbdi_joint_origin(u->type, q0));
        rbdi_motion step;
        step.omega = u->type == RBD_PLANAR
                         ? rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_within_half_turn(q1[2] - q0[2]))
                         : rbdi_quaternion_difference(&q0[u->nq - 4], &q1[u->nq - 4]);
        step.v = rbdi_mul(rbdi_joint_attitude(u->type, q0), x);
        step.v = rbdi_log_shift(rbdi_exp_of(step.omega), step.omega, step.v);
        rbdi_put_joint_motion(u, step, d, 1);
    } else {
        for (int k = 0; k < u->nv; ++k) d[k] = q1[k] - q0[k];
    }
}

/* 1 / |q|, of unit quaternion or (cos, sin) u along q; 0 where q has no direction. */
static rbd_real rbdi_inverse_length(const rbd_real *q, const rbd_real *u, int n) {
    rbdi_mask bad = rbdi_less(*q, *q);
    rbd_real length = rbdi_zero();
    for (int k = 0; k < n; ++k) length = length + q[k] * u[k];
    return rbdi_reciprocal(length, RBD_C(1e-15), &bad);
}

static void rbdi_joint_rates(const rbdi_frame *u, const rbd_real *q, const rbd_real *v, rbd_real *rates) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rates[0] = -(q[1] * v[0]), rates[1] = q[0] * v[0];
    } else if (rbdi_joint_turns(u)) {
        const rbdi_motion V = rbdi_joint_motion(u, v, 1);
        rbd_real turn[4];
        rbdi_put_origin(u, rbdi_mul_t(rbdi_joint_attitude(u->type, q), V.v), rates);
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
static rbdi_v3 rbdi_quaternion_velocity(const rbd_real *q, const rbd_real *rates) {
    rbd_real x[4], k;
    rbdi_unit_quaternion(q, x);
    k = rbdi_inverse_length(q, x, 4);
    for (int i = 0; i < 3; ++i) x[i] = -x[i];
    rbdi_quaternion_product(x, rates, x);
    return rbdi_scale(k + k, rbdi_load_vec(x, 1));
}

static void rbdi_joint_velocity(const rbdi_frame *u, const rbd_real *q, const rbd_real *rates, rbd_real *v) {
    if (u->type == RBD_CONTINUOUS_CS) {
        rbd_real x[2];
        rbdi_unit_cs(q, &x[0], &x[1]);
        v[0] = (x[0] * rates[1] - x[1] * rates[0]) * rbdi_inverse_length(q, x, 2);
    } else if (rbdi_joint_turns(u)) {
        rbdi_motion V;
        V.v = rbdi_mul(rbdi_joint_attitude(u->type, q), rbdi_joint_origin(u->type, rates));
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
        if (u->nv > 0) rbdi_step_joint(u, &q[u->iq], d, 0, &q_next[u->iq]);
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_step(const rbd_model *m, const rbd_real *q, const rbd_real *v, const rbd_real *a,
                             rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    if (!m || !q || !v || !a || !q_next || !v_next) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real nu[6];
        if (u->nv == 0) continue;
        rbdi_glide(u, &v[u->iv], dt, nu);
        for (int k = 0; k < u->nv; ++k) nu[k] = nu[k] + dt * a[u->iv + k];
        rbdi_move_straight(u, &q[u->iq], nu, dt, &q_next[u->iq]);
        rbdi_turn_velocity(u, nu, dt, nu, &v_next[u->iv]);
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

RBDI_API rbd_status rbd_neutral(const rbd_model *m, rbd_real *q) {
    if (!m || !q) return RBD_ERR_NULL;
    for (int k = 0; k < m->nq; ++k) q[k] = rbdi_zero();
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->type == RBD_CONTINUOUS_CS) q[u->iq] = rbdi_set(RBD_C(1));
        if (u->type == RBD_SPHERICAL || u->type == RBD_FLOATING) q[u->iq + u->nq - 1] = rbdi_set(RBD_C(1));
    }
    return RBD_OK;
}

/* Uniform in [0, 1), 24 bits so that any scalar holds them, by splitmix64. */
static rbd_const rbdi_uniform(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (rbd_const)(int32_t)(z >> 40) * RBD_C(5.9604644775390625e-8);
}

/* Uniform between two bounds; each lane draws its own. */
static rbd_real rbdi_draw(uint64_t *seed, rbd_const lower, rbd_const upper) {
#ifdef RBD_LANES
    rbd_real x = rbdi_zero();
    for (int i = 0; i < RBD_LANES; ++i) {
        const rbd_const u = rbdi_uniform(seed);
        x[i] = lower * (1 - u) + upper * u;
    }
    return x;
#else
    const rbd_const u = rbdi_uniform(seed);
    return rbdi_set(lower * (1 - u) + upper * u);
#endif
}

/* Uniform orientation: two points on circles with radii sqrt(u), sqrt(1 - u) (Shoemake 1992). */
static void rbdi_draw_quaternion(uint64_t *seed, rbd_real *q) {
    rbd_real u = rbdi_draw(seed, RBD_C(0), RBD_C(1)), a, b, c, s;
    a = rbdi_sqrt(u);
    b = rbdi_sqrt(rbdi_set(RBD_C(1)) - u);
    rbdi_sincos(rbdi_draw(seed, -RBDI_PI(rbd_const), RBDI_PI(rbd_const)), &s, &c);
    q[0] = a * s, q[1] = a * c;
    rbdi_sincos(rbdi_draw(seed, -RBDI_PI(rbd_const), RBDI_PI(rbd_const)), &s, &c);
    q[2] = b * s, q[3] = b * c;
}

RBDI_API rbd_status rbd_random(const rbd_model *m, uint64_t *seed, rbd_real *q) {
    if (!m || !seed || !q) return RBD_ERR_NULL;
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real *x;
        const rbd_const pi = RBDI_PI(rbd_const), one = RBD_C(1);
        int angles = u->nv, shifts = 0; /* shifts come first, but with cylindrical joints */
        if (u->nv == 0) continue;
        x = &q[u->iq];
        if (u->nv == 1 && u->lower < u->upper && u->type != RBD_CONTINUOUS_CS) {
            x[0] = rbdi_draw(seed, u->lower, u->upper);
            continue;
        }
        if (u->type == RBD_PRISMATIC) shifts = 1;
        if (u->type == RBD_PLANAR) shifts = 2;
        if (u->type == RBD_TRANSLATION || u->type == RBD_FLOATING) shifts = angles = 3;
        if (u->type == RBD_SPHERICAL) angles = 0;
        for (int k = 0; k < angles; ++k)
            x[k] = k < shifts ? rbdi_draw(seed, -one, one) : rbdi_draw(seed, -pi, pi);
        if (u->type == RBD_CYLINDRICAL) x[1] = rbdi_draw(seed, -one, one);
        if (u->type == RBD_CONTINUOUS_CS) {
            rbd_real angle = x[0];
            rbdi_sincos(angle, &x[1], &x[0]);
        }
        if (u->type == RBD_SPHERICAL || u->type == RBD_FLOATING) rbdi_draw_quaternion(seed, x + u->nq - 4);
    }
    return RBD_OK;
}

#endif
