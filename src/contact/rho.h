#ifndef RBDI_CONTACT_RHO_H
#define RBDI_CONTACT_RHO_H
#include "dynamics/row_sums.h"
#include "derivatives/layout.h"
#include "derivatives/steps.h"
#include "contact/layout.h"

/* ---- derivatives [step derivatives code] ----
   Derivatives of [step code], with the states of each solution held. x is a component of q_mid, v_mid or tau,
   a = (nu - v_mid) / dt + a(w), w = (v_mid + nu before) / 2, M without damping:

       K dnu/dx = J' dp/dx - rho,     rho = dt dID(q_mid, w, a)/dx - d(J' p)/dx at fixed nu and p
       du/dx = J dnu/dx + sigma,      sigma = d(J nu + dt/2 gamma + bias)/dx at fixed nu

   where dID has, by w, also a(w); by v_mid, -M of a, and -A of the caller's matrix; by tau, rho = -dt. Each
   solution's dnu enters the next by w. rbd_id_derivatives gives d ID; d(J nu), d gamma and d(J' p) are as in
   [derivatives code] but for balls, over which the place of contact rolls. With Z = L^-T rho and the S, T
   and G of [newton]

       G y = -T' (sigma - Y' D^-1 Z),   dp = S y,   dnu = -L^-1 D^-1 (Z - Y dp)                         (5)

   Last, the half of the step before takes derivatives by q_mid and v_mid to those by q and v.

   This room has rho, contact/sigma.h has sigma, contact/derivatives.h solves for dnu. */

/* Parts of the memory for derivatives, behind c->sigma: M, later G; two matrices; two for columns that the
   caller does not want; derivatives of J nu without impulses, a row for each contact, by three x. */
RBDI_LOCAL rbd_real *rbdi_side(const rbd_model *m, const rbd_contact_set *c, int k) {
    const int nv = m->nv;
    const int shared = RBDI_CONTACT_SHARED(nv, c->max_rows);
    return c->sigma + c->max_rows * nv + (k > 0 ? shared + (k - 1) * nv * nv : 0);
}

/* B = dt dID(q_mid, w, a(w))/dw and M, both without contacts; if Q is not NULL, dt dID/dq_mid. */
RBDI_LOCAL void rbdi_write_sides(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d,
                                 const rbd_real *nu, const rbd_real *f_ext, rbd_real *Q, rbd_real *B,
                                 rbd_real *M) {
    const int size = m->nv * m->nv;

    /* a = (nu - v_mid) / dt + a(w) */
    rbdi_straight_acceleration(m, c->points, c->at, c->straight);
    for (int k = 0; k < m->nv; ++k) d->a[k] = (nu[k] - c->v_mid[k]) / c->dt + c->straight[k];
    if (Q) rbdi_clear(Q, size); /* rbd_keep_zeros leaves entries out */
    if (B) {
        rbdi_clear(B, size);
        rbdi_clear(M, size);
    }

    (void)rbd_id_derivatives(m, d, c->q_mid, c->at, d->a, f_ext, Q, B, M);
    if (Q) rbdi_multiply(Q, c->dt, size);
}

/* X -= A, packed, of which X has all entries. */
RBDI_LOCAL void rbdi_subtract_packed(const rbd_model *m, const rbd_real *A, rbd_real *X) {
    for (int i = 0; i < m->nv; ++i) {
        const rbd_real *entry = &A[m->dof[i].row + m->dof[i].depth];
        for (int j = i; j >= 0; j = m->dof[j].lambda, --entry) {
            X[i * m->nv + j] = X[i * m->nv + j] - *entry;
            if (j < i) X[j * m->nv + i] = X[j * m->nv + i] - *entry;
        }
    }
}

/* Adds rho without the terms by q_mid at fixed w, which come into Q, and without d(J' p). last: dnu of the
   solution before, NULL = w is v_mid. */
RBDI_LOCAL void rbdi_add_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *nu,
                             const rbd_real *f_ext, rbd_real *const *last, rbd_real *const rho[3]) {
    const rbd_real half = rbdi_set(RBD_C(0.5));
    const int n = m->nv;
    rbd_real *M = rbdi_side(m, c, 0), *B = rbdi_side(m, c, 1), *Q = rho[0] ? rbdi_side(m, c, 2) : NULL;

    rbdi_write_sides(m, c, d, nu, f_ext, Q, B, M);

    /* by v_mid -M - A of a and the caller's matrix, by tau -dt */
    for (int k = 0; k < n * n; ++k) {
        B[k] = B[k] * c->dt + M[k];
        if (rho[1]) rho[1][k] = rho[1][k] - M[k];
        if (rho[2] && k % (n + 1) == 0) rho[2][k] = rho[2][k] - c->dt;
    }
    if (c->added && rho[1]) rbdi_subtract_packed(m, c->added, rho[1]);

    /* B = dt dID/dw with a(w), by v_mid and, with the solution before, by w = (v_mid + nu) / 2 */
    rbdi_unforced_columns(m, c->points, c->at, c->dt, n, M);
    for (int k = 0; k < n * n; ++k) {
        B[k] = last ? (B[k] - M[k]) * half : B[k] - M[k];
        if (rho[1]) rho[1][k] = rho[1][k] + B[k];
    }
    if (!last) return;

    /* rho += B dnu */
    rbdi_multiply(B, -rbdi_set(RBD_C(1)), n * n);
    for (int x = 0; x < 3; ++x) {
        if (!rho[x]) continue;
        for (int k = 0; k < n; ++k) rbdi_subtract_product(&B[k * n], last[x], n, n, &rho[x][k * n]);
    }
}

/* The same in place of what was there. */
RBDI_LOCAL void rbdi_write_rho(const rbd_model *m, rbd_contact_set *c, rbd_derivatives *d, const rbd_real *nu,
                               const rbd_real *f_ext, rbd_real *const *last, rbd_real *const rho[3]) {
    for (int x = 0; x < 3; ++x)
        if (rho[x]) rbdi_clear(rho[x], m->nv * m->nv);
    rbdi_add_rho(m, c, d, nu, f_ext, last, rho);
}

/* Adds Q, the terms by q_mid at fixed w. */
RBDI_LOCAL void rbdi_add_side(const rbd_model *m, const rbd_contact_set *c, rbd_real *const rho[3]) {
    if (rho[0]) rbdi_subtract(rho[0], -rbdi_set(RBD_C(1)), rbdi_side(m, c, 2), m->nv * m->nv);
}

#endif
