#ifndef RBDI_BASE_SINCOS_H
#define RBDI_BASE_SINCOS_H
#include "base/tolerances.h"
#include "base/reduction.h"

#ifdef RBDI_POLYNOMIAL_SINCOS
#ifdef RBDI_BATCH_SCALAR
typedef rbdi_bit rbdi_bits;
typedef union rbdi_pun {
    rbd_real x;
    rbdi_bits b;
} rbdi_pun;
RBDI_INLINE rbdi_bits rbdi_to_bits(rbdi_batch x) {
    rbdi_pun u;
    u.x = x;
    return u.b;
}
RBDI_INLINE rbdi_batch rbdi_from_bits(rbdi_bits b) {
    rbdi_pun u;
    u.b = b;
    return u.x;
}
RBDI_INLINE rbdi_bits rbdi_beyond(rbdi_batch x, rbd_const limit) { return !(x < limit); }
#else
#if RBDI_BATCH == 1 /* lanes */
typedef rbdi_bit rbdi_bits __attribute__((vector_size(RBDI_BATCH * sizeof(rbd_real))));
#endif
RBDI_INLINE rbdi_bits rbdi_to_bits(rbdi_batch x) { return (rbdi_bits)x; }
RBDI_INLINE rbdi_batch rbdi_from_bits(rbdi_bits b) { return (rbdi_batch)b; }
RBDI_INLINE rbdi_bits rbdi_beyond(rbdi_batch x, rbd_const limit) { return ~(rbdi_bits)(x < limit); }
#endif

/* Sine and cosine for |x| <= RBDI_SINCOS_LIMIT, without a branch: x = n pi/2 + r by adding and
   subtracting 1.5 * 2^(mantissa bits), pi/2 split in three (Cody and Waite); minimax polynomials in
   r^2 on |r| <= pi/4; the quadrant, in the sum's low bits, swaps and signs them. Right angles to be added to
   x go there exactly. */
RBDI_INLINE void rbdi_sincos_batch(rbdi_batch x, rbdi_batch quarters, rbdi_batch *s, rbdi_batch *c) {
#if RBDI_CLANG /* which does not tell by a macro that it may reassociate */
#pragma clang fp reassociate(off)
#endif
#if RBDI_REAL_KIND == 1
    const rbdi_batch magic = quarters + 6755399441055744.0;
    rbdi_batch shifted = x * 0.63661977236758134308 + magic, n = shifted - magic;
    rbdi_batch r =
        ((x - n * 1.57079632673412561417) - n * 6.07710050630396597660e-11) - n * 2.02226624879595063154e-21;
    rbdi_batch z = r * r;
    rbdi_batch ps =
        ((((z * 1.5896987541673679574e-10 + -2.5050761807404846211e-8) * z + 2.7557313718766776671e-6) * z +
          -0.0001984126982989857878) *
             z +
         0.0083333333333225528993) *
            z +
        -0.16666666666666632772;
    rbdi_batch pc =
        ((((z * -1.1361303896065947874e-11 + 2.0875758075722807366e-9) * z + -2.755731463445455091e-7) * z +
          2.4801587290576460775e-5) *
             z +
         -0.0013888888888876133562) *
            z +
        0.041666666666666613249;
    const int top = 62;
#else
    const rbdi_batch magic = quarters + 12582912.0f;
    rbdi_batch shifted = x * 0.636619772f + magic, n = shifted - magic;
    rbdi_batch r = ((x - n * 1.5703125f) - n * 4.837512969971e-4f) - n * 7.549789954892e-8f;
    rbdi_batch z = r * r;
    rbdi_batch ps = (z * -0.000195175284f + 0.00833218040f) * z + -0.166666550f;
    rbdi_batch pc = (z * 2.44394104e-5f + -0.00138873773f) * z + 0.0416666471f;
    const int top = 30;
#endif
    rbdi_batch sine = z * r * ps + r;
    rbdi_batch cosine = z * z * pc + (RBD_C(1) - RBD_C(0.5) * z);
    rbdi_bits k = rbdi_to_bits(shifted), bs = rbdi_to_bits(sine), bc = rbdi_to_bits(cosine);
    rbdi_bits swap = (bs ^ bc) & (0u - (k & 1u));
    *s = rbdi_from_bits((bs ^ swap) ^ ((k & 2u) << top));
    *c = rbdi_from_bits((bc ^ swap) ^ (((k + 1u) & 2u) << top));
}

/* Sine and cosine of one angle of any size and as many right angles. */
RBDI_PART void rbdi_sincos_one(rbd_real x, rbd_real quarters, rbd_real *s, rbd_real *c) {
    rbdi_batch bs, bc;
#ifdef RBD_LANES
    for (int i = 0; i < RBD_LANES; ++i) {
        RBD_REAL k = quarters[i];
        if (!(x[i] * x[i] < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT)) x[i] = rbdi_reduce_angle(x[i], &k);
        quarters[i] = k;
    }
#else
    if (!(x * x < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT)) x = rbdi_reduce_angle(x, &quarters);
#endif
    rbdi_sincos_batch(rbdi_all_lanes(x), rbdi_all_lanes(quarters), &bs, &bc);
    *s = rbdi_first_lane(bs), *c = rbdi_first_lane(bc);
}

/* Sines and cosines of n angles and as many right angles. The error is below 2.3e-16 (double), 1.0e-7
   (float) up to the limit, and twice as much beyond it. The arrays are padded to whole batches. */
RBDI_PART void rbdi_sincos_array(const rbd_real *x, const rbd_real *quarters, int n, rbd_real *s,
                                 rbd_real *c) {
    const rbd_const limit = RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT;
    const rbdi_batch *bx = (const rbdi_batch *)x, *bq = (const rbdi_batch *)quarters;
    rbdi_batch *bs = (rbdi_batch *)s, *bc = (rbdi_batch *)c;
    rbdi_bits beyond;
    rbdi_bit any = 0;
    if (n <= 0) return;
    beyond = rbdi_beyond(bx[0] * bx[0], limit);
    for (int i = 0; i * RBDI_BATCH < n; ++i) {
        beyond |= rbdi_beyond(bx[i] * bx[i], limit);
        rbdi_sincos_batch(bx[i], bq[i], &bs[i], &bc[i]);
    }
#ifdef RBDI_BATCH_SCALAR
    any = beyond;
#else
    for (int i = 0; i < (int)(sizeof beyond / sizeof any); ++i) any |= beyond[i];
#endif
    for (int i = 0; any && i < n; ++i) rbdi_sincos_one(x[i], quarters[i], &s[i], &c[i]);
}
#endif

/* Sine and cosine of one angle, by libm where rbd has no polynomial. */
RBDI_INLINE void rbdi_sincos(rbd_real x, rbd_real *s, rbd_real *c) {
#ifdef RBDI_POLYNOMIAL_SINCOS
    rbdi_sincos_one(x, rbdi_zero(), s, c);
#elif defined RBD_LANES
    for (int i = 0; i < RBD_LANES; ++i) {
        (*s)[i] = RBD_SIN(x[i]);
        (*c)[i] = RBD_COS(x[i]);
    }
#else
    *s = RBD_SIN(x);
    *c = RBD_COS(x);
#endif
}

/* 1 / D if D > threshold, else 0 and it is marked bad: no infinity ever leaves a division. */
RBDI_INLINE rbd_real rbdi_reciprocal(rbd_real D, rbd_const threshold, rbdi_mask *bad) {
    rbdi_mask good = rbdi_less(rbdi_set(threshold), D);
    *bad = rbdi_or(*bad, rbdi_not(good));
    return rbdi_select(good, rbdi_set(RBD_C(1)) / rbdi_select(good, D, rbdi_set(RBD_C(1))), rbdi_zero());
}

/* 1 / D of a pivot, 0 where that would overflow; in doubt if D is small beside the inertia that it came
   from. */
RBDI_INLINE rbd_real rbdi_pivot_inverse(rbd_real D, rbd_const scale, rbdi_mask *doubt) {
    rbdi_mask none = rbdi_less(D, D);
    *doubt = rbdi_or(*doubt, rbdi_not(rbdi_less(rbdi_set(scale * RBDI_DOUBT), D)));
    return rbdi_reciprocal(D, RBDI_TINY, &none);
}

#endif
