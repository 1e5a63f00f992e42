/* Like limbs of one state as lanes. SPDX-License-Identifier: MIT

   rbd.h does to each leg what it does to the others, so that their parts of the graph are alike but for signs
   and constants. Limbs are alike by their trees (class tree); nodes by how they come about from their limb's
   inputs (classify). A node and its like of the other limbs become one, of vectors (match); what differs
   between the limbs beside that is gathered, what is wanted of one limb is taken out (build). Where limbs are
   mirror images a lane stands for its node's negative (choose_signs). */
#include "codegen.h"
#include <algorithm>
#include <iterator>
#include <map>

namespace codegen {
namespace {

enum { NONE = -1, MOST_INPUTS = 8 /* of a body, in one array */ };

/* ---- like limbs of the tree ---- */

/* limb: its group * width + its lane, or NONE; slot: which of the limb's bodies. */
struct place {
    int limb, slot;
};

class tree {
  public:
    std::vector<place> places; /* of each body */
    int operations = 0;        /* bodies, those of like limbs counted once */

    tree(const std::vector<joint> &joints_, int width_)
        : places(joints_.size(), {NONE, 0}), joints(joints_), width(width_) {
        for (const joint &j : joints)
            carrier.push_back(j.parent < 0 || is_moving(j.parent) ? j.parent : carrier[size_t(j.parent)]);
        search(NONE);
    }

  private:
    const std::vector<joint> &joints;
    int width, groups = 0;
    std::map<std::string, int> slots; /* of paths */
    std::vector<int> carrier;         /* of each body the next one that moves, through fixed ones */

    bool is_moving(int b) const { return joints[size_t(b)].nv > 0; }

    /* The bodies that body b carries: moving ones, by shape; or fixed ones. */
    std::vector<int> carried(int b, bool moving) const {
        std::vector<int> all;
        for (int k = b + 1; k < int(joints.size()); k++)
            if (carrier[size_t(k)] == b && is_moving(k) == moving) all.push_back(k);
        const auto by_shape = [this](int x, int y) { return shape(x) < shape(y); };
        if (moving) std::stable_sort(all.begin(), all.end(), by_shape);
        return all;
    }
    std::string shape(int b) const {
        std::string s = std::to_string(joints[size_t(b)].nq) + ":" + std::to_string(joints[size_t(b)].nv);
        for (int c : carried(b, true)) s += "(" + shape(c) + ")";
        return s;
    }

    /* Body b and all that it carries. path: from the limb's root, indices among what each body carries;
       bodies of one path have one slot. */
    void place_limb(int b, int limb, const std::string &path) {
        places[size_t(b)] = {limb, slots.emplace(path, int(slots.size())).first->second};
        operations += is_moving(b) && limb % width == 0;
        for (bool moving : {true, false}) {
            const std::vector<int> all = carried(b, moving);
            for (size_t k = 0; k < all.size(); k++)
                place_limb(all[k], limb, path + (moving ? " " : ":") + std::to_string(k));
        }
    }
    void search(int b) {
        const std::vector<int> all = carried(b, true);
        for (size_t k = 0; k < all.size();) {
            size_t n = k;
            while (n < all.size() && n < k + size_t(width) && shape(all[n]) == shape(all[k])) n++;
            if (width > 1 && int(n - k) == width) {
                groups++;
                for (; k < n; k++) place_limb(all[k], groups * width - int(n - k), std::to_string(groups));
            } else {
                operations++;
                search(all[k++]);
            }
        }
    }
};

/* ---- signs of lanes, some of which can still be chosen ---- */

/* Lane l is negative if bit l of the mask is set; or not, if an odd number of the unknowns has it set. */
struct signs {
    unsigned mask;
    std::vector<int> unknowns; /* ascending */
};
signs operator^(const signs &a, const signs &b) {
    signs c = {a.mask ^ b.mask, {}};
    std::set_symmetric_difference(a.unknowns.begin(), a.unknowns.end(), b.unknowns.begin(), b.unknowns.end(),
                                  std::back_inserter(c.unknowns));
    return c;
}

/* ---- packing ---- */

typedef std::vector<value> tuple;            /* for each lane */
typedef std::vector<std::vector<int>> lists; /* of nodes, for each lane */

class packer {
  public:
    function out;

    packer(const function &f_, const std::vector<joint> &joints, int width_)
        : out(f_), f(f_), width(width_), all_lanes((1u << width_) - 1), live(f_.code.nodes.size(), 0),
          in_angle(live), kind(live.size(), NONE), limb(kind), pack(kind), scalars(kind) {
        place_inputs(joints);
        find_live();
        classify();
        match();
        choose_signs();
        build();
    }

  private:
    const function &f;
    int width;
    unsigned all_lanes;
    std::vector<std::vector<place>> inputs; /* of each array's elements */
    std::vector<char> live, in_angle;       /* of each node: used; part of an angle */
    std::vector<int> kind, limb, pack;      /* its class; where it belongs; its pack; or NONE */
    lists packs;                            /* nodes that are one vector */
    std::vector<signs> sign;                /* of packs: lanes that hold the node's negative */
    std::map<int, signs> solved;            /* of unknowns */
    int unknowns = 0;
    std::vector<value> scalars, vectors; /* of nodes and packs in `out`, or NONE */

    const node &at(int i) const { return f.code.nodes[size_t(i)]; }
    bool is_constant(value x) const { return at(node_of(x)).op == CONSTANT; }
    static bool is_source(operation op) { return op == INPUT || op == SINE || op == COSINE; }
    int lane(int i) const { return limb[size_t(i)] % width; }

    void place_inputs(const std::vector<joint> &joints) {
        const tree t(joints, width);
        for (const array &a : f.inputs) {
            std::vector<place> places(size_t(a.size), {NONE, 0});
            for (size_t b = 0; b < joints.size() && a.name != "gravity" && a.name != "restitution"; b++) {
                const joint &j = joints[b];
                const bool is_q = a.name == "q", is_wrench = a.name == "f_ext";
                const int first = is_wrench ? 6 * int(b) : is_q ? j.iq : j.iv;
                for (int k = 0; k < (is_wrench ? 6 : is_q ? j.nq : j.nv); k++)
                    places[size_t(first + k)] = {t.places[b].limb, t.places[b].slot * MOST_INPUTS + k};
            }
            inputs.push_back(places);
        }
    }

    /* Angles are computed before all else, one by one. */
    void find_live() {
        for (value x : f.wanted()) live[size_t(node_of(x))] = 1;
        for (int i = int(live.size()) - 1; i >= 0; i--) {
            const operation op = at(i).op;
            for (value x : at(i).arg) {
                if (!live[size_t(i)] || x < 0 || !has_operands(op)) continue;
                live[size_t(node_of(x))] = 1;
                if (op == SINE || op == COSINE || in_angle[size_t(i)]) in_angle[size_t(node_of(x))] = 1;
            }
        }
    }

    /* A node belongs to the limb of its operands, to none if they are of several. Its class is its operation
       and its operands' classes: constants are all alike, inputs are if they have the same place in their
       limbs. Nodes of one class are equally deep. */
    void classify() {
        std::map<std::vector<int>, int> classes;
        for (int i = 0; i < int(live.size()); i++) {
            const node &n = at(i);
            std::vector<int> key;
            int where = NONE;
            bool several = false;
            if (n.op == INPUT) {
                const place &p = inputs[size_t(n.arg[0])][size_t(n.arg[1])];
                where = p.limb;
                key = {n.arg[0], where == NONE ? n.arg[1] : p.slot};
            }
            if (n.op == LOADED) key = {n.arg[1]};
            for (value x : n.arg) {
                if (x < 0 || !has_operands(n.op)) continue;
                const int l = limb[size_t(node_of(x))];
                key.push_back(kind[size_t(node_of(x))]);
                several = several || (l != NONE && where != NONE && l != where);
                if (l != NONE) where = l;
            }
            if (several) where = NONE;
            if (n.op == ADD || n.op == MULTIPLY) std::sort(key.begin(), key.end());
            key.push_back(where == NONE ? NONE : where / width);
            key.push_back(n.op);
            kind[size_t(i)] = classes.emplace(key, int(classes.size())).first->second;
            limb[size_t(i)] = where;
        }
    }

    /* Of each class the first of one limb with the first of the others, and so on: they were recorded in one
       order. */
    void match() {
        std::map<int, lists> members; /* of a class */
        for (int i = 0; i < int(live.size()); i++) {
            const operation op = at(i).op;
            const bool can = op == ADD || op == MULTIPLY || op == DIVIDE || is_source(op);
            if (!live[size_t(i)] || limb[size_t(i)] == NONE || !can || (in_angle[size_t(i)] && op != INPUT))
                continue;
            lists &l = members[kind[size_t(i)]];
            l.resize(size_t(width));
            l[size_t(lane(i))].push_back(i);
        }
        for (const auto &m : members) {
            size_t n = live.size();
            for (const std::vector<int> &x : m.second) n = std::min(n, x.size());
            for (size_t k = 0; k < n; k++) {
                packs.push_back({});
                for (const std::vector<int> &x : m.second) packs.back().push_back(x[k]);
            }
        }
        std::sort(packs.begin(), packs.end()); /* operands come first */
        for (size_t p = 0; p < packs.size(); p++)
            for (int i : packs[p]) pack[size_t(i)] = int(p);
        vectors.assign(packs.size(), NONE);
    }

    /* ---- operands of a pack: for each lane an edge ---- */

    /* In one order for all lanes; constants come second where the operation allows. */
    void operands(int p, tuple *x, tuple *y) const {
        const auto key = [this](value v) {
            const size_t k = size_t(node_of(v));
            return std::vector<int>{is_constant(v), kind[k], pack[k], int(k)};
        };
        for (int i : packs[size_t(p)]) {
            value a = at(i).arg[0], b = at(i).arg[1];
            if (at(i).op != DIVIDE && key(b) < key(a)) std::swap(a, b);
            x->push_back(a), y->push_back(b);
        }
    }
    operation op_of(int p) const { return at(packs[size_t(p)][0]).op; }
    bool are_constant(const tuple &t) const {
        return std::all_of(t.begin(), t.end(), [this](value x) { return is_constant(x); });
    }
    int pack_of(const tuple &t) const {
        const int p = pack[size_t(node_of(t[0]))];
        for (size_t l = 0; l < t.size(); l++)
            if (p < 0 || packs[size_t(p)][l] != node_of(t[l])) return NONE;
        return p;
    }
    static unsigned edges(const tuple &t) {
        unsigned mask = 0;
        for (size_t l = 0; l < t.size(); l++) mask |= unsigned(is_negative(t[l])) << l;
        return mask;
    }

    /* ---- signs: those of inputs and of products with constants are free ---- */

    static signs only(int unknown) { return {0, {unknown}}; }
    signs unknown() { return only(unknowns++); }
    signs resolved(signs s) const { /* with lane 0 positive */
        for (size_t k = 0; k < s.unknowns.size();) {
            const auto found = solved.find(s.unknowns[k]);
            if (found == solved.end())
                k++;
            else
                s = s ^ only(found->first) ^ found->second, k = 0;
        }
        if (s.mask & 1) s.mask ^= all_lanes;
        return s;
    }
    unsigned mask_of(const tuple &t) { return resolved(sign_of(t)).mask; }
    signs sign_of(const tuple &t) { return pack_of(t) < 0 ? signs{0, {}} : sign[size_t(pack_of(t))]; }

    /* In a sum both operands must have the signs of the node, or opposite ones in all lanes. */
    void choose_signs() {
        for (int p = 0; p < int(packs.size()); p++) {
            tuple x, y;
            if (is_source(op_of(p))) {
                sign.push_back(unknown());
                continue;
            }
            operands(p, &x, &y);
            if (op_of(p) == ADD) {
                sign.push_back(sign_of(x) ^ signs{edges(x), {}});
                if (are_constant(y)) continue;
                const signs difference = resolved(sign.back() ^ sign_of(y) ^ signs{edges(y), {}});
                if (difference.unknowns.empty()) continue; /* as it should be; or an operand is multiplied */
                const int last = difference.unknowns.back();
                solved[last] = difference ^ only(last);
            } else
                sign.push_back(are_constant(x) || are_constant(y) ? unknown() : sign_of(x) ^ sign_of(y));
        }
    }

    /* ---- the new graph ---- */

    value gathered(const tuple &t, unsigned negative) {
        node n = {GATHER, {NONE, NONE, NONE, NONE}, 0, true};
        for (size_t l = 0; l < t.size(); l++) n.arg[l] = negated(t[l], negative >> l & 1);
        return out.code.apply(n, n.arg);
    }
    value scaled_by_signs(unsigned negative, value vector) {
        const tuple ones(size_t(width), out.code.constant(1));
        return negative == 0 ? vector : out.code.multiply(gathered(ones, negative), vector);
    }

    /* The vector of the edges, or of their negatives in some lanes. */
    value vector_of(const tuple &t, unsigned negative) {
        const int p = pack_of(t);
        const unsigned d = mask_of(t) ^ edges(t) ^ negative;
        if (p >= 0) return d == all_lanes ? negated(packed(p)) : scaled_by_signs(d, packed(p));
        tuple s;
        for (value v : t) s.push_back(scalar(2 * node_of(v)));
        return gathered(s, d);
    }
    value packed(int p) {
        value &v = vectors[size_t(p)];
        const unsigned own = resolved(sign[size_t(p)]).mask;
        tuple x, y;
        if (v >= 0) return v;
        if (is_source(op_of(p))) {
            for (int i : packs[size_t(p)]) x.push_back(scalar(2 * i));
            return v = scaled_by_signs(own, gathered(x, 0));
        }
        operands(p, &x, &y);
        const bool is_sum = op_of(p) == ADD;
        const unsigned of_x = is_sum ? own : are_constant(x) ? own ^ mask_of(y) : mask_of(x);
        const value a = vector_of(x, of_x), b = vector_of(y, is_sum ? own : own ^ of_x);
        return v = out.code.apply(at(packs[size_t(p)][0]), {a, b, NONE, NONE});
    }
    value scalar(value x) {
        const int i = node_of(x), p = pack[size_t(i)];
        value &v = scalars[size_t(i)];
        if (v < 0 && p >= 0 && !is_source(at(i).op)) {
            const unsigned own = resolved(sign[size_t(p)]).mask;
            v = negated(out.code.lane(packed(p), lane(i)), own >> lane(i) & 1);
        } else if (v < 0)
            v = out.code.copy(at(i), [this](value y) { return scalar(y); });
        return negated(v, is_negative(x));
    }

    /* A result; if several lanes of its vector have the wrong sign, of that vector with the right ones. */
    value result(value x, const std::vector<unsigned> &wanted) {
        const int i = node_of(x), p = pack[size_t(i)];
        if (p < 0 || is_source(at(i).op)) return scalar(x);
        const unsigned own = resolved(sign[size_t(p)]).mask, wrong = own ^ wanted[size_t(p)];
        const int n = __builtin_popcount(wrong);
        if (n < 2 || n == width) return scalar(x);
        const value v = out.code.lane(scaled_by_signs(wrong, packed(p)), lane(i));
        return negated(v, is_negative(x) != bool(wanted[size_t(p)] >> lane(i) & 1));
    }

    /* No lane of a vector depends on a call on which another does not. */
    void copy_call(row_call *c) {
        for (row_call::store &s : c->stores) s.x = scalar(s.x);
        c->node = int(out.code.nodes.size());
    }

    void build() {
        std::vector<unsigned> wanted(packs.size(), 0); /* lanes that are results, and negative */
        out.code = graph();
        out.code.is_float = f.code.is_float;
        for (size_t p = 0; p < packs.size(); p++) /* angles side by side */
            for (int i : packs[p])
                if (at(i).op == SINE || at(i).op == COSINE) scalar(at(i).arg[0]);
        size_t call = 0;
        for (int i = 0; i <= int(live.size()); i++) {
            for (; call < f.calls.size() && f.calls[call].node <= i; call++) copy_call(&out.calls[call]);
            if (i == int(live.size()) || !live[size_t(i)]) continue;
            if (pack[size_t(i)] >= 0 && !is_source(at(i).op))
                packed(pack[size_t(i)]);
            else
                scalar(2 * i);
        }
        for (value x : f.results)
            if (is_negative(x) && pack[size_t(node_of(x))] >= 0)
                wanted[size_t(pack[size_t(node_of(x))])] |= 1u << lane(node_of(x));
        for (value &x : out.results) x = result(x, wanted);
        for (value &x : out.pivots) x = scalar(x);
    }
};

} // namespace

int like_limbs(const std::vector<joint> &joints, int most) {
    int best = 1;
    for (int width = 2; width <= most; width *= 2)
        if (tree(joints, width).operations < tree(joints, best).operations) best = width;
    return best;
}

function pack_limbs(const function &f, const std::vector<joint> &joints, int width) {
    return packer(f, joints, width).out;
}

} // namespace codegen
