/* run_time.h - the calls of rbd.h for a model known at run time: one state each.
   SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "../bench.h"
#include "rbd_derivatives.h"
#include "constrained.h"

#define VARIANT RUN_TIME
#define N_LANES 1
#define ONLY_ROBOT NULL
#define WIDTH 1

/* A work, and the memory of rbd_derivatives.h and rbd_constraints.h behind it. */

enum { ALIGNMENT = 64 };

static size_t aligned(size_t size) { return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT; }

static size_t constraints_size(const rbd_model *m, int algorithm) {
    rbd_constraint list[MAX_CONTACTS];
    const int n = contacts_of(m, algorithm, list);
    return n > 0 ? aligned(rbd_constraint_set_size(m, list, n)) : 0;
}

static rbd_status init_constraints(const rbd_model *m, struct rbd_memory *own, int algorithm,
                                   unsigned char *memory) {
    rbd_constraint list[MAX_CONTACTS];
    rbd_constraint_set *c = NULL;
    const int n = contacts_of(m, algorithm, list);
    const rbd_status status = n > 0 ? rbd_constraint_set_init(m, own->work, list, n, memory,
                                                              constraints_size(m, algorithm), &c, NULL)
                                    : RBD_OK;
    own->constraints[algorithm - CONSTRAINED] = c;
    return status;
}

static size_t work_size(const void *model) {
    size_t size = aligned(sizeof(struct rbd_memory)) + aligned(rbd_work_size(model)) +
                  aligned(rbd_derivatives_size(model));
    for (int k = CONSTRAINED; k < ALGORITHMS; k++) size += constraints_size(model, k);
    return size;
}

static rbd_status work_init(const void *model, void *memory, size_t size, void **out) {
    struct rbd_memory *own = memory;
    unsigned char *p = (unsigned char *)memory + aligned(sizeof *own);
    rbd_work *w = NULL;
    rbd_derivatives *d = NULL;
    rbd_status status = size < work_size(model) ? RBD_ERR_MEMORY : RBD_OK;
    if (status == RBD_OK) status = rbd_work_init(model, p, rbd_work_size(model), &w);
    p += aligned(rbd_work_size(model));
    if (status == RBD_OK) status = rbd_derivatives_init(model, w, p, rbd_derivatives_size(model), &d);
    p += aligned(rbd_derivatives_size(model));
    if (status != RBD_OK) return status;
    own->work = w;
    own->derivatives = d;
    for (int k = CONSTRAINED; k < ALGORITHMS && status == RBD_OK; p += constraints_size(model, k++))
        status = init_constraints(model, own, k, p);
    *out = own;
    return status;
}

static rbd_work *work_of(void *memory) { return ((struct rbd_memory *)memory)->work; }

static rbd_derivatives *derivatives_of(void *memory) { return ((struct rbd_memory *)memory)->derivatives; }

static rbd_status set_gravity(void *work, const double gravity[3]) {
    const rbd_const g[3] = {(rbd_const)gravity[0], (rbd_const)gravity[1], (rbd_const)gravity[2]};
    return rbd_set_gravity(work_of(work), g);
}

static rbd_status call_id(const void *model, void *work, int n, const void *q, const void *v, const void *a,
                          void *tau) {
    (void)n;
    return rbd_rnea(model, work_of(work), q, v, a, NULL, tau);
}

static rbd_status call_mm(const void *model, void *work, int n, const void *q, const void *v, const void *x,
                          void *M) {
    (void)n, (void)v, (void)x;
    return rbd_crba(model, work_of(work), q, M);
}

static rbd_status call_mm_packed(const void *model, void *work, int n, const void *q, const void *v,
                                 const void *x, void *H) {
    (void)n, (void)v, (void)x;
    return rbd_crba_packed(model, work_of(work), q, H);
}

static rbd_status call_fd(const void *model, void *work, int n, const void *q, const void *v, const void *tau,
                          void *a) {
    (void)n;
    return rbd_aba(model, work_of(work), q, v, tau, NULL, a);
}

static rbd_status call_fd_cholesky(const void *model, void *work, int n, const void *q, const void *v,
                                   const void *tau, void *a) {
    (void)n;
    return rbd_fd_cholesky(model, work_of(work), q, v, tau, NULL, a);
}

/* Of a robot with a base its torques are 0 and the accelerations of all joints given; of another every second
   joint is like the base. */
static rbd_status call_hybrid(const void *model, void *work, int n, const void *q, const void *v,
                              const void *a, void *out) {
    enum { MOST = 256 };
    const int nv = rbd_nv(model), base = rbd_nq(model) > nv;
    rbd_real *acceleration = out, *tau = acceleration + nv;
    unsigned char given[MOST];
    (void)n;
    if (nv > MOST) return RBD_ERR_MEMORY;
    for (int i = 0; i < nv; i++) {
        acceleration[i] = ((const rbd_real *)a)[i];
        given[i] = (unsigned char)(base ? i >= 6 : i % 2);
        tau[i] = 0;
    }
    return rbd_hybrid(model, work_of(work), q, v, given, acceleration, tau, NULL);
}

/* The same by the call that needs no flags; of a robot without a base plain inverse dynamics. */
static rbd_status call_free_base(const void *model, void *work, int n, const void *q, const void *v,
                                 const void *a, void *out) {
    const int nv = rbd_nv(model);
    rbd_real *acceleration = out, *tau = acceleration + nv;
    (void)n;
    for (int i = 0; i < nv; i++) acceleration[i] = ((const rbd_real *)a)[i], tau[i] = 0;
    return rbd_id_free_base(model, derivatives_of(work), q, v, acceleration, tau, NULL);
}

static rbd_status call_minv(const void *model, void *work, int n, const void *q, const void *v, const void *x,
                            void *Minv) {
    (void)n, (void)v, (void)x;
    return rbd_minverse(model, work_of(work), q, Minv);
}

/* World axes, at the origin of the last body. */
static rbd_status call_jacobian(const void *model, void *work, int n, const void *q, const void *v,
                                const void *x, void *J) {
    rbd_status status = rbd_kinematics(model, work_of(work), q, NULL, NULL);
    (void)n, (void)v, (void)x;
    return status != RBD_OK ? status
                            : rbd_jacobian(model, work_of(work), rbd_nb(model) - 1, NULL, RBD_WORLD_AXES, J);
}

/* The Jacobian, then rotation and origin of the body. */
static rbd_status call_body_jacobian(const void *model, void *work, int n, const void *q, const void *v,
                                     const void *x, void *out) {
    const int last = rbd_nb(model) - 1;
    rbd_work *w = work_of(work);
    rbd_real *J = out, *pose = J + 6 * rbd_nv(model);
    rbd_status status = rbd_body_kinematics(model, w, last, q, NULL, NULL);
    (void)n, (void)v, (void)x;
    if (status == RBD_OK) status = rbd_body_pose(model, w, last, pose, pose + 9);
    return status != RBD_OK ? status : rbd_jacobian(model, w, last, NULL, RBD_WORLD_AXES, J);
}

static rbd_status call_momentum_matrix(const void *model, void *work, int n, const void *q, const void *v,
                                       const void *x, void *A) {
    (void)n, (void)v, (void)x;
    return rbd_momentum_matrix(model, derivatives_of(work), q, NULL, A, NULL);
}

static rbd_status call_coriolis(const void *model, void *work, int n, const void *q, const void *v,
                                const void *x, void *C) {
    (void)n, (void)x;
    return rbd_coriolis(model, derivatives_of(work), q, v, C);
}

static rbd_status call_regressor(const void *model, void *work, int n, const void *q, const void *v,
                                 const void *a, void *Y) {
    (void)n;
    return rbd_regressor(model, derivatives_of(work), q, v, a, Y);
}

static rbd_status call_id_derivatives(const void *model, void *work, int n, const void *q, const void *v,
                                      const void *a, void *out) {
    const int nv = rbd_nv(model);
    rbd_real *dq = out, *dv = dq + nv * nv;
    (void)n;
    return rbd_id_derivatives(model, derivatives_of(work), q, v, a, NULL, dq, dv, NULL);
}

static rbd_status call_id_derivatives_mm(const void *model, void *work, int n, const void *q, const void *v,
                                         const void *a, void *out) {
    const int nv = rbd_nv(model);
    rbd_real *dq = out, *dv = dq + nv * nv, *M = dv + nv * nv;
    (void)n;
    return rbd_id_derivatives(model, derivatives_of(work), q, v, a, NULL, dq, dv, M);
}

static rbd_status call_fd_derivatives(const void *model, void *work, int n, const void *q, const void *v,
                                      const void *tau, void *out) {
    const int nv = rbd_nv(model);
    rbd_real *dq = out, *dv = dq + nv * nv, *Minv = dv + nv * nv;
    (void)n;
    return rbd_fd_derivatives(model, derivatives_of(work), q, v, tau, NULL, NULL, dq, dv, Minv);
}

static rbd_status constrained(const void *model, void *work, int algorithm, const void *q, const void *v,
                              const void *tau, void *out) {
    rbd_constraint_set *c = ((struct rbd_memory *)work)->constraints[algorithm - CONSTRAINED];
    rbd_real *a = out, *lambda = a + rbd_nv(model);
    return rbd_constrained_fd(model, c, q, v, tau, NULL, a, lambda);
}

static rbd_status call_constrained(const void *model, void *work, int n, const void *q, const void *v,
                                   const void *tau, void *out) {
    (void)n;
    return constrained(model, work, CONSTRAINED, q, v, tau, out);
}

static rbd_status call_constrained_hand(const void *model, void *work, int n, const void *q, const void *v,
                                        const void *tau, void *out) {
    (void)n;
    return constrained(model, work, CONSTRAINED_HAND, q, v, tau, out);
}

#define CAN can
#define CALLS \
    [ID] = call_id, [MM] = call_mm, [MM_PACKED] = call_mm_packed, [FD] = call_fd, \
    [FD_CHOLESKY] = call_fd_cholesky, [HYBRID] = call_hybrid, [FREE_BASE] = call_free_base, \
    [MINV] = call_minv, [JACOBIAN] = call_jacobian, [BODY_JACOBIAN] = call_body_jacobian, \
    [MOMENTUM_MATRIX] = call_momentum_matrix, [CORIOLIS] = call_coriolis, [REGRESSOR] = call_regressor, \
    [ID_DERIVATIVES] = call_id_derivatives, [ID_DERIVATIVES_MM] = call_id_derivatives_mm, \
    [FD_DERIVATIVES] = call_fd_derivatives, [CONSTRAINED] = call_constrained, \
    [CONSTRAINED_HAND] = call_constrained_hand
