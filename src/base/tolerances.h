#ifndef RBDI_BASE_TOLERANCES_H
#define RBDI_BASE_TOLERANCES_H
#include "base/types.h"

/* ---- tolerances [tolerances] ----
   RBDI_EPS is one rounding of the scalar, RBDI_TINY the least pivot whose inverse is finite;
   RBDI_LEAST_SCALE is so large that every pivot up to RBDI_TINY is in doubt.

   A pivot below RBDI_DOUBT times dof.scale, the largest inertia that its joint can move, is in doubt. Such a
   pivot must exceed RBDI_NOISE times e, a bound of the terms whose difference it is, or it is singular: 32
   roundings, because a pivot is a sum of many terms. The largest pivot that was rounding in 20,000 singular
   models had 15 of rbd_aba and 4.3 of the factor (tests/one_word.c). [pivots] derives the rest.

   An exact pivot can be rounding too: an axis that should go through a mass m misses it by L eps, L the
   distance to the frame that it is described in, and the pivot is m (L eps)^2. dof.scale has RBDI_ROD m L^2
   in it. With RBDI_ROD = 16 eps / RBDI_DOUBT a pivot up to 16 eps m L^2 is in doubt, and one up to
   RBDI_NOISE RBDI_SHARE RBDI_ROD m L^2 is singular: 2.5e-26 m L^2, far above the 5e-32 m L^2 of a rounding,
   and far below any real robot, whose radius of gyration would be 2e-13 L. In float 1e-21 m L^2, for
   descriptions are double. The factor has a quarter in place of RBDI_SHARE.

   RBDI_SHARE: of dof.scale in rbd_aba's e. A chain of n rods has a dof.scale of n^3/3 rods: with a much
   larger share float chains of 200 rods are refused, with a much smaller one the rounding of a description
   passes.
   RBDI_TURN: a change of frame rounds by this share of RBDI_NOISE, a third of eps. It compounds along a
   chain: a larger one refuses float chains of 200 rods.
   RBDI_FAR: a joint that has slid by more than 4 times the size of what it moves is a doubt, see
   rbdi_slid_far. Ten times more lets rounding of 160 eps dof.scale pass, far below RBDI_DOUBT dof.scale; ten
   times less costs time alone.

   Tests see RBDI_DOUBT by the verdicts of RBDI_ROD. A larger one costs time alone otherwise. */

#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_EPS 2.220446049250313e-16
#define RBDI_DOUBT 1e-7
#define RBDI_SHARE 1e-4
#define RBDI_TINY 2.2250738585072014e-308
#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_EPS 1.1920929e-7f
#define RBDI_DOUBT 1e-3f
#define RBDI_SHARE 1e-4f
#define RBDI_TINY 1.17549435e-38f
#else
#define RBDI_EPS RBD_C(1.925929944387236e-34)
#define RBDI_DOUBT RBD_C(1.4e-17)
#define RBDI_SHARE RBD_C(0.25) /* descriptions are double, their rounding is far above eps */
#define RBDI_TINY RBD_C(2.2250738585072014e-308)
#endif
#define RBDI_LEAST_SCALE (RBDI_TINY / RBDI_DOUBT)
#ifndef RBDI_NOISE                 /* tests/fuzz/pivots.c sets it to 0 */
#define RBDI_NOISE (32 * RBDI_EPS) /* of its bound a pivot must exceed this */
#endif
#ifndef RBDI_TURN /* tests/test_bounds.c sets it to 0 */
#define RBDI_TURN RBD_C(0.01)
#endif
#define RBDI_FAR RBD_C(16) /* a square */
#define RBDI_BUILD \
    RBD_C(2.220446049250313e-16 / (double)RBDI_EPS) /* the build's rounding: descriptions are double */
#define RBDI_ROD (16 * (rbdi_wide)2.220446049250313e-16 / (rbdi_wide)RBDI_DOUBT) /* see rbdi_build_scale */

#define RBDI_FASTEST RBD_C(1e12)   /* m/s or rad/s: a step that makes more has overflowed, or would */
#define RBDI_UNBOUNDED RBD_C(1e30) /* as a bound or limit: none; as a residual: none could be computed */
#define RBDI_SHORT RBD_C(1e-30)    /* square of the shortest quaternion or (cos, sin) that has a direction */
#define RBDI_NO_ANGLE RBD_C(1e-30) /* added to squares of angles: quotients stay finite, no digit changes */
#define RBDI_TAIL_TERMS 15         /* of the series of sine and cosine for |x| < 1: 1/33! is below 1e-36 */
#define RBDI_ANGLE_START 0.43 /* t (2 - 0.43 t^2) for 2 atan(t), |t| < 1: within 0.02, cubed four times */
#define RBDI_SNAP \
    ((rbdi_wide)1e-12) /* rad: angles this close to a multiple of 90 degrees are taken as that */
#define RBDI_PARALLEL \
    ((rbdi_wide)1e-6)          /* sine of the angle below which axes of a universal joint are parallel */
#define RBDI_ORTHONORMAL 4e-6  /* of products of the rows of a rotation: six decimals in a file will do */
#define RBDI_SEMIDEFINITE 1e-9 /* share of an inertia by which a principal moment may seem negative */

#endif
