// robcogen.cpp - the C++ that RobCoGen (robcogenteam.bitbucket.io) generated for one robot, beside rbd: its
// namespace is ROBOT. States are copied into its vectors, the results stay in its objects. Its constants are
// of 32 bits, and where gravity is taken away little may remain: hence the bound.
// SPDX-License-Identifier: MIT
#include <cstring>
#include <new>
#include <traits.h>
#include "tree.hpp"

namespace {

namespace generated = rcg::ROBOT;
using traits = generated::Traits;

#define TEXT(x) TEXT_OF(x)
#define TEXT_OF(x) #x

constexpr int joints = traits::joints_count;
constexpr int base_q = traits::floating_base ? 7 : 0, base_v = traits::floating_base ? 6 : 0;

struct model {
    int nq = base_q + joints, nv = base_v + joints;
};

struct work {
    traits::InertiaProperties inertia;
    traits::MotionTransforms motions;
    traits::ForceTransforms forces;
    traits::InvDynEngine inverse{inertia, motions};
    traits::FwdDynEngine forward{inertia, motions};
    traits::JSIM matrix{inertia, forces};
    traits::JointState q, v, x, out;
    // Of a floating base, in its axes.
    generated::Velocity base;
    generated::Acceleration base_a, g;
    generated::Force wrench;
    traits::FwdDynEngine::ExtForces pushes{generated::Force::Zero()};
    double gravity[3] = {0, 0, 0};
};

// ---- model and work ----

rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t, const void **out, char *text) {
    tree t;
    model *p = new (memory) model;
    *out = p;
    if (!read_tree(bodies, nb, &t, text)) return RBD_ERR_TYPE;
    if (t.nq == p->nq && t.nv == p->nv) return RBD_OK;
    std::snprintf(text, 160, "the code was generated for another robot: %d degrees of freedom, here %d",
                  p->nv, t.nv);
    return RBD_ERR_TYPE;
}

size_t model_size(const rbd_body *, int) { return sizeof(model); }

rbd_status work_init(const void *, void *memory, size_t, void **out) {
    *out = new (aligned(memory)) work;
    return RBD_OK;
}

size_t work_size(const void *) { return sizeof(work) + 64; }
void work_free(void *w) { static_cast<work *>(w)->~work(); }

rbd_status set_gravity(void *w, const double gravity[3]) {
    std::memcpy(static_cast<work *>(w)->gravity, gravity, 3 * sizeof(double));
    return RBD_OK;
}

// ---- the calls that are timed: templates, as a robot has the calls of a fixed or of a floating base ----

template <typename Vector> void take(Vector *to, const double *from) {
    std::memcpy(to->data(), from, (size_t)to->size() * sizeof(double));
}

// Further inputs of a floating base: its velocity, gravity in its axes.
template <class W> void take_base(W *w, const double *q, const double *v) {
    if constexpr (traits::floating_base) {
        take(&w->base, v);
        w->g.setZero();
        put(w->g.data() + 3, transpose(rotation_of(q + 3)) * get(w->gravity));
    }
}

template <class W> void run_inverse(W *w, const double *base_a) {
    if constexpr (traits::floating_base) {
        take(&w->base_a, base_a);
        w->inverse.id_fully_actuated(w->wrench, w->out, w->g, w->base, w->base_a, w->q, w->v, w->x);
    } else {
        w->inverse.id(w->out, w->q, w->v, w->x);
    }
}

// The torque of a floating base is a push on its link.
template <class W> void run_forward(W *w, const double *wrench) {
    if constexpr (traits::floating_base) {
        take(&w->pushes[traits::orderedLinkIDs()[0]], wrench);
        w->forward.fd(w->out, w->base_a, w->base, w->g, w->q, w->v, w->x, w->pushes);
    } else {
        w->forward.fd(w->out, w->q, w->v, w->x);
    }
}

#define CALL(name, ...) \
    rbd_status call_##name(const void *, void *work_, int, const void *q_, const void *v_, const void *x_, \
                           void *out) { \
        work *w = static_cast<work *>(work_); \
        const double *q = static_cast<const double *>(q_), *v = static_cast<const double *>(v_), \
                     *x = static_cast<const double *>(x_); \
        take(&w->q, q + base_q); \
        (void)v, (void)x; \
        __VA_ARGS__; \
        std::memcpy(out, &w, sizeof w); /* where the results are */ \
        return RBD_OK; \
    }
#define TAKE_STATE take(&w->v, v + base_v), take(&w->x, x + base_v), take_base(w, q, v)

CALL(id, TAKE_STATE; run_inverse(w, x))
CALL(fd, TAKE_STATE; run_forward(w, x))
CALL(mm, w->matrix.update(w->q))
CALL(minv, w->matrix.update(w->q); w->matrix.computeL(); w->matrix.computeInverse())

// ---- conventions: its joints stand in the order of the URDF file, its base has rbd's ----

void size(const void *p, int *nq, int *nv) {
    *nq = static_cast<const model *>(p)->nq;
    *nv = static_cast<const model *>(p)->nv;
}

void convert_state(const void *p, const struct state *rbd, const struct state *its) {
    int nq, nv;
    size(p, &nq, &nv);
    const size_t length = (size_t)nv * sizeof(double);
    std::memcpy(its->q, rbd->q, (size_t)nq * sizeof(double));
    std::memcpy(its->v, rbd->v, length);
    std::memcpy(its->a, rbd->a, length);
    std::memcpy(its->tau, rbd->tau, length);
}

void give_vector(const work *w, const double *base, double *x) {
    for (int i = 0; i < base_v; i++) x[i] = base[i];
    for (int i = 0; i < joints; i++) x[base_v + i] = w->out[i];
}

// A fixed base has 9.80665 down compiled in: takes that away, and adds the gravity that is set.
void change_gravity(work *w, int algorithm, double *x) {
    w->v.setZero();
    w->x.setZero();
    algorithm == ID ? run_inverse(w, nullptr) : run_forward(w, nullptr);
    for (int i = 0; i < joints; i++) x[i] -= (1 + w->gravity[2] / iit::rbd::g) * w->out[i];
}

template <typename Matrix> void give_matrix(const Matrix &its, double *x) {
    for (int i = 0; i < its.rows(); i++)
        for (int j = 0; j < its.cols(); j++) x[i * its.cols() + j] = its(i, j);
}

void convert_result(const void *, int algorithm, const struct state *, const double *out, double *x) {
    work *w;
    std::memcpy(&w, out, sizeof w);
    if (algorithm == MM) return give_matrix(w->matrix, x);
    if (algorithm == MINV) return give_matrix(w->matrix.getInverse(), x);
    give_vector(w, algorithm == ID ? w->wrench.data() : w->base_a.data(), x);
    if (!traits::floating_base) change_gravity(w, algorithm, x);
}

conventions make_conventions() {
    conventions c = {};
    c.size = size;
    c.state = convert_state;
    c.result = convert_result;
    c.bound = 1e-5;
    c.build = PEER_BUILD;
    c.calls[ID] = traits::floating_base ? "InverseDynamics::id_fully_actuated" : "InverseDynamics::id";
    c.calls[MM] = "JSIM::update";
    c.calls[FD] = "ForwardDynamics::fd";
    c.calls[MINV] = "JSIM::update, computeL, computeInverse";
    return c;
}

const conventions others = make_conventions();

library make_library() {
    library l = plain_library("RobCoGen", "code");
    l.variant = GENERATED;
    l.robot = TEXT(ROBOT);
    l.model_build = model_build;
    l.model_size = model_size;
    l.work_init = work_init;
    l.work_size = work_size;
    l.work_free = work_free;
    l.set_gravity = set_gravity;
    l.call[ID] = call_id;
    l.call[MM] = call_mm;
    l.call[FD] = call_fd;
    l.call[MINV] = traits::floating_base ? nullptr : call_minv; // computeInverse leaves the base out
    l.conventions = &others;
    return l;
}

} // namespace

extern "C" {
PEER extern const struct library LIBRARY;
const struct library LIBRARY = make_library();
}
