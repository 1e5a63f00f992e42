/* robot_main.c - firmware for a robot of yours: the torques that hold it still at q, by rbd.h from the table
   robot_model.h, and by the straight-line code of robot_code.c. The playground writes all three, or rbd-model
   and rbd-codegen do. No heap, the model stays in flash: docs/first_minutes.md compiles and runs it.
   SPDX-License-Identifier: MIT */
#include <stdio.h>
#define RBD_REAL float /* the scalar of robot_code.c */
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "robot_model.h"

#include "robot_code.h"

static rbd_real q[ROBOT_NQ], half[ROBOT_NV];
static const rbd_real still[ROBOT_NV];
static rbd_real by_model[ROBOT_NV], by_code[ROBOT_NV];
static unsigned char memory[ROBOT_WORK_SIZE];

int main(void) {
    rbd_work *work;
    if (rbd_work_init(&robot_model, memory, sizeof memory, &work) != RBD_OK) return 1;

    /* The pose: half a radian, or half a metre, at each joint. For yours: q[ROBOT_Q_ELBOW] = 0.5f. */
    for (int i = 0; i < ROBOT_NV; i++) half[i] = 0.5f;
    if (rbd_neutral(&robot_model, q) != RBD_OK) return 1;
    if (rbd_integrate(&robot_model, q, half, 1, q) != RBD_OK) return 1;

    if (rbd_rnea(&robot_model, work, q, still, still, NULL, by_model) != RBD_OK) return 1;
    robot_id(q, still, still, by_code);
    for (int i = 0; i < ROBOT_NV; i++) printf("%.6g %.6g\n", (double)by_model[i], (double)by_code[i]);
    return 0;
}
