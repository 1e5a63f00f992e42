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

    blocks(const program &p, int most) : of(p.f.code.nodes.size(), -1), kept_at(of) {
        for (int i = 0; i < int(of.size()); i++)
            if (p.is_statement[size_t(i)]) order.push_back(i);
        const auto rank = [&](int i) {
            const uint32_t set = p.stances[size_t(i)];
            return std::make_pair(-__builtin_popcount(set), set);
        };
        std::stable_sort(order.begin(), order.end(), [&](int x, int y) { return rank(x) < rank(y); });
        const int n = int(order.size());
        for (int first = 0, end = 0; first < n || count == 0; first = end) {
            while (end < n && rank(order[size_t(end)]) == rank(order[size_t(first)])) end++;
            const int more = std::max(1, (end - first + most - 1) / most);
            for (int k = first; k < end; k++)
                of[size_t(order[size_t(k)])] = count + int(int64_t(k - first) * more / (end - first));
            stances.resize(size_t(count += more), first < n ? p.stances[size_t(order[size_t(first)])] : 0);
        }
        const std::vector<int> last = last_uses(p);
        std::vector<std::vector<int>> released(size_t(count) + 1);
        std::vector<int> unused[2]; /* places of scalars, of vectors */
        int current = 0;
        for (int i : order) {
            for (; current < of[size_t(i)]; current++)
                for (int k : released[size_t(current)])
                    unused[p.at(k).is_vector].push_back(kept_at[size_t(k)]);
            if (last[size_t(i)] <= current) continue;
            const bool is_vector = p.at(i).is_vector;
            std::vector<int> &u = unused[is_vector];
            if (u.empty()) u.push_back(is_vector ? kept_vectors++ : kept++);
            kept_at[size_t(i)] = u.back();
            u.pop_back();
            released[size_t(last[size_t(i)])].push_back(i);
        }
    }

  private:
    /* Of each node the last block that reads it. */
    std::vector<int> last_uses(const program &p) const {
        std::vector<int> last(of.size(), -1);
        for (int i : order)
            for (int k : p.operands(i)) last[size_t(k)] = of[size_t(i)];
        return last;
    }
};

} // namespace codegen
#endif
