#ifndef RBDI_CONSTRAINTS_WEIGHTS_H
#define RBDI_CONSTRAINTS_WEIGHTS_H
#include "constraints/calls.h"

/* ---- weights [weights] ----
   rbdi_multipliers solves weighted least squares, too. With a diagonal matrix D in place of M, so that L = 1
   and Y = J',

       J (x + d) = target,   d' D d least:   d = D^-1 J' lambda

   rbd_constrained_id looks for lambda of least lambda' W lambda with

       J_p' lambda = tau_p

   p: the joints without motors, tau: the torques without contacts. It sets Y = J' W^-1/2, x_p = -tau_p, other
   entries of x to 0, and D^-1 to 1 for these joints and to 0 for others. Then the equations of
   rbdi_multipliers

       Y' D^-1 Y mu = -Y' D^-1 x,   mu = W^1/2 lambda

   are the normal equations of the least squares problem, and mu has the least norm. */

/* Whether n weights are 0, or from RBDI_LEAST_WEIGHT to RBDI_MOST_WEIGHT. NULL: all are 1. */
RBDI_LOCAL int rbdi_weights_fit(const rbd_const *weight, int n) {
    for (int k = 0; weight && k < n; ++k) {
        const int none = weight[k] >= 0 && weight[k] <= 0;

        if (!none && !(weight[k] >= RBDI_LEAST_WEIGHT && weight[k] <= RBDI_MOST_WEIGHT)) return 0;
    }
    return 1;
}

/* The weight that stands for 0: the share RBDI_FREE of the least of the others. */
RBDI_LOCAL rbd_const rbdi_free_weight(const rbd_const *weight, int n) {
    rbd_const least = 0;
    for (int k = 0; weight && k < n; ++k)
        if (weight[k] > 0 && !(least > 0 && least < weight[k])) least = weight[k];
    return least > 0 ? least * RBDI_FREE : RBD_C(1);
}

/* 1 / weight k. free: the weight that stands for 0. */
RBDI_LOCAL rbd_const rbdi_inverse_weight(const rbd_const *weight, int k, rbd_const free) {
    return weight ? RBD_C(1) / (weight[k] > 0 ? weight[k] : free) : RBD_C(1);
}

/* Whether dof k has no motor: its flag is 0 or, without flags, its joint is a floating one. */
RBDI_LOCAL int rbdi_is_passive(const rbd_model *m, const unsigned char *actuated, int k) {
    return actuated ? !actuated[k] : m->frame[m->dof[k].body].type == RBD_FLOATING;
}

RBDI_API rbd_status rbd_constrained_id(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, const rbd_real *a, const rbd_real *f_ext,
                                       const unsigned char *actuated, const rbd_const *weight, rbd_real *tau,
                                       rbd_real *lambda) {
    const rbd_status status = rbdi_check_constrained(m, c, q && v && a && tau);
    rbd_real *root; /* of 1 / weight */
    rbd_const free;
    if (status) return status;
    if (!rbdi_weights_fit(weight, c->rows)) return RBD_ERR_RANGE;
    free = rbdi_free_weight(weight, c->rows);

    rbd_rnea(m, c->w, q, v, a, f_ext, c->x);
    rbdi_constraint_rows_at(m, c, q, NULL, 0);

    /* Y = J' W^-1/2, x, D^-1 */
    root = c->velocity; /* J v is not needed */
    for (int r = 0; r < c->rows; ++r) root[r] = rbdi_sqrt(rbdi_set(rbdi_inverse_weight(weight, r, free)));
    for (int k = 0; k < m->nv; ++k) {
        const int passive = rbdi_is_passive(m, actuated, k);
        for (int r = 0; r < c->rows; ++r) c->Y[k * c->stride + r] = c->Y[k * c->stride + r] * root[r];
        tau[k] = c->x[k];
        c->x[k] = passive ? -tau[k] : rbdi_zero();
        c->D_inverse[k] = rbdi_set(passive ? RBD_C(1) : RBD_C(0));
    }
    rbdi_clear(c->target, c->rows);
    (void)rbdi_multipliers(m, c, 0);

    /* tau - J' lambda */
    for (int k = 0; k < m->nv; ++k)
        tau[k] = tau[k] - rbdi_rows_product(&c->Y[k * c->stride], c->lambda, c->rows);
    for (int r = 0; lambda && r < c->rows; ++r) lambda[r] = c->lambda[r] * root[r];

    c->infeasible = -1; /* least squares always have a solution */
    return RBD_OK;
}

#endif
