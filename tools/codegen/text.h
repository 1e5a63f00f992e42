/* text.h - what the files that write C share. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_TEXT_H
#define TOOLS_CODEGEN_TEXT_H

#include "program.h"

namespace codegen {

/* A function, and its statements. */
struct piece {
    const tested &x;
    program p;
};

std::string format(const char *text, ...) __attribute__((format(printf, 1, 2)));
std::string literal(double x, bool is_float); /* the shortest that reads back as the same number */
std::string upper(std::string s);

/* one(0), one(1) and so on, n of them. */
template <class function> std::string join(size_t n, const std::string &between, function one) {
    std::string s;
    for (size_t k = 0; k < n; k++) s += (k ? between : "") + one(k);
    return s;
}

/* The arrays of a function: "const double q[restrict 7], double tau[restrict 7]"; or their names. */
std::string parameters(const function &f, const std::string &real, const char *before_size);
std::string names(const function &f, const char *before = "");
std::string only_if(const function &f, uint32_t stances, uint32_t known); /* it is one of those known, or 0 */
const char *result_type(const function &f);
std::string real_name(const target &t); /* of the header */

std::string common_text(const std::vector<piece> &all, const target &t); /* what all functions use */
std::string sines_text(const target &t);
std::string function_text(const program &p, const target &t);
size_t stack_bytes(const program &p, const target &t); /* of its arrays */
std::string selftest_text(const std::vector<piece> &all, const target &t);

} // namespace codegen
#endif
