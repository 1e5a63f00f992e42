#ifndef RBDI_MOTION_FREE_STEP_H
#define RBDI_MOTION_FREE_STEP_H
#include "dynamics/rnea.h"
#include "dynamics/packed.h"
#include "dynamics/pivots.h"
#include "motion/step.h"

/* Interface: rbdi_guard_solution */

/* ---- free step [free step] ----
   Half of the way by v, to q_mid, where v_mid is v in its axes. There, with damping d, K = M + dt d and the
   accelerations a(w) of [straight moves],

       nu = v_mid + K^-1 dt (tau - c(w) - d v_mid),   c(w) = ID(q_mid, w, a(w)),   w = (v_mid + nu) / 2

   by three solutions, the first with w = v_mid; then the other half by nu. For a vector that turns by x in a
   step, the square of the length is magnified by 1 + x^2 with one solution, by 1 + x^4/4 with two, by
   1 - x^4/4 + x^6/16 with three: the least number that is stable, up to x = 2. Near that and beyond, where
   the solutions diverge, see rbdi_guard_solution. */

#ifndef RBD_NO_CHOLESKY
/* Of three solutions y = L^-T K (nu - v_mid), K = L'DL, changes the third if the second change is large
   beside the first, measured by D^-1, which makes it twice a kinetic energy:

       y_3 -= t s (y_3 - y_1),   s = r / (1 + r),   r = |y_3 - y_2|^2 / |y_2 - y_1|^2

   If the changes are a series of one frequency, with the ratio i x/2, then r = x^2/4, and with t = 1 that is
   its sum: the implicit midpoint, which keeps energy at any x. Where several frequencies act on each other
   the sum may make energy, and three solutions take some up to x = 2. So t grows from 0 at r = 1/2 to 1 at
   r = 1, without a jump: of one frequency each such mean of both takes energy or keeps it. */
RBDI_PART void rbdi_guard_solution(const rbd_model *m, const rbd_real *L, const rbd_real *first,
                                   const rbd_real *second, rbd_real *third) {
    const rbd_real one = rbdi_set(RBD_C(1));
    rbd_real before = rbdi_zero(), after = before, t, kept;
    rbdi_mask grows;
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real inverse = L[m->dof[k].row + m->dof[k].depth], old = second[k] - first[k],
                       change = third[k] - second[k];
        before = before + old * old * inverse;
        after = after + change * change * inverse;
    }

    grows = rbdi_less(before, after + after);
    if (!rbdi_any(grows)) return;

    /* t = 2 r - 1, at most 1 */
    t = (after + after) / before - one;
    t = rbdi_select(rbdi_less(one, t), one, t);

    /* y_3 = y_1 + (1 - t s) (y_3 - y_1): without a difference of large numbers where r is large */
    kept = (before + (one - t) * after) / (before + after);
    for (int k = 0; k < m->nv; ++k)
        third[k] = rbdi_select(grows, first[k] + kept * (third[k] - first[k]), third[k]);
}

/* Columns of w->F, behind the scratch of a solution: three solutions, velocities, and accelerations. */
RBDI_LOCAL rbd_real *rbdi_free_vector(const rbd_model *m, rbd_work *w, int k) {
    return w->F + (1 + k) * rbdi_stride(m);
}

/* y = L^-T dt (tau - c(at) - d v_mid). */
RBDI_LOCAL void rbdi_free_solution(const rbd_model *m, rbd_work *w, const rbd_real *v_mid, const rbd_real *at,
                                   const rbd_real *tau, const rbd_real *f_ext, const rbd_real *damping,
                                   rbd_real dt, rbd_real *y) {
    rbd_real *a = rbdi_free_vector(m, w, 4);
    rbdi_clear(a, m->nv);
    rbdi_straight_acceleration(m, RBDI_CENTRES, at, a);
    rbdi_rnea(m, w, rbdi_expand_v(m, at, w->vx), rbdi_expand_v(m, a, w->ax), f_ext,
              rbdi_mimics(m) ? w->tx : y);
    rbdi_reduce_tau(m, w->tx, y);
    for (int k = 0; k < m->nv; ++k) {
        const rbd_real d = damping ? damping[k] : rbdi_zero();
        y[k] = dt * (tau[k] - y[k] - d * v_mid[k]);
    }
    rbdi_vector_transposed(m, w, w->H, y);
}

/* x = nu - v_mid, by three solutions. */
RBDI_LOCAL void rbdi_free_change(const rbd_model *m, rbd_work *w, const rbd_real *v_mid, const rbd_real *tau,
                                 const rbd_real *f_ext, const rbd_real *damping, rbd_real dt, rbd_real *x) {
    const rbd_real half = rbdi_set(RBD_C(0.5));
    rbd_real *at = rbdi_free_vector(m, w, 3);
    rbdi_clear(x, m->nv);
    for (int i = 0; i < 3; ++i) {
        rbd_real *y = rbdi_free_vector(m, w, i);
        for (int k = 0; k < m->nv; ++k) at[k] = v_mid[k] + half * x[k];
        rbdi_free_solution(m, w, v_mid, at, tau, f_ext, damping, dt, y);
        if (i == 2) rbdi_guard_solution(m, w->H, rbdi_free_vector(m, w, 0), rbdi_free_vector(m, w, 1), y);
        for (int k = 0; k < m->nv; ++k) x[k] = y[k];
        rbdi_vector_forward(m, w, w->H, x);
    }
}

/* Whether the changes x of the velocities are numbers below RBDI_FASTEST. In lanes where one is not, x
   becomes 0. */
RBDI_LOCAL int rbdi_bound_change(const rbd_model *m, rbd_real *x) {
    const rbd_real fastest = rbdi_set(RBDI_FASTEST);
    rbdi_mask good = rbdi_less(rbdi_zero(), fastest);
    for (int k = 0; k < m->nv; ++k) good = rbdi_and(good, rbdi_less(rbdi_abs(x[k]), fastest));

    for (int k = 0; k < m->nv; ++k) x[k] = rbdi_select(good, x[k], rbdi_zero());
    return !rbdi_any(rbdi_not(good));
}

RBDI_API rbd_status rbd_free_step(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                  const rbd_real *tau, const rbd_real *f_ext, const rbd_real *damping,
                                  rbd_real dt, rbd_real *q_next, rbd_real *v_next) {
    const rbd_real half = dt * RBD_C(0.5);
    rbd_real *nu;
    rbdi_mask doubt;
    rbd_status status = rbdi_check_dynamics(m, w, q && v && tau && q_next && v_next);
    if (status) return status;

    /* q_mid and v_mid, and K there */
    rbdi_move_joints(m, RBDI_CENTRES, q, v, v, half, q_next, v_next);
    rbd_crba_packed(m, w, q_next, w->H);
    for (int k = 0; damping && k < m->nv; ++k) {
        rbd_real *diagonal = &w->H[m->dof[k].row + m->dof[k].depth];
        *diagonal = *diagonal + dt * damping[k];
    }

    doubt = rbdi_factor(m, w, w->H);

    nu = w->bias;
    rbdi_free_change(m, w, v_next, tau, f_ext, damping, dt, nu);
    status = rbdi_factor_status(m, w, w->H, doubt, nu, m->nv);
    if (!rbdi_bound_change(m, nu) && !status) status = RBD_ERR_NAN;
    for (int k = 0; k < m->nv; ++k) nu[k] = v_next[k] + nu[k];

    rbdi_move_joints(m, RBDI_CENTRES, q_next, nu, nu, half, q_next, v_next);
    return status;
}
#endif

#endif
