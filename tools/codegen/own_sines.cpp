/* See own_sines.h. Compiled for each scalar: SCALAR, and WORDS, the name of its function.
   SPDX-License-Identifier: MIT */
#include "own_sines.h"

#define RBD_REAL SCALAR
#define RBD_REPRODUCIBLE
#define RBD_STATIC
#define RBD_NO_BUILD
#define RBD_IMPLEMENTATION
#include "rbd.h"

namespace codegen {

void own_sines(SCALAR x, SCALAR quarters, SCALAR *sine, SCALAR *cosine) {
    rbdi_sincos_one(x, quarters, sine, cosine);
}

std::vector<uint32_t> WORDS() { return {std::begin(rbdi_two_over_pi), std::end(rbdi_two_over_pi)}; }

} // namespace codegen
