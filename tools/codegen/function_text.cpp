/* A function as C: its sines, its statements, by blocks, its calls on rows, its verdict.
   SPDX-License-Identifier: MIT */
#include "statements.h"
#include <algorithm>

namespace codegen {
namespace {

class writer {
  public:
    writer(const program &p_, const target &t_)
        : f(p_.f), t(t_), p(p_), b(p, t_.block), c(p, t_), full(t_.name + "_" + f.name) {}
    std::string text();
    size_t stack_bytes() const;

  private:
    const function &f;
    const target &t;
    const program &p;
    const blocks b;
    statements c;
    const std::string full; /* name */
    size_t calls = 0;       /* written */

    /* Arrays of the function, which its parts share. */
    struct local {
        const char *type, *name;
        size_t size;
        int scalars; /* of an element */
    };
    std::vector<local> locals() const;
    static size_t padded(size_t angles) { return (angles + 3) / 4 * 4; }

    std::string calls_before(int i);
    std::string copies() const;
    std::string clears() const;
    std::string block_text(int k);
    std::string part(int k, const std::string &arguments);
    std::string sines() const;
    std::string end() const;

    /* Whether angles beyond are refused by a status: by one more pivot, 1 or NaN, which is judged first. */
    bool refuses() const { return t.is_bounded && !p.angles.empty() && !f.pivots.empty(); }
    size_t judged() const { return size_t(f.judged()) + refuses(); }
};

/* ---- calls on rows ---- */

std::string writer::calls_before(int i) {
    std::string s;
    for (; calls < f.calls.size() && f.calls[calls].node <= i; calls++) {
        for (const row_call::store &x : f.calls[calls].stores)
            if (p.is_for_call(x) && !c.is_cleared(x.x))
                s += format("    rows[%d] = %s;\n", x.at, c.of(x.x).c_str());
        s += format("    %s_rows_%zu(rows);\n", full.c_str(), calls);
    }
    return s;
}

/* Results that stand in rows, in runs, of which several may be rows of one matrix. */
std::string writer::copies() const {
    struct run {
        int to, from, n;
    };
    std::string s;
    size_t first = 0;
    for (const array &a : f.outputs) {
        std::vector<run> runs;
        for (int k = 0; k < a.size; k++) {
            const value x = f.results[first + size_t(k)];
            if (!c.is_copied(x)) continue;
            const int at = p.at(node_of(x)).arg[0];
            if (!runs.empty() && runs.back().to + runs.back().n == k &&
                runs.back().from + runs.back().n == at)
                runs.back().n++;
            else
                runs.push_back({k, at, 1});
        }
        for (size_t i = 0, count = 1; i < runs.size(); i += count, count = 1) {
            const run &x = runs[i], &next = runs[std::min(i + 1, runs.size() - 1)];
            const int pitch = next.to - x.to, step = next.from - x.from;
            for (; i + count < runs.size(); count++) {
                const run &y = runs[i + count];
                if (y.n != x.n || y.to != x.to + int(count) * pitch || y.from != x.from + int(count) * step)
                    break;
            }
            s += format("    copy_rows(%zu, %d, %s + %d, %d, rows + %d, %d);\n", count, x.n, a.name.c_str(),
                        x.to, pitch, x.from, step);
        }
        first += size_t(a.size);
    }
    return s;
}

/* The zeros of an array, before all else is stored: whole fours, which may reach over other elements. */
template <class function> std::string clear_text(const std::string &name, int size, function is_zero) {
    std::string s;
    for (int k = 0, n = 0; k < size; k += n ? n : 1, n = 0) {
        while (k + n < size && is_zero(k + n)) n += std::min<int>(FOUR, size - k - n);
        if (n > 0) s += format("    clear_row(%d, %s + %d);\n", n, name.c_str(), k);
    }
    return s;
}

std::string writer::clears() const {
    std::vector<char> is_zero(size_t(f.rows), 0);
    for (const row_call &call : f.calls)
        for (const row_call::store &x : call.stores) is_zero[size_t(x.at)] |= c.is_cleared(x.x);
    std::string s = clear_text("rows", f.rows, [&](int k) { return is_zero[size_t(k)] != 0; });
    const value *first = f.results.data();
    for (const array &a : f.outputs) {
        s += clear_text(a.name, a.size, [&](int k) { return c.is_cleared(first[k]); });
        first += a.size;
    }
    return s;
}

/* ---- parts ---- */

std::string writer::sines() const {
    const size_t n = p.angles.size();
    const auto angle = [&](size_t k) { return p.angles[std::min(k, n - 1)]; };
    const auto text = [&](size_t k) {
        const value x = angle(k).x;
        return f.code.is_constant(x) ? c.of(x) : c.of_angle(x);
    };
    const std::string verdict = refuses() ? format("pivot + %d", f.judged()) : "0";
    const char *quarters = t.is_reproducible ? "quarters" : "0";
    std::string s;
    if (n == 0) return s;
    if (t.is_reproducible)
        s += format("    static const scalar quarters[%zu] = {", padded(n)) +
             join(padded(n), ", ",
                  [&](size_t k) { return literal(f.code.constant_of(angle(k).quarters), t.is_float); }) +
             "};\n";
    s += "    batch squares = {0};\n";
    for (size_t k = 0; k < n; k += 4)
        s += format("    sines4(%zu, ", std::min<size_t>(4, n - k)) +
             join(4, ", ", [&](size_t j) { return text(k + j); }) +
             format(", %s, angle + %zu, sine + %zu, cosine + %zu, &squares);\n",
                    t.is_reproducible ? format("quarters + %zu", k).c_str() : "0", k, k, k);
    s += format("    SINES_OF(%zu, %s);\n", n, quarters);
    if (refuses()) s += format("    pivot[%d] = splat(1);\n", f.judged());
    return s + format("    if (!are_inside(squares)) sines_beyond(angle, %s, %zu, sine, cosine, %s);\n",
                      quarters, n, verdict.c_str());
}

std::string writer::block_text(int k) {
    const std::string s = codegen::block_text(p, b, &c, k, [this](int i) { return calls_before(i); });
    return k == b.count - 1 ? s + calls_before(int(c.name.size())) : s;
}

/* Results that are no statements, and the judgement of the pivots. */
std::string writer::end() const {
    std::string s = copies() + c.stores_of_others();
    if (f.pivots.empty()) return s;
    const auto judge = [&](const char *how, const array &a) {
        return format("%s(pivot, %s_limit, %zu, %s, %d)", how, full.c_str(), judged(), a.name.c_str(),
                      a.size);
    };
    s += "    const int status = " + judge("judge", f.outputs[0]) + ";\n";
    for (size_t k = 1; k < f.outputs.size(); k++)
        s += "    if (status) (void)" + judge("judge_closely", f.outputs[k]) + ";\n";
    if (f.rows_held == 0) return s + "    return status;\n";
    return s + format("    return status_of_rows(status, %d, %d, %d);\n", f.rows_held, f.dofs(), f.nv);
}

std::vector<writer::local> writer::locals() const {
    const size_t angles = padded(p.angles.size());
    std::vector<local> all;
    if (b.count > 1) all.push_back({"real", "k", size_t(std::max(1, b.kept)), t.lanes});
    if (b.kept_vectors > 0) all.push_back({"limbs", "kl", size_t(b.kept_vectors), t.limbs});
    if (f.rows > 0) all.push_back({"real", "rows", size_t(f.rows), t.lanes});
    if (!f.pivots.empty()) all.push_back({"real", "pivot", judged(), t.lanes});
    for (const char *name : {"angle", "sine", "cosine"})
        if (angles > 0) all.push_back({"real", name, angles, t.lanes});
    return all;
}

size_t writer::stack_bytes() const {
    size_t scalars = 0;
    for (const local &x : locals()) scalars += x.size * size_t(x.scalars);
    return scalars * (t.is_float ? sizeof(float) : sizeof(double));
}

/* A block, as a function that has the arrays of the whole. */
std::string writer::part(int k, const std::string &arguments) {
    std::string s = format("PART void part_%d_of_%s(", k, full.c_str()) + arguments;
    for (const local &x : locals()) s += format(", %s *restrict %s", x.type, x.name);
    s += ") {\n    " + names(f, "(void)");
    for (const local &x : locals()) s += format(", (void)%s", x.name);
    return s + ";\n" + block_text(k) + "}\n";
}

std::string writer::text() {
    const std::string arguments = parameters(f, "real", "restrict ");
    std::string s, body, arrays;
    for (size_t k = 0; k < f.calls.size(); k++)
        s += format("PART void %s_rows_%zu(scalar *restrict rows) {\n", full.c_str(), k) +
             call_text(f.calls[k]) + "}\n";
    if (!f.pivots.empty())
        s += format("static const scalar %s_limit[%zu] = {", full.c_str(), judged()) +
             join(judged(), ", ",
                  [&](size_t k) { return literal(k < f.limits.size() ? f.limits[k] : 0, t.is_float); }) +
             "};\n";
    if (b.count == 1) body = block_text(0);
    for (const local &x : locals()) arrays += format(", %s", x.name);
    for (int k = 0; k < b.count && b.count > 1; k++) {
        s += part(k, arguments);
        body += "    " + only_if(f, b.stances[size_t(k)], 0) + format("part_%d_of_%s(", k, full.c_str()) +
                names(f) + arrays + ");\n";
    }
    s += format("%s %s(%s) {\n", result_type(f), full.c_str(), arguments.c_str());
    for (const local &x : locals())
        s += format("    %s%s %s[%zu];\n", x.name == std::string("rows") ? "ALIGNED " : "", x.type, x.name,
                    x.size);
    if (f.stances > 0 && !f.pivots.empty()) /* of one that there is not, none is sound */
        s += format("    for (int i = 0; i < %d; ++i) pivot[i] = splat(0);\n", f.judged());
    return s + clears() + sines() + body + "    " + names(f, "(void)") + ";\n" + end() + "}\n\n";
}

} // namespace

std::string function_text(const program &p, const target &t) { return writer(p, t).text(); }
size_t stack_bytes(const program &p, const target &t) { return writer(p, t).stack_bytes(); }

} // namespace codegen
