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
