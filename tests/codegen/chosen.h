/* chosen.h - the robots of these tests: small ones that together have every joint type, joints that mimic
   others, merged bodies, several roots and axes at right angles. Gimbal lock makes the first singular. */
#ifndef CHOSEN_H
#define CHOSEN_H

#include "../fuzz/robots.h"

enum { CHOSEN = 8 };

static void choose_robot(sample *s, int index) {
    static const int drawn[CHOSEN][2] = {{ORDINARY, 0},   {AXES, 49},      {FOLLOWERS, 8}, {TURNED, 399},
                                         {ORDINARY, 391}, {ORDINARY, 133}, {FAR, 268},     {ORDINARY, 318}};
    static const rbd_body gimbal = {.name = "tip",
                                    .joint = "gimbal",
                                    .parent = -1,
                                    .type = RBD_EULER_ZYX,
                                    .mass = 1,
                                    .inertia = {0.1, 0, 0, 0.2, 0, 0.3}};
    draw_robot(s, drawn[index][0], drawn[index][1]);
    s->bodies[s->nb - 1].name = "tip";
    if (index > 0) return;
    s->bodies[0] = gimbal;
    s->nb = 1;
    s->nq = s->nv = 3;
}

#endif
