#ifndef RBDI_BASE_COMPILER_H
#define RBDI_BASE_COMPILER_H
#include "base/types.h"
#include <float.h>

/* ---- compiler [compiler] ----
   All that depends on the compiler and its target. No other section asks for them, except [configuration] for
   vector types and C99. */

#if defined __FAST_MATH__ || defined __ASSOCIATIVE_MATH__
#error \
    "rbd: -ffast-math or -funsafe-math-optimizations reassociates the sine's argument reduction and voids \
the pivot checks; use -O3 -ffp-contract=fast instead"
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
#define RBDI_GCC (RBDI_GNU && !RBDI_CLANG)

#if defined __OPTIMIZE__ && !defined __OPTIMIZE_SIZE__
#define RBDI_FOR_SPEED 1
#else
#define RBDI_FOR_SPEED 0
#endif
#ifdef __SOFTFP__ /* arithmetic is a call */
#define RBDI_HARD_FLOAT 0
#else
#define RBDI_HARD_FLOAT 1
#endif

/* Doubles that one SIMD instruction takes, 0 without; of AVX-512 half: what one state has is short, and whole
   ones of 512 bits made single calls slower (Intel, Cholesky of Atlas by a third). Lanes may be longer:
   RBD_LANES. */
#ifdef __AVX__
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

/* Products and sums are rounded to the scalar: not with -1 and 2, which keep more of them, and with 1 those
   of double alone. Other values, as 16 of GCC's default dialects where there is a half precision unit, are of
   types that are not used here. tcc does not tell. */
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
/* GCC's vectoriser packs the scalars of 3-vectors, which costs time. GCC makes calls of memset of loops that
   clear a few numbers, and its ISO modes switch contraction to FMA off. clang needs none of this. */
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

/* Dynamics. At -Os no part of the code is compiled for special cases (RBDI_FOR_SPEED), which halves it; GCC's
   level 2 then makes it 6 % larger and saves a fifth of the instructions. All in one list: a level undoes
   earlier ones. */
#if RBDI_GCC && defined __OPTIMIZE_SIZE__
#define RBDI_DYNAMICS_BEGIN _Pragma("GCC push_options") RBDI_OPTIMIZE("O2,")
#else
#define RBDI_DYNAMICS_BEGIN RBDI_CODE_BEGIN
#endif

/* RBDI_INLINE: vector algebra, and the steps that are compiled once for each common set of link flags. It is
   inlined always where the compiler optimises: vectors that are passed in memory would cost ten times as much
   at -Os, to save a fifth of the code. RBDI_PART: all others; a build may leave them unused. */
#if RBDI_GNU && defined __OPTIMIZE__
#define RBDI_INLINE static inline __attribute__((always_inline, unused))
#else
#define RBDI_INLINE static inline RBDI_UNUSED
#endif
/* RBDI_ONCE: inlined where the compiler optimises for speed; at -Os there is one copy for all callers. */
#if RBDI_FOR_SPEED
#define RBDI_ONCE RBDI_INLINE
#else
#define RBDI_ONCE RBDI_PART
#endif
#if RBDI_GNU
#define RBDI_COLD static __attribute__((noinline, cold, unused)) /* hardly ever called */
#else
#define RBDI_COLD static RBDI_UNUSED
#endif
#define RBDI_PART static RBDI_UNUSED
/* For a function that chooses among texts. GCC would make an array of them, which is linked even if nothing
   calls the function, when the file has any other text, as a model's names. */
#if RBDI_GCC
#define RBDI_MESSAGES __attribute__((optimize("no-tree-switch-conversion")))
#else
#define RBDI_MESSAGES
#endif
/* The short loops, over six components, in any case; clang does so by itself. */
#if RBDI_GCC && RBDI_FOR_SPEED
#define RBDI_UNROLL_SIX _Pragma("GCC unroll 6")
#define RBDI_UNROLL_ROW _Pragma("GCC unroll 8")
#define RBDI_UNROLL_TWO _Pragma("GCC unroll 2")
#else
#define RBDI_UNROLL_SIX
#define RBDI_UNROLL_ROW
#define RBDI_UNROLL_TWO
#endif
/* Stands before columns of a row are read or written one by one. Without it each gets an index of its own. */
#if RBDI_GNU
#define RBDI_ONE_INDEX(row) __asm__("" : "+r"(row))
#else
#define RBDI_ONE_INDEX(row) (void)(row)
#endif

#endif
