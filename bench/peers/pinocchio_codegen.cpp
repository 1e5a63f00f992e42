// pinocchio_codegen.cpp - the C that Pinocchio's code generation wrote for one robot (pinocchio_write.cpp),
// beside rbd's generated code: compiled in the same way. A state is copied into the one array that it reads,
// as Pinocchio's own call of it does; it writes its results where the caller wants them.
// SPDX-License-Identifier: MIT
#include <algorithm>
#include "pinocchio_codegen.hpp"
#include "pinocchio_model.hpp"

namespace {

// Functions that generated code may call; this code calls none.
struct atomic_functions {
    void *library;
    void (*forward)(), (*reverse)();
};

using written_function = void(const double *const *in, double *const *out, atomic_functions none);

struct work {
    const model *p;
    std::vector<double> input; // q, v, a or tau, gravity
};

rbd_status work_init(const void *p_, void *memory, size_t, void **out) {
    const model *p = static_cast<const model *>(p_);
    *out = new (memory) work{p, std::vector<double>((size_t)(p->m.nq + 2 * p->m.nv + 3))};
    return RBD_OK;
}

size_t work_size(const void *) { return sizeof(work); }
void work_free(void *w) { static_cast<work *>(w)->~work(); }

rbd_status set_gravity(void *w, const double gravity[3]) {
    std::copy_n(gravity, 3, static_cast<work *>(w)->input.end() - 3);
    return RBD_OK;
}

// ---- the calls that are timed ----

bool takes_q_alone(int algorithm) { return algorithm == MM || algorithm == MINV; }

template <int algorithm, written_function *function>
rbd_status call(const void *p, void *w, int, const void *q, const void *v, const void *x, void *out) {
    const int nq = static_cast<const model *>(p)->m.nq, nv = static_cast<const model *>(p)->m.nv;
    double *input = static_cast<work *>(w)->input.data(), *results = static_cast<double *>(out);
    std::copy_n(static_cast<const double *>(q), nq, input);
    if (!takes_q_alone(algorithm)) {
        std::copy_n(static_cast<const double *>(v), nv, input + nq);
        std::copy_n(static_cast<const double *>(x), nv, input + nq + nv);
    }
    const double *in[] = {input};
    function(in, &results, {});
    return RBD_OK;
}

// ---- conventions ----

// The upper triangle, row after row.
MatrixXd unpacked(int nv, const double *its) {
    MatrixXd A(nv, nv);
    for (int i = 0; i < nv; i++)
        for (int j = i; j < nv; j++) A(i, j) = *its++;
    return A;
}

void convert_result(const void *p_, int algorithm, const struct state *, const double *its, double *x) {
    using matrix = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
    const model *p = static_cast<const model *>(p_);
    const int nv = p->m.nv, parts = algorithm == ID_DERIVATIVES ? 2 : algorithm == FD_DERIVATIVES ? 3 : 0;
    if (takes_q_alone(algorithm)) reorder_upper(p, unpacked(nv, its), x);
    if (algorithm == ID || algorithm == FD)
        for (int i = 0; i < nv; i++) x[i] = its[p->place[(size_t)i]];
    for (int k = 0; k < parts; k++) reorder(p, matrix(its + k * nv * nv, nv, nv), x + k * nv * nv);
}

conventions make_conventions() {
    conventions c = {};
    c.size = size;
    c.state = convert_state;
    c.result = convert_result;
    c.bound = 1e-10;
    c.build = PEER_BUILD;
    c.calls[ID] = "what it wrote of rnea";
    c.calls[MM] = "of crba, LOCAL convention: one triangle";
    c.calls[FD] = "of aba, LOCAL convention";
    c.calls[MINV] = "of computeMinverse: one triangle";
    c.calls[ID_DERIVATIVES] = "of computeRNEADerivatives, without M";
    c.calls[FD_DERIVATIVES] = "of computeABADerivatives";
    return c;
}

const conventions others = make_conventions();

library make_library(const char *robot) {
    library l = plain_library("Pinocchio", PEER_VERSION);
    l.variant = GENERATED;
    l.form = "code";
    l.robot = robot;
    l.model_build = model_build;
    l.model_size = model_size;
    l.model_free = model_free;
    l.work_init = work_init;
    l.work_size = work_size;
    l.work_free = work_free;
    l.set_gravity = set_gravity;
    l.conventions = &others;
    return l;
}

} // namespace

extern "C" {
#define WRITTEN(robot, name) pinocchio_##robot##_##name##_forward_zero
#define DECLARE(robot) \
    written_function WRITTEN(robot, id), WRITTEN(robot, mm), WRITTEN(robot, fd), WRITTEN(robot, minv), \
        WRITTEN(robot, id_derivatives), WRITTEN(robot, fd_derivatives); \
    PEER extern const struct library library_pinocchio_code_##robot;
DECLARE(iiwa)
DECLARE(hyq)
DECLARE(atlas)
}

#define DEFINE(robot) \
    const struct library library_pinocchio_code_##robot = [] { \
        library l = make_library(#robot); \
        l.call[ID] = call<ID, WRITTEN(robot, id)>; \
        l.call[MM] = call<MM, WRITTEN(robot, mm)>; \
        l.call[FD] = call<FD, WRITTEN(robot, fd)>; \
        l.call[MINV] = call<MINV, WRITTEN(robot, minv)>; \
        l.call[ID_DERIVATIVES] = call<ID_DERIVATIVES, WRITTEN(robot, id_derivatives)>; \
        l.call[FD_DERIVATIVES] = call<FD_DERIVATIVES, WRITTEN(robot, fd_derivatives)>; \
        return l; \
    }();
DEFINE(iiwa)
DEFINE(hyq)
DEFINE(atlas)
