/* rbd.h's own results in double, to hold the generated code against. SPDX-License-Identifier: MIT */
#include "record.h"
#include <stdexcept>

#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"

namespace codegen {
namespace {

#include "algorithms.h"

void demand(rbd_status status) {
    if (status != RBD_OK) throw std::runtime_error(rbd_status_string(status));
}

/* In -1 to 1, the same on all machines. */
double draw(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return double(int32_t(*seed >> 32)) / 2147483648.0;
}

} // namespace

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names;
    for (const algorithm &row : algorithms) names.push_back(row.name);
    return names;
}

example compute(const robot &r, const std::string &name, unsigned state) {
    std::vector<unsigned char> model_memory(rbd_model_size(r.bodies, r.nb)), work_memory;
    const rbd_model *m;
    rbd_work *w;
    demand(rbd_model_build(r.bodies, r.nb, model_memory.data(), model_memory.size(), &m, NULL));
    work_memory.resize(rbd_work_size(m));
    demand(rbd_work_init(m, work_memory.data(), work_memory.size(), &w));
    demand(rbd_set_gravity(w, r.gravity));

    example e;
    uint64_t seed = state + 1, configuration = state + 1;
    std::vector<double> x[sizeof arguments / sizeof *arguments];
    for (const algorithm &row : algorithms) {
        if (name != row.name) continue;
        for (size_t i = 0; i < sizeof arguments / sizeof *arguments; i++) {
            const char letter = arguments[i].letter;
            std::vector<double> &y = x[i];
            y.resize(size_t(arguments[i].size(m)));
            for (double &k : y) k = draw(&seed) * (letter == 'g' ? 10 : 2);
            if (letter == 'q') demand(rbd_random(m, &configuration, y.data()));
            const bool wanted = letter == 'f' ? r.f_ext : letter == 'g' ? r.gravity_argument : true;
            if (std::string(row.arguments).find(letter) != std::string::npos && wanted) e.in.push_back(y);
        }
        if (r.gravity_argument) demand(rbd_set_gravity(w, x[5].data()));
        e.out.resize(size_t(row.size(m)));
        demand(row.run({m, w, x[0].data(), x[1].data(), x[2].data(), x[3].data(),
                        r.f_ext ? x[4].data() : NULL, e.out.data()}));
    }
    return e;
}

} // namespace codegen
