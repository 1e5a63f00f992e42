// fuzz.cpp - writes code of a random robot, with rbd.h's results in random states as its self-test: all
// functions, by options that the robot's number draws.
// usage: fuzz FOLDER NUMBER, writes FOLDER/fNUMBER_code.h and .c
#include "../larger.h"
#include "quad.h"
#include "rbd.h"
#include "rbd_constraints.h"
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

extern "C" {
enum { ORDINARY, AXES, TURNED = 7, FOLLOWERS, CLASSES = 10 }; // of robots.h
extern const char *const class_names[CLASSES];
const rbd_body *drawn_robot(int class_number, int number, int limbs, int *nb);
const rbd_constraint *drawn_constraints(int number, int *nc);
const unsigned char *drawn_motors();
void drawn_state();
const double *drawn_input(const char *name);
double uniform(uint64_t *seed, double low, double high);
}

namespace {

enum { STATES = 6 };
typedef std::vector<std::vector<double>> input;

struct drawn {
    codegen::target t;
    codegen::robot r;
    std::string about;
    bool has_usual_sizes; // lengths and masses that float can tell
};

/* Those numbers below n whose bits are set. */
std::vector<int> some_of(int n, int bits) {
    std::vector<int> found;
    for (int k = 0; k < n; k++)
        if (bits >> k & 1) found.push_back(k);
    return found;
}

drawn draw(int number) {
    uint64_t seed = uint64_t(number);
    const auto below = [&seed](int n) { return int(uniform(&seed, 0, n)); };
    const int robot_class = number % CLASSES, alike = below(3) ? 1 : 2 << below(2);
    drawn x = {};
    x.has_usual_sizes = robot_class <= AXES || robot_class == TURNED || robot_class == FOLLOWERS;
    x.r.bodies = drawn_robot(robot_class, number, alike, &x.r.nb);
    x.r.constraints = drawn_constraints(number, &x.r.nc);
    x.r.gravity[2] = -9.81;
    int nv = 0;
    for (const codegen::joint &j : codegen::joints(x.r)) nv += j.nv;
    x.r.actuated.assign(drawn_motors(), drawn_motors() + nv);
    x.r.f_ext = below(2), x.r.gravity_argument = below(2);
    x.t.name = "f" + std::to_string(number);
    x.t.is_float = x.has_usual_sizes && below(3) == 0;
    x.t.is_reproducible = x.r.reproducible = below(4) == 0;
    x.t.is_bounded = below(3) == 0 && robot_class != TURNED;
    x.t.lanes = below(3) ? 1 : 2 << below(2);
    x.t.limbs = x.t.lanes > 1 || x.t.is_reproducible ? 1 : codegen::like_limbs(codegen::joints(x.r), 4);
    x.t.block = below(2) ? 600 : 50 + below(100);
    x.t.long_sums = below(3) && !x.t.is_reproducible;
    x.r.limbs_alike = x.t.limbs > 1;
    x.r.by_rows = x.t.lanes == 1 && x.t.long_sums;
    for (int stances = x.t.lanes == 1 && below(2) ? 1 + below(4) : 0; stances > 0; stances--)
        x.r.stances.push_back(some_of(x.r.nc, below(1 << x.r.nc)));
    x.about = x.t.name + ": " + class_names[robot_class] + ", " + std::to_string(x.r.nb) + " bodies, " +
              (x.t.is_float ? "float" : "double") + (x.t.is_reproducible ? ", reproducible" : "") +
              (x.t.is_bounded ? ", bounded" : "") + (x.t.long_sums ? "" : ", short sums") + ", lanes " +
              std::to_string(x.t.lanes) + ", limbs " + std::to_string(x.t.limbs) + ", block " +
              std::to_string(x.t.block) + ", stances " + std::to_string(x.r.stances.size());
    return x;
}

/* The arguments in the state drawn last; what that has none of is a quarter. */
input inputs(const codegen::function &f) {
    input in;
    for (const codegen::array &a : f.inputs) {
        const double *x = drawn_input(a.name.c_str());
        in.push_back(x ? std::vector<double>(x, x + a.size) : std::vector<double>(size_t(a.size), 0.25));
    }
    return in;
}

/* ---- how much of a difference is rounding ----
   Results are compared with those of rbd.h in quad precision. In a state nearby, of a robot nearby, a mistake
   makes nearly the same difference, and rounding another one. So code is recorded of several neighbours, and
   the differences of its results show how far rounding goes. */

enum { NEARBY = 8 };
const double distance = 1e-4; // relative, of what neighbours are made of

double epsilon(const drawn &x) { return x.t.is_float ? double(FLT_EPSILON) : DBL_EPSILON; }

double largest(const std::vector<double> &all) {
    double x = 0;
    for (double y : all) x = larger(x, std::fabs(y));
    return x;
}

/* A state nearby: what is large, such as an angle of many turns, moves no further than 1 would, but by some
   of its last digits. */
input moved(const drawn &x, input in, uint64_t seed) {
    for (std::vector<double> &values : in)
        for (double &y : values) {
            const double size = std::fabs(y), most = std::fmin(size, 1) * distance;
            y += std::fmax(most, 16 * epsilon(x) * size) * uniform(&seed, -1, 1);
            if (x.t.is_float) y = double(float(y));
        }
    return in;
}

struct neighbour {
    std::vector<rbd_body> bodies;
    std::vector<rbd_constraint> constraints;
    codegen::robot r;
};

/* Zeros stay 0, rotations are still what rbd.h takes for one, and inertias are physical. */
void move(const drawn &x, uint64_t seed, neighbour *to) {
    const auto change = [&seed]() { return uniform(&seed, -distance, distance); };
    const auto scale = [&change](double *y, int n) {
        for (int k = 0; k < n; k++) y[k] *= 1 + change();
    };
    const auto turn = [&change](double *y) {
        for (int k = 0; k < 9; k++)
            if (std::fabs(y[k]) > 0) y[k] += change() / 200;
    };
    to->bodies.assign(x.r.bodies, x.r.bodies + x.r.nb);
    to->constraints.assign(x.r.constraints, x.r.constraints + x.r.nc);
    for (rbd_body &b : to->bodies) {
        scale(&b.mass, 1), scale(b.com, 3), scale(b.position, 3), scale(b.armature, 6), turn(b.rotation);
        scale(b.axis, 3), scale(b.axis2, 3), scale(&b.pitch, 1);
        scale(&b.mimic_ratio, 1), scale(&b.mimic_offset, 1);
        const double k = 1 + change();
        for (double &y : b.inertia) y *= k;
    }
    for (rbd_constraint &c : to->constraints) {
        scale(c.position1, 3), scale(c.position2, 3), scale(&c.kp, 1), scale(&c.kd, 1);
        turn(c.rotation1), turn(c.rotation2);
    }
    to->r = x.r;
    to->r.bodies = to->bodies.data(), to->r.constraints = to->constraints.data();
}

struct tested {
    std::string name; // of the algorithm
    codegen::tested code;
    std::vector<codegen::function> nearby; // of the neighbours
    bool may_be_empty;                     // there may be no example: see add_example
};

/* As the code computes it; none if it refuses. */
std::vector<double> evaluate(const drawn &x, const codegen::function &f, const input &in, int stance) {
    if (!x.t.is_float) return codegen::evaluate<double>(f, in, stance);
    const std::vector<float> y = codegen::evaluate<float>(f, in, stance);
    return {y.begin(), y.end()};
}

/* That the largest result of an array counts as. C and derivatives by v are differences of terms of the size
   of M v, and 0 with one degree of freedom. */
double least_of(const drawn &x, const tested &to, const codegen::example &e) {
    const double share = (x.t.is_float ? 1e-2 : 1e-6) * largest(e.out);
    if (to.name != "coriolis" && to.name != "id_derivatives") return share;
    return std::fmax(share, largest(codegen::compute(x.r, "mm", {e.in[0]}).out) * largest(e.in[1]));
}

/* How far the neighbours' differences are apart, for each result; infinite where code refuses. */
std::vector<double> scatter_of(const drawn &x, const std::vector<neighbour> &near, const tested &to,
                               const codegen::example &e) {
    std::vector<double> low(e.out.size(), HUGE_VAL), high(e.out.size(), -HUGE_VAL);
    for (size_t n = 0; n < near.size(); n++) {
        const input in = moved(x, e.in, n);
        const std::vector<double> y = evaluate(x, to.nearby[n], in, e.stance);
        if (y.empty()) return std::vector<double>(e.out.size(), HUGE_VAL);
        const std::vector<double> exact = compute_quad(near[n].r, to.name, in, e.stance);
        for (size_t k = 0; k < y.size(); k++) {
            const double difference = y[k] - exact[k],
                         known = std::isfinite(difference) ? difference : HUGE_VAL;
            low[k] = std::fmin(low[k], known), high[k] = larger(high[k], known);
        }
    }
    for (size_t k = 0; k < low.size(); k++) high[k] -= std::isfinite(high[k]) ? low[k] : 0;
    return high;
}

/* Relative to the largest result of an array: some roundings of it, and the scatter many times. Of 600 robots
   the worst error was 5 times the scatter, in float 50: there, what is added to an angle of many turns, such
   as the angle of a frame, is hardly moved. */
double tolerance_of(const drawn &x, const codegen::function &f, const codegen::example &e, double least,
                    const std::vector<double> &scatter) {
    double worst = 0;
    size_t k = 0;
    for (const codegen::array &a : f.outputs) {
        double size = std::fmax(least, 1e-300), sum = 0;
        for (const size_t end = k + size_t(a.size); k < end; k++)
            size = larger(size, std::fabs(e.out[k])), sum += scatter[k];
        worst = larger(worst, sum / size);
    }
    return (x.t.is_float ? 100 : 20) * (10 * epsilon(x) + worst);
}

/* Adds results of rbd.h to the known ones; not where one of the two refuses, or digits are lost. Code may
   refuse where rbd.h does not if rows depend on each other, or nearly, which can be where sizes differ. */
void add_example(const drawn &x, const std::vector<neighbour> &near, const input &in, int stance,
                 tested *to) {
    const bool to_the_bit = x.t.is_reproducible && !x.t.is_float;
    try {
        codegen::example e = codegen::compute(x.r, to->name, in, stance);
        if (!to_the_bit) e.out = compute_quad(x.r, to->name, in, stance);
        const std::vector<double> found = evaluate(x, to->code.f, in, stance);
        to->may_be_empty |= !found.empty() || e.rank < e.rows || (e.rows > 0 && !x.has_usual_sizes);
        if (found.empty()) return;
        for (size_t k = 0; k < found.size(); k++)
            if (std::isnan(found[k]) || std::isnan(e.out[k]))
                throw std::logic_error((std::isnan(e.out[k]) ? "rbd.h's " : "") + to->name + " gives NaN");
        const double least = least_of(x, *to, e);
        const double tolerance = tolerance_of(x, to->code.f, e, least, scatter_of(x, near, *to, e));
        if (!(tolerance < (x.t.is_float ? 0.05 : 1e-4))) return;
        to->code.examples.push_back(e);
        to->code.least = larger(to->code.least, least);
        if (!to_the_bit) to->code.tolerance = std::fmax(to->code.tolerance, tolerance);
    } catch (const std::runtime_error &) {
        to->may_be_empty = true;
    }
}

/* In each stance. */
void add_state(const drawn &x, const std::vector<neighbour> &near, tested *to) {
    const input in = inputs(to->code.f);
    for (double y : in[0])
        if (x.t.is_bounded && !(std::fabs(y) < (x.t.is_float ? 1e3 : 1e5))) {
            to->may_be_empty = true;
            return;
        }
    for (int stance = 0; stance < to->code.f.sets(); stance++) add_example(x, near, in, stance, to);
}

void write(const std::string &path, const std::string &text) {
    FILE *file = std::fopen(path.c_str(), "w");
    if (!file || std::fputs(text.c_str(), file) < 0 || std::fclose(file) != 0) std::exit(1);
}

} // namespace

/* One function. Throws std::runtime_error where it cannot be recorded. */
codegen::function record(const drawn &x, const codegen::robot &r, const std::string &name) {
    return x.t.is_float ? codegen::record_float(r, name) : codegen::record_double(r, name);
}

/* All functions of the robot, but those that cannot be recorded of constraints, or where M is singular. */
std::vector<tested> record(const drawn &x, const std::vector<neighbour> &near) {
    std::vector<tested> all;
    for (std::string name : codegen::algorithm_names()) {
        const size_t link = name.find("LINK");
        if (link != name.npos) name.replace(link, 4, "tip");
        try {
            codegen::function f = record(x, x.r, name);
            if (x.r.limbs_alike) f = codegen::pack_limbs(f, codegen::joints(x.r), x.t.limbs);
            tested to = {name, {f, {}, 0, x.t.is_float ? 1e-30 : 1e-300}, {}, false};
            for (const neighbour &n : near) to.nearby.push_back(record(x, n.r, name));
            all.push_back(to);
        } catch (const std::runtime_error &e) {
            if (!codegen::takes_constraints(name) && !std::strstr(e.what(), "is singular")) throw;
        }
    }
    return all;
}

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    const drawn x = draw(std::atoi(argv[2]));
    std::vector<neighbour> near(NEARBY);
    for (size_t n = 0; n < near.size(); n++) move(x, n, &near[n]);
    std::vector<tested> all = record(x, near);
    std::vector<codegen::tested> functions;
    size_t states = 0;
    for (int k = 0; k < STATES; k++) {
        drawn_state();
        for (tested &y : all) add_state(x, near, &y);
    }
    for (const tested &y : all) {
        if (!y.code.examples.empty()) functions.push_back(y.code);
        if (!y.may_be_empty) throw std::logic_error(y.name + " refuses all states, and rbd.h none");
        states += y.code.examples.size();
    }
    std::printf("%s: %zu functions, %zu states\n", x.about.c_str(), functions.size(), states);
    const std::string path = argv[1] + ("/" + x.t.name);
    write(path + "_code.h", codegen::declarations(functions, x.t));
    write(path + "_code.c", "#include \"" + x.t.name + "_code.h\"\n" + codegen::definitions(functions, x.t));
    return 0;
}
