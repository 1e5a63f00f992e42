#ifndef RBDI_CONSTRAINTS_ASSEMBLY_H
#define RBDI_CONSTRAINTS_ASSEMBLY_H
#include "api/manifold.h"
#include "constraints/weights.h"

/* ---- assembly [assembly] ----
   Newton's method. x is the distance of q_near from q. A step removes a share `size` of it and closes e:

       d = D^-1 J' lambda - size x,   J d = -e,   x = rbd_difference(q, q_near)

   The last steps have size 0: they reduce e alone. D: the weights. J stands for de/dq. Only if a constraint
   holds a single angular axis is de/dq itself used: J d = -e would not come nearer there at large turns. For
   two axes J is better: de/dq vanishes where they are 90 degrees off. Steps are cut to RBDI_LONGEST_STEP,
   because the rows change. */

/* The next step size, by Barzilai and Borwein (1988), from this step d = c->x and the one before it, d_0 =
   c->last_step, of sizes s and s_0:

       d_0' D d_0 / d_0' D (d_0 / s_0 - d / s)

   1 is right if J is constant; if J changes, steps of size 1 converge slowly or never. */
RBDI_LOCAL rbd_real rbdi_next_size(const rbd_constraint_set *c, int nv, rbd_real size, rbd_real last_size) {
    const rbd_real one = rbdi_set(RBD_C(1)), least = rbdi_set(RBDI_LEAST_STEP_SIZE),
                   most = rbdi_set(RBDI_MOST_STEP_SIZE);
    rbdi_mask none = rbdi_less(one, rbdi_zero());
    rbd_real square = rbdi_zero(), change = rbdi_zero(), next;

    for (int k = 0; k < nv; ++k) {
        const rbd_real weighted = c->last_step[k] / c->D_inverse[k];
        square = square + weighted * c->last_step[k];
        change = change + weighted * (c->last_step[k] / last_size - c->x[k] / size);
    }

    next = square * rbdi_reciprocal(change, RBDI_TINY, &none);
    next = rbdi_select(none, one, next); /* no step before this */
    next = rbdi_select(rbdi_less(most, next), most, next);
    return rbdi_select(rbdi_less(next, least), least, next);
}

/* Rows that depend on each other where the constraints hold may be independent beside such a place, by a tiny
   share. Their errors agree to e^2 only, and the rest, divided by that share, would be a step of any length.
   So a row t has no say in a step if both are small. With R' beta = e, in the order of [rank]:

       rest_t = e_t - sum_(i < t) R_it beta_i,   abs(rest_t) < size abs(e),   R_tt^2 < size^2 sum_i R_it^2

   size: the largest abs(e), at most RBDI_NEAR. The target of such a row becomes what the rows before it make
   of it. Returns whether there is one. */
RBDI_COLD rbdi_mask rbdi_ease_targets(rbd_constraint_set *c) {
    rbd_real *rest = c->slack, *beta = c->square;
    const rbd_real error = rbdi_largest(c->e, c->rows), most = rbdi_set(RBDI_NEAR);
    const rbd_real size = rbdi_select(rbdi_less(most, error), most, error), agreed = size * error;
    rbdi_mask eased = rbdi_less(error, error);

    for (int r = 0; r < c->rows; ++r) rest[r] = c->e[r];
    rbdi_permute(c, rest, 1, 0);

    for (int t = 0; t < c->rows; ++t) {
        const rbd_real *R = &c->R[t];
        const rbd_real own = R[t * c->stride] * R[t * c->stride];
        rbd_real square = own;
        rbdi_mask poor, ease;

        for (int i = 0; i < t; ++i) {
            rest[t] = rest[t] - R[i * c->stride] * beta[i];
            square = square + R[i * c->stride] * R[i * c->stride];
        }

        poor = rbdi_or(rbdi_dropped(c, t), rbdi_less(own, size * size * square));
        ease = rbdi_and(poor, rbdi_less(rbdi_abs(rest[t]), agreed));
        beta[t] = rbdi_select(ease, rbdi_zero(), rest[t] * c->R_inverse[t]);
        rest[t] = rbdi_select(ease, rest[t], rbdi_zero());
        eased = rbdi_or(eased, rbdi_and(ease, rbdi_not(rbdi_dropped(c, t))));
    }

    rbdi_permute(c, rest, 1, 1);
    for (int r = 0; r < c->rows; ++r) c->target[r] = c->target[r] + rest[r];
    return eased;
}

/* Computes the step c->x of this size: d = D^-1 J' lambda - size x, J d = target. */
RBDI_LOCAL void rbdi_assembly_direction(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                        const rbd_real *q_near, rbd_real size) {
    rbd_difference(m, q, q_near, c->x);
    for (int i = 0; i < m->nv; ++i) c->x[i] = -size * c->x[i];
    (void)rbdi_multipliers(m, c, 0);
}

/* Takes a step of this size. Returns its length before it is cut. */
RBDI_LOCAL rbd_real rbdi_assembly_step(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       rbd_real *q_near, rbd_real size) {
    const rbd_real limit = rbdi_set(RBDI_LONGEST_STEP);
    rbd_real length, cut;

    for (int r = 0; r < c->rows; ++r) c->target[r] = -c->e[r];
    rbdi_assembly_direction(m, c, q, q_near, size);
    if (c->pivoted && rbdi_any(rbdi_ease_targets(c))) rbdi_assembly_direction(m, c, q, q_near, size);

    length = rbdi_largest(c->x, m->nv);
    cut = rbdi_select(rbdi_less(limit, length), limit / (length + RBDI_TINY), rbdi_set(RBD_C(1)));
    rbd_integrate(m, q_near, c->x, cut, q_near);
    return length;
}

/* Computes q_near from q. */
RBDI_LOCAL void rbdi_assemble_position(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       rbd_real *q_near) {
    rbd_real size = rbdi_set(RBD_C(1)), last_size = size;
    int close = 0; /* the last steps that were taken */
    for (int k = 0; k < m->nq; ++k) q_near[k] = q[k];
    rbdi_clear(c->last_step, m->nv);

    for (int step = 0; close < RBDI_CLOSING_STEPS; ++step) {
        rbd_real length, next;

        rbdi_constraint_rows_at(m, c, q_near, NULL, RBDI_SLOPES);
        length = rbdi_assembly_step(m, c, q, q_near, close ? rbdi_zero() : size);
        if (close || step > RBDI_NEARING_STEPS || !rbdi_any(rbdi_less(size * RBDI_SHORT_STEP, length)))
            ++close;
        if (close) continue;

        next = rbdi_next_size(c, m->nv, size, last_size);
        last_size = size;
        size = next;
        for (int k = 0; k < m->nv; ++k) c->last_step[k] = c->x[k];
    }

    rbdi_constraint_rows_at(m, c, q_near, NULL, 1);
}

/* Computes v_near from v with the rows at q_near: J v_near = 0. Notes a row that this does not hold. */
RBDI_LOCAL void rbdi_assemble_velocity(const rbd_model *m, rbd_constraint_set *c, const rbd_real *v,
                                       rbd_real *v_near) {
    for (int k = 0; k < m->nv; ++k) c->x[k] = v[k];
    rbdi_clear(c->target, c->rows);
    (void)rbdi_multipliers(m, c, 0);
    if (rbdi_multipliers(m, c, 0)) rbdi_check_held(m, c); /* the second removes rounding */
    for (int k = 0; k < m->nv; ++k) v_near[k] = c->x[k];
}

/* Notes the row with the largest error e, if that is not below RBDI_CLOSED. */
RBDI_LOCAL void rbdi_note_open_row(rbd_constraint_set *c) {
    rbd_real open = rbdi_set(RBDI_CLOSED);
    for (int r = 0; r < c->rows; ++r) {
        const rbdi_mask worse = rbdi_not(rbdi_less(rbdi_abs(c->e[r]), open));
        if (!rbdi_any(worse)) continue;
        c->infeasible = r;
        open = rbdi_select(worse, rbdi_abs(c->e[r]), open);
    }
}

/* Whether weights hide rows: J alone has a higher rank. */
RBDI_COLD int rbdi_weights_hide(const rbd_model *m, rbd_constraint_set *c) {
    const int rank = rbd_constraint_rank(c);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = rbdi_set(RBD_C(1));

    c->pivoted = rbdi_any(rbdi_factor_delta(m, c));
    if (c->pivoted) rbdi_orthogonalise(m, c);
    return rbd_constraint_rank(c) > rank;
}

RBDI_API rbd_status rbd_assemble(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                 const rbd_real *v, const rbd_const *weight, rbd_real *q_near,
                                 rbd_real *v_near) {
    const rbd_status status = rbdi_check_constraints(m, c, q && q_near && q != q_near && (!v == !v_near));
    rbd_const free;
    if (status) return status;
    if (!rbdi_weights_fit(weight, m->nv)) return RBD_ERR_RANGE;

    free = rbdi_free_weight(weight, m->nv);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = rbdi_set(rbdi_inverse_weight(weight, k, free));
    rbdi_assemble_position(m, c, q, q_near);
    c->infeasible = -1;
    if (v) rbdi_assemble_velocity(m, c, v, v_near);

    rbdi_note_open_row(c);
    if (c->infeasible < 0) return RBD_OK;
    if (!rbdi_weights_hide(m, c)) return RBD_ERR_INFEASIBLE;

    c->infeasible = -1;
    return RBD_ERR_RANGE;
}

RBDI_API int rbd_constraint_rows(const rbd_constraint_set *c) { return c ? c->rows : 0; }

RBDI_API int rbd_constraint_first(const rbd_constraint_set *c, int constraint) {
    return c && constraint >= 0 && constraint < c->n ? c->constraint[constraint].row : -1;
}

RBDI_API int rbd_constraint_rank(const rbd_constraint_set *c) {
    rbd_real rank = rbdi_zero();
    int least;
    if (!c) return 0;

    for (int r = 0; r < c->rows; ++r)
        rank = rank + rbdi_select(rbdi_dropped(c, r), rbdi_zero(), rbdi_set(RBD_C(1)));

    /* of lanes the least */
    least = c->rows;
    while (least > 0 && rbdi_any(rbdi_less(rank, rbdi_set(RBD_C(least))))) --least;
    return least;
}

RBDI_API int rbd_infeasible_row(const rbd_constraint_set *c) { return c ? c->infeasible : -1; }

#endif
