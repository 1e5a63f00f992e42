#ifndef RBDI_BASE_SINCOS_H
#define RBDI_BASE_SINCOS_H
#include "base/reduction.h"

#ifdef RBDI_POLYNOMIAL_SINCOS
#ifdef RBDI_BATCH_SCALAR
typedef rbdi_bit rbdi_bits;
typedef union rbdi_pun {
    rbd_real x;
    rbdi_bits bits;
} rbdi_pun;
RBDI_INLINE rbdi_bits rbdi_to_bits(rbdi_batch x) {
    rbdi_pun u;
    u.x = x;
    return u.bits;
}

RBDI_INLINE rbdi_batch rbdi_from_bits(rbdi_bits bits) {
    rbdi_pun u;
    u.bits = bits;
    return u.x;
}
#else
#if RBDI_BATCH == 1 /* lanes */
typedef rbdi_bit rbdi_bits __attribute__((vector_size(RBDI_BATCH * sizeof(rbd_real))));
#endif
RBDI_INLINE rbdi_bits rbdi_to_bits(rbdi_batch x) { return (rbdi_bits)x; }
RBDI_INLINE rbdi_batch rbdi_from_bits(rbdi_bits bits) { return (rbdi_batch)bits; }
#endif

/* Sine and cosine of x + quarters pi/2, |x| <= RBDI_SINCOS_LIMIT, without a branch. x = n pi/2 + r, n from
   adding and subtracting 1.5 * 2^(mantissa bits), with pi/2 split in three (Cody and Waite 1980). Minimax
   polynomials in z = r^2 on |r| <= pi/4. The low bits of the sum have the quadrant, to which the quarters are
   added exactly; it swaps sine and cosine and gives their signs. */
RBDI_INLINE void rbdi_sincos_batch(rbdi_batch x, rbdi_batch quarters, rbdi_batch *s, rbdi_batch *c) {
#if RBDI_CLANG /* which does not tell by a macro that it may reassociate */
#pragma clang fp reassociate(off)
#endif

    /* n, r, and the polynomials ps = (sin r / r - 1) / z, pc = (cos r - 1 + z/2) / z^2 */
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

    /* sine and cosine of r, swapped and with the signs of the quadrant */
    rbdi_batch sine = z * r * ps + r;
    rbdi_batch cosine = z * z * pc + (RBD_C(1) - RBD_C(0.5) * z);
    rbdi_bits quadrant = rbdi_to_bits(shifted), bs = rbdi_to_bits(sine), bc = rbdi_to_bits(cosine);
    rbdi_bits swap = (bs ^ bc) & (0u - (quadrant & 1u));

    *s = rbdi_from_bits((bs ^ swap) ^ ((quadrant & 2u) << top));
    *c = rbdi_from_bits((bc ^ swap) ^ (((quadrant + 1u) & 2u) << top));
}

/* Sine and cosine of one angle x of any size plus so many right angles. */
RBDI_PART void rbdi_sincos_one(rbd_real x, rbd_real quarters, rbd_real *s, rbd_real *c) {
    rbdi_batch sine, cosine;
#ifdef RBD_LANES
    for (int i = 0; i < RBD_LANES; ++i) {
        RBD_REAL sum = quarters[i];
        if (!(x[i] * x[i] < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT)) x[i] = rbdi_reduce_angle(x[i], &sum);
        quarters[i] = sum;
    }
#else
    if (!(x * x < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT)) x = rbdi_reduce_angle(x, &quarters);
#endif

    rbdi_sincos_batch(rbdi_all_lanes(x), rbdi_all_lanes(quarters), &sine, &cosine);
    *s = rbdi_first_lane(sine);
    *c = rbdi_first_lane(cosine);
}

/* Sines and cosines of the angles first .. end - 1 plus right angles, in the least number of batches, which
   are aligned where that takes no more. Entries that share a batch with them are written too. The arrays are
   padded. The error is below 2.3e-16 (double), 1.0e-7 (float) up to the limit, and twice as much beyond it.
   */
RBDI_PART void rbdi_sincos_array(const rbd_real *x, const rbd_real *quarters, int first, int end, rbd_real *s,
                                 rbd_real *c) {
    const int size = (end - first + RBDI_BATCH - 1) / RBDI_BATCH * RBDI_BATCH;
    int start = first / RBDI_BATCH * RBDI_BATCH;                                     /* aligned */
    rbdi_bits within = (rbdi_bits)(rbdi_all_lanes(rbdi_zero()) < RBDI_SINCOS_LIMIT); /* all are */
    rbdi_bit all;

    if (start + size < end) start = end - size;
    for (int i = start; i < end; i += RBDI_BATCH) {
        const rbdi_batch angle = *(const rbdi_batch *)&x[i];
        within &= (rbdi_bits)(angle * angle < RBDI_SINCOS_LIMIT * RBDI_SINCOS_LIMIT);
        rbdi_sincos_batch(angle, *(const rbdi_batch *)&quarters[i], (rbdi_batch *)&s[i], (rbdi_batch *)&c[i]);
    }

#ifdef RBDI_BATCH_SCALAR
    all = within;
#else
    all = within[0];
    for (int i = 1; i < (int)(sizeof within / sizeof all); ++i) all &= within[i];
#endif
    if (all) return;

    /* with a large angle, or one that is no number, all anew, one by one */
    for (int i = first; i < end; ++i) rbdi_sincos_one(x[i], quarters[i], &s[i], &c[i]);
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

#endif
