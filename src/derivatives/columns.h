#ifndef RBDI_DERIVATIVES_COLUMNS_H
#define RBDI_DERIVATIVES_COLUMNS_H
#include "derivatives/layout.h"
#include "algebra/batch_vectors.h"

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

#endif
