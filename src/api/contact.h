#ifndef RBDI_API_CONTACT_H
#define RBDI_API_CONTACT_H
#include "api/symbols.h"
#include "api/status.h"

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

#endif
