/* The C text of programs. SPDX-License-Identifier: MIT */
#include "emit.h"
#include "sines.h"
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>

namespace codegen {
namespace {

std::string format(const char *text, ...) __attribute__((format(printf, 1, 2)));
std::string format(const char *text, ...) {
    va_list list, again;
    va_start(list, text);
    va_copy(again, list);
    std::string s(size_t(vsnprintf(nullptr, 0, text, list)) + 1, 0);
    vsnprintf(&s[0], s.size(), text, again);
    va_end(again);
    va_end(list);
    s.pop_back();
    return s;
}

/* The shortest text that reads back as the same number of the scalar. */
std::string literal(double x, bool is_float) {
    char text[40];
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (is_float ? strtof(text, nullptr) == float(x) : strtod(text, nullptr) == x) break;
    }
    std::string s = text;
    if (s.find_first_of(".en") == std::string::npos) s += ".0";
    return is_float ? s + "f" : s;
}

std::string upper(std::string s) {
    for (char &c : s) c = char(toupper(static_cast<unsigned char>(c)));
    return s;
}

std::string real_name(const target &t) {
    return t.lanes > 1 ? t.name + "_real" : t.is_float ? "float" : "double";
}

/* All arrays, "const double q[7], double tau[7]", with "restrict " where wanted; or their names. */
std::string parameters(const function &f, const std::string &real, const char *restrict_) {
    std::string s;
    for (const array &a : f.inputs)
        s += format("const %s %s[%s%d], ", real.c_str(), a.name.c_str(), restrict_, a.size);
    for (const array &a : f.outputs)
        s += format("%s %s[%s%d], ", real.c_str(), a.name.c_str(), restrict_, a.size);
    return s.substr(0, s.size() - 2);
}
std::string names(const function &f, const char *before = "", const char *between = ", ") {
    std::string s;
    for (const std::vector<array> *list : {&f.inputs, &f.outputs})
        for (const array &a : *list) s += (s.empty() ? "" : between) + std::string(before) + a.name;
    return s;
}

const char *result_type(const function &f) { return f.pivots.empty() ? "void" : "int"; }

/* ---- one function ---- */

class writer {
  public:
    writer(const function &f_, const target &t_)
        : f(f_), t(t_), p(f_, t_.statements), name(f_.code.nodes.size()) {
        for (int i = 0; i < int(f.code.nodes.size()); i++)
            if (p.is_statement[size_t(i)]) order.push_back(i);
        for (size_t k = 0; k < p.angles.size(); k++) angle[p.angles[k]] = int(k);
        size_t first = 0;
        for (const array &a : f.outputs)
            for (int k = 0; k < a.size; k++, first++)
                if (!is_copied(f.results[first])) store_at(f.results[first], a.name, size_t(k));
        for (size_t k = 0; k < f.pivots.size(); k++) store_at(f.pivots[k], "pivot", k);
        for (const row_call &c : f.calls)
            for (const row_call::store &s : c.stores)
                if (!is_for_call(s)) store_at(s.x, "rows", size_t(s.at));
        split();
        check_loads();
    }
    std::string text();

  private:
    const function &f;
    const target &t;
    program p;
    std::vector<int> order;            /* statements */
    std::vector<std::string> name;     /* of each node's value */
    std::map<wanted_angle, int> angle; /* its index among the angles */
    struct store {
        std::string array;
        size_t k;
        bool negative;
        int lane; /* of a vector; or -1 */
    };
    std::map<int, std::vector<store>> stores; /* of a node */
    std::vector<int> block, shared; /* of a node: the block that computes it, its place in `kept` or -1 */
    int blocks = 1, kept = 0, kept_vectors = 0;
    size_t calls = 0; /* written */

    /* The statement behind a value; of a lane that of its vector. */
    int source_of(value x) const {
        const node &n = p.at(node_of(x));
        return node_of(n.op == LANE ? n.arg[0] : x);
    }
    /* Stored just before the call, and not where it is computed. */
    bool is_for_call(const row_call::store &s) const {
        return s.late || !p.is_statement[size_t(source_of(s.x))];
    }
    /* A result that stands in rows. */
    bool is_copied(value x) const { return p.at(node_of(x)).op == LOADED && !is_negative(x); }
    void check_loads() const;
    std::string calls_before(int i);
    std::string copies() const;
    std::string call_texts() const;
    void store_at(value x, const std::string &array, size_t k);
    void split();
    std::string number(double x) const { return literal(x, t.is_float); }
    std::string leaf(int i) const;
    std::string elements(int i) const;
    std::string gathered(int i) const;
    std::string operand(int i) const;
    std::string stores_of(int i) const;
    std::string operand_signed(value x) const;
    std::string angle_text(value x) const;
    std::string sum(int i) const;
    std::string expression(int i) const;
    std::string statement(int i);
    std::string block_text(int b);
    std::string sines() const;
    std::string reproducible_sines() const;
    std::string end() const;

    /* Whether angles beyond are refused by a status: by one more pivot, 1 or NaN, which is judged first. */
    bool refuses() const { return t.is_bounded && !p.angles.empty() && !f.pivots.empty(); }
    size_t judged() const { return f.pivots.size() + refuses(); }
};

void writer::store_at(value x, const std::string &array, size_t k) {
    const node &n = p.at(node_of(x));
    if (n.op == LANE)
        stores[node_of(n.arg[0])].push_back({array, k, is_negative(x), int(n.constant)});
    else
        stores[node_of(x)].push_back({array, k, is_negative(x), -1});
}

/* Blocks of as many statements, and places for what later blocks read, free again behind the last of them. */
void writer::split() {
    const int n = int(order.size());
    blocks = std::max(1, (n + t.block - 1) / t.block);
    block.assign(f.code.nodes.size(), -1);
    shared.assign(f.code.nodes.size(), -1);
    for (int k = 0; k < n; k++) block[size_t(order[size_t(k)])] = int(int64_t(k) * blocks / n);
    std::vector<int> last(f.code.nodes.size(), -1);
    for (int i : order)
        for (int k : p.operands(i)) last[size_t(k)] = block[size_t(i)];
    for (const row_call &c : f.calls) {
        const auto next = std::lower_bound(order.begin(), order.end(), c.node);
        const int at = next == order.end() ? blocks - 1 : block[size_t(*next)];
        for (const row_call::store &s : c.stores)
            last[size_t(source_of(s.x))] = std::max(last[size_t(source_of(s.x))], is_for_call(s) ? at : -1);
    }
    std::vector<std::vector<int>> released(size_t(blocks) + 1);
    std::vector<int> unused[2]; /* scalars, vectors */
    int current = 0;
    for (int i : order) {
        for (; current < block[size_t(i)]; current++)
            for (int k : released[size_t(current)]) unused[p.at(k).is_vector].push_back(shared[size_t(k)]);
        if (last[size_t(i)] <= current) continue;
        const bool is_vector = p.at(i).is_vector;
        std::vector<int> &u = unused[is_vector];
        if (u.empty()) u.push_back(is_vector ? kept_vectors++ : kept++);
        shared[size_t(i)] = u.back();
        u.pop_back();
        released[size_t(last[size_t(i)])].push_back(i);
    }
}

std::string writer::elements(int i) const {
    std::string s;
    for (int l = 0; l < t.limbs; l++) s += (l ? ", " : "") + operand_signed(p.at(i).arg[l]);
    return s;
}

/* A vector of scalars; "side_by_side(v[6])" where they stand one behind the other. */
std::string writer::gathered(int i) const {
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

std::string writer::leaf(int i) const {
    const node &n = p.at(i);
    if (n.op == CONSTANT) return number(n.constant);
    if (n.op == GATHER) return "(limbs){" + elements(i) + "}";
    if (n.op == LOADED) return format("rows[%d]", n.arg[0]);
    if (n.op == INPUT) return format("%s[%d]", f.inputs[size_t(n.arg[0])].name.c_str(), n.arg[1]);
    return format("%s[%d]", n.op == SINE ? "sine" : "cosine", angle.at(p.angle_of(i)));
}

std::string writer::operand_signed(value x) const {
    const int i = node_of(x);
    const std::string s = (is_negative(x) != bool(p.flipped[size_t(i)]) ? "-" : "") + operand(i);
    return p.at(i).op == CONSTANT && t.lanes > 1 ? "splat(" + s + ")" : s;
}

/* An angle, as one expression of the inputs. */
std::string writer::angle_text(value x) const {
    const node &n = p.at(node_of(x));
    std::string s;
    if (n.op == ADD)
        s = "(" + angle_text(n.arg[0]) + " + " + angle_text(n.arg[1]) + ")";
    else if (n.op == MULTIPLY)
        s = angle_text(n.arg[0]) + " * " + angle_text(n.arg[1]);
    else
        s = leaf(node_of(x));
    return is_negative(x) ? "-" + s : s;
}

/* First a term that is no product and positive, for what follows to be fused to; else what is there. */
std::string writer::sum(int i) const {
    std::vector<term> all = p.terms[size_t(i)];
    const auto rank = [&](const term &x) {
        const bool negative = p.term_is_negative(i, x);
        return x.b < 0 ? (negative ? 2 : 0) : negative ? 3 : 1;
    };
    const auto bring = [&](size_t to, auto better) {
        size_t best = to;
        for (size_t k = to; k < all.size(); k++)
            if (better(all[k], all[best])) best = k;
        std::rotate(all.begin() + long(to), all.begin() + long(best), all.begin() + long(best) + 1);
    };
    bring(0, [&](const term &x, const term &y) { return rank(x) < rank(y); });
    if (all[0].b >= 0) /* a b - c is one operation */
        bring(1, [](const term &x, const term &y) { return x.b < 0 && y.b >= 0; });
    std::string s;
    for (size_t k = 0; k < all.size(); k++) {
        const bool negative = p.term_is_negative(i, all[k]);
        s += k == 0 ? (negative ? "-" : "") : negative ? " - " : " + ";
        s += operand(all[k].a) + (all[k].b < 0 ? "" : " * " + operand(all[k].b));
    }
    return s;
}

std::string writer::expression(int i) const {
    const node &n = p.at(i);
    const term &x = p.terms[size_t(i)][0];
    switch (n.op) {
    case ADD: return sum(i);
    case MULTIPLY: return operand(x.a) + " * " + operand(x.b);
    case DIVIDE: return operand(x.a) + " / " + operand(x.b);
    case ROOT: return "root(" + operand_signed(n.arg[0]) + ")";
    case SELECT:
        return format("choose(%s < %s, %s, %s)", operand_signed(n.arg[0]).c_str(),
                      operand_signed(n.arg[1]).c_str(), operand_signed(n.arg[2]).c_str(),
                      operand_signed(n.arg[3]).c_str());
    case GATHER: return gathered(i);
    default: abort();
    }
}

/* The lanes of a vector are stored as one where they stand one behind the other. */
std::string writer::stores_of(int i) const {
    const auto found = stores.find(i);
    std::string s;
    if (found == stores.end()) return s;
    const std::vector<store> &all = found->second;
    for (size_t k = 0; k < all.size(); k++) {
        const store &to = all[k];
        size_t n = 0;
        while (to.lane == 0 && k + n < all.size() && all[k + n].lane == int(n) && all[k + n].k == to.k + n &&
               all[k + n].array == to.array && all[k + n].negative == to.negative)
            n++;
        const bool whole = to.lane == 0 && n == size_t(t.limbs);
        const std::string place = format("%s[%zu]", to.array.c_str(), to.k);
        s += "    " + (whole ? "side_by_side(" + place + ")" : place) + " = " +
             operand_signed(negated(2 * i, to.negative)) +
             (whole || to.lane < 0 ? "" : format("[%d]", to.lane)) + ";\n";
        if (whole) k += n - 1;
    }
    return s;
}

std::string writer::operand(int i) const {
    const node &n = p.at(i);
    if (n.op == LANE) return operand(node_of(n.arg[0])) + format("[%d]", int(n.constant));
    return p.is_leaf(i) ? leaf(i) : name[size_t(i)];
}

std::string writer::statement(int i) {
    std::string &own = name[size_t(i)];
    own = format("t%d", i);
    const bool is_vector = p.at(i).is_vector;
    std::string s =
        (is_vector ? "    const limbs " : "    const real ") + own + " = " + expression(i) + ";\n";
    s += stores_of(i);
    if (shared[size_t(i)] >= 0)
        s += format("    k%s[%d] = %s;\n", is_vector ? "l" : "", shared[size_t(i)], own.c_str());
    return s;
}

std::string writer::block_text(int b) {
    std::string s;
    for (int i : order)
        if (block[size_t(i)] < b && shared[size_t(i)] >= 0)
            name[size_t(i)] = format("k%s[%d]", p.at(i).is_vector ? "l" : "", shared[size_t(i)]);
    for (int i : order)
        if (block[size_t(i)] == b) s += calls_before(i) + statement(i);
    return b == blocks - 1 ? s + calls_before(int(name.size())) : s;
}

/* ---- calls on rows ---- */

/* No call may have written a place again before a statement loads it. */
void writer::check_loads() const {
    std::vector<std::vector<int>> written(size_t(f.rows)); /* of each place: the calls */
    for (size_t k = 0; k < f.calls.size(); k++)
        for (int at : places_written(f.calls[k])) written[size_t(at)].push_back(int(k));
    const auto check = [&](int i, int at) {
        const node &n = p.at(i);
        if (n.op != LOADED) return;
        for (int k : written[size_t(n.arg[0])])
            if (k > n.arg[1] && f.calls[size_t(k)].node <= at)
                throw std::logic_error("a row is read when it has been written again");
    };
    for (int i : order)
        for (int k : p.operands(i)) check(k, i);
    for (value x : f.results) check(node_of(x), int(name.size()));
    for (value x : f.pivots) check(node_of(x), int(name.size()));
}

std::string writer::calls_before(int i) {
    std::string s;
    for (; calls < f.calls.size() && f.calls[calls].node <= i; calls++) {
        const std::vector<row_call::store> &all = f.calls[calls].stores;
        const value zero = f.code.find_constant(0);
        for (size_t k = 0, n = 0; k < all.size(); k += n ? n : 1, n = 0) {
            while (k + n < all.size() && all[k + n].x == zero && all[k + n].at == all[k].at + int(n)) n++;
            if (n > 2)
                s += format("    CLEAR(%d, rows + %d);\n", int(n), all[k].at);
            else if (n = 0, is_for_call(all[k]))
                s += format("    rows[%d] = %s;\n", all[k].at, operand_signed(all[k].x).c_str());
        }
        s += format("    %s_%s_rows_%zu(rows);\n", t.name.c_str(), f.name.c_str(), calls);
    }
    return s;
}

std::string writer::call_texts() const {
    std::string s;
    for (size_t k = 0; k < f.calls.size(); k++)
        s += format("PART void %s_%s_rows_%zu(scalar *restrict rows) {\n%s}\n", t.name.c_str(),
                    f.name.c_str(), k, sums_text(f.calls[k]).c_str());
    return s;
}

/* Results that stand in rows, as long as they stand there one behind the other. */
std::string writer::copies() const {
    std::string s;
    size_t first = 0;
    for (const array &a : f.outputs) {
        const auto at = [&](int k) {
            if (k == a.size || !is_copied(f.results[first + size_t(k)])) return -a.size;
            return p.at(node_of(f.results[first + size_t(k)])).arg[0];
        };
        for (int k = 0, n = 1; k < a.size; k += n, n = 1) {
            if (at(k) < 0) continue;
            while (at(k + n) == at(k) + n) n++;
            s += format("    COPY(%d, %s + %d, %d);\n", n, a.name.c_str(), k, at(k));
        }
        first += size_t(a.size);
    }
    return s;
}

/* One after the other, so that right angles and angles of any size are those of rbd.h. */
std::string writer::reproducible_sines() const {
    const size_t n = p.angles.size();
    std::string angles, quarters, s;
    for (const wanted_angle &x : p.angles) {
        const bool is_constant = f.code.is_constant(x.x);
        const char *before = angles.empty() ? "" : ", ";
        angles += before + (is_constant ? "splat(" + angle_text(x.x) + ")" : angle_text(x.x));
        quarters += before + number(f.code.constant_of(x.quarters));
    }
    s = format("    static const scalar quarters[%zu] = {%s};\n    const real angle[%zu] = {%s};\n"
               "    real sine[%zu], cosine[%zu];\n",
               n, quarters.c_str(), n, angles.c_str(), n, n);
    if (refuses()) s += format("    pivot[%zu] = splat(1);\n", f.pivots.size());
    return s + format("    sines_of(angle, quarters, %zu, sine, cosine, %s);\n", n,
                      refuses() ? format("pivot + %zu", f.pivots.size()).c_str() : "0");
}

std::string writer::sines() const {
    const size_t n = p.angles.size(), padded = (n + 3) / 4 * 4;
    if (n == 0) return "";
    if (t.is_reproducible) return reproducible_sines();
    std::string s = format("    real angle[%zu], sine[%zu], cosine[%zu];\n    batch squares = {0};\n", padded,
                           padded, padded);
    for (size_t k = 0; k < n; k += 4) {
        s += format("    sines4(%zu", std::min<size_t>(4, n - k));
        for (size_t j = k; j < k + 4; j++) s += ", " + angle_text(p.angles[j < n ? j : k].x);
        s += format(", angle + %zu, sine + %zu, cosine + %zu, &squares);\n", k, k, k);
    }
    s += format("    SINES_OF(%zu);\n", n);
    if (!refuses()) return s + format("    SINES_BEYOND(%zu, 0);\n", n);
    return s + format("    pivot[%zu] = %s;\n    SINES_BEYOND(%zu, pivot + %zu);\n", f.pivots.size(),
                      t.lanes > 1 ? "splat(1)" : "1", n, f.pivots.size());
}

/* Results that are no statements, and the judgement of the pivots. */
std::string writer::end() const {
    std::string s = copies();
    for (const auto &x : stores)
        if (!p.is_statement[size_t(x.first)]) s += stores_of(x.first);
    if (f.pivots.empty()) return s;
    const std::string pivots = format("pivot, %s_%s_limit, %zu", t.name.c_str(), f.name.c_str(), judged());
    const auto judge = [&](const char *how, const array &a) {
        return format("%s(%s, %s, %d)", how, pivots.c_str(), a.name.c_str(), a.size);
    };
    s += "    const int status = " + judge("judge", f.outputs[0]) + ";\n";
    for (size_t k = 1; k < f.outputs.size(); k++)
        s += "    if (status) (void)" + judge("judge_closely", f.outputs[k]) + ";\n";
    return s + "    return status;\n";
}

std::string writer::text() {
    const std::string full = t.name + "_" + f.name;
    const bool angles = !p.angles.empty(), pivots = !f.pivots.empty();
    const std::string all = parameters(f, "real", "restrict ");
    std::string s = call_texts(), parts;
    if (pivots) {
        s += format("static const scalar %s_limit[%zu] = {", full.c_str(), judged());
        for (size_t k = 0; k < judged(); k++)
            s += (k ? ", " : "") + number(k < f.limits.size() ? f.limits[k] : 0);
        s += "};\n";
    }
    std::string more = ", real *restrict k", pass = ", k";
    if (f.rows > 0) more += ", real *restrict rows", pass += ", rows";
    if (kept_vectors > 0) more += ", limbs *restrict kl", pass += ", kl";
    if (angles) more += ", const real *restrict sine, const real *restrict cosine", pass += ", sine, cosine";
    if (pivots) more += ", real *restrict pivot", pass += ", pivot";
    for (int b = 0; b < blocks && blocks > 1; b++) {
        s += format(
            "PART void %s_%d(%s%s) {\n    %s, (void)k%s%s%s;\n%s}\n", full.c_str(), b, all.c_str(),
            more.c_str(), names(f, "(void)").c_str(),
            (std::string(kept_vectors > 0 ? ", (void)kl" : "") + (f.rows > 0 ? ", (void)rows" : "")).c_str(),
            angles ? ", (void)sine, (void)cosine" : "", pivots ? ", (void)pivot" : "", block_text(b).c_str());
        parts += format("    %s_%d(%s%s);\n", full.c_str(), b, names(f).c_str(), pass.c_str());
    }
    s += format("%s %s(%s) {\n", result_type(f), full.c_str(), all.c_str());
    if (blocks > 1) s += format("    real k[%d]; /* kept for later parts */\n", std::max(1, kept));
    if (kept_vectors > 0) s += format("    limbs kl[%d];\n", kept_vectors);
    if (f.rows > 0) s += format("    real rows[%d];\n", f.rows);
    if (pivots) s += format("    real pivot[%zu];\n", judged());
    s += sines() + (blocks > 1 ? parts : block_text(0));
    return s + "    " + names(f, "(void)") + ";\n" + end() + "}\n\n";
}

/* The range of the angles, how pivots are judged, and what is not checked. */
std::string contract(const function &f, const program &p, const target &t) {
    const char *limit = t.is_float ? "1e4" : "1e6";
    const bool pivots = !f.pivots.empty();
    std::string s;
    if (p.angles.empty())
        s += "   Angles: none.\n";
    else if (!t.is_bounded)
        s += t.is_reproducible ? "   Angles: any.\n"
                               : format("   Angles: any; from %s rad on by libm.\n", limit);
    else if (pivots)
        s += format("   Angles: below %s rad in size. Else, and if one is NaN, it returns -1 - %s_NV.\n",
                    limit, upper(t.name).c_str());
    else
        s += format("   Angles: below %s rad in size. Else, and if one is NaN, results that depend on it are "
                    "NaN.\n",
                    limit);
    if (pivots)
        s += format(
            "   Pivots: M counts as singular where one is at most %.2g of the largest inertia that its "
            "joint can move.\n",
            f.noise);
    s += "   Not checked: pointers, lengths, overlap; that ";
    s += p.angles.empty() || !t.is_bounded ? "" : "other ";
    s += "input is finite: what depends on NaN is NaN";
    return s + (pivots ? ";\n      it returns 0 unless M depends on it.\n" : ".\n");
}

} // namespace

/* ---- the files ---- */

std::string declarations(const std::vector<tested> &functions, const target &t) {
    std::string s;
    if (t.lanes > 1)
        s += format("/* %d states at once: element k of each array holds coordinate k of all. */\n"
                    "typedef %s %s_real __attribute__((vector_size(%d * sizeof(%s))));\n\n",
                    t.lanes, t.is_float ? "float" : "double", t.name.c_str(), t.lanes,
                    t.is_float ? "float" : "double");
    for (const tested &x : functions) {
        const program p(x.f, t.statements);
        const operations n = p.count();
        s += "/* " + x.f.about + "\n";
        for (const std::vector<array> *list : {&x.f.inputs, &x.f.outputs})
            for (const array &a : *list) s += format("   %-8s %s\n", a.name.c_str(), a.shape);
        s += contract(x.f, p, t);
        s += format("   Operations: %d multiplications, %d additions, %d divisions, %d roots, %d sines and "
                    "cosines.",
                    n.multiplications, n.additions, n.divisions, n.roots, n.angles);
        if (n.of_vectors > 0) s += format("\n   Of these %d are of %d limbs at once.", n.of_vectors, t.limbs);
        if (n.of_fours > 0) s += format("\n   And %d on four columns of rows at once.", n.of_fours);
        s += " */\n";
        s += format("%s %s_%s(%s);\n\n", result_type(x.f), t.name.c_str(), x.f.name.c_str(),
                    parameters(x.f, real_name(t), "").c_str());
    }
    return s;
}

namespace {

const char compiler_begin[] = R"(
#include <float.h>
#include <math.h>
#include <stdint.h>

#if defined __FAST_MATH__ || defined __ASSOCIATIVE_MATH__
#error "reassociation voids the sine's argument reduction: compile without -ffast-math"
#endif
)";

const char compiler_contraction[] = R"(
/* GCC's vectoriser packs scalars and loses time by it, as does its first scheduler on Arm, which spills; its
   ISO modes switch contraction to fused operations off. */
#if defined __GNUC__ && !defined __clang__ && defined __OPTIMIZE__
#pragma GCC optimize("no-tree-slp-vectorize,no-tree-vectorize,no-math-errno,fp-contract=fast")
#ifdef __arm__
#pragma GCC optimize("no-schedule-insns")
#endif
#elif defined __clang__
#pragma STDC FP_CONTRACT ON
#endif
)";

const char compiler_reproducible[] = R"(
#ifdef __RECIPROCAL_MATH__
#error "divisions have the bits of IEEE 754: compile without -freciprocal-math"
#endif

/* Products and sums are rounded one by one: no FMA. GCC's vectoriser packs scalars and loses time by it, as
   does its first scheduler on Arm, which spills. */
#ifdef __clang__
#pragma clang fp contract(off)
#elif defined __GNUC__
#pragma GCC optimize("fp-contract=off")
#ifdef __OPTIMIZE__
#pragma GCC optimize("no-tree-slp-vectorize,no-tree-vectorize,no-math-errno")
#ifdef __arm__
#pragma GCC optimize("no-schedule-insns")
#endif
#endif
#else
#pragma STDC FP_CONTRACT OFF
#endif
)";

const char compiler_end[] = R"(
#ifdef __GNUC__
#define INLINE static inline __attribute__((always_inline, unused))
#define PART static __attribute__((noinline))
#define COLD static __attribute__((noinline, cold, unused))
#else
#define INLINE static inline
#define PART static
#define COLD static
#endif
#if defined __GNUC__ && defined __FLT_EVAL_METHOD__ && (__FLT_EVAL_METHOD__ == 0 || __FLT_EVAL_METHOD__ > 2)
#define OWN_SINES
#endif
)";

const char evaluation_text[] = R"(
/* Products and sums are rounded to the scalar. tcc does not tell how. */
#ifdef __FLT_EVAL_METHOD__
#define EVALUATION __FLT_EVAL_METHOD__
#elif defined FLT_EVAL_METHOD
#define EVALUATION FLT_EVAL_METHOD
#elif defined __TINYC__ && !defined __i386__
#define EVALUATION 0
#else
#define EVALUATION -1
#endif
#ifdef SCALAR_IS_FLOAT
#define KEEPS_DIGITS (EVALUATION == 1 || EVALUATION == 2 || EVALUATION < 0)
#else
#define KEEPS_DIGITS (EVALUATION == 2 || EVALUATION < 0)
#endif
#if KEEPS_DIGITS
#error "not reproducible: x87 keeps more digits, use SSE2; s390x keeps those of double, use -std=gnu99"
#endif
)";

const char scalar_text[] = R"(
typedef scalar real;
INLINE real choose(int k, real x, real y) { return k ? x : y; }
INLINE real root(real x) { return LIBM_SQRT(x); }
)";

const char limbs_text[] = R"(
/* Like limbs, side by side. */
#if defined __GNUC__ && !defined __clang__
#pragma GCC diagnostic ignored "-Wpsabi"
#endif
typedef scalar limbs __attribute__((vector_size(LIMBS * sizeof(scalar))));
typedef scalar limbs_in_memory
    __attribute__((vector_size(LIMBS * sizeof(scalar)), aligned(sizeof(scalar)), may_alias));
#define side_by_side(first) (*(limbs_in_memory *)&(first))
)";

const char lanes_text[] = R"(
#if defined __GNUC__ && !defined __clang__
#pragma GCC diagnostic ignored "-Wpsabi"
#endif
typedef signed_bit mask __attribute__((vector_size(LANES * sizeof(scalar))));
INLINE real splat(scalar x) {
    const real zero = {0};
    return zero + x;
}
INLINE real choose(mask k, real x, real y) { return (real)(((mask)x & k) | ((mask)y & ~k)); }
INLINE real root(real x) {
    for (int i = 0; i < LANES; ++i) x[i] = LIBM_SQRT(x[i]);
    return x;
}
)";

/* As rbd.h's verdict on pivots: the first in the order of elimination that is not sound. */
const char judge_text[] = R"(
/* Pivots are sound if they are above their rounding. 0 if all are; else 1 + the first dof, in the order of
   elimination, whose pivot is not, its negative if that is not a number; the results become 0. Angles out of
   range are one pivot more, before the others. */
#if LANES > 1
COLD int judge_closely(const real *pivot, const scalar *limit, int n, real *x, int size) {
    int status = 0;
    mask sound = ~(mask){0};
    for (int k = n - 1; k >= 0; --k) {
        const mask ok = limit[k] < pivot[k], number = pivot[k] == pivot[k];
        int found = 0;
        for (int j = 0; j < LANES; ++j)
            if (!ok[j] && found >= 0) found = number[j] ? k + 1 : -1 - k;
        if (status == 0) status = found;
        sound &= ok;
    }
    for (int k = 0; k < size; ++k) x[k] = (real)((mask)x[k] & sound);
    return status;
}
INLINE int judge(const real *pivot, const scalar *limit, int n, real *x, int size) {
    mask sound = limit[0] < pivot[0];
    signed_bit all = -1;
    for (int k = 1; k < n; ++k) sound &= limit[k] < pivot[k];
    for (int j = 0; j < LANES; ++j) all &= sound[j];
    return all ? 0 : judge_closely(pivot, limit, n, x, size);
}
#else
COLD int judge_closely(const real *pivot, const scalar *limit, int n, real *x, int size) {
    int k = n - 1;
    while (limit[k] < pivot[k]) --k;
    for (int j = 0; j < size; ++j) x[j] = 0;
    return pivot[k] < pivot[k] || pivot[k] >= pivot[k] ? k + 1 : -1 - k;
}
INLINE int judge(const real *pivot, const scalar *limit, int n, real *x, int size) {
    int sound = 1;
    for (int k = 0; k < n; ++k) sound &= limit[k] < pivot[k];
    return sound ? 0 : judge_closely(pivot, limit, n, x, size);
}
#endif

)";

std::string numbers(const std::vector<double> &x, bool is_float) {
    std::string s = "{";
    for (size_t k = 0; k < x.size(); k++)
        s += (k == 0 ? "" : k % 6 == 0 ? ",\n     " : ", ") + literal(x[k], is_float);
    return s + "}";
}

const char selftest_text[] = R"(
/* Relative to the largest, which counts as 0.001 at least. */
#define SELFTEST_FLOOR 0.001
static int differs(const real *x, const scalar *y, int n, int lane, scalar tolerance, scalar *worst) {
    scalar largest = (scalar)SELFTEST_FLOOR;
    int same = 1;
    for (int k = 0; k < n; ++k) {
        if (y[k] > largest) largest = y[k];
        if (-y[k] > largest) largest = -y[k];
    }
    for (int k = 0; k < n; ++k) {
#if LANES > 1
        const scalar d = (x[k][lane] - y[k]) / largest;
#else
        const scalar d = (x[k] - y[k]) / largest;
        (void)lane;
#endif
        same = same && d <= tolerance && -d <= tolerance;
        if (!(d <= *worst)) *worst = d;
        if (!(-d <= *worst)) *worst = -d;
    }
    return !same;
}
static void give(const scalar *y, int n, int lane, real *x) {
#if LANES > 1
    for (int k = 0; k < n; ++k) x[k][lane] = y[k];
#else
    for (int k = 0; k < n; ++k) x[k] = y[k];
    (void)lane;
#endif
}
)";

const char selftest_beyond_text[] = R"(
/* Whether in this lane none of the n is NaN. */
COLD int has_numbers(const real *x, int n, int lane) {
#if LANES > 1
    for (int k = 0; k < n; ++k)
        if (x[k][lane] != x[k][lane]) return 0;
#else
    (void)lane;
    for (int k = 0; k < n; ++k)
        if (x[k] != x[k]) return 0;
#endif
    return 1;
}
)";

/* The first input that an angle depends on, and the angle's derivative by it. */
const node &input_of(const graph &g, value angle, double *slope) {
    const node &n = g.nodes[size_t(node_of(angle))];
    if (n.op == INPUT) return n;
    const int k = g.is_constant(n.arg[0]);
    if ((n.op != ADD && n.op != MULTIPLY) || g.is_constant(n.arg[k])) abort();
    if (n.op == MULTIPLY) *slope *= g.constant_of(n.arg[1 - k]);
    return input_of(g, n.arg[k], slope);
}

/* An angle a thousand times too large, where unchecked polynomials still have values, is refused. */
std::string selftest_beyond(const function &f, value angle, const target &t, const std::string &call) {
    double slope = 1;
    const node &n = input_of(f.code, angle, &slope);
    const double beyond = (t.is_float ? 1e7 : 1e9) / std::fabs(slope);
    std::string s =
        format("    for (int j = 0; j < LANES; ++j) {\n        const scalar beyond[1] = {%s};\n"
               "        give(beyond, 1, j, %s + %d);\n    }\n",
               literal(beyond, t.is_float).c_str(), f.inputs[size_t(n.arg[0])].name.c_str(), n.arg[1]);
    if (!f.pivots.empty())
        return s + format("    return %s == -1 - %zu ? 0 : 2;\n", call.c_str(), f.pivots.size());
    s += "    " + call + ";\n    for (int j = 0; j < LANES; ++j)\n        if (";
    for (size_t k = 0; k < f.outputs.size(); k++)
        s +=
            format("%shas_numbers(%s, %d, j)", k ? " && " : "", f.outputs[k].name.c_str(), f.outputs[k].size);
    return s + ") return 2;\n    return 0;\n";
}

/* The rows of its table, its name, the macro that adds a main, its name. */
const char selftest_end[] = R"(static const struct {
    const char *name;
    int (*run)(scalar *worst); /* 0: right */
    int states;
    scalar tolerance;
} selftests[] = {
%s};
enum { SELFTESTS = sizeof selftests / sizeof *selftests };
int %s_selftest(void) {
    for (int k = 0; k < SELFTESTS; ++k) {
        scalar worst = 0;
        if (selftests[k].run(&worst)) return k + 1;
    }
    return 0;
}
#ifdef %s_MAIN
#include <stdio.h>
int main(void) {
    static const char *const verdicts[] = {"right", "WRONG", "WRONG: takes an angle out of range"};
    for (int k = 0; k < SELFTESTS; ++k) {
        scalar worst = 0;
        const int status = selftests[k].run(&worst);
        printf("%%s: %%d states, largest error %%.1e, %%.1e allowed: %%s\n", selftests[k].name,
               selftests[k].states, (double)worst, (double)selftests[k].tolerance, verdicts[status]);
    }
    return %s_selftest();
}
#endif
#endif
)";

/* A function that runs all functions on known states. */
std::string selftest(const std::vector<tested> &functions, const target &t) {
    const std::string test = upper(t.name) + "_SELFTEST";
    std::string s = "#ifdef " + test + "\n" + selftest_text, rows;
    bool angles = false;
    for (const tested &x : functions) angles = angles || !program(x.f, t.statements).angles.empty();
    if (t.is_bounded && angles) s += selftest_beyond_text;
    for (const tested &x : functions) {
        const function &f = x.f;
        const program p(f, t.statements);
        const int states = int(x.examples.size());
        const auto table = [&](const std::string &name, const array &a, auto get) {
            s += format("static const scalar %s_%s_%s[%d][%d] = {\n", t.name.c_str(), f.name.c_str(),
                        name.c_str(), states, a.size);
            for (const example &e : x.examples) s += "    " + numbers(get(e), t.is_float) + ",\n";
            s += "};\n";
        };
        for (size_t k = 0; k < f.inputs.size(); k++)
            table("of_" + f.inputs[k].name, f.inputs[k], [k](const example &e) { return e.in[k]; });
        size_t first = 0;
        for (const array &a : f.outputs) {
            table("is_" + a.name, a, [&](const example &e) {
                return std::vector<double>(e.out.begin() + long(first), e.out.begin() + long(first) + a.size);
            });
            first += size_t(a.size);
        }
        const std::string tolerance = literal(x.tolerance, t.is_float);
        s += format("static int test_%s(scalar *worst) {\n    ", f.name.c_str());
        for (const std::vector<array> *list : {&f.inputs, &f.outputs})
            for (const array &a : *list) s += format("static real %s[%d];\n    ", a.name.c_str(), a.size);
        s += format("for (int k = 0; k < %d; ++k) {\n        for (int j = 0; j < LANES; ++j) {\n", states);
        for (const array &a : f.inputs)
            s += format("            give(%s_%s_of_%s[(k + j) %% %d], %d, j, %s);\n", t.name.c_str(),
                        f.name.c_str(), a.name.c_str(), states, a.size, a.name.c_str());
        const std::string call = format("%s_%s(%s)", t.name.c_str(), f.name.c_str(), names(f).c_str());
        s += "        }\n        " + (f.pivots.empty() ? call + ";\n" : "if (" + call + " != 0) return 1;\n");
        for (const array &a : f.outputs)
            s += format(
                "        for (int j = 0; j < LANES; ++j)\n"
                "            if (differs(%s, %s_%s_is_%s[(k + j) %% %d], %d, j, %s, worst)) return 1;\n",
                a.name.c_str(), t.name.c_str(), f.name.c_str(), a.name.c_str(), states, a.size,
                tolerance.c_str());
        s += "    }\n" +
             (t.is_bounded && !p.angles.empty() ? selftest_beyond(f, p.angles[0].x, t, call)
                                                : std::string("    return 0;\n")) +
             "}\n";
        rows += format("    {\"%s_%s\", test_%s, %d, %s},\n", t.name.c_str(), f.name.c_str(), f.name.c_str(),
                       states, tolerance.c_str());
    }
    return s + format(selftest_end, rows.c_str(), t.name.c_str(), test.c_str(), t.name.c_str());
}

} // namespace

std::string definitions(const std::vector<tested> &functions, const target &t) {
    const char *scalar = t.is_float ? "float" : "double", *suffix = t.is_float ? "f" : "";
    std::string s = compiler_begin;
    s += t.is_reproducible ? compiler_reproducible : compiler_contraction;
    s += compiler_end;
    s += format("\ntypedef %s scalar;\n#define LANES %d\n#define LIBM_SIN sin%s\n#define LIBM_COS cos%s\n"
                "#define LIBM_SQRT sqrt%s\n",
                scalar, t.lanes, suffix, suffix, suffix);
    if (t.is_float) s += "#define SCALAR_IS_FLOAT\n";
    if (t.is_reproducible) s += evaluation_text;
    if (t.is_bounded) s += "#define ANGLES_ARE_BOUNDED\n";
    if (t.lanes > 1)
        s += format("typedef %s_real real;\ntypedef %s signed_bit;\n", t.name.c_str(),
                    t.is_float ? "int32_t" : "int64_t") +
             lanes_text;
    else
        s += scalar_text;
    if (t.limbs > 1) s += format("\n#define LIMBS %d\n", t.limbs) + limbs_text;
    bool angles = false, pivots = false, rows = false;
    for (const tested &x : functions) {
        rows = rows || x.f.rows > 0;
        angles = angles || !program(x.f, t.statements).angles.empty();
        pivots = pivots || !x.f.pivots.empty();
    }
    if (angles) s += std::string(t.is_float ? sines_float : sines_double);
    if (angles) s += t.is_reproducible ? sines_reproducible(t.is_float, t.is_bounded) : sines_common;
    if (pivots) s += judge_text;
    if (rows) s += rows_text();
    s += "\n";
    for (const tested &x : functions) s += writer(x.f, t).text();
    return s + selftest(functions, t);
}

} // namespace codegen
