#ifndef RBDI_BASE_SCALAR_H
#define RBDI_BASE_SCALAR_H
#include "base/compiler.h"
#include "base/tolerances.h"

/* ---- scalar [scalar] ---- */

#if RBDI_REAL_KIND == 3 || RBDI_KIND(RBD_CONST) == 3
#ifdef __cplusplus
extern "C" {
#endif
RBDI_EXTENSION __float128 sinq(__float128 x);
RBDI_EXTENSION __float128 cosq(__float128 x);
RBDI_EXTENSION __float128 sqrtq(__float128 x);
#ifdef __cplusplus
}
#endif
#endif
#include <math.h>

#if RBDI_REAL_KIND == 2
#define RBDI_LIBM(name) name##f
#elif RBDI_REAL_KIND == 3
#define RBDI_LIBM(name) name##q
#else
#define RBDI_LIBM(name) name
#endif
#ifdef RBD_SIN
#define RBDI_OWN_SINCOS
#if RBDI_REPRODUCIBLE
#error "rbd: RBD_REPRODUCIBLE needs rbd's own sine: leave RBD_SIN and RBD_COS undefined"
#endif
#else
#define RBD_SIN(x) RBDI_LIBM(sin)(x)
#define RBD_COS(x) RBDI_LIBM(cos)(x)
#endif

/* MinGW's square root computes in 80 bits and rounds twice, the processor's own once. */
#if defined __MINGW32__ && defined __SSE2__ && RBDI_REAL_KIND != 0
#include <emmintrin.h>
RBDI_INLINE double rbdi_root(double x) { return _mm_cvtsd_f64(_mm_sqrt_sd(_mm_set_sd(x), _mm_set_sd(x))); }
RBDI_INLINE float rbdi_rootf(float x) { return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))); }
#else
#define rbdi_root sqrt
#define rbdi_rootf sqrtf
#endif
#define rbdi_rootq sqrtq
#ifndef RBD_SQRT
#define RBD_SQRT(x) RBDI_LIBM(rbdi_root)(x)
#endif

/* pi to quad precision, as a sum of doubles: a longer literal would be rounded to double. */
#define RBDI_PI(type) \
    ((type)3.141592653589793116 + (type)1.2246467991473532e-16 + (type) - 2.9947698097183397e-33)

/* A scalar is one number or, with RBD_LANES, a vector with a number for each state. A mask is the result of a
   comparison; with lanes it holds in some and not in others. */
#ifdef RBD_LANES
#if RBDI_REAL_KIND == 2
typedef int32_t rbdi_int;
#else
typedef int64_t rbdi_int;
#endif
typedef rbdi_int rbdi_mask __attribute__((vector_size(sizeof(rbd_real)))); /* per lane 0 or -1 */

RBDI_INLINE rbd_real rbdi_set(rbd_const c) {
    rbd_real zero = {0};
    return zero + c;
}

RBDI_INLINE rbdi_mask rbdi_less(rbd_real a, rbd_real b) { return (rbdi_mask)(a < b); }
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask a) { return ~a; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) {
    return (rbd_real)(((rbdi_mask)a & mask) | ((rbdi_mask)b & ~mask));
}

RBDI_INLINE int rbdi_any(rbdi_mask mask) {
    rbdi_int any = 0;
    for (int i = 0; i < RBD_LANES; ++i) any |= mask[i];
    return any != 0;
}

RBDI_INLINE rbd_real rbdi_sqrt(rbd_real x) {
    for (int i = 0; i < RBD_LANES; ++i) x[i] = RBD_SQRT(x[i]);
    return x;
}
#else
#ifdef RBD_MASK
typedef RBD_MASK rbdi_mask;
#else
typedef int rbdi_mask;
#endif
RBDI_INLINE rbd_real rbdi_set(rbd_const c) { return (rbd_real)(c); }
RBDI_INLINE rbdi_mask rbdi_less(rbd_real a, rbd_real b) { return a < b; }
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask a) { return !a; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
#ifdef RBD_MASK
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) { return select(mask, a, b); }
#else
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) { return mask ? a : b; }
#endif
RBDI_INLINE int rbdi_any(rbdi_mask mask) { return mask; }
RBDI_INLINE rbd_real rbdi_sqrt(rbd_real x) { return RBD_SQRT(x); }
#endif
RBDI_INLINE rbd_real rbdi_zero(void) { return rbdi_set(RBD_C(0)); }
RBDI_INLINE rbd_real rbdi_abs(rbd_real x) { return rbdi_select(rbdi_less(x, rbdi_zero()), -x, x); }

/* The larger and the smaller of two. If one is NaN these are a and b. */
RBDI_INLINE rbd_real rbdi_larger(rbd_real a, rbd_real b) { return rbdi_select(rbdi_less(a, b), b, a); }
RBDI_INLINE rbd_real rbdi_smaller(rbd_real a, rbd_real b) { return rbdi_select(rbdi_less(a, b), a, b); }

/* Whether x is a finite number, in all lanes. Of infinity and of NaN x - x is NaN. */
RBDI_INLINE int rbdi_is_finite(rbd_real x) {
    return !rbdi_any(rbdi_not(rbdi_less(x - x, rbdi_set(RBD_C(1)))));
}

/* 1 / D if D > threshold, else 0, and bad is set: no division gives infinity. */
RBDI_INLINE rbd_real rbdi_reciprocal(rbd_real D, rbd_const threshold, rbdi_mask *bad) {
    rbdi_mask good = rbdi_less(rbdi_set(threshold), D);
    *bad = rbdi_or(*bad, rbdi_not(good));
    return rbdi_select(good, rbdi_set(RBD_C(1)) / rbdi_select(good, D, rbdi_set(RBD_C(1))), rbdi_zero());
}

/* 1 / D of a pivot, 0 where that would overflow. The pivot is in doubt if it is small beside scale, the
   inertia that it came from: see [tolerances]. */
RBDI_INLINE rbd_real rbdi_pivot_inverse(rbd_real D, rbd_const scale, rbdi_mask *doubt) {
    rbdi_mask tiny = rbdi_less(D, D); /* not asked: such a pivot is in doubt as well */
    *doubt = rbdi_or(*doubt, rbdi_not(rbdi_less(rbdi_set(scale * RBDI_DOUBT), D)));
    return rbdi_reciprocal(D, RBDI_TINY, &tiny);
}

#endif
