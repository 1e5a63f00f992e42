/* emit.h - the C text of a set of functions. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_EMIT_H
#define TOOLS_CODEGEN_EMIT_H

#include "program.h"
#include "record.h"

namespace codegen {

struct target {
    std::string name;          /* what all names begin with */
    bool is_float, is_bounded; /* is_bounded: no angle is beyond what the polynomials take */
    bool is_reproducible;      /* the same bits wherever it is compiled: functions are of exact graphs */
    int lanes;                 /* 1: plain scalars */
    int limbs;                 /* like limbs of a state at once; 1: none are */
    int block;                 /* most statements of one C function */
    style statements;
};

/* A function, and states with rbd.h's results for them. */
struct tested {
    function f;
    std::vector<example> examples;
    double tolerance; /* of the self-test, relative to the largest result of an array, or to `least` */
    double least;
};

std::string declarations(const std::vector<tested> &functions, const target &t);
std::string definitions(const std::vector<tested> &functions, const target &t);

/* A main that calls a function at rest at q, and how to compile it. */
std::string example_command(const std::string &path); /* of the files: FOLDER/NAME */
std::string example_text(const function &f, const target &t, const std::vector<double> &q,
                         const std::vector<double> &gravity);

} // namespace codegen
#endif
