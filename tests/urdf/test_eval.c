/* test_eval.c - the command rbd-eval, end to end, against the stored reference results: the robots' URDF
   files in, tables through pipes, columns in another order. In the environment: RBD_ROOT, the folder of the
   project; RBD_EVAL, the command. */
#define _POSIX_C_SOURCE 200809L
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "rbd.h"

#include "../reference.h"
#include "../larger.h"

enum { MAX_OUT = 12000, STATES = 2, MAX_LINE = 400000 };

static const char *const robots[] = {"iiwa", "hyq", "atlas"};

static const ref_control *find_control(const char *robot) {
    for (int i = 0; i < control_count; i++) /* "control_iiwa" */
        if (strcmp(reference_control(i)->model->name + strlen("control_"), robot) == 0)
            return reference_control(i);
    ck_abort_msg("no control data of %s", robot);
    return NULL;
}

static const ref_model *find_reference(const char *name) {
    for (int i = 0; i < reference_count; i++)
        if (strcmp(reference_model(i)->name, name) == 0) return reference_model(i);
    ck_abort_msg("no reference of %s", name);
    return NULL;
}

/* "rbd-eval --model ... --algorithm ..." as a line for the shell. */
static const char *command_line(const ref_model *model, const ref_state *s, const char *algorithm) {
    static char line[2000];
    snprintf(line, sizeof line,
             "'%s' --model '%s/models/%s.urdf' %s --gravity=%.17g,%.17g,%.17g --algorithm %s",
             getenv("RBD_EVAL"), getenv("RBD_ROOT"), model->name,
             model->bodies[0].type == RBD_FLOATING ? "--floating" : "", s->gravity[0], s->gravity[1],
             s->gravity[2], algorithm);
    return line;
}

/* ---- a table of states, by the names of --layout ---- */

typedef struct names {
    char name[200][64];
    int n;
} names;

static names names_taken(const char *command) {
    static char line[3000];
    names taken = {.n = 0};
    FILE *layout;
    snprintf(line, sizeof line, "%s --layout", command);
    layout = popen(line, "r");
    ck_assert(layout != NULL);
    while (fgets(line, sizeof line, layout))
        if (sscanf(line, "takes %63s", taken.name[taken.n]) == 1) ck_assert_int_lt(++taken.n, 200);
    ck_assert_int_eq(pclose(layout), 0);
    return taken;
}

/* The value of column i among those taken: they stand in the order of q, v, a, tau, or some of these. */
static double value(const ref_model *model, const ref_state *s, const char *name, int i) {
    if (i < model->nq) return s->q[i];
    i -= model->nq;
    if (i < model->nv) return s->v[i];
    i -= model->nv;
    return name[0] == 'a' ? s->vdot[i] : s->tau[i % model->nv];
}

/* Writes the table to a file: the columns from the last to the first, and one that nobody asked for. */
static void write_table(const char *path, const ref_model *model, const ref_state *s, const names *taken) {
    FILE *table = fopen(path, "w");
    ck_assert(table != NULL);
    for (int i = taken->n; i-- > 0;) fprintf(table, "%s,", taken->name[i]);
    fprintf(table, "remark\r\n\r\n");
    for (int i = taken->n; i-- > 0;) fprintf(table, " %.17g,", value(model, s, taken->name[i], i));
    fprintf(table, "none\r\n\n");
    ck_assert_int_eq(fclose(table), 0);
}

/* Runs the command on the table; returns how many numbers the one row of results has. */
static int run(const char *command, const char *path, double *out) {
    static char line[MAX_LINE];
    FILE *results;
    int n = 0;
    snprintf(line, sizeof line, "%s <'%s'", command, path);
    results = popen(line, "r");
    ck_assert(results && fgets(line, sizeof line, results)); /* names */
    ck_assert(fgets(line, sizeof line, results) != NULL);
    for (char *cell = strtok(line, ",\n"); cell; cell = strtok(NULL, ",\n")) {
        ck_assert_int_lt(n, MAX_OUT);
        out[n++] = strtod(cell, NULL);
    }
    ck_assert_ptr_null(fgets(line, sizeof line, results));
    ck_assert_int_eq(pclose(results), 0);
    return n;
}

static int evaluate(const ref_model *model, const ref_state *s, const char *algorithm, double *out) {
    char path[] = "/tmp/rbd_eval_XXXXXX", command[2000];
    const int file = mkstemp(path);
    names taken;
    int n;
    ck_assert_int_ge(file, 0);
    close(file);
    snprintf(command, sizeof command, "%s", command_line(model, s, algorithm));
    taken = names_taken(command);
    write_table(path, model, s, &taken);
    n = run(command, path, out);
    unlink(path);
    return n;
}

/* ---- results ---- */

static void expect(const ref_model *model, const char *what, const double *found, const double *expected,
                   int n, double bound) {
    double scale = 1e-3;
    for (int i = 0; i < n; i++) scale = larger(scale, fabs(expected[i]));
    for (int i = 0; i < n; i++)
        ck_assert_msg(fabs(found[i] - expected[i]) <= bound * scale, "%s, %s, number %d: %.17g, not %.17g",
                      model->name, what, i, found[i], expected[i]);
}

static void check_dynamics(const ref_model *model, const ref_state *s) {
    static double out[MAX_OUT];
    const int nv = model->nv;
    const double inverse = fmax(1e-11, 1e-15 * s->cond_M);
    ck_assert_int_eq(evaluate(model, s, "id", out), nv);
    expect(model, "id", out, s->tau_rnea, nv, 1e-11);
    ck_assert_int_eq(evaluate(model, s, "mm", out), nv * nv);
    expect(model, "mm", out, s->M, nv * nv, 1e-11);
    ck_assert_int_eq(evaluate(model, s, "fd", out), nv);
    expect(model, "fd", out, s->qdd, nv, inverse);
    ck_assert_int_eq(evaluate(model, s, "fd_cholesky", out), nv);
    expect(model, "fd_cholesky", out, s->qdd, nv, inverse);
    ck_assert_int_eq(evaluate(model, s, "bias", out), nv);
    expect(model, "bias", out, s->c, nv, 1e-11);
    ck_assert_int_eq(evaluate(model, s, "gravity_torque", out), nv);
    expect(model, "gravity_torque", out, s->g, nv, 1e-11);
}

static void check_kinematics(const ref_model *model, const ref_state *s) {
    static double out[MAX_OUT];
    const double energy[2] = {s->kinetic, s->potential};
    ck_assert_int_eq(evaluate(model, s, "energy", out), 2);
    expect(model, "energy", out, energy, 2, 1e-11);
    ck_assert_int_eq(evaluate(model, s, "com", out), 6);
    expect(model, "com", out, s->com, 3, 1e-11);
    expect(model, "velocity of com", out + 3, s->com_vel, 3, 1e-11);
    ck_assert_int_eq(evaluate(model, s, "pose", out), 12 * model->nb);
    for (int b = 0; b < model->nb; b++) {
        expect(model, "position", out + 12 * b, s->body_p + 3 * b, 3, 1e-11);
        expect(model, "rotation", out + 12 * b + 3, s->body_R + 9 * b, 9, 1e-11);
    }
}

START_TEST(rbd_eval_gives_the_reference_results) {
    const ref_model *model = find_reference(robots[_i]);
    for (int k = 0; k < STATES; k++) {
        check_dynamics(model, &model->states[k]);
        check_kinematics(model, &model->states[k]);
    }
}
END_TEST

/* ---- what controllers ask ---- */

/* The same state for the functions above. */
static ref_state plain_state(const ref_control_state *s) {
    ref_state plain;
    memset(&plain, 0, sizeof plain);
    plain.gravity = s->gravity;
    plain.q = s->q;
    plain.v = s->v;
    plain.vdot = s->vdot;
    plain.tau = s->tau;
    return plain;
}

static void check_one(const ref_model *model, const ref_control_state *s, const char *algorithm,
                      const double *const *expected, const int *lengths, int count, double bound) {
    static double out[MAX_OUT];
    const ref_state plain = plain_state(s);
    const int n = evaluate(model, &plain, algorithm, out);
    int at = 0;
    for (int i = 0; i < count; at += lengths[i++])
        expect(model, algorithm, out + at, expected[i], lengths[i], bound);
    ck_assert_int_eq(n, at);
}

static void check_matrices(const ref_model *model, const ref_control_state *s) {
    const int nv = model->nv, square = nv * nv;
    const struct {
        const char *algorithm;
        const double *expected[3];
        int lengths[3], inverse;
    } rows[] = {{"minv", {s->Minv}, {square}, 1},
                {"coriolis", {s->C}, {square}, 0},
                {"com_jacobian", {s->J_com}, {3 * nv}, 0},
                {"momentum", {s->h, s->h_dot}, {6, 6}, 0},
                {"momentum_matrix", {s->A_h}, {6 * nv}, 0},
                {"id_derivatives", {s->dtau_dq, s->dtau_dv}, {square, square}, 0},
                {"fd_derivatives", {s->dqdd_dq, s->dqdd_dv, s->Minv}, {square, square, square}, 1}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        int count = 0;
        while (count < 3 && rows[i].expected[count]) count++;
        check_one(model, s, rows[i].algorithm, rows[i].expected, rows[i].lengths, count,
                  rows[i].inverse ? fmax(1e-11, 1e-15 * s->cond_M) : 1e-11);
    }
}

static void check_generalized_momentum(const ref_model *model, const ref_control_state *s) {
    double p[64] = {0}, ctv[64] = {0};
    const double *const expected[] = {p, ctv};
    const int nv = model->nv, lengths[] = {nv, nv};
    for (int i = 0; i < nv; i++)
        for (int k = 0; k < nv; k++) p[i] += s->M[i * nv + k] * s->v[k], ctv[k] += s->C[i * nv + k] * s->v[i];
    check_one(model, s, "generalized_momentum", expected, lengths, 2, 1e-11);
}

/* A joint transmits its torque along its axis, a floating one all of it. */
static void check_joint_wrench(const ref_model *model, const ref_control_state *s) {
    static double f[MAX_OUT];
    const ref_state plain = plain_state(s);
    ck_assert_int_eq(evaluate(model, &plain, "joint_wrench", f), 6 * model->nb);
    for (int b = 0; b < model->nb; b++) {
        const double *axis = model->bodies[b].axis, *n = f + 6 * b,
                     along = axis[0] * n[0] + axis[1] * n[1] + axis[2] * n[2];
        const double *tau = s->tau_rnea + model->body_iv[b];
        expect(model, "joint_wrench", model->body_nv[b] == 6 ? n : &along, tau, model->body_nv[b], 1e-11);
    }
}

/* Of a quaternion p half of p (omega; 0), of a floating base's place its velocity turned into world axes. */
static void check_rates(const ref_model *model, const ref_control_state *s) {
    const double *q = s->q, *p = q + 3, *w = s->v, *u = s->v + 3;
    const int floats = model->nq > model->nv, n = floats ? 7 : 0;
    double rates[64];
    const double *const expected[] = {rates};
    const int length[] = {model->nq};
    memcpy(rates + n, s->v + (floats ? 6 : 0), (size_t)(model->nq - n) * sizeof *rates);
    for (int i = 0, j = 1, k = 2; floats && i < 3; i++, j = (i + 1) % 3, k = (i + 2) % 3) {
        const double t[3] = {2 * (p[j] * u[k] - p[k] * u[j]), 2 * (p[k] * u[i] - p[i] * u[k]),
                             2 * (p[i] * u[j] - p[j] * u[i])}; /* along i, j, k */
        rates[i] = u[i] + p[3] * t[0] + p[j] * t[2] - p[k] * t[1];
        rates[3 + i] = (p[3] * w[i] + p[j] * w[k] - p[k] * w[j]) / 2;
    }
    if (floats) rates[6] = -(p[0] * w[0] + p[1] * w[1] + p[2] * w[2]) / 2;
    check_one(model, s, "rates", expected, length, 1, 1e-11);
}

static void check_points(const ref_model *model, const ref_control_state *s) {
    char algorithm[200];
    for (int i = 0; i < s->npoints; i++) {
        const ref_point *p = &s->points[i];
        const double *const jacobian[] = {p->point_J}, *const motion[] = {p->point_vel,
                                                                          p->point_acc_classical};
        const int length[] = {6 * model->nv}, six[] = {6, 6};
        for (int k = 0; k < 2; k++) {
            snprintf(algorithm, sizeof algorithm, "%s --body %s --point=%.17g,%.17g,%.17g",
                     k ? "point" : "jacobian", model->bodies[p->body].name, p->p[0], p->p[1], p->p[2]);
            if (k)
                check_one(model, s, algorithm, motion, six, 2, 1e-11);
            else
                check_one(model, s, algorithm, jacobian, length, 1, 1e-11);
        }
    }
}

static void check_steps(const ref_model *model, const ref_control_state *s) {
    const double *const expected[] = {s->integrate_d_dq, s->integrate_d_dd};
    const double *const difference[] = {s->difference_d_dq0, s->difference_d_dq1};
    const int square = model->nv * model->nv, lengths[] = {square, square};
    ref_control_state step = *s;
    step.v = s->integrate_d;
    check_one(model, &step, "integrate_derivatives", expected, lengths, 2, 1e-11);
    step.v = s->difference_d;
    check_one(model, &step, "difference_derivatives", difference, lengths, 2, 1e-11);
}

static void check_regressors(const ref_model *model, const ref_control_state *s) {
    const double *const torque[] = {s->Y}, *const energy[] = {s->Y_kinetic, s->Y_potential};
    const int nb = model->nb, lengths[] = {10 * model->nv * nb}, tens[] = {10 * nb, 10 * nb};
    if (s->Y) check_one(model, s, "regressor", torque, lengths, 1, 1e-11);
    check_one(model, s, "energy_regressors", energy, tens, 2, 1e-11);
}

static void check_hybrid(const ref_model *model, const ref_control_state *s) {
    static const char *const six[] = {".wx", ".wy", ".wz", ".vx", ".vy", ".vz"};
    const double *const expected[] = {s->hybrid_a, s->hybrid_tau};
    const int nv = model->nv, lengths[] = {nv, nv};
    char algorithm[1500] = "hybrid";
    for (int b = 0; b < model->nb; b++)
        for (int k = 0; k < model->body_nv[b]; k++) {
            const int floats = model->bodies[b].type == RBD_FLOATING;
            const size_t length = strlen(algorithm);
            if (s->hybrid_given[model->body_iv[b] + k])
                snprintf(algorithm + length, sizeof algorithm - length, " --given %s%s",
                         floats ? "root" : model->bodies[b].joint, floats ? six[k] : "");
        }
    check_one(model, s, algorithm, expected, lengths, 2, fmax(1e-11, 1e-15 * s->cond_M));
}

/* A table for --constraints; tool frames are links of the URDF files only. */
static void write_constraints(const char *path, const ref_model *model, const ref_constraint_set *set) {
    FILE *table = fopen(path, "w");
    ck_assert(table != NULL);
    fprintf(table, "axes");
    for (int body = 1; body <= 2; body++) {
        fprintf(table, ",body%d,x%d,y%d,z%d", body, body, body, body);
        for (int i = 0; i < 9; i++) fprintf(table, ",r%d_%d", body, i);
    }
    for (int k = 0; k < set->count; k++) {
        const ref_constraint *c = &set->constraints[k];
        fprintf(table, "\n");
        for (int i = 0; i < 6; i++) fprintf(table, "%d", c->axes[i]);
        for (int body = 1; body <= 2; body++) {
            const int index = body == 1 ? c->body1 : c->body2;
            const double *p = body == 1 ? c->p1 : c->p2, *R = body == 1 ? c->R1 : c->R2;
            fprintf(table, ",%s", index < 0 ? "world" : model->bodies[index].name);
            for (int i = 0; i < 3; i++) fprintf(table, ",%.17g", p[i]);
            for (int i = 0; i < 9; i++) fprintf(table, ",%.17g", R[i]);
        }
    }
    fprintf(table, "\n");
    ck_assert_int_eq(fclose(table), 0);
}

static void check_constrained(const ref_model *model, const ref_control_state *s) {
    for (int i = 0; i < s->nconstraint_sets; i++) {
        const ref_constraint_set *set = &s->constraint_sets[i];
        const double *const expected[] = {set->qdd_c, set->lambda};
        const int lengths[] = {model->nv, set->rows};
        char path[] = "/tmp/rbd_eval_XXXXXX", algorithm[100];
        const int file = mkstemp(path);
        ck_assert_int_ge(file, 0);
        close(file);
        write_constraints(path, model, set);
        snprintf(algorithm, sizeof algorithm, "constrained_fd --constraints %s", path);
        check_one(model, s, algorithm, expected, lengths, 2, fmax(1e-11, 1e-15 * (s->cond_M + set->cond)));
        unlink(path);
    }
}

START_TEST(rbd_eval_gives_the_control_results) {
    const ref_control *control = find_control(robots[_i]);
    ref_model model = *control->model;
    model.name = robots[_i]; /* of the URDF */
    for (int k = 0; k < STATES; k++) {
        check_matrices(&model, &control->states[k]);
        check_generalized_momentum(&model, &control->states[k]);
        check_joint_wrench(&model, &control->states[k]);
        check_rates(&model, &control->states[k]);
        check_points(&model, &control->states[k]);
        check_regressors(&model, &control->states[k]);
        check_steps(&model, &control->states[k]);
        check_hybrid(&model, &control->states[k]);
        check_constrained(&model, &control->states[k]);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("eval");
    TCase *c = tcase_create("eval");
    SRunner *runner;
    int failed;
    tcase_set_timeout(c, 120);
    tcase_add_loop_test(c, rbd_eval_gives_the_reference_results, 0, (int)(sizeof robots / sizeof *robots));
    tcase_add_loop_test(c, rbd_eval_gives_the_control_results, 0, (int)(sizeof robots / sizeof *robots));
    suite_add_tcase(suite, c);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
