#ifndef RBDI_ACTUATOR_SEARCH_H
#define RBDI_ACTUATOR_SEARCH_H
#include "actuator/laws.h"

/* ---- search [search] ----
   The way from the points of the shafts to new speeds, `next`, where the joints ask for `force`. */

/* Slope of the function of [method] at the share c of the way. */
RBDI_LOCAL rbd_real rbdi_act_growth(const rbd_actuators *a, rbd_real c) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real d = s->next - s->point;
        const rbd_real x = s->point + c * d;
        const rbd_real T = s->base + c * (s->force - s->base);
        sum = sum + (T - rbdi_act_law_at(&a->motor[i], s, x, a)) * d;
    }
    return sum;
}

/* Whether the function grows at the new speeds by a quarter of what it falls at the points. */
RBDI_LOCAL int rbdi_act_overshoots(const rbd_actuators *a) {
    const rbd_real falls = -rbdi_act_growth(a, rbdi_zero());
    return falls > 0 && rbdi_act_growth(a, rbdi_set(RBD_C(1))) > RBD_C(0.25) * falls;
}

/* The share of the way at which the function is least. */
RBDI_LOCAL rbd_real rbdi_act_least(const rbd_actuators *a) {
    rbd_real least = rbdi_zero(), most = rbdi_set(RBD_C(1));
    const rbd_real half = rbdi_set(RBD_C(0.5));
    for (int k = 0; k < RBDI_ACTUATOR_HALVINGS; ++k) {
        const rbd_real middle = half * (least + most);
        if (rbdi_act_growth(a, middle) > 0)
            most = middle;
        else
            least = middle;
    }
    return half * (least + most);
}

/* Moves the points to the new speeds or, where `searches` and the function grows there, to where it is least
   on the way. */
RBDI_LOCAL void rbdi_act_move_points(rbd_actuators *a, int searches) {
    const int stops = searches && rbdi_act_overshoots(a);
    const rbd_real share = stops ? rbdi_act_least(a) : rbdi_zero();
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        s->base = stops ? s->base + share * (s->force - s->base) : s->force;
        s->point = stops ? s->point + share * (s->next - s->point) : s->next;
    }
}

#endif
