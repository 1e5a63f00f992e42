#ifndef RBDI_CONTACT_TOLERANCES_H
#define RBDI_CONTACT_TOLERANCES_H
#include "base/tolerances.h"

/* ---- tolerances [tolerances] ---- */

/* RBDI_UNMOVED: a tangent below this share of its block's trace is rounding: no impulse moves it. A normal
   is a sum of squares: its rounding is below the square of the share.
   RBDI_ON_CONE: a contact at rest counts as sticking up to this times its largest friction.
   RBDI_LEFT_OF_SLOP: depths of this share of the slop that the first half of a step makes are left.
   RBDI_LOOSE: of the first solution the residual may be so many times larger: its velocities enter those of
   the end times dt and the velocity of what turns.
   RBDI_PROXIMAL: share of the trace that Newton steps add to the diagonal, [newton]. Ten times more costs
   iterations, which a test sees; with a tenth p is the same within the tolerance.
   RBDI_LEAST_SIZE: squares of smaller impulses (N s) are near the smallest number, or below it. For sizes up
   to a million times away both ways of computing agree to rounding, so no test sees ten times more or less.
   RBDI_SCALE_SPREAD: the scale of RBDI_PROXIMAL is at most so many times the diagonal's entry, of a normal.
   As there, no test sees ten times more or less.
   RBDI_SIDES_PROXIMAL: the same for derivatives, whose relative error is that times the condition of G. Ten
   times more is an error that random trees see; a tenth is near rounding, and no test sees it: tried.
   RBDI_FASTEST_SLIP: largest alpha / d of a contact that slips. Friction is 1e-9 of p_n then, so with ten
   times more or less all tests pass as well: tried.
   RBDI_JAMS: positions whose residual exceeds this share of the corrections have no solution. Where a contact
   jams the residual equals the corrections. */
#define RBDI_UNMOVED (16 * RBDI_EPS)
#define RBDI_ON_CONE (1 + 16 * RBDI_EPS)
#define RBDI_LEFT_OF_SLOP RBD_C(0.01)
#define RBDI_LOOSE RBD_C(10)
#define RBDI_SCALE_SPREAD RBD_C(1e4)
#define RBDI_SIDES_PROXIMAL (512 * RBDI_EPS)
#if RBDI_KIND(RBD_CONST) == 2
#define RBDI_PROXIMAL {1e-4f, 1e-3f, 1e-2f}
#define RBDI_CONTACT_TOLERANCE 1e-5f
#define RBDI_LEAST_SIZE 1e-15f
#else
#define RBDI_PROXIMAL {RBD_C(1e-7), RBD_C(1e-4), RBD_C(1e-2)}
#define RBDI_CONTACT_TOLERANCE RBD_C(1e-6)
#define RBDI_LEAST_SIZE RBD_C(1e-140)
#endif
#define RBDI_CONTACT_ITERATIONS 40
#define RBDI_NEAR_LIMIT RBD_C(0.02) /* rad or m: nearer limits are rows; a larger one costs time alone */

#define RBDI_ROOT_STEPS 60 /* for the root of one contact, six on average */
#define RBDI_FASTEST_SLIP RBD_C(1e9)
#define RBDI_JAMS RBD_C(0.99)
#define RBDI_MOST_SWEEPS 32 /* between two Newton steps */

#endif
