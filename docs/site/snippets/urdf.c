#include "rbd_urdf.h"

#include <stdio.h>

rbd_status status;
rbd_body bodies[20];
char names[2000];
rbd_urdf_frame frames[20];
rbd_urdf_finding warnings[5];
rbd_urdf robot = {.bodies = bodies,
                  .bodies_max = 20,
                  .names = names,
                  .names_max = sizeof names,
                  .frames = frames,
                  .frames_max = 20,
                  .warnings = warnings,
                  .warnings_max = 5};

void example_rbd_urdf_load(void) {
    if (rbd_urdf_load("models/cart_pole.urdf", NULL, &robot) != RBD_URDF_OK) {
        fprintf(stderr, "line %d: %s\n", robot.error.line, robot.error.text);
        status = RBD_ERR_NAME;
    }
    for (int i = 0; i < robot.nwarnings && i < robot.warnings_max; i++) puts(robot.warnings[i].text);
}

void example_rbd_urdf_joint_index(void) {
    const int pole = rbd_urdf_joint_index(&robot, "hinge"); /* the body that it moves */
    if (pole < 0) status = RBD_ERR_NAME;                    /* no such joint */
    if (pole >= 0) printf("it carries %g kg\n", robot.bodies[pole].mass);
}

void example_rbd_urdf_link_index(void) {
    const int link = rbd_urdf_link_index(&robot, "pole");
    if (link < 0) status = RBD_ERR_NAME; /* no such link */
    if (link >= 0) printf("the link is part of body %d; -1: of the world\n", robot.frames[link].body);
}

void example_rbd_urdf_parse(void) {
    static const char text[] =
        "<robot name='rod'><link name='wall'/><link name='rod'><inertial><mass value='1'/>"
        "<inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
        "<joint name='hinge' type='continuous'><parent link='wall'/><child link='rod'/>"
        "</joint></robot>";
    const rbd_urdf_options floating = {.root = RBD_FLOATING, .lock_massless = 1};
    if (rbd_urdf_parse(text, sizeof text - 1, &floating, &robot) != RBD_URDF_OK) status = RBD_ERR_NAME;
}

void example_rbd_urdf_status_string(void) { puts(rbd_urdf_status_string(robot.error.status)); }
