#ifndef RBDI_API_DERIVATIVES_H
#define RBDI_API_DERIVATIVES_H
#include "api/points.h"

#define rbd_derivatives_init RBDI_SYMBOL(rbd_derivatives_init)
#define rbd_derivatives_size RBDI_SYMBOL(rbd_derivatives_size)
#define rbd_momentum_matrix RBDI_SYMBOL(rbd_momentum_matrix)
#define rbd_com_jacobian RBDI_SYMBOL(rbd_com_jacobian)
#define rbd_jacobian_derivative RBDI_SYMBOL(rbd_jacobian_derivative)
#define rbd_relative_jacobian_derivative RBDI_SYMBOL(rbd_relative_jacobian_derivative)
#define rbd_coriolis RBDI_SYMBOL(rbd_coriolis)
#define rbd_id_free_base RBDI_SYMBOL(rbd_id_free_base)
#define rbd_id_derivatives RBDI_SYMBOL(rbd_id_derivatives)
#define rbd_gravity_torque_derivatives RBDI_SYMBOL(rbd_gravity_torque_derivatives)
#define rbd_keep_zeros RBDI_SYMBOL(rbd_keep_zeros)
#define rbd_fd_derivatives RBDI_SYMBOL(rbd_fd_derivatives)
#define rbd_regressor RBDI_SYMBOL(rbd_regressor)
#define rbd_energy_regressors RBDI_SYMBOL(rbd_energy_regressors)
#define rbd_body_parameters RBDI_SYMBOL(rbd_body_parameters)
#define rbd_set_parameters RBDI_SYMBOL(rbd_set_parameters)
#define rbd_check_parameters RBDI_SYMBOL(rbd_check_parameters)
#define rbd_integrate_derivatives RBDI_SYMBOL(rbd_integrate_derivatives)
#define rbd_difference_derivatives RBDI_SYMBOL(rbd_difference_derivatives)

/* ---- memory [memory] ---- */

typedef struct rbd_derivatives rbd_derivatives; /* scratch of one thread: see rbd_derivatives_init */

/* Prepares the memory that the calls of this header work in.
   w        a work of the model. The calls take its gravity and use its scratch, so no other thread may
            compute in it. They do not change the results of rbd_kinematics in it
   memory   size bytes of any alignment; RBD_DERIVATIVES_SIZE(nb, nv) always suffices, with mimic joints
            RBD_DERIVATIVES_SIZE_MIMIC(nb, nv)
   d        receives the structure, which lies inside memory: do not move it; NULL after an error
   It holds constants of the model: call it again when those have changed. With any other model every call
   returns RBD_ERR_WORK. Errors: RBD_ERR_NULL, _MEMORY, _WORK. */
RBDI_API rbd_status rbd_derivatives_init(const rbd_model *m, rbd_work *w, void *memory, size_t size,
                                         rbd_derivatives **d);

/* Bytes that rbd_derivatives_init needs for this model. */
RBDI_API size_t rbd_derivatives_size(const rbd_model *m);

/* Sizes in all calls below: q nq; v, a nv; f_ext nb x 6 or NULL. Errors: RBD_ERR_NULL, RBD_ERR_WORK. */

/* ---- momentum [momentum] ---- */

/* Centroidal momentum matrix A, 6 x nv: A v = (angular momentum about the centre of mass; linear momentum) of
   all bodies that a joint moves, world axes; and, unless it is NULL, A_dot_v = dA/dt v, 6: the momentum's
   rate is A a + A_dot_v. v may be NULL if A_dot_v is. Rotors count in neither. Orin,
   Goswami and Lee (2013). Its angular half needs mass: without any it is about the root. */
RBDI_API rbd_status rbd_momentum_matrix(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                        const rbd_real *v, rbd_real *matrix, rbd_real A_dot_v[6]);

/* Jacobian of the centre of mass of all bodies that a joint moves, J, 3 x nv: J v is its velocity in world
   axes. Zero if there is no mass. */
RBDI_API rbd_status rbd_com_jacobian(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                     rbd_real *jacobian);

/* ---- derivatives of Jacobians [jacobians] ----
   After rbd_kinematics or, for its bodies, rbd_body_kinematics, at its q and v, in the same work; without a
   call of rbd_derivatives_init. v = NULL there is v = 0, and the derivative is 0.
   Errors: RBD_ERR_NULL, _WORK, _INDEX, _ORDER. */

/* dJ/dt of the matrix J that rbd_jacobian gives with the same arguments, 6 x nv: J a + dJ/dt v is the rate of
   the components of the point's motion J v. In world axes it is the (domega/dt; classical acceleration) of
   rbd_point_acceleration; in link axes, which turn with omega, the acceleration lacks omega x velocity: of
   the link's origin it is rbd_body_acceleration. */
RBDI_API rbd_status rbd_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                            const rbd_real point[3], rbd_axes axes, rbd_real *J_dot);

/* dJ/dt of the matrix J that rbd_relative_jacobian gives with the same arguments, 6 x nv. */
RBDI_API rbd_status rbd_relative_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                                     const rbd_real point[3], int reference, rbd_axes axes,
                                                     rbd_real *J_dot);

/* ---- Coriolis matrix [coriolis] ---- */

/* The matrix C(q, v), nv x nv, with C v = c - g (rbd_bias without wrenches less rbd_gravity_torque) and
   dM/dt - 2 C skew: C = sum over the bodies of J' (I dJ/dt + B J),
   B x = (V x* I x - I (V x x) + x x* I V) / 2, with J the body's Jacobian and V its velocity. Among all
   such matrices it is the one without torsion: for joints whose v are rates of q it consists of Christoffel
   symbols. Echeandia and Wensing (2021). */
RBDI_API rbd_status rbd_coriolis(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                                 rbd_real *matrix);

/* ---- inverse dynamics with a free base [free base] ---- */

#ifndef RBD_NO_CHOLESKY
/* Inverse dynamics with floating bases (RBDA section 9.3), from the wrenches on the bases and the
   accelerations of all other joints. It takes a little more than half the instructions of rbd_hybrid.
   a       in: those of the joints; out: of floating bases too
   tau     in: the wrench on each floating base, 0 in flight; out: the torques of the joints too
   Without a floating base it is rbd_rnea. Also RBD_ERR_SINGULAR; then a and tau are 0. */
RBDI_API rbd_status rbd_id_free_base(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                     const rbd_real *v, rbd_real *a, rbd_real *tau, const rbd_real *f_ext);
#endif

/* ---- derivatives of inverse dynamics [inverse dynamics] ----
   Row = torque. Column k of a derivative by q: along rbd_integrate(q, t e_k) at t = 0, with the components of
   v and a held; for joints whose v are the rates of q that is d/dq_k. Column k of one by v: d/dv_k. External
   wrenches are held in the axes of their bodies, at their origins. For a unit quaternion p = (x, y, z, w) and
   its tangent step e, omega in body axes, dp = p (e/2, 0): the derivative by p is two times that by e with
   p' (conjugate) multiplied from the left, d/dp = 2 d/de vec(p' dp). */

/* Derivatives of tau = rbd_rnea(q, v, a, f_ext): dtau_dq and dtau_dv, nv x nv, and the mass matrix M =
   dtau/da, nv x nv. Any of the three may be NULL, and is then not computed. The common frame's form of
   Carpentier and Mansard (2018) and Singh, Russell and Wensing (2022). */
RBDI_API rbd_status rbd_id_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                       rbd_real *dtau_dq, rbd_real *dtau_dv, rbd_real *mass_matrix);

/* Derivative of the gravity torque rbd_gravity_torque(q) by q: dg_dq, nv x nv. */
RBDI_API rbd_status rbd_gravity_torque_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                                   rbd_real *dg_dq);

/* Matrices of these calls, of rbd_coriolis and of rbd_regressor are written whole. With keep other than 0
   the calls may leave out entries that are zero in all states, those of dofs on different branches and of
   bodies that a dof does not move, for a caller who cleared the matrix once. Not with mimic joints. Errors:
   RBD_ERR_NULL. */
RBDI_API rbd_status rbd_keep_zeros(rbd_derivatives *d, int keep);

/* ---- derivatives of forward dynamics [forward dynamics] ---- */

#ifndef RBD_NO_CHOLESKY
/* Derivatives of a = rbd_aba(q, v, tau, f_ext), as those above with the components of v and tau held: a, nv;
   da_dq, da_dv and da/dtau = Minv, nv x nv. Any of the four may be NULL, and is then not computed. da/dx =
   -M^-1 dtau/dx, the latter at a: Carpentier and Mansard (2018), here by the branch-sparse factor. a may be
   v or tau. Also RBD_ERR_SINGULAR, RBD_ERR_NAN; after either all results are 0. */
RBDI_API rbd_status rbd_fd_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *da_dq, rbd_real *da_dv, rbd_real *Minv);
#endif

/* ---- regressors and inertial parameters [identification] ----
   The ten parameters pi of a body: m, m c (3), and xx xy xz yy yz zz of the inertia about the link's origin,
   not the centre of mass; link axes. Torques and energies are linear in them (Atkeson, An and Hollerbach
   1986). */

/* Torque regressor Y, nv x 10 nb: rbd_rnea(q, v, a) without wrenches is Y pi + armature a, pi of all bodies
   one after the other. Columns of bodies that no joint moves are zero. */
RBDI_API rbd_status rbd_regressor(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                  const rbd_real *v, const rbd_real *a, rbd_real *regressor);

/* Energy regressors, 10 nb each, for rbd_energy's figures: kinetic = Y_kinetic pi + sum of armature v^2 / 2,
   potential = Y_potential pi. Either may be NULL; v may be NULL if Y_kinetic is. */
RBDI_API rbd_status rbd_energy_regressors(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                          const rbd_real *v, rbd_real *Y_kinetic, rbd_real *Y_potential);

/* The parameters of a body of the model, as it was described. Errors: RBD_ERR_NULL, _INDEX. */
RBDI_API rbd_status rbd_body_parameters(const rbd_model *m, int body, rbd_const pi[10]);

#ifndef RBD_NO_BUILD
/* Sets mass, com and inertia of a row of a description to these parameters. Without mass com becomes 0.
   Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_set_parameters(rbd_body *body, const rbd_const pi[10]);

/* Whether a body can have these parameters: RBD_OK if some distribution of mass does, else RBD_ERR_MASS
   (negative, or not a number), _COM (moment without mass) or _INERTIA (the second moment of mass about the
   centre of mass, tr(I)/2 - I, has a negative principal value beyond rounding). Errors: RBD_ERR_NULL.
   Traversaro et al. (2016); Wensing, Kim and Slotine (2018). */
RBDI_API rbd_status rbd_check_parameters(const rbd_const pi[10]);
#endif

/* ---- derivatives of steps on the configuration manifold [steps] ----
   The linearisation of a step, with a floating base too. Rows and columns: tangent components, as v;
   q and results move by rbd_integrate(q, t e_k). Either output may be NULL. Errors: RBD_ERR_NULL. */

/* Of q_next = rbd_integrate(q, v, dt) by q and by v: dnext_dq, dnext_dv, nv x nv. They do not depend on q. */
RBDI_API rbd_status rbd_integrate_derivatives(const rbd_model *m, const rbd_real *v, rbd_real dt,
                                              rbd_real *dnext_dq, rbd_real *dnext_dv);

/* Of d = rbd_difference(q0, q1) by q0 and by q1: dd_dq0, dd_dq1, nv x nv. */
RBDI_API rbd_status rbd_difference_derivatives(const rbd_model *m, const rbd_real *q0, const rbd_real *q1,
                                               rbd_real *dd_dq0, rbd_real *dd_dq1);

#endif
