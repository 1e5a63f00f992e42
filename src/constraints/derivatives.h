#ifndef RBDI_CONSTRAINTS_DERIVATIVES_H
#define RBDI_CONSTRAINTS_DERIVATIVES_H
#include "motion/points.h"
#include "derivatives/memory.h"
#include "derivatives/steps.h"
#include "api/constrained_derivatives.h"
#include "constraints/calls.h"

/* Interface: rbdi_change, rbdi_change_forces, rbdi_change_of, rbdi_error_turn, rbdi_pair_motion,
   rbdi_pair_motion_of */

/* ---- derivatives [derivatives code] ----
   Where x is a component of q, v or tau,

       M da/dx = J' dlambda/dx - rho,     rho = d(ID - J' lambda)/dx at fixed a and lambda
       J da/dx = -sigma,                  sigma = d(J a + gamma + kd J v + kp e)/dx at fixed a

   so that with T = M^-1 J'    Delta dlambda/dx = T' rho - sigma,   da/dx = -M^-1 rho + T dlambda/dx. By tau,
   rho = -1 and sigma = 0. rbd_id_derivatives gives d ID. The rest depends only on the relative motion of the
   two bodies, so only on dofs that move one of them. All quantities are in world axes, at the origin p of
   frame 1: motions of the link-fixed point there. For such a dof k, which moves body b, S = (z; s), negated
   if b is body 2; P is its joint's parent; x between spatial vectors is the spatial cross product, A a
   spatial acceleration:

       Psi = V_P x S    Phi = A_P x S + V_P x Psi    U = Psi + V_link x S
       d(w; u) = (z x omega_b + Psi_omega; z x v_b + Psi_v - omega_2 x s)                           by q
       d(angular) = z x alpha_b + Psi_omega x omega_b + Phi_omega - omega_2 x dw                    by q
       d(linear) = z x acc_b + 2 Psi_omega x v_b + Phi_v - alpha_2 x s - omega_2 x (omega_2 x s)
                   - 2 omega_2 x du                                                                 by q
       d(angular; linear) = (U_omega + z x omega_b - omega_2 x z; U_v + 2 z x v_b - 2 omega_2 x s)  by v

   where (w; u) is the velocity of body 1 relative to body 2 and (angular; linear) its rate. If b is body 2,
   the axes turn with it, which adds z x (w; u), (dw x w + z x angular; 2 dw x u + z x linear) with dw from
   above, and by v (z x w; 2 z x u). With m and f the moment and force of lambda, and S_i that of another such
   dof, J' lambda has

       d(S_i . (m; f)) = S_i . (m x z; f x z)   if b is body 1 and k moves i, or b is body 2 and it does not
                         S_i . (s x f; 0)       else

   Checked against finite differences in tests/test_constraints.c. */

/* Relative motion of the two bodies of a constraint, and their force. */
typedef struct rbdi_pair_motion {
    rbdi_station body[2];
    rbdi_v3 w, u, angular, linear, m, f;
    rbdi_axes_held h;
    rbdi_v3 turn;    /* log R, world axes */
    rbdi_v3 free[2]; /* the free axis if two angular ones are held: of frame 2, of frame 1 */
    rbd_real bend;   /* factor of turn x (turn x .) in the derivative of log R */
    rbdi_v3 rolls;   /* p moves over body 1, of balls in contact: by z x rolls, z the relative turn */
} rbdi_pair_motion;

/* S of a dof, and the derivatives by it: of (w; u) by q, of (angular; linear) by q and by v. */
typedef struct rbdi_change {
    rbdi_motion S, velocity, by_q, by_v;
} rbdi_change;

RBDI_INLINE rbdi_motion rbdi_motion_cross(rbdi_motion V, rbdi_motion S) {
    rbdi_motion C;
    C.omega = rbdi_cross(V.omega, S.omega);
    C.v = rbdi_add(rbdi_cross(V.omega, S.v), rbdi_cross(V.v, S.omega));
    return C;
}

/* c + a x b */
RBDI_INLINE rbdi_v3 rbdi_cross_add(rbdi_v3 c, rbdi_v3 a, rbdi_v3 b) { return rbdi_add(c, rbdi_cross(a, b)); }
RBDI_INLINE rbdi_v3 rbdi_cross_sub(rbdi_v3 c, rbdi_v3 a, rbdi_v3 b) { return rbdi_add(c, rbdi_cross(b, a)); }
RBDI_INLINE rbdi_v3 rbdi_twice(rbdi_v3 a) { return rbdi_add(a, a); }

static rbdi_pair_motion rbdi_pair_motion_of(const rbd_constraint_set *c, const rbdi_constraint *k) {
    rbdi_pair_motion x;
    const rbdi_station one = rbdi_station_of(c, k, 0), two = rbdi_station_at(c, k->link[1], one.p);
    x.body[0] = one, x.body[1] = two;
    x.w = rbdi_sub(one.omega, two.omega), x.u = rbdi_sub(one.v, two.v);
    x.angular = rbdi_cross_sub(rbdi_sub(one.omega_dot, two.omega_dot), two.omega, x.w);
    x.linear = rbdi_cross_sub(rbdi_sub(one.acc, two.acc), two.omega, rbdi_twice(x.u));
    rbdi_set_axes(c, k, &x.h);
    x.m = x.f = rbdi_vec0();
    for (int r = 0; r < k->rows; ++r) {
        const int angular = r < k->angular, i = angular ? 0 : 3;
        const rbdi_v3 e = rbdi_vec(x.h.x[i][r], x.h.x[i + 1][r], x.h.x[i + 2][r]);
        rbdi_v3 *to = angular ? &x.m : &x.f;
        *to = rbdi_add(*to, rbdi_scale(c->lambda[k->row + r], e));
    }
    x.turn = x.free[0] = x.free[1] = x.rolls = rbdi_vec0(), x.bend = rbdi_zero();
    if (k->kp > 0 && k->angular) {
        const rbdi_mat R_1 = rbdi_station_axes(c, k, 0), R_2 = rbdi_station_axes(c, k, 1);
        const int i = k->angular == 2 ? 3 - k->axis[0] - k->axis[1] : 0;
        rbd_real tails[7], axis[3] = {rbdi_zero(), rbdi_zero(), rbdi_zero()};
        x.turn = rbdi_log_rotation(rbdi_mul_mat(rbdi_transpose(R_2), R_1));
        rbdi_tails(x.turn, tails);
        x.turn = rbdi_mul(R_2, x.turn);
        x.bend = rbdi_ad_function_of(RBDI_J_R_INVERSE, tails).c;
        axis[i] = rbdi_set(RBD_C(1));
        x.free[0] = rbdi_mul(R_2, rbdi_load_vec(axis, 1));
        x.free[1] = rbdi_mul(R_1, rbdi_load_vec(axis, 1));
    }
    return x;
}

/* By dof j of a link on the path of body `side`. */
static rbdi_change rbdi_change_of(const rbd_model *m, const rbd_constraint_set *c, const rbdi_pair_motion *x,
                                  int side, int link, int j) {
    const rbdi_station *b = &x->body[side], P = rbdi_station_at(c, m->link[link].parent, b->p),
                       own = rbdi_station_at(c, link, b->p);
    const rbd_real ratio = rbdi_ratio(m, m->link[link].iv + j), scale = side ? -ratio : ratio;
    const rbdi_v3 w2 = x->body[1].omega;
    rbdi_motion V, A, Psi, Phi, U;
    rbdi_change d;
    rbdi_v3 z, s, ws;
    d.S = rbdi_column(m, c->w, link, j, b->p);
    z = d.S.omega = rbdi_scale(scale, d.S.omega), s = d.S.v = rbdi_scale(scale, d.S.v);
    V.omega = own.omega, V.v = own.v;
    U = rbdi_motion_cross(V, d.S);
    V.omega = P.omega, V.v = P.v;
    A.omega = P.omega_dot, A.v = rbdi_cross_sub(P.acc, P.omega, P.v);
    Psi = rbdi_motion_cross(V, d.S);
    Phi = rbdi_motion_add(rbdi_motion_cross(A, d.S), rbdi_motion_cross(V, Psi));
    U = rbdi_motion_add(U, Psi);
    ws = rbdi_cross(w2, s);
    d.velocity.omega = rbdi_cross_add(Psi.omega, z, b->omega);
    d.velocity.v = rbdi_sub(rbdi_cross_add(Psi.v, z, b->v), ws);
    d.by_q.omega = rbdi_cross_add(rbdi_cross_add(Phi.omega, z, b->omega_dot), Psi.omega, b->omega);
    d.by_q.omega = rbdi_cross_sub(d.by_q.omega, w2, d.velocity.omega);
    d.by_q.v = rbdi_cross_add(rbdi_cross_add(Phi.v, z, b->acc), rbdi_twice(Psi.omega), b->v);
    d.by_q.v = rbdi_cross_sub(rbdi_cross_sub(d.by_q.v, x->body[1].omega_dot, s), w2, ws);
    d.by_q.v = rbdi_cross_sub(d.by_q.v, w2, rbdi_twice(d.velocity.v));
    d.by_v.omega = rbdi_cross_sub(rbdi_cross_add(U.omega, z, b->omega), w2, z);
    d.by_v.v = rbdi_sub(rbdi_cross_add(U.v, z, rbdi_twice(b->v)), rbdi_twice(ws));
    if (side) {
        d.by_q.omega = rbdi_cross_add(rbdi_cross_add(d.by_q.omega, d.velocity.omega, x->w), z, x->angular);
        d.by_q.v = rbdi_cross_add(rbdi_cross_add(d.by_q.v, d.velocity.omega, rbdi_twice(x->u)), z, x->linear);
        d.velocity.omega = rbdi_cross_add(d.velocity.omega, z, x->w);
        d.velocity.v = rbdi_cross_add(d.velocity.v, z, x->u);
        d.by_v.omega = rbdi_cross_add(d.by_v.omega, z, x->w);
        d.by_v.v = rbdi_cross_add(d.by_v.v, z, rbdi_twice(x->u));
    }
    d.velocity.v = rbdi_cross_add(d.velocity.v, x->w, rbdi_cross(z, x->rolls));
    return d;
}

/* Derivative of the angular part of e, world axes, by a dof that turns body 1 by z relative to body 2. */
static rbdi_v3 rbdi_error_turn(const rbdi_constraint *k, const rbdi_pair_motion *x, rbdi_v3 z) {
    const rbdi_v3 bent = rbdi_cross(x->turn, z), more = rbdi_scale(x->bend, rbdi_cross(x->turn, bent));
    if (k->angular == 2) return rbdi_cross(x->free[0], rbdi_cross(z, x->free[1]));
    return rbdi_add(rbdi_add(z, rbdi_scale(rbdi_set(RBD_C(-0.5)), bent)), more);
}

/* Adds a dof's column of sigma. */
static void rbdi_put_sigma(const rbdi_constraint *k, const rbdi_pair_motion *x, const rbdi_change *d, int nv,
                           rbd_real *by_q, rbd_real *by_v) {
    rbd_real sum[2][RBDI_SIX_ROWS], also[RBDI_SIX_ROWS];
    rbdi_clear(sum[0], 2 * RBDI_SIX_ROWS);
    rbdi_add_held(k, &x->h, d->by_q.omega, d->by_q.v, sum[0]);
    rbdi_add_held(k, &x->h, d->by_v.omega, d->by_v.v, sum[1]);
    for (int part = 0; part < 3; ++part) { /* J v by q, by v; e by q */
        rbdi_v3 turn = part == 0 ? d->velocity.omega : d->S.omega;
        const rbd_const gain = part < 2 ? k->kd : k->kp;
        if (!(gain > 0)) continue;
        if (part == 2) turn = rbdi_error_turn(k, x, turn);
        rbdi_clear(also, RBDI_SIX_ROWS);
        rbdi_add_held(k, &x->h, turn, part == 0 ? d->velocity.v : d->S.v, also);
        for (int r = 0; r < k->rows; ++r) sum[part == 1][r] = sum[part == 1][r] + also[r] * gain;
    }
    for (int r = 0; r < k->rows; ++r) {
        if (by_q) by_q[(k->row + r) * nv] = by_q[(k->row + r) * nv] + sum[0][r];
        if (by_v) by_v[(k->row + r) * nv] = by_v[(k->row + r) * nv] + sum[1][r];
    }
}

/* Subtracts the derivative of J' lambda by a dof of the link `mover` from a column of rho. The dofs'
   motions S stand in the columns Phi of d, which are no longer needed. The columns S of d are: they keep a
   free base's. */
static void rbdi_put_rho(const rbd_model *m, const rbd_derivatives *d, const rbdi_constraint *k,
                         const rbdi_pair_motion *x, int side, int mover, rbdi_motion S, rbd_real *rho) {
    const rbdi_v3 o = rbdi_vec0(), mz = rbdi_cross(x->m, S.omega), fz = rbdi_cross(x->f, S.omega),
                  sf = rbdi_cross(S.v, x->f), roll = rbdi_cross(rbdi_cross(S.omega, x->rolls), x->f);
    RBDI_FOR_PATHS(m, k, link, sign) {
        const rbdi_link *l = &m->link[link];
        const int other = sign < 0,
                  moved = other == side && l->first >= m->link[mover].first; /* on the same path: behind it */
        const rbdi_v3 moment = rbdi_add(roll, moved == side ? sf : mz), force = moved == side ? o : fz;
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_motion C = rbdi_load_motion(RBDI_OF(d, l->first + j, Phi), RBDI_BATCH);
            rbd_real *to = &rho[rbdi_source(m, l->iv + j) * m->nv];
            *to = *to - rbdi_dot(C.omega, moment) - rbdi_dot(C.v, force);
        }
    }
}

/* rho += -d(J' lambda) of a constraint, with the dofs' motions in d. */
static void rbdi_change_forces(const rbd_model *m, const rbd_derivatives *d, const rbdi_constraint *k,
                               const rbdi_pair_motion *x, rbd_real *rho) {
    RBDI_FOR_PATHS(m, k, link, sign)
    for (int j = 0, first = m->link[link].first; j < rbdi_link_dofs(m, &m->link[link]); ++j)
        rbdi_put_rho(m, d, k, x, sign < 0, link, rbdi_load_motion(RBDI_OF(d, first + j, Phi), RBDI_BATCH),
                     rho + rbdi_source(m, m->link[link].iv + j));
}

/* The same, and sigma. */
static void rbdi_differentiate(const rbd_model *m, const rbd_constraint_set *c, const rbd_derivatives *d,
                               const rbdi_constraint *k, rbd_real *rho_q, rbd_real *sigma_q,
                               rbd_real *sigma_v) {
    const rbdi_pair_motion x = rbdi_pair_motion_of(c, k);
    RBDI_FOR_PATHS(m, k, link, sign) {
        const rbdi_link *l = &m->link[link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_change by = rbdi_change_of(m, c, &x, sign < 0, link, j);
            const int column = rbdi_source(m, l->iv + j);
            rbdi_store_motion(RBDI_OF(d, l->first + j, Phi), RBDI_BATCH, by.S);
            rbdi_put_sigma(k, &x, &by, m->nv, sigma_q ? sigma_q + column : NULL,
                           sigma_v ? sigma_v + column : NULL);
        }
    }
    if (rho_q) rbdi_change_forces(m, d, k, &x, rho_q);
}

/* dlambda = Delta^-1 (T' rho - sigma) in place of sigma. */
static void rbdi_change_lambda(const rbd_model *m, rbd_constraint_set *c, const rbd_real *rho,
                               rbd_real *sigma) {
    const int n = m->nv;
    for (int r = 0; r < c->rows; ++r) {
        rbd_real *to = &sigma[r * n];
        for (int k = 0; k < n; ++k) to[k] = -to[k], c->x[k] = c->Y[k * c->stride + r];
        rbdi_subtract_product(c->x, rho, n, n, to);
    }
    rbdi_delta_solve(c, sigma, n);
}

RBDI_API rbd_status rbd_constrained_fd_derivatives(const rbd_model *m, rbd_constraint_set *c,
                                                   rbd_derivatives *d, const rbd_real *q, const rbd_real *v,
                                                   const rbd_real *tau, const rbd_real *f_ext,
                                                   const rbd_constrained_fd_results *out) {
    const rbd_constrained_fd_results none_wanted = {NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
    const rbd_constrained_fd_results to = out ? *out : none_wanted;
    const rbdi_c3 none = {RBD_C(0), RBD_C(0), RBD_C(0)};
    rbd_real *const of_a[3] = {to.da_dq, to.da_dv, to.da_dtau};
    rbd_real *const of_lambda[3] = {to.dlambda_dq, to.dlambda_dv, to.dlambda_dtau};
    const int nv = m ? m->nv : 0;
    int pairs = 1;
    rbd_status status, solved;
    for (int x = 0; x < 3; ++x) pairs &= !of_a[x] == !of_lambda[x];
    status = rbdi_check_constraints(m, c, d && q && v && tau && out && pairs);
    if (!status) status = rbdi_check_derivatives(m, d, 1);
    if (status) return status;
    if (d->work != c->w) return RBD_ERR_WORK;
    solved = rbdi_factored_fd(m, c, q, v, tau, f_ext, NULL, d->a);
    solved = rbdi_constrained_status(m, c, solved, to.lambda);
    if (to.da_dq || to.da_dv) (void)rbd_id_derivatives(m, d, q, v, d->a, f_ext, to.da_dq, to.da_dv, NULL);
    for (int x = 0; x < 3; ++x)
        if (of_lambda[x]) rbdi_clear(of_lambda[x], c->rows * nv);
    rbdi_constraint_state(m, c, rbdi_expand_v(m, v, c->w->vx), rbdi_expand_v(m, d->a, c->w->ax), none, 0);
    for (const rbdi_constraint *k = c->constraint; k < c->constraint + c->n; ++k)
        rbdi_differentiate(m, c, d, k, to.da_dq, to.dlambda_dq, to.dlambda_dv);
    rbdi_solve_down(m, c->w, c->w->H, -1, c->stride, c->rows, c->Y); /* -T = -L^-1 D^-1 Y */
    if (to.da_dtau) rbdi_clear(to.da_dtau, nv * nv);
    for (int k = 0; to.da_dtau && k < nv; ++k) to.da_dtau[k * nv + k] = rbdi_set(RBD_C(-1));
    for (int x = 0; x < 3; ++x) {
        if (!of_a[x]) continue;
        rbdi_change_lambda(m, c, of_a[x], of_lambda[x]);
        rbdi_solve_columns(m, c->w, c->w->H, -1, nv, nv, of_a[x], NULL);
        for (int k = 0; k < nv; ++k)
            rbdi_subtract_product(&c->Y[k * c->stride], of_lambda[x], c->rows, nv, &of_a[x][k * nv]);
        if (solved && solved != RBD_ERR_INFEASIBLE) {
            (void)rbdi_verdict(m, c->w, of_a[x], nv * nv);
            (void)rbdi_verdict(m, c->w, of_lambda[x], c->rows * nv);
        }
    }
    for (int k = 0; to.a && k < nv; ++k) to.a[k] = d->a[k];
    return solved;
}

#endif
