// pinocchio_model.hpp - a robot as Pinocchio's model, and its conventions: what the adapters of its run-time
// calls and of its generated code share. SPDX-License-Identifier: MIT
#ifndef PEERS_PINOCCHIO_MODEL_HPP
#define PEERS_PINOCCHIO_MODEL_HPP

#include <new>
#include <string>
#include <pinocchio/multibody/model.hpp>
#include "tree.hpp"

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

struct model {
    tree t;
    pinocchio::Model m;
    std::vector<int> q, v;  // Pinocchio's places of each body's joint, -1 = fixed
    std::vector<int> joint; // and its number
    std::vector<int> place; // Pinocchio's place of each degree of freedom of rbd
    std::size_t last = 0;   // frame of the last body
    bool every_body_moves = true;
};

inline Vector3d vector_of(const double *x) { return Vector3d(x[0], x[1], x[2]); }

inline pinocchio::SE3 placement_of(const rbd_body &b) {
    const mat3 R = rotation_given(b.rotation);
    Matrix3d rotation;
    for (int i = 0; i < 9; i++) rotation(i / 3, i % 3) = R.m[i];
    return pinocchio::SE3(rotation, vector_of(b.position));
}

inline pinocchio::Inertia inertia_of(const rbd_body &b) {
    const double *I = b.inertia;
    Matrix3d about_com;
    about_com << I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5];
    return pinocchio::Inertia(b.mass, vector_of(b.com), about_com);
}

// The joint that its URDF loader would make: about a coordinate axis where it can.
inline pinocchio::JointModel joint_of(const rbd_body &b) {
    const Vector3d axis = vector_of(b.axis).normalized();
    if (b.type == RBD_FLOATING) return pinocchio::JointModelFreeFlyer();
    if (turns(b)) {
        if (axis == Vector3d::UnitX()) return pinocchio::JointModelRX();
        if (axis == Vector3d::UnitY()) return pinocchio::JointModelRY();
        if (axis == Vector3d::UnitZ()) return pinocchio::JointModelRZ();
        return pinocchio::JointModelRevoluteUnaligned(axis);
    }
    if (axis == Vector3d::UnitX()) return pinocchio::JointModelPX();
    if (axis == Vector3d::UnitY()) return pinocchio::JointModelPY();
    if (axis == Vector3d::UnitZ()) return pinocchio::JointModelPZ();
    return pinocchio::JointModelPrismaticUnaligned(axis);
}

// Where a body is: on a joint, at a placement.
struct seat {
    std::size_t joint = 0;
    pinocchio::SE3 placement = pinocchio::SE3::Identity();
};

// A body and what hangs on it, depth first: its algorithms take the joints of a subtree to be contiguous.
inline void add_bodies(model *p, int i, seat s) {
    const rbd_body &b = p->t.bodies[(size_t)i];
    const size_t k = (size_t)i;
    s.placement = s.placement * placement_of(b);
    if (b.type == RBD_FIXED) {
        p->every_body_moves = false;
    } else {
        s.joint = p->m.addJoint(s.joint, joint_of(b), s.placement, "j" + std::to_string(i));
        s.placement = pinocchio::SE3::Identity();
        p->q[k] = p->m.joints[s.joint].idx_q();
        p->v[k] = p->m.joints[s.joint].idx_v();
        if (b.type != RBD_FLOATING) p->m.armature[p->v[k]] = b.armature[0];
    }
    p->joint[k] = (int)s.joint;
    p->m.appendBodyToJoint(s.joint, inertia_of(b), s.placement);
    const pinocchio::Frame frame("b" + std::to_string(i), s.joint, 0, s.placement, pinocchio::BODY);
    const std::size_t number = p->m.addFrame(frame);
    if (k + 1 == p->t.bodies.size()) p->last = number;
    for (int child = i + 1; child < (int)p->t.bodies.size(); child++)
        if (p->t.bodies[(size_t)child].parent == i) add_bodies(p, child, s);
}

// rbd has the base's angular components first.
inline void find_places(model *p) {
    for (size_t i = 0; i < p->t.bodies.size(); i++) {
        const int v = p->v[i], n = v < 0 ? 0 : p->t.bodies[i].type == RBD_FLOATING ? 6 : 1;
        for (int k = 0; k < n; k++) p->place.push_back(v + (n == 6 ? (k + 3) % 6 : k));
    }
}

inline rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t, const void **out,
                              char *text) {
    model *p = new (memory) model;
    *out = p;
    if (!read_tree(bodies, nb, &p->t, text)) return RBD_ERR_TYPE;
    p->q.assign((size_t)nb, -1);
    p->v = p->joint = p->q;
    for (int i = 0; i < nb; i++)
        if (bodies[i].parent < 0) add_bodies(p, i, seat());
    find_places(p);
    return RBD_OK;
}

inline size_t model_size(const rbd_body *, int) { return sizeof(model); }

inline void model_free(const void *p) { static_cast<model *>(const_cast<void *>(p))->~model(); }

// ---- conventions: docs/other_libraries.md ----

inline void size(const void *p, int *nq, int *nv) {
    *nq = static_cast<const model *>(p)->m.nq;
    *nv = static_cast<const model *>(p)->m.nv;
}

inline void convert_state(const void *model_, const struct state *rbd, const struct state *its) {
    const model *p = static_cast<const model *>(model_);
    for (size_t i = 0; i < p->t.bodies.size(); i++)
        for (int k = 0; p->q[i] >= 0 && k < (p->t.bodies[i].type == RBD_FLOATING ? 7 : 1); k++)
            its->q[p->q[i] + k] = rbd->q[p->t.iq[i] + k];
    for (int i = 0; i < p->m.nv; i++) {
        const int k = p->place[(size_t)i];
        its->v[k] = rbd->v[i], its->a[k] = rbd->a[i], its->tau[k] = rbd->tau[i];
    }
}

template <typename Matrix> inline void reorder(const model *p, const Matrix &its, double *x) {
    const int nv = p->m.nv;
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) x[i * nv + j] = its(p->place[(size_t)i], p->place[(size_t)j]);
}

// A symmetric matrix of which the upper triangle alone is filled.
template <typename Matrix> inline void reorder_upper(const model *p, const Matrix &its, double *x) {
    const MatrixXd full = its.template selfadjointView<Eigen::Upper>();
    reorder(p, full, x);
}

#endif
