#ifndef RBDI_API_CONTACT_H
#define RBDI_API_CONTACT_H
#include "api/constraints.h"

#define rbd_contact_solve_size RBDI_SYMBOL(rbd_contact_solve_size)
#define rbd_contact_solve RBDI_SYMBOL(rbd_contact_solve)
#define rbd_contact_set_init RBDI_SYMBOL(rbd_contact_set_init)
#define rbd_contact_finding_text RBDI_SYMBOL(rbd_contact_finding_text)
#define rbd_contact_set_size RBDI_SYMBOL(rbd_contact_set_size)
#define rbd_contact_step RBDI_SYMBOL(rbd_contact_step)
#define rbd_contact_fd RBDI_SYMBOL(rbd_contact_fd)
#define rbd_contact_plane RBDI_SYMBOL(rbd_contact_plane)
#define rbd_contact_friction RBDI_SYMBOL(rbd_contact_friction)
#define rbd_contact_row_set RBDI_SYMBOL(rbd_contact_row_set)
#define rbd_contact_row_get RBDI_SYMBOL(rbd_contact_row_get)
#define rbd_contact_inertia RBDI_SYMBOL(rbd_contact_inertia)
#define rbd_contact_reset RBDI_SYMBOL(rbd_contact_reset)
#define rbd_contact_get RBDI_SYMBOL(rbd_contact_get)
#define rbd_contact_last RBDI_SYMBOL(rbd_contact_last)

typedef enum rbd_contact_state {
    RBD_APART,  /* not a row of the problem: too far away, or nothing that it touches can move */
    RBD_OPENS,  /* may touch, but does not push */
    RBD_STICKS, /* pushes, and does not move along the plane */
    RBD_SLIPS   /* moves along the plane, and friction brakes it */
} rbd_contact_state;

/* ---- solver [solver] ----
   Impulses p of contacts from u = Delta p + b and the laws of [conventions], for a caller's own Delta. */

typedef struct rbd_contact_problem {
    int contacts;             /* three rows each, in the order tangent, tangent, normal */
    int bounded;              /* rows behind those, one each: joint limits, dry friction, held axes */
    const rbd_real *delta;    /* rows x rows: J M^-1 J', symmetric and positive semidefinite, 1/kg */
    const rbd_real *b;        /* rows: u where p = 0, m/s */
    const rbd_real *friction; /* contacts: mu, not negative */
    const rbd_real *lower;    /* bounded rows: lower <= p <= upper; +-1e30 where there is no bound */
    const rbd_real *upper;
    rbd_real tolerance; /* of the residual, m/s; 0 is the default, 1e-6, of float 1e-5 */
    int iterations;     /* sweeps and Newton steps at most; 0 is the default, 40 */
} rbd_contact_problem;

typedef struct rbd_contact_solution {
    rbd_real residual; /* m/s, of p: 0 where all laws hold. [one contact], [laws] */
    int sweeps;        /* Gauss-Seidel's */
    int newton_steps;  /* each with one factorisation at least */
} rbd_contact_solution;

/* Bytes of memory that rbd_contact_solve needs for such a problem; 0 if a number is out of range. */
RBDI_API size_t rbd_contact_solve_size(int contacts, int bounded);

/* Solves the problem. One that is not solved is no error: the residual is above the tolerance then. p is
   finite and, to rounding, within cones and bounds in any case.
   memory     size bytes of any alignment, scratch
   p          rows: where to begin (0, or the solution before), then the solution, N s
   state      contacts: what each does; may be NULL
   solution   may be NULL
   Errors: RBD_ERR_NULL, _MEMORY; _COUNT, a number below 0, or 46,000 rows and more: their matrix has no int
   for an index; _RANGE, a friction, tolerance or number of iterations below 0, or a lower bound above the
   upper one; _NAN, an entry of delta, b or p is not finite: p = 0. */
RBDI_API rbd_status rbd_contact_solve(const rbd_contact_problem *problem, void *memory, size_t size,
                                      rbd_real *p, rbd_contact_state *state, rbd_contact_solution *solution);

/* ---- set [set] ---- */

/* A point of body 1, or a ball about it, that may touch a plane of body 2. Zero is a sensible default for
   every field but the bodies. body2 = 0 without on_body is refused: it may have been left out where the world
   was meant. */
typedef struct rbd_contact {
    const char *name;   /* for findings; NULL = nameless */
    int body1, body2;   /* index in the description, -1 = world */
    double point[3];    /* axes of body 1, m */
    double radius;      /* m; 0 = a point */
    double normal[3];   /* of the plane, axes of body 2, towards body 1; of any length; all 0 = z */
    double height;      /* of the plane along the unit normal, m */
    double friction;    /* mu */
    double restitution; /* 0 (does not rebound) to 1 */
    double stiffness;   /* N/m: p/dt = -(stiffness gap + damping d gap/dt); 0 = rigid */
    double damping;     /* N s/m; refused without a stiffness */
    int on_body;        /* not 0: the plane is a body's, body2, and not the world's; body 0 needs it */
} rbd_contact;

/* 0 is the default in brackets. */
typedef struct rbd_contact_options {
    double margin; /* closer contacts are rows, m [0.005]; others where they may arrive within two steps */
    double slop;   /* penetration that is left, m [1e-5] */
    double correction;  /* share of the rest that a step corrects, up to 1 [0.2] */
    double bounce;      /* slower impacts do not rebound, m/s [0.05]; choose more than 2 g dt */
    double tolerance;   /* of the residual, m/s [1e-6, float 1e-5] */
    int iterations;     /* of each solution at most [40]; a step has two, or three where something rebounds */
    int joint_limits;   /* not 0: limits of joints push, those of their followers too */
    int joint_friction; /* not 0: the description's friction of each degree of freedom holds, or brakes */
    int joint_damping;  /* not 0: the description's damping, implicitly */
    double slip;        /* contacts that stick give way along the plane, m/s per newton [0] */
    int derivatives;    /* not 0: memory for rbd_contact_step_derivatives */
    int first_order;    /* not 0: steps of semi-implicit Euler, q_next is q moved by v_next: for planners */
    int momentum;       /* not 0: robots that float keep their momentum to rounding while nothing touches;
                           refused with first_order */
    int rows;           /* bounded rows of the caller's, for rbd_contact_row_set [0] */
} rbd_contact_options;

/* A bounded row: a shaft with its friction, a bristle, a brake. Its force f acts on its dofs by J' f, and

       lower <= f <= upper,   s > 0 only if f = lower,   s < 0 only if f = upper,
       s = J v_next + bias + compliance dt f

   So between its bounds it sticks, s = 0; at one it may slip. Dry friction, without bias and compliance, that
   turns around within a step has less force in it, so that it makes no energy. */
typedef struct rbd_contact_row {
    int dofs;             /* number of its dofs: 1 to 3; 0: it does nothing */
    int dof[3];           /* each once */
    rbd_real jacobian[3]; /* J: speed of the row per speed of each dof, in the middle of the step */
    rbd_real bias;        /* rad/s or m/s */
    rbd_real lower;       /* N m or N; +-1e30 and beyond: no bound */
    rbd_real upper;
    rbd_real compliance; /* speed per impulse, 1/(kg m^2) or 1/kg; 0 = rigid */
} rbd_contact_row;

typedef struct rbd_contact_set rbd_contact_set; /* contacts, impulses of the last step, scratch */

/* Checks contacts and prepares them in the caller's memory, for this model and work, which the calls use.
   list      n contacts, not needed later but for their names
   held      n_held constraints that hold at the same time: loops, feet that are bolted down. Their kp and kd
             have no meaning here; position errors are corrected as penetration is. May be NULL
   options   NULL: all defaults
   memory    size bytes of any alignment; rbd_contact_set_size is exact. For n contacts and `bounded` other
             rows (held axes, two limits of each joint, dry friction, the option `rows`)
             RBD_CONTACT_SET_SIZE(nv, n, bounded) suffices without the option `derivatives`
   c         receives the set, which lies inside memory: do not move it; NULL after an error
   Errors: RBD_ERR_NULL, _MEMORY, _WORK, _COUNT (more than RBD_MAX_CONSTRAINTS); with the contact in
   report->error.body: _INDEX, _POSITION (point or height), _AXIS (normal), _RANGE; with a constraint, n + its
   index there: those of rbd_constraint_set_init; _RANGE, an option. rbd_contact_finding_text has the
   sentence. */
RBDI_API rbd_status rbd_contact_set_init(const rbd_model *m, rbd_work *w, const rbd_contact *list, int n,
                                         const rbd_constraint *held, int n_held,
                                         const rbd_contact_options *options, void *memory, size_t size,
                                         rbd_contact_set **c, rbd_report *report);

/* As rbd_finding_text, e.g. "contact 3 'left toe', field 'friction': negative, not finite or out of range".
   n   number of contacts in the list: the constraints behind them are held constraint 0, 1, ... */
RBDI_API char *rbd_contact_finding_text(const rbd_finding *finding, int n, char *text, size_t size);

/* Bytes that rbd_contact_set_init needs for these; 0 if a number is out of range. */
RBDI_API size_t rbd_contact_set_size(const rbd_model *m, int n, const rbd_constraint *held, int n_held,
                                     const rbd_contact_options *options);

/* ---- step [step] ----
   q: nq, v, tau, damping: nv, f_ext: nb x 6 or NULL. An output may be the same array as the input of its
   name.
   damping    implicit: tau acts as tau - damping v_next. A position controller of gains kp, kd that runs with
              the step has tau = kp (q_wanted - q) and damping = kd + dt kp / 2, which is neutral: it neither
              adds nor takes energy beyond kd. kd + dt kp is stable at every dt, and brakes. NULL: 0
   Errors: RBD_ERR_NULL, _WORK; _MASSLESS, of a model for kinematics alone; _RANGE, dt not between 1e-30 and
   1e30; _SINGULAR if M + dt D is, D the damping: damping makes a joint sound that moves no mass; _NAN as
   rbd_constrained_fd, _NAN also of q or a gap that is not a number and of speeds above 1e12: then q_next is
   q, v_next or a is 0, and the set is as after rbd_contact_reset. A solution above the tolerance is no error:
   rbd_contact_last. */

/* One time step dt by the midpoint scheme of Moreau (1999), of second order: half of the way by v, to q_mid;
   there, with v in its axes,

       M (nu - v) = dt (tau - c(w) + sum J_b' f_ext - damping nu) + J' p,   w = (v + nu) / 2,
       laws of contact between u + bias and p

   where u is the velocity of the end along the rows; the other half by nu; v_next is nu in the axes of the
   end. f_ext acts in the axes that bodies have in the middle. The bias lets contacts close their gap, makes
   stiff ones springs and dampers, and reverses approaches that rebound. Penetration is corrected in
   positions alone, by a second solution with the same Delta, so that it gives no velocity. Energy is kept
   to second order in dt: docs/contact_step.md says when it is made or taken, and how much. */
RBDI_API rbd_status rbd_contact_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                     const rbd_real *damping, rbd_real dt, rbd_real *q_next,
                                     rbd_real *v_next);

/* The acceleration at q and v with which a step of first order, rbd_step, obeys the laws at its end; for
   schemes of your own. rbd_contact_step differs from that step by O(dt^2). */
RBDI_API rbd_status rbd_contact_fd(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                   const rbd_real *damping, rbd_real dt, rbd_real *a);

/* Changes the plane of contact i, as in rbd_contact, from the next step on: to the tangent plane of terrain.
   Errors: RBD_ERR_NULL, _WORK, _INDEX, _AXIS, _POSITION. */
RBDI_API rbd_status rbd_contact_plane(const rbd_model *m, rbd_contact_set *c, int i, const double normal[3],
                                      double height);

/* Changes the dry friction of a dof, from the next step on: of a motor that is loaded, or warm. The set has a
   row for it if the option `joint_friction` is on and the description's friction there is above 0.
   bound      largest force, N m or N; 0: none
   Errors: RBD_ERR_NULL, _WORK; _INDEX, no such row; _RANGE, negative or not finite. */
RBDI_API rbd_status rbd_contact_friction(const rbd_model *m, rbd_contact_set *c, int dof, rbd_real bound);

/* Changes bounded row i of the option `rows`, from the next step on; until then it does nothing. See
   docs/contact_step.md, Bounded rows: friction of shafts, bristles, brakes.
   Errors: RBD_ERR_NULL, _WORK; _INDEX, no row i, or a dof that is not there or twice; _COUNT, dofs; _RANGE,
   not finite, a compliance below 0, lower > upper. Then the row is as it was. */
RBDI_API rbd_status rbd_contact_row_set(const rbd_model *m, rbd_contact_set *c, int i,
                                        const rbd_contact_row *row);

/* Returns what bounded row i of the caller's did in the last step: RBD_STICKS, s = 0; RBD_SLIPS, it moved;
   RBD_APART, nothing: it has no force, or moves nothing, or there is no such row.
   force      f, N m or N; may be NULL */
RBDI_API rbd_contact_state rbd_contact_row_get(const rbd_contact_set *c, int i, rbd_real *force);

/* Adds a matrix to M, from the next step on: rotors that several joints drive, G' J G; with dt G' D G their
   damping is implicit, if tau has -G' D G v. It does not depend on q within a step, has no velocity terms,
   and multiplies the change of v.
   added      rbd_packed_size, as of rbd_crba_packed: M + added is positive definite. Kept, not copied: it
              must be there in the steps. NULL: nothing
   Errors: RBD_ERR_NULL, of m or c; _WORK; one that is not finite is RBD_ERR_NAN of the step. */
RBDI_API rbd_status rbd_contact_inertia(const rbd_model *m, rbd_contact_set *c, const rbd_real *added);

/* Clears the last impulses, with which a step begins; rbd_contact_get then returns RBD_APART, gaps of 0 and
   no force. Call it after a jump of the state. */
RBDI_API void rbd_contact_reset(rbd_contact_set *c);

/* Returns the state of contact i in the last step; RBD_APART without such a contact.
   gap        before the step, m, to third order in dt where the contact moves; may be NULL
   force      p/dt on body 1, world axes, N; may be NULL */
RBDI_API rbd_contact_state rbd_contact_get(const rbd_contact_set *c, int i, rbd_real *gap, rbd_real force[3]);

/* Residual and iterations of the last step: the residual is that of positions and velocities, iterations
   are all; all 0 without a set or step. */
RBDI_API rbd_contact_solution rbd_contact_last(const rbd_contact_set *c);

#endif
