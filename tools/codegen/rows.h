/* rows.h - sums of rows of matrices, four columns at once. SPDX-License-Identifier: MIT

   Work on whole rows (src/dynamics/packed.h) is no part of the graph: a function has calls instead, each a
   list of sums. The rows stand in one memory, in whole fours. Scalars of
   the graph are stored into it before a call, and loaded from it behind one. */
#ifndef TOOLS_CODEGEN_ROWS_H
#define TOOLS_CODEGEN_ROWS_H

#include <string>
#include <vector>

namespace codegen {

enum { FOUR = 4, MOST_FOURS = 10 /* of one sum: as many as there are registers for */, NOWHERE = -1 };

/* The row at `to` = scale * the row at `from`, minus the sum of factors times rows. All are places in memory.
   A set of fours has a bit for each: own are those of the row at `from`, the others count as 0. Without
   fours: the inverse of the scalar at `from`. */
struct row_sum {
    struct multiple {
        int factor, row;
        unsigned fours;
    };
    int to, from, scale; /* scale: NOWHERE is 1 */
    bool scale_is_negative;
    unsigned own;
    std::vector<multiple> terms;

    unsigned fours() const {
        unsigned all = own;
        for (const multiple &t : terms) all |= t.fours;
        return all;
    }
};

struct row_call {
    struct store {
        int at;
        int x;     /* value */
        bool late; /* something stands there already */
    };
    int node; /* it stands before this node */
    std::vector<store> stores;
    std::vector<row_sum> sums;
};

std::vector<int> places_written(const row_call &c);
std::string copies_text(); /* CLEAR and COPY */
std::string rows_text();
std::string sums_text(const row_call &c);
/* Multiplications and additions, of fours. */
int count_fours(const row_call &c);

template <class T> void run(const row_call &c, std::vector<T> &rows) {
    for (const row_sum &s : c.sums) {
        if (s.fours() == 0) rows[size_t(s.to)] = 1 / rows[size_t(s.from)];
        for (int j = 0; s.fours() >> j / FOUR; j++) {
            const auto of = [&rows, j](int row, unsigned fours) {
                return fours >> j / FOUR & 1 ? rows[size_t(row + j)] : 0;
            };
            T x = of(s.from, s.own);
            if (s.scale != NOWHERE) x *= s.scale_is_negative ? -rows[size_t(s.scale)] : rows[size_t(s.scale)];
            for (const row_sum::multiple &t : s.terms) x -= rows[size_t(t.factor)] * of(t.row, t.fours);
            if (s.fours() >> j / FOUR & 1) rows[size_t(s.to + j)] = x;
        }
    }
}

} // namespace codegen
#endif
