// pinocchio.cpp - Pinocchio (https://github.com/stack-of-tasks/pinocchio) beside rbd, from its headers alone,
// so that its algorithms are compiled with the flags of this file. What is timed stands in `conventions`
// below: the arrays of the caller are used as they are, and the results stay in its `Data`.
// SPDX-License-Identifier: MIT
#undef PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION // that of the installed library has other flags
#include <cstring>
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/pv.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include "../robots/contacts.h"
#include "pinocchio_model.hpp"

namespace {

using Eigen::VectorXd;
using input = Eigen::Map<const VectorXd>;

enum { SETS = ALGORITHMS - CONSTRAINED };

// Two algorithms for constrained dynamics: each is a library of its own to the bench.
enum solver { SPARSE_CHOLESKY, POPOV_VERESHCHAGIN, SOLVERS };

// A set of contacts, none if the robot lacks it, and the data of its own that they take.
struct contacts {
    template <typename T> using list = std::vector<T, Eigen::aligned_allocator<T>>;
    list<pinocchio::RigidConstraintModel> models;
    list<pinocchio::RigidConstraintData> data;
    pinocchio::ProximalSettings settings; // as they are: no regularisation, one iteration
    pinocchio::Data d;
    contacts(const model &p, int algorithm, solver by);
};

struct work {
    pinocchio::Model m; // for its gravity
    pinocchio::Data d;
    pinocchio::Data::Matrix6x J;
    std::size_t last;
    std::vector<contacts> sets[SOLVERS];
    work(const model &p) : m(p.m), d(p.m), J(pinocchio::Data::Matrix6x::Zero(6, p.m.nv)), last(p.last) {
        for (int by = 0; by < SOLVERS; by++)
            for (int i = 0; i < SETS; i++) sets[by].emplace_back(p, CONSTRAINED + i, solver(by));
    }
};

contacts::contacts(const model &p, int algorithm, solver by) : d(p.m) {
    const int nb = (int)p.t.bodies.size();
    const contact_set *set = contact_set_of(p.t.bodies.data(), nb, algorithm);
    for (int i = 0; set && i < set->count; i++) {
        const contact &c = set->contacts[i];
        const int body = contact_body(p.t.bodies.data(), nb, c.body);
        const pinocchio::Frame &f = p.m.frames[p.m.getFrameId("b" + std::to_string(body))];
        models.emplace_back(c.flat ? pinocchio::CONTACT_6D : pinocchio::CONTACT_3D, p.m, f.parentJoint,
                            f.placement * pinocchio::SE3(Matrix3d::Identity(), vector_of(c.point)),
                            pinocchio::LOCAL);
        data.emplace_back(models.back());
    }
    if (by == SPARSE_CHOLESKY)
        pinocchio::initConstraintDynamics(p.m, d, models);
    else
        pinocchio::initPvSolver(p.m, d, models);
}

// ---- work ----

rbd_status work_init(const void *p, void *memory, size_t, void **out) {
    *out = new (aligned(memory)) work(*static_cast<const model *>(p));
    return RBD_OK;
}

size_t work_size(const void *) { return sizeof(work) + 64; }
void work_free(void *w) { static_cast<work *>(w)->~work(); }

rbd_status set_gravity(void *w, const double gravity[3]) {
    static_cast<work *>(w)->m.gravity.linear() = vector_of(gravity);
    return RBD_OK;
}

// ---- the calls that are timed ----

using constrained_call = void(const pinocchio::Model &m, contacts *c, const input &q, const input &v,
                              const input &tau);

void run_sparse(const pinocchio::Model &m, contacts *c, const input &q, const input &v, const input &tau) {
    pinocchio::constraintDynamics(m, c->d, q, v, tau, c->models, c->data, c->settings);
}

void run_pv(const pinocchio::Model &m, contacts *c, const input &q, const input &v, const input &tau) {
    pinocchio::pv(m, c->d, q, v, tau, c->models, c->data, c->settings);
}

// A call of Pinocchio's with m, d and the state's parts as maps on the caller's arrays.
#define CALL(name, ...) \
    rbd_status call_##name(const void *, void *work_, int, const void *q_, const void *v_, const void *x_, \
                           void *out) { \
        work *w = static_cast<work *>(work_); \
        const pinocchio::Model &m = w->m; \
        pinocchio::Data &d = w->d; \
        const input q(static_cast<const double *>(q_), m.nq), v(static_cast<const double *>(v_), m.nv), \
            x(static_cast<const double *>(x_), m.nv); \
        (void)d, (void)v, (void)x; \
        __VA_ARGS__; \
        std::memcpy(out, &w, sizeof w); /* where the results are */ \
        return RBD_OK; \
    }

CALL(id, pinocchio::rnea(m, d, q, v, x))
CALL(mm, pinocchio::crba(m, d, q, pinocchio::Convention::LOCAL))
CALL(fd, pinocchio::aba(m, d, q, v, x, pinocchio::Convention::LOCAL))
CALL(minv, pinocchio::computeMinverse(m, d, q))
CALL(jacobian, pinocchio::computeFrameJacobian(m, d, q, w->last, pinocchio::LOCAL_WORLD_ALIGNED, w->J))
CALL(momentum_matrix, pinocchio::computeCentroidalMap(m, d, q))
CALL(coriolis, pinocchio::computeCoriolisMatrix(m, d, q, v))
CALL(regressor, pinocchio::computeJointTorqueRegressor(m, d, q, v, x))
CALL(id_derivatives_mm, pinocchio::computeRNEADerivatives(m, d, q, v, x))
CALL(fd_derivatives, pinocchio::computeABADerivatives(m, d, q, v, x))

CALL(constrained, run_sparse(w->m, &w->sets[SPARSE_CHOLESKY][0], q, v, x))
CALL(constrained_hand, run_sparse(w->m, &w->sets[SPARSE_CHOLESKY][1], q, v, x))
CALL(constrained_pv, run_pv(w->m, &w->sets[POPOV_VERESHCHAGIN][0], q, v, x))
CALL(constrained_hand_pv, run_pv(w->m, &w->sets[POPOV_VERESHCHAGIN][1], q, v, x))

// Its regressor has a block for each joint, in which fixed bodies are merged.
int can(const void *model_, int algorithm) {
    const model *p = static_cast<const model *>(model_);
    if (algorithm >= CONSTRAINED)
        return contact_set_of(p->t.bodies.data(), (int)p->t.bodies.size(), algorithm) != nullptr;
    return algorithm != REGRESSOR || p->every_body_moves;
}

// ---- conventions: docs/other_libraries.md ----

// Rows: linear first there.
template <typename Matrix> void reorder_motion(const model *p, const Matrix &its, double *x) {
    const int nv = p->m.nv;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < nv; j++) x[i * nv + j] = its((i + 3) % 6, p->place[(size_t)j]);
}

// Columns of a body: m, m com, then xx xy yy xz yz zz there.
void reorder_regressor(const model *p, const MatrixXd &its, double *x) {
    static const int column[10] = {0, 1, 2, 3, 4, 5, 7, 6, 8, 9};
    const int nv = p->m.nv, nb = (int)p->t.bodies.size();
    for (int i = 0; i < nv; i++)
        for (int b = 0; b < nb; b++)
            for (int k = 0; k < 10; k++)
                x[(i * nb + b) * 10 + k] =
                    its(p->place[(size_t)i], 10 * (p->joint[(size_t)b] - 1) + column[k]);
}

// A flat contact holds a surface's spatial acceleration at 0, where rbd holds that of a point, which is
// omega x u more. With that as the wanted acceleration, 0 in the timed call, both solve the same. pv takes no
// wanted acceleration, but a gain for a velocity that it reads of a flat contact and does not compute.
void run_as_rbd(const model *p, const pinocchio::Model &m, contacts *c, constrained_call *call,
                const struct state *rbd) {
    bool flat = false;
    for (const auto &contact : c->models) flat = flat || contact.type == pinocchio::CONTACT_6D;
    VectorXd q(m.nq), v(m.nv), a(m.nv), tau(m.nv);
    const struct state its = {q.data(), v.data(), a.data(), tau.data()};
    convert_state(p, rbd, &its);
    pinocchio::forwardKinematics(m, c->d, q, v);
    for (size_t i = 0; flat && i < c->data.size(); i++) {
        pinocchio::RigidConstraintModel &contact = c->models[i];
        if (contact.type != pinocchio::CONTACT_6D) continue;
        const pinocchio::Motion u = contact.joint1_placement.actInv(c->d.v[contact.joint1_id]);
        const Vector3d wanted = -u.angular().cross(u.linear());
        c->data[i].contact_acceleration_desired.setZero();
        if (call == run_sparse) {
            c->data[i].contact_acceleration_desired.linear() = wanted;
        } else {
            contact.corrector.Kd.setOnes();
            c->data[i].contact1_velocity.setZero();
            c->data[i].contact1_velocity.linear() = -wanted;
        }
    }
    if (flat) call(m, c, input(q.data(), m.nq), input(v.data(), m.nv), input(tau.data(), m.nv));
    pinocchio::forwardKinematics(m, c->d, q);
    for (auto &data : c->data) data.contact_acceleration_desired.setZero();
    for (auto &contact : c->models) contact.corrector.Kd.setZero();
}

// The force of contact i, in its axes: pv leaves those of a joint's contacts one after the other.
pinocchio::Force force_of(const contacts &c, constrained_call *call, size_t i) {
    if (call == run_sparse) return c.data[i].contact_force;
    int first = 0;
    for (size_t k = 0; k < i; k++)
        if (c.models[k].joint1_id == c.models[i].joint1_id) first += c.models[k].size();
    const VectorXd &its = c.d.lambdaA[c.models[i].joint1_id];
    pinocchio::Force f = pinocchio::Force::Zero();
    f.linear() = -its.segment<3>(first);
    if (c.models[i].type == pinocchio::CONTACT_6D) f.angular() = -its.segment<3>(first + 3);
    return f;
}

// The acceleration, then of each contact the moment, if it is flat, and the force, in world axes.
void constrained_as_rbd(const model *p, const pinocchio::Model &m, contacts *c, constrained_call *call,
                        const struct state *rbd, double *x) {
    run_as_rbd(p, m, c, call, rbd);
    for (int i = 0; i < p->m.nv; i++) *x++ = c->d.ddq[p->place[(size_t)i]];
    for (size_t i = 0; i < c->data.size(); i++) {
        const pinocchio::RigidConstraintModel &contact = c->models[i];
        const Matrix3d R = c->d.oMi[contact.joint1_id].rotation() * contact.joint1_placement.rotation();
        const pinocchio::Force its = force_of(*c, call, i);
        const Vector3d n = R * its.angular(), f = R * its.linear();
        for (int k = 0; k < 3 && contact.type == pinocchio::CONTACT_6D; k++) *x++ = n[k];
        for (int k = 0; k < 3; k++) *x++ = f[k];
    }
}

void convert_result(const void *model_, int algorithm, const struct state *rbd, const double *out,
                    double *x) {
    const model *p = static_cast<const model *>(model_);
    work *w;
    std::memcpy(&w, out, sizeof w);
    const pinocchio::Data &d = w->d;
    const int nv = p->m.nv;
    switch (algorithm) {
    case ID:
    case FD:
        for (int i = 0; i < nv; i++) x[i] = (algorithm == ID ? d.tau : d.ddq)[p->place[(size_t)i]];
        break;
    case MM: reorder_upper(p, d.M, x); break;
    case MINV: reorder_upper(p, d.Minv, x); break;
    case JACOBIAN: reorder_motion(p, w->J, x); break;
    case BODY_JACOBIAN: {
        const pinocchio::SE3 &pose = d.oMf[w->last];
        reorder_motion(p, w->J, x);
        for (int i = 0; i < 9; i++) x[6 * nv + i] = pose.rotation()(i / 3, i % 3);
        for (int i = 0; i < 3; i++) x[6 * nv + 9 + i] = pose.translation()[i];
        break;
    }
    case MOMENTUM_MATRIX: reorder_motion(p, d.Ag, x); break;
    case CORIOLIS: reorder(p, d.C, x); break;
    case REGRESSOR: reorder_regressor(p, d.jointTorqueRegressor, x); break;
    case ID_DERIVATIVES_MM:
        reorder(p, d.dtau_dq, x);
        reorder(p, d.dtau_dv, x + nv * nv);
        reorder_upper(p, d.M, x + 2 * nv * nv);
        break;
    case FD_DERIVATIVES:
        reorder(p, d.ddq_dq, x);
        reorder(p, d.ddq_dv, x + nv * nv);
        reorder(p, d.Minv, x + 2 * nv * nv);
        break;
    case CONSTRAINED:
    case CONSTRAINED_HAND:
        constrained_as_rbd(p, w->m, &w->sets[SPARSE_CHOLESKY][(size_t)(algorithm - CONSTRAINED)], run_sparse,
                           rbd, x);
        break;
    }
}

void convert_pv(const void *p, int algorithm, const struct state *rbd, const double *out, double *x) {
    work *w;
    std::memcpy(&w, out, sizeof w);
    constrained_as_rbd(static_cast<const model *>(p), w->m,
                       &w->sets[POPOV_VERESHCHAGIN][(size_t)(algorithm - CONSTRAINED)], run_pv, rbd, x);
}

conventions make_conventions() {
    conventions c = {};
    c.size = size;
    c.state = convert_state;
    c.result = convert_result;
    c.bound = 1e-10;
    c.build = PEER_BUILD;
    c.calls[ID] = "rnea";
    c.calls[MM] = "crba, LOCAL convention: one triangle";
    c.calls[FD] = "aba, LOCAL convention";
    c.calls[MINV] = "computeMinverse: one triangle";
    c.calls[JACOBIAN] = c.calls[BODY_JACOBIAN] =
        "computeFrameJacobian, LOCAL_WORLD_ALIGNED: the chain of that body alone";
    c.calls[MOMENTUM_MATRIX] = "computeCentroidalMap";
    c.calls[CORIOLIS] = "computeCoriolisMatrix";
    c.calls[REGRESSOR] = "computeJointTorqueRegressor";
    c.calls[ID_DERIVATIVES_MM] = "computeRNEADerivatives: structural zeros not written";
    c.calls[FD_DERIVATIVES] = "computeABADerivatives";
    c.calls[CONSTRAINED] = c.calls[CONSTRAINED_HAND] =
        "constraintDynamics, LOCAL contacts, mu 0: of flat ones the spatial acceleration is held";
    return c;
}

conventions make_pv_conventions() {
    conventions c = make_conventions();
    c.result = convert_pv;
    for (const char *&call : c.calls) call = nullptr;
    c.calls[CONSTRAINED] = c.calls[CONSTRAINED_HAND] =
        "pv, mu 0: of flat contacts the spatial acceleration is held";
    return c;
}

const conventions others = make_conventions(), others_pv = make_pv_conventions();

library make_library() {
    library l = plain_library("Pinocchio", PEER_VERSION);
    l.model_build = model_build;
    l.model_size = model_size;
    l.model_free = model_free;
    l.work_init = work_init;
    l.work_size = work_size;
    l.work_free = work_free;
    l.set_gravity = set_gravity;
    l.call[ID] = call_id;
    l.call[MM] = call_mm;
    l.call[FD] = call_fd;
    l.call[MINV] = call_minv;
    l.call[JACOBIAN] = l.call[BODY_JACOBIAN] = call_jacobian;
    l.call[MOMENTUM_MATRIX] = call_momentum_matrix;
    l.call[CORIOLIS] = call_coriolis;
    l.call[REGRESSOR] = call_regressor;
    l.call[ID_DERIVATIVES_MM] = call_id_derivatives_mm;
    l.call[FD_DERIVATIVES] = call_fd_derivatives;
    l.call[CONSTRAINED] = call_constrained;
    l.call[CONSTRAINED_HAND] = call_constrained_hand;
    l.can = can;
    l.conventions = &others;
    l.form = *PEER_FORM ? PEER_FORM : nullptr;
    return l;
}

library make_pv_library() {
    library l = make_library();
    for (library_call *&call : l.call) call = nullptr;
    l.call[CONSTRAINED] = call_constrained_pv;
    l.call[CONSTRAINED_HAND] = call_constrained_hand_pv;
    l.conventions = &others_pv;
    l.form = *PEER_FORM ? "pv " PEER_FORM : "pv";
    return l;
}

} // namespace

extern "C" {
PEER extern const struct library LIBRARY, LIBRARY_PV;
const struct library LIBRARY = make_library(), LIBRARY_PV = make_pv_library();
}
