/* lqr.c - two systems that fall over if left alone are linearised, regulated by an LQR gain, and simulated: a
   pole on a cart, which has no motor at the hinge, and HyQ hung up in the air by its trunk, to which whatever
   holds it gives a wrench. Errors of a floating base are tangent vectors, by rbd_difference. */
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "models/cart_pole_model.h"
#include "models/hyq_model.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, N = 2 * NV }; /* the larger of the two */
#define STEP 0.01

typedef struct regulator { /* of the step x -> A x + B u about (home, v = 0, hold) */
    double home[NQ], hold[NV], A[N][N], B[N][NV], K[NV][N];
    int nv, inputs; /* the first of the joints are driven */
} regulator;

static unsigned char work_memory[HYQ_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(HYQ_NB, NV)];
static rbd_work *w;
static rbd_derivatives *d;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* The step v += h a(q, v, tau), q = integrate(q, v, h), by the chain rule. */
static void linearise(const rbd_model *m, regulator *r) {
    static double by_q[NV * NV], by_v[NV * NV], Minv[NV * NV], turn[NV * NV], move[NV * NV];
    const double v[NV] = {0};
    const int n = r->nv;
    check(rbd_gravity_torque(m, w, r->home, r->hold));
    check(rbd_fd_derivatives(m, d, r->home, v, r->hold, NULL, NULL, by_q, by_v, Minv));
    check(rbd_integrate_derivatives(m, v, STEP, turn, move));
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            r->A[n + i][j] = STEP * by_q[i * n + j];
            r->A[n + i][n + j] = (i == j) + STEP * by_v[i * n + j];
            if (j < r->inputs) r->B[n + i][j] = STEP * Minv[i * n + j];
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < 2 * n; j++) {
            r->A[i][j] = j < n ? turn[i * n + j] : 0;
            for (int k = 0; k < n; k++) r->A[i][j] += move[i * n + k] * r->A[n + k][j];
            for (int k = 0; k < n && j < r->inputs; k++) r->B[i][j] += move[i * n + k] * r->B[n + k][j];
        }
}

/* (1e-4 + B' P B) K = B' P A, by Gauss and Jordan: the matrix is positive definite. */
static void solve_gain(regulator *r, double PA[N][N], double PB[N][NV]) {
    static double S[NV][NV + N];
    const int n = 2 * r->nv, m = r->inputs;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m + n; j++) {
            S[i][j] = i == j ? 1e-4 : 0;
            for (int k = 0; k < n; k++) S[i][j] += r->B[k][i] * (j < m ? PB[k][j] : PA[k][j - m]);
        }
    for (int p = 0; p < m; p++)
        for (int i = 0; i < m; i++) {
            const double factor = (i == p ? S[p][p] - 1 : S[i][p]) / S[p][p];
            for (int j = p; j < m + n; j++) S[i][j] -= factor * S[p][j];
        }
    for (int i = 0; i < m; i++) memcpy(r->K[i], S[i] + m, (size_t)n * sizeof(double));
}

/* The gain of u = -K x that makes the sum of x' x + 1e-4 u' u least: P = 1 + A' P (A - B K), repeated. */
static void find_gain(regulator *r) {
    static double P[N][N], PA[N][N], PB[N][NV];
    const int n = 2 * r->nv, m = r->inputs;
    double change = 1, largest = 0;
    memset(P, 0, sizeof P);
    for (int round = 0; round < 5000 && change > 1e-10 * largest; round++) {
        memset(PA, 0, sizeof PA), memset(PB, 0, sizeof PB);
        for (int i = 0; i < n; i++)
            for (int k = 0; k < n; k++) {
                for (int j = 0; j < n; j++) PA[i][j] += P[i][k] * r->A[k][j];
                for (int j = 0; j < m; j++) PB[i][j] += P[i][k] * r->B[k][j];
            }
        solve_gain(r, PA, PB);
        for (int i = 0; i < n; i++)
            for (int k = 0; k < m; k++)
                for (int j = 0; j < n; j++) PA[i][j] -= PB[i][k] * r->K[k][j];
        change = largest = 0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double x = i == j;
                for (int k = 0; k < n; k++) x += r->A[k][i] * PA[k][j];
                change = larger(change, fabs(x - P[i][j])), largest = larger(largest, fabs(x));
                P[i][j] = x;
            }
    }
}

/* How far q and v are from home and rest, x, and its largest component. */
static double distance(const rbd_model *m, const regulator *r, const double *q, const double *v, double *x) {
    double largest = 0;
    check(rbd_difference(m, r->home, q, x));
    for (int i = 0; i < r->nv; i++) x[r->nv + i] = v[i];
    for (int i = 0; i < 2 * r->nv; i++) largest = larger(largest, fabs(x[i]));
    return largest;
}

/* 10 s from home moved by error, regulated or not: how far from home the end is. */
static double simulate(const rbd_model *m, const regulator *r, const double *error, int regulated) {
    double q[NQ], v[NV] = {0}, a[NV], tau[NV], x[N];
    check(rbd_integrate(m, r->home, error, 1, q));
    for (int step = 0; step < 1000; step++) {
        distance(m, r, q, v, x);
        for (int i = 0; i < r->nv; i++) {
            tau[i] = r->hold[i];
            for (int k = 0; k < 2 * r->nv && regulated && i < r->inputs; k++) tau[i] -= r->K[i][k] * x[k];
        }
        check(rbd_aba(m, w, q, v, tau, NULL, a));
        check(rbd_step(m, q, v, a, STEP, q, v));
    }
    return distance(m, r, q, v, x);
}

static int regulate(const char *name, const rbd_model *m, int inputs, regulator *r, const double *error) {
    r->nv = rbd_nv(m), r->inputs = inputs;
    check(rbd_work_init(m, work_memory, sizeof work_memory, &w));
    check(rbd_derivatives_init(m, w, memory, sizeof memory, &d));
    linearise(m, r);
    find_gain(r);
    const double alone = simulate(m, r, error, 0), end = simulate(m, r, error, 1);
    printf("%s: %d of %d joints driven; after 10 s alone %s, regulated %s\n", name, inputs, r->nv,
           alone > 0.1 ? "far off" : "at home", end < 1e-3 ? "at home" : "far off");
    return alone > 0.1 && end < 1e-3;
}

int main(void) {
    static regulator pole, hyq;
    double error[2][NV] = {{0.3, 0.4}, {0}};
    pole.home[CART_POLE_Q_HINGE] = acos(-1); /* upright */
    check(rbd_neutral(&hyq_model, hyq.home));
    for (int i = 0; i < NV; i++) error[1][i] = i % 2 ? 0.3 : -0.3; /* rad and m */
    for (int leg = 0; leg < 4; leg++) hyq.home[HYQ_Q_LF_HFE_JOINT + leg] = leg < 2 ? 0.7 : -0.7;
    for (int leg = 0; leg < 4; leg++) hyq.home[HYQ_Q_LF_KFE_JOINT + leg] = leg < 2 ? -1.4 : 1.4;
    return regulate("cart and pole", &cart_pole_model, 1, &pole, error[0]) &&
                   regulate("HyQ", &hyq_model, HYQ_NV, &hyq, error[1])
               ? EXIT_SUCCESS
               : EXIT_FAILURE;
}
