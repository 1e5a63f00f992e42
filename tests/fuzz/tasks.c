/* tasks.c - random problems of whole-body control for rbd_tasks.h, each answer judged on its own.

   usage: tasks [--problems N | --seconds N] [--seed N]     so many problems, 2,000

   Random robots with random tasks, contacts, limits and levels, by velocities and by accelerations. The judge
   takes Jacobians from velocities of points for unit speeds, and the dynamics from rbd_rnea. It checks that

   - contacts are held, motors and joints are within limits, forces within friction, passive dofs without
     torque, and M a + c = tau + J'f, each row to what RBD_TASKS_OK promises;
   - a level leaves the residuals of those before as they were;
   - no feasible move makes the last level better: along the gradient, projected onto what limits leave, with
     each of the limits that hold left out in turn, and random ones;
   - of a problem that is called infeasible projections onto its rows find no answer either;
   - what a level tells its QP of its zeros is so: without being told the QP has the same answer, to the last
     bit, and with some rows soft and guesses that are wrong too;
   - a field that is NaN, 1e30 or -1 where it must not be is refused by name, and outputs are as they were.

   An answer of a QP that is not exact, but near enough to be called so, is judged by its rows alone. Prints a
   table. Fails if anything is wrong, if in float a move gains more than 1 % of the objective's terms in one
   answer of 200, or if more than 1 % of the answers are inexact, 3 % in float. */
#define RBD_IMPLEMENTATION
#include "../larger.h"
#include "rbd_tasks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "robots.h"

enum { DOFS = 24, CONTACTS = 3, TASKS = 4, OWN_ROWS = 2, N = DOFS + 3 * CONTACTS, ROWS = 160 };

static const double pi = 3.14159265358979323846;
static const int in_float = sizeof(rbd_real) == 4;
static const double epsilon = sizeof(rbd_real) == 4 ? 1.2e-7 : 2.3e-16;

/* lower <= c x <= upper; x: velocities, or accelerations and the forces of contacts in world axes. */
typedef struct hard_rows {
    int count;
    double c[ROWS][N], lower[ROWS], upper[ROWS];
    double rounding[ROWS]; /* of the side, where it is a difference of larger numbers */
    int of_place[ROWS];    /* whether the entries are of a point, whose place has rounding of 1 m */
} hard_rows;

/* The objective of a level: weight r^2 / 2 each, r = c x - y. */
typedef struct squares {
    int count;
    double c[ROWS][N], weight[ROWS], r[ROWS];
} squares;

typedef struct problem {
    sample s;
    const rbd_model *m;
    rbd_work *w;
    int nv, n, accelerations, levels;
    rbd_tasks p;
    rbd_task task[TASKS];
    rbd_task_contact contact[CONTACTS];
    rbd_real q[WORLD_COORDINATES], v[WORLD_DOFS], there[WORLD_COORDINATES], f_ext[6 * WORLD_BODIES];
    rbd_real lower[DOFS], upper[DOFS], speed[DOFS], torque[DOFS], acceleration[DOFS];
    rbd_real jacobian[OWN_ROWS * DOFS], y[OWN_ROWS];
    unsigned char passive[DOFS];
} problem;

typedef struct answer {
    rbd_tasks_status status;
    rbd_tasks_result result;
    rbd_real x[DOFS], forces[3 * CONTACTS], tau[DOFS];
} answer;

static problem g;
static unsigned char model_memory[200000], work_memory[200000], memory[1000000];
static long wrong;
static uint64_t number;

static void fail(const char *what, double by) {
    if (wrong++ < 30) printf("--seed %llu: %s: %g\n", (unsigned long long)number, what, by);
}

static int below(uint64_t *seed, int n) { return (int)uniform(seed, 0, n); }

static double dot(const double *a, const double *b, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static double length_of(const double *a, int n) { return sqrt(dot(a, a, n)); }

/* ---- a random problem ---- */

static void draw_numbers(uint64_t *seed, rbd_real *x, int n, double low, double high) {
    for (int i = 0; i < n; i++) x[i] = (rbd_real)uniform(seed, low, high);
}

/* A robot that has few enough dofs. */
static void draw_body(uint64_t *seed) {
    static const int classes[3] = {ORDINARY, AXES, FOLLOWERS};
    do {
        const int kind = classes[below(seed, 3)];
        draw_robot(&g.s, kind, below(seed, 1 << 30));
    } while (rbd_model_build(g.s.bodies, g.s.nb, model_memory, sizeof model_memory, &g.m, NULL) != RBD_OK ||
             rbd_nv(g.m) > DOFS || rbd_nv(g.m) < 1);
    if (rbd_work_init(g.m, work_memory, sizeof work_memory, &g.w) != RBD_OK) exit(2);
    g.nv = rbd_nv(g.m);
}

static void draw_rotation(uint64_t *seed, rbd_real R[9]) {
    const double turn = uniform(seed, -2, 2), c = cos(turn), s = sin(turn);
    const double about[3][9] = {
        {c, -s, 0, s, c, 0, 0, 0, 1}, {c, 0, s, 0, 1, 0, -s, 0, c}, {1, 0, 0, 0, c, -s, 0, s, c}};
    const int axis = below(seed, 4);
    for (int i = 0; i < 9; i++) R[i] = axis < 3 ? (rbd_real)about[axis][i] : 0;
}

/* Rows of velocity and acceleration that a kind reads. */
static int first_of(const rbd_task *t) {
    return t->kind == RBD_TASK_POINT || t->kind == RBD_TASK_COM ? 3 : 0;
}
static int end_of(const rbd_task *t) {
    if (t->kind >= RBD_TASK_POSTURE) return 0;
    return t->kind == RBD_TASK_ROTATION || t->kind == RBD_TASK_AXIS ? 3 : 6;
}

static void draw_task(uint64_t *seed, rbd_task *t, int level) {
    t->kind = (rbd_task_kind)(1 + below(seed, RBD_TASK_ROWS));
    t->level = level;
    t->weight = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 0.1, 10);
    t->gain = below(seed, 4) ? (rbd_real)uniform(seed, 0.5, 10) : 0;
    t->damping = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 0.3, 2);
    t->body = below(seed, g.s.nb);
    t->reference = below(seed, g.s.nb + 1) - 1;
    if (below(seed, 2)) draw_numbers(seed, t->point, 3, -0.3, 0.3);
    draw_numbers(seed, t->position, 3, -1, 1);
    draw_rotation(seed, t->rotation);
    draw_numbers(seed, t->axis, 3, 0.2, 1);
    draw_numbers(seed, t->direction, 3, -1, -0.2);
    t->direction[0] = -t->direction[0];
    if (below(seed, 2)) draw_numbers(seed, t->velocity, 6, -1, 1);
    if (below(seed, 2)) draw_numbers(seed, t->acceleration, 6, -5, 5);
    for (int i = 0; i < 6; i++) t->loose[i] = !below(seed, 6);
    for (int i = 0; i < 6; i++) { /* rows that the kind has not are 0 */
        if (i >= first_of(t) && i < end_of(t)) continue;
        t->velocity[i] = t->acceleration[i] = 0;
        t->loose[i] = 0;
    }
    if (t->kind == RBD_TASK_POSTURE) t->q = g.there;
    if (t->kind == RBD_TASK_ROWS) {
        t->rows = OWN_ROWS;
        t->jacobian = g.jacobian;
        t->y = g.y;
    }
}

static void draw_contact(uint64_t *seed, rbd_task_contact *c) {
    c->body = below(seed, g.s.nb);
    c->open = !below(seed, 4);
    draw_numbers(seed, c->point, 3, -0.3, 0.3);
    if (below(seed, 2)) draw_numbers(seed, c->normal, 3, 0.1, 1);
    c->friction = (rbd_real)uniform(seed, 0, 1.2);
    c->sides = 4 * below(seed, 3);
    c->least = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 0, 5);
    c->most = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 10, 500);
    c->cost = below(seed, 2) ? 0 : (rbd_real)1e-3;
    c->gain = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 1, 50);
}

/* Limits around the state, some of which the state is beyond. */
static void draw_limits(uint64_t *seed) {
    for (int i = 0; i < g.nv; i++) {
        g.lower[i] = below(seed, 3) ? (rbd_real)uniform(seed, -6, 1) : (rbd_real)-RBD_QP_NONE;
        g.upper[i] = below(seed, 3) ? (rbd_real)uniform(seed, 1, 6) : (rbd_real)RBD_QP_NONE;
        g.speed[i] = below(seed, 2) ? (rbd_real)uniform(seed, 0.5, 6) : 0;
        g.torque[i] = below(seed, 2) ? (rbd_real)uniform(seed, 5, 500) : 0;
        g.acceleration[i] = below(seed, 2) ? (rbd_real)uniform(seed, 1, 100) : 0;
        g.passive[i] = !below(seed, 5);
    }
    if (below(seed, 2)) g.p.lower = g.lower;
    if (below(seed, 2)) g.p.upper = g.upper;
    if (below(seed, 2)) g.p.speed = g.speed;
    if (below(seed, 2)) g.p.torque = g.torque;
    if (below(seed, 2)) g.p.acceleration = g.acceleration;
    if (below(seed, 2)) g.p.passive = g.passive;
    g.p.without = below(seed, 2) ? 0 : below(seed, 8);
    g.p.braking = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 1, 100);
}

static void draw_problem(uint64_t start) {
    uint64_t seed = start;
    sample_state x;
    memset(&g, 0, sizeof g);
    draw_body(&seed);
    draw_state(&g.s, &x);

    g.accelerations = below(&seed, 2);
    const double pace = below(&seed, 2) ? 0 : uniform(&seed, 0, 0.5);
    rbd_random(g.m, &seed, g.q);
    rbd_random(g.m, &seed, g.there);
    for (int i = 0; i < g.nv; i++) g.v[i] = (rbd_real)(pace * uniform(&seed, -3, 3));
    for (int i = 0; i < 6 * g.s.nb; i++) g.f_ext[i] = (rbd_real)x.f_ext[i];
    draw_numbers(&seed, g.jacobian, OWN_ROWS * g.nv, -1, 1);
    draw_numbers(&seed, g.y, OWN_ROWS, -2, 2);

    g.p.task = g.task;
    g.p.tasks = below(&seed, TASKS + 1);
    g.levels = 1 + below(&seed, 3);
    for (int i = 0; i < TASKS; i++) draw_task(&seed, &g.task[i], i * g.levels / TASKS);
    g.p.contact = g.contact;
    g.p.contacts = below(&seed, CONTACTS + 1);
    for (int i = 0; i < CONTACTS; i++) draw_contact(&seed, &g.contact[i]);

    g.p.dt = (rbd_real)uniform(&seed, 0.5e-3, 10e-3);
    draw_limits(&seed);
    if (below(&seed, 2)) g.p.f_ext = g.f_ext;
    g.p.motion_cost = below(&seed, 2) ? 0 : (rbd_real)1e-3;
    g.n = g.nv + (g.accelerations ? 3 * g.p.contacts : 0);
}

/* The answer with the first tasks. */
static void solve(int tasks, answer *a) {
    rbd_tasks p = g.p;
    p.tasks = tasks;
    memset(a, 0, sizeof *a);
    memcpy(a->x, g.v, (size_t)g.nv * sizeof *g.v);
    const size_t size = rbd_tasks_size(g.m, &p);
    if (size == 0 || size > sizeof memory) fail("size", (double)size);
    a->status = g.accelerations ? rbd_tasks_acceleration(g.m, g.w, &p, g.q, g.v, memory, size, a->x,
                                                         a->forces, a->tau, &a->result)
                                : rbd_tasks_velocity(g.m, g.w, &p, g.q, memory, size, a->x, &a->result);
}

/* ---- kinematics and dynamics by long hand ---- */

static void move(const rbd_real *v, const rbd_real *a) {
    if (rbd_kinematics(g.m, g.w, g.q, v, a) != RBD_OK) exit(3);
}

static void cross(const double *a, const double *b, double *c) {
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    c[0] = x;
    c[1] = y;
    c[2] = z;
}

/* A wish is half a turn away: rounding says whether to the left or to the right. */
static int half_turn;

/* Rotation vector of R. */
static void log_of(const double R[9], double w[3]) {
    const double s[3] = {(R[7] - R[5]) / 2, (R[2] - R[6]) / 2, (R[3] - R[1]) / 2};
    const double sine = length_of(s, 3), cosine = (R[0] + R[4] + R[8] - 1) / 2, angle = atan2(sine, cosine);
    half_turn |= angle > pi - (in_float ? 1e-3 : 1e-7);
    for (int i = 0; i < 3; i++) w[i] = s[i] * (sine > 1e-9 ? angle / sine : 1);
}

typedef struct motion {
    double R[9], p[3], velocity[6], rate[6];
} motion;

/* Pose and motion of a point after move(). body -1: the world. */
static void motion_of(int body, const rbd_real *point, motion *s) {
    rbd_real R[9], p[3], v[6], a[6];
    memset(s, 0, sizeof *s);
    s->R[0] = s->R[4] = s->R[8] = 1;
    if (body < 0) return;
    rbd_body_pose(g.m, g.w, body, R, NULL);
    rbd_point_position(g.m, g.w, body, point, p);
    rbd_point_velocity(g.m, g.w, body, point, RBD_WORLD_AXES, v);
    rbd_point_acceleration(g.m, g.w, body, point, RBD_WORLD_AXES, a);
    for (int i = 0; i < 9; i++) s->R[i] = (double)R[i];
    for (int i = 0; i < 3; i++) s->p[i] = (double)p[i];
    for (int i = 0; i < 6; i++) s->velocity[i] = (double)v[i];
    for (int i = 0; i < 6; i++) s->rate[i] = (double)a[i];
}

/* The motion of b as seen in the axes of a: w = E (w_b - w_a), v = E (v_b - v_a - w_a x d), and their rates.
 */
static void relative(const motion *a, const motion *b, motion *s) {
    double d[3], turn[3], spin[3], seen[3], rate[6], t[3];
    for (int i = 0; i < 3; i++) d[i] = b->p[i] - a->p[i];
    cross(a->velocity, d, turn);
    for (int i = 0; i < 3; i++) seen[i] = b->velocity[3 + i] - a->velocity[3 + i] - turn[i];

    cross(a->velocity, b->velocity, spin);
    for (int i = 0; i < 3; i++) rate[i] = b->rate[i] - a->rate[i] - spin[i];
    cross(a->rate, d, t);
    for (int i = 0; i < 3; i++) rate[3 + i] = b->rate[3 + i] - a->rate[3 + i] - t[i];
    cross(a->velocity, turn, t);
    for (int i = 0; i < 3; i++) rate[3 + i] -= t[i];
    cross(a->velocity, seen, t);
    for (int i = 0; i < 3; i++) rate[3 + i] -= 2 * t[i];

    for (int i = 0; i < 3; i++) {
        const double column[3] = {a->R[i], a->R[3 + i], a->R[6 + i]};
        double omega[3];
        for (int k = 0; k < 3; k++) omega[k] = b->velocity[k] - a->velocity[k];
        s->p[i] = dot(column, d, 3);
        s->velocity[i] = dot(column, omega, 3);
        s->velocity[3 + i] = dot(column, seen, 3);
        s->rate[i] = dot(column, rate, 3);
        s->rate[3 + i] = dot(column, rate + 3, 3);
        for (int j = 0; j < 3; j++) {
            s->R[3 * i + j] = 0;
            for (int k = 0; k < 3; k++) s->R[3 * i + j] += a->R[3 * k + i] * b->R[3 * k + j];
        }
    }
}

/* ---- residuals of tasks ---- */

/* e, u and the rate of u of a task, in the state of move(). Returns its rows; those before `first` do not
   count. */
static int look(const rbd_task *t, int *first, double *e, double *u, double *rate) {
    rbd_real p[3], v[6], a[6];
    motion s, own, other;
    *first = first_of(t);
    memset(e, 0, 6 * sizeof *e);

    if (t->kind == RBD_TASK_MOMENTUM) {
        rbd_momentum(g.m, g.w, v, a);
        for (int i = 0; i < 6; i++) u[i] = (double)v[i];
        for (int i = 0; i < 6; i++) rate[i] = (double)a[i];
        return 6;
    }
    if (t->kind == RBD_TASK_COM) {
        rbd_com(g.m, g.w, p, v, a);
        for (int i = 0; i < 3; i++) {
            e[3 + i] = (double)(t->position[i] - p[i]);
            u[3 + i] = (double)v[i];
            rate[3 + i] = (double)a[i];
        }
        return 6;
    }

    motion_of(t->body, t->kind == RBD_TASK_AXIS ? NULL : t->point, &own);
    s = own;
    motion_of(t->reference, NULL, &other);
    if (t->kind == RBD_TASK_RELATIVE && t->reference >= 0) relative(&other, &own, &s);
    memcpy(u, s.velocity, sizeof s.velocity);
    memcpy(rate, s.rate, sizeof s.rate);
    if (t->kind == RBD_TASK_AXIS) {
        double axis[3], to[3], turned[3], along = 0, size = 0, size_to = 0, spin[3];
        for (int i = 0; i < 3; i++) size += pow((double)t->axis[i], 2);
        for (int i = 0; i < 3; i++) size_to += pow((double)t->direction[i], 2);
        for (int i = 0; i < 3; i++) {
            axis[i] = 0;
            for (int k = 0; k < 3; k++) axis[i] += s.R[3 * i + k] * (double)t->axis[k] / sqrt(size);
            to[i] = (double)t->direction[i] / sqrt(size_to);
        }
        cross(axis, to, turned);
        const double sine = length_of(turned, 3), angle = atan2(sine, dot(axis, to, 3));
        half_turn |= angle > pi - (in_float ? 1e-3 : 1e-7);
        cross(s.velocity, axis, spin);
        along = dot(s.velocity, axis, 3);
        const double rate_along = dot(s.rate, axis, 3);
        for (int i = 0; i < 3; i++) {
            e[i] = turned[i] * (sine > 1e-9 ? angle / sine : 1);
            u[i] = s.velocity[i] - along * axis[i];
            rate[i] = s.rate[i] - rate_along * axis[i] - along * spin[i];
        }
        return 3;
    }

    double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, turn[9], any = 0;
    for (int i = 0; i < 9; i++) any += fabs((double)t->rotation[i]);
    for (int i = 0; i < 9 && any > 0; i++) R[i] = (double)t->rotation[i];
    for (int i = 0; i < 9; i++) turn[i] = dot(&R[3 * (i / 3)], &s.R[3 * (i % 3)], 3);
    if (t->kind != RBD_TASK_POINT) log_of(turn, e);
    for (int i = 0; i < 3; i++) e[3 + i] = (double)t->position[i] - s.p[i];
    return t->kind == RBD_TASK_ROTATION ? 3 : 6;
}

static int is_passive(int dof) {
    if (g.p.passive) return g.p.passive[dof] != 0;
    for (int i = 0, iv = 0; i < g.s.nb; i++) {
        if (g.s.bodies[i].mimic) continue;
        const int nv = world_nv(&g.s.bodies[i]);
        if (dof >= iv && dof < iv + nv) return g.s.bodies[i].type == RBD_FLOATING;
        iv += nv;
    }
    return 0;
}

static double *append_square(squares *o, double weight, double r) {
    double *c = o->c[o->count];
    memset(c, 0, N * sizeof *c);
    o->weight[o->count] = weight;
    o->r[o->count++] = r;
    return c;
}

/* u of J x, at present or at the speeds x. */
static double wish(const rbd_task *t, double velocity, double acceleration, double e, double u) {
    const double k = (double)t->gain, damping = t->damping > 0 ? (double)t->damping : 1;
    if (!g.accelerations) return velocity + (t->kind == RBD_TASK_MOMENTUM ? 0 : k * e);
    if (t->kind == RBD_TASK_MOMENTUM) return acceleration + k * (velocity - u);
    return acceleration + k * k * e + 2 * damping * k * (velocity - u);
}

static void put_bodies(const rbd_task *t, const rbd_real *x, squares *o, double weight) {
    double e[6], u[6], rate[6], own[6], J[6][DOFS];
    int first, rows = 6;
    for (int i = 0; i < g.nv; i++) {
        rbd_real unit[WORLD_DOFS] = {0};
        unit[i] = 1;
        move(unit, NULL);
        rows = look(t, &first, e, u, rate);
        for (int r = 0; r < rows; r++) J[r][i] = u[r];
    }
    move(g.accelerations ? g.v : x, g.accelerations ? x : NULL);
    look(t, &first, e, u, rate);
    for (int r = first; r < rows; r++) own[r] = g.accelerations ? rate[r] : u[r];
    for (int r = first; r < rows; r++) {
        if (t->loose[r]) continue;
        const double y = wish(t, (double)t->velocity[r], (double)t->acceleration[r], e[r], u[r]);
        memcpy(append_square(o, weight, own[r] - y), J[r], (size_t)g.nv * sizeof **J);
    }
}

/* The squares of the tasks of a level, at x. */
static void put_level(int level, int tasks, const rbd_real *x, squares *o) {
    o->count = 0;
    for (int i = 0; i < tasks; i++) {
        const rbd_task *t = &g.task[i];
        const double weight = t->weight > 0 ? (double)t->weight : 1;
        if (t->level != level) continue;
        if (t->kind == RBD_TASK_POSTURE) {
            rbd_real e[WORLD_DOFS];
            rbd_difference(g.m, g.q, t->q, e);
            for (int k = 0; k < g.nv; k++)
                if (!is_passive(k))
                    append_square(o, weight, (double)x[k] - wish(t, 0, 0, (double)e[k], (double)g.v[k]))[k] =
                        1;
        } else if (t->kind == RBD_TASK_ROWS) {
            for (int r = 0; r < OWN_ROWS; r++) {
                double *c = append_square(o, weight, -(double)g.y[r]);
                for (int k = 0; k < g.nv; k++) c[k] = (double)g.jacobian[r * g.nv + k];
                for (int k = 0; k < g.nv; k++) o->r[o->count - 1] += c[k] * (double)x[k];
            }
        } else {
            put_bodies(t, x, o, weight);
        }
    }
}

/* ---- hard rows ---- */

static double *append_row(hard_rows *h, double lower, double upper) {
    double *c = h->c[h->count];
    memset(c, 0, N * sizeof *c);
    h->lower[h->count] = lower;
    h->upper[h->count] = upper;
    h->rounding[h->count] = 0;
    h->of_place[h->count++] = 0;
    return c;
}

/* The speed at s before a stop, from v^2 + 2 b dt v = 2 b s; it is odd. */
static double speed_at(double s, double b, double dt) {
    const double way = fabs(s), v = sqrt(b * b * dt * dt + 2 * b * way) - b * dt;
    return s < 0 ? -v : v;
}

static double within(double x, double most) { return fmax(-most, fmin(x, most)); }

/* Velocities that dof i may have, as the header's limits say. */
static void limits_of(int i, int iq, double *low, double *high) {
    const double none = RBD_QP_NONE, dt = (double)g.p.dt;
    const double most = g.p.acceleration ? (double)g.acceleration[i] : 0;
    const double b = most > 0 ? most : g.p.braking > 0 ? (double)g.p.braking : 10;
    double speed = none, v = (double)g.v[i];
    if (!(g.p.without & RBD_WITHOUT_SPEED) && g.p.speed && g.speed[i] > 0) speed = (double)g.speed[i];
    *low = -speed;
    *high = speed;
    if (iq >= 0 && !(g.p.without & RBD_WITHOUT_POSITION)) {
        if (g.p.lower && (double)g.lower[i] > -none / 2)
            *low = within(-speed_at((double)(g.q[iq] - g.lower[i]), b, dt), speed);
        if (g.p.upper && (double)g.upper[i] < none / 2)
            *high = within(speed_at((double)(g.upper[i] - g.q[iq]), b, dt), speed);
    }
    if (!g.accelerations && !(most > 0)) return;
    *low = fmin(*low, v + b * dt);
    *high = larger(*high, v - b * dt);
    if (!(most > 0)) return;
    *low = larger(*low, v - most * dt);
    *high = fmin(*high, v + most * dt);
}

static void put_limits(hard_rows *h) {
    for (int body = 0, iq = 0, iv = 0; body < g.s.nb; body++) {
        const rbd_body *b = &g.s.bodies[body];
        if (b->mimic) continue;
        for (int k = 0; k < world_nv(b); k++, iv++) {
            const double v = g.accelerations ? (double)g.v[iv] : 0, dt = g.accelerations ? (double)g.p.dt : 1;
            double low, high;
            limits_of(iv, world_nq(b) == 1 ? iq : -1, &low, &high);
            append_row(h, low > -1e29 ? (low - v) / dt : -1e30, high < 1e29 ? (high - v) / dt : 1e30)[iv] = 1;
            if (low > -1e29) h->rounding[h->count - 1] += epsilon * (fabs(low) + fabs(v)) / dt;
            if (high < 1e29) h->rounding[h->count - 1] += epsilon * (fabs(high) + fabs(v)) / dt;
        }
        iq += world_nq(b);
    }
}

/* Jacobian of a contact's point, 3 x nv, and its drift: what the acceleration is without a. */
static void contact_rows(const rbd_task_contact *c, double J[3][DOFS], double drift[3]) {
    const rbd_real zero[WORLD_DOFS] = {0};
    motion s;
    for (int i = 0; i < g.nv; i++) {
        rbd_real unit[WORLD_DOFS] = {0};
        unit[i] = 1;
        move(unit, NULL);
        motion_of(c->body, c->point, &s);
        for (int k = 0; k < 3; k++) J[k][i] = s.velocity[3 + k];
    }
    move(g.v, zero);
    motion_of(c->body, c->point, &s);
    const double gain = c->gain > 0 ? (double)c->gain : 20;
    for (int k = 0; k < 3; k++) drift[k] = s.rate[3 + k] + gain * s.velocity[3 + k];
}

/* Two tangents and the normal of a contact's ground. The tangents' turn about the normal is the library's
   own. */
static void ground_of(const rbd_task_contact *c, double axes[3][3]) {
    const rbdi_mat R = rbdi_tasks_ground(c);
    const rbd_real rows[3][3] = {{R.xx, R.xy, R.xz}, {R.yx, R.yy, R.yz}, {R.zx, R.zy, R.zz}};
    for (int k = 0; k < 9; k++) axes[k / 3][k % 3] = (double)rows[k / 3][k % 3];
}

/* Forces within the pyramid and the limits of the normal force. */
static void put_friction(hard_rows *h, int i) {
    const rbd_task_contact *c = &g.contact[i];
    const int sides = c->sides == 8 ? 8 : 4;
    double axes[3][3];
    ground_of(c, axes);
    const double *t = axes[0], *u = axes[1], *n = axes[2];
    double *force = append_row(h, (double)c->least, c->most > 0 ? (double)c->most : 1e30) + g.nv + 3 * i;
    memcpy(force, n, sizeof axes[2]);
    for (int k = 0; k < sides; k++) {
        double *row = append_row(h, -1e30, 0) + g.nv + 3 * i;
        for (int j = 0; j < 3; j++)
            row[j] = cos(2 * pi * k / sides) * t[j] + sin(2 * pi * k / sides) * u[j] -
                     (double)c->friction * cos(pi / sides) * n[j];
    }
}

/* Torques tau = M a + c - J'f within limits, 0 of passive dofs. J: of the contacts. */
static void put_torques(hard_rows *h, double J[CONTACTS][3][DOFS]) {
    rbd_real bias[WORLD_DOFS], plain[WORLD_DOFS], at[WORLD_DOFS];
    const rbd_real zero[WORLD_DOFS] = {0};
    double *row[DOFS];
    rbd_rnea(g.m, g.w, g.q, g.v, zero, g.p.f_ext, bias);
    rbd_rnea(g.m, g.w, g.q, zero, zero, NULL, plain);
    for (int i = 0; i < g.nv; i++) {
        const int limited = g.p.torque && g.torque[i] > 0 && !(g.p.without & RBD_WITHOUT_TORQUE);
        const double most = is_passive(i) ? 0 : limited ? (double)g.torque[i] : 1e30, c = (double)bias[i];
        row[i] = append_row(h, most < 1e29 ? -most - c : -1e30, most < 1e29 ? most - c : 1e30);
    }
    for (int k = 0; k < g.nv; k++) {
        rbd_real unit[WORLD_DOFS] = {0};
        unit[k] = 1;
        rbd_rnea(g.m, g.w, g.q, zero, unit, NULL, at);
        for (int i = 0; i < g.nv; i++) row[i][k] = (double)at[i] - (double)plain[i];
    }
    for (int i = 0; i < g.nv; i++)
        for (int k = 0; k < 3 * g.p.contacts; k++)
            if (!g.contact[k / 3].open) row[i][g.nv + k] = -J[k / 3][k % 3][i];
}

/* The rows by which a contact is held, along the axes of its ground. */
static void put_held(hard_rows *h, const rbd_task_contact *c, double J[3][DOFS], const double drift[3]) {
    double axes[3][3];
    ground_of(c, axes);
    for (int k = 0; k < 3; k++) {
        const double y = g.accelerations ? -dot(axes[k], drift, 3) : 0;
        double *row = append_row(h, y, y);
        for (int i = 0; i < g.nv; i++)
            row[i] = axes[k][0] * J[0][i] + axes[k][1] * J[1][i] + axes[k][2] * J[2][i];
        h->of_place[h->count - 1] = 1;
    }
}

static void put_hard_rows(hard_rows *h) {
    static double J[CONTACTS][3][DOFS];
    h->count = 0;
    put_limits(h);
    for (int i = 0; i < g.p.contacts; i++) {
        double drift[3];
        if (g.contact[i].open) {
            for (int k = 0; k < 3 && g.accelerations; k++) append_row(h, 0, 0)[g.nv + 3 * i + k] = 1;
            continue;
        }
        contact_rows(&g.contact[i], J[i], drift);
        put_held(h, &g.contact[i], J[i], drift);
        if (g.accelerations) put_friction(h, i);
    }
    if (g.accelerations) put_torques(h, J);
}

/* The size of what is added up in a row, and its bounds: errors are measured against it. A component of x
   counts as one unit at least; that of a force gives the robot 1 m/s^2. */
static double size_of_row(const hard_rows *h, int k, const double *x) {
    const double mass = (double)rbd_mass(g.m);
    double size = 0;
    for (int i = 0; i < g.n; i++) size += fabs(h->c[k][i]) * (fabs(x[i]) + (i < g.nv ? 1 : mass));
    if (h->lower[k] > -1e29) size += fabs(h->lower[k]);
    if (h->upper[k] < 1e29) size += fabs(h->upper[k]);
    return size;
}

static double missed(const hard_rows *h, int k, const double *x) {
    const double value = dot(h->c[k], x, g.n);
    return larger(0, larger(h->lower[k] - value, value - h->upper[k]));
}

/* ---- judgement ---- */

static void all_of(const answer *a, double *x) {
    for (int i = 0; i < g.nv; i++) x[i] = (double)a->x[i];
    for (int i = g.nv; i < g.n; i++) x[i] = (double)a->forces[i - g.nv];
}

/* Terms of forces are less than twice as large along the axes of the ground, where the library counts
   them. */
static void judge_rows(const hard_rows *h, const double *x) {
    for (int k = 0; k < h->count; k++) {
        const double by = missed(h, k, x), size = size_of_row(h, k, x);
        double rounding = h->rounding[k];
        for (int i = 0; i < g.nv && h->of_place[k]; i++) rounding += epsilon * fabs(x[i]);
        const double most = 2 * RBDI_TASKS_ACCURACY * size + 10 * rounding;
        if (!(by <= most)) fail("a hard row is missed", by / size);
    }
}

/* tau is that of inverse dynamics with the forces as wrenches; of passive dofs the rows above say so. */
static void judge_dynamics(const answer *a) {
    rbd_real f_ext[6 * WORLD_BODIES] = {0}, tau[WORLD_DOFS], wrench[6], size = 1;
    if (g.p.f_ext) memcpy(f_ext, g.f_ext, sizeof g.f_ext);
    move(g.v, a->x);
    for (int i = 0; i < g.p.contacts; i++) {
        const rbd_real *f = &a->forces[3 * i], at_point[6] = {0, 0, 0, f[0], f[1], f[2]};
        rbd_point_wrench(g.m, g.w, g.contact[i].body, g.contact[i].point, RBD_WORLD_AXES, at_point, wrench);
        for (int k = 0; k < 6; k++) f_ext[6 * g.contact[i].body + k] += wrench[k];
    }
    rbd_rnea(g.m, g.w, g.q, g.v, a->x, f_ext, tau);
    for (int i = 0; i < 3 * g.p.contacts; i++)
        size = (rbd_real)larger((double)size, fabs((double)a->forces[i]));
    for (int i = 0; i < g.nv; i++)
        size = (rbd_real)larger((double)size, fabs((double)a->x[i]) + fabs((double)tau[i]));
    for (int i = 0; i < g.nv; i++) {
        const double by = fabs((double)(a->tau[i] - tau[i])) / (double)size;
        if (!is_passive(i) && !(by < (in_float ? 1e-3 : 1e-9)))
            fail("tau is not that of inverse dynamics", by);
        if (is_passive(i) && !(a->tau[i] <= 0 && a->tau[i] >= 0))
            fail("a passive dof has a torque", (double)a->tau[i]);
    }
}

/* Removes from d what lies in the rows of a basis. */
static void remove_rows(double basis[ROWS][N], int count, double *d) {
    for (int twice = 0; twice < 2; twice++)
        for (int k = 0; k < count; k++) {
            const double along = dot(basis[k], d, g.n);
            for (int i = 0; i < g.n; i++) d[i] -= along * basis[k][i];
        }
}

static int add_to_basis(double basis[ROWS][N], int count, const double *row) {
    double *to = basis[count];
    const double before = length_of(row, g.n);
    memcpy(to, row, (size_t)g.n * sizeof *to);
    remove_rows(basis, count, to);
    const double after = length_of(to, g.n);
    if (count >= g.n || !(after > (in_float ? 1e-5 : 1e-13) * before)) return count;
    for (int i = 0; i < g.n; i++) to[i] /= after;
    return count + 1;
}

typedef struct level_state {
    const hard_rows *h;
    const squares *o;
    double x[N], cost[N], gradient[N], size; /* of the objective's terms */
} level_state;

/* The objective falls by so much, at best, along d. */
static double fall_along(const level_state *s, const double *d) {
    const double slope = dot(s->gradient, d, g.n);
    double bend = 0, t;
    if (!(slope < 0)) return 0;
    for (int i = 0; i < g.n; i++) bend += s->cost[i] * d[i] * d[i];
    for (int k = 0; k < s->o->count; k++) bend += s->o->weight[k] * pow(dot(s->o->c[k], d, g.n), 2);
    t = -slope / bend;
    for (int k = 0; k < s->h->count; k++) {
        const double way = dot(s->h->c[k], d, g.n), value = dot(s->h->c[k], s->x, g.n);
        if (s->h->lower[k] >= s->h->upper[k]) continue;
        if (way > 0) t = fmin(t, fmax(0, s->h->upper[k] - value) / way);
        if (way < 0) t = fmin(t, fmax(0, value - s->h->lower[k]) / -way);
    }
    return -(t * slope + t * t * bend / 2);
}

/* In float weights and costs of motion are six decades apart, and a flat way is found to some share only:
   that of one answer in 500 is above 1 %. */
static int loose;
static long loose_ones;

static void judge_move(const level_state *s, const double *d) {
    const double by = fall_along(s, d) / s->size;
    if (!(by < (in_float ? 0.5 : 1e-5))) fail("a feasible move is better", by);
    if (!(by < 0.01)) loose = 1;
}

/* d without what leaves the rows: those of equalities, of levels before, and limits that hold, but one. A d
   of which rounding alone is left becomes 0. */
static void project(const level_state *s, const squares *before, const int *holds, int but, double *d) {
    static double basis[ROWS][N];
    const double whole = length_of(d, g.n);
    int count = 0;
    for (int k = 0; k < s->h->count; k++)
        if (s->h->lower[k] >= s->h->upper[k]) count = add_to_basis(basis, count, s->h->c[k]);
    for (int k = 0; k < before->count; k++) count = add_to_basis(basis, count, before->c[k]);
    for (int k = 0; k < s->h->count; k++)
        if (holds[k] && k != but) count = add_to_basis(basis, count, s->h->c[k]);
    remove_rows(basis, count, d);
    if (!(length_of(d, g.n) > (in_float ? 1e-3 : 1e-7) * whole)) memset(d, 0, N * sizeof *d);
}

/* The costs of all components, and gradient and size of the objective. */
static void prepare(level_state *s) {
    const double share = in_float ? 1e-4 : 1e-6, mass = (double)rbd_mass(g.m);
    const double motion = g.p.motion_cost > 0 ? (double)g.p.motion_cost : share;
    s->size = in_float ? 1 : 1e-3;
    for (int i = 0; i < g.n; i++) {
        const double own = i < g.nv ? 0 : (double)g.contact[(i - g.nv) / 3].cost;
        s->cost[i] = i < g.nv ? motion : own > 0 ? own : motion / (mass * mass);
        s->gradient[i] = s->cost[i] * s->x[i];
        s->size += s->cost[i] * s->x[i] * s->x[i];
    }
    for (int k = 0; k < s->o->count; k++) {
        const double along = dot(s->o->c[k], s->x, g.n), w = s->o->weight[k];
        s->size += w * (along * along + s->o->r[k] * s->o->r[k]);
        for (int i = 0; i < g.n; i++) s->gradient[i] += w * s->o->r[k] * s->o->c[k][i];
    }
}

static void judge_optimum(const hard_rows *h, const squares *o, const squares *before, const answer *a) {
    static level_state s;
    int holds[ROWS];
    uint64_t seed = number;
    double d[N];
    s.h = h;
    s.o = o;
    all_of(a, s.x);
    prepare(&s);
    for (int k = 0; k < h->count; k++) {
        const double value = dot(h->c[k], s.x, g.n),
                     near = (in_float ? 1e-3 : 1e-7) * (1 + size_of_row(h, k, s.x));
        holds[k] = h->lower[k] < h->upper[k] && (value > h->upper[k] - near || value < h->lower[k] + near);
    }
    for (int k = -1; k < h->count; k++) {
        if (k >= 0 && !holds[k]) continue;
        for (int i = 0; i < g.n; i++) d[i] = -s.gradient[i];
        project(&s, before, holds, k, d);
        judge_move(&s, d);
    }
    for (int k = 0; k < 5; k++) {
        for (int i = 0; i < g.n; i++) d[i] = uniform(&seed, -1, 1);
        project(&s, before, holds, -1, d);
        judge_move(&s, d);
        for (int i = 0; i < g.n; i++) d[i] = -d[i];
        judge_move(&s, d);
    }
}

/* Projections onto the rows in turn approach an answer, if there is one. */
static void judge_infeasible(const hard_rows *h) {
    double x[N] = {0}, worst = 1;
    for (int sweep = 0; sweep < 3000 && worst > 1e-11; sweep++) {
        worst = 0;
        for (int k = 0; k < h->count; k++) {
            const double square = dot(h->c[k], h->c[k], g.n), value = dot(h->c[k], x, g.n);
            const double by = value > h->upper[k]   ? h->upper[k] - value
                              : value < h->lower[k] ? h->lower[k] - value
                                                    : 0;
            if (!(square > 1e-20)) {
                worst = larger(worst, fabs(by));
                continue;
            }
            worst = larger(worst, fabs(by) / (sqrt(square) * (1 + length_of(x, g.n))));
            for (int i = 0; i < g.n; i++) x[i] += by / square * h->c[k][i];
        }
    }
    if (worst <= 1e-11) fail("an infeasible problem has an answer", worst);
}

/* Level 0 alone, and all levels. */
static void judge(const answer *a, int tasks, int level) {
    static hard_rows h;
    static squares o, before, one;
    double x[N];
    half_turn = 0;
    put_hard_rows(&h);
    all_of(a, x);
    for (int i = 0; i < g.n; i++)
        if (!(fabs(x[i]) < 1e12)) fail("an answer is not finite", x[i]);
    judge_rows(&h, x);
    if (g.accelerations) judge_dynamics(a);

    before.count = 0;
    for (int l = 0; l < level; l++) {
        put_level(l, tasks, a->x, &one);
        for (int k = 0; k < one.count; k++)
            memcpy(append_square(&before, one.weight[k], one.r[k]), one.c[k], sizeof one.c[k]);
    }
    put_level(level, tasks, a->x, &o);
    if (half_turn || a->result.qp != RBD_QP_OK) return;
    loose = 0;
    judge_optimum(&h, &o, &before, a);
    loose_ones += loose;
}

/* The residuals of level 0 are the same with the levels after as without. */
static void judge_levels(int first_tasks, const answer *first, const answer *all) {
    static squares a, b;
    put_level(0, first_tasks, first->x, &a);
    put_level(0, first_tasks, all->x, &b);
    for (int k = 0; k < a.count; k++) {
        double size = 1;
        for (int i = 0; i < g.nv; i++)
            size += fabs(a.c[k][i]) * (fabs((double)first->x[i]) + fabs((double)all->x[i]));
        const double by = fabs(a.r[k] - b.r[k]) / size;
        if (!(by < (in_float ? 1e-3 : 1e-6))) fail("a level worsens the one before", by);
    }
}

/* ---- zeros of a level's QP ---- */

/* What H has beside its diagonal in the rows of forces, which nobody may read who is told. */
static void put_beside_diagonal(rbdi_tasks *k, double value) {
    for (int i = k->nv; i < k->n; i++)
        for (int j = 0; j < k->n; j++)
            if (j != i) k->H[i * k->n + j] = (rbd_real)value;
}

/* The QP of a level, as rbdi_tasks_solve_level left it, without being told where it is 0. */
static void judge_untold(rbdi_tasks *k, int rows, rbd_real *x, signed char *side) {
    static unsigned char qp_memory[sizeof memory];
    static rbd_real lambda[ROWS];
    const rbd_qp_problem qp = {.n = k->n,
                               .bounds = k->n,
                               .rows = rows,
                               .H = k->H,
                               .f = k->f,
                               .C = k->C,
                               .lower = k->lower,
                               .upper = k->upper,
                               .soft = k->given->limit_weight > 0 || k->given->torque_weight > 0 ? k->soft
                                                                                                 : NULL};
    const rbd_qp_options options = {.warm = k->given->warm, .steps = k->given->steps};
    rbd_qp_result result;
    put_beside_diagonal(k, 0);
    rbd_qp_solve(&qp, &options, qp_memory, sizeof qp_memory, x, lambda, side, &result);

    for (int i = 0; i < k->n; i++)
        if (!(x[i] == k->x[i])) fail("x differs by what is told of zeros", (double)(x[i] - k->x[i]));
    for (int row = 0; row < k->n + rows; row++) {
        if (!(lambda[row] == k->lambda[row]))
            fail("lambda differs by what is told of zeros", (double)(lambda[row] - k->lambda[row]));
        if (side[row] != k->side[row]) fail("a side differs by what is told of zeros", row);
    }
}

/* Level by level as rbdi_tasks_descend does, with any guess. */
static void judge_zeros(void) {
    uint64_t seed = number;
    rbd_tasks p = g.p;
    rbd_tasks_result result;
    p.warm = below(&seed, 2);
    if (below(&seed, 2)) p.limit_weight = (rbd_real)uniform(&seed, 1, 1000);
    if (below(&seed, 2)) p.torque_weight = (rbd_real)uniform(&seed, 1, 1000);
    rbdi_tasks *k = rbdi_tasks_begin(g.m, g.w, &p, g.q, g.v, g.accelerations, memory, &result);
    const int limits = RBD_TASK_LEVELS * (2 * k->nv + RBDI_TASKS_CONTACT * p.contacts);
    for (int i = 0; i < limits; i++) k->kept[i] = (signed char)(below(&seed, 3) - 1);

    for (int level = 0; level < RBD_TASK_LEVELS; level++) {
        static rbd_real x[N];
        static signed char side[ROWS];
        const int rows = k->rows;
        if (!rbdi_tasks_put_level(k, level) && level > 0) continue;
        memset(k->x, 0, (size_t)k->n * sizeof *x);
        memset(x, 0, sizeof x);
        rbdi_tasks_keep(k, level, rows, 0);
        memcpy(side, k->side, (size_t)(k->n + rows));

        put_beside_diagonal(k, NAN);
        const rbd_qp_status status = rbdi_tasks_solve_level(k, level, rows);
        judge_untold(k, rows, x, side);
        if (status != RBD_QP_OK) return;
        rbdi_tasks_freeze(k, rows);
    }
}

/* ---- bad input ---- */

enum { NOT_A_NUMBER = 1, HUGE_ONE = 2, NEGATIVE = 4 };

/* The problem with one number changed is refused by that name, and leaves the outputs alone. */
static void refuse(rbd_real *x, const char *field, int kinds) {
    const rbd_real bad[3] = {(rbd_real)NAN, (rbd_real)1e30, -1}, kept = *x;
    for (int k = 0; k < 3; k++) {
        answer a, as_before;
        if (!(kinds & 1 << k)) continue;
        memset(&a, 0, sizeof a);
        for (int i = 0; i < g.nv; i++) a.x[i] = a.tau[i] = (rbd_real)7;
        memcpy(&as_before, &a, sizeof a);
        *x = bad[k];
        a.status = g.accelerations
                       ? rbd_tasks_acceleration(g.m, g.w, &g.p, g.q, g.v, memory, sizeof memory, a.x,
                                                a.forces, a.tau, &a.result)
                       : rbd_tasks_velocity(g.m, g.w, &g.p, g.q, memory, sizeof memory, a.x, &a.result);
        *x = kept;
        if (a.status != RBD_TASKS_ERROR || !a.result.field || strcmp(a.result.field, field) != 0) {
            printf("field %s, %g: status %d, field %s\n", field, (double)bad[k], (int)a.status,
                   a.result.field ? a.result.field : "none");
            fail("a bad field is not refused by name", (double)bad[k]);
        }
        if (memcmp(a.x, as_before.x, sizeof a.x) || memcmp(a.tau, as_before.tau, sizeof a.tau) ||
            memcmp(a.forces, as_before.forces, sizeof a.forces))
            fail("a refusal changed an output", 0);
    }
}

static void refuse_task(rbd_task *t) {
    const int all = NOT_A_NUMBER + HUGE_ONE + NEGATIVE, any_sign = NOT_A_NUMBER + HUGE_ONE;
    const rbd_task_kind k = t->kind;
    const int place = k == RBD_TASK_POINT || k == RBD_TASK_POSE || k == RBD_TASK_RELATIVE;
    refuse(&t->weight, "weight", all);
    refuse(&t->gain, "gain", all);
    refuse(&t->damping, "damping", all);
    refuse(&t->velocity[number % 6], "velocity", any_sign);
    refuse(&t->acceleration[number % 6], "acceleration", any_sign);
    if (place) refuse(&t->point[number % 3], "point", any_sign);
    if (place || k == RBD_TASK_COM) refuse(&t->position[number % 3], "position", any_sign);
    if (k == RBD_TASK_POSE || k == RBD_TASK_ROTATION || k == RBD_TASK_RELATIVE)
        refuse(&t->rotation[number % 9], "rotation", any_sign);
    if (k == RBD_TASK_AXIS) refuse(&t->axis[number % 3], "axis", any_sign);
    if (k == RBD_TASK_AXIS) refuse(&t->direction[number % 3], "direction", any_sign);
    if (k == RBD_TASK_POSTURE) refuse(&g.there[0], "q", any_sign);
    if (k == RBD_TASK_ROWS) refuse(&g.jacobian[number % (uint64_t)g.nv], "jacobian", any_sign);
    if (k == RBD_TASK_ROWS) refuse(&g.y[number % OWN_ROWS], "y", any_sign);
}

static void judge_refusals(void) {
    const int all = NOT_A_NUMBER + HUGE_ONE + NEGATIVE, any_sign = NOT_A_NUMBER + HUGE_ONE;
    const uint64_t dof = number % (uint64_t)g.nv;
    if (g.p.tasks > 0) refuse_task(&g.task[number % (uint64_t)g.p.tasks]);
    if (g.p.contacts > 0) {
        rbd_task_contact *c = &g.contact[number % (uint64_t)g.p.contacts];
        refuse(&c->point[number % 3], "point", any_sign);
        refuse(&c->normal[number % 3], "normal", any_sign);
        refuse(&c->friction, "friction", all);
        refuse(&c->least, "least", all);
        refuse(&c->most, "most", all);
        refuse(&c->cost, "cost", all);
        refuse(&c->gain, "gain", all);
    }
    if (g.p.lower) refuse(&g.lower[dof], "lower", any_sign);
    if (g.p.upper) refuse(&g.upper[dof], "upper", NOT_A_NUMBER);
    if (g.p.speed) refuse(&g.speed[dof], "speed", NOT_A_NUMBER + NEGATIVE);
    if (g.p.torque) refuse(&g.torque[dof], "torque", NOT_A_NUMBER + NEGATIVE);
    if (g.p.acceleration) refuse(&g.acceleration[dof], "acceleration", NOT_A_NUMBER + NEGATIVE);
    refuse(&g.p.dt, "dt", all);
    refuse(&g.p.braking, "braking", all);
    refuse(&g.p.limit_weight, "limit_weight", all);
    refuse(&g.p.torque_weight, "torque_weight", all);
    refuse(&g.p.motion_cost, "motion_cost", all);
    refuse(&g.p.force_cost, "force_cost", all);
    refuse(&g.q[0], "q", any_sign);
    if (g.accelerations) refuse(&g.v[dof], "v", any_sign);
    if (g.p.f_ext) refuse(&g.f_ext[number % 6], "f_ext", any_sign);
}

/* ---- run ---- */

typedef struct tally {
    long problems, exact, inexact, infeasible;
} tally;

static void count_answer(const answer *a, tally *t) {
    char text[200];
    t->problems++;
    t->exact += a->status == RBD_TASKS_OK;
    t->inexact += a->status == RBD_TASKS_INEXACT;
    t->infeasible += a->status == RBD_TASKS_INFEASIBLE;
    if (a->status != RBD_TASKS_ERROR) return;
    fail(rbd_tasks_text(a->status, &a->result, text, sizeof text), a->result.error);
}

static void try_problem(uint64_t start, tally tallies[2]) {
    static hard_rows h;
    answer first, all;
    int first_tasks = 0, last = 0;
    number = start;
    draw_problem(start);
    for (int i = 0; i < g.p.tasks; i++) first_tasks += g.task[i].level == 0;
    if (g.p.tasks > 0) last = g.task[g.p.tasks - 1].level;

    solve(first_tasks, &first);
    count_answer(&first, &tallies[g.accelerations]);
    if (first.status == RBD_TASKS_OK) judge(&first, first_tasks, 0);
    if (first.status == RBD_TASKS_INFEASIBLE) {
        put_hard_rows(&h);
        judge_infeasible(&h);
    }
    if (last > 0 && first.status == RBD_TASKS_OK) {
        solve(g.p.tasks, &all);
        count_answer(&all, &tallies[g.accelerations]);
        if (all.status == RBD_TASKS_INFEASIBLE) fail("a level made the problem infeasible", 0);
        if (all.status >= 0) judge_levels(first_tasks, &first, &all);
        if (all.status == RBD_TASKS_OK) judge(&all, g.p.tasks, last);
    }
    judge_zeros();
    if (start % 4 == 0) judge_refusals();
}

int main(int count, char **arguments) {
    static const char *const names[2] = {"velocities", "accelerations"};
    static tally tallies[2];
    long problems = 2000, seconds = 0, inexact = 0, answers = 0;
    const time_t begin = time(NULL);
    uint64_t start = 1;

    for (int i = 1; i + 1 < count; i += 2) {
        if (!strcmp(arguments[i], "--problems")) problems = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seconds")) seconds = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seed")) start = strtoull(arguments[i + 1], NULL, 10);
    }
    for (long k = 0; seconds ? time(NULL) - begin < seconds : k < problems; k++)
        try_problem(start + (uint64_t)k, tallies);

    printf("%-14s %9s %9s %9s %11s\n", "", "solved", "exact", "inexact", "infeasible");
    for (int k = 0; k < 2; k++) {
        const tally *t = &tallies[k];
        printf("%-14s %9ld %9ld %9ld %11ld\n", names[k], t->problems, t->exact, t->inexact, t->infeasible);
        inexact += t->inexact;
        answers += t->exact + t->inexact;
    }
    printf("wrong: %ld; a move gains more than 1 %%: %ld\n", wrong, loose_ones);
    return wrong > 0 || answers == 0 || inexact * 100 > answers * (in_float ? 3 : 1) ||
           loose_ones * 200 > answers;
}
