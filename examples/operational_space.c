/* operational_space.c - the tool of an iiwa draws a circle while the arm, given a push, goes back to its
   posture (Khatib 1987). The tool's error falls as that of a critically damped oscillator in any case. */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "models/iiwa_model.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NV = IIWA_NV, TOOL = IIWA_BODY_LBR_IIWA_LINK_7, STEPS = 20000 };
static const double dt = 2e-4, w0 = 10, radius = 0.15, turn = 3.14159265358979; /* s, rad/s, m, rad/s */
static const double tool[3] = {0, 0, 0.15}; /* the point, axes of the last link */
static const double home[NV] = {0.3, 0.6, 0, -1.2, 0, 0.9, 0};

static unsigned char memory[IIWA_WORK_SIZE];
static rbd_work *w;
static double centre[3];

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* The wanted circle, in the plane of y and z: place, velocity and acceleration. */
static void wanted(double t, double x[3], double v[3], double a[3]) {
    const double circle[3] = {0, radius * sin(turn * t), radius * cos(turn * t)};
    for (int i = 0; i < 3; i++) x[i] = centre[i] + circle[i], a[i] = -turn * turn * circle[i];
    v[0] = 0, v[1] = turn * circle[2], v[2] = -turn * circle[1];
}

/* b = A^-1 b for a positive definite matrix of three rows. */
static void solve(double A[3][3], double b[3]) {
    for (int k = 0; k < 3; k++)
        for (int i = k + 1; i < 3; i++) {
            const double factor = A[i][k] / A[k][k];
            for (int j = k; j < 3; j++) A[i][j] -= factor * A[k][j];
            b[i] -= factor * b[k];
        }
    for (int k = 2; k >= 0; k--) {
        for (int j = k + 1; j < 3; j++) b[k] -= A[k][j] * b[j];
        b[k] /= A[k][k];
    }
}

/* tau = M a + c + J' f, for the posture's acceleration a and the force f that gives the tool the command: the
   operational-space inertia Lambda = A^-1, A = J M^-1 J', times what it lacks of acceleration. */
static void control(double t, const double *q, const double *v, double stiffness, double *tau,
                    double error[3]) {
    double J[6 * NV], Jt[NV * 3], M[NV * NV], MJ[NV * 3], x[3], velocity[6], bias[6], A[3][3] = {{0}},
                                                                                      f[6] = {0};
    double x_wanted[3], v_wanted[3], a_wanted[3], a[NV], push[NV];
    wanted(t, x_wanted, v_wanted, a_wanted);
    check(rbd_kinematics(&iiwa_model, w, q, v, NULL));
    check(rbd_jacobian(&iiwa_model, w, TOOL, tool, RBD_WORLD_AXES, J));
    check(rbd_point_position(&iiwa_model, w, TOOL, tool, x));
    check(rbd_point_velocity(&iiwa_model, w, TOOL, tool, RBD_WORLD_AXES, velocity));
    check(rbd_point_acceleration(&iiwa_model, w, TOOL, tool, RBD_WORLD_AXES, bias)); /* dJ/dt v */
    for (int i = 0; i < 3; i++) {
        error[i] = x_wanted[i] - x[i];
        f[3 + i] = a_wanted[i] + 2 * w0 * (v_wanted[i] - velocity[3 + i]) + w0 * w0 * error[i] - bias[3 + i];
        for (int k = 0; k < NV; k++) Jt[3 * k + i] = J[(3 + i) * NV + k];
    }
    check(rbd_crba(&iiwa_model, w, q, M));
    check(rbd_cholesky_factor(&iiwa_model, w, M, M));
    check(rbd_cholesky_solve_many(&iiwa_model, w, M, 3, Jt, MJ)); /* M^-1 J' */
    for (int k = 0; k < NV; k++) {
        a[k] = -stiffness * (q[k] - home[k]) - 2 * sqrt(stiffness) * v[k];
        for (int i = 0; i < 3; i++) {
            f[3 + i] -= Jt[3 * k + i] * a[k];
            for (int j = 0; j < 3; j++) A[i][j] += Jt[3 * k + i] * MJ[3 * k + j];
        }
    }
    solve(A, f + 3);
    check(rbd_jacobian_transpose(&iiwa_model, w, TOOL, tool, RBD_WORLD_AXES, f, push));
    check(rbd_rnea(&iiwa_model, w, q, v, a, NULL, tau));
    for (int k = 0; k < NV; k++) tau[k] += push[k];
}

/* Returns whether the error is the oscillator's at all times, and the posture kept if anything keeps it. */
static int run(double stiffness) {
    double q[NV], v[NV] = {0.5, 0, -0.5}, a[NV], tau[NV], error[3], e[3], rate[3], moves[6], worst = 0,
                  away = 0;
    for (int k = 0; k < NV; k++) q[k] = home[k];
    check(rbd_kinematics(&iiwa_model, w, q, v, NULL));
    check(rbd_point_position(&iiwa_model, w, TOOL, tool, centre));
    check(rbd_point_velocity(&iiwa_model, w, TOOL, tool, RBD_WORLD_AXES, moves));
    wanted(0, e, rate, error);
    for (int i = 0; i < 3; i++) e[i] -= centre[i], rate[i] -= moves[3 + i];
    for (int n = 0; n < STEPS; n++) {
        const double t = n * dt;
        control(t, q, v, stiffness, tau, error);
        for (int i = 0; i < 3; i++)
            worst = larger(worst, fabs(error[i] - (e[i] * (1 + w0 * t) + rate[i] * t) * exp(-w0 * t)));
        check(rbd_aba(&iiwa_model, w, q, v, tau, NULL, a));
        check(rbd_step(&iiwa_model, q, v, a, dt, q, v));
    }
    for (int k = 0; k < NV; k++) away = larger(away, fabs(q[k] - home[k]));
    printf("posture %s, tool's error as it must be: %s\n", away < 1 ? "kept" : "lost",
           worst < 1e-3 ? "yes" : "no");
    return worst < 1e-3 && (away < 1) == (stiffness > 0);
}

int main(void) {
    check(rbd_work_init(&iiwa_model, memory, sizeof memory, &w));
    const int loose = run(0), firm = run(25);
    return loose && firm ? EXIT_SUCCESS : EXIT_FAILURE;
}
