#ifndef RBDI_MODEL_WORK_H
#define RBDI_MODEL_WORK_H
#include "model/layout.h"

/* Interface: rbdi_block_work, rbdi_branch, rbdi_kin, rbdi_scratch, RBDI_FIXED_STRIDE, RBDI_LINKS */

typedef struct rbdi_scratch { /* per link, of one call */
    rbdi_force f;             /* rnea: wrench; aba: pA; children that are not the next link add theirs */
    rbdi_motion c;            /* aba: velocity-product acceleration */
    rbdi_force U_D;           /* aba: U / D */
    rbd_real u_D;             /* aba: u / D */
} rbdi_scratch;

typedef struct rbdi_branch { /* per link with a child that is not the next link: what those children share */
    rbdi_state state;        /* rnea, kinematics; aba's pass 1: omega */
    rbdi_motion y;           /* aba's pass 3 */
    rbdi_abi I;              /* aba's pass 2; pass 1 clears it */
    rbdi_rbi C;              /* crba */
} rbdi_branch;

typedef struct rbdi_block_work { /* per block */
    rbdi_pose X;
    rbd_real U_D[6][6], u_D[6]; /* aba: U / D and u / D of each of its dofs */
} rbdi_block_work;

typedef struct rbdi_kin { /* per link, kept after rbd_kinematics */
    rbdi_pose X;          /* axes and origin in the world */
    rbdi_v3 v;            /* velocity of the origin, link axes */
    rbdi_state state;     /* angular velocity, angular and classical acceleration, no gravity */
} rbdi_kin;

struct rbd_work {
    uint64_t shape[RBDI_SHAPE]; /* of the model that it was made for */
    rbdi_c3 gravity;
    int singular; /* dof, -1 = none */
    int have_kinematics;
    rbd_real *rotors; /* 1: kinetic energy of the armatures */
    rbd_real *angle,
        *quarters;   /* nl, padded to RBDI_ALIGN: joint angles without their right angles; the right angles */
    rbd_real *c, *s; /* nl, padded: cosines and sines of the whole angles */
    rbd_real *d;     /* nl: slides of screw links */
    rbdi_scratch *scratch;       /* nl */
    rbdi_kin *kin;               /* nl */
    rbdi_branch *branch;         /* nbranch */
    rbdi_block_work *block;      /* nblock */
    rbd_real *zero;              /* nv + nmimic zeros */
    rbd_real *pivot;             /* nv + nmimic: pivots of the last factorisation */
    rbd_real *bias;              /* nv */
    rbd_real *F;                 /* 6 x RBDI_STRIDE(n): crba: wrenches of the dofs, by component */
    rbd_real *H;                 /* nh + nhx */
    rbd_real *qx, *vx, *ax, *tx; /* with mimic joints: coordinates with the mimics' appended */
};

/* From one component of crba's wrenches to the next, of n dofs. Where memory is plenty it is a number that
   the compiler knows, for up to 64 dofs: that saves a tenth of the mass matrix's time, a fifth in lanes. */
#if (defined __x86_64__ || defined __aarch64__) && RBDI_REAL_KIND % 3
#define RBDI_FIXED_STRIDE 80
#else
#define RBDI_FIXED_STRIDE 0
#endif
#define RBDI_STRIDE(n) ((n) + RBDI_CHUNK > RBDI_FIXED_STRIDE ? (n) + RBDI_CHUNK : RBDI_FIXED_STRIDE)
/* Bytes of the arrays of a work: nl links, k blocks, s branch points, n dofs with mimics, n_q coordinates
   with mimics (0 without mimics), nv dofs without, h packed entries. */
#define RBDI_WORK_BYTES(nl, k, s, n, n_q, nv, h) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_work)) + 4 * RBDI_ROUND((size_t)(nl) * sizeof(rbd_real)) + \
     (size_t)(nl) * (sizeof(rbd_real) + sizeof(rbdi_scratch) + sizeof(rbdi_kin)) + \
     (size_t)(k) * sizeof(rbdi_block_work) + (size_t)(s) * sizeof(rbdi_branch) + \
     sizeof(rbd_real) * (1 + 2 * (size_t)(n) + 6 * (size_t)RBDI_STRIDE(n) + (size_t)(nv) + (size_t)(h) + \
                         ((n_q) > 0 ? (size_t)(n_q) + 3 * (size_t)(n) : 0)))

/* Most links that nb bodies with nv dofs can need: universal and cylindrical joints take two, Euler
   joints three. Branch points have two children, blocks have three dofs at least. */
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
