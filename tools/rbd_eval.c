/* rbd-eval: evaluates an algorithm on states given as a table, to check one library against another.
   SPDX-License-Identifier: MIT */
#include "csv.h"
#include "print.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *program = "rbd-eval";

static const char help[] =
    "usage: rbd-eval --model FILE.urdf --algorithm NAME [OPTION...] < states.csv > results.csv\n"
    "\n"
    "Evaluates an algorithm on every row of a table of states, 17 digits out. The first row of a table "
    "names\n"
    "its columns; they may stand in any order, and those that are not needed are skipped.\n"
    "\n"
    "  name         what                                   takes     gives\n"
    "  id           inverse dynamics (RNEA)                q v a     tau.DOF\n"
    "  mm           mass matrix (CRBA)                     q         M.DOF.DOF, row by row\n"
    "  fd           forward dynamics (ABA)                 q v tau   a.DOF\n"
    "  fd_cholesky  forward dynamics (CRBA and Cholesky)   q v tau   a.DOF\n"
    "  bias         inverse dynamics with a = 0            q v       tau.DOF\n"
    "  gravity      inverse dynamics with v = a = 0        q         tau.DOF\n"
    "  pose         of every link in the world             q         p.LINK.x ... R.LINK.xx ..., row by row\n"
    "  energy       kinetic and potential                  q v       kinetic, potential\n"
    "  com          centre of mass and its velocity        q v       com.x ... com_v.x ...\n"
    "\n"
    "A joint of one degree of freedom has the columns q.JOINT, v.JOINT, a.JOINT, tau.JOINT. A floating "
    "joint\n"
    "has q.JOINT.x y z qx qy qz qw and v.JOINT.wx wy wz vx vy vz, in body axes, a planar one q.JOINT.x y "
    "angle\n"
    "and v.JOINT.w vx vy. a and tau are named as v: tau.JOINT.wx is the moment about x, tau.JOINT.vx the "
    "force\n"
    "along x. The root link's floating joint is called root. pose leaves out a massless root link called "
    "world\n"
    "that does not float: it is the world.\n"
    "\n"
    "  --model FILE        of the robot\n"
    "  --algorithm NAME    one of these; rnea, crba and aba are id, mm and fd\n"
    "  --layout            only print the names that the algorithm takes and gives\n";
static const char help_end[] =
    "\n"
    "Exit status: 0, 1 for a bad file or row, which is named, 2 for bad arguments.\n";

/* ---- algorithms ---- */

enum { TAKES_V = 1, TAKES_A = 2, TAKES_TAU = 4 };
typedef enum gives { GIVES_TAU, GIVES_M, GIVES_A, GIVES_POSE, GIVES_ENERGY, GIVES_COM } gives;

/* A state, and what a call needs. */
typedef struct state {
    const rbd_model *m;
    rbd_work *w;
    double *q, *v, *a, *tau;
} state;

static rbd_status run_id(const state *s, double *out) {
    return rbd_rnea(s->m, s->w, s->q, s->v, s->a, NULL, out);
}
static rbd_status run_mm(const state *s, double *out) { return rbd_crba(s->m, s->w, s->q, out); }
static rbd_status run_fd(const state *s, double *out) {
    return rbd_aba(s->m, s->w, s->q, s->v, s->tau, NULL, out);
}
static rbd_status run_fd_cholesky(const state *s, double *out) {
    return rbd_fd_cholesky(s->m, s->w, s->q, s->v, s->tau, NULL, out);
}
static rbd_status run_bias(const state *s, double *out) {
    return rbd_bias(s->m, s->w, s->q, s->v, NULL, out);
}
static rbd_status run_gravity(const state *s, double *out) { return rbd_gravity(s->m, s->w, s->q, out); }

static rbd_status run_pose(const state *s, double *out) {
    rbd_status status = rbd_kinematics(s->m, s->w, s->q, NULL, NULL);
    for (int i = 0; i < rbd_nb(s->m); i++) {
        if (!rbd_body_name(s->m, i)) continue;
        rbd_body_pose(s->m, s->w, i, out + 3, out);
        out += 12;
    }
    return status;
}
static rbd_status run_energy(const state *s, double *out) {
    rbd_kinematics(s->m, s->w, s->q, s->v, NULL);
    return rbd_energy(s->m, s->w, &out[0], &out[1]);
}
static rbd_status run_com(const state *s, double *out) {
    rbd_kinematics(s->m, s->w, s->q, s->v, NULL);
    return rbd_com(s->m, s->w, out, out + 3, NULL);
}

typedef struct algorithm {
    const char *name;
    int takes; /* beside q */
    gives gives;
    rbd_status (*run)(const state *s, double *out);
} algorithm;

static const algorithm algorithms[] = {
    {"id", TAKES_V | TAKES_A, GIVES_TAU, run_id},
    {"mm", 0, GIVES_M, run_mm},
    {"fd", TAKES_V | TAKES_TAU, GIVES_A, run_fd},
    {"fd_cholesky", TAKES_V | TAKES_TAU, GIVES_A, run_fd_cholesky},
    {"bias", TAKES_V, GIVES_TAU, run_bias},
    {"gravity", 0, GIVES_TAU, run_gravity},
    {"pose", 0, GIVES_POSE, run_pose},
    {"energy", TAKES_V, GIVES_ENERGY, run_energy},
    {"com", TAKES_V, GIVES_COM, run_com},
};

static const algorithm *find_algorithm(const char *name) {
    static const char *const others[][2] = {{"rnea", "id"}, {"crba", "mm"}, {"aba", "fd"}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(others[i][0], name) == 0) name = others[i][1];
    for (size_t i = 0; i < sizeof algorithms / sizeof *algorithms; i++)
        if (strcmp(algorithms[i].name, name) == 0) return &algorithms[i];
    return NULL;
}

/* ---- names of columns ---- */

typedef struct columns {
    char **name;
    int n, max;
} columns;

/* Adds "first.second.third.fourth"; those that are empty are left out. */
static void add_name(columns *c, const char *first, const char *second, const char *third,
                     const char *fourth) {
    const char *const parts[] = {first, second, third, fourth};
    size_t length = 1;
    char *name;
    for (int i = 0; i < 4; i++) length += strlen(parts[i]) + 1;
    name = allocate(length, 1);
    for (int i = 0; i < 4; i++) {
        if (*parts[i] && *name) strcat(name, ".");
        strcat(name, parts[i]);
    }
    if (c->n == c->max) {
        char **larger = allocate((size_t)(c->max = 2 * c->max + 64), sizeof *larger);
        if (c->n) memcpy(larger, c->name, (size_t)c->n * sizeof *larger);
        free(c->name);
        c->name = larger;
    }
    c->name[c->n++] = name;
}

static void free_columns(columns *c) {
    for (int i = 0; i < c->n; i++) free(c->name[i]);
    free(c->name);
}

static void add_coordinates(columns *c, const rbd_model *m) {
    for (int b = 0; b < rbd_nb(m); b++) {
        rbd_joint_info info;
        rbd_joint(m, b, &info);
        for (int k = 0; k < info.nq; k++)
            add_name(c, "q", rbd_joint_name(m, b), coordinate_names(info.type)[k], "");
    }
}

/* Names of all degrees of freedom, each after what stands before. */
static void add_dofs(columns *c, const rbd_model *m, const char *before, const char *between) {
    for (int b = 0; b < rbd_nb(m); b++) {
        rbd_joint_info info;
        rbd_joint(m, b, &info);
        for (int k = 0; k < info.nv; k++)
            add_name(c, before, between, rbd_joint_name(m, b), dof_names(info.type)[k]);
    }
}

static void add_matrix(columns *c, const rbd_model *m) {
    columns rows = {0};
    add_dofs(&rows, m, "", "");
    for (int i = 0; i < rows.n; i++) add_dofs(c, m, "M", rows.name[i]);
    free_columns(&rows);
}

static void add_poses(columns *c, const rbd_model *m) {
    static const char *const p[] = {"x", "y", "z"};
    static const char *const R[] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
    for (int b = 0; b < rbd_nb(m); b++) {
        const char *link = rbd_body_name(m, b);
        for (int k = 0; link && k < 3; k++) add_name(c, "p", link, p[k], "");
        for (int k = 0; link && k < 9; k++) add_name(c, "R", link, R[k], "");
    }
}

static void add_inputs(columns *c, const rbd_model *m, const algorithm *a) {
    add_coordinates(c, m);
    if (a->takes & TAKES_V) add_dofs(c, m, "v", "");
    if (a->takes & TAKES_A) add_dofs(c, m, "a", "");
    if (a->takes & TAKES_TAU) add_dofs(c, m, "tau", "");
}

static void add_outputs(columns *c, const rbd_model *m, const algorithm *a) {
    static const char *const com[] = {"com.x", "com.y", "com.z", "com_v.x", "com_v.y", "com_v.z"};
    switch (a->gives) {
    case GIVES_TAU: add_dofs(c, m, "tau", ""); break;
    case GIVES_A: add_dofs(c, m, "a", ""); break;
    case GIVES_M: add_matrix(c, m); break;
    case GIVES_POSE: add_poses(c, m); break;
    case GIVES_ENERGY: add_name(c, "kinetic", "", "", ""), add_name(c, "potential", "", "", ""); break;
    case GIVES_COM:
        for (int k = 0; k < 6; k++) add_name(c, com[k], "", "", "");
    }
}

/* ---- rows ---- */

/* The first names of a header, "'a', 'b', ...", as many as fit. */
static void list_cells(const csv *header, char *text, size_t size) {
    size_t length = 0;
    for (int k = 0; k < header->n; k++) {
        const char *before = k ? ", " : "";
        if (length + strlen(header->cells[k]) + 10 > size) {
            snprintf(text + length, size - length, "%s...", before);
            return;
        }
        length += (size_t)snprintf(text + length, size - length, "%s'%s'", before, header->cells[k]);
    }
}

static int report_missing(const csv *header, const char *name) {
    char found[120];
    list_cells(header, found, sizeof found);
    return csv_error(header, "column '%s' is missing (--layout prints all); found, between commas: %s", name,
                     found);
}

/* Finds every name in the header: where[i] is the cell of name i. Returns 0, or -1 after a message. */
static int find_columns(const csv *header, const columns *names, int *where) {
    for (int i = 0; i < names->n; i++) {
        where[i] = -1;
        for (int k = 0; k < header->n; k++) {
            if (strcmp(header->cells[k], names->name[i]) != 0) continue;
            if (where[i] >= 0) return csv_error(header, "column '%s' stands twice", names->name[i]);
            where[i] = k;
        }
        if (where[i] < 0) return report_missing(header, names->name[i]);
    }
    return 0;
}

/* Reads the numbers of a row, in the order of the names. */
static int read_numbers(const csv *row, const columns *names, const int *where, double *x) {
    for (int i = 0; i < names->n; i++) {
        const char *cell = row->cells[where[i]];
        char *end;
        x[i] = strtod(cell, &end);
        if (end == cell || *end || !isfinite(x[i]))
            return csv_error(row, "column '%s': '%s' is not a finite number", names->name[i], cell);
    }
    return 0;
}

static int report_failure(const csv *row, const state *s, const columns *outputs, rbd_status status) {
    const int dof = status == RBD_ERR_SINGULAR || status == RBD_ERR_NAN ? rbd_singular_dof(s->w) : -1;
    if (dof >= 0 && dof < outputs->n)
        return csv_error(row, "%s, at %s", rbd_status_string(status),
                         outputs->name[dof] + 2); /* without "a." */
    return csv_error(row, "%s", rbd_status_string(status));
}

static void print_names(const columns *c) {
    for (int i = 0; i < c->n; i++) csv_print(c->name[i], i == 0);
    printf("\n");
}

static void print_numbers(const double *x, int n) {
    for (int i = 0; i < n; i++) printf("%s%.17g", i ? "," : "", x[i]);
    printf("\n");
}

/* All rows after the header. Returns 0, or -1 after a message. */
static int evaluate(csv *table, const algorithm *a, state *s, const columns *in, const columns *out) {
    int *where = allocate((size_t)in->n, sizeof *where);
    double *x = allocate((size_t)in->n, sizeof *x), *y = allocate((size_t)out->n, sizeof *y);
    const int width = table->n, nv = rbd_nv(s->m);
    int status = find_columns(table, in, where), named = 0;
    s->q = x;
    s->v = s->a = s->tau = x + rbd_nq(s->m);
    if (a->takes & TAKES_V) s->a = s->tau = s->v + nv;
    while (status == 0 && (status = csv_read(table)) > 0) {
        rbd_status result;
        if (table->n != width)
            status = csv_error(table, "it has %d cell%s, the header %d", table->n, table->n == 1 ? "" : "s",
                               width);
        else
            status = read_numbers(table, in, where, x);
        if (status != 0) break;
        result = a->run(s, y);
        if (result != RBD_OK) {
            status = report_failure(table, s, out, result);
            break;
        }
        if (!named++) /* not before it is known that a row is good */
            print_names(out);
        print_numbers(y, out->n);
    }
    if (status == 0 && !named) print_names(out);
    free(where);
    free(x);
    free(y);
    return status;
}

static int read_table(const algorithm *a, state *s, const columns *in, const columns *out) {
    csv table = {0};
    int status = csv_read(&table);
    if (status == 0) {
        fprintf(stderr, "%s: no header: the table is empty\n", program);
        status = -1;
    } else if (status > 0) {
        status = evaluate(&table, a, s, in, out);
    }
    csv_free(&table);
    return status == 0 ? 0 : EXIT_BAD;
}

/* ---- command ---- */

typedef struct options {
    const char *model;
    const algorithm *algorithm;
    int layout;
    settings settings;
} options;

static int read_own(options *o, char **argv, int *i) {
    const char *value;
    if (strcmp(argv[*i], "--layout") == 0) {
        o->layout = 1;
        return 0;
    }
    if (option_is(argv[*i], "--model")) return (o->model = option_value(argv, i)) ? 0 : EXIT_USAGE;
    if (!option_is(argv[*i], "--algorithm")) return -1;
    value = option_value(argv, i);
    if (!value) return EXIT_USAGE;
    o->algorithm = find_algorithm(value);
    return o->algorithm ? 0 : usage_error("--algorithm: there is no '%s'", value);
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
            puts("rbd-eval " RBD_VERSION);
            return 1 + EXIT_SUCCESS;
        }
        status = read_own(o, argv, &i);
        if (status < 0) status = settings_read(&o->settings, argv, &i);
        if (status < 0) status = usage_error("unknown argument '%s'", argv[i]);
        if (status > 0) return 1 + status;
    }
    if (!o->model) return 1 + usage_error("--model is missing");
    if (!o->layout && strcmp(o->model, "-") == 0)
        return 1 + usage_error("--model: standard input has the table, so it cannot have the robot");
    return o->algorithm ? 0 : 1 + usage_error("--algorithm is missing");
}

static void print_layout(const columns *in, const columns *out) {
    for (int i = 0; i < in->n; i++) printf("takes %s\n", in->name[i]);
    for (int i = 0; i < out->n; i++) printf("gives %s\n", out->name[i]);
}

static int run_on(const options *o, const robot *r) {
    columns in = {0}, out = {0};
    state s = {r->model, NULL, NULL, NULL, NULL, NULL};
    const size_t size = rbd_work_size(r->model);
    void *memory = allocate(size, 1);
    int status = 0;
    rbd_work_init(s.m, memory, size, &s.w);
    add_inputs(&in, s.m, o->algorithm);
    add_outputs(&out, s.m, o->algorithm);
    if (o->layout)
        print_layout(&in, &out);
    else
        status = read_table(o->algorithm, &s, &in, &out);
    free_columns(&in);
    free_columns(&out);
    free(memory);
    return status;
}

static int run(options *o) {
    robot r;
    int status;
    if (o->algorithm->gives == GIVES_POSE) o->settings.urdf.keep_all = 1;
    status = robot_open(&r, o->model, &o->settings);
    if (status == 0) {
        robot_print_warnings(&r);
        status = run_on(o, &r);
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "%s: cannot write the output\n", program);
        status = EXIT_BAD;
    }
    robot_close(&r);
    return status;
}

int main(int argc, char **argv) {
    options o = {0};
    int status;
    o.settings = settings_new(argc);
    status = read_options(&o, argv);
    status = status ? status - 1 : run(&o);
    settings_free(&o.settings);
    return status;
}
