#ifndef RBDI_BATCH_CALLS_H
#define RBDI_BATCH_CALLS_H
#include "api/model.h"
#include "api/dynamics.h"
#include "api/kinematics.h"
#include "api/lookup.h"
#include "base/pieces.h"
#include "base/memory.h"
#include "batch/tasks.h"

/* ---- batches [batch code] ---- */

/* A call with one output, which must not be NULL. */
RBDI_LOCAL rbd_status rbdi_batch_one(rbdi_lane_call *call, const rbd_model *m, rbd_batch *b, int n,
                                     const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                     const RBD_REAL *f_ext, RBD_REAL *out, int width) {
    rbdi_task t = rbdi_task_of(q, v, a, f_ext);
    rbdi_task_output(&t, 0, out, width);
    return out ? rbdi_batch_run(call, m, b, n, b ? b->y : NULL, &t) : RBD_ERR_NULL;
}

RBDI_BATCH_API int rbd_batch_lanes(void) { return RBD_LANES; }

RBDI_BATCH_API size_t rbd_batch_size(const rbd_model *m) {
    if (!m) return 0;

    return RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_batch)) + RBDI_ROUND(rbd_work_size(m)) +
           sizeof(rbd_real) * (size_t)(m->nq + 2 * m->nv + 6 * m->nb + rbdi_batch_output(m));
}

RBDI_BATCH_API rbd_status rbd_batch_init(const rbd_model *m, void *memory, size_t size, rbd_batch **batch) {
    unsigned char *p;
    rbd_batch *b;
    rbd_status status;
    if (batch) *batch = NULL;
    if (!m || !memory || !batch) return RBD_ERR_NULL;
    if (size < rbd_batch_size(m)) return RBD_ERR_MEMORY;

    p = rbdi_aligned(memory);
    b = (rbd_batch *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_batch)));
    for (int k = 0; k < RBDI_ARGUMENTS; ++k)
        b->x[k] = (rbd_real *)rbdi_take(&p, rbdi_batch_width(m, k), sizeof(rbd_real));
    b->y = (rbd_real *)rbdi_take(&p, rbdi_batch_output(m), sizeof(rbd_real));

    b->state = b->dof = -1;
    b->layout = RBD_ROWS;
    status = rbd_work_init(m, p, rbd_work_size(m), &b->w);
    if (!status) *batch = b;
    return status;
}

RBDI_BATCH_API rbd_status rbd_batch_set_gravity(rbd_batch *b, const rbd_const gravity[3]) {
    return b ? rbd_set_gravity(b->w, gravity) : RBD_ERR_NULL;
}

RBDI_BATCH_API rbd_status rbd_batch_set_layout(rbd_batch *b, rbd_layout layout) {
    if (!b) return RBD_ERR_NULL;
    b->layout = layout;
    return RBD_OK;
}

/* The calls in lanes. x: q, v, a or tau, f_ext. */
RBDI_LOCAL rbd_status rbdi_lanes_rnea(const rbd_model *m, const rbdi_task *t) {
    const rbd_real *a = t->x[2] ? t->x[2] : t->w->zero;
    return rbd_rnea(m, t->w, t->x[0], t->x[1], a, t->x[3], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_aba(const rbd_model *m, const rbdi_task *t) {
    return rbd_aba(m, t->w, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_fd_cholesky(const rbd_model *m, const rbdi_task *t) {
    return rbd_fd_cholesky(m, t->w, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_crba(const rbd_model *m, const rbdi_task *t) {
    return rbd_crba(m, t->w, t->x[0], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_crba_packed(const rbd_model *m, const rbdi_task *t) {
    return rbd_crba_packed(m, t->w, t->x[0], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_minverse(const rbd_model *m, const rbdi_task *t) {
    return rbd_minverse(m, t->w, t->x[0], t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_rnea(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *a, const RBD_REAL *f_ext,
                                         RBD_REAL *tau) {
    if (!v || !a) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_rnea, m, b, n, q, v, a, f_ext, tau, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_bias(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *f_ext, RBD_REAL *c) {
    if (!v) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_rnea, m, b, n, q, v, NULL, f_ext, c, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_crba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         RBD_REAL *M) {
    return rbdi_batch_one(rbdi_lanes_crba, m, b, n, q, NULL, NULL, NULL, M, rbd_nv(m) * rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_crba_packed(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                RBD_REAL *H) {
    return rbdi_batch_one(rbdi_lanes_crba_packed, m, b, n, q, NULL, NULL, NULL, H, rbd_packed_size(m));
}

RBDI_BATCH_API rbd_status rbd_batch_aba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                        const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                        RBD_REAL *a) {
    if (!v || !tau) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_aba, m, b, n, q, v, tau, f_ext, a, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_fd_cholesky(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                                RBD_REAL *a) {
    if (!v || !tau) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_fd_cholesky, m, b, n, q, v, tau, f_ext, a, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_minverse(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             RBD_REAL *Minv) {
    return rbdi_batch_one(rbdi_lanes_minverse, m, b, n, q, NULL, NULL, NULL, Minv, rbd_nv(m) * rbd_nv(m));
}

/* Arguments of rbd_jacobian beside q. */
typedef struct rbdi_lane_point {
    int body;
    rbd_axes axes;
    const rbd_real *point;
} rbdi_lane_point;

RBDI_LOCAL rbd_status rbdi_lanes_jacobian(const rbd_model *m, const rbdi_task *t) {
    const rbdi_lane_point *at = (const rbdi_lane_point *)t->more;
    (void)rbd_kinematics(m, t->w, t->x[0], NULL, NULL); /* arguments are checked */
    return rbd_jacobian(m, t->w, at->body, at->point, at->axes, t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_jacobian(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             int body, const RBD_REAL point[3], rbd_axes axes, RBD_REAL *J) {
    rbdi_task t = rbdi_task_of(q, NULL, NULL, NULL);
    rbdi_lane_point at;
    rbd_real lanes[3];

    for (int k = 0; k < 3; ++k) lanes[k] = rbdi_set(point ? point[k] : RBD_C(0));
    at.body = body;
    at.axes = axes;
    at.point = lanes;
    t.more = &at;

    rbdi_task_output(&t, 0, J, 6 * rbd_nv(m));
    return J ? rbdi_batch_run(rbdi_lanes_jacobian, m, b, n, b ? b->y : NULL, &t) : RBD_ERR_NULL;
}

RBDI_LOCAL rbd_status rbdi_lanes_momentum(const rbd_model *m, const rbdi_task *t) {
    (void)rbd_kinematics(m, t->w, t->x[0], t->x[1], t->x[2]);
    return rbd_momentum(m, t->w, t->y[0], t->y[1]);
}

RBDI_BATCH_API rbd_status rbd_batch_momentum(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             const RBD_REAL *v, const RBD_REAL *a, RBD_REAL *h,
                                             RBD_REAL *h_dot) {
    rbdi_task t = rbdi_task_of(q, v, a, NULL);
    rbdi_task_output(&t, 0, h, 6);
    rbdi_task_output(&t, 1, h_dot, 6);
    return rbdi_batch_run(rbdi_lanes_momentum, m, b, n, b ? b->y : NULL, &t);
}

RBDI_BATCH_API int rbd_batch_singular(const rbd_batch *b, int *dof) {
    if (dof) *dof = b ? b->dof : -1;
    return b ? b->state : -1;
}

#endif
