/* The chosen robots for write.cpp. */
#include "chosen.h"

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
