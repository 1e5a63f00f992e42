#ifndef RBDI_MOTION_MANIFOLD_H
#define RBDI_MOTION_MANIFOLD_H
#include "api/manifold.h"
#include "model/layout.h"
#include "algebra/rotations.h"

/* Interface: rbdi_difference_joint, rbdi_glide, rbdi_move_straight, rbdi_turn_back, rbdi_turn_velocity */

/* ---- configuration manifold [manifold code] ---- */

/* q_next = q (+) d for one joint of the description. */
static void rbdi_step_joint(const rbdi_frame *u, const rbd_real *q, const rbd_real *d, rbd_real *q_next) {
    rbdi_v3 x;
    switch (u->type) {
    case RBD_CONTINUOUS_CS: {
        rbd_real c, s, cd, sd, next[2];
        rbdi_unit_cs(q, &c, &s);
        rbdi_sincos(d[0], &sd, &cd);
        next[0] = c * cd - s * sd;
        next[1] = s * cd + c * sd;
        rbdi_unit_cs(next, &q_next[0], &q_next[1]);
        break;
    }
    case RBD_SPHERICAL:
        x = rbdi_load_vec(d, 1);
        rbdi_quaternion_step(q, rbdi_exp_of(x), x, q_next);
        break;
    case RBD_PLANAR: {
        rbd_real c, s;
        rbdi_v3 turn = rbdi_vec(rbdi_zero(), rbdi_zero(), d[0]);
        x = rbdi_exp_shift(rbdi_exp_of(turn), turn, rbdi_vec(d[1], d[2], rbdi_zero()));
        rbdi_sincos(q[2], &s, &c);
        q_next[0] = q[0] + (c * x.x - s * x.y);
        q_next[1] = q[1] + (s * x.x + c * x.y);
        q_next[2] = q[2] + d[0];
        break;
    }
    case RBD_FLOATING: {
        rbdi_v3 turn = rbdi_load_vec(d, 1);
        rbdi_exp e = rbdi_exp_of(turn);
        x = rbdi_exp_shift(e, turn, rbdi_load_vec(d + 3, 1));
        x = rbdi_mul_t(rbdi_quaternion_down(q + 3), x);
        rbdi_store_vec(q_next, 1, rbdi_add(rbdi_load_vec(q, 1), x));
        rbdi_quaternion_step(q + 3, e, turn, q_next + 3);
        break;
    }
    default:
        for (int k = 0; k < u->nv; ++k) q_next[k] = q[k] + d[k];
        break;
    }
}

/* The step of rbd_step in three parts, of one joint. First v after dt without a, in the axes of the
   beginning: linear velocities in body axes gain dt omega x v, the others stay. */
static void rbdi_glide(const rbdi_frame *u, const rbd_real *v, rbd_real dt, rbd_real *nu) {
    for (int k = 0; k < u->nv; ++k) nu[k] = v[k];
    if (u->type == RBD_FLOATING) {
        const rbdi_v3 linear = rbdi_load_vec(v + 3, 1);
        const rbdi_v3 gain = rbdi_cross(rbdi_load_vec(v, 1), linear);
        rbdi_store_vec(nu + 3, 1, rbdi_add(linear, rbdi_scale(dt, gain)));
    } else if (u->type == RBD_PLANAR) {
        nu[1] = v[1] - dt * v[0] * v[2], nu[2] = v[2] + dt * v[0] * v[1];
    }
}

/* q moved by nu dt, whose axes stay: origins of floating and planar joints move straight. */
static void rbdi_move_straight(const rbdi_frame *u, const rbd_real *q, const rbd_real *nu, rbd_real dt,
                               rbd_real *q_next) {
    rbd_real d[6], c, s, x, y;
    rbdi_v3 turn, shift;
    for (int k = 0; k < u->nv; ++k) d[k] = nu[k] * dt;
    if (u->type == RBD_FLOATING) {
        turn = rbdi_load_vec(d, 1);
        shift = rbdi_mul_t(rbdi_quaternion_down(q + 3), rbdi_load_vec(d + 3, 1));
        rbdi_store_vec(q_next, 1, rbdi_add(rbdi_load_vec(q, 1), shift));
        rbdi_quaternion_step(q + 3, rbdi_exp_of(turn), turn, q_next + 3);
    } else if (u->type == RBD_PLANAR) {
        rbdi_sincos(q[2], &s, &c);
        x = c * d[1] - s * d[2], y = s * d[1] + c * d[2];
        q_next[0] = q[0] + x, q_next[1] = q[1] + y, q_next[2] = q[2] + d[0];
    } else {
        rbdi_step_joint(u, q, d, q_next);
    }
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
    const int planar = u->type == RBD_PLANAR;
    rbdi_v3 turn, x;
    rbdi_exp e;
    if (planar || u->type == RBD_FLOATING || u->type == RBD_SPHERICAL) {
        turn = planar ? rbdi_vec(rbdi_zero(), rbdi_zero(), moved[0]) : rbdi_load_vec(moved, 1);
        turn = rbdi_scale(dt, turn);
        e = rbdi_exp_of(turn);
        for (int k = planar; k < u->nv; k += 3) {
            x = rbdi_vec(nu[k], nu[k + 1], planar ? rbdi_zero() : nu[k + 2]);
            x = rbdi_turn_back(e, turn, x);
            v_next[k] = x.x, v_next[k + 1] = x.y;
            if (!planar) v_next[k + 2] = x.z;
        }
        if (planar) v_next[0] = nu[0];
    } else {
        for (int k = 0; k < u->nv; ++k) v_next[k] = nu[k];
    }
}

static void rbdi_difference_joint(const rbdi_frame *u, const rbd_real *q0, const rbd_real *q1, rbd_real *d) {
    rbdi_v3 x, turn;
    rbd_real c, s;
    switch (u->type) {
    case RBD_CONTINUOUS_CS: {
        rbd_real c1, s1;
        rbdi_unit_cs(q0, &c, &s);
        rbdi_unit_cs(q1, &c1, &s1);
        d[0] = rbdi_signed_angle(c * s1 - s * c1, c * c1 + s * s1);
        break;
    }
    case RBD_SPHERICAL: rbdi_store_vec(d, 1, rbdi_quaternion_difference(q0, q1)); break;
    case RBD_PLANAR: {
        rbd_real angle = q1[2] - q0[2], pi2 = rbdi_set(RBDI_PI(rbd_const) * RBDI_PI(rbd_const));
        rbdi_sincos(angle, &s, &c);
        angle = rbdi_select(rbdi_less(pi2, angle * angle), rbdi_signed_angle(s, c), angle);
        rbdi_sincos(q0[2], &s, &c);
        turn = rbdi_vec(rbdi_zero(), rbdi_zero(), angle);
        x = rbdi_turn_z(0, c, s, rbdi_vec(q1[0] - q0[0], q1[1] - q0[1], rbdi_zero()));
        x = rbdi_log_shift(rbdi_exp_of(turn), turn, x);
        rbdi_store_vec(d, 1, rbdi_vec(angle, x.x, x.y));
        break;
    }
    case RBD_FLOATING:
        turn = rbdi_quaternion_difference(q0 + 3, q1 + 3);
        x = rbdi_sub(rbdi_load_vec(q1, 1), rbdi_load_vec(q0, 1));
        x = rbdi_log_shift(rbdi_exp_of(turn), turn, rbdi_mul(rbdi_quaternion_down(q0 + 3), x));
        rbdi_store_vec(d, 1, turn);
        rbdi_store_vec(d + 3, 1, x);
        break;
    default:
        for (int k = 0; k < u->nv; ++k) d[k] = q1[k] - q0[k];
        break;
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
    const rbd_real half = rbdi_set(RBD_C(0.5));
    rbd_real c, s, turn[4];
    switch (u->type) {
    case RBD_CONTINUOUS_CS: rates[0] = -(q[1] * v[0]), rates[1] = q[0] * v[0]; break;
    case RBD_PLANAR:
        rbdi_sincos(q[2], &s, &c);
        rates[0] = c * v[1] - s * v[2], rates[1] = s * v[1] + c * v[2], rates[2] = v[0];
        break;
    case RBD_SPHERICAL:
    case RBD_FLOATING:
        rbdi_store_vec(turn, 1, rbdi_scale(half, rbdi_load_vec(v, 1)));
        turn[3] = rbdi_zero();
        rbdi_quaternion_product(&q[u->nq - 4], turn, &rates[u->nq - 4]);
        if (u->type == RBD_FLOATING) {
            const rbdi_mat E = rbdi_quaternion_down(q + 3);
            const rbdi_v3 linear = rbdi_load_vec(v + 3, 1);
            rbdi_store_vec(rates, 1, rbdi_mul_t(E, linear));
        }
        break;
    default:
        for (int k = 0; k < u->nv; ++k) rates[k] = v[k];
        break;
    }
}

static void rbdi_joint_velocity(const rbdi_frame *u, const rbd_real *q, const rbd_real *rates, rbd_real *v) {
    rbd_real x[4], k;
    switch (u->type) {
    case RBD_CONTINUOUS_CS:
        rbdi_unit_cs(q, &x[0], &x[1]);
        v[0] = (x[0] * rates[1] - x[1] * rates[0]) * rbdi_inverse_length(q, x, 2);
        break;
    case RBD_PLANAR:
        rbdi_sincos(q[2], &x[1], &x[0]);
        rbdi_store_vec(x, 1, rbdi_turn_z(0, x[0], x[1], rbdi_vec(rates[0], rates[1], rbdi_zero())));
        v[0] = rates[2], v[1] = x[0], v[2] = x[1];
        break;
    case RBD_SPHERICAL:
    case RBD_FLOATING:
        rbdi_unit_quaternion(&q[u->nq - 4], x);
        k = rbdi_inverse_length(&q[u->nq - 4], x, 4);
        for (int i = 0; i < 3; ++i) x[i] = -x[i];
        rbdi_quaternion_product(x, &rates[u->nq - 4], x);
        rbdi_store_vec(v, 1, rbdi_scale(k + k, rbdi_load_vec(x, 1)));
        if (u->type == RBD_FLOATING) {
            const rbdi_mat E = rbdi_quaternion_down(q + 3);
            const rbdi_v3 linear = rbdi_load_vec(rates, 1);
            rbdi_store_vec(v + 3, 1, rbdi_mul(E, linear));
        }
        break;
    default:
        for (int i = 0; i < u->nv; ++i) v[i] = rates[i];
        break;
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
