/* The generated code's own sine and cosine: rbd.h's, see its rbdi_sincos_batch, for the scalar wanted.
   tests/codegen/sines.c holds the two against each other, bit by bit. SPDX-License-Identifier: MIT */
#include "sines.h"
#include "own_sines.h"

namespace codegen {

/* The lines that end a sine and cosine: from the rest of an angle and its quadrant. */
#define SINES_OF_REST \
    "    z = r * r;\n" \
    "    sine.x = z * r * (SINE_TAIL(z)) + r;\n" \
    "    cosine.x = z * z * (COSINE_TAIL(z)) + (ONE - HALF * z);\n" \
    "    k = shifted.b;\n" \
    "    swap = (sine.b ^ cosine.b) & (0u - (k & 1u));\n" \
    "    sine.b = (sine.b ^ swap) ^ ((k & 2u) << QUADRANT_SIGN);\n" \
    "    cosine.b = (cosine.b ^ swap) ^ (((k + 1u) & 2u) << QUADRANT_SIGN);\n" \
    "    *s = sine.x;\n" \
    "    *c = cosine.x;\n"

const char sines_double[] = R"(
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

const char sines_float[] = R"(
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
    shifted.x = x * TWO_OVER_PI + WHOLE;
    n = shifted.x - WHOLE;
    r = REST(x, n);
)" SINES_OF_REST R"(    *squares += x * x;
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

static const char reproducible_text[] = R"(
#if LANES > 1
typedef bit bits __attribute__((vector_size(LANES * sizeof(scalar))));
INLINE int is_inside(real x) {
    const mask inside = x * x < SINES_LIMIT * SINES_LIMIT;
    signed_bit all = -1;
    for (int j = 0; j < LANES; ++j) all &= inside[j];
    return all != 0;
}
#else
typedef bit bits;
INLINE real splat(scalar x) { return x; }
INLINE int is_inside(real x) { return x * x < SINES_LIMIT * SINES_LIMIT; }
#endif

/* Sine and cosine of x, below SINES_LIMIT, and as many right angles. x = n pi/2 + r by adding and subtracting
   1.5 * 2^(mantissa bits), to which right angles are added; the quadrant, in the sum's low bits, swaps and
   signs the two. */
INLINE void sines(real x, real quarters, real *s, real *c) {
    union {
        real x;
        bits b;
    } shifted, sine, cosine;
    const real whole = quarters + WHOLE;
    real n, r, z;
    bits k, swap;
    shifted.x = x * TWO_OVER_PI + whole;
    n = shifted.x - whole;
    r = REST(x, n);
)" SINES_OF_REST R"(}

#ifdef ANGLES_ARE_BOUNDED
/* Sine and cosine of an angle not below SINES_LIMIT become NaN, and so does *verdict if it is not NULL. */
PART void sines_of(const real *x, const scalar *quarters, int n, real *s, real *c, real *verdict) {
    for (int i = 0; i < n; ++i) {
        sines(x[i], splat(quarters[i]), &s[i], &c[i]);
        if (!is_inside(x[i])) {
            const real k = choose(x[i] * x[i] < SINES_LIMIT * SINES_LIMIT, splat(ONE), splat((scalar)NAN));
            s[i] *= k, c[i] *= k;
            if (verdict) *verdict *= k;
        }
    }
}
#else
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

COLD void reduce(real *x, real *quarters) {
#if LANES > 1
    for (int j = 0; j < LANES; ++j) {
        scalar k = (*quarters)[j];
        if (!((*x)[j] * (*x)[j] < SINES_LIMIT * SINES_LIMIT)) (*x)[j] = reduced((*x)[j], &k);
        (*quarters)[j] = k;
    }
#else
    *x = reduced(*x, quarters);
#endif
}

/* Of n angles and as many right angles. */
PART void sines_of(const real *x, const scalar *quarters, int n, real *s, real *c, real *verdict) {
    (void)verdict;
    for (int i = 0; i < n; ++i) {
        real angle = x[i], k = splat(quarters[i]);
        if (!is_inside(angle)) reduce(&angle, &k);
        sines(angle, k, &s[i], &c[i]);
    }
}
#endif
)";

std::string sines_reproducible(bool is_float, bool is_bounded) {
    std::string s = is_float
                        ? "#define MANTISSA 23\n#define REDUCTION 2 /* words of the fraction of x 2/pi */\n"
                        : "#define MANTISSA 52\n#define REDUCTION 4 /* words of the fraction of x 2/pi */\n";
    if (is_bounded) return reproducible_text;
    s += "static const uint32_t two_over_pi[] = {";
    int k = 0;
    for (uint32_t word : is_float ? two_over_pi_float() : two_over_pi_double())
        s += (k == 0 ? "\n    " : k % 8 == 0 ? ",\n    " : ", ") + std::to_string(word) + "u", k++;
    return s + "};\n" + reproducible_text;
}

} // namespace codegen
