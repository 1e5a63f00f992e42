#ifndef RBDI_DERIVATIVES_MEMORY_H
#define RBDI_DERIVATIVES_MEMORY_H
#include "base/pieces.h"
#include "derivatives/common_frame.h"
#include "derivatives/entries.h"

/* Interface: rbdi_check_derivatives */

/* ---- memory [memory code] ---- */

/* 6 if the model has a free base without rotors, with all other dofs in its subtree, else 0. Its coordinates
   come first. The torque of a rotor depends on v_dot, which is not the unknown of [forward dynamics code]. */
RBDI_INLINE int rbdi_free_dofs(const rbd_model *m) {
    const rbdi_link *l = m->link;
    return m->nl > 0 && !rbdi_mimics(m) && rbdi_is(l, RBDI_BLOCK) && !(rbdi_flags(l) & RBDI_ARMATURE) &&
                   rbdi_link_dofs(m, l) == 6 && l->end == m->nv
               ? 6
               : 0;
}

/* Lanes left out behind a free base, so that the next dof begins a batch. */
RBDI_INLINE int rbdi_surplus_lanes(const rbd_model *m) {
    return (RBDI_BATCH - rbdi_free_dofs(m) % RBDI_BATCH) % RBDI_BATCH;
}

/* Number of batches that have all dofs. */
RBDI_INLINE int rbdi_batches_of(const rbd_model *m) {
    return (m->nv + rbdi_mimics(m) + rbdi_surplus_lanes(m) + RBDI_BATCH - 1) / RBDI_BATCH;
}

RBDI_API size_t rbd_derivatives_size(const rbd_model *m) {
    return m ? RBDI_DERIVATIVES_BYTES(m->nl, m->nv + rbdi_mimics(m), rbdi_batches_of(m) * RBDI_BATCH) : 0;
}

/* Whether dof k of a link only slides. */
RBDI_INLINE int rbdi_slides(const rbd_model *m, const rbdi_link *l, int k) {
    return rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->first + k - l->first >= 3
                                  : rbdi_is(l, RBDI_SCREW) && !(l->rho > 0);
}

/* Constants of link i's dofs. The last dof has the link's inertia, in axes cycled so that z is its axis. */
RBDI_PART void rbdi_init_constants(const rbd_model *m, rbd_derivatives *d, int i) {
    const rbdi_link *l = &m->link[i];
    const int last = rbdi_last_dof(m, i), z = rbdi_dof_axis(m, l, last);
    const rbd_const S[3][3] = {{l->Sigma.xx, l->Sigma.xy, l->Sigma.xz},
                               {l->Sigma.xy, l->Sigma.yy, l->Sigma.yz},
                               {l->Sigma.xz, l->Sigma.yz, l->Sigma.zz}};
    const rbd_const h[3] = {l->h.x, l->h.y, l->h.z};
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    const rbd_const own[10] = {S[x][x], S[x][y], S[x][z], S[y][y], S[y][z],
                               S[z][z], h[x],    h[y],    h[z],    l->mass};

    for (int j = 0; j < 10; ++j) RBDI_CONSTANT_OF(d, last, xx)[j * RBDI_BATCH] = own[j];

    for (int k = l->first; k <= last; ++k) {
        const int slides = rbdi_slides(m, l, k), screw = rbdi_is(l, RBDI_SCREW);
        *RBDI_CONSTANT_OF(d, k, subtree) = l->subtree_mass;
        *RBDI_CONSTANT_OF(d, k, rho) = screw ? l->rho : RBD_C(!slides);
        *RBDI_CONSTANT_OF(d, k, kappa) = screw ? l->kappa : RBD_C(slides);
    }
}

/* Adds mass and first moment m (E' com + r) of a body as described to those of its link, in axes cycled so
   that z is the last dof's. */
RBDI_PART void rbdi_init_body(const rbd_model *m, rbd_derivatives *d, const rbdi_frame *u) {
    const int last = rbdi_last_dof(m, u->link), z = rbdi_dof_axis(m, &m->link[u->link], last);
    const rbd_const *E = u->E, com[3] = {u->com.x, u->com.y, u->com.z}, r[3] = {u->r.x, u->r.y, u->r.z};
    rbd_const *out = RBDI_CONSTANT_OF(d, last, all_hx); /* and the three fields behind it */

    for (int j = 0; j < 3; ++j) {
        const int k = (z + 1 + j) % 3;
        out[j * RBDI_BATCH] += u->mass * (E[k] * com[0] + E[3 + k] * com[1] + E[6 + k] * com[2] + r[k]);
    }

    out[3 * RBDI_BATCH] += u->mass;
    d->mass += u->mass;
}

/* Whether a link only slides. */
RBDI_PART int rbdi_only_slides(const rbd_model *m, const rbdi_link *l) {
    if (rbdi_is(l, RBDI_SCREW)) return !(l->rho > 0);
    return rbdi_is(l, RBDI_BLOCK) && rbdi_block_of(m, l)->type == RBD_TRANSLATION;
}

/* Chooses the link whose origin is the common origin of a root's tree: the first that rotates or, in a chain
   of links that only slide, the last. */
RBDI_PART void rbdi_init_origin(const rbd_model *m, rbd_derivatives *d, int root, rbdi_segment *seg) {
    int i = root;
    while (i + 1 < m->nl && m->link[i + 1].parent == i && rbdi_only_slides(m, &m->link[i])) ++i;

    d->origin[i] = (int16_t)root;
    seg->origin = (int16_t)(rbdi_last_dof(m, i) + 1);
}

/* Entries of the dofs of link i, and their segment. */
RBDI_PART void rbdi_init_link(const rbd_model *m, rbd_derivatives *d, int i) {
    const rbdi_link *l = &m->link[i];
    const int n = rbdi_link_dofs(m, l), block = rbdi_is(l, RBDI_BLOCK);
    const int parent = l->parent < 0 ? -1 : rbdi_last_dof(m, l->parent);
    rbdi_segment *seg = &d->segment[d->segments > 0 ? d->segments - 1 : 0];

    for (int k = l->first; k < l->first + n; ++k) {
        rbdi_entry *e = &d->entry[k];
        e->source = m->order[k].dof;
        e->user = (int16_t)rbdi_source(m, e->source);
        e->end = l->end;
        e->joint = (int16_t)(l->first + n);
        e->parent = (int16_t)(k > l->first ? k - 1 : parent);
        e->row = e->user * m->nv;
    }

    /* a new segment, unless the link goes on with the last one */
    if (d->segments == 0 || block || seg->block || parent != l->first - 1) {
        seg = &d->segment[d->segments++];
        seg->first = l->first;
        seg->parent = (int16_t)parent;
        seg->block = (int16_t)block;
        seg->link = (int16_t)i;
        seg->origin = 0;
        if (parent < 0) rbdi_init_origin(m, d, i, seg);
    }
    seg->end = (int16_t)(l->first + n);
}

/* Assigns the lanes in the caller's order, the order of the results' rows. */
RBDI_PART void rbdi_assign_lanes(const rbd_model *m, rbd_derivatives *d) {
    for (int k = 0; k < d->n; ++k) {
        rbdi_entry *e = &d->entry[k];
        const int from = e->source + (e->source < d->base ? 0 : rbdi_surplus_lanes(m));

        d->entry[e->source].of_source = (int16_t)k;
        e->batch = (int16_t)(from / RBDI_BATCH);
        e->lane = (int16_t)(from % RBDI_BATCH);
        e->at = e->batch * RBDI_COLUMN_SIZE * RBDI_BATCH + e->lane;
    }
}

#if RBDI_BATCH > 1
/* The list of a dof that a batch with these lanes is in: 0 for lanes on the path alone, 1 for both, 2 for
   lanes in the subtree alone; -1 = none. */
RBDI_PART int rbdi_list_of(uint64_t lanes) {
    const int subtree = lanes >> RBDI_IN_SUBTREE != 0, path = lanes % ((uint64_t)1 << RBDI_IN_SUBTREE) != 0;
    if (path && subtree) return 1;
    if (subtree) return 2;
    return path ? 0 : -1;
}

/* The three lists of each dof behind a free base: batches with lanes on its path only, with both, with lanes
   in its subtree only. */
RBDI_PART void rbdi_init_relatives(rbd_derivatives *d) {
    uint64_t *lanes = d->lanes;

    for (int i = d->base; i < d->n; ++i) {
        rbdi_relatives *list = rbdi_relatives_of(d, i), *rel = list;

        /* the lanes of its relatives, by batch */
        for (int b = 0; b < d->batches; ++b) lanes[b] = 0;
        for (int j = d->entry[i].parent; j >= d->base; j = d->entry[j].parent)
            lanes[d->entry[j].batch] |= (uint64_t)1 << (RBDI_ON_PATH + d->entry[j].lane);
        for (int j = i; j < d->entry[i].end; ++j)
            lanes[d->entry[j].batch] |= (uint64_t)1 << (RBDI_IN_SUBTREE + d->entry[j].lane);

        /* list by list, each with its end */
        for (int which = 0; which < 3; ++which) {
            for (int b = d->behind; b < d->batches; ++b) {
                if (rbdi_list_of(lanes[b]) != which) continue;
                rel->batch = b;
                rel->row = (int16_t)((b - d->behind) * RBDI_BATCH);
                rel->lanes = lanes[b];
                ++rel;
            }
            rel->batch = -1;
            ++rel;
        }

        list->whole = rel - list == rbdi_relatives_length(d);
    }
}
#endif

/* The columns S of a free base's dofs, unit vectors. No call computes them anew, except for
   rbd_energy_regressors, which then restores them. */
RBDI_PART void rbdi_init_base(const rbd_derivatives *d) {
    for (int k = 0; k < d->base; ++k) {
        rbdi_store_motion(RBDI_OF(d, k, S), RBDI_BATCH, rbdi_motion0());
        RBDI_OF(d, k, S)[k * RBDI_BATCH] = rbdi_set(RBD_C(1));
    }
}

/* Lays out the memory as RBDI_DERIVATIVES_BYTES says. */
RBDI_PART rbd_derivatives *rbdi_lay_derivatives(const rbd_model *m, void *memory) {
    unsigned char *p = rbdi_aligned(memory);
    rbd_derivatives *d = (rbd_derivatives *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_derivatives)));

    d->n = m->nv + rbdi_mimics(m);
    d->base = rbdi_free_dofs(m);
    d->batches = rbdi_batches_of(m);
    d->behind = (d->base + rbdi_surplus_lanes(m)) / RBDI_BATCH;

    d->columns = (rbdi_columns *)rbdi_take(&p, d->batches, sizeof(rbdi_columns));
#if RBDI_BATCH > 1
    d->relatives = (rbdi_relatives *)rbdi_take(&p, d->n * rbdi_relatives_length(d), sizeof(rbdi_relatives));
    d->lanes = (uint64_t *)rbdi_take(&p, d->batches, sizeof(uint64_t));
#endif
    d->a = (rbd_real *)rbdi_take(&p, d->n, sizeof(rbd_real));
    d->constants = (rbdi_constants *)rbdi_take(&p, d->batches, sizeof(rbdi_constants));
    d->entry = (rbdi_entry *)rbdi_take(&p, d->n, sizeof(rbdi_entry));
    d->segment = (rbdi_segment *)rbdi_take(&p, m->nl, sizeof(rbdi_segment));
    d->origin = (int16_t *)rbdi_take(&p, m->nl, sizeof(int16_t));
    d->given = (unsigned char *)rbdi_take(&p, d->n, 1);
    return d;
}

/* Dofs, segments and lists. */
RBDI_PART void rbdi_init_order(const rbd_model *m, rbd_derivatives *d) {
    d->segments = 0;
    for (int i = 0; i < m->nl; ++i) d->origin[i] = -1;
    for (int i = 0; i < m->nl; ++i) rbdi_init_link(m, d, i);

    rbdi_assign_lanes(m, d);
#if RBDI_BATCH > 1
    rbdi_init_relatives(d);
#endif
}

/* Columns and constants. Surplus lanes stay finite. */
RBDI_PART void rbdi_init_numbers(const rbd_model *m, rbd_derivatives *d) {
    const int padded = d->batches * RBDI_BATCH;
    rbd_const *constants = (rbd_const *)d->constants;

    rbdi_clear((rbd_real *)d->columns, RBDI_COLUMN_SIZE * padded);
    for (int k = 0; k < RBDI_CONSTANT * padded; ++k) constants[k] = RBD_C(0);

    d->mass = RBD_C(0);
    for (int i = 0; i < m->nl; ++i) rbdi_init_constants(m, d, i);
    for (int b = 0; b < m->nb; ++b)
        if (m->frame[b].link >= 0) rbdi_init_body(m, d, &m->frame[b]);
    rbdi_init_base(d);
}

RBDI_API rbd_status rbd_derivatives_init(const rbd_model *m, rbd_work *w, void *memory, size_t size,
                                         rbd_derivatives **derivatives) {
    const rbd_status status = rbdi_check(m, w, memory && derivatives);
    rbd_derivatives *d;
    if (derivatives) *derivatives = NULL;
    if (status) return status;
    if (size < rbd_derivatives_size(m)) return RBD_ERR_MEMORY;

    d = rbdi_lay_derivatives(m, memory);
    for (int k = 0; k < RBDI_SHAPE; ++k) d->shape[k] = m->shape[k];
    d->model = m;
    d->work = w;
    d->keep_zeros = 0;

    rbdi_init_order(m, d);
    rbdi_init_numbers(m, d);
    *derivatives = d;
    return RBD_OK;
}

/* The checks of every call: arguments, the model that the constants are of, work. */
RBDI_INLINE rbd_status rbdi_check_derivatives(const rbd_model *m, const rbd_derivatives *d, int arrays) {
    if (!m || !d || !arrays) return RBD_ERR_NULL;
    return d->model == m ? rbdi_check_dynamics(m, d->work, 1) : RBD_ERR_WORK;
}

#endif
