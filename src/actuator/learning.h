#ifndef RBDI_ACTUATOR_LEARNING_H
#define RBDI_ACTUATOR_LEARNING_H
#include "actuator/motor.h"

/* ---- learning [learning] ----
   Each repeat tells a change d of the shafts' speeds and the impulse y that made it: M d = y. M is corrected
   by BFGS (Nocedal and Wright 2006, section 6.1):

       M + y y' / (y'd) - M d (M d)' / (d'M d)

   Pairs of the same step are made conjugate first: d less what the pairs before it, d_k and y_k, have of it,

       d - sum d_k (y_k'd) / (y_k'd_k),   y - sum y_k (y_k'd) / (y_k'd_k)

   Then a correction keeps M d_k = y_k, so that after n of them M is exact where the joints' motion is linear,
   and it stays positive definite (Schnabel 1983, Quasi-Newton methods using multiple secant equations). */

RBDI_INLINE rbd_real rbdi_act_dot(const rbd_real *x, const rbd_real *y, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + x[i] * y[i];
    return sum;
}

/* A first guess of the mass, a diagonal in kg m^2: the impulse of the step over the largest change of speed
   that it can have made. No pair tells of it. The least torque, 1e-3 N m, keeps it above 0. */
RBDI_LOCAL void rbdi_act_guess_mass(rbd_actuators *a) {
    for (int i = 0; i < a->n * a->n; ++i) a->mass[i] = rbdi_zero();
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real change = rbdi_abs(s->x) + rbdi_abs(s->next) + a->dt; /* by 1 rad/s^2 at least */
        const rbd_real torque = rbdi_abs(s->force) + s->level + RBD_C(1e-3);
        a->mass[(a->n + 1) * i] = a->dt * torque / change + rbdi_act_rotor_inertia(&a->motor[i]);
    }
    a->pairs = 0;
    a->known = 1;
}

/* Adds factor x x' to M. */
RBDI_LOCAL void rbdi_act_add_square(rbd_actuators *a, rbd_real factor, const rbd_real *x) {
    for (int i = 0; i < a->n; ++i)
        for (int j = 0; j < a->n; ++j) a->mass[a->n * i + j] = a->mass[a->n * i + j] + factor * x[i] * x[j];
}

/* a->solution = M d. */
RBDI_LOCAL void rbdi_act_mass_times(const rbd_actuators *a, const rbd_real *d) {
    for (int i = 0; i < a->n; ++i) a->solution[i] = rbdi_act_dot(a->mass + a->n * i, d, a->n);
}

/* The pair (d, y) of the last repeat. */
RBDI_LOCAL void rbdi_act_take_pair(const rbd_actuators *a, rbd_real *d, rbd_real *y) {
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        d[i] = s->next - s->seen_x;
        y[i] = a->dt * (s->force - s->seen_T);
    }
}

/* Makes the pair (d, y) conjugate to those before it. */
RBDI_LOCAL void rbdi_act_conjugate(const rbd_actuators *a, rbd_real *d, rbd_real *y) {
    const int n = a->n;
    for (int k = 0; k < a->pairs; ++k) {
        const rbd_real *d_k = a->pair + 2 * n * k;
        const rbd_real *y_k = d_k + n;
        const rbd_real share = rbdi_act_dot(y_k, d, n) / rbdi_act_dot(y_k, d_k, n);
        for (int i = 0; i < n; ++i) {
            d[i] = d[i] - share * d_k[i];
            y[i] = y[i] - share * y_k[i];
        }
    }
}

/* If the speeds should have changed by d and did not, but for rounding, the mass there is ten times as large
   at least: M + 9 M d (M d)' / (d'M d). */
RBDI_LOCAL void rbdi_act_stiffen(rbd_actuators *a) {
    rbd_real *d = a->pair, work;
    a->pairs = 0;
    for (int i = 0; i < a->n; ++i) d[i] = a->shaft[i].point - a->shaft[i].seen_x;
    rbdi_act_mass_times(a, d);
    work = rbdi_act_dot(d, a->solution, a->n);
    if (work > 0) rbdi_act_add_square(a, 9 / work, a->solution);
}

/* Corrects the mass by the last repeat. Pairs before it are forgotten if it tells nothing that they did not,
   which is so where the joints' motion is not linear. */
RBDI_LOCAL void rbdi_act_learn(rbd_actuators *a) {
    const int n = a->n;
    rbd_real *d = a->pair + 2 * n * a->pairs;
    rbd_real *y = d + n;
    rbd_real work, square;
    rbdi_act_take_pair(a, d, y);
    work = rbdi_act_dot(d, y, n);
    if (!(rbdi_act_dot(d, d, n) > RBDI_ACTUATOR_ACROSS * a->speed_rounding * a->speed_rounding) ||
        !(work > 0)) {
        rbdi_act_stiffen(a);
        return;
    }

    rbdi_act_conjugate(a, d, y);
    if (!(rbdi_act_dot(d, y, n) > RBDI_ACTUATOR_TELLING * work)) {
        a->pairs = 0;
        d = a->pair;
        y = d + n;
        rbdi_act_take_pair(a, d, y);
    }

    rbdi_act_mass_times(a, d);
    square = rbdi_act_dot(d, a->solution, n);
    rbdi_act_add_square(a, 1 / rbdi_act_dot(d, y, n), y);
    rbdi_act_add_square(a, -1 / square, a->solution);
    a->pairs = (a->pairs + 1) % n;
}

/* Guesses for the next step the torque that the joints ask for at the speeds of its beginning: that of this
   step's beginning. */
RBDI_LOCAL void rbdi_act_foresee(rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->base = s->force;
        for (int k = 0; k < a->n; ++k)
            s->base = s->base - a->mass[a->n * i + k] / a->dt * (a->shaft[k].next - a->shaft[k].x);
    }
}

#endif
