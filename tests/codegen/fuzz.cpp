// fuzz.cpp - writes code of a random robot, with rbd.h's results in random states as its self-test: all
// functions, by options that the robot's number draws.
// usage: fuzz FOLDER NUMBER, writes FOLDER/fNUMBER_code.h and .c
#include "../../tools/codegen/emit.h"
#include "../../tools/codegen/limbs.h"
#include "rbd.h"
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstdlib>
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
    // float cannot tell the lengths and masses of the other classes
    const bool can_be_float = robot_class <= AXES || robot_class == TURNED || robot_class == FOLLOWERS;
    drawn x = {};
    x.r.bodies = drawn_robot(robot_class, number, alike, &x.r.nb);
    x.r.constraints = drawn_constraints(number, &x.r.nc);
    x.r.gravity[2] = -9.81;
    int nv = 0;
    for (const codegen::joint &j : codegen::joints(x.r)) nv += j.nv;
    x.r.actuated.assign(drawn_motors(), drawn_motors() + nv);
    x.r.f_ext = below(2), x.r.gravity_argument = below(2);
    x.t.name = "f" + std::to_string(number);
    x.t.is_float = can_be_float && below(3) == 0;
    x.t.is_reproducible = x.r.reproducible = below(4) == 0;
    x.t.is_bounded = below(3) == 0 && robot_class != TURNED;
    x.t.lanes = below(3) ? 1 : 2 << below(2);
    x.t.limbs = x.t.lanes > 1 || x.t.is_reproducible ? 1 : codegen::like_limbs(codegen::joints(x.r), 4);
    x.t.block = below(2) ? 600 : 50 + below(100);
    x.t.statements.long_sums = below(3) && !x.t.is_reproducible;
    x.r.limbs_alike = x.t.limbs > 1;
    x.r.by_rows = x.t.lanes == 1 && x.t.statements.long_sums;
    for (int stances = x.t.lanes == 1 && below(2) ? 1 + below(4) : 0; stances > 0; stances--)
        x.r.stances.push_back(some_of(x.r.nc, below(1 << x.r.nc)));
    x.about = x.t.name + ": " + class_names[robot_class] + ", " + std::to_string(x.r.nb) + " bodies, " +
              (x.t.is_float ? "float" : "double") + (x.t.is_reproducible ? ", reproducible" : "") +
              (x.t.is_bounded ? ", bounded" : "") + (x.t.statements.long_sums ? "" : ", short sums") +
              ", lanes " + std::to_string(x.t.lanes) + ", limbs " + std::to_string(x.t.limbs) + ", block " +
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

/* Inputs nearby, each at most so much of itself off. */
input moved(input in, double share, uint64_t seed) {
    for (std::vector<double> &x : in)
        for (double &y : x) y *= uniform(&seed, 1 - share, 1 + share);
    return in;
}

/* A robot whose last digits differ; its bodies stand in `room`. */
codegen::robot moved(codegen::robot r, uint64_t seed, std::vector<rbd_body> *room) {
    const auto move = [&seed](double *x, int n) {
        for (int k = 0; k < n; k++) x[k] *= uniform(&seed, 1 - 4 * DBL_EPSILON, 1 + 4 * DBL_EPSILON);
    };
    room->assign(r.bodies, r.bodies + r.nb);
    for (rbd_body &b : *room)
        move(&b.mass, 1), move(b.com, 3), move(b.inertia, 6), move(b.position, 3), move(b.armature, 6);
    r.bodies = room->data();
    return r;
}

/* The largest difference of results relative to the largest of their array; infinite if one is no number. */
template <class T>
double difference(const codegen::function &f, const codegen::example &e, const std::vector<T> &x,
                  const std::vector<double> &y) {
    double worst = 0;
    size_t k = 0;
    for (const codegen::array &a : f.outputs) {
        double largest = 1e-300, sum = 0;
        for (const size_t end = k + size_t(a.size); k < end; k++) {
            largest = std::fmax(largest, std::fabs(e.out[k]));
            sum += std::fabs(double(x[k]) - y[k]);
        }
        if (!(sum / largest < HUGE_VAL)) return HUGE_VAL;
        worst = std::fmax(worst, sum / largest);
    }
    return worst;
}

struct tested {
    std::string name; // of the algorithm
    codegen::tested code;
};

/* Of results relative to the largest of their array: some roundings of these, and a hundred times those on
   the way to them. Float shows the code's, in states nearby; rbd.h's show where the last digits of the
   robot and of arguments differ. Infinite where one of the two refuses. */
double tolerance_of(const drawn &x, const tested &to, const codegen::example &e) {
    const codegen::function &f = to.code.f;
    const double eps = x.t.is_float ? FLT_EPSILON : DBL_EPSILON;
    double code = 0, rbd = 0;
    std::vector<rbd_body> room;
    for (uint64_t seed = 0; seed < 10; seed++) {
        const input in = moved(e.in, seed > 0 ? 1e-3 : 0, seed);
        const std::vector<double> fine = codegen::evaluate<double>(f, in, e.stance);
        const std::vector<float> rough = codegen::evaluate<float>(f, in, e.stance);
        if (fine.empty() || rough.empty()) return HUGE_VAL;
        code = std::fmax(code, difference(f, e, rough, fine));
        const input near = moved(e.in, 4 * DBL_EPSILON, seed);
        const codegen::robot r = moved(x.r, seed, &room);
        rbd = std::fmax(rbd, difference(f, e, codegen::compute(r, to.name, near, e.stance).out, e.out));
    }
    return 5e4 * eps + 100 * (code / double(FLT_EPSILON) + rbd / DBL_EPSILON) * eps;
}

double largest(const std::vector<double> &all) {
    double x = 0;
    for (double y : all) x = std::fmax(x, std::fabs(y));
    return x;
}

/* Adds rbd.h's results to the known ones; not where one of the two refuses, or digits are lost. */
void add_example(const drawn &x, const input &in, int stance, tested *to) {
    try {
        const codegen::example e = codegen::compute(x.r, to->name, in, stance);
        const double tolerance = tolerance_of(x, *to, e);
        if (!(tolerance < (x.t.is_float ? 0.05 : 1e-4))) return;
        to->code.examples.push_back(e);
        to->code.tolerance =
            x.t.is_reproducible && !x.t.is_float ? 0 : std::fmax(to->code.tolerance, tolerance);
    } catch (const std::runtime_error &) {
        return;
    }
    double size = largest(to->code.examples.back().out);
    /* C is a difference of terms of the size of M v, and 0 with one degree of freedom. */
    if (to->name == "coriolis")
        size = std::fmax(size, largest(codegen::compute(x.r, "mm", {in[0]}).out) * largest(in[1]));
    to->code.least = std::fmax(to->code.least, 1e-6 * size);
}

/* In each stance. */
void add_state(const drawn &x, tested *to) {
    const input in = inputs(to->code.f);
    for (double y : in[0])
        if (x.t.is_bounded && !(std::fabs(y) < (x.t.is_float ? 1e3 : 1e5))) return;
    for (int stance = 0; stance < to->code.f.sets(); stance++) add_example(x, in, stance, to);
}

void write(const std::string &path, const std::string &text) {
    FILE *file = std::fopen(path.c_str(), "w");
    if (!file || std::fputs(text.c_str(), file) < 0 || std::fclose(file) != 0) std::exit(1);
}

} // namespace

/* All functions of the robot, but those of constraints that cannot be recorded. */
std::vector<tested> record(const drawn &x) {
    std::vector<tested> all;
    for (std::string name : codegen::algorithm_names()) {
        const size_t link = name.find("LINK");
        if (link != name.npos) name.replace(link, 4, "tip");
        try {
            codegen::function f =
                x.t.is_float ? codegen::record_float(x.r, name) : codegen::record_double(x.r, name);
            if (x.r.limbs_alike) f = codegen::pack_limbs(f, codegen::joints(x.r), x.t.limbs);
            all.push_back({name, {f, {}, 0, x.t.is_float ? 1e-30 : 1e-300}});
        } catch (const std::runtime_error &) {
            if (!codegen::takes_constraints(name)) throw;
        }
    }
    return all;
}

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    const drawn x = draw(std::atoi(argv[2]));
    std::vector<tested> all = record(x);
    std::vector<codegen::tested> functions;
    size_t states = 0;
    for (int k = 0; k < STATES; k++) {
        drawn_state();
        for (tested &y : all) add_state(x, &y);
    }
    for (const tested &y : all) {
        if (!y.code.examples.empty()) functions.push_back(y.code);
        states += y.code.examples.size();
    }
    std::printf("%s: %zu functions, %zu states\n", x.about.c_str(), functions.size(), states);
    const std::string path = argv[1] + ("/" + x.t.name);
    write(path + "_code.h", codegen::declarations(functions, x.t));
    write(path + "_code.c", "#include \"" + x.t.name + "_code.h\"\n" + codegen::definitions(functions, x.t));
    return 0;
}
