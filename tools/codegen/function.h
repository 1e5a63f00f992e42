/* function.h - one function to be written. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_FUNCTION_H
#define TOOLS_CODEGEN_FUNCTION_H

#include "graph.h"
#include "rows.h"
#include <string>

namespace codegen {

struct array {
    std::string name;
    int size;
    const char *shape; /* for the header's reader */
};

/* A graph with names. */
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

    int nv;      /* degrees of freedom */
    int stances; /* sets of constraints, of each of which there are results and pivots; 0: one */
    int sets() const { return stances > 0 ? stances : 1; }
    int judged() const { return int(pivots.size()) / sets(); } /* pivots of one */
    int dofs() const { return judged() - rows_held; }

    std::vector<array> arrays() const { /* inputs and outputs */
        std::vector<array> all = inputs;
        all.insert(all.end(), outputs.begin(), outputs.end());
        return all;
    }
    std::vector<value> wanted() const { /* results, pivots and what is stored for calls */
        std::vector<value> all = results;
        all.insert(all.end(), pivots.begin(), pivots.end());
        for (const row_call &c : calls)
            for (const row_call::store &s : c.stores) all.push_back(s.x);
        return all;
    }
};

/* The results, computed in the scalar T; none if a pivot is not above its limit. in: an array for each
   input. */
template <class T>
std::vector<T> evaluate(const function &f, const std::vector<std::vector<double>> &in, int stance = 0);

} // namespace codegen
#endif
