/* rbd.h's own results in double, to hold the generated code against. SPDX-License-Identifier: MIT */
#include "codegen.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#define RBD_REPRODUCIBLE
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"

#include "rbd_constraints.h"

namespace codegen {
namespace {

#include "algorithms.h"
#include "held.h"

/* In -1 to 1, the same on all machines. */
double draw(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return double(int32_t(*seed >> 32)) / 2147483648.0;
}

/* An array for each argument. */
std::vector<std::vector<double>> draw_arguments(const robot &r, const session &s, unsigned state) {
    uint64_t seed = state + 1, configuration = state + 1;
    std::vector<std::vector<double>> all;
    for (int k = 0; k < ARGUMENTS; k++) {
        if (!s.takes(r, k)) continue;
        std::vector<double> x(size_t(arguments[k].size(s.c)));
        for (double &y : x) y = draw(&seed) * (k == GRAVITY ? 10 : 2);
        if (k == RESTITUTION) x[0] = 0.5 + x[0] / 4;
        if (k == Q) demand(rbd_random(s.c.m, &configuration, x.data()));
        all.push_back(x);
    }
    return all;
}

} // namespace

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names;
    for (const algorithm &row : algorithms)
        names.push_back(row.name + std::string(row.traits & BODY ? ":LINK" : ""));
    return names;
}

std::string name_in_c(std::string name) {
    for (char &c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

bool takes_constraints(const std::string &name) { return row_of(name) && row_of(name)->traits & HELD; }
bool takes_stances(const std::string &name) {
    return row_of(name) && (row_of(name)->traits & ALL_HELD) == HELD;
}

std::vector<joint> joints(const robot &r) {
    session s(r, "id");
    std::vector<joint> all;
    for (int b = 0; b < r.nb; b++) {
        rbd_joint_info x;
        demand(rbd_joint(s.c.m, b, &x));
        all.push_back({r.bodies[b].parent, x.iq, x.nq, x.iv, x.nv});
    }
    return all;
}

/* The share of its entry that a row of G keeps behind those taken. */
static double share_of(const std::vector<column> &G, const std::vector<bool> &taken, size_t k) {
    const std::vector<column> L = factor_of(G, [&](size_t i, double, double) { return bool(taken[i]); });
    return 1 - sum_of(L.size(), [&](size_t t) { return L[t][k] * L[t][k]; }) / G[k][k];
}

/* One after the other, the joint that keeps most in all states: the last of several, for those of a free base
   that shift it do so in any state. */
std::vector<bool> independent_joints(const robot &r, int stance) {
    enum { TRIED = 20 };
    std::vector<std::vector<column>> states;
    for (unsigned state = 0; state < TRIED; state++) {
        session s(r, "constrained_id", stance);
        const std::vector<std::vector<double>> x = draw_arguments(r, s, state);
        s.c.q = x[Q].data();
        states.push_back(products_of(passive_columns(s.c, jacobian_of(s.c))));
    }
    const size_t n = states[0].size();
    std::vector<bool> taken(n, false);
    for (;;) {
        double most = TRIED * std::log(RBDI_CLEAR);
        size_t best = n;
        for (size_t k = 0; k < n; k++) {
            double score = 0;
            for (const std::vector<column> &G : states)
                score += std::log(std::fmax(share_of(G, taken, k), 1e-16));
            if (!taken[k] && score >= most) best = k, most = score;
        }
        if (best == n) return taken;
        taken[best] = true;
    }
}

example compute(const robot &r, const std::string &name, const std::vector<std::vector<double>> &in,
                int stance) {
    session s(r, name, stance);
    example e = {in, results_for(&s, r, in), stance, 0, 0};
    if (s.c.set) e.rows = rbd_constraint_rows(s.c.set), e.rank = rbd_constraint_rank(s.c.set);
    return e;
}

example compute(const robot &r, const std::string &name, unsigned state, int stance) {
    return compute(r, name, draw_arguments(r, session(r, name, stance), state), stance);
}

} // namespace codegen
