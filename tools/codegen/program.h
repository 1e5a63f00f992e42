/* program.h - the statements that a graph becomes. SPDX-License-Identifier: MIT

   Dead nodes go, sums become long, products stand inside the sums that use them, so that the compiler can
   fuse the two. */
#ifndef TOOLS_CODEGEN_PROGRAM_H
#define TOOLS_CODEGEN_PROGRAM_H

#include "codegen.h"
#include <algorithm>
#include <set>

namespace codegen {

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
};

struct operations {
    int multiplications, additions, divisions, roots, angles, of_vectors, of_fours;
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
    std::vector<uint32_t> stances; /* of each node: those that need it, a bit each; with stances */

    program(const function &f_, const target &t)
        : f(f_), is_statement(f_.code.nodes.size(), 0), terms(is_statement.size()), flipped(is_statement),
          stances(terms.size(), 0), uses(terms.size(), 0) {
        mark();
        gather_sums(t.long_sums ? 8 : 2);
        sort_by_depth();
        choose_signs();
        find_stances();
    }

    const node &at(int i) const { return f.code.nodes[size_t(i)]; }
    wanted_angle angle_of(int i) const { return {at(i).arg[0], at(i).arg[1]}; } /* of a sine or cosine */

    bool is_leaf(int i) const {
        const operation op = at(i).op;
        if (op == GATHER)
            return std::all_of(at(i).arg.begin(), at(i).arg.end(),
                               [this](value x) { return x < 0 || at(node_of(x)).op == CONSTANT; });
        return op == CONSTANT || op == INPUT || op == SINE || op == COSINE || op == LOADED;
    }

    bool term_is_negative(int i, const term &t) const {
        const bool a = flipped[size_t(t.a)], b = t.b >= 0 && flipped[size_t(t.b)];
        return (t.negative != flipped[size_t(i)]) != (a != b);
    }

    /* Of a lane that of its vector. */
    int source_of(value x) const {
        const int i = node_of(x);
        return at(i).op == LANE ? node_of(at(i).arg[0]) : i;
    }

    std::vector<int> operands(int i) const {
        std::vector<int> all;
        for (const term &t : terms[size_t(i)]) {
            all.push_back(source_of(2 * t.a));
            if (t.b >= 0) all.push_back(source_of(2 * t.b));
        }
        return all;
    }

    bool is_for_call(const row_call::store &s) const { return !is_statement[size_t(source_of(s.x))]; }

    operations count() const {
        operations n = {0, 0, 0, 0, int(angles.size()), 0, 0};
        for (const row_call &c : f.calls) n.of_fours += count_fours(c), n.divisions += count_inverses(c);
        for (int i = 0; i < int(terms.size()); i++) {
            if (!is_statement[size_t(i)]) continue;
            const operation op = at(i).op;
            const int before = n.additions + n.multiplications + n.divisions;
            if (op == ADD) n.additions += int(terms[size_t(i)].size()) - 1;
            for (const term &t : terms[size_t(i)])
                if (op == MULTIPLY || (op == ADD && t.b >= 0)) n.multiplications++;
            n.divisions += op == DIVIDE;
            if (at(i).is_vector) n.of_vectors += n.additions + n.multiplications + n.divisions - before;
            n.roots += op == ROOT;
        }
        return n;
    }

  private:
    std::vector<int> uses;

    /* Nodes that results need, and how often each is used. */
    void mark() {
        std::set<wanted_angle> all;
        const auto use = [this](value x) {
            if (x >= 0) is_statement[size_t(node_of(x))] = 1, uses[size_t(node_of(x))]++;
        };
        for (value x : f.wanted()) use(x);
        for (int i = int(f.code.nodes.size()) - 1; i >= 0; i--) {
            const node &n = at(i);
            if (!is_statement[size_t(i)]) continue;
            if (n.op == SINE || n.op == COSINE) all.insert(angle_of(i));
            if (is_leaf(i) || n.op == LANE) is_statement[size_t(i)] = 0;
            if (is_leaf(i)) continue;
            for (value x : n.arg) use(x);
        }
        angles.assign(all.begin(), all.end());
    }

    /* The terms of a sum: sums and products that are used but once open up, as long as there is room, and are
       no statements any more. */
    void gather(int i, bool negative, std::vector<term> &t, int &room) {
        const node &n = at(i);
        if (uses[size_t(i)] > 1 || !(n.op == MULTIPLY || (n.op == ADD && room > 0))) {
            t.push_back({negative, i, -1});
            return;
        }
        is_statement[size_t(i)] = 0;
        if (n.op == MULTIPLY)
            t.push_back({negative, node_of(n.arg[0]), node_of(n.arg[1])});
        else
            room--, gather_both(n, negative, t, room);
    }
    void gather_both(const node &n, bool negative, std::vector<term> &t, int &room) {
        for (value x : {n.arg[0], n.arg[1]}) gather(node_of(x), negative != is_negative(x), t, room);
    }

    void gather_sums(int longest) {
        for (int i = int(terms.size()) - 1; i >= 0; i--) {
            const node &n = at(i);
            int room = longest - 2;
            if (!is_statement[size_t(i)]) continue;
            if (n.op == ADD) gather_both(n, false, terms[size_t(i)], room);
            for (int k = 0; n.op != ADD && k < 4 && n.arg[k] >= 0; k += 2)
                terms[size_t(i)].push_back(
                    {false, node_of(n.arg[k]), n.arg[k + 1] < 0 ? -1 : node_of(n.arg[k + 1])});
        }
    }

    /* In a sum what is ready last comes last. */
    void sort_by_depth() {
        std::vector<int> depth(terms.size(), 0);
        const auto of = [&](const term &t) {
            return std::max(depth[size_t(t.a)], t.b < 0 ? 0 : depth[size_t(t.b)]);
        };
        for (int i = 0; i < int(terms.size()); i++) {
            std::vector<term> &t = terms[size_t(i)];
            if (at(i).op == LANE) depth[size_t(i)] = depth[size_t(source_of(2 * i))] + 1;
            if (!is_statement[size_t(i)]) continue;
            if (at(i).op == ADD)
                std::stable_sort(t.begin(), t.end(),
                                 [&](const term &x, const term &y) { return of(x) < of(y); });
            for (const term &x : t) depth[size_t(i)] = std::max(depth[size_t(i)], of(x) + 1);
        }
    }

    /* A sum may stand for its negative: where all its terms are negative, or the result that it is. */
    void choose_signs() {
        std::vector<int> wanted(terms.size(), 0);
        for (value x : f.results) wanted[size_t(source_of(x))] += is_negative(x) ? 1 : -1;
        for (int i = 0; i < int(terms.size()); i++) {
            if (at(i).op == LANE) flipped[size_t(i)] = flipped[size_t(source_of(2 * i))];
            if (!is_statement[size_t(i)]) continue;
            const std::vector<term> &t = terms[size_t(i)];
            const auto negative =
                std::count_if(t.begin(), t.end(), [&](const term &x) { return term_is_negative(i, x); });
            if (at(i).op == ADD)
                flipped[size_t(i)] = negative == int(t.size()) || (negative > 0 && wanted[size_t(i)] > 0);
            else if (at(i).op == MULTIPLY || at(i).op == DIVIDE)
                flipped[size_t(i)] = negative > 0;
        }
    }

    void find_stances() {
        for (const std::vector<value> *all : {&f.results, &f.pivots})
            for (size_t k = 0; k < all->size() && f.stances > 0; k++)
                stances[size_t(source_of((*all)[k]))] |= 1u << k / (all->size() / size_t(f.stances));
        for (int i = int(terms.size()) - 1; i >= 0; i--)
            if (is_statement[size_t(i)])
                for (int k : operands(i)) stances[size_t(k)] |= stances[size_t(i)];
    }
};

} // namespace codegen
#endif
