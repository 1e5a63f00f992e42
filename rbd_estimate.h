/* rbd_estimate.h - what a robot learns about itself: external torques, friction and payload, on rbd.h.
   Made by src/amalgamate.py from src/rbd_estimate.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   A momentum observer feels what pushes a robot, from motors and encoders alone. A recursive estimate finds
   the friction of each joint and the payload of the hand, one sample a tick, as a body that can exist at each
   tick. For all joint types, floating bases and mimic joints; each call takes constant time. Implemented by
   the same RBD_IMPLEMENTATION as rbd.h, in the same file. An alarm of an arm of 7 joints:

       #define RBD_IMPLEMENTATION
       #include "rbd_estimate.h"

       const rbd_observer_options options = {.gain = 40, .share = 0.2, .least = 0.5, .friction = friction};
       static unsigned char memory[RBD_OBSERVER_SIZE(7)];
       rbd_observer *observer;
       rbd_observer_init(m, &options, memory, sizeof memory, &observer, NULL);
       // each tick:
       rbd_observer_step(m, w, observer, q, v, tau, dt, r, band, NULL);
       for (int i = 0; i < 7; i++) if (fabs(r[i]) > band[i]) stop();

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [friction] [observer] [estimate]
     --- stop here if you only use it ---
     [method] [triangles] [estimate checks] [observer code] [pseudo-inertia] [samples] [newton]
     [friction code] [estimate code] [estimate text]

   [conventions] Those of rbd.h. Friction acts against the motor: tau = rbd_rnea + friction. In floating
     joints there is none.

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it: it branches on its data.

   [guarantees]
     Input that is refused changes nothing. Finite input gives finite output, or an error. A payload is always
     physical: mass above 0 and a positive definite pseudo-inertia; Coulomb and viscous friction are 0 or
     more. The bits are the same on every machine with RBD_REPRODUCIBLE.

   [limits]
     At rest friction hides every torque below it from the observer, and all samples from the estimate. The
     payload shows only in motions that excite it: rbd_estimate_deviations says how well. Friction is Coulomb,
     viscous and an offset. One payload, of one body. Errors of the model itself go to both. A change of the
     payload that nobody tells is forgotten with the samples; rbd_estimate_grip is quicker.
     Where samples tell little of the payload, as of an empty hand, rbd_estimate_solve takes some twenty times
     as long as else, and fifty at most; call rbd_estimate_release for an empty hand.
*/
#include "rbd_derivatives.h"

#ifndef RBD_ESTIMATE_H
#define RBD_ESTIMATE_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_estimate.h is of another version than rbd.h"
#endif

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_estimate.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/estimate.h ==== */
#define rbd_estimate_text RBDI_SYMBOL(rbd_estimate_text)
#define rbd_observer_init RBDI_SYMBOL(rbd_observer_init)
#define rbd_observer_size RBDI_SYMBOL(rbd_observer_size)
#define rbd_observer_reset RBDI_SYMBOL(rbd_observer_reset)
#define rbd_observer_step RBDI_SYMBOL(rbd_observer_step)
#define rbd_estimate_init RBDI_SYMBOL(rbd_estimate_init)
#define rbd_estimate_size RBDI_SYMBOL(rbd_estimate_size)
#define rbd_estimate_add RBDI_SYMBOL(rbd_estimate_add)
#define rbd_estimate_solve RBDI_SYMBOL(rbd_estimate_solve)
#define rbd_estimate_deviations RBDI_SYMBOL(rbd_estimate_deviations)
#define rbd_estimate_grip RBDI_SYMBOL(rbd_estimate_grip)
#define rbd_estimate_release RBDI_SYMBOL(rbd_estimate_release)

/* ---- friction and bad input [friction] ---- */

/* Friction of a degree of freedom that moves at v: offset + coulomb sign(v) + viscous v, against the motor.
   At rest the dry part is anything between -coulomb and coulomb. */
typedef struct rbd_joint_friction {
    rbd_real coulomb; /* N m or N, 0 or more */
    rbd_real viscous; /* N m s/rad or N s/m, 0 or more */
    rbd_real offset;  /* N m or N: of a sensor, say */
} rbd_joint_friction;

/* Which input was refused. */
typedef struct rbd_estimate_fault {
    const char *field; /* the argument, or the field of a struct; NULL: none */
    int at;            /* index in it, as of a dof; -1: it is a single number */
} rbd_estimate_fault;

/* Writes a status and its fault as a sentence, e.g. "tau[3]: not finite", cut to fit, always terminated.
   fault: may be NULL. text: size bytes. Returns text. */
RBDI_API char *rbd_estimate_text(rbd_status status, const rbd_estimate_fault *fault, char *text, size_t size);

/* ---- external torque [observer] ---- */

typedef struct rbd_observer rbd_observer; /* see rbd_observer_init */

typedef struct rbd_observer_options {
    rbd_real gain;  /* 1/s, above 0: the felt torque follows with a time constant of 1 / gain */
    rbd_real slow;  /* rad/s or m/s: a slower dof counts as at rest; 0: 0.02 */
    rbd_real share; /* of the friction below that may be wrong, 0 to 1 */
    rbd_real least; /* N m: of the band, for what the model and the sensors lack */
    const rbd_joint_friction *friction; /* nv, or NULL: none. It must stay, and may change between steps */
} rbd_observer_options;

/* Prepares an observer of the torques that act on the joints beside the motors.
   memory    size bytes of any alignment; RBD_OBSERVER_SIZE(nv)
   observer  receives the structure, which lies inside memory; NULL after an error
   fault     may be NULL
   Errors: RBD_ERR_NULL, _MEMORY; _RANGE, an option that `fault` names. */
RBDI_API rbd_status rbd_observer_init(const rbd_model *m, const rbd_observer_options *options, void *memory,
                                      size_t size, rbd_observer **observer, rbd_estimate_fault *fault);

/* Bytes that rbd_observer_init needs for this model. */
RBDI_API size_t rbd_observer_size(const rbd_model *m);

/* Forgets the past: the next step begins anew, with a felt torque of 0. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_observer_reset(rbd_observer *observer);

/* One tick: the torque r that acts on each joint beside the motor and the friction, such as J' f of a push.
   r follows it as a filter of first order, r += gain dt (torque - r) / (1 + gain dt), stable for each gain
   and dt. The first step after init or reset takes the state alone, and r is 0.
   w       a work of the model
   q, v    nq, nv: the state at the end of the tick
   tau     nv: of the motors, constant in the tick. Of a floating base 0, or J' f of the known contacts
   dt      s, above 0: since the last step
   r       nv: the felt torque, N m; or NULL
   band    nv: how much of r may be friction: an alarm is |r| > band; or NULL. It follows, as r does,

               share (coulomb + viscous |v|) + coulomb of a dof at rest + least,

           so that r is off by no more, if friction is known to that share. A dof that turns back counts as
           at rest
   fault   may be NULL
   De Luca and Mattone (2005), with an implicit step. Errors, after which the observer and its results are as
   they were: RBD_ERR_NULL; _WORK; _NAN, an entry of q, v or tau, or all of it overflows; _RANGE, dt or
   friction. */
RBDI_API rbd_status rbd_observer_step(const rbd_model *m, rbd_work *w, rbd_observer *observer,
                                      const rbd_real *q, const rbd_real *v, const rbd_real *tau, rbd_real dt,
                                      rbd_real *r, rbd_real *band, rbd_estimate_fault *fault);

/* ---- friction and payload [estimate] ---- */

typedef struct rbd_estimate rbd_estimate; /* see rbd_estimate_init */

/* 0 is the default in brackets. */
typedef struct rbd_estimate_options {
    rbd_real mass;         /* kg: as heavy as a payload may be [5] */
    rbd_real reach;        /* m: as far as it may be from the body's origin [0.2] */
    rbd_real friction;     /* N m, N m s/rad: as large as friction and offset may be [100] */
    rbd_real forgetting;   /* what a sample leaves of the weight of those before, 0.5 to 1 [0.998] */
    rbd_real slow;         /* rad/s or m/s: a slower dof counts as at rest, and tells nothing [0.03] */
    const rbd_real *noise; /* nv, N m, above 0: standard deviations of tau; NULL: 0.1 of each dof */
    const unsigned char *left_out; /* nv flags: not 0 where tau is not known, as of a base on unknown
                                      contacts; NULL: none */
} rbd_estimate_options;

/* Prepares a recursive estimate of the friction of each degree of freedom, but those of floating joints, and
   of the payload of a body.
   body     that carries the payload, as the hand does; -1: friction alone
   options  NULL: all defaults. Its arrays need not stay
   memory   size bytes of any alignment; RBD_ESTIMATE_SIZE(nv)
   e        receives the structure, which lies inside memory; NULL after an error
   fault    may be NULL
   Errors: RBD_ERR_NULL, _MEMORY; _INDEX, a body; _RANGE, an option that `fault` names. */
RBDI_API rbd_status rbd_estimate_init(const rbd_model *m, int body, const rbd_estimate_options *options,
                                      void *memory, size_t size, rbd_estimate **e, rbd_estimate_fault *fault);

/* Bytes that rbd_estimate_init needs for this model. */
RBDI_API size_t rbd_estimate_size(const rbd_model *m);

/* Takes in one sample: tau = rbd_rnea(q, v, a) + friction + torque of the payload. A dof at rest tells
   nothing, since friction hides what holds it. A joint's friction is forgotten only while the joint moves.
   d           memory of rbd_derivatives_init, of the model without the payload
   q, v, a     nq, nv, nv: measured. Noise in a biases the estimate: filter all of them alike
   tau         nv: of the motors, and of a floating base what holds it
   fault       may be NULL
   Errors, after which the estimate is as it was: RBD_ERR_NULL; _WORK; _NAN, an entry of q, v, a or tau;
   _RANGE, numbers too large to compute with. */
RBDI_API rbd_status rbd_estimate_add(const rbd_model *m, rbd_derivatives *d, rbd_estimate *e,
                                     const rbd_real *q, const rbd_real *v, const rbd_real *a,
                                     const rbd_real *tau, rbd_estimate_fault *fault);

/* The estimate from all samples so far. A body can always be like that (Wensing, Kim and Slotine 2018).
   If samples tell little of the payload, some 15 rounds, 50 at most, find the nearest
   such body.
   payload   10: parameters as those of rbd_set_parameters, link axes; 0 after rbd_estimate_release; or NULL
   friction  nv; or NULL
   misfit    what the estimate leaves of the samples, over their `noise`: near 1 if the model and the noise
             are right; 0 before there are enough samples; or NULL
   Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_estimate_solve(rbd_estimate *e, rbd_const payload[10], rbd_joint_friction *friction,
                                       rbd_real *misfit);

/* Standard deviations of what rbd_estimate_solve gives, from the noise of tau alone. What the samples do not
   tell has those of the options mass, reach and friction. Either array may be NULL. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_estimate_deviations(const rbd_estimate *e, rbd_const payload[10],
                                            rbd_joint_friction *friction);

/* The hand took something, or changed it: the payload is unknown from here on; friction stays known. Takes as
   long as rbd_estimate_solve. Errors: RBD_ERR_NULL; _INDEX, the estimate has no body. */
RBDI_API rbd_status rbd_estimate_grip(rbd_estimate *e);

/* The hand is empty: the payload is 0, and samples tell of friction alone. Errors: as rbd_estimate_grip. */
RBDI_API rbd_status rbd_estimate_release(rbd_estimate *e);

/* ==== src/rbd_estimate.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_ESTIMATE_H */

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
#pragma push_macro("F")
#undef F
#pragma push_macro("G")
#undef G
#pragma push_macro("L")
#undef L
#pragma push_macro("P")
#undef P
#pragma push_macro("Q")
#undef Q
#pragma push_macro("R")
#undef R
#pragma push_macro("S")
#undef S
#pragma push_macro("T")
#undef T
#pragma push_macro("X")
#undef X
#pragma push_macro("Y")
#undef Y
#pragma push_macro("Z")
#undef Z

/* ==== src/rbd_estimate.h ==== */
#ifndef RBDI_ESTIMATE_LAYOUT
#define RBDI_ESTIMATE_LAYOUT

/* ==== src/estimate/layout.h ==== */
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

/* ==== src/rbd_estimate.h ==== */
#endif /* RBDI_ESTIMATE_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_ESTIMATE_IMPLEMENTED
#define RBDI_ESTIMATE_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/estimate/triangles.h ==== */
/* ---- triangles [triangles] ----
   Upper triangles of least squares, full rows of n entries: row k is 0 before entry k. */

/* Turns row x into the first `rows` rows of R. x keeps what they do not take. */
RBDI_PART void rbdi_est_absorb(rbd_real *R, int rows, int n, rbd_real *x) {
    for (int k = 0; k < rows; ++k, R += n) {
        const rbd_real square = R[k] * R[k] + x[k] * x[k];
        rbd_real size, c, s;
        if (!(square > RBDI_TINY)) continue;

        /* (R_k, x_k) becomes (size, 0) */
        size = rbdi_sqrt(square);
        c = R[k] / size;
        s = x[k] / size;
        R[k] = size;
        x[k] = rbdi_zero();

        for (int j = k + 1; j < n; ++j) {
            const rbd_real kept = R[j];
            R[j] = c * kept + s * x[j];
            x[j] = c * x[j] - s * kept;
        }
    }
}

/* Takes in factor x_k = value. x: n scalars of scratch. */
RBDI_PART void rbdi_est_absorb_one(rbd_real *R, int rows, int n, int k, rbd_real factor, rbd_real value,
                                   rbd_real *x) {
    for (int j = 0; j < n; ++j) x[j] = rbdi_zero();
    x[k] = factor;
    x[n - 1] = value;
    rbdi_est_absorb(R, rows, n, x);
}

/* x = R^-1 x of the first `rows` columns. */
RBDI_PART void rbdi_est_solve_upper(const rbd_real *R, int rows, int n, rbd_real *x) {
    for (int k = rows - 1; k >= 0; --k) {
        for (int j = k + 1; j < rows; ++j) x[k] = x[k] - R[k * n + j] * x[j];
        x[k] = x[k] / R[k * n + k];
    }
}

/* x = R'^-1 x. */
RBDI_PART void rbdi_est_solve_lower(const rbd_real *R, int rows, int n, rbd_real *x) {
    for (int k = 0; k < rows; ++k) {
        x[k] = x[k] / R[k * n + k];
        for (int j = k + 1; j < rows; ++j) x[j] = x[j] - R[k * n + j] * x[k];
    }
}

RBDI_PART rbd_real rbdi_est_sum_of_squares(const rbd_real *x, int n) {
    rbd_real sum = rbdi_zero();
    for (int k = 0; k < n; ++k) sum = sum + x[k] * x[k];
    return sum;
}

RBDI_PART void rbdi_est_scale_all(rbd_real *x, int n, rbd_real factor) {
    for (int k = 0; k < n; ++k) x[k] = x[k] * factor;
}

/* ==== src/estimate/check.h ==== */
/* ---- estimate checks [estimate checks] ---- */

/* Notes what was refused, unless nobody asks; returns the error. */
RBDI_PART rbd_status rbdi_est_fault(rbd_estimate_fault *fault, rbd_status error, const char *field, int at) {
    if (fault) {
        fault->field = field;
        fault->at = at;
    }
    return error;
}

/* Whether low <= x <= high; not of NaN. */
RBDI_INLINE int rbdi_est_between(rbd_real x, rbd_const low, rbd_const high) { return x >= low && x <= high; }

/* Whether an array is finite. */
RBDI_PART rbd_status rbdi_est_check_finite(const rbd_real *x, int n, const char *name,
                                           rbd_estimate_fault *fault) {
    for (int i = 0; i < n; ++i)
        if (!rbdi_is_finite(x[i])) return rbdi_est_fault(fault, RBD_ERR_NAN, name, i);
    return RBD_OK;
}

/* Whether memory of a model with this shape fits the model. */
RBDI_PART rbd_status rbdi_est_check_shape(const rbd_model *m, const uint64_t shape[RBDI_SHAPE]) {
    return rbdi_has_shape(m, shape) ? RBD_OK : RBD_ERR_WORK;
}

RBDI_PART rbd_status rbdi_est_check_friction(const rbd_joint_friction *f, int n, rbd_estimate_fault *fault) {
    if (!f) return RBD_OK;

    for (int i = 0; i < n; ++i, ++f) {
        if (!rbdi_est_between(f->coulomb, 0, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "coulomb", i);
        if (!rbdi_est_between(f->viscous, 0, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "viscous", i);
        if (!rbdi_est_between(f->offset, -RBDI_EST_LARGE, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "offset", i);
    }
    return RBD_OK;
}

RBDI_PART rbd_status rbdi_est_check_observer_options(const rbd_observer_options *o, int nv,
                                                     rbd_estimate_fault *fault) {
    if (!(o->gain > 0 && o->gain <= RBDI_EST_LARGE)) return rbdi_est_fault(fault, RBD_ERR_RANGE, "gain", -1);
    if (!rbdi_est_between(o->slow, 0, RBDI_EST_LARGE))
        return rbdi_est_fault(fault, RBD_ERR_RANGE, "slow", -1);
    if (!rbdi_est_between(o->share, 0, 1)) return rbdi_est_fault(fault, RBD_ERR_RANGE, "share", -1);
    if (!rbdi_est_between(o->least, 0, RBDI_EST_LARGE))
        return rbdi_est_fault(fault, RBD_ERR_RANGE, "least", -1);
    return rbdi_est_check_friction(o->friction, nv, fault);
}

/* An option is 0, or neither too little nor too large to divide by. */
RBDI_PART rbd_status rbdi_est_check_options(const rbd_estimate_options *o, int nv,
                                            rbd_estimate_fault *fault) {
    const rbd_real values[4] = {o->mass, o->reach, o->friction, o->slow};
    const char *const names[4] = {"mass", "reach", "friction", "slow"};
    const rbd_const little = RBD_C(1) / RBDI_EST_LARGE;

    for (int i = 0; i < 4; ++i)
        if (!rbdi_est_between(values[i], 0, RBDI_EST_LARGE) || (values[i] > 0 && values[i] < little))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, names[i], -1);
    if (!rbdi_est_between(o->forgetting, 0, 1) || (o->forgetting > 0 && o->forgetting < RBD_C(0.5)))
        return rbdi_est_fault(fault, RBD_ERR_RANGE, "forgetting", -1);

    if (!o->noise) return RBD_OK;
    for (int i = 0; i < nv; ++i)
        if (!rbdi_est_between(o->noise[i], little, RBDI_EST_LARGE))
            return rbdi_est_fault(fault, RBD_ERR_RANGE, "noise", i);
    return RBD_OK;
}

/* ==== src/estimate/observer.h ==== */
/* ---- observer [observer code] ---- */

RBDI_API size_t rbd_observer_size(const rbd_model *m) { return m ? RBDI_EST_OBSERVER_BYTES(m->nv) : 0; }

RBDI_API rbd_status rbd_observer_init(const rbd_model *m, const rbd_observer_options *options, void *memory,
                                      size_t size, rbd_observer **observer, rbd_estimate_fault *fault) {
    unsigned char *at = rbdi_aligned(memory);
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    rbd_observer *o;
    if (observer) *observer = NULL;
    if (!m || !options || !memory || !observer) return RBD_ERR_NULL;
    status = rbdi_est_check_observer_options(options, m->nv, fault);
    if (status) return status;
    if (size < rbd_observer_size(m)) return RBD_ERR_MEMORY;

    o = RBDI_CUT(rbd_observer, 1);
    for (int k = 0; k < RBDI_SHAPE; ++k) o->shape[k] = m->shape[k];
    o->options = *options;
    if (!(o->options.slow > 0)) o->options.slow = rbdi_set(RBDI_EST_OBSERVER_SLOW);

    o->p = (rbd_real *)at;
    o->rate = o->p + m->nv;
    o->r = o->rate + m->nv;
    o->band = o->r + m->nv;
    o->side = o->band + m->nv;
    o->p_next = o->side + m->nv;
    o->rate_next = o->p_next + m->nv;
    o->gravity = o->rate_next + m->nv;
    o->r_next = o->gravity + m->nv;
    o->band_next = o->r_next + m->nv;

    *observer = o;
    return rbd_observer_reset(o);
}

RBDI_API rbd_status rbd_observer_reset(rbd_observer *observer) {
    if (!observer) return RBD_ERR_NULL;
    observer->begun = 0;
    return RBD_OK;
}

/* -1 or 1, the way a dof moves, or 0 at rest. */
RBDI_INLINE rbd_real rbdi_est_way_of(rbd_real v, rbd_real slow) {
    return rbdi_set(v > slow ? RBD_C(1) : v < -slow ? RBD_C(-1) : RBD_C(0));
}

/* p and C'v - g of the state. */
RBDI_LOCAL rbd_status rbdi_est_observe_state(const rbd_model *m, rbd_work *w, rbd_observer *o,
                                             const rbd_real *q, const rbd_real *v) {
    rbd_status status = rbd_generalized_momentum(m, w, q, v, o->p_next, o->rate_next);
    if (!status) status = rbd_gravity_torque(m, w, q, o->gravity);
    for (int i = 0; i < m->nv && !status; ++i) o->rate_next[i] = o->rate_next[i] - o->gravity[i];
    return status;
}

/* The friction of dof i that is subtracted from the motor's torque, and the bound of what this lacks. */
RBDI_LOCAL rbd_real rbdi_est_observed_friction(const rbd_observer *o, int i, rbd_real v, rbd_real *bound) {
    const rbd_joint_friction *f = o->options.friction ? &o->options.friction[i] : NULL;
    const rbd_real side = rbdi_est_way_of(v, o->options.slow);
    const int moves = side * o->side[i] > 0;

    *bound = o->options.least;
    if (!f) return rbdi_zero();

    *bound = *bound + o->options.share * (f->coulomb + f->viscous * rbdi_abs(v));
    if (!moves) {
        *bound = *bound + f->coulomb;
        return f->offset + f->viscous * v;
    }
    return f->offset + f->viscous * v + side * f->coulomb;
}

/* r_next = (r + gain (p_next - p - dt x)) / (1 + gain dt), and the band by the same step. The first step has
   no past: both are 0. */
RBDI_LOCAL void rbdi_est_observe(rbd_observer *o, int nv, const rbd_real *v, const rbd_real *tau,
                                 rbd_real dt) {
    const rbd_real gain = o->options.gain;
    const rbd_real all = 1 + gain * dt;

    for (int i = 0; i < nv; ++i) {
        rbd_real x, friction, bound;
        if (!o->begun) {
            o->r_next[i] = rbdi_zero();
            o->band_next[i] = rbdi_zero();
            continue;
        }

        friction = rbdi_est_observed_friction(o, i, v[i], &bound);
        x = tau[i] - friction + (o->rate[i] + o->rate_next[i]) * RBD_C(0.5);
        o->r_next[i] = (o->r[i] + gain * (o->p_next[i] - o->p[i] - dt * x)) / all;
        o->band_next[i] = (o->band[i] + gain * dt * bound) / all;
    }
}

/* Whether nothing overflowed. */
RBDI_LOCAL rbd_status rbdi_est_check_observed(const rbd_observer *o, int nv, rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_check_finite(o->p_next, nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(o->rate_next, nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(o->r_next, nv, "r", fault);
    return status ? status : rbdi_est_check_finite(o->band_next, nv, "band", fault);
}

/* Nothing was refused: the next state becomes the last. */
RBDI_LOCAL void rbdi_est_observer_commit(rbd_observer *o, int nv, const rbd_real *v) {
    for (int i = 0; i < nv; ++i) {
        o->r[i] = o->r_next[i];
        o->band[i] = o->band_next[i];
        o->p[i] = o->p_next[i];
        o->rate[i] = o->rate_next[i];
        o->side[i] = rbdi_est_way_of(v[i], o->options.slow);
    }
    o->begun = 1;
}

RBDI_LOCAL rbd_status rbdi_est_check_observer_step(const rbd_model *m, const rbd_work *w,
                                                   const rbd_observer *o, const rbd_real *q,
                                                   const rbd_real *v, const rbd_real *tau, rbd_real dt,
                                                   rbd_estimate_fault *fault) {
    rbd_status status = rbdi_check(m, w, o && q && v && tau);
    if (!status) status = rbdi_est_check_shape(m, o->shape);
    if (!status && !(dt > 0 && dt <= RBDI_EST_LARGE)) status = rbdi_est_fault(fault, RBD_ERR_RANGE, "dt", -1);
    if (!status) status = rbdi_est_check_finite(q, m->nq, "q", fault);
    if (!status) status = rbdi_est_check_finite(v, m->nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(tau, m->nv, "tau", fault);
    return status ? status : rbdi_est_check_friction(o->options.friction, m->nv, fault);
}

RBDI_API rbd_status rbd_observer_step(const rbd_model *m, rbd_work *w, rbd_observer *o, const rbd_real *q,
                                      const rbd_real *v, const rbd_real *tau, rbd_real dt, rbd_real *r,
                                      rbd_real *band, rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    status = rbdi_est_check_observer_step(m, w, o, q, v, tau, dt, fault);
    if (!status) status = rbdi_est_observe_state(m, w, o, q, v);
    if (status) return status;

    rbdi_est_observe(o, m->nv, v, tau, dt);
    status = rbdi_est_check_observed(o, m->nv, fault);
    if (status) return status;

    rbdi_est_observer_commit(o, m->nv, v);
    if (r)
        for (int i = 0; i < m->nv; ++i) r[i] = o->r[i];
    if (band)
        for (int i = 0; i < m->nv; ++i) band[i] = o->band[i];
    return RBD_OK;
}

/* ==== src/estimate/pseudo_inertia.h ==== */
/* ---- pseudo-inertia [pseudo-inertia] ----
   P is packed by rows of the lower triangle: S_xx, S_xy, S_yy, S_xz, S_yz, S_zz, h_x, h_y, h_z, m. */

/* The index of entry (i, j), j <= i. */
RBDI_INLINE int rbdi_est_packed_at(int i, int j) { return i * (i + 1) / 2 + j; }

/* Entry (i, j) of a lower triangle, 0 above the diagonal; and of a symmetric matrix. */
RBDI_INLINE rbd_real rbdi_est_lower(const rbd_real A[RBDI_EST_TEN], int i, int j) {
    return j <= i ? A[rbdi_est_packed_at(i, j)] : rbdi_zero();
}

RBDI_INLINE rbd_real rbdi_est_symmetric(const rbd_real A[RBDI_EST_TEN], int i, int j) {
    return A[j <= i ? rbdi_est_packed_at(i, j) : rbdi_est_packed_at(j, i)];
}

/* P = L L'. Returns whether every pivot is above its rounding. */
RBDI_PART int rbdi_est_factor_pseudo(const rbd_real P[RBDI_EST_TEN], rbd_real L[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) {
            rbd_real x = P[rbdi_est_packed_at(i, j)];
            for (int k = 0; k < j; ++k) x = x - L[rbdi_est_packed_at(i, k)] * L[rbdi_est_packed_at(j, k)];

            if (j < i) {
                L[rbdi_est_packed_at(i, j)] = x / L[rbdi_est_packed_at(j, j)];
                continue;
            }
            if (!(x > RBDI_EST_FLOOR && x > RBDI_EST_RIM * P[rbdi_est_packed_at(i, i)])) return 0;
            L[rbdi_est_packed_at(i, i)] = rbdi_sqrt(x);
        }
    return 1;
}

/* G = L^-1. */
RBDI_PART void rbdi_est_invert_lower(const rbd_real L[RBDI_EST_TEN], rbd_real G[RBDI_EST_TEN]) {
    for (int j = 0; j < 4; ++j) {
        G[rbdi_est_packed_at(j, j)] = 1 / L[rbdi_est_packed_at(j, j)];
        for (int i = j + 1; i < 4; ++i) {
            rbd_real x = rbdi_zero();
            for (int k = j; k < i; ++k) x = x - L[rbdi_est_packed_at(i, k)] * G[rbdi_est_packed_at(k, j)];
            G[rbdi_est_packed_at(i, j)] = x / L[rbdi_est_packed_at(i, i)];
        }
    }
}

/* G'G, which is P^-1. */
RBDI_PART void rbdi_est_square(const rbd_real G[RBDI_EST_TEN], rbd_real inverse[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) {
            rbd_real sum = rbdi_zero();
            for (int k = i; k < 4; ++k) sum = sum + G[rbdi_est_packed_at(k, i)] * G[rbdi_est_packed_at(k, j)];
            inverse[rbdi_est_packed_at(i, j)] = sum;
        }
}

/* The ten parameters, from a pseudo-inertia in units: I = tr(S) 1 - S. */
RBDI_PART void rbdi_est_parameters_of(const rbd_real P[RBDI_EST_TEN], const rbd_real scale[3],
                                      rbd_const pi[10]) {
    const rbd_real S = scale[2];

    pi[0] = (rbd_const)(scale[0] * P[9]);
    pi[1] = (rbd_const)(scale[1] * P[6]);
    pi[2] = (rbd_const)(scale[1] * P[7]);
    pi[3] = (rbd_const)(scale[1] * P[8]);
    pi[4] = (rbd_const)(S * (P[2] + P[5]));
    pi[5] = (rbd_const)(-S * P[1]);
    pi[6] = (rbd_const)(-S * P[3]);
    pi[7] = (rbd_const)(S * (P[0] + P[5]));
    pi[8] = (rbd_const)(-S * P[4]);
    pi[9] = (rbd_const)(S * (P[0] + P[2]));
}

/* The factors of the entries of P, from those of the ten parameters: the transpose of the above. */
RBDI_PART void rbdi_est_pseudo_factors(const rbd_real y[10], const rbd_real scale[3],
                                       rbd_real x[RBDI_EST_TEN]) {
    const rbd_real S = scale[2];

    x[0] = S * (y[7] + y[9]);
    x[1] = -S * y[5];
    x[2] = S * (y[4] + y[9]);
    x[3] = -S * y[6];
    x[4] = -S * y[8];
    x[5] = S * (y[4] + y[7]);
    x[6] = scale[1] * y[1];
    x[7] = scale[1] * y[2];
    x[8] = scale[1] * y[3];
    x[9] = scale[0] * y[0];
}

/* Where the estimate begins. */
RBDI_PART void rbdi_est_begin_ball(rbd_real P[RBDI_EST_TEN]) {
    const rbd_const mass = RBDI_EST_BALL;
    const rbd_const second = mass * mass * mass;

    for (int k = 0; k < RBDI_EST_TEN; ++k) P[k] = rbdi_zero();
    for (int i = 0; i < 3; ++i) P[rbdi_est_packed_at(i, i)] = rbdi_set(second);
    P[rbdi_est_packed_at(3, 3)] = rbdi_set(mass);
}

/* ==== src/estimate/samples.h ==== */
/* ---- samples [samples] ---- */

/* Whether dof i tells something: it is measured, and moves if it has friction. */
RBDI_INLINE int rbdi_est_tells(const rbd_estimate *e, int i, rbd_real v) {
    return e->kind[i] == RBDI_EST_PLAIN || (e->kind[i] == RBDI_EST_RUBS && rbdi_abs(v) > e->slow);
}

/* The row of dof i, over its noise. */
RBDI_LOCAL void rbdi_est_sample_row(const rbd_estimate *e, int i, rbd_real v, rbd_real *x) {
    const rbd_real certain = e->certain[i];
    const int rubs = e->kind[i] == RBDI_EST_RUBS;

    x[0] = rbdi_set(rubs ? RBD_C(1) : RBD_C(0));
    x[1] = rbdi_set(!rubs ? RBD_C(0) : v > 0 ? RBD_C(1) : RBD_C(-1));
    x[2] = rubs ? v : rbdi_zero();
    rbdi_est_pseudo_factors(e->y + 10 * i, e->scale, x + RBDI_EST_FRICTIONS);
    x[RBDI_EST_WHOLE_ROW - 1] = e->left[i];
    rbdi_est_scale_all(x, RBDI_EST_WHOLE_ROW, certain);
}

/* The rows of all dofs that tell something; refuses what is too large. */
RBDI_LOCAL rbd_status rbdi_est_sample_rows(const rbd_estimate *e, const rbd_real *v,
                                           rbd_estimate_fault *fault) {
    for (int i = 0; i < e->nv; ++i) {
        rbd_real *x = e->row + i * RBDI_EST_WHOLE_ROW;
        if (!rbdi_est_tells(e, i, v[i])) continue;

        rbdi_est_sample_row(e, i, v[i], x);
        for (int k = 0; k < RBDI_EST_WHOLE_ROW; ++k)
            if (!rbdi_est_between(x[k], -RBDI_EST_LARGE, RBDI_EST_LARGE))
                return rbdi_est_fault(fault, RBD_ERR_RANGE, "tau", i);
    }
    return RBD_OK;
}

/* What the robot without payload and friction leaves of tau, and the regressor of the payload. */
RBDI_LOCAL rbd_status rbdi_est_sample(const rbd_model *m, rbd_derivatives *d, const rbd_estimate *e,
                                      const rbd_real *q, const rbd_real *v, const rbd_real *a,
                                      const rbd_real *tau) {
    const rbd_status status = rbd_rnea(m, d->work, q, v, a, NULL, e->left);
    if (status) return status;
    for (int i = 0; i < m->nv; ++i) e->left[i] = tau[i] - e->left[i];

    rbdi_clear(e->y, 10 * m->nv);
    if (e->known || m->frame[e->body].link < 0) return RBD_OK;
    rbdi_regressor_motion(m, d, q, v, a);
    rbdi_regress_body(m, d, &m->frame[e->body], e->y, 10);
    return RBD_OK;
}

/* Takes in the rows. What is known fades only where new rows come. */
RBDI_LOCAL void rbdi_est_take_rows(rbd_estimate *e, const rbd_real *v) {
    int rows = 0;
    for (int i = 0; i < e->nv; ++i) {
        rbd_real *x = e->row + i * RBDI_EST_WHOLE_ROW, *joint = e->joint + i * RBDI_EST_JOINT_TRIANGLE;
        if (!rbdi_est_tells(e, i, v[i])) continue;

        if (rows++ == 0) {
            rbdi_est_scale_all(e->load, RBDI_EST_LOAD_TRIANGLE, e->kept);
            e->squares = e->squares * e->kept * e->kept;
            e->samples = e->samples * e->kept * e->kept;
        }
        rbdi_est_scale_all(joint, RBDI_EST_JOINT_TRIANGLE, e->kept);

        rbdi_est_absorb(joint, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, x);
        rbdi_est_absorb(e->load, RBDI_EST_TEN, RBDI_EST_TEN_ROW, x + RBDI_EST_FRICTIONS);
        e->squares = e->squares + x[RBDI_EST_WHOLE_ROW - 1] * x[RBDI_EST_WHOLE_ROW - 1];
        e->samples = e->samples + 1;
    }
}

RBDI_LOCAL rbd_status rbdi_est_check_sample(const rbd_model *m, const rbd_derivatives *d,
                                            const rbd_estimate *e, const rbd_real *q, const rbd_real *v,
                                            const rbd_real *a, const rbd_real *tau,
                                            rbd_estimate_fault *fault) {
    rbd_status status = rbdi_check_derivatives(m, d, e && q && v && a && tau);
    if (!status) status = rbdi_est_check_shape(m, e->shape);
    if (!status) status = rbdi_est_check_finite(q, m->nq, "q", fault);
    if (!status) status = rbdi_est_check_finite(v, m->nv, "v", fault);
    if (!status) status = rbdi_est_check_finite(a, m->nv, "a", fault);
    return status ? status : rbdi_est_check_finite(tau, m->nv, "tau", fault);
}

RBDI_API rbd_status rbd_estimate_add(const rbd_model *m, rbd_derivatives *d, rbd_estimate *e,
                                     const rbd_real *q, const rbd_real *v, const rbd_real *a,
                                     const rbd_real *tau, rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    status = rbdi_est_check_sample(m, d, e, q, v, a, tau, fault);
    if (!status) status = rbdi_est_sample(m, d, e, q, v, a, tau);
    if (!status) status = rbdi_est_sample_rows(e, v, fault);
    if (!status) rbdi_est_take_rows(e, v);
    return status;
}

/* ==== src/estimate/newton.h ==== */
/* ---- newton [newton] ----
   The primal-dual method of interior points of Helmberg, Rendl, Vanderbei and Wolkowicz (1996). Beside P
   stands a multiplier Z, positive definite, which ends at weight P^-1. To second order, with P = L L',
   G = L^-1 and Z = Q Q', a step E of P minimises

       |R p - z|^2 / 2 + |p|^2 / 2 + |G E Q|^2 / 2 - weight tr(P^-1 E)   at p + E,
       while Z takes the step   weight P^-1 - Z - (P^-1 E Z + Z E P^-1) / 2,

   that is triangles again: the rows G E Q come to those of the samples. Where Z = weight P^-1 it is Newton's
   step; elsewhere it is better near the rim. */

/* An iterate. P is in the estimate. */
typedef struct rbdi_est_interior {
    rbd_real Z[RBDI_EST_TEN];
    rbd_real inverse[RBDI_EST_TEN];                                  /* of P */
    rbd_real all[RBDI_EST_LOAD_TRIANGLE], T[RBDI_EST_LOAD_TRIANGLE]; /* of samples and prior; of a round */
    rbd_real P_step[RBDI_EST_TEN], Z_step[RBDI_EST_TEN];
    rbd_real weight, share; /* share of the last step that was taken */
} rbdi_est_interior;

/* The payload's triangle with the prior in it, T p = z. */
RBDI_PART void rbdi_est_load_triangle(const rbd_estimate *e, rbd_real T[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real x[RBDI_EST_TEN_ROW];
    for (int k = 0; k < RBDI_EST_LOAD_TRIANGLE; ++k) T[k] = e->load[k];
    for (int k = 0; k < RBDI_EST_TEN; ++k)
        rbdi_est_absorb_one(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, k, rbdi_set(RBD_C(1)), rbdi_zero(), x);
}

/* Its right side at P: T E = z - T P for the step E. */
RBDI_LOCAL void rbdi_est_triangle_at(const rbd_real all[RBDI_EST_LOAD_TRIANGLE],
                                     const rbd_real P[RBDI_EST_TEN], rbd_real T[RBDI_EST_LOAD_TRIANGLE]) {
    for (int k = 0; k < RBDI_EST_LOAD_TRIANGLE; ++k) T[k] = all[k];
    for (int k = 0; k < RBDI_EST_TEN; ++k) {
        rbd_real *row = T + k * RBDI_EST_TEN_ROW;
        for (int j = k; j < RBDI_EST_TEN; ++j) row[RBDI_EST_TEN] = row[RBDI_EST_TEN] - row[j] * P[j];
    }
}

/* Takes the rows G E Q = 0 into T, by the entries of E; those below the diagonal stand for two. */
RBDI_LOCAL void rbdi_est_absorb_barrier(const rbd_real G[RBDI_EST_TEN], const rbd_real Q[RBDI_EST_TEN],
                                        rbd_real T[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real x[RBDI_EST_TEN_ROW];
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j <= i; ++j) {
                    rbd_real sum = rbdi_est_lower(G, a, i) * rbdi_est_lower(Q, j, b);
                    if (j < i) sum = sum + rbdi_est_lower(G, a, j) * rbdi_est_lower(Q, i, b);
                    x[rbdi_est_packed_at(i, j)] = sum;
                }

            x[RBDI_EST_TEN] = rbdi_zero();
            rbdi_est_absorb(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, x);
        }
}

/* The step E for C: T'T E = T'r + the gradient of tr(C E). */
RBDI_LOCAL void rbdi_est_step_of(const rbd_real T[RBDI_EST_LOAD_TRIANGLE], const rbd_real C[RBDI_EST_TEN],
                                 rbd_real E[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j)
            E[rbdi_est_packed_at(i, j)] = C[rbdi_est_packed_at(i, j)] * (j < i ? RBD_C(2) : RBD_C(1));

    rbdi_est_solve_lower(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, E);
    for (int k = 0; k < RBDI_EST_TEN; ++k) E[k] = E[k] + T[k * RBDI_EST_TEN_ROW + RBDI_EST_TEN];
    rbdi_est_solve_upper(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, E);
}

/* C -= (X + X') / 2, X = A E F, of symmetric matrices. */
RBDI_LOCAL void rbdi_est_subtract_mean(const rbd_real A[RBDI_EST_TEN], const rbd_real E[RBDI_EST_TEN],
                                       const rbd_real F[RBDI_EST_TEN], rbd_real C[RBDI_EST_TEN]) {
    rbd_real Y[4][4], X[4][4];
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            Y[i][j] = rbdi_zero();
            for (int k = 0; k < 4; ++k)
                Y[i][j] = Y[i][j] + rbdi_est_symmetric(E, i, k) * rbdi_est_symmetric(F, k, j);
        }
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            X[i][j] = rbdi_zero();
            for (int k = 0; k < 4; ++k) X[i][j] = X[i][j] + rbdi_est_symmetric(A, i, k) * Y[k][j];
        }

    for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) {
            const int at = rbdi_est_packed_at(i, j);
            C[at] = C[at] - (X[i][j] + X[j][i]) * RBD_C(0.5);
        }
}

/* x += step, or nearly as much of it as leaves it positive definite, by bisection. Returns the share. */
RBDI_LOCAL rbd_real rbdi_est_move_inside(rbd_real x[RBDI_EST_TEN], const rbd_real step[RBDI_EST_TEN]) {
    rbd_real inside = rbdi_zero(), outside = rbdi_set(RBD_C(2)), next[RBDI_EST_TEN], L[RBDI_EST_TEN];
    for (int cut = 0; cut <= RBDI_EST_CUTS && inside < 1; ++cut) {
        const rbd_real share = (inside + outside) * RBD_C(0.5);
        for (int k = 0; k < RBDI_EST_TEN; ++k) next[k] = x[k] + share * step[k];
        if (rbdi_est_factor_pseudo(next, L)) {
            inside = share;
        } else {
            outside = share;
        }
    }

    if (inside < 1) inside = inside * RBDI_EST_SHORT;
    for (int k = 0; k < RBDI_EST_TEN; ++k) x[k] = x[k] + inside * step[k];
    return inside;
}

/* tr(P Z) / 4. */
RBDI_LOCAL rbd_real rbdi_est_mean_product(const rbd_real P[RBDI_EST_TEN], const rbd_real Z[RBDI_EST_TEN]) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) sum = sum + rbdi_est_symmetric(P, i, j) * rbdi_est_symmetric(Z, i, j);
    return sum * RBD_C(0.25);
}

/* A share of tr(P Z) / 4: a tenth after full steps, nearly all of it after short ones. */
RBDI_LOCAL rbd_real rbdi_est_next_weight(const rbd_estimate *e, const rbdi_est_interior *s) {
    const rbd_real rest = 1 - s->share, least = rbdi_set(RBDI_EST_LESS);
    const rbd_real weight = (least + (1 - least) * rest * rest) * rbdi_est_mean_product(e->P, s->Z);
    return weight > RBDI_EST_LEAST ? weight : rbdi_set(RBDI_EST_LEAST);
}

/* Whether a step changes no entry of the diagonal much. */
RBDI_LOCAL int rbdi_est_is_small_step(const rbd_real P[RBDI_EST_TEN], const rbd_real step[RBDI_EST_TEN]) {
    for (int i = 0; i < 4; ++i) {
        const int at = rbdi_est_packed_at(i, i);
        if (rbdi_abs(step[at]) > RBDI_EST_SMALL * P[at]) return 0;
    }
    return 1;
}

/* One round. Returns whether it was the last: a small step at the least weight, or rounding has brought Z to
   the rim. */
RBDI_LOCAL int rbdi_est_round(rbd_estimate *e, rbdi_est_interior *s) {
    rbd_real L[RBDI_EST_TEN], G[RBDI_EST_TEN], Q[RBDI_EST_TEN], C[RBDI_EST_TEN], P_share, Z_share;
    if (!rbdi_est_factor_pseudo(e->P, L) || !rbdi_est_factor_pseudo(s->Z, Q)) return 1;

    rbdi_est_invert_lower(L, G);
    rbdi_est_square(G, s->inverse);
    rbdi_est_triangle_at(s->all, e->P, s->T);
    rbdi_est_absorb_barrier(G, Q, s->T);

    s->weight = rbdi_est_next_weight(e, s);
    for (int k = 0; k < RBDI_EST_TEN; ++k) C[k] = s->weight * s->inverse[k];
    rbdi_est_step_of(s->T, C, s->P_step);
    for (int k = 0; k < RBDI_EST_TEN; ++k) s->Z_step[k] = C[k] - s->Z[k];
    rbdi_est_subtract_mean(s->inverse, s->P_step, s->Z, s->Z_step);

    P_share = rbdi_est_move_inside(e->P, s->P_step);
    Z_share = rbdi_est_move_inside(s->Z, s->Z_step);
    s->share = P_share < Z_share ? P_share : Z_share;
    if (s->share < RBDI_EST_JAM) /* the products of P and Z differ too much: make them equal */
        for (int k = 0; k < RBDI_EST_TEN; ++k) s->Z[k] = s->weight * s->inverse[k];
    return !(s->weight > RBDI_EST_LEAST) && rbdi_est_is_small_step(e->P, s->P_step);
}

/* Z = weight P^-1 at the ball. The weight is on the way from the least to one that counts as much as the
   samples. */
RBDI_LOCAL void rbdi_est_begin_interior(rbd_estimate *e, rbdi_est_interior *s) {
    rbd_real weight = rbdi_set(RBD_C(1));
    for (int k = 0; k < RBDI_EST_TEN; ++k) {
        const rbd_real pivot = e->load[k * (RBDI_EST_TEN_ROW + 1)];
        weight = weight + pivot;
    }

    s->share = rbdi_zero();
    rbdi_est_begin_ball(e->P);
    rbdi_clear(s->Z, RBDI_EST_TEN);
    for (int i = 0; i < 4; ++i) s->Z[rbdi_est_packed_at(i, i)] = weight / e->P[rbdi_est_packed_at(i, i)];
}

/* The optimum without a barrier. Returns whether it is a body. */
RBDI_LOCAL int rbdi_est_find_free_load(rbd_estimate *e, const rbd_real all[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real P[RBDI_EST_TEN], L[RBDI_EST_TEN];
    for (int k = 0; k < RBDI_EST_TEN; ++k) P[k] = all[k * RBDI_EST_TEN_ROW + RBDI_EST_TEN];
    rbdi_est_solve_upper(all, RBDI_EST_TEN, RBDI_EST_TEN_ROW, P);
    if (!rbdi_est_factor_pseudo(P, L)) return 0;

    for (int k = 0; k < RBDI_EST_TEN; ++k) e->P[k] = P[k];
    return 1;
}

/* The optimum: without a barrier, if that is a body; else inside. */
RBDI_PART void rbdi_est_find_load(rbd_estimate *e) {
    rbdi_est_interior s;
    rbdi_est_load_triangle(e, s.all);
    if (rbdi_est_find_free_load(e, s.all)) return;

    rbdi_est_begin_interior(e, &s);
    for (int k = 0; k < RBDI_EST_ROUNDS; ++k)
        if (rbdi_est_round(e, &s)) return;
}

/* ==== src/estimate/friction.h ==== */
/* ---- friction of a dof [friction code] ----
   The unknowns are offset, coulomb and viscous, in this order: so the last two rows of a triangle are those
   of coulomb and viscous with the offset eliminated. */

/* The triangle of a dof with the prior in it, T. */
RBDI_PART void rbdi_est_joint_triangle(const rbd_estimate *e, int i, rbd_real T[RBDI_EST_JOINT_TRIANGLE]) {
    rbd_real x[RBDI_EST_WHOLE_ROW];
    for (int k = 0; k < RBDI_EST_JOINT_TRIANGLE; ++k) T[k] = e->joint[i * RBDI_EST_JOINT_TRIANGLE + k];
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k)
        rbdi_est_absorb_one(T, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, k, e->stiff, rbdi_zero(), x);
}

/* The largest x >= 0 of a single unknown, ax = b in the sense of least squares with square = a'a, and the
   share of the right side that it explains. */
RBDI_INLINE rbd_real rbdi_est_one_unknown(rbd_real product, rbd_real square, rbd_real *explained) {
    *explained = product > 0 ? product * product / square : rbdi_zero();
    return product > 0 ? product / square : rbdi_zero();
}

/* Minimises |U (c, v) - (r, s)|^2 with c, v >= 0, U = [a b; 0 d], a, d > 0: free, or one of them is 0. */
RBDI_PART void rbdi_est_bounded_pair(rbd_real a, rbd_real b, rbd_real d, rbd_real r, rbd_real s, rbd_real *c,
                                     rbd_real *v) {
    rbd_real c_explains, v_explains, c_alone, v_alone;
    *v = s / d;
    *c = (r - b * *v) / a;
    if (*c >= 0 && *v >= 0) return;

    c_alone = rbdi_est_one_unknown(a * r, a * a, &c_explains);
    v_alone = rbdi_est_one_unknown(b * r + d * s, b * b + d * d, &v_explains);
    *c = c_explains >= v_explains ? c_alone : rbdi_zero();
    *v = c_explains >= v_explains ? rbdi_zero() : v_alone;
}

/* The friction of dof i for the payload as it is. */
RBDI_PART void rbdi_est_solve_friction(const rbd_estimate *e, int i, rbd_joint_friction *f) {
    rbd_real T[RBDI_EST_JOINT_TRIANGLE], z[RBDI_EST_FRICTIONS];
    rbdi_est_joint_triangle(e, i, T);

    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        const rbd_real *row = T + k * RBDI_EST_WHOLE_ROW;
        z[k] = row[RBDI_EST_WHOLE_ROW - 1];
        for (int j = 0; j < RBDI_EST_TEN && !e->known; ++j)
            z[k] = z[k] - row[RBDI_EST_FRICTIONS + j] * e->P[j];
    }

    rbdi_est_bounded_pair(T[RBDI_EST_WHOLE_ROW + 1], T[RBDI_EST_WHOLE_ROW + 2], T[2 * RBDI_EST_WHOLE_ROW + 2],
                          z[1], z[2], &f->coulomb, &f->viscous);
    f->offset = (z[0] - T[1] * f->coulomb - T[2] * f->viscous) / T[0];
}

/* The variance of u'F p, |load'^-1 F'u|^2, of a payload p with the triangle `load`. F: of a dof's triangle
   T. */
RBDI_PART rbd_real rbdi_est_load_variance(const rbd_real T[RBDI_EST_JOINT_TRIANGLE],
                                          const rbd_real load[RBDI_EST_LOAD_TRIANGLE],
                                          const rbd_real u[RBDI_EST_FRICTIONS]) {
    rbd_real x[RBDI_EST_TEN];
    for (int j = 0; j < RBDI_EST_TEN; ++j) {
        x[j] = rbdi_zero();
        for (int r = 0; r < RBDI_EST_FRICTIONS; ++r)
            x[j] = x[j] + T[r * RBDI_EST_WHOLE_ROW + RBDI_EST_FRICTIONS + j] * u[r];
    }

    rbdi_est_solve_lower(load, RBDI_EST_TEN, RBDI_EST_TEN_ROW, x);
    return rbdi_est_sum_of_squares(x, RBDI_EST_TEN);
}

/* Standard deviations: T f = z - F p, with p's triangle `load`, which nothing reads of a known payload. Of
   unknown k with u = T'^-1 e_k the variance is u'u and that of u'F p. */
RBDI_PART void rbdi_est_friction_deviations(const rbd_estimate *e, int i,
                                            const rbd_real load[RBDI_EST_LOAD_TRIANGLE],
                                            rbd_real deviation[RBDI_EST_FRICTIONS]) {
    rbd_real T[RBDI_EST_JOINT_TRIANGLE];
    rbdi_est_joint_triangle(e, i, T);

    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        rbd_real u[RBDI_EST_FRICTIONS], variance;
        for (int j = 0; j < RBDI_EST_FRICTIONS; ++j) u[j] = rbdi_set(j == k ? RBD_C(1) : RBD_C(0));
        rbdi_est_solve_lower(T, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, u);

        variance = rbdi_est_sum_of_squares(u, RBDI_EST_FRICTIONS);
        if (!e->known) variance = variance + rbdi_est_load_variance(T, load, u);
        deviation[k] = rbdi_sqrt(variance);
    }
}

/* Replaces the rows R f = z - F p of dof i, where p is the estimate with the covariance of `load`, by rows of
   f alone: with B = 1 + F C F' = L L', L^-1 R f = L^-1 (z - F p). */
RBDI_PART void rbdi_est_forget_load_of(rbd_estimate *e, int i, const rbd_real load[RBDI_EST_LOAD_TRIANGLE]) {
    rbd_real *R = e->joint + i * RBDI_EST_JOINT_TRIANGLE, x[RBDI_EST_FRICTIONS][RBDI_EST_WHOLE_ROW],
             F[RBDI_EST_FRICTIONS][RBDI_EST_TEN], B[RBDI_EST_FRICTIONS * RBDI_EST_FRICTIONS];

    /* the rows, and F load^-1 */
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        for (int j = 0; j < RBDI_EST_WHOLE_ROW; ++j) x[k][j] = R[k * RBDI_EST_WHOLE_ROW + j];
        for (int j = 0; j < RBDI_EST_TEN; ++j) {
            F[k][j] = x[k][RBDI_EST_FRICTIONS + j];
            x[k][RBDI_EST_WHOLE_ROW - 1] = x[k][RBDI_EST_WHOLE_ROW - 1] - F[k][j] * e->P[j];
            x[k][RBDI_EST_FRICTIONS + j] = rbdi_zero();
        }
        rbdi_est_solve_lower(load, RBDI_EST_TEN, RBDI_EST_TEN_ROW, F[k]);
    }

    /* L' by turns: B is the sum of squares of 1 and of the columns of F */
    for (int k = 0; k < RBDI_EST_FRICTIONS * RBDI_EST_FRICTIONS; ++k)
        B[k] = rbdi_set(k % (RBDI_EST_FRICTIONS + 1) ? RBD_C(0) : RBD_C(1));
    for (int j = 0; j < RBDI_EST_TEN; ++j) {
        rbd_real column[RBDI_EST_FRICTIONS];
        for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) column[k] = F[k][j];
        rbdi_est_absorb(B, RBDI_EST_FRICTIONS, RBDI_EST_FRICTIONS, column);
    }

    /* x = L^-1 x, which is a triangle no more */
    rbdi_clear(R, RBDI_EST_JOINT_TRIANGLE);
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k) {
        for (int j = 0; j < RBDI_EST_WHOLE_ROW; ++j) {
            for (int r = 0; r < k; ++r) x[k][j] = x[k][j] - B[r * RBDI_EST_FRICTIONS + k] * x[r][j];
            x[k][j] = x[k][j] / B[k * RBDI_EST_FRICTIONS + k];
        }
    }
    for (int k = 0; k < RBDI_EST_FRICTIONS; ++k)
        rbdi_est_absorb(R, RBDI_EST_FRICTIONS, RBDI_EST_WHOLE_ROW, x[k]);
}

/* ==== src/estimate/estimate.h ==== */
/* ---- estimate [estimate code] ---- */

RBDI_API size_t rbd_estimate_size(const rbd_model *m) { return m ? RBDI_EST_BYTES(m->nv) : 0; }

/* Lays out the arrays in the memory. */
RBDI_LOCAL rbd_estimate *rbdi_est_lay_out(int nv, void *memory) {
    unsigned char *at = rbdi_aligned(memory);
    rbd_estimate *e = RBDI_CUT(rbd_estimate, 1);

    e->kind = RBDI_CUT(unsigned char, nv);
    e->certain = (rbd_real *)at;
    e->joint = e->certain + nv;
    e->row = e->joint + nv * RBDI_EST_JOINT_TRIANGLE;
    e->y = e->row + nv * RBDI_EST_WHOLE_ROW;
    e->left = e->y + nv * RBDI_EST_TEN;
    return e;
}

/* The option, or its default. */
RBDI_INLINE rbd_real rbdi_est_option(rbd_real given, rbd_const otherwise) {
    return given > 0 ? given : rbdi_set(otherwise);
}

RBDI_LOCAL void rbdi_est_take_options(rbd_estimate *e, const rbd_estimate_options *given) {
    const rbd_real none = rbdi_zero();
    const rbd_real reach = rbdi_est_option(given ? given->reach : none, RBDI_EST_REACH);

    e->scale[0] = rbdi_est_option(given ? given->mass : none, RBDI_EST_MASS);
    e->scale[1] = e->scale[0] * reach;
    e->scale[2] = e->scale[1] * reach;
    e->stiff = 1 / rbdi_est_option(given ? given->friction : none, RBDI_EST_FRICTION);
    e->kept = rbdi_sqrt(rbdi_est_option(given ? given->forgetting : none, RBDI_EST_FORGETTING));
    e->slow = rbdi_est_option(given ? given->slow : none, RBDI_EST_SLOW);

    for (int i = 0; i < e->nv; ++i)
        e->certain[i] = 1 / rbdi_est_option(given && given->noise ? given->noise[i] : none, RBDI_EST_NOISE);
}

/* Which dofs have friction, and which are left out. */
RBDI_LOCAL void rbdi_est_find_kinds(rbd_estimate *e, const rbd_model *m, const unsigned char *left_out) {
    for (int i = 0; i < m->nv; ++i) e->kind[i] = RBDI_EST_RUBS;
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        for (int k = 0; k < u->nv && u->type == RBD_FLOATING; ++k) e->kind[u->iv + k] = RBDI_EST_PLAIN;
    for (int i = 0; i < m->nv; ++i)
        if (left_out && left_out[i]) e->kind[i] = RBDI_EST_LEFT_OUT;
}

/* An unknown payload, of which no sample tells yet. */
RBDI_LOCAL void rbdi_est_begin_load(rbd_estimate *e) {
    rbdi_clear(e->load, RBDI_EST_LOAD_TRIANGLE);
    rbdi_est_begin_ball(e->P);
    e->squares = rbdi_zero();
    e->samples = rbdi_zero();
}

RBDI_API rbd_status rbd_estimate_init(const rbd_model *m, int body, const rbd_estimate_options *options,
                                      void *memory, size_t size, rbd_estimate **estimate,
                                      rbd_estimate_fault *fault) {
    rbd_status status = rbdi_est_fault(fault, RBD_OK, NULL, -1);
    rbd_estimate *e;
    if (estimate) *estimate = NULL;
    if (!m || !memory || !estimate) return RBD_ERR_NULL;
    if (body < -1 || body >= m->nb) return rbdi_est_fault(fault, RBD_ERR_INDEX, "body", -1);
    if (options) status = rbdi_est_check_options(options, m->nv, fault);
    if (status) return status;
    if (size < rbd_estimate_size(m)) return RBD_ERR_MEMORY;

    e = rbdi_est_lay_out(m->nv, memory);
    for (int k = 0; k < RBDI_SHAPE; ++k) e->shape[k] = m->shape[k];
    e->nv = m->nv;
    e->body = body;
    e->known = body < 0;

    rbdi_est_take_options(e, options);
    rbdi_est_find_kinds(e, m, options ? options->left_out : NULL);
    rbdi_clear(e->joint, m->nv * RBDI_EST_JOINT_TRIANGLE);
    rbdi_est_begin_load(e);
    *estimate = e;
    return RBD_OK;
}

RBDI_API rbd_status rbd_estimate_solve(rbd_estimate *e, rbd_const payload[10], rbd_joint_friction *friction,
                                       rbd_real *misfit) {
    if (!e) return RBD_ERR_NULL;
    if (!e->known) rbdi_est_find_load(e);

    if (payload) rbdi_est_parameters_of(e->P, e->scale, payload);
    for (int k = 0; k < RBDI_EST_TEN && payload && e->known; ++k) payload[k] = RBD_C(0);
    for (int i = 0; i < e->nv && friction; ++i) rbdi_est_solve_friction(e, i, &friction[i]);
    if (misfit) *misfit = e->samples > 0 ? rbdi_sqrt(e->squares / e->samples) : rbdi_zero();
    return RBD_OK;
}

/* The deviations of the parameters are those of sums of entries of P: of the sum c'p |T'^-1 c|. */
RBDI_LOCAL void rbdi_est_load_deviations(const rbd_estimate *e, const rbd_real T[RBDI_EST_LOAD_TRIANGLE],
                                         rbd_const pi[10]) {
    for (int k = 0; k < RBDI_EST_TEN; ++k) {
        rbd_real y[10], c[RBDI_EST_TEN];
        for (int j = 0; j < 10; ++j) y[j] = rbdi_set(j == k ? RBD_C(1) : RBD_C(0));
        rbdi_est_pseudo_factors(y, e->scale, c);
        rbdi_est_solve_lower(T, RBDI_EST_TEN, RBDI_EST_TEN_ROW, c);
        pi[k] = (rbd_const)rbdi_sqrt(rbdi_est_sum_of_squares(c, RBDI_EST_TEN));
    }
}

RBDI_API rbd_status rbd_estimate_deviations(const rbd_estimate *e, rbd_const payload[10],
                                            rbd_joint_friction *friction) {
    rbd_real T[RBDI_EST_LOAD_TRIANGLE], deviation[RBDI_EST_FRICTIONS];
    if (!e) return RBD_ERR_NULL;

    for (int k = 0; k < RBDI_EST_TEN && payload && e->known; ++k) payload[k] = RBD_C(0);
    if (!e->known) rbdi_est_load_triangle(e, T);
    if (!e->known && payload) rbdi_est_load_deviations(e, T, payload);

    for (int i = 0; i < e->nv && friction; ++i) {
        rbdi_est_friction_deviations(e, i, T, deviation);
        friction[i].offset = deviation[0];
        friction[i].coulomb = deviation[1];
        friction[i].viscous = deviation[2];
    }
    return RBD_OK;
}

/* Forgets the payload, not the friction, which is kept for the payload that the samples so far tell of. */
RBDI_LOCAL void rbdi_est_forget_load(rbd_estimate *e) {
    rbd_real T[RBDI_EST_LOAD_TRIANGLE];
    rbdi_est_find_load(e);
    rbdi_est_load_triangle(e, T);
    for (int i = 0; i < e->nv; ++i) rbdi_est_forget_load_of(e, i, T);
}

RBDI_LOCAL rbd_status rbdi_est_change_load(rbd_estimate *e, int known) {
    if (!e) return RBD_ERR_NULL;
    if (e->body < 0) return RBD_ERR_INDEX;

    if (!e->known) rbdi_est_forget_load(e);
    rbdi_est_begin_load(e);
    e->known = known;
    return RBD_OK;
}

RBDI_API rbd_status rbd_estimate_grip(rbd_estimate *e) { return rbdi_est_change_load(e, 0); }

RBDI_API rbd_status rbd_estimate_release(rbd_estimate *e) { return rbdi_est_change_load(e, 1); }

/* ==== src/estimate/text.h ==== */
/* ---- estimate text [estimate text] ---- */

/* The sentence of an error, where that of rbd_status_string speaks of a model. */
RBDI_MESSAGES RBDI_PART const char *rbdi_est_sentence(rbd_status status) {
    switch ((int)status) {
    case RBD_ERR_RANGE: return "out of range";
    case RBD_ERR_NAN: return "not finite";
    case RBD_ERR_MEMORY: return "the memory is too small";
    case RBD_ERR_WORK: return "the memory is of another model";
    default: return rbd_status_string(status);
    }
}

RBDI_API char *rbd_estimate_text(rbd_status status, const rbd_estimate_fault *fault, char *text,
                                 size_t size) {
    const int named = status != RBD_OK && fault && fault->field;
    const char *piece[8];
    char digits[12];
    int n = 0;
    if (!text || size == 0) return text;

    if (named) {
        piece[n++] = fault->field;
        if (fault->at >= 0) {
            piece[n++] = "[";
            piece[n++] = rbdi_decimal(fault->at, digits);
            piece[n++] = "]";
        }
        piece[n++] = ": ";
    }
    piece[n++] = rbdi_est_sentence(status);
    return rbdi_join(piece, n, text, size);
}

/* ==== src/rbd_estimate.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("B")
#pragma pop_macro("C")
#pragma pop_macro("E")
#pragma pop_macro("F")
#pragma pop_macro("G")
#pragma pop_macro("L")
#pragma pop_macro("P")
#pragma pop_macro("Q")
#pragma pop_macro("R")
#pragma pop_macro("S")
#pragma pop_macro("T")
#pragma pop_macro("X")
#pragma pop_macro("Y")
#pragma pop_macro("Z")
