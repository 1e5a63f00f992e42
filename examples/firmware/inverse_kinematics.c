/* inverse_kinematics.c - joint angles of an iiwa for its tool on a microcontroller, in float: poses from far
   starts, and a line that the tool follows a millimetre a tick. SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#define IIWA_MODEL_IMPLEMENTATION
#include "cost.h"
#include "rbd_ik.h"
#include "models/iiwa_model.h"

enum { NQ = IIWA_NQ, TOOL = IIWA_BODY_LBR_IIWA_LINK_7, POSES = 60, TICKS = 200 };

static unsigned char work_memory[IIWA_WORK_SIZE], memory[RBD_IK_SIZE(IIWA_NB, IIWA_NV, 1)];
static rbd_work *w;

/* What calls of rbd_ik took together, and how many reached their target. */
typedef struct cost {
    uint64_t instructions;
    uint32_t worst, stack, evaluations, reached;
} cost;

/* The pose of the tool at q. */
static rbd_ik_target pose(const rbd_real *q) {
    rbd_ik_target t = {.kind = RBD_IK_POSE, .body = TOOL, .point = {0, 0, 0.15f}};
    rbd_kinematics(&iiwa_model, w, q, NULL, NULL);
    rbd_body_pose(&iiwa_model, w, TOOL, t.rotation, NULL);
    rbd_point_position(&iiwa_model, w, TOOL, t.point, t.position);
    return t;
}

static void solve(const rbd_ik_target *t, const rbd_ik_options *o, rbd_real *q, cost *c) {
    rbd_ik_result result;
    cost_stack(0);
    uint32_t start = board_now();
    const rbd_ik_status status = rbd_ik(&iiwa_model, w, t, 1, o, memory, sizeof memory, q, &result);
    const uint32_t took = COST_INSTRUCTIONS(cost_since(&start)), used = cost_stack(1);
    c->instructions += took;
    c->worst = took > c->worst ? took : c->worst;
    c->stack = used > c->stack ? used : c->stack;
    c->evaluations += (uint32_t)result.evaluations;
    c->reached += status == RBD_IK_REACHED;
}

int main(void) {
    static cost far, line;
    static rbd_real q[NQ];
    const rbd_ik_options once = {.starts = 1, .evaluations = 20};
    uint64_t seed = 1;
    if (rbd_work_init(&iiwa_model, work_memory, sizeof work_memory, &w) != RBD_OK) return 1;
    board_start();

    for (int i = 0; i < POSES; i++) {
        rbd_random(&iiwa_model, &seed, q);
        const rbd_ik_target t = pose(q);
        rbd_random(&iiwa_model, &seed, q);
        solve(&t, NULL, q, &far);
    }

    for (int k = 0; k < NQ; k++) q[k] = k % 2 ? 0.9f : 0.1f; /* bent */
    rbd_ik_target t = pose(q);
    for (int i = 0; i < TICKS; i++) {
        t.position[2] -= 0.001f;
        solve(&t, &once, q, &line);
    }

    printf("inverse kinematics of an iiwa: pose from a far start %lu instructions, %lu at worst, %lu an "
           "evaluation; "
           "a millimetre along a line %lu, %lu at worst; memory %u, work %u, stack %lu bytes; reached %lu of "
           "%d and %lu of "
           "%d\n",
           (unsigned long)(far.instructions / POSES), (unsigned long)far.worst,
           (unsigned long)(far.instructions / far.evaluations), (unsigned long)(line.instructions / TICKS),
           (unsigned long)line.worst, (unsigned)sizeof memory, (unsigned)sizeof work_memory,
           (unsigned long)far.stack, (unsigned long)far.reached, POSES, (unsigned long)line.reached, TICKS);
    return !(far.reached == POSES && line.reached == TICKS);
}
