/* hyq_jump.c - HyQ jumps: it stands on four feet, pushes off, flies, and lands. When the feet stand is the
   program's to say; how it jumps, iterative LQR finds out: torques within the motors' limits, forces that
   push and stay within the friction cone. Then a robot that is heavier than the model, and is pushed in the
   air, jumps so: a hundred times a second the plan of the next second starts from the measured state and
   gets one iteration. Prints tables for hyq_jump.gp; with --times what a tick takes, in parts.
   SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include <stdio.h>
#include <stdlib.h>

#include "check.h"
#include "hyq_robot.h"
#include "squares.h"
#include "times.h"
#include "../larger.h"

enum { TAKEOFF = 30, TOUCHDOWN = TAKEOFF + 36, N = TOUCHDOWN + 34 }; /* knots where these phases begin */
enum { TICKS = 150, STEPS = 10 };                                    /* of control; of the robot in each */

static const double forward = 0.5, rise = 0.2, clearance = 0.08; /* m */
static const double limit = 150, friction = 0.6;                 /* N m */
static const double payload = 5, shove = 200;                    /* kg; N to the left, for 0.1 s */

static int begun;                 /* knot of the jump at which the horizon begins */
static double goal[NQ], hold[NU]; /* standing where it shall land */

/* ---- what it shall do ---- */

/* In flight the feet swing up and down again; where they land they are put on their places. k here and in
   way: of the jump. */
static rbd_status swing(const squares *s, int k, const double *q) {
    const double x = (double)(k - TAKEOFF) / (TOUCHDOWN - TAKEOFF), height = 4 * clearance * x * (1 - x);
    double J[ROWS * NV], e[ROWS];
    const rbd_status status = rbd_constraint_jacobian(&hyq_model, feet, q, NULL, s->l_z ? J : NULL, NULL, e);
    for (int i = 0; i < ROWS; i++) {
        const int up = i % 3 == 2;
        if (k == TOUCHDOWN) squares_add(s, 1e5, e[i], J + i * NV, 0, NV);
        if (k < TOUCHDOWN && up) squares_add(s, 1e3, e[i] - height, J + i * NV, 0, NV);
    }
    return status;
}

static int unbounded; /* what push costs holds everywhere: differences must not meet its kinks */

/* Feet shall push with 30 N at least, and no steeper than the friction allows, with some reserve. */
static void push(const squares *s, int k) {
    const double *f = s->l_z ? force[k] : tried[k];
    const double weight = 1e-2, least = 30, steepest = 0.9 * friction;
    for (int i = 2; i < ROWS; i += 3) {
        const double *up = force_z[k][i];
        if (unbounded || f[i] < least) squares_add(s, weight, f[i] - least, up, 0, NZ);
        for (int side = 1; side <= 2; side++) {
            const double along = f[i - side], sign = along < 0 && !unbounded ? -1 : 1;
            const double slip = sign * along - steepest * f[i];
            double by_z[NZ];
            if (slip <= 0 && !unbounded) continue;
            for (int j = 0; j < NZ; j++) by_z[j] = sign * force_z[k][i - side][j] - steepest * up[j];
            squares_add(s, weight, slip, by_z, 0, NZ);
        }
    }
}

/* The way of the base: up and forward while it flies. */
static void way(int k, double *to) {
    const double x = fmin(fmax((double)(k - TAKEOFF) / (TOUCHDOWN - TAKEOFF), 0), 1);
    memcpy(to, goal, sizeof goal);
    to[HYQ_Q_ROOT_X] -= forward * (1 - x);
    to[HYQ_Q_ROOT_Z] += 4 * rise * x * (1 - x);
}

static rbd_status cost(void *user, int k, const double *q, const double *v, const double *u, double *l,
                       double *l_z, double *l_zz) {
    const squares s = {l, l_z, l_zz, NZ};
    const double pose = k < N ? 10 : 1000, base = k < N ? 100 : 1000, motion = k < N ? 0.1 : 100;
    double to[NQ], weight[NV], difference[NV], D[NV * NV];
    rbd_status status;
    (void)user;
    *l = 0;
    way(begun + k, to);
    for (int i = 0; i < NV; i++) {
        weight[i] = i < 6 ? base : pose;
        squares_entry(&s, motion, v[i], NV + i);
    }
    status = squares_way(&s, &hyq_model, weight, to, q, difference, D);
    if (begun + k > TAKEOFF && begun + k <= TOUCHDOWN && status == RBD_OK) status = swing(&s, begun + k, q);
    if (!u) return status;
    for (int i = 0; i < NU; i++)
        squares_entry(&s, 1e-4, u[i] - (phases[k] == STAND ? hold[i] : 0), 2 * NV + i);
    if (phases[k] != FLY) push(&s, k);
    return status;
}

/* ---- the jump ---- */

static ilqr s;
static ilqr_problem p;

/* The first guess: it stands as if the ground went on beneath it, and joints are held by springs; without
   these it would fall over in the first trial. */
static void plan(void) {
    static double memory[ILQR_REALS(NQ, NV, NU, N)], dt[SCHEDULE], lower[NU], upper[NU];
    const double v[NV] = {0}, stiffness = 300, damping = 15; /* N m/rad, N m s/rad */
    double q[NQ];
    p = (ilqr_problem){&hyq_model, N, NU, 6, dt, lower, upper, &p, step, derivatives, cost};
    for (int i = 0; i < NU; i++) lower[i] = -limit, upper[i] = limit;
    check(ilqr_init(&s, &p, memory, sizeof memory / sizeof *memory));
    for (int k = 0; k < SCHEDULE; k++) {
        schedule[k] = k == TOUCHDOWN ? IMPACT : k < TAKEOFF || k > TOUCHDOWN ? STAND : FLY;
        dt[k] = schedule[k] == IMPACT ? 0 : tick;
    }
    for (int k = 0; k < N; k++) {
        memcpy(s.q + k * NQ, goal, sizeof goal);
        for (int i = 0; i < NU; i++) {
            double *K = s.K + (k * NU + i) * 2 * NV;
            K[6 + i] = -stiffness, K[NV + 6 + i] = -damping;
            s.u[k * NU + i] = phases[k] == STAND ? hold[i] : 0;
        }
    }
    memcpy(q, goal, sizeof q);
    q[HYQ_Q_ROOT_X] -= forward;
    check(ilqr_start(&s, q, v));
}

/* Iterations until nothing is to be gained. Returns whether the cost fell in each, of fewer than 300. The
   first rollouts are far off: how many follow hangs on roundings, 40 to 130, but not where it ends. */
static int converge(void) {
    int better = 1, falling = 1, iterations = 0;
    s.tolerance = 1e-4;
    while (better && iterations < 300) {
        const double before = s.cost;
        check(ilqr_iterate(&s, &better));
        falling = falling && (better ? s.cost < before : s.cost == before);
        iterations += better;
    }
    check(ilqr_linearise(&s));
    return falling && !better;
}

/* ---- the control loop ---- */

static struct { /* what happened at the ticks: the robot, the first plan's trunk, and the torques */
    double q[NQ], force[ROWS], planned_height, u[NU];
} past[TICKS];

/* The horizon begins a tick later: the impact, which takes no time, is left behind with the knot after it. */
static void move_on(void) {
    double moved;
    do {
        moved = *p.dt++;
        phases++, begun++;
        check(ilqr_shift(&s, 1));
    } while (!(moved > 0));
}

/* Plans anew from the measured state, with the trajectory that there is as a first guess. Returns the torques
   until the next tick; *falling: no iteration made the cost rise. */
static const double *control(const double *q, const double *v, int *falling) {
    int better;
    check(ilqr_start(&s, q, v));
    const double before = s.cost;
    check(ilqr_iterate(&s, &better));
    *falling = *falling && s.cost <= before;
    return phases[0] == IMPACT ? s.u + NU : s.u;
}

/* The robot jumps as planned tick by tick. */
static int jump(robot *r) {
    int falling = 1;
    s.tries = 1, s.rollouts = 2, s.tolerance = 1e-9;
    for (int i = 0; i < TICKS; i++) {
        double push[6 * HYQ_NB] = {0};
        if (i > 0) move_on();
        const double *u = control(r->q, r->v, &falling);
        if (i >= 40 && i < 50) push[6 * HYQ_BODY_BASE_LINK_0 + 4] = shove;
        memcpy(past[i].q, r->q, sizeof r->q);
        memcpy(past[i].u, u, sizeof past[i].u);
        for (int j = 0; j < STEPS; j++) robot_step(r, u, push);
        memcpy(past[i].force, r->force, sizeof r->force);
    }
    return falling;
}

/* Side view at tick i, moved to the right: the legs from hip to toe, and the trunk. */
static void figure(int i, double right) {
    static const int body[3] = {HYQ_BODY_LF_UPPERLEG, HYQ_BODY_LF_LOWERLEG, HYQ_BODY_LF_LOWERLEG};
    static const double corner[5][3] = {
        {0.5, 0, -0.07}, {0.5, 0, 0.1}, {-0.5, 0, 0.1}, {-0.5, 0, -0.07}, {0.5, 0, -0.07}};
    double at[3];
    check(rbd_kinematics(&hyq_model, w, past[i].q, NULL, NULL));
    for (int foot = FEET; foot >= 0; foot--) {
        for (int j = 0; j < (foot < FEET ? 3 : 5); j++) {
            const int link = foot < FEET ? body[j] + foot : HYQ_BODY_BASE_LINK_0;
            const double *point = foot == FEET ? corner[j] : j == 2 ? toe : NULL;
            check(rbd_point_position(&hyq_model, w, link, point, at));
            printf("%.3f,%.3f,%d\n", at[0] - past[0].q[0] + right, at[2], foot < FEET ? 1 + foot % 2 : 0);
        }
        puts("");
    }
}

/* Two tables: what happens by time, and figures. */
static void print_tables(void) {
    static const int shown[] = {0, 24, TAKEOFF, TAKEOFF + 18, TOUCHDOWN, TOUCHDOWN + 9, TICKS - 1};
    puts(
        "t s,trunk's height m,as planned at first m,trunk to the left m,left fore N,right fore N,left hind N,"
        "right hind N,torques over their limits");
    for (int i = 0; i < TICKS; i++) {
        printf("%.2f,%.4f,%.4f,%.4f", i * tick, past[i].q[HYQ_Q_ROOT_Z], past[i].planned_height,
               past[i].q[HYQ_Q_ROOT_Y]);
        for (int j = 2; j < ROWS; j += 3) printf(",%.1f", past[i].force[j]);
        for (int j = 0; j < NU; j++) printf(",%.3f", past[i].u[j] / limit);
        puts("");
    }
    puts("\n");
    for (int i = 0; i < 7; i++) figure(shown[i], 1.42 * i);
}

/* ---- what must be true of it ---- */

/* How far any foot moves while it stands. */
static double slip(int first, int last) {
    double from[ROWS], to[ROWS], worst = 0;
    check(rbd_constraint_jacobian(&hyq_model, feet, s.q + first * NQ, NULL, NULL, NULL, from));
    for (int k = first; k <= last; k++) {
        check(rbd_constraint_jacobian(&hyq_model, feet, s.q + k * NQ, NULL, NULL, NULL, to));
        for (int i = 0; i < ROWS; i++) worst = larger(worst, fabs(to[i] - from[i]));
    }
    return worst;
}

/* The least that a foot pushes with, and the steepest. */
static void judge_forces(double *least, double *steepest) {
    *least = 1e9, *steepest = 0;
    for (int k = 0; k < N; k++)
        for (int i = 2; i < ROWS && phases[k] != FLY; i += 3) {
            *least = fmin(*least, force[k][i]);
            for (int j = i - 2; j < i; j++) *steepest = larger(*steepest, fabs(force[k][j]) / force[k][i]);
        }
}

/* Is the first plan a jump? */
static int judge_plan(void) {
    double off[ROWS], miss = 0, largest = 0, least, steepest;
    const double moved = larger(slip(0, TAKEOFF), slip(TOUCHDOWN, N));
    judge_forces(&least, &steepest);
    for (int i = 0; i < N * NU; i++) largest = larger(largest, fabs(s.u[i]));
    check(rbd_constraint_jacobian(&hyq_model, feet, s.q + TOUCHDOWN * NQ, NULL, NULL, NULL, off));
    for (int i = 0; i < ROWS; i++) miss = larger(miss, fabs(off[i]));
    fprintf(stderr, "feet land within %.0f mm of their places, move by less than %.0f mm while they stand\n",
            miss * 1e3, moved * 1e3);
    fprintf(stderr, "they push with %.0f N at least, never steeper than %.2f; torques up to %.0f N m\n",
            least, steepest, largest);
    return miss < 5e-3 && moved < 3e-3 && least > 0 && steepest < friction && largest <= limit;
}

/* Did the robot land where it should, and does it stand? */
static int judge_jump(const robot *r, int falling) {
    double off[ROWS], miss = 0, away = 0, motion = 0, largest = 0;
    check(rbd_constraint_jacobian(&hyq_model, feet, r->q, NULL, NULL, NULL, off));
    for (int i = 0; i < ROWS; i++) miss = larger(miss, fabs(off[i]));
    for (int i = 0; i < 3; i++) away = larger(away, fabs(r->q[i] - goal[i]));
    for (int i = 0; i < NV; i++) motion = larger(motion, fabs(r->v[i]));
    for (int i = 0; i < TICKS * NU; i++) largest = larger(largest, fabs(past[i / NU].u[i % NU]));
    const int lands = miss < 0.02 && away < 0.02 && motion < 0.02 && r->standing == 15;
    const int holds = largest <= limit && r->steepest < ground_friction;
    fprintf(stderr,
            "%g kg heavier, pushed in the air with %g N, and planned anew a hundred times a second:\n",
            payload, shove);
    fprintf(stderr,
            "stands within 20 mm of the goal at the end, feet too: %s; no tick made the cost rise: %s\n",
            lands ? "yes" : "no", falling ? "yes" : "no");
    fprintf(stderr, "torques within their limits, forces within the cone of the ground's %g: %s\n",
            ground_friction, holds ? "yes" : "no");
    return lands && holds && falling;
}

int main(int count, char **arguments) {
    static double scratch[2 * (NQ + 2 * NV + NU)];
    static robot r;
    const int timed = count > 1 && strcmp(arguments[1], "--times") == 0;
    prepare_feet();
    stand(goal, hold);
    plan();
    unbounded = 1;
    const double error = ilqr_derivative_error(&s, scratch);
    const int meets_limits = ilqr_meets_limits(&s, 1000, scratch, scratch + NU);
    unbounded = 0;
    int good = converge();
    fprintf(stderr, "the cost fell in each iteration, fewer than 300, to %.0f: %s\n", s.cost,
            good ? "yes" : "no");
    good = judge_plan() && good;
    for (int i = 0; i < TICKS; i++)
        past[i].planned_height = s.q[(i < TOUCHDOWN ? i : i < N ? i + 1 : N) * NQ + HYQ_Q_ROOT_Z];
    if (timed) ilqr_print_times(&s, "before the jump");
    robot_start(&r, s.q, payload);
    good = judge_jump(&r, jump(&r)) && good;
    if (timed)
        ilqr_print_times(&s, "after it, standing in all knots");
    else
        print_tables();
    fprintf(stderr, "derivatives agree with differences to 1e-6: %s; ", error < 1e-6 ? "yes" : "no");
    fprintf(stderr, "limits are met to the bit: %s\n", meets_limits ? "yes" : "no");
    return good && error < 1e-6 && meets_limits ? EXIT_SUCCESS : EXIT_FAILURE;
}
