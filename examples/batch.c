/* batch.c - forward dynamics of the iiwa in 4096 random states by one batch call, and by single calls. */
#define RBD_IMPLEMENTATION
#include "rbd_batch.h"

#include "models/iiwa_model.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STATES = 4096, NQ = IIWA_NQ, NV = IIWA_NV };

static double q[STATES * NQ], v[STATES * NV], tau[STATES * NV], a[STATES * NV], a_single[STATES * NV];

static void draw_states(void) {
    uint64_t seed = 1;
    for (int s = 0; s < STATES; s++) rbd_random(&iiwa_model, &seed, q + s * NQ);
    for (int i = 0; i < STATES * NV; i++) {
        v[i] = sin(i);
        tau[i] = 5 * cos(i);
    }
}

static rbd_status by_batch(void) {
    const size_t size = rbd_batch_size(&iiwa_model);
    void *memory = malloc(size);
    rbd_batch *b;
    rbd_status status = rbd_batch_init(&iiwa_model, memory, size, &b);
    if (status == RBD_OK) status = rbd_batch_aba(&iiwa_model, b, STATES, q, v, tau, NULL, a);
    free(memory);
    return status;
}

static rbd_status by_single_calls(void) {
    static unsigned char memory[IIWA_WORK_SIZE];
    rbd_work *w;
    rbd_status status = rbd_work_init(&iiwa_model, memory, sizeof memory, &w);
    for (int s = 0; s < STATES && status == RBD_OK; s++)
        status = rbd_aba(&iiwa_model, w, q + s * NQ, v + s * NV, tau + s * NV, NULL, a_single + s * NV);
    return status;
}

/* The largest difference between the two, relative to the largest acceleration. */
static double difference(void) {
    double worst = 0, largest = 0;
    for (int i = 0; i < STATES * NV; i++) {
        worst = larger(worst, fabs(a[i] - a_single[i]));
        largest = larger(largest, fabs(a_single[i]));
    }
    return worst / largest;
}

int main(void) {
    draw_states();
    rbd_status status = by_batch();
    if (status == RBD_OK) status = by_single_calls();
    if (status != RBD_OK) {
        printf("%s\n", rbd_status_string(status));
        return EXIT_FAILURE;
    }
    printf("%d states, %d at a time; the last one's accelerations, rad/s^2:\n", STATES, rbd_batch_lanes());
    for (int i = 0; i < NV; i++) printf("%10.3f", a[(STATES - 1) * NV + i]);
    printf("\nbatch and single calls differ by less than 1e-12: %s\n", difference() < 1e-12 ? "yes" : "no");
    return difference() < 1e-12 ? EXIT_SUCCESS : EXIT_FAILURE;
}
