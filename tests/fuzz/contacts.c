/* contacts.c - the fuzzer of rbd_contact.h. It prints how many problems of each kind there were, the worst of
   each quantity, and how many stayed above the tolerance; docs/accuracy_tables.md says what is measured.
       contacts [--problems N]   N single contacts, N/10 problems on random trees, N steps of robots and N/10
                                 broken descriptions; 100000
                [--seconds S]    as many of these as there is time for, ten thousand by ten thousand
                [--kind NAME]    of this kind only: single, a class of trees, runs or broken
                [--from N]       begins with problem N of each kind
                [--long N]       two runs of N steps instead, HyQ in space and Atlas that falls: their energy
                [--publish FOLDER]   writes contact_accuracy.csv and contact_runs.csv there, of float
                                     contact_accuracy_float.csv and so on: tables of docs/accuracy_tables.md
       contacts --one CLASS N    shows one problem of a class of trees
   In float (RBD_REAL): single contacts, runs and broken descriptions only. */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"

#include "../larger.h"
#include "dense.h"
#include "robots.h"

#include "models/atlas.h"
#include "models/hyq.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if RBDI_KIND(RBD_REAL) == 2
enum { IN_FLOAT = 1 };
#else
enum { IN_FLOAT = 0 };
#endif
static const double unit_of_real = IN_FLOAT ? (double)FLT_EPSILON : DBL_EPSILON;
static const double relative_tolerance = IN_FLOAT ? 1e-4 : 1e-9; /* of trees, of the largest speed */

/* ---- what is measured ---- */

enum {
    SINGLE,
    WORLD,
    BODIES,
    FRICTIONLESS,
    LIMITS,
    HELD,
    REDUNDANT,
    ANY,
    TREES_END,
    RUNS = TREES_END,
    BROKEN,
    KINDS
};
static const char *const kinds[KINDS] = {"single", "world",     "bodies", "frictionless", "limits",
                                         "held",   "redundant", "any",    "runs",         "broken"};

/* Errors above the bound are failures; of problems that are not solved nothing but `cone` is held. */
enum {
    DELTA,
    FREE,
    GAP,
    EQUATION,
    CONE,
    SIGNORINI,
    DISSIPATION,
    ENERGY,
    METHODS,
    MOVES,
    DEPTH,
    BALANCE,
    FREE_STEP,
    QUANTITIES
};
static const struct quantity {
    const char *name;
    double bound, in_float;
} quantities[QUANTITIES] = {{"Delta", 1e-10, 1e-2},
                            {"free velocity", 1e-10, 1e-2},
                            {"gap", 1e-13, 1e-4},
                            {"equation of motion", 1e-9, 1e-2},
                            {"cone", 1e-14, 1e-5},
                            {"Signorini", 1e-7, 1e-2},
                            {"dissipation", 1e-7, 1e-2},
                            {"energy made", 1e-7, 1e-2},
                            {"two methods", 1e-5, 1e9},
                            {"q_next, v_next", 1e-12, 1e-4},
                            {"depth at the end", 1e-7, 1e-2},
                            {"energy of a step", 4, 4},
                            {"free step", 1e-10, 1e-2}};

/* Failures that are no matter of size. */
enum { NOT_BUILT, NOT_FINITE, STATUS, NOT_A_ROW, NOT_REPEATED, WRONG_ANSWER, FAILURES };
static const char *const failure_names[FAILURES] = {"not built",          "not finite",   "status",
                                                    "no row though near", "not repeated", "wrong answer"};

enum {
    PROBLEMS,
    ROWS,
    UNSOLVED,
    OTHER_SOLVES,
    SINGULAR,
    COMPARED,
    SEVERAL,
    NOT_COMPARED,
    WILD,
    ITERATIONS,
    COUNTS
};
static const char *const count_names[COUNTS] = {"problems",
                                                "rows",
                                                "above the tolerance",
                                                "the other method is not",
                                                "M singular",
                                                "by two methods",
                                                "several solutions",
                                                "other method failed",
                                                "more than 1 rad a step",
                                                "iterations"};

typedef struct worst {
    double error;
    int number;
} worst;
static worst worst_of[KINDS][QUANTITIES];
static double worst_unsolved[KINDS]; /* residual */
static long counts[KINDS][COUNTS], compared[QUANTITIES], failures;
static int kind_now, number_now, shown = 5, show;

static void fail(const char *what, double value) {
    failures++;
    if (shown-- > 0) printf("FAIL %s (%.2g): --one %s %d\n", what, value, kinds[kind_now], number_now);
}

static void record(int quantity, double value) {
    const double error = value >= 0 ? value : value < 0 ? 0 : HUGE_VAL; /* not a number */
    worst *w = &worst_of[kind_now][quantity];
    const double bound = IN_FLOAT ? quantities[quantity].in_float : quantities[quantity].bound;
    compared[quantity]++;
    if (show) printf("%-20s %.2e\n", quantities[quantity].name, error);
    if (error > w->error) *w = (worst){error, number_now};
    if (!(error <= bound)) fail(quantities[quantity].name, error);
}

static double largest_of(const quad *x, int n) {
    double most = 0;
    for (int k = 0; k < n; k++) most = larger(most, fabs((double)x[k]));
    return most;
}

static double magnitude_of(const quad *x, int n) {
    quad sum = 0;
    for (int i = 0; i < n; i++) sum += x[i] * x[i];
    return (double)world_sqrt(sum);
}

static int below(uint64_t *seed, int n) { return (int)uniform(seed, 0, n); }
static double power(uint64_t *seed, double low, double high) { return pow(10, uniform(seed, low, high)); }
static int one_in(uint64_t *seed, int n) { return below(seed, n) == 0; }

/* Exactly as much memory as the library asks for, filled with what is not a number. */
static void *memory_of(size_t size) { return memset(malloc(size ? size : 1), 0xff, size); }

static int finite(const rbd_real *x, int n) {
    for (int i = 0; i < n; i++)
        if (!isfinite((double)x[i])) return 0;
    return 1;
}

/* ---- laws, from outside ---- */

enum {
    MOST_CONTACTS = 16,
    MOST_ROWS = 192
}; /* contacts, held rows, limits, friction of each dof, bounded rows */

/* A problem by its definition: u = Delta p + b, contacts first, then bounded rows. */
typedef struct laws {
    int contacts, rows;
    quad delta[MOST_ROWS][MOST_ROWS], b[MOST_ROWS], p[MOST_ROWS], u[MOST_ROWS];
    double mu[MOST_CONTACTS], lower[MOST_ROWS], upper[MOST_ROWS]; /* by row */
    double spring[MOST_CONTACTS]; /* what a spring adds to Delta's normal: it is no mass */
    double speed;   /* what velocities are measured by: the largest b, or p moved by its own row */
    double unmoved; /* a row's own 1/mass below is rounding */
} laws;

/* speed: at least. */
static void find_velocities(laws *x, double speed) {
    x->speed = speed, x->unmoved = 0;
    for (int r = 0; r < x->rows; r++) {
        x->u[r] = x->b[r];
        x->unmoved = larger(x->unmoved, 1e-24 * (double)x->delta[r][r]);
        for (int k = 0; k < x->rows; k++) x->u[r] += x->delta[r][k] * x->p[k];
        x->speed = larger(x->speed, fabs((double)x->b[r]));
        x->speed = larger(x->speed, fabs((double)(x->delta[r][r] * x->p[r])));
    }
}

/* The residuals of Le Lidec and others (2023): impulses times the row's own 1/mass are velocities, all in
   shares of the problem's. A contact that nothing moves has none. */
static void judge_contact(const laws *x, int i, double *cone, double *signorini, double *dissipation) {
    const quad *p = &x->p[3 * i], *u = &x->u[3 * i];
    const double pt = magnitude_of(p, 2), ut = magnitude_of(u, 2), pn = (double)p[2], un = (double)u[2],
                 d = (double)x->delta[3 * i + 2][3 * i + 2], rigid = d - x->spring[i], s = x->speed,
                 along = (double)(p[0] * u[0] + p[1] * u[1]);
    double trace = d;
    for (int j = 0; j < 2; j++) trace += (double)x->delta[3 * i + j][3 * i + j];
    if (pn > 0 || pt > 0) *cone = larger(*cone, larger(pt / pn - x->mu[i], -pn) / (1 + x->mu[i]));
    if (!(d > 64 * unit_of_real * trace)) return;

    /* the errors of p_n and p_t, by the velocities that they move: a spring is no mass */
    const double error = un * rigid / d;
    *signorini = larger(*signorini, larger(-error, d * pn * error / (s + d * pn)) / s);
    const double kept = fabs(along + x->mu[i] * pn * ut);
    *dissipation = larger(*dissipation, rigid * kept / (s * (s + rigid * (pt + pn))));
}

static void judge_bounded(const laws *x, int r, double *cone, double *signorini) {
    const double p = (double)x->p[r], u = (double)x->u[r], d = (double)x->delta[r][r], s = x->speed,
                 above = p - x->lower[r], under = x->upper[r] - p, room = u > 0 ? above : under;
    *cone = larger(*cone, larger(-above, -under));
    if (d > x->unmoved) *signorini = larger(*signorini, fabs(u) * d * room / (s * (s + d * room)));
}

/* Records the residuals; returns whether the problem counts as solved. residual: what the library says. */
static int judge(const laws *x, double residual, double tolerance) {
    double cone = 0, signorini = 0, dissipation = 0;
    for (int i = 0; i < x->contacts; i++) judge_contact(x, i, &cone, &signorini, &dissipation);
    for (int r = 3 * x->contacts; r < x->rows; r++) judge_bounded(x, r, &cone, &signorini);
    record(CONE, cone);
    if (show) printf("residual %.2e of tolerance %.2e, speed %.2e\n", residual, tolerance, x->speed);
    if (!(residual <= tolerance)) {
        counts[kind_now][UNSOLVED]++;
        worst_unsolved[kind_now] = larger(worst_unsolved[kind_now], residual / x->speed);
        return 0;
    }
    record(SIGNORINI, signorini);
    record(DISSIPATION, dissipation);
    return 1;
}

/* ---- single contacts ---- */

/* A block of Delta of condition up to 1e9, or with a direction that nothing moves; mu 0.01 to 10, or 0. */
static void run_single(int number) {
    uint64_t seed = (uint64_t)number + (UINT64_C(1) << 41);
    static laws x;
    rbd_real delta[9], b[3], mu, p[3] = {0, 0, 0}, none = 0;
    double J[9], scale[3];
    unsigned char memory[2000];
    rbd_contact_state state;
    rbd_contact_solution solution;
    kind_now = SINGLE, number_now = number;
    for (int i = 0; i < 3; i++) uniform(&seed, 0, 1);
    const double spread = IN_FLOAT ? 1 : 2.2, size = power(&seed, -3, 3);
    for (int k = 0; k < 3; k++) scale[k] = one_in(&seed, 50) ? 0 : size * power(&seed, -spread, spread);
    for (int k = 0; k < 9; k++) J[k] = uniform(&seed, -1, 1);
    for (int k = 0; k < 9; k++) {
        double sum = 0;
        for (int i = 0; i < 3; i++) sum += scale[i] * J[i + k / 3 * 3] * J[i + k % 3 * 3];
        delta[k] = (rbd_real)sum;
    }
    for (int r = 0; r < 3; r++) scale[r] = one_in(&seed, 3) ? 0 : uniform(&seed, -1, 1) * scale[r];
    for (int r = 0; r < 3; r++) { /* what some motion has */
        double sum = 0;
        for (int i = 0; i < 3; i++) sum += J[i + 3 * r] * scale[i];
        b[r] = (rbd_real)sum;
    }
    mu = one_in(&seed, 20) ? 0 : (rbd_real)power(&seed, -2, 1);
    const rbd_real tolerance = IN_FLOAT ? (rbd_real)1e-5 : (rbd_real)1e-8;
    const rbd_contact_problem given = {1, 0, delta, b, &mu, &none, &none, tolerance, 0};
    if (rbd_contact_solve(&given, memory, sizeof memory, p, &state, &solution) != RBD_OK)
        fail(failure_names[STATUS], 0);
    if (!finite(p, 3)) fail(failure_names[NOT_FINITE], 0);
    counts[SINGLE][PROBLEMS]++, counts[SINGLE][ROWS] += 3;
    counts[SINGLE][ITERATIONS] += solution.sweeps + solution.newton_steps;
    x.contacts = 1, x.rows = 3, x.mu[0] = (double)mu;
    for (int r = 0; r < 3; r++) {
        x.b[r] = (quad)b[r], x.p[r] = (quad)p[r];
        for (int k = 0; k < 3; k++) x.delta[r][k] = (quad)delta[3 * r + k];
    }
    find_velocities(&x, 0.1);
    judge(&x, (double)solution.residual, (double)tolerance);
    if (show)
        printf("state %d, mu %g, p %g %g %g, u %g %g %g, sweeps %d, Newton steps %d\n", (int)state,
               (double)mu, (double)p[0], (double)p[1], (double)p[2], (double)x.u[0], (double)x.u[1],
               (double)x.u[2], solution.sweeps, solution.newton_steps);
}

/* ---- problems on trees ---- */

/* The tree, its state, and what touches. */
typedef struct scene {
    sample robot;
    sample_state state;
    rbd_contact list[MOST_CONTACTS];
    rbd_constraint held[2];
    int n, n_held;
    double gap[MOST_CONTACTS]; /* that was asked for */
    double damping[WORLD_DOFS];
    rbd_contact_options options;
    rbd_contact_row row[3]; /* bounded: options.rows */
    double dt;
    uint64_t seed;
} scene;

static void vector(uint64_t *seed, double size, double *x, int n) {
    for (int k = 0; k < n; k++) x[k] = uniform(seed, -size, size);
}

/* The body that a body is fixed to, itself where it can move. */
static int carrier(const scene *s, int body) {
    while (body >= 0 && (s->robot.bodies[body].type == RBD_FIXED)) body = s->robot.bodies[body].parent;
    return body;
}

static int any_moving_body(scene *s) {
    for (int tries = 0; tries < 50; tries++) {
        const int body = below(&s->seed, s->robot.nb);
        if (carrier(s, body) >= 0) return body;
    }
    return -1;
}

static rbd_contact *new_contact(scene *s, int body1, int body2) {
    rbd_contact *a = &s->list[s->n];
    if (s->n == MOST_CONTACTS || body1 == body2 || carrier(s, body1) == carrier(s, body2)) return NULL;
    memset(a, 0, sizeof *a);
    a->body1 = body1, a->body2 = body2, a->on_body = body2 >= 0;
    vector(&s->seed, 0.3, a->point, 3);
    vector(&s->seed, 1, a->normal, 3);
    if (one_in(&s->seed, 3)) a->radius = uniform(&s->seed, 0, 0.2);
    if (one_in(&s->seed, 3)) a->normal[0] = a->normal[1] = 0, a->normal[2] = 2;
    a->friction = kind_now == FRICTIONLESS || one_in(&s->seed, 10) ? 0 : uniform(&s->seed, 0, 1.2);
    if (one_in(&s->seed, 8)) a->friction = power(&s->seed, -3, 1);
    if (kind_now == FRICTIONLESS) a->friction = 0;
    if (one_in(&s->seed, 6)) a->stiffness = power(&s->seed, 2, 7), a->damping = power(&s->seed, -1, 3);
    if (kind_now == ANY && one_in(&s->seed, 8)) a->restitution = uniform(&s->seed, 0, 1);
    static const double gaps[8] = {0, 0, 0, 1e-6, -5e-6, 1e-3, 0.1, -2e-3};
    s->gap[s->n++] = gaps[below(&s->seed, kind_now == ANY ? 8 : 7)];
    return a;
}

static void draw_contacts(scene *s, int n, int between) {
    for (; n > 0; n--) {
        const int one = any_moving_body(s), two = between ? below(&s->seed, s->robot.nb + 1) - 1 : -1;
        if (one >= 0 && one_in(&s->seed, 6)) /* the world's point over the body's plane */
            new_contact(s, two, one);
        else if (one >= 0)
            new_contact(s, one, two);
    }
}

/* More points of bodies that touch already; or the same points again. */
static void draw_redundant(scene *s, int n) {
    for (; n > 0 && s->n > 0 && s->n < MOST_CONTACTS; n--) {
        const int like = below(&s->seed, s->n);
        s->list[s->n] = s->list[like];
        s->gap[s->n] = s->gap[like];
        if (!one_in(&s->seed, 3)) vector(&s->seed, 0.3, s->list[s->n].point, 3);
        s->n++;
    }
}

static void draw_held(scene *s) {
    for (int tries = 0; tries < 2; tries++) {
        const int one = any_moving_body(s), two = one_in(&s->seed, 2) ? -1 : below(&s->seed, s->robot.nb);
        double p1[3], p2[3];
        vector(&s->seed, 0.3, p1, 3);
        vector(&s->seed, 0.3, p2, 3);
        if (one < 0 || carrier(s, one) == carrier(s, two)) continue;
        s->held[s->n_held] = rbd_ball_loop(one, p1, two, p2);
        for (int k = 0; k < 6; k++)
            if (one_in(&s->seed, 4)) s->held[s->n_held].axes[k] ^= 1;
        s->held[s->n_held].axes[3] = 1;
        s->n_held++;
    }
}

static int has_limits(const rbd_body *b) {
    return b->type == RBD_REVOLUTE || b->type == RBD_PRISMATIC || b->type == RBD_HELICAL;
}

/* Bounded rows of one to three dofs: friction, drives and bristles. */
static void draw_rows(scene *s) {
    int dofs = 0;
    for (int i = 0; i < s->robot.nb; i++) dofs += world_nv(&s->robot.bodies[i]);
    for (int i = 0; i < 3 && dofs > 0 && one_in(&s->seed, 2); i++) {
        rbd_contact_row *row = &s->row[s->options.rows++];
        const int first = below(&s->seed, dofs), kind = below(&s->seed, 3);
        memset(row, 0, sizeof *row);
        row->dofs = 1 + below(&s->seed, dofs < 3 ? dofs : 3);
        for (int j = 0; j < row->dofs; j++) {
            row->dof[j] = (first + j) % dofs;
            row->jacobian[j] = (rbd_real)uniform(&s->seed, -2, 2);
        }
        row->lower = -(rbd_real)power(&s->seed, -2, 2), row->upper = (rbd_real)power(&s->seed, -2, 2);
        if (kind > 0) row->bias = (rbd_real)uniform(&s->seed, -1, 1);
        if (kind > 1) row->compliance = (rbd_real)power(&s->seed, -3, 1);
    }
}

/* Limits near the state's coordinates, dry friction, and bounded rows. */
static void draw_limits(scene *s) {
    static const double room[6] = {0, 1e-7, 1e-3, 0.01, 0.5, -1e-3}; /* beyond: of any problem only */
    s->options.joint_limits = s->options.joint_friction = 1;
    for (int i = 0, iq = 0; i < s->robot.nb; i++) {
        rbd_body *b = &s->robot.bodies[i];
        const int upper = one_in(&s->seed, 2);
        const double q = s->state.q[iq], near = room[below(&s->seed, kind_now == ANY ? 6 : 5)];
        if (has_limits(b) && !b->mimic && one_in(&s->seed, 2))
            b->lower = upper ? q - 1 : q - near, b->upper = upper ? q + near : q + 1;
        if (!b->mimic && one_in(&s->seed, 3))
            for (int k = 0; k < world_nv(b); k++) b->friction[k] = power(&s->seed, -2, 2);
        iq += world_nq(b);
    }
    draw_rows(s);
}

static void count_dofs(sample *s) {
    s->nq = s->nv = 0;
    for (int i = 0; i < s->nb; i++) s->nq += world_nq(&s->bodies[i]), s->nv += world_nv(&s->bodies[i]);
}

static void draw_scene(scene *s, int kind, int number) {
    static const double dts[5] = {5e-4, 1e-3, 2e-3, 5e-3, 1e-2};
    memset(s, 0, sizeof *s);
    s->seed = (uint64_t)number * KINDS + (uint64_t)kind + (UINT64_C(1) << 42);
    for (int i = 0; i < 4; i++) uniform(&s->seed, 0, 1);
    const int of = one_in(&s->seed, 6) ? FOLLOWERS : one_in(&s->seed, 4) ? AXES : ORDINARY;
    draw_robot(&s->robot, of, number * KINDS + kind);
    if (s->robot.nb > 12) s->robot.nb = 12;
    if (of != FOLLOWERS && one_in(&s->seed, 2)) s->robot.bodies[0].type = RBD_FLOATING;
    for (int i = 1; i < s->robot.nb; i++)
        if (one_in(&s->seed, 10)) s->robot.bodies[i].parent = -1;
    count_dofs(&s->robot);
    draw_state(&s->robot, &s->state);
    s->dt = dts[below(&s->seed, 5)];
    for (int k = 0; k < s->robot.nv; k++) {
        s->state.tau[k] *= 20;
        s->damping[k] = one_in(&s->seed, 4) ? power(&s->seed, -1, 2) : 0;
        if (number % 3 == 0) s->state.v[k] = 0;
    }
    draw_contacts(s, 1 + below(&s->seed, 5), kind == BODIES || kind == ANY);
    if (kind == LIMITS || (kind == ANY && one_in(&s->seed, 2))) draw_limits(s);
    if (kind == HELD || (kind == ANY && one_in(&s->seed, 3))) draw_held(s);
    if (kind == REDUNDANT || (kind == ANY && one_in(&s->seed, 2))) draw_redundant(s, 2 + below(&s->seed, 8));
    s->options.iterations = 200;
}

/* ---- the truth ---- */

static scene now;
static world truth;
static dense exact;
static dense_rows found_rows;
static int nv;
static quad J[MOST_ROWS][WORLD_DOFS], J_size[MOST_ROWS][WORLD_DOFS], lever[MOST_ROWS],
    M[WORLD_DOFS * WORLD_DOFS], M_size[WORLD_DOFS];
/* The scheme of the call: v moves q for a time `half`, to `middle`, where it is `begin`; then the solution
   moves it for the time `way`. rbd_contact_step: dt/2 each; rbd_contact_fd: 0 and dt. */
static quad half, way, middle[WORLD_COORDINATES], begin[WORLD_DOFS];
/* Velocities without impulses: with velocity terms of `begin`, and those of the last solution. The forces of
   the latter times dt, and their sizes. gamma: of all contacts and held rows. */
static quad nu_0[WORLD_DOFS], nu_free[WORLD_DOFS], forces[WORLD_DOFS], forces_size[WORLD_DOFS],
    gamma[3 * MOST_CONTACTS + 12], gamma_of_row[MOST_ROWS];
static laws exact_laws;

static void widen(const double *x, int n, quad *y) {
    for (int i = 0; i < n; i++) y[i] = x[i];
}

/* A body's point in the world, and a direction of a body. */
static void point_in_world(int body, const double *x, quad *out) {
    for (int i = 0; i < 3; i++) {
        out[i] = body < 0 ? x[i] : truth.element[truth.last[body]].p[i];
        for (int j = 0; body >= 0 && j < 3; j++)
            out[i] += truth.element[truth.last[body]].R[3 * i + j] * x[j];
    }
}

static void turn_to_world(int body, const quad *x, quad *out) {
    for (int i = 0; i < 3; i++) {
        out[i] = body < 0 ? x[i] : 0;
        for (int j = 0; body >= 0 && j < 3; j++)
            out[i] += truth.element[truth.last[body]].R[3 * i + j] * x[j];
    }
}

/* World coordinates in the axes of a body. */
static void into_body(int body, const quad *x, double *out) {
    for (int i = 0; i < 3; i++) {
        quad sum = body < 0 ? x[i] : 0;
        for (int j = 0; body >= 0 && j < 3; j++) {
            const world_element *e = &truth.element[truth.last[body]];
            sum += e->R[3 * j + i] * (x[j] - e->p[j]);
        }
        out[i] = (double)sum;
    }
}

/* The contact's gap for height 0, and the constraint whose linear rows are its: it holds the places where the
   two bodies touch, in the axes of the plane. */
static quad contact_constraint(const rbd_contact *a, int on_foot, rbd_constraint *k) {
    quad n[3], n_world[3], p[3], origin[3], gap = 0;
    double up[3] = {0, 0, 1};
    const double zero[3] = {0, 0, 0};
    const int given = a->normal[0] < 0 || a->normal[0] > 0 || a->normal[1] < 0 || a->normal[1] > 0 ||
                      a->normal[2] < 0 || a->normal[2] > 0;
    if (given) memcpy(up, a->normal, sizeof up);
    *k = rbd_ball_loop(a->body1, NULL, a->body2, NULL);
    rbdi_frame_along(up, k->rotation2); /* its tangents are what the rows' order is told by */
    widen(up, 3, n);
    const quad length = world_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++) n[i] /= length;
    turn_to_world(a->body2, n, n_world);
    point_in_world(a->body1, a->point, p);
    point_in_world(a->body2, zero, origin);
    for (int i = 0; i < 3; i++) gap += n_world[i] * (p[i] - origin[i]);
    for (int i = 0; i < 3; i++) p[i] -= (on_foot ? gap - a->height : a->radius) * n_world[i];
    into_body(a->body1, p, k->position1);
    into_body(a->body2, p, k->position2);
    return gap - a->radius;
}

/* Puts the planes where the gaps are as asked, and closes what is held. */
static void place_contacts(void) {
    quad q[WORLD_COORDINATES], v[WORLD_DOFS];
    rbd_constraint k;
    widen(now.state.q, now.robot.nq, q);
    widen(now.state.v, nv, v);
    world_move(&truth, now.robot.bodies, now.robot.nb, q, v, NULL);
    for (int i = 0; i < now.n; i++)
        now.list[i].height = (double)(contact_constraint(&now.list[i], 0, &k))-now.gap[i];
    for (int i = 0; i < now.n_held; i++) dense_close(&truth, &now.held[i]);
}

/* ---- straight motion ---- */

static void cross(const quad *a, const quad *b, quad *out) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Components of a vector that stays, in axes that have turned by w for the time t: x turned by -w t. */
static void turned_back(const quad w[3], quad t, const quad x[3], quad out[3]) {
    const quad size = world_sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const long double angle = (long double)(size * t);
    quad axis[3], once[3], twice[3];
    memcpy(out, x, 3 * sizeof *x);
    if (!(size > 0)) return;

    for (int j = 0; j < 3; j++) axis[j] = w[j] / size;
    cross(axis, x, once);
    cross(axis, once, twice);
    for (int j = 0; j < 3; j++) out[j] += (1 - cosl(angle)) * twice[j] - sinl(angle) * once[j];
}

/* x from the axes that a quaternion turns to. */
static void turned(const quad *quaternion, const quad x[3], quad out[3]) {
    quad u[4], size = 0, once[3], twice[3];
    for (int j = 0; j < 4; j++) size += quaternion[j] * quaternion[j];
    for (int j = 0; j < 4; j++) u[j] = quaternion[j] / world_sqrt(size);
    cross(u, x, once);
    cross(u, once, twice);
    for (int j = 0; j < 3; j++) out[j] = x[j] + 2 * (u[3] * once[j] + twice[j]);
}

/* Mass and first moment of a body and of what its hinges carry, in its axes, as far as no motion of a hinge
   changes them. */
typedef struct carried {
    quad mass, moment[3];
} carried;
static carried carried_by[WORLD_BODIES];

/* Of a moment, the part along an axis. */
static void keep_along(const double *axis, quad *moment) {
    const quad square = (quad)axis[0] * axis[0] + (quad)axis[1] * axis[1] + (quad)axis[2] * axis[2],
               share = (axis[0] * moment[0] + axis[1] * moment[1] + axis[2] * moment[2]) / square;
    for (int j = 0; j < 3; j++) moment[j] = share * axis[j];
}

/* The part that a joint passes on of what its body carries: a turn about an axis through the origin keeps the
   moment along that axis, turns about three axes keep none. A joint that slides passes nothing on. */
static carried passed_on(const rbd_body *b, carried x) {
    static const carried nothing;
    switch (b->type) {
    case RBD_FIXED: break;
    case RBD_REVOLUTE:
    case RBD_CONTINUOUS:
    case RBD_CONTINUOUS_CS: keep_along(b->axis, x.moment); break;
    case RBD_UNIVERSAL:
        keep_along(b->axis2, x.moment);
        keep_along(b->axis, x.moment);
        break;
    case RBD_SPHERICAL:
    case RBD_EULER_ZYX:
    case RBD_EULER_XYZ:
    case RBD_EULER_YXZ:
    case RBD_EULER_ZXY: memset(x.moment, 0, sizeof x.moment); break;
    default: return nothing;
    }
    return x;
}

/* Writes carried_by, from the leaves. */
static void find_carried(void) {
    for (int i = 0; i < now.robot.nb; i++) {
        const rbd_body *b = &now.robot.bodies[i];
        carried_by[i].mass = b->mass;
        for (int j = 0; j < 3; j++) carried_by[i].moment[j] = (quad)b->mass * b->com[j];
    }
    for (int i = now.robot.nb - 1; i >= 0; i--) {
        const rbd_body *b = &now.robot.bodies[i];
        const carried x = passed_on(b, carried_by[i]);
        quad R[9];
        if (b->parent < 0) continue;
        carried *to = &carried_by[b->parent];
        world_rotation(b->rotation, R);
        to->mass += x.mass;
        for (int j = 0; j < 3; j++)
            to->moment[j] += x.mass * b->position[j] + R[3 * j] * x.moment[0] + R[3 * j + 1] * x.moment[1] +
                             R[3 * j + 2] * x.moment[2];
    }
}

/* The point of body i that moves straight, in its axes: its origin in steps of first order. In others any
   point will do: that of a body that floats is the centre of mass of what it carries. */
static void straight_point(int i, quad point[3]) {
    const carried *x = &carried_by[i];
    for (int k = 0; k < 3; k++) point[k] = half == 0 || !(x->mass > 0) ? 0 : x->moment[k] / x->mass;
}

/* Adds `sign` times the velocity of the point c over the origin. */
static void add_velocity_of(int sign, const quad *w, const quad *c, quad *v) {
    quad more[3];
    cross(w, c, more);
    for (int j = 0; j < 3; j++) v[j] += sign * more[j];
}

/* A joint moves by `moved` for the time t, its point c straight and its turn about one axis. v_next: nu in
   the axes of the end. */
static void move_joint(const rbd_body *b, const quad *c, const quad *q, const quad *moved, const quad *nu,
                       quad t, quad *q_next, quad *v_next) {
    const int planar = b->type == RBD_PLANAR;
    quad d[6], size[7];
    for (int k = 0; k < world_nv(b); k++) d[k] = moved[k] * t, v_next[k] = nu[k];
    world_step(b, q, d, q_next, size);
    if (b->type == RBD_SPHERICAL) turned_back(moved, t, nu, v_next);
    if (b->type == RBD_FLOATING || planar) {
        quad w[3] = {0, 0, moved[0]}, nu_w[3] = {0, 0, nu[0]},
             to_world[2][3] = {{0, 0, -q[2]}, {0, 0, -q_next[2]}}, way[3] = {moved[1], moved[2], 0},
             u[3] = {nu[1], nu[2], 0}, before[3], after[3], end_w[3], end_u[3];
        if (!planar) {
            memcpy(w, moved, sizeof w), memcpy(way, moved + 3, sizeof way);
            memcpy(nu_w, nu, sizeof nu_w), memcpy(u, nu + 3, sizeof u);
        }
        add_velocity_of(1, w, c, way);
        for (int j = 0; j < 3; j++) way[j] = c[j] + way[j] * t;
        if (planar)
            turned_back(to_world[0], 1, way, before), turned_back(to_world[1], 1, c, after);
        else
            turned(q + 3, way, before), turned(q_next + 3, c, after);
        for (int j = 0; j < 3 - planar; j++) q_next[j] = q[j] + before[j] - after[j];

        add_velocity_of(1, nu_w, c, u);
        turned_back(w, t, u, end_u);
        turned_back(w, t, nu_w, end_w);
        add_velocity_of(-1, end_w, c, end_u);
        memcpy(v_next, planar ? &end_w[2] : end_w, (planar ? 1 : 3) * sizeof *v_next);
        memcpy(v_next + (planar ? 1 : 3), end_u, (planar ? 2 : 3) * sizeof *v_next);
    }
}

static void move(const quad *q, const quad *moved, const quad *nu, quad t, quad *q_next, quad *v_next) {
    for (int i = 0, iq = 0, iv = 0; i < now.robot.nb; i++) {
        const rbd_body *b = &now.robot.bodies[i];
        quad c[3];
        straight_point(i, c);
        if (!b->mimic) move_joint(b, c, q + iq, moved + iv, nu + iv, t, q_next + iq, v_next + iv);
        iq += world_nq(b), iv += world_nv(b);
    }
}

/* Accelerations at the velocity v by which the points c move straight: -omega x (u + omega x c). */
static void straight(const quad *v, quad *a) {
    memset(a, 0, (size_t)nv * sizeof *a);
    for (int i = 0, iv = 0; i < now.robot.nb; i++) {
        const rbd_body *b = &now.robot.bodies[i];
        const int planar = b->type == RBD_PLANAR;
        if (!b->mimic && (planar || b->type == RBD_FLOATING)) {
            quad c[3], w[3] = {0, 0, v[iv]}, u[3] = {v[iv + 1], v[iv + 2], 0}, bend[3];
            if (!planar) memcpy(w, v + iv, sizeof w), memcpy(u, v + iv + 3, sizeof u);
            straight_point(i, c);
            add_velocity_of(1, w, c, u);
            cross(u, w, bend);
            memcpy(a + iv + (planar ? 1 : 3), bend, (planar ? 2 : 3) * sizeof *a);
        }
        iv += world_nv(b);
    }
}

/* ---- the motion without impulses ---- */

/* forces = dt (tau - c(w) - damping begin), and the velocity begin + K^-1 forces. */
static void move_freely(const quad *w, quad *velocity) {
    quad tau[WORLD_DOFS], wrench[6 * WORLD_BODIES], gravity[3], a[WORLD_DOFS], c[WORLD_DOFS],
        c_size[WORLD_DOFS];
    widen(now.state.tau, nv, tau);
    widen(now.state.f_ext, 6 * now.robot.nb, wrench);
    widen(now.state.gravity, 3, gravity);
    straight(w, a);
    world_move(&truth, now.robot.bodies, now.robot.nb, middle, w, a);
    world_torques(&truth, gravity, a, wrench, c, c_size);
    for (int k = 0; k < nv; k++) {
        const quad d = now.dt * now.damping[k];
        forces[k] = now.dt * (tau[k] - c[k]) - d * begin[k];
        forces_size[k] = now.dt * (c_size[k] + fabsl((long double)tau[k])) + d * fabsl((long double)begin[k]);
    }
    dense_inverse(&exact, forces, velocity);
    for (int k = 0; k < nv; k++) velocity[k] += begin[k];
    world_move(&truth, now.robot.bodies, now.robot.nb, middle, begin, NULL);
}

/* The middle of a step, or the beginning of one of first order: K = M + dt damping, and the velocity without
   impulses. Whether K is regular. */
static int find_motion(int first_order) {
    static dense_rows no_rows;
    quad q[WORLD_COORDINATES], v[WORLD_DOFS];
    half = first_order ? 0 : now.dt / (quad)2, way = now.dt - half;
    find_carried();
    widen(now.state.q, now.robot.nq, q);
    widen(now.state.v, nv, v);
    move(q, v, v, half, middle, begin);
    world_move(&truth, now.robot.bodies, now.robot.nb, middle, begin, NULL);
    world_mass_matrix(&truth, M, M_size);
    for (int k = 0; k < nv; k++) {
        const quad d = now.dt * now.damping[k];
        M[k * (nv + 1)] += d, M_size[k] += d;
    }
    no_rows.rows = 0;
    if (!dense_factor(&exact, &no_rows, M, M_size, nv, 1) || !(exact.distance > (IN_FLOAT ? 1e-4L : 1e-6L)))
        return 0;
    move_freely(begin, nu_0);
    memcpy(nu_free, nu_0, sizeof nu_0);
    return 1;
}

static quad along(const quad *row, const quad *x) {
    quad sum = 0;
    for (int k = 0; k < nv; k++) sum += row[k] * x[k];
    return sum;
}

/* Whether the place of a contact is the foot of its centre on the plane: see find_places. */
static int on_plane[MOST_CONTACTS];

/* J v of all contacts and held rows, a time t from the middle on its straight way. */
static void speeds_of_rows(quad t, quad *speed) {
    quad q[WORLD_COORDINATES], v[WORLD_DOFS];
    rbd_constraint k;
    move(middle, begin, begin, t, q, v);
    world_move(&truth, now.robot.bodies, now.robot.nb, q, v, NULL);
    for (int i = 0; i < now.n; i++) {
        contact_constraint(&now.list[i], on_plane[i], &k);
        dense_rows_of(&truth, &k, 1, NULL, &found_rows);
        for (int r = 0; r < 3; r++) *speed++ = along(found_rows.J[r], v);
    }
    dense_rows_of(&truth, now.held, now.n_held, NULL, &found_rows);
    for (int r = 0; now.n_held && r < found_rows.rows; r++) *speed++ = along(found_rows.J[r], v);
}

/* gamma = d(J v)/dt on that way, by differences of order four. */
static void find_gamma(void) {
    enum { N = sizeof gamma / sizeof *gamma };
    static const double factor[4] = {1, -8, 8, -1};
    quad t = 1, size = 1;
    for (int k = 0; k < nv; k++) size += fabsl((long double)begin[k]);
    t = 1e-3L / size;
    memset(gamma, 0, sizeof gamma);
    for (int j = 0; half > 0 && j < 4; j++) {
        quad speed[N] = {0};
        speeds_of_rows(t * (j < 2 ? j - 2 : j - 1), speed);
        for (int r = 0; r < N; r++) gamma[r] += factor[j] * speed[r] / (12 * t);
    }
    world_move(&truth, now.robot.bodies, now.robot.nb, middle, begin, NULL);
}

/* Keeps n of the rows found as rows of the problem, and what their levers alone would make of Delta. */
static void keep_rows(int row, int n, const quad *gamma_of) {
    memcpy(J[row], found_rows.J, (size_t)n * sizeof *J);
    memcpy(J_size[row], found_rows.J_size, (size_t)n * sizeof *J);
    for (int r = 0; r < n; r++) {
        gamma_of_row[row + r] = gamma_of[r];
        exact_laws.b[row + r] += half * gamma_of[r];
        lever[row + r] = 0;
        for (int k = 0; k < nv; k++)
            lever[row + r] += found_rows.J_size[r][k] * found_rows.J_size[r][k] * exact.inverse[k];
    }
}

static void keep_dofs(int row, int n, const int *dof, const rbd_real *jacobian) {
    memset(J[row], 0, sizeof *J);
    memset(J_size[row], 0, sizeof *J);
    lever[row] = gamma_of_row[row] = 0;
    for (int j = 0; j < n; j++) {
        J[row][dof[j]] = jacobian[j];
        lever[row] += (quad)jacobian[j] * jacobian[j] * exact.inverse[dof[j]];
    }
}

static void keep_dof(int row, int dof, rbd_real side) { keep_dofs(row, 1, &dof, &side); }

/* ---- a problem in the library ---- */

static const rbd_model *model;
static rbd_work *work;
static rbd_contact_set *set;
static void *memory[3];

static int build(void) {
    const size_t size = rbd_model_size(now.robot.bodies, now.robot.nb);
    memory[0] = memory_of(size);
    if (rbd_model_build(now.robot.bodies, now.robot.nb, memory[0], size, &model, NULL)) return 0;
    memory[1] = memory_of(rbd_work_size(model));
    if (rbd_work_init(model, memory[1], rbd_work_size(model), &work)) return 0;
    const rbd_const gravity[3] = {(rbd_const)now.state.gravity[0], (rbd_const)now.state.gravity[1],
                                  (rbd_const)now.state.gravity[2]};
    rbd_set_gravity(work, gravity);
    return 1;
}

static int build_set(void) {
    const size_t size = rbd_contact_set_size(model, now.n, now.held, now.n_held, &now.options);
    memory[2] = memory_of(size);
    if (rbd_contact_set_init(model, work, now.list, now.n, now.held, now.n_held, &now.options, memory[2],
                             size, &set, NULL))
        return 0;
    for (int i = 0; i < now.options.rows; i++)
        if (rbd_contact_row_set(model, set, i, &now.row[i])) return 0;
    return 1;
}

static void release(void) {
    for (int k = 0; k < 3; k++) free(memory[k]), memory[k] = NULL;
    set = NULL;
}

/* ---- the laws' biases ---- */

/* A gap at the step's beginning, its rate there, and at the end if the velocity of the end is 0. */
typedef struct gap_of_row {
    quad first, rate, rest;
} gap_of_row;

static gap_of_row gap_from_middle(quad gap, quad rate, quad acceleration) {
    gap_of_row g;
    g.rate = rate - half * acceleration;
    g.rest = gap - half * half / 2 * acceleration;
    g.first = g.rest - half * g.rate;
    return g;
}

static int is_row(const gap_of_row *g, double margin) {
    return g->first <= margin || g->first + 2 * now.dt * g->rate <= 0;
}
static int may_be_either(const gap_of_row *g, double margin) {
    const double little_more = IN_FLOAT ? 1e-4 : 1e-9;
    return fabs((double)(g->first + 2 * now.dt * g->rate)) < little_more ||
           fabs((double)g->first - margin) < little_more;
}

/* A rigid row may close its gap, no more. */
static quad closing(const gap_of_row *g) { return g->rest > 0 ? g->rest / way : 0; }

/* In positions, a rigid row that is in the plane also gives back what the first half of the step made deeper,
   over a hundredth of the slop, and a fifth of the depth below the slop. */
static quad lifting(const gap_of_row *g) {
    const quad slop = 1e-5L, made = g->rest - g->first;
    quad bias = 0;
    if (g->rest > 0) return closing(g);
    if (g->first > 0) return g->rest < -slop / 100 ? g->rest / way : 0;
    if (made < -slop / 100) bias += made / way;
    if (g->first < -slop) bias += (g->first + slop) / (5 * way);
    return bias;
}

static gap_of_row gaps[MOST_CONTACTS];
static int springs_of[MOST_CONTACTS], rebounds_of[MOST_CONTACTS];

/* A stiff contact is a spring if it is in the plane at the end, without impulses or at rest. free: its speed
   without impulses. Where rounding decides, both have no force. */
static int is_spring(const rbd_contact *a, const rbdi_contact *own, const gap_of_row *g, quad free) {
    const quad end = g->rest + way * free, lower = g->rest < end ? g->rest : end,
               doubt = (IN_FLOAT ? 1e-5L : 1e-13L) * (1 + fabsl((long double)a->height));
    if (!(a->stiffness > 0)) return 0;
    return lower < doubt && lower > -doubt ? own->springs : lower <= 0;
}

/* It rebounds if it approaches faster than 0.05 m/s, and positions bring it into the plane. */
static int is_rebound(const rbd_contact *a, const rbdi_contact *own, const gap_of_row *g, const quad *row,
                      quad gamma_n) {
    quad moved[WORLD_DOFS];
    if (!(a->restitution > 0) || !(g->rate < -0.05L)) return 0;
    if (own->springs || !(rbd_contact_last(set).residual <= now.options.tolerance)) return own->rebounds;
    for (int k = 0; k < nv; k++) moved[k] = (quad)set->moved[k];
    const double beyond = (double)(along(row, moved) + half * gamma_n + lifting(g));
    const double doubt = (IN_FLOAT ? 1e-2 : 1e-6) * (1 + fabs((double)g->rate)) + 10 * now.options.tolerance;
    if (fabs(beyond) < doubt && !own->rebounds) return set->rows->lambda[own->row + 2] > 0;
    return beyond < doubt;
}

/* e times the speed with which it hits: that of the beginning, and what it falls until then. */
static quad rebounding(const rbd_contact *a, const gap_of_row *g, quad free) {
    const quad faster = free < g->rate && g->first > 0 ? 2 * g->first * (g->rate - free) / now.dt : 0;
    return -a->restitution * world_sqrt(g->rate * g->rate + faster);
}

/* What is added to u_n. If `any` contact rebounds, one that leaves may keep its speed. free: u_n without
   impulses. */
static quad bias_of(const rbd_contact *a, int i, quad free, int any) {
    const gap_of_row *g = &gaps[i];
    if (rebounds_of[i]) return rebounding(a, g, free);
    if (springs_of[i])
        return a->stiffness * (g->rest + (g->first < 0 ? g->first : 0)) /
               (way * a->stiffness + 2 * a->damping);
    return any && g->rate > 0 && g->rate > closing(g) ? g->rate : closing(g);
}
/* ---- rows ---- */

/* Of all bodies, rad/s. */
static double fastest_turn(void) {
    double most = 0;
    for (int i = 0; i < truth.elements; i++) most = larger(most, (double)truth.element[i].w_size);
    return most;
}

/* Of all bodies: turns and what points move by them, rad/s and m/s. */
static double fastest_of_bodies(void) {
    double most = 0;
    for (int i = 0; i < now.robot.nb; i++) {
        const world_element *e = &truth.element[truth.last[i]];
        most = larger(most, (double)(e->w_size * (1 + truth.p_size[i]) + e->v_size));
    }
    return most;
}

/* Gaps and gamma. A contact is a place on its ball; but where three of the same bodies touch, or arrive
   within two steps, each is the foot of its centre on the plane. */
static void find_places(void) {
    int any = 0;
    memset(on_plane, 0, sizeof on_plane);
    find_gamma();
    for (int i = 0; i < now.n; i++) {
        rbd_constraint k;
        const quad gap = contact_constraint(&now.list[i], 0, &k) - now.list[i].height;
        dense_rows_of(&truth, &k, 1, NULL, &found_rows);
        gaps[i] = gap_from_middle(gap, along(found_rows.J[2], begin), gamma[3 * i + 2]);
    }
    for (int i = 0; i < now.n; i++) {
        int n = 0, doubt = 0;
        for (int j = 0; j < now.n; j++) {
            const rbd_contact *a = &now.list[i], *b = &now.list[j];
            if (carrier(&now, a->body1) != carrier(&now, b->body1)) continue;
            if (carrier(&now, a->body2) != carrier(&now, b->body2)) continue;
            n += is_row(&gaps[j], 1e-5), doubt |= may_be_either(&gaps[j], 1e-5);
        }
        on_plane[i] = doubt ? set->contact[i].on_plane : n >= 3;
        any |= on_plane[i];
    }
    if (any) find_gamma();
}

/* The rows of contact i, if it is near: J, and what is added to u of them. Returns 0 if the library has
   another opinion. */
static int add_contact_rows(int i) {
    laws *x = &exact_laws;
    const rbd_contact *a = &now.list[i];
    const rbdi_contact *own = &set->contact[i];
    rbd_constraint k;
    rbd_real told;
    contact_constraint(a, on_plane[i], &k);
    dense_rows_of(&truth, &k, 1, NULL, &found_rows);
    springs_of[i] = rebounds_of[i] = 0;
    rbd_contact_get(set, i, &told, NULL);
    const double moves = (double)half * fastest_of_bodies();
    record(GAP, fabs((double)(told - gaps[i].first)) /
                    (1 + (double)truth.reach[0] + fabs(a->height) + moves + moves * moves));
    if (is_row(&gaps[i], 0.005) != (own->row >= 0)) return may_be_either(&gaps[i], 0.005);
    if (own->row < 0) return 1;

    springs_of[i] = is_spring(a, own, &gaps[i], along(found_rows.J[2], nu_0) + half * gamma[3 * i + 2]);
    rebounds_of[i] = is_rebound(a, own, &gaps[i], found_rows.J[2], gamma[3 * i + 2]);
    keep_rows(x->rows, 3, &gamma[3 * i]);
    x->mu[x->rows / 3] = a->friction;
    x->spring[x->rows / 3] = springs_of[i] ? 2 / (now.dt * ((double)way * a->stiffness + 2 * a->damping)) : 0;
    x->delta[x->rows + 2][x->rows + 2] = x->spring[x->rows / 3];
    x->rows += 3;
    return 1;
}

static void add_held_rows(void) {
    laws *x = &exact_laws;
    if (!now.n_held) return;
    dense_rows_of(&truth, now.held, now.n_held, NULL, &found_rows);
    keep_rows(x->rows, found_rows.rows, &gamma[3 * now.n]);
    for (int r = 0; r < found_rows.rows; r++, x->rows++) x->lower[x->rows] = -1e30, x->upper[x->rows] = 1e30;
}

/* Row of the limit on one side of a joint, if it is near. */
static void add_limit(const rbd_body *b, double q, double v, int dof, int upper, int any) {
    laws *x = &exact_laws;
    gap_of_row g;
    g.first = upper ? (quad)b->upper - q : (quad)q - b->lower, g.rate = upper ? -v : v;
    g.rest = g.first + half * g.rate;
    if (!is_row(&g, 0.02)) return;
    keep_dof(x->rows, dof, upper ? -1 : 1);
    x->lower[x->rows] = 0, x->upper[x->rows] = 1e30;
    x->b[x->rows] = any && g.rate > 0 && g.rate > closing(&g) ? g.rate : closing(&g);
    x->rows++;
}

/* The laws of a bounded row. In steps of second order the work of dry friction, by the mean of the speeds
   before and at the end, is not above 0: with the sign of the first solution's impulse it brakes, and may
   stop; or it pushes the way in which the row moves, which must then turn around. */
static void add_bounded(const rbd_contact_row *row) {
    laws *x = &exact_laws;
    const int r = x->rows++;
    const quad first = r < set->rows->rows ? (quad)set->early[r] : 0;
    const double tolerance =
        now.options.tolerance > 0 ? now.options.tolerance : (double)RBDI_CONTACT_TOLERANCE;
    keep_dofs(r, row->dofs, row->dof, row->jacobian);
    x->lower[r] = now.dt * (double)row->lower, x->upper[r] = now.dt * (double)row->upper;
    x->b[r] = row->bias, x->delta[r][r] = row->compliance;

    const quad u = along(J[r], begin);
    const int brakes = u * first <= 0;
    if (half == 0 || row->compliance > 0 || fabs((double)row->bias) > 0) return;
    if (!(fabs((double)u) > tolerance)) return;
    if (brakes == (u > 0))
        x->upper[r] = 0;
    else
        x->lower[r] = 0;
    if (!brakes) x->b[r] = u;
}

/* Limits of joints, their dry friction, and bounded rows. */
static void add_joint_rows(int any) {
    for (int i = 0, iq = 0, iv = 0; now.options.joint_limits && i < now.robot.nb; i++) {
        const rbd_body *b = &now.robot.bodies[i];
        for (int upper = 0; !b->mimic && upper < 2 && has_limits(b) && b->lower < b->upper; upper++)
            add_limit(b, now.state.q[iq], now.state.v[iv], iv, upper, any);
        iq += world_nq(b), iv += world_nv(b);
    }
    for (int i = 0, iv = 0; now.options.joint_friction && i < now.robot.nb; i++) {
        const rbd_body *b = &now.robot.bodies[i];
        for (int k = 0; !b->mimic && k < world_nv(b); k++, iv++) {
            const rbd_real most = (rbd_real)b->friction[k];
            const rbd_contact_row row = {
                .dofs = 1, .dof = {iv}, .jacobian = {1}, .lower = -most, .upper = most};
            if (most > 0) add_bounded(&row);
        }
    }
    for (int i = 0; i < now.options.rows; i++) add_bounded(&now.row[i]);
}

/* All rows of the step by their definition, in the library's order, and its impulses. Returns 0 if it has
   other rows. */
static int find_rows(int *energy_holds) {
    laws *x = &exact_laws;
    int any = 0, agrees = 1;
    x->rows = 0, *energy_holds = 1;
    memset(x->b, 0, sizeof x->b);
    memset(x->delta, 0, sizeof x->delta);
    for (int i = 0; i < now.n; i++) {
        if (!add_contact_rows(i)) fail(failure_names[NOT_A_ROW], (double)gaps[i].first), agrees = 0;
        any |= rebounds_of[i];
        if (set->contact[i].row >= 0 && now.list[i].stiffness > 0) *energy_holds = 0;
    }
    x->contacts = x->rows / 3;
    if (any) *energy_holds = 0;
    for (int i = 0; i < now.options.rows; i++)
        if (fabs((double)now.row[i].bias) > 0) *energy_holds = 0; /* it drives */
    for (int i = 0; i < now.n; i++) {
        const int normal = set->contact[i].row + 2;
        if (normal < 2 || normal >= x->rows) continue;
        x->b[normal] += bias_of(&now.list[i], i, along(J[normal], nu_0) + half * gamma[3 * i + 2], any);
    }
    add_held_rows();
    add_joint_rows(any);
    for (int r = 0; r < x->rows && r < set->rows->rows; r++) x->p[r] = (quad)set->rows->lambda[r];
    return agrees && x->rows == set->rows->rows;
}

/* Delta = J M^-1 J' and b, beside the library's. */
static void find_delta(void) {
    laws *x = &exact_laws;
    /* gaps, which may be rounding, over this time */
    quad worst_delta = 0, worst_b = 0, size_b = (IN_FLOAT ? 1e-4L : 1e-5L) / way;
    for (int r = 0; r < x->rows; r++) {
        quad y[WORLD_DOFS];
        dense_inverse(&exact, J[r], y);
        for (int k = 0; k < x->rows; k++) x->delta[r][k] += along(J[k], y);
        x->b[r] += along(J[r], nu_free);
    }
    for (int r = 0; r < x->rows; r++) {
        const quad off = (quad)set->b[r] - x->b[r];
        worst_b = larger((double)worst_b, fabs((double)off));
        size_b = larger((double)size_b, fabs((double)x->b[r]));
        for (int k = 0; k < x->rows; k++) {
            const quad both = world_sqrt(lever[r] * lever[k]),
                       error = (quad)set->rows->R[r * x->rows + k] - x->delta[r][k];
            if (both > 0) worst_delta = larger((double)worst_delta, fabs((double)(error / both)));
        }
    }
    for (int k = 0; k < nv; k++) size_b = larger((double)size_b, fabs((double)nu_free[k]));
    record(DELTA, (double)(worst_delta * exact.distance));
    record(FREE, (double)(worst_b / size_b * exact.distance));
}

/* Of the levers that make a term, or of velocities whose difference it is, beside the term itself: its own
   rounding. */
static const quad little = IN_FLOAT ? 1e-3L : 1e-6L;

/* K (nu - begin) = forces + J' p with what the library returns. */
static void check_equation(const quad *nu) {
    const laws *x = &exact_laws;
    double worst_row = 0;
    for (int k = 0; k < nv; k++) {
        quad error = -forces[k], size = forces_size[k] + (quad)1e-12L;
        for (int j = 0; j < nv; j++) {
            const quad term = M[k * nv + j] * (nu[j] - begin[j]);
            error += term;
            size += fabsl((long double)term) + little * fabsl((long double)M[k * nv + j]) *
                                                   (fabsl((long double)nu[j]) + fabsl((long double)begin[j]));
        }
        for (int r = 0; r < x->rows; r++) {
            const quad term = J[r][k] * x->p[r];
            error -= term;
            size += fabsl((long double)term) + little * J_size[r][k] * fabsl((long double)x->p[r]);
        }
        worst_row = larger(worst_row, fabs((double)(error / size)));
    }
    record(EQUATION, worst_row * (double)exact.distance);
}

/* Forces as rbd_contact_get has them: n of the plane, and mu. */
static void check_forces(void) {
    for (int i = 0; i < now.n; i++) {
        rbd_real f[3];
        const rbd_contact_state state = rbd_contact_get(set, i, NULL, f);
        const int row = set->contact[i].row;
        const double size = hypot(hypot((double)f[0], (double)f[1]), (double)f[2]) * now.dt,
                     own = row < 0 ? 0 : magnitude_of(&exact_laws.p[row], 3);
        if (fabs(size - own) > (IN_FLOAT ? 1e-5 : 1e-12) * own) fail(failure_names[WRONG_ANSWER], size);
        if (state <= RBD_OPENS && own > 0) fail(failure_names[WRONG_ANSWER], own);
    }
}

/* A residual is an error of p times the normal's own 1/mass: tangents may be off by so many times that. */
static double spread_of(int r) {
    const laws *x = &exact_laws;
    const int first = r / 3 * 3;
    double trace = 0;
    if (r >= 3 * x->contacts) return 1;
    for (int j = 0; j < 3; j++) trace += (double)x->delta[first + j][first + j];
    return trace / (double)x->delta[first + 2][first + 2];
}

/* Contacts take kinetic energy: p'(u + u_free)/2 without biases. More than the residual allows is an
   error. */
static void check_energy(double residual) {
    const laws *x = &exact_laws;
    quad sum = 0, size = 0, allowed = 0;
    for (int r = 0; r < x->rows; r++) {
        const quad before = along(J[r], nu_free) + half * gamma_of_row[r];
        quad after = before;
        for (int k = 0; k < x->rows; k++) after += x->delta[r][k] * x->p[k];
        sum += x->p[r] * (before + after) / 2;
        size += fabsl((long double)x->p[r]);
        if (x->p[r] < 0 || x->p[r] > 0) allowed += 2 * residual * fabsl((long double)x->p[r]) * spread_of(r);
    }
    if (size > 0) record(ENERGY, (double)((sum - allowed) / size) / x->speed);
}

/* ---- another method: p = P(p - u/L) contact by contact, until nothing changes ---- */

static quad clamp(quad x, double low, double high) { return x < low ? low : x > high ? high : x; }

static void add_impulse(laws *x, int r, quad change) {
    if (!(change < 0 || change > 0)) return;
    for (int k = 0; k < x->rows; k++) x->u[k] += x->delta[k][r] * change;
    x->p[r] += change;
}

static double project_contact(laws *x, int i) {
    const int r = 3 * i;
    const quad d = x->delta[r + 2][r + 2], L = x->delta[r][r] + x->delta[r + 1][r + 1];
    double change = 0;
    for (int again = 0; again < 4; again++) {
        quad t[2], size, n;
        if (!(d > (quad)1e-15L * L) || !(d > 0)) return 0;
        n = x->p[r + 2] - x->u[r + 2] / d;
        n = n > 0 ? n : 0;
        change = larger(change, fabs((double)((n - x->p[r + 2]) * d)));
        add_impulse(x, r + 2, n - x->p[r + 2]);
        for (int j = 0; j < 2; j++) t[j] = L > 0 ? x->p[r + j] - x->u[r + j] / L : 0;
        size = world_sqrt(t[0] * t[0] + t[1] * t[1]);
        for (int j = 0; j < 2; j++) {
            if (size > x->mu[i] * n) t[j] *= x->mu[i] * n / size;
            change = larger(change, fabs((double)((t[j] - x->p[r + j]) * L)));
        }
        for (int j = 0; j < 2; j++) add_impulse(x, r + j, t[j] - x->p[r + j]);
    }
    return change;
}

/* From p = 0. Returns whether it has come to the end. */
static int other_method(laws *x) {
    for (int r = 0; r < x->rows; r++) x->p[r] = 0, x->u[r] = x->b[r];
    for (int sweep = 0; sweep < 3000; sweep++) {
        double change = 0;
        for (int i = 0; i < x->contacts; i++) change = larger(change, project_contact(x, i));
        for (int r = 3 * x->contacts; r < x->rows; r++) {
            const quad d = x->delta[r][r],
                       p = d > 0 ? clamp(x->p[r] - x->u[r] / d, x->lower[r], x->upper[r]) : 0;
            change = larger(change, fabs((double)((p - x->p[r]) * d)));
            add_impulse(x, r, p - x->p[r]);
        }
        if (change < 1e-13 * x->speed) return 1;
    }
    return 0;
}

static void compare_methods(void) {
    static laws y;
    double worst_u = 0;
    int frictionless = 1;
    y = exact_laws;
    if (!other_method(&y)) {
        counts[kind_now][NOT_COMPARED]++;
        return;
    }
    counts[kind_now][COMPARED]++;
    for (int r = 0; r < y.rows; r++) { /* a spring's own part of u is no velocity */
        const double d = (double)y.delta[r][r],
                     spring = r < 3 * y.contacts && r % 3 == 2 ? y.spring[r / 3] : 0;
        const double error = fabs((double)(y.u[r] - exact_laws.u[r])) / exact_laws.speed;
        worst_u = larger(worst_u, spring > 0 ? error * (d - spring) / d : error);
    }
    for (int i = 0; i < y.contacts; i++) frictionless &= !(y.mu[i] > 0);
    if (worst_u > 1e-5 && !frictionless)
        counts[kind_now][SEVERAL]++;
    else
        record(METHODS, worst_u);
}

/* ---- a whole step ---- */

static double off(const rbd_real *found, const quad *expected, int n, double size) {
    double worst_of_all = 0;
    for (int k = 0; k < n; k++) worst_of_all = larger(worst_of_all, fabs((double)(found[k] - expected[k])));
    return worst_of_all / size;
}

/* q_next and v_next are the middle moved by `moved`, and nu in the axes of the end. */
static void check_move(const rbd_real *q_next, const rbd_real *v_next) {
    quad q[WORLD_COORDINATES], v[WORLD_DOFS], moved[WORLD_DOFS], nu[WORLD_DOFS];
    for (int k = 0; k < nv; k++) moved[k] = (quad)set->moved[k], nu[k] = (quad)set->nu[k];
    move(middle, moved, nu, way, q, v);
    const double turn = 1 + now.dt * (largest_of(moved, nv) + largest_of(begin, nv));
    record(MOVES, larger(off(q_next, q, now.robot.nq, (1 + largest_of(q, now.robot.nq)) * turn),
                         off(v_next, v, nv, (1 + largest_of(nu, nv)) * turn)));
}

/* Positions bring no rigid contact into its plane, and lift those that are in it. */
static void check_depth(void) {
    quad moved[WORLD_DOFS];
    for (int k = 0; k < nv; k++) moved[k] = (quad)set->moved[k];
    for (int i = 0; i < now.n; i++) {
        const int normal = set->contact[i].row + 2;
        if (normal < 2 || springs_of[i]) continue;
        if (!(exact_laws.delta[normal][normal] > exact_laws.unmoved)) continue;
        const quad u = along(J[normal], moved) + half * gamma[3 * i + 2] + lifting(&gaps[i]);
        record(DEPTH, -(double)u / exact_laws.speed);
    }
}

/* Kinetic and potential energy at a state. Adds up the first, and the sizes of what both are sums of. */
static quad energy_at(const rbd_real *q, const rbd_real *v, quad *kinetic, quad *sizes) {
    quad wide_q[WORLD_COORDINATES], wide_v[WORLD_DOFS], gravity[3];
    world_totals total;
    for (int k = 0; k < now.robot.nq; k++) wide_q[k] = (quad)q[k];
    for (int k = 0; k < nv; k++) wide_v[k] = (quad)v[k];
    widen(now.state.gravity, 3, gravity);
    world_move(&truth, now.robot.bodies, now.robot.nb, wide_q, wide_v, NULL);
    world_total(&truth, gravity, wide_v, &total);
    *kinetic += total.energy[0];
    *sizes += total.energy_size[0] + total.energy_size[1];
    return total.energy[0] + total.energy[1];
}

/* Torques, wrenches and damping do work at the mean velocity, and contacts p'(J v + J nu)/2. The rest of what
   energy changes by is the scheme's own: of kinetic energy and work a part of order x^3 + x y + y^2 / x, with
   x the way of the step (rad or m) and y the change of the velocity times dt. That is dt^3, for y is dt^2 but
   in impacts: forces are those of q + v dt/2, not of half of the way, and what velocity terms do is of third
   power in the velocity. */
static void check_balance(const rbd_real *q, const rbd_real *v, const rbd_real *q_next,
                          const rbd_real *v_next) {
    const laws *z = &exact_laws;
    quad a[WORLD_DOFS], mean[WORLD_DOFS], wrench[6 * WORLD_BODIES], gravity[3], c[3][WORLD_DOFS],
        size[WORLD_DOFS], done = 0, all = 0, sizes = 0;
    const quad no_gravity[3] = {0, 0, 0};
    double x = 0, y = 0, faster = 1; /* followers */
    for (int k = 0; k < nv; k++) {
        const quad nu = (quad)set->nu[k];
        mean[k] = (begin[k] + nu) / 2;
        x += now.dt * (fabs((double)begin[k]) + fabs((double)nu));
        y += now.dt * fabs((double)(nu - begin[k]));
    }
    for (int i = 0; i < now.robot.nb; i++)
        if (now.robot.bodies[i].mimic) faster = larger(faster, fabs(now.robot.bodies[i].mimic_ratio));
    x *= faster, y *= faster;
    if (!(x < 1)) return;
    straight(mean, a);
    widen(now.state.f_ext, 6 * now.robot.nb, wrench);
    widen(now.state.gravity, 3, gravity);
    world_move(&truth, now.robot.bodies, now.robot.nb, middle, mean, a);
    world_torques(&truth, no_gravity, a, NULL, c[0], size);
    world_torques(&truth, no_gravity, a, wrench, c[1], size);
    world_torques(&truth, gravity, a, wrench, c[2], size);
    for (int k = 0; k < nv; k++) {
        const quad torque = now.state.tau[k] - now.damping[k] * (quad)set->nu[k] + c[0][k] - c[1][k];
        done += now.dt * torque * mean[k];
        all += now.dt * (fabsl((long double)torque) + size[k]) * fabsl((long double)mean[k]);
    }
    for (int r = 0; r < z->rows; r++) {
        const quad work_of_row = z->p[r] * along(J[r], mean);
        done += work_of_row, all += fabsl((long double)work_of_row);
        sizes += 1e-3 * z->speed * fabsl((long double)z->p[r]); /* rounding of nu that large impulses leave */
    }
    const quad before = energy_at(q, v, &all, &sizes), after = energy_at(q_next, v_next, &all, &sizes);
    world_move(&truth, now.robot.bodies, now.robot.nb, middle, begin, NULL);
    const quad order_3 = x * x * x + x * y + (x > 0 ? y * y / x : 0), rounding = IN_FLOAT ? 1e-5L : 1e-13L;
    record(BALANCE,
           fabs((double)((after - before - done) / (all * order_3 + (all + sizes) * rounding + 1e-30L))));
}

/* A solution without contacts, and its forces K (nu - begin). */
typedef struct motion {
    quad nu[WORLD_DOFS], force[WORLD_DOFS];
} motion;

static motion motion_of(const quad *w) {
    motion m;
    move_freely(w, m.nu);
    memcpy(m.force, forces, sizeof forces);
    return m;
}

/* Twice the kinetic energy of the change from one motion to another. */
static quad energy_of_change(const motion *from, const motion *to) {
    quad sum = 0;
    for (int k = 0; k < nv; k++) sum += (to->nu[k] - from->nu[k]) * (to->force[k] - from->force[k]);
    return sum;
}

/* Where solutions diverge, the third is the sum of their series: third - r/(1 + r) (third - first). From
   r = 1/2 to 1 the share of that grows from 0 to 1. */
static void sum_series(const motion *first, const motion *second, motion *third) {
    const quad before = energy_of_change(first, second), after = energy_of_change(second, third);
    quad share;
    if (!(2 * after > before)) return;
    share = after / (before + after);
    if (after < before) share *= 2 * after / before - 1;
    for (int k = 0; k < nv; k++) {
        third->nu[k] -= share * (third->nu[k] - first->nu[k]);
        third->force[k] -= share * (third->force[k] - first->force[k]);
    }
}

/* Velocity terms of the step's last solution are those of the mean of v and a solution before it. That one
   has impulses of its own, and is taken from the library, as the mean is. */
static void find_last_motion(void) {
    const motion first = motion_of(begin);
    motion second, third;
    rbd_real change[WORLD_DOFS];
    quad w[WORLD_DOFS];

    for (int k = 0; k < nv; k++) change[k] = set->x[1][k];
    rbdi_vector_forward(model, work, work->H, change);
    for (int k = 0; k < nv; k++) second.nu[k] = begin[k] + (quad)change[k];
    for (int k = 0; k < nv; k++) {
        second.force[k] = 0;
        for (int j = 0; j < nv; j++) second.force[k] += M[k * nv + j] * (quad)change[j];
    }

    for (int k = 0; k < nv; k++) w[k] = (quad)set->at[k];
    third = motion_of(w);
    sum_series(&first, &second, &third);
    memcpy(nu_free, third.nu, sizeof nu_free);
    memcpy(forces, third.force, sizeof forces);
}

/* rbd_free_step is the step without contacts, and three solutions with the velocity terms of the mean. */
static void check_free_step(const rbd_real *q, const rbd_real *v, const rbd_real *tau, const rbd_real *wrench,
                            const rbd_real *damping) {
    rbd_real q_next[WORLD_COORDINATES], v_next[WORLD_DOFS], q_too[WORLD_COORDINATES], v_too[WORLD_DOFS];
    quad w[WORLD_DOFS], *nu, at_end[WORLD_DOFS], q_end[WORLD_COORDINATES];
    motion free_motion[3];
    const rbd_real dt = (rbd_real)now.dt;
    const size_t size = rbd_contact_set_size(model, 0, NULL, 0, NULL);
    void *empty_memory = memory_of(size);
    rbd_contact_set *empty;
    free_motion[0] = motion_of(begin);
    for (int i = 1; i < 3; i++) {
        for (int k = 0; k < nv; k++) w[k] = (begin[k] + free_motion[i - 1].nu[k]) / 2;
        free_motion[i] = motion_of(w);
    }
    sum_series(&free_motion[0], &free_motion[1], &free_motion[2]);
    nu = free_motion[2].nu;
    move(middle, nu, nu, way, q_end, at_end);
    if (rbd_free_step(model, work, q, v, tau, wrench, damping, dt, q_next, v_next) != RBD_OK ||
        rbd_contact_set_init(model, work, NULL, 0, NULL, 0, NULL, empty_memory, size, &empty, NULL) !=
            RBD_OK ||
        rbd_contact_step(model, empty, q, v, tau, wrench, damping, dt, q_too, v_too) != RBD_OK) {
        fail(failure_names[STATUS], 0);
    } else {
        const double share = (double)exact.distance,
                     speed = 1 + largest_of(nu, nv) + largest_of(nu_0, nv) + largest_of(begin, nv),
                     way_of_all = 1 + largest_of(q_end, now.robot.nq) + now.dt * speed;
        record(FREE_STEP, share * off(v_next, at_end, nv, speed));
        record(FREE_STEP, share * off(q_next, q_end, now.robot.nq, way_of_all));
        record(FREE_STEP, share * off(v_too, at_end, nv, speed));
        record(FREE_STEP, share * off(q_too, q_end, now.robot.nq, way_of_all));
    }
    free(empty_memory);
}

/* ---- one problem ---- */

/* The laws of a call that has found this nu. Returns whether it was solved, with the rows that are told. */
static int check_answer(const quad *nu) {
    int energy_holds;
    if (!find_rows(&energy_holds)) {
        fail(failure_names[NOT_A_ROW], exact_laws.rows);
        return 0;
    }
    find_delta();
    find_velocities(&exact_laws, now.options.tolerance / relative_tolerance);
    const double residual = (double)rbd_contact_last(set).residual;
    counts[kind_now][ROWS] += exact_laws.rows;
    counts[kind_now][ITERATIONS] += rbd_contact_last(set).sweeps + rbd_contact_last(set).newton_steps;
    check_forces();
    const int solved = judge(&exact_laws, residual, now.options.tolerance);
    if (solved) check_equation(nu), check_depth();
    if (energy_holds) check_energy(residual);
    if (solved && number_now % 4 == 0 && !IN_FLOAT) compare_methods();
    if (!solved && !IN_FLOAT && !rbdi_write_biases(set, RBDI_FOR_POSITIONS)) {
        static laws y;
        y = exact_laws;
        const int other = other_method(&y);
        counts[kind_now][OTHER_SOLVES] += other;
    }
    return solved;
}

static void print_scene(void) {
    static const char *const states[4] = {"apart", "opens", "sticks", "slips"};
    print_robot(&now.robot);
    print_state(&now.robot, &now.state);
    printf("dt %g, %d contacts, %d held, tolerance %g\n", now.dt, now.n, now.n_held, now.options.tolerance);
    for (int i = 0; set && i < now.n; i++) {
        const rbd_contact *a = &now.list[i];
        rbd_real gap, f[3];
        const rbd_contact_state state = rbd_contact_get(set, i, &gap, f);
        printf("%d: bodies %d, %d, gap %g, mu %g, e %g, k %g: %s, %g %g %g N\n", i, a->body1, a->body2,
               (double)gap, a->friction, a->restitution, a->stiffness, states[state], (double)f[0],
               (double)f[1], (double)f[2]);
    }
    if (set)
        printf("%d sweeps, %d Newton steps\n", rbd_contact_last(set).sweeps,
               rbd_contact_last(set).newton_steps);
}

/* What the library is given. */
static struct {
    rbd_real q[WORLD_COORDINATES], v[WORLD_DOFS], tau[WORLD_DOFS], damping[WORLD_DOFS],
        wrench[6 * WORLD_BODIES], dt;
} given;

static void give(void) {
    for (int k = 0; k < now.robot.nq; k++) given.q[k] = (rbd_real)now.state.q[k];
    for (int k = 0; k < nv; k++) {
        given.v[k] = (rbd_real)now.state.v[k], given.tau[k] = (rbd_real)now.state.tau[k];
        given.damping[k] = (rbd_real)now.damping[k];
    }
    for (int k = 0; k < 6 * now.robot.nb; k++) given.wrench[k] = (rbd_real)now.state.f_ext[k];
    given.dt = (rbd_real)now.dt;
}

/* rbd_contact_fd: of first order. */
static void run_acceleration(void) {
    rbd_real a[WORLD_DOFS] = {0}, again[WORLD_DOFS];
    quad nu[WORLD_DOFS], bend[WORLD_DOFS];
    const rbd_status status =
        rbd_contact_fd(model, set, given.q, given.v, given.tau, given.wrench, given.damping, given.dt, a);
    straight(begin, bend);
    for (int k = 0; k < nv; k++) nu[k] = begin[k] + now.dt * ((quad)a[k] - bend[k]);
    if (status != RBD_OK)
        fail(failure_names[STATUS], status);
    else if (!finite(a, nv))
        fail(failure_names[NOT_FINITE], 0);
    else
        find_places(), check_answer(nu);
    rbd_contact_reset(set);
    rbd_contact_fd(model, set, given.q, given.v, given.tau, given.wrench, given.damping, given.dt, again);
    if (memcmp(a, again, (size_t)nv * sizeof *a)) fail(failure_names[NOT_REPEATED], 0);
    rbd_contact_reset(set);
}

/* rbd_contact_step and rbd_free_step. */
static void run_step(void) {
    rbd_real q[WORLD_COORDINATES], v[WORLD_DOFS], q_again[WORLD_COORDINATES], v_again[WORLD_DOFS];
    quad nu[WORLD_DOFS];
    rbd_contact_set *const c = set;
    const rbd_status status =
        rbd_contact_step(model, c, given.q, given.v, given.tau, given.wrench, given.damping, given.dt, q, v);
    const int wild = now.dt * larger(fastest_turn(), largest_of(nu_0, nv)) > 1;
    if (status != RBD_OK) {
        if (!wild || status != RBD_ERR_NAN) fail(failure_names[STATUS], status);
    } else if (!finite(q, now.robot.nq) || !finite(v, nv)) {
        fail(failure_names[NOT_FINITE], 0);
    } else if (!wild) {
        find_places();
        find_last_motion();
        for (int k = 0; k < nv; k++) nu[k] = (quad)set->nu[k];
        check_move(q, v);
        if (check_answer(nu) && !set->differ) check_balance(given.q, given.v, q, v);
    }
    counts[kind_now][WILD] += wild;
    if (show) print_scene();
    rbd_contact_reset(set);
    rbd_contact_step(model, set, given.q, given.v, given.tau, given.wrench, given.damping, given.dt, q_again,
                     v_again);
    if (status == RBD_OK &&
        (memcmp(q, q_again, (size_t)now.robot.nq * sizeof *q) || memcmp(v, v_again, (size_t)nv * sizeof *v)))
        fail(failure_names[NOT_REPEATED], 0);
    if (!wild) check_free_step(given.q, given.v, given.tau, given.wrench, given.damping);
}

static void run_tree(int kind, int number) {
    kind_now = kind, number_now = number;
    draw_scene(&now, kind, number);
    nv = now.robot.nv;
    if (nv == 0 || now.n == 0) return;
    place_contacts();
    counts[kind][PROBLEMS]++;
    if (!find_motion(1)) {
        counts[kind][SINGULAR]++;
        return;
    }
    double speed = 1;
    for (int k = 0; k < nv; k++) speed = larger(speed, fabs((double)nu_free[k]));
    now.options.tolerance = relative_tolerance * speed;
    give();
    if (!build() || !build_set()) {
        fail(failure_names[NOT_BUILT], 0);
    } else {
        if (!IN_FLOAT) run_acceleration();
        if (find_motion(0)) run_step();
    }
    release();
}

/* ---- runs of robots ---- */

enum { HYQ_FALLS, HYQ_FALLS_LIMITS, HYQ_STANDS, HYQ_TROTS, ATLAS_FALLS, ATLAS_FALLS_LIMITS, SCENES };
static const char *const scene_names[SCENES] = {"HyQ falls", "HyQ falls, limits", "HyQ lands and stands",
                                                "HyQ trots", "Atlas falls over",  "Atlas falls, limits"};
enum { STEP_SIZES = 5, DECADES = 8 };
static const double step_sizes[STEP_SIZES] = {5e-4, 1e-3, 2e-3, 5e-3, 1e-2};

/* What all steps of a scene of one step size came to. */
typedef struct run_figures {
    long steps, unsolved, histogram[DECADES]; /* residuals below 1e-8, 1e-7 .. 1e-2, above */
    double worst, energy, cone, deepest;
    long iterations;
} run_figures;
static run_figures runs[SCENES][STEP_SIZES];

static const double hyq_stance[12] = {0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4};

typedef struct robot_run {
    int scene;
    rbd_real q[64], v[64], tau[64], damping[64], dt, t;
    int q_of[64]; /* coordinate of a dof */
    double wanted[64], kp, kd;
    uint64_t seed;
} robot_run;

static void find_coordinates(robot_run *r) {
    for (int b = 0; b < rbd_nb(model); b++) {
        rbd_joint_info joint;
        rbd_joint(model, b, &joint);
        if (joint.nv == 1) r->q_of[joint.iv] = joint.iq;
    }
}

static rbd_contact *touch(int body, double x, double y, double z, double radius, double friction) {
    rbd_contact *a = &now.list[now.n++];
    memset(a, 0, sizeof *a);
    a->body1 = body, a->body2 = -1, a->radius = radius, a->friction = friction;
    a->point[0] = x, a->point[1] = y, a->point[2] = z;
    return a;
}

static void list_hyq(int falls) {
    for (int k = 0; k < 4; k++) touch(HYQ_BODY_LF_LOWERLEG + k, 0.33, 0, 0, 0.02, 0.7);
    for (int k = 0; falls && k < 4; k++) touch(HYQ_BODY_LF_LOWERLEG + k, 0, 0, 0, 0.04, 0.5);
    for (int k = 0; falls && k < 8; k++)
        touch(HYQ_BODY_BASE_LINK_0, k & 1 ? 0.45 : -0.45, k & 2 ? 0.2 : -0.2, k & 4 ? 0.1 : -0.1, 0, 0.4);
}

static void list_atlas(void) {
    for (int k = 0; k < 8; k++)
        touch(k / 4 ? ATLAS_BODY_R_FOOT : ATLAS_BODY_L_FOOT, k & 1 ? 0.17 : -0.08, k & 2 ? 0.06 : -0.06,
              -0.08, 0, 0.8);
    for (int k = 0; k < 2; k++) {
        touch(ATLAS_BODY_L_HAND + k, 0, 0, 0, 0.08, 0.5);
        touch(ATLAS_BODY_L_LARM + k, 0, 0, 0, 0.06, 0.5);
        touch(ATLAS_BODY_L_LLEG + k, 0, 0, 0, 0.08, 0.5);
    }
    touch(ATLAS_BODY_PELVIS, 0, 0, 0, 0.15, 0.4);
    touch(ATLAS_BODY_HEAD, 0, 0, 0.05, 0.12, 0.4);
}

static int is_atlas(int scene_number) { return scene_number >= ATLAS_FALLS; }

/* The state that a run begins with: in the air or on the feet, turned and thrown a little. */
static void begin_run(robot_run *r) {
    const int atlas = is_atlas(r->scene), falls = r->scene <= HYQ_FALLS_LIMITS;
    const double tilt = falls ? 1 : atlas ? 0.1 : 0.02, throw = falls ? 2 : atlas ? 0.5 : 0.1;
    double u[4], square = 1;
    rbd_neutral(model, r->q);
    memset(r->v, 0, sizeof r->v);
    r->t = 0;
    for (int k = 0; k < 3; k++) u[k] = uniform(&r->seed, -tilt, tilt), square += u[k] * u[k];
    for (int k = 0; k < 3; k++) r->q[3 + k] = (rbd_real)(u[k] / sqrt(square));
    r->q[6] = (rbd_real)(1 / sqrt(square));
    for (int k = 0; k < 6; k++) r->v[k] = (rbd_real)uniform(&r->seed, -throw, throw);
    for (int k = 6; k < nv; k++) {
        r->wanted[k] = atlas ? 0 : hyq_stance[k - 6];
        r->q[r->q_of[k]] = (rbd_real)(r->wanted[k] + (falls ? uniform(&r->seed, -0.2, 0.2) : 0));
    }
    if (atlas)
        for (int k = 0; k < 2; k++) {
            r->wanted[k ? ATLAS_DOF_R_LEG_HPY : ATLAS_DOF_L_LEG_HPY] = -0.4;
            r->wanted[k ? ATLAS_DOF_R_LEG_KNY : ATLAS_DOF_L_LEG_KNY] = 0.8;
            r->wanted[k ? ATLAS_DOF_R_LEG_AKY : ATLAS_DOF_L_LEG_AKY] = -0.4;
        }
    for (int k = 6; atlas && k < nv; k++) r->q[r->q_of[k]] = (rbd_real)r->wanted[k];
    double lowest = 1e9;
    rbd_kinematics(model, work, r->q, NULL, NULL);
    for (int i = 0; i < now.n; i++) {
        const rbd_real point[3] = {(rbd_real)now.list[i].point[0], (rbd_real)now.list[i].point[1],
                                   (rbd_real)now.list[i].point[2]};
        rbd_real p[3];
        rbd_point_position(model, work, now.list[i].body1, point, p);
        lowest = fmin(lowest, (double)p[2] - now.list[i].radius);
    }
    const double drop = r->scene == HYQ_TROTS ? 0 : falls ? 0.3 : 0.02;
    r->q[2] = (rbd_real)((double)r->q[2] - lowest + drop);
    rbd_contact_reset(set);
}

/* PD, its damping implicit: kd + dt kp, which brakes, and is stable with ten milliseconds too. A trot of
   2 Hz. */
static void control(robot_run *r) {
    for (int k = 6; k < nv; k++) {
        double wanted = r->wanted[k];
        const int j = k - 6, leg = j % 4, pair = leg == 0 || leg == 3;
        const double side = leg < 2 ? 1 : -1,
                     phase = 4 * 3.14159265358979 * (double)r->t + (pair ? 0 : 3.14159265358979);
        if (r->scene == HYQ_TROTS && j >= 8) wanted -= 0.5 * side * fmax(sin(phase), 0);
        if (r->scene == HYQ_TROTS && j >= 4 && j < 8)
            wanted += 0.25 * side * fmax(sin(phase), 0) - 0.1 * cos(phase);
        r->tau[k] = (rbd_real)(r->kp * (wanted - (double)r->q[r->q_of[k]]));
        r->damping[k] = (rbd_real)(r->kd + (double)r->dt * r->kp);
    }
}

/* What a step must hold, and its figures. */
static void check_step(const robot_run *r, run_figures *f) {
    const rbd_contact_solution last = rbd_contact_last(set);
    const double residual = (double)last.residual;
    const rbd_real *p = set->rows->lambda, *delta = set->rows->R;
    const int rows = set->rows->rows;
    double energy = 0, size = 0, bound = 1e-8;
    int decade = 0;
    if (!finite(r->q, rbd_nq(model)) || !finite(r->v, nv) || !isfinite(residual))
        fail(failure_names[NOT_FINITE], 0);
    for (; decade + 1 < DECADES && !(residual <= bound); decade++) bound *= 10;
    f->steps++, f->histogram[decade]++;
    f->unsolved += residual > now.options.tolerance;
    f->iterations += last.sweeps + last.newton_steps;
    f->worst = larger(f->worst, residual);
    for (int i = 0; i < now.n; i++) {
        rbd_real gap, w[3];
        rbd_contact_get(set, i, &gap, w);
        const double most = now.list[i].friction * (double)w[2], t = hypot((double)w[0], (double)w[1]);
        f->deepest = larger(f->deepest, -(double)gap);
        if (t > 0 || w[2] < 0 || w[2] > 0) f->cone = larger(f->cone, w[2] > 0 ? t / most - 1 : 1);
    }
    for (int i = 0; i < rows; i++) { /* p'(u + u_free) / 2, all without bias */
        double u = -2 * (double)set->rows->b[i];
        for (int k = 0; k < rows; k++) u += (double)delta[i * rows + k] * (double)p[k];
        energy += (double)p[i] * u / 2, size += fabs((double)p[i]);
    }
    f->energy = larger(f->energy, energy);
    const double rounding = IN_FLOAT ? 1e-4 : 1e-12;
    if (!(f->cone <= 16 * unit_of_real)) fail("cone", f->cone);
    if (!(energy <= size * (2 * residual + rounding))) fail("energy made", energy);
}

static uint64_t hash_of(uint64_t h, const rbd_real *x, int n) {
    const unsigned char *bytes = (const unsigned char *)x;
    for (size_t i = 0; i < (size_t)n * sizeof *x; i++) h = (h ^ bytes[i]) * UINT64_C(0x100000001b3);
    return h;
}

/* So many steps, begun anew after each two seconds; returns a number that tells all states. */
static uint64_t run_robot(int scene_number, int size, long steps, run_figures *figures) {
    static robot_run r;
    static const rbd_body *const tables[2] = {hyq_bodies, atlas_bodies};
    const int atlas = is_atlas(scene_number);
    uint64_t hash = 1;
    memset(&now, 0, sizeof now);
    memset(&r, 0, sizeof r);
    now.robot.nb = atlas ? ATLAS_NB : HYQ_NB;
    memcpy(now.robot.bodies, tables[atlas], (size_t)now.robot.nb * sizeof(rbd_body));
    now.state.gravity[2] = -9.81;
    now.options.tolerance = IN_FLOAT ? 1e-5 : 1e-6;
    now.options.joint_limits = scene_number == HYQ_FALLS_LIMITS || scene_number == ATLAS_FALLS_LIMITS;
    if (atlas)
        list_atlas();
    else
        list_hyq(scene_number <= HYQ_FALLS_LIMITS);
    if (!build() || !build_set()) fail(failure_names[NOT_BUILT], 0);
    nv = rbd_nv(model);
    find_coordinates(&r);
    r.scene = scene_number, r.dt = (rbd_real)step_sizes[size],
    r.seed = (uint64_t)(scene_number * STEP_SIZES + size + 1);
    r.kp = atlas                        ? 100
           : scene_number >= HYQ_STANDS ? 300
                                        : 20,
    r.kd = atlas                        ? 5
           : scene_number >= HYQ_STANDS ? 8
                                        : 2;
    begin_run(&r);
    for (long n = 0; n < steps; n++) {
        number_now = (int)n;
        if (r.t > 2) begin_run(&r);
        control(&r);
        if (rbd_contact_step(model, set, r.q, r.v, r.tau, NULL, r.damping, r.dt, r.q, r.v) != RBD_OK) {
            fail(failure_names[STATUS], scene_number);
            begin_run(&r);
        }
        r.t += r.dt;
        if (figures) check_step(&r, figures);
        hash = hash_of(hash_of(hash, r.q, rbd_nq(model)), r.v, nv);
    }
    release();
    return hash;
}

static void run_robots(long steps) {
    kind_now = RUNS;
    for (int k = 0; k < SCENES; k++)
        for (int size = 0; size < STEP_SIZES; size++) {
            const long each = steps / (SCENES * STEP_SIZES) + 1;
            const uint64_t hash = run_robot(k, size, each, &runs[k][size]);
            if (run_robot(k, size, each, NULL) != hash) fail(failure_names[NOT_REPEATED], k);
            counts[RUNS][PROBLEMS] += each;
            counts[RUNS][UNSOLVED] += runs[k][size].unsolved;
            counts[RUNS][ITERATIONS] += runs[k][size].iterations;
            worst_unsolved[RUNS] = larger(worst_unsolved[RUNS], runs[k][size].worst);
        }
}

/* ---- long runs: no motor, no new beginning ---- */

enum { HYQ_IN_SPACE, ATLAS_LIES, LONG_SCENES };
static const char *const long_names[LONG_SCENES] = {"HyQ in space", "Atlas falls, limp"};

static double energy_of(const robot_run *r) {
    rbd_real kinetic = 0, potential = 0;
    rbd_kinematics(model, work, r->q, r->v, NULL);
    rbd_energy(model, work, &kinetic, &potential);
    return (double)kinetic + (double)potential;
}

/* HyQ turns with its legs swinging; Atlas falls onto the floor, as a run of it begins. */
static void begin_long(robot_run *r, int in_space) {
    static const double base[6] = {3, 2, -4, 1, 0.5, 2};
    begin_run(r);
    if (in_space) rbd_neutral(model, r->q);
    for (int k = 0; in_space && k < nv; k++) r->v[k] = (rbd_real)(k < 6 ? base[k] : k % 2 ? -10 : 10);
    for (int k = 7; in_space && k < rbd_nq(model); k++) r->q[k] = k % 3 == 2 ? (rbd_real)0.7 : (rbd_real)-0.4;
}

/* So many steps of a millisecond. In space energy may change by a thousandth in each 20 s; on the floor it is
   never more than at the beginning. */
static void run_long(int scene_number, long steps) {
    static robot_run r;
    const int in_space = scene_number == HYQ_IN_SPACE;
    memset(&now, 0, sizeof now);
    memset(&r, 0, sizeof r);
    now.robot.nb = in_space ? HYQ_NB : ATLAS_NB;
    memcpy(now.robot.bodies, in_space ? hyq_bodies : atlas_bodies, (size_t)now.robot.nb * sizeof(rbd_body));
    now.state.gravity[2] = in_space ? 0 : -9.81;
    now.options.tolerance = IN_FLOAT ? 1e-5 : 1e-6;
    now.options.joint_limits = !in_space;
    if (!in_space) list_atlas();
    if (!build() || !build_set()) fail(failure_names[NOT_BUILT], 0);
    nv = rbd_nv(model);
    find_coordinates(&r);
    r.scene = in_space ? HYQ_FALLS : ATLAS_FALLS, r.dt = (rbd_real)1e-3, r.seed = 1;
    begin_long(&r, in_space);

    const double start = energy_of(&r);
    double least = start, most = start, made = 0, before = start, residual = 0;
    for (long n = 0; n < steps; n++) {
        number_now = (int)n;
        if (rbd_contact_step(model, set, r.q, r.v, r.tau, NULL, NULL, r.dt, r.q, r.v) != RBD_OK) {
            fail(failure_names[STATUS], (double)n);
            break;
        }
        if (!finite(r.q, rbd_nq(model)) || !finite(r.v, nv)) fail(failure_names[NOT_FINITE], (double)n);
        const double energy = energy_of(&r);
        least = fmin(least, energy), most = larger(most, energy), made = larger(made, energy - before);
        residual = larger(residual, (double)rbd_contact_last(set).residual);
        before = energy;
    }
    printf("%-20s %ld steps: energy %.1f J at the start, %.6f to %.6f of it, at the end %.6f; most in a step "
           "%.1e J; "
           "residual %.1e m/s\n",
           long_names[scene_number], steps, start, least / start, most / start, before / start, made,
           residual);
    const double drift = 1e-3 * (1 + (double)steps / 20000), rounding = IN_FLOAT ? 1e-4 : 1e-6;
    if (!(most <= start * (1 + (in_space ? drift : rounding)))) fail("energy made", most / start);
    if (in_space && !(least >= start * (1 - drift))) fail("energy lost", least / start);
    if (!(made <= 1e-4 * start)) fail("energy made in a step", made / start);
    release();
}

/* ---- broken descriptions ---- */

/* A field that is broken: what it is called and how it is refused. */
typedef struct broken_field {
    const char *name;
    rbd_status status;
    double *at;
    double worst_allowed; /* larger values are refused */
    int negative;         /* whether negative ones are allowed */
} broken_field;

static void break_field(uint64_t *seed, const broken_field *f) {
    const int kind = below(seed, f->worst_allowed < 1e300 ? 5 : f->negative ? 3 : 4);
    *f->at = kind == 0   ? (double)NAN
             : kind == 1 ? HUGE_VAL
             : kind == 2 ? -HUGE_VAL
             : kind == 3 ? -power(seed, -300, 300)
                         : 1 + power(seed, -10, 300);
}

static void expect_refused(const rbd_contact_options *o, rbd_status status, const char *field, int body) {
    rbd_report report;
    const size_t size = 100000;
    memory[2] = memory_of(size);
    set = (rbd_contact_set *)memory[2];
    const rbd_status found = rbd_contact_set_init(model, work, now.list, now.n, now.held, now.n_held, o,
                                                  memory[2], size, &set, &report);
    char text[300];
    if (found != status || set || report.error.status != status || report.error.body != body ||
        !report.error.field || strcmp(report.error.field, field) ||
        !strstr(rbd_contact_finding_text(&report.error, now.n, text, sizeof text), field))
        fail(failure_names[WRONG_ANSWER], found);
    if (show)
        printf("%s of %d: %s\n", field, body,
               rbd_contact_finding_text(&report.error, now.n, text, sizeof text));
}

static void break_contact(uint64_t *seed, int i) {
    rbd_contact *a = &now.list[i];
    const broken_field fields[] = {
        {"point", RBD_ERR_POSITION, &a->point[below(seed, 3)], HUGE_VAL, 1},
        {"radius", RBD_ERR_RANGE, &a->radius, HUGE_VAL, 0},
        {"normal", RBD_ERR_AXIS, &a->normal[below(seed, 3)], HUGE_VAL, 1},
        {"height", RBD_ERR_POSITION, &a->height, HUGE_VAL, 1},
        {"friction", RBD_ERR_RANGE, &a->friction, HUGE_VAL, 0},
        {"restitution", RBD_ERR_RANGE, &a->restitution, 1, 0},
        {"stiffness", RBD_ERR_RANGE, &a->stiffness, HUGE_VAL, 0},
        {"damping", RBD_ERR_RANGE, &a->damping, HUGE_VAL, 0},
    };
    static const int wrong[4] = {-2, 1000000, -1000000, 12};
    const int which = below(seed, 12);
    const char *const names[4] = {"body1", "body2", "body2", "body2"};
    if (which < 8) {
        break_field(seed, &fields[which]);
        expect_refused(&now.options, fields[which].status, fields[which].name, i);
        return;
    }
    if (which == 8) a->body1 = wrong[below(seed, 4)];
    if (which == 9) a->body2 = wrong[below(seed, 4)];
    if (which == 10) a->body2 = a->body1, a->on_body = a->body2 >= 0;
    if (which == 11) a->body2 = 0, a->on_body = 0; /* left out */
    expect_refused(&now.options, RBD_ERR_INDEX, a->body1 == -1 && a->body2 < 0 ? "body1" : names[which - 8],
                   i);
}

static void break_options(uint64_t *seed) {
    rbd_contact_options o = now.options;
    const broken_field fields[] = {
        {"margin", RBD_ERR_RANGE, &o.margin, HUGE_VAL, 0},
        {"slop", RBD_ERR_RANGE, &o.slop, HUGE_VAL, 0},
        {"correction", RBD_ERR_RANGE, &o.correction, HUGE_VAL, 0},
        {"bounce", RBD_ERR_RANGE, &o.bounce, HUGE_VAL, 0},
        {"tolerance", RBD_ERR_RANGE, &o.tolerance, HUGE_VAL, 0},
    };
    const int which = below(seed, 6);
    if (which == 5)
        o.iterations = -1 - below(seed, 1000000);
    else
        break_field(seed, &fields[which]);
    expect_refused(&o, RBD_ERR_RANGE, which == 5 ? "iterations" : fields[which].name, -1);
}

/* Strange but finite numbers: the answer is finite, or an error says that something overflowed. */
static double strange(uint64_t *seed) {
    static const double some[8] = {0, 1, 1e-300, 1e300, 5e-324, 1e150, 1e-12, 1e12};
    return IN_FLOAT ? (double)(float)fmin(some[below(seed, 8)], 1e30) : some[below(seed, 8)];
}

static void try_strange(uint64_t *seed) {
    rbd_real q[WORLD_COORDINATES] = {0}, v[WORLD_DOFS], tau[WORLD_DOFS], out_q[WORLD_COORDINATES],
             out_v[WORLD_DOFS];
    rbd_contact_options o = now.options;
    for (int i = 0; i < now.n; i++) {
        rbd_contact *a = &now.list[i];
        double *const fields[8] = {&a->radius, &a->friction, &a->stiffness, &a->damping,
                                   &a->height, &a->point[0], &a->normal[0], &a->normal[2]};
        for (int k = 0; k < 8; k++)
            if (one_in(seed, 4)) *fields[k] = strange(seed);
        if (!((rbd_real)a->stiffness > 0)) a->damping = 0; /* refused without it */
    }
    if (one_in(seed, 3)) o.margin = strange(seed);
    if (one_in(seed, 3)) o.slop = strange(seed);
    if (one_in(seed, 3)) o.correction = fmin(strange(seed), 1);
    if (one_in(seed, 3)) o.bounce = strange(seed);
    if (one_in(seed, 3)) o.tolerance = strange(seed);
    if (one_in(seed, 3)) o.iterations = below(seed, 4);
    const size_t size = rbd_contact_set_size(model, now.n, NULL, 0, &o);
    memory[2] = memory_of(size);
    if (rbd_contact_set_init(model, work, now.list, now.n, NULL, 0, &o, memory[2], size, &set, NULL) !=
        RBD_OK) {
        fail(failure_names[STATUS], 0);
        return;
    }
    for (int k = 0; k < rbd_nq(model); k++) q[k] = (rbd_real)now.state.q[k];
    for (int k = 0; k < nv; k++) {
        v[k] = (rbd_real)now.state.v[k], tau[k] = (rbd_real)now.state.tau[k];
        if (one_in(seed, 40)) v[k] = (rbd_real)strange(seed);
        if (one_in(seed, 40)) tau[k] = (rbd_real)strange(seed);
    }
    const double dt = one_in(seed, 4) ? power(seed, -29, 20) : 1e-3;
    for (int k = 0; k < 3; k++) {
        const rbd_status status =
            rbd_contact_step(model, set, q, v, tau, NULL, NULL, (rbd_real)dt, out_q, out_v);
        if (status != RBD_OK && status != RBD_ERR_NAN && status != RBD_ERR_SINGULAR)
            fail(failure_names[STATUS], status);
        if (!finite(out_q, rbd_nq(model)) || !finite(out_v, nv)) {
            fail(failure_names[NOT_FINITE], status);
            break;
        }
        if (!isfinite((double)rbd_contact_last(set).residual)) fail(failure_names[NOT_FINITE], 0);
        for (int i = 0; i < now.n; i++) {
            rbd_real gap, f[3];
            rbd_contact_get(set, i, &gap, f);
            if (!finite(f, 3) || !finite(&gap, 1)) fail("force or gap not finite", (double)gap);
        }
        memcpy(q, out_q, sizeof q);
        memcpy(v, out_v, sizeof v);
    }
}

static void run_broken(int number) {
    uint64_t seed = (uint64_t)number + (UINT64_C(1) << 43);
    uniform(&seed, 0, 1);
    draw_scene(&now, number % 2 ? HELD : WORLD, number);
    kind_now = BROKEN, number_now = number;
    nv = now.robot.nv;
    if (nv == 0 || now.n == 0) return;
    counts[BROKEN][PROBLEMS]++;
    place_contacts();
    if (!build()) {
        fail(failure_names[NOT_BUILT], 0);
    } else if (one_in(&seed, 2)) {
        try_strange(&seed);
    } else if (now.n_held > 0 && one_in(&seed, 3)) {
        const int i = below(&seed, now.n_held);
        now.held[i].position2[below(&seed, 3)] = (double)NAN;
        expect_refused(&now.options, RBD_ERR_POSITION, "position2", now.n + i);
    } else if (one_in(&seed, 4)) {
        break_options(&seed);
    } else {
        break_contact(&seed, below(&seed, now.n));
    }
    release();
}

/* ---- tables ---- */

static void print_counts(void) {
    printf("%-24s", "");
    for (int k = 0; k < KINDS; k++) printf(" %12s", kinds[k]);
    for (int c = 0; c < COUNTS; c++) {
        printf("\n%-24s", count_names[c]);
        for (int k = 0; k < KINDS; k++) printf(" %12ld", counts[k][c]);
    }
    printf("\n%-24s", "their worst residual");
    for (int k = 0; k < KINDS; k++) printf(" %12.1e", worst_unsolved[k]);
    for (int q = 0; q < QUANTITIES; q++) {
        printf("\n%-24s", quantities[q].name);
        for (int k = 0; k < TREES_END; k++) printf(" %12.1e", worst_of[k][q].error);
    }
    printf("\n");
}

static void print_runs(void) {
    printf("\n%-24s %6s %8s %8s  %-62s %8s %8s %8s %8s\n", "", "dt", "steps", "above",
           "residuals <= 1e-8, 1e-7, .. 1e-2, above", "worst", "energy", "deepest", "per step");
    for (int k = 0; k < SCENES; k++)
        for (int size = 0; size < STEP_SIZES; size++) {
            const run_figures *f = &runs[k][size];
            if (f->steps == 0) continue;
            printf("%-24s %6g %8ld %8ld ", scene_names[k], step_sizes[size], f->steps, f->unsolved);
            for (int d = 0; d < DECADES; d++) printf(" %7ld", f->histogram[d]);
            printf(" %8.1e %8.1e %8.1e %8.2f\n", f->worst, f->energy, f->deepest,
                   (double)f->iterations / (double)f->steps);
        }
}

/* A figure to one digit, rounded up. */
static const char *rounded(double x) {
    static char text[16];
    int e = (int)floor(log10(x)), digit;
    if (!(x > 0)) return "0";
    digit = (int)ceil(x / pow(10, e) * (1 - 1e-9));
    if (digit == 10) digit = 1, e++;
    snprintf(text, sizeof text, "%de%d", digit, e);
    return text;
}

static FILE *open_table(const char *folder, const char *name) {
    char path[1000];
    FILE *file;
    snprintf(path, sizeof path, "%s/contact_%s%s.csv", folder, name, IN_FLOAT ? "_float" : "");
    file = fopen(path, "w");
    if (!file) perror(path), exit(2);
    return file;
}

/* Of all kinds, in float of the first; a kind whose problems have no such figure has an empty cell. */
static void publish_accuracy(const char *folder) {
    static const struct {
        const char *name;
        int quantity;
    } rows[6] = {{"cone", CONE},
                 {"Signorini, of those solved", SIGNORINI},
                 {"dissipation, of those solved", DISSIPATION},
                 {"energy made beyond the residual", ENERGY},
                 {"equation of motion", EQUATION},
                 {"two methods", METHODS}};
    const int end = IN_FLOAT ? WORLD : TREES_END;
    FILE *file = open_table(folder, "accuracy");
    for (int k = SINGLE; k < end; k++) fprintf(file, ",%s", kinds[k]);
    fprintf(file, "\nproblems");
    for (int k = SINGLE; k < end; k++) fprintf(file, ",%ld", counts[k][PROBLEMS] - counts[k][SINGULAR]);
    fprintf(file, "\nabove the tolerance");
    for (int k = SINGLE; k < end; k++) fprintf(file, ",%ld", counts[k][UNSOLVED]);
    fprintf(file, "\ntheir largest residual");
    for (int k = SINGLE; k < end; k++) fprintf(file, ",%s", rounded(worst_unsolved[k]));
    if (!IN_FLOAT) fprintf(file, "\nwhich the second method solves,");
    for (int k = WORLD; k < ANY && !IN_FLOAT; k++) fprintf(file, ",%ld", counts[k][OTHER_SOLVES]);
    if (!IN_FLOAT) fprintf(file, ",");
    for (int r = 0; r < (IN_FLOAT ? 3 : 6); r++) {
        fprintf(file, strchr(rows[r].name, ',') ? "\n\"%s\"" : "\n%s", rows[r].name);
        for (int k = SINGLE; k < end; k++) {
            const double scale = IN_FLOAT && rows[r].quantity == CONE ? 1e5 : 1; /* see judge */
            const char *figure = rounded(worst_of[k][rows[r].quantity].error * scale);
            fprintf(file, ",%s", k == SINGLE && r > 2 ? "" : figure);
        }
    }
    fprintf(file, "\n");
    fclose(file);
}

/* Of each scene, by step size. */
static void publish_runs(const char *folder) {
    FILE *file = open_table(folder, "runs");
    fprintf(file, ",\"above %s m/s, of %ld, at 0.5, 1, 2, 5, 10 ms\",above 1e-3 m/s\n",
            IN_FLOAT ? "1e-5" : "1e-6", runs[0][0].steps);
    for (int k = 0; k < SCENES; k++) {
        const run_figures *f = runs[k];
        fprintf(file, strchr(scene_names[k], ',') ? "\"%s\"" : "%s", scene_names[k]);
        for (int size = 0; size < STEP_SIZES; size++)
            fprintf(file, "%s%ld", size ? ", " : ",\"", f[size].unsolved);
        for (int size = 0; size < STEP_SIZES; size++)
            fprintf(file, "%s%ld", size ? ", " : "\",\"",
                    f[size].histogram[DECADES - 2] + f[size].histogram[DECADES - 1]);
        fprintf(file, "\"\n");
    }
    fclose(file);
}

static int kind_of(const char *name) {
    for (int k = 0; k < KINDS; k++)
        if (strcmp(kinds[k], name) == 0) return k;
    printf("no such kind: %s\n", name);
    exit(2);
}

/* The share of one kind in n problems, from number `from` on. */
static void run_kind(int kind, int from, int n) {
    const int tree = kind > SINGLE && kind < TREES_END,
              each = tree ? n / (10 * (TREES_END - 1)) + 1 : n / 10 + 1;
    shown = 5;
    if (kind == RUNS && from == 0) run_robots(n);
    for (int i = from; kind == SINGLE && i < from + n; i++) run_single(i);
    for (int i = from; kind == BROKEN && i < from + each; i++) run_broken(i);
    for (int i = from; tree && i < from + each; i++) run_tree(kind, i);
}

/* A run that compares nothing is no success; one of all kinds, and not too short, has every quantity. Two
   methods are compared in double alone. */
static void expect_compared(int is_long) {
    long problems = 0;
    for (int k = 0; k < KINDS; k++) problems += counts[k][PROBLEMS];
    if (problems == 0) fail("no problem is tried", 0);
    for (int q = 0; q < QUANTITIES && is_long; q++)
        if (compared[q] == 0 && !(IN_FLOAT && q == METHODS)) fail(quantities[q].name, -1);
}

int main(int argc, char **argv) {
    int problems = 100000, from = 0, only = -1;
    double seconds = 0;
    const char *publish = NULL;
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    for (int i = 1; i < argc; i++) {
        const int more = argc - 1 - i;
        if (more > 0 && strcmp(argv[i], "--seconds") == 0)
            seconds = atof(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--problems") == 0)
            problems = atoi(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--from") == 0)
            from = atoi(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--publish") == 0)
            publish = argv[++i];
        else if (more > 0 && strcmp(argv[i], "--kind") == 0)
            only = kind_of(argv[++i]);
        else if (more > 0 && strcmp(argv[i], "--long") == 0) {
            const long steps = atol(argv[++i]);
            if (steps < 1) fail("no step is tried", 0);
            kind_now = RUNS;
            for (int k = 0; k < LONG_SCENES; k++) run_long(k, steps);
            printf("%ld failures\n", failures);
            return failures > 0;
        } else if (more > 1 && strcmp(argv[i], "--one") == 0) {
            const int kind = kind_of(argv[i + 1]), number = atoi(argv[i + 2]);
            shown = 1000, show = 1;
            if (kind == SINGLE) run_single(number);
            if (kind == BROKEN) run_broken(number);
            if (kind > SINGLE && kind < TREES_END) run_tree(kind, number);
            expect_compared(0);
            return failures > 0;
        } else {
            printf("usage: see the head of contacts.c\n");
            return 2;
        }
    }
    const time_t start_time = time(NULL);
    const int part = seconds > 0 ? 10000 : problems;
    do {
        for (int k = 0; k < KINDS; k++)
            if (only < 0 || k == only) run_kind(k, from, part);
        from += part;
    } while (difftime(time(NULL), start_time) < seconds);
    print_counts();
    print_runs();
    if (publish) publish_accuracy(publish), publish_runs(publish);
    expect_compared(only < 0 && part >= 1000);
    printf("%ld failures\n", failures);
    return failures > 0;
}
