// fuzz.cpp - writes code of a random robot, with rbd.h's results in random states as its self-test: all
// functions, by options that the robot's number draws.
// usage: fuzz FOLDER NUMBER, writes fNUMBER_code.h and .c
#include "../../tools/codegen/emit.h"
#include "../../tools/codegen/limbs.h"
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

extern "C" {
enum { ORDINARY, AXES, TURNED = 7, FOLLOWERS, CLASSES = 10 }; // of robots.h
extern const char *const class_names[CLASSES];
const rbd_body *drawn_robot(int class_number, int number, int limbs, int *nb);
void drawn_state();
const double *drawn_input(const char *name);
double uniform(uint64_t *seed, double low, double high);
}

namespace {

enum { STATES = 10 };
typedef std::vector<std::vector<double>> input;

struct drawn {
    codegen::target t;
    codegen::robot r;
    std::string about;
};

drawn draw(int number) {
    uint64_t seed = uint64_t(number);
    const auto below = [&seed](int n) { return int(uniform(&seed, 0, n)); };
    const int robot_class = number % CLASSES, alike = below(3) ? 1 : 2 << below(2);
    // float cannot tell the lengths and masses of the other classes
    const bool can_be_float = robot_class <= AXES || robot_class == TURNED || robot_class == FOLLOWERS;
    drawn x = {};
    x.r.bodies = drawn_robot(robot_class, number, alike, &x.r.nb);
    x.r.gravity[2] = -9.81;
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
    x.about = x.t.name + ": " + class_names[robot_class] + ", " + std::to_string(x.r.nb) + " bodies, " +
              (x.t.is_float ? "float" : "double") + (x.t.is_reproducible ? ", reproducible" : "") +
              (x.t.is_bounded ? ", bounded" : "") + (x.t.statements.long_sums ? "" : ", short sums") +
              ", lanes " + std::to_string(x.t.lanes) + ", limbs " + std::to_string(x.t.limbs) + ", block " +
              std::to_string(x.t.block);
    return x;
}

/* Condition number in the norm of the largest column sum, by Gauss and Jordan with the largest pivots. */
double condition(std::vector<double> M) {
    const size_t n = size_t(std::lround(std::sqrt(double(M.size()))));
    std::vector<long double> A(M.begin(), M.end()), B(n * n);
    const auto norm = [n](const std::vector<long double> &X) {
        long double most = 0;
        for (size_t j = 0; j < n; j++) {
            long double sum = 0;
            for (size_t i = 0; i < n; i++) sum += std::fabs(X[n * i + j]);
            most = std::fmax(most, sum);
        }
        return most;
    };
    const long double before = norm(A);
    for (size_t i = 0; i < n; i++) B[(n + 1) * i] = 1;
    for (size_t k = 0; k < n; k++) {
        size_t best = k;
        for (size_t i = k; i < n; i++)
            if (std::fabs(A[n * i + k]) > std::fabs(A[n * best + k])) best = i;
        if (!(std::fabs(A[n * best + k]) > 0)) return HUGE_VAL;
        for (auto *X : {&A, &B}) std::swap_ranges(&(*X)[n * k], &(*X)[n * k] + n, &(*X)[n * best]);
        for (size_t i = 0; i < n; i++) {
            const long double factor = i == k ? 1 - 1 / A[n * k + k] : A[n * i + k] / A[n * k + k];
            for (auto *X : {&A, &B})
                for (size_t j = 0; j < n; j++) (*X)[n * i + j] -= factor * (*X)[n * k + j];
        }
    }
    return double(before * norm(B));
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

/* Of the results; those of M^-1 as M can be inverted. */
double tolerance_of(const drawn &x, const codegen::function &f, const input &in) {
    const double eps = x.t.is_float ? FLT_EPSILON : DBL_EPSILON;
    double largest = 0;
    for (double y : in[0]) largest = std::fmax(largest, std::fabs(y));
    const double angle = eps * largest;
    if (f.pivots.empty()) return 5e4 * eps + 100 * angle;
    return 5e4 * eps + (10 * eps + 100 * angle) * condition(codegen::compute(x.r, "mm", {in[0]}).out);
}

struct tested {
    std::string name; // of the algorithm
    codegen::tested code;
};

/* Adds rbd.h's results to the known ones; not where it refuses, or the scalar can tell too little of them. */
void add_state(const drawn &x, tested *to) {
    const input in = inputs(to->code.f);
    const double tolerance = tolerance_of(x, to->code.f, in);
    if (!(tolerance < (x.t.is_float ? 0.05 : 1e-4))) return;
    for (double y : in[0])
        if (x.t.is_bounded && !(std::fabs(y) < (x.t.is_float ? 1e3 : 1e5))) return;
    try {
        to->code.examples.push_back(codegen::compute(x.r, to->name, in));
    } catch (const std::runtime_error &) {
        return;
    }
    to->code.tolerance = x.t.is_reproducible && !x.t.is_float ? 0 : std::fmax(to->code.tolerance, tolerance);
    for (double y : to->code.examples.back().out)
        to->code.least = std::fmax(to->code.least, 1e-6 * std::fabs(y));
}

void write(const std::string &path, const std::string &text) {
    FILE *file = std::fopen(path.c_str(), "w");
    if (!file || std::fputs(text.c_str(), file) < 0 || std::fclose(file) != 0) std::exit(1);
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    const drawn x = draw(std::atoi(argv[2]));
    std::vector<tested> all;
    for (const std::string &given : codegen::algorithm_names()) {
        const std::string name =
            given.substr(0, given.find("LINK")) + (given.find("LINK") != given.npos ? "tip" : "");
        if (codegen::takes_constraints(name)) continue; // check.c has robots with constraints
        const codegen::function f =
            x.t.is_float ? codegen::record_float(x.r, name) : codegen::record_double(x.r, name);
        all.push_back({name,
                       {x.r.limbs_alike ? codegen::pack_limbs(f, codegen::joints(x.r), x.t.limbs) : f,
                        {},
                        0,
                        x.t.is_float ? 1e-30 : 1e-300}});
    }
    for (int k = 0; k < STATES; k++) {
        drawn_state();
        for (tested &y : all) add_state(x, &y);
    }
    std::vector<codegen::tested> functions;
    size_t states = 0;
    for (const tested &y : all) {
        if (y.code.examples.empty()) continue;
        functions.push_back(y.code);
        states += y.code.examples.size();
    }
    std::printf("%s: %zu functions, %zu states\n", x.about.c_str(), functions.size(), states);
    const std::string path = argv[1] + ("/" + x.t.name);
    write(path + "_code.h", codegen::declarations(functions, x.t));
    write(path + "_code.c", "#include \"" + x.t.name + "_code.h\"\n" + codegen::definitions(functions, x.t));
    return 0;
}
