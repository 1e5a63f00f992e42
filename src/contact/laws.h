#ifndef RBDI_CONTACT_LAWS_H
#define RBDI_CONTACT_LAWS_H
#include "dynamics/row_sums.h"
#include "contact/one_contact.h"

/* ---- laws [laws] ----
   A sweep of block Gauss-Seidel solves all contacts and bounded rows exactly, one after the other. As a
   projection (Alart and Curnier 1991) the laws are p = P(z), z = p - u/d with the normal's d:

     opens    z_n <= 0                p = 0
     sticks   |z_t| <= mu z_n         p = z
     slips    else                    p = z_n (mu e + n), e = z_t/|z_t|
     bounded                          p = z, or the bound that z has passed

   The residual is the largest |p - P(z)| d: of an open contact d |p|, of one that sticks |u|, of one that
   slips |u_n| and d times the error of friction. It is in m/s, and 0 only if all laws hold. An error of
   friction moves the plane's velocity by more where its 1/mass there, l, exceeds d: by up to l / d times the
   residual. It includes the rounding of u; if it did not, impulses of contacts that jam could have any size.
   A spring's share of d counts in z_n alone: it is no mass. */

/* u = b + Delta p. */
RBDI_PART void rbdi_contact_velocities(rbdi_contact_solver *s) {
    for (int r = 0; r < s->rows; ++r) {
        s->u[r] = s->given.b[r];
        s->scratch[r] = -s->p[r];
    }
    rbdi_subtract_product(s->scratch, s->given.delta, s->rows, s->rows, s->u);
}

/* Sets p of n rows from row `first` on to x, and changes u with it. */
RBDI_INLINE void rbdi_change_impulse(rbdi_contact_solver *s, int first, int n, const rbd_real *x) {
    for (int r = first; r < first + n; ++r) {
        const rbd_real less = s->p[r] - x[r - first];
        if (!(less < 0 || less > 0)) continue;

        s->p[r] = x[r - first];
        rbdi_subtract(s->u, less, &s->given.delta[r * s->rows], s->rows);
    }
}

/* Solves contact i with all other impulses held. */
RBDI_PART void rbdi_sweep_contact(rbdi_contact_solver *s, int i) {
    rbdi_contact_law *law = &s->law[i];
    rbd_real w[3], x[3];
    if (law->state == RBD_APART) return;

    /* w = u - D p */
    rbdi_own_velocity(law, &s->p[3 * i], w);
    for (int j = 0; j < 3; ++j) w[j] = s->u[3 * i + j] - w[j];

    rbdi_contact_impulse(law, w, x);
    rbdi_change_impulse(s, 3 * i, 3, x);
}

/* P(z) of bounded row i, and its state. */
RBDI_INLINE rbd_real rbdi_project_bounded(const rbdi_contact_solver *s, int i, rbd_contact_state *state) {
    const int r = 3 * s->given.contacts + i;
    const rbd_real d = s->given.delta[r * s->rows + r],
                   z = d > s->unmoved ? s->p[r] - s->u[r] / d : rbdi_zero();

    *state = RBD_OPENS;
    if (z <= s->given.lower[i]) return s->given.lower[i];
    if (z >= s->given.upper[i]) return s->given.upper[i];

    *state = d > s->unmoved ? RBD_STICKS : RBD_APART;
    return z;
}

/* One sweep, from the first contact to the last row or, if `back`, from the last row to the first contact. */
RBDI_PART void rbdi_sweep_laws(rbdi_contact_solver *s, int back) {
    const int n = s->given.contacts, all = n + s->given.bounded;
    for (int t = 0; t < all; ++t) {
        const int i = back ? all - 1 - t : t;

        if (i < n) {
            rbdi_sweep_contact(s, i);
        } else {
            const rbd_real x = rbdi_project_bounded(s, i - n, &s->bound[i - n]);
            rbdi_change_impulse(s, 2 * n + i, 1, &x);
        }
    }
    ++s->solution.sweeps;
}

/* P(z) of a contact; its state, direction e and alpha are those of z. u_t = -alpha p_t with p_t = mu z_n e
   gives alpha = d (|z_t| - mu z_n) / (mu z_n). */
RBDI_PART void rbdi_project_contact(rbdi_contact_law *law, const rbd_real *p, const rbd_real *u,
                                    rbd_real to[3]) {
    const rbd_real x = p[0] - u[0] / law->rigid, y = p[1] - u[1] / law->rigid, n = p[2] - u[2] / law->d;
    const rbd_real size = rbdi_sqrt(x * x + y * y), most = law->friction * n;

    to[0] = to[1] = to[2] = rbdi_zero();
    law->state = RBD_OPENS;
    if (!(n > 0)) return;

    to[0] = x;
    to[1] = y;
    to[2] = n;
    law->state = RBD_STICKS;
    if (size <= most * RBDI_ON_CONE && law->friction > 0) return;

    law->state = RBD_SLIPS;
    law->e[0] = size > 0 ? x / size : rbdi_zero();
    law->e[1] = size > 0 ? y / size : rbdi_zero();
    law->alpha = law->rigid * (size > RBDI_FASTEST_SLIP * most ? RBDI_FASTEST_SLIP : (size - most) / most);
    to[0] = most * law->e[0];
    to[1] = most * law->e[1];
}

/* The larger of two residuals. NaN counts as RBDI_UNBOUNDED. */
RBDI_INLINE rbd_real rbdi_worse(rbd_real worst, rbd_real error) {
    if (!(error < RBDI_UNBOUNDED)) return rbdi_set(RBDI_UNBOUNDED);
    return error > worst ? error : worst;
}

/* The states of z, and the residual: the largest d (|P(z) - p| + eps p_n), with d and eps |p| of bounded rows
   alike. */
RBDI_PART void rbdi_project_laws(rbdi_contact_solver *s) {
    rbd_real worst = rbdi_zero();

    for (int i = 0; i < s->given.contacts; ++i) {
        const rbd_real *p = &s->p[3 * i];
        rbdi_contact_law *law = &s->law[i];
        rbd_real to[3];
        if (law->state == RBD_APART) continue;

        rbdi_project_contact(law, p, &s->u[3 * i], to);
        for (int j = 0; j < 3; ++j) to[j] = to[j] - p[j];
        worst = rbdi_worse(
            worst, law->rigid * (rbdi_sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]) + RBDI_EPS * p[2]));
    }

    for (int i = 0; i < s->given.bounded; ++i) {
        const int r = 3 * s->given.contacts + i;
        const rbd_real x = rbdi_project_bounded(s, i, &s->bound[i]);
        worst = rbdi_worse(worst, s->given.delta[r * s->rows + r] *
                                      (rbdi_abs(x - s->p[r]) + RBDI_EPS * rbdi_abs(x)));
    }

    s->solution.residual = worst;
}

/* u, states and residual of p. */
RBDI_PART void rbdi_contact_residual(rbdi_contact_solver *s) {
    rbdi_contact_velocities(s);
    rbdi_project_laws(s);
}

/* |p_t|. Below RBDI_LEAST_SIZE squares would lose digits, or vanish. */
RBDI_INLINE rbd_real rbdi_tangent_size(const rbd_real *p) {
    const rbd_real x = rbdi_abs(p[0]), y = rbdi_abs(p[1]), most = x > y ? x : y;
    rbd_real ratio;
    if (most > RBDI_LEAST_SIZE) return rbdi_sqrt(x * x + y * y);
    if (!(most > 0)) return x + y;

    ratio = (x > y ? y : x) / most;
    return most * rbdi_sqrt(1 + ratio * ratio);
}

/* Moves p into cones and bounds, because iterations leave it outside by the tolerance. If `at_end`, contacts
   that open get 0. Returns whether p changed. */
RBDI_PART int rbdi_into_cones(rbdi_contact_solver *s, int at_end) {
    int changed = 0;

    for (int i = 0; i < s->given.contacts; ++i) {
        rbd_real *p = &s->p[3 * i];
        const rbd_real size = rbdi_tangent_size(p), most = s->law[i].friction * p[2];
        const rbd_contact_state state = s->law[i].state;
        const int none = state == RBD_APART || !(p[2] > 0) || (at_end && state == RBD_OPENS);
        if (none ? size <= 0 && p[2] <= 0 && p[2] >= 0 : !(size > most)) continue; /* not so of NaN */

        for (int j = 0; j < 2 + none; ++j) p[j] = none ? rbdi_zero() : p[j] * (most / size);
        changed = 1;
    }

    for (int i = 0; i < s->given.bounded; ++i) {
        rbd_real *p = &s->p[3 * s->given.contacts + i];
        const rbd_real lower = s->given.lower[i], upper = s->given.upper[i];
        if (!(*p < lower) && !(*p > upper)) continue;

        *p = *p < lower ? lower : upper;
        changed = 1;
    }

    return changed;
}

#endif
