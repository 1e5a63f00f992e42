/* iiwa.c - model predictive control of an arm, a thousand times a second: the hand of an iiwa catches up
   with a target that goes round in a circle, and follows it. Each millisecond the plan of half a second,
   50 knots, moves on, starts from the measured state, and gets one iteration; its first torque is held
   for the millisecond. Prints a table for iiwa.gp; with --times what an iteration takes, in parts, and
   derivatives by single calls, one batch call and threads. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200112L /* clock_gettime, pthread_barrier */
#define RBD_IMPLEMENTATION
#include "check.h"

#include "reach.h"
#include "rbd_batch.h"
#include "../larger.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { NV = REACH_NV, N = REACH_N, THREADS = 2, TICKS = 3000, TICKS_PER_ROW = 5 };

static const double tick = 1e-3; /* s */

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* ---- derivatives of all knots: by single calls, one batch call, or two threads of either ---- */

typedef struct worker { /* memory of a thread, and the knots that are its */
    unsigned char work_memory[IIWA_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(IIWA_NB, NV)];
    rbd_work *w;
    rbd_derivatives *d;
    rbd_batch *b;
    rbd_batch_derivatives *bd;
    int first, end;
    rbd_status status;
} worker;

static worker workers[THREADS], whole = {.end = N};
static double da_dq[N][NV * NV], da_dv[N][NV * NV], Minv[N][NV * NV];

static struct { /* what the threads are to do, from one barrier to the next */
    pthread_barrier_t start, done;
    int batch, quit;
    const double *q, *v, *u;
} job;

static void ready(worker *k) {
    const rbd_model *m = &iiwa_model;
    check(rbd_work_init(m, k->work_memory, sizeof k->work_memory, &k->w));
    check(rbd_derivatives_init(m, k->w, k->memory, sizeof k->memory, &k->d));
    const size_t size = rbd_batch_size(m), more = rbd_batch_derivatives_size(m);
    check(rbd_batch_init(m, malloc(size), size, &k->b));
    check(rbd_batch_derivatives_init(m, k->b, malloc(more), more, &k->bd));
}

static void differentiate(worker *w, int batch, const double *q, const double *v, const double *u) {
    const int first = w->first;
    w->status = RBD_OK;
    if (batch) {
        w->status =
            rbd_batch_fd_derivatives(&iiwa_model, w->bd, w->end - first, q + first * NV, v + first * NV,
                                     u + first * NV, NULL, NULL, da_dq[first], da_dv[first], Minv[first]);
        return;
    }
    for (int k = first; k < w->end && w->status == RBD_OK; k++)
        w->status = rbd_fd_derivatives(&iiwa_model, w->d, q + k * NV, v + k * NV, u + k * NV, NULL, NULL,
                                       da_dq[k], da_dv[k], Minv[k]);
}

static void *run(void *argument) {
    for (;;) {
        pthread_barrier_wait(&job.start);
        if (job.quit) return NULL;
        differentiate(argument, job.batch, job.q, job.v, job.u);
        pthread_barrier_wait(&job.done);
    }
}

/* The last thread is this one. */
static void differentiate_by_threads(int batch, const double *q, const double *v, const double *u) {
    job.batch = batch, job.q = q, job.v = v, job.u = u;
    pthread_barrier_wait(&job.start);
    differentiate(&workers[THREADS - 1], batch, q, v, u);
    pthread_barrier_wait(&job.done);
    for (int i = 0; i < THREADS; i++) check(workers[i].status);
}

static rbd_status by_batch(void *user, const double *q, const double *v, const double *u, double *f_z) {
    const reach *r = user;
    differentiate(&whole, 1, q, v, u);
    for (int k = 0; k < N; k++)
        ilqr_accelerations(r->p, 0, r->dt, da_dq[k], da_dv[k], Minv[k], f_z + k * NV * REACH_NZ);
    return whole.status;
}

/* ---- the controller ---- */

static ilqr s;
static ilqr_problem p;
static reach r;

static void plan(const double *q, const double *v) {
    static double memory[ILQR_REALS(NV, NV, NV, N)], dt[N];
    r.w = whole.w, r.d = whole.d, r.dt = 0.01, r.p = &p;
    for (int k = 0; k < N; k++) dt[k] = r.dt;
    p = (ilqr_problem){.m = &iiwa_model,
                       .knots = N,
                       .nu = NV,
                       .dt = dt,
                       .lower = reach_least,
                       .upper = reach_limit,
                       .user = &r,
                       .step = reach_step,
                       .derivatives = by_batch,
                       .cost = reach_cost};
    check(ilqr_init(&s, &p, memory, sizeof memory / sizeof *memory));
    check(reach_aim(&r, 0, q));
    for (int k = 0; k < N; k++) memcpy(s.u + k * NV, r.hold, sizeof r.hold); /* first guess: stay */
    check(ilqr_start(&s, q, v));
    s.tries = 1, s.rollouts = 2;
}

/* One tick of the control loop: returns the torque. */
static const double *control(double time, const double *q, const double *v) {
    int better;
    check(ilqr_shift(&s, tick / r.dt));
    check(reach_aim(&r, time, q));
    check(ilqr_start(&s, q, v));
    check(ilqr_iterate(&s, &better));
    return s.u;
}

/* The robot, in place of the real one. */
static void move(double *q, double *v, const double *tau) {
    double a[NV];
    check(rbd_aba(&iiwa_model, whole.w, q, v, tau, NULL, a));
    check(rbd_step(&iiwa_model, q, v, a, tick, q, v));
}

static double distance(double time, const double *q) {
    double target[3], hand[3];
    reach_target(time, target);
    check(rbd_kinematics(&iiwa_model, whole.w, q, NULL, NULL));
    check(rbd_point_position(&iiwa_model, whole.w, IIWA_BODY_LBR_IIWA_LINK_7, reach_hand, hand));
    return sqrt(pow(hand[0] - target[0], 2) + pow(hand[1] - target[1], 2) + pow(hand[2] - target[2], 2));
}

/* ---- times ---- */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

enum {
    SHIFT,
    START,
    LINEARISE,
    BACKWARD,
    FORWARD,
    WHOLE,
    BY_SINGLE,
    BY_BATCH,
    BY_THREADS,
    BY_BOTH,
    COST,
    PARTS
};
static double least[PARTS];

static double took(int part, double since) {
    const double t = now();
    least[part] = fmin(least[part], t - since);
    return now();
}

/* As control, part by part. */
static void timed_control(double time, const double *q, const double *v) {
    const double begin = now();
    double t = begin;
    check(ilqr_shift(&s, tick / r.dt)), t = took(SHIFT, t);
    check(reach_aim(&r, time, q)), check(ilqr_start(&s, q, v)), t = took(START, t);
    check(ilqr_linearise(&s)), t = took(LINEARISE, t);
    check(ilqr_backward(&s)), t = took(BACKWARD, t);
    ilqr_line_search(&s), took(FORWARD, t);
    took(WHOLE, begin);
    static double l, l_z[REACH_NZ], l_zz[REACH_NZ * REACH_NZ];
    t = now();
    for (int k = 0; k < N; k++)
        check(reach_cost(&r, k, s.q + k * NV, s.v + k * NV, s.u + k * NV, &l, l_z, l_zz));
    t = took(COST, t);
    differentiate(&whole, 0, s.q, s.v, s.u), t = took(BY_SINGLE, t);
    differentiate(&whole, 1, s.q, s.v, s.u), t = took(BY_BATCH, t);
    differentiate_by_threads(0, s.q, s.v, s.u), t = took(BY_THREADS, t);
    differentiate_by_threads(1, s.q, s.v, s.u), took(BY_BOTH, t);
}

static void print_times(void) {
    printf("microseconds, the least of %d ticks; %d knots, %d joints\n", TICKS, N, NV);
    printf("%8.1f  a tick of the controller\n", least[WHOLE]);
    printf("%8.1f    the plan moves on and starts from the measured state: dynamics and cost\n",
           least[SHIFT] + least[START]);
    printf("%8.1f    derivatives of the dynamics, by one batch call\n", least[LINEARISE]);
    printf("%8.1f    backward pass, of which the cost's derivatives are %.1f\n", least[BACKWARD],
           least[COST]);
    printf("%8.1f    line search: dynamics and cost\n", least[FORWARD]);
    printf("derivatives of the dynamics in all knots, %d states in each SIMD instruction of a batch:\n",
           rbd_batch_lanes());
    printf("%8.1f  single calls\n%8.1f  one batch call\n%8.1f  %d threads of single calls\n%8.1f  %d "
           "threads, a batch "
           "call each\n",
           least[BY_SINGLE], least[BY_BATCH], least[BY_THREADS], THREADS, least[BY_BOTH], THREADS);
}

static void start_threads(pthread_t *threads) {
    pthread_barrier_init(&job.start, NULL, THREADS);
    pthread_barrier_init(&job.done, NULL, THREADS);
    for (int i = 0; i < THREADS; i++) {
        ready(&workers[i]);
        workers[i].first = i * N / THREADS, workers[i].end = (i + 1) * N / THREADS;
        if (i < THREADS - 1 && pthread_create(&threads[i], NULL, run, &workers[i])) exit(EXIT_FAILURE);
    }
    for (int i = 0; i < PARTS; i++) least[i] = 1e9;
}

static void stop_threads(pthread_t *threads) {
    job.quit = 1;
    pthread_barrier_wait(&job.start);
    for (int i = 0; i < THREADS - 1; i++) pthread_join(threads[i], NULL);
}

int main(int count, char **arguments) {
    const int timed = count > 1 && strcmp(arguments[1], "--times") == 0;
    static double scratch[2 * 4 * NV];
    double q[NV] = {1.5, 0.2, 0, -1.8, 0, 0.6, 0}, v[NV] = {0}, error, worst = 0, beyond = 0;
    int limited = 0, caught = -1;
    pthread_t threads[THREADS];
    ready(&whole);
    plan(q, v);
    const double derivatives = ilqr_derivative_error(&s, scratch);
    if (timed)
        start_threads(threads);
    else
        puts("t s,distance mm,joint 1,joint 2,joint 3,joint 4,joint 5,joint 6,joint 7");
    for (int i = 0; i < TICKS; i++) {
        const double *tau = control(i * tick, q, v);
        int at_limit = 0;
        for (int j = 0; j < NV; j++) {
            beyond = larger(beyond, fabs(tau[j]) - reach_limit[j]);
            at_limit |= fabs(tau[j]) >= reach_limit[j];
        }
        limited += at_limit;
        error = distance(i * tick, q);
        if (caught < 0 && error < 2e-3) caught = i;
        if (i >= 1000) worst = larger(worst, error);
        if (!timed && i % TICKS_PER_ROW == 0) {
            printf("%.2f,%.2f", i * tick, error * 1e3);
            for (int j = 0; j < NV; j++) printf(",%.3f", tau[j] / reach_limit[j]);
            puts("");
        }
        move(q, v, tau);
        if (timed) timed_control(i * tick, q, v);
    }
    if (timed) print_times(), stop_threads(threads);
    fprintf(stderr, "within 2 mm of the target after %.2f s, and within %.1f mm from 1 s on\n", caught * tick,
            worst * 1e3);
    fprintf(stderr, "at a torque's limit for %.2f s, never beyond: %s\n", limited * tick,
            beyond <= 0 ? "yes" : "no");
    fprintf(stderr, "derivatives agree with differences to 1e-6: %s\n", derivatives < 1e-6 ? "yes" : "no");
    return beyond <= 0 && caught > 0 && worst < 2e-3 && derivatives < 1e-6 ? EXIT_SUCCESS : EXIT_FAILURE;
}
