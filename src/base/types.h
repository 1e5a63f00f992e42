#ifndef RBDI_BASE_TYPES_H
#define RBDI_BASE_TYPES_H
#include "api/configuration.h"

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
