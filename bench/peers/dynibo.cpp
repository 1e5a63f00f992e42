// dynibo.cpp - dynibo (https://github.com/xiaojie-xue/dynibo), through its C interface, beside rbd: its robot
// comes from URDF text that this file writes from the description. What is timed stands in `conventions`
// below; the state of a floating base is set in the robot at each call. SPDX-License-Identifier: MIT
#include <cstdlib>
#include <cstring>
#include <dynibo/dynibo.h>
#include <new>
#include <string>
#include <unistd.h>
#include "tree.hpp"

namespace {

struct model {
    tree t;
    DyniboRobot *robot = nullptr;
    DyniboWorkspace *apart = nullptr; // for what is not timed
    std::vector<int> place;           // its place of each body's joint among all joints, -1 = none
    size_t joints = 0, last = 0;      // how many joints; its number of the last body
    int base_q = 0, base_v = 0;       // numbers of the base's state: 7 and 6, or none
    double gravity = 0;               // along z
};

struct work {
    model *p;
    DyniboWorkspace *space;
};

// ---- URDF ----

std::string numbers(const char *name, const double *x, int n) {
    std::string s = std::string(" ") + name + "=\"";
    char text[40];
    for (int i = 0; i < n; i++) {
        std::snprintf(text, sizeof text, "%s%.17g", i ? " " : "", x[i]);
        s += text;
    }
    return s + "\"";
}

// Roll, pitch and yaw: R = Rz(yaw) Ry(pitch) Rx(roll).
std::string origin(const double position[3], const mat3 &R) {
    const double *m = R.m, across = std::sqrt(m[0] * m[0] + m[3] * m[3]);
    double rpy[3] = {std::atan2(m[7], m[8]), std::atan2(-m[6], across), std::atan2(m[3], m[0])};
    if (across < 1e-9) rpy[0] = std::atan2(-m[5], m[4]), rpy[2] = 0; // roll and yaw turn about one axis
    return "<origin" + numbers("xyz", position, 3) + numbers("rpy", rpy, 3) + "/>";
}

std::string link(const rbd_body &b, int index) {
    static const char *const names[6] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
    const double unturned[9] = {};
    std::string inertia;
    for (int k = 0; k < 6; k++) inertia += numbers(names[k], &b.inertia[k], 1);
    return "<link name=\"b" + std::to_string(index) + "\"><inertial>" +
           origin(b.com, rotation_given(unturned)) + "<mass" + numbers("value", &b.mass, 1) + "/><inertia" +
           inertia + "/></inertial></link>\n";
}

std::string joint(const rbd_body &b, int index) {
    const char *type = turns(b) ? "continuous" : b.type == RBD_FIXED ? "fixed" : "prismatic";
    const std::string parent = b.parent < 0 ? "world" : "b" + std::to_string(b.parent);
    const std::string name = std::to_string(index);
    return "<joint name=\"j" + name + "\" type=\"" + type + "\">" +
           origin(b.position, rotation_given(b.rotation)) + "<parent link=\"" + parent +
           "\"/><child link=\"b" + name + "\"/><axis" + numbers("xyz", b.axis, 3) +
           "/><limit lower=\"-1e3\" upper=\"1e3\" effort=\"1\" velocity=\"1\"/></joint>\n";
}

std::string urdf(const tree &t) {
    std::string s = "<robot name=\"robot\">\n";
    if (!t.floating) s += "<link name=\"world\"/>\n"; // else body 0 is the root
    for (int i = 0; i < (int)t.bodies.size(); i++) s += link(t.bodies[(size_t)i], i);
    for (int i = t.floating; i < (int)t.bodies.size(); i++) s += joint(t.bodies[(size_t)i], i);
    return s + "</robot>\n";
}

DyniboRobot *read_urdf(const std::string &text, bool floating) {
    char path[] = "/tmp/rbd-bench-XXXXXX";
    DyniboRobot *robot = nullptr;
    const int file = mkstemp(path);
    if (file < 0) return nullptr;
    if (write(file, text.data(), text.size()) == (ssize_t)text.size())
        dynibo_robot_from_urdf_with_base(path, floating ? DYNIBO_BASE_FLOATING : DYNIBO_BASE_FIXED, &robot);
    close(file);
    unlink(path);
    return robot;
}

// ---- model and work ----

// Its joints stand breadth first, children as in the file.
void find_places(model *p) {
    std::vector<int> queue = {-1};
    p->place.assign(p->t.bodies.size(), -1);
    for (size_t k = 0; k < queue.size(); k++)
        for (int i = 0; i < (int)p->t.bodies.size(); i++) {
            const rbd_body &b = p->t.bodies[(size_t)i];
            if (b.parent != queue[k]) continue;
            queue.push_back(i);
            if (has_one_axis(b)) p->place[(size_t)i] = (int)p->joints++;
        }
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
    find_places(p);
    if (p->t.floating) p->base_q = 7, p->base_v = 6;
    p->robot = read_urdf(urdf(p->t), p->t.floating);
    const std::string last = "b" + std::to_string(nb - 1);
    if (p->robot && dynibo_workspace_create(p->robot, &p->apart) == DYNIBO_STATUS_OK &&
        dynibo_robot_link_id(p->robot, last.c_str(), &p->last) == DYNIBO_STATUS_OK)
        return RBD_OK;
    std::snprintf(text, 160, "%.150s", dynibo_last_error_message());
    return RBD_ERR_MEMORY;
}

size_t model_size(const rbd_body *, int) { return sizeof(model); }

void model_free(const void *out) {
    model *p = static_cast<model *>(const_cast<void *>(out));
    dynibo_workspace_destroy(p->apart);
    dynibo_robot_destroy(p->robot);
    p->~model();
}

rbd_status work_init(const void *model_, void *memory, size_t, void **out) {
    work *w = new (memory) work;
    w->p = static_cast<model *>(const_cast<void *>(model_));
    w->space = nullptr;
    *out = w;
    return dynibo_workspace_create(w->p->robot, &w->space) == DYNIBO_STATUS_OK ? RBD_OK : RBD_ERR_MEMORY;
}

size_t work_size(const void *) { return sizeof(work); }
void work_free(void *w) { dynibo_workspace_destroy(static_cast<work *>(w)->space); }

rbd_status set_gravity(void *w, const double gravity[3]) {
    static_cast<work *>(w)->p->gravity = gravity[2];
    return RBD_OK;
}

// ---- the calls that are timed ----

rbd_status status_of(DyniboStatus s) { return s == DYNIBO_STATUS_OK ? RBD_OK : RBD_ERR_WORK; }

DyniboPose pose_of(const double *q) {
    DyniboPose pose;
    std::memcpy(pose.translation, q, sizeof pose.translation);
    std::memcpy(pose.rotation_xyzw, q + 3, sizeof pose.rotation_xyzw);
    return pose;
}

DyniboTwist twist_of(const double *v) { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }

void place_base(const model *p, const double *q) {
    if (p->base_q == 0) return;
    const DyniboPose pose = pose_of(q);
    dynibo_robot_set_base_frame(p->robot, &pose);
}

rbd_status call_id(const void *model_, void *work_, int, const void *q_, const void *v_, const void *a_,
                   void *tau) {
    const model *p = static_cast<const model *>(model_);
    const double *q = static_cast<const double *>(q_), *v = static_cast<const double *>(v_),
                 *a = static_cast<const double *>(a_);
    if (p->base_q > 0) {
        const DyniboPose pose = pose_of(q);
        dynibo_robot_set_floating_base_state(p->robot, &pose, twist_of(v), twist_of(a));
    }
    return status_of(dynibo_inverse_dynamics(p->robot, static_cast<work *>(work_)->space, q + p->base_q,
                                             v + p->base_v, a + p->base_v, p->joints, nullptr, 0,
                                             static_cast<double *>(tau), (size_t)p->t.nv));
}

rbd_status call_mm(const void *model_, void *work_, int, const void *q_, const void *, const void *,
                   void *M) {
    const model *p = static_cast<const model *>(model_);
    const double *q = static_cast<const double *>(q_);
    place_base(p, q);
    return status_of(dynibo_mass_matrix(p->robot, static_cast<work *>(work_)->space, q + p->base_q, p->joints,
                                        static_cast<double *>(M), (size_t)(p->t.nv * p->t.nv)));
}

rbd_status call_jacobian(const void *model_, void *work_, int, const void *q_, const void *, const void *,
                         void *J) {
    const model *p = static_cast<const model *>(model_);
    const double *q = static_cast<const double *>(q_);
    place_base(p, q);
    return status_of(dynibo_jacobian(p->robot, static_cast<work *>(work_)->space, q + p->base_q, p->joints,
                                     p->last, static_cast<double *>(J), (size_t)(6 * p->t.nv)));
}

// ---- conventions: its base has angular, then linear motion in world axes; accelerations classical ----

void size(const void *p, int *nq, int *nv) {
    *nq = static_cast<const model *>(p)->t.nq;
    *nv = static_cast<const model *>(p)->t.nv;
}

// A vector of the base, angular first, in other axes: the world's by R.
void turn(const mat3 &R, const double *from, double *to) {
    const vec3 angular = R * get(from), linear = R * get(from + 3);
    put(to, angular);
    put(to + 3, linear);
}

void convert_base(const struct state *rbd, const struct state *its) {
    const mat3 R = rotation_of(rbd->q + 3);
    double classical[6];
    put(classical, get(rbd->a));
    put(classical + 3, get(rbd->a + 3) + cross(get(rbd->v), get(rbd->v + 3)));
    std::memcpy(its->q, rbd->q, 7 * sizeof(double));
    turn(R, rbd->v, its->v);
    turn(R, classical, its->a);
    turn(R, rbd->tau, its->tau);
}

void convert_state(const void *model_, const struct state *rbd, const struct state *its) {
    const model *p = static_cast<const model *>(model_);
    if (p->t.floating) convert_base(rbd, its);
    for (size_t i = 0; i < p->t.bodies.size(); i++) {
        if (p->place[i] < 0) continue;
        const int k = p->base_v + p->place[i];
        its->q[p->base_q + p->place[i]] = rbd->q[p->t.iq[i]];
        its->v[k] = rbd->v[p->t.iv[i]];
        its->a[k] = rbd->a[p->t.iv[i]];
        its->tau[k] = rbd->tau[p->t.iv[i]];
    }
}

// A row of nv.
void convert_row(const model *p, const double *q, const double *its, double *x) {
    if (p->t.floating) turn(transpose(rotation_of(q + 3)), its, x);
    for (size_t i = 0; i < p->place.size(); i++)
        if (p->place[i] >= 0) x[p->t.iv[i]] = its[p->base_v + p->place[i]];
}

// It has 9.80665 down compiled in: takes that away, and adds the gravity that is set.
void change_gravity(const model *p, const struct state *rbd, std::vector<double> *tau) {
    std::vector<double> g(tau->size()), q((size_t)p->t.nq), v(tau->size()), a(v), unused(v);
    const struct state its = {q.data(), v.data(), a.data(), unused.data()};
    convert_state(p, rbd, &its);
    place_base(p, q.data());
    dynibo_gravity(p->robot, p->apart, q.data() + p->base_q, p->joints, nullptr, 0, g.data(), g.size());
    for (size_t i = 0; i < g.size(); i++) (*tau)[i] -= (1 + p->gravity / 9.80665) * g[i];
}

void convert_result(const void *model_, int algorithm, const struct state *rbd, const double *its,
                    double *x) {
    const model *p = static_cast<const model *>(model_);
    const size_t nv = (size_t)p->t.nv;
    std::vector<double> row(nv), matrix(nv * nv);
    switch (algorithm) {
    case ID:
        row.assign(its, its + nv);
        change_gravity(p, rbd, &row);
        convert_row(p, rbd->q, row.data(), x);
        break;
    case JACOBIAN: // by columns there
        for (size_t i = 0; i < 6; i++) {
            for (size_t j = 0; j < nv; j++) row[j] = its[j * 6 + i];
            convert_row(p, rbd->q, row.data(), x + i * nv);
        }
        break;
    case MM: // rows, then columns
        for (size_t i = 0; i < nv; i++) convert_row(p, rbd->q, its + i * nv, &matrix[i * nv]);
        for (size_t j = 0; j < nv; j++) {
            std::vector<double> column(nv);
            for (size_t i = 0; i < nv; i++) row[i] = matrix[i * nv + j];
            convert_row(p, rbd->q, row.data(), column.data());
            for (size_t i = 0; i < nv; i++) x[i * nv + j] = column[i];
        }
        break;
    }
}

conventions make_conventions() {
    conventions c = {};
    c.size = size;
    c.state = convert_state;
    c.result = convert_result;
    c.bound = 1e-10;
    c.build = PEER_BUILD;
    c.calls[ID] = "dynibo_inverse_dynamics, the base's state set before";
    c.calls[MM] = "dynibo_mass_matrix, the base's pose set before";
    c.calls[JACOBIAN] = "dynibo_jacobian, the base's pose set before";
    return c;
}

const conventions others = make_conventions();

library make_library() {
    library l = plain_library("dynibo", PEER_VERSION);
    l.model_build = model_build;
    l.model_size = model_size;
    l.model_free = model_free;
    l.work_init = work_init;
    l.work_size = work_size;
    l.work_free = work_free;
    l.set_gravity = set_gravity;
    l.call[ID] = call_id;
    l.call[MM] = call_mm;
    l.call[JACOBIAN] = call_jacobian;
    l.conventions = &others;
    return l;
}

} // namespace

extern "C" {
PEER extern const struct library library_dynibo;
const struct library library_dynibo = make_library();
}
