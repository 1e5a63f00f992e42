/* own_sines.h - the sine and cosine of rbd.h under RBD_REPRODUCIBLE. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_OWN_SINES_H
#define TOOLS_CODEGEN_OWN_SINES_H

#include <cstdint>
#include <vector>

namespace codegen {

/* Of x and as many right angles. */
void own_sines(double x, double quarters, double *sine, double *cosine);
void own_sines(float x, float quarters, float *sine, float *cosine);

/* The words of 2/pi for the angles of a scalar. */
std::vector<uint32_t> two_over_pi_double();
std::vector<uint32_t> two_over_pi_float();

} // namespace codegen
#endif
