/* urdf_fuzz.cpp - libFuzzer's target over the loader: whatever the text, it returns, and what it calls good
   is a model that rbd_model_build takes and whose results are finite. The first byte chooses options. Run by:
   ./run fuzz [SECONDS] */
#ifndef LIBRARIES_ARE_LINKED /* as in the replay */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#define RBD_URDF_IMPLEMENTATION
#endif
#include "rbd_urdf.h"

#include <cmath>
#include <vector>

static void require(bool condition) {
    if (!condition) __builtin_trap();
}

static bool moderate(const rbd_body *bodies, int nb) {
    for (int i = 0; i < nb; i++) {
        const rbd_body &b = bodies[i];
        const double x[] = {b.mass,        b.com[0],      b.com[1],       b.com[2],
                            b.position[0], b.position[1], b.position[2],  b.inertia[0],
                            b.inertia[1],  b.inertia[2],  b.inertia[3],   b.inertia[4],
                            b.inertia[5],  b.mimic_ratio, b.mimic_offset, b.armature[0]};
        for (double value : x)
            if (!(std::fabs(value) < 1e6)) return false;
    }
    return true;
}

/* Poses and inverse dynamics of a state: numbers of a sensible size give finite ones. Dynamics may be refused
   if a joint moves no mass, in a model for kinematics alone. */
static void compute(const rbd_body *bodies, int nb, bool kinematic) {
    std::vector<unsigned char> memory(rbd_model_size(bodies, nb)), scratch;
    const rbd_model *m;
    rbd_work *w;
    uint64_t seed = 1;
    if (kinematic)
        require(rbd_model_build_kinematic(bodies, nb, memory.data(), memory.size(), &m, NULL) == RBD_OK);
    else
        require(rbd_model_build(bodies, nb, memory.data(), memory.size(), &m, NULL) == RBD_OK);
    scratch.resize(rbd_work_size(m));
    require(rbd_work_init(m, scratch.data(), scratch.size(), &w) == RBD_OK);
    const size_t nv = (size_t)rbd_nv(m);
    std::vector<double> q((size_t)rbd_nq(m) + 1), v(nv + 1, 1), tau(nv + 1);
    rbd_random(m, &seed, q.data());
    require(rbd_kinematics(m, w, q.data(), NULL, NULL) == RBD_OK);
    double p[3];
    require(rbd_body_pose(m, w, nb - 1, NULL, p) == RBD_OK);
    const int massless = rbd_singular_dof(w);
    require(massless < 0 || kinematic);
    require(rbd_rnea(m, w, q.data(), v.data(), v.data(), NULL, tau.data()) ==
            (massless < 0 ? RBD_OK : RBD_ERR_MASSLESS));
    if (!moderate(bodies, nb)) return;
    for (size_t i = 0; i < 3; i++) require(std::isfinite(p[i]));
    for (size_t i = 0; massless < 0 && i < nv; i++) require(std::isfinite(tau[i]));
}

/* What a text gave; strings lie in names. */
struct loaded {
    std::vector<rbd_body> bodies;
    std::vector<rbd_urdf_frame> frames;
    std::vector<char> names;
};

/* Returns whether the text is good. */
static bool load(const char *text, size_t length, const rbd_urdf_options &options, loaded &to) {
    rbd_urdf robot = {};
    const rbd_urdf_status counted = rbd_urdf_parse(text, length, &options, &robot);
    require((counted == RBD_URDF_OK) == (robot.error.text[0] == 0));
    require(counted != RBD_URDF_ERR_PARSER); /* what urdfdom refuses, our checks must have refused before */
    if (counted != RBD_URDF_OK) return false;
    to.bodies.resize((size_t)robot.nb);
    to.frames.resize((size_t)robot.nframes);
    to.names.resize(robot.names_size);
    robot.bodies = to.bodies.data(), robot.bodies_max = robot.nb;
    robot.frames = to.frames.data(), robot.frames_max = robot.nframes;
    robot.names = to.names.data(), robot.names_max = robot.names_size;
    require(rbd_urdf_parse(text, length, &options, &robot) == RBD_URDF_OK);
    compute(robot.bodies, robot.nb, options.kinematic != 0);
    return true;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (size == 0) return 0;
    rbd_urdf_options options = {};
    options.root = data[0] & 1 ? RBD_FLOATING : RBD_FIXED;
    options.keep_all = data[0] >> 1 & 1;
    options.lock_massless = (data[0] >> 2 & 3) == 1;
    options.kinematic = (data[0] >> 2 & 3) == 3;
    options.free_mimics = !(data[0] >> 4 & 1); /* digits have this bit */
    options.strict = (data[0] >> 3 & 7) == 7;
    const char *text = (const char *)data + 1;
    loaded whole, part;
    if (!load(text, size - 1, options, whole)) return 0;
    /* once more, of what is in the middle: the part on a link, and with a joint held still */
    const rbd_body &b = whole.bodies[whole.bodies.size() / 2];
    const rbd_urdf_lock lock[] = {{b.joint, data[0] & 0x40 ? 0.5 : 0}, {NULL, 0}};
    options.lock = lock;
    load(text, size - 1, options, part);
    options.lock = NULL;
    options.root_link = whole.frames[whole.frames.size() / 2].link;
    load(text, size - 1, options, part);
    return 0;
}
