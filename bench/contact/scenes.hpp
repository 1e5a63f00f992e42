// scenes.hpp - robots and boxes that touch the ground: what rbd and MuJoCo simulate, and its controllers.
// SPDX-License-Identifier: MIT
#ifndef CONTACT_SCENES_HPP
#define CONTACT_SCENES_HPP

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>
#include "rbd_contact.h"
#include "../../models/atlas.h"
#include "../../models/hyq.h"

using vector = std::vector<double>;

const double pi = 3.14159265358979323846, g = 9.81;

// Everything that touches is a ball over a plane whose normal is z: MuJoCo's cheapest contact. In place of
// a point it has this radius.
const double point_radius = 1e-3;

inline void must(rbd_status status, const char *what) {
    if (status == RBD_OK) return;
    std::fprintf(stderr, "contact: %s: %s\n", what, rbd_status_string(status));
    std::exit(1);
}

struct scene {
    std::string name;
    std::vector<rbd_body> bodies;
    std::vector<rbd_contact> contacts;
    vector q, v;           // at the beginning
    double slope = 0;      // of the ground, rad: gravity is turned, downhill is x
    double kp = 0, kd = 0; // of a position controller in each joint that turns
    bool trots = false;
    double seconds = 1;      // simulated to judge the result
    double from = 0, to = 0; // the steps between are timed and counted
};

// Model and work of rbd.
class robot {
    std::vector<unsigned char> model_memory, work_memory;

  public:
    const rbd_model *m = nullptr;
    rbd_work *w = nullptr;
    int nq = 0, nv = 0;
    std::vector<rbd_joint_info> joints; // of each body

    explicit robot(const std::vector<rbd_body> &bodies) {
        const int nb = (int)bodies.size();
        model_memory.resize(rbd_model_size(bodies.data(), nb));
        must(rbd_model_build(bodies.data(), nb, model_memory.data(), model_memory.size(), &m, nullptr),
             "model");
        work_memory.resize(rbd_work_size(m));
        must(rbd_work_init(m, work_memory.data(), work_memory.size(), &w), "work");
        joints.resize((size_t)nb);
        for (int b = 0; b < nb; b++) must(rbd_joint(m, b, &joints[(size_t)b]), "joint");
        nq = rbd_nq(m), nv = rbd_nv(m);
    }
    robot(const robot &) = delete;
    robot &operator=(const robot &) = delete;

    void set_slope(double slope) {
        const double gravity[3] = {g * std::sin(slope), 0, -g * std::cos(slope)};
        must(rbd_set_gravity(w, gravity), "gravity");
    }
    void look(const double *q, const double *v) { must(rbd_kinematics(m, w, q, v, nullptr), "kinematics"); }
    vector neutral() const {
        vector q((size_t)nq);
        rbd_neutral(m, q.data());
        return q;
    }
    double height(int body, const double *point) const {
        double p[3];
        must(rbd_point_position(m, w, body, point, p), "point");
        return p[2];
    }
};

// ---- descriptions ----

inline rbd_body box(double lx, double ly, double lz, double mass) {
    rbd_body b = {};
    b.parent = -1, b.type = RBD_FLOATING, b.mass = mass;
    b.inertia[0] = mass * (ly * ly + lz * lz) / 12, b.inertia[3] = mass * (lx * lx + lz * lz) / 12;
    b.inertia[5] = mass * (lx * lx + ly * ly) / 12;
    return b;
}

inline rbd_contact ball(int body1, int body2, double x, double y, double z, double radius, double friction) {
    rbd_contact c = {};
    c.body1 = body1, c.body2 = body2, c.on_body = body2 >= 0, c.point[0] = x, c.point[1] = y, c.point[2] = z;
    c.radius = radius, c.friction = friction;
    return c;
}

// Balls in the lower corners of a box, that end at its faces; at the upper ones for top = true.
inline void add_corners(scene *s, int body1, int body2, double lx, double ly, double lz, double radius,
                        bool top = false) {
    for (int i = 0; i < 4; i++) {
        const double x = lx / 2 - radius, y = ly / 2 - radius, z = lz / 2 - radius;
        s->contacts.push_back(ball(body1, body2, i & 1 ? x : -x, i & 2 ? y : -y, top ? z : -z, radius, 0.5));
    }
}

inline scene block(int degrees) {
    scene s;
    s.name = "block, " + std::to_string(degrees) + " degrees";
    s.bodies = {box(0.4, 0.3, 0.2, 3)};
    s.q = robot(s.bodies).neutral(), s.v.resize(6);
    s.q[2] = 0.1, s.slope = degrees * pi / 180;
    s.seconds = 2, s.from = 0.1, s.to = 0.2;
    add_corners(&s, 0, -1, 0.4, 0.3, 0.2, point_radius);
    return s;
}

inline scene thrown_box() {
    scene s;
    s.name = "thrown box";
    s.bodies = {box(0.4, 0.3, 0.2, 3)};
    s.q = robot(s.bodies).neutral(), s.v = {3, 5, 2, 2, 0, 0};
    s.q[2] = 1, s.seconds = 4, s.from = 0.4, s.to = 0.9;
    for (bool top : {false, true}) add_corners(&s, 0, -1, 0.4, 0.3, 0.2, point_radius, top);
    return s;
}

// The balls are large, since MuJoCo's sink into the box below: its planes stand still, so that a box's
// face is one.
inline scene stack() {
    scene s;
    s.name = "stack 1, 1, 100 kg";
    s.bodies = {box(0.2, 0.2, 0.2, 1), box(0.2, 0.2, 0.2, 1), box(0.2, 0.2, 0.2, 100)};
    s.q = robot(s.bodies).neutral(), s.v.resize(18);
    s.from = 0.1, s.to = 0.2;
    for (int k = 0; k < 3; k++) {
        s.q[(size_t)(7 * k + 2)] = 0.1 + 0.2 * k;
        add_corners(&s, k, k - 1, 0.2, 0.2, 0.2, 0.03);
    }
    for (rbd_contact &c : s.contacts) c.height = c.body2 < 0 ? 0 : 0.1;
    return s;
}

inline scene hyq(bool trots) {
    static const double stance[3] = {0, 0.7, -1.4};
    scene s;
    s.name = trots ? "HyQ trots" : "HyQ dropped, stands";
    s.bodies.assign(hyq_bodies, hyq_bodies + HYQ_NB);
    robot r(s.bodies);
    s.q = r.neutral(), s.v.resize(HYQ_NV);
    for (int k = 0; k < 12; k++) s.q[(size_t)(7 + k)] = (k % 4 < 2 ? 1 : -1) * stance[k / 4];
    for (int k = 0; k < 4; k++)
        s.contacts.push_back(ball(HYQ_BODY_LF_LOWERLEG + k, -1, 0.33, 0, 0, point_radius, 0.7));
    r.look(s.q.data(), nullptr);
    s.q[2] = point_radius - r.height(HYQ_BODY_LF_LOWERLEG, s.contacts[0].point) + (trots ? 0 : 0.05);
    s.kp = 300, s.kd = 8, s.trots = trots;
    s.from = 0.25, s.to = trots ? 0.75 : 0.35;
    return s;
}

// Knees bent, the centre of mass over the middle of the feet.
inline scene atlas() {
    static const int hips[2] = {ATLAS_DOF_L_LEG_HPY, ATLAS_DOF_R_LEG_HPY},
                     knees[2] = {ATLAS_DOF_L_LEG_KNY, ATLAS_DOF_R_LEG_KNY},
                     ankles[2] = {ATLAS_DOF_L_LEG_AKY, ATLAS_DOF_R_LEG_AKY};
    const double middle[3] = {0.045, 0, -0.08};
    scene s;
    s.name = "Atlas stands";
    s.bodies.assign(atlas_bodies, atlas_bodies + ATLAS_NB);
    robot r(s.bodies);
    s.q = r.neutral(), s.v.resize(ATLAS_NV);
    const auto q_of = [&](int dof) -> double & {
        return s.q[(size_t)r.joints[(size_t)rbd_dof_body(r.m, dof)].iq];
    };
    const int feet[2] = {rbd_body_index(r.m, "l_foot"), rbd_body_index(r.m, "r_foot")};
    for (int i = 0; i < 8; i++)
        s.contacts.push_back(
            ball(feet[i / 4], -1, i & 1 ? 0.17 : -0.08, i & 2 ? 0.06 : -0.06, -0.08, point_radius, 0.8));
    for (int k = 0; k < 2; k++) q_of(hips[k]) = q_of(ankles[k]) = -0.4, q_of(knees[k]) = 0.8;
    for (int i = 0; i < 20; i++) {
        double com[3], p[3];
        r.look(s.q.data(), nullptr);
        must(rbd_com(r.m, r.w, com, nullptr, nullptr), "com");
        must(rbd_point_position(r.m, r.w, feet[0], middle, p), "point");
        for (int k = 0; k < 2; k++) q_of(hips[k]) -= com[0] - p[0], q_of(ankles[k]) += com[0] - p[0];
    }
    r.look(s.q.data(), nullptr);
    s.q[2] = point_radius - r.height(feet[0], middle);
    s.kp = 5000, s.kd = 100;
    s.from = 0.1, s.to = 0.2;
    return s;
}

inline std::vector<scene> all_scenes() {
    return {hyq(false), hyq(true), atlas(), block(26), block(27), block(40), thrown_box(), stack()};
}

// ---- controllers ----

// Deviation of HyQ's joints from their stance in a trot of 2 Hz: diagonal legs lift in turns.
inline double trot(int joint, double t) {
    const int leg = joint % 4;
    const double side = leg < 2 ? 1 : -1, phase = 4 * pi * t + (leg == 0 || leg == 3 ? 0 : pi),
                 lift = std::max(std::sin(phase), 0.0);
    if (joint < 4) return 0;
    return joint < 8 ? 0.25 * side * lift - 0.1 * std::cos(phase) : -0.5 * side * lift;
}

// kp times the error of position; the damping kd + h kp is left to the simulation. Half of h kp would be
// neutral in rbd's step; this is stable in MuJoCo's too, at every h.
inline void control(const scene &s, const robot &r, double t, const double *q, double *tau) {
    for (const rbd_joint_info &j : r.joints) {
        if (j.nv != 1) continue;
        const double wanted = s.q[(size_t)j.iq] + (s.trots ? trot(j.iv - 6, t) : 0);
        tau[j.iv] = s.kp * (wanted - q[j.iq]);
    }
}

#endif
