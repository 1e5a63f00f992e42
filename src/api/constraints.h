#ifndef RBDI_API_CONSTRAINTS_H
#define RBDI_API_CONSTRAINTS_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

#define rbd_point_contact RBDI_SYMBOL(rbd_point_contact)
#define rbd_flat_contact RBDI_SYMBOL(rbd_flat_contact)
#define rbd_ball_loop RBDI_SYMBOL(rbd_ball_loop)
#define rbd_hinge_loop RBDI_SYMBOL(rbd_hinge_loop)
#define rbd_constraint_set_init RBDI_SYMBOL(rbd_constraint_set_init)
#define rbd_constraint_set_size RBDI_SYMBOL(rbd_constraint_set_size)
#define rbd_constraint_finding_text RBDI_SYMBOL(rbd_constraint_finding_text)
#define rbd_constraint_rows RBDI_SYMBOL(rbd_constraint_rows)
#define rbd_constraint_first RBDI_SYMBOL(rbd_constraint_first)
#define rbd_constraint_rank RBDI_SYMBOL(rbd_constraint_rank)
#define rbd_infeasible_row RBDI_SYMBOL(rbd_infeasible_row)
#define rbd_constraint_jacobian RBDI_SYMBOL(rbd_constraint_jacobian)
#define rbd_constrained_fd RBDI_SYMBOL(rbd_constrained_fd)
#define rbd_impact RBDI_SYMBOL(rbd_impact)
#define rbd_constrained_id RBDI_SYMBOL(rbd_constrained_id)
#define rbd_assemble RBDI_SYMBOL(rbd_assemble)
#define rbd_constrained_fd_derivatives RBDI_SYMBOL(rbd_constrained_fd_derivatives)

/* ---- description [description] ---- */

/* Holds frame 1 to frame 2 along some axes. Zero is a sensible default for every field but the bodies and
   axes. */
typedef struct rbd_constraint {
    const char *name; /* for findings; NULL = nameless */
    int body1, body2; /* index in the description; -1 = world, and also rbd_body_index of an unknown name */
    double rotation1[9]; /* 3 x 3, vectors of frame 1 into those of body 1; all 0 = identity */
    double position1[3]; /* of its origin, m */
    double rotation2[9]; /* the same of frame 2 in body 2 */
    double position2[3];
    int axes[6];   /* 1 = held: omega_x omega_y omega_z v_x v_y v_z, along the axes of frame 2 */
    double kp, kd; /* 1/s^2, 1/s: Baumgarte's stabilisation, J a + gamma = -kd J v - kp e. A time step dt
                      sets bounds: [calls] */
} rbd_constraint;

/* Common constraints. Every field may be changed afterwards. Holds a point of a body at a place: 3 rows,
   forces in world axes. point: body axes, m; place: world, m; NULL = origin. Without kp any place will do. */
RBDI_API rbd_constraint rbd_point_contact(int body, const double point[3], const double place[3]);

/* Holds a surface, the point and the orientation: 6 rows. Without kp any orientation will do. */
RBDI_API rbd_constraint rbd_flat_contact(int body, const double point[3], const double place[3]);

/* Loop joints between two bodies. Ball: point1 and point2, each in its body's axes, coincide; 3 rows. Hinge:
   the lines along axis1 and axis2 there coincide, too; 5 rows, in frames whose z is the axis. An axis of zero
   length is refused as rotation1 or rotation2. */
RBDI_API rbd_constraint rbd_ball_loop(int body1, const double point1[3], int body2, const double point2[3]);
RBDI_API rbd_constraint rbd_hinge_loop(int body1, const double point1[3], const double axis1[3], int body2,
                                       const double point2[3], const double axis2[3]);

/* ---- set [set] ---- */

#define RBD_MAX_CONSTRAINTS 1000

typedef struct rbd_constraint_set rbd_constraint_set; /* constraints that hold together, and scratch */

/* Checks n constraints and prepares them in the caller's memory, for this model and work, which the calls
   use. If contacts come and go, make a set for each phase; the sets may share the work.
   list     n constraints; only their names are needed later; n may be 0
   memory   size bytes of any alignment. RBD_CONSTRAINT_SET_SIZE(nv, rows) suffices, rows: axes held by all;
            RBD_CONSTRAINT_SET_SIZE_OF(nv, n, rows) is nearer; rbd_constraint_set_size is exact
   c        receives the set, which lies inside memory: do not move it; NULL after an error
   report   receives the error: body is the constraint's index, field one of rbd_constraint's; may be NULL
   Errors: RBD_ERR_NULL, _MEMORY, _WORK, _COUNT; of a constraint: _INDEX (a body does not exist, or no joint
   moves one relative to the other), _ROTATION, _POSITION, _AXIS (none held, or neither 0 nor 1), _RANGE. */
RBDI_API rbd_status rbd_constraint_set_init(const rbd_model *m, rbd_work *w, const rbd_constraint *list,
                                            int n, void *memory, size_t size, rbd_constraint_set **c,
                                            rbd_report *report);

/* Bytes that rbd_constraint_set_init needs for these; 0 if n is out of range. */
RBDI_API size_t rbd_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n);

/* As rbd_finding_text, e.g. "constraint 3 'left foot', field 'axes': no axis is held". */
RBDI_API char *rbd_constraint_finding_text(const rbd_finding *finding, char *text, size_t size);

/* Number of rows, axes held by all constraints; and the first row of a constraint, -1 if there is none. */
RBDI_API int rbd_constraint_rows(const rbd_constraint_set *c);
RBDI_API int rbd_constraint_first(const rbd_constraint_set *c, int constraint);

/* The rank that the last call found, with lanes the least of all states: of J at q (rbd_constrained_fd and
   its derivatives, rbd_impact) or at q_near (rbd_assemble); of the columns of J of the joints without motors
   (rbd_constrained_id). rbd_constraint_jacobian does not change it. */
RBDI_API int rbd_constraint_rank(const rbd_constraint_set *c);

/* After RBD_ERR_INFEASIBLE: a row that depends on others and contradicts them, or that rounding hides; else
   -1. If rows depend on each other, the state decides which of them are left out, not their order. If several
   of these contradict the others, this is the first. */
RBDI_API int rbd_infeasible_row(const rbd_constraint_set *c);

/* ---- calls [calls] ----
   q: nq, v, tau, a: nv, f_ext: nb x 6 or NULL; rows: rbd_constraint_rows. An output may be the same array as
   an input of the same shape. Each call overwrites the results of rbd_kinematics in the work. Errors:
   RBD_ERR_NULL, _WORK; _SINGULAR, _NAN and _INFEASIBLE where said. */

/* Jacobian J, rows x nv; gamma, rows; position error e, rows; all three as in [conventions]. Each may be
   NULL, and v for zero. */
RBDI_API rbd_status rbd_constraint_jacobian(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                            const rbd_real *v, rbd_real *jacobian, rbd_real *gamma,
                                            rbd_real *e);

/* Accelerations and constraint forces: M a + c = tau + sum J_b' f_ext + J' lambda and J a + gamma = -kd J v -
   kp e, RBDA section 8.4 and, for kp and kd, 8.3. If rows depend on others (rbd_constraint_rank), a is
   unique and lambda is the solution of least norm.
   lambda   rows; may be NULL
   gains    with steps v += dt a, q += dt v, errors die out only if kd dt < 2 and kp dt^2 + 2 kd dt < 4, and
            grow without bound beyond: [design]. kd = 2 sqrt(kp), kp dt^2 up to 0.1 is a good choice
   Errors: also RBD_ERR_SINGULAR and _NAN of M: rbd_singular_dof says where, and the results are 0;
   RBD_ERR_INFEASIBLE if dependent rows contradict each other, or if rounding hides a row, as an inertia of
   1e-20 kg m^2 on its path may (rbd_infeasible_row): then the first equation holds, and the second in the
   sense of least squares. After RBD_OK each row is met to 1e-9 (float: 1e-3) of what its length times that of
   a allows; only rows that depend on each other may contradict each other by 1e-6 (float: 1e-2), because
   positions drift. A state in which rows depend on each other takes up to four times as long as one in which
   they do not. */
RBDI_API rbd_status rbd_constrained_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *lambda);

/* Velocity after an impact: M (v_plus - v) = J' impulse, J v_plus = -restitution J v, RBDA section 11.7.
   restitution   0 (nothing rebounds) to 1, of all rows
   impulse       rows; may be NULL
   Errors: RBD_ERR_SINGULAR, _NAN as rbd_constrained_fd; RBD_ERR_RANGE, a restitution that is not from 0 to 1;
   RBD_ERR_INFEASIBLE only if rounding hides a row: dependent rows never contradict each other here. */
RBDI_API rbd_status rbd_impact(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                               const rbd_real *v, rbd_real restitution, rbd_real *v_plus, rbd_real *impulse);

/* Inverse dynamics with contacts: M a + c = tau + sum J_b' f_ext + J' lambda, where only some joints have
   motors. Among all lambda with tau = 0 at the other joints (a free base), takes the one with the least sum
   of weight lambda^2. If there is none, takes the nearest (least squares); tau of these joints is what is
   missing. The caller must check lambda: a foot may be asked to pull.
   a          nv, wanted, with J a + gamma = 0: for example the result of rbd_constrained_fd with another set,
              in which rows with gains describe the task, too
   actuated   nv flags: not 0 where there is a motor; NULL: everywhere but in floating joints
   weight     rows, 0 (lambda costs nothing) or 1e-20 to 1e30; NULL: 1
   Errors: also RBD_ERR_RANGE, a weight out of its range. Mistry, Buchli and Schaal (2010). */
RBDI_API rbd_status rbd_constrained_id(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                       const unsigned char *actuated, const rbd_const *weight, rbd_real *tau,
                                       rbd_real *lambda);

/* Closes loops, or puts feet in their places: computes q_near near q, with e = 0, and v_near with J v_near
   = 0 there, the one with the least sum of weight (v_near - v)^2.
   q_near is a stationary point of the distance: with d = rbd_difference(q, q_near), the vector weight d is a
   combination of the rows of de/dq, which are those of J but for single angular axes. If all joints have one
   degree of freedom, it is the nearest place, or nearer than all places around it; with other joints nearly
   so, the more the smaller d is. Newton's method finds it from q. Far from any solution it may find none, or
   another one. In a singular place, where rows lose their rank, q_near may only be close.
   q_near   another array than q
   v        may be NULL, v_near then too
   weight   nv, 0 (a free dof: its motion costs nothing) or 1e-20 to 1e30; NULL: 1, that is, a metre counts
            as much as a radian
   Errors: also RBD_ERR_RANGE, a weight out of its range, or weights so far apart (1e20; float: 1e8) that a
   row is lost beside others; RBD_ERR_INFEASIBLE if an entry of e is not below 1e-9 (float: 1e-4), the largest
   in rbd_infeasible_row, or if v_near does not meet a row. */
RBDI_API rbd_status rbd_assemble(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                 const rbd_real *v, const rbd_const *weight, rbd_real *q_near,
                                 rbd_real *v_near);

#endif
