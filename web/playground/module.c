/* The playground's module: a URDF text becomes a model, told once as JSON; then numbers in arrays, whose
   places the JSON has. One robot for each instance: another one takes a new instance.
   SPDX-License-Identifier: MIT */
#include "rbd_urdf.h"
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_contact.h"
#include "rbd_ik.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

static const rbd_model *m;
static rbd_work *w;
static rbd_derivatives *d;
static rbd_contact_set *contacts;
static void *contact_memory;
static int ncontacts;

enum { BALLS = 300, TARGETS = 40, TARGET = 18 }; /* at most so many; numbers of a target */

/* ---- arrays that the page reads and writes ---- */

static double *q, *v, *tau, *damping, *stiffness, *wanted, *f_ext; /* state, and what moves it */
static double *poses, *com, *energy, *gravity, *mass_matrix, *jacobian, *out;
static double *contact_forces;                /* 4 for each ball: state, force */
static double *standing, *feet, *foot_forces; /* torques; body, x, y, z of each foot; 3 for each */
static double *targets, *reached;             /* of inverse kinematics; m, dof of the limit or -1 */
static char sentence[200];

static void *allocate(size_t n, size_t size) {
    void *memory = calloc(n ? n : 1, size);
    if (!memory) abort(); /* the page reads a trap as: out of memory */
    return memory;
}

/* ---- JSON ---- */

static char *json;
static size_t used, room;

static void text(const char *s) {
    const size_t n = strlen(s);
    if (used + n + 1 > room) json = realloc(json, room = 2 * (used + n + 1));
    if (!json) abort();
    memcpy(json + used, s, n + 1);
    used += n;
}

static void string(const char *s) {
    char c[8];
    if (!s) {
        text("null");
        return;
    }
    text("\"");
    for (; *s; s++) {
        const unsigned char u = (unsigned char)*s;
        snprintf(c, sizeof c, u < 32 || u == '"' || u == '\\' ? "\\u%04x" : "%c", u);
        text(c);
    }
    text("\"");
}

static void number(double x) {
    char c[40];
    snprintf(c, sizeof c, "%.17g", x);
    text(c);
}

static void key(const char *name) { text(",\""), text(name), text("\":"); }
static void named_number(const char *name, double x) { key(name), number(x); }
static void named_string(const char *name, const char *s) { key(name), string(s); }
static void named_list(const char *name, const double *x, int n) {
    key(name), text("[");
    for (int i = 0; i < n; i++) text(i ? "," : ""), number(x[i]);
    text("]");
}

static void finding(const rbd_urdf_finding *f) {
    text("{\"line\":"), number(f->line), named_number("status", f->status);
    named_string("text", f->text), text("}");
}

static double *array(const char *name, int n) {
    double *x = allocate((size_t)n, sizeof *x);
    const double place[2] = {(double)(size_t)x, n};
    named_list(name, place, 2);
    return x;
}

/* ---- loading ---- */

/* After an error r has the first warnings, which may say where it comes from. */
static rbd_urdf_status parse(const char *xml, size_t length, const rbd_urdf_options *o, rbd_urdf *r) {
    static rbd_urdf_finding first[20];
    r->warnings = first;
    r->warnings_max = sizeof first / sizeof *first;
    const rbd_urdf_status status = rbd_urdf_parse(xml, length, o, r);
    if (status) return status;
    r->bodies_max = r->nb, r->names_max = r->names_size, r->frames_max = r->nframes;
    r->warnings_max = r->nwarnings;
    r->bodies = allocate((size_t)r->nb, sizeof *r->bodies);
    r->names = allocate(r->names_size, 1);
    r->frames = allocate((size_t)r->nframes, sizeof *r->frames);
    r->warnings = allocate((size_t)r->nwarnings, sizeof *r->warnings);
    return rbd_urdf_parse(xml, length, o, r);
}

static rbd_status build(const rbd_urdf *r, int kinematic, rbd_report *report) {
    const size_t size = rbd_model_size(r->bodies, r->nb);
    void *memory = allocate(size, 1);
    rbd_status status = kinematic ? rbd_model_build_kinematic(r->bodies, r->nb, memory, size, &m, report)
                                  : rbd_model_build(r->bodies, r->nb, memory, size, &m, report);
    if (status) return status;
    const size_t work = rbd_work_size(m);
    status = rbd_work_init(m, allocate(work, 1), work, &w);
    if (status) return status;
    const size_t derivatives = rbd_derivatives_size(m);
    return rbd_derivatives_init(m, w, allocate(derivatives, 1), derivatives, &d);
}

static void tell_body(const rbd_body *b, int i) {
    rbd_joint_info info;
    rbd_joint(m, i, &info);
    text(i ? ",{\"name\":" : "{\"name\":"), string(b->name), named_string("joint", b->joint);
    named_number("type", b->type), named_number("parent", b->parent);
    named_number("iq", info.iq), named_number("nq", info.nq);
    named_number("iv", info.iv), named_number("nv", info.nv);
    named_number("lower", b->lower), named_number("upper", b->upper), named_number("effort", b->effort);
    named_number("mass", b->mass), named_list("com", b->com, 3), named_list("inertia", b->inertia, 6);
    named_list("axis", b->axis, 3), named_list("position", b->position, 3), text("}");
}

static void tell_frame(const rbd_urdf_frame *f, int i) {
    text(i ? ",{\"link\":" : "{\"link\":"), string(f->link), named_string("joint", f->joint);
    named_number("parent", f->parent), named_number("body", f->body);
    named_list("position", f->position, 3), named_list("rotation", f->rotation, 9), text("}");
}

static void tell_robot(const rbd_urdf *r) {
    named_string("name", r->name), named_number("nb", r->nb);
    named_number("nq", rbd_nq(m)), named_number("nv", rbd_nv(m)), named_number("mass", rbd_mass(m));
    key("bodies"), text("[");
    for (int i = 0; i < r->nb; i++) tell_body(&r->bodies[i], i);
    text("]"), key("frames"), text("[");
    for (int i = 0; i < r->nframes; i++) tell_frame(&r->frames[i], i);
    text("]");
}

static void tell_arrays(void) {
    const int nb = rbd_nb(m), nq = rbd_nq(m), nv = rbd_nv(m);
    key("arrays"), text("{\"none\":[0,0]");
    q = array("q", nq), wanted = array("wanted", nq), v = array("v", nv), tau = array("tau", nv);
    damping = array("damping", nv), stiffness = array("stiffness", nv), gravity = array("gravity", nv);
    f_ext = array("f_ext", 6 * nb), poses = array("poses", 12 * nb), com = array("com", 3);
    energy = array("energy", 2), mass_matrix = array("mass_matrix", nv * nv);
    jacobian = array("jacobian", 6 * nv), out = array("out", 2 * nv * nv);
    contact_forces = array("contact_forces", 4 * BALLS);
    standing = array("standing", nv), feet = array("feet", 4 * BALLS),
    foot_forces = array("foot_forces", 3 * BALLS);
    targets = array("targets", TARGET * TARGETS), reached = array("reached", 2);
    text("}");
}

/* src/robot.js knows these by number. */
typedef char types_are_those_of_robot_js
    [RBD_FIXED == 0 && RBD_PRISMATIC == 4 && RBD_PLANAR == 13 && RBD_FLOATING == 15 ? 1 : -1];
typedef char kinds_are_those_of_robot_js[RBD_IK_POINT == 1 && RBD_IK_POSE == 2 ? 1 : -1];

/* 0, or a status; web_json says more. */
EXPORT int web_load(const char *xml, size_t length, int floating, int lock_massless, int kinematic) {
    const rbd_urdf_options o = {
        .root = floating ? RBD_FLOATING : RBD_FIXED, .lock_massless = lock_massless, .kinematic = kinematic};
    rbd_urdf r = {0};
    rbd_report report;
    int status = parse(xml, length, &o, &r);
    text("{\"status\":"), number(status), key("errors"), text("[");
    if (status) finding(&r.error);
    text("]"), key("warnings"), text("[");
    for (int i = 0; i < r.nwarnings && i < r.warnings_max; i++) text(i ? "," : ""), finding(&r.warnings[i]);
    text("]");
    if (!status && (status = build(&r, kinematic, &report)) != 0)
        named_string("build", rbd_status_string(status));
    if (!status) tell_robot(&r), tell_arrays(), rbd_neutral(m, q);
    text("}");
    return status;
}

EXPORT const char *web_json(void) { return json; }

/* ---- what the page asks at a pose ---- */

/* poses (12 for each body: rotation, origin), com, energy (kinetic, potential), of q and v. */
EXPORT int web_pose(void) {
    const rbd_status status = rbd_kinematics(m, w, q, v, NULL);
    for (int i = 0; i < rbd_nb(m); i++) rbd_body_pose(m, w, i, poses + 12 * i, poses + 12 * i + 9);
    rbd_com(m, w, com, NULL, NULL);
    rbd_energy(m, w, &energy[0], &energy[1]);
    return status;
}

/* gravity, mass_matrix. */
EXPORT int web_dynamics(void) {
    const rbd_status status = rbd_gravity_torque(m, w, q, gravity);
    return status ? (int)status : (int)rbd_crba(m, w, q, mass_matrix);
}

/* jacobian of a point of a body, world axes; after web_pose. */
EXPORT int web_jacobian(int body, double x, double y, double z) {
    const double point[3] = {x, y, z};
    return rbd_jacobian(m, w, body, point, RBD_WORLD_AXES, jacobian);
}

/* Torques that hold the robot at rest on `feet`, n points that stay where they are, and the forces there, of
   least squares: `standing` and `foot_forces`. A force may pull; what motors cannot give is at the root. */
EXPORT int web_stand(int n) {
    rbd_constraint list[BALLS];
    rbd_constraint_set *set;
    for (int i = 0; i < n; i++) list[i] = rbd_point_contact((int)feet[4 * i], feet + 4 * i + 1, NULL);

    const size_t size = rbd_constraint_set_size(m, list, n);
    void *memory = allocate(size, 1);
    double *rest = allocate((size_t)rbd_nv(m), sizeof *rest);
    rbd_status status = rbd_constraint_set_init(m, w, list, n, memory, size, &set, NULL);
    if (!status) status = rbd_constrained_id(m, set, q, rest, rest, NULL, NULL, NULL, standing, foot_forces);

    free(rest);
    free(memory);
    return status;
}

/* ---- inverse kinematics: q follows the mouse ---- */

static rbd_ik_target target_of(const double *t) {
    rbd_ik_target target = {.kind = (rbd_ik_kind)t[0], .body = (int)t[1], .weight = t[2]};
    memcpy(target.point, t + 3, 3 * sizeof *t);
    memcpy(target.position, t + 6, 3 * sizeof *t);
    memcpy(target.rotation, t + 9, 9 * sizeof *t);
    return target;
}

/* n of `targets` by motions near q: kind, body, weight, point, position, rotation. hold_root: the first joint
   stays. Returns the status of rbd_ik; web_sentence says it in words. */
EXPORT int web_ik(int n, int hold_root) {
    rbd_ik_target list[TARGETS];
    for (int i = 0; i < n; i++) list[i] = target_of(targets + TARGET * i);

    unsigned char *held = allocate((size_t)rbd_nv(m), 1);
    rbd_joint_info root;
    rbd_joint(m, 0, &root);
    for (int k = root.iv; hold_root && k < root.iv + root.nv; k++) held[k] = 1;

    const size_t size = rbd_ik_size(m, n);
    void *memory = allocate(size, 1);
    const rbd_ik_options near = {
        .starts = 1, .evaluations = 100, .metres = 1e-5, .radians = 1e-4, .held = held};
    rbd_ik_result result;
    const rbd_ik_status status = rbd_ik(m, w, list, n, &near, memory, size, q, &result);
    rbd_ik_text(status, &result, sentence, sizeof sentence);
    reached[0] = result.metres;
    reached[1] = result.limit;

    free(memory);
    free(held);
    return status;
}

EXPORT const char *web_sentence(void) { return sentence; }

/* ---- motion ---- */

/* Balls that may touch the floor: for each body, x, y, z, radius. */
EXPORT int web_contacts(const double *balls, int n, double friction, double floor_height) {
    const rbd_contact_options o = {.joint_limits = 1, .joint_friction = 1, .joint_damping = 1};
    rbd_contact *list = allocate((size_t)n, sizeof *list);
    for (int i = 0; i < n; i++, balls += 5)
        list[i] = (rbd_contact){.body1 = (int)balls[0],
                                .body2 = -1,
                                .point = {balls[1], balls[2], balls[3]},
                                .radius = balls[4],
                                .friction = friction,
                                .height = floor_height};
    const size_t size = rbd_contact_set_size(m, n, NULL, 0, &o);
    free(contact_memory);
    contact_memory = allocate(size, 1);
    const rbd_status status =
        rbd_contact_set_init(m, w, list, n, NULL, 0, &o, contact_memory, size, &contacts, NULL);
    ncontacts = status ? 0 : n;
    free(list);
    return status;
}

/* contact_forces, of the last step. Returns how many there are. */
EXPORT int web_contact_forces(void) {
    double *f = contact_forces;
    for (int i = 0; i < ncontacts; i++, f += 4) f[0] = rbd_contact_get(contacts, i, NULL, f + 1);
    return ncontacts;
}

/* Motors of joints with one degree of freedom, which hold `wanted`: an implicit spring. */
static void hold(double dt, double *implicit) {
    for (int i = 0; i < rbd_nb(m); i++) {
        rbd_joint_info info;
        rbd_joint(m, i, &info);
        for (int k = info.iv; k < info.iv + info.nv; k++) tau[k] = 0, implicit[k] = damping[k];
        if (info.nv != 1 || info.nq != 1) continue;
        tau[info.iv] = stiffness[info.iv] * (wanted[info.iq] - q[info.iq]);
        implicit[info.iv] += dt / 2 * stiffness[info.iv]; /* neutral */
    }
}

/* A spring from a point of a body to a place of the world. */
static void pull(int body, const double *point, const double *place, double newton_per_metre) {
    double p[3], velocity[6], force[6] = {0};
    memset(f_ext, 0, 6 * (size_t)rbd_nb(m) * sizeof *f_ext);
    if (body < 0) return;
    rbd_kinematics(m, w, q, v, NULL);
    rbd_point_position(m, w, body, point, p);
    rbd_point_velocity(m, w, body, point, RBD_WORLD_AXES, velocity);
    for (int k = 0; k < 3; k++) force[3 + k] = newton_per_metre * (place[k] - p[k] - 0.1 * velocity[3 + k]);
    rbd_point_wrench(m, w, body, point, RBD_WORLD_AXES, force, f_ext + 6 * body);
}

/* n steps; grip (may be NULL): a body, a point of it, a place, N/m. Ends with the first error. */
EXPORT int web_step(int n, double dt, const double *grip) {
    for (int i = 0; i < n; i++) {
        hold(dt, out);
        pull(grip ? (int)grip[0] : -1, grip ? grip + 1 : NULL, grip ? grip + 4 : NULL, grip ? grip[7] : 0);
        const rbd_status status = rbd_contact_step(m, contacts, q, v, tau, f_ext, out, dt, q, v);
        if (status) return status;
    }
    return 0;
}

EXPORT double web_residual(void) { return rbd_contact_last(contacts).residual; }
EXPORT const char *web_status_text(int status) { return rbd_status_string((rbd_status)status); }

/* ---- cost: the page's clock is coarse, so it times many calls at once ---- */

EXPORT int web_repeat(int call, int n) {
    const int nv = rbd_nv(m);
    int status = 0;
    for (int i = 0; i < n; i++) switch (call) {
        case 0: status |= rbd_rnea(m, w, q, v, gravity, NULL, out); break;
        case 1: status |= rbd_crba(m, w, q, out); break;
        case 2: status |= rbd_aba(m, w, q, v, gravity, NULL, out); break;
        case 3: status |= rbd_minverse(m, w, q, out); break;
        case 4: status |= rbd_id_derivatives(m, d, q, v, gravity, NULL, out, out + nv * nv, NULL); break;
        default: return -1;
        }
    return status;
}

EXPORT void *web_malloc(size_t n) { return allocate(n, 1); }
