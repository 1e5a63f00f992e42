#ifndef RBDI_CONSTRAINTS_SET_H
#define RBDI_CONSTRAINTS_SET_H
#include "model/text.h"
#include "model/wide.h"
#include "constraints/passes.h"

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

RBD_API rbd_constraint rbd_point_contact(int body, const double point[3], const double place[3]) {
    return rbdi_constraint_of(body, point, -1, place, 0);
}

RBD_API rbd_constraint rbd_flat_contact(int body, const double point[3], const double place[3]) {
    return rbdi_constraint_of(body, point, -1, place, 3);
}

RBD_API rbd_constraint rbd_ball_loop(int body1, const double point1[3], int body2, const double point2[3]) {
    return rbdi_constraint_of(body1, point1, body2, point2, 0);
}

RBD_API rbd_constraint rbd_hinge_loop(int body1, const double point1[3], const double axis1[3], int body2,
                                      const double point2[3], const double axis2[3]) {
    rbd_constraint k = rbdi_constraint_of(body1, point1, body2, point2, 2);
    if (axis1) rbdi_frame_along(axis1, k.rotation1);
    if (axis2) rbdi_frame_along(axis2, k.rotation2);
    return k;
}

#ifndef RBD_NO_TEXT
RBD_API char *rbd_constraint_finding_text(const rbd_finding *finding, char *text, size_t size) {
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
#endif

static int rbdi_held_axes(const rbd_constraint *k) {
    int n = 0;
    for (int i = 0; i < 6; ++i) n += k->axes[i] == 1;
    return n;
}

/* Rows from one dof to the next: two batches may begin at any row. */
static int rbdi_row_stride(int rows) { return rbdi_whole_batches(rows + 2 * RBDI_BATCH - 1); }

static int rbdi_rows_of(const rbd_constraint *list, int n) {
    int rows = 0;
    for (int i = 0; i < n; ++i) rows += rbdi_held_axes(&list[i]);
    return rows;
}

static int rbdi_batches_of(const rbd_constraint *list, int n) {
    int batches = 0;
    for (int i = 0; i < n; ++i) batches += rbdi_whole_batches(rbdi_held_axes(&list[i])) / RBDI_BATCH;
    return batches;
}

RBD_API size_t rbd_constraints_size(const rbd_model *m, const rbd_constraint *list, int n) {
    int rows;
    if (!m || (!list && n) || n < 0 || n > RBD_MAX_CONSTRAINTS) return 0;
    rows = rbdi_rows_of(list, n);
    return RBDI_CONSTRAINTS_BYTES(m->nv, n, rows, rbdi_row_stride(rows), rbdi_batches_of(list, n),
                                  rbdi_batches_of(list, n) * RBDI_BATCH, RBDI_BATCH);
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
    RBDI_REQUIRE(rbdi_finite_positive(&k->kp, 1), RBD_ERR_GAIN, "kp", NULL);
    RBDI_REQUIRE(rbdi_finite_positive(&k->kd, 1), RBD_ERR_GAIN, "kd", NULL);
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

/* The last link that the paths to both have, -1 = none: ancestors have smaller indices. */
static int rbdi_meeting_link(const rbd_model *m, int one, int two) {
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
    to->meet = (int16_t)rbdi_meeting_link(m, to->link[0], to->link[1]);
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

/* Whether the part of a path behind `meet`, to `tip`, has link i. */
static int rbdi_is_between(const rbd_model *m, int meet, int tip, int i) {
    return i > meet && i <= tip && m->link[tip].first < m->link[i].end;
}

/* What meets behind goes behind, and so is eliminated before; else the caller's order stays. */
static void rbdi_sort_constraints(rbdi_constraint *list, int n) {
    for (int i = 1; i < n; ++i) {
        const rbdi_constraint k = list[i];
        int at = i;
        for (; at > 0 && list[at - 1].meet > k.meet; --at) list[at] = list[at - 1];
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

/* The rows of a constraint reach the dofs of the paths to its bodies: L^-T J' those that J' does not, too. */
static void rbdi_span_constraint(const rbd_model *m, rbd_constraints *c, rbdi_constraint *k) {
    k->trunk = 0;
    for (int side = 0; side < 2; ++side) {
        k->tip[side] = (int16_t)rbdi_tip_of(m, k->link[side]);
        for (int i = k->tip[side]; i >= 0; i = m->dof[i].lambda) {
            rbdi_span *s = &c->span[i];
            if (s->end == 0) s->first = k->row;
            if (side && s->end == k->row + k->rows) ++k->trunk;
            s->end = (int16_t)(k->row + k->rows);
        }
    }
}

/* Every dof goes behind those that are behind the dof before it. */
static void rbdi_order_dofs(const rbd_model *m, int16_t *order) {
    for (int k = 0; k < m->nv; ++k) {
        const int before = m->dof[k].lambda;
        int at = k, i;
        for (; at > 0; order[at] = order[at - 1], --at) {
            for (i = order[at - 1]; i > before; i = m->dof[i].lambda) continue;
            if (i == before) break;
        }
        order[at] = (int16_t)k;
    }
}

/* Rows from here on are those of the sorted constraints. */
static void rbdi_number_rows(rbd_constraints *c, rbd_real *K) {
    rbdi_strand *s = c->strand;
    int row = 0;
    for (rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k) {
        for (int r = 0; r < k->rows; ++r) c->at[k->row + r] = (int16_t)(row + r);
        k->row = k->low = (int16_t)row;
        k->strand = (int16_t)(s - c->strand);
        for (int r = 0; r < k->rows; r += RBDI_BATCH)
            for (int side = 0; side < 2; ++side, ++s, K += 6 * RBDI_BATCH) {
                s->K = K;
                s->row = (int16_t)(row + r);
                s->rows = (int16_t)(k->rows - r < RBDI_BATCH ? k->rows - r : RBDI_BATCH);
                s->link = k->link[side], s->meet = k->meet;
            }
        row += k->rows;
    }
    c->strands = (int)(s - c->strand);
    c->moving = 0;
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
        c->moving |= k->kd > 0 || k->kp > 0 || k->link[1] >= 0; /* else: rbdi_articulated_contact */
}

/* Whether a strand passes the joint of link i. */
static int rbdi_passes(const rbd_model *m, const rbdi_strand *s, int i) {
    return rbdi_is_between(m, s->meet, s->link, i);
}

/* Whether the same strands pass two links. */
static int rbdi_same_strands(const rbd_model *m, const rbd_constraints *c, int i, int k) {
    for (int s = 0; s < c->strands; ++s)
        if (rbdi_passes(m, &c->strand[s], i) != rbdi_passes(m, &c->strand[s], k)) return 0;
    return 1;
}

static int rbdi_is_meeting(const rbd_constraints *c, int link) {
    for (int i = 0; i < c->n; ++i)
        if (c->constraint[i].meet == link) return 1;
    return 0;
}

/* The longest piece of six, three or one dofs that begins at link i; of any number where no strand passes. */
static int rbdi_piece_dofs(const rbd_model *m, const rbd_constraints *c, int i) {
    int links = 1, passed = 0;
    if (m->link[i].kind == RBDI_BLOCK) return rbdi_link_dofs(m, &m->link[i]);
    for (int s = 0; s < c->strands; ++s) passed |= rbdi_passes(m, &c->strand[s], i);
    while ((links < 6 || !passed) && i + links < m->nl && m->link[i + links].kind != RBDI_BLOCK &&
           m->link[i + links].parent == i + links - 1 && rbdi_same_strands(m, c, i, i + links) &&
           !rbdi_is_meeting(c, i + links - 1))
        ++links;
    return links == 6 || !passed ? links : links >= 3 ? 3 : 1;
}

static void rbdi_lay_pieces(const rbd_model *m, rbd_constraints *c) {
    for (int i = 0; i < m->nl;) {
        const int dofs = rbdi_piece_dofs(m, c, i), links = m->link[i].kind == RBDI_BLOCK ? 1 : dofs;
        for (int k = 0; k < links; ++k, ++i) {
            c->piece[i].dofs = (int16_t)dofs, c->piece[i].at = (int16_t)k;
            c->piece[i].posed = 0;
        }
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

/* Whether a limb ends at link i: which only contacts with the world pass, one behind the other in their
   order, with no more rows than dofs, and which hangs on a block or on what other strands pass too. */
static int rbdi_ends_limb(const rbd_model *m, const rbd_constraints *c, int i, const int16_t *route,
                          rbdi_limb *e) {
    const int parent = m->link[i].parent, n = c->piece[i].strands;
    int dofs = 0;
    if (n == 0 || parent < 0 || (m->link[parent].kind != RBDI_BLOCK && rbdi_same_strands(m, c, i, parent)))
        return 0;
    e->link = (int16_t)parent, e->taken = 0;
    e->strand = route[0], e->end = (int16_t)(route[n - 1] + 2);
    e->row = c->strand[e->strand].row, e->rows = 0;
    for (int s = 0; s < n; ++s) {
        const rbdi_strand *on = &c->strand[route[s]], *other = &c->strand[route[s] ^ 1];
        if (route[s] != e->strand + 2 * s || on->meet >= 0 || other->link >= 0) return 0;
        for (const rbdi_limb *k = c->limb; k < e; ++k)
            if (k->strand <= route[s] && route[s] < k->end) return 0;
        e->rows = (int16_t)(e->rows + on->rows);
    }
    for (int k = i, behind = 0; k < m->nl; ++k, behind = 0) {
        for (int s = 0; s < n; ++s) behind |= rbdi_passes(m, &c->strand[route[s]], k);
        if (behind) dofs += rbdi_link_dofs(m, &m->link[k]);
    }
    return e->rows <= 6 && e->rows <= dofs && rbdi_may_eliminate_at(m, parent);
}

/* By the links that they hang on. */
static void rbdi_sort_limbs(rbdi_limb *list, int n) {
    for (int i = 1; i < n; ++i) {
        const rbdi_limb e = list[i];
        int at = i;
        for (; at > 0 && list[at - 1].link > e.link; --at) list[at] = list[at - 1];
        list[at] = e;
    }
}

/* The strands of each link; and of constraints that meet in one place the first row that any of them shares a
   link with. */
static void rbdi_lay_route(const rbd_model *m, rbd_constraints *c) {
    int16_t *route = c->route;
    rbdi_lay_pieces(m, c);
    c->posed = 0;
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
        for (int side = 0; side < 2; ++side)
            for (int i = k->link[side]; i >= 0; i = m->link[i].parent) {
                c->piece[i].posed = 1;
                if (i >= c->posed) c->posed = i + 1;
            }
    for (int i = m->nl - 1; i >= 0; --i) {
        int n = 0;
        for (int s = 0; s < c->strands; ++s)
            if (rbdi_passes(m, &c->strand[s], i)) route[n++] = (int16_t)s;
        for (int s = 1; s < n; ++s)
            for (rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
                if (k->meet == c->strand[route[s]].meet && k->low > c->strand[route[0]].row)
                    k->low = c->strand[route[0]].row;
        c->piece[i].strands = (int16_t)n;
        if (rbdi_ends_limb(m, c, i, route, &c->limb[c->limbs])) ++c->limbs;
        if (c->piece[i].at == 0) route += n;
    }
    rbdi_sort_limbs(c->limb, c->limbs);
    for (int end = c->n, first; end > 0; end = first) {
        const rbdi_rows g = rbdi_rows_between(c, first = rbdi_together(c, end), end);
        for (int k = first; k < end; ++k) c->constraint[k].low = c->constraint[k].near_low = (int16_t)g.low;
    }
    for (const rbdi_limb *e = c->limb; e < c->limb + c->limbs; ++e)
        for (rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
            if (k->row >= e->row && k->row < e->row + e->rows) k->near_low = e->row;
}

RBD_API rbd_status rbd_constraints_init(const rbd_model *m, rbd_work *w, const rbd_constraint *list, int n,
                                        void *memory, size_t size, rbd_constraints **constraints,
                                        rbd_report *report) {
    rbd_report own;
    rbd_constraints *c;
    unsigned char *p;
    rbd_real *K;
    int rows = 0, batches;
    if (!report) report = &own;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (constraints) *constraints = NULL;
    if (!m || !w || (!list && n) || !memory || !constraints)
        return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (!rbdi_fits(m, w)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (n < 0 || n > RBD_MAX_CONSTRAINTS) {
        rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);
        report->error.text = RBDI_TEXT("the number of constraints is below 0 or above RBD_MAX_CONSTRAINTS");
        return RBD_ERR_COUNT;
    }
    for (int i = 0; i < n; ++i) {
        const rbd_status status = rbdi_check_constraint(m, &list[i], i, report);
        if (status) return status;
        rows += rbdi_held_axes(&list[i]);
    }
    if (size < rbd_constraints_size(m, list, n)) return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);
    batches = rbdi_batches_of(list, n);
    p = rbdi_aligned(memory);
    c = (rbd_constraints *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_constraints)));
    for (int k = 0; k < RBDI_SHAPE; ++k) c->shape[k] = m->shape[k];
    c->w = w, c->n = n, c->rows = rows;
    c->stride = rbdi_row_stride(rows);
    c->constraint = (rbdi_constraint *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n * sizeof(rbdi_constraint)));
    c->strand = (rbdi_strand *)rbdi_take(&p, 1, RBDI_ROUND(2 * (size_t)batches * sizeof(rbdi_strand)));
    c->span = (rbdi_span *)rbdi_take(&p, 1, RBDI_ROUND((size_t)m->nv * sizeof(rbdi_span)));
    c->order = (int16_t *)rbdi_take(
        &p, 1, RBDI_ROUND(((size_t)m->nv * ((size_t)batches + 1) + (size_t)rows) * sizeof(int16_t)));
    c->at = c->order + m->nv, c->route = c->at + rows;
    c->piece = (rbdi_piece *)rbdi_take(&p, 1, RBDI_ROUND((size_t)m->nv * sizeof(rbdi_piece)));
    c->limb = (rbdi_limb *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n * sizeof(rbdi_limb)));
    c->limbs = 0;
    c->path = (int32_t *)rbdi_take(&p, 1, RBDI_ROUND((size_t)m->nv * sizeof(int32_t)));
    c->Y = (rbd_real *)rbdi_take(&p, m->nv * (int)RBDI_LARGER(c->stride, batches * RBDI_BATCH),
                                 sizeof(rbd_real));
    K = (rbd_real *)rbdi_take(&p, 12 * batches * RBDI_BATCH, sizeof(rbd_real));
    c->wrench = (rbd_real *)rbdi_take(&p, 8 * rows, sizeof(rbd_real));
    c->D = (rbd_real *)rbdi_take(&p, (int)RBDI_LARGER(rows, m->nv) * c->stride, sizeof(rbd_real));
    c->P = (rbd_real *)rbdi_take(&p, m->nv * RBDI_BATCH, sizeof(rbd_real));
    c->x = (rbd_real *)rbdi_take(&p, m->nv, sizeof(rbd_real));
    c->stack = (rbd_real *)rbdi_take(&p, m->nv, sizeof(rbd_real));
    c->before = (rbd_real *)rbdi_take(&p, m->nv, sizeof(rbd_real));
    c->D_inverse = (rbd_real *)rbdi_take(&p, m->nv, sizeof(rbd_real));
    c->b = (rbd_real *)rbdi_take(&p, 10 * c->stride, sizeof(rbd_real));
    c->lambda = c->b + c->stride, c->target = c->lambda + c->stride;
    c->u = c->target + c->stride, c->gamma = c->u + c->stride, c->e = c->gamma + c->stride;
    c->demand = c->e + c->stride, c->square = c->demand + c->stride;
    c->share = c->square + c->stride, c->chosen = c->share + c->stride;
    c->inverse = (rbd_real *)rbdi_take(&p, rows, sizeof(rbd_real));
    c->diagonal = (rbd_real *)rbdi_take(&p, rows, sizeof(rbd_real));
    rbdi_order_dofs(m, c->order);
    for (int k = 0; k < m->nv; ++k) c->span[k].first = c->span[k].end = 0;
    for (int i = 0, row = 0; i < n; row += c->constraint[i++].rows) {
        rbdi_place_constraint(m, &list[i], row, &c->constraint[i]);
        c->constraint[i].index = (int16_t)i;
    }
    rbdi_sort_constraints(c->constraint, n);
    rbdi_number_rows(c, K);
    for (int i = 0; i < n; ++i) rbdi_span_constraint(m, c, &c->constraint[i]);
    if (!m->nmimic) rbdi_lay_route(m, c);
    for (int k = 0; k < m->nv; ++k)
        c->span[k].n = (int16_t)rbdi_whole_batches(c->span[k].end - c->span[k].first);
    rbdi_clear(c->b, 10 * c->stride);
    c->used = 1, c->infeasible = -1;
    c->factored = m->nmimic > 0;
    for (int i = 0; i < n; ++i) c->factored |= !rbdi_may_eliminate_at(m, c->constraint[i].meet);
    rbdi_clear(c->inverse, rows);
    *constraints = c;
    return RBD_OK;
}

#endif
