#ifndef RBDI_TASKS_CONTACTS_H
#define RBDI_TASKS_CONTACTS_H
#include "ik/targets.h"
#include "tasks/layout.h"

/* ---- contacts and dynamics [contacts and dynamics] ---- */

/* Appends a row with these sides; returns it, for its entries to be written. */
RBDI_LOCAL rbd_real *rbdi_tasks_append_any(rbdi_tasks *k, rbd_real lower, rbd_real upper) {
    rbd_real *row = &k->C[(ptrdiff_t)k->rows * k->n];

    k->lower[k->n + k->rows] = lower;
    k->upper[k->n + k->rows] = upper;
    k->soft[k->n + k->rows] = rbdi_zero();
    ++k->rows;
    return row;
}

/* The same of a row of zeros. */
RBDI_LOCAL rbd_real *rbdi_tasks_append(rbdi_tasks *k, rbd_real lower, rbd_real upper) {
    rbd_real *row = rbdi_tasks_append_any(k, lower, upper);
    rbdi_clear(row, k->n);
    return row;
}

/* Two tangents and the normal of a contact's ground, as rows. */
RBDI_LOCAL rbdi_mat rbdi_tasks_ground(const rbd_task_contact *c) {
    const rbdi_v3 given = rbdi_load_vec(c->normal, 1);
    const rbdi_v3 z = rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_set(RBD_C(1)));
    const rbdi_v3 n = rbdi_dot(given, given) > 0 ? rbdi_ik_unit(c->normal) : z;
    const rbdi_v3 t = rbdi_ik_across(n), u = rbdi_cross(n, t);
    return rbdi_mat_of(t.x, t.y, t.z, u.x, u.y, u.z, n.x, n.y, n.z);
}

/* Holds a contact: J a = -dJ/dt v - gain J v, or J v = 0, along the axes of its ground. */
RBDI_LOCAL void rbdi_tasks_hold(rbdi_tasks *k, const rbd_task_contact *c) {
    const rbdi_mat axes = rbdi_tasks_ground(c);
    const rbd_real gain = c->gain > 0 ? c->gain : rbdi_set(RBDI_TASKS_HELD);
    rbd_real motion[6], *row[3];
    rbdi_v3 drift;

    rbd_jacobian(k->m, k->w, c->body, c->point, RBD_WORLD_AXES, k->J);
    for (int r = 0; r < 3; ++r) row[r] = rbdi_tasks_append(k, rbdi_zero(), rbdi_zero());
    for (int i = 0; i < k->nv; ++i) {
        const rbdi_v3 along = rbdi_mul(axes, rbdi_load_vec(&k->J[3 * k->nv + i], k->nv));
        row[0][i] = along.x;
        row[1][i] = along.y;
        row[2][i] = along.z;
    }
    if (!k->accelerations) return;

    rbd_point_acceleration(k->m, k->w, c->body, c->point, RBD_WORLD_AXES, motion);
    drift = rbdi_load_vec(&motion[3], 1);
    rbd_point_velocity(k->m, k->w, c->body, c->point, RBD_WORLD_AXES, motion);
    drift = rbdi_add(drift, rbdi_scale(gain, rbdi_load_vec(&motion[3], 1)));

    drift = rbdi_scale(rbdi_set(-RBD_C(1)), rbdi_mul(axes, drift));
    rbdi_store_vec(&k->lower[k->n + k->rows - 3], 1, drift);
    rbdi_store_vec(&k->upper[k->n + k->rows - 3], 1, drift);
}

/* Whether a dof has no motor. */
RBDI_LOCAL int rbdi_tasks_is_passive(const rbdi_tasks *k, int dof) {
    if (k->given->passive) return k->given->passive[dof] != 0;
    return k->m->frame[k->m->dof[dof].body].type == RBD_FLOATING;
}

/* The largest torque of a dof; RBDI_UNBOUNDED: any. That of a mimic, x = ratio q, comes to ratio times its
   own: whichever of the joints bears all, none bears more than its limit. */
RBDI_LOCAL rbd_real rbdi_tasks_torque(const rbdi_tasks *k, int dof) {
    const rbd_model *m = k->m;
    const rbdi_frame *u = &m->frame[m->dof[dof].body];
    rbd_real most = rbdi_set(RBDI_UNBOUNDED);
    if (k->given->without & RBD_WITHOUT_TORQUE) return most;
    if (k->given->torque) return k->given->torque[dof] > 0 ? k->given->torque[dof] : most;

    if (u->nv == 1 && u->effort > 0) most = rbdi_set(u->effort);
    for (int i = 0; i < rbdi_mimics(m); ++i) {
        const rbd_const own = m->frame[m->dof[m->nv + i].body].effort;
        if (m->mimic[i].source_v == dof && own > 0)
            most = rbdi_smaller(most, rbdi_abs(rbdi_set(own * m->mimic[i].ratio)));
    }
    return most;
}

/* Rows of the dynamics: -most <= M a - J'f + bias <= most, most = 0 of passive dofs. M: nv x nv. */
RBDI_LOCAL void rbdi_tasks_put_dynamics(rbdi_tasks *k, const rbd_real *M) {
    k->dynamics = k->rows;
    for (int i = 0; i < k->nv; ++i) {
        const int passive = rbdi_tasks_is_passive(k, i);
        const rbd_real most = passive ? rbdi_zero() : rbdi_tasks_torque(k, i);
        const int limited = most < RBDI_UNBOUNDED;
        rbd_real *row = rbdi_tasks_append_any(k, limited ? -most - k->bias[i] : -most,
                                              limited ? most - k->bias[i] : most);

        for (int j = 0; j < k->nv; ++j) row[j] = M[i * k->nv + j];
        for (int j = 0; j < 3 * k->closed; ++j) row[k->nv + j] = -k->C[(ptrdiff_t)j * k->n + i];
        if (!passive) k->soft[k->n + k->rows - 1] = k->given->torque_weight;
    }
}

/* Rows of friction: along each side of the pyramid, whose edges lie on the cone, f is at most
   mu cos(pi / sides) of the normal force. */
RBDI_LOCAL void rbdi_tasks_put_friction(rbdi_tasks *k) {
    const rbd_const diagonal = RBD_C(0.70710678118654752440); /* of a square; cos(pi / 4) */
    const rbd_const octagon = RBD_C(0.92387953251128675613);  /* cos(pi / 8) */
    const rbd_const cosine[8] = {1, diagonal, 0, -diagonal, -1, -diagonal, 0, diagonal};

    k->friction = k->rows;
    for (int i = 0; i < k->closed; ++i) {
        const rbd_task_contact *c = &k->given->contact[k->contact[i]];
        const int step = c->sides == 8 ? 1 : 2;
        const rbd_real share = c->friction * (c->sides == 8 ? octagon : diagonal);

        for (int side = 0; side < 8; side += step) {
            rbd_real *row = rbdi_tasks_append(k, -rbdi_set(RBDI_UNBOUNDED), rbdi_zero()) + k->nv + 3 * i;
            row[0] = rbdi_set(cosine[side]);
            row[1] = rbdi_set(cosine[(side + 6) % 8]);
            row[2] = -share;
        }
    }
}

/* All rows but those of tasks, and what rbd_kinematics leaves in w. The mass matrix passes through the memory
   of the QP. */
RBDI_LOCAL void rbdi_tasks_put_robot(rbdi_tasks *k) {
    rbd_real *M = (rbd_real *)k->scratch;

    if (k->accelerations) {
        rbd_crba(k->m, k->w, k->q, M);
        rbd_bias(k->m, k->w, k->q, k->v, k->given->f_ext, k->bias);
    }
    rbd_kinematics(k->m, k->w, k->q, k->accelerations ? k->v : NULL, NULL);

    k->rows = 0;
    for (int i = 0; i < k->closed; ++i) rbdi_tasks_hold(k, &k->given->contact[k->contact[i]]);
    k->dynamics = k->rows;
    k->friction = k->rows;
    k->robot = k->rows;
    if (!k->accelerations) return;
    rbdi_tasks_put_dynamics(k, M);
    rbdi_tasks_put_friction(k);
    k->robot = k->rows;
}

#endif
