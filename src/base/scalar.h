#ifndef RBDI_BASE_SCALAR_H
#define RBDI_BASE_SCALAR_H
#include "api/types.h"
#include "base/compiler.h"

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
#ifndef RBD_SQRT
#define RBD_SQRT(x) RBDI_LIBM(sqrt)(x)
#endif

/* pi to quad precision, from doubles: a long literal would be cut to double. */
#define RBDI_PI(type) \
    ((type)3.141592653589793116 + (type)1.2246467991473532e-16 + (type) - 2.9947698097183397e-33)

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
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask k) { return ~k; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
RBDI_INLINE rbd_real rbdi_select(rbdi_mask k, rbd_real a, rbd_real b) {
    return (rbd_real)(((rbdi_mask)a & k) | ((rbdi_mask)b & ~k));
}
RBDI_INLINE int rbdi_any(rbdi_mask k) {
    rbdi_int any = 0;
    for (int i = 0; i < RBD_LANES; ++i) any |= k[i];
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
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask k) { return !k; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
#ifdef RBD_MASK
RBDI_INLINE rbd_real rbdi_select(rbdi_mask k, rbd_real a, rbd_real b) { return select(k, a, b); }
#else
RBDI_INLINE rbd_real rbdi_select(rbdi_mask k, rbd_real a, rbd_real b) { return k ? a : b; }
#endif
RBDI_INLINE int rbdi_any(rbdi_mask k) { return k; }
RBDI_INLINE rbd_real rbdi_sqrt(rbd_real x) { return RBD_SQRT(x); }
#endif
RBDI_INLINE rbd_real rbdi_zero(void) { return rbdi_set(RBD_C(0)); }
RBDI_INLINE rbd_real rbdi_abs(rbd_real x) { return rbdi_select(rbdi_less(x, rbdi_zero()), -x, x); }

#endif
