#ifndef RBDI_TASKS_BLAME_H
#define RBDI_TASKS_BLAME_H
#include "tasks/levels.h"

/* ---- contradictions [contradictions] ----
   The multipliers of a QP without solution are a proof: lambda' rows = 0, and yet the sides that they name
   would have the sum below 0. Each row counts by |lambda| (its length + |its side|): friction, whose side is
   0, counts by the first, a force or torque by the second. */

RBDI_LOCAL rbd_real rbdi_tasks_share(const rbdi_tasks *k, int row) {
    const rbd_real side = k->lambda[row] > 0 ? k->upper[row] : k->lower[row];
    rbd_real length = rbdi_set(RBD_C(1));
    if (!(k->lambda[row] < 0 || k->lambda[row] > 0)) return rbdi_zero();

    if (row >= k->n) {
        const rbd_real *c = &k->C[(ptrdiff_t)(row - k->n) * k->n];
        length = rbdi_sqrt(rbdi_qp_dot(c, c, k->n));
    }
    return rbdi_abs(k->lambda[row]) * (length + rbdi_abs(side));
}

/* Names the part that counts most, limits before contacts that are held and dofs without a motor; then the
   one that counts most of those of another kind. */
RBDI_LOCAL void rbdi_tasks_blame(rbdi_tasks *k, int rows) {
    rbd_tasks_result *result = k->result;

    for (int i = 0; i < 2; ++i) {
        rbd_real most = rbdi_zero();
        int firm = 1; /* whether the part so far is an equality */
        for (int row = 0; row < k->n + rows; ++row) {
            const rbdi_tasks_limit limit = rbdi_tasks_limit_of(k, row);
            const int equal = k->lower[row] >= k->upper[row];
            const rbd_real share = rbdi_tasks_share(k, row);
            if (!(share > 0) || (i && limit.part == result->part[0])) continue;
            if (equal > firm || (equal == firm && !(share > most))) continue;
            firm = equal;
            most = share;
            result->part[i] = limit.part;
            result->at[i] = limit.at;
        }
    }
}

#endif
