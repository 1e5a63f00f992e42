#ifndef RBDI_CONSTRAINTS_KINEMATICS_H
#define RBDI_CONSTRAINTS_KINEMATICS_H
#include "motion/kinematics.h"
#include "constraints/layout.h"

/* Interface: rbdi_add_held, rbdi_axes_held, rbdi_frame_origin, rbdi_relative_motion, rbdi_relative_motion_of,
   rbdi_set_axes */

/* ---- kinematics [kinematics] ---- */

/* Motion of a point fixed in a link, world axes: place, angular velocity, velocity, and their rates. */
typedef struct rbdi_station {
    rbdi_v3 p, omega, v, omega_dot, acc;
} rbdi_station;

/* Motion of the point of a link that is at p now. Link -1 is the world, which accelerates by -gravity where
   gravity is an acceleration of the world. */
RBDI_INLINE rbdi_station rbdi_station_at(const rbd_constraint_set *c, int link, rbdi_v3 p) {
    rbdi_station at;
    at.p = p;
    at.omega = at.v = at.omega_dot = rbdi_vec0();
    at.acc = c->world;

    if (link >= 0) {
        const rbdi_kin *kin = &c->w->kin[link];
        const rbdi_mat E = kin->X.E;
        const rbdi_v3 arm = rbdi_sub(p, kin->X.r);
        rbdi_v3 turn;

        /* v + omega x arm */
        at.omega = rbdi_mul_t(E, kin->state.omega);
        turn = rbdi_cross(at.omega, arm);
        at.v = rbdi_add(rbdi_mul_t(E, kin->v), turn);

        /* acc + omega_dot x arm + omega x (omega x arm) */
        at.omega_dot = rbdi_mul_t(E, kin->state.omega_dot);
        at.acc = rbdi_add(rbdi_mul_t(E, kin->state.acc), rbdi_cross(at.omega_dot, arm));
        at.acc = rbdi_add(at.acc, rbdi_cross(at.omega, turn));
    }
    return at;
}

/* Origin of a constraint's frame in the world. */
RBDI_INLINE rbdi_v3 rbdi_frame_origin(const rbd_constraint_set *c, const rbdi_constraint *con, int side) {
    const rbdi_v3 origin = rbdi_vec_c(con->position[side]);
    return con->link[side] < 0 ? origin : rbdi_point_p(&c->w->kin[con->link[side]], origin);
}

/* Motion of the bodies at the origin of frame 1. */
typedef struct rbdi_relative_motion {
    rbdi_station body[2];
    rbdi_motion velocity, rate; /* of body 1 relative to body 2, and its rate in axes that turn with body 2 */
} rbdi_relative_motion;

RBDI_ONCE rbdi_relative_motion rbdi_relative_motion_of(const rbd_constraint_set *c,
                                                       const rbdi_constraint *con) {
    const rbdi_v3 p = rbdi_frame_origin(c, con, 0);
    const rbdi_station one = rbdi_station_at(c, con->link[0], p);
    const rbdi_station two = rbdi_station_at(c, con->link[1], p);
    rbdi_relative_motion relative;
    relative.body[0] = one;
    relative.body[1] = two;
    relative.velocity.omega = rbdi_sub(one.omega, two.omega);
    relative.velocity.v = rbdi_sub(one.v, two.v);
    relative.rate.omega = rbdi_sub(one.omega_dot, two.omega_dot);
    relative.rate.v = rbdi_sub(one.acc, two.acc);

    /* axes that turn with body 2: alpha - omega_2 x w, acc - omega_2 x 2 u */
    if (con->link[1] >= 0) {
        relative.rate.omega = rbdi_sub(relative.rate.omega, rbdi_cross(two.omega, relative.velocity.omega));
        relative.rate.v = rbdi_sub(relative.rate.v,
                                   rbdi_cross(two.omega, rbdi_add(relative.velocity.v, relative.velocity.v)));
    }
    return relative;
}

/* Orientation of a constraint's frame in the world. */
RBDI_LOCAL rbdi_mat rbdi_frame_axes(const rbd_constraint_set *c, const rbdi_constraint *con, int side) {
    const rbdi_mat R = rbdi_mat_c(con->rotation[side]);
    return con->link[side] < 0 ? R : rbdi_mul_mat(rbdi_transpose(c->w->kin[con->link[side]].X.E), R);
}

/* The factor in the derivative of w = log R by the turn z of body 1, in the axes of z:

       z - w x z / 2 + factor w x (w x z),   factor = (1 - |w|/2 cot(|w|/2)) / |w|^2

   from the tails of sine and cosine in [steps code]. */
RBDI_LOCAL rbd_real rbdi_log_square(rbdi_v3 w) {
    const rbdi_exp e = rbdi_exp_of(w);
    const rbdi_mask near_zero = rbdi_less(e.x, rbdi_set(RBD_C(1)));
    const rbd_real c4 = rbdi_select(near_zero, rbdi_tail(rbdi_select(near_zero, e.x, rbdi_zero()), 4),
                                    (RBD_C(0.5) - e.B) / e.x);
    return (e.C - (c4 + c4)) / (e.B + e.B);
}

/* Angular part of the position error e, axes of frame 2: [conventions]. If two axes are held, it is f x R f
   with the free axis f. R: frame 1 seen from frame 2. */
RBDI_LOCAL rbdi_v3 rbdi_angular_error(const rbdi_constraint *con, rbdi_mat R) {
    const rbd_real o = rbdi_zero();
    int free;
    if (con->angular != 2) return rbdi_log_rotation(R);

    free = 3 - con->axis[0] - con->axis[1];
    if (free == 0) return rbdi_vec(o, -R.zx, R.yx);
    if (free == 1) return rbdi_vec(R.zy, o, -R.xy);
    return rbdi_vec(-R.yz, R.xz, o);
}

/* The axes that a constraint holds, world axes, rows as lanes: x, y, z of the axes of angular rows, then of
   linear rows; 0 where the row is of the other kind. */
typedef struct rbdi_axes_held {
    rbd_real axis[6][RBDI_SIX_ROWS];
} rbdi_axes_held;

RBDI_ONCE void rbdi_set_axes(const rbd_constraint_set *c, const rbdi_constraint *con, rbdi_axes_held *h) {
    const rbdi_batch zero = rbdi_all_lanes(rbdi_zero());
    for (int r = 0; r < con->rows; r += RBDI_BATCH)
        for (int i = con->angular ? 0 : 3; i < 6; ++i) *(rbdi_batch *)&h->axis[i][r] = zero;

    for (int r = 0; r < con->rows; ++r) {
        const int first = r < con->angular ? 0 : 3;
        rbdi_v3 axis =
            rbdi_vec(rbdi_set(con->held[0][r]), rbdi_set(con->held[1][r]), rbdi_set(con->held[2][r]));
        if (con->link[1] >= 0) axis = rbdi_mul_t(c->w->kin[con->link[1]].X.E, axis);

        h->axis[first][r] = axis.x;
        h->axis[first + 1][r] = axis.y;
        h->axis[first + 2][r] = axis.z;
    }
}

/* Makes the axis a of a single angular row the one whose product with a turn z of body 1 is the derivative of
   a . w, w = log R in world axes: a + w x a / 2 + factor w x (w x a), with the factor of rbdi_log_square. */
RBDI_LOCAL void rbdi_bend_axis(const rbd_constraint_set *c, const rbdi_constraint *con, rbdi_axes_held *h) {
    const rbdi_mat R = rbdi_frame_axes(c, con, 1);
    const rbdi_v3 log_R = rbdi_log_rotation(rbdi_mul_mat(rbdi_transpose(R), rbdi_frame_axes(c, con, 0)));
    const rbdi_v3 w = rbdi_mul(R, log_R);
    const rbdi_v3 a = rbdi_vec(h->axis[0][0], h->axis[1][0], h->axis[2][0]);
    const rbdi_v3 across = rbdi_cross(w, a);
    const rbdi_v3 more = rbdi_scale(rbdi_log_square(log_R), rbdi_cross(w, across));
    const rbdi_v3 bent = rbdi_add(rbdi_add(a, rbdi_scale(rbdi_set(RBD_C(0.5)), across)), more);

    h->axis[0][0] = bent.x;
    h->axis[1][0] = bent.y;
    h->axis[2][0] = bent.z;
}

/* Adds the components of (angular; linear), world axes, along the axes that a constraint holds. */
RBDI_ONCE void rbdi_add_held(const rbdi_constraint *con, const rbdi_axes_held *h, rbdi_v3 angular,
                             rbdi_v3 linear, rbd_real *out) {
    for (int r = 0; r < con->rows; r += RBDI_BATCH) {
        rbdi_batch sum = *(const rbdi_batch *)&out[r];

        sum = sum + *(const rbdi_batch *)&h->axis[3][r] * linear.x +
              *(const rbdi_batch *)&h->axis[4][r] * linear.y + *(const rbdi_batch *)&h->axis[5][r] * linear.z;
        if (con->angular)
            sum = sum + *(const rbdi_batch *)&h->axis[0][r] * angular.x +
                  *(const rbdi_batch *)&h->axis[1][r] * angular.y +
                  *(const rbdi_batch *)&h->axis[2][r] * angular.z;

        *(rbdi_batch *)&out[r] = sum;
    }
}

/* Adds gamma and J v of a constraint and, if `errors`, e. Returns the origin of frame 1 in the world. */
RBDI_ONCE rbdi_v3 rbdi_constraint_motion(rbd_constraint_set *c, const rbdi_constraint *con,
                                         const rbdi_axes_held *h, int errors) {
    const rbdi_relative_motion relative = rbdi_relative_motion_of(c, con);
    const rbdi_v3 p = relative.body[0].p;
    rbdi_add_held(con, h, relative.rate.omega, relative.rate.v, &c->gamma[con->row]);
    rbdi_add_held(con, h, relative.velocity.omega, relative.velocity.v, &c->velocity[con->row]);

    if (errors) {
        rbdi_v3 turn = rbdi_vec0();

        if (con->angular) {
            const rbdi_mat R = rbdi_frame_axes(c, con, 1);
            turn = rbdi_angular_error(con, rbdi_mul_mat(rbdi_transpose(R), rbdi_frame_axes(c, con, 0)));
            turn = rbdi_mul(R, turn);
        }

        rbdi_add_held(con, h, turn, rbdi_sub(p, rbdi_frame_origin(c, con, 1)), &c->e[con->row]);
    }
    return p;
}

#endif
