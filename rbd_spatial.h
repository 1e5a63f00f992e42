/* rbd_spatial.h - spatial algebra, for programs that use rbd.h. SPDX-License-Identifier: MIT, see rbd.h.
   Made by src/amalgamate.py from src/rbd_spatial.h and the files that it includes: edit those.

   Rotations, placements of frames, and the spatial vectors of Featherstone's book (Rigid Body Dynamics
   Algorithms, 2008, chapter 2; "the book" below): small structs by value and static inline functions, in C99
   and C++, for every scalar of rbd.h, which must stand beside it. It has no symbol of its own: any number of
   files may include it.

       rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);         // of rbd_body_pose
       rbd_force f = rbd_force_of(moment, force, WORLD);
       rbd_force_to_array(rbd_force_down(hand, f), &f_ext[6 * HAND]);             // a row of f_ext

   CONTENTS (search for the tag)
     [conventions] [frames]
     [types] [rotations] [placements] [motions] [forces] [inertias] [checks]

   [conventions]
     vectors      angular first, as everywhere in rbd: a motion is (omega; v of the point at the origin), a
                  force is (moment about the origin; force)
     kinds        motion and force are different types, so that a compiler refuses to mix them up:
                  rbd_motion_up takes a motion only, and an inertia times a motion is a force
     placement    says where frame `of` stands in frame `in`: rotation turns vectors from of's axes into in's
                  axes, position is of's origin, in in's axes; Pinocchio's SE3 in_M_of
     up, down     up: from `of` to `in`, as from a child to its parent; down: back
     quaternions  (x, y, z, w), of any length; they turn as the rotation does
     angles       rad; roll, pitch, yaw are those of URDF: Rz(yaw) Ry(pitch) Rx(roll)

   [frames] Every quantity is given a frame, a number of your choice, such as a body's index or -1 for the
   world. By default it is not kept and costs nothing. With

       void frame_error(const char *file, int line, const char *call, int found, int expected);
       #define RBD_CHECK_FRAMES frame_error
       #include "rbd_spatial.h"

   it is kept with each quantity. If a call gets a quantity of a wrong frame, your function (in one file; it
   may print, stop, or return) gets the place in your source, the name of the call, and the two frames. The
   structs are larger then: all files that exchange them need the same setting. rbd_vec3 and rbd_rotation have
   no frame.
*/
#define RBDI_WITH_ALGEBRA
#include "rbd.h"

#ifndef RBD_SPATIAL_H
#define RBD_SPATIAL_H

#if RBD_VERSION_NUMBER < 400
#error "rbd_spatial.h: needs a newer rbd.h"
#endif

/* ==== src/spatial/types.h ==== */
#ifdef RBD_CHECK_FRAMES
#define RBDI_FRAMES(...) __VA_ARGS__
#define RBDI_AT const char *file, int line,
#define RBDI_HERE file, line,
#define RBDI_MATCH(call, found, expected) \
    if ((found) != (expected)) RBD_CHECK_FRAMES(file, line, call, found, expected)
#else
#define RBDI_FRAMES(...)
#define RBDI_AT
#define RBDI_HERE
#define RBDI_MATCH(call, found, expected) (void)0
#endif

/* ---- types [types] ---- */

typedef rbdi_v3 rbd_vec3;      /* x, y, z */
typedef rbdi_mat rbd_rotation; /* xx, xy, xz, yx, ... zz: by rows */
typedef rbdi_sym rbd_sym3;     /* xx, xy, xz, yy, yz, zz: symmetric */

/* Where frame `of` stands in frame `in`. */
typedef struct rbd_placement {
    rbd_rotation rotation; /* from of's axes into in's */
    rbd_vec3 position;     /* of of's origin, in in's axes, m */
    RBDI_FRAMES(int of, in;)
} rbd_placement;

/* Velocity or acceleration, displacement, axis of motion. */
typedef struct rbd_motion {
    rbd_vec3 angular; /* rad/s */
    rbd_vec3 linear;  /* m/s, of the point at the frame's origin */
    RBDI_FRAMES(int frame;)
} rbd_motion;

/* Wrench, momentum, impulse. */
typedef struct rbd_force {
    rbd_vec3 moment; /* N m, about the frame's origin */
    rbd_vec3 force;  /* N */
    RBDI_FRAMES(int frame;)
} rbd_force;

/* Spatial inertia of a rigid body. */
typedef struct rbd_inertia {
    rbd_const mass;      /* kg, the same in every frame */
    rbd_vec3 h;          /* mass times centre of mass, kg m */
    rbd_sym3 rotational; /* about the frame's origin, kg m^2 */
    RBDI_FRAMES(int frame;)
} rbd_inertia;

/* ==== src/spatial/placements.h ==== */
/* ---- rotations [rotations] ---- */

RBDI_INLINE rbd_vec3 rbd_vec3_of(rbd_real x, rbd_real y, rbd_real z) { return rbdi_vec(x, y, z); }
RBDI_INLINE rbd_vec3 rbd_vec3_from_array(const rbd_real *a) { return rbdi_load_vec(a, 1); }
RBDI_INLINE void rbd_vec3_to_array(rbd_vec3 v, rbd_real *a) { rbdi_store_vec(a, 1, v); }

RBDI_INLINE rbd_rotation rbd_rotation_identity(void) {
    rbd_rotation r;
    r.xx = r.yy = r.zz = rbdi_set(RBD_C(1));
    r.xy = r.xz = r.yx = r.yz = r.zx = r.zy = rbdi_zero();
    return r;
}

/* From and to nine numbers, row-major, such as those of rbd_body_pose. */
RBDI_INLINE rbd_rotation rbd_rotation_from_array(const rbd_real *a) {
    rbd_rotation r;

    r.xx = a[0];
    r.xy = a[1];
    r.xz = a[2];
    r.yx = a[3];
    r.yy = a[4];
    r.yz = a[5];
    r.zx = a[6];
    r.zy = a[7];
    r.zz = a[8];
    return r;
}

RBDI_INLINE void rbd_rotation_to_array(rbd_rotation r, rbd_real *a) {
    rbdi_store_vec(a, 1, rbdi_vec(r.xx, r.xy, r.xz));
    rbdi_store_vec(a + 3, 1, rbdi_vec(r.yx, r.yy, r.yz));
    rbdi_store_vec(a + 6, 1, rbdi_vec(r.zx, r.zy, r.zz));
}

/* a b: first turns by b, then by a. Both turn about the axes of the frame that a leads to. */
RBDI_INLINE rbd_rotation rbd_rotation_product(rbd_rotation a, rbd_rotation b) { return rbdi_mul_mat(a, b); }
RBDI_INLINE rbd_rotation rbd_rotation_inverse(rbd_rotation r) { return rbdi_transpose(r); }

/* r v, from of's axes into in's; rbd_rotate_back: r' v. */
RBDI_INLINE rbd_vec3 rbd_rotate(rbd_rotation r, rbd_vec3 v) { return rbdi_mul(r, v); }
RBDI_INLINE rbd_vec3 rbd_rotate_back(rbd_rotation r, rbd_vec3 v) { return rbdi_mul_t(r, v); }

/* q: x, y, z, w, of any length; zero gives the identity. */
RBDI_INLINE rbd_rotation rbd_rotation_from_quaternion(const rbd_real q[4]) {
    return rbdi_transpose(rbdi_quaternion_down(q));
}

/* q: the unit quaternion x, y, z, w with w >= 0. */
RBDI_PART void rbd_rotation_to_quaternion(rbd_rotation r, rbd_real q[4]) {
    const rbd_real one = rbdi_set(RBD_C(1));
    rbd_real row[4], sign;
    rbdi_quaternion_of(r, row);
    rbdi_unit_quaternion(row, q);
    sign = rbdi_select(rbdi_less(q[3], rbdi_zero()), -one, one);
    for (int k = 0; k < 4; ++k) q[k] = sign * q[k];
}

/* Rz(yaw) Ry(pitch) Rx(roll), rad. */
RBDI_PART rbd_rotation rbd_rotation_from_rpy(rbd_real roll, rbd_real pitch, rbd_real yaw) {
    rbd_real sr, cr, sp, cp, sy, cy;
    rbd_rotation r;

    rbdi_sincos(roll, &sr, &cr);
    rbdi_sincos(pitch, &sp, &cp);
    rbdi_sincos(yaw, &sy, &cy);
    r.xx = cy * cp;
    r.xy = cy * sp * sr - sy * cr;
    r.xz = cy * sp * cr + sy * sr;
    r.yx = sy * cp;
    r.yy = sy * sp * sr + cy * cr;
    r.yz = sy * sp * cr - cy * sr;
    r.zx = -sp;
    r.zy = cp * sr;
    r.zz = cp * cr;
    return r;
}

/* The angle of (c, s), in [-pi, pi]; scales them to unit length, (1, 0) if both are zero. */
RBDI_INLINE rbd_real rbdi_angle_of(rbd_real *c, rbd_real *s) {
    rbdi_mask none = rbdi_less(*c, *c);
    const rbd_real factor = rbdi_reciprocal(rbdi_sqrt(*c * *c + *s * *s), RBDI_TINY, &none);
    *c = rbdi_select(none, rbdi_set(RBD_C(1)), factor * *c);
    *s = factor * *s;
    return rbdi_signed_angle(*s, *c);
}

/* rpy: roll and yaw in [-pi, pi], pitch in [-pi/2, pi/2], rad. At a pitch of pi/2 or -pi/2 roll and yaw turn
   about the same axis; then they are two that give r. */
RBDI_PART void rbd_rotation_to_rpy(rbd_rotation r, rbd_real rpy[3]) {
    rbd_real c = r.zz, s = r.zy, cp, sp = -r.zx, cy, sy;
    rpy[0] = rbdi_angle_of(&c, &s);
    cp = r.zy * s + r.zz * c; /* the rest is Rz(yaw) Ry(pitch) = r Rx(-roll) */
    sy = r.xz * s - r.xy * c;
    cy = r.yy * c - r.yz * s;
    rpy[1] = rbdi_angle_of(&cp, &sp);
    rpy[2] = rbdi_angle_of(&cy, &sy);
}

/* exp: the rotation about the vector turn, by its length, rad. */
RBDI_PART rbd_rotation rbd_rotation_exp(rbd_vec3 turn) {
    const rbdi_exp e = rbdi_exp_of(turn);
    rbd_real q[4];
    rbdi_store_vec(q, 1, rbdi_scale(e.half_sine, turn));
    q[3] = e.half_cosine;
    return rbd_rotation_from_quaternion(q);
}

/* log: the shortest turn, of length at most pi, whose exp is r. */
RBDI_INLINE rbd_vec3 rbd_rotation_log(rbd_rotation r) { return rbdi_log_rotation(r); }

/* The rotation about an axis of any length, by the angle, rad; the identity if the axis is zero. */
RBDI_PART rbd_rotation rbd_rotation_from_axis_angle(rbd_vec3 axis, rbd_real angle) {
    rbdi_mask bad;
    rbd_real a[3], u[3];
    rbdi_store_vec(a, 1, axis);
    angle = angle * rbdi_sqrt(rbdi_inverse_square(a, 3, u, &bad));
    return rbd_rotation_exp(rbdi_scale(angle, rbdi_load_vec(u, 1)));
}

/* Returns the angle, in [0, pi]; axis: of unit length, z if the angle is 0. */
RBDI_PART rbd_real rbd_rotation_to_axis_angle(rbd_rotation r, rbd_vec3 *axis) {
    const rbd_vec3 turn = rbd_rotation_log(r);
    const rbd_real angle = rbdi_sqrt(rbdi_dot(turn, turn));
    rbdi_mask none = rbdi_less(angle, angle);
    *axis = rbdi_scale(rbdi_reciprocal(angle, RBDI_TINY, &none), turn);
    axis->z = rbdi_select(none, rbdi_set(RBD_C(1)), axis->z);
    return angle;
}

/* ---- placements [placements] ---- */

/* Where frame `of` stands in frame `in`: its axes, and its origin, m. */
RBDI_INLINE rbd_placement rbd_placement_of(rbd_rotation rotation, rbd_vec3 position, int of, int in) {
    rbd_placement x;
    x.rotation = rotation;
    x.position = position;
    (void)of;
    (void)in;
    RBDI_FRAMES(x.of = of; x.in = in;)
    return x;
}

/* The same from arrays, such as the results of rbd_body_pose, where `in` is the world. */
RBDI_INLINE rbd_placement rbd_placement_from_arrays(const rbd_real rotation[9], const rbd_real position[3],
                                                    int of, int in) {
    return rbd_placement_of(rbd_rotation_from_array(rotation), rbd_vec3_from_array(position), of, in);
}

RBDI_INLINE rbd_placement rbd_placement_identity(int of, int in) {
    return rbd_placement_of(rbd_rotation_identity(), rbdi_vec0(), of, in);
}

/* The placement of inner.of in outer.in; inner.in must be outer.of. */
RBDI_INLINE rbd_placement rbd_placement_compose(RBDI_AT rbd_placement outer, rbd_placement inner) {
    rbd_placement x;
    RBDI_MATCH("rbd_placement_compose", inner.in, outer.of);
    x.rotation = rbdi_mul_mat(outer.rotation, inner.rotation);
    x.position = rbdi_add(outer.position, rbdi_mul(outer.rotation, inner.position));
    RBDI_FRAMES(x.of = inner.of; x.in = outer.in;)
    return x;
}

/* The placement of frame `in` in frame `of`. */
RBDI_INLINE rbd_placement rbd_placement_inverse(rbd_placement x) {
    rbd_placement y;
    y.rotation = rbdi_transpose(x.rotation);
    y.position = rbdi_scale(rbdi_set(RBD_C(-1)), rbdi_mul_t(x.rotation, x.position));
    RBDI_FRAMES(y.of = x.in; y.in = x.of;)
    return y;
}

/* A point from coordinates of frame `of` into those of `in`; rbd_point_down: back. */
RBDI_INLINE rbd_vec3 rbd_point_up(rbd_placement x, rbd_vec3 point) {
    return rbdi_add(x.position, rbdi_mul(x.rotation, point));
}

RBDI_INLINE rbd_vec3 rbd_point_down(rbd_placement x, rbd_vec3 point) {
    return rbdi_mul_t(x.rotation, rbdi_sub(point, x.position));
}

/* ==== src/spatial/vectors.h ==== */
/* ---- motions [motions] ---- */

RBDI_INLINE rbd_motion rbd_motion_of(rbd_vec3 angular, rbd_vec3 linear, int frame) {
    rbd_motion m;
    m.angular = angular;
    m.linear = linear;
    (void)frame;
    RBDI_FRAMES(m.frame = frame;)
    return m;
}

/* From and to six numbers (angular; linear), such as those of rbd_body_velocity. */
RBDI_INLINE rbd_motion rbd_motion_from_array(const rbd_real a[6], int frame) {
    return rbd_motion_of(rbd_vec3_from_array(a), rbd_vec3_from_array(a + 3), frame);
}

RBDI_INLINE void rbd_motion_to_array(rbd_motion m, rbd_real a[6]) {
    rbdi_store_vec(a, 1, m.angular);
    rbdi_store_vec(a + 3, 1, m.linear);
}

RBDI_INLINE rbd_motion rbd_motion_add(RBDI_AT rbd_motion a, rbd_motion b) {
    RBDI_MATCH("rbd_motion_add", b.frame, a.frame);
    a.angular = rbdi_add(a.angular, b.angular);
    a.linear = rbdi_add(a.linear, b.linear);
    return a;
}

RBDI_INLINE rbd_motion rbd_motion_scale(rbd_real factor, rbd_motion m) {
    m.angular = rbdi_scale(factor, m.angular);
    m.linear = rbdi_scale(factor, m.linear);
    return m;
}

/* A motion from frame `of` into frame `in`; (2.24) of the book. */
RBDI_INLINE rbd_motion rbd_motion_up(RBDI_AT rbd_placement x, rbd_motion m) {
    RBDI_MATCH("rbd_motion_up", m.frame, x.of);
    m.angular = rbdi_mul(x.rotation, m.angular);
    m.linear = rbdi_add(rbdi_mul(x.rotation, m.linear), rbdi_cross(x.position, m.angular));
    RBDI_FRAMES(m.frame = x.in;)
    return m;
}

/* A motion from frame `in` into frame `of`. */
RBDI_INLINE rbd_motion rbd_motion_down(RBDI_AT rbd_placement x, rbd_motion m) {
    RBDI_MATCH("rbd_motion_down", m.frame, x.in);
    m.linear = rbdi_mul_t(x.rotation, rbdi_sub(m.linear, rbdi_cross(x.position, m.angular)));
    m.angular = rbdi_mul_t(x.rotation, m.angular);
    RBDI_FRAMES(m.frame = x.of;)
    return m;
}

/* v x m: the rate of a motion m that is fixed in a body with velocity v; (2.31). */
RBDI_INLINE rbd_motion rbd_motion_cross(RBDI_AT rbd_motion v, rbd_motion m) {
    RBDI_MATCH("rbd_motion_cross", m.frame, v.frame);
    m.linear = rbdi_add(rbdi_cross(v.angular, m.linear), rbdi_cross(v.linear, m.angular));
    m.angular = rbdi_cross(v.angular, m.angular);
    return m;
}

/* exp: the placement, after unit time, of a frame that moves with v, constant in its own axes. The moved
   frame is `of`; `in`, where it started, is the frame of v. */
RBDI_PART rbd_placement rbd_placement_exp(rbd_motion v, int of) {
    rbd_placement x;
    x.rotation = rbd_rotation_exp(v.angular);
    x.position = rbdi_exp_shift(rbdi_exp_of(v.angular), v.angular, v.linear);
    (void)of;
    RBDI_FRAMES(x.of = of; x.in = v.frame;)
    return x;
}

/* log: the motion with the shortest turn, at most pi, whose exp is x. It has the same components in both
   frames; its frame is `in`. */
RBDI_PART rbd_motion rbd_placement_log(rbd_placement x) {
    rbd_motion v;
    v.angular = rbd_rotation_log(x.rotation);
    v.linear = rbdi_log_shift(rbdi_exp_of(v.angular), v.angular, x.position);
    RBDI_FRAMES(v.frame = x.in;)
    return v;
}

/* ---- forces [forces] ---- */

RBDI_INLINE rbd_force rbd_force_of(rbd_vec3 moment, rbd_vec3 force, int frame) {
    rbd_force f;
    f.moment = moment;
    f.force = force;
    (void)frame;
    RBDI_FRAMES(f.frame = frame;)
    return f;
}

/* From and to six numbers (moment; force), such as a row of f_ext. */
RBDI_INLINE rbd_force rbd_force_from_array(const rbd_real a[6], int frame) {
    return rbd_force_of(rbd_vec3_from_array(a), rbd_vec3_from_array(a + 3), frame);
}

RBDI_INLINE void rbd_force_to_array(rbd_force f, rbd_real a[6]) {
    rbdi_store_vec(a, 1, f.moment);
    rbdi_store_vec(a + 3, 1, f.force);
}

RBDI_INLINE rbd_force rbd_force_add(RBDI_AT rbd_force a, rbd_force b) {
    RBDI_MATCH("rbd_force_add", b.frame, a.frame);
    a.moment = rbdi_add(a.moment, b.moment);
    a.force = rbdi_add(a.force, b.force);
    return a;
}

RBDI_INLINE rbd_force rbd_force_scale(rbd_real factor, rbd_force f) {
    f.moment = rbdi_scale(factor, f.moment);
    f.force = rbdi_scale(factor, f.force);
    return f;
}

/* A force from frame `of` into frame `in`; (2.25). */
RBDI_INLINE rbd_force rbd_force_up(RBDI_AT rbd_placement x, rbd_force f) {
    RBDI_MATCH("rbd_force_up", f.frame, x.of);
    f.force = rbdi_mul(x.rotation, f.force);
    f.moment = rbdi_add(rbdi_mul(x.rotation, f.moment), rbdi_cross(x.position, f.force));
    RBDI_FRAMES(f.frame = x.in;)
    return f;
}

/* A force from frame `in` into frame `of`. */
RBDI_INLINE rbd_force rbd_force_down(RBDI_AT rbd_placement x, rbd_force f) {
    RBDI_MATCH("rbd_force_down", f.frame, x.in);
    f.moment = rbdi_mul_t(x.rotation, rbdi_sub(f.moment, rbdi_cross(x.position, f.force)));
    f.force = rbdi_mul_t(x.rotation, f.force);
    RBDI_FRAMES(f.frame = x.of;)
    return f;
}

/* v x* f: the rate of a force f that is fixed in a body with velocity v; (2.32). */
RBDI_INLINE rbd_force rbd_force_cross(RBDI_AT rbd_motion v, rbd_force f) {
    RBDI_MATCH("rbd_force_cross", f.frame, v.frame);
    f.moment = rbdi_add(rbdi_cross(v.angular, f.moment), rbdi_cross(v.linear, f.force));
    f.force = rbdi_cross(v.angular, f.force);
    return f;
}

/* v . f: the power, W, of the force on a body with velocity v; the same in every frame. */
RBDI_INLINE rbd_real rbd_power(RBDI_AT rbd_motion v, rbd_force f) {
    RBDI_MATCH("rbd_power", f.frame, v.frame);
    return rbdi_dot(v.angular, f.moment) + rbdi_dot(v.linear, f.force);
}

/* ==== src/spatial/inertias.h ==== */
/* ---- inertias [inertias] ---- */

/* From the ten parameters of a regressor, in which the inertia is linear: mass; mass times centre of mass;
   xx, xy, xz, yy, yz, zz about the frame's origin, in kg, kg m and kg m^2. _to_parameters: back. */
RBDI_INLINE rbd_inertia rbd_inertia_from_parameters(const rbd_const p[10], int frame) {
    rbd_inertia i;

    i.mass = p[0];
    i.h = rbdi_vec(rbdi_set(p[1]), rbdi_set(p[2]), rbdi_set(p[3]));
    i.rotational.xx = rbdi_set(p[4]);
    i.rotational.xy = rbdi_set(p[5]);
    i.rotational.xz = rbdi_set(p[6]);
    i.rotational.yy = rbdi_set(p[7]);
    i.rotational.yz = rbdi_set(p[8]);
    i.rotational.zz = rbdi_set(p[9]);
    (void)frame;
    RBDI_FRAMES(i.frame = frame;)
    return i;
}

RBDI_INLINE void rbd_inertia_to_parameters(rbd_inertia i, rbd_real p[10]) {
    const rbd_sym3 a = i.rotational;
    p[0] = rbdi_set(i.mass);
    rbdi_store_vec(p + 1, 1, i.h);
    rbdi_store_vec(p + 4, 1, rbdi_vec(a.xx, a.xy, a.xz));
    rbdi_store_vec(p + 7, 1, rbdi_vec(a.yy, a.yz, a.zz));
}

/* trace 1 - a: of the second moment of mass, Sigma, the rotational inertia, see [design] of rbd.h. With half
   the trace of the rotational inertia: back. */
RBDI_INLINE rbd_sym3 rbdi_trace_less(rbd_real trace, rbd_sym3 a) {
    rbd_sym3 b;

    b.xx = trace - a.xx;
    b.yy = trace - a.yy;
    b.zz = trace - a.zz;
    b.xy = -a.xy;
    b.xz = -a.xz;
    b.yz = -a.yz;
    return b;
}

RBDI_INLINE rbd_sym3 rbdi_second_moment(rbd_sym3 rotational) {
    return rbdi_trace_less(RBD_C(0.5) * (rotational.xx + rotational.yy + rotational.zz), rotational);
}

/* An inertia with this second moment, whose frame moves so that its origin stands at `shift` in the new
   one. */
RBDI_INLINE rbd_inertia rbdi_inertia_shift(rbd_vec3 shift, rbd_sym3 Sigma, rbd_inertia i) {
    rbdi_rbi c; /* composite: no capital letter, of which users may have macros here */
    c.Sigma = Sigma;
    c.h = i.h;
    c = rbdi_rbi_shift(shift, i.mass, c);
    i.h = c.h;
    i.rotational = rbdi_trace_less(c.Sigma.xx + c.Sigma.yy + c.Sigma.zz, c.Sigma);
    return i;
}

/* From mass, kg; centre of mass, m; inertia about it xx, xy, xz, yy, yz, zz, kg m^2: as in an rbd_body. */
RBDI_INLINE rbd_inertia rbd_inertia_of(rbd_const mass, const rbd_const com[3], const rbd_const inertia[6],
                                       int frame) {
    rbd_const p[10];
    rbd_inertia i;

    p[0] = mass;
    p[1] = p[2] = p[3] = RBD_C(0);
    for (int k = 0; k < 6; ++k) p[4 + k] = inertia[k];
    i = rbd_inertia_from_parameters(p, frame);
    return rbdi_inertia_shift(rbdi_vec(rbdi_set(com[0]), rbdi_set(com[1]), rbdi_set(com[2])),
                              rbdi_second_moment(i.rotational), i);
}

/* The inertia of two bodies that move as one, from theirs in the same frame. */
RBDI_INLINE rbd_inertia rbd_inertia_add(RBDI_AT rbd_inertia a, rbd_inertia b) {
    RBDI_MATCH("rbd_inertia_add", b.frame, a.frame);
    a.mass = a.mass + b.mass;
    a.h = rbdi_add(a.h, b.h);
    a.rotational = rbdi_sym_add(a.rotational, b.rotational);
    return a;
}

/* An inertia from frame `of` into frame `in`; (2.66) of the book. */
RBDI_INLINE rbd_inertia rbd_inertia_up(RBDI_AT rbd_placement x, rbd_inertia i) {
    RBDI_MATCH("rbd_inertia_up", i.frame, x.of);
    i.h = rbdi_mul(x.rotation, i.h);
    i = rbdi_inertia_shift(x.position,
                           rbdi_sym_up(rbdi_transpose(x.rotation), rbdi_second_moment(i.rotational)), i);
    RBDI_FRAMES(i.frame = x.in;)
    return i;
}

/* An inertia from frame `in` into frame `of`. */
RBDI_INLINE rbd_inertia rbd_inertia_down(RBDI_AT rbd_placement x, rbd_inertia i) {
    RBDI_MATCH("rbd_inertia_down", i.frame, x.in);
    RBDI_FRAMES(i.frame = x.in;) /* so that a mismatch is reported once */
    return rbd_inertia_up(RBDI_HERE rbd_placement_inverse(x), i);
}

/* i m: the momentum for a velocity m, the force for an acceleration m; (2.63). */
RBDI_INLINE rbd_force rbd_inertia_times(RBDI_AT rbd_inertia i, rbd_motion m) {
    rbd_force f;
    RBDI_MATCH("rbd_inertia_times", m.frame, i.frame);
    f.moment = rbdi_add(rbdi_mul_sym(i.rotational, m.angular), rbdi_cross(i.h, m.linear));
    f.force = rbdi_sub(rbdi_scale(rbdi_set(i.mass), m.linear), rbdi_cross(i.h, m.angular));
    RBDI_FRAMES(f.frame = m.frame;)
    return f;
}

/* ---- checks [checks] ----
   Calls that compare frames get their file and line. A macro does not expand within its own expansion. */

#ifdef RBD_CHECK_FRAMES
#define rbd_placement_compose(...) rbd_placement_compose(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_add(...) rbd_motion_add(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_up(...) rbd_motion_up(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_down(...) rbd_motion_down(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_cross(...) rbd_motion_cross(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_add(...) rbd_force_add(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_up(...) rbd_force_up(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_down(...) rbd_force_down(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_cross(...) rbd_force_cross(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_power(...) rbd_power(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_add(...) rbd_inertia_add(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_up(...) rbd_inertia_up(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_down(...) rbd_inertia_down(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_times(...) rbd_inertia_times(__FILE__, __LINE__, __VA_ARGS__)
#endif

/* ==== src/rbd_spatial.h ==== */
#endif /* RBD_SPATIAL_H */
