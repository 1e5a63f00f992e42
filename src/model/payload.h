#ifndef RBDI_MODEL_PAYLOAD_H
#define RBDI_MODEL_PAYLOAD_H
#include "api/model.h"
#include "model/emit.h"

/* -- a payload -- */

/* The inertia of a body with a payload: the sum of the masses, the centre of mass c, the moments about it. */
RBDI_LOCAL rbd_status rbdi_payload_frame(rbdi_frame *u, const rbd_body *load) {
    const rbdi_wide mass[2] = {(rbdi_wide)u->mass, (rbdi_wide)load->mass}, sum = mass[0] + mass[1];
    const rbdi_wide com[2][3] = {{(rbdi_wide)u->com.x, (rbdi_wide)u->com.y, (rbdi_wide)u->com.z},
                                 {(rbdi_wide)load->com[0], (rbdi_wide)load->com[1], (rbdi_wide)load->com[2]}};
    const rbdi_wide noise = 8 * (rbdi_wide)RBDI_EPS * (rbdi_w_abs(mass[0]) + rbdi_w_abs(mass[1]));
    const rbdi_wide total = rbdi_w_abs(sum) > noise ? sum : 0;
    rbdi_wide c[3], I[6] = {(rbdi_wide)u->I.xx, (rbdi_wide)u->I.xy, (rbdi_wide)u->I.xz,
                            (rbdi_wide)u->I.yy, (rbdi_wide)u->I.yz, (rbdi_wide)u->I.zz};
    double whole[6], size = 0;
    if (total < 0) return RBD_ERR_MASS;

    for (int k = 0; k < 3; ++k)
        c[k] = total > 0 ? (mass[0] * com[0][k] + mass[1] * com[1][k]) / total : com[0][k];
    for (int k = 0; k < 6; ++k) {
        size += (double)(rbdi_w_abs(I[k]) + rbdi_w_abs((rbdi_wide)load->inertia[k]));
        I[k] += (rbdi_wide)load->inertia[k];
    }

    for (int part = 0; part < 2; ++part) {
        const rbdi_wide r[3] = {com[part][0] - c[0], com[part][1] - c[1], com[part][2] - c[2]},
                        rr = rbdi_w_dot(r, r);
        for (int k = 0, i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j, ++k) I[k] += mass[part] * ((i == j ? rr : 0) - r[i] * r[j]);
        size += (double)(rbdi_w_abs(mass[part]) * rr);
    }

    for (int k = 0; k < 6; ++k) whole[k] = (double)I[k];
    size *= 1 + 16 * (double)RBDI_EPS / RBDI_SEMIDEFINITE;
    if (!rbdi_finite(whole, 6) || (size > 0 && !rbdi_semidefinite(whole, size))) return RBD_ERR_INERTIA;

    u->mass = RBD_C(total);
    u->com = rbdi_round3(c);
    u->I = rbdi_round6(I);
    return RBD_OK;
}

/* Prepares a step of the build from link i of the model to its parent, for the payload alone: pair[1] becomes
   link i with the moments of mass that pair[0] has, pair[0] its parent, empty. */
RBDI_LOCAL void rbdi_payload_step(const rbd_model *m, int i, rbdi_build_link pair[2]) {
    const rbdi_link *l = &m->link[i];

    pair[1] = pair[0];
    pair[1].parent = l->parent < 0 ? -1 : 0;
    pair[1].kind = l->kind;
    pair[1].type = l->kind == RBDI_BLOCK ? m->block[l->block].type : 0;
    pair[1].rho = (rbdi_wide)l->rho;
    pair[1].kappa = (rbdi_wide)l->kappa;
    pair[1].X = rbdi_link_place(m, l);
    rbdi_clear_link(&pair[0]);
    pair[0].all_mass = pair[1].all_mass;
}

/* Adds x to a dof's scale. */
RBDI_LOCAL void rbdi_payload_scale(rbdi_dof *dof, rbdi_wide x) {
    dof->scale = RBD_C((rbdi_wide)dof->scale + x);
    if (dof->scale < dof->armature + RBDI_LEAST_SCALE) dof->scale = dof->armature + RBDI_LEAST_SCALE;
}

/* Step 7, the bounds of pivots, for a payload that is added (sign = 1) or taken off (-1). */
RBDI_LOCAL void rbdi_payload_bounds(const rbd_model *m, int i, rbd_body load, const rbdi_place *place) {
    rbdi_dof *dof = (rbdi_dof *)m->dof;
    const double sign = load.mass < 0 || load.inertia[0] + load.inertia[3] + load.inertia[5] < 0 ? -1 : 1;
    rbdi_build_link pair[2];

    load.mass *= sign;
    for (int k = 0; k < 6; ++k) load.inertia[k] *= sign;
    rbdi_clear_link(&pair[0]);
    rbdi_build_mass(&load, place, pair);
    pair[0].all_mass = pair[0].mass;

    for (; i >= 0; i = m->link[i].parent) {
        const int iv = m->link[i].iv;

        rbdi_payload_step(m, i, pair);
        for (int body = 0; body < m->nb; ++body) {
            const rbdi_c3 at = m->frame[body].r;
            const rbdi_wide r[3] = {(rbdi_wide)at.x, (rbdi_wide)at.y, (rbdi_wide)at.z};
            if (m->frame[body].link == i) rbdi_build_reach(&pair[1], rbdi_w_length(r));
        }

        rbdi_build_scale(pair, 1);
        for (int k = 0; k < rbdi_link_dofs(m, &m->link[i]); ++k) {
            const rbdi_wide x = (rbdi_wide)sign * rbdi_build_dof_scale(&pair[1], k);
            rbdi_payload_scale(&dof[iv + k], x);
            if (iv >= m->nv) { /* which has one dof */
                const rbdi_mimic *mimic = &m->mimic[iv - m->nv];
                const rbdi_wide ratio = (rbdi_wide)mimic->ratio;
                rbdi_payload_scale(&dof[mimic->source_v], ratio * ratio * x);
            }
        }
    }
}

/* Step 8, regrouping, for the payload alone, because it is linear: on the way to the root each link keeps a
   part. */
RBDI_LOCAL void rbdi_payload_links(const rbd_model *m, int i, const rbd_body *load, const rbdi_place *place) {
    rbdi_link *link = (rbdi_link *)m->link;
    rbdi_build_link pair[2];
    rbdi_wide kept = 0;

    rbdi_clear_link(&pair[0]);
    rbdi_build_mass(load, place, pair);

    for (; i >= 0; i = link[i].parent) {
        rbdi_csym *Sigma = &link[i].Sigma, add;

        rbdi_payload_step(m, i, pair);
        rbdi_build_regroup(pair, 1);

        add = rbdi_round6(pair[1].Sigma);
        Sigma->xx += add.xx;
        Sigma->xy += add.xy;
        Sigma->xz += add.xz;
        Sigma->yy += add.yy;
        Sigma->yz += add.yz;
        Sigma->zz += add.zz;

        link[i].h.x += RBD_C(pair[1].h[0]);
        link[i].h.y += RBD_C(pair[1].h[1]);
        link[i].h.z += RBD_C(pair[1].h[2]);
        link[i].mass += RBD_C(pair[1].mass);
        kept += pair[1].mass;
        link[i].subtree_mass += RBD_C(kept);
    }
}

RBDI_API rbd_status rbd_add_payload(void *memory, int body, double mass, const double com[3],
                                    const double inertia[6]) {
    const rbd_model *m = memory ? (const rbd_model *)rbdi_aligned(memory) : NULL;
    rbd_status status;
    rbdi_frame *u;
    rbd_body load;
    rbdi_place place;
    if (!m || !com) return RBD_ERR_NULL;
    if (m->version != RBD_MODEL_VERSION || m->scalar != (int)sizeof(rbd_const)) return RBD_ERR_VERSION;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    load.mass = mass;
    for (int k = 0; k < 3; ++k) load.com[k] = com[k];
    for (int k = 0; k < 6; ++k) load.inertia[k] = inertia ? inertia[k] : 0;
    if (!rbdi_finite(&load.mass, 1)) return RBD_ERR_MASS;
    if (!rbdi_finite(load.com, 3)) return RBD_ERR_COM;
    if (!rbdi_finite(load.inertia, 6)) return RBD_ERR_INERTIA;

    u = (rbdi_frame *)&m->frame[body];
    status = rbdi_payload_frame(u, &load);
    if (status || u->link < 0) return status;

    place.link = 0;
    place.X = rbdi_widen_pose(u->E, u->r);
    rbdi_payload_links(m, u->link, &load, &place);
    rbdi_payload_bounds(m, u->link, load, &place);
    return RBD_OK;
}

#endif
