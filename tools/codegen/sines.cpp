/* The generated code's own sine and cosine: rbd.h's, see its rbdi_sincos_batch, for the scalar wanted.
   tests/codegen/sines.c holds the two against each other, bit by bit. SPDX-License-Identifier: MIT */
#include "sines.h"

namespace codegen {

const char sines_double[] = R"(
typedef uint64_t bit;
#define QUADRANT_SIGN 62
#define SINES_LIMIT 1e6

/* Minimax polynomials of sine and cosine for |r| < pi/4, z = r^2; pi/2 in three parts (Cody and Waite). */
#define SHIFTED(x) ((x) * 0.63661977236758134308 + 6755399441055744.0)
#define WHOLE(shifted) ((shifted) - 6755399441055744.0)
#define REST(x, n) (((x) - (n) * 1.57079632673412561417) - (n) * 6.07710050630396597660e-11) - \
                   (n) * 2.02226624879595063154e-21
#define SINE_TAIL(z) \
    (((((z) * 1.5896987541673679574e-10 + -2.5050761807404846211e-8) * (z) + \
       2.7557313718766776671e-6) * (z) + -0.0001984126982989857878) * (z) + \
     0.0083333333333225528993) * (z) + -0.16666666666666632772
#define COSINE_TAIL(z) \
    (((((z) * -1.1361303896065947874e-11 + 2.0875758075722807366e-9) * (z) + \
       -2.755731463445455091e-7) * (z) + 2.4801587290576460775e-5) * (z) + \
     -0.0013888888888876133562) * (z) + 0.041666666666666613249
#define HALF 0.5
#define ONE 1.0
)";

const char sines_float[] = R"(
typedef uint32_t bit;
#define QUADRANT_SIGN 30
#define SINES_LIMIT 1e4f

/* Minimax polynomials of sine and cosine for |r| < pi/4, z = r^2; pi/2 in three parts (Cody and Waite). */
#define SHIFTED(x) ((x) * 0.636619772f + 12582912.0f)
#define WHOLE(shifted) ((shifted) - 12582912.0f)
#define REST(x, n) (((x) - (n) * 1.5703125f) - (n) * 4.837512969971e-4f) - (n) * 7.549789954892e-8f
#define SINE_TAIL(z) ((z) * -0.000195175284f + 0.00833218040f) * (z) + -0.166666550f
#define COSINE_TAIL(z) ((z) * 2.44394104e-5f + -0.00138873773f) * (z) + 0.0416666471f
#define HALF 0.5f
#define ONE 1.0f
)";

const char sines_common[] = R"(
/* A batch is as many angles as one SIMD instruction takes, 256 bits at most. */
#if LANES > 1
#define BATCH 1
typedef real batch;
typedef bit bits __attribute__((vector_size(LANES * sizeof(scalar))));
#elif defined OWN_SINES && (defined __SSE2__ || (defined __ARM_NEON && defined __aarch64__))
#if defined __AVX__ || defined SCALAR_IS_FLOAT
#define BATCH 4
#else
#define BATCH 2
#endif
typedef scalar batch __attribute__((vector_size(BATCH * sizeof(scalar)), aligned(sizeof(scalar)), may_alias));
typedef bit bits __attribute__((vector_size(BATCH * sizeof(scalar))));
#else
#define BATCH 1
typedef real batch;
typedef bit bits;
#endif

#ifdef OWN_SINES
/* Sine and cosine for |x| below SINES_LIMIT; *squares grows by x^2. x = n pi/2 + r by adding and subtracting
   1.5 * 2^(mantissa bits); the quadrant, in the sum's low bits, swaps and signs the two. */
INLINE void sines(batch x, batch *s, batch *c, batch *squares) {
#ifdef __clang__
#pragma clang fp reassociate(off)
#endif
    union {
        batch x;
        bits b;
    } shifted, sine, cosine;
    batch n, r, z;
    bits k, swap;
    shifted.x = SHIFTED(x);
    n = WHOLE(shifted.x);
    r = REST(x, n);
    z = r * r;
    sine.x = z * r * (SINE_TAIL(z)) + r;
    cosine.x = z * z * (COSINE_TAIL(z)) + (ONE - HALF * z);
    k = shifted.b;
    swap = (sine.b ^ cosine.b) & (0u - (k & 1u));
    sine.b = (sine.b ^ swap) ^ ((k & 2u) << QUADRANT_SIGN);
    cosine.b = (cosine.b ^ swap) ^ (((k + 1u) & 2u) << QUADRANT_SIGN);
    *s = sine.x;
    *c = cosine.x;
    *squares += x * x;
}
#endif

/* Of the first n of four angles, which are kept in x. They come by value: what is stored one by one and read
   together stalls. */
INLINE void sines4(int n, real x0, real x1, real x2, real x3, real *x, real *s, real *c, batch *squares) {
#if !defined OWN_SINES || LANES * BATCH == 1
    (void)s, (void)c, (void)squares;
    x[0] = x0;
    if (n > 1) x[1] = x1;
    if (n > 2) x[2] = x2;
    if (n > 3) x[3] = x3;
#elif BATCH == 4
    const batch all = {x0, x1, x2, x3};
    (void)n;
    *(batch *)x = all;
    sines(all, (batch *)s, (batch *)c, squares);
#elif BATCH == 2
    const batch first = {x0, x1}, second = {x2, x3};
    *(batch *)x = first;
    sines(first, (batch *)s, (batch *)c, squares);
    if (n < 3) return;
    *(batch *)(x + 2) = second;
    sines(second, (batch *)(s + 2), (batch *)(c + 2), squares);
#else
    sines(x[0] = x0, &s[0], &c[0], squares);
    if (n > 1) sines(x[1] = x1, &s[1], &c[1], squares);
    if (n > 2) sines(x[2] = x2, &s[2], &c[2], squares);
    if (n > 3) sines(x[3] = x3, &s[3], &c[3], squares);
#endif
}

/* One at a time they are a loop, for the sake of flash. */
#if defined OWN_SINES && LANES * BATCH == 1
#define SINES_OF(n) \
    for (int i = 0; i < (n); ++i) sines(angle[i], sine + i, cosine + i, &squares)
#else
#define SINES_OF(n) (void)0
#endif

/* Where this is 0, any angle may lie beyond; without sines of our own, always. */
INLINE int are_inside(batch squares) {
#ifndef OWN_SINES
    (void)squares;
    return 0;
#elif LANES * BATCH == 1
    return squares < SINES_LIMIT * SINES_LIMIT;
#else
    const bits inside = (bits)(squares < SINES_LIMIT * SINES_LIMIT);
    bit all = 1;
    for (int i = 0; i < LANES * BATCH; ++i) all &= inside[i];
    return (int)all;
#endif
}

#if !defined ANGLES_ARE_BOUNDED || !defined OWN_SINES
COLD void sines_by_libm(const real *x, int n, real *s, real *c) {
    for (int i = 0; i < n; ++i) {
#if LANES > 1
        for (int j = 0; j < LANES; ++j) s[i][j] = LIBM_SIN(x[i][j]), c[i][j] = LIBM_COS(x[i][j]);
#else
        s[i] = LIBM_SIN(x[i]), c[i] = LIBM_COS(x[i]);
#endif
    }
}
#endif

#ifdef ANGLES_ARE_BOUNDED
/* Sine and cosine of an angle not below SINES_LIMIT become NaN, and so does *verdict if it is not NULL. */
COLD void refuse_beyond(const real *x, int n, real *s, real *c, real *verdict) {
#ifndef OWN_SINES
    sines_by_libm(x, n, s, c);
#endif
    for (int i = 0; i < n; ++i) {
        const real zero = {0};
        const real k = choose(x[i] * x[i] < SINES_LIMIT * SINES_LIMIT, zero + ONE, zero + (scalar)NAN);
        s[i] *= k, c[i] *= k;
        if (verdict) *verdict *= k;
    }
}
#define SINES_BEYOND(n, verdict) \
    if (!are_inside(squares)) refuse_beyond(angle, n, sine, cosine, verdict)
#else
#define SINES_BEYOND(n, verdict) \
    if (!are_inside(squares)) sines_by_libm(angle, n, sine, cosine)
#endif
)";

} // namespace codegen
