#ifndef RBDI_API_MANIFOLD_H
#define RBDI_API_MANIFOLD_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- configuration manifold [manifold] ----
   q: nq, v and d: nv, in the coordinates of [conventions]. Errors: RBD_ERR_NULL. */

/* The neutral configuration: zeros, identity quaternions, (cos, sin) = (1, 0). */
RBDI_API rbd_status rbd_neutral(const rbd_model *m, rbd_real *q);

/* q_next = q moved by the tangent step v dt: exponentials in body axes for spherical (SO(3)), planar
   (SE(2)) and floating (SE(3)) joints, addition for the others. q_next may be q. */
RBDI_API rbd_status rbd_integrate(const rbd_model *m, const rbd_real *q, const rbd_real *v, rbd_real dt,
                                  rbd_real *q_next);

/* One step of semi-implicit Euler from the accelerations a of forward dynamics: nu = v + dt a, then q moves
   by nu dt. The velocities of floating, planar and spherical joints have body axes; their step is made in
   the axes of its beginning: the origin has its classical acceleration and moves straight, and v_next is nu
   in the axes of the end. So a free body keeps its linear momentum, and a rolling ball its energy, at any
   dt; v + dt a by components and rbd_integrate gain some. It is of first order: it takes a as it is at q and
   v, so bodies and robots that turn fast gain energy by their velocity terms, a box at 30 rad/s two thirds
   in ten seconds at 1 ms. rbd_free_step does not. q_next may be q, v_next may be v or a. */
RBDI_API rbd_status rbd_step(const rbd_model *m, const rbd_real *q, const rbd_real *v, const rbd_real *a,
                             rbd_real dt, rbd_real *q_next, rbd_real *v_next);

#ifndef RBD_NO_CHOLESKY
/* One step of second order from torques, without contacts: the midpoint scheme of rbd_contact_step, which
   keeps energy and momentum of what turns to second order in dt. Of a single body it takes some energy where
   it turns by more than a quarter of a radian a step, and is stable up to two radians; joints that turn by
   more than a twentieth of a radian a step may gain energy. The option `momentum` of rbd_contact_step, also of a
   set without contacts, keeps momentum to rounding. Some three times the work of rbd_aba and rbd_step.
   tau, damping   nv. damping is implicit: tau acts as tau - damping v_next. NULL: 0
   f_ext          nb x 6 or NULL: in the axes that bodies have in the middle of the step
   dt             s; any finite number
   q_next may be q, v_next may be v. Errors: as rbd_fd_cholesky; also RBD_ERR_NAN if a velocity changes by
   1e12 or more, or by NaN. After RBD_ERR_SINGULAR and RBD_ERR_NAN forces and velocity terms count as 0.
   Moreau 1999; Hairer, Lubich and Wanner, Geometric Numerical Integration, VII. */
RBDI_API rbd_status rbd_free_step(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                  const rbd_real *tau, const rbd_real *f_ext, const rbd_real *damping,
                                  rbd_real dt, rbd_real *q_next, rbd_real *v_next);
#endif

/* The tangent step d, nv, for which rbd_integrate(q0, d, 1) is q1, with the shortest rotation. */
RBDI_API rbd_status rbd_difference(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real *d);

/* The part s of the way from q0 to q1: q, nq, is rbd_integrate(q0, rbd_difference(q0, q1), s). It turns by
   the shortest rotation, at constant velocity. s = 0 gives q0 and s = 1 gives q1 exactly, with quaternions
   and (cos, sin) made unit. s below 0 or above 1 goes on along the same way. Before s = 1 a quaternion may be
   near -q1, and a planar angle whole turns from q1. q may be q0 or q1. */
RBDI_API rbd_status rbd_interpolate(const rbd_model *m, const rbd_real *q0, const rbd_real *q1, rbd_real s,
                                    rbd_real *q);

/* Distance between two configurations: the square root of the sum of weight_k d_k^2, d =
   rbd_difference(q0, q1). Pinocchio's distance, if weight is NULL.
   weight     nv, not below 0; 0: the dof does not count. NULL: 1, that is, a metre counts as much as a radian
   distance   one number, in radians if lengths have weights of 1 / length^2 (or 0) and angles 1
   Also RBD_ERR_RANGE, a weight that is below 0 or not a number. */
RBDI_API rbd_status rbd_distance(const rbd_model *m, const rbd_real *q0, const rbd_real *q1,
                                 const rbd_const *weight, rbd_real *distance);

/* Rates q' of the coordinates, nq, from the velocity, for filters and ODE solvers: a quaternion's is
   q (omega; 0) / 2, a (cos, sin)'s (-sin, cos) v; their lengths stay. */
RBDI_API rbd_status rbd_rates_from_velocity(const rbd_model *m, const rbd_real *q, const rbd_real *v,
                                            rbd_real *rates);

/* The velocity, nv, from such rates. A change of length of a quaternion or (cos, sin) does not count. */
RBDI_API rbd_status rbd_velocity_from_rates(const rbd_model *m, const rbd_real *q, const rbd_real *rates,
                                            rbd_real *v);

/* A random configuration: uniform within the limits of a joint that has them, else angles in (-pi, pi),
   lengths in (-1, 1) m, orientations uniform. seed: any value; the call advances it. */
RBDI_API rbd_status rbd_random(const rbd_model *m, uint64_t *seed, rbd_real *q);

#endif
