/* A function computed in a scalar. SPDX-License-Identifier: MIT */
#include "function.h"

namespace codegen {

template <class T>
std::vector<T> evaluate(const function &f, const std::vector<std::vector<double>> &in, int stance) {
    enum { LANES = 4 }; /* of scalars all the same */
    std::vector<T> x(LANES * f.code.nodes.size()), rows(size_t(f.rows)), results;
    size_t call = 0;
    const auto of = [&](value v, size_t l = 0) {
        const T y = x[LANES * size_t(node_of(v)) + l];
        return is_negative(v) ? -y : y;
    };
    for (size_t i = 0; i < x.size(); i++) {
        const node &n = f.code.nodes[i / LANES];
        const std::array<value, 4> &a = n.arg;
        const size_t l = i % LANES;
        for (; call < f.calls.size() && f.calls[call].node <= int(i / LANES); call++) {
            for (const row_call::store &s : f.calls[call].stores) rows[size_t(s.at)] = of(s.x);
            run(f.calls[call], rows);
        }
        switch (n.op) {
        case CONSTANT: x[i] = T(n.constant); break;
        case INPUT: x[i] = T(in[size_t(a[0])][size_t(a[1])]); break;
        case ADD: x[i] = of(a[0], l) + of(a[1], l); break;
        case MULTIPLY: x[i] = of(a[0], l) * of(a[1], l); break;
        case DIVIDE: x[i] = of(a[0], l) / of(a[1], l); break;
        case ROOT: x[i] = std::sqrt(of(a[0], l)); break;
        case SINE:
        case COSINE: {
            T own[2];
            own_sines(of(a[0], l), a[1] >= 0 ? of(a[1]) : T(0), &own[0], &own[1]);
            x[i] = own[n.op == COSINE];
            break;
        }
        case SELECT: x[i] = of(a[0], l) < of(a[1], l) ? of(a[2], l) : of(a[3], l); break;
        case GATHER: x[i] = a[l] < 0 ? 0 : of(a[l]); break;
        case LANE: x[i] = of(a[0], size_t(n.constant)); break;
        case LOADED: x[i] = rows[size_t(a[0])]; break;
        }
    }
    const size_t judged = size_t(f.judged()), n = f.results.size() / size_t(f.sets());
    for (size_t k = 0; k < judged; k++)
        if (!(of(f.pivots[size_t(stance) * judged + k]) > T(f.limits[k]))) return {};
    for (size_t k = 0; k < n; k++) results.push_back(of(f.results[size_t(stance) * n + k]));
    return results;
}
template std::vector<double> evaluate<double>(const function &, const std::vector<std::vector<double>> &,
                                              int);
template std::vector<float> evaluate<float>(const function &, const std::vector<std::vector<double>> &, int);

} // namespace codegen
