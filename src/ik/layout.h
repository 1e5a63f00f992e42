#ifndef RBDI_IK_LAYOUT_H
#define RBDI_IK_LAYOUT_H
#include "model/work.h"
#include "base/tolerances.h"
#include "api/ik.h"

/* Interface: rbdi_ik_dof, RBDI_IK_MOST */

/* ---- method [method] ----
   The errors e of all targets, angles times `length`, times the root of the target's weight, stand in one
   vector; J is its Jacobian over the dofs that move a target. A step d minimises

       |J d - e|^2 + damping |d|^2   within the limits of the joints,

   to good approximation: dofs at a limit that the gradient g = J'e presses on stay; the others are solved for
   from (H + damping) d = g, with H = J'J and, in descents, what [curvature] adds; those that would pass their
   limit are set on it, and the rest is solved for again, with H d of these on the right.

   The search takes such steps with damping RBDI_IK_DAMPING |e|^2. It is large far away, where the linear
   model is wrong, and falls with the square of the error, so that the last steps are Newton's. The error may
   grow on the way. A start that has not brought |e|^2 to a quarter for RBDI_IK_STALL steps is given up for
   another one: anywhere within limits, but a turn at most from the caller's angle, RBDI_IK_WIDE lengths at
   most from a slide's, and half a turn at most without limits.

   If no start reaches the targets, descents from the best place and from a few starts look for the nearest
   place. They take steps that bring the error down alone, with the damping of Levenberg and Marquardt. If the
   last ends on a saddle, another begins beside it. */

/* RBDI_IK_DAMPING: a hundred times more needs up to twice the evaluations, a hundred times less a tenth more.
   RBDI_IK_FLOOR: of the damping, a share of the trace of J'J, which is above its rounding.
   RBDI_IK_FAR: |e|^2 counts as at most so many length^2 in the damping.
   RBDI_IK_TURN: rad, the most that a dof turns in a step of the search.
   RBDI_IK_COARSE, RBDI_IK_FINE: a descent ends if |e|^2 falls by less than this share.
   RBDI_IK_PRESSED, RBDI_IK_SETTLED: shares of |e| and the longest column of J. A limit keeps e away if g is
   above the first; e is at its least if g is below the second. */
#define RBDI_IK_DAMPING RBD_C(0.01)
#define RBDI_IK_FLOOR (8 * RBDI_EPS)
#define RBDI_IK_FAR RBD_C(10)
#define RBDI_IK_TURN RBD_C(1)
#define RBDI_IK_WIDE RBD_C(10)
#define RBDI_IK_STEPS 60
#define RBDI_IK_STALL 6
#define RBDI_IK_STARTS 60
#define RBDI_IK_EVALUATIONS 5000
#define RBDI_IK_DESCENTS 8
#define RBDI_IK_LAST 4 /* the last descent has so many times the steps */
#define RBDI_IK_LENGTH RBD_C(0.3)
#define RBDI_IK_STIFF RBD_C(1e9)     /* damping, in length^2, by which hardly any step is left */
#define RBDI_IK_STRAIGHT RBD_C(1e-3) /* rad: the curvature of smaller turns is not needed */
#define RBDI_IK_ASIDE RBD_C(0.05)    /* rad, or length: how far a saddle is left */
#define RBDI_IK_MOST_TARGETS 1000
#define RBDI_IK_MOST RBD_C(1e9)        /* of a position, in m, and of q */
#define RBDI_IK_MOST_WEIGHT RBD_C(1e6) /* and its inverse is the least */
#define RBDI_IK_OVERFLOW RBD_C(1e36)   /* a sum of squares above it is not computed with */
#define RBDI_IK_NEWTON 6 /* the fifth step is the last that changes the root, for any number of dofs */
#if RBDI_KIND(RBD_CONST) == 2
#define RBDI_IK_TOLERANCE RBD_C(1e-5)
#define RBDI_IK_COARSE RBD_C(1e-4)
#define RBDI_IK_PRESSED RBD_C(1e-3)
#else
#define RBDI_IK_TOLERANCE RBD_C(1e-6)
#define RBDI_IK_COARSE RBD_C(1e-8)
#define RBDI_IK_PRESSED RBD_C(1e-6)
#endif
#define RBDI_IK_FINE (4 * RBDI_EPS)
#define RBDI_IK_SETTLED (100 * RBDI_IK_PRESSED)
#define RBDI_IK_ROUNDED (16 * RBDI_EPS)

/* A degree of freedom that moves a target. */
typedef struct rbdi_ik_dof {
    int16_t dof;   /* index into v */
    int16_t at;    /* coordinate of a joint with limits; -1: none */
    int16_t turns; /* whether it is an angle */
    int16_t hold;  /* of the step: one of those below */
    rbd_real lower, upper;
} rbdi_ik_dof;

/* A step solves for a dof, leaves it where it is, or sets it on a limit. */
enum { RBDI_IK_FREE, RBDI_IK_STAYS, RBDI_IK_LOWER, RBDI_IK_UPPER };

/* One search: `ik` in these rooms. */
typedef struct rbdi_ik {
    const rbd_model *m;
    rbd_work *w;
    const rbd_ik_target *target;
    rbd_ik_options options; /* all set */
    rbd_ik_result *result;
    int n, rows, dofs;
    int alone;                /* the body of the only target, which is not the centre of mass; else -1 */
    rbd_const all;            /* kg: mass of the robot */
    rbd_real cost, best_cost; /* |e|^2, and the least so far */

    rbdi_ik_dof *dof;     /* dofs */
    int16_t *mark;        /* nv: the dofs that move a target */
    int16_t *solved;      /* dofs: those that a step solves for; in the memory of mark */
    rbd_real *e;          /* rows */
    rbd_real *J;          /* dofs x rows: column after column */
    rbd_real *columns;    /* 6 x nv: Jacobian of one target */
    rbd_real *H, *factor; /* dofs (dofs + 1) / 2: upper triangle of H, by rows; the free dofs' factor */
    rbd_real *g, *d, *x;  /* dofs: J'e, the step, and that of the free dofs */
    rbd_real *v;          /* nv: the step */
    rbd_real *from, *best, *q, *trial; /* nq: the caller's, the best, and where the search is */
    rbd_real *mass; /* nl x 4: of subtrees, mass and first moment about the first link, world axes */
} rbdi_ik;

/* Numbers of scalars and bytes for nv dofs, nl links and n targets. nq <= 2 nv. */
#define RBDI_IK_SCALARS(nv, nl, n) \
    (6 * (size_t)(n) * (1 + (size_t)(nv)) + 6 * (size_t)(nv) + (size_t)(nv) * ((size_t)(nv) + 1) + \
     4 * (size_t)(nv) + 8 * (size_t)(nv) + 4 * (size_t)(nl))
#define RBDI_IK_BYTES(nv, nl, n) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbdi_ik)) + RBDI_ROUND((size_t)(nv) * sizeof(rbdi_ik_dof)) + \
     RBDI_ROUND((size_t)(nv) * sizeof(int16_t)) + RBDI_ROUND(RBDI_IK_SCALARS(nv, nl, n) * sizeof(rbd_real)))

/* Bytes that suffice for n targets and any model with nb bodies and nv degrees of freedom; a constant. */
#define RBD_IK_SIZE(nb, nv, n) RBDI_IK_BYTES(nv, RBDI_LINKS(nb, nv), n)

#endif
