#ifndef RBDI_TASKS_CHECK_H
#define RBDI_TASKS_CHECK_H
#include "ik/check.h"
#include "tasks/layout.h"

/* ---- checks of tasks [checks of tasks] ---- */

/* Notes an error; returns it. */
RBDI_LOCAL rbd_status rbdi_tasks_refuse(rbd_tasks_result *result, rbd_status error, const char *field) {
    result->error = error;
    result->field = field;
    return error;
}

/* Whether n numbers are from `least` to `most`; NULL stands for none. */
RBDI_LOCAL int rbdi_tasks_are_within(const rbd_real *x, int n, rbd_const least, rbd_const most) {
    if (!x) return 1;

    for (int i = 0; i < n; ++i)
        if (!(x[i] >= least && x[i] <= most)) return 0;
    return 1;
}

/* Whether a rate or a weight is 0, which is a default, or neither tiny nor huge. */
RBDI_LOCAL int rbdi_tasks_is_measure(rbd_real x) {
    return rbdi_ik_within(x, RBDI_IK_MOST) && !(x > 0 && x < RBD_C(1) / RBDI_IK_MOST);
}

/* Numbers of a task by which it is scaled. */
RBDI_LOCAL rbd_status rbdi_tasks_check_scales(const rbd_task *t, rbd_tasks_result *result) {
    if (t->level < 0 || t->level >= RBD_TASK_LEVELS) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "level");
    if (!rbdi_tasks_is_measure(t->weight)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "weight");
    if (!rbdi_tasks_is_measure(t->gain)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "gain");
    if (!rbdi_tasks_is_measure(t->damping)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "damping");
    if (!rbdi_tasks_are_within(t->velocity, 6, -RBDI_IK_MOST, RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "velocity");
    if (!rbdi_tasks_are_within(t->acceleration, 6, -RBDI_IK_MOST, RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "acceleration");
    return RBD_OK;
}

/* Arrays of a posture, or rows of the caller's. */
RBDI_LOCAL rbd_status rbdi_tasks_check_arrays(const rbd_model *m, const rbd_task *t,
                                              rbd_tasks_result *result) {
    const int own = t->kind == RBD_TASK_ROWS;
    const rbd_const most = RBDI_IK_MOST;

    if (own) {
        if (t->rows < 0 || t->rows > RBDI_TASKS_MOST) return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "rows");
        if (!t->jacobian) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "jacobian");
        if (!t->y) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "y");
        if (!rbdi_tasks_are_within(t->jacobian, t->rows * m->nv, -most, most))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "jacobian");
        if (!rbdi_tasks_are_within(t->y, t->rows, -most, most))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "y");
        return RBD_OK;
    }

    if (!t->q) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "q");
    if (!rbdi_tasks_are_within(t->q, m->nq, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "q");
    if (!rbdi_tasks_are_within(t->v, m->nv, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "v");
    if (!rbdi_tasks_are_within(t->a, m->nv, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "a");
    if (!rbdi_tasks_are_within(t->weights, m->nv, 0, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "weights");
    return RBD_OK;
}

/* Not of NaN. */
RBDI_INLINE int rbdi_tasks_is_zero(rbd_real x) { return !(x < 0) && x <= 0; }

/* Which fields a kind reads. */
RBDI_INLINE int rbdi_tasks_turns(rbd_task_kind kind) {
    return kind == RBD_TASK_POSE || kind == RBD_TASK_ROTATION || kind == RBD_TASK_RELATIVE;
}
RBDI_INLINE int rbdi_tasks_of_robot(rbd_task_kind kind) {
    return kind == RBD_TASK_COM || kind == RBD_TASK_MOMENTUM;
}
RBDI_INLINE int rbdi_tasks_has_place(rbd_task_kind kind) {
    return kind == RBD_TASK_POINT || kind == RBD_TASK_POSE || kind == RBD_TASK_RELATIVE ||
           kind == RBD_TASK_COM;
}

/* The rows of a kind, of angular x y z and linear x y z, from the first to before the end. */
RBDI_INLINE int rbdi_tasks_first(rbd_task_kind kind) {
    return kind == RBD_TASK_POINT || kind == RBD_TASK_COM ? 3 : 0;
}
RBDI_INLINE int rbdi_tasks_end(rbd_task_kind kind) {
    return kind >= RBD_TASK_POSTURE ? 0 : kind == RBD_TASK_ROTATION || kind == RBD_TASK_AXIS ? 3 : 6;
}

/* Numbers of rows that the kind has not. */
RBDI_LOCAL rbd_status rbdi_tasks_check_unread(const rbd_task *t, rbd_tasks_result *result) {
    for (int r = 0; r < 6; ++r) {
        if (r >= rbdi_tasks_first(t->kind) && r < rbdi_tasks_end(t->kind)) continue;
        if (!rbdi_tasks_is_zero(t->velocity[r])) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "velocity");
        if (!rbdi_tasks_is_zero(t->acceleration[r]))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "acceleration");
        if (t->loose[r]) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "loose");
    }
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_tasks_check_task(const rbd_model *m, const rbd_task *t, rbd_tasks_result *result) {
    const int robot = rbdi_tasks_of_robot(t->kind), kind = (int)t->kind;
    if (kind < (int)RBD_TASK_POINT || kind > (int)RBD_TASK_ROWS)
        return rbdi_tasks_refuse(result, RBD_ERR_TYPE, "kind");
    if (rbdi_tasks_check_scales(t, result) || rbdi_tasks_check_unread(t, result)) return result->error;
    if (t->kind >= RBD_TASK_POSTURE) return rbdi_tasks_check_arrays(m, t, result);

    if (!robot && (t->body < 0 || t->body >= m->nb)) return rbdi_tasks_refuse(result, RBD_ERR_INDEX, "body");
    if (robot && !(rbd_mass(m) > 0)) return rbdi_tasks_refuse(result, RBD_ERR_MASS, "kind");
    if (robot && rbdi_massless_dof(m) >= 0) return rbdi_tasks_refuse(result, RBD_ERR_MASSLESS, "kind");
    if (t->kind == RBD_TASK_RELATIVE && (t->reference < -1 || t->reference >= m->nb))
        return rbdi_tasks_refuse(result, RBD_ERR_INDEX, "reference");

    if (!robot && !rbdi_ik_is_place(t->point)) return rbdi_tasks_refuse(result, RBD_ERR_POSITION, "point");
    if (rbdi_tasks_has_place(t->kind) && !rbdi_ik_is_place(t->position))
        return rbdi_tasks_refuse(result, RBD_ERR_POSITION, "position");
    if (rbdi_tasks_turns(t->kind) && !rbdi_ik_is_rotation(t->rotation))
        return rbdi_tasks_refuse(result, RBD_ERR_ROTATION, "rotation");
    if (t->kind == RBD_TASK_AXIS && !rbdi_ik_is_axis(t->axis))
        return rbdi_tasks_refuse(result, RBD_ERR_AXIS, "axis");
    if (t->kind == RBD_TASK_AXIS && !rbdi_ik_is_axis(t->direction))
        return rbdi_tasks_refuse(result, RBD_ERR_AXIS, "direction");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_tasks_check_contact(const rbd_model *m, const rbd_task_contact *c,
                                               rbd_tasks_result *result) {
    const int no_normal = !(c->normal[0] < 0 || c->normal[0] > 0 || c->normal[1] < 0 || c->normal[1] > 0 ||
                            c->normal[2] < 0 || c->normal[2] > 0);
    if (c->body < 0 || c->body >= m->nb) return rbdi_tasks_refuse(result, RBD_ERR_INDEX, "body");
    if (!rbdi_ik_is_place(c->point)) return rbdi_tasks_refuse(result, RBD_ERR_POSITION, "point");
    if (!rbdi_ik_is_place(c->normal) || (!no_normal && !rbdi_ik_is_axis(c->normal)))
        return rbdi_tasks_refuse(result, RBD_ERR_AXIS, "normal");

    if (!rbdi_ik_within(c->friction, RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "friction");
    if (c->sides != 0 && c->sides != 4 && c->sides != 8)
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "sides");
    if (!rbdi_ik_within(c->most, RBDI_IK_MOST)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "most");
    if (!rbdi_ik_within(c->least, c->most > 0 ? c->most : RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "least");
    if (!rbdi_tasks_is_measure(c->cost)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "cost");
    if (!rbdi_tasks_is_measure(c->gain)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "gain");
    return RBD_OK;
}

/* Limits and the problem's other numbers. */
RBDI_LOCAL rbd_status rbdi_tasks_check_limits(const rbd_model *m, const rbd_tasks *p,
                                              rbd_tasks_result *result) {
    const rbd_real *const arrays[3] = {p->speed, p->torque, p->acceleration};
    const rbd_real scales[5] = {p->braking, p->limit_weight, p->torque_weight, p->motion_cost, p->force_cost};
    const char *const names[3] = {"speed", "torque", "acceleration"};
    const char *const scale_names[5] = {"braking", "limit_weight", "torque_weight", "motion_cost",
                                        "force_cost"};

    for (result->dof = 0; result->dof < m->nv; ++result->dof) {
        const int i = result->dof;
        for (int k = 0; k < 3; ++k)
            if (arrays[k] && !rbdi_ik_within(arrays[k][i], RBDI_UNBOUNDED))
                return rbdi_tasks_refuse(result, RBD_ERR_RANGE, names[k]);
        if (p->lower && !(p->lower[i] < RBDI_UNBOUNDED))
            return rbdi_tasks_refuse(result, RBD_ERR_LIMITS, "lower");
        if (p->upper && !(p->upper[i] > -RBDI_UNBOUNDED))
            return rbdi_tasks_refuse(result, RBD_ERR_LIMITS, "upper");
        if (p->lower && p->upper && p->lower[i] > p->upper[i])
            return rbdi_tasks_refuse(result, RBD_ERR_LIMITS, "lower");
    }

    result->dof = -1;
    if (!(p->dt > 0) || !rbdi_tasks_is_measure(p->dt)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "dt");
    for (int k = 0; k < 5; ++k)
        if (!rbdi_tasks_is_measure(scales[k]))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, scale_names[k]);
    if (p->steps < 0) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "steps");
    if (p->without < 0 || p->without > RBDI_TASKS_WITHOUT)
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "without");
    return RBD_OK;
}

/* State and forces. v: NULL if it does not count. */
RBDI_LOCAL rbd_status rbdi_tasks_check_state(const rbd_model *m, const rbd_tasks *p, const rbd_real *q,
                                             const rbd_real *v, rbd_tasks_result *result) {
    const rbd_const most = RBDI_IK_MOST;
    if (!rbdi_tasks_are_within(q, m->nq, -most, most)) return rbdi_tasks_refuse(result, RBD_ERR_NAN, "q");
    if (!rbdi_tasks_are_within(v, m->nv, -most, most)) return rbdi_tasks_refuse(result, RBD_ERR_NAN, "v");
    if (!rbdi_tasks_are_within(p->f_ext, 6 * m->nb, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_NAN, "f_ext");
    return RBD_OK;
}

/* All checks, in the order of the arguments. given: the pointers that must not be NULL are not. dynamics:
   whether masses are needed. */
RBDI_LOCAL rbd_status rbdi_tasks_check(const rbd_model *m, const rbd_work *w, const rbd_tasks *p, int given,
                                       int dynamics, size_t size, rbd_tasks_result *result) {
    const int all = p && given;
    size_t needed;
    const rbd_status status = dynamics ? rbdi_check_dynamics(m, w, all) : rbdi_check(m, w, all);
    if (status) return rbdi_tasks_refuse(result, status, NULL);
    if (p->tasks < 0 || p->tasks > RBDI_TASKS_MOST) return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "tasks");
    if (p->contacts < 0 || p->contacts > RBDI_TASKS_MOST)
        return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "contacts");
    if (p->tasks && !p->task) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "task");
    if (p->contacts && !p->contact) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "contact");

    for (result->task = 0; result->task < p->tasks; ++result->task)
        if (rbdi_tasks_check_task(m, &p->task[result->task], result)) return result->error;
    result->task = -1;
    for (result->contact = 0; result->contact < p->contacts; ++result->contact)
        if (rbdi_tasks_check_contact(m, &p->contact[result->contact], result)) return result->error;
    result->contact = -1;

    if (rbdi_tasks_check_limits(m, p, result)) return result->error;
    needed = rbd_tasks_size(m, p);
    if (needed == 0) return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "tasks"); /* their rows, with contacts */
    return size < needed ? rbdi_tasks_refuse(result, RBD_ERR_MEMORY, NULL) : RBD_OK;
}

#endif
