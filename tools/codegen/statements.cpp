/* Values and statements as C. SPDX-License-Identifier: MIT */
#include "statements.h"
#include <algorithm>
#include <cstdlib>

namespace codegen {

statements::statements(const program &p_, const target &t_) : name(p_.f.code.nodes.size()), p(p_), t(t_) {
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

/* ---- values ---- */

std::string statements::leaf(int i) const {
    const node &n = p.at(i);
    switch (n.op) {
    case CONSTANT: return literal(n.constant, t.is_float);
    case GATHER: return "(limbs){" + elements(i) + "}";
    case LOADED: return format("rows[%d]", n.arg[0]);
    case INPUT: return format("%s[%d]", p.f.inputs[size_t(n.arg[0])].name.c_str(), n.arg[1]);
    default: return format("%s[%d]", n.op == SINE ? "sine" : "cosine", angle.at(p.angle_of(i)));
    }
}

std::string statements::unsigned_of(int i) const {
    const node &n = p.at(i);
    if (n.op == LANE) return unsigned_of(node_of(n.arg[0])) + format("[%d]", int(n.constant));
    return p.is_leaf(i) ? leaf(i) : name[size_t(i)];
}

std::string statements::of(value x) const {
    const int i = node_of(x);
    const std::string s = (is_negative(x) != bool(p.flipped[size_t(i)]) ? "-" : "") + unsigned_of(i);
    return p.at(i).op == CONSTANT && t.lanes > 1 ? "splat(" + s + ")" : s;
}

std::string statements::of_angle(value x) const {
    const node &n = p.at(node_of(x));
    std::string s;
    if (n.op == ADD)
        s = "(" + of_angle(n.arg[0]) + " + " + of_angle(n.arg[1]) + ")";
    else if (n.op == MULTIPLY)
        s = of_angle(n.arg[0]) + " * " + of_angle(n.arg[1]);
    else
        s = leaf(node_of(x));
    return is_negative(x) ? "-" + s : s;
}

std::string statements::elements(int i) const {
    return join(size_t(t.limbs), ", ", [&](size_t l) { return of(p.at(i).arg[l]); });
}

/* A vector of scalars; "side_by_side(v[6])" where they stand one behind the other. */
std::string statements::gathered(int i) const {
    const value *a = p.at(i).arg;
    const auto place = [&](value x) {
        const node &n = p.at(node_of(x));
        if (is_negative(x) || !p.is_leaf(node_of(x)) || n.op == CONSTANT) return std::make_pair(-1, -1);
        if (n.op == LOADED) return std::make_pair(-int(n.op), n.arg[0]);
        return n.op == INPUT ? std::make_pair(n.arg[0], n.arg[1])
                             : std::make_pair(-int(n.op), angle.at(p.angle_of(node_of(x))));
    };
    bool contiguous = true;
    for (int l = 0; l < t.limbs; l++)
        contiguous = contiguous && place(a[l]).first == place(a[0]).first && place(a[l]).first != -1 &&
                     place(a[l]).second == place(a[0]).second + l;
    return contiguous ? "side_by_side(" + leaf(node_of(a[0])) + ")" : "(limbs){" + elements(i) + "}";
}

/* ---- statements ---- */

/* First a term that is no product and positive, for what follows to be fused to; else what is there. */
std::string statements::sum(int i) const {
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

std::string statements::expression(int i) const {
    const node &n = p.at(i);
    const term &x = p.terms[size_t(i)][0];
    switch (n.op) {
    case ADD: return sum(i);
    case MULTIPLY: return unsigned_of(x.a) + " * " + unsigned_of(x.b);
    case DIVIDE: return unsigned_of(x.a) + " / " + unsigned_of(x.b);
    case ROOT: return "root(" + of(n.arg[0]) + ")";
    case SELECT:
        return "choose(" + of(n.arg[0]) + " < " + of(n.arg[1]) + ", " + of(n.arg[2]) + ", " + of(n.arg[3]) +
               ")";
    case GATHER: return gathered(i);
    default: abort();
    }
}

std::string statements::statement(int i) {
    name[size_t(i)] = format("t%d", named++);
    return (p.at(i).is_vector ? "    limbs " : "    real ") + name[size_t(i)] + " = " + expression(i) +
           ";\n" + stores_of(i);
}

/* ---- stores ---- */

bool statements::is_copied(value x) const { return p.at(node_of(x)).op == LOADED && !is_negative(x); }

/* With stances a result may be zero in some of them alone. */
bool statements::is_cleared(value x) const {
    return t.lanes == 1 && p.f.stances == 0 && x == p.f.code.find_constant(0);
}

void statements::store_at(value x, const std::string &array, size_t k, uint32_t stances) {
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
std::string statements::stores_of(int i) const {
    const auto found = stores.find(i);
    std::string s;
    if (found == stores.end()) return s;
    const std::vector<store> &all = found->second;
    for (size_t k = 0; k < all.size(); k++) {
        const store &to = all[k];
        size_t n = 0;
        while (to.lane == 0 && k + n < all.size() && all[k + n].lane == int(n) && all[k + n].k == to.k + n &&
               all[k + n].array == to.array && all[k + n].negative == to.negative &&
               all[k + n].stances == to.stances)
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

std::string statements::stores_of_others() const {
    std::string s;
    for (const auto &x : stores)
        if (!p.is_statement[size_t(x.first)]) s += stores_of(x.first);
    return s;
}

} // namespace codegen
