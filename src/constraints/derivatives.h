#ifndef RBDI_CONSTRAINTS_DERIVATIVES_H
#define RBDI_CONSTRAINTS_DERIVATIVES_H
#include "motion/points.h"
#include "derivatives/memory.h"
#include "api/constrained_derivatives.h"
#include "constraints/calls.h"

/* Interface: rbdi_cross_add, rbdi_differentiate_error, rbdi_differentiate_forces, rbdi_differentiate_motion,
   rbdi_motion_derivatives, rbdi_pair_motion, rbdi_pair_motion_of, rbdi_roll */

/* ---- derivatives [derivatives code] ----
   Where x is a component of q, v or tau,

       M da/dx = J' dlambda/dx - rho,     rho = d(ID - J' lambda)/dx at fixed a and lambda
       J da/dx = -sigma,                  sigma = d(J a + gamma + kd J v + kp e)/dx at fixed a

   so that with T = M^-1 J'

       Delta dlambda/dx = T' rho - sigma,   da/dx = -M^-1 rho + T dlambda/dx

   By tau, rho = -1 and sigma = 0. rbd_id_derivatives gives d ID. The rest depends only on the relative motion
   of the two bodies, so only on dofs that move one of them. All quantities are in world axes; motions are
   those of the link-fixed points at p, the origin of frame 1. Such a dof k moves body b; S = (z; s), negated
   if b is body 2. Psi, Phi and U are those of [common frame] in rbd_derivatives.h, about p instead of the
   common origin:

       by q   dw = z x omega_b + Psi_omega
              du = z x v_b + Psi_v - omega_2 x s
              dalpha = z x alpha_b + Psi_omega x omega_b + Phi_omega - omega_2 x dw
              dacc = z x acc_b + 2 Psi_omega x v_b + Phi_v - alpha_2 x s - omega_2 x (omega_2 x s)
                     - 2 omega_2 x du
       by v   dalpha = U_omega + z x omega_b - omega_2 x z
              dacc = U_v + 2 z x v_b - 2 omega_2 x s

   where (w; u) is the velocity of body 1 relative to body 2 and (alpha; acc) its rate. If b is body 2, the
   axes turn with it, which adds by q (z x w; z x u) to (dw; du) and (dw x w + z x alpha; 2 dw x u + z x acc),
   with dw from above, to (dalpha; dacc), and by v (z x w; 2 z x u). With n and f the moment and force of
   lambda, and S_i of another such dof, J' lambda has

       d(S_i . (n; f)) = S_i . (n x z; f x z)   if b is body 1 and k moves i, or b is body 2 and it does not
                         S_i . (s x f; 0)       else

   Checked against finite differences in tests/test_constraints.c. */

/* Motion of body 1 relative to body 2 at the origin of frame 1, world axes, and what its derivatives need. */
typedef struct rbdi_pair_motion {
    rbdi_relative_motion motion; /* velocity (w; u), rate (alpha; acc) */
    rbdi_force force;            /* of lambda */
    rbdi_axes_held h;
    rbdi_v3 log_R;       /* world axes */
    rbd_real log_square; /* rbdi_log_square of it */
    rbdi_v3 free[2];     /* the free axis if two angular ones are held: of frame 2, of frame 1 */
    rbdi_v3 roll_radius; /* of a contact, from its place to the centre of its ball; else 0 */
    rbdi_v3 normal;      /* of the plane on which the place of a contact stays; else 0 */
} rbdi_pair_motion;

/* S of a dof, and derivatives by it: of (w; u) by q, of (alpha; acc) by q and by v. */
typedef struct rbdi_motion_derivatives {
    rbdi_motion S, velocity_q, rate_q, rate_v;
} rbdi_motion_derivatives;

RBDI_INLINE rbdi_motion rbdi_motion_cross(rbdi_motion V, rbdi_motion S) {
    rbdi_motion C;
    C.omega = rbdi_cross(V.omega, S.omega);
    C.v = rbdi_add(rbdi_cross(V.omega, S.v), rbdi_cross(V.v, S.omega));
    return C;
}

/* 2 a */
RBDI_INLINE rbdi_v3 rbdi_twice(rbdi_v3 a) { return rbdi_add(a, a); }

/* x + a x b */
RBDI_INLINE rbdi_v3 rbdi_cross_add(rbdi_v3 x, rbdi_v3 a, rbdi_v3 b) { return rbdi_add(x, rbdi_cross(a, b)); }

/* x - a x b */
RBDI_INLINE rbdi_v3 rbdi_cross_sub(rbdi_v3 x, rbdi_v3 a, rbdi_v3 b) { return rbdi_add(x, rbdi_cross(b, a)); }

RBDI_LOCAL rbdi_pair_motion rbdi_pair_motion_of(const rbd_constraint_set *c, const rbdi_constraint *con) {
    rbdi_pair_motion pair;
    pair.motion = rbdi_relative_motion_of(c, con);
    rbdi_set_axes(c, con, &pair.h);

    /* n and f: the sum of lambda times the row's axis */
    pair.force.n = pair.force.f = rbdi_vec0();
    for (int r = 0; r < con->rows; ++r) {
        const int angular = r < con->angular, i = angular ? 0 : 3;
        const rbdi_v3 axis = rbdi_vec(pair.h.axis[i][r], pair.h.axis[i + 1][r], pair.h.axis[i + 2][r]);
        rbdi_v3 *to = angular ? &pair.force.n : &pair.force.f;
        *to = rbdi_add(*to, rbdi_scale(c->lambda[con->row + r], axis));
    }

    /* the angular part of e */
    pair.log_R = pair.free[0] = pair.free[1] = rbdi_vec0();
    pair.roll_radius = pair.normal = rbdi_vec0();
    pair.log_square = rbdi_zero();
    if (con->kp > 0 && con->angular) {
        const rbdi_mat R_1 = rbdi_frame_axes(c, con, 0), R_2 = rbdi_frame_axes(c, con, 1);
        const int i = con->angular == 2 ? 3 - con->axis[0] - con->axis[1] : 0;
        rbd_real axis[3] = {rbdi_zero(), rbdi_zero(), rbdi_zero()};

        pair.log_R = rbdi_log_rotation(rbdi_mul_mat(rbdi_transpose(R_2), R_1));
        pair.log_square = rbdi_log_square(pair.log_R);
        pair.log_R = rbdi_mul(R_2, pair.log_R);

        axis[i] = rbdi_set(RBD_C(1));
        pair.free[0] = rbdi_mul(R_2, rbdi_load_vec(axis, 1));
        pair.free[1] = rbdi_mul(R_1, rbdi_load_vec(axis, 1));
    }
    return pair;
}

/* The terms in the axes of body 2 that turn with it: by q (z x w; z x u) and (dw x w + z x alpha; 2 dw x u +
   z x acc), by v (z x w; 2 z x u). */
RBDI_INLINE void rbdi_turn_with_body2(rbdi_motion velocity, rbdi_motion rate, rbdi_v3 z,
                                      rbdi_motion_derivatives *by) {
    const rbdi_v3 dw = by->velocity_q.omega;

    by->rate_q.omega = rbdi_cross_add(rbdi_cross_add(by->rate_q.omega, dw, velocity.omega), z, rate.omega);
    by->rate_q.v = rbdi_cross_add(rbdi_cross_add(by->rate_q.v, dw, rbdi_twice(velocity.v)), z, rate.v);

    by->velocity_q.omega = rbdi_cross_add(dw, z, velocity.omega);
    by->velocity_q.v = rbdi_cross_add(by->velocity_q.v, z, velocity.v);

    by->rate_v.omega = rbdi_cross_add(by->rate_v.omega, z, velocity.omega);
    by->rate_v.v = rbdi_cross_add(by->rate_v.v, z, rbdi_twice(velocity.v));
}

/* How far the place of a contact moves over body 1 if that moves by S relative to body 2: its centre moves by
   S, and the place stays below it; on a plane that moves neither up nor down. */
RBDI_INLINE rbdi_v3 rbdi_roll(const rbdi_pair_motion *pair, rbdi_motion S) {
    const rbdi_v3 up = rbdi_scale(rbdi_dot(pair->normal, S.v), pair->normal);
    return rbdi_sub(rbdi_cross(S.omega, pair->roll_radius), up);
}

/* Derivatives by dof j of a link on the path of body `side`. */
RBDI_LOCAL rbdi_motion_derivatives rbdi_differentiate_motion(const rbd_model *m, const rbd_constraint_set *c,
                                                             const rbdi_pair_motion *pair, int side, int link,
                                                             int j) {
    const rbdi_station *b = &pair->motion.body[side], P = rbdi_station_at(c, m->link[link].parent, b->p),
                       own = rbdi_station_at(c, link, b->p);
    const rbd_real ratio = rbdi_ratio(m, m->link[link].iv + j), scale = side ? -ratio : ratio;
    const rbdi_v3 omega2 = pair->motion.body[1].omega;
    rbdi_motion V, A, Psi, Phi, U;
    rbdi_motion_derivatives by;
    rbdi_v3 z, s, omega2_s;

    by.S = rbdi_column(m, c->w, link, j, b->p);
    by.S.omega = rbdi_scale(scale, by.S.omega);
    by.S.v = rbdi_scale(scale, by.S.v);
    z = by.S.omega;
    s = by.S.v;

    /* Psi = V_P x S, Phi = A_P x S + V_P x Psi, U = Psi + V_link x S */
    V.omega = own.omega;
    V.v = own.v;
    U = rbdi_motion_cross(V, by.S);
    V.omega = P.omega;
    V.v = P.v;
    A.omega = P.omega_dot;
    A.v = rbdi_cross_sub(P.acc, P.omega, P.v);
    Psi = rbdi_motion_cross(V, by.S);
    Phi = rbdi_motion_add(rbdi_motion_cross(A, by.S), rbdi_motion_cross(V, Psi));
    U = rbdi_motion_add(U, Psi);

    /* dw, du by q */
    omega2_s = rbdi_cross(omega2, s);

    by.velocity_q.omega = rbdi_cross_add(Psi.omega, z, b->omega);
    by.velocity_q.v = rbdi_sub(rbdi_cross_add(Psi.v, z, b->v), omega2_s);

    /* dalpha, dacc by q */
    by.rate_q.omega = rbdi_cross_add(rbdi_cross_add(Phi.omega, z, b->omega_dot), Psi.omega, b->omega);
    by.rate_q.omega = rbdi_cross_sub(by.rate_q.omega, omega2, by.velocity_q.omega);
    by.rate_q.v = rbdi_cross_add(rbdi_cross_add(Phi.v, z, b->acc), rbdi_twice(Psi.omega), b->v);
    by.rate_q.v =
        rbdi_cross_sub(rbdi_cross_sub(by.rate_q.v, pair->motion.body[1].omega_dot, s), omega2, omega2_s);
    by.rate_q.v = rbdi_cross_sub(by.rate_q.v, omega2, rbdi_twice(by.velocity_q.v));

    /* dalpha, dacc by v */
    by.rate_v.omega = rbdi_cross_sub(rbdi_cross_add(U.omega, z, b->omega), omega2, z);
    by.rate_v.v = rbdi_sub(rbdi_cross_add(U.v, z, rbdi_twice(b->v)), rbdi_twice(omega2_s));

    if (side) rbdi_turn_with_body2(pair->motion.velocity, pair->motion.rate, z, &by);

    /* The place of contact moves over body 1. */
    by.velocity_q.v = rbdi_cross_add(by.velocity_q.v, pair->motion.velocity.omega, rbdi_roll(pair, by.S));
    return by;
}

/* Derivative of the angular part of e, world axes, by a dof that turns body 1 by z relative to body 2. With w
   = log R: z - w x z / 2 + factor w x (w x z), [rbdi_log_square]. If two axes are held: f_2 x (z x f_1), f
   the free axis. */
RBDI_LOCAL rbdi_v3 rbdi_differentiate_error(const rbdi_constraint *con, const rbdi_pair_motion *pair,
                                            rbdi_v3 z) {
    const rbdi_v3 bent = rbdi_cross(pair->log_R, z),
                  more = rbdi_scale(pair->log_square, rbdi_cross(pair->log_R, bent));

    if (con->angular == 2) return rbdi_cross(pair->free[0], rbdi_cross(z, pair->free[1]));
    return rbdi_add(rbdi_add(z, rbdi_scale(rbdi_set(RBD_C(-0.5)), bent)), more);
}

/* Adds a dof's column of sigma. */
RBDI_LOCAL void rbdi_add_sigma(const rbdi_constraint *con, const rbdi_pair_motion *pair,
                               const rbdi_motion_derivatives *by, int nv, rbd_real *sigma_q,
                               rbd_real *sigma_v) {
    rbd_real sum[2][RBDI_SIX_ROWS], also[RBDI_SIX_ROWS]; /* by q, by v */

    /* J a + gamma */
    rbdi_clear(sum[0], 2 * RBDI_SIX_ROWS);
    rbdi_add_held(con, &pair->h, by->rate_q.omega, by->rate_q.v, sum[0]);
    rbdi_add_held(con, &pair->h, by->rate_v.omega, by->rate_v.v, sum[1]);

    /* kd J v by q, by v; kp e by q */
    for (int part = 0; part < 3; ++part) {
        rbdi_v3 turn = part == 0 ? by->velocity_q.omega : by->S.omega;
        const rbd_const gain = part < 2 ? con->kd : con->kp;
        if (!(gain > 0)) continue;

        if (part == 2) turn = rbdi_differentiate_error(con, pair, turn);
        rbdi_clear(also, RBDI_SIX_ROWS);
        rbdi_add_held(con, &pair->h, turn, part == 0 ? by->velocity_q.v : by->S.v, also);
        for (int r = 0; r < con->rows; ++r) sum[part == 1][r] = sum[part == 1][r] + also[r] * gain;
    }

    for (int r = 0; r < con->rows; ++r) {
        if (sigma_q) sigma_q[(con->row + r) * nv] = sigma_q[(con->row + r) * nv] + sum[0][r];
        if (sigma_v) sigma_v[(con->row + r) * nv] = sigma_v[(con->row + r) * nv] + sum[1][r];
    }
}

/* Subtracts the derivative of J' lambda by a dof of the link `mover`, with this S, from a column of rho. S of
   all dofs is stage.mover in the columns of d.

       S_i . (n x z; f x z)   if k is on the path of body 1 and moves i, or on that of body 2 and does not
       S_i . (s x f; 0)       else */
RBDI_LOCAL void rbdi_subtract_force_derivative(const rbd_model *m, const rbd_derivatives *d,
                                               const rbdi_constraint *con, const rbdi_pair_motion *pair,
                                               int side, int mover, rbdi_motion S, rbd_real *rho) {
    const rbdi_v3 o = rbdi_vec0(), nz = rbdi_cross(pair->force.n, S.omega),
                  fz = rbdi_cross(pair->force.f, S.omega), sf = rbdi_cross(S.v, pair->force.f),
                  roll = rbdi_cross(rbdi_roll(pair, S), pair->force.f);

    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];
        const int moved =
            walk.side == side && l->first >= m->link[mover].first; /* on the same path: behind it */
        const rbdi_v3 moment = rbdi_add(roll, moved == side ? sf : nz), force = moved == side ? o : fz;

        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_motion C = rbdi_load_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH);
            rbd_real *to = &rho[rbdi_source(m, l->iv + j) * m->nv];
            *to = *to - rbdi_dot(C.omega, moment) - rbdi_dot(C.v, force);
        }
    }
}

/* rho += -d(J' lambda) of a constraint, with the dofs' motions in d. */
RBDI_LOCAL void rbdi_differentiate_forces(const rbd_model *m, const rbd_derivatives *d,
                                          const rbdi_constraint *con, const rbdi_pair_motion *pair,
                                          rbd_real *rho) {
    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j)
            rbdi_subtract_force_derivative(
                m, d, con, pair, walk.side, walk.link,
                rbdi_load_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH),
                rho + rbdi_source(m, l->iv + j));
    }
}

/* The same, and += sigma by q and by v. NULL: not wanted. */
RBDI_LOCAL void rbdi_differentiate(const rbd_model *m, const rbd_constraint_set *c, const rbd_derivatives *d,
                                   const rbdi_constraint *con, rbd_real *rho_q, rbd_real *sigma_q,
                                   rbd_real *sigma_v) {
    const rbdi_pair_motion pair = rbdi_pair_motion_of(c, con);

    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);) {
        const rbdi_link *l = &m->link[walk.link];
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const rbdi_motion_derivatives by =
                rbdi_differentiate_motion(m, c, &pair, walk.side, walk.link, j);
            const int column = rbdi_source(m, l->iv + j);

            rbdi_store_motion(RBDI_OF(d, l->first + j, stage.mover), RBDI_BATCH, by.S);
            rbdi_add_sigma(con, &pair, &by, m->nv, sigma_q ? sigma_q + column : NULL,
                           sigma_v ? sigma_v + column : NULL);
        }
    }

    if (rho_q) rbdi_differentiate_forces(m, d, con, &pair, rho_q);
}

/* Replaces sigma by dlambda = Delta^-1 (T' rho - sigma). c->Y: -T. */
RBDI_LOCAL void rbdi_lambda_derivatives(const rbd_model *m, rbd_constraint_set *c, const rbd_real *rho,
                                        rbd_real *sigma) {
    const int n = m->nv;
    for (int r = 0; r < c->rows; ++r) {
        rbd_real *to = &sigma[r * n];
        for (int k = 0; k < n; ++k) {
            to[k] = -to[k];
            c->x[k] = c->Y[k * c->stride + r];
        }
        rbdi_subtract_product(c->x, rho, n, n, to);
    }

    rbdi_delta_solve(c, sigma, n);
}

/* Replaces rho by da = -M^-1 rho + T dlambda and sigma by dlambda, all columns at once. c->Y: -T. */
RBDI_LOCAL void rbdi_solve_at_once(const rbd_model *m, rbd_constraint_set *c, rbd_real *rho,
                                   rbd_real *sigma) {
    const int nv = m->nv;
    rbdi_lambda_derivatives(m, c, rho, sigma);
    rbdi_solve_columns(m, c->w, c->w->H, -1, nv, nv, rho);
    for (int k = 0; k < nv; ++k)
        rbdi_subtract_product(&c->Y[k * c->stride], sigma, c->rows, nv, &rho[k * nv]);
}

/* Column j of x = -D^-1 L^-T rho, Y' x = -sigma, by the steps of rbd_constrained_fd. rho: L^-T rho, becomes
   D (x + D^-1 Y dlambda); sigma becomes dlambda. D is not in c->w->pivot: if a pivot of M was in doubt,
   [pivots] has written verdicts there. Notes a row that the column does not meet. */
RBDI_LOCAL void rbdi_solve_column(const rbd_model *m, rbd_constraint_set *c, int j, rbd_real *rho,
                                  rbd_real *sigma) {
    const rbdi_mask look = rbdi_less(rbdi_zero(), rbdi_set(RBD_C(1)));
    rbdi_mask none = rbdi_not(look);
    const int nv = m->nv;
    for (int k = 0; k < nv; ++k) c->x[k] = -c->D_inverse[k] * rho[k * nv + j];
    for (int r = 0; r < c->rows; ++r) c->target[r] = -sigma[r * nv + j];

    rbdi_rest_of_rows(c);
    for (int r = 0; r < c->rows; ++r) c->lambda[r] = c->b[r];
    rbdi_delta_solve(c, c->lambda, 1);
    (void)rbdi_add_forces(m, c, c->lambda);
    if (rbdi_refine(m, c, look) || c->pivoted) rbdi_check_held(m, c);

    for (int k = 0; k < nv; ++k)
        rho[k * nv + j] = c->x[k] * rbdi_reciprocal(c->D_inverse[k], RBDI_TINY, &none);
    for (int r = 0; r < c->rows; ++r) sigma[r * nv + j] = c->lambda[r];
}

/* As rbdi_solve_at_once, column by column with [refinement]. c->Y: L^-T J'. */
RBDI_COLD void rbdi_solve_by_columns(const rbd_model *m, rbd_constraint_set *c, rbd_real *rho,
                                     rbd_real *sigma) {
    const int nv = m->nv;
    rbdi_solve_transposed(m, c->w, c->w->H, nv, nv, rho);
    for (int j = 0; j < nv; ++j) rbdi_solve_column(m, c, j, rho, sigma);
    rbdi_solve_forward(m, c->w, c->w->H, 1, nv, nv, rho);
}

/* Whether accelerations by a force at each dof lose so many digits that rows may need [refinement]. One set
   of forces, all different, stands for all columns: the loss depends on D and Y, hardly on the forces. */
RBDI_LOCAL int rbdi_loses_digits(const rbd_model *m, rbd_constraint_set *c) {
    for (int k = 0; k < m->nv; ++k)
        c->x[k] = c->D_inverse[k] * (RBD_C(1) + RBD_C(0.618) * (rbd_const)(k % 7));
    rbdi_clear(c->target, c->rows);
    rbdi_rest_of_rows(c);

    rbdi_delta_solve(c, c->b, 1);
    if (rbdi_any(rbdi_add_forces(m, c, c->b))) return 1;
    return c->pivoted && rbdi_any(rbdi_rows_miss(c));
}

/* Makes da of rho and dlambda of sigma, for q, v and tau. status: of a. Returns that of the call. */
RBDI_LOCAL rbd_status rbdi_constrained_slopes(const rbd_model *m, rbd_constraint_set *c, rbd_status status,
                                              rbd_real *const of_a[3], rbd_real *const of_lambda[3]) {
    const int nv = m->nv, by_columns = rbdi_loses_digits(m, c);
    if (!by_columns)
        rbdi_solve_forward(m, c->w, c->w->H, -1, c->stride, c->rows, c->Y); /* -T = -L^-1 D^-1 Y */

    for (int x = 0; x < 3; ++x) {
        if (!of_a[x]) continue;
        if (by_columns)
            rbdi_solve_by_columns(m, c, of_a[x], of_lambda[x]);
        else
            rbdi_solve_at_once(m, c, of_a[x], of_lambda[x]);
    }

    /* M is singular: that is the error, and there are no results */
    if (status && status != RBD_ERR_INFEASIBLE) {
        c->infeasible = -1;
        for (int x = 0; x < 3; ++x) {
            if (!of_a[x]) continue;
            (void)rbdi_pivot_status(m, c->w, of_a[x], nv * nv);
            (void)rbdi_pivot_status(m, c->w, of_lambda[x], c->rows * nv);
        }
        return status;
    }

    return c->infeasible < 0 ? RBD_OK : RBD_ERR_INFEASIBLE;
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
    status = rbdi_check_constrained(m, c, d && q && v && tau && out && pairs);
    if (!status) status = rbdi_check_derivatives(m, d, 1);
    if (status) return status;
    if (d->work != c->w) return RBD_ERR_WORK;

    /* a and lambda */
    solved = rbdi_factored_fd(m, c, q, v, tau, f_ext, NULL, d->a);
    solved = rbdi_constrained_status(m, c, solved, to.lambda);

    /* rho by q and v without lambda */
    if (to.da_dq || to.da_dv) (void)rbd_id_derivatives(m, d, q, v, d->a, f_ext, to.da_dq, to.da_dv, NULL);

    /* sigma, and lambda's part of rho */
    for (int x = 0; x < 3; ++x)
        if (of_lambda[x]) rbdi_clear(of_lambda[x], c->rows * nv);
    rbdi_constraint_state(m, c, rbdi_expand_v(m, v, c->w->vx), rbdi_expand_v(m, d->a, c->w->ax), none, 0);
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con)
        rbdi_differentiate(m, c, d, con, to.da_dq, to.dlambda_dq, to.dlambda_dv);

    /* by tau, rho = -1 */
    if (to.da_dtau) rbdi_clear(to.da_dtau, nv * nv);
    if (to.da_dtau)
        for (int k = 0; k < nv; ++k) to.da_dtau[k * nv + k] = rbdi_set(RBD_C(-1));

    solved = rbdi_constrained_slopes(m, c, solved, of_a, of_lambda);

    if (to.a)
        for (int k = 0; k < nv; ++k) to.a[k] = d->a[k];
    return solved;
}

#endif
