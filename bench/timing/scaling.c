/* Time per call against the number of joints: chains and binary trees of 1 to 200 bodies, fixed base,
   revolute joints about changing axes. CSV: shape,bodies,algorithm,ns,disturbed. Each model is verified
   before it is timed. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "least.h"
#include "rbd.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST = 200, STATES = 16, ROUNDS = 7, MOST_ROUNDS = 50 };

static unsigned char model_memory[RBD_MODEL_SIZE(MOST)], work_memory[RBD_WORK_SIZE(MOST, MOST)];
static double q[STATES][MOST], v[STATES][MOST], a[STATES][MOST], tau[STATES][MOST];
static double out[MOST * MOST];

static const rbd_model *model;
static rbd_work *work;

/* ---- robots ---- */

static rbd_status build(int n, int children) {
    static rbd_body bodies[MOST];
    memset(bodies, 0, sizeof bodies);
    for (int i = 0; i < n; i++) {
        rbd_body *b = &bodies[i];
        b->parent = i == 0 ? -1 : (i - 1) / children;
        b->type = RBD_REVOLUTE;
        b->axis[i % 3] = 1;
        b->position[0] = i > 0 ? 0.1 : 0;
        b->position[1] = 0.01;
        b->mass = 1;
        b->com[0] = 0.05;
        b->inertia[0] = 0.002;
        b->inertia[3] = b->inertia[5] = 0.003;
    }
    rbd_status status = rbd_model_build(bodies, n, model_memory, sizeof model_memory, &model, NULL);
    return status == RBD_OK ? rbd_work_init(model, work_memory, sizeof work_memory, &work) : status;
}

static void draw(int n) {
    for (int s = 0; s < STATES; s++)
        for (int i = 0; i < n; i++) {
            q[s][i] = 2 * sin(3 * i + 5 * s + 1);
            v[s][i] = sin(7 * i + s);
            a[s][i] = cos(5 * i + 2 * s);
            tau[s][i] = 3 * sin(2 * i + 3 * s);
        }
}

/* ---- algorithms ---- */

static rbd_status call_id(int s) { return rbd_rnea(model, work, q[s], v[s], a[s], NULL, out); }
static rbd_status call_mm(int s) { return rbd_crba(model, work, q[s], out); }
static rbd_status call_fd(int s) { return rbd_aba(model, work, q[s], v[s], tau[s], NULL, out); }

static const struct algorithm {
    const char *name;
    rbd_status (*call)(int s);
} algorithms[] = {{"id", call_id}, {"mm", call_mm}, {"fd", call_fd}};

/* Unlike fmax, keeps what is not a number. */
static double larger(double x, double y) { return y > x || isnan(y) ? y : x; }

/* The largest difference between tau and inverse dynamics of forward dynamics of tau, against the largest
   tau; and between M a + bias and tau of inverse dynamics. Of state s. */
static double round_trip_error(int s, int n) {
    static double acceleration[MOST], torque[MOST], bias[MOST];
    double worst = 0, largest = 1e-3;
    if (rbd_aba(model, work, q[s], v[s], tau[s], NULL, acceleration) != RBD_OK ||
        rbd_rnea(model, work, q[s], v[s], acceleration, NULL, torque) != RBD_OK ||
        rbd_bias(model, work, q[s], v[s], NULL, bias) != RBD_OK || rbd_crba(model, work, q[s], out) != RBD_OK)
        return HUGE_VAL;
    for (int i = 0; i < n; i++) {
        double sum = bias[i];
        for (int j = 0; j < n; j++) sum += out[i * n + j] * acceleration[j];
        worst = larger(worst, larger(fabs(torque[i] - tau[s][i]), fabs(sum - torque[i])));
        largest = larger(largest, larger(fabs(bias[i]), fabs(torque[i])));
    }
    return worst / largest;
}

/* ---- timing ---- */

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* Sets *ns to the two least means of a few rounds, each of about a millisecond; of more if they differ. */
static rbd_status time_call(rbd_status call(int s), int n, struct least *ns) {
    const int calls = 16 + 60000 / n;
    *ns = LEAST_NONE;
    for (int r = 0; r < ROUNDS || (r < MOST_ROUNDS && !least_repeats(*ns)); r++) {
        const double start = now_ns();
        for (int i = 0; i < calls; i++) {
            const rbd_status status = call(i % STATES);
            if (status != RBD_OK) return status;
        }
        least_take(ns, (now_ns() - start) / calls);
    }
    return RBD_OK;
}

static int verify(const char *shape, int n) {
    for (int s = 0; s < STATES; s++) {
        const double error = round_trip_error(s, n);
        if (!(error < 1e-6)) { /* long chains are ill-conditioned */
            fprintf(stderr, "scaling: %s of %d: the round trip of state %d is wrong by %.1e\n", shape, n, s,
                    error);
            return -1;
        }
    }
    return 0;
}

static int measure(const char *shape, int children, int n) {
    rbd_status status = build(n, children);
    if (status != RBD_OK) {
        fprintf(stderr, "scaling: %s of %d: %s\n", shape, n, rbd_status_string(status));
        return -1;
    }
    draw(n);
    if (verify(shape, n) != 0) return -1;
    for (size_t i = 0; i < sizeof algorithms / sizeof *algorithms; i++) {
        struct least ns;
        status = time_call(algorithms[i].call, n, &ns);
        if (status != RBD_OK) {
            fprintf(stderr, "scaling: %s of %d: %s: %s\n", shape, n, algorithms[i].name,
                    rbd_status_string(status));
            return -1;
        }
        printf("%s,%d,%s,%.2f,%d\n", shape, n, algorithms[i].name, ns.first, !least_repeats(ns));
    }
    return 0;
}

int main(void) {
    static const int sizes[] = {1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200};
    puts("shape,bodies,algorithm,ns,disturbed");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (measure("chain", 1, sizes[i]) != 0 || measure("tree", 2, sizes[i]) != 0) return EXIT_FAILURE;
    return EXIT_SUCCESS;
}
