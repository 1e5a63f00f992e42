#ifndef RBDI_API_TASKS_H
#define RBDI_API_TASKS_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"
#include "api/qp.h"

#define rbd_tasks_velocity RBDI_SYMBOL(rbd_tasks_velocity)
#define rbd_tasks_acceleration RBDI_SYMBOL(rbd_tasks_acceleration)
#define rbd_tasks_size RBDI_SYMBOL(rbd_tasks_size)
#define rbd_tasks_text RBDI_SYMBOL(rbd_tasks_text)

/* ---- tasks [tasks] ---- */

typedef enum rbd_task_kind {
    RBD_TASK_POINT = 1, /* a point of the body at a place: 3 rows */
    RBD_TASK_POSE,      /* the body turned to a rotation, and the point at a place: 6 rows */
    RBD_TASK_ROTATION,  /* the body turned to a rotation: 3 rows */
    RBD_TASK_AXIS,      /* an axis of the body along a direction; the turn about it is free: 3 rows */
    RBD_TASK_COM,       /* the centre of mass of the robot at a place: 3 rows */
    RBD_TASK_MOMENTUM,  /* its momentum, angular about its centre of mass, and linear: 6 rows */
    RBD_TASK_RELATIVE,  /* the pose of the body in the axes of another, `reference`: 6 rows */
    RBD_TASK_POSTURE,   /* all joints at q: nv rows */
    RBD_TASK_ROWS       /* rows of your own, J x = y */
} rbd_task_kind;

#define RBD_TASK_LEVELS 3

/* One wish, of the form J x = y. Zero is a sensible default for every field that the kind needs not; a kind
   of 0 is an error, so that a forgotten task is not a wish. With e from where it is to where it shall be, u
   its velocity and k the gain,
       velocities      y = velocity + k e
       accelerations   y = acceleration + k^2 e + 2 damping k (velocity - u) - dJ/dt v
   A momentum h has no e: y = velocity, or acceleration + k (velocity - h), less what h gains without x. */
typedef struct rbd_task {
    rbd_task_kind kind;
    int level;        /* 0 to RBD_TASK_LEVELS - 1: no task makes one of a lower level worse */
    rbd_real weight;  /* of the squares of its rows, beside the tasks of its level, above 0; 0: 1 */
    rbd_real gain;    /* k, 1/s; 0: the velocity and acceleration alone */
    rbd_real damping; /* 0 is 1: as fast as it goes without overshoot */

    int body;          /* index in the description; centre of mass, momentum, posture and rows have none */
    int reference;     /* of RBD_TASK_RELATIVE: the other body; -1: the world */
    rbd_real point[3]; /* of the body, link axes, m: that of the tool, say; 0: the link's origin */

    rbd_real position[3]; /* where the point or centre of mass shall be, m, world; RELATIVE: reference axes */
    rbd_real rotation[9]; /* 3 x 3, from link axes to these axes, as of rbd_body_pose; all 0 = identity */
    rbd_real axis[3];     /* of the body, link axes, of a length of 1e-9 to 1e9 */
    rbd_real direction[3]; /* where the axis shall point, world axes, of such a length */

    /* Wanted (omega; v) and its rate, of the point, in the axes of `position`; of a momentum (kg m^2/s;
       kg m/s) and its rate. A kind of 3 rows reads its three, POINT and COM
       the last, the others the first, and refuses others that are not 0, as it does those of `loose`. */
    rbd_real velocity[6], acceleration[6];
    unsigned char loose[6]; /* not 0: this row, angular x y z or linear x y z, does not count */

    const rbd_real *q;       /* POSTURE: nq */
    const rbd_real *v, *a;   /* POSTURE: nv, wanted velocity and acceleration; NULL: 0 */
    const rbd_real *weights; /* POSTURE: nv, each dof's, times `weight`; 0: does not count. NULL: 1, but 0 of
                                passive dofs */
    int rows;                /* ROWS: how many */
    const rbd_real *jacobian, *y; /* ROWS: rows x nv; rows */
} rbd_task;

/* A point of a body that touches the ground and is held there; a flat foot has several. */
typedef struct rbd_task_contact {
    int body;           /* index in the description */
    int open;           /* not 0: in the air. No row and no force, but it keeps its place in the array */
    rbd_real point[3];  /* of the body, link axes, m */
    rbd_real normal[3]; /* of the ground, world axes, towards the robot; all 0: z */
    rbd_real friction;  /* mu, 0 or more */
    int sides;          /* of the pyramid within the cone of friction, 4 or 8 [4] */
    rbd_real least;     /* N: the normal force is at least that, 0 or more */
    rbd_real most;      /* N, and at most; 0: any */
    rbd_real cost;      /* of each newton squared [that of the problem] */
    rbd_real gain;      /* 1/s: a velocity of the point decays so fast [20] */
} rbd_task_contact;

/* ---- problem [problem of tasks] ---- */

/* Limits that do not count: rbd_tasks.without is their sum; other numbers are an error. */
typedef enum rbd_tasks_without {
    RBD_WITHOUT_POSITION = 1,
    RBD_WITHOUT_SPEED = 2,
    RBD_WITHOUT_TORQUE = 4
} rbd_tasks_without;

/* What shall be done in one tick. Keep it and change what moves. 0 is the default in brackets. */
typedef struct rbd_tasks {
    const rbd_task *task;
    int tasks;
    const rbd_task_contact *contact;
    int contacts;
    rbd_real dt; /* s: until the next tick, above 0 */

    /* Limits of dofs, nv each. NULL: those of the model, of joints with one dof and of their mimics. A joint
       that others mimic keeps their limits too. Its torque is at most its own limit, and at most |ratio|
       times that of each mimic: so no motor has too much, even if one alone gives all of it. */
    const rbd_real *lower;  /* rad or m, of joints with one coordinate; -RBD_QP_NONE and less: none */
    const rbd_real *upper;  /* RBD_QP_NONE and more: none. If only one is given, the other side has none */
    const rbd_real *speed;  /* rad/s or m/s; 0: none */
    const rbd_real *torque; /* N m or N; 0: none */
    const rbd_real *acceleration; /* rad/s^2 or m/s^2; 0: none. NULL: none */
    rbd_real braking;       /* rad/s^2 or m/s^2: limits of position and speed ask for no more, where there is
                               no limit of acceleration [10] */
    int without;            /* limits that do not count */
    rbd_real limit_weight;  /* 0: limits of position, speed and acceleration are hard. Else soft, at a cost of
                               weight e^2 / 2 where they are missed by e, rad/s or rad/s^2 */
    rbd_real torque_weight; /* and those of torque, by e in N m */

    const unsigned char *passive; /* nv flags: not 0 where no motor is. NULL: floating joints */
    const rbd_real *f_ext;        /* nb x 6, known forces, as of rbd_rnea; NULL: none */
    rbd_real motion_cost;         /* of each component of x squared, at all levels [1e-6, float 1e-4] */
    rbd_real force_cost;          /* of each newton squared [motion_cost / mass^2 of the robot] */
    int warm;  /* not 0: memory is as the last call of the same model and number of contacts left it, and
                 the QP begins with the limits that held then; x begins at 0 */
    int steps; /* of each level's QP, at most: rbd_qp_options */
} rbd_tasks;

/* Hard rows that may contradict each other. */
typedef enum rbd_tasks_part {
    RBD_TASKS_NOTHING,
    RBD_TASKS_HELD,         /* contact `at` is held */
    RBD_TASKS_FRICTION,     /* friction of contact `at` */
    RBD_TASKS_FORCE,        /* its least or largest force */
    RBD_TASKS_PASSIVE,      /* dof `at` has no motor */
    RBD_TASKS_TORQUE_LIMIT, /* of dof `at` */
    RBD_TASKS_MOTION_LIMIT  /* position, speed or acceleration, of dof `at` */
} rbd_tasks_part;

/* The result: 0 or above, if there is an answer. Below 0 all outputs are as they were. */
typedef enum rbd_tasks_status {
    RBD_TASKS_OK = 0,
    RBD_TASKS_INEXACT = 1,     /* the QP of ->level did not end well: ->qp says why, ->primal by how much hard
                                  rows are missed, as where they nearly contradict each other and x is huge.
                                  Of level 1 and 2 the answer of the level before stands */
    RBD_TASKS_INFEASIBLE = -1, /* hard rows contradict each other: result->part, ->at say which */
    RBD_TASKS_ERROR = -2       /* result->error says why */
} rbd_tasks_status;

typedef struct rbd_tasks_result {
    int steps;        /* rows of the QPs that joined or left */
    int level;        /* of the last QP */
    rbd_qp_status qp; /* its status */
    rbd_real primal;  /* of the answer: the largest miss of a hard row, as a share of its terms, summed over
                        the levels that count; or that of rbd_qp_result, if it is larger. The terms are the
                        side and the entries times x. There a component of x counts as 1 rad/s, m/s, rad/s^2
                        or m/s^2 at least, a force as what gives the robot 1 m/s^2 */
    rbd_real dual;    /* of the answer: the largest component of Hx + f + C'lambda of a QP, as a share of the
                        largest of its terms */
    rbd_tasks_part part[2]; /* INFEASIBLE: the two that contradict most; NOTHING: it is one alone */
    int at[2];              /* their contacts or dofs; -1: none */
    rbd_status error;       /* RBD_OK but after RBD_TASKS_ERROR */
    int task, contact, dof; /* after an error: where; -1: none */
    const char *field; /* after an error: of rbd_task, rbd_task_contact or rbd_tasks, or "q", "v"; or NULL */
} rbd_tasks_result;

/* ---- solve [solve of tasks] ----
   Both calls minimise, level by level, the sum of weight |J x - y|^2 of the tasks, while contacts are held
   and limits are kept. w: what rbd_kinematics left there is replaced.
   memory    size bytes of any alignment: RBD_TASKS_SIZE. Leave it alone between ticks if `warm` is set
   result    what was reached
   Errors, in result->error: RBD_ERR_NULL, but without a result RBD_TASKS_ERROR alone; _WORK; _MEMORY;
   _COUNT, a number below 0 or above 1000, or more than 20000 rows or variables of the QP; _INDEX, a body;
   _TYPE, no kind; _POSITION, _ROTATION, _AXIS; _MASS, a centre of mass of a robot without mass; _MASSLESS,
   accelerations, or a centre of mass, of one some of whose joints move none; _LIMITS, lower above upper;
   _RANGE, any other number, with its field; _NAN, q, v or f_ext is not finite, or there is an overflow. */

/* Velocities for inverse kinematics at each tick. Contacts are held by J x = 0; forces have no part in it.
   q   nq
   v   nv. In, where the problem has limits of acceleration: the velocity of the last tick. Out: x */
RBDI_API rbd_tasks_status rbd_tasks_velocity(const rbd_model *m, rbd_work *w, const rbd_tasks *problem,
                                             const rbd_real *q, void *memory, size_t size, rbd_real *v,
                                             rbd_tasks_result *result);

/* Accelerations, forces of contacts and torques that go together: M a + c = tau + sum J' f, tau = 0 of
   passive dofs, forces within friction. Herzog, Rotella, Mason and others (2016).
   q, v     nq, nv
   a        nv, out
   forces   contacts x 3, out: on the robot, world axes, N; 0 of open ones. May be NULL
   tau      nv, out: torques of the motors, without damping and friction of the joints: see rbd_passive */
RBDI_API rbd_tasks_status rbd_tasks_acceleration(const rbd_model *m, rbd_work *w, const rbd_tasks *problem,
                                                 const rbd_real *q, const rbd_real *v, void *memory,
                                                 size_t size, rbd_real *a, rbd_real *forces, rbd_real *tau,
                                                 rbd_tasks_result *result);

/* Bytes that either call needs; 0 if the problem's counts are out of range. */
RBDI_API size_t rbd_tasks_size(const rbd_model *m, const rbd_tasks *problem);

/* Writes what a status and result say as a sentence, e.g. "task 1, field 'body': no such body", or "the
   torque of dof 8 contradicts the friction of contact 2", cut to fit, always terminated. text: size bytes.
   Returns text. */
RBDI_API char *rbd_tasks_text(rbd_tasks_status status, const rbd_tasks_result *result, char *text,
                              size_t size);

#endif
