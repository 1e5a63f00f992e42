/* rbd-model: looks at a robot's URDF file, and turns it into C tables. SPDX-License-Identifier: MIT */
#include "constraints.h"
#include "print.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *program = "rbd-model";

static const char help[] =
    "usage: rbd-model [OPTION...] FILE\n"
    "\n"
    "Prints a summary of a robot's file, URDF or MJCF (- is standard input): links, joints, masses, odd "
    "data.\n"
    "With one of these it writes something else to standard output, and the warnings to standard error:\n"
    "  --c NAME            the description, NAME_bodies, a C table for rbd_model_build\n"
    "  --c-model NAME      the built model, NAME_model and NAME_FEATURES, a C table for firmware\n"
    "  --urdf              URDF of what dynamics needs, fixed links merged\n"
    "  --dot               the tree, for Graphviz: rbd-model --dot FILE | dot -Tsvg\n"
    "  --check             nothing: only the messages and the exit status\n"
    "  --constraints FILE  with --c or --c-model: NAME_constraints too, a C table for "
    "rbd_constraint_set_init, "
    "of\n"
    "                      the table of constraints that rbd-eval reads, in place of those of an MJCF file\n"
    "How the file is read:\n";
static const char help_end[] =
    "\n"
    "Exit status: 0, 1 if the file has an error (with --strict: or a warning), 2 for bad arguments.\n";

typedef enum output { SUMMARY, C, C_MODEL, URDF, DOT, CHECK } output;

typedef struct options {
    output output;
    const char *name; /* of the C table */
    const char *path, *constraints;
    settings settings;
} options;

static int is_identifier(const char *s) {
    if (!isalpha((unsigned char)*s) && *s != '_') return 0;
    while (isalnum((unsigned char)*s) || *s == '_') s++;
    return *s == 0;
}

static int read_name(options *o, char **argv, int *i) {
    const char *option = argv[*i];
    o->name = option_value(argv, i);
    if (!o->name) return EXIT_USAGE;
    return is_identifier(o->name)
               ? 0
               : usage_error("%s: '%s' is not a C identifier: it takes the name of the table", option,
                             o->name);
}

/* Reads an option that says what to write; -1 if the argument is none. */
static int read_output(options *o, char **argv, int *i) {
    static const struct {
        const char *name;
        output output;
    } outputs[] = {{"--c", C}, {"--c-model", C_MODEL}, {"--urdf", URDF}, {"--dot", DOT}, {"--check", CHECK}};
    for (size_t k = 0; k < sizeof outputs / sizeof *outputs; k++) {
        const int named = outputs[k].output == C || outputs[k].output == C_MODEL;
        if (named ? !option_is(argv[*i], outputs[k].name) : strcmp(argv[*i], outputs[k].name) != 0) continue;
        if (o->output != SUMMARY) return usage_error("%s: there is only one output", argv[*i]);
        o->output = outputs[k].output;
        return named ? read_name(o, argv, i) : 0;
    }
    return -1;
}

/* Returns 0 to go on, or 1 + the exit status to end with. */
static int read_options(options *o, char **argv) {
    for (int i = 1; argv[i]; i++) {
        int status;
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            printf("%s%s%s", help, settings_help, help_end);
            return 1 + EXIT_SUCCESS;
        }
        if (strcmp(argv[i], "--version") == 0) {
            puts("rbd-model " RBD_VERSION);
            return 1 + EXIT_SUCCESS;
        }
        if (option_is(argv[i], "--constraints")) {
            o->constraints = option_value(argv, &i);
            if (!o->constraints) return 1 + EXIT_USAGE;
            continue;
        }
        status = read_output(o, argv, &i);
        if (status < 0) status = settings_read(&o->settings, argv, &i);
        if (status < 0 && argv[i][0] == '-' && argv[i][1])
            status = unknown_option(argv[i], (const char *const[]){help, settings_help, NULL});
        if (status < 0) {
            status = o->path ? usage_error("more than one file: '%s'", argv[i]) : 0;
            o->path = argv[i];
        }
        if (status > 0) return 1 + status;
    }
    if (o->settings.urdf.gravity && (o->output == C || o->output == URDF || o->output == DOT))
        return 1 + usage_error("--gravity: only the built model has gravity (--c-model)");
    if (o->constraints && o->output != C && o->output != C_MODEL)
        return 1 + usage_error("--constraints: only a C table has them (--c, --c-model)");
    if (!o->path && o->settings.nlock)
        return 1 + usage_error("no file given (--lock takes a joint, --lock-massless nothing)");
    return o->path ? 0 : 1 + usage_error("no file given");
}

static void print_output(const options *o, const robot *r) {
    switch (o->output) {
    case SUMMARY: print_summary(r); break;
    case C: print_c(r, o->name); break;
    case C_MODEL: print_c_model(r, o->name); break;
    case URDF: print_urdf(r); break;
    case DOT: print_dot(r); break;
    case CHECK: break;
    }
}

/* The constraints of a table, before anything is written; returns how many, or -1 after a message. */
static int read_constraints(const options *o, const robot *r, rbd_constraint **list) {
    const size_t size = rbd_work_size(r->model);
    void *work_memory = allocate(size, 1), *memory = NULL;
    rbd_constraint_set *c;
    rbd_work *w;
    int n = -1;
    if (rbd_work_init(r->model, work_memory, size, &w) == RBD_OK)
        n = constraints_read(o->constraints, r, w, list, &memory, &c);
    free(memory);
    free(work_memory);
    return n;
}

/* What a file says and an output of this kind cannot: a ball joint in URDF, gravity but in a built model. */
static int check_output(const options *o, const robot *r) {
    const double *g = r->urdf.gravity;
    if (o->output == C || o->output == URDF)
        if (g[0] != 0 || g[1] != 0 || g[2] != -9.81)
            fprintf(stderr, "%s: warning: gravity %g,%g,%g of the file is not in this output\n", r->path,
                    g[0], g[1], g[2]);
    for (int i = 0; o->output == URDF && i < r->urdf.nb; i++) {
        if (r->urdf.bodies[i].type != RBD_SPHERICAL) continue;
        fprintf(stderr, "%s: error: --urdf: joint '%s' is a ball, which URDF has not\n", r->path,
                r->urdf.bodies[i].joint);
        return EXIT_BAD;
    }
    return 0;
}

static int run(const options *o) {
    robot r;
    rbd_constraint *list = NULL;
    int n = 0, status = robot_open(&r, o->path, &o->settings);
    const int with_constraints = o->output == C || o->output == C_MODEL;
    if (status == 0 && o->constraints && (n = read_constraints(o, &r, &list)) < 0) status = EXIT_BAD;
    if (status == 0) status = check_output(o, &r);
    if (status == 0) {
        if (o->output != SUMMARY) robot_print_warnings(&r);
        print_output(o, &r);
        if (o->constraints)
            print_c_constraints(&r, o->name, list, n);
        else if (with_constraints && r.nconstraints > 0)
            print_c_constraints(&r, o->name, r.constraints, r.nconstraints);
        if (fflush(stdout) != 0 || ferror(stdout)) {
            fprintf(stderr, "%s: cannot write the output\n", program);
            status = EXIT_BAD;
        }
    }
    free(list);
    robot_close(&r);
    return status;
}

int main(int argc, char **argv) {
    options o = {0};
    int status;
    o.settings = settings_new(argc, argv);
    status = read_options(&o, argv);
    status = status ? status - 1 : run(&o);
    settings_free(&o.settings);
    return status;
}
