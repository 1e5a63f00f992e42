/* The robots of the fuzzer's, with states, for fuzz.cpp. */
#include "chosen.h"

#include <string.h>

enum { MOST_BODIES = 4 /* else compilers take minutes */ };
static sample robot;
static sample_state state;

const rbd_body *drawn_robot(int class_number, int number, int limbs, int *nb);
const rbd_body *drawn_robot(int class_number, int number, int limbs, int *nb) {
    const int can_be_limb =
        class_number != FOLLOWERS && class_number != ALL; /* whose joints may follow others */
    const int most = limbs > 1 && can_be_limb ? MOST_BODIES / limbs : MOST_BODIES;
    draw_robot(&robot, class_number, number);
    if (robot.nb > most) robot.nb = most;
    if (limbs > 1 && can_be_limb) make_limbs(&robot, limbs);
    robot.bodies[robot.nb - 1].name = "tip";
    *nb = robot.nb;
    return robot.bodies;
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
