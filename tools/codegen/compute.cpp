/* rbd.h's own results in double, to hold the generated code against. SPDX-License-Identifier: MIT */
#include "record.h"
#include <algorithm>
#include <cstring>
#include <stdexcept>

#define RBD_REPRODUCIBLE
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"

namespace codegen {
namespace {

#include "algorithms.h"

/* In -1 to 1, the same on all machines. */
double draw(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return double(int32_t(*seed >> 32)) / 2147483648.0;
}

} // namespace

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names;
    for (const algorithm &row : algorithms)
        names.push_back(row.name + std::string(row.traits & BODY ? ":LINK" : ""));
    return names;
}

std::vector<joint> joints(const robot &r) {
    session s(r, "id");
    std::vector<joint> all;
    for (int b = 0; b < r.nb; b++) {
        rbd_joint_info x;
        session::demand(rbd_joint(s.m, b, &x));
        all.push_back({r.bodies[b].parent, x.iq, x.nq, x.iv, x.nv});
    }
    return all;
}

example compute(const robot &r, const std::string &name, unsigned state) {
    session s(r, name);
    example e;
    uint64_t seed = state + 1, configuration = state + 1;
    std::vector<double> x[ARGUMENTS];
    for (int k = 0; k < ARGUMENTS; k++) {
        const argument &a = arguments[k];
        if (!s.takes(r, a)) continue;
        x[k].resize(size_t(a.size(s.m)));
        for (double &y : x[k]) y = draw(&seed) * (a.letter == 'g' ? 10 : 2);
        if (a.letter == 'q') session::demand(rbd_random(s.m, &configuration, x[k].data()));
        e.in.push_back(x[k]);
    }
    session::demand(rbd_set_gravity(s.w, x[5].empty() ? r.gravity : x[5].data()));
    e.out = s.run(x);
    return e;
}

} // namespace codegen
