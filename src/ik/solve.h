#ifndef RBDI_IK_SOLVE_H
#define RBDI_IK_SOLVE_H
#include "base/pieces.h"
#include "ik/dofs.h"
#include "ik/search.h"
#include "ik/check.h"

/* ---- inverse kinematics [inverse kinematics code] ---- */

RBDI_API size_t rbd_ik_size(const rbd_model *m, int n) {
    return m && n > 0 && n <= RBDI_IK_MOST_TARGETS ? RBDI_IK_BYTES(m->nv, m->nl, n) : 0;
}

/* The options with defaults. */
RBDI_LOCAL rbd_ik_options rbdi_ik_defaults(const rbd_ik_options *given) {
    rbd_ik_options o;
    o.starts = given && given->starts ? given->starts : RBDI_IK_STARTS;
    o.evaluations = given && given->evaluations ? given->evaluations : RBDI_IK_EVALUATIONS;
    o.metres = given && given->metres > 0 ? given->metres : rbdi_set(RBDI_IK_TOLERANCE);
    o.radians = given && given->radians > 0 ? given->radians : rbdi_set(RBDI_IK_TOLERANCE);
    o.length = given && given->length > 0 ? given->length : rbdi_set(RBDI_IK_LENGTH);
    o.held = given ? given->held : NULL;
    return o;
}

/* Lays out the arrays in the memory. */
RBDI_LOCAL rbdi_ik *rbdi_ik_lay_out(const rbd_model *m, int n, void *memory) {
    const int nv = m->nv, triangle = nv * (nv + 1) / 2;
    unsigned char *at = rbdi_aligned(memory);
    rbdi_ik *ik = RBDI_CUT(rbdi_ik, 1);
    ik->dof = RBDI_CUT(rbdi_ik_dof, nv);
    ik->mark = RBDI_CUT(int16_t, nv);
    ik->solved = ik->mark;

    ik->e = (rbd_real *)at;
    ik->J = ik->e + 6 * n;
    ik->columns = ik->J + 6 * n * nv;
    ik->H = ik->columns + 6 * nv;
    ik->factor = ik->H + triangle;
    ik->g = ik->factor + triangle;
    ik->d = ik->g + nv;
    ik->x = ik->d + nv;
    ik->v = ik->x + nv;
    ik->from = ik->v + nv;
    ik->best = ik->from + m->nq;
    ik->q = ik->best + m->nq;
    ik->trial = ik->q + m->nq;
    ik->mass = ik->trial + m->nq;
    return ik;
}

/* Makes the search ready to begin from q. */
RBDI_LOCAL rbdi_ik *rbdi_ik_begin(const rbd_model *m, rbd_work *w, const rbd_ik_target *targets, int n,
                                  const rbd_ik_options *options, void *memory, const rbd_real *q,
                                  rbd_ik_result *result) {
    rbdi_ik *ik = rbdi_ik_lay_out(m, n, memory);
    ik->m = m;
    ik->w = w;
    ik->target = targets;
    ik->n = n;
    ik->options = rbdi_ik_defaults(options);
    ik->result = result;
    ik->alone = n == 1 && targets->kind != RBD_IK_COM ? targets->body : -1;
    ik->all = rbd_mass(m);
    ik->best_cost = rbdi_set(RBDI_IK_OVERFLOW);

    ik->rows = 0;
    for (int i = 0; i < n; ++i) ik->rows += rbdi_ik_rows_of(targets[i].kind);
    rbdi_clear(ik->v, m->nv);
    rbdi_ik_find_dofs(ik);
    rbdi_ik_copy(q, m->nq, ik->from);
    rbdi_ik_put_within(ik, ik->from);
    return ik;
}

/* Searches; then looks for the nearest place. ik->q is the answer. */
RBDI_LOCAL rbd_ik_status rbdi_ik_run(rbdi_ik *ik) {
    for (int i = 0; i < ik->options.starts && rbdi_ik_may_go_on(ik); ++i) {
        ++ik->result->starts;
        rbdi_ik_start(ik, i);
        if (rbdi_ik_search(ik)) return RBD_IK_REACHED;
    }

    if (!(ik->best_cost < RBDI_IK_OVERFLOW)) {
        rbdi_ik_refuse(ik->result, RBD_ERR_NAN, -1, "q");
        return RBD_IK_ERROR;
    }

    if (rbdi_ik_find_nearest(ik)) return RBD_IK_REACHED;
    rbdi_ik_copy(ik->best, ik->m->nq, ik->q);
    return rbdi_ik_judge(ik);
}

RBDI_API rbd_ik_status rbd_ik(const rbd_model *m, rbd_work *w, const rbd_ik_target *targets, int n,
                              const rbd_ik_options *options, void *memory, size_t size, rbd_real *q,
                              rbd_ik_result *result) {
    rbd_ik_status status;
    rbdi_ik *ik;
    if (!result) return RBD_IK_ERROR;

    result->metres = rbdi_zero();
    result->radians = rbdi_zero();
    result->starts = 0;
    result->evaluations = 0;
    result->limits = 0;
    result->limit = -1;
    rbdi_ik_refuse(result, RBD_OK, -1, NULL);
    if (rbdi_ik_check(m, w, targets, n, options, memory, size, q, result)) return RBD_IK_ERROR;

    ik = rbdi_ik_begin(m, w, targets, n, options, memory, q, result);
    status = rbdi_ik_run(ik);
    if (status != RBD_IK_ERROR) rbdi_ik_copy(ik->q, m->nq, q);
    return status;
}

#endif
