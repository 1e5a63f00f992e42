/* library.c - the library's fuzzer: random robots against Kane's equations in quad precision (world.c). It
   prints the worst error of each algorithm in each class of robots, relative to what the algorithm has to add
   up; see docs/accuracy_tables.md for what is measured.
               library [--seconds N | --robots N]   for so long, or so many robots of each class; 200 by
                                            default
               [--publish]                  prints the rows of docs/accuracy_tables.md
               [--hold FILE]                fails if an error exceeds that of the document's table
       library --one CLASS NUMBER           shows one robot and its errors
   Compiled with -DRBD_REAL=double or float. */
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "../larger.h"
#include "robots.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef RBD_REAL real;

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
static const double epsilon = sizeof(real) == sizeof(float) ? (double)FLT_EPSILON / 2 : DBL_EPSILON / 2;

/* ---- what is measured ---- */

enum {
    RNEA,
    BIAS,
    GRAVITY,
    CRBA,
    PACKED,
    DIAGONAL,
    CHOLESKY,
    ABA,
    FD_CHOLESKY,
    ORIENTATION,
    POSITION,
    VELOCITY,
    ACCELERATION,
    COM,
    ENERGY,
    INTEGRATE,
    DIFFERENCE,
    REFUSED, /* distance from singularity of the systems that were refused */
    QUANTITIES
};
static const char *const quantity_names[QUANTITIES] = {
    "rnea",         "bias", "gravity",     "crba",      "crba_packed", "crba / diagonal",
    "cholesky",     "aba",  "fd_cholesky", "rotation",  "position",    "velocity",
    "acceleration", "com",  "energy",      "integrate", "difference",  "refused"};

typedef struct worst {
    double error;
    int number;
} worst;
static worst worst_of[CLASSES][QUANTITIES], current[QUANTITIES];
static int failures, class_number, robot_number;
static long robots_done, refused, accepted_singular, beyond_range;
static long of_class[CLASSES], of_quantity[QUANTITIES]; /* comparisons */

static void fail(const char *what, const char *why) {
    printf("FAIL %s: %s: %s %d: %s\n", TEXT(RBD_REAL), what, class_names[class_number], robot_number, why);
    failures++;
}

static void record(int quantity, double error) {
    worst *w = &worst_of[class_number][quantity];
    const double most = larger(w->error, error);
    of_class[class_number]++;
    of_quantity[quantity]++;
    current[quantity].error = larger(current[quantity].error, error);
    if (most > w->error) *w = (worst){most, robot_number};
}

/* Relative to the size of what was added; where nothing was, the result must be exactly so. */
static double relative(quad error, quad size) {
    if (error <= 0 && error >= 0) return 0;
    const double share = (double)((error < 0 ? -error : error) / size);
    return share >= 0 ? share : HUGE_VAL; /* not a number */
}

/* ---- a robot in the library ---- */

static sample robot;
static sample_state state;
static const rbd_model *model;
static rbd_work *work;
static void *model_memory, *work_memory;
static real q[WORLD_COORDINATES], q1[WORLD_COORDINATES], v[WORLD_DOFS], a[WORLD_DOFS], tau[WORLD_DOFS],
    f_ext[6 * WORLD_BODIES], found[WORLD_DOFS * WORLD_DOFS];
static quad wide_q[WORLD_COORDINATES], wide_v[WORLD_DOFS], wide_a[WORLD_DOFS], wide_tau[WORLD_DOFS],
    wide_f[6 * WORLD_BODIES], wide_gravity[3];
static world truth;
static double angle_unit; /* what the rounding of large angles makes of the unit of errors */

static void finite(const char *what, const real *x, int n) {
    for (int i = 0; i < n; i++)
        if (!isfinite(x[i])) {
            fail(what, "not finite");
            return;
        }
}

static int ok(const char *what, rbd_status status) {
    if (status != RBD_OK) fail(what, rbd_status_string(status));
    return status == RBD_OK;
}

/* Exactly as much memory as the library asks for, at odd addresses too: the sanitizers watch its ends. */
static int build(const rbd_body *bodies, int nb) {
    const size_t odd = robot_number % 2 ? 1 : 0, size = rbd_model_size(bodies, nb);
    rbd_report report;
    model_memory = malloc(size + odd);
    if (!ok("build", rbd_model_build(bodies, nb, (char *)model_memory + odd, size, &model, &report)))
        return 0;
    const size_t work_size = rbd_work_size(model);
    work_memory = malloc(work_size + odd);
    return ok("work", rbd_work_init(model, (char *)work_memory + odd, work_size, &work));
}

static void release(void) {
    free(model_memory);
    free(work_memory);
    model_memory = work_memory = NULL;
}

static void widen(const double *x, int n, real *y, quad *z) {
    for (int i = 0; i < n; i++) {
        y[i] = (real)x[i];
        if (z) z[i] = x[i];
    }
}

static void set_gravity(void) {
    const rbd_const g[3] = {(real)state.gravity[0], (real)state.gravity[1], (real)state.gravity[2]};
    ok("gravity", rbd_set_gravity(work, g));
}

static void load_state(void) {
    widen(state.q, robot.nq, q, wide_q);
    widen(state.q1, robot.nq, q1, NULL);
    widen(state.v, robot.nv, v, wide_v);
    widen(state.a, robot.nv, a, wide_a);
    widen(state.f_ext, 6 * robot.nb, f_ext, wide_f);
    for (int k = 0; k < 3; k++) wide_gravity[k] = state.gravity[k];
    set_gravity();
}

/* ---- the checks ---- */

static void compare(int quantity, const real *x, const quad *expected, const quad *size, int n) {
    finite(quantity_names[quantity], x, n);
    for (int i = 0; i < n; i++) record(quantity, relative(x[i] - expected[i], size[i]) / angle_unit);
}

/* No result is to be had where what is added up is beyond the scalar's largest number. */
static int in_range(const quad *size, int n) {
    const double largest = sizeof(real) == sizeof(float) ? (double)FLT_MAX : DBL_MAX;
    for (int i = 0; i < n; i++)
        if (size[i] > (quad)(largest / 16)) return 0;
    return 1;
}

/* Whether the state is one to judge. */
static int check_torques(void) {
    quad size[WORLD_DOFS];
    const int nv = robot.nv;
    world_move(&truth, robot.bodies, robot.nb, wide_q, wide_v, wide_a);
    angle_unit = fmax(1, (double)truth.largest_angle / 3.141592653589793);
    world_torques(&truth, wide_gravity, wide_a, wide_f, wide_tau, size);
    if (!in_range(size, nv)) return 0;
    if (ok("rnea", rbd_rnea(model, work, q, v, a, f_ext, found))) compare(RNEA, found, wide_tau, size, nv);
    for (int k = 0; k < nv; k++) /* for forward dynamics: of the order of what inverse dynamics adds up */
        tau[k] = (real)(state.tau[k] * (double)size[k]);
    world_move(&truth, robot.bodies, robot.nb, wide_q, wide_v, NULL);
    world_torques(&truth, wide_gravity, NULL, wide_f, wide_tau, size);
    if (ok("bias", rbd_bias(model, work, q, v, f_ext, found))) compare(BIAS, found, wide_tau, size, nv);
    world_move(&truth, robot.bodies, robot.nb, wide_q, NULL, NULL);
    world_torques(&truth, wide_gravity, NULL, NULL, wide_tau, size);
    if (ok("gravity", rbd_gravity_torque(model, work, q, found))) compare(GRAVITY, found, wide_tau, size, nv);
    return 1;
}

static quad M[WORLD_DOFS * WORLD_DOFS], M_size[WORLD_DOFS];

static void check_mass_matrix(void) {
    static real H[WORLD_DOFS * WORLD_DOFS];
    const int nv = robot.nv;
    world_mass_matrix(&truth, M, M_size);
    if (!ok("crba", rbd_crba(model, work, q, found)) || !ok("packed", rbd_crba_packed(model, work, q, H)))
        return;
    finite("crba", found, nv * nv);
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++) {
            const quad error = found[i * nv + j] - M[i * nv + j];
            const int at = i >= j ? rbd_packed_index(model, i, j) : -1;
            record(CRBA, relative(error, world_sqrt(M_size[i] * M_size[j])) / angle_unit);
            record(DIAGONAL, relative(error, world_sqrt(M[i * (nv + 1)] * M[j * (nv + 1)])) / angle_unit);
            if (i < j) continue;
            const quad packed = at < 0 ? 0 : H[at];
            record(PACKED, relative(packed - M[i * nv + j], world_sqrt(M_size[i] * M_size[j])) / angle_unit);
        }
}

/* |M x - b| by rows, relative to what the product adds up */
static void check_cholesky(void) {
    static real L[WORLD_DOFS * WORLD_DOFS], x[WORLD_DOFS];
    const int nv = robot.nv;
    if (rbd_cholesky_factor(model, work, found, L) != RBD_OK) return; /* judged by fd_cholesky */
    if (!ok("solve", rbd_cholesky_solve(model, work, L, tau, x))) return;
    finite("solve", x, nv);
    for (int i = 0; i < nv; i++) {
        quad residual = -(quad)tau[i], size = tau[i] < 0 ? -tau[i] : tau[i];
        for (int j = 0; j < nv; j++) {
            residual += M[i * nv + j] * x[j];
            size += world_sqrt(M_size[i] * M_size[j]) * (x[j] < 0 ? -x[j] : x[j]);
        }
        record(CHOLESKY, relative(residual, size) / angle_unit);
    }
}

typedef rbd_status forward(const rbd_model *m, rbd_work *w, const real *q, const real *v, const real *tau,
                           const real *f_ext, real *a);

/* The torques that the accelerations found would need, against those that were given. */
static void check_forward(int quantity, forward *call, quad distance) {
    quad size[WORLD_DOFS], given[WORLD_DOFS];
    real out[WORLD_DOFS];
    const rbd_status status = call(model, work, q, v, tau, f_ext, out);
    if (status == RBD_ERR_SINGULAR) {
        refused++;
        record(REFUSED, (double)distance / angle_unit);
        return;
    }
    if (!ok(quantity_names[quantity], status)) return;
    accepted_singular += distance < (quad)(epsilon / 16) && angle_unit < 2; /* else the angles decide */
    for (int k = 0; k < robot.nv; k++) {
        wide_a[k] = out[k];
        given[k] = tau[k];
    }
    finite(quantity_names[quantity], out, robot.nv);
    world_move(&truth, robot.bodies, robot.nb, wide_q, wide_v, wide_a);
    world_torques(&truth, wide_gravity, wide_a, wide_f, wide_tau, size);
    for (int k = 0; k < robot.nv; k++) {
        const quad magnitude = given[k] < 0 ? -given[k] : given[k];
        record(quantity, relative(wide_tau[k] - given[k], size[k] + magnitude) / angle_unit);
    }
}

static void check_forwards(void) {
    static quad copy[WORLD_DOFS * WORLD_DOFS];
    memcpy(copy, M, sizeof copy);
    const quad distance = world_distance(copy, M_size, robot.nv);
    check_forward(ABA, rbd_aba, distance);
    check_forward(FD_CHOLESKY, rbd_fd_cholesky, distance);
}

/* World vector x in link axes. */
static void to_link(const quad R[9], const quad x[3], quad out[3]) {
    for (int i = 0; i < 3; i++) out[i] = R[i] * x[0] + R[3 + i] * x[1] + R[6 + i] * x[2];
}

static void compare3(int quantity, const real *x, const quad *expected, quad size) {
    const quad sizes[3] = {size, size, size};
    compare(quantity, x, expected, sizes, 3);
}

static void check_body(int body) {
    const world_element *e = &truth.element[truth.last[body]];
    const quad unit[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    const quad wv[3] = {e->w[1] * e->v[2] - e->w[2] * e->v[1], e->w[2] * e->v[0] - e->w[0] * e->v[2],
                        e->w[0] * e->v[1] - e->w[1] * e->v[0]};
    quad x[3];
    real R[9], p[3], y[6];
    ok("pose", rbd_body_pose(model, work, body, R, p));
    compare(ORIENTATION, R, e->R, unit, 9);
    compare3(POSITION, p, e->p, truth.p_size[body]);
    ok("velocity", rbd_body_velocity(model, work, body, y));
    to_link(e->R, e->w, x);
    compare3(VELOCITY, y, x, e->w_size);
    to_link(e->R, e->v, x);
    compare3(VELOCITY, y + 3, x, truth.v_size[body]);
    ok("classical", rbd_body_acceleration_classical(model, work, body, y));
    to_link(e->R, e->alpha, x);
    compare3(ACCELERATION, y, x, e->alpha_size);
    to_link(e->R, e->a, x);
    compare3(ACCELERATION, y + 3, x, truth.a_size[body]);
    ok("acceleration", rbd_body_acceleration(model, work, body, y));
    const quad spatial[3] = {e->a[0] - wv[0], e->a[1] - wv[1], e->a[2] - wv[2]};
    to_link(e->R, spatial, x);
    compare3(ACCELERATION, y + 3, x, truth.a_size[body] + e->w_size * truth.v_size[body]);
}

static void check_kinematics(void) {
    world_totals t;
    real x[9], energy[2];
    widen(state.a, robot.nv, a, wide_a);
    world_move(&truth, robot.bodies, robot.nb, wide_q, wide_v, wide_a);
    if (!ok("kinematics", rbd_kinematics(model, work, q, v, a))) return;
    for (int i = 0; i < robot.nb; i++) check_body(i);
    world_total(&truth, wide_gravity, wide_v, &t);
    ok("com", rbd_com(model, work, x, x + 3, x + 6));
    for (int k = 0; k < 3; k++) compare3(COM, x + 3 * k, t.com[k], t.com_size[k]);
    ok("energy", rbd_energy(model, work, &energy[0], &energy[1]));
    if (in_range(t.energy_size, 2)) compare(ENERGY, energy, t.energy, t.energy_size, 2);
}

/* A step from q by v dt; and the step from q to q1 must lead there. */
static void check_manifold(void) {
    static real reached[WORLD_COORDINATES], d[WORLD_DOFS];
    const real dt = (real)0.125;
    ok("integrate", rbd_integrate(model, q, v, dt, reached));
    ok("difference", rbd_difference(model, q, q1, d));
    finite("integrate", reached, robot.nq);
    finite("difference", d, robot.nv);
    for (int i = 0, iq = 0, iv = 0; i < robot.nb; i++) {
        const rbd_body *b = &robot.bodies[i];
        const int nq = world_nq(b), nv = world_nv(b), first = b->type == RBD_FLOATING ? 3 : 0;
        quad step[6], next[7], size[7], sign = 1, norm = 0, along = 0;
        for (int k = 0; k < nv; k++) step[k] = v[iv + k] * dt;
        if (nv > 0) world_step(b, &wide_q[iq], step, next, size);
        for (int k = 0; k < nq; k++) record(INTEGRATE, relative(reached[iq + k] - next[k], size[k]));
        for (int k = 0; k < nv; k++) step[k] = d[iv + k];
        if (nv > 0) world_step(b, &wide_q[iq], step, next, size);
        for (int k = first; k < nq && nq > nv; k++) { /* unit vectors: the length of q1 does not count */
            norm += (quad)q1[iq + k] * q1[iq + k];
            along += q1[iq + k] * next[k];
        }
        if (nq - first == 4 && along < 0) sign = -1;
        for (int k = 0; k < nq; k++) {
            const int is_unit = nq > nv && k >= first;
            quad error = is_unit ? sign * next[k] - q1[iq + k] / world_sqrt(norm) : next[k] - q1[iq + k];
            if (b->type == RBD_PLANAR && k == 2) /* whole turns do not count */
                error = (quad)remainder((double)error, 6.283185307179586476925);
            record(DIFFERENCE, relative(error, size[k] + (is_unit ? 0 : fabs((double)q1[iq + k]))));
        }
        iq += nq, iv += nv;
    }
}

/* Where the roots stand does not matter to the dynamics: not a bit. */
static void check_moved_base(void) {
    static real before[WORLD_DOFS * (WORLD_DOFS + 2)], after[WORLD_DOFS * (WORLD_DOFS + 2)];
    static sample elsewhere;
    const int nv = robot.nv;
    elsewhere = robot;
    for (int i = 0; i < robot.nb; i++)
        for (int k = 0; k < 3 && robot.bodies[i].parent < 0; k++)
            elsewhere.bodies[i].position[k] += uniform(&elsewhere.seed, -1e6, 1e6);
    for (int round = 0; round < 2; round++) {
        real *x = round ? after : before;
        memset(x, 0, sizeof before);
        release();
        if (!build(round ? elsewhere.bodies : robot.bodies, robot.nb)) return;
        set_gravity();
        rbd_rnea(model, work, q, v, a, f_ext, x);
        rbd_crba(model, work, q, x + nv);
        if (rbd_aba(model, work, q, v, tau, f_ext, x + nv + nv * nv) != RBD_OK)
            memset(x + nv + nv * nv, 0, (size_t)nv * sizeof *x);
    }
    for (int i = 0; i < nv * (nv + 2); i++)
        if (before[i] < after[i] || before[i] > after[i]) {
            fail("another place", "other bits");
            return;
        }
}

static void run_robot(int class_of, int number) {
    class_number = class_of;
    robot_number = number;
    memset(current, 0, sizeof current);
    draw_robot(&robot, class_of, number);
    if (build(robot.bodies, robot.nb)) {
        for (int k = 0; k < 2; k++) {
            draw_state(&robot, &state);
            load_state();
            if (!check_torques()) {
                beyond_range++;
                continue;
            }
            check_mass_matrix();
            check_cholesky();
            check_forwards();
            check_kinematics();
            check_manifold();
        }
        check_moved_base();
    }
    release();
    robots_done++;
}

/* ---- tables ---- */

static void print_worst(void) {
    printf("%-16s", TEXT(RBD_REAL));
    for (int c = 0; c < CLASSES; c++) printf(" %15s", class_names[c]);
    for (int k = 0; k < QUANTITIES; k++) {
        printf("\n%-16s", quantity_names[k]);
        for (int c = 0; c < CLASSES; c++) printf(" %7.1e %7d", worst_of[c][k].error, worst_of[c][k].number);
    }
    printf(
        "\n%ld robots; %ld systems refused as singular, %ld accepted though singular, %ld states beyond the "
        "scalar's range; %d failures\n",
        robots_done, refused, accepted_singular, beyond_range, failures);
}

/* The published bound: twice the worst error, to one digit, rounded up; at least the rounding unit. */
static double bound_of(double error) {
    char text[32];
    const double bound = fmax(2 * error, epsilon);
    snprintf(text, sizeof text, "%.0e", bound);
    if (strtod(text, NULL) < bound)
        snprintf(text, sizeof text, "%.0e", bound + pow(10, floor(log10(bound))) / 2);
    return strtod(text, NULL);
}

static void print_rows(void) {
    for (int k = 0; k < QUANTITIES; k++) {
        printf("| %s |", quantity_names[k]);
        for (int c = 0; c < CLASSES; c++) printf(" %.0e |", bound_of(worst_of[c][k].error));
        printf("\n");
    }
}

static int quantity_of(const char *row) {
    for (int k = 0; k < QUANTITIES; k++) {
        const size_t n = strlen(quantity_names[k]);
        if (strncmp(row, "| ", 2) == 0 && strncmp(row + 2, quantity_names[k], n) == 0 &&
            strncmp(row + 2 + n, " |", 2) == 0)
            return k;
    }
    return -1;
}

static void hold_row(int quantity, const char *row) {
    const char *at = strchr(row + 2, '|');
    for (int c = 0; c < CLASSES; c++) {
        char *end = NULL;
        const double bound = at ? strtod(at + 1, &end) : -1;
        const worst *w = &worst_of[c][quantity];
        at = end ? strchr(end, '|') : NULL;
        if (!(w->error <= bound)) {
            printf("FAIL %s: %s: %.2e exceeds %.0e: %s %d\n", TEXT(RBD_REAL), quantity_names[quantity],
                   w->error, bound, class_names[c], w->number);
            failures++;
        }
    }
}

static void expect_compared(const char *what, long comparisons) {
    if (comparisons > 0) return;
    printf("FAIL %s: %s: nothing is compared\n", TEXT(RBD_REAL), what);
    failures++;
}

/* Compares with the rows under the heading that names the scalar. */
static void hold(const char *path) {
    char line[400];
    int here = 0, rows = 0;
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        const int quantity = quantity_of(line);
        if (strncmp(line, "## ", 3) == 0) here = strcmp(line, "## " TEXT(RBD_REAL) "\n") == 0;
        if (here && quantity >= 0) {
            hold_row(quantity, line);
            rows++;
        }
    }
    if (file) fclose(file);
    for (int c = 0; c < CLASSES; c++) expect_compared(class_names[c], of_class[c]);
    for (int k = 0; k < QUANTITIES; k++) expect_compared(quantity_names[k], of_quantity[k]);
    if (rows != QUANTITIES) {
        printf("FAIL %s: %d rows for " TEXT(RBD_REAL) " instead of %d\n", path, rows, (int)QUANTITIES);
        failures++;
    }
}

static int class_of(const char *name) {
    for (int c = 0; c < CLASSES; c++)
        if (strcmp(class_names[c], name) == 0) return c;
    printf("no such class: %s\n", name);
    exit(2);
}

static void show_one(int class_of_robot, int number) {
    run_robot(class_of_robot, number);
    draw_robot(&robot, class_of_robot, number);
    print_robot(&robot);
    for (int k = 0; k < 2; k++) {
        draw_state(&robot, &state);
        print_state(&robot, &state);
    }
    for (int k = 0; k < QUANTITIES; k++) printf("%-16s %.2e\n", quantity_names[k], current[k].error);
}

int main(int argc, char **argv) {
    int robots = 200, publish = 0;
    double seconds = 0;
    const char *document = NULL;
    for (int i = 1; i < argc; i++) {
        const int more = argc - 1 - i;
        if (strcmp(argv[i], "--publish") == 0)
            publish = 1;
        else if (more > 0 && strcmp(argv[i], "--seconds") == 0)
            seconds = atof(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--robots") == 0)
            robots = atoi(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--hold") == 0)
            document = argv[++i];
        else if (more > 1 && strcmp(argv[i], "--one") == 0) {
            show_one(class_of(argv[i + 1]), atoi(argv[i + 2]));
            return failures > 0;
        } else {
            printf("usage: see the head of library.c\n");
            return 2;
        }
    }
    const time_t start = time(NULL);
    for (int number = 0; seconds > 0 ? difftime(time(NULL), start) < seconds : number < robots; number++)
        for (int c = 0; c < CLASSES; c++) run_robot(c, number);
    if (publish)
        print_rows();
    else
        print_worst();
    if (document) hold(document);
    return failures > 0 || robots_done == 0;
}
