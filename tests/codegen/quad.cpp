// quad.cpp - rbd.h's results in quad precision for fuzz.cpp: references without roundings of their own.
#include "../../tools/codegen/codegen.h"
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

rbd_status run_constrained_id(const call &c) {
    return rbd_constrained_id(c.m, c.set, c.q, c.v, c.a, c.f_ext, c.actuated, NULL, c.out[0], c.out[1]);
}

} // namespace

} // namespace codegen

/* Rounded to double; in: an array for each input of the function. */
std::vector<double> compute_quad(const codegen::robot &r, const std::string &name, const codegen::function &f,
                                 const std::vector<std::vector<double>> &in, int stance);
std::vector<double> compute_quad(const codegen::robot &r, const std::string &name, const codegen::function &f,
                                 const std::vector<std::vector<double>> &in, int stance) {
    using namespace codegen;
    session s(r, name, stance);
    std::vector<rbd_real> x[ARGUMENTS];
    const double *gravity = r.gravity;
    for (size_t i = 0; i < in.size(); i++)
        for (int k = 0; k < ARGUMENTS; k++)
            if (f.inputs[i].name == arguments[k].name) x[k].assign(in[i].begin(), in[i].end());
    for (size_t i = 0; i < in.size(); i++)
        if (f.inputs[i].name == "gravity") gravity = in[i].data();
    if (rbd_set_gravity(s.c.w, gravity) != RBD_OK) throw std::runtime_error("gravity");
    const std::vector<rbd_real> y = s.run(x, s.row->run);
    return std::vector<double>(y.begin(), y.end());
}
