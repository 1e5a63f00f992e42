/* pivots_call.c - forward dynamics by one build of rbd.h, for pivots.c: -DPIVOTS_CALL=NAME,
   -DRBD_REAL=SCALAR, and -DRBDI_NOISE=0 for one that takes any positive pivot. SPDX-License-Identifier: MIT
 */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "pivots.h"

static union {
    long double align;
    unsigned char bytes[1 << 23];
} model_memory, work_memory;

int PIVOTS_CALL(const pivots_system *s, int cholesky, double *a) {
    const rbd_model *m;
    rbd_work *w;
    rbd_real q[PIVOTS_MAX_Q], v[PIVOTS_MAX_V], x[PIVOTS_MAX_V];
    rbd_status status = rbd_model_build(s->bodies, s->nb, &model_memory, sizeof model_memory, &m, NULL);
    if (status == RBD_OK) status = rbd_work_init(m, &work_memory, sizeof work_memory, &w);
    if (status != RBD_OK) return status;
    for (int i = 0; i < s->nq; i++) q[i] = (rbd_real)s->q[i];
    for (int i = 0; i < s->nv; i++) {
        v[i] = (rbd_real)s->v[i];
        x[i] = (rbd_real)s->tau[i];
    }
    status = cholesky ? rbd_fd_cholesky(m, w, q, v, x, NULL, x) : rbd_aba(m, w, q, v, x, NULL, x);
    for (int i = 0; i < s->nv; i++) a[i] = (double)x[i];
    return status;
}
