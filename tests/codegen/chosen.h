/* chosen.h - the robots of these tests: small ones that together have every joint type, joints that mimic
   others, merged bodies, several roots and axes at right angles. Gimbal lock makes the first singular. The
   last two have like limbs. Each has constraints. */
#ifndef CHOSEN_H
#define CHOSEN_H

#include "../fuzz/robots.h"
#include "rbd_constraints.h"

#include <math.h>
#include <string.h>

enum { CHOSEN = 10, FIRST_WITH_LIMBS = 8, HELD_TWICE = 4 /* has one constraint twice */ };

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

/* A rotation about a random axis, by Rodrigues' formula with cos = 0.6, sin = 0.8. */
static void draw_rotation(uint64_t *seed, double R[9]) {
    double u[3], square = 0;
    for (int i = 0; i < 3; i++) u[i] = uniform(seed, 0.1, 1), square += u[i] * u[i];
    for (int i = 0; i < 9; i++) R[i] = (i % 4 ? 0 : 0.6) + 0.4 * u[i / 3] * u[i % 3] / square;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double x = 0.8 * u[k] / sqrt(square);
        R[3 * i + j] -= x, R[3 * j + i] += x;
    }
}

/* Returns how many: the tip on the world, another body on the world, with all kinds of axes and with gains.
   The last two robots have kp of one or three turns, which is not reproducible. */
static int choose_constraints(const sample *s, int index, rbd_constraint list[4]) {
    static const int axes[][6] = {{0, 0, 0, 0, 1, 1}, {0, 0, 0, 1, 1, 1}, {0, 1, 0, 0, 0, 0},
                                  {0, 0, 0, 0, 0, 1}, {1, 1, 1, 0, 0, 0}, {1, 1, 0, 1, 0, 1},
                                  {0, 0, 1, 0, 0, 1}};
    static const int held[CHOSEN][2] = {{0},    {1, 2}, {2, 3}, {2, 3}, {0, 2},
                                        {5, 6}, {3},    {0, 1}, {1, 4}, {2, 4}};
    uint64_t seed = (uint64_t)index + 1;
    const int n = s->nv < 5 ? 1 : 2;
    memset(list, 0, 4 * sizeof *list);
    for (int k = 0; k < n; k++) {
        rbd_constraint *x = &list[k];
        x->body1 = k == 0 ? s->nb - 1 : -1;
        x->body2 = k == 0 ? -1 : s->nb / 2;
        for (int i = 0; i < 3; i++)
            x->position1[i] = uniform(&seed, -1, 1), x->position2[i] = uniform(&seed, -1, 1);
        if (index % 2) draw_rotation(&seed, x->rotation1);
        draw_rotation(&seed, x->rotation2);
        memcpy(x->axes, axes[held[index][k]], sizeof x->axes);
        if ((index + k) % 2) x->kp = x->axes[0] != x->axes[1] && index < 8 ? 0 : 30, x->kd = 5;
    }
    if (index == HELD_TWICE) list[n] = list[0];
    return n + (index == HELD_TWICE);
}

/* Every third dof has no motor. */
static void choose_motors(const sample *s, unsigned char *actuated) {
    for (int k = 0; k < s->nv; k++) actuated[k] = k % 3 != 0;
}

#endif
