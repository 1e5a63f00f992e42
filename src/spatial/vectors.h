#ifndef RBDI_SPATIAL_VECTORS_H
#define RBDI_SPATIAL_VECTORS_H
#include "spatial/placements.h"

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

#endif
