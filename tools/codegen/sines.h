/* sines.h - the text of the generated code's own sine and cosine. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_SINES_H
#define TOOLS_CODEGEN_SINES_H

namespace codegen {
extern const char sines_double[], sines_float[], sines_common[];
}
#endif
