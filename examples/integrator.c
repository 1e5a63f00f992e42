/* integrator.c - steps of first, second and fourth order: HyQ tumbles freely. Semi-implicit Euler by rbd_step
   gains energy, the midpoint of rbd_free_step keeps it. Runge-Kutta on the configuration manifold: the
   classical scheme with rbd_integrate for its stages falls from order four to two; Runge-Kutta-Munthe-Kaas
   keeps its order (Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.8). */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "models/hyq_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, STEPS = 100, RUNS = 2, TRUTH = 32 * STEPS };

static unsigned char memory[HYQ_WORK_SIZE];
static rbd_work *w;
static const double earth[3] = {0, 0, -9.81};

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* b += x [d, v], the bracket of se(3), in which the floating root moves; HyQ's other joints just add up. A
   spherical joint moves in so(3), which has the first line alone; a planar one in se(2), which has both for
   d = (0, 0, d0; d1, d2, 0) and v likewise. */
static void add_bracket(const double *d, const double *v, double x, double *b) {
    for (int i = 0, k = 1, l = 2; i < 3; k = l, l = i++) {
        b[i] += x * (d[k] * v[l] - d[l] * v[k]);
        b[3 + i] += x * (d[k] * v[3 + l] - d[l] * v[3 + k] + d[3 + k] * v[l] - d[3 + l] * v[k]);
    }
}

/* The rate r of d where q = rbd_integrate(q0, d, 1) moves by v: v + [d, v] / 2 + [d, [d, v]] / 12 + O(d^4).
 */
static void tangent_rate(const double *d, const double *v, double *r) {
    double b[NV] = {0};
    add_bracket(d, v, 1, b);
    for (int i = 0; i < NV; i++) r[i] = v[i] + b[i] / 2;
    add_bracket(d, b, 1. / 12, r);
}

/* A step h of the classical scheme in the tangent space at q; naive: as if that were flat. */
static void step(double *q, double *v, double h, int naive) {
    static const double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    double rate[NV] = {0}, a[NV] = {0}, d[NV], qs[NQ], vs[NV], tau[NV] = {0}, move[NV] = {0}, gain[NV] = {0};
    for (int s = 0; s < 4; s++) {
        for (int i = 0; i < NV; i++) {
            d[i] = h * node[s] * rate[i];
            vs[i] = v[i] + h * node[s] * a[i];
        }
        check(rbd_integrate(&hyq_model, q, d, 1, qs));
        check(rbd_aba(&hyq_model, w, qs, vs, tau, NULL, a));
        tangent_rate(d, vs, rate);
        for (int i = 0; i < NV; i++) {
            rate[i] = naive ? vs[i] : rate[i];
            move[i] += h * weight[s] * rate[i];
            gain[i] += h * weight[s] * a[i];
        }
    }
    check(rbd_integrate(&hyq_model, q, move, 1, q));
    for (int i = 0; i < NV; i++) v[i] += gain[i];
}

/* Where it is after a fifth of a second. */
static void fly(int steps, int naive, double *q, double *v) {
    static const double start[NV] = {3, 6, -4, 1, 0.5, 2, 1, -1, 1, -1}; /* turning, rising, legs swinging */
    check(rbd_neutral(&hyq_model, q));
    for (int i = 0; i < NV; i++) v[i] = start[i];
    for (int k = 0; k < steps; k++) step(q, v, 0.2 / steps, naive);
}

/* How far from the truth it is then, q and v together. */
static double error_of(int steps, int naive, const double *true_q, const double *true_v) {
    double q[NQ], v[NV], d[NV], error = 0;
    fly(steps, naive, q, v);
    check(rbd_difference(&hyq_model, true_q, q, d));
    for (int i = 0; i < NV; i++) error += d[i] * d[i] + pow(v[i] - true_v[i], 2);
    return sqrt(error);
}

/* The energy gained in two seconds of a space without gravity, as a share, by steps of a millisecond: of
   first order by rbd_aba and rbd_step, or of second by rbd_free_step. */
static double energy(const double *q, const double *v) {
    double kinetic, potential;
    check(rbd_kinematics(&hyq_model, w, q, v, NULL));
    check(rbd_energy(&hyq_model, w, &kinetic, &potential));
    return kinetic + potential;
}
static double gain(int second) {
    const double none[3] = {0, 0, 0}, dt = 1e-3;
    double q[NQ], v[NV], a[NV], tau[NV] = {0}, before, after;
    rbd_set_gravity(w, none);
    fly(0, 0, q, v);
    before = energy(q, v);
    for (int k = 0; k < 2000; k++) {
        if (second) {
            check(rbd_free_step(&hyq_model, w, q, v, tau, NULL, NULL, dt, q, v));
        } else {
            check(rbd_aba(&hyq_model, w, q, v, tau, NULL, a));
            check(rbd_step(&hyq_model, q, v, a, dt, q, v));
        }
    }
    after = energy(q, v);
    rbd_set_gravity(w, earth);
    return after / before - 1;
}

int main(void) {
    double q[NQ], v[NV], order[2] = {0}, gained[2];
    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    for (int second = 0; second < 2; second++) gained[second] = gain(second);
    printf("energy gained in 2 s by steps of 1 ms: rbd_step %.0e, rbd_free_step %.0e\n", gained[0],
           gained[1]);
    fly(TRUTH, 0, q, v);
    printf("steps   naive error, order   Munthe-Kaas error, order\n");
    for (int run = 0, steps = 2 * STEPS; run < RUNS; run++, steps *= 2) {
        printf("%5d", steps);
        for (int naive = 1; naive >= 0; naive--) {
            const double error = error_of(steps, naive, q, v);
            order[naive] = log2(error_of(steps / 2, naive, q, v) / error);
            printf("%18.0e%7.1f", error, order[naive]);
        }
        printf("\n");
    }
    return fabs(order[1] - 2) < 0.1 && fabs(order[0] - 4) < 0.1 && gained[0] > 1e-3 && fabs(gained[1]) < 1e-4
               ? EXIT_SUCCESS
               : EXIT_FAILURE;
}
