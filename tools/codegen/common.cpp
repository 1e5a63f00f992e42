/* The text that all functions of a file share. SPDX-License-Identifier: MIT */
#include "text.h"
#include <algorithm>

namespace codegen {
namespace {

const char language_text[] = R"(
#include <float.h>
#include <math.h>
#include <stdint.h>

#ifdef __cplusplus
#error "this file is C99: compile it as C, not as C++, which may include its header"
#endif
)";

/* Words of contraction: GCC's and the standard's. */
const char compiler_text[] = R"(
/* GCC's vectoriser packs scalars and loses time by it, as do its first scheduler on Arm, which spills, and
   memset for a few zeros. Its ISO modes do not contract products and sums to fused operations. */
#if defined __GNUC__ && !defined __clang__
#pragma GCC optimize("fp-contract=%s")
#pragma GCC diagnostic ignored "-Wpsabi"
#ifdef __OPTIMIZE__
#pragma GCC optimize("no-tree-loop-distribute-patterns")
#pragma GCC optimize("no-tree-slp-vectorize,no-tree-vectorize,no-math-errno")
#ifdef __arm__
#pragma GCC optimize("no-schedule-insns")
#endif
#endif
#else
#pragma STDC FP_CONTRACT %s
#endif

#ifdef __GNUC__
#define INLINE static inline __attribute__((always_inline, unused))
#define PART static __attribute__((noinline))
#define COLD static __attribute__((noinline, cold, unused))
#define UNUSED __attribute__((unused))
#else
#define INLINE static inline
#define PART static
#define COLD static
#define UNUSED
#endif
)";

const char rounding_text[] = R"(
/* Whether products and sums are rounded to the scalar. tcc does not tell how. */
#ifdef __FLT_EVAL_METHOD__
#define EVALUATION __FLT_EVAL_METHOD__
#elif defined FLT_EVAL_METHOD
#define EVALUATION FLT_EVAL_METHOD
#elif defined __TINYC__ && !defined __i386__
#define EVALUATION 0
#else
#define EVALUATION -1
#endif
#if EVALUATION == 0 || EVALUATION > 2 || (EVALUATION == 1 && !defined SCALAR_IS_FLOAT)
#define OWN_ROUNDS 1
#else
#define OWN_ROUNDS 0
#endif
)";

const char reproducible_text[] = R"(
#ifdef __RECIPROCAL_MATH__
#error "divisions have the bits of IEEE 754: compile without -freciprocal-math"
#endif
#if !OWN_ROUNDS
#error "not reproducible: x87 keeps more digits, use SSE2; s390x keeps those of double, use -std=gnu99"
#endif
)";

const char scalar_text[] = R"(
typedef scalar real;
typedef int mask;
#define LANE(x, j) (*((void)(j), &(x)))
INLINE int all(mask k) { return k; }
INLINE real choose(mask k, real x, real y) { return k ? x : y; }
)";

const char lanes_text[] = R"(
typedef signed_bit mask __attribute__((vector_size(LANES * sizeof(scalar))));
#define LANE(x, j) ((x)[j])
INLINE int all(mask k) {
    signed_bit every = -1;
    for (int j = 0; j < LANES; ++j) every &= k[j];
    return every != 0;
}
INLINE real choose(mask k, real x, real y) { return (real)(((mask)x & k) | ((mask)y & ~k)); }
)";

/* The verdict on pivots is rbd.h's: the first in the order of elimination that is not sound. */
const char real_text[] = R"(INLINE real splat(scalar x) {
    const real zero = {0};
    return zero + x;
}
INLINE real root(real x) {
    for (int j = 0; j < LANES; ++j) LANE(x, j) = LIBM_SQRT(LANE(x, j));
    return x;
}

/* Pivots are sound if they are above their rounding. 0 if all are; else, of the first lane where one is not,
   1 + the first dof, in the order of elimination, whose pivot is not, its negative if that is not a number;
   the lane's results become 0. Angles out of range are one pivot more, before the others. */
COLD int judge_closely(const real *pivot, const scalar *limit, int n, real *x, int size) {
    int status = 0;
    for (int j = 0; j < LANES; ++j) {
        int k = n - 1;
        while (k >= 0 && limit[k] < LANE(pivot[k], j)) --k;
        if (k < 0) continue;
        if (status == 0) status = LANE(pivot[k], j) <= limit[k] ? k + 1 : -1 - k;
        for (int i = 0; i < size; ++i) LANE(x[i], j) = 0;
    }
    return status;
}
INLINE int judge(const real *pivot, const scalar *limit, int n, real *x, int size) {
    mask sound = limit[0] < pivot[0];
    for (int k = 1; k < n; ++k) sound &= limit[k] < pivot[k];
    return all(sound) ? 0 : judge_closely(pivot, limit, n, x, size);
}
)";

const char limbs_text[] = R"(
/* Like limbs, side by side. */
typedef scalar limbs __attribute__((vector_size(LIMBS * sizeof(scalar))));
typedef scalar limbs_in_memory
    __attribute__((vector_size(LIMBS * sizeof(scalar)), aligned(sizeof(scalar)), may_alias));
#define side_by_side(first) (*(limbs_in_memory *)&(first))
)";

} // namespace

const char flags_text[] = R"(#if defined __FAST_MATH__ || defined __ASSOCIATIVE_MATH__
#error "reassociation voids the sine's argument reduction: compile without -ffast-math"
#elif defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0
#error "-ffinite-math-only removes the checks for NaN: compile without it"
#endif
)";

const char status_text[] = R"(
/* The status to return, from that of judge(). Its pivots are those of rows, the last first, then those of
   all dofs or of none. */
INLINE int status_of_rows(int status, int rows, int judged, int dofs) {
    const int k = (status < 0 ? -status : status) - 1, behind = dofs - judged - rows;
    if (status == 0 || k < rows) return status == 0 ? 0 : dofs + rows - k;
    return status < 0 ? status - behind : status + behind;
}
)";

std::string common_text(const std::vector<piece> &all, const target &t) {
    const auto any = [&all](auto has) { return std::any_of(all.begin(), all.end(), has); };
    std::string s =
        language_text + std::string(flags_text) +
        format(compiler_text, t.is_reproducible ? "off" : "fast", t.is_reproducible ? "OFF" : "ON") +
        format("\ntypedef %s scalar;\n#define LANES %d\n#define LIBM_SQRT sqrt%s\n%s",
               t.is_float ? "float" : "double", t.lanes, t.is_float ? "f" : "",
               t.is_float ? "#define SCALAR_IS_FLOAT\n" : "");
    s += rounding_text;
    if (t.is_reproducible) s += reproducible_text;
    if (t.lanes > 1)
        s += format("typedef %s_real real;\ntypedef %s signed_bit;\n", t.name.c_str(),
                    t.is_float ? "int32_t" : "int64_t") +
             lanes_text;
    else
        s += scalar_text;
    s += real_text + std::string(status_text) + copies_text();
    if (t.limbs > 1) s += format("\n#define LIMBS %d\n", t.limbs) + limbs_text;
    if (any([](const piece &x) { return !x.p.angles.empty(); })) s += sines_text(t);
    if (any([](const piece &x) { return x.p.f.rows > 0; })) s += rows_text();
    return s;
}

} // namespace codegen
