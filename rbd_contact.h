/* rbd_contact.h - contacts that push only and slip, on rbd_constraints.h.
   Made by src/amalgamate.py from src/rbd_contact.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Impulses of contacts with friction by the exact laws of Signorini and Coulomb at the level of velocities.
   Implemented by the same RBD_IMPLEMENTATION as rbd.h, in the same file.

   CONTENTS (search for the tag)
     [conventions] [configuration] [limits]
     [solver]
     --- stop here if you only use it ---
     [tolerances] [layout] [one contact] [laws] [newton] [solver code]

   [conventions] Beyond those of rbd.h:
     u            velocity of body 1's point of contact less that of body 2's at this place, m/s
     p            impulse on body 1 at this place, N s; the opposite acts on body 2
     rows         of a contact: two tangents, then the normal, out of body 2 into body 1
     laws         normal: p_n >= 0, u_n >= 0, p_n u_n = 0; friction: |p_t| <= mu p_n, and where a contact slips
                  u_t = -alpha p_t, alpha > 0, |p_t| = mu p_n. Stewart and Trinkle (1996), Anitescu and Potra
                  (1997), here with the round cone. Of a bounded row: lower <= p <= upper; u > 0 only at the
                  lower bound, u < 0 only at the upper one

   [configuration] That of rbd.h, without RBD_NO_CHOLESKY, RBD_LANES and RBD_REAL_CUSTOM: the solver branches on
     its data.

   [limits]
     No rolling and torsional friction. Convergence of the solver is not proven, nor is the solution unique where
     friction is large; the residual says what was reached.
*/
#include "rbd_constraints.h"

#ifndef RBD_CONTACT_H
#define RBD_CONTACT_H

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_contact.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

#if defined __cplusplus && !defined RBD_STATIC
extern "C" {
#endif

/* ==== src/api/contact.h ==== */
#define rbd_contact_solve_size RBDI_SYMBOL(rbd_contact_solve_size)
#define rbd_contact_solve RBDI_SYMBOL(rbd_contact_solve)

typedef enum rbd_contact_state {
    RBD_APART, /* not a row of the problem: too far away, or nothing that it touches can move */
    RBD_OPENS, /* may touch, but does not push */
    RBD_STICKS,
    RBD_SLIPS
} rbd_contact_state;

/* ---- solver [solver] ----
   Impulses p of contacts from u = Delta p + b and the laws of [conventions], for those who have a Delta. */

typedef struct rbd_contact_problem {
    int contacts;             /* three rows each, in the order tangent, tangent, normal */
    int bounded;              /* rows behind those, one each: joint limits, dry friction, what is held */
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

/* Bytes of memory that rbd_contact_solve needs for such a problem. */
RBDI_API size_t rbd_contact_solve_size(int contacts, int bounded);

/* Solves the problem. One that is not solved is no error: the residual is above the tolerance then. p is finite
   and within cones and bounds in any case, if M^-1, b and the bounds are finite.
   memory     size bytes of any alignment, scratch
   p          rows: where to begin (0, or the solution before), then the solution, N s
   state      contacts: what each does; may be NULL
   solution   may be NULL
   Errors: RBD_ERR_NULL, _MEMORY; _COUNT, a number below 0; _RANGE, a friction, tolerance or number of iterations
   below 0, or a lower bound above the upper one; _NAN, an entry of b or p is not finite: p is 0. */
RBDI_API rbd_status rbd_contact_solve(const rbd_contact_problem *problem, void *memory, size_t size,
                                      rbd_real *p, rbd_contact_state *state, rbd_contact_solution *solution);

/* ==== src/rbd_contact.h ==== */
#if defined __cplusplus && !defined RBD_STATIC
}
#endif

#endif /* RBD_CONTACT_H */

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
#pragma push_macro("I")
#undef I
#pragma push_macro("J")
#undef J
#pragma push_macro("K")
#undef K
#pragma push_macro("L")
#undef L
#pragma push_macro("M")
#undef M
#pragma push_macro("N")
#undef N
#pragma push_macro("O")
#undef O
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
#pragma push_macro("U")
#undef U
#pragma push_macro("V")
#undef V
#pragma push_macro("W")
#undef W
#pragma push_macro("X")
#undef X
#pragma push_macro("Y")
#undef Y
#pragma push_macro("Z")
#undef Z

/* ==== src/rbd_contact.h ==== */
#ifndef RBDI_CONTACT_LAYOUT
#define RBDI_CONTACT_LAYOUT

/* ==== src/contact/layout.h ==== */
/* ---- layout [layout] ---- */

/* One contact of a problem: its block of Delta, D = [A c; c' d], and what the law needs of it. */
typedef struct rbdi_contact_law {
    rbd_real A[3], c[2], d; /* A: xx xy yy */
    rbd_real trace;         /* of D */
    rbd_real l[2], axis[2]; /* S = A - c c'/d: its eigenvalues, and the eigenvector of the first */
    rbd_real k[2];          /* c/d along S's eigenvectors */
    rbd_real friction;      /* mu */
    rbd_real alpha;         /* u_t = -alpha p_t when it last slipped, 1/kg; 0 before */
    rbd_real e[2];          /* direction of friction */
    rbd_contact_state state;
} rbdi_contact_law;

/* An unknown of a Newton step, [newton]: it changes p by `column` and asks for 0 of `row` times u, both in so
   many rows of the problem from number `first` on. */
typedef struct rbdi_contact_unknown {
    int first, rows;
    rbd_real column[3], row[3];
    rbd_real alpha; /* what the diagonal has beside Delta */
    rbd_real scale; /* of the diagonal */
} rbdi_contact_unknown;

/* A problem that is being solved. */
typedef struct rbdi_contact_solver {
    rbd_contact_problem given;
    int rows;
    rbdi_contact_law *law;         /* contacts */
    rbd_contact_state *bound;      /* bounded rows: RBD_STICKS between the bounds, else RBD_OPENS */
    rbd_real *p, *u;               /* rows: p is the caller's */
    rbd_real *start, *aim, *best;  /* rows: impulses before and behind a Newton step, the best so far */
    rbd_real *scratch;             /* rows */
    rbdi_contact_unknown *unknown; /* rows */
    rbd_real *G; /* rows x (rows + 1): the matrix of a Newton step, and its right-hand side */
    rbd_contact_solution solution;
} rbdi_contact_solver;

#define RBDI_CONTACT_SOLVER_BYTES(contacts, bounded) \
    (RBDI_ALIGN + RBDI_ROUND((size_t)(contacts) * sizeof(rbdi_contact_law)) + \
     RBDI_ROUND((size_t)(bounded) * sizeof(rbd_contact_state)) + \
     RBDI_ROUND(RBDI_CONTACT_ROWS(contacts, bounded) * sizeof(rbdi_contact_unknown)) + \
     sizeof(rbd_real) * RBDI_CONTACT_ROWS(contacts, bounded) * (6 + RBDI_CONTACT_ROWS(contacts, bounded)))
#define RBDI_CONTACT_ROWS(contacts, bounded) (3 * (size_t)(contacts) + (size_t)(bounded))

/* ==== src/rbd_contact.h ==== */
#endif /* RBDI_CONTACT_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_CONTACT_IMPLEMENTED
#define RBDI_CONTACT_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/contact/tolerances.h ==== */
/* ---- tolerances [tolerances] ---- */

/* RBDI_UNMOVED: a block's entry below this share of its trace is rounding: nothing gives way there.
   RBDI_PROXIMAL: what Newton adds to the diagonal, a share of the trace: [newton]. */
#define RBDI_UNMOVED (16 * RBDI_EPS)
#if RBDI_KIND(RBD_CONST) == 2
#define RBDI_PROXIMAL {1e-4f, 1e-3f, 1e-2f}
#define RBDI_CONTACT_TOLERANCE 1e-5f
#else
#define RBDI_PROXIMAL {RBD_C(1e-7), RBD_C(1e-4), RBD_C(1e-2)}
#define RBDI_CONTACT_TOLERANCE RBD_C(1e-6)
#endif
#define RBDI_CONTACT_ITERATIONS 40

#define RBDI_ROOT_STEPS 60           /* of the root of one contact, which needs six on average */
#define RBDI_FASTEST_SLIP RBD_C(1e9) /* alpha over d: faster slip is slip without friction */
#define RBDI_SHORTENINGS 3           /* shares of a Newton step that are tried: */
#define RBDI_SHORTEN_BY RBD_C(0.3)
#define RBDI_FULL_STEP_GAIN RBD_C(0.98) /* the residual must fall below this share of itself */
#define RBDI_SHORT_STEP_GAIN RBD_C(0.9)
#define RBDI_MOST_SWEEPS 32        /* between two Newton steps */
#define RBDI_UNBOUNDED RBD_C(1e30) /* as a bound: none; as a residual: none could be computed */

/* ==== src/contact/one_contact.h ==== */
/* ---- one contact [one contact] ----
   The laws of one contact, exactly, with all other impulses held. w = u - D p is its velocity without its own
   impulse, D = [A c; c' d].

     w_n >= 0             p = 0: it opens
     slip                 u_n = 0 and u_t = -alpha p_t, so that with p0 = -w_n/d > 0, S = A - c c'/d, s = w_t + c p0

       (S + alpha) p_t = -s,   p_n = p0 - (c/d)'p_t,   |p_t(alpha)| = mu p_n(alpha),   alpha > 0               (1)

     stick                the same with alpha = 0, where p is within the cone

   Along the eigenvectors of S p_t is two divisions. g(alpha) = |p_t| - mu p_n is above 0 at 0 where stick was
   refused, and not above 0 at |s| (1 + mu (|k_1| + |k_2|)) / (mu p0), k = c/d along the eigenvectors: there is
   always a root between. Newton's method on 1/|p_t| - 1/(mu p_n), which is linear in alpha where S has equal
   eigenvalues and c = 0; a step out of the bracket becomes a halving. With strong coupling there may be more
   roots (Painleve): each obeys the laws, and the bracket decides which one comes out. */

/* Eigenvalues and eigenvectors of S = A - c c'/d. */
RBDI_PART void rbdi_contact_axes(rbdi_contact_law *law) {
    const rbd_real x = law->c[0] / law->d, y = law->c[1] / law->d, least = law->trace * RBDI_UNMOVED;
    const rbd_real xx = law->A[0] - x * law->c[0], xy = law->A[1] - x * law->c[1],
                   yy = law->A[2] - y * law->c[1];
    const rbd_real mean = (xx + yy) / 2, half = (xx - yy) / 2, radius = rbdi_sqrt(half * half + xy * xy);
    law->axis[0] = rbdi_set(RBD_C(1)), law->axis[1] = rbdi_zero();
    if (radius > 4 * RBDI_EPS * mean) {
        const rbd_real ax = half >= 0 ? half + radius : xy, ay = half >= 0 ? xy : radius - half;
        const rbd_real length = rbdi_sqrt(ax * ax + ay * ay);
        if (length > 0) law->axis[0] = ax / length, law->axis[1] = ay / length;
    }
    law->l[0] = mean + radius > least ? mean + radius : least;
    law->l[1] = mean - radius > least ? mean - radius : least;
    law->k[0] = law->axis[0] * x + law->axis[1] * y, law->k[1] = law->axis[0] * y - law->axis[1] * x;
}

/* A contact whose block of Delta starts at D; from one row to the next `stride`. */
RBDI_PART void rbdi_contact_prepare(rbdi_contact_law *law, const rbd_real *D, int stride, rbd_real friction) {
    const rbd_real *y = D + stride, *n = y + stride;
    law->trace = D[0] + y[1] + n[2];
    law->A[0] = D[0], law->A[1] = D[1], law->A[2] = y[1];
    law->c[0] = n[0], law->c[1] = n[1], law->d = n[2];
    law->friction = friction;
    law->alpha = law->e[0] = law->e[1] = rbdi_zero();
    law->state = law->d > law->trace * RBDI_UNMOVED ? RBD_OPENS : RBD_APART;
    if (law->state == RBD_APART) return;
    law->A[0] = law->A[0] + law->trace * RBDI_UNMOVED, law->A[2] = law->A[2] + law->trace * RBDI_UNMOVED;
    rbdi_contact_axes(law);
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
    rbdi_contact_trial x;
    x.t[0] = -s[0] / (law->l[0] + alpha), x.t[1] = -s[1] / (law->l[1] + alpha);
    x.normal = p0 - law->k[0] * x.t[0] - law->k[1] * x.t[1];
    x.size = rbdi_sqrt(x.t[0] * x.t[0] + x.t[1] * x.t[1]);
    return x;
}

/* What Newton's method on 1/|p_t| - 1/(mu p_n) adds to alpha. */
RBDI_INLINE rbd_real rbdi_slip_newton(const rbdi_contact_law *law, const rbdi_contact_trial *x,
                                      rbd_real alpha) {
    const rbd_real bound = law->friction * x->normal, r0 = x->t[0] / (law->l[0] + alpha),
                   r1 = x->t[1] / (law->l[1] + alpha);
    const rbd_real size_rate = -(x->t[0] * r0 + x->t[1] * r1) / x->size,
                   bound_rate = law->friction * (law->k[0] * r0 + law->k[1] * r1);
    return (1 / x->size - 1 / bound) / (size_rate / (x->size * x->size) - bound_rate / (bound * bound));
}

/* Finds the root of (1); law->alpha is the first guess, and becomes the root. s is not 0, nor is mu. */
RBDI_PART rbdi_contact_trial rbdi_slip_root(rbdi_contact_law *law, const rbd_real s[2], rbd_real p0) {
    const rbd_real mu = law->friction, size = rbdi_sqrt(s[0] * s[0] + s[1] * s[1]);
    rbd_real low = rbdi_zero(), alpha = law->alpha,
             high = size * (1 + mu * (rbdi_abs(law->k[0]) + rbdi_abs(law->k[1]))) / (mu * p0);
    rbdi_contact_trial x;
    if (!(alpha > 0 && alpha < high)) alpha = size / (mu * p0) - law->l[0]; /* as without coupling */
    if (!(alpha > 0 && alpha < high)) alpha = rbdi_zero();
    x = rbdi_contact_try(law, s, p0, alpha);
    for (int i = 0; i < RBDI_ROOT_STEPS; ++i) {
        const rbd_real excess = x.size - mu * x.normal;
        rbd_real next = alpha;
        if (excess > 0)
            low = alpha;
        else
            high = alpha;
        if (rbdi_abs(excess) <= 8 * RBDI_EPS * x.size || high - low <= 2 * RBDI_EPS * high) break;
        if (x.normal > 0) next = alpha + rbdi_slip_newton(law, &x, alpha);
        if (!(next > low && next < high))
            next = low > 0 && high > 16 * low ? rbdi_sqrt(low) * rbdi_sqrt(high) : (low + high) / 2;
        alpha = next;
        x = rbdi_contact_try(law, s, p0, alpha);
    }
    law->alpha = alpha;
    return x;
}

/* The impulse of a contact from w, and its state. */
RBDI_PART void rbdi_contact_impulse(rbdi_contact_law *law, const rbd_real w[3], rbd_real p[3]) {
    const rbd_real mu = law->friction;
    rbd_real p0, x, y, s[2];
    rbdi_contact_trial best;
    p[0] = p[1] = p[2] = rbdi_zero();
    law->state = RBD_OPENS;
    if (!(w[2] < 0)) return;
    p0 = -w[2] / law->d;
    x = w[0] + law->c[0] * p0, y = w[1] + law->c[1] * p0;
    s[0] = law->axis[0] * x + law->axis[1] * y, s[1] = law->axis[0] * y - law->axis[1] * x;
    best = rbdi_contact_try(law, s, p0, rbdi_zero());
    law->state = best.normal > 0 && best.size <= mu * best.normal ? RBD_STICKS : RBD_SLIPS;
    if (law->state == RBD_SLIPS) {
        rbd_real share;
        p[2] = p0;
        if (!(mu > 0)) return;
        best = rbdi_slip_root(law, s, p0);
        if (!(best.normal > 0)) best.normal = rbdi_zero();
        share = best.size > 0 ? mu * best.normal / best.size : rbdi_zero(); /* onto the cone exactly */
        best.t[0] = best.t[0] * share, best.t[1] = best.t[1] * share;
    }
    p[0] = law->axis[0] * best.t[0] - law->axis[1] * best.t[1];
    p[1] = law->axis[1] * best.t[0] + law->axis[0] * best.t[1];
    p[2] = best.normal;
}

/* ==== src/contact/laws.h ==== */
/* ---- laws [laws] ----
   All contacts and bounded rows together. A sweep of block Gauss-Seidel solves one after the other exactly.
   As a projection (Alart and Curnier 1991) the laws are p = P(z), z = p - u/d with the normal's d:

     opens    z_n <= 0                p = 0
     sticks   |z_t| <= mu z_n         p = z
     slips    else                    p = z_n (mu e + n), e = z_t/|z_t|
     bounded                          p = z, or the bound that z is behind

   The residual is the largest |p - P(z)| d: of an open contact d |p|, of one that sticks |u|, of one that slips
   |u_n| and d times the error of friction. It is in m/s and 0 only where all laws hold. */

/* u = b + Delta p. */
RBDI_PART void rbdi_contact_velocities(rbdi_contact_solver *s) {
    for (int r = 0; r < s->rows; ++r) s->u[r] = s->given.b[r], s->scratch[r] = -s->p[r];
    rbdi_subtract_product(s->scratch, s->given.delta, s->rows, s->rows, s->u);
}

/* Changes p of n rows from number `first` on to x, and u with it. */
RBDI_INLINE void rbdi_change_impulse(rbdi_contact_solver *s, int first, int n, const rbd_real *x) {
    for (int r = first; r < first + n; ++r) {
        const rbd_real less = s->p[r] - x[r - first];
        if (!(less < 0 || less > 0)) continue;
        s->p[r] = x[r - first];
        rbdi_subtract(s->u, less, &s->given.delta[r * s->rows], s->rows);
    }
}

RBDI_PART void rbdi_sweep_contact(rbdi_contact_solver *s, int i) {
    rbdi_contact_law *law = &s->law[i];
    rbd_real w[3], x[3];
    if (law->state == RBD_APART) return;
    rbdi_own_velocity(law, &s->p[3 * i], w);
    for (int j = 0; j < 3; ++j) w[j] = s->u[3 * i + j] - w[j];
    rbdi_contact_impulse(law, w, x);
    rbdi_change_impulse(s, 3 * i, 3, x);
}

/* z of bounded row number i, and P(z). */
RBDI_INLINE rbd_real rbdi_project_bounded(const rbdi_contact_solver *s, int i, rbd_contact_state *state) {
    const int r = 3 * s->given.contacts + i;
    const rbd_real d = s->given.delta[r * s->rows + r], z = d > 0 ? s->p[r] - s->u[r] / d : rbdi_zero();
    *state = RBD_OPENS;
    if (z <= s->given.lower[i]) return s->given.lower[i];
    if (z >= s->given.upper[i]) return s->given.upper[i];
    *state = d > 0 ? RBD_STICKS : RBD_APART;
    return z;
}

/* One sweep, from the first contact to the last row, or back. */
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

/* P(z) of a contact; its state, direction and alpha are those of z. */
RBDI_PART void rbdi_project_contact(rbdi_contact_law *law, const rbd_real *p, const rbd_real *u,
                                    rbd_real to[3]) {
    const rbd_real x = p[0] - u[0] / law->d, y = p[1] - u[1] / law->d, n = p[2] - u[2] / law->d,
                   size = rbdi_sqrt(x * x + y * y), most = law->friction * n;
    to[0] = to[1] = to[2] = rbdi_zero();
    law->state = RBD_OPENS;
    if (!(n > 0)) return;
    to[0] = x, to[1] = y, to[2] = n;
    law->state = RBD_STICKS;
    if (size <= most && law->friction > 0) return;
    law->state = RBD_SLIPS;
    law->e[0] = size > 0 ? x / size : rbdi_zero(), law->e[1] = size > 0 ? y / size : rbdi_zero();
    law->alpha = law->d * (size > RBDI_FASTEST_SLIP * most ? RBDI_FASTEST_SLIP : (size - most) / most);
    to[0] = most * law->e[0], to[1] = most * law->e[1];
}

/* The larger of two residuals; what is not a number counts as RBDI_UNBOUNDED. */
RBDI_INLINE rbd_real rbdi_worse(rbd_real worst, rbd_real error) {
    if (!(error < RBDI_UNBOUNDED)) return rbdi_set(RBDI_UNBOUNDED);
    return error > worst ? error : worst;
}

/* The states that z has, and the residual. */
RBDI_PART void rbdi_project_laws(rbdi_contact_solver *s) {
    rbd_real worst = rbdi_zero();
    for (int i = 0; i < s->given.contacts; ++i) {
        const rbd_real *p = &s->p[3 * i];
        rbdi_contact_law *law = &s->law[i];
        rbd_real to[3];
        if (law->state == RBD_APART) continue;
        rbdi_project_contact(law, p, &s->u[3 * i], to);
        for (int j = 0; j < 3; ++j) to[j] = to[j] - p[j];
        worst = rbdi_worse(worst, law->d * rbdi_sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]));
    }
    for (int i = 0; i < s->given.bounded; ++i) {
        const int r = 3 * s->given.contacts + i;
        const rbd_real x = rbdi_project_bounded(s, i, &s->bound[i]);
        worst = rbdi_worse(worst, s->given.delta[r * s->rows + r] * rbdi_abs(x - s->p[r]));
    }
    s->solution.residual = worst;
}

/* Puts p into cones and bounds, where iterations leave it outside by the tolerance. Returns whether p changed. */
RBDI_PART int rbdi_into_cones(rbdi_contact_solver *s) {
    int changed = 0;
    for (int i = 0; i < s->given.contacts; ++i) {
        rbd_real *p = &s->p[3 * i];
        const rbd_real size = rbdi_sqrt(p[0] * p[0] + p[1] * p[1]), most = s->law[i].friction * p[2];
        const int outside = s->law[i].state == RBD_APART || !(p[2] > 0);
        const rbd_real share = outside ? rbdi_zero() : most / size;
        if (!outside && !(size > most)) continue;
        changed |= p[2] < 0 || size > 0;
        p[0] = p[0] * share, p[1] = p[1] * share;
        if (outside) p[0] = p[1] = p[2] = rbdi_zero();
    }
    for (int i = 0; i < s->given.bounded; ++i) {
        rbd_real *p = &s->p[3 * s->given.contacts + i];
        if (*p < s->given.lower[i]) *p = s->given.lower[i], changed = 1;
        if (*p > s->given.upper[i]) *p = s->given.upper[i], changed = 1;
    }
    return changed;
}

/* ==== src/contact/newton.h ==== */
/* ---- newton [newton] ----
   Newton's method on p = P(z), whose states are held during a step. With kappa = mu z_n/|z_t| and t across e:

     opens    p = 0                 no unknown
     sticks   u = 0                 three unknowns
     slips    u_n = 0,  t'u + alpha t'p = 0,  alpha = (1 - kappa) d / kappa;  dp = (mu e + n) dp_n + t ds
     bounded  u = 0                 one, none at a bound                                                        (2)

   The second equation of a slip is the linearised direction: friction turns as u turns. With the columns S
   and the rows T of (2)

     G dx = -T'u,   G = T' Delta S + diag(alpha) + proximal diag(trace D),   p += S dx                          (3)

   `proximal` keeps G regular. Points on one rigid foot make Delta singular; with rounding alone on the diagonal
   a step wanders through its null space and the states never settle. It acts on the increments, not on p, so
   the solution is that of the laws as they are. S has mu e where T has none, so G is not symmetric: Gauss with
   row pivots. */

/* Unknown number n of row `first` and, of a contact, the two behind it. */
RBDI_INLINE rbdi_contact_unknown *rbdi_new_unknown(rbdi_contact_solver *s, int n, int first, int rows,
                                                   rbd_real scale) {
    rbdi_contact_unknown *x = &s->unknown[n];
    x->first = first, x->rows = rows, x->scale = scale;
    for (int j = 0; j < 3; ++j) x->column[j] = x->row[j] = rbdi_zero();
    x->alpha = rbdi_zero();
    return x;
}

/* One row whose u shall become 0. */
RBDI_INLINE void rbdi_plain_unknown(rbdi_contact_solver *s, int n, int row, rbd_real scale) {
    rbdi_contact_unknown *x = rbdi_new_unknown(s, n, row, 1, scale);
    x->column[0] = x->row[0] = rbdi_set(RBD_C(1));
}

/* Lists the unknowns (2); returns their number. */
RBDI_PART int rbdi_list_unknowns(rbdi_contact_solver *s) {
    int n = 0;
    for (int i = 0; i < s->given.contacts; ++i) {
        const rbdi_contact_law *law = &s->law[i];
        if (law->state == RBD_STICKS)
            for (int j = 0; j < 3; ++j) rbdi_plain_unknown(s, n++, 3 * i + j, law->trace);
        if (law->state == RBD_SLIPS) {
            rbdi_contact_unknown *x = rbdi_new_unknown(s, n++, 3 * i, 3, law->trace);
            x->column[0] = law->friction * law->e[0], x->column[1] = law->friction * law->e[1];
            x->column[2] = x->row[2] = rbdi_set(RBD_C(1));
        }
        if (law->state == RBD_SLIPS && law->friction > 0) {
            rbdi_contact_unknown *x = rbdi_new_unknown(s, n++, 3 * i, 3, law->trace);
            x->column[0] = x->row[0] = -law->e[1], x->column[1] = x->row[1] = law->e[0];
            x->alpha = law->alpha;
        }
    }
    for (int i = 0, r = 3 * s->given.contacts; i < s->given.bounded; ++i, ++r)
        if (s->bound[i] == RBD_STICKS) rbdi_plain_unknown(s, n++, r, s->given.delta[r * s->rows + r]);
    return n;
}

/* G and -T'u behind it, of n unknowns. */
RBDI_PART void rbdi_newton_matrix(rbdi_contact_solver *s, int n, rbd_const proximal) {
    for (int i = 0; i < n; ++i) {
        const rbdi_contact_unknown *x = &s->unknown[i];
        rbd_real *g = &s->G[i * (n + 1)], *row = s->scratch;
        rbdi_clear(row, s->rows); /* minus the row of T' Delta */
        g[n] = rbdi_zero();
        for (int j = 0; j < x->rows; ++j) {
            if (!(x->row[j] < 0 || x->row[j] > 0)) continue;
            rbdi_subtract(row, x->row[j], &s->given.delta[(x->first + j) * s->rows], s->rows);
            g[n] = g[n] - x->row[j] * s->u[x->first + j];
        }
        for (int k = 0; k < n; ++k) {
            const rbdi_contact_unknown *y = &s->unknown[k];
            g[k] = -row[y->first] * y->column[0];
            if (y->rows == 3)
                g[k] = g[k] - row[y->first + 1] * y->column[1] - row[y->first + 2] * y->column[2];
        }
        g[i] = g[i] + x->alpha + x->scale * proximal;
    }
}

/* The largest entry on or below the diagonal of column k comes to the diagonal. Returns 0 if there is none. */
RBDI_PART int rbdi_newton_pivot(rbdi_contact_solver *s, int n, int k) {
    rbd_real *own = &s->G[k * (n + 1)], *best = own;
    for (rbd_real *g = own; g < &s->G[n * (n + 1)]; g += n + 1)
        if (rbdi_abs(g[k]) > rbdi_abs(best[k])) best = g;
    for (int j = k; best != own && j <= n; ++j) {
        const rbd_real x = own[j];
        own[j] = best[j], best[j] = x;
    }
    return rbdi_abs(own[k]) > 0;
}

/* dx in place of the right-hand side. Returns 0 if G is singular. */
RBDI_PART int rbdi_newton_solve(rbdi_contact_solver *s, int n) {
    for (int k = 0; k < n; ++k) {
        const rbd_real *own = &s->G[k * (n + 1)];
        if (!rbdi_newton_pivot(s, n, k)) return 0;
        for (int i = k + 1; i < n; ++i) {
            rbd_real *g = &s->G[i * (n + 1)];
            rbdi_subtract(g + k + 1, g[k] / own[k], own + k + 1, n - k);
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        rbd_real *g = &s->G[k * (n + 1)], x = g[n];
        for (int j = k + 1; j < n; ++j) x = x - g[j] * s->G[j * (n + 1) + n];
        g[n] = x / g[k];
    }
    return 1;
}

/* Puts p where the states say: of open contacts to 0, of slipping ones on the cone along p_t. along_e: along e,
   and rows that are at a bound there; u belongs to p. */
RBDI_PART void rbdi_onto_cones(rbdi_contact_solver *s, int along_e) {
    for (int i = 0; i < s->given.contacts; ++i) {
        const rbdi_contact_law *law = &s->law[i];
        rbd_real *p = &s->p[3 * i], x = p[0], y = p[1], size;
        if (law->state == RBD_OPENS) p[0] = p[1] = p[2] = rbdi_zero();
        if (law->state != RBD_SLIPS) continue;
        if (!(p[2] > 0)) p[2] = rbdi_zero();
        if (along_e) x = law->e[0], y = law->e[1];
        size = rbdi_sqrt(x * x + y * y);
        size = size > 0 ? law->friction * p[2] / size : rbdi_zero();
        p[0] = x * size, p[1] = y * size;
    }
    for (int i = 0; along_e && i < s->given.bounded; ++i)
        if (s->bound[i] != RBD_STICKS)
            s->p[3 * s->given.contacts + i] = rbdi_project_bounded(s, i, &s->bound[i]);
}

/* p + S dx. */
RBDI_PART void rbdi_add_increments(rbdi_contact_solver *s, int n) {
    for (int i = 0; i < n; ++i) {
        const rbdi_contact_unknown *x = &s->unknown[i];
        const rbd_real dx = s->G[i * (n + 1) + n];
        for (int j = 0; j < x->rows; ++j) s->p[x->first + j] = s->p[x->first + j] + x->column[j] * dx;
    }
}

/* p as a step of all its length has it. Returns 0 if there is none. */
RBDI_PART int rbdi_newton_aim(rbdi_contact_solver *s, rbd_const proximal) {
    int n;
    rbdi_onto_cones(s, 1);
    rbdi_contact_velocities(s);
    n = rbdi_list_unknowns(s);
    rbdi_newton_matrix(s, n, proximal);
    if (!rbdi_newton_solve(s, n)) return 0;
    rbdi_add_increments(s, n);
    rbdi_onto_cones(s, 0);
    return 1;
}

RBDI_INLINE void rbdi_copy_rows(const rbdi_contact_solver *s, const rbd_real *from, rbd_real *to) {
    for (int r = 0; r < s->rows; ++r) to[r] = from[r];
}

/* A Newton step that makes the residual smaller, perhaps a shortened one. Returns 0, p, u and states as they
   were, if there is none. */
RBDI_PART int rbdi_newton_step(rbdi_contact_solver *s, rbd_const proximal) {
    const rbd_real before = s->solution.residual;
    rbd_const share = 1;
    rbdi_copy_rows(s, s->p, s->start);
    if (rbdi_newton_aim(s, proximal)) {
        rbdi_copy_rows(s, s->p, s->aim);
        for (int i = 0; i < RBDI_SHORTENINGS; ++i, share *= RBDI_SHORTEN_BY) {
            for (int r = 0; i > 0 && r < s->rows; ++r)
                s->p[r] = s->start[r] + (s->aim[r] - s->start[r]) * share;
            rbdi_contact_velocities(s);
            rbdi_project_laws(s);
            if (s->solution.residual < before * (i > 0 ? RBDI_SHORT_STEP_GAIN : RBDI_FULL_STEP_GAIN))
                return 1;
        }
    }
    rbdi_copy_rows(s, s->start, s->p);
    rbdi_contact_velocities(s);
    rbdi_project_laws(s);
    return 0;
}

/* ==== src/contact/solver.h ==== */
/* ---- solver code [solver code] ----
   One sweep, which is enough where contacts hardly feel each other; then Newton steps; where none makes the
   residual smaller, some sweeps, twice as many each time. The best p of all is kept. */

/* A Newton step, with a larger proximal term if that is needed. */
RBDI_PART int rbdi_newton_descends(rbdi_contact_solver *s) {
    const rbd_const proximal[3] = RBDI_PROXIMAL;
    ++s->solution.newton_steps;
    for (int i = 0; i < 3; ++i)
        if (rbdi_newton_step(s, proximal[i])) return 1;
    return 0;
}

RBDI_PART int rbdi_contact_left(const rbdi_contact_solver *s) {
    return s->given.iterations - s->solution.sweeps - s->solution.newton_steps;
}

/* Sweeps forth and back, up to n. */
RBDI_PART void rbdi_sweep_some(rbdi_contact_solver *s, int n) {
    while (n-- > 0 && rbdi_contact_left(s) > 0) rbdi_sweep_laws(s, n & 1);
    rbdi_project_laws(s);
}

/* u and the residual of p. */
RBDI_PART void rbdi_contact_judge(rbdi_contact_solver *s) {
    rbdi_contact_velocities(s);
    rbdi_project_laws(s);
}

/* Puts p into cones and bounds; whether the residual is within the tolerance there. */
RBDI_PART int rbdi_contact_solved(rbdi_contact_solver *s) {
    if (s->solution.residual > s->given.tolerance) return 0;
    if (rbdi_into_cones(s)) rbdi_contact_judge(s);
    return s->solution.residual <= s->given.tolerance;
}

/* p of a problem that is not solved: the best one, in cones and bounds; 0 if something has overflowed. */
RBDI_PART void rbdi_contact_give_up(rbdi_contact_solver *s) {
    rbdi_copy_rows(s, s->best, s->p);
    (void)rbdi_into_cones(s);
    rbdi_contact_judge(s);
    if (s->solution.residual < RBDI_UNBOUNDED) return;
    rbdi_clear(s->p, s->rows);
    (void)rbdi_into_cones(s);
    rbdi_contact_judge(s);
}

/* p and u of a problem that has been laid out, from p. */
RBDI_PART void rbdi_contact_iterate(rbdi_contact_solver *s) {
    rbd_real least = rbdi_set(RBDI_UNBOUNDED);
    s->solution.sweeps = s->solution.newton_steps = 0;
    rbdi_clear(s->best, s->rows);
    rbdi_contact_velocities(s);
    rbdi_sweep_some(s, 1);
    for (int sweeps = 2; !rbdi_contact_solved(s);) {
        if (s->solution.residual < least) least = s->solution.residual, rbdi_copy_rows(s, s->p, s->best);
        if (rbdi_contact_left(s) <= 0) {
            rbdi_contact_give_up(s);
            return;
        }
        if (rbdi_newton_descends(s)) continue;
        rbdi_sweep_some(s, sweeps);
        if (sweeps < RBDI_MOST_SWEEPS) sweeps *= 2;
    }
}

/* Cuts a solver's arrays off the memory. */
RBDI_PART void rbdi_lay_solver(rbdi_contact_solver *s, int contacts, int bounded, unsigned char *memory) {
    const int rows = 3 * contacts + bounded;
    rbd_real *x;
    s->law =
        (rbdi_contact_law *)rbdi_take(&memory, 1, RBDI_ROUND((size_t)contacts * sizeof(rbdi_contact_law)));
    s->bound =
        (rbd_contact_state *)rbdi_take(&memory, 1, RBDI_ROUND((size_t)bounded * sizeof(rbd_contact_state)));
    s->unknown = (rbdi_contact_unknown *)rbdi_take(&memory, 1,
                                                   RBDI_ROUND((size_t)rows * sizeof(rbdi_contact_unknown)));
    x = (rbd_real *)rbdi_take(&memory, rows * (rows + 6), sizeof(rbd_real));
    s->u = x, s->start = x + rows, s->aim = x + 2 * rows, s->best = x + 3 * rows, s->scratch = x + 4 * rows;
    s->G = x + 5 * rows;
}

/* A problem, and what of it does not change between iterations; the defaults. */
RBDI_PART void rbdi_contact_begin(rbdi_contact_solver *s, const rbd_contact_problem *given, rbd_real *p) {
    s->given = *given;
    s->rows = 3 * given->contacts + given->bounded;
    s->p = p;
    if (!(given->tolerance > 0)) s->given.tolerance = rbdi_set(RBDI_CONTACT_TOLERANCE);
    if (given->iterations == 0) s->given.iterations = RBDI_CONTACT_ITERATIONS;
    for (int i = 0; i < given->contacts; ++i)
        rbdi_contact_prepare(&s->law[i], &given->delta[3 * i * (s->rows + 1)], s->rows, given->friction[i]);
}

RBDI_PART int rbdi_all_finite(const rbd_real *x, int n) {
    for (int i = 0; i < n; ++i)
        if (!(x[i] - x[i] == 0)) return 0;
    return 1;
}

RBDI_PART rbd_status rbdi_check_problem(const rbd_contact_problem *a, const void *memory, size_t size,
                                        const rbd_real *p) {
    if (!a) return RBD_ERR_NULL;
    if (a->contacts < 0 || a->bounded < 0) return RBD_ERR_COUNT;
    if (!memory || (a->contacts && !a->friction) || (a->bounded && (!a->lower || !a->upper)))
        return RBD_ERR_NULL;
    if (a->contacts + a->bounded > 0 && (!a->delta || !a->b || !p)) return RBD_ERR_NULL;
    if (size < rbd_contact_solve_size(a->contacts, a->bounded)) return RBD_ERR_MEMORY;
    if (!(a->tolerance >= 0) || a->iterations < 0) return RBD_ERR_RANGE;
    for (int i = 0; i < a->contacts; ++i)
        if (!(a->friction[i] >= 0)) return RBD_ERR_RANGE;
    for (int i = 0; i < a->bounded; ++i)
        if (!(a->lower[i] <= a->upper[i])) return RBD_ERR_RANGE;
    return RBD_OK;
}

RBDI_API size_t rbd_contact_solve_size(int contacts, int bounded) {
    return contacts < 0 || bounded < 0 ? 0 : RBDI_CONTACT_SOLVER_BYTES(contacts, bounded);
}

RBDI_API rbd_status rbd_contact_solve(const rbd_contact_problem *problem, void *memory, size_t size,
                                      rbd_real *p, rbd_contact_state *state, rbd_contact_solution *solution) {
    const rbd_status status = rbdi_check_problem(problem, memory, size, p);
    rbdi_contact_solver s;
    if (status) return status;
    s.rows = 3 * problem->contacts + problem->bounded;
    if (!rbdi_all_finite(problem->b, s.rows) || !rbdi_all_finite(p, s.rows)) {
        rbdi_clear(p, s.rows);
        return RBD_ERR_NAN;
    }
    rbdi_lay_solver(&s, problem->contacts, problem->bounded, rbdi_aligned(memory));
    rbdi_contact_begin(&s, problem, p);
    rbdi_contact_iterate(&s);
    for (int i = 0; state && i < problem->contacts; ++i) state[i] = s.law[i].state;
    if (solution) *solution = s.solution;
    return RBD_OK;
}

/* ==== src/rbd_contact.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("B")
#pragma pop_macro("C")
#pragma pop_macro("D")
#pragma pop_macro("E")
#pragma pop_macro("F")
#pragma pop_macro("G")
#pragma pop_macro("H")
#pragma pop_macro("I")
#pragma pop_macro("J")
#pragma pop_macro("K")
#pragma pop_macro("L")
#pragma pop_macro("M")
#pragma pop_macro("N")
#pragma pop_macro("O")
#pragma pop_macro("P")
#pragma pop_macro("Q")
#pragma pop_macro("R")
#pragma pop_macro("S")
#pragma pop_macro("T")
#pragma pop_macro("U")
#pragma pop_macro("V")
#pragma pop_macro("W")
#pragma pop_macro("X")
#pragma pop_macro("Y")
#pragma pop_macro("Z")
