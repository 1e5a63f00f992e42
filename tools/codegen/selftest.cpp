/* The self-test: all functions on known states. SPDX-License-Identifier: MIT */
#include "text.h"

namespace codegen {
namespace {

const char comparison_text[] = R"(
/* Relative to the largest, if that is more than it is at the call. */
static int differs(const real *x, const scalar *y, int n, int lane, scalar tolerance, scalar largest,
                   scalar *worst) {
    int same = 1;
    for (int k = 0; k < n; ++k) {
        if (y[k] > largest) largest = y[k];
        if (-y[k] > largest) largest = -y[k];
    }
    for (int k = 0; k < n; ++k) {
        const scalar d = (LANE(x[k], lane) - y[k]) / largest;
        same = same && d <= tolerance && -d <= tolerance;
        if (!(d <= *worst)) *worst = d;
        if (!(-d <= *worst)) *worst = -d;
    }
    return !same;
}
static void give(const scalar *y, int n, int lane, real *x) {
    for (int k = 0; k < n; ++k) LANE(x[k], lane) = y[k];
}
/* Whether in this lane none of the n is NaN. */
COLD int has_numbers(const real *x, int n, int lane) {
    for (int k = 0; k < n; ++k)
        if (LANE(x[k], lane) != LANE(x[k], lane)) return 0;
    return 1;
}
)";

/* The rows of its table, its name, the macro that adds a main, its name. */
const char end_text[] = R"(static const struct {
    const char *name;
    int (*run)(scalar *worst); /* 0: right */
    int states;
    scalar tolerance;
} selftests[] = {
%s};
enum { SELFTESTS = sizeof selftests / sizeof *selftests };
int %s_selftest(void) {
    for (int k = 0; k < SELFTESTS; ++k) {
        scalar worst = 0;
        if (selftests[k].run(&worst)) return k + 1;
    }
    return 0;
}
#ifdef %s_MAIN
#include <stdio.h>
int main(void) {
    static const char *const verdicts[] = {"right", "WRONG", "WRONG: takes an angle out of range"};
    for (int k = 0; k < SELFTESTS; ++k) {
        scalar worst = 0;
        const int status = selftests[k].run(&worst);
        printf("%%s: %%d states, largest error %%.1e, %%.1e allowed: %%s\n", selftests[k].name,
               selftests[k].states, (double)worst, (double)selftests[k].tolerance, verdicts[status]);
    }
    return %s_selftest();
}
#endif
#endif
)";

/* Angles a thousand times too large, where unchecked polynomials still have values, are refused. */
std::string beyond(const function &f, const target &t, const std::string &call) {
    const std::string s = format("    for (int i = 0; i < %d; ++i)\n"
                                 "        for (int j = 0; j < LANES; ++j) LANE(%s[i], j) = %s;\n",
                                 f.inputs[0].size, f.inputs[0].name.c_str(), t.is_float ? "1e7f" : "1e9");
    if (!f.pivots.empty()) return s + format("    return %s == -1 - %d ? 0 : 2;\n", call.c_str(), f.nv);
    const auto has_numbers = [&](size_t k) {
        return format("has_numbers(%s, %d, j)", f.outputs[k].name.c_str(), f.outputs[k].size);
    };
    return s + "    " + call + ";\n    for (int j = 0; j < LANES; ++j)\n        if (" +
           join(f.outputs.size(), " && ", has_numbers) + ") return 2;\n    return 0;\n";
}

/* An array from x on in all states, six numbers to a line. */
std::string table(const std::vector<const double *> &states, const std::string &name, int size,
                  const target &t) {
    std::string s = format("static const scalar %s[%zu][%d] = {\n", name.c_str(), states.size(), size);
    for (const double *x : states)
        s += "    {" +
             join(size_t(size), "",
                  [&](size_t k) {
                      return (k % 6 ? ", " : k ? ",\n     " : "") + literal(x[k], t.is_float);
                  }) +
             "},\n";
    return s + "};\n";
}

/* "test_ROBOT_NAME" runs a function on each state; with lanes other states are in the others. */
std::string test_of(const piece &x, const target &t) {
    const function &f = x.x.f;
    const std::string full = t.name + "_" + f.name, call = full + "(" + names(f) + ")";
    const size_t states = x.x.examples.size(), given = f.inputs.size();
    const std::vector<array> arrays = f.arrays();
    std::string tables, room, gives, compares;
    size_t first = 0; /* of the results */
    for (size_t k = 0; k < arrays.size(); k++) {
        const array &a = arrays[k];
        const std::string name = full + (k < given ? "_of_" : "_is_") + a.name,
                          row = format("%s[(k + j) %% %zu], %d, j", name.c_str(), states, a.size);
        std::vector<const double *> numbers;
        for (const example &e : x.x.examples)
            numbers.push_back(k < given ? e.in[k].data() : e.out.data() + first);
        tables += table(numbers, name, a.size, t);
        room += format("    static real %s[%d];\n", a.name.c_str(), a.size);
        if (k < given) {
            gives += "            give(" + row + ", " + a.name + ");\n";
            continue;
        }
        first += size_t(a.size);
        compares += "            if (differs(" + a.name + ", " + row + ", " +
                    literal(x.x.tolerance, t.is_float) + ", " + literal(x.x.least, t.is_float) +
                    ", worst)) return 1;\n";
    }
    std::string s = tables + format("static int test_%s(scalar *worst) {\n", full.c_str());
    if (f.stances > 0)
        s += format("    int stance = 0;\n    static const int stances[%zu] = {", states) +
             join(states, ", ", [&](size_t k) { return std::to_string(x.x.examples[k].stance); }) + "};\n";
    s += room;
    s += format("    for (int k = 0; k < %zu; ++k) {\n        for (int j = 0; j < LANES; ++j) {\n", states) +
         gives + "        }\n        " + (f.stances > 0 ? "stance = stances[k];\n        " : "") +
         (f.pivots.empty() ? call + ";\n" : "if (" + call + " != 0) return 1;\n") +
         "        for (int j = 0; j < LANES; ++j) {\n" + compares + "        }\n    }\n";
    const bool checks = t.is_bounded && !x.p.angles.empty();
    return s + (checks ? beyond(f, t, call) : "    return 0;\n") + "}\n";
}

} // namespace

std::string selftest_text(const std::vector<piece> &all, const target &t) {
    const std::string macro = upper(t.name) + "_SELFTEST";
    std::string s = "#if defined " + macro + " || defined " + macro + "_MAIN\n" + comparison_text, rows;
    for (const piece &x : all) {
        const std::string full = t.name + "_" + x.x.f.name;
        s += test_of(x, t);
        rows += format("    {\"%s\", test_%s, %zu, %s},\n", full.c_str(), full.c_str(), x.x.examples.size(),
                       literal(x.x.tolerance, t.is_float).c_str());
    }
    return s + format(end_text, rows.c_str(), t.name.c_str(), macro.c_str(), t.name.c_str());
}

} // namespace codegen
