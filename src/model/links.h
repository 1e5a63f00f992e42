#ifndef RBDI_MODEL_LINKS_H
#define RBDI_MODEL_LINKS_H
#include "model/check.h"

/* The axis of a letter of rbdi_joint_fact.axes, of unit length, joint frame. */
RBDI_LOCAL void rbdi_link_axis(const rbd_body *b, char letter, rbdi_wide axis[3]) {
    const char name = rbdi_axis_name(letter);
    const double *described = name == 'a' ? b->axis : b->axis2;
    for (int k = 0; k < 3; ++k) axis[k] = name < 'x' ? (rbdi_wide)described[k] : name == 'x' + k;
    rbdi_unit(axis, axis);
}

RBDI_LOCAL void rbdi_clear_link(rbdi_build_link *l) {
    unsigned char *p = (unsigned char *)l;
    for (size_t k = 0; k < sizeof *l; ++k) p[k] = 0;
}

RBDI_LOCAL void rbdi_build_reach(rbdi_build_link *l, rbdi_wide reach) {
    if (l->reach < reach) l->reach = reach;
}

/* Step 1: the pose of body i, and the links of its joint, in the user's frames. Universal, cylindrical and
   Euler joints become chains of one-axis links; only the last has mass. */
RBDI_LOCAL void rbdi_build_joint(const rbdi_build *build, int i, int *nl) {
    const rbd_body *b = &build->bodies[i];
    rbdi_place *place = build->place;
    const int type = (int)b->type, n = rbdi_links_of(type);
    const char *axes = rbdi_joint_facts(type)->axes;
    rbdi_wide R[9];
    rbdi_wide_pose X;
    int parent = -1;

    rbdi_widen(b->rotation, 9, R);
    if (rbdi_all_zero(b->rotation, 9)) rbdi_w_identity(R);
    rbdi_orthonormalise(R);
    rbdi_w_transpose(R, X.E);
    rbdi_widen(b->position, 3, X.r);

    if (b->parent >= 0) {
        parent = place[b->parent].link;
        X = rbdi_w_compose(&X, &place[b->parent].X);
    }

    for (int k = 0; k < n; ++k) {
        rbdi_build_link *l = &build->links[*nl];

        rbdi_clear_link(l);
        l->parent = parent;
        l->type = type;
        l->body = i;
        l->joint_dof = k;
        l->iq = place[i].iq + k;
        l->iv = place[i].iv + k;
        l->favourite = -1;
        l->X = X;
        l->rho = 1;
        l->kind = RBDI_REVOLUTE;

        if (!axes[0]) {
            l->kind = RBDI_BLOCK;
        } else {
            rbdi_link_axis(b, axes[k], l->axis);
            if (type == RBD_CONTINUOUS_CS) l->kind = RBDI_REVOLUTE_CS;
            if (type == RBD_HELICAL) {
                l->kind = RBDI_SCREW;
                l->kappa = (rbdi_wide)b->pitch;
            }
            if (rbdi_axis_slides(axes[k])) {
                l->kind = RBDI_SCREW;
                l->rho = 0;
                l->kappa = 1;
            }
        }

        parent = (*nl)++;
        rbdi_w_identity(X.E);
        X.r[0] = X.r[1] = X.r[2] = 0;
    }

    place[i].link = parent;
    place[i].X = X;
    if (parent >= 0) rbdi_build_reach(&build->links[parent], rbdi_w_length(X.r));
}

/* Step 2: adds the body's moments of mass to its link's. About the centre of mass Sigma = tr(I)/2 - I. */
RBDI_LOCAL void rbdi_build_mass(const rbd_body *b, const rbdi_place *place, rbdi_build_link *links) {
    rbdi_wide Sigma[6], T[9], com[3], none[3] = {0, 0, 0}, half;
    if (place->link < 0) return;

    rbdi_widen(b->inertia, 6, Sigma);
    half = (Sigma[0] + Sigma[3] + Sigma[5]) / 2;
    for (int k = 0; k < 6; ++k) Sigma[k] = (k == 0 || k == 3 || k == 5 ? half : 0) - Sigma[k];
    rbdi_widen(b->com, 3, com);
    rbdi_w_transpose(place->X.E, T);
    rbdi_w_apply(T, com, com);
    for (int k = 0; k < 3; ++k) com[k] += place->X.r[k];
    rbdi_add_moments(&links[place->link], T, com, Sigma, none, (rbdi_wide)b->mass);
}

/* Step 3: solver frames, with the joint's axis on z. */
RBDI_LOCAL void rbdi_build_axis(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i];
    rbdi_w_identity(l->solver.E);
    if (l->kind != RBDI_BLOCK) rbdi_w_basis(l->axis, l->solver.E);
    l->X = rbdi_w_compose(&l->solver, &l->X);
    if (l->parent >= 0) l->X = rbdi_w_relative(&l->X, &links[l->parent].solver);
    rbdi_change_moments(l, l->solver.E, l->solver.r);
}

/* Of the children of a link the one with the highest rank comes first, its favourite: that with the largest
   subtree; under a one-axis parent one-axis children before blocks, because only they can have Denavit and
   Hartenberg's form. */
RBDI_LOCAL int rbdi_build_rank(const rbdi_build_link *links, int nl, int i) {
    const int one_axis = links[i].kind != RBDI_BLOCK && links[links[i].parent].kind != RBDI_BLOCK;
    return links[i].size + (one_axis ? nl : 0);
}

/* Step 4: depth-first positions. */
RBDI_LOCAL void rbdi_build_order(rbdi_build_link *links, int nl) {
    int next_root = 0;

    for (int i = 0; i < nl; ++i) links[i].size = 1;
    for (int i = nl - 1; i >= 0; --i)
        if (links[i].parent >= 0) links[links[i].parent].size += links[i].size;

    for (int i = 0; i < nl; ++i) {
        int *favourite;
        if (links[i].parent < 0) continue;
        favourite = &links[links[i].parent].favourite;
        if (*favourite < 0 || rbdi_build_rank(links, nl, i) > rbdi_build_rank(links, nl, *favourite))
            *favourite = i;
    }

    for (int i = 0; i < nl; ++i) {
        rbdi_build_link *l = &links[i];

        if (l->parent < 0) {
            l->position = next_root;
            next_root += l->size;
        } else if (links[l->parent].favourite == i) {
            l->position = links[l->parent].position + 1;
        } else {
            l->position = links[l->parent].cursor;
            links[l->parent].cursor += l->size;
        }

        l->cursor = l->position + 1 + (l->favourite >= 0 ? links[l->favourite].size : 0);
        links[l->position].order = i;
    }
}

/* Turns the frame of link i about its joint axis z by (c, s) and shifts it along z by t. The joint's motion
   and all results stay; the constants around it change. */
RBDI_LOCAL void rbdi_build_turn(rbdi_build_link *links, int nl, int i, rbdi_wide c, rbdi_wide s,
                                rbdi_wide t) {
    rbdi_build_link *l = &links[i];
    const rbdi_wide down[3] = {0, 0, -t};
    rbdi_wide_pose turn;

    rbdi_w_turn_z(c, s, turn.E);
    turn.r[0] = turn.r[1] = 0;
    turn.r[2] = t;
    for (int j = i + 1; j < nl; ++j)
        if (links[j].parent == i) links[j].X = rbdi_w_relative(&links[j].X, &turn);
    rbdi_change_moments(l, turn.E, down);
    l->solver = rbdi_w_compose(&turn, &l->solver);

    if (l->dh) {
        l->d += t;
        turn.r[2] = 0;
    }

    l->X = rbdi_w_compose(&turn, &l->X);
}

/* Angles of E = Rz(gamma) Rx(alpha) Rz(beta), |beta| <= 90 degrees, snapped to right angles. E is computed
   anew from them, so that poses and dynamics have the same model. */
RBDI_LOCAL void rbdi_build_angles(rbdi_build_link *l) {
    rbdi_wide *E = l->X.E, sigma = RBDI_WIDE_LIBM(rbdi_root)(E[6] * E[6] + E[7] * E[7]);

    l->cb = 1;
    l->sb = 0;
    l->ca = E[8] > 0 ? 1 : -1;
    l->sa = 0;

    if (sigma > RBDI_SNAP) {
        l->cb = -E[7] / sigma;
        l->sb = E[6] / sigma;
        l->ca = E[8];
        l->sa = sigma;
        rbdi_w_snap(&l->ca, &l->sa, RBDI_SNAP);
        rbdi_w_snap(&l->cb, &l->sb, RBDI_SNAP);

        if (l->cb < 0 && (rbdi_nonzero(l->ca) || !rbdi_nonzero(l->sb))) {
            l->cb = -l->cb;
            l->sb = -l->sb;
            l->sa = -l->sa;
        }
    }

    l->cg = E[0] * l->cb + E[1] * l->sb;
    l->sg = (E[1] * l->cb - E[0] * l->sb) * l->ca + E[2] * l->sa;
    rbdi_w_snap(&l->cg, &l->sg, RBDI_SNAP / 1000); /* removes rounding alone: any gamma costs the same */
    rbdi_w_zxz(l->cg, l->sg, l->ca, l->sa, l->cb, l->sb, E);
}

/* Bounds of the moments of mass, sums of m |x|^2 and of m |x|, of the subtree of link l about a point at this
   distance from l's origin: with its links stretched out away from the point. */
RBDI_LOCAL rbdi_wide rbdi_build_second_moment(const rbdi_build_link *l, rbdi_wide distance) {
    return l->all_mass * (l->radius + distance) * (l->radius + distance);
}

RBDI_LOCAL rbdi_wide rbdi_build_first_moment(const rbdi_build_link *l, rbdi_wide distance) {
    return l->lever + l->all_mass * distance;
}

/* Step 5, leaves to root: mass, radius of gyration and first moment of the stretched subtree about the link's
   own origin. */
RBDI_LOCAL void rbdi_build_measure(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i];
    const rbdi_wide own = l->Sigma[0] + l->Sigma[3] + l->Sigma[5];

    if (own > 0) l->radius += own; /* not positive: no real body is like this */
    if (own > 0 && l->mass > 0) l->lever += RBDI_WIDE_LIBM(rbdi_root)(own * l->mass);
    l->all_mass += l->mass;
    l->radius = l->all_mass > 0 ? RBDI_WIDE_LIBM(rbdi_root)(l->radius / l->all_mass) : 0;
    if (l->parent < 0) return;

    /* until the parent is measured its radius is the sum of the second moments */
    links[l->parent].radius += rbdi_build_second_moment(l, rbdi_w_length(l->X.r));
    links[l->parent].lever += rbdi_build_first_moment(l, rbdi_w_length(l->X.r));
    links[l->parent].all_mass += l->all_mass;
}

/* Whether the frame of link i, l, may move by t along its axis, so that its favourite child f is at this
   distance from it. Inertias about a far point are large, and the algorithms subtract them from each other:
   rounding errors grow with them. So the moments of this subtree may become at most 4 times those about the
   origin that the user chose. Right-angled and parallel axes pass (1.1 times at most in iiwa, HyQ, Atlas). */
RBDI_LOCAL int rbdi_build_near(const rbdi_build_link *links, int nl, int i, rbdi_wide t, rbdi_wide distance) {
    const rbdi_build_link *l = &links[i], *f = &links[l->favourite];
    const rbdi_wide rest = l->all_mass - f->all_mass, before = rbdi_w_length(f->X.r), step = rbdi_w_abs(t);

    for (int j = i + 1; j < nl; ++j) {
        const rbdi_build_link *child = &links[j];
        rbdi_wide r[3] = {child->X.r[0], child->X.r[1], child->X.r[2] - t};
        if (child->parent == i && child != f && child->all_mass > 0 &&
            child->radius + rbdi_w_length(r) > 4 * (child->radius + rbdi_w_length(child->X.r)))
            return 0;
    }

    return rest * t * t + rbdi_build_second_moment(f, distance) - rbdi_build_second_moment(f, before) <
               3 * rbdi_build_second_moment(l, 0) &&
           rest * step + rbdi_build_first_moment(f, distance) - rbdi_build_first_moment(f, before) <
               3 * rbdi_build_first_moment(l, 0);
}

/* Step 6, root to leaves: gives the favourite child of link i Denavit and Hartenberg's form, beta = 0 and r =
   (a, 0, 0), by a turn and shift of link i's frame. Without such a child gamma and d become 0 instead. Nearly
   parallel axes have their common normal far away and would lose digits: they keep a general r and beta. */
RBDI_LOCAL void rbdi_build_normalise(rbdi_build_link *links, int nl, int i) {
    rbdi_build_link *l = &links[i], *f;
    rbdi_wide r[3], Z[9], a, d = 0, t;
    if (l->kind == RBDI_BLOCK) return;
#ifdef RBDI_NO_FAVOURITE /* rbd-codegen --limbs: equal limbs get equal constants */
    if (l->favourite >= 0 && RBDI_NO_FAVOURITE(links, nl, i)) l->favourite = -1;
#endif
    if (l->favourite < 0 || links[l->favourite].kind == RBDI_BLOCK) {
        /* this saves no more than the shift d: the subtree may get at most 4 times farther away */
        const rbdi_wide moved = rbdi_build_second_moment(l, rbdi_w_abs(l->d));
        const int moves = l->dh && moved <= 16 * rbdi_build_second_moment(l, 0);
        rbdi_build_angles(l);
        rbdi_build_turn(links, nl, i, l->cg, -l->sg, moves ? -l->d : 0);
        return;
    }

    f = &links[l->favourite];
    rbdi_build_angles(l);
    rbdi_build_angles(f);

    if (rbdi_w_abs(f->sa) > 0) {
        /* the axes cross or pass each other: their common normal becomes x */

        /* beta or beta + 180 degrees: so that alpha is 90 degrees, or else l's gamma within 90 degrees */
        if (rbdi_nonzero(f->ca) ? l->cg * f->cb - l->sg * f->sb < 0 : f->sa < 0) {
            f->cb = -f->cb;
            f->sb = -f->sb;
            f->sa = -f->sa;
        }

        /* in axes turned by beta: r = (a, 0, t) + d (row z of Rx(alpha)) */
        rbdi_w_turn_z(f->cb, f->sb, Z);
        rbdi_w_apply(Z, f->X.r, r);
        a = r[0];
        d = -r[1] / f->sa;
        t = r[2] - d * f->ca;
        if (!rbdi_build_near(links, nl, i, t, RBDI_WIDE_LIBM(rbdi_root)(a * a + d * d))) return;
        rbdi_build_turn(links, nl, i, f->cb, f->sb, t);
    } else {
        /* the axes are parallel: x leads from one to the other */
        a = RBDI_WIDE_LIBM(rbdi_root)(f->X.r[0] * f->X.r[0] + f->X.r[1] * f->X.r[1]);
        t = f->X.r[2];
        if (!rbdi_build_near(links, nl, i, t, a)) {
            d = t * f->ca;
            t = 0;
        }
        rbdi_build_turn(links, nl, i, a > 0 ? f->X.r[0] / a : 1, a > 0 ? f->X.r[1] / a : 0, t);
    }

    f->dh = 1;
    f->X.r[0] = a;
    f->X.r[1] = f->X.r[2] = 0;
    f->d = d;
}

/* Origin of a link in its parent's frame at q = 0. */
RBDI_LOCAL void rbdi_build_origin(const rbdi_build_link *l, rbdi_wide r[3]) {
    for (int k = 0; k < 3; ++k) r[k] = l->X.r[k] + l->d * l->X.E[6 + k];
}

#endif
