#ifndef RBDI_TASKS_ROWS_H
#define RBDI_TASKS_ROWS_H
#include "ik/step.h"
#include "qp/vectors.h"
#include "tasks/check.h"
#include "tasks/contacts.h"

/* ---- rows of tasks [rows of tasks] ---- */

/* A task at the present state: its Jacobian is k->J, of which the rows of its kind count. */
typedef struct rbdi_tasks_error {
    rbdi_motion e;               /* from where it is to where it shall be */
    rbdi_motion drift;           /* dJ/dt v */
    rbd_real stiffness, damping; /* 1/s^2 or 1/s; 1/s */
} rbdi_tasks_error;

/* Momentum of the robot for each unit velocity, about its centre of mass, world axes: k->J. A dof moves a
   body with a velocity v of its centre of mass, at r from that of the robot, and omega: it adds m v, and
   R I R' omega + r x m v. */
RBDI_LOCAL void rbdi_tasks_put_momentum(rbdi_tasks *k) {
    const rbd_model *m = k->m;
    rbd_real centre[3] = {0, 0, 0};
    rbd_com(m, k->w, centre, NULL, NULL);
    rbdi_clear(k->J, 6 * k->nv);

    for (int body = 0; body < m->nb; ++body) {
        const rbdi_frame *u = &m->frame[body];
        const rbdi_sym I = rbdi_sym_c(u->I);
        rbdi_mat E;
        rbdi_v3 p, r;
        if (u->link < 0) continue;

        E = rbdi_axes_of(m, k->w, body);
        p = rbdi_ik_body_com(m, k->w, u);
        r = rbdi_sub(p, rbdi_load_vec(centre, 1));

        for (int i = u->link; i >= 0; i = m->link[i].parent) {
            const rbdi_link *l = &m->link[i];
            for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
                const rbdi_motion c = rbdi_column(m, k->w, i, j, p);
                const rbd_real ratio = rbdi_ratio(m, l->iv + j);
                rbd_real *to = &k->J[rbdi_source(m, l->iv + j)];
                rbdi_force h = rbdi_load_force(to, k->nv);
                const rbdi_v3 f = rbdi_scale(ratio * u->mass, c.v);
                const rbdi_v3 spin = rbdi_mul_t(E, rbdi_mul_sym(I, rbdi_mul(E, c.omega)));

                h.f = rbdi_add(h.f, f);
                h.n = rbdi_add(h.n, rbdi_add(rbdi_scale(ratio, spin), rbdi_cross(r, f)));
                rbdi_store_force(to, k->nv, h);
            }
        }
    }
}

/* Momentum, which has no place. */
RBDI_LOCAL void rbdi_tasks_of_momentum(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    rbd_real h_dot[6] = {0};

    rbdi_tasks_put_momentum(k);
    rbd_momentum(k->m, k->w, NULL, h_dot);
    s->drift = rbdi_load_motion(h_dot, 1);
    s->stiffness = rbdi_zero();
    s->damping = t->gain;
}

/* The centre of mass. */
RBDI_LOCAL void rbdi_tasks_of_com(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    rbd_real com[3] = {0}, a[3] = {0};

    rbdi_ik_com_jacobian(k->m, k->w, rbd_mass(k->m), k->w->F, &k->J[3 * k->nv]);
    rbd_com(k->m, k->w, com, NULL, a);
    s->e.v = rbdi_ik_way(t->position, rbdi_load_vec(com, 1));
    s->drift.v = rbdi_load_vec(a, 1);
}

/* The rates of the motion of a point at d from the origin of a moving frame of motion V and accelerations A,
   as seen there: V_p and A_p are those of the point itself, all in world axes. */
RBDI_LOCAL rbdi_motion rbdi_tasks_relative_drift(rbdi_motion V, rbdi_motion A, rbdi_motion V_p,
                                                 rbdi_motion A_p, rbdi_v3 d) {
    const rbdi_v3 seen = rbdi_sub(rbdi_sub(V_p.v, V.v), rbdi_cross(V.omega, d));
    rbdi_motion drift;

    /* alpha_p - alpha - omega x omega_p */
    drift.omega = rbdi_sub(rbdi_sub(A_p.omega, A.omega), rbdi_cross(V.omega, V_p.omega));

    /* a_p - a - alpha x d - omega x (omega x d) - 2 omega x v_seen */
    drift.v = rbdi_sub(rbdi_sub(A_p.v, A.v), rbdi_cross(A.omega, d));
    drift.v = rbdi_sub(drift.v, rbdi_cross(V.omega, rbdi_cross(V.omega, d)));
    drift.v = rbdi_sub(drift.v, rbdi_scale(rbdi_set(RBD_C(2)), rbdi_cross(V.omega, seen)));
    return drift;
}

/* Motion or acceleration of a point, world axes. */
RBDI_LOCAL rbdi_motion rbdi_tasks_motion(const rbdi_tasks *k, int body, const rbd_real *point, int rate) {
    rbd_real motion[6];
    if (rate)
        rbd_point_acceleration(k->m, k->w, body, point, RBD_WORLD_AXES, motion);
    else
        rbd_point_velocity(k->m, k->w, body, point, RBD_WORLD_AXES, motion);
    return rbdi_load_motion(motion, 1);
}

/* A point, pose or rotation, in the world or in the axes of another body. */
RBDI_LOCAL void rbdi_tasks_of_body(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    const int reference = t->kind == RBD_TASK_RELATIVE ? t->reference : -1;
    rbdi_mat seen = rbdi_axes_of(k->m, k->w, t->body); /* from the axes of `position` to the body's */
    rbdi_v3 p = rbdi_point_position(k->m, k->w, t->body, t->point);

    s->drift = rbdi_tasks_motion(k, t->body, t->point, 1);
    if (reference >= 0) {
        const rbdi_mat E = rbdi_axes_of(k->m, k->w, reference);
        const rbdi_motion V = rbdi_tasks_motion(k, reference, NULL, 0);
        const rbdi_motion A = rbdi_tasks_motion(k, reference, NULL, 1);
        const rbdi_motion V_p = rbdi_tasks_motion(k, t->body, t->point, 0);
        p = rbdi_sub(p, rbdi_point_position(k->m, k->w, reference, NULL));
        s->drift = rbdi_tasks_relative_drift(V, A, V_p, s->drift, p);

        s->drift.omega = rbdi_mul(E, s->drift.omega);
        s->drift.v = rbdi_mul(E, s->drift.v);
        seen = rbdi_mul_mat(seen, rbdi_transpose(E));
        p = rbdi_mul(E, p);
    }

    rbd_relative_jacobian(k->m, k->w, t->body, t->point, reference,
                          reference >= 0 ? RBD_LINK_AXES : RBD_WORLD_AXES, k->J);
    s->e.v = rbdi_ik_way(t->position, p);
    if (rbdi_tasks_turns(t->kind)) s->e.omega = rbdi_ik_turn_to(t->rotation, seen);
}

/* An axis s: its turn is omega - (omega s) s, whose rate is alpha - (alpha s) s - (omega s) omega x s. */
RBDI_LOCAL void rbdi_tasks_of_axis(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    const rbdi_v3 axis = rbdi_ik_axis(k->m, k->w, t->body, t->axis);
    const rbdi_v3 omega = rbdi_tasks_motion(k, t->body, NULL, 0).omega;
    const rbdi_v3 alpha = rbdi_tasks_motion(k, t->body, NULL, 1).omega;

    rbd_jacobian(k->m, k->w, t->body, NULL, RBD_WORLD_AXES, k->J);
    for (int i = 0; i < k->nv; ++i) {
        const rbdi_v3 c = rbdi_load_vec(&k->J[i], k->nv);
        rbdi_store_vec(&k->J[i], k->nv, rbdi_ik_part_across(c, axis));
    }

    s->e.omega = rbdi_ik_turn(axis, rbdi_ik_unit(t->direction));
    s->drift.omega = rbdi_ik_part_across(alpha, axis);
    s->drift.omega = rbdi_sub(s->drift.omega, rbdi_scale(rbdi_dot(omega, axis), rbdi_cross(omega, axis)));
}

/* What a row of a task asks for: y of J x = y. u: its velocity. */
RBDI_LOCAL rbd_real rbdi_tasks_wish(const rbdi_tasks *k, const rbdi_tasks_error *s, rbd_real velocity,
                                    rbd_real acceleration, rbd_real u, rbd_real e, rbd_real drift) {
    if (!k->accelerations) return velocity + s->stiffness * e;
    return acceleration + s->stiffness * e + s->damping * (velocity - u) - drift;
}

/* H + weight J'J and f - weight J'y of the last row; H below the diagonal alone. */
RBDI_LOCAL void rbdi_tasks_square(rbdi_tasks *k, rbd_real weight) {
    const rbd_real *row = &k->C[(ptrdiff_t)(k->rows - 1) * k->n];
    const rbd_real y = k->lower[k->n + k->rows - 1];

    for (int i = 0; i < k->nv; ++i) {
        const rbd_real a = weight * row[i];
        rbd_real *to = &k->H[(ptrdiff_t)i * k->n];
        if (a == 0) continue; /* a NaN is to reach the diagonal, where the QP looks for it */
        k->f[i] = k->f[i] - a * y;
        for (int j = 0; j <= i; ++j) to[j] = to[j] + a * row[j];
    }
}

/* The gains of a task: k, or k^2 and 2 damping k. */
RBDI_LOCAL rbdi_tasks_error rbdi_tasks_gains(const rbdi_tasks *k, const rbd_task *t) {
    const rbd_real damping = t->damping > 0 ? t->damping : rbdi_set(RBD_C(1));
    rbdi_tasks_error s;
    s.e = s.drift = rbdi_motion0();
    s.stiffness = k->accelerations ? t->gain * t->gain : t->gain;
    s.damping = 2 * damping * t->gain;
    return s;
}

/* Appends the rows of a task of bodies. A row of which rounding alone is left does not count: the next levels
   would have to keep it. */
RBDI_LOCAL void rbdi_tasks_put_bodies(rbdi_tasks *k, const rbd_task *t, rbd_real weight) {
    rbdi_tasks_error s = rbdi_tasks_gains(k, t);
    const int first = rbdi_tasks_first(t->kind), end = rbdi_tasks_end(t->kind);
    rbd_real e[6], drift[6], rounding;

    if (t->kind == RBD_TASK_MOMENTUM)
        rbdi_tasks_of_momentum(k, t, &s);
    else if (t->kind == RBD_TASK_COM)
        rbdi_tasks_of_com(k, t, &s);
    else if (t->kind == RBD_TASK_AXIS)
        rbdi_tasks_of_axis(k, t, &s);
    else
        rbdi_tasks_of_body(k, t, &s);
    rbdi_store_motion(e, 1, s.e);
    rbdi_store_motion(drift, 1, s.drift);
    rounding = rbdi_set(64 * RBDI_EPS);
    if (rbdi_tasks_of_robot(t->kind))
        rounding = rounding * rbdi_qp_largest(&k->J[first * k->nv], (end - first) * k->nv);
    else
        rounding = rounding * rbdi_qp_largest(k->J, 6 * k->nv);

    for (int r = first; r < end; ++r) {
        const rbd_real *J = &k->J[r * k->nv];
        const rbd_real u = k->accelerations ? rbdi_qp_dot(J, k->v, k->nv) : rbdi_zero();
        const rbd_real y = rbdi_tasks_wish(k, &s, t->velocity[r], t->acceleration[r], u, e[r], drift[r]);
        if (t->loose[r] || !(rbdi_qp_largest(J, k->nv) > rounding)) continue;
        rbdi_ik_copy(J, k->nv, rbdi_tasks_append(k, y, y));
        rbdi_tasks_square(k, weight);
    }
}

/* Appends the rows of a posture: J is the identity. e passes through k->J. */
RBDI_LOCAL void rbdi_tasks_put_posture(rbdi_tasks *k, const rbd_task *t, rbd_real weight) {
    const rbdi_tasks_error s = rbdi_tasks_gains(k, t);
    const rbd_real none = rbdi_zero();

    rbd_difference(k->m, k->q, t->q, k->J);
    for (int i = 0; i < k->nv; ++i) {
        const rbd_real velocity = t->v ? t->v[i] : none, acceleration = t->a ? t->a[i] : none;
        const rbd_real u = k->accelerations ? k->v[i] : none;
        const rbd_real y = rbdi_tasks_wish(k, &s, velocity, acceleration, u, k->J[i], none);
        const rbd_real own = t->weights                    ? t->weights[i]
                             : rbdi_tasks_is_passive(k, i) ? none
                                                           : rbdi_set(RBD_C(1));
        if (!(own > 0)) continue;
        rbdi_tasks_append(k, y, y)[i] = rbdi_set(RBD_C(1));

        /* its square is one entry */
        k->f[i] = k->f[i] - weight * own * y;
        k->H[(ptrdiff_t)i * (k->n + 1)] = k->H[(ptrdiff_t)i * (k->n + 1)] + weight * own;
    }
}

/* Appends the rows of one task, with their squares. */
RBDI_LOCAL void rbdi_tasks_put_task(rbdi_tasks *k, const rbd_task *t) {
    const rbd_real weight = t->weight > 0 ? t->weight : rbdi_set(RBD_C(1));

    if (t->kind == RBD_TASK_POSTURE) {
        rbdi_tasks_put_posture(k, t, weight);
    } else if (t->kind == RBD_TASK_ROWS) {
        for (int r = 0; r < t->rows; ++r) {
            rbdi_ik_copy(&t->jacobian[r * k->nv], k->nv, rbdi_tasks_append(k, t->y[r], t->y[r]));
            rbdi_tasks_square(k, weight);
        }
    } else {
        rbdi_tasks_put_bodies(k, t, weight);
    }
}

#endif
