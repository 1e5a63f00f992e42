/* recorded_controller.h - the controller that recorded_control.c runs on the robot and replay.c on a PC: an
   iiwa follows a path by computed torque with an integral part. Both files implement rbd by this header, with
   RBD_REPRODUCIBLE. From rbd.h on, no product and sum becomes one instruction, in the controller neither.
   SPDX-License-Identifier: MIT */
#ifndef RECORDED_CONTROLLER_H
#define RECORDED_CONTROLLER_H

#ifndef RBD_REAL
#define RBD_REAL float
#endif
#ifndef RBD_NO_BUILD
#define RBD_NO_BUILD
#endif
#ifndef RBD_REPRODUCIBLE
#define RBD_REPRODUCIBLE
#endif
#define RBD_IMPLEMENTATION
#define RBD_FEATURES IIWA_FEATURES
#include "models/iiwa_model.h"
#include "rbd.h"
#include "models/iiwa_model.h"
#include "recorder.h"

enum { N = IIWA_NV };
enum { Q = 0, V = N, WANTED_Q = 2 * N, WANTED_V = 3 * N, INPUTS = 4 * N }; /* where they are in the inputs */
enum { STATES = N, OUTPUTS = N }; /* integrals of the errors; torques */
#define OUTPUT "torque"

enum { KP, KD, KI, INTEGRAL_LIMIT, PERIOD_S, GAINS };
static const rbd_real gains[GAINS] = {
    [KP] = 100, [KD] = 20, [KI] = 200, [INTEGRAL_LIMIT] = 0.05f, [PERIOD_S] = 0.004f};

static inline uint64_t controller_configuration(void) {
    return recorder_hash_scalars(recorder_hash_start, gains, GAINS);
}

/* Before the first tick; for replay.c. */
static inline rbd_status controller_start(void) { return RBD_OK; }

/* Torques of the tick; moves the integrals on. */
static rbd_status controller_tick(rbd_work *w, const rbd_real *in, rbd_real *integral, rbd_real *tau) {
    const rbd_real limit = gains[INTEGRAL_LIMIT];
    rbd_real a[N];
    for (int i = 0; i < N; i++) {
        const rbd_real error = in[WANTED_Q + i] - in[Q + i], sum = integral[i] + gains[PERIOD_S] * error;
        integral[i] = sum > limit ? limit : sum < -limit ? -limit : sum;
        a[i] = gains[KP] * error + gains[KD] * (in[WANTED_V + i] - in[V + i]) + gains[KI] * integral[i];
    }
    return rbd_rnea(&iiwa_model, w, in + Q, in + V, a, NULL, tau);
}

#endif
