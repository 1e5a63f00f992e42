/* hyq_jump.c - HyQ jumps: it stands on four feet, pushes off, flies, and lands. When the feet stand is the
   program's to say; how it jumps, iterative LQR finds out: torques within the motors' limits, forces that
   push and stay within the friction cone. Prints tables for hyq_jump.gp; with --times what an iteration
   takes, in parts. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "check.h"
#include "hyq_feet.h"
#include "squares.h"

enum { TAKEOFF = 30, TOUCHDOWN = TAKEOFF + 36, N = TOUCHDOWN + 34 }; /* knots where these phases begin */

static const double forward = 0.5, rise = 0.2, clearance = 0.08; /* m */
static const double limit = 150, friction = 0.6;                 /* N m */

static double goal[NQ], hold[NU]; /* standing where it shall land */

/* ---- what it shall do ---- */

/* In flight the feet swing up and down again; where they land they are put on their places. */
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
    way(k, to);
    for (int i = 0; i < NV; i++) {
        weight[i] = i < 6 ? base : pose;
        squares_entry(&s, motion, v[i], NV + i);
    }
    status = squares_way(&s, &hyq_model, weight, to, q, difference, D);
    if (k > TAKEOFF && k <= TOUCHDOWN && status == RBD_OK) status = swing(&s, k, q);
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
    static double memory[ILQR_REALS(NQ, NV, NU, N)], dt[N], lower[NU], upper[NU];
    const double v[NV] = {0}, stiffness = 300, damping = 15; /* N m/rad, N m s/rad */
    double q[NQ];
    p = (ilqr_problem){&hyq_model, N, NU, 6, dt, lower, upper, &p, step, derivatives, cost};
    for (int i = 0; i < NU; i++) lower[i] = -limit, upper[i] = limit;
    check(ilqr_init(&s, &p, memory, sizeof memory / sizeof *memory));
    for (int k = 0; k < N; k++) {
        phases[k] = k == TOUCHDOWN ? IMPACT : k < TAKEOFF || k > TOUCHDOWN ? STAND : FLY;
        dt[k] = phases[k] == IMPACT ? 0 : tick;
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

/* Side view of knot k, moved to the right: the legs from hip to toe, and the trunk. */
static void figure(int k, double right) {
    static const int body[3] = {HYQ_BODY_LF_UPPERLEG, HYQ_BODY_LF_LOWERLEG, HYQ_BODY_LF_LOWERLEG};
    static const double corner[5][3] = {
        {0.5, 0, -0.07}, {0.5, 0, 0.1}, {-0.5, 0, 0.1}, {-0.5, 0, -0.07}, {0.5, 0, -0.07}};
    double at[3];
    check(rbd_kinematics(&hyq_model, w, s.q + k * NQ, NULL, NULL));
    for (int i = FEET; i >= 0; i--) {
        for (int j = 0; j < (i < FEET ? 3 : 5); j++) {
            const int link = i < FEET ? body[j] + i : HYQ_BODY_BASE_LINK_0;
            check(rbd_point_position(&hyq_model, w, link, i == FEET ? corner[j] : j == 2 ? toe : NULL, at));
            printf("%.3f,%.3f,%d\n", at[0] - s.q[0] + right, at[2], i < FEET ? 1 + i % 2 : 0);
        }
        puts("");
    }
}

/* Two tables: what happens by time, and figures. */
static void print_tables(void) {
    static const int shown[] = {0, 24, TAKEOFF, TAKEOFF + 18, TOUCHDOWN, TOUCHDOWN + 9, N};
    double t = 0;
    puts("t s,trunk's height m,left fore N,right fore N,left hind N,right hind N,torques over their limits");
    for (int k = 0; k < N; t += p.dt[k++]) {
        if (phases[k] == IMPACT) continue;
        printf("%.2f,%.4f", t, s.q[k * NQ + HYQ_Q_ROOT_Z]);
        for (int i = 2; i < ROWS; i += 3) printf(",%.1f", phases[k] == STAND ? force[k][i] : 0);
        for (int i = 0; i < NU; i++) printf(",%.3f", s.u[k * NU + i] / limit);
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
        for (int i = 0; i < ROWS; i++) worst = fmax(worst, fabs(to[i] - from[i]));
    }
    return worst;
}

/* The least that a foot pushes with, and the steepest. */
static void judge_forces(double *least, double *steepest) {
    *least = 1e9, *steepest = 0;
    for (int k = 0; k < N; k++)
        for (int i = 2; i < ROWS && phases[k] != FLY; i += 3) {
            *least = fmin(*least, force[k][i]);
            for (int j = i - 2; j < i; j++) *steepest = fmax(*steepest, fabs(force[k][j]) / force[k][i]);
        }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* An iteration, part by part, at the trajectory that was found. */
static void print_times(void) {
    double least[4] = {1e9, 1e9, 1e9, 1e9};
    for (int i = 0; i < 100; i++) {
        double t[5], value;
        t[0] = now();
        check(ilqr_linearise(&s)), t[1] = now();
        check(ilqr_backward(&s)), t[2] = now();
        check(ilqr_rollout(&s, 0, &value)), t[3] = now();
        for (int j = 0; j < 3; j++) least[j] = fmin(least[j], t[j + 1] - t[j]);
        for (int k = 0; k <= N; k++) {
            static double l, l_z[NZ], l_zz[NZ * NZ];
            check(cost(&p, k, s.q + k * NQ, s.v + k * NV, k < N ? s.u + k * NU : NULL, &l, l_z, l_zz));
        }
        least[3] = fmin(least[3], now() - t[3]);
    }
    printf("milliseconds, the least of 100; %d knots, %d joints and a base\n", N, NU);
    printf("%6.2f  an iteration\n", least[0] + least[1] + least[2]);
    printf("%6.2f    derivatives of the dynamics and the forces\n", least[0]);
    printf("%6.2f    backward pass, of which the cost's derivatives are %.2f\n", least[1], least[3]);
    printf("%6.2f    line search: dynamics and cost\n", least[2]);
}

int main(int count, char **arguments) {
    static double scratch[2 * (NQ + 2 * NV + NU)];
    int iterations = 0, better = 1, falling = 1;
    double largest = 0, least, steepest;
    prepare_feet();
    stand(goal, hold);
    plan();
    unbounded = 1;
    const double error = ilqr_derivative_error(&s, scratch);
    unbounded = 0;
    s.tolerance = 1e-4;
    while (better && iterations < 60) {
        const double before = s.cost;
        check(ilqr_iterate(&s, &better));
        falling = falling && (better ? s.cost < before : s.cost == before);
        iterations += better;
    }
    check(ilqr_linearise(&s));
    judge_forces(&least, &steepest);
    if (count > 1 && strcmp(arguments[1], "--times") == 0)
        print_times();
    else
        print_tables();
    for (int i = 0; i < N * NU; i++) largest = fmax(largest, fabs(s.u[i]));
    const double moved = fmax(slip(0, TAKEOFF), slip(TOUCHDOWN, N));
    double off[ROWS], miss = 0;
    check(rbd_constraint_jacobian(&hyq_model, feet, s.q + TOUCHDOWN * NQ, NULL, NULL, NULL, off));
    for (int i = 0; i < ROWS; i++) miss = fmax(miss, fabs(off[i]));
    fprintf(stderr, "the cost fell in each iteration, fewer than 60, to %.0f: %s\n", s.cost,
            falling && !better ? "yes" : "no");
    fprintf(stderr, "feet land within %.0f mm of their places, move by less than %.0f mm while they stand\n",
            miss * 1e3, moved * 1e3);
    fprintf(stderr, "they push with %.0f N at least, never steeper than %.2f; torques up to %.0f N m\n",
            least, steepest, largest);
    fprintf(stderr, "derivatives agree with differences to 1e-6: %s\n", error < 1e-6 ? "yes" : "no");
    return falling && !better && miss < 5e-3 && moved < 3e-3 && least > 0 && steepest < friction &&
                   largest <= limit && error < 1e-6
               ? EXIT_SUCCESS
               : EXIT_FAILURE;
}
