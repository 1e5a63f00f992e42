/* The generated code's own sine and cosine: those of rbd.h, in its text (src/base/reduction.h, sincos.h) with
   other names. SPDX-License-Identifier: MIT */
#include "text.h"
#include <cstring>

namespace codegen {
namespace {

const char library[] = {
#include "sincos_text.h"
};

const char batches_text[] = R"(
/* A batch is as many angles as one SIMD instruction takes, 256 bits at most. */
#if LANES > 1
#define OWN_LANES LANES
#define OWN_BATCH 1
typedef real own_batch;
#elif OWN_ROUNDS && defined __GNUC__ && (defined __SSE2__ || (defined __ARM_NEON && defined __aarch64__))
#if defined __AVX__ || defined SCALAR_IS_FLOAT
#define OWN_BATCH 4
#else
#define OWN_BATCH 2
#endif
typedef scalar own_batch
    __attribute__((vector_size(OWN_BATCH * sizeof(scalar)), aligned(sizeof(scalar)), may_alias));
typedef own_bit own_bits __attribute__((vector_size(OWN_BATCH * sizeof(scalar))));
#else
#define OWN_BATCH 1
#define OWN_BATCH_SCALAR
typedef real own_batch;
#endif
INLINE own_batch own_all_lanes(real x) {
    const own_batch zero = {0};
    return x - zero;
}
INLINE real own_first_lane(own_batch x) {
#if OWN_BATCH > 1
    return x[0];
#else
    return x;
#endif
}
)";

const char by_batches[] = R"(
typedef own_batch batch;

/* Sine and cosine of x, |x| below SINES_LIMIT, and the right angles from i on, none if quarters is 0;
   *squares grows by x^2. */
#ifdef OWN_POLYNOMIAL_SINCOS
INLINE void sines(batch x, const scalar *quarters, int i, batch *s, batch *c, batch *squares) {
    batch turns = {0};
#if OWN_BATCH > 1
    if (quarters) turns = *(const batch *)(quarters + i);
#else
    if (quarters) turns = splat(quarters[i]);
#endif
    own_sincos_batch(x, turns, s, c);
    *squares += x * x;
}
#endif

/* Of the first n of four angles, which are kept in x. They come by value: what is stored one by one and read
   together stalls. */
INLINE void sines4(int n, real x0, real x1, real x2, real x3, const scalar *quarters, real *x, real *s,
                   real *c, batch *squares) {
#if !defined OWN_POLYNOMIAL_SINCOS || defined OWN_BATCH_SCALAR
    (void)quarters, (void)s, (void)c, (void)squares;
    x[0] = x0;
    if (n > 1) x[1] = x1;
    if (n > 2) x[2] = x2;
    if (n > 3) x[3] = x3;
#elif OWN_BATCH == 4
    const batch all = {x0, x1, x2, x3};
    (void)n;
    *(batch *)x = all;
    sines(all, quarters, 0, (batch *)s, (batch *)c, squares);
#elif OWN_BATCH == 2
    const batch first = {x0, x1}, second = {x2, x3};
    *(batch *)x = first;
    sines(first, quarters, 0, (batch *)s, (batch *)c, squares);
    if (n < 3) return;
    *(batch *)(x + 2) = second;
    sines(second, quarters, 2, (batch *)(s + 2), (batch *)(c + 2), squares);
#else
    const real all[4] = {x0, x1, x2, x3};
    for (int i = 0; i < n; ++i) sines(x[i] = all[i], quarters, i, &s[i], &c[i], squares);
#endif
}

/* One at a time they are a loop, for the sake of flash. */
#if defined OWN_POLYNOMIAL_SINCOS && defined OWN_BATCH_SCALAR
#define SINES_OF(n, quarters) \
    for (int i = 0; i < (n); ++i) sines(angle[i], quarters, i, sine + i, cosine + i, &squares)
#else
#define SINES_OF(n, quarters) (void)0
#endif

/* Where this is 0, any angle may lie beyond; without sines of our own, always. */
INLINE int are_inside(batch squares) {
#ifndef OWN_POLYNOMIAL_SINCOS
    (void)squares;
    return 0;
#elif defined OWN_BATCH_SCALAR
    return squares < SINES_LIMIT * SINES_LIMIT;
#else
    const own_bits inside = (own_bits)(squares < SINES_LIMIT * SINES_LIMIT);
    own_bit every = 1;
    for (int i = 0; i < LANES * OWN_BATCH; ++i) every &= inside[i];
    return (int)every;
#endif
}

/* Sines and cosines of angles of which some are not below SINES_LIMIT; if that is refused theirs become NaN,
   and so does *verdict if it is not NULL. */
COLD void sines_beyond(const real *x, const scalar *quarters, int n, real *s, real *c, real *verdict) {
    (void)quarters, (void)verdict;
    for (int i = 0; i < n; ++i) {
#ifndef OWN_POLYNOMIAL_SINCOS
        own_sincos(x[i], &s[i], &c[i]);
#elif !defined BOUNDED
        own_sincos_one(x[i], splat(quarters ? quarters[i] : 0), &s[i], &c[i]);
#endif
#ifdef BOUNDED
        const real k = choose(x[i] * x[i] < SINES_LIMIT * SINES_LIMIT, splat(1), splat((scalar)NAN));
        s[i] *= k, c[i] *= k;
        if (verdict) *verdict *= k;
#endif
    }
}
)";

/* Of the library's text, from one word to the end of another. */
std::string cut(const char *first, const char *last) {
    const std::string all = library;
    const size_t from = all.find(first), to = all.find(last, from);
    if (to == all.npos) throw std::runtime_error("src/base/sincos.h has changed: tools/codegen/sines.cpp");
    return all.substr(from, to + strlen(last) - from);
}

} // namespace

std::string own_sincos_text() {
    return cut("typedef own_bit own_bits", "return u.x;\n}\n") + "\n" +
           cut("/* Sine and cosine of x + quarters", "\n}\n");
}

std::string sines_text(const target &t) {
    return format("\n#define OWN_REAL_KIND %d\ntypedef uint%d_t own_bit;\n#define SINES_LIMIT %s%s\n%s"
                  "#define OWN_SIN sin%s\n#define OWN_COS cos%s\n",
                  t.is_float ? 2 : 1, t.is_float ? 32 : 64, angle_limit(t), t.is_float ? "f" : "",
                  t.is_bounded ? "#define BOUNDED\n" : "", t.is_float ? "f" : "", t.is_float ? "f" : "") +
           batches_text + library + by_batches;
}

} // namespace codegen
