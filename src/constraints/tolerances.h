#ifndef RBDI_CONSTRAINTS_TOLERANCES_H
#define RBDI_CONSTRAINTS_TOLERANCES_H
#include "api/configuration.h"

/* ---- tolerances [tolerances] ---- */

/* RBDI_CLEAR: each pivot of Delta must exceed this share of Delta's diagonal entry, or the state is in doubt.
   Both equations then hold to 1e-11 of their terms. The error of lambda is up to 1 / sqrt(RBDI_CLEAR) times
   the one that its condition explains, because Delta squares the condition of the rows. A larger one costs
   time alone.
   RBDI_RANK: a row counts as independent if the square of its part that is independent of the rows before it
   exceeds this share of the row's square. Rounding leaves some 1e-31, more in ill-conditioned models; a leg
   1e-7 rad from straight has 1e-14.
   RBDI_MOTIONLESS: a row of Z, [rank], that is shorter than this share of its lever arms over the root of D
   is rounding: no joint moves the body along its axis.
   RBDI_FEASIBLE: targets of dependent rows may contradict each other by this share of their terms, because
   positions drift.
   RBDI_LOST: a sum whose magnitude is below this share of a term's has lost so many digits that [refinement]
   looks at the rows. A larger one costs time alone.
   RBDI_MISSED: a row that is off by more than this share of its terms is refined, [refinement]. A
   smaller one costs time alone.
   RBDI_STILL, m/s^2 or rad/s^2: misses below this are not refined. Where constraints hold all joints,
   accelerations are rounding, and their error is no share of them. A smaller one costs time alone.
   RBDI_HELD: and the result must have no row that is off by more than this share of the terms that its length
   and that of the accelerations allow.
   RBDI_DEPENDENT: J' n of the null vector n of rows that truly depend on each other is below this share of
   its terms.
   RBDI_FREE: the share of the least weight that stands for a weight of 0.
   RBDI_SHORT_STEP, rad or m: assembly ends RBDI_CLOSING_STEPS after a step below this times its size. These
   square the error three times, and steps of rounding are below a tenth of it: no test sees ten times more
   or less.
   RBDI_NEAR, rad or m: the largest error e that [assembly] takes for small. A smaller one leaves more loops
   open; with a larger one it takes other steps to the same end: no test sees ten times more.
   RBDI_CLOSED: after it all entries of e must be below this. */
#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_CLEAR 1e-5
#define RBDI_MOTIONLESS 2e-13
#define RBDI_RANK 1e-20
#define RBDI_FEASIBLE 1e-6
#define RBDI_LOST 1e-6
#define RBDI_MISSED 1e-12
#define RBDI_STILL 1e-20
#define RBDI_HELD 1e-9
#define RBDI_DEPENDENT 1e-12
#define RBDI_FREE 1e-13
#define RBDI_SHORT_STEP 1e-12
#define RBDI_CLOSED 1e-9

#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_CLEAR 1e-3f
#define RBDI_MOTIONLESS 4e-6f
#define RBDI_RANK 1e-8f
#define RBDI_FEASIBLE 1e-2f
#define RBDI_LOST 1e-3f
#define RBDI_MISSED 1e-5f
#define RBDI_STILL 1e-9f
#define RBDI_HELD 1e-3f
#define RBDI_DEPENDENT 1e-5f
#define RBDI_FREE 1e-6f
#define RBDI_SHORT_STEP 1e-5f
#define RBDI_CLOSED 1e-4f

#else
#define RBDI_CLEAR RBD_C(1e-10)
#define RBDI_MOTIONLESS RBD_C(2e-31)
#define RBDI_RANK RBD_C(1e-54)
#define RBDI_FEASIBLE RBD_C(1e-12)
#define RBDI_LOST RBD_C(1e-15)
#define RBDI_MISSED RBD_C(1e-28)
#define RBDI_STILL RBD_C(1e-40)
#define RBDI_HELD RBD_C(1e-24)
#define RBDI_DEPENDENT RBD_C(1e-29)
#define RBDI_FREE RBD_C(1e-26)
#define RBDI_SHORT_STEP RBD_C(1e-24)
#define RBDI_CLOSED RBD_C(1e-12)

#endif

#define RBDI_CLEARLY_MORE RBD_C(1.001) /* of shares that differ by rounding alone the first is taken */
#define RBDI_LEAST_WEIGHT RBD_C(1e-20) /* 1 / (this RBDI_FREE), times squares of lengths, is no overflow */
#define RBDI_MOST_WEIGHT RBD_C(1e30)
#define RBDI_LONGEST_STEP RBD_C(0.5)
#define RBDI_NEAR RBD_C(0.1)
/* Bounds of the step size keep a wild estimate from doing harm. With other bounds [assembly] takes other
   steps to the same end: no test sees ten times more or less. */
#define RBDI_LEAST_STEP_SIZE RBD_C(1e-3)
#define RBDI_MOST_STEP_SIZE RBD_C(5)

#define RBDI_REFINEMENTS 24 /* each gains some digits: enough for all that fit into an exponent */
#define RBDI_NEARING_STEPS 200
#define RBDI_CLOSING_STEPS 3

#endif
