/* collision.c - someone pushes an iiwa that moves: a momentum observer feels on which link, and how hard,
   from torques and encoders alone (De Luca and Mattone 2005). Without a push it must feel nothing.
   SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "control.h"
#include "rbd_estimate.h"
#define IIWA_MODEL_IMPLEMENTATION /* the built model: const, in flash */
#include "models/iiwa_model.h"
#include "../larger.h"

enum { N = IIWA_NV, STEPS = 1000000 / PERIOD_US, PUSHED = IIWA_BODY_LBR_IIWA_LINK_4 }; /* one second */

static const rbd_observer_options options = {.gain = 40, .least = 1}; /* 1/s; N m: a threshold */
static const rbd_real hand[3] = {0, 0.2f, 0};           /* where it pushes: in the link's axes, m */
static const rbd_real push[6] = {0, 0, 0, 20, -25, 10}; /* from the half of the second on: world axes, N */

/* The last link whose joint feels a push, -1 if none does; of all times the last is that which is pushed. */
static int felt(const rbd_real *r) {
    int link = N - 1;
    while (link >= 0 && fabsf(r[link]) < options.least) link--;
    return link;
}

/* Computed torque along sines. */
static rbd_status control(rbd_work *w, rbd_real t, const rbd_real *q, const rbd_real *v, rbd_real *tau) {
    const rbd_real gain = 8, size = 0.4f; /* 1/s, rad */
    rbd_real a[N];
    for (int i = 0; i < N; i++) {
        const rbd_real rate = 1 + 0.25f * (rbd_real)i, s = size * sinf(rate * t), c = size * cosf(rate * t);
        a[i] = -rate * rate * s + 2 * gain * (rate * c - v[i]) + gain * gain * (s - q[i]);
    }
    return rbd_rnea(&iiwa_model, w, q, v, a, NULL, tau);
}

int main(void) {
    static unsigned char memory[IIWA_WORK_SIZE], observing[RBD_OBSERVER_SIZE(N)];
    static rbd_real q[N], v[N], tau[N], r[N], scratch[N], f_ext[6 * IIWA_NB], truth[N];
    rbd_observer *o = NULL;
    rbd_work *w;
    rbd_status status = rbd_work_init(&iiwa_model, memory, sizeof memory, &w);
    rbd_real quiet = 0, size = 0, error = 0;
    int late = 0, first = -1, link = -1;
    for (int i = 0; i < N; i++) v[i] = 0.4f * (1 + 0.25f * (rbd_real)i);
    if (status == RBD_OK)
        status = rbd_observer_init(&iiwa_model, &options, observing, sizeof observing, &o, NULL);
    if (status == RBD_OK) status = rbd_observer_step(&iiwa_model, w, o, q, v, tau, PERIOD, r, NULL, NULL);
    board_start();
    uint32_t start = board_now();
    for (int step = 0; step < STEPS && status == RBD_OK; step++) {
        const int pushed = step >= STEPS / 2;
        status = control(w, (rbd_real)step * PERIOD, q, v, tau);
        if (pushed && status == RBD_OK) { /* the robot: what it is pushed with */
            status = rbd_kinematics(&iiwa_model, w, q, v, NULL);
            rbd_point_wrench(&iiwa_model, w, PUSHED, hand, RBD_WORLD_AXES, push, &f_ext[6 * PUSHED]);
            rbd_jacobian_transpose(&iiwa_model, w, PUSHED, hand, RBD_WORLD_AXES, push, truth);
        }
        if (status == RBD_OK) status = simulate(&iiwa_model, w, q, v, tau, f_ext, scratch);
        if (status == RBD_OK) status = rbd_observer_step(&iiwa_model, w, o, q, v, tau, PERIOD, r, NULL, NULL);
        if (felt(r) > link) link = felt(r);
        if (first < 0 && link >= 0) first = step;
        for (int i = 0; i < N && !pushed; i++) quiet = largerf(quiet, fabsf(r[i]));
        late += !board_wait(&start, BOARD_TICKS(PERIOD_US));
    }
    for (int i = 0; i < N; i++) {
        size = largerf(size, fabsf(truth[i]));
        error = largerf(error, fabsf(r[i] - truth[i]));
    }
    printf("collision, iiwa: %d periods of %d us, %d late; %d mN m at most without a push; it is felt after "
           "%d ms, on link %d and none beyond; up to %d mN m in the end, off by %d: %s\n",
           STEPS, PERIOD_US, late, (int)(quiet * 1e3f), (first + 1 - STEPS / 2) * PERIOD_US / 1000, link + 1,
           (int)(size * 1e3f), (int)(error * 1e3f), rbd_status_string(status));
    return !(status == RBD_OK && late == 0 && first >= STEPS / 2 && link == PUSHED && error < 0.05f * size &&
             quiet < options.least / 4);
}
