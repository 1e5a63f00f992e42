/* limbs.h - like limbs of one state as lanes. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_LIMBS_H
#define TOOLS_CODEGEN_LIMBS_H

#include "record.h"

namespace codegen {

/* How many limbs of this robot, up to `most`, are best computed at once: 4, 2, or 1 if none are alike. */
int like_limbs(const std::vector<joint> &joints, int most);

/* The same function: what is done alike to `width` like limbs is done to vectors. */
function pack_limbs(const function &f, const std::vector<joint> &joints, int width);

} // namespace codegen
#endif
