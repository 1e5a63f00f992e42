#ifndef RBDI_ALGEBRA_ROTATIONS_H
#define RBDI_ALGEBRA_ROTATIONS_H
#include "base/sincos.h"
#include "algebra/vectors.h"

/* Quaternions and angles. */

/* A power of two. It is so small that the square of no finite number times it overflows, and so large that a
   number whose square overflows stays above 1e-15. */
#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_SHORTEN 2.9134143481250808e-157 /* 2^-520 */
#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_SHORTEN 8.47032947e-22f /* 2^-70 */
#else
#define RBDI_SQUARE(x) ((x) * (x))
#define RBDI_SHORTEN /* 2^-8208 */ \
    RBDI_SQUARE(RBDI_SQUARE(RBDI_SQUARE(RBDI_SQUARE(RBD_C(3.7291703656001034e-155)))))
#endif

/* u = q, shortened if the sum of the n squares would overflow. Returns 1 / (sum of the squares of u), or 0
   with bad set if that sum is below RBDI_SHORT; of NaN it returns NaN, so that no direction is made up. */
RBDI_INLINE rbd_real rbdi_inverse_square(const rbd_real *q, int n, rbd_real *u, rbdi_mask *bad) {
    const rbd_real one = rbdi_set(RBD_C(1)), limit = rbdi_set(RBD_C(1e-12) / RBDI_SHORTEN / RBDI_SHORTEN);
    rbd_real sum = q[0] * q[0], factor;

    RBDI_UNROLL_SIX for (int i = 1; i < n; ++i)
        sum = sum + q[i] * q[i];
    factor = rbdi_select(rbdi_less(limit, sum), rbdi_set(RBDI_SHORTEN), one);
    RBDI_UNROLL_SIX for (int i = 0; i < n; ++i)
        u[i] = q[i] * factor;
    sum = u[0] * u[0];
    RBDI_UNROLL_SIX for (int i = 1; i < n; ++i)
        sum = sum + u[i] * u[i];
    *bad = rbdi_less(sum, rbdi_set(RBDI_SHORT));
    return rbdi_select(*bad, rbdi_zero(), one / rbdi_select(*bad, one, sum));
}

/* E of a quaternion (x, y, z, w) of any length, from joint-frame axes to body axes; zero gives the
   identity. */
RBDI_INLINE rbdi_mat rbdi_quaternion_down(const rbd_real *q) {
    rbdi_mask bad;
    rbd_real u[4], twice = rbdi_inverse_square(q, 4, u, &bad), x, y, z;
    rbdi_mat E;

    /* E = 1 - 2 (v'v 1 - v v' + w [v]x) / q'q, for q = (v; w) */
    twice = twice + twice;
    x = twice * u[0];
    y = twice * u[1];
    z = twice * u[2];

    E.xx = rbdi_set(RBD_C(1)) - (y * u[1] + z * u[2]);
    E.yy = rbdi_set(RBD_C(1)) - (x * u[0] + z * u[2]);
    E.zz = rbdi_set(RBD_C(1)) - (x * u[0] + y * u[1]);
    E.xy = x * u[1] + z * u[3];
    E.yx = x * u[1] - z * u[3];
    E.xz = x * u[2] - y * u[3];
    E.zx = x * u[2] + y * u[3];
    E.yz = y * u[2] + x * u[3];
    E.zy = y * u[2] - x * u[3];
    return E;
}

/* (cos, sin) scaled to unit length, (1, 0) if both vanish. */
RBDI_INLINE void rbdi_unit_cs(const rbd_real *q, rbd_real *c, rbd_real *s) {
    rbdi_mask bad;
    rbd_real u[2], factor = rbdi_sqrt(rbdi_inverse_square(q, 2, u, &bad));
    *c = rbdi_select(bad, rbdi_set(RBD_C(1)), u[0] * factor);
    *s = rbdi_select(bad, rbdi_zero(), u[1] * factor);
}

/* sum over k of (-x)^k / (n + 2k)!: the tails of sine (n odd) and cosine (n even), for 0 <= x < 1. */
RBDI_PART rbd_real rbdi_tail(rbd_real x, int n) {
    rbd_real sum = rbdi_set(RBD_C(1));
    int factorial = 1;
    for (int k = RBDI_TAIL_TERMS; k > 0; --k)
        sum = rbdi_set(RBD_C(1)) - x * sum * (RBD_C(1) / (rbd_const)((n + 2 * k - 1) * (n + 2 * k)));
    for (int k = 2; k <= n; ++k) factorial *= k;
    return sum * (RBD_C(1) / (rbd_const)factorial);
}

/* Coefficients of the exponential map for a turn by theta. Here and below A = sin(theta) / theta. */
typedef struct rbdi_exp {
    rbd_real x;           /* theta^2 */
    rbd_real half_sine;   /* sin(theta / 2) / theta */
    rbd_real half_cosine; /* cos(theta / 2) */
    rbd_real B, C;        /* (1 - cos theta) / theta^2, (theta - sin theta) / theta^3 */
} rbdi_exp;

RBDI_PART rbdi_exp rbdi_exp_of(rbdi_v3 turn) {
    rbdi_exp e;
    rbd_real theta, sine, A;
    rbdi_mask near_zero;

    e.x = rbdi_dot(turn, turn) + RBDI_NO_ANGLE;
    theta = rbdi_sqrt(e.x);
    rbdi_sincos(theta * RBD_C(0.5), &sine, &e.half_cosine);
    e.half_sine = sine / theta;
    e.B = (e.half_sine + e.half_sine) * e.half_sine;
    A = (e.half_sine + e.half_sine) * e.half_cosine;
    near_zero = rbdi_less(e.x, rbdi_set(RBD_C(1)));
    e.C = rbdi_select(near_zero, rbdi_tail(rbdi_select(near_zero, e.x, rbdi_zero()), 3),
                      (rbdi_set(RBD_C(1)) - A) / e.x);
    return e;
}

/* The shift p of a screw motion (omega; v): p = v + B omega x v + C omega x (omega x v). */
RBDI_PART rbdi_v3 rbdi_exp_shift(rbdi_exp e, rbdi_v3 omega, rbdi_v3 v) {
    rbdi_v3 across = rbdi_cross(omega, v);
    return rbdi_add(v, rbdi_add(rbdi_scale(e.B, across), rbdi_scale(e.C, rbdi_cross(omega, across))));
}

/* Its inverse: v = p - omega x p / 2 + D omega x (omega x p), D = (1 - A / (2 B)) / theta^2. */
RBDI_PART rbdi_v3 rbdi_log_shift(rbdi_exp e, rbdi_v3 omega, rbdi_v3 p) {
    rbdi_v3 across = rbdi_cross(omega, p);
    rbd_real one = rbdi_set(RBD_C(1)), twice_B = e.B + e.B, A = (e.half_sine + e.half_sine) * e.half_cosine;
    rbdi_mask near_zero = rbdi_less(e.x, one);
    rbd_real x = rbdi_select(near_zero, e.x, rbdi_zero()), tail = rbdi_tail(x, 4);
    rbd_real D =
        rbdi_select(near_zero, (rbdi_tail(x, 3) - (tail + tail)) / twice_B, (one - A / twice_B) / e.x);

    p = rbdi_add(p, rbdi_scale(D, rbdi_cross(omega, across)));
    return rbdi_sub(p, rbdi_scale(rbdi_set(RBD_C(0.5)), across));
}

/* Angle in [0, pi] with sine s >= 0 and cosine c, s^2 + c^2 = 1, by sine and cosine alone: from a cubic guess
   by Newton steps, each of which cubes the error. */
RBDI_PART rbd_real rbdi_angle(rbd_real s, rbd_real c) {
    rbd_real one = rbdi_set(RBD_C(1)), t, angle, sine, cosine;
    rbdi_mask obtuse = rbdi_less(c, rbdi_zero());
    rbd_real positive = rbdi_select(obtuse, -c, c);

    t = s / (positive + one); /* tan(angle / 2) in [0, 1] */
    angle = t * (rbdi_set(RBD_C(2)) - t * t * RBD_C(RBDI_ANGLE_START));

    for (int k = 0; k < 4; ++k) {
        rbdi_sincos(angle, &sine, &cosine);
        angle = angle + (s * cosine - positive * sine);
    }

    return rbdi_select(obtuse, rbdi_set(RBDI_PI(rbd_const)) - angle, angle);
}

/* The same with the sign of s, in [-pi, pi]. */
RBDI_PART rbd_real rbdi_signed_angle(rbd_real s, rbd_real c) {
    rbdi_mask negative = rbdi_less(s, rbdi_zero());
    rbd_real angle = rbdi_angle(rbdi_select(negative, -s, s), c);
    return rbdi_select(negative, -angle, angle);
}

/* Unit quaternion of the same direction; identity for zero. */
RBDI_PART void rbdi_unit_quaternion(const rbd_real *q, rbd_real *u) {
    rbdi_mask bad;
    rbd_real factor = rbdi_sqrt(rbdi_inverse_square(q, 4, u, &bad));
    for (int i = 0; i < 4; ++i) u[i] = u[i] * factor;
    u[3] = rbdi_select(bad, rbdi_set(RBD_C(1)), u[3]);
}

/* out = a b, Hamilton's product of (x, y, z, w). */
RBDI_PART void rbdi_quaternion_product(const rbd_real *a, const rbd_real *b, rbd_real *out) {
    rbdi_v3 va = rbdi_load_vec(a, 1), vb = rbdi_load_vec(b, 1);
    rbd_real w = a[3] * b[3] - rbdi_dot(va, vb);
    rbdi_store_vec(out, 1,
                   rbdi_add(rbdi_cross(va, vb), rbdi_add(rbdi_scale(a[3], vb), rbdi_scale(b[3], va))));
    out[3] = w;
}

/* out = q exp(turn), normalised; e: the coefficients for the turn. */
RBDI_PART void rbdi_quaternion_step(const rbd_real *q, rbdi_exp e, rbdi_v3 turn, rbd_real *out) {
    rbd_real step[4], unit[4];
    rbdi_store_vec(step, 1, rbdi_scale(e.half_sine, turn));
    step[3] = e.half_cosine;
    rbdi_unit_quaternion(q, unit);
    rbdi_quaternion_product(unit, step, unit);
    rbdi_unit_quaternion(unit, out);
}

/* A quaternion, of any length, of the rotation R: the row of 4 q q' with the largest diagonal entry, whose
   entries are sums of those of R (Shepperd 1978), without a branch. */
RBDI_PART void rbdi_quaternion_of(rbdi_mat R, rbd_real q[4]) {
    const rbd_real one = rbdi_set(RBD_C(1)), x = R.zy - R.yz, y = R.xz - R.zx, z = R.yx - R.xy;
    const rbd_real xy = R.xy + R.yx, yz = R.yz + R.zy, xz = R.xz + R.zx;
    const rbd_real rows[4][4] = {{one + R.xx - R.yy - R.zz, xy, xz, x},
                                 {xy, one - R.xx + R.yy - R.zz, yz, y},
                                 {xz, yz, one - R.xx - R.yy + R.zz, z},
                                 {x, y, z, one + R.xx + R.yy + R.zz}};
    rbd_real best = rows[3][3];

    for (int k = 0; k < 4; ++k) q[k] = rows[3][k];
    for (int i = 0; i < 3; ++i) {
        const rbdi_mask more = rbdi_less(best, rows[i][i]);
        best = rbdi_select(more, rows[i][i], best);
        for (int k = 0; k < 4; ++k) q[k] = rbdi_select(more, rows[i][k], q[k]);
    }
}

/* The turn (body axes, at most pi) that leads from q0 to q1. */
RBDI_PART rbdi_v3 rbdi_quaternion_difference(const rbd_real *q0, const rbd_real *q1) {
    rbd_real a[4], b[4], step[4], sine, cosine, angle;
    rbdi_v3 v;
    rbdi_mask back;

    rbdi_unit_quaternion(q0, a);
    rbdi_unit_quaternion(q1, b);
    for (int i = 0; i < 3; ++i) a[i] = -a[i];
    rbdi_quaternion_product(a, b, step);
    v = rbdi_load_vec(step, 1);
    back = rbdi_less(step[3], rbdi_zero());
    cosine = rbdi_select(back, -step[3], step[3]);
    sine = rbdi_sqrt(rbdi_dot(v, v) + RBDI_NO_ANGLE);
    angle = rbdi_angle(sine, cosine);
    angle = (angle + angle) / sine;
    return rbdi_scale(rbdi_select(back, -angle, angle), v);
}

/* log R: the shortest turn, of length at most pi, whose exponential is R. */
RBDI_PART rbdi_v3 rbdi_log_rotation(rbdi_mat R) {
    const rbd_real o = rbdi_zero();
    const rbd_real identity[4] = {o, o, o, rbdi_set(RBD_C(1))};
    rbd_real q[4];
    rbdi_quaternion_of(R, q);
    return rbdi_quaternion_difference(identity, q);
}

#endif
