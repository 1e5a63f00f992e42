/* payload_identification.c - what an iiwa took up, and the friction of its joints, from the torques of a
   motion with noise: a recursive estimate by rbd_estimate.h, which is a body that can exist at each tick. The
   model is corrected at run time. Then the hand opens, and the estimate is told. */
#define RBD_IMPLEMENTATION
#include "rbd_estimate.h"
#include "models/iiwa.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NB = IIWA_NB, NV = IIWA_NV, LAST = NB - 1, SAMPLES = 400 };

/* The truth that the estimate does not know: 2.5 kg, off the flange's axis; and friction, N m, N m s. */
static const double mass = 2.5, com[3] = {0.02, -0.03, 0.11}, inertia[6] = {0.012, 0, 0.001, 0.010, 0, 0.006};
static const double coulomb[NV] = {3, 4, 2, 2.5, 1, 0.8, 0.4}, viscous[NV] = {1, 1.5, 0.8, 1, 0.4, 0.3, 0.1};

typedef struct arm {
    unsigned char model[RBD_MODEL_SIZE(NB)], work[RBD_WORK_SIZE(NB, NV)], more[RBD_DERIVATIVES_SIZE(NB, NV)];
    const rbd_model *m;
    rbd_work *w;
    rbd_derivatives *d;
} arm;

static arm known, loaded;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

static void build(arm *r) {
    check(rbd_model_build(iiwa_bodies, NB, r->model, sizeof r->model, &r->m, NULL));
    check(rbd_work_init(r->m, r->work, sizeof r->work, &r->w));
    check(rbd_derivatives_init(r->m, r->w, r->more, sizeof r->more, &r->d));
}

/* A motion in which every joint swings at frequencies of its own. */
static void motion(double t, double q[NV], double v[NV], double a[NV]) {
    for (int k = 0; k < NV; k++) {
        const double f = 1.1 + 0.37 * k, g = 2.3 - 0.19 * k;
        q[k] = 0.6 * sin(f * t + k) + 0.3 * cos(g * t);
        v[k] = 0.6 * f * cos(f * t + k) - 0.3 * g * sin(g * t);
        a[k] = -0.6 * f * f * sin(f * t + k) - 0.3 * g * g * cos(g * t);
    }
}

/* What the motors of an arm give, with the noise of a sensor, N m. */
static void measure(const arm *r, double t, double noise, double *q, double *v, double *a, double *tau) {
    static uint32_t seed = 1;
    motion(t, q, v, a);
    check(rbd_rnea(r->m, r->w, q, v, a, NULL, tau));
    for (int i = 0; i < NV; i++) {
        seed = seed * 1664525u + 1013904223u;
        tau[i] += coulomb[i] * (v[i] > 0 ? 1 : -1) + viscous[i] * v[i] + noise * ((double)seed * 0x1p-31 - 1);
    }
}

/* The estimate after a motion that begins at t; each one on the way is a body. */
static void learn(rbd_estimate *e, const arm *r, double t, double pi[10], rbd_joint_friction f[NV]) {
    double q[NV], v[NV], a[NV], tau[NV];
    for (int n = 0; n < SAMPLES; n++) {
        measure(r, t + 0.02 * n, 0.2, q, v, a, tau);
        check(rbd_estimate_add(known.m, known.d, e, q, v, a, tau, NULL));
        check(rbd_estimate_solve(e, pi, f, NULL));
        check(rbd_check_parameters(pi));
    }
}

/* The largest torque that the arm and its friction do not explain, on another motion. */
static double unexplained(const rbd_joint_friction *f) {
    double worst = 0, q[NV], v[NV], a[NV], tau[2][NV];
    for (int n = 0; n < SAMPLES; n++) {
        measure(&loaded, 20 + 0.02 * n, 0, q, v, a, tau[0]);
        check(rbd_rnea(known.m, known.w, q, v, a, NULL, tau[1]));
        for (int i = 0; i < NV; i++) {
            if (f) tau[1][i] += f[i].coulomb * (v[i] > 0 ? 1 : -1) + f[i].viscous * v[i] + f[i].offset;
            worst = larger(worst, fabs(tau[0][i] - tau[1][i]));
        }
    }
    return worst;
}

int main(void) {
    static unsigned char memory[RBD_ESTIMATE_SIZE(NV)];
    rbd_joint_friction friction[NV];
    rbd_body load = {.mass = 0};
    double pi[10], sure[10], before, after;
    rbd_estimate *e;
    build(&known), build(&loaded);
    check(rbd_estimate_init(known.m, LAST, NULL, memory, sizeof memory, &e, NULL));
    check(rbd_add_payload(loaded.model, LAST, mass, com, inertia));

    before = unexplained(NULL);
    learn(e, &loaded, 0, pi, friction);
    check(rbd_estimate_deviations(e, sure, NULL));
    check(rbd_set_parameters(&load, pi));
    check(rbd_add_payload(known.model, LAST, load.mass, load.com, load.inertia));
    after = unexplained(friction);
    printf("payload %.2f kg at (%.2f, %.2f, %.2f) m; Coulomb friction of the joints", load.mass, load.com[0],
           load.com[1], load.com[2]);
    for (int i = 0; i < NV; i++) printf(" %.1f", friction[i].coulomb);
    printf(" N m\ntorques left over: %.0f N m before, below 0.3 N m after: %s\n", before,
           after < 0.3 ? "yes" : "no");
    if (after >= 0.3 || fabs(load.mass - mass) > 4 * sure[0]) return EXIT_FAILURE;

    /* the hand opens: the arm alone again, and the estimate is told */
    build(&known), build(&loaded);
    check(rbd_estimate_grip(e));
    learn(e, &loaded, 8, pi, friction);
    printf("in the hand after it has opened: less than 0.02 kg: %s\n", pi[0] < 0.02 ? "yes" : "no");
    return pi[0] < 0.02 ? EXIT_SUCCESS : EXIT_FAILURE;
}
