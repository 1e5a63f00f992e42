/* rbd.h run with a scalar that records what is done to it. Compiled for the constants of each scalar:
   CONSTANTS is double or float, RECORD the function's name, RECORD_SPACE a namespace for it.
   SPDX-License-Identifier: MIT */
#include "record.h"
#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace codegen {
namespace RECORD_SPACE {

static graph *tape;                                /* where it is recorded */
static std::unordered_map<double, value> stand_in; /* constants that stand for arguments */

class number {
  public:
    alignas(double) value x; /* constants stand behind numbers in the library's memory */
    number() = default;      /* trivial: the library's memory is raw */
    number(double c) {
        const auto found = stand_in.find(c);
        x = found != stand_in.end() ? found->second : tape->constant(c);
    }
    static number of(value x) {
        number n;
        n.x = x;
        return n;
    }
};

static inline number operator+(number a, number b) { return number::of(tape->add(a.x, b.x)); }
static inline number operator-(number a) { return number::of(negated(a.x)); }
static inline number operator-(number a, number b) { return a + -b; }
static inline number operator*(number a, number b) { return number::of(tape->multiply(a.x, b.x)); }
static inline number operator/(number a, number b) { return number::of(tape->divide(a.x, b.x)); }
static inline number sin(number a) { return number::of(tape->sine(a.x)); }
static inline number cos(number a) { return number::of(tape->cosine(a.x)); }
static inline number sqrt(number a) { return number::of(tape->root(a.x)); }

/* A condition: known, or a comparison a < b or its opposite, or more than that, which can be asked for only
   as `any`. Of what is not known the recording takes that no state meets it: the one such question of rbd.h
   is whether pivots are in doubt, and that is asked again after the recorded code, see `pivots`. */
enum certainty { NEVER, ALWAYS, LESS, NOT_LESS, MANY };
class mask {
  public:
    certainty kind;
    value a, b;
    mask() = default;
    mask(bool known) : kind(known ? ALWAYS : NEVER), a(-1), b(-1) {}
    mask(value a_, value b_) : kind(LESS), a(a_), b(b_) {}
    operator int() const { return kind == ALWAYS; }
};
static inline mask operator!(mask k) {
    static const certainty opposite[] = {ALWAYS, NEVER, NOT_LESS, LESS, MANY};
    k.kind = opposite[k.kind];
    return k;
}
static inline mask operator|(mask a, mask b) {
    if (a.kind == ALWAYS || b.kind == NEVER) return a;
    if (b.kind == ALWAYS || a.kind == NEVER) return b;
    a.kind = MANY;
    return a;
}
static inline mask operator&(mask a, mask b) { return !((!a) | (!b)); }
static inline number select(mask k, number x, number y) {
    if (k.kind == ALWAYS) return x;
    if (k.kind == NEVER) return y;
    if (k.kind == MANY) throw std::runtime_error("a choice by more than one comparison");
    if (k.kind == NOT_LESS) std::swap(x, y);
    return number::of(tape->select(k.a, k.b, x.x, y.x));
}
static mask operator<(number a, number b);

/* Of several limbs of one size none has the cheaper frames. */
static bool limbs_alike;
template <class draft> bool has_like_limbs(const draft *links, int count, int i) {
    int alike = 0;
    for (int j = i + 1; j < count; j++)
        alike += links[j].parent == i && links[j].size == links[links[i].favourite].size;
    return limbs_alike && alike > 1;
}

} // namespace RECORD_SPACE
} // namespace codegen

#define RBD_REAL codegen::RECORD_SPACE::number
#define RBD_REAL_CUSTOM
#define RBD_MASK codegen::RECORD_SPACE::mask
#define RBD_CONST CONSTANTS
#define RBD_STATIC
#define RBDI_NO_FAVOURITE codegen::RECORD_SPACE::has_like_limbs
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"

namespace codegen {
namespace RECORD_SPACE {

#include "algorithms.h"

/* That a pivot's inverse is finite is taken for granted: what is not is refused with the pivot. */
static mask operator<(number a, number b) {
    if (tape->is_constant(a.x) && tape->is_constant(b.x))
        return tape->constant_of(a.x) < tape->constant_of(b.x);
    if (a.x == b.x) return false;
    if (tape->is_constant(a.x) && tape->constant_of(a.x) == double(RBDI_TINY)) return true;
    return mask(a.x, b.x);
}

/* Gravity is a constant to rbd.h: where it is an argument, numbers that nothing else has stand in. */
static void set_gravity(const session &s, const robot &r, const std::vector<number> &g) {
    rbd_const c[3];
    for (int i = 0; i < 3; i++) {
        c[i] = rbd_const(g.empty() ? r.gravity[i] : 1.2345678912e-21 * (i + 2));
        if (g.empty()) continue;
        stand_in[double(c[i])] = g[size_t(i)].x;
        stand_in[-double(c[i])] = negated(g[size_t(i)].x);
    }
    session::demand(rbd_set_gravity(s.w, c));
}

/* "jacobian:left foot" as part of a C identifier. */
static std::string identifier(std::string name) {
    for (char &c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

} // namespace RECORD_SPACE

function RECORD(const robot &r, const std::string &name) {
    using namespace RECORD_SPACE;
    function f;
    tape = &f.code;
    stand_in.clear();
    limbs_alike = r.limbs_alike;
    session s(r, name);
    std::vector<number> x[ARGUMENTS];
    for (int k = 0; k < ARGUMENTS; k++) {
        const argument &a = arguments[k];
        if (!s.takes(r, a)) continue;
        for (int i = 0; i < a.size(s.m); i++)
            x[k].push_back(number::of(tape->input(int(f.inputs.size()), i)));
        f.inputs.push_back({a.name, a.size(s.m), a.shape});
    }
    set_gravity(s, r, x[5]);
    for (number y : s.run(x)) f.results.push_back(y.x);
    for (const result &y : s.row->results)
        if (y.size) f.outputs.push_back({y.name, y.size(s.m), y.shape});
    for (int k = 0; s.row->traits & PIVOTS && k < rbd_nv(s.m); k++) {
        f.pivots.push_back(s.w->pivot[k].x);
        f.limits.push_back(double((s.m->dof[k].scale + s.m->dof[k].armature) * RBDI_NOISE));
    }
    f.noise = double(RBDI_NOISE);
    f.name = identifier(name), f.about = s.row->about;
    return f;
}

} // namespace codegen
