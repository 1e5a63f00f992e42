/* The command line. SPDX-License-Identifier: MIT */
#include "bench.h"
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: rbd-bench [OPTION...]\n"
    "Verifies rbd's algorithms, then times them.\n"
    "\n"
    "  --robot NAME       iiwa, hyq, atlas or all (default all)\n"
    "  --model FILE       the robot of this URDF file instead of these\n"
    "  --floating         its root link is on a floating joint, not fixed to the world\n"
    "  --fixed-base       the base of hyq and atlas is fixed to the world, not floating\n"
    "  --algorithm NAME   id, mm, mm_packed, fd, fd_cholesky, hybrid, id_free_base, minv, jacobian,\n"
    "                     body_jacobian, momentum_matrix, coriolis, regressor, id_derivatives,\n"
    "                     id_derivatives_mm, fd_derivatives, constrained_fd, constrained_fd_hand or all\n"
    "                     (default all);\n"
    "                     rnea, crba and aba are other names of id, mm and fd\n"
    "  --scalar NAME      double, float or all (default double)\n"
    "  --variant NAME     run-time, generated, lanes, blocks, generated-lanes,\n"
    "                     generated-blocks, threads or all (default all)\n"
    "  --library NAME     rbd, mujoco, kdl or all (default all that this build has)\n"
    "  --samples N        random states per robot, a different one each call (default 100000)\n"
    "  --experiments N    how often all samples are timed, spread over the run (default 10)\n"
    "  --seed N           of the random states (default 1)\n"
    "  --gravity          with gravity (default without)\n"
    "  --cold             every call after other data and code have filled the caches up to level 2\n"
    "  --no-quad          without the error against quad precision, which takes most of a short run's time\n"
    "  --count SOURCE     count events instead of timing: perf (CSV), or callgrind (run under it)\n"
    "  --states           write the states and rbd's results instead of timing: for other programs\n"
    "  --format FORMAT    table, csv or json (default table)\n"
    "  --output FILE      write there instead of standard output\n"
    "  --help             this text\n"
    "  --version          version of rbd\n"
    "\n"
    "Exit status: 0 done, 1 a result is wrong or the run failed, 2 bad arguments.\n";

enum { MAX_COUNT = 1000000000 };

int usage_error(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fputs("rbd-bench: ", stderr);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputs("; try --help\n", stderr);
    return EXIT_USAGE;
}

/* ---- values: each reader takes the option's name for its message ---- */

/* Sets *index to the place of value among the names; a leading "all" is number ALL. */
static int read_name(const char *option, const char *value, const char *const *names, int *index) {
    int first = strcmp(names[0], "all") == 0 ? ALL : 0;
    char known[256] = "";
    for (int i = 0; names[i]; i++) {
        if (strcmp(value, names[i]) == 0) {
            *index = i + first;
            return 0;
        }
        size_t length = strlen(known);
        snprintf(known + length, sizeof known - length, "%s%s", i > 0 ? ", " : "", names[i]);
    }
    return usage_error("%s: unknown '%s' (known: %s)", option, value, known);
}

static int read_count(const char *option, const char *value, int *count) {
    char *end;
    errno = 0;
    long number = strtol(value, &end, 10);
    if (end == value || *end || errno || number < 1 || number > MAX_COUNT)
        return usage_error("%s: '%s' is not a positive number (up to %d)", option, value, MAX_COUNT);
    *count = (int)number;
    return 0;
}

/* ---- options with a value: each returns 0, or the exit status after a message ---- */

static int read_robot(struct options *o, const char *option, const char *value) {
    const char *names[MAX_ROBOTS + 2] = {"all"};
    for (int i = 0; i < MAX_ROBOTS && robot_names[i]; i++) names[i + 1] = robot_names[i];
    return read_name(option, value, names, &o->robot);
}

static int read_model(struct options *o, const char *option, const char *value) {
    (void)option;
    o->model = value;
    return 0;
}

static int read_algorithm(struct options *o, const char *option, const char *value) {
    const char *names[ALGORITHMS + 2] = {"all"};
    for (int i = 0; i < ALGORITHMS; i++) names[i + 1] = algorithms[i].name;
    static const char *const others[][2] = {{"rnea", "id"}, {"crba", "mm"}, {"aba", "fd"}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(value, others[i][0]) == 0) value = others[i][1];
    return read_name(option, value, names, &o->algorithm);
}

static int read_scalar(struct options *o, const char *option, const char *value) {
    const char *names[SCALARS + 2] = {"all"};
    for (int i = 0; i < SCALARS; i++) names[i + 1] = scalar_names[i];
    return read_name(option, value, names, &o->scalar);
}

static int read_variant(struct options *o, const char *option, const char *value) {
    const char *names[VARIANTS + 2] = {"all"};
    for (int i = 0; i < VARIANTS; i++) names[i + 1] = variant_names[i];
    return read_name(option, value, names, &o->variant);
}

static int read_library(struct options *o, const char *option, const char *value) {
    const char *names[LIBRARIES + 2] = {"all"};
    for (int i = 0; library_names[i]; i++) names[i + 1] = library_names[i];
    return read_name(option, value, names, &o->library);
}

static int read_format(struct options *o, const char *option, const char *value) {
    static const char *const names[] = {
        [FORMAT_TABLE] = "table", [FORMAT_CSV] = "csv", [FORMAT_JSON] = "json", NULL};
    int index = FORMAT_TABLE;
    int status = read_name(option, value, names, &index);
    o->format = (enum format)index;
    return status;
}

static int read_count_source(struct options *o, const char *option, const char *value) {
    static const char *const names[] = {
        [COUNT_NONE] = "none", [COUNT_PERF] = "perf", [COUNT_CALLGRIND] = "callgrind", NULL};
    int index = COUNT_NONE;
    int status = read_name(option, value, names, &index);
    o->count = (enum count)index;
    return status;
}

static int read_samples(struct options *o, const char *option, const char *value) {
    return read_count(option, value, &o->samples);
}

static int read_experiments(struct options *o, const char *option, const char *value) {
    return read_count(option, value, &o->experiments);
}

static int read_seed(struct options *o, const char *option, const char *value) {
    char *end;
    errno = 0;
    unsigned long long number = strtoull(value, &end, 10);
    if (value[0] < '0' || value[0] > '9' || *end || errno || number > UINT64_MAX)
        return usage_error("%s: '%s' is not a whole number from 0 to 2^64 - 1", option, value);
    o->seed = number;
    return 0;
}

static int read_output(struct options *o, const char *option, const char *value) {
    if (!*value) return usage_error("%s: the file name is empty", option);
    o->output = value;
    return 0;
}

/* ---- the command line ---- */

struct option {
    const char *name;
    int (*read)(struct options *o, const char *option, const char *value);
};

static const struct option with_value[] = {
    {"--robot", read_robot},
    {"--algorithm", read_algorithm},
    {"--samples", read_samples},
    {"--seed", read_seed},
    {"--experiments", read_experiments},
    {"--format", read_format},
    {"--output", read_output},
    {"--scalar", read_scalar},
    {"--variant", read_variant},
    {"--library", read_library},
    {"--model", read_model},
    {"--count", read_count_source},
};

/* The option that the argument, "--name" or "--name=value", begins with. */
static const struct option *find_option(const char *argument) {
    size_t length = strcspn(argument, "=");
    for (size_t i = 0; i < sizeof with_value / sizeof *with_value; i++)
        if (strlen(with_value[i].name) == length && strncmp(argument, with_value[i].name, length) == 0)
            return &with_value[i];
    return NULL;
}

/* Reads argument number *i, and its value, which may be the next one. Returns -1 to go on. */
static int read_argument(struct options *o, char **argv, int *i) {
    const char *argument = argv[*i];
    const struct option *option = find_option(argument);
    if (option) {
        const char *equals = strchr(argument, '=');
        const char *value = equals ? equals + 1 : argv[++*i];
        int status = value ? option->read(o, option->name, value)
                           : usage_error("%s: its value is missing", option->name);
        return status == 0 ? -1 : status;
    }
    if (strcmp(argument, "--gravity") == 0) {
        o->gravity = true;
        return -1;
    }
    if (strcmp(argument, "--cold") == 0) {
        o->cold = true;
        return -1;
    }
    if (strcmp(argument, "--no-quad") == 0) {
        o->no_quad = true;
        return -1;
    }
    if (strcmp(argument, "--states") == 0) {
        o->states = true;
        return -1;
    }
    if (strcmp(argument, "--floating") == 0) {
        o->floating = true;
        return -1;
    }
    if (strcmp(argument, "--fixed-base") == 0) {
        o->fixed_base = true;
        return -1;
    }
    if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0)
        return fputs(help, stdout) < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
    if (strcmp(argument, "--version") == 0)
        return puts("rbd-bench " RBD_VERSION) < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
    return usage_error("unknown %s '%s'", argument[0] == '-' ? "option" : "argument", argument);
}

int options_read(struct options *o, int argc, char **argv) {
    *o = (struct options){.robot = ALL,
                          .algorithm = ALL,
                          .scalar = DOUBLE,
                          .variant = ALL,
                          .library = ALL,
                          .samples = 100000,
                          .experiments = 10,
                          .seed = 1};
    for (int i = 1; i < argc; i++) {
        int status = read_argument(o, argv, &i);
        if (status >= 0) return status;
    }
    if (o->model && o->robot != ALL) return usage_error("--model: it stands instead of --robot");
    if (o->cold && o->count != COUNT_NONE) return usage_error("--cold: it belongs to times, not to --count");
    if (o->states && o->count != COUNT_NONE) return usage_error("--states: it stands instead of --count");
    if (o->fixed_base && o->model) return usage_error("--fixed-base: --model has it so without --floating");
    if (o->floating && !o->model) return usage_error("--floating: it belongs to --model");
    return -1;
}
