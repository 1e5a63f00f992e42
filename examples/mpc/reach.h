/* reach.h - the problem: the hand of an iiwa follows a target that goes round in a circle, with motors so
   weak that they limit how fast it gets there. For iiwa.c and, in float, for the firmware. SPDX-License-
   Identifier: MIT */
#ifndef REACH_H
#define REACH_H

#include <math.h>

#include "ilqr.h"
#include "models/iiwa_model.h"

#ifndef REACH_KNOTS
#define REACH_KNOTS 50
#endif
enum { REACH_N = REACH_KNOTS, REACH_NV = IIWA_NV, REACH_NZ = 3 * IIWA_NV };

typedef struct reach {
    const ilqr_problem *p;
    rbd_work *w;
    rbd_derivatives *d;
    rbd_real dt;
    rbd_real target[REACH_N + 1][3]; /* where the hand shall be at the knots, m */
    rbd_real hold[REACH_NV]; /* torque that holds the arm where it is now: what effort is measured from */
} reach;

static const rbd_real reach_hand[3] = {0, 0, RBD_C(0.1)};                 /* in the last link, m */
static const rbd_real reach_limit[REACH_NV] = {40, 80, 30, 40, 10, 8, 3}; /* N m */
static const rbd_real reach_least[REACH_NV] = {-40, -80, -30, -40, -10, -8, -3};
static const rbd_real reach_posture[REACH_NV] = {0, RBD_C(0.6), 0, RBD_C(-1.4), 0, RBD_C(1.1), 0}; /* rad */

/* Half the weights of the squares. */
static const rbd_real reach_near = 4000, reach_near_last = 40000; /* of the hand's distance, 1/m^2 */
static const rbd_real reach_home = 1;             /* of the distance from the posture, 1/rad^2 */
static const rbd_real reach_slow = RBD_C(0.3);    /* of the velocity, s^2/rad^2 */
static const rbd_real reach_effort = RBD_C(2e-4); /* of the torque beyond hold, 1/(N m)^2 */

/* Where the target is at a time, in world axes: a turn in two seconds. */
static inline void reach_target(rbd_real time, rbd_real target[3]) {
    const rbd_real angle = RBD_C(3.14159265358979) * time, radius = RBD_C(0.15);
    target[0] = RBD_C(0.55);
    target[1] = radius * (sizeof time > 4 ? (rbd_real)sin((double)angle) : (rbd_real)sinf((float)angle));
    target[2] = RBD_C(0.55) +
                radius * (sizeof time > 4 ? (rbd_real)cos((double)angle) : (rbd_real)cosf((float)angle));
}

/* Before each iteration: the target's places on the horizon that begins now, and the torque that holds q. */
static inline rbd_status reach_aim(reach *r, rbd_real time, const rbd_real *q) {
    for (int k = 0; k <= REACH_N; k++) reach_target(time + r->dt * (rbd_real)k, r->target[k]);
    return rbd_gravity_torque(&iiwa_model, r->w, q, r->hold);
}

static inline rbd_status reach_step(void *user, int k, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *u, rbd_real *v_next) {
    reach *r = (reach *)user;
    rbd_real a[REACH_NV];
    const rbd_status status = rbd_aba(&iiwa_model, r->w, q, v, u, NULL, a);
    (void)k;
    for (int i = 0; i < REACH_NV; i++) v_next[i] = v[i] + r->dt * a[i];
    return status;
}

/* f_z from derivatives of the acceleration: the rows are [dt da/dq, 1 + dt da/dv, dt da/dtau]. */
static inline rbd_status reach_derivatives(void *user, const rbd_real *q, const rbd_real *v,
                                           const rbd_real *u, rbd_real *f_z) {
    enum { n = REACH_NV };
    reach *r = (reach *)user;
    rbd_real da_dq[n * n], da_dv[n * n], Minv[n * n];
    rbd_status status = RBD_OK;
    for (int k = 0; k < REACH_N && status == RBD_OK; k++) {
        status = rbd_fd_derivatives(&iiwa_model, r->d, q + k * n, v + k * n, u + k * n, NULL, NULL, da_dq,
                                    da_dv, Minv);
        ilqr_accelerations(r->p, 0, r->dt, da_dq, da_dv, Minv, f_z + k * n * REACH_NZ);
    }
    return status;
}

static inline rbd_status reach_cost(void *user, int k, const rbd_real *q, const rbd_real *v,
                                    const rbd_real *u, rbd_real *l, rbd_real *l_z, rbd_real *l_zz) {
    enum { n = REACH_NV, nz = REACH_NZ };
    reach *r = (reach *)user;
    const rbd_real near = k < REACH_N ? reach_near : reach_near_last;
    rbd_real hand[3], error[3], J[6 * n], sum = 0;
    rbd_status status = rbd_kinematics(&iiwa_model, r->w, q, NULL, NULL);
    if (status == RBD_OK)
        status = rbd_point_position(&iiwa_model, r->w, IIWA_BODY_LBR_IIWA_LINK_7, reach_hand, hand);
    for (int i = 0; i < 3; i++) error[i] = hand[i] - r->target[k][i];
    sum += near * (error[0] * error[0] + error[1] * error[1] + error[2] * error[2]);
    for (int i = 0; i < n; i++) {
        const rbd_real away = q[i] - reach_posture[i], torque = u ? u[i] - r->hold[i] : 0;
        sum += reach_home * away * away + reach_slow * v[i] * v[i] + reach_effort * torque * torque;
        if (!l_z) continue;
        l_z[i] = reach_home * away, l_z[n + i] = reach_slow * v[i], l_z[2 * n + i] = reach_effort * torque;
        l_zz[i * nz + i] = reach_home, l_zz[(n + i) * (nz + 1)] = reach_slow;
        l_zz[(2 * n + i) * (nz + 1)] = u ? reach_effort : 0;
    }
    *l = sum / 2;
    if (!l_z || status != RBD_OK) return status;
    status = rbd_jacobian(&iiwa_model, r->w, IIWA_BODY_LBR_IIWA_LINK_7, reach_hand, RBD_WORLD_AXES, J);
    for (int c = 0; c < 3; c++) { /* Gauss-Newton: J' J of the rows of the hand's place */
        const rbd_real *row = J + (3 + c) * n;
        for (int i = 0; i < n; i++) {
            const rbd_real slope = near * row[i];
            l_z[i] += slope * error[c];
            for (int j = i; j < n; j++) l_zz[i * nz + j] += slope * row[j];
        }
    }
    return status;
}

#endif
