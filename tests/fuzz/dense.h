/* dense.h - the arbiter of the fuzzer of rbd_constraints.h: the rows of constraints by their definition, and
   constrained dynamics by dense matrices, orthogonal ones where ranks are judged. It stands on world.h, in
   long double, and shares nothing with the library but the descriptions. */
#ifndef DENSE_H
#define DENSE_H

#include "rbd_constraints.h"

#include "world.h"

enum { DENSE_ROWS = 64 };

/* Rows of constraints at a state of the world, in the order of the list: J, gamma = dJ/dt v, J v, position
   error e. Sizes are of what was added up for an entry. */
typedef struct dense_rows {
    int rows, nv;
    quad J[DENSE_ROWS][WORLD_DOFS], J_size[DENSE_ROWS][WORLD_DOFS];
    quad gamma[DENSE_ROWS], gamma_size[DENSE_ROWS];
    quad Jv[DENSE_ROWS], Jv_size[DENSE_ROWS];
    quad e[DENSE_ROWS], e_size[DENSE_ROWS];
    quad kd[DENSE_ROWS], kp[DENSE_ROWS];
} dense_rows;

/* world_move has been called without accelerations. */
void dense_rows_of(const world *s, const rbd_constraint *list, int n, const quad *v, dense_rows *out);

/* The same, with de/dq in place of J for single angular axes. */
void dense_slopes_of(const world *s, const rbd_constraint *list, int n, dense_rows *out);

/* Puts frame 2 where frame 1 is: e = 0. */
void dense_close(const world *s, rbd_constraint *k);

/* A symmetric positive definite matrix M and rows J. Row i is taken as J_i / scale_i: where `scaled`,
   scale_i^2 = J_i M^-1 J_i'; 1 where that is rounding. */
typedef struct dense {
    int nv, rows;
    quad L[WORLD_DOFS * WORLD_DOFS]; /* M = L L' */
    quad inverse[WORLD_DOFS];        /* diagonal of M^-1 */
    quad distance;                   /* of M from a singular one: world_distance */
    quad scale[DENSE_ROWS];
    quad least_share; /* least of scale_i over what J_size would make of it, rows without motion left out */
    quad A[DENSE_ROWS][WORLD_DOFS]; /* L^-1 J' scale^-1 V: orthogonal columns */
    quad V[DENSE_ROWS][DENSE_ROWS]; /* V[k]: combination of the scaled rows that has the singular value k */
    quad sigma[DENSE_ROWS];         /* singular values, the largest first */
} dense;

/* Returns 0 if M is not positive definite. */
int dense_factor(dense *d, const dense_rows *rows, const quad *M, const quad *M_size, int nv, int scaled);

/* How many singular values exceed a bound. */
int dense_rank(const dense *d, double bound);

/* x nearest to x0 in the norm of M with J x = b in the directions of the `rank` largest singular values;
   lambda of least norm with M (x - x0) = J' lambda; rest: what is left of J x - b, scaled rows. */
void dense_solve(const dense *d, const dense_rows *rows, int rank, const quad *x0, const quad *b, quad *x,
                 quad *lambda, quad *rest);

/* x = M^-1 f, and sqrt(x' M x) */
void dense_inverse(const dense *d, const quad *f, quad *x);
quad dense_norm(const dense *d, const quad *x);

/* Whether row i takes part in a combination of rows that has none of the `rank` largest singular values. */
int dense_depends(const dense *d, int rank, int i);

#endif
