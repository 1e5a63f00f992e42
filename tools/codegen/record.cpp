/* rbd.h run with a scalar that records what is done to it. Compiled for the constants of each scalar:
   CONSTANTS is double or float, RECORD the function's name, RECORD_SPACE a namespace for it.
   SPDX-License-Identifier: MIT */
#include "codegen.h"
#include <algorithm>
#include <cstring>
#include <float.h> /* these four before rbd.h has them, in a namespace */
#include <math.h>
#include <stddef.h>
#include <stdexcept>
#include <stdint.h>
#include <unordered_map>

namespace codegen {
namespace RECORD_SPACE {

/* An operation on numbers as rbd.h wrote it. */
struct step {
    node written;   /* operands: steps */
    value seen;     /* folded at once in `sketch`, to know what is constant */
    value recorded; /* on the tape; or NONE */
};
enum { NONE = -1 };

static graph *tape; /* where it is recorded */
static graph sketch;
static std::vector<step> steps;
static std::unordered_map<double, value> stand_in; /* constants that stand for arguments: steps */

static value seen(value x) { return negated(steps[size_t(node_of(x))].seen, is_negative(x)); }

static value write(const node &written) {
    steps.push_back({written, sketch.copy(written, seen), NONE});
    return 2 * value(steps.size() - 1);
}
static value write(operation op, value a, value b = NONE, value c = NONE, value d = NONE) {
    return write({op, {a, b, c, d}, 0, false});
}

/* Operands from right to left, then the step: so GCC evaluates them, and packed limbs are shorter by it. */
static value record(value x) {
    step &t = steps[size_t(node_of(x))];
    if (t.recorded == NONE) t.recorded = tape->copy(t.written, record);
    return negated(t.recorded, is_negative(x));
}

/* Each compiler evaluates the arguments of a call, and operands, in an order of its own. So what is done to
   numbers is written only, and recorded when it is assigned: assignments come in one order, as long as of the
   arguments of a call one at most assigns. That is so in rbd.h, whose vectors are initialised. */
class number {
  public:
    alignas(double) value x; /* a step; constants stand behind numbers in the library's memory */
    number() = default;      /* trivial: the library's memory is raw */
    number(const number &) = default;
    number(double c) {
        const auto found = stand_in.find(c);
        const node constant = {CONSTANT, {NONE, NONE, NONE, NONE}, c, false};
        x = found != stand_in.end() ? found->second : write(constant);
    }
    static number of(value x) {
        number n;
        n.x = x;
        return n;
    }
    number &operator=(const number &y) {
        x = y.x;
        record(x);
        return *this;
    }
};

static inline number operator+(number a, number b) { return number::of(write(ADD, a.x, b.x)); }
static inline number operator-(number a) { return number::of(negated(a.x)); }
static inline number operator-(number a, number b) { return a + -b; }
static inline number operator*(number a, number b) { return number::of(write(MULTIPLY, a.x, b.x)); }
static inline number operator/(number a, number b) { return number::of(write(DIVIDE, a.x, b.x)); }

/* Whether it is made of arguments alone: sines and cosines of these are computed before all else. */
static bool is_given(value x) {
    const node &n = sketch.nodes[size_t(node_of(x))];
    if (n.op == ADD || n.op == MULTIPLY) return is_given(n.arg[0]) && is_given(n.arg[1]);
    return n.op == INPUT || n.op == CONSTANT;
}
/* Of other angles, up to a right one, by the power series: 1 - x^2 / (k (k - 1)) (1 - ...), k from
   least + 2 on. */
static number series(number square, int least) {
    number sum = 1;
    if (tape->is_exact) throw std::runtime_error("--reproducible: not with kp of one or three angular axes");
    for (int k = least + 22; k > least; k -= 2) sum = number(1) - square * sum * number(1. / (k * (k - 1)));
    return sum;
}
static inline number sin(number a) {
    return is_given(seen(a.x)) ? number::of(write(SINE, a.x)) : a * series(a * a, 1);
}
static inline number cos(number a) {
    return is_given(seen(a.x)) ? number::of(write(COSINE, a.x)) : series(a * a, 0);
}
static inline number sqrt(number a) { return number::of(write(ROOT, a.x)); }

/* Of x and as many right angles. */
static inline void sincos(number x, int quarters, number *s, number *c) {
    if (tape->is_exact) {
        const number turn = quarters;
        *s = number::of(write(SINE, x.x, turn.x)), *c = number::of(write(COSINE, x.x, turn.x));
        return;
    }
    number sine = sin(x), cosine = cos(x);
    for (; quarters > 0; quarters--) std::swap(cosine, sine), cosine = -cosine;
    *s = sine, *c = cosine;
}

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
    if (k.kind == MANY) /* asked where pivots are in doubt whatever the arguments are */
        throw std::runtime_error("the mass matrix is singular, or nearly, in every state");
    if (k.kind == NOT_LESS) std::swap(x.x, y.x);
    return number::of(write(SELECT, k.a, k.b, x.x, y.x));
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

using ::cos, ::sin, ::sqrt; /* of constants */

/* Work on whole rows is recorded as calls: rows_record.h. */
template <class model, class work> bool rows_factor(const model *m, work *w, number *H);
template <class model>
bool rows_solve(const model *m, const number *L, int sign, ptrdiff_t stride, int n, number *X, number *Y);
template <class model> bool rows_invert(const model *m, const number *L, number *Z);

/* Of rows of constraints: pivots, minus what they must exceed. Their verdict is asked for as `pivots` are. */
static std::vector<number> row_pivots;
static void rows_pivot(number pivot, number least) {
    const value x = seen(pivot.x);
    if (sketch.is_constant(x) && !(sketch.constant_of(x) > 0))
        throw std::runtime_error("row " + std::to_string(row_pivots.size()) +
                                 " of the constraints is 0 in every state: hold fewer axes");
    row_pivots.push_back(pivot - least);
}

#define RBD_REAL codegen::RECORD_SPACE::number
#define RBD_REAL_CUSTOM
#define RBD_MASK codegen::RECORD_SPACE::mask
#define RBD_CONST CONSTANTS
#define RBD_STATIC
#define RBDI_SINCOS codegen::RECORD_SPACE::sincos
#define RBDI_NO_FAVOURITE codegen::RECORD_SPACE::has_like_limbs
#define RBDI_ROWS(name) rows_##name
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "rbd_derivatives.h" /* in this namespace: its structs are of this scalar */
#include "algorithms.h"
#include "held.h"
#include "rows_record.h"

/* x = (L L')^-1 x. */
static void solve_by(const std::vector<column> &L, column *x) {
    column &y = *x;
    for (size_t k = 0; k < L.size(); k++) {
        y[k] = y[k] / L[k][k];
        for (size_t i = k + 1; i < L.size(); i++) y[i] = y[i] - L[k][i] * y[k];
    }
    for (size_t k = L.size(); k-- > 0;) {
        for (size_t i = k + 1; i < L.size(); i++) y[k] = y[k] - L[k][i] * y[i];
        y[k] = y[k] / L[k][k];
    }
}

static std::vector<bool> kept; /* joints whose columns L has */

/* By the columns of L that held.h speaks of. */
static rbd_status record_constrained_id(const call &c) {
    const size_t nv = size_t(rbd_nv(c.m)), rows = size_t(rbd_constraint_rows(c.set));
    number *tau = c.out[0], *lambda = c.out[1];
    const column J = jacobian_of(c);
    const std::vector<column> A = passive_columns(c, J), G = products_of(A);
    const std::vector<column> L = factor_of(G, [](size_t k, number pivot, number entry) {
        if (kept[k]) rows_pivot(pivot, entry * RBDI_CLEAR);
        return bool(kept[k]);
    });
    column t, y;
    for (size_t k = 0; k < A.size(); k++) { /* 0 if the rows hold a joint that they did not */
        const number held = sum_of(L.size(), [&](size_t i) { return L[i][k] * L[i][k]; });
        if (!kept[k]) row_pivots.push_back(select(G[k][k] * RBDI_CLEAR < G[k][k] - held, 0, 1));
    }
    const rbd_status status = rbd_rnea(c.m, c.w, c.q, c.v, c.a, c.f_ext, tau);
    for (size_t k = 0; k < nv; k++)
        if (rbdi_is_passive(c.m, c.actuated, int(k))) t.push_back(tau[k]);
    if (L.size() < A.size()) {
        const std::vector<column> F = factor_of(products_of(L), [](size_t, number, number) { return true; });
        for (const column &l : L) y.push_back(sum_of(t.size(), [&](size_t k) { return l[k] * t[k]; }));
        solve_by(F, &y), solve_by(F, &y);
        for (size_t k = 0; k < t.size(); k++)
            t[k] = sum_of(L.size(), [&](size_t i) { return L[i][k] * y[i]; });
    } else {
        solve_by(L, &t);
    }
    for (size_t r = 0; r < rows; r++) lambda[r] = sum_of(A.size(), [&](size_t k) { return A[k][r] * t[k]; });
    for (size_t k = 0; k < nv; k++)
        for (size_t r = 0; r < rows; r++) tau[k] = tau[k] - J[r * nv + k] * lambda[r];
    return status;
}

#include "derivatives_record.h"

/* That a pivot's inverse is finite is taken for granted: what is not is refused with the pivot. */
static mask operator<(number a, number b) {
    const value x = seen(a.x), y = seen(b.x);
    if (sketch.is_constant(x) && sketch.is_constant(y)) return sketch.constant_of(x) < sketch.constant_of(y);
    if (x == y) return false;
    if (sketch.is_constant(x) && sketch.constant_of(x) == double(RBDI_TINY)) return true;
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
    demand(rbd_set_gravity(s.c.w, c));
}

/* The call with the constraints of a stance. Nodes that earlier stances recorded are taken again. */
static void record_set(const robot &r, const std::string &name, int stance, function *f) {
    row_pivots.clear();
    if (tape->is_exact && (name == "constrained_id" || name == "delta"))
        throw std::runtime_error("--reproducible: not with " + name);
    if (name == "constrained_id") kept = independent_joints(r, stance);
    session s(r, name, stance);
    std::vector<number> x[ARGUMENTS];
    f->inputs.clear(), f->outputs.clear(), f->limits.clear();
    for (int k = 0; k < ARGUMENTS; k++) {
        const quantity &a = arguments[k];
        if (!s.takes(r, k)) continue;
        for (int i = 0; i < a.size(s.c); i++)
            x[k].push_back(number::of(write(INPUT, int(f->inputs.size()), i)));
        f->inputs.push_back({a.name, a.size(s.c), a.shape});
    }
    set_gravity(s, r, x[GRAVITY]);
    const auto own = r.reproducible ? NULL : record_of(s.row->name);
    for (number y : s.run(x, own ? own : s.row->run)) f->results.push_back(record(y.x));
    for (const quantity &y : s.row->results)
        if (y.size) f->outputs.push_back({y.name, y.size(s.c), y.shape});
    const bool has_M = s.row->traits & PIVOTS;
    if (s.holds_all()) row_pivots.clear();
    if (s.c.set && !s.holds_all()) f->rows_held = has_M ? s.c.rows : int(kept.size());
    std::vector<value> pivots(size_t(f->rows_held), tape->constant(1));
    f->limits.resize(pivots.size(), 0);
    for (size_t k = 0; k < row_pivots.size(); k++)
        pivots[pivots.size() - 1 - (has_M ? size_t(s.held[k]) : k)] = record(row_pivots[k].x);
    for (int k = 0; has_M && k < rbd_nv(s.c.m); k++) {
        pivots.push_back(record(s.c.w->pivot[k].x));
        f->limits.push_back(double((s.c.m->dof[k].scale + s.c.m->dof[k].armature) * RBDI_NOISE));
    }
    f->pivots.insert(f->pivots.end(), pivots.begin(), pivots.end());
    f->nv = rbd_nv(s.c.m), f->about = s.row->about;
}

} // namespace RECORD_SPACE

function RECORD(const robot &r, const std::string &name) {
    using namespace RECORD_SPACE;
    function f = {};
    f.code.is_exact = r.reproducible, f.code.is_float = sizeof(CONSTANTS) == sizeof(float);
    tape = &f.code, sketch = f.code;
    steps.clear();
    stand_in.clear();
    limbs_alike = r.limbs_alike;
    const bool has_stances = takes_stances(name) && !r.stances.empty();
    recorder.begin(&f, r.by_rows && !has_stances);
    f.stances = has_stances ? int(r.stances.size()) : 0;
    for (int stance = 0; stance < f.sets(); stance++) record_set(r, name, stance, &f);
    f.noise = double(RBDI_NOISE), f.clear = double(RBDI_CLEAR);
    f.name = name_in_c(name);
    return f;
}

} // namespace codegen
