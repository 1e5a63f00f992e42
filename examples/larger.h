/* larger.h - the largest of what an example checks. libm's fmax passes over NaN, and so would the check.
   SPDX-License-Identifier: MIT */
#ifndef LARGER_H
#define LARGER_H

#include <math.h>

/* Infinite if one is NaN. */
static inline double larger(double x, double y) { return x <= y ? y : x > y ? x : HUGE_VAL; }
static inline float largerf(float x, float y) { return x <= y ? y : x > y ? x : HUGE_VALF; }

#endif
