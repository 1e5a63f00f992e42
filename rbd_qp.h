/* rbd_qp.h - small convex quadratic programs, for control, in one C99 header. Version 0.4.0.
   Made by src/amalgamate.py from src/rbd_qp.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end.

   Minimises x'Hx/2 + f'x within bounds of x and of C x, without allocation, dependency, global or NaN. It
   stands alone; rbd.h may stand beside it. In ONE file of the program:

       #define RBD_IMPLEMENTATION
       #include "rbd_qp.h"

   and plain #include "rbd_qp.h" everywhere else. The nearest point to (1, 0.5) with x + y <= 1 and x >= 0:

       const double H[4] = {1, 0, 0, 1}, f[2] = {-1, -0.5}, C[2] = {1, 1};
       const double lower[2] = {0, -RBD_QP_NONE}, upper[2] = {RBD_QP_NONE, 1};
       const rbd_qp_problem p = {.n = 2, .bounds = 1, .rows = 1, .H = H, .f = f, .C = C,
                                 .lower = lower, .upper = upper};
       unsigned char memory[RBD_QP_SIZE(2, 1, 1, 0)];
       double x[2], lambda[2];
       signed char side[2];
       rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, side, NULL);   // x = (0.75, 0.25)

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits] [cost]
     [problem] [solve]
     --- stop here if you only use it ---
     [layout] [compiler] [tolerances] [scalar] [pieces]
     [method] [vectors] [factor] [active rows] [search] [refinement] [rounds] [solve code]
     [text code]
     [licence]

   [conventions]
     rows         first the bounds of x, then the rows of C; an equality has lower = upper
     soft         a row with a weight w may be missed by e, at a cost of w e^2/2
     lambda       Hx + f + C'lambda = 0; above 0 where the upper side holds. Arrays and signs are DAQP's
     matrices     row-major

   [configuration] That of rbd.h. RBD_REAL is double or float; RBD_LANES and RBD_REAL_CUSTOM do not go with
   it.

   [guarantees]
     No allocation, recursion, VLA, global, stdio, locale or errno. Reentrant. From libm only sqrt. The number
     of steps is bounded: options->steps. A result with RBD_QP_OK satisfies the conditions of Karush, Kuhn and
     Tucker to the shares that result->primal and ->dual state, at most ten times options->accuracy. x is
     finite with every status, but after RBD_QP_NULL, _RANGE and _MEMORY it is as it was. The bits are the
     same on every machine with RBD_REPRODUCIBLE, as of rbd.h.

   [limits]
     Dense matrices, of up to some hundred variables: a step costs about 3 n^2 products, and one for each
     entry of C. H must be convex. If it is only semidefinite, a proximal method takes some rounds, and the
     optimum is exact to the accuracy, not to rounding. Squares of the entries of a row must be normal
     numbers. result->dual is a share of the cost's largest term: what is 1e8 times weaker (float: 1e3) is
     less exact. Rows at an angle of less than 1e-6 (float: 1e-2) may have multipliers too large to be exact:
     RBD_QP_INACCURATE. Weights of soft rows more than 1e14 above H (float: 1e4) may end in RBD_QP_ITERATIONS
     or _INACCURATE, never in _INFEASIBLE: hard rows are better there. Linear programs whose vertices lie far
     apart, as those of Klee and Minty do from 7 variables on (float: 5), may end in RBD_QP_ITERATIONS: more
     options->rounds. In float RBD_QP_UNBOUNDED is said where f falls by a tenth of its terms; less is
     RBD_QP_INACCURATE. Of problems without H (all 0) that are unbounded a few of a thousand end in
     RBD_QP_ITERATIONS or _NAN instead, of those with soft rows alone a few of a hundred.

   [cost] Flash for a Cortex-M4F at -Os: 13.6 kB of rbd_qp_solve. Contact forces of HyQ without a warm
   start, by gcc 12.2 -O2: instructions of a Cortex-M4F in float, the mean of 32 problems; microseconds of a
   PC in double, the mean of 400, with -march=native (AVX-512) and without. More in docs/qp.md:

                                              instructions    native   without
     12 forces, 28 rows, few limits reached         37,685       3.0       3.3
     the same, many                                 97,040       8.0       8.9
     18 accelerations too, 46 rows, few            118,976       8.7      10.1
     the same, many                                204,902      13.6      16.5
*/

/* ==== src/api/configuration.h ==== */
#ifndef RBDI_API_CONFIGURATION_H
#define RBDI_API_CONFIGURATION_H
#ifdef RBD_BATCH_IMPLEMENTATION /* all but the calls of rbd_batch.h is static: another file implements it */
#define RBD_IMPLEMENTATION
#define RBD_STATIC
#endif

#include <stddef.h>
#include <stdint.h>

#define RBD_VERSION "0.4.0"
#define RBD_VERSION_NUMBER 400 /* 10000 major + 100 minor + patch: for headers that build on this one */
#define RBD_MODEL_VERSION 6    /* layout of the built model; generated tables check it */

/* The macros of [configuration], checked and completed. */

/* Code of a GPU: nvcc, clang for CUDA and hipcc compile a file for the host and for the GPU. Each function is
   code of both then, and all memory has the same layout there. Without RBD_STATIC such a file has
   declarations alone, of code that another file compiles for the host. */
#if (defined __CUDACC__ || defined __CUDA__ || defined __HIP__) && defined RBD_STATIC
#define RBDI_GPU 1
#else
#define RBDI_GPU 0
#endif

/* A wrong macro gives one #error. It is then replaced by a value that works, so that no other message
   follows. */
#if !defined __cplusplus && (!defined __STDC_VERSION__ || __STDC_VERSION__ < 199901L)
#error "rbd: needs C99 or later: compile with -std=c99, c11, c17 or a gnu dialect of them"
#undef RBD_IMPLEMENTATION
#elif (defined __CUDACC__ || defined __CUDA__ || defined __HIP__) && defined RBD_IMPLEMENTATION && !RBDI_GPU
#error "rbd: code of a GPU lies in the file that calls it: define RBD_STATIC in each file that implements rbd"
#undef RBD_IMPLEMENTATION
#endif

#ifndef RBD_REAL
#define RBD_REAL double
#endif
#if !defined RBD_CONST && defined RBD_REAL_CUSTOM
#define RBD_CONST double
#elif !defined RBD_CONST
#define RBD_CONST RBD_REAL
#endif

#define RBDI_KIND_double 1
#define RBDI_KIND_float 2
#define RBDI_KIND___float128 3
#define RBDI_KIND_long 0 && /* long double, that the words behind it count as 0 */
#define RBDI_KIND_OF(type) RBDI_KIND_##type
#define RBDI_KIND(type) RBDI_KIND_OF(type)
#ifdef RBD_REAL_CUSTOM
#define RBDI_REAL_KIND 0
#elif (RBDI_KIND(RBD_REAL)) /* RBD_REAL: double, float or __float128; a class needs RBD_REAL_CUSTOM too */
#define RBDI_REAL_KIND RBDI_KIND(RBD_REAL)
#else
#error "rbd: RBD_REAL must be double, float or __float128 (for a C++ class define RBD_REAL_CUSTOM as well)"
#undef RBD_REAL
#undef RBD_CONST
#define RBD_REAL double
#define RBD_CONST double
#define RBDI_REAL_KIND 1
#endif
#if !(RBDI_KIND(RBD_CONST)) || (RBDI_REAL_KIND != RBDI_KIND(RBD_CONST) && RBDI_REAL_KIND % 3 != 0)
#error "rbd: RBD_CONST must be RBD_REAL; where that is __float128 or a class: double, float or __float128"
#undef RBD_CONST
#define RBD_CONST RBD_REAL
#endif

#if defined RBD_LANES && (RBD_LANES + 0 < 2 || (RBD_LANES + 0 & RBD_LANES + -1) != 0)
#error "rbd: RBD_LANES must be 2, 4, 8 or another power of two; leave it undefined for one state at a time"
#undef RBD_LANES
#define RBD_LANES 2
#endif
#if defined RBD_LANES && RBDI_GPU
#error "rbd: code of a GPU has one state a thread: leave RBD_LANES undefined"
#undef RBD_LANES
#elif defined RBD_LANES && (!defined __GNUC__ || RBDI_REAL_KIND % 3 == 0)
#error "rbd: RBD_LANES needs GCC or clang, and RBD_REAL double or float"
#undef RBD_LANES
#endif

/* From here to the end of the file, also in functions that are inlined. clang obeys unless
   -ffp-contract=fast is on its command line. */
#ifdef RBD_REPRODUCIBLE
#if RBDI_REAL_KIND % 3 == 0
#error "rbd: RBD_REPRODUCIBLE needs RBD_REAL double or float"
#undef RBD_REPRODUCIBLE
#elif RBDI_GPU
#error "rbd: RBD_REPRODUCIBLE has no meaning for code of a GPU: compile it with -fmad=false instead"
#undef RBD_REPRODUCIBLE
#elif defined __clang__
#pragma clang fp contract(off)
#elif defined __GNUC__
#pragma GCC optimize("fp-contract=off")
#else
#pragma STDC FP_CONTRACT OFF
#endif
#endif
#ifdef RBD_REPRODUCIBLE
#define RBDI_REPRODUCIBLE 1
#else
#define RBDI_REPRODUCIBLE 0
#endif

/* Functions and tables of host and GPU. A table is the GPU's own in that compiler's pass for it alone. */
#if RBDI_GPU && defined __clang__
#define RBDI_BOTH __attribute__((host, device))
#define RBDI_THERE __attribute__((device))
#elif RBDI_GPU
#define RBDI_BOTH __host__ __device__
#define RBDI_THERE __device__
#else
#define RBDI_BOTH
#endif
#if !RBDI_GPU || !(defined __CUDA_ARCH__ || defined __HIP_DEVICE_COMPILE__)
#undef RBDI_THERE
#define RBDI_THERE
#endif
#ifdef RBD_STATIC
#define RBDI_API static RBDI_BOTH RBDI_UNUSED
#else
#define RBDI_API extern
#endif
#if defined __GNUC__ || defined __clang__ /* clang for Windows is no __GNUC__ */
#define RBDI_UNUSED __attribute__((unused))
#define RBDI_EXTENSION __extension__
#else
#define RBDI_UNUSED
#define RBDI_EXTENSION
#endif

/* Every file has a symbol whose value encodes the scalar. The linker accepts it several times if all values
   are equal, else it refuses; in link-time optimisation the assembler does. It has no section, so that it
   takes no memory and is never removed. clang's link-time optimisation would refuse equal values too. */
#ifndef RBD_CHECK_SCALAR
#if defined __GNUC__ && !defined __clang__ && defined __ELF__ && !defined RBD_STATIC && \
    !defined RBD_REAL_CUSTOM
#define RBD_CHECK_SCALAR 1
#else
#define RBD_CHECK_SCALAR 0
#endif
#endif
#if RBD_CHECK_SCALAR
#define RBDI_QUOTE_OF(x) #x
#define RBDI_QUOTE(x) RBDI_QUOTE_OF(x)
#ifdef RBD_LANES
#define RBDI_SCALAR_LANES RBD_LANES
#else
#define RBDI_SCALAR_LANES 1
#endif
#define RBDI_SCALAR "rbd_files_differ_in_RBD_REAL_RBD_CONST_RBD_LANES_or_RBD_REPRODUCIBLE"
#define RBDI_SCALAR_VALUE \
    "(" RBDI_QUOTE(RBDI_KIND(RBD_REAL)) "+4*" RBDI_QUOTE(RBDI_KIND(RBD_CONST)) "+16*" RBDI_QUOTE( \
        RBDI_REPRODUCIBLE) "+32*" RBDI_QUOTE(RBDI_SCALAR_LANES) ")"
__asm__(".ifndef " RBDI_SCALAR "\n"
        ".globl " RBDI_SCALAR "\n"
        ".hidden " RBDI_SCALAR "\n" RBDI_SCALAR " = " RBDI_SCALAR_VALUE "\n"
        ".elseif " RBDI_SCALAR " - " RBDI_SCALAR_VALUE "\n"
        ".error \"" RBDI_SCALAR "\"\n"
        ".endif\n");
#endif

#define RBDI_PASTE_OF(a, b) a##_##b
#define RBDI_PASTE(a, b) RBDI_PASTE_OF(a, b)

RBDI_EXTENSION typedef RBD_CONST rbd_const; /* constants of the model */
#define RBD_C(x) ((rbd_const)(x))           /* a literal as a constant of the model, without a warning */
#ifdef RBD_LANES
typedef RBD_REAL rbd_real __attribute__((vector_size(RBD_LANES * sizeof(RBD_REAL))));
#else
RBDI_EXTENSION typedef RBD_REAL rbd_real; /* states and results */
#endif

#if defined __cplusplus && !defined RBD_REAL_CUSTOM && !defined RBD_STATIC
#define RBDI_EXTERN_C_BEGIN extern "C" {
#define RBDI_EXTERN_C_END }
#else
#define RBDI_EXTERN_C_BEGIN
#define RBDI_EXTERN_C_END
#endif
#endif

/* ==== src/rbd_qp.h ==== */
/* The caller's macros of single letters, such as I of complex.h, are set aside and come back at the end. */

/* ==== src/base/letters_begin.h ==== */
#pragma push_macro("C")
#undef C
#pragma push_macro("D")
#undef D
#pragma push_macro("H")
#undef H
#pragma push_macro("J")
#undef J
#pragma push_macro("L")
#undef L
#pragma push_macro("R")
#undef R
#pragma push_macro("V")
#undef V

/* ==== src/rbd_qp.h ==== */
#ifndef RBD_QP_H
#define RBD_QP_H

#if RBD_VERSION_NUMBER < 400
#error "rbd_qp.h: needs a newer rbd.h"
#endif

#if defined RBD_LANES || RBDI_REAL_KIND % 3 == 0
#error "rbd: rbd_qp.h needs RBD_REAL double or float, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/qp.h ==== */
/* The symbols name the scalar, so that files which differ in it do not link. */
#define RBDI_QP_SYMBOL(name) RBDI_PASTE(name, RBD_REAL)
#define rbd_qp_solve RBDI_QP_SYMBOL(rbd_qp_solve)
#define rbd_qp_text RBDI_QP_SYMBOL(rbd_qp_text)

/* ---- problem [problem] ---- */

#define RBD_QP_NONE 1e30 /* a bound of this size and more is none */

/* The result of rbd_qp_solve: 0, or a negative reason. x is finite with each of them, but as it was after
   RBD_QP_NULL, _RANGE and _MEMORY. */
typedef enum rbd_qp_status {
    RBD_QP_OK = 0,
    RBD_QP_INFEASIBLE = -1, /* hard rows contradict each other: lambda says which */
    RBD_QP_UNBOUNDED = -2,  /* unbounded below: f falls along a way that H does not bend and no row ends */
    RBD_QP_ITERATIONS = -3, /* more steps would be needed: x is as good as it got */
    RBD_QP_INACCURATE = -4, /* solved, but primal or dual is above ten times the accuracy */
    RBD_QP_CONVEX = -5,     /* H has a negative eigenvalue */
    RBD_QP_SYMMETRIC = -6,  /* H is not symmetric */
    RBD_QP_NAN = -7,        /* an input is not a number or not finite, or the result is too large */
    RBD_QP_RANGE = -8,      /* a number of the problem, a weight or an option is out of range */
    RBD_QP_MEMORY = -9,     /* the memory is too small */
    RBD_QP_NULL = -10,      /* a required pointer is NULL */
    RBD_QP_SIDES = -11      /* a lower side is above the upper one */
} rbd_qp_status;

/* Minimise x'Hx/2 + f'x, where each row r has lower <= row x <= upper. The first rows are bounds of x[0],
   x[1], ...; the others are rows of C. */
typedef struct rbd_qp_problem {
    int n;                 /* variables */
    int bounds;            /* of x[0] to x[bounds - 1], 0 to n */
    int rows;              /* of C */
    const rbd_real *H;     /* n x n, symmetric, positive definite or semidefinite */
    const rbd_real *f;     /* n */
    const rbd_real *C;     /* rows x n; may be NULL without rows */
    const rbd_real *lower; /* bounds + rows, -RBD_QP_NONE: none; equal to upper: an equality */
    const rbd_real *upper; /* bounds + rows, RBD_QP_NONE: none */
    const rbd_real
        *soft; /* bounds + rows, weights w > 0: a row that is missed by e costs w e^2 / 2; 0: a hard
                              row. NULL: all are hard */
} rbd_qp_problem;

/* 0 is the default in brackets. */
typedef struct rbd_qp_options {
    int steps;         /* rows that join or leave by steps, at most [10 (n + bounds + rows)] */
    int warm;          /* not 0: side is a guess, such as the result for a similar problem */
    int rounds;        /* of the proximal method, if H is semidefinite, at most [50] */
    rbd_real accuracy; /* of rows and optimum, a share of their terms [1e-10, float 1e-5] */
} rbd_qp_options;

typedef struct rbd_qp_result {
    int steps;       /* rows that joined or left */
    int rounds;      /* of the proximal method: 0 if H is definite */
    int active;      /* rows that hold, equalities too */
    rbd_real primal; /* the largest miss of a row, or distance of one that pushes from its side, as a share of
                        its terms: the side, and its entries times the largest x */
    rbd_real dual; /* the largest component of Hx + f + C'lambda, as a share of the largest term of the cost:
                        of Hx + f, or lambda of a soft row times the row; rounding of larger
                        multipliers counts as well */
    int at;        /* after an error the row, counted with the bounds, or the variable; -1: none */
    const char *field; /* after an error: of rbd_qp_problem or rbd_qp_options; NULL: none */
} rbd_qp_result;

/* ---- solve [solve] ---- */

/* Bytes of memory for n variables and this many bounds, rows of C and soft rows; a constant. */
#define RBD_QP_SIZE(n, bounds, rows, soft) \
    (sizeof(rbd_real) * \
         (((size_t)(n) + (size_t)(soft)) * (size_t)(n) + (size_t)(n) * ((size_t)(n) + 1) / 2 + \
          ((size_t)(n) + (size_t)(soft)) * ((size_t)(n) + (size_t)(soft) + 1) / 2 + 10 * (size_t)(n) + \
          5 * ((size_t)(n) + (size_t)(soft)) + 2 * ((size_t)(bounds) + (size_t)(rows))) + \
     sizeof(int) * (5 * (size_t)(n) + (size_t)(soft) + 3 * ((size_t)(bounds) + (size_t)(rows))) + \
     2 * sizeof(rbd_real))

/* Solves the problem by the dual active-set method of Goldfarb and Idnani (1983).
   options   NULL: all defaults
   memory    size bytes of any alignment, scratch: RBD_QP_SIZE
   x         n: the solution. With `warm` and a semidefinite H also where to begin
   lambda    bounds + rows: multipliers, Hx + f + C'lambda = 0 (a bound is a row of the identity): above 0
             where the upper side holds, below 0 at the lower one. After RBD_QP_INFEASIBLE a proof, after
             Farkas: lambda' rows = 0, but the sum of lambda times the side that it names is below 0; the
             rows with lambda != 0 contradict each other
   side      bounds + rows: -1 where the lower side holds, 1 the upper one, 0 neither; with `warm` the guess.
             Any guess will do
   result    may be NULL
   Errors: rbd_qp_status; result->at and ->field say where. */
RBDI_API rbd_qp_status rbd_qp_solve(const rbd_qp_problem *problem, const rbd_qp_options *options,
                                    void *memory, size_t size, rbd_real *x, rbd_real *lambda,
                                    signed char *side, rbd_qp_result *result);

/* Writes what a status and result say as a sentence, e.g. "row 3, field 'lower': above upper", cut to fit,
   always terminated. text: size bytes. Returns text. */
RBDI_API char *rbd_qp_text(rbd_qp_status status, const rbd_qp_result *result, char *text, size_t size);

/* ==== src/rbd_qp.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_QP_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

#if defined RBD_IMPLEMENTATION && !defined RBDI_QP_IMPLEMENTED
#define RBDI_QP_IMPLEMENTED

/* ==== src/base/types.h ==== */
#ifndef RBDI_BASE_TYPES_H
#define RBDI_BASE_TYPES_H
/* ---- layout [layout] ----
   The built model and the work, laid open for sizes at compile time and for generated tables only. */

/* Arithmetic of the build: double at least, whatever the model's scalar. Firmware, which does not build, sets
   constraints up in its own scalar. */
#if RBDI_KIND(RBD_CONST) == 3 || (defined RBD_NO_BUILD && !RBDI_REPRODUCIBLE)
#define RBDI_WIDE RBD_CONST
#else
#define RBDI_WIDE double
#endif
RBDI_EXTENSION typedef RBDI_WIDE rbdi_wide;

#define RBDI_CHUNK 16 /* padding of rows: at least a batch */

/* Doubles in the widest SIMD register for which any file of a program may be compiled, 0 without. Memory is
   sized for it: the file with the implementation may have other options than the file that gives memory. */
#if RBDI_GPU
#define RBDI_WIDEST_SIMD 0
#elif defined __x86_64__ || defined __i386__ || defined __aarch64__ || defined _M_X64 || defined __wasm__
#define RBDI_WIDEST_SIMD 8
#else
#define RBDI_WIDEST_SIMD 0
#endif
#define RBDI_ALIGN ((size_t)(sizeof(rbd_real) > 64 ? sizeof(rbd_real) : 64))
#define RBDI_ROUND(bytes) (((size_t)(bytes) + RBDI_ALIGN - 1) / RBDI_ALIGN * RBDI_ALIGN)
#endif

/* ==== src/base/compiler.h ==== */
#ifndef RBDI_BASE_COMPILER_H
#define RBDI_BASE_COMPILER_H
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

/* ==== src/rbd_qp.h ==== */
RBDI_CODE_BEGIN

/* ==== src/base/tolerances.h ==== */
#ifndef RBDI_BASE_TOLERANCES_H
#define RBDI_BASE_TOLERANCES_H
/* ---- tolerances [tolerances] ----
   RBDI_EPS is one rounding of the scalar, RBDI_TINY the least pivot whose inverse is finite;
   RBDI_LEAST_SCALE is so large that every pivot up to RBDI_TINY is in doubt.

   A pivot below RBDI_DOUBT times dof.scale, the largest inertia that its joint can move, is in doubt. Such a
   pivot must exceed RBDI_NOISE times e, a bound of the terms whose difference it is, or it is singular: 32
   roundings, because a pivot is a sum of many terms. The largest pivot that was rounding in 20,000 singular
   models had 15 of rbd_aba and 4.3 of the factor (tests/one_word.c). [pivots] derives the rest.

   An exact pivot can be rounding too: an axis that should go through a mass m misses it by L eps, L the
   distance to the frame that it is described in, and the pivot is m (L eps)^2. dof.scale has RBDI_ROD m L^2
   in it. With RBDI_ROD = 16 eps / RBDI_DOUBT a pivot up to 16 eps m L^2 is in doubt, and one up to
   RBDI_NOISE RBDI_SHARE RBDI_ROD m L^2 is singular: 2.5e-26 m L^2, far above the 5e-32 m L^2 of a rounding,
   and far below any real robot, whose radius of gyration would be 2e-13 L. In float 1e-21 m L^2, for
   descriptions are double. The factor has a quarter in place of RBDI_SHARE.

   RBDI_SHARE: of dof.scale in rbd_aba's e. A chain of n rods has a dof.scale of n^3/3 rods: with a much
   larger share float chains of 200 rods are refused, with a much smaller one the rounding of a description
   passes.
   RBDI_TURN: a change of frame rounds by this share of RBDI_NOISE, a third of eps. It compounds along a
   chain: a larger one refuses float chains of 200 rods.
   RBDI_FAR: a joint that has slid by more than 4 times the size of what it moves is a doubt, see
   rbdi_slid_far. Ten times more lets rounding of 160 eps dof.scale pass, far below RBDI_DOUBT dof.scale; ten
   times less costs time alone.

   Tests see RBDI_DOUBT by the verdicts of RBDI_ROD. A larger one costs time alone otherwise. */

#if RBDI_KIND(RBD_CONST) == 1
#define RBDI_EPS 2.220446049250313e-16
#define RBDI_DOUBT 1e-7
#define RBDI_SHARE 1e-4
#define RBDI_TINY 2.2250738585072014e-308
#elif RBDI_KIND(RBD_CONST) == 2
#define RBDI_EPS 1.1920929e-7f
#define RBDI_DOUBT 1e-3f
#define RBDI_SHARE 1e-4f
#define RBDI_TINY 1.17549435e-38f
#else
#define RBDI_EPS RBD_C(1.925929944387236e-34)
#define RBDI_DOUBT RBD_C(1.4e-17)
#define RBDI_SHARE RBD_C(0.25) /* descriptions are double, their rounding is far above eps */
#define RBDI_TINY RBD_C(2.2250738585072014e-308)
#endif
#define RBDI_LEAST_SCALE (RBDI_TINY / RBDI_DOUBT)
#ifndef RBDI_NOISE                 /* tests/fuzz/pivots.c sets it to 0 */
#define RBDI_NOISE (32 * RBDI_EPS) /* of its bound a pivot must exceed this */
#endif
#ifndef RBDI_TURN /* tests/test_bounds.c sets it to 0 */
#define RBDI_TURN RBD_C(0.01)
#endif
#define RBDI_FAR RBD_C(16) /* a square */
#define RBDI_BUILD \
    RBD_C(2.220446049250313e-16 / (double)RBDI_EPS) /* the build's rounding: descriptions are double */
#define RBDI_ROD (16 * (rbdi_wide)2.220446049250313e-16 / (rbdi_wide)RBDI_DOUBT) /* see rbdi_build_scale */

#define RBDI_FASTEST RBD_C(1e12)   /* m/s or rad/s: a step that makes more has overflowed, or would */
#define RBDI_UNBOUNDED RBD_C(1e30) /* as a bound or limit: none; as a residual: none could be computed */
#define RBDI_SHORT RBD_C(1e-30)    /* square of the shortest quaternion or (cos, sin) that has a direction */
#define RBDI_NO_ANGLE RBD_C(1e-30) /* added to squares of angles: quotients stay finite, no digit changes */
#define RBDI_TAIL_TERMS 15         /* of the series of sine and cosine for |x| < 1: 1/33! is below 1e-36 */
#define RBDI_ANGLE_START 0.43 /* t (2 - 0.43 t^2) for 2 atan(t), |t| < 1: within 0.02, cubed four times */
#define RBDI_SNAP \
    ((rbdi_wide)1e-12) /* rad: angles this close to a multiple of 90 degrees are taken as that */
#define RBDI_PARALLEL \
    ((rbdi_wide)1e-6)          /* sine of the angle below which axes of a universal joint are parallel */
#define RBDI_ORTHONORMAL 4e-6  /* of products of the rows of a rotation: six decimals in a file will do */
#define RBDI_SEMIDEFINITE 1e-9 /* share of an inertia by which a principal moment may seem negative */
#endif

/* ==== src/base/scalar.h ==== */
#ifndef RBDI_BASE_SCALAR_H
#define RBDI_BASE_SCALAR_H
/* ---- scalar [scalar] ---- */

#if RBDI_REAL_KIND == 3 || RBDI_KIND(RBD_CONST) == 3
#ifdef __cplusplus
extern "C" {
#endif
RBDI_EXTENSION __float128 sinq(__float128 x);
RBDI_EXTENSION __float128 cosq(__float128 x);
RBDI_EXTENSION __float128 sqrtq(__float128 x);
#ifdef __cplusplus
}
#endif
#endif
#include <math.h>

#if RBDI_REAL_KIND == 2
#define RBDI_LIBM(name) name##f
#elif RBDI_REAL_KIND == 3
#define RBDI_LIBM(name) name##q
#else
#define RBDI_LIBM(name) name
#endif
#ifdef RBD_SIN
#define RBDI_OWN_SINCOS
#if RBDI_REPRODUCIBLE
#error "rbd: RBD_REPRODUCIBLE needs rbd's own sine: leave RBD_SIN and RBD_COS undefined"
#endif
#else
#define RBD_SIN(x) RBDI_LIBM(sin)(x)
#define RBD_COS(x) RBDI_LIBM(cos)(x)
#endif

/* MinGW's square root computes in 80 bits and rounds twice, the processor's own once. */
#if defined __MINGW32__ && defined __SSE2__ && RBDI_REAL_KIND != 0
#include <emmintrin.h>
RBDI_INLINE double rbdi_root(double x) { return _mm_cvtsd_f64(_mm_sqrt_sd(_mm_set_sd(x), _mm_set_sd(x))); }
RBDI_INLINE float rbdi_rootf(float x) { return _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))); }
#else
#define rbdi_root sqrt
#define rbdi_rootf sqrtf
#endif
#define rbdi_rootq sqrtq
#ifndef RBD_SQRT
#define RBD_SQRT(x) RBDI_LIBM(rbdi_root)(x)
#endif

/* pi to quad precision, as a sum of doubles: a longer literal would be rounded to double. */
#define RBDI_PI(type) \
    ((type)3.141592653589793116 + (type)1.2246467991473532e-16 + (type) - 2.9947698097183397e-33)

/* A scalar is one number or, with RBD_LANES, a vector with a number for each state. A mask is the result of a
   comparison; with lanes it holds in some and not in others. */
#ifdef RBD_LANES
#if RBDI_REAL_KIND == 2
typedef int32_t rbdi_int;
#else
typedef int64_t rbdi_int;
#endif
typedef rbdi_int rbdi_mask __attribute__((vector_size(sizeof(rbd_real)))); /* per lane 0 or -1 */

RBDI_INLINE rbd_real rbdi_set(rbd_const c) {
    rbd_real zero = {0};
    return zero + c;
}

RBDI_INLINE rbdi_mask rbdi_less(rbd_real a, rbd_real b) { return (rbdi_mask)(a < b); }
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask a) { return ~a; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) {
    return (rbd_real)(((rbdi_mask)a & mask) | ((rbdi_mask)b & ~mask));
}

RBDI_INLINE int rbdi_any(rbdi_mask mask) {
    rbdi_int any = 0;
    for (int i = 0; i < RBD_LANES; ++i) any |= mask[i];
    return any != 0;
}

RBDI_INLINE rbd_real rbdi_sqrt(rbd_real x) {
    for (int i = 0; i < RBD_LANES; ++i) x[i] = RBD_SQRT(x[i]);
    return x;
}
#else
#ifdef RBD_MASK
typedef RBD_MASK rbdi_mask;
#else
typedef int rbdi_mask;
#endif
RBDI_INLINE rbd_real rbdi_set(rbd_const c) { return (rbd_real)(c); }
RBDI_INLINE rbdi_mask rbdi_less(rbd_real a, rbd_real b) { return a < b; }
RBDI_INLINE rbdi_mask rbdi_not(rbdi_mask a) { return !a; }
RBDI_INLINE rbdi_mask rbdi_or(rbdi_mask a, rbdi_mask b) { return a | b; }
RBDI_INLINE rbdi_mask rbdi_and(rbdi_mask a, rbdi_mask b) { return a & b; }
#ifdef RBD_MASK
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) { return select(mask, a, b); }
#else
RBDI_INLINE rbd_real rbdi_select(rbdi_mask mask, rbd_real a, rbd_real b) { return mask ? a : b; }
#endif
RBDI_INLINE int rbdi_any(rbdi_mask mask) { return mask; }
RBDI_INLINE rbd_real rbdi_sqrt(rbd_real x) { return RBD_SQRT(x); }
#endif
RBDI_INLINE rbd_real rbdi_zero(void) { return rbdi_set(RBD_C(0)); }
RBDI_INLINE rbd_real rbdi_abs(rbd_real x) { return rbdi_select(rbdi_less(x, rbdi_zero()), -x, x); }

/* The larger and the smaller of two. If one is NaN these are a and b. */
RBDI_INLINE rbd_real rbdi_larger(rbd_real a, rbd_real b) { return rbdi_select(rbdi_less(a, b), b, a); }
RBDI_INLINE rbd_real rbdi_smaller(rbd_real a, rbd_real b) { return rbdi_select(rbdi_less(a, b), a, b); }

/* Whether x is a finite number, in all lanes. Of infinity and of NaN x - x is NaN. */
RBDI_INLINE int rbdi_is_finite(rbd_real x) {
    return !rbdi_any(rbdi_not(rbdi_less(x - x, rbdi_set(RBD_C(1)))));
}

/* 1 / D if D > threshold, else 0, and bad is set: no division gives infinity. */
RBDI_INLINE rbd_real rbdi_reciprocal(rbd_real D, rbd_const threshold, rbdi_mask *bad) {
    rbdi_mask good = rbdi_less(rbdi_set(threshold), D);
    *bad = rbdi_or(*bad, rbdi_not(good));
    return rbdi_select(good, rbdi_set(RBD_C(1)) / rbdi_select(good, D, rbdi_set(RBD_C(1))), rbdi_zero());
}

/* 1 / D of a pivot, 0 where that would overflow. The pivot is in doubt if it is small beside scale, the
   inertia that it came from: see [tolerances]. */
RBDI_INLINE rbd_real rbdi_pivot_inverse(rbd_real D, rbd_const scale, rbdi_mask *doubt) {
    rbdi_mask tiny = rbdi_less(D, D); /* not asked: such a pivot is in doubt as well */
    *doubt = rbdi_or(*doubt, rbdi_not(rbdi_less(rbdi_set(scale * RBDI_DOUBT), D)));
    return rbdi_reciprocal(D, RBDI_TINY, &tiny);
}
#endif

/* ==== src/base/pieces.h ==== */
#ifndef RBDI_BASE_PIECES_H
#define RBDI_BASE_PIECES_H
/* ---- pieces [pieces] ----
   Pieces of a caller's memory, and of a sentence. */

/* Takes count objects of size bytes from the front of the memory. */
RBDI_PART void *rbdi_take(unsigned char **memory, int count, size_t size) {
    unsigned char *taken = *memory;
    *memory += (size_t)count * size;
    return taken;
}

/* Takes n objects from the memory at `at`, a variable of the caller. */
#define RBDI_CUT(type, n) ((type *)rbdi_take(&at, 1, RBDI_ROUND((size_t)(n) * sizeof(type))))

/* Writes n, which is not negative, into the end of `digits`; returns where it begins. */
RBDI_PART const char *rbdi_decimal(int n, char digits[12]) {
    int at = 11;

    digits[at] = 0;
    do {
        digits[--at] = (char)('0' + n % 10);
        n = n / 10;
    } while (n);
    return &digits[at];
}

/* Writes n pieces one behind the other, cut to fit in size bytes, always terminated. Returns text. */
RBDI_PART char *rbdi_join(const char *const *piece, int n, char *text, size_t size) {
    size_t at = 0;

    for (int k = 0; k < n; ++k)
        for (const char *c = piece[k]; *c && at + 1 < size; ++c) text[at++] = *c;
    text[at] = 0;
    return text;
}
#endif

/* ==== src/qp/layout.h ==== */
/* Interface: rbdi_qp, rbdi_qp_shape */

/* ---- method [method] ----
   Minimise x'Hx/2 + f'x with n_i'x >= b_i, where the normal n_i of a row points into what is allowed: the
   row itself at its lower side, its negative at its upper one.

   H + rho 1 = L L', where rho is 0 or that of the proximal method. Equalities are eliminated first: their
   normals, L^-1 n, are reflected one by one onto the first axes. With Q the product of these reflections,

       J = L^-T Q [0; 1],   so that J'(H + rho 1) J = 1

   spans the space in which all equalities hold. The dual method of Goldfarb and Idnani (1983) works on J and
   on the normals N of the active rows, with R from J'N = [R; 0], as Powell (1985) gives it: x is always the
   optimum for the active rows alone, and each step takes in a row that x misses. Then with d = J'n, split
   behind the q active rows in d1 and d2, J = [J1 J2]:

       z = J2 d2        the way of x
       r = R^-1 d1      how fast the multipliers u of the active rows fall on that way

   A row joins by one reflection of d2 onto its first axis, which turns J2 too; it leaves by plane rotations.

   A soft row n'x + e >= b has a slack e, with the cost w e^2/2. It brings a column of its own to J, 0 in x
   and 1/sqrt(w) in e. Nothing of e is stored: e = u/w. */

/* Tolerances. None depends on the units of x or of a row, as long as their squares are normal numbers.
   RBDI_QP_DEPENDENT: sine of the angle, in the metric of H^-1, between a row and the active ones, below
   which it depends on them. RBDI_QP_ACCURACY: share of a row's terms that may be rounding. RBDI_QP_KEEP:
   share of the largest x so far that counts in those terms, until a refinement. RBDI_QP_PIVOT: share of a
   diagonal entry of H that its pivot must have. RBDI_QP_PROXIMAL: rho as a share of the largest diagonal
   entry of H, or without H of the least curvature of a soft row. RBDI_QP_WAY: how far a round goes without H,
   at least. RBDI_QP_ENOUGH: share of the accuracy at which its rounds end. RBDI_QP_FALL: share of its terms
   by which f must fall on a way without end, for rounding of the squares in H leaves less in doubt.
   RBDI_QP_CANCELLED: share of the largest x so far below which a solution of 0 is nothing but rounding. */
#if RBDI_REAL_KIND == 2
#define RBDI_QP_DEPENDENT 3e-5f
#define RBDI_QP_ACCURACY 1e-5f
#define RBDI_QP_KEEP 3e-2f
#define RBDI_QP_PIVOT 1e-5f
#define RBDI_QP_PROXIMAL 1e-3f
#define RBDI_QP_WAY 100
#define RBDI_QP_ENOUGH 1.0f
#define RBDI_QP_FALL 1e-1f
#define RBDI_QP_CANCELLED (64 * RBDI_EPS)
#else
#define RBDI_QP_DEPENDENT 1e-10
#define RBDI_QP_ACCURACY 1e-10
#define RBDI_QP_KEEP 1e-3
#define RBDI_QP_PIVOT 1e-12
#define RBDI_QP_PROXIMAL 1e-6
#define RBDI_QP_WAY 1000
#define RBDI_QP_ENOUGH 0.1
#define RBDI_QP_FALL 1e-8
#define RBDI_QP_CANCELLED (1000 * RBDI_EPS)
#endif
#define RBDI_QP_NONE ((rbd_real)RBD_QP_NONE)

/* Where the caller made H and C symmetric or zero. rbdi_qp_solve does not look there. */
typedef struct rbdi_qp_shape {
    int symmetric;   /* whether H is symmetric because of how it was made */
    int coupled;     /* H is diagonal from this variable on: only its diagonal is read there */
    int heads;       /* rows of C before this one are 0 from variable `coupled` on */
    int tails, rest; /* rows of C from `tails` to before `rest` are 0 before it */
} rbdi_qp_shape;

/* The state of one solution. A row is counted with the bounds. Matrices have no padding. */
typedef struct rbdi_qp {
    rbd_qp_problem given;
    rbd_qp_options options; /* all set */
    rbd_qp_result result;
    rbd_real *lambda;  /* of each row */
    signed char *side; /* of each row: -1, 0 or 1; 1 for an equality that is eliminated */
    rbdi_qp_shape shape;
    int n, all, soft;  /* variables, rows with bounds, soft rows */
    int watches;       /* rows that x may miss: not 0, with a side */
    int zeros;         /* rows of zeros */
    int equalities;    /* eliminated: the first reflections */
    int reflections;   /* equalities and active rows; of no use once there is J */
    int columns;       /* of J: n - equalities, and the slacks of active soft rows */
    int q;             /* active rows that are not eliminated */
    rbd_real rho;      /* added to H's diagonal */
    rbd_real own;      /* length of the last row that wanted to join, in the metric of H^-1 */
    rbd_real furthest; /* largest |x_k| so far */
    rbd_real accuracy; /* of rows: that of the options, and tenfold each time after `loosen` steps */
    rbd_real balance; /* the largest component of Hx + f + C'lambda, as a share of the largest of all terms */
    int doubtful;     /* rows contradict each other by what may be rounding, or sums overflow */
    int loosen;       /* the number of steps at which accuracy grows next */

    rbd_real *L; /* packed rows, its diagonal inverted */
    rbd_real *V; /* reflections x n: their vectors from the diagonal on; R of the equalities above */
    rbd_real *J; /* columns x n, each column a row here; NULL with no active row and no soft one */
    rbd_real *R; /* packed columns, its diagonal inverted */

    rbd_real *d, *r;   /* n + soft: see [method] */
    rbd_real *u;       /* q: multipliers, not negative but for equalities */
    rbd_real *length;  /* q: of active rows, in the metric of H^-1 */
    rbd_real *leaving; /* n + soft: column of R that leaves */
    rbd_real *x0;      /* n: optimum on the equalities alone */
    rbd_real *z;       /* n: way of x; scratch */
    rbd_real *reach;   /* n: largest |x| since the last refinement, which says how much has cancelled */
    rbd_real *centre;  /* n: of the proximal round */
    rbd_real *g;       /* n: f - rho centre */
    rbd_real *t;       /* n: scratch */
    rbd_real *beta;    /* reflections: 2/|v|^2 */
    rbd_real
        *cross; /* reflections: product of the vectors of reflection e, which is even, and the next one */
    rbd_real *diagonal; /* reflections: of their R, inverted */
    rbd_real *u_equal;  /* equalities: multipliers */
    rbd_real *unit;     /* of each row: 1 over its length */
    rbd_real *value;    /* of each row: the row times x; of a row that x cannot miss 0 */

    int *active;    /* q: rows */
    int *from, *to; /* of each row: where it is not 0 */
    int *watched;   /* watches: rows that x may miss */
    int *equality;  /* equalities: rows */
    int *first;     /* of each row of L: where it begins */
    int coupled;    /* rows of L: behind them it has nothing but its diagonal */
    int *last;      /* of each row of H: behind its last entry that is not 0, a multiple of four or n */
    int *end;       /* of each reflection: behind its last component */
} rbdi_qp;

RBDI_PART rbd_real *rbdi_qp_scalars(unsigned char **at, int count) {
    return (rbd_real *)rbdi_take(at, count, sizeof(rbd_real));
}
RBDI_PART int *rbdi_qp_ints(unsigned char **at, int count) {
    return (int *)rbdi_take(at, count, sizeof(int));
}

/* Gives each array its place in the memory. V and J lie in one: what is eliminated is no column of J. */
RBDI_PART void rbdi_qp_place(rbdi_qp *s, void *memory) {
    const int n = s->n, most = n + s->soft;
    const uintptr_t misaligned = (uintptr_t)memory % sizeof(rbd_real);
    unsigned char *at = (unsigned char *)memory + (misaligned ? sizeof(rbd_real) - misaligned : 0);

    s->V = rbdi_qp_scalars(&at, most * n);
    s->L = rbdi_qp_scalars(&at, n * (n + 1) / 2);
    s->R = rbdi_qp_scalars(&at, most * (most + 1) / 2);

    /* these four together have room for a group of vectors */
    s->d = rbdi_qp_scalars(&at, most);
    s->r = rbdi_qp_scalars(&at, most);
    s->leaving = rbdi_qp_scalars(&at, most);
    s->z = rbdi_qp_scalars(&at, n);

    s->u = rbdi_qp_scalars(&at, most);
    s->length = rbdi_qp_scalars(&at, most);
    s->x0 = rbdi_qp_scalars(&at, n);
    s->reach = rbdi_qp_scalars(&at, n);
    s->centre = rbdi_qp_scalars(&at, n);
    s->g = rbdi_qp_scalars(&at, n);
    s->t = rbdi_qp_scalars(&at, n);
    s->beta = rbdi_qp_scalars(&at, n);
    s->cross = rbdi_qp_scalars(&at, n);
    s->diagonal = rbdi_qp_scalars(&at, n);
    s->u_equal = rbdi_qp_scalars(&at, n);
    s->unit = rbdi_qp_scalars(&at, s->all);
    s->value = rbdi_qp_scalars(&at, s->all);

    s->active = rbdi_qp_ints(&at, most);
    s->from = rbdi_qp_ints(&at, s->all);
    s->watched = rbdi_qp_ints(&at, s->all);
    s->to = rbdi_qp_ints(&at, s->all);
    s->equality = rbdi_qp_ints(&at, n);
    s->first = rbdi_qp_ints(&at, n);
    s->last = rbdi_qp_ints(&at, n);
    s->end = rbdi_qp_ints(&at, n);
}

/* |x|, and 0 of -0. Compilers have one instruction for it. */
RBDI_INLINE rbd_real rbdi_qp_abs(rbd_real x) {
#if RBDI_GNU && RBDI_REAL_KIND == 2
    return __builtin_fabsf(x);
#elif RBDI_GNU
    return __builtin_fabs(x);
#else
    return x > 0 ? x : 0 - x;
#endif
}
RBDI_INLINE rbd_real rbdi_qp_larger(rbd_real a, rbd_real b) { return a > b ? a : b; }

/* The weight of a row, 0 if it is hard. */
RBDI_ONCE rbd_real rbdi_qp_weight(const rbdi_qp *s, int row) {
    return s->given.soft ? s->given.soft[row] : 0;
}
RBDI_ONCE int rbdi_qp_is_equality(const rbdi_qp *s, int row) {
    return s->given.lower[row] == s->given.upper[row];
}
/* The sign of the normal: 1 at the lower side, -1 at the upper one. */
RBDI_INLINE rbd_real rbdi_qp_sign(int side) { return side > 0 ? -1 : 1; }

/* The side at which an active row holds. */
RBDI_ONCE rbd_real rbdi_qp_side(const rbdi_qp *s, int row) {
    return s->side[row] > 0 ? s->given.upper[row] : s->given.lower[row];
}
/* Row of C, from where it is not 0; not for a bound. */
RBDI_INLINE const rbd_real *rbdi_qp_c(const rbdi_qp *s, int row) {
    return s->given.C + (row - s->given.bounds) * s->n + s->from[row];
}
/* Where the diagonal of L stands, inverted: the next one is i + 2 behind it. */
RBDI_INLINE int rbdi_qp_pivot(int i) { return i * (i + 3) / 2; }
RBDI_ONCE rbd_real *rbdi_qp_column(const rbdi_qp *s, int k) { return s->R + k * (k + 1) / 2; }
RBDI_INLINE rbd_real *rbdi_qp_j(const rbdi_qp *s, int k) { return s->J + k * s->n; }

/* ==== src/qp/vectors.h ==== */
/* Interface: rbdi_qp_dot, rbdi_qp_largest */

/* ---- vectors [vectors] ----
   Loops over rows of n scalars, four at a time. A dot product has four sums and one for the rest, which are
   added in one order everywhere, so that RBD_REPRODUCIBLE holds with every SIMD unit.

   A pack: as many scalars as a SIMD register has, two or four. A group: like components of RBDI_QP_GROUP
   vectors side by side, in a pack; without a SIMD unit two of them, as the parts of a complex number, for
   which compilers take two registers. Groups are added, and multiplied by real numbers alone, so that no part
   reaches the other; and a loop over components has no sum across lanes. So each vector comes out as if it
   were alone. vectors_of.h and reflections_of.h have each loop once: for vectors, and, by other names, for
   groups. */

#if RBDI_GNU && RBDI_SIMD > 0
#if RBDI_REAL_KIND == 2 || RBDI_SIMD == 4
#define RBDI_QP_PACK 4
#else
#define RBDI_QP_PACK 2
#endif
#define RBDI_QP_GROUP RBDI_QP_PACK
typedef rbd_real rbdi_pack
    __attribute__((vector_size(RBDI_QP_PACK * sizeof(rbd_real)), aligned(sizeof(rbd_real)), may_alias));
typedef __typeof__(*(rbdi_pack *)0 < *(rbdi_pack *)0) rbdi_pack_bits; /* integers as wide */
typedef rbdi_pack rbdi_qp_group;
#elif RBDI_GNU && RBDI_FOR_SPEED && !RBDI_GPU
#define RBDI_QP_PACK 1
#define RBDI_QP_GROUP 2
#if RBDI_REAL_KIND == 2
__extension__ typedef float _Complex rbdi_qp_group __attribute__((may_alias));
#else
__extension__ typedef double _Complex rbdi_qp_group __attribute__((may_alias));
#endif
#else
#define RBDI_QP_PACK 1
#define RBDI_QP_GROUP 1
typedef rbd_real rbdi_qp_group;
#endif

#if RBDI_QP_GROUP > 1
#define RBDI_T rbdi_qp_group
#define rbdi_qp_dot rbdi_qp_group_dot
#define rbdi_qp_dots rbdi_qp_group_dots
#define rbdi_qp_add rbdi_qp_group_add
#define rbdi_qp_adds rbdi_qp_group_adds
/* The sum of a_i t_i. */
RBDI_ONCE RBDI_T rbdi_qp_dot(const rbd_real *a, const RBDI_T *t, int n) {
    const RBDI_T zero = {0};
    RBDI_T s0, s1, s2, s3, rest;
    int i = 0;

    s0 = s1 = s2 = s3 = rest = zero;
    for (; i + 4 <= n; i += 4) {
        s0 = s0 + a[i] * t[i];
        s1 = s1 + a[i + 1] * t[i + 1];
        s2 = s2 + a[i + 2] * t[i + 2];
        s3 = s3 + a[i + 3] * t[i + 3];
    }
    for (; i < n; ++i) rest = rest + a[i] * t[i];
    return ((s0 + s2) + (s1 + s3)) + rest;
}

/* The sums of a_i t_i and of b_i t_i: where size counts by two calls, with the same order. */
RBDI_ONCE void rbdi_qp_dots(const rbd_real *a, const rbd_real *b, const RBDI_T *t, int n, RBDI_T *with_a,
                            RBDI_T *with_b) {
    const RBDI_T zero = {0};
    RBDI_T a0, a1, a2, a3, rest_a, b0, b1, b2, b3, rest_b;
    int i = 0;

    if (!RBDI_FOR_SPEED) {
        *with_a = rbdi_qp_dot(a, t, n);
        *with_b = rbdi_qp_dot(b, t, n);
        return;
    }

    a0 = a1 = a2 = a3 = rest_a = zero;
    b0 = b1 = b2 = b3 = rest_b = zero;
    for (; i + 4 <= n; i += 4) {
        const RBDI_T t0 = t[i], t1 = t[i + 1], t2 = t[i + 2], t3 = t[i + 3];
        a0 = a0 + a[i] * t0;
        b0 = b0 + b[i] * t0;
        a1 = a1 + a[i + 1] * t1;
        b1 = b1 + b[i + 1] * t1;
        a2 = a2 + a[i + 2] * t2;
        b2 = b2 + b[i + 2] * t2;
        a3 = a3 + a[i + 3] * t3;
        b3 = b3 + b[i + 3] * t3;
    }
    for (; i < n; ++i) {
        rest_a = rest_a + a[i] * t[i];
        rest_b = rest_b + b[i] * t[i];
    }
    *with_a = ((a0 + a2) + (a1 + a3)) + rest_a;
    *with_b = ((b0 + b2) + (b1 + b3)) + rest_b;
}

/* t += k a + l b. */
RBDI_ONCE void rbdi_qp_adds(RBDI_T k, const rbd_real *a, RBDI_T l, const rbd_real *b, RBDI_T *t, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        t[i] = t[i] + k * a[i] + l * b[i];
        t[i + 1] = t[i + 1] + k * a[i + 1] + l * b[i + 1];
        t[i + 2] = t[i + 2] + k * a[i + 2] + l * b[i + 2];
        t[i + 3] = t[i + 3] + k * a[i + 3] + l * b[i + 3];
    }
    for (; i < n; ++i) t[i] = t[i] + k * a[i] + l * b[i];
}

/* t += k a. */
RBDI_ONCE void rbdi_qp_add(RBDI_T k, const rbd_real *a, RBDI_T *t, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        t[i] = t[i] + k * a[i];
        t[i + 1] = t[i + 1] + k * a[i + 1];
        t[i + 2] = t[i + 2] + k * a[i + 2];
        t[i + 3] = t[i + 3] + k * a[i + 3];
    }
    for (; i < n; ++i) t[i] = t[i] + k * a[i];
}
#undef RBDI_T
#undef rbdi_qp_dot
#undef rbdi_qp_dots
#undef rbdi_qp_add
#undef rbdi_qp_adds
#endif

#if RBDI_QP_PACK > 1
RBDI_INLINE rbdi_pack rbdi_qp_load(const rbd_real *a) { return *(const rbdi_pack *)a; }

/* The sum of four sums: s0 and s2 first, s1 and s3. Packs of two: a has s0 and s1, b the others. */
RBDI_INLINE rbd_real rbdi_qp_total(rbdi_pack a, rbdi_pack b) {
#if RBDI_QP_PACK == 4
    (void)b;
    return (a[0] + a[2]) + (a[1] + a[3]);
#else
    a = a + b;
    return a[0] + a[1];
#endif
}

/* sum of a_i b_i */
RBDI_INLINE rbd_real rbdi_qp_dot(const rbd_real *a, const rbd_real *b, int n) {
    rbdi_pack sum = {0}, more = {0};
    rbd_real rest = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        sum = sum + rbdi_qp_load(a + i) * rbdi_qp_load(b + i);
        if (RBDI_QP_PACK == 2) more = more + rbdi_qp_load(a + i + 2) * rbdi_qp_load(b + i + 2);
    }
    for (; i < n; ++i) rest = rest + a[i] * b[i];
    return rbdi_qp_total(sum, more) + rest;
}

/* sum of a_i b_i; *terms: sum of |a_i b_i| */
RBDI_INLINE rbd_real rbdi_qp_dot_and_terms(const rbd_real *a, const rbd_real *b, int n, rbd_real *terms) {
    const rbdi_pack zero = {0};
    const rbdi_pack_bits size = ~(rbdi_pack_bits)-zero; /* all but the sign */
    rbdi_pack sum = zero, more = zero, sum_size = zero, more_size = zero;
    rbd_real rest = 0, rest_size = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        const rbdi_pack product = rbdi_qp_load(a + i) * rbdi_qp_load(b + i);
        sum = sum + product;
        sum_size = sum_size + (rbdi_pack)((rbdi_pack_bits)product & size);
        if (RBDI_QP_PACK == 2) {
            const rbdi_pack next = rbdi_qp_load(a + i + 2) * rbdi_qp_load(b + i + 2);
            more = more + next;
            more_size = more_size + (rbdi_pack)((rbdi_pack_bits)next & size);
        }
    }
    for (; i < n; ++i) {
        rest = rest + a[i] * b[i];
        rest_size = rest_size + rbdi_qp_abs(a[i] * b[i]);
    }
    *terms = rbdi_qp_total(sum_size, more_size) + rest_size;
    return rbdi_qp_total(sum, more) + rest;
}

/* b += k a */
RBDI_INLINE void rbdi_qp_add(rbd_real k, const rbd_real *a, rbd_real *b, int n) {
    const rbdi_pack zero = {0}, all = k - zero;
    int i = 0;

    for (; i + RBDI_QP_PACK <= n; i += RBDI_QP_PACK)
        *(rbdi_pack *)(b + i) = rbdi_qp_load(b + i) + all * rbdi_qp_load(a + i);
    for (; i < n; ++i) b[i] = b[i] + k * a[i];
}

RBDI_INLINE void rbdi_qp_dots(const rbd_real *a, const rbd_real *b, const rbd_real *t, int n,
                              rbd_real *with_a, rbd_real *with_b) {
    *with_a = rbdi_qp_dot(a, t, n);
    *with_b = rbdi_qp_dot(b, t, n);
}
RBDI_INLINE void rbdi_qp_adds(rbd_real k, const rbd_real *a, rbd_real l, const rbd_real *b, rbd_real *t,
                              int n) {
    const rbdi_pack zero = {0}, all_k = k - zero, all_l = l - zero;
    int i = 0;

    for (; i + RBDI_QP_PACK <= n; i += RBDI_QP_PACK)
        *(rbdi_pack *)(t + i) =
            rbdi_qp_load(t + i) + all_k * rbdi_qp_load(a + i) + all_l * rbdi_qp_load(b + i);
    for (; i < n; ++i) t[i] = t[i] + k * a[i] + l * b[i];
}

/* (a, b) becomes (cosine a + sine b, cosine b - sine a). */
RBDI_INLINE void rbdi_qp_rotate(rbd_real *a, rbd_real *b, int n, rbd_real cosine, rbd_real sine) {
    const rbdi_pack zero = {0}, c = cosine - zero, s = sine - zero, minus = -sine - zero;
    const rbd_real less = -sine;
    int i = 0;

    for (; i + RBDI_QP_PACK <= n; i += RBDI_QP_PACK) {
        const rbdi_pack x = rbdi_qp_load(a + i), y = rbdi_qp_load(b + i);
        *(rbdi_pack *)(a + i) = c * x + s * y;
        *(rbdi_pack *)(b + i) = c * y + minus * x;
    }
    for (; i < n; ++i) {
        const rbd_real x = a[i], y = b[i];
        a[i] = cosine * x + sine * y;
        b[i] = cosine * y + less * x; /* GCC 12 fuses a sum and a difference even without contraction */
    }
}
#else
#define RBDI_T rbd_real
/* The sum of a_i t_i. */
RBDI_ONCE RBDI_T rbdi_qp_dot(const rbd_real *a, const RBDI_T *t, int n) {
    const RBDI_T zero = {0};
    RBDI_T s0, s1, s2, s3, rest;
    int i = 0;

    s0 = s1 = s2 = s3 = rest = zero;
    for (; i + 4 <= n; i += 4) {
        s0 = s0 + a[i] * t[i];
        s1 = s1 + a[i + 1] * t[i + 1];
        s2 = s2 + a[i + 2] * t[i + 2];
        s3 = s3 + a[i + 3] * t[i + 3];
    }
    for (; i < n; ++i) rest = rest + a[i] * t[i];
    return ((s0 + s2) + (s1 + s3)) + rest;
}

/* The sums of a_i t_i and of b_i t_i: where size counts by two calls, with the same order. */
RBDI_ONCE void rbdi_qp_dots(const rbd_real *a, const rbd_real *b, const RBDI_T *t, int n, RBDI_T *with_a,
                            RBDI_T *with_b) {
    const RBDI_T zero = {0};
    RBDI_T a0, a1, a2, a3, rest_a, b0, b1, b2, b3, rest_b;
    int i = 0;

    if (!RBDI_FOR_SPEED) {
        *with_a = rbdi_qp_dot(a, t, n);
        *with_b = rbdi_qp_dot(b, t, n);
        return;
    }

    a0 = a1 = a2 = a3 = rest_a = zero;
    b0 = b1 = b2 = b3 = rest_b = zero;
    for (; i + 4 <= n; i += 4) {
        const RBDI_T t0 = t[i], t1 = t[i + 1], t2 = t[i + 2], t3 = t[i + 3];
        a0 = a0 + a[i] * t0;
        b0 = b0 + b[i] * t0;
        a1 = a1 + a[i + 1] * t1;
        b1 = b1 + b[i + 1] * t1;
        a2 = a2 + a[i + 2] * t2;
        b2 = b2 + b[i + 2] * t2;
        a3 = a3 + a[i + 3] * t3;
        b3 = b3 + b[i + 3] * t3;
    }
    for (; i < n; ++i) {
        rest_a = rest_a + a[i] * t[i];
        rest_b = rest_b + b[i] * t[i];
    }
    *with_a = ((a0 + a2) + (a1 + a3)) + rest_a;
    *with_b = ((b0 + b2) + (b1 + b3)) + rest_b;
}

/* t += k a + l b. */
RBDI_ONCE void rbdi_qp_adds(RBDI_T k, const rbd_real *a, RBDI_T l, const rbd_real *b, RBDI_T *t, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        t[i] = t[i] + k * a[i] + l * b[i];
        t[i + 1] = t[i + 1] + k * a[i + 1] + l * b[i + 1];
        t[i + 2] = t[i + 2] + k * a[i + 2] + l * b[i + 2];
        t[i + 3] = t[i + 3] + k * a[i + 3] + l * b[i + 3];
    }
    for (; i < n; ++i) t[i] = t[i] + k * a[i] + l * b[i];
}

/* t += k a. */
RBDI_ONCE void rbdi_qp_add(RBDI_T k, const rbd_real *a, RBDI_T *t, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        t[i] = t[i] + k * a[i];
        t[i + 1] = t[i + 1] + k * a[i + 1];
        t[i + 2] = t[i + 2] + k * a[i + 2];
        t[i + 3] = t[i + 3] + k * a[i + 3];
    }
    for (; i < n; ++i) t[i] = t[i] + k * a[i];
}
#undef RBDI_T

RBDI_PART rbd_real rbdi_qp_dot_and_terms(const rbd_real *a, const rbd_real *b, int n, rbd_real *terms) {
    rbd_real s0 = 0, s1 = 0, s2 = 0, s3 = 0, rest = 0, t0 = 0, t1 = 0, t2 = 0, t3 = 0, rest_size = 0;
    int i = 0;

    for (; i + 4 <= n; i += 4) {
        const rbd_real p0 = a[i] * b[i], p1 = a[i + 1] * b[i + 1];
        const rbd_real p2 = a[i + 2] * b[i + 2], p3 = a[i + 3] * b[i + 3];
        s0 = s0 + p0;
        s1 = s1 + p1;
        s2 = s2 + p2;
        s3 = s3 + p3;
        t0 = t0 + rbdi_qp_abs(p0);
        t1 = t1 + rbdi_qp_abs(p1);
        t2 = t2 + rbdi_qp_abs(p2);
        t3 = t3 + rbdi_qp_abs(p3);
    }
    for (; i < n; ++i) {
        rest = rest + a[i] * b[i];
        rest_size = rest_size + rbdi_qp_abs(a[i] * b[i]);
    }
    *terms = ((t0 + t2) + (t1 + t3)) + rest_size;
    return ((s0 + s2) + (s1 + s3)) + rest;
}

RBDI_ONCE void rbdi_qp_rotate(rbd_real *a, rbd_real *b, int n, rbd_real cosine, rbd_real sine) {
    const rbd_real less = -sine;

    for (int i = 0; i < n; ++i) {
        const rbd_real x = a[i];
        const rbd_real y = b[i];
        a[i] = cosine * x + sine * y;
        b[i] = cosine * y + less * x;
    }
}
#endif

/* The largest |a_i|. */
RBDI_PART rbd_real rbdi_qp_largest(const rbd_real *a, int n) {
    rbd_real largest = 0;
    for (int i = 0; i < n; ++i) largest = rbdi_qp_larger(largest, rbdi_qp_abs(a[i]));
    return largest;
}
/* a_i becomes the largest of a_i, |x_i| and least. */
RBDI_PART void rbdi_qp_raise(rbd_real *a, const rbd_real *x, rbd_real least, int n) {
    for (int i = 0; i < n; ++i) a[i] = rbdi_qp_larger(rbdi_qp_larger(a[i], rbdi_qp_abs(x[i])), least);
}

RBDI_ONCE void rbdi_qp_clear(rbd_real *a, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        a[i] = 0;
        a[i + 1] = 0;
        a[i + 2] = 0;
        a[i + 3] = 0;
    }
    for (; i < n; ++i) a[i] = 0;
}
RBDI_ONCE void rbdi_qp_copy(const rbd_real *from, rbd_real *to, int n) {
    for (int i = 0; i < n; ++i) to[i] = from[i];
}

/* A row times x. */
RBDI_ONCE rbd_real rbdi_qp_row_times(const rbdi_qp *s, int row, const rbd_real *x) {
    if (row < s->given.bounds) return x[row];
    return rbdi_qp_dot(rbdi_qp_c(s, row), x + s->from[row], s->to[row] - s->from[row]);
}
/* y += k row' */
RBDI_ONCE void rbdi_qp_add_row(const rbdi_qp *s, int row, rbd_real k, rbd_real *y) {
    if (row < s->given.bounds)
        y[row] = y[row] + k;
    else
        rbdi_qp_add(k, rbdi_qp_c(s, row), y + s->from[row], s->to[row] - s->from[row]);
}

/* ==== src/qp/factor.h ==== */
/* ---- factor and equalities [factor] ----
   L is kept in the envelope of H, each row from its first entry that is not 0 on: a diagonal H, or one of
   blocks, costs next to nothing. Rows and right sides begin at a multiple of four, so that dot products have
   the same four sums whatever other vectors share a group. */

/* Scratch for a group of vectors, while d, r, leaving and z have no use. */
#define RBDI_QP_GROUP_OF(s) ((rbdi_qp_group *)(s)->d)

/* How many rows of L have more than their diagonal; and where the rows of H end: row k with the last row of L
   that reaches to k, for H is symmetric. */
RBDI_PART void rbdi_qp_find_ends(rbdi_qp *s) {
    int k = s->n;

    s->coupled = s->n;
    while (s->coupled > 0 && s->first[s->coupled - 1] == s->coupled - 1) s->coupled--;
    for (int i = s->n - 1; i >= 0; --i) {
        const int end = (i + 4) / 4 * 4;
        while (k > s->first[i]) s->last[--k] = end < s->n ? end : s->n;
    }
}

/* Component i of H x, and of |H| |x|: with the sums of all of the row, for its ends are multiples of four. */
RBDI_PART rbd_real rbdi_qp_h_times(const rbdi_qp *s, int i, const rbd_real *x, rbd_real *terms) {
    const int from = s->first[i] / 4 * 4;
    const rbd_real *h = s->given.H + i * s->n;

    if (i < s->coupled) return rbdi_qp_dot_and_terms(h + from, x + from, s->last[i] - from, terms);
    *terms = rbdi_qp_abs(h[i] * x[i]);
    return h[i] * x[i];
}

/* L L' = H + rho 1. Returns the first variable whose pivot is too small, or n. */
RBDI_PART int rbdi_qp_factor(rbdi_qp *s) {
    const int n = s->n;

    for (int i = 0; i < n; ++i) {
        const rbd_real *h = s->given.H + i * n;
        const rbd_real diagonal = h[i] + s->rho;
        rbd_real *l = s->L + i * (i + 1) / 2;
        rbd_real pivot;
        int start = i < s->shape.coupled ? 0 : i;

        while (start < i && h[start] == 0) start++;
        if (start < i) start = start / 4 * 4;
        s->first[i] = start;

        /* L_ij = (H_ij - sum_k L_ik L_jk) / L_jj */
        for (int j = start; j < i; ++j) {
            const int k = s->first[j] > start ? s->first[j] : start;
            const rbd_real *lj = s->L + j * (j + 1) / 2;
            l[j] = (h[j] - rbdi_qp_dot(l + k, lj + k, j - k)) * lj[j];
        }

        pivot = diagonal - rbdi_qp_dot(l + start, l + start, i - start);
        if (!(pivot > RBDI_QP_PIVOT * diagonal)) return i; /* nor if diagonal <= 0: pivot <= diagonal */
        l[i] = 1 / rbdi_sqrt(pivot);
    }
    rbdi_qp_find_ends(s);
    return n;
}

/* Solutions by L and reflections, of one vector; and the same of a group. */
#define RBDI_T rbd_real
/* t := L^-1 t, where t is 0 before `from`, a multiple of four, and from `to` on. */
RBDI_PART void rbdi_qp_solve_lower(const rbdi_qp *s, RBDI_T *t, int from, int to) {
    int i = from;
    int at;

    for (; i < s->coupled; ++i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i] > from ? s->first[i] : from;
        if (k < i) t[i] = t[i] - rbdi_qp_dot(l + k, t + k, i - k);
        t[i] = t[i] * l[i];
    }
    at = rbdi_qp_pivot(i);
    for (; i < to; ++i) {
        t[i] = t[i] * s->L[at];
        at = at + i + 2;
    }
}

/* t := L'^-1 t, where t is 0 from `to` on. */
RBDI_PART void rbdi_qp_solve_upper(const rbdi_qp *s, RBDI_T *t, int to) {
    int i = to - 1;
    int at = rbdi_qp_pivot(i);

    for (; i >= s->coupled; --i) {
        t[i] = s->L[at] * t[i];
        at = at - i - 1;
    }
    for (; i >= 0; --i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i];
        t[i] = l[i] * t[i];
        if (k < i) rbdi_qp_add(-t[i], l + k, t + k, i - k);
    }
}

/* t := (1 - beta v v') t, of reflection e. */
RBDI_PART void rbdi_qp_reflect(const rbdi_qp *s, int e, RBDI_T *t) {
    const rbd_real *v = s->V + e * s->n + e;
    const int length = s->end[e] - e;

    rbdi_qp_add(-s->beta[e] * rbdi_qp_dot(v, t + e, length), v, t + e, length);
}

/* Reflections e and e + 1, of vectors v and w, in one pass; backwards: first e + 1, then e. With c = v'w

       a = beta_v v't,  b = beta_w (w't - c a)      or  b = beta_w w't,  a = beta_v (v't - c b)
       t -= a v + b w */
RBDI_PART void rbdi_qp_reflect_two(const rbdi_qp *s, int e, int backwards, RBDI_T *t) {
    const rbd_real *v = s->V + e * s->n, *w = v + s->n;
    const int end = s->end[e] > s->end[e + 1] ? s->end[e] : s->end[e + 1], from = e + 1;
    RBDI_T a, b;

    rbdi_qp_dots(v + from, w + from, t + from, end - from, &a, &b);
    a = a + v[e] * t[e];
    if (backwards) {
        b = s->beta[e + 1] * b;
        a = s->beta[e] * (a - s->cross[e] * b);
    } else {
        a = s->beta[e] * a;
        b = s->beta[e + 1] * (b - s->cross[e] * a);
    }

    t[e] = t[e] - a * v[e];
    rbdi_qp_adds(-a, v + from, -b, w + from, t + from, end - from);
}

/* t := Q t, of the first k reflections */
RBDI_PART void rbdi_qp_reflect_back(const rbdi_qp *s, int k, RBDI_T *t) {
    if (k % 2) rbdi_qp_reflect(s, k - 1, t);
    for (int e = k / 2 * 2 - 2; e >= 0; e -= 2) rbdi_qp_reflect_two(s, e, 1, t);
}
#undef RBDI_T

#if RBDI_QP_GROUP > 1
#define RBDI_T rbdi_qp_group
#define rbdi_qp_dot rbdi_qp_group_dot
#define rbdi_qp_dots rbdi_qp_group_dots
#define rbdi_qp_add rbdi_qp_group_add
#define rbdi_qp_adds rbdi_qp_group_adds
#define rbdi_qp_solve_lower rbdi_qp_group_solve_lower
#define rbdi_qp_solve_upper rbdi_qp_group_solve_upper
#define rbdi_qp_reflect rbdi_qp_group_reflect
#define rbdi_qp_reflect_two rbdi_qp_group_reflect_two
#define rbdi_qp_reflect_back rbdi_qp_group_reflect_back
/* t := L^-1 t, where t is 0 before `from`, a multiple of four, and from `to` on. */
RBDI_PART void rbdi_qp_solve_lower(const rbdi_qp *s, RBDI_T *t, int from, int to) {
    int i = from;
    int at;

    for (; i < s->coupled; ++i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i] > from ? s->first[i] : from;
        if (k < i) t[i] = t[i] - rbdi_qp_dot(l + k, t + k, i - k);
        t[i] = t[i] * l[i];
    }
    at = rbdi_qp_pivot(i);
    for (; i < to; ++i) {
        t[i] = t[i] * s->L[at];
        at = at + i + 2;
    }
}

/* t := L'^-1 t, where t is 0 from `to` on. */
RBDI_PART void rbdi_qp_solve_upper(const rbdi_qp *s, RBDI_T *t, int to) {
    int i = to - 1;
    int at = rbdi_qp_pivot(i);

    for (; i >= s->coupled; --i) {
        t[i] = s->L[at] * t[i];
        at = at - i - 1;
    }
    for (; i >= 0; --i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i];
        t[i] = l[i] * t[i];
        if (k < i) rbdi_qp_add(-t[i], l + k, t + k, i - k);
    }
}

/* t := (1 - beta v v') t, of reflection e. */
RBDI_PART void rbdi_qp_reflect(const rbdi_qp *s, int e, RBDI_T *t) {
    const rbd_real *v = s->V + e * s->n + e;
    const int length = s->end[e] - e;

    rbdi_qp_add(-s->beta[e] * rbdi_qp_dot(v, t + e, length), v, t + e, length);
}

/* Reflections e and e + 1, of vectors v and w, in one pass; backwards: first e + 1, then e. With c = v'w

       a = beta_v v't,  b = beta_w (w't - c a)      or  b = beta_w w't,  a = beta_v (v't - c b)
       t -= a v + b w */
RBDI_PART void rbdi_qp_reflect_two(const rbdi_qp *s, int e, int backwards, RBDI_T *t) {
    const rbd_real *v = s->V + e * s->n, *w = v + s->n;
    const int end = s->end[e] > s->end[e + 1] ? s->end[e] : s->end[e + 1], from = e + 1;
    RBDI_T a, b;

    rbdi_qp_dots(v + from, w + from, t + from, end - from, &a, &b);
    a = a + v[e] * t[e];
    if (backwards) {
        b = s->beta[e + 1] * b;
        a = s->beta[e] * (a - s->cross[e] * b);
    } else {
        a = s->beta[e] * a;
        b = s->beta[e + 1] * (b - s->cross[e] * a);
    }

    t[e] = t[e] - a * v[e];
    rbdi_qp_adds(-a, v + from, -b, w + from, t + from, end - from);
}

/* t := Q t, of the first k reflections */
RBDI_PART void rbdi_qp_reflect_back(const rbdi_qp *s, int k, RBDI_T *t) {
    if (k % 2) rbdi_qp_reflect(s, k - 1, t);
    for (int e = k / 2 * 2 - 2; e >= 0; e -= 2) rbdi_qp_reflect_two(s, e, 1, t);
}
#undef RBDI_T
#undef rbdi_qp_dot
#undef rbdi_qp_dots
#undef rbdi_qp_add
#undef rbdi_qp_adds
#undef rbdi_qp_solve_lower
#undef rbdi_qp_solve_upper
#undef rbdi_qp_reflect
#undef rbdi_qp_reflect_two
#undef rbdi_qp_reflect_back
#else
#define rbdi_qp_group_solve_lower rbdi_qp_solve_lower
#define rbdi_qp_group_reflect_two rbdi_qp_reflect_two
#define rbdi_qp_group_reflect_back rbdi_qp_reflect_back
#define rbdi_qp_group_solve_upper rbdi_qp_solve_upper
#endif

/* t := L^-1 row' */
RBDI_PART void rbdi_qp_spread(const rbdi_qp *s, int row, rbd_real *t) {
    rbdi_qp_clear(t, s->n);
    if (row < s->given.bounds)
        t[row] = 1;
    else
        rbdi_qp_copy(rbdi_qp_c(s, row), t + s->from[row], s->to[row] - s->from[row]);
    rbdi_qp_solve_lower(s, t, s->from[row] / 4 * 4, s->to[row]);
}

/* t := Q'L^-1 t, of the first k reflections, two at a time */
RBDI_PART void rbdi_qp_forth(const rbdi_qp *s, int k, rbd_real *t) {
    rbdi_qp_solve_lower(s, t, 0, s->n);
    for (int e = 0; e + 1 < k; e += 2) rbdi_qp_reflect_two(s, e, 0, t);
    if (k % 2) rbdi_qp_reflect(s, k - 1, t);
}

/* t := L'^-1 Q t, of the first k reflections */
RBDI_PART void rbdi_qp_back(const rbdi_qp *s, int k, rbd_real *t) {
    rbdi_qp_reflect_back(s, k, t);
    rbdi_qp_solve_upper(s, t, s->n);
}

/* Reflection e = s->reflections of a row, whose L^-1 row', behind the earlier reflections, is v. Returns 0 if
   the row depends on the earlier ones: that is set aside, and whether it agrees with them is seen later, like
   any row. Sparse rows first make the vectors short. */
RBDI_PART int rbdi_qp_make_reflection(rbdi_qp *s, int row, rbd_real *v) {
    const int n = s->n, e = s->reflections;
    rbd_real gone, rest, length, onto;
    int end = n;

    while (end > e + 1 && v[end - 1] == 0) end--;
    gone = rbdi_qp_dot(v, v, e);
    rest = rbdi_qp_dot(v + e, v + e, end - e);
    if (rest <= RBDI_QP_DEPENDENT * RBDI_QP_DEPENDENT * (gone + rest)) return 0;

    /* v - (-+|v|) on axis e: no difference of like numbers. */
    length = rbdi_sqrt(rest);
    onto = v[e] > 0 ? -length : length;
    s->beta[e] = 1 / (length * (length + rbdi_qp_abs(v[e])));
    s->diagonal[e] = 1 / onto;
    v[e] = v[e] - onto;

    s->end[e] = end;
    if (e % 2) s->cross[e - 1] = rbdi_qp_dot(v + e - n, v + e, end - e);
    s->reflections = e + 1;

    if (rbdi_qp_is_equality(s, row)) {
        s->equality[s->equalities++] = row;
        s->side[row] = 1;
    } else {
        s->active[s->q] = row;
        s->length[s->q++] = rbdi_sqrt(gone + rest);
    }
    return 1;
}

/* Reflects rows (Householder 1958), a group of them: L^-1 row' of each goes onto an axis. */
RBDI_PART void rbdi_qp_eliminate(rbdi_qp *s, const int *rows, int lanes) {
    const int n = s->n;
    rbdi_qp_group *t = RBDI_QP_GROUP_OF(s);
    int from = n, to = 0;

    rbdi_qp_clear((rbd_real *)t, n * RBDI_QP_GROUP);
    for (int lane = 0; lane < lanes; ++lane) {
        const int row = rows[lane], begin = s->from[row], end = s->to[row];
        const rbd_real one = 1, *c = row < s->given.bounds ? &one : rbdi_qp_c(s, row);
        rbd_real *own = (rbd_real *)t + begin * RBDI_QP_GROUP + lane;

        from = begin < from ? begin : from;
        to = end > to ? end : to;
        for (int k = 0; k < end - begin; ++k) own[k * RBDI_QP_GROUP] = c[k];
    }
    from = from / 4 * 4;
    rbdi_qp_group_solve_lower(s, t, from, to);
    for (int e = 0; e + 1 < s->reflections; e += 2)
        if (s->end[e] > from || s->end[e + 1] > from) rbdi_qp_group_reflect_two(s, e, 0, t);

    for (int lane = 0; lane < lanes; ++lane) {
        const int e = s->reflections;
        rbd_real *v = s->V + e * n;
        int made = 0;

        if (e < n) {
            for (int k = 0; k < n; ++k) v[k] = ((const rbd_real *)t)[k * RBDI_QP_GROUP + lane];
            if (e % 2) rbdi_qp_reflect(s, e - 1, v);
            made = rbdi_qp_make_reflection(s, rows[lane], v);
        }
        if (!made) s->side[rows[lane]] = 0;
        if (made && e % 2 && lane + 1 < lanes) rbdi_qp_group_reflect_two(s, e - 1, 0, t);
    }
}

/* Whether a row can hold at the side of the guess. */
RBDI_PART int rbdi_qp_can_hold(const rbdi_qp *s, int row) {
    return s->side[row] && s->from[row] < s->to[row] && rbdi_qp_abs(rbdi_qp_side(s, row)) < RBDI_QP_NONE;
}

/* Eliminates the equalities, or then the rows of the guess. Soft rows have no part in it. */
RBDI_PART void rbdi_qp_eliminate_all(rbdi_qp *s, int guess) {
    int rows[RBDI_QP_GROUP], lanes = 0;

    for (int row = 0; row < s->all; ++row) {
        if (guess && !s->side[row]) continue;
        if (rbdi_qp_is_equality(s, row) == guess || rbdi_qp_weight(s, row) > 0) continue;
        if (guess && !rbdi_qp_can_hold(s, row)) {
            s->side[row] = 0;
            continue;
        }
        rows[lanes++] = row;
        if (lanes < RBDI_QP_GROUP) continue;
        rbdi_qp_eliminate(s, rows, lanes);
        lanes = 0;
    }
    if (lanes) rbdi_qp_eliminate(s, rows, lanes);
}

/* R of the rows of the guess: their reflections' diagonals, and what stands above. */
RBDI_PART void rbdi_qp_take_guess(rbdi_qp *s) {
    const int k = s->equalities;

    for (int j = 0; j < s->q; ++j) {
        const int side = s->side[s->active[j]] > 0 ? 1 : -1;
        const rbd_real sign = rbdi_qp_sign(side), *above = s->V + (k + j) * s->n + k;
        rbd_real *column = rbdi_qp_column(s, j);

        for (int i = 0; i < j; ++i) column[i] = sign * above[i];
        column[j] = sign * s->diagonal[k + j];
        s->side[s->active[j]] = (signed char)side;
        s->u[j] = 0;
    }
}

/* J = L'^-1 Q [0; 1], if it is not there yet, the last columns first: they come to lie where the vectors of
   the guess were, which the columns before have no use for. */
RBDI_PART void rbdi_qp_basis(rbdi_qp *s) {
    const int n = s->n, k = s->equalities;
    rbdi_qp_group *t = RBDI_QP_GROUP_OF(s);
    if (s->J) return;

    s->J = s->V + k * n;
    for (int j = (s->columns - 1) / RBDI_QP_GROUP * RBDI_QP_GROUP; j >= 0; j -= RBDI_QP_GROUP) {
        const int left = s->columns - j, lanes = left < RBDI_QP_GROUP ? left : RBDI_QP_GROUP;
        const int end = k + j + lanes, count = end < s->reflections ? end : s->reflections;

        rbdi_qp_clear((rbd_real *)t, n * RBDI_QP_GROUP);
        for (int lane = 0; lane < lanes; ++lane) ((rbd_real *)t)[(k + j + lane) * RBDI_QP_GROUP + lane] = 1;
        rbdi_qp_group_reflect_back(s, count, t);
        rbdi_qp_group_solve_upper(s, t, count ? n : end);
        for (int lane = 0; lane < lanes; ++lane)
            for (int i = 0; i < n; ++i)
                rbdi_qp_j(s, j + lane)[i] = ((const rbd_real *)t)[i * RBDI_QP_GROUP + lane];
    }
}

/* d = J'y; y is lost. Without J it goes by the factors. */
RBDI_PART void rbdi_qp_project(const rbdi_qp *s, rbd_real *y, rbd_real *d) {
    if (s->J) {
        for (int j = 0; j < s->columns; ++j) d[j] = rbdi_qp_dot(rbdi_qp_j(s, j), y, s->n);
        return;
    }
    rbdi_qp_forth(s, s->reflections, y);
    rbdi_qp_copy(y + s->equalities, d, s->columns);
}

/* y += J d of the columns from `from` to before `to`, two at a time; without J by the factors, with t as
   scratch. */
RBDI_PART void rbdi_qp_add_columns(const rbdi_qp *s, int from, int to, const rbd_real *d, rbd_real *y) {
    int j = from;

    if (!s->J) {
        rbdi_qp_clear(s->t, s->n);
        rbdi_qp_copy(d + from, s->t + s->equalities + from, to - from);
        rbdi_qp_back(s, s->reflections, s->t);
        rbdi_qp_add(1, s->t, y, s->n);
        return;
    }
    for (; j + 2 <= to; j += 2) rbdi_qp_adds(d[j], rbdi_qp_j(s, j), d[j + 1], rbdi_qp_j(s, j + 1), y, s->n);
    if (j < to) rbdi_qp_add(d[j], rbdi_qp_j(s, j), y, s->n);
}

/* t := L'^-1 Q (y; t2), R' y = b, for the equalities A x = b; `further`: R' y = b - A x, from the values of
   these rows. t2: t from there on. */
RBDI_PART void rbdi_qp_onto_equalities(const rbdi_qp *s, int further, rbd_real *t) {
    for (int e = 0; e < s->equalities; ++e) {
        const int row = s->equality[e];
        rbd_real b = s->given.upper[row];
        if (further) b = b - s->value[row];
        t[e] = (b - rbdi_qp_dot(s->V + e * s->n, t, e)) * s->diagonal[e];
    }
    rbdi_qp_back(s, s->equalities, t);
}

/* Multipliers u_equal of the equalities that balance y best; y += A' u_equal. t: scratch, n. */
RBDI_PART void rbdi_qp_balance(rbdi_qp *s, rbd_real *y, rbd_real *t) {
    if (!s->equalities) return;
    rbdi_qp_copy(y, t, s->n);
    rbdi_qp_forth(s, s->equalities, t);

    /* R u = -t */
    for (int e = s->equalities - 1; e >= 0; --e) {
        t[e] = t[e] * s->diagonal[e];
        s->u_equal[e] = -t[e];
        rbdi_qp_add(-t[e], s->V + e * s->n, t, e);
    }
    for (int e = 0; e < s->equalities; ++e) rbdi_qp_add_row(s, s->equality[e], s->u_equal[e], y);
}

/* ==== src/qp/active.h ==== */
/* Interface: rbdi_qp_terms */

/* ---- active rows [active rows] ---- */

/* d = J'n of a row that wants to join at this side. A soft row brings its slack as a column. Returns the
   length of the row in the metric of H^-1. */
RBDI_PART rbd_real rbdi_qp_enter(rbdi_qp *s, int row, int side) {
    const rbd_real weight = rbdi_qp_weight(s, row), sign = rbdi_qp_sign(side);

    rbdi_qp_basis(s);
    if (row < s->given.bounds) {
        for (int j = 0; j < s->columns; ++j) s->d[j] = sign * rbdi_qp_j(s, j)[row];
    } else {
        const rbd_real *c = rbdi_qp_c(s, row);
        const int from = s->from[row], length = s->to[row] - from;
        for (int j = 0; j < s->columns; ++j) s->d[j] = sign * rbdi_qp_dot(rbdi_qp_j(s, j) + from, c, length);
    }

    if (weight > 0) {
        rbdi_qp_clear(rbdi_qp_j(s, s->columns), s->n);
        s->d[s->columns] = 1 / rbdi_sqrt(weight);
        s->columns++;
    }
    if (!s->equalities) return rbdi_sqrt(rbdi_qp_dot(s->d, s->d, s->columns));
    rbdi_qp_spread(s, row, s->z);
    return rbdi_sqrt(rbdi_qp_dot(s->z, s->z, s->n));
}

/* |d2|^2 */
RBDI_INLINE rbd_real rbdi_qp_free_part(const rbdi_qp *s) {
    return rbdi_qp_dot(s->d + s->q, s->d + s->q, s->columns - s->q);
}

/* Whether a hard row, with d as it is, depends on the active ones; square: |d2|^2. A soft row never does. */
RBDI_INLINE int rbdi_qp_depends(const rbdi_qp *s, int row, rbd_real square) {
    const rbd_real least = RBDI_QP_DEPENDENT * s->own;
    return !(rbdi_qp_weight(s, row) > 0) && square <= least * least;
}

/* z = J2 d2 */
RBDI_PART void rbdi_qp_way(rbdi_qp *s) {
    rbdi_qp_clear(s->z, s->n);
    rbdi_qp_add_columns(s, s->q, s->columns, s->d, s->z);
}

/* The row joins, with d and z = J2 d2 as they are; square: |d2|^2. A reflection turns d2 onto its first
   axis, a: with y = (z - a J_q) / (|d2| (|d2| + |d_q|)),

       J_j -= d_j y for j > q,   J_q -= (d_q - a) y,   the new column of R is (d1, a). */
RBDI_PART void rbdi_qp_join(rbdi_qp *s, int row, int side, rbd_real u, rbd_real square) {
    const int n = s->n, q = s->q;
    rbd_real *column = rbdi_qp_column(s, q), *J_q = rbdi_qp_j(s, q);
    rbd_real a = s->d[q];

    if (q < s->columns - 1) {
        const rbd_real length = rbdi_sqrt(square);
        const rbd_real scale = 1 / (length * (length + rbdi_qp_abs(a)));
        const rbd_real onto = a > 0 ? -length : length;

        for (int k = 0; k < n; ++k) s->z[k] = scale * (s->z[k] - onto * J_q[k]);
        rbdi_qp_add(onto - a, s->z, J_q, n);
        for (int j = q + 1; j < s->columns; ++j) rbdi_qp_add(-s->d[j], s->z, rbdi_qp_j(s, j), n);
        a = onto;
    }

    rbdi_qp_copy(s->d, column, q);
    column[q] = 1 / a;
    s->active[q] = row;
    s->u[q] = u;
    s->length[q] = s->own;
    s->side[row] = (signed char)side;
    s->q = q + 1;
}

/* Removes the slack column of a soft row that has left: its components in the columns of J2, (leaving, 0,
   ...) - J2'n, are reflected into the last column, with J2 and d, and that is deleted. */
RBDI_PART void rbdi_qp_drop_slack(rbdi_qp *s, int row, rbd_real sign) {
    const int n = s->n, q = s->q, last = s->columns - 1;
    rbd_real *slack = s->leaving, square = 0;

    for (int j = q; j <= last; ++j) {
        const rbd_real carried = j == q ? slack[j] : 0;
        slack[j] = carried - sign * rbdi_qp_row_times(s, row, rbdi_qp_j(s, j));
        square = square + slack[j] * slack[j];
    }
    s->columns = last;
    if (q >= last || !(square > 0)) return;

    const rbd_real length = rbdi_sqrt(square);
    const rbd_real scale = 1 / (length * (length + rbdi_qp_abs(slack[last])));

    slack[last] = slack[last] + (slack[last] > 0 ? length : -length);
    const rbd_real along = rbdi_qp_dot(slack + q, s->d + q, last + 1 - q);

    rbdi_qp_clear(s->z, n);
    rbdi_qp_add_columns(s, q, last + 1, slack, s->z);
    for (int j = q; j < last; ++j) {
        rbdi_qp_add(-scale * slack[j], s->z, rbdi_qp_j(s, j), n);
        s->d[j] = s->d[j] - scale * along * slack[j];
    }
}

/* Active row l leaves. R's columns behind it move one place to the left; plane rotations of its rows k and k
   + 1 make it triangular again. They turn the columns of J and d with it. */
RBDI_PART void rbdi_qp_leave(rbdi_qp *s, int l) {
    const int n = s->n, row = s->active[l];
    const rbd_real *gone = rbdi_qp_column(s, l);
    const rbd_real sign = rbdi_qp_sign(s->side[row]);

    for (int k = 0; k < l; ++k) s->leaving[k] = gone[k];
    s->leaving[l] = 1 / gone[l];
    for (int k = l + 1; k < s->q; ++k) s->leaving[k] = 0;

    for (int k = l; k < s->q - 1; ++k) {
        const rbd_real *from = rbdi_qp_column(s, k + 1);
        rbd_real *to = rbdi_qp_column(s, k);
        const rbd_real x = from[k], y = 1 / from[k + 1];
        const rbd_real inverse = 1 / rbdi_sqrt(x * x + y * y);
        const rbd_real cosine = x * inverse, sine = y * inverse;

        rbdi_qp_copy(from, to, k);
        to[k] = inverse;
        for (int j = k + 2; j < s->q; ++j) {
            rbd_real *column = rbdi_qp_column(s, j);
            rbdi_qp_rotate(column + k, column + k + 1, 1, cosine, sine);
        }
        rbdi_qp_rotate(rbdi_qp_j(s, k), rbdi_qp_j(s, k + 1), n, cosine, sine);
        rbdi_qp_rotate(s->d + k, s->d + k + 1, 1, cosine, sine);
        rbdi_qp_rotate(s->leaving + k, s->leaving + k + 1, 1, cosine, sine);
        s->active[k] = s->active[k + 1];
        s->u[k] = s->u[k + 1];
        s->length[k] = s->length[k + 1];
    }
    s->side[row] = 0;
    s->q = s->q - 1;
    s->result.steps++;
    if (rbdi_qp_weight(s, row) > 0) rbdi_qp_drop_slack(s, row, sign);
}

/* y := R^-1 y */
RBDI_PART void rbdi_qp_solve_r(const rbdi_qp *s, rbd_real *y) {
    for (int k = s->q - 1; k >= 0; --k) {
        const rbd_real *column = rbdi_qp_column(s, k);
        y[k] = y[k] * column[k];
        rbdi_qp_add(-y[k], column, y, k);
    }
}
/* y := R'^-1 y */
RBDI_PART void rbdi_qp_solve_r_transposed(const rbdi_qp *s, rbd_real *y) {
    for (int k = 0; k < s->q; ++k) {
        const rbd_real *column = rbdi_qp_column(s, k);
        y[k] = (y[k] - rbdi_qp_dot(column, y, k)) * column[k];
    }
}

/* r = y and u of the active rows: R' y = b - N'x0, u = R^-1 y. */
RBDI_PART void rbdi_qp_push(rbdi_qp *s) {
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        const rbd_real missed = rbdi_qp_side(s, row) - rbdi_qp_row_times(s, row, s->x0);
        s->r[j] = rbdi_qp_sign(s->side[row]) * missed;
    }
    rbdi_qp_solve_r_transposed(s, s->r);
    rbdi_qp_copy(s->r, s->u, s->q);
    rbdi_qp_solve_r(s, s->u);
}

/* x and u of the active rows: x = x0 + J1 y. */
RBDI_PART void rbdi_qp_point(rbdi_qp *s, rbd_real *x) {
    rbdi_qp_push(s);
    rbdi_qp_copy(s->x0, x, s->n);
    if (s->q) rbdi_qp_add_columns(s, 0, s->q, s->r, x);
}

/* The scale of a row's miss: its side, and its terms with the largest x so far. */
RBDI_PART rbd_real rbdi_qp_terms(const rbdi_qp *s, int row, rbd_real side) {
    rbd_real terms;
    const rbd_real *c;

    if (row < s->given.bounds) return rbdi_qp_abs(side) + s->reach[row];
    c = rbdi_qp_c(s, row);
    rbdi_qp_dot_and_terms(c, s->reach + s->from[row], s->to[row] - s->from[row], &terms);
    return rbdi_qp_abs(side) + terms;
}

/* The largest |x_k|; where x is nothing but what has cancelled, a share of the largest x so far. That is so
   if x = 0 is right: all hard rows that hold have the side 0. */
RBDI_PART rbd_real rbdi_qp_size(const rbdi_qp *s, const rbd_real *x) {
    const rbd_real size = rbdi_qp_largest(x, s->n);
    int zero = size <= RBDI_QP_CANCELLED * s->furthest;

    for (int j = 0; j < s->q && zero; ++j) {
        const int row = s->active[j];
        zero = rbdi_qp_side(s, row) == 0 || rbdi_qp_weight(s, row) > 0;
    }
    for (int e = 0; e < s->equalities && zero; ++e) zero = s->given.upper[s->equality[e]] == 0;
    return zero ? RBDI_QP_CANCELLED * s->furthest : size;
}

/* How far u < 0 of active row j may be rounding, in its length: a share of the largest multiplier; of a soft
   row also such a share of its terms that e = u/w misses. */
RBDI_PART rbd_real rbdi_qp_slight(const rbdi_qp *s, int j, rbd_real share, rbd_real largest) {
    const int row = s->active[j];
    const rbd_real weight = rbdi_qp_weight(s, row), slight = share * largest;
    rbd_real of_terms;

    if (!(weight > 0)) return slight;
    of_terms = share * rbdi_qp_terms(s, row, rbdi_qp_side(s, row)) * weight * s->length[j];
    return of_terms < slight ? of_terms : slight;
}

/* Active row l leaves before there is J: the reflections of the rows behind it are made anew. */
RBDI_PART void rbdi_qp_forget(rbdi_qp *s, int l) {
    const int end = s->q;

    s->side[s->active[l]] = 0;
    s->q = l;
    s->reflections = s->equalities + l;
    for (int j = l + 1; j < end; j += RBDI_QP_GROUP)
        rbdi_qp_eliminate(s, s->active + j, end - j < RBDI_QP_GROUP ? end - j : RBDI_QP_GROUP);
    rbdi_qp_take_guess(s);
    s->result.steps++;
}

/* The active inequality that pulls most, u < 0 by more than what share may be rounding, leaves. Returns
   whether one does. */
RBDI_PART int rbdi_qp_release(rbdi_qp *s, rbd_real share) {
    rbd_real least = 0, largest = 0;
    int worst = -1;

    for (int j = 0; j < s->q; ++j) largest = rbdi_qp_larger(largest, rbdi_qp_abs(s->u[j] * s->length[j]));
    for (int j = 0; j < s->q; ++j) {
        const rbd_real u = s->u[j] * s->length[j];
        if (!(u < least) || rbdi_qp_is_equality(s, s->active[j])) continue;
        if (-u <= rbdi_qp_slight(s, j, share, largest)) continue;
        least = u;
        worst = j;
    }
    if (worst < 0) return 0;
    if (s->J)
        rbdi_qp_leave(s, worst);
    else
        rbdi_qp_forget(s, worst);
    return 1;
}

/* ==== src/qp/search.h ==== */
/* ---- search [search] ---- */

/* A row that x misses. */
typedef struct rbdi_qp_miss {
    int row, side;
    rbd_real by; /* in the row's units */
} rbdi_qp_miss;

RBDI_PART void rbdi_qp_reached(rbdi_qp *s, const rbd_real *x) {
    s->furthest = rbdi_qp_larger(s->furthest, rbdi_qp_largest(x, s->n));
    rbdi_qp_raise(s->reach, x, RBDI_QP_KEEP * s->furthest, s->n);
}

/* By how much a value misses the lower side, or the upper one; negative if it does not. */
RBDI_INLINE rbd_real rbdi_qp_below(const rbdi_qp *s, int row, rbd_real value) {
    const rbd_real lower = s->given.lower[row];
    return lower > -RBDI_QP_NONE ? lower - value : -RBDI_QP_NONE;
}
RBDI_INLINE rbd_real rbdi_qp_above(const rbdi_qp *s, int row, rbd_real value) {
    const rbd_real upper = s->given.upper[row];
    return upper < RBDI_QP_NONE ? value - upper : -RBDI_QP_NONE;
}

/* Whether x misses a row by more than rounding explains, and by how much. */
RBDI_PART int rbdi_qp_misses(const rbdi_qp *s, int row, rbd_real accuracy, rbdi_qp_miss *miss) {
    const rbd_real value = s->value[row];
    const rbd_real below = rbdi_qp_below(s, row, value), above = rbdi_qp_above(s, row, value);
    const rbd_real by = rbdi_qp_larger(below, above);
    const rbd_real side = below > above ? s->given.lower[row] : s->given.upper[row];
    if (!(by > accuracy * rbdi_qp_terms(s, row, side))) return 0;

    miss->row = row;
    miss->side = below > above ? -1 : 1;
    miss->by = by;
    return 1;
}

/* Values at x of the watched rows; without `all` of those that are not active, for those of the others come
   with the residuals. */
RBDI_PART void rbdi_qp_evaluate(rbdi_qp *s, const rbd_real *x, int all) {
    for (int i = 0; i < s->watches; ++i) {
        const int row = s->watched[i];
        if (all || !s->side[row]) s->value[row] = rbdi_qp_row_times(s, row, x);
    }
}

/* By how much x misses a row, in lengths of it; 0 of an active one. */
RBDI_INLINE rbd_real rbdi_qp_score(const rbdi_qp *s, int row) {
    const rbd_real value = s->value[row];
    if (s->side[row]) return 0;
    return s->unit[row] * rbdi_qp_larger(s->given.lower[row] - value, value - s->given.upper[row]);
}

/* The inactive row that x misses most, in lengths of the row, beyond what rounding explains: row -1 if there
   is none. */
RBDI_PART rbdi_qp_miss rbdi_qp_most_missed(const rbdi_qp *s, rbd_real accuracy) {
    rbdi_qp_miss worst = {-1, 0, 0};
    rbd_real most = 0;
    int first = -1;

    for (int i = 0; i < s->watches; ++i) {
        const rbd_real score = rbdi_qp_score(s, s->watched[i]);
        if (!(score > most)) continue;
        most = score;
        first = s->watched[i];
    }
    if (first < 0 || rbdi_qp_misses(s, first, accuracy, &worst)) return worst;

    most = 0;
    for (int i = 0; i < s->watches; ++i) {
        const int row = s->watched[i];
        const rbd_real score = rbdi_qp_score(s, row);
        if (score > most && rbdi_qp_misses(s, row, accuracy, &worst)) most = score;
    }
    return worst;
}

/* The active inequality whose multiplier falls to 0 first on the way r, or -1; *step: where. */
RBDI_PART int rbdi_qp_first_to_leave(const rbdi_qp *s, rbd_real *step) {
    int first = -1;

    *step = 0;
    for (int j = 0; j < s->q; ++j) {
        if (!(s->r[j] * s->length[j] > RBDI_QP_DEPENDENT * s->own)) continue;
        if (rbdi_qp_is_equality(s, s->active[j]) || (first >= 0 && !(s->u[j] < *step * s->r[j]))) continue;
        *step = rbdi_qp_larger(s->u[j], 0) / s->r[j];
        first = j;
    }
    return first;
}

#define RBDI_QP_ROUNDING (64 * RBDI_EPS) /* of a row's length in the metric of H^-1 */

/* Whether a soft row is among the active ones that the last row depends on: then these do not contradict. */
RBDI_PART int rbdi_qp_gives_way(const rbdi_qp *s) {
    for (int j = 0; j < s->q; ++j)
        if (rbdi_qp_weight(s, s->active[j]) > 0 &&
            rbdi_qp_abs(s->r[j]) * s->length[j] > RBDI_QP_DEPENDENT * s->own)
            return 1;
    return 0;
}

/* Takes in a row that is missed. Each turn goes as far as the multipliers of the active rows stay positive,
   at most until the row holds:

       x += step z,   u -= step r,   the row's multiplier += step,   the miss -= step |d2|^2

   and then a row leaves, or the row joins. A row that depends on the active ones, and with which none can
   leave, contradicts them. */
RBDI_PART rbd_qp_status rbdi_qp_take_in(rbdi_qp *s, rbd_real *x, rbdi_qp_miss miss) {
    rbd_real u = 0;

    s->own = rbdi_qp_enter(s, miss.row, miss.side);
    while (s->result.steps < s->options.steps) {
        const rbd_real square = rbdi_qp_free_part(s);
        int dependent = rbdi_qp_depends(s, miss.row, square);
        rbd_real step;
        int leaves;

        rbdi_qp_copy(s->d, s->r, s->q);
        rbdi_qp_solve_r(s, s->r);
        leaves = rbdi_qp_first_to_leave(s, &step);
        if (dependent && leaves < 0) {
            const rbd_real rounding = RBDI_QP_ROUNDING * s->own;
            if (square <= rounding * rounding || !rbdi_qp_gives_way(s)) return RBD_QP_INFEASIBLE;
            dependent = 0;
        }

        if (!dependent) {
            rbdi_qp_way(s);
            if (leaves < 0 || miss.by <= step * square) {
                step = miss.by / square;
                leaves = -1;
            }
            rbdi_qp_add(step, s->z, x, s->n);
            miss.by = miss.by - step * square;
        }
        rbdi_qp_add(-step, s->r, s->u, s->q);
        u = u + step;

        if (leaves < 0) {
            s->result.steps++;
            rbdi_qp_join(s, miss.row, miss.side, u, square);
            return RBD_QP_OK;
        }
        rbdi_qp_leave(s, leaves);
    }
    return RBD_QP_ITERATIONS;
}

/* ==== src/qp/refine.h ==== */
/* ---- refinement [refinement] ----
   The residuals of the optimum on the active rows,

       r1 = -(H x + rho x + g) + N u + A'u_equal,   r2 = b - N'x - u/w   (0 for a hard row's u/w)

   and their correction by the factors at hand:

       x_E = L'^-1 Q (R_E'^-1 r2_E; 0),   y1 = R'^-1 (r2 - N'x_E),   y2 = J2'r1,
       x += x_E + J (y1; y2),   u += R^-1 (y1 - J1'r1) */

#define RBDI_QP_REFINED (16 * RBDI_EPS) /* shares below this are rounding */
#define RBDI_QP_REFINEMENTS 2

/* y = H x + f. Returns the largest of the sums |f_k| + |H_k1 x_1| + ... */
RBDI_PART rbd_real rbdi_qp_gradient(const rbdi_qp *s, const rbd_real *x, rbd_real *y) {
    rbd_real largest = 0, terms;

    for (int k = 0; k < s->n; ++k) {
        const rbd_real f = s->given.f[k];
        y[k] = rbdi_qp_h_times(s, k, x, &terms) + f;
        largest = rbdi_qp_larger(largest, rbdi_qp_abs(f) + terms);
    }
    return largest;
}

/* t = r1 without the equalities' part, r = r2, and the values of these rows at x. Returns the largest |r2|,
   as a share of its row's length; raises *size to the largest term of the cost in r1, *push to that of all
   rows. */
RBDI_PART rbd_real rbdi_qp_residuals(rbdi_qp *s, const rbd_real *x, rbd_real *size, rbd_real *push) {
    rbd_real missed = 0;

    *size = rbdi_qp_larger(*size, rbdi_qp_gradient(s, x, s->t));
    for (int i = 0; i < s->n; ++i) s->t[i] = s->rho * (s->centre[i] - x[i]) - s->t[i];

    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        const rbd_real sign = rbdi_qp_sign(s->side[row]), weight = rbdi_qp_weight(s, row);

        s->value[row] = rbdi_qp_row_times(s, row, x);
        s->r[j] = sign * (rbdi_qp_side(s, row) - s->value[row]);
        if (weight > 0) s->r[j] = s->r[j] - s->u[j] / weight;
        missed = rbdi_qp_larger(missed, rbdi_qp_abs(s->r[j]) * s->unit[row]);
        const rbd_real term = rbdi_qp_abs(s->u[j]) / s->unit[row];
        if (weight > 0) *size = rbdi_qp_larger(*size, term);
        *push = rbdi_qp_larger(*push, term);
        rbdi_qp_add_row(s, row, sign * s->u[j], s->t);
    }
    for (int e = 0; e < s->equalities; ++e) {
        const int row = s->equality[e];
        s->value[row] = rbdi_qp_row_times(s, row, x);
        missed = rbdi_qp_larger(missed, rbdi_qp_abs(s->value[row] - s->given.upper[row]) * s->unit[row]);
    }
    return missed;
}

/* result.dual: the largest |t_k|, where t is what Hx + f + C'lambda leaves, as a share of `size`, the largest
   term of the cost: of Hx + f, and lambda of a soft row. Not of a hard row, whose largest is `push`: where
   rows nearly depend on each other, their lambda may be so large that its rounding, which counts, is all of
   the gradient. s->balance is the share of the larger of the two. Both are not a number if a t_k is none. */
RBDI_PART void rbdi_qp_judge(rbdi_qp *s, rbd_real size, rbd_real push) {
    const rbd_real larger = rbdi_qp_larger(size, push);
    rbd_real worst = rbdi_qp_largest(s->t, s->n), sum = 0;

    for (int k = 0; k < s->n; ++k) sum = sum + s->t[k];
    worst = worst + (sum - sum);
    s->balance = larger > 0 ? worst / larger : worst;

    worst = worst + RBDI_EPS * (larger - size);
    s->result.dual = size > 0 ? worst / size : worst;
}

/* One correction, from t = r1 and r = r2. */
RBDI_PART void rbdi_qp_correct(rbdi_qp *s, rbd_real *x) {
    const int n = s->n;

    rbdi_qp_clear(s->z, n);
    if (s->equalities) rbdi_qp_onto_equalities(s, 1, s->z);
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        s->r[j] = s->r[j] - rbdi_qp_sign(s->side[row]) * rbdi_qp_row_times(s, row, s->z);
    }

    /* d = (y1; y2), r = R^-1 (y1 - J1'r1) */
    rbdi_qp_project(s, s->t, s->d);
    rbdi_qp_solve_r_transposed(s, s->r);
    for (int j = 0; j < s->q; ++j) {
        const rbd_real y = s->r[j];
        s->r[j] = y - s->d[j];
        s->d[j] = y;
    }
    rbdi_qp_solve_r(s, s->r);

    for (int k = 0; k < n; ++k) x[k] = x[k] + s->z[k];
    rbdi_qp_add_columns(s, 0, s->columns, s->d, x);
    for (int j = 0; j < s->q; ++j) s->u[j] = s->u[j] + s->r[j];
}

/* The multipliers of the equalities; result.dual; and corrections where the residuals exceed rounding of x,
   which may be far less than it was on the way. Returns whether x has changed. */
RBDI_PART int rbdi_qp_refine(rbdi_qp *s, rbd_real *x) {
    for (int corrections = 0;; ++corrections) {
        const rbd_real furthest = rbdi_qp_size(s, x);
        rbd_real size = s->rho * furthest, push = 0;
        const rbd_real missed = rbdi_qp_residuals(s, x, &size, &push);

        rbdi_qp_balance(s, s->t, s->z);
        for (int e = 0; e < s->equalities; ++e)
            push = rbdi_qp_larger(push, rbdi_qp_abs(s->u_equal[e]) / s->unit[s->equality[e]]);
        rbdi_qp_judge(s, size, push);

        if (s->balance <= RBDI_QP_REFINED && missed <= RBDI_QP_REFINED * furthest) return corrections > 0;
        if (corrections == RBDI_QP_REFINEMENTS) return 1;
        rbdi_qp_correct(s, x);
    }
}

/* ==== src/qp/rounds.h ==== */
/* ---- rounds [rounds] ----
   If H is semidefinite, each round of the proximal method (Rockafellar 1976) has the cost rho |x - centre|^2
   / 2 beside it, and the next one is centred at its solution. J, R and the active rows stay. */

#define RBDI_QP_STILL (64 * RBDI_EPS) /* without H and f, x that moves by less of itself moves by rounding */

/* x0: optimum on the equalities alone. */
RBDI_PART void rbdi_qp_optimum_on_equalities(rbdi_qp *s) {
    for (int k = 0; k < s->n; ++k) s->x0[k] = -s->g[k];
    rbdi_qp_forth(s, s->equalities, s->x0);
    rbdi_qp_onto_equalities(s, 0, s->x0);
}

/* The soft equalities, and with `warm` the soft rows of the guess, join without a step: none depends on
   others. Rows that pull leave then, so that the dual method may begin here. */
RBDI_PART void rbdi_qp_first_soft_rows(rbdi_qp *s) {
    for (int row = 0; row < s->all && s->soft; ++row) {
        int side;
        if (!(rbdi_qp_weight(s, row) > 0)) continue;

        if (rbdi_qp_is_equality(s, row)) s->side[row] = 1;
        side = !rbdi_qp_can_hold(s, row) ? 0 : s->side[row] > 0 ? 1 : -1;
        s->side[row] = 0;
        if (!side) continue;

        s->own = rbdi_qp_enter(s, row, side);
        rbdi_qp_way(s);
        rbdi_qp_join(s, row, side, 0, rbdi_qp_free_part(s));
    }
}

#define RBDI_QP_HOPELESS \
    ((rbd_real)1e-3) /* accuracy beyond which rows that seem to contradict are left missed */

/* Writes the proof that the last row contradicts active ones: n = N r + A'u. Returns whether it holds:
   lambda' rows is 0 to the accuracy, and the sum of lambda times the sides is below what that leaves for any
   x so far. */
RBDI_PART int rbdi_qp_proven(rbdi_qp *s, rbdi_qp_miss miss) {
    rbd_real sum = 0, terms = 0, left = 0, largest = 0;

    for (int row = 0; row < s->all; ++row) s->lambda[row] = 0;
    s->lambda[miss.row] = (rbd_real)miss.side;
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        if (rbdi_qp_abs(s->r[j]) * s->length[j] > RBDI_QP_DEPENDENT * s->own)
            s->lambda[row] = s->side[row] > 0 ? -s->r[j] : s->r[j];
    }
    rbdi_qp_clear(s->t, s->n);
    for (int row = 0; row < s->all; ++row) {
        if (s->lambda[row] == 0) continue;
        rbdi_qp_add_row(s, row, -s->lambda[row], s->t);
        largest = rbdi_qp_larger(largest, rbdi_qp_abs(s->lambda[row]) / s->unit[row]);
    }
    rbdi_qp_balance(s, s->t, s->z);
    for (int e = 0; e < s->equalities; ++e) s->lambda[s->equality[e]] = -s->u_equal[e];

    for (int row = 0; row < s->all; ++row) {
        const rbd_real lambda = s->lambda[row];
        const rbd_real side = lambda > 0 ? s->given.upper[row] : s->given.lower[row];
        if (lambda == 0) continue;
        if (rbdi_qp_weight(s, row) > 0) return 0; /* it gives way */
        sum = sum + lambda * side;
        terms = terms + rbdi_qp_abs(lambda * side);
    }
    for (int k = 0; k < s->n; ++k) {
        if (!(rbdi_qp_abs(s->t[k]) <= 10 * s->options.accuracy * largest)) return 0;
        left = left + rbdi_qp_abs(s->t[k]) * s->furthest;
    }
    return sum < -(10 * s->options.accuracy * terms + left);
}

/* The solution for this centre. */
RBDI_PART rbd_qp_status rbdi_qp_round(rbdi_qp *s, rbd_real *x, rbdi_qp_miss *miss) {
    int refined = 0;

    rbdi_qp_reached(s, s->x0);
    rbdi_qp_push(s);
    while (s->result.steps < s->options.steps && rbdi_qp_release(s, 0)) rbdi_qp_push(s);
    rbdi_qp_point(s, x);
    rbdi_qp_reached(s, x);
    rbdi_qp_evaluate(s, x, 0);

    for (;;) {
        rbd_qp_status status;
        *miss = rbdi_qp_most_missed(s, s->accuracy);
        if (miss->row < 0 && refined) return RBD_QP_OK;
        if (s->result.steps >= s->options.steps) return RBD_QP_ITERATIONS;

        if (miss->row < 0) {
            int moved = rbdi_qp_refine(s, x);
            refined = 1;
            if (rbdi_qp_release(s, s->accuracy)) {
                rbdi_qp_point(s, x);
                refined = 0;
                moved = 1;
            }
            if (moved) rbdi_qp_evaluate(s, x, 0);
            /* x is exact now: what has cancelled before counts no more. */
            rbdi_qp_clear(s->reach, s->n);
            rbdi_qp_raise(s->reach, x, RBDI_QP_KEEP * rbdi_qp_size(s, x), s->n);
            continue;
        }

        if (s->result.steps >= s->loosen) {
            s->accuracy = 10 * s->accuracy;
            s->loosen = s->loosen + 2 * (s->n + s->all);
        }
        status = rbdi_qp_take_in(s, x, *miss);
        rbdi_qp_reached(s, x);
        rbdi_qp_evaluate(s, x, 0);
        refined = 0;
        if (status == RBD_QP_INFEASIBLE && !rbdi_qp_proven(s, *miss)) {
            if (s->accuracy > RBDI_QP_HOPELESS) return RBD_QP_INACCURATE;
            s->accuracy = 10 * s->accuracy;
            s->doubtful = 1;
            continue;
        }
        if (status != RBD_QP_OK) return status;
    }
}

#define RBDI_QP_BENT (8 * RBDI_EPS) /* of H times a way, for each variable: less is rounding */

/* z = x, or x - from; whether the value falls on this way, and H does not bend it, but for rounding. */
RBDI_PART int rbdi_qp_straight(rbdi_qp *s, const rbd_real *x, const rbd_real *from) {
    rbd_real down = 0, curvature = 0, length = 0, largest = 0, rounding, terms;

    for (int k = 0; k < s->n; ++k) {
        s->z[k] = from ? x[k] - from[k] : x[k];
        down = down + s->given.f[k] * s->z[k];
        length = rbdi_qp_larger(length, rbdi_qp_abs(s->z[k]));
        largest = rbdi_qp_larger(largest, s->given.H[k * s->n + k]);
    }
    for (int k = 0; k < s->n; ++k)
        curvature = rbdi_qp_larger(curvature, rbdi_qp_abs(rbdi_qp_h_times(s, k, s->z, &terms)));
    rounding = RBDI_QP_BENT * (rbd_real)s->n * largest * length;
    return down < 0 && curvature <= rounding;
}

/* Whether the value falls on the way z by more than rounding of H and f explains, where the weights of a sum
   of squares are far apart. */
RBDI_PART int rbdi_qp_falls(const rbdi_qp *s) {
    rbd_real terms;
    const rbd_real down = rbdi_qp_dot_and_terms(s->given.f, s->z, s->n, &terms);
    return -down > RBDI_QP_FALL * terms;
}

/* Whether no row ends the way z. */
RBDI_PART int rbdi_qp_endless(const rbdi_qp *s) {
    const rbd_real length = rbdi_qp_largest(s->z, s->n);

    for (int row = 0; row < s->all; ++row) {
        const rbd_real by = rbdi_qp_row_times(s, row, s->z);
        const rbd_real side = by < 0 ? s->given.lower[row] : s->given.upper[row];
        if (rbdi_qp_abs(side) < RBDI_QP_NONE && rbdi_qp_abs(by) > s->options.accuracy / s->unit[row] * length)
            return 0;
    }
    return 1;
}

/* Rounds until x stays where it is: rho |x - centre| within the accuracy of H x and f. On a straight way each
   centre lies twice as far ahead as the one before. */
RBDI_PART rbd_qp_status rbdi_qp_rounds(rbdi_qp *s, rbd_real *x, rbdi_qp_miss *miss) {
    rbd_real ahead = 1;

    for (;; s->result.rounds++) {
        rbd_real moved = 0, furthest = 0, size;
        rbd_qp_status status;

        /* The centre is all that a round has of those before it. */
        rbdi_qp_clear(s->reach, s->n);
        s->furthest = rbdi_qp_largest(s->centre, s->n);

        rbdi_qp_optimum_on_equalities(s);
        if (s->result.rounds == 0) rbdi_qp_first_soft_rows(s);
        status = rbdi_qp_round(s, x, miss);
        if (status != RBD_QP_OK || !(s->rho > 0)) return status;

        size = rbdi_qp_gradient(s, x, s->t);
        for (int k = 0; k < s->n; ++k) {
            moved = rbdi_qp_larger(moved, s->rho * rbdi_qp_abs(x[k] - s->centre[k]));
            furthest = rbdi_qp_larger(furthest, s->rho * rbdi_qp_abs(x[k]));
        }
        if (moved <= RBDI_QP_ENOUGH * s->options.accuracy * size ||
            (!(size > 0) && moved <= RBDI_QP_STILL * furthest))
            return RBD_QP_OK;
        if (s->result.rounds >= s->options.rounds) return RBD_QP_ITERATIONS;

        /* Far away x itself points along the way, also where the last round went along rows that end. */
        ahead = rbdi_qp_straight(s, x, s->centre) ? 2 * ahead : 1;
        if (ahead > 4 && (rbdi_qp_endless(s) || (rbdi_qp_straight(s, x, NULL) && rbdi_qp_endless(s))))
            return rbdi_qp_falls(s) ? RBD_QP_UNBOUNDED : RBD_QP_INACCURATE;
        for (int k = 0; k < s->n; ++k) {
            s->centre[k] = s->centre[k] + ahead * (x[k] - s->centre[k]);
            s->g[k] = s->given.f[k] - s->rho * s->centre[k];
        }
    }
}

/* ==== src/qp/solve.h ==== */
/* Interface: rbdi_qp_solve, RBDI_QP_MOST */

/* ---- solve [solve code] ---- */

#define RBDI_QP_MOST 20000 /* variables with soft rows, rows: their matrices have ints for an index */
#if RBDI_REAL_KIND == 2
#define RBDI_QP_ASYMMETRY 1e-4f
#else
#define RBDI_QP_ASYMMETRY 1e-8 /* of H, as a share of its diagonal */
#endif

RBDI_PART rbd_qp_status rbdi_qp_refuse(rbdi_qp *s, rbd_qp_status status, int at, const char *field) {
    s->result.at = at;
    s->result.field = field;
    return status;
}

RBDI_ONCE int rbdi_qp_finite(rbd_real x) { return rbdi_qp_abs(x) < RBDI_QP_NONE; }

/* Whether numbers, pointers and options make sense; completes the options. */
RBDI_PART rbd_qp_status rbdi_qp_check_problem(rbdi_qp *s) {
    const rbd_qp_problem *p = &s->given;
    rbd_qp_options *o = &s->options;

    if (p->n < 1 || p->n > RBDI_QP_MOST) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "n");
    if (p->bounds < 0 || p->bounds > p->n) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "bounds");
    if (p->rows < 0 || p->rows > RBDI_QP_MOST) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "rows");
    s->n = p->n;
    s->all = p->bounds + p->rows;

    if (!p->H) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "H");
    if (!p->f) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "f");
    if (p->rows && !p->C) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "C");
    if (s->all && !p->lower) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "lower");
    if (s->all && !p->upper) return rbdi_qp_refuse(s, RBD_QP_NULL, -1, "upper");

    if (o->steps < 0) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "steps");
    if (o->rounds < 0) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "rounds");
    if (!(o->accuracy >= 0 && o->accuracy < 1)) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "accuracy");
    if (!o->steps) o->steps = 10 * (s->n + s->all);
    if (!o->rounds) o->rounds = 50;
    if (!(o->accuracy > 0)) o->accuracy = RBDI_QP_ACCURACY;

    for (int row = 0; row < s->all && p->soft; ++row) {
        if (!(p->soft[row] >= 0 && rbdi_qp_finite(p->soft[row])))
            return rbdi_qp_refuse(s, RBD_QP_RANGE, row, "soft");
        s->soft += p->soft[row] > 0;
    }
    if (s->n + s->soft > RBDI_QP_MOST) return rbdi_qp_refuse(s, RBD_QP_RANGE, -1, "soft");
    return RBD_QP_OK;
}

/* H_ij and H_ji differ, or one is not a number. */
RBDI_PART rbd_qp_status rbdi_qp_refuse_pair(rbdi_qp *s, int i, int j) {
    const rbd_real *H = s->given.H;
    if (!rbdi_qp_finite(H[i * s->n + j])) return rbdi_qp_refuse(s, RBD_QP_NAN, i, "H");
    if (!rbdi_qp_finite(H[j * s->n + i])) return rbdi_qp_refuse(s, RBD_QP_NAN, j, "H");
    return rbdi_qp_refuse(s, RBD_QP_SYMMETRIC, i, "H");
}

/* H and f: finite, symmetric. A sum of squares is symmetric, and finite if its diagonal is. */
RBDI_PART rbd_qp_status rbdi_qp_check_value(rbdi_qp *s) {
    const rbd_real *H = s->given.H;
    const int n = s->n;

    for (int i = 0; i < n; ++i) {
        const rbd_real diagonal = H[i * n + i], own = RBDI_QP_ASYMMETRY * diagonal;
        if (!rbdi_qp_finite(s->given.f[i])) return rbdi_qp_refuse(s, RBD_QP_NAN, i, "f");
        if (!rbdi_qp_finite(diagonal)) return rbdi_qp_refuse(s, RBD_QP_NAN, i, "H");
        if (diagonal < 0) return rbdi_qp_refuse(s, RBD_QP_CONVEX, i, "H");
        s->t[i] = own;
        for (int j = 0; j < i && !s->shape.symmetric; ++j) {
            const rbd_real apart = rbdi_qp_abs(H[i * n + j] - H[j * n + i]);
            if (!(apart <= own) && !(apart <= own + s->t[j])) return rbdi_qp_refuse_pair(s, i, j);
        }
    }
    return RBD_QP_OK;
}

/* H is not definite: each two variables alone must be semidefinite. */
RBDI_PART rbd_qp_status rbdi_qp_check_pairs(rbdi_qp *s) {
    const rbd_real *H = s->given.H;
    const int n = s->n;

    for (int i = 0; i < s->shape.coupled; ++i) {
        for (int j = 0; j < i; ++j) {
            const rbd_real minor = H[i * n + i] * H[j * n + j];
            if (!(H[i * n + j] * H[i * n + j] <= minor + RBDI_QP_ASYMMETRY * minor))
                return rbdi_qp_refuse(s, RBD_QP_CONVEX, i, "H");
        }
    }
    return RBD_QP_OK;
}

/* The rows: finite, lower <= upper; where each begins and ends, its length, and whether x may miss it. */
RBDI_PART rbd_qp_status rbdi_qp_check_rows(rbdi_qp *s) {
    const rbd_qp_problem *p = &s->given;
    const int n = s->n;

    s->watches = 0;
    s->zeros = 0;
    for (int row = 0; row < s->all; ++row) {
        const rbd_real lower = p->lower[row], upper = p->upper[row];
        int from = row, to = row + 1;
        rbd_real square = 1;

        if (lower != lower || lower >= RBDI_QP_NONE) return rbdi_qp_refuse(s, RBD_QP_NAN, row, "lower");
        if (upper != upper || upper <= -RBDI_QP_NONE) return rbdi_qp_refuse(s, RBD_QP_NAN, row, "upper");
        if (row >= p->bounds) {
            const int of_c = row - p->bounds;
            const rbd_real *c = p->C + of_c * n;
            to = of_c < s->shape.heads ? s->shape.coupled : n;
            from = of_c >= s->shape.tails && of_c < s->shape.rest ? s->shape.coupled : 0;
            while (to > from && c[to - 1] == 0) --to;
            while (from < to && c[from] == 0) ++from;
            square = rbdi_qp_dot(c + from, c + from, to - from);
            if (!(square - square == 0)) return rbdi_qp_refuse(s, RBD_QP_NAN, row, "C");
        }
        s->from[row] = from;
        s->to[row] = to;
        s->value[row] = 0;
        s->zeros += from == to;
        s->unit[row] = square > 0 ? 1 / rbdi_sqrt(square) : RBDI_QP_NONE;
        if (lower > upper) return rbdi_qp_refuse(s, RBD_QP_SIDES, row, "lower");
        if (from < to && (lower > -RBDI_QP_NONE || upper < RBDI_QP_NONE)) s->watched[s->watches++] = row;
    }
    return RBD_QP_OK;
}

/* The least curvature w |row|^2 that a soft row gives the cost; 0: there is none. */
RBDI_PART rbd_real rbdi_qp_least_curvature(const rbdi_qp *s) {
    rbd_real least = 0;

    for (int row = 0; row < s->all; ++row) {
        const rbd_real curvature = rbdi_qp_weight(s, row) / (s->unit[row] * s->unit[row]);
        if (curvature > 0 && s->from[row] < s->to[row] && !(least > 0 && least <= curvature))
            least = curvature;
    }
    return least;
}

/* rho of the proximal method. Without H it has the units of soft rows or of f: the smaller of the two. */
RBDI_PART rbd_real rbdi_qp_proximal(const rbdi_qp *s) {
    rbd_real diagonal = 0, slope = 0, of_soft, of_slope;

    for (int i = 0; i < s->n; ++i) {
        diagonal = rbdi_qp_larger(diagonal, s->given.H[i * s->n + i]);
        slope = rbdi_qp_larger(slope, rbdi_qp_abs(s->given.f[i]));
    }
    if (diagonal > 0) return (rbd_real)RBDI_QP_PROXIMAL * diagonal;

    of_soft = (rbd_real)RBDI_QP_PROXIMAL * rbdi_qp_least_curvature(s);
    of_slope = slope / RBDI_QP_WAY;
    if (of_soft > 0 && of_slope > 0) return of_soft < of_slope ? of_soft : of_slope;
    return of_soft > 0 ? of_soft : of_slope > 0 ? of_slope : 1;
}

/* Factors H; if it is semidefinite, H + rho 1. */
RBDI_PART rbd_qp_status rbdi_qp_factor_any(rbdi_qp *s) {
    int at = rbdi_qp_factor(s);
    if (at == s->n) return RBD_QP_OK;
    if (rbdi_qp_check_pairs(s) != RBD_QP_OK) return RBD_QP_CONVEX;

    s->rho = rbdi_qp_proximal(s);
    at = rbdi_qp_factor(s);
    return at == s->n ? RBD_QP_OK : rbdi_qp_refuse(s, RBD_QP_CONVEX, at, "H");
}

/* Multipliers of what holds; one that is below 0 by rounding becomes 0. Returns whether none is. A proof that
   did not hold may stand there. */
RBDI_PART int rbdi_qp_multipliers(rbdi_qp *s, rbd_real *lambda) {
    int as_found = 1;

    for (int row = 0; row < s->all; ++row) lambda[row] = 0;
    for (int j = 0; j < s->q; ++j) {
        const int row = s->active[j];
        const int pulls = s->u[j] < 0 && !rbdi_qp_is_equality(s, row);
        const rbd_real u = pulls ? 0 : s->u[j];
        lambda[row] = s->side[row] > 0 ? u : -u;
        as_found = as_found && !pulls;
    }
    for (int e = 0; e < s->equalities; ++e) lambda[s->equality[e]] = -s->u_equal[e];

    /* Rows of zeros: e = u/w is what 0 misses. */
    for (int row = 0; row < s->all && s->zeros; ++row) {
        const rbd_real below = rbdi_qp_larger(s->given.lower[row], 0);
        const rbd_real above = rbdi_qp_larger(-s->given.upper[row], 0);
        if (s->from[row] < s->to[row]) continue;
        lambda[row] = rbdi_qp_weight(s, row) * (above - below);
        s->side[row] = (signed char)(lambda[row] > 0 ? 1 : lambda[row] < 0 ? -1 : 0);
    }
    return as_found;
}

/* result.primal of x and lambda, by the values of the rows: of each row the miss, or where it pushes the
   distance from the side, as a share of its terms. */
RBDI_PART void rbdi_qp_verify_rows(rbdi_qp *s, const rbd_real *x, const rbd_real *lambda) {
    const rbd_real furthest = rbdi_qp_largest(x, s->n);
    const rbd_real of_zero = rbdi_qp_size(s, x);

    s->result.primal = 0;
    for (int k = 0; k < s->n; ++k) s->reach[k] = 1;

    for (int row = 0; row < s->all; ++row) {
        const rbd_real weight = rbdi_qp_weight(s, row), miss = weight > 0 ? lambda[row] / weight : 0;
        const rbd_real value = s->value[row] - miss;
        if (lambda[row] == 0 && value >= s->given.lower[row] && value <= s->given.upper[row]) continue;
        const rbd_real below = rbdi_qp_below(s, row, value), above = rbdi_qp_above(s, row, value);
        const int at_upper = lambda[row] > 0 || (!(lambda[row] < 0) && above > below);
        const rbd_real by = rbdi_qp_abs(at_upper ? above : below);
        const rbd_real side = rbdi_qp_abs(at_upper ? s->given.upper[row] : s->given.lower[row]);
        const rbd_real size = side > 0 ? furthest : of_zero;

        /* its terms are more than this, for a sum is more than a root of squares */
        if (by <= 0 || by <= s->result.primal * (side + size / s->unit[row])) continue;
        const rbd_real share = by / (side + size * rbdi_qp_terms(s, row, 0) + rbdi_qp_abs(miss));
        if (rbdi_qp_finite(share))
            s->result.primal = rbdi_qp_larger(s->result.primal, share);
        else
            s->doubtful = 1;
    }
}

/* result.dual and s->balance of x and lambda, whatever they came from. */
RBDI_PART void rbdi_qp_verify_optimum(rbdi_qp *s, const rbd_real *x, const rbd_real *lambda) {
    rbd_real size = rbdi_qp_gradient(s, x, s->t), push = 0;
    if (!(size > 0)) size = s->rho * rbdi_qp_size(s, x); /* multipliers are rounding of this */

    for (int row = 0; row < s->all; ++row) {
        if (lambda[row] == 0 || s->from[row] == s->to[row]) continue;
        const rbd_real term = rbdi_qp_abs(lambda[row]) / s->unit[row];
        rbdi_qp_add_row(s, row, lambda[row], s->t);
        if (rbdi_qp_weight(s, row) > 0) size = rbdi_qp_larger(size, term);
        push = rbdi_qp_larger(push, term);
    }
    rbdi_qp_judge(s, size, push);
}

/* The verdict on x and lambda. `ended`: x is as rbdi_qp_refine left it, with the values of the rows; if no
   multiplier had to be set to 0 and there is no rho, so is result.dual. */
RBDI_PART void rbdi_qp_verify(rbdi_qp *s, int ended, const rbd_real *x, rbd_real *lambda) {
    rbd_real size = 0, push = 0;
    int as_refined;

    if (!ended) { /* the equalities may have no multipliers yet */
        rbdi_qp_residuals(s, x, &size, &push);
        rbdi_qp_balance(s, s->t, s->z);
        rbdi_qp_evaluate(s, x, 1);
    }
    as_refined = rbdi_qp_multipliers(s, lambda) && ended && !(s->rho > 0);
    rbdi_qp_verify_rows(s, x, lambda);
    if (!as_refined) rbdi_qp_verify_optimum(s, x, lambda);
}

/* A hard row of zeros contradicts itself, or asks for nothing. */
RBDI_PART rbd_qp_status rbdi_qp_zero_rows(rbdi_qp *s, rbdi_qp_miss *miss) {
    for (int row = 0; row < s->all && s->zeros; ++row) {
        const rbd_real lower = s->given.lower[row], upper = s->given.upper[row];
        if (s->from[row] < s->to[row] || rbdi_qp_weight(s, row) > 0 || (lower <= 0 && upper >= 0)) continue;
        miss->row = row;
        miss->side = lower > 0 ? -1 : 1;
        s->lambda[row] = (rbd_real)miss->side;
        return RBD_QP_INFEASIBLE;
    }
    return RBD_QP_OK;
}

RBDI_PART rbd_qp_status rbdi_qp_run(rbdi_qp *s, rbd_real *x, rbd_real *lambda) {
    rbdi_qp_miss miss = {-1, 0, 0};
    rbd_qp_status status = rbdi_qp_check_value(s);
    if (status == RBD_QP_OK) status = rbdi_qp_check_rows(s);
    if (status == RBD_QP_OK) status = rbdi_qp_factor_any(s);
    if (status != RBD_QP_OK) return status;

    rbdi_qp_eliminate_all(s, 0);
    if (s->options.warm) rbdi_qp_eliminate_all(s, 1);
    rbdi_qp_take_guess(s);
    s->columns = s->n - s->equalities;
    for (int k = 0; k < s->n; ++k) {
        s->centre[k] = s->options.warm && s->rho > 0 ? x[k] : 0;
        s->g[k] = s->given.f[k] - s->rho * s->centre[k];
    }

    s->accuracy = s->options.accuracy;
    s->loosen = 2 * (s->n + s->all);
    status = rbdi_qp_zero_rows(s, &miss);
    if (status == RBD_QP_OK) status = rbdi_qp_rounds(s, x, &miss);
    if (status == RBD_QP_INFEASIBLE) {
        rbdi_qp_refuse(s, RBD_QP_INFEASIBLE, miss.row, miss.side < 0 ? "lower" : "upper");
    } else {
        rbdi_qp_verify(s, status == RBD_QP_OK, x, lambda);
    }
    if (status == RBD_QP_OK &&
        (s->doubtful || !(rbdi_qp_larger(s->result.primal, s->result.dual) <= 10 * s->options.accuracy)))
        status = RBD_QP_INACCURATE;
    s->result.active = s->q + s->equalities;
    return status;
}

/* x and lambda are finite, whatever happened: what is not becomes 0, and the status says so. */
RBDI_PART rbd_qp_status rbdi_qp_bound_result(rbdi_qp *s, rbd_qp_status status, rbd_real *x,
                                             rbd_real *lambda) {
    for (int row = 0; row < s->all; ++row) {
        if (lambda[row] - lambda[row] == 0) continue;
        lambda[row] = 0;
        status = rbdi_qp_refuse(s, RBD_QP_NAN, row, "lambda");
    }
    for (int k = 0; k < s->n; ++k) {
        if (rbdi_qp_finite(x[k])) continue;
        x[k] = 0;
        status = rbdi_qp_refuse(s, RBD_QP_NAN, k, NULL);
    }
    if (!(s->result.dual - s->result.dual == 0)) s->result.dual = RBDI_QP_NONE;
    if (!(s->balance - s->balance == 0)) s->balance = RBDI_QP_NONE;
    return status;
}

/* Solves a problem. s: what it leaves there and in the memory stays for the caller to read. */
RBDI_PART rbd_qp_status rbdi_qp_solve(rbdi_qp *s, const rbd_qp_problem *problem,
                                      const rbd_qp_options *options, const rbdi_qp_shape *shape, void *memory,
                                      size_t size, rbd_real *x, rbd_real *lambda, signed char *side) {
    static const rbd_qp_options defaults = {0, 0, 0, 0};
    static const rbd_qp_result none = {0, 0, 0, 0, 0, -1, NULL};
    rbd_qp_status status;
    int warm;

    rbdi_require_ieee();
    s->result = none;
    if (!problem || !memory || !x) return RBD_QP_NULL;
    s->given = *problem;
    s->options = options ? *options : defaults;
    s->shape = *shape;
    s->side = side;
    s->lambda = lambda;
    s->soft = 0;
    s->q = 0;
    s->equalities = 0;
    s->reflections = 0;
    s->rho = 0;
    s->doubtful = 0;
    s->furthest = 0;
    s->balance = 0;
    status = rbdi_qp_check_problem(s);
    if (status == RBD_QP_OK && s->all && (!lambda || !side)) status = RBD_QP_NULL;
    if (status == RBD_QP_OK && size < RBD_QP_SIZE(s->n, problem->bounds, problem->rows, s->soft))
        status = RBD_QP_MEMORY;
    if (status != RBD_QP_OK) return status;

    warm = s->options.warm;
    for (int k = 0; k < s->n; ++k)
        if (!warm || !rbdi_qp_finite(x[k])) x[k] = 0;
    for (int row = 0; row < s->all; ++row) {
        lambda[row] = 0;
        if (!warm) side[row] = 0;
    }
    rbdi_qp_place(s, memory);
    s->J = NULL;
    status = rbdi_qp_run(s, x, lambda);
    return rbdi_qp_bound_result(s, status, x, lambda);
}

RBDI_API rbd_qp_status rbd_qp_solve(const rbd_qp_problem *problem, const rbd_qp_options *options,
                                    void *memory, size_t size, rbd_real *x, rbd_real *lambda,
                                    signed char *side, rbd_qp_result *result) {
    const rbdi_qp_shape any = {0, problem ? problem->n : 0, 0, 0, 0};
    rbdi_qp s;
    const rbd_qp_status status = rbdi_qp_solve(&s, problem, options, &any, memory, size, x, lambda, side);
    if (result) *result = s.result;
    return status;
}

/* ==== src/qp/text.h ==== */
/* ---- text [text code] ---- */

RBDI_MESSAGES RBDI_PART const char *rbdi_qp_sentence(rbd_qp_status status) {
    switch (status) {
    case RBD_QP_OK: return "no error";
    case RBD_QP_INFEASIBLE: return "contradicts the other rows whose lambda is not 0";
    case RBD_QP_UNBOUNDED: return "unbounded: f falls along a way that H does not bend and no row ends";
    case RBD_QP_ITERATIONS: return "more steps or rounds would be needed";
    case RBD_QP_INACCURATE: return "solved, but not to the accuracy that the options ask for";
    case RBD_QP_CONVEX: return "H has a negative eigenvalue";
    case RBD_QP_SYMMETRIC: return "H is not symmetric";
    case RBD_QP_NAN: return "not a number, not finite, or too large";
    case RBD_QP_RANGE: return "negative or out of range";
    case RBD_QP_MEMORY: return "the memory is too small: RBD_QP_SIZE has the figure";
    case RBD_QP_NULL: return "a required pointer is NULL";
    case RBD_QP_SIDES: return "above upper";
    }
    return "unknown status";
}

RBDI_API char *rbd_qp_text(rbd_qp_status status, const rbd_qp_result *result, char *text, size_t size) {
    const char *piece[8];
    char digits[12];
    int n = 0;
    if (!text || size == 0) return text;

    if (result && result->at >= 0) {
        const int variable = !result->field || result->field[0] == 'H' || result->field[0] == 'f';
        piece[n++] = variable ? "variable " : "row ";
        piece[n++] = rbdi_decimal(result->at, digits);
        piece[n++] = ", ";
    }
    if (result && result->field) {
        piece[n++] = "field '";
        piece[n++] = result->field;
        piece[n++] = "': ";
    }
    piece[n++] = rbdi_qp_sentence(status);
    return rbdi_join(piece, n, text, size);
}

/* ==== src/rbd_qp.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("C")
#pragma pop_macro("D")
#pragma pop_macro("H")
#pragma pop_macro("J")
#pragma pop_macro("L")
#pragma pop_macro("R")
#pragma pop_macro("V")

/* ==== src/rbd_qp.h ==== */
/* ---- licence [licence] ----

   MIT License

   Copyright (c) 2026 the rbd authors

   Permission is hereby granted, free of charge, to any person obtaining a copy
   of this software and associated documentation files (the "Software"), to deal
   in the Software without restriction, including without limitation the rights
   to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
   copies of the Software, and to permit persons to whom the Software is
   furnished to do so, subject to the following conditions:

   The above copyright notice and this permission notice shall be included in all
   copies or substantial portions of the Software.

   THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
   IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
   FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
   AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
   LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
   OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
   SOFTWARE.
*/
