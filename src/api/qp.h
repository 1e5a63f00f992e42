#ifndef RBDI_API_QP_H
#define RBDI_API_QP_H
#include "api/configuration.h"

/* The symbols name the scalar, so that files which differ in it do not link. */
#define RBDI_QP_SYMBOL(name) RBDI_PASTE(name, RBD_REAL)
#define rbd_qp_solve RBDI_QP_SYMBOL(rbd_qp_solve)
#define rbd_qp_text RBDI_QP_SYMBOL(rbd_qp_text)

/* ---- problem [problem] ---- */

#define RBD_QP_NONE 1e30 /* a bound of this size and more is none */

/* The result of rbd_qp_solve: 0, or a negative reason. x is finite with each of them, but as it was after
   RBD_QP_NULL, _RANGE and _MEMORY. */
typedef enum rbd_qp_status {
    RBD_QP_OK = 0,
    RBD_QP_INFEASIBLE = -1, /* hard rows contradict each other: lambda says which */
    RBD_QP_UNBOUNDED = -2,  /* unbounded below: f falls along a way that H does not bend and no row ends */
    RBD_QP_ITERATIONS = -3, /* more steps would be needed: x is as good as it got */
    RBD_QP_INACCURATE = -4, /* solved, but primal or dual is above ten times the accuracy */
    RBD_QP_CONVEX = -5,     /* H has a negative eigenvalue */
    RBD_QP_SYMMETRIC = -6,  /* H is not symmetric */
    RBD_QP_NAN = -7,        /* an input is not a number or not finite, or the result is too large */
    RBD_QP_RANGE = -8,      /* a number of the problem, a weight or an option is out of range */
    RBD_QP_MEMORY = -9,     /* the memory is too small */
    RBD_QP_NULL = -10,      /* a required pointer is NULL */
    RBD_QP_SIDES = -11      /* a lower side is above the upper one */
} rbd_qp_status;

/* Minimise x'Hx/2 + f'x, where each row r has lower <= row x <= upper. The first rows are bounds of x[0],
   x[1], ...; the others are rows of C. */
typedef struct rbd_qp_problem {
    int n;                 /* variables */
    int bounds;            /* of x[0] to x[bounds - 1], 0 to n */
    int rows;              /* of C */
    const rbd_real *H;     /* n x n, symmetric, positive definite or semidefinite */
    const rbd_real *f;     /* n */
    const rbd_real *C;     /* rows x n; may be NULL without rows */
    const rbd_real *lower; /* bounds + rows, -RBD_QP_NONE: none; equal to upper: an equality */
    const rbd_real *upper; /* bounds + rows, RBD_QP_NONE: none */
    const rbd_real
        *soft; /* bounds + rows, weights w > 0: a row that is missed by e costs w e^2 / 2; 0: a hard
                              row. NULL: all are hard */
} rbd_qp_problem;

/* 0 is the default in brackets. */
typedef struct rbd_qp_options {
    int steps;         /* rows that join or leave by steps, at most [10 (n + bounds + rows)] */
    int warm;          /* not 0: side is a guess, such as the result for a similar problem */
    int rounds;        /* of the proximal method, if H is semidefinite, at most [50] */
    rbd_real accuracy; /* of rows and optimum, a share of their terms [1e-10, float 1e-5] */
} rbd_qp_options;

typedef struct rbd_qp_result {
    int steps;       /* rows that joined or left */
    int rounds;      /* of the proximal method: 0 if H is definite */
    int active;      /* rows that hold, equalities too */
    rbd_real primal; /* the largest miss of a row, or distance of one that pushes from its side, as a share of
                        its terms: the side, and its entries times the largest x */
    rbd_real dual; /* the largest component of Hx + f + C'lambda, as a share of the largest term of the cost:
                        of Hx + f, or lambda of a soft row times the row; rounding of larger
                        multipliers counts as well */
    int at;        /* after an error the row, counted with the bounds, or the variable; -1: none */
    const char *field; /* after an error: of rbd_qp_problem or rbd_qp_options; NULL: none */
} rbd_qp_result;

/* ---- solve [solve] ---- */

/* Bytes of memory for n variables and this many bounds, rows of C and soft rows; a constant. */
#define RBD_QP_SIZE(n, bounds, rows, soft) \
    (sizeof(rbd_real) * \
         (((size_t)(n) + (size_t)(soft)) * (size_t)(n) + (size_t)(n) * ((size_t)(n) + 1) / 2 + \
          ((size_t)(n) + (size_t)(soft)) * ((size_t)(n) + (size_t)(soft) + 1) / 2 + 10 * (size_t)(n) + \
          5 * ((size_t)(n) + (size_t)(soft)) + 2 * ((size_t)(bounds) + (size_t)(rows))) + \
     sizeof(int) * (5 * (size_t)(n) + (size_t)(soft) + 3 * ((size_t)(bounds) + (size_t)(rows))) + \
     2 * sizeof(rbd_real))

/* Solves the problem by the dual active-set method of Goldfarb and Idnani (1983).
   options   NULL: all defaults
   memory    size bytes of any alignment, scratch: RBD_QP_SIZE
   x         n: the solution. With `warm` and a semidefinite H also where to begin
   lambda    bounds + rows: multipliers, Hx + f + C'lambda = 0 (a bound is a row of the identity): above 0
             where the upper side holds, below 0 at the lower one. After RBD_QP_INFEASIBLE a proof, after
             Farkas: lambda' rows = 0, but the sum of lambda times the side that it names is below 0; the
             rows with lambda != 0 contradict each other
   side      bounds + rows: -1 where the lower side holds, 1 the upper one, 0 neither; with `warm` the guess.
             Any guess will do
   result    may be NULL
   Errors: rbd_qp_status; result->at and ->field say where. */
RBDI_API rbd_qp_status rbd_qp_solve(const rbd_qp_problem *problem, const rbd_qp_options *options,
                                    void *memory, size_t size, rbd_real *x, rbd_real *lambda,
                                    signed char *side, rbd_qp_result *result);

/* Writes what a status and result say as a sentence, e.g. "row 3, field 'lower': above upper", cut to fit,
   always terminated. text: size bytes. Returns text. */
RBDI_API char *rbd_qp_text(rbd_qp_status status, const rbd_qp_result *result, char *text, size_t size);

#endif
