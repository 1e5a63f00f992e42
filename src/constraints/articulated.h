#ifndef RBDI_CONSTRAINTS_ARTICULATED_H
#define RBDI_CONSTRAINTS_ARTICULATED_H
#include "dynamics/aba.h"
#include "dynamics/packed.h"
#include "constraints/rows.h"
#include "constraints/factor.h"
#include "constraints/solution.h"

/* ---- articulated bodies [articulated] ----
   A row's unit force (moment) acts on body 1 with one sign and on body 2 with the other, as wrenches K on
   their links. Behind pass 2 of [aba], which eliminates the force of one joint after the other, K goes down
   the tree. With y = X y_p + c the acceleration of the joint's link but for S qdd, at each joint

       Y = S' K,   K -= U/D Y,   epsilon += Y u/D + K' c,   K_p = X' K

   so that the acceleration along the rows is K' y + epsilon + Delta lambda, where Delta = Y' D^-1 Y of the
   joints so far. Once both sides have come to the common ancestor of the two links, no other joint moves the
   rows against each other, and they are eliminated there, [factor]:

       W = K R^-1,   R' beta = r - epsilon,   R lambda = beta - W'y      IA += W W',   pA -= W beta

   The rows that go on lose what these take: K -= W R, and of Delta and beta by [factor]. Rows that depend on
   others would vanish, K too: for n with Delta n = 0 all Y'n = 0. They leave a pivot in doubt. In pass 3
   lambda follows from y of the common ancestor, then u/D += Y'lambda / D of the joints behind it. */

#if RBDI_BATCH > 1
#define rbdi_wrenches_up rbdi_batch_up
#else
#define rbdi_wrenches_up rbdi_array_up
#endif

/* Wrenches on the link of a side, of a constraint at the place `arm` from its origin, link axes. */
RBDI_INLINE void rbdi_start_rows(const rbd_constraint_set *c, const rbdi_constraint *k,
                                 const rbdi_axes_held *h, rbdi_v3 arm, int side) {
    const rbdi_mat E = c->w->kin[k->link[side]].X.E;
    const rbd_real sign = rbdi_set(side ? RBD_C(-1) : RBD_C(1));
    const rbdi_v3 axis[3] = {rbdi_scale(sign, rbdi_vec(E.xx, E.xy, E.xz)),
                             rbdi_scale(sign, rbdi_vec(E.yx, E.yy, E.yz)),
                             rbdi_scale(sign, rbdi_vec(E.zx, E.zy, E.zz))};
    for (int r = 0; r < k->rows; r += RBDI_BATCH) {
        rbdi_row_block *on = &c->block[k->block[side] + r / RBDI_BATCH];
        rbdi_batch *K = (rbdi_batch *)on->K;
        on->at = k->link[side];
        for (int j = 0; j < 3; ++j)
            K[3 + j] = *(const rbdi_batch *)&h->x[3][r] * axis[j].x +
                       *(const rbdi_batch *)&h->x[4][r] * axis[j].y +
                       *(const rbdi_batch *)&h->x[5][r] * axis[j].z;
        K[0] = K[5] * arm.y - K[4] * arm.z;
        K[1] = K[3] * arm.z - K[5] * arm.x;
        K[2] = K[4] * arm.x - K[3] * arm.y;
        for (int j = 0; k->angular && j < 3; ++j)
            K[j] = K[j] + *(const rbdi_batch *)&h->x[0][r] * axis[j].x +
                   *(const rbdi_batch *)&h->x[1][r] * axis[j].y +
                   *(const rbdi_batch *)&h->x[2][r] * axis[j].z;
    }
}

/* K of a row block, and its b, on the way down the tree. */
typedef struct rbdi_carried {
    rbdi_batch K[6], b;
} rbdi_carried;

/* Past the joint of one-axis link i, into the parent's axes; Y = S' K. */
RBDI_INLINE void rbdi_rows_axis(const rbd_model *m, const rbd_work *w, int i, int flags, rbdi_carried *on,
                                rbdi_batch *Y) {
    const rbdi_link *l = &m->link[i];
    const rbdi_scratch *own = &w->scratch[i];
    rbdi_batch *K = on->K, y = K[2], z = K[2], term;
    if (flags & RBDI_SLIDES) y = K[2] * l->rho + K[5] * l->kappa;
    *Y = y;
    K[0] = K[0] - y * own->U_D.n.x, K[1] = K[1] - y * own->U_D.n.y;
    K[2] = rbdi_zero_batch(); /* U_z/D = 1 */
    if (flags & (RBDI_SLIDES | RBDI_ARMATURE)) K[2] = z - y * own->U_D.n.z;
    K[3] = K[3] - y * own->U_D.f.x, K[4] = K[4] - y * own->U_D.f.y, K[5] = K[5] - y * own->U_D.f.z;
    term = y * own->u_D + K[0] * own->c.omega.x + K[1] * own->c.omega.y;
    term = term + K[3] * own->c.v.x + K[4] * own->c.v.y + K[5] * own->c.v.z;
    on->b = on->b - term;
    rbdi_wrenches_up(l, flags, rbdi_trig_of(m, w, i, flags), K);
}

/* K = X' K of a block link. */
RBDI_INLINE void rbdi_wrenches_up_block(const rbdi_pose *X, rbdi_batch K[6]) {
    const rbdi_mat E = X->E;
    const rbdi_v3 r = X->r;
    for (int j = 0; j < 6; j += 3) {
        const rbdi_batch x = K[j], y = K[j + 1], z = K[j + 2];
        K[j] = x * E.xx + y * E.yx + z * E.zx;
        K[j + 1] = x * E.xy + y * E.yy + z * E.zy;
        K[j + 2] = x * E.xz + y * E.yz + z * E.zz;
    }
    K[0] = K[0] + K[5] * r.y - K[4] * r.z;
    K[1] = K[1] + K[3] * r.z - K[5] * r.x;
    K[2] = K[2] + K[4] * r.x - K[3] * r.y;
}

/* Past the n dofs of block link i; their rows of Y are `stride` apart. Of a free base, which nothing of K
   passes, U/D has only what its dofs before d need. */
RBDI_INLINE void rbdi_rows_dofs(const rbdi_block_work *bw, int first, int n, int free_base, rbdi_carried *on,
                                rbd_real *Y, int stride) {
    RBDI_UNROLL_SIX for (int d = n - 1; d >= 0; --d) {
        const rbdi_batch y = on->K[first + d];
        const int end = free_base ? d : 6;
        *(rbdi_batch *)&Y[d * stride] = y;
        on->b = on->b - y * bw->u_D[d];
        RBDI_UNROLL_SIX for (int j = 0; j < end; ++j) { on->K[j] = on->K[j] - y * bw->U_D[d][j]; }
    }
}
static rbdi_carried rbdi_rows_block(const rbd_model *m, const rbd_work *w, int i, rbdi_carried on,
                                    rbd_real *Y, int stride) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_block_work *bw = &w->block[l->block];
    if (rbdi_free_base(l, b)) {
        rbdi_rows_dofs(bw, 0, 6, 1, &on, Y, stride);
        for (int j = 0; j < 6; ++j) on.K[j] = rbdi_zero_batch();
    } else {
        rbd_real C[6];
        rbdi_motion_to_array(w->scratch[i].c, C);
        rbdi_rows_dofs(bw, b->first, b->n, 0, &on, Y, stride);
        for (int j = 0; j < 6; ++j) on.b = on.b - on.K[j] * C[j];
        rbdi_wrenches_up_block(&bw->X, on.K);
    }
    return on;
}

/* A row block goes down the tree to link `stop`, if it is on the way; -1: to the world, which accelerates. */
static void rbdi_rows_to(const rbd_model *m, rbd_constraint_set *c, rbdi_row_block *block, int stop) {
    const int stride = c->stride;
    rbd_real *to = c->Y + block->row;
    rbdi_carried on;
    int i = block->at;
    if (i <= stop) return;
    RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) { on.K[j] = ((const rbdi_batch *)block->K)[j]; }
    on.b = *(const rbdi_batch *)&c->b[block->row];
    for (; i > stop; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        rbd_real *Y = to + l->iv * stride;
        if (l->kind == RBDI_BLOCK)
            on = rbdi_rows_block(m, c->w, i, on, Y, stride);
        else
            RBDI_BY_FLAGS(flags, l, rbdi_rows_axis(m, c->w, i, flags, &on, (rbdi_batch *)Y));
    }
    if (i < 0) on.b = on.b - on.K[3] * c->world.x - on.K[4] * c->world.y - on.K[5] * c->world.z;
    RBDI_UNROLL_SIX for (int j = 0; j < 6; ++j) { ((rbdi_batch *)block->K)[j] = on.K[j]; }
    *(rbdi_batch *)&c->b[block->row] = on.b;
    block->at = (int16_t)i;
}

/* 1/D of the links on a path from `first` on, of those before number `at`. Returns how many are left. */
static int rbdi_path_inverse(const rbd_model *m, rbd_constraint_set *c, int at, int first) {
    rbdi_mask none = rbdi_less(c->give, c->give);
    rbd_real give = c->give;
    for (; at > 0 && c->link[at - 1] >= first; --at) {
        const rbdi_link *l = &m->link[c->link[at - 1]];
        for (int k = l->iv, end = k + rbdi_link_dofs(m, l); k < end; ++k) {
            const rbd_real inverse = rbdi_reciprocal(c->w->pivot[k], RBDI_TINY, &none);
            c->D_inverse[k] = inverse;
            give = give + inverse;
        }
    }
    c->give = give;
    return at;
}

/* W = K R^-1 of the rows first .. end - 1, which the blocks from `on` on carry, before `stop`. */
static void rbdi_scaled_wrenches(const rbd_constraint_set *c, int first, int end, const rbdi_row_block *on,
                                 const rbdi_row_block *stop) {
    rbdi_clear(&c->W[6 * first], 6 * (end - first));
    for (; on < stop; ++on)
        for (int r = 0; r < on->rows; ++r)
            for (int j = 0; j < 6; ++j) {
                rbd_real *w = &c->W[6 * (on->row + r) + j];
                *w = *w + on->K[j * RBDI_BATCH + r];
            }
    for (int t = first; t < end; ++t) {
        rbd_real *w = &c->W[6 * t];
        for (int s = first; s < t; ++s) rbdi_subtract(w, c->R[s * c->stride + t], &c->W[6 * s], 6);
        rbdi_multiply(w, c->inverse[t], 6);
    }
}

/* Eliminates the rows of the constraints first .. end - 1 on their common ancestor. IA and pA: what it feels
   of its children. */
static rbdi_mask rbdi_eliminate(rbd_constraint_set *c, int first, int end, rbdi_abi *IA, rbdi_force *pA) {
    const rbdi_constraint *k = &c->constraint[first], *last = &c->constraint[end - 1];
    const int low = k->row, high = last->row + last->rows;
    rbdi_row_block *own = &c->block[k->block[0]], *stop = c->block + c->blocks,
                   *others = end < c->n ? &c->block[last[1].block[0]] : stop;
    rbdi_mask doubt = rbdi_less(c->give, c->give);
    rbd_real A[6][6], P[6];
    for (; k <= last; ++k) doubt = rbdi_or(doubt, rbdi_factor_rows(c, k, 0));
    rbdi_scaled_wrenches(c, low, high, own, others);
    rbdi_abi_to_array(*IA, A);
    rbdi_store_force(P, 1, *pA);
    for (int t = low; t < high; ++t) {
        const rbd_real *w = &c->W[6 * t];
        RBDI_UNROLL_SIX for (int i = 0; i < 6; ++i) {
            P[i] = P[i] - w[i] * c->R[t * c->stride + c->rows];
            RBDI_UNROLL_SIX for (int j = i; j < 6; ++j)
                A[i][j] = A[i][j] + w[i] * w[j];
        }
    }
    *IA = rbdi_abi_from_array(A);
    *pA = rbdi_load_force(P, 1);
    for (rbdi_row_block *on = others; on < stop; ++on)
        for (int r = 0; on->at == last->ancestor && r < on->rows; ++r)
            for (int t = low; t < high; ++t)
                for (int j = 0; j < 6; ++j) {
                    rbd_real *to = &on->K[j * RBDI_BATCH + r];
                    *to = *to - c->R[t * c->stride + on->row + r] * c->W[6 * t + j];
                }
    return doubt;
}

/* Pass 2 where it has come to: IA and pA that link number `link` - 1 feels of its children; `at`: so many of
   the links on a path are left. */
typedef struct rbdi_progress {
    rbdi_abi IA;
    rbdi_force pA;
    rbdi_mask doubt;
    int link, at;
} rbdi_progress;

/* Pass 2 of the links behind `stop`. */
static void rbdi_articulate_links(const rbd_model *m, rbd_work *w, const rbd_real *tau, int stop,
                                  rbdi_progress *p) {
    rbdi_aba_pass2_links(m, w, tau, stop + 1, p->link, &p->IA, &p->pA, &p->doubt);
    p->link = stop + 1;
}

/* The row blocks from number `first` on go down to link `stop`. */
static void rbdi_rows_down(const rbd_model *m, rbd_constraint_set *c, int stop, int first, rbdi_progress *p) {
    p->at = rbdi_path_inverse(m, c, p->at, stop + 1);
    for (int s = first; s < c->blocks; ++s) rbdi_rows_to(m, c, &c->block[s], stop);
}

/* Pass 2 with the rows, and the factor of those that are eliminated in the world. Returns whether a pivot of
   a joint or a row is in doubt. */
static rbdi_mask rbdi_articulate_up(const rbd_model *m, rbd_constraint_set *c, const rbd_real *tau) {
    int first = 0;
    rbdi_progress p;
    p.IA = rbdi_abi_zero(), p.pA = rbdi_force0(), p.doubt = rbdi_less(rbdi_zero(), rbdi_zero());
    p.link = m->nl, p.at = c->links;
    for (int end; first < c->n && c->constraint[first].ancestor >= 0; first = end) {
        const rbdi_constraint *k = &c->constraint[first];
        for (end = first; end < c->n && c->constraint[end].ancestor == k->ancestor;) ++end;
        rbdi_articulate_links(m, c->w, tau, k->ancestor, &p);
        rbdi_rows_down(m, c, k->ancestor, k->block[0], &p);
        p.doubt = rbdi_or(p.doubt, rbdi_eliminate(c, first, end, &p.IA, &p.pA));
    }
    rbdi_articulate_links(m, c->w, tau, -1, &p);
    rbdi_rows_down(m, c, -1, first < c->n ? c->constraint[first].block[0] : c->blocks, &p);
    for (; first < c->n; ++first) p.doubt = rbdi_or(p.doubt, rbdi_factor_rows(c, &c->constraint[first], 0));
    return p.doubt;
}

/* u/D of the links on a path before link `end`, from number `at` on, once lambda of the rows that pass them
   is known. Returns the number of the next. */
static int rbdi_push_links(const rbd_model *m, rbd_constraint_set *c, int at, int end) {
    for (; at < c->links && c->link[at] < end; ++at) {
        const rbdi_link *l = &m->link[c->link[at]];
        const int block = l->kind == RBDI_BLOCK, n = rbdi_link_dofs(m, l);
        rbd_real *u_D = block ? c->w->block[l->block].u_D : &c->w->scratch[c->link[at]].u_D;
        for (int t = 0; t < n; ++t) u_D[t] = u_D[t] + rbdi_rows_push(c, l->iv + t, c->passed[l->iv + t]);
    }
    return at;
}

/* lambda of the constraints first .. end - 1 from y, the acceleration of their common ancestor. */
static void rbdi_solve_group(rbd_constraint_set *c, int first, int end, const rbdi_motion *y) {
    const rbdi_constraint *k = &c->constraint[end - 1];
    rbd_real Y[6];
    rbdi_motion_to_array(*y, Y);
    for (int t = c->constraint[first].row; k->ancestor >= 0 && t < k->row + k->rows; ++t)
        for (int j = 0; j < 6; ++j) {
            rbd_real *beta = &c->R[t * c->stride + c->rows];
            *beta = *beta - c->W[6 * t + j] * Y[j];
        }
    for (; k >= c->constraint + first; --k) rbdi_back_substitute(c, k->row, k->row + k->rows, k->end);
}

/* Pass 3, and lambda. */
static void rbdi_articulate_down(const rbd_model *m, rbd_constraint_set *c, rbd_real *x) {
    rbdi_motion world = rbdi_motion0(), y;
    world.v = c->world;
    y = world;
    for (int link = 0, end = c->n, at = 0;;) {
        int first = end, last;
        while (first > 0 && c->constraint[first - 1].ancestor == link - 1) --first;
        if (first < end) rbdi_solve_group(c, first, end, &y);
        last = first > 0 ? c->constraint[first - 1].ancestor : m->nl - 1;
        at = rbdi_push_links(m, c, at, last + 1);
        y = rbdi_aba_pass3_links(m, c->w, link, last + 1, world, y, x);
        if (first == 0) return;
        link = last + 1, end = first;
    }
}

/* x and lambda from the joints' torques, bias wrenches and target. Returns 0, x unknown, if a pivot of a
   joint or a row is in doubt. */
static int rbdi_articulated_solve(const rbd_model *m, rbd_constraint_set *c, const rbd_real *tau,
                                  rbd_real *x) {
    c->give = rbdi_zero();
    rbdi_clear(c->lambda, c->stride);
    if (c->dirty) rbdi_clear_rows(m, c);
    c->dirty = 0;
    for (int r = 0; r < c->rows; r += RBDI_BATCH)
        *(rbdi_batch *)&c->b[r] = *(const rbdi_batch *)&c->target[r];
    if (rbdi_any(rbdi_articulate_up(m, c, tau))) return 0;
    rbdi_articulate_down(m, c, x);
    c->infeasible = c->w->singular = -1;
    return 1;
}

/* Velocities, poses and bias wrenches of the links; gamma, J v and e start at 0. */
static void rbdi_articulated_start(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                   const rbd_real *v, rbdi_c3 gravity, int moving) {
    rbd_work *w = c->w;
    w->have_kinematics = 0;
    c->world = rbdi_world_state(gravity).acc;
    rbdi_joints(m, w, q);
    rbdi_aba_velocities(m, w, v, 1);
    rbdi_kin_of_paths(m, c, v, moving);
    c->levers = rbdi_set(RBD_C(1));
    rbdi_clear(c->u, 3 * c->stride); /* gamma and e too */
}

/* gamma of a constraint, without omega_dot and acc of its links; want: also J v, e. Its row blocks begin. */
static void rbdi_articulated_rows(rbd_constraint_set *c, const rbdi_constraint *k, int want) {
    rbdi_axes_held h;
    rbdi_v3 p;
    rbdi_add_levers(c, k);
    for (int side = 0; side < 2; ++side)
        if (k->link[side] >= 0) {
            rbdi_state *s = &c->w->kin[k->link[side]].state;
            s->omega_dot = s->acc = rbdi_vec0();
            if (!c->moving && !want) c->w->kin[k->link[side]].v = rbdi_vec0(); /* not computed, not used */
        }
    rbdi_set_axes(c, k, &h);
    p = rbdi_constraint_motion(c, k, &h, want, 1);
    if (k->link[0] >= 0) rbdi_start_rows(c, k, &h, rbdi_vec_c(k->p[0]), 0);
    if (k->link[1] >= 0) {
        const rbdi_kin *kin = &c->w->kin[k->link[1]];
        rbdi_start_rows(c, k, &h, rbdi_mul(kin->X.E, rbdi_sub(p, kin->X.r)), 1);
    }
}

#endif
