/* The header's declarations, with their contracts, and the source. SPDX-License-Identifier: MIT */
#include "text.h"

namespace codegen {
namespace {

/* The range of the angles, how pivots are judged, and what is not checked. */
std::string contract(const program &p, const target &t) {
    const std::string nv = (t.is_cuda ? "" : upper(t.name) + "_") + "NV";
    const bool pivots = !p.f.pivots.empty(), refuses = t.is_bounded && !p.angles.empty(), M = p.f.dofs() > 0;
    std::string s = "   Angles: ";
    s += p.angles.empty() ? "none"
         : !refuses       ? "any"
                          : format("below %s rad in size. Else, and if one is NaN, ", angle_limit(t));
    if (refuses) s += pivots ? "it returns -1 - " + nv : "results that depend on it are NaN";
    s += ".\n";
    if (M)
        s += format(
            "   Pivots: M counts as singular where one is at most %.2g of the largest inertia that its "
            "joint can move.\n",
            p.f.noise);
    if (p.f.rows_held > 0)
        s += (M ? "   Rows: where a pivot of J M^-1 J' is at most " + format("%.0e", p.f.clear) +
                      " of its diagonal entry, a row depends on those\n      before it, or nearly: it "
                      "returns 1 + " +
                      nv + " + this row."
                : "   Pivots: A is J of the joints without motors. Where one of A'A is at most " +
                      format("%.0e", p.f.clear) +
                      " of its diagonal\n      entry, or a joint is held that was not when this was "
                      "written, it returns\n      more than " +
                      nv + ".") +
             " There call rbd.h, which decides.\n";
    if (p.f.rows_held > 0 && M)
        s += "   Digits: where a constraint holds a link of tiny inertia, rbd.h refines the rows, and this "
             "does not.\n";
    s += std::string("   Not checked: ") + (p.f.stances > 0 ? "the stance, " : "") +
         "pointers, lengths, overlap; that " + (refuses ? "other " : "") +
         "input is finite: what depends on NaN is NaN";
    if (!pivots) return s + ".\n";
    return s + ";\n      it returns 0 unless " +
           (p.f.rows_held == 0 ? "M"
            : M                ? "M or J of the constraints"
                               : "J") +
           " depends on it.\n";
}

std::string operations_text(const operations &n, const target &t) {
    std::string s =
        format("   Operations: %d multiplications, %d additions, %d divisions, %d roots, %d sines and "
               "cosines.",
               n.multiplications, n.additions, n.divisions, n.roots, n.angles);
    if (n.of_vectors > 0) s += format("\n   Of these %d are of %d limbs at once.", n.of_vectors, t.limbs);
    if (n.of_fours > 0) s += format("\n   And %d on four columns of rows at once.", n.of_fours);
    return s;
}

} // namespace

std::string comment_text(const tested &x, const program &p, const target &t) {
    std::string s = "/* " + x.f.about + "\n";
    if (x.f.stances > 0)
        s += format("   stance   0 to %d: which constraints hold, by a row of the table\n", x.f.stances - 1);
    for (const array &a : x.f.arrays()) s += format("   %-8s %s\n", a.name.c_str(), a.shape);
    return s + contract(p, t) + operations_text(p.count(), t);
}

std::string declarations(const std::vector<tested> &functions, const target &t) {
    const char *scalar = t.is_float ? "float" : "double";
    std::string s;
    if (t.lanes > 1)
        s += format("/* %d states at once: element k of each array holds coordinate k of all. */\n"
                    "typedef %s %s_real __attribute__((vector_size(%d * sizeof(%s))));\n\n",
                    t.lanes, scalar, t.name.c_str(), t.lanes, scalar);
    for (const tested &x : functions) {
        const program p(x.f, t);
        s += comment_text(x, p, t) +
             format("\n   Stack: arrays of %zu bytes, beside what the compiler keeps there. */\n",
                    stack_bytes(p, t));
        s += format("%s %s_%s(%s);\n\n", result_type(x.f), t.name.c_str(), x.f.name.c_str(),
                    parameters(x.f, real_name(t), "").c_str());
    }
    return s;
}

std::string definitions(const std::vector<tested> &functions, const target &t) {
    std::vector<piece> all;
    for (const tested &x : functions) all.push_back({x, program(x.f, t)});
    std::string s = common_text(all, t) + "\n";
    for (const piece &x : all) s += function_text(x.p, t);
    return s + selftest_text(all, t);
}

} // namespace codegen
