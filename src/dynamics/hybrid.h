#ifndef RBDI_DYNAMICS_HYBRID_H
#define RBDI_DYNAMICS_HYBRID_H
#include "dynamics/rnea.h"
#include "dynamics/pivots.h"

#ifndef RBD_NO_CHOLESKY
/* ---- hybrid dynamics [hybrid] ----
   RBDA section 9.1. f: the dofs whose torque is given; p: those whose acceleration is prescribed. With c =
   tau at a_p and a_f = 0:

       M_ff a_f = tau_f - c_f,   tau_p = c_p + M_pf a_f

   M_ff = L'DL is factored in place within the packed M, from the last dof to the first. M_pf stays. */

/* L and 1/D replace M_ff in H, x_f becomes L^-T x_f. Returns whether a pivot is in doubt. */
RBDI_PART rbdi_mask rbdi_eliminate_free(const rbd_model *m, rbd_work *w, const unsigned char *prescribed,
                                        rbd_real *H, rbd_real *x) {
    rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());

    for (int k = m->nv - 1; k >= 0; --k) {
        const rbdi_dof *dof = &m->dof[k];
        rbd_real *row = &H[dof->row], inverse;
        if (prescribed[k]) continue;

        w->pivot[k] = row[dof->depth];
        inverse = rbdi_pivot_inverse(w->pivot[k], dof->scale, &doubt);
        row[dof->depth] = inverse;

        /* of each free dof i on the path: l = L_ki, row i -= l row k, x_i -= l x_k */
        for (int t = dof->depth - 1, i = dof->lambda; t >= 0; --t, i = m->dof[i].lambda) {
            rbd_real *to = &H[m->dof[i].row];
            const rbd_real l = row[t] * inverse;
            if (prescribed[i]) continue;
            for (int s = t, j = i; s >= 0; --s, j = m->dof[j].lambda)
                if (!prescribed[j]) to[s] = to[s] - l * row[s];
            row[t] = l;
            x[i] = x[i] - l * x[k];
        }
    }

    return doubt;
}

/* a_f = L^-1 D^-1 x_f, tau_p = x_p + M_pf a_f. */
RBDI_PART void rbdi_substitute_free(const rbd_model *m, const unsigned char *prescribed, const rbd_real *H,
                                    const rbd_real *x, rbd_real *a, rbd_real *tau) {
    for (int k = 0; k < m->nv; ++k) {
        const rbdi_dof *dof = &m->dof[k];
        const rbd_real *row = &H[dof->row];
        rbd_real sum = rbdi_zero();

        for (int t = dof->depth - 1, i = dof->lambda; t >= 0; --t, i = m->dof[i].lambda)
            if (!prescribed[i]) sum = sum + row[t] * a[i];
        if (prescribed[k]) {
            tau[k] = x[k] + sum;
            continue;
        }

        a[k] = x[k] * row[dof->depth] - sum; /* x_k / D_k - sum of L_ki a_i */
        for (int t = dof->depth - 1, i = dof->lambda; t >= 0; --t, i = m->dof[i].lambda)
            if (prescribed[i]) tau[i] = tau[i] + row[t] * a[k];
    }
}

/* Checks the pivots of M_ff: those of M with the rows and columns p of the unit matrix, whose factor H
   becomes. */
RBDI_COLD rbd_status rbdi_check_free(const rbd_model *m, rbd_work *w, const unsigned char *prescribed,
                                     rbdi_mask doubt, rbd_real *a, rbd_real *tau) {
    for (int k = 0; k < m->nv; ++k) {
        rbd_real *row = &w->H[m->dof[k].row];
        if (prescribed[k]) w->pivot[k] = rbdi_set(RBD_C(1));
        for (int t = m->dof[k].depth - 1, i = m->dof[k].lambda; t >= 0; --t, i = m->dof[i].lambda)
            if (prescribed[k] || prescribed[i]) row[t] = rbdi_zero();
    }

    rbdi_check_factor(m, w, w->H, doubt);
    for (int k = 0; k < m->nv; ++k)
        if (prescribed[k]) w->pivot[k] = rbdi_set(RBD_C(1)); /* good */
    (void)rbdi_pivot_status(m, w, tau, m->nv);
    return rbdi_pivot_status(m, w, a, m->nv);
}

RBDI_API rbd_status rbd_hybrid(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                               const unsigned char *given, rbd_real *a, rbd_real *tau,
                               const rbd_real *f_ext) {
    const rbd_status status = rbdi_check_dynamics(m, w, q && v && given && a && tau);
    rbdi_mask doubt;
    if (status) return status;

    /* c = tau at a_p and a_f = 0 */
    for (int k = 0; k < m->nv; ++k)
        if (!given[k]) a[k] = rbdi_zero();
    rbdi_joints(m, w, rbdi_expand_q(m, w, q));
    rbdi_rnea(m, w, rbdi_expand_v(m, v, w->vx), rbdi_expand_v(m, a, w->ax), f_ext,
              rbdi_mimics(m) ? w->tx : w->bias);
    rbdi_reduce_tau(m, w->tx, w->bias);

    /* M_ff a_f = tau_f - c_f,  tau_p = c_p + M_pf a_f */
    for (int k = 0; k < m->nv; ++k)
        if (!given[k]) w->bias[k] = tau[k] - w->bias[k];
    rbdi_crba_of_joints(m, w, w->H);
    doubt = rbdi_eliminate_free(m, w, given, w->H, w->bias);
    rbdi_substitute_free(m, given, w->H, w->bias, a, tau);

    w->singular = -1;
    return rbdi_any(doubt) ? rbdi_check_free(m, w, given, doubt, a, tau) : RBD_OK;
}
#endif

#endif
