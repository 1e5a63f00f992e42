#ifndef RBDI_DERIVATIVES_MOMENTUM_H
#define RBDI_DERIVATIVES_MOMENTUM_H
#include "derivatives/base_entries.h"
#include "derivatives/memory.h"

/* ---- momentum [momentum code] ----
   A (Orin, Goswami and Lee 2013) has the columns F_i of RBDA table 6.2 about the centre of mass. */

/* Position in the world of the common origin of a root's tree: the root's position in the world less that
   in the common frame. */
RBDI_INLINE rbdi_v3 rbdi_place_of(const rbd_model *m, const rbd_derivatives *d, int root) {
    const rbdi_link *l = &m->link[root];
    const rbdi_pose X = rbdi_common_pose(m, d, root);

    if (rbdi_is(l, RBDI_BLOCK)) return rbdi_sub(d->work->block[l->block].X.r, X.r);
    return rbdi_sub(rbdi_add(rbdi_vec_c(l->r), rbdi_scale(rbdi_trig_of(m, d->work, root, rbdi_flags(l)).d,
                                                          rbdi_vec(X.E.zx, X.E.zy, X.E.zz))),
                    X.r);
}

/* n += offset x f of a force in the lanes. */
RBDI_INLINE void rbdi_shift_moment(rbd_real *in, rbdi_v3 offset) {
    rbdi_force F = rbdi_load_force(in, RBDI_BATCH);
    F.n = rbdi_add(F.n, rbdi_cross(offset, F.f));
    rbdi_store_force(in, RBDI_BATCH, F);
}

/* Moves positions, F and wrenches of the other roots' trees to the first root's origin: A is in one frame. */
RBDI_PART void rbdi_join_origins(const rbd_model *m, rbd_derivatives *d) {
    rbdi_v3 offset = rbdi_vec0();
    int others = 0; /* whether the first root's tree is behind */

    for (const rbdi_segment *r = d->segment + 1; r < d->segment + d->segments; ++r) {
        if (r->parent < 0) offset = rbdi_sub(rbdi_place_of(m, d, r->link), rbdi_place_of(m, d, 0));
        others |= r->parent < 0;
        if (!others) continue;

        for (int k = r->first; k < r->end; ++k) {
            rbd_real *x = RBDI_OF(d, k, x);
            rbdi_store_vec(x, RBDI_BATCH, rbdi_add(rbdi_load_vec(x, RBDI_BATCH), offset));
            rbdi_shift_moment(RBDI_OF(d, k, F), offset);
            rbdi_shift_moment(RBDI_OF(d, k, sum.f), offset);
        }
    }
}

/* The centre of mass relative to that origin, h / mass of all bodies; 0 without mass. With a free base h of
   the whole tree is that, for no mass was moved past the base. Otherwise it is summed over the bodies as
   described. */
RBDI_PART rbdi_v3 rbdi_common_com(const rbd_derivatives *d) {
    const rbd_real share = rbdi_set(d->mass > 0 ? RBD_C(1) / d->mass : RBD_C(0));
    rbdi_sum x = rbdi_sum_of_none(), y = x, z = x;

    if (d->base) return rbdi_scale(share, rbdi_load_vec(RBDI_OF(d, d->base - 1, sum.h), RBDI_BATCH));
    for (int b = 0; b < d->batches; ++b) {
        const rbdi_columns *cols = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        const rbdi_b3 h = rbdi_b_rotate(cols, own->all_hx, own->all_hy, own->all_hz);
        x = rbdi_sum_and(x, h.x + cols->x.x * own->all_m);
        y = rbdi_sum_and(y, h.y + cols->x.y * own->all_m);
        z = rbdi_sum_and(z, h.z + cols->x.z * own->all_m);
    }

    return rbdi_scale(share, rbdi_vec(rbdi_sum_value(x), rbdi_sum_value(y), rbdi_sum_value(z)));
}

/* Stores F of all dofs as a matrix, in world axes, with moments about the centre of mass. With three rows:
   f only, which no shift of the origin changes, times scale. */
RBDI_INLINE void rbdi_put_momenta(const rbd_derivatives *d, rbdi_v3 com, rbd_real scale, int rows,
                                  rbd_real *out) {
    const rbd_model *m = d->model;
    const rbdi_mat *E = &d->work->block->X.E; /* if there is a base */
    const rbd_real *x = rows == 3 ? RBDI_FIELD(d, stage.momentum.f) : RBDI_FIELD(d, stage.momentum);
    if (d->base) rbdi_base_columns(d, RBDI_WANT_M);

    /* n - com x f, from a free base's axes to the world's */
    for (int b = 0; b < d->batches; ++b) {
        rbdi_bforce F = d->columns[b].F;
        F.n = rbdi_b_cross_add(F.n, F.f, rbdi_b_all(com));
        if (d->base) {
            F.n = rbdi_b_mul_t(*E, F.n);
            F.f = rbdi_b_mul_t(*E, F.f);
        }
        F.f = rbdi_b_vec(F.f.x * scale, F.f.y * scale, F.f.z * scale);
        d->columns[b].stage.momentum = F;
    }

    if (!rbdi_mimics(m) && 2 * m->nv >= RBDI_BATCH) {
        rbdi_put_components(d, x, rows, rows * m->nv, out);
        return;
    }

    /* the columns of mimic joints are added to those of the joints that they follow */
    rbdi_clear(out, rows * m->nv);
    for (int i = 0; i < d->n; ++i) {
        const rbdi_entry *e = &d->entry[i];
        const rbd_real ratio = rbdi_ratio(m, e->source);
        for (int j = 0; j < rows; ++j) {
            rbd_real *to = &out[j * m->nv + e->user];
            *to = *to + ratio * x[e->at + j * RBDI_BATCH];
        }
    }
}

/* The wrench f of table 5.1 on all that moves, at a = 0 and without gravity: the sum over the roots. */
RBDI_PART void rbdi_put_momentum_bias(const rbd_model *m, const rbd_derivatives *d, rbdi_v3 com,
                                      rbd_real *A_dot_v) {
    rbdi_force F = rbdi_force0();

    for (const rbdi_segment *r = d->segment; r < d->segment + d->segments; ++r) {
        const rbd_real *in = RBDI_OF(d, rbdi_last_dof(m, r->link), sum.f);
        if (r->parent < 0) F = rbdi_force_add(F, rbdi_load_force(in, RBDI_BATCH));
    }
    F.n = rbdi_sub(F.n, rbdi_cross(com, F.f));
    if (d->base) {
        F.n = rbdi_mul_t(d->work->block[0].X.E, F.n);
        F.f = rbdi_mul_t(d->work->block[0].X.E, F.f);
    }
    rbdi_store_force(A_dot_v, 1, F);
}

RBDI_API rbd_status rbd_momentum_matrix(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                        const rbd_real *v, rbd_real *A, rbd_real A_dot_v[6]) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && A && (v || !A_dot_v));
    const int need = A_dot_v ? RBDI_NEED_WRENCH | RBDI_NEED_WHOLE : 0;
    rbdi_v3 com;
    if (status) return status;

    rbdi_common(m, d, q, v, d->work->zero, rbdi_no_gravity(), NULL, need);
    rbdi_join_origins(m, d);
    com = rbdi_common_com(d);
    if (A_dot_v) rbdi_put_momentum_bias(m, d, com, A_dot_v);
    rbdi_put_momenta(d, com, rbdi_set(RBD_C(1)), 6, A);
    return RBD_OK;
}

RBDI_API rbd_status rbd_com_jacobian(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, rbd_real *J) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && J);
    const rbd_const share = !status && d->mass > 0 ? RBD_C(1) / d->mass : RBD_C(0);
    if (status) return status;

    rbdi_common(m, d, q, NULL, NULL, rbdi_no_gravity(), NULL, 0);
    rbdi_put_momenta(d, rbdi_vec0(), rbdi_set(share), 3, J);
    return RBD_OK;
}

/* ---- Coriolis matrix [coriolis code] ---- */

RBDI_API rbd_status rbd_coriolis(const rbd_model *m, rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                                 rbd_real *C) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && C);
    if (status) return status;

    rbdi_common(m, d, q, v, NULL, rbdi_no_gravity(), NULL, RBDI_NEED_V | RBDI_NEED_CORIOLIS);
    rbdi_put_entries(m, d, NULL, C, NULL, 1);
    return RBD_OK;
}

#endif
