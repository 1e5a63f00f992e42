/* blocks.h - a long function in parts. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_BLOCKS_H
#define TOOLS_CODEGEN_BLOCKS_H

#include "program.h"

namespace codegen {

/* Compilers take long for a long function: it is cut into blocks of as many statements. A value that a later
   block reads is kept in memory, in a place that is free again behind the last block that reads it. Each
   set of stances has blocks of its own; sets of more stances come first. */
struct blocks {
    std::vector<int> order;        /* the statements */
    std::vector<int> of;           /* each node's block, or -1 */
    std::vector<int> kept_at;      /* its place, or -1 */
    std::vector<uint32_t> stances; /* of each block */
    int count = 0, kept = 0, kept_vectors = 0;

    blocks(const program &p, int most);

  private:
    std::vector<int> last_uses(const program &p) const;
};

} // namespace codegen
#endif
