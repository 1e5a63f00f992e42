#ifndef RBDI_API_TYPES_H
#define RBDI_API_TYPES_H

/* ---- types [types] ---- */

/* Joint types; [conventions] has their coordinates. All but fixed may stand anywhere in the tree. Built
   models and generated tables hold these numbers: another order takes another RBD_MODEL_VERSION. */
typedef enum rbd_joint_type {
    RBD_FIXED,         /* merged into the parent; the body remains as a named frame */
    RBD_REVOLUTE,      /* about axis */
    RBD_CONTINUOUS,    /* about axis, no limits */
    RBD_CONTINUOUS_CS, /* about axis, q = (cos, sin) */
    RBD_PRISMATIC,     /* along axis */
    RBD_HELICAL,       /* about axis, and pitch metres per radian along it */
    RBD_CYLINDRICAL,   /* about and along axis, independently */
    RBD_UNIVERSAL,     /* about axis, then about axis2, which the first turn moves */
    RBD_SPHERICAL,     /* quaternion */
    RBD_EULER_ZYX,     /* R = Rz(q0) Ry(q1) Rx(q2) */
    RBD_EULER_XYZ,     /* R = Rx(q0) Ry(q1) Rz(q2) */
    RBD_EULER_YXZ,     /* R = Ry(q0) Rx(q1) Rz(q2) */
    RBD_EULER_ZXY,     /* R = Rz(q0) Rx(q1) Ry(q2) */
    RBD_PLANAR,        /* in the x-y plane of the joint frame */
    RBD_TRANSLATION,   /* along x, y, z of the joint frame */
    RBD_FLOATING,      /* free */
    RBD_JOINT_TYPES    /* how many there are */
} rbd_joint_type;

/* One body and the joint that carries it: a row of the description. Zero is a sensible default for
   every field but parent (-1 = world), type (0 is fixed), mass, axis where the joint has one, and
   mimic_ratio of a joint that mimics. */
typedef struct rbd_body {
    const char *name;    /* of the link; unique, NULL = nameless */
    const char *joint;   /* name of the joint; unique, NULL = nameless */
    int parent;          /* index of an earlier body, or -1 for the world */
    rbd_joint_type type; /* of the joint */
    double axis[3];      /* in the joint frame; need not be of unit length */
    double axis2[3];     /* universal: the second axis */
    double pitch;        /* helical: m/rad */
    double position[3];  /* of the joint frame's origin in the parent's link frame */
    double rotation[9];  /* 3 x 3, joint-frame vectors into parent-frame vectors; all 0 = identity */
    double mass;         /* kg */
    double com[3];       /* centre of mass, link frame */
    double inertia[6];   /* xx xy xz yy yz zz about the centre of mass, link axes, kg m^2 */
    double armature[6];  /* per degree of freedom, entries beyond are ignored: rotor inertia seen at the
                             joint, kg m^2 or kg; in M, rnea, fd */
    double damping[6];   /* per degree of freedom, N m s or N s/m: see rbd_passive */
    double friction[6];  /* per degree of freedom, N m or N: see rbd_passive */
    double lower, upper; /* limits of a revolute, prismatic or helical joint, rad or m; both 0 = none */
    double velocity;     /* limit, rad/s or m/s, 0 = none; kept for the user */
    double effort;       /* limit, N m or N, 0 = none; kept for the user */
    const char *mimic;   /* name of the joint that this one follows, NULL = none; one-dof joints only */
    double mimic_ratio;  /* q = ratio * (q of that joint) + offset; not 0 */
    double mimic_offset; /* rad or m */
} rbd_body;

typedef struct rbd_model rbd_model; /* constants: see rbd_model_build */
typedef struct rbd_work rbd_work;   /* scratch and results of one thread: see rbd_work_init */

#endif
