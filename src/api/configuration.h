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
