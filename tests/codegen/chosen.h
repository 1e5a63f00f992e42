/* chosen.h - the robots of these tests: small ones that together have every joint type, joints that mimic
   others, merged bodies, several roots and axes at right angles. Gimbal lock makes the first singular. The
   last two have like limbs. */
#ifndef CHOSEN_H
#define CHOSEN_H

#include "../fuzz/robots.h"

enum { CHOSEN = 10 };

/* The robot becomes `count` limbs of a floating base: alike but for constants, every other one mirrored. */
static void make_limbs(sample *s, int count) {
    static const rbd_body base = {.name = "base",
                                  .parent = -1,
                                  .type = RBD_FLOATING,
                                  .mass = 5,
                                  .inertia = {0.5, 0.01, 0.02, 0.6, 0.03, 0.7}};
    const sample limb = *s;
    s->bodies[0] = base;
    s->nb = 1;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < limb.nb; i++) {
            rbd_body *b = &s->bodies[s->nb++];
            const double mirror = k % 2 ? -1 : 1;
            *b = limb.bodies[i];
            b->name = b->joint = NULL;
            b->parent = b->parent < 0 ? 0 : b->parent + 1 + k * limb.nb;
            b->position[1] *= mirror;
            b->axis[1] *= mirror, b->com[1] *= mirror;
            b->mass *= k < 2 ? 1 : 1.25;
            s->mass[s->nb - 1] = s->length[s->nb - 1] = 1;
        }
    s->nq = 7 + count * limb.nq, s->nv = 6 + count * limb.nv;
}

static void choose_robot(sample *s, int index) {
    static const int drawn[CHOSEN][2] = {{ORDINARY, 0},   {AXES, 49},      {FOLLOWERS, 8}, {TURNED, 399},
                                         {ORDINARY, 391}, {ORDINARY, 133}, {FAR, 268},     {ORDINARY, 318},
                                         {TURNED, 399},   {ORDINARY, 133}};
    static const rbd_body gimbal = {.name = "tip",
                                    .joint = "gimbal",
                                    .parent = -1,
                                    .type = RBD_EULER_ZYX,
                                    .mass = 1,
                                    .inertia = {0.1, 0, 0, 0.2, 0, 0.3}};
    draw_robot(s, drawn[index][0], drawn[index][1]);
    if (index >= 8) make_limbs(s, index == 8 ? 4 : 2);
    s->bodies[s->nb - 1].name = "tip";
    if (index > 0) return;
    s->bodies[0] = gimbal;
    s->nb = 1;
    s->nq = s->nv = 3;
}

#endif
