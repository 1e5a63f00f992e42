/* sines.h - the text of the generated code's own sine and cosine. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_SINES_H
#define TOOLS_CODEGEN_SINES_H

#include <string>

namespace codegen {
extern const char sines_double[], sines_float[], sines_common[];

/* In the place of sines_common, where bits shall be those of rbd.h under RBD_REPRODUCIBLE. */
std::string sines_reproducible(bool is_float, bool is_bounded);
} // namespace codegen
#endif
