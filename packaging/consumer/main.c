/* A user's program: the angular acceleration of a pendulum, and its check. */
#define RBD_IMPLEMENTATION
#include <rbd.h>

#include <math.h>
#include <stdio.h>

int main(void) {
    static const rbd_body rod[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, -0.5}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)];
    const double q[1] = {0.5}, v[1] = {0}, tau[1] = {0}, expected = -9.81 * sin(q[0]) / 0.5;
    double a[1];
    const rbd_model *m;
    rbd_work *w;
    if (rbd_model_build(rod, 1, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK ||
        rbd_aba(m, w, q, v, tau, NULL, a) != RBD_OK)
        return 1;
    printf("rbd %s: %.12f rad/s^2, by hand %.12f\n", RBD_VERSION, a[0], expected);
    return !(fabs(a[0] - expected) < 1e-12);
}
