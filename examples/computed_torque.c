/* computed_torque.c - a robot from a URDF file follows a motion by computed torque, simulated: the error
   falls as that of a critically damped oscillator. usage: computed_torque FILE.urdf (joints of one dof) */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "rbd_urdf.h"
#include "larger.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MAX = 20, STEPS = 10000 };
static const double dt = 1e-4, w0 = 10, error0 = 0.2; /* s, rad/s of the closed loop, rad */

static rbd_body bodies[MAX];
static char names[4000];
static unsigned char model_memory[RBD_MODEL_SIZE(MAX)], work_memory[RBD_WORK_SIZE(MAX, MAX)];
static const rbd_model *m;
static rbd_work *w;

static void fail(const char *what) {
    fprintf(stderr, "computed_torque: %s\n", what);
    exit(EXIT_FAILURE);
}

static void load(const char *path) {
    rbd_urdf robot = {.bodies = bodies, .bodies_max = MAX, .names = names, .names_max = sizeof names};
    if (rbd_urdf_load(path, NULL, &robot) != RBD_URDF_OK) fail(robot.error.text);
    if (rbd_model_build(bodies, robot.nb, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK || rbd_nv(m) != rbd_nb(m))
        fail("its joints must have one degree of freedom each"); /* else it builds: the loader has tried */
    printf("%s: %d joints\n", robot.name, robot.nb);
}

/* The wanted motion of joint i: angle, rate, acceleration. */
static void wanted(double t, int i, double *q, double *v, double *a) {
    const double rate = 1 + 0.3 * i;
    *q = 0.5 * sin(rate * t), *v = 0.5 * rate * cos(rate * t), *a = -0.5 * rate * rate * sin(rate * t);
}

static void control(double t, const double *q, const double *v, double *tau) {
    double command[MAX];
    for (int i = 0; i < rbd_nv(m); i++) {
        double q_wanted, v_wanted, a_wanted;
        wanted(t, i, &q_wanted, &v_wanted, &a_wanted);
        command[i] = a_wanted + 2 * w0 * (v_wanted - v[i]) + w0 * w0 * (q_wanted - q[i]);
    }
    if (rbd_rnea(m, w, q, v, command, NULL, tau) != RBD_OK) fail("inverse dynamics failed");
}

int main(int argc, char **argv) {
    double q[MAX], v[MAX], a[MAX], tau[MAX], unused, error = 0, worst = 0;
    if (argc != 2) fail("usage: computed_torque FILE.urdf");
    load(argv[1]);
    const int nv = rbd_nv(m);
    for (int i = 0; i < nv; i++) {
        wanted(0, i, &q[i], &v[i], &unused);
        q[i] -= error0;
    }
    for (int k = 0; k <= STEPS; k++) {
        const double t = k * dt, expected = error0 * (1 + w0 * t) * exp(-w0 * t);
        for (int i = 0; i < nv; i++) {
            wanted(t, i, &error, &unused, &unused);
            error -= q[i];
            worst = larger(worst, fabs(error - expected));
        }
        if (k % (STEPS / 4) == 0)
            printf("%.2f s: error of the last joint%8.4f rad, expected%8.4f\n", t, error, expected);
        control(t, q, v, tau);
        if (rbd_aba(m, w, q, v, tau, NULL, a) != RBD_OK) fail("forward dynamics failed");
        rbd_step(m, q, v, a, dt, q, v);
    }
    printf("all joints follow the expected error to 1 mrad: %s\n", worst < 1e-3 ? "yes" : "no");
    return worst < 1e-3 ? EXIT_SUCCESS : EXIT_FAILURE;
}
