/* The sines of constants and examples: graph.h. Compiled for each SCALAR. SPDX-License-Identifier: MIT */
#include "graph.h"

#define RBD_REAL SCALAR
#define RBD_REPRODUCIBLE
#define RBD_STATIC
#define RBD_NO_BUILD
#define RBD_IMPLEMENTATION
#include "rbd.h"

void codegen::own_sines(SCALAR x, SCALAR quarters, SCALAR *sine, SCALAR *cosine) {
    rbdi_sincos_one(x, quarters, sine, cosine);
}
