#ifndef RBDI_CONSTRAINTS_ARTICULATED_H
#define RBDI_CONSTRAINTS_ARTICULATED_H
#include "dynamics/aba.h"
#include "constraints/rows.h"
#include "constraints/refinement.h"

/* ---- articulated bodies [articulated] ----
   The Popov-Vereshchagin algorithm. A unit force (moment) of a row acts on both bodies, with opposite
   signs, as wrenches K on their links. Pass 2 of [aba] has eliminated the joints; K is carried past each of
   them to the world. a' = X a_p + zeta is the acceleration of a joint's link without S qdd, zeta its velocity
   product. At each joint

       Y = S' K,   K -= U/D Y,   epsilon += Y u/D + K' zeta,   K_p = X' K

   and the acceleration along the row is K' a' + epsilon + Delta lambda, where Delta = Y' D^-1 Y of the joints
   so far. At the common ancestor of the two links the two wrenches are added. In the world a' is known, and
   [factor] gives lambda from b = target - epsilon - K' a'. Then u/D += D^-1 Y lambda, and pass 3 gives the
   accelerations. [refinement] needs the targets less all of epsilon but its terms Y u/D. */

/* K_p = X' K of a batch of rows. */
#if RBDI_BATCH > 1
#define rbdi_wrenches_to_parent rbdi_batch_up
#else
#define rbdi_wrenches_to_parent rbdi_array_up
#endif

/* K of a batch of rows, in the axes of the link that it was carried to; b = target - epsilon, and the target
   without the terms Y u/D. */
typedef struct rbdi_row_wrenches {
    rbdi_batch K[6], b, target;
} rbdi_row_wrenches;

/* K on one of the two links, of a batch of rows from row r of the constraint on; 0 if it is the world. p:
   origin of frame 1, where the forces act. With a row's axes e in link axes, of angular and linear rows:

       K = (e_angular + arm x e_linear; e_linear) */
RBDI_INLINE void rbdi_start_rows(const rbd_constraint_set *c, const rbdi_constraint *con,
                                 const rbdi_axes_held *h, rbdi_v3 p, int side, int r, rbdi_batch K[6]) {
    const int link = con->link[con->link[side] < 0 ? 1 : side];
    const rbdi_pose X = c->w->kin[link].X;
    const rbd_real sign = rbdi_set(side ? RBD_C(-1) : RBD_C(con->link[0] >= 0));
    const rbdi_v3 arm = side ? rbdi_mul(X.E, rbdi_sub(p, X.r)) : rbdi_vec_c(con->position[0]);
    const rbdi_v3 axis[3] = {rbdi_scale(sign, rbdi_vec(X.E.xx, X.E.xy, X.E.xz)),
                             rbdi_scale(sign, rbdi_vec(X.E.yx, X.E.yy, X.E.yz)),
                             rbdi_scale(sign, rbdi_vec(X.E.zx, X.E.zy, X.E.zz))};

    for (int j = 0; j < 3; ++j)
        K[3 + j] = *(const rbdi_batch *)&h->axis[3][r] * axis[j].x +
                   *(const rbdi_batch *)&h->axis[4][r] * axis[j].y +
                   *(const rbdi_batch *)&h->axis[5][r] * axis[j].z;

    K[0] = K[5] * arm.y - K[4] * arm.z;
    K[1] = K[3] * arm.z - K[5] * arm.x;
    K[2] = K[4] * arm.x - K[3] * arm.y;

    for (int j = 0; con->angular && j < 3; ++j)
        K[j] = K[j] + *(const rbdi_batch *)&h->axis[0][r] * axis[j].x +
               *(const rbdi_batch *)&h->axis[1][r] * axis[j].y +
               *(const rbdi_batch *)&h->axis[2][r] * axis[j].z;
}

/* Carries K past the joint of one-axis link i, into the parent's axes. Writes Y. */
RBDI_INLINE void rbdi_rows_axis(const rbd_model *m, const rbd_work *w, int i, int flags,
                                rbdi_row_wrenches *rows, rbdi_batch *Y) {
    const rbdi_link *l = &m->link[i];
    const rbdi_scratch *own = &w->scratch[i];
    rbdi_batch *K = rows->K, y = K[2], z = K[2], term;

    /* Y = S' K */
    if (flags & RBDI_SLIDES) y = K[2] * l->rho + K[5] * l->kappa;
    *Y = y;

    /* K -= U/D Y */
    K[0] = K[0] - y * own->U_D.n.x;
    K[1] = K[1] - y * own->U_D.n.y;
    K[2] = rbdi_all_lanes(rbdi_zero()); /* U_z/D = 1 */
    if (flags & (RBDI_SLIDES | RBDI_ARMATURE)) K[2] = z - y * own->U_D.n.z;
    K[3] = K[3] - y * own->U_D.f.x;
    K[4] = K[4] - y * own->U_D.f.y;
    K[5] = K[5] - y * own->U_D.f.z;

    /* epsilon += Y u/D + K' zeta */
    term = K[0] * own->c.omega.x + K[1] * own->c.omega.y;
    term = term + K[3] * own->c.v.x + K[4] * own->c.v.y + K[5] * own->c.v.z;
    rows->target = rows->target - term;
    rows->b = rows->b - (y * own->u_D + term);

    rbdi_wrenches_to_parent(l, flags, rbdi_trig_of(m, w, i, flags), K);
}

/* Carries K past the n dofs of a block, whose rows of Y are `stride` apart. At a free base all of K is
   eliminated: U/D has only the entries that its own dofs need. */
RBDI_INLINE void rbdi_rows_dofs(const rbdi_block_work *bw, int first, int n, int free_base,
                                rbdi_row_wrenches *rows, rbd_real *Y, int stride) {
    RBDI_UNROLL_SIX for (int d = n - 1; d >= 0; --d) {
        const rbdi_batch y = rows->K[first + d];
        const int end = free_base ? d : 6;

        *(rbdi_batch *)&Y[d * stride] = y;
        rows->b = rows->b - y * bw->u_D[d];
        RBDI_UNROLL_SIX for (int j = 0; j < end; ++j) { rows->K[j] = rows->K[j] - y * bw->U_D[d][j]; }
    }
}

/* Carries K past the joint of block i, into the parent's axes. Writes Y. */
RBDI_LOCAL rbdi_row_wrenches rbdi_rows_block(const rbd_model *m, const rbd_work *w, int i,
                                             rbdi_row_wrenches rows, rbd_real *Y, int stride) {
    const rbdi_link *l = &m->link[i];
    const rbdi_block *b = rbdi_block_of(m, l);
    const rbdi_block_work *bw = &w->block[l->block];

    if (rbdi_free_base(l, b)) {
        rbdi_rows_dofs(bw, 0, 6, 1, &rows, Y, stride);
        for (int j = 0; j < 6; ++j) rows.K[j] = rbdi_all_lanes(rbdi_zero());
    } else {
        rbd_real zeta[6];
        rbdi_store_motion(zeta, 1, w->scratch[i].c);
        rbdi_rows_dofs(bw, b->first, b->n, 0, &rows, Y, stride);

        for (int j = 0; j < 6; ++j) {
            const rbdi_batch term = rows.K[j] * zeta[j];
            rows.b = rows.b - term;
            rows.target = rows.target - term;
        }

        rbdi_crba_up_block(&bw->X, (rbd_real *)rows.K, RBDI_BATCH, RBDI_BATCH);
    }

    return rows;
}

/* Carries K from link i to its ancestor `stop`. Y: the batch in the row of dof 0. */
RBDI_LOCAL void rbdi_carry_rows(const rbd_model *m, const rbd_constraint_set *c, int i, int stop,
                                rbdi_row_wrenches *carried, rbd_real *Y) {
    rbdi_row_wrenches rows = *carried; /* in registers */
    for (; i > stop; i = m->link[i].parent) {
        const rbdi_link *l = &m->link[i];
        rbd_real *to = Y + l->iv * c->stride;
        if (rbdi_is(l, RBDI_BLOCK))
            rows = rbdi_rows_block(m, c->w, i, rows, to, c->stride);
        else
            RBDI_BY_FLAGS(const int flags, l, rbdi_rows_axis(m, c->w, i, flags, &rows, (rbdi_batch *)to));
    }
    *carried = rows;
}

/* Y, b and target of a batch of rows from row r of the constraint on. h: its axes. p: origin of frame 1. */
RBDI_LOCAL void rbdi_rows_to_world(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                   int r, const rbdi_axes_held *h, rbdi_v3 p) {
    rbd_real *Y = c->Y + con->row + r;
    rbdi_row_wrenches rows, one;
    rbdi_batch world;
    for (int j = 0; j < 6; ++j) rows.K[j] = rbdi_all_lanes(rbdi_zero());
    rows.b = rows.target = *(const rbdi_batch *)&c->target[con->row + r];

    /* from both links to their common ancestor, and on */
    for (int side = 0; side < (con->link[1] < 0 ? 1 : 2); ++side) {
        rbdi_start_rows(c, con, h, p, side, r, one.K);
        one.b = rows.b;
        one.target = rows.target;
        rbdi_carry_rows(m, c, con->link[side], con->ancestor, &one, Y);

        for (int j = 0; j < 6; ++j) rows.K[j] = rows.K[j] + one.K[j];
        rows.b = one.b;
        rows.target = one.target;
    }
    rbdi_carry_rows(m, c, con->ancestor, -1, &rows, Y);

    /* K' a' of the world */
    world = rows.K[3] * c->world.x + rows.K[4] * c->world.y + rows.K[5] * c->world.z;
    *(rbdi_batch *)&c->b[con->row + r] = rows.b - world;
    *(rbdi_batch *)&c->target[con->row + r] = rows.target - world;
}

/* 1/D of the dofs on the paths. */
RBDI_LOCAL void rbdi_path_inverse(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_mask none = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int k = 0; k < m->nv; ++k)
        if (c->span[k].end > 0) c->D_inverse[k] = rbdi_reciprocal(c->w->pivot[k], RBDI_TINY, &none);
}

/* u/D of a link's dofs. */
RBDI_INLINE rbd_real *rbdi_u_D_of(const rbd_model *m, const rbd_constraint_set *c, int link) {
    const rbdi_link *l = &m->link[link];
    return rbdi_is(l, RBDI_BLOCK) ? c->w->block[l->block].u_D : &c->w->scratch[link].u_D;
}

/* u/D += D^-1 Y lambda, refined. */
RBDI_LOCAL void rbdi_add_multipliers(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_mask lost = rbdi_less(rbdi_zero(), rbdi_zero());
    for (int at = 0; at < c->links; ++at) {
        const int link = c->link[at], first = m->link[link].iv, n = rbdi_link_dofs(m, &m->link[link]);
        rbd_real *u_D = rbdi_u_D_of(m, c, link);

        for (int t = 0; t < n; ++t) {
            lost = rbdi_or(lost, rbdi_add_force(c, c->lambda, first + t, &u_D[t]));
            c->x[first + t] = u_D[t];
        }
    }
    if (!rbdi_refine(m, c, lost)) return;
    rbdi_check_held(m, c);

    /* the refined ones */
    for (int at = 0; at < c->links; ++at) {
        const int link = c->link[at], first = m->link[link].iv, n = rbdi_link_dofs(m, &m->link[link]);
        rbd_real *u_D = rbdi_u_D_of(m, c, link);
        for (int t = 0; t < n; ++t) u_D[t] = c->x[first + t];
    }
}

/* Velocities, poses and bias wrenches of the links. Accelerations of the links are 0 here: epsilon has their
   terms of gamma. */
RBDI_LOCAL void rbdi_articulated_start(const rbd_model *m, rbd_constraint_set *c, const rbd_real *q,
                                       const rbd_real *v, rbdi_c3 gravity, int moving) {
    rbd_work *w = c->w;
    w->kinematics_of = RBDI_NO_KINEMATICS;
    c->world = rbdi_world_state(gravity).acc;

    rbdi_joints(m, w, q);
    rbdi_aba_velocities(m, w, v, 1);
    rbdi_kin_of_paths(m, c, v, moving);

    for (int i = 0; i < 2 * c->n; ++i) {
        const int link = c->constraint[i / 2].link[i % 2];
        if (link < 0) continue;

        w->kin[link].state.omega_dot = w->kin[link].state.acc = rbdi_vec0();
        if (!moving) w->kin[link].v = rbdi_vec0(); /* not used, but it must not be a NaN */
    }
}

/* Computes x and lambda from Y and b. Returns 0, x untouched, if a pivot is in doubt. */
RBDI_LOCAL int rbdi_articulated_solve(const rbd_model *m, rbd_constraint_set *c, rbd_real *x) {
    if (rbdi_any(rbdi_factor_delta(m, c))) return 0;
    c->pivoted = 0;
    c->infeasible = -1;
    rbdi_back_substitute(c);
    rbdi_add_multipliers(m, c);

    rbdi_aba_pass3(m, c->w, c->world, x);
    c->w->singular = -1;
    return 1;
}

#endif
