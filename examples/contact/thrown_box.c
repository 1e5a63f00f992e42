/* thrown_box.c - a box is thrown, tumbles over the ground and comes to rest on a face. No step with contact
   gains energy. */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"
#include "../larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { CORNERS = 8, STEPS = 1500, STEPS_PER_ROW = 250 };
static const double dt = 1e-3, half[3] = {0.2, 0.15, 0.1}, mass = 3; /* s, m, kg */

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

static double energy(const rbd_model *m, rbd_work *w, const double *q, const double *v) {
    double kinetic, potential;
    check(rbd_kinematics(m, w, q, v, NULL));
    check(rbd_energy(m, w, &kinetic, &potential));
    return kinetic + potential;
}

int main(void) {
    const double x = half[0] * half[0], y = half[1] * half[1], z = half[2] * half[2];
    const rbd_body box = {.name = "box",
                          .parent = -1,
                          .type = RBD_FLOATING,
                          .mass = mass,
                          .inertia = {mass * (y + z) / 3, 0, 0, mass * (x + z) / 3, 0, mass * (x + y) / 3}};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 6)];
    double q[7] = {0, 0, 1, 0, 0, 0, 1}, v[6] = {3, 5, 2, 2, 0, 0}, tau[6] = {0}, before, gain = 0;
    rbd_contact corner[CORNERS];
    const rbd_model *m;
    rbd_work *w;
    rbd_contact_set *c;

    check(rbd_model_build(&box, 1, model_memory, sizeof model_memory, &m, NULL));
    check(rbd_work_init(m, work_memory, sizeof work_memory, &w));
    for (int i = 0; i < CORNERS; i++) {
        corner[i] = (rbd_contact){.body1 = 0, .body2 = -1, .friction = 0.5};
        for (int j = 0; j < 3; j++) corner[i].point[j] = i >> j & 1 ? half[j] : -half[j];
    }
    const size_t size = rbd_contact_set_size(m, CORNERS, NULL, 0, NULL);
    void *memory = malloc(size);
    if (!memory) return EXIT_FAILURE;
    check(rbd_contact_set_init(m, w, corner, CORNERS, NULL, 0, NULL, memory, size, &c, NULL));

    before = energy(m, w, q, v);
    for (int k = 0; k <= STEPS; k++) {
        int touching = 0, slipping = 0;
        double now;
        check(rbd_contact_step(m, c, q, v, tau, NULL, NULL, dt, q, v));
        for (int i = 0; i < CORNERS; i++) {
            const rbd_contact_state state = rbd_contact_get(c, i, NULL, NULL);
            touching += state == RBD_STICKS, slipping += state == RBD_SLIPS;
        }
        now = energy(m, w, q, v);
        if (touching + slipping > 0) gain = larger(gain, now - before);
        before = now;
        if (k % STEPS_PER_ROW == 0)
            printf("%.2f s: centre at %5.2f %5.2f %5.2f m, energy %6.2f J, %d corners touch\n", k * dt, q[0],
                   q[1], q[2], now, touching + slipping);
    }
    printf("it lies on a face: %s\n", fabs(before - mass * 9.81 * half[2]) < 1e-3 ? "yes" : "no");
    printf("a step with contact gained energy: %s\n", gain < 1e-9 ? "no" : "yes");
    free(memory);
    return EXIT_SUCCESS;
}
