#ifndef RBDI_BATCH_CONSTRAINTS_H
#define RBDI_BATCH_CONSTRAINTS_H
#include "constraints/set.h"
#include "api/batch_constraints.h"
#include "batch/tasks.h"

/* ---- constraints [constraints code] ---- */

struct rbd_batch_constraint_set {
    rbd_batch *b;
    rbd_constraint_set *set;
    rbd_real *y; /* outputs of RBD_LANES states */
};

RBDI_LOCAL size_t rbdi_batch_constraints_own(const rbd_model *m, int rows) {
    return RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_batch_constraint_set)) +
           RBDI_ROUND(sizeof(rbd_real) * (size_t)(m->nv + rows));
}

RBDI_BATCH_API size_t rbd_batch_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n) {
    const size_t size = rbd_constraint_set_size(m, list, n);
    return size ? size + rbdi_batch_constraints_own(m, rbdi_rows_of(list, n)) : 0;
}

RBDI_BATCH_API rbd_status rbd_batch_constraint_set_init(const rbd_model *m, rbd_batch *b,
                                                        const rbd_constraint *list, int n, void *memory,
                                                        size_t size, rbd_batch_constraint_set **constraints,
                                                        rbd_report *report) {
    rbd_batch_constraint_set *c;
    rbd_constraint_set *inner = NULL;
    unsigned char *p, *at;
    const size_t needed = rbd_batch_constraint_set_size(m, list, n);
    const int room = memory && needed && size >= needed;
    rbd_status status;
    int rows = 0;
    if (constraints) *constraints = NULL;

    /* The set lies behind the struct and its outputs. Without room its init finds the error. */
    if (room) rows = rbdi_rows_of(list, n);
    p = at = room ? rbdi_aligned(memory) : (unsigned char *)memory;
    if (room) at += rbdi_batch_constraints_own(m, rows) - RBDI_ALIGN;

    status = rbd_constraint_set_init(m, b && constraints ? b->w : NULL, list, n, at,
                                     room ? rbd_constraint_set_size(m, list, n) : 0, &inner, report);
    if (status) return status;

    c = (rbd_batch_constraint_set *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_batch_constraint_set)));
    c->b = b;
    c->set = inner;
    c->y = (rbd_real *)rbdi_take(&p, m->nv + rows, sizeof(rbd_real));
    *constraints = c;
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_lanes_constrained_fd(const rbd_model *m, const rbdi_task *t) {
    return rbd_constrained_fd(m, (rbd_constraint_set *)t->more, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0],
                              t->y[1]);
}

RBDI_BATCH_API rbd_status rbd_batch_constrained_fd(const rbd_model *m, rbd_batch_constraint_set *c, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *lambda) {
    rbdi_task t = rbdi_task_of(q, v, tau, f_ext);
    if (!m || !c || !v || !tau || !a) return RBD_ERR_NULL;

    rbdi_task_output(&t, 0, a, rbd_nv(m));
    rbdi_task_output(&t, 1, lambda, c->set->rows);
    t.more = c->set;
    return rbdi_batch_run(rbdi_lanes_constrained_fd, m, c->b, n, c->y, &t);
}

#endif
