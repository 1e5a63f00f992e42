/* rbd-codegen: writes rbd.h's functions for one robot as straight-line C. SPDX-License-Identifier: MIT */
extern "C" {
#include "constraints.h"
#include "csv.h"
#include "nearest.h"
#include "print.h"
#include "robot.h"
}
#include "codegen/codegen.h"
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <stdexcept>

const char *program = "rbd-codegen";

namespace {

const char help[] =
    "usage: rbd-codegen [OPTION...] FILE\n"
    "\n"
    "Writes NAME_code.h and NAME_code.c: functions of one robot as straight-line C99, which "
    "need no rbd.h.\n"
    "They compute the same as rbd.h: it is run once, on a scalar that records, and the "
    "record is written.\n"
    "Large matrices are factored and solved by rows, several columns at once, except with --lanes, "
    "--stances, --short-sums and --reproducible.\n"
    "  --name NAME         what files, functions and constants begin with (the file's name)\n"
    "  --output FOLDER     where to write (here)\n"
    "  --algorithm LIST    which functions, with commas between (id,mm,fd; or rnea,crba,aba); of a link "
    "with a comma\n"
    "                      in quotes, as in a table (id,\"pose:left, foot\"); there are\n";
const char help_more[] =
    "\n"
    "  --constraints FILE  of constrained, impact, constrained_id, delta: table of contacts and loops, as "
    "for "
    "rbd-eval\n"
    "  --stances FILE      of the constraints those that hold, by the links of body1 with commas between, or "
    "none: a\n"
    "                      line for each stance, which is an argument then, a number from 0\n"
    "  --passive JOINT     it has no motor in constrained_id; may stand several times (a floating base's)\n"
    "  --scalar SCALAR     double or float (double)\n"
    "  --lanes N           N states at once, 2, 4, 8 or 16: GCC's and clang's vectors of N scalars\n"
    "  --limbs N           up to N like limbs of a state at once, 2 or 4: vectors too, for computers (1)\n"
    "  --f-ext             external wrenches are an argument\n"
    "  --gravity-argument  gravity is an argument, not the constant of --gravity\n"
    "  --bounded-angles    angles from 1e6 rad on (float: 1e4), infinity and NaN are refused: less code\n"
    "  --reproducible      the same bits with every compiler, option and machine: those of rbd.h under "
    "RBD_REPRODUCIBLE\n"
    "  --example           also NAME_example.c, a main that calls the first function and prints what it "
    "gives\n"
    "  --cuda              NAME_code.cuh instead: C++11 for kernels, with one state to a thread, and for a "
    "host;\n"
    "                      angles are bounded and sums are short\n"
    "  --short-sums        for machines that do one operation at a time, as Cortex-M\n"
    "  --block N           most statements of a C function (300); longer ones are cut into several\n"
    "How the file is read:\n";
const char help_end[] =
    "\n"
    "Exit status: 0, 1 if the file has an error (with --strict: or a warning), 2 for bad arguments.\n";

const char *const options_helps[] = {help, help_more, settings_help, nullptr};

struct options {
    codegen::target target;
    codegen::robot robot;
    std::vector<std::string> algorithms;
    std::string folder;
    bool example, short_sums, block_is_given;
    const char *path, *constraints, *stances;
    std::vector<const char *> passive;
    settings read;
};

/* ---- arguments ---- */

bool is_identifier(const std::string &s) {
    if (s.empty() || isdigit(static_cast<unsigned char>(s[0]))) return false;
    for (char c : s)
        if (!isalnum(static_cast<unsigned char>(c)) && c != '_') return false;
    return true;
}

/* NAME, or NAME:LINK where it is a link's. before: the word of the list before it, whose link may have a
   comma. */
int check_algorithm(const std::string &given, const std::string &before) {
    const std::string name = given.substr(0, given.find(':'));
    const bool has_link = name != given;
    nearest n = nearest_to(name.c_str());
    bool is_known = false;
    for (const std::string &x : codegen::algorithm_names()) {
        const std::string known = x.substr(0, x.find(':'));
        nearest_see_words(&n, known.c_str(), known.size());
        is_known = is_known || name == known;
        if (name != known || has_link == (known != x)) continue;
        return has_link ? usage_error("--algorithm: '%s' takes no link", name.c_str())
                        : usage_error("--algorithm: '%s' is a link's: '%s'", name.c_str(), x.c_str());
    }
    if (is_known) return 0;
    if (*n.best)
        return usage_error("--algorithm: there is no '%s'; did you mean '%s'?", name.c_str(), n.best);
    if (before.find(':') != std::string::npos)
        return usage_error("--algorithm: there is no '%s'; a link with a comma stands in quotes: '\"%s,%s\"'",
                           given.c_str(), before.c_str(), given.c_str());
    return usage_error("--algorithm: there is no '%s'", name.c_str());
}

/* This command's name of an algorithm that has rbd.h's name, as in rbd-eval. */
std::string own_name(const std::string &name) {
    return name == "rnea" ? "id" : name == "crba" ? "mm" : name == "aba" ? "fd" : name;
}

/* The words of a list with commas between, without their quotes. False: a quote is not closed, or something
   follows it. */
bool split(const std::string &list, std::vector<std::string> *words) {
    for (size_t at = 0; at <= list.size(); at++) {
        std::string word;
        if (at == list.size() || list[at] != '"') {
            const size_t end = std::min(list.find(',', at), list.size());
            word = list.substr(at, end - at);
            at = end;
        } else {
            for (at++; at < list.size() && (list[at] != '"' || list[at + 1] == '"'); at++) {
                at += list[at] == '"'; /* two stand for one */
                word += list[at];
            }
            if (at == list.size() || (++at < list.size() && list[at] != ',')) return false;
        }
        words->push_back(word);
    }
    return true;
}

int read_algorithms(options *o, const char *list) {
    std::vector<std::string> words;
    if (!split(list, &words))
        return usage_error("--algorithm: a quote is not closed, or something follows it: %s", list);
    o->algorithms.clear();
    for (size_t k = 0; k < words.size(); k++) {
        const std::string name = own_name(words[k]);
        if (check_algorithm(name, k > 0 ? words[k - 1] : "") != 0) return EXIT_USAGE;
        for (const std::string &x : o->algorithms) {
            const std::string in_c = codegen::name_in_c(name);
            if (x == name) return usage_error("--algorithm: '%s' stands twice", name.c_str());
            if (codegen::name_in_c(x) == in_c)
                return usage_error("--algorithm: '%s' and '%s' have one name in C, '%s'", x.c_str(),
                                   name.c_str(), in_c.c_str());
        }
        o->algorithms.push_back(name);
    }
    return 0;
}

int read_scalar(options *o, const char *text) {
    o->target.is_float = strcmp(text, "float") == 0;
    if (o->target.is_float || strcmp(text, "double") == 0) return 0;
    return usage_error("--scalar: '%s' is neither double nor float", text);
}

int read_lanes(options *o, const char *text) {
    for (int n = 2; n <= 16; n *= 2)
        if (text == std::to_string(n)) return o->target.lanes = n, 0;
    return usage_error("--lanes: '%s' is none of 2, 4, 8, 16", text);
}

int read_limbs(options *o, const char *text) {
    for (int n = 1; n <= 4; n *= 2)
        if (text == std::to_string(n)) return o->target.limbs = n, 0;
    return usage_error("--limbs: '%s' is none of 1, 2, 4", text);
}

int read_block(options *o, const char *text) {
    char *end;
    const long n = strtol(text, &end, 10);
    if (*end || end == text || n < 50 || n > 1000000)
        return usage_error("--block: '%s' is no number from 50 to 1000000", text);
    o->target.block = int(n);
    o->block_is_given = true;
    return 0;
}

/* Of C++, where a namespace has the name; those of C are prefixes alone. */
bool is_taken_in_cpp(const std::string &name) {
    static const char all[] =
        " alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t "
        "char32_t class "
        "compl concept const consteval constexpr constinit const_cast continue co_await co_return co_yield "
        "decltype default delete do double dynamic_cast else enum explicit export extern false float for "
        "friend "
        "goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private "
        "protected public rbd register reinterpret_cast requires return short signed sizeof static "
        "static_assert "
        "static_cast std struct switch template this thread_local throw true try typedef typeid typename "
        "union "
        "unsigned using virtual void volatile wchar_t while xor xor_eq ";
    return strstr(all, (" " + name + " ").c_str()) != nullptr;
}

int read_name(options *o, const char *text) {
    o->target.name = text;
    return is_identifier(text) ? 0 : usage_error("--name: '%s' is not a C identifier", text);
}

int read_constraints(options *o, const char *text) { return o->constraints = text, 0; }
int read_stances(options *o, const char *text) { return o->stances = text, 0; }
int read_passive(options *o, const char *text) { return o->passive.push_back(text), 0; }
int read_folder(options *o, const char *text) { return o->folder = *text ? std::string(text) + "/" : "", 0; }

/* Reads argument *i if it is one of this command's own; -1 if it is none. */
int read_own(options *o, char **argv, int *i) {
    static const struct {
        const char *name;
        int (*read)(options *, const char *);
    } with_value[] = {{"--name", read_name},
                      {"--output", read_folder},
                      {"--algorithm", read_algorithms},
                      {"--scalar", read_scalar},
                      {"--lanes", read_lanes},
                      {"--block", read_block},
                      {"--limbs", read_limbs},
                      {"--constraints", read_constraints},
                      {"--passive", read_passive},
                      {"--stances", read_stances}};
    for (const auto &x : with_value) {
        if (!option_is(argv[*i], x.name)) continue;
        const char *text = option_value(argv, i);
        return text ? x.read(o, text) : int(EXIT_USAGE);
    }
    const struct {
        const char *name;
        bool *is_given;
    } flags[] = {{"--f-ext", &o->robot.f_ext},
                 {"--gravity-argument", &o->robot.gravity_argument},
                 {"--reproducible", &o->robot.reproducible},
                 {"--bounded-angles", &o->target.is_bounded},
                 {"--example", &o->example},
                 {"--cuda", &o->target.is_cuda},
                 {"--short-sums", &o->short_sums}};
    for (const auto &x : flags)
        if (strcmp(argv[*i], x.name) == 0) return *x.is_given = true, 0;
    return -1;
}

void print_help() {
    printf("%s", help);
    size_t column = 0;
    for (const std::string &name : codegen::algorithm_names()) {
        if (column > 0 && column + 1 + name.size() > 105) column = (puts(""), 0);
        column += size_t(printf(column ? " %s" : "                      %s", name.c_str()));
    }
    printf("%s%s%s", help_more, settings_help, help_end);
}

/* A table of constraints, and who takes them: none without the other. */
int check_constraints(const options *o) {
    std::string taker;
    for (const std::string &name : o->algorithms)
        if (codegen::takes_constraints(name) && taker != "constrained_id") taker = name;
    if (!o->constraints && !taker.empty())
        return usage_error("--algorithm: '%s' needs --constraints FILE", taker.c_str());
    if (o->constraints && taker.empty())
        return usage_error("--constraints: no algorithm of the list takes them");
    if (o->stances && !o->constraints) return usage_error("--stances: needs --constraints FILE");
    if (o->stances && std::none_of(o->algorithms.begin(), o->algorithms.end(), codegen::takes_stances))
        return usage_error("--stances: no algorithm of the list takes them");
    if (o->stances && o->target.lanes > 1) return usage_error("--stances: not with --lanes");
    if (!o->passive.empty() && taker != "constrained_id")
        return usage_error("--passive: 'constrained_id' is not in the list");
    return 0;
}

/* The file's name without folder and ending. */
std::string stem(const char *path) {
    std::string s = file_name(path);
    return s.substr(0, s.find('.'));
}

/* A thread has one state, in registers: no vectors, calls or arrays. */
int prepare_cuda(options *o) {
    const struct {
        const char *name;
        bool is_given;
    } others[] = {{"--lanes", o->target.lanes > 1},
                  {"--limbs", o->target.limbs > 1},
                  {"--reproducible", o->target.is_reproducible},
                  {"--block", o->block_is_given},
                  {"--example", o->example}};
    for (const auto &x : others)
        if (x.is_given) return usage_error("--cuda: not with %s", x.name);
    o->target.is_bounded = true;
    o->target.long_sums = false;
    o->target.block = 1 << 30;
    return 0;
}

/* Returns 0 to go on, or 1 + the exit status to end with. */
int read_options(options *o, char **argv) {
    for (int i = 1; argv[i]; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return print_help(), 1;
        if (strcmp(argv[i], "--version") == 0) return puts("rbd-codegen " RBD_VERSION), 1;
        int status = read_own(o, argv, &i);
        if (status < 0) status = settings_read(&o->read, argv, &i);
        if (status < 0 && argv[i][0] == '-' && argv[i][1]) status = unknown_option(argv[i], options_helps);
        if (status < 0) {
            status = o->path ? usage_error("more than one file: '%s'", argv[i]) : 0;
            o->path = argv[i];
        }
        if (status > 0) return 1 + status;
    }
    if (!o->path) return 1 + usage_error("no file given");
    o->target.is_reproducible = o->robot.reproducible;
    if (o->target.limbs > 1 && o->target.lanes > 1)
        return 1 + usage_error("--limbs: the lanes are those of --lanes already");
    if (o->target.limbs > 1 && o->target.is_reproducible)
        return 1 + usage_error("--limbs: computes in another order than rbd.h, which --reproducible forbids");
    if (check_constraints(o) != 0) return 1 + EXIT_USAGE;
    o->target.long_sums = !o->short_sums && !o->target.is_reproducible;
    if (o->target.is_cuda && prepare_cuda(o) != 0) return 1 + EXIT_USAGE;
    if (o->target.name.empty()) o->target.name = stem(o->path);
    if (!is_identifier(o->target.name))
        return 1 + usage_error("'%s' is not a C identifier: give a --name", o->target.name.c_str());
    if (o->target.is_cuda && is_taken_in_cpp(o->target.name))
        return 1 +
               usage_error("--cuda: '%s' means something else in C++: give a --name", o->target.name.c_str());
    return 0;
}

/* ---- functions ---- */

/* Rows go through memory, which takes small robots longer than scalars in registers: M^-1 of the iiwa (7
   degrees of freedom) takes twice as long, that of HyQ (18) a fifth longer. But by rows HyQ's derivatives,
   which solve for 46 columns, take three fifths of the time, as does Atlas's M^-1 (36). The limits lie
   between. */
bool is_by_rows(const options &o, const std::string &name, int nv) {
    const int most_by_scalars = name == "fd_derivatives" ? 12 : 24;
    return nv > most_by_scalars && o.target.lanes == 1 && o.target.long_sums;
}

const double least = 0.001; /* that the largest entry of an output counts as */

/* Largest difference of an output relative to its largest entry; infinite if one is refused. */
double difference_of(const codegen::function &f, const std::vector<double> &x, const std::vector<double> &y) {
    if (x.empty() || y.empty()) return HUGE_VAL; /* a pivot near its limit */
    double worst = 0;
    size_t k = 0;
    for (const codegen::array &a : f.outputs) {
        double largest = least, difference = 0;
        for (const size_t end = k + size_t(a.size); k < end; k++) {
            const double d = std::fabs(x[k] - y[k]);
            if (!(d < HUGE_VAL)) return HUGE_VAL;
            largest = std::fmax(largest, std::fabs(y[k]));
            difference = std::fmax(difference, d);
        }
        worst = std::fmax(worst, difference / largest);
    }
    return worst;
}

template <class T> std::vector<double> results(const codegen::function &f, const codegen::example &e) {
    const std::vector<T> x = codegen::evaluate<T>(f, e.in, e.stance);
    return {x.begin(), x.end()};
}
template <class T> double error_of(const codegen::function &f, const codegen::example &e) {
    return difference_of(f, results<T>(f, e), e.out);
}

/* How far results go where arguments move by a last digit, as they do for a compiler that rounds elsewhere:
   of light links on heavy ones, or a long chain, much further than that. */
template <class T> double scatter_of(const codegen::function &f, const codegen::example &e) {
    codegen::example near = e;
    double digit = double(std::numeric_limits<T>::epsilon());
    for (std::vector<double> &x : near.in)
        for (double &y : x) y *= 1 + (digit = -digit);
    return difference_of(f, results<T>(f, near), results<T>(f, e));
}

/* To the bit what the written code computes. */
std::vector<double> exact_results(const codegen::function &f, const codegen::example &e) {
    return f.code.is_float ? results<float>(f, e) : results<double>(f, e);
}

const char too_few_digits[] = "this scalar has too few digits for the robot";

/* Records an algorithm and holds the record against rbd.h in some states: what is wrong is not written. */
codegen::tested record(const options *o, const std::string &algorithm) {
    codegen::compute(o->robot, algorithm, 0, 0); /* says where M is singular */
    const bool is_float = o->target.is_float;
    const auto recorded = is_float ? codegen::record_float : codegen::record_double;
    codegen::tested x = {recorded(o->robot, algorithm), {}, 0, least};
    if (o->robot.limbs_alike) x.f = codegen::pack_limbs(x.f, codegen::joints(o->robot), o->target.limbs);
    const size_t wanted = size_t(std::max(3, x.f.sets()));
    bool all_refused = true;
    for (unsigned state = 0; x.examples.size() < wanted; state++) {
        const int stance = int(x.examples.size()) % x.f.sets();
        codegen::example e = codegen::compute(o->robot, algorithm, state, stance);
        all_refused = all_refused && exact_results(x.f, e).empty();
        const double scatter = is_float ? scatter_of<float>(x.f, e) : scatter_of<double>(x.f, e);
        if (!(scatter < HUGE_VAL)) {
            if (state < 40 * wanted) continue;
            if (!all_refused) throw std::runtime_error(too_few_digits);
            if (x.f.rows_held == 0)
                throw std::runtime_error("the mass matrix is singular, in this scalar, in every state tried");
            throw std::runtime_error(std::string(o->constraints) + ": the " + std::to_string(e.rows) +
                                     " rows depend on each other in every state tried, their rank is " +
                                     std::to_string(e.rank) + ": hold fewer axes, or call rbd.h");
        }
        /* rbd.h and the record round more than once each: a hundred last digits. float rounds constants too;
           there this finds wrong formulas alone. */
        if (!(error_of<double>(x.f, e) < (is_float ? 0.05 : 1e-9 + 100 * scatter)))
            throw std::runtime_error(
                is_float ? too_few_digits
                         : "what was recorded is not what rbd.h computes; please report this");
        if (is_float) e.out = codegen::evaluate<double>(x.f, e.in, e.stance); /* of the rounded constants */
        const double error = is_float ? error_of<float>(x.f, e) : error_of<double>(x.f, e);
        x.tolerance = std::fmax(x.tolerance, std::fmax(error, scatter));
        x.examples.push_back(e);
    }
    if (o->target.is_reproducible) {
        x.tolerance = 0;
        for (codegen::example &e : x.examples) e.out = exact_results(x.f, e);
        return x;
    }
    int exponent; /* a power of two above: that is the same if the last bits of the errors are not */
    std::frexp(32 * x.tolerance + (is_float ? 1e-5 : 1e-13), &exponent);
    x.tolerance = std::ldexp(1, exponent);
    if (x.tolerance > 0.25) throw std::runtime_error(too_few_digits); /* zeros would pass the self-test */
    return x;
}

/* The same; an error names the algorithm. */
codegen::tested record_or_say(const options *o, const std::string &algorithm) {
    try {
        return record(o, algorithm);
    } catch (const std::runtime_error &e) {
        throw std::runtime_error(algorithm + ": " + e.what());
    }
}

/* The memory of constraints_read. */
struct held {
    std::vector<unsigned char> work;
    rbd_constraint *list = nullptr;
    void *set = nullptr;
    ~held() { free(list), free(set); }
};

/* ---- files ---- */

std::vector<std::string> begun; /* files */

/* Makes standard output the file NAME_ENDING, and begins it. */
void begin(const options *o, const robot *r, const char *ending, const char *what) {
    const std::string path = o->folder + o->target.name + "_" + ending;
    if (!freopen(path.c_str(), "w", stdout))
        throw std::runtime_error("cannot write " + path + ": " + std::strerror(errno));
    begun.push_back(path);
    printf("/* %s_%s - ", o->target.name.c_str(), ending);
    print_in_comment(r->urdf.name);
    printf(", %s\n", what);
    print_origin(r, "rbd-codegen " RBD_VERSION);
}

void end() {
    if (fflush(stdout) != 0 || ferror(stdout)) throw std::runtime_error("cannot write the output");
}

std::string upper(std::string s) {
    for (char &c : s) c = char(toupper(static_cast<unsigned char>(c)));
    return s;
}

/* What holds for all functions, to the end of the comment. */
void print_units(const options *o, const std::string &nv) {
    printf("   Units are SI, matrices row-major; coordinates and frames are those of rbd.h. Arrays must not\n"
           "   overlap. Functions that return int give 0, or, all results being 0 then, 1 + the degree of "
           "freedom\n"
           "   at which the mass matrix is singular, or -1 - that at which it is not a number");
    if (o->target.is_bounded) printf(", or\n   -1 - %s if an angle is out of range", nv.c_str());
    printf(". */\n");
}

void print_header(const options *o, const robot *r, const std::vector<codegen::tested> &functions) {
    const char *name = o->target.name.c_str();
    const std::string capitals = upper(o->target.name);
    const char *upper = capitals.c_str();
    begin(o, r, "code.h", "functions of this robot alone, straight-line code.");
    printf(
        "\n   Compile %s_code.c, a file of its own, as C, with\n"
        "       cc -O3 -march=native -c %s_code.c                               (a computer)\n"
        "       arm-none-eabi-gcc -O2 -mcpu=... -mfloat-abi=... -c %s_code.c    (a microcontroller)\n"
        "   without -ffast-math. With -D%s_SELFTEST it has int %s_selftest(void), which runs all functions\n"
        "   on known states: 0, or the number of the first that is wrong; with -D%s_SELFTEST_MAIN a main\n"
        "   too, which prints what it found.\n\n",
        name, name, name, upper, name, upper);
    if (o->target.is_reproducible)
        printf("   Every compiler, option and machine that rounds as IEEE 754 does gives the same bits: "
               "those of\n"
               "   rbd.h under RBD_REPRODUCIBLE, but for the signs of zeros. clang: not with "
               "-ffp-contract=fast.\n\n");
    print_units(o, capitals + "_NV");
    printf("#ifndef %s_CODE_H\n#define %s_CODE_H\n\n/* clang-format off */\n\n", upper, upper);
    print_c_indices(r, name);
    printf("\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n%s",
           codegen::declarations(functions, o->target).c_str());
    printf("extern int %s_selftest(void); /* with -D%s_SELFTEST */\n\n", name, upper);
    printf("#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
    end();
}

void print_source(const options *o, const robot *r, const std::vector<codegen::tested> &functions) {
    begin(o, r, "code.c", "see the header.");
    printf("*/\n/* clang-format off */\n#include \"%s_code.h\"\n%s", o->target.name.c_str(),
           codegen::definitions(functions, o->target).c_str());
    end();
}

void print_cuda(const options *o, const robot *r, const std::vector<codegen::tested> &functions) {
    const std::string name = o->target.name, capitals = upper(name);
    const char *upper = capitals.c_str();
    begin(o, r, "code.cuh", "functions of this robot alone, for CUDA and for a host.");
    printf(
        "\n   A function takes anything that [] reads and writes: arrays, pointers, what a layout gives. A "
        "kernel\n"
        "   computes one state in a thread, for n states:\n"
        "       %s_kernel<rbd::rows><<<(n + 127) / 128, 128, 0, stream>>>(n, ...);   (nvcc, clang, hipcc, "
        "NVRTC)\n"
        "       %s_kernel<rbd::rows>(n, ...);                                        (a host alone)\n"
        "   Blocks have at most RBD_THREADS threads, 128 unless it is defined. C++11; without fast math.\n\n",
        (name + "::" + functions[0].f.name).c_str(), (name + "::" + functions[0].f.name).c_str());
    print_units(o, "NV");
    printf("#ifndef %s_CODE_CUH\n#define %s_CODE_CUH\n\n/* clang-format off */\n\n", upper, upper);
    print_c_indices(r, name.c_str());
    printf("\n%s\n#endif\n", codegen::cuda_text(functions, o->target).c_str());
    end();
}

/* A bent pose, since a straight one has little to show: each joint is 0.5 from the neutral configuration,
   except a free base. */
std::vector<double> bent_pose(const rbd_model *model) {
    std::vector<double> q(size_t(rbd_nq(model))), turn(size_t(rbd_nv(model)), 0.5);
    for (int body = 0; body < rbd_nb(model); body++) {
        rbd_joint_info joint;
        rbd_joint(model, body, &joint);
        if (joint.type == RBD_FLOATING) std::fill_n(turn.begin() + joint.iv, joint.nv, 0.);
    }
    rbd_neutral(model, q.data());
    rbd_integrate(model, std::vector<double>(q).data(), turn.data(), 1, q.data());
    return q;
}

/* Of the first function, in a bent pose. */
void print_example(const options *o, const robot *r, const codegen::function &f) {
    const std::vector<double> q = bent_pose(r->model);
    begin(o, r, "example.c", "calls the first function and prints what it gives.");
    printf("       %s */\n%s", codegen::example_command(o->target.name).c_str(),
           codegen::example_text(f, o->target, q, {o->robot.gravity, o->robot.gravity + 3}).c_str());
    end();
}

/* Before the work, and not after it. */
void check_folder(const options *o) {
    std::error_code error;
    if (o->folder.empty() || std::filesystem::is_directory(o->folder, error)) return;
    throw std::runtime_error("--output: there is no folder '" + o->folder.substr(0, o->folder.size() - 1) +
                             "'");
}

/* All files or none: a header and a source of two runs would not fit. */
void write_files(const options *o, const robot *r, const std::vector<codegen::tested> &functions) {
    try {
        if (o->target.is_cuda) return print_cuda(o, r, functions);
        print_header(o, r, functions);
        print_source(o, r, functions);
        if (o->example) print_example(o, r, functions[0].f);
    } catch (const std::exception &) {
        for (const std::string &path : begun) std::remove(path.c_str());
        throw;
    }
}

void check_link(const robot *r, const std::string &algorithm) {
    const size_t colon = algorithm.find(':');
    char reason[REASON];
    if (colon == algorithm.npos || robot_link(r, algorithm.c_str() + colon + 1, reason) >= 0) return;
    throw std::runtime_error("--algorithm " + algorithm + ": " + reason);
}

/* The flags of constrained_id. */
std::vector<unsigned char> motors(const options *o, const rbd_model *m) {
    std::vector<unsigned char> all(o->passive.empty() ? 0 : size_t(rbd_nv(m)), 1);
    for (const char *name : o->passive) {
        rbd_joint_info x;
        nearest n = nearest_to(name);
        char hint[140];
        for (int b = 0; b < rbd_nb(m); b++)
            if (rbd_joint_name(m, b)) nearest_see(&n, rbd_joint_name(m, b), strlen(rbd_joint_name(m, b)));
        if (rbd_joint(m, rbd_joint_index(m, name), &x) != RBD_OK || x.nv == 0)
            throw std::runtime_error(std::string("--passive: the robot has no joint '") + name +
                                     "' that moves" + nearest_hint(&n, hint));
        for (int k = 0; k < x.nv; k++) all[size_t(x.iv + k)] = 0;
    }
    return all;
}

/* Adds the constraints of each link of a row. */
int add_stance(const csv *table, options *o, const robot *r) {
    std::vector<int> holds;
    if (o->robot.stances.size() == 32) return csv_error(table, "more than 32 stances");
    for (int k = 0; k < table->n; k++) {
        const std::string link = table->cells[k];
        char reason[REASON];
        if (link == "none" && table->n > 1) return csv_error(table, "'none' stands alone in its row");
        const int body = link == "none" ? -1 : robot_link(r, link.c_str(), reason);
        if (body < 0 && link != "none") return csv_error(table, "%s", reason);
        const size_t before = holds.size();
        for (int i = 0; i < o->robot.nc && body >= 0; i++)
            if (o->robot.constraints[i].body1 == body) holds.push_back(i);
        if (body >= 0 && holds.size() == before)
            return csv_error(table, "link '%s' is body1 of no constraint", link.c_str());
    }
    o->robot.stances.push_back(holds);
    return 0;
}

int read_table_of_stances(options *o, const robot *r) {
    csv table = {};
    int status;
    table.name = o->stances;
    table.from = fopen(o->stances, "r");
    if (!table.from)
        return fprintf(stderr, "%s: %s: %s\n", program, o->stances, std::strerror(errno)), EXIT_BAD;
    while ((status = csv_read(&table)) > 0 && (status = add_stance(&table, o, r)) == 0) {
    }
    if (status == 0 && o->robot.stances.empty()) status = csv_error(&table, "no stance: the table is empty");
    fclose(table.from);
    csv_free(&table);
    return status == 0 ? 0 : EXIT_BAD;
}

/* Reads the table; returns 0, or EXIT_BAD after a message. */
int hold(options *o, const robot *r, held *to) {
    rbd_work *w;
    rbd_constraint_set *set;
    if (!o->constraints) return 0;
    to->work.resize(rbd_work_size(r->model));
    rbd_work_init(r->model, to->work.data(), to->work.size(), &w);
    o->robot.nc = constraints_read(o->constraints, r, w, &to->list, &to->set, &set);
    o->robot.constraints = to->list;
    if (o->robot.nc < 0) return EXIT_BAD;
    if (o->robot.nc == 0)
        return fprintf(stderr, "%s: %s: no constraint: the table has a header alone\n", program,
                       o->constraints),
               EXIT_BAD;
    return o->stances ? read_table_of_stances(o, r) : 0;
}

int run(options *o) {
    robot r;
    held constraints;
    int status = robot_open(&r, o->path, &o->read);
    if (status == 0) status = hold(o, &r, &constraints);
    if (status == 0) {
        robot_print_warnings(&r);
        o->robot.bodies = r.urdf.bodies;
        o->robot.nb = r.urdf.nb;
        std::memcpy(o->robot.gravity, r.urdf.gravity, sizeof r.urdf.gravity);
        try {
            check_folder(o);
            o->robot.actuated = motors(o, r.model);
            for (const std::string &name : o->algorithms) check_link(&r, name);
            std::vector<codegen::tested> functions;
            if (o->target.limbs > 1)
                o->target.limbs = codegen::like_limbs(codegen::joints(o->robot), o->target.limbs);
            o->robot.limbs_alike = o->target.limbs > 1;
            for (const std::string &name : o->algorithms) {
                o->robot.by_rows = is_by_rows(*o, name, rbd_nv(r.model));
                functions.push_back(record_or_say(o, name));
            }
            if (o->example) puts(codegen::example_command(o->folder + o->target.name).c_str());
            write_files(o, &r, functions);
        } catch (const std::exception &e) {
            fprintf(stderr, "%s: %s\n", program, e.what());
            status = EXIT_BAD;
        }
    }
    robot_close(&r);
    return status;
}

} // namespace

int main(int argc, char **argv) {
    options o = {};
    o.target.lanes = 1;
    o.target.limbs = 1;
    o.target.block = 300;
    o.algorithms = {"id", "mm", "fd"};
    o.read = settings_new(argc, argv);
    int status = read_options(&o, argv);
    status = status ? status - 1 : run(&o);
    settings_free(&o.read);
    return status;
}
