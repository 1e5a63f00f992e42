#ifndef RBDI_BASE_TYPES_H
#define RBDI_BASE_TYPES_H
#include "api/configuration.h"

/* ---- layout [layout] ----
   The built model and the work, laid open for sizes at compile time and for generated tables only. */

/* Arithmetic of the build: double at least, whatever the model's scalar. */
#if RBDI_KIND(RBD_CONST) == 3
RBDI_EXTENSION typedef __float128 rbdi_wide;
#else
typedef double rbdi_wide;
#endif

#define RBDI_CHUNK 16 /* padding of rows: at least a batch */
#define RBDI_ALIGN ((size_t)(sizeof(rbd_real) > 64 ? sizeof(rbd_real) : 64))
#define RBDI_ROUND(bytes) (((size_t)(bytes) + RBDI_ALIGN - 1) / RBDI_ALIGN * RBDI_ALIGN)

#endif
