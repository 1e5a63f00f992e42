/* own_sines.h - the sine and cosine of rbd.h under RBD_REPRODUCIBLE. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_OWN_SINES_H
#define TOOLS_CODEGEN_OWN_SINES_H

namespace codegen {

/* Of x and as many right angles. */
void own_sines(double x, double quarters, double *sine, double *cosine);
void own_sines(float x, float quarters, float *sine, float *cosine);

} // namespace codegen
#endif
