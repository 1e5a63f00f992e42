// quad.cpp - references without roundings of their own, for fuzz.cpp.
#include "quad.h"
#include <algorithm>
#include <cstring>
#include <stdexcept>

#define RBD_REAL __float128
#define RBD_CONST double
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"

#include "rbd_constraints.h"

namespace codegen {
namespace {
#include "../../tools/codegen/algorithms.h"
}
} // namespace codegen

std::vector<double> compute_quad(const codegen::robot &r, const std::string &name,
                                 const std::vector<std::vector<double>> &in, int stance) {
    codegen::session s(r, name, stance);
    const std::vector<rbd_real> y = codegen::results_for(&s, r, in);
    return std::vector<double>(y.begin(), y.end());
}
