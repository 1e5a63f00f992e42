#include "rbd_mjcf.h"

#include <stdio.h>

rbd_status status;
rbd_body bodies[40];
char names[4000];
rbd_mjcf_frame frames[60];
rbd_mjcf_place places[40];
rbd_constraint constraints[10];
rbd_mjcf_finding warnings[5];
rbd_mjcf robot = {.bodies = bodies,
                  .bodies_max = 40,
                  .names = names,
                  .names_max = sizeof names,
                  .frames = frames,
                  .frames_max = 60,
                  .places = places,
                  .places_max = 40,
                  .constraints = constraints,
                  .constraints_max = 10,
                  .warnings = warnings,
                  .warnings_max = 5};
double q[40], v[40], qpos[40] = {0}, qvel[40];

void example_rbd_mjcf_load(void) {
    const char *const keep[] = {"on_plate",
                                NULL}; /* a site that shall be a body, for its pose and Jacobian */
    const rbd_mjcf_options options = {.keep = keep};
    if (rbd_mjcf_load("tests/mjcf/joints.xml", &options, &robot) != RBD_MJCF_OK) {
        fprintf(stderr, "line %d: %s\n", robot.error.line, robot.error.text);
        status = RBD_ERR_NAME;
    }
    for (int i = 0; i < robot.nwarnings && i < robot.warnings_max; i++) puts(robot.warnings[i].text);
}

void example_rbd_mjcf_qpos_of_q(void) {
    for (int i = 0; i < 40; i++) q[i] = 0.1;
    rbd_mjcf_qpos_of_q(&robot, q, qpos); /* for mjData */
}

void example_rbd_mjcf_q_of_qpos(void) { rbd_mjcf_q_of_qpos(&robot, qpos, q); }

void example_rbd_mjcf_qvel_of_v(void) { rbd_mjcf_qvel_of_v(&robot, qpos, v, qvel); }

void example_rbd_mjcf_v_of_qvel(void) { rbd_mjcf_v_of_qvel(&robot, qpos, qvel, v); }

void example_rbd_mjcf_convert(void) {
    const struct mjModel_ *m = NULL; /* yours, from mj_loadXML */
    if (m && rbd_mjcf_convert(m, NULL, &robot) != RBD_MJCF_OK) status = RBD_ERR_NAME;
}

void example_rbd_mjcf_parse(void) {
    static const char text[] =
        "<mujoco><worldbody><body name='rod'><joint name='hinge' axis='0 1 0'/>"
        "<geom type='capsule' size='.1' fromto='0 0 0 0 0 1'/></body></worldbody></mujoco>";
    if (rbd_mjcf_parse(text, sizeof text - 1, NULL, &robot) != RBD_MJCF_OK) status = RBD_ERR_NAME;
}

void example_rbd_mjcf_status_string(void) { puts(rbd_mjcf_status_string(robot.error.status)); }
