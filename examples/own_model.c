/* own_model.c - a model of one's own, written as a table: a double pendulum, checked against its textbook
   equations (e.g. Craig, Introduction to Robotics, section 6.7, with rods for point masses). */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NB = 2, NV = 2 };

/* Two rods that turn about y and hang along -z at q = 0: length, mass, and where the centre of mass is. */
#define L1 0.8
#define M1 2.0
#define R1 0.4
#define I1 (M1 * L1 * L1 / 12)
#define L2 0.6
#define M2 1.5
#define R2 0.3
#define I2 (M2 * L2 * L2 / 12)

/* clang-format off */
static const rbd_body bodies[NB] = {
    {.name = "upper", .joint = "shoulder", .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0},
     .mass = M1, .com = {0, 0, -R1}, .inertia = {I1, 0, 0, I1, 0, 0}}, /* xx xy xz yy yz zz */
    {.name = "lower", .joint = "elbow", .parent = 0, .type = RBD_REVOLUTE, .axis = {0, 1, 0},
     .position = {0, 0, -L1}, .mass = M2, .com = {0, 0, -R2}, .inertia = {I2, 0, 0, I2, 0, 0}},
};
/* clang-format on */

/* tau = M(q) a + c(q, v) + g(q), by hand. */
static void textbook(const double *q, const double *v, const double *a, double *tau) {
    const double A = I1 + M1 * R1 * R1 + I2 + M2 * (L1 * L1 + R2 * R2), B = M2 * L1 * R2,
                 D = I2 + M2 * R2 * R2;
    const double c = B * cos(q[1]), s = B * sin(q[1]);
    const double g0 = (M1 * R1 + M2 * L1) * 9.81 * sin(q[0]), g1 = M2 * R2 * 9.81 * sin(q[0] + q[1]);
    tau[0] = (A + 2 * c) * a[0] + (D + c) * a[1] - s * (2 * v[0] + v[1]) * v[1] + g0 + g1;
    tau[1] = (D + c) * a[0] + D * a[1] + s * v[0] * v[0] + g1;
}

static void fail(const char *what) {
    printf("%s\n", what);
    exit(EXIT_FAILURE);
}

int main(void) {
    static unsigned char model_memory[RBD_MODEL_SIZE(NB)], work_memory[RBD_WORK_SIZE(NB, NV)];
    const rbd_model *m;
    rbd_work *w;
    rbd_report report;
    char text[120];
    if (rbd_model_build(bodies, NB, model_memory, sizeof model_memory, &m, &report) != RBD_OK)
        fail(rbd_finding_text(&report.error, text, sizeof text));
    for (int i = 0; i < report.warnings && i < RBD_MAX_WARNINGS; i++)
        printf("warning: %s\n", rbd_finding_text(&report.warning[i], text, sizeof text));
    if (rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK) fail("no memory for the work");

    double worst = 0;
    for (int k = 0; k < 1000; k++) {
        const double q[NV] = {sin(k), 3 * cos(2 * k)}, v[NV] = {4 * sin(3 * k), 2 * cos(k)};
        const double a[NV] = {9 * cos(5 * k), 7 * sin(7 * k)};
        double tau[NV], expected[NV], back[NV];
        textbook(q, v, a, expected);
        if (rbd_rnea(m, w, q, v, a, NULL, tau) != RBD_OK || rbd_aba(m, w, q, v, tau, NULL, back) != RBD_OK)
            fail("dynamics failed");
        for (int i = 0; i < NV; i++)
            worst = larger(worst, larger(fabs(tau[i] - expected[i]), fabs(back[i] - a[i])));
        if (k == 1)
            printf("tau   %9.4f %9.4f N m\nbook  %9.4f %9.4f N m\n", tau[0], tau[1], expected[0],
                   expected[1]);
    }
    printf("1000 states: rbd and the textbook differ by less than 1e-12: %s\n", worst < 1e-12 ? "yes" : "no");
    return worst < 1e-12 ? EXIT_SUCCESS : EXIT_FAILURE;
}
