#ifndef RBDI_SPATIAL_INERTIAS_H
#define RBDI_SPATIAL_INERTIAS_H
#include "algebra/spatial.h"
#include "spatial/placements.h"

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

#endif
