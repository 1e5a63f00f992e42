/* graph.h - arithmetic as a graph, folded while it grows. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_GRAPH_H
#define TOOLS_CODEGEN_GRAPH_H

#include "rows.h"
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace codegen {

enum operation { CONSTANT, INPUT, ADD, MULTIPLY, DIVIDE, ROOT, SINE, COSINE, SELECT, GATHER, LANE, LOADED };

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
    value arg[4];
    double constant;
    bool is_vector;
};

inline bool has_operands(operation op) { return op != INPUT && op != LOADED; }

/* Every node stands once: what is equal is shared. Operands come before what uses them. */
class graph {
  public:
    std::vector<node> nodes;
    bool is_exact = false; /* only what no rounding changes is folded */
    bool is_float = false; /* what constants are rounded to then */

    value constant(double x);
    value input(int array, int element);
    value add(value a, value b);
    value multiply(value a, value b);
    value divide(value a, value b);
    value root(value a);
    value sine(value a, int quarters = 0); /* of a and as many right angles, which need is_exact */
    value cosine(value a, int quarters = 0);
    value select(value a, value b, value x, value y);
    value gather(value a, value b, value c, value d);
    value lane(value vector, int lane);
    value apply(const node &n, const value operands[4]); /* n's operation on other operands */
    value loaded(int at, int call);

    bool is_constant(value x) const { return nodes[size_t(node_of(x))].op == CONSTANT; }
    double constant_of(value x) const;
    value find_constant(double x) const; /* -1: there is none */

  private:
    struct hash {
        size_t operator()(const node &n) const;
    };
    struct same {
        bool operator()(const node &a, const node &b) const;
    };
    std::unordered_map<node, int, hash, same> table;

    value make(operation op, value a = -1, value b = -1, value c = -1, value d = -1, double x = 0);
    bool is(value x, double constant) const { return is_constant(x) && constant_of(x) == constant; }
    value scaled(double k, value x);
    value folded(double x) { return constant(is_exact && is_float ? double(float(x)) : x); }
};

/* ---- functions ---- */

struct array {
    std::string name;
    int size;
    const char *shape; /* for the header's reader */
};

/* One function to be written: a graph with names. */
struct function {
    std::string name, about;
    graph code;
    std::vector<array> inputs;
    std::vector<array> outputs;
    std::vector<value> results; /* of one output after the other */
    std::vector<value> pivots;  /* of the rows of constraints, the last first; of M, by degree of freedom */
    int rows_held;              /* of these constraints */
    std::vector<double> limits; /* that they must exceed */
    double noise;               /* limits relative to the most inertia that a joint can move */
    double clear;               /* limits of rows relative to them */
    std::vector<row_call> calls;
    int rows; /* scalars of their memory */

    std::vector<array> arrays() const; /* inputs and outputs */
    int nv;                            /* degrees of freedom */
    int stances; /* sets of constraints, of each of which there are results and pivots; 0: one */
    int sets() const { return stances > 0 ? stances : 1; }
    int judged() const { return int(pivots.size()) / sets(); } /* pivots of one */
    int dofs() const { return judged() - rows_held; }
    std::vector<value> wanted() const; /* results, pivots and what is stored for calls */
};

/* The results, computed in the scalar T; none if a pivot is not above its limit. in: an array for each
   input. */
template <class T>
std::vector<T> evaluate(const function &f, const std::vector<std::vector<double>> &in, int stance = 0);

} // namespace codegen
#endif
