#ifndef RBDI_MODEL_WORK_H
#define RBDI_MODEL_WORK_H
#include "model/layout.h"

/* Interface: rbdi_block_work, rbdi_kin, rbdi_scratch, rbdi_slot */

typedef struct rbdi_scratch { /* per link, of one call */
    rbdi_force f;             /* rnea: wrench; aba: pA; children that are not the next link add theirs */
    rbdi_motion c;            /* aba: velocity-product acceleration */
    rbdi_force U_D;           /* aba: U / D */
    rbd_real u_D;             /* aba: u / D */
} rbdi_scratch;

typedef struct rbdi_slot { /* per link with a child that is not the next link: what those children share */
    rbdi_state state;      /* rnea, kinematics; aba's pass 1: omega */
    rbdi_motion y;         /* aba's pass 3 */
    rbdi_abi I;            /* aba's pass 2; pass 1 clears it */
    rbdi_rbi C;            /* crba */
} rbdi_slot;

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
    rbdi_slot *slot;             /* nslot */
    rbdi_block_work *block;      /* nblock */
    rbd_real *zero;              /* nv + nmimic zeros */
    rbd_real *pivot;             /* nv + nmimic: pivots of the last factorisation */
    rbd_real *bias;              /* nv */
    rbd_real *F;                 /* 6 x RBDI_STRIDE(n): crba: wrenches of the dofs, by component */
    rbd_real *H;                 /* nh + nhx */
    rbd_real *qx, *vx, *ax, *tx; /* with mimic joints: coordinates with the mimics' appended */
};

#endif
