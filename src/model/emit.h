#ifndef RBDI_MODEL_EMIT_H
#define RBDI_MODEL_EMIT_H
#include "model/joints.h"
#include "model/regroup.h"

/* Three and six numbers of the build as constants of the model. */
RBDI_LOCAL rbdi_c3 rbdi_round3(const rbdi_wide x[3]) {
    rbdi_c3 out;
    out.x = RBD_C(x[0]);
    out.y = RBD_C(x[1]);
    out.z = RBD_C(x[2]);
    return out;
}

RBDI_LOCAL rbdi_csym rbdi_round6(const rbdi_wide x[6]) {
    rbdi_csym out;

    out.xx = RBD_C(x[0]);
    out.xy = RBD_C(x[1]);
    out.xz = RBD_C(x[2]);
    out.yy = RBD_C(x[3]);
    out.yz = RBD_C(x[4]);
    out.zz = RBD_C(x[5]);
    return out;
}

/* The joint angle at q = 0. Its right angles are kept apart, because a multiple of pi would be rounded. */
RBDI_LOCAL void rbdi_emit_angle(const rbdi_build_link *l, rbdi_link *out) {
    rbdi_wide c = l->cg, s = l->sg, minus_c;
    int quarters = 0;

    out->cg = RBD_C(c);
    out->sg = RBD_C(s);

    for (; quarters < 3 && c < rbdi_w_abs(s); ++quarters) {
        minus_c = 0 - c;
        c = s;
        s = minus_c;
    }

    out->quarters = RBD_C(quarters);
    out->gamma = l->kind == RBDI_BLOCK ? RBD_C(0) : RBD_C(rbdi_w_angle(c, s));
}

/* The flags of a link: the operations that its constants make necessary. */
RBDI_LOCAL int rbdi_emit_flags(const rbdi_build *build, const rbdi_build_link *l) {
    const rbd_body *b = &build->bodies[l->body];
    const int block = l->kind == RBDI_BLOCK;
    int flags = 0;

    if (!block && rbdi_nonzero(l->sb)) flags |= RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ;
    if (rbdi_nonzero(l->X.r[1]) || rbdi_nonzero(l->X.r[2])) flags |= RBDI_SHIFT_XYZ;
    if ((flags & RBDI_SHIFT_XYZ) || rbdi_nonzero(l->X.r[0])) flags |= RBDI_SHIFT_R;
    if (rbdi_nonzero(l->d) || rbdi_nonzero(l->kappa)) flags |= RBDI_SHIFT_Z;
    if (block || l->kind == RBDI_SCREW) flags |= RBDI_MASS_KEPT;
    if (!rbdi_all_zero(b->armature, rbdi_joint_facts(l->type)->nv)) flags |= RBDI_ARMATURE;
    if (l->parent < 0) flags |= RBDI_ROOT;
    if (l->kind == RBDI_SCREW) flags |= RBDI_SLIDES;
    if (!block && !rbdi_nonzero(l->ca) && l->sa > 0) flags |= RBDI_TWIST_90;
    if (!block && !rbdi_nonzero(l->sa) && l->ca > 0) flags |= RBDI_TWIST_0;
    return flags;
}

/* Step 9: the constants of the link at position p. */
RBDI_LOCAL rbdi_link rbdi_emit_link(const rbdi_build *build, int p) {
    const rbdi_build_link *links = build->links, *l = &links[links[p].order];
    rbdi_link out;

    out.parent = (int16_t)(l->parent < 0 ? -1 : links[l->parent].position);
    out.iq = (int16_t)l->iq;
    out.iv = (int16_t)l->iv;
    out.block = out.branch = -1;
    out.first = out.end = 0;
    out.kind = (int16_t)l->kind;
    out.flags = (int16_t)rbdi_emit_flags(build, l);

    rbdi_emit_angle(l, &out);
    out.ca = RBD_C(l->ca);
    out.sa = RBD_C(l->sa);
    out.cb = RBD_C(l->cb);
    out.sb = RBD_C(l->sb);
    out.r = rbdi_round3(l->X.r);
    out.d = RBD_C(l->d);
    out.rho = RBD_C(l->rho);
    out.kappa = RBD_C(l->kappa);

    out.Sigma = rbdi_round6(l->Sigma);
    out.h = rbdi_round3(l->h);
    out.mass = RBD_C(l->mass);
    out.subtree_mass = RBD_C(l->subtree_mass);
    return out;
}

/* The same of a block: its joint. */
RBDI_LOCAL rbdi_block rbdi_emit_block(const rbdi_build_link *l) {
    const rbdi_joint_fact *fact = rbdi_joint_facts(l->type);
    rbdi_block out;

    out.type = (int16_t)l->type;
    out.first = (int16_t)rbdi_first_axis(l->type);
    out.n = (int16_t)fact->nv;
    out.identity = 1;

    for (int k = 0; k < 9; ++k) {
        out.E[k] = RBD_C(l->X.E[k]);
        if (rbdi_nonzero(l->X.E[k] - (k % 4 == 0))) out.identity = 0;
    }

    return out;
}

/* Bound of the inertia that the link's k-th dof moves. */
RBDI_LOCAL rbdi_wide rbdi_build_dof_scale(const rbdi_build_link *l, int k) {
    if (l->kind != RBDI_BLOCK) return l->rho * l->scale + l->kappa * l->kappa * l->all_mass;
    return rbdi_first_axis(l->type) + k < 3 ? l->scale : l->all_mass;
}

/* The dofs of the link at position p. */
RBDI_LOCAL void rbdi_emit_dofs(const rbdi_build *build, int p) {
    const rbdi_build_link *l = &build->links[build->links[p].order];
    const rbd_body *b = &build->bodies[l->body];
    const rbdi_link *link = &build->link[p];
    rbdi_dof *dof = build->dof;
    const int n = l->kind == RBDI_BLOCK ? rbdi_joint_facts(l->type)->nv : 1;

    for (int k = 0; k < n; ++k) {
        rbdi_dof *out = &dof[link->iv + k];

        out->body = (int16_t)l->body;
        out->before = -1;

        if (k > 0) {
            out->before = (int16_t)(link->iv + k - 1);
        } else if (link->parent >= 0) {
            const rbdi_link *parent = &build->link[link->parent];
            out->before = (int16_t)(parent->iv + rbdi_link_dofs(build->m, parent) - 1);
        }

        out->level = (int16_t)(out->before < 0 ? 0 : dof[out->before].level + 1);
        out->armature = RBD_C(b->armature[l->joint_dof + k]);
        out->damping = RBD_C(b->damping[l->joint_dof + k]);
        out->friction = RBD_C(b->friction[l->joint_dof + k]);
        out->scale = RBD_C(rbdi_build_dof_scale(l, k)) + out->armature + RBDI_LEAST_SCALE;
    }
}

/* Body i in the user's frame. */
RBDI_LOCAL rbdi_frame rbdi_emit_frame(const rbdi_build *build, int i) {
    const rbd_body *b = &build->bodies[i];
    const rbdi_place *place = &build->place[i];
    rbdi_wide_pose X = place->X;
    rbdi_wide com[3], I[6];
    rbdi_frame out;

    rbdi_widen(b->com, 3, com);
    rbdi_widen(b->inertia, 6, I);
    out.link = -1;

    if (place->link >= 0) {
        out.link = (int16_t)build->links[place->link].position;
        X = rbdi_w_relative(&X, &build->links[place->link].solver);
    }

    out.name = b->name;
    out.joint = b->joint;
    out.parent = (int16_t)b->parent;
    out.type = (int16_t)b->type;
    out.iq = (int16_t)place->iq;
    out.iv = (int16_t)place->iv;
    out.nq = out.nv = 0;

    if (!b->mimic) {
        out.nq = (int16_t)rbdi_joint_facts((int)b->type)->nq;
        out.nv = (int16_t)rbdi_joint_facts((int)b->type)->nv;
    }

    for (int k = 0; k < 9; ++k) out.E[k] = RBD_C(X.E[k]);
    out.r = rbdi_round3(X.r);
    out.mass = RBD_C(b->mass);
    out.com = rbdi_round3(com);
    out.I = rbdi_round6(I);
    const int limited = rbdi_is_limited(b);
    out.lower = limited ? RBD_C(b->lower) : RBD_C(0);
    out.upper = limited ? RBD_C(b->upper) : RBD_C(0);
    out.velocity = RBD_C(b->velocity);
    out.effort = RBD_C(b->effort);
    return out;
}

/* Steps 3 to 8: from the user's frames to those of [design]. */
RBDI_LOCAL void rbdi_build_solve(rbdi_build_link *links, int nl) {
    for (int i = 0; i < nl; ++i) rbdi_build_axis(links, i);
    rbdi_build_order(links, nl);
    for (int p = nl - 1; p >= 0; --p) rbdi_build_measure(links, links[p].order);
    for (int p = 0; p < nl; ++p) rbdi_build_normalise(links, nl, links[p].order);
    for (int i = 0; i < nl; ++i)
        if (links[i].kind != RBDI_BLOCK) rbdi_build_angles(&links[i]);
    for (int p = nl - 1; p >= 0; --p) rbdi_build_scale(links, links[p].order);
    for (int p = nl - 1; p >= 0; --p) rbdi_build_regroup(links, links[p].order);

    for (int p = nl - 1; p >= 0; --p) {
        rbdi_build_link *l = &links[links[p].order];
        l->subtree_mass += l->mass;
        if (l->parent >= 0) links[l->parent].subtree_mass += l->subtree_mass;
    }
}

/* Coordinates and dofs: in the order of the bodies; those of mimic joints behind all others. */
RBDI_LOCAL void rbdi_place_coordinates(const rbdi_build *build) {
    int iq = 0, iv = 0, mimic = 0;

    for (int i = 0; i < build->nb; ++i) {
        const rbdi_joint_fact *fact = rbdi_joint_facts((int)build->bodies[i].type);
        rbdi_place *place = &build->place[i];

        place->iq = iq;
        place->iv = iv;

        if (build->bodies[i].mimic) {
            place->iq = build->n.nq + mimic;
            place->iv = build->n.nv + mimic;
            ++mimic;
        } else {
            iq += fact->nq;
            iv += fact->nv;
        }
    }
}

/* All numbers that rbd_work_size and rbd_batch_size depend on, side by side in few words to compare; and the
   first dof that moves no mass, see rbdi_massless_dof. */
RBDI_LOCAL void rbdi_shape(const rbd_model *m, int massless, uint64_t shape[RBDI_SHAPE]) {
    shape[0] = (uint64_t)m->nb << 48 | (uint64_t)m->nq << 32 | (uint64_t)m->nv << 16 | (uint64_t)m->nl;
    shape[1] = (uint64_t)(massless + 1) << 48 | (uint64_t)m->nblock << 32 | (uint64_t)m->nbranch << 16 |
               (uint64_t)m->nmimic;
    shape[2] = (uint64_t)m->nh << 32 | (uint64_t)m->nhx;
}

/* Entry (i, j) of the matrix is not zero: so one of the two must be on the other's path to the root. The
   elimination of a row fills the row of its lambda in all its other columns (RBDA 6.5): so from there on the
   two paths become one. */
RBDI_LOCAL void rbdi_couple(rbdi_dof *dof, int i, int j) {
    while (i != j) {
        const int high = i > j ? i : j, low = i > j ? j : i, next = dof[high].lambda;
        if (next < low) dof[high].lambda = (int16_t)low;
        i = low;
        j = next;
    }
}

/* The nv dofs of the matrix in depth-first order. Meanwhile dof.depth is the number of descendants, and
   dof.row where the next child goes. */
RBDI_LOCAL void rbdi_emit_nodes(rbdi_dof *dof, int nv, rbdi_node *node) {
    int32_t next = 0;

    for (int k = 0; k < nv; ++k) dof[k].depth = 0;
    for (int k = nv - 1; k >= 0; --k)
        if (dof[k].lambda >= 0) dof[dof[k].lambda].depth += (int16_t)(dof[k].depth + 1);

    for (int k = 0; k < nv; ++k) {
        int32_t *place = dof[k].lambda < 0 ? &next : &dof[dof[k].lambda].row;
        node[*place].dof = (int16_t)k;
        node[*place].descendants = dof[k].depth;
        dof[k].row = *place + 1;
        *place += dof[k].depth + 1;
    }
}

/* Step 10: the tree of the matrix. Without mimic joints it is that of the mechanism. A mimic dof couples the
   dof that it follows with those on its path to the root, and with those whose path it is on. */
RBDI_LOCAL void rbdi_emit_tree(const rbdi_build *build) {
    const int nv = build->n.nv, n = build->n.ndof;
    const rbdi_mimic *mimic = build->mimic;
    rbdi_dof *dof = build->dof;

    for (int k = 0; k < n; ++k) {
        int before = dof[k].before;
        while (before >= nv) before = dof[before].before;
        dof[k].lambda = (int16_t)(k < nv ? before : -1);
    }

    for (int k = 0; k < n; ++k)
        for (int j = dof[k].before; j >= 0; j = dof[j].before)
            if (k >= nv || j >= nv)
                rbdi_couple(dof, k < nv ? k : mimic[k - nv].source_v, j < nv ? j : mimic[j - nv].source_v);

    rbdi_emit_nodes(dof, nv, build->node);
    build->m->nh = 0;

    for (int k = 0; k < n; ++k) {
        dof[k].depth = (int16_t)(dof[k].lambda < 0 ? 0 : dof[dof[k].lambda].depth + 1);
        dof[k].row = build->m->nh;
        if (k < nv) build->m->nh += dof[k].depth + 1;
    }

    for (int k = 0; k < nv; ++k) build->node[k].row = dof[build->node[k].dof].row;
}

/* Links, blocks, branch points and dofs, in the solver's order. */
RBDI_LOCAL void rbdi_emit_links(const rbdi_build *build) {
    rbd_model *m = build->m;
    int block = 0;

    m->nbranch = 0;
    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *out = &build->link[p];

        *out = rbdi_emit_link(build, p);
        if (out->kind == RBDI_BLOCK) {
            out->block = (int16_t)block;
            build->block[block++] = rbdi_emit_block(&build->links[build->links[p].order]);
        }

        if (out->parent >= 0 && out->parent != p - 1 && build->link[out->parent].branch < 0)
            build->link[out->parent].branch = m->nbranch++;
        rbdi_emit_dofs(build, p);
    }

    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *out = &build->link[p];
        if (out->kind == RBDI_BLOCK || out->branch >= 0 || out->parent < 0 || out->parent != p - 1 ||
            (out->flags & RBDI_SHIFT_XYZ))
            out->flags |= RBDI_OFF_CHAIN;
    }
}

/* Frames of the bodies, and mimic joints, whose inertia adds to the scale of the joint that they follow. */
RBDI_LOCAL void rbdi_emit_frames(const rbdi_build *build) {
    int next = 0;

    for (int i = 0; i < build->nb; ++i) {
        build->frame[i] = rbdi_emit_frame(build, i);
        if (!build->bodies[i].mimic) continue;

        const rbdi_place *source = &build->place[rbdi_mimic_source(build->bodies, build->nb, i)];
        rbdi_mimic *out = &build->mimic[next++];

        out->source_q = (int16_t)source->iq;
        out->source_v = (int16_t)source->iv;
        out->ratio = RBD_C(build->bodies[i].mimic_ratio);
        out->offset = RBD_C(build->bodies[i].mimic_offset);
        build->dof[out->source_v].scale += out->ratio * out->ratio * build->dof[build->place[i].iv].scale;
    }
}

/* The solver's order of the dofs, with the rows that crba writes; the range of each link's subtree in it. */
RBDI_LOCAL void rbdi_emit_order(const rbdi_build *build) {
    rbd_model *m = build->m;
    int next = 0;

    m->nhx = 0;
    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *out = &build->link[p];
        out->first = (int16_t)next;
        for (int k = 0; k < rbdi_link_dofs(m, out); ++k, ++next) {
            const rbdi_dof *dof = &build->dof[out->iv + k];
            build->order[next].dof = (int16_t)(out->iv + k);
            build->order[next].row = m->nmimic ? m->nh + m->nhx : dof->row;
            if (m->nmimic) m->nhx += dof->level + 1;
        }
    }

    for (int p = 0; p < m->nl; ++p) {
        const int behind = p + build->links[build->links[p].order].size;
        build->link[p].end = behind < m->nl ? build->link[behind].first : (int16_t)next;
    }
}

/* Steps 9 and 10. */
RBDI_LOCAL void rbdi_emit(const rbdi_build *build) {
    rbd_model *m = build->m;

    m->link = build->link;
    m->block = build->block;
    m->dof = build->dof;
    m->order = build->order;
    m->node = build->node;
    m->mimic = build->mimic;
    m->frame = build->frame;

    m->version = RBD_MODEL_VERSION;
    m->scalar = (int16_t)sizeof(rbd_const);
    m->nb = (int16_t)build->nb;
    m->nq = (int16_t)build->n.nq;
    m->nv = (int16_t)build->n.nv;
    m->nl = (int16_t)build->n.nl;
    m->nblock = (int16_t)build->n.nblock;
    m->nmimic = (int16_t)build->n.nmimic;
    m->gravity.x = m->gravity.y = RBD_C(0);
    m->gravity.z = RBD_C(-9.81);

    rbdi_emit_links(build);
    rbdi_emit_frames(build);
    rbdi_emit_tree(build);
    rbdi_emit_order(build);
    m->features = rbdi_features(m) | (build->massless < 0 ? 0 : RBDI_MASSLESS);
    rbdi_shape(m, build->massless, m->shape);
}

#endif
