/* world.h - the arbiter of the library's fuzzer: rigid-body dynamics by Kane's equations, in world axes and
   in quad precision. It reads rbd_body rows and shares nothing else with rbd.h: no spatial vectors, no link
   frames, no recursion of forces. Beside every result it keeps the sum of the magnitudes of what was added up
   for it: the size that a rounding error is to be measured against. */
#ifndef WORLD_H
#define WORLD_H

#include "rbd.h"

/* With WORLD_LONG_DOUBLE that instead, in a twentieth of the time: three digits more than double on x86. */
#ifdef WORLD_LONG_DOUBLE
typedef long double quad;
#else
__extension__ typedef __float128 quad;
#endif

enum { WORLD_BODIES = 32, WORLD_DOFS = 64, WORLD_ELEMENTS = 5 * WORLD_BODIES };

/* A frame on the way from the world to a body, and the degrees of freedom that move it relative to the one
   before: a placement (none), a joint, or a part of a joint. All vectors in world axes. */
typedef struct world_element {
    int before; /* element, -1 = world */
    int dofs, iv;
    quad ratio; /* of a mimic joint */
    quad armature[6];
    quad turn[6][3], shift[6][3];            /* omega, and velocity of the origin, per unit of each rate */
    quad R[9], p[3];                         /* pose */
    quad w[3], v[3], alpha[3], a[3];         /* velocities and (classical) accelerations; no gravity */
    quad path;                               /* from the world origin along the tree: sum of lengths */
    quad w_size, v_size, alpha_size, a_size; /* sums of magnitudes */
} world_element;

typedef struct world {
    const rbd_body *bodies;
    int nb, nv, elements;
    world_element element[WORLD_ELEMENTS];
    int last[WORLD_BODIES];   /* the element that is the link frame of the body */
    int moved[WORLD_BODIES];  /* some joint moves it */
    quad reach[WORLD_BODIES]; /* how far off the library's own origin may be: see measure_reach */
    quad p_size[WORLD_BODIES], v_size[WORLD_BODIES],
        a_size[WORLD_BODIES]; /* of a body's motion: see measure_bodies */
    quad largest_angle;       /* of the joints, offsets of mimic joints included */
} world;

/* How many coordinates and degrees of freedom the joint of a body has; a mimic joint has none. */
int world_nq(const rbd_body *body);
int world_nv(const rbd_body *body);

/* Poses, velocities and accelerations. v and a may be NULL: zero. */
void world_move(world *s, const rbd_body *bodies, int nb, const quad *q, const quad *v, const quad *a);

/* tau of the state that world_move has set; size: of the terms of each. f_ext: nb x 6 or NULL. */
void world_torques(const world *s, const quad gravity[3], const quad *a, const quad *f_ext, quad *tau,
                   quad *size);

/* Mass matrix, nv x nv, and for each degree of freedom the sum of the magnitudes that make its diagonal
 * entry. */
void world_mass_matrix(const world *s, quad *M, quad *size);

/* Results of rbd_com and rbd_energy, with sizes: position, velocity and acceleration of the centre of mass,
   kinetic and potential energy. */
typedef struct world_totals {
    quad com[3][3], com_size[3];
    quad energy[2], energy_size[2];
} world_totals;
void world_total(const world *s, const quad gravity[3], const quad *v, world_totals *t);

/* The coordinates of one joint after the tangent step d, and the size of each. */
void world_step(const rbd_body *body, const quad *q, const quad *d, quad *next, quad *size);

/* How far a symmetric matrix scaled by 1 / sqrt(size_i size_j) is from a singular one: 1 over the 1-norm of
   the inverse; 0 if it is not positive definite. Destroys M. */
quad world_distance(quad *M, const quad *size, int n);

/* R as the library takes it: all zero is the identity, and rows are made orthonormal, first to last. */
void world_rotation(const double rotation[9], quad R[9]);

quad world_sqrt(quad x);

#endif
