// pinocchio_codegen.hpp - the functions that Pinocchio's code generation is asked for.
// SPDX-License-Identifier: MIT
#ifndef PEERS_PINOCCHIO_CODEGEN_HPP
#define PEERS_PINOCCHIO_CODEGEN_HPP

#include "../calls/library.h"

struct codegen_function {
    int algorithm;
    const char *name;
    int (*results)(int nv);
};

const codegen_function codegen_functions[] = {
    {ID, "id", [](int nv) { return nv; }},
    {MM, "mm", [](int nv) { return nv * (nv + 1) / 2; }},
    {FD, "fd", [](int nv) { return nv; }},
    {MINV, "minv", [](int nv) { return nv * (nv + 1) / 2; }},
    {ID_DERIVATIVES, "id_derivatives", [](int nv) { return 2 * nv * nv; }},
    {FD_DERIVATIVES, "fd_derivatives", [](int nv) { return 3 * nv * nv; }},
};

#endif
