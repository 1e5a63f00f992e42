/* inverse_kinematics.c - joint angles for places of an iiwa's tool, for its poses, and for places with the
   tool pointing down, by rbd_ik.h; then a place out of reach. The model is a table. */
#define RBD_IMPLEMENTATION
#include "rbd_ik.h"

#include "models/iiwa_model.h"

#include <stdio.h>
#include <stdlib.h>

enum { TOOL = IIWA_BODY_LBR_IIWA_LINK_7, TARGETS = 200 };

static unsigned char work_memory[IIWA_WORK_SIZE], memory[RBD_IK_SIZE(IIWA_NB, IIWA_NV, 2)];
static rbd_work *w;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* How many targets of this kind are reached, each that of a configuration within the limits, each from
   another. */
static int solve_all(rbd_ik_kind kind) {
    uint64_t seed = 1;
    int reached = 0;
    for (int n = 0; n < TARGETS; n++) {
        rbd_ik_target target = {.kind = kind, .body = TOOL, .point = {0, 0, 0.15}};
        rbd_ik_result result;
        double q[IIWA_NQ];
        check(rbd_random(&iiwa_model, &seed, q));
        check(rbd_kinematics(&iiwa_model, w, q, NULL, NULL));
        check(rbd_body_pose(&iiwa_model, w, TOOL, target.rotation, NULL));
        check(rbd_point_position(&iiwa_model, w, TOOL, target.point, target.position));
        check(rbd_random(&iiwa_model, &seed, q));
        reached +=
            rbd_ik(&iiwa_model, w, &target, 1, NULL, memory, sizeof memory, q, &result) == RBD_IK_REACHED;
    }
    return reached;
}

/* The tool pointing down at a place. */
static rbd_ik_status point_down(double x, rbd_ik_result *result) {
    const rbd_ik_target tool[2] = {
        {.kind = RBD_IK_POINT, .body = TOOL, .point = {0, 0, 0.15}, .position = {x, 0.2, 0.4}},
        {.kind = RBD_IK_AXIS, .body = TOOL, .axis = {0, 0, 1}, .direction = {0, 0, -1}}};
    double q[IIWA_NQ] = {0};
    char text[100];
    const rbd_ik_status status = rbd_ik(&iiwa_model, w, tool, 2, NULL, memory, sizeof memory, q, result);
    printf("down at %.1f m: %s", x, rbd_ik_text(status, result, text, sizeof text));
    if (status == RBD_IK_REACHED)
        printf(", q = %.2f %.2f %.2f %.2f %.2f %.2f %.2f\n", q[0], q[1], q[2], q[3], q[4], q[5], q[6]);
    else
        printf(", %.2f m and %.1f rad away\n", result->metres, result->radians);
    return status;
}

int main(void) {
    rbd_ik_result result;
    check(rbd_work_init(&iiwa_model, work_memory, sizeof work_memory, &w));
    const int places = solve_all(RBD_IK_POINT), poses = solve_all(RBD_IK_POSE);
    printf("%d of %d places, %d of %d poses reached to 1e-6, within the joints' limits\n", places, TARGETS,
           poses, TARGETS);
    const int within = point_down(0.5, &result) == RBD_IK_REACHED,
              beyond = point_down(1.5, &result) == RBD_IK_REACHED;
    return places == TARGETS && poses == TARGETS && within && !beyond ? EXIT_SUCCESS : EXIT_FAILURE;
}
