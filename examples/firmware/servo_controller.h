/* servo_controller.h - the controller that recorded_servos.c runs on the robot and replay.c on a PC: an iiwa
   follows a path by currents, which the table of its motors makes of torques: gravity, inertia and friction
   are compensated, and feedback is weak. Both files implement rbd by this header, with RBD_REPRODUCIBLE.
   SPDX-License-Identifier: MIT */
#ifndef SERVO_CONTROLLER_H
#define SERVO_CONTROLLER_H

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
#include "rbd_actuator.h"
#include "models/iiwa_model.h"
#include "recorder.h"

enum { N = IIWA_NV };
enum { Q = 0, V = N, WANTED_Q = 2 * N, WANTED_V = 3 * N, INPUTS = 4 * N }; /* where they are in the inputs */
enum { STATES = N, OUTPUTS = N }; /* integrals of the errors; currents */
#define OUTPUT "current"

enum { KP, KD, KI, INTEGRAL_LIMIT, PERIOD_S, GAINS };
static const rbd_real gains[GAINS] = {
    [KP] = 200, [KD] = 30, [KI] = 300, [INTEGRAL_LIMIT] = 0.05f, [PERIOD_S] = 0.002f};

/* In flash: what the controller believes of the motors. */
#define SERVO(number, torque, dry, oil, load) \
    {.joint = "lbr_iiwa_joint_" #number, \
     .gear = 100, \
     .constant = 0.05f, \
     .inertia = 1e-5f, \
     .resistance = 0.4f, \
     .current = torque / 5.0f, \
     .friction = {.coulomb = dry, .viscous = oil, .load_motor = load, .still = 0.01f}}
static const rbd_motor servos[N] = {SERVO(1, 200, 3, 1, 0.05f),    SERVO(2, 200, 3, 1, 0.05f),
                                    SERVO(3, 150, 2, 0.8f, 0.05f), SERVO(4, 150, 2, 0.8f, 0.05f),
                                    SERVO(5, 100, 1, 0.5f, 0.1f),  SERVO(6, 60, 0.8f, 0.3f, 0.1f),
                                    SERVO(7, 60, 0.5f, 0.2f, 0.1f)};

/* Gains, and the numbers of the table. */
static inline uint64_t controller_configuration(void) {
    uint64_t hash = recorder_hash_scalars(recorder_hash_start, gains, GAINS);
    for (int i = 0; i < N; i++) {
        const rbd_motor *m = &servos[i];
        RECORDER_SCALARS(m->gear, m->constant, m->inertia, m->resistance, m->current, m->friction.coulomb,
                         m->friction.viscous, m->friction.load_motor, m->friction.still);
    }
    return hash;
}

static rbd_actuators *controller_servos;

/* Before the first tick. */
static inline rbd_status controller_start(void) {
    static unsigned char memory[RBD_ACTUATORS_SIZE(N, 0, 0)];
    return rbd_actuators_init(&iiwa_model, servos, N, NULL, 0, memory, sizeof memory, &controller_servos,
                              NULL);
}

/* Currents of the tick; moves the integrals on. Friction is compensated along the planned speed. */
static inline rbd_status controller_tick(rbd_work *w, const rbd_real *in, rbd_real *integral,
                                         rbd_real *currents) {
    const rbd_real limit = gains[INTEGRAL_LIMIT];
    rbd_real a[N], tau[N];
    rbd_drive drives[N];
    rbd_status status;
    for (int i = 0; i < N; i++) {
        const rbd_real error = in[WANTED_Q + i] - in[Q + i], sum = integral[i] + gains[PERIOD_S] * error;
        integral[i] = sum > limit ? limit : sum < -limit ? -limit : sum;
        a[i] = gains[KP] * error + gains[KD] * (in[WANTED_V + i] - in[V + i]) + gains[KI] * integral[i];
    }

    status = rbd_rnea(&iiwa_model, w, in + Q, in + V, a, NULL, tau);
    if (status == RBD_OK)
        status = rbd_actuators_inverse(controller_servos, in + Q, in + WANTED_V, a, tau, drives);
    for (int i = 0; i < N; i++) currents[i] = status == RBD_OK ? drives[i].current : 0;
    return status;
}

#endif
