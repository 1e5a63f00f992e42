#ifndef RBDI_CONSTRAINTS_SET_H
#define RBDI_CONSTRAINTS_SET_H
#include "model/text.h"
#include "model/wide.h"
#include "constraints/rows.h"

/* Interface: rbdi_begin_set, rbdi_check_constraint, rbdi_constraint_of, rbdi_frame_along,
   rbdi_lay_constraints, rbdi_place_constraint, rbdi_place_frame, rbdi_row_stride, rbdi_rows_of */

/* ---- set code [set code] ---- */

/* Holds a point of body 1 at a point of body 2, and the first `angular` angular axes. */
RBDI_LOCAL rbd_constraint rbdi_constraint_of(int body1, const double *p1, int body2, const double *p2,
                                             int angular) {
    rbd_constraint con;
    con.name = NULL;
    con.body1 = body1;
    con.body2 = body2;
    for (int i = 0; i < 9; ++i) con.rotation1[i] = con.rotation2[i] = i % 4 == 0;
    for (int i = 0; i < 3; ++i) {
        con.position1[i] = p1 ? p1[i] : 0;
        con.position2[i] = p2 ? p2[i] : 0;
        con.axes[i] = i < angular;
        con.axes[i + 3] = 1;
    }
    con.kp = con.kd = 0;
    return con;
}

/* A rotation whose z axis is this axis. */
RBDI_LOCAL void rbdi_frame_along(const double axis[3], double R[9]) {
    rbdi_wide z[3], E[9], T[9];
    rbdi_widen(axis, 3, z);
    rbdi_unit(z, z);
    rbdi_w_basis(z, E);
    rbdi_w_transpose(E, T);
    for (int k = 0; k < 9; ++k) R[k] = (double)T[k];
}

RBDI_API rbd_constraint rbd_point_contact(int body, const double point[3], const double place[3]) {
    return rbdi_constraint_of(body, point, -1, place, 0);
}

RBDI_API rbd_constraint rbd_flat_contact(int body, const double point[3], const double place[3]) {
    return rbdi_constraint_of(body, point, -1, place, 3);
}

RBDI_API rbd_constraint rbd_ball_loop(int body1, const double point1[3], int body2, const double point2[3]) {
    return rbdi_constraint_of(body1, point1, body2, point2, 0);
}

RBDI_API rbd_constraint rbd_hinge_loop(int body1, const double point1[3], const double axis1[3], int body2,
                                       const double point2[3], const double axis2[3]) {
    rbd_constraint con = rbdi_constraint_of(body1, point1, body2, point2, 2);
    if (axis1) rbdi_frame_along(axis1, con.rotation1);
    if (axis2) rbdi_frame_along(axis2, con.rotation2);
    return con;
}

RBDI_API char *rbd_constraint_finding_text(const rbd_finding *finding, char *text, size_t size) {
    return rbdi_write_finding(finding, "constraint", text, size);
}

RBDI_LOCAL int rbdi_held_axes(const rbd_constraint *con) {
    int n = 0;
    for (int i = 0; i < 6; ++i) n += con->axes[i] == 1;
    return n;
}

/* The stride for so many rows: loops may access two batches from any row on. */
RBDI_LOCAL int rbdi_row_stride(int rows) { return (rows + 4 * RBDI_BATCH) / RBDI_BATCH * RBDI_BATCH; }

RBDI_LOCAL int rbdi_rows_of(const rbd_constraint *list, int n) {
    int rows = 0;
    for (int i = 0; i < n; ++i) rows += rbdi_held_axes(&list[i]);
    return rows;
}

RBDI_API size_t rbd_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n) {
    int rows;
    if (!m || (!list && n) || n < 0 || n > RBD_MAX_CONSTRAINTS) return 0;

    rows = rbdi_rows_of(list, n);
    return RBDI_CONSTRAINTS_BYTES(m->nv, n, rows, rbdi_row_stride(rows));
}

/* The link of a body, -1 = world. */
RBDI_LOCAL int rbdi_link_of_body(const rbd_model *m, int body) { return body < 0 ? -1 : m->frame[body].link; }

RBDI_LOCAL rbd_status rbdi_check_constraint(const rbd_model *m, const rbd_constraint *con, int i,
                                            rbd_report *report) {
    int strange = rbdi_held_axes(con) == 0;
    for (int j = 0; j < 6; ++j) strange |= con->axes[j] != 0 && con->axes[j] != 1;
    if (con->body1 < -1 || con->body1 >= m->nb)
        return rbdi_refuse(report, RBD_ERR_INDEX, i, con->name, "body1");
    if (con->body1 < 0 && con->body2 < 0)
        return rbdi_refuse_saying(report, RBD_ERR_INDEX, i, con->name, "body1",
                                  "both bodies are -1: the world, or a name that no body has");
    if (con->body2 < -1 || con->body2 >= m->nb)
        return rbdi_refuse(report, RBD_ERR_INDEX, i, con->name, "body2");
    if (rbdi_link_of_body(m, con->body1) == rbdi_link_of_body(m, con->body2))
        return rbdi_refuse_saying(report, RBD_ERR_INDEX, i, con->name, "body2",
                                  "no joint moves it relative to body1");

    if (!rbdi_is_rotation(con->rotation1))
        return rbdi_refuse(report, RBD_ERR_ROTATION, i, con->name, "rotation1");
    if (!rbdi_finite(con->position1, 3))
        return rbdi_refuse(report, RBD_ERR_POSITION, i, con->name, "position1");
    if (!rbdi_is_rotation(con->rotation2))
        return rbdi_refuse(report, RBD_ERR_ROTATION, i, con->name, "rotation2");
    if (!rbdi_finite(con->position2, 3))
        return rbdi_refuse(report, RBD_ERR_POSITION, i, con->name, "position2");

    if (strange)
        return rbdi_refuse_saying(report, RBD_ERR_AXIS, i, con->name, "axes",
                                  "none is held, or one is neither 0 nor 1");
    if (!rbdi_finite_positive(&con->kp, 1)) return rbdi_refuse(report, RBD_ERR_RANGE, i, con->name, "kp");
    if (!rbdi_finite_positive(&con->kd, 1)) return rbdi_refuse(report, RBD_ERR_RANGE, i, con->name, "kd");
    return RBD_OK;
}

/* Converts a frame on a body to a frame on its link; returns the link. */
RBDI_LOCAL int rbdi_place_frame(const rbd_model *m, int body, const double rotation[9],
                                const double position[3], rbd_const R_link[9], rbdi_c3 *p_link) {
    rbdi_wide A[9], x[3], E[9], r[3] = {0, 0, 0};
    rbdi_w_identity(E);
    rbdi_widen(rotation, 9, A);
    rbdi_widen(position, 3, x);
    if (rbdi_all_zero(rotation, 9)) rbdi_w_identity(A);
    rbdi_orthonormalise(A);

    /* the body's frame on its link */
    if (body >= 0) {
        const rbdi_frame *u = &m->frame[body];
        for (int k = 0; k < 9; ++k) E[k] = (rbdi_wide)u->E[k / 3 + k % 3 * 3]; /* transposed */
        r[0] = (rbdi_wide)u->r.x;
        r[1] = (rbdi_wide)u->r.y;
        r[2] = (rbdi_wide)u->r.z;
    }

    /* E A, r + E x */
    rbdi_w_product(E, A, A);
    rbdi_w_apply(E, x, x);
    for (int k = 0; k < 9; ++k) R_link[k] = (rbd_const)A[k];
    p_link->x = (rbd_const)(r[0] + x[0]);
    p_link->y = (rbd_const)(r[1] + x[1]);
    p_link->z = (rbd_const)(r[2] + x[2]);

    return rbdi_link_of_body(m, body);
}

/* The nearest common ancestor of two links, or one of them; -1 = world. Ancestors have smaller indices. */
RBDI_LOCAL int rbdi_common_ancestor(const rbd_model *m, int one, int two) {
    while (one != two) {
        int *later = one > two ? &one : &two;
        *later = m->link[*later].parent;
    }
    return one;
}

RBDI_LOCAL void rbdi_place_constraint(const rbd_model *m, const rbd_constraint *from, int row,
                                      rbdi_constraint *to) {
    to->link[0] = (int16_t)rbdi_place_frame(m, from->body1, from->rotation1, from->position1, to->rotation[0],
                                            &to->position[0]);
    to->link[1] = (int16_t)rbdi_place_frame(m, from->body2, from->rotation2, from->position2, to->rotation[1],
                                            &to->position[1]);
    to->ancestor = (int16_t)rbdi_common_ancestor(m, to->link[0], to->link[1]);
    to->kp = RBD_C(from->kp);
    to->kd = RBD_C(from->kd);

    /* each held axis is a row: column j of rotation 2 */
    to->row = (int16_t)row;
    to->rows = to->angular = 0;
    for (int r = 0; r < RBDI_SIX_ROWS; ++r) to->held[0][r] = to->held[1][r] = to->held[2][r] = 0;
    for (int j = 0; j < 6; ++j) {
        if (!from->axes[j]) continue;

        for (int i = 0; i < 3; ++i) to->held[i][to->rows] = to->rotation[1][3 * i + j % 3];
        to->axis[to->rows++] = (int16_t)j;
        to->angular = (int16_t)(to->angular + (j < 3));
    }
}

/* Marks a dof and all before it on the way to the world. */
RBDI_LOCAL void rbdi_mark_path(const rbd_model *m, int dof, int16_t *reached) {
    for (int i = dof; i >= 0 && !reached[i]; i = m->dof[i].lambda) reached[i] = 1;
}

/* Finds the dofs of the paths to a constraint's bodies, and extends their spans by its rows. */
RBDI_LOCAL void rbdi_reach_dofs(const rbd_model *m, rbd_constraint_set *c, rbdi_constraint *con) {
    int16_t *reached = c->path;
    for (int i = 0; i < m->nv; ++i) reached[i] = 0;

    for (int side = 0; side < 2; ++side)
        for (int link = con->link[side]; link >= 0; link = m->link[link].parent)
            for (int j = 0; j < rbdi_link_dofs(m, &m->link[link]); ++j)
                rbdi_mark_path(m, rbdi_source(m, m->link[link].iv + j), reached);

    con->dofs = 0;
    for (int i = 0; i < m->nv; ++i) {
        rbdi_span *s = &c->span[i];
        if (!reached[i]) continue;

        if (s->end == 0) s->first = con->row;
        s->end = (int16_t)(con->row + con->rows);
        con->dof[con->dofs++] = (int16_t)i;
    }
}

/* Prepares a set whose constraints are placed for this model and work: the dofs of each, spans, and the links
   on all paths. */
RBDI_LOCAL void rbdi_begin_set(const rbd_model *m, rbd_work *w, rbd_constraint_set *c) {
    for (int k = 0; k < RBDI_SHAPE; ++k) c->shape[k] = m->shape[k];
    c->w = w;
    c->infeasible = -1;

    for (int k = 0; k < m->nv; ++k) c->span[k].first = c->span[k].end = 0;
    for (int i = 0; i < c->n; ++i) rbdi_reach_dofs(m, c, &c->constraint[i]);

    c->links = 0;
    for (int i = 0; i < m->nl && !rbdi_mimics(m); ++i)
        if (c->span[m->link[i].iv].end > 0) c->link[c->links++] = (int16_t)i;
}

/* Whether rows depend on each other in every state. Articulated bodies would fail in all of them. There are
   more rows than dofs, or between two links more than six, or more than the dofs that move one of them. */
RBDI_LOCAL int rbdi_too_many_rows(const rbd_model *m, const rbd_constraint_set *c) {
    const rbdi_constraint *stop = c->constraint + c->n;
    int too_many = c->rows > m->nv;
    for (const rbdi_constraint *con = c->constraint; con < stop; ++con) {
        int rows = 0, dofs = 0;

        /* rows of all constraints between these two links */
        for (const rbdi_constraint *o = c->constraint; o < stop; ++o)
            if ((o->link[0] == con->link[0] && o->link[1] == con->link[1]) ||
                (o->link[0] == con->link[1] && o->link[1] == con->link[0]))
                rows += o->rows;

        for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);)
            dofs += rbdi_link_dofs(m, &m->link[walk.link]);
        too_many |= rows > 6 || rows > dofs;
    }
    return too_many;
}

/* Checks the arguments of rbd_constraint_set_init. */
RBDI_LOCAL rbd_status rbdi_check_list(const rbd_model *m, const rbd_work *w, const rbd_constraint *list,
                                      int n, const void *memory, size_t size, rbd_report *report) {
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);

    if (!m || !w || (!list && n) || !memory) return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (rbdi_check(m, w, 1)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (n < 0 || n > RBD_MAX_CONSTRAINTS) {
        rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);
        report->error.text = "the number of constraints is below 0 or above RBD_MAX_CONSTRAINTS";
        return RBD_ERR_COUNT;
    }

    for (int i = 0; i < n; ++i) {
        const rbd_status status = rbdi_check_constraint(m, &list[i], i, report);
        if (status) return status;
    }

    if (size < rbd_constraint_set_size(m, list, n))
        return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);
    return RBD_OK;
}

/* Lays out the memory as RBDI_CONSTRAINTS_BYTES says. */
RBDI_LOCAL rbd_constraint_set *rbdi_lay_constraints(int nv, int n, int rows, void *memory) {
    const int stride = rbdi_row_stride(rows);
    unsigned char *p = rbdi_aligned(memory);
    rbd_constraint_set *c = (rbd_constraint_set *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_constraint_set)));
    rbd_real *x;
    c->n = n;
    c->rows = rows;
    c->stride = stride;

    c->constraint = (rbdi_constraint *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n * sizeof(rbdi_constraint)));
    c->link = (int16_t *)rbdi_take(&p, 1, RBDI_ROUND((size_t)nv * ((size_t)n + 1) * sizeof(int16_t)));
    for (int i = 0; i < n; ++i) c->constraint[i].dof = c->link + (i + 1) * nv;
    c->span = (rbdi_span *)rbdi_take(&p, 1, RBDI_ROUND((size_t)nv * sizeof(rbdi_span)));
    c->path = (int16_t *)rbdi_take(&p, 1, RBDI_ROUND((size_t)nv * sizeof(int16_t)));
    c->Y = (rbd_real *)rbdi_take(&p, nv * stride, sizeof(rbd_real));
    c->R = (rbd_real *)rbdi_take(&p, (rows > nv ? rows : nv) * stride, sizeof(rbd_real));

    /* an entry for each dof */
    x = (rbd_real *)rbdi_take(&p, 4 * nv, sizeof(rbd_real));
    c->x = x;
    c->of_dofs.reflection = x + nv;
    c->last_step = x + 2 * nv;
    c->D_inverse = x + 3 * nv;

    /* an entry for each row; velocity, gamma and e are cleared together */
    x = (rbd_real *)rbdi_take(&p, 11 * stride, sizeof(rbd_real));
    rbdi_clear(x, 11 * stride);
    c->b = x;
    c->lambda = x + stride;
    c->target = x + 2 * stride;
    c->velocity = x + 3 * stride;
    c->gamma = x + 4 * stride;
    c->e = x + 5 * stride;
    c->slack = x + 6 * stride;
    c->square = x + 7 * stride;
    c->of_rows.inverse_square = x + 8 * stride;
    c->pivot_row = x + 9 * stride;
    c->R_inverse = x + 10 * stride;

    return c;
}

RBDI_API rbd_status rbd_constraint_set_init(const rbd_model *m, rbd_work *w, const rbd_constraint *list,
                                            int n, void *memory, size_t size,
                                            rbd_constraint_set **constraints, rbd_report *report) {
    rbd_report own;
    rbd_constraint_set *c;
    rbd_status status;
    int row = 0;
    if (!report) report = &own;
    status = rbdi_check_list(m, w, list, n, constraints ? memory : NULL, size, report);
    if (constraints) *constraints = NULL;
    if (status) return status;

    c = rbdi_lay_constraints(m->nv, n, rbdi_rows_of(list, n), memory);
    c->dirty = 1;
    c->pivoted = 0;
    c->moving = 0;
    for (int i = 0; i < n; ++i) {
        rbdi_place_constraint(m, &list[i], row, &c->constraint[i]);
        c->moving |= list[i].kp > 0 || list[i].kd > 0 || c->constraint[i].link[1] >= 0;
        row += c->constraint[i].rows;
    }

    rbdi_begin_set(m, w, c);
    c->factored = rbdi_mimics(m) > 0 || rbdi_too_many_rows(m, c);
    *constraints = c;
    return RBD_OK;
}

#endif
