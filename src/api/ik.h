#ifndef RBDI_API_IK_H
#define RBDI_API_IK_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

#define rbd_ik RBDI_SYMBOL(rbd_ik)
#define rbd_ik_size RBDI_SYMBOL(rbd_ik_size)
#define rbd_ik_text RBDI_SYMBOL(rbd_ik_text)

/* ---- targets [targets] ---- */

typedef enum rbd_ik_kind {
    RBD_IK_POINT = 1, /* a point of the body at a place */
    RBD_IK_POSE,      /* the point at a place, and the body turned to a rotation */
    RBD_IK_ROTATION,  /* the body turned to a rotation */
    RBD_IK_AXIS,      /* an axis of the body along a direction; the turn about it is free */
    RBD_IK_COM        /* the centre of mass of the robot at a place */
} rbd_ik_kind;

/* One wish. Zero is a sensible default for every field that the kind needs not; a kind of 0 is an error, so
   that a forgotten target is not a wish. */
typedef struct rbd_ik_target {
    rbd_ik_kind kind;
    int body;              /* index in the description; a centre of mass has none */
    rbd_real point[3];     /* of the body, link axes, m: that of the tool, say; 0: the link's origin */
    rbd_real position[3];  /* where the point, or the centre of mass, shall be, world, m */
    rbd_real rotation[9];  /* 3 x 3, from link axes to world axes, as of rbd_body_pose; all 0 = identity */
    rbd_real axis[3];      /* of the body, link axes, of a length of 1e-9 to 1e9 */
    rbd_real direction[3]; /* where the axis shall point, world axes, of such a length */
    rbd_real weight;       /* of its squared error, beside those of the other targets; 0: 1 */
} rbd_ik_target;

/* 0 is the default in brackets. */
typedef struct rbd_ik_options {
    int starts;                /* at most [60]: the caller's q, then others; 1: from q alone */
    int evaluations;           /* of the targets, at most, 2 or more [5000]: bounds the time */
    rbd_real metres;           /* m: a target is reached if its place is this near [1e-6, float 1e-5] */
    rbd_real radians;          /* rad: and its angle [1e-6, float 1e-5] */
    rbd_real length;           /* m, 1e-9 or more: how much a radian of error counts; say reach / 3 [0.3] */
    const unsigned char *held; /* nv flags: not 0 where a degree of freedom stays as it is; NULL: none. Of a
                                  spherical, planar or floating joint all, or none */
} rbd_ik_options;

/* The result of rbd_ik: 0 if all targets are reached. Above 0 q is the nearest that was found. */
typedef enum rbd_ik_status {
    RBD_IK_REACHED = 0,
    RBD_IK_AT_LIMIT = 1,    /* not reached: a joint is at a limit, which keeps the targets away */
    RBD_IK_NEAREST = 2,     /* not reached: no small motion comes nearer, as of an arm that is too short */
    RBD_IK_EVALUATIONS = 3, /* not reached, and more evaluations might come nearer */
    RBD_IK_ERROR = -1       /* result->error says why; q is as it was */
} rbd_ik_status;

typedef struct rbd_ik_result {
    rbd_real metres;  /* m: the largest distance of a point or centre of mass from its place */
    rbd_real radians; /* rad: the largest angle of a body or axis from what it should be */
    int limit;        /* AT_LIMIT: the dof, index into v, whose limit keeps the targets away most; else -1 */
    int limits;       /* how many dofs are at such limits; with mimic joints a limit may be that of a mimic */
    int starts;       /* begun */
    int evaluations;  /* of the targets */
    rbd_status error; /* RBD_OK but after RBD_IK_ERROR */
    int target;       /* after an error: of which; -1: none */
    const char *field; /* after an error: of rbd_ik_target or rbd_ik_options, or "q"; NULL: none */
} rbd_ik_result;

/* ---- inverse kinematics [inverse kinematics] ---- */

/* Finds joint positions q within all limits for which all targets are reached; if there are none that it
   finds, those that minimise the sum of weight (metres^2 + length^2 radians^2), at least locally.
   w         what rbd_kinematics left there is replaced: call it anew before calls that read it
   targets   n of them, n at least 1; a body may have several, such as a point and an axis
   options   NULL: all defaults
   memory    size bytes of any alignment, scratch: RBD_IK_SIZE
   q         nq: where to begin, such as where the robot is; then the answer. Joints that move no target, and
             held ones, stay, to the bit
   result    what was reached
   Damped least squares (Wampler 1986) with the damping of Sugihara (2011); joints that would pass a limit are
   set on it, and the others solved for again (Flacco, De Luca and Khatib 2015).
   Errors, in result->error: RBD_ERR_NULL, but without a result RBD_IK_ERROR alone; _WORK; _MEMORY; _COUNT, n
   below 1 or above 1000; _INDEX, a body; _TYPE, no kind; _POSITION, _ROTATION, _AXIS; _MASS, a centre of mass
   of a robot without mass; _MASSLESS, that of a robot some of whose joints move none; _RANGE, a weight, an
   option or q; _INFEASIBLE, some dofs of a joint are held, not all; _NAN, q is not finite, or the errors at
   each start overflow. */
RBDI_API rbd_ik_status rbd_ik(const rbd_model *m, rbd_work *w, const rbd_ik_target *targets, int n,
                              const rbd_ik_options *options, void *memory, size_t size, rbd_real *q,
                              rbd_ik_result *result);

/* Bytes that rbd_ik needs for n targets; 0 if n is out of range. */
RBDI_API size_t rbd_ik_size(const rbd_model *m, int n);

/* Writes what a status and result say as a sentence, e.g. "target 1, field 'body': no such body", cut to
   fit, always terminated. text: size bytes. Returns text. */
RBDI_API char *rbd_ik_text(rbd_ik_status status, const rbd_ik_result *result, char *text, size_t size);

#endif
