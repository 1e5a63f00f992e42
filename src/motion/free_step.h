#ifndef RBDI_MOTION_FREE_STEP_H
#define RBDI_MOTION_FREE_STEP_H
#include "dynamics/rnea.h"
#include "dynamics/packed.h"
#include "dynamics/pivots.h"
#include "motion/manifold.h"

/* ---- free step [free step] ----
   Half of the way by v, to q_mid, where v_mid is v in its axes. There, with damping d, K = M + dt d and the
   classical accelerations a(w) = 0 of [manifold code],

       nu = v_mid + K^-1 dt (tau - c(w) - d v_mid),   c(w) = ID(q_mid, w, a(w)),   w = (v_mid + nu) / 2

   by three solutions, the first with w = v_mid; then the other half by nu. For a vector that turns by x in a
   step, the square of the length is magnified by 1 + x^2 with one solution, by 1 + x^4/4 with two, by
   1 - x^4/4 + x^6/16 with three: the least number that is stable, up to x = 2. Vectors stand in w->F. */

#ifndef RBD_NO_CHOLESKY
/* Columns of w->F, behind what the factor's calls use: w, a(w), v_mid. */
static rbd_real *rbdi_free_vector(const rbd_model *m, rbd_work *w, int k) {
    return w->F + (2 + k) * rbdi_stride(m);
}

/* v in the axes of q_mid. */
static void rbdi_middle_velocity(const rbd_model *m, const rbd_real *v, rbd_real half, rbd_real *v_mid) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->nv > 0) rbdi_turn_velocity(u, &v[u->iv], half, &v[u->iv], &v_mid[u->iv]);
}

/* x = K^-1 dt (tau - c(at) - d v_mid). */
static void rbdi_free_change(const rbd_model *m, rbd_work *w, const rbd_real *tau, const rbd_real *f_ext,
                             const rbd_real *damping, rbd_real dt, rbd_real *x) {
    const rbd_real *v_mid = rbdi_free_vector(m, w, 2);
    rbd_real *at = rbdi_free_vector(m, w, 0), *a = rbdi_free_vector(m, w, 1);

    rbdi_clear(a, m->nv);
    rbdi_straight_acceleration(m, at, a);
    rbdi_rnea(m, w, rbdi_expand_v(m, at, w->vx), rbdi_expand_v(m, a, w->ax), f_ext,
              rbdi_mimics(m) ? w->tx : x);
    rbdi_reduce_tau(m, w->tx, x);

    for (int k = 0; k < m->nv; ++k) {
        const rbd_real d = damping ? damping[k] : rbdi_zero();
        x[k] = dt * (tau[k] - x[k] - d * v_mid[k]);
    }

    rbdi_solve(m, w, w->H, x);
}

/* q and v of one joint moved by v for half, then by v in the new axes plus x. */
static void rbdi_finish_joint(const rbdi_frame *u, const rbd_real *q, const rbd_real *v, const rbd_real *x,
                              rbd_real half, rbd_real *q_next, rbd_real *v_next) {
    rbd_real middle[7], nu[6];
    rbdi_move_straight(u, q, v, half, middle);
    rbdi_turn_velocity(u, v, half, v, nu);
    for (int k = 0; k < u->nv; ++k) nu[k] = nu[k] + x[k];
    rbdi_move_straight(u, middle, nu, half, q_next);
    rbdi_turn_velocity(u, nu, half, nu, v_next);
}

RBDI_API rbd_status rbd_free_step(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                  const rbd_real *tau, const rbd_real *f_ext, const rbd_real *damping,
                                  rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    const rbd_real half = dt * RBD_C(0.5);
    rbd_real *at, *v_mid, *x;
    rbdi_mask doubt;
    rbd_status status = rbdi_check(m, w, q && v && tau && q_next && v_next);
    if (status) return status;

    at = rbdi_free_vector(m, w, 0);
    v_mid = rbdi_free_vector(m, w, 2);
    x = w->bias;

    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->nv > 0) rbdi_move_straight(u, &q[u->iq], &v[u->iv], half, &at[u->iq]);
    rbd_crba_packed(m, w, at, w->H);

    for (int k = 0; damping && k < m->nv; ++k) {
        rbd_real *diagonal = &w->H[m->dof[k].row + m->dof[k].depth];
        *diagonal = *diagonal + dt * damping[k];
    }

    doubt = rbdi_factor(m, w, w->H);

    rbdi_middle_velocity(m, v, half, v_mid);
    for (int k = 0; k < m->nv; ++k) at[k] = v_mid[k];

    for (int i = 0; i < 3; ++i) {
        rbdi_free_change(m, w, tau, f_ext, damping, dt, x);
        for (int k = 0; k < m->nv; ++k) at[k] = v_mid[k] + x[k] * RBD_C(0.5);
    }

    status = rbdi_factor_status(m, w, w->H, doubt, x, m->nv);

    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->nv > 0)
            rbdi_finish_joint(u, &q[u->iq], &v[u->iv], &x[u->iv], half, &q_next[u->iq], &v_next[u->iv]);
    return status;
}
#endif

#endif
