/* The self-test: all functions on known states. SPDX-License-Identifier: MIT */
#include "text.h"
#include <algorithm>
#include <cmath>
#include <cstdlib>

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

/* The first input that an angle depends on, and the angle's derivative by it. */
const node &input_of(const graph &g, value angle, double *slope) {
    const node &n = g.nodes[size_t(node_of(angle))];
    if (n.op == INPUT) return n;
    const int k = g.is_constant(n.arg[0]);
    if ((n.op != ADD && n.op != MULTIPLY) || g.is_constant(n.arg[k])) abort();
    if (n.op == MULTIPLY) *slope *= g.constant_of(n.arg[1 - k]);
    return input_of(g, n.arg[k], slope);
}

/* An angle a thousand times too large, where unchecked polynomials still have values, is refused. */
std::string beyond(const function &f, value angle, const target &t, const std::string &call) {
    double slope = 1;
    const node &n = input_of(f.code, angle, &slope);
    const std::string size = literal((t.is_float ? 1e7 : 1e9) / std::fabs(slope), t.is_float);
    const std::string s = format("    for (int j = 0; j < LANES; ++j) LANE(%s[%d], j) = %s;\n",
                                 f.inputs[size_t(n.arg[0])].name.c_str(), n.arg[1], size.c_str());
    if (!f.pivots.empty()) return s + format("    return %s == -1 - %d ? 0 : 2;\n", call.c_str(), f.nv);
    return s + "    " + call + ";\n    for (int j = 0; j < LANES; ++j)\n        if (" +
           join(f.outputs.size(), " && ",
                [&](size_t k) {
                    return format("has_numbers(%s, %d, j)", f.outputs[k].name.c_str(), f.outputs[k].size);
                }) +
           ") return 2;\n    return 0;\n";
}

/* The states' values of an array, from `first` on in what `get` gives of a state. */
template <class getter>
std::string table(const piece &x, const std::string &name, int size, const target &t, getter get,
                  size_t first) {
    std::string s = format("static const scalar %s[%zu][%d] = {\n", name.c_str(), x.x.examples.size(), size);
    for (const example &e : x.x.examples)
        s += "    {" +
             join(size_t(size), "",
                  [&](size_t k) {
                      return (k == 0       ? ""
                              : k % 6 == 0 ? ",\n     "
                                           : ", ") +
                             literal(get(e)[first + k], t.is_float);
                  }) +
             "},\n";
    return s + "};\n";
}

/* "test_NAME" runs a function on each state; with lanes other states are in the others. */
std::string test_of(const piece &x, const target &t) {
    const function &f = x.x.f;
    const std::string full = t.name + "_" + f.name, call = full + "(" + names(f) + ")";
    const size_t states = x.x.examples.size();
    std::string tables, gives, compares;
    size_t first = 0;
    for (size_t k = 0; k < f.inputs.size(); k++) {
        const std::string name = full + "_of_" + f.inputs[k].name;
        tables += table(x, name, f.inputs[k].size, t, [k](const example &e) { return e.in[k]; }, 0);
        gives += format("            give(%s[(k + j) %% %zu], %d, j, %s);\n", name.c_str(), states,
                        f.inputs[k].size, f.inputs[k].name.c_str());
    }
    for (const array &a : f.outputs) {
        const std::string name = full + "_is_" + a.name;
        tables += table(x, name, a.size, t, [](const example &e) { return e.out; }, first);
        first += size_t(a.size);
        compares +=
            format("            if (differs(%s, %s[(k + j) %% %zu], %d, j, %s, %s, worst)) return 1;\n",
                   a.name.c_str(), name.c_str(), states, a.size, literal(x.x.tolerance, t.is_float).c_str(),
                   literal(x.x.least, t.is_float).c_str());
    }
    std::string s = tables + format("static int test_%s(scalar *worst) {\n", f.name.c_str());
    if (f.stances > 0)
        s += format("    int stance = 0;\n    static const int stances[%zu] = {", states) +
             join(states, ", ", [&](size_t k) { return std::to_string(x.x.examples[k].stance); }) + "};\n";
    for (const array &a : f.arrays()) s += format("    static real %s[%d];\n", a.name.c_str(), a.size);
    s += format("    for (int k = 0; k < %zu; ++k) {\n        for (int j = 0; j < LANES; ++j) {\n", states) +
         gives + "        }\n        " + (f.stances > 0 ? "stance = stances[k];\n        " : "") +
         (f.pivots.empty() ? call + ";\n" : "if (" + call + " != 0) return 1;\n") +
         "        for (int j = 0; j < LANES; ++j) {\n" + compares + "        }\n    }\n";
    const bool checks = t.is_bounded && !x.p.angles.empty();
    return s + (checks ? beyond(f, x.p.angles[0].x, t, call) : "    return 0;\n") + "}\n";
}

} // namespace

std::string selftest_text(const std::vector<piece> &all, const target &t) {
    const std::string macro = upper(t.name) + "_SELFTEST";
    std::string s = "#ifdef " + macro + "\n" + comparison_text, rows;
    for (const piece &x : all) {
        const char *name = x.x.f.name.c_str();
        s += test_of(x, t);
        rows += format("    {\"%s_%s\", test_%s, %zu, %s},\n", t.name.c_str(), name, name,
                       x.x.examples.size(), literal(x.x.tolerance, t.is_float).c_str());
    }
    return s + format(end_text, rows.c_str(), t.name.c_str(), macro.c_str(), t.name.c_str());
}

} // namespace codegen
