#ifndef RBDI_MODEL_BUILD_H
#define RBDI_MODEL_BUILD_H
#include "api/model.h"
#include "base/pieces.h"
#include "model/emit.h"

/* Takes the model and the scratch of the build from the memory. */
RBDI_LOCAL void rbdi_build_take(rbdi_build *b, void *memory) {
    unsigned char *p = rbdi_aligned(memory);
    b->m = (rbd_model *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_model)));
#define RBDI_TAKE(type, name, length) \
    b->name = (type *)rbdi_take(&p, 1, RBDI_ROUND((size_t)(length) * sizeof(type)));
    RBDI_MODEL_ARRAYS(RBDI_TAKE, b->nb, b->n.nl, b->n.nblock, b->n.ndof, b->n.nmimic)
#undef RBDI_TAKE
}

RBDI_API size_t rbd_model_size(const rbd_body *bodies, int nb) {
    rbdi_counts n;
    if (!bodies || nb < 1 || nb > RBD_MAX_BODIES) return 0;
    n = rbdi_count(bodies, nb);
    return RBDI_MODEL_BYTES(nb, n.nl, n.nblock, n.ndof, n.nmimic);
}

/* Builds a model. kinematic: joints may move no mass. */
RBDI_LOCAL rbd_status rbdi_build_model(const rbd_body *bodies, int nb, int kinematic, void *memory,
                                       size_t size, const rbd_model **model, rbd_report *report) {
    rbd_report own;

    if (!report) report = &own;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (model) *model = NULL;
    if (!bodies || !memory || !model) return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (nb < 1 || nb > RBD_MAX_BODIES) return rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);

    for (int i = 0; i < nb; ++i) {
        const rbd_status status = rbdi_check_body(bodies, nb, i, report);
        if (status) return status;
    }
    rbdi_check_followers(bodies, nb, report);

    rbdi_build b;
    b.bodies = bodies;
    b.nb = nb;
    b.n = rbdi_count(bodies, nb);
    if (size < rbd_model_size(bodies, nb)) return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);

    rbdi_build_take(&b, memory);
    rbdi_place_coordinates(&b);

    for (int i = 0, nl = 0; i < nb; ++i) {
        rbdi_build_joint(&b, i, &nl);
        rbdi_build_mass(&bodies[i], &b.place[i], b.links);
    }

    b.massless = kinematic ? rbdi_massless_dof_of(bodies, nb, b.place) : -1;
    if (!kinematic && rbdi_check_moves(bodies, nb, b.place, report)) return RBD_ERR_LEAF;

    rbdi_build_solve(b.links, b.n.nl);
    rbdi_emit(&b);
    *model = b.m;
    return RBD_OK;
}

RBDI_API rbd_status rbd_model_build(const rbd_body *bodies, int nb, void *memory, size_t size,
                                    const rbd_model **model, rbd_report *report) {
    return rbdi_build_model(bodies, nb, 0, memory, size, model, report);
}

RBDI_API rbd_status rbd_model_build_kinematic(const rbd_body *bodies, int nb, void *memory, size_t size,
                                              const rbd_model **model, rbd_report *report) {
    return rbdi_build_model(bodies, nb, 1, memory, size, model, report);
}

#endif
