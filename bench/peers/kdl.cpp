// kdl.cpp - Orocos KDL (https://www.orocos.org/kdl) beside rbd. What is timed stands in `conventions` below.
//
// KDL has joints of one degree of freedom only. A floating base is three slides along the world's axes and
// then three turns, about z, y and x, with massless segments between them: as many degrees of freedom and the
// same motion, but other coordinates. States are converted before, results after what is timed. Near a pitch
// of 90 degrees these coordinates are singular; random states come close only so far that the results lose
// some digits. SPDX-License-Identifier: MIT
#include <new>
#include <string>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/tree.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>
#include "tree.hpp"

namespace {

enum { ROOT_DOFS = 6 };

struct model {
    tree t;
    KDL::Tree kdl{"world"};
    KDL::Chain chain; // empty if the robot branches
    int n = 0;        // degrees of freedom, rbd's nv
};

// ---- model ----

KDL::Vector vector_of(const double x[3]) { return KDL::Vector(x[0], x[1], x[2]); }

std::string name_of(int body) { return body < 0 ? "world" : "body" + std::to_string(body); }

KDL::RigidBodyInertia inertia_of(const rbd_body &b) {
    const double *I = b.inertia;
    return KDL::RigidBodyInertia(b.mass, vector_of(b.com),
                                 KDL::RotationalInertia(I[0], I[3], I[5], I[1], I[2], I[4]));
}

KDL::Joint joint_of(const rbd_body &b, const KDL::Frame &F, const std::string &name) {
    if (b.type == RBD_FIXED) return KDL::Joint(name, KDL::Joint::Fixed);
    return KDL::Joint(name, F.p, F.M * vector_of(b.axis),
                      turns(b) ? KDL::Joint::RotAxis : KDL::Joint::TransAxis, 1, 0, b.armature[0]);
}

bool add_body(model *p, int i) {
    const rbd_body &b = p->t.bodies[(size_t)i];
    const mat3 E = rotation_given(b.rotation);
    const double *R = E.m;
    const KDL::Frame F(KDL::Rotation(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]),
                       vector_of(b.position));
    const KDL::Segment s(name_of(i), joint_of(b, F, "j" + std::to_string(i)), F, inertia_of(b));
    return p->kdl.addSegment(s, name_of(b.parent));
}

bool add_floating_base(model *p) {
    static const KDL::Joint::JointType types[ROOT_DOFS] = {KDL::Joint::TransX, KDL::Joint::TransY,
                                                           KDL::Joint::TransZ, KDL::Joint::RotZ,
                                                           KDL::Joint::RotY,   KDL::Joint::RotX};
    std::string parent = "world";
    for (int k = 0; k < ROOT_DOFS; k++) {
        const bool last = k == ROOT_DOFS - 1;
        const std::string name = last ? name_of(0) : "base" + std::to_string(k);
        const KDL::Joint joint("root" + std::to_string(k), types[k]);
        const KDL::RigidBodyInertia inertia =
            last ? inertia_of(p->t.bodies[0]) : KDL::RigidBodyInertia::Zero();
        if (!p->kdl.addSegment(KDL::Segment(name, joint, KDL::Frame::Identity(), inertia), parent))
            return false;
        parent = name;
    }
    return true;
}

// Whether each body is carried by the one before.
bool is_chain(const tree &t) {
    for (size_t i = 0; i < t.bodies.size(); i++)
        if (t.bodies[i].parent != (int)i - 1) return false;
    return true;
}

rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t, const void **out, char *text) {
    model *p = new (memory) model;
    *out = p;
    if (!read_tree(bodies, nb, &p->t, text)) return RBD_ERR_TYPE;
    p->n = p->t.nv;
    bool added = !p->t.floating || add_floating_base(p);
    for (int i = p->t.floating ? 1 : 0; i < nb; i++) added = added && add_body(p, i);
    if (added && is_chain(p->t)) added = p->kdl.getChain("world", name_of(nb - 1), p->chain);
    std::snprintf(text, 160, "KDL refused a segment");
    return added ? RBD_OK : RBD_ERR_TYPE;
}

size_t model_size(const rbd_body *, int) { return sizeof(model); }

void model_free(const void *p) { static_cast<model *>(const_cast<void *>(p))->~model(); }

// ---- work: solvers keep gravity and a reference to the tree or chain ----

struct work {
    const model *p;
    KDL::JntArray q, v, x, out;
    KDL::JntSpaceInertiaMatrix M;
    KDL::Jacobian J;
    KDL::ChainJntToJacSolver jacobian;
    KDL::WrenchMap no_wrenches;
    KDL::Wrenches zero_wrenches; // for chains one for each segment is demanded
    KDL::TreeIdSolver_RNE *tree_id = nullptr;
    KDL::ChainIdSolver_RNE *chain_id = nullptr;
    KDL::ChainDynParam *dynamics = nullptr;
    KDL::ChainFdSolver_RNE *fd = nullptr;
    explicit work(const model *m)
        : p(m), q((unsigned)m->n), v((unsigned)m->n), x((unsigned)m->n), out((unsigned)m->n),
          M((unsigned)m->n), J((unsigned)m->n), jacobian(m->chain),
          zero_wrenches(m->chain.getNrOfSegments(), KDL::Wrench::Zero()) {}
};

void drop_solvers(work *w) {
    delete w->tree_id;
    delete w->chain_id;
    delete w->dynamics;
    delete w->fd;
}

rbd_status set_gravity(void *work_, const double gravity[3]) {
    work *w = static_cast<work *>(work_);
    const KDL::Vector g = vector_of(gravity);
    drop_solvers(w);
    w->tree_id = new KDL::TreeIdSolver_RNE(w->p->kdl, g);
    w->chain_id = new KDL::ChainIdSolver_RNE(w->p->chain, g);
    w->dynamics = new KDL::ChainDynParam(w->p->chain, g);
    w->fd = new KDL::ChainFdSolver_RNE(w->p->chain, g);
    return RBD_OK;
}

rbd_status work_init(const void *p, void *memory, size_t, void **out) {
    const double gravity[3] = {0, 0, -9.81};
    *out = new (memory) work(static_cast<const model *>(p));
    return set_gravity(*out, gravity);
}

size_t work_size(const void *) { return sizeof(work); }

void work_free(void *w) {
    drop_solvers(static_cast<work *>(w));
    static_cast<work *>(w)->~work();
}

// ---- the calls that are timed; KDL takes arrays of its own, so that states are copied ----

void take(KDL::JntArray &x, const void *from) {
    const double *y = static_cast<const double *>(from);
    for (unsigned i = 0; i < x.rows(); i++) x(i) = y[i];
}

void give(const KDL::JntArray &x, void *to) {
    double *y = static_cast<double *>(to);
    for (unsigned i = 0; i < x.rows(); i++) y[i] = x(i);
}

rbd_status status_of(int code) { return code < 0 ? RBD_ERR_SINGULAR : RBD_OK; }

rbd_status call_id(const void *, void *work_, int, const void *q, const void *v, const void *a, void *tau) {
    work *w = static_cast<work *>(work_);
    take(w->q, q);
    take(w->v, v);
    take(w->x, a);
    const bool chain = w->p->chain.getNrOfSegments() > 0;
    const int code = chain ? w->chain_id->CartToJnt(w->q, w->v, w->x, w->zero_wrenches, w->out)
                           : w->tree_id->CartToJnt(w->q, w->v, w->x, w->no_wrenches, w->out);
    give(w->out, tau);
    return status_of(code);
}

rbd_status call_mm(const void *, void *work_, int, const void *q, const void *, const void *, void *M) {
    work *w = static_cast<work *>(work_);
    double *out = static_cast<double *>(M);
    take(w->q, q);
    const int code = w->dynamics->JntToMass(w->q, w->M);
    for (unsigned i = 0; i < w->M.rows(); i++)
        for (unsigned j = 0; j < w->M.rows(); j++) *out++ = w->M(i, j);
    return status_of(code);
}

rbd_status call_fd(const void *, void *work_, int, const void *q, const void *v, const void *tau, void *a) {
    work *w = static_cast<work *>(work_);
    take(w->q, q);
    take(w->v, v);
    take(w->x, tau);
    const int code = w->fd->CartToJnt(w->q, w->v, w->x, w->zero_wrenches, w->out);
    give(w->out, a);
    return status_of(code);
}

// Its rows: linear first.
rbd_status call_jacobian(const void *, void *work_, int, const void *q, const void *, const void *, void *J) {
    work *w = static_cast<work *>(work_);
    double *out = static_cast<double *>(J);
    take(w->q, q);
    const int code = w->jacobian.JntToJac(w->q, w->J);
    for (unsigned i = 0; i < 6; i++)
        for (unsigned j = 0; j < w->J.columns(); j++) *out++ = w->J((i + 3) % 6, j);
    return status_of(code);
}

int can(const void *p, int algorithm) {
    return algorithm == ID || static_cast<const model *>(p)->chain.getNrOfSegments() > 0;
}

// ---- conventions ----

void size(const void *p, int *nq, int *nv) { *nq = *nv = static_cast<const model *>(p)->n; }

// The base turns by R = Rz(yaw) Ry(pitch) Rx(roll); omega in body axes is B (yaw', pitch', roll').
struct base {
    mat3 R, B, inverse;
    double yaw, pitch, roll;
};

base base_at(const double *q) {
    base b;
    b.R = rotation_of(q + 3);
    const double *R = b.R.m;
    b.yaw = std::atan2(R[3], R[0]);
    b.pitch = std::atan2(-R[6], std::sqrt(R[0] * R[0] + R[3] * R[3]));
    b.roll = std::atan2(R[7], R[8]);
    const double cp = std::cos(b.pitch), sp = std::sin(b.pitch), cr = std::cos(b.roll), sr = std::sin(b.roll);
    b.B = {{-sp, 0, 1, sr * cp, cr, 0, cr * cp, -sr, 0}};
    b.inverse = {{0, sr / cp, cr / cp, 0, cr, -sr, 1, sr * sp / cp, cr * sp / cp}};
    return b;
}

// d/dt of B times the rates e of (yaw, pitch, roll).
vec3 rate_term(const base &b, vec3 e) {
    const double cp = std::cos(b.pitch), sp = std::sin(b.pitch), cr = std::cos(b.roll), sr = std::sin(b.roll);
    const double p = e.y, r = e.z;
    return {-cp * p * e.x, (cr * cp * r - sr * sp * p) * e.x - sr * r * e.y,
            (-sr * cp * r - cr * sp * p) * e.x - cr * r * e.y};
}

void convert_base(const struct state *rbd, const struct state *its) {
    const base b = base_at(rbd->q);
    const vec3 omega = get(rbd->v), u = get(rbd->v + 3), rates = b.inverse * omega;
    put(its->q, get(rbd->q));
    put(its->q + 3, {b.yaw, b.pitch, b.roll});
    put(its->v, b.R * u);
    put(its->v + 3, rates);
    put(its->a, b.R * (get(rbd->a + 3) + cross(omega, u)));
    put(its->a + 3, b.inverse * (get(rbd->a) - rate_term(b, rates)));
    put(its->tau, b.R * get(rbd->tau + 3));
    put(its->tau + 3, transpose(b.B) * get(rbd->tau));
}

void convert_state(const void *model_, const struct state *rbd, const struct state *its) {
    const model *p = static_cast<const model *>(model_);
    const int first = p->t.floating ? ROOT_DOFS : 0, shift = p->t.nq - p->t.nv;
    if (p->t.floating) convert_base(rbd, its);
    for (int i = first; i < p->n; i++) {
        its->q[i] = rbd->q[i + shift];
        its->v[i] = rbd->v[i];
        its->a[i] = rbd->a[i];
        its->tau[i] = rbd->tau[i];
    }
}

// The base floats in inverse dynamics only: see `can`.
void convert_result(const void *model_, int algorithm, const struct state *rbd, const double *its,
                    double *x) {
    const model *p = static_cast<const model *>(model_);
    const int n = algorithm == MM ? p->n * p->n : algorithm == JACOBIAN ? 6 * p->n : p->n;
    for (int i = 0; i < n; i++) x[i] = its[i];
    if (!p->t.floating) return;
    const base b = base_at(rbd->q);
    put(x, transpose(b.inverse) * get(its + 3));
    put(x + 3, transpose(b.R) * get(its));
}

conventions make_conventions() {
    conventions c = {};
    c.size = size;
    c.state = convert_state;
    c.result = convert_result;
    c.bound = 1e-10;
    c.build = PEER_BUILD;
    c.calls[ID] = "ChainIdSolver_RNE::CartToJnt; trees: TreeIdSolver_RNE::CartToJnt, a floating base as six "
                  "joints of one axis";
    c.calls[MM] = "ChainDynParam::JntToMass (chains only)";
    c.calls[FD] = "ChainFdSolver_RNE::CartToJnt (chains only; mass matrix and L'DL, no ABA)";
    c.calls[JACOBIAN] = "ChainJntToJacSolver::JntToJac (chains only)";
    return c;
}

const conventions others = make_conventions();

library make_library() {
    library l = plain_library("KDL", PEER_VERSION);
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
    l.call[JACOBIAN] = call_jacobian;
    l.can = can;
    l.conventions = &others;
    return l;
}

} // namespace

extern "C" {
PEER extern const struct library library_kdl;
const struct library library_kdl = make_library();
}
