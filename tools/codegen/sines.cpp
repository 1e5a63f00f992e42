/* The generated code's own sine and cosine: rbd.h's, see its rbdi_sincos_batch, for the scalar wanted.
   tests/codegen/sines.c holds the two against each other, bit by bit. SPDX-License-Identifier: MIT */
#include "own_sines.h"
#include "text.h"

namespace codegen {
namespace {

const char of_double[] = R"(
typedef uint64_t bit;
#define QUADRANT_SIGN 62
#define SINES_LIMIT 1e6

/* Minimax polynomials of sine and cosine for |r| < pi/4, z = r^2; pi/2 in three parts (Cody and Waite). */
#define TWO_OVER_PI 0.63661977236758134308
#define WHOLE 6755399441055744.0 /* in sums with it the last digit is 1 */
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

const char of_float[] = R"(
typedef uint32_t bit;
#define QUADRANT_SIGN 30
#define SINES_LIMIT 1e4f

/* Minimax polynomials of sine and cosine for |r| < pi/4, z = r^2; pi/2 in three parts (Cody and Waite). */
#define TWO_OVER_PI 0.636619772f
#define WHOLE 12582912.0f /* in sums with it the last digit is 1 */
#define REST(x, n) (((x) - (n) * 1.5703125f) - (n) * 4.837512969971e-4f) - (n) * 7.549789954892e-8f
#define SINE_TAIL(z) ((z) * -0.000195175284f + 0.00833218040f) * (z) + -0.166666550f
#define COSINE_TAIL(z) ((z) * 2.44394104e-5f + -0.00138873773f) * (z) + 0.0416666471f
#define HALF 0.5f
#define ONE 1.0f
)";

/* Sums keep no digits that the scalar has not. */
const char not_kept_longer[] = R"(
#if defined __GNUC__ && defined __FLT_EVAL_METHOD__ && (__FLT_EVAL_METHOD__ == 0 || __FLT_EVAL_METHOD__ > 2)
#define OWN_SINES
#endif
)";

const char by_batches[] = R"(
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

/* Sine and cosine of x, |x| below SINES_LIMIT, and as many right angles as `whole` is more than WHOLE;
   *squares grows by x^2. x = n pi/2 + r by adding and subtracting 1.5 * 2^(mantissa bits); the quadrant, in
   the sum's low bits, swaps and signs the two. */
#ifdef OWN_SINES
INLINE void sines(batch x, batch whole, batch *s, batch *c, batch *squares) {
#ifdef __clang__
#pragma clang fp reassociate(off)
#endif
    union {
        batch x;
        bits b;
    } shifted, sine, cosine;
    batch n, r, z;
    bits k, swap;
    shifted.x = x * TWO_OVER_PI + whole;
    n = shifted.x - whole;
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

/* The right angles of the batch from i on; without any, quarters is 0. */
INLINE batch whole_of(const scalar *quarters, int i) {
    const batch zero = {0};
#if BATCH > 1
    return (quarters ? *(const batch *)(quarters + i) : zero) + WHOLE;
#else
    return (quarters ? splat(quarters[i]) : zero) + WHOLE;
#endif
}
#endif

/* Of the first n of four angles, which are kept in x. They come by value: what is stored one by one and read
   together stalls. */
INLINE void sines4(int n, real x0, real x1, real x2, real x3, const scalar *quarters, real *x, real *s,
                   real *c, batch *squares) {
#if !defined OWN_SINES || LANES * BATCH == 1
    (void)quarters, (void)s, (void)c, (void)squares;
    x[0] = x0;
    if (n > 1) x[1] = x1;
    if (n > 2) x[2] = x2;
    if (n > 3) x[3] = x3;
#elif BATCH == 4
    const batch all = {x0, x1, x2, x3};
    (void)n;
    *(batch *)x = all;
    sines(all, whole_of(quarters, 0), (batch *)s, (batch *)c, squares);
#elif BATCH == 2
    const batch first = {x0, x1}, second = {x2, x3};
    *(batch *)x = first;
    sines(first, whole_of(quarters, 0), (batch *)s, (batch *)c, squares);
    if (n < 3) return;
    *(batch *)(x + 2) = second;
    sines(second, whole_of(quarters, 2), (batch *)(s + 2), (batch *)(c + 2), squares);
#else
    const real all[4] = {x0, x1, x2, x3};
    for (int i = 0; i < n; ++i)
        sines(x[i] = all[i], whole_of(quarters, i), &s[i], &c[i], squares);
#endif
}

/* One at a time they are a loop, for the sake of flash. */
#if defined OWN_SINES && LANES * BATCH == 1
#define SINES_OF(n, quarters) \
    for (int i = 0; i < (n); ++i) \
    sines(angle[i], whole_of(quarters, i), sine + i, cosine + i, &squares)
#else
#define SINES_OF(n, quarters) (void)0
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
    bit every = 1;
    for (int i = 0; i < LANES * BATCH; ++i) every &= inside[i];
    return (int)every;
#endif
}
)";

/* ---- angles beyond the limit ---- */

const char by_libm[] = R"(
COLD void sines_by_libm(const real *x, int n, real *s, real *c) {
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < LANES; ++j)
            LANE(s[i], j) = LIBM_SIN(LANE(x[i], j)), LANE(c[i], j) = LIBM_COS(LANE(x[i], j));
}
)";

const char beyond_by_libm[] =
    R"(COLD void sines_beyond(const real *x, const scalar *quarters, int n, real *s, real *c, real *verdict) {
    (void)quarters, (void)verdict;
    sines_by_libm(x, n, s, c);
}
)";

const char beyond_refused[] = R"(
/* Sine and cosine of an angle not below SINES_LIMIT become NaN, and so does *verdict if it is not NULL. */
COLD void sines_beyond(const real *x, const scalar *quarters, int n, real *s, real *c, real *verdict) {
    (void)quarters;
#ifndef OWN_SINES
    sines_by_libm(x, n, s, c);
#endif
    for (int i = 0; i < n; ++i) {
        const real k = choose(x[i] * x[i] < SINES_LIMIT * SINES_LIMIT, splat(ONE), splat((scalar)NAN));
        s[i] *= k, c[i] *= k;
        if (verdict) *verdict *= k;
    }
}
)";

const char beyond_reduced[] = R"(
/* x 2/pi, its integer part modulo 2^32 and the words of its fraction, after Payne and Hanek (1983). x is
   N 2^(32 a), N of three words. Words of 2/pi before the a-th contribute multiples of 4. */
COLD void turns(scalar x, uint32_t *part) {
    union {
        scalar x;
        bit b;
    } u;
    const bit one = (bit)1 << MANTISSA;
    uint64_t mantissa, low, high;
    uint32_t N[3];
    int e, a;
    u.x = x < 0 ? -x : x;
    mantissa = (u.b & (one - 1)) | one;
    e = (int)(u.b >> MANTISSA) - ((1 << (8 * (int)sizeof(x) - 2 - MANTISSA)) - 1) - MANTISSA + 64;
    a = e / 32 - 2;
    low = (mantissa & UINT32_MAX) << (e % 32);
    high = ((mantissa >> 32) << (e % 32)) + (low >> 32);
    N[0] = (uint32_t)low, N[1] = (uint32_t)high, N[2] = (uint32_t)(high >> 32);
    for (int j = 0; j < REDUCTION + 2; ++j) part[j] = 0;
    for (int k = a > 1 ? a : 1; k <= a + REDUCTION + 3; ++k)
        for (int i = 0; i < 3; ++i) {
            uint64_t carry = (uint64_t)two_over_pi[k - 1] * N[i];
            if (k - a - i > REDUCTION + 1) continue;
            for (int j = k - a - i; j >= 0; --j, carry >>= 32) {
                carry += part[j];
                part[j] = (uint32_t)carry;
            }
        }
}

/* r of x, finite or not; its right angles are added to *quarters. */
COLD scalar reduced(scalar x, scalar *quarters) {
    const scalar word = (scalar)(1 / 4294967296.), right_angle = (scalar)1.57079632679489661923;
    uint32_t part[REDUCTION + 2], flip;
    scalar r = 0;
    if (!(x - x == 0)) return x - x;
    turns(x, part);
    flip = part[1] >> 31 ? UINT32_MAX : 0; /* it counts from the next multiple */
    for (int j = REDUCTION + 1; j > 0; --j) r = (r + (scalar)(part[j] ^ flip)) * word;
    r = r * (flip ? -right_angle : right_angle);
    part[0] = (part[0] + (flip & 1)) & 3;
    *quarters = *quarters + (scalar)(x < 0 ? 4 - part[0] : part[0]);
    return x < 0 ? -r : r;
}

COLD void sines_beyond(const real *x, const scalar *quarters, int n, real *s, real *c, real *verdict) {
    const batch zero = {0};
    batch squares = zero, sine, cosine;
    (void)verdict;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < LANES; ++j) {
            scalar r = LANE(x[i], j), k = quarters[i];
            if (!(r * r < SINES_LIMIT * SINES_LIMIT)) r = reduced(r, &k);
            sines(zero + r, zero + (k + WHOLE), &sine, &cosine, &squares);
#if LANES * BATCH == 1
            s[i] = sine, c[i] = cosine;
#else
            LANE(s[i], j) = sine[0], LANE(c[i], j) = cosine[0];
#endif
        }
}
)";

std::string reduction(bool is_float) {
    const std::vector<uint32_t> words = is_float ? two_over_pi_float() : two_over_pi_double();
    return format("\n#define MANTISSA %d\n#define REDUCTION %d /* words of the fraction of x 2/pi */\n"
                  "static const uint32_t two_over_pi[] = {",
                  is_float ? 23 : 52, is_float ? 2 : 4) +
           join(words.size(), ", ",
                [&](size_t k) { return (k % 8 ? "" : "\n    ") + std::to_string(words[k]) + "u"; }) +
           "};\n" + beyond_reduced;
}

} // namespace

std::string sines_text(const target &t) {
    std::string s = t.is_float ? of_float : of_double;
    s += t.is_reproducible ? "\n#define OWN_SINES\n" : not_kept_longer;
    s += by_batches;
    if (t.is_reproducible) return s + (t.is_bounded ? beyond_refused : reduction(t.is_float));
    if (!t.is_bounded) return s + by_libm + beyond_by_libm;
    return s + "\n#ifndef OWN_SINES" + by_libm + "#endif\n" + beyond_refused;
}

} // namespace codegen
