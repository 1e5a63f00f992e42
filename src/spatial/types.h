#ifndef RBDI_SPATIAL_TYPES_H
#define RBDI_SPATIAL_TYPES_H
#include "algebra/types.h"

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

#endif
