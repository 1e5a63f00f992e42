#ifndef RBDI_CONSTRAINTS_ASSEMBLY_H
#define RBDI_CONSTRAINTS_ASSEMBLY_H
#include "api/manifold.h"
#include "constraints/weights.h"

/* ---- assembly [assembly] ----
   Newton's method. Of all steps d with de/dq d = -e it takes the one that makes d + rbd_difference(q,
   q_near), the remaining distance from q, shortest. J takes the place of de/dq, except where a single angular
   axis is held: J d = -e would not come nearer there at large turns. Two axes are better off with J: de/dq
   vanishes where they are 90 degrees off. Steps are cut to RBDI_LONGEST_STEP, because the rows change. The
   last steps reduce e alone. */

/* The next step size: the share of the distance that a step removes, by Barzilai and Borwein (1988), from
   this step c->x, the step before it, and the sizes of both. 1 is right if J is constant; if J changes, steps
   of size 1 converge slowly or never. */
static rbd_real rbdi_next_size(const rbd_constraint_set *c, int nv, rbd_real size, rbd_real last_size) {
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

/* Takes a step of this size. Returns its length before it is cut. */
static rbd_real rbdi_assembly_step(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                   rbd_real *q_near, rbd_real size) {
    const rbd_real limit = rbdi_set(RBDI_LONGEST_STEP);
    rbd_real length, cut;
    rbd_difference(m, q, q_near, c->x);
    for (int i = 0; i < m->nv; ++i) c->x[i] = -size * c->x[i];
    for (int r = 0; r < c->rows; ++r) c->target[r] = -c->e[r];
    rbdi_multipliers(m, c, 0);
    length = rbdi_largest(c->x, m->nv);
    cut = rbdi_select(rbdi_less(limit, length), limit / (length + RBDI_TINY), rbdi_set(RBD_C(1)));
    rbd_integrate(m, q_near, c->x, cut, q_near);
    return length;
}

/* Computes q_near from q. */
static void rbdi_assemble_position(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                   rbd_real *q_near) {
    rbd_real size = rbdi_set(RBD_C(1)), last_size = size;
    for (int k = 0; k < m->nq; ++k) q_near[k] = q[k];
    rbdi_clear(c->last_step, m->nv);
    for (int step = 0, close = 0; close < RBDI_CLOSING_STEPS; ++step) {
        rbd_real length, next;
        rbdi_constraint_rows_at(m, c, q_near, NULL, RBDI_SLOPES);
        length = rbdi_assembly_step(m, c, q, q_near, close ? rbdi_zero() : size);
        if (close || step > RBDI_NEARING_STEPS || !rbdi_any(rbdi_less(size * RBDI_SHORT_STEP, length)))
            ++close;
        if (close) continue;
        next = rbdi_next_size(c, m->nv, size, last_size);
        last_size = size, size = next;
        for (int k = 0; k < m->nv; ++k) c->last_step[k] = c->x[k];
    }
    rbdi_constraint_rows_at(m, c, q_near, NULL, 1);
}

RBDI_API rbd_status rbd_assemble(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                 const rbd_real *v, const rbd_const *weight, rbd_real *q_near,
                                 rbd_real *v_near) {
    const rbd_status status = rbdi_check_constraints(m, c, q && q_near && q != q_near && (!v == !v_near));
    rbd_real open;
    rbd_const free;
    if (status) return status;
    if (!rbdi_weights_fit(weight, m->nv)) return RBD_ERR_RANGE;
    free = rbdi_free_weight(weight, m->nv);
    for (int k = 0; k < m->nv; ++k) c->D_inverse[k] = rbdi_set(rbdi_inverse_weight(weight, k, free));
    rbdi_assemble_position(m, c, q, q_near);
    if (v) {
        for (int k = 0; k < m->nv; ++k) c->x[k] = v[k];
        rbdi_clear(c->target, c->rows);
        for (int pass = 0; pass < 2; ++pass) rbdi_multipliers(m, c, 0); /* the second removes rounding */
        for (int k = 0; k < m->nv; ++k) v_near[k] = c->x[k];
    }
    c->infeasible = -1;
    open = rbdi_set(RBDI_CLOSED);
    for (int r = 0; r < c->rows; ++r) {
        const rbdi_mask worse = rbdi_not(rbdi_less(rbdi_abs(c->e[r]), open));
        if (rbdi_any(worse)) c->infeasible = r, open = rbdi_select(worse, rbdi_abs(c->e[r]), open);
    }
    return c->infeasible < 0 ? RBD_OK : RBD_ERR_INFEASIBLE;
}

RBDI_API int rbd_constraint_rows(const rbd_constraint_set *c) { return c ? c->rows : 0; }

RBDI_API int rbd_constraint_first(const rbd_constraint_set *c, int constraint) {
    return c && constraint >= 0 && constraint < c->n ? c->constraint[constraint].row : -1;
}

RBDI_API int rbd_constraint_rank(const rbd_constraint_set *c) {
    rbd_real rank = rbdi_zero();
    int least = c ? c->rows : 0;
    for (int r = 0; c && r < c->rows; ++r)
        rank = rank + rbdi_select(rbdi_dropped(c, r), rbdi_zero(), rbdi_set(RBD_C(1)));
    while (least > 0 && rbdi_any(rbdi_less(rank, rbdi_set(RBD_C(least))))) --least;
    return least;
}

RBDI_API int rbd_infeasible_row(const rbd_constraint_set *c) { return c ? c->infeasible : -1; }

#endif
