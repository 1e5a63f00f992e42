/* algorithms.c - see algorithms.h. SPDX-License-Identifier: MIT */
#include "algorithms.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- algorithms ---- */

static rbd_status run_id(const state *s, double *out) {
    return rbd_rnea(s->m, s->w, s->q, s->v, s->a, NULL, out);
}
static rbd_status run_mm(const state *s, double *out) { return rbd_crba(s->m, s->w, s->q, out); }
static rbd_status run_fd(const state *s, double *out) {
    return rbd_aba(s->m, s->w, s->q, s->v, s->tau, NULL, out);
}
static rbd_status run_fd_cholesky(const state *s, double *out) {
    return rbd_fd_cholesky(s->m, s->w, s->q, s->v, s->tau, NULL, out);
}
static rbd_status run_bias(const state *s, double *out) {
    return rbd_bias(s->m, s->w, s->q, s->v, NULL, out);
}
static rbd_status run_gravity(const state *s, double *out) {
    return rbd_gravity_torque(s->m, s->w, s->q, out);
}
static rbd_status run_minv(const state *s, double *out) { return rbd_minverse(s->m, s->w, s->q, out); }
static rbd_status run_coriolis(const state *s, double *out) {
    return rbd_coriolis(s->m, s->d, s->q, s->v, out);
}

static rbd_status run_pose(const state *s, double *out) {
    rbd_status status = rbd_kinematics(s->m, s->w, s->q, NULL, NULL);
    for (int i = 0; i < rbd_nb(s->m); i++) {
        if (!rbd_body_name(s->m, i)) continue;
        rbd_body_pose(s->m, s->w, i, out + 3, out);
        out += 12;
    }
    return status;
}
static rbd_status run_energy(const state *s, double *out) {
    rbd_kinematics(s->m, s->w, s->q, s->v, NULL);
    return rbd_energy(s->m, s->w, &out[0], &out[1]);
}

static rbd_status run_jacobian(const state *s, double *out) {
    rbd_kinematics(s->m, s->w, s->q, NULL, NULL);
    return rbd_jacobian(s->m, s->w, s->body, s->point, RBD_WORLD_AXES, out);
}
static rbd_status run_point(const state *s, double *out) {
    rbd_kinematics(s->m, s->w, s->q, s->v, s->a);
    rbd_point_velocity(s->m, s->w, s->body, s->point, RBD_WORLD_AXES, out);
    return rbd_point_acceleration(s->m, s->w, s->body, s->point, RBD_WORLD_AXES, out + 6);
}

static rbd_status run_com(const state *s, double *out) {
    rbd_kinematics(s->m, s->w, s->q, s->v, NULL);
    return rbd_com(s->m, s->w, out, out + 3, NULL);
}
static rbd_status run_com_jacobian(const state *s, double *out) {
    return rbd_com_jacobian(s->m, s->d, s->q, out);
}
static rbd_status run_momentum(const state *s, double *out) {
    rbd_kinematics(s->m, s->w, s->q, s->v, s->a);
    return rbd_momentum(s->m, s->w, out, out + 6);
}
static rbd_status run_momentum_matrix(const state *s, double *out) {
    return rbd_momentum_matrix(s->m, s->d, s->q, NULL, out, NULL);
}

static rbd_status run_rates(const state *s, double *out) {
    return rbd_rates_from_velocity(s->m, s->q, s->v, out);
}
static rbd_status run_joint_wrench(const state *s, double *out) {
    return rbd_joint_wrench(s->m, s->w, s->q, s->v, s->a, NULL, out);
}
static rbd_status run_generalized_momentum(const state *s, double *out) {
    return rbd_generalized_momentum(s->m, s->w, s->q, s->v, out, out + rbd_nv(s->m));
}

static rbd_status run_id_derivatives(const state *s, double *out) {
    const int nv = rbd_nv(s->m);
    return rbd_id_derivatives(s->m, s->d, s->q, s->v, s->a, NULL, out, out + nv * nv, NULL);
}
static rbd_status run_fd_derivatives(const state *s, double *out) {
    const int square = rbd_nv(s->m) * rbd_nv(s->m);
    return rbd_fd_derivatives(s->m, s->d, s->q, s->v, s->tau, NULL, NULL, out, out + square,
                              out + 2 * square);
}
static rbd_status run_gravity_derivatives(const state *s, double *out) {
    return rbd_gravity_torque_derivatives(s->m, s->d, s->q, out);
}

static rbd_status run_integrate_derivatives(const state *s, double *out) {
    return rbd_integrate_derivatives(s->m, s->v, 1, out, out + rbd_nv(s->m) * rbd_nv(s->m));
}

/* Between q and the end of the step v. */
static rbd_status run_difference_derivatives(const state *s, double *out) {
    double *next = malloc((size_t)rbd_nq(s->m) * sizeof *next);
    rbd_status status = next ? rbd_integrate(s->m, s->q, s->v, 1, next) : RBD_ERR_MEMORY;
    if (status == RBD_OK)
        status = rbd_difference_derivatives(s->m, s->q, next, out, out + rbd_nv(s->m) * rbd_nv(s->m));
    free(next);
    return status;
}

static rbd_status run_regressor(const state *s, double *out) {
    return rbd_regressor(s->m, s->d, s->q, s->v, s->a, out);
}
static rbd_status run_energy_regressors(const state *s, double *out) {
    return rbd_energy_regressors(s->m, s->d, s->q, s->v, out, out + 10 * rbd_nb(s->m));
}

static rbd_status run_hybrid(const state *s, double *out) {
    const int nv = rbd_nv(s->m);
    memcpy(out, s->a, (size_t)nv * sizeof *out);
    memcpy(out + nv, s->tau, (size_t)nv * sizeof *out);
    return rbd_hybrid(s->m, s->w, s->q, s->v, s->given, out, out + nv, NULL);
}

static rbd_status run_constrained(const state *s, double *out) {
    return rbd_constrained_fd(s->m, s->c, s->q, s->v, s->tau, NULL, out, out + rbd_nv(s->m));
}

/* Each state for itself: no impulses are kept. */
static rbd_status run_contact_step(const state *s, double *out) {
    double *v_next = out + rbd_nq(s->m), *to = v_next + rbd_nv(s->m);
    rbd_contact_reset(s->contacts);
    const rbd_status status =
        rbd_contact_step(s->m, s->contacts, s->q, s->v, s->tau, NULL, NULL, s->dt, out, v_next);
    for (int i = 0; i < s->ncontacts; i++, to += 5) to[0] = rbd_contact_get(s->contacts, i, &to[1], &to[2]);
    *to = rbd_contact_last(s->contacts).residual;
    return status;
}

/* clang-format off */
static const algorithm algorithms[] = {
    {"id", "inverse dynamics (RNEA)", TAKES_V | TAKES_A, {{"tau", ONE, DOFS}}, run_id},
    {"mm", "mass matrix (CRBA)", 0, {{"M", DOFS, DOFS}}, run_mm},
    {"minv", "its inverse", 0, {{"Minv", DOFS, DOFS}}, run_minv},
    {"fd", "forward dynamics (ABA)", TAKES_V | TAKES_TAU, {{"a", ONE, DOFS}}, run_fd},
    {"fd_cholesky", "forward dynamics (Cholesky)", TAKES_V | TAKES_TAU, {{"a", ONE, DOFS}}, run_fd_cholesky},
    {"hybrid", "some a given, other tau", TAKES_V | TAKES_A | TAKES_TAU | TAKES_GIVEN,
     {{"a", ONE, DOFS}, {"tau", ONE, DOFS}}, run_hybrid},
    {"constrained_fd", "with --constraints FILE", TAKES_V | TAKES_TAU | TAKES_CONSTRAINTS,
     {{"a", ONE, DOFS}, {"lambda", ONE, HELD}}, run_constrained},
    {"contact_step", "with --contacts FILE", TAKES_V | TAKES_TAU | TAKES_CONTACTS,
     {{"q_next", ONE, COORDINATES}, {"v_next", ONE, DOFS}, {"contact", ONE, TOUCHES}, {"residual", ONE, ONE}},
     run_contact_step},
    {"bias", "inverse dynamics, a = 0", TAKES_V, {{"tau", ONE, DOFS}}, run_bias},
    {"gravity_torque", "inverse dynamics, v = a = 0", 0, {{"tau", ONE, DOFS}}, run_gravity},
    {"coriolis", "Coriolis matrix", TAKES_V, {{"C", DOFS, DOFS}}, run_coriolis},
    {"pose", "of every link in the world", NO_MASS, {{"", ONE, POSES}}, run_pose},
    {"energy", "kinetic and potential", TAKES_V, {{"kinetic", ONE, ONE}, {"potential", ONE, ONE}},
     run_energy},
    {"jacobian", "of a point", TAKES_POINT | NO_MASS, {{"J", SIX, DOFS}}, run_jacobian},
    {"point", "its velocity, acceleration", TAKES_POINT | TAKES_V | TAKES_A | NO_MASS,
     {{"point_v", ONE, SIX}, {"point_a", ONE, SIX}}, run_point},
    {"com", "centre of mass, velocity", TAKES_V, {{"com", ONE, XYZ}, {"com_v", ONE, XYZ}}, run_com},
    {"com_jacobian", "of the centre of mass", 0, {{"J_com", XYZ, DOFS}}, run_com_jacobian},
    {"momentum", "centroidal, and its rate", TAKES_V | TAKES_A, {{"h", ONE, SIX}, {"h_dot", ONE, SIX}},
     run_momentum},
    {"momentum_matrix", "centroidal", 0, {{"A", SIX, DOFS}}, run_momentum_matrix},
    {"rates", "of q, from v", TAKES_V | NO_MASS, {{"dq", ONE, COORDINATES}}, run_rates},
    {"joint_wrench", "from parent on link", TAKES_V | TAKES_A, {{"f", ONE, WRENCHES}}, run_joint_wrench},
    {"generalized_momentum", "M v and C' v", TAKES_V, {{"p", ONE, DOFS}, {"ctv", ONE, DOFS}},
     run_generalized_momentum},
    {"id_derivatives", "of inverse dynamics", TAKES_V | TAKES_A,
     {{"dtau_dq", DOFS, DOFS}, {"dtau_dv", DOFS, DOFS}}, run_id_derivatives},
    {"fd_derivatives", "of forward dynamics", TAKES_V | TAKES_TAU,
     {{"da_dq", DOFS, DOFS}, {"da_dv", DOFS, DOFS}, {"Minv", DOFS, DOFS}}, run_fd_derivatives},
    {"gravity_torque_derivatives", "of gravity_torque", 0, {{"dg_dq", DOFS, DOFS}}, run_gravity_derivatives},
    {"integrate_derivatives", "of the step v from q", TAKES_V | NO_MASS,
     {{"dnext_dq", DOFS, DOFS}, {"dnext_dv", DOFS, DOFS}}, run_integrate_derivatives},
    {"difference_derivatives", "of (q after v) - q", TAKES_V | NO_MASS,
     {{"dd_dq0", DOFS, DOFS}, {"dd_dq1", DOFS, DOFS}}, run_difference_derivatives},
    {"regressor", "of inverse dynamics", TAKES_V | TAKES_A, {{"Y", DOFS, PARAMETERS}}, run_regressor},
    {"energy_regressors", "of both energies", TAKES_V,
     {{"Y_kinetic", ONE, PARAMETERS}, {"Y_potential", ONE, PARAMETERS}}, run_energy_regressors},
};
/* clang-format on */
enum { ALGORITHMS = sizeof algorithms / sizeof *algorithms };

static const char *const others[][2] = {
    {"rnea", "id"}, {"crba", "mm"}, {"aba", "fd"}, {"minverse", "minv"}, {"contact", "contact_step"}};
enum { OTHERS = sizeof others / sizeof *others };

void see_algorithms(nearest *n) {
    for (int i = 0; i < ALGORITHMS; i++) nearest_see_words(n, algorithms[i].name, strlen(algorithms[i].name));
    for (int i = 0; i < OTHERS; i++) nearest_see_words(n, others[i][0], strlen(others[i][0]));
}

const algorithm *find_algorithm(const char *name) {
    for (int i = 0; i < OTHERS; i++)
        if (strcmp(others[i][0], name) == 0) name = others[i][1];
    for (int i = 0; i < ALGORITHMS; i++)
        if (strcmp(algorithms[i].name, name) == 0) return &algorithms[i];
    return NULL;
}

void print_algorithms(void) {
    static const char *const parts[] = {
        "",        ".XYZ",          ".ROW",      ".COORDINATE",
        ".DOF",    ".LINK.PAR",     ".LINK.ROW", "p.LINK.x ..., R.LINK.xx ...",
        ".NUMBER", ".CONTACT.TOUCH"};
    printf("  %-22s  %-27s  %-9s  %s\n", "name", "what", "takes", "gives");
    for (int i = 0; i < ALGORITHMS; i++) {
        const algorithm *a = &algorithms[i];
        char takes[20];
        snprintf(takes, sizeof takes, "q%s%s%s", a->takes & TAKES_V ? " v" : "",
                 a->takes & TAKES_A ? " a" : "", a->takes & TAKES_TAU ? " tau" : "");
        printf("  %-22s  %-27s  %-9s ", a->name, a->what, takes);
        for (const output *o = a->gives; o->name; o++)
            printf("%s%s%s%s", o == a->gives ? " " : ", ", o->name, parts[o->rows], parts[o->columns]);
        printf("\n");
    }
}

/* ---- names of columns ---- */

/* Adds "first.second.third"; those that are empty are left out. */
static void add_name(columns *c, const char *first, const char *second, const char *third) {
    const char *const parts[] = {first, second, third};
    size_t length = 1;
    char *name;
    for (int i = 0; i < 3; i++) length += strlen(parts[i]) + 1;
    name = allocate(length, 1);
    for (int i = 0; i < 3; i++) {
        if (*parts[i] && *name) strcat(name, ".");
        strcat(name, parts[i]);
    }
    if (c->n == c->max) {
        char **larger = allocate((size_t)(c->max = 2 * c->max + 64), sizeof *larger);
        if (c->n) memcpy(larger, c->name, (size_t)c->n * sizeof *larger);
        free(c->name);
        c->name = larger;
    }
    c->name[c->n++] = name;
}

void free_columns(columns *c) {
    for (int i = 0; i < c->n; i++) free(c->name[i]);
    free(c->name);
}

static void add_coordinates(columns *c, const rbd_model *m, const char *before) {
    for (int b = 0; b < rbd_nb(m); b++) {
        rbd_joint_info info;
        rbd_joint(m, b, &info);
        for (int k = 0; k < info.nq; k++)
            add_name(c, before, rbd_joint_name(m, b), coordinate_names(info.type)[k]);
    }
}

void add_dofs(columns *c, const rbd_model *m, const char *before) {
    for (int b = 0; b < rbd_nb(m); b++) {
        rbd_joint_info info;
        rbd_joint(m, b, &info);
        for (int k = 0; k < info.nv; k++) add_name(c, before, rbd_joint_name(m, b), dof_names(info.type)[k]);
    }
}

static void add_poses(columns *c, const rbd_model *m) {
    static const char *const p[] = {"x", "y", "z"};
    static const char *const R[] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
    for (int b = 0; b < rbd_nb(m); b++) {
        const char *link = rbd_body_name(m, b);
        for (int k = 0; link && k < 3; k++) add_name(c, "p", link, p[k]);
        for (int k = 0; link && k < 9; k++) add_name(c, "R", link, R[k]);
    }
}

static const char *const six[] = {"wx", "wy", "wz", "vx", "vy", "vz"};
static const char *const ten[] = {"m", "mx", "my", "mz", "ixx", "ixy", "ixz", "iyy", "iyz", "izz"};

/* n names for every link; one without a name is called by its joint. */
static void add_links(columns *c, const rbd_model *m, const char *const *names, int n) {
    for (int b = 0; b < rbd_nb(m); b++)
        for (int k = 0; k < n; k++)
            add_name(c, rbd_body_name(m, b) ? rbd_body_name(m, b) : rbd_joint_name(m, b), names[k], "");
}

static void add_rows(columns *c, const state *s) {
    for (int i = 0; i < rbd_constraint_rows(s->c); i++) {
        char number[12];
        snprintf(number, sizeof number, "%d", i);
        add_name(c, number, "", "");
    }
}

static void add_contacts(columns *c, const state *s) {
    static const char *const parts[] = {"state", "gap", "fx", "fy", "fz"};
    for (int i = 0; i < s->ncontacts; i++)
        for (int k = 0; k < 5; k++) add_name(c, s->contact_name[i], parts[k], "");
}

static void add_axis(columns *c, const state *s, axis a) {
    static const char *const xyz[] = {"x", "y", "z"};
    switch (a) {
    case ONE: add_name(c, "", "", ""); break;
    case XYZ:
        for (int k = 0; k < 3; k++) add_name(c, xyz[k], "", "");
        break;
    case SIX:
        for (int k = 0; k < 6; k++) add_name(c, six[k], "", "");
        break;
    case COORDINATES: add_coordinates(c, s->m, ""); break;
    case DOFS: add_dofs(c, s->m, ""); break;
    case PARAMETERS: add_links(c, s->m, ten, 10); break;
    case WRENCHES: add_links(c, s->m, six, 6); break;
    case POSES: add_poses(c, s->m); break;
    case HELD: add_rows(c, s); break;
    case TOUCHES: add_contacts(c, s); break;
    }
}

int mark_dofs(const rbd_model *m, const char *name, unsigned char *marks) {
    const int joint = rbd_joint_index(m, name);
    columns dofs = {0};
    int found = -1;
    add_dofs(&dofs, m, "");
    for (int i = 0; i < dofs.n; i++)
        if (rbd_dof_body(m, i) == joint || strcmp(dofs.name[i], name) == 0) marks[i] = 1, found = 0;
    free_columns(&dofs);
    return found;
}

void add_inputs(columns *c, const rbd_model *m, const algorithm *a) {
    add_coordinates(c, m, "q");
    if (a->takes & TAKES_V) add_dofs(c, m, "v");
    if (a->takes & TAKES_A) add_dofs(c, m, "a");
    if (a->takes & TAKES_TAU) add_dofs(c, m, "tau");
}

void add_outputs(columns *c, const state *s, const algorithm *a) {
    for (const output *o = a->gives; o->name; o++) {
        columns rows = {0}, across = {0};
        add_axis(&rows, s, o->rows);
        add_axis(&across, s, o->columns);
        for (int i = 0; i < rows.n; i++)
            for (int k = 0; k < across.n; k++) add_name(c, o->name, rows.name[i], across.name[k]);
        free_columns(&rows);
        free_columns(&across);
    }
}
