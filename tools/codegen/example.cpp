/* A main that calls a function. SPDX-License-Identifier: MIT */
#include "text.h"
#include <algorithm>

namespace codegen {
namespace {

/* "{0, 1}"; of lanes "{{0}, {1, 1}}"; one 0 stands for all. */
std::string initialiser(std::vector<double> x, const target &t) {
    if (std::count(x.begin(), x.end(), 0) == long(x.size())) x.resize(1);
    return "{" +
           join(x.size(), ", ",
                [&](size_t k) {
                    const std::string one = x[k] == 0 ? "0" : literal(x[k], t.is_float);
                    if (t.lanes == 1) return one;
                    return "{" + join(x[k] == 0 ? 1 : size_t(t.lanes), ", ", [&](size_t) { return one; }) +
                           "}";
                }) +
           "}";
}

} // namespace

std::string example_command(const std::string &path) {
    return "cc -O2 " + path + "_example.c " + path + "_code.c -lm -o " + path + "_example";
}

std::string example_text(const function &f, const target &t, const std::vector<double> &q,
                         const std::vector<double> &gravity) {
    const std::string real = real_name(t), call = t.name + "_" + f.name;
    std::string s =
        format("#include \"%s_code.h\"\n#include <stdio.h>\n\nint main(void) {\n", t.name.c_str());
    if (f.stances > 0) s += "    const int stance = 0;\n";
    for (const array &a : f.inputs) {
        const std::vector<double> x = a.name == "q"         ? q
                                      : a.name == "gravity" ? gravity
                                                            : std::vector<double>(size_t(a.size), 0);
        s += format("    const %s %s[%d] = %s;\n", real.c_str(), a.name.c_str(), a.size,
                    initialiser(x, t).c_str());
    }
    for (const array &a : f.outputs) s += format("    %s %s[%d];\n", real.c_str(), a.name.c_str(), a.size);
    s += "    " + std::string(f.pivots.empty() ? "" : "const int status = ") + call + "(" + names(f) + ");\n";
    if (!f.pivots.empty()) s += format("    printf(\"%s: status %%d\\n\", status);\n", call.c_str());
    for (const array &a : f.outputs)
        s += format("    for (int i = 0; i < %d; i++) printf(\"%s[%%d] = %%g\\n\", i, (double)%s[i]%s);\n",
                    a.size, a.name.c_str(), a.name.c_str(), t.lanes > 1 ? "[0]" : "");
    return s + "    return " + (f.pivots.empty() ? "0" : "status != 0") + ";\n}\n";
}

} // namespace codegen
