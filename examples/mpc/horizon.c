/* horizon.c - what a plan is worth on a robot that is not quite the model. A cart swings up a pole that is
   10 % heavier than it believes, and is pushed when the pole stands. Four controllers: the plan's forces
   alone; the plan with its gains; a plan made anew at each tick, 2 s ahead; the same 0.4 s ahead. Prints a
   table for horizon.gp, and to stderr what must be true. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "squares.h"

#include <stdio.h>
#include <stdlib.h>

enum { RAIL, HINGE, NB, NV = NB, NU = 1, NZ = 2 * NV + NU };
enum { TICKS = 300, STEPS = 20 }; /* ticks in all, and steps of the robot in each */
enum { LONG = 100, SHORT = 20 };  /* ticks that a plan made anew looks ahead */
enum { PUSHED = 200, PUSH = 5 };  /* the tick of the push, and ticks that it takes */
enum { FORCES, GAINS, ANEW, NEAR, CONTROLLERS };

static const double tick = 0.02, upright = 3.14159265358979324; /* s, rad */
static const double push = 17.5;                                /* N, on the cart, for 0.1 s */
static const double least = -10, most = 10;                     /* N, of the motor */

/* ---- the model, and the robot that it shall describe ---- */

/* A cart on a rail, and a pole that hangs from it at angle 0. */
#define CART \
    {.name = "cart", .joint = "rail", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1.2}
#define POLE(share) \
    {.name = "pole", \
     .joint = "hinge", \
     .parent = 0, \
     .type = RBD_CONTINUOUS, \
     .axis = {0, -1, 0}, \
     .mass = 0.5 * (share), \
     .com = {0, 0, -0.3}, \
     .inertia = {0.015 * (share), 0, 0, 0.015 * (share), 0, 0}}

static const rbd_body bodies[NB] = {CART, POLE(1)}, heavier[NB] = {CART, POLE(1.1)};
static const rbd_model *model, *robot;
static rbd_work *work, *robot_work;
static rbd_derivatives *derivatives_memory;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

static void build(void) {
    static unsigned char memory[2][RBD_MODEL_SIZE(NB)], works[2][RBD_WORK_SIZE(NB, NV)],
        of_derivatives[RBD_DERIVATIVES_SIZE(NB, NV)];
    check(rbd_model_build(bodies, NB, memory[0], sizeof memory[0], &model, NULL));
    check(rbd_model_build(heavier, NB, memory[1], sizeof memory[1], &robot, NULL));
    check(rbd_work_init(model, works[0], sizeof works[0], &work));
    check(rbd_work_init(robot, works[1], sizeof works[1], &robot_work));
    check(rbd_derivatives_init(model, work, of_derivatives, sizeof of_derivatives, &derivatives_memory));
}

/* ---- the problem of a plan ---- */

/* v_next = v + dt a: the motor drives the cart, not the hinge. */
static rbd_status step(void *user, int k, const double *q, const double *v, const double *u, double *v_next) {
    const ilqr_problem *p = user;
    const double tau[NV] = {u[0], 0};
    double a[NV];
    const rbd_status status = rbd_aba(model, work, q, v, tau, NULL, a);
    for (int i = 0; i < NV; i++) v_next[i] = v[i] + p->dt[k] * a[i];
    return status;
}

static rbd_status derivatives(void *user, const double *q, const double *v, const double *u, double *f_z) {
    const ilqr_problem *p = user;
    rbd_status status = RBD_OK;
    for (int k = 0; k < p->knots && status == RBD_OK; k++, q += NV, v += NV, f_z += NV * NZ) {
        const double tau[NV] = {u[k], 0};
        double by_q[NV * NV], by_v[NV * NV], Minv[NV * NV];
        status = rbd_fd_derivatives(model, derivatives_memory, q, v, tau, NULL, NULL, by_q, by_v, Minv);
        if (status == RBD_OK) ilqr_accelerations(p, 0, p->dt[k], by_q, by_v, Minv, f_z);
    }
    return status;
}

/* Upright, in the middle of the rail, at rest, with little force; most of all at the end. */
static rbd_status cost(void *user, int k, const double *q, const double *v, const double *u, double *l,
                       double *l_z, double *l_zz) {
    const ilqr_problem *p = user;
    const squares s = {l, l_z, l_zz, NZ};
    const double place = k < p->knots ? 0.1 : 500, motion = k < p->knots ? 0.01 : 50;
    *l = 0;
    squares_entry(&s, place, q[RAIL], RAIL);
    squares_entry(&s, place, q[HINGE] - upright, HINGE);
    for (int i = 0; i < NV; i++) squares_entry(&s, motion, v[i], NV + i);
    if (u) squares_entry(&s, 1e-3, u[0], 2 * NV);
    return RBD_OK;
}

static ilqr_problem problem = {.nu = NU,
                               .lower = &least,
                               .upper = &most,
                               .user = &problem,
                               .step = step,
                               .derivatives = derivatives,
                               .cost = cost};

/* A plan from rest, hanging, for so many ticks; iterated until nothing is to be gained. */
static void make_plan(ilqr *s, int knots) {
    static double reals[ILQR_REALS(NV, NV, NU, TICKS)], dt[TICKS];
    const double hanging[NV] = {0}, still[NV] = {0};
    int better = 1;
    for (int k = 0; k < knots; k++) dt[k] = tick;
    problem.m = model;
    problem.knots = knots;
    problem.dt = dt;
    check(ilqr_init(s, &problem, reals, sizeof reals / sizeof *reals));
    check(ilqr_start(s, hanging, still));
    for (int i = 0; i < 200 && better; i++) check(ilqr_iterate(s, &better));
}

/* ---- the controllers ---- */

/* What the plan says at this tick; with its gains, and how far the robot is from where it should be. */
static double planned(const ilqr *s, int k, const double *q, const double *v, int with_gains) {
    const double *K = s->K + k * 2 * NV;
    double u = s->u[k];
    for (int i = 0; i < NV && with_gains; i++) {
        u += K[i] * (q[i] - s->q[k * NV + i]);
        u += K[NV + i] * (v[i] - s->v[k * NV + i]);
    }
    return ilqr_clamp(u, least, most);
}

/* The plan moves on by a tick, starts where the robot is, and gets one iteration. */
static double anew(ilqr *s, const double *q, const double *v) {
    int better;
    check(ilqr_start(s, q, v));
    check(ilqr_iterate(s, &better));
    const double u = s->u[0];
    check(ilqr_shift(s, 1));
    return u;
}

/* A tick of the robot: twenty steps of a millisecond, with this force of the motor. */
static void move(double force, double *q, double *v) {
    for (int i = 0; i < STEPS; i++) {
        const double tau[NV] = {force, 0};
        double a[NV];
        check(rbd_aba(robot, robot_work, q, v, tau, NULL, a));
        check(rbd_step(robot, q, v, a, tick / (double)STEPS, q, v));
    }
}

/* What a controller did: angle and force at each tick, and how far from upright the pole was: at the push, at
   the end, and when it was nearest. */
typedef struct run {
    double angle[TICKS], force[TICKS], before_push, end, nearest;
} run;

static void drive(int controller, run *r) {
    static const int knots[CONTROLLERS] = {TICKS, TICKS, LONG, SHORT};
    double q[NV] = {0}, v[NV] = {0};
    ilqr s;
    make_plan(&s, knots[controller]);
    for (int k = 0; k < TICKS; k++) {
        const double u = controller < ANEW ? planned(&s, k, q, v, controller == GAINS) : anew(&s, q, v);
        r->angle[k] = q[HINGE];
        r->force[k] = u;
        if (k == PUSHED) r->before_push = fabs(q[HINGE] - upright);
        if (k == 0 || fabs(q[HINGE] - upright) < r->nearest) r->nearest = fabs(q[HINGE] - upright);
        move(u + (k >= PUSHED && k < PUSHED + PUSH ? push : 0), q, v);
    }
    r->end = fabs(q[HINGE] - upright);
}

/* Prints what should be so, and whether it is. */
static int fact(const char *what, int is) {
    fprintf(stderr, "%s: %s\n", what, is ? "yes" : "no");
    return is;
}

/* Does the pole stand, or is it far from standing? */
static int stands(double away) { return away < 0.2; }
static int lies(double away) { return away > 1; }

static void print_table(const run *runs) {
    puts("t s,angle rad: forces alone,with gains,anew 2 s ahead,anew 0.4 s ahead,force N: with gains,anew");
    for (int k = 0; k < TICKS; k++) {
        printf("%.2f", k * tick);
        for (int i = 0; i < CONTROLLERS; i++) printf(",%.3f", runs[i].angle[k]);
        printf(",%.2f,%.2f\n", runs[GAINS].force[k], runs[ANEW].force[k]);
    }
}

int main(void) {
    static run runs[CONTROLLERS];
    build();
    for (int i = 0; i < CONTROLLERS; i++) drive(i, &runs[i]);
    print_table(runs);

    int good = fact("the plan's forces alone miss the top", lies(runs[FORCES].before_push));
    good = fact("with its gains the pole stands", stands(runs[GAINS].before_push)) && good;
    good = fact("and falls after the push", lies(runs[GAINS].end)) && good;
    good = fact("planned anew, 2 s ahead, it stands", stands(runs[ANEW].before_push)) && good;
    good = fact("and after the push", stands(runs[ANEW].end)) && good;
    good = fact("planned anew, 0.4 s ahead, it never gets up",
                lies(runs[NEAR].nearest) && lies(runs[NEAR].end)) &&
           good;
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
