#ifndef RBDI_API_STATUS_H
#define RBDI_API_STATUS_H
#include "api/configuration.h"

/* ---- status [status] ---- */

/* The result of most functions: 0, or a negative error. An error of the build names body and field. */
typedef enum rbd_status {
    RBD_OK = 0,
    RBD_ERR_NULL = -1,        /* a required pointer is NULL */
    RBD_ERR_MEMORY = -2,      /* the memory given is too small */
    RBD_ERR_VERSION = -3,     /* the built model is of another version or scalar */
    RBD_ERR_INDEX = -4,       /* no such body */
    RBD_ERR_ORDER = -5,       /* rbd_kinematics must be called first */
    RBD_ERR_SINGULAR = -6,    /* the mass matrix is singular: rbd_singular_dof says where */
    RBD_ERR_COUNT = -7,       /* number of bodies below 1 or above RBD_MAX_BODIES, or that of constraints */
    RBD_ERR_NAME = -8,        /* a name stands twice */
    RBD_ERR_PARENT = -9,      /* parent is not an earlier body or -1 */
    RBD_ERR_TYPE = -10,       /* unknown joint type, or missing: fixed, but with an axis */
    RBD_ERR_AXIS = -11,       /* axis zero or not finite; universal: axes parallel */
    RBD_ERR_PITCH = -12,      /* not finite */
    RBD_ERR_POSITION = -13,   /* not finite */
    RBD_ERR_ROTATION = -14,   /* not finite or not orthonormal and right-handed */
    RBD_ERR_MASS = -15,       /* not finite or negative */
    RBD_ERR_COM = -16,        /* not finite */
    RBD_ERR_INERTIA = -17,    /* not finite */
    RBD_ERR_LEAF = -18,       /* a movable leaf without mass, inertia and armature */
    RBD_ERR_ARMATURE = -19,   /* not finite or negative */
    RBD_ERR_DAMPING = -20,    /* not finite or negative */
    RBD_ERR_FRICTION = -21,   /* not finite or negative */
    RBD_ERR_LIMITS = -22,     /* not finite, or a negative velocity or effort limit */
    RBD_ERR_MIMIC = -23,      /* not a one-dof joint, what it follows is missing or follows too, or ratio 0 */
    RBD_ERR_WORK = -24,       /* the work, or batch, is of another model; the set, of another work */
    RBD_ERR_NAN = -25,        /* NaN in q (rbd_singular_dof says where), v, a force or a gap; or overflow */
    RBD_ERR_RANGE = -26,      /* a gain, weight, restitution, friction, dt, option or q is out of range */
    RBD_ERR_INFEASIBLE = -27, /* constraints contradict each other */
    RBD_ERR_LEFT_OUT = -28,   /* the model needs code that RBD_FEATURES or RBD_NO_CHOLESKY leave out */
    RBD_ERR_ARITHMETIC = -29, /* RBD_REPRODUCIBLE, and arithmetic does not round as in [guarantees] */
    RBD_ERR_MASSLESS = -30,   /* built for kinematics alone, and this call needs the mass that a joint moves:
                                 rbd_singular_dof says which joint has none */
    /* warnings of the build: dynamics computes with such a body, but no real one is like this */
    RBD_WARN_INERTIA_NEGATIVE = 1, /* inertia has a negative eigenvalue */
    RBD_WARN_INERTIA_TRIANGLE = 2, /* one principal moment exceeds the sum of the others */
    RBD_WARN_INERTIA_ZERO = 3,     /* mass, but no inertia about the centre of mass */
    RBD_WARN_MASS_ZERO = 4,        /* inertia, but no mass */
    RBD_WARN_LIMITS = 5 /* lower >= upper, or limits of another type of joint: read as none; or a joint that
                           mimics another has limits that contradict the other's */
} rbd_status;

/* One sentence for a status, English, static. */
RBDI_API const char *rbd_status_string(rbd_status status);

/* One finding of the build. */
typedef struct rbd_finding {
    rbd_status status;
    int body;          /* index in the description, -1 = the whole model */
    const char *name;  /* of that body, NULL if nameless; points into the description */
    const char *field; /* of rbd_body, e.g. "inertia" */
    const char *text;  /* a sentence where the status's says too little, else NULL */
} rbd_finding;

#define RBD_MAX_WARNINGS 16
/* Findings of the build: the first error, and the warnings, of which the first RBD_MAX_WARNINGS are kept. */
typedef struct rbd_report {
    rbd_finding error; /* error.status is RBD_OK if there is none */
    int warnings;      /* number of all */
    rbd_finding warning[RBD_MAX_WARNINGS];
} rbd_report;

/* Writes a finding as a sentence, e.g. "body 3 'left_foot', field 'mass': negative or not finite",
   cut to fit, always terminated. text: size bytes. Returns text. */
RBDI_API char *rbd_finding_text(const rbd_finding *finding, char *text, size_t size);

#endif
