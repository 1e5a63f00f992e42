/* computed_torque.c - the iiwa follows sines by computed torque, at a fixed period, without a heap. The robot
   starts off its path: the error must decay as the gains say. SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "control.h"
#define IIWA_MODEL_IMPLEMENTATION /* the built model: const, in flash */
#include "models/iiwa_model.h"
#include "../larger.h"

enum { N = IIWA_NV, STEPS = 1000000 / PERIOD_US }; /* one second */

static const rbd_real bandwidth =
    8; /* 1/s, critically damped: error'' + 2 bandwidth error' + bandwidth^2 error = 0 */
static const rbd_real first_error = 0.2f; /* rad */

/* Where joint i shall be. */
static void path(int i, rbd_real t, rbd_real *q, rbd_real *v, rbd_real *a) {
    const rbd_real size = 0.4f, rate = 1 + 0.25f * (rbd_real)i;
    *q = size * sinf(rate * t);
    *v = size * rate * cosf(rate * t);
    *a = -rate * rate * *q;
}

/* Torques by inverse dynamics of the acceleration that corrects the error. */
static rbd_status control(rbd_work *w, rbd_real t, const rbd_real *q, const rbd_real *v, rbd_real *tau) {
    rbd_real a[N];
    for (int i = 0; i < N; i++) {
        rbd_real q_path, v_path, a_path;
        path(i, t, &q_path, &v_path, &a_path);
        a[i] = a_path + 2 * bandwidth * (v_path - v[i]) + bandwidth * bandwidth * (q_path - q[i]);
    }
    return rbd_rnea(&iiwa_model, w, q, v, a, NULL, tau);
}

/* Largest difference between the joints' errors and the decay that theory says. */
static rbd_real deviation(rbd_real t, const rbd_real *q) {
    const rbd_real expected = first_error * (1 + bandwidth * t) * expf(-bandwidth * t);
    rbd_real largest = 0;
    for (int i = 0; i < N; i++) {
        rbd_real q_path, v_path, a_path;
        path(i, t, &q_path, &v_path, &a_path);
        largest = largerf(largest, fabsf(q[i] - q_path - expected));
    }
    return largest;
}

int main(void) {
    static unsigned char memory[IIWA_WORK_SIZE];
    static rbd_real q[N], v[N], tau[N], scratch[N];
    rbd_work *w;
    rbd_status status = rbd_work_init(&iiwa_model, memory, sizeof memory, &w);
    rbd_real worst = 0, unused;
    int late = 0;
    for (int i = 0; i < N; i++) {
        path(i, 0, &q[i], &v[i], &unused);
        q[i] += first_error;
    }
    board_start();
    uint32_t start = board_now();
    for (int step = 0; step < STEPS && status == RBD_OK; step++) {
        status = control(w, (rbd_real)step * PERIOD, q, v, tau);
        if (status == RBD_OK) status = simulate(&iiwa_model, w, q, v, tau, NULL, scratch);
        late += !board_wait(&start, BOARD_TICKS(PERIOD_US));
        worst = largerf(worst, deviation((rbd_real)(step + 1) * PERIOD, q));
    }
    const rbd_real last = deviation((rbd_real)STEPS * PERIOD, q);
    /* Held over a period, the torque is half of one late: at worst so much of the first error, times its
     * rate. */
    const rbd_real bound = first_error * bandwidth * PERIOD;
    printf(
        "computed torque, iiwa: %d periods of %d us, %d late; error %d urad off the theory at worst (of %d "
        "allowed), %d at the end: %s\n",
        STEPS, PERIOD_US, late, (int)(worst * 1e6f), (int)(bound * 1e6f), (int)(last * 1e6f),
        rbd_status_string(status));
    return !(status == RBD_OK && late == 0 && worst <= bound && last <= bound / 4);
}
