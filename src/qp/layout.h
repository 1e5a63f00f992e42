#ifndef RBDI_QP_LAYOUT_H
#define RBDI_QP_LAYOUT_H
#include "base/tolerances.h"
#include "base/pieces.h"
#include "api/qp.h"

/* Interface: rbdi_qp, rbdi_qp_shape */

/* ---- method [method] ----
   Minimise x'Hx/2 + f'x with n_i'x >= b_i, where the normal n_i of a row points into what is allowed: the
   row itself at its lower side, its negative at its upper one.

   H + rho 1 = L L', where rho is 0 or that of the proximal method. Equalities are eliminated first: their
   normals, L^-1 n, are reflected one by one onto the first axes. With Q the product of these reflections,

       J = L^-T Q [0; 1],   so that J'(H + rho 1) J = 1

   spans the space in which all equalities hold. The dual method of Goldfarb and Idnani (1983) works on J and
   on the normals N of the active rows, with R from J'N = [R; 0], as Powell (1985) gives it: x is always the
   optimum for the active rows alone, and each step takes in a row that x misses. Then with d = J'n, split
   behind the q active rows in d1 and d2, J = [J1 J2]:

       z = J2 d2        the way of x
       r = R^-1 d1      how fast the multipliers u of the active rows fall on that way

   A row joins by one reflection of d2 onto its first axis, which turns J2 too; it leaves by plane rotations.

   A soft row n'x + e >= b has a slack e, with the cost w e^2/2. It brings a column of its own to J, 0 in x
   and 1/sqrt(w) in e. Nothing of e is stored: e = u/w. */

/* Tolerances. None depends on the units of x or of a row, as long as their squares are normal numbers.
   RBDI_QP_DEPENDENT: sine of the angle, in the metric of H^-1, between a row and the active ones, below
   which it depends on them. RBDI_QP_ACCURACY: share of a row's terms that may be rounding. RBDI_QP_KEEP:
   share of the largest x so far that counts in those terms, until a refinement. RBDI_QP_PIVOT: share of a
   diagonal entry of H that its pivot must have. RBDI_QP_PROXIMAL: rho as a share of the largest diagonal
   entry of H, or without H of the least curvature of a soft row. RBDI_QP_WAY: how far a round goes without H,
   at least. RBDI_QP_ENOUGH: share of the accuracy at which its rounds end. RBDI_QP_FALL: share of its terms
   by which f must fall on a way without end, for rounding of the squares in H leaves less in doubt.
   RBDI_QP_CANCELLED: share of the largest x so far below which a solution of 0 is nothing but rounding. */
#if RBDI_REAL_KIND == 2
#define RBDI_QP_DEPENDENT 3e-5f
#define RBDI_QP_ACCURACY 1e-5f
#define RBDI_QP_KEEP 3e-2f
#define RBDI_QP_PIVOT 1e-5f
#define RBDI_QP_PROXIMAL 1e-3f
#define RBDI_QP_WAY 100
#define RBDI_QP_ENOUGH 1.0f
#define RBDI_QP_FALL 1e-1f
#define RBDI_QP_CANCELLED (64 * RBDI_EPS)
#else
#define RBDI_QP_DEPENDENT 1e-10
#define RBDI_QP_ACCURACY 1e-10
#define RBDI_QP_KEEP 1e-3
#define RBDI_QP_PIVOT 1e-12
#define RBDI_QP_PROXIMAL 1e-6
#define RBDI_QP_WAY 1000
#define RBDI_QP_ENOUGH 0.1
#define RBDI_QP_FALL 1e-8
#define RBDI_QP_CANCELLED (1000 * RBDI_EPS)
#endif
#define RBDI_QP_NONE ((rbd_real)RBD_QP_NONE)

/* Where the caller made H and C symmetric or zero. rbdi_qp_solve does not look there. */
typedef struct rbdi_qp_shape {
    int symmetric;   /* whether H is symmetric because of how it was made */
    int coupled;     /* H is diagonal from this variable on: only its diagonal is read there */
    int heads;       /* rows of C before this one are 0 from variable `coupled` on */
    int tails, rest; /* rows of C from `tails` to before `rest` are 0 before it */
} rbdi_qp_shape;

/* The state of one solution. A row is counted with the bounds. Matrices have no padding. */
typedef struct rbdi_qp {
    rbd_qp_problem given;
    rbd_qp_options options; /* all set */
    rbd_qp_result result;
    rbd_real *lambda;  /* of each row */
    signed char *side; /* of each row: -1, 0 or 1; 1 for an equality that is eliminated */
    rbdi_qp_shape shape;
    int n, all, soft;  /* variables, rows with bounds, soft rows */
    int watches;       /* rows that x may miss: not 0, with a side */
    int zeros;         /* rows of zeros */
    int equalities;    /* eliminated: the first reflections */
    int reflections;   /* equalities and active rows; of no use once there is J */
    int columns;       /* of J: n - equalities, and the slacks of active soft rows */
    int q;             /* active rows that are not eliminated */
    rbd_real rho;      /* added to H's diagonal */
    rbd_real own;      /* length of the last row that wanted to join, in the metric of H^-1 */
    rbd_real furthest; /* largest |x_k| so far */
    rbd_real accuracy; /* of rows: that of the options, and tenfold each time after `loosen` steps */
    rbd_real balance; /* the largest component of Hx + f + C'lambda, as a share of the largest of all terms */
    int doubtful;     /* rows contradict each other by what may be rounding, or sums overflow */
    int loosen;       /* the number of steps at which accuracy grows next */

    rbd_real *L; /* packed rows, its diagonal inverted */
    rbd_real *V; /* reflections x n: their vectors from the diagonal on; R of the equalities above */
    rbd_real *J; /* columns x n, each column a row here; NULL with no active row and no soft one */
    rbd_real *R; /* packed columns, its diagonal inverted */

    rbd_real *d, *r;   /* n + soft: see [method] */
    rbd_real *u;       /* q: multipliers, not negative but for equalities */
    rbd_real *length;  /* q: of active rows, in the metric of H^-1 */
    rbd_real *leaving; /* n + soft: column of R that leaves */
    rbd_real *x0;      /* n: optimum on the equalities alone */
    rbd_real *z;       /* n: way of x; scratch */
    rbd_real *reach;   /* n: largest |x| since the last refinement, which says how much has cancelled */
    rbd_real *centre;  /* n: of the proximal round */
    rbd_real *g;       /* n: f - rho centre */
    rbd_real *t;       /* n: scratch */
    rbd_real *beta;    /* reflections: 2/|v|^2 */
    rbd_real
        *cross; /* reflections: product of the vectors of reflection e, which is even, and the next one */
    rbd_real *diagonal; /* reflections: of their R, inverted */
    rbd_real *u_equal;  /* equalities: multipliers */
    rbd_real *unit;     /* of each row: 1 over its length */
    rbd_real *value;    /* of each row: the row times x; of a row that x cannot miss 0 */

    int *active;    /* q: rows */
    int *from, *to; /* of each row: where it is not 0 */
    int *watched;   /* watches: rows that x may miss */
    int *equality;  /* equalities: rows */
    int *first;     /* of each row of L: where it begins */
    int coupled;    /* rows of L: behind them it has nothing but its diagonal */
    int *last;      /* of each row of H: behind its last entry that is not 0, a multiple of four or n */
    int *end;       /* of each reflection: behind its last component */
} rbdi_qp;

RBDI_PART rbd_real *rbdi_qp_scalars(unsigned char **at, int count) {
    return (rbd_real *)rbdi_take(at, count, sizeof(rbd_real));
}
RBDI_PART int *rbdi_qp_ints(unsigned char **at, int count) {
    return (int *)rbdi_take(at, count, sizeof(int));
}

/* Gives each array its place in the memory. V and J lie in one: what is eliminated is no column of J. */
RBDI_PART void rbdi_qp_place(rbdi_qp *s, void *memory) {
    const int n = s->n, most = n + s->soft;
    const uintptr_t misaligned = (uintptr_t)memory % sizeof(rbd_real);
    unsigned char *at = (unsigned char *)memory + (misaligned ? sizeof(rbd_real) - misaligned : 0);

    s->V = rbdi_qp_scalars(&at, most * n);
    s->L = rbdi_qp_scalars(&at, n * (n + 1) / 2);
    s->R = rbdi_qp_scalars(&at, most * (most + 1) / 2);

    /* these four together have room for a group of vectors */
    s->d = rbdi_qp_scalars(&at, most);
    s->r = rbdi_qp_scalars(&at, most);
    s->leaving = rbdi_qp_scalars(&at, most);
    s->z = rbdi_qp_scalars(&at, n);

    s->u = rbdi_qp_scalars(&at, most);
    s->length = rbdi_qp_scalars(&at, most);
    s->x0 = rbdi_qp_scalars(&at, n);
    s->reach = rbdi_qp_scalars(&at, n);
    s->centre = rbdi_qp_scalars(&at, n);
    s->g = rbdi_qp_scalars(&at, n);
    s->t = rbdi_qp_scalars(&at, n);
    s->beta = rbdi_qp_scalars(&at, n);
    s->cross = rbdi_qp_scalars(&at, n);
    s->diagonal = rbdi_qp_scalars(&at, n);
    s->u_equal = rbdi_qp_scalars(&at, n);
    s->unit = rbdi_qp_scalars(&at, s->all);
    s->value = rbdi_qp_scalars(&at, s->all);

    s->active = rbdi_qp_ints(&at, most);
    s->from = rbdi_qp_ints(&at, s->all);
    s->watched = rbdi_qp_ints(&at, s->all);
    s->to = rbdi_qp_ints(&at, s->all);
    s->equality = rbdi_qp_ints(&at, n);
    s->first = rbdi_qp_ints(&at, n);
    s->last = rbdi_qp_ints(&at, n);
    s->end = rbdi_qp_ints(&at, n);
}

/* |x|, and 0 of -0. Compilers have one instruction for it. */
RBDI_INLINE rbd_real rbdi_qp_abs(rbd_real x) {
#if RBDI_GNU && RBDI_REAL_KIND == 2
    return __builtin_fabsf(x);
#elif RBDI_GNU
    return __builtin_fabs(x);
#else
    return x > 0 ? x : 0 - x;
#endif
}
RBDI_INLINE rbd_real rbdi_qp_larger(rbd_real a, rbd_real b) { return a > b ? a : b; }

/* The weight of a row, 0 if it is hard. */
RBDI_ONCE rbd_real rbdi_qp_weight(const rbdi_qp *s, int row) {
    return s->given.soft ? s->given.soft[row] : 0;
}
RBDI_ONCE int rbdi_qp_is_equality(const rbdi_qp *s, int row) {
    return s->given.lower[row] == s->given.upper[row];
}
/* The sign of the normal: 1 at the lower side, -1 at the upper one. */
RBDI_INLINE rbd_real rbdi_qp_sign(int side) { return side > 0 ? -1 : 1; }

/* The side at which an active row holds. */
RBDI_ONCE rbd_real rbdi_qp_side(const rbdi_qp *s, int row) {
    return s->side[row] > 0 ? s->given.upper[row] : s->given.lower[row];
}
/* Row of C, from where it is not 0; not for a bound. */
RBDI_INLINE const rbd_real *rbdi_qp_c(const rbdi_qp *s, int row) {
    return s->given.C + (row - s->given.bounds) * s->n + s->from[row];
}
/* Where the diagonal of L stands, inverted: the next one is i + 2 behind it. */
RBDI_INLINE int rbdi_qp_pivot(int i) { return i * (i + 3) / 2; }
RBDI_ONCE rbd_real *rbdi_qp_column(const rbdi_qp *s, int k) { return s->R + k * (k + 1) / 2; }
RBDI_INLINE rbd_real *rbdi_qp_j(const rbdi_qp *s, int k) { return s->J + k * s->n; }

#endif
