#ifndef RBDI_MODEL_REGROUP_H
#define RBDI_MODEL_REGROUP_H
#include "model/links.h"

/* Step 7, leaves to root: scale, a bound of the inertia that the joint moves, in any configuration: that of
   the subtree about the link's origin, but of the link's own only the part about the axis. A pivot is the
   difference of numbers of this size.

   RBDI_ROD of the inertia about all axes is added. Otherwise a pivot of 16 roundings of the description would
   not be in doubt where nothing should turn about the axis, as with a thin rod on it. This inertia is taken
   about points as far away as the user's frames: solver.r, from the link's origin to the user's, and reach,
   to the farthest body fixed to this link or to a later one. A sliding joint is assumed to move by 1 m. */
RBDI_LOCAL void rbdi_build_scale(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i], *parent;
    rbdi_wide r[3], distance, reach,
        trace = l->Sigma[0] + l->Sigma[3] + l->Sigma[5] + l->mass * rbdi_w_dot(l->solver.r, l->solver.r);

    l->scale = l->trace + (l->kind == RBDI_BLOCK ? trace : l->Sigma[0] + l->Sigma[3]);
    l->trace += trace;
    l->moment += rbdi_w_length(l->h);
    reach = l->reach += rbdi_w_length(l->solver.r);
    l->scale += RBDI_ROD * (l->trace + 2 * l->moment * reach + l->all_mass * reach * reach);
    if (l->parent < 0) return;

    parent = &links[l->parent];
    rbdi_build_origin(l, r);
    distance = rbdi_w_length(r);
    parent->trace += l->trace + 2 * l->moment * distance + l->all_mass * distance * distance;
    parent->moment += l->moment + l->all_mass * distance;

    /* a joint that slides */
    if (l->kind == RBDI_BLOCK ? l->type != RBD_SPHERICAL : rbdi_nonzero(l->kappa)) reach += 1;
    rbdi_build_reach(parent, reach);
}

/* Step 8, leaves to root: regrouping ([design]). Moments of mass that the joint's motion does not change go
   to the parent: of a revolute link m, h_z and Sigma_zz, of a sliding one Sigma, of a spherical one m, of a
   helical or planar one Sigma_zz. */
RBDI_LOCAL void rbdi_build_regroup(rbdi_build_link *links, int i) {
    rbdi_build_link *l = &links[i];
    rbdi_wide Sigma[6] = {0, 0, 0, 0, 0, 0}, h[3] = {0, 0, 0}, mass = 0, r[3], T[9];
    int slides = l->type == RBD_TRANSLATION || (l->kind == RBDI_SCREW && !(l->rho > 0));
    if (l->type == RBD_FLOATING) return;

    if (l->type == RBD_SPHERICAL) {
        mass = l->mass;
        l->mass = 0;
    } else if (slides) {
        for (int k = 0; k < 6; ++k) {
            Sigma[k] = l->Sigma[k];
            l->Sigma[k] = 0;
        }
    } else {
        Sigma[5] = l->Sigma[5];
        l->Sigma[5] = 0;
        if (l->kind == RBDI_REVOLUTE || l->kind == RBDI_REVOLUTE_CS) {
            h[2] = l->h[2];
            l->h[2] = 0;
            mass = l->mass;
            l->mass = 0;
        }
    }
    if (l->parent < 0) return;

    rbdi_build_origin(l, r);
    rbdi_w_transpose(l->X.E, T);
    rbdi_add_moments(&links[l->parent], T, r, Sigma, h, mass);
}

#endif
