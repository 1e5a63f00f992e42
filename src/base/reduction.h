#ifndef RBDI_BASE_REDUCTION_H
#define RBDI_BASE_REDUCTION_H
#include "base/simd.h"

/* ---- reduction [reduction] ----
   Angles of any size: x = n pi/2 + r with |r| <= pi/4, after Payne and Hanek (1983). |x| is N 2^(32 a), N a
   whole number of three words of 32 bits. Of 2/pi = sum b_k 2^(-32 k) the words before b_a contribute
   multiples of 4 to x 2/pi. The words behind b_(a + RBDI_REDUCTION + 3) contribute less than rounding does,
   also where x is near a multiple of pi/2. */

#if RBDI_REAL_KIND % 3 != 0 && !defined RBDI_OWN_SINCOS && RBDI_ROUNDS
#define RBDI_POLYNOMIAL_SINCOS
#if RBDI_REAL_KIND == 1
#define RBDI_SINCOS_LIMIT 1e6
#define RBDI_REDUCTION 4 /* words of the fraction of x 2/pi */
#define RBDI_MANTISSA 52
#else
#define RBDI_SINCOS_LIMIT 1e4f
#define RBDI_REDUCTION 2
#define RBDI_MANTISSA 23
#endif

/* The integer part of |x| 2/pi modulo 2^32, in part[0], and its fraction, in the words from part[1] on. */
RBDI_COLD void rbdi_turns(RBD_REAL x, uint32_t part[RBDI_REDUCTION + 2]) {
    /* words of 2/pi, from b_1 on */
    static const uint32_t two_over_pi[] = {
#if RBDI_REAL_KIND == 1
        0xa2f9836eu, 0x4e441529u, 0xfc2757d1u, 0xf534ddc0u, 0xdb629599u, 0x3c439041u, 0xfe5163abu,
        0xdebbc561u, 0xb7246e3au, 0x424dd2e0u, 0x06492eeau, 0x09d1921cu, 0xfe1deb1cu, 0xb129a73eu,
        0xe88235f5u, 0x2ebb4484u, 0xe99c7026u, 0xb45f7e41u, 0x3991d639u, 0x835339f4u, 0x9c845f8bu,
        0xbdf9283bu, 0x1ff897ffu, 0xde05980fu, 0xef2f118bu, 0x5a0a6d1fu, 0x6d367ecfu, 0x27cb09b7u,
        0x4f463f66u, 0x9e5fea2du, 0x7527bac7u, 0xebe5f17bu, 0x3d0739f7u, 0x8a5292eau, 0x6bfb5fb1u,
        0x1f8d5d08u, 0x56033046u
#else
        0xa2f9836eu, 0x4e441529u, 0xfc2757d1u, 0xf534ddc0u, 0xdb629599u,
        0x3c439041u, 0xfe5163abu, 0xdebbc561u
#endif
    };

    union {
        RBD_REAL x;
        rbdi_bit bits;
    } u = {x < 0 ? -x : x};
    const rbdi_bit one = (rbdi_bit)1 << RBDI_MANTISSA;
    const uint64_t mantissa = (u.bits & (one - 1)) | one;
    const int bias = (1 << (8 * (int)sizeof(x) - 2 - RBDI_MANTISSA)) - 1; /* of the exponent */

    /* |x| = N 2^(32 a) */
    const int e = (int)(u.bits >> RBDI_MANTISSA) - bias - RBDI_MANTISSA + 64;
    const int a = e / 32 - 2, shift = e % 32;
    const uint64_t low = (mantissa & UINT32_MAX) << shift, high = ((mantissa >> 32) << shift) + (low >> 32);
    const uint32_t N[3] = {(uint32_t)low, (uint32_t)high, (uint32_t)(high >> 32)};

    /* part += b_k N_i 2^(32 (a + i - k)), with carries */
    for (int j = 0; j <= RBDI_REDUCTION + 1; ++j) part[j] = 0;
    for (int k = a > 1 ? a : 1; k <= a + RBDI_REDUCTION + 3; ++k)
        for (int i = 0; i < 3; ++i) {
            uint64_t carry = (uint64_t)two_over_pi[k - 1] * N[i];
            if (k - a - i > RBDI_REDUCTION + 1) continue;
            for (int j = k - a - i; j >= 0; --j, carry >>= 32) {
                carry += part[j];
                part[j] = (uint32_t)carry;
            }
        }
}

/* Returns r, for x finite or not, and adds n modulo 4 to the quarters: right angles. */
RBDI_COLD RBD_REAL rbdi_reduce_angle(RBD_REAL x, RBD_REAL *quarters) {
    const RBD_REAL word = (RBD_REAL)(1 / 4294967296.), right_angle = (RBD_REAL)1.57079632679489661923;
    uint32_t part[RBDI_REDUCTION + 2], flip;
    RBD_REAL r = 0;
    if (!(x - x == 0)) return x - x; /* not a number */

    /* |x| 2/pi = part[0] + fraction; r = (fraction, less 1 if above a half) pi/2 */
    rbdi_turns(x, part);
    flip = part[1] >> 31 ? UINT32_MAX : 0; /* a fraction over a half counts from the next multiple */
    for (int j = RBDI_REDUCTION + 1; j > 0; --j) r = (r + (RBD_REAL)(part[j] ^ flip)) * word;
    r = r * (flip ? -right_angle : right_angle);

    part[0] = (part[0] + (flip & 1)) & 3;
    *quarters = *quarters + (RBD_REAL)(x < 0 ? 4 - part[0] : part[0]);
    return x < 0 ? -r : r;
}
#endif

#endif
