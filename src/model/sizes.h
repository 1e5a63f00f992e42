#ifndef RBDI_MODEL_SIZES_H
#define RBDI_MODEL_SIZES_H
#include "model/work.h"

/* Interface: RBDI_FIXED_STRIDE, RBDI_LINKS */

/* From one component of crba's wrenches to the next, of n dofs. Where memory is plenty it is a number that
   the compiler knows, for up to 64 dofs: that saves a tenth of the mass matrix's time, a fifth in lanes. */
#if (defined __x86_64__ || defined __aarch64__) && RBDI_REAL_KIND % 3
#define RBDI_FIXED_STRIDE 80
#else
#define RBDI_FIXED_STRIDE 0
#endif
#define RBDI_STRIDE(n) ((n) + RBDI_CHUNK > RBDI_FIXED_STRIDE ? (n) + RBDI_CHUNK : RBDI_FIXED_STRIDE)
/* Bytes of the arrays of a work: nl links, k blocks, s slots, n dofs with mimics, n_q coordinates with
   mimics (0 without mimics), nv dofs without, h packed entries. */
#define RBDI_WORK_BYTES(nl, k, s, n, n_q, nv, h) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_work)) + 4 * RBDI_ROUND((size_t)(nl) * sizeof(rbd_real)) + \
     (size_t)(nl) * (sizeof(rbd_real) + sizeof(rbdi_scratch) + sizeof(rbdi_kin)) + \
     (size_t)(k) * sizeof(rbdi_block_work) + (size_t)(s) * sizeof(rbdi_slot) + \
     sizeof(rbd_real) * (1 + 2 * (size_t)(n) + 6 * (size_t)RBDI_STRIDE(n) + (size_t)(nv) + (size_t)(h) + \
                         ((n_q) > 0 ? (size_t)(n_q) + 3 * (size_t)(n) : 0)))

/* Most links that nb bodies with nv dofs can need: universal and cylindrical joints take two, Euler
   joints three. Slots go to links with two children, blocks have three dofs at least. */
#define RBDI_LINKS(nb, nv) ((nb) + 2 * (nv) / 3)

/* Bytes that suffice for the work of any model with nb bodies and nv degrees of freedom, without or with
   mimic joints (compile-time bounds; rbd_work_size is exact, and less). */
#define RBD_WORK_SIZE(nb, nv) \
    RBDI_WORK_BYTES(RBDI_LINKS(nb, nv), (nv) / 3, RBDI_LINKS(nb, nv) / 2, nv, 0, nv, RBDI_TRIANGLE(nv))
#define RBD_WORK_SIZE_MIMIC(nb, nv) \
    RBDI_WORK_BYTES(RBDI_LINKS(nb, nv), (nv) / 3, RBDI_LINKS(nb, nv) / 2, (nb) + (nv), (nb) + 2 * (nv) + 1, \
                    nv, RBDI_TRIANGLE(nv) + RBDI_TRIANGLE((nb) + (nv)))
#define RBDI_TRIANGLE(n) ((size_t)(n) * ((size_t)(n) + 1) / 2)

/* Bytes that suffice to build any model of nb bodies (a compile-time bound; rbd_model_size is exact). */
#define RBD_MODEL_SIZE(nb) RBDI_MODEL_BYTES(nb, 3 * (nb), nb, 6 * (nb), nb)
#define RBDI_MODEL_BYTES(nb, nl, k, n, mimics) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_model)) + RBDI_ROUND((size_t)(nl) * sizeof(rbdi_link)) + \
     RBDI_ROUND((size_t)(k) * sizeof(rbdi_block)) + RBDI_ROUND((size_t)(n) * sizeof(rbdi_dof)) + \
     RBDI_ROUND((size_t)(n) * sizeof(rbdi_order)) + RBDI_ROUND((size_t)(n) * sizeof(rbdi_node)) + \
     RBDI_ROUND((size_t)(mimics) * sizeof(rbdi_mimic)) + RBDI_ROUND((size_t)(nb) * sizeof(rbdi_frame)) + \
     RBDI_ROUND((size_t)(nl) * sizeof(rbdi_build_link)) + RBDI_ROUND((size_t)(nb) * sizeof(rbdi_place)))

#endif
