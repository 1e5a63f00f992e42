#ifndef RBDI_API_MODEL_H
#define RBDI_API_MODEL_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- build [build] ---- */

#define RBD_MAX_BODIES 1000

#ifndef RBD_NO_BUILD

/* Builds a model from a description into the caller's memory.
   bodies   nb rows, parents first; only its strings must outlive the model
   memory   size bytes of any alignment; RBD_MODEL_SIZE(nb) always suffices
   model    receives the model, which lies inside memory: do not move it; NULL after an error
   report   receives the error and the warnings; may be NULL
   Errors: RBD_ERR_NULL, _MEMORY, _COUNT, and all from RBD_ERR_NAME on, with body and field. */
RBDI_API rbd_status rbd_model_build(const rbd_body *bodies, int nb, void *memory, size_t size,
                                    const rbd_model **model, rbd_report *report);

/* The same for kinematics alone: joints may move no mass, as in a robot whose file has geometry only. If each
   joint moves mass, inertia or armature, or one does that mimics it, the model is that of rbd_model_build.
   Otherwise all calls that need masses return RBD_ERR_MASSLESS, and rbd_singular_dof says which joint moves
   none. Poses, velocities, accelerations, Jacobians, inverse kinematics, coordinates, rows of constraints and
   rbd_assemble are computed as for any model. Errors: those of rbd_model_build but RBD_ERR_LEAF. */
RBDI_API rbd_status rbd_model_build_kinematic(const rbd_body *bodies, int nb, void *memory, size_t size,
                                              const rbd_model **model, rbd_report *report);

/* Bytes that rbd_model_build needs for this description; 0 if nb is out of range. */
RBDI_API size_t rbd_model_size(const rbd_body *bodies, int nb);

/* Adds a payload, such as an object in the hand, to a body of a built model. Later results are those of a new
   build, to rounding. It costs a step for each link on the way to the root. To take the payload off, add it
   with mass and inertia negated. Every rbd_work and set of constraints stays valid; but make a set anew after
   taking off mass that the model was built with. Make every rbd_derivatives anew: it has copies of masses. A
   model for kinematics alone stays one: if its joints move mass now, build it anew. No other call may use the
   model meanwhile. A model in a table of constants cannot be changed.
   memory   the memory that was given to rbd_model_build
   mass     kg, may be negative
   com      centre of mass of the payload, link frame, m
   inertia  xx xy xz yy yz zz about that, link axes, kg m^2; NULL = a point mass
   Errors, which leave the model as it was: RBD_ERR_NULL, _VERSION (no model there), _INDEX; _MASS, _COM,
   _INERTIA if not finite; _MASS if the body's mass would be negative, _INERTIA if its inertia would have a
   negative eigenvalue. */
RBDI_API rbd_status rbd_add_payload(void *memory, int body, double mass, const double com[3],
                                    const double inertia[6]);

/* Holds joints of a description still. The row of each joint whose flag is set, and of those that mimic it,
   becomes a fixed joint at the pose that the joint has at q. All bodies stay, with their names and indices.
   The new model's q and v are those of the joints that still move, in the same order. Its dynamics is that of
   the whole model with v = a = 0 of the held joints.
   bodies   nb rows, as for rbd_model_build; those of a built model come from rbd_describe
   locked   nb flags: not 0 where the body's joint shall be held; without effect on a fixed one
   q        nq, of all joints of the description. Only those of held joints, and of joints that these mimic,
            are read. Limits do not count
   rows     nb rows, receives the description with fixed joints; may be bodies. An error leaves it as it was
   report   receives the error and the warnings; may be NULL
   Errors: RBD_ERR_NULL, _COUNT; RBD_ERR_RANGE, with the body, if a coordinate of a held joint is not finite;
   all of rbd_model_build that one row can have, with body and field. */
RBDI_API rbd_status rbd_lock_joints(const rbd_body *bodies, int nb, const unsigned char *locked,
                                    const double *q, rbd_body *rows, rbd_report *report);

#endif

/* ---- work [work] ---- */

/* Prepares the memory that the algorithms work in; one per thread and model. It serves every model with
   arrays of the same lengths, such as a copy. With a model of other lengths, including one rebuilt in
   the same memory, each call returns RBD_ERR_WORK.
   memory   size bytes of any alignment; RBD_WORK_SIZE(nb, nv) always suffices, with mimic joints
            RBD_WORK_SIZE_MIMIC(nb, nv)
   work     receives the work structure, which lies inside memory: do not move it; NULL after an error
   Errors: RBD_ERR_NULL, _MEMORY, _VERSION, _LEFT_OUT, _ARITHMETIC. */
RBDI_API rbd_status rbd_work_init(const rbd_model *m, void *memory, size_t size, rbd_work **work);

/* Bytes that rbd_work_init needs for this model. */
RBDI_API size_t rbd_work_size(const rbd_model *m);

/* Sets gravity, a vector in the world frame, m/s^2, for the calls that follow. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_set_gravity(rbd_work *w, const rbd_const gravity[3]);

/* Reads the gravity that is set, m/s^2. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_get_gravity(const rbd_work *w, rbd_const gravity[3]);

/* Returns, after RBD_ERR_SINGULAR or RBD_ERR_NAN, the degree of freedom (index into v) whose pivot is not
   above its rounding, or not a number; of several the last. After RBD_ERR_NAN the cause is q of a joint
   that this dof moves, or of its own joint if that has several dofs, or an overflow there. -1 after a call
   that factors M and finds it regular: then RBD_ERR_NAN of rbd_contact_step came from v, tau, f_ext, damping,
   a gap, or a coordinate that M does not depend on, as the place of a floating root. Other calls do not
   change it. With lanes: of all states together. After RBD_ERR_MASSLESS the first degree of freedom that
   moves no mass. */
RBDI_API int rbd_singular_dof(const rbd_work *w);

#endif
