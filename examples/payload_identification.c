/* payload_identification.c - what an iiwa took up, from the torques of a motion: those that the arm alone
   does not explain are linear in the ten inertial parameters of its last link, by the regressor (Atkeson, An
   and Hollerbach 1986); least squares, then the model is corrected at run time. */
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "models/iiwa.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NB = IIWA_NB, NV = IIWA_NV, LAST = NB - 1, SAMPLES = 400, P = 10 };

/* The truth that the program below does not know: 2.5 kg, off the flange's axis. */
static const double mass = 2.5, com[3] = {0.02, -0.03, 0.11}, inertia[6] = {0.012, 0, 0.001, 0.010, 0, 0.006};

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

/* x = A^-1 x for a positive definite matrix. */
static void solve(double A[P][P], double x[P]) {
    for (int k = 0; k < P; k++)
        for (int i = k + 1; i < P; i++) {
            const double factor = A[i][k] / A[k][k];
            for (int j = k; j < P; j++) A[i][j] -= factor * A[k][j];
            x[i] -= factor * x[k];
        }
    for (int k = P - 1; k >= 0; k--) {
        for (int j = k + 1; j < P; j++) x[k] -= A[k][j] * x[j];
        x[k] /= A[k][k];
    }
}

/* The payload's parameters pi, of which Y pi are the torques left over: Y'Y pi = Y' left over. noise: of a
   torque sensor, N m. */
static void identify(double noise, double pi[P]) {
    double A[P][P] = {{0}}, q[NV], v[NV], a[NV], measured[NV], expected[NV];
    static double Y[NV * P * NB];
    uint32_t seed = 1;
    for (int k = 0; k < P; k++) pi[k] = 0;
    for (int n = 0; n < SAMPLES; n++) {
        motion(0.02 * n, q, v, a);
        check(rbd_rnea(loaded.m, loaded.w, q, v, a, NULL, measured));
        check(rbd_rnea(known.m, known.w, q, v, a, NULL, expected));
        check(rbd_regressor(known.m, known.d, q, v, a, Y));
        for (int i = 0; i < NV; i++) {
            const double *y = &Y[(i * NB + LAST) * P];
            seed = seed * 1664525u + 1013904223u;
            const double left = measured[i] + noise * ((double)seed * 0x1p-31 - 1) - expected[i];
            for (int j = 0; j < P; j++) {
                pi[j] += y[j] * left;
                for (int k = 0; k < P; k++) A[j][k] += y[j] * y[k];
            }
        }
    }
    solve(A, pi);
}

/* The largest torque that the known arm does not explain. */
static double unexplained(void) {
    double worst = 0, q[NV], v[NV], a[NV], tau[2][NV];
    for (int n = 0; n < SAMPLES; n++) {
        motion(10 + 0.02 * n, q, v, a);
        check(rbd_rnea(loaded.m, loaded.w, q, v, a, NULL, tau[0]));
        check(rbd_rnea(known.m, known.w, q, v, a, NULL, tau[1]));
        for (int i = 0; i < NV; i++) worst = fmax(worst, fabs(tau[0][i] - tau[1][i]));
    }
    return worst;
}

int main(void) {
    rbd_body load = {.mass = 0};
    double pi[P], before, after;
    build(&known), build(&loaded);
    check(rbd_derivatives_init(known.m, known.w, known.more, sizeof known.more, &known.d));
    check(rbd_add_payload(loaded.model, LAST, mass, com, inertia));
    before = unexplained();
    identify(0.2, pi);
    check(rbd_check_parameters(pi));
    check(rbd_set_parameters(&load, pi));
    check(rbd_add_payload(known.model, LAST, load.mass, load.com, load.inertia));
    after = unexplained();
    printf("payload %.2f kg at (%.3f, %.3f, %.3f) m\n", load.mass, load.com[0], load.com[1], load.com[2]);
    printf("torques left over: %.0f N m before, below 0.1 N m after: %s\n", before,
           after < 0.1 ? "yes" : "no");
    return after < 0.1 && fabs(load.mass - mass) < 0.01 ? EXIT_SUCCESS : EXIT_FAILURE;
}
