#ifndef RBDI_MODEL_FEATURES_H
#define RBDI_MODEL_FEATURES_H
#include "model/layout.h"
#include "base/compiler.h"

/* Interface: rbdi_block_of, rbdi_flags, rbdi_is, rbdi_massless_dof, rbdi_mimics, rbdi_on_world,
   rbdi_supported, RBDI_FEATURES, RBDI_OTHER_BLOCKS */

/* ---- features [features] ----
   The features of a model, as bits: flags that some link has, flags that some link has not, kinds of links,
   mimic joints, and blocks other than floating bases. RBD_FEATURES are those of all models of the program;
   its default is all. The algorithms get flags, kinds, mimic joints and blocks from these functions, so that
   the compiler drops code that no model needs. */

#define RBDI_FLAGS 2047u /* all flags of links */
#define RBDI_LACKS(flags) ((uint32_t)(flags) << 11)
#define RBDI_KIND_BIT(kind) (UINT32_C(1) << (22 + (kind)))
#define RBDI_MIMICS (UINT32_C(1) << 26)
#define RBDI_OTHER_BLOCKS (UINT32_C(1) << 27) /* not floating on the world, in its axes */
#define RBDI_ALL_FEATURES UINT32_C(0xfffffff)
#define RBDI_MASSLESS (UINT32_C(1) << 28) /* a joint moves no mass: no code, and none of dynamics */
#ifdef RBD_FEATURES
#define RBDI_FEATURES ((uint32_t)(RBD_FEATURES))
#else
#define RBDI_FEATURES RBDI_ALL_FEATURES
#endif

/* Flags of a link. The compiler knows those that all links of all models have, and those that none has. */
RBDI_INLINE int rbdi_flags(const rbdi_link *l) {
    const uint32_t some = RBDI_FEATURES & RBDI_FLAGS, all = some & ~(RBDI_FEATURES >> 11);
    if (RBDI_FEATURES == RBDI_ALL_FEATURES) return l->flags;
    return (int)(((uint32_t)l->flags & some) | all);
}

/* Whether a link is of this kind. */
RBDI_INLINE int rbdi_is(const rbdi_link *l, int kind) {
    const uint32_t kinds = RBDI_FEATURES >> 22 & 15u;
    return kinds == 1u << kind || ((kinds >> kind & 1u) && l->kind == kind);
}

/* The block of a link: a constant if all blocks of the program are floating bases on the world, in its
   axes. */
RBDI_INLINE const rbdi_block *rbdi_block_of(const rbd_model *m, const rbdi_link *l) {
    static const rbdi_block floating = {RBD_FLOATING, 0, 6, 1, {0}};
    return RBDI_FEATURES & RBDI_OTHER_BLOCKS ? &m->block[l->block] : &floating;
}

/* Whether the parent of a block is the world. */
RBDI_INLINE int rbdi_on_world(const rbdi_link *block) {
    return RBDI_FEATURES & RBDI_OTHER_BLOCKS ? block->parent < 0 : 1;
}

/* Features of the model that this program lacks. RBDI_MASSLESS is always one of them: no program computes
   dynamics without masses. Without Cholesky's factor mimic joints are one, because rbd_aba needs it for
   them. */
RBDI_INLINE uint32_t rbdi_missing(const rbd_model *m) {
#ifdef RBD_NO_CHOLESKY
    if (m->nmimic) return RBDI_MIMICS;
#endif
    return m->features & ~(RBDI_FEATURES & ~RBDI_MASSLESS);
}

/* Whether this program can compute the model's kinematics. */
RBDI_INLINE int rbdi_supported(const rbd_model *m) { return (rbdi_missing(m) & ~RBDI_MASSLESS) == 0; }

/* The first dof that moves no mass, -1 if there is none. It is part of the shape, so that no work of another
   model is taken: rbd_singular_dof reads it there. */
RBDI_INLINE int rbdi_massless_dof(const rbd_model *m) { return (int)(m->shape[1] >> 48) - 1; }

/* Number of mimic joints. */
RBDI_INLINE int rbdi_mimics(const rbd_model *m) { return RBDI_FEATURES & RBDI_MIMICS ? m->nmimic : 0; }

/* The features of a model. */
RBDI_PART uint32_t rbdi_features(const rbd_model *m) {
    uint32_t features = m->nmimic ? RBDI_MIMICS : 0;

    for (int i = 0; i < m->nblock; ++i)
        if (m->block[i].type != RBD_FLOATING || !m->block[i].identity) features |= RBDI_OTHER_BLOCKS;
    for (int i = 0; i < m->nl; ++i) {
        const uint32_t flags = (uint32_t)m->link[i].flags;
        features |= flags | RBDI_LACKS(~flags & RBDI_FLAGS) | RBDI_KIND_BIT(m->link[i].kind);
        if (m->link[i].kind == RBDI_BLOCK && m->link[i].parent >= 0) features |= RBDI_OTHER_BLOCKS;
    }

    return features;
}

#endif
