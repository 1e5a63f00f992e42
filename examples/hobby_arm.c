/* hobby_arm.c - forward and inverse kinematics of a hobby arm of five axes, in degrees, as a robot's program
   has them: two functions, forty lines. The arm has the lengths of an SO-101; it needs no masses. */
#define RBD_IMPLEMENTATION
#include "rbd_ik.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- the arm: forty lines ---- */

#define JOINT(label, number, x, y, z, ax, ay, az, low, high) \
    {.name = label, \
     .parent = (number) - 1, \
     .type = RBD_REVOLUTE, \
     .axis = {ax, ay, az}, \
     .position = {x, y, z}, \
     .armature = {1}, \
     .lower = low, \
     .upper = high} /* m, rad; armature stands for the mass that is not known */

static const rbd_body joints[5] = {JOINT("pan", 0, 0.04, 0, 0.062, 0, 0, 1, -1.92, 1.92),
                                   JOINT("lift", 1, 0.03, -0.018, 0.054, 0, 1, 0, -1.75, 1.75),
                                   JOINT("elbow", 2, 0.028, 0, 0.113, 0, 1, 0, -1.69, 1.69),
                                   JOINT("flex", 3, 0.135, 0.005, 0, 0, 1, 0, -1.66, 1.66),
                                   JOINT("roll", 4, 0.061, 0.018, 0, 1, 0, 0, -2.74, 2.84)};
static const double radian = 57.29577951308232,
                    gripper[3] = {0.1, 0, 0}; /* degrees; point of the last link, m */
static unsigned char model_memory[RBD_MODEL_SIZE(5)], work_memory[RBD_WORK_SIZE(5, 5)],
    memory[RBD_IK_SIZE(5, 5, 2)];
static const rbd_model *arm;
static rbd_work *work;

static rbd_status open_arm(void) {
    const rbd_status status = rbd_model_build(joints, 5, model_memory, sizeof model_memory, &arm, NULL);
    return status ? status : rbd_work_init(arm, work_memory, sizeof work_memory, &work);
}

/* Where the gripper is: place, m, and rotation, 3 x 3, at five angles in degrees. */
static void forward(const double degrees[5], double place[3], double rotation[9]) {
    double q[5];
    for (int i = 0; i < 5; i++) q[i] = degrees[i] / radian;
    rbd_kinematics(arm, work, q, NULL, NULL);
    rbd_body_pose(arm, work, 4, rotation, NULL);
    rbd_point_position(arm, work, 4, gripper, place);
}

/* Angles for a place and a direction of the gripper, from where it is: degrees in and out. */
static rbd_ik_status inverse(const double place[3], const double direction[3], double degrees[5],
                             rbd_ik_result *result) {
    rbd_ik_target t[2] = {{.kind = RBD_IK_POINT, .body = 4},
                          {.kind = RBD_IK_AXIS, .body = 4, .axis = {1, 0, 0}}};
    rbd_ik_status status;
    double q[5];
    for (int i = 0; i < 3; i++)
        t[0].point[i] = gripper[i], t[0].position[i] = place[i], t[1].direction[i] = direction[i];
    for (int i = 0; i < 5; i++) q[i] = degrees[i] / radian;
    status = rbd_ik(arm, work, t, 2, NULL, memory, sizeof memory, q, result);
    for (int i = 0; i < 5; i++) degrees[i] = q[i] * radian;
    return status;
}

/* ---- what it does ---- */

int main(void) {
    static const double down[3] = {0, 0, -1};
    double degrees[5] = {0}, place[3], rotation[9];
    int reached = 0;
    rbd_ik_result result;
    if (open_arm() != RBD_OK) return EXIT_FAILURE;
    forward(degrees, place, rotation);
    printf("stretched: gripper at %.3f %.3f %.3f m\n", place[0], place[1], place[2]);

    for (int i = 0; i < 3; i++) { /* along a line over the table, pointing down; the last place is too far */
        const double wanted[3] = {0.15 + 0.06 * i * i, 0.05, 0.05};
        char text[100];
        const rbd_ik_status status = inverse(wanted, down, degrees, &result);
        forward(degrees, place, rotation);
        printf("%.2f m: %s\n", wanted[0], rbd_ik_text(status, &result, text, sizeof text));
        printf("    pan %.1f, lift %.1f, elbow %.1f, flex %.1f degrees: gripper at %.3f %.3f %.3f "
               "m\n",
               degrees[0], degrees[1], degrees[2], degrees[3], place[0], place[1], place[2]);
        reached += status == RBD_IK_REACHED && fabs(place[0] - wanted[0]) < 1e-5;
    }
    return reached == 2 ? EXIT_SUCCESS : EXIT_FAILURE;
}
