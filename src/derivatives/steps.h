#ifndef RBDI_DERIVATIVES_STEPS_H
#define RBDI_DERIVATIVES_STEPS_H
#include "base/memory.h"
#include "motion/step.h"
#include "api/derivatives.h"

/* Interface: rbdi_columns_before, rbdi_move_columns, rbdi_unforced_columns */

/* ---- derivatives of steps on the configuration manifold [steps code] ----
   Of spherical, planar and floating joints; the coordinates of others add up, so their derivatives are 1 and
   -1. For a step d = (w; u), with zeros where a joint has fewer than six dofs, and ad = ([w]x, 0; [u]x, [w]x)

       integrate     by q  exp(-ad)         by d   J_r = (1 - exp(-ad)) / ad
       difference    by q0 -J_r^-1(-d)      by q1  J_r^-1(d)

   ad is the dual number [w]x + eps [u]x: a function f(ad) has f([w]x) = 1 + k1 [w]x + k2 [w]x^2 on the
   diagonal and the derivative of f([w]x) along u below it. k1 and k2 are functions of x = w'w. With t_n = sum
   over k of (-x)^k / (n + 2k)!, where 2 dt_n/dx = n t_n+2 - t_n+1, they are

       exp(-ad)   k1 = -t_1, k2 = t_2
       J_r        k1 = -t_2, k2 = t_3
       J_r^-1     k1 = 1/2,  k2 = (t_3 - 2 t_4) / (2 t_2)

   Sola, Deray and Atchuthan (2018) for J_r; Barfoot, State Estimation for Robotics (2017), 7.1.5. */

/* f(ad): k1, k2 and their derivatives by x. */
typedef struct rbdi_ad_function {
    rbd_real k1, k2, dk1, dk2;
} rbdi_ad_function;

/* t_0 .. t_6 of a turn w: t_0 = cos, t_1 = sin / angle; from the series where x < 1, else
   t_n = (1 / (n - 2)! - t_n-2) / x. */
RBDI_LOCAL void rbdi_tails(rbdi_v3 w, rbd_real t[7]) {
    const rbdi_exp e = rbdi_exp_of(w);
    const rbd_real one = rbdi_set(RBD_C(1));
    const rbdi_mask near_zero = rbdi_less(e.x, one);
    const rbd_real x = rbdi_select(near_zero, e.x, rbdi_zero());

    t[0] = one - e.x * e.B;
    t[1] = (e.half_sine + e.half_sine) * e.half_cosine;
    t[2] = e.B;
    t[3] = e.C;

    for (int n = 4; n < 7; ++n) {
        const rbd_real inverse_factorial = rbdi_set(RBD_C(1) / (rbd_const)(n == 4 ? 2 : n == 5 ? 6 : 24));
        t[n] = rbdi_select(near_zero, rbdi_tail(x, n), (inverse_factorial - t[n - 2]) / e.x);
    }
}

/* dt_n/dx = (n t_n+2 - t_n+1) / 2. */
RBDI_INLINE rbd_real rbdi_tail_slope(const rbd_real t[7], int n) {
    return (t[n + 2] * (rbd_const)n - t[n + 1]) * RBD_C(0.5);
}

enum { RBDI_EXP_MINUS_AD, RBDI_J_R, RBDI_J_R_INVERSE };

/* k1 and k2 of the table above, and their derivatives. */
RBDI_LOCAL rbdi_ad_function rbdi_ad_function_of(int which, const rbd_real t[7]) {
    const int n = which == RBDI_EXP_MINUS_AD ? 1 : 2;
    rbdi_ad_function f;

    if (which == RBDI_J_R_INVERSE) {
        const rbd_real half = rbdi_set(RBD_C(0.5)), factor = half / t[2], slope = rbdi_tail_slope(t, 4);
        f.k1 = half;
        f.dk1 = rbdi_zero();
        f.k2 = (t[3] - (t[4] + t[4])) * factor;
        f.dk2 = (rbdi_tail_slope(t, 3) - (slope + slope) - (f.k2 + f.k2) * rbdi_tail_slope(t, 2)) * factor;
        return f;
    }

    f.k1 = -t[n];
    f.dk1 = -rbdi_tail_slope(t, n);
    f.k2 = t[n + 1];
    f.dk2 = rbdi_tail_slope(t, n + 1);
    return f;
}

/* J = scale f(ad) of the step d = (w; u):

       diagonal   1 + k1 [w]x + k2 [w]x^2                                     [w]x^2 = w w' - x
       below it   k1 [u]x + k2 (w u' + u w' - slope) + slope (dk1 [w]x + dk2 [w]x^2)

   with slope = 2 w'u, the derivative of x along u. */
RBDI_LOCAL void rbdi_fill_ad(rbdi_ad_function f, rbdi_motion d, rbd_real scale, rbd_real J[6][6]) {
    const rbd_real w[3] = {d.omega.x, d.omega.y, d.omega.z}, u[3] = {d.v.x, d.v.y, d.v.z};
    const rbd_real x = rbdi_dot(d.omega, d.omega), slope = rbdi_dot(d.omega, d.v) + rbdi_dot(d.omega, d.v);

    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int k = 3 - i - j, even = (j - i + 3) % 3 == 2; /* [w]x_ij = w_k, or -w_k */
            rbd_real turn = rbdi_zero(), shift = rbdi_zero(), ww = w[i] * w[j],
                     wu = w[i] * u[j] + u[i] * w[j];
            if (i == j) {
                ww = ww - x;
                wu = wu - slope;
            } else {
                turn = even ? w[k] : -w[k];
                shift = even ? u[k] : -u[k];
            }

            J[i][j] = f.k1 * turn + f.k2 * ww;
            if (i == j) J[i][j] = J[i][j] + rbdi_set(RBD_C(1));
            J[i][j] = J[3 + i][3 + j] = J[i][j] * scale;
            J[i][3 + j] = rbdi_zero();
            J[3 + i][j] = (f.k1 * shift + f.k2 * wu + slope * (f.dk1 * turn + f.dk2 * ww)) * scale;
        }
}

/* Writes scale f(ad) of the step sign d as a joint's block of a matrix that is 0. f = 1 for joints whose
   coordinates add up. */
RBDI_LOCAL void rbdi_put_step(const rbd_model *m, const rbdi_frame *body, int which, const rbd_real *d,
                              rbd_real sign, rbd_real scale, rbd_real *out) {
    const ptrdiff_t nv = m->nv;
    const int first = rbdi_first_axis(body->type);
    rbd_real t[7], J[6][6];
    rbdi_motion step;

    out += body->iv * nv + body->iv;
    if (!rbdi_joint_turns(body)) {
        for (int k = 0; k < body->nv; ++k) out[k * nv + k] = scale;
        return;
    }

    step = rbdi_joint_motion(body, d, 1);
    step.omega = rbdi_scale(sign, step.omega);
    step.v = rbdi_scale(sign, step.v);

    rbdi_tails(step.omega, t);
    rbdi_fill_ad(rbdi_ad_function_of(which, t), step, scale, J);
    for (int i = 0; i < body->nv; ++i)
        for (int j = 0; j < body->nv; ++j) out[i * nv + j] = J[first + i][first + j];
}

RBDI_API rbd_status rbd_integrate_derivatives(const rbd_model *m, const rbd_real *v, rbd_real dt,
                                              rbd_real *dnext_dq, rbd_real *dnext_dv) {
    const rbd_real one = rbdi_set(RBD_C(1));
    if (!m || !v) return RBD_ERR_NULL;

    if (dnext_dq) rbdi_clear(dnext_dq, m->nv * m->nv);
    if (dnext_dv) rbdi_clear(dnext_dv, m->nv * m->nv);

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];
        const rbd_real *d = body->nv > 0 ? &v[body->iv] : v;
        if (dnext_dq && body->nv > 0) rbdi_put_step(m, body, RBDI_EXP_MINUS_AD, d, dt, one, dnext_dq);
        if (dnext_dv && body->nv > 0) rbdi_put_step(m, body, RBDI_J_R, d, dt, dt, dnext_dv);
    }
    return RBD_OK;
}

/* Replaces the rows of M by M dv~/dv, v~ = v + dt w x (u + w x c), for steps whose points c move straight.
   With the velocity (w; u) of a joint that turns, a row (n; f) becomes

       n + dt (u + w x c) x f + c x (dt f x w),   f + dt f x w */
RBDI_PART void rbdi_unforced_columns(const rbd_model *m, int points, const rbd_real *v, rbd_real dt, int rows,
                                     rbd_real *M) {
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];
        rbdi_motion V;
        rbdi_v3 c;
        if (!rbdi_joint_turns(body)) continue;

        c = rbdi_straight_point(m, body, points);
        V = rbdi_motion_of_point(rbdi_joint_motion(body, &v[body->iv], 1), c);
        for (rbd_real *row = M + body->iv; row < M + rows * m->nv; row += m->nv) {
            rbdi_motion part = rbdi_joint_motion(body, row, 1);
            const rbdi_v3 gain = rbdi_scale(dt, rbdi_cross(part.v, V.omega));

            part.omega = rbdi_add(part.omega, rbdi_scale(dt, rbdi_cross(V.v, part.v)));
            part.omega = rbdi_add(part.omega, rbdi_cross(c, gain));
            part.v = rbdi_add(part.v, gain);
            rbdi_put_joint_motion(body, part, row, 1);
        }
    }
}

/* Replaces rows of a joint that turns: the derivatives dq of `moved` = (w; v) by those of the q that it
   reaches in dt with its point c straight (rbdi_move_turning), the derivatives dv of `nu` by those of its
   components in the axes there. Linear parts are those of c, until the end. With
   E = exp(-dt [w]x), E nu = (end_w; end_v), and the step (e; s) of the joint's own q that a column is by:

       turn = dt J_r(dt w) dw
       dq_next = (E e + turn; E (s + dt e x v + dt dv))
       dv_next = E dnu + (end_w x turn; end_v x turn)

   n: number of columns; own: the first column by the joint's own q, -1 = none */
RBDI_LOCAL void rbdi_turn_columns(const rbdi_frame *body, rbdi_v3 c, int n, const rbd_real *moved,
                                  const rbd_real *nu, rbd_real dt, int own, rbd_real *dq, rbd_real *dv) {
    const rbdi_motion V = rbdi_motion_of_point(rbdi_joint_motion(body, moved, 1), c),
                      end = rbdi_motion_of_point(rbdi_joint_motion(body, nu, 1), c);
    const rbdi_v3 origin = rbdi_sub(rbdi_vec0(), c);
    const rbdi_v3 w = rbdi_scale(dt, V.omega), back = rbdi_scale(-dt, V.omega);
    const rbdi_exp e = rbdi_exp_of(w);
    const rbdi_v3 end_w = rbdi_turn_back(e, w, end.omega), end_v = rbdi_turn_back(e, w, end.v);

    for (int k = 0; k < n; ++k, ++dq, ++dv) {
        rbdi_motion position = rbdi_motion_of_point(rbdi_joint_motion(body, dq, n), c),
                    velocity = rbdi_motion_of_point(rbdi_joint_motion(body, dv, n), c);
        const rbdi_v3 turn = rbdi_scale(dt, rbdi_exp_shift(e, back, position.omega));

        position.omega = turn;
        position.v = rbdi_scale(dt, position.v);
        if (own >= 0 && k >= own && k < own + body->nv) {
            rbd_real unit[6] = {rbdi_zero(), rbdi_zero(), rbdi_zero(), rbdi_zero(), rbdi_zero(), rbdi_zero()};
            rbdi_motion step;
            unit[k - own] = rbdi_set(RBD_C(1));
            step = rbdi_motion_of_point(rbdi_joint_motion(body, unit, 1), c);
            position.omega = rbdi_add(turn, rbdi_turn_back(e, w, step.omega));
            position.v = rbdi_add(rbdi_add(position.v, step.v), rbdi_scale(dt, rbdi_cross(step.omega, V.v)));
        }
        position.v = rbdi_turn_back(e, w, position.v);

        velocity.omega = rbdi_add(rbdi_turn_back(e, w, velocity.omega), rbdi_cross(end_w, turn));
        velocity.v = rbdi_add(rbdi_turn_back(e, w, velocity.v), rbdi_cross(end_v, turn));

        rbdi_put_joint_motion(body, rbdi_motion_of_point(position, origin), dq, n);
        rbdi_put_joint_motion(body, rbdi_motion_of_point(velocity, origin), dv, n);
    }
}

/* The same for all joints. Where coordinates add up, dq_next = e + dt dq and dv_next = dv. */
RBDI_PART void rbdi_move_columns(const rbd_model *m, int points, const rbd_real *moved, const rbd_real *nu,
                                 rbd_real dt, int by_q, rbd_real *dq, rbd_real *dv) {
    const ptrdiff_t n = m->nv;

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];

        if (rbdi_joint_turns(body)) {
            const rbdi_v3 c = rbdi_straight_point(m, body, points);
            rbdi_turn_columns(body, c, m->nv, &moved[body->iv], &nu[body->iv], dt, by_q ? body->iv : -1,
                              &dq[body->iv * n], &dv[body->iv * n]);
            continue;
        }

        for (int k = body->iv; k < body->iv + body->nv; ++k) {
            for (int j = 0; j < n; ++j) dq[k * n + j] = dq[k * n + j] * dt;
            if (by_q) dq[k * n + k] = dq[k * n + k] + rbdi_set(RBD_C(1));
        }
    }
}

/* Derivatives of the q and v of one joint, moved by v dt with its point c straight, v in the axes of the end:
   nv x nv each, of q by q and by v, of v by v. */
typedef struct rbdi_moved_joint {
    rbd_real q_q[36], q_v[36], v_v[36];
} rbdi_moved_joint;

RBDI_LOCAL rbdi_moved_joint rbdi_differentiate_move(const rbdi_frame *body, rbdi_v3 c, const rbd_real *v,
                                                    rbd_real dt) {
    const int n = body->nv;
    rbd_real none[36];
    rbdi_moved_joint by;

    for (int k = 0; k < 36; ++k) by.q_q[k] = by.q_v[k] = by.v_v[k] = none[k] = rbdi_zero();
    for (int k = 0; k < n; ++k) by.q_v[k * (n + 1)] = by.v_v[k * (n + 1)] = rbdi_set(RBD_C(1));
    if (rbdi_joint_turns(body)) {
        rbdi_turn_columns(body, c, n, v, v, dt, 0, by.q_q, none);
        rbdi_turn_columns(body, c, n, v, v, dt, -1, by.q_v, by.v_v);
        return by;
    }

    for (int k = 0; k < n; ++k) {
        by.q_q[k * (n + 1)] = rbdi_set(RBD_C(1));
        by.q_v[k * (n + 1)] = dt;
    }
    return by;
}

/* Replaces rows of derivatives by a state, F_q and F_v, by those by the state from which v moved it for dt:
   F_v = F_q dq/dv + F_v dv/dv, F_q = F_q dq/dq. F_v: NULL = not wanted. */
RBDI_PART void rbdi_columns_before(const rbd_model *m, int points, const rbd_real *v, rbd_real dt,
                                   rbd_real *F_q, rbd_real *F_v) {
    for (const rbdi_frame *body = m->frame; body < m->frame + m->nb; ++body) {
        const int n = body->nv;
        rbdi_moved_joint by;
        if (n == 0) continue;

        by = rbdi_differentiate_move(body, rbdi_straight_point(m, body, points), &v[body->iv], dt);
        for (int r = 0; r < m->nv; ++r) {
            rbd_real *q = &F_q[r * m->nv + body->iv], new_q[6], new_v[6];

            for (int j = 0; j < n; ++j) {
                new_q[j] = new_v[j] = rbdi_zero();
                for (int i = 0; i < n; ++i) {
                    new_q[j] = new_q[j] + q[i] * by.q_q[i * n + j];
                    new_v[j] = new_v[j] + q[i] * by.q_v[i * n + j];
                    if (F_v) new_v[j] = new_v[j] + F_v[r * m->nv + body->iv + i] * by.v_v[i * n + j];
                }
            }

            for (int j = 0; j < n; ++j) {
                q[j] = new_q[j];
                if (F_v) F_v[r * m->nv + body->iv + j] = new_v[j];
            }
        }
    }
}

RBDI_API rbd_status rbd_difference_derivatives(const rbd_model *m, const rbd_real *q0, const rbd_real *q1,
                                               rbd_real *dd_dq0, rbd_real *dd_dq1) {
    const rbd_real one = rbdi_set(RBD_C(1));
    if (!m || !q0 || !q1) return RBD_ERR_NULL;

    if (dd_dq0) rbdi_clear(dd_dq0, m->nv * m->nv);
    if (dd_dq1) rbdi_clear(dd_dq1, m->nv * m->nv);

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];
        rbd_real d[6];
        if (body->nv == 0) continue;

        rbdi_difference_joint(body, &q0[body->iq], &q1[body->iq], d);
        if (dd_dq0) rbdi_put_step(m, body, RBDI_J_R_INVERSE, d, -one, -one, dd_dq0);
        if (dd_dq1) rbdi_put_step(m, body, RBDI_J_R_INVERSE, d, one, one, dd_dq1);
    }
    return RBD_OK;
}

#endif
