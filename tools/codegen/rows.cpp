/* The C text of sums of rows and of solutions. SPDX-License-Identifier: MIT */
#include "rows.h"
#include <algorithm>

namespace codegen {
namespace {

static_assert(MOST_FOURS == 10 && MOST_COLUMNS == 120, "the texts below have room for as many");

/* s, the row that is made, by fours; those from i on, n of them. By vectors each number of fours has its own
   macros: compilers need not unroll anything. k: where a factor stands; x: where a row does. */
const char by_vectors[] = R"(
/* Sums of rows, by fours of columns. Compilers that do not optimize would keep a place on the stack for each
   vector, megabytes for a long chain. */
#if defined __GNUC__ && defined __OPTIMIZE__
#define ALIGNED __attribute__((aligned(8 * sizeof(scalar))))
#define AT(x, i) (((four *)(rows + (x)))[i])
/* Compilers that know what has been stored would keep it in registers, and spill it: read it again. */
#define ROW { four s[10]; __asm__ volatile("" ::: "memory");
#define FROM(i, n, x) FROM##n(i, x)
#define TIMES(i, n, k, x) TIMES##n(i, rows[k], x)
#define NEGATIVE(i, n, k, x) TIMES##n(i, -rows[k], x)
#define MINUS(i, n, k, x) MINUS##n(i, rows[k], x)
#define TO(i, n, x) TO##n(i, x)
)";

const char clears_and_copies[] = R"(
#ifdef __GNUC__
typedef scalar four __attribute__((vector_size(4 * sizeof(scalar)), aligned(sizeof(scalar)), may_alias));
#endif
INLINE void clear_row(int n, scalar *to) {
    int j = 0;
#ifdef __GNUC__
    const four zeros = {0};
    for (; j + 32 <= n; j += 32) {
        four *y = (four *)(to + j);
        y[0] = y[1] = y[2] = y[3] = y[4] = y[5] = y[6] = y[7] = zeros;
    }
    for (; j + 4 <= n; j += 4) *(four *)(to + j) = zeros;
#endif
    for (; j < n; ++j) to[j] = 0;
}
/* By sixteens at first, else compilers call memcpy. */
INLINE void copy_row(int n, scalar *restrict to, const scalar *restrict from) {
    int j = 0;
#ifdef __GNUC__
    for (; j + 16 <= n; j += 16) {
        four *y = (four *)(to + j);
        const four *x = (const four *)(from + j);
        y[0] = x[0], y[1] = x[1], y[2] = x[2], y[3] = x[3];
    }
    for (; j + 4 <= n; j += 4) *(four *)(to + j) = *(const four *)(from + j);
#endif
    for (; j < n; ++j) to[j] = from[j];
}
INLINE void copy_rows(int rows, int n, scalar *restrict to, int pitch, const scalar *restrict from,
                      int step) {
    for (int i = 0; i < rows; ++i) copy_row(n, to + i * pitch, from + i * step);
}
)";

const char by_loops[] = R"(#else
#define ALIGNED
#define ROW { scalar s[40];
#define EACH(n) for (int j = 0; j < 4 * (n); ++j)
#define FROM(i, n, x) EACH(n) s[4 * (i) + j] = rows[(x) + j];
#define TIMES(i, n, k, x) EACH(n) s[4 * (i) + j] = rows[k] * rows[(x) + j];
#define NEGATIVE(i, n, k, x) EACH(n) s[4 * (i) + j] = -rows[k] * rows[(x) + j];
#define MINUS(i, n, k, x) EACH(n) s[4 * (i) + j] -= rows[k] * rows[(x) + j];
#define TO(i, n, x) EACH(n) rows[(x) + j] = s[4 * (i) + j];
#endif
#define END }
)";

/* n and `half` are constants wherever it is called. */
const char solution[] = R"(
/* X = sign M^-1 X, n fours of columns: first X = L'^-1 X, sums over the descendants of each dof, then
   X = sign L^-1 D^-1 X, sums over the path from the root. Of each dof, depth first: its row in X, its depth,
   where its row of L and 1/D are, and how many descendants it has. half: the second alone. */
#ifdef __GNUC__
#if defined __AVX512F__ || (defined __AVX__ && defined SCALAR_IS_FLOAT)
enum { WIDE = 2, MOST_AT_ONCE = 16 }; /* fours in a register; of a row, so that two sums stay in registers */
#else
enum { WIDE = 1, MOST_AT_ONCE = 6 };
#endif
typedef scalar wide
    __attribute__((vector_size(4 * WIDE * sizeof(scalar)), aligned(sizeof(scalar)), may_alias));
#ifdef __clang__ /* unrolls by itself, and loads once what is used twice */
#define UNROLL
#define ONCE
#else
#define UNROLL _Pragma("GCC unroll 8")
#define ONCE __asm__ volatile("" ::: "memory");
#endif
#define EACH_WIDE UNROLL for (int j = 0; j < (n + WIDE - 1) / WIDE; ++j)

/* s -= f z, and r -= g z: the rows of a dof and of its only child are computed together, for one load. */
#define MINUS_TWO(z, f, g) { \
    const wide *from = (const wide *)(z); \
    const scalar of_s = f, of_r = g; \
    EACH_WIDE { const wide v = from[j]; ONCE s[j] -= v * of_s, r[j] -= v * of_r; } }
#define MINUS_ONE(z, f) { \
    const wide *from = (const wide *)(z); \
    const scalar of_s = f; \
    EACH_WIDE s[j] -= from[j] * of_s; }
INLINE void solve_columns(const int (*dof)[5], int dofs, int half, scalar sign, const scalar *rows, scalar *X,
                          int n) {
    int path[120];
    wide s[8], r[8];
    for (int k = dofs - 1; k >= 0 && !half; --k) {
        const int depth = dof[k][1], two = k > 0 && dof[k - 1][4] == dof[k][4] + 1;
        wide *x = (wide *)(X + dof[k][0]), *y = (wide *)(X + dof[k - two][0]);
        const scalar *l = rows + depth, own = two ? l[dof[k][2] - 1] : 0;
        int t = k + dof[k][4];
        EACH_WIDE s[j] = x[j], r[j] = y[j];
        if (two)
            for (; t > k; --t) MINUS_TWO(X + dof[t][0], l[dof[t][2]], l[dof[t][2] - 1])
        else
            for (; t > k; --t) MINUS_ONE(X + dof[t][0], l[dof[t][2]])
        EACH_WIDE x[j] = s[j];
        if (two) EACH_WIDE y[j] = r[j] - s[j] * own;
        k -= two;
    }
    for (int k = 0; k < dofs; ++k) {
        const int depth = dof[k][1], two = k + 1 < dofs && dof[k][4] == dof[k + 1][4] + 1;
        const int *next = dof[k + two];
        wide *x = (wide *)(X + dof[k][0]), *y = (wide *)(X + next[0]);
        const scalar *l = rows + dof[k][2], *h = rows + next[2], a = sign * rows[dof[k][3]],
                     b = sign * rows[next[3]], own = two ? h[depth] : 0;
        EACH_WIDE s[j] = x[j] * a, r[j] = y[j] * b;
        if (two)
            for (int t = 0; t < depth; ++t) MINUS_TWO(X + path[t], l[t], h[t])
        else
            for (int t = 0; t < depth; ++t) MINUS_ONE(X + path[t], l[t])
        EACH_WIDE x[j] = s[j];
        if (two) EACH_WIDE y[j] = r[j] - s[j] * own;
        path[depth] = dof[k][0], path[next[1]] = next[0];
        k += two;
    }
}
INLINE void solve(const int (*dof)[5], int dofs, int half, scalar sign, const scalar *rows, scalar *X,
                  int n) {
    const int passes = (n + MOST_AT_ONCE - 1) / MOST_AT_ONCE, size = ((n - 1) / passes + WIDE) / WIDE * WIDE;
    const int last = (passes - 1) * size;
    for (int j = 0; j < last; j += size) solve_columns(dof, dofs, half, sign, rows, X + 4 * j, size);
    solve_columns(dof, dofs, half, sign, rows, X + 4 * last, n - last);
}
#else
INLINE void solve(const int (*dof)[5], int dofs, int half, scalar sign, const scalar *rows, scalar *X,
                  int n) {
    int path[120];
    for (scalar *x = X; x < X + 4 * n; ++x) {
        for (int k = dofs - 1; k >= 0 && !half; --k)
            for (int t = k + dof[k][4]; t > k; --t)
                x[dof[k][0]] -= rows[dof[t][2] + dof[k][1]] * x[dof[t][0]];
        for (int k = 0; k < dofs; ++k) {
            x[dof[k][0]] *= sign * rows[dof[k][3]];
            for (int t = 0; t < dof[k][1]; ++t) x[dof[k][0]] -= rows[dof[k][2] + t] * x[path[t]];
            path[dof[k][1]] = dof[k][0];
        }
    }
}
#endif
)";

/* Calls one(first, number) for the runs of a set of fours. */
template <class function> void for_runs(unsigned fours, function one) {
    for (int i = 0, n = 0; fours >> i; i += n ? n : 1, n = 0) {
        while (fours >> (i + n) & 1) n++;
        if (n > 0) one(i, n);
    }
}

class sum_writer {
  public:
    std::string text;

    void write(const row_sum &r) {
        unsigned known = r.own; /* fours of s that have a value */
        if (r.fours() == 0) {
            text += "    rows[" + number(r.to) + "] = 1 / rows[" + number(r.from) + "];\n";
            return;
        }
        text += "    ROW\n";
        if (r.scale == NOWHERE)
            for_runs(r.own, [&](int i, int n) { line("FROM", {i, n, r.from + FOUR * i}); });
        else
            add("TIMES", r.own, r.scale, r.from);
        for (const row_sum::multiple &t : r.terms) {
            add("NEGATIVE", t.fours & ~known, t.factor, t.row);
            add("MINUS", t.fours & known, t.factor, t.row);
            known |= t.fours;
        }
        for_runs(known, [&](int i, int n) { line("TO", {i, n, r.to + FOUR * i}); });
        text += "    END\n";
    }

  private:
    static std::string number(int x) { return std::to_string(x); }
    void line(const char *name, const std::vector<int> &numbers) {
        text += std::string("    ") + name;
        for (const int &x : numbers) text += (&x == &numbers[0] ? "(" : ", ") + number(x);
        text += ")\n";
    }
    void add(const char *name, unsigned fours, int factor, int row) {
        for_runs(fours, [&](int i, int n) { line(name, {i, n, factor, row + FOUR * i}); });
    }
};

} // namespace

std::vector<int> places_written(const row_call &c) {
    std::vector<int> all;
    for (const row_sum &s : c.sums) {
        if (s.fours() == 0) all.push_back(s.to);
        for (int j = 0; s.fours() >> j / FOUR; j++)
            if (s.fours() >> j / FOUR & 1) all.push_back(s.to + j);
    }
    for (const row_solution::dof &d : c.solution.dofs)
        for (int j = 0; j < FOUR * c.solution.fours; j++) all.push_back(c.solution.X + d.row + j);
    return all;
}

std::string copies_text() { return clears_and_copies; }

std::string rows_text() {
    static const char *const macros[][3] = {{"FROM", "(i, x)", " = AT(x, "},
                                            {"TIMES", "(i, k, x)", " = k * AT(x, "},
                                            {"MINUS", "(i, k, x)", " -= k * AT(x, "}};
    std::string s = by_vectors;
    const auto begin = [&s](const char *name, int n, const char *arguments) {
        s += std::string("#define ") + name + std::to_string(n) + arguments;
    };
    for (int n = 1; n <= MOST_FOURS; n++) {
        for (const auto &m : macros) {
            begin(m[0], n, m[1]);
            for (int k = 0; k < n; k++)
                s += " s[i + " + std::to_string(k) + "]" + m[2] + std::to_string(k) + ");";
            s += "\n";
        }
        begin("TO", n, "(i, x)");
        for (int k = 0; k < n; k++)
            s += " AT(x, " + std::to_string(k) + ") = s[i + " + std::to_string(k) + "];";
        s += "\n";
    }
    return s + by_loops + solution;
}

std::string call_text(const row_call &c) {
    const row_solution &x = c.solution;
    const auto list = [](std::vector<int> numbers) {
        std::string s;
        for (const int &n : numbers) s += (&n == &numbers[0] ? "" : ", ") + std::to_string(n);
        return s;
    };
    sum_writer w;
    for (const row_sum &r : c.sums) w.write(r);
    if (x.dofs.empty()) return w.text;
    w.text += "    static const int dof[][5] = {";
    for (const row_solution::dof &d : x.dofs)
        w.text += "{" + list({d.row, d.depth, d.factors, d.inverse, d.descendants}) + "},";
    return w.text + "};\n    solve(dof, " + list({int(x.dofs.size()), x.is_half, x.sign}) +
           ", rows, rows + " + list({x.X, x.fours}) + ");\n";
}

int count_inverses(const row_call &c) {
    return int(std::count_if(c.sums.begin(), c.sums.end(), [](const row_sum &s) { return s.fours() == 0; }));
}

int count_fours(const row_call &c) {
    int n = 0;
    for (const row_sum &s : c.sums) {
        if (s.scale != NOWHERE) n += __builtin_popcount(s.own);
        for (const row_sum::multiple &t : s.terms) n += 2 * __builtin_popcount(t.fours);
    }
    for (const row_solution::dof &d : c.solution.dofs)
        n += (1 + 2 * d.depth * (c.solution.is_half ? 1 : 2)) * c.solution.fours;
    return n;
}

} // namespace codegen
