/* lanes.h - the calls of rbd_batch.h: RBD_LANES states in each SIMD instruction.
   SPDX-License-Identifier: MIT */
#define RBD_BATCH_IMPLEMENTATION
#include "../bench.h"
#include "rbd_derivatives.h"
#include "constrained.h"
#include "rbd_batch.h"

#define VARIANT LANES
#define BLOCKS_VARIANT BLOCKS
#define N_LANES RBD_LANES
#define ONLY_ROBOT NULL
#define WIDTH BATCH

enum { ALIGNMENT = 64 };

static size_t aligned(size_t size) { return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT; }

static size_t constraints_size(const rbd_model *m, int algorithm) {
    rbd_constraint list[MAX_CONTACTS];
    const int n = contacts_of(m, algorithm, list);
    return n > 0 ? aligned(rbd_batch_constraint_set_size(m, list, n)) : 0;
}

static rbd_status init_constraints(const rbd_model *m, struct rbd_memory *own, int algorithm,
                                   unsigned char *memory) {
    rbd_constraint list[MAX_CONTACTS];
    rbd_batch_constraint_set *c = NULL;
    const int n = contacts_of(m, algorithm, list);
    const rbd_status status = n > 0 ? rbd_batch_constraint_set_init(m, own->work, list, n, memory,
                                                                    constraints_size(m, algorithm), &c, NULL)
                                    : RBD_OK;
    own->constraints[algorithm - CONSTRAINED] = c;
    return status;
}

static size_t work_size(const void *model) {
    size_t size = aligned(sizeof(struct rbd_memory)) + aligned(rbd_batch_size(model)) +
                  aligned(rbd_batch_derivatives_size(model));
    for (int k = CONSTRAINED; k < ALGORITHMS; k++) size += constraints_size(model, k);
    return size;
}

static rbd_status work_init(const void *model, void *memory, size_t size, void **out) {
    struct rbd_memory *own = memory;
    unsigned char *p = (unsigned char *)memory + aligned(sizeof *own);
    rbd_batch *b = NULL;
    rbd_batch_derivatives *d = NULL;
    rbd_status status = size < work_size(model) ? RBD_ERR_MEMORY : RBD_OK;
    if (status == RBD_OK) status = rbd_batch_init(model, p, rbd_batch_size(model), &b);
    p += aligned(rbd_batch_size(model));
    if (status == RBD_OK)
        status = rbd_batch_derivatives_init(model, b, p, rbd_batch_derivatives_size(model), &d);
    p += aligned(rbd_batch_derivatives_size(model));
    if (status != RBD_OK) return status;
    own->work = b;
    own->derivatives = d;
    for (int k = CONSTRAINED; k < ALGORITHMS && status == RBD_OK; p += constraints_size(model, k++))
        status = init_constraints(model, own, k, p);
    *out = own;
    return status;
}

#ifdef BLOCKS_LIBRARY
static rbd_status work_init_blocks(const void *model, void *memory, size_t size, void **out) {
    const rbd_status status = work_init(model, memory, size, out);
    return status ? status : rbd_batch_set_layout(((struct rbd_memory *)*out)->work, RBD_BLOCKS);
}
#endif

static rbd_batch *batch_of(void *memory) { return ((struct rbd_memory *)memory)->work; }

static rbd_batch_derivatives *derivatives_of(void *memory) {
    return ((struct rbd_memory *)memory)->derivatives;
}

static rbd_status set_gravity(void *work, const double gravity[3]) {
    const rbd_const g[3] = {(rbd_const)gravity[0], (rbd_const)gravity[1], (rbd_const)gravity[2]};
    return rbd_batch_set_gravity(batch_of(work), g);
}

static rbd_status call_id(const void *model, void *work, int n, const void *q, const void *v, const void *a,
                          void *tau) {
    return rbd_batch_rnea(model, batch_of(work), n, q, v, a, NULL, tau);
}

static rbd_status call_mm(const void *model, void *work, int n, const void *q, const void *v, const void *x,
                          void *M) {
    (void)v, (void)x;
    return rbd_batch_crba(model, batch_of(work), n, q, M);
}

static rbd_status call_mm_packed(const void *model, void *work, int n, const void *q, const void *v,
                                 const void *x, void *H) {
    (void)v, (void)x;
    return rbd_batch_crba_packed(model, batch_of(work), n, q, H);
}

static rbd_status call_fd(const void *model, void *work, int n, const void *q, const void *v, const void *tau,
                          void *a) {
    return rbd_batch_aba(model, batch_of(work), n, q, v, tau, NULL, a);
}

static rbd_status call_fd_cholesky(const void *model, void *work, int n, const void *q, const void *v,
                                   const void *tau, void *a) {
    return rbd_batch_fd_cholesky(model, batch_of(work), n, q, v, tau, NULL, a);
}

static rbd_status call_minv(const void *model, void *work, int n, const void *q, const void *v, const void *x,
                            void *Minv) {
    (void)v, (void)x;
    return rbd_batch_minverse(model, batch_of(work), n, q, Minv);
}

static rbd_status call_jacobian(const void *model, void *work, int n, const void *q, const void *v,
                                const void *x, void *J) {
    (void)v, (void)x;
    return rbd_batch_jacobian(model, batch_of(work), n, q, rbd_nb(model) - 1, NULL, RBD_WORLD_AXES, J);
}

static rbd_status call_momentum_matrix(const void *model, void *work, int n, const void *q, const void *v,
                                       const void *x, void *A) {
    (void)v, (void)x;
    return rbd_batch_momentum_matrix(model, derivatives_of(work), n, q, NULL, A, NULL);
}

static rbd_status call_coriolis(const void *model, void *work, int n, const void *q, const void *v,
                                const void *x, void *C) {
    (void)x;
    return rbd_batch_coriolis(model, derivatives_of(work), n, q, v, C);
}

static rbd_status call_id_derivatives(const void *model, void *work, int n, const void *q, const void *v,
                                      const void *a, void *out) {
    RBD_REAL *dq = out, *dv = dq + BATCH * rbd_nv(model) * rbd_nv(model);
    return rbd_batch_id_derivatives(model, derivatives_of(work), n, q, v, a, NULL, dq, dv, NULL);
}

static rbd_status call_id_derivatives_mm(const void *model, void *work, int n, const void *q, const void *v,
                                         const void *a, void *out) {
    const int part = BATCH * rbd_nv(model) * rbd_nv(model);
    RBD_REAL *dq = out, *dv = dq + part, *M = dv + part;
    return rbd_batch_id_derivatives(model, derivatives_of(work), n, q, v, a, NULL, dq, dv, M);
}

static rbd_status call_fd_derivatives(const void *model, void *work, int n, const void *q, const void *v,
                                      const void *tau, void *out) {
    const int part = BATCH * rbd_nv(model) * rbd_nv(model);
    RBD_REAL *dq = out, *dv = dq + part, *Minv = dv + part;
    return rbd_batch_fd_derivatives(model, derivatives_of(work), n, q, v, tau, NULL, NULL, dq, dv, Minv);
}

static rbd_status constrained(const void *model, void *work, int algorithm, int n, const void *q,
                              const void *v, const void *tau, void *out) {
    rbd_batch_constraint_set *c = ((struct rbd_memory *)work)->constraints[algorithm - CONSTRAINED];
    RBD_REAL *a = out, *lambda = a + BATCH * rbd_nv(model);
    return rbd_batch_constrained_fd(model, c, n, q, v, tau, NULL, a, lambda);
}

static rbd_status call_constrained(const void *model, void *work, int n, const void *q, const void *v,
                                   const void *tau, void *out) {
    return constrained(model, work, CONSTRAINED, n, q, v, tau, out);
}

static rbd_status call_constrained_hand(const void *model, void *work, int n, const void *q, const void *v,
                                        const void *tau, void *out) {
    return constrained(model, work, CONSTRAINED_HAND, n, q, v, tau, out);
}

#define CAN can
#define CALLS \
    [ID] = call_id, [MM] = call_mm, [MM_PACKED] = call_mm_packed, [FD] = call_fd, \
    [FD_CHOLESKY] = call_fd_cholesky, [MINV] = call_minv, [JACOBIAN] = call_jacobian, \
    [MOMENTUM_MATRIX] = call_momentum_matrix, [CORIOLIS] = call_coriolis, \
    [ID_DERIVATIVES] = call_id_derivatives, [ID_DERIVATIVES_MM] = call_id_derivatives_mm, \
    [FD_DERIVATIVES] = call_fd_derivatives, [CONSTRAINED] = call_constrained, \
    [CONSTRAINED_HAND] = call_constrained_hand
