/* The C text of sums of rows. SPDX-License-Identifier: MIT */
#include "rows.h"

namespace codegen {
namespace {

static_assert(MOST_FOURS == 10, "the texts below have room for as many");

/* s, the row that is made, by fours; those from i on, n of them. By vectors each number of fours has its own
   macros: compilers need not unroll anything. */
const char by_vectors[] = R"(
/* Sums of rows, by fours of columns. */
#ifdef __GNUC__
#define AT(x, i) (((four *)(rows + (x)))[i])
/* Compilers that know what has been stored would keep it in registers, and spill it: read it again. */
#define ROW { four s[10]; __asm__ volatile("" ::: "memory");
#define FROM(i, n, x) FROM##n(i, x)
#define TIMES(i, n, k, x) TIMES##n(i, k, x)
#define MINUS(i, n, k, x) MINUS##n(i, k, x)
#define TO(i, n, x) TO##n(i, x)
)";

const char clears_and_copies[] = R"(
#ifdef __GNUC__
typedef scalar four __attribute__((vector_size(4 * sizeof(scalar)), aligned(sizeof(scalar)), may_alias));
#endif
#define CLEAR(n, to) clear_row(n, to)
#define COPY(n, to, x) copy_row(n, to, rows + (x))
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
)";

const char by_loops[] = R"(#else
#define ROW { scalar s[40];
#define EACH(n) for (int j = 0; j < 4 * (n); ++j)
#define FROM(i, n, x) EACH(n) s[4 * (i) + j] = rows[(x) + j];
#define TIMES(i, n, k, x) EACH(n) s[4 * (i) + j] = k * rows[(x) + j];
#define MINUS(i, n, k, x) EACH(n) s[4 * (i) + j] -= k * rows[(x) + j];
#define TO(i, n, x) EACH(n) rows[(x) + j] = s[4 * (i) + j];
#endif
#define END }
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
            for_runs(r.own, [&](int i, int n) { line("FROM", {i, n}, "", r.from + FOUR * i); });
        else
            add("TIMES", r.own, r.scale, r.scale_is_negative, r.from);
        for (const row_sum::multiple &t : r.terms) {
            add("TIMES", t.fours & ~known, t.factor, true, t.row);
            add("MINUS", t.fours & known, t.factor, false, t.row);
            known |= t.fours;
        }
        for_runs(known, [&](int i, int n) { line("TO", {i, n}, "", r.to + FOUR * i); });
        text += "    END\n";
    }

  private:
    static std::string number(int x) { return std::to_string(x); }
    void line(const char *name, const std::vector<int> &first, const std::string &factor, int last) {
        text += std::string("    ") + name + "(";
        for (int x : first) text += number(x) + ", ";
        text += factor + number(last) + ")\n";
    }
    void add(const char *name, unsigned fours, int factor, bool negative, int row) {
        const std::string k = (negative ? "-rows[" : "rows[") + number(factor) + "], ";
        for_runs(fours, [&](int i, int n) { line(name, {i, n}, k, row + FOUR * i); });
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
    return s + by_loops;
}

std::string sums_text(const row_call &c) {
    sum_writer w;
    for (const row_sum &r : c.sums) w.write(r);
    return w.text;
}

int count_fours(const row_call &c) {
    int n = 0;
    for (const row_sum &s : c.sums) {
        if (s.scale != NOWHERE) n += __builtin_popcount(s.own);
        for (const row_sum::multiple &t : s.terms) n += 2 * __builtin_popcount(t.fours);
    }
    return n;
}

} // namespace codegen
