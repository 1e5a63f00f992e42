#ifndef RBDI_API_KINEMATICS_H
#define RBDI_API_KINEMATICS_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- kinematics [kinematics] ---- */

/* Computes poses, velocities and accelerations of all bodies, for the functions below.
   q: nq; v, a: nv, or NULL for zero. The results stay until the next call of rbd_kinematics,
   rbd_body_kinematics, rbd_joint_wrench, or of rbd_constraints.h or rbd_contact.h with the same work.
   Errors: RBD_ERR_NULL, _WORK. */
RBDI_API rbd_status rbd_kinematics(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                   const rbd_real *a);

/* Computes poses, velocities and accelerations of one body, and of the bodies between it and the world, as
   rbd_kinematics does of all. For other bodies, and for sums over all bodies, the functions below then return
   RBD_ERR_ORDER. q: nq; v, a: nv, or NULL for zero.
   Errors: RBD_ERR_NULL, _WORK, _INDEX. */
RBDI_API rbd_status rbd_body_kinematics(const rbd_model *m, rbd_work *w, int body, const rbd_real *q,
                                        const rbd_real *v, const rbd_real *a);

/* Pose of a body: rotation, 3 x 3, from link axes to world axes; p, the link origin in the world, m. Each
   may be NULL. Errors of these four: RBD_ERR_NULL, _WORK, _INDEX, _ORDER. */
RBDI_API rbd_status rbd_body_pose(const rbd_model *m, const rbd_work *w, int body, rbd_real rotation[9],
                                  rbd_real p[3]);

/* Spatial velocity of a body (omega; v of the link origin), link axes. */
RBDI_API rbd_status rbd_body_velocity(const rbd_model *m, const rbd_work *w, int body, rbd_real velocity[6]);

/* Spatial acceleration of a body, link axes, without gravity: d/dt of the components of the velocity. */
RBDI_API rbd_status rbd_body_acceleration(const rbd_model *m, const rbd_work *w, int body,
                                          rbd_real acceleration[6]);

/* Classical acceleration of a body (domega/dt; acceleration of the link origin), link axes, without gravity:
   an accelerometer at the origin measures it minus gravity. */
RBDI_API rbd_status rbd_body_acceleration_classical(const rbd_model *m, const rbd_work *w, int body,
                                                    rbd_real acceleration[6]);

/* Kinetic energy (rotors' included) and potential energy (zero at the world origin), of all bodies
   that a joint moves, J; after rbd_kinematics. Either may be NULL. Errors of these two: RBD_ERR_NULL,
   _WORK, _ORDER. */
RBDI_API rbd_status rbd_energy(const rbd_model *m, const rbd_work *w, rbd_real *kinetic, rbd_real *potential);

/* Centre of mass of all bodies that a joint moves, its velocity and acceleration, world frame; after
   rbd_kinematics. Each may be NULL. Zero if there is no mass. */
RBDI_API rbd_status rbd_com(const rbd_model *m, const rbd_work *w, rbd_real position[3], rbd_real velocity[3],
                            rbd_real acceleration[3]);

/* Mass of all bodies that a joint moves, kg; 0 without a model. */
RBDI_API rbd_const rbd_mass(const rbd_model *m);

/* The wrench (moment; force) that each body's joint transmits, fixed joints too: it loads gears and bearings,
   and a force sensor there measures it. It acts on the body, from its parent, in link axes at the link's
   origin. RBDA table 5.1 with the bodies' own inertias; along the axis it is tau - armature a.
   It calls rbd_kinematics with q, v, a. f_ext: as for rbd_rnea. wrench: nb x 6.
   Errors: RBD_ERR_NULL, _WORK. */
RBDI_API rbd_status rbd_joint_wrench(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                     const rbd_real *a, const rbd_real *f_ext, rbd_real *wrench);

#endif
