// rbdl.cpp - RBDL (https://github.com/rbdl/rbdl) beside rbd. What is timed stands in `conventions` below;
// states are copied into its vectors, as its calls take no others. SPDX-License-Identifier: MIT
#include <cstring>
#include <new>
#include <rbdl/rbdl.h>
#include "../robots/contacts.h"
#include "world_base.hpp"

namespace {

namespace dynamics = RigidBodyDynamics;
using dynamics::Math::Matrix3d;
using dynamics::Math::MatrixNd;
using dynamics::Math::Vector3d;
using dynamics::Math::VectorNd;

struct model {
    tree t;
    dynamics::Model m;
    std::vector<int> v;           // RBDL's place of each body's joint, in q too, -1 = fixed
    std::vector<int> place;       // RBDL's place of each degree of freedom of rbd
    unsigned last = 0;            // its number of the last body
    dynamics::ConstraintSet feet; // empty if they are not points
};

struct work {
    dynamics::Model m; // it computes in the model
    VectorNd q, v, x, out;
    MatrixNd matrix, J;
    unsigned last;
    dynamics::ConstraintSet feet;
    work(const model &p)
        : m(p.m), q(VectorNd::Zero(m.q_size)), v(VectorNd::Zero(m.qdot_size)), x(v), out(v),
          matrix(MatrixNd::Zero(m.qdot_size, m.qdot_size)), J(MatrixNd::Zero(6, m.qdot_size)), last(p.last),
          feet(p.feet) {
        feet.Bind(m);
    }
};

// ---- model ----

Vector3d vector_of(const double *x) { return Vector3d(x[0], x[1], x[2]); }

// Its rotations turn vectors of the parent into the body's axes.
dynamics::Math::SpatialTransform placement_of(const rbd_body &b) {
    const mat3 R = rotation_given(b.rotation);
    Matrix3d E;
    for (int i = 0; i < 9; i++) E(i % 3, i / 3) = R.m[i];
    return dynamics::Math::SpatialTransform(E, vector_of(b.position));
}

dynamics::Body body_of(const rbd_body &b) {
    const double *I = b.inertia;
    Matrix3d about_com;
    about_com << I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5];
    return dynamics::Body(b.mass, vector_of(b.com), about_com);
}

// By the axis alone, as its URDF reader does: then RBDL takes its own code for turns about x, y and z.
dynamics::Joint joint_of(const rbd_body &b) {
    if (b.type == RBD_FLOATING) return dynamics::Joint(dynamics::JointTypeFloatingBase);
    if (b.type == RBD_FIXED) return dynamics::Joint(dynamics::JointTypeFixed);
    const Vector3d axis = vector_of(b.axis).normalized();
    dynamics::Math::SpatialVector motion = dynamics::Math::SpatialVector::Zero();
    motion.segment<3>(turns(b) ? 0 : 3) = axis;
    return dynamics::Joint(motion);
}

// Points held along the world's axes. A flat contact would be a loop, whose spatial acceleration vanishes.
void add_feet(model *p, const std::vector<unsigned> &number) {
    const int nb = (int)p->t.bodies.size();
    const contact_set *set = contact_set_of(p->t.bodies.data(), nb, CONSTRAINED);
    for (int i = 0; set && i < set->count && !set->contacts[i].flat; i++) {
        const contact &c = set->contacts[i];
        const unsigned body = number[(size_t)contact_body(p->t.bodies.data(), nb, c.body)];
        for (int k = 0; k < 3; k++) p->feet.AddContactConstraint(body, vector_of(c.point), Vector3d::Unit(k));
    }
}

void add_bodies(model *p) {
    std::vector<unsigned> number;
    for (const rbd_body &b : p->t.bodies) {
        const unsigned parent = b.parent < 0 ? 0 : number[(size_t)b.parent];
        const unsigned v = p->m.qdot_size;
        number.push_back(p->m.AddBody(parent, placement_of(b), joint_of(b), body_of(b)));
        p->v.push_back(p->m.qdot_size > v ? (int)v : -1);
        for (unsigned k = v; k < p->m.qdot_size; k++) p->place.push_back((int)k);
    }
    p->last = number.back();
    add_feet(p, number);
}

rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t, const void **out, char *text) {
    model *p = new (memory) model;
    *out = p;
    if (!read_tree(bodies, nb, &p->t, text)) return RBD_ERR_TYPE;
    for (const rbd_body &b : p->t.bodies)
        if (b.armature[0] != 0) {
            std::snprintf(text, 160, "it has no armature: body '%s'", b.name ? b.name : "");
            return RBD_ERR_TYPE;
        }
    add_bodies(p);
    return RBD_OK;
}

size_t model_size(const rbd_body *, int) { return sizeof(model); }

void model_free(const void *p) { static_cast<model *>(const_cast<void *>(p))->~model(); }

rbd_status work_init(const void *p, void *memory, size_t, void **out) {
    *out = new (memory) work(*static_cast<const model *>(p));
    return RBD_OK;
}

size_t work_size(const void *) { return sizeof(work); }
void work_free(void *w) { static_cast<work *>(w)->~work(); }

rbd_status set_gravity(void *w, const double gravity[3]) {
    static_cast<work *>(w)->m.gravity = vector_of(gravity);
    return RBD_OK;
}

// ---- the calls that are timed ----

void take(VectorNd *to, const void *from) {
    std::memcpy(to->data(), from, (size_t)to->size() * sizeof(double));
}

void give(const VectorNd &from, void *to) {
    std::memcpy(to, from.data(), (size_t)from.size() * sizeof(double));
}

rbd_status call_id(const void *, void *work_, int, const void *q, const void *v, const void *a, void *tau) {
    work *w = static_cast<work *>(work_);
    take(&w->q, q), take(&w->v, v), take(&w->x, a);
    dynamics::InverseDynamics(w->m, w->q, w->v, w->x, w->out);
    give(w->out, tau);
    return RBD_OK;
}

// Its matrices stay where they are: the caller's array gets their address.
rbd_status call_mm(const void *, void *work_, int, const void *q, const void *, const void *, void *out) {
    work *w = static_cast<work *>(work_);
    const double *M = w->matrix.data();
    take(&w->q, q);
    dynamics::CompositeRigidBodyAlgorithm(w->m, w->q, w->matrix);
    std::memcpy(out, &M, sizeof M);
    return RBD_OK;
}

rbd_status call_fd(const void *, void *work_, int, const void *q, const void *v, const void *tau, void *a) {
    work *w = static_cast<work *>(work_);
    take(&w->q, q), take(&w->v, v), take(&w->x, tau);
    dynamics::ForwardDynamics(w->m, w->q, w->v, w->x, w->out);
    give(w->out, a);
    return RBD_OK;
}

rbd_status call_jacobian(const void *, void *work_, int, const void *q, const void *, const void *,
                         void *out) {
    work *w = static_cast<work *>(work_);
    const double *J = w->J.data();
    take(&w->q, q);
    dynamics::CalcPointJacobian6D(w->m, w->q, w->last, Vector3d(0, 0, 0), w->J);
    std::memcpy(out, &J, sizeof J);
    return RBD_OK;
}

rbd_status call_constrained(const void *, void *work_, int, const void *q, const void *v, const void *tau,
                            void *out) {
    work *w = static_cast<work *>(work_);
    double *a = static_cast<double *>(out);
    take(&w->q, q), take(&w->v, v), take(&w->x, tau);
    dynamics::ForwardDynamicsConstraintsRangeSpaceSparse(w->m, w->q, w->v, w->x, w->feet, w->out);
    give(w->out, a);
    give(w->feet.force, a + w->out.size());
    return RBD_OK;
}

int can(const void *p, int algorithm) {
    return algorithm != CONSTRAINED || static_cast<const model *>(p)->feet.size() > 0;
}

// ---- conventions: docs/other_libraries.md ----

void size(const void *p, int *nq, int *nv) {
    *nq = (int)static_cast<const model *>(p)->m.q_size;
    *nv = (int)static_cast<const model *>(p)->m.qdot_size;
}

void convert_state(const void *model_, const struct state *rbd, const struct state *its) {
    const model *p = static_cast<const model *>(model_);
    if (p->t.floating) {
        world_base(rbd, its->v, its->a, its->tau);
        std::memcpy(its->q, rbd->q, 6 * sizeof(double)); // position, x, y, z of the quaternion
        its->q[p->m.dof_count] = rbd->q[6];              // its w stands behind all
    }
    for (size_t i = p->t.floating ? 1 : 0; i < p->t.bodies.size(); i++) {
        if (p->t.iv[i] < 0) continue;
        its->q[p->v[i]] = rbd->q[p->t.iq[i]];
        its->v[p->v[i]] = rbd->v[p->t.iv[i]];
        its->a[p->v[i]] = rbd->a[p->t.iv[i]];
        its->tau[p->v[i]] = rbd->tau[p->t.iv[i]];
    }
}

void convert_result(const void *model_, int algorithm, const struct state *rbd, const double *out,
                    double *x) {
    const model *p = static_cast<const model *>(model_);
    const world_order order(p->place, p->t.floating, rbd->q);
    const int nv = (int)p->place.size();
    if (algorithm == ID || algorithm == FD || algorithm == CONSTRAINED) {
        order.vector(out, x);
        if (algorithm != ID && p->t.floating) put(x + 3, get(x + 3) - turned(rbd->v));
        if (algorithm == CONSTRAINED) std::memcpy(x + nv, out + nv, p->feet.size() * sizeof *x);
        return;
    }
    const double *its;
    std::memcpy(&its, out, sizeof its);
    if (algorithm == MM) return order.matrix(its, x);
    std::vector<double> rows((size_t)(6 * nv)); // columns there
    for (int i = 0; i < 6 * nv; i++) rows[(size_t)(i % 6 * nv + i / 6)] = its[i];
    order.columns(rows.data(), 6, x);
}

conventions make_conventions() {
    conventions c = {};
    c.size = size;
    c.state = convert_state;
    c.result = convert_result;
    c.bound = 1e-10;
    c.build = PEER_BUILD;
    c.calls[ID] = "InverseDynamics";
    c.calls[MM] = "CompositeRigidBodyAlgorithm";
    c.calls[FD] = "ForwardDynamics (ABA)";
    c.calls[JACOBIAN] = "CalcPointJacobian6D with the kinematics";
    c.calls[CONSTRAINED] = "ForwardDynamicsConstraintsRangeSpaceSparse, point contacts";
    return c;
}

const conventions others = make_conventions();

library make_library() {
    library l = plain_library("RBDL", PEER_VERSION);
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
    l.call[CONSTRAINED] = call_constrained;
    l.can = can;
    l.conventions = &others;
    return l;
}

} // namespace

extern "C" {
PEER extern const struct library library_rbdl;
const struct library library_rbdl = make_library();
}
