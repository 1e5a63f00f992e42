#ifndef RBDI_CONTACT_BOUNDED_H
#define RBDI_CONTACT_BOUNDED_H
#include "constraints/calls.h"
#include "contact/solver.h"
#include "contact/joints.h"

/* ---- bounded rows [bounded rows] ----
   Dry friction of the description, and rows of the caller's, whose force is f = p / dt. A row

       s = J nu + bias + compliance p,   dt lower <= p <= dt upper

   takes its compliance on Delta's diagonal. A bristle of stiffness k that is bent by z has bias z / dt and
   compliance 1 / (dt^2 k): p = -dt k (z + dt J nu), implicit, within the bounds.

   Dry friction has neither. Its law p (J nu) <= 0 makes no energy in a step of first order. In the midpoint
   scheme its work is p (u + J nu) / 2 with the speed u before: if the row turns around in the step, that may
   be above 0. So the first solution tells the sign of p, and the others have bounds, and a bias, by which

       p against u     p within 0 and that bound; it may stop: J nu = 0
       p along u       p within 0 and that bound; it turns around: J nu <= -u where p is not 0

   Both take energy or keep it, whichever is chosen. In between it coasts: p = 0. */

/* The row without force, as before the first step. */
RBDI_LOCAL void rbdi_rest_bounded(rbdi_bounded_row *row) {
    row->row = -1;
    row->state = RBD_APART;
    row->force = rbdi_zero();
}

/* A row that does nothing, until it is set. */
RBDI_LOCAL void rbdi_begin_bounded(rbdi_bounded_row *row) {
    rbd_contact_row *law = &row->law;
    law->dofs = 0;
    for (int j = 0; j < 3; ++j) {
        law->dof[j] = 0;
        law->jacobian[j] = rbdi_zero();
    }
    law->bias = law->lower = law->upper = law->compliance = rbdi_zero();
    rbdi_rest_bounded(row);
}

/* Lists the dofs that have dry friction, or counts them; NULL: counts. */
RBDI_LOCAL int rbdi_list_frictions(const rbd_model *m, const rbd_contact_options *o, rbdi_bounded_row *row) {
    int n = 0;
    if (!o->joint_friction) return 0;

    for (int k = 0; k < m->nv; ++k) {
        const rbd_const friction = rbdi_joint_friction(m, k);
        if (!(friction > 0)) continue;

        if (row) {
            rbdi_begin_bounded(&row[n]);
            row[n].law.dofs = 1;
            row[n].law.dof[0] = k;
            row[n].law.jacobian[0] = rbdi_set(RBD_C(1));
            row[n].law.lower = rbdi_set(-friction);
            row[n].law.upper = rbdi_set(friction);
        }
        ++n;
    }
    return n;
}

/* Whether the row may have a force. */
RBDI_INLINE int rbdi_bounded_acts(const rbdi_bounded_row *row) {
    return row->law.dofs > 0 && (row->law.lower < 0 || row->law.upper > 0);
}

/* Writes a dof and its ancestors, ascending, to s->path. Returns how many. */
RBDI_LOCAL int rbdi_path_to(const rbd_model *m, const rbd_constraint_set *s, int dof) {
    const int n = m->dof[dof].depth + 1;
    for (int t = n - 1; t >= 0; --t, dof = m->dof[dof].lambda) s->path[t] = (int16_t)dof;
    return n;
}

/* The same for all dofs of a row. */
RBDI_LOCAL int rbdi_paths_to(const rbd_model *m, const rbd_constraint_set *s, const rbd_contact_row *law) {
    int next[3] = {-1, -1, -1}, n = 0;
    if (law->dofs == 1) return rbdi_path_to(m, s, law->dof[0]);
    for (int j = 0; j < law->dofs; ++j) next[j] = law->dof[j];

    /* the largest of those that are next, from the end of the path on */
    for (;;) {
        const int two = next[0] > next[1] ? next[0] : next[1];
        const int most = two > next[2] ? two : next[2];
        if (most < 0) break;
        s->path[m->nv - ++n] = (int16_t)most;
        for (int j = 0; j < 3; ++j)
            if (next[j] == most) next[j] = m->dof[most].lambda;
    }

    for (int t = 0; t < n; ++t) s->path[t] = s->path[m->nv - n + t];
    return n;
}

/* Writes the row of J', and J v_mid. */
RBDI_LOCAL void rbdi_write_bounded(const rbd_contact_set *c, const rbdi_bounded_row *row) {
    const rbd_contact_row *law = &row->law;
    rbd_constraint_set *s = c->rows;
    if (row->row < 0) return;

    for (int j = 0; j < law->dofs; ++j) {
        s->Y[law->dof[j] * s->stride + row->row] = law->jacobian[j];
        s->velocity[row->row] = s->velocity[row->row] + law->jacobian[j] * c->v_mid[law->dof[j]];
    }
}

/* Makes dry friction take energy, by the sign of the force in the first solution. */
RBDI_LOCAL void rbdi_find_turn(const rbd_contact_set *c, rbdi_bounded_row *row) {
    const rbd_contact_row *law = &row->law;
    const int r = row->row, i = r - 3 * c->contacts;
    rbd_real u, p;
    int brakes;
    if (r < 0 || law->compliance > 0 || rbdi_abs(law->bias) > 0) return;
    if (law->lower > 0 || law->upper < 0) return;

    u = c->rows->velocity[r];
    p = c->rows->lambda[r];
    if (!(rbdi_abs(u) > c->solver.given.tolerance)) return;
    brakes = u > 0 ? p <= 0 : p >= 0;
    if (brakes == (u > 0))
        c->upper[i] = rbdi_zero();
    else
        c->lower[i] = rbdi_zero();
    if (!brakes) row->turn = u;
}

/* Keeps force and state for the caller. At a bound the force is that bound: p / dt is, but for rounding. */
RBDI_LOCAL void rbdi_keep_bounded(const rbd_contact_set *c, rbdi_bounded_row *row) {
    const int r = row->row, i = r - 3 * c->contacts;
    const rbd_contact_row *law = &row->law;
    row->force = rbdi_zero();
    row->state = RBD_APART;
    if (r < 0) return;

    row->force = c->rows->lambda[r] / c->dt;
    if (c->rows->lambda[r] <= c->dt * law->lower) row->force = law->lower;
    if (c->rows->lambda[r] >= c->dt * law->upper) row->force = law->upper;
    row->state = c->solver.bound[i];
    if (row->state == RBD_OPENS || rbdi_abs(row->turn) > 0) row->state = RBD_SLIPS;
}

RBDI_API rbd_status rbd_contact_friction(const rbd_model *m, rbd_contact_set *c, int dof, rbd_real bound) {
    const rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, 1);
    if (status) return status;
    for (int i = 0; i < c->frictions; ++i) {
        rbd_contact_row *law = &c->bound[i].law;
        if (law->dof[0] != dof) continue;
        if (!(bound >= 0 && bound < RBDI_UNBOUNDED)) return RBD_ERR_RANGE;
        law->lower = -bound;
        law->upper = bound;
        return RBD_OK;
    }
    return RBD_ERR_INDEX;
}

RBDI_LOCAL rbd_status rbdi_check_bounded(const rbd_model *m, const rbd_contact_row *law) {
    if (law->dofs < 0 || law->dofs > 3) return RBD_ERR_COUNT;
    for (int j = 0; j < law->dofs; ++j) {
        if (law->dof[j] < 0 || law->dof[j] >= m->nv) return RBD_ERR_INDEX;
        for (int i = 0; i < j; ++i)
            if (law->dof[i] == law->dof[j]) return RBD_ERR_INDEX;
    }

    if (!rbdi_all_finite(law->jacobian, law->dofs) || !rbdi_all_finite(&law->bias, 1)) return RBD_ERR_RANGE;
    if (!(law->compliance >= 0) || !rbdi_all_finite(&law->compliance, 1)) return RBD_ERR_RANGE;
    if (!(law->lower < RBDI_UNBOUNDED) || !(law->upper > -RBDI_UNBOUNDED)) return RBD_ERR_RANGE;
    return law->lower <= law->upper ? RBD_OK : RBD_ERR_RANGE;
}

RBDI_API rbd_status rbd_contact_row_set(const rbd_model *m, rbd_contact_set *c, int i,
                                        const rbd_contact_row *row) {
    const rbd_real most = rbdi_set(RBDI_UNBOUNDED);
    rbd_contact_row *law;
    rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, row != NULL);
    if (status) return status;
    if (i < 0 || i >= c->options.rows) return RBD_ERR_INDEX;
    status = rbdi_check_bounded(m, row);
    if (status) return status;

    law = &c->bound[c->frictions + i].law;
    *law = *row;
    if (law->lower < -most) law->lower = -most;
    if (law->upper > most) law->upper = most;
    return RBD_OK;
}

RBDI_API rbd_contact_state rbd_contact_row_get(const rbd_contact_set *c, int i, rbd_real *force) {
    const int there = c && i >= 0 && i < c->options.rows;
    const rbdi_bounded_row *row = there ? &c->bound[c->frictions + i] : NULL;
    if (force) *force = there ? row->force : rbdi_zero();
    return there ? row->state : RBD_APART;
}

RBDI_API rbd_status rbd_contact_inertia(const rbd_model *m, rbd_contact_set *c, const rbd_real *added) {
    const rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, 1);
    if (!status) c->added = added;
    return status;
}

#endif
