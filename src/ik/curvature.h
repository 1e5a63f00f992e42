#ifndef RBDI_IK_CURVATURE_H
#define RBDI_IK_CURVATURE_H
#include "ik/targets.h"

/* ---- curvature [curvature] ----
   The second derivative of |e|^2/2 beyond J'J; it counts where e does not vanish. With omega_i and v_i the
   columns of a target's Jacobian, dof i nearer to the root than dof j, as i < j, place and turn are

       d^2 p / dq_i dq_j = omega_i x v_j
       turn = omega_i q_i + omega_j q_j + (omega_i x omega_j) q_i q_j / 2

   For two dofs of one floating or planar joint, use the mean of both orders. What mimic joints add is left
   out.

   Let a turn of angle a about the unit vector n be left. A further turn w changes a^2/2 in second order by

       w' (n n' + c (1 - n n')) w / 2            c = (a/2) cot(a/2)

   because rotations are unit quaternions, on whose sphere angles are half as large, and on a unit sphere half
   the square of a distance x has the second derivative 1 along the way and x cot x across it. A direction s
   is a point of the unit sphere itself, and a turn about s does not change it:

       w' (n n' + c (1 - n n' - s s')) w / 2     c = a cot a

   The step from s by w is exp(w) s. Unless w is perpendicular to s, it is no great circle, and adds the term
   a (s'w) ((s x n)'w) / 2. The tests compare both with differences. Centres of mass are left out. */

/* The error of one target that is left, and what follows from it. */
typedef struct rbdi_ik_bend {
    rbdi_v3 place, turn; /* factor^2 times the error */
    rbdi_v3 n, s;        /* unit vectors, or 0 */
    rbdi_v3 side;        /* s x turn: of the term (s'w) ((s x n)'w) */
    rbd_real lack;       /* factor^2 (1 - c): what the Hessian lacks of J'J across n */
} rbdi_ik_bend;

/* x cot x, at least -1; x > 0. */
RBDI_LOCAL rbd_real rbdi_ik_cotangent(rbd_real x) {
    rbd_real s, c;
    rbdi_sincos(x, &s, &c);
    return x * c > -s ? x * c / s : rbdi_set(RBD_C(-1));
}

RBDI_LOCAL rbdi_ik_bend rbdi_ik_bend_of(const rbdi_ik *ik, const rbd_ik_target *t, int *row) {
    const rbd_real factor = rbdi_ik_factor(t);
    const rbd_real angular = factor * ik->options.length;
    rbdi_ik_bend b;

    b.place = b.turn = b.n = b.s = b.side = rbdi_vec0();
    b.lack = rbdi_zero();

    if (rbdi_ik_turns_body(t->kind) || t->kind == RBD_IK_AXIS) {
        const rbdi_v3 e = rbdi_load_vec(&ik->e[*row], 1);
        const rbd_real length = rbdi_sqrt(rbdi_dot(e, e));
        const rbd_real angle = length / angular;
        b.turn = rbdi_scale(angular, e);
        if (t->kind == RBD_IK_AXIS) b.s = rbdi_ik_axis(ik->m, ik->w, t->body, t->axis);
        b.side = rbdi_cross(b.s, b.turn);
        if (angle > RBDI_IK_STRAIGHT) {
            const rbd_real half = t->kind == RBD_IK_AXIS ? angle : RBD_C(0.5) * angle;
            b.n = rbdi_scale(RBD_C(1) / length, e);
            b.lack = angular * angular * (RBD_C(1) - rbdi_ik_cotangent(half));
        }
        *row += 3;
    }

    if (rbdi_ik_moves_point(t->kind)) b.place = rbdi_scale(factor, rbdi_load_vec(&ik->e[*row], 1));
    if (rbdi_ik_moves_point(t->kind) || t->kind == RBD_IK_COM) *row += 3;
    return b;
}

/* Term of the second derivative of place and turn, subtracted from H; dof i is nearer to the root. */
RBDI_INLINE rbd_real rbdi_ik_bent(const rbdi_ik_bend *b, const rbdi_motion *i, const rbdi_motion *j) {
    return rbdi_dot(b->place, rbdi_cross(i->omega, j->v)) +
           RBD_C(0.5) * rbdi_dot(b->turn, rbdi_cross(i->omega, j->omega));
}

/* Term of the second derivative of the angle, subtracted from H. */
RBDI_INLINE rbd_real rbdi_ik_lacking(const rbdi_ik_bend *b, rbdi_v3 i, rbdi_v3 j) {
    const rbd_real along = rbdi_dot(b->n, i) * rbdi_dot(b->n, j) + rbdi_dot(b->s, i) * rbdi_dot(b->s, j);
    const rbd_real side = rbdi_dot(b->s, i) * rbdi_dot(b->side, j) + rbdi_dot(b->s, j) * rbdi_dot(b->side, i);
    return b->lack * (rbdi_dot(i, j) - along) - RBD_C(0.5) * side;
}

/* Whether two dofs are of one joint whose dofs move together. */
RBDI_INLINE int rbdi_ik_together(const rbd_model *m, int i, int j) {
    const rbdi_frame *u = &m->frame[m->dof[i].body];
    return m->dof[i].body == m->dof[j].body && rbdi_is(&m->link[u->link], RBDI_BLOCK);
}

/* Takes the curvature of one target, whose Jacobian is in ik->columns, from H. */
RBDI_LOCAL void rbdi_ik_curve_of(rbdi_ik *ik, const rbdi_ik_bend *b) {
    const rbd_model *m = ik->m;
    rbd_real *H = ik->H;

    for (int r = 0; r < ik->dofs; ++r) {
        const int i = ik->dof[r].dof;
        const rbdi_motion one = rbdi_load_motion(&ik->columns[i], m->nv);

        for (int c = r; c < ik->dofs; ++c, ++H) {
            const int j = ik->dof[c].dof;
            const rbdi_motion two = rbdi_load_motion(&ik->columns[j], m->nv);
            rbd_real bent;

            if (rbdi_ik_together(m, i, j))
                bent = RBD_C(0.5) * (rbdi_ik_bent(b, &one, &two) + rbdi_ik_bent(b, &two, &one));
            else
                bent = rbdi_ik_bent(b, &one, &two);
            *H = *H - bent - rbdi_ik_lacking(b, one.omega, two.omega);
        }
    }
}

/* Takes the curvature of all targets from H, after rbdi_ik_normal. */
RBDI_LOCAL void rbdi_ik_curve(rbdi_ik *ik) {
    int row = 0;

    for (const rbd_ik_target *t = ik->target; t < ik->target + ik->n; ++t) {
        const rbdi_ik_bend b = rbdi_ik_bend_of(ik, t, &row);
        if (t->kind == RBD_IK_COM) continue;
        rbd_jacobian(ik->m, ik->w, t->body, t->point, RBD_WORLD_AXES, ik->columns);
        rbdi_ik_curve_of(ik, &b);
    }
}

#endif
