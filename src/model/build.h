#ifndef RBDI_MODEL_BUILD_H
#define RBDI_MODEL_BUILD_H
#include "api/model.h"
#include "model/emit.h"

/* Cuts the model and the build's own scratch off the memory. */
static void rbdi_build_take(rbdi_build *b, void *memory) {
    const rbdi_counts n = b->n;
    unsigned char *p = rbdi_aligned(memory);
    b->m = (rbd_model *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_model)));
    b->link = (rbdi_link *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n.nl * sizeof(rbdi_link)));
    b->block = (rbdi_block *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n.nblock * sizeof(rbdi_block)));
    b->dof = (rbdi_dof *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n.ndof * sizeof(rbdi_dof)));
    b->order = (rbdi_order *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n.ndof * sizeof(rbdi_order)));
    b->node = (rbdi_node *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n.ndof * sizeof(rbdi_node)));
    b->mimic = (rbdi_mimic *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n.nmimic * sizeof(rbdi_mimic)));
    b->frame = (rbdi_frame *)rbdi_take(&p, 1, RBDI_ROUND((size_t)b->nb * sizeof(rbdi_frame)));
    b->links = (rbdi_build_link *)rbdi_take(&p, 1, RBDI_ROUND((size_t)n.nl * sizeof(rbdi_build_link)));
    b->place = (rbdi_place *)rbdi_take(&p, b->nb, sizeof(rbdi_place));
}

RBDI_API size_t rbd_model_size(const rbd_body *bodies, int nb) {
    if (!bodies || nb < 1 || nb > RBD_MAX_BODIES) return 0;
    return rbdi_model_bytes(rbdi_count(bodies, nb), nb);
}

RBDI_API rbd_status rbd_model_build(const rbd_body *bodies, int nb, void *memory, size_t size,
                                    const rbd_model **model, rbd_report *report) {
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
    rbdi_build b;
    b.bodies = bodies, b.nb = nb, b.n = rbdi_count(bodies, nb);
    if (size < rbdi_model_bytes(b.n, nb)) return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);
    rbdi_build_take(&b, memory);
    rbdi_place_coordinates(bodies, nb, b.n, b.place);
    for (int i = 0, nl = 0; i < nb; ++i) {
        rbdi_build_joint(bodies, i, b.place, b.links, &nl);
        rbdi_build_mass(&bodies[i], &b.place[i], b.links);
    }
    if (rbdi_check_moves(bodies, nb, b.place, report)) return RBD_ERR_LEAF;
    rbdi_build_solve(b.links, b.n.nl);
    rbdi_emit(&b);
    *model = b.m;
    return RBD_OK;
}

#endif
