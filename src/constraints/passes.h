#ifndef RBDI_CONSTRAINTS_PASSES_H
#define RBDI_CONSTRAINTS_PASSES_H
#include "constraints/rows.h"
#include "constraints/articulated.h"
#include "constraints/limbs.h"

/* ---- passes [passes] ---- */

/* lambda of rows whose sides meet on a link, from its acceleration. */
static void rbdi_solve_between(rbd_constraints *c, int first, int end, const rbd_real Y[6]) {
    const rbdi_rows g = rbdi_rows_between(c, first, end);
    for (int r = g.first; r < g.end; ++r)
        for (int j = 0; j < 6; ++j) c->b[r] = c->b[r] - c->wrench[8 * r + j] * Y[j];
    rbdi_lambda_solve(c, g);
}

/* Before other rows are eliminated: those that limbs have taken have nothing to do with them. */
static void rbdi_skip_limbs(rbd_constraints *c) {
    for (const rbdi_limb *e = c->limb; e < c->limb + c->limbs; ++e)
        for (int r = e->row; e->taken && r < e->row + e->rows; ++r) {
            rbdi_clear(&c->D[r * c->stride], r);
            c->D[r * c->stride + r] = rbdi_set(RBD_C(1));
            c->b[r] = rbdi_zero();
        }
}

/* As rbdi_eliminate, of the rows that meet in the world, which accelerates as c->world says. */
static void rbdi_eliminate_at_world(rbd_constraints *c, int end, rbdi_mask *doubt) {
    const rbdi_v3 g = c->world;
    const rbdi_strand *stop = c->strand + (end < c->n ? c->constraint[end].strand : c->strands);
    int open = 0;
    for (const rbdi_strand *s = c->strand; s < stop; ++s) open |= s->open && s->link >= 0;
    if (!open) return;
    rbdi_skip_limbs(c);
    for (const rbdi_strand *s = c->strand; s < stop; ++s) {
        const rbdi_batch *K = (const rbdi_batch *)s->K;
        rbdi_batch *b = (rbdi_batch *)&c->b[s->row];
        if (s->link >= 0) *b = *b - K[3] * g.x - K[4] * g.y - K[5] * g.z;
    }
    rbdi_lambda_factor(c, rbdi_rows_between(c, 0, end), doubt);
    rbdi_lambda_solve(c, rbdi_rows_between(c, 0, end));
}

/* Of the constraints before `end` the first that meets where the last does: they are eliminated together. */
static int rbdi_together(const rbd_constraints *c, int end) {
    int first = end - 1;
    while (first > 0 && c->constraint[first - 1].meet == c->constraint[end - 1].meet) --first;
    return first;
}

/* Where the constraints before `end` that meet last do, -1: in the world, or none. */
static int rbdi_meeting(const rbd_constraints *c, int end) {
    return end > 0 ? c->constraint[end - 1].meet : -1;
}

/* Pass 2 of links between two places where rows are eliminated. */
RBDI_PART rbdi_mask rbdi_articulate_links(const rbd_model *m, rbd_work *w, const rbd_real *tau, int first,
                                          int end, rbdi_abi *IA, rbdi_force *pA, rbdi_mask doubt) {
    rbdi_aba_pass2_links(m, w, tau, first, end, IA, pA, &doubt);
    return doubt;
}

/* The same with their strands. */
RBDI_INLINE rbdi_mask rbdi_articulate_part(const rbd_model *m, rbd_constraints *c, const rbd_real *tau,
                                           int first, int end, rbdi_cursor *at, rbdi_abi *IA, rbdi_force *pA,
                                           rbdi_mask doubt) {
    if (end > first) doubt = rbdi_articulate_links(m, c->w, tau, first, end, IA, pA, doubt);
    while (end > first) {
        end -= c->piece[end - 1].at + 1;
        rbdi_piece_up(m, c, end, at);
    }
    return doubt;
}

/* Pass 2 with the strands, and lambda of what meets in the world. */
static rbdi_mask rbdi_articulate_up(const rbd_model *m, rbd_constraints *c, const rbd_real *tau,
                                    rbdi_cursor *at) {
    rbdi_abi IA = rbdi_abi_zero();
    rbdi_force pA = rbdi_force0();
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    int link = m->nl, end = c->n, limbs = c->limbs;
    for (;;) {
        const int meet = rbdi_meeting(c, end), hang = limbs > 0 ? c->limb[limbs - 1].link : -1,
                  stop = meet > hang ? meet : hang;
        doubt = rbdi_articulate_part(m, c, tau, stop + 1, link, at, &IA, &pA, doubt);
        link = stop + 1;
        if (stop < 0) break;
        if (hang == stop) {
            const int first = rbdi_limbs_together(c, limbs);
            rbdi_take_limbs(m, c, first, limbs, &IA, &pA);
            limbs = first;
        }
        if (meet == stop) {
            const int first = rbdi_together(c, end);
            rbdi_eliminate(c, first, end, at, &IA, &pA, &doubt);
            end = first;
        }
    }
    rbdi_eliminate_at_world(c, end, &doubt);
    return doubt;
}

/* Pass 3, and lambda of what meets on links. */
static void rbdi_articulate_down(const rbd_model *m, rbd_constraints *c, rbdi_cursor *at, rbd_real *x) {
    rbdi_motion world = rbdi_motion0(), y;
    rbd_real Y[6];
    int link = 0, first = 0, limb = 0;
    world.v = c->world;
    y = world;
    rbdi_motion_to_array(y, Y);
    while (first < c->n && c->constraint[first].meet < 0) ++first;
    for (;;) {
        const int met = first < c->n ? c->constraint[first].meet : m->nl - 1,
                  hung = limb < c->limbs ? c->limb[limb].link : m->nl - 1, last = hung < met ? hung : met;
        int end = first;
        rbdi_strands_down(m, c, link, last + 1, at);
        y = rbdi_aba_pass3_links(m, c->w, link, last + 1, world, y, x);
        link = last + 1;
        if (link == m->nl) break;
        rbdi_motion_to_array(y, Y);
        for (; limb < c->limbs && c->limb[limb].link == last; ++limb) rbdi_solve_limb(c, &c->limb[limb], Y);
        while (end < c->n && c->constraint[end].meet == last) ++end;
        if (end > first) rbdi_solve_between(c, first, end, Y);
        first = end;
    }
}

/* Rows of Lambda, of constraint k, from the first column that they know to the diagonal; of a limb, if it
   takes them. */
RBDI_INLINE void rbdi_clear_lambda(const rbd_constraints *c, const rbdi_constraint *k) {
    const rbdi_batch zero = rbdi_zero_batch();
    const int stride = c->stride, n = k->row + k->rows - k->near_low;
    rbd_real *D = &c->D[k->row * stride + k->near_low];
    for (int r = k->rows; r > 0; --r, D += stride)
        for (int j = 0; j < n; j += RBDI_BATCH) *(rbdi_batch *)&D[j] = zero;
}

/* x and lambda from the joints' torques, bias wrenches and b = target. Returns 0, x unknown, if a pivot of a
   joint or a row is in doubt. */
static int rbdi_articulated_solve(const rbd_model *m, rbd_constraints *c, const rbd_real *tau, rbd_real *x) {
    rbdi_cursor at;
    rbdi_mask doubt;
    at.route = c->route, at.Y = c->Y;
    c->give = rbdi_zero();
    rbdi_clear(c->diagonal, c->rows);
    rbdi_clear(c->lambda, c->stride);
    for (int s = 0; s < c->strands; ++s) c->strand[s].open = 1;
    if (c->used) rbdi_clear(c->D, c->rows * c->stride);
    for (const rbdi_constraint *k = c->constraint; !c->used && k < c->constraint + c->n; ++k)
        rbdi_clear_lambda(c, k);
    c->used = 0;
    for (int r = 0; r < c->rows; r += RBDI_BATCH)
        *(rbdi_batch *)&c->b[r] = *(const rbdi_batch *)&c->target[r];
    doubt = rbdi_articulate_up(m, c, tau, &at);
    if (rbdi_any(doubt)) return 0;
    rbdi_articulate_down(m, c, &at, x);
    c->infeasible = c->w->singular = -1;
    return 1;
}

/* Velocities, poses and bias wrenches of the links, and what starts from rows: wrenches, gamma, J v. */
static void rbdi_articulated_start(const rbd_model *m, rbd_constraints *c, const rbd_real *q,
                                   const rbd_real *v, rbdi_c3 gravity, int moving) {
    rbd_work *w = c->w;
    w->have_kinematics = 0;
    c->world = rbdi_world_state(gravity).acc;
    rbdi_joints(m, w, q);
    rbdi_aba_velocities(m, w, v, 1);
    rbdi_kin_of_paths(m, c, v, moving, 0);
    c->levers = rbdi_set(RBD_C(1));
    rbdi_clear(c->u, 3 * c->stride); /* gamma and e too */
}

/* What is left of a contact with the world without stabilisation: gamma, in the link's axes. */
static void rbdi_articulated_contact(rbd_constraints *c, const rbdi_constraint *k, const rbdi_axes_held *h) {
    const rbdi_v3 arm = rbdi_vec_c(k->p[0]), omega = c->w->kin[k->link[0]].state.omega,
                  acc = rbdi_cross(omega, rbdi_cross(omega, arm)), g = c->world;
    rbdi_start_strand(c, k, h, arm, 0);
    for (int r = 0; r < k->rows; r += RBDI_BATCH) {
        const rbdi_batch *K = (const rbdi_batch *)c->strand[k->strand + 2 * (r / RBDI_BATCH)].K,
                         *e = (const rbdi_batch *)&h->x[3][r];
        rbdi_batch *gamma = (rbdi_batch *)&c->gamma[k->row + r], sum = K[3] * acc.x + K[4] * acc.y;
        sum = sum + K[5] * acc.z - *e * g.x;
        e = (const rbdi_batch *)&h->x[4][r], sum = sum - *e * g.y;
        e = (const rbdi_batch *)&h->x[5][r], sum = sum - *e * g.z;
        *gamma = *gamma + sum;
    }
}

/* gamma of a constraint, links steady, and what else is wanted; its strands begin. */
static void rbdi_articulated_rows(rbd_constraints *c, const rbdi_constraint *k, int want) {
    rbdi_axes_held h;
    rbdi_v3 p;
    rbdi_add_levers(c, k);
    for (int side = 0; side < 2; ++side)
        if (k->link[side] >= 0) {
            rbdi_state *s = &c->w->kin[k->link[side]].state;
            s->omega_dot = s->acc = rbdi_vec0();
        }
    rbdi_set_axes(c, k, &h);
    if (k->link[1] < 0 && !want) {
        if (!c->moving) c->w->kin[k->link[0]].v = rbdi_vec0(); /* unknown, and nothing depends on it */
        rbdi_articulated_contact(c, k, &h);
        return;
    }
    p = rbdi_constraint_motion(c, k, &h, want, 1);
    if (k->link[0] >= 0) rbdi_start_strand(c, k, &h, rbdi_vec_c(k->p[0]), 0);
    if (k->link[1] >= 0) {
        const rbdi_kin *kin = &c->w->kin[k->link[1]];
        rbdi_start_strand(c, k, &h, rbdi_mul(kin->X.E, rbdi_sub(p, kin->X.r)), 1);
    }
}

#endif
