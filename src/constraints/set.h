#ifndef RBDI_CONSTRAINTS_SET_H
#define RBDI_CONSTRAINTS_SET_H
#include "dynamics/crba.h"
#include "model/text.h"
#include "model/wide.h"
#include "constraints/layout.h"

/* ---- set code [set code] ---- */

static rbd_constraint rbdi_constraint_of(int body1, const double *p1, int body2, const double *p2,
                                         int angular) {
    rbd_constraint k;
    k.name = NULL;
    k.body1 = body1, k.body2 = body2;
    for (int i = 0; i < 9; ++i) k.rotation1[i] = k.rotation2[i] = i % 4 == 0;
    for (int i = 0; i < 3; ++i) {
        k.position1[i] = p1 ? p1[i] : 0;
        k.position2[i] = p2 ? p2[i] : 0;
        k.axes[i] = i < angular;
        k.axes[i + 3] = 1;
    }
    k.kp = k.kd = 0;
    return k;
}

/* A rotation that turns z into this axis. */
static void rbdi_frame_along(const double axis[3], double R[9]) {
    rbdi_wide A[9], T[9];
    int least = 0;
    rbdi_widen(axis, 3, A);
    rbdi_unit(A, A);
    for (int k = 1; k < 3; ++k)
        if (rbdi_w_abs(A[k]) < rbdi_w_abs(A[least])) least = k;
    for (int k = 0; k < 3; ++k) A[3 + k] = k == least;
    rbdi_orthonormalise(A); /* rows z, x, y: an even order */
    rbdi_w_transpose(A, T);
    for (int k = 0; k < 9; ++k) R[k] = (double)T[k / 3 * 3 + (k % 3 + 1) % 3];
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
    rbd_constraint k = rbdi_constraint_of(body1, point1, body2, point2, 2);
    if (axis1) rbdi_frame_along(axis1, k.rotation1);
    if (axis2) rbdi_frame_along(axis2, k.rotation2);
    return k;
}

RBDI_API char *rbd_constraint_finding_text(const rbd_finding *finding, char *text, size_t size) {
    rbd_finding rest;
    size_t at = 0;
    if (!finding || !text || size == 0) return text;
    rest = *finding;
    rest.body = -1;
    if (finding->body >= 0) {
        at = rbdi_append(text, size, at, "constraint ");
        at = rbdi_append_number(text, size, at, finding->body);
        if (finding->name) {
            at = rbdi_append(text, size, at, " '");
            at = rbdi_append(text, size, at, finding->name);
            at = rbdi_append(text, size, at, "'");
        }
        at = rbdi_append(text, size, at, ", ");
    }
    rbd_finding_text(&rest, text + at, size - at);
    return text;
}

static int rbdi_held_axes(const rbd_constraint *k) {
    int n = 0;
    for (int i = 0; i < 6; ++i) n += k->axes[i] == 1;
    return n;
}

/* Rows from one dof to the next: two batches may begin at any row. */
static int rbdi_row_stride(int rows) { return (rows + 4 * RBDI_BATCH) / RBDI_BATCH * RBDI_BATCH; }

static int rbdi_rows_of(const rbd_constraint *list, int n) {
    int rows = 0;
    for (int i = 0; i < n; ++i) rows += rbdi_held_axes(&list[i]);
    return rows;
}

/* At most so many row blocks. */
static int rbdi_row_blocks_of(const rbd_constraint *list, int n) {
    int blocks = 0;
    for (int i = 0; i < n; ++i) blocks += 2 * ((rbdi_held_axes(&list[i]) + RBDI_BATCH - 1) / RBDI_BATCH);
    return blocks;
}

RBDI_API size_t rbd_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n) {
    int rows;
    if (!m || (!list && n) || n < 0 || n > RBD_MAX_CONSTRAINTS) return 0;
    rows = rbdi_rows_of(list, n);
    return RBDI_CONSTRAINTS_BYTES(m->nv, n, rows, rbdi_row_stride(rows), rbdi_row_blocks_of(list, n));
}

/* The link that carries a body, -1 = world. */
static int rbdi_link_of_body(const rbd_model *m, int body) { return body < 0 ? -1 : m->frame[body].link; }

static rbd_status rbdi_check_constraint(const rbd_model *m, const rbd_constraint *k, int i,
                                        rbd_report *report) {
    int strange = rbdi_held_axes(k) == 0;
    for (int j = 0; j < 6; ++j) strange |= k->axes[j] != 0 && k->axes[j] != 1;
#define RBDI_REQUIRE(condition, status, field, sentence) \
    do { \
        if (!(condition)) { \
            rbdi_refuse(report, status, i, k->name, field); \
            report->error.text = sentence; \
            return status; \
        } \
    } while (0)
    RBDI_REQUIRE(k->body1 >= -1 && k->body1 < m->nb, RBD_ERR_INDEX, "body1", NULL);
    RBDI_REQUIRE(k->body1 >= 0 || k->body2 >= 0, RBD_ERR_INDEX, "body1",
                 RBDI_TEXT("both bodies are -1, the world, or what no name of a body was found as"));
    RBDI_REQUIRE(k->body2 >= -1 && k->body2 < m->nb, RBD_ERR_INDEX, "body2", NULL);
    RBDI_REQUIRE(rbdi_link_of_body(m, k->body1) != rbdi_link_of_body(m, k->body2), RBD_ERR_INDEX, "body2",
                 RBDI_TEXT("no joint moves it against body1"));
    RBDI_REQUIRE(rbdi_is_rotation(k->rotation1), RBD_ERR_ROTATION, "rotation1", NULL);
    RBDI_REQUIRE(rbdi_finite(k->position1, 3), RBD_ERR_POSITION, "position1", NULL);
    RBDI_REQUIRE(rbdi_is_rotation(k->rotation2), RBD_ERR_ROTATION, "rotation2", NULL);
    RBDI_REQUIRE(rbdi_finite(k->position2, 3), RBD_ERR_POSITION, "position2", NULL);
    RBDI_REQUIRE(!strange, RBD_ERR_AXIS, "axes", RBDI_TEXT("none is held, or one is neither 0 nor 1"));
    RBDI_REQUIRE(rbdi_finite_positive(&k->kp, 1), RBD_ERR_RANGE, "kp", NULL);
    RBDI_REQUIRE(rbdi_finite_positive(&k->kd, 1), RBD_ERR_RANGE, "kd", NULL);
#undef RBDI_REQUIRE
    return RBD_OK;
}

/* A frame on a body as a frame on the link that carries it; returns the link. */
static int rbdi_place_frame(const rbd_model *m, int body, const double R[9], const double p[3],
                            rbd_const R_link[9], rbdi_c3 *p_link) {
    rbdi_wide A[9], x[3], E[9], r[3] = {0, 0, 0};
    rbdi_w_identity(E);
    rbdi_widen(R, 9, A);
    rbdi_widen(p, 3, x);
    if (rbdi_all_zero(R, 9)) rbdi_w_identity(A);
    rbdi_orthonormalise(A);
    if (body >= 0) {
        const rbdi_frame *u = &m->frame[body];
        for (int k = 0; k < 9; ++k) E[k] = (rbdi_wide)u->E[k / 3 + k % 3 * 3]; /* transposed */
        r[0] = (rbdi_wide)u->r.x, r[1] = (rbdi_wide)u->r.y, r[2] = (rbdi_wide)u->r.z;
    }
    rbdi_w_product(E, A, A);
    rbdi_w_apply(E, x, x);
    for (int k = 0; k < 9; ++k) R_link[k] = (rbd_const)A[k];
    p_link->x = (rbd_const)(r[0] + x[0]), p_link->y = (rbd_const)(r[1] + x[1]),
    p_link->z = (rbd_const)(r[2] + x[2]);
    return rbdi_link_of_body(m, body);
}

/* The nearest link that carries both or is one of them, -1 = world: ancestors have smaller indices. */
static int rbdi_common_ancestor(const rbd_model *m, int one, int two) {
    while (one != two) {
        int *behind = one > two ? &one : &two;
        *behind = m->link[*behind].parent;
    }
    return one;
}

static void rbdi_place_constraint(const rbd_model *m, const rbd_constraint *from, int row,
                                  rbdi_constraint *to) {
    to->link[0] =
        (int16_t)rbdi_place_frame(m, from->body1, from->rotation1, from->position1, to->R[0], &to->p[0]);
    to->link[1] =
        (int16_t)rbdi_place_frame(m, from->body2, from->rotation2, from->position2, to->R[1], &to->p[1]);
    to->ancestor = (int16_t)rbdi_common_ancestor(m, to->link[0], to->link[1]);
    to->kp = RBD_C(from->kp), to->kd = RBD_C(from->kd);
    to->row = (int16_t)row;
    to->rows = to->angular = 0;
    for (int r = 0; r < RBDI_SIX_ROWS; ++r) to->held[0][r] = to->held[1][r] = to->held[2][r] = 0;
    for (int j = 0; j < 6; ++j) {
        if (!from->axes[j]) continue;
        for (int i = 0; i < 3; ++i) to->held[i][to->rows] = to->R[1][3 * i + j % 3];
        to->axis[to->rows++] = (int16_t)j;
        to->angular = (int16_t)(to->angular + (j < 3));
    }
}

/* A common ancestor farther from the world comes before; else the caller's order stays. */
static void rbdi_sort_constraints(rbdi_constraint *list, int n) {
    for (int i = 1; i < n; ++i) {
        const rbdi_constraint k = list[i];
        int at = i;
        for (; at > 0 && list[at - 1].ancestor < k.ancestor; --at) list[at] = list[at - 1];
        list[at] = k;
    }
}

/* The last dof of the path to a link, mimic joints standing for those that they follow; -1 = none. */
static int rbdi_tip_of(const rbd_model *m, int link) {
    int tip = -1;
    for (; link >= 0; link = m->link[link].parent)
        for (int j = rbdi_link_dofs(m, &m->link[link]) - 1; j >= 0; --j) {
            const int i = rbdi_source(m, m->link[link].iv + j);
            if (tip < 0 || m->dof[i].depth > m->dof[tip].depth) tip = i;
        }
    return tip;
}

/* The rows of a constraint reach the dofs of the paths to its bodies. With M's factor those of L^-T J' reach
   what both paths begin with too; articulated bodies eliminate them before: `passed`. */
static void rbdi_reach_dofs(const rbd_model *m, rbd_constraint_set *c, rbdi_constraint *k) {
    const int end = k->row + k->rows;
    k->trunk = 0;
    for (int side = 0; side < 2; ++side) {
        k->tip[side] = (int16_t)rbdi_tip_of(m, k->link[side]);
        for (int i = k->tip[side]; i >= 0; i = m->dof[i].lambda) {
            rbdi_span *s = &c->span[i];
            if (s->end == 0) s->first = k->row;
            if (side && s->end == end) ++k->trunk;
            s->end = (int16_t)end;
        }
    }
    k->dofs = 0;
    for (int side = 0; side < 2; ++side) {
        const int least = side ? k->trunk : 0, base = k->dofs - least;
        for (int i = k->tip[side]; i >= 0 && m->dof[i].depth >= least; i = m->dof[i].lambda, ++k->dofs)
            k->dof[base + m->dof[i].depth] = (int16_t)i;
    }
    for (int t = k->trunk; t < k->dofs; ++t) {
        rbdi_span *s = &c->passed[k->dof[t]];
        if (s->end == 0) s->first = k->row;
        s->end = (int16_t)end;
    }
}

/* Finds the rows that share a joint with each constraint's rows: from `low` on, up to `end`. */
static void rbdi_find_coupled_rows(rbd_constraint_set *c) {
    const rbdi_constraint *stop = c->constraint + c->n;
    for (rbdi_constraint *k = c->constraint; k < stop; ++k) {
        k->low = k->row, k->end = (int16_t)(k->row + k->rows);
        for (int t = k->trunk; t < k->dofs; ++t)
            if (c->passed[k->dof[t]].first < k->low) k->low = c->passed[k->dof[t]].first;
        for (rbdi_constraint *before = c->constraint; before < k; ++before)
            if (before->row >= k->low) before->end = k->end;
    }
    for (rbdi_constraint *k = c->constraint; k < stop; ++k)
        if (k->end + 2 * RBDI_BATCH > c->rows)
            k->end = (int16_t)c->rows; /* or the last batches would reach beta */
}

/* Rows and row blocks in the order of the sorted constraints. */
static void rbdi_number_rows(rbd_constraint_set *c) {
    int row = 0;
    c->blocks = 0;
    for (rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k) {
        for (int r = 0; r < k->rows; ++r) c->at[k->row + r] = (int16_t)(row + r);
        k->row = (int16_t)row;
        for (int side = 0; side < 2; ++side) {
            k->block[side] = (int16_t)c->blocks;
            for (int r = 0; k->link[side] >= 0 && r < k->rows; r += RBDI_BATCH) {
                rbdi_row_block *on = &c->block[c->blocks++];
                on->row = (int16_t)(row + r);
                on->rows = (int16_t)(k->rows - r < RBDI_BATCH ? k->rows - r : RBDI_BATCH);
                on->at = k->link[side];
            }
        }
        row += k->rows;
    }
}

/* Adds up the bodies of a link: their inertia about its origin, in its axes. */
static void rbdi_bodies_of_link(const rbd_model *m, int link, rbd_real A[6][6]) {
    for (int i = 0; i < 36; ++i) A[i / 6][i % 6] = rbdi_zero();
    for (int b = 0; b < m->nb; ++b) {
        const rbdi_frame *u = &m->frame[b];
        if (u->link != link) continue;
        const rbdi_mat E = rbdi_mat_c(u->E);
        const rbdi_v3 p = rbdi_add(rbdi_vec_c(u->r), rbdi_mul_t(E, rbdi_vec_c(u->com)));
        const rbdi_sym I = rbdi_sym_up(E, rbdi_sym_c(u->I));
        const rbd_real mass = rbdi_set(u->mass), x = mass * p.x, y = mass * p.y, z = mass * p.z;
        A[0][0] = A[0][0] + I.xx + y * p.y + z * p.z, A[1][1] = A[1][1] + I.yy + x * p.x + z * p.z;
        A[2][2] = A[2][2] + I.zz + x * p.x + y * p.y, A[0][1] = A[0][1] + I.xy - x * p.y;
        A[0][2] = A[0][2] + I.xz - x * p.z, A[1][2] = A[1][2] + I.yz - y * p.z;
        A[0][4] = A[0][4] - z, A[0][5] = A[0][5] + y, A[1][3] = A[1][3] + z;
        A[1][5] = A[1][5] - x, A[2][3] = A[2][3] - y, A[2][4] = A[2][4] + x;
        for (int i = 3; i < 6; ++i) A[i][i] = A[i][i] + mass;
    }
}

/* Whether the pivots of a link's joint are above doubt by the link's own inertia: what hangs on it only
   adds. */
static int rbdi_own_pivots_clear(const rbd_model *m, int i) {
    const rbdi_link *l = &m->link[i];
    const int n = rbdi_link_dofs(m, l), first = l->kind == RBDI_BLOCK ? rbdi_block_of(m, l)->first : 0;
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    rbd_real A[6][6], H[6][6];
    rbdi_bodies_of_link(m, i, A);
    for (int j = 0; j < n; ++j)
        for (int k = j; k < n; ++k) H[j][k] = A[first + j][first + k];
    if (l->kind != RBDI_BLOCK) H[0][0] = A[2][2] * (l->rho * l->rho) + A[5][5] * (l->kappa * l->kappa);
    for (int k = 0; k < n; ++k) H[k][k] = H[k][k] + m->dof[l->iv + k].armature;
    for (int k = n - 1; k >= 0; --k) {
        const rbd_real inverse = rbdi_pivot_inverse(H[k][k], m->dof[l->iv + k].scale, &doubt);
        for (int i1 = 0; i1 < k; ++i1)
            for (int j = i1; j < k; ++j) H[i1][j] = H[i1][j] - H[i1][k] * H[j][k] * inverse;
    }
    return !rbdi_any(doubt);
}

/* Whether rows may be eliminated on a link. From there on they add to the pivots of its joint and those
   before it, which then no longer tell whether M is regular. So the links' own inertia must. */
static int rbdi_may_eliminate_at(const rbd_model *m, int link) {
    for (; link >= 0; link = m->link[link].parent)
        if (!rbdi_own_pivots_clear(m, link)) return 0;
    return 1;
}

/* Whether the rows between the two links of a constraint must depend on each other. */
static int rbdi_too_many_rows(const rbd_constraint_set *c, const rbdi_constraint *k) {
    int rows = 0;
    for (const rbdi_constraint *o = c->constraint; o < c->constraint + c->n; ++o)
        if ((o->link[0] == k->link[0] && o->link[1] == k->link[1]) ||
            (o->link[0] == k->link[1] && o->link[1] == k->link[0]))
            rows += o->rows;
    return rows > 6 || rows > k->dofs - k->trunk;
}

/* Whether articulated bodies could not tell, or would always find rows that depend on each other. */
static int rbdi_needs_factor(const rbd_model *m, const rbd_constraint_set *c) {
    int needs = m->nmimic > 0 || c->rows > m->nv;
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
        needs |= rbdi_too_many_rows(c, k) || !rbdi_may_eliminate_at(m, k->ancestor);
    return needs;
}

/* Checks the arguments of rbd_constraint_set_init. */
static rbd_status rbdi_check_list(const rbd_model *m, const rbd_work *w, const rbd_constraint *list, int n,
                                  const void *memory, size_t size, rbd_report *report) {
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (!m || !w || (!list && n) || !memory) return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (!rbdi_fits(m, w)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (n < 0 || n > RBD_MAX_CONSTRAINTS) {
        rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);
        report->error.text = RBDI_TEXT("the number of constraints is below 0 or above RBD_MAX_CONSTRAINTS");
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
static rbd_constraint_set *rbdi_lay_constraints(int nv, int n, int rows, int blocks, void *memory) {
    const int stride = rbdi_row_stride(rows);
    unsigned char *p = rbdi_aligned(memory);
    rbd_constraint_set *c = (rbd_constraint_set *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_constraint_set)));
    rbd_real *x;
    c->n = n, c->rows = rows, c->stride = stride;
    c->constraint = (rbdi_constraint *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n * sizeof(rbdi_constraint)));
    c->block = (rbdi_row_block *)rbdi_take(&p, 1, RBDI_ROUND((size_t)blocks * sizeof(rbdi_row_block)));
    c->link = (int16_t *)rbdi_take(
        &p, 1, RBDI_ROUND(((size_t)nv * ((size_t)n + 1) + (size_t)rows) * sizeof(int16_t)));
    c->at = c->link + nv;
    for (int i = 0; i < n; ++i) c->constraint[i].dof = c->at + rows + i * nv;
    c->span = (rbdi_span *)rbdi_take(&p, 1, RBDI_ROUND(2 * (size_t)nv * sizeof(rbdi_span)));
    c->passed = c->span + nv;
    c->path = (int32_t *)rbdi_take(&p, 1, RBDI_ROUND((size_t)nv * sizeof(int32_t)));
    c->Y = (rbd_real *)rbdi_take(&p, nv * stride, sizeof(rbd_real));
    c->R = (rbd_real *)rbdi_take(&p, (rows > nv ? rows : nv) * stride, sizeof(rbd_real));
    c->W = (rbd_real *)rbdi_take(&p, 6 * rows, sizeof(rbd_real));
    x = (rbd_real *)rbdi_take(&p, 4 * nv, sizeof(rbd_real));
    c->x = x, c->stack = x + nv, c->before = x + 2 * nv, c->D_inverse = x + 3 * nv;
    x = (rbd_real *)rbdi_take(&p, 11 * stride, sizeof(rbd_real));
    rbdi_clear(x, 11 * stride);
    c->b = x, c->lambda = x + stride, c->target = x + 2 * stride, c->u = x + 3 * stride;
    c->gamma = x + 4 * stride, c->e = x + 5 * stride, c->demand = x + 6 * stride, c->square = x + 7 * stride;
    c->share = x + 8 * stride, c->chosen = x + 9 * stride, c->inverse = x + 10 * stride;
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
    c = rbdi_lay_constraints(m->nv, n, rbdi_rows_of(list, n), rbdi_row_blocks_of(list, n), memory);
    for (int k = 0; k < RBDI_SHAPE; ++k) c->shape[k] = m->shape[k];
    c->w = w, c->infeasible = -1, c->exchanged = 0, c->dirty = 1;
    for (int i = 0; i < n; row += c->constraint[i++].rows) {
        rbdi_place_constraint(m, &list[i], row, &c->constraint[i]);
        c->constraint[i].index = (int16_t)i;
    }
    rbdi_sort_constraints(c->constraint, n);
    rbdi_number_rows(c);
    for (int k = 0; k < 2 * m->nv; ++k) c->span[k].first = c->span[k].end = 0; /* and passed */
    for (int i = 0; i < n; ++i) rbdi_reach_dofs(m, c, &c->constraint[i]);
    c->links = 0;
    for (int i = 0; i < m->nl && !m->nmimic; ++i)
        if (c->span[m->link[i].iv].end > 0) c->link[c->links++] = (int16_t)i;
    rbdi_find_coupled_rows(c);
    c->moving = 0;
    for (int i = 0; i < n; ++i)
        c->moving |= list[i].kp > 0 || list[i].kd > 0 || c->constraint[i].link[1] >= 0;
    c->factored = rbdi_needs_factor(m, c);
    *constraints = c;
    return RBD_OK;
}

#endif
