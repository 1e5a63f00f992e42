#ifndef RBDI_CONTACT_LAYOUT_H
#define RBDI_CONTACT_LAYOUT_H
#include "constraints/layout.h"
#include "api/contact.h"

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

#endif
