/* The chosen robots for write.cpp; random ones, with constraints, motors and states, for fuzz.cpp. */
#include "chosen.h"

#include <string.h>

const rbd_body *chosen_robot(int index, int *nb, const rbd_constraint **constraints, int *nc,
                             unsigned char **actuated, int *nv);
const rbd_body *chosen_robot(int index, int *nb, const rbd_constraint **constraints, int *nc,
                             unsigned char **actuated, int *nv) {
    static sample s;
    static rbd_constraint list[4];
    static unsigned char motors[WORLD_DOFS];
    choose_robot(&s, index);
    *nb = s.nb;
    *nc = choose_constraints(&s, index, list);
    *constraints = list;
    choose_motors(&s, motors);
    *actuated = motors;
    *nv = s.nv;
    return s.bodies;
}

/* ---- random ones ---- */

enum { MOST_BODIES = 3 /* else compilers take minutes */ };
static sample robot;
static sample_state state;

/* The first bodies of the robot; none that moves may be without mass at a tip. */
static void cut(int most) {
    int carries[WORLD_BODIES] = {0};
    if (robot.nb <= most) return;
    robot.nb = most;
    for (int i = most - 1; i >= 0; i--) {
        rbd_body *b = &robot.bodies[i];
        if (b->parent >= 0) carries[b->parent] = 1;
        if (carries[i] || b->mass > 0) continue;
        b->mass = robot.mass[i];
        b->inertia[0] = b->inertia[3] = b->inertia[5] = robot.mass[i] * robot.length[i] * robot.length[i];
    }
}

/* Of a robot whose joints are all fixed the last one turns. */
static void let_one_move(void) {
    rbd_body *last = &robot.bodies[robot.nb - 1];
    int nv = 0;
    for (int i = 0; i < robot.nb; i++) nv += world_nv(&robot.bodies[i]);
    if (nv > 0) return;
    last->type = RBD_REVOLUTE;
    last->axis[2] = 1;
    if (last->mass <= 0) last->mass = robot.mass[robot.nb - 1];
}

const rbd_body *drawn_robot(int class_number, int number, int limbs, int *nb);
const rbd_body *drawn_robot(int class_number, int number, int limbs, int *nb) {
    const int can_be_limb =
        class_number != FOLLOWERS && class_number != ALL; /* whose joints may follow others */
    draw_robot(&robot, class_number, number);
    cut(limbs > 1 && can_be_limb ? 1 : MOST_BODIES);
    let_one_move();
    if (limbs > 1 && can_be_limb) make_limbs(&robot, limbs);
    robot.bodies[robot.nb - 1].name = "tip";
    *nb = robot.nb;
    return robot.bodies;
}

/* Of the robot drawn last, as the chosen ones have them. */
const rbd_constraint *drawn_constraints(int number, int *nc);
const rbd_constraint *drawn_constraints(int number, int *nc) {
    static rbd_constraint list[4];
    *nc = choose_constraints(&robot, number % FIRST_WITH_LIMBS, list);
    return list;
}
const unsigned char *drawn_motors(void);
const unsigned char *drawn_motors(void) {
    static unsigned char motors[WORLD_DOFS];
    choose_motors(&robot, motors);
    return motors;
}

void drawn_state(void);
void drawn_state(void) { draw_state(&robot, &state); }

/* An argument in that state; NULL for one that has none. */
const double *drawn_input(const char *name);
const double *drawn_input(const char *name) {
    const struct {
        const char *name;
        const double *x;
    } all[] = {{"q", state.q},     {"v", state.v},         {"a", state.a},
               {"tau", state.tau}, {"f_ext", state.f_ext}, {"gravity", state.gravity}};
    for (int k = 0; k < (int)(sizeof all / sizeof *all); k++)
        if (strcmp(name, all[k].name) == 0) return all[k].x;
    return NULL;
}
