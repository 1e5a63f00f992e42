/* rbd_contact.h - contacts that push only and slip: a time step of a simulation, on rbd_constraints.h.
   Made by src/amalgamate.py from src/rbd_contact.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Points and balls on bodies touch planes of the world or of other bodies, with friction. A step finds the
   impulses by the exact laws of Signorini and Coulomb, with those of joint limits, of dry friction of joints
   and of bounded rows of yours, and moves the robot. Implemented by the same RBD_IMPLEMENTATION as rbd.h, in
   the same file. A box of which two corners may touch the ground:

       #define RBD_IMPLEMENTATION
       #include "rbd_contact.h"

       const rbd_contact corners[2] = {
           {.body1 = 0, .body2 = -1, .point = {0.2, 0.1, -0.1}, .friction = 0.5},
           {.body1 = 0, .body2 = -1, .point = {0.2, -0.1, -0.1}, .friction = 0.5}};
       size_t size = rbd_contact_set_size(m, 2, NULL, 0, NULL);
       rbd_contact_set *c;
       rbd_contact_set_init(m, w, corners, 2, NULL, 0, NULL, malloc(size), size, &c, NULL);
       for (int i = 0; i < 1000; i++)
           rbd_contact_step(m, c, q, v, tau, NULL, NULL, 1e-3, q, v);

   CONTENTS (search for the tag)
     [conventions] [configuration] [limits]
     [solver] [set] [step] [step derivatives]
     --- stop here if you only use it ---
     [layout] [tolerances] [one contact] [laws] [newton] [solver code]
     [joints] [bounded rows] [set code] [contact rows] [biases] [row reduction]
     [momentum code] [step code]
     [step derivatives code]

   [conventions] Beyond those of rbd.h:
     u            velocity of body 1's point of contact less that of body 2's at this place, m/s
     place        of contact: the point, or that of the ball next to the plane; where three contacts or more
                  of the same two bodies touch, its foot on the plane
     p            impulse on body 1 at this place, N s; the opposite acts on body 2
     rows         of a contact: two tangents, then the normal, out of body 2 into body 1
     gap          distance of point or ball from the plane, m; below 0 in penetration
     laws         normal: p_n >= 0, u_n >= 0, p_n u_n = 0; friction: |p_t| <= mu p_n, and where a contact
                  slips u_t = -alpha p_t, alpha > 0, |p_t| = mu p_n. Stewart and Trinkle (1996), Anitescu and
                  Potra (1997), here with the round cone. Of a bounded row: lower <= p <= upper; u > 0 only
                  at the lower bound, u < 0 only at the upper one

   [configuration] That of rbd.h, without RBD_NO_CHOLESKY, RBD_LANES and RBD_REAL_CUSTOM: the solver branches
     on its data.

   [limits]
     No collision detection, no rolling and torsional friction, no batches; planes are infinite. Convergence
     of the solver is not proven, nor is the solution unique where friction is large; the residual says what
     was reached. The step is of second order between impacts, of first order in impacts, in dampers and in
     what a controller samples. Energy is made by O(dt^2) at most, some 1e-6 of it at 1 ms, but for rebounds
     with friction: they follow Newton's law, which may gain energy in known examples.
*/
#include "rbd_constraints.h"

#ifndef RBD_CONTACT_H
#define RBD_CONTACT_H

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_contact.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/contact.h ==== */
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

/* ==== src/rbd_contact.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_CONTACT_H */

#if defined RBD_DERIVATIVES_H && !defined RBDI_CONTACT_DERIVATIVES
#define RBDI_CONTACT_DERIVATIVES
RBDI_EXTERN_C_BEGIN

/* ==== src/api/contact_derivatives.h ==== */
#define rbd_contact_step_derivatives RBDI_SYMBOL(rbd_contact_step_derivatives)

/* ---- derivatives [step derivatives] ----
   Declared where rbd_derivatives.h is included too. */

/* Arrays for the results of rbd_contact_step_derivatives. NULL: not wanted. */
typedef struct rbd_contact_step_results {
    rbd_real *q_next, *v_next;                        /* nq, nv: as rbd_contact_step gives them */
    rbd_real *dq_next_dq, *dq_next_dv, *dq_next_dtau; /* nv x nv */
    rbd_real *dv_next_dq, *dv_next_dv, *dv_next_dtau; /* nv x nv */
} rbd_contact_step_results;

/* Makes a step and differentiates q_next (row k: along its dof k) and v_next by q (column k: q moves with
   unit velocity of dof k), v and tau. f_ext stays fixed in its bodies' axes, planes of the world and damping
   as they are. The state of each contact and bounded row is held: where one is about to change, these are the
   derivatives on one side.
   c            with the option `derivatives`
   d            of the same work
   out          dq_next_... each with its dv_next_..., both or neither NULL; no two the same array
   The step and its derivatives are those without the option `momentum`. Beyond two radians a step, where the
   corrections of velocity terms diverge, derivatives are those without the sum of their series.
   If redundant points slip and turn at once, the motion depends on shares of force that are not unique: these
   are derivatives for one choice.
   Errors: as rbd_contact_step; RBD_ERR_WORK also if d has another work; RBD_ERR_MEMORY without the option;
   RBD_ERR_SINGULAR also where impulses have no derivative. Then q_next is q, and all else is 0. */
RBDI_API rbd_status rbd_contact_step_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                                 const rbd_real *q, const rbd_real *v, const rbd_real *tau,
                                                 const rbd_real *f_ext, const rbd_real *damping, rbd_real dt,
                                                 const rbd_contact_step_results *out);

/* ==== src/rbd_contact.h ==== */
RBDI_EXTERN_C_END
#endif

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

/* ==== src/base/letters_begin.h ==== */
#pragma push_macro("A")
#undef A
#pragma push_macro("B")
#undef B
#pragma push_macro("D")
#undef D
#pragma push_macro("E")
#undef E
#pragma push_macro("F")
#undef F
#pragma push_macro("G")
#undef G
#pragma push_macro("H")
#undef H
#pragma push_macro("L")
#undef L
#pragma push_macro("M")
#undef M
#pragma push_macro("Q")
#undef Q
#pragma push_macro("R")
#undef R
#pragma push_macro("S")
#undef S
#pragma push_macro("X")
#undef X
#pragma push_macro("Y")
#undef Y

/* ==== src/rbd_contact.h ==== */
#ifndef RBDI_CONTACT_LAYOUT
#define RBDI_CONTACT_LAYOUT

/* ==== src/contact/layout.h ==== */
/* ---- layout [layout] ---- */

/* One contact of a problem: its block of Delta, D = [A c; c' d], and quantities of [one contact]. */
typedef struct rbdi_contact_law {
    rbd_real A[3], c[2], d; /* A: xx xy yy */
    rbd_real rigid, trace;  /* d and D's trace without the spring of a set's contact: rounding is of these */
    rbd_real l[2], axis[2]; /* of S = A - c c'/d: eigenvalues, and the eigenvector of the first */
    rbd_real k[2];          /* components of c/d along the eigenvectors of S */
    rbd_real friction;      /* mu */
    rbd_real alpha;         /* u_t = -alpha p_t when it last slipped, 1/kg; 0 before */
    rbd_real e[2];          /* direction of friction */
    rbd_contact_state state;
} rbdi_contact_law;

/* An unknown of a Newton step, [newton]: it changes p by `column`, and its equation is `row` times u = 0,
   both in so many rows of the problem from row `first` on. */
typedef struct rbdi_contact_unknown {
    int first, rows;
    rbd_real column[3], row[3];
    rbd_real alpha; /* added to the diagonal */
    rbd_real scale; /* of the diagonal's entry: the factor of `proximal` */
} rbdi_contact_unknown;

/* A problem that is being solved. */
typedef struct rbdi_contact_solver {
    rbd_contact_problem given;
    int rows;
    rbdi_contact_law *law;         /* contacts */
    rbd_contact_state *bound;      /* bounded rows: RBD_STICKS between the bounds, else RBD_OPENS */
    rbd_real *p, *u;               /* rows: p is the caller's */
    rbd_real *start, *full, *best; /* rows: p before a Newton step, after all of it, and the best p */
    rbd_real *scratch;             /* rows */
    rbdi_contact_unknown *unknown; /* rows */
    rbd_real *G;                   /* the matrix of a Newton step, and behind it its right-hand sides */
    int unknowns, sides, stride;   /* of G: rows; right-hand sides; entries from one row to the next */
    int symmetric;                 /* whether G is: no contact slips */
    rbd_real unmoved;              /* smaller entries of a bounded row on Delta's diagonal are rounding */
    rbd_contact_solution solution;
} rbdi_contact_solver;

#define RBDI_CONTACT_SOLVER_BYTES(contacts, bounded) \
    (RBDI_ALIGN + RBDI_ROUND((size_t)(contacts) * sizeof(rbdi_contact_law)) + \
     RBDI_ROUND((size_t)(bounded) * sizeof(rbd_contact_state)) + \
     RBDI_ROUND(RBDI_CONTACT_ROWS(contacts, bounded) * sizeof(rbdi_contact_unknown)) + \
     sizeof(rbd_real) * RBDI_CONTACT_ROWS(contacts, bounded) * \
         (5 + RBDI_CHUNK + RBDI_CONTACT_ROWS(contacts, bounded)))
#define RBDI_CONTACT_ROWS(contacts, bounded) (3 * (size_t)(contacts) + (size_t)(bounded))

/* A distance that a row keeps from being negative, m or rad: at the step's beginning, its rate there, and
   what it would be at the end if the velocity of the end were 0. */
typedef struct rbdi_gap {
    rbd_real start, rate, reach;
} rbdi_gap;

/* A contact of a set. */
typedef struct rbdi_contact {
    rbdi_c3 point; /* link axes */
    rbd_const radius, friction, restitution, stiffness, damping;
    rbdi_gap gap;
    rbd_real falls;             /* u_n that forces would add in the step without impulses, m/s */
    rbd_real below;             /* the place of contact is so far below the centre, m: l of [contact rows] */
    rbd_real middle;            /* the ball's gap in the middle of the step, m */
    rbdi_motion velocity, rate; /* in the middle of the step, of the body relative to the plane, world axes:
                                   omega and velocity at the place of contact; domega/dt and gamma */
    rbd_real force[3];          /* of the last step, world axes */
    int body2;
    int row;      /* of the step, -1 = none */
    int on_plane; /* whether the place of contact is the foot of the centre on the plane */
    int pushes;   /* whether it does in a solution of the step */
    int springs;  /* whether its stiffness acts in the step */
    int rebounds; /* whether the solution for the velocities returns a share of its approach */
    rbd_contact_state state;
} rbdi_contact;

/* A limit of a joint of one degree of freedom. */
typedef struct rbdi_limit_row {
    int16_t dof, iq;        /* and index of the coordinate */
    rbd_const lower, upper; /* rad or m */
    rbdi_gap gap;           /* to the limit */
    rbd_real side;          /* the row's sign: 1 at the lower limit, -1 at the upper one */
    int row;                /* of the step, -1 = none */
    int rebounds;           /* as of a contact: a limit does if it leaves */
} rbdi_limit_row;

/* A row with bounds on its force: the dry friction of a degree of freedom, or the caller's. */
typedef struct rbdi_bounded_row {
    rbd_contact_row law;
    rbd_real turn;  /* added to the bias: the speed before, if dry friction turns around in the step */
    rbd_real force; /* of the last step, as its state */
    rbd_contact_state state;
    int row; /* of the step, -1 = none */
} rbdi_bounded_row;

/* A set of contacts has a set of constraints, whose rows are listed anew at each step: three of each contact
   that is near, those of held constraints, limits, bounded rows. A row's place is the number that it has if
   all rows are present. Impulses are kept by place. */
struct rbd_contact_set {
    rbd_constraint_set *rows;
    rbd_contact_options options;
    int n, limits;           /* numbers of contacts, and of limits */
    int frictions, bounds;   /* of rows of dry friction; of these, and the caller's behind them */
    int max_rows;            /* rows at most */
    int contacts;            /* that are rows of the step */
    int points;              /* that move straight: RBDI_ORIGINS or RBDI_CENTRES */
    int differ;              /* whether biases of positions and velocities differ */
    int jams;                /* whether positions have no solution, and `moved` is `nu` */
    rbdi_contact *contact;   /* n */
    rbdi_limit_row *limit;   /* limits */
    rbdi_bounded_row *bound; /* bounds */
    const rbd_real *added;   /* the caller's, packed: added to M; NULL = nothing */
    int16_t *place;          /* max_rows: of each row of the step */
    rbd_real *impulse;       /* max_rows: of the last step, by place; 0 where it had no row */
    rbd_real *early;         /* max_rows: impulses of the step's first solution, by row */
    rbd_real *friction;      /* of the step's contacts */
    rbd_real *lower, *upper; /* of its other rows */
    rbd_real *b;             /* max_rows: u without impulses, with the bias */
    rbd_real *q_mid, *v_mid; /* nq, nv: the state after half of the step, by v alone */
    rbd_real *at, *straight; /* nv each: velocities of the velocity terms; accelerations by which, at
                                     these velocities, the `points` move straight */
    rbd_real *damping;       /* nv: all of it that is implicit */
    rbd_real *nu, *moved;    /* nv each: velocities of the end; of the positions */
    rbd_real *centre;        /* nv: with `momentum`, centres of mass at q_mid, at the first dofs of roots */
    rbd_real *momentum;      /* nv: wanted at the end, of roots that fly */
    rbd_real *x[3];          /* nv each: L^-T dt (tau - ID - damping v_mid), see below */
    rbd_real dt, last_dt;    /* of this step; of the last one, 1 = none */
    rbd_real half, way;      /* times for which v moves q, and then the solution does: dt/2 each */
    rbd_real *sigma;         /* of derivatives: max_rows x nv, then [step derivatives code]; NULL = none */
    rbdi_contact_solver solver;
};

/* Indices of x, by the velocities of the velocity terms in it: v_mid, the mean of the first solution, that of
   the solution after it. */
enum { RBDI_X_UNCORRECTED, RBDI_X_CORRECTED, RBDI_X_CORRECTED_TWICE };

/* Bytes for n contacts, so many held constraints and, at most, `bounded` other rows, of which limits and
   bounded rows take `dof_bytes`. nq <= 2 nv. */
#define RBDI_CONTACT_SET_BYTES(nq, nv, n, constraints, bounded, stride, dof_bytes) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_contact_set)) + RBDI_ROUND((size_t)(n) * sizeof(rbdi_contact)) + \
     (dof_bytes) + RBDI_ROUND(RBDI_CONTACT_ROWS(n, bounded) * sizeof(int16_t)) + \
     RBDI_ROUND(sizeof(rbd_real) * ((size_t)(n) + 2 * (size_t)(bounded) + \
                                    3 * RBDI_CONTACT_ROWS(n, bounded) + (size_t)(nq) + 11 * (size_t)(nv))) + \
     RBDI_ROUND(RBDI_CONTACT_SOLVER_BYTES(n, bounded)) + \
     RBDI_CONSTRAINTS_BYTES(nv, (n) + (constraints), RBDI_CONTACT_ROWS(n, bounded), stride))

#define RBDI_DOF_BYTES(limits, bounded) \
    (RBDI_ROUND((size_t)(limits) * sizeof(rbdi_limit_row)) + \
     RBDI_ROUND((size_t)(bounded) * sizeof(rbdi_bounded_row)))

/* Scalars for the option `derivatives`: sigma; M or G; four matrices; three rows for each of n contacts. */
#define RBDI_CONTACT_SHARED(nv, rows) ((int)RBDI_LARGER((nv) * (nv), (rows) * ((rows) + (nv) + RBDI_CHUNK)))
#define RBDI_CONTACT_SIDES(nv, n, rows) \
    ((rows) * (nv) + RBDI_CONTACT_SHARED(nv, rows) + 4 * (nv) * (nv) + 3 * (n) * (nv))

/* Bytes that suffice for n contacts and so many other rows: held axes, two limits of each joint, dry
   friction, the caller's. */
#define RBD_CONTACT_SET_SIZE(nv, n, bounded) \
    RBDI_CONTACT_SET_BYTES(2 * (size_t)(nv), nv, n, bounded, bounded, \
                           3 * (n) + (bounded) + 4 * RBDI_ROW_BATCH, RBDI_DOF_BYTES(bounded, bounded))

/* ==== src/rbd_contact.h ==== */
#endif /* RBDI_CONTACT_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_CONTACT_IMPLEMENTED && !defined RBDI_JOINS_DERIVATIVES
#define RBDI_CONTACT_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/contact/tolerances.h ==== */
/* ---- tolerances [tolerances] ---- */

/* RBDI_UNMOVED: a tangent below this share of its block's trace is rounding: no impulse moves it. A normal
   is a sum of squares: its rounding is below the square of the share.
   RBDI_ON_CONE: a contact at rest counts as sticking up to this times its largest friction.
   RBDI_LEFT_OF_SLOP: depths of this share of the slop that the first half of a step makes are left.
   RBDI_LOOSE: of the first solution the residual may be so many times larger: its velocities enter those of
   the end times dt and the velocity of what turns.
   RBDI_PROXIMAL: share of the trace that Newton steps add to the diagonal, [newton]. Ten times more costs
   iterations, which a test sees; with a tenth p is the same within the tolerance.
   RBDI_LEAST_SIZE: squares of smaller impulses (N s) are near the smallest number, or below it. For sizes up
   to a million times away both ways of computing agree to rounding, so no test sees ten times more or less.
   RBDI_SCALE_SPREAD: the scale of RBDI_PROXIMAL is at most so many times the diagonal's entry, of a normal.
   As there, no test sees ten times more or less.
   RBDI_SIDES_PROXIMAL: the same for derivatives, whose relative error is that times the condition of G. Ten
   times more is an error that random trees see; a tenth is near rounding, and no test sees it: tried.
   RBDI_FASTEST_SLIP: largest alpha / d of a contact that slips. Friction is 1e-9 of p_n then, so with ten
   times more or less all tests pass as well: tried.
   RBDI_JAMS: positions whose residual exceeds this share of the corrections have no solution. Where a contact
   jams the residual equals the corrections. */
#define RBDI_UNMOVED (16 * RBDI_EPS)
#define RBDI_ON_CONE (1 + 16 * RBDI_EPS)
#define RBDI_LEFT_OF_SLOP RBD_C(0.01)
#define RBDI_LOOSE RBD_C(10)
#define RBDI_SCALE_SPREAD RBD_C(1e4)
#define RBDI_SIDES_PROXIMAL (512 * RBDI_EPS)
#if RBDI_KIND(RBD_CONST) == 2
#define RBDI_PROXIMAL {1e-4f, 1e-3f, 1e-2f}
#define RBDI_CONTACT_TOLERANCE 1e-5f
#define RBDI_LEAST_SIZE 1e-15f
#else
#define RBDI_PROXIMAL {RBD_C(1e-7), RBD_C(1e-4), RBD_C(1e-2)}
#define RBDI_CONTACT_TOLERANCE RBD_C(1e-6)
#define RBDI_LEAST_SIZE RBD_C(1e-140)
#endif
#define RBDI_CONTACT_ITERATIONS 40
#define RBDI_NEAR_LIMIT RBD_C(0.02) /* rad or m: nearer limits are rows; a larger one costs time alone */

#define RBDI_ROOT_STEPS 60 /* for the root of one contact, six on average */
#define RBDI_FASTEST_SLIP RBD_C(1e9)
#define RBDI_JAMS RBD_C(0.99)
#define RBDI_MOST_SWEEPS 32 /* between two Newton steps */

/* ==== src/contact/one_contact.h ==== */
/* ---- one contact [one contact] ----
   Solves the laws of one contact exactly, with all other impulses held. w = u - D p is its velocity without
   its own impulse, D = [A c; c' d].

     w_n >= 0             p = 0: it opens
     slip                 u_n = 0 and u_t = -alpha p_t: with p0 = -w_n/d > 0, S = A - c c'/d, s = w_t + c p0

       (S + alpha) p_t = -s,   p_n = p0 - (c/d)'p_t,   |p_t(alpha)| = mu p_n(alpha),   alpha > 0         (1)

     stick                the same with alpha = 0, where p is within the cone

   Along the eigenvectors of S, p_t takes two divisions. g(alpha) = |p_t| - mu p_n is above 0 at alpha = 0,
   because stick was refused, and not above 0 at |s| (1 + mu (|k_1| + |k_2|)) / (mu p0), k = c/d along the
   eigenvectors: a root is between. Newton's method finds it as a root of 1/|p_t| - 1/(mu p_n). This is linear
   in alpha if S has equal eigenvalues and c = 0. A step out of the bracket becomes a halving. With strong
   coupling there may be more roots (Painleve); each obeys the laws, and the bracket decides. */

/* Eigenvalues l and eigenvectors of S = A - c c'/d, and k. With S = [xx xy; xy yy] and

       mean = (xx + yy)/2,   half = (xx - yy)/2,   radius = sqrt(half^2 + xy^2)

   l = mean +- radius. The first eigenvector is (half + radius, xy) or (xy, radius - half), the longer one. */
RBDI_PART void rbdi_contact_axes(rbdi_contact_law *law) {
    const rbd_real x = law->c[0] / law->d, y = law->c[1] / law->d, least = law->trace * RBDI_UNMOVED;
    const rbd_real xx = law->A[0] - x * law->c[0], xy = law->A[1] - x * law->c[1],
                   yy = law->A[2] - y * law->c[1];
    const rbd_real mean = (xx + yy) / 2, half = (xx - yy) / 2, radius = rbdi_sqrt(half * half + xy * xy);

    law->axis[0] = rbdi_set(RBD_C(1));
    law->axis[1] = rbdi_zero();
    if (radius > 4 * RBDI_EPS * mean) {
        const rbd_real ax = half >= 0 ? half + radius : xy, ay = half >= 0 ? xy : radius - half;
        const rbd_real length = rbdi_sqrt(ax * ax + ay * ay);
        law->axis[0] = ax / length;
        law->axis[1] = ay / length;
    }

    law->l[0] = mean + radius > least ? mean + radius : least;
    law->l[1] = mean - radius > least ? mean - radius : least;
    law->k[0] = law->axis[0] * x + law->axis[1] * y;
    law->k[1] = law->axis[0] * y - law->axis[1] * x;
}

/* Prepares a contact whose block of Delta begins at D, with rows that are `stride` apart. */
RBDI_PART void rbdi_contact_prepare(rbdi_contact_law *law, const rbd_real *D, int stride, rbd_real friction) {
    const rbd_real *y = D + stride, *n = y + stride, trace = D[0] + y[1] + n[2];
    law->trace = trace;
    law->friction = friction;

    /* D = [A c; c' d] */
    law->A[0] = D[0] + trace * RBDI_UNMOVED;
    law->A[1] = D[1];
    law->A[2] = y[1] + trace * RBDI_UNMOVED;
    law->c[0] = n[0];
    law->c[1] = n[1];
    law->d = law->rigid = n[2];

    law->alpha = law->e[0] = law->e[1] = rbdi_zero();
    law->state = law->d > trace * (RBDI_UNMOVED * RBDI_UNMOVED) ? RBD_OPENS : RBD_APART;
    if (law->state != RBD_APART) rbdi_contact_axes(law);
}

/* D p */
RBDI_INLINE void rbdi_own_velocity(const rbdi_contact_law *law, const rbd_real p[3], rbd_real u[3]) {
    u[0] = law->A[0] * p[0] + law->A[1] * p[1] + law->c[0] * p[2];
    u[1] = law->A[1] * p[0] + law->A[2] * p[1] + law->c[1] * p[2];
    u[2] = law->c[0] * p[0] + law->c[1] * p[1] + law->d * p[2];
}

/* The impulse (1) at some alpha: tangents along the eigenvectors of S. */
typedef struct rbdi_contact_trial {
    rbd_real t[2], normal, size; /* size: |p_t| */
} rbdi_contact_trial;

RBDI_INLINE rbdi_contact_trial rbdi_contact_try(const rbdi_contact_law *law, const rbd_real s[2], rbd_real p0,
                                                rbd_real alpha) {
    rbdi_contact_trial trial;
    trial.t[0] = -s[0] / (law->l[0] + alpha);
    trial.t[1] = -s[1] / (law->l[1] + alpha);
    trial.normal = p0 - law->k[0] * trial.t[0] - law->k[1] * trial.t[1];
    trial.size = rbdi_sqrt(trial.t[0] * trial.t[0] + trial.t[1] * trial.t[1]);
    return trial;
}

/* Newton increment of alpha for 1/|p_t| - 1/(mu p_n) = 0. Rates are derivatives by alpha, r = -p_t':

       r_i = t_i / (l_i + alpha),   |p_t|' = -t'r / |p_t|,   (mu p_n)' = mu k'r */
RBDI_INLINE rbd_real rbdi_slip_newton(const rbdi_contact_law *law, const rbdi_contact_trial *trial,
                                      rbd_real alpha) {
    const rbd_real size = trial->size, bound = law->friction * trial->normal;
    const rbd_real r0 = trial->t[0] / (law->l[0] + alpha), r1 = trial->t[1] / (law->l[1] + alpha);
    const rbd_real size_rate = -(trial->t[0] * r0 + trial->t[1] * r1) / size;
    const rbd_real bound_rate = law->friction * (law->k[0] * r0 + law->k[1] * r1);

    return (1 / size - 1 / bound) / (size_rate / (size * size) - bound_rate / (bound * bound));
}

/* Finds the root of (1). law->alpha is the first guess, and becomes the root. Neither s nor mu is 0. */
RBDI_PART rbdi_contact_trial rbdi_slip_root(rbdi_contact_law *law, const rbd_real s[2], rbd_real p0) {
    const rbd_real mu = law->friction, size = rbdi_sqrt(s[0] * s[0] + s[1] * s[1]);
    rbd_real low = rbdi_zero(), alpha = law->alpha,
             high = size * (1 + mu * (rbdi_abs(law->k[0]) + rbdi_abs(law->k[1]))) / (mu * p0);
    rbdi_contact_trial trial;

    /* the first guess; else the root without coupling */
    if (!(alpha > 0 && alpha < high)) alpha = size / (mu * p0) - law->l[0];
    if (!(alpha > 0 && alpha < high)) alpha = rbdi_zero();
    trial = rbdi_contact_try(law, s, p0, alpha);
    for (int i = 0; i < RBDI_ROOT_STEPS; ++i) {
        const rbd_real excess = trial.size - mu * trial.normal;
        rbd_real next = alpha;

        /* the bracket */
        low = excess > 0 ? alpha : low;
        high = excess > 0 ? high : alpha;
        if (rbdi_abs(excess) <= 8 * RBDI_EPS * trial.size || high - low <= 2 * RBDI_EPS * high) break;

        /* Newton's step; out of the bracket, its middle */
        if (trial.normal > 0) next = alpha + rbdi_slip_newton(law, &trial, alpha);
        if (!(next > low && next < high))
            next = low > 0 && high > 16 * low ? rbdi_sqrt(low) * rbdi_sqrt(high) : (low + high) / 2;

        alpha = next;
        trial = rbdi_contact_try(law, s, p0, alpha);
    }

    law->alpha = alpha;
    return trial;
}

/* The impulse of a contact from w, and its state. */
RBDI_PART void rbdi_contact_impulse(rbdi_contact_law *law, const rbd_real w[3], rbd_real p[3]) {
    const rbd_real mu = law->friction, p0 = -w[2] / law->d;

    /* s = w_t + c p0, along the eigenvectors */
    const rbd_real x = w[0] + law->c[0] * p0, y = w[1] + law->c[1] * p0;
    const rbd_real s[2] = {law->axis[0] * x + law->axis[1] * y, law->axis[0] * y - law->axis[1] * x};
    rbdi_contact_trial best;

    p[0] = p[1] = p[2] = rbdi_zero();
    law->state = RBD_OPENS;
    if (!(w[2] < 0)) return;

    best = rbdi_contact_try(law, s, p0, rbdi_zero());
    law->state = best.normal > 0 && best.size <= mu * best.normal ? RBD_STICKS : RBD_SLIPS;
    if (law->state == RBD_SLIPS) {
        rbd_real share;

        p[2] = p0;
        if (!(mu > 0)) return;

        best = rbdi_slip_root(law, s, p0);
        if (!(best.normal > 0)) best.normal = rbdi_zero();

        share = best.size > 0 ? mu * best.normal / best.size : rbdi_zero(); /* onto the cone exactly */
        best.t[0] = best.t[0] * share;
        best.t[1] = best.t[1] * share;
    }

    p[0] = law->axis[0] * best.t[0] - law->axis[1] * best.t[1];
    p[1] = law->axis[1] * best.t[0] + law->axis[0] * best.t[1];
    p[2] = best.normal;
}

/* ==== src/contact/laws.h ==== */
/* ---- laws [laws] ----
   A sweep of block Gauss-Seidel solves all contacts and bounded rows exactly, one after the other. As a
   projection (Alart and Curnier 1991) the laws are p = P(z), z = p - u/d with the normal's d:

     opens    z_n <= 0                p = 0
     sticks   |z_t| <= mu z_n         p = z
     slips    else                    p = z_n (mu e + n), e = z_t/|z_t|
     bounded                          p = z, or the bound that z has passed

   The residual is the largest |p - P(z)| d: of an open contact d |p|, of one that sticks |u|, of one that
   slips |u_n| and d times the error of friction. It is in m/s, and 0 only if all laws hold. An error of
   friction moves the plane's velocity by more where its 1/mass there, l, exceeds d: by up to l / d times the
   residual. It includes the rounding of u; if it did not, impulses of contacts that jam could have any size.
   A spring's share of d counts in z_n alone: it is no mass. */

/* u = b + Delta p. */
RBDI_PART void rbdi_contact_velocities(rbdi_contact_solver *s) {
    for (int r = 0; r < s->rows; ++r) {
        s->u[r] = s->given.b[r];
        s->scratch[r] = -s->p[r];
    }
    rbdi_subtract_product(s->scratch, s->given.delta, s->rows, s->rows, s->u);
}

/* Sets p of n rows from row `first` on to x, and changes u with it. */
RBDI_INLINE void rbdi_change_impulse(rbdi_contact_solver *s, int first, int n, const rbd_real *x) {
    for (int r = first; r < first + n; ++r) {
        const rbd_real less = s->p[r] - x[r - first];
        if (!(less < 0 || less > 0)) continue;

        s->p[r] = x[r - first];
        rbdi_subtract(s->u, less, &s->given.delta[r * s->rows], s->rows);
    }
}

/* Solves contact i with all other impulses held. */
RBDI_PART void rbdi_sweep_contact(rbdi_contact_solver *s, int i) {
    rbdi_contact_law *law = &s->law[i];
    rbd_real w[3], x[3];
    if (law->state == RBD_APART) return;

    /* w = u - D p */
    rbdi_own_velocity(law, &s->p[3 * i], w);
    for (int j = 0; j < 3; ++j) w[j] = s->u[3 * i + j] - w[j];

    rbdi_contact_impulse(law, w, x);
    rbdi_change_impulse(s, 3 * i, 3, x);
}

/* P(z) of bounded row i, and its state. */
RBDI_INLINE rbd_real rbdi_project_bounded(const rbdi_contact_solver *s, int i, rbd_contact_state *state) {
    const int r = 3 * s->given.contacts + i;
    const rbd_real d = s->given.delta[r * s->rows + r],
                   z = d > s->unmoved ? s->p[r] - s->u[r] / d : rbdi_zero();

    *state = RBD_OPENS;
    if (z <= s->given.lower[i]) return s->given.lower[i];
    if (z >= s->given.upper[i]) return s->given.upper[i];

    *state = d > s->unmoved ? RBD_STICKS : RBD_APART;
    return z;
}

/* One sweep, from the first contact to the last row or, if `back`, from the last row to the first contact. */
RBDI_PART void rbdi_sweep_laws(rbdi_contact_solver *s, int back) {
    const int n = s->given.contacts, all = n + s->given.bounded;
    for (int t = 0; t < all; ++t) {
        const int i = back ? all - 1 - t : t;

        if (i < n) {
            rbdi_sweep_contact(s, i);
        } else {
            const rbd_real x = rbdi_project_bounded(s, i - n, &s->bound[i - n]);
            rbdi_change_impulse(s, 2 * n + i, 1, &x);
        }
    }
    ++s->solution.sweeps;
}

/* P(z) of a contact; its state, direction e and alpha are those of z. u_t = -alpha p_t with p_t = mu z_n e
   gives alpha = d (|z_t| - mu z_n) / (mu z_n). */
RBDI_PART void rbdi_project_contact(rbdi_contact_law *law, const rbd_real *p, const rbd_real *u,
                                    rbd_real to[3]) {
    const rbd_real x = p[0] - u[0] / law->rigid, y = p[1] - u[1] / law->rigid, n = p[2] - u[2] / law->d;
    const rbd_real size = rbdi_sqrt(x * x + y * y), most = law->friction * n;

    to[0] = to[1] = to[2] = rbdi_zero();
    law->state = RBD_OPENS;
    if (!(n > 0)) return;

    to[0] = x;
    to[1] = y;
    to[2] = n;
    law->state = RBD_STICKS;
    if (size <= most * RBDI_ON_CONE && law->friction > 0) return;

    law->state = RBD_SLIPS;
    law->e[0] = size > 0 ? x / size : rbdi_zero();
    law->e[1] = size > 0 ? y / size : rbdi_zero();
    law->alpha = law->rigid * (size > RBDI_FASTEST_SLIP * most ? RBDI_FASTEST_SLIP : (size - most) / most);
    to[0] = most * law->e[0];
    to[1] = most * law->e[1];
}

/* The larger of two residuals. NaN counts as RBDI_UNBOUNDED. */
RBDI_INLINE rbd_real rbdi_worse(rbd_real worst, rbd_real error) {
    if (!(error < RBDI_UNBOUNDED)) return rbdi_set(RBDI_UNBOUNDED);
    return error > worst ? error : worst;
}

/* The states of z, and the residual: the largest d (|P(z) - p| + eps p_n), with d and eps |p| of bounded rows
   alike. */
RBDI_PART void rbdi_project_laws(rbdi_contact_solver *s) {
    rbd_real worst = rbdi_zero();

    for (int i = 0; i < s->given.contacts; ++i) {
        const rbd_real *p = &s->p[3 * i];
        rbdi_contact_law *law = &s->law[i];
        rbd_real to[3];
        if (law->state == RBD_APART) continue;

        rbdi_project_contact(law, p, &s->u[3 * i], to);
        for (int j = 0; j < 3; ++j) to[j] = to[j] - p[j];
        worst = rbdi_worse(
            worst, law->rigid * (rbdi_sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]) + RBDI_EPS * p[2]));
    }

    for (int i = 0; i < s->given.bounded; ++i) {
        const int r = 3 * s->given.contacts + i;
        const rbd_real x = rbdi_project_bounded(s, i, &s->bound[i]);
        worst = rbdi_worse(worst, s->given.delta[r * s->rows + r] *
                                      (rbdi_abs(x - s->p[r]) + RBDI_EPS * rbdi_abs(x)));
    }

    s->solution.residual = worst;
}

/* u, states and residual of p. */
RBDI_PART void rbdi_contact_residual(rbdi_contact_solver *s) {
    rbdi_contact_velocities(s);
    rbdi_project_laws(s);
}

/* |p_t|. Below RBDI_LEAST_SIZE squares would lose digits, or vanish. */
RBDI_INLINE rbd_real rbdi_tangent_size(const rbd_real *p) {
    const rbd_real x = rbdi_abs(p[0]), y = rbdi_abs(p[1]), most = x > y ? x : y;
    rbd_real ratio;
    if (most > RBDI_LEAST_SIZE) return rbdi_sqrt(x * x + y * y);
    if (!(most > 0)) return x + y;

    ratio = (x > y ? y : x) / most;
    return most * rbdi_sqrt(1 + ratio * ratio);
}

/* Moves p into cones and bounds, because iterations leave it outside by the tolerance. If `at_end`, contacts
   that open get 0. Returns whether p changed. */
RBDI_PART int rbdi_into_cones(rbdi_contact_solver *s, int at_end) {
    int changed = 0;

    for (int i = 0; i < s->given.contacts; ++i) {
        rbd_real *p = &s->p[3 * i];
        const rbd_real size = rbdi_tangent_size(p), most = s->law[i].friction * p[2];
        const rbd_contact_state state = s->law[i].state;
        const int none = state == RBD_APART || !(p[2] > 0) || (at_end && state == RBD_OPENS);
        if (none ? size <= 0 && p[2] <= 0 && p[2] >= 0 : !(size > most)) continue; /* not so of NaN */

        for (int j = 0; j < 2 + none; ++j) p[j] = none ? rbdi_zero() : p[j] * (most / size);
        changed = 1;
    }

    for (int i = 0; i < s->given.bounded; ++i) {
        rbd_real *p = &s->p[3 * s->given.contacts + i];
        const rbd_real lower = s->given.lower[i], upper = s->given.upper[i];
        if (!(*p < lower) && !(*p > upper)) continue;

        *p = *p < lower ? lower : upper;
        changed = 1;
    }

    return changed;
}

/* ==== src/contact/newton.h ==== */
/* ---- newton [newton] ----
   Newton's method on p = P(z), whose states are held during a step. With kappa = mu z_n/|z_t| and t across e:

     opens    p = 0                 no unknown
     sticks   u = 0                 three unknowns
     slips    u_n = 0,  t'u + alpha t'p = 0,  alpha = (1 - kappa) d / kappa;  dp = (mu e + n) dp_n + t ds
     bounded  u = 0                 one, none at a bound                                                  (2)

   The second equation of a slip is the linearised direction: friction turns as u turns. With the columns S
   and the rows T of (2)

     G dx = -T'u,   G = T' Delta S + diag(alpha) + proximal diag(trace D),   p += S dx                    (3)

   `proximal` keeps G regular. Points on one rigid foot make Delta singular; with rounding alone on the
   diagonal a step moves far along its null space, and the states never settle. It acts on the increments, not
   on p, so the solution still obeys the laws. S has mu e where T has 0, so G is not symmetric: Gauss
   eliminates it, with row pivots. If nothing slips, S = T: Cholesky takes half of the time. */

/* A new unknown of so many rows from row `first` on. Its equation is u = 0 in the first of them. */
RBDI_INLINE rbdi_contact_unknown *rbdi_new_unknown(rbdi_contact_solver *s, int first, int rows,
                                                   rbd_real scale) {
    rbdi_contact_unknown *x = &s->unknown[s->unknowns++];
    x->first = first;
    x->rows = rows;
    x->scale = scale;
    x->alpha = rbdi_zero();
    for (int j = 0; j < 3; ++j) x->column[j] = x->row[j] = rbdi_set(RBD_C(j == 0));
    return x;
}

/* The scale of a normal: that of the contact, unless its d is far smaller, as under a heavy body on light
   slides, and `proximal` of it would stop the normal. */
RBDI_INLINE rbd_real rbdi_normal_scale(const rbdi_contact_law *law) {
    const rbd_real most = law->d * RBDI_SCALE_SPREAD;
    return most < law->trace ? most : law->trace;
}

/* Lists the unknowns (2). The right-hand sides follow G's columns; rows end with a whole batch. */
RBDI_PART void rbdi_list_unknowns(rbdi_contact_solver *s) {
    s->symmetric = 1;
    s->unknowns = 0;
    for (int i = 0; i < s->given.contacts; ++i) {
        const rbdi_contact_law *law = &s->law[i];
        rbdi_contact_unknown *x;
        if (law->state == RBD_STICKS)
            for (int j = 0; j < 3; ++j)
                (void)rbdi_new_unknown(s, 3 * i + j, 1, j < 2 ? law->trace : rbdi_normal_scale(law));
        if (law->state != RBD_SLIPS) continue;

        /* mu e + n, and u_n = 0 */
        s->symmetric = 0;
        x = rbdi_new_unknown(s, 3 * i, 3, rbdi_normal_scale(law));
        x->column[0] = law->friction * law->e[0];
        x->column[1] = law->friction * law->e[1];
        x->row[0] = rbdi_zero();
        x->column[2] = x->row[2] = rbdi_set(RBD_C(1));
        if (!(law->friction > 0)) continue;

        /* t, and t'u + alpha t'p = 0 */
        x = rbdi_new_unknown(s, 3 * i, 3, law->trace);
        x->column[0] = x->row[0] = -law->e[1];
        x->column[1] = x->row[1] = law->e[0];
        x->alpha = law->alpha;
    }

    for (int i = 0, r = 3 * s->given.contacts; i < s->given.bounded; ++i, ++r)
        if (s->bound[i] == RBD_STICKS) (void)rbdi_new_unknown(s, r, 1, s->given.delta[r * s->rows + r]);

    s->stride = (s->unknowns + s->sides + RBDI_BATCH - 1) / RBDI_BATCH * RBDI_BATCH;
}

/* An unknown's row of T' Delta: one of Delta's, or a sum of three, in s->scratch. */
RBDI_INLINE const rbd_real *rbdi_newton_row(rbdi_contact_solver *s, const rbdi_contact_unknown *x) {
    const rbd_real *delta = &s->given.delta[x->first * s->rows];
    if (x->rows == 1) return delta;
    for (int j = 0; j < s->rows; ++j)
        s->scratch[j] =
            x->row[0] * delta[j] + x->row[1] * delta[s->rows + j] + x->row[2] * delta[2 * s->rows + j];
    return s->scratch;
}

/* y -= factor x, of n right-hand sides: one, but for derivatives. */
RBDI_INLINE void rbdi_subtract_sides(rbd_real *y, rbd_real factor, const rbd_real *x, int n) {
    if (n == 1)
        y[0] = y[0] - factor * x[0];
    else
        rbdi_subtract(y, factor, x, n);
}

/* Row i of G. Where all contacts stick, each unknown is one row: G is symmetric, and its upper triangle is
   enough. One that slips moves three rows by one unknown. */
RBDI_PART void rbdi_newton_row_of_G(rbdi_contact_solver *s, int i, rbd_real *g) {
    const rbdi_contact_unknown *y = s->unknown;
    const rbd_real *row = rbdi_newton_row(s, &s->unknown[i]);

    if (s->symmetric) {
        for (int k = i; k < s->unknowns; ++k) g[k] = row[y[k].first];
        return;
    }
    for (int k = 0; k < s->unknowns; ++k, ++y) {
        g[k] = row[y->first];
        if (y->rows == 3)
            g[k] = g[k] * y->column[0] + row[y->first + 1] * y->column[1] + row[y->first + 2] * y->column[2];
    }
}

/* G, followed by -T'u. u: rows x sides. */
RBDI_PART void rbdi_newton_matrix(rbdi_contact_solver *s, rbd_const proximal, const rbd_real *u) {
    const int n = s->unknowns, stride = s->stride, sides = s->sides;
    rbdi_clear(s->G, n * stride);
    for (int i = 0; i < n; ++i) {
        const rbdi_contact_unknown *x = &s->unknown[i];
        rbd_real *g = &s->G[i * stride];

        rbdi_newton_row_of_G(s, i, g);
        g[i] = g[i] + x->alpha + x->scale * proximal;
        for (int j = 0; j < x->rows; ++j)
            rbdi_subtract_sides(&g[n], x->row[j], &u[(x->first + j) * sides], sides);
    }
}

/* Brings the largest entry of column k on or below the diagonal to the diagonal. Returns 0 if all are 0. */
RBDI_PART int rbdi_newton_pivot(rbdi_contact_solver *s, int k) {
    rbd_real *own = &s->G[k * s->stride], *best = own, largest = rbdi_zero();
    for (rbd_real *g = own; g < &s->G[s->unknowns * s->stride]; g += s->stride) {
        const rbd_real size = rbdi_abs(g[k]);
        if (!(size > largest)) continue;
        best = g;
        largest = size;
    }

    if (best != own) {
        for (int j = k; j < s->unknowns + s->sides; ++j) {
            const rbd_real old = own[j];
            own[j] = best[j];
            best[j] = old;
        }
    }

    return largest > 0;
}

/* Eliminates the entries below the diagonal. Returns 0 if G is singular. Rows are changed in whole batches;
   entries before column k are not read again. */
RBDI_PART int rbdi_newton_gauss(rbdi_contact_solver *s) {
    const int n = s->unknowns, stride = s->stride;
    for (int k = 0; k < n; ++k) {
        const rbd_real *own = &s->G[k * stride];
        const int from = k / RBDI_BATCH * RBDI_BATCH;
        rbd_real inverse;
        if (!rbdi_newton_pivot(s, k)) return 0;

        inverse = 1 / own[k];
        for (int i = k + 1; i < n; ++i) {
            rbd_real *g = &s->G[i * stride];
            rbdi_subtract(g + from, g[k] * inverse, own + from, stride - from);
        }
    }
    return 1;
}

/* R of a symmetric G = R'R, and R'^-1 times the right-hand sides. Returns 0 if G is not positive definite. */
RBDI_PART int rbdi_newton_cholesky(rbdi_contact_solver *s) {
    const int stride = s->stride;
    for (int k = 0; k < s->unknowns; ++k) {
        rbd_real *own = &s->G[k * stride];
        const int from = k / RBDI_BATCH * RBDI_BATCH;
        for (int j = from; j < stride; j += RBDI_BATCH) {
            rbdi_batch out = *(const rbdi_batch *)&own[j];
            for (const rbd_real *g = s->G; g < own; g += stride)
                out = out - *(const rbdi_batch *)&g[j] * g[k];
            *(rbdi_batch *)&own[j] = out;
        }
        if (!(own[k] > 0)) return 0;
        rbdi_multiply(own + from, 1 / rbdi_sqrt(own[k]), stride - from);
    }
    return 1;
}

/* Replaces the right-hand sides by dx. Returns 0 if G is singular. */
RBDI_PART int rbdi_newton_solve(rbdi_contact_solver *s) {
    const int n = s->unknowns, stride = s->stride, sides = s->sides;

    if (!(s->symmetric ? rbdi_newton_cholesky(s) : rbdi_newton_gauss(s))) return 0;

    for (int k = n - 1; k >= 0; --k) {
        rbd_real *g = &s->G[k * stride];
        const rbd_real *x = g + stride + n;
        for (int j = k + 1; j < n; ++j, x += stride) rbdi_subtract_sides(&g[n], g[j], x, sides);
        rbdi_multiply(&g[n], 1 / g[k], sides);
    }
    return 1;
}

/* Moves p to where the states have it: 0 for open contacts, on the cone along e for slipping ones, at the
   bound for rows at a bound. u must be that of p. */
RBDI_PART void rbdi_onto_cones(rbdi_contact_solver *s) {
    for (int i = 0; i < s->given.contacts; ++i) {
        const rbdi_contact_law *law = &s->law[i];
        rbd_real *p = &s->p[3 * i];
        if (law->state == RBD_OPENS) p[0] = p[1] = p[2] = rbdi_zero();
        if (law->state != RBD_SLIPS) continue;
        for (int j = 0; j < 2; ++j) p[j] = law->friction * p[2] * law->e[j];
    }
    for (int i = 0; i < s->given.bounded; ++i)
        if (s->bound[i] != RBD_STICKS)
            s->p[3 * s->given.contacts + i] = rbdi_project_bounded(s, i, &s->bound[i]);
}

/* p += S dx. p: rows x sides. */
RBDI_PART void rbdi_add_increments(const rbdi_contact_solver *s, rbd_real *p) {
    const int n = s->unknowns, sides = s->sides;
    for (int i = 0; i < n; ++i) {
        const rbdi_contact_unknown *x = &s->unknown[i];
        for (int j = 0; j < x->rows; ++j)
            rbdi_subtract_sides(&p[(x->first + j) * sides], -x->column[j], &s->G[i * s->stride + n], sides);
    }
}

RBDI_INLINE void rbdi_copy_rows(const rbdi_contact_solver *s, const rbd_real *from, rbd_real *to) {
    for (int r = 0; r < s->rows; ++r) to[r] = from[r];
}

/* Computes s->full, p after a step of full length. Returns 0 if G is singular. */
RBDI_PART int rbdi_full_step(rbdi_contact_solver *s, rbd_const proximal) {
    rbdi_onto_cones(s);
    rbdi_contact_velocities(s);

    rbdi_list_unknowns(s);
    rbdi_newton_matrix(s, proximal, s->u);
    if (!rbdi_newton_solve(s)) return 0;

    rbdi_add_increments(s, s->p);
    rbdi_copy_rows(s, s->p, s->full);
    return 1;
}

/* The share of the full step at which the first contact opens or the first row reaches its bound. */
RBDI_PART rbd_real rbdi_share_to_bound(const rbdi_contact_solver *s) {
    const int first = 3 * s->given.contacts;
    rbd_real share = rbdi_set(RBD_C(1));
    for (int r = first > 0 ? 2 : 0; r < s->rows; r += r < first - 1 ? 3 : 1) {
        const rbd_real from = s->start[r], step = s->full[r] - from;
        rbd_real bound = step < 0 ? rbdi_zero() : rbdi_set(RBDI_UNBOUNDED);
        if (r >= first) bound = step < 0 ? s->given.lower[r - first] : s->given.upper[r - first];
        if (rbdi_abs(step) * share > rbdi_abs(bound - from)) share = (bound - from) / step;
    }
    return share;
}

/* Takes a Newton step that reduces the residual to less than `gain` of it: the full step, the step up to the
   first bound, or a share of the full step. If none does, returns 0, with p, u and states as they were. */
RBDI_PART int rbdi_newton_step(rbdi_contact_solver *s, rbd_const proximal) {
    const rbd_const gain[4] = {RBD_C(0.98), RBD_C(1), RBD_C(0.9), RBD_C(0.9)},
                    shorter[4] = {RBD_C(1), RBD_C(1), RBD_C(0.3), RBD_C(0.09)};
    const rbd_real before = s->solution.residual;
    rbdi_copy_rows(s, s->p, s->start);

    for (int i = rbdi_full_step(s, proximal) ? 0 : 4; i < 4; ++i) {
        const rbd_real share = i == 1 ? rbdi_share_to_bound(s) : rbdi_set(shorter[i]);

        if (i > 0) { /* p is the full step already */
            for (int r = 0; r < s->rows; ++r) s->p[r] = s->start[r] + (s->full[r] - s->start[r]) * share;
        }
        (void)rbdi_into_cones(s, 0);
        rbdi_contact_residual(s);
        if (s->solution.residual < before * gain[i]) return 1;
    }

    rbdi_copy_rows(s, s->start, s->p);
    rbdi_contact_residual(s);
    return 0;
}

/* ==== src/contact/solver.h ==== */
/* ---- solver code [solver code] ----
   The first sweep is enough if contacts hardly affect each other. Newton steps follow. If none reduces the
   residual, some sweeps follow, twice as many each time. The best p of all is kept. */

/* Sweeps and Newton steps that are left. */
RBDI_PART int rbdi_iterations_left(const rbdi_contact_solver *s) {
    return s->given.iterations - s->solution.sweeps - s->solution.newton_steps;
}

/* Up to n sweeps, forth and back. u may have the rounding of far larger impulses, so it is computed anew
   before a small residual counts. */
RBDI_PART void rbdi_sweep_back_and_forth(rbdi_contact_solver *s, int n) {
    while (n-- > 0 && rbdi_iterations_left(s) > 0) rbdi_sweep_laws(s, n & 1);

    rbdi_project_laws(s);
    if (s->solution.residual <= s->given.tolerance) rbdi_contact_residual(s);
}

/* Ends with this p, moved into cones and bounds, 0 for contacts that open. A contact that opens but pushes,
   by less than the tolerance, counts as sticking. Returns whether the problem is solved. */
RBDI_PART int rbdi_contact_end(rbdi_contact_solver *s) {
    if (rbdi_into_cones(s, 1)) rbdi_contact_residual(s);

    for (int i = 0; i < s->given.contacts; ++i)
        if (s->law[i].state == RBD_OPENS && s->p[3 * i + 2] > 0) s->law[i].state = RBD_STICKS;

    return s->solution.residual <= s->given.tolerance;
}

/* Sets p to other impulses, moved into cones and bounds. */
RBDI_PART void rbdi_set_impulses(rbdi_contact_solver *s, const rbd_real *p) {
    rbdi_copy_rows(s, p, s->p);
    (void)rbdi_into_cones(s, 0);
    rbdi_contact_residual(s);
}

/* Ends a problem that is not solved with the best p or, unless that halves the residual, with p = 0: contacts
   that jam would get impulses in whose rounding the velocities are lost. */
RBDI_PART void rbdi_contact_give_up(rbdi_contact_solver *s) {
    rbd_real least;

    rbdi_clear(s->start, s->rows);
    rbdi_set_impulses(s, s->start);
    least = s->solution.residual / 2;

    rbdi_set_impulses(s, s->best);
    if (!(s->solution.residual < least)) rbdi_set_impulses(s, s->start);
    (void)rbdi_contact_end(s);
}

/* Solves a problem from the p that is given. */
RBDI_PART void rbdi_contact_iterate(rbdi_contact_solver *s) {
    const rbd_const proximal[3] = RBDI_PROXIMAL;
    rbd_real least = rbdi_set(RBDI_UNBOUNDED);
    int sweeps = 2;

    s->solution.sweeps = s->solution.newton_steps = 0;
    s->solution.residual = rbdi_zero();
    if (s->rows == 0) return;

    rbdi_clear(s->best, s->rows);

    rbdi_contact_velocities(s);
    rbdi_sweep_back_and_forth(s, 1);

    for (;;) {
        int tried = 0;
        if (!(s->solution.residual > s->given.tolerance) && rbdi_contact_end(s)) return;

        if (s->solution.residual < least) {
            least = s->solution.residual;
            rbdi_copy_rows(s, s->p, s->best);
        }
        if (rbdi_iterations_left(s) <= 0) {
            rbdi_contact_give_up(s);
            return;
        }

        /* a Newton step with each proximal weight, or sweeps if none reduces the residual */
        while (tried < 3 && !rbdi_newton_step(s, proximal[tried])) ++tried;
        ++s->solution.newton_steps;
        if (tried < 3) continue;

        rbdi_sweep_back_and_forth(s, sweeps);
        if (sweeps < RBDI_MOST_SWEEPS) sweeps *= 2;
    }
}

/* Lays out a solver's arrays in the memory. */
RBDI_PART void rbdi_lay_solver(rbdi_contact_solver *s, int contacts, int bounded, unsigned char *at) {
    const int rows = 3 * contacts + bounded;
    s->law = RBDI_CUT(rbdi_contact_law, contacts);
    s->bound = RBDI_CUT(rbd_contact_state, bounded);
    s->unknown = RBDI_CUT(rbdi_contact_unknown, rows);

    s->u = RBDI_CUT(rbd_real, rows * (rows + 5 + RBDI_CHUNK));
    s->start = s->u + rows;
    s->full = s->start + rows;
    s->best = s->full + rows;
    s->scratch = s->best + rows;
    s->G = s->scratch + rows;
}

/* Takes a problem, sets its defaults, and prepares its contacts. */
RBDI_PART void rbdi_contact_begin(rbdi_contact_solver *s, const rbd_contact_problem *given, rbd_real *p) {
    s->given = *given;
    s->rows = 3 * given->contacts + given->bounded;
    s->p = p;
    s->sides = 1;
    if (!(given->tolerance > 0)) s->given.tolerance = rbdi_set(RBDI_CONTACT_TOLERANCE);
    if (given->iterations == 0) s->given.iterations = RBDI_CONTACT_ITERATIONS;

    s->unmoved = rbdi_zero();
    for (int r = 0; r < s->rows; ++r) {
        const rbd_real least = given->delta[r * (s->rows + 1)] * RBDI_UNMOVED * RBDI_UNMOVED;
        if (least > s->unmoved) s->unmoved = least;
    }

    for (int i = 0; i < given->contacts; ++i)
        rbdi_contact_prepare(&s->law[i], &given->delta[3 * i * (s->rows + 1)], s->rows, given->friction[i]);
}

/* Of a number x - x is 0, else NaN, and so is a sum with it. */
RBDI_PART int rbdi_all_finite(const rbd_real *x, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + (x[i] - x[i]);
    return sum == 0;
}

/* Whether an index into G, the largest array, would not fit an int. */
RBDI_INLINE int rbdi_too_large(int contacts, int bounded) {
    const int most = (int)((unsigned)-1 >> 1);
    int rows;
    if (contacts > most / 3 || bounded > most - 3 * contacts) return 1;

    rows = 3 * contacts + bounded;
    return rows > 0 && rows > most / rows - 5 - RBDI_CHUNK;
}

RBDI_PART rbd_status rbdi_check_problem(const rbd_contact_problem *given, const void *memory, size_t size,
                                        const rbd_real *p) {
    if (!given) return RBD_ERR_NULL;
    if (given->contacts < 0 || given->bounded < 0) return RBD_ERR_COUNT;
    if (rbdi_too_large(given->contacts, given->bounded)) return RBD_ERR_COUNT;

    if (!memory || (given->contacts && !given->friction) ||
        (given->bounded && (!given->lower || !given->upper)))
        return RBD_ERR_NULL;
    if (given->contacts + given->bounded > 0 && (!given->delta || !given->b || !p)) return RBD_ERR_NULL;
    if (size < rbd_contact_solve_size(given->contacts, given->bounded)) return RBD_ERR_MEMORY;

    if (!(given->tolerance >= 0) || given->iterations < 0) return RBD_ERR_RANGE;
    for (int i = 0; i < given->contacts; ++i)
        if (!(given->friction[i] >= 0)) return RBD_ERR_RANGE;
    for (int i = 0; i < given->bounded; ++i)
        if (!(given->lower[i] <= given->upper[i])) return RBD_ERR_RANGE;

    return RBD_OK;
}

RBDI_API size_t rbd_contact_solve_size(int contacts, int bounded) {
    if (contacts < 0 || bounded < 0 || rbdi_too_large(contacts, bounded)) return 0;
    return RBDI_CONTACT_SOLVER_BYTES(contacts, bounded);
}

RBDI_API rbd_status rbd_contact_solve(const rbd_contact_problem *problem, void *memory, size_t size,
                                      rbd_real *p, rbd_contact_state *state, rbd_contact_solution *solution) {
    const rbd_status status = rbdi_check_problem(problem, memory, size, p);
    rbdi_contact_solver s;
    if (status) return status;

    s.rows = 3 * problem->contacts + problem->bounded;
    if (!rbdi_all_finite(problem->delta, s.rows * s.rows) || !rbdi_all_finite(problem->b, s.rows) ||
        !rbdi_all_finite(p, s.rows)) {
        rbdi_clear(p, s.rows);
        return RBD_ERR_NAN;
    }

    rbdi_lay_solver(&s, problem->contacts, problem->bounded, rbdi_aligned(memory));
    rbdi_contact_begin(&s, problem, p);
    rbdi_contact_iterate(&s);

    if (state)
        for (int i = 0; i < problem->contacts; ++i) state[i] = s.law[i].state;
    if (solution) *solution = s.solution;
    return RBD_OK;
}

/* ==== src/contact/joints.h ==== */
/* ---- joints [joints] ----
   Friction and damping of the description along dof k. A joint that mimics it, x = ratio q_k + offset, has no
   dof of its own: its torques act on q_k as rbd_passive has them,

       friction  |ratio| friction_x,   damping  ratio^2 damping_x */

RBDI_LOCAL rbd_const rbdi_joint_friction(const rbd_model *m, int k) {
    rbd_const sum = m->dof[k].friction;

    for (int i = 0; i < m->nmimic; ++i) {
        const rbd_const ratio = m->mimic[i].ratio;
        if (m->mimic[i].source_v == k) sum = sum + (ratio < 0 ? -ratio : ratio) * m->dof[m->nv + i].friction;
    }

    return sum;
}

RBDI_LOCAL rbd_const rbdi_joint_damping(const rbd_model *m, int k) {
    rbd_const sum = m->dof[k].damping;

    for (int i = 0; i < m->nmimic; ++i) {
        const rbd_const ratio = m->mimic[i].ratio;
        if (m->mimic[i].source_v == k) sum = sum + ratio * ratio * m->dof[m->nv + i].damping;
    }

    return sum;
}

/* Limits of the coordinate of a joint with one dof, those of its followers included. */
RBDI_LOCAL rbdi_limits rbdi_joint_limits(const rbd_model *m, const rbdi_frame *u) {
    rbdi_limits all = rbdi_limits_of(u);

    for (int i = 0; i < m->nmimic; ++i)
        if (m->mimic[i].source_v == u->iv) all = rbdi_both_limits(all, rbdi_limits_of_mimic(m, i));

    return all;
}

/* ==== src/contact/bounded.h ==== */
/* ---- bounded rows [bounded rows] ----
   Dry friction of the description, and rows of the caller's, whose force is f = p / dt. A row

       s = J nu + bias + compliance p,   dt lower <= p <= dt upper

   takes its compliance on Delta's diagonal. A bristle of stiffness k that is bent by z has bias z / dt and
   compliance 1 / (dt^2 k): p = -dt k (z + dt J nu), implicit, within the bounds.

   Dry friction has neither. Its law p (J nu) <= 0 makes no energy in a step of first order. In the midpoint
   scheme its work is p (u + J nu) / 2 with the speed u before: if the row turns around in the step, that may
   be above 0. So the first solution tells the sign of p, and the others have bounds, and a bias, by which

       p against u     p within 0 and that bound; it may stop: J nu = 0
       p along u       p within 0 and that bound; it turns around: J nu <= -u where p is not 0

   Both take energy or keep it, whichever is chosen. In between it coasts: p = 0. */

/* The row without force, as before the first step. */
RBDI_LOCAL void rbdi_rest_bounded(rbdi_bounded_row *row) {
    row->row = -1;
    row->state = RBD_APART;
    row->force = rbdi_zero();
}

/* A row that does nothing, until it is set. */
RBDI_LOCAL void rbdi_begin_bounded(rbdi_bounded_row *row) {
    rbd_contact_row *law = &row->law;
    law->dofs = 0;
    for (int j = 0; j < 3; ++j) {
        law->dof[j] = 0;
        law->jacobian[j] = rbdi_zero();
    }
    law->bias = law->lower = law->upper = law->compliance = rbdi_zero();
    rbdi_rest_bounded(row);
}

/* Lists the dofs that have dry friction, or counts them; NULL: counts. */
RBDI_LOCAL int rbdi_list_frictions(const rbd_model *m, const rbd_contact_options *o, rbdi_bounded_row *row) {
    int n = 0;
    if (!o->joint_friction) return 0;

    for (int k = 0; k < m->nv; ++k) {
        const rbd_const friction = rbdi_joint_friction(m, k);
        if (!(friction > 0)) continue;

        if (row) {
            rbdi_begin_bounded(&row[n]);
            row[n].law.dofs = 1;
            row[n].law.dof[0] = k;
            row[n].law.jacobian[0] = rbdi_set(RBD_C(1));
            row[n].law.lower = rbdi_set(-friction);
            row[n].law.upper = rbdi_set(friction);
        }
        ++n;
    }
    return n;
}

/* Whether the row may have a force. */
RBDI_INLINE int rbdi_bounded_acts(const rbdi_bounded_row *row) {
    return row->law.dofs > 0 && (row->law.lower < 0 || row->law.upper > 0);
}

/* Writes a dof and its ancestors, ascending, to s->path. Returns how many. */
RBDI_LOCAL int rbdi_path_to(const rbd_model *m, const rbd_constraint_set *s, int dof) {
    const int n = m->dof[dof].depth + 1;
    for (int t = n - 1; t >= 0; --t, dof = m->dof[dof].lambda) s->path[t] = (int16_t)dof;
    return n;
}

/* The same for all dofs of a row. */
RBDI_LOCAL int rbdi_paths_to(const rbd_model *m, const rbd_constraint_set *s, const rbd_contact_row *law) {
    int next[3] = {-1, -1, -1}, n = 0;
    if (law->dofs == 1) return rbdi_path_to(m, s, law->dof[0]);
    for (int j = 0; j < law->dofs; ++j) next[j] = law->dof[j];

    /* the largest of those that are next, from the end of the path on */
    for (;;) {
        const int two = next[0] > next[1] ? next[0] : next[1];
        const int most = two > next[2] ? two : next[2];
        if (most < 0) break;
        s->path[m->nv - ++n] = (int16_t)most;
        for (int j = 0; j < 3; ++j)
            if (next[j] == most) next[j] = m->dof[most].lambda;
    }

    for (int t = 0; t < n; ++t) s->path[t] = s->path[m->nv - n + t];
    return n;
}

/* Writes the row of J', and J v_mid. */
RBDI_LOCAL void rbdi_write_bounded(const rbd_contact_set *c, const rbdi_bounded_row *row) {
    const rbd_contact_row *law = &row->law;
    rbd_constraint_set *s = c->rows;
    if (row->row < 0) return;

    for (int j = 0; j < law->dofs; ++j) {
        s->Y[law->dof[j] * s->stride + row->row] = law->jacobian[j];
        s->velocity[row->row] = s->velocity[row->row] + law->jacobian[j] * c->v_mid[law->dof[j]];
    }
}

/* Makes dry friction take energy, by the sign of the force in the first solution. */
RBDI_LOCAL void rbdi_find_turn(const rbd_contact_set *c, rbdi_bounded_row *row) {
    const rbd_contact_row *law = &row->law;
    const int r = row->row, i = r - 3 * c->contacts;
    rbd_real u, p;
    int brakes;
    if (r < 0 || law->compliance > 0 || rbdi_abs(law->bias) > 0) return;
    if (law->lower > 0 || law->upper < 0) return;

    u = c->rows->velocity[r];
    p = c->rows->lambda[r];
    if (!(rbdi_abs(u) > c->solver.given.tolerance)) return;
    brakes = u > 0 ? p <= 0 : p >= 0;
    if (brakes == (u > 0))
        c->upper[i] = rbdi_zero();
    else
        c->lower[i] = rbdi_zero();
    if (!brakes) row->turn = u;
}

/* Keeps force and state for the caller. At a bound the force is that bound: p / dt is, but for rounding. */
RBDI_LOCAL void rbdi_keep_bounded(const rbd_contact_set *c, rbdi_bounded_row *row) {
    const int r = row->row, i = r - 3 * c->contacts;
    const rbd_contact_row *law = &row->law;
    row->force = rbdi_zero();
    row->state = RBD_APART;
    if (r < 0) return;

    row->force = c->rows->lambda[r] / c->dt;
    if (c->rows->lambda[r] <= c->dt * law->lower) row->force = law->lower;
    if (c->rows->lambda[r] >= c->dt * law->upper) row->force = law->upper;
    row->state = c->solver.bound[i];
    if (row->state == RBD_OPENS || rbdi_abs(row->turn) > 0) row->state = RBD_SLIPS;
}

RBDI_API rbd_status rbd_contact_friction(const rbd_model *m, rbd_contact_set *c, int dof, rbd_real bound) {
    const rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, 1);
    if (status) return status;
    for (int i = 0; i < c->frictions; ++i) {
        rbd_contact_row *law = &c->bound[i].law;
        if (law->dof[0] != dof) continue;
        if (!(bound >= 0 && bound < RBDI_UNBOUNDED)) return RBD_ERR_RANGE;
        law->lower = -bound;
        law->upper = bound;
        return RBD_OK;
    }
    return RBD_ERR_INDEX;
}

RBDI_LOCAL rbd_status rbdi_check_bounded(const rbd_model *m, const rbd_contact_row *law) {
    if (law->dofs < 0 || law->dofs > 3) return RBD_ERR_COUNT;
    for (int j = 0; j < law->dofs; ++j) {
        if (law->dof[j] < 0 || law->dof[j] >= m->nv) return RBD_ERR_INDEX;
        for (int i = 0; i < j; ++i)
            if (law->dof[i] == law->dof[j]) return RBD_ERR_INDEX;
    }

    if (!rbdi_all_finite(law->jacobian, law->dofs) || !rbdi_all_finite(&law->bias, 1)) return RBD_ERR_RANGE;
    if (!(law->compliance >= 0) || !rbdi_all_finite(&law->compliance, 1)) return RBD_ERR_RANGE;
    if (!(law->lower < RBDI_UNBOUNDED) || !(law->upper > -RBDI_UNBOUNDED)) return RBD_ERR_RANGE;
    return law->lower <= law->upper ? RBD_OK : RBD_ERR_RANGE;
}

RBDI_API rbd_status rbd_contact_row_set(const rbd_model *m, rbd_contact_set *c, int i,
                                        const rbd_contact_row *row) {
    const rbd_real most = rbdi_set(RBDI_UNBOUNDED);
    rbd_contact_row *law;
    rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, row != NULL);
    if (status) return status;
    if (i < 0 || i >= c->options.rows) return RBD_ERR_INDEX;
    status = rbdi_check_bounded(m, row);
    if (status) return status;

    law = &c->bound[c->frictions + i].law;
    *law = *row;
    if (law->lower < -most) law->lower = -most;
    if (law->upper > most) law->upper = most;
    return RBD_OK;
}

RBDI_API rbd_contact_state rbd_contact_row_get(const rbd_contact_set *c, int i, rbd_real *force) {
    const int there = c && i >= 0 && i < c->options.rows;
    const rbdi_bounded_row *row = there ? &c->bound[c->frictions + i] : NULL;
    if (force) *force = there ? row->force : rbdi_zero();
    return there ? row->state : RBD_APART;
}

RBDI_API rbd_status rbd_contact_inertia(const rbd_model *m, rbd_contact_set *c, const rbd_real *added) {
    const rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, 1);
    if (!status) c->added = added;
    return status;
}

/* ==== src/contact/set.h ==== */
/* ---- set code [set code] ---- */

RBDI_API char *rbd_contact_finding_text(const rbd_finding *finding, int n, char *text, size_t size) {
    rbd_finding held;
    if (!finding || finding->body < 0 || finding->body < n)
        return rbdi_write_finding(finding, "contact", text, size);
    held = *finding;
    held.body = finding->body - n;
    return rbdi_write_finding(&held, "held constraint", text, size);
}

/* Makes the plane of a contact frame 2 of its constraint: x and y are tangents, z is the normal. */
RBDI_LOCAL void rbdi_place_plane(const rbd_model *m, rbdi_constraint *con, int body2, const double normal[3],
                                 double height) {
    double R[9], origin[3], up[3] = {0, 0, 1};
    for (int j = 0; j < 3 && !rbdi_all_zero(normal, 3); ++j) up[j] = normal[j];
    rbdi_frame_along(up, R);
    for (int j = 0; j < 3; ++j) origin[j] = height * R[3 * j + 2];
    con->link[1] = (int16_t)rbdi_place_frame(m, body2, R, origin, con->rotation[1], &con->position[1]);
    for (int i = 0; i < 3; ++i)
        for (int r = 0; r < 3; ++r) con->held[i][r] = con->rotation[1][3 * i + r];
}

/* The constraint of a contact: it holds three linear axes. */
RBDI_LOCAL rbd_constraint rbdi_constraint_of_contact(const rbd_contact *from) {
    rbd_constraint con = rbdi_constraint_of(from->body1, from->point, from->body2, NULL, 0);
    con.name = from->name;
    return con;
}

/* Refuses a body2 that was left out, and one that is the world's where a body's plane is meant. */
RBDI_LOCAL rbd_status rbdi_check_plane_body(const rbd_contact *from, int i, rbd_report *report) {
    const char *sentence = NULL;
    if (from->body2 == 0 && !from->on_body)
        sentence = "it is 0, or was left out: the world is -1; for body 0 set on_body";
    if (from->body2 == -1 && from->on_body)
        sentence = "on_body is set, and it is -1: the world, or a name that no body has";
    if (!sentence) return RBD_OK;

    rbdi_refuse(report, RBD_ERR_INDEX, i, from->name, "body2");
    report->error.text = sentence;
    return RBD_ERR_INDEX;
}

/* Refuses damping without stiffness: a rigid contact has no damper. */
RBDI_LOCAL rbd_status rbdi_check_damper(const rbd_contact *from, int i, rbd_report *report) {
    if ((rbd_const)from->stiffness > 0 || !((rbd_const)from->damping > 0)) return RBD_OK;

    rbdi_refuse(report, RBD_ERR_RANGE, i, from->name, "damping");
    report->error.text = "a contact without stiffness is rigid, and has no damping: set both, or neither";
    return RBD_ERR_RANGE;
}

RBDI_LOCAL rbd_status rbdi_check_contact(const rbd_model *m, const rbd_contact *from, int i,
                                         rbd_report *report) {
    const double values[5] = {from->radius, from->friction, from->restitution, from->stiffness,
                              from->damping};
    const char *const names[5] = {"radius", "friction", "restitution", "stiffness", "damping"};
    const rbd_constraint con = rbdi_constraint_of_contact(from);
    rbd_status status;

    status = rbdi_check_plane_body(from, i, report);
    if (!status) status = rbdi_check_constraint(m, &con, i, report);
    if (status == RBD_ERR_POSITION) report->error.field = "point";
    if (status) return status;

    if (!rbdi_finite(from->normal, 3)) return rbdi_refuse(report, RBD_ERR_AXIS, i, from->name, "normal");
    if (!rbdi_finite(&from->height, 1)) return rbdi_refuse(report, RBD_ERR_POSITION, i, from->name, "height");
    for (int j = 0; j < 5; ++j)
        if (!rbdi_finite_positive(&values[j], 1) || (j == 2 && values[j] > 1))
            return rbdi_refuse(report, RBD_ERR_RANGE, i, from->name, names[j]);
    return rbdi_check_damper(from, i, report);
}

RBDI_LOCAL rbd_status rbdi_check_options(const rbd_contact_options *o, rbd_report *report) {
    const double values[7] = {o->margin,    o->slop, o->correction,        o->bounce,
                              o->tolerance, o->slip, (double)o->iterations};
    const char *const names[7] = {"margin",    "slop", "correction", "bounce",
                                  "tolerance", "slip", "iterations"};
    for (int j = 0; j < 7; ++j)
        if (!rbdi_finite_positive(&values[j], 1))
            return rbdi_refuse(report, RBD_ERR_RANGE, -1, NULL, names[j]);
    if (o->correction > 1)
        return rbdi_refuse_saying(report, RBD_ERR_RANGE, -1, NULL, "correction",
                                  "above 1: a step would correct more than all, and shake");
    if (!o->momentum || !o->first_order) return RBD_OK;

    rbdi_refuse(report, RBD_ERR_RANGE, -1, NULL, "momentum");
    report->error.text = "steps of first order do not keep it: choose one, momentum or first_order";
    return RBD_ERR_RANGE;
}

RBDI_LOCAL rbd_contact_options rbdi_contact_defaults(const rbd_contact_options *given) {
    const rbd_contact_options none = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    rbd_contact_options o = given ? *given : none;
    if (!(o.margin > 0)) o.margin = 0.005;
    if (!(o.slop > 0)) o.slop = 1e-5;
    if (!(o.correction > 0)) o.correction = 0.2;
    if (!(o.bounce > 0)) o.bounce = 0.05;
    return o;
}

/* Appends the two limits of a joint to the rows, or counts them; a limit of infinity is none. */
RBDI_LOCAL int rbdi_limits_of_joint(const rbd_model *m, const rbdi_frame *u, rbdi_limit_row *row) {
    const rbdi_limits limits = rbdi_joint_limits(m, u);
    int n = 0;
    for (int upper = 0; upper < 2; ++upper) {
        if (upper ? limits.upper >= RBDI_UNBOUNDED : limits.lower <= -RBDI_UNBOUNDED) continue;
        if (row) {
            row[n].dof = u->iv;
            row[n].iq = u->iq;
            row[n].lower = limits.lower;
            row[n].upper = limits.upper;
            row[n].side = rbdi_set(RBD_C(upper ? -1 : 1));
        }
        ++n;
    }
    return n;
}

/* Lists the limits of all joints of one dof; NULL: counts them. */
RBDI_LOCAL int rbdi_list_limits(const rbd_model *m, const rbd_contact_options *o, rbdi_limit_row *row) {
    int n = 0;
    if (o->joint_limits)
        for (int b = 0; b < m->nb; ++b)
            if (m->frame[b].nv == 1) n += rbdi_limits_of_joint(m, &m->frame[b], row ? &row[n] : NULL);
    return n;
}

RBDI_API size_t rbd_contact_set_size(const rbd_model *m, int n, const rbd_constraint *held, int n_held,
                                     const rbd_contact_options *options) {
    const rbd_contact_options o = rbdi_contact_defaults(options);
    int limits, rows, bounded, most;
    if (!m || n < 0 || n_held < 0 || n > RBD_MAX_CONSTRAINTS || n_held > RBD_MAX_CONSTRAINTS - n) return 0;
    if (!held && n_held > 0) return 0;
    if (o.rows < 0 || o.rows > RBD_MAX_CONSTRAINTS) return 0;
    limits = rbdi_list_limits(m, &o, NULL);
    rows = rbdi_list_frictions(m, &o, NULL) + o.rows;
    bounded = rbdi_rows_of(held, n_held) + limits + rows;
    most = 3 * n + bounded;
    return RBDI_CONTACT_SET_BYTES(m->nq, m->nv, n, n_held, bounded, rbdi_row_stride(most),
                                  RBDI_DOF_BYTES(limits, rows)) +
           (o.derivatives ? RBDI_ROUND(sizeof(rbd_real) * (size_t)RBDI_CONTACT_SIDES(m->nv, n, most)) : 0);
}

RBDI_LOCAL rbd_status rbdi_check_contact_list(const rbd_model *m, const rbd_work *w, const rbd_contact *list,
                                              int n, const rbd_constraint *held, int n_held,
                                              const rbd_contact_options *options, const void *memory,
                                              size_t size, rbd_report *report) {
    const size_t least = rbd_contact_set_size(m, n, held, n_held, options);
    rbd_status status = RBD_OK;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (!m || !w || !memory || (!list && n) || (!held && n_held))
        return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (least == 0) {
        rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);
        report->error.text = "a number of contacts, constraints or rows is below 0, or above 1000";
        return RBD_ERR_COUNT;
    }
    if (rbdi_check(m, w, 1)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (options) status = rbdi_check_options(options, report);
    for (int i = 0; !status && i < n; ++i) status = rbdi_check_contact(m, &list[i], i, report);
    for (int i = 0; !status && i < n_held; ++i) status = rbdi_check_constraint(m, &held[i], n + i, report);
    return !status && size < least ? rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL) : status;
}

/* Lays out the arrays of a set in the memory. */
RBDI_LOCAL rbd_contact_set *rbdi_lay_contacts(const rbd_model *m, int n, int n_held, int held_rows,
                                              const rbd_contact_options *o, void *memory) {
    const int limits = rbdi_list_limits(m, o, NULL);
    const int frictions = rbdi_list_frictions(m, o, NULL);
    const int bounded = held_rows + limits + frictions + o->rows;
    const int nv = m->nv;
    unsigned char *at = rbdi_aligned(memory);
    rbd_contact_set *c = RBDI_CUT(rbd_contact_set, 1);
    c->options = *o;
    c->n = n;
    c->limits = limits;
    c->frictions = frictions;
    c->bounds = frictions + o->rows;
    c->max_rows = 3 * n + bounded;
    c->contact = RBDI_CUT(rbdi_contact, n);
    c->limit = RBDI_CUT(rbdi_limit_row, limits);
    c->bound = RBDI_CUT(rbdi_bounded_row, c->bounds);
    c->place = RBDI_CUT(int16_t, c->max_rows);
    c->friction = RBDI_CUT(rbd_real, n + 2 * bounded + 3 * c->max_rows + m->nq + 11 * nv);
    c->lower = c->friction + n;
    c->upper = c->lower + bounded;
    c->b = c->upper + bounded;
    c->impulse = c->b + c->max_rows;
    c->early = c->impulse + c->max_rows;
    c->q_mid = c->early + c->max_rows;
    c->v_mid = c->q_mid + m->nq;
    c->at = c->v_mid + nv;
    c->straight = c->at + nv;
    c->damping = c->straight + nv;
    c->nu = c->damping + nv;
    c->moved = c->nu + nv;
    c->centre = c->moved + nv;
    c->momentum = c->centre + nv;
    for (int i = 0; i < 3; ++i) c->x[i] = c->momentum + (1 + i) * nv;
    rbdi_lay_solver(&c->solver, n, bounded, at);
    at += RBDI_ROUND(RBDI_CONTACT_SOLVER_BYTES(n, bounded));
    c->sigma = o->derivatives ? RBDI_CUT(rbd_real, RBDI_CONTACT_SIDES(nv, n, c->max_rows)) : NULL;
    c->rows = rbdi_lay_constraints(nv, n + n_held, c->max_rows, at);
    return c;
}

RBDI_LOCAL void rbdi_place_contact(const rbd_model *m, rbd_contact_set *c, const rbd_contact *from, int i) {
    const rbd_constraint as = rbdi_constraint_of_contact(from);
    rbdi_constraint *con = &c->rows->constraint[i];
    rbdi_contact *to = &c->contact[i];
    rbdi_place_constraint(m, &as, 0, con);
    rbdi_place_plane(m, con, from->body2, from->normal, from->height);
    to->body2 = from->body2;
    to->point = con->position[0];
    to->radius = RBD_C(from->radius);
    to->friction = RBD_C(from->friction);
    to->restitution = RBD_C(from->restitution);
    to->stiffness = RBD_C(from->stiffness);
    to->damping = RBD_C(from->damping);
}

RBDI_API void rbd_contact_reset(rbd_contact_set *c) {
    const rbd_contact_solution none = {0, 0, 0};
    if (!c) return;
    c->last_dt = rbdi_set(RBD_C(1));
    c->solver.solution = none;
    rbdi_clear(c->impulse, c->max_rows);
    for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        rbdi_clear(contact->force, 3);
        contact->state = RBD_APART;
        contact->gap.start = rbdi_zero();
        contact->row = -1;
    }
    for (int i = 0; i < c->bounds; ++i) rbdi_rest_bounded(&c->bound[i]);
}

RBDI_API rbd_status rbd_contact_set_init(const rbd_model *m, rbd_work *w, const rbd_contact *list, int n,
                                         const rbd_constraint *held, int n_held,
                                         const rbd_contact_options *options, void *memory, size_t size,
                                         rbd_contact_set **contacts, rbd_report *report) {
    rbd_report own;
    rbd_contact_set *c;
    rbd_contact_options o;
    rbd_status status;
    if (!report) report = &own;
    status =
        rbdi_check_contact_list(m, w, list, n, held, n_held, options, contacts ? memory : NULL, size, report);
    if (contacts) *contacts = NULL;
    if (status) return status;
    o = rbdi_contact_defaults(options);
    c = rbdi_lay_contacts(m, n, n_held, rbdi_rows_of(held, n_held), &o, memory);
    for (int i = 0; i < n; ++i) rbdi_place_contact(m, c, &list[i], i);
    for (int i = n; i < n + n_held; ++i) {
        rbdi_place_constraint(m, &held[i - n], 0, &c->rows->constraint[i]);
        c->rows->constraint[i].kp = 1; /* any value above 0: derivatives need the position error */
    }
    rbdi_list_limits(m, &o, c->limit);
    rbdi_list_frictions(m, &o, c->bound);
    for (int i = c->frictions; i < c->bounds; ++i) rbdi_begin_bounded(&c->bound[i]);
    c->added = NULL;
    rbdi_clear(c->straight, m->nv);
    rbdi_begin_set(m, w, c->rows);
    rbd_contact_reset(c);
    *contacts = c;
    return RBD_OK;
}

RBDI_API rbd_status rbd_contact_plane(const rbd_model *m, rbd_contact_set *c, int i, const double normal[3],
                                      double height) {
    const rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, normal != NULL);
    if (status) return status;
    if (i < 0 || i >= c->n) return RBD_ERR_INDEX;
    if (!rbdi_finite(normal, 3)) return RBD_ERR_AXIS;
    if (!rbdi_finite(&height, 1)) return RBD_ERR_POSITION;
    rbdi_place_plane(m, &c->rows->constraint[i], c->contact[i].body2, normal, height);
    return RBD_OK;
}

/* ==== src/contact/rows.h ==== */
/* ---- contact rows [contact rows] ----
   The rows of a step: contacts first, three each, then held constraints, limits, bounded rows. By the factor
   M + dt damping = L'DL of [packed matrix], with Y = L^-T J' and x = L^-T dt (tau - ID - damping v):

       Delta = Y' D^-1 Y,   J nu_0 = J v + Y' D^-1 x,   nu = v + L^-1 D^-1 (x + Y p)                      (4)

   where v, M and J are those of the middle of the step, [step code], J of the place of contact. The laws
   hold for the velocity of the end

       u = J nu + dt/2 gamma,   gamma = dJ/dt v with classical accelerations 0

   The place of contact is l below the centre of a ball, against the normal n, and moves over the body. With
   the motion of the body relative to the plane, the centre has velocity v and acceleration a, and

       u = v - l omega x n,   gamma = a - l domega/dt x n - l' omega x n

   Of a ball, or of a point, l is the radius, and l' = 0: the point of a wheel accelerates upward, its gap
   does not. This is where an impact acts. But places of one body at different heights over a plane have
   different velocities along it when the body turns: three of them could not all stick. So where three
   contacts or more of two bodies touch, the place of each is the foot of its centre on the plane: l is the
   radius plus the gap, l' the rate of the gap. */

/* World axes of the normal of a constraint. */
RBDI_INLINE rbdi_v3 rbdi_contact_normal(const rbd_constraint_set *s, const rbdi_constraint *con) {
    const rbdi_v3 normal =
        rbdi_vec(rbdi_set(con->held[0][2]), rbdi_set(con->held[1][2]), rbdi_set(con->held[2][2]));
    return con->link[1] < 0 ? normal : rbdi_mul_t(s->w->kin[con->link[1]].X.E, normal);
}

/* World axes of a vector along the rows of a contact. */
RBDI_INLINE rbdi_v3 rbdi_contact_vector(const rbd_constraint_set *s, const rbdi_constraint *con,
                                        const rbd_real *x) {
    rbdi_v3 local;
    local.x = con->held[0][0] * x[0] + con->held[0][1] * x[1] + con->held[0][2] * x[2];
    local.y = con->held[1][0] * x[0] + con->held[1][1] * x[1] + con->held[1][2] * x[2];
    local.z = con->held[2][0] * x[0] + con->held[2][1] * x[1] + con->held[2][2] * x[2];
    return con->link[1] < 0 ? local : rbdi_mul_t(s->w->kin[con->link[1]].X.E, local);
}

/* A gap from that of the middle, with its first and second rate there. If the velocity then was u - half
   gamma, and u = 0 at the end, second order gives its way back and onward. */
RBDI_INLINE rbdi_gap rbdi_gap_of(rbd_real middle, rbd_real rate, rbd_real gamma, rbd_real half) {
    rbdi_gap gap;
    gap.rate = rate - half * gamma;
    gap.reach = middle - half * half / 2 * gamma;
    gap.start = gap.reach - half * gap.rate;
    return gap;
}

/* Moves frame 1 of the constraint to the place of contact, l below the centre. normal: world axes. */
RBDI_LOCAL void rbdi_place_below(const rbd_constraint_set *s, rbdi_constraint *con,
                                 const rbdi_contact *contact, rbdi_v3 normal) {
    const rbdi_v3 local = con->link[0] < 0 ? normal : rbdi_mul(s->w->kin[con->link[0]].X.E, normal);
    con->position[0].x = contact->point.x - (rbd_const)(contact->below * local.x);
    con->position[0].y = contact->point.y - (rbd_const)(contact->below * local.y);
    con->position[0].z = contact->point.z - (rbd_const)(contact->below * local.z);
}

/* Computes motion and gap, with the place of contact on the ball:

       gamma = acc + l omega x (omega x n) */
RBDI_LOCAL void rbdi_contact_gap(const rbd_contact_set *c, rbdi_constraint *con, rbdi_contact *contact) {
    const rbd_constraint_set *s = c->rows;
    const rbdi_v3 normal = rbdi_contact_normal(s, con);
    rbdi_relative_motion relative;
    rbdi_v3 omega, roll;

    contact->on_plane = 0;
    contact->below = rbdi_set(contact->radius);
    rbdi_place_below(s, con, contact, normal);
    relative = rbdi_relative_motion_of(s, con);

    omega = relative.velocity.omega;
    roll = rbdi_scale(contact->below, rbdi_cross(omega, rbdi_cross(omega, normal)));
    contact->velocity = relative.velocity;
    contact->rate = relative.rate;
    contact->rate.v = rbdi_add(relative.rate.v, roll);

    contact->middle = rbdi_dot(normal, rbdi_sub(relative.body[0].p, rbdi_frame_origin(s, con, 1)));
    contact->gap = rbdi_gap_of(contact->middle, rbdi_dot(normal, contact->velocity.v),
                               rbdi_dot(normal, contact->rate.v), c->half);
}

/* Moves the place of contact along n from the ball to the plane: l grows by the gap, and l' is n'v. For the
   point of the body at the new place

       v := v - gap omega x n,   gamma := gamma - gap domega/dt x n - l' omega x n */
RBDI_LOCAL void rbdi_place_on_plane(const rbd_constraint_set *s, rbdi_constraint *con,
                                    rbdi_contact *contact) {
    const rbdi_v3 normal = rbdi_contact_normal(s, con);
    const rbdi_v3 v = contact->velocity.v;
    const rbdi_v3 turn = rbdi_cross(contact->velocity.omega, normal);
    const rbdi_v3 faster = rbdi_cross(contact->rate.omega, normal);

    contact->on_plane = 1;
    contact->below = contact->below + contact->middle;
    rbdi_place_below(s, con, contact, normal);

    contact->velocity.v = rbdi_sub(v, rbdi_scale(contact->middle, turn));
    contact->rate.v = rbdi_sub(contact->rate.v, rbdi_scale(contact->middle, faster));
    contact->rate.v = rbdi_sub(contact->rate.v, rbdi_scale(rbdi_dot(normal, v), turn));
}

/* Whether this gap may become 0 within two steps, or is at most the margin, or not a number. */
RBDI_INLINE int rbdi_may_touch(rbdi_gap gap, rbd_real dt, rbd_real margin) {
    return !(gap.start > margin && gap.start + 2 * dt * gap.rate > 0);
}

/* Whether three contacts or more of the bodies of contact i touch in the step, or arrive at their speed. */
RBDI_LOCAL int rbdi_touch_widely(const rbd_contact_set *c, int i) {
    const rbdi_constraint *own = &c->rows->constraint[i];
    int n = 0;
    for (int j = 0; j < c->n; ++j) {
        const rbdi_constraint *con = &c->rows->constraint[j];
        if (con->link[0] != own->link[0] || con->link[1] != own->link[1]) continue;
        n += rbdi_may_touch(c->contact[j].gap, c->dt, RBD_C(c->options.slop));
    }
    return n >= 3;
}

/* Computes all gaps, and the places of contacts that may be rows. */
RBDI_LOCAL void rbdi_find_places(const rbd_contact_set *c) {
    for (int i = 0; i < c->n; ++i) rbdi_contact_gap(c, &c->rows->constraint[i], &c->contact[i]);
    for (int i = 0; i < c->n; ++i) {
        if (!rbdi_may_touch(c->contact[i].gap, c->dt, RBD_C(c->options.margin))) continue;
        if (rbdi_touch_widely(c, i)) rbdi_place_on_plane(c->rows, &c->rows->constraint[i], &c->contact[i]);
    }
}

/* Computes the gap to the limit. Returns whether it may be reached. */
RBDI_LOCAL int rbdi_find_limit(const rbd_contact_set *c, rbdi_limit_row *limit, const rbd_real *q,
                               const rbd_real *v) {
    rbdi_gap *gap = &limit->gap;
    gap->start = limit->side > 0 ? q[limit->iq] - limit->lower : limit->upper - q[limit->iq];
    gap->rate = limit->side * v[limit->dof];
    gap->reach = gap->start + c->half * gap->rate;
    return rbdi_may_touch(*gap, c->dt, rbdi_set(RBDI_NEAR_LIMIT));
}

/* Appends n rows, of this place and those behind it, with entries in these dofs. Returns the first. */
RBDI_LOCAL int rbdi_open_rows(rbd_contact_set *c, int place, int n, const int16_t *dof, int dofs) {
    rbd_constraint_set *s = c->rows;
    const int row = s->rows;
    for (int r = 0; r < n; ++r) c->place[s->rows++] = (int16_t)(place + r);
    for (int t = 0; t < dofs; ++t) {
        rbdi_span *span = &s->span[dof[t]];
        if (span->end == 0) span->first = (int16_t)row;
        span->end = (int16_t)s->rows;
    }
    return row;
}

/* Lists the rows of the step with their bounds, and the impulses of the last step, times dt over its dt, to
   begin with. Returns the number of contacts. */
RBDI_LOCAL int rbdi_list_rows(const rbd_model *m, rbd_contact_set *c, const rbd_real *q, const rbd_real *v) {
    rbd_constraint_set *s = c->rows;
    const rbd_real dt = c->dt, ratio = dt / c->last_dt;
    int place = 0, contacts;

    for (int k = 0; k < m->nv; ++k) s->span[k].first = s->span[k].end = 0;
    s->rows = 0;

    rbdi_find_places(c);
    for (int i = 0; i < c->n; ++i, place += 3) {
        rbdi_constraint *con = &s->constraint[i];
        rbdi_contact *contact = &c->contact[i];
        contact->row = con->row = -1;
        contact->rebounds = 0;
        contact->state = RBD_APART;
        if (!rbdi_may_touch(contact->gap, dt, RBD_C(c->options.margin))) continue;
        c->friction[s->rows / 3] = rbdi_set(contact->friction);
        contact->row = con->row = (int16_t)rbdi_open_rows(c, place, 3, con->dof, con->dofs);
    }
    contacts = s->rows / 3;

    for (rbdi_constraint *con = s->constraint + c->n; con < s->constraint + s->n; place += con++->rows) {
        con->row = (int16_t)rbdi_open_rows(c, place, con->rows, con->dof, con->dofs);
        for (int r = con->row - 3 * contacts; r < s->rows - 3 * contacts; ++r) {
            c->upper[r] = rbdi_set(RBDI_UNBOUNDED);
            c->lower[r] = -c->upper[r];
        }
    }

    for (int i = 0; i < c->limits; ++i, ++place) {
        rbdi_limit_row *limit = &c->limit[i];
        const int r = s->rows - 3 * contacts, acts = rbdi_find_limit(c, limit, q, v);
        limit->rebounds = 0;
        limit->row = acts ? rbdi_open_rows(c, place, 1, s->path, rbdi_path_to(m, s, limit->dof)) : -1;
        if (!acts) continue;
        c->lower[r] = rbdi_zero();
        c->upper[r] = rbdi_set(RBDI_UNBOUNDED);
    }

    for (int i = 0; i < c->bounds; ++i, ++place) {
        rbdi_bounded_row *row = &c->bound[i];
        const int r = s->rows - 3 * contacts, acts = rbdi_bounded_acts(row);
        row->turn = rbdi_zero();
        row->row = acts ? rbdi_open_rows(c, place, 1, s->path, rbdi_paths_to(m, s, &row->law)) : -1;
        if (!acts) continue;
        c->lower[r] = dt * row->law.lower;
        c->upper[r] = dt * row->law.upper;
    }

    s->stride = rbdi_row_stride(s->rows);
    rbdi_clear(s->lambda, s->stride);
    for (int r = 0; r < s->rows; ++r) s->lambda[r] = c->impulse[c->place[r]] * ratio;
    return contacts;
}

/* Y = J', J v_mid and gamma of a contact. */
RBDI_LOCAL void rbdi_write_contact(const rbd_model *m, rbd_constraint_set *s, const rbdi_constraint *con,
                                   const rbdi_contact *contact) {
    const rbdi_v3 none = rbdi_vec0();
    rbdi_axes_held h;
    rbdi_set_axes(s, con, &h);
    rbdi_add_held(con, &h, none, contact->velocity.v, &s->velocity[con->row]);
    rbdi_add_held(con, &h, none, contact->rate.v, &s->gamma[con->row]);
    rbdi_constraint_columns(m, s, con, &h, rbdi_frame_origin(s, con, 0));
}

/* Y = J', and target = -J v_mid - dt/2 gamma. */
RBDI_LOCAL void rbdi_write_rows(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    rbdi_clear(s->Y, m->nv * s->stride);
    rbdi_clear(s->target, (int)(s->e - s->target) + s->stride); /* J v and gamma too */
    for (int i = 0; i < c->n; ++i)
        if (c->contact[i].row >= 0) rbdi_write_contact(m, s, &s->constraint[i], &c->contact[i]);
    for (int i = c->n; i < s->n; ++i) rbdi_constraint_rows(m, s, &s->constraint[i], 1);

    for (int i = 0; i < c->limits; ++i) {
        const rbdi_limit_row *limit = &c->limit[i];
        if (limit->row < 0) continue;
        s->Y[limit->dof * s->stride + limit->row] = limit->side;
        s->velocity[limit->row] = limit->side * c->v_mid[limit->dof];
    }

    for (int i = 0; i < c->bounds; ++i) rbdi_write_bounded(c, &c->bound[i]);

    for (int r = 0; r < s->rows; ++r) s->target[r] = -s->velocity[r] - c->half * s->gamma[r];
}

/* How a contact falls without impulses, and whether its spring acts: where it is in the plane, or would
   be. */
RBDI_LOCAL void rbdi_find_falls(rbd_contact_set *c) {
    for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        rbd_real u;
        contact->springs = 0;
        contact->falls = rbdi_zero();
        if (contact->row < 0) continue;
        u = -c->rows->b[contact->row + 2];
        contact->falls = u - contact->gap.rate;
        contact->springs =
            contact->stiffness > 0 && (contact->gap.reach <= 0 || contact->gap.reach + c->way * u < 0);
    }
}

/* Makes of the upper triangle of a symmetric matrix, in rows of this stride, all of it in rows of n: moves
   the rows, then copies each into the column below the diagonal. The last batch of a row writes up to a batch
   beyond it, which no later row is read from: rbdi_row_stride is longer than n by more. */
RBDI_LOCAL void rbdi_close_up(rbd_real *x, int stride, int n) {
    for (int r = 0; r < n; ++r)
        for (int t = r; t < n; t += RBDI_BATCH)
            *(rbdi_batch *)&x[r * n + t] = *(const rbdi_batch *)&x[r * stride + t];

    for (int r = 0; r < n - 1; ++r) rbdi_mirror(&x[r * n + r + 1], n, n - 1 - r, &x[(r + 1) * n + r]);
}

/* Delta of (4), rows x rows, in s->R; first the upper triangle, in rows of s->stride. Rows that rounding
   alone moves get 0 on the diagonal: no impulse changes their velocity. Slip and compliance come last. */
RBDI_LOCAL void rbdi_write_delta(const rbd_model *m, rbd_contact_set *c) {
    rbd_constraint_set *s = c->rows;
    const int n = s->rows;
    rbd_real *delta = s->R;

    rbdi_bound_noise(m, s);
    for (const rbdi_constraint *con = s->constraint; con < s->constraint + s->n; ++con)
        if (con->row >= 0) rbdi_delta(s, con->dof, con->dofs, con->row, con->rows);
    for (int i = 0; i < c->limits; ++i) {
        const rbdi_limit_row *limit = &c->limit[i];
        if (limit->row >= 0) rbdi_delta(s, s->path, rbdi_path_to(m, s, limit->dof), limit->row, 1);
    }
    for (int i = 0; i < c->bounds; ++i) {
        const rbdi_bounded_row *row = &c->bound[i];
        if (row->row >= 0) rbdi_delta(s, s->path, rbdi_paths_to(m, s, &row->law), row->row, 1);
    }
    rbdi_close_up(delta, s->stride, n);

    for (int r = 0; r < n; ++r)
        if (delta[r * n + r] <= s->noise) delta[r * n + r] = rbdi_zero();

    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        if (contact->row < 0) continue;
        for (int j = 0; j < 2; ++j) {
            rbd_real *d = &delta[(contact->row + j) * (n + 1)];
            *d = *d + RBD_C(c->options.slip) / c->dt;
        }
    }

    for (const rbdi_bounded_row *row = c->bound; row < c->bound + c->bounds; ++row)
        if (row->row >= 0) delta[row->row * (n + 1)] = delta[row->row * (n + 1)] + row->law.compliance;
}

/* Adds springs to the normals of Delta and of the solver's laws. Where nothing moves along the normal, the
   spring alone has the force. */
RBDI_LOCAL void rbdi_add_springs(rbd_contact_set *c) {
    const int n = c->rows->rows;
    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        const int normal = contact->row + 2;
        rbdi_contact_law *law;
        if (contact->row < 0 || !contact->springs) continue;
        law = &c->solver.law[contact->row / 3];
        law->d = law->d + 2 / (c->dt * (c->way * contact->stiffness + 2 * contact->damping));
        c->rows->R[normal * (n + 1)] = law->d;
        if (law->state == RBD_APART) law->rigid = law->d;
        law->state = RBD_OPENS;
        rbdi_contact_axes(law);
    }
}

/* ==== src/contact/biases.h ==== */
/* ---- biases [biases] ----
   The bias is added to u_n, so that p_n >= 0, u_n >= 0, p_n u_n = 0 is the law in each case. With h the time
   for which the solution moves q, c->way, the gap at the end is reach + h u_n:

     apart      reach / h: the gap is at least 0 at the end
     rigid      0; for positions, what the first half of the step has added to the depth, over h (all of the
                depth, if there was none before), and the option `correction` times the depth below the slop
     stiff      k (min(start, 0) + reach) / (h k + 2 d), and 2 / (dt (h k + 2 d)) on Delta's diagonal:
                together p_n = -dt (k (min(start, 0) + gap at the end) / 2 + d u_n). The spring has the mean
                of its ends: along a straight way, where the gap changes by dt times the mean of u, it gives
                what it took, whatever k and dt are. Where a body turns, the end is off by up to
                r (omega dt)^2 / 8. The damper is implicit. Stable at every dt
     rebounds   for velocities, restitution times the speed with which it hits: that of the beginning, and
                what it still falls until the gap is 0
     leaves     for velocities, if another contact rebounds: the speed at which it leaves, where that is more
                than its bias

   Without friction a rebound makes no energy then, whatever the restitutions are: impulses do the work
   p'(u+ + u-)/2, of approach and end. A contact that pushes has u+ = -e u- if it rebounds or leaves (e = 1),
   or u+ = -reach / h; in each case u+ + u- <= 0.

   The option `slip` adds a damper along the plane: slip / dt on the diagonal, so that u_t + slip p_t / dt is
   the velocity that sticks or slips. */

enum { RBDI_FOR_POSITIONS, RBDI_FOR_VELOCITIES };

/* A bias, m/s, and its derivatives by the gap's start, rate and reach, and by how it falls. */
typedef struct rbdi_bias {
    rbd_real value, by_start, by_rate, by_reach, by_falls;
} rbdi_bias;

RBDI_INLINE rbdi_bias rbdi_no_bias(void) {
    rbdi_bias x;
    x.value = x.by_start = x.by_rate = x.by_reach = x.by_falls = rbdi_zero();
    return x;
}

/* The bias of a rigid row. */
RBDI_INLINE rbdi_bias rbdi_rigid_bias(const rbd_contact_set *c, int purpose, const rbdi_gap *gap) {
    const rbd_real inverse = 1 / c->way, slop = RBD_C(c->options.slop), least = -slop * RBDI_LEFT_OF_SLOP,
                   made = gap->reach - gap->start, deeper = gap->start + slop;
    rbdi_bias x = rbdi_no_bias();

    if (!(gap->reach <= 0)) {
        x.value = gap->reach * inverse;
        x.by_reach = inverse;
    } else if (purpose == RBDI_FOR_POSITIONS && gap->start > 0) {
        if (gap->reach < least) {
            x.value = gap->reach * inverse;
            x.by_reach = inverse;
        }
    } else if (purpose == RBDI_FOR_POSITIONS) {
        if (made < least) {
            x.value = made * inverse;
            x.by_reach = inverse;
            x.by_start = -inverse;
        }
        if (deeper < 0) {
            const rbd_real share = RBD_C(c->options.correction) * inverse;
            x.value = x.value + share * deeper;
            x.by_start = x.by_start + share;
        }
    }
    return x;
}

RBDI_INLINE rbdi_bias rbdi_spring_bias(const rbd_contact_set *c, const rbdi_contact *contact) {
    const rbdi_gap *gap = &contact->gap;
    rbdi_bias x = rbdi_no_bias();
    x.by_reach = contact->stiffness / (c->way * contact->stiffness + 2 * contact->damping);
    if (gap->start < 0) x.by_start = x.by_reach;
    x.value = gap->reach * x.by_reach + gap->start * x.by_start;
    return x;
}

/* Of a row that leaves: its rate. */
RBDI_INLINE rbdi_bias rbdi_leaving_bias(const rbdi_gap *gap) {
    rbdi_bias x = rbdi_no_bias();
    x.value = gap->rate;
    x.by_rate = rbdi_set(RBD_C(1));
    return x;
}

/* -restitution sqrt(rate^2 - 2 start falls / dt) */
RBDI_INLINE rbdi_bias rbdi_rebound_bias(const rbd_contact_set *c, const rbdi_contact *contact) {
    const rbdi_gap *gap = &contact->gap;
    const int further = gap->start > 0 && contact->falls < 0;
    rbd_real square = gap->rate * gap->rate, share;
    rbdi_bias x = rbdi_no_bias();
    if (gap->rate > 0) return rbdi_leaving_bias(gap);

    if (further) square = square - 2 * gap->start * contact->falls / c->dt;
    x.value = -contact->restitution * rbdi_sqrt(square);

    share = contact->restitution * contact->restitution / x.value;
    x.by_rate = share * gap->rate;
    if (further) {
        x.by_start = -share * contact->falls / c->dt;
        x.by_falls = -share * gap->start / c->dt;
    }
    return x;
}

RBDI_LOCAL rbdi_bias rbdi_contact_bias(const rbd_contact_set *c, int purpose, const rbdi_contact *contact) {
    if (purpose == RBDI_FOR_VELOCITIES && contact->rebounds) return rbdi_rebound_bias(c, contact);
    return contact->springs ? rbdi_spring_bias(c, contact) : rbdi_rigid_bias(c, purpose, &contact->gap);
}

RBDI_LOCAL rbdi_bias rbdi_limit_bias(const rbd_contact_set *c, int purpose, const rbdi_limit_row *limit) {
    if (purpose == RBDI_FOR_VELOCITIES && limit->rebounds) return rbdi_leaving_bias(&limit->gap);
    return rbdi_rigid_bias(c, purpose, &limit->gap);
}

/* Whether a rigid row leaves, faster than it may close its gap. */
RBDI_LOCAL int rbdi_leaves(const rbd_contact_set *c, const rbdi_gap *gap) {
    return gap->rate > 0 && gap->rate > rbdi_rigid_bias(c, RBDI_FOR_VELOCITIES, gap).value;
}

/* Finds the contacts that rebound by the first solution, and then those that leave. */
RBDI_LOCAL void rbdi_find_rebounds(rbd_contact_set *c) {
    int any = 0;
    for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        contact->pushes = contact->row >= 0 && c->rows->lambda[contact->row + 2] > 0;
        contact->rebounds =
            contact->pushes && contact->restitution > 0 && contact->gap.rate < -RBD_C(c->options.bounce);
        any |= contact->rebounds;
    }

    if (any) {
        for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact)
            if (contact->row >= 0 && !contact->springs && rbdi_leaves(c, &contact->gap))
                contact->rebounds = 1;
    }

    for (rbdi_limit_row *limit = c->limit; limit < c->limit + c->limits; ++limit)
        limit->rebounds = any && limit->row >= 0 && rbdi_leaves(c, &limit->gap);
}

/* The bias of a held row: its error counts as a penetration on either side. */
RBDI_LOCAL rbdi_bias rbdi_held_bias(const rbd_contact_set *c, int purpose, int row) {
    const rbd_constraint_set *s = c->rows;
    const rbdi_gap gap = rbdi_gap_of(s->e[row], s->velocity[row], s->gamma[row], c->half);
    const rbd_real inverse = 1 / c->way, slop = RBD_C(c->options.slop), made = gap.reach - gap.start,
                   over = rbdi_abs(gap.start) - slop, share = RBD_C(c->options.correction) * inverse;
    rbdi_bias x = rbdi_no_bias();
    if (purpose != RBDI_FOR_POSITIONS) return x;

    if (rbdi_abs(made) > slop * RBDI_LEFT_OF_SLOP) {
        x.value = made * inverse;
        x.by_reach = inverse;
        x.by_start = -inverse;
    }
    if (!(over > 0)) return x;

    x.value = x.value + share * (gap.start > 0 ? over : -over);
    x.by_start = x.by_start + share;
    return x;
}

/* c->b = J nu_0 + bias of a row, where J nu_0 = -s->b. Returns the larger of `most` and the change. */
RBDI_INLINE rbd_real rbdi_write_bias(rbd_contact_set *c, int row, rbd_real bias, rbd_real most) {
    const rbd_real before = c->b[row];
    rbd_real change;
    c->b[row] = bias - c->rows->b[row];
    change = rbdi_abs(c->b[row] - before);
    return change > most ? change : most;
}

/* Writes c->b of all rows. Returns by how much it changes at most. */
RBDI_LOCAL rbd_real rbdi_write_biases(rbd_contact_set *c, int purpose) {
    const rbd_constraint_set *s = c->rows;
    rbd_real most = rbdi_zero();
    for (const rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact)
        if (contact->row >= 0)
            most = rbdi_write_bias(c, contact->row + 2, rbdi_contact_bias(c, purpose, contact).value, most);
    for (const rbdi_constraint *con = s->constraint + c->n; con < s->constraint + s->n; ++con)
        for (int r = con->row; r < con->row + con->rows; ++r)
            most = rbdi_write_bias(c, r, rbdi_held_bias(c, purpose, r).value, most);
    for (const rbdi_limit_row *limit = c->limit; limit < c->limit + c->limits; ++limit)
        if (limit->row >= 0)
            most = rbdi_write_bias(c, limit->row, rbdi_limit_bias(c, purpose, limit).value, most);
    for (const rbdi_bounded_row *row = c->bound; row < c->bound + c->bounds; ++row)
        if (row->row >= 0) most = rbdi_write_bias(c, row->row, row->law.bias + row->turn, most);
    return most;
}

/* ==== src/contact/reduction.h ==== */
/* ---- row reduction [row reduction] ----
   The steps from the rows to Delta lambda = b by the factor M = L'DL. */

/* Y = L^-T Y, and b = target - Y' D^-1 x. Batches may reach beyond a dof's span: entries there are 0. */
RBDI_LOCAL void rbdi_reduce_rows(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbdi_solve_transposed(m, c->w, L, c->stride, c->rows, c->Y);

    for (int r = 0; r < c->rows; r += RBDI_BATCH) {
        *(rbdi_batch *)&c->b[r] = *(const rbdi_batch *)&c->target[r];
    }

    for (int k = 0; k < m->nv; ++k) {
        const rbd_real z = c->x[k] * c->D_inverse[k];
        for (int r = c->span[k].first; r < c->span[k].end; r += RBDI_BATCH) {
            rbdi_batch *b = (rbdi_batch *)&c->b[r];
            *b = *b - *(const rbdi_batch *)&c->Y[k * c->stride + r] * z;
        }
    }
}

/* ==== src/contact/momentum.h ==== */
/* ---- momentum [momentum code] ----
   The option `momentum`. A body that floats has, with all that it carries, the momentum h: the root's six
   rows of M v. About the centre of mass, and in the axes of the root's joint, which stand in the world, h
   changes within a step by

       F = dt (tau - d nu - ID(q_mid, 0, 0))    of the root, at q_mid

   the impulse of torques, damping, gravity and all wrenches on bodies. The step misses that by O(dt^3). Here
   a change of the root's velocity alone makes it exact, to rounding:

       v_next += Ic^-1 (h(q, v) + F - h(q_next, v_next)),    Ic = rows and columns of the root in M(q_next)

   Ic = [I [mc]x; -[mc]x m] has the centre of mass c. About a fixed point, an error of position times the
   linear momentum would change the spin: the result would depend on the speed of the world. */

/* The first link of the tree that carries a link, -1 = the world. */
RBDI_LOCAL int rbdi_root_of(const rbd_model *m, int link) {
    while (link >= 0 && m->link[link].parent >= 0) link = m->link[link].parent;
    return link;
}

/* Whether a body floats over the world, and nothing outside has pushed what it carries: neither contacts nor
   constraints, nor dry friction of its own joint, nor bounded rows. Armature there is no momentum. */
RBDI_LOCAL int rbdi_flies(const rbd_model *m, const rbd_contact_set *c, const rbdi_frame *u) {
    if (u->type != RBD_FLOATING || u->link < 0 || m->link[u->link].parent >= 0) return 0;
    for (int k = u->iv; k < u->iv + 6; ++k) {
        if (m->dof[k].armature > 0) return 0;
        if (c->added && rbdi_abs(c->added[m->dof[k].row + m->dof[k].depth]) > 0) return 0;
    }

    for (int i = 0; i < c->rows->n; ++i) {
        const rbdi_constraint *con = &c->rows->constraint[i];
        const int one = rbdi_root_of(m, con->link[0]), two = rbdi_root_of(m, con->link[1]);
        if (con->row < 0 || one == two) continue;
        if (i < c->n && !c->contact[i].pushes) continue;
        if (one == u->link || two == u->link) return 0;
    }

    for (int i = 0; i < c->bounds; ++i) {
        const rbd_contact_row *law = &c->bound[i].law;
        if (c->bound[i].row < 0) continue;
        for (int j = 0; j < law->dofs; ++j)
            if (law->dof[j] >= u->iv && law->dof[j] < u->iv + 6) return 0;
    }
    return 1;
}

/* Whether any body does. */
RBDI_LOCAL int rbdi_any_flies(const rbd_model *m, const rbd_contact_set *c) {
    for (int b = 0; b < m->nb; ++b)
        if (rbdi_flies(m, c, &m->frame[b])) return 1;
    return 0;
}

/* The centre of mass of the tree whose root has the first dof iv, by M, packed. Axes and origin of the
   root. */
RBDI_LOCAL rbdi_v3 rbdi_centre_of(const rbd_model *m, const rbd_real *M, int iv) {
    const rbdi_dof *dof = &m->dof[iv];
    const rbd_real *x = &M[dof[3].row + dof[0].depth], *y = &M[dof[4].row + dof[0].depth],
                   *z = &M[dof[5].row + dof[0].depth], mass = x[3];
    if (!(mass > 0)) return rbdi_vec0();
    return rbdi_vec(y[2] / mass, z[0] / mass, x[1] / mass);
}

/* Notes the centres of mass at q_mid, where M is w->H, in c->centre at the first dofs of roots. */
RBDI_LOCAL void rbdi_note_centres(const rbd_model *m, rbd_contact_set *c) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->type == RBD_FLOATING && u->link >= 0)
            rbdi_store_vec(&c->centre[u->iv], 1, rbdi_centre_of(m, c->rows->w->H, u->iv));
}

/* The root's six rows of M v, M packed: about the root's origin, in its axes. */
RBDI_LOCAL rbdi_force rbdi_root_momentum(const rbd_model *m, const rbd_real *M, int iv, const rbd_real *v) {
    rbd_real h[6];
    rbdi_clear(h, 6);
    for (int j = iv; j < m->nv; ++j) {
        const rbd_real *row = &M[m->dof[j].row + m->dof[iv].depth];
        int root = j;
        while (root > iv + 5) root = m->dof[root].lambda;
        if (root < iv) continue;

        for (int i = 0; i < 6 && iv + i <= j; ++i) h[i] = h[i] + row[i] * v[j];
        for (int i = 0; j < iv + 6 && iv + i < j; ++i) h[j - iv] = h[j - iv] + row[i] * v[iv + i];
    }

    /* A joint of another tree that one of this tree follows comes before the root in the rows of M. */
    for (int j = m->dof[iv].lambda; j >= 0; j = m->dof[j].lambda)
        for (int i = 0; i < 6; ++i) h[i] = h[i] + M[m->dof[iv + i].row + m->dof[j].depth] * v[j];
    return rbdi_load_force(h, 1);
}

/* A wrench, or a momentum, from the root's axes and origin to the joint's axes and the centre of mass. */
RBDI_LOCAL rbdi_force rbdi_about_centre(const rbd_real *q, rbdi_v3 centre, rbdi_force F) {
    const rbdi_mat E = rbdi_joint_attitude(RBD_FLOATING, q);
    F.n = rbdi_mul_t(E, rbdi_sub(F.n, rbdi_cross(centre, F.f)));
    F.f = rbdi_mul_t(E, F.f);
    return F;
}

/* Wanted momenta, h(q, v) + F, into c->momentum at the dofs of roots that fly. */
RBDI_LOCAL void rbdi_wanted_momentum(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext) {
    rbd_work *w = c->rows->w;
    rbd_real *impulse = c->rows->x;
    (void)rbd_bias(m, w, c->q_mid, w->zero, f_ext, impulse);
    for (int k = 0; k < m->nv; ++k) impulse[k] = c->dt * (tau[k] - c->damping[k] * c->nu[k] - impulse[k]);
    (void)rbd_crba_packed(m, w, q, w->H);

    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        const int iv = u->iv;
        rbdi_force h, F;
        if (!rbdi_flies(m, c, u)) continue;
        h = rbdi_root_momentum(m, w->H, iv, v);
        h = rbdi_about_centre(&q[u->iq], rbdi_centre_of(m, w->H, iv), h);
        F = rbdi_load_force(&impulse[iv], 1);
        F = rbdi_about_centre(&c->q_mid[u->iq], rbdi_load_vec(&c->centre[iv], 1), F);
        rbdi_store_force(&c->momentum[iv], 1, rbdi_force_add(h, F));
    }
}

/* x = Ic^-1 x, 6, of the root whose first dof this is. Ic = L'DL stands in the packed M, and L and 1/D
   replace it. A direction in which the inertia may be rounding gets 0. */
RBDI_LOCAL void rbdi_solve_root(const rbdi_dof *dof, rbd_real *M, rbd_real *x) {
    rbd_real *row[6];
    for (int k = 0; k < 6; ++k) row[k] = &M[dof[k].row + dof[k].depth - k];

    for (int k = 5; k >= 0; --k) {
        rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
        const rbd_real inverse = rbdi_pivot_inverse(row[k][k], dof[k].scale, &doubt);
        row[k][k] = rbdi_select(doubt, rbdi_zero(), inverse);
        for (int i = 0; i < k; ++i) {
            const rbd_real factor = row[k][i] * row[k][k];
            for (int j = 0; j <= i; ++j) row[i][j] = row[i][j] - factor * row[k][j];
            x[i] = x[i] - factor * x[k];
        }
    }

    for (int k = 0; k < 6; ++k) {
        for (int i = 0; i < k; ++i) x[k] = x[k] - row[k][i] * x[i];
        x[k] = x[k] * row[k][k];
    }
}

/* Gives the roots that fly the wanted momenta. */
RBDI_LOCAL void rbdi_restore_momentum(const rbd_model *m, const rbd_contact_set *c, const rbd_real *q_next,
                                      rbd_real *v_next) {
    rbd_work *w = c->rows->w;
    (void)rbd_crba_packed(m, w, q_next, w->H);
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        rbdi_mat E;
        rbdi_force h;
        rbd_real change[6];
        if (!rbdi_flies(m, c, u)) continue;

        /* about the root's origin, in its axes */
        E = rbdi_joint_attitude(RBD_FLOATING, &q_next[u->iq]);
        h = rbdi_load_force(&c->momentum[u->iv], 1);
        h.f = rbdi_mul(E, h.f);
        h.n = rbdi_add(rbdi_mul(E, h.n), rbdi_cross(rbdi_centre_of(m, w->H, u->iv), h.f));

        h = rbdi_force_sub(h, rbdi_root_momentum(m, w->H, u->iv, v_next));
        rbdi_store_force(change, 1, h);
        rbdi_solve_root(&m->dof[u->iv], w->H, change);
        for (int k = 0; k < 6; ++k) v_next[u->iv + k] = v_next[u->iv + k] + change[k];
    }
}

/* ==== src/contact/step.h ==== */
/* ---- step code [step code] ----
   The midpoint scheme of Moreau (1999), with two corrections of the velocity terms. Half of the way is made
   by v: to q_mid, and v_mid is v in its axes. There all matrices are made, once. Then nu is solved for, and
   makes the other half of the way:

       K = M + A + dt d,   nu = v_mid + K^-1 (dt (tau - ID(q_mid, at, a(at)) - d v_mid) + J' p)

   with the matrix A that the caller adds, the damping d, and the accelerations a(at) of [straight moves]. The
   velocity terms are those of the mean velocity: first at = v_mid, then twice at = (v_mid + nu) / 2 of the nu
   before. Contacts are solved for the first and the last time; the nu between has the impulses of the first.
   Without these, light links that the ground holds would race away. For a vector that turns by x a step the
   length grows in order x^4 / 8 with one correction, and falls in that order with two; from x = 1.4 on
   rbdi_guard_solution sums the series. Energy then changes by half of p'(u before + u after). */

/* x = L^-T dt (tau - w->bias - damping v_mid). */
RBDI_LOCAL void rbdi_free_impulse(const rbd_model *m, const rbd_contact_set *c, const rbd_real *tau,
                                  rbd_real *x) {
    rbd_work *w = c->rows->w;
    const rbd_real *bias = w->bias;
    for (int k = 0; k < m->nv; ++k) x[k] = c->dt * (tau[k] - bias[k] - c->damping[k] * c->v_mid[k]);
    rbdi_vector_transposed(m, w, w->H, x);
}

/* Adds the caller's matrix and the damping to M, and factors the sum. Returns whether a pivot is in doubt. */
RBDI_LOCAL rbdi_mask rbdi_factor_damped(const rbd_model *m, rbd_contact_set *c, const rbd_real *damping) {
    rbd_constraint_set *s = c->rows;
    rbd_work *w = s->w;
    rbdi_mask doubt;

    /* K = M + A + dt d */
    if (c->added)
        for (int k = 0; k < m->nh; ++k) w->H[k] = w->H[k] + c->added[k];
    for (int k = 0; k < m->nv; ++k) {
        rbd_real *diagonal = &w->H[m->dof[k].row + m->dof[k].depth];
        c->damping[k] = damping ? damping[k] : rbdi_zero();
        if (c->options.joint_damping) c->damping[k] = c->damping[k] + rbdi_joint_damping(m, k);
        *diagonal = *diagonal + c->dt * c->damping[k];
    }

    doubt = rbdi_factor(m, w, w->H);
    for (int k = 0; k < m->nv; ++k) s->D_inverse[k] = w->H[m->dof[k].row + m->dof[k].depth];
    return doubt;
}

/* The middle of the step (or, with c->half = 0, its beginning): state, rows, factor, and x without
   corrections. */
RBDI_LOCAL rbd_status rbdi_begin_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                      const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                      const rbd_real *damping) {
    rbd_constraint_set *s = c->rows;
    rbd_work *w = s->w;
    rbdi_mask doubt;

    if (c->added && !rbdi_all_finite(c->added, m->nh)) return RBD_ERR_NAN;

    rbdi_move_joints(m, c->points, q, v, v, c->half, c->q_mid, c->v_mid);
    for (int k = 0; k < m->nv; ++k) c->at[k] = c->v_mid[k];
    rbdi_straight_acceleration(m, c->points, c->at, c->straight);
    rbdi_constraint_bias(m, s, c->q_mid, c->at, rbdi_expand_v(m, c->straight, w->ax), f_ext, w->gravity);

    c->contacts = rbdi_list_rows(m, c, q, v);
    rbdi_write_rows(m, c);

    if (c->options.momentum) rbdi_note_centres(m, c);
    doubt = rbdi_factor_damped(m, c, damping);
    rbdi_free_impulse(m, c, tau, c->x[RBDI_X_UNCORRECTED]);
    return rbdi_factor_status(m, w, w->H, doubt, c->x[RBDI_X_UNCORRECTED], m->nv);
}

/* x of the velocity terms of at = (v_mid + nu) / 2, in c->at. */
RBDI_LOCAL void rbdi_correct(const rbd_model *m, rbd_contact_set *c, const rbd_real *nu, const rbd_real *tau,
                             const rbd_real *f_ext, rbd_real *x) {
    rbd_work *w = c->rows->w;
    for (int k = 0; k < m->nv; ++k) c->at[k] = (c->v_mid[k] + nu[k]) / 2;

    rbdi_straight_acceleration(m, c->points, c->at, c->straight);
    rbdi_rnea(m, w, rbdi_expand_v(m, c->at, w->vx), rbdi_expand_v(m, c->straight, w->ax), f_ext,
              rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
    rbdi_free_impulse(m, c, tau, x);
}

/* nu of x and the impulses p:

       nu = v_mid + L^-1 D^-1 (x + Y p) */
RBDI_LOCAL void rbdi_contact_respond(const rbd_model *m, rbd_contact_set *c, const rbd_real *x,
                                     rbd_real *nu) {
    rbd_constraint_set *s = c->rows;
    for (int k = 0; k < m->nv; ++k) nu[k] = x[k] + rbdi_y_lambda(s, s->lambda, k);
    rbdi_vector_forward(m, s->w, s->w->H, nu);
    for (int k = 0; k < m->nv; ++k) nu[k] = c->v_mid[k] + nu[k];
}

/* Gives the rows of the step to the solver, with biases, springs, and the impulses to begin with. */
RBDI_LOCAL void rbdi_pose_problem(rbd_contact_set *c, int purpose) {
    const rbd_constraint_set *s = c->rows;
    rbd_contact_problem given;
    (void)rbdi_write_biases(c, purpose);

    given.contacts = c->contacts;
    given.bounded = s->rows - 3 * c->contacts;
    given.delta = s->R;
    given.b = c->b;
    given.friction = c->friction;
    given.lower = c->lower;
    given.upper = c->upper;
    given.tolerance = RBD_C(c->options.tolerance);
    given.iterations = c->options.iterations;

    rbdi_contact_begin(&c->solver, &given, s->lambda);
    if (purpose == RBDI_FOR_VELOCITIES) c->solver.given.tolerance = c->solver.given.tolerance * RBDI_LOOSE;
    rbdi_add_springs(c);
}

/* Solves for the first time, without corrections and with these biases. Computes c->moved. */
RBDI_LOCAL void rbdi_solve_first(const rbd_model *m, rbd_contact_set *c, int purpose) {
    rbd_constraint_set *s = c->rows;

    for (int k = 0; k < m->nv; ++k) s->x[k] = c->x[RBDI_X_UNCORRECTED][k];
    if (s->rows > 0) {
        rbdi_reduce_rows(m, s, s->w->H);
        rbdi_write_delta(m, c);
    }
    rbdi_find_falls(c);
    for (int r = 0; r < s->rows; ++r) c->b[r] = -s->b[r];

    rbdi_pose_problem(c, purpose);
    rbdi_contact_iterate(&c->solver);
    rbdi_contact_respond(m, c, c->x[RBDI_X_UNCORRECTED], c->moved);
}

/* Corrects the velocity terms for the first time: c->x[RBDI_X_CORRECTED], and c->moved with the impulses as
   they are. Returns whether velocities change by more than rounding: they do not at rest, or where nothing
   turns. Speeds count as the solver's tolerance at least. */
RBDI_LOCAL int rbdi_solve_between(const rbd_model *m, rbd_contact_set *c, const rbd_real *tau,
                                  const rbd_real *f_ext) {
    rbd_real *change = c->rows->x; /* of velocities, by the first correction */
    rbd_real changes = rbdi_zero();
    rbd_real speeds = c->solver.given.tolerance;

    rbdi_correct(m, c, c->moved, tau, f_ext, c->x[RBDI_X_CORRECTED]);
    for (int k = 0; k < m->nv; ++k) change[k] = c->x[RBDI_X_CORRECTED][k] - c->x[RBDI_X_UNCORRECTED][k];
    rbdi_vector_forward(m, c->rows->w, c->rows->w->H, change);

    for (int k = 0; k < m->nv; ++k) {
        changes = changes + rbdi_abs(change[k]);
        speeds = speeds + rbdi_abs(c->moved[k]);
        c->moved[k] = c->moved[k] + change[k];
    }
    return !(changes <= RBDI_EPS * speeds);
}

/* Corrects them again: c->x[RBDI_X_CORRECTED_TWICE], and the velocities without impulses. */
RBDI_LOCAL void rbdi_correct_again(const rbd_model *m, rbd_contact_set *c, const rbd_real *tau,
                                   const rbd_real *f_ext) {
    rbd_constraint_set *s = c->rows;
    rbdi_correct(m, c, c->moved, tau, f_ext, c->x[RBDI_X_CORRECTED_TWICE]);
    rbdi_guard_solution(m, s->w->H, c->x[RBDI_X_UNCORRECTED], c->x[RBDI_X_CORRECTED],
                        c->x[RBDI_X_CORRECTED_TWICE]);

    for (int k = 0; k < m->nv; ++k) {
        const rbdi_span span = s->span[k];
        rbdi_subtract(&s->b[span.first],
                      (c->x[RBDI_X_CORRECTED_TWICE][k] - c->x[RBDI_X_UNCORRECTED][k]) * s->D_inverse[k],
                      &s->Y[k * s->stride + span.first], span.end - span.first);
    }
    for (int r = 0; r < s->rows; ++r) c->b[r] = -s->b[r];
}

/* Corrects again, if the first correction changed anything; solves with the biases of positions, and computes
   c->moved. Where neither correction nor biases changed anything, the first solution stays if it is good
   enough. c->early keeps the impulses of the first solution for rbdi_solve_apart. */
RBDI_LOCAL void rbdi_solve_again(const rbd_model *m, rbd_contact_set *c, const rbd_real *tau,
                                 const rbd_real *f_ext, int changed) {
    const rbd_contact_solution first = c->solver.solution;
    const rbd_constraint_set *s = c->rows;

    if (changed) {
        rbdi_correct_again(m, c, tau, f_ext);
    } else {
        for (int k = 0; k < m->nv; ++k) c->x[RBDI_X_CORRECTED_TWICE][k] = c->x[RBDI_X_CORRECTED][k];
    }

    for (int r = 0; r < s->rows; ++r) c->early[r] = s->lambda[r];
    c->solver.given.tolerance = c->solver.given.tolerance / RBDI_LOOSE;
    for (int i = 0; i < c->bounds; ++i) rbdi_find_turn(c, &c->bound[i]);
    changed |= rbdi_write_biases(c, RBDI_FOR_POSITIONS) > 0;

    if (changed || !(first.residual <= c->solver.given.tolerance)) {
        rbdi_contact_iterate(&c->solver);
        c->solver.solution.sweeps += first.sweeps;
        c->solver.solution.newton_steps += first.newton_steps;
    }

    /* anew: a change that c->moved rounds away would be missing in each step */
    rbdi_contact_respond(m, c, c->x[RBDI_X_CORRECTED_TWICE], c->moved);
}

/* Chooses the scheme: half of the way by v, or all of it by the solution. */
RBDI_LOCAL void rbdi_choose_scheme(rbd_contact_set *c, rbd_real dt, int first_order) {
    c->dt = dt;
    c->way = first_order ? dt : dt / 2;
    c->half = first_order ? rbdi_zero() : c->way;
    c->points = first_order ? RBDI_ORIGINS : RBDI_CENTRES;
}

/* Computes c->moved, the velocities by which positions change. */
RBDI_LOCAL rbd_status rbdi_solve_positions(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                           const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                           const rbd_real *damping) {
    const int first_order = !(c->half > 0);
    const rbd_status status = rbdi_begin_step(m, c, q, v, tau, f_ext, damping);
    int changed;
    if (status) return status;

    rbdi_solve_first(m, c, first_order ? RBDI_FOR_POSITIONS : RBDI_FOR_VELOCITIES);
    if (first_order) return RBD_OK;

    changed = rbdi_solve_between(m, c, tau, f_ext);
    rbdi_solve_again(m, c, tau, f_ext, changed);
    return RBD_OK;
}

/* Keeps impulses, states and forces for the next step and the caller. */
RBDI_LOCAL void rbdi_keep_impulses(rbd_contact_set *c) {
    const rbd_constraint_set *s = c->rows;
    const rbd_real inverse = 1 / c->dt;

    c->last_dt = c->dt;
    rbdi_clear(c->impulse, c->max_rows);
    for (int r = 0; r < s->rows; ++r) c->impulse[c->place[r]] = s->lambda[r];

    for (int i = 0; i < c->n; ++i) {
        rbdi_contact *contact = &c->contact[i];
        rbdi_v3 impulse;
        rbdi_clear(contact->force, 3);
        if (contact->row < 0) continue;

        contact->state = c->solver.law[contact->row / 3].state;
        contact->pushes |= s->lambda[contact->row + 2] > 0;
        impulse = rbdi_contact_vector(s, &s->constraint[i], &s->lambda[contact->row]);
        rbdi_store_vec(contact->force, 1, rbdi_scale(inverse, impulse));
    }

    for (int i = 0; i < c->bounds; ++i) rbdi_keep_bounded(c, &c->bound[i]);
}

/* Solves for c->nu with biases that differ from those of the positions by `asked` at most, m/s. If positions
   had no solution, their impulses may be huge: then those of rbdi_solve_first are the better beginning. A
   contact that jams, because friction presses it into the plane, cannot be lifted: what is left of the laws
   is as much as the corrections ask for. Then positions of all dofs move by c->nu, without corrections, or
   the contact would creep through the plane. */
RBDI_LOCAL void rbdi_solve_apart(const rbd_model *m, rbd_contact_set *c, rbd_real asked) {
    const rbd_contact_solution first = c->solver.solution;
    const int again = c->half > 0 && first.residual > c->solver.given.tolerance;

    if (again)
        for (int r = 0; r < c->rows->rows; ++r) c->rows->lambda[r] = c->early[r];

    rbdi_contact_iterate(&c->solver);
    rbdi_contact_respond(m, c, c->half > 0 ? c->x[RBDI_X_CORRECTED_TWICE] : c->x[RBDI_X_UNCORRECTED], c->nu);

    c->jams = again && first.residual > RBDI_JAMS * asked && c->solver.solution.residual < first.residual;
    if (c->jams)
        for (int k = 0; k < m->nv; ++k) c->moved[k] = c->nu[k];

    c->solver.solution.residual = rbdi_worse(first.residual, c->solver.solution.residual);
    c->solver.solution.sweeps += first.sweeps;
    c->solver.solution.newton_steps += first.newton_steps;
}

/* Computes c->nu, the velocities at the end, in the axes of the beginning. They differ from c->moved if
   penetration was corrected, or a contact that pushed rebounds. */
RBDI_LOCAL rbd_status rbdi_solve_velocities(const rbd_model *m, rbd_contact_set *c) {
    int finite = rbdi_all_finite(c->b, c->rows->rows) && rbdi_all_finite(c->q_mid, m->nq);
    rbd_real asked;

    /* nu is c->moved, unless biases differ */
    rbdi_find_rebounds(c);
    for (int k = 0; k < m->nv; ++k) c->nu[k] = c->moved[k];
    asked = rbdi_write_biases(c, RBDI_FOR_VELOCITIES);
    c->differ = asked > 0;
    c->jams = 0;
    if (c->differ) rbdi_solve_apart(m, c, asked);
    rbdi_keep_impulses(c);

    for (int k = 0; k < m->nv; ++k)
        finite &= rbdi_abs(c->nu[k]) < RBDI_FASTEST && rbdi_abs(c->dt * c->moved[k]) < RBDI_FASTEST;
    for (int i = 0; i < c->n; ++i) {
        finite &= rbdi_all_finite(c->contact[i].force, 3);
        finite &= rbdi_all_finite(&c->contact[i].gap.start, 1);
    }

    return finite ? RBD_OK : RBD_ERR_NAN;
}

/* Computes c->moved and c->nu. After an error the set has no impulses, and all gaps are 0. */
RBDI_LOCAL rbd_status rbdi_solve_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                      const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                      const rbd_real *damping) {
    rbd_status status = rbdi_solve_positions(m, c, q, v, tau, f_ext, damping);
    if (!status) status = rbdi_solve_velocities(m, c);
    if (status) rbd_contact_reset(c);
    return status;
}

/* Writes the state after the step; after an error, q and v = 0. */
RBDI_LOCAL void rbdi_contact_move(const rbd_model *m, const rbd_contact_set *c, rbd_status status,
                                  const rbd_real *q, rbd_real *q_next, rbd_real *v_next) {
    if (!status) {
        rbdi_move_joints(m, c->points, c->q_mid, c->moved, c->nu, c->way, q_next, v_next);
        return;
    }

    for (int k = 0; k < m->nq; ++k) q_next[k] = q[k];
    rbdi_clear(v_next, m->nv);
}

RBDI_LOCAL rbd_status rbdi_check_step(const rbd_model *m, const rbd_contact_set *c, int arrays, rbd_real dt) {
    const rbd_status status = c ? rbdi_check_constrained(m, c->rows, arrays) : RBD_ERR_NULL;
    if (status) return status;
    return dt > 1 / RBDI_UNBOUNDED && dt < RBDI_UNBOUNDED ? RBD_OK : RBD_ERR_RANGE;
}

RBDI_API rbd_status rbd_contact_step(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                     const rbd_real *damping, rbd_real dt, rbd_real *q_next,
                                     rbd_real *v_next) {
    rbd_status status = rbdi_check_step(m, c, q && v && tau && q_next && v_next, dt);
    int flies;
    if (status) return status;

    rbdi_choose_scheme(c, dt, c->options.first_order);
    status = rbdi_solve_step(m, c, q, v, tau, f_ext, damping);

    flies = !status && c->options.momentum && rbdi_any_flies(m, c);
    if (flies) rbdi_wanted_momentum(m, c, q, v, tau, f_ext);
    rbdi_contact_move(m, c, status, q, q_next, v_next);
    if (flies) rbdi_restore_momentum(m, c, q_next, v_next);
    return status;
}

RBDI_API rbd_status rbd_contact_fd(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                   const rbd_real *damping, rbd_real dt, rbd_real *a) {
    rbd_status status = rbdi_check_step(m, c, q && v && tau && a, dt);
    if (status) return status;

    rbdi_choose_scheme(c, dt, 1);
    status = rbdi_solve_step(m, c, q, v, tau, f_ext, damping);

    /* a = (nu - v_mid) / dt + a(at), by [straight moves] */
    for (int k = 0; k < m->nv; ++k) a[k] = (c->nu[k] - c->v_mid[k]) / dt + c->straight[k];
    if (!status && !rbdi_all_finite(a, m->nv)) status = RBD_ERR_NAN;
    if (status) rbdi_clear(a, m->nv);
    return status;
}

RBDI_API rbd_contact_state rbd_contact_get(const rbd_contact_set *c, int i, rbd_real *gap,
                                           rbd_real force[3]) {
    const int there = c && i >= 0 && i < c->n;
    if (gap) *gap = there ? c->contact[i].gap.start : rbdi_zero();
    if (force)
        for (int j = 0; j < 3; ++j) force[j] = there ? c->contact[i].force[j] : rbdi_zero();
    return there ? c->contact[i].state : RBD_APART;
}

RBDI_API rbd_contact_solution rbd_contact_last(const rbd_contact_set *c) {
    const rbd_contact_solution none = {0, 0, 0};
    return c ? c->solver.solution : none;
}

/* ==== src/rbd_contact.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#if defined RBD_IMPLEMENTATION && defined RBDI_CONTACT_IMPLEMENTED && defined RBDI_CONTACT_DERIVATIVES && \
    !defined RBDI_CONTACT_DERIVATIVES_IMPLEMENTED
#define RBDI_CONTACT_DERIVATIVES_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/contact/rho.h ==== */
/* ---- derivatives [step derivatives code] ----
   Derivatives of [step code], with the states of each solution held. x is a component of q_mid, v_mid or tau,
   a = (nu - v_mid) / dt + a(w), w = (v_mid + nu before) / 2, M without damping:

       K dnu/dx = J' dp/dx - rho,     rho = dt dID(q_mid, w, a)/dx - d(J' p)/dx at fixed nu and p
       du/dx = J dnu/dx + sigma,      sigma = d(J nu + dt/2 gamma + bias)/dx at fixed nu

   where dID has, by w, also a(w); by v_mid, -M of a, and -A of the caller's matrix; by tau, rho = -dt. Each
   solution's dnu enters the next by w. rbd_id_derivatives gives d ID; d(J nu), d gamma and d(J' p) are as in
   [derivatives code] but for balls, over which the place of contact rolls. With Z = L^-T rho and the S, T
   and G of [newton]

       G y = -T' (sigma - Y' D^-1 Z),   dp = S y,   dnu = -L^-1 D^-1 (Z - Y dp)                         (5)

   Last, the half of the step before takes derivatives by q_mid and v_mid to those by q and v.

   This room has rho, contact/sigma.h has sigma, contact/derivatives.h solves for dnu. */

/* Parts of the memory for derivatives, behind c->sigma: M, later G; two matrices; two for columns that the
   caller does not want; derivatives of J nu without impulses, a row for each contact, by three x. */
RBDI_LOCAL rbd_real *rbdi_side(const rbd_model *m, const rbd_contact_set *c, int k) {
    const int nv = m->nv;
    const int shared = RBDI_CONTACT_SHARED(nv, c->max_rows);
    return c->sigma + c->max_rows * nv + (k > 0 ? shared + (k - 1) * nv * nv : 0);
}

/* B = dt dID(q_mid, w, a(w))/dw and M, both without contacts; if Q is not NULL, dt dID/dq_mid. */
RBDI_LOCAL void rbdi_write_sides(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                 const rbd_real *nu, const rbd_real *f_ext, rbd_real *Q, rbd_real *B,
                                 rbd_real *M) {
    const int size = m->nv * m->nv;

    /* a = (nu - v_mid) / dt + a(w) */
    rbdi_straight_acceleration(m, c->points, c->at, c->straight);
    for (int k = 0; k < m->nv; ++k) d->a[k] = (nu[k] - c->v_mid[k]) / c->dt + c->straight[k];
    if (Q) rbdi_clear(Q, size); /* rbd_keep_zeros leaves entries out */
    if (B) {
        rbdi_clear(B, size);
        rbdi_clear(M, size);
    }

    (void)rbd_id_derivatives(m, d, c->q_mid, c->at, d->a, f_ext, Q, B, M);
    if (Q) rbdi_multiply(Q, c->dt, size);
}

/* X -= A, packed, of which X has all entries. */
RBDI_LOCAL void rbdi_subtract_packed(const rbd_model *m, const rbd_real *A, rbd_real *X) {
    for (int i = 0; i < m->nv; ++i) {
        const rbd_real *entry = &A[m->dof[i].row + m->dof[i].depth];
        for (int j = i; j >= 0; j = m->dof[j].lambda, --entry) {
            X[i * m->nv + j] = X[i * m->nv + j] - *entry;
            if (j < i) X[j * m->nv + i] = X[j * m->nv + i] - *entry;
        }
    }
}

/* Adds rho without the terms by q_mid at fixed w, which come into Q, and without d(J' p). last: dnu of the
   solution before, NULL = w is v_mid. */
RBDI_LOCAL void rbdi_add_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *nu,
                             const rbd_real *f_ext, rbd_real *const *last, rbd_real *const rho[3]) {
    const rbd_real half = rbdi_set(RBD_C(0.5));
    const int n = m->nv;
    rbd_real *M = rbdi_side(m, c, 0), *B = rbdi_side(m, c, 1), *Q = rho[0] ? rbdi_side(m, c, 2) : NULL;

    rbdi_write_sides(m, c, d, nu, f_ext, Q, B, M);

    /* by v_mid -M - A of a and the caller's matrix, by tau -dt */
    for (int k = 0; k < n * n; ++k) {
        B[k] = B[k] * c->dt + M[k];
        if (rho[1]) rho[1][k] = rho[1][k] - M[k];
        if (rho[2] && k % (n + 1) == 0) rho[2][k] = rho[2][k] - c->dt;
    }
    if (c->added && rho[1]) rbdi_subtract_packed(m, c->added, rho[1]);

    /* B = dt dID/dw with a(w), by v_mid and, with the solution before, by w = (v_mid + nu) / 2 */
    rbdi_unforced_columns(m, c->points, c->at, c->dt, n, M);
    for (int k = 0; k < n * n; ++k) {
        B[k] = last ? (B[k] - M[k]) * half : B[k] - M[k];
        if (rho[1]) rho[1][k] = rho[1][k] + B[k];
    }
    if (!last) return;

    /* rho += B dnu */
    rbdi_multiply(B, -rbdi_set(RBD_C(1)), n * n);
    for (int x = 0; x < 3; ++x) {
        if (!rho[x]) continue;
        for (int k = 0; k < n; ++k) rbdi_subtract_product(&B[k * n], last[x], n, n, &rho[x][k * n]);
    }
}

/* The same in place of what was there. */
RBDI_LOCAL void rbdi_write_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *nu,
                               const rbd_real *f_ext, rbd_real *const *last, rbd_real *const rho[3]) {
    for (int x = 0; x < 3; ++x)
        if (rho[x]) rbdi_clear(rho[x], m->nv * m->nv);
    rbdi_add_rho(m, c, d, nu, f_ext, last, rho);
}

/* Adds Q, the terms by q_mid at fixed w. */
RBDI_LOCAL void rbdi_add_side(const rbd_model *m, const rbd_contact_set *c, rbd_real *const rho[3]) {
    if (rho[0]) rbdi_subtract(rho[0], -rbdi_set(RBD_C(1)), rbdi_side(m, c, 2), m->nv * m->nv);
}

/* ==== src/contact/sigma.h ==== */
/* -- sigma of [step derivatives code] -- */

/* Factors of a row in sigma: of derivatives of J nu and, of the middle of the step, of the gap or error, its
   rate and its gamma. */
typedef struct rbdi_row_factors {
    rbd_real velocity[6], gap[6], rate[6];
} rbdi_row_factors;

/* Adds to the derivatives of gamma by a dof what the place of contact has beyond the point of the body: with
   r = roll_radius and the normal n of the plane on which the place stays, if it does,

       gamma = acc + omega x (omega x r) - rate (omega x n),   rate = n . velocity

   By q the place moves over the body by its roll, and r by n (n . s): together by z x r. */
RBDI_LOCAL void rbdi_roll_rates(const rbdi_pair_motion *pair, rbdi_motion_derivatives *by) {
    const rbdi_v3 omega = pair->motion.velocity.omega;
    const rbdi_v3 r = pair->roll_radius;
    const rbdi_v3 n = pair->normal;
    const rbdi_v3 z = by->S.omega;
    const rbdi_v3 dw = by->velocity_q.omega;
    const rbdi_v3 across = rbdi_cross(omega, r);
    const rbdi_v3 shift = rbdi_cross(z, r);
    const rbdi_v3 turn = rbdi_cross(omega, n);
    const rbd_real rate = rbdi_dot(n, pair->motion.velocity.v);
    const rbd_real rate_q = rbdi_dot(n, by->velocity_q.v);
    const rbd_real rate_v = rbdi_dot(n, by->S.v);

    by->rate_q.v = rbdi_cross_add(by->rate_q.v, pair->motion.rate.omega, rbdi_roll(pair, by->S));
    by->rate_q.v = rbdi_cross_add(by->rate_q.v, dw, across);
    by->rate_q.v = rbdi_cross_add(by->rate_q.v, omega, rbdi_add(rbdi_cross(dw, r), rbdi_cross(omega, shift)));
    by->rate_q.v = rbdi_sub(by->rate_q.v, rbdi_scale(rate_q, turn));
    by->rate_q.v = rbdi_sub(by->rate_q.v, rbdi_scale(rate, rbdi_cross(dw, n)));

    by->rate_v.v = rbdi_cross_add(rbdi_cross_add(by->rate_v.v, z, across), omega, shift);
    by->rate_v.v = rbdi_sub(by->rate_v.v, rbdi_scale(rate_v, turn));
    by->rate_v.v = rbdi_sub(by->rate_v.v, rbdi_scale(rate, rbdi_cross(z, n)));
}

/* Adds a constraint's terms to sigma, by q_mid or v_mid (x = 0, 1). With f->velocity by v_mid, J takes the
   place of the derivative of J nu. Leaves the S of the dofs in d. */
RBDI_LOCAL void rbdi_row_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                               const rbdi_constraint *con, const rbdi_pair_motion *pair,
                               const rbdi_row_factors *f, int x) {
    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];

        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            rbdi_motion_derivatives by = rbdi_differentiate_motion(m, c->rows, pair, walk.side, walk.link, j);
            rbd_real sum[3][RBDI_SIX_ROWS], *to = &c->sigma[con->row * m->nv + rbdi_source(m, l->iv + j)];
            rbdi_motion velocity, rate;

            rbdi_store_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH, by.S);
            rbdi_roll_rates(pair, &by);
            velocity = x == 0 ? by.velocity_q : by.S;
            rate = x == 0 ? by.rate_q : by.rate_v;

            /* of J nu, of the gap or error, and of gamma */
            rbdi_clear(sum[0], 3 * RBDI_SIX_ROWS);
            rbdi_add_held(con, &pair->h, velocity.omega, velocity.v, sum[0]);
            rbdi_add_held(con, &pair->h, rbdi_differentiate_error(con, pair, by.S.omega), by.S.v, sum[1]);
            rbdi_add_held(con, &pair->h, rate.omega, rate.v, sum[2]);

            for (int r = 0; r < con->rows; ++r, to += m->nv)
                *to = *to + f->velocity[r] * sum[0][r] + f->gap[r] * sum[1][r] + f->rate[r] * sum[2][r];
        }
    }
}

/* Motion of constraint i's two bodies; of a contact with the place that rolls over them. */
RBDI_LOCAL rbdi_pair_motion rbdi_contact_pair(const rbd_contact_set *c, int i) {
    const rbdi_constraint *con = &c->rows->constraint[i];
    rbdi_pair_motion pair = rbdi_pair_motion_of(c->rows, con);

    if (i < c->n) {
        const rbdi_v3 normal = rbdi_contact_normal(c->rows, con);
        pair.roll_radius = rbdi_scale(c->contact[i].below, normal);
        if (c->contact[i].on_plane) pair.normal = normal;
    }

    return pair;
}

/* The bias of row r of a constraint. */
RBDI_LOCAL rbdi_bias rbdi_bias_of(const rbd_contact_set *c, int i, int purpose, int r) {
    if (i >= c->n) return rbdi_held_bias(c, purpose, c->rows->constraint[i].row + r);
    return r == 2 ? rbdi_contact_bias(c, purpose, &c->contact[i]) : rbdi_no_bias();
}

/* Adds the terms by q_mid at the velocity nu: of J nu and of the gap to sigma, -d(J' p) to rho. */
RBDI_LOCAL void rbdi_velocity_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                                    const rbd_real *nu, int purpose, rbd_real *rho) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_constraint_set *s = c->rows;

    rbdi_constraint_state(m, s, rbdi_expand_v(m, nu, s->w->vx), s->w->zero, none, 0);
    for (int i = 0; i < s->n; ++i) {
        const rbdi_constraint *con = &s->constraint[i];
        rbdi_row_factors f;
        rbdi_pair_motion pair;
        if (con->row < 0) continue;

        for (int r = 0; r < con->rows; ++r) {
            const rbdi_bias bias = rbdi_bias_of(c, i, purpose, r);
            f.velocity[r] = rbdi_set(RBD_C(1));
            f.rate[r] = rbdi_zero();
            f.gap[r] = bias.by_start + bias.by_reach;
        }

        pair = rbdi_contact_pair(c, i);
        rbdi_row_terms(m, c, d, con, &pair, &f, 0);
        rbdi_differentiate_forces(m, d, con, &pair, rho);
    }
}

/* Adds to sigma the terms of gamma and, in the bias, of the rate in the middle of the step, by q_mid or v_mid
   (x = 0, 1). gamma holds the classical accelerations by v, so by v_mid it has J da/dv beyond the rate. */
RBDI_LOCAL void rbdi_middle_terms(const rbd_model *m, rbd_contact_set *c, const rbd_derivatives *d,
                                  int purpose, int x) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    const rbd_real half = c->half;
    rbd_constraint_set *s = c->rows;

    rbdi_straight_acceleration(m, c->points, c->v_mid, c->straight);
    rbdi_constraint_state(m, s, rbdi_expand_v(m, c->v_mid, s->w->vx), rbdi_expand_v(m, c->straight, s->w->ax),
                          none, 0);

    /* pass 0, by v_mid alone: -J, which becomes -J - J dW/dv; pass 1: the rest */
    for (int pass = x == 0; pass < 2; ++pass) {
        for (int i = 0; i < s->n; ++i) {
            const rbdi_constraint *con = &s->constraint[i];
            rbdi_row_factors f;
            rbdi_pair_motion pair;
            if (con->row < 0) continue;

            for (int r = 0; r < con->rows; ++r) {
                const rbdi_bias bias = rbdi_bias_of(c, i, purpose, r);
                const rbd_real gamma = half + half * half / 2 * (bias.by_start - bias.by_reach) -
                                       half * bias.by_rate + 2 * half * bias.by_falls;
                f.gap[r] = rbdi_zero();
                f.rate[r] = pass ? gamma : rbdi_zero();
                f.velocity[r] = pass ? bias.by_rate - half * bias.by_start - bias.by_falls : -gamma;
                if (pass && x == 1) f.velocity[r] = f.velocity[r] + gamma;
            }

            pair = rbdi_contact_pair(c, i);
            rbdi_row_terms(m, c, d, con, &pair, &f, x);
        }

        if (pass == 0) rbdi_unforced_columns(m, c->points, c->v_mid, rbdi_set(RBD_C(1)), s->rows, c->sigma);
    }
}

/* Where the derivatives of J nu by x are, nu without impulses, of contact i. */
RBDI_LOCAL rbd_real *rbdi_fall_columns(const rbd_model *m, const rbd_contact_set *c, int i, int x) {
    return rbdi_side(m, c, 5) + (x * c->n + i) * m->nv;
}

/* Writes them, of contacts that may rebound. dnu: of nu without impulses, by x. */
RBDI_LOCAL void rbdi_write_falls(const rbd_model *m, rbd_contact_set *c, const rbd_real *nu,
                                 rbd_real *const dnu[3]) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_constraint_set *s = c->rows;

    rbdi_constraint_state(m, s, rbdi_expand_v(m, nu, s->w->vx), s->w->zero, none, 0);
    for (int i = 0; i < c->n; ++i) {
        const rbdi_constraint *con = &s->constraint[i];
        rbdi_pair_motion pair;
        if (con->row < 0 || !(c->contact[i].restitution > 0)) continue;

        pair = rbdi_contact_pair(c, i);
        for (int x = 0; x < 3; ++x) rbdi_clear(rbdi_fall_columns(m, c, i, x), m->nv);

        /* each dof k: n . d(J nu)/dq_k, and n . J_k dnu_k/dx */
        for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);)
            for (int j = 0; j < rbdi_link_dofs(m, &m->link[walk.link]); ++j) {
                const rbdi_motion_derivatives by =
                    rbdi_differentiate_motion(m, s, &pair, walk.side, walk.link, j);
                const int k = rbdi_source(m, m->link[walk.link].iv + j);
                const rbdi_v3 normal = rbdi_contact_normal(s, con);
                rbd_real *own = &rbdi_fall_columns(m, c, i, 0)[k];

                *own = *own + rbdi_dot(normal, by.velocity_q.v);
                for (int x = 0; x < 3; ++x)
                    if (dnu[x])
                        rbdi_subtract(rbdi_fall_columns(m, c, i, x), -rbdi_dot(normal, by.S.v),
                                      &dnu[x][k * m->nv], m->nv);
            }
    }
}

/* Adds the terms of what contacts that rebound fall, by any x, of limits, by q_mid and v_mid, and of dry
   friction that turns around, by v_mid. */
RBDI_LOCAL void rbdi_other_terms(const rbd_model *m, rbd_contact_set *c, int purpose, int x) {
    for (int i = 0; i < c->n; ++i) {
        const rbdi_contact *contact = &c->contact[i];
        rbd_real by_falls;
        if (contact->row < 0 || !contact->rebounds) continue;

        by_falls = rbdi_rebound_bias(c, contact).by_falls;
        if (by_falls > 0)
            rbdi_subtract(&c->sigma[(contact->row + 2) * m->nv], -by_falls, rbdi_fall_columns(m, c, i, x),
                          m->nv);
    }
    if (x == 2) return;

    for (const rbdi_limit_row *limit = c->limit; limit < c->limit + c->limits; ++limit) {
        rbdi_bias bias;
        if (limit->row < 0) continue;

        bias = rbdi_limit_bias(c, purpose, limit);
        c->sigma[limit->row * m->nv + limit->dof] =
            limit->side * (x == 0 ? bias.by_start + bias.by_reach : bias.by_rate - c->half * bias.by_start);
    }
    if (x == 0) return;

    for (const rbdi_bounded_row *row = c->bound; row < c->bound + c->bounds; ++row) {
        if (row->row < 0 || !(rbdi_abs(row->turn) > 0)) continue;
        for (int j = 0; j < row->law.dofs; ++j)
            c->sigma[row->row * m->nv + row->law.dof[j]] = row->law.jacobian[j];
    }
}

/* ==== src/contact/derivatives.h ==== */
/* -- dnu of [step derivatives code] -- */

/* Arrays for derivatives by q_mid, v_mid and tau, nv x nv each, in turns of one solution and the next.
   NULL: not wanted. In the end: of c->moved and c->nu. */
typedef struct rbdi_step_columns {
    rbd_real *dq[3], *dv[3];
} rbdi_step_columns;

/* Replaces rho by dnu of (5). Returns 0 if the impulses have no derivative. */
RBDI_LOCAL int rbdi_solve_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_real *rho) {
    rbd_constraint_set *s = c->rows;
    rbdi_contact_solver solver = c->solver;
    const int n = m->nv;
    int solved;

    /* Z = L^-T rho, in place, and sigma - Y' D^-1 Z */
    rbdi_solve_transposed(m, s->w, s->w->H, n, n, rho);
    for (int r = 0; r < s->rows; ++r) {
        for (int k = 0; k < n; ++k) s->x[k] = s->Y[k * s->stride + r] * s->D_inverse[k];
        rbdi_subtract_product(s->x, rho, n, n, &c->sigma[r * n]);
    }

    /* G y = -T' (...),  dp = S y */
    solver.G = c->sigma + c->max_rows * n;
    solver.sides = n;
    rbdi_list_unknowns(&solver);
    rbdi_newton_matrix(&solver, RBDI_SIDES_PROXIMAL, c->sigma);
    solved = rbdi_newton_solve(&solver);
    rbdi_clear(c->sigma, s->rows * n);
    rbdi_add_increments(&solver, c->sigma);

    /* dnu = -L^-1 D^-1 (Z - Y dp) */
    for (int k = 0; k < n; ++k)
        rbdi_subtract_product(&s->Y[k * s->stride], c->sigma, s->rows, n, &rho[k * n]);
    rbdi_solve_forward(m, s->w, s->w->H, -1, n, n, rho);
    return solved;
}

/* Replaces rho, without d(J' p), by dnu of the solution that has just been found. Returns 0 if one does not
   exist. */
RBDI_LOCAL int rbdi_differentiate_solution(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                           const rbd_real *nu, int purpose, rbd_real *const rho[3]) {
    int solved = 1;

    rbdi_add_side(m, c, rho);
    for (int x = 0; x < 3; ++x) {
        if (!rho[x]) continue;

        rbdi_clear(c->sigma, c->rows->rows * m->nv);
        if (x < 2) rbdi_middle_terms(m, c, d, purpose, x);
        if (x == 0) rbdi_velocity_terms(m, c, d, nu, purpose, rho[0]);
        rbdi_other_terms(m, c, purpose, x);
        solved &= rbdi_solve_derivatives(m, c, rho[x]);
    }
    return solved;
}

RBDI_LOCAL void rbdi_copy_columns(const rbd_model *m, rbd_real *const from[3], rbd_real *const to[3]) {
    for (int x = 0; x < 3; ++x)
        if (from[x])
            for (int k = 0; k < m->nv * m->nv; ++k) to[x][k] = from[x][k];
}

/* Solves for the corrections of the velocity terms. to->dq: rho of the first solution. to->dv becomes dnu
   with the first correction, which has the impulses of the first solution:

       K (dnu_1 - dnu_0) = rho_0 - rho_1    without d(J' p)

   Returns whether they exist. */
RBDI_LOCAL int rbdi_differentiate_corrections(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                              const rbd_real *tau, const rbd_real *f_ext,
                                              const rbdi_step_columns *to) {
    const int size = m->nv * m->nv;
    rbd_work *w = c->rows->w;
    int solved, changed;

    /* dv = -rho_0,  dq = dnu_0 */
    rbdi_copy_columns(m, to->dq, to->dv);
    rbdi_add_side(m, c, to->dv);
    for (int x = 0; x < 3; ++x)
        if (to->dv[x]) rbdi_multiply(to->dv[x], -rbdi_set(RBD_C(1)), size);
    solved = rbdi_differentiate_solution(m, c, d, c->moved, RBDI_FOR_VELOCITIES, to->dq);

    /* dv = dnu_1 = dnu_0 - K^-1 (rho_1 - rho_0) */
    changed = rbdi_solve_between(m, c, tau, f_ext);
    rbdi_add_rho(m, c, d, c->moved, f_ext, to->dq, to->dv);
    rbdi_add_side(m, c, to->dv);
    for (int x = 0; x < 3; ++x) {
        if (!to->dv[x]) continue;
        rbdi_solve_columns(m, w, w->H, -1, m->nv, m->nv, to->dv[x]);
        rbdi_subtract(to->dv[x], -rbdi_set(RBD_C(1)), to->dq[x], size);
    }

    rbdi_solve_again(m, c, tau, f_ext, changed);
    return solved;
}

/* Derivatives of what contacts that may rebound fall: by dnu of the velocities without contacts. */
RBDI_LOCAL void rbdi_differentiate_falls(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                         const rbd_real *f_ext, rbd_real *const dnu[3]) {
    rbd_work *w = c->rows->w;
    rbd_real *nu = c->rows->x;
    int any = 0;

    for (int i = 0; i < c->n; ++i) any |= c->contact[i].row >= 0 && c->contact[i].restitution > 0;
    if (!any) return;

    /* nu = v_mid + L^-1 D^-1 x */
    for (int k = 0; k < m->nv; ++k) nu[k] = c->x[RBDI_X_UNCORRECTED][k];
    rbdi_solve_forward(m, w, w->H, 1, 1, 1, nu);
    for (int k = 0; k < m->nv; ++k) nu[k] = c->v_mid[k] + nu[k];

    /* dnu = -K^-1 rho */
    rbdi_write_rho(m, c, d, nu, f_ext, NULL, dnu);
    rbdi_add_side(m, c, dnu);
    for (int x = 0; x < 3; ++x)
        if (dnu[x]) rbdi_solve_columns(m, w, w->H, -1, m->nv, m->nv, dnu[x]);
    rbdi_write_falls(m, c, nu, dnu);
}

/* Makes the step, and writes derivatives of c->moved and c->nu. Returns whether they exist. */
RBDI_LOCAL int rbdi_differentiate_step(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                       const rbd_real *tau, const rbd_real *f_ext,
                                       const rbdi_step_columns *to, rbd_status *status) {
    const int first_order = !(c->half > 0);
    int solved = 1, positions, velocities;

    /* the first solution, and the corrections */
    rbdi_differentiate_falls(m, c, d, f_ext, to->dq);
    rbdi_solve_first(m, c, first_order ? RBDI_FOR_POSITIONS : RBDI_FOR_VELOCITIES);
    rbdi_write_rho(m, c, d, c->moved, f_ext, NULL, to->dq);
    if (!first_order) {
        solved = rbdi_differentiate_corrections(m, c, d, tau, f_ext, to);
        rbdi_write_rho(m, c, d, c->moved, f_ext, to->dv, to->dq);
    }

    /* c->moved */
    rbdi_copy_columns(m, to->dq, to->dv);
    positions = rbdi_differentiate_solution(m, c, d, c->moved, RBDI_FOR_POSITIONS, to->dq);

    /* c->nu; of a contact that jams c->moved too */
    *status = rbdi_solve_velocities(m, c);
    if (!c->differ) {
        rbdi_copy_columns(m, to->dq, to->dv);
        return solved & positions;
    }

    if (to->dv[0]) rbdi_write_sides(m, c, d, c->nu, f_ext, rbdi_side(m, c, 2), NULL, NULL);
    velocities = rbdi_differentiate_solution(m, c, d, c->nu, RBDI_FOR_VELOCITIES, to->dv);
    if (!c->jams) return solved & positions & velocities;

    rbdi_copy_columns(m, to->dv, to->dq);
    return solved & velocities;
}

RBDI_API rbd_status rbd_contact_step_derivatives(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                                 const rbd_real *q, const rbd_real *v, const rbd_real *tau,
                                                 const rbd_real *f_ext, const rbd_real *damping, rbd_real dt,
                                                 const rbd_contact_step_results *out) {
    const rbd_contact_step_results none_wanted = {NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
    const rbd_contact_step_results to = out ? *out : none_wanted;
    rbdi_step_columns by = {{to.dq_next_dq, to.dq_next_dv, to.dq_next_dtau},
                            {to.dv_next_dq, to.dv_next_dv, to.dv_next_dtau}};
    int pairs = !to.q_next == !to.v_next, solved = 1, size;
    rbd_status status;

    for (int x = 0; x < 3; ++x) pairs &= !by.dq[x] == !by.dv[x];
    status = rbdi_check_step(m, c, d && q && v && tau && out && pairs, dt);
    if (!status) status = rbdi_check_derivatives(m, d, 1);
    if (status) return status;
    if (d->work != c->rows->w) return RBD_ERR_WORK;
    if (!c->sigma) return RBD_ERR_MEMORY;

    /* those by v need those by q */
    size = m->nv * m->nv;
    if (by.dq[1] && !by.dq[0]) {
        by.dq[0] = rbdi_side(m, c, 3);
        by.dv[0] = rbdi_side(m, c, 4);
    }

    rbdi_choose_scheme(c, dt, c->options.first_order);
    status = rbdi_begin_step(m, c, q, v, tau, f_ext, damping);
    if (!status) solved = rbdi_differentiate_step(m, c, d, tau, f_ext, &by, &status);

    /* the half of the step behind q_mid, and the half before */
    for (int x = 0; x < 3; ++x)
        if (by.dq[x] && !status)
            rbdi_move_columns(m, c->points, c->moved, c->nu, c->way, x == 0, by.dq[x], by.dv[x]);
    if (by.dq[0] && !status) {
        rbdi_columns_before(m, c->points, v, c->half, by.dq[0], by.dq[1]);
        rbdi_columns_before(m, c->points, v, c->half, by.dv[0], by.dv[1]);
    }

    for (int x = 0; x < 3; ++x)
        if (by.dq[x]) solved &= rbdi_all_finite(by.dq[x], size) & rbdi_all_finite(by.dv[x], size);
    if (!status && !solved) status = RBD_ERR_SINGULAR;

    /* after an error all are 0 */
    if (status) rbd_contact_reset(c);
    for (int x = 0; x < 3; ++x)
        if (status && by.dq[x]) rbdi_clear(by.dq[x], size);
    for (int x = 0; x < 3; ++x)
        if (status && by.dv[x]) rbdi_clear(by.dv[x], size);

    if (to.q_next) rbdi_contact_move(m, c, status, q, to.q_next, to.v_next);
    return status;
}

/* ==== src/rbd_contact.h ==== */
RBDI_CODE_END

#endif

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("B")
#pragma pop_macro("D")
#pragma pop_macro("E")
#pragma pop_macro("F")
#pragma pop_macro("G")
#pragma pop_macro("H")
#pragma pop_macro("L")
#pragma pop_macro("M")
#pragma pop_macro("Q")
#pragma pop_macro("R")
#pragma pop_macro("S")
#pragma pop_macro("X")
#pragma pop_macro("Y")
