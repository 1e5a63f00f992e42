#ifndef RBDI_API_POINTS_H
#define RBDI_API_POINTS_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- points and momentum [points] ----
   After rbd_kinematics or, for its bodies, rbd_body_kinematics, at its q, v and a. A point is fixed in a
   body: 3 components in link axes, NULL for the link origin. Its motion: (omega of the body; velocity of the
   point), along world axes or link axes.
   Errors: RBD_ERR_NULL, _WORK, _INDEX, _ORDER. */

typedef enum rbd_axes { RBD_WORLD_AXES, RBD_LINK_AXES } rbd_axes;

/* Jacobian of a point, 6 x nv: its motion is J v. Columns of dofs that do not move the body are zero.
   Siciliano, Sciavicco, Villani and Oriolo, Robotics (2009), section 3.1. */
RBDI_API rbd_status rbd_jacobian(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                 rbd_axes axes, rbd_real *jacobian);

/* Jacobian of a point of a body relative to another body, the reference (-1: the world), 6 x nv: J v is
   the motion of the point less that of the reference's point at the same place. RBD_LINK_AXES: the
   reference's. */
RBDI_API rbd_status rbd_relative_jacobian(const rbd_model *m, const rbd_work *w, int body,
                                          const rbd_real point[3], int reference, rbd_axes axes,
                                          rbd_real *jacobian);

/* tau = J' f, nv, for a wrench f (moment about the point; force) along these axes, without computing J. */
RBDI_API rbd_status rbd_jacobian_transpose(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, const rbd_real f[6],
                                           rbd_real *tau);

/* Position of a point in the world, m. */
RBDI_API rbd_status rbd_point_position(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_real position[3]);

/* Motion of a point, J v. */
RBDI_API rbd_status rbd_point_velocity(const rbd_model *m, const rbd_work *w, int body,
                                       const rbd_real point[3], rbd_axes axes, rbd_real velocity[6]);

/* (domega/dt; classical acceleration of the point), without gravity: J a + dJ/dt v, J along world axes.
   With a = NULL in rbd_kinematics it is the bias dJ/dt v. */
RBDI_API rbd_status rbd_point_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                           const rbd_real point[3], rbd_axes axes, rbd_real acceleration[6]);

/* Converts a wrench f (moment about the point; force) along these axes to a row of f_ext, that of the body:
   f_ext + 6 body. Add up the rows of several points. row may be f. */
RBDI_API rbd_status rbd_point_wrench(const rbd_model *m, const rbd_work *w, int body, const rbd_real point[3],
                                     rbd_axes axes, const rbd_real f[6], rbd_real row[6]);

/* Centroidal momentum h (angular, about the centre of mass; linear) of all bodies that a joint moves, and its
   rate h_dot, world axes. Either may be NULL. Rotors (armature) have none. Orin, Goswami and Lee (2013).
   The wrench of the world on the robot, without gravity, is n = h_dot[0..2] about the centre of mass and f =
   h_dot[3..5] - rbd_mass(m) gravity. On a ground z = 0 the zero-moment point is (c_x - (n_y + c_z f_x) / f_z,
   c_y + (n_x - c_z f_y) / f_z, 0), with c from rbd_com. */
RBDI_API rbd_status rbd_momentum(const rbd_model *m, const rbd_work *w, rbd_real h[6], rbd_real h_dot[6]);

#endif
