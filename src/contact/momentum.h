#ifndef RBDI_CONTACT_MOMENTUM_H
#define RBDI_CONTACT_MOMENTUM_H
#include "api/dynamics.h"
#include "base/memory.h"
#include "model/joints.h"
#include "contact/layout.h"

/* ---- momentum [momentum code] ----
   The option `momentum`. A body that floats has, with all that it carries, the momentum h: the root's six
   rows of M v. About the centre of mass, and in the axes of the root's joint, which stand in the world, h
   changes within a step by

       F = dt (tau - d nu - ID(q_mid, 0, 0))    of the root, at q_mid

   the impulse of torques, damping, gravity and all wrenches on bodies. The step misses that by O(dt^3). Here
   a change of the root's velocity alone makes it exact, to rounding:

       v_next += Ic^-1 (h(q, v) + F - h(q_next, v_next)),    Ic = rows and columns of the root in M(q_next)

   Ic = [I [mc]x; -[mc]x m] has the centre of mass c. About a fixed point, an error of position times the
   linear momentum would change the spin: the result would depend on the speed of the world. */

/* The first link of the tree that carries a link, -1 = the world. */
RBDI_LOCAL int rbdi_root_of(const rbd_model *m, int link) {
    while (link >= 0 && m->link[link].parent >= 0) link = m->link[link].parent;
    return link;
}

/* Whether a body floats over the world, and nothing outside has pushed what it carries: neither contacts nor
   constraints, nor dry friction of its own joint, nor bounded rows. Armature there is no momentum. */
RBDI_LOCAL int rbdi_flies(const rbd_model *m, const rbd_contact_set *c, const rbdi_frame *u) {
    if (u->type != RBD_FLOATING || u->link < 0 || m->link[u->link].parent >= 0) return 0;
    for (int k = u->iv; k < u->iv + 6; ++k) {
        if (m->dof[k].armature > 0) return 0;
        if (c->added && rbdi_abs(c->added[m->dof[k].row + m->dof[k].depth]) > 0) return 0;
    }

    for (int i = 0; i < c->rows->n; ++i) {
        const rbdi_constraint *con = &c->rows->constraint[i];
        const int one = rbdi_root_of(m, con->link[0]), two = rbdi_root_of(m, con->link[1]);
        if (con->row < 0 || one == two) continue;
        if (i < c->n && !c->contact[i].pushes) continue;
        if (one == u->link || two == u->link) return 0;
    }

    for (int i = 0; i < c->bounds; ++i) {
        const rbd_contact_row *law = &c->bound[i].law;
        if (c->bound[i].row < 0) continue;
        for (int j = 0; j < law->dofs; ++j)
            if (law->dof[j] >= u->iv && law->dof[j] < u->iv + 6) return 0;
    }
    return 1;
}

/* Whether any body does. */
RBDI_LOCAL int rbdi_any_flies(const rbd_model *m, const rbd_contact_set *c) {
    for (int b = 0; b < m->nb; ++b)
        if (rbdi_flies(m, c, &m->frame[b])) return 1;
    return 0;
}

/* The centre of mass of the tree whose root has the first dof iv, by M, packed. Axes and origin of the
   root. */
RBDI_LOCAL rbdi_v3 rbdi_centre_of(const rbd_model *m, const rbd_real *M, int iv) {
    const rbdi_dof *dof = &m->dof[iv];
    const rbd_real *x = &M[dof[3].row + dof[0].depth], *y = &M[dof[4].row + dof[0].depth],
                   *z = &M[dof[5].row + dof[0].depth], mass = x[3];
    if (!(mass > 0)) return rbdi_vec0();
    return rbdi_vec(y[2] / mass, z[0] / mass, x[1] / mass);
}

/* Notes the centres of mass at q_mid, where M is w->H, in c->centre at the first dofs of roots. */
RBDI_LOCAL void rbdi_note_centres(const rbd_model *m, rbd_contact_set *c) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        if (u->type == RBD_FLOATING && u->link >= 0)
            rbdi_store_vec(&c->centre[u->iv], 1, rbdi_centre_of(m, c->rows->w->H, u->iv));
}

/* The root's six rows of M v, M packed: about the root's origin, in its axes. */
RBDI_LOCAL rbdi_force rbdi_root_momentum(const rbd_model *m, const rbd_real *M, int iv, const rbd_real *v) {
    rbd_real h[6];
    rbdi_clear(h, 6);
    for (int j = iv; j < m->nv; ++j) {
        const rbd_real *row = &M[m->dof[j].row + m->dof[iv].depth];
        int root = j;
        while (root > iv + 5) root = m->dof[root].lambda;
        if (root < iv) continue;

        for (int i = 0; i < 6 && iv + i <= j; ++i) h[i] = h[i] + row[i] * v[j];
        for (int i = 0; j < iv + 6 && iv + i < j; ++i) h[j - iv] = h[j - iv] + row[i] * v[iv + i];
    }

    /* A joint of another tree that one of this tree follows comes before the root in the rows of M. */
    for (int j = m->dof[iv].lambda; j >= 0; j = m->dof[j].lambda)
        for (int i = 0; i < 6; ++i) h[i] = h[i] + M[m->dof[iv + i].row + m->dof[j].depth] * v[j];
    return rbdi_load_force(h, 1);
}

/* A wrench, or a momentum, from the root's axes and origin to the joint's axes and the centre of mass. */
RBDI_LOCAL rbdi_force rbdi_about_centre(const rbd_real *q, rbdi_v3 centre, rbdi_force F) {
    const rbdi_mat E = rbdi_joint_attitude(RBD_FLOATING, q);
    F.n = rbdi_mul_t(E, rbdi_sub(F.n, rbdi_cross(centre, F.f)));
    F.f = rbdi_mul_t(E, F.f);
    return F;
}

/* Wanted momenta, h(q, v) + F, into c->momentum at the dofs of roots that fly. */
RBDI_LOCAL void rbdi_wanted_momentum(const rbd_model *m, rbd_contact_set *c, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *tau, const rbd_real *f_ext) {
    rbd_work *w = c->rows->w;
    rbd_real *impulse = c->rows->x;
    (void)rbd_bias(m, w, c->q_mid, w->zero, f_ext, impulse);
    for (int k = 0; k < m->nv; ++k) impulse[k] = c->dt * (tau[k] - c->damping[k] * c->nu[k] - impulse[k]);
    (void)rbd_crba_packed(m, w, q, w->H);

    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        const int iv = u->iv;
        rbdi_force h, F;
        if (!rbdi_flies(m, c, u)) continue;
        h = rbdi_root_momentum(m, w->H, iv, v);
        h = rbdi_about_centre(&q[u->iq], rbdi_centre_of(m, w->H, iv), h);
        F = rbdi_load_force(&impulse[iv], 1);
        F = rbdi_about_centre(&c->q_mid[u->iq], rbdi_load_vec(&c->centre[iv], 1), F);
        rbdi_store_force(&c->momentum[iv], 1, rbdi_force_add(h, F));
    }
}

/* x = Ic^-1 x, 6, of the root whose first dof this is. Ic = L'DL stands in the packed M, and L and 1/D
   replace it. A direction in which the inertia may be rounding gets 0. */
RBDI_LOCAL void rbdi_solve_root(const rbdi_dof *dof, rbd_real *M, rbd_real *x) {
    rbd_real *row[6];
    for (int k = 0; k < 6; ++k) row[k] = &M[dof[k].row + dof[k].depth - k];

    for (int k = 5; k >= 0; --k) {
        rbdi_mask doubt = rbdi_less(rbdi_zero(), rbdi_zero());
        const rbd_real inverse = rbdi_pivot_inverse(row[k][k], dof[k].scale, &doubt);
        row[k][k] = rbdi_select(doubt, rbdi_zero(), inverse);
        for (int i = 0; i < k; ++i) {
            const rbd_real factor = row[k][i] * row[k][k];
            for (int j = 0; j <= i; ++j) row[i][j] = row[i][j] - factor * row[k][j];
            x[i] = x[i] - factor * x[k];
        }
    }

    for (int k = 0; k < 6; ++k) {
        for (int i = 0; i < k; ++i) x[k] = x[k] - row[k][i] * x[i];
        x[k] = x[k] * row[k][k];
    }
}

/* Gives the roots that fly the wanted momenta. */
RBDI_LOCAL void rbdi_restore_momentum(const rbd_model *m, const rbd_contact_set *c, const rbd_real *q_next,
                                      rbd_real *v_next) {
    rbd_work *w = c->rows->w;
    (void)rbd_crba_packed(m, w, q_next, w->H);
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u) {
        rbdi_mat E;
        rbdi_force h;
        rbd_real change[6];
        if (!rbdi_flies(m, c, u)) continue;

        /* about the root's origin, in its axes */
        E = rbdi_joint_attitude(RBD_FLOATING, &q_next[u->iq]);
        h = rbdi_load_force(&c->momentum[u->iv], 1);
        h.f = rbdi_mul(E, h.f);
        h.n = rbdi_add(rbdi_mul(E, h.n), rbdi_cross(rbdi_centre_of(m, w->H, u->iv), h.f));

        h = rbdi_force_sub(h, rbdi_root_momentum(m, w->H, u->iv, v_next));
        rbdi_store_force(change, 1, h);
        rbdi_solve_root(&m->dof[u->iv], w->H, change);
        for (int k = 0; k < 6; ++k) v_next[u->iv + k] = v_next[u->iv + k] + change[k];
    }
}

#endif
