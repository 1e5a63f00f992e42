/* estimate_scalars.c - rbd_estimate.h in double and in float: a payload of 2.5 kg, found, weighed with noise
   and taken away, physical at each tick; 100,000 ticks of an observer and of an estimate; bounded friction
   beside a search. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "larger.h"
#include "rbd_estimate.h"

#include "models/iiwa.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = IIWA_NV, HAND = IIWA_NB - 1, IN_FLOAT = sizeof(rbd_real) == 4, TICKS = 100000 };

static int failures;
static void expect(int holds, const char *what, double value) {
    if (holds) return;
    failures++;
    printf("FAILED: %s: %g\n", what, value);
}

/* bare, and with the payload */
static unsigned char model_memory[2][RBD_MODEL_SIZE(IIWA_NB)], work_memory[2][RBD_WORK_SIZE(IIWA_NB, N)],
    derivatives_memory[RBD_DERIVATIVES_SIZE(IIWA_NB, N)], memory[RBD_ESTIMATE_SIZE(N)],
    observer_memory[RBD_OBSERVER_SIZE(N)];
static const rbd_model *m[2];
static rbd_work *w[2];
static rbd_derivatives *d;

static const double com[3] = {0.02, -0.03, 0.11}, inertia[6] = {0.012, 0, 0.001, 0.010, 0, 0.006};
static const double coulomb[N] = {3, 4, 2, 2.5, 1, 0.8, 0.4}, viscous[N] = {1, 1.5, .8, 1, .4, .3, .1};

static void build(void) {
    for (int k = 0; k < 2; k++)
        if (rbd_model_build(iiwa_bodies, IIWA_NB, model_memory[k], sizeof model_memory[k], &m[k], NULL) ||
            rbd_work_init(m[k], work_memory[k], sizeof work_memory[k], &w[k]))
            exit(2);
    if (rbd_add_payload(model_memory[1], HAND, 2.5, com, inertia) ||
        rbd_derivatives_init(m[0], w[0], derivatives_memory, sizeof derivatives_memory, &d))
        exit(2);
}

static uint64_t seed = 11;
static double uniform(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-53;
}
static double gauss(void) {
    double sum = -6;
    for (int i = 0; i < 12; i++) sum += uniform();
    return sum;
}

typedef struct sample {
    rbd_real q[N], v[N], a[N], tau[N];
} sample;

/* A plan in which every joint swings at frequencies of its own, and the torques of the motors. */
static void measure(double t, int loaded, double noise, sample *s) {
    for (int k = 0; k < N; k++) {
        const double f = 1.1 + 0.37 * k, g = 2.3 - 0.19 * k;
        s->q[k] = (rbd_real)(0.6 * sin(f * t + k) + 0.3 * cos(g * t));
        s->v[k] = (rbd_real)(0.6 * f * cos(f * t + k) - 0.3 * g * sin(g * t));
        s->a[k] = (rbd_real)(-0.6 * f * f * sin(f * t + k) - 0.3 * g * g * cos(g * t));
    }
    rbd_rnea(m[loaded], w[loaded], s->q, s->v, s->a, NULL, s->tau);
    for (int i = 0; i < N; i++)
        s->tau[i] +=
            (rbd_real)(coulomb[i] * (s->v[i] > 0 ? 1 : -1) + viscous[i] * (double)s->v[i] + noise * gauss());
}

/* The estimate, which must be physical. Returns the mass. */
static double weigh(rbd_estimate *e) {
    rbd_const pi[10];
    rbd_joint_friction f[N];
    if (rbd_estimate_solve(e, pi, f, NULL)) return -1;
    if (rbd_check_parameters(pi)) return -2;
    for (int i = 0; i < N; i++)
        if (!(f[i].coulomb >= 0 && f[i].viscous >= 0 && f[i].offset - f[i].offset <= 0)) return -3;
    return (double)pi[0];
}

/* 3 s with the payload, 3 s without, at 100 Hz. */
static void check_payload(double noise, double bound) {
    rbd_real sure[N];
    rbd_estimate_options options = {.noise = sure};
    rbd_estimate *e;
    sample s;
    double mass = 0, least = 1;
    for (int i = 0; i < N; i++) sure[i] = (rbd_real)(noise > 0 ? noise : 0.01);
    if (rbd_estimate_init(m[0], HAND, &options, memory, sizeof memory, &e, NULL)) exit(2);
    for (int k = 0; k < 600; k++) {
        measure(0.01 * k, k < 300, noise, &s);
        if (k == 300) rbd_estimate_grip(e);
        if (rbd_estimate_add(m[0], d, e, s.q, s.v, s.a, s.tau, NULL)) exit(2);
        mass = weigh(e);
        if (mass < least) least = mass;
        if (k == 299) expect(fabs(mass - 2.5) < bound, "2.5 kg", mass - 2.5);
    }
    expect(least > 0, "physical at each tick", least);
    expect(mass < bound, "nothing in the hand", mass);
}

/* Nothing but samples at rest and of one joint at a steady speed. */
static void check_rest(void) {
    rbd_estimate *e;
    sample s;
    double least = 1;
    if (rbd_estimate_init(m[0], HAND, NULL, memory, sizeof memory, &e, NULL)) exit(2);
    measure(1, 1, 0, &s);
    for (int k = 0; k < 3000; k++) {
        for (int i = 0; i < N; i++) s.v[i] = s.a[i] = 0;
        if (k > 1000) s.v[k % 2] = (rbd_real)0.5;
        if (rbd_estimate_add(m[0], d, e, s.q, s.v, s.a, s.tau, NULL)) exit(2);
        if (k % 10) continue;
        const double mass = weigh(e);
        if (mass < least) least = mass;
    }
    expect(least > 0, "physical without excitation", least);
}

/* The same samples again and again: 100,000 ticks. */
static void check_drift(void) {
    enum { PERIOD = 500 };
    static sample s[PERIOD];
    rbd_observer_options observing = {.gain = 40};
    const rbd_real dt = (rbd_real)0.001;
    rbd_real felt[N], first[N] = {0};
    double worst = 0, drift = 0;
    rbd_observer *o;
    rbd_estimate *e;

    for (int k = 0; k < PERIOD; k++) measure(0.02 * k, 1, 0, &s[k]);
    if (rbd_estimate_init(m[0], HAND, NULL, memory, sizeof memory, &e, NULL) ||
        rbd_observer_init(m[0], &observing, observer_memory, sizeof observer_memory, &o, NULL))
        exit(2);

    for (int tick = 0; tick < TICKS; tick++) {
        const sample *x = &s[tick % PERIOD];
        if (rbd_estimate_add(m[0], d, e, x->q, x->v, x->a, x->tau, NULL) ||
            rbd_observer_step(m[0], w[0], o, x->q, x->v, x->tau, dt, felt, NULL, NULL))
            exit(2);
        if (tick % 100 == 0 && tick > 1000) worst = larger(worst, fabs(weigh(e) - 2.5));
        if (tick == 10 * PERIOD) memcpy(first, felt, sizeof first);
        if (tick > 10 * PERIOD && tick % PERIOD == 0)
            for (int i = 0; i < N; i++) drift = larger(drift, fabs((double)(felt[i] - first[i])));
    }
    expect(worst < (IN_FLOAT ? 2e-3 : 1e-6), "2.5 kg, drift", worst);
    expect(drift < (IN_FLOAT ? 1e-1 : 1e-9), "felt torque, drift", drift);
}

/* rbdi_est_bounded_pair beside a search on a grid that is made finer. */
static void check_bounded_pair(void) {
    double worst = 0;
    for (int trial = 0; trial < 300; trial++) {
        const double a = 0.5 + uniform(), b = 4 * uniform() - 2, c = 0.5 + uniform(), r = 4 * uniform() - 2,
                     s = 4 * uniform() - 2;
        rbd_real x[2];
        double at[2] = {4, 4}, size = 4, found;
        rbdi_est_bounded_pair((rbd_real)a, (rbd_real)b, (rbd_real)c, (rbd_real)r, (rbd_real)s, &x[0], &x[1]);
        found = pow(a * (double)x[0] + b * (double)x[1] - r, 2) + pow(c * (double)x[1] - s, 2);
        double best = 1e9, here[2] = {4, 4};
        for (int round = 0; round < 40; round++, size *= 0.7) {
            for (int i = -4; i <= 4; i++)
                for (int j = -4; j <= 4; j++) {
                    const double u = larger(0, at[0] + size * i / 4), v = larger(0, at[1] + size * j / 4);
                    const double cost = pow(a * u + b * v - r, 2) + pow(c * v - s, 2);
                    if (cost >= best) continue;
                    best = cost;
                    here[0] = u;
                    here[1] = v;
                }
            memcpy(at, here, sizeof at);
        }
        worst = larger(worst, found - best);
        expect(x[0] >= 0 && x[1] >= 0, "bounds", fmin((double)x[0], (double)x[1]));
    }
    expect(worst < (IN_FLOAT ? 1e-5 : 1e-7), "bounded friction", worst);
}

/* A round that begins at the rim, of P or of Z, is the last, and moves nothing. */
static void check_rim(void) {
    rbdi_est_interior s;
    rbd_estimate *e;
    rbd_real P[RBDI_EST_TEN], Z[RBDI_EST_TEN];
    for (int k = 0; k < 2; k++) {
        if (rbd_estimate_init(m[0], HAND, NULL, memory, sizeof memory, &e, NULL)) exit(2);
        rbdi_est_load_triangle(e, s.all);
        rbdi_est_begin_interior(e, &s);
        expect(!rbdi_est_round(e, &s), "a round inside", k);

        memcpy(P, e->P, sizeof P);
        memcpy(Z, s.Z, sizeof Z);
        if (k) s.Z[9] = Z[9] = 0;
        if (!k) e->P[9] = P[9] = 0;
        expect(rbdi_est_round(e, &s), "a round at the rim", k);
        expect(memcmp(P, e->P, sizeof P) == 0 && memcmp(Z, s.Z, sizeof Z) == 0, "moves", k);
    }
}

int main(void) {
    build();
    check_payload(0, IN_FLOAT ? 2e-4 : 1e-4);
    check_payload(0.3, 0.02);
    check_rest();
    check_drift();
    check_bounded_pair();
    check_rim();
    printf("%s\n", failures ? "FAILED" : "rbd_estimate.h: ok");
    return failures != 0;
}
