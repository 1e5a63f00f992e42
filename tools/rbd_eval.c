/* rbd-eval: evaluates an algorithm on states given as a table, to check one library against another.
   SPDX-License-Identifier: MIT */
#include "algorithms.h"
#include "constraints.h"
#include "csv.h"
#include "nearest.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *program = "rbd-eval";

static const char help[] =
    "usage: rbd-eval FILE --algorithm NAME [OPTION...] < states.csv > results.csv\n"
    "\n"
    "Evaluates an algorithm on every row of a table of states, with 17 digits. The first row of a table "
    "names\n"
    "its columns; they may stand in any order, and those that are not needed are skipped.\n"
    "\n";
static const char help_columns[] =
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
    "ROW is wx wy wz vx vy vz: rotation first, then translation, or moment and force, along world axes; of "
    "h about\n"
    "the centre of mass; of f in link axes, at its origin. PAR is m mx my mz (mass, times centre of mass)\n"
    "ixx ixy ixz iyy iyz izz (about the link's origin), in link axes. Matrices row by row; column k of a\n"
    "derivative by q is along the step v = e_k.\n"
    "\n"
    "  --model FILE        the same as FILE alone\n"
    "  --algorithm NAME    one of these; rnea, crba and aba are id, mm and fd\n"
    "  --body LINK         that has the point of jacobian and point\n"
    "  --point X,Y,Z       in the link's axes, m (0,0,0)\n"
    "  --given DOF         its a is given in hybrid, of all others tau; a joint's name for all of its; may "
    "stand\n"
    "                      several times\n"
    "  --constraints FILE  table of constraints, for constrained_fd: a row each with the columns body1 and "
    "axes, "
    "and of\n"
    "                      body2 x1 y1 z1 x2 y2 z2 r1_0 ... r1_8 r2_0 ... r2_8 kp kd those that are wanted: "
    "two "
    "links\n"
    "                      (world), origin (0) and rotation (identity), row by row, of a frame on each; the "
    "axes "
    "of\n"
    "                      the second that are held, six characters 0 or 1 in the order of ROW. lambda.0 is "
    "the "
    "first\n"
    "                      of them. docs/tools.md has examples\n"
    "  --contacts FILE     table of contacts, for contact_step: a row each with the column body1, and of "
    "name "
    "body2\n"
    "                      x y z nx ny nz height radius friction restitution stiffness damping those that "
    "are "
    "wanted:\n"
    "                      a point (0) of link body1, or a ball about it, over a plane of link body2 (world) "
    "with this\n"
    "                      normal (z). TOUCH is state (0 apart, 1 opens, 2 sticks, 3 slips) gap fx fy fz. "
    "--constraints\n"
    "                      adds loops that hold\n"
    "  --dt SECONDS        of contact_step (0.001)\n"
    "  --layout            only print the names that the algorithm takes and gives\n";
static const char help_end[] =
    "\n"
    "Exit status: 0, 1 for a bad file or row, which is named, 2 for bad arguments.\n";

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

static int is_name(const columns *names, const char *cell) {
    for (int i = 0; i < names->n; i++)
        if (strcmp(names->name[i], cell) == 0) return 1;
    return 0;
}

static int report_missing(const csv *header, const columns *names, const char *name) {
    char found[120];
    nearest n = nearest_to(name);
    for (int k = 0; k < header->n; k++)
        if (!is_name(names, header->cells[k])) nearest_see(&n, header->cells[k], strlen(header->cells[k]));
    list_cells(header, found, sizeof found);
    if (header->n == 1 && strpbrk(header->cells[0], ";\t")) return csv_separators(header);
    if (*n.best)
        return csv_error(header, "column '%s' is missing (--layout prints all); is '%s' meant for it?", name,
                         n.best);
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
        if (where[i] < 0) return report_missing(header, names, names->name[i]);
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

/* Of dynamics with --kinematic. */
static int report_massless(const csv *row, const state *s) {
    const int body = rbd_dof_body(s->m, rbd_singular_dof(s->w));
    const char *joint = rbd_joint_name(s->m, body), *link = rbd_body_name(s->m, body);
    return csv_error(row,
                     "dynamics needs masses, and joint '%s', which carries link '%s', moves none: with "
                     "--kinematic there are poses and Jacobians alone",
                     joint ? joint : "", link ? link : "");
}

static int report_failure(const csv *row, const state *s, rbd_status status) {
    const int dof = status == RBD_ERR_SINGULAR || status == RBD_ERR_NAN ? rbd_singular_dof(s->w) : -1;
    columns dofs = {0};
    if (status == RBD_ERR_MASSLESS) return report_massless(row, s);
    if (status == RBD_ERR_INFEASIBLE)
        return csv_error(row, "%s, at lambda.%d", rbd_status_string(status), rbd_infeasible_row(s->c));
    if (dof < 0) return csv_error(row, "%s", rbd_status_string(status));
    add_dofs(&dofs, s->m, "");
    csv_error(row, "%s, at %s", rbd_status_string(status), dofs.name[dof]);
    free_columns(&dofs);
    return -1;
}

static void print_names(const columns *c) {
    for (int i = 0; i < c->n; i++) csv_print(c->name[i], i == 0);
    printf("\n");
}

/* Numbers too large to compute with. */
static int report_overflow(const csv *row, const columns *out, const double *y) {
    for (int i = 0; i < out->n; i++)
        if (!isfinite(y[i])) return csv_error(row, "the result '%s' overflows", out->name[i]);
    return 0;
}

static void print_numbers(const double *x, int n) {
    for (int i = 0; i < n; i++) printf("%s%.17g", i ? "," : "", x[i] + 0.0); /* -0 is written 0 */
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
    if (a->takes & TAKES_A) s->tau = s->a + nv;
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
            status = report_failure(table, s, result);
            break;
        }
        if ((status = report_overflow(table, out, y)) != 0) break;
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
    const char *model, *body, *constraints, *contacts;
    const algorithm *algorithm;
    double point[3], dt;
    const char **given; /* ngiven */
    int ngiven, layout, point_given, dt_given;
    settings settings;
} options;

static int take_model(options *o, const char *path) {
    if (o->model) return usage_error("more than one file: '%s'", path);
    o->model = path;
    return 0;
}

static int report_algorithm(const char *name) {
    nearest n = nearest_to(name);
    see_algorithms(&n);
    if (*n.best) return usage_error("--algorithm: there is no '%s'; did you mean '%s'?", name, n.best);
    return usage_error("--algorithm: there is no '%s'", name);
}

static int read_dt(options *o, const char *text) {
    char *end;
    o->dt = strtod(text, &end);
    o->dt_given = 1;
    if (end != text && !*end && o->dt > 0 && isfinite(o->dt)) return 0;
    return usage_error("--dt: '%s' is not a number above 0", text);
}

static int read_own(options *o, char **argv, int *i) {
    const char *value;
    if (strcmp(argv[*i], "--layout") == 0) {
        o->layout = 1;
        return 0;
    }
    if (option_is(argv[*i], "--model"))
        return (value = option_value(argv, i)) ? take_model(o, value) : EXIT_USAGE;
    if (option_is(argv[*i], "--body")) return (o->body = option_value(argv, i)) ? 0 : EXIT_USAGE;
    if (option_is(argv[*i], "--constraints"))
        return (o->constraints = option_value(argv, i)) ? 0 : EXIT_USAGE;
    if (option_is(argv[*i], "--contacts")) return (o->contacts = option_value(argv, i)) ? 0 : EXIT_USAGE;
    if (option_is(argv[*i], "--dt")) return (value = option_value(argv, i)) ? read_dt(o, value) : EXIT_USAGE;
    if (option_is(argv[*i], "--given"))
        return (o->given[o->ngiven++] = option_value(argv, i)) ? 0 : EXIT_USAGE;
    if (option_is(argv[*i], "--point")) {
        o->point_given = 1;
        return (value = option_value(argv, i)) ? read_vector("--point", value, o->point) : EXIT_USAGE;
    }
    if (!option_is(argv[*i], "--algorithm")) return -1;
    value = option_value(argv, i);
    if (!value) return EXIT_USAGE;
    o->algorithm = find_algorithm(value);
    return o->algorithm ? 0 : report_algorithm(value);
}

/* An option that the algorithm does not read would be lost. */
static int check_unread(const options *o) {
    const int takes = o->algorithm->takes;
    const struct {
        const char *name;
        int given, takers;
    } own[] = {{"--body", o->body != NULL, TAKES_POINT},
               {"--point", o->point_given, TAKES_POINT},
               {"--given", o->ngiven > 0, TAKES_GIVEN},
               {"--constraints", o->constraints != NULL, TAKES_CONSTRAINTS | TAKES_CONTACTS},
               {"--contacts", o->contacts != NULL, TAKES_CONTACTS},
               {"--dt", o->dt_given, TAKES_CONTACTS}};
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
        if (own[k].given && !(takes & own[k].takers))
            return usage_error("%s: '%s' does not take it", own[k].name, o->algorithm->name);
    return 0;
}

/* Returns 0 to go on, or 1 + the exit status to end with. */
static int read_options(options *o, char **argv) {
    for (int i = 1; argv[i]; i++) {
        int status;
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            printf("%s", help);
            print_algorithms();
            printf("%s%s%s", help_columns, settings_help, help_end);
            return 1 + EXIT_SUCCESS;
        }
        if (strcmp(argv[i], "--version") == 0) {
            puts("rbd-eval " RBD_VERSION);
            return 1 + EXIT_SUCCESS;
        }
        status = read_own(o, argv, &i);
        if (status < 0) status = settings_read(&o->settings, argv, &i);
        if (status < 0 && argv[i][0] == '-' && argv[i][1])
            status = unknown_option(argv[i], (const char *const[]){help_columns, settings_help, NULL});
        if (status < 0) status = take_model(o, argv[i]);
        if (status > 0) return 1 + status;
    }
    if (!o->model) return 1 + usage_error("no file given");
    if (!o->layout && strcmp(o->model, "-") == 0)
        return 1 + usage_error("'-': standard input has the table, so it cannot have the robot");
    if (!o->algorithm) return 1 + usage_error("--algorithm is missing");
    if (o->algorithm->takes & TAKES_POINT && !o->body)
        return 1 + usage_error("--body is missing: %s takes a point of a link", o->algorithm->name);
    if (o->algorithm->takes & TAKES_CONSTRAINTS && !o->constraints)
        return 1 + usage_error("--constraints is missing: %s takes a table of them", o->algorithm->name);
    if (o->algorithm->takes & TAKES_CONTACTS && !o->contacts)
        return 1 + usage_error("--contacts is missing: %s takes a table of them", o->algorithm->name);
    return check_unread(o) ? 1 + EXIT_USAGE : 0;
}

static void print_layout(const columns *in, const columns *out) {
    for (int i = 0; i < in->n; i++) printf("takes %s\n", in->name[i]);
    for (int i = 0; i < out->n; i++) printf("gives %s\n", out->name[i]);
}

/* Of --given. */
static int report_dof(const rbd_model *m, const char *name) {
    nearest n = nearest_to(name);
    columns dofs = {0};
    char hint[140];
    add_dofs(&dofs, m, "");
    for (int i = 0; i < dofs.n; i++) nearest_see(&n, dofs.name[i], strlen(dofs.name[i]));
    for (int b = 0; b < rbd_nb(m); b++)
        if (rbd_joint_name(m, b)) nearest_see(&n, rbd_joint_name(m, b), strlen(rbd_joint_name(m, b)));
    free_columns(&dofs);
    fprintf(stderr, "%s: --given: the robot has no degree of freedom '%s'%s\n", program, name,
            nearest_hint(&n, hint));
    return EXIT_BAD;
}

/* The sets of the tables that are given, in memory[2]; returns 0, or EXIT_BAD after a message. */
static int prepare_sets(state *s, const options *o, const robot *r, void **memory) {
    rbd_constraint *list = NULL;
    int held = 0;
    if (o->constraints) held = constraints_read(o->constraints, r, s->w, &list, &memory[0], &s->c);
    if (held >= 0 && o->contacts)
        s->ncontacts =
            contacts_read(o->contacts, r, s->w, list, held, &s->contact_name, &memory[1], &s->contacts);
    free(list);
    return held < 0 || s->ncontacts < 0 ? EXIT_BAD : 0;
}

/* Everything of a state but its numbers. Returns 0, or EXIT_BAD after a message. */
static int prepare(state *s, const options *o, const robot *r) {
    const rbd_model *m = r->model;
    char reason[REASON];
    const size_t size = rbd_work_size(m), more = rbd_derivatives_size(m);
    unsigned char *memory = allocate(size + more + (size_t)rbd_nv(m), 1);
    s->m = m;
    s->memory = memory;
    rbd_work_init(m, memory, size, &s->w);
    rbd_derivatives_init(m, s->w, memory + size, more, &s->d);
    s->given = memory + size + more;
    memcpy(s->point, o->point, sizeof s->point);
    s->dt = o->dt;
    s->body = o->body ? robot_link(r, o->body, reason) : -1;
    if (o->body && s->body < 0) {
        fprintf(stderr, "%s: --body: %s\n", program, reason);
        return EXIT_BAD;
    }
    for (int i = 0; i < o->ngiven; i++)
        if (mark_dofs(m, o->given[i], s->given) != 0) return report_dof(m, o->given[i]);
    return 0;
}

static int run_on(const options *o, const robot *r) {
    columns in = {0}, out = {0};
    state s = {0};
    void *sets[2] = {NULL, NULL};
    int status = prepare(&s, o, r);
    if (status == 0) status = prepare_sets(&s, o, r, sets);
    add_inputs(&in, s.m, o->algorithm);
    add_outputs(&out, &s, o->algorithm);
    if (status == 0 && o->layout)
        print_layout(&in, &out);
    else if (status == 0)
        status = read_table(o->algorithm, &s, &in, &out);
    free_columns(&in);
    free_columns(&out);
    free(sets[0]);
    free(sets[1]);
    free(s.contact_name);
    free(s.memory);
    return status;
}

static int run(options *o) {
    robot r;
    int status;
    if (o->body || o->constraints || o->contacts || o->algorithm->gives[0].columns == POSES)
        o->settings.urdf.keep_all = 1;
    if (o->algorithm->takes & NO_MASS && !o->settings.urdf.lock_massless) o->settings.urdf.kinematic = 1;
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
    o.settings = settings_new(argc, argv);
    o.dt = 1e-3;
    o.given = allocate((size_t)argc, sizeof *o.given);
    status = read_options(&o, argv);
    status = status ? status - 1 : run(&o);
    settings_free(&o.settings);
    free(o.given);
    return status;
}
