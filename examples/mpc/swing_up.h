/* swing_up.h - the problem: a pole hangs from a cart whose motor is too weak to push it up at once. For
   cart_pole.c and, in float, for the firmware. SPDX-License-Identifier: MIT */
#ifndef SWING_UP_H
#define SWING_UP_H

#include "ilqr.h"
#include "models/cart_pole_model.h"

#ifndef SWING_UP_KNOTS
#define SWING_UP_KNOTS 100
#endif
enum { SWING_UP_N = SWING_UP_KNOTS, SWING_UP_NV = CART_POLE_NV, SWING_UP_NU = 1, SWING_UP_NZ = 5 };

typedef struct swing_up {
    const ilqr_problem *p;
    rbd_work *w;
    rbd_derivatives *d;
} swing_up;

static const rbd_real swing_up_most = 10, swing_up_least = -10; /* N */
static const rbd_real swing_up_angle = RBD_C(3.14159265358979324);

/* Weights of the squares, halved: of the place on the rail, the angle, both velocities; the force. */
static const rbd_real swing_up_running[4] = {RBD_C(0.1), RBD_C(0.1), RBD_C(0.01), RBD_C(0.01)},
                      swing_up_last[4] = {500, 500, 50, 50};
static const rbd_real swing_up_effort = RBD_C(0.001);

/* v_next = v + dt a: the motor drives the cart, not the hinge. */
static inline rbd_status swing_up_step(void *user, int k, const rbd_real *q, const rbd_real *v,
                                       const rbd_real *u, rbd_real *v_next) {
    const swing_up *x = (const swing_up *)user;
    const rbd_real tau[SWING_UP_NV] = {u[0], 0};
    rbd_real a[SWING_UP_NV];
    const rbd_status status = rbd_aba(&cart_pole_model, x->w, q, v, tau, NULL, a);
    for (int i = 0; i < SWING_UP_NV; i++) v_next[i] = v[i] + x->p->dt[k] * a[i];
    return status;
}

static inline rbd_status swing_up_derivatives(void *user, const rbd_real *q, const rbd_real *v,
                                              const rbd_real *u, rbd_real *f_z) {
    enum { n = SWING_UP_NV };
    const swing_up *x = (const swing_up *)user;
    rbd_status status = RBD_OK;
    for (int k = 0; k < SWING_UP_N && status == RBD_OK; k++, q += n, v += n, f_z += n * SWING_UP_NZ) {
        const rbd_real tau[n] = {u[k], 0};
        rbd_real da_dq[n * n], da_dv[n * n], Minv[n * n];
        status = rbd_fd_derivatives(&cart_pole_model, x->d, q, v, tau, NULL, NULL, da_dq, da_dv, Minv);
        ilqr_accelerations(x->p, 0, x->p->dt[k], da_dq, da_dv, Minv, f_z);
    }
    return status;
}

/* Half the weighted squares of what is not upright, at the middle of the rail and still, and of the force. */
static inline rbd_status swing_up_cost(void *user, int k, const rbd_real *q, const rbd_real *v,
                                       const rbd_real *u, rbd_real *l, rbd_real *l_z, rbd_real *l_zz) {
    const rbd_real z[SWING_UP_NZ] = {q[CART_POLE_Q_RAIL], q[CART_POLE_Q_HINGE] - swing_up_angle, v[0], v[1],
                                     u ? u[0] : 0};
    const rbd_real *weights = k < SWING_UP_N ? swing_up_running : swing_up_last;
    (void)user;
    *l = 0;
    for (int i = 0; i < SWING_UP_NZ; i++) {
        const rbd_real weight = i < 4 ? weights[i] : u ? swing_up_effort : 0;
        *l += weight * z[i] * z[i] / 2;
        if (l_z) l_z[i] = weight * z[i], l_zz[i * (SWING_UP_NZ + 1)] = weight;
    }
    return RBD_OK;
}

#endif
