#ifndef RBDI_BASE_TOLERANCES_H
#define RBDI_BASE_TOLERANCES_H
#include "api/types.h"
#include "base/types.h"

/* ---- tolerances [tolerances] ----
   RBDI_EPS is one rounding of the scalar, RBDI_TINY the least pivot whose inverse is finite;
   RBDI_LEAST_SCALE is so large that every pivot up to RBDI_TINY is in doubt.

   A pivot in doubt is below RBDI_DOUBT times dof.scale, the largest inertia that its joint can move. Such a
   pivot must exceed RBDI_NOISE times the terms whose difference it is, or it is singular: 32
   roundings, because a pivot is a sum of many terms. An exact pivot can be rounding too: an axis that
   should go through a mass m misses it by L eps, L the distance to the frame that it is described in, and
   the pivot is m (L eps)^2. dof.scale has RBDI_ROD m L^2 in it. With RBDI_ROD = 16 eps / RBDI_DOUBT a pivot
   up to 16 eps m L^2 is in doubt, and one up to RBDI_NOISE RBDI_ROD m L^2 / 4 is singular: 6e-23 m L^2, far
   above the 5e-32 m L^2 of a rounding, and as far below any real robot, whose radius of gyration would be
   1e-11 L. In float 3e-18 m L^2, for descriptions are double. [pivots] derives the rest. */

#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_EPS 2.220446049250313e-16
#define RBDI_DOUBT 1e-7
#define RBDI_TINY 2.2250738585072014e-308
#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_EPS 1.1920929e-7f
#define RBDI_DOUBT 1e-3f
#define RBDI_TINY 1.17549435e-38f
#else
#define RBDI_EPS RBD_C(1.925929944387236e-34)
#define RBDI_DOUBT RBD_C(1.4e-17)
#define RBDI_TINY RBD_C(2.2250738585072014e-308)
#endif
#define RBDI_LEAST_SCALE (RBDI_TINY / RBDI_DOUBT)
#ifndef RBDI_NOISE                 /* tests/fuzz/pivots.c sets it to 0 */
#define RBDI_NOISE (32 * RBDI_EPS) /* of its bound a pivot must exceed this */
#endif
#define RBDI_BUILD \
    RBD_C(2.220446049250313e-16 / (double)RBDI_EPS) /* the build's rounding: descriptions are double */
#define RBDI_ROD (16 * (rbdi_wide)2.220446049250313e-16 / (rbdi_wide)RBDI_DOUBT) /* see rbdi_build_scale */

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
