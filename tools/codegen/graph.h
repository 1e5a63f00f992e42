/* graph.h - arithmetic as a graph, folded while it grows. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_GRAPH_H
#define TOOLS_CODEGEN_GRAPH_H

#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <vector>

namespace codegen {

enum operation { CONSTANT, INPUT, ADD, MULTIPLY, DIVIDE, ROOT, SINE, COSINE, SELECT, GATHER, LANE, LOADED };

/* Sine and cosine of x and as many right angles: rbd.h's under RBD_REPRODUCIBLE. */
void own_sines(double x, double quarters, double *sine, double *cosine);
void own_sines(float x, float quarters, float *sine, float *cosine);

/* A node or its negative, 2 * node + sign: signs stand on the edges, so that no negation costs anything. */
typedef int value;
inline int node_of(value x) { return x >> 1; }
inline bool is_negative(value x) { return x & 1; }
inline value negated(value x, bool when = true) { return x ^ int(when); }

/* arg: operands, -1 where there are fewer; of an input its array and element. SELECT: arg[0] < arg[1] ?
   arg[2] : arg[3]. SINE, COSINE: if the graph is exact, arg[1] is a constant, the right angles to be added.
   GATHER: a vector of scalars; LANE: its element `constant`; sums, products and quotients of vectors are
   vectors. LOADED: arg[0] is a place in the memory of rows, arg[1] the call that wrote it. Operands of
   products and quotients, and the first of a sum, are never negative. */
struct node {
    operation op;
    std::array<value, 4> arg;
    double constant;
    bool is_vector;
    bool operator<(const node &y) const {
        return std::tie(op, arg, constant) < std::tie(y.op, y.arg, y.constant);
    }
};

inline bool has_operands(operation op) { return op != INPUT && op != LOADED; }

/* Every node stands once: what is equal is shared. Operands come before what uses them. */
class graph {
  public:
    std::vector<node> nodes;
    bool is_exact = false; /* only what no rounding changes is folded */
    bool is_float = false; /* what constants are rounded to then */

    bool is_constant(value x) const { return nodes[size_t(node_of(x))].op == CONSTANT; }
    double constant_of(value x) const {
        const double c = nodes[size_t(node_of(x))].constant;
        return is_negative(x) ? -c : c;
    }
    bool is(value x, double constant) const { return is_constant(x) && constant_of(x) == constant; }

    value constant(double x) {
        if (std::isnan(x)) /* which has no place in the order of nodes */
            throw std::runtime_error("a constant is not a number: the robot's lengths or masses overflow");
        return negated(make(CONSTANT, {-1, -1, -1, -1}, std::fabs(x)), x < 0);
    }
    value multiply(value a, value b) {
        if (is_constant(b)) std::swap(a, b);
        if (is(a, 0) || is(b, 1)) return a;
        if (is_constant(a) && is_constant(b)) return folded(constant_of(a) * constant_of(b));
        if (is(a, 1)) return b;
        if (is(a, -1)) return negated(b);
        return is_constant(a) ? scaled(constant_of(a), b) : product(a, b);
    }
    value lane(value vector, int lane) {
        return negated(make(LANE, {2 * node_of(vector), -1, -1, -1}, lane), is_negative(vector));
    }

    /* n's operation on other operands. */
    value apply(const node &n, const std::array<value, 4> &x) {
        switch (n.op) {
        case CONSTANT: return constant(n.constant);
        case INPUT:
        case LOADED: return make(n.op, n.arg);
        case ADD: return add(x[0], x[1]);
        case MULTIPLY: return multiply(x[0], x[1]);
        case DIVIDE: return divide(x[0], x[1]);
        case ROOT: return is_constant(x[0]) ? folded(std::sqrt(constant_of(x[0]))) : make(ROOT, x);
        case SINE:
        case COSINE: return turned(n.op, x[0], x[1]);
        case SELECT: return x[2] == x[3] ? x[2] : make(SELECT, x);
        case GATHER: return make(GATHER, x);
        default: return lane(x[0], int(n.constant));
        }
    }
    /* On of(operand) in place of each operand, the last first. */
    template <class function> value copy(const node &n, function of) {
        std::array<value, 4> x = {-1, -1, -1, -1};
        for (size_t k = 4; k-- > 0;)
            if (has_operands(n.op) && n.arg[k] >= 0) x[k] = of(n.arg[k]);
        return apply(n, x);
    }

  private:
    std::map<node, int> table;

    value make(operation op, const std::array<value, 4> &x, double constant = 0) {
        const bool of_vector = op >= ADD && op <= DIVIDE && nodes[size_t(node_of(x[0]))].is_vector;
        const auto found = table.emplace(node{op, x, constant, op == GATHER || of_vector}, int(nodes.size()));
        if (found.second) nodes.push_back(found.first->first);
        return 2 * found.first->second;
    }
    value folded(double x) { return constant(is_exact && is_float ? double(float(x)) : x); }

    value add(value a, value b) {
        if (is(a, 0)) return b;
        if (is(b, 0)) return a;
        if (is_constant(a) && is_constant(b)) return folded(constant_of(a) + constant_of(b));
        if (a == negated(b)) return constant(0);
        if (a == b) return scaled(2, a);
        if (node_of(a) > node_of(b)) std::swap(a, b);
        const bool sign = is_negative(a);
        return negated(make(ADD, {negated(a, sign), negated(b, sign), -1, -1}), sign);
    }
    value product(value a, value b) {
        const bool sign = is_negative(a) != is_negative(b);
        a = 2 * node_of(a), b = 2 * node_of(b);
        return negated(make(MULTIPLY, {std::min(a, b), std::max(a, b), -1, -1}), sign);
    }
    /* k x; of a product with a constant, that times k. */
    value scaled(double k, value x) {
        const node n = nodes[size_t(node_of(x))];
        for (size_t i = 0; i < 2 && n.op == MULTIPLY && !is_exact; i++)
            if (is_constant(n.arg[i]))
                return multiply(constant(k * constant_of(n.arg[i])), negated(n.arg[1 - i], is_negative(x)));
        return product(constant(k), x);
    }
    value divide(value a, value b) {
        const bool has_inverse = is_constant(b) && constant_of(b) != 0;
        if (has_inverse && !is_exact) return multiply(constant(1 / constant_of(b)), a);
        if (has_inverse && is_constant(a)) return folded(constant_of(a) / constant_of(b));
        if (is(b, 1) || is(a, 0)) return a;
        return negated(make(DIVIDE, {2 * node_of(a), 2 * node_of(b), -1, -1}),
                       is_negative(a) != is_negative(b));
    }
    /* Sine or cosine of a and as many right angles, which need is_exact. */
    value turned(operation op, value a, value quarters) {
        double own[2];
        if (is_exact && !is(a, 0)) return make(op, {a, quarters < 0 ? constant(0) : quarters, -1, -1});
        if (is_constant(a)) {
            own_sines(constant_of(a), quarters < 0 ? 0 : constant_of(quarters), &own[0], &own[1]);
            return constant(own[op == COSINE]);
        }
        return negated(make(op, {2 * node_of(a), -1, -1, -1}), op == SINE && is_negative(a));
    }
};

} // namespace codegen
#endif
