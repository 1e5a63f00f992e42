// operations.cpp - the exact operations of each algorithm: the same header with a scalar that counts.
// CSV as rbd-bench --count perf has it; sums of differences are additions, a product with a constant is a
// product. SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>

namespace counting {

// In the order of `names` below.
enum { MUL, ADD, DIV, SQRT, SIN, COS, NEG, LESS, OPERATIONS };
static long counts[OPERATIONS];

class number {
  public:
    double value;
    number() = default;
    number(double v) : value(v) {}
};

inline number operator*(number a, number b) {
    counts[MUL]++;
    return number(a.value * b.value);
}
inline number operator+(number a, number b) {
    counts[ADD]++;
    return number(a.value + b.value);
}
inline number operator-(number a, number b) {
    counts[ADD]++;
    return number(a.value - b.value);
}
inline number operator-(number a) {
    counts[NEG]++;
    return number(-a.value);
}
inline number operator/(number a, number b) {
    counts[DIV]++;
    return number(a.value / b.value);
}
inline bool operator<(number a, number b) {
    counts[LESS]++;
    return a.value < b.value;
}
inline number sqrt(number a) {
    counts[SQRT]++;
    return number(std::sqrt(a.value));
}
inline number sin(number a) {
    counts[SIN]++;
    return number(std::sin(a.value));
}
inline number cos(number a) {
    counts[COS]++;
    return number(std::cos(a.value));
}

} // namespace counting

#define RBD_REAL counting::number
#define RBD_REAL_CUSTOM
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "rbd_derivatives.h"
#include "../../models/iiwa.h"
#include "../../models/hyq.h"
#include "../../models/atlas.h"

using counting::counts;
using counting::number;
using counting::OPERATIONS;

static const char *const names[OPERATIONS] = {"op_mul", "op_add", "op_div", "op_sqrt",
                                              "op_sin", "op_cos", "op_neg", "op_less"};

enum { STATES = 64 };

static unsigned char model_memory[RBD_MODEL_SIZE(ATLAS_NB)], work_memory[RBD_WORK_SIZE(ATLAS_NB, ATLAS_NV)],
    derivatives_memory[RBD_DERIVATIVES_SIZE(ATLAS_NB, ATLAS_NV)];
static number q[ATLAS_NQ], v[ATLAS_NV], x[ATLAS_NV], out[ATLAS_NV * 10 * ATLAS_NB],
    more[2][ATLAS_NV * ATLAS_NV];

// ---- a loop of known counts, for the test ----

static void count_known_loop(int n) {
    number product = 1;
    for (int i = 0; i < n; i++) product = product * number(1.0 + i);
    std::printf("%.0f %ld\n", product.value > 0 ? double(n) : 0, counts[counting::MUL]);
}

// ---- algorithms ----

struct robot {
    const char *name;
    const rbd_body *bodies;
    int nb;
    const rbd_model *m;
    rbd_work *w;
    rbd_derivatives *d;
};

typedef rbd_status algorithm_call(const robot &r);

static rbd_status call_id(const robot &r) { return rbd_rnea(r.m, r.w, q, v, x, NULL, out); }
static rbd_status call_mm(const robot &r) { return rbd_crba(r.m, r.w, q, out); }
static rbd_status call_mm_packed(const robot &r) { return rbd_crba_packed(r.m, r.w, q, out); }
static rbd_status call_fd(const robot &r) { return rbd_aba(r.m, r.w, q, v, x, NULL, out); }
static rbd_status call_fd_cholesky(const robot &r) { return rbd_fd_cholesky(r.m, r.w, q, v, x, NULL, out); }

// Its results are of no interest: the base's torques are 0, all other accelerations given.
static rbd_status call_hybrid(const robot &r) {
    unsigned char given[ATLAS_NV];
    for (int i = 0; i < rbd_nv(r.m); i++) {
        given[i] = (unsigned char)(rbd_nq(r.m) > rbd_nv(r.m) ? i >= 6 : i % 2);
        out[i] = x[i];
        more[0][i] = 0;
    }
    return rbd_hybrid(r.m, r.w, q, v, given, out, more[0], NULL);
}

static rbd_status call_minv(const robot &r) { return rbd_minverse(r.m, r.w, q, out); }
static rbd_status call_jacobian(const robot &r) {
    const rbd_status status = rbd_kinematics(r.m, r.w, q, NULL, NULL);
    return status != RBD_OK ? status : rbd_jacobian(r.m, r.w, rbd_nb(r.m) - 1, NULL, RBD_WORLD_AXES, out);
}
static rbd_status call_momentum_matrix(const robot &r) {
    return rbd_momentum_matrix(r.m, r.d, q, NULL, out, NULL);
}
static rbd_status call_coriolis(const robot &r) { return rbd_coriolis(r.m, r.d, q, v, out); }
static rbd_status call_regressor(const robot &r) { return rbd_regressor(r.m, r.d, q, v, x, out); }
static rbd_status call_id_derivatives(const robot &r) {
    return rbd_id_derivatives(r.m, r.d, q, v, x, NULL, out, more[0], NULL);
}
static rbd_status call_fd_derivatives(const robot &r) {
    return rbd_fd_derivatives(r.m, r.d, q, v, x, NULL, NULL, out, more[0], more[1]);
}

struct algorithm {
    const char *name;
    algorithm_call *call;
};
static const algorithm algorithms[] = {{"id", call_id},
                                       {"mm", call_mm},
                                       {"mm_packed", call_mm_packed},
                                       {"fd", call_fd},
                                       {"fd_cholesky", call_fd_cholesky},
                                       {"hybrid", call_hybrid},
                                       {"minv", call_minv},
                                       {"jacobian", call_jacobian},
                                       {"momentum_matrix", call_momentum_matrix},
                                       {"coriolis", call_coriolis},
                                       {"regressor", call_regressor},
                                       {"id_derivatives", call_id_derivatives},
                                       {"fd_derivatives", call_fd_derivatives}};

static void draw_state(const robot &r, uint64_t *seed) {
    rbd_random(r.m, seed, q);
    for (int i = 0; i < rbd_nv(r.m); i++) {
        v[i] = number(std::sin(1.0 + i + double(*seed % 1000)));
        x[i] = number(std::cos(2.0 * i + double(*seed % 1000)));
    }
}

// Adds the operations of one algorithm in STATES states, and prints their mean.
static rbd_status count(const robot &r, const algorithm &a) {
    long sum[OPERATIONS] = {0};
    uint64_t seed = 1;
    for (int k = 0; k < STATES; k++) {
        draw_state(r, &seed);
        for (int i = 0; i < OPERATIONS; i++) counts[i] = 0;
        const rbd_status status = a.call(r);
        if (status != RBD_OK) return status;
        for (int i = 0; i < OPERATIONS; i++) sum[i] += counts[i];
    }
    for (int i = 0; i < OPERATIONS; i++)
        std::printf("operations,rbd,%s,run-time,double,%s,%s,%s,%.4f,1\n", RBD_VERSION, r.name, a.name,
                    names[i], double(sum[i]) / STATES);
    return RBD_OK;
}

static rbd_status count_robot(robot r) {
    rbd_status status = rbd_model_build(r.bodies, r.nb, model_memory, sizeof model_memory, &r.m, NULL);
    if (status == RBD_OK) status = rbd_work_init(r.m, work_memory, sizeof work_memory, &r.w);
    if (status == RBD_OK)
        status = rbd_derivatives_init(r.m, r.w, derivatives_memory, sizeof derivatives_memory, &r.d);
    for (const algorithm &a : algorithms)
        if (status == RBD_OK) status = count(r, a);
    if (status != RBD_OK) std::fprintf(stderr, "operations: %s: %s\n", r.name, rbd_status_string(status));
    return status;
}

int main(int argc, char **) {
    if (argc > 1) {
        count_known_loop(1000);
        return counts[counting::MUL] == 1000 ? 0 : 1;
    }
    std::puts("source,library,version,variant,scalar,robot,algorithm,counter,per_state,share");
    static robot robots[] = {// not const: GCC 12 warns of its own constant propagation
                             {"iiwa", iiwa_bodies, IIWA_NB, NULL, NULL, NULL},
                             {"hyq", hyq_bodies, HYQ_NB, NULL, NULL, NULL},
                             {"atlas", atlas_bodies, ATLAS_NB, NULL, NULL, NULL}};
    for (const robot &r : robots)
        if (count_robot(r) != RBD_OK) return 1;
    return 0;
}
