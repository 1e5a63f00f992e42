#ifndef RBDI_ACTUATOR_INIT_H
#define RBDI_ACTUATOR_INIT_H
#include "base/pieces.h"
#include "motion/axes.h"
#include "actuator/step.h"
#include "actuator/check.h"

/* ---- tables [tables code] ---- */

RBDI_LOCAL int rbdi_act_is_number_of(int n, int groups, int delay) {
    return n >= 1 && n <= RBDI_ACTUATOR_MOST_MOTORS && groups >= 0 && groups <= n && delay >= 0 &&
           delay <= RBDI_ACTUATOR_MOST_DELAY;
}

RBDI_API size_t rbd_actuators_size(int n, int groups, int delay) {
    return rbdi_act_is_number_of(n, groups, delay) ? RBDI_ACTUATORS_BYTES(n, groups, delay) : 0;
}

/* Lays out the arrays in the memory. */
RBDI_LOCAL rbd_actuators *rbdi_act_lay_actuators(const rbd_model *m, const rbd_motor *motors, int n,
                                                 int groups, int ring, void *memory) {
    unsigned char *at = rbdi_aligned(memory);
    rbd_actuators *a = RBDI_CUT(rbd_actuators, 1);
    const int all = groups ? n : 0; /* shafts of which the motion is learnt */
    a->shaft = RBDI_CUT(rbdi_act_shaft, n);
    a->group = RBDI_CUT(rbdi_act_group, groups);
    a->commands = RBDI_CUT(rbd_command, n * ring);
    a->mass = RBDI_CUT(rbd_real, (4 * all + 1) * all);
    a->system = a->mass + all * all;
    a->pair = a->system + all * all;
    a->solution = a->pair + 2 * all * all;
    a->motor = motors;
    a->n = n;
    a->groups = groups;
    a->nq = m->nq;
    a->nv = m->nv;
    a->ring = ring;
    a->fault = -1;
    a->begun = 0;
    a->dt = rbdi_zero();
    return a;
}

/* Whether a shaft or group before moves the dof. */
RBDI_LOCAL int rbdi_act_is_moved(const rbd_actuators *a, int dof, int groups) {
    for (int i = 0; i < a->n; ++i)
        if (a->shaft[i].dof == dof) return 1;
    for (int k = 0; k < groups; ++k)
        for (int j = 0; j < a->group[k].n; ++j)
            if (a->group[k].dof[j] == dof) return 1;
    return 0;
}

/* The shafts that move a joint directly. A motor without a joint must be in one transmission. */
RBDI_LOCAL rbd_status rbdi_act_place_motors(const rbd_model *m, rbd_actuators *a, const rbd_transmission *t,
                                            int groups, rbd_report *report) {
    for (int i = 0; i < a->n; ++i) {
        a->shaft[i].dof = a->shaft[i].at = -1;
        a->shaft[i].phi = a->shaft[i].x = a->shaft[i].bias = rbdi_zero();
    }
    for (int i = 0; i < a->n; ++i) {
        const rbd_motor *motor = &a->motor[i];
        const rbdi_act_where where = {report, i, motor->name};
        int16_t dof, at;
        rbd_status status;
        int moves = 0;
        for (int k = 0; k < groups; ++k) moves += i >= t[k].motor && i < t[k].motor + t[k].n;
        if (moves > 1) return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, NULL, "in two transmissions");
        if (moves) continue;
        if (!motor->joint)
            return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, "joint",
                                         "missing, and no transmission has the motor");

        status = rbdi_act_find_joint(m, &where, motor->joint, motor, &dof, &at);
        if (status) return status;
        if (rbdi_act_is_moved(a, dof, 0))
            return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, "joint", "another motor moves this joint");
        a->shaft[i].dof = dof;
        a->shaft[i].at = at;
    }
    return RBD_OK;
}

/* Frame of a body on its link: x_body = E (x_link - r); of the world itself without one. */
RBDI_LOCAL rbdi_pose rbdi_act_body_frame(const rbd_model *m, int body) {
    rbdi_pose X = rbdi_world_pose();
    if (body < 0) return X;
    X.E = rbdi_mat_c(m->frame[body].E);
    X.r = rbdi_vec_c(m->frame[body].r);
    return X;
}

/* The joint j of rods at q = 0, in the axes of the body before, and the axis in its own body's. */
RBDI_LOCAL void rbdi_act_place_rod_joint(const rbd_model *m, rbdi_act_group *g, int j, int before) {
    const int body = m->dof[g->dof[j]].body;
    const rbdi_link *l = &m->link[m->frame[body].link];
    const rbdi_pose base = rbdi_act_body_frame(m, before), own = rbdi_act_body_frame(m, body);
    rbdi_trig trig;
    rbdi_pose X;
    trig.c = rbdi_set(l->cg);
    trig.s = rbdi_set(l->sg);
    trig.d = rbdi_set(l->d);
    X = rbdi_pose_step(l, l->flags & ~RBDI_ROOT, trig, rbdi_world_pose());

    /* origin = E_before (X.r + X.E' r_body - r_before),  turn = E_before X.E' E_body' */
    g->origin[j] = rbdi_mul(base.E, rbdi_sub(rbdi_add(X.r, rbdi_mul_t(X.E, own.r)), base.r));
    g->turn[j] = rbdi_mul_mat(base.E, rbdi_mul_mat(rbdi_transpose(X.E), rbdi_transpose(own.E)));
    g->axis[j] = rbdi_mul(own.E, rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_set(l->rho)));
}

RBDI_LOCAL rbd_status rbdi_act_place_rods(const rbd_model *m, const rbdi_act_where *where,
                                          rbdi_act_group *g) {
    int before = m->frame[m->dof[g->dof[0]].body].parent;
    for (int j = 0; j < g->n; ++j) {
        const int body = m->dof[g->dof[j]].body;
        const rbdi_frame *u = &m->frame[body];
        if (m->link[u->link].kind != RBDI_REVOLUTE)
            return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint", "a joint of rods does not turn");
        if (m->link[u->link].parent != (before < 0 ? -1 : m->frame[before].link))
            return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint",
                                         "joints of rods do not follow each other");
        rbdi_act_place_rod_joint(m, g, j, before);
        before = body;
    }
    return RBD_OK;
}

/* Checks a transmission, and looks its joints up. */
RBDI_LOCAL rbd_status rbdi_act_place_transmission(const rbd_model *m, rbd_actuators *a,
                                                  const rbd_transmission *t, int k, rbd_report *report) {
    const rbdi_act_where where = {report, a->n + k, t->name};
    rbdi_act_group *g = &a->group[k];
    g->by = t;
    g->n = 0;
    g->first = (int16_t)t->motor;
    for (int j = 0; j < t->n; ++j) {
        const rbd_status status =
            rbdi_act_find_joint(m, &where, t->joint[j], &a->motor[t->motor + j], &g->dof[j], &g->at[j]);
        int twice;
        if (status) return status;
        twice = rbdi_act_is_moved(a, g->dof[j], k);
        for (int i = 0; i < j; ++i) twice |= g->dof[i] == g->dof[j];
        if (twice)
            return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, "joint", "another motor moves this joint");
    }
    g->n = (int16_t)t->n;
    if (t->kind == RBD_BY_RODS) return rbdi_act_place_rods(m, &where, g);

    for (int i = 0; i < t->n * t->n; ++i) g->G[i] = rbdi_set(t->matrix[i]);
    if (rbdi_act_invert_small(g->G, t->n, g->inverse)) return RBD_OK;
    return rbdi_act_refuse_field(&where, RBD_ERR_SINGULAR, "matrix", "singular: some motion has no motor");
}

/* Checks the tables by themselves. ring: the largest delay. */
RBDI_LOCAL rbd_status rbdi_act_check_tables(const rbd_motor *motors, int n,
                                            const rbd_transmission *transmissions, int groups, int *ring,
                                            rbd_report *report) {
    for (int i = 0; i < n; ++i) {
        const rbdi_act_where where = {report, i, motors[i].name};
        const rbd_status status = rbdi_act_check_motor(&where, &motors[i]);
        if (status) return status;
        if (motors[i].delay > *ring) *ring = motors[i].delay;
    }
    for (int k = 0; k < groups; ++k) {
        const rbdi_act_where where = {report, n + k, transmissions[k].name};
        const rbd_status status = rbdi_act_check_transmission(&where, &transmissions[k], motors, n);
        if (status) return status;
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_actuators_init(const rbd_model *m, const rbd_motor *motors, int n,
                                       const rbd_transmission *transmissions, int groups, void *memory,
                                       size_t size, rbd_actuators **a, rbd_report *report) {
    rbd_report own;
    rbd_status status;
    rbd_actuators *x;
    int ring = 0;
    if (!report) report = &own;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (a) *a = NULL;
    if (!m || !motors || (!transmissions && groups) || !memory || !a)
        return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (!rbdi_supported(m)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (!rbdi_act_is_number_of(n, groups, 0))
        return rbdi_refuse_saying(report, RBD_ERR_COUNT, -1, NULL, NULL,
                                  "below 1 or above 1000 motors, or more transmissions than motors");
    status = rbdi_act_check_tables(motors, n, transmissions, groups, &ring, report);
    if (status) return status;
    if (size < rbd_actuators_size(n, groups, ring))
        return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);

    x = rbdi_act_lay_actuators(m, motors, n, groups, ring, memory);
    status = rbdi_act_place_motors(m, x, transmissions, groups, report);
    for (int k = 0; k < groups && !status; ++k)
        status = rbdi_act_place_transmission(m, x, &transmissions[k], k, report);
    if (status) return status;
    rbdi_act_rest(x, RBDI_ACTUATOR_WARM);
    *a = x;
    return RBD_OK;
}

#endif
