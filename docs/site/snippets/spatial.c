#include "rbd_spatial.h"

#include <math.h>

enum { HAND = 0, WORLD = -1 };
rbd_status status;
double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, p[3] = {0, 0, 1}, f_ext[6], velocity[6] = {0, 0, 1, 0.5, 0, 0};

/* What an example computes, and what it should be. */
static void expect(double x, double wanted) {
    if (!(fabs(x - wanted) < 1e-9)) status = RBD_ERR_RANGE;
}

void example_rbd_placement_from_arrays(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD); /* of rbd_body_pose */
    const rbd_vec3 tip = rbd_point_up(hand, rbd_vec3_of(0, 0, 0.1));         /* in the world */
    const rbd_vec3 back = rbd_point_down(hand, tip);
    expect(back.z, 0.1);
}

void example_rbd_force_down(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);
    const rbd_force push = rbd_force_of(rbd_vec3_of(0, 0, 0), rbd_vec3_of(0, 0, 50), WORLD);
    rbd_force_to_array(rbd_force_down(hand, push), &f_ext[6 * HAND]); /* a row of f_ext */
}

void example_rbd_power(void) {
    const rbd_motion v = rbd_motion_from_array(velocity, HAND);
    const rbd_force f = rbd_force_from_array(f_ext, HAND);
    expect(rbd_power(v, f), 0); /* W: the hand moves along x, the push is along z */
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
    expect(step.linear.z, 1);
}

void example_rbd_inertia_times(void) {
    const rbd_motion v = rbd_motion_from_array(velocity, HAND);
    const double pi[10] = {1, 0, 0, 0.1, 0.02, 0, 0, 0.02, 0, 0.01};
    const rbd_inertia body = rbd_inertia_from_parameters(pi, HAND);
    const rbd_force momentum = rbd_inertia_times(body, v);
    const rbd_force rate = rbd_force_cross(v, momentum); /* what the velocity adds to the wrench */
    expect(rate.force.y, 0.5);                           /* N: 1 kg, 1 rad/s, 0.5 m/s */
}

void example_rbd_rotation_product(void) {
    const rbd_rotation tilt = rbd_rotation_from_axis_angle(rbd_vec3_of(0, 1, 0), 0.5),
                       hand = rbd_rotation_from_array(R);
    const rbd_rotation tilted = rbd_rotation_product(tilt, hand); /* first hand, then tilt */
    const rbd_rotation back = rbd_rotation_product(rbd_rotation_inverse(tilt), tilted);
    double nine[9];
    rbd_rotation_to_array(back, nine); /* R again */
    expect(nine[0], R[0]);
}

void example_rbd_rotate(void) {
    const rbd_rotation r = rbd_rotation_from_rpy(0, 0, 1.5707963267948966);
    double v[3];
    rbd_vec3_to_array(rbd_rotate(r, rbd_vec3_from_array(p)), v); /* the hand's axes into the world's */
    expect(rbd_rotate_back(r, rbd_vec3_of(0, 1, 0)).x, 1);       /* and back */
}

void example_rbd_rotation_exp(void) {
    const rbd_vec3 turn = rbd_vec3_of(0, 0, 0.3); /* axis times angle: omega times a second */
    const rbd_vec3 same = rbd_rotation_log(rbd_rotation_exp(turn));
    expect(same.z, 0.3);
}

void example_rbd_rotation_to_axis_angle(void) {
    rbd_vec3 axis;
    const double angle = rbd_rotation_to_axis_angle(rbd_rotation_from_rpy(0.4, 0, 0), &axis);
    expect(angle, 0.4);
    expect(axis.x, 1);
    expect(rbd_rotation_to_axis_angle(rbd_rotation_identity(), &axis), 0);
}

void example_rbd_placement_of(void) {
    const rbd_placement hand =
        rbd_placement_of(rbd_rotation_from_array(R), rbd_vec3_from_array(p), HAND, WORLD);
    const rbd_placement world = rbd_placement_inverse(hand); /* where the world stands in the hand */
    expect(world.position.z, -1);
}

void example_rbd_placement_exp(void) {
    const rbd_motion twist = rbd_motion_of(rbd_vec3_of(0, 0, 0.1), rbd_vec3_of(1, 0, 0), WORLD);
    const rbd_placement moved = rbd_placement_exp(twist, HAND); /* after a second along the screw */
    expect(moved.position.x, sin(0.1) / 0.1);                   /* it goes round a circle of 10 m */
}

void example_rbd_motion_up(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);
    const rbd_motion v = rbd_motion_from_array(velocity, HAND), in_world = rbd_motion_up(hand, v);
    double six[6];
    rbd_motion_to_array(rbd_motion_down(hand, in_world), six); /* velocity again */
    expect(six[3], velocity[3]);
}

void example_rbd_motion_cross(void) {
    const rbd_motion v = rbd_motion_from_array(velocity, HAND),
                     axis = rbd_motion_of(rbd_vec3_of(0, 1, 0), rbd_vec3_of(0, 0, 0), HAND);
    const rbd_motion joint = rbd_motion_scale(2, axis); /* 2 rad/s about it */
    const rbd_motion child = rbd_motion_add(v, joint), bias = rbd_motion_cross(child, joint);
    expect(bias.angular.x, -2); /* rad/s^2 */
}

void example_rbd_force_up(void) {
    const rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);
    const rbd_force grip = rbd_force_from_array(f_ext, HAND),
                    weight = rbd_force_of(rbd_vec3_of(0, 0, 0), rbd_vec3_of(0, 0, -9.81), HAND);
    const rbd_force all = rbd_force_add(grip, rbd_force_scale(1.5, weight)); /* 1.5 kg in the hand */
    expect(rbd_force_up(hand, all).force.z, 50 - 1.5 * 9.81);
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
    expect(parameters[0], 1.5); /* kg */
}
