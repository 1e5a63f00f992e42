/* statements.h - values and statements as C. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_STATEMENTS_H
#define TOOLS_CODEGEN_STATEMENTS_H

#include "blocks.h"
#include "text.h"
#include <map>

namespace codegen {

class statements {
  public:
    std::vector<std::string> name; /* of each statement's value, once it has one */

    statements(const program &p_, const target &t_) : name(p_.f.code.nodes.size()), p(p_), t(t_) {
        const function &f = p.f;
        for (size_t k = 0; k < p.angles.size(); k++) angle[p.angles[k]] = int(k);
        size_t first = 0, judged = 0;
        for (int set = 0; set < f.sets(); set++) {
            for (const array &a : f.outputs)
                for (int k = 0; k < a.size; k++, first++)
                    if (!is_copied(f.results[first]) && !is_cleared(f.results[first]))
                        store_at(f.results[first], a.name, size_t(k), 1u << set);
            for (int k = 0; k < f.judged(); k++) store_at(f.pivots[judged++], "pivot", size_t(k), 1u << set);
        }
        for (const row_call &c : f.calls)
            for (const row_call::store &s : c.stores)
                if (!p.is_for_call(s)) store_at(s.x, "rows", size_t(s.at), 1);
    }

    void begin_block() { named = 0; } /* short names, for they are half of the text */

    std::string of(value x) const {
        const int i = node_of(x);
        const std::string s = (is_negative(x) != bool(p.flipped[size_t(i)]) ? "-" : "") + unsigned_of(i);
        return p.at(i).op == CONSTANT && t.lanes > 1 ? "splat(" + s + ")" : s;
    }

    std::string of_angle(value x) const {
        const node &n = p.at(node_of(x));
        const std::string sign = is_negative(x) ? "-" : "";
        if (n.op == ADD) return sign + "(" + of_angle(n.arg[0]) + " + " + of_angle(n.arg[1]) + ")";
        if (n.op == MULTIPLY) return sign + of_angle(n.arg[0]) + " * " + of_angle(n.arg[1]);
        return sign + leaf(node_of(x));
    }

    std::string statement(int i) {
        name[size_t(i)] = format("t%d", named++);
        return (p.at(i).is_vector ? "    limbs " : "    real ") + name[size_t(i)] + " = " + expression(i) +
               ";\n" + stores_of(i);
    }

    std::string stores_of_others() const {
        std::string s;
        for (const auto &x : stores)
            if (!p.is_statement[size_t(x.first)]) s += stores_of(x.first);
        return s;
    }

    /* A result that stands in rows. */
    bool is_copied(value x) const { return p.at(node_of(x)).op == LOADED && !is_negative(x); }

    /* A zero, which is stored before all statements. With stances it may be zero in some of them alone. */
    bool is_cleared(value x) const {
        return t.lanes == 1 && !t.is_cuda && p.f.stances == 0 && p.f.code.is(x, 0);
    }

  private:
    const program &p;
    const target &t;
    int named = 0;                     /* statements of the block */
    std::map<wanted_angle, int> angle; /* its index among the angles */
    struct store {
        std::string array;
        size_t k;
        bool negative;
        int lane; /* of a vector; or -1 */
        uint32_t stances;
    };
    std::map<int, std::vector<store>> stores; /* of a node */

    std::string leaf(int i) const {
        const node &n = p.at(i);
        switch (n.op) {
        case CONSTANT: return literal(n.constant, t.is_float);
        case GATHER: return "(limbs){" + elements(i) + "}";
        case LOADED: return format("rows[%d]", n.arg[0]);
        case INPUT: return format("%s[%d]", p.f.inputs[size_t(n.arg[0])].name.c_str(), n.arg[1]);
        default: return format("%s[%d]", n.op == SINE ? "sine" : "cosine", angle.at(p.angle_of(i)));
        }
    }

    std::string unsigned_of(int i) const {
        const node &n = p.at(i);
        if (n.op == LANE) return unsigned_of(node_of(n.arg[0])) + format("[%d]", int(n.constant));
        return p.is_leaf(i) ? leaf(i) : name[size_t(i)];
    }

    std::string elements(int i) const {
        return join(size_t(t.limbs), ", ", [&](size_t l) { return of(p.at(i).arg[l]); });
    }

    /* A vector of scalars; "side_by_side(v[6])" where they stand one behind the other. */
    std::string gathered(int i) const {
        const value x = p.at(i).arg[0];
        const std::string first = of(x), all = elements(i), array = first.substr(0, first.find('['));
        const bool is_place = p.is_leaf(node_of(x)) && !is_negative(x) && array != first;
        const int k = is_place ? atoi(first.c_str() + array.size() + 1) : 0;
        const auto next = [&](size_t l) { return format("%s[%zu]", array.c_str(), size_t(k) + l); };
        return is_place && all == join(size_t(t.limbs), ", ", next) ? "side_by_side(" + first + ")"
                                                                    : "(limbs){" + all + "}";
    }

    /* First a term that is no product and positive, for what follows to be fused to; else what is there. */
    std::string sum(int i) const {
        std::vector<term> all = p.terms[size_t(i)];
        const auto rank = [&](const term &x) { return 2 * p.term_is_negative(i, x) + (x.b >= 0); };
        const auto first = std::min_element(all.begin(), all.end(),
                                            [&](const term &x, const term &y) { return rank(x) < rank(y); });
        std::rotate(all.begin(), first, first + 1);
        std::string s;
        for (size_t k = 0; k < all.size(); k++) {
            const bool negative = p.term_is_negative(i, all[k]);
            s += k == 0 ? (negative ? "-" : "") : negative ? " - " : " + ";
            s += unsigned_of(all[k].a) + (all[k].b < 0 ? "" : " * " + unsigned_of(all[k].b));
        }
        return s;
    }

    std::string expression(int i) const {
        const node &n = p.at(i);
        const term &x = p.terms[size_t(i)][0];
        switch (n.op) {
        case ADD:
        case MULTIPLY: return sum(i);
        case DIVIDE: return unsigned_of(x.a) + " / " + unsigned_of(x.b);
        case ROOT: return "root(" + of(n.arg[0]) + ")";
        case SELECT:
            return "choose(" + of(n.arg[0]) + " < " + of(n.arg[1]) + ", " + of(n.arg[2]) + ", " +
                   of(n.arg[3]) + ")";
        case GATHER: return gathered(i);
        default: abort();
        }
    }

    void store_at(value x, const std::string &array, size_t k, uint32_t stances) {
        const node &n = p.at(node_of(x));
        const int lane = n.op == LANE ? int(n.constant) : -1;
        std::vector<store> &all = stores[p.source_of(x)];
        for (store &to : all)
            if (to.array == array && to.k == k && to.negative == is_negative(x) && to.lane == lane) {
                to.stances |= stances;
                return;
            }
        all.push_back({array, k, is_negative(x), lane, stances});
    }

    /* The lanes of a vector are stored as one where they stand one behind the other. */
    std::string stores_of(int i) const {
        const auto found = stores.find(i);
        std::string s;
        if (found == stores.end()) return s;
        const std::vector<store> &all = found->second;
        for (size_t k = 0; k < all.size(); k++) {
            const store &to = all[k];
            size_t n = 0;
            while (to.lane == 0 && k + n < all.size() && all[k + n].lane == int(n) &&
                   all[k + n].k == to.k + n && all[k + n].array == to.array &&
                   all[k + n].negative == to.negative && all[k + n].stances == to.stances)
                n++;
            const bool whole = to.lane == 0 && n == size_t(t.limbs);
            const std::string place = format("%s[%zu]", to.array.c_str(), to.k);
            s += "    " + only_if(p.f, to.stances, p.is_statement[size_t(i)] ? p.stances[size_t(i)] : 0) +
                 (whole ? "side_by_side(" + place + ")" : place) + " = " + of(negated(2 * i, to.negative)) +
                 (whole || to.lane < 0 ? "" : format("[%d]", to.lane)) + ";\n";
            if (whole) k += n - 1;
        }
        return s;
    }
};

/* The statements of block k, and before(i) before statement i. */
template <class function>
std::string block_text(const program &p, const blocks &b, statements *c, int k, function before) {
    const auto kept = [&](int i) {
        return format("k%s[%d]", p.at(i).is_vector ? "l" : "", b.kept_at[size_t(i)]);
    };
    std::string s;
    c->begin_block();
    for (int i : b.order) {
        const int own = b.of[size_t(i)];
        const bool is_kept = b.kept_at[size_t(i)] >= 0;
        if (own < k && is_kept) c->name[size_t(i)] = kept(i);
        if (own != k) continue;
        s += before(i) + c->statement(i);
        if (is_kept) s += "    " + kept(i) + " = " + c->name[size_t(i)] + ";\n";
    }
    return s;
}

} // namespace codegen
#endif
