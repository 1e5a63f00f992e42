#ifndef RBDI_ESTIMATE_LAYOUT_H
#define RBDI_ESTIMATE_LAYOUT_H
#include "model/layout.h"
#include "base/tolerances.h"
#include "api/estimate.h"

/* ---- method [method] ----
   The observer (De Luca and Mattone 2005): dp/dt = x + torque, with the momentum p = M v, x = tau - friction
   + C'v - g, and the torque that is looked for. r follows it, r' = gain (dp/dt - x - r), by the implicit step

       r_next = (r + gain (p_next - p - dt x)) / (1 + gain dt)

   with the mean of C'v - g. No integral of x is kept, so nothing drifts. The friction that r takes for a
   torque is at most `bound`; the band follows the bound by the same step, so |r - true r| <= band.

   The estimate: a sample has a row for each dof,

       y pi + offset + coulomb sign(v) + viscous v = left over,   y = the regressor of the payload's body,

   over the standard deviation of its torque. All rows so far are kept as triangles R, z, by Givens' turns,
   so that |R x - z|^2 is their sum of squares: of each dof three rows, for its friction, which reach over the
   payload's columns; then ten rows of the payload alone. The turns eliminate the friction first. A row that
   comes in leaves what no unknown explains, which counts for the misfit.

   The unknowns of the payload are the entries of its pseudo-inertia (Wensing, Kim and Slotine 2018)

       P = [S h; h' m],   S = second moment of mass = tr(I)/2 - I,  h = m c,

   packed by rows of the lower triangle: p. A body can be like that if P is positive definite. The estimate

       minimises |R p - z|^2 / 2 + |p|^2 / 2

   in units of mass and reach of the options: the prior |p|^2, outside of what is forgotten, has them as its
   standard deviations. If that is no body, it minimises this less weight log det P, with the least weight:
   the nearest that is one, found by interior points, anew in each call. */

/* RBDI_EST_LEAST: of the weight. A body that no sample tells of has a tenth of the options' mass.
   RBDI_EST_ROUNDS: at most; some 15 will do. RBDI_EST_SMALL: share of P; a smaller step ends them.
   RBDI_EST_LESS: factor of the weight after a full step. RBDI_EST_JAM: a smaller share
   makes Z anew.
   RBDI_EST_SHORT: share that is taken of a step to the rim; RBDI_EST_CUTS: bisections that find it.
   RBDI_EST_RIM: a pivot of P must be above this share of its diagonal, and above RBDI_EST_FLOOR, so
   that no square of its inverse overflows.
   RBDI_EST_BALL: where the rounds begin: a ball of this mass and, about each axis, radius of gyration,
   in the units of the options. */
#define RBDI_EST_LEAST RBD_C(0.01)
#define RBDI_EST_ROUNDS 50
#define RBDI_EST_SMALL RBD_C(1e-3)
#define RBDI_EST_LESS RBD_C(0.1)
#define RBDI_EST_JAM RBD_C(0.01)
#define RBDI_EST_SHORT RBD_C(0.95)
#define RBDI_EST_CUTS 9
#define RBDI_EST_RIM (64 * RBDI_EPS)
#define RBDI_EST_FLOOR RBD_C(1e-12)
#define RBDI_EST_BALL RBD_C(0.06)

/* Defaults, and the largest number that is computed with: of options, and of a row over its noise. */
#define RBDI_EST_MASS RBD_C(5)
#define RBDI_EST_REACH RBD_C(0.2)
#define RBDI_EST_FRICTION RBD_C(100)
#define RBDI_EST_FORGETTING RBD_C(0.998)
#define RBDI_EST_SLOW RBD_C(0.03)
#define RBDI_EST_NOISE RBD_C(0.1)
#define RBDI_EST_OBSERVER_SLOW RBD_C(0.02)
#define RBDI_EST_LARGE RBD_C(1e9)

/* Columns of a row: offset, coulomb, viscous, ten of the payload, and the right side. */
enum {
    RBDI_EST_FRICTIONS = 3,                                            /* columns of the friction of a dof */
    RBDI_EST_TEN = 10,                                                 /* of the payload */
    RBDI_EST_TEN_ROW = RBDI_EST_TEN + 1,                               /* a row of the payload alone */
    RBDI_EST_WHOLE_ROW = RBDI_EST_FRICTIONS + RBDI_EST_TEN_ROW,        /* a row of a dof */
    RBDI_EST_JOINT_TRIANGLE = RBDI_EST_FRICTIONS * RBDI_EST_WHOLE_ROW, /* scalars of the triangle of a dof */
    RBDI_EST_LOAD_TRIANGLE = RBDI_EST_TEN * RBDI_EST_TEN_ROW           /* and of the payload */
};

/* A dof is left out, has no friction, or has. */
enum { RBDI_EST_LEFT_OUT, RBDI_EST_PLAIN, RBDI_EST_RUBS };

struct rbd_observer {
    uint64_t shape[RBDI_SHAPE]; /* of the model */
    rbd_observer_options options;
    int begun;
    rbd_real *p, *rate, *r, *band; /* nv: M v, C'v - g, what is felt, its band */
    rbd_real *side;                /* nv: -1, 0, 1: the way a dof moves, 0 at rest */
    rbd_real *p_next, *rate_next, *gravity, *r_next, *band_next; /* nv: of a step */
};

struct rbd_estimate {
    uint64_t shape[RBDI_SHAPE]; /* of the model */
    int nv, body;
    int known;           /* the payload is 0, and no unknown */
    rbd_real slow, kept; /* root of the forgetting */
    rbd_real scale[3];   /* units of m, m c and S: the unknowns are shares of these, the prior's deviations */
    rbd_real stiff;      /* 1 / deviation of the prior of friction */
    rbd_real squares, samples; /* of what is left of the rows, and how many */
    rbd_real P[RBDI_EST_TEN];
    rbd_real load[RBDI_EST_LOAD_TRIANGLE];
    unsigned char *kind; /* nv */
    rbd_real *certain;   /* nv: 1 / noise */
    rbd_real *joint;     /* nv x RBDI_EST_JOINT_TRIANGLE */
    rbd_real *row;       /* nv x RBDI_EST_WHOLE_ROW: of a sample */
    rbd_real *y;         /* nv x 10: regressor */
    rbd_real *left;      /* nv */
};

/* Bytes for nv dofs. */
#define RBDI_EST_OBSERVER_BYTES(nv) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_observer)) + RBDI_ROUND(10 * (size_t)(nv) * sizeof(rbd_real)))
#define RBDI_EST_BYTES(nv) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_estimate)) + RBDI_ROUND((size_t)(nv)) + \
     RBDI_ROUND((size_t)(nv) * (RBDI_EST_JOINT_TRIANGLE + RBDI_EST_WHOLE_ROW + RBDI_EST_TEN + 2) * \
                sizeof(rbd_real)))

/* Bytes that suffice for any model of nv degrees of freedom; constants. */
#define RBD_OBSERVER_SIZE(nv) RBDI_EST_OBSERVER_BYTES(nv)
#define RBD_ESTIMATE_SIZE(nv) RBDI_EST_BYTES(nv)

#endif
