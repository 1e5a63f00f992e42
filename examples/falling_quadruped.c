/* falling_quadruped.c - HyQ, let go 6 m above the ground, tumbles for a second while springs and dampers in
   its joints draw in the stretched legs. Writes a table to standard output: falling_quadruped.gp draws it. */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "models/hyq_model.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LEG = HYQ_DOF_LF_HAA_JOINT, LEGS = HYQ_NV - LEG, STEPS = 50000, STEPS_PER_ROW = 500 };
static const double dt = 2e-5, stiffness = 60, damping = 3; /* s, N m/rad, N m s/rad */
static const double rest[LEGS] = {0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4}; /* rad */

static unsigned char memory[HYQ_WORK_SIZE];
static rbd_work *w;
static double q[HYQ_NQ], v[HYQ_NV], dissipated;
static double *const legs = q + HYQ_Q_LF_HAA_JOINT, *const legs_v = v + LEG;

static void check(rbd_status status) {
    if (status != RBD_OK) {
        fprintf(stderr, "%s\n", rbd_status_string(status));
        exit(EXIT_FAILURE);
    }
}

static void start(void) {
    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    check(rbd_neutral(&hyq_model, q));
    q[HYQ_Q_ROOT_Z] = 6, v[HYQ_DOF_ROOT_VZ] = 2;    /* height of the trunk, m; rising, m/s */
    v[HYQ_DOF_ROOT_WX] = 1, v[HYQ_DOF_ROOT_WY] = 6; /* turning about its x and y axes, rad/s */
}

/* Semi-implicit Euler: the velocity first, then the configuration by the new velocity. It keeps momentum. */
static void step(void) {
    double tau[HYQ_NV] = {0}, a[HYQ_NV];
    for (int i = 0; i < LEGS; i++) tau[LEG + i] = stiffness * (rest[i] - legs[i]) - damping * legs_v[i];
    check(rbd_aba(&hyq_model, w, q, v, tau, NULL, a));
    check(rbd_step(&hyq_model, q, v, a, dt, q, v));
    for (int i = 0; i < LEGS; i++) dissipated += damping * pow(legs_v[i], 2) * dt;
}

/* Writes a row; returns the sum of the energies, and the centre of mass. */
static double row(double t, double com[3], double velocity[3]) {
    double kinetic, potential, elastic = 0, fore[3], hind[3];
    check(rbd_kinematics(&hyq_model, w, q, v, NULL));
    check(rbd_energy(&hyq_model, w, &kinetic, &potential));
    check(rbd_com(&hyq_model, w, com, velocity, NULL));
    check(rbd_body_pose(&hyq_model, w, HYQ_BODY_LF_LOWERLEG, NULL, fore));
    check(rbd_body_pose(&hyq_model, w, HYQ_BODY_RH_LOWERLEG, NULL, hind));
    for (int i = 0; i < LEGS; i++) elastic += stiffness * pow(legs[i] - rest[i], 2) / 2;
    const double sum = kinetic + potential + elastic + dissipated;
    printf("%.2f,%.4f,%.4f,%.4f,", t, com[2], fore[2], hind[2]);
    printf("%.3f,%.3f,%.3f,%.3f,%.3f\n", kinetic, potential, elastic, dissipated, sum);
    return sum;
}

int main(void) {
    double com[3], velocity[3], com0[3], velocity0[3], drift = 0, off = 0;
    printf("t s,com m,fore knee m,hind knee m,kinetic J,potential J,elastic J,dissipated J,sum J\n");
    start();
    const double sum = row(0, com0, velocity0);
    for (int k = 1; k <= STEPS; k++) {
        step();
        if (k % STEPS_PER_ROW == 0) {
            const double t = k * dt, height = com0[2] + velocity0[2] * t - 9.81 * t * t / 2;
            drift = larger(drift, fabs(row(t, com, velocity) - sum));
            off = larger(off, fabs(com[2] - height));
        }
    }
    fprintf(stderr, "%.1f J dissipated; all energies together %.1f J, to %.1f J\n", dissipated, sum, drift);
    fprintf(stderr, "the centre of mass follows its parabola to %.1f mm\n", 1e3 * off);
    return drift < 0.3 && off < 3e-4 ? EXIT_SUCCESS : EXIT_FAILURE;
}
