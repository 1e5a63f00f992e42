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

rbd_status run_constrained_id(const call &c) {
    return rbd_constrained_id(c.m, c.set, c.q, c.v, c.a, c.f_ext, c.actuated, NULL, c.out[0], c.out[1]);
}

/* In -1 to 1, the same on all machines. */
double draw(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return double(int32_t(*seed >> 32)) / 2147483648.0;
}

/* Draws an array for each argument. */
void draw_arguments(const robot &r, const session &s, unsigned state, std::vector<double> x[ARGUMENTS]) {
    uint64_t seed = state + 1, configuration = state + 1;
    for (int k = 0; k < ARGUMENTS; k++) {
        if (!s.takes(r, k)) continue;
        x[k].resize(size_t(arguments[k].size(s.c)));
        for (double &y : x[k]) y = draw(&seed) * (k == GRAVITY ? 10 : 2);
        if (k == RESTITUTION) x[k][0] = 0.5 + x[k][0] / 4;
        if (k == Q) demand(rbd_random(s.c.m, &configuration, x[k].data()));
    }
}

} // namespace

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names;
    for (const algorithm &row : algorithms)
        names.push_back(row.name + std::string(row.traits & BODY ? ":LINK" : ""));
    return names;
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

/* Rows of a factor of G, each the one with the largest share of its entry that those before leave. */
std::vector<bool> largest_rows(const std::vector<column> &G) {
    std::vector<bool> taken(G.size(), false);
    for (;;) {
        const std::vector<column> L = factor_of(G, [&](size_t k, double, double) { return bool(taken[k]); });
        double share = RBDI_CLEAR;
        size_t best = G.size();
        for (size_t k = 0; k < G.size(); k++) {
            const double left = G[k][k] - sum_of(L.size(), [&](size_t t) { return L[t][k] * L[t][k]; });
            if (!taken[k] && left > share * G[k][k]) best = k, share = left / G[k][k];
        }
        if (best == G.size()) return taken;
        taken[best] = true;
    }
}

/* The least share of these rows. */
double least_share(const std::vector<column> &G, const std::vector<bool> &taken) {
    double least = 1;
    factor_of(G, [&](size_t k, double pivot, double entry) {
        if (taken[k]) least = std::fmin(least, std::fmax(pivot / entry, 1e-16));
        return bool(taken[k]);
    });
    return least;
}

std::vector<bool> independent_joints(const robot &r, int stance) {
    enum { TRIED = 20 };
    std::vector<std::vector<column>> G;
    std::vector<bool> best;
    double best_score = -HUGE_VAL;
    for (unsigned state = 0; state < TRIED; state++) {
        std::vector<double> x[ARGUMENTS];
        session s(r, "constrained_id", stance);
        draw_arguments(r, s, state, x);
        s.c.q = x[Q].data();
        G.push_back(products_of(passive_columns(s.c, jacobian_of(s.c))));
    }
    for (const std::vector<column> &own : G) {
        const std::vector<bool> taken = largest_rows(own);
        double score = 1e6 * double(std::count(taken.begin(), taken.end(), true));
        for (const std::vector<column> &other : G) score += std::log(least_share(other, taken));
        if (score > best_score) best = taken, best_score = score;
    }
    return best;
}

example compute(const robot &r, const std::string &name, const std::vector<std::vector<double>> &in,
                int stance) {
    session s(r, name, stance);
    std::vector<double> x[ARGUMENTS];
    size_t given = 0;
    for (int k = 0; k < ARGUMENTS; k++)
        if (s.takes(r, k)) x[k] = in[given++];
    demand(rbd_set_gravity(s.c.w, x[GRAVITY].empty() ? r.gravity : x[GRAVITY].data()));
    example e = {in, s.run(x, s.row->run), stance, 0, 0};
    if (s.c.set) e.rows = rbd_constraint_rows(s.c.set), e.rank = rbd_constraint_rank(s.c.set);
    return e;
}

example compute(const robot &r, const std::string &name, unsigned state, int stance) {
    session s(r, name, stance);
    std::vector<double> x[ARGUMENTS];
    std::vector<std::vector<double>> in;
    draw_arguments(r, s, state, x);
    for (const std::vector<double> &y : x)
        if (!y.empty()) in.push_back(y);
    return compute(r, name, in, stance);
}

} // namespace codegen
