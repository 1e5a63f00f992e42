#ifndef RBDI_CONSTRAINTS_KINEMATICS_H
#define RBDI_CONSTRAINTS_KINEMATICS_H
#include "motion/kinematics.h"
#include "constraints/layout.h"

/* Interface: rbdi_add_held, rbdi_axes_held, rbdi_set_axes, rbdi_station, rbdi_station_at, rbdi_station_of */

/* ---- kinematics [kinematics] ---- */

/* A point fixed in a link, world axes: its place, angular velocity, velocity, and their rates. */
typedef struct rbdi_station {
    rbdi_v3 p, omega, v, omega_dot, acc;
} rbdi_station;

/* Motion of the point of a link that is at p. The world, link -1, accelerates by -gravity if the links do. */
RBDI_INLINE rbdi_station rbdi_station_at(const rbd_constraint_set *c, int link, rbdi_v3 p) {
    rbdi_station s;
    s.p = p;
    s.omega = s.v = s.omega_dot = rbdi_vec0();
    s.acc = c->world;
    if (link >= 0) {
        const rbdi_kin *k = &c->w->kin[link];
        const rbdi_v3 arm = rbdi_sub(p, k->X.r);
        rbdi_v3 turn;
        s.omega = rbdi_mul_t(k->X.E, k->state.omega);
        turn = rbdi_cross(s.omega, arm);
        s.v = rbdi_add(rbdi_mul_t(k->X.E, k->v), turn);
        s.omega_dot = rbdi_mul_t(k->X.E, k->state.omega_dot);
        s.acc = rbdi_add(rbdi_mul_t(k->X.E, k->state.acc), rbdi_cross(s.omega_dot, arm));
        s.acc = rbdi_add(s.acc, rbdi_cross(s.omega, turn));
    }
    return s;
}

/* Motion of the origin of a constraint's frame. */
RBDI_ONCE rbdi_station rbdi_station_of(const rbd_constraint_set *c, const rbdi_constraint *on, int side) {
    const rbdi_v3 x = rbdi_vec_c(on->p[side]);
    const int link = on->link[side];
    return rbdi_station_at(c, link, link < 0 ? x : rbdi_point_p(&c->w->kin[link], x));
}

/* Orientation of that frame in the world. */
static rbdi_mat rbdi_station_axes(const rbd_constraint_set *c, const rbdi_constraint *on, int side) {
    const rbdi_mat R = rbdi_mat_c(on->R[side]);
    return on->link[side] < 0 ? R : rbdi_mul_mat(rbdi_transpose(c->w->kin[on->link[side]].X.E), R);
}

/* log R, the rotation vector. Sums of R's entries give four multiples of its quaternion, each by one of its
   components. The one with the largest factor is accurate. */
static rbdi_v3 rbdi_log_rotation(rbdi_mat R) {
    const rbd_real one = rbdi_set(RBD_C(1)), o = rbdi_zero();
    const rbd_real x = R.zy - R.yz, y = R.xz - R.zx, z = R.yx - R.xy, xy = R.xy + R.yx, xz = R.xz + R.zx,
                   yz = R.yz + R.zy;
    const rbd_real multiple[4][4] = {{x, y, z, one + R.xx + R.yy + R.zz},
                                     {one + R.xx - R.yy - R.zz, xy, xz, x},
                                     {xy, one - R.xx + R.yy - R.zz, yz, y},
                                     {xz, yz, one - R.xx - R.yy + R.zz, z}};
    const rbd_real identity[4] = {o, o, o, one};
    rbd_real q[4], largest = multiple[0][3];
    for (int i = 0; i < 4; ++i) q[i] = multiple[0][i];
    for (int k = 1; k < 4; ++k) {
        const rbdi_mask more = rbdi_less(largest, multiple[k][k - 1]);
        largest = rbdi_select(more, multiple[k][k - 1], largest);
        for (int i = 0; i < 4; ++i) q[i] = rbdi_select(more, multiple[k][i], q[i]);
    }
    return rbdi_quaternion_difference(identity, q);
}

/* Angular part of the position error e, frame 2: [conventions]. */
static rbdi_v3 rbdi_angular_error(const rbdi_constraint *k, rbdi_mat R) {
    const rbd_real o = rbdi_zero();
    int free;
    if (k->angular != 2) return rbdi_log_rotation(R);
    free = 3 - k->axis[0] - k->axis[1];
    if (free == 0) return rbdi_vec(o, -R.zx, R.yx);
    if (free == 1) return rbdi_vec(R.zy, o, -R.xy);
    return rbdi_vec(-R.yz, R.xz, o);
}

/* The axes that a constraint holds, in world axes, with rows as lanes: the components of angular rows, then
   those of linear rows. */
typedef struct rbdi_axes_held {
    rbd_real x[6][RBDI_SIX_ROWS];
} rbdi_axes_held;

RBDI_ONCE void rbdi_set_axes(const rbd_constraint_set *c, const rbdi_constraint *k, rbdi_axes_held *h) {
    const rbdi_batch zero = rbdi_zero_batch();
    for (int r = 0; r < k->rows; r += RBDI_BATCH)
        for (int i = k->angular ? 0 : 3; i < 6; ++i) *(rbdi_batch *)&h->x[i][r] = zero;
    for (int r = 0; r < k->rows; ++r) {
        const rbdi_v3 a = rbdi_vec(rbdi_set(k->held[0][r]), rbdi_set(k->held[1][r]), rbdi_set(k->held[2][r])),
                      e = k->link[1] < 0 ? a : rbdi_mul_t(c->w->kin[k->link[1]].X.E, a);
        const int first = r < k->angular ? 0 : 3;
        h->x[first][r] = e.x, h->x[first + 1][r] = e.y, h->x[first + 2][r] = e.z;
    }
}

/* Adds the components of (angular; linear), world axes, along the axes that a constraint holds. */
RBDI_ONCE void rbdi_add_held(const rbdi_constraint *k, const rbdi_axes_held *h, rbdi_v3 angular,
                             rbdi_v3 linear, rbd_real *out) {
    for (int r = 0; r < k->rows; r += RBDI_BATCH) {
        rbdi_batch sum = *(const rbdi_batch *)&out[r];
        sum = sum + *(const rbdi_batch *)&h->x[3][r] * linear.x +
              *(const rbdi_batch *)&h->x[4][r] * linear.y + *(const rbdi_batch *)&h->x[5][r] * linear.z;
        if (k->angular)
            sum = sum + *(const rbdi_batch *)&h->x[0][r] * angular.x +
                  *(const rbdi_batch *)&h->x[1][r] * angular.y + *(const rbdi_batch *)&h->x[2][r] * angular.z;
        *(rbdi_batch *)&out[r] = sum;
    }
}

/* Adds gamma and J v of a constraint and, if `errors`, e. Returns the origin of frame 1 in the world. */
RBDI_ONCE rbdi_v3 rbdi_constraint_motion(rbd_constraint_set *c, const rbdi_constraint *k,
                                         const rbdi_axes_held *h, int errors) {
    const rbdi_station one = rbdi_station_of(c, k, 0), two = rbdi_station_of(c, k, 1);
    const rbdi_v3 s = rbdi_sub(one.p, two.p), w2 = two.omega;
    rbdi_v3 u = one.v, spin = one.omega, a = rbdi_sub(one.acc, two.acc), alpha = one.omega_dot;
    if (k->link[1] >= 0) {
        const rbdi_v3 ws = rbdi_cross(w2, s);
        u = rbdi_sub(rbdi_sub(u, two.v), ws);
        spin = rbdi_sub(spin, w2);
        alpha = rbdi_sub(alpha, two.omega_dot), a = rbdi_sub(a, rbdi_cross(two.omega_dot, s));
        alpha = rbdi_sub(alpha, rbdi_cross(w2, spin));
        a = rbdi_sub(a, rbdi_cross(w2, rbdi_add(ws, rbdi_add(u, u))));
    }
    rbdi_add_held(k, h, alpha, a, &c->gamma[k->row]);
    rbdi_add_held(k, h, spin, u, &c->u[k->row]);
    if (errors) {
        rbdi_v3 turn = rbdi_vec0();
        if (k->angular) {
            const rbdi_mat R = rbdi_station_axes(c, k, 1);
            turn = rbdi_angular_error(k, rbdi_mul_mat(rbdi_transpose(R), rbdi_station_axes(c, k, 0)));
            turn = rbdi_mul(R, turn);
        }
        rbdi_add_held(k, h, turn, s, &c->e[k->row]);
    }
    return one.p;
}

#endif
