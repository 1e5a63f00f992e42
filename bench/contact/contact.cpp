// contact.cpp - a step with contacts in rbd and in MuJoCo: verifies that both simulate the same, then
// times, counts and judges them. usage:
//     contact [--verify | --count | --rounds N | --results-of COMMAND]
// prints CSV; --count is for callgrind; --results-of has no times: COMMAND simulates, as mujoco.mjs does.
// SPDX-License-Identifier: MIT
#include <cstring>
#include <ctime>
#include <functional>
#include "../../tests/larger.h"
#include "../timing/least.h"
#include "simulations.hpp"
#ifdef CONTACT_VALGRIND
#include <valgrind/callgrind.h>
#endif

namespace {

const double step_sizes[] = {0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3}, usual_step = 1e-3;

int steps_in(double seconds, double h) { return (int)(seconds / h + 0.5); }

// Takes the simulation through some time; `watch` is called with the number of each step, after which q
// and v are the state, and does the step itself.
void run(const scene &s, const robot &r, simulation *x, double h, double seconds,
         const std::function<void(int, const vector &q, const vector &v)> &watch) {
    vector q = s.q, v = s.v, tau(v.size());
    x->begin(q.data(), v.data());
    for (int i = 0; i < steps_in(seconds, h); i++) {
        if (s.kp > 0) {
            control(s, r, i * h, q.data(), tau.data());
            x->apply(tau.data());
        }
        watch(i, q, v);
        x->state(q.data(), v.data());
    }
    watch(-1, q, v);
}

// ---- how good it is ----

struct outcome {
    double deepest = 0;      // penetration, m
    double creep = 0;        // speed downhill, mean of the second half, m/s
    double acceleration = 0; // downhill, the same mean, m/s^2
    double hover = 0;        // mean gap at the end, m
    double made = 0;         // energy: sum of the gains of all steps with contact, J
    double iterations = 0;   // a step
    // Force of the ground less weight and rate of momentum, over the weight, the same mean.
    double balance = 0;
    double unsolved = 0; // of that what the solver left of its equations
};

// The centre of mass, and what the ground has pushed since a time.
struct instant {
    double p[3], v[3], pushed, unsolved;
};

double gap_of(const robot &r, const rbd_contact &c) {
    double p[3], R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, o[3] = {0, 0, 0};
    must(rbd_point_position(r.m, r.w, c.body1, c.point, p), "point");
    if (c.body2 >= 0) must(rbd_body_pose(r.m, r.w, c.body2, R, o), "pose");
    return R[2] * (p[0] - o[0]) + R[5] * (p[1] - o[1]) + R[8] * (p[2] - o[2]) - c.height - c.radius;
}

outcome judge(const scene &s, const setting &o, double h) {
    robot r(s.bodies);
    const auto x = simulate(s, o, h);
    const int all = steps_in(s.seconds, h), half = all / 2;
    double energy = 0;
    bool touched = false;
    instant now = {}, then = {};
    outcome out;
    r.set_slope(s.slope);
    run(s, r, x.get(), h, s.seconds, [&](int i, const vector &q, const vector &v) {
        double kinetic, potential, sum = 0;
        bool touches = false;
        r.look(q.data(), v.data());
        must(rbd_energy(r.m, r.w, &kinetic, &potential), "energy");
        must(rbd_com(r.m, r.w, now.p, now.v, nullptr), "com");
        for (const rbd_contact &c : s.contacts) {
            const double gap = gap_of(r, c);
            out.deepest = larger(out.deepest, -gap), sum += gap;
            touches = touches || gap < 1e-3;
        }
        out.hover = sum / (double)s.contacts.size();
        if (touched && s.kp == 0) out.made += std::max(kinetic + potential - energy, 0.0);
        energy = kinetic + potential, touched = touches;
        if (i == half) then = now;
        if (i < 0) return;
        x->step();
        now.pushed += h * x->ground_force();
        now.unsolved -= h * x->unsolved();
        out.iterations += x->iterations() / (double)all;
    });
    const double time = (all - half) * h, mass = rbd_mass(r.m), weight = mass * g * std::cos(s.slope);
    out.creep = (now.p[0] - then.p[0]) / time;
    out.acceleration = (now.v[0] - then.v[0]) / time;
    out.balance = ((now.pushed - then.pushed - mass * (now.v[2] - then.v[2])) / time - weight) / weight;
    out.unsolved = (now.unsolved - then.unsolved) / time / weight;
    return out;
}

double exact_acceleration(const scene &s) {
    return std::max(g * (std::sin(s.slope) - 0.5 * std::cos(s.slope)), 0.0);
}

// ---- whether both simulate the same ----

// Far above the ground, all joints moving: the largest difference of the states after 50 steps of first
// order.
double flight_difference(scene s, const setting &o) {
    robot r(s.bodies);
    vector end[2];
    for (const rbd_joint_info &j : r.joints)
        if (j.nv == 6) s.q[(size_t)j.iq + 2] += 10 + 10 * j.iv;
    for (size_t k = 0; k < s.v.size(); k++) s.v[k] = std::sin(3.0 * (double)k + 1);
    for (int k = 0; k < 2; k++) {
        const auto x = simulate(s, k ? o : settings[0], usual_step, true);
        run(s, r, x.get(), usual_step, 50 * usual_step, [&](int i, const vector &q, const vector &v) {
            if (i >= 0) return x->step();
            end[k] = q;
            end[k].insert(end[k].end(), v.begin(), v.end());
        });
    }
    double worst = 0;
    for (size_t k = 0; k < end[0].size(); k++) {
        worst = larger(worst, std::fabs(end[0][k] - end[1][k]));
    }
    return worst;
}

bool holds(const scene &s, const setting &o, const char *what, double error, double bound) {
    if (std::fabs(error) <= bound) return true;
    std::fprintf(stderr, "contact: %s, %s: %s: %.2e, more than %.0e\n", s.name.c_str(), o.name, what, error,
                 bound);
    return false;
}

// The impulse of the ground is that of weight and momentum, whatever the law of contact; up to what moving
// the robot for a step changes of the momentum, and to what a solver that gives up early left.
bool verify(const std::vector<scene> &scenes) {
    bool right = true;
    for (const scene &s : scenes)
        for (const setting &o : settings) {
            right &= holds(s, o, "flies otherwise than rbd", flight_difference(s, o), 1e-9);
            const outcome x = judge(s, o, usual_step);
            right &= holds(s, o, "balance of forces", x.balance - x.unsolved, 1e-4);
        }
    return right;
}

// ---- time ----

double now_ns() {
    timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

double cost_of_clock() {
    double least = HUGE_VAL;
    for (int i = 0; i < 10000; i++) {
        const double t = now_ns();
        least = std::min(least, now_ns() - t);
    }
    return least;
}

// A row of the table. Each round runs the scene anew; of each step the least time counts.
struct row {
    const scene *s;
    const setting *o;
    double h;
    std::unique_ptr<simulation> x;
    std::vector<least> times;
    outcome result;

    int first() const { return steps_in(s->from, h); }
    void time_once() {
        robot r(s->bodies);
        run(*s, r, x.get(), h, s->to, [&](int i, const vector &, const vector &) {
            if (i < 0) return;
            const double t = now_ns();
            x->step();
            const double end = now_ns();
            if (i >= first()) least_take(&times[(size_t)(i - first())], end - t);
        });
    }
};

std::vector<row> make_rows(const std::vector<scene> &scenes) {
    std::vector<row> rows;
    for (const scene &s : scenes)
        for (double h : step_sizes)
            for (const setting &o : settings) {
                row r = {&s, &o, h, simulate(s, o, h), {}, judge(s, o, h)};
                r.times.assign((size_t)(steps_in(s.to, h) - r.first()), LEAST_NONE);
                rows.push_back(std::move(r));
            }
    return rows;
}

const char *library_of(const setting &o) {
    if (is_rbd(o)) return "rbd";
    return other_process() ? other_process()->version.c_str() : "MuJoCo " PEER_VERSION;
}

void print_head() {
    std::puts("scene,library,setting,step_ms,ns,disturbed,iterations,deepest_m,creep_m_s,acceleration_error,"
              "hover_m,energy_made_J,balance");
}

// times: its two columns.
void print_row(const scene &s, const setting &o, double h, const char *times, const outcome &x) {
    std::printf("\"%s\",%s,\"%s\",%g,%s,%.2f,%.3e,%.3e,%.3e,%.3e,%.3e,%.3e\n", s.name.c_str(), library_of(o),
                o.name, 1e3 * h, times, x.iterations, x.deepest, s.slope > 0 ? x.creep : 0,
                s.slope > 0 ? x.acceleration - exact_acceleration(s) : 0, x.hover, x.made, x.balance);
}

void print(const row &r, double clock) {
    char times[40];
    least sum = {0, 0};
    for (const least &t : r.times) sum.first += t.first - clock, sum.second += t.second - clock;
    std::snprintf(times, sizeof times, "%.1f,%d", sum.first / (double)r.times.size(), !least_repeats(sum));
    print_row(*r.s, *r.o, r.h, times, r.result);
}

// Without times, with steps of one size.
void print_results(const std::vector<scene> &scenes) {
    print_head();
    for (const scene &s : scenes)
        for (const setting &o : settings)
            if (!is_rbd(o)) print_row(s, o, usual_step, ",", judge(s, o, usual_step));
}

void measure(const std::vector<scene> &scenes, int rounds) {
    std::vector<row> rows = make_rows(scenes);
    const double clock = cost_of_clock();
    for (int i = 0; i < rounds; i++)
        for (row &r : rows) r.time_once();
    print_head();
    for (const row &r : rows) print(r, clock);
}

// ---- instructions ----

#ifdef CONTACT_VALGRIND
// A dump of callgrind's for each scene and setting: "SCENE;SETTING;STEPS".
bool count(const std::vector<scene> &scenes) {
    for (const scene &s : scenes)
        for (const setting &o : settings) {
            robot r(s.bodies);
            const auto x = simulate(s, o, usual_step);
            const int first = steps_in(s.from, usual_step), all = steps_in(s.to, usual_step);
            const std::string key = s.name + ";" + o.name + ";" + std::to_string(all - first);
            CALLGRIND_ZERO_STATS;
            run(s, r, x.get(), usual_step, s.to, [&](int i, const vector &, const vector &) {
                if (i < 0) return;
                if (i >= first) CALLGRIND_TOGGLE_COLLECT;
                x->step();
                if (i >= first) CALLGRIND_TOGGLE_COLLECT;
            });
            CALLGRIND_DUMP_STATS_AT(key.c_str());
        }
    return true;
}
#else
bool count(const std::vector<scene> &) {
    std::fputs("contact: built without valgrind's headers\n", stderr);
    return false;
}
#endif

} // namespace

int main(int argc, char **argv) {
    const std::string what = argc > 1 ? argv[1] : "";
    const std::vector<scene> scenes = all_scenes();
    mju_user_warning = [](const char *) {}; // of a line search that rounding ends; it would write a file
    const int rounds = what == "--rounds" && argc == 3 ? std::atoi(argv[2]) : 20;
    if ((what == "--rounds" || what == "--results-of") != (argc == 3) || rounds < 1 || argc > 3 ||
        (argc == 2 && what != "--verify" && what != "--count")) {
        std::fputs("usage: contact [--verify | --count | --rounds N | --results-of COMMAND]\n", stderr);
        return 2;
    }
    if (what == "--count") return !count(scenes);
    if (what == "--results-of") other_process() = std::make_unique<pipes>(argv[2]);
    if (!verify(scenes)) return 1;
    if (what == "--results-of")
        print_results(scenes);
    else if (what != "--verify")
        measure(scenes, rounds);
    return 0;
}
