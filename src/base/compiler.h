#ifndef RBDI_BASE_COMPILER_H
#define RBDI_BASE_COMPILER_H
#include "base/types.h"
#include <float.h>

/* ---- compiler [compiler] ----
   Only this section and [configuration], for vector types and C99, depend on the compiler and its target. */

/* Options that void results. Other parts of -ffast-math do no harm: -freciprocal-math, -fno-signed-zeros,
   -fno-trapping-math, -fno-math-errno. */
#if defined __FAST_MATH__ || defined __ASSOCIATIVE_MATH__ || defined _M_FP_FAST || \
    (defined __USE_FAST_MATH__ && __USE_FAST_MATH__ + 0) /* NVRTC has 0 or 1 */
#error \
    "rbd: -ffast-math or -funsafe-math-optimizations reassociates the sine's argument reduction and voids \
the pivot checks; use -O3 -ffp-contract=fast instead"
#elif defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0
#error "rbd: -ffinite-math-only removes the checks for NaN and overflow; compile without it"
#elif RBDI_REPRODUCIBLE && (defined __RECIPROCAL_MATH__ || defined __NO_SIGNED_ZEROS__)
#error "rbd: RBD_REPRODUCIBLE: -freciprocal-math and -fno-signed-zeros change bits; compile without them"
#endif

#ifdef __GNUC__ /* GCC's extensions, which clang has too: attributes, vectors, assembly */
#define RBDI_GNU 1
#else
#define RBDI_GNU 0
#endif
#ifdef __clang__
#define RBDI_CLANG 1
#else
#define RBDI_CLANG 0
#endif
#define RBDI_GCC (RBDI_GNU && !RBDI_CLANG && !RBDI_GPU)

/* GCC has no macro for -fsingle-precision-constant, which rounds constants to float. It does no harm if
   rbd_real is float. */
#if RBDI_REAL_KIND != 2
typedef char rbd_needs_no_fsingle_precision_constant[sizeof 1.0 == sizeof(double) ? 1 : -1];
#endif

/* rbdi_require_ieee() does not compile where sums are reassociated, or NaN or infinity has no meaning. clang
   has no macro for most of this, and GCC's pragmas set none in C++. A compiler that optimises then knows
   beforehand what (x + 1) - x is, that x <= x, or that x is not infinite. One that does not optimise changes
   nothing. */
#if RBDI_GNU && !RBDI_GPU && defined __OPTIMIZE__ && defined __has_attribute
#if __has_attribute(error)
#define RBDI_SHOWS_OPTIONS 1
#endif
#endif
#ifdef RBDI_SHOWS_OPTIONS
#if RBDI_CLANG
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wunknown-warning-option"
#pragma clang diagnostic ignored "-Wnan-infinity-disabled" /* says the same, but does not stop */
#endif
__attribute__((error(
    "rbd: -fassociative-math, part of -funsafe-math-optimizations, voids the sine and the checks"))) void
rbdi_sums_are_reassociated(void);
__attribute__((error(
    "rbd: -ffinite-math-only, -fno-honor-nans and -fno-honor-infinities remove the checks for NaN"))) void
rbdi_nan_is_lost(void);

static inline void rbdi_require_ieee(void) {
    const volatile double unknown = 0;
    const double x = unknown;
    if (__builtin_constant_p((x + 1) - x)) rbdi_sums_are_reassociated();
    if (__builtin_constant_p(x <= x) || __builtin_constant_p(__builtin_isinf_sign(x))) rbdi_nan_is_lost();
}
#if RBDI_CLANG
#pragma clang diagnostic pop
#endif
#else
static inline RBDI_BOTH void rbdi_require_ieee(void) {}
#endif

#if defined __OPTIMIZE__ && !defined __OPTIMIZE_SIZE__
#define RBDI_FOR_SPEED 1
#else
#define RBDI_FOR_SPEED 0
#endif
#ifdef __SOFTFP__ /* without a floating-point unit each operation is a call */
#define RBDI_HARD_FLOAT 0
#else
#define RBDI_HARD_FLOAT 1
#endif

/* Doubles in one SIMD register, 0 without SIMD. With AVX-512 half a register: the rows of one state are
   short, and whole registers made single calls slower (Intel, Cholesky of Atlas by a third). Lanes may be
   longer: RBD_LANES. */
#if RBDI_GPU
#define RBDI_SIMD 0
#elif defined __AVX__
#define RBDI_SIMD 4
#elif defined __SSE2__ || (defined __ARM_NEON && defined __aarch64__) || defined __wasm_simd128__
#define RBDI_SIMD 2
#else
#define RBDI_SIMD 0
#endif
#if RBDI_SIMD > RBDI_WIDEST_SIMD
#error "rbd: RBDI_WIDEST_SIMD, for which memory is sized, must be at least RBDI_SIMD"
#endif
#ifdef __has_builtin
#if __has_builtin(__builtin_shufflevector)
#define RBDI_HAS_SHUFFLE 1
#endif
#endif
#ifndef RBDI_HAS_SHUFFLE
#define RBDI_HAS_SHUFFLE 0
#endif

/* Whether products and sums are rounded to the scalar. FLT_EVAL_METHOD -1 and 2 keep more digits, 1 rounds
   double alone. Other values concern types that are not used here, such as 16 in GCC's default dialects for a
   half precision unit. tcc does not define it. */
#ifdef __FLT_EVAL_METHOD__
#define RBDI_EVALUATION __FLT_EVAL_METHOD__
#elif defined FLT_EVAL_METHOD
#define RBDI_EVALUATION FLT_EVAL_METHOD
#elif defined __TINYC__ && !defined __i386__
#define RBDI_EVALUATION 0
#else
#define RBDI_EVALUATION -1
#endif
#if RBDI_EVALUATION == 0 || RBDI_EVALUATION > 2 || (RBDI_EVALUATION == 1 && RBDI_REAL_KIND == 1)
#define RBDI_ROUNDS 1
#else
#define RBDI_ROUNDS 0
#if RBDI_REPRODUCIBLE
#error "rbd: RBD_REPRODUCIBLE: x87 keeps more digits (use SSE2), and s390x those of double (use -std=gnu99)"
#endif
#endif

#if RBDI_REPRODUCIBLE
#define RBDI_CONTRACTION "fp-contract=off"
#else
#define RBDI_CONTRACTION "fp-contract=fast"
#endif
/* GCC's vectoriser packs the scalars of 3-vectors, which costs time. GCC turns loops that clear a few numbers
   into calls of memset, and its ISO modes switch contraction to FMA off. clang needs none of this. */
#if RBDI_GCC && defined __OPTIMIZE__
#define RBDI_PRAGMA(text) _Pragma(#text)
#define RBDI_OPTIMIZE_WITH(level, contraction) \
    RBDI_PRAGMA(GCC optimize(level "no-tree-slp-vectorize,no-tree-vectorize," \
                                   "no-tree-loop-distribute-patterns," contraction))
#define RBDI_OPTIMIZE(level) RBDI_OPTIMIZE_WITH(level, RBDI_CONTRACTION)
#define RBDI_CODE_BEGIN _Pragma("GCC push_options") RBDI_OPTIMIZE("")
#define RBDI_CODE_END _Pragma("GCC pop_options")
#else
#define RBDI_CODE_BEGIN
#define RBDI_CODE_END
#endif

/* Dynamics at -Os: no code is compiled for special cases (RBDI_FOR_SPEED), which halves it. GCC's level 2
   then makes it 6 % larger and saves a fifth of the instructions. All options stand in one list, because a
   level undoes earlier ones. */
#if RBDI_GCC && defined __OPTIMIZE_SIZE__
#define RBDI_DYNAMICS_BEGIN _Pragma("GCC push_options") RBDI_OPTIMIZE("O2,")
#else
#define RBDI_DYNAMICS_BEGIN RBDI_CODE_BEGIN
#endif

/* The build of a model, which runs once: at GCC's -Os it is a third smaller. It has the contraction of the
   command line. */
#if RBDI_GCC && RBDI_FOR_SPEED && RBDI_REPRODUCIBLE
#define RBDI_BUILD_BEGIN _Pragma("GCC push_options") RBDI_PRAGMA(GCC optimize("Os,fp-contract=off"))
#elif RBDI_GCC && RBDI_FOR_SPEED
#define RBDI_BUILD_BEGIN _Pragma("GCC push_options") RBDI_PRAGMA(GCC optimize("Os"))
#elif RBDI_GCC && defined __OPTIMIZE__
#define RBDI_BUILD_BEGIN _Pragma("GCC push_options")
#else
#define RBDI_BUILD_BEGIN
#endif

/* RBDI_INLINE: vector algebra, and the steps that are compiled once for each common set of link flags. Where
   the compiler optimises it always inlines them: to pass vectors in memory would take ten times as long at
   -Os, and save a fifth of the code. RBDI_PART: all others; a build may leave them unused. */
#if RBDI_GNU && (defined __OPTIMIZE__ || RBDI_GPU)
#define RBDI_INLINE static inline RBDI_BOTH __attribute__((always_inline, unused))
#else
#define RBDI_INLINE static inline RBDI_BOTH RBDI_UNUSED
#endif
/* RBDI_ONCE: inlined where the compiler optimises for speed; at -Os there is one copy for all callers. */
#if RBDI_FOR_SPEED
#define RBDI_ONCE RBDI_INLINE
#else
#define RBDI_ONCE RBDI_PART
#endif
#if RBDI_GNU
#define RBDI_COLD static RBDI_BOTH __attribute__((noinline, cold, unused)) /* hardly ever called */
#else
#define RBDI_COLD static RBDI_BOTH RBDI_UNUSED
#endif
#if RBDI_GPU && RBDI_GNU /* nvcc would inline them everywhere: three times the code */
#define RBDI_PART static RBDI_BOTH __attribute__((noinline, unused))
#else
#define RBDI_PART static RBDI_UNUSED
#endif
/* RBDI_LOCAL: steps of a room that something calls wherever the room is compiled; a compiler warns where
   nothing does. */
#define RBDI_LOCAL static RBDI_BOTH
/* For a function that returns one of many texts. GCC would keep them in an array, which is linked even if
   nothing calls the function, as soon as the file has any other text, such as a model's names. */
#if RBDI_GCC
#define RBDI_MESSAGES __attribute__((optimize("no-tree-switch-conversion")))
#else
#define RBDI_MESSAGES
#endif
/* Unrolls short loops, such as those over six components; clang does so by itself. */
#if RBDI_GCC && RBDI_FOR_SPEED
#define RBDI_UNROLL_SIX _Pragma("GCC unroll 6")
#define RBDI_UNROLL_ROW _Pragma("GCC unroll 8")
#define RBDI_UNROLL_TWO _Pragma("GCC unroll 2")
#else
#define RBDI_UNROLL_SIX
#define RBDI_UNROLL_ROW
#define RBDI_UNROLL_TWO
#endif
/* Keeps one address for all columns of a row. Without it the compiler computes one for each column. */
#if RBDI_GNU && !RBDI_GPU
#define RBDI_ONE_INDEX(row) __asm__("" : "+r"(row))
#else
#define RBDI_ONE_INDEX(row) (void)(row)
#endif

#endif
