/* rows.h - sums of rows of matrices, four columns at once. SPDX-License-Identifier: MIT

   Work on whole rows (src/dynamics/packed.h) is no part of the graph: a function has calls instead. The rows
   stand in one memory, in whole fours. Scalars of the graph are stored into it before a call, and loaded
   from it behind one. No two calls write to one place. Rows that the tree leaves partly zero are written sum
   by sum; full ones are computed by a loop, whose instructions stay in the cache. */
#ifndef TOOLS_CODEGEN_ROWS_H
#define TOOLS_CODEGEN_ROWS_H

#include <string>
#include <vector>

namespace codegen {

enum { FOUR = 4, MOST_FOURS = 10 /* of one sum: as many as there are registers for */, NOWHERE = -1 };
enum { MOST_COLUMNS = 120 /* a set of fours is a word */, WHOLE = 8 /* rows start at multiples of it */ };

/* The row at `to` = scale * the row at `from`, minus the sum of factors times rows. All are places in memory.
   A set of fours has a bit for each: own are those of the row at `from`, the others count as 0. Without
   fours: the inverse of the scalar at `from`. */
struct row_sum {
    struct multiple {
        int factor, row;
        unsigned fours;
    };
    int to, from, scale; /* scale: NOWHERE is 1 */
    unsigned own;
    std::vector<multiple> terms;

    unsigned fours() const {
        unsigned all = own;
        for (const multiple &t : terms) all |= t.fours;
        return all;
    }
};

/* X = sign M^-1 X, all columns of it, as loops over a table of the dofs: X = L'^-1 X, a sum over the
   descendants of each; then X = sign L^-1 D^-1 X, a sum over the path from the root. */
struct row_solution {
    struct dof {
        int row, depth, factors, inverse; /* row: from X; where its row of L and 1/D are */
        int descendants;
    };
    std::vector<dof> dofs; /* depth first; none: nothing is solved */
    int X, fours, sign;
    bool is_half; /* the second half alone */
};

/* Sums, then a solution. */
struct row_call {
    struct store {
        int at, x; /* x: value */
    };
    int node; /* it stands before this node */
    std::vector<store> stores;
    std::vector<row_sum> sums;
    row_solution solution;
};

std::vector<int> places_written(const row_call &c);
std::string copies_text(); /* of runs of scalars, cleared and copied */
std::string rows_text();
std::string call_text(const row_call &c); /* the body of its function */
/* Multiplications and additions, of fours. */
int count_fours(const row_call &c);
int count_inverses(const row_call &c);

template <class T> void run_sum(const row_sum &s, std::vector<T> &rows) {
    const auto at = [&rows](int i) -> T & { return rows[size_t(i)]; };
    if (s.fours() == 0) at(s.to) = 1 / at(s.from);
    for (int j = 0; s.fours() >> j / FOUR; j++) {
        const auto of = [&](int row, unsigned fours) { return fours >> j / FOUR & 1 ? at(row + j) : 0; };
        T x = of(s.from, s.own);
        if (s.scale != NOWHERE) x *= at(s.scale);
        for (const row_sum::multiple &t : s.terms) x -= at(t.factor) * of(t.row, t.fours);
        if (s.fours() >> j / FOUR & 1) at(s.to + j) = x;
    }
}
template <class T> void run_solution(const row_solution &s, std::vector<T> &rows) {
    typedef row_solution::dof dof;
    std::vector<const dof *> path(s.dofs.size());
    for (int j = 0; j < FOUR * s.fours; j++) {
        const auto at = [&](const dof &k) -> T & { return rows[size_t(s.X + k.row + j)]; };
        const auto factor = [&rows](const dof &k, int depth) { return rows[size_t(k.factors + depth)]; };
        for (size_t k = s.dofs.size(); k-- > 0 && !s.is_half;)
            for (int i = s.dofs[k].descendants; i > 0; i--) {
                const dof &t = s.dofs[k + size_t(i)];
                at(s.dofs[k]) -= factor(t, s.dofs[k].depth) * at(t);
            }
        for (const dof &k : s.dofs) {
            at(k) *= T(s.sign) * rows[size_t(k.inverse)];
            for (int t = 0; t < k.depth; t++) at(k) -= factor(k, t) * at(*path[size_t(t)]);
            path[size_t(k.depth)] = &k;
        }
    }
}
template <class T> void run(const row_call &c, std::vector<T> &rows) {
    for (const row_sum &s : c.sums) run_sum(s, rows);
    run_solution(c.solution, rows);
}

} // namespace codegen
#endif
