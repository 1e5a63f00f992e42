#include "rbd_spatial.h"

enum { HAND = 0, WORLD = -1 };
rbd_status status;
double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, p[3] = {0, 0, 1}, f_ext[6], velocity[6] = {0, 0, 1, 0.5, 0, 0};

void example_rbd_placement_from_arrays(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD); /* of rbd_body_pose */
    const rbd_vec3 tip = rbd_point_up(hand, rbd_vec3_of(0, 0, 0.1));         /* in the world */
    const rbd_vec3 back = rbd_point_down(hand, tip);
    if (back.z < 0.09 || back.z > 0.11) status = RBD_ERR_POSITION;
}

void example_rbd_force_down(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);
    const rbd_force push = rbd_force_of(rbd_vec3_of(0, 0, 0), rbd_vec3_of(0, 0, 50), WORLD);
    rbd_force_to_array(rbd_force_down(hand, push), &f_ext[6 * HAND]); /* a row of f_ext */
}

void example_rbd_power(void) {
    const rbd_motion v = rbd_motion_from_array(velocity, HAND);
    const rbd_force f = rbd_force_from_array(f_ext, HAND);
    if (rbd_power(v, f) > 1e6) status = RBD_ERR_RANGE; /* W */
}

void example_rbd_rotation_from_rpy(void) {
    double q[4], rpy[3];
    const rbd_rotation r = rbd_rotation_from_rpy(0.1, 0.2, 0.3); /* rad, as in a URDF */
    rbd_rotation_to_quaternion(r, q);                            /* x, y, z, w */
    rbd_rotation_to_rpy(rbd_rotation_from_quaternion(q), rpy);
}

void example_rbd_placement_compose(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD),
                        tool = rbd_placement_identity(1, HAND);
    const rbd_placement tool_in_world = rbd_placement_compose(hand, tool);
    const rbd_motion step = rbd_placement_log(tool_in_world); /* the twist that leads there in unit time */
    if (step.linear.z < 0.9) status = RBD_ERR_POSITION;
}

void example_rbd_inertia_times(void) {
    const rbd_motion v = rbd_motion_from_array(velocity, HAND);
    const double pi[10] = {1, 0, 0, 0.1, 0.02, 0, 0, 0.02, 0, 0.01};
    const rbd_inertia body = rbd_inertia_from_parameters(pi, HAND);
    const rbd_force momentum = rbd_inertia_times(body, v);
    const rbd_force rate = rbd_force_cross(v, momentum); /* what the velocity adds to the wrench */
    if (rate.force.x > 1e6) status = RBD_ERR_RANGE;
}

void example_rbd_rotation_product(void) {
    const rbd_rotation tilt = rbd_rotation_from_axis_angle(rbd_vec3_of(0, 1, 0), 0.5),
                       hand = rbd_rotation_from_array(R);
    const rbd_rotation tilted = rbd_rotation_product(tilt, hand); /* first hand, then tilt */
    const rbd_rotation back = rbd_rotation_product(rbd_rotation_inverse(tilt), tilted);
    double nine[9];
    rbd_rotation_to_array(back, nine); /* R again */
    if (nine[0] < 0.99) status = RBD_ERR_ROTATION;
}

void example_rbd_rotate(void) {
    const rbd_rotation r = rbd_rotation_from_rpy(0, 0, 1.5707963267948966);
    double v[3];
    rbd_vec3_to_array(rbd_rotate(r, rbd_vec3_from_array(p)), v); /* the hand's axes into the world's */
    if (rbd_rotate_back(r, rbd_vec3_of(0, 1, 0)).x < 0.99) status = RBD_ERR_AXIS; /* and back */
}

void example_rbd_rotation_exp(void) {
    const rbd_vec3 turn = rbd_vec3_of(0, 0, 0.3); /* axis times angle: omega times a second */
    const rbd_vec3 same = rbd_rotation_log(rbd_rotation_exp(turn));
    if (same.z < 0.29 || same.z > 0.31) status = RBD_ERR_ROTATION;
}

void example_rbd_rotation_to_axis_angle(void) {
    rbd_vec3 axis;
    const double angle = rbd_rotation_to_axis_angle(rbd_rotation_from_rpy(0.4, 0, 0), &axis);
    if (angle < 0.39 || axis.x < 0.99) status = RBD_ERR_AXIS;
    if (rbd_rotation_to_axis_angle(rbd_rotation_identity(), &axis) != 0) status = RBD_ERR_AXIS;
}

void example_rbd_placement_of(void) {
    const rbd_placement hand =
        rbd_placement_of(rbd_rotation_from_array(R), rbd_vec3_from_array(p), HAND, WORLD);
    const rbd_placement world = rbd_placement_inverse(hand); /* where the world stands in the hand */
    if (world.position.z > -0.9) status = RBD_ERR_POSITION;
}

void example_rbd_placement_exp(void) {
    const rbd_motion twist = rbd_motion_of(rbd_vec3_of(0, 0, 0.1), rbd_vec3_of(1, 0, 0), WORLD);
    const rbd_placement moved = rbd_placement_exp(twist, HAND); /* after a second along the screw */
    if (moved.position.x < 0.9) status = RBD_ERR_POSITION;
}

void example_rbd_motion_up(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);
    const rbd_motion v = rbd_motion_from_array(velocity, HAND), in_world = rbd_motion_up(hand, v);
    double six[6];
    rbd_motion_to_array(rbd_motion_down(hand, in_world), six); /* velocity again */
    if (six[3] < 0.49) status = RBD_ERR_POSITION;
}

void example_rbd_motion_cross(void) {
    const rbd_motion v = rbd_motion_from_array(velocity, HAND),
                     axis = rbd_motion_of(rbd_vec3_of(0, 1, 0), rbd_vec3_of(0, 0, 0), HAND);
    const rbd_motion joint = rbd_motion_scale(2, axis); /* 2 rad/s about it */
    const rbd_motion child = rbd_motion_add(v, joint), bias = rbd_motion_cross(child, joint);
    if (bias.angular.x > 1e6) status = RBD_ERR_RANGE;
}

void example_rbd_force_up(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);
    const rbd_force grip = rbd_force_from_array(f_ext, HAND),
                    weight = rbd_force_of(rbd_vec3_of(0, 0, 0), rbd_vec3_of(0, 0, -9.81), HAND);
    const rbd_force all = rbd_force_add(grip, rbd_force_scale(1.5, weight)); /* 1.5 kg in the hand */
    if (rbd_force_up(hand, all).force.z > 100) status = RBD_ERR_RANGE;
}

void example_rbd_inertia_add(void) {
    enum { TOOL = 1 };
    const rbd_placement tool = rbd_placement_of(rbd_rotation_identity(), rbd_vec3_of(0, 0, 0.2), TOOL, HAND);
    const double c_hand[3] = {0, 0, 0.05}, c_tool[3] = {0, 0, 0.1};
    const double I_hand[6] = {0.01, 0, 0, 0.01, 0, 0.01}, I_tool[6] = {1e-3, 0, 0, 1e-3, 0, 1e-4};
    const rbd_inertia hand = rbd_inertia_of(1, c_hand, I_hand, HAND),
                      drill = rbd_inertia_of(0.5, c_tool, I_tool, TOOL);
    const rbd_inertia both = rbd_inertia_add(hand, rbd_inertia_up(tool, drill)); /* about the hand's origin */
    double parameters[10];
    rbd_inertia_to_parameters(rbd_inertia_down(tool, both), parameters);
    if (parameters[0] < 1.49) status = RBD_ERR_MASS;
}
