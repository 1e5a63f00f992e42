// mujoco.cpp - MuJoCo (https://mujoco.org) beside rbd: its model is compiled from MJCF text that mjcf.hpp
// writes from the description; contacts, limits, damping and all other forces are absent or off. What is
// timed stands in `conventions` below. SPDX-License-Identifier: MIT
#include <cstring>
#include <new>
#include "mjcf.hpp"
#include "world_base.hpp"

namespace {

struct model {
    tree t;
    mjModel *m = nullptr;
    std::vector<int> qpos, dof; // MuJoCo's places of each body's joint, -1 = fixed
    std::vector<int> place;     // MuJoCo's place of each degree of freedom of rbd
    double armature[256] = {};  // in MuJoCo's order
    int last = 0;               // its number of the last body
};

std::string mjcf(const tree &t) {
    return "<mujoco>" MJCF_COMPILER "<option><flag constraint=\"disable\"/></option><worldbody>" +
           mjcf_children(t.bodies, -1, [](int) { return std::string(); }) + "</worldbody></mujoco>";
}

// Differences between versions, whose number is 222 for 2.2.2 and 3010000 for 3.10.0:
// the function that computes the mass matrix that mj_factorM reads,
#if mjVERSION_HEADER < 333
#define MASS_MATRIX "mj_crb"
void mass_matrix(const mjModel *m, mjData *d) { mj_crb(m, d); }
#else
#define MASS_MATRIX "mj_makeM"
void mass_matrix(const mjModel *m, mjData *d) { mj_makeM(m, d); }
#endif

// how it is unpacked,
#if mjVERSION_HEADER < 3010000
void unpack(const mjModel *m, const mjData *d, double *M) { mj_fullM(m, M, d->qM); }
#else
void unpack(const mjModel *m, const mjData *d, double *M) { mj_fullM(m, d, M); }
#endif

// the matrix of angular momentum.
#if mjVERSION_HEADER < 313
#define ANGULAR_MOMENTUM 0
void angular_momentum(const mjModel *, mjData *, double *) {}
#else
#define ANGULAR_MOMENTUM 1
void angular_momentum(const mjModel *m, mjData *d, double *A) { mj_angmomMat(m, d, A, 0); }
#endif

// ---- model and work ----

void find_places(model *p) {
    for (size_t i = 0; i < p->t.bodies.size(); i++) {
        const int j = p->t.iv[i] < 0 ? -1 : mj_name2id(p->m, mjOBJ_JOINT, ("j" + std::to_string(i)).c_str());
        p->qpos.push_back(j < 0 ? -1 : p->m->jnt_qposadr[j]);
        p->dof.push_back(j < 0 ? -1 : p->m->jnt_dofadr[j]);
        const int n = j < 0 ? 0 : p->t.bodies[i].type == RBD_FLOATING ? 6 : 1;
        for (int k = 0; k < n; k++) p->place.push_back(p->dof[i] + k);
    }
    for (int i = 0; i < p->m->nv; i++) p->armature[i] = p->m->dof_armature[i];
    p->last = mj_name2id(p->m, mjOBJ_BODY, ("b" + std::to_string(p->t.bodies.size() - 1)).c_str());
}

rbd_status model_build(const rbd_body *bodies, int nb, void *memory, size_t, const void **out, char *text) {
    model *p = new (memory) model;
    *out = p;
    if (mj_version() != mjVERSION_HEADER) {
        std::snprintf(text, 160, "its header is of version %d, the library %d", mjVERSION_HEADER,
                      mj_version());
        return RBD_ERR_TYPE;
    }
    if (!read_tree(bodies, nb, &p->t, text) || p->t.nv > 256) return RBD_ERR_TYPE;
    p->m = mjcf_compile(mjcf(p->t), text);
    if (!p->m) return RBD_ERR_MEMORY;
    find_places(p);
    return RBD_OK;
}

size_t model_size(const rbd_body *, int) { return sizeof(model); }

void model_free(const void *out) {
    model *p = static_cast<model *>(const_cast<void *>(out));
    if (p->m) mj_deleteModel(p->m);
    p->~model();
}

struct work {
    mjModel *m;
    mjData *d;
};

rbd_status work_init(const void *p, void *memory, size_t, void **out) {
    work *w = new (memory) work;
    w->m = static_cast<const model *>(p)->m;
    w->d = mj_makeData(w->m);
    *out = w;
    return w->d ? RBD_OK : RBD_ERR_MEMORY;
}

size_t work_size(const void *) { return sizeof(work); }
void work_free(void *w) { mj_deleteData(static_cast<work *>(w)->d); }

rbd_status set_gravity(void *w, const double gravity[3]) {
    mju_copy3(static_cast<work *>(w)->m->opt.gravity, gravity);
    return RBD_OK;
}

// ---- the calls that are timed; MuJoCo computes in mjData, so that states are copied into it ----

void take(const model *p, const work *w, const void *q, const void *v) {
    std::memcpy(w->d->qpos, q, (size_t)p->m->nq * sizeof(double));
    std::memcpy(w->d->qvel, v, (size_t)p->m->nv * sizeof(double));
}

rbd_status call_id(const void *model_, void *work_, int, const void *q, const void *v, const void *a,
                   void *tau) {
    const model *p = static_cast<const model *>(model_);
    const work *w = static_cast<const work *>(work_);
    const double *acceleration = static_cast<const double *>(a);
    double *out = static_cast<double *>(tau);
    take(p, w, q, v);
    std::memcpy(w->d->qacc, a, (size_t)p->m->nv * sizeof(double));
    mj_kinematics(p->m, w->d);
    mj_comPos(p->m, w->d);
    mj_comVel(p->m, w->d);
    mj_rne(p->m, w->d, 1, out);
    for (int i = 0; i < p->m->nv; i++) // mj_rne leaves it out
        out[i] += p->armature[i] * acceleration[i];
    return RBD_OK;
}

rbd_status call_mm(const void *model_, void *work_, int, const void *q, const void *, const void *, void *M) {
    const model *p = static_cast<const model *>(model_);
    const work *w = static_cast<const work *>(work_);
    std::memcpy(w->d->qpos, q, (size_t)p->m->nq * sizeof(double));
    mj_kinematics(p->m, w->d);
    mj_comPos(p->m, w->d);
    mass_matrix(p->m, w->d);
    unpack(p->m, w->d, static_cast<double *>(M));
    return RBD_OK;
}

rbd_status call_fd(const void *model_, void *work_, int, const void *q, const void *v, const void *tau,
                   void *a) {
    const model *p = static_cast<const model *>(model_);
    const work *w = static_cast<const work *>(work_);
    const double *force = static_cast<const double *>(tau);
    double *rest = w->d->qfrc_smooth, *out = static_cast<double *>(a);
    take(p, w, q, v);
    mj_kinematics(p->m, w->d);
    mj_comPos(p->m, w->d);
    mass_matrix(p->m, w->d);
    mj_factorM(p->m, w->d);
    mj_comVel(p->m, w->d);
    mj_rne(p->m, w->d, 0, w->d->qfrc_bias);
    for (int i = 0; i < p->m->nv; i++) rest[i] = force[i] - w->d->qfrc_bias[i];
    mj_solveM(p->m, w->d, out, rest, 1);
    return RBD_OK;
}

// M^-1 as its user gets it: the columns of the unit matrix, solved with the factor of M.
rbd_status call_minv(const void *model_, void *work_, int, const void *q, const void *, const void *,
                     void *inverse) {
    const model *p = static_cast<const model *>(model_);
    const work *w = static_cast<const work *>(work_);
    double *X = static_cast<double *>(inverse);
    std::memset(X, 0, (size_t)(p->m->nv * p->m->nv) * sizeof(double));
    for (int i = 0; i < p->m->nv; i++) X[i * p->m->nv + i] = 1;
    std::memcpy(w->d->qpos, q, (size_t)p->m->nq * sizeof(double));
    mj_kinematics(p->m, w->d);
    mj_comPos(p->m, w->d);
    mass_matrix(p->m, w->d);
    mj_factorM(p->m, w->d);
    mj_solveM(p->m, w->d, X, X, p->m->nv);
    return RBD_OK;
}

// The last body's, world axes, at its origin; angular rows first.
rbd_status call_jacobian(const void *model_, void *work_, int, const void *q, const void *, const void *,
                         void *J_) {
    const model *p = static_cast<const model *>(model_);
    const work *w = static_cast<const work *>(work_);
    double *J = static_cast<double *>(J_);
    std::memcpy(w->d->qpos, q, (size_t)p->m->nq * sizeof(double));
    mj_kinematics(p->m, w->d);
    mj_comPos(p->m, w->d);
    mj_jacBody(p->m, w->d, J + 3 * p->m->nv, J, p->last);
    return RBD_OK;
}

// About the centre of mass, world axes; angular rows first.
rbd_status call_momentum_matrix(const void *model_, void *work_, int, const void *q, const void *,
                                const void *, void *A_) {
    const model *p = static_cast<const model *>(model_);
    const work *w = static_cast<const work *>(work_);
    double *A = static_cast<double *>(A_), *linear = A + 3 * p->m->nv;
    std::memcpy(w->d->qpos, q, (size_t)p->m->nq * sizeof(double));
    mj_kinematics(p->m, w->d);
    mj_comPos(p->m, w->d);
    angular_momentum(p->m, w->d, A);
    mj_jacSubtreeCom(p->m, w->d, linear, 0);
    mju_scl(linear, linear, p->m->body_subtreemass[0], 3 * p->m->nv);
    return RBD_OK;
}

// Its momentum is that of all bodies, rbd's of those that a joint moves.
int can(const void *model_, int algorithm) {
    const mjModel *m = static_cast<const model *>(model_)->m;
    if (algorithm != MOMENTUM_MATRIX) return 1;
    double fixed = 0; // mass that no joint moves
    for (int i = 0; i < m->nbody; i++)
        if (m->body_weldid[i] == 0) fixed += m->body_mass[i];
    return ANGULAR_MOMENTUM && fixed == 0;
}

// ---- conventions: docs/other_libraries.md ----

void size(const void *p, int *nq, int *nv) {
    *nq = static_cast<const model *>(p)->m->nq;
    *nv = static_cast<const model *>(p)->m->nv;
}

void convert_base(const model *p, const struct state *rbd, const struct state *its) {
    double *q = its->q + p->qpos[0];
    const double *x = rbd->q;
    world_base(rbd, its->v + p->dof[0], its->a + p->dof[0], its->tau + p->dof[0]);
    put(q, get(x));
    q[3] = x[6], q[4] = x[3], q[5] = x[4], q[6] = x[5];
}

void convert_state(const void *model_, const struct state *rbd, const struct state *its) {
    const model *p = static_cast<const model *>(model_);
    if (p->t.floating) convert_base(p, rbd, its);
    for (size_t i = p->t.floating ? 1 : 0; i < p->t.bodies.size(); i++) {
        if (p->t.iv[i] < 0) continue;
        its->q[p->qpos[i]] = rbd->q[p->t.iq[i]];
        its->v[p->dof[i]] = rbd->v[p->t.iv[i]];
        its->a[p->dof[i]] = rbd->a[p->t.iv[i]];
        its->tau[p->dof[i]] = rbd->tau[p->t.iv[i]];
    }
}

void convert_result(const void *model_, int algorithm, const struct state *rbd, const double *its,
                    double *x) {
    const model *p = static_cast<const model *>(model_);
    const world_order order(p->place, p->t.floating, rbd->q);
    if (algorithm == MM || algorithm == MINV) // turning the base's axes is orthogonal: M^-1 turns as M
        order.matrix(its, x);
    else
        order.columns(its, algorithm == JACOBIAN || algorithm == MOMENTUM_MATRIX ? 6 : 1, x);
    if (algorithm == FD && p->t.floating) put(x + 3, get(x + 3) - turned(rbd->v));
}

conventions make_conventions() {
    conventions c = {};
    c.size = size;
    c.state = convert_state;
    c.result = convert_result;
    c.bound = 1e-10;
    c.build = PEER_BUILD;
    c.calls[ID] = "mj_kinematics, mj_comPos, mj_comVel, mj_rne, armature added";
    c.calls[MM] = "mj_kinematics, mj_comPos, " MASS_MATRIX ", mj_fullM";
    c.calls[FD] = "mj_kinematics, mj_comPos, " MASS_MATRIX
                  ", mj_factorM, mj_comVel, mj_rne, mj_solveM (sparse L'DL, no ABA)";
    c.calls[MINV] = "mj_kinematics, mj_comPos, " MASS_MATRIX ", mj_factorM, mj_solveM of the unit matrix";
    c.calls[JACOBIAN] = "mj_kinematics, mj_comPos, mj_jacBody";
    c.calls[MOMENTUM_MATRIX] = "mj_kinematics, mj_comPos, mj_angmomMat, mj_jacSubtreeCom times the mass";
    return c;
}

const conventions others = make_conventions();

library make_library() {
    library l = plain_library("MuJoCo", PEER_VERSION);
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
    l.call[JACOBIAN] = call_jacobian;
    l.call[MOMENTUM_MATRIX] = call_momentum_matrix;
    l.can = can;
    l.conventions = &others;
    return l;
}

} // namespace

extern "C" {
PEER extern const struct library library_mujoco;
const struct library library_mujoco = make_library();
}
