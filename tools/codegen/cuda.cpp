/* The functions as C++ for CUDA: templates over where a state lies, and a kernel for each.
   SPDX-License-Identifier: MIT */
#include "statements.h"
#include <algorithm>

namespace codegen {
namespace {

/* Whatever the robot. No header is needed: NVRTC has none. */
const char compilers_text[] = R"(
#if defined __USE_FAST_MATH__ && __USE_FAST_MATH__ + 0 /* NVRTC has 0 or 1; nvcc 13 tells nothing */
#error "singular pivots need whole quotients and roots: compile without --use_fast_math"
#endif
#if defined __FLT_EVAL_METHOD__ && (__FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2)
#error "the sine's argument reduction needs sums rounded to the scalar: x87 keeps more digits, use SSE2"
#endif

#ifndef RBD_CUDA
#define RBD_CUDA
#if defined __CUDACC__ || defined __CUDA__ || defined __HIP__
#ifndef RBD_THREADS
#define RBD_THREADS 128 /* most threads of a block: registers are shared out by it */
#endif
#define RBD_HD __host__ __device__ __forceinline__
#define RBD_KERNEL __global__ void __launch_bounds__(RBD_THREADS)
#define RBD_EACH_STATE(i, n) \
    const int i = (int)(blockIdx.x * blockDim.x + threadIdx.x); \
    if ((unsigned)i < (unsigned)(n))
#else /* a host alone: a kernel is a loop over all states */
#define RBD_HD inline
#define RBD_KERNEL void
#define RBD_EACH_STATE(i, n) for (int i = 0; i < (n); ++i)
#endif
#if defined __CUDA_ARCH__ || defined __HIP_DEVICE_COMPILE__ /* an array with constant indices is registers */
#define RBD_UNROLL _Pragma("unroll")
#else
#define RBD_UNROLL
#endif

/* Layouts: where the arrays of `size` scalars of n states stand. at() is what holds those of state i.
   rows     [n][size], as vectors stand in PyTorch, JAX and numpy
   blocks   [n / 32][size][32], memory for whole blocks: threads side by side read side by side
   columns  [size][n]: so too, but each address is computed */
namespace rbd {
template <class scalar, int stride> struct strided {
    scalar *first;
    RBD_HD scalar &operator[](int k) const { return first[k * stride]; }
};
template <class scalar> struct strided<scalar, 0> {
    scalar *first;
    int stride;
    RBD_HD scalar &operator[](int k) const { return first[(long long)k * stride]; }
};
struct rows {
    template <class scalar> static RBD_HD scalar *at(scalar *x, int size, int, int i) {
        return x + (long long)i * size;
    }
};
struct blocks {
    template <class scalar> static RBD_HD strided<scalar, 32> at(scalar *x, int size, int, int i) {
        return strided<scalar, 32>{x + (long long)(i / 32) * 32 * size + i % 32};
    }
};
struct columns {
    template <class scalar> static RBD_HD strided<scalar, 0> at(scalar *x, int, int n, int i) {
        return strided<scalar, 0>{x + i, n};
    }
};

RBD_HD float root(float x) {
#if defined __CUDACC__ && !defined __clang__
    return sqrtf(x);
#else
    return __builtin_sqrtf(x);
#endif
}
RBD_HD double root(double x) {
#if defined __CUDACC__ && !defined __clang__
    return sqrt(x);
#else
    return __builtin_sqrt(x);
#endif
}
} // namespace rbd
#endif
)";

/* Whatever the functions. */
const char scalar_text[] = R"(typedef scalar real;
using rbd::root;
RBD_HD real choose(bool k, real x, real y) { return k ? x : y; }

/* The status with pivot k, from that before it: the last that is not above its limit decides. */
RBD_HD int judged(int status, real pivot, real limit, int k) {
    return limit < pivot ? status : pivot <= limit ? k + 1 : -1 - k;
}
)";

const char angle_text[] = R"(
/* Returns whether x is below the limit; else its sine and cosine are NaN. */
RBD_HD bool sines(real x, real *s, real *c) {
    const bool is_inside = x * x < SINES_LIMIT * SINES_LIMIT;
    own_sincos_batch(is_inside ? x : own_from_bits(~(own_bit)0), 0, s, c);
    return is_inside;
}
)";

std::string replaced(std::string s, const std::string &from, const std::string &to) {
    for (size_t at = 0; (at = s.find(from, at)) != s.npos; at += to.size()) s.replace(at, from.size(), to);
    return s;
}

/* C's text, whose macros are not here. */
std::string in_cuda(const std::string &text) {
    return replaced(replaced(text, "INLINE", "RBD_HD"), "own_batch", "real");
}

std::string sines_for(const target &t) {
    return format("\n#define OWN_REAL_KIND %d\ntypedef %s own_bit;\n", t.is_float ? 2 : 1,
                  t.is_float ? "unsigned" : "unsigned long long") +
           in_cuda(own_sincos_text()) +
           replaced(angle_text, "SINES_LIMIT", angle_limit(t) + std::string(t.is_float ? "f" : "")) +
           "#undef OWN_REAL_KIND\n";
}

/* ---- one function ---- */

bool is_refusing(const program &p) { return !p.angles.empty() && !p.f.pivots.empty(); }

/* The sine and cosine of each angle, and whether all are below the limit if that is a status. */
std::string angles_of(const program &p, const statements &c) {
    const char *keep = is_refusing(p) ? "is_inside &= " : "";
    std::string s = is_refusing(p) ? "    bool is_inside = true;\n" : "";
    for (size_t k = 0; k < p.angles.size(); k++)
        s += format("    %ssines(%s, &sine[%zu], &cosine[%zu]);\n", keep, c.of_angle(p.angles[k].x).c_str(),
                    k, k);
    return s;
}

/* Each block stands in braces: names of statements begin anew. */
std::string statements_of(const program &p, const blocks &b, statements *c) {
    const auto nothing = [](int) { return ""; };
    std::string s;
    for (int k = 0; k < b.count; k++) {
        const std::string one = block_text(p, b, c, k, nothing);
        s += b.count == 1 ? one : "    " + only_if(p.f, b.stances[size_t(k)], 0) + "{\n" + one + "    }\n";
    }
    return s + c->stores_of_others();
}

/* The verdict on the pivots, and all results 0 where it is bad. */
std::string verdict_of(const program &p, const target &t) {
    const function &f = p.f;
    std::string s = "    int status = 0;\n";
    for (int k = 0; k < f.judged(); k++)
        s += format("    status = judged(status, pivot[%d], %s, %d);\n", k,
                    literal(f.limits[size_t(k)], t.is_float).c_str(), k);
    if (is_refusing(p)) s += format("    if (!is_inside) status = -1 - %d;\n", f.judged());
    s += "    if (status) {\n";
    for (const array &a : f.outputs)
        s += format("        %sfor (int i = 0; i < %d; ++i) %s[i] = 0;\n", a.size > 64 ? "" : "RBD_UNROLL ",
                    a.size, a.name.c_str());
    s += "    }\n";
    if (f.rows_held == 0) return s + "    return status;\n";
    return s + format("    return status_of_rows(status, %d, %d, %d);\n", f.rows_held, f.dofs(), f.nv);
}

std::string locals_of(const program &p, const blocks &b) {
    const function &f = p.f;
    std::string s = p.angles.empty()
                        ? ""
                        : format("    real sine[%zu], cosine[%zu];\n", p.angles.size(), p.angles.size());
    if (b.kept > 0) s += format("    real k[%d] = {};\n", b.kept); /* not each stance computes all */
    if (!f.pivots.empty())                                         /* of an unknown stance all fail */
        s += format("    real pivot[%d]%s;\n", f.judged(), f.stances > 0 ? " = {}" : "");
    return s;
}

std::string function_of(const program &p, const target &t) {
    const function &f = p.f;
    const std::vector<array> all = f.arrays();
    const blocks b(p, t.block);
    statements c(p, t);
    const auto type = [&](size_t k) { return "class of_" + all[k].name; };
    const auto argument = [&](size_t k) { return "of_" + all[k].name + " &&" + all[k].name; };
    return "template <" + join(all.size(), ", ", type) + ">\n" +
           format("RBD_HD %s %s(%s", result_type(f), f.name.c_str(), f.stances > 0 ? "int stance, " : "") +
           join(all.size(), ", ", argument) + ") {\n    " + names(f, "(void)") + ";\n" + locals_of(p, b) +
           angles_of(p, c) + statements_of(p, b, &c) + (f.pivots.empty() ? "" : verdict_of(p, t)) + "}\n";
}

/* One state to a thread; on a host all of them. */
std::string kernel_of(const function &f) {
    const std::vector<array> all = f.arrays();
    const std::string none = "", name = f.name,
                      stance = f.stances > 0 ? ", const int *__restrict__ stance" : "";
    const auto argument = [&](size_t k) {
        return (k < f.inputs.size() ? "const scalar *__restrict__ " : "scalar *__restrict__ ") + all[k].name;
    };
    const auto of_state = [&](size_t k) {
        return format("L::at(%s, %d, n, i)", all[k].name.c_str(), all[k].size);
    };
    return "template <class L>\nRBD_KERNEL " + name + "_kernel(int n" + stance + ", " +
           join(all.size(), ", ", argument) + (f.pivots.empty() ? none : ", int *__restrict__ status") +
           ") {\n    RBD_EACH_STATE(i, n) " + (f.pivots.empty() ? none : "status[i] = ") + name + "(" +
           (f.stances > 0 ? "stance[i], " : none) + join(all.size(), ", ", of_state) + ");\n}\n\n";
}

} // namespace

std::string cuda_text(const std::vector<tested> &functions, const target &t) {
    const std::string name = t.name, capitals = upper(name);
    std::string s, own;
    bool has_angles = false;
    for (const tested &x : functions) {
        const program p(x.f, t);
        has_angles = has_angles || !p.angles.empty();
        own += "\n" + comment_text(x, p, t) + " */\n" + function_of(p, t) + kernel_of(x.f);
    }
    s = flags_text + std::string(compilers_text) + "\nnamespace " + name + " {\nenum { NB = " + capitals +
        "_NB, NQ = " + capitals + "_NQ, NV = " + capitals + "_NV };\ntypedef " +
        (t.is_float ? "float" : "double") + " scalar;\n";
    s += scalar_text + in_cuda(status_text);
    if (has_angles) s += sines_for(t);
    return s + own + "} // namespace " + name + "\n";
}

} // namespace codegen
