/* rbd_derivatives.h - momentum and Coriolis matrix and first derivatives of a robot's dynamics, for rbd.h.
   Made by src/amalgamate.py from src/rbd_derivatives.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   All calls support every joint type, external wrenches, rotors, mimic joints and several roots. Include it
   as rbd.h: in ONE file

       #define RBD_IMPLEMENTATION
       #include "rbd_derivatives.h"

   and plain #include "rbd_derivatives.h" everywhere else; it includes rbd.h. [conventions], [configuration]
   and [guarantees] are those of rbd.h. Derivatives of the inverse dynamics at a state:

       unsigned char memory[RBD_DERIVATIVES_SIZE(NB, NV)];
       rbd_derivatives *d;
       rbd_derivatives_init(m, w, memory, sizeof memory, &d);
       rbd_id_derivatives(m, d, q, v, a, NULL, dtau_dq, dtau_dv, NULL);

   CONTENTS (search for the tag)
     [memory] [momentum] [jacobians] [coriolis] [free base] [inverse dynamics] [forward dynamics]
     [identification] [steps]
     --- stop here if you only use it ---
     [layout]
     [common frame] [batches] [common motion] [subtrees] [entries] [base entries] [matrices] [memory code]
     [momentum code] [coriolis code] [jacobians code]
     [free base code] [inverse dynamics code] [forward dynamics code] [identification code] [steps code]

   Begin with [common frame]: it has the formulas, and the fields of rbdi_columns are their numbers. Two
   sweeps fill these for every call: [common motion] from the roots to the leaves, [subtrees] back. Each
   call is then a loop over the columns.
*/
#include "rbd.h"

#ifndef RBD_DERIVATIVES_H
#define RBD_DERIVATIVES_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd_derivatives.h: belongs to another version of rbd.h"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/derivatives.h ==== */
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

/* ==== src/rbd_derivatives.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_DERIVATIVES_H */

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
#pragma push_macro("O")
#undef O
#pragma push_macro("P")
#undef P
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

/* ==== src/rbd_derivatives.h ==== */
#ifndef RBDI_DERIVATIVES_LAYOUT
#define RBDI_DERIVATIVES_LAYOUT

/* ==== src/derivatives/layout.h ==== */
/* ---- layout [layout] ----
   Users see it because RBD_DERIVATIVES_SIZE needs its sizes; they need no more of it. */

typedef struct rbdi_columns rbdi_columns;     /* of a batch of dofs: quantities that depend on the state */
typedef struct rbdi_constants rbdi_constants; /* of a batch of dofs: constants */

/* A chain of dofs without branches, each the parent of the next; or the dofs of one block. In this header
   dofs are numbered in the solver's order. */
typedef struct rbdi_segment {
    int16_t first, end; /* its dofs are first .. end - 1 */
    int16_t parent;     /* parent of the first dof, -1 = none */
    int16_t block;      /* whether it is a block */
    int16_t link;       /* link of the first dof */
    int16_t origin;     /* of a root: end of the dofs from it to the link of the common origin; else 0 */
} rbdi_segment;

/* A dof: its entries in the results, and its place among the lanes. */
typedef struct rbdi_entry {
    int16_t user;   /* the caller's dof: row and column of the results */
    int16_t end;    /* end of the dofs of its subtree */
    int16_t joint;  /* end of the dofs of its link */
    int16_t source; /* index of its velocity in v with mimic joints appended */
    int16_t parent; /* -1 = none */
    int16_t batch, lane;
    int16_t of_source; /* inverse of source: the dof whose source is this index */
    int32_t at;        /* index of its scalar in the first field of rbdi_columns, counted from d->columns */
    int32_t row;       /* index of its row in a square matrix */
} rbdi_entry;

/* A batch that has relatives of a dof, ancestors or dofs of its subtree, with a bit for the lane of each. */
typedef struct rbdi_relatives {
    int32_t batch;  /* -1 ends a list */
    int16_t row;    /* index of the batch's first scalar in a row of entries */
    int16_t whole;  /* in the first of a dof's three lists: they have all batches but those of a free base */
    uint64_t lanes; /* as wide as a lane of doubles, with which it is compared */
} rbdi_relatives;
enum { RBDI_ON_PATH = 0, RBDI_IN_SUBTREE = 16 }; /* first bits: a batch has at most 16 lanes */

struct rbd_derivatives {
    uint64_t shape[RBDI_SHAPE]; /* of the model */
    const rbd_model *model;
    rbd_work *work;
    int n;                 /* dofs, with those of mimic joints */
    int batches, segments; /* their numbers */
    int keep_zeros;        /* rbd_keep_zeros */
    int base;              /* dofs of a free base: 6 or 0 */
    int behind;            /* first batch of the dofs behind the base */
    rbdi_motion V;         /* velocity of the base, in its axes; linear 0 where a call leaves it out */
    rbdi_v3 minus_g;       /* -gravity, in the base's axes; 0 where a call leaves it out */
    rbdi_columns *columns; /* batches */
    rbdi_constants *constants;
    rbd_real *a;           /* n, forward dynamics: tau less the bias force, then the acceleration */
    rbdi_entry *entry;     /* n */
    rbdi_segment *segment; /* segments */
    int16_t *origin;       /* nl: root of the tree that has the common origin in this link, else -1 */
    rbdi_relatives
        *relatives;       /* n x 3 lists: batches with dofs on the path only, with both, in the subtree */
    uint64_t *lanes;      /* batches: bits as in rbdi_relatives, of one dof, while the lists are made */
    unsigned char *given; /* n: argument of rbd_hybrid in rbd_id_free_base */
    rbd_const mass;       /* of all bodies that a joint moves */
};

#define RBDI_COLUMN_SIZE 116 /* scalars of a dof in rbdi_columns */
#define RBDI_CONSTANT 17     /* in rbdi_constants */
#if defined RBD_LANES || RBDI_WIDEST_SIMD == 0
#define RBDI_SURPLUS 0
#define RBDI_RELATIVES(n, padded) 0
#else
#define RBDI_SURPLUS (2 * RBDI_CHUNK - 2) /* those of a free base and the others to whole batches */
#define RBDI_RELATIVES(n, padded) \
    ((size_t)(n) * ((size_t)(padded) / 2 + 3) * sizeof(rbdi_relatives) + \
     (size_t)(padded) / 2 * sizeof(uint64_t)) /* from 2 lanes on */
#endif

/* Bytes for nl links and n dofs, padded. */
#define RBDI_DERIVATIVES_BYTES(nl, n, padded) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_derivatives)) + \
     (size_t)(padded) * (RBDI_COLUMN_SIZE * sizeof(rbd_real) + RBDI_CONSTANT * sizeof(rbd_const)) + \
     (size_t)(n) * (sizeof(rbd_real) + sizeof(rbdi_entry) + 1) + \
     (size_t)(nl) * (sizeof(rbdi_segment) + sizeof(int16_t)) + RBDI_RELATIVES(n, padded))

/* Bytes that suffice for any model with nb bodies and nv degrees of freedom, without or with mimic joints
   (compile-time bounds; rbd_derivatives_size is exact, and less). */
#define RBD_DERIVATIVES_SIZE(nb, nv) RBDI_DERIVATIVES_BYTES(RBDI_LINKS(nb, nv), nv, (nv) + RBDI_SURPLUS)
#define RBD_DERIVATIVES_SIZE_MIMIC(nb, nv) \
    RBDI_DERIVATIVES_BYTES(RBDI_LINKS(nb, nv), (nb) + (nv), (nb) + (nv) + RBDI_SURPLUS)

/* ==== src/rbd_derivatives.h ==== */
#endif /* RBDI_DERIVATIVES_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_DERIVATIVES_IMPLEMENTED
#define RBDI_DERIVATIVES_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/algebra/batch_vectors.h ==== */
/* Vectors, motions and forces of batches. */

typedef struct rbdi_b3 {
    rbdi_batch x, y, z;
} rbdi_b3;

typedef struct rbdi_bmotion {
    rbdi_b3 omega, v;
} rbdi_bmotion;

typedef struct rbdi_bforce {
    rbdi_b3 n, f;
} rbdi_bforce;

/* rbdi_b_vec, rbdi_b_add and so on. */
#define RBDI_T rbdi_batch
#define rbdi_v3 rbdi_b3
#define rbdi_motion rbdi_bmotion
#define rbdi_force rbdi_bforce
#define rbdi_vec rbdi_b_vec
#define rbdi_add rbdi_b_add
#define rbdi_scale rbdi_b_scale
#define rbdi_cross rbdi_b_cross
#define rbdi_motion_add rbdi_b_motion_add
#define rbdi_force_add rbdi_b_force_add
#define rbdi_power rbdi_b_power
RBDI_INLINE rbdi_v3 rbdi_vec(RBDI_T x, RBDI_T y, RBDI_T z) {
    const rbdi_v3 v = {x, y, z};
    return v;
}

RBDI_INLINE rbdi_v3 rbdi_add(rbdi_v3 a, rbdi_v3 b) { return rbdi_vec(a.x + b.x, a.y + b.y, a.z + b.z); }
RBDI_INLINE rbdi_v3 rbdi_scale(RBDI_T k, rbdi_v3 a) { return rbdi_vec(k * a.x, k * a.y, k * a.z); }
RBDI_INLINE rbdi_v3 rbdi_cross(rbdi_v3 a, rbdi_v3 b) {
    return rbdi_vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

RBDI_INLINE rbdi_motion rbdi_motion_add(rbdi_motion a, rbdi_motion b) {
    a.omega = rbdi_add(a.omega, b.omega);
    a.v = rbdi_add(a.v, b.v);
    return a;
}

RBDI_INLINE rbdi_force rbdi_force_add(rbdi_force a, rbdi_force b) {
    a.n = rbdi_add(a.n, b.n);
    a.f = rbdi_add(a.f, b.f);
    return a;
}

/* S' f. */
RBDI_INLINE RBDI_T rbdi_power(rbdi_motion S, rbdi_force f) {
    return (f.n.x * S.omega.x + f.n.y * S.omega.y + f.n.z * S.omega.z) +
           (f.f.x * S.v.x + f.f.y * S.v.y + f.f.z * S.v.z);
}
#undef RBDI_T
#undef rbdi_v3
#undef rbdi_motion
#undef rbdi_force
#undef rbdi_vec
#undef rbdi_add
#undef rbdi_scale
#undef rbdi_cross
#undef rbdi_motion_add
#undef rbdi_force_add
#undef rbdi_power

/* ==== src/derivatives/columns.h ==== */
/* Interface: RBDI_OF */

/* ---- common frame [common frame] ----
   All quantities of a tree are in one frame. Its axes are those of the world. Its origin is the origin of the
   tree's first link that rotates, and it moves with the velocity that this point has now. Every frame that
   moves uniformly gives the same matrices. In this one the numbers do not grow with the distance and the
   speed of the robot, so their differences keep their digits. Seen from this frame the world moves with -v of
   that point.

   In one frame a recursion over the links is a sum: over the ancestors of a link or over its subtree. All
   else is computed for each dof alone. SIMD lanes are dofs, in the caller's order.

   A joint of several dofs is a chain of dofs without mass between them. All its dofs have the same link and
   the same parent. R = (ex ey ez) has the axes of the link, cycled so that the dof's own axis is ez; x is the
   link's origin. V and A are velocity and acceleration of the link, V_p and A_p those of its parent. (omega;
   v) and (omega_dot; a) are their two halves.

       S = (rho ez; x x rho ez + kappa ez)      rho, kappa = 1, 0 turns; 0, 1 slides; 1, pitch: a screw
       V = V_p + sum over the joint of S qd
       Psi = V_p x S                            rate of S, carried by the parent
       U = Psi + V x S                          with one dof 2 Psi
       A = A_p + sum over the joint of Psi qd + S qdd,   A of the world = (0; -gravity)
       Phi = A_p x S + V_p x Psi                rate of Psi, carried by the parent

   A link has mass m, first moment h_b and second moment Sigma_b, constants in its axes. They are the model's
   regrouped constants; bodies that move alike have the same momentum and wrench. About the common origin:

       h = R h_b + m x
       Sigma = R Sigma_b R' + x (R h_b)' + h x'
       X = [W_omega]x Sigma + W_v h'            the integral of x_dot x' dm
       P = m W_v + W_omega x h                  linear momentum, both at the velocity W
       f: the wrench (n; f) of rbd.h's [state] less the external ones, of
          Omega = [omega_dot]x + [omega]x [omega]x and acc = a + omega x v

   These 27 numbers and m are summed over the subtree of each link. The sums make two matrices:

       I = [tr(Sigma) - Sigma, [h]x; -[h]x, m]
       B = [tr(X) - X, 0; -[P]x, 0]             linear in W

   and these make the columns of each dof. Products of two columns are the entries of the results: [entries].

       F = I S
       D = B S + I U
       E = B Psi + I Phi + S x* f
       T = B' S                                 a moment; its force is 0

   W = 2 V: the papers have B at V, and 2 B in these lines. rbd_coriolis alone has W = V, and V x S for U.

   With a free base whose subtree has all other dofs (d->base) the frame has the axes of the base too. The S
   of the base's dofs are unit vectors there; [base entries] has their U and Phi. With the velocity (w; v) of
   the base, V = (w; 0) in this frame, and

       A = (w_dot; v_dot + w x v - gravity)

   RBDA 2.9, 2.10 and 5.3 have the two cross products, Echeandia and Wensing (2021) the matrix B. Columns and
   entries are those of Singh, Russell and Wensing (2022), after Carpentier and Mansard (2018). What the
   former call Psi_dot, Psi_ddot and S_dot is Psi, Phi and V x S here; their I^C, B^C and f^C are sums over
   subtrees. In these rooms U and D are not those of [aba], X is no pose and E no rotation, but for the E of
   poses. */

#if RBDI_BATCH > 1
typedef rbdi_batch rbdi_cbatch; /* a batch of constants */
#else
typedef rbd_const rbdi_cbatch;
#endif

typedef struct rbdi_b33 { /* rows of a matrix */
    rbdi_b3 x, y, z;
} rbdi_b33;

#if RBDI_GCC && RBDI_FOR_SPEED
#define RBDI_UNROLL_SUMS _Pragma("GCC unroll 14")
#else
#define RBDI_UNROLL_SUMS
#endif

/* Quantities that are summed over subtrees, in three groups of components. */
enum { RBDI_INERTIA_SUMS = 9, RBDI_MOMENTUM_SUMS = 12, RBDI_WRENCH_SUMS = 6 };
typedef struct rbdi_sums {
    rbdi_batch xx, xy, xz, yy, yz, zz; /* Sigma; with h the inertia */
    rbdi_b3 h;
    rbdi_b3 Xx, Xy, Xz; /* rows of X at W; with P the momentum */
    rbdi_b3 P;          /* at W */
    rbdi_bforce f;      /* the wrench */
} rbdi_sums;

/* A motion that is summed over ancestors. That of the link is p + joint. */
typedef struct rbdi_carried {
    rbdi_bmotion p;     /* of the parent link */
    rbdi_bmotion joint; /* the part of the joint */
} rbdi_carried;

/* Columns that only derivatives by q need. */
typedef struct rbdi_by_q {
    rbdi_bmotion Phi;
    rbdi_bforce E;
} rbdi_by_q;

/* The effect of accelerations qdd alone, at rest and without gravity. */
typedef struct rbdi_response {
    rbdi_carried A;
    rbdi_bforce F_qdd; /* of the dof, then summed over its subtree */
} rbdi_response;

/* The motion of a link. It gives the unit wrenches of the link's bodies. */
typedef struct rbdi_link_motion {
    rbdi_b3 omega, omega_dot, acc; /* acc: of the link-fixed point at the common origin */
    rbdi_b33 Omega;
} rbdi_link_motion;

struct rbdi_columns {
    rbdi_b3 ex, ey, ez; /* axes of the link */
    rbdi_b3 x;          /* its origin */
    rbdi_bmotion S;     /* motion of the link for a unit velocity of the dof. Of a free base constants: where
                           rbd_energy_regressors alone needs others, it writes these anew at its end */
    rbdi_carried V;     /* velocity */
    rbdi_bmotion Psi;   /* rate of S, carried by the parent */
    rbdi_bmotion U;     /* acceleration for a unit velocity of the dof, which I multiplies in D */
    rbdi_carried A;     /* acceleration, with -gravity of the world */
    rbdi_sums sum;      /* of the subtree; rbdi_sum_subtrees sums in place what each link has */
    rbdi_bforce F;      /* column of M */
    rbdi_bforce D;      /* column of the derivatives by v or, in rbd_coriolis, of C */
    rbdi_b3 T;          /* moment that gives entries of rows of the same matrix */
    rbdi_batch qd, qdd; /* velocity and acceleration of the dof, as given to the sweep */

    /* Memory of one step each. A call that takes two takes them one after the other. */
    union {
        rbdi_by_q by_q;         /* from rbdi_columns_by_q to the entries */
        rbdi_response response; /* rbdi_add_acceleration, before by_q */
        rbdi_link_motion link;  /* rbd_regressor */
        rbdi_bforce momentum;   /* rbdi_put_momenta: F in world axes, its moment about the centre of mass */
        rbdi_bmotion mover;     /* derivatives of constraints, after by_q: motion of a body by this dof, world
                                   axes, at the constraint's point */
    } stage;
};

struct rbdi_constants {
    rbdi_cbatch xx, xy, xz, yy, yz, zz, hx, hy, hz, m; /* Sigma_b, h_b, m: of a link's last dof, else 0 */
    rbdi_cbatch subtree;                               /* mass of the subtree */
    rbdi_cbatch rho, kappa;
    rbdi_cbatch all_hx, all_hy, all_hz, all_m; /* h and m of the bodies as described, before regrouping */
};

typedef char
    rbdi_columns_check[sizeof(rbdi_columns) == RBDI_COLUMN_SIZE * RBDI_BATCH * sizeof(rbd_real) ? 1 : -1];
typedef char
    rbdi_constants_check[sizeof(rbdi_constants) == RBDI_CONSTANT * RBDI_BATCH * sizeof(rbd_const) ? 1 : -1];

/* Index of a field in the scalars of rbdi_columns. */
#define RBDI_PLACE(field) (offsetof(rbdi_columns, field) / sizeof(rbd_real))

/* First component of a field of the first dof. Those of dof k are d->entry[k].at further. */
#define RBDI_FIELD(d, field) ((rbd_real *)(d)->columns + RBDI_PLACE(field))

/* First component of a field of dof k. The next components follow RBDI_BATCH scalars apart. */
#define RBDI_OF(d, k, field) (RBDI_FIELD(d, field) + (d)->entry[k].at)

/* The same of a constant of dof k. */
#define RBDI_CONSTANT_OF(d, k, field) \
    ((rbd_const *)&(d)->constants[(d)->entry[k].batch] + \
     offsetof(rbdi_constants, field) / sizeof(rbd_const) + (d)->entry[k].lane)

/* ---- vectors of batches [batches] ---- */

/* The vector in all lanes. */
RBDI_INLINE rbdi_b3 rbdi_b_all(rbdi_v3 a) {
    return rbdi_b_vec(rbdi_all_lanes(a.x), rbdi_all_lanes(a.y), rbdi_all_lanes(a.z));
}

/* a x b with a sum added: sums before products are contracted to FMA best. */
RBDI_INLINE rbdi_b3 rbdi_b_cross_add(rbdi_b3 sum, rbdi_b3 a, rbdi_b3 b) {
    return rbdi_b_vec(sum.x + a.y * b.z - a.z * b.y, sum.y + a.z * b.x - a.x * b.z,
                      sum.z + a.x * b.y - a.y * b.x);
}

/* a' x of a batch of vectors a and one vector x, and with a sum added. */
RBDI_INLINE rbdi_batch rbdi_b_dot(rbdi_b3 a, rbdi_v3 x) { return a.x * x.x + a.y * x.y + a.z * x.z; }

RBDI_INLINE rbdi_batch rbdi_b_dot_add(rbdi_batch sum, rbdi_b3 a, rbdi_v3 x) {
    return sum + a.x * x.x + a.y * x.y + a.z * x.z;
}

RBDI_INLINE rbdi_bmotion rbdi_b_motion_scale(rbdi_batch k, rbdi_bmotion a) {
    const rbdi_bmotion b = {rbdi_b_scale(k, a.omega), rbdi_b_scale(k, a.v)};
    return b;
}

/* V x S = (omega x S_omega; v x S_omega + omega x S_v), and with a sum added. */
RBDI_INLINE rbdi_bmotion rbdi_b_motion_cross(rbdi_bmotion V, rbdi_bmotion S) {
    rbdi_bmotion product;
    product.omega = rbdi_b_cross(V.omega, S.omega);
    product.v = rbdi_b_cross_add(rbdi_b_cross(V.v, S.omega), V.omega, S.v);
    return product;
}

RBDI_INLINE rbdi_bmotion rbdi_b_motion_cross_add(rbdi_bmotion sum, rbdi_bmotion V, rbdi_bmotion S) {
    sum.omega = rbdi_b_cross_add(sum.omega, V.omega, S.omega);
    sum.v = rbdi_b_cross_add(rbdi_b_cross_add(sum.v, V.v, S.omega), V.omega, S.v);
    return sum;
}

/* S' f of a batch of motions and one force, and of a batch of forces and one motion. */
RBDI_INLINE rbdi_batch rbdi_b_motion_dot(rbdi_bmotion S, rbdi_force F) {
    return rbdi_b_dot_add(rbdi_b_dot(S.omega, F.n), S.v, F.f);
}

RBDI_INLINE rbdi_batch rbdi_b_force_dot(rbdi_bforce F, rbdi_motion S) {
    return rbdi_b_dot_add(rbdi_b_dot(F.n, S.omega), F.f, S.v);
}

/* R (x; y; z) of constants in the axes of the links. */
RBDI_INLINE rbdi_b3 rbdi_b_rotate(const rbdi_columns *cols, rbdi_cbatch x, rbdi_cbatch y, rbdi_cbatch z) {
    const rbdi_b3 ex = cols->ex, ey = cols->ey, ez = cols->ez;
    return rbdi_b_vec(ex.x * x + ey.x * y + ez.x * z, ex.y * x + ey.y * y + ez.y * z,
                      ex.z * x + ey.z * y + ez.z * z);
}

/* E' a, of one matrix. */
RBDI_INLINE rbdi_b3 rbdi_b_mul_t(rbdi_mat E, rbdi_b3 a) {
    return rbdi_b_vec(a.x * E.xx + a.y * E.yx + a.z * E.zx, a.x * E.xy + a.y * E.yy + a.z * E.zy,
                      a.x * E.xz + a.y * E.yz + a.z * E.zz);
}

/* Copies so many scalars, a batch at a time. */
RBDI_INLINE void rbdi_copy(const rbd_real *x, int count, rbd_real *y) {
    int k = 0;
    for (; k + RBDI_BATCH <= count; k += RBDI_BATCH) *(rbdi_batch *)&y[k] = *(const rbdi_batch *)&x[k];
    for (; k < count; ++k) y[k] = x[k];
}

/* Copies the scalars of a batch that are left in an array: all or, of its last batch, the first ones. */
RBDI_INLINE void rbdi_copy_batch(const rbd_real *batch, int left, rbd_real *y) {
    rbdi_copy(batch, left < RBDI_BATCH ? left : RBDI_BATCH, y);
}

/* ==== src/derivatives/common_frame.h ==== */
/* ---- motion in the common frame [common motion] ---- */

/* The last dof of a link, in the solver's order. */
RBDI_INLINE int rbdi_last_dof(const rbd_model *m, int link) {
    return m->link[link].first + rbdi_link_dofs(m, &m->link[link]) - 1;
}

/* The axis of dof k of a link: 0 to 2 for x, y, z. */
RBDI_INLINE int rbdi_dof_axis(const rbd_model *m, const rbdi_link *l, int k) {
    return rbdi_is(l, RBDI_BLOCK) ? (rbdi_block_of(m, l)->first + k - l->first) % 3 : 2;
}

/* Stores axes and origin of a link for dof k. e: the axes, cycled so that the last is the dof's own. */
RBDI_INLINE void rbdi_put_axes(rbd_derivatives *d, int k, rbdi_v3 ex, rbdi_v3 ey, rbdi_v3 ez,
                               rbdi_v3 origin) {
    rbdi_store_vec(RBDI_OF(d, k, ex), RBDI_BATCH, ex);
    rbdi_store_vec(RBDI_OF(d, k, ey), RBDI_BATCH, ey);
    rbdi_store_vec(RBDI_OF(d, k, ez), RBDI_BATCH, ez);
    rbdi_store_vec(RBDI_OF(d, k, x), RBDI_BATCH, origin);
}

/* The same for the dofs of a block from k on. */
RBDI_PART void rbdi_put_block_axes(const rbd_model *m, rbd_derivatives *d, const rbdi_link *l, int k,
                                   const rbdi_pose *p) {
    const rbdi_v3 e[3] = {rbdi_vec(p->E.xx, p->E.xy, p->E.xz), rbdi_vec(p->E.yx, p->E.yy, p->E.yz),
                          rbdi_vec(p->E.zx, p->E.zy, p->E.zz)};

    for (; k < d->entry[l->first].joint; ++k) {
        const int axis = rbdi_dof_axis(m, l, k);
        rbdi_put_axes(d, k, e[(axis + 1) % 3], e[(axis + 2) % 3], e[axis], p->r);
    }
}

/* Pose of a link in the common frame, x_link = E (x - r), from its last dof. */
RBDI_INLINE rbdi_pose rbdi_common_pose(const rbd_model *m, const rbd_derivatives *d, int link) {
    const int last = rbdi_last_dof(m, link), axis = rbdi_dof_axis(m, &m->link[link], last);
    rbdi_v3 e[3];
    rbdi_pose pose;

    e[(axis + 1) % 3] = rbdi_load_vec(RBDI_OF(d, last, ex), RBDI_BATCH);
    e[(axis + 2) % 3] = rbdi_load_vec(RBDI_OF(d, last, ey), RBDI_BATCH);
    e[axis] = rbdi_load_vec(RBDI_OF(d, last, ez), RBDI_BATCH);

    pose.E.xx = e[0].x;
    pose.E.xy = e[0].y;
    pose.E.xz = e[0].z;
    pose.E.yx = e[1].x;
    pose.E.yy = e[1].y;
    pose.E.yz = e[1].z;
    pose.E.zx = e[2].x;
    pose.E.zy = e[2].y;
    pose.E.zz = e[2].z;
    pose.r = rbdi_load_vec(RBDI_OF(d, last, x), RBDI_BATCH);
    return pose;
}

/* Moves the common origin from the root's origin to that of link i, which is at x. */
RBDI_PART void rbdi_move_origin(const rbd_model *m, rbd_derivatives *d, int i, rbdi_v3 x) {
    for (int k = m->link[d->origin[i]].first; k < m->link[i].first; ++k)
        rbdi_store_vec(RBDI_OF(d, k, x), RBDI_BATCH,
                       rbdi_sub(rbdi_load_vec(RBDI_OF(d, k, x), RBDI_BATCH), x));
}

/* Axes and origins of all links. base: dofs of a free base whose axes the frame has, or 0. */
RBDI_PART void rbdi_poses(const rbd_model *m, rbd_derivatives *d, int base) {
    const int frame = base ? 0 : -1; /* the link, or the world, whose axes the common frame has */
    rbdi_pose p = rbdi_world_pose(); /* of the link before, then of link i */

    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];

        /* the parent's pose, unless p is that already */
        if (l->parent <= frame) {
            p = rbdi_world_pose();
        } else if (l->parent != i - 1) {
            p = rbdi_common_pose(m, d, l->parent);
        }

        /* link i's. A root block has the common origin, and a base its axes too */
        if (!rbdi_is(l, RBDI_BLOCK))
            RBDI_BY_FLAGS(const int flags, l,
                          p = rbdi_pose_step(l, flags, rbdi_trig_of(m, d->work, i, flags), p));
        else if (!rbdi_on_world(l))
            p = rbdi_pose_block(&d->work->block[l->block].X, p);
        else if (!base || i > 0)
            p.E = d->work->block[l->block].X.E;

        /* the common origin is that of this link */
        if (d->origin[i] >= 0) {
            if (d->origin[i] < i) rbdi_move_origin(m, d, i, p.r);
            p.r = rbdi_vec0();
        }

        /* of a base only the last dof, which has the inertia, needs axes */
        if (rbdi_is(l, RBDI_BLOCK)) {
            const rbdi_pose own = p; /* an address of p would keep it in memory */
            rbdi_put_block_axes(m, d, l, i == 0 && base ? base - 1 : l->first, &own);
        } else {
            rbdi_put_axes(d, l->first, rbdi_vec(p.E.xx, p.E.xy, p.E.xz), rbdi_vec(p.E.yx, p.E.yy, p.E.yz),
                          rbdi_vec(p.E.zx, p.E.zy, p.E.zz), p.r);
        }
    }
}

/* S = (rho ez; kappa ez + x x rho ez) of the dofs from batch b on. */
RBDI_PART void rbdi_motion_columns(rbd_derivatives *d, int b) {
    for (; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        const rbdi_b3 ez = cols->ez;
        const rbdi_b3 turn = rbdi_b_vec(ez.x * own->rho, ez.y * own->rho, ez.z * own->rho);
        const rbdi_b3 slide = rbdi_b_vec(ez.x * own->kappa, ez.y * own->kappa, ez.z * own->kappa);

        cols->S.omega = turn;
        cols->S.v = rbdi_b_cross_add(slide, cols->x, turn);
    }
}

/* Sums over ancestors: p of an rbdi_carried from the joints' parts.
   Vp      the first scalar of p in d->columns
   world   the motion of the roots' parent or, with a base, of the base
   moves   whether the motion is a velocity, which is taken relative to that of the common origin */
RBDI_INLINE void rbdi_sum_ancestors(rbd_derivatives *d, int base, rbd_real *Vp, rbdi_motion world,
                                    int moves) {
    const ptrdiff_t apart = offsetof(rbdi_carried, joint) / sizeof(rbd_real); /* from p to joint */
    const rbdi_entry *entry = d->entry;
    const rbdi_segment *seg = d->segment + (base > 0), *end = d->segment + d->segments;

    if (base) { /* as if its joint did not move */
        rbdi_store_motion(Vp + entry[base - 1].at, RBDI_BATCH, world);
        rbdi_store_motion(Vp + entry[base - 1].at + apart, RBDI_BATCH, rbdi_motion0());
    }

    for (; seg < end; ++seg) {
        rbdi_motion V = world;

        /* the motion of the parent, the last dof of another segment */
        if (seg->parent >= base) {
            const rbd_real *in = Vp + entry[seg->parent].at;
            V = rbdi_motion_add(rbdi_load_motion(in, RBDI_BATCH), rbdi_load_motion(in + apart, RBDI_BATCH));
        }

        /* of a root: that of the world, -v of the common origin */
        if (moves) {
            for (int k = seg->first; k < seg->origin; ++k)
                V.v = rbdi_sub(V.v, rbdi_load_vec(Vp + entry[k].at + apart + 3 * RBDI_BATCH, RBDI_BATCH));
        }

        /* of a block: all dofs have its p and its joint's sum */
        if (seg->block) {
            rbdi_motion all = rbdi_motion0();
            for (int k = seg->first; k < seg->end; ++k)
                all = rbdi_motion_add(all, rbdi_load_motion(Vp + entry[k].at + apart, RBDI_BATCH));
            for (int k = seg->first; k < seg->end; ++k) {
                rbdi_store_motion(Vp + entry[k].at, RBDI_BATCH, V);
                rbdi_store_motion(Vp + entry[k].at + apart, RBDI_BATCH, all);
            }
            continue;
        }

        /* of a chain: dof by dof */
        for (int k = seg->first; k < seg->end; ++k) {
            rbd_real *out = Vp + entry[k].at;
            RBDI_ONE_INDEX(out);
            rbdi_store_motion(out, RBDI_BATCH, V);
            V = rbdi_motion_add(V, rbdi_load_motion(out + apart, RBDI_BATCH));
        }
    }
}

/* Copies v or a into the lanes, which have the same order, from dof k on: 0, or the first behind a base. out:
   the first scalar of the field in d->columns. */
RBDI_INLINE void rbdi_spread(const rbd_derivatives *d, int k, const rbd_real *v, rbd_real *out) {
    const int n = d->n;

    for (; k < d->base; ++k) out[d->entry[k].at] = v[k];

    out += d->behind * RBDI_COLUMN_SIZE * RBDI_BATCH;
    for (; k < n; k += RBDI_BATCH, out += RBDI_COLUMN_SIZE * RBDI_BATCH) rbdi_copy_batch(v + k, n - k, out);
}

/* Quantities that a call needs beyond F. F depends on q only. */
enum {
    RBDI_NEED_V = 1,        /* D and T, from v */
    RBDI_NEED_WRENCH = 2,   /* sums of f, from v and a; then rbdi_columns_by_q gives Phi and E */
    RBDI_NEED_CORIOLIS = 4, /* W = V, not 2 V, for X and P; U = V x S */
    RBDI_NEED_WHOLE = 16    /* with the linear velocity of a free base and gravity, else both are 0 */
};

/* V_p, the joints' S qd, Psi = V_p x S and, if needed, U. */
RBDI_INLINE void rbdi_velocities(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *v,
                                 int need) {
    const int first = base ? d->behind : 0;
    rbdi_motion world = rbdi_motion0();
    if (base) world.omega = d->V.omega;

    rbdi_spread(d, base, rbdi_expand_v(m, v, d->work->vx), RBDI_FIELD(d, qd));
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        cols->V.joint = rbdi_b_motion_scale(cols->qd, cols->S);
    }

    rbdi_sum_ancestors(d, base, RBDI_FIELD(d, V), world, 1);

    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion V = rbdi_b_motion_add(cols->V.p, cols->V.joint), S = cols->S,
                           Psi = rbdi_b_motion_cross(cols->V.p, S);
        cols->Psi = Psi;

        if (need & RBDI_NEED_CORIOLIS)
            cols->U = rbdi_b_motion_cross(V, S);
        else if (need & RBDI_NEED_V)
            cols->U = rbdi_b_motion_cross_add(Psi, V, S);
    }
}

/* A_p and the joints' Psi qd + S qdd. The world accelerates by -gravity, a free base by
   (w_dot; v_dot + w x v - gravity). */
RBDI_INLINE void rbdi_accelerations(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *a,
                                    rbdi_c3 gravity) {
    const int first = base ? d->behind : 0;
    rbdi_motion A = rbdi_motion0();
    A.v = rbdi_sub(A.v, rbdi_vec_c(gravity));
    if (base) {
        A = rbdi_load_motion(a, 1);
        A.v = rbdi_add(rbdi_add(A.v, d->minus_g), rbdi_cross(d->V.omega, d->V.v));
    }

    rbdi_spread(d, base, rbdi_expand_v(m, a, d->work->ax), RBDI_FIELD(d, qdd));
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        cols->A.joint = rbdi_b_motion_add(rbdi_b_motion_scale(cols->qd, cols->Psi),
                                          rbdi_b_motion_scale(cols->qdd, cols->S));
    }

    rbdi_sum_ancestors(d, base, RBDI_FIELD(d, A), A, 0);
}

/* The sweep towards the leaves: the motion of all dofs. Reads v, a and gravity only if need asks for them. */
RBDI_INLINE void rbdi_common_motion(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *q,
                                    const rbd_real *v, const rbd_real *a, rbdi_c3 gravity, int need) {
    rbdi_joints(m, d->work, rbdi_expand_q(m, d->work, q));

    if (base && need) {
        d->V.omega = rbdi_load_vec(v, 1);
        d->V.v = d->minus_g = rbdi_vec0();
    }
    if (base && need & RBDI_NEED_WHOLE) {
        d->V.v = rbdi_load_vec(v + 3, 1);
        d->minus_g = rbdi_sub(d->minus_g, rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(gravity)));
    }

    rbdi_poses(m, d, base);
    rbdi_motion_columns(d, base ? d->behind : 0);
    if (need) rbdi_velocities(m, d, base, v, need);
    if (need & RBDI_NEED_WRENCH) rbdi_accelerations(m, d, base, a, gravity);
}

/* ==== src/derivatives/subtrees.h ==== */
/* ---- links, subtrees, columns [subtrees] ----
   From the motion of all dofs to their columns F, D, T, E: the inertia, momentum and wrench of each link,
   their sums over subtrees, and products of these with S, U, Psi, Phi. */

/* h = R h_b + m x, Sigma = R Sigma_b R' + x (R h_b)' + h x' of the links. col_x, col_y, col_z: R Sigma_b. */
RBDI_INLINE void rbdi_own_inertia(const rbdi_columns *cols, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 ex = cols->ex, ey = cols->ey, ez = cols->ez, x = cols->x;
    const rbdi_b3 h = rbdi_b_rotate(cols, own->hx, own->hy, own->hz),
                  col_x = rbdi_b_rotate(cols, own->xx, own->xy, own->xz),
                  col_y = rbdi_b_rotate(cols, own->xy, own->yy, own->yz),
                  col_z = rbdi_b_rotate(cols, own->xz, own->yz, own->zz);

    s->h = rbdi_b_vec(h.x + x.x * own->m, h.y + x.y * own->m, h.z + x.z * own->m);

    s->xx = col_x.x * ex.x + col_y.x * ey.x + col_z.x * ez.x + x.x * h.x + s->h.x * x.x;
    s->xy = col_x.x * ex.y + col_y.x * ey.y + col_z.x * ez.y + x.x * h.y + s->h.x * x.y;
    s->xz = col_x.x * ex.z + col_y.x * ey.z + col_z.x * ez.z + x.x * h.z + s->h.x * x.z;
    s->yy = col_x.y * ex.y + col_y.y * ey.y + col_z.y * ez.y + x.y * h.y + s->h.y * x.y;
    s->yz = col_x.y * ex.z + col_y.y * ey.z + col_z.y * ez.z + x.y * h.z + s->h.y * x.z;
    s->zz = col_x.z * ex.z + col_y.z * ey.z + col_z.z * ez.z + x.z * h.z + s->h.z * x.z;
}

/* X = [w]x Sigma + v h', P = m v + w x h of the links, W = (w; v). */
RBDI_INLINE void rbdi_own_momentum(rbdi_bmotion W, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 w = W.omega, v = W.v, h = s->h;
    const rbdi_b3 sx = rbdi_b_vec(s->xx, s->xy, s->xz), sy = rbdi_b_vec(s->xy, s->yy, s->yz),
                  sz = rbdi_b_vec(s->xz, s->yz, s->zz);

    s->Xx = rbdi_b_vec(w.y * sz.x - w.z * sy.x + v.x * h.x, w.y * sz.y - w.z * sy.y + v.x * h.y,
                       w.y * sz.z - w.z * sy.z + v.x * h.z);
    s->Xy = rbdi_b_vec(w.z * sx.x - w.x * sz.x + v.y * h.x, w.z * sx.y - w.x * sz.y + v.y * h.y,
                       w.z * sx.z - w.x * sz.z + v.y * h.z);
    s->Xz = rbdi_b_vec(w.x * sy.x - w.y * sx.x + v.z * h.x, w.x * sy.y - w.y * sx.y + v.z * h.y,
                       w.x * sy.z - w.y * sx.z + v.z * h.z);

    s->P = rbdi_b_cross_add(rbdi_b_vec(v.x * own->m, v.y * own->m, v.z * own->m), w, h);
}

/* Omega = [omega_dot]x + [omega]x [omega]x: rbdi_omega for batches, whose matrices are rows of vectors. */
RBDI_INLINE rbdi_b33 rbdi_b_omega(rbdi_b3 w, rbdi_b3 w_dot) {
    rbdi_b33 O;
    O.x = rbdi_b_vec(-(w.y * w.y + w.z * w.z), w.x * w.y - w_dot.z, w.x * w.z + w_dot.y);
    O.y = rbdi_b_vec(w.x * w.y + w_dot.z, -(w.x * w.x + w.z * w.z), w.y * w.z - w_dot.x);
    O.z = rbdi_b_vec(w.x * w.z - w_dot.y, w.y * w.z + w_dot.x, -(w.x * w.x + w.y * w.y));
    return O;
}

/* acc = a + omega x v. */
RBDI_INLINE rbdi_b3 rbdi_b_classical(rbdi_bmotion V, rbdi_bmotion A) {
    return rbdi_b_cross_add(A.v, V.omega, V.v);
}

/* The wrench that moves each link. rbdi_wrench has the same formula for one link with the model's constants,
   whose zeros it leaves out; here h and Sigma are about the common origin, and none is 0:

       f = Omega h + m acc,   n = (K_zy - K_yz; K_xz - K_zx; K_yx - K_xy),   K = Omega Sigma + acc h' */
RBDI_INLINE void rbdi_own_wrench(rbdi_bmotion V, rbdi_bmotion A, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 h = s->h, acc = rbdi_b_classical(V, A);
    const rbdi_b33 O = rbdi_b_omega(V.omega, A.omega);
    const rbdi_b3 n =
        rbdi_b_vec(O.z.x * s->xy + O.z.y * s->yy + (O.z.z - O.y.y) * s->yz - O.y.x * s->xz - O.y.z * s->zz,
                   O.x.y * s->yz + (O.x.x - O.z.z) * s->xz + O.x.z * s->zz - O.z.x * s->xx - O.z.y * s->xy,
                   O.y.x * s->xx + (O.y.y - O.x.x) * s->xy + O.y.z * s->xz - O.x.y * s->yy - O.x.z * s->yz);

    s->f.n = rbdi_b_cross_add(n, h, acc);
    s->f.f = rbdi_b_vec(O.x.x * h.x + O.x.y * h.y + O.x.z * h.z + acc.x * own->m,
                        O.y.x * h.x + O.y.y * h.y + O.y.z * h.z + acc.y * own->m,
                        O.z.x * h.x + O.z.y * h.y + O.z.z * h.z + acc.z * own->m);
}

/* Stores the sums that need asks for. */
RBDI_INLINE void rbdi_store_sums(const rbdi_sums *s, int need, rbdi_sums *out) {
    out->xx = s->xx;
    out->xy = s->xy;
    out->xz = s->xz;
    out->yy = s->yy;
    out->yz = s->yz;
    out->zz = s->zz;
    out->h = s->h;

    if (need & RBDI_NEED_V) {
        out->Xx = s->Xx;
        out->Xy = s->Xy;
        out->Xz = s->Xz;
        out->P = s->P;
    }

    if (need & RBDI_NEED_WRENCH) out->f = s->f;
}

/* Subtracts external wrenches from those of the links. */
RBDI_PART void rbdi_common_external(const rbd_model *m, rbd_derivatives *d, const rbd_real *f_ext) {
    const int bodies = f_ext ? m->nb : 0;

    for (int body = 0; body < bodies; ++body) {
        const rbdi_frame *u = &m->frame[body];
        rbdi_pose pose;
        rbdi_force F;
        rbd_real *out;
        if (u->link < 0) continue;

        /* from the body to its link, then to the common frame */
        pose.E = rbdi_mat_c(u->E);
        pose.r = rbdi_vec_c(u->r);
        F = rbdi_force_up_block(&pose, rbdi_load_force(f_ext + 6 * body, 1));
        pose = rbdi_common_pose(m, d, u->link);
        F = rbdi_force_up_block(&pose, F);

        out = RBDI_OF(d, rbdi_last_dof(m, u->link), sum.f);
        rbdi_store_force(out, RBDI_BATCH, rbdi_force_sub(rbdi_load_force(out, RBDI_BATCH), F));
    }
}

/* The first batch with a link's inertia, which the link's last dof has. */
RBDI_INLINE int rbdi_first_inertia(const rbd_derivatives *d, int base) {
    return base ? d->entry[base - 1].batch : 0;
}

/* Inertias, momenta and wrenches of the links, each alone. */
RBDI_INLINE void rbdi_own_sums(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *f_ext,
                               int need) {
    for (int b = rbdi_first_inertia(d, base); b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        rbdi_bmotion V;
        rbdi_sums s; /* not in place: what lies in memory is read again after every store */

        rbdi_own_inertia(cols, own, &s);
        if (need) V = rbdi_b_motion_add(cols->V.p, cols->V.joint);
        if (need & RBDI_NEED_WRENCH) rbdi_own_wrench(V, rbdi_b_motion_add(cols->A.p, cols->A.joint), own, &s);
        if (need & RBDI_NEED_V)
            rbdi_own_momentum(need & RBDI_NEED_CORIOLIS ? V : rbdi_b_motion_add(V, V), own, &s);
        rbdi_store_sums(&s, need, &cols->sum);
    }

    if (need & RBDI_NEED_WRENCH) rbdi_common_external(m, d, f_ext);
}

/* Sums so many components of a field over subtrees, for the segments from root on: at most 14, for which
   there are registers. x: the field's first scalar in d->columns. All dofs of a block get the sum of the
   block. Segments are taken one after the other: equal limbs as lanes, as HyQ's legs, took more time. */
RBDI_INLINE void rbdi_sum_components(rbd_derivatives *d, const rbdi_segment *root, rbd_real *x, int count) {
    for (const rbdi_segment *seg = d->segment + d->segments - 1; seg >= root; --seg) {
        const rbdi_entry *e = d->entry + seg->end - 1, *first = d->entry + seg->first;
        const rbd_real *last = x + e->at;
        rbd_real sum[14], *out;

        /* up the segment: each dof adds what it has */
        RBDI_ONE_INDEX(last);
        RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) sum[j] = last[j * RBDI_BATCH];
        while (e > first) {
            out = x + (--e)->at;
            RBDI_ONE_INDEX(out);
            RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) {
                sum[j] = sum[j] + out[j * RBDI_BATCH];
                out[j * RBDI_BATCH] = sum[j];
            }
        }

        /* a block: all of its dofs have the sum */
        if (seg->block) {
            for (e = first + 1; e < d->entry + seg->end; ++e) {
                out = x + e->at;
                RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) out[j * RBDI_BATCH] = sum[j];
            }
        }

        /* the parent's segment takes the sum too */
        if (seg->parent < 0) continue;
        out = x + d->entry[seg->parent].at;
        RBDI_ONE_INDEX(out);
        RBDI_UNROLL_SUMS for (int j = 0; j < count; ++j) out[j * RBDI_BATCH] = out[j * RBDI_BATCH] + sum[j];
    }
}

/* Sums all that need asks for. With all of it the 27 components go in two halves. */
RBDI_INLINE void rbdi_sum_subtrees(rbd_derivatives *d, const rbdi_segment *root, int need) {
    const int all = RBDI_INERTIA_SUMS + RBDI_MOMENTUM_SUMS + RBDI_WRENCH_SUMS, half = 14;
    const int wrench = need & RBDI_NEED_WRENCH;
    rbd_real *x = RBDI_FIELD(d, sum);

    if (need & RBDI_NEED_V) {
        rbdi_sum_components(d, root, x, half);
        rbdi_sum_components(d, root, x + half * RBDI_BATCH, all - half - (wrench ? 0 : RBDI_WRENCH_SUMS));
        return;
    }

    rbdi_sum_components(d, root, x, RBDI_INERTIA_SUMS);
    if (wrench) rbdi_sum_components(d, root, RBDI_FIELD(d, sum.f), RBDI_WRENCH_SUMS);
}

/* I V of a subtree, with V = (w; v) and tr(Sigma) - Sigma in I:

       n = (tr(Sigma) - Sigma) w + h x v,   f = m v + w x h */
RBDI_INLINE rbdi_bforce rbdi_inertia_times(const rbdi_sums *s, rbdi_cbatch mass, rbdi_bmotion V) {
    const rbdi_b3 w = V.omega, v = V.v;
    rbdi_bforce F;

    F.n = rbdi_b_vec((s->yy + s->zz) * w.x - s->xy * w.y - s->xz * w.z,
                     (s->xx + s->zz) * w.y - s->xy * w.x - s->yz * w.z,
                     (s->xx + s->yy) * w.z - s->xz * w.x - s->yz * w.y);
    F.n = rbdi_b_cross_add(F.n, s->h, v);
    F.f = rbdi_b_cross_add(rbdi_b_vec(v.x * mass, v.y * mass, v.z * mass), w, s->h);
    return F;
}

/* F + B S, which needs only w of S = (w; v): n + (tr(X) - X) w and f + w x P. */
RBDI_INLINE rbdi_bforce rbdi_subtree_B_add(rbdi_bforce F, const rbdi_sums *s, rbdi_b3 w) {
    const rbdi_b3 x = s->Xx, y = s->Xy, z = s->Xz;

    F.n = rbdi_b_vec(F.n.x + (y.y + z.z) * w.x - x.y * w.y - x.z * w.z,
                     F.n.y + (x.x + z.z) * w.y - y.x * w.x - y.z * w.z,
                     F.n.z + (x.x + y.y) * w.z - z.x * w.x - z.y * w.y);
    F.f = rbdi_b_cross_add(F.f, w, s->P);
    return F;
}

/* The moment of B' S: (tr(X) - X)' w + P x v of S = (w; v). */
RBDI_INLINE rbdi_b3 rbdi_subtree_B_t(const rbdi_sums *s, rbdi_bmotion S) {
    const rbdi_b3 x = s->Xx, y = s->Xy, z = s->Xz, w = S.omega;
    const rbdi_b3 n =
        rbdi_b_vec((y.y + z.z) * w.x - y.x * w.y - z.x * w.z, (x.x + z.z) * w.y - x.y * w.x - z.y * w.z,
                   (x.x + y.y) * w.z - x.z * w.x - y.z * w.y);

    return rbdi_b_cross_add(n, s->P, S.v);
}

/* F = I S and, if needed, T = B' S and D = B S + I U of a batch of dofs. */
RBDI_INLINE void rbdi_force_columns(rbdi_columns *cols, const rbdi_constants *own, int need) {
    const rbdi_sums *s = &cols->sum;
    const rbdi_bmotion S = cols->S;

    if (need & RBDI_NEED_V) {
        cols->T = rbdi_subtree_B_t(s, S);
        cols->D = rbdi_subtree_B_add(rbdi_inertia_times(s, own->subtree, cols->U), s, S.omega);
    }

    cols->F = rbdi_inertia_times(s, own->subtree, S);
}

/* Phi = A_p x S + V_p x Psi and E = B Psi + I Phi + S x* f of the dofs behind a free base, where
   S x* f = (S_omega x n + S_v x f; S_omega x f). */
RBDI_PART void rbdi_columns_by_q(rbd_derivatives *d) {
    for (int b = d->base ? d->behind : 0; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_sums *s = &cols->sum;
        const rbdi_bmotion S = cols->S, Phi = rbdi_b_motion_cross_add(rbdi_b_motion_cross(cols->A.p, S),
                                                                      cols->V.p, cols->Psi);
        const rbdi_bforce f = s->f;
        rbdi_bforce E =
            rbdi_subtree_B_add(rbdi_inertia_times(s, d->constants[b].subtree, Phi), s, cols->Psi.omega);

        E.n = rbdi_b_cross_add(rbdi_b_cross_add(E.n, S.omega, f.n), S.v, f.f);
        E.f = rbdi_b_cross_add(E.f, S.omega, f.f);

        cols->stage.by_q.Phi = Phi;
        cols->stage.by_q.E = E;
    }
}

/* The whole computation for one need, a constant unless at -Os: motion, then inertias, momenta and wrenches,
   their sums over subtrees, and the columns F, D and T. */
RBDI_INLINE void rbdi_common_of(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *q,
                                const rbd_real *v, const rbd_real *a, rbdi_c3 gravity, const rbd_real *f_ext,
                                int need, int whole) {
    rbdi_common_motion(m, d, base, q, v, a, gravity, need | whole);
    rbdi_own_sums(m, d, base, f_ext, need);
    rbdi_sum_subtrees(d, d->segment + (base > 0), need);

    for (int b = base ? d->behind : 0; b < d->batches; ++b)
        rbdi_force_columns(&d->columns[b], &d->constants[b], need);
}

/* The same for any need: q alone, C, the wrench alone, or all. With a free base the frame has its axes.
   Unless need has RBDI_NEED_WHOLE, the base's linear velocity and gravity are left out. */
RBDI_PART void rbdi_common(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                           const rbd_real *a, rbdi_c3 gravity, const rbd_real *f_ext, int need) {
    const int coriolis = RBDI_NEED_V | RBDI_NEED_CORIOLIS, all = RBDI_NEED_V | RBDI_NEED_WRENCH;
    const int base = d->base, whole = need & RBDI_NEED_WHOLE;
    need &= ~whole;

    if (RBDI_FOR_SPEED && !need)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, 0, 0);
    else if (RBDI_FOR_SPEED && need == coriolis)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, coriolis, 0);
    else if (RBDI_FOR_SPEED && need == RBDI_NEED_WRENCH)
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, RBDI_NEED_WRENCH, whole);
    else
        rbdi_common_of(m, d, base, q, v, a, gravity, f_ext, RBDI_FOR_SPEED ? all : need, whole);
}

/* The call's argument gravity without any. */
RBDI_INLINE rbdi_c3 rbdi_no_gravity(void) {
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    return none;
}

/* ==== src/derivatives/entries.h ==== */
/* ---- entries [entries] ----
   For dof j and every dof i of an ancestor link, or of j's own link if not said otherwise:

       M_ij = S_i' F_j                M_ji = M_ij
       dtau_i/dv_j = S_i' D_j         dtau_j/dv_i = T_j' S_i + F_j' U_i
       dtau_i/dq_j = S_i' E_j         dtau_j/dq_i = T_j' Psi_i + F_j' Phi_i

   and 0 for dofs of different branches. Within a joint the axes of i do not turn with those of j: there
   dtau_i/dq_j is the second formula of the last line with i and j exchanged (rbdi_put_block_entries). C has
   the formulas of dtau/dv, with columns of W = V, not 2 V: [columns].

   Rows are computed one at a time, with dofs as lanes. The entries of row i with dofs on the path from i to
   the root have the formulas on the right, those with dofs in i's subtree the formulas on the left. */

/* The caller's matrices: derivatives by q and by v (or C), and M. Bits for those that are wanted. */
enum { RBDI_BY_Q, RBDI_BY_V, RBDI_MASS, RBDI_RESULTS };
enum { RBDI_WANT_Q = 1 << RBDI_BY_Q, RBDI_WANT_V = 1 << RBDI_BY_V, RBDI_WANT_M = 1 << RBDI_MASS };
typedef struct rbdi_wanted {
    rbd_real *at[RBDI_RESULTS];
} rbdi_wanted;

/* Entries of a dof, whose columns are F and T, with a batch of dofs on its path. */
RBDI_INLINE void rbdi_entries_before(const rbdi_columns *cols, int want, rbdi_force F, rbdi_v3 T,
                                     rbdi_batch y[RBDI_RESULTS]) {
    if (want & RBDI_WANT_Q) {
        const rbdi_by_q *by_q = &cols->stage.by_q;
        y[RBDI_BY_Q] = rbdi_b_dot(cols->Psi.omega, T) + rbdi_b_motion_dot(by_q->Phi, F);
    }
    if (want & RBDI_WANT_V) y[RBDI_BY_V] = rbdi_b_dot(cols->S.omega, T) + rbdi_b_motion_dot(cols->U, F);
    if (want & RBDI_WANT_M) y[RBDI_MASS] = rbdi_b_motion_dot(cols->S, F);
}

/* Entries of a dof, whose column is S, with a batch of dofs in its subtree. */
RBDI_INLINE void rbdi_entries_behind(const rbdi_columns *cols, int want, rbdi_motion S,
                                     rbdi_batch y[RBDI_RESULTS]) {
    if (want & RBDI_WANT_Q) y[RBDI_BY_Q] = rbdi_b_force_dot(cols->stage.by_q.E, S);
    if (want & RBDI_WANT_V) y[RBDI_BY_V] = rbdi_b_force_dot(cols->D, S);
    if (want & RBDI_WANT_M) y[RBDI_MASS] = rbdi_b_force_dot(cols->F, S);
}

/* Adds the entries y of two dofs, one of each result, `stride` apart, to those of the joints that they
   follow. With mimic joints the velocities of all joints are G v, and each result is G' (.) G. */
RBDI_PART void rbdi_add_entry(const rbd_model *m, const rbdi_entry *row, const rbdi_entry *column,
                              const rbd_real *y, ptrdiff_t stride, rbdi_wanted out) {
    const rbd_real ratio = rbdi_ratio(m, row->source) * rbdi_ratio(m, column->source);

    for (int r = 0; r < RBDI_RESULTS; ++r) {
        rbd_real *to = out.at[r] ? out.at[r] + row->row + column->user : NULL;
        if (to) *to = *to + y[r * stride] * ratio;
    }
}

/* Replaces dtau_i/dq_j of dofs i before j of one block by T_i' Psi_j + F_i' Phi_j. */
RBDI_PART void rbdi_put_block_entries(const rbd_derivatives *d, rbd_real *by_q) {
    for (const rbdi_segment *seg = d->segment + (d->base > 0); seg < d->segment + d->segments; ++seg) {
        if (!seg->block) continue;

        for (int i = seg->first; i < seg->end; ++i) {
            const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
            const rbdi_v3 T = rbdi_load_vec(RBDI_OF(d, i, T), RBDI_BATCH);

            for (int j = i + 1; j < seg->end; ++j)
                by_q[d->entry[i].row + d->entry[j].user] =
                    rbdi_dot(T, rbdi_load_vec(RBDI_OF(d, j, Psi.omega), RBDI_BATCH)) +
                    rbdi_power(rbdi_load_motion(RBDI_OF(d, j, stage.by_q.Phi), RBDI_BATCH), F);
        }
    }
}

/* Adds the rotors' inertias to the diagonal of M. */
RBDI_PART void rbdi_add_armature(const rbd_derivatives *d, rbd_real *M) {
    for (int k = d->base; k < d->n; ++k) {
        const rbdi_entry *e = &d->entry[k];
        const rbd_real ratio = rbdi_ratio(d->model, e->source);
        M[e->row + e->user] = M[e->row + e->user] + ratio * ratio * d->model->dof[e->source].armature;
    }
}

#if RBDI_BATCH > 1
/* Length of a dof's three lists, which follow one another. */
RBDI_INLINE int rbdi_relatives_length(const rbd_derivatives *d) { return d->batches - d->behind + 3; }

RBDI_INLINE rbdi_relatives *rbdi_relatives_of(const rbd_derivatives *d, int i) {
    return d->relatives + d->entry[i].source * rbdi_relatives_length(d);
}

/* Mask of the lanes on the path (first = RBDI_ON_PATH), or of those in the subtree. */
RBDI_INLINE rbdi_bits rbdi_lanes_of(const rbdi_relatives *rel, int first) {
    rbdi_bits lanes;
    for (int j = 0; j < RBDI_BATCH; ++j) lanes[j] = (rbdi_bit)1 << (first + j);
    return (rbdi_bits)((lanes & (rbdi_bit)rel->lanes) == lanes); /* no table: loads take the time here */
}

/* Stores the wanted entries of a batch into a row, 0 in the other lanes. */
RBDI_INLINE void rbdi_put_lanes(const rbdi_batch *y, rbdi_bits lanes, int want, rbdi_wanted row,
                                ptrdiff_t at) {
    RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
        if (want >> r & 1) *(rbdi_batch *)(row.at[r] + at) = (rbdi_batch)((rbdi_bits)y[r] & lanes);
    }
}

/* The same of a batch in which some lanes are on the path, with entries y, others in the subtree, with z. */
RBDI_INLINE void rbdi_put_both(const rbdi_batch *y, const rbdi_batch *z, const rbdi_relatives *rel, int want,
                               rbdi_wanted row) {
    const rbdi_bits before = rbdi_lanes_of(rel, RBDI_ON_PATH), behind = rbdi_lanes_of(rel, RBDI_IN_SUBTREE);

    RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
        if (want >> r & 1)
            *(rbdi_batch *)(row.at[r] + rel->row) =
                (rbdi_batch)(((rbdi_bits)y[r] & before) | ((rbdi_bits)z[r] & behind));
    }
}

/* The row of the dof at e, from the columns behind a free base on. rel: its three lists, in a row. */
RBDI_INLINE void rbdi_put_row(const rbdi_columns *columns, const rbdi_entry *e, const rbdi_relatives *rel,
                              int want, rbdi_wanted row) {
    const rbd_real *own = (const rbd_real *)columns + e->at;
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());
    rbdi_batch y[RBDI_RESULTS] = {zero, zero, zero}, z[RBDI_RESULTS] = {zero, zero, zero};

    /* batches with dofs on the path only */
    if (rel->batch >= 0) {
        const rbdi_force F = rbdi_load_force(own + RBDI_PLACE(F), RBDI_BATCH);
        const rbdi_v3 T = rbdi_load_vec(own + RBDI_PLACE(T), RBDI_BATCH);
        do {
            rbdi_entries_before(columns + rel->batch, want, F, T, y);
            rbdi_put_lanes(y, rbdi_lanes_of(rel, RBDI_ON_PATH), want, row, rel->row);
        } while ((++rel)->batch >= 0);
    }

    /* with both */
    for (++rel; rel->batch >= 0; ++rel) {
        const rbdi_force F = rbdi_load_force(own + RBDI_PLACE(F), RBDI_BATCH);
        const rbdi_v3 T = rbdi_load_vec(own + RBDI_PLACE(T), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(own + RBDI_PLACE(S), RBDI_BATCH);
        rbdi_entries_before(columns + rel->batch, want, F, T, y);
        rbdi_entries_behind(columns + rel->batch, want, S, z);
        rbdi_put_both(y, z, rel, want, row);
    }

    /* with dofs in the subtree only */
    if ((++rel)->batch >= 0) {
        const rbdi_motion S = rbdi_load_motion(own + RBDI_PLACE(S), RBDI_BATCH);
        do {
            rbdi_entries_behind(columns + rel->batch, want, S, y);
            rbdi_put_lanes(y, rbdi_lanes_of(rel, RBDI_IN_SUBTREE), want, row, rel->row);
        } while ((++rel)->batch >= 0);
    }
}

/* 0 in n entries of a row, up to whole batches. */
RBDI_INLINE void rbdi_clear_row(int n, int want, rbdi_wanted row) {
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());

    for (int k = 0; k < n; k += RBDI_BATCH) {
        RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
            if (want >> r & 1) *(rbdi_batch *)(row.at[r] + k) = zero;
        }
    }
}

/* Stores the rows of all dofs behind a free base, in the caller's order. The last batch of a row may
   overwrite the beginning of the next row, which is stored later, as are the columns of a base. A row whose
   last batch would pass the end of the matrix is computed in scratch memory and copied. */
RBDI_INLINE void rbdi_put_rows_in_place(const rbd_derivatives *d, int want, int zeros, rbdi_wanted out) {
    const int base = d->base, n = d->n - base, last = d->n * d->n - (d->batches - d->behind) * RBDI_BATCH;
    const ptrdiff_t length = rbdi_relatives_length(d), stride = rbdi_stride(d->model);
    const rbdi_columns *columns = d->columns; /* copies: the compiler cannot know that no store changes d */
    const rbdi_entry *entry = d->entry;
    const rbdi_relatives *list = d->relatives + base * length;
    rbd_real *spare = d->work->F;

    for (const rbdi_entry *p = entry + base, *end = entry + d->n; p < end; ++p, list += length) {
        const rbdi_entry *e = entry + p->of_source;
        const int at = e->row + base, fits = at <= last;
        rbdi_wanted row = out;

        RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
            if (want >> r & 1) row.at[r] = fits ? out.at[r] + at : spare + r * stride;
        }

        if (!list->whole && (zeros || !fits)) rbdi_clear_row(n, want, row);
        rbdi_put_row(columns, e, list, want, row);

        if (fits) continue;
        RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
            if (want >> r & 1) rbdi_copy(row.at[r], n, out.at[r] + at);
        }
    }
}

/* The same with mimic joints: entries are added to those of the sources. */
RBDI_PART void rbdi_add_rows(const rbd_derivatives *d, int want, rbdi_wanted out) {
    const ptrdiff_t stride = rbdi_stride(d->model);
    const rbd_real *x = d->work->F;
    rbdi_wanted row = out;
    for (int r = 0; r < RBDI_RESULTS; ++r) row.at[r] = d->work->F + r * stride;

    for (int i = 0; i < d->n; ++i) {
        const rbdi_entry *e = d->entry + i;
        rbdi_put_row(d->columns, e, rbdi_relatives_of(d, i), want, row);

        for (int k = e->parent; k >= 0; k = d->entry[k].parent)
            rbdi_add_entry(d->model, e, d->entry + k, x + d->entry[k].source, stride, out);
        for (int k = i; k < e->end; ++k)
            rbdi_add_entry(d->model, e, d->entry + k, x + d->entry[k].source, stride, out);
    }
}

/* Stores the rows of all dofs behind a free base. zeros: also the entries of dofs on different branches,
   which are 0. */
RBDI_INLINE void rbdi_put_rows(const rbd_derivatives *d, int want, int zeros, rbdi_wanted out) {
    if (rbdi_mimics(d->model))
        rbdi_add_rows(d, want, out);
    else
        rbdi_put_rows_in_place(d, want, zeros, out);
}
#else
/* Stores or, with mimic joints, adds the entries y of two dofs. */
RBDI_INLINE void rbdi_put_entry(const rbd_model *m, const rbdi_entry *row, const rbdi_entry *column, int want,
                                const rbd_real *y, rbdi_wanted out) {
    if (rbdi_mimics(m)) {
        rbdi_add_entry(m, row, column, y, 1, out);
        return;
    }

    RBDI_UNROLL_SIX for (int r = 0; r < RBDI_RESULTS; ++r) {
        if (want >> r & 1) (out.at[r] + row->row)[column->user] = y[r];
    }
}

/* Stores the rows of all dofs behind a free base. The other entries are 0 already. */
RBDI_INLINE void rbdi_put_rows(const rbd_derivatives *d, int want, int zeros, rbdi_wanted out) {
    const rbdi_entry *e = d->entry;
    const rbd_real o = rbdi_zero();
    (void)zeros;

    for (int i = d->base; i < d->n; ++i) {
        const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
        const rbdi_v3 T = rbdi_load_vec(RBDI_OF(d, i, T), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(RBDI_OF(d, i, S), RBDI_BATCH);
        rbd_real y[RBDI_RESULTS] = {o, o, o};

        for (int k = e[i].parent; k >= d->base; k = e[k].parent) {
            rbdi_entries_before(&d->columns[e[k].batch], want, F, T, y);
            rbdi_put_entry(d->model, e + i, e + k, want, y, out);
        }
        for (int k = i; k < e[i].end; ++k) {
            rbdi_entries_behind(&d->columns[e[k].batch], want, S, y);
            rbdi_put_entry(d->model, e + i, e + k, want, y, out);
        }
    }
}
#endif

/* ==== src/derivatives/base_entries.h ==== */
/* ---- entries of a free base [base entries] ----
   The frame has the axes of the base, and the S of its dofs are unit vectors. So the entries of its rows are
   components of F_j, D_j, E_j. With the velocity (w; v) of the base, its turn theta, the world's acceleration
   minus_g, and (n; f) = F_j, its dofs have

       U = (w; -v) x S,   Phi = (0; minus_g x S_omega)

   and the base's columns of the other rows are

       dtau_j/dw = T_j + n_j x w - f_j x v
       dtau_j/dv = f_j x w
       dtau_j/dtheta = f_j x minus_g

   The position of the base has no effect. Without this, derivatives of inverse dynamics take 50 % more
   instructions for HyQ, 17 % for Atlas. */

/* The wanted columns F, D, E of a free base's dofs, with the sums of the whole tree:

       F = I S,   D = B S + I U,   E = I Phi = (h x Phi_v; m Phi_v) */
RBDI_INLINE void rbdi_base_columns(const rbd_derivatives *d, int want) {
    const int last = d->base - 1;
    const rbdi_b3 minus_g = rbdi_b_all(d->minus_g);
    rbdi_bmotion V;
    rbdi_sums s;
    V.omega = rbdi_b_all(d->V.omega);
    V.v = rbdi_b_all(rbdi_sub(rbdi_vec0(), d->V.v));

    /* the sums in all lanes */
    s.xx = rbdi_all_lanes(*RBDI_OF(d, last, sum.xx));
    s.xy = rbdi_all_lanes(*RBDI_OF(d, last, sum.xy));
    s.xz = rbdi_all_lanes(*RBDI_OF(d, last, sum.xz));
    s.yy = rbdi_all_lanes(*RBDI_OF(d, last, sum.yy));
    s.yz = rbdi_all_lanes(*RBDI_OF(d, last, sum.yz));
    s.zz = rbdi_all_lanes(*RBDI_OF(d, last, sum.zz));
    s.h = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.h), RBDI_BATCH));
    if (want & RBDI_WANT_V) {
        s.Xx = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.Xx), RBDI_BATCH));
        s.Xy = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.Xy), RBDI_BATCH));
        s.Xz = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.Xz), RBDI_BATCH));
        s.P = rbdi_b_all(rbdi_load_vec(RBDI_OF(d, last, sum.P), RBDI_BATCH));
    }

    for (int b = 0; b < d->behind; ++b) {
        const rbdi_cbatch mass = d->constants[b].subtree;
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion S = cols->S;
        const rbdi_b3 Phi_v = rbdi_b_cross(minus_g, S.omega);

        if (want & RBDI_WANT_M) cols->F = rbdi_inertia_times(&s, mass, S);
        if (want & RBDI_WANT_V)
            cols->D =
                rbdi_subtree_B_add(rbdi_inertia_times(&s, mass, rbdi_b_motion_cross(V, S)), &s, S.omega);
        if (want & RBDI_WANT_Q) {
            cols->stage.by_q.E.n = rbdi_b_cross(s.h, Phi_v);
            cols->stage.by_q.E.f = rbdi_b_vec(Phi_v.x * mass, Phi_v.y * mass, Phi_v.z * mass);
        }
    }
}

/* Stores n components of a field of all dofs as rows of a matrix. x: the first scalar of the field in
   d->columns. A batch may overwrite the beginning of the next row, which is stored later, but does not pass
   end, the number of the matrix's entries. Only the last row compares with it, so that two rows must not be
   shorter than a batch. */
RBDI_INLINE void rbdi_put_components(const rbd_derivatives *d, const rbd_real *x, int n, ptrdiff_t end,
                                     rbd_real *out) {
    const ptrdiff_t nv = d->model->nv, base = d->base, behind = d->behind;

    for (ptrdiff_t b = d->batches - 1; b >= behind; --b) {
        const rbdi_batch *in = (const rbdi_batch *)x + b * RBDI_COLUMN_SIZE;
        rbd_real *to = out + base + (b - behind) * RBDI_BATCH;

        RBDI_UNROLL_SIX for (int k = 0; k < n; ++k, to += nv) {
            if (RBDI_BATCH == 1 || k < n - 1 || to - out <= end - RBDI_BATCH)
                *(rbdi_batch *)to = in[k];
            else
                rbdi_copy((const rbd_real *)&in[k], (int)(end - (to - out)), to);
        }
    }

    if (!base) return;
    for (int k = 0; k < n; ++k, x += RBDI_BATCH, out += nv) {
        RBDI_UNROLL_SIX for (int j = 0; j < 6; j += RBDI_BATCH)
            rbdi_copy_batch(&x[j * RBDI_COLUMN_SIZE], 6 - j, &out[j]);
    }
}

/* Stores (n; f) of a batch of dofs as the base's columns of their rows. */
RBDI_INLINE void rbdi_put_base_columns(const rbd_derivatives *d, int b, rbdi_b3 n, rbdi_b3 f, rbd_real *out) {
    const rbdi_batch x[6] = {n.x, n.y, n.z, f.x, f.y, f.z};
    const ptrdiff_t nv = d->model->nv, first = d->base + (b - d->behind) * RBDI_BATCH;

    out += first * nv;
    RBDI_UNROLL_SIX for (int k = 0; k < RBDI_BATCH; ++k) {
        if (k < nv - first) {
            RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j)
                out[k * nv + j] = ((const rbd_real *)&x[j])[k];
        }
    }
}

/* The base's columns of the rows of all other dofs. */
RBDI_INLINE void rbdi_put_base(const rbd_derivatives *d, int want, rbdi_wanted out) {
    const rbdi_b3 w = rbdi_b_all(d->V.omega), minus_v = rbdi_b_all(rbdi_sub(rbdi_vec0(), d->V.v)),
                  minus_g = rbdi_b_all(d->minus_g);

    for (int b = d->behind; b < d->batches; ++b) {
        const rbdi_b3 T = d->columns[b].T;
        const rbdi_bforce F = d->columns[b].F;

        if (want & RBDI_WANT_M) rbdi_put_base_columns(d, b, F.n, F.f, out.at[RBDI_MASS]);
        if (want & RBDI_WANT_V)
            rbdi_put_base_columns(d, b, rbdi_b_cross_add(rbdi_b_cross_add(T, F.n, w), F.f, minus_v),
                                  rbdi_b_cross(F.f, w), out.at[RBDI_BY_V]);
        if (want & RBDI_WANT_Q)
            rbdi_put_base_columns(d, b, rbdi_b_cross(F.f, minus_g), rbdi_b_all(rbdi_vec0()),
                                  out.at[RBDI_BY_Q]);
    }
}

/* For rbd_fd_derivatives, which leaves out v of the base and gravity: of the base's columns only the three
   by w are not 0. They take places of the others, so that both matrices are solved from the same column on:

       both matrices   by_v[4], by_v[5], by_q[5]   solved from column 4 on, by_q[4] for nothing
       by_v alone      by_v[3], by_v[4], by_v[5]   from column 3 on
       by_q alone      none                        from column 6 on

   turn: where the three columns begin. */
RBDI_INLINE void rbdi_place_turns(rbd_real *by_q, rbd_real *by_v, rbd_real *turn[3]) {
    turn[0] = by_v + (by_q ? 4 : 3);
    turn[1] = turn[0] + 1;
    turn[2] = by_q ? by_q + 5 : by_v + 5;
}

/* The first column to solve for; without a base all are. */
RBDI_INLINE int rbdi_first_solved(const rbd_derivatives *d, const rbd_real *by_q, const rbd_real *by_v) {
    if (!d->base) return 0;
    if (!by_v) return 6;
    return by_q ? 4 : 3;
}

/* Stores the three columns by w: of the base's rows D, of the others T + n x w. */
RBDI_PART void rbdi_put_turns(const rbd_derivatives *d, rbd_real *by_q, rbd_real *by_v) {
    const ptrdiff_t nv = d->model->nv;
    const rbdi_b3 w = rbdi_b_all(d->V.omega);
    ptrdiff_t row = d->base * nv;
    rbd_real *turn[3];
    if (!by_v) return;

    rbdi_place_turns(by_q, by_v, turn);

    /* rows of the base */
    for (int j = 0; j < 3; ++j) rbdi_store_force(turn[j], nv, rbdi_load_force(RBDI_OF(d, j, D), RBDI_BATCH));

    /* the other rows */
    for (int b = d->behind; b < d->batches; ++b) {
        const rbdi_b3 column = rbdi_b_cross_add(d->columns[b].T, d->columns[b].F.n, w);
        const rbd_real *x = (const rbd_real *)&column;
        for (int k = 0; k < RBDI_BATCH && row < nv * nv; ++k, row += nv)
            for (int j = 0; j < 3; ++j) turn[j][row] = x[j * RBDI_BATCH + k];
    }
}

/* ---- matrices [matrices] ---- */

/* All entries of the wanted matrices: results, or right-hand sides in rbd_fd_derivatives. */
RBDI_PART void rbdi_put_entries(const rbd_model *m, const rbd_derivatives *d, rbd_real *by_q, rbd_real *by_v,
                                rbd_real *M, int results) {
    const int want = (by_q ? RBDI_WANT_Q : 0) | (by_v ? RBDI_WANT_V : 0) | (M ? RBDI_WANT_M : 0);
    const int zeros = !results || !d->keep_zeros;
    const int branched = m->nh < m->nv * (m->nv + 1) / 2;
    rbdi_wanted out;
    out.at[RBDI_BY_Q] = by_q;
    out.at[RBDI_BY_V] = by_v;
    out.at[RBDI_MASS] = M;

    /* unless every entry is written: batches go into whole rows */
    if (rbdi_mimics(m) || (RBDI_BATCH == 1 && zeros && (m->nblock || branched)))
        for (int r = 0; r < RBDI_RESULTS; ++r)
            if (out.at[r]) rbdi_clear(out.at[r], m->nv * m->nv);

    /* the rows of a free base */
    if (d->base) {
        rbdi_base_columns(d, want);
        if (by_q) rbdi_put_components(d, RBDI_FIELD(d, stage.by_q.E), 6, PTRDIFF_MAX, by_q);
        if (by_v) rbdi_put_components(d, RBDI_FIELD(d, D), 6, PTRDIFF_MAX, by_v);
        if (M) rbdi_put_components(d, RBDI_FIELD(d, F), 6, PTRDIFF_MAX, M);
    }

    /* the other rows: the most common of `want` as constants */
    if (RBDI_FOR_SPEED && want == (RBDI_WANT_Q | RBDI_WANT_V))
        rbdi_put_rows(d, RBDI_WANT_Q | RBDI_WANT_V, zeros, out);
    else if (RBDI_FOR_SPEED && want == RBDI_WANT_V)
        rbdi_put_rows(d, RBDI_WANT_V, zeros, out);
#if RBDI_BATCH > 1
    else if (RBDI_FOR_SPEED && want == (RBDI_WANT_Q | RBDI_WANT_V | RBDI_WANT_M))
        rbdi_put_rows(d, RBDI_WANT_Q | RBDI_WANT_V | RBDI_WANT_M, zeros, out);
#endif
    else
        rbdi_put_rows(d, want, zeros, out);

    if (d->base && results) rbdi_put_base(d, want, out);
    if (by_q) rbdi_put_block_entries(d, by_q);
    if (M) rbdi_add_armature(d, M);
}

/* ==== src/derivatives/memory.h ==== */
/* Interface: rbdi_check_derivatives */

/* ---- memory [memory code] ---- */

/* 6 if the model has a free base without rotors, with all other dofs in its subtree, else 0. Its coordinates
   come first. The torque of a rotor depends on v_dot, which is not the unknown of [forward dynamics code]. */
RBDI_INLINE int rbdi_free_dofs(const rbd_model *m) {
    const rbdi_link *l = m->link;
    return m->nl > 0 && !rbdi_mimics(m) && rbdi_is(l, RBDI_BLOCK) && !(rbdi_flags(l) & RBDI_ARMATURE) &&
                   rbdi_link_dofs(m, l) == 6 && l->end == m->nv
               ? 6
               : 0;
}

/* Lanes left out behind a free base, so that the next dof begins a batch. */
RBDI_INLINE int rbdi_surplus_lanes(const rbd_model *m) {
    return (RBDI_BATCH - rbdi_free_dofs(m) % RBDI_BATCH) % RBDI_BATCH;
}

/* Number of batches that have all dofs. */
RBDI_INLINE int rbdi_batches_of(const rbd_model *m) {
    return (m->nv + rbdi_mimics(m) + rbdi_surplus_lanes(m) + RBDI_BATCH - 1) / RBDI_BATCH;
}

RBDI_API size_t rbd_derivatives_size(const rbd_model *m) {
    return m ? RBDI_DERIVATIVES_BYTES(m->nl, m->nv + rbdi_mimics(m), rbdi_batches_of(m) * RBDI_BATCH) : 0;
}

/* Whether dof k of a link only slides. */
RBDI_INLINE int rbdi_slides(const rbd_model *m, const rbdi_link *l, int k) {
    return rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first + k - l->first >= 3
                                  : rbdi_is(l, RBDI_SCREW) && !(l->rho > 0);
}

/* Constants of link i's dofs. The last dof has the link's inertia, in axes cycled so that z is its axis. */
RBDI_PART void rbdi_init_constants(const rbd_model *m, rbd_derivatives *d, int i) {
    const rbdi_link *l = &m->link[i];
    const int last = rbdi_last_dof(m, i), z = rbdi_dof_axis(m, l, last);
    const rbd_const S[3][3] = {{l->Sigma.xx, l->Sigma.xy, l->Sigma.xz},
                               {l->Sigma.xy, l->Sigma.yy, l->Sigma.yz},
                               {l->Sigma.xz, l->Sigma.yz, l->Sigma.zz}};
    const rbd_const h[3] = {l->h.x, l->h.y, l->h.z};
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    const rbd_const own[10] = {S[x][x], S[x][y], S[x][z], S[y][y], S[y][z],
                               S[z][z], h[x],    h[y],    h[z],    l->mass};

    for (int j = 0; j < 10; ++j) RBDI_CONSTANT_OF(d, last, xx)[j * RBDI_BATCH] = own[j];

    for (int k = l->first; k <= last; ++k) {
        const int slides = rbdi_slides(m, l, k), screw = rbdi_is(l, RBDI_SCREW);
        *RBDI_CONSTANT_OF(d, k, subtree) = l->subtree_mass;
        *RBDI_CONSTANT_OF(d, k, rho) = screw ? l->rho : RBD_C(!slides);
        *RBDI_CONSTANT_OF(d, k, kappa) = screw ? l->kappa : RBD_C(slides);
    }
}

/* Adds mass and first moment m (E' com + r) of a body as described to those of its link, in axes cycled so
   that z is the last dof's. */
RBDI_PART void rbdi_init_body(const rbd_model *m, rbd_derivatives *d, const rbdi_frame *u) {
    const int last = rbdi_last_dof(m, u->link), z = rbdi_dof_axis(m, &m->link[u->link], last);
    const rbd_const *E = u->E, com[3] = {u->com.x, u->com.y, u->com.z}, r[3] = {u->r.x, u->r.y, u->r.z};
    rbd_const *out = RBDI_CONSTANT_OF(d, last, all_hx); /* and the three fields behind it */

    for (int j = 0; j < 3; ++j) {
        const int k = (z + 1 + j) % 3;
        out[j * RBDI_BATCH] += u->mass * (E[k] * com[0] + E[3 + k] * com[1] + E[6 + k] * com[2] + r[k]);
    }

    out[3 * RBDI_BATCH] += u->mass;
    d->mass += u->mass;
}

/* Whether a link only slides. */
RBDI_PART int rbdi_only_slides(const rbd_model *m, const rbdi_link *l) {
    if (rbdi_is(l, RBDI_SCREW)) return !(l->rho > 0);
    return rbdi_is(l, RBDI_BLOCK) && rbdi_block_of(m, l)->type == RBD_TRANSLATION;
}

/* Chooses the link whose origin is the common origin of a root's tree: the first that rotates or, in a chain
   of links that only slide, the last. */
RBDI_PART void rbdi_init_origin(const rbd_model *m, rbd_derivatives *d, int root, rbdi_segment *seg) {
    int i = root;
    while (i + 1 < m->nl && m->link[i + 1].parent == i && rbdi_only_slides(m, &m->link[i])) ++i;

    d->origin[i] = (int16_t)root;
    seg->origin = (int16_t)(rbdi_last_dof(m, i) + 1);
}

/* Entries of the dofs of link i, and their segment. */
RBDI_PART void rbdi_init_link(const rbd_model *m, rbd_derivatives *d, int i) {
    const rbdi_link *l = &m->link[i];
    const int n = rbdi_link_dofs(m, l), block = rbdi_is(l, RBDI_BLOCK);
    const int parent = l->parent < 0 ? -1 : rbdi_last_dof(m, l->parent);
    rbdi_segment *seg = &d->segment[d->segments > 0 ? d->segments - 1 : 0];

    for (int k = l->first; k < l->first + n; ++k) {
        rbdi_entry *e = &d->entry[k];
        e->source = m->order[k].dof;
        e->user = (int16_t)rbdi_source(m, e->source);
        e->end = l->end;
        e->joint = (int16_t)(l->first + n);
        e->parent = (int16_t)(k > l->first ? k - 1 : parent);
        e->row = e->user * m->nv;
    }

    /* a new segment, unless the link goes on with the last one */
    if (d->segments == 0 || block || seg->block || parent != l->first - 1) {
        seg = &d->segment[d->segments++];
        seg->first = l->first;
        seg->parent = (int16_t)parent;
        seg->block = (int16_t)block;
        seg->link = (int16_t)i;
        seg->origin = 0;
        if (parent < 0) rbdi_init_origin(m, d, i, seg);
    }
    seg->end = (int16_t)(l->first + n);
}

/* Assigns the lanes in the caller's order, the order of the results' rows. */
RBDI_PART void rbdi_assign_lanes(const rbd_model *m, rbd_derivatives *d) {
    for (int k = 0; k < d->n; ++k) {
        rbdi_entry *e = &d->entry[k];
        const int from = e->source + (e->source < d->base ? 0 : rbdi_surplus_lanes(m));

        d->entry[e->source].of_source = (int16_t)k;
        e->batch = (int16_t)(from / RBDI_BATCH);
        e->lane = (int16_t)(from % RBDI_BATCH);
        e->at = e->batch * RBDI_COLUMN_SIZE * RBDI_BATCH + e->lane;
    }
}

#if RBDI_BATCH > 1
/* The list of a dof that a batch with these lanes is in: 0 for lanes on the path alone, 1 for both, 2 for
   lanes in the subtree alone; -1 = none. */
RBDI_PART int rbdi_list_of(uint64_t lanes) {
    const int subtree = lanes >> RBDI_IN_SUBTREE != 0, path = lanes % ((uint64_t)1 << RBDI_IN_SUBTREE) != 0;
    if (path && subtree) return 1;
    if (subtree) return 2;
    return path ? 0 : -1;
}

/* The three lists of each dof behind a free base: batches with lanes on its path only, with both, with lanes
   in its subtree only. */
RBDI_PART void rbdi_init_relatives(rbd_derivatives *d) {
    uint64_t *lanes = d->lanes;

    for (int i = d->base; i < d->n; ++i) {
        rbdi_relatives *list = rbdi_relatives_of(d, i), *rel = list;

        /* the lanes of its relatives, by batch */
        for (int b = 0; b < d->batches; ++b) lanes[b] = 0;
        for (int j = d->entry[i].parent; j >= d->base; j = d->entry[j].parent)
            lanes[d->entry[j].batch] |= (uint64_t)1 << (RBDI_ON_PATH + d->entry[j].lane);
        for (int j = i; j < d->entry[i].end; ++j)
            lanes[d->entry[j].batch] |= (uint64_t)1 << (RBDI_IN_SUBTREE + d->entry[j].lane);

        /* list by list, each with its end */
        for (int which = 0; which < 3; ++which) {
            for (int b = d->behind; b < d->batches; ++b) {
                if (rbdi_list_of(lanes[b]) != which) continue;
                rel->batch = b;
                rel->row = (int16_t)((b - d->behind) * RBDI_BATCH);
                rel->lanes = lanes[b];
                ++rel;
            }
            rel->batch = -1;
            ++rel;
        }

        list->whole = rel - list == rbdi_relatives_length(d);
    }
}
#endif

/* The columns S of a free base's dofs, unit vectors. No call computes them anew, except for
   rbd_energy_regressors, which then restores them. */
RBDI_PART void rbdi_init_base(const rbd_derivatives *d) {
    for (int k = 0; k < d->base; ++k) {
        rbdi_store_motion(RBDI_OF(d, k, S), RBDI_BATCH, rbdi_motion0());
        RBDI_OF(d, k, S)[k * RBDI_BATCH] = rbdi_set(RBD_C(1));
    }
}

/* Lays out the memory as RBDI_DERIVATIVES_BYTES says. */
RBDI_PART rbd_derivatives *rbdi_lay_derivatives(const rbd_model *m, void *memory) {
    unsigned char *p = rbdi_aligned(memory);
    rbd_derivatives *d = (rbd_derivatives *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_derivatives)));

    d->n = m->nv + rbdi_mimics(m);
    d->base = rbdi_free_dofs(m);
    d->batches = rbdi_batches_of(m);
    d->behind = (d->base + rbdi_surplus_lanes(m)) / RBDI_BATCH;

    d->columns = (rbdi_columns *)rbdi_take(&p, d->batches, sizeof(rbdi_columns));
#if RBDI_BATCH > 1
    d->relatives = (rbdi_relatives *)rbdi_take(&p, d->n * rbdi_relatives_length(d), sizeof(rbdi_relatives));
    d->lanes = (uint64_t *)rbdi_take(&p, d->batches, sizeof(uint64_t));
#endif
    d->a = (rbd_real *)rbdi_take(&p, d->n, sizeof(rbd_real));
    d->constants = (rbdi_constants *)rbdi_take(&p, d->batches, sizeof(rbdi_constants));
    d->entry = (rbdi_entry *)rbdi_take(&p, d->n, sizeof(rbdi_entry));
    d->segment = (rbdi_segment *)rbdi_take(&p, m->nl, sizeof(rbdi_segment));
    d->origin = (int16_t *)rbdi_take(&p, m->nl, sizeof(int16_t));
    d->given = (unsigned char *)rbdi_take(&p, d->n, 1);
    return d;
}

/* Dofs, segments and lists. */
RBDI_PART void rbdi_init_order(const rbd_model *m, rbd_derivatives *d) {
    d->segments = 0;
    for (int i = 0; i < m->nl; ++i) d->origin[i] = -1;
    for (int i = 0; i < m->nl; ++i) rbdi_init_link(m, d, i);

    rbdi_assign_lanes(m, d);
#if RBDI_BATCH > 1
    rbdi_init_relatives(d);
#endif
}

/* Columns and constants. Surplus lanes stay finite. */
RBDI_PART void rbdi_init_numbers(const rbd_model *m, rbd_derivatives *d) {
    const int padded = d->batches * RBDI_BATCH;
    rbd_const *constants = (rbd_const *)d->constants;

    rbdi_clear((rbd_real *)d->columns, RBDI_COLUMN_SIZE * padded);
    for (int k = 0; k < RBDI_CONSTANT * padded; ++k) constants[k] = RBD_C(0);

    d->mass = RBD_C(0);
    for (int i = 0; i < m->nl; ++i) rbdi_init_constants(m, d, i);
    for (int b = 0; b < m->nb; ++b)
        if (m->frame[b].link >= 0) rbdi_init_body(m, d, &m->frame[b]);
    rbdi_init_base(d);
}

RBDI_API rbd_status rbd_derivatives_init(const rbd_model *m, rbd_work *w, void *memory, size_t size,
                                         rbd_derivatives **derivatives) {
    const rbd_status status = rbdi_check(m, w, memory && derivatives);
    rbd_derivatives *d;
    if (derivatives) *derivatives = NULL;
    if (status) return status;
    if (size < rbd_derivatives_size(m)) return RBD_ERR_MEMORY;

    d = rbdi_lay_derivatives(m, memory);
    for (int k = 0; k < RBDI_SHAPE; ++k) d->shape[k] = m->shape[k];
    d->model = m;
    d->work = w;
    d->keep_zeros = 0;

    rbdi_init_order(m, d);
    rbdi_init_numbers(m, d);
    *derivatives = d;
    return RBD_OK;
}

/* The checks of every call: arguments, the model that the constants are of, work. */
RBDI_INLINE rbd_status rbdi_check_derivatives(const rbd_model *m, const rbd_derivatives *d, int arrays) {
    if (!m || !d || !arrays) return RBD_ERR_NULL;
    return d->model == m ? rbdi_check_dynamics(m, d->work, 1) : RBD_ERR_WORK;
}

/* ==== src/derivatives/momentum.h ==== */
/* ---- momentum [momentum code] ----
   A (Orin, Goswami and Lee 2013) has the columns F_i of RBDA table 6.2 about the centre of mass. */

/* Position in the world of the common origin of a root's tree: the root's position in the world less that
   in the common frame. */
RBDI_INLINE rbdi_v3 rbdi_place_of(const rbd_model *m, const rbd_derivatives *d, int root) {
    const rbdi_link *l = &m->link[root];
    const rbdi_pose X = rbdi_common_pose(m, d, root);

    if (rbdi_is(l, RBDI_BLOCK)) return rbdi_sub(d->work->block[l->block].X.r, X.r);
    return rbdi_sub(rbdi_add(rbdi_vec_c(l->r), rbdi_scale(rbdi_trig_of(m, d->work, root, rbdi_flags(l)).d,
                                                          rbdi_vec(X.E.zx, X.E.zy, X.E.zz))),
                    X.r);
}

/* n += offset x f of a force in the lanes. */
RBDI_INLINE void rbdi_shift_moment(rbd_real *in, rbdi_v3 offset) {
    rbdi_force F = rbdi_load_force(in, RBDI_BATCH);
    F.n = rbdi_add(F.n, rbdi_cross(offset, F.f));
    rbdi_store_force(in, RBDI_BATCH, F);
}

/* Moves positions, F and wrenches of the other roots' trees to the first root's origin: A is in one frame. */
RBDI_PART void rbdi_join_origins(const rbd_model *m, rbd_derivatives *d) {
    rbdi_v3 offset = rbdi_vec0();
    int others = 0; /* whether the first root's tree is behind */

    for (const rbdi_segment *r = d->segment + 1; r < d->segment + d->segments; ++r) {
        if (r->parent < 0) offset = rbdi_sub(rbdi_place_of(m, d, r->link), rbdi_place_of(m, d, 0));
        others |= r->parent < 0;
        if (!others) continue;

        for (int k = r->first; k < r->end; ++k) {
            rbd_real *x = RBDI_OF(d, k, x);
            rbdi_store_vec(x, RBDI_BATCH, rbdi_add(rbdi_load_vec(x, RBDI_BATCH), offset));
            rbdi_shift_moment(RBDI_OF(d, k, F), offset);
            rbdi_shift_moment(RBDI_OF(d, k, sum.f), offset);
        }
    }
}

/* The centre of mass relative to that origin, h / mass of all bodies; 0 without mass. With a free base h of
   the whole tree is that, for no mass was moved past the base. Otherwise it is summed over the bodies as
   described. */
RBDI_PART rbdi_v3 rbdi_common_com(const rbd_derivatives *d) {
    const rbd_real share = rbdi_set(d->mass > 0 ? RBD_C(1) / d->mass : RBD_C(0));
    rbdi_sum x = rbdi_sum_of_none(), y = x, z = x;

    if (d->base) return rbdi_scale(share, rbdi_load_vec(RBDI_OF(d, d->base - 1, sum.h), RBDI_BATCH));
    for (int b = 0; b < d->batches; ++b) {
        const rbdi_columns *cols = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        const rbdi_b3 h = rbdi_b_rotate(cols, own->all_hx, own->all_hy, own->all_hz);
        x = rbdi_sum_and(x, h.x + cols->x.x * own->all_m);
        y = rbdi_sum_and(y, h.y + cols->x.y * own->all_m);
        z = rbdi_sum_and(z, h.z + cols->x.z * own->all_m);
    }

    return rbdi_scale(share, rbdi_vec(rbdi_sum_value(x), rbdi_sum_value(y), rbdi_sum_value(z)));
}

/* Stores F of all dofs as a matrix, in world axes, with moments about the centre of mass. With three rows:
   f only, which no shift of the origin changes, times scale. */
RBDI_INLINE void rbdi_put_momenta(const rbd_derivatives *d, rbdi_v3 com, rbd_real scale, int rows,
                                  rbd_real *out) {
    const rbd_model *m = d->model;
    const rbdi_mat *E = &d->work->block->X.E; /* if there is a base */
    const rbd_real *x = rows == 3 ? RBDI_FIELD(d, stage.momentum.f) : RBDI_FIELD(d, stage.momentum);
    if (d->base) rbdi_base_columns(d, RBDI_WANT_M);

    /* n - com x f, from a free base's axes to the world's */
    for (int b = 0; b < d->batches; ++b) {
        rbdi_bforce F = d->columns[b].F;
        F.n = rbdi_b_cross_add(F.n, F.f, rbdi_b_all(com));
        if (d->base) {
            F.n = rbdi_b_mul_t(*E, F.n);
            F.f = rbdi_b_mul_t(*E, F.f);
        }
        F.f = rbdi_b_vec(F.f.x * scale, F.f.y * scale, F.f.z * scale);
        d->columns[b].stage.momentum = F;
    }

    if (!rbdi_mimics(m) && 2 * m->nv >= RBDI_BATCH) {
        rbdi_put_components(d, x, rows, rows * m->nv, out);
        return;
    }

    /* the columns of mimic joints are added to those of the joints that they follow */
    rbdi_clear(out, rows * m->nv);
    for (int i = 0; i < d->n; ++i) {
        const rbdi_entry *e = &d->entry[i];
        const rbd_real ratio = rbdi_ratio(m, e->source);
        for (int j = 0; j < rows; ++j) {
            rbd_real *to = &out[j * m->nv + e->user];
            *to = *to + ratio * x[e->at + j * RBDI_BATCH];
        }
    }
}

/* The wrench f of table 5.1 on all that moves, at a = 0 and without gravity: the sum over the roots. */
RBDI_PART void rbdi_put_momentum_bias(const rbd_model *m, const rbd_derivatives *d, rbdi_v3 com,
                                      rbd_real *A_dot_v) {
    rbdi_force F = rbdi_force0();

    for (const rbdi_segment *r = d->segment; r < d->segment + d->segments; ++r) {
        const rbd_real *in = RBDI_OF(d, rbdi_last_dof(m, r->link), sum.f);
        if (r->parent < 0) F = rbdi_force_add(F, rbdi_load_force(in, RBDI_BATCH));
    }
    F.n = rbdi_sub(F.n, rbdi_cross(com, F.f));
    if (d->base) {
        F.n = rbdi_mul_t(d->work->block[0].X.E, F.n);
        F.f = rbdi_mul_t(d->work->block[0].X.E, F.f);
    }
    rbdi_store_force(A_dot_v, 1, F);
}

RBDI_API rbd_status rbd_momentum_matrix(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                        const rbd_real *v, rbd_real *A, rbd_real A_dot_v[6]) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && A && (v || !A_dot_v));
    const int need = A_dot_v ? RBDI_NEED_WRENCH | RBDI_NEED_WHOLE : 0;
    rbdi_v3 com;
    if (status) return status;

    rbdi_common(m, d, q, v, d->work->zero, rbdi_no_gravity(), NULL, need);
    rbdi_join_origins(m, d);
    com = rbdi_common_com(d);
    if (A_dot_v) rbdi_put_momentum_bias(m, d, com, A_dot_v);
    rbdi_put_momenta(d, com, rbdi_set(RBD_C(1)), 6, A);
    return RBD_OK;
}

RBDI_API rbd_status rbd_com_jacobian(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, rbd_real *J) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && J);
    const rbd_const share = !status && d->mass > 0 ? RBD_C(1) / d->mass : RBD_C(0);
    if (status) return status;

    rbdi_common(m, d, q, NULL, NULL, rbdi_no_gravity(), NULL, 0);
    rbdi_put_momenta(d, rbdi_vec0(), rbdi_set(share), 3, J);
    return RBD_OK;
}

/* ---- Coriolis matrix [coriolis code] ---- */

RBDI_API rbd_status rbd_coriolis(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                                 rbd_real *C) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && C);
    if (status) return status;

    rbdi_common(m, d, q, v, NULL, rbdi_no_gravity(), NULL, RBDI_NEED_V | RBDI_NEED_CORIOLIS);
    rbdi_put_entries(m, d, NULL, C, NULL, 1);
    return RBD_OK;
}

/* ==== src/derivatives/jacobians.h ==== */
/* ---- derivatives of Jacobians [jacobians code] ----
   Let s be an axis of the joint of link i, in world axes, p the link's origin and r the point. s is fixed in
   the link, which turns with omega_i. A column of J and its rate are

       turning      (s; s x (r - p))      (ds/dt; ds/dt x (r - p) + s x (dr/dt - dp/dt)),  ds/dt = omega_i x s
       sliding      (0; s)                (0; ds/dt)
       screw        rho and kappa times these, summed

   In the axes E of a body that turns with omega a column c becomes E c, with the rate
   E (dc/dt - omega x c). */

/* The point of a Jacobian and its velocity, in world axes; the axes of the result, E with their angular
   velocity in world axes, unless these are the world's. */
typedef struct rbdi_observer {
    rbdi_v3 r, r_dot, omega;
    rbdi_mat E;
    int turns;
} rbdi_observer;

/* Rate of the column of a link's spatial unit axis. */
RBDI_LOCAL rbdi_motion rbdi_column_rate(const rbdi_link *l, const rbdi_kin *k, int axis,
                                        const rbdi_observer *o) {
    const rbdi_v3 s = rbdi_unit_axis(&k->X, axis);
    const rbdi_v3 arm = rbdi_sub(o->r, k->X.r);
    const rbdi_v3 arm_dot = rbdi_sub(o->r_dot, rbdi_mul_t(k->X.E, k->v));
    const rbdi_v3 s_dot = rbdi_cross(rbdi_mul_t(k->X.E, k->state.omega), s);
    const rbd_const rho = rbdi_is(l, RBDI_SCREW) ? l->rho : RBD_C(axis < 3);
    rbdi_motion rate = rbdi_axis_motion(l, axis, s_dot, arm), column;

    rate.v = rbdi_add(rate.v, rbdi_scale(rbdi_set(rho), rbdi_cross(s, arm_dot)));
    if (!o->turns) return rate;

    /* E (dc/dt - omega x c) */
    column = rbdi_axis_motion(l, axis, s, arm);
    rate.omega = rbdi_mul(o->E, rbdi_sub(rate.omega, rbdi_cross(o->omega, column.omega)));
    rate.v = rbdi_mul(o->E, rbdi_sub(rate.v, rbdi_cross(o->omega, column.v)));
    return rate;
}

/* Adds sign times the rates of the columns of link i and of its ancestors up to link `end`, without `end`. */
RBDI_LOCAL void rbdi_add_rates(const rbd_model *m, const rbd_work *w, int i, int end, const rbdi_observer *o,
                               int sign, rbd_real *J_dot) {
    for (; i != end; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        const rbd_real factor = rbdi_ratio(m, l->iv) * (rbd_const)sign;
        const int first = rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first : 2;

        for (int k = 0; k < rbdi_link_dofs(m, l); ++k) {
            rbd_real *to = &J_dot[rbdi_source(m, l->iv) + k];
            const rbdi_motion rate = rbdi_column_rate(l, &w->kin[i], first + k, o);
            rbdi_motion sum;

            sum.omega = rbdi_add(rbdi_load_vec(to, m->nv), rbdi_scale(factor, rate.omega));
            sum.v = rbdi_add(rbdi_load_vec(to + 3 * m->nv, m->nv), rbdi_scale(factor, rate.v));
            rbdi_store_motion(to, m->nv, sum);
        }
    }
}

/* The derivative of rbdi_put_jacobian's matrix, with the same arguments. */
RBDI_LOCAL void rbdi_put_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                             const rbd_real *point, int reference, int axes,
                                             rbd_real *J_dot) {
    const int link = m->frame[body].link, other = reference < 0 ? -1 : m->frame[reference].link;
    const int common = rbdi_common_link(m, link, other);
    const rbdi_kin k = rbdi_body_kin(m, w, body);
    rbdi_observer o;

    rbdi_clear(J_dot, 6 * m->nv);
    if (!w->moving) return; /* v = 0: the work has no velocities */

    o.r = rbdi_point_position(m, w, body, point);
    o.r_dot = rbdi_mul_t(k.X.E, rbdi_point_v(&k, point ? rbdi_load_vec(point, 1) : rbdi_vec0()));
    o.turns = axes >= 0;
    if (o.turns) {
        const rbdi_kin seen_from = rbdi_body_kin(m, w, axes);
        o.E = seen_from.X.E;
        o.omega = rbdi_mul_t(o.E, seen_from.state.omega);
    }

    rbdi_add_rates(m, w, link, common, &o, 1, J_dot);
    rbdi_add_rates(m, w, other, common, &o, -1, J_dot);
}

RBDI_API rbd_status rbd_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                            const rbd_real point[3], rbd_axes axes, rbd_real *J_dot) {
    const rbd_status status = rbdi_check_body_call(m, w, body, J_dot != NULL);
    if (status) return status;
    rbdi_put_jacobian_derivative(m, w, body, point, -1, axes == RBD_LINK_AXES ? body : -1, J_dot);
    return RBD_OK;
}

RBDI_API rbd_status rbd_relative_jacobian_derivative(const rbd_model *m, const rbd_work *w, int body,
                                                     const rbd_real point[3], int reference, rbd_axes axes,
                                                     rbd_real *J_dot) {
    rbd_status status;
    if (reference == -1) return rbd_jacobian_derivative(m, w, body, point, RBD_WORLD_AXES, J_dot);
    status = rbdi_check_body_call(m, w, body, J_dot != NULL);
    if (!status) status = rbdi_check_body_call(m, w, reference, 1);
    if (status) return status;
    rbdi_put_jacobian_derivative(m, w, body, point, reference, axes == RBD_LINK_AXES ? reference : -1, J_dot);
    return RBD_OK;
}

/* ==== src/derivatives/free_base.h ==== */
/* ---- inverse dynamics with a free base [free base code] ----
   If A = 0 at the base, the wrenches of the links add up to f. The missing wrench tau - f gives A = y of the
   base: I y = tau - f, with I the inertia of the whole tree, by Newton's and Euler's laws about the centre of
   mass. In the common frame the A of all links increases by y. The torques are S' f + F' y, with f of the
   subtree and F = I S. Gravity and the base's linear velocity are in the linear part y_v of y only:
   v_dot = y_v - w x v + gravity. rbd_hybrid serves other models, and states in which y is in doubt. */

#ifndef RBD_NO_CHOLESKY
/* M^-1 x for the 3 x 3 matrix M of turns, by pivots from the end, as in [packed matrix]: M = L'DL. z, y: 1/D
   of these rows. */
RBDI_INLINE rbdi_v3 rbdi_solve_turns(const rbd_model *m, rbdi_sym M, rbdi_v3 x, rbdi_mask *doubt) {
    const rbd_real z = rbdi_pivot_inverse(M.zz, m->dof[2].scale, doubt);
    const rbd_real L_zy = M.yz * z;
    const rbd_real L_zx = M.xz * z;
    const rbd_real xy = M.xy - L_zx * M.yz;
    const rbd_real y = rbdi_pivot_inverse(M.yy - L_zy * M.yz, m->dof[1].scale, doubt);
    const rbd_real L_yx = xy * y;
    rbdi_v3 s;

    x.y = x.y - L_zy * x.z;
    x.x = x.x - L_zx * x.z - L_yx * x.y;

    s.x = x.x * rbdi_pivot_inverse(M.xx - L_zx * M.xz - L_yx * xy, m->dof[0].scale, doubt);
    s.y = x.y * y - L_yx * s.x;
    s.z = x.z * z - L_zx * s.x - L_zy * s.y;
    return s;
}

/* y = (omega_dot; y_v) from the missing wrench F = (n; f):

       com = h / mass,   I_com omega_dot = n - com x f,   mass y_v = f - omega_dot x h */
RBDI_PART rbdi_motion rbdi_base_motion(const rbd_model *m, const rbd_derivatives *d, rbdi_force F,
                                       rbdi_mask *doubt) {
    const rbd_real mass_inverse = rbdi_pivot_inverse(rbdi_set(d->mass), m->dof[3].scale, doubt);
    const int last = d->base - 1;
    const rbdi_v3 h = rbdi_load_vec(RBDI_OF(d, last, sum.h), RBDI_BATCH), com = rbdi_scale(mass_inverse, h);
    rbdi_rbi C; /* Sigma - com h' about the centre of mass, h about the base's origin */
    rbdi_motion y;

    C.h = h;
    C.Sigma.xx = *RBDI_OF(d, last, sum.xx) - com.x * h.x;
    C.Sigma.xy = *RBDI_OF(d, last, sum.xy) - com.x * h.y;
    C.Sigma.xz = *RBDI_OF(d, last, sum.xz) - com.x * h.z;
    C.Sigma.yy = *RBDI_OF(d, last, sum.yy) - com.y * h.y;
    C.Sigma.yz = *RBDI_OF(d, last, sum.yz) - com.y * h.z;
    C.Sigma.zz = *RBDI_OF(d, last, sum.zz) - com.z * h.z;

    y.omega = rbdi_solve_turns(m, rbdi_abi_of_rbi(C, d->mass).I, rbdi_sub(F.n, rbdi_cross(com, F.f)), doubt);
    y.v = rbdi_scale(mass_inverse, rbdi_sub(F.f, rbdi_cross(y.omega, h)));
    return y;
}

/* Torques of the joints at A = y of the base: S' f + F' y + armature a. */
RBDI_PART void rbdi_put_torques(const rbd_model *m, const rbd_derivatives *d, rbdi_motion y,
                                const rbd_real *a, rbd_real *tau) {
    for (int b = d->behind, k = d->base; b < d->batches; ++b, k += RBDI_BATCH) {
        const rbdi_columns *cols = &d->columns[b];
        const rbdi_batch x = rbdi_b_power(cols->S, cols->sum.f) + rbdi_b_force_dot(cols->F, y);
        rbdi_copy_batch((const rbd_real *)&x, m->nv - k, tau + k);
    }

    for (int k = d->base; k < m->nv; ++k) tau[k] = tau[k] + a[k] * m->dof[k].armature;
}

/* rbd_id_free_base by rbd_hybrid, for any model. */
RBDI_COLD rbd_status rbdi_hybrid_free_base(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                           const rbd_real *v, const rbd_real *f_ext, rbd_real *a,
                                           rbd_real *tau) {
    unsigned char *given = d->given;
    int bases = 0;

    for (int k = 0; k < m->nv; ++k) given[k] = 1;
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        if (l->parent >= 0 || rbdi_link_dofs(m, l) != 6) continue;

        for (int k = 0; k < 6; ++k) given[l->iv + k] = 0;
        ++bases;
    }

    if (bases == 0) return rbd_rnea(m, d->work, q, v, a, f_ext, tau);
    return rbd_hybrid(m, d->work, q, v, given, a, tau, f_ext);
}

RBDI_API rbd_status rbd_id_free_base(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                     const rbd_real *v, rbd_real *a, rbd_real *tau, const rbd_real *f_ext) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && a && tau);
    rbdi_force f;
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    rbdi_motion y;
    if (status) return status;
    if (!d->base) return rbdi_hybrid_free_base(m, d, q, v, f_ext, a, tau);

    rbdi_clear(a, 6);
    rbdi_common(m, d, q, v, a, rbdi_no_gravity(), f_ext, RBDI_NEED_WRENCH);
    f = rbdi_load_force(RBDI_OF(d, d->base - 1, sum.f), RBDI_BATCH);
    y = rbdi_base_motion(m, d, rbdi_force_sub(rbdi_load_force(tau, 1), f), &doubt);
    if (rbdi_any(doubt)) return rbdi_hybrid_free_base(m, d, q, v, f_ext, a, tau);
    rbdi_put_torques(m, d, y, a, tau);

    /* v_dot = y_v - w x v + gravity */
    y.v = rbdi_add(y.v, rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(d->work->gravity)));
    y.v = rbdi_sub(y.v, rbdi_cross(d->V.omega, rbdi_load_vec(v + 3, 1)));
    rbdi_store_motion(a, 1, y);
    d->work->singular = -1;
    return RBD_OK;
}
#endif

/* ==== src/derivatives/solve_two.h ==== */
/* X = sign M^-1 X and Y = sign M^-1 Y: n columns each, with rows a stride apart. Both in one pass, as long as
   their rows fit into registers: each entry of L is loaded once, and the two do not wait for each other. */
RBDI_PART void rbdi_solve_two(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign, ptrdiff_t stride,
                              int n, rbd_real *X, rbd_real *Y) {
#ifdef RBDI_ROWS
    if (RBDI_ROWS(solve)(m, L, sign, stride, n, X, Y)) return;
#endif

    if (n < RBDI_BATCH || 2 * n > RBDI_ROW * RBDI_BATCH) {
        rbdi_solve_columns(m, w, L, sign, stride, n, X);
        rbdi_solve_columns(m, w, L, sign, stride, n, Y);
        return;
    }
    rbdi_solve_half(m, w, L, 1, 1, stride, 2, n, X, Y);
    rbdi_solve_half(m, w, L, 0, sign, stride, 2, n, X, Y);
}

/* ==== src/derivatives/dynamics.h ==== */
/* ---- derivatives of inverse dynamics [inverse dynamics code] ---- */

RBDI_API rbd_status rbd_id_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                       rbd_real *dtau_dq, rbd_real *dtau_dv, rbd_real *M) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && a);
    if (status) return status;

    rbdi_common(m, d, q, v, a, d->work->gravity, f_ext, RBDI_NEED_V | RBDI_NEED_WRENCH | RBDI_NEED_WHOLE);
    if (dtau_dq) rbdi_columns_by_q(d);
    rbdi_put_entries(m, d, dtau_dq, dtau_dv, M, 1);
    return RBD_OK;
}

RBDI_API rbd_status rbd_gravity_torque_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                                   rbd_real *dg_dq) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && dg_dq);
    if (status) return status;
    return rbd_id_derivatives(m, d, q, d->work->zero, d->work->zero, NULL, dg_dq, NULL, NULL);
}

RBDI_API rbd_status rbd_keep_zeros(rbd_derivatives *d, int keep) {
    if (!d) return RBD_ERR_NULL;
    d->keep_zeros = keep;
    return RBD_OK;
}

/* ---- derivatives of forward dynamics [forward dynamics code] ----
   With the acceleration a of M a = tau - c, where c is the bias force,

       da/dx = -M^-1 dtau/dx,   dtau/dx: of inverse dynamics, at a.

   rbd_fd_derivatives computes, in this order:

     1. the columns at a = 0. They give M, and the bias force c_i = S_i' f_i of the subtree's wrench f
     2. M = L'DL and a
     3. the effect of a, which is linear: A_p' on the acceleration A_p of dof i's parent, f' on the wrench f

            A_p' = sum over the parent and its ancestors of S_j a_j
            f' = I A_p' + sum over the subtree of F_j a_j

     4. Phi and E from A_p + A_p' and f + f', and with them dtau/dq and dtau/dv
     5. the solution of M X = -dtau/dx

   a is computed from the factor even if M^-1 is requested. The product M^-1 (tau - c) takes 5 % fewer
   instructions but loses digits: in chains of 48 links the error of M a is 80 times as large, of da/dq 20
   times. If each of 24 links is twice as heavy as its parent, da/dq has no correct digit; by the factor it
   has six.

   With a free base, gravity and the base's linear velocity enter the dynamics only by the A of the base. The
   call leaves both out. Its unknowns are y = (A of the base; accelerations of the joints). y does not depend
   on position, attitude and linear velocity of the base. At the end v_dot and its derivatives follow from the
   linear part y_v of A and its derivatives. With the velocity (w; u) of the base,

       v_dot = y_v - w x u + gravity
       by w: dy_v/dw + [u]x     by u: -[w]x     by the turn theta: [gravity]x     by joints: those of y_v */

#ifndef RBD_NO_CHOLESKY
/* Writes M as a packed matrix, M_ik = S_k' F_i on the path of i. The model has no mimic joints. */
RBDI_PART void rbdi_put_packed(const rbd_model *m, const rbd_derivatives *d, rbd_real *H) {
    const rbdi_order *o = m->order;
    const rbdi_entry *e = d->entry;
    if (d->base) rbdi_base_columns(d, RBDI_WANT_M);

    for (int i = 0; i < d->n; ++i) {
        const rbdi_force F = rbdi_load_force(RBDI_OF(d, i, F), RBDI_BATCH);
        const rbdi_motion S = rbdi_load_motion(RBDI_OF(d, i, S), RBDI_BATCH);
        rbd_real *row = H + o[i].row, *pivot = row + m->dof[o[i].dof].depth, *to = pivot;

        /* S_k of a base are unit vectors. A row shorter than six spills into the next, which comes later */
        if (d->base) rbdi_store_force(row, 1, F);
        for (int k = e[i].parent; k >= d->base; k = e[k].parent)
            *--to = rbdi_power(rbdi_load_motion(RBDI_OF(d, k, S), RBDI_BATCH), F);
        *pivot = rbdi_power(S, F) + m->dof[o[i].dof].armature;
    }
}

/* Whether a pivot of M is in doubt because of the common frame: M_kk is a difference of inertias about the
   common origin, as large as the subtree's tr(Sigma), and its error is eps times that. */
RBDI_PART rbdi_mask rbdi_far_pivots(const rbd_derivatives *d) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());

    for (int k = d->base; k < d->n; ++k) {
        const rbd_real trace = *RBDI_OF(d, k, sum.xx) + *RBDI_OF(d, k, sum.yy) + *RBDI_OF(d, k, sum.zz);
        const rbd_const rho = *RBDI_CONSTANT_OF(d, k, rho);
        doubt = rbdi_or(doubt, rbdi_less(d->work->pivot[d->entry[k].source], trace * (rho * RBDI_DOUBT)));
    }
    return doubt;
}

/* Factors M anew, computed in the links' frames, and checks its pivots. */
RBDI_COLD void rbdi_factor_again(const rbd_model *m, rbd_work *w) {
    rbdi_mask doubt;
    RBDI_NOTE_DOUBT(w, 1);
    rbdi_crba_of_joints(m, w, w->H);
    doubt = rbdi_factor(m, w, w->H);
    rbdi_check_factor(m, w, w->H, doubt);
}

/* x = tau - c, with c_i = S_i' f_i; of a free base c = f. A batch of lanes is a piece of c: both have the
   caller's order. */
RBDI_PART void rbdi_net_torque(const rbd_model *m, rbd_derivatives *d, const rbd_real *tau, rbd_real *x) {
    rbd_real *bias = rbdi_mimics(m) ? d->work->tx : x;

    for (int b = d->behind, k = d->base; b < d->batches; ++b, k += RBDI_BATCH) {
        const rbdi_columns *cols = &d->columns[b];
        const rbdi_batch bias_b = rbdi_b_power(cols->S, cols->sum.f);
        rbdi_copy_batch((const rbd_real *)&bias_b, d->n - k, bias + k);
    }
    if (d->base) rbdi_store_force(bias, 1, rbdi_load_force(RBDI_OF(d, d->base - 1, sum.f), RBDI_BATCH));

    rbdi_reduce_tau(m, d->work->tx, x);
    for (int k = 0; k < m->nv; ++k) x[k] = tau[k] - x[k];
}

/* Steps 3 and, by q, 4: adds the effect of a to A_p and f of all dofs; then Phi and E. */
RBDI_PART void rbdi_add_acceleration(const rbd_model *m, rbd_derivatives *d, const rbd_real *a) {
    const int base = d->base, first = base ? d->behind : 0;
    const rbdi_motion A = base ? rbdi_load_motion(a, 1) : rbdi_motion0();

    /* S a and F a of each dof, then their sums: A_p' and that of F a */
    rbdi_spread(d, base, rbdi_expand_v(m, a, d->work->ax), RBDI_FIELD(d, qdd));
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        cols->stage.response.A.joint = rbdi_b_motion_scale(cols->qdd, cols->S);
        cols->stage.response.F_qdd.n = rbdi_b_scale(cols->qdd, cols->F.n);
        cols->stage.response.F_qdd.f = rbdi_b_scale(cols->qdd, cols->F.f);
    }

    rbdi_sum_ancestors(d, base, RBDI_FIELD(d, stage.response.A), A, 0);
    rbdi_sum_components(d, d->segment, RBDI_FIELD(d, stage.response.F_qdd), RBDI_WRENCH_SUMS);

    /* A_p += A_p',  f += I A_p' + sum of F a */
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion A_p = cols->stage.response.A.p;
        const rbdi_bforce I_A_p = rbdi_inertia_times(&cols->sum, d->constants[b].subtree, A_p);

        cols->sum.f = rbdi_b_force_add(cols->sum.f, rbdi_b_force_add(I_A_p, cols->stage.response.F_qdd));
        cols->A.p = rbdi_b_motion_add(cols->A.p, A_p);
    }

    rbdi_columns_by_q(d);
}

/* Adds [s]x to three rows and columns of a matrix that has nv columns. */
RBDI_INLINE void rbdi_add_skew(rbd_real *out, ptrdiff_t nv, rbdi_v3 s) {
    const rbd_real x[3] = {s.x, s.y, s.z};

    for (int i = 0; i < 3; ++i, out += nv) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[j] = out[j] - x[k];
        out[k] = out[k] + x[j];
    }
}

/* Replaces y, in d->a, by a, and the derivatives by_q and by_v of y, either of which may be NULL, by those of
   a. v: its first six are (w; u) of the base. The formulas are those of [forward dynamics code]. */
RBDI_PART void rbdi_from_base(const rbd_model *m, const rbd_derivatives *d, const rbd_real *v, rbd_real *by_q,
                              rbd_real *by_v) {
    const ptrdiff_t nv = m->nv;
    const rbdi_v3 w = rbdi_load_vec(v, 1), u = rbdi_load_vec(v + 3, 1),
                  g = rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(d->work->gravity)),
                  y_v = rbdi_load_vec(d->a + 3, 1);
    rbd_real *turn[3];

    /* the columns by w from the places of rbdi_place_turns to their own; the base's others are 0 */
    if (by_v) rbdi_place_turns(by_q, by_v, turn);
    for (ptrdiff_t r = 0; r < nv * nv; r += nv) {
        if (by_v) {
            rbdi_store_vec(by_v + r, 1, rbdi_vec(turn[0][r], turn[1][r], turn[2][r]));
            rbdi_store_vec(by_v + r + 3, 1, rbdi_vec0());
        }
        if (by_q) rbdi_clear(by_q + r, 6);
    }

    /* v_dot, and what its rows have beyond those of y_v */
    rbdi_store_vec(d->a + 3, 1, rbdi_add(rbdi_sub(y_v, rbdi_cross(w, u)), g));
    if (by_q) rbdi_add_skew(by_q + 3 * nv, nv, g);
    if (by_v) {
        rbdi_add_skew(by_v + 3 * nv, nv, u);
        rbdi_add_skew(by_v + 3 * nv + 3, nv, rbdi_sub(rbdi_vec0(), w));
    }
}

/* Steps 1 and 2: the columns, the factor of M in w->H, and a (of a free base y) in d->a. need: what of the
   columns is needed. Returns whether a pivot is in doubt. */
RBDI_INLINE rbdi_mask rbdi_solve_acceleration(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                              const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                              int need, rbd_real *Minv) {
    rbd_work *w = d->work;
    rbdi_mask doubt;

    /* columns, M and tau - c; with mimic joints M is not that of the columns' dofs */
    if (rbdi_mimics(m)) rbd_crba_packed(m, w, q, w->H);
    rbdi_common(m, d, q, v, w->zero, w->gravity, f_ext, need);
    if (!rbdi_mimics(m)) rbdi_put_packed(m, d, w->H);
    rbdi_net_torque(m, d, tau, d->a);

    doubt = rbdi_factor(m, w, w->H);
    if (!rbdi_mimics(m)) doubt = rbdi_or(doubt, rbdi_far_pivots(d));

    /* in doubt, M anew from the links' frames; then w->pivot has the verdicts for rbdi_pivot_status */
    w->singular = -1;
    if (rbdi_any(doubt)) rbdi_factor_again(m, w);

    if (Minv) rbdi_invert(m, w, w->H, Minv);
    rbdi_solve(m, w, w->H, d->a);
    return doubt;
}

/* The rest of step 4, and step 5: da/dq and da/dv, one of them or both; of a free base those of y. */
RBDI_INLINE void rbdi_acceleration_derivatives(const rbd_model *m, rbd_derivatives *d, rbd_real *da_dq,
                                               rbd_real *da_dv) {
    const int first = rbdi_first_solved(d, da_dq, da_dv);
    rbd_real *one = da_dq ? da_dq + first : da_dv + first, *other = da_dq && da_dv ? da_dv + first : NULL;

    rbdi_put_entries(m, d, da_dq, da_dv, NULL, 0);
    if (d->base) rbdi_put_turns(d, da_dq, da_dv);

    if (other)
        rbdi_solve_two(m, d->work, d->work->H, -1, m->nv, m->nv - first, one, other);
    else
        rbdi_solve_columns(m, d->work, d->work->H, -1, m->nv, m->nv - first, one);
}

RBDI_API rbd_status rbd_fd_derivatives(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext,
                                       rbd_real *a, rbd_real *da_dq, rbd_real *da_dv, rbd_real *Minv) {
    const int nv = m ? m->nv : 0, need = RBDI_NEED_WRENCH | (da_dq || da_dv ? RBDI_NEED_V : 0);
    rbd_real *const result[3] = {da_dq, da_dv, Minv};
    rbdi_mask doubt;
    rbd_status status = rbdi_check_derivatives(m, d, q && v && tau);
    if (status) return status;

    /* d->a = a, or y of a free base */
    doubt = rbdi_solve_acceleration(m, d, q, v, tau, f_ext, need, Minv);
    if (rbdi_any(doubt)) status = rbdi_pivot_status(m, d->work, d->a, nv);

    if (da_dq) rbdi_add_acceleration(m, d, d->a);
    if (da_dq || da_dv) rbdi_acceleration_derivatives(m, d, da_dq, da_dv);

    /* from y to a */
    if (d->base) rbdi_from_base(m, d, v, da_dq, da_dv);
    if (a)
        for (int k = 0; k < nv; ++k) a[k] = d->a[k];
    if (!status) return RBD_OK;

    /* the results become 0 in the lanes that have an error */
    if (a) (void)rbdi_pivot_status(m, d->work, a, nv);
    for (int k = 0; k < 3; ++k)
        if (result[k]) (void)rbdi_pivot_status(m, d->work, result[k], nv * nv);
    return status;
}
#endif

/* ==== src/derivatives/regressors.h ==== */
/* Interface: rbdi_regress_body, rbdi_regressor_motion */

/* ---- regressors and inertial parameters [identification code] ----
   f = I a + v x* I v (RBDA table 5.1) is linear in a body's parameters, f = K pi: row i of Y is S_i' K. */

/* Four parameters of a body, or their factors. A row of K has three such parts: m and m c; xx xy xz yy; xz yy
   yz zz, where the last two overlap. All formulas below are the same for each of the four, as for the
   components of a vector. add: y += factor x; scale: y = factor x. */
typedef struct rbdi_four {
    rbd_real x, y, z, w;
} rbdi_four;

RBDI_INLINE void rbdi_set_four(rbdi_four *y, rbd_real a, rbd_real b, rbd_real c, rbd_real d) {
    y->x = a;
    y->y = b;
    y->z = c;
    y->w = d;
}

RBDI_INLINE void rbdi_scale_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) {
    rbdi_set_four(y, x->x * factor, x->y * factor, x->z * factor, x->w * factor);
}

RBDI_INLINE void rbdi_add_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) {
    rbdi_set_four(y, y->x + x->x * factor, y->y + x->y * factor, y->z + x->z * factor, y->w + x->w * factor);
}

/* y += a_1 x_1 + a_2 x_2 + a_3 x_3; and y = this sum. */
RBDI_INLINE void rbdi_add_fours(rbdi_four *y, rbdi_v3 a, const rbdi_four x[3]) {
    rbdi_add_four(y, a.x, &x[0]);
    rbdi_add_four(y, a.y, &x[1]);
    rbdi_add_four(y, a.z, &x[2]);
}

RBDI_INLINE void rbdi_combine_fours(rbdi_four *y, rbdi_v3 a, const rbdi_four x[3]) {
    rbdi_scale_four(y, a.x, &x[0]);
    rbdi_add_four(y, a.y, &x[1]);
    rbdi_add_four(y, a.z, &x[2]);
}

/* (x R) of a body as described: its origin and axes in the common frame. A row is four scalars, for the
   parameters m and m c: a' (x R) = (a' x; R' a). */
typedef struct rbdi_placement {
    rbdi_four row[3];
} rbdi_placement;

/* (x R) = (r 0) + E' (r_b E_b'), with the pose (E, r) of the link, and r_b and E_b of the body on it. */
RBDI_INLINE void rbdi_place_body(const rbd_model *m, const rbd_derivatives *d, const rbdi_frame *body,
                                 rbdi_placement *p) {
    const rbdi_pose X = rbdi_common_pose(m, d, body->link);
    const rbd_real o = rbdi_zero();
    const rbd_const *E = body->E;
    rbdi_four own[3]; /* (r_b E_b') */

    rbdi_set_four(&own[0], rbdi_set(body->r.x), rbdi_set(E[0]), rbdi_set(E[3]), rbdi_set(E[6]));
    rbdi_set_four(&own[1], rbdi_set(body->r.y), rbdi_set(E[1]), rbdi_set(E[4]), rbdi_set(E[7]));
    rbdi_set_four(&own[2], rbdi_set(body->r.z), rbdi_set(E[2]), rbdi_set(E[5]), rbdi_set(E[8]));

    rbdi_set_four(&p->row[0], X.r.x, o, o, o);
    rbdi_set_four(&p->row[1], X.r.y, o, o, o);
    rbdi_set_four(&p->row[2], X.r.z, o, o, o);

    rbdi_add_fours(&p->row[0], rbdi_vec(X.E.xx, X.E.yx, X.E.zx), own);
    rbdi_add_fours(&p->row[1], rbdi_vec(X.E.xy, X.E.yy, X.E.zy), own);
    rbdi_add_fours(&p->row[2], rbdi_vec(X.E.xz, X.E.yz, X.E.zz), own);
}

/* R' a, and the origin x. */
RBDI_INLINE rbdi_v3 rbdi_to_body(const rbdi_placement *p, rbdi_v3 a) {
    rbdi_four y;
    rbdi_combine_fours(&y, a, p->row);
    return rbdi_vec(y.y, y.z, y.w);
}

RBDI_INLINE rbdi_v3 rbdi_origin_of(const rbdi_placement *p) {
    return rbdi_vec(p->row[0].x, p->row[1].x, p->row[2].x);
}

/* The motion of all links. base: dofs of a free base whose axes the frame has, or 0. */
RBDI_PART void rbdi_link_motions(rbd_derivatives *d, int base) {
    for (int b = rbdi_first_inertia(d, base); b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion V = rbdi_b_motion_add(cols->V.p, cols->V.joint),
                           A = rbdi_b_motion_add(cols->A.p, cols->A.joint);

        cols->stage.link.Omega = rbdi_b_omega(V.omega, A.omega);
        cols->stage.link.acc = rbdi_b_classical(V, A);
        cols->stage.link.omega = V.omega;
        cols->stage.link.omega_dot = A.omega;
    }
}

/* The columns of I w_dot + w x I w by xx xy xz yy yz zz of I, three rows: `some` has xx xy xz yy, `rest`
   has xz yy yz zz. */
RBDI_INLINE void rbdi_unit_moments(rbdi_v3 w, rbdi_v3 w_dot, rbdi_four some[3], rbdi_four rest[3]) {
    const rbd_real x = w_dot.x, y = w_dot.y, z = w_dot.z;
    const rbd_real xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z, xx = w.x * w.x, yy = w.y * w.y,
                   zz = w.z * w.z;

    rbdi_set_four(&some[0], x, y - xz, z + xy, -yz);
    rbdi_set_four(&some[1], xz, x + yz, zz - xx, y);
    rbdi_set_four(&some[2], -xy, xx - yy, x - yz, xy);

    rbdi_set_four(&rest[0], z + xy, -yz, yy - zz, yz);
    rbdi_set_four(&rest[1], zz - xx, y, z - xy, -xz);
    rbdi_set_four(&rest[2], x - yz, xy, y + xz, z);
}

/* K of a body, its wrenches for unit parameters in the common frame: six rows of ten, moments and forces.
   last: the last dof of its link. With its origin x and its axes e, and acc of the link-fixed point there,

       m         (x x acc; acc)
       m c       (e x acc + x x Omega e; Omega e)
       inertia   (I omega_dot + omega x I omega, in body axes; 0), where the zeros are not written */
RBDI_PART void rbdi_unit_wrenches(const rbd_derivatives *d, int last, const rbdi_placement *p, rbd_real *K,
                                  ptrdiff_t stride) {
    const rbd_real *w_in = RBDI_OF(d, last, stage.link.omega),
                   *w_dot_in = RBDI_OF(d, last, stage.link.omega_dot);
    const rbdi_v3 w = rbdi_to_body(p, rbdi_load_vec(w_in, RBDI_BATCH)),
                  w_dot = rbdi_to_body(p, rbdi_load_vec(w_dot_in, RBDI_BATCH));
    const rbd_real *Omega = RBDI_OF(d, last, stage.link.Omega), *acc = RBDI_OF(d, last, stage.link.acc),
                   o = rbdi_zero();
    rbdi_four f[3], some[3], rest[3];

    rbdi_unit_moments(w, w_dot, some, rest);

    /* row i of the forces: (acc_i 0 0 0) + Omega_i (x R); of the moments of inertia: R_i times those in
       body axes */
    RBDI_UNROLL_SIX for (int i = 0; i < 3; ++i) {
        const rbdi_v3 R = rbdi_vec(p->row[i].y, p->row[i].z, p->row[i].w);
        rbdi_set_four(&f[i], acc[i * RBDI_BATCH], o, o, o);
        rbdi_add_fours(&f[i], rbdi_load_vec(Omega + 3 * i * RBDI_BATCH, RBDI_BATCH), p->row);
        *(rbdi_four *)&K[(3 + i) * stride] = f[i];
        rbdi_combine_fours((rbdi_four *)&K[i * stride + 4], R, some);
        rbdi_combine_fours((rbdi_four *)&K[i * stride + 6], R, rest);
    }

    /* row i of the moments of m and m c: (x R) x acc + x x f. The first has x x acc twice */
    RBDI_UNROLL_SIX for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        rbdi_four n;
        rbdi_scale_four(&n, f[k].x, &p->row[j]);
        rbdi_add_four(&n, -f[j].x, &p->row[k]);
        rbdi_add_four(&n, p->row[j].x, &f[k]);
        rbdi_add_four(&n, -p->row[k].x, &f[j]);
        *(rbdi_four *)&K[i * stride] = n;
        K[i * stride] = K[i * stride] * RBD_C(0.5);
    }
}

/* y = S' K, ten scalars: 0 to 3, 4 to 7 and 6 to 9, where the last two overlap. */
RBDI_INLINE void rbdi_regress(const rbd_real *K, ptrdiff_t stride, rbdi_motion S, rbd_real *y) {
    static const int at[3] = {0, 4, 6};
    rbdi_four sum[3];

    RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) {
        const rbd_real *k = K + at[j];
        rbdi_scale_four(&sum[j], S.omega.x, (const rbdi_four *)k);
        rbdi_add_four(&sum[j], S.omega.y, (const rbdi_four *)(k + stride));
        rbdi_add_four(&sum[j], S.omega.z, (const rbdi_four *)(k + 2 * stride));
    }

    rbdi_add_four(&sum[0], S.v.x, (const rbdi_four *)(K + 3 * stride));
    rbdi_add_four(&sum[0], S.v.y, (const rbdi_four *)(K + 4 * stride));
    rbdi_add_four(&sum[0], S.v.z, (const rbdi_four *)(K + 5 * stride));

    RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) { *(rbdi_four *)&y[at[j]] = sum[j]; }
}

/* A body's ten columns of the regressor, Y, whose rows are `columns` apart; after rbdi_link_motions. A free
   base's six rows are the unit wrenches themselves. */
RBDI_PART void rbdi_regress_body(const rbd_model *m, const rbd_derivatives *d, const rbdi_frame *body,
                                 rbd_real *Y, ptrdiff_t columns) {
    /* copies, which no store can change */
    const rbdi_entry *entry = d->entry;
    const rbd_real *S = RBDI_FIELD(d, S);
    const int base = d->base;
    const ptrdiff_t stride = base ? columns : 10;
    rbd_real own[60], *K = base ? Y : own;
    rbdi_placement p;
    int k = rbdi_last_dof(m, body->link);

    rbdi_place_body(m, d, body, &p);
    rbdi_unit_wrenches(d, k, &p, K, stride);

    for (; k >= base; k = entry[k].parent) {
        rbd_real *y = Y + entry[k].user * columns;
        const rbdi_motion S_k = rbdi_load_motion(S + entry[k].at, RBDI_BATCH);

        if (rbdi_mimics(m)) {
            const rbd_real ratio = rbdi_ratio(m, entry[k].source);
            rbd_real part[10];
            rbdi_regress(K, stride, S_k, part);
            for (int j = 0; j < 10; ++j) y[j] = y[j] + part[j] * ratio;
        } else {
            rbdi_regress(K, stride, S_k, y);
        }
    }
}

/* The motion that the regressor of every body is made of. */
RBDI_PART void rbdi_regressor_motion(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *a) {
    const int base = d->base;
    rbdi_common_motion(m, d, base, q, v, a, d->work->gravity, RBDI_NEED_WRENCH | RBDI_NEED_WHOLE);
    rbdi_link_motions(d, base);
}

RBDI_API rbd_status rbd_regressor(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                  const rbd_real *v, const rbd_real *a, rbd_real *Y) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && a && Y);
    const ptrdiff_t columns = m ? 10 * m->nb : 0;
    if (status) return status;

    rbdi_regressor_motion(m, d, q, v, a);
    if (!d->keep_zeros || rbdi_mimics(m)) rbdi_clear(Y, m->nv * 10 * m->nb);

    for (int i = 0; i < m->nb; ++i, Y += 10)
        if (m->frame[i].link >= 0) rbdi_regress_body(m, d, &m->frame[i], Y, columns);
    return RBD_OK;
}

/* v' I v / 2 = y pi of a body on a link, with velocity omega and v_o of the body's origin in its axes:

       y = (v_o' v_o / 2; v_o x omega; omega_x^2 / 2, omega_x omega_y, omega_x omega_z, omega_y^2 / 2,
            omega_y omega_z, omega_z^2 / 2)

   The common frame moves: the world has the velocity `world` in it. */
RBDI_PART void rbdi_put_kinetic(const rbd_model *m, const rbd_derivatives *d, int link, rbdi_motion world,
                                const rbdi_placement *p, rbd_real *y) {
    const int last = rbdi_last_dof(m, link);
    const rbd_const half = RBD_C(0.5);
    const rbdi_motion V = rbdi_motion_add(rbdi_load_motion(RBDI_OF(d, last, V.p), RBDI_BATCH),
                                          rbdi_load_motion(RBDI_OF(d, last, V.joint), RBDI_BATCH));
    const rbdi_v3 v = rbdi_add(rbdi_sub(V.v, world.v), rbdi_cross(V.omega, rbdi_origin_of(p)));
    const rbdi_v3 omega = rbdi_to_body(p, V.omega), v_o = rbdi_to_body(p, v);

    y[0] = rbdi_dot(v_o, v_o) * half;
    rbdi_store_vec(y + 1, 1, rbdi_cross(v_o, omega));
    y[4] = omega.x * omega.x * half;
    y[5] = omega.x * omega.y;
    y[6] = omega.x * omega.z;
    y[7] = omega.y * omega.y * half;
    y[8] = omega.y * omega.z;
    y[9] = omega.z * omega.z * half;
}

/* m minus_g' (place of c) = y pi: y = (minus_g' (place + x); R' minus_g), with the place of the common
   origin. */
RBDI_PART void rbdi_put_potential(const rbd_derivatives *d, rbdi_v3 place, const rbdi_placement *p,
                                  rbd_real *Y) {
    const rbdi_v3 minus_g = rbdi_sub(rbdi_vec0(), rbdi_vec_c(d->work->gravity));
    rbdi_four *y = (rbdi_four *)Y;
    rbdi_set_four(y, rbdi_dot(minus_g, place), rbdi_zero(), rbdi_zero(), rbdi_zero());
    rbdi_add_fours(y, minus_g, p->row);
}

/* The frame has the axes of the world here, with a free base too. Its dofs then have columns S like all
   others; at the end they get back their unit vectors. */
RBDI_API rbd_status rbd_energy_regressors(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                          const rbd_real *v, rbd_real *Y_kinetic, rbd_real *Y_potential) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && (v || !Y_kinetic));
    if (status) return status;

    rbdi_common_motion(m, d, 0, q, v, NULL, d->work->gravity, Y_kinetic ? RBDI_NEED_V : 0);
    if (Y_kinetic) rbdi_clear(Y_kinetic, 10 * m->nb);
    if (Y_potential) rbdi_clear(Y_potential, 10 * m->nb);

    for (int i = 0; i < m->nb; ++i) {
        const rbdi_frame *body = &m->frame[i];
        int root = body->link;
        rbdi_placement p;
        if (root < 0) continue;

        while (m->link[root].parent >= 0) root = m->link[root].parent;
        rbdi_place_body(m, d, body, &p);

        if (Y_kinetic) {
            const rbd_real *world = RBDI_OF(d, m->link[root].first, V.p);
            rbdi_put_kinetic(m, d, body->link, rbdi_load_motion(world, RBDI_BATCH), &p, Y_kinetic + 10 * i);
        }
        if (Y_potential) rbdi_put_potential(d, rbdi_place_of(m, d, root), &p, &Y_potential[10 * i]);
    }

    rbdi_init_base(d);
    return RBD_OK;
}

/* RBDA 2.63: the inertia about the origin is that about the centre of mass + m (c'c - c c'). */
RBDI_API rbd_status rbd_body_parameters(const rbd_model *m, int body, rbd_const pi[10]) {
    const rbdi_frame *u;
    rbd_const mass, x, y, z;
    if (!m || !pi) return RBD_ERR_NULL;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    u = &m->frame[body];
    mass = u->mass;
    x = u->com.x;
    y = u->com.y;
    z = u->com.z;

    pi[0] = mass;
    pi[1] = mass * x;
    pi[2] = mass * y;
    pi[3] = mass * z;
    pi[4] = u->I.xx + mass * (y * y + z * z);
    pi[5] = u->I.xy - mass * x * y;
    pi[6] = u->I.xz - mass * x * z;
    pi[7] = u->I.yy + mass * (x * x + z * z);
    pi[8] = u->I.yz - mass * y * z;
    pi[9] = u->I.zz + mass * (x * x + y * y);
    return RBD_OK;
}

#ifndef RBD_NO_BUILD
/* The reverse: com = pi[1 .. 3] / m, and the inertia about it. */
RBDI_API rbd_status rbd_set_parameters(rbd_body *body, const rbd_const pi[10]) {
    double com[3], mass;
    if (!body || !pi) return RBD_ERR_NULL;

    mass = (double)pi[0];
    for (int k = 0; k < 3; ++k) com[k] = mass > 0 || mass < 0 ? (double)pi[1 + k] / mass : 0;
    body->mass = mass;
    for (int k = 0; k < 3; ++k) body->com[k] = com[k];

    body->inertia[0] = (double)pi[4] - mass * (com[1] * com[1] + com[2] * com[2]);
    body->inertia[1] = (double)pi[5] + mass * com[0] * com[1];
    body->inertia[2] = (double)pi[6] + mass * com[0] * com[2];
    body->inertia[3] = (double)pi[7] - mass * (com[0] * com[0] + com[2] * com[2]);
    body->inertia[4] = (double)pi[8] + mass * com[1] * com[2];
    body->inertia[5] = (double)pi[9] - mass * (com[0] * com[0] + com[1] * com[1]);
    return RBD_OK;
}

/* Sigma = tr(I)/2 - I about the centre of mass must be semidefinite up to the rounding of pi. */
RBDI_API rbd_status rbd_check_parameters(const rbd_const pi[10]) {
    rbd_body b;
    double trace, size = 0, Sigma[6];
    if (!pi) return RBD_ERR_NULL;
    if (!(pi[0] >= 0 && rbdi_is_finite(rbdi_set(pi[0])))) return RBD_ERR_MASS;
    for (int k = 1; k < 4; ++k)
        if (!rbdi_is_finite(rbdi_set(pi[k])) || (!(pi[0] > 0) && (pi[k] < 0 || pi[k] > 0)))
            return RBD_ERR_COM;

    for (int k = 4; k < 10; ++k) size += (double)(pi[k] < 0 ? -pi[k] : pi[k]);
    if (size <= 0) return RBD_OK;

    rbd_set_parameters(&b, pi);
    trace = b.inertia[0] + b.inertia[3] + b.inertia[5];
    for (int k = 0; k < 6; ++k) Sigma[k] = (k == 0 || k == 3 || k == 5 ? trace / 2 : 0) - b.inertia[k];
    size = trace + 64 * (double)RBDI_EPS / RBDI_SEMIDEFINITE * size;
    return rbdi_semidefinite(Sigma, size) ? RBD_OK : RBD_ERR_INERTIA;
}
#endif

/* ==== src/derivatives/steps.h ==== */
/* Interface: rbdi_columns_before, rbdi_move_columns, rbdi_unforced_columns */

/* ---- derivatives of steps on the configuration manifold [steps code] ----
   Of spherical, planar and floating joints; the coordinates of others add up, so their derivatives are 1 and
   -1. For a step d = (w; u), with zeros where a joint has fewer than six dofs, and ad = ([w]x, 0; [u]x, [w]x)

       integrate     by q  exp(-ad)         by d   J_r = (1 - exp(-ad)) / ad
       difference    by q0 -J_r^-1(-d)      by q1  J_r^-1(d)

   ad is the dual number [w]x + eps [u]x: a function f(ad) has f([w]x) = 1 + k1 [w]x + k2 [w]x^2 on the
   diagonal and the derivative of f([w]x) along u below it. k1 and k2 are functions of x = w'w. With t_n = sum
   over k of (-x)^k / (n + 2k)!, where 2 dt_n/dx = n t_n+2 - t_n+1, they are

       exp(-ad)   k1 = -t_1, k2 = t_2
       J_r        k1 = -t_2, k2 = t_3
       J_r^-1     k1 = 1/2,  k2 = (t_3 - 2 t_4) / (2 t_2)

   Sola, Deray and Atchuthan (2018) for J_r; Barfoot, State Estimation for Robotics (2017), 7.1.5. */

/* f(ad): k1, k2 and their derivatives by x. */
typedef struct rbdi_ad_function {
    rbd_real k1, k2, dk1, dk2;
} rbdi_ad_function;

/* t_0 .. t_6 of a turn w: t_0 = cos, t_1 = sin / angle; from the series where x < 1, else
   t_n = (1 / (n - 2)! - t_n-2) / x. */
RBDI_LOCAL void rbdi_tails(rbdi_v3 w, rbd_real t[7]) {
    const rbdi_exp e = rbdi_exp_of(w);
    const rbd_real one = rbdi_set(RBD_C(1));
    const rbdi_mask near_zero = rbdi_less(e.x, one);
    const rbd_real x = rbdi_select(near_zero, e.x, rbdi_zero());

    t[0] = one - e.x * e.B;
    t[1] = (e.half_sine + e.half_sine) * e.half_cosine;
    t[2] = e.B;
    t[3] = e.C;

    for (int n = 4; n < 7; ++n) {
        const rbd_real inverse_factorial = rbdi_set(RBD_C(1) / (rbd_const)(n == 4 ? 2 : n == 5 ? 6 : 24));
        t[n] = rbdi_select(near_zero, rbdi_tail(x, n), (inverse_factorial - t[n - 2]) / e.x);
    }
}

/* dt_n/dx = (n t_n+2 - t_n+1) / 2. */
RBDI_INLINE rbd_real rbdi_tail_slope(const rbd_real t[7], int n) {
    return (t[n + 2] * (rbd_const)n - t[n + 1]) * RBD_C(0.5);
}

enum { RBDI_EXP_MINUS_AD, RBDI_J_R, RBDI_J_R_INVERSE };

/* k1 and k2 of the table above, and their derivatives. */
RBDI_LOCAL rbdi_ad_function rbdi_ad_function_of(int which, const rbd_real t[7]) {
    const int n = which == RBDI_EXP_MINUS_AD ? 1 : 2;
    rbdi_ad_function f;

    if (which == RBDI_J_R_INVERSE) {
        const rbd_real half = rbdi_set(RBD_C(0.5)), factor = half / t[2], slope = rbdi_tail_slope(t, 4);
        f.k1 = half;
        f.dk1 = rbdi_zero();
        f.k2 = (t[3] - (t[4] + t[4])) * factor;
        f.dk2 = (rbdi_tail_slope(t, 3) - (slope + slope) - (f.k2 + f.k2) * rbdi_tail_slope(t, 2)) * factor;
        return f;
    }

    f.k1 = -t[n];
    f.dk1 = -rbdi_tail_slope(t, n);
    f.k2 = t[n + 1];
    f.dk2 = rbdi_tail_slope(t, n + 1);
    return f;
}

/* J = scale f(ad) of the step d = (w; u):

       diagonal   1 + k1 [w]x + k2 [w]x^2                                     [w]x^2 = w w' - x
       below it   k1 [u]x + k2 (w u' + u w' - slope) + slope (dk1 [w]x + dk2 [w]x^2)

   with slope = 2 w'u, the derivative of x along u. */
RBDI_LOCAL void rbdi_fill_ad(rbdi_ad_function f, rbdi_motion d, rbd_real scale, rbd_real J[6][6]) {
    const rbd_real w[3] = {d.omega.x, d.omega.y, d.omega.z}, u[3] = {d.v.x, d.v.y, d.v.z};
    const rbd_real x = rbdi_dot(d.omega, d.omega), slope = rbdi_dot(d.omega, d.v) + rbdi_dot(d.omega, d.v);

    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int k = 3 - i - j, even = (j - i + 3) % 3 == 2; /* [w]x_ij = w_k, or -w_k */
            rbd_real turn = rbdi_zero(), shift = rbdi_zero(), ww = w[i] * w[j],
                     wu = w[i] * u[j] + u[i] * w[j];
            if (i == j) {
                ww = ww - x;
                wu = wu - slope;
            } else {
                turn = even ? w[k] : -w[k];
                shift = even ? u[k] : -u[k];
            }

            J[i][j] = f.k1 * turn + f.k2 * ww;
            if (i == j) J[i][j] = J[i][j] + rbdi_set(RBD_C(1));
            J[i][j] = J[3 + i][3 + j] = J[i][j] * scale;
            J[i][3 + j] = rbdi_zero();
            J[3 + i][j] = (f.k1 * shift + f.k2 * wu + slope * (f.dk1 * turn + f.dk2 * ww)) * scale;
        }
}

/* Writes scale f(ad) of the step sign d as a joint's block of a matrix that is 0. f = 1 for joints whose
   coordinates add up. */
RBDI_LOCAL void rbdi_put_step(const rbd_model *m, const rbdi_frame *body, int which, const rbd_real *d,
                              rbd_real sign, rbd_real scale, rbd_real *out) {
    const ptrdiff_t nv = m->nv;
    const int first = rbdi_first_axis(body->type);
    rbd_real t[7], J[6][6];
    rbdi_motion step;

    out += body->iv * nv + body->iv;
    if (!rbdi_joint_turns(body)) {
        for (int k = 0; k < body->nv; ++k) out[k * nv + k] = scale;
        return;
    }

    step = rbdi_joint_motion(body, d, 1);
    step.omega = rbdi_scale(sign, step.omega);
    step.v = rbdi_scale(sign, step.v);

    rbdi_tails(step.omega, t);
    rbdi_fill_ad(rbdi_ad_function_of(which, t), step, scale, J);
    for (int i = 0; i < body->nv; ++i)
        for (int j = 0; j < body->nv; ++j) out[i * nv + j] = J[first + i][first + j];
}

RBDI_API rbd_status rbd_integrate_derivatives(const rbd_model *m, const rbd_real *v, rbd_real dt,
                                              rbd_real *dnext_dq, rbd_real *dnext_dv) {
    const rbd_real one = rbdi_set(RBD_C(1));
    if (!m || !v) return RBD_ERR_NULL;

    if (dnext_dq) rbdi_clear(dnext_dq, m->nv * m->nv);
    if (dnext_dv) rbdi_clear(dnext_dv, m->nv * m->nv);

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];
        const rbd_real *d = body->nv > 0 ? &v[body->iv] : v;
        if (dnext_dq && body->nv > 0) rbdi_put_step(m, body, RBDI_EXP_MINUS_AD, d, dt, one, dnext_dq);
        if (dnext_dv && body->nv > 0) rbdi_put_step(m, body, RBDI_J_R, d, dt, dt, dnext_dv);
    }
    return RBD_OK;
}

/* Replaces the rows of M by M dv~/dv, v~ = v + dt w x (u + w x c), for steps whose points c move straight.
   With the velocity (w; u) of a joint that turns, a row (n; f) becomes

       n + dt (u + w x c) x f + c x (dt f x w),   f + dt f x w */
RBDI_PART void rbdi_unforced_columns(const rbd_model *m, int points, const rbd_real *v, rbd_real dt, int rows,
                                     rbd_real *M) {
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];
        rbdi_motion V;
        rbdi_v3 c;
        if (!rbdi_joint_turns(body)) continue;

        c = rbdi_straight_point(m, body, points);
        V = rbdi_motion_of_point(rbdi_joint_motion(body, &v[body->iv], 1), c);
        for (rbd_real *row = M + body->iv; row < M + rows * m->nv; row += m->nv) {
            rbdi_motion part = rbdi_joint_motion(body, row, 1);
            const rbdi_v3 gain = rbdi_scale(dt, rbdi_cross(part.v, V.omega));

            part.omega = rbdi_add(part.omega, rbdi_scale(dt, rbdi_cross(V.v, part.v)));
            part.omega = rbdi_add(part.omega, rbdi_cross(c, gain));
            part.v = rbdi_add(part.v, gain);
            rbdi_put_joint_motion(body, part, row, 1);
        }
    }
}

/* Replaces rows of a joint that turns: the derivatives dq of `moved` = (w; v) by those of the q that it
   reaches in dt with its point c straight (rbdi_move_turning), the derivatives dv of `nu` by those of its
   components in the axes there. Linear parts are those of c, until the end. With
   E = exp(-dt [w]x), E nu = (end_w; end_v), and the step (e; s) of the joint's own q that a column is by:

       turn = dt J_r(dt w) dw
       dq_next = (E e + turn; E (s + dt e x v + dt dv))
       dv_next = E dnu + (end_w x turn; end_v x turn)

   n: number of columns; own: the first column by the joint's own q, -1 = none */
RBDI_LOCAL void rbdi_turn_columns(const rbdi_frame *body, rbdi_v3 c, int n, const rbd_real *moved,
                                  const rbd_real *nu, rbd_real dt, int own, rbd_real *dq, rbd_real *dv) {
    const rbdi_motion V = rbdi_motion_of_point(rbdi_joint_motion(body, moved, 1), c),
                      end = rbdi_motion_of_point(rbdi_joint_motion(body, nu, 1), c);
    const rbdi_v3 origin = rbdi_sub(rbdi_vec0(), c);
    const rbdi_v3 w = rbdi_scale(dt, V.omega), back = rbdi_scale(-dt, V.omega);
    const rbdi_exp e = rbdi_exp_of(w);
    const rbdi_v3 end_w = rbdi_turn_back(e, w, end.omega), end_v = rbdi_turn_back(e, w, end.v);

    for (int k = 0; k < n; ++k, ++dq, ++dv) {
        rbdi_motion position = rbdi_motion_of_point(rbdi_joint_motion(body, dq, n), c),
                    velocity = rbdi_motion_of_point(rbdi_joint_motion(body, dv, n), c);
        const rbdi_v3 turn = rbdi_scale(dt, rbdi_exp_shift(e, back, position.omega));

        position.omega = turn;
        position.v = rbdi_scale(dt, position.v);
        if (own >= 0 && k >= own && k < own + body->nv) {
            rbd_real unit[6] = {rbdi_zero(), rbdi_zero(), rbdi_zero(), rbdi_zero(), rbdi_zero(), rbdi_zero()};
            rbdi_motion step;
            unit[k - own] = rbdi_set(RBD_C(1));
            step = rbdi_motion_of_point(rbdi_joint_motion(body, unit, 1), c);
            position.omega = rbdi_add(turn, rbdi_turn_back(e, w, step.omega));
            position.v = rbdi_add(rbdi_add(position.v, step.v), rbdi_scale(dt, rbdi_cross(step.omega, V.v)));
        }
        position.v = rbdi_turn_back(e, w, position.v);

        velocity.omega = rbdi_add(rbdi_turn_back(e, w, velocity.omega), rbdi_cross(end_w, turn));
        velocity.v = rbdi_add(rbdi_turn_back(e, w, velocity.v), rbdi_cross(end_v, turn));

        rbdi_put_joint_motion(body, rbdi_motion_of_point(position, origin), dq, n);
        rbdi_put_joint_motion(body, rbdi_motion_of_point(velocity, origin), dv, n);
    }
}

/* The same for all joints. Where coordinates add up, dq_next = e + dt dq and dv_next = dv. */
RBDI_PART void rbdi_move_columns(const rbd_model *m, int points, const rbd_real *moved, const rbd_real *nu,
                                 rbd_real dt, int by_q, rbd_real *dq, rbd_real *dv) {
    const ptrdiff_t n = m->nv;

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];

        if (rbdi_joint_turns(body)) {
            const rbdi_v3 c = rbdi_straight_point(m, body, points);
            rbdi_turn_columns(body, c, m->nv, &moved[body->iv], &nu[body->iv], dt, by_q ? body->iv : -1,
                              &dq[body->iv * n], &dv[body->iv * n]);
            continue;
        }

        for (int k = body->iv; k < body->iv + body->nv; ++k) {
            for (int j = 0; j < n; ++j) dq[k * n + j] = dq[k * n + j] * dt;
            if (by_q) dq[k * n + k] = dq[k * n + k] + rbdi_set(RBD_C(1));
        }
    }
}

/* Derivatives of the q and v of one joint, moved by v dt with its point c straight, v in the axes of the end:
   nv x nv each, of q by q and by v, of v by v. */
typedef struct rbdi_moved_joint {
    rbd_real q_q[36], q_v[36], v_v[36];
} rbdi_moved_joint;

RBDI_LOCAL rbdi_moved_joint rbdi_differentiate_move(const rbdi_frame *body, rbdi_v3 c, const rbd_real *v,
                                                    rbd_real dt) {
    const int n = body->nv;
    rbd_real none[36];
    rbdi_moved_joint by;

    for (int k = 0; k < 36; ++k) by.q_q[k] = by.q_v[k] = by.v_v[k] = none[k] = rbdi_zero();
    for (int k = 0; k < n; ++k) by.q_v[k * (n + 1)] = by.v_v[k * (n + 1)] = rbdi_set(RBD_C(1));
    if (rbdi_joint_turns(body)) {
        rbdi_turn_columns(body, c, n, v, v, dt, 0, by.q_q, none);
        rbdi_turn_columns(body, c, n, v, v, dt, -1, by.q_v, by.v_v);
        return by;
    }

    for (int k = 0; k < n; ++k) {
        by.q_q[k * (n + 1)] = rbdi_set(RBD_C(1));
        by.q_v[k * (n + 1)] = dt;
    }
    return by;
}

/* Replaces rows of derivatives by a state, F_q and F_v, by those by the state from which v moved it for dt:
   F_v = F_q dq/dv + F_v dv/dv, F_q = F_q dq/dq. F_v: NULL = not wanted. */
RBDI_PART void rbdi_columns_before(const rbd_model *m, int points, const rbd_real *v, rbd_real dt,
                                   rbd_real *F_q, rbd_real *F_v) {
    for (const rbdi_frame *body = m->frame; body < m->frame + m->nb; ++body) {
        const int n = body->nv;
        rbdi_moved_joint by;
        if (n == 0) continue;

        by = rbdi_differentiate_move(body, rbdi_straight_point(m, body, points), &v[body->iv], dt);
        for (int r = 0; r < m->nv; ++r) {
            rbd_real *q = &F_q[r * m->nv + body->iv], new_q[6], new_v[6];

            for (int j = 0; j < n; ++j) {
                new_q[j] = new_v[j] = rbdi_zero();
                for (int i = 0; i < n; ++i) {
                    new_q[j] = new_q[j] + q[i] * by.q_q[i * n + j];
                    new_v[j] = new_v[j] + q[i] * by.q_v[i * n + j];
                    if (F_v) new_v[j] = new_v[j] + F_v[r * m->nv + body->iv + i] * by.v_v[i * n + j];
                }
            }

            for (int j = 0; j < n; ++j) {
                q[j] = new_q[j];
                if (F_v) F_v[r * m->nv + body->iv + j] = new_v[j];
            }
        }
    }
}

RBDI_API rbd_status rbd_difference_derivatives(const rbd_model *m, const rbd_real *q0, const rbd_real *q1,
                                               rbd_real *dd_dq0, rbd_real *dd_dq1) {
    const rbd_real one = rbdi_set(RBD_C(1));
    if (!m || !q0 || !q1) return RBD_ERR_NULL;

    if (dd_dq0) rbdi_clear(dd_dq0, m->nv * m->nv);
    if (dd_dq1) rbdi_clear(dd_dq1, m->nv * m->nv);

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *body = &m->frame[b];
        rbd_real d[6];
        if (body->nv == 0) continue;

        rbdi_difference_joint(body, &q0[body->iq], &q1[body->iq], d);
        if (dd_dq0) rbdi_put_step(m, body, RBDI_J_R_INVERSE, d, -one, -one, dd_dq0);
        if (dd_dq1) rbdi_put_step(m, body, RBDI_J_R_INVERSE, d, one, one, dd_dq1);
    }
    return RBD_OK;
}

/* ==== src/rbd_derivatives.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("B")
#pragma pop_macro("C")
#pragma pop_macro("D")
#pragma pop_macro("E")
#pragma pop_macro("F")
#pragma pop_macro("H")
#pragma pop_macro("I")
#pragma pop_macro("J")
#pragma pop_macro("K")
#pragma pop_macro("L")
#pragma pop_macro("M")
#pragma pop_macro("O")
#pragma pop_macro("P")
#pragma pop_macro("R")
#pragma pop_macro("S")
#pragma pop_macro("T")
#pragma pop_macro("U")
#pragma pop_macro("V")
#pragma pop_macro("W")
#pragma pop_macro("X")
#pragma pop_macro("Y")

/* ==== src/rbd_derivatives.h ==== */
/* Headers that stand before this one declare their derivatives now. They implement them if they themselves
   are implemented in this file. */
#ifndef RBDI_JOINS_DERIVATIVES
#define RBDI_JOINS_DERIVATIVES
#if defined RBD_CONTACT_H && !defined RBDI_CONTACT_DERIVATIVES
#include "rbd_contact.h"
#elif defined RBD_CONSTRAINTS_H && !defined RBDI_CONSTRAINED_DERIVATIVES
#include "rbd_constraints.h"
#endif
#undef RBDI_JOINS_DERIVATIVES
#endif
