/* textbook.h - the arbiter of the tests: rigid-body dynamics the plain way.
   It reads rbd_body rows directly, in the user's frames, and works with 6x6 matrices in long double.
   Every joint becomes a chain of links with constant motion subspaces (a universal joint: two
   revolutes), so there is nothing to derive by hand. RBDA = Featherstone, Rigid Body Dynamics
   Algorithms, 2008. Nothing here is shared with rbd.h but the description. */
#ifndef TEXTBOOK_H
#define TEXTBOOK_H

#include "rbd.h"

typedef long double tb_real;

enum { TB_MAX_BODIES = 40, TB_MAX_DOFS = 6 * TB_MAX_BODIES };

/* Body quantities: rows are bodies; R, p in the world, the rest in link axes. */
typedef struct tb_motion {
    tb_real R[TB_MAX_BODIES][9], p[TB_MAX_BODIES][3];
    tb_real velocity[TB_MAX_BODIES][6];
    tb_real acceleration[TB_MAX_BODIES][6]; /* without gravity */
    tb_real classical[TB_MAX_BODIES][6];
    tb_real kinetic, potential, mass;
    tb_real com[3], com_velocity[3], com_acceleration[3];
} tb_motion;

/* How many coordinates and degrees of freedom the joint of a body has (a mimic joint: none). */
int tb_nq(const rbd_body *body);
int tb_nv(const rbd_body *body);

/* Inverse dynamics, RBDA table 5.1. f_ext (nb x 6) and motion may be NULL. */
void tb_rnea(const rbd_body *bodies, int nb, const double gravity[3], const double *q, const double *v,
             const double *a, const double *f_ext, tb_real *tau, tb_motion *motion);

/* Mass matrix, nv x nv: column k is the torque of the acceleration e_k alone. */
void tb_mass_matrix(const rbd_body *bodies, int nb, const double *q, tb_real *M);

/* a = M^-1 (tau - c). Returns the condition number of M in the 1-norm, or -1 if M is not positive
   definite in this arithmetic. */
tb_real tb_forward(const rbd_body *bodies, int nb, const double gravity[3], const double *q, const double *v,
                   const double *tau, const double *f_ext, tb_real *a);

/* The same by articulated bodies, RBDA table 7.1: the plain twin of rbd.h's [aba]. Returns 0 if a pivot is
   not positive definite, or if the robot has mimic joints, which the table does not know. */
int tb_aba(const rbd_body *bodies, int nb, const double gravity[3], const double *q, const double *v,
           const double *tau, const double *f_ext, tb_real *a);

/* Inverse of a symmetric positive definite matrix by Cholesky; 0 if it is not positive definite. */
int tb_invert(const tb_real *M, int n, tb_real *inverse);

#endif
