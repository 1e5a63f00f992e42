#ifndef RBDI_CONTACT_LAYOUT_H
#define RBDI_CONTACT_LAYOUT_H
#include "base/types.h"
#include "api/contact.h"

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

#endif
