#ifndef RBDI_MODEL_WORK_INIT_H
#define RBDI_MODEL_WORK_INIT_H
#include "api/model.h"
#include "model/work.h"
#include "base/pieces.h"
#include "base/memory.h"
#include "model/features.h"

/* ---- work [work code] ---- */

RBDI_API size_t rbd_work_size(const rbd_model *m) {
    if (!m) return 0;
    return RBDI_WORK_BYTES(m->nl, m->nblock, m->nbranch, m->nv + m->nmimic, m->nmimic ? m->nq + m->nmimic : 0,
                           m->nv, m->nh + m->nhx);
}

#if RBDI_REPRODUCIBLE
/* Whether products, sums and roots are rounded one by one and to nearest, and denormals are numbers.
   1 - x low finds libgcc's double sums on ARMv7-M: they are wrong if one exponent is 33 above the other and
   that of the result is lower. The root of 1 + 3 eps is 1 + 3/2 eps - 9/8 eps^2: one that is rounded to 80
   bits before loses the last term, and then is 1 + 2 eps. */
RBDI_COLD int rbdi_rounds(void) {
    const volatile RBD_REAL given[5] = {1, RBDI_EPS, 1 + RBDI_EPS, 1 + 2 * RBDI_EPS, RBDI_TINY};
    const RBD_REAL one = given[0], e = given[1], x = given[2], square = given[3], tiny = given[4];
    const volatile RBD_REAL half = tiny * (RBD_REAL)0.5, low = e * 524288 /* double: 2^-33 */;
    const volatile RBD_REAL root = RBD_SQRT(one + 3 * e);
    return root == x && x * x - square == 0 && one + e * (RBD_REAL)0.75 == x &&
           one + e * (RBD_REAL)0.25 == one && half > 0 && half + half == tiny && one - x * low == one - low;
}
#endif

RBDI_API rbd_status rbd_work_init(const rbd_model *m, void *memory, size_t size, rbd_work **work) {
    unsigned char *p;
    rbd_work *w;
    int n, nqx;

    if (work) *work = NULL;
    if (!m || !memory || !work) return RBD_ERR_NULL;
    if (m->version != RBD_MODEL_VERSION || m->scalar != (int)sizeof(rbd_const)) return RBD_ERR_VERSION;
    if (!rbdi_supported(m)) return RBD_ERR_LEFT_OUT;
#if RBDI_REPRODUCIBLE
    if (!rbdi_rounds()) return RBD_ERR_ARITHMETIC;
#endif
    if (size < rbd_work_size(m)) return RBD_ERR_MEMORY;

    n = m->nv + m->nmimic;
    nqx = m->nmimic ? m->nq + m->nmimic : 0;

    p = rbdi_aligned(memory);
    w = (rbd_work *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_work)));
    for (int k = 0; k < RBDI_SHAPE; ++k) w->shape[k] = m->shape[k];
    w->gravity = m->gravity;
    rbdi_require_ieee();
    w->singular = rbdi_massless_dof(m);
    w->kinematics_of = RBDI_NO_KINEMATICS;
#define RBDI_TAKE(type, name, length) w->name = (type *)rbdi_take(&p, (int)(length), sizeof(type));
    RBDI_WORK_ARRAYS(RBDI_TAKE, m->nl, m->nblock, m->nbranch, n, nqx, m->nv, m->nh + m->nhx)
#undef RBDI_TAKE

    for (int k = 0; k < n; ++k) w->zero[k] = rbdi_zero();
    for (int k = 0; k < 6 * RBDI_STRIDE(n); ++k) w->F[k] = rbdi_zero();
    for (int k = 0; k < (int)RBDI_PADDED(m->nl); ++k) w->angle[k] = w->quarters[k] = rbdi_zero();
    w->F += RBDI_CHUNK;
    *work = w;
    return RBD_OK;
}

RBDI_API rbd_status rbd_set_gravity(rbd_work *w, const rbd_const gravity[3]) {
    if (!w || !gravity) return RBD_ERR_NULL;
    w->gravity.x = gravity[0];
    w->gravity.y = gravity[1];
    w->gravity.z = gravity[2];
    return RBD_OK;
}

RBDI_API rbd_status rbd_get_gravity(const rbd_work *w, rbd_const gravity[3]) {
    if (!w || !gravity) return RBD_ERR_NULL;
    gravity[0] = w->gravity.x;
    gravity[1] = w->gravity.y;
    gravity[2] = w->gravity.z;
    return RBD_OK;
}

#endif
