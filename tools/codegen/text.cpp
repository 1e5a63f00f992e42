/* Numbers, names and lists as C. SPDX-License-Identifier: MIT */
#include "text.h"
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace codegen {

std::string format(const char *text, ...) {
    va_list list, again;
    va_start(list, text);
    va_copy(again, list);
    std::string s(size_t(vsnprintf(nullptr, 0, text, list)) + 1, 0);
    vsnprintf(&s[0], s.size(), text, again);
    va_end(again);
    va_end(list);
    s.pop_back();
    return s;
}

std::string literal(double x, bool is_float) {
    char text[40];
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (is_float ? strtof(text, nullptr) == float(x) : strtod(text, nullptr) == x) break;
    }
    std::string s = text;
    if (s.find_first_of(".en") == std::string::npos) s += ".0";
    return is_float ? s + "f" : s;
}

std::string upper(std::string s) {
    for (char &c : s) c = char(toupper(static_cast<unsigned char>(c)));
    return s;
}

std::string parameters(const function &f, const std::string &real, const char *before_size) {
    const std::vector<array> all = f.arrays();
    return (f.stances > 0 ? "int stance, " : "") + join(all.size(), ", ", [&](size_t k) {
               return format("%s%s %s[%s%d]", k < f.inputs.size() ? "const " : "", real.c_str(),
                             all[k].name.c_str(), before_size, all[k].size);
           });
}

std::string names(const function &f, const char *before) {
    const std::vector<array> all = f.arrays();
    return (f.stances > 0 ? before + std::string("stance, ") : "") +
           join(all.size(), ", ", [&](size_t k) { return before + all[k].name; });
}

std::string only_if(const function &f, uint32_t stances, uint32_t known) {
    const uint32_t all = known ? known : uint32_t(-1) >> (32 - f.sets());
    return f.stances == 0 || stances == all ? "" : format("if (0x%xu >> stance & 1) ", unsigned(stances));
}

std::string real_name(const target &t) {
    return t.lanes > 1 ? t.name + "_real" : t.is_float ? "float" : "double";
}

const char *result_type(const function &f) { return f.pivots.empty() ? "void" : "int"; }

} // namespace codegen
