#ifndef RBDI_MODEL_EMIT_H
#define RBDI_MODEL_EMIT_H
#include "model/joints.h"
#include "model/regroup.h"

static rbdi_c3 rbdi_round3(const rbdi_wide x[3]) {
    rbdi_c3 c;
    c.x = RBD_C(x[0]), c.y = RBD_C(x[1]), c.z = RBD_C(x[2]);
    return c;
}
static rbdi_csym rbdi_round6(const rbdi_wide x[6]) {
    rbdi_csym c;
    c.xx = RBD_C(x[0]), c.xy = RBD_C(x[1]), c.xz = RBD_C(x[2]);
    c.yy = RBD_C(x[3]), c.yz = RBD_C(x[4]), c.zz = RBD_C(x[5]);
    return c;
}

/* The joint angle at q = 0: right angles are exact where their multiple of pi would not be. */
static void rbdi_emit_angle(const rbdi_build_link *l, rbdi_link *out) {
    rbdi_wide c = l->cg, s = l->sg, next;
    int quarters = 0;
    out->cg = RBD_C(c), out->sg = RBD_C(s);
    for (; quarters < 3 && c < rbdi_w_abs(s); ++quarters) next = 0 - c, c = s, s = next;
    out->quarters = RBD_C(quarters);
    out->gamma = l->kind == RBDI_BLOCK ? RBD_C(0) : RBD_C(rbdi_w_angle(c, s));
}

/* Step 9: the solver's constants of the link at position p. */
static rbdi_link rbdi_emit_link(const rbd_body *bodies, const rbdi_build_link *links, int p) {
    const rbdi_build_link *l = &links[links[p].order];
    const rbd_body *b = &bodies[l->body];
    int block = l->kind == RBDI_BLOCK, flags = 0;
    rbdi_link out;
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
    out.parent = (int16_t)(l->parent < 0 ? -1 : links[l->parent].position);
    out.iq = (int16_t)l->iq, out.iv = (int16_t)l->iv;
    out.block = out.branch = -1;
    out.first = out.end = 0;
    out.kind = (int16_t)l->kind, out.flags = (int16_t)flags;
    rbdi_emit_angle(l, &out);
    out.ca = RBD_C(l->ca), out.sa = RBD_C(l->sa);
    out.cb = RBD_C(l->cb), out.sb = RBD_C(l->sb);
    out.r = rbdi_round3(l->X.r);
    out.d = RBD_C(l->d);
    out.rho = RBD_C(l->rho), out.kappa = RBD_C(l->kappa);
    out.Sigma = rbdi_round6(l->Sigma);
    out.h = rbdi_round3(l->h);
    out.mass = RBD_C(l->mass), out.subtree_mass = RBD_C(l->subtree_mass);
    return out;
}

static rbdi_block rbdi_emit_block(const rbdi_build_link *l) {
    const rbdi_joint_fact *fact = rbdi_joint_facts(l->type);
    rbdi_block out;
    out.type = (int16_t)l->type;
    out.first = (int16_t)fact->first, out.n = (int16_t)fact->nv;
    out.identity = 1;
    for (int k = 0; k < 9; ++k) {
        out.E[k] = RBD_C(l->X.E[k]);
        if (rbdi_nonzero(l->X.E[k] - (k % 4 == 0))) out.identity = 0;
    }
    return out;
}

/* Bound of the inertia that dof k of a link moves. */
static rbdi_wide rbdi_build_dof_scale(const rbdi_build_link *l, int k) {
    if (l->kind != RBDI_BLOCK) return l->rho * l->scale + l->kappa * l->kappa * l->all_mass;
    return rbdi_joint_facts(l->type)->first + k < 3 ? l->scale : l->all_mass;
}

/* The dofs of link p. */
static void rbdi_emit_dofs(const rbd_body *bodies, const rbd_model *m, const rbdi_build_link *links, int p,
                           rbdi_dof *dof) {
    const rbdi_build_link *l = &links[links[p].order];
    const rbd_body *b = &bodies[l->body];
    const rbdi_link *link = &m->link[p];
    const int n = l->kind == RBDI_BLOCK ? rbdi_joint_facts(l->type)->nv : 1;
    for (int k = 0; k < n; ++k) {
        rbdi_dof *d = &dof[link->iv + k];
        const rbdi_wide scale = rbdi_build_dof_scale(l, k);
        d->body = (int16_t)l->body;
        d->before = -1;
        if (k > 0) {
            d->before = (int16_t)(link->iv + k - 1);
        } else if (link->parent >= 0) {
            const rbdi_link *up = &m->link[link->parent];
            d->before = (int16_t)(up->iv + rbdi_link_dofs(m, up) - 1);
        }
        d->level = (int16_t)(d->before < 0 ? 0 : dof[d->before].level + 1);
        d->armature = RBD_C(b->armature[l->joint_dof + k]);
        d->damping = RBD_C(b->damping[l->joint_dof + k]);
        d->friction = RBD_C(b->friction[l->joint_dof + k]);
        d->scale = RBD_C(scale) + d->armature + RBDI_LEAST_SCALE;
    }
}

/* The frame of body i, as its user sees it. */
static rbdi_frame rbdi_emit_frame(const rbd_body *b, const rbdi_place *place, const rbdi_build_link *links) {
    rbdi_wide_pose X = place->X;
    rbdi_wide com[3], I[6];
    rbdi_frame out;
    rbdi_widen(b->com, 3, com);
    rbdi_widen(b->inertia, 6, I);
    out.link = -1;
    if (place->link >= 0) {
        out.link = (int16_t)links[place->link].position;
        X = rbdi_w_relative(&X, &links[place->link].solver);
    }
    out.name = b->name, out.joint = b->joint;
    out.parent = (int16_t)b->parent;
    out.type = (int16_t)b->type;
    out.iq = (int16_t)place->iq, out.iv = (int16_t)place->iv;
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
    out.lower = RBD_C(b->lower), out.upper = RBD_C(b->upper);
    out.velocity = RBD_C(b->velocity), out.effort = RBD_C(b->effort);
    return out;
}

/* Steps 3 to 8: from the users' frames to the solver's. */
static void rbdi_build_solve(rbdi_build_link *links, int nl) {
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

/* Coordinates and dofs in the order of the bodies; those of mimic joints behind all others. */
static void rbdi_place_coordinates(const rbd_body *bodies, int nb, rbdi_counts n, rbdi_place *place) {
    int iq = 0, iv = 0, mimic = 0;
    for (int i = 0; i < nb; ++i) {
        const rbdi_joint_fact *fact = rbdi_joint_facts((int)bodies[i].type);
        place[i].iq = iq, place[i].iv = iv;
        if (bodies[i].mimic) {
            place[i].iq = n.nq + mimic, place[i].iv = n.nv + mimic;
            ++mimic;
        } else {
            iq += fact->nq, iv += fact->nv;
        }
    }
}

/* Four counts side by side. */
static uint64_t rbdi_pack(int a, int b, int c, int d) {
    return (uint64_t)a << 48 | (uint64_t)b << 32 | (uint64_t)c << 16 | (uint64_t)d;
}
/* All that rbd_work_size and rbd_batch_size depend on, so that a few comparisons tell whether two models have
   the same. */
static void rbdi_shape(const rbd_model *m, uint64_t shape[RBDI_SHAPE]) {
    shape[0] = rbdi_pack(m->nb, m->nq, m->nv, m->nl);
    shape[1] = rbdi_pack(0, m->nblock, m->nbranch, m->nmimic);
    shape[2] = (uint64_t)m->nh << 32 | (uint64_t)m->nhx;
}

/* Entry (a, b) of the matrix is not zero: b joins the path from a to the root, or a the path from b.
   Eliminating a row fills the row of its lambda with what else it has (RBDA 6.5), so the two paths become
   one from there on. */
static void rbdi_couple(rbdi_dof *dof, int a, int b) {
    while (a != b) {
        const int high = a > b ? a : b, low = a > b ? b : a, next = dof[high].lambda;
        if (next < low) dof[high].lambda = (int16_t)low;
        a = low, b = next;
    }
}

/* The nv dofs of the matrix in depth-first order. Until the caller sets them, depth counts the descendants,
   and row is the next place after a dof. */
static void rbdi_emit_nodes(rbdi_dof *dof, int nv, rbdi_node *node) {
    int32_t next = 0;
    for (int k = 0; k < nv; ++k) dof[k].depth = 0;
    for (int k = nv - 1; k >= 0; --k)
        if (dof[k].lambda >= 0) dof[dof[k].lambda].depth += (int16_t)(dof[k].depth + 1);
    for (int k = 0; k < nv; ++k) {
        int32_t *place = dof[k].lambda < 0 ? &next : &dof[dof[k].lambda].row;
        node[*place].dof = (int16_t)k, node[*place].descendants = dof[k].depth;
        dof[k].row = *place + 1;
        *place += dof[k].depth + 1;
    }
}

/* Step 10: the tree of the matrix. Without mimic joints it is that of the mechanism; mimic dofs couple what
   they follow with all that lies before and behind them. */
static void rbdi_emit_tree(rbd_model *m, const rbdi_mimic *mimic, rbdi_dof *dof, rbdi_node *node) {
    const int nv = m->nv, n = nv + m->nmimic;
    for (int k = 0; k < n; ++k) {
        int up = dof[k].before;
        while (up >= nv) up = dof[up].before;
        dof[k].lambda = (int16_t)(k < nv ? up : -1);
    }
    for (int k = 0; k < n; ++k)
        for (int j = dof[k].before; j >= 0; j = dof[j].before)
            if (k >= nv || j >= nv)
                rbdi_couple(dof, k < nv ? k : mimic[k - nv].source_v, j < nv ? j : mimic[j - nv].source_v);
    rbdi_emit_nodes(dof, nv, node);
    m->nh = 0;
    for (int k = 0; k < n; ++k) {
        dof[k].depth = (int16_t)(dof[k].lambda < 0 ? 0 : dof[dof[k].lambda].depth + 1);
        dof[k].row = m->nh;
        if (k < nv) m->nh += dof[k].depth + 1;
    }
    for (int s = 0; s < nv; ++s) node[s].row = dof[node[s].dof].row;
}

/* Links, blocks, branch points and dofs, in the solver's order. */
static void rbdi_emit_links(const rbdi_build *build) {
    rbd_model *m = build->m;
    int block = 0;
    m->nbranch = 0;
    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *l = &build->link[p];
        *l = rbdi_emit_link(build->bodies, build->links, p);
        if (l->kind == RBDI_BLOCK) {
            l->block = (int16_t)block;
            build->block[block++] = rbdi_emit_block(&build->links[build->links[p].order]);
        }
        if (l->parent >= 0 && l->parent != p - 1 && build->link[l->parent].branch < 0)
            build->link[l->parent].branch = m->nbranch++;
        rbdi_emit_dofs(build->bodies, m, build->links, p, build->dof);
    }
    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *l = &build->link[p];
        if (l->kind == RBDI_BLOCK || l->branch >= 0 || l->parent < 0 || l->parent != p - 1 ||
            (l->flags & RBDI_SHIFT_XYZ))
            l->flags |= RBDI_OFF_CHAIN;
    }
}

static void rbdi_emit_frames(const rbdi_build *build) {
    int next = 0;
    for (int i = 0; i < build->nb; ++i) {
        build->frame[i] = rbdi_emit_frame(&build->bodies[i], &build->place[i], build->links);
        if (!build->bodies[i].mimic) continue;
        const rbdi_place *source = &build->place[rbdi_mimic_source(build->bodies, build->nb, i)];
        rbdi_mimic *k = &build->mimic[next++];
        k->source_q = (int16_t)source->iq, k->source_v = (int16_t)source->iv;
        k->ratio = RBD_C(build->bodies[i].mimic_ratio), k->offset = RBD_C(build->bodies[i].mimic_offset);
        build->dof[k->source_v].scale += k->ratio * k->ratio * build->dof[build->place[i].iv].scale;
    }
}

/* The solver's order of the dofs, with the rows that crba writes, and which of them a link's subtree has. */
static void rbdi_emit_order(const rbdi_build *build) {
    rbd_model *m = build->m;
    int next = 0;
    m->nhx = 0;
    for (int p = 0; p < m->nl; ++p) {
        rbdi_link *l = &build->link[p];
        l->first = (int16_t)next;
        for (int k = 0; k < rbdi_link_dofs(m, l); ++k, ++next) {
            const rbdi_dof *d = &build->dof[l->iv + k];
            build->order[next].dof = (int16_t)(l->iv + k);
            build->order[next].row = m->nmimic ? m->nh + m->nhx : d->row;
            if (m->nmimic) m->nhx += d->level + 1;
        }
    }
    for (int p = 0; p < m->nl; ++p) {
        const int behind = p + build->links[build->links[p].order].size;
        build->link[p].end = behind < m->nl ? build->link[behind].first : (int16_t)next;
    }
}

static void rbdi_emit(const rbdi_build *build) {
    rbd_model *m = build->m;
    m->link = build->link, m->block = build->block, m->dof = build->dof, m->order = build->order,
    m->node = build->node;
    m->mimic = build->mimic, m->frame = build->frame;
    m->version = RBD_MODEL_VERSION, m->scalar = (int16_t)sizeof(rbd_const);
    m->nb = (int16_t)build->nb, m->nq = (int16_t)build->n.nq, m->nv = (int16_t)build->n.nv;
    m->nl = (int16_t)build->n.nl, m->nblock = (int16_t)build->n.nblock, m->nmimic = (int16_t)build->n.nmimic;
    m->gravity.x = m->gravity.y = RBD_C(0), m->gravity.z = RBD_C(-9.81);
    rbdi_emit_links(build);
    rbdi_emit_frames(build);
    rbdi_emit_tree(m, build->mimic, build->dof, build->node);
    rbdi_emit_order(build);
    m->features = rbdi_features(m);
    rbdi_shape(m, m->shape);
}

#endif
