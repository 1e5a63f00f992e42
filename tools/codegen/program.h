/* program.h - the statements that a graph becomes. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_PROGRAM_H
#define TOOLS_CODEGEN_PROGRAM_H

#include "graph.h"

namespace codegen {

/* Ways of writing that suit the target. */
struct style {
    bool long_sums; /* of up to eight terms: for machines that run several instructions at once */
};

/* a b, or a alone if b is -1; nodes. */
struct term {
    bool negative;
    int a, b;
};

/* Whose sine and cosine are wanted; quarters: node of the right angles to be added, or -1. */
struct wanted_angle {
    value x;
    value quarters;
    bool operator<(const wanted_angle &y) const { return x < y.x || (x == y.x && quarters < y.quarters); }
    bool operator==(const wanted_angle &y) const { return x == y.x && quarters == y.quarters; }
};

struct operations {
    int multiplications, additions, divisions, roots, angles, choices, of_vectors, of_fours;
};

/* Each node that is a statement has terms: a sum's; or one, the operands, of other operations. The order is
   the one recorded: every cleverer order was tried, and gained nothing. */
class program {
  public:
    const function &f;
    std::vector<char> is_statement;
    std::vector<std::vector<term>> terms;
    std::vector<char> flipped; /* the statement computes the node's negative */
    std::vector<wanted_angle> angles;
    std::vector<uint32_t>
        stances; /* of each node: those that need it, a bit each; none if the function has none */

    program(const function &f, const style &s);

    const node &at(int i) const { return f.code.nodes[size_t(i)]; }
    bool is_leaf(int i) const; /* what is there before all statements, and what rows hold */
    wanted_angle angle_of(int i) const { return {at(i).arg[0], at(i).arg[1]}; } /* of a sine or cosine */
    bool term_is_negative(int i, const term &t) const;
    int source_of(value x) const;                     /* the node that computes it */
    std::vector<int> operands(int i) const;           /* nodes that a statement uses, leaves among them */
    bool is_for_call(const row_call::store &s) const; /* stored before the call, not where it is computed */
    operations count() const;

  private:
    std::vector<int> uses;

    void mark();
    void gather_sums(int longest);
    void gather(int i, bool negative, bool top, std::vector<term> &t, int &room) const;
    void absorb(int i);
    void sort_by_depth();
    void choose_signs();
    void find_stances();
};

} // namespace codegen
#endif
