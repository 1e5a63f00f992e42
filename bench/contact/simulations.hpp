// simulations.hpp - a scene in rbd and in MuJoCo, step by step. SPDX-License-Identifier: MIT
#ifndef CONTACT_SIMULATIONS_HPP
#define CONTACT_SIMULATIONS_HPP

#include <memory>
#include <sys/wait.h>
#include <unistd.h>
#include "../peers/mjcf.hpp"
#include "scenes.hpp"

#ifndef MASS_FACTOR // the test of this program makes MuJoCo's bodies heavier
#define MASS_FACTOR 1.0
#endif

class simulation {
  public:
    virtual ~simulation() = default;
    virtual void begin(const double *q, const double *v) = 0; // forgets what was before
    virtual void apply(const double *tau) = 0;                // of joints, for the next step
    virtual void step() = 0;                                  // what is timed and counted
    virtual void state(double *q, double *v) const = 0;       // as rbd has it
    virtual double ground_force() const = 0;                  // of the last step, along the normal, N
    // The same in the acceleration of the last step, but in no contact: what a solver left of its equations.
    virtual double unsolved() const { return 0; }
    virtual int iterations() const = 0; // Newton steps, or sweeps of PGS, of the last step
};

// Which law is solved, and how far. A solver of MuJoCo's is -1 for rbd.
struct setting {
    const char *name;
    int solver, cone, iterations;
    double tolerance; // rbd: m/s; MuJoCo: relative
    double ratio;     // impratio: stiffness of friction to that of the normal
    bool stiff;       // time constant of two steps, impedance as near to 1 as MuJoCo allows
    int noslip;       // further sweeps that take slip back
};

const setting settings[] = {
    {"rbd, 1e-8 m/s", -1, 0, 0, 1e-8, 0, false, 0},
    {"rbd, 1e-5 m/s", -1, 0, 0, 1e-5, 0, false, 0},
    {"Newton, pyramid", mjSOL_NEWTON, mjCONE_PYRAMIDAL, 100, 1e-8, 1, false, 0}, // the defaults
    {"Newton, pyramid, 1e-4", mjSOL_NEWTON, mjCONE_PYRAMIDAL, 100, 1e-4, 1, false, 0},
    {"Newton, cone", mjSOL_NEWTON, mjCONE_ELLIPTIC, 100, 1e-8, 1, false, 0},
    {"Newton, cone, 1e-4", mjSOL_NEWTON, mjCONE_ELLIPTIC, 100, 1e-4, 1, false, 0},
    {"CG, pyramid", mjSOL_CG, mjCONE_PYRAMIDAL, 100, 1e-8, 1, false, 0},
    {"stiff, cone", mjSOL_NEWTON, mjCONE_ELLIPTIC, 100, 1e-12, 1, true, 0},
    {"stiff, cone, impratio 100", mjSOL_NEWTON, mjCONE_ELLIPTIC, 100, 1e-12, 100, true, 0},
    {"stiff, cone, noslip", mjSOL_NEWTON, mjCONE_ELLIPTIC, 100, 1e-12, 1, true, 100},
};

inline bool is_rbd(const setting &o) { return o.solver < 0; }

// ---- rbd ----

class rbd_simulation : public simulation {
    robot r;
    std::vector<unsigned char> memory;
    rbd_contact_set *c = nullptr;
    std::vector<rbd_contact> contacts;
    vector q, v, tau, damping;
    double h;

  public:
    rbd_simulation(const scene &s, const setting &o, double step, bool first_order)
        : r(s.bodies), contacts(s.contacts), q((size_t)r.nq), v((size_t)r.nv), tau((size_t)r.nv),
          damping((size_t)r.nv), h(step) {
        rbd_contact_options options = {};
        const int n = (int)contacts.size();
        options.tolerance = o.tolerance;
        options.first_order = first_order;
        memory.resize(rbd_contact_set_size(r.m, n, nullptr, 0, &options));
        must(rbd_contact_set_init(r.m, r.w, contacts.data(), n, nullptr, 0, &options, memory.data(),
                                  memory.size(), &c, nullptr),
             "contacts");
        r.set_slope(s.slope);
        for (const rbd_joint_info &j : r.joints)
            if (j.nv == 1) damping[(size_t)j.iv] = s.kd + h * s.kp;
    }
    void begin(const double *start, const double *velocity) override {
        std::copy(start, start + r.nq, q.begin()), std::copy(velocity, velocity + r.nv, v.begin());
        rbd_contact_reset(c);
    }
    void apply(const double *torque) override { std::copy(torque, torque + r.nv, tau.begin()); }
    void step() override {
        must(rbd_contact_step(r.m, c, q.data(), v.data(), tau.data(), nullptr, damping.data(), h, q.data(),
                              v.data()),
             "step");
    }
    void state(double *position, double *velocity) const override {
        std::copy(q.begin(), q.end(), position), std::copy(v.begin(), v.end(), velocity);
    }
    double ground_force() const override {
        double sum = 0, force[3];
        for (size_t i = 0; i < contacts.size(); i++)
            if (contacts[i].body2 < 0) rbd_contact_get(c, (int)i, nullptr, force), sum += force[2];
        return sum;
    }
    int iterations() const override { return rbd_contact_last(c).newton_steps; }
};

// ---- MuJoCo ----

// A contact's ball meets the surface of one body only: that is what the bits are for. The surface of a box
// is a box, whose upper face the balls meet; rbd has the plane of that face.
inline std::string mjcf_geoms(const scene &s, int body) {
    std::string text;
    bool carries = false;
    for (const rbd_contact &c : s.contacts) {
        carries = carries || c.body2 == body;
        if (c.body1 != body) continue;
        text += "<geom type=\"sphere\"" + mjcf_attribute("size", &c.radius, 1) +
                mjcf_attribute("pos", c.point, 3) + mjcf_attribute("friction", &c.friction, 1) +
                " contype=\"" + std::to_string(1 << (c.body2 + 1)) + "\" conaffinity=\"0\"/>";
    }
    if (carries)
        text += "<geom type=\"box\" size=\"0.1 0.1 0.1\" friction=\"0\" contype=\"0\" conaffinity=\"" +
                std::to_string(1 << (body + 1)) + "\"/>";
    return text;
}

// Its contacts do not know of its implicit damping, so the controller's stands in armature and torque: M +
// h d instead of M, and tau - d v, are the same equations.
inline std::string mjcf_scene(const scene &s, const setting &o, double h) {
    const double gravity[3] = {g * std::sin(s.slope), 0, -g * std::cos(s.slope)}, stiff[2] = {2 * h, 1};
    std::vector<rbd_body> bodies = s.bodies;
    for (rbd_body &b : bodies) {
        b.mass *= MASS_FACTOR;
        if (has_one_axis(b)) b.armature[0] += h * (s.kd + h * s.kp);
    }
    return "<mujoco>" MJCF_COMPILER "<option" + mjcf_attribute("timestep", &h, 1) +
           mjcf_attribute("gravity", gravity, 3) + mjcf_attribute("tolerance", &o.tolerance, 1) +
           mjcf_attribute("impratio", &o.ratio, 1) + "/><default><geom condim=\"3\"" +
           (o.stiff ? mjcf_attribute("solref", stiff, 2) + " solimp=\"0.9999 0.9999 0.001\"" : "") +
           "/></default><worldbody><geom type=\"plane\" size=\"100 100 1\" friction=\"0\" contype=\"0\" "
           "conaffinity=\"1\"/>" +
           mjcf_children(bodies, -1, [&](int body) { return mjcf_geoms(s, body); }) + "</worldbody></mujoco>";
}

// The state in its conventions, wherever it computes.
class mujoco_state : public simulation {
  protected:
    robot r;
    std::vector<int> qpos, dof; // its places of each body's joint, -1: fixed
    double damping;
    double *positions = nullptr, *velocities = nullptr, *applied = nullptr;

    mujoco_state(const scene &s, double h) : r(s.bodies), damping(s.kd + h * s.kp) {}

    // Degrees of freedom that lift all that a floating base carries.
    std::vector<int> vertical() const {
        std::vector<int> found;
        for (size_t i = 0; i < dof.size(); i++)
            if (r.joints[i].nv == 6) found.push_back(dof[i] + 2);
        return found;
    }

  public:
    void begin(const double *q, const double *v) override {
        for (size_t i = 0; i < qpos.size(); i++) {
            const rbd_joint_info &j = r.joints[i];
            const double *own = q + j.iq, *rate = v + j.iv;
            double *position = positions + qpos[i], *velocity = velocities + dof[i];
            if (j.nv == 1) *position = *own, *velocity = *rate;
            if (j.nv != 6) continue;
            put(position, get(own)), put(position + 4, get(own + 3)), position[3] = own[6];
            put(velocity, rotation_of(own + 3) * get(rate + 3)), put(velocity + 3, get(rate));
        }
    }
    void apply(const double *tau) override {
        for (size_t i = 0; i < qpos.size(); i++)
            if (r.joints[i].nv == 1) applied[dof[i]] = tau[r.joints[i].iv] - damping * velocities[dof[i]];
    }
    void state(double *q, double *v) const override {
        for (size_t i = 0; i < qpos.size(); i++) {
            const rbd_joint_info &j = r.joints[i];
            const double *position = positions + qpos[i], *velocity = velocities + dof[i];
            double *own = q + j.iq, *rate = v + j.iv;
            if (j.nv == 1) *own = *position, *rate = *velocity;
            if (j.nv != 6) continue;
            put(own, get(position)), put(own + 3, get(position + 4)), own[6] = position[3];
            put(rate, get(velocity + 3)), put(rate + 3, transpose(rotation_of(own + 3)) * get(velocity));
        }
    }
};

class mujoco_simulation : public mujoco_state {
    std::unique_ptr<mjModel, void (*)(mjModel *)> m{nullptr, mj_deleteModel};
    std::unique_ptr<mjData, void (*)(mjData *)> d{nullptr, mj_deleteData};

  public:
    mujoco_simulation(const scene &s, const setting &o, double h) : mujoco_state(s, h) {
        char text[160] = "";
        m.reset(mjcf_compile(mjcf_scene(s, o, h), text));
        if (!m) {
            std::fprintf(stderr, "contact: MuJoCo refuses '%s': %s\n", s.name.c_str(), text);
            std::exit(1);
        }
        m->opt.solver = o.solver, m->opt.cone = o.cone, m->opt.iterations = o.iterations;
        m->opt.noslip_iterations = o.noslip, m->opt.noslip_tolerance = o.tolerance;
        // Switches off features that no scene has. Contacts and the checks of mj_step stay.
        m->opt.disableflags |=
            mjDSBL_EQUALITY | mjDSBL_FRICTIONLOSS | mjDSBL_LIMIT | mjDSBL_ACTUATION | mjDSBL_SENSOR;
        d.reset(mj_makeData(m.get()));
        positions = d->qpos, velocities = d->qvel, applied = d->qfrc_applied;
        for (size_t i = 0; i < s.bodies.size(); i++) {
            const int j = mj_name2id(m.get(), mjOBJ_JOINT, ("j" + std::to_string(i)).c_str());
            qpos.push_back(j < 0 ? -1 : m->jnt_qposadr[j]), dof.push_back(j < 0 ? -1 : m->jnt_dofadr[j]);
        }
    }
    void begin(const double *q, const double *v) override {
        mj_resetData(m.get(), d.get());
        mujoco_state::begin(q, v);
    }
    void step() override { mj_step(m.get(), d.get()); }
    double ground_force() const override {
        double sum = 0, force[6];
        for (int i = 0; i < d->ncon; i++) {
            if (m->geom_bodyid[d->contact[i].geom1] && m->geom_bodyid[d->contact[i].geom2]) continue;
            mj_contactForce(m.get(), d.get(), i, force);
            sum += force[0];
        }
        return sum;
    }
    double unsolved() const override {
        vector inertia((size_t)m->nv); // times the acceleration
        double sum = 0;
        mj_mulM(m.get(), d.get(), inertia.data(), d->qacc);
        for (const int z : vertical()) sum += inertia[(size_t)z] - d->qfrc_smooth[z] - d->qfrc_constraint[z];
        return sum;
    }
#if mjVERSION_HEADER < 300
    int iterations() const override { return d->solver_iter; }
#else
    int iterations() const override { return d->solver_niter[0]; }
#endif
};

// ---- MuJoCo in another process: mujoco.mjs has its messages ----

class pipes {
    FILE *to = nullptr, *from = nullptr;
    pid_t child = -1;

    [[noreturn]] static void fail(const char *what) {
        std::fprintf(stderr, "contact: the other process: %s\n", what);
        std::exit(1);
    }

  public:
    std::string version;

    explicit pipes(const char *command) {
        int in[2], out[2];
        char text[64];
        if (pipe(in) != 0 || pipe(out) != 0) fail("no pipe");
        child = fork();
        if (child < 0) fail("cannot be started");
        if (child == 0) {
            dup2(in[0], 0), dup2(out[1], 1);
            for (int end : {in[0], in[1], out[0], out[1]}) close(end);
            execl("/bin/sh", "sh", "-c", command, nullptr);
            _exit(127);
        }
        close(in[0]), close(out[1]);
        to = fdopen(in[1], "w"), from = fdopen(out[0], "r");
        if (std::fscanf(from, "%63[^\n]", text) != 1 || std::fgetc(from) != '\n') fail("does not begin");
        version = text;
    }
    pipes(const pipes &) = delete;
    pipes &operator=(const pipes &) = delete;
    ~pipes() {
        fclose(to), fclose(from);
        waitpid(child, nullptr, 0);
    }
    void write(const std::string &text) { std::fwrite(text.data(), 1, text.size(), to); }
    void write(const vector &x) { std::fwrite(x.data(), sizeof(double), x.size(), to); }
    void read(vector *x) {
        std::fflush(to);
        if (std::fread(x->data(), sizeof(double), x->size(), from) != x->size()) fail("does not answer");
    }
};

// There is one model at a time, the last one that was made.
class remote_mujoco : public mujoco_state {
    pipes &other;
    vector q, v, tau, rest, last{0, 0}; // rest: unsolved; last: force of the ground, iterations

  public:
    remote_mujoco(pipes &p, const scene &s, const setting &o, double h) : mujoco_state(s, h), other(p) {
        const std::string text = mjcf_scene(s, o, h);
        vector numbers = {(double)text.size(),  (double)s.bodies.size(), (double)o.solver, (double)o.cone,
                          (double)o.iterations, (double)o.noslip,        o.tolerance};
        other.write("m"), other.write(numbers), other.write(text);

        vector places(2 + 2 * s.bodies.size());
        other.read(&places);
        q.resize((size_t)places[0]), v.resize((size_t)places[1]), tau.resize(v.size()), rest.resize(v.size());
        for (size_t i = 2; i < places.size(); i += 2)
            qpos.push_back((int)places[i]), dof.push_back((int)places[i + 1]);
        positions = q.data(), velocities = v.data(), applied = tau.data();
    }
    void begin(const double *start, const double *velocity) override {
        mujoco_state::begin(start, velocity);
        other.write("b"), other.write(q), other.write(v);
    }
    void step() override {
        other.write("s"), other.write(tau);
        other.read(&q), other.read(&v), other.read(&rest), other.read(&last);
    }
    double ground_force() const override { return last[0]; }
    double unsolved() const override {
        double sum = 0;
        for (const int z : vertical()) sum += rest[(size_t)z];
        return sum;
    }
    int iterations() const override { return (int)last[1]; }
};

// The process that stands in MuJoCo's place, or nullptr.
inline std::unique_ptr<pipes> &other_process() {
    static std::unique_ptr<pipes> process;
    return process;
}

// first_order: rbd's step is semi-implicit Euler, as MuJoCo's is.
inline std::unique_ptr<simulation> simulate(const scene &s, const setting &o, double h,
                                            bool first_order = false) {
    if (is_rbd(o)) return std::make_unique<rbd_simulation>(s, o, h, first_order);
    if (other_process()) return std::make_unique<remote_mujoco>(*other_process(), s, o, h);
    return std::make_unique<mujoco_simulation>(s, o, h);
}

#endif
