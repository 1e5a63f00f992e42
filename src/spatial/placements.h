#ifndef RBDI_SPATIAL_PLACEMENTS_H
#define RBDI_SPATIAL_PLACEMENTS_H
#include "spatial/rotations.h"

/* ---- placements [placements] ---- */

/* Frame `of` seen from frame `in`. */
RBDI_INLINE rbd_placement rbd_placement_of(rbd_rotation rotation, rbd_vec3 position, int of, int in) {
    rbd_placement x;
    x.rotation = rotation;
    x.position = position;
    (void)of, (void)in;
    RBDI_FRAMES(x.of = of; x.in = in;)
    return x;
}
/* The same of the numbers that rbd_body_pose gives: with in = the world. */
RBDI_INLINE rbd_placement rbd_placement_from_arrays(const rbd_real rotation[9], const rbd_real position[3],
                                                    int of, int in) {
    return rbd_placement_of(rbd_rotation_from_array(rotation), rbd_vec3_from_array(position), of, in);
}
RBDI_INLINE rbd_placement rbd_placement_identity(int of, int in) {
    return rbd_placement_of(rbd_rotation_identity(), rbdi_vec0(), of, in);
}

/* c in a, from b in a and c in b. */
RBDI_INLINE rbd_placement rbd_placement_compose(RBDI_AT rbd_placement b, rbd_placement c) {
    rbd_placement x;
    RBDI_MATCH("rbd_placement_compose", c.in, b.of);
    x.rotation = rbdi_mul_mat(b.rotation, c.rotation);
    x.position = rbdi_add(b.position, rbdi_mul(b.rotation, c.position));
    RBDI_FRAMES(x.of = c.of; x.in = b.in;)
    return x;
}

/* `in` seen from `of`. */
RBDI_INLINE rbd_placement rbd_placement_inverse(rbd_placement x) {
    rbd_placement y;
    y.rotation = rbdi_transpose(x.rotation);
    y.position = rbdi_scale(rbdi_set(RBD_C(-1)), rbdi_mul_t(x.rotation, x.position));
    RBDI_FRAMES(y.of = x.in; y.in = x.of;)
    return y;
}

/* A point of frame `of` in coordinates of `in`, and back. */
RBDI_INLINE rbd_vec3 rbd_point_up(rbd_placement x, rbd_vec3 point) {
    return rbdi_add(x.position, rbdi_mul(x.rotation, point));
}
RBDI_INLINE rbd_vec3 rbd_point_down(rbd_placement x, rbd_vec3 point) {
    return rbdi_mul_t(x.rotation, rbdi_sub(point, x.position));
}

#endif
