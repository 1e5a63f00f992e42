#ifndef RBDI_MODEL_LAYOUT_H
#define RBDI_MODEL_LAYOUT_H
#include "api/types.h"
#include "base/types.h"
#include "algebra/types.h"

/* Interface: rbdi_block, rbdi_dof, rbdi_frame, rbdi_link, rbdi_node, rbdi_order, RBDI_ARMATURE, RBDI_BLOCK,
   RBDI_BRANCH_TURN, RBDI_MASS_KEPT, RBDI_OFF_CHAIN, RBDI_REVOLUTE, RBDI_REVOLUTE_CS, RBDI_ROOT, RBDI_SCREW,
   RBDI_SHAPE, RBDI_SHIFT_R, RBDI_SHIFT_XYZ, RBDI_SHIFT_Z, RBDI_SLIDES */

/* Pose of a frame B in a frame A: x_B = E (x_A - r), in the build's arithmetic. */
typedef struct rbdi_wide_pose {
    rbdi_wide E[9], r[3];
} rbdi_wide_pose;

/* A link during the build. Later steps overwrite fields of earlier ones. */
typedef struct rbdi_build_link {
    rbdi_wide_pose X;               /* in the parent's frame at q = 0; r is without the slide d */
    rbdi_wide Sigma[6], h[3], mass; /* second, first and zeroth moment of mass */
    rbdi_wide_pose solver;          /* solver frame in the user's link frame */
    rbdi_wide axis[3], rho, kappa;
    rbdi_wide cg, sg, ca, sa, cb, sb, d;
    rbdi_wide all_mass, radius, lever; /* of the subtree: mass, radius of gyration and first moment */
    rbdi_wide trace, moment;           /* of the subtree: bounds of its moments of mass */
    rbdi_wide scale, reach;            /* of the pivot; of the user's frames: see rbdi_build_scale */
    rbdi_wide subtree_mass;            /* regrouped */
    int parent, kind, type, iq, iv;    /* parent: index among the links being built */
    int body, joint_dof;               /* its body; its first dof among those of the body's joint */
    int size, favourite;  /* number of links in the subtree; the child that is next in the solver's order */
    int position, cursor; /* in the solver's order: its own; that of its next child */
    int order;            /* the link whose position is this one's index */
    int dh;               /* whether it has Denavit and Hartenberg's form: beta = 0, r along x */
} rbdi_build_link;

/* A body of the description during the build. */
typedef struct rbdi_place {
    rbdi_wide_pose X; /* in its link */
    int link;         /* that carries it, -1 = world */
    int moves;        /* whether its joint moves mass, inertia or armature */
    int iq, iv;
} rbdi_place;

/* Kinds of links: those that move about and along their z, and blocks, see rbdi_block. */
enum { RBDI_REVOLUTE, RBDI_REVOLUTE_CS, RBDI_SCREW, RBDI_BLOCK };

/* Flags for operations that a link's constants make necessary. The algorithms take the flags as an argument:
   the common combinations are compiled with constant flags (see RBDI_BY_FLAGS). */
enum {
    RBDI_BRANCH_TURN = 1, /* the frame is turned about the parent's z before the twist */
    RBDI_SHIFT_XYZ = 2,   /* RBDI_BRANCH_TURN, or the parent-side shift has a y or z component */
    RBDI_SHIFT_Z = 4,     /* the shift along the link's z is not always zero */
    RBDI_MASS_KEPT = 8,   /* Sigma_zz, h_z or m were not regrouped away */
    RBDI_ARMATURE = 16,   /* some degree of freedom of the joint has armature */
    RBDI_ROOT = 32,       /* the parent is the world */
    RBDI_SLIDES = 64,     /* kind is RBDI_SCREW; 128 and 256: RBDI_TWIST_90 and RBDI_TWIST_0, of alpha */
    RBDI_SHIFT_R = 512,   /* the parent-side shift is not zero */
    RBDI_OFF_CHAIN = 1024 /* not a simple link of a chain: a root, a block, a branch point, a link i whose
                               parent is not link i - 1, or one without Denavit and Hartenberg's form */
};

/* A moving link, see [design]. From the parent's frame: shift by r, turn by beta about z, twist by alpha
   about x, turn by rho q + gamma about z, slide by d + kappa q along z. A block has its pose in an
   rbdi_block. */
typedef struct rbdi_link {
    int16_t parent; /* an earlier link, -1 = world */
    int16_t iq, iv; /* first coordinate and degree of freedom */
    int16_t block;  /* index into blocks, -1 = none */
    int16_t branch; /* a branch point's index into rbd_work.branch; -1: its child, if any, is the next link */
    int16_t first, end; /* dofs of the subtree: rbd_model.order[first] .. [end - 1], its own first */
    int16_t kind, flags;
    rbd_const cg, sg;          /* cosine and sine of the joint angle at q = 0 */
    rbd_const quarters, gamma; /* that angle: 0 to 3 right angles, and the rest, at most 45 degrees */
    rbd_const ca, sa, cb, sb;  /* cosines and sines of alpha and beta */
    rbdi_c3 r;                 /* parent axes; y = z = 0 unless RBDI_SHIFT_XYZ */
    rbd_const d;               /* along the link's z */
    rbd_const rho, kappa;      /* turn and slide per unit of q */
    rbdi_csym Sigma;           /* regrouped second moment of mass about the origin, link axes */
    rbdi_c3 h;                 /* regrouped first moment */
    rbd_const mass;            /* regrouped mass */
    rbd_const subtree_mass;    /* its sum over the subtree */
} rbdi_link;

/* A joint whose motion axes are unit spatial axes first .. first + n - 1 of the link frame. */
typedef struct rbdi_block {
    int16_t type;     /* rbd_joint_type: spherical, planar, translation or floating */
    int16_t first, n; /* axes are counted omega_x .. omega_z, v_x .. v_z */
    int16_t identity; /* E is the identity */
    rbd_const E[9];   /* turns parent vectors into the joint frame, row-major */
} rbdi_block;

/* A degree of freedom; those that mimic others follow the nv that do not. */
typedef struct rbdi_dof {
    int16_t body;   /* index in the description */
    int16_t lambda; /* parent in the matrix's elimination tree, -1 = none (RBDA 6.5; see rbdi_emit_tree) */
    int32_t row;    /* where its row starts in the packed tree matrix; the diagonal is its last entry */
    int16_t depth; /* number of ancestors in that tree. Of mimic dofs lambda, row and depth have no meaning */
    int16_t before, level; /* parent and number of ancestors in the mechanism, of mimic dofs too */
    rbd_const armature, damping, friction;
    rbd_const scale; /* bound of the inertia that it moves; a pivot below RBDI_DOUBT scale is in doubt */
} rbdi_dof;

/* The dof at this index of the solver's order, depth first, and where the row of level + 1 entries begins
   that crba writes for it: the dof's own row or, with mimic joints, one behind the packed matrix. */
typedef struct rbdi_order {
    int16_t dof;
    int32_t row;
} rbdi_order;

/* A dof of the packed matrix, in a depth-first order of its tree: its descendants follow it. */
typedef struct rbdi_node {
    int16_t dof, descendants;
    int32_t row; /* dof[].row */
} rbdi_node;

/* A mimic joint: coordinate iq = ratio * q[source_q] + offset. */
typedef struct rbdi_mimic {
    int16_t source_q, source_v;
    rbd_const ratio, offset;
} rbdi_mimic;

/* A body of the description as seen by the user: its frame on a link, and its own inertia. */
typedef struct rbdi_frame {
    const char *name, *joint;
    int16_t link;   /* that carries it, -1 = world */
    int16_t parent; /* body, -1 = world */
    int16_t type;   /* rbd_joint_type */
    int16_t iq, nq, iv, nv;
    rbd_const E[9]; /* turns link vectors into body vectors, row-major */
    rbdi_c3 r;      /* origin in the link frame */
    rbd_const mass;
    rbdi_c3 com; /* body frame */
    rbdi_csym I; /* about the centre of mass, body axes */
    rbd_const lower, upper, velocity, effort;
} rbdi_frame;

#define RBDI_SHAPE 3 /* words of rbd_model.shape */

struct rbd_model {
    int16_t version, scalar; /* RBD_MODEL_VERSION, sizeof(rbd_const) */
    int16_t nb, nq, nv;      /* bodies, coordinates, degrees of freedom */
    int16_t nl, nblock, nbranch, nmimic;
    int32_t nh;              /* entries of the packed tree matrix */
    int32_t nhx;             /* with mimic joints: entries of the rows behind it, for the mechanism's dofs */
    rbdi_c3 gravity;         /* world frame */
    const rbdi_link *link;   /* nl, depth first */
    const rbdi_block *block; /* nblock */
    const rbdi_dof *dof;     /* nv + nmimic */
    const rbdi_order *order; /* nv + nmimic */
    const rbdi_node *node;   /* nv */
    const rbdi_mimic *mimic; /* nmimic */
    const rbdi_frame *frame; /* nb, in the description's order */
    uint32_t features;       /* rbdi_features */
    uint64_t shape[RBDI_SHAPE]; /* determines the sizes of a work and a batch: rbdi_shape */
};

/* For a built model as a table, which rbd-model writes: declared in every file, defined in one. */
#define RBDI_TABLE_SYMBOL(name) RBDI_PASTE(name, RBD_CONST)
#ifdef RBD_STATIC
#define RBDI_TABLE static RBDI_THERE
#define RBDI_TABLE_DECLARATION(name)
#elif defined __cplusplus
#define RBDI_TABLE
#define RBDI_TABLE_DECLARATION(name) extern "C" const rbd_model name;
#else
#define RBDI_TABLE
#define RBDI_TABLE_DECLARATION(name) extern const rbd_model name;
#endif

#endif
