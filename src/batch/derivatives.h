#ifndef RBDI_BATCH_DERIVATIVES_H
#define RBDI_BATCH_DERIVATIVES_H
#include "api/lookup.h"
#include "base/pieces.h"
#include "base/memory.h"
#include "derivatives/layout.h"
#include "api/batch_derivatives.h"
#include "batch/tasks.h"

/* ---- derivatives [derivatives code] ---- */

struct rbd_batch_derivatives {
    rbd_batch *b;
    rbd_derivatives *d;
    rbd_real *y; /* outputs of RBD_LANES states */
};

/* Largest outputs of a call: three square matrices and an acceleration, a momentum matrix and its bias, or a
   regressor. */
RBDI_LOCAL int rbdi_derivatives_output(const rbd_model *m) {
    int most = (3 * m->nv + 6) * m->nv + 6;
    if (most < 10 * m->nb * m->nv) most = 10 * m->nb * m->nv;
    return most;
}

RBDI_BATCH_API size_t rbd_batch_derivatives_size(const rbd_model *m) {
    if (!m) return 0;

    return RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_batch_derivatives)) + rbd_derivatives_size(m) +
           sizeof(rbd_real) * (size_t)rbdi_derivatives_output(m);
}

RBDI_BATCH_API rbd_status rbd_batch_derivatives_init(const rbd_model *m, rbd_batch *b, void *memory,
                                                     size_t size, rbd_batch_derivatives **derivatives) {
    unsigned char *p;
    rbd_batch_derivatives *d;
    rbd_status status;
    if (derivatives) *derivatives = NULL;
    if (!m || !b || !memory || !derivatives) return RBD_ERR_NULL;
    if (size < rbd_batch_derivatives_size(m)) return RBD_ERR_MEMORY;

    p = rbdi_aligned(memory);
    d = (rbd_batch_derivatives *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_batch_derivatives)));
    d->b = b;
    d->y = (rbd_real *)rbdi_take(&p, rbdi_derivatives_output(m), sizeof(rbd_real));
    status = rbd_derivatives_init(m, b->w, p, rbd_derivatives_size(m), &d->d);
    if (!status) *derivatives = d;
    return status;
}

RBDI_LOCAL rbd_status rbdi_batch_derivatives_run(rbdi_lane_call *call, const rbd_model *m,
                                                 rbd_batch_derivatives *d, int n, rbdi_task *t) {
    if (!d) return RBD_ERR_NULL;
    t->more = d->d;
    return rbdi_batch_run(call, m, d->b, n, d->y, t);
}

RBDI_LOCAL rbd_status rbdi_lanes_momentum_matrix(const rbd_model *m, const rbdi_task *t) {
    return rbd_momentum_matrix(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->y[0], t->y[1]);
}

RBDI_BATCH_API rbd_status rbd_batch_momentum_matrix(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                    const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *A,
                                                    RBD_REAL *A_dot_v) {
    rbdi_task t = rbdi_task_of(q, v, NULL, NULL);
    rbdi_task_output(&t, 0, A, 6 * rbd_nv(m));
    rbdi_task_output(&t, 1, A_dot_v, 6);
    return rbdi_batch_derivatives_run(rbdi_lanes_momentum_matrix, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_coriolis(const rbd_model *m, const rbdi_task *t) {
    return rbd_coriolis(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_coriolis(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                             const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *C) {
    rbdi_task t = rbdi_task_of(q, v, NULL, NULL);
    rbdi_task_output(&t, 0, C, rbd_nv(m) * rbd_nv(m));
    return rbdi_batch_derivatives_run(rbdi_lanes_coriolis, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_id_derivatives(const rbd_model *m, const rbdi_task *t) {
    return rbd_id_derivatives(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0],
                              t->y[1], t->y[2]);
}

RBDI_BATCH_API rbd_status rbd_batch_id_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                                   const RBD_REAL *f_ext, RBD_REAL *dtau_dq,
                                                   RBD_REAL *dtau_dv, RBD_REAL *M) {
    rbdi_task t = rbdi_task_of(q, v, a, f_ext);
    rbdi_task_output(&t, 0, dtau_dq, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 1, dtau_dv, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 2, M, rbd_nv(m) * rbd_nv(m));
    return rbdi_batch_derivatives_run(rbdi_lanes_id_derivatives, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_fd_derivatives(const rbd_model *m, const rbdi_task *t) {
    return rbd_fd_derivatives(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0],
                              t->y[1], t->y[2], t->y[3]);
}

RBDI_BATCH_API rbd_status rbd_batch_fd_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *da_dq,
                                                   RBD_REAL *da_dv, RBD_REAL *Minv) {
    rbdi_task t = rbdi_task_of(q, v, tau, f_ext);
    rbdi_task_output(&t, 0, a, rbd_nv(m));
    rbdi_task_output(&t, 1, da_dq, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 2, da_dv, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 3, Minv, rbd_nv(m) * rbd_nv(m));
    return rbdi_batch_derivatives_run(rbdi_lanes_fd_derivatives, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_regressor(const rbd_model *m, const rbdi_task *t) {
    return rbd_regressor(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->x[2], t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_regressor(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                              const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                              RBD_REAL *Y) {
    rbdi_task t = rbdi_task_of(q, v, a, NULL);
    rbdi_task_output(&t, 0, Y, m ? 10 * m->nb * m->nv : 0);
    return rbdi_batch_derivatives_run(rbdi_lanes_regressor, m, d, n, &t);
}

#endif
