#ifndef RBDI_TASKS_LEVELS_H
#define RBDI_TASKS_LEVELS_H
#include "qp/solve.h"
#include "tasks/rows.h"

/* ---- levels [levels] ---- */

/* Which limit a row of the QP is: of motion, of torque, or of contact `at`, there the normal force or a side
   of its friction. */
typedef struct rbdi_tasks_limit {
    rbd_tasks_part part; /* RBD_TASKS_NOTHING: a tangential force, or a row of a task */
    int at;              /* dof or contact */
} rbdi_tasks_limit;

/* row: counted with the bounds. */
RBDI_LOCAL rbdi_tasks_limit rbdi_tasks_limit_of(const rbdi_tasks *k, int row) {
    const int nv = k->nv, c = row - k->n;
    rbdi_tasks_limit limit = {RBD_TASKS_NOTHING, -1};

    if (row < nv) {
        limit.part = RBD_TASKS_MOTION_LIMIT;
        limit.at = row;
    } else if (c < 0) {
        if ((row - nv) % 3 < 2) return limit;
        limit.part = RBD_TASKS_FORCE;
        limit.at = k->contact[(row - nv) / 3];
    } else if (c < k->dynamics) {
        limit.part = RBD_TASKS_HELD;
        limit.at = k->contact[c / 3];
    } else if (c < k->friction) {
        limit.part = rbdi_tasks_is_passive(k, c - k->dynamics) ? RBD_TASKS_PASSIVE : RBD_TASKS_TORQUE_LIMIT;
        limit.at = c - k->dynamics;
    } else {
        for (int i = 0, side = c - k->friction; i < k->closed; ++i) {
            const int sides = k->given->contact[k->contact[i]].sides == 8 ? 8 : 4;
            if (side < sides) {
                limit.part = RBD_TASKS_FRICTION;
                limit.at = k->contact[i];
                return limit;
            }
            side -= sides;
        }
    }
    return limit;
}

/* Copies sides of limits from those kept, or back. */
RBDI_LOCAL void rbdi_tasks_keep_some(signed char *side, signed char *kept, int n, int back) {
    for (int i = 0; i < n; ++i) {
        if (back)
            kept[i] = side[i];
        else
            side[i] = kept[i];
    }
}

/* Copies the sides at which limits hold from those kept of a level, or back. Rows of tasks have none. */
RBDI_LOCAL void rbdi_tasks_keep(rbdi_tasks *k, int level, int rows, int back) {
    signed char *kept = k->kept + (size_t)level * RBDI_TASKS_LIMITS(k->nv, k->given->contacts);
    signed char *side = k->side;
    signed char *friction = side + k->n + k->friction;

    for (int row = 0; row < k->n + rows && !back; ++row) side[row] = 0;
    rbdi_tasks_keep_some(side, kept, k->nv, back);
    if (!k->accelerations) return;

    rbdi_tasks_keep_some(side + k->n + k->dynamics, kept + k->nv, k->nv, back);
    for (int i = 0; i < k->closed; ++i) {
        const int contact = k->contact[i];
        const int sides = k->given->contact[contact].sides == 8 ? 8 : 4;
        signed char *of_contact = kept + 2 * k->nv + RBDI_TASKS_CONTACT * contact;

        rbdi_tasks_keep_some(side + k->nv + 3 * i + 2, of_contact, 1, back);
        rbdi_tasks_keep_some(friction, of_contact + 1, sides, back);
        friction += sides;
    }
}

/* The force that counts as 1 m/s^2: that which gives the robot so much. */
RBDI_LOCAL rbd_const rbdi_tasks_unit_force(const rbdi_tasks *k) {
    const rbd_const mass = rbd_mass(k->m);
    return mass > 0 ? mass : RBD_C(1);
}

/* The squares that every level has: of x alone. */
RBDI_LOCAL void rbdi_tasks_clear_squares(rbdi_tasks *k) {
    const rbd_tasks *p = k->given;
    const rbd_real motion = p->motion_cost > 0 ? p->motion_cost : rbdi_set(RBDI_TASKS_MOTION_COST);
    const rbd_const unit = rbdi_tasks_unit_force(k);
    const rbd_real force = p->force_cost > 0 ? p->force_cost : motion / (unit * unit);

    rbdi_clear(k->f, k->n);
    rbdi_clear(k->H, k->nv * k->n);
    for (int i = 0; i < k->n; ++i) {
        const rbd_real own = i < k->nv ? rbdi_zero() : p->contact[k->contact[(i - k->nv) / 3]].cost;
        k->H[(ptrdiff_t)i * k->n + i] = i < k->nv ? motion : own > 0 ? own : force;
    }
}

/* By how much x misses hard rows of the QP that was solved, at most, as a share of each row's own terms. That
   of rbd_qp_result counts all components of x as the largest: one may be missed by all of itself, where
   another is a million. Here x_i counts as |x_i| + a unit of it. */
RBDI_LOCAL rbd_real rbdi_tasks_missed(const rbdi_tasks *k, const rbdi_qp *s) {
    const rbd_real force = rbdi_set(rbdi_tasks_unit_force(k)), motion = rbdi_set(RBD_C(1));
    rbd_real most = rbdi_zero();

    for (int i = 0; i < k->n; ++i) s->reach[i] = rbdi_abs(k->x[i]) + (i < k->nv ? motion : force);
    for (int row = 0; row < s->all; ++row) {
        const rbd_real value = s->value[row];
        const rbd_real below = k->lower[row] - value;
        const rbd_real by = rbdi_larger(below, value - k->upper[row]);
        const rbd_real side = below > 0 ? k->lower[row] : k->upper[row];
        if (!(by > 0) || k->soft[row] > 0) continue;
        if (by <= most * (rbdi_abs(side) + rbdi_abs(value))) continue; /* the terms are more than the value */
        const rbd_real share = by / rbdi_qp_terms(s, row, side);
        most = rbdi_larger(most, rbdi_smaller(share, rbdi_set(RBD_C(1)))); /* 1 if sums overflow */
    }
    return most;
}

/* Adds what x misses of its rows to what the levels before missed, by which limits were widened. Returns
   whether that is little enough for a tick. */
RBDI_LOCAL int rbdi_tasks_count_missed(rbdi_tasks *k, const rbdi_qp *s) {
    k->missed = k->missed + rbdi_tasks_missed(k, s);
    k->result->primal = rbdi_larger(k->result->primal, k->missed);
    return k->missed < RBDI_TASKS_ACCURACY && rbdi_tasks_are_within(k->x, k->n, -RBDI_IK_MOST, RBDI_IK_MOST);
}

/* Whether a QP has ended with an x that is of use, though perhaps not the best. */
RBDI_LOCAL int rbdi_tasks_has_answer(rbd_qp_status status) {
    return status == RBD_QP_OK || status == RBD_QP_INACCURATE || status == RBD_QP_ITERATIONS ||
           status == RBD_QP_UNBOUNDED;
}

/* Solves the QP of a level, with the first rows of C: those of its own tasks are squares in it. */
RBDI_LOCAL rbd_qp_status rbdi_tasks_solve_level(rbdi_tasks *k, int level, int rows) {
    rbd_tasks_result *result = k->result;
    rbd_qp_problem qp;
    rbd_qp_options options;
    const rbdi_qp_shape shape = {1, k->nv, k->dynamics, k->friction, k->robot};
    rbdi_qp s;
    rbd_qp_status status;

    for (int i = 0; i < k->nv; ++i)
        for (int j = 0; j < i; ++j) k->H[(ptrdiff_t)j * k->n + i] = k->H[(ptrdiff_t)i * k->n + j];

    qp.n = k->n;
    qp.bounds = k->n;
    qp.rows = rows;
    qp.H = k->H;
    qp.f = k->f;
    qp.C = k->C;
    qp.lower = k->lower;
    qp.upper = k->upper;
    qp.soft = k->given->limit_weight > 0 || k->given->torque_weight > 0 ? k->soft : NULL;
    options.steps = k->given->steps;
    options.warm = k->given->warm;
    options.rounds = 0;
    options.accuracy = rbdi_zero();

    if (options.warm) rbdi_tasks_keep(k, level, rows, 0);
    status = rbdi_qp_solve(&s, &qp, &options, &shape, k->scratch, k->scratch_size, k->x, k->lambda, k->side);
    rbdi_tasks_keep(k, level, rows, 1);
    result->qp = status;
    result->level = level;
    result->steps += s.result.steps;
    result->primal = rbdi_larger(result->primal, s.result.primal);
    result->dual = rbdi_larger(result->dual, s.balance);
    if (!rbdi_tasks_has_answer(status)) return status;

    /* x is what counts: nobody asks for multipliers, of rows that nearly depend on each other */
    if (status == RBD_QP_INACCURATE && rbdi_larger(s.result.primal, s.balance) < RBDI_TASKS_ACCURACY)
        status = RBD_QP_OK;
    if (!rbdi_tasks_count_missed(k, &s) && status == RBD_QP_OK) {
        result->qp = RBD_QP_INACCURATE; /* rows that nearly contradict each other */
        return RBD_QP_INACCURATE;
    }
    return status;
}

/* The value of a row, counted with the bounds, at x. */
RBDI_LOCAL rbd_real rbdi_tasks_value(const rbdi_tasks *k, int row) {
    if (row < k->n) return k->x[row];
    return rbdi_qp_dot(&k->C[(ptrdiff_t)(row - k->n) * k->n], k->x, k->n);
}

/* Before the next level: rows of tasks hold what they reached, and limits hold x. */
RBDI_LOCAL void rbdi_tasks_freeze(rbdi_tasks *k, int rows) {
    for (int row = 0; row < k->n + k->rows; ++row) {
        const rbd_real value = rbdi_tasks_value(k, row);
        if (row >= k->n + rows) {
            k->lower[row] = value;
            k->upper[row] = value;
        } else if (k->lower[row] < k->upper[row]) {
            k->lower[row] = rbdi_smaller(k->lower[row], value);
            k->upper[row] = rbdi_larger(k->upper[row], value);
        }
        k->soft[row] = rbdi_zero();
    }
}

/* Appends the rows and squares of the tasks of a level; returns how many tasks. */
RBDI_LOCAL int rbdi_tasks_put_level(rbdi_tasks *k, int level) {
    int tasks = 0;

    rbdi_tasks_clear_squares(k);
    for (int i = 0; i < k->given->tasks; ++i) {
        if (k->given->task[i].level != level) continue;
        rbdi_tasks_put_task(k, &k->given->task[i]);
        ++tasks;
    }
    return tasks;
}

/* Whether a level above this one has tasks. */
RBDI_LOCAL int rbdi_tasks_goes_on(const rbdi_tasks *k, int level) {
    for (int i = 0; i < k->given->tasks; ++i)
        if (k->given->task[i].level > level) return 1;
    return 0;
}

/* Solves level by level. k->found is the answer, if there is any. */
RBDI_LOCAL rbd_tasks_status rbdi_tasks_descend(rbdi_tasks *k) {
    int solved = 0;

    for (int level = 0; level < RBD_TASK_LEVELS && k->n > 0; ++level) {
        const rbd_real primal = k->result->primal, dual = k->result->dual;
        const int rows = k->rows;
        rbd_qp_status status;
        if (!rbdi_tasks_put_level(k, level) && level > 0) continue;

        status = rbdi_tasks_solve_level(k, level, rows);
        if (status != RBD_QP_OK && solved) { /* the answer of the level before stands */
            k->result->primal = primal;
            k->result->dual = dual;
            return RBD_TASKS_INEXACT;
        }
        if (status == RBD_QP_INFEASIBLE) return RBD_TASKS_INFEASIBLE;
        if (!rbdi_tasks_has_answer(status)) {
            rbdi_tasks_refuse(k->result, RBD_ERR_NAN, NULL);
            return RBD_TASKS_ERROR;
        }

        rbdi_ik_copy(k->x, k->n, k->found);
        if (status != RBD_QP_OK) return RBD_TASKS_INEXACT;
        if (!rbdi_tasks_goes_on(k, level)) return RBD_TASKS_OK;
        solved = 1;
        rbdi_tasks_freeze(k, rows);
    }
    return RBD_TASKS_OK;
}

#endif
