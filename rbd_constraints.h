/* rbd_constraints.h - contacts, closed loops and impacts, on rbd.h.
   Made by src/amalgamate.py from src/rbd_constraints.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   A set of constraints is described and checked once. One call then gives accelerations and constraint
   forces, another one the velocities after an impact. Implemented by the same RBD_IMPLEMENTATION as rbd.h,
   in the same file. A foot that stands:

       #define RBD_IMPLEMENTATION
       #include "rbd_constraints.h"

       const double foot[3] = {0.33, 0, 0};
       rbd_constraint rows[1] = {rbd_point_contact(rbd_body_index(m, "lf_lowerleg"), foot, NULL)};
       unsigned char memory[RBD_CONSTRAINT_SET_SIZE(NV, 3)];
       rbd_constraint_set *c;
       rbd_constraint_set_init(m, w, rows, 1, memory, sizeof memory, &c, NULL);
       rbd_constrained_fd(m, c, q, v, tau, NULL, a, lambda);

   CONTENTS (search for the tag)
     [conventions] [configuration] [limits]
     [description] [set] [calls] [derivatives]
     --- stop here if you only use it ---
     [layout]
     [design] [tolerances] [kinematics] [rows] [factor] [rank] [solution]
     [refinement] [articulated]
     [call code] [weights] [assembly] [set code] [derivatives code]

   [conventions] Beyond those of rbd.h:
     frames       frame 1 is fixed in body 1, frame 2 in body 2, which may be the world. R_1, p_1, w_1, v_1
                  are the orientation and origin of frame 1 in the world, its angular velocity and that of its
                  origin; E = R_2' turns world vectors into the axes of frame 2; s = p_1 - p_2
     position     R = E R_1, r = E s: frame 1 seen from frame 2
     velocity     (E (w_1 - w_2); dr/dt), dr/dt = E (v_1 - v_2 - w_2 x s)
     rows         the components of the velocity whose axes are held, in the order omega_x .. v_z, constraint
                  after constraint: J v
     gamma        dJ/dt v: J a + gamma is the time derivative of J v, on the constraint and off it
     e            the position error. For linear rows it is r, and its rate is J v. For three angular axes
                  it is log R, for two z x (R z), z the unit vector of the free axis; their rate is J v at
                  e = 0. For a single angular axis it is its component of log R, useful for small turns only
     lambda       (moment about the origin of frame 1; force) in the axes of frame 2 that body 2 puts on body
                  1, the held components; the opposite acts on body 2, at the same place: J' lambda

   [configuration] That of rbd.h, without RBD_NO_CHOLESKY.

   [limits]
     A constraint pulls as well as it pushes. rbd_contact.h has contacts that open and slip, with friction.
     Constraints of velocities alone (rolling, knife edges) are not described. M must be regular, also where
     the constraints would make up for it.
*/
#include "rbd.h"
#if defined RBD_DERIVATIVES_H && !defined RBDI_JOINS_DERIVATIVES /* implemented with it: [derivatives] */
#include "rbd_derivatives.h"
#endif

#ifndef RBD_CONSTRAINTS_H
#define RBD_CONSTRAINTS_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_constraints.h is of another version than rbd.h"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/constraints.h ==== */
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

/* ==== src/rbd_constraints.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_CONSTRAINTS_H */

#if defined RBD_DERIVATIVES_H && !defined RBD_NO_CHOLESKY && !defined RBDI_CONSTRAINED_DERIVATIVES
#define RBDI_CONSTRAINED_DERIVATIVES
RBDI_EXTERN_C_BEGIN

/* ==== src/api/constrained_derivatives.h ==== */
/* ---- derivatives [derivatives] ----
   Declared where rbd_derivatives.h is included too. */

/* Arrays for the results of rbd_constrained_fd_derivatives. NULL: not wanted. */
typedef struct rbd_constrained_fd_results {
    rbd_real *a, *lambda;                             /* nv, rows: as rbd_constrained_fd gives them */
    rbd_real *da_dq, *da_dv, *da_dtau;                /* nv x nv */
    rbd_real *dlambda_dq, *dlambda_dv, *dlambda_dtau; /* rows x nv */
} rbd_constrained_fd_results;

/* Derivatives of the results of rbd_constrained_fd, a (nv x nv) and lambda (rows x nv), by q (column k: q
   moves with unit velocity of dof k), v and tau. f_ext stays fixed in its bodies' axes.
   d            of the same work
   out          da_... each with its dlambda_..., both or neither NULL, also where there are no rows; no two
                the same array
   If rows depend on each other, their rank is taken as constant. da is then unique, and dlambda is the
   change of least norm that belongs to it: the lambda of least norm changes by that and by a null vector of
   J'. Errors: as rbd_constrained_fd; RBD_ERR_INFEASIBLE also if rounding keeps a column of da from meeting
   the derivative of a row, which rbd_infeasible_row names; RBD_ERR_WORK also if d has another work;
   RBD_ERR_NULL. Section 5 of Carpentier, Budhiraja and Mansard (2021), and [derivatives code]. */
RBDI_API rbd_status rbd_constrained_fd_derivatives(const rbd_model *m, rbd_constraint_set *c,
                                                   rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                                                   const rbd_real *tau, const rbd_real *f_ext,
                                                   const rbd_constrained_fd_results *out);

/* ==== src/rbd_constraints.h ==== */
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
#pragma push_macro("C")
#undef C
#pragma push_macro("E")
#undef E
#pragma push_macro("H")
#undef H
#pragma push_macro("J")
#undef J
#pragma push_macro("K")
#undef K
#pragma push_macro("L")
#undef L
#pragma push_macro("P")
#undef P
#pragma push_macro("R")
#undef R
#pragma push_macro("S")
#undef S
#pragma push_macro("T")
#undef T
#pragma push_macro("U")
#undef U
#pragma push_macro("V")
#undef V
#pragma push_macro("X")
#undef X
#pragma push_macro("Y")
#undef Y
#pragma push_macro("Z")
#undef Z

/* ==== src/rbd_constraints.h ==== */
#ifndef RBDI_CONSTRAINTS_LAYOUT
#define RBDI_CONSTRAINTS_LAYOUT

/* ==== src/constraints/layout.h ==== */
/* Interface: rbdi_constraint, rbdi_span, RBDI_CONSTRAINTS_BYTES, RBDI_LARGER, RBDI_ROW_BATCH, RBDI_SIX_ROWS
   */

/* ---- layout [layout] ---- */

/* Scalars in the widest SIMD register for which the file with the implementation may be compiled. */
#if defined RBD_LANES || RBDI_REAL_KIND % 3 == 0 || RBDI_WIDEST_SIMD == 0
#define RBDI_ROW_BATCH 1
#else
#define RBDI_ROW_BATCH (RBDI_WIDEST_SIMD * RBDI_REAL_KIND)
#endif

#define RBDI_SIX_ROWS (RBDI_ROW_BATCH > 6 ? RBDI_ROW_BATCH : 6) /* a constraint's rows, padded to batches */

/* A constraint between two links. Arrays of two: of frame 1 and of frame 2. */
typedef struct rbdi_constraint {
    rbd_const rotation[2][9];         /* vectors of the frame into those of the link, row-major */
    rbdi_c3 position[2];              /* of its origin, link axes */
    rbd_const held[3][RBDI_SIX_ROWS]; /* x, y and z of the axis that each row holds, axes of link 2 */
    rbd_const kp, kd;
    int16_t link[2];   /* -1 = world */
    int16_t ancestor;  /* the nearest common ancestor of the two links, -1 = the world */
    int16_t row, rows; /* the first row in the set, and how many */
    int16_t angular;   /* number of angular rows, which come first */
    int16_t axis[6];   /* of each row: 0 .. 5 */
    int16_t dofs;      /* number of entries of `dof` */
    int16_t *dof;      /* dofs on the path to one body or both, ascending */
} rbdi_constraint;

/* Rows in which a dof may have entries: first .. end - 1. In all others its entries are 0. */
typedef struct rbdi_span {
    int16_t first, end;
} rbdi_span;

/* Scratch with an entry for each dof, and for each row. Its users never need it at the same time. */
typedef union rbdi_dof_scratch {
    rbd_real *reflection; /* [rank]: Householder's vector */
    rbd_real *best_x;     /* [refinement] */
} rbdi_dof_scratch;

typedef union rbdi_row_scratch {
    rbd_real *inverse_square; /* [rank]: 1 / the square of the whole row */
    rbd_real *contradicts;    /* [rank]: 1 if a dropped row contradicts those before it */
    rbd_real *best_lambda;    /* [refinement] */
    rbd_real *length;         /* [refinement]: of rows, of J L^-1 */
} rbdi_row_scratch;

struct rbd_constraint_set {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbd_work *w;
    int n, rows, stride; /* constraints; rows; distance of arrays with an entry for each row, padded */
    int links;           /* number of entries of `link` */
    int infeasible;      /* row, -1 = none */
    int pivoted;         /* whether R is that of [rank], its rows in the order of `pivot_row` */
    int factored;        /* whether the factor of M is always used */
    int dirty;           /* whether Y and R have entries that articulated bodies do not write */
    int moving;          /* whether dynamics need the velocities of the links' origins */
    rbdi_constraint *constraint; /* n */
    int16_t *link;               /* links on a path to a body, ascending; none with mimic joints */
    rbdi_span *span;             /* nv: the rows of the constraints whose paths have the dof */
    int16_t *path;               /* nv: scratch, of dofs */
    rbd_real *Y;                 /* nv x stride: J' by dofs, then L^-T J'; or S' K of [articulated] */
    rbd_real *R;                 /* Cholesky factor of Delta, rows x stride; in [rank] first Z, nv x stride */
    rbd_real *x;                 /* nv: right-hand side, then solution */
    rbdi_dof_scratch of_dofs;    /* nv */
    rbd_real *last_step;         /* nv: of assembly */
    rbd_real *D_inverse;         /* nv: 1/D of M = L'DL */
    rbd_real *b, *lambda;        /* stride each: right-hand side and solution of Delta lambda = b */
    rbd_real *velocity, *gamma;  /* stride each: J v; gamma */
    rbd_real *e;                 /* stride: position error */
    rbd_real *target;            /* stride: wanted J x */
    rbd_real *slack;          /* stride: sum of the squares of b's terms; [rank] makes it a tolerance of b */
    rbd_real *square;         /* stride: of a row's part that is independent of those before; a column */
    rbdi_row_scratch of_rows; /* stride */
    rbd_real *pivot_row;      /* stride, [rank]: the row with which row t was exchanged */
    rbd_real *R_inverse;      /* stride: 1 / R_tt, 0 where a row depends on those before it */
    rbd_real noise;           /* a square below which a row's entries may be rounding of J's */
    rbdi_v3 world;            /* acceleration of the world */
};

#define RBDI_CONSTRAINTS_BYTES(nv, n, rows, stride) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_constraint_set)) + \
     RBDI_ROUND((size_t)(n) * sizeof(rbdi_constraint)) + \
     RBDI_ROUND((size_t)(nv) * ((size_t)(n) + 1) * sizeof(int16_t)) + \
     RBDI_ROUND((size_t)(nv) * sizeof(rbdi_span)) + RBDI_ROUND((size_t)(nv) * sizeof(int16_t)) + \
     sizeof(rbd_real) * ((size_t)(nv) * ((size_t)(stride) + 4) + RBDI_LARGER(rows, nv) * (size_t)(stride) + \
                         11 * (size_t)(stride)))
#define RBDI_LARGER(a, b) ((size_t)(a) > (size_t)(b) ? (size_t)(a) : (size_t)(b))

/* Bytes that suffice for any n constraints that hold this many axes together; and for any number of them. */
#define RBD_CONSTRAINT_SET_SIZE_OF(nv, n, rows) \
    RBDI_CONSTRAINTS_BYTES(nv, n, rows, (rows) + 4 * RBDI_ROW_BATCH)
#define RBD_CONSTRAINT_SET_SIZE(nv, rows) RBD_CONSTRAINT_SET_SIZE_OF(nv, rows, rows)

/* ==== src/rbd_constraints.h ==== */
#endif /* RBDI_CONSTRAINTS_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_CONSTRAINTS_IMPLEMENTED && !defined RBDI_JOINS_DERIVATIVES
#define RBDI_CONSTRAINTS_IMPLEMENTED

/* ---- design [design] ----
   There are two ways. Dynamics and impacts use articulated bodies, [articulated]: the work grows with the
   links, and with the lengths of the paths times the squares of their rows. The factor of M costs the squares
   of the paths as well. It serves derivatives, models with mimic joints, sets with more rows than can be
   independent, and each state in which a pivot of the other way is in doubt; [rank] then decides which rows
   are independent.
   HyQ on four points and Atlas on two flat feet, 12 rows each, instructions (gcc 12, -O3 -march=haswell):

                               HyQ     Atlas
       rbd_aba                8394     17426
       articulated bodies    18602     27733
       factor of M           25854     45899

   By the factor: the two equations, with M = L'DL ([packed matrix] of rbd.h), Y = L^-T J' and
   z = D^-1 L^-T (tau - c):

       Delta lambda = r - gamma - Y'z,   Delta = J M^-1 J' = Y' D^-1 Y        r: the wanted J a + gamma
       L a = z + D^-1 Y lambda

   Row k of Y is that of dof k, its columns are the rows of the constraints, so that the entries of one dof
   are contiguous and loops run over batches of rows. A dof has entries only in rows of constraints on a body
   that it moves: its span.

   Gains in time steps. Along a row, de/dt = u = J v and du/dt = -kd u - kp e. Semi-implicit steps make of it

       u+ = (1 - kd dt) u - kp dt e,   e+ = e + dt u+

   whose eigenvalues z solve z^2 - (2 - kd dt - kp dt^2) z + 1 - kd dt = 0. By Jury's test both lie within the
   unit circle if kd dt < 2, kp > 0, kd > 0 and, at z = -1, 4 - 2 kd dt - kp dt^2 > 0. */

RBDI_CODE_BEGIN

#ifdef RBD_NO_CHOLESKY
#error "rbd: rbd_constraints.h needs RBD_NO_CHOLESKY undefined"
#endif

/* ==== src/constraints/tolerances.h ==== */
/* ---- tolerances [tolerances] ---- */

/* RBDI_CLEAR: each pivot of Delta must exceed this share of Delta's diagonal entry, or the state is in doubt.
   Both equations then hold to 1e-11 of their terms. The error of lambda is up to 1 / sqrt(RBDI_CLEAR) times
   the one that its condition explains, because Delta squares the condition of the rows. A larger one costs
   time alone.
   RBDI_RANK: a row counts as independent if the square of its part that is independent of the rows before it
   exceeds this share of the row's square. Rounding leaves some 1e-31, more in ill-conditioned models; a leg
   1e-7 rad from straight has 1e-14.
   RBDI_MOTIONLESS: a row of Z, [rank], that is shorter than this share of its lever arms over the root of D
   is rounding: no joint moves the body along its axis.
   RBDI_FEASIBLE: targets of dependent rows may contradict each other by this share of their terms, because
   positions drift.
   RBDI_LOST: a sum whose magnitude is below this share of a term's has lost so many digits that [refinement]
   looks at the rows. A larger one costs time alone.
   RBDI_MISSED: a row that is off by more than this share of its terms is refined, [refinement]. A
   smaller one costs time alone.
   RBDI_STILL, m/s^2 or rad/s^2: misses below this are not refined. Where constraints hold all joints,
   accelerations are rounding, and their error is no share of them. A smaller one costs time alone.
   RBDI_HELD: and the result must have no row that is off by more than this share of the terms that its length
   and that of the accelerations allow.
   RBDI_DEPENDENT: J' n of the null vector n of rows that truly depend on each other is below this share of
   its terms.
   RBDI_FREE: the share of the least weight that stands for a weight of 0.
   RBDI_SHORT_STEP, rad or m: assembly ends RBDI_CLOSING_STEPS after a step below this times its size. These
   square the error three times, and steps of rounding are below a tenth of it: no test sees ten times more
   or less.
   RBDI_NEAR, rad or m: the largest error e that [assembly] takes for small. A smaller one leaves more loops
   open; with a larger one it takes other steps to the same end: no test sees ten times more.
   RBDI_CLOSED: after it all entries of e must be below this. */
#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_CLEAR 1e-5
#define RBDI_MOTIONLESS 2e-13
#define RBDI_RANK 1e-20
#define RBDI_FEASIBLE 1e-6
#define RBDI_LOST 1e-6
#define RBDI_MISSED 1e-12
#define RBDI_STILL 1e-20
#define RBDI_HELD 1e-9
#define RBDI_DEPENDENT 1e-12
#define RBDI_FREE 1e-13
#define RBDI_SHORT_STEP 1e-12
#define RBDI_CLOSED 1e-9

#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_CLEAR 1e-3f
#define RBDI_MOTIONLESS 4e-6f
#define RBDI_RANK 1e-8f
#define RBDI_FEASIBLE 1e-2f
#define RBDI_LOST 1e-3f
#define RBDI_MISSED 1e-5f
#define RBDI_STILL 1e-9f
#define RBDI_HELD 1e-3f
#define RBDI_DEPENDENT 1e-5f
#define RBDI_FREE 1e-6f
#define RBDI_SHORT_STEP 1e-5f
#define RBDI_CLOSED 1e-4f

#else
#define RBDI_CLEAR RBD_C(1e-10)
#define RBDI_MOTIONLESS RBD_C(2e-31)
#define RBDI_RANK RBD_C(1e-54)
#define RBDI_FEASIBLE RBD_C(1e-12)
#define RBDI_LOST RBD_C(1e-15)
#define RBDI_MISSED RBD_C(1e-28)
#define RBDI_STILL RBD_C(1e-40)
#define RBDI_HELD RBD_C(1e-24)
#define RBDI_DEPENDENT RBD_C(1e-29)
#define RBDI_FREE RBD_C(1e-26)
#define RBDI_SHORT_STEP RBD_C(1e-24)
#define RBDI_CLOSED RBD_C(1e-12)

#endif

#define RBDI_CLEARLY_MORE RBD_C(1.001) /* of shares that differ by rounding alone the first is taken */
#define RBDI_LEAST_WEIGHT RBD_C(1e-20) /* 1 / (this RBDI_FREE), times squares of lengths, is no overflow */
#define RBDI_MOST_WEIGHT RBD_C(1e30)
#define RBDI_LONGEST_STEP RBD_C(0.5)
#define RBDI_NEAR RBD_C(0.1)
/* Bounds of the step size keep a wild estimate from doing harm. With other bounds [assembly] takes other
   steps to the same end: no test sees ten times more or less. */
#define RBDI_LEAST_STEP_SIZE RBD_C(1e-3)
#define RBDI_MOST_STEP_SIZE RBD_C(5)

#define RBDI_REFINEMENTS 24 /* each gains some digits: enough for all that fit into an exponent */
#define RBDI_NEARING_STEPS 200
#define RBDI_CLOSING_STEPS 3

/* ==== src/constraints/kinematics.h ==== */
/* Interface: rbdi_add_held, rbdi_axes_held, rbdi_frame_origin, rbdi_relative_motion, rbdi_relative_motion_of,
   rbdi_set_axes */

/* ---- kinematics [kinematics] ---- */

/* Motion of a point fixed in a link, world axes: place, angular velocity, velocity, and their rates. */
typedef struct rbdi_station {
    rbdi_v3 p, omega, v, omega_dot, acc;
} rbdi_station;

/* Motion of the point of a link that is at p now. Link -1 is the world, which accelerates by -gravity where
   gravity is an acceleration of the world. */
RBDI_INLINE rbdi_station rbdi_station_at(const rbd_constraint_set *c, int link, rbdi_v3 p) {
    rbdi_station at;
    at.p = p;
    at.omega = at.v = at.omega_dot = rbdi_vec0();
    at.acc = c->world;

    if (link >= 0) {
        const rbdi_kin *kin = &c->w->kin[link];
        const rbdi_mat E = kin->X.E;
        const rbdi_v3 arm = rbdi_sub(p, kin->X.r);
        rbdi_v3 turn;

        /* v + omega x arm */
        at.omega = rbdi_mul_t(E, kin->state.omega);
        turn = rbdi_cross(at.omega, arm);
        at.v = rbdi_add(rbdi_mul_t(E, kin->v), turn);

        /* acc + omega_dot x arm + omega x (omega x arm) */
        at.omega_dot = rbdi_mul_t(E, kin->state.omega_dot);
        at.acc = rbdi_add(rbdi_mul_t(E, kin->state.acc), rbdi_cross(at.omega_dot, arm));
        at.acc = rbdi_add(at.acc, rbdi_cross(at.omega, turn));
    }
    return at;
}

/* Origin of a constraint's frame in the world. */
RBDI_INLINE rbdi_v3 rbdi_frame_origin(const rbd_constraint_set *c, const rbdi_constraint *con, int side) {
    const rbdi_v3 origin = rbdi_vec_c(con->position[side]);
    return con->link[side] < 0 ? origin : rbdi_point_p(&c->w->kin[con->link[side]], origin);
}

/* Motion of the bodies at the origin of frame 1. */
typedef struct rbdi_relative_motion {
    rbdi_station body[2];
    rbdi_motion velocity, rate; /* of body 1 relative to body 2, and its rate in axes that turn with body 2 */
} rbdi_relative_motion;

RBDI_ONCE rbdi_relative_motion rbdi_relative_motion_of(const rbd_constraint_set *c,
                                                       const rbdi_constraint *con) {
    const rbdi_v3 p = rbdi_frame_origin(c, con, 0);
    const rbdi_station one = rbdi_station_at(c, con->link[0], p);
    const rbdi_station two = rbdi_station_at(c, con->link[1], p);
    rbdi_relative_motion relative;
    relative.body[0] = one;
    relative.body[1] = two;
    relative.velocity.omega = rbdi_sub(one.omega, two.omega);
    relative.velocity.v = rbdi_sub(one.v, two.v);
    relative.rate.omega = rbdi_sub(one.omega_dot, two.omega_dot);
    relative.rate.v = rbdi_sub(one.acc, two.acc);

    /* axes that turn with body 2: alpha - omega_2 x w, acc - omega_2 x 2 u */
    if (con->link[1] >= 0) {
        relative.rate.omega = rbdi_sub(relative.rate.omega, rbdi_cross(two.omega, relative.velocity.omega));
        relative.rate.v = rbdi_sub(relative.rate.v,
                                   rbdi_cross(two.omega, rbdi_add(relative.velocity.v, relative.velocity.v)));
    }
    return relative;
}

/* Orientation of a constraint's frame in the world. */
RBDI_LOCAL rbdi_mat rbdi_frame_axes(const rbd_constraint_set *c, const rbdi_constraint *con, int side) {
    const rbdi_mat R = rbdi_mat_c(con->rotation[side]);
    return con->link[side] < 0 ? R : rbdi_mul_mat(rbdi_transpose(c->w->kin[con->link[side]].X.E), R);
}

/* The factor in the derivative of w = log R by the turn z of body 1, in the axes of z:

       z - w x z / 2 + factor w x (w x z),   factor = (1 - |w|/2 cot(|w|/2)) / |w|^2

   from the tails of sine and cosine in [steps code]. */
RBDI_LOCAL rbd_real rbdi_log_square(rbdi_v3 w) {
    const rbdi_exp e = rbdi_exp_of(w);
    const rbdi_mask near_zero = rbdi_less(e.x, rbdi_set(RBD_C(1)));
    const rbd_real c4 = rbdi_select(near_zero, rbdi_tail(rbdi_select(near_zero, e.x, rbdi_zero()), 4),
                                    (RBD_C(0.5) - e.B) / e.x);
    return (e.C - (c4 + c4)) / (e.B + e.B);
}

/* Angular part of the position error e, axes of frame 2: [conventions]. If two axes are held, it is f x R f
   with the free axis f. R: frame 1 seen from frame 2. */
RBDI_LOCAL rbdi_v3 rbdi_angular_error(const rbdi_constraint *con, rbdi_mat R) {
    const rbd_real o = rbdi_zero();
    int free;
    if (con->angular != 2) return rbdi_log_rotation(R);

    free = 3 - con->axis[0] - con->axis[1];
    if (free == 0) return rbdi_vec(o, -R.zx, R.yx);
    if (free == 1) return rbdi_vec(R.zy, o, -R.xy);
    return rbdi_vec(-R.yz, R.xz, o);
}

/* The axes that a constraint holds, world axes, rows as lanes: x, y, z of the axes of angular rows, then of
   linear rows; 0 where the row is of the other kind. */
typedef struct rbdi_axes_held {
    rbd_real axis[6][RBDI_SIX_ROWS];
} rbdi_axes_held;

RBDI_ONCE void rbdi_set_axes(const rbd_constraint_set *c, const rbdi_constraint *con, rbdi_axes_held *h) {
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());
    for (int r = 0; r < con->rows; r += RBDI_BATCH)
        for (int i = con->angular ? 0 : 3; i < 6; ++i) *(rbdi_batch *)&h->axis[i][r] = zero;

    for (int r = 0; r < con->rows; ++r) {
        const int first = r < con->angular ? 0 : 3;
        rbdi_v3 axis =
            rbdi_vec(rbdi_set(con->held[0][r]), rbdi_set(con->held[1][r]), rbdi_set(con->held[2][r]));
        if (con->link[1] >= 0) axis = rbdi_mul_t(c->w->kin[con->link[1]].X.E, axis);

        h->axis[first][r] = axis.x;
        h->axis[first + 1][r] = axis.y;
        h->axis[first + 2][r] = axis.z;
    }
}

/* Makes the axis a of a single angular row the one whose product with a turn z of body 1 is the derivative of
   a . w, w = log R in world axes: a + w x a / 2 + factor w x (w x a), with the factor of rbdi_log_square. */
RBDI_LOCAL void rbdi_bend_axis(const rbd_constraint_set *c, const rbdi_constraint *con, rbdi_axes_held *h) {
    const rbdi_mat R = rbdi_frame_axes(c, con, 1);
    const rbdi_v3 log_R = rbdi_log_rotation(rbdi_mul_mat(rbdi_transpose(R), rbdi_frame_axes(c, con, 0)));
    const rbdi_v3 w = rbdi_mul(R, log_R);
    const rbdi_v3 a = rbdi_vec(h->axis[0][0], h->axis[1][0], h->axis[2][0]);
    const rbdi_v3 across = rbdi_cross(w, a);
    const rbdi_v3 more = rbdi_scale(rbdi_log_square(log_R), rbdi_cross(w, across));
    const rbdi_v3 bent = rbdi_add(rbdi_add(a, rbdi_scale(rbdi_set(RBD_C(0.5)), across)), more);

    h->axis[0][0] = bent.x;
    h->axis[1][0] = bent.y;
    h->axis[2][0] = bent.z;
}

/* Adds the components of (angular; linear), world axes, along the axes that a constraint holds. */
RBDI_ONCE void rbdi_add_held(const rbdi_constraint *con, const rbdi_axes_held *h, rbdi_v3 angular,
                             rbdi_v3 linear, rbd_real *out) {
    for (int r = 0; r < con->rows; r += RBDI_BATCH) {
        rbdi_batch sum = *(const rbdi_batch *)&out[r];

        sum = sum + *(const rbdi_batch *)&h->axis[3][r] * linear.x +
              *(const rbdi_batch *)&h->axis[4][r] * linear.y + *(const rbdi_batch *)&h->axis[5][r] * linear.z;
        if (con->angular)
            sum = sum + *(const rbdi_batch *)&h->axis[0][r] * angular.x +
                  *(const rbdi_batch *)&h->axis[1][r] * angular.y +
                  *(const rbdi_batch *)&h->axis[2][r] * angular.z;

        *(rbdi_batch *)&out[r] = sum;
    }
}

/* Adds gamma and J v of a constraint and, if `errors`, e. Returns the origin of frame 1 in the world. */
RBDI_ONCE rbdi_v3 rbdi_constraint_motion(rbd_constraint_set *c, const rbdi_constraint *con,
                                         const rbdi_axes_held *h, int errors) {
    const rbdi_relative_motion relative = rbdi_relative_motion_of(c, con);
    const rbdi_v3 p = relative.body[0].p;
    rbdi_add_held(con, h, relative.rate.omega, relative.rate.v, &c->gamma[con->row]);
    rbdi_add_held(con, h, relative.velocity.omega, relative.velocity.v, &c->velocity[con->row]);

    if (errors) {
        rbdi_v3 turn = rbdi_vec0();

        if (con->angular) {
            const rbdi_mat R = rbdi_frame_axes(c, con, 1);
            turn = rbdi_angular_error(con, rbdi_mul_mat(rbdi_transpose(R), rbdi_frame_axes(c, con, 0)));
            turn = rbdi_mul(R, turn);
        }

        rbdi_add_held(con, h, turn, rbdi_sub(p, rbdi_frame_origin(c, con, 1)), &c->e[con->row]);
    }
    return p;
}

/* ==== src/constraints/rows.h ==== */
/* Interface: rbdi_constraint_columns, rbdi_constraint_rows, rbdi_constraint_state, rbdi_next_link, rbdi_walk,
   rbdi_walk_of */

/* ---- rows [rows] ---- */

/* Adds a motion, world axes, that a dof gives to body 1 at the origin of frame 1, to the dof's column of J.
   sign: -1 if it gives the motion to body 2. A mimic joint's goes to the joint that it follows. */
RBDI_ONCE void rbdi_constraint_column(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                      const rbdi_axes_held *h, int dof, int sign, rbdi_v3 angular,
                                      rbdi_v3 linear) {
    if (sign < 0 || dof >= m->nv) {
        const rbd_real ratio = sign < 0 ? -rbdi_ratio(m, dof) : rbdi_ratio(m, dof);
        angular = rbdi_scale(ratio, angular);
        linear = rbdi_scale(ratio, linear);
    }

    rbdi_add_held(con, h, angular, linear, &c->Y[rbdi_source(m, dof) * c->stride + con->row]);
}

/* Columns of the dofs of a link on a path. p: origin of frame 1, arm = p less the link's origin.

       turn about z         (z; z x arm)
       slide along z        (0; z)
       screw                (rho z; kappa z + rho z x arm)

   A block has turns about x, y, z and slides along them, in this order, from its first axis on. */
RBDI_INLINE void rbdi_constraint_link(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                      const rbdi_axes_held *h, rbdi_v3 p, int link, int sign) {
    const rbdi_link *l = &m->link[link];
    const rbdi_pose X = c->w->kin[link].X;
    const rbdi_v3 arm = rbdi_sub(p, X.r), z = rbdi_vec(X.E.zx, X.E.zy, X.E.zz), o = rbdi_vec0();

    if (rbdi_is(l, RBDI_REVOLUTE) || rbdi_is(l, RBDI_REVOLUTE_CS)) {
        rbdi_constraint_column(m, c, con, h, l->iv, sign, z, rbdi_cross(z, arm));
    } else if (rbdi_is(l, RBDI_SCREW)) {
        const rbdi_v3 turn = rbdi_scale(rbdi_set(l->rho), z), slide = rbdi_scale(rbdi_set(l->kappa), z);
        rbdi_constraint_column(m, c, con, h, l->iv, sign, turn, rbdi_add(slide, rbdi_cross(turn, arm)));
    } else {
        const rbdi_v3 axis[3] = {rbdi_vec(X.E.xx, X.E.xy, X.E.xz), rbdi_vec(X.E.yx, X.E.yy, X.E.yz), z};
        const int first = rbdi_block_of(m, l)->first;
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const int at = first + j;
            rbdi_constraint_column(m, c, con, h, l->iv + j, sign, at < 3 ? axis[at] : o,
                                   at < 3 ? rbdi_cross(axis[at], arm) : axis[at - 3]);
        }
    }
}

/* A walk over the links that move only one of a constraint's two bodies, from the bodies to their common
   ancestor. The motions of links on both paths cancel. */
typedef struct rbdi_walk {
    int end[2]; /* the next link on the path of body 1 and of body 2 */
    int link;   /* the link that the walk is at */
    int side;   /* 0 if it moves body 1, 1 if body 2 */
} rbdi_walk;

RBDI_INLINE rbdi_walk rbdi_walk_of(const rbdi_constraint *con) {
    const rbdi_walk walk = {{con->link[0], con->link[1]}, -1, 0};
    return walk;
}

/* Steps to the next link: of the two ends the one with the larger index, which its parent replaces. Returns
   0 at the common ancestor. */
RBDI_INLINE int rbdi_next_link(const rbd_model *m, rbdi_walk *walk) {
    if (walk->end[0] == walk->end[1]) return 0;

    walk->side = walk->end[0] < walk->end[1];
    walk->link = walk->end[walk->side];
    walk->end[walk->side] = m->link[walk->link].parent;
    return 1;
}

/* Poses of the links on a path and, if `moving`, velocities of their origins, from the angular velocities. */
RBDI_LOCAL void rbdi_kin_of_paths(const rbd_model *m, rbd_constraint_set *c, const rbd_real *v, int moving) {
    for (int n = 0; n < c->links;) {
        const int first = c->link[n];
        int end = first;

        /* consecutive links in one call */
        for (; n < c->links && c->link[n] == end; ++n) ++end;
        rbdi_kin_links(m, c->w, first, end, v, moving);
    }

    if (rbdi_mimics(m)) rbdi_kin_links(m, c->w, 0, m->nl, v, moving);
}

/* Writes the motion of all links and the poses of those on a path into the work, over the results of
   rbd_kinematics; if `wrench`, also the wrenches of inverse dynamics. Gravity is an acceleration of the
   world. Call rbdi_joints before. */
RBDI_INLINE void rbdi_constraint_state(const rbd_model *m, rbd_constraint_set *c, const rbd_real *v,
                                       const rbd_real *a, rbdi_c3 gravity, int wrench) {
    rbd_work *w = c->w;
    const rbdi_state world = rbdi_world_state(gravity);
    c->world = world.acc;
    w->kinematics_of = RBDI_NO_KINEMATICS;

    rbdi_forward(m, w, 0, m->nl, &world, v, a, wrench, 1);
    rbdi_kin_of_paths(m, c, v, 1);
}

/* Clears J v, gamma, e, Y and R. Articulated bodies read entries of Y and R that they do not write. */
RBDI_LOCAL void rbdi_clear_rows(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_clear(c->Y, m->nv * c->stride);
    rbdi_clear(c->R, c->rows * c->stride);
    rbdi_clear(c->velocity, 3 * c->stride);
    c->dirty = 1;
}

/* Adds Y = J' of a constraint. p: origin of frame 1. */
RBDI_LOCAL void rbdi_constraint_columns(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                        const rbdi_axes_held *h, rbdi_v3 p) {
    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);)
        rbdi_constraint_link(m, c, con, h, p, walk.link, walk.side ? -1 : 1);
}

enum { RBDI_SLOPES = 2 };

/* Adds Y = J', gamma and J v of a constraint and, if `errors`, e. With errors = RBDI_SLOPES, Y = (de/dq)',
   which differs from J' in the row of a single angular axis. */
RBDI_LOCAL void rbdi_constraint_rows(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                     int errors) {
    rbdi_axes_held h;
    rbdi_v3 p;

    rbdi_set_axes(c, con, &h);
    p = rbdi_constraint_motion(c, con, &h, errors);

    if (errors == RBDI_SLOPES && con->angular == 1) rbdi_bend_axis(c, con, &h);
    rbdi_constraint_columns(m, c, con, &h, p);
}

/* ==== src/constraints/factor.h ==== */
/* Interface: rbdi_bound_noise, rbdi_delta */

/* ---- factor [factor] ----
   Both ways of [design] factor Delta = Y' D^-1 Y by Cholesky and solve Delta lambda = b:

       Delta = R'R,   R' beta = b,   R lambda = beta

   b stands in column `rows` of Delta's array, and becomes beta while R replaces Delta. */

/* x'y */
RBDI_INLINE rbd_real rbdi_rows_product(const rbd_real *x, const rbd_real *y, int n) {
    rbdi_sum batches = rbdi_sum_of_none();
    rbd_real sum;
    int k = 0;

    for (; k + RBDI_BATCH <= n; k += RBDI_BATCH)
        batches = rbdi_sum_and(batches, *(const rbdi_batch *)&x[k] * *(const rbdi_batch *)&y[k]);

    sum = rbdi_sum_value(batches);
    for (; k < n; ++k) sum = sum + x[k] * y[k];
    return sum;
}

/* Computes c->noise. Rounding in an entry of J is a share of its lever arm, here the distance r of a link
   from the world's origin; Delta has its square times 1/D:

       noise = RBDI_MOTIONLESS^2 (1 + sum r^2) sum 1/D */
RBDI_LOCAL void rbdi_bound_noise(const rbd_model *m, rbd_constraint_set *c) {
    rbd_real levers = rbdi_set(RBD_C(1)), inverse = rbdi_zero();

    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        for (int side = 0; side < 2; ++side)
            if (con->link[side] >= 0)
                levers = levers + rbdi_dot(c->w->kin[con->link[side]].X.r, c->w->kin[con->link[side]].X.r);

    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) inverse = inverse + c->D_inverse[k];

    c->noise = levers * inverse * (RBDI_MOTIONLESS * RBDI_MOTIONLESS);
}

/* Two consecutive batches of a row. */
typedef struct rbdi_batches {
    rbdi_batch first, second;
} rbdi_batches;

/* Rows i .. i + n - 1 of Delta = Y' D^-1 Y from the diagonal on, and b behind them. dof: where they have
   entries. */
RBDI_INLINE void rbdi_delta_rows(const rbd_constraint_set *c, const int16_t *dof, int dofs, int i, int n) {
    const int stride = c->stride;
    rbd_real *R = c->R + i * stride;
    for (int j = i; j <= c->rows; j += 2 * RBDI_BATCH) {
        rbdi_batches sum[6];
        RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
            sum[r].first = sum[r].second = rbdi_all_lanes(rbdi_zero());
        }

        while (dofs > 0 && c->span[dof[dofs - 1]].end <= j) --dofs; /* its rows of Y end there */
        for (int t = 0; t < dofs; ++t) {
            const rbd_real *own = c->Y + dof[t] * stride, inverse = c->D_inverse[dof[t]];
            const rbdi_batch first = *(const rbdi_batch *)&own[j] * inverse,
                             second = *(const rbdi_batch *)&own[j + RBDI_BATCH] * inverse;

            RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
                sum[r].first = sum[r].first + first * own[i + r];
                sum[r].second = sum[r].second + second * own[i + r];
            }
        }

        RBDI_UNROLL_SIX for (int r = 0; r < n; ++r) {
            *(rbdi_batch *)&R[r * stride + j] = sum[r].first;
            *(rbdi_batch *)&R[r * stride + j + RBDI_BATCH] = sum[r].second;
        }
    }

    for (int r = 0; r < n; ++r) R[r * stride + c->rows] = c->b[i + r];
}

/* The same for any number of rows, in blocks of 6 and 3 as constants for the compiler. dof: ascending. */
RBDI_LOCAL void rbdi_delta(const rbd_constraint_set *c, const int16_t *dof, int dofs, int row, int rows) {
    for (int i = row, n; i < row + rows; i += n) {
        n = row + rows - i >= 6 ? 6 : row + rows - i >= 3 ? 3 : 1;

        if (RBDI_FOR_SPEED && n == 6)
            rbdi_delta_rows(c, dof, dofs, i, 6);
        else if (RBDI_FOR_SPEED && n == 3)
            rbdi_delta_rows(c, dof, dofs, i, 3);
        else
            rbdi_delta_rows(c, dof, dofs, i, n);
    }
}

/* Two batches of row t of Delta from column j on, minus the products of the rows of R before it:

       Delta_tj - sum_(i < t) R_it R_ij */
RBDI_INLINE rbdi_batches rbdi_less_rows(const rbd_constraint_set *c, int t, int j) {
    const int stride = c->stride;
    const rbd_real *row = &c->R[t * stride];
    rbdi_batches two = {*(const rbdi_batch *)&row[j], *(const rbdi_batch *)&row[j + RBDI_BATCH]};

    for (const rbd_real *before = c->R; before < row; before += stride) {
        two.first = two.first - *(const rbdi_batch *)&before[j] * before[t];
        two.second = two.second - *(const rbdi_batch *)&before[j + RBDI_BATCH] * before[t];
    }

    return two;
}

/* Replaces row t of Delta by that of R, and b_t by beta_t. noise: c->noise / RBDI_CLEAR. Returns whether the
   pivot is in doubt. */
RBDI_INLINE rbdi_mask rbdi_factor_row(rbd_constraint_set *c, int t, rbd_real noise) {
    rbd_real *R = &c->R[t * c->stride], inverse;
    const rbd_real least = (R[t] + noise) * RBDI_CLEAR;
    rbdi_mask none = rbdi_less(least, least), doubt;
    rbdi_batches two = rbdi_less_rows(c, t, t);

    /* the pivot R_tt^2 beside Delta_tt */
    *(rbdi_batch *)&R[t] = two.first;
    doubt = rbdi_not(rbdi_less(least, R[t]));
#ifdef RBDI_ROWS /* rbd-codegen: the verdict comes behind what is recorded */
    RBDI_ROWS(pivot)(R[t], least);
#endif

    /* the row over its root, and beta_t in its column `rows` */
    inverse = rbdi_sqrt(rbdi_reciprocal(R[t], RBDI_TINY, &none));
    c->R_inverse[t] = inverse;
    for (int j = t;;) {
        *(rbdi_batch *)&R[j] = two.first * inverse;
        *(rbdi_batch *)&R[j + RBDI_BATCH] = two.second * inverse;
        j += 2 * RBDI_BATCH;
        if (j > c->rows) return doubt;
        two = rbdi_less_rows(c, t, j);
    }
}

/* Solves R lambda = beta: lambda_t = (beta_t - sum_(j > t) R_tj lambda_j) / R_tt. Entries of lambda behind
   the last row are 0. */
RBDI_LOCAL void rbdi_back_substitute(rbd_constraint_set *c) {
    for (int t = c->rows - 1; t >= 0; --t) {
        const rbd_real *R = &c->R[t * c->stride];
        rbdi_sum sum = rbdi_sum_of_none();
        for (int j = t + 1; j < c->rows; j += RBDI_BATCH)
            sum = rbdi_sum_and(sum, *(const rbdi_batch *)&R[j] * *(const rbdi_batch *)&c->lambda[j]);
        c->lambda[t] = c->R_inverse[t] * (R[c->rows] - rbdi_sum_value(sum));
    }
}

/* Computes R and beta from Y, D and b. Returns whether a pivot is in doubt. */
RBDI_LOCAL rbdi_mask rbdi_factor_delta(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    rbd_real noise;
    rbdi_bound_noise(m, c);
    noise = c->noise * (1 / RBDI_CLEAR);

    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        rbdi_delta(c, con->dof, con->dofs, con->row, con->rows);
        for (int t = con->row; t < con->row + con->rows; ++t)
            doubt = rbdi_or(doubt, rbdi_factor_row(c, t, noise));
    }

    return doubt;
}

/* ==== src/constraints/rank.h ==== */
/* ---- rank [rank] ----
   If a pivot of Delta = Z'Z, Z = D^-1/2 Y, is in doubt, Z is factored instead. Its condition number is the
   square root of Delta's:

       Z P = Q R,    Delta = P R' R P'

   by Householder's reflections with column pivoting (Golub and Van Loan, Matrix Computations, section 5.4.2).
   A row of a constraint is a column of Z. Each step takes the row with the largest share that is independent
   of the rows taken before, and P exchanges it with the row in its place. So the state decides the order, not
   the caller. Once the largest share is rounding ([tolerances]), all remaining rows depend on those taken:
   they are dropped, 1/R_tt = 0.

   Q is not needed. R' beta = b and R lambda = beta give lambda, 0 for dropped rows. The equation of motion
   then holds to rounding whatever the rank is, and so do the rows taken. For a dropped row j, R n = 0 with
   n_j = 1 gives a null vector n: J' n = 0. The rows agree only if n' b = 0. The null vectors are made
   orthogonal to each other (Gram and Schmidt); lambda less its components along them has the least norm.

   Lanes may differ in order and rank, so no branch depends on one lane alone. */

RBDI_LOCAL rbdi_mask rbdi_is_index(rbd_real x, int k) {
    return rbdi_and(rbdi_less(rbdi_set(RBD_C(k) - RBD_C(0.5)), x),
                    rbdi_less(x, rbdi_set(RBD_C(k) + RBD_C(0.5))));
}

RBDI_LOCAL rbdi_mask rbdi_dropped(const rbd_constraint_set *c, int t) {
    return rbdi_not(rbdi_less(rbdi_zero(), rbdi_abs(c->R_inverse[t])));
}

/* Exchanges entry t of x with that of row pivot_row[t]. Entries of x are `step` apart. Does so for `count`
   vectors x, `next` apart. */
RBDI_LOCAL void rbdi_exchange(const rbd_constraint_set *c, int t, rbd_real *x, int step, int count,
                              int next) {
    for (int j = t + 1; j < c->rows; ++j) {
        const rbdi_mask here = rbdi_is_index(c->pivot_row[t], j);
        if (!rbdi_any(here)) continue;

        for (int i = 0; i < count; ++i) {
            rbd_real *one = x + t * step + i * next, *two = x + j * step + i * next;
            const rbd_real old = *one;
            *one = rbdi_select(here, *two, old);
            *two = rbdi_select(here, old, *two);
        }
    }
}

/* P' X or, if `back`, P X. X: rows x columns. */
RBDI_LOCAL void rbdi_permute(const rbd_constraint_set *c, rbd_real *X, int columns, int back) {
    for (int t = 0; c->pivoted && t < c->rows; ++t)
        rbdi_exchange(c, back ? c->rows - 1 - t : t, X, columns, columns, 1);
}

/* c->square of the rows from t on: of column j of Z, after t reflections, the sum of Z_kj^2 from k = t on. */
RBDI_LOCAL void rbdi_independent_squares(const rbd_constraint_set *c, int nv, int t) {
    for (int j = t; j < c->rows; j += RBDI_BATCH) {
        rbdi_batch sum = rbdi_all_lanes(rbdi_zero());

        for (int k = t; k < nv; ++k) {
            const rbdi_batch z = *(const rbdi_batch *)&c->R[k * c->stride + j];
            sum = sum + z * z;
        }

        *(rbdi_batch *)&c->square[j] = sum;
    }
}

/* Exchanges row t with the row that has the largest independent share. */
RBDI_LOCAL void rbdi_choose_row(rbd_constraint_set *c, int nv, int t) {
    rbd_real best = c->square[t] * c->of_rows.inverse_square[t], at = rbdi_set(RBD_C(t));

    for (int j = t + 1; j < c->rows; ++j) {
        const rbd_real share = c->square[j] * c->of_rows.inverse_square[j];
        const rbdi_mask more = rbdi_less(best * RBDI_CLEARLY_MORE, share);
        best = rbdi_select(more, share, best);
        at = rbdi_select(more, rbdi_set(RBD_C(j)), at);
    }

    c->pivot_row[t] = at;
    rbdi_exchange(c, t, c->R, 1, nv, c->stride);
    rbdi_exchange(c, t, c->square, 1, 1, 0);
    rbdi_exchange(c, t, c->of_rows.inverse_square, 1, 1, 0);
}

/* Householder's reflection that leaves R_tt as the last entry of column t other than 0. For each column z
   from row t on, with x that of column t:

       h = x - R e_1,   R = -sign(x_1) |x|,   z -= h (h'z) / (|x| (|x| + |x_1|)) */
RBDI_LOCAL void rbdi_reflect(rbd_constraint_set *c, int nv, int t) {
    const int stride = c->stride;
    rbd_real *Z = c->R, *h = c->of_dofs.reflection;
    rbdi_mask none = rbdi_less(rbdi_zero(), rbdi_zero());
    const rbd_real head = Z[t * stride + t], length = rbdi_sqrt(c->square[t]),
                   R = rbdi_select(rbdi_less(head, rbdi_zero()), length, -length),
                   scale = rbdi_reciprocal(length * (length + rbdi_abs(head)), RBDI_TINY, &none);

    for (int k = t; k < nv; ++k) h[k] = Z[k * stride + t];
    h[t] = head - R;

    for (int j = t + 1; j < c->rows; j += RBDI_BATCH) {
        rbdi_batch sum = rbdi_all_lanes(rbdi_zero());
        for (int k = t; k < nv; ++k) sum = sum + *(const rbdi_batch *)&Z[k * stride + j] * h[k];

        sum = sum * scale;
        for (int k = t; k < nv; ++k) {
            rbdi_batch *z = (rbdi_batch *)&Z[k * stride + j];
            *z = *z - sum * h[k];
        }
    }

    Z[t * stride + t] = R;
}

/* Writes Z = D^-1/2 Y to c->R, and the squares of its columns. No row is taken yet. */
RBDI_LOCAL void rbdi_start_ranking(rbd_constraint_set *c, int nv) {
    const rbd_real noise = c->noise * (1 / RBDI_RANK), one = rbdi_set(RBD_C(1));

    for (int k = 0; k < nv; ++k) {
        const rbd_real root = rbdi_sqrt(c->D_inverse[k]);
        for (int j = 0; j < c->stride; j += RBDI_BATCH)
            *(rbdi_batch *)&c->R[k * c->stride + j] = *(const rbdi_batch *)&c->Y[k * c->stride + j] * root;
    }
    if (c->rows > nv) rbdi_clear(&c->R[nv * c->stride], (c->rows - nv) * c->stride);

    rbdi_independent_squares(c, nv, 0);
    for (int r = 0; r < c->rows; ++r) {
        rbdi_mask none = rbdi_less(one, rbdi_zero());
        c->of_rows.inverse_square[r] = rbdi_reciprocal(c->square[r] + noise, RBDI_TINY, &none);
        c->R_inverse[r] = rbdi_zero();
        c->pivot_row[r] = rbdi_set(RBD_C(r));
    }
}

/* R of all rows, and 1/R_tt, which is 0 if row t depends on those before it. */
RBDI_LOCAL void rbdi_orthogonalise(const rbd_model *m, rbd_constraint_set *c) {
    const rbd_real one = rbdi_set(RBD_C(1));
    const int nv = m->nv, steps = c->rows < nv ? c->rows : nv;
    rbdi_mask taken = rbdi_less(rbdi_zero(), one);

    rbdi_start_ranking(c, nv);
    for (int t = 0; t < steps; ++t) {
        if (t > 0) rbdi_independent_squares(c, nv, t);
        rbdi_choose_row(c, nv, t);
        taken = rbdi_and(
            taken, rbdi_not(rbdi_less(c->square[t] * c->of_rows.inverse_square[t], rbdi_set(RBDI_RANK))));
        if (!rbdi_any(taken)) return;

        rbdi_reflect(c, nv, t);
        c->R_inverse[t] =
            rbdi_select(taken, one / rbdi_select(taken, c->R[t * c->stride + t], one), rbdi_zero());
    }
}

/* The null vector of a dropped row t, 0 in lanes that took the row. Its t + 1 entries replace row t of c->R
   up to the diagonal, which is no longer needed. */
RBDI_LOCAL rbd_real *rbdi_null_vector(const rbd_constraint_set *c, int t) { return &c->R[t * c->stride]; }

/* x -= n (n'x) / n'n where `mask`, n the null vector of dropped row t. */
RBDI_LOCAL void rbdi_project_along(const rbd_constraint_set *c, int t, rbdi_mask mask, rbd_real *x) {
    const rbd_real *null = rbdi_null_vector(c, t);
    rbdi_mask none = rbdi_less(null[0], null[0]); /* its length is 0, or at least 1 */
    rbd_real factor = rbdi_rows_product(null, x, t + 1) *
                      rbdi_reciprocal(rbdi_rows_product(null, null, t + 1), RBD_C(0.5), &none);

    factor = rbdi_select(mask, factor, rbdi_zero());
    for (int i = 0; i <= t; ++i) x[i] = x[i] - factor * null[i];
}

/* x loses its components along the null vectors of the rows before row `end`. */
RBDI_LOCAL void rbdi_project(const rbd_constraint_set *c, int end, rbd_real *x) {
    for (int t = 0; t < end; ++t) {
        const rbdi_mask dropped = rbdi_dropped(c, t);
        if (rbdi_any(dropped)) rbdi_project_along(c, t, dropped, x);
    }
}

/* The null vectors of all dropped rows, orthogonal to each other: R n = 0, n_t = 1. */
RBDI_LOCAL void rbdi_null_space(const rbd_constraint_set *c) {
    for (int t = 0; t < c->rows; ++t) {
        rbd_real *null = rbdi_null_vector(c, t);
        if (!rbdi_any(rbdi_dropped(c, t))) continue;

        null[t] = rbdi_select(rbdi_dropped(c, t), rbdi_set(RBD_C(1)), rbdi_zero());
        for (int i = t - 1; i >= 0; --i)
            null[i] = -c->R_inverse[i] * rbdi_rows_product(&c->R[i * c->stride + i + 1], &null[i + 1], t - i);
        rbdi_project(c, t, null);
    }
}

RBDI_LOCAL rbd_real rbdi_sum_abs(rbdi_v3 x) { return rbdi_abs(x.x) + rbdi_abs(x.y) + rbdi_abs(x.z); }

/* A bound on the terms of a constraint's target. J v, gamma and e in it are differences, so they may be far
   smaller than their terms:

       alpha + acc + v (w + 1 + kd) + p (w^2 + alpha + kp)

   p: of the places in the world, whose rounding is that of the lever arms. */
RBDI_LOCAL rbd_real rbdi_motion_size(const rbd_constraint_set *c, const rbdi_constraint *con) {
    const rbdi_relative_motion relative = rbdi_relative_motion_of(c, con);
    const rbdi_station one = relative.body[0], two = relative.body[1];
    const rbd_real w = rbdi_sum_abs(one.omega) + rbdi_sum_abs(two.omega),
                   v = w + rbdi_sum_abs(one.v) + rbdi_sum_abs(two.v),
                   p = rbdi_sum_abs(one.p) + rbdi_sum_abs(rbdi_frame_origin(c, con, 1)) + RBD_C(1);
    const rbd_real turning = rbdi_sum_abs(one.omega_dot) + rbdi_sum_abs(two.omega_dot),
                   moving = rbdi_sum_abs(one.acc) + rbdi_sum_abs(two.acc);

    return turning + moving + v * (w + (RBD_C(1) + con->kd)) + p * (w * w + turning + con->kp);
}

/* Makes c->slack the error of b by rounding and drift, and permutes it. */
RBDI_LOCAL void rbdi_set_slack(rbd_constraint_set *c) {
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        const rbd_real noise = rbdi_motion_size(c, con) * RBDI_NOISE;
        for (int r = con->row; r < con->row + con->rows; ++r)
            c->slack[r] = rbdi_sqrt(c->slack[r]) * RBDI_FEASIBLE + noise;
    }

    rbdi_permute(c, c->slack, 1, 0);
}

/* Notes the first dropped row, in the caller's order, that contradicts the rows it depends on: the targets
   have a component along its null vector n, |n' target| > |n|' slack. (J x of any x has none.) */
RBDI_LOCAL void rbdi_check_rows(rbd_constraint_set *c) {
    rbd_real *bad = c->of_rows.contradicts;
    const rbd_real one = rbdi_set(RBD_C(1));

    rbdi_set_slack(c);
    rbdi_permute(c, c->target, 1, 0);
    rbdi_clear(bad, c->rows);
    for (int t = 0; t < c->rows; ++t) {
        const rbd_real *null = rbdi_null_vector(c, t);
        rbd_real bound = rbdi_zero();
        if (!rbdi_any(rbdi_dropped(c, t))) continue;

        for (int j = 0; j <= t; ++j) bound = bound + rbdi_abs(null[j]) * c->slack[j];
        bad[t] = rbdi_select(rbdi_less(bound, rbdi_abs(rbdi_rows_product(null, c->target, t + 1))), one,
                             rbdi_zero());
    }

    rbdi_permute(c, c->target, 1, 1);
    rbdi_permute(c, bad, 1, 1);
    for (int r = c->rows - 1; r >= 0; --r)
        if (rbdi_any(rbdi_less(rbdi_zero(), bad[r]))) c->infeasible = r;
}

/* The columns of X lose their components along the null vectors. X: rows x columns. */
RBDI_LOCAL void rbdi_project_columns(const rbd_constraint_set *c, rbd_real *X, int columns) {
    rbd_real *x = c->square;
    for (int j = 0; c->pivoted && j < columns; ++j) {
        for (int i = 0; i < c->rows; ++i) x[i] = X[i * columns + j];
        rbdi_project(c, c->rows, x);
        for (int i = 0; i < c->rows; ++i) X[i * columns + j] = x[i];
    }
}

/* X = Delta^-1 X, of least norm. X: rows x columns. If rows depend on each other, the right-hand sides lose
   their components along the null vectors, too: with them the equations would contradict each other. */
RBDI_LOCAL void rbdi_delta_solve(const rbd_constraint_set *c, rbd_real *X, int columns) {
    rbd_real *x = c->square; /* a column of R */
    rbdi_permute(c, X, columns, 0);
    rbdi_project_columns(c, X, columns);

    /* R' beta = X */
    for (int t = 0; t < c->rows; ++t) {
        for (int i = 0; i < t; ++i) x[i] = c->R[i * c->stride + t];
        rbdi_subtract_product(x, X, t, columns, &X[t * columns]);
        rbdi_multiply(&X[t * columns], c->R_inverse[t], columns);
    }

    /* R X = beta */
    for (int t = c->rows - 1; t >= 0; --t) {
        rbdi_subtract_product(&c->R[t * c->stride + t + 1], &X[(t + 1) * columns], c->rows - t - 1, columns,
                              &X[t * columns]);
        rbdi_multiply(&X[t * columns], c->R_inverse[t], columns);
    }

    rbdi_project_columns(c, X, columns);
    rbdi_permute(c, X, columns, 1);
}

/* Gives lambda to the caller. Returns the status of a call from that of the pivots of M. */
RBDI_LOCAL rbd_status rbdi_constrained_status(const rbd_model *m, rbd_constraint_set *c, rbd_status status,
                                              rbd_real *lambda) {
    if (status) {
        (void)rbdi_pivot_status(m, c->w, c->lambda, c->rows);
        c->infeasible = -1;
    }
    for (int r = 0; lambda && r < c->rows; ++r) lambda[r] = c->lambda[r];
    if (status) return status;
    return c->infeasible < 0 ? RBD_OK : RBD_ERR_INFEASIBLE;
}

/* ==== src/constraints/solution.h ==== */
/* Interface: rbdi_y_lambda */

/* ---- solution [solution] ----
   The steps by the factor M = L'DL, before and after [factor] or [rank]. */

/* x = L^-T x, and c->D_inverse from the factor. */
RBDI_LOCAL void rbdi_sweep_back(const rbd_model *m, rbd_constraint_set *c, const rbd_real *L) {
    rbdi_solve_transposed(m, c->w, L, 1, 1, c->x);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = L[m->dof[k].row + m->dof[k].depth];
}

/* Entry of dof k of Y lambda. */
RBDI_INLINE rbd_real rbdi_y_lambda(const rbd_constraint_set *c, const rbd_real *lambda, int k) {
    const rbdi_span span = c->span[k];
    const rbd_real *y = &c->Y[k * c->stride];
    rbdi_sum sum = rbdi_sum_of_none();
    for (int r = span.first; r < span.end; r += RBDI_BATCH)
        sum = rbdi_sum_and(sum, *(const rbdi_batch *)&y[r] * *(const rbdi_batch *)&lambda[r]);
    return rbdi_sum_value(sum);
}

/* ==== src/constraints/refinement.h ==== */
/* ---- refinement [refinement] ----
   Accelerations x = D^-1 (f + Y lambda) lose digits where both terms are larger by far than their sum. An
   example is a link of tiny inertia that a constraint holds: without the constraint its acceleration would
   be torque / inertia. The rows then miss their targets by rounding of these terms. Iterative refinement
   (Higham, Accuracy and Stability of Numerical Algorithms, chapter 12) finds the digits:

       b = target - Y' x,   Delta delta = b,   x += D^-1 Y delta,   lambda += delta

   until b is small beside its own terms. In most states it is so from the start. Dependent rows can only
   meet the part of b that has no component along their null vectors.

   At the end all rows must hold: b is at most RBDI_HELD of the terms that the row's length and that of x
   allow. Only rows that truly depend on each other may contradict each other by more, because positions
   drift: their null vectors n have J' n = 0. Rounding can hide a row, too. If a link of tiny inertia is on
   its path, its part along the other joints is lost beside the huge terms 1/D of that link. [rank] drops the
   row, but J' n is not 0. In this case, or if refinement stalls, the call is an error that names the row. */

/* Largest magnitude of n numbers. */
RBDI_LOCAL rbd_real rbdi_largest(const rbd_real *x, int n) {
    rbd_real largest = rbdi_zero();
    for (int k = 0; k < n; ++k) {
        const rbd_real size = rbdi_abs(x[k]);
        largest = rbdi_select(rbdi_less(largest, size), size, largest);
    }
    return largest;
}

/* b = target - Y' x, and the squares of its terms. A batch may reach into the rows of the next constraint,
   which come after, or behind the last row, where all is 0. */
RBDI_LOCAL void rbdi_rest_of_rows(rbd_constraint_set *c) {
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        for (int r = con->row; r < con->row + con->rows; r += RBDI_BATCH) {
            const rbd_real *Y = &c->Y[r];
            rbdi_batch b = *(const rbdi_batch *)&c->target[r], squares = b * b;
            for (int t = 0; t < con->dofs; ++t) {
                const int k = con->dof[t];
                const rbdi_batch term = *(const rbdi_batch *)&Y[k * c->stride] * c->x[k];
                b = b - term;
                squares = squares + term * term;
            }
            *(rbdi_batch *)&c->b[r] = b;
            *(rbdi_batch *)&c->slack[r] = squares;
        }

    /* behind the last row nothing is left of a call before, which may have had NaN */
    rbdi_clear(&c->b[c->rows], c->stride - c->rows);
}

/* Computes b and whether an entry of it is more than rounding of its terms. */
RBDI_LOCAL rbdi_mask rbdi_rows_miss(rbd_constraint_set *c) {
    rbdi_mask miss = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_rest_of_rows(c);
    if (c->pivoted) {
        rbdi_permute(c, c->b, 1, 0);
        rbdi_project_columns(c, c->b, 1);
        rbdi_permute(c, c->b, 1, 1);
    }

    for (int r = 0; r < c->rows; ++r) {
        const rbd_real least = c->slack[r] * (RBDI_MISSED * RBDI_MISSED) + RBDI_STILL * RBDI_STILL;
        miss = rbdi_or(miss, rbdi_not(rbdi_less(c->b[r] * c->b[r], least)));
    }
    return miss;
}

/* Adds entry k of D^-1 Y lambda to x. Returns whether the sum lost so many digits that rows may miss. */
RBDI_INLINE rbdi_mask rbdi_add_force(const rbd_constraint_set *c, const rbd_real *lambda, int k,
                                     rbd_real *x) {
    const rbd_real change = rbdi_y_lambda(c, lambda, k) * c->D_inverse[k], sum = *x + change;
    *x = sum;
    return rbdi_less(rbdi_abs(sum) * (1 / RBDI_LOST), rbdi_abs(change));
}

/* The same for all dofs, in c->x. */
RBDI_LOCAL rbdi_mask rbdi_add_forces(const rbd_model *m, rbd_constraint_set *c, const rbd_real *lambda) {
    rbdi_mask lost = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) lost = rbdi_or(lost, rbdi_add_force(c, lambda, k, &c->x[k]));
    return lost;
}

/* y = x where `mask`. */
RBDI_LOCAL void rbdi_copy_where(rbdi_mask mask, const rbd_real *x, int n, rbd_real *y) {
    for (int k = 0; k < n; ++k) y[k] = rbdi_select(mask, x[k], y[k]);
}

/* Refines x and lambda where `miss` says so, which rbdi_rows_miss returned. A step may exchange an error for
   one along other rows that is larger, by eps / inertia of a tiny link, and the next one removes that. So
   from the second step on a step must halve b of two steps before, or the best x and lambda so far are the
   result. */
RBDI_COLD void rbdi_refine_steps(const rbd_model *m, rbd_constraint_set *c, rbdi_mask miss) {
    rbd_real *best_x = c->of_dofs.best_x, *best_lambda = c->of_rows.best_lambda;
    rbd_real size = rbdi_largest(c->b, c->rows), best = size, last = size;
    rbdi_mask stalled = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_copy_where(miss, c->x, m->nv, best_x);
    rbdi_copy_where(miss, c->lambda, c->rows, best_lambda);

    for (int step = 0; step < RBDI_REFINEMENTS && rbdi_any(miss); ++step) {
        const rbd_real before = last;
        rbdi_mask better;
        last = size;

        rbdi_delta_solve(c, c->b, 1);
        for (int r = 0; r < c->rows; ++r) {
            c->b[r] = rbdi_select(miss, c->b[r], rbdi_zero());
            c->lambda[r] = c->lambda[r] + c->b[r];
        }
        (void)rbdi_add_forces(m, c, c->b);

        miss = rbdi_and(miss, rbdi_rows_miss(c));
        size = rbdi_largest(c->b, c->rows);
        better = rbdi_and(miss, rbdi_less(size, best));
        best = rbdi_select(better, size, best);
        rbdi_copy_where(better, c->x, m->nv, best_x);
        rbdi_copy_where(better, c->lambda, c->rows, best_lambda);

        if (step > 0) stalled = rbdi_or(stalled, rbdi_and(miss, rbdi_not(rbdi_less(size + size, before))));
        miss = rbdi_and(miss, rbdi_not(stalled));
    }

    stalled = rbdi_or(stalled, miss);
    rbdi_copy_where(stalled, best_x, m->nv, c->x);
    rbdi_copy_where(stalled, best_lambda, c->rows, c->lambda);
}

#ifndef RBDI_NOTE_REFINED /* tests of generated code, which does not refine, count these states */
#define RBDI_NOTE_REFINED() ((void)0)
#endif

/* Refines x and lambda where rows miss their targets. lost: what the additions to x returned. Returns whether
   any row missed. */
RBDI_LOCAL int rbdi_refine(const rbd_model *m, rbd_constraint_set *c, rbdi_mask lost) {
    rbdi_mask miss;
    if (!c->pivoted && !rbdi_any(lost)) return 0;

    miss = rbdi_rows_miss(c);
    if (!rbdi_any(miss)) return 0;
    RBDI_NOTE_REFINED();
    rbdi_refine_steps(m, c, miss);
    return 1;
}

/* -- do all rows hold? -- */

/* Lengths of the rows of J L^-1: the root of the sum of Y_kr^2. */
RBDI_LOCAL void rbdi_row_lengths(const rbd_model *m, const rbd_constraint_set *c, rbd_real *length) {
    for (int r = 0; r < c->rows; r += RBDI_BATCH) {
        rbdi_batch sum = rbdi_all_lanes(rbdi_zero());

        for (int k = 0; k < m->nv; ++k) {
            const rbdi_batch y = *(const rbdi_batch *)&c->Y[k * c->stride + r];
            sum = sum + y * y;
        }

        *(rbdi_batch *)&length[r] = sum;
    }

    for (int r = 0; r < c->rows; ++r) length[r] = rbdi_sqrt(length[r]);
}

/* Whether dropped row t depends on the rows taken whatever D is: each entry of Y n, n its null vector, is
   rounding of sum |n_j| length_j. */
RBDI_LOCAL rbdi_mask rbdi_row_depends(const rbd_model *m, const rbd_constraint_set *c, int t,
                                      const rbd_real *length) {
    const rbd_real *null = rbdi_null_vector(c, t);
    rbd_real *n = c->square, bound = rbdi_zero();
    rbdi_mask depends = rbdi_dropped(c, t);

    /* n in the caller's order */
    rbdi_clear(n, c->stride);
    for (int i = 0; i <= t; ++i) n[i] = null[i];
    rbdi_permute(c, n, 1, 1);

    for (int r = 0; r < c->rows; ++r) bound = bound + rbdi_abs(n[r]) * (length[r] + RBD_C(1));
    bound = bound * RBDI_DEPENDENT;
    for (int k = 0; k < m->nv; ++k)
        depends = rbdi_and(depends, rbdi_less(rbdi_abs(rbdi_y_lambda(c, n, k)), bound));

    return depends;
}

/* b loses the part by which rows that depend on each other contradict each other. */
RBDI_LOCAL void rbdi_forgive_drift(const rbd_model *m, const rbd_constraint_set *c, const rbd_real *length) {
    rbdi_permute(c, c->b, 1, 0);
    for (int t = 0; t < c->rows; ++t)
        if (rbdi_any(rbdi_dropped(c, t))) rbdi_project_along(c, t, rbdi_row_depends(m, c, t, length), c->b);
    rbdi_permute(c, c->b, 1, 1);
}

/* The first row that x, of this length, misses by b; -1 = none:

       |b_r| > RBDI_HELD (|target_r| + length_r |x|) + noise of the target

   A NaN is no miss: these calls only look for NaN in M. */
RBDI_LOCAL int rbdi_first_missed(const rbd_constraint_set *c, const rbd_real *length, rbd_real size) {
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        const rbd_real noise = rbdi_motion_size(c, con) * RBDI_NOISE + RBDI_STILL;
        for (int r = con->row; r < con->row + con->rows; ++r) {
            const rbd_real terms = rbdi_abs(c->target[r]) + length[r] * size;
            if (rbdi_any(rbdi_less(terms * RBDI_HELD + noise, rbdi_abs(c->b[r])))) return r;
        }
    }
    return -1;
}

/* Notes a row that x, the solution, does not meet, unless a row is noted already. */
RBDI_COLD void rbdi_check_held(const rbd_model *m, rbd_constraint_set *c) {
    rbd_real *length = c->of_rows.length, size = rbdi_zero();
    if (c->infeasible >= 0) return;

    rbdi_rest_of_rows(c);
    rbdi_row_lengths(m, c, length);
    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) size = size + c->x[k] * c->x[k];
    size = rbdi_sqrt(size);

    c->infeasible = rbdi_first_missed(c, length, size);
    if (c->infeasible < 0 || !c->pivoted) return;

    rbdi_forgive_drift(m, c, length);
    c->infeasible = rbdi_first_missed(c, length, size);
}

/* ==== src/constraints/articulated.h ==== */
/* ---- articulated bodies [articulated] ----
   The Popov-Vereshchagin algorithm. A unit force (moment) of a row acts on both bodies, with opposite
   signs, as wrenches K on their links. Pass 2 of [aba] has eliminated the joints; K is carried past each of
   them to the world. a' = X a_p + zeta is the acceleration of a joint's link without S qdd, zeta its velocity
   product. At each joint

       Y = S' K,   K -= U/D Y,   epsilon += Y u/D + K' zeta,   K_p = X' K

   and the acceleration along the row is K' a' + epsilon + Delta lambda, where Delta = Y' D^-1 Y of the joints
   so far. At the common ancestor of the two links the two wrenches are added. In the world a' is known, and
   [factor] gives lambda from b = target - epsilon - K' a'. Then u/D += D^-1 Y lambda, and pass 3 gives the
   accelerations. [refinement] needs the targets less all of epsilon but its terms Y u/D. */

/* K_p = X' K of a batch of rows. */
#if RBDI_BATCH > 1
#define rbdi_wrenches_to_parent rbdi_batch_up
#else
#define rbdi_wrenches_to_parent rbdi_array_up
#endif

/* K of a batch of rows, in the axes of the link that it was carried to; b = target - epsilon, and the target
   without the terms Y u/D. */
typedef struct rbdi_row_wrenches {
    rbdi_batch K[6], b, target;
} rbdi_row_wrenches;

/* K on one of the two links, of a batch of rows from row r of the constraint on; 0 if it is the world. p:
   origin of frame 1, where the forces act. With a row's axes e in link axes, of angular and linear rows:

       K = (e_angular + arm x e_linear; e_linear) */
RBDI_INLINE void rbdi_start_rows(const rbd_constraint_set *c, const rbdi_constraint *con,
                                 const rbdi_axes_held *h, rbdi_v3 p, int side, int r, rbdi_batch K[6]) {
    const int link = con->link[con->link[side] < 0 ? 1 : side];
    const rbdi_pose X = c->w->kin[link].X;
    const rbd_real sign = rbdi_set(side ? RBD_C(-1) : RBD_C(con->link[0] >= 0));
    const rbdi_v3 arm = side ? rbdi_mul(X.E, rbdi_sub(p, X.r)) : rbdi_vec_c(con->position[0]);
    const rbdi_v3 axis[3] = {rbdi_scale(sign, rbdi_vec(X.E.xx, X.E.xy, X.E.xz)),
                             rbdi_scale(sign, rbdi_vec(X.E.yx, X.E.yy, X.E.yz)),
                             rbdi_scale(sign, rbdi_vec(X.E.zx, X.E.zy, X.E.zz))};

    for (int j = 0; j < 3; ++j)
        K[3 + j] = *(const rbdi_batch *)&h->axis[3][r] * axis[j].x +
                   *(const rbdi_batch *)&h->axis[4][r] * axis[j].y +
                   *(const rbdi_batch *)&h->axis[5][r] * axis[j].z;

    K[0] = K[5] * arm.y - K[4] * arm.z;
    K[1] = K[3] * arm.z - K[5] * arm.x;
    K[2] = K[4] * arm.x - K[3] * arm.y;

    for (int j = 0; con->angular && j < 3; ++j)
        K[j] = K[j] + *(const rbdi_batch *)&h->axis[0][r] * axis[j].x +
               *(const rbdi_batch *)&h->axis[1][r] * axis[j].y +
               *(const rbdi_batch *)&h->axis[2][r] * axis[j].z;
}

/* Carries K past the joint of one-axis link i, into the parent's axes. Writes Y. */
RBDI_INLINE void rbdi_rows_axis(const rbd_model *m, const rbd_work *w, int i, int flags,
                                rbdi_row_wrenches *rows, rbdi_batch *Y) {
    const rbdi_link *l = &m->link[i];
    const rbdi_scratch *own = &w->scratch[i];
    rbdi_batch *K = rows->K, y = K[2], z = K[2], term;

    /* Y = S' K */
    if (flags & RBDI_SLIDES) y = K[2] * l->rho + K[5] * l->kappa;
    *Y = y;

    /* K -= U/D Y */
    K[0] = K[0] - y * own->U_D.n.x;
    K[1] = K[1] - y * own->U_D.n.y;
    K[2] = rbdi_all_lanes(rbdi_zero()); /* U_z/D = 1 */
    if (flags & (RBDI_SLIDES | RBDI_ARMATURE)) K[2] = z - y * own->U_D.n.z;
    K[3] = K[3] - y * own->U_D.f.x;
    K[4] = K[4] - y * own->U_D.f.y;
    K[5] = K[5] - y * own->U_D.f.z;

    /* epsilon += Y u/D + K' zeta */
    term = K[0] * own->c.omega.x + K[1] * own->c.omega.y;
    term = term + K[3] * own->c.v.x + K[4] * own->c.v.y + K[5] * own->c.v.z;
    rows->target = rows->target - term;
    rows->b = rows->b - (y * own->u_D + term);

    rbdi_wrenches_to_parent(l, flags, rbdi_trig_of(m, w, i, flags), K);
}

/* Carries K past the n dofs of a block, whose rows of Y are `stride` apart. At a free base all of K is
   eliminated: U/D has only the entries that its own dofs need. */
RBDI_INLINE void rbdi_rows_dofs(const rbdi_block_work *bw, int first, int n, int free_base,
                                rbdi_row_wrenches *rows, rbd_real *Y, int stride) {
    RBDI_UNROLL_SIX for (int d = n - 1; d >= 0; --d) {
        const rbdi_batch y = rows->K[first + d];
        const int end = free_base ? d : 6;

        *(rbdi_batch *)&Y[d * stride] = y;
        rows->b = rows->b - y * bw->u_D[d];
        RBDI_UNROLL_SIX for (int j = 0; j < end; ++j) { rows->K[j] = rows->K[j] - y * bw->U_D[d][j]; }
    }
}

/* Carries K past the joint of block i, into the parent's axes. Writes Y. */
RBDI_LOCAL rbdi_row_wrenches rbdi_rows_block(const rbd_model *m, const rbd_work *w, int i,
                                             rbdi_row_wrenches rows, rbd_real *Y, int stride) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_block_work *bw = &w->block[l->block];

    if (rbdi_free_base(l, b)) {
        rbdi_rows_dofs(bw, 0, 6, 1, &rows, Y, stride);
        for (int j = 0; j < 6; ++j) rows.K[j] = rbdi_all_lanes(rbdi_zero());
    } else {
        rbd_real zeta[6];
        rbdi_store_motion(zeta, 1, w->scratch[i].c);
        rbdi_rows_dofs(bw, b->first, b->n, 0, &rows, Y, stride);

        for (int j = 0; j < 6; ++j) {
            const rbdi_batch term = rows.K[j] * zeta[j];
            rows.b = rows.b - term;
            rows.target = rows.target - term;
        }

        rbdi_crba_up_block(&bw->X, (rbd_real *)rows.K, RBDI_BATCH, RBDI_BATCH);
    }

    return rows;
}

/* Carries K from link i to its ancestor `stop`. Y: the batch in the row of dof 0. */
RBDI_LOCAL void rbdi_carry_rows(const rbd_model *m, const rbd_constraint_set *c, int i, int stop,
                                rbdi_row_wrenches *carried, rbd_real *Y) {
    rbdi_row_wrenches rows = *carried; /* in registers */
    for (; i > stop; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        rbd_real *to = Y + l->iv * c->stride;
        if (rbdi_is(l, RBDI_BLOCK))
            rows = rbdi_rows_block(m, c->w, i, rows, to, c->stride);
        else
            RBDI_BY_FLAGS(const int flags, l, rbdi_rows_axis(m, c->w, i, flags, &rows, (rbdi_batch *)to));
    }
    *carried = rows;
}

/* Y, b and target of a batch of rows from row r of the constraint on. h: its axes. p: origin of frame 1. */
RBDI_LOCAL void rbdi_rows_to_world(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                   int r, const rbdi_axes_held *h, rbdi_v3 p) {
    rbd_real *Y = c->Y + con->row + r;
    rbdi_row_wrenches rows, one;
    rbdi_batch world;
    for (int j = 0; j < 6; ++j) rows.K[j] = rbdi_all_lanes(rbdi_zero());
    rows.b = rows.target = *(const rbdi_batch *)&c->target[con->row + r];

    /* from both links to their common ancestor, and on */
    for (int side = 0; side < (con->link[1] < 0 ? 1 : 2); ++side) {
        rbdi_start_rows(c, con, h, p, side, r, one.K);
        one.b = rows.b;
        one.target = rows.target;
        rbdi_carry_rows(m, c, con->link[side], con->ancestor, &one, Y);

        for (int j = 0; j < 6; ++j) rows.K[j] = rows.K[j] + one.K[j];
        rows.b = one.b;
        rows.target = one.target;
    }
    rbdi_carry_rows(m, c, con->ancestor, -1, &rows, Y);

    /* K' a' of the world */
    world = rows.K[3] * c->world.x + rows.K[4] * c->world.y + rows.K[5] * c->world.z;
    *(rbdi_batch *)&c->b[con->row + r] = rows.b - world;
    *(rbdi_batch *)&c->target[con->row + r] = rows.target - world;
}

/* 1/D of the dofs on the paths. */
RBDI_LOCAL void rbdi_path_inverse(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_mask none = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) c->D_inverse[k] = rbdi_reciprocal(c->w->pivot[k], RBDI_TINY, &none);
}

/* u/D of a link's dofs. */
RBDI_INLINE rbd_real *rbdi_u_D_of(const rbd_model *m, const rbd_constraint_set *c, int link) {
    const rbdi_link *l = &m->link[link];
    return rbdi_is(l, RBDI_BLOCK) ? c->w->block[l->block].u_D : &c->w->scratch[link].u_D;
}

/* u/D += D^-1 Y lambda, refined. */
RBDI_LOCAL void rbdi_add_multipliers(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_mask lost = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int at = 0; at < c->links; ++at) {
        const int link = c->link[at], first = m->link[link].iv, n = rbdi_link_dofs(m, &m->link[link]);
        rbd_real *u_D = rbdi_u_D_of(m, c, link);

        for (int t = 0; t < n; ++t) {
            lost = rbdi_or(lost, rbdi_add_force(c, c->lambda, first + t, &u_D[t]));
            c->x[first + t] = u_D[t];
        }
    }
    if (!rbdi_refine(m, c, lost)) return;
    rbdi_check_held(m, c);

    /* the refined ones */
    for (int at = 0; at < c->links; ++at) {
        const int link = c->link[at], first = m->link[link].iv, n = rbdi_link_dofs(m, &m->link[link]);
        rbd_real *u_D = rbdi_u_D_of(m, c, link);
        for (int t = 0; t < n; ++t) u_D[t] = c->x[first + t];
    }
}

/* Velocities, poses and bias wrenches of the links. Accelerations of the links are 0 here: epsilon has their
   terms of gamma. */
RBDI_LOCAL void rbdi_articulated_start(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, rbdi_c3 gravity, int moving) {
    rbd_work *w = c->w;
    w->kinematics_of = RBDI_NO_KINEMATICS;
    c->world = rbdi_world_state(gravity).acc;

    rbdi_joints(m, w, q);
    rbdi_aba_velocities(m, w, v, 1);
    rbdi_kin_of_paths(m, c, v, moving);

    for (int i = 0; i < 2 * c->n; ++i) {
        const int link = c->constraint[i / 2].link[i % 2];
        if (link < 0) continue;

        w->kin[link].state.omega_dot = w->kin[link].state.acc = rbdi_vec0();
        if (!moving) w->kin[link].v = rbdi_vec0(); /* not used, but it must not be a NaN */
    }
}

/* Computes x and lambda from Y and b. Returns 0, x untouched, if a pivot is in doubt. */
RBDI_LOCAL int rbdi_articulated_solve(const rbd_model *m, rbd_constraint_set *c, rbd_real *x) {
    if (rbdi_any(rbdi_factor_delta(m, c))) return 0;
    c->pivoted = 0;
    c->infeasible = -1;
    rbdi_back_substitute(c);
    rbdi_add_multipliers(m, c);

    rbdi_aba_pass3(m, c->w, c->world, x);
    c->w->singular = -1;
    return 1;
}

/* ==== src/constraints/calls.h ==== */
/* Interface: rbdi_check_constrained, rbdi_check_constraints, rbdi_constraint_bias */

/* ---- call code [call code] ---- */

RBDI_LOCAL rbd_status rbdi_check_constraints(const rbd_model *m, const rbd_constraint_set *c, int arrays) {
    if (!m || !c || !arrays) return RBD_ERR_NULL;
    if (!rbdi_has_shape(m, c->shape)) return RBD_ERR_WORK;
    return rbdi_check(m, c->w, 1);
}

/* The same of a call that needs masses. */
RBDI_LOCAL rbd_status rbdi_check_constrained(const rbd_model *m, const rbd_constraint_set *c, int arrays) {
    const rbd_status status = rbdi_check_constraints(m, c, arrays);
    return status ? status : rbdi_check_dynamics(m, c->w, 1);
}

/* x += D^-1 Y lambda, with lambda of least norm so that Y' x = target. check: whether to note a row that
   contradicts others. Returns whether rows may not hold yet, so that rbdi_check_held must look at them.

       b = target - Y' x,   Delta lambda = b */
RBDI_LOCAL int rbdi_multipliers(const rbd_model *m, rbd_constraint_set *c, int check) {
    rbdi_rest_of_rows(c);
    c->pivoted = 0;
    c->infeasible = -1;

    if (rbdi_any(rbdi_factor_delta(m, c))) {
        RBDI_NOTE_DOUBT(c->w, 1);
        c->pivoted = 1;
        rbdi_orthogonalise(m, c);
        rbdi_null_space(c);
        if (check) rbdi_check_rows(c);
        for (int r = 0; r < c->rows; ++r) c->lambda[r] = c->b[r];
        rbdi_delta_solve(c, c->lambda, 1);
    } else {
        rbdi_back_substitute(c);
    }

    return rbdi_refine(m, c, rbdi_add_forces(m, c, c->lambda)) || c->pivoted;
}

/* Targets of a constraint's rows: -gamma - kd J v - kp e; with a restitution, the change of velocity in an
   impact, -J v - restitution J v. */
RBDI_LOCAL void rbdi_set_target(rbd_constraint_set *c, const rbdi_constraint *con,
                                const rbd_real *restitution) {
    for (int r = con->row; r < con->row + con->rows; r += RBDI_BATCH) {
        const rbdi_batch v = *(const rbdi_batch *)&c->velocity[r];
        rbdi_batch target =
            rbdi_all_lanes(rbdi_zero()) - (restitution ? v : *(const rbdi_batch *)&c->gamma[r]);

        if (restitution) target = target - v * *restitution;
        if (!restitution && con->kd > 0) target = target - v * con->kd;
        if (!restitution && con->kp > 0) target = target - *(const rbdi_batch *)&c->e[r] * con->kp;

        *(rbdi_batch *)&c->target[r] = target;
    }
}

/* Computes the accelerations x and lambda by articulated bodies. With a restitution x is the change of
   velocity in an impact, by the same steps without gravity, velocity products and forces. Returns 0, x
   untouched, if a pivot is in doubt. */
RBDI_LOCAL int rbdi_articulated_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                   const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                   const rbd_real *restitution, rbd_real *x) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_work *w = c->w;
    if (c->factored) return 0;

    /* the articulated bodies; in an impact without velocity products */
    rbdi_articulated_start(m, c, q, v, restitution ? none : w->gravity, c->moving || restitution);
    for (int i = 0; restitution && i < m->nl; ++i) {
        w->scratch[i].f = rbdi_force0();
        w->scratch[i].c = rbdi_motion0();
    }
    rbdi_external(m, w, f_ext);
    if (rbdi_any(rbdi_aba_pass2(m, w, tau))) return 0;

    rbdi_path_inverse(m, c);
    if (c->dirty) rbdi_clear_rows(m, c);
    c->dirty = 0;
    rbdi_clear(c->velocity, 3 * c->stride); /* gamma and e are behind it */

    /* the rows */
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        rbdi_axes_held h;
        rbdi_v3 p;
        rbdi_set_axes(c, con, &h);
        p = rbdi_constraint_motion(c, con, &h, !restitution && con->kp > 0);
        rbdi_set_target(c, con, restitution);
        for (int r = 0; r < con->rows; r += RBDI_BATCH) rbdi_rows_to_world(m, c, con, r, &h, p);
    }

    return rbdi_articulated_solve(m, c, x);
}

/* Writes M to w->H, M a + bias - sum J_b' f_ext to w->bias, and the state of all links. a: with the joints
   that mimic. */
RBDI_LOCAL void rbdi_constraint_bias(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                     rbdi_c3 gravity) {
    rbd_work *w = c->w;
    rbd_crba_packed(m, w, q, w->H);
    rbdi_constraint_state(m, c, rbdi_expand_v(m, v, w->vx), a, gravity, 1);

    rbdi_external(m, w, f_ext);
    rbdi_rnea_sweep(m, w, a, rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);
}

/* As rbdi_articulated_fd, by the factor M = L'DL, in every state. Returns the status of M's pivots.

       f = L^-T (tau - bias),   Y = L^-T J',   L a = D^-1 (f + Y lambda) */
RBDI_LOCAL rbd_status rbdi_factored_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       const rbd_real *restitution, rbd_real *x) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_work *w = c->w;
    rbdi_mask doubt;

    /* f */
    rbdi_constraint_bias(m, c, q, v, w->zero, f_ext, restitution ? none : w->gravity);
    for (int k = 0; k < m->nv; ++k) c->x[k] = restitution ? rbdi_zero() : tau[k] - w->bias[k];
    doubt = rbdi_factor(m, w, w->H);
    rbdi_sweep_back(m, c, w->H);

    /* Y */
    rbdi_clear_rows(m, c);
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        rbdi_constraint_rows(m, c, con, !restitution && con->kp > 0);
        rbdi_set_target(c, con, restitution);
    }
    rbdi_solve_transposed(m, w, w->H, c->stride, c->rows, c->Y);

    /* L a = D^-1 (f + Y lambda) */
    for (int k = 0; k < m->nv; ++k) c->x[k] = c->x[k] * c->D_inverse[k];
    if (rbdi_multipliers(m, c, !restitution)) /* an impact's targets, J v, are in the range of J */
        rbdi_check_held(m, c);

    /* a, from D L a */
    for (int k = 0; k < m->nv; ++k) x[k] = c->x[k] * w->pivot[k];
    rbdi_solve_forward(m, w, w->H, 1, 1, 1, x);
    return rbdi_factor_status(m, w, w->H, doubt, x, m->nv);
}

/* Computes x and lambda by articulated bodies or, if these are in doubt, by the factor of M. Returns the
   status of the call. */
RBDI_LOCAL rbd_status rbdi_constrained(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       const rbd_real *restitution, rbd_real *x, rbd_real *lambda) {
    rbd_status status = RBD_OK;

    if (!rbdi_articulated_fd(m, c, q, v, tau, f_ext, restitution, x)) {
        if (!c->factored) RBDI_NOTE_DOUBT(c->w, 1);
        status = rbdi_factored_fd(m, c, q, v, tau, f_ext, restitution, x);
    }

    return rbdi_constrained_status(m, c, status, lambda);
}

RBDI_API rbd_status rbd_constrained_fd(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *lambda) {
    const rbd_status status = rbdi_check_constrained(m, c, q && v && tau && a);
    return status ? status : rbdi_constrained(m, c, q, v, tau, f_ext, NULL, a, lambda);
}

/* Whether 0 <= restitution <= 1. */
RBDI_LOCAL int rbdi_restitution_fits(rbd_real restitution) {
    const rbd_real one = rbdi_set(RBD_C(1)), two = one + one; /* to refuse NaN, which is not below it */
    const rbdi_mask above = rbdi_or(rbdi_less(one, restitution), rbdi_not(rbdi_less(restitution, two)));

    return !rbdi_any(rbdi_or(above, rbdi_less(restitution, rbdi_zero())));
}

RBDI_API rbd_status rbd_impact(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                               const rbd_real *v, rbd_real restitution, rbd_real *v_plus, rbd_real *impulse) {
    rbd_status status = rbdi_check_constrained(m, c, q && v && v_plus);
    if (status) return status;
    if (!rbdi_restitution_fits(restitution)) return RBD_ERR_RANGE;

    status = rbdi_constrained(m, c, q, v, c->w->zero, NULL, &restitution, c->x, impulse);
    for (int k = 0; k < m->nv; ++k) v_plus[k] = v[k] + c->x[k];

    if (status && status != RBD_ERR_INFEASIBLE) (void)rbdi_pivot_status(m, c->w, v_plus, m->nv);
    return status;
}

/* Computes J, J v, gamma and, if `errors`, e as rbdi_constraint_rows, and the motion of all links without
   gravity. v: NULL = 0. */
RBDI_LOCAL void rbdi_constraint_rows_at(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                        const rbd_real *v, int errors) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbdi_joints(m, c->w, rbdi_expand_q(m, c->w, q));
    rbdi_constraint_state(m, c, v ? rbdi_expand_v(m, v, c->w->vx) : c->w->zero, c->w->zero, none, 0);

    rbdi_clear_rows(m, c);
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        rbdi_constraint_rows(m, c, con, errors);
}

RBDI_API rbd_status rbd_constraint_jacobian(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                            const rbd_real *v, rbd_real *J, rbd_real *gamma, rbd_real *e) {
    const rbd_status status = rbdi_check_constraints(m, c, q != NULL);
    if (status) return status;

    rbdi_constraint_rows_at(m, c, q, v, e != NULL);
    for (int r = 0; r < c->rows; ++r) {
        for (int k = 0; J && k < m->nv; ++k) J[r * m->nv + k] = c->Y[k * c->stride + r];
        if (gamma) gamma[r] = c->gamma[r];
        if (e) e[r] = c->e[r];
    }
    return RBD_OK;
}

/* ==== src/constraints/weights.h ==== */
/* ---- weights [weights] ----
   rbdi_multipliers solves weighted least squares, too. With a diagonal matrix D in place of M, so that L = 1
   and Y = J',

       J (x + d) = target,   d' D d least:   d = D^-1 J' lambda

   rbd_constrained_id looks for lambda of least lambda' W lambda with

       J_p' lambda = tau_p

   p: the joints without motors, tau: the torques without contacts. It sets Y = J' W^-1/2, x_p = -tau_p, other
   entries of x to 0, and D^-1 to 1 for these joints and to 0 for others. Then the equations of
   rbdi_multipliers

       Y' D^-1 Y mu = -Y' D^-1 x,   mu = W^1/2 lambda

   are the normal equations of the least squares problem, and mu has the least norm. */

/* Whether n weights are 0, or from RBDI_LEAST_WEIGHT to RBDI_MOST_WEIGHT. NULL: all are 1. */
RBDI_LOCAL int rbdi_weights_fit(const rbd_const *weight, int n) {
    for (int k = 0; weight && k < n; ++k) {
        const int none = weight[k] >= 0 && weight[k] <= 0;

        if (!none && !(weight[k] >= RBDI_LEAST_WEIGHT && weight[k] <= RBDI_MOST_WEIGHT)) return 0;
    }
    return 1;
}

/* The weight that stands for 0: the share RBDI_FREE of the least of the others. */
RBDI_LOCAL rbd_const rbdi_free_weight(const rbd_const *weight, int n) {
    rbd_const least = 0;
    for (int k = 0; weight && k < n; ++k)
        if (weight[k] > 0 && !(least > 0 && least < weight[k])) least = weight[k];
    return least > 0 ? least * RBDI_FREE : RBD_C(1);
}

/* 1 / weight k. free: the weight that stands for 0. */
RBDI_LOCAL rbd_const rbdi_inverse_weight(const rbd_const *weight, int k, rbd_const free) {
    return weight ? RBD_C(1) / (weight[k] > 0 ? weight[k] : free) : RBD_C(1);
}

/* Whether dof k has no motor: its flag is 0 or, without flags, its joint is a floating one. */
RBDI_LOCAL int rbdi_is_passive(const rbd_model *m, const unsigned char *actuated, int k) {
    return actuated ? !actuated[k] : m->frame[m->dof[k].body].type == RBD_FLOATING;
}

RBDI_API rbd_status rbd_constrained_id(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                       const unsigned char *actuated, const rbd_const *weight, rbd_real *tau,
                                       rbd_real *lambda) {
    const rbd_status status = rbdi_check_constrained(m, c, q && v && a && tau);
    rbd_real *root; /* of 1 / weight */
    rbd_const free;
    if (status) return status;
    if (!rbdi_weights_fit(weight, c->rows)) return RBD_ERR_RANGE;
    free = rbdi_free_weight(weight, c->rows);

    rbd_rnea(m, c->w, q, v, a, f_ext, c->x);
    rbdi_constraint_rows_at(m, c, q, NULL, 0);

    /* Y = J' W^-1/2, x, D^-1 */
    root = c->velocity; /* J v is not needed */
    for (int r = 0; r < c->rows; ++r) root[r] = rbdi_sqrt(rbdi_set(rbdi_inverse_weight(weight, r, free)));
    for (int k = 0; k < m->nv; ++k) {
        const int passive = rbdi_is_passive(m, actuated, k);
        for (int r = 0; r < c->rows; ++r) c->Y[k * c->stride + r] = c->Y[k * c->stride + r] * root[r];
        tau[k] = c->x[k];
        c->x[k] = passive ? -tau[k] : rbdi_zero();
        c->D_inverse[k] = rbdi_set(passive ? RBD_C(1) : RBD_C(0));
    }
    rbdi_clear(c->target, c->rows);
    (void)rbdi_multipliers(m, c, 0);

    /* tau - J' lambda */
    for (int k = 0; k < m->nv; ++k)
        tau[k] = tau[k] - rbdi_rows_product(&c->Y[k * c->stride], c->lambda, c->rows);
    for (int r = 0; lambda && r < c->rows; ++r) lambda[r] = c->lambda[r] * root[r];

    c->infeasible = -1; /* least squares always have a solution */
    return RBD_OK;
}

/* ==== src/constraints/assembly.h ==== */
/* ---- assembly [assembly] ----
   Newton's method. x is the distance of q_near from q. A step removes a share `size` of it and closes e:

       d = D^-1 J' lambda - size x,   J d = -e,   x = rbd_difference(q, q_near)

   The last steps have size 0: they reduce e alone. D: the weights. J stands for de/dq. Only if a constraint
   holds a single angular axis is de/dq itself used: J d = -e would not come nearer there at large turns. For
   two axes J is better: de/dq vanishes where they are 90 degrees off. Steps are cut to RBDI_LONGEST_STEP,
   because the rows change. */

/* The next step size, by Barzilai and Borwein (1988), from this step d = c->x and the one before it, d_0 =
   c->last_step, of sizes s and s_0:

       d_0' D d_0 / d_0' D (d_0 / s_0 - d / s)

   1 is right if J is constant; if J changes, steps of size 1 converge slowly or never. */
RBDI_LOCAL rbd_real rbdi_next_size(const rbd_constraint_set *c, int nv, rbd_real size, rbd_real last_size) {
    const rbd_real one = rbdi_set(RBD_C(1)), least = rbdi_set(RBDI_LEAST_STEP_SIZE),
                   most = rbdi_set(RBDI_MOST_STEP_SIZE);
    rbdi_mask none = rbdi_less(one, rbdi_zero());
    rbd_real square = rbdi_zero(), change = rbdi_zero(), next;

    for (int k = 0; k < nv; ++k) {
        const rbd_real weighted = c->last_step[k] / c->D_inverse[k];
        square = square + weighted * c->last_step[k];
        change = change + weighted * (c->last_step[k] / last_size - c->x[k] / size);
    }

    next = square * rbdi_reciprocal(change, RBDI_TINY, &none);
    next = rbdi_select(none, one, next); /* no step before this */
    next = rbdi_select(rbdi_less(most, next), most, next);
    return rbdi_select(rbdi_less(next, least), least, next);
}

/* Rows that depend on each other where the constraints hold may be independent beside such a place, by a tiny
   share. Their errors agree to e^2 only, and the rest, divided by that share, would be a step of any length.
   So a row t has no say in a step if both are small. With R' beta = e, in the order of [rank]:

       rest_t = e_t - sum_(i < t) R_it beta_i,   abs(rest_t) < size abs(e),   R_tt^2 < size^2 sum_i R_it^2

   size: the largest abs(e), at most RBDI_NEAR. The target of such a row becomes what the rows before it make
   of it. Returns whether there is one. */
RBDI_COLD rbdi_mask rbdi_ease_targets(rbd_constraint_set *c) {
    rbd_real *rest = c->slack, *beta = c->square;
    const rbd_real error = rbdi_largest(c->e, c->rows), most = rbdi_set(RBDI_NEAR);
    const rbd_real size = rbdi_select(rbdi_less(most, error), most, error), agreed = size * error;
    rbdi_mask eased = rbdi_less(error, error);

    for (int r = 0; r < c->rows; ++r) rest[r] = c->e[r];
    rbdi_permute(c, rest, 1, 0);

    for (int t = 0; t < c->rows; ++t) {
        const rbd_real *R = &c->R[t];
        const rbd_real own = R[t * c->stride] * R[t * c->stride];
        rbd_real square = own;
        rbdi_mask poor, ease;

        for (int i = 0; i < t; ++i) {
            rest[t] = rest[t] - R[i * c->stride] * beta[i];
            square = square + R[i * c->stride] * R[i * c->stride];
        }

        poor = rbdi_or(rbdi_dropped(c, t), rbdi_less(own, size * size * square));
        ease = rbdi_and(poor, rbdi_less(rbdi_abs(rest[t]), agreed));
        beta[t] = rbdi_select(ease, rbdi_zero(), rest[t] * c->R_inverse[t]);
        rest[t] = rbdi_select(ease, rest[t], rbdi_zero());
        eased = rbdi_or(eased, rbdi_and(ease, rbdi_not(rbdi_dropped(c, t))));
    }

    rbdi_permute(c, rest, 1, 1);
    for (int r = 0; r < c->rows; ++r) c->target[r] = c->target[r] + rest[r];
    return eased;
}

/* Computes the step c->x of this size: d = D^-1 J' lambda - size x, J d = target. */
RBDI_LOCAL void rbdi_assembly_direction(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                        const rbd_real *q_near, rbd_real size) {
    rbd_difference(m, q, q_near, c->x);
    for (int i = 0; i < m->nv; ++i) c->x[i] = -size * c->x[i];
    (void)rbdi_multipliers(m, c, 0);
}

/* Takes a step of this size. Returns its length before it is cut. */
RBDI_LOCAL rbd_real rbdi_assembly_step(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       rbd_real *q_near, rbd_real size) {
    const rbd_real limit = rbdi_set(RBDI_LONGEST_STEP);
    rbd_real length, cut;

    for (int r = 0; r < c->rows; ++r) c->target[r] = -c->e[r];
    rbdi_assembly_direction(m, c, q, q_near, size);
    if (c->pivoted && rbdi_any(rbdi_ease_targets(c))) rbdi_assembly_direction(m, c, q, q_near, size);

    length = rbdi_largest(c->x, m->nv);
    cut = rbdi_select(rbdi_less(limit, length), limit / (length + RBDI_TINY), rbdi_set(RBD_C(1)));
    rbd_integrate(m, q_near, c->x, cut, q_near);
    return length;
}

/* Computes q_near from q. */
RBDI_LOCAL void rbdi_assemble_position(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       rbd_real *q_near) {
    rbd_real size = rbdi_set(RBD_C(1)), last_size = size;
    int close = 0; /* the last steps that were taken */
    for (int k = 0; k < m->nq; ++k) q_near[k] = q[k];
    rbdi_clear(c->last_step, m->nv);

    for (int step = 0; close < RBDI_CLOSING_STEPS; ++step) {
        rbd_real length, next;

        rbdi_constraint_rows_at(m, c, q_near, NULL, RBDI_SLOPES);
        length = rbdi_assembly_step(m, c, q, q_near, close ? rbdi_zero() : size);
        if (close || step > RBDI_NEARING_STEPS || !rbdi_any(rbdi_less(size * RBDI_SHORT_STEP, length)))
            ++close;
        if (close) continue;

        next = rbdi_next_size(c, m->nv, size, last_size);
        last_size = size;
        size = next;
        for (int k = 0; k < m->nv; ++k) c->last_step[k] = c->x[k];
    }

    rbdi_constraint_rows_at(m, c, q_near, NULL, 1);
}

/* Computes v_near from v with the rows at q_near: J v_near = 0. Notes a row that this does not hold. */
RBDI_LOCAL void rbdi_assemble_velocity(const rbd_model *m, rbd_constraint_set *c, const rbd_real *v,
                                       rbd_real *v_near) {
    for (int k = 0; k < m->nv; ++k) c->x[k] = v[k];
    rbdi_clear(c->target, c->rows);
    (void)rbdi_multipliers(m, c, 0);
    if (rbdi_multipliers(m, c, 0)) rbdi_check_held(m, c); /* the second removes rounding */
    for (int k = 0; k < m->nv; ++k) v_near[k] = c->x[k];
}

/* Notes the row with the largest error e, if that is not below RBDI_CLOSED. */
RBDI_LOCAL void rbdi_note_open_row(rbd_constraint_set *c) {
    rbd_real open = rbdi_set(RBDI_CLOSED);
    for (int r = 0; r < c->rows; ++r) {
        const rbdi_mask worse = rbdi_not(rbdi_less(rbdi_abs(c->e[r]), open));
        if (!rbdi_any(worse)) continue;
        c->infeasible = r;
        open = rbdi_select(worse, rbdi_abs(c->e[r]), open);
    }
}

/* Whether weights hide rows: J alone has a higher rank. */
RBDI_COLD int rbdi_weights_hide(const rbd_model *m, rbd_constraint_set *c) {
    const int rank = rbd_constraint_rank(c);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = rbdi_set(RBD_C(1));

    c->pivoted = rbdi_any(rbdi_factor_delta(m, c));
    if (c->pivoted) rbdi_orthogonalise(m, c);
    return rbd_constraint_rank(c) > rank;
}

RBDI_API rbd_status rbd_assemble(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                 const rbd_real *v, const rbd_const *weight, rbd_real *q_near,
                                 rbd_real *v_near) {
    const rbd_status status = rbdi_check_constraints(m, c, q && q_near && q != q_near && (!v == !v_near));
    rbd_const free;
    if (status) return status;
    if (!rbdi_weights_fit(weight, m->nv)) return RBD_ERR_RANGE;

    free = rbdi_free_weight(weight, m->nv);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = rbdi_set(rbdi_inverse_weight(weight, k, free));
    rbdi_assemble_position(m, c, q, q_near);
    c->infeasible = -1;
    if (v) rbdi_assemble_velocity(m, c, v, v_near);

    rbdi_note_open_row(c);
    if (c->infeasible < 0) return RBD_OK;
    if (!rbdi_weights_hide(m, c)) return RBD_ERR_INFEASIBLE;

    c->infeasible = -1;
    return RBD_ERR_RANGE;
}

RBDI_API int rbd_constraint_rows(const rbd_constraint_set *c) { return c ? c->rows : 0; }

RBDI_API int rbd_constraint_first(const rbd_constraint_set *c, int constraint) {
    return c && constraint >= 0 && constraint < c->n ? c->constraint[constraint].row : -1;
}

RBDI_API int rbd_constraint_rank(const rbd_constraint_set *c) {
    rbd_real rank = rbdi_zero();
    int least = c ? c->rows : 0;
    for (int r = 0; c && r < c->rows; ++r)
        rank = rank + rbdi_select(rbdi_dropped(c, r), rbdi_zero(), rbdi_set(RBD_C(1)));
    while (least > 0 && rbdi_any(rbdi_less(rank, rbdi_set(RBD_C(least))))) --least;
    return least;
}

RBDI_API int rbd_infeasible_row(const rbd_constraint_set *c) { return c ? c->infeasible : -1; }

/* ==== src/constraints/set.h ==== */
/* Interface: rbdi_begin_set, rbdi_check_constraint, rbdi_constraint_of, rbdi_frame_along,
   rbdi_lay_constraints, rbdi_place_constraint, rbdi_place_frame, rbdi_row_stride, rbdi_rows_of */

/* ---- set code [set code] ---- */

/* Holds a point of body 1 at a point of body 2, and the first `angular` angular axes. */
RBDI_LOCAL rbd_constraint rbdi_constraint_of(int body1, const double *p1, int body2, const double *p2,
                                             int angular) {
    rbd_constraint con;
    con.name = NULL;
    con.body1 = body1;
    con.body2 = body2;
    for (int i = 0; i < 9; ++i) con.rotation1[i] = con.rotation2[i] = i % 4 == 0;
    for (int i = 0; i < 3; ++i) {
        con.position1[i] = p1 ? p1[i] : 0;
        con.position2[i] = p2 ? p2[i] : 0;
        con.axes[i] = i < angular;
        con.axes[i + 3] = 1;
    }
    con.kp = con.kd = 0;
    return con;
}

/* A rotation whose z axis is this axis. */
RBDI_LOCAL void rbdi_frame_along(const double axis[3], double R[9]) {
    rbdi_wide z[3], E[9], T[9];
    rbdi_widen(axis, 3, z);
    rbdi_unit(z, z);
    rbdi_w_basis(z, E);
    rbdi_w_transpose(E, T);
    for (int k = 0; k < 9; ++k) R[k] = (double)T[k];
}

RBDI_API rbd_constraint rbd_point_contact(int body, const double point[3], const double place[3]) {
    return rbdi_constraint_of(body, point, -1, place, 0);
}

RBDI_API rbd_constraint rbd_flat_contact(int body, const double point[3], const double place[3]) {
    return rbdi_constraint_of(body, point, -1, place, 3);
}

RBDI_API rbd_constraint rbd_ball_loop(int body1, const double point1[3], int body2, const double point2[3]) {
    return rbdi_constraint_of(body1, point1, body2, point2, 0);
}

RBDI_API rbd_constraint rbd_hinge_loop(int body1, const double point1[3], const double axis1[3], int body2,
                                       const double point2[3], const double axis2[3]) {
    rbd_constraint con = rbdi_constraint_of(body1, point1, body2, point2, 2);
    if (axis1) rbdi_frame_along(axis1, con.rotation1);
    if (axis2) rbdi_frame_along(axis2, con.rotation2);
    return con;
}

RBDI_API char *rbd_constraint_finding_text(const rbd_finding *finding, char *text, size_t size) {
    return rbdi_write_finding(finding, "constraint", text, size);
}

RBDI_LOCAL int rbdi_held_axes(const rbd_constraint *con) {
    int n = 0;
    for (int i = 0; i < 6; ++i) n += con->axes[i] == 1;
    return n;
}

/* The stride for so many rows: loops may access two batches from any row on. */
RBDI_LOCAL int rbdi_row_stride(int rows) { return (rows + 4 * RBDI_BATCH) / RBDI_BATCH * RBDI_BATCH; }

RBDI_LOCAL int rbdi_rows_of(const rbd_constraint *list, int n) {
    int rows = 0;
    for (int i = 0; i < n; ++i) rows += rbdi_held_axes(&list[i]);
    return rows;
}

RBDI_API size_t rbd_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n) {
    int rows;
    if (!m || (!list && n) || n < 0 || n > RBD_MAX_CONSTRAINTS) return 0;

    rows = rbdi_rows_of(list, n);
    return RBDI_CONSTRAINTS_BYTES(m->nv, n, rows, rbdi_row_stride(rows));
}

/* The link of a body, -1 = world. */
RBDI_LOCAL int rbdi_link_of_body(const rbd_model *m, int body) { return body < 0 ? -1 : m->frame[body].link; }

RBDI_LOCAL rbd_status rbdi_check_constraint(const rbd_model *m, const rbd_constraint *con, int i,
                                            rbd_report *report) {
    int strange = rbdi_held_axes(con) == 0;
    for (int j = 0; j < 6; ++j) strange |= con->axes[j] != 0 && con->axes[j] != 1;
    if (con->body1 < -1 || con->body1 >= m->nb)
        return rbdi_refuse(report, RBD_ERR_INDEX, i, con->name, "body1");
    if (con->body1 < 0 && con->body2 < 0)
        return rbdi_refuse_saying(report, RBD_ERR_INDEX, i, con->name, "body1",
                                  "both bodies are -1: the world, or a name that no body has");
    if (con->body2 < -1 || con->body2 >= m->nb)
        return rbdi_refuse(report, RBD_ERR_INDEX, i, con->name, "body2");
    if (rbdi_link_of_body(m, con->body1) == rbdi_link_of_body(m, con->body2))
        return rbdi_refuse_saying(report, RBD_ERR_INDEX, i, con->name, "body2",
                                  "no joint moves it relative to body1");

    if (!rbdi_is_rotation(con->rotation1))
        return rbdi_refuse(report, RBD_ERR_ROTATION, i, con->name, "rotation1");
    if (!rbdi_finite(con->position1, 3))
        return rbdi_refuse(report, RBD_ERR_POSITION, i, con->name, "position1");
    if (!rbdi_is_rotation(con->rotation2))
        return rbdi_refuse(report, RBD_ERR_ROTATION, i, con->name, "rotation2");
    if (!rbdi_finite(con->position2, 3))
        return rbdi_refuse(report, RBD_ERR_POSITION, i, con->name, "position2");

    if (strange)
        return rbdi_refuse_saying(report, RBD_ERR_AXIS, i, con->name, "axes",
                                  "none is held, or one is neither 0 nor 1");
    if (!rbdi_finite_positive(&con->kp, 1)) return rbdi_refuse(report, RBD_ERR_RANGE, i, con->name, "kp");
    if (!rbdi_finite_positive(&con->kd, 1)) return rbdi_refuse(report, RBD_ERR_RANGE, i, con->name, "kd");
    return RBD_OK;
}

/* Converts a frame on a body to a frame on its link; returns the link. */
RBDI_LOCAL int rbdi_place_frame(const rbd_model *m, int body, const double rotation[9],
                                const double position[3], rbd_const R_link[9], rbdi_c3 *p_link) {
    rbdi_wide A[9], x[3], E[9], r[3] = {0, 0, 0};
    rbdi_w_identity(E);
    rbdi_widen(rotation, 9, A);
    rbdi_widen(position, 3, x);
    if (rbdi_all_zero(rotation, 9)) rbdi_w_identity(A);
    rbdi_orthonormalise(A);

    /* the body's frame on its link */
    if (body >= 0) {
        const rbdi_frame *u = &m->frame[body];
        for (int k = 0; k < 9; ++k) E[k] = (rbdi_wide)u->E[k / 3 + k % 3 * 3]; /* transposed */
        r[0] = (rbdi_wide)u->r.x;
        r[1] = (rbdi_wide)u->r.y;
        r[2] = (rbdi_wide)u->r.z;
    }

    /* E A, r + E x */
    rbdi_w_product(E, A, A);
    rbdi_w_apply(E, x, x);
    for (int k = 0; k < 9; ++k) R_link[k] = (rbd_const)A[k];
    p_link->x = (rbd_const)(r[0] + x[0]);
    p_link->y = (rbd_const)(r[1] + x[1]);
    p_link->z = (rbd_const)(r[2] + x[2]);

    return rbdi_link_of_body(m, body);
}

/* The nearest common ancestor of two links, or one of them; -1 = world. Ancestors have smaller indices. */
RBDI_LOCAL int rbdi_common_ancestor(const rbd_model *m, int one, int two) {
    while (one != two) {
        int *later = one > two ? &one : &two;
        *later = m->link[*later].parent;
    }
    return one;
}

RBDI_LOCAL void rbdi_place_constraint(const rbd_model *m, const rbd_constraint *from, int row,
                                      rbdi_constraint *to) {
    to->link[0] = (int16_t)rbdi_place_frame(m, from->body1, from->rotation1, from->position1, to->rotation[0],
                                            &to->position[0]);
    to->link[1] = (int16_t)rbdi_place_frame(m, from->body2, from->rotation2, from->position2, to->rotation[1],
                                            &to->position[1]);
    to->ancestor = (int16_t)rbdi_common_ancestor(m, to->link[0], to->link[1]);
    to->kp = RBD_C(from->kp);
    to->kd = RBD_C(from->kd);

    /* each held axis is a row: column j of rotation 2 */
    to->row = (int16_t)row;
    to->rows = to->angular = 0;
    for (int r = 0; r < RBDI_SIX_ROWS; ++r) to->held[0][r] = to->held[1][r] = to->held[2][r] = 0;
    for (int j = 0; j < 6; ++j) {
        if (!from->axes[j]) continue;

        for (int i = 0; i < 3; ++i) to->held[i][to->rows] = to->rotation[1][3 * i + j % 3];
        to->axis[to->rows++] = (int16_t)j;
        to->angular = (int16_t)(to->angular + (j < 3));
    }
}

/* Marks a dof and all before it on the way to the world. */
RBDI_LOCAL void rbdi_mark_path(const rbd_model *m, int dof, int16_t *reached) {
    for (int i = dof; i >= 0 && !reached[i]; i = m->dof[i].lambda) reached[i] = 1;
}

/* Finds the dofs of the paths to a constraint's bodies, and extends their spans by its rows. */
RBDI_LOCAL void rbdi_reach_dofs(const rbd_model *m, rbd_constraint_set *c, rbdi_constraint *con) {
    int16_t *reached = c->path;
    for (int i = 0; i < m->nv; ++i) reached[i] = 0;

    for (int side = 0; side < 2; ++side)
        for (int link = con->link[side]; link >= 0; link = m->link[link].parent)
            for (int j = 0; j < rbdi_link_dofs(m, &m->link[link]); ++j)
                rbdi_mark_path(m, rbdi_source(m, m->link[link].iv + j), reached);

    con->dofs = 0;
    for (int i = 0; i < m->nv; ++i) {
        rbdi_span *s = &c->span[i];
        if (!reached[i]) continue;

        if (s->end == 0) s->first = con->row;
        s->end = (int16_t)(con->row + con->rows);
        con->dof[con->dofs++] = (int16_t)i;
    }
}

/* Prepares a set whose constraints are placed for this model and work: the dofs of each, spans, and the links
   on all paths. */
RBDI_LOCAL void rbdi_begin_set(const rbd_model *m, rbd_work *w, rbd_constraint_set *c) {
    for (int k = 0; k < RBDI_SHAPE; ++k) c->shape[k] = m->shape[k];
    c->w = w;
    c->infeasible = -1;

    for (int k = 0; k < m->nv; ++k) c->span[k].first = c->span[k].end = 0;
    for (int i = 0; i < c->n; ++i) rbdi_reach_dofs(m, c, &c->constraint[i]);

    c->links = 0;
    for (int i = 0; i < m->nl && !rbdi_mimics(m); ++i)
        if (c->span[m->link[i].iv].end > 0) c->link[c->links++] = (int16_t)i;
}

/* Whether rows depend on each other in every state. Articulated bodies would fail in all of them. There are
   more rows than dofs, or between two links more than six, or more than the dofs that move one of them. */
RBDI_LOCAL int rbdi_too_many_rows(const rbd_model *m, const rbd_constraint_set *c) {
    const rbdi_constraint *stop = c->constraint + c->n;
    int too_many = c->rows > m->nv;
    for (const rbdi_constraint *con = c->constraint; con < stop; ++con) {
        int rows = 0, dofs = 0;

        /* rows of all constraints between these two links */
        for (const rbdi_constraint *o = c->constraint; o < stop; ++o)
            if ((o->link[0] == con->link[0] && o->link[1] == con->link[1]) ||
                (o->link[0] == con->link[1] && o->link[1] == con->link[0]))
                rows += o->rows;

        for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);)
            dofs += rbdi_link_dofs(m, &m->link[walk.link]);
        too_many |= rows > 6 || rows > dofs;
    }
    return too_many;
}

/* Checks the arguments of rbd_constraint_set_init. */
RBDI_LOCAL rbd_status rbdi_check_list(const rbd_model *m, const rbd_work *w, const rbd_constraint *list,
                                      int n, const void *memory, size_t size, rbd_report *report) {
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);

    if (!m || !w || (!list && n) || !memory) return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (rbdi_check(m, w, 1)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (n < 0 || n > RBD_MAX_CONSTRAINTS) {
        rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);
        report->error.text = "the number of constraints is below 0 or above RBD_MAX_CONSTRAINTS";
        return RBD_ERR_COUNT;
    }

    for (int i = 0; i < n; ++i) {
        const rbd_status status = rbdi_check_constraint(m, &list[i], i, report);
        if (status) return status;
    }

    if (size < rbd_constraint_set_size(m, list, n))
        return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);
    return RBD_OK;
}

/* Lays out the memory as RBDI_CONSTRAINTS_BYTES says. */
RBDI_LOCAL rbd_constraint_set *rbdi_lay_constraints(int nv, int n, int rows, void *memory) {
    const int stride = rbdi_row_stride(rows);
    unsigned char *p = rbdi_aligned(memory);
    rbd_constraint_set *c = (rbd_constraint_set *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_constraint_set)));
    rbd_real *x;
    c->n = n;
    c->rows = rows;
    c->stride = stride;

    c->constraint = (rbdi_constraint *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n * sizeof(rbdi_constraint)));
    c->link = (int16_t *)rbdi_take(&p, 1, RBDI_ROUND((size_t)nv * ((size_t)n + 1) * sizeof(int16_t)));
    for (int i = 0; i < n; ++i) c->constraint[i].dof = c->link + (i + 1) * nv;
    c->span = (rbdi_span *)rbdi_take(&p, 1, RBDI_ROUND((size_t)nv * sizeof(rbdi_span)));
    c->path = (int16_t *)rbdi_take(&p, 1, RBDI_ROUND((size_t)nv * sizeof(int16_t)));
    c->Y = (rbd_real *)rbdi_take(&p, nv * stride, sizeof(rbd_real));
    c->R = (rbd_real *)rbdi_take(&p, (rows > nv ? rows : nv) * stride, sizeof(rbd_real));

    /* an entry for each dof */
    x = (rbd_real *)rbdi_take(&p, 4 * nv, sizeof(rbd_real));
    c->x = x;
    c->of_dofs.reflection = x + nv;
    c->last_step = x + 2 * nv;
    c->D_inverse = x + 3 * nv;

    /* an entry for each row; velocity, gamma and e are cleared together */
    x = (rbd_real *)rbdi_take(&p, 11 * stride, sizeof(rbd_real));
    rbdi_clear(x, 11 * stride);
    c->b = x;
    c->lambda = x + stride;
    c->target = x + 2 * stride;
    c->velocity = x + 3 * stride;
    c->gamma = x + 4 * stride;
    c->e = x + 5 * stride;
    c->slack = x + 6 * stride;
    c->square = x + 7 * stride;
    c->of_rows.inverse_square = x + 8 * stride;
    c->pivot_row = x + 9 * stride;
    c->R_inverse = x + 10 * stride;

    return c;
}

RBDI_API rbd_status rbd_constraint_set_init(const rbd_model *m, rbd_work *w, const rbd_constraint *list,
                                            int n, void *memory, size_t size,
                                            rbd_constraint_set **constraints, rbd_report *report) {
    rbd_report own;
    rbd_constraint_set *c;
    rbd_status status;
    int row = 0;
    if (!report) report = &own;
    status = rbdi_check_list(m, w, list, n, constraints ? memory : NULL, size, report);
    if (constraints) *constraints = NULL;
    if (status) return status;

    c = rbdi_lay_constraints(m->nv, n, rbdi_rows_of(list, n), memory);
    c->dirty = 1;
    c->pivoted = 0;
    c->moving = 0;
    for (int i = 0; i < n; ++i) {
        rbdi_place_constraint(m, &list[i], row, &c->constraint[i]);
        c->moving |= list[i].kp > 0 || list[i].kd > 0 || c->constraint[i].link[1] >= 0;
        row += c->constraint[i].rows;
    }

    rbdi_begin_set(m, w, c);
    c->factored = rbdi_mimics(m) > 0 || rbdi_too_many_rows(m, c);
    *constraints = c;
    return RBD_OK;
}

/* ==== src/rbd_constraints.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

#if defined RBD_IMPLEMENTATION && defined RBDI_CONSTRAINTS_IMPLEMENTED && \
    defined RBDI_CONSTRAINED_DERIVATIVES && !defined RBDI_CONSTRAINED_DERIVATIVES_IMPLEMENTED
#define RBDI_CONSTRAINED_DERIVATIVES_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/constraints/derivatives.h ==== */
/* Interface: rbdi_cross_add, rbdi_differentiate_error, rbdi_differentiate_forces, rbdi_differentiate_motion,
   rbdi_motion_derivatives, rbdi_pair_motion, rbdi_pair_motion_of, rbdi_roll */

/* ---- derivatives [derivatives code] ----
   Where x is a component of q, v or tau,

       M da/dx = J' dlambda/dx - rho,     rho = d(ID - J' lambda)/dx at fixed a and lambda
       J da/dx = -sigma,                  sigma = d(J a + gamma + kd J v + kp e)/dx at fixed a

   so that with T = M^-1 J'

       Delta dlambda/dx = T' rho - sigma,   da/dx = -M^-1 rho + T dlambda/dx

   By tau, rho = -1 and sigma = 0. rbd_id_derivatives gives d ID. The rest depends only on the relative motion
   of the two bodies, so only on dofs that move one of them. All quantities are in world axes; motions are
   those of the link-fixed points at p, the origin of frame 1. Such a dof k moves body b; S = (z; s), negated
   if b is body 2. Psi, Phi and U are those of [common frame] in rbd_derivatives.h, about p instead of the
   common origin:

       by q   dw = z x omega_b + Psi_omega
              du = z x v_b + Psi_v - omega_2 x s
              dalpha = z x alpha_b + Psi_omega x omega_b + Phi_omega - omega_2 x dw
              dacc = z x acc_b + 2 Psi_omega x v_b + Phi_v - alpha_2 x s - omega_2 x (omega_2 x s)
                     - 2 omega_2 x du
       by v   dalpha = U_omega + z x omega_b - omega_2 x z
              dacc = U_v + 2 z x v_b - 2 omega_2 x s

   where (w; u) is the velocity of body 1 relative to body 2 and (alpha; acc) its rate. If b is body 2, the
   axes turn with it, which adds by q (z x w; z x u) to (dw; du) and (dw x w + z x alpha; 2 dw x u + z x acc),
   with dw from above, to (dalpha; dacc), and by v (z x w; 2 z x u). With n and f the moment and force of
   lambda, and S_i of another such dof, J' lambda has

       d(S_i . (n; f)) = S_i . (n x z; f x z)   if b is body 1 and k moves i, or b is body 2 and it does not
                         S_i . (s x f; 0)       else

   Checked against finite differences in tests/test_constraints.c. */

/* Motion of body 1 relative to body 2 at the origin of frame 1, world axes, and what its derivatives need. */
typedef struct rbdi_pair_motion {
    rbdi_relative_motion motion; /* velocity (w; u), rate (alpha; acc) */
    rbdi_force force;            /* of lambda */
    rbdi_axes_held h;
    rbdi_v3 log_R;       /* world axes */
    rbd_real log_square; /* rbdi_log_square of it */
    rbdi_v3 free[2];     /* the free axis if two angular ones are held: of frame 2, of frame 1 */
    rbdi_v3 roll_radius; /* of a contact, from its place to the centre of its ball; else 0 */
    rbdi_v3 normal;      /* of the plane on which the place of a contact stays; else 0 */
} rbdi_pair_motion;

/* S of a dof, and derivatives by it: of (w; u) by q, of (alpha; acc) by q and by v. */
typedef struct rbdi_motion_derivatives {
    rbdi_motion S, velocity_q, rate_q, rate_v;
} rbdi_motion_derivatives;

RBDI_INLINE rbdi_motion rbdi_motion_cross(rbdi_motion V, rbdi_motion S) {
    rbdi_motion C;
    C.omega = rbdi_cross(V.omega, S.omega);
    C.v = rbdi_add(rbdi_cross(V.omega, S.v), rbdi_cross(V.v, S.omega));
    return C;
}

/* 2 a */
RBDI_INLINE rbdi_v3 rbdi_twice(rbdi_v3 a) { return rbdi_add(a, a); }

/* x + a x b */
RBDI_INLINE rbdi_v3 rbdi_cross_add(rbdi_v3 x, rbdi_v3 a, rbdi_v3 b) { return rbdi_add(x, rbdi_cross(a, b)); }

/* x - a x b */
RBDI_INLINE rbdi_v3 rbdi_cross_sub(rbdi_v3 x, rbdi_v3 a, rbdi_v3 b) { return rbdi_add(x, rbdi_cross(b, a)); }

RBDI_LOCAL rbdi_pair_motion rbdi_pair_motion_of(const rbd_constraint_set *c, const rbdi_constraint *con) {
    rbdi_pair_motion pair;
    pair.motion = rbdi_relative_motion_of(c, con);
    rbdi_set_axes(c, con, &pair.h);

    /* n and f: the sum of lambda times the row's axis */
    pair.force.n = pair.force.f = rbdi_vec0();
    for (int r = 0; r < con->rows; ++r) {
        const int angular = r < con->angular, i = angular ? 0 : 3;
        const rbdi_v3 axis = rbdi_vec(pair.h.axis[i][r], pair.h.axis[i + 1][r], pair.h.axis[i + 2][r]);
        rbdi_v3 *to = angular ? &pair.force.n : &pair.force.f;
        *to = rbdi_add(*to, rbdi_scale(c->lambda[con->row + r], axis));
    }

    /* the angular part of e */
    pair.log_R = pair.free[0] = pair.free[1] = rbdi_vec0();
    pair.roll_radius = pair.normal = rbdi_vec0();
    pair.log_square = rbdi_zero();
    if (con->kp > 0 && con->angular) {
        const rbdi_mat R_1 = rbdi_frame_axes(c, con, 0), R_2 = rbdi_frame_axes(c, con, 1);
        const int i = con->angular == 2 ? 3 - con->axis[0] - con->axis[1] : 0;
        rbd_real axis[3] = {rbdi_zero(), rbdi_zero(), rbdi_zero()};

        pair.log_R = rbdi_log_rotation(rbdi_mul_mat(rbdi_transpose(R_2), R_1));
        pair.log_square = rbdi_log_square(pair.log_R);
        pair.log_R = rbdi_mul(R_2, pair.log_R);

        axis[i] = rbdi_set(RBD_C(1));
        pair.free[0] = rbdi_mul(R_2, rbdi_load_vec(axis, 1));
        pair.free[1] = rbdi_mul(R_1, rbdi_load_vec(axis, 1));
    }
    return pair;
}

/* The terms in the axes of body 2 that turn with it: by q (z x w; z x u) and (dw x w + z x alpha; 2 dw x u +
   z x acc), by v (z x w; 2 z x u). */
RBDI_INLINE void rbdi_turn_with_body2(rbdi_motion velocity, rbdi_motion rate, rbdi_v3 z,
                                      rbdi_motion_derivatives *by) {
    const rbdi_v3 dw = by->velocity_q.omega;

    by->rate_q.omega = rbdi_cross_add(rbdi_cross_add(by->rate_q.omega, dw, velocity.omega), z, rate.omega);
    by->rate_q.v = rbdi_cross_add(rbdi_cross_add(by->rate_q.v, dw, rbdi_twice(velocity.v)), z, rate.v);

    by->velocity_q.omega = rbdi_cross_add(dw, z, velocity.omega);
    by->velocity_q.v = rbdi_cross_add(by->velocity_q.v, z, velocity.v);

    by->rate_v.omega = rbdi_cross_add(by->rate_v.omega, z, velocity.omega);
    by->rate_v.v = rbdi_cross_add(by->rate_v.v, z, rbdi_twice(velocity.v));
}

/* How far the place of a contact moves over body 1 if that moves by S relative to body 2: its centre moves by
   S, and the place stays below it; on a plane that moves neither up nor down. */
RBDI_INLINE rbdi_v3 rbdi_roll(const rbdi_pair_motion *pair, rbdi_motion S) {
    const rbdi_v3 up = rbdi_scale(rbdi_dot(pair->normal, S.v), pair->normal);
    return rbdi_sub(rbdi_cross(S.omega, pair->roll_radius), up);
}

/* Derivatives by dof j of a link on the path of body `side`. */
RBDI_LOCAL rbdi_motion_derivatives rbdi_differentiate_motion(const rbd_model *m, const rbd_constraint_set *c,
                                                             const rbdi_pair_motion *pair, int side, int link,
                                                             int j) {
    const rbdi_station *b = &pair->motion.body[side], P = rbdi_station_at(c, m->link[link].parent, b->p),
                       own = rbdi_station_at(c, link, b->p);
    const rbd_real ratio = rbdi_ratio(m, m->link[link].iv + j), scale = side ? -ratio : ratio;
    const rbdi_v3 omega2 = pair->motion.body[1].omega;
    rbdi_motion V, A, Psi, Phi, U;
    rbdi_motion_derivatives by;
    rbdi_v3 z, s, omega2_s;

    by.S = rbdi_column(m, c->w, link, j, b->p);
    by.S.omega = rbdi_scale(scale, by.S.omega);
    by.S.v = rbdi_scale(scale, by.S.v);
    z = by.S.omega;
    s = by.S.v;

    /* Psi = V_P x S, Phi = A_P x S + V_P x Psi, U = Psi + V_link x S */
    V.omega = own.omega;
    V.v = own.v;
    U = rbdi_motion_cross(V, by.S);
    V.omega = P.omega;
    V.v = P.v;
    A.omega = P.omega_dot;
    A.v = rbdi_cross_sub(P.acc, P.omega, P.v);
    Psi = rbdi_motion_cross(V, by.S);
    Phi = rbdi_motion_add(rbdi_motion_cross(A, by.S), rbdi_motion_cross(V, Psi));
    U = rbdi_motion_add(U, Psi);

    /* dw, du by q */
    omega2_s = rbdi_cross(omega2, s);

    by.velocity_q.omega = rbdi_cross_add(Psi.omega, z, b->omega);
    by.velocity_q.v = rbdi_sub(rbdi_cross_add(Psi.v, z, b->v), omega2_s);

    /* dalpha, dacc by q */
    by.rate_q.omega = rbdi_cross_add(rbdi_cross_add(Phi.omega, z, b->omega_dot), Psi.omega, b->omega);
    by.rate_q.omega = rbdi_cross_sub(by.rate_q.omega, omega2, by.velocity_q.omega);
    by.rate_q.v = rbdi_cross_add(rbdi_cross_add(Phi.v, z, b->acc), rbdi_twice(Psi.omega), b->v);
    by.rate_q.v =
        rbdi_cross_sub(rbdi_cross_sub(by.rate_q.v, pair->motion.body[1].omega_dot, s), omega2, omega2_s);
    by.rate_q.v = rbdi_cross_sub(by.rate_q.v, omega2, rbdi_twice(by.velocity_q.v));

    /* dalpha, dacc by v */
    by.rate_v.omega = rbdi_cross_sub(rbdi_cross_add(U.omega, z, b->omega), omega2, z);
    by.rate_v.v = rbdi_sub(rbdi_cross_add(U.v, z, rbdi_twice(b->v)), rbdi_twice(omega2_s));

    if (side) rbdi_turn_with_body2(pair->motion.velocity, pair->motion.rate, z, &by);

    /* The place of contact moves over body 1. */
    by.velocity_q.v = rbdi_cross_add(by.velocity_q.v, pair->motion.velocity.omega, rbdi_roll(pair, by.S));
    return by;
}

/* Derivative of the angular part of e, world axes, by a dof that turns body 1 by z relative to body 2. With w
   = log R: z - w x z / 2 + factor w x (w x z), [rbdi_log_square]. If two axes are held: f_2 x (z x f_1), f
   the free axis. */
RBDI_LOCAL rbdi_v3 rbdi_differentiate_error(const rbdi_constraint *con, const rbdi_pair_motion *pair,
                                            rbdi_v3 z) {
    const rbdi_v3 bent = rbdi_cross(pair->log_R, z),
                  more = rbdi_scale(pair->log_square, rbdi_cross(pair->log_R, bent));

    if (con->angular == 2) return rbdi_cross(pair->free[0], rbdi_cross(z, pair->free[1]));
    return rbdi_add(rbdi_add(z, rbdi_scale(rbdi_set(RBD_C(-0.5)), bent)), more);
}

/* Adds a dof's column of sigma. */
RBDI_LOCAL void rbdi_add_sigma(const rbdi_constraint *con, const rbdi_pair_motion *pair,
                               const rbdi_motion_derivatives *by, int nv, rbd_real *sigma_q,
                               rbd_real *sigma_v) {
    rbd_real sum[2][RBDI_SIX_ROWS], also[RBDI_SIX_ROWS]; /* by q, by v */

    /* J a + gamma */
    rbdi_clear(sum[0], 2 * RBDI_SIX_ROWS);
    rbdi_add_held(con, &pair->h, by->rate_q.omega, by->rate_q.v, sum[0]);
    rbdi_add_held(con, &pair->h, by->rate_v.omega, by->rate_v.v, sum[1]);

    /* kd J v by q, by v; kp e by q */
    for (int part = 0; part < 3; ++part) {
        rbdi_v3 turn = part == 0 ? by->velocity_q.omega : by->S.omega;
        const rbd_const gain = part < 2 ? con->kd : con->kp;
        if (!(gain > 0)) continue;

        if (part == 2) turn = rbdi_differentiate_error(con, pair, turn);
        rbdi_clear(also, RBDI_SIX_ROWS);
        rbdi_add_held(con, &pair->h, turn, part == 0 ? by->velocity_q.v : by->S.v, also);
        for (int r = 0; r < con->rows; ++r) sum[part == 1][r] = sum[part == 1][r] + also[r] * gain;
    }

    for (int r = 0; r < con->rows; ++r) {
        if (sigma_q) sigma_q[(con->row + r) * nv] = sigma_q[(con->row + r) * nv] + sum[0][r];
        if (sigma_v) sigma_v[(con->row + r) * nv] = sigma_v[(con->row + r) * nv] + sum[1][r];
    }
}

/* Subtracts the derivative of J' lambda by a dof of the link `mover`, with this S, from a column of rho. S of
   all dofs is stage.mover in the columns of d.

       S_i . (n x z; f x z)   if k is on the path of body 1 and moves i, or on that of body 2 and does not
       S_i . (s x f; 0)       else */
RBDI_LOCAL void rbdi_subtract_force_derivative(const rbd_model *m, const rbd_derivatives *d,
                                               const rbdi_constraint *con, const rbdi_pair_motion *pair,
                                               int side, int mover, rbdi_motion S, rbd_real *rho) {
    const rbdi_v3 o = rbdi_vec0(), nz = rbdi_cross(pair->force.n, S.omega),
                  fz = rbdi_cross(pair->force.f, S.omega), sf = rbdi_cross(S.v, pair->force.f),
                  roll = rbdi_cross(rbdi_roll(pair, S), pair->force.f);

    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];
        const int moved =
            walk.side == side && l->first >= m->link[mover].first; /* on the same path: behind it */
        const rbdi_v3 moment = rbdi_add(roll, moved == side ? sf : nz), force = moved == side ? o : fz;

        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_motion C = rbdi_load_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH);
            rbd_real *to = &rho[rbdi_source(m, l->iv + j) * m->nv];
            *to = *to - rbdi_dot(C.omega, moment) - rbdi_dot(C.v, force);
        }
    }
}

/* rho += -d(J' lambda) of a constraint, with the dofs' motions in d. */
RBDI_LOCAL void rbdi_differentiate_forces(const rbd_model *m, const rbd_derivatives *d,
                                          const rbdi_constraint *con, const rbdi_pair_motion *pair,
                                          rbd_real *rho) {
    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j)
            rbdi_subtract_force_derivative(
                m, d, con, pair, walk.side, walk.link,
                rbdi_load_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH),
                rho + rbdi_source(m, l->iv + j));
    }
}

/* The same, and += sigma by q and by v. NULL: not wanted. */
RBDI_LOCAL void rbdi_differentiate(const rbd_model *m, const rbd_constraint_set *c, const rbd_derivatives *d,
                                   const rbdi_constraint *con, rbd_real *rho_q, rbd_real *sigma_q,
                                   rbd_real *sigma_v) {
    const rbdi_pair_motion pair = rbdi_pair_motion_of(c, con);

    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_motion_derivatives by =
                rbdi_differentiate_motion(m, c, &pair, walk.side, walk.link, j);
            const int column = rbdi_source(m, l->iv + j);

            rbdi_store_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH, by.S);
            rbdi_add_sigma(con, &pair, &by, m->nv, sigma_q ? sigma_q + column : NULL,
                           sigma_v ? sigma_v + column : NULL);
        }
    }

    if (rho_q) rbdi_differentiate_forces(m, d, con, &pair, rho_q);
}

/* Replaces sigma by dlambda = Delta^-1 (T' rho - sigma). c->Y: -T. */
RBDI_LOCAL void rbdi_lambda_derivatives(const rbd_model *m, rbd_constraint_set *c, const rbd_real *rho,
                                        rbd_real *sigma) {
    const int n = m->nv;
    for (int r = 0; r < c->rows; ++r) {
        rbd_real *to = &sigma[r * n];
        for (int k = 0; k < n; ++k) {
            to[k] = -to[k];
            c->x[k] = c->Y[k * c->stride + r];
        }
        rbdi_subtract_product(c->x, rho, n, n, to);
    }

    rbdi_delta_solve(c, sigma, n);
}

/* Replaces rho by da = -M^-1 rho + T dlambda and sigma by dlambda, all columns at once. c->Y: -T. */
RBDI_LOCAL void rbdi_solve_at_once(const rbd_model *m, rbd_constraint_set *c, rbd_real *rho,
                                   rbd_real *sigma) {
    const int nv = m->nv;
    rbdi_lambda_derivatives(m, c, rho, sigma);
    rbdi_solve_columns(m, c->w, c->w->H, -1, nv, nv, rho);
    for (int k = 0; k < nv; ++k)
        rbdi_subtract_product(&c->Y[k * c->stride], sigma, c->rows, nv, &rho[k * nv]);
}

/* Column j of x = -D^-1 L^-T rho, Y' x = -sigma, by the steps of rbd_constrained_fd. rho: L^-T rho, becomes
   D (x + D^-1 Y dlambda); sigma becomes dlambda. D is not in c->w->pivot: if a pivot of M was in doubt,
   [pivots] has written verdicts there. Notes a row that the column does not meet. */
RBDI_LOCAL void rbdi_solve_column(const rbd_model *m, rbd_constraint_set *c, int j, rbd_real *rho,
                                  rbd_real *sigma) {
    const rbdi_mask look = rbdi_less(rbdi_zero(), rbdi_set(RBD_C(1)));
    rbdi_mask none = rbdi_not(look);
    const int nv = m->nv;
    for (int k = 0; k < nv; ++k) c->x[k] = -c->D_inverse[k] * rho[k * nv + j];
    for (int r = 0; r < c->rows; ++r) c->target[r] = -sigma[r * nv + j];

    rbdi_rest_of_rows(c);
    for (int r = 0; r < c->rows; ++r) c->lambda[r] = c->b[r];
    rbdi_delta_solve(c, c->lambda, 1);
    (void)rbdi_add_forces(m, c, c->lambda);
    if (rbdi_refine(m, c, look) || c->pivoted) rbdi_check_held(m, c);

    for (int k = 0; k < nv; ++k)
        rho[k * nv + j] = c->x[k] * rbdi_reciprocal(c->D_inverse[k], RBDI_TINY, &none);
    for (int r = 0; r < c->rows; ++r) sigma[r * nv + j] = c->lambda[r];
}

/* As rbdi_solve_at_once, column by column with [refinement]. c->Y: L^-T J'. */
RBDI_COLD void rbdi_solve_by_columns(const rbd_model *m, rbd_constraint_set *c, rbd_real *rho,
                                     rbd_real *sigma) {
    const int nv = m->nv;
    rbdi_solve_transposed(m, c->w, c->w->H, nv, nv, rho);
    for (int j = 0; j < nv; ++j) rbdi_solve_column(m, c, j, rho, sigma);
    rbdi_solve_forward(m, c->w, c->w->H, 1, nv, nv, rho);
}

/* Whether accelerations by a force at each dof lose so many digits that rows may need [refinement]. One set
   of forces, all different, stands for all columns: the loss depends on D and Y, hardly on the forces. */
RBDI_LOCAL int rbdi_loses_digits(const rbd_model *m, rbd_constraint_set *c) {
    for (int k = 0; k < m->nv; ++k)
        c->x[k] = c->D_inverse[k] * (RBD_C(1) + RBD_C(0.618) * (rbd_const)(k % 7));
    rbdi_clear(c->target, c->rows);
    rbdi_rest_of_rows(c);

    rbdi_delta_solve(c, c->b, 1);
    if (rbdi_any(rbdi_add_forces(m, c, c->b))) return 1;
    return c->pivoted && rbdi_any(rbdi_rows_miss(c));
}

/* Makes da of rho and dlambda of sigma, for q, v and tau. status: of a. Returns that of the call. */
RBDI_LOCAL rbd_status rbdi_constrained_slopes(const rbd_model *m, rbd_constraint_set *c, rbd_status status,
                                              rbd_real *const of_a[3], rbd_real *const of_lambda[3]) {
    const int nv = m->nv, by_columns = rbdi_loses_digits(m, c);
    if (!by_columns)
        rbdi_solve_forward(m, c->w, c->w->H, -1, c->stride, c->rows, c->Y); /* -T = -L^-1 D^-1 Y */

    for (int x = 0; x < 3; ++x) {
        if (!of_a[x]) continue;
        if (by_columns)
            rbdi_solve_by_columns(m, c, of_a[x], of_lambda[x]);
        else
            rbdi_solve_at_once(m, c, of_a[x], of_lambda[x]);
    }

    /* M is singular: that is the error, and there are no results */
    if (status && status != RBD_ERR_INFEASIBLE) {
        c->infeasible = -1;
        for (int x = 0; x < 3; ++x) {
            if (!of_a[x]) continue;
            (void)rbdi_pivot_status(m, c->w, of_a[x], nv * nv);
            (void)rbdi_pivot_status(m, c->w, of_lambda[x], c->rows * nv);
        }
        return status;
    }

    return c->infeasible < 0 ? RBD_OK : RBD_ERR_INFEASIBLE;
}

RBDI_API rbd_status rbd_constrained_fd_derivatives(const rbd_model *m, rbd_constraint_set *c,
                                                   rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                                                   const rbd_real *tau, const rbd_real *f_ext,
                                                   const rbd_constrained_fd_results *out) {
    const rbd_constrained_fd_results none_wanted = {NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
    const rbd_constrained_fd_results to = out ? *out : none_wanted;
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_real *const of_a[3] = {to.da_dq, to.da_dv, to.da_dtau};
    rbd_real *const of_lambda[3] = {to.dlambda_dq, to.dlambda_dv, to.dlambda_dtau};
    const int nv = m ? m->nv : 0;
    int pairs = 1;
    rbd_status status, solved;

    for (int x = 0; x < 3; ++x) pairs &= !of_a[x] == !of_lambda[x];
    status = rbdi_check_constrained(m, c, d && q && v && tau && out && pairs);
    if (!status) status = rbdi_check_derivatives(m, d, 1);
    if (status) return status;
    if (d->work != c->w) return RBD_ERR_WORK;

    /* a and lambda */
    solved = rbdi_factored_fd(m, c, q, v, tau, f_ext, NULL, d->a);
    solved = rbdi_constrained_status(m, c, solved, to.lambda);

    /* rho by q and v without lambda */
    if (to.da_dq || to.da_dv) (void)rbd_id_derivatives(m, d, q, v, d->a, f_ext, to.da_dq, to.da_dv, NULL);

    /* sigma, and lambda's part of rho */
    for (int x = 0; x < 3; ++x)
        if (of_lambda[x]) rbdi_clear(of_lambda[x], c->rows * nv);
    rbdi_constraint_state(m, c, rbdi_expand_v(m, v, c->w->vx), rbdi_expand_v(m, d->a, c->w->ax), none, 0);
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        rbdi_differentiate(m, c, d, con, to.da_dq, to.dlambda_dq, to.dlambda_dv);

    /* by tau, rho = -1 */
    if (to.da_dtau) rbdi_clear(to.da_dtau, nv * nv);
    for (int k = 0; to.da_dtau && k < nv; ++k) to.da_dtau[k * nv + k] = rbdi_set(RBD_C(-1));

    solved = rbdi_constrained_slopes(m, c, solved, of_a, of_lambda);

    for (int k = 0; to.a && k < nv; ++k) to.a[k] = d->a[k];
    return solved;
}

/* ==== src/rbd_constraints.h ==== */
RBDI_CODE_END

#endif

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("B")
#pragma pop_macro("C")
#pragma pop_macro("E")
#pragma pop_macro("H")
#pragma pop_macro("J")
#pragma pop_macro("K")
#pragma pop_macro("L")
#pragma pop_macro("P")
#pragma pop_macro("R")
#pragma pop_macro("S")
#pragma pop_macro("T")
#pragma pop_macro("U")
#pragma pop_macro("V")
#pragma pop_macro("X")
#pragma pop_macro("Y")
#pragma pop_macro("Z")
