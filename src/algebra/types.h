#ifndef RBDI_ALGEBRA_TYPES_H
#define RBDI_ALGEBRA_TYPES_H
#include "api/configuration.h"

/* Flags of a link whose twist has a known angle. Macros, because C++20 warns where enumerators of two
   enumerations are combined. */
#define RBDI_TWIST_90 128 /* 90 degrees */
#define RBDI_TWIST_0 256  /* 0 */

/* c: of constants of the model. */
typedef struct rbdi_c3 {
    rbd_const x, y, z;
} rbdi_c3;

typedef struct rbdi_csym {
    rbd_const xx, xy, xz, yy, yz, zz;
} rbdi_csym;

typedef struct rbdi_v3 {
    rbd_real x, y, z;
} rbdi_v3;

typedef struct rbdi_sym { /* symmetric 3 x 3 */
    rbd_real xx, xy, xz, yy, yz, zz;
} rbdi_sym;

typedef struct rbdi_mat { /* 3 x 3 */
    rbd_real xx, xy, xz, yx, yy, yz, zx, zy, zz;
} rbdi_mat;

typedef struct rbdi_motion { /* angular, linear */
    rbdi_v3 omega, v;
} rbdi_motion;

typedef struct rbdi_force { /* moment, force */
    rbdi_v3 n, f;
} rbdi_force;

/* Velocity and classical acceleration of a link, in its own axes at its origin. */
typedef struct rbdi_state {
    rbdi_v3 omega, omega_dot, acc;
} rbdi_state;

typedef struct rbdi_rbi { /* composite rigid body; its mass is the constant subtree_mass */
    rbdi_sym Sigma;
    rbdi_v3 h;
} rbdi_rbi;

typedef struct rbdi_abi { /* articulated-body inertia [I H; H' M] */
    rbdi_sym I;
    rbdi_mat H;
    rbdi_sym M;
} rbdi_abi;

typedef struct rbdi_trig { /* cosine and sine of the joint angle; the slide d + kappa q */
    rbd_real c, s, d;
} rbdi_trig;

typedef struct rbdi_pose { /* x_child = E (x_parent - r) */
    rbdi_mat E;
    rbdi_v3 r;
} rbdi_pose;

#endif
