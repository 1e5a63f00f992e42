/* Arithmetic as a graph: folding, sharing, evaluation. SPDX-License-Identifier: MIT */
#include "graph.h"
#include "own_sines.h"
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace codegen {

size_t graph::hash::operator()(const node &n) const {
    uint64_t bits, h = uint64_t(n.op);
    std::memcpy(&bits, &n.constant, sizeof bits);
    for (value x : n.arg) h = (h ^ uint64_t(x + 1)) * UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ bits) * UINT64_C(0xbf58476d1ce4e5b9);
    return size_t(h ^ h >> 31);
}

bool graph::same::operator()(const node &a, const node &b) const {
    return a.op == b.op && std::memcmp(a.arg, b.arg, sizeof a.arg) == 0 && a.constant == b.constant;
}

value graph::make(operation op, value a, value b, value c, value d, double x) {
    const bool of_vector = op >= ADD && op <= DIVIDE && nodes[size_t(node_of(a))].is_vector;
    const node n = {op, {a, b, c, d}, x, op == GATHER || of_vector};
    const auto found = table.emplace(n, int(nodes.size()));
    if (found.second) nodes.push_back(n);
    return 2 * found.first->second;
}

value graph::constant(double x) { return negated(make(CONSTANT, -1, -1, -1, -1, std::fabs(x)), x < 0); }
double graph::constant_of(value x) const {
    const double c = nodes[size_t(node_of(x))].constant;
    return is_negative(x) ? -c : c;
}
value graph::find_constant(double x) const {
    const auto found = table.find({CONSTANT, {-1, -1, -1, -1}, std::fabs(x), false});
    return found == table.end() ? -1 : 2 * found->second + (x < 0);
}
value graph::input(int array, int element) { return make(INPUT, array, element); }

value graph::add(value a, value b) {
    if (is(a, 0)) return b;
    if (is(b, 0)) return a;
    if (is_constant(a) && is_constant(b)) return folded(constant_of(a) + constant_of(b));
    if (a == negated(b)) return constant(0);
    if (a == b) return scaled(2, a);
    if (node_of(a) > node_of(b)) std::swap(a, b);
    const bool sign = is_negative(a);
    return negated(make(ADD, negated(a, sign), negated(b, sign)), sign);
}

/* k x; of a product with a constant, that times k. */
value graph::scaled(double k, value x) {
    const node &n = nodes[size_t(node_of(x))];
    if (n.op == MULTIPLY && !is_exact)
        for (int i = 0; i < 2; i++)
            if (is_constant(n.arg[i])) {
                const value rest = n.arg[1 - i];
                return multiply(constant(k * constant_of(n.arg[i])), negated(rest, is_negative(x)));
            }
    const value c = constant(k);
    const bool sign = is_negative(c) != is_negative(x);
    value a = 2 * node_of(c), b = 2 * node_of(x);
    if (a > b) std::swap(a, b);
    return negated(make(MULTIPLY, a, b), sign);
}

value graph::multiply(value a, value b) {
    if (is_constant(b)) std::swap(a, b);
    if (is(a, 0) || is(b, 1)) return a;
    if (is_constant(a) && is_constant(b)) return folded(constant_of(a) * constant_of(b));
    if (is(a, 1)) return b;
    if (is(a, -1)) return negated(b);
    if (is_constant(a)) return scaled(constant_of(a), b);
    const bool sign = is_negative(a) != is_negative(b);
    a = 2 * node_of(a), b = 2 * node_of(b);
    if (a > b) std::swap(a, b);
    return negated(make(MULTIPLY, a, b), sign);
}

value graph::divide(value a, value b) {
    if (is_constant(b) && constant_of(b) != 0 && !is_exact) return multiply(constant(1 / constant_of(b)), a);
    if (is_constant(a) && is_constant(b) && constant_of(b) != 0)
        return folded(constant_of(a) / constant_of(b));
    if (is(b, 1)) return a;
    if (is(a, 0)) return a;
    return negated(make(DIVIDE, 2 * node_of(a), 2 * node_of(b)), is_negative(a) != is_negative(b));
}

value graph::root(value a) { return is_constant(a) ? folded(std::sqrt(constant_of(a))) : make(ROOT, a); }

static double own_sine(double x, double quarters) {
    double sine, cosine;
    own_sines(x, quarters, &sine, &cosine);
    return sine;
}
value graph::sine(value a, int quarters) {
    static const int of_zero[] = {0, 1, 0, -1};
    if (is_exact) return is(a, 0) ? constant(of_zero[quarters]) : make(SINE, a, constant(quarters));
    if (is_constant(a)) return constant(own_sine(constant_of(a), 0));
    return negated(make(SINE, 2 * node_of(a)), is_negative(a));
}
value graph::cosine(value a, int quarters) {
    if (is_exact) return is(a, 0) ? sine(a, (quarters + 1) % 4) : make(COSINE, a, constant(quarters));
    return is_constant(a) ? constant(own_sine(constant_of(a), 1)) : make(COSINE, 2 * node_of(a));
}

value graph::select(value a, value b, value x, value y) { return x == y ? x : make(SELECT, a, b, x, y); }

value graph::gather(value a, value b, value c, value d) { return make(GATHER, a, b, c, d); }
value graph::lane(value vector, int lane) {
    return negated(make(LANE, 2 * node_of(vector), -1, -1, -1, lane), is_negative(vector));
}
value graph::loaded(int at, int call) { return make(LOADED, at, call); }

std::vector<array> function::arrays() const {
    std::vector<array> all = inputs;
    all.insert(all.end(), outputs.begin(), outputs.end());
    return all;
}

std::vector<value> function::wanted() const {
    std::vector<value> all = results;
    all.insert(all.end(), pivots.begin(), pivots.end());
    for (const row_call &c : calls)
        for (const row_call::store &s : c.stores) all.push_back(s.x);
    return all;
}

value graph::apply(const node &n, const value x[4]) {
    const int quarters = (n.op == SINE || n.op == COSINE) && n.arg[1] >= 0 ? int(constant_of(x[1])) : 0;
    switch (n.op) {
    case CONSTANT: return constant(n.constant);
    case INPUT: return input(n.arg[0], n.arg[1]);
    case LOADED: return loaded(n.arg[0], n.arg[1]);
    case ADD: return add(x[0], x[1]);
    case MULTIPLY: return multiply(x[0], x[1]);
    case DIVIDE: return divide(x[0], x[1]);
    case ROOT: return root(x[0]);
    case SINE: return sine(x[0], quarters);
    case COSINE: return cosine(x[0], quarters);
    case SELECT: return select(x[0], x[1], x[2], x[3]);
    case GATHER: return gather(x[0], x[1], x[2], x[3]);
    case LANE: return lane(x[0], int(n.constant));
    }
    std::abort();
}

/* ---- evaluation ---- */

template <class T>
std::vector<T> evaluate(const function &f, const std::vector<std::vector<double>> &in, int stance) {
    enum { LANES = 4 }; /* of scalars all the same */
    std::vector<T> x(LANES * f.code.nodes.size()), rows(size_t(f.rows)), results;
    size_t call = 0;
    const auto of = [&](value v, int l) {
        const T y = x[size_t(LANES * node_of(v) + l)];
        return is_negative(v) ? -y : y;
    };
    for (size_t i = 0; i < x.size(); i++) {
        const node &n = f.code.nodes[i / LANES];
        const value *a = n.arg;
        const int l = int(i % LANES);
        for (; call < f.calls.size() && f.calls[call].node <= int(i / LANES); call++) {
            for (const row_call::store &s : f.calls[call].stores) rows[size_t(s.at)] = of(s.x, 0);
            run(f.calls[call], rows);
        }
        switch (n.op) {
        case CONSTANT: x[i] = T(n.constant); break;
        case INPUT: x[i] = T(in[size_t(a[0])][size_t(a[1])]); break;
        case ADD: x[i] = of(a[0], l) + of(a[1], l); break;
        case MULTIPLY: x[i] = of(a[0], l) * of(a[1], l); break;
        case DIVIDE: x[i] = of(a[0], l) / of(a[1], l); break;
        case ROOT: x[i] = std::sqrt(of(a[0], l)); break;
        case SINE:
        case COSINE: {
            T own[2];
            own_sines(of(a[0], l), a[1] >= 0 ? of(a[1], l) : T(0), &own[0], &own[1]);
            x[i] = own[n.op == COSINE];
            break;
        }
        case SELECT: x[i] = of(a[0], l) < of(a[1], l) ? of(a[2], l) : of(a[3], l); break;
        case GATHER: x[i] = a[l] < 0 ? 0 : of(a[l], 0); break;
        case LANE: x[i] = of(a[0], int(n.constant)); break;
        case LOADED: x[i] = rows[size_t(a[0])]; break;
        }
    }
    const size_t judged = size_t(f.judged()), n = f.results.size() / size_t(f.sets());
    for (size_t k = 0; k < judged; k++)
        if (!(of(f.pivots[size_t(stance) * judged + k], 0) > T(f.limits[k]))) return {};
    for (size_t k = 0; k < n; k++) results.push_back(of(f.results[size_t(stance) * n + k], 0));
    return results;
}
template std::vector<double> evaluate<double>(const function &, const std::vector<std::vector<double>> &,
                                              int);
template std::vector<float> evaluate<float>(const function &, const std::vector<std::vector<double>> &, int);

} // namespace codegen
