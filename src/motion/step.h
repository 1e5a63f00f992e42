#ifndef RBDI_MOTION_STEP_H
#define RBDI_MOTION_STEP_H
#include "motion/manifold.h"

/* Interface: rbdi_motion_of_point, rbdi_move_joints, rbdi_straight_acceleration, rbdi_straight_point,
   rbdi_turn_back, RBDI_CENTRES, RBDI_ORIGINS */

/* ---- steps of joints [straight moves] ----
   A body that floats, or moves on a plane, has a point that moves straight while the body turns: with the
   velocity V = (omega; v) of its origin, the point c of the body has v + omega x c, and after dt

       q_next   turned by dt omega, with c moved by dt (v + omega x c)
       v_next   the world velocities of c and of the turn, in the axes of q_next

   rbd_step moves the origin straight, c = 0. Steps of second order move the centre of mass: as nothing
   accelerates it in free flight, linear momentum of a body stays to rounding, and no result depends on where
   the origin is in the body. */

/* Which points of bodies move straight. */
enum { RBDI_ORIGINS, RBDI_CENTRES };

/* That point in body axes: the centre of mass of the link, with the masses that regrouping moved to it. It
   counts only for joints that turn freely. u: the frame of a body with dofs of its own. */
RBDI_INLINE rbdi_v3 rbdi_straight_point(const rbd_model *m, const rbdi_frame *u, int points) {
    const rbdi_link *l;
    rbd_real inverse;
    if (points == RBDI_ORIGINS) return rbdi_vec0();
    l = &m->link[u->link];
    if (!(l->mass > 0)) return rbdi_vec0();

    /* E (h / mass - r) */
    inverse = rbdi_set(1 / l->mass);
    return rbdi_mul(rbdi_mat_c(u->E), rbdi_sub(rbdi_scale(inverse, rbdi_vec_c(l->h)), rbdi_vec_c(u->r)));
}

/* The motion of the body's point c in place of that of its origin, and back with -c. */
RBDI_INLINE rbdi_motion rbdi_motion_of_point(rbdi_motion V, rbdi_v3 c) {
    V.v = rbdi_add(V.v, rbdi_cross(V.omega, c));
    return V;
}

/* The vector r turned by -turn: r - A turn x r + B turn x (turn x r). */
RBDI_LOCAL rbdi_v3 rbdi_turn_back(rbdi_exp e, rbdi_v3 turn, rbdi_v3 r) {
    const rbdi_v3 across = rbdi_cross(turn, r);
    const rbdi_v3 inward = rbdi_cross(turn, across);
    r = rbdi_sub(r, rbdi_scale((e.half_sine + e.half_sine) * e.half_cosine, across));
    return rbdi_add(r, rbdi_scale(e.B, inward));
}

/* Moves one joint that turns: q by `moved` for dt with its point c straight, and nu to the axes of the end.
   With turn = dt omega and exp(turn) c = c + S, S the shift of a screw (turn; turn x c), the origin moves by

       dt v + turn x c - S */
RBDI_LOCAL void rbdi_move_turning(const rbdi_frame *u, rbdi_v3 c, const rbd_real *q, const rbd_real *moved,
                                  const rbd_real *nu, rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    const rbdi_motion V = rbdi_joint_motion(u, moved, 1);
    const rbdi_v3 turn = rbdi_scale(dt, V.omega), across = rbdi_cross(turn, c);
    const rbdi_exp e = rbdi_exp_of(turn);
    const rbdi_v3 shift = rbdi_sub(across, rbdi_exp_shift(e, turn, across));
    rbdi_motion end = rbdi_motion_of_point(rbdi_joint_motion(u, nu, 1), c);

    rbdi_turn_joint(u, q, e, turn, rbdi_add(rbdi_scale(dt, V.v), shift), q_next);

    end.omega = rbdi_turn_back(e, turn, end.omega);
    end.v = rbdi_turn_back(e, turn, end.v);
    rbdi_put_joint_motion(u, rbdi_motion_of_point(end, rbdi_sub(rbdi_vec0(), c)), v_next, 1);
}

/* Moves all joints, for a scheme of its own: q by `moved` for dt, and nu to the axes of the end. points:
   RBDI_ORIGINS or RBDI_CENTRES move straight. An output may be the input of its name. */
RBDI_PART void rbdi_move_joints(const rbd_model *m, int points, const rbd_real *q, const rbd_real *moved,
                                const rbd_real *nu, rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        if (u->nv == 1 && u->nq == 1) { /* the most */
            q_next[u->iq] = q[u->iq] + moved[u->iv] * dt;
            v_next[u->iv] = nu[u->iv];
        } else if (rbdi_joint_turns(u)) {
            rbdi_move_turning(u, rbdi_straight_point(m, u, points), &q[u->iq], &moved[u->iv], &nu[u->iv], dt,
                              &q_next[u->iq], &v_next[u->iv]);
        } else if (u->nv > 0) {
            rbd_real d[6];
            for (int k = 0; k < u->nv; ++k) d[k] = moved[u->iv + k] * dt;
            for (int k = u->iv; k < u->iv + u->nv; ++k) v_next[k] = nu[k];
            rbdi_step_joint(u, &q[u->iq], d, &q_next[u->iq]);
        }
    }
}

/* a by which these points move straight and turns keep their axis: the linear part is
   (v + omega x c) x omega, all else 0. a: 0 before, but where this call writes. */
RBDI_PART void rbdi_straight_acceleration(const rbd_model *m, int points, const rbd_real *v, rbd_real *a) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        rbdi_motion V;
        if (!rbdi_joint_turns(u)) continue;
        V = rbdi_motion_of_point(rbdi_joint_motion(u, &v[u->iv], 1), rbdi_straight_point(m, u, points));
        V.v = rbdi_cross(V.v, V.omega);
        V.omega = rbdi_vec0();
        rbdi_put_joint_motion(u, V, &a[u->iv], 1);
    }
}

/* v of one joint after dt if a is 0, in the axes of the step's beginning: linear velocities in body axes
   gain dt omega x v, the others stay. */
RBDI_LOCAL void rbdi_unforced_velocity(const rbdi_frame *u, const rbd_real *v, rbd_real dt, rbd_real *nu) {
    rbdi_motion V;
    for (int k = 0; k < u->nv; ++k) nu[k] = v[k];
    if (!rbdi_joint_turns(u)) return;
    V = rbdi_joint_motion(u, v, 1);
    V.v = rbdi_add(V.v, rbdi_scale(dt, rbdi_cross(V.omega, V.v)));
    rbdi_put_joint_motion(u, V, nu, 1);
}

RBDI_API rbd_status rbd_step(const rbd_model *m, const rbd_real *q, const rbd_real *v, const rbd_real *a,
                             rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    if (!m || !q || !v || !a || !q_next || !v_next) return RBD_ERR_NULL;

    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        rbd_real nu[6];
        if (u->nv == 0) continue;
        rbdi_unforced_velocity(u, &v[u->iv], dt, nu);
        for (int k = 0; k < u->nv; ++k) v_next[u->iv + k] = nu[k] + dt * a[u->iv + k];
    }
    rbdi_move_joints(m, RBDI_ORIGINS, q, v_next, v_next, dt, q_next, v_next);
    return RBD_OK;
}

#endif
