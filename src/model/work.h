#ifndef RBDI_MODEL_WORK_H
#define RBDI_MODEL_WORK_H
#include "model/layout.h"

/* Interface: rbdi_block_work, rbdi_branch, rbdi_kin, rbdi_scratch, RBDI_FIXED_STRIDE, RBDI_LINKS,
   RBDI_NOTE_DOUBT, RBDI_NO_KINEMATICS */

typedef struct rbdi_scratch { /* per link, during one call */
    rbdi_force f;             /* rnea: wrench; aba: pA; children that are not the next link add theirs */
    rbdi_motion c;            /* aba: velocity-product acceleration; rbdi_momenta: velocity */
    rbdi_force U_D;           /* aba: U / D */
    rbd_real u_D;             /* aba: u / D */
} rbdi_scratch;

typedef struct rbdi_branch { /* per branch point: a link with a child that is not the next link; [design] */
    rbdi_state state;        /* for those children, in rnea and kinematics; aba's pass 1: omega */
    rbdi_motion y;           /* for them, in aba's pass 3 */
    rbdi_abi I; /* sum of their IA, in aba's pass 2; pass 1 clears it; rbdi_check_bodies: of their K */
    rbdi_rbi C; /* sum of their composite bodies, in crba */
} rbdi_branch;

typedef struct rbdi_block_work { /* per block */
    rbdi_pose X;
    rbd_real U_D[6][6], u_D[6]; /* aba: U / D and u / D of each of its dofs */
} rbdi_block_work;

typedef struct rbdi_kin { /* per link, kept for the calls after rbd_kinematics */
    rbdi_pose X;          /* axes and origin in the world */
    rbdi_v3 v;            /* velocity of the origin, link axes */
    rbdi_state state;     /* without gravity */
} rbdi_kin;

/* The arrays of a work: type, name, length. nl links, nblock blocks, nbranch branch points; ndof dofs and
   nqx coordinates with those of mimic joints (nqx = 0 without mimic joints), nv dofs without them; nh
   packed entries. */
#define RBDI_WORK_ARRAYS(ARRAY, nl, nblock, nbranch, ndof, nqx, nv, nh) \
    ARRAY(rbd_real, angle, RBDI_PADDED(nl))         /* joint angles less these right angles */ \
    ARRAY(rbd_real, quarters, RBDI_PADDED(nl))      /* right angles */ \
    ARRAY(rbd_real, cosine, RBDI_PADDED(nl))        /* of the whole angles */ \
    ARRAY(rbd_real, sine, RBDI_PADDED(nl))          /* of the whole angles */ \
    ARRAY(ptrdiff_t, start, RBDI_PADDED_STARTS(nv)) /* [packed matrix]: where rows of a matrix begin */ \
    ARRAY(rbdi_branch, branch, nbranch) \
    ARRAY(rbdi_block_work, block, nblock) \
    ARRAY(rbd_real, d, nl) /* slides of screw links */ \
    ARRAY(rbdi_scratch, scratch, nl) \
    ARRAY(rbdi_kin, kin, nl) \
    ARRAY(rbd_real, rotors, 1)   /* kinetic energy of the armatures */ \
    ARRAY(rbd_real, zero, ndof)  /* zeros */ \
    ARRAY(rbd_real, pivot, ndof) /* pivots of the last factorisation or, where one is in doubt, verdicts */ \
    ARRAY(rbd_real, bias, nv) \
    ARRAY(rbd_real, F, 6 * RBDI_STRIDE(ndof)) /* scratch of a call, behind RBDI_CHUNK zeros */ \
    ARRAY(rbd_real, H, nh) \
    ARRAY(rbd_real, qx, nqx) /* coordinates with the mimics' appended */ \
    ARRAY(rbd_real, vx, (nqx) > 0 ? (ndof) : 0) \
    ARRAY(rbd_real, ax, (nqx) > 0 ? (ndof) : 0) \
    ARRAY(rbd_real, tx, (nqx) > 0 ? (ndof) : 0)
#define RBDI_PADDED(n) (RBDI_ROUND((size_t)(n) * sizeof(rbd_real)) / sizeof(rbd_real))
#define RBDI_PADDED_STARTS(n) (RBDI_ROUND((size_t)(n) * sizeof(ptrdiff_t)) / sizeof(ptrdiff_t))
#define RBDI_ARRAY_FIELD(type, name, length) type *name;
#define RBDI_ARRAY_BYTES(type, name, length) +(size_t)(length) * sizeof(type)

enum { RBDI_NO_KINEMATICS = -2 };

struct rbd_work {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbdi_c3 gravity;
    int singular;          /* dof, -1 = none */
    int16_t kinematics_of; /* kin: of this link and its ancestors; nl: of all; -1: of the world alone */
    int16_t moving;        /* whether kin has velocities and accelerations; else rbdi_body_kin makes them 0 */
#if RBDI_REPRODUCIBLE
    int doubt; /* a pivot or a rank has been in doubt: see rbdi_batch_singly */
#endif
    RBDI_WORK_ARRAYS(RBDI_ARRAY_FIELD, 0, 0, 0, 0, 0, 0, 0)
};

#if RBDI_REPRODUCIBLE
#define RBDI_NOTE_DOUBT(w, x) (w)->doubt = (x)
#else
#define RBDI_NOTE_DOUBT(w, x) (void)(w)
#endif

/* From one component of crba's wrenches to the next, of n dofs. Where memory is plenty it is a constant for
   up to 64 dofs, which saves a tenth of the mass matrix's time, a fifth in lanes. */
#if (defined __x86_64__ || defined __aarch64__) && RBDI_REAL_KIND % 3
#define RBDI_FIXED_STRIDE 80
#else
#define RBDI_FIXED_STRIDE 0
#endif
#define RBDI_STRIDE(n) ((n) + RBDI_CHUNK > RBDI_FIXED_STRIDE ? (n) + RBDI_CHUNK : RBDI_FIXED_STRIDE)
#define RBDI_WORK_BYTES(nl, nblock, nbranch, ndof, nqx, nv, nh) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_work)) \
                      RBDI_WORK_ARRAYS(RBDI_ARRAY_BYTES, nl, nblock, nbranch, ndof, nqx, nv, nh))

/* Most links that nb bodies with nv dofs can have: universal and cylindrical joints have two, Euler joints
   three. Branch points have at least two children, blocks at least three dofs. */
#define RBDI_LINKS(nb, nv) ((nb) + 2 * (nv) / 3)

/* Bytes that suffice for the work of any model with nb bodies and nv degrees of freedom, without or with
   mimic joints (a compile-time bound; rbd_work_size is exact). */
#define RBD_WORK_SIZE(nb, nv) \
    RBDI_WORK_BYTES(RBDI_LINKS(nb, nv), (nv) / 3, RBDI_LINKS(nb, nv) / 2, nv, 0, nv, RBDI_TRIANGLE(nv))
#define RBD_WORK_SIZE_MIMIC(nb, nv) \
    RBDI_WORK_BYTES(RBDI_LINKS(nb, nv), (nv) / 3, RBDI_LINKS(nb, nv) / 2, (nb) + (nv), (nb) + 2 * (nv) + 1, \
                    nv, RBDI_TRIANGLE(nv) + RBDI_TRIANGLE((nb) + (nv)))
#define RBDI_TRIANGLE(n) ((size_t)(n) * ((size_t)(n) + 1) / 2)

/* The arrays of a model of nb bodies, and of its build: type, name, length. */
#define RBDI_MODEL_ARRAYS(ARRAY, nb, nl, nblock, ndof, nmimic) \
    ARRAY(rbdi_link, link, nl) \
    ARRAY(rbdi_block, block, nblock) \
    ARRAY(rbdi_dof, dof, ndof) \
    ARRAY(rbdi_order, order, ndof) \
    ARRAY(rbdi_node, node, ndof) \
    ARRAY(rbdi_mimic, mimic, nmimic) \
    ARRAY(rbdi_frame, frame, nb) \
    ARRAY(rbdi_build_link, links, nl) \
    ARRAY(rbdi_place, place, nb)
#define RBDI_ROUNDED_BYTES(type, name, length) +RBDI_ROUND((size_t)(length) * sizeof(type))
#define RBDI_MODEL_BYTES(nb, nl, nblock, ndof, nmimic) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_model)) \
                      RBDI_MODEL_ARRAYS(RBDI_ROUNDED_BYTES, nb, nl, nblock, ndof, nmimic))

/* Bytes that suffice to build any model of nb bodies (a compile-time bound; rbd_model_size is exact). */
#define RBD_MODEL_SIZE(nb) RBDI_MODEL_BYTES(nb, 3 * (nb), nb, 6 * (nb), nb)

#endif
