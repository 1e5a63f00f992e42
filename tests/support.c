/* support.c - see support.h */
#include "support.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const double earth[3] = {0, 0, -9.81};

/* ---- models ---- */

robot robot_build_any(const char *name, const rbd_body *bodies, int nb) {
    robot r = {name, bodies, nb, 0, 0, NULL, NULL, {NULL, NULL}};
    rbd_report report;
    char text[200];
    size_t size = rbd_model_size(bodies, nb);
    r.memory[0] = malloc(size);
    rbd_status status = rbd_model_build(bodies, nb, r.memory[0], size, &r.m, &report);
    ck_assert_msg(status == RBD_OK, "%s: build: %s", name,
                  rbd_finding_text(&report.error, text, sizeof text));
    r.nq = rbd_nq(r.m);
    r.nv = rbd_nv(r.m);
    size = rbd_work_size(r.m);
    r.memory[1] = memset(malloc(size), 0xff, size); /* NaN, so that what was never written shows */
    ck_assert_msg(rbd_work_init(r.m, r.memory[1], size, &r.w) == RBD_OK, "%s: work", name);
    return r;
}

robot robot_build(const char *name, const rbd_body *bodies, int nb) {
    const robot r = robot_build_any(name, bodies, nb);
    ck_assert_msg(r.nq <= MAX_Q && r.nv <= MAX_V, "%s: nq %d, nv %d", name, r.nq, r.nv);
    return r;
}

void robot_free(robot *r) {
    free(r->memory[0]);
    free(r->memory[1]);
}

/* ---- random numbers, states and trees ---- */

/* xorshift64*, of Vigna */
static uint64_t draw(uint64_t *seed) {
    *seed ^= *seed >> 12;
    *seed ^= *seed << 25;
    *seed ^= *seed >> 27;
    return *seed * UINT64_C(2685821657736338717);
}

double uniform(uint64_t *seed, double low, double high) {
    return low + (high - low) * ((double)(draw(seed) >> 11) / 9007199254740992.0);
}

int below(uint64_t *seed, int n) { return (int)((draw(seed) >> 33) % (uint64_t)n); }

static void draw_vector(uint64_t *seed, double size, double *x, int n) {
    for (int i = 0; i < n; i++) x[i] = uniform(seed, -size, size);
}

static void draw_unit(uint64_t *seed, double *x, int n) {
    double square;
    do {
        draw_vector(seed, 1, x, n);
        square = dot(x, x, n);
    } while (square > 1 || square < 0.01);
    for (int i = 0; i < n; i++) x[i] /= sqrt(square);
}

static void draw_coordinates(const rbd_body *b, uint64_t *seed, double *q) {
    switch (b->type) {
    case RBD_FLOATING:
        draw_vector(seed, 1, q, 3);
        draw_unit(seed, q + 3, 4);
        break;
    case RBD_SPHERICAL: draw_unit(seed, q, 4); break;
    case RBD_CONTINUOUS_CS: draw_unit(seed, q, 2); break;
    case RBD_PRISMATIC:
    case RBD_TRANSLATION: draw_vector(seed, 1, q, tb_nq(b)); break;
    default: draw_vector(seed, 3, q, tb_nq(b));
    }
}

void draw_state(const robot *r, uint64_t *seed, state *s) {
    double *q = s->q;
    memset(s, 0xff, sizeof *s); /* NaN, so that what was never drawn shows */
    draw_vector(seed, 10, s->gravity, 3);
    for (int i = 0; i < r->nb; i++)
        if (!r->bodies[i].mimic) {
            draw_coordinates(&r->bodies[i], seed, q);
            q += tb_nq(&r->bodies[i]);
        }
    draw_vector(seed, 2, s->v, r->nv);
    draw_vector(seed, 3, s->a, r->nv);
    draw_vector(seed, 20, s->tau, r->nv);
    draw_vector(seed, 10, s->f_ext, 6 * r->nb);
    ck_assert(rbd_set_gravity(r->w, s->gravity) == RBD_OK);
}

void random_rotation(uint64_t *seed, double R[9]) {
    double u[4];
    draw_unit(seed, u, 4);
    const double x = u[0], y = u[1], z = u[2], w = u[3];
    const double rotation[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                                2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                                2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(R, rotation, sizeof rotation);
}

/* The inertia of a box-like body: positive second moments along turned axes obey the triangle. */
void random_mass(uint64_t *seed, rbd_body *b) {
    double R[9], moment[3], S[9] = {0};
    random_rotation(seed, R);
    b->mass = uniform(seed, 0.2, 5);
    draw_vector(seed, 0.3, b->com, 3);
    for (int k = 0; k < 3; k++) moment[k] = b->mass * uniform(seed, 0.001, 0.05);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) S[3 * i + j] += R[3 * i + k] * moment[k] * R[3 * j + k];
    const double inertia[6] = {S[4] + S[8], -S[1], -S[2], S[0] + S[8], -S[5], S[0] + S[4]};
    memcpy(b->inertia, inertia, sizeof inertia);
}

static void quarter_turn(uint64_t *seed, double R[9]) {
    static const double turns[6][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},   {1, 0, 0, 0, 0, -1, 0, 1, 0},
                                       {0, 0, 1, 0, 1, 0, -1, 0, 0},  {0, -1, 0, 1, 0, 0, 0, 0, 1},
                                       {-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    memcpy(R, turns[below(seed, 6)], 9 * sizeof(double));
}

static void random_axis(uint64_t *seed, double axis[3]) {
    if (below(seed, 2)) {
        draw_unit(seed, axis, 3);
    } else {
        axis[0] = axis[1] = axis[2] = 0;
        axis[below(seed, 3)] = below(seed, 2) ? 1 : -1;
    }
    const double length = below(seed, 4) ? 1 : uniform(seed, 0.1, 10);
    for (int k = 0; k < 3; k++) axis[k] *= length;
}

/* Zero, on the parent's axis, or anywhere. */
static void random_place(uint64_t *seed, const rbd_body *parent, double position[3]) {
    const int kind = below(seed, 4);
    draw_vector(seed, 0.6, position, 3);
    const double along = position[0];
    for (int k = 0; k < 3 && kind < 2; k++) position[k] = kind == 1 && parent ? along * parent->axis[k] : 0;
}

/* The second axis of a universal joint: at a right angle to the first, or anywhere not near it. */
static void random_second_axis(uint64_t *seed, rbd_body *b) {
    const double *a = b->axis;
    double *c = b->axis2, u[3], cosine;
    if (below(seed, 2)) {
        draw_unit(seed, u, 3);
        c[0] = a[1] * u[2] - a[2] * u[1];
        c[1] = a[2] * u[0] - a[0] * u[2];
        c[2] = a[0] * u[1] - a[1] * u[0];
    }
    cosine = dot(a, c, 3) / sqrt(dot(a, a, 3) * dot(c, c, 3));
    while (!(fabs(cosine) < 0.8)) {
        draw_unit(seed, c, 3);
        cosine = dot(a, c, 3) / sqrt(dot(a, a, 3));
    }
}

void random_joint(uint64_t *seed, rbd_body *bodies, int index, rbd_joint_type type) {
    rbd_body *b = &bodies[index];
    memset(b, 0, sizeof *b);
    b->parent = below(seed, 3) ? index - 1 : below(seed, index + 1) - 1;
    b->type = type;
    const rbd_body *parent = b->parent < 0 ? NULL : &bodies[b->parent];
    random_axis(seed, b->axis);
    random_place(seed, parent, b->position);
    switch (below(seed, 4)) {
    case 0: /* the same axes as the parent, often the same joint axis too */
        if (parent && below(seed, 2) && dot(parent->axis, parent->axis, 3) > 0) {
            const double sign = below(seed, 2) ? 1 : -1;
            for (int k = 0; k < 3; k++) b->axis[k] = sign * parent->axis[k];
        }
        break;
    case 1: quarter_turn(seed, b->rotation); break;
    default: random_rotation(seed, b->rotation);
    }
    b->pitch = type == RBD_HELICAL ? uniform(seed, -0.5, 0.5) : 0;
    if (type == RBD_UNIVERSAL) random_second_axis(seed, b);
    if (type == RBD_FIXED) memset(b->axis, 0, sizeof b->axis);
}

static int has_one_dof(rbd_joint_type type) {
    return type == RBD_REVOLUTE || type == RBD_CONTINUOUS || type == RBD_PRISMATIC || type == RBD_HELICAL;
}

static const char *joint_name(int index) {
    static char names[MAX_BODIES][16];
    snprintf(names[index], sizeof names[index], "j%d", index);
    return names[index];
}

/* Lets a one-dof joint follow an earlier one now and then. */
static void maybe_follow(uint64_t *seed, rbd_body *bodies, int index) {
    rbd_body *b = &bodies[index];
    const int leader = below(seed, index + 1);
    if (leader == index || below(seed, 3) || !has_one_dof(b->type) || bodies[leader].mimic ||
        !has_one_dof(bodies[leader].type))
        return;
    b->mimic = joint_name(leader);
    b->mimic_ratio = uniform(seed, -2, 2);
    b->mimic_offset = uniform(seed, -1, 1);
}

static int is_leaf(const rbd_body *bodies, int nb, int index) {
    for (int i = index + 1; i < nb; i++)
        if (bodies[i].parent == index) return 0;
    return 1;
}

void random_tree(uint64_t *seed, rbd_body *bodies, int nb) {
    const int one_dof_only = below(seed, 3) == 0, light = below(seed, 4) == 0;
    int nv = 0;
    for (int i = 0; i < nb; i++) {
        rbd_joint_type type = (rbd_joint_type)below(seed, RBD_JOINT_TYPES);
        if (one_dof_only || nv + 6 + (nb - i) > MAX_V)
            type = (rbd_joint_type)(RBD_REVOLUTE + below(seed, RBD_HELICAL));
        random_joint(seed, bodies, i, type);
        bodies[i].joint = joint_name(i);
        random_mass(seed, &bodies[i]);
        if (!below(seed, 6)) maybe_follow(seed, bodies, i);
        for (int k = 0; k < 6 && !below(seed, 4); k++) bodies[i].armature[k] = uniform(seed, 0, 0.5);
        nv += tb_nv(&bodies[i]);
    }
    for (int i = 0; i < nb; i++)
        if (light && !below(seed, 3) && !is_leaf(bodies, nb, i)) {
            bodies[i].mass = 0;
            memset(bodies[i].inertia, 0, sizeof bodies[i].inertia);
        }
}

/* ---- loops over models and states ---- */

static robot build_reference(const ref_model *model) {
    robot r = robot_build(model->name, model->bodies, model->nb);
    ck_assert_msg(r.nq == model->nq && r.nv == model->nv, "%s: nq %d, nv %d", r.name, r.nq, r.nv);
    return r;
}

static void check_states(const robot *r, uint64_t *seed, int count, state_check *check) {
    state s;
    for (int i = 0; i < count; i++) {
        draw_state(r, seed, &s);
        check(r, &s, i);
    }
}

void for_random_states(int count, state_check *check) {
    uint64_t seed = 2026;
    for (int i = 0; i < reference_count; i++) {
        robot r = build_reference(reference_model(i));
        check_states(&r, &seed, count, check);
        robot_free(&r);
    }
}

TCase *slow_tests(Suite *suite) {
    TCase *slow = tcase_create("slow");
    tcase_set_tags(slow, "slow");
    tcase_set_timeout(slow, 60);
    suite_add_tcase(suite, slow);
    return slow;
}

void for_random_trees(int trees, state_check *check) {
    trees = (trees + PART_OF_TREES - 1) / PART_OF_TREES;

    for (int i = 0; i < trees; i++) {
        uint64_t seed = 1000 + (uint64_t)i; /* of its own, so that one tree can be looked at alone */
        rbd_body bodies[MAX_BODIES];
        char name[32];
        const int nb = 1 + below(&seed, 25);
        random_tree(&seed, bodies, nb);
        snprintf(name, sizeof name, "random tree %d", i);
        robot r = robot_build(name, bodies, nb);
        check_states(&r, &seed, 2, check);
        robot_free(&r);
    }
}

void for_reference_states(reference_check *check) {
    for (int i = 0; i < reference_count; i++) {
        const ref_model *model = reference_model(i);
        robot r = build_reference(model);
        for (int k = 0; k < model->nstates; k++) {
            ck_assert(rbd_set_gravity(r.w, model->states[k].gravity) == RBD_OK);
            check(&r, model, &model->states[k], k);
        }
        robot_free(&r);
    }
}

void for_control_states(control_check *check) {
    for (int i = 0; i < control_count; i++) {
        const ref_control *control = reference_control(i);
        robot r = build_reference(control->model);
        for (int k = 0; k < control->nstates; k++) {
            ck_assert(rbd_set_gravity(r.w, control->states[k].gravity) == RBD_OK);
            check(&r, &control->states[k], k);
        }
        robot_free(&r);
    }
}

/* ---- comparison ---- */

double largest(const double *x, int n) {
    double size = 0;
    for (int i = 0; i < n; i++) size = larger(size, fabs(x[i]));
    return size;
}

double dot(const double *a, const double *b, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

void multiply(const double *M, const double *x, int rows, int columns, double *out) {
    for (int i = 0; i < rows; i++) out[i] = dot(M + i * columns, x, columns);
}

double inverse_bound(double condition) { return fmax(1e-12, 1e-15 * condition); }

double relative_error(const double *found, const double *expected, int n) {
    double difference = 0;
    for (int i = 0; i < n; i++) {
        if (!isfinite(found[i]) || !isfinite(expected[i])) return HUGE_VAL;
        difference = larger(difference, fabs(found[i] - expected[i]));
    }
    return difference / fmax(largest(expected, n), 1e-3);
}

/* The largest error so far of each quantity on each robot. Robots whose names have the first word in
   common ("random tree 17") count as one. */
typedef struct record {
    char what[48], robot[24];
    double error, share; /* share: of its bound */
} record;

static record records[4000];
static int record_count, recording;

void record_errors(void) { recording = 1; }

static void remember(const char *what, const char *name, double error, double bound) {
    record *r = records;
    const int word = (int)strcspn(name, " ");
    char group[sizeof r->robot];
    if (!recording) return;
    snprintf(group, sizeof group, "%.*s", word, name);
    while (r < records + record_count &&
           (strncmp(r->what, what, sizeof r->what - 1) != 0 || strcmp(r->robot, group) != 0))
        r++;
    ck_assert_msg(r < records + LENGTH(records), "no room for another quantity");
    if (r == records + record_count) {
        record_count++;
        snprintf(r->what, sizeof r->what, "%s", what);
        memcpy(r->robot, group, sizeof group);
    }
    r->error = larger(r->error, error);
    r->share = larger(r->share, error / bound);
}

void print_errors(void) {
    printf("%-47s %-16s %8s  %s\n", "quantity", "robot", "error", "of its bound");
    for (const record *r = records; r < records + record_count; r++)
        printf("%-47s %-16s %8.1e  %.3f\n", r->what, r->robot, r->error, r->share);
}

/* A sentence that holds until the next one. */
static const char *sentence(const char *format, ...) {
    static char text[400];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    return text;
}

/* ---- figures ---- */

typedef struct figure {
    int item, times;
    char what[72];
    double found, expected, bound;
} figure;

static figure figures[200];
static int figure_count, figures_are_kept;

void record_figures(void) { figures_are_kept = 1; }

int figures_are_recorded(void) { return figures_are_kept; }

const char *why_not_figure(int item, const char *what, double found, double expected, double bound) {
    figure *f = figures;
    const double off = fabs(found - expected);
    if (!(off <= bound))
        return sentence("%s: %.12g, which is further than %.3g from %.12g", what, found, bound, expected);
    if (!figures_are_kept) return NULL;
    while (f < figures + figure_count && (f->item != item || strcmp(f->what, what) != 0)) f++;
    ck_assert_msg(f < figures + LENGTH(figures), "no room for another figure");
    if (f == figures + figure_count) {
        *f = (figure){item, 0, "", found, expected, bound};
        snprintf(f->what, sizeof f->what, "%s", what);
        figure_count++;
    }
    f->times++;
    if (off / bound >= fabs(f->found - f->expected) / f->bound)
        f->found = found, f->expected = expected, f->bound = bound;
    return NULL;
}

void print_figures(void) {
    printf("%-70s %16s %16s %8s %8s %8s\n", "the worst of so many, by item", "found", "expected", "off by",
           "allowed", "of");
    for (int item = 0; item < 100; item++)
        for (const figure *f = figures; f < figures + figure_count; f++)
            if (f->item == item)
                printf("%2d %-67s %16.9g %16.9g %8.1e %8.1e %8d\n", item, f->what, f->found, f->expected,
                       fabs(f->found - f->expected), f->bound, f->times);
}

const char *why_not_small(const char *what, const robot *r, int number, double error, double bound) {
    remember(what, r->name, error, bound);
    if (error <= bound) return NULL;
    return sentence("%s: %s, state %d: error %.3g exceeds %.3g", what, r->name, number, error, bound);
}

const char *why_not_close(const char *what, const robot *r, int number, const double *found,
                          const double *expected, int n, double bound) {
    int worst = 0;
    const double error = relative_error(found, expected, n);
    for (int i = 1; i < n; i++)
        if (!(fabs(found[i] - expected[i]) <= fabs(found[worst] - expected[worst]))) worst = i;
    remember(what, r->name, error, bound);
    if (error <= bound) return NULL;
    return sentence("%s: %s, state %d: error %.3g exceeds %.3g; entry %d of %d is %.17g instead of %.17g",
                    what, r->name, number, error, bound, worst, n, found[worst], expected[worst]);
}

const char *why_not_close_tb(const char *what, const robot *r, int number, const double *found,
                             const tb_real *expected, int n, double bound) {
    static double rounded[MAX_V * MAX_V];
    for (int i = 0; i < n; i++) rounded[i] = (double)expected[i];
    return why_not_close(what, r, number, found, rounded, n, bound);
}

const char *why_not_ok(const char *what, const robot *r, int number, rbd_status status) {
    if (status == RBD_OK) return NULL;
    return sentence("%s: %s, state %d: %s (degree of freedom %d)", what, r->name, number,
                    rbd_status_string(status), rbd_singular_dof(r->w));
}

const char *why_not_textbook_forward(const char *what, forward_dynamics *call, const robot *r, const state *s,
                                     int number) {
    tb_real expected[TB_MAX_DOFS];
    double a[MAX_V];
    const tb_real condition =
        tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, expected);
    const rbd_status status = call(r->m, r->w, s->q, s->v, s->tau, s->f_ext, a);
    if (condition > 0 && condition < 1e12L) { /* below it, doubles keep some digits of the inverse */
        const char *wrong = why_not_ok(what, r, number, status);
        return wrong
                   ? wrong
                   : why_not_close_tb(what, r, number, a, expected, r->nv, inverse_bound((double)condition));
    }
    if ((condition < 0 || condition > 1e18L) &&
        status != RBD_ERR_SINGULAR) /* even to the textbook's long double */
        return sentence("%s: %s, state %d: %s, though M is singular", what, r->name, number,
                        rbd_status_string(status));
    return NULL;
}
