#ifndef RBDI_API_DYNAMICS_H
#define RBDI_API_DYNAMICS_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- dynamics [dynamics] ----
   q: nq, v, a, tau: nv, f_ext: nb x 6 or NULL. An output may be the same array as an input of the
   same shape, but must not overlap otherwise. All include armature; none includes damping and
   friction. Errors: RBD_ERR_NULL, RBD_ERR_WORK, and RBD_ERR_SINGULAR where said; there RBD_ERR_NAN too, and
   after either all results are 0.

   M is singular if one of its pivots is not above the rounding of the description and of the call's own
   terms: [guarantees]. A pivot below 1e-7 (float: 1e-3) of the largest inertia that its joint can move is
   in doubt. Then the call bounds its rounding to decide: rbd_aba takes up to six times as long. */

/* Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext. Recursive Newton-Euler, RBDA table 5.1. */
RBDI_API rbd_status rbd_rnea(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *a, const rbd_real *f_ext, rbd_real *tau);

/* Bias force c, the part of inverse dynamics that does not depend on a: velocity terms, gravity, minus
   external wrenches. rbd_rnea gives it at a = 0. */
RBDI_API rbd_status rbd_bias(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *f_ext, rbd_real *c);

/* Gravity torque g, which holds the robot still. rbd_rnea gives it at v = a = 0, without f_ext. */
RBDI_API rbd_status rbd_gravity_torque(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *g);

/* Generalized momentum p = M v and C' v, for a momentum observer, which detects contacts by dp/dt = tau +
   C' v - g + sum J' f_ext (De Luca and Mattone 2005). C is the Coriolis matrix of rbd_coriolis, for which
   dM/dt - 2 C is skew. No matrix is computed: p_i = S_i' h_i, (C' v)_i = (dS_i/dt)' h_i, h_i the momenta of
   the subtrees.
   p, ctv: nv; each may be NULL, not the same array. */
RBDI_API rbd_status rbd_generalized_momentum(const rbd_model *m, rbd_work *w, const rbd_real *q,
                                             const rbd_real *v, rbd_real *p, rbd_real *ctv);

/* Mass matrix M, nv x nv, both triangles. Composite rigid bodies, RBDA table 6.2. */
RBDI_API rbd_status rbd_crba(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *mass_matrix);

/* Mass matrix packed: rows of the lower triangle one after the other, rbd_packed_size(m) entries. Row i has
   the columns of its ancestors in the tree, root first, then i: all others are zero. With mimic joints the
   tree is the matrix's elimination tree, and some entries may be zero. */
RBDI_API rbd_status rbd_crba_packed(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *packed);

/* Number of entries of a packed matrix, at most nv (nv + 1) / 2. */
RBDI_API int rbd_packed_size(const rbd_model *m);

/* Index of entry (i, j) in a packed matrix; -1 if the tree makes it zero, or there is no such dof. */
RBDI_API int rbd_packed_index(const rbd_model *m, int i, int j);

/* Forward dynamics a = M^-1 (tau - c + sum J' f_ext). Articulated bodies, RBDA table 7.1. Also
   RBD_ERR_SINGULAR. Models with mimic joints are solved by rbd_fd_cholesky. */
RBDI_API rbd_status rbd_aba(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                            const rbd_real *tau, const rbd_real *f_ext, rbd_real *a);

#ifndef RBD_NO_CHOLESKY
/* Forward dynamics by mass matrix, bias and branch-sparse L'DL, RBDA ch. 6. Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_fd_cholesky(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *tau, const rbd_real *f_ext, rbd_real *a);

/* Hybrid dynamics, M a + c = tau + sum J' f_ext: of each degree of freedom either the acceleration or the
   torque is given, and the other computed. By the mass matrix, RBDA section 9.1. Of the dofs of one joint
   some may have a given, the others tau. If only a floating base's torque is given, rbd_id_free_base of
   rbd_derivatives.h is faster.
   given   nv flags: not 0 where a is given, 0 where tau is
   a, tau  in: what is given; out: all. Not the same array.
   Also RBD_ERR_SINGULAR, of the degrees of freedom whose torque is given; then a and tau are 0. */
RBDI_API rbd_status rbd_hybrid(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                               const unsigned char *given, rbd_real *a, rbd_real *tau, const rbd_real *f_ext);

/* Factors M = L' D L keeping the tree's zeros, RBDA section 6.5.
   mass_matrix   nv x nv, of this model's sparsity (as from rbd_crba; only the lower triangle is read)
   factor        packed like rbd_crba_packed: L below the diagonal, 1/D on it; rbd_packed_size(m) entries
   Both may be the same array. Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_cholesky_factor(const rbd_model *m, rbd_work *w, const rbd_real *mass_matrix,
                                        rbd_real *factor);

/* The same on a packed matrix, in place. Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_cholesky_factor_packed(const rbd_model *m, rbd_work *w, rbd_real *packed);

/* Solves M x = b with the factor. b, x: nv; may be the same. */
RBDI_API rbd_status rbd_cholesky_solve(const rbd_model *m, rbd_work *w, const rbd_real *factor,
                                       const rbd_real *b, rbd_real *x);

/* Solves M x = b for n right-hand sides, the columns of b. b, x: nv x n; may be the same. With n <= 0 it does
   nothing. With b = J', for a Jacobian J, J x is J M^-1 J'; columns of the identity give those of M^-1. */
RBDI_API rbd_status rbd_cholesky_solve_many(const rbd_model *m, rbd_work *w, const rbd_real *factor, int n,
                                            const rbd_real *b, rbd_real *x);

/* Inverse M^-1 of the mass matrix, nv x nv, both triangles, which are equal to the bit. From the factor of M,
   row by row (Takahashi, Fagan and Chin 1973). Also RBD_ERR_SINGULAR. */
RBDI_API rbd_status rbd_minverse(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *Minv);
#endif

/* Passive torque of the joints, tau_k = -damping_k v_k - friction_k sign(v_k), sign(0) = 0: add it to
   the tau given to forward dynamics, subtract it from the tau that inverse dynamics gives.
   A mimic joint's torque acts on the joint that it follows. v, tau: nv; may be the same array.
   Errors: RBD_ERR_NULL, _WORK. */
RBDI_API rbd_status rbd_passive(const rbd_model *m, rbd_work *w, const rbd_real *v, rbd_real *tau);

#endif
