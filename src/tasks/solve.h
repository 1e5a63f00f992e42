#ifndef RBDI_TASKS_SOLVE_H
#define RBDI_TASKS_SOLVE_H
#include "tasks/bounds.h"
#include "tasks/blame.h"

/* ---- solve [code of tasks] ---- */

/* Rows of a task, at most. */
RBDI_LOCAL int rbdi_tasks_rows_of(const rbd_model *m, const rbd_task *t) {
    switch ((int)t->kind) {
    case RBD_TASK_POSE:
    case RBD_TASK_MOMENTUM:
    case RBD_TASK_RELATIVE: return 6;
    case RBD_TASK_POSTURE: return m->nv;
    case RBD_TASK_ROWS: return t->rows;
    default: return 3;
    }
}

/* Rows of all tasks, soft rows at most. */
RBDI_LOCAL int rbdi_tasks_count(const rbd_model *m, const rbd_tasks *p, int *soft) {
    int rows = 0;
    for (int i = 0; i < p->tasks; ++i) rows += rbdi_tasks_rows_of(m, &p->task[i]);
    *soft = (p->limit_weight > 0 ? m->nv : 0) + (p->torque_weight > 0 ? m->nv : 0);
    return rows;
}

RBDI_API size_t rbd_tasks_size(const rbd_model *m, const rbd_tasks *p) {
    int rows, soft;
    if (!m || !p || p->tasks < 0 || p->tasks > RBDI_TASKS_MOST || p->contacts < 0 ||
        p->contacts > RBDI_TASKS_MOST || (p->tasks && !p->task))
        return 0;
    for (int i = 0; i < p->tasks; ++i)
        if (p->task[i].kind == RBD_TASK_ROWS && (p->task[i].rows < 0 || p->task[i].rows > RBDI_TASKS_MOST))
            return 0;
    rows = rbdi_tasks_count(m, p, &soft);
    if (RBDI_TASKS_C(m->nv, rows, p->contacts) > RBDI_QP_MOST ||
        RBDI_TASKS_N(m->nv, p->contacts) + (size_t)soft > RBDI_QP_MOST)
        return 0;
    return RBD_TASKS_SIZE(m->nv, rows, p->contacts, soft);
}

/* Lays out the arrays in the memory. What is kept between ticks stands first. */
RBDI_LOCAL rbdi_tasks *rbdi_tasks_lay_out(const rbd_model *m, const rbd_tasks *p, void *memory) {
    const int nv = m->nv, n = nv + 3 * p->contacts;
    unsigned char *at = rbdi_aligned(memory);
    int soft;
    const int count = rbdi_tasks_count(m, p, &soft);
    const int rows = nv + count + (3 + RBDI_TASKS_SIDES) * p->contacts, all = n + rows;
    signed char *kept = RBDI_CUT(signed char, RBDI_TASKS_CHARS(nv, count, p->contacts));
    int16_t *contact = RBDI_CUT(int16_t, p->contacts);
    rbdi_tasks *k = RBDI_CUT(rbdi_tasks, 1);

    k->kept = kept;
    k->side = kept + RBD_TASK_LEVELS * RBDI_TASKS_LIMITS(nv, p->contacts);
    k->contact = contact;
    k->H = RBDI_CUT(rbd_real, RBDI_TASKS_SCALARS(nv, count, p->contacts));
    k->C = k->H + n * n;
    k->lower = k->C + rows * n;
    k->upper = k->lower + all;
    k->soft = k->upper + all;
    k->lambda = k->soft + all;
    k->f = k->lambda + all;
    k->x = k->f + n;
    k->found = k->x + n;
    k->bias = k->found + n;
    k->J = k->bias + nv;
    k->scratch = at;
    k->scratch_size = RBD_QP_SIZE(n, n, rows, soft);
    return k;
}

/* Makes a tick ready: closed contacts, bounds, rows of the robot. */
RBDI_LOCAL rbdi_tasks *rbdi_tasks_begin(const rbd_model *m, rbd_work *w, const rbd_tasks *p,
                                        const rbd_real *q, const rbd_real *v, int accelerations, void *memory,
                                        rbd_tasks_result *result) {
    rbdi_tasks *k = rbdi_tasks_lay_out(m, p, memory);
    k->m = m;
    k->w = w;
    k->given = p;
    k->q = q;
    k->v = v;
    k->result = result;
    k->accelerations = accelerations;
    k->nv = m->nv;
    k->missed = rbdi_zero();

    k->closed = 0;
    for (int i = 0; i < p->contacts; ++i)
        if (!p->contact[i].open) k->contact[k->closed++] = (int16_t)i;
    k->n = k->nv + (accelerations ? 3 * k->closed : 0);

    if (!p->warm)
        for (size_t i = 0; i < RBD_TASK_LEVELS * RBDI_TASKS_LIMITS(k->nv, p->contacts); ++i) k->kept[i] = 0;
    rbdi_tasks_bounds(k);
    rbdi_tasks_put_robot(k);
    return k;
}

/* Sets a result to nothing. */
RBDI_LOCAL void rbdi_tasks_clear_result(rbd_tasks_result *result) {
    result->steps = 0;
    result->level = 0;
    result->qp = RBD_QP_OK;
    result->primal = rbdi_zero();
    result->dual = rbdi_zero();
    for (int i = 0; i < 2; ++i) {
        result->part[i] = RBD_TASKS_NOTHING;
        result->at[i] = -1;
    }
    result->task = -1;
    result->contact = -1;
    result->dof = -1;
    rbdi_tasks_refuse(result, RBD_OK, NULL);
}

/* Solves a problem that is in order; k->found is the answer. */
RBDI_LOCAL rbd_tasks_status rbdi_tasks_run(rbdi_tasks *k) {
    const int rows = k->rows;
    const rbd_tasks_status status = rbdi_tasks_descend(k);
    if (status == RBD_TASKS_INFEASIBLE) rbdi_tasks_blame(k, rows);
    return status;
}

RBDI_API rbd_tasks_status rbd_tasks_velocity(const rbd_model *m, rbd_work *w, const rbd_tasks *p,
                                             const rbd_real *q, void *memory, size_t size, rbd_real *v,
                                             rbd_tasks_result *result) {
    rbd_tasks_status status;
    rbdi_tasks *k;
    if (!result) return RBD_TASKS_ERROR;

    rbdi_tasks_clear_result(result);
    if (rbdi_tasks_check(m, w, p, q && memory && v, 0, size, result) ||
        rbdi_tasks_check_state(m, p, q, p->acceleration ? v : NULL, result))
        return RBD_TASKS_ERROR;

    k = rbdi_tasks_begin(m, w, p, q, v, 0, memory, result);
    status = rbdi_tasks_run(k);
    if (status >= 0) rbdi_ik_copy(k->found, k->nv, v);
    return status;
}

/* Forces of the contacts, world axes, from those along the axes of their ground. */
RBDI_LOCAL void rbdi_tasks_put_forces(const rbdi_tasks *k, rbd_real *forces) {
    rbdi_clear(forces, 3 * k->given->contacts);
    for (int i = 0; i < k->closed; ++i) {
        const int contact = k->contact[i];
        const rbdi_v3 f = rbdi_load_vec(&k->found[k->nv + 3 * i], 1);
        rbdi_store_vec(&forces[3 * contact], 1,
                       rbdi_mul_t(rbdi_tasks_ground(&k->given->contact[contact]), f));
    }
}

RBDI_API rbd_tasks_status rbd_tasks_acceleration(const rbd_model *m, rbd_work *w, const rbd_tasks *p,
                                                 const rbd_real *q, const rbd_real *v, void *memory,
                                                 size_t size, rbd_real *a, rbd_real *forces, rbd_real *tau,
                                                 rbd_tasks_result *result) {
    rbd_tasks_status status;
    rbdi_tasks *k;
    if (!result) return RBD_TASKS_ERROR;

    rbdi_tasks_clear_result(result);
    if (rbdi_tasks_check(m, w, p, q && v && memory && a && tau, 1, size, result) ||
        rbdi_tasks_check_state(m, p, q, v, result))
        return RBD_TASKS_ERROR;

    k = rbdi_tasks_begin(m, w, p, q, v, 1, memory, result);
    status = rbdi_tasks_run(k);
    if (status < 0) return status;

    rbdi_ik_copy(k->found, k->nv, a);
    for (int i = 0; i < k->nv; ++i) {
        const rbd_real *row = &k->C[(ptrdiff_t)(k->dynamics + i) * k->n];
        tau[i] = rbdi_tasks_is_passive(k, i) ? rbdi_zero() : rbdi_qp_dot(row, k->found, k->n) + k->bias[i];
    }
    if (forces && p->contacts) rbdi_tasks_put_forces(k, forces);
    return status;
}

#endif
