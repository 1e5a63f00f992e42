#ifndef RBDI_SPATIAL_PLACEMENTS_H
#define RBDI_SPATIAL_PLACEMENTS_H
#include "algebra/rotations.h"
#include "spatial/types.h"

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

#endif
