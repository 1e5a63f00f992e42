/* text.h - numbers, names and lists as C, for the files that write it. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_TEXT_H
#define TOOLS_CODEGEN_TEXT_H

#include "program.h"
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace codegen {

/* A function, and its statements. */
struct piece {
    const tested &x;
    program p;
};

std::string common_text(const std::vector<piece> &all, const target &t); /* what all functions use */
std::string sines_text(const target &t);
std::string own_sincos_text();   /* of it what computes one sine and cosine */
extern const char flags_text[];  /* which of the compiler's options are errors */
extern const char status_text[]; /* the status where rows of constraints are judged */
std::string comment_text(const tested &x, const program &p,
                         const target &t); /* a function's contract, not closed */
std::string function_text(const program &p, const target &t);
size_t stack_bytes(const program &p, const target &t); /* of its arrays */
std::string selftest_text(const std::vector<piece> &all, const target &t);

__attribute__((format(printf, 1, 2))) inline std::string format(const char *text, ...) {
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

/* The shortest that reads back as the same number. */
inline std::string literal(double x, bool is_float) {
    char text[40];
    if (is_float && float(x) == 0) x = 0; /* compilers warn of what float has not */
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (is_float ? strtof(text, nullptr) == float(x) : strtod(text, nullptr) == x) break;
    }
    std::string s = text;
    if (s.find_first_of(".en") == std::string::npos) s += ".0";
    return is_float ? s + "f" : s;
}

inline std::string upper(std::string s) {
    for (char &c : s) c = char(toupper(static_cast<unsigned char>(c)));
    return s;
}

/* one(0), one(1) and so on, n of them. */
template <class function> std::string join(size_t n, const std::string &between, function one) {
    std::string s;
    for (size_t k = 0; k < n; k++) s += (k ? between : "") + one(k);
    return s;
}

/* The arrays of a function: "const double q[restrict 7], double tau[restrict 7]"; or their names. */
inline std::string parameters(const function &f, const std::string &real, const char *before_size) {
    const std::vector<array> all = f.arrays();
    return (f.stances > 0 ? "int stance, " : "") + join(all.size(), ", ", [&](size_t k) {
               return format("%s%s %s[%s%d]", k < f.inputs.size() ? "const " : "", real.c_str(),
                             all[k].name.c_str(), before_size, all[k].size);
           });
}

inline std::string names(const function &f, const char *before = "") {
    const std::vector<array> all = f.arrays();
    return (f.stances > 0 ? before + std::string("stance, ") : "") +
           join(all.size(), ", ", [&](size_t k) { return before + all[k].name; });
}

inline const char *angle_limit(const target &t) { return t.is_float ? "1e4" : "1e6"; }

/* Before what these stances alone need, where those known run; 0: all. */
inline std::string only_if(const function &f, uint32_t stances, uint32_t known) {
    const uint32_t all = known ? known : uint32_t(-1) >> (32 - f.sets());
    return f.stances == 0 || stances == all ? "" : format("if (0x%xu >> stance & 1) ", unsigned(stances));
}

/* Of the header. */
inline std::string real_name(const target &t) {
    return t.lanes > 1 ? t.name + "_real" : t.is_float ? "float" : "double";
}

inline const char *result_type(const function &f) { return f.pivots.empty() ? "void" : "int"; }

} // namespace codegen
#endif
