/* rbd_ik.h - inverse kinematics: joint positions for a tool, feet or a centre of mass, on rbd.h.
   Made by src/amalgamate.py from src/rbd_ik.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Finds joint positions within the joints' limits for which points, poses and axes of bodies, and the centre
   of mass, are where they shall be; for all joint types, floating bases and mimic joints. Implemented by the
   same RBD_IMPLEMENTATION as rbd.h, in the same file. A tool, 0.1 m in front of the last link of an arm:

       #define RBD_IMPLEMENTATION
       #include "rbd_ik.h"

       const rbd_ik_target tool = {.kind = RBD_IK_POSE, .body = 6, .point = {0, 0, 0.1},
                                   .position = {0.5, 0.2, 0.4}, .rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1}};
       static unsigned char memory[RBD_IK_SIZE(7, 7, 1)];
       rbd_ik_result result;
       double q[7] = {0};   // where the robot is
       rbd_ik_status status = rbd_ik(m, w, &tool, 1, NULL, memory, sizeof memory, q, &result);
       if (status != RBD_IK_REACHED) puts(rbd_ik_text(status, &result, text, sizeof text));

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [targets] [inverse kinematics]
     --- stop here if you only use it ---
     [method] [step] [targets code] [curvature] [dofs] [search] [checks]
     [inverse kinematics code] [text code]

   [conventions] Those of rbd.h, beyond them:
     target       a point, rotation or axis of a body in the world; all rows of all targets count together
     limits       of joints with one dof, as rbd_joint has them. A mimic joint's limits bind what it follows,
                  but those that leave it nothing do not count
     angle        of a rotation: that of the shortest turn; of an axis: that to its direction

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it: the search branches on its
     data.

   [guarantees]
     Deterministic: starts come from a fixed sequence. RBD_IK_ERROR leaves q as it was. With any other status
     q is finite, and the joints that it moved are within their limits, to the bit; mimic joints to rounding.
     RBD_IK_REACHED says that the errors at q were computed and are within the tolerances. The bits are the
     same on every machine with RBD_REPRODUCIBLE.

   [limits]
     An evaluation costs kinematics, a Jacobian and the solution of a linear system; the option `evaluations`
     bounds their number. Poses in reach of an arm take 15 to 25 in the mean and some hundred at worst, as
     ./run fuzz --ik counts. That a target is out of reach is known after all starts and descents: a thousand.
     That no place is nearer is not proven, nor that a target that is not reached cannot be. A redundant arm
     may take any of its postures. Where limits are wide, starts are within a turn, or 10 times `length` of a
     slide, of the caller's q. No collisions. Robots need no masses, but for their centre of mass:
     rbd_model_build_kinematic builds one without.
*/
#include "rbd.h"

#ifndef RBD_IK_H
#define RBD_IK_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_ik.h is of another version than rbd.h"
#endif

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_ik.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/ik.h ==== */
#define rbd_ik RBDI_SYMBOL(rbd_ik)
#define rbd_ik_size RBDI_SYMBOL(rbd_ik_size)
#define rbd_ik_text RBDI_SYMBOL(rbd_ik_text)

/* ---- targets [targets] ---- */

typedef enum rbd_ik_kind {
    RBD_IK_POINT = 1, /* a point of the body at a place */
    RBD_IK_POSE,      /* the point at a place, and the body turned to a rotation */
    RBD_IK_ROTATION,  /* the body turned to a rotation */
    RBD_IK_AXIS,      /* an axis of the body along a direction; the turn about it is free */
    RBD_IK_COM        /* the centre of mass of the robot at a place */
} rbd_ik_kind;

/* One wish. Zero is a sensible default for every field that the kind needs not; a kind of 0 is an error, so
   that a forgotten target is not a wish. */
typedef struct rbd_ik_target {
    rbd_ik_kind kind;
    int body;              /* index in the description; a centre of mass has none */
    rbd_real point[3];     /* of the body, link axes, m: that of the tool, say; 0: the link's origin */
    rbd_real position[3];  /* where the point, or the centre of mass, shall be, world, m */
    rbd_real rotation[9];  /* 3 x 3, from link axes to world axes, as of rbd_body_pose; all 0 = identity */
    rbd_real axis[3];      /* of the body, link axes, of a length of 1e-9 to 1e9 */
    rbd_real direction[3]; /* where the axis shall point, world axes, of such a length */
    rbd_real weight;       /* of its squared error, beside those of the other targets; 0: 1 */
} rbd_ik_target;

/* 0 is the default in brackets. */
typedef struct rbd_ik_options {
    int starts;                /* at most [60]: the caller's q, then others; 1: from q alone */
    int evaluations;           /* of the targets, at most, 2 or more [5000]: bounds the time */
    rbd_real metres;           /* m: a target is reached if its place is this near [1e-6, float 1e-5] */
    rbd_real radians;          /* rad: and its angle [1e-6, float 1e-5] */
    rbd_real length;           /* m, 1e-9 or more: how much a radian of error counts; say reach / 3 [0.3] */
    const unsigned char *held; /* nv flags: not 0 where a degree of freedom stays as it is; NULL: none. Of a
                                  spherical, planar or floating joint all, or none */
} rbd_ik_options;

/* The result of rbd_ik: 0 if all targets are reached. Above 0 q is the nearest that was found. */
typedef enum rbd_ik_status {
    RBD_IK_REACHED = 0,
    RBD_IK_AT_LIMIT = 1,    /* not reached: a joint is at a limit, which keeps the targets away */
    RBD_IK_NEAREST = 2,     /* not reached: no small motion comes nearer, as of an arm that is too short */
    RBD_IK_EVALUATIONS = 3, /* not reached, and more evaluations might come nearer */
    RBD_IK_ERROR = -1       /* result->error says why; q is as it was */
} rbd_ik_status;

typedef struct rbd_ik_result {
    rbd_real metres;  /* m: the largest distance of a point or centre of mass from its place */
    rbd_real radians; /* rad: the largest angle of a body or axis from what it should be */
    int limit;        /* AT_LIMIT: the dof, index into v, whose limit keeps the targets away most; else -1 */
    int limits;       /* how many dofs are at such limits; with mimic joints a limit may be that of a mimic */
    int starts;       /* begun */
    int evaluations;  /* of the targets */
    rbd_status error; /* RBD_OK but after RBD_IK_ERROR */
    int target;       /* after an error: of which; -1: none */
    const char *field; /* after an error: of rbd_ik_target or rbd_ik_options, or "q"; NULL: none */
} rbd_ik_result;

/* ---- inverse kinematics [inverse kinematics] ---- */

/* Finds joint positions q within all limits for which all targets are reached; if there are none that it
   finds, those that minimise the sum of weight (metres^2 + length^2 radians^2), at least locally.
   w         what rbd_kinematics left there is replaced: call it anew before calls that read it
   targets   n of them, n at least 1; a body may have several, such as a point and an axis
   options   NULL: all defaults
   memory    size bytes of any alignment, scratch: RBD_IK_SIZE
   q         nq: where to begin, such as where the robot is; then the answer. Joints that move no target, and
             held ones, stay, to the bit
   result    what was reached
   Damped least squares (Wampler 1986) with the damping of Sugihara (2011); joints that would pass a limit are
   set on it, and the others solved for again (Flacco, De Luca and Khatib 2015).
   Errors, in result->error: RBD_ERR_NULL, but without a result RBD_IK_ERROR alone; _WORK; _MEMORY; _COUNT, n
   below 1 or above 1000; _INDEX, a body; _TYPE, no kind; _POSITION, _ROTATION, _AXIS; _MASS, a centre of mass
   of a robot without mass; _MASSLESS, that of a robot some of whose joints move none; _RANGE, a weight, an
   option or q; _INFEASIBLE, some dofs of a joint are held, not all; _NAN, q is not finite, or the errors at
   each start overflow. */
RBDI_API rbd_ik_status rbd_ik(const rbd_model *m, rbd_work *w, const rbd_ik_target *targets, int n,
                              const rbd_ik_options *options, void *memory, size_t size, rbd_real *q,
                              rbd_ik_result *result);

/* Bytes that rbd_ik needs for n targets; 0 if n is out of range. */
RBDI_API size_t rbd_ik_size(const rbd_model *m, int n);

/* Writes what a status and result say as a sentence, e.g. "target 1, field 'body': no such body", cut to
   fit, always terminated. text: size bytes. Returns text. */
RBDI_API char *rbd_ik_text(rbd_ik_status status, const rbd_ik_result *result, char *text, size_t size);

/* ==== src/rbd_ik.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_IK_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

/* ==== src/base/letters_begin.h ==== */
#pragma push_macro("A")
#undef A
#pragma push_macro("E")
#undef E
#pragma push_macro("H")
#undef H
#pragma push_macro("J")
#undef J
#pragma push_macro("P")
#undef P
#pragma push_macro("R")
#undef R
#pragma push_macro("X")
#undef X

/* ==== src/rbd_ik.h ==== */
#ifndef RBDI_IK_LAYOUT
#define RBDI_IK_LAYOUT

/* ==== src/ik/layout.h ==== */
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

/* ==== src/rbd_ik.h ==== */
#endif /* RBDI_IK_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_IK_IMPLEMENTED
#define RBDI_IK_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/ik/step.h ==== */
/* Interface: rbdi_ik_copy */

/* ---- step [step] ---- */

RBDI_LOCAL void rbdi_ik_copy(const rbd_real *from, int n, rbd_real *to) {
    for (int i = 0; i < n; ++i) to[i] = from[i];
}

/* Where row i of a packed upper triangle of n rows begins: with its diagonal entry. */
RBDI_INLINE ptrdiff_t rbdi_ik_row(int n, int i) { return (ptrdiff_t)i * (2 * n - i + 1) / 2; }

/* Product of two columns of J, in three sums: one would wait for each product. Rows come in threes. */
RBDI_INLINE rbd_real rbdi_ik_product(const rbd_real *a, const rbd_real *b, int rows) {
    rbdi_v3 sum = rbdi_vec0();

    for (int r = 0; r < rows; r += 3) {
        sum.x = sum.x + a[r] * b[r];
        sum.y = sum.y + a[r + 1] * b[r + 1];
        sum.z = sum.z + a[r + 2] * b[r + 2];
    }

    return sum.x + sum.y + sum.z;
}

/* H = J'J and g = J'e. Returns the trace of H. */
RBDI_LOCAL rbd_real rbdi_ik_normal(rbdi_ik *ik) {
    rbd_real trace = rbdi_zero(), *to = ik->H;

    for (int i = 0; i < ik->dofs; ++i) {
        const rbd_real *column = &ik->J[i * ik->rows];
        const rbd_real *diagonal = to;
        ik->g[i] = rbdi_ik_product(column, ik->e, ik->rows);
        for (int j = i; j < ik->dofs; ++j) *to++ = rbdi_ik_product(column, &ik->J[j * ik->rows], ik->rows);
        trace = trace + *diagonal;
    }

    return trace;
}

/* The limit of dof i at which q is and g presses, or RBDI_IK_FREE. */
RBDI_INLINE int rbdi_ik_pressed(const rbdi_ik *ik, int i) {
    const rbdi_ik_dof *f = &ik->dof[i];
    if (f->at < 0) return RBDI_IK_FREE;
    if (ik->g[i] < 0 && !(ik->q[f->at] > f->lower)) return RBDI_IK_LOWER;
    if (ik->g[i] > 0 && !(ik->q[f->at] < f->upper)) return RBDI_IK_UPPER;
    return RBDI_IK_FREE;
}

/* Entry (i, j) of H. */
RBDI_INLINE rbd_real rbdi_ik_entry(const rbdi_ik *ik, int i, int j) {
    return i <= j ? ik->H[rbdi_ik_row(ik->dofs, i) + j - i] : ik->H[rbdi_ik_row(ik->dofs, j) + i - j];
}

/* The equations of the n free dofs: the upper triangle of H + damping 1, and in x g - H d of the others. */
RBDI_LOCAL void rbdi_ik_gather(rbdi_ik *ik, int n, rbd_real damping) {
    rbd_real *to = ik->factor;

    for (int a = 0; a < n; ++a) {
        const int i = ik->solved[a];
        const rbd_real *row = &ik->H[rbdi_ik_row(ik->dofs, i) - i];
        *to++ = row[i] + damping;
        for (int b = a + 1; b < n; ++b) *to++ = row[ik->solved[b]];
        ik->x[a] = ik->g[i];
    }

    for (int j = 0; j < ik->dofs; ++j) {
        if (ik->dof[j].hold <= RBDI_IK_STAYS) continue; /* its d is solved for, or 0 */
        for (int a = 0; a < n; ++a) ik->x[a] = ik->x[a] - rbdi_ik_entry(ik, ik->solved[a], j) * ik->d[j];
    }
}

/* Solves the equations by elimination, A = L D L'. A pivot is at least `least`; its inverse takes its place.
   Returns whether all were positive. */
RBDI_LOCAL int rbdi_ik_solve(rbdi_ik *ik, int n, rbd_real least) {
    rbd_real *row = ik->factor, *x = ik->x;
    int definite = 1;

    /* A_ij = A_ij - A_ci A_cj / D_c, and so x */
    for (int c = 0; c < n; ++c) {
        rbd_real *to = row + n - c;
        const rbd_real inverse = RBD_C(1) / rbdi_larger(row[0], least);

        if (!(row[0] > 0)) definite = 0;
        row[0] = inverse;
        for (int i = 1; i < n - c; ++i) {
            const rbd_real share = row[i] * inverse;
            for (int j = i; j < n - c; ++j, ++to) *to = *to - share * row[j];
            x[c + i] = x[c + i] - share * x[c];
        }
        row += n - c;
    }

    /* x_c = (x_c - sum A_ci x_i) / D_c */
    for (int c = n - 1; c >= 0; --c) {
        row -= n - c;
        for (int i = 1; i < n - c; ++i) x[c] = x[c] - row[i] * x[c + i];
        x[c] = x[c] * row[0];
    }

    return definite;
}

/* Takes the n free dofs' part of the step; those that would pass a limit are set on it. Returns whether there
   were any. */
RBDI_LOCAL int rbdi_ik_set_on_limits(rbdi_ik *ik, int n) {
    int any = 0;

    for (int a = 0; a < n; ++a) {
        const int i = ik->solved[a];
        rbdi_ik_dof *f = &ik->dof[i];
        ik->d[i] = ik->x[a];
        if (f->at < 0) continue;

        if (ik->q[f->at] + ik->d[i] > f->upper) {
            ik->d[i] = f->upper - ik->q[f->at];
            f->hold = RBDI_IK_UPPER;
            any = 1;
        } else if (ik->q[f->at] + ik->d[i] < f->lower) {
            ik->d[i] = f->lower - ik->q[f->at];
            f->hold = RBDI_IK_LOWER;
            any = 1;
        }
    }

    return any;
}

/* The step d from q: see [method]. H and g are those of q; least: a share of H that is rounding. Returns
   whether H + damping was definite. */
RBDI_LOCAL int rbdi_ik_step(rbdi_ik *ik, rbd_real damping, rbd_real least) {
    int more = 1, definite = 1;

    for (int i = 0; i < ik->dofs; ++i) {
        ik->d[i] = rbdi_zero();
        ik->dof[i].hold = (int16_t)(rbdi_ik_pressed(ik, i) ? RBDI_IK_STAYS : RBDI_IK_FREE);
    }

    /* each round sets more dofs on limits, until none is left or none passes one */
    while (more) {
        int n = 0;
        for (int i = 0; i < ik->dofs; ++i)
            if (ik->dof[i].hold == RBDI_IK_FREE) ik->solved[n++] = (int16_t)i;

        rbdi_ik_gather(ik, n, damping + least);
        definite &= rbdi_ik_solve(ik, n, least);
        more = rbdi_ik_set_on_limits(ik, n);
    }

    return definite;
}

/* The share of the step at which no dof turns by more than RBDI_IK_TURN. */
RBDI_LOCAL rbd_real rbdi_ik_share(const rbdi_ik *ik) {
    rbd_real most = rbdi_set(RBDI_IK_TURN);
    for (int i = 0; i < ik->dofs; ++i)
        if (ik->dof[i].turns) most = rbdi_larger(most, rbdi_abs(ik->d[i]));
    return RBDI_IK_TURN / most;
}

/* q_next = q (+) share d of the joints that move a target; the others are as in q. */
RBDI_LOCAL void rbdi_ik_move_joints(rbdi_ik *ik, rbd_real share, rbd_real *q_next) {
    const rbdi_frame *last = NULL;

    rbdi_ik_copy(ik->q, ik->m->nq, q_next);
    for (int i = 0; i < ik->dofs; ++i) ik->v[ik->dof[i].dof] = ik->d[i] * share;

    for (int i = 0; i < ik->dofs; ++i) {
        const rbdi_frame *u = &ik->m->frame[ik->m->dof[ik->dof[i].dof].body];
        if (u->nq == 1) /* the most */
            q_next[u->iq] = ik->q[u->iq] + ik->v[u->iv];
        else if (u != last)
            rbdi_step_joint(u, &ik->q[u->iq], &ik->v[u->iv], &q_next[u->iq]);
        last = u;
    }
}

/* Moves q by a share of the step to q_next, which may be q. Limits hold to the bit. */
RBDI_LOCAL void rbdi_ik_move(rbdi_ik *ik, rbd_real share, rbd_real *q_next) {
    const int whole = !(share < 1);

    rbdi_ik_move_joints(ik, share, q_next);
    for (const rbdi_ik_dof *f = ik->dof; f < ik->dof + ik->dofs; ++f) {
        rbd_real *x;
        if (f->at < 0) continue;

        x = &q_next[f->at];
        if (*x > f->upper || (f->hold == RBDI_IK_UPPER && whole)) *x = f->upper;
        if (*x < f->lower || (f->hold == RBDI_IK_LOWER && whole)) *x = f->lower;
    }
}

/* ==== src/ik/targets.h ==== */
/* Interface: rbdi_ik_across, rbdi_ik_axis, rbdi_ik_body_com, rbdi_ik_com_jacobian, rbdi_ik_part_across,
   rbdi_ik_turn, rbdi_ik_turn_to, rbdi_ik_unit, rbdi_ik_way */

/* ---- targets [targets code] ---- */

RBDI_INLINE int rbdi_ik_turns_body(rbd_ik_kind kind) {
    return kind == RBD_IK_POSE || kind == RBD_IK_ROTATION;
}

RBDI_INLINE int rbdi_ik_moves_point(rbd_ik_kind kind) { return kind == RBD_IK_POSE || kind == RBD_IK_POINT; }

/* Rows of a kind of target. */
RBDI_INLINE int rbdi_ik_rows_of(rbd_ik_kind kind) { return kind == RBD_IK_POSE ? 6 : 3; }

/* Of a target's rows: the root of its weight. */
RBDI_INLINE rbd_real rbdi_ik_factor(const rbd_ik_target *t) {
    return t->weight > 0 ? rbdi_sqrt(t->weight) : rbdi_set(RBD_C(1));
}

/* R, 3 x 3 by rows; all 0 is the identity. */
RBDI_LOCAL rbdi_mat rbdi_ik_rotation(const rbd_real *R) {
    const rbd_real o = rbdi_zero(), one = rbdi_set(RBD_C(1));
    rbd_real sum = o;
    for (int i = 0; i < 9; ++i) sum = sum + R[i] * R[i];
    if (sum > 0) return rbdi_mat_of(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]);
    return rbdi_mat_of(one, o, o, o, one, o, o, o, one);
}

/* A vector of unit length. */
RBDI_LOCAL rbdi_v3 rbdi_ik_unit(const rbd_real *x) {
    const rbdi_v3 v = rbdi_load_vec(x, 1);
    return rbdi_scale(RBD_C(1) / rbdi_sqrt(rbdi_dot(v, v)), v);
}

/* A unit vector across the unit vector s. */
RBDI_LOCAL rbdi_v3 rbdi_ik_across(rbdi_v3 s) {
    const rbd_real o = rbdi_zero(), one = rbdi_set(RBD_C(1));
    const rbdi_v3 x = rbdi_vec(one, o, o), y = rbdi_vec(o, one, o);
    const rbdi_v3 v = rbdi_cross(s, s.x * s.x < RBD_C(0.5) ? x : y);
    return rbdi_scale(one / rbdi_sqrt(rbdi_dot(v, v)), v);
}

/* The shortest turn that leads from s to t, of unit length; from s = -t about any axis across. */
RBDI_LOCAL rbdi_v3 rbdi_ik_turn(rbdi_v3 s, rbdi_v3 t) {
    const rbdi_v3 across = rbdi_cross(s, t);
    const rbd_real cosine = rbdi_dot(s, t), sine = rbdi_sqrt(rbdi_dot(across, across));
    if (sine > 0) return rbdi_scale(rbdi_angle(sine, cosine) / sine, across);
    if (cosine > 0) return rbdi_vec0();
    return rbdi_scale(rbdi_set(RBDI_PI(rbd_const)), rbdi_ik_across(s));
}

/* The turn, in the axes that E leads from, of a body with the axes E to the rotation R, 3 x 3. */
RBDI_LOCAL rbdi_v3 rbdi_ik_turn_to(const rbd_real *R, rbdi_mat E) {
    return rbdi_log_rotation(rbdi_mul_mat(rbdi_ik_rotation(R), E));
}

/* An axis of a body, of unit length, world axes. */
RBDI_LOCAL rbdi_v3 rbdi_ik_axis(const rbd_model *m, const rbd_work *w, int body, const rbd_real *axis) {
    return rbdi_mul_t(rbdi_axes_of(m, w, body), rbdi_ik_unit(axis));
}

/* The part of v across the unit vector s. A turn about s itself does not move it. */
RBDI_LOCAL rbdi_v3 rbdi_ik_part_across(rbdi_v3 v, rbdi_v3 s) {
    return rbdi_sub(v, rbdi_scale(rbdi_dot(s, v), s));
}

/* The way from a point to a place. */
RBDI_LOCAL rbdi_v3 rbdi_ik_way(const rbd_real *place, rbdi_v3 p) {
    return rbdi_sub(rbdi_load_vec(place, 1), p);
}

/* The turn, world axes, that a target wants. */
RBDI_LOCAL rbdi_v3 rbdi_ik_wanted_turn(const rbdi_ik *ik, const rbd_ik_target *t) {
    if (t->kind == RBD_IK_AXIS)
        return rbdi_ik_turn(rbdi_ik_axis(ik->m, ik->w, t->body, t->axis), rbdi_ik_unit(t->direction));
    return rbdi_ik_turn_to(t->rotation, rbdi_axes_of(ik->m, ik->w, t->body));
}

/* Centre of mass of one body. */
RBDI_LOCAL rbdi_v3 rbdi_ik_body_com(const rbd_model *m, const rbd_work *w, const rbdi_frame *u) {
    rbd_real com[3];
    rbdi_store_vec(com, 1, rbdi_vec_c(u->com));
    return rbdi_point_position(m, w, (int)(u - m->frame), com);
}

/* Centre of mass of all bodies that a joint moves. */
RBDI_LOCAL rbdi_v3 rbdi_ik_com(const rbdi_ik *ik) {
    const rbd_model *m = ik->m;
    rbdi_v3 sum = rbdi_vec0();

    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->link >= 0)
            sum = rbdi_add(sum, rbdi_scale(rbdi_set(u->mass / ik->all), rbdi_ik_body_com(m, ik->w, u)));

    return sum;
}

/* Appends an error to e, with its weight; returns its length. */
RBDI_LOCAL rbd_real rbdi_ik_append(rbdi_ik *ik, int *row, rbd_real factor, rbdi_v3 error) {
    const rbdi_v3 scaled = rbdi_scale(factor, error);
    rbdi_store_vec(&ik->e[*row], 1, scaled);
    *row += 3;
    ik->cost = ik->cost + rbdi_dot(scaled, scaled);
    return rbdi_sqrt(rbdi_dot(error, error));
}

/* e and |e|^2 at q, angles before lengths; also the largest distance and angle. */
RBDI_LOCAL void rbdi_ik_errors(rbdi_ik *ik, const rbd_real *q) {
    int row = 0;

    if (ik->alone >= 0)
        rbd_body_kinematics(ik->m, ik->w, ik->alone, q, NULL, NULL);
    else
        rbd_kinematics(ik->m, ik->w, q, NULL, NULL);

    ++ik->result->evaluations;
    ik->cost = rbdi_zero();
    ik->result->metres = rbdi_zero();
    ik->result->radians = rbdi_zero();

    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        const rbd_real factor = rbdi_ik_factor(t);

        if (rbdi_ik_turns_body(t->kind) || t->kind == RBD_IK_AXIS) {
            const rbdi_v3 turn = rbdi_ik_wanted_turn(ik, t);
            const rbd_real angle = rbdi_ik_append(ik, &row, factor * ik->options.length, turn);
            ik->result->radians = rbdi_larger(ik->result->radians, angle);
        }

        if (rbdi_ik_moves_point(t->kind) || t->kind == RBD_IK_COM) {
            const rbdi_v3 at = t->kind == RBD_IK_COM ? rbdi_ik_com(ik)
                                                     : rbdi_point_position(ik->m, ik->w, t->body, t->point);
            const rbd_real distance = rbdi_ik_append(ik, &row, factor, rbdi_ik_way(t->position, at));
            ik->result->metres = rbdi_larger(ik->result->metres, distance);
        }
    }
}

/* Masses and first moments of the subtrees of all links, the moments about the origin of the first link.
   sums: nl x 4. */
RBDI_LOCAL void rbdi_ik_subtrees(const rbd_model *m, const rbd_work *w, rbd_real *sums) {
    const rbdi_v3 o = w->kin[0].X.r;

    rbdi_clear(sums, 4 * m->nl);
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        const rbd_real mass = rbdi_set(u->mass);
        rbdi_v3 moment;
        rbd_real *sum;
        if (u->link < 0) continue;

        moment = rbdi_scale(mass, rbdi_sub(rbdi_ik_body_com(m, w, u), o));
        sum = &sums[4 * u->link];
        sum[0] = sum[0] + mass;
        rbdi_store_vec(sum + 1, 1, rbdi_add(rbdi_load_vec(sum + 1, 1), moment));
    }

    for (int i = m->nl - 1; i > 0; --i)
        for (int j = 0; j < 4 && m->link[i].parent >= 0; ++j) {
            rbd_real *sum = &sums[4 * m->link[i].parent + j];
            *sum = *sum + sums[4 * i + j];
        }
}

/* Jacobian of the centre of mass, 3 x nv: a joint moves the centre of mass of its subtree, whose share of the
   whole is that of its mass. all: kg, the robot's mass. sums: nl x 4, scratch. */
RBDI_LOCAL void rbdi_ik_com_jacobian(const rbd_model *m, const rbd_work *w, rbd_const all, rbd_real *sums,
                                     rbd_real *J) {
    const rbd_real whole = rbdi_set(all);
    const rbdi_v3 o = w->kin[0].X.r;

    rbdi_ik_subtrees(m, w, sums);
    rbdi_clear(J, 3 * m->nv);
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        const rbd_real mass = sums[4 * i];
        rbdi_v3 centre;
        if (!(mass > 0)) continue;

        centre = rbdi_add(o, rbdi_scale(RBD_C(1) / mass, rbdi_load_vec(&sums[4 * i + 1], 1)));
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbd_real share = rbdi_ratio(m, l->iv + j) * mass / whole;
            const rbdi_v3 v = rbdi_scale(share, rbdi_column(m, w, i, j, centre).v);
            rbd_real *to = &J[rbdi_source(m, l->iv + j)];
            rbdi_store_vec(to, m->nv, rbdi_add(rbdi_load_vec(to, m->nv), v));
        }
    }
}

/* Copies three rows of ik->columns into J from `row` on; without the part along `off`, if there is any. */
RBDI_LOCAL void rbdi_ik_put_rows(rbdi_ik *ik, int *row, rbd_real factor, int from, const rbdi_v3 *off) {
    const ptrdiff_t nv = ik->m->nv;

    for (int i = 0; i < ik->dofs; ++i) {
        rbdi_v3 c = rbdi_load_vec(&ik->columns[from * nv + ik->dof[i].dof], nv);
        if (off) c = rbdi_ik_part_across(c, *off);
        rbdi_store_vec(&ik->J[i * ik->rows + *row], 1, rbdi_scale(factor, c));
    }

    *row += 3;
}

/* J at the place of the last rbdi_ik_errors. A turn e of length angle changes by dangle = -n omega, n along
   e: so g = J'e is exact, and J without the part along the axis. */
RBDI_LOCAL void rbdi_ik_jacobian(rbdi_ik *ik) {
    int row = 0;

    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        const rbd_real factor = rbdi_ik_factor(t);

        if (t->kind == RBD_IK_COM)
            rbdi_ik_com_jacobian(ik->m, ik->w, ik->all, ik->mass, &ik->columns[3 * ik->m->nv]);
        else
            rbd_jacobian(ik->m, ik->w, t->body, t->point, RBD_WORLD_AXES, ik->columns);

        if (t->kind == RBD_IK_AXIS) {
            const rbdi_v3 axis = rbdi_ik_axis(ik->m, ik->w, t->body, t->axis);
            rbdi_ik_put_rows(ik, &row, factor * ik->options.length, 0, &axis);
        }
        if (rbdi_ik_turns_body(t->kind)) rbdi_ik_put_rows(ik, &row, factor * ik->options.length, 0, NULL);
        if (rbdi_ik_moves_point(t->kind) || t->kind == RBD_IK_COM)
            rbdi_ik_put_rows(ik, &row, factor, 3, NULL);
    }
}

/* ==== src/ik/curvature.h ==== */
/* ---- curvature [curvature] ----
   The second derivative of |e|^2/2 beyond J'J; it counts where e does not vanish. With omega_i and v_i the
   columns of a target's Jacobian, dof i nearer to the root than dof j, as i < j, place and turn are

       d^2 p / dq_i dq_j = omega_i x v_j
       turn = omega_i q_i + omega_j q_j + (omega_i x omega_j) q_i q_j / 2

   For two dofs of one floating or planar joint, use the mean of both orders. What mimic joints add is left
   out.

   Let a turn of angle a about the unit vector n be left. A further turn w changes a^2/2 in second order by

       w' (n n' + c (1 - n n')) w / 2            c = (a/2) cot(a/2)

   because rotations are unit quaternions, on whose sphere angles are half as large, and on a unit sphere half
   the square of a distance x has the second derivative 1 along the way and x cot x across it. A direction s
   is a point of the unit sphere itself, and a turn about s does not change it:

       w' (n n' + c (1 - n n' - s s')) w / 2     c = a cot a

   The step from s by w is exp(w) s. Unless w is perpendicular to s, it is no great circle, and adds the term
   a (s'w) ((s x n)'w) / 2. The tests compare both with differences. Centres of mass are left out. */

/* The error of one target that is left, and what follows from it. */
typedef struct rbdi_ik_bend {
    rbdi_v3 place, turn; /* factor^2 times the error */
    rbdi_v3 n, s;        /* unit vectors, or 0 */
    rbdi_v3 side;        /* s x turn: of the term (s'w) ((s x n)'w) */
    rbd_real lack;       /* factor^2 (1 - c): what the Hessian lacks of J'J across n */
} rbdi_ik_bend;

/* x cot x, at least -1; x > 0. */
RBDI_LOCAL rbd_real rbdi_ik_cotangent(rbd_real x) {
    rbd_real s, c;
    rbdi_sincos(x, &s, &c);
    return x * c > -s ? x * c / s : rbdi_set(RBD_C(-1));
}

RBDI_LOCAL rbdi_ik_bend rbdi_ik_bend_of(const rbdi_ik *ik, const rbd_ik_target *t, int *row) {
    const rbd_real factor = rbdi_ik_factor(t);
    const rbd_real angular = factor * ik->options.length;
    rbdi_ik_bend b;

    b.place = b.turn = b.n = b.s = b.side = rbdi_vec0();
    b.lack = rbdi_zero();

    if (rbdi_ik_turns_body(t->kind) || t->kind == RBD_IK_AXIS) {
        const rbdi_v3 e = rbdi_load_vec(&ik->e[*row], 1);
        const rbd_real length = rbdi_sqrt(rbdi_dot(e, e));
        const rbd_real angle = length / angular;
        b.turn = rbdi_scale(angular, e);
        if (t->kind == RBD_IK_AXIS) b.s = rbdi_ik_axis(ik->m, ik->w, t->body, t->axis);
        b.side = rbdi_cross(b.s, b.turn);
        if (angle > RBDI_IK_STRAIGHT) {
            const rbd_real half = t->kind == RBD_IK_AXIS ? angle : RBD_C(0.5) * angle;
            b.n = rbdi_scale(RBD_C(1) / length, e);
            b.lack = angular * angular * (RBD_C(1) - rbdi_ik_cotangent(half));
        }
        *row += 3;
    }

    if (rbdi_ik_moves_point(t->kind)) b.place = rbdi_scale(factor, rbdi_load_vec(&ik->e[*row], 1));
    if (rbdi_ik_moves_point(t->kind) || t->kind == RBD_IK_COM) *row += 3;
    return b;
}

/* Term of the second derivative of place and turn, subtracted from H; dof i is nearer to the root. */
RBDI_INLINE rbd_real rbdi_ik_bent(const rbdi_ik_bend *b, const rbdi_motion *i, const rbdi_motion *j) {
    return rbdi_dot(b->place, rbdi_cross(i->omega, j->v)) +
           RBD_C(0.5) * rbdi_dot(b->turn, rbdi_cross(i->omega, j->omega));
}

/* Term of the second derivative of the angle, subtracted from H. */
RBDI_INLINE rbd_real rbdi_ik_lacking(const rbdi_ik_bend *b, rbdi_v3 i, rbdi_v3 j) {
    const rbd_real along = rbdi_dot(b->n, i) * rbdi_dot(b->n, j) + rbdi_dot(b->s, i) * rbdi_dot(b->s, j);
    const rbd_real side = rbdi_dot(b->s, i) * rbdi_dot(b->side, j) + rbdi_dot(b->s, j) * rbdi_dot(b->side, i);
    return b->lack * (rbdi_dot(i, j) - along) - RBD_C(0.5) * side;
}

/* Whether two dofs are of one joint whose dofs move together. */
RBDI_INLINE int rbdi_ik_together(const rbd_model *m, int i, int j) {
    const rbdi_frame *u = &m->frame[m->dof[i].body];
    return m->dof[i].body == m->dof[j].body && rbdi_is(&m->link[u->link], RBDI_BLOCK);
}

/* Takes the curvature of one target, whose Jacobian is in ik->columns, from H. */
RBDI_LOCAL void rbdi_ik_curve_of(rbdi_ik *ik, const rbdi_ik_bend *b) {
    const rbd_model *m = ik->m;
    rbd_real *H = ik->H;

    for (int r = 0; r < ik->dofs; ++r) {
        const int i = ik->dof[r].dof;
        const rbdi_motion one = rbdi_load_motion(&ik->columns[i], m->nv);

        for (int c = r; c < ik->dofs; ++c, ++H) {
            const int j = ik->dof[c].dof;
            const rbdi_motion two = rbdi_load_motion(&ik->columns[j], m->nv);
            rbd_real bent;

            if (rbdi_ik_together(m, i, j))
                bent = RBD_C(0.5) * (rbdi_ik_bent(b, &one, &two) + rbdi_ik_bent(b, &two, &one));
            else
                bent = rbdi_ik_bent(b, &one, &two);
            *H = *H - bent - rbdi_ik_lacking(b, one.omega, two.omega);
        }
    }
}

/* Takes the curvature of all targets from H, after rbdi_ik_normal. */
RBDI_LOCAL void rbdi_ik_curve(rbdi_ik *ik) {
    int row = 0;

    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        const rbdi_ik_bend b = rbdi_ik_bend_of(ik, t, &row);
        if (t->kind == RBD_IK_COM) continue;
        rbd_jacobian(ik->m, ik->w, t->body, t->point, RBD_WORLD_AXES, ik->columns);
        rbdi_ik_curve_of(ik, &b);
    }
}

/* ==== src/ik/dofs.h ==== */
/* Interface: rbdi_ik_limits */

/* ---- dofs [dofs] ---- */

/* Marks the dofs that move link i: 1, or 2 if they turn. With mimic joints those that they follow. */
RBDI_LOCAL void rbdi_ik_mark(const rbd_model *m, int i, int16_t *mark) {
    for (; i >= 0; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const int block = rbdi_is(l, RBDI_BLOCK);
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const int slides =
                block ? rbdi_block_of(m, l)->first + j >= 3 : rbdi_is(l, RBDI_SCREW) && !(l->rho > 0);
            int16_t *to = &mark[rbdi_source(m, l->iv + j)];
            if (!slides)
                *to = 2;
            else if (*to == 0)
                *to = 1;
        }
    }
}

/* The limits of a dof: those of its joint, and of joints that mimic it unless they leave nothing. */
RBDI_LOCAL void rbdi_ik_limits(const rbd_model *m, rbdi_ik_dof *f) {
    const rbdi_frame *u = &m->frame[m->dof[f->dof].body];
    rbdi_limits all = rbdi_limits_of(u);

    for (int i = 0; i < rbdi_mimics(m); ++i) {
        const rbdi_limits both = rbdi_both_limits(all, rbdi_limits_of_mimic(m, i));
        if (m->mimic[i].source_v == f->dof && both.lower <= both.upper) all = both;
    }

    f->at = (int16_t)(all.lower > -RBDI_UNBOUNDED || all.upper < RBDI_UNBOUNDED ? u->iq : -1);
    f->lower = rbdi_set(all.lower);
    f->upper = rbdi_set(all.upper);
}

/* The dofs that move a target and are not held. */
RBDI_LOCAL void rbdi_ik_find_dofs(rbdi_ik *ik) {
    const rbd_model *m = ik->m;
    int16_t *mark = ik->mark;

    for (int i = 0; i < m->nv; ++i) mark[i] = 0;
    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        if (t->kind != RBD_IK_COM) rbdi_ik_mark(m, m->frame[t->body].link, mark);
        for (int i = 0; t->kind == RBD_IK_COM && i < m->nl; ++i) rbdi_ik_mark(m, i, mark);
    }

    ik->dofs = 0;
    for (int i = 0; i < m->nv; ++i) {
        rbdi_ik_dof *f = &ik->dof[ik->dofs];
        if (mark[i] == 0 || (ik->options.held && ik->options.held[i])) continue;
        f->dof = (int16_t)i;
        f->turns = mark[i] == 2;
        rbdi_ik_limits(m, f);
        ++ik->dofs;
    }
}

/* Puts q within the limits of these dofs. */
RBDI_LOCAL void rbdi_ik_put_within(const rbdi_ik *ik, rbd_real *q) {
    for (const rbdi_ik_dof *f = ik->dof; f < ik->dof + ik->dofs; ++f) {
        if (f->at < 0) continue;
        if (q[f->at] > f->upper) q[f->at] = f->upper;
        if (q[f->at] < f->lower) q[f->at] = f->lower;
    }
}

/* ==== src/ik/search.h ==== */
/* ---- search [search] ---- */

/* Whether there are evaluations left, but for the last one, which judges. */
RBDI_INLINE int rbdi_ik_may_go_on(const rbdi_ik *ik) {
    return ik->result->evaluations == 0 || ik->result->evaluations < ik->options.evaluations - 1;
}

/* Whether the errors of the last evaluation are within the tolerances. */
RBDI_INLINE int rbdi_ik_is_reached(const rbdi_ik *ik) {
    return ik->result->metres <= ik->options.metres && ik->result->radians <= ik->options.radians &&
           ik->cost < RBDI_IK_OVERFLOW;
}

/* Keeps the place q of the last evaluation if it is the best so far. */
RBDI_LOCAL void rbdi_ik_keep(rbdi_ik *ik, const rbd_real *q) {
    if (!(ik->cost < ik->best_cost)) return;
    ik->best_cost = ik->cost;
    rbdi_ik_copy(q, ik->m->nq, ik->best);
}

/* The root above 1 of x^(n + 1) = x + 1, by Newton's method. It comes from above: (1 + 1/n)^n >= 2. */
RBDI_LOCAL rbd_real rbdi_ik_golden(int n) {
    const rbd_real one = rbdi_set(RBD_C(1)), count = rbdi_set((rbd_const)n);
    rbd_real x = one + one / count;

    for (int i = 0; i < RBDI_IK_NEWTON; ++i) {
        rbd_real power = one; /* x^n */
        for (int j = 0; j < n; ++j) power = power * x;
        x = x - (power * x - x - one) / ((count + one) * power - one);
    }

    return x;
}

/* How far from q starts are drawn where limits are wide. An angle goes as far as one turn, a slide as far as
   RBDI_IK_WIDE lengths. If joints mimic this one at a smaller ratio, the slowest of them goes as far. A screw
   of little pitch goes on until it has slid as far as a slide. */
RBDI_LOCAL rbd_real rbdi_ik_wide(const rbdi_ik *ik, const rbdi_ik_dof *f) {
    const rbdi_frame *u = &ik->m->frame[ik->m->dof[f->dof].body];
    const rbd_real slide = RBDI_IK_WIDE * ik->options.length,
                   pitch = rbdi_abs(rbdi_set(ik->m->link[u->link].kappa));
    rbd_real most = f->turns ? rbdi_set(2 * RBDI_PI(rbd_const)) : slide;
    rbd_real least = rbdi_set(RBD_C(1)); /* of the ratios */

    for (int j = 0; j < rbdi_mimics(ik->m); ++j)
        if (ik->m->mimic[j].source_v == f->dof)
            least = rbdi_smaller(least, rbdi_abs(rbdi_set(ik->m->mimic[j].ratio)));

    if (f->turns && most * pitch < slide && pitch > 0) most = slide / pitch;
    return most < RBDI_IK_MOST * least ? most / least : rbdi_set(RBDI_IK_MOST);
}

/* A share of what a start may take of the limits of dof f, from ik->q: see [method]. */
RBDI_LOCAL rbd_real rbdi_ik_draw(const rbdi_ik *ik, const rbdi_ik_dof *f, rbd_real share) {
    const rbd_real q = ik->q[f->at];
    const rbd_real most = rbdi_ik_wide(ik, f);
    rbd_real lower = f->lower, upper = f->upper;

    if (upper - lower > most + most) {
        lower = rbdi_larger(lower, q - most);
        upper = rbdi_smaller(upper, q + most);
    }

    return lower + share * (upper - lower) - q;
}

/* q of a start: the caller's; then share frac(1/2 + start golden^-(i + 1)) of the range of the ith dof. Any
   number of first starts is spread evenly (Roberts 2018). */
RBDI_LOCAL void rbdi_ik_start(rbdi_ik *ik, int start) {
    const rbd_real pi = rbdi_set(RBDI_PI(rbd_const));
    rbd_real golden, part = rbdi_set((rbd_const)start);

    rbdi_ik_copy(ik->from, ik->m->nq, ik->q);
    if (start == 0 || ik->dofs == 0) return;

    golden = rbdi_ik_golden(ik->dofs);
    for (int i = 0; i < ik->dofs; ++i) {
        rbdi_ik_dof *f = &ik->dof[i];
        rbd_real share;

        part = part / golden;
        share = part + RBD_C(0.5);
        share = share - (rbd_const)(int)share;

        f->hold = RBDI_IK_FREE;
        ik->d[i] = f->turns ? (share + share - RBD_C(1)) * pi : rbdi_zero();
        if (f->at >= 0) ik->d[i] = rbdi_ik_draw(ik, f, share);
    }
    rbdi_ik_move(ik, rbdi_set(RBD_C(1)), ik->q);
}

/* A start of the search. Returns whether it reaches the targets. */
RBDI_LOCAL int rbdi_ik_search(rbdi_ik *ik) {
    const rbd_real distant = RBDI_IK_FAR * ik->options.length * ik->options.length;
    rbd_real mark = rbdi_set(RBDI_IK_OVERFLOW);
    int stalled = 0;

    for (int step = 0; step < RBDI_IK_STEPS && rbdi_ik_may_go_on(ik); ++step) {
        rbd_real damping, least;

        rbdi_ik_errors(ik, ik->q);
        rbdi_ik_keep(ik, ik->q);
        if (rbdi_ik_is_reached(ik)) return 1;

        /* a start that gains too little is given up */
        if (ik->cost < RBD_C(0.25) * mark) {
            mark = ik->cost;
            stalled = 0;
        } else if (++stalled >= RBDI_IK_STALL) {
            return 0;
        }

        rbdi_ik_jacobian(ik);
        least = RBDI_IK_FLOOR * rbdi_ik_normal(ik) + RBDI_TINY;
        damping = RBDI_IK_DAMPING * (ik->cost < distant ? ik->cost : distant);
        rbdi_ik_step(ik, damping, least);
        rbdi_ik_move(ik, rbdi_ik_share(ik), ik->q);
    }

    return 0;
}

/* g, and H with the curvature, at the place of the last evaluation. Returns the share of H that is
   rounding. */
RBDI_LOCAL rbd_real rbdi_ik_quadratic(rbdi_ik *ik) {
    rbd_real least;

    rbdi_ik_jacobian(ik);
    least = RBDI_IK_FLOOR * rbdi_ik_normal(ik) + RBDI_TINY;
    rbdi_ik_curve(ik);
    return least;
}

/* How much the step should bring |e|^2 down by the quadratic model with H of [curvature]: 2 g'd - d'H d. */
RBDI_LOCAL rbd_real rbdi_ik_expected(const rbdi_ik *ik) {
    rbd_real sum = rbdi_zero();
    const rbd_real *H = ik->H;

    for (int i = 0; i < ik->dofs; ++i) {
        rbd_real Hd = RBD_C(0.5) * *H++ * ik->d[i];
        for (int j = i + 1; j < ik->dofs; ++j) Hd = Hd + *H++ * ik->d[j];
        sum = sum + ik->d[i] * (ik->g[i] - Hd);
    }

    return sum + sum;
}

/* By how much the damping changes after a step that has brought |e|^2 down by this share of what was expected
   (Nielsen 1999): 1 at a half. */
RBDI_LOCAL rbd_real rbdi_ik_relax(rbd_real share) {
    const rbd_real x = share + share - RBD_C(1);
    const rbd_real factor = rbdi_larger(rbdi_set(RBD_C(1) / 3), RBD_C(1) - x * x * x);
    return factor < 2 ? factor : rbdi_set(RBD_C(2));
}

/* Goes down from q by at most so many steps, with the damping of Levenberg and Marquardt, until one brings
   |e|^2 down by less than a share `end`. Returns whether it reaches the targets. */
RBDI_LOCAL int rbdi_ik_descend(rbdi_ik *ik, int steps, rbd_const end) {
    const rbd_real square = ik->options.length * ik->options.length;
    const rbd_real most = RBDI_IK_STIFF * square;
    rbd_real damping = RBDI_IK_DAMPING * square;
    rbd_real factor = rbdi_set(RBD_C(2));
    rbd_real least = rbdi_zero();
    rbd_real cost;
    int fresh = 1;
    if (!rbdi_ik_may_go_on(ik)) return 0;

    rbdi_ik_errors(ik, ik->q);
    cost = ik->cost;
    rbdi_ik_keep(ik, ik->q);
    if (rbdi_ik_is_reached(ik)) return 1;

    for (int step = 0; step < steps && rbdi_ik_may_go_on(ik) && damping < most; ++step) {
        rbd_real drop = rbdi_zero();
        if (fresh) least = rbdi_ik_quadratic(ik);

        if (rbdi_ik_step(ik, damping, least)) {
            rbdi_ik_move(ik, rbdi_set(RBD_C(1)), ik->trial);
            rbdi_ik_errors(ik, ik->trial);
            drop = cost - ik->cost;
        }

        /* the next damping; a step that brings nothing is not taken */
        fresh = drop > 0;
        damping = damping * (fresh ? rbdi_ik_relax(drop / rbdi_ik_expected(ik)) : factor);
        factor = fresh ? rbdi_set(RBD_C(2)) : factor + factor;
        if (!fresh) continue;

        rbdi_ik_keep(ik, ik->trial);
        rbdi_ik_copy(ik->trial, ik->m->nq, ik->q);
        if (rbdi_ik_is_reached(ik)) return 1;
        if (drop < end * cost) break;
        cost = ik->cost;
    }

    return 0;
}

/* Where g is 0 and H has a negative direction, as of a stretched arm that could fold, q is no nearest place:
   a small motion of all dofs leaves it. Returns whether the best place is such a one, q then being beside
   it. */
RBDI_LOCAL int rbdi_ik_leave_saddle(rbdi_ik *ik) {
    if (!rbdi_ik_may_go_on(ik)) return 0;

    rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
    rbdi_ik_errors(ik, ik->q);
    if (rbdi_ik_step(ik, rbdi_zero(), rbdi_ik_quadratic(ik))) return 0;

    for (int i = 0; i < ik->dofs; ++i) {
        const rbd_real aside =
            ik->dof[i].turns ? rbdi_set(RBDI_IK_ASIDE) : RBDI_IK_ASIDE * ik->options.length;
        ik->d[i] = i % 2 ? rbdi_zero() - aside : aside;
        ik->dof[i].hold = RBDI_IK_FREE;
    }

    rbdi_ik_move(ik, rbdi_set(RBD_C(1)), ik->q);
    return 1;
}

/* Descents from the best place and from the first starts, then a long one from the best of all, and another
   if that ends on a saddle. Returns whether one reaches the targets. */
RBDI_LOCAL int rbdi_ik_find_nearest(rbdi_ik *ik) {
    const int descents = ik->options.starts < RBDI_IK_DESCENTS ? ik->options.starts : RBDI_IK_DESCENTS;

    for (int i = 0; i < descents; ++i) {
        if (i > 0) {
            rbdi_ik_start(ik, i);
        } else {
            rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
        }

        if (rbdi_ik_descend(ik, RBDI_IK_STEPS, RBDI_IK_COARSE)) return 1;
    }

    rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
    if (rbdi_ik_descend(ik, RBDI_IK_LAST * RBDI_IK_STEPS, RBDI_IK_FINE)) return 1;
    return rbdi_ik_leave_saddle(ik) && rbdi_ik_descend(ik, RBDI_IK_LAST * RBDI_IK_STEPS, RBDI_IK_FINE);
}

/* Says why the targets are not reached at q: by g = J'e, as a share of |e| and the longest column of J. */
RBDI_LOCAL rbd_ik_status rbdi_ik_judge(rbdi_ik *ik) {
    rbd_real longest = rbdi_zero();
    rbd_real most = rbdi_zero();
    rbd_real left = rbdi_zero();
    rbd_real size;

    rbdi_ik_errors(ik, ik->q);
    rbdi_ik_jacobian(ik);
    rbdi_ik_normal(ik);
    for (int i = 0; i < ik->dofs; ++i) longest = rbdi_larger(longest, ik->H[rbdi_ik_row(ik->dofs, i)]);
    size = rbdi_sqrt(longest * ik->cost);

    for (int i = 0; i < ik->dofs; ++i) {
        const rbd_real slope = rbdi_abs(ik->g[i]);
        if (!rbdi_ik_pressed(ik, i)) {
            left = rbdi_larger(left, slope);
        } else if (slope > RBDI_IK_PRESSED * size) {
            ++ik->result->limits;
            if (slope > most) ik->result->limit = ik->dof[i].dof;
            most = rbdi_larger(most, slope);
        }
    }

    if (left > RBDI_IK_SETTLED * size) return RBD_IK_EVALUATIONS;
    return ik->result->limits > 0 ? RBD_IK_AT_LIMIT : RBD_IK_NEAREST;
}

/* ==== src/ik/check.h ==== */
/* Interface: rbdi_ik_is_axis, rbdi_ik_is_place, rbdi_ik_is_rotation, rbdi_ik_within */

/* ---- checks [checks] ---- */

/* Notes an error; returns it. */
RBDI_LOCAL rbd_status rbdi_ik_refuse(rbd_ik_result *result, rbd_status error, int target, const char *field) {
    result->error = error;
    result->target = target;
    result->field = field;
    return error;
}

/* Whether x is not negative and at most `most`; not of NaN. */
RBDI_INLINE int rbdi_ik_within(rbd_real x, rbd_const most) { return x >= 0 && x <= most; }

/* Whether three components are finite and not too large to compute with. */
RBDI_LOCAL int rbdi_ik_is_place(const rbd_real *x) {
    for (int i = 0; i < 3; ++i)
        if (!rbdi_ik_within(rbdi_abs(x[i]), RBDI_IK_MOST)) return 0;
    return 1;
}

/* Whether x is finite and not too short for an axis. */
RBDI_LOCAL int rbdi_ik_is_axis(const rbd_real *x) {
    const rbd_real least = RBD_C(1) / RBDI_IK_MOST;
    return rbdi_ik_is_place(x) && rbdi_dot(rbdi_load_vec(x, 1), rbdi_load_vec(x, 1)) >= least * least;
}

/* Whether R is a rotation to some six decimals, or all 0. */
RBDI_LOCAL int rbdi_ik_is_rotation(const rbd_real *R) {
    const rbd_real most = rbdi_set(RBD_C(RBDI_ORTHONORMAL)) + RBDI_IK_ROUNDED;
    rbdi_mat A, P;
    rbdi_v3 x;
    if (!rbdi_ik_is_place(R) || !rbdi_ik_is_place(R + 3) || !rbdi_ik_is_place(R + 6)) return 0;

    A = rbdi_ik_rotation(R);
    P = rbdi_mul_mat(A, rbdi_transpose(A));
    x = rbdi_cross(rbdi_vec(A.xx, A.xy, A.xz), rbdi_vec(A.yx, A.yy, A.yz));
    return rbdi_abs(P.xx - 1) <= most && rbdi_abs(P.yy - 1) <= most && rbdi_abs(P.zz - 1) <= most &&
           rbdi_abs(P.xy) <= most && rbdi_abs(P.xz) <= most && rbdi_abs(P.yz) <= most &&
           rbdi_dot(x, rbdi_vec(A.zx, A.zy, A.zz)) > 0;
}

RBDI_LOCAL rbd_status rbdi_ik_check_target(const rbd_model *m, const rbd_ik_target *t, int i,
                                           rbd_ik_result *result) {
    const int kind = (int)t->kind;
    const int com = t->kind == RBD_IK_COM;
    if (kind < (int)RBD_IK_POINT || kind > (int)RBD_IK_COM)
        return rbdi_ik_refuse(result, RBD_ERR_TYPE, i, "kind");
    if (!com && (t->body < 0 || t->body >= m->nb)) return rbdi_ik_refuse(result, RBD_ERR_INDEX, i, "body");
    if (com && !(rbd_mass(m) > 0)) return rbdi_ik_refuse(result, RBD_ERR_MASS, i, "kind");
    if (com && rbdi_massless_dof(m) >= 0) return rbdi_ik_refuse(result, RBD_ERR_MASSLESS, i, "kind");

    if (!com && !rbdi_ik_is_place(t->point)) return rbdi_ik_refuse(result, RBD_ERR_POSITION, i, "point");
    if ((com || rbdi_ik_moves_point(t->kind)) && !rbdi_ik_is_place(t->position))
        return rbdi_ik_refuse(result, RBD_ERR_POSITION, i, "position");
    if (rbdi_ik_turns_body(t->kind) && !rbdi_ik_is_rotation(t->rotation))
        return rbdi_ik_refuse(result, RBD_ERR_ROTATION, i, "rotation");
    if (t->kind == RBD_IK_AXIS && !rbdi_ik_is_axis(t->axis))
        return rbdi_ik_refuse(result, RBD_ERR_AXIS, i, "axis");
    if (t->kind == RBD_IK_AXIS && !rbdi_ik_is_axis(t->direction))
        return rbdi_ik_refuse(result, RBD_ERR_AXIS, i, "direction");

    if (!rbdi_ik_within(t->weight, RBDI_IK_MOST_WEIGHT) ||
        (t->weight > 0 && t->weight < RBD_C(1) / RBDI_IK_MOST_WEIGHT))
        return rbdi_ik_refuse(result, RBD_ERR_RANGE, i, "weight");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_ik_check_options(const rbd_ik_options *o, rbd_ik_result *result) {
    const rbd_real values[5] = {(rbd_real)o->starts, (rbd_real)o->evaluations, o->metres, o->radians,
                                o->length};
    const char *const names[5] = {"starts", "evaluations", "metres", "radians", "length"};
    for (int i = 0; i < 5; ++i)
        if (!rbdi_ik_within(values[i], RBDI_IK_MOST))
            return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, names[i]);
    if (o->length > 0 && o->length < RBD_C(1) / RBDI_IK_MOST)
        return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, "length");
    if (o->evaluations == 1) return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, "evaluations");
    return RBD_OK;
}

/* A joint that turns has no coordinate that stays if one of its dofs does: all of them are held, or none. */
RBDI_LOCAL rbd_status rbdi_ik_check_held(const rbd_model *m, const unsigned char *held,
                                         rbd_ik_result *result) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        for (int k = 1; k < u->nv && rbdi_joint_turns(u); ++k)
            if (!held[u->iv + k] != !held[u->iv])
                return rbdi_ik_refuse(result, RBD_ERR_INFEASIBLE, -1, "held");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_ik_check_q(const rbd_model *m, const rbd_real *q, rbd_ik_result *result) {
    for (int i = 0; i < m->nq; ++i) {
        if (!rbdi_is_finite(q[i])) return rbdi_ik_refuse(result, RBD_ERR_NAN, -1, "q");
        if (rbdi_abs(q[i]) > RBDI_IK_MOST) return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, "q");
    }
    return RBD_OK;
}

/* All checks, in the order of the arguments. */
RBDI_LOCAL rbd_status rbdi_ik_check(const rbd_model *m, const rbd_work *w, const rbd_ik_target *targets,
                                    int n, const rbd_ik_options *options, const void *memory, size_t size,
                                    const rbd_real *q, rbd_ik_result *result) {
    rbd_status status = rbdi_check(m, w, targets && memory && q);
    if (status) return rbdi_ik_refuse(result, status, -1, NULL);
    if (n < 1 || n > RBDI_IK_MOST_TARGETS) return rbdi_ik_refuse(result, RBD_ERR_COUNT, -1, NULL);

    for (int i = 0; i < n && !status; ++i) status = rbdi_ik_check_target(m, &targets[i], i, result);
    if (!status && options) status = rbdi_ik_check_options(options, result);
    if (!status && options && options->held) status = rbdi_ik_check_held(m, options->held, result);
    if (!status && size < rbd_ik_size(m, n)) status = rbdi_ik_refuse(result, RBD_ERR_MEMORY, -1, NULL);
    return status ? status : rbdi_ik_check_q(m, q, result);
}

/* ==== src/ik/solve.h ==== */
/* ---- inverse kinematics [inverse kinematics code] ---- */

RBDI_API size_t rbd_ik_size(const rbd_model *m, int n) {
    return m && n > 0 && n <= RBDI_IK_MOST_TARGETS ? RBDI_IK_BYTES(m->nv, m->nl, n) : 0;
}

/* The options with defaults. */
RBDI_LOCAL rbd_ik_options rbdi_ik_defaults(const rbd_ik_options *given) {
    rbd_ik_options o;
    o.starts = given && given->starts ? given->starts : RBDI_IK_STARTS;
    o.evaluations = given && given->evaluations ? given->evaluations : RBDI_IK_EVALUATIONS;
    o.metres = given && given->metres > 0 ? given->metres : rbdi_set(RBDI_IK_TOLERANCE);
    o.radians = given && given->radians > 0 ? given->radians : rbdi_set(RBDI_IK_TOLERANCE);
    o.length = given && given->length > 0 ? given->length : rbdi_set(RBDI_IK_LENGTH);
    o.held = given ? given->held : NULL;
    return o;
}

/* Lays out the arrays in the memory. */
RBDI_LOCAL rbdi_ik *rbdi_ik_lay_out(const rbd_model *m, int n, void *memory) {
    const int nv = m->nv, triangle = nv * (nv + 1) / 2;
    unsigned char *at = rbdi_aligned(memory);
    rbdi_ik *ik = RBDI_CUT(rbdi_ik, 1);
    ik->dof = RBDI_CUT(rbdi_ik_dof, nv);
    ik->mark = RBDI_CUT(int16_t, nv);
    ik->solved = ik->mark;

    ik->e = (rbd_real *)at;
    ik->J = ik->e + 6 * n;
    ik->columns = ik->J + 6 * n * nv;
    ik->H = ik->columns + 6 * nv;
    ik->factor = ik->H + triangle;
    ik->g = ik->factor + triangle;
    ik->d = ik->g + nv;
    ik->x = ik->d + nv;
    ik->v = ik->x + nv;
    ik->from = ik->v + nv;
    ik->best = ik->from + m->nq;
    ik->q = ik->best + m->nq;
    ik->trial = ik->q + m->nq;
    ik->mass = ik->trial + m->nq;
    return ik;
}

/* Makes the search ready to begin from q. */
RBDI_LOCAL rbdi_ik *rbdi_ik_begin(const rbd_model *m, rbd_work *w, const rbd_ik_target *targets, int n,
                                  const rbd_ik_options *options, void *memory, const rbd_real *q,
                                  rbd_ik_result *result) {
    rbdi_ik *ik = rbdi_ik_lay_out(m, n, memory);
    ik->m = m;
    ik->w = w;
    ik->target = targets;
    ik->n = n;
    ik->options = rbdi_ik_defaults(options);
    ik->result = result;
    ik->alone = n == 1 && targets->kind != RBD_IK_COM ? targets->body : -1;
    ik->all = rbd_mass(m);
    ik->best_cost = rbdi_set(RBDI_IK_OVERFLOW);

    ik->rows = 0;
    for (int i = 0; i < n; ++i) ik->rows += rbdi_ik_rows_of(targets[i].kind);
    rbdi_clear(ik->v, m->nv);
    rbdi_ik_find_dofs(ik);
    rbdi_ik_copy(q, m->nq, ik->from);
    rbdi_ik_put_within(ik, ik->from);
    return ik;
}

/* Searches; then looks for the nearest place. ik->q is the answer. */
RBDI_LOCAL rbd_ik_status rbdi_ik_run(rbdi_ik *ik) {
    for (int i = 0; i < ik->options.starts && rbdi_ik_may_go_on(ik); ++i) {
        ++ik->result->starts;
        rbdi_ik_start(ik, i);
        if (rbdi_ik_search(ik)) return RBD_IK_REACHED;
    }

    if (!(ik->best_cost < RBDI_IK_OVERFLOW)) {
        rbdi_ik_refuse(ik->result, RBD_ERR_NAN, -1, "q");
        return RBD_IK_ERROR;
    }

    if (rbdi_ik_find_nearest(ik)) return RBD_IK_REACHED;
    rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
    return rbdi_ik_judge(ik);
}

RBDI_API rbd_ik_status rbd_ik(const rbd_model *m, rbd_work *w, const rbd_ik_target *targets, int n,
                              const rbd_ik_options *options, void *memory, size_t size, rbd_real *q,
                              rbd_ik_result *result) {
    rbd_ik_status status;
    rbdi_ik *ik;
    if (!result) return RBD_IK_ERROR;

    result->metres = rbdi_zero();
    result->radians = rbdi_zero();
    result->starts = 0;
    result->evaluations = 0;
    result->limits = 0;
    result->limit = -1;
    rbdi_ik_refuse(result, RBD_OK, -1, NULL);
    if (rbdi_ik_check(m, w, targets, n, options, memory, size, q, result)) return RBD_IK_ERROR;

    ik = rbdi_ik_begin(m, w, targets, n, options, memory, q, result);
    status = rbdi_ik_run(ik);
    if (status != RBD_IK_ERROR) rbdi_ik_copy(ik->q, m->nq, q);
    return status;
}

/* ==== src/ik/text.h ==== */
/* ---- text [text code] ---- */

RBDI_MESSAGES RBDI_PART const char *rbdi_ik_sentence(rbd_ik_status status) {
    switch (status) {
    case RBD_IK_REACHED: return "all targets are reached";
    case RBD_IK_AT_LIMIT: return "not reached: the limit of this joint keeps the targets away";
    case RBD_IK_NEAREST: return "not reached: no small motion comes nearer";
    case RBD_IK_EVALUATIONS: return "not reached: more evaluations might come nearer";
    case RBD_IK_ERROR: return "an error, and no result that says which";
    }
    return "unknown status";
}

/* The sentence of an error, where that of rbd_status_string speaks of a model. */
RBDI_MESSAGES RBDI_PART const char *rbdi_ik_error(rbd_status error) {
    switch ((int)error) {
    case RBD_ERR_COUNT: return "fewer than 1 target, or more than 1000";
    case RBD_ERR_TYPE: return "no kind of target";
    case RBD_ERR_POSITION: return "not finite, or farther than 1e9 m";
    case RBD_ERR_AXIS: return "not finite, or of a length out of 1e-9 to 1e9";
    case RBD_ERR_INFEASIBLE: return "only a part of a spherical, planar or floating joint is held";
    case RBD_ERR_MASS: return "a centre of mass, but the robot has no mass";
    case RBD_ERR_NAN: return "not finite, or the errors overflow";
    default: return rbd_status_string(error);
    }
}

RBDI_API char *rbd_ik_text(rbd_ik_status status, const rbd_ik_result *result, char *text, size_t size) {
    const int failed = status == RBD_IK_ERROR && result;
    const char *piece[8];
    char digits[12];
    int n = 0;
    if (!text || size == 0) return text;

    if (failed && result->target >= 0) {
        piece[n++] = "target ";
        piece[n++] = rbdi_decimal(result->target, digits);
        piece[n++] = ", ";
    }
    if (failed && result->field) {
        piece[n++] = "field '";
        piece[n++] = result->field;
        piece[n++] = "': ";
    }
    if (status == RBD_IK_AT_LIMIT && result && result->limit >= 0) {
        piece[n++] = "dof ";
        piece[n++] = rbdi_decimal(result->limit, digits);
        piece[n++] = ": ";
    }
    piece[n++] = failed ? rbdi_ik_error(result->error) : rbdi_ik_sentence(status);
    return rbdi_join(piece, n, text, size);
}

/* ==== src/rbd_ik.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("E")
#pragma pop_macro("H")
#pragma pop_macro("J")
#pragma pop_macro("P")
#pragma pop_macro("R")
#pragma pop_macro("X")
