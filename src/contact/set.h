#ifndef RBDI_CONTACT_SET_H
#define RBDI_CONTACT_SET_H
#include "constraints/set.h"
#include "contact/bounded.h"

/* ---- set code [set code] ---- */

RBDI_API char *rbd_contact_finding_text(const rbd_finding *finding, int n, char *text, size_t size) {
    rbd_finding held;
    if (!finding || finding->body < 0 || finding->body < n)
        return rbdi_write_finding(finding, "contact", text, size);
    held = *finding;
    held.body = finding->body - n;
    return rbdi_write_finding(&held, "held constraint", text, size);
}

/* Makes the plane of a contact frame 2 of its constraint: x and y are tangents, z is the normal. */
RBDI_LOCAL void rbdi_place_plane(const rbd_model *m, rbdi_constraint *con, int body2, const double normal[3],
                                 double height) {
    double R[9], origin[3], up[3] = {0, 0, 1};
    for (int j = 0; j < 3 && !rbdi_all_zero(normal, 3); ++j) up[j] = normal[j];
    rbdi_frame_along(up, R);
    for (int j = 0; j < 3; ++j) origin[j] = height * R[3 * j + 2];
    con->link[1] = (int16_t)rbdi_place_frame(m, body2, R, origin, con->rotation[1], &con->position[1]);
    for (int i = 0; i < 3; ++i)
        for (int r = 0; r < 3; ++r) con->held[i][r] = con->rotation[1][3 * i + r];
}

/* The constraint of a contact: it holds three linear axes. */
RBDI_LOCAL rbd_constraint rbdi_constraint_of_contact(const rbd_contact *from) {
    rbd_constraint con = rbdi_constraint_of(from->body1, from->point, from->body2, NULL, 0);
    con.name = from->name;
    return con;
}

/* Refuses a body2 that was left out, and one that is the world's where a body's plane is meant. */
RBDI_LOCAL rbd_status rbdi_check_plane_body(const rbd_contact *from, int i, rbd_report *report) {
    const char *sentence = NULL;
    if (from->body2 == 0 && !from->on_body)
        sentence = "it is 0, or was left out: the world is -1; for body 0 set on_body";
    if (from->body2 == -1 && from->on_body)
        sentence = "on_body is set, and it is -1: the world, or a name that no body has";
    if (!sentence) return RBD_OK;

    rbdi_refuse(report, RBD_ERR_INDEX, i, from->name, "body2");
    report->error.text = sentence;
    return RBD_ERR_INDEX;
}

/* Refuses damping without stiffness: a rigid contact has no damper. */
RBDI_LOCAL rbd_status rbdi_check_damper(const rbd_contact *from, int i, rbd_report *report) {
    if ((rbd_const)from->stiffness > 0 || !((rbd_const)from->damping > 0)) return RBD_OK;

    rbdi_refuse(report, RBD_ERR_RANGE, i, from->name, "damping");
    report->error.text = "a contact without stiffness is rigid, and has no damping: set both, or neither";
    return RBD_ERR_RANGE;
}

RBDI_LOCAL rbd_status rbdi_check_contact(const rbd_model *m, const rbd_contact *from, int i,
                                         rbd_report *report) {
    const double values[5] = {from->radius, from->friction, from->restitution, from->stiffness,
                              from->damping};
    const char *const names[5] = {"radius", "friction", "restitution", "stiffness", "damping"};
    const rbd_constraint con = rbdi_constraint_of_contact(from);
    rbd_status status;

    status = rbdi_check_plane_body(from, i, report);
    if (!status) status = rbdi_check_constraint(m, &con, i, report);
    if (status == RBD_ERR_POSITION) report->error.field = "point";
    if (status) return status;

    if (!rbdi_finite(from->normal, 3)) return rbdi_refuse(report, RBD_ERR_AXIS, i, from->name, "normal");
    if (!rbdi_finite(&from->height, 1)) return rbdi_refuse(report, RBD_ERR_POSITION, i, from->name, "height");
    for (int j = 0; j < 5; ++j)
        if (!rbdi_finite_positive(&values[j], 1) || (j == 2 && values[j] > 1))
            return rbdi_refuse(report, RBD_ERR_RANGE, i, from->name, names[j]);
    return rbdi_check_damper(from, i, report);
}

RBDI_LOCAL rbd_status rbdi_check_options(const rbd_contact_options *o, rbd_report *report) {
    const double values[7] = {o->margin,    o->slop, o->correction,        o->bounce,
                              o->tolerance, o->slip, (double)o->iterations};
    const char *const names[7] = {"margin",    "slop", "correction", "bounce",
                                  "tolerance", "slip", "iterations"};
    for (int j = 0; j < 7; ++j)
        if (!rbdi_finite_positive(&values[j], 1))
            return rbdi_refuse(report, RBD_ERR_RANGE, -1, NULL, names[j]);
    if (o->correction > 1)
        return rbdi_refuse_saying(report, RBD_ERR_RANGE, -1, NULL, "correction",
                                  "above 1: a step would correct more than all, and shake");
    if (!o->momentum || !o->first_order) return RBD_OK;

    rbdi_refuse(report, RBD_ERR_RANGE, -1, NULL, "momentum");
    report->error.text = "steps of first order do not keep it: choose one, momentum or first_order";
    return RBD_ERR_RANGE;
}

RBDI_LOCAL rbd_contact_options rbdi_contact_defaults(const rbd_contact_options *given) {
    const rbd_contact_options none = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    rbd_contact_options o = given ? *given : none;
    if (!(o.margin > 0)) o.margin = 0.005;
    if (!(o.slop > 0)) o.slop = 1e-5;
    if (!(o.correction > 0)) o.correction = 0.2;
    if (!(o.bounce > 0)) o.bounce = 0.05;
    return o;
}

/* Appends the two limits of a joint to the rows, or counts them; a limit of infinity is none. */
RBDI_LOCAL int rbdi_limits_of_joint(const rbd_model *m, const rbdi_frame *u, rbdi_limit_row *row) {
    const rbdi_limits limits = rbdi_joint_limits(m, u);
    int n = 0;
    for (int upper = 0; upper < 2; ++upper) {
        if (upper ? limits.upper >= RBDI_UNBOUNDED : limits.lower <= -RBDI_UNBOUNDED) continue;
        if (row) {
            row[n].dof = u->iv;
            row[n].iq = u->iq;
            row[n].lower = limits.lower;
            row[n].upper = limits.upper;
            row[n].side = rbdi_set(RBD_C(upper ? -1 : 1));
        }
        ++n;
    }
    return n;
}

/* Lists the limits of all joints of one dof; NULL: counts them. */
RBDI_LOCAL int rbdi_list_limits(const rbd_model *m, const rbd_contact_options *o, rbdi_limit_row *row) {
    int n = 0;
    for (int b = 0; o->joint_limits && b < m->nb; ++b)
        if (m->frame[b].nv == 1) n += rbdi_limits_of_joint(m, &m->frame[b], row ? &row[n] : NULL);
    return n;
}

RBDI_API size_t rbd_contact_set_size(const rbd_model *m, int n, const rbd_constraint *held, int n_held,
                                     const rbd_contact_options *options) {
    const rbd_contact_options o = rbdi_contact_defaults(options);
    int limits, rows, bounded, most;
    if (!m || n < 0 || n_held < 0 || n > RBD_MAX_CONSTRAINTS || n_held > RBD_MAX_CONSTRAINTS - n) return 0;
    if (!held && n_held > 0) return 0;
    if (o.rows < 0 || o.rows > RBD_MAX_CONSTRAINTS) return 0;
    limits = rbdi_list_limits(m, &o, NULL);
    rows = rbdi_list_frictions(m, &o, NULL) + o.rows;
    bounded = rbdi_rows_of(held, n_held) + limits + rows;
    most = 3 * n + bounded;
    return RBDI_CONTACT_SET_BYTES(m->nq, m->nv, n, n_held, bounded, rbdi_row_stride(most),
                                  RBDI_DOF_BYTES(limits, rows)) +
           (o.derivatives ? RBDI_ROUND(sizeof(rbd_real) * (size_t)RBDI_CONTACT_SIDES(m->nv, n, most)) : 0);
}

RBDI_LOCAL rbd_status rbdi_check_contact_list(const rbd_model *m, const rbd_work *w, const rbd_contact *list,
                                              int n, const rbd_constraint *held, int n_held,
                                              const rbd_contact_options *options, const void *memory,
                                              size_t size, rbd_report *report) {
    const size_t least = rbd_contact_set_size(m, n, held, n_held, options);
    rbd_status status = RBD_OK;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (!m || !w || !memory || (!list && n) || (!held && n_held))
        return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (least == 0) {
        rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);
        report->error.text = "a number of contacts, constraints or rows is below 0, or above 1000";
        return RBD_ERR_COUNT;
    }
    if (rbdi_check(m, w, 1)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (options) status = rbdi_check_options(options, report);
    for (int i = 0; !status && i < n; ++i) status = rbdi_check_contact(m, &list[i], i, report);
    for (int i = 0; !status && i < n_held; ++i) status = rbdi_check_constraint(m, &held[i], n + i, report);
    return !status && size < least ? rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL) : status;
}

/* Lays out the arrays of a set in the memory. */
RBDI_LOCAL rbd_contact_set *rbdi_lay_contacts(const rbd_model *m, int n, int n_held, int held_rows,
                                              const rbd_contact_options *o, void *memory) {
    const int limits = rbdi_list_limits(m, o, NULL);
    const int frictions = rbdi_list_frictions(m, o, NULL);
    const int bounded = held_rows + limits + frictions + o->rows;
    const int nv = m->nv;
    unsigned char *at = rbdi_aligned(memory);
    rbd_contact_set *c = RBDI_CUT(rbd_contact_set, 1);
    c->options = *o;
    c->n = n;
    c->limits = limits;
    c->frictions = frictions;
    c->bounds = frictions + o->rows;
    c->max_rows = 3 * n + bounded;
    c->contact = RBDI_CUT(rbdi_contact, n);
    c->limit = RBDI_CUT(rbdi_limit_row, limits);
    c->bound = RBDI_CUT(rbdi_bounded_row, c->bounds);
    c->place = RBDI_CUT(int16_t, c->max_rows);
    c->friction = RBDI_CUT(rbd_real, n + 2 * bounded + 3 * c->max_rows + m->nq + 11 * nv);
    c->lower = c->friction + n;
    c->upper = c->lower + bounded;
    c->b = c->upper + bounded;
    c->impulse = c->b + c->max_rows;
    c->early = c->impulse + c->max_rows;
    c->q_mid = c->early + c->max_rows;
    c->v_mid = c->q_mid + m->nq;
    c->at = c->v_mid + nv;
    c->straight = c->at + nv;
    c->damping = c->straight + nv;
    c->nu = c->damping + nv;
    c->moved = c->nu + nv;
    c->centre = c->moved + nv;
    c->momentum = c->centre + nv;
    for (int i = 0; i < 3; ++i) c->x[i] = c->momentum + (1 + i) * nv;
    rbdi_lay_solver(&c->solver, n, bounded, at);
    at += RBDI_ROUND(RBDI_CONTACT_SOLVER_BYTES(n, bounded));
    c->sigma = o->derivatives ? RBDI_CUT(rbd_real, RBDI_CONTACT_SIDES(nv, n, c->max_rows)) : NULL;
    c->rows = rbdi_lay_constraints(nv, n + n_held, c->max_rows, at);
    return c;
}

RBDI_LOCAL void rbdi_place_contact(const rbd_model *m, rbd_contact_set *c, const rbd_contact *from, int i) {
    const rbd_constraint as = rbdi_constraint_of_contact(from);
    rbdi_constraint *con = &c->rows->constraint[i];
    rbdi_contact *to = &c->contact[i];
    rbdi_place_constraint(m, &as, 0, con);
    rbdi_place_plane(m, con, from->body2, from->normal, from->height);
    to->body2 = from->body2;
    to->point = con->position[0];
    to->radius = RBD_C(from->radius);
    to->friction = RBD_C(from->friction);
    to->restitution = RBD_C(from->restitution);
    to->stiffness = RBD_C(from->stiffness);
    to->damping = RBD_C(from->damping);
}

RBDI_API void rbd_contact_reset(rbd_contact_set *c) {
    const rbd_contact_solution none = {0, 0, 0};
    if (!c) return;
    c->last_dt = rbdi_set(RBD_C(1));
    c->solver.solution = none;
    rbdi_clear(c->impulse, c->max_rows);
    for (rbdi_contact *contact = c->contact; contact < c->contact + c->n; ++contact) {
        rbdi_clear(contact->force, 3);
        contact->state = RBD_APART;
        contact->gap.start = rbdi_zero();
        contact->row = -1;
    }
    for (int i = 0; i < c->bounds; ++i) rbdi_rest_bounded(&c->bound[i]);
}

RBDI_API rbd_status rbd_contact_set_init(const rbd_model *m, rbd_work *w, const rbd_contact *list, int n,
                                         const rbd_constraint *held, int n_held,
                                         const rbd_contact_options *options, void *memory, size_t size,
                                         rbd_contact_set **contacts, rbd_report *report) {
    rbd_report own;
    rbd_contact_set *c;
    rbd_contact_options o;
    rbd_status status;
    if (!report) report = &own;
    status =
        rbdi_check_contact_list(m, w, list, n, held, n_held, options, contacts ? memory : NULL, size, report);
    if (contacts) *contacts = NULL;
    if (status) return status;
    o = rbdi_contact_defaults(options);
    c = rbdi_lay_contacts(m, n, n_held, rbdi_rows_of(held, n_held), &o, memory);
    for (int i = 0; i < n; ++i) rbdi_place_contact(m, c, &list[i], i);
    for (int i = n; i < n + n_held; ++i) {
        rbdi_place_constraint(m, &held[i - n], 0, &c->rows->constraint[i]);
        c->rows->constraint[i].kp = 1; /* any value above 0: derivatives need the position error */
    }
    rbdi_list_limits(m, &o, c->limit);
    rbdi_list_frictions(m, &o, c->bound);
    for (int i = c->frictions; i < c->bounds; ++i) rbdi_begin_bounded(&c->bound[i]);
    c->added = NULL;
    rbdi_clear(c->straight, m->nv);
    rbdi_begin_set(m, w, c->rows);
    rbd_contact_reset(c);
    *contacts = c;
    return RBD_OK;
}

RBDI_API rbd_status rbd_contact_plane(const rbd_model *m, rbd_contact_set *c, int i, const double normal[3],
                                      double height) {
    const rbd_status status = rbdi_check_constraints(m, c ? c->rows : NULL, normal != NULL);
    if (status) return status;
    if (i < 0 || i >= c->n) return RBD_ERR_INDEX;
    if (!rbdi_finite(normal, 3)) return RBD_ERR_AXIS;
    if (!rbdi_finite(&height, 1)) return RBD_ERR_POSITION;
    rbdi_place_plane(m, &c->rows->constraint[i], c->contact[i].body2, normal, height);
    return RBD_OK;
}

#endif
