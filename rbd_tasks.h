/* rbd_tasks.h - whole-body control: tasks, contacts and limits in one QP, on rbd.h, rbd_ik.h and rbd_qp.h.
   Made by src/amalgamate.py from src/rbd_tasks.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Finds, at each tick of a controller, the velocities, or the accelerations with contact forces and torques,
   that do what tasks ask for as well as contacts, friction and limits allow. For all joint types, floating
   and fixed bases, and mimic joints. Implemented by the same RBD_IMPLEMENTATION as rbd.h, in the same file. A
   robot on four feet that holds its trunk still:

       #define RBD_IMPLEMENTATION
       #include "rbd_tasks.h"

       const rbd_task wishes[2] = {
           {.kind = RBD_TASK_POSE, .body = 0, .position = {0, 0, 0.6}, .gain = 10},
           {.kind = RBD_TASK_POSTURE, .q = home, .gain = 10, .weight = 1e-3}};
       rbd_task_contact feet[4] = {{.body = 4, .point = {0.33, 0, 0}, .friction = 0.6}, ...};
       rbd_tasks problem = {.task = wishes, .tasks = 2, .contact = feet, .contacts = 4, .dt = 1e-3};
       static unsigned char memory[RBD_TASKS_SIZE(NV, 6 + NV, 4, 0)];
       rbd_tasks_result result;
       for (;;) {   // each millisecond
           status = rbd_tasks_acceleration(m, w, &problem, q, v, memory, sizeof memory, a, f, tau, &result);
           problem.warm = status >= 0;
           if (status < 0) puts(rbd_tasks_text(status, &result, text, sizeof text));
       }

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [tasks] [problem of tasks] [solve of tasks]
     --- stop here if you only use it ---
     [method of tasks] [limits of motion] [checks of tasks] [contacts and dynamics] [rows of tasks] [levels]
     [contradictions] [code of tasks] [text of tasks]

   [conventions] Those of rbd.h and rbd_qp.h, beyond them:
     x            velocities; or accelerations, then forces of closed contacts
     level        tasks of level 0 come first, by weights among themselves; level 1 has what they leave
     hard, soft   what must hold; what may be missed at a cost

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it.

   [guarantees]
     Those of rbd.h: no allocation, reentrant. With RBD_TASKS_OK contacts are held, hard limits kept and the
     equations of motion solved to result->primal, a share of each row's terms that is at most 1e-7 (float
     1e-3), and mostly some roundings. With a status below 0 all outputs stay as they were. Outputs are
     finite. The bits are the same on every machine with RBD_REPRODUCIBLE.

   [limits]
     A tick costs kinematics, the mass matrix, a Jacobian for each task and contact, and a QP of nv + 3
     contacts variables for each level: see rbd_qp.h; the option `steps` bounds it. A level misses what it
     could do by what motion_cost and force_cost take: a share of some motion_cost / weight. Tasks in float
     should differ by at most three decades in weight; levels are better, and a momentum, whose rows are as
     large as masses, is best with a weight of 1 / mass^2. Friction of contacts is that of
     points: a flat foot has several, and their forces share its torsion. Contacts may contradict each other
     or limits, as where a joint is at its stop: RBD_TASKS_INFEASIBLE. Soft limits, an open contact or a lower
     `least` help. Closed loops of rbd_constraints.h are not known here; RBD_TASK_ROWS can state them softly.
     Passive joints other than floating ones must be named. Velocities look one tick ahead: they may end where
     another posture would reach further, which rbd_ik finds.
*/
#include "rbd_ik.h"
#include "rbd_qp.h"

#ifndef RBD_TASKS_H
#define RBD_TASKS_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_tasks.h is of another version than rbd.h"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/tasks.h ==== */
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

/* ==== src/rbd_tasks.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_TASKS_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

/* ==== src/base/letters_begin.h ==== */
#pragma push_macro("A")
#undef A
#pragma push_macro("C")
#undef C
#pragma push_macro("E")
#undef E
#pragma push_macro("F")
#undef F
#pragma push_macro("H")
#undef H
#pragma push_macro("I")
#undef I
#pragma push_macro("J")
#undef J
#pragma push_macro("M")
#undef M
#pragma push_macro("V")
#undef V

/* ==== src/rbd_tasks.h ==== */
#ifndef RBDI_TASKS_LAYOUT
#define RBDI_TASKS_LAYOUT

/* ==== src/tasks/layout.h ==== */
/* ---- method [method of tasks] ----
   x are the nv velocities; or the nv accelerations a, and then the forces f of the closed contacts, each
   along two tangents and the normal of its ground. Rows of the QP, after the bounds of x:

       held contacts   J a = -dJ/dt v - gain J v                     3 each; with velocities J x = 0
       dynamics        lower <= M a - J'f <= upper                   nv, if x are accelerations
       friction        along each side of the pyramid                4 or 8 each
       tasks           of levels that are solved: J x as it came out

   A row of the dynamics is an equality of a passive dof, the limits of torque of another, and torques are
   read from it. The contacts stand before it because their zeros spare work (rbd_qp.h).

   A level minimises the sum of its tasks' weight |J x - y|^2 / 2, and a little of |x|^2. For the next level
   its rows become equalities at what they reached, soft rows become hard where they are, and each limit is
   widened to hold the x that was found: so a next level always has a solution, rounding included. */

#define RBDI_TASKS_MOST 1000 /* tasks, contacts, rows of one task */
#define RBDI_TASKS_WITHOUT (RBD_WITHOUT_POSITION + RBD_WITHOUT_SPEED + RBD_WITHOUT_TORQUE) /* all */
#define RBDI_TASKS_BRAKING RBD_C(10)
#define RBDI_TASKS_HELD RBD_C(20)
#if RBDI_KIND(RBD_CONST) == 2
#define RBDI_TASKS_MOTION_COST RBD_C(1e-4)
#define RBDI_TASKS_ACCURACY RBD_C(1e-3)
#else
#define RBDI_TASKS_MOTION_COST RBD_C(1e-6)
#define RBDI_TASKS_ACCURACY RBD_C(1e-7) /* shares of rows and optimum that are good enough for a tick */
#endif
#define RBDI_TASKS_SIDES 8                        /* of a pyramid, at most */
#define RBDI_TASKS_CONTACT (1 + RBDI_TASKS_SIDES) /* limits of a contact: the normal force, the sides */

/* One tick. */
typedef struct rbdi_tasks {
    const rbd_model *m;
    rbd_work *w;
    const rbd_tasks *given;
    const rbd_real *q, *v;
    rbd_tasks_result *result;
    int accelerations;      /* whether x has them, and forces */
    int nv, n;              /* dofs, components of x */
    int closed;             /* contacts */
    int dynamics, friction; /* the first row of each kind: a row of C is counted from 0 */
    int robot;              /* rows of C before those of tasks */
    int rows;               /* of C so far */
    rbd_real missed;        /* sum over the levels of the largest miss of a row, as a share of its terms */
    size_t scratch_size;

    signed char *kept;   /* of each level, the sides at which its limits hold: see rbdi_tasks_limit */
    signed char *side;   /* n + rows: those of one QP */
    int16_t *contact;    /* closed: which */
    rbd_real *H, *f, *C; /* n x n, n, rows x n */
    rbd_real *lower, *upper, *soft; /* n + rows; a task's row has y in both until its level is solved */
    rbd_real *x, *lambda;           /* n, n + rows */
    rbd_real *found;                /* n: x of the level before */
    rbd_real *bias;                 /* nv: torque at a = 0 */
    rbd_real *J;                    /* 6 x nv: of one task or contact */
    void *scratch;                  /* memory of the QP */
} rbdi_tasks;

/* Limits that hold or not: of motions, torques and contacts. */
#define RBDI_TASKS_LIMITS(nv, contacts) (2 * (size_t)(nv) + RBDI_TASKS_CONTACT * (size_t)(contacts))

/* Bytes for nv dofs, so many rows of tasks, contacts and soft rows: variables n, rows of C. */
#define RBDI_TASKS_N(nv, contacts) ((size_t)(nv) + 3 * (size_t)(contacts))
#define RBDI_TASKS_C(nv, rows, contacts) \
    ((size_t)(nv) + (size_t)(rows) + (3 + RBDI_TASKS_SIDES) * (size_t)(contacts))
#define RBDI_TASKS_ALL(nv, rows, contacts) (RBDI_TASKS_N(nv, contacts) + RBDI_TASKS_C(nv, rows, contacts))
#define RBDI_TASKS_SCALARS(nv, rows, contacts) \
    (RBDI_TASKS_N(nv, contacts) * (RBDI_TASKS_ALL(nv, rows, contacts) + 3) + \
     4 * RBDI_TASKS_ALL(nv, rows, contacts) + 7 * (size_t)(nv))
#define RBDI_TASKS_CHARS(nv, rows, contacts) \
    (RBD_TASK_LEVELS * RBDI_TASKS_LIMITS(nv, contacts) + RBDI_TASKS_ALL(nv, rows, contacts))

/* Bytes that suffice for a model with nv degrees of freedom, a constant.
   rows       of all tasks: 6 of a pose, 3 of a point, nv of a posture
   contacts   open ones too
   soft       rows that may be soft: nv with limit_weight, nv with torque_weight, 0 if there is neither */
#define RBD_TASKS_SIZE(nv, rows, contacts, soft) \
    (RBDI_ALIGN + RBDI_ROUND(RBDI_TASKS_CHARS(nv, rows, contacts)) + \
     RBDI_ROUND((size_t)(contacts) * sizeof(int16_t)) + RBDI_ROUND(sizeof(rbdi_tasks)) + \
     RBDI_ROUND(RBDI_TASKS_SCALARS(nv, rows, contacts) * sizeof(rbd_real)) + \
     RBD_QP_SIZE(RBDI_TASKS_N(nv, contacts), RBDI_TASKS_N(nv, contacts), RBDI_TASKS_C(nv, rows, contacts), \
                 soft))

/* ==== src/rbd_tasks.h ==== */
#endif /* RBDI_TASKS_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_TASKS_IMPLEMENTED
#define RBDI_TASKS_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/tasks/bounds.h ==== */
/* ---- limits of motion [limits of motion] ----
   A dof that is s before a limit and brakes by b may be as fast as

       speed(s) = (2 s / dt) / (1 + sqrt(1 + 2 s / (b dt^2))),   the v of v^2 + 2 b dt v = 2 b s.

   Then v dt is not more than s, and as after it s' = s - v dt and v^2 = 2 b s', the next such speed is less
   by b dt at most: the limit is approached without a jump, and not passed. So it is if the dof moves by the
   mean of its velocities before and after, but for b dt^2 / 2. Del Prete (2018) calls such states viable. */

/* The most strict limits of a dof: that on its coordinate and on its velocity. */
typedef struct rbdi_tasks_range {
    rbd_real lower, upper;
} rbdi_tasks_range;

RBDI_LOCAL rbd_real rbdi_tasks_speed_before(rbd_real s, rbd_real braking, rbd_real dt) {
    const rbd_real way = rbdi_abs(s) / dt;
    const rbd_real v = 2 * way / (1 + rbdi_sqrt(1 + 2 * way / (braking * dt)));
    return s < 0 ? -v : v;
}

/* x, but not out of -most .. most. */
RBDI_INLINE rbd_real rbdi_tasks_clamp(rbd_real x, rbd_real most) {
    return rbdi_larger(-most, rbdi_smaller(x, most));
}

/* The largest speed of a dof; RBDI_UNBOUNDED: any. */
RBDI_LOCAL rbd_real rbdi_tasks_speed(const rbdi_tasks *k, int dof) {
    const rbd_model *m = k->m;
    const rbdi_frame *u = &m->frame[m->dof[dof].body];
    rbd_real speed = rbdi_set(RBDI_UNBOUNDED);
    if (k->given->without & RBD_WITHOUT_SPEED) return speed;
    if (k->given->speed) return k->given->speed[dof] > 0 ? k->given->speed[dof] : speed;

    if (u->nv == 1 && u->velocity > 0) speed = rbdi_set(u->velocity);
    for (int i = 0; i < rbdi_mimics(m); ++i) {
        const rbd_const own = m->frame[m->dof[m->nv + i].body].velocity;
        if (m->mimic[i].source_v == dof && own > 0)
            speed = rbdi_smaller(speed, rbdi_abs(rbdi_set(own / m->mimic[i].ratio)));
    }
    return speed;
}

/* How far a dof is from its limits of position; RBDI_UNBOUNDED: none. */
RBDI_LOCAL rbdi_tasks_range rbdi_tasks_way(const rbdi_tasks *k, int dof) {
    const rbd_tasks *p = k->given;
    const rbdi_frame *u = &k->m->frame[k->m->dof[dof].body];
    rbdi_tasks_range way = {-RBDI_UNBOUNDED, RBDI_UNBOUNDED};
    rbdi_ik_dof f;
    if (u->nq != 1 || (p->without & RBD_WITHOUT_POSITION)) return way;

    f.dof = (int16_t)dof;
    rbdi_ik_limits(k->m, &f);
    if (p->lower || p->upper) {
        f.lower = p->lower ? p->lower[dof] : -rbdi_set(RBDI_UNBOUNDED);
        f.upper = p->upper ? p->upper[dof] : rbdi_set(RBDI_UNBOUNDED);
    }
    if (f.lower > -RBDI_UNBOUNDED) way.lower = f.lower - k->q[u->iq];
    if (f.upper < RBDI_UNBOUNDED) way.upper = f.upper - k->q[u->iq];
    return way;
}

/* The velocities that a dof may have after this tick. Limits of position and speed ask for no more than the
   dof can brake; a dof that comes too fast passes them. */
RBDI_LOCAL rbdi_tasks_range rbdi_tasks_velocities(const rbdi_tasks *k, int dof) {
    const rbd_tasks *p = k->given;
    const rbd_real speed = rbdi_tasks_speed(k, dof);
    const int limited = p->acceleration && p->acceleration[dof] > 0;
    const rbd_real braking = limited          ? p->acceleration[dof]
                             : p->braking > 0 ? p->braking
                                              : rbdi_set(RBDI_TASKS_BRAKING);
    const rbdi_tasks_range way = rbdi_tasks_way(k, dof);
    rbdi_tasks_range v = {-speed, speed};

    if (way.lower > -RBDI_UNBOUNDED)
        v.lower = rbdi_tasks_clamp(rbdi_tasks_speed_before(way.lower, braking, p->dt), speed);
    if (way.upper < RBDI_UNBOUNDED)
        v.upper = rbdi_tasks_clamp(rbdi_tasks_speed_before(way.upper, braking, p->dt), speed);

    if (k->accelerations || limited) {
        const rbd_real slower = k->v[dof] - braking * p->dt, faster = k->v[dof] + braking * p->dt;
        v.lower = rbdi_smaller(v.lower, faster);
        v.upper = rbdi_larger(v.upper, slower);
        if (limited) {
            v.lower = rbdi_larger(v.lower, slower);
            v.upper = rbdi_smaller(v.upper, faster);
        }
    }
    return v;
}

/* The acceleration that leads to a velocity after this tick; none stays none. */
RBDI_LOCAL rbd_real rbdi_tasks_rate(const rbdi_tasks *k, int dof, rbd_real v) {
    return rbdi_abs(v) < RBDI_UNBOUNDED ? (v - k->v[dof]) / k->given->dt : v;
}

/* Bounds of x: of velocities or accelerations, and of the contacts' normal forces. */
RBDI_LOCAL void rbdi_tasks_bounds(rbdi_tasks *k) {
    const rbd_tasks *p = k->given;

    for (int i = 0; i < k->nv; ++i) {
        const rbdi_tasks_range v = rbdi_tasks_velocities(k, i);
        k->lower[i] = k->accelerations ? rbdi_tasks_rate(k, i, v.lower) : v.lower;
        k->upper[i] = k->accelerations ? rbdi_tasks_rate(k, i, v.upper) : v.upper;
        k->soft[i] = p->limit_weight;
    }

    for (int i = k->nv; i < k->n; ++i) {
        const rbd_task_contact *c = &p->contact[k->contact[(i - k->nv) / 3]];
        const int normal = (i - k->nv) % 3 == 2;
        k->lower[i] = normal ? c->least : -rbdi_set(RBDI_UNBOUNDED);
        k->upper[i] = normal && c->most > 0 ? c->most : rbdi_set(RBDI_UNBOUNDED);
        k->soft[i] = rbdi_zero();
    }
}

/* ==== src/tasks/check.h ==== */
/* ---- checks of tasks [checks of tasks] ---- */

/* Notes an error; returns it. */
RBDI_LOCAL rbd_status rbdi_tasks_refuse(rbd_tasks_result *result, rbd_status error, const char *field) {
    result->error = error;
    result->field = field;
    return error;
}

/* Whether n numbers are from `least` to `most`; NULL stands for none. */
RBDI_LOCAL int rbdi_tasks_are_within(const rbd_real *x, int n, rbd_const least, rbd_const most) {
    if (!x) return 1;

    for (int i = 0; i < n; ++i)
        if (!(x[i] >= least && x[i] <= most)) return 0;
    return 1;
}

/* Whether a rate or a weight is 0, which is a default, or neither tiny nor huge. */
RBDI_LOCAL int rbdi_tasks_is_measure(rbd_real x) {
    return rbdi_ik_within(x, RBDI_IK_MOST) && !(x > 0 && x < RBD_C(1) / RBDI_IK_MOST);
}

/* Numbers of a task by which it is scaled. */
RBDI_LOCAL rbd_status rbdi_tasks_check_scales(const rbd_task *t, rbd_tasks_result *result) {
    if (t->level < 0 || t->level >= RBD_TASK_LEVELS) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "level");
    if (!rbdi_tasks_is_measure(t->weight)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "weight");
    if (!rbdi_tasks_is_measure(t->gain)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "gain");
    if (!rbdi_tasks_is_measure(t->damping)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "damping");
    if (!rbdi_tasks_are_within(t->velocity, 6, -RBDI_IK_MOST, RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "velocity");
    if (!rbdi_tasks_are_within(t->acceleration, 6, -RBDI_IK_MOST, RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "acceleration");
    return RBD_OK;
}

/* Arrays of a posture, or rows of the caller's. */
RBDI_LOCAL rbd_status rbdi_tasks_check_arrays(const rbd_model *m, const rbd_task *t,
                                              rbd_tasks_result *result) {
    const int own = t->kind == RBD_TASK_ROWS;
    const rbd_const most = RBDI_IK_MOST;

    if (own) {
        if (t->rows < 0 || t->rows > RBDI_TASKS_MOST) return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "rows");
        if (!t->jacobian) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "jacobian");
        if (!t->y) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "y");
        if (!rbdi_tasks_are_within(t->jacobian, t->rows * m->nv, -most, most))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "jacobian");
        if (!rbdi_tasks_are_within(t->y, t->rows, -most, most))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "y");
        return RBD_OK;
    }

    if (!t->q) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "q");
    if (!rbdi_tasks_are_within(t->q, m->nq, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "q");
    if (!rbdi_tasks_are_within(t->v, m->nv, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "v");
    if (!rbdi_tasks_are_within(t->a, m->nv, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "a");
    if (!rbdi_tasks_are_within(t->weights, m->nv, 0, most))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "weights");
    return RBD_OK;
}

/* Not of NaN. */
RBDI_INLINE int rbdi_tasks_is_zero(rbd_real x) { return !(x < 0) && x <= 0; }

/* Which fields a kind reads. */
RBDI_INLINE int rbdi_tasks_turns(rbd_task_kind kind) {
    return kind == RBD_TASK_POSE || kind == RBD_TASK_ROTATION || kind == RBD_TASK_RELATIVE;
}
RBDI_INLINE int rbdi_tasks_of_robot(rbd_task_kind kind) {
    return kind == RBD_TASK_COM || kind == RBD_TASK_MOMENTUM;
}
RBDI_INLINE int rbdi_tasks_has_place(rbd_task_kind kind) {
    return kind == RBD_TASK_POINT || kind == RBD_TASK_POSE || kind == RBD_TASK_RELATIVE ||
           kind == RBD_TASK_COM;
}

/* The rows of a kind, of angular x y z and linear x y z, from the first to before the end. */
RBDI_INLINE int rbdi_tasks_first(rbd_task_kind kind) {
    return kind == RBD_TASK_POINT || kind == RBD_TASK_COM ? 3 : 0;
}
RBDI_INLINE int rbdi_tasks_end(rbd_task_kind kind) {
    return kind >= RBD_TASK_POSTURE ? 0 : kind == RBD_TASK_ROTATION || kind == RBD_TASK_AXIS ? 3 : 6;
}

/* Numbers of rows that the kind has not. */
RBDI_LOCAL rbd_status rbdi_tasks_check_unread(const rbd_task *t, rbd_tasks_result *result) {
    for (int r = 0; r < 6; ++r) {
        if (r >= rbdi_tasks_first(t->kind) && r < rbdi_tasks_end(t->kind)) continue;
        if (!rbdi_tasks_is_zero(t->velocity[r])) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "velocity");
        if (!rbdi_tasks_is_zero(t->acceleration[r]))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "acceleration");
        if (t->loose[r]) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "loose");
    }
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_tasks_check_task(const rbd_model *m, const rbd_task *t, rbd_tasks_result *result) {
    const int robot = rbdi_tasks_of_robot(t->kind), kind = (int)t->kind;
    if (kind < (int)RBD_TASK_POINT || kind > (int)RBD_TASK_ROWS)
        return rbdi_tasks_refuse(result, RBD_ERR_TYPE, "kind");
    if (rbdi_tasks_check_scales(t, result) || rbdi_tasks_check_unread(t, result)) return result->error;
    if (t->kind >= RBD_TASK_POSTURE) return rbdi_tasks_check_arrays(m, t, result);

    if (!robot && (t->body < 0 || t->body >= m->nb)) return rbdi_tasks_refuse(result, RBD_ERR_INDEX, "body");
    if (robot && !(rbd_mass(m) > 0)) return rbdi_tasks_refuse(result, RBD_ERR_MASS, "kind");
    if (robot && rbdi_massless_dof(m) >= 0) return rbdi_tasks_refuse(result, RBD_ERR_MASSLESS, "kind");
    if (t->kind == RBD_TASK_RELATIVE && (t->reference < -1 || t->reference >= m->nb))
        return rbdi_tasks_refuse(result, RBD_ERR_INDEX, "reference");

    if (!robot && !rbdi_ik_is_place(t->point)) return rbdi_tasks_refuse(result, RBD_ERR_POSITION, "point");
    if (rbdi_tasks_has_place(t->kind) && !rbdi_ik_is_place(t->position))
        return rbdi_tasks_refuse(result, RBD_ERR_POSITION, "position");
    if (rbdi_tasks_turns(t->kind) && !rbdi_ik_is_rotation(t->rotation))
        return rbdi_tasks_refuse(result, RBD_ERR_ROTATION, "rotation");
    if (t->kind == RBD_TASK_AXIS && !rbdi_ik_is_axis(t->axis))
        return rbdi_tasks_refuse(result, RBD_ERR_AXIS, "axis");
    if (t->kind == RBD_TASK_AXIS && !rbdi_ik_is_axis(t->direction))
        return rbdi_tasks_refuse(result, RBD_ERR_AXIS, "direction");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_tasks_check_contact(const rbd_model *m, const rbd_task_contact *c,
                                               rbd_tasks_result *result) {
    const int no_normal = !(c->normal[0] < 0 || c->normal[0] > 0 || c->normal[1] < 0 || c->normal[1] > 0 ||
                            c->normal[2] < 0 || c->normal[2] > 0);
    if (c->body < 0 || c->body >= m->nb) return rbdi_tasks_refuse(result, RBD_ERR_INDEX, "body");
    if (!rbdi_ik_is_place(c->point)) return rbdi_tasks_refuse(result, RBD_ERR_POSITION, "point");
    if (!rbdi_ik_is_place(c->normal) || (!no_normal && !rbdi_ik_is_axis(c->normal)))
        return rbdi_tasks_refuse(result, RBD_ERR_AXIS, "normal");

    if (!rbdi_ik_within(c->friction, RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "friction");
    if (c->sides != 0 && c->sides != 4 && c->sides != 8)
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "sides");
    if (!rbdi_ik_within(c->most, RBDI_IK_MOST)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "most");
    if (!rbdi_ik_within(c->least, c->most > 0 ? c->most : RBDI_IK_MOST))
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "least");
    if (!rbdi_tasks_is_measure(c->cost)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "cost");
    if (!rbdi_tasks_is_measure(c->gain)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "gain");
    return RBD_OK;
}

/* Limits and the problem's other numbers. */
RBDI_LOCAL rbd_status rbdi_tasks_check_limits(const rbd_model *m, const rbd_tasks *p,
                                              rbd_tasks_result *result) {
    const rbd_real *const arrays[3] = {p->speed, p->torque, p->acceleration};
    const rbd_real scales[5] = {p->braking, p->limit_weight, p->torque_weight, p->motion_cost, p->force_cost};
    const char *const names[3] = {"speed", "torque", "acceleration"};
    const char *const scale_names[5] = {"braking", "limit_weight", "torque_weight", "motion_cost",
                                        "force_cost"};

    for (result->dof = 0; result->dof < m->nv; ++result->dof) {
        const int i = result->dof;
        for (int k = 0; k < 3; ++k)
            if (arrays[k] && !rbdi_ik_within(arrays[k][i], RBDI_UNBOUNDED))
                return rbdi_tasks_refuse(result, RBD_ERR_RANGE, names[k]);
        if (p->lower && !(p->lower[i] < RBDI_UNBOUNDED))
            return rbdi_tasks_refuse(result, RBD_ERR_LIMITS, "lower");
        if (p->upper && !(p->upper[i] > -RBDI_UNBOUNDED))
            return rbdi_tasks_refuse(result, RBD_ERR_LIMITS, "upper");
        if (p->lower && p->upper && p->lower[i] > p->upper[i])
            return rbdi_tasks_refuse(result, RBD_ERR_LIMITS, "lower");
    }

    result->dof = -1;
    if (!(p->dt > 0) || !rbdi_tasks_is_measure(p->dt)) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "dt");
    for (int k = 0; k < 5; ++k)
        if (!rbdi_tasks_is_measure(scales[k]))
            return rbdi_tasks_refuse(result, RBD_ERR_RANGE, scale_names[k]);
    if (p->steps < 0) return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "steps");
    if (p->without < 0 || p->without > RBDI_TASKS_WITHOUT)
        return rbdi_tasks_refuse(result, RBD_ERR_RANGE, "without");
    return RBD_OK;
}

/* State and forces. v: NULL if it does not count. */
RBDI_LOCAL rbd_status rbdi_tasks_check_state(const rbd_model *m, const rbd_tasks *p, const rbd_real *q,
                                             const rbd_real *v, rbd_tasks_result *result) {
    const rbd_const most = RBDI_IK_MOST;
    if (!rbdi_tasks_are_within(q, m->nq, -most, most)) return rbdi_tasks_refuse(result, RBD_ERR_NAN, "q");
    if (!rbdi_tasks_are_within(v, m->nv, -most, most)) return rbdi_tasks_refuse(result, RBD_ERR_NAN, "v");
    if (!rbdi_tasks_are_within(p->f_ext, 6 * m->nb, -most, most))
        return rbdi_tasks_refuse(result, RBD_ERR_NAN, "f_ext");
    return RBD_OK;
}

/* All checks, in the order of the arguments. given: the pointers that must not be NULL are not. dynamics:
   whether masses are needed. */
RBDI_LOCAL rbd_status rbdi_tasks_check(const rbd_model *m, const rbd_work *w, const rbd_tasks *p, int given,
                                       int dynamics, size_t size, rbd_tasks_result *result) {
    const int all = p && given;
    size_t needed;
    const rbd_status status = dynamics ? rbdi_check_dynamics(m, w, all) : rbdi_check(m, w, all);
    if (status) return rbdi_tasks_refuse(result, status, NULL);
    if (p->tasks < 0 || p->tasks > RBDI_TASKS_MOST) return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "tasks");
    if (p->contacts < 0 || p->contacts > RBDI_TASKS_MOST)
        return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "contacts");
    if (p->tasks && !p->task) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "task");
    if (p->contacts && !p->contact) return rbdi_tasks_refuse(result, RBD_ERR_NULL, "contact");

    for (result->task = 0; result->task < p->tasks; ++result->task)
        if (rbdi_tasks_check_task(m, &p->task[result->task], result)) return result->error;
    result->task = -1;
    for (result->contact = 0; result->contact < p->contacts; ++result->contact)
        if (rbdi_tasks_check_contact(m, &p->contact[result->contact], result)) return result->error;
    result->contact = -1;

    if (rbdi_tasks_check_limits(m, p, result)) return result->error;
    needed = rbd_tasks_size(m, p);
    if (needed == 0) return rbdi_tasks_refuse(result, RBD_ERR_COUNT, "tasks"); /* their rows, with contacts */
    return size < needed ? rbdi_tasks_refuse(result, RBD_ERR_MEMORY, NULL) : RBD_OK;
}

/* ==== src/tasks/contacts.h ==== */
/* ---- contacts and dynamics [contacts and dynamics] ---- */

/* Appends a row with these sides; returns it, for its entries to be written. */
RBDI_LOCAL rbd_real *rbdi_tasks_append_any(rbdi_tasks *k, rbd_real lower, rbd_real upper) {
    rbd_real *row = &k->C[(ptrdiff_t)k->rows * k->n];

    k->lower[k->n + k->rows] = lower;
    k->upper[k->n + k->rows] = upper;
    k->soft[k->n + k->rows] = rbdi_zero();
    ++k->rows;
    return row;
}

/* The same of a row of zeros. */
RBDI_LOCAL rbd_real *rbdi_tasks_append(rbdi_tasks *k, rbd_real lower, rbd_real upper) {
    rbd_real *row = rbdi_tasks_append_any(k, lower, upper);
    rbdi_clear(row, k->n);
    return row;
}

/* Two tangents and the normal of a contact's ground, as rows. */
RBDI_LOCAL rbdi_mat rbdi_tasks_ground(const rbd_task_contact *c) {
    const rbdi_v3 given = rbdi_load_vec(c->normal, 1);
    const rbdi_v3 z = rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_set(RBD_C(1)));
    const rbdi_v3 n = rbdi_dot(given, given) > 0 ? rbdi_ik_unit(c->normal) : z;
    const rbdi_v3 t = rbdi_ik_across(n), u = rbdi_cross(n, t);
    return rbdi_mat_of(t.x, t.y, t.z, u.x, u.y, u.z, n.x, n.y, n.z);
}

/* Holds a contact: J a = -dJ/dt v - gain J v, or J v = 0, along the axes of its ground. */
RBDI_LOCAL void rbdi_tasks_hold(rbdi_tasks *k, const rbd_task_contact *c) {
    const rbdi_mat axes = rbdi_tasks_ground(c);
    const rbd_real gain = c->gain > 0 ? c->gain : rbdi_set(RBDI_TASKS_HELD);
    rbd_real motion[6], *row[3];
    rbdi_v3 drift;

    rbd_jacobian(k->m, k->w, c->body, c->point, RBD_WORLD_AXES, k->J);
    for (int r = 0; r < 3; ++r) row[r] = rbdi_tasks_append(k, rbdi_zero(), rbdi_zero());
    for (int i = 0; i < k->nv; ++i) {
        const rbdi_v3 along = rbdi_mul(axes, rbdi_load_vec(&k->J[3 * k->nv + i], k->nv));
        row[0][i] = along.x;
        row[1][i] = along.y;
        row[2][i] = along.z;
    }
    if (!k->accelerations) return;

    rbd_point_acceleration(k->m, k->w, c->body, c->point, RBD_WORLD_AXES, motion);
    drift = rbdi_load_vec(&motion[3], 1);
    rbd_point_velocity(k->m, k->w, c->body, c->point, RBD_WORLD_AXES, motion);
    drift = rbdi_add(drift, rbdi_scale(gain, rbdi_load_vec(&motion[3], 1)));

    drift = rbdi_scale(rbdi_set(-RBD_C(1)), rbdi_mul(axes, drift));
    rbdi_store_vec(&k->lower[k->n + k->rows - 3], 1, drift);
    rbdi_store_vec(&k->upper[k->n + k->rows - 3], 1, drift);
}

/* Whether a dof has no motor. */
RBDI_LOCAL int rbdi_tasks_is_passive(const rbdi_tasks *k, int dof) {
    if (k->given->passive) return k->given->passive[dof] != 0;
    return k->m->frame[k->m->dof[dof].body].type == RBD_FLOATING;
}

/* The largest torque of a dof; RBDI_UNBOUNDED: any. That of a mimic, x = ratio q, comes to ratio times its
   own: whichever of the joints bears all, none bears more than its limit. */
RBDI_LOCAL rbd_real rbdi_tasks_torque(const rbdi_tasks *k, int dof) {
    const rbd_model *m = k->m;
    const rbdi_frame *u = &m->frame[m->dof[dof].body];
    rbd_real most = rbdi_set(RBDI_UNBOUNDED);
    if (k->given->without & RBD_WITHOUT_TORQUE) return most;
    if (k->given->torque) return k->given->torque[dof] > 0 ? k->given->torque[dof] : most;

    if (u->nv == 1 && u->effort > 0) most = rbdi_set(u->effort);
    for (int i = 0; i < rbdi_mimics(m); ++i) {
        const rbd_const own = m->frame[m->dof[m->nv + i].body].effort;
        if (m->mimic[i].source_v == dof && own > 0)
            most = rbdi_smaller(most, rbdi_abs(rbdi_set(own * m->mimic[i].ratio)));
    }
    return most;
}

/* Rows of the dynamics: -most <= M a - J'f + bias <= most, most = 0 of passive dofs. M: nv x nv. */
RBDI_LOCAL void rbdi_tasks_put_dynamics(rbdi_tasks *k, const rbd_real *M) {
    k->dynamics = k->rows;
    for (int i = 0; i < k->nv; ++i) {
        const int passive = rbdi_tasks_is_passive(k, i);
        const rbd_real most = passive ? rbdi_zero() : rbdi_tasks_torque(k, i);
        const int limited = most < RBDI_UNBOUNDED;
        rbd_real *row = rbdi_tasks_append_any(k, limited ? -most - k->bias[i] : -most,
                                              limited ? most - k->bias[i] : most);

        for (int j = 0; j < k->nv; ++j) row[j] = M[i * k->nv + j];
        for (int j = 0; j < 3 * k->closed; ++j) row[k->nv + j] = -k->C[(ptrdiff_t)j * k->n + i];
        if (!passive) k->soft[k->n + k->rows - 1] = k->given->torque_weight;
    }
}

/* Rows of friction: along each side of the pyramid, whose edges lie on the cone, f is at most
   mu cos(pi / sides) of the normal force. */
RBDI_LOCAL void rbdi_tasks_put_friction(rbdi_tasks *k) {
    const rbd_const diagonal = RBD_C(0.70710678118654752440); /* of a square; cos(pi / 4) */
    const rbd_const octagon = RBD_C(0.92387953251128675613);  /* cos(pi / 8) */
    const rbd_const cosine[8] = {1, diagonal, 0, -diagonal, -1, -diagonal, 0, diagonal};

    k->friction = k->rows;
    for (int i = 0; i < k->closed; ++i) {
        const rbd_task_contact *c = &k->given->contact[k->contact[i]];
        const int step = c->sides == 8 ? 1 : 2;
        const rbd_real share = c->friction * (c->sides == 8 ? octagon : diagonal);

        for (int side = 0; side < 8; side += step) {
            rbd_real *row = rbdi_tasks_append(k, -rbdi_set(RBDI_UNBOUNDED), rbdi_zero()) + k->nv + 3 * i;
            row[0] = rbdi_set(cosine[side]);
            row[1] = rbdi_set(cosine[(side + 6) % 8]);
            row[2] = -share;
        }
    }
}

/* All rows but those of tasks, and what rbd_kinematics leaves in w. The mass matrix passes through the memory
   of the QP. */
RBDI_LOCAL void rbdi_tasks_put_robot(rbdi_tasks *k) {
    rbd_real *M = (rbd_real *)k->scratch;

    if (k->accelerations) {
        rbd_crba(k->m, k->w, k->q, M);
        rbd_bias(k->m, k->w, k->q, k->v, k->given->f_ext, k->bias);
    }
    rbd_kinematics(k->m, k->w, k->q, k->accelerations ? k->v : NULL, NULL);

    k->rows = 0;
    for (int i = 0; i < k->closed; ++i) rbdi_tasks_hold(k, &k->given->contact[k->contact[i]]);
    k->dynamics = k->rows;
    k->friction = k->rows;
    k->robot = k->rows;
    if (!k->accelerations) return;
    rbdi_tasks_put_dynamics(k, M);
    rbdi_tasks_put_friction(k);
    k->robot = k->rows;
}

/* ==== src/tasks/rows.h ==== */
/* ---- rows of tasks [rows of tasks] ---- */

/* A task at the present state: its Jacobian is k->J, of which the rows of its kind count. */
typedef struct rbdi_tasks_error {
    rbdi_motion e;               /* from where it is to where it shall be */
    rbdi_motion drift;           /* dJ/dt v */
    rbd_real stiffness, damping; /* 1/s^2 or 1/s; 1/s */
} rbdi_tasks_error;

/* Momentum of the robot for each unit velocity, about its centre of mass, world axes: k->J. A dof moves a
   body with a velocity v of its centre of mass, at r from that of the robot, and omega: it adds m v, and
   R I R' omega + r x m v. */
RBDI_LOCAL void rbdi_tasks_put_momentum(rbdi_tasks *k) {
    const rbd_model *m = k->m;
    rbd_real centre[3] = {0, 0, 0};
    rbd_com(m, k->w, centre, NULL, NULL);
    rbdi_clear(k->J, 6 * k->nv);

    for (int body = 0; body < m->nb; ++body) {
        const rbdi_frame *u = &m->frame[body];
        const rbdi_sym I = rbdi_sym_c(u->I);
        rbdi_mat E;
        rbdi_v3 p, r;
        if (u->link < 0) continue;

        E = rbdi_axes_of(m, k->w, body);
        p = rbdi_ik_body_com(m, k->w, u);
        r = rbdi_sub(p, rbdi_load_vec(centre, 1));

        for (int i = u->link; i >= 0; i = m->link[i].parent) {
            const rbdi_link *l = &m->link[i];
            for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
                const rbdi_motion c = rbdi_column(m, k->w, i, j, p);
                const rbd_real ratio = rbdi_ratio(m, l->iv + j);
                rbd_real *to = &k->J[rbdi_source(m, l->iv + j)];
                rbdi_force h = rbdi_load_force(to, k->nv);
                const rbdi_v3 f = rbdi_scale(ratio * u->mass, c.v);
                const rbdi_v3 spin = rbdi_mul_t(E, rbdi_mul_sym(I, rbdi_mul(E, c.omega)));

                h.f = rbdi_add(h.f, f);
                h.n = rbdi_add(h.n, rbdi_add(rbdi_scale(ratio, spin), rbdi_cross(r, f)));
                rbdi_store_force(to, k->nv, h);
            }
        }
    }
}

/* Momentum, which has no place. */
RBDI_LOCAL void rbdi_tasks_of_momentum(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    rbd_real h_dot[6] = {0};

    rbdi_tasks_put_momentum(k);
    rbd_momentum(k->m, k->w, NULL, h_dot);
    s->drift = rbdi_load_motion(h_dot, 1);
    s->stiffness = rbdi_zero();
    s->damping = t->gain;
}

/* The centre of mass. */
RBDI_LOCAL void rbdi_tasks_of_com(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    rbd_real com[3] = {0}, a[3] = {0};

    rbdi_ik_com_jacobian(k->m, k->w, rbd_mass(k->m), k->w->F, &k->J[3 * k->nv]);
    rbd_com(k->m, k->w, com, NULL, a);
    s->e.v = rbdi_ik_way(t->position, rbdi_load_vec(com, 1));
    s->drift.v = rbdi_load_vec(a, 1);
}

/* The rates of the motion of a point at d from the origin of a moving frame of motion V and accelerations A,
   as seen there: V_p and A_p are those of the point itself, all in world axes. */
RBDI_LOCAL rbdi_motion rbdi_tasks_relative_drift(rbdi_motion V, rbdi_motion A, rbdi_motion V_p,
                                                 rbdi_motion A_p, rbdi_v3 d) {
    const rbdi_v3 seen = rbdi_sub(rbdi_sub(V_p.v, V.v), rbdi_cross(V.omega, d));
    rbdi_motion drift;

    /* alpha_p - alpha - omega x omega_p */
    drift.omega = rbdi_sub(rbdi_sub(A_p.omega, A.omega), rbdi_cross(V.omega, V_p.omega));

    /* a_p - a - alpha x d - omega x (omega x d) - 2 omega x v_seen */
    drift.v = rbdi_sub(rbdi_sub(A_p.v, A.v), rbdi_cross(A.omega, d));
    drift.v = rbdi_sub(drift.v, rbdi_cross(V.omega, rbdi_cross(V.omega, d)));
    drift.v = rbdi_sub(drift.v, rbdi_scale(rbdi_set(RBD_C(2)), rbdi_cross(V.omega, seen)));
    return drift;
}

/* Motion or acceleration of a point, world axes. */
RBDI_LOCAL rbdi_motion rbdi_tasks_motion(const rbdi_tasks *k, int body, const rbd_real *point, int rate) {
    rbd_real motion[6];
    if (rate)
        rbd_point_acceleration(k->m, k->w, body, point, RBD_WORLD_AXES, motion);
    else
        rbd_point_velocity(k->m, k->w, body, point, RBD_WORLD_AXES, motion);
    return rbdi_load_motion(motion, 1);
}

/* A point, pose or rotation, in the world or in the axes of another body. */
RBDI_LOCAL void rbdi_tasks_of_body(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    const int reference = t->kind == RBD_TASK_RELATIVE ? t->reference : -1;
    rbdi_mat seen = rbdi_axes_of(k->m, k->w, t->body); /* from the axes of `position` to the body's */
    rbdi_v3 p = rbdi_point_position(k->m, k->w, t->body, t->point);

    s->drift = rbdi_tasks_motion(k, t->body, t->point, 1);
    if (reference >= 0) {
        const rbdi_mat E = rbdi_axes_of(k->m, k->w, reference);
        const rbdi_motion V = rbdi_tasks_motion(k, reference, NULL, 0);
        const rbdi_motion A = rbdi_tasks_motion(k, reference, NULL, 1);
        const rbdi_motion V_p = rbdi_tasks_motion(k, t->body, t->point, 0);
        p = rbdi_sub(p, rbdi_point_position(k->m, k->w, reference, NULL));
        s->drift = rbdi_tasks_relative_drift(V, A, V_p, s->drift, p);

        s->drift.omega = rbdi_mul(E, s->drift.omega);
        s->drift.v = rbdi_mul(E, s->drift.v);
        seen = rbdi_mul_mat(seen, rbdi_transpose(E));
        p = rbdi_mul(E, p);
    }

    rbd_relative_jacobian(k->m, k->w, t->body, t->point, reference,
                          reference >= 0 ? RBD_LINK_AXES : RBD_WORLD_AXES, k->J);
    s->e.v = rbdi_ik_way(t->position, p);
    if (rbdi_tasks_turns(t->kind)) s->e.omega = rbdi_ik_turn_to(t->rotation, seen);
}

/* An axis s: its turn is omega - (omega s) s, whose rate is alpha - (alpha s) s - (omega s) omega x s. */
RBDI_LOCAL void rbdi_tasks_of_axis(rbdi_tasks *k, const rbd_task *t, rbdi_tasks_error *s) {
    const rbdi_v3 axis = rbdi_ik_axis(k->m, k->w, t->body, t->axis);
    const rbdi_v3 omega = rbdi_tasks_motion(k, t->body, NULL, 0).omega;
    const rbdi_v3 alpha = rbdi_tasks_motion(k, t->body, NULL, 1).omega;

    rbd_jacobian(k->m, k->w, t->body, NULL, RBD_WORLD_AXES, k->J);
    for (int i = 0; i < k->nv; ++i) {
        const rbdi_v3 c = rbdi_load_vec(&k->J[i], k->nv);
        rbdi_store_vec(&k->J[i], k->nv, rbdi_ik_part_across(c, axis));
    }

    s->e.omega = rbdi_ik_turn(axis, rbdi_ik_unit(t->direction));
    s->drift.omega = rbdi_ik_part_across(alpha, axis);
    s->drift.omega = rbdi_sub(s->drift.omega, rbdi_scale(rbdi_dot(omega, axis), rbdi_cross(omega, axis)));
}

/* What a row of a task asks for: y of J x = y. u: its velocity. */
RBDI_LOCAL rbd_real rbdi_tasks_wish(const rbdi_tasks *k, const rbdi_tasks_error *s, rbd_real velocity,
                                    rbd_real acceleration, rbd_real u, rbd_real e, rbd_real drift) {
    if (!k->accelerations) return velocity + s->stiffness * e;
    return acceleration + s->stiffness * e + s->damping * (velocity - u) - drift;
}

/* H + weight J'J and f - weight J'y of the last row; H below the diagonal alone. */
RBDI_LOCAL void rbdi_tasks_square(rbdi_tasks *k, rbd_real weight) {
    const rbd_real *row = &k->C[(ptrdiff_t)(k->rows - 1) * k->n];
    const rbd_real y = k->lower[k->n + k->rows - 1];

    for (int i = 0; i < k->nv; ++i) {
        const rbd_real a = weight * row[i];
        rbd_real *to = &k->H[(ptrdiff_t)i * k->n];
        if (a == 0) continue; /* a NaN is to reach the diagonal, where the QP looks for it */
        k->f[i] = k->f[i] - a * y;
        for (int j = 0; j <= i; ++j) to[j] = to[j] + a * row[j];
    }
}

/* The gains of a task: k, or k^2 and 2 damping k. */
RBDI_LOCAL rbdi_tasks_error rbdi_tasks_gains(const rbdi_tasks *k, const rbd_task *t) {
    const rbd_real damping = t->damping > 0 ? t->damping : rbdi_set(RBD_C(1));
    rbdi_tasks_error s;
    s.e = s.drift = rbdi_motion0();
    s.stiffness = k->accelerations ? t->gain * t->gain : t->gain;
    s.damping = 2 * damping * t->gain;
    return s;
}

/* Appends the rows of a task of bodies. A row of which rounding alone is left does not count: the next levels
   would have to keep it. */
RBDI_LOCAL void rbdi_tasks_put_bodies(rbdi_tasks *k, const rbd_task *t, rbd_real weight) {
    rbdi_tasks_error s = rbdi_tasks_gains(k, t);
    const int first = rbdi_tasks_first(t->kind), end = rbdi_tasks_end(t->kind);
    rbd_real e[6], drift[6], rounding;

    if (t->kind == RBD_TASK_MOMENTUM)
        rbdi_tasks_of_momentum(k, t, &s);
    else if (t->kind == RBD_TASK_COM)
        rbdi_tasks_of_com(k, t, &s);
    else if (t->kind == RBD_TASK_AXIS)
        rbdi_tasks_of_axis(k, t, &s);
    else
        rbdi_tasks_of_body(k, t, &s);
    rbdi_store_motion(e, 1, s.e);
    rbdi_store_motion(drift, 1, s.drift);
    rounding = rbdi_set(64 * RBDI_EPS);
    if (rbdi_tasks_of_robot(t->kind))
        rounding = rounding * rbdi_qp_largest(&k->J[first * k->nv], (end - first) * k->nv);
    else
        rounding = rounding * rbdi_qp_largest(k->J, 6 * k->nv);

    for (int r = first; r < end; ++r) {
        const rbd_real *J = &k->J[r * k->nv];
        const rbd_real u = k->accelerations ? rbdi_qp_dot(J, k->v, k->nv) : rbdi_zero();
        const rbd_real y = rbdi_tasks_wish(k, &s, t->velocity[r], t->acceleration[r], u, e[r], drift[r]);
        if (t->loose[r] || !(rbdi_qp_largest(J, k->nv) > rounding)) continue;
        rbdi_ik_copy(J, k->nv, rbdi_tasks_append(k, y, y));
        rbdi_tasks_square(k, weight);
    }
}

/* Appends the rows of a posture: J is the identity. e passes through k->J. */
RBDI_LOCAL void rbdi_tasks_put_posture(rbdi_tasks *k, const rbd_task *t, rbd_real weight) {
    const rbdi_tasks_error s = rbdi_tasks_gains(k, t);
    const rbd_real none = rbdi_zero();

    rbd_difference(k->m, k->q, t->q, k->J);
    for (int i = 0; i < k->nv; ++i) {
        const rbd_real velocity = t->v ? t->v[i] : none, acceleration = t->a ? t->a[i] : none;
        const rbd_real u = k->accelerations ? k->v[i] : none;
        const rbd_real y = rbdi_tasks_wish(k, &s, velocity, acceleration, u, k->J[i], none);
        const rbd_real own = t->weights                    ? t->weights[i]
                             : rbdi_tasks_is_passive(k, i) ? none
                                                           : rbdi_set(RBD_C(1));
        if (!(own > 0)) continue;
        rbdi_tasks_append(k, y, y)[i] = rbdi_set(RBD_C(1));

        /* its square is one entry */
        k->f[i] = k->f[i] - weight * own * y;
        k->H[(ptrdiff_t)i * (k->n + 1)] = k->H[(ptrdiff_t)i * (k->n + 1)] + weight * own;
    }
}

/* Appends the rows of one task, with their squares. */
RBDI_LOCAL void rbdi_tasks_put_task(rbdi_tasks *k, const rbd_task *t) {
    const rbd_real weight = t->weight > 0 ? t->weight : rbdi_set(RBD_C(1));

    if (t->kind == RBD_TASK_POSTURE) {
        rbdi_tasks_put_posture(k, t, weight);
    } else if (t->kind == RBD_TASK_ROWS) {
        for (int r = 0; r < t->rows; ++r) {
            rbdi_ik_copy(&t->jacobian[r * k->nv], k->nv, rbdi_tasks_append(k, t->y[r], t->y[r]));
            rbdi_tasks_square(k, weight);
        }
    } else {
        rbdi_tasks_put_bodies(k, t, weight);
    }
}

/* ==== src/tasks/levels.h ==== */
/* ---- levels [levels] ---- */

/* Which limit a row of the QP is: of motion, of torque, or of contact `at`, there the normal force or a side
   of its friction. */
typedef struct rbdi_tasks_limit {
    rbd_tasks_part part; /* RBD_TASKS_NOTHING: a tangential force, or a row of a task */
    int at;              /* dof or contact */
} rbdi_tasks_limit;

/* row: counted with the bounds. */
RBDI_LOCAL rbdi_tasks_limit rbdi_tasks_limit_of(const rbdi_tasks *k, int row) {
    const int nv = k->nv, c = row - k->n;
    rbdi_tasks_limit limit = {RBD_TASKS_NOTHING, -1};

    if (row < nv) {
        limit.part = RBD_TASKS_MOTION_LIMIT;
        limit.at = row;
    } else if (c < 0) {
        if ((row - nv) % 3 < 2) return limit;
        limit.part = RBD_TASKS_FORCE;
        limit.at = k->contact[(row - nv) / 3];
    } else if (c < k->dynamics) {
        limit.part = RBD_TASKS_HELD;
        limit.at = k->contact[c / 3];
    } else if (c < k->friction) {
        limit.part = rbdi_tasks_is_passive(k, c - k->dynamics) ? RBD_TASKS_PASSIVE : RBD_TASKS_TORQUE_LIMIT;
        limit.at = c - k->dynamics;
    } else {
        for (int i = 0, side = c - k->friction; i < k->closed; ++i) {
            const int sides = k->given->contact[k->contact[i]].sides == 8 ? 8 : 4;
            if (side < sides) {
                limit.part = RBD_TASKS_FRICTION;
                limit.at = k->contact[i];
                return limit;
            }
            side -= sides;
        }
    }
    return limit;
}

/* Copies sides of limits from those kept, or back. */
RBDI_LOCAL void rbdi_tasks_keep_some(signed char *side, signed char *kept, int n, int back) {
    for (int i = 0; i < n; ++i) {
        if (back)
            kept[i] = side[i];
        else
            side[i] = kept[i];
    }
}

/* Copies the sides at which limits hold from those kept of a level, or back. Rows of tasks have none. */
RBDI_LOCAL void rbdi_tasks_keep(rbdi_tasks *k, int level, int rows, int back) {
    signed char *kept = k->kept + (size_t)level * RBDI_TASKS_LIMITS(k->nv, k->given->contacts);
    signed char *side = k->side;
    signed char *friction = side + k->n + k->friction;

    for (int row = 0; row < k->n + rows && !back; ++row) side[row] = 0;
    rbdi_tasks_keep_some(side, kept, k->nv, back);
    if (!k->accelerations) return;

    rbdi_tasks_keep_some(side + k->n + k->dynamics, kept + k->nv, k->nv, back);
    for (int i = 0; i < k->closed; ++i) {
        const int contact = k->contact[i];
        const int sides = k->given->contact[contact].sides == 8 ? 8 : 4;
        signed char *of_contact = kept + 2 * k->nv + RBDI_TASKS_CONTACT * contact;

        rbdi_tasks_keep_some(side + k->nv + 3 * i + 2, of_contact, 1, back);
        rbdi_tasks_keep_some(friction, of_contact + 1, sides, back);
        friction += sides;
    }
}

/* The force that counts as 1 m/s^2: that which gives the robot so much. */
RBDI_LOCAL rbd_const rbdi_tasks_unit_force(const rbdi_tasks *k) {
    const rbd_const mass = rbd_mass(k->m);
    return mass > 0 ? mass : RBD_C(1);
}

/* The squares that every level has: of x alone. */
RBDI_LOCAL void rbdi_tasks_clear_squares(rbdi_tasks *k) {
    const rbd_tasks *p = k->given;
    const rbd_real motion = p->motion_cost > 0 ? p->motion_cost : rbdi_set(RBDI_TASKS_MOTION_COST);
    const rbd_const unit = rbdi_tasks_unit_force(k);
    const rbd_real force = p->force_cost > 0 ? p->force_cost : motion / (unit * unit);

    rbdi_clear(k->f, k->n);
    rbdi_clear(k->H, k->nv * k->n);
    for (int i = 0; i < k->n; ++i) {
        const rbd_real own = i < k->nv ? rbdi_zero() : p->contact[k->contact[(i - k->nv) / 3]].cost;
        k->H[(ptrdiff_t)i * k->n + i] = i < k->nv ? motion : own > 0 ? own : force;
    }
}

/* By how much x misses hard rows of the QP that was solved, at most, as a share of each row's own terms. That
   of rbd_qp_result counts all components of x as the largest: one may be missed by all of itself, where
   another is a million. Here x_i counts as |x_i| + a unit of it. */
RBDI_LOCAL rbd_real rbdi_tasks_missed(const rbdi_tasks *k, const rbdi_qp *s) {
    const rbd_real force = rbdi_set(rbdi_tasks_unit_force(k)), motion = rbdi_set(RBD_C(1));
    rbd_real most = rbdi_zero();

    for (int i = 0; i < k->n; ++i) s->reach[i] = rbdi_abs(k->x[i]) + (i < k->nv ? motion : force);
    for (int row = 0; row < s->all; ++row) {
        const rbd_real value = s->value[row];
        const rbd_real below = k->lower[row] - value;
        const rbd_real by = rbdi_larger(below, value - k->upper[row]);
        const rbd_real side = below > 0 ? k->lower[row] : k->upper[row];
        if (!(by > 0) || k->soft[row] > 0) continue;
        if (by <= most * (rbdi_abs(side) + rbdi_abs(value))) continue; /* the terms are more than the value */
        const rbd_real share = by / rbdi_qp_terms(s, row, side);
        most = rbdi_larger(most, rbdi_smaller(share, rbdi_set(RBD_C(1)))); /* 1 if sums overflow */
    }
    return most;
}

/* Adds what x misses of its rows to what the levels before missed, by which limits were widened. Returns
   whether that is little enough for a tick. */
RBDI_LOCAL int rbdi_tasks_count_missed(rbdi_tasks *k, const rbdi_qp *s) {
    k->missed = k->missed + rbdi_tasks_missed(k, s);
    k->result->primal = rbdi_larger(k->result->primal, k->missed);
    return k->missed < RBDI_TASKS_ACCURACY && rbdi_tasks_are_within(k->x, k->n, -RBDI_IK_MOST, RBDI_IK_MOST);
}

/* Whether a QP has ended with an x that is of use, though perhaps not the best. */
RBDI_LOCAL int rbdi_tasks_has_answer(rbd_qp_status status) {
    return status == RBD_QP_OK || status == RBD_QP_INACCURATE || status == RBD_QP_ITERATIONS ||
           status == RBD_QP_UNBOUNDED;
}

/* Solves the QP of a level, with the first rows of C: those of its own tasks are squares in it. */
RBDI_LOCAL rbd_qp_status rbdi_tasks_solve_level(rbdi_tasks *k, int level, int rows) {
    rbd_tasks_result *result = k->result;
    rbd_qp_problem qp;
    rbd_qp_options options;
    const rbdi_qp_shape shape = {1, k->nv, k->dynamics, k->friction, k->robot};
    rbdi_qp s;
    rbd_qp_status status;

    for (int i = 0; i < k->nv; ++i)
        for (int j = 0; j < i; ++j) k->H[(ptrdiff_t)j * k->n + i] = k->H[(ptrdiff_t)i * k->n + j];

    qp.n = k->n;
    qp.bounds = k->n;
    qp.rows = rows;
    qp.H = k->H;
    qp.f = k->f;
    qp.C = k->C;
    qp.lower = k->lower;
    qp.upper = k->upper;
    qp.soft = k->given->limit_weight > 0 || k->given->torque_weight > 0 ? k->soft : NULL;
    options.steps = k->given->steps;
    options.warm = k->given->warm;
    options.rounds = 0;
    options.accuracy = rbdi_zero();

    /* begins at 0, also with `warm`: of a free motion the least is wanted, not the last one */
    for (int i = 0; i < k->n; ++i) k->x[i] = rbdi_zero();
    if (options.warm) rbdi_tasks_keep(k, level, rows, 0);
    status = rbdi_qp_solve(&s, &qp, &options, &shape, k->scratch, k->scratch_size, k->x, k->lambda, k->side);
    rbdi_tasks_keep(k, level, rows, 1);
    result->qp = status;
    result->level = level;
    result->steps += s.result.steps;
    result->primal = rbdi_larger(result->primal, s.result.primal);
    result->dual = rbdi_larger(result->dual, s.balance);
    if (!rbdi_tasks_has_answer(status)) return status;

    /* x is what counts: nobody asks for multipliers, of rows that nearly depend on each other */
    if (status == RBD_QP_INACCURATE && rbdi_larger(s.result.primal, s.balance) < RBDI_TASKS_ACCURACY)
        status = RBD_QP_OK;
    if (!rbdi_tasks_count_missed(k, &s) && status == RBD_QP_OK) {
        result->qp = RBD_QP_INACCURATE; /* rows that nearly contradict each other */
        return RBD_QP_INACCURATE;
    }
    return status;
}

/* The value of a row, counted with the bounds, at x. */
RBDI_LOCAL rbd_real rbdi_tasks_value(const rbdi_tasks *k, int row) {
    if (row < k->n) return k->x[row];
    return rbdi_qp_dot(&k->C[(ptrdiff_t)(row - k->n) * k->n], k->x, k->n);
}

/* Before the next level: rows of tasks hold what they reached, and limits hold x. */
RBDI_LOCAL void rbdi_tasks_freeze(rbdi_tasks *k, int rows) {
    for (int row = 0; row < k->n + k->rows; ++row) {
        const rbd_real value = rbdi_tasks_value(k, row);
        if (row >= k->n + rows) {
            k->lower[row] = value;
            k->upper[row] = value;
        } else if (k->lower[row] < k->upper[row]) {
            k->lower[row] = rbdi_smaller(k->lower[row], value);
            k->upper[row] = rbdi_larger(k->upper[row], value);
        }
        k->soft[row] = rbdi_zero();
    }
}

/* Appends the rows and squares of the tasks of a level; returns how many tasks. */
RBDI_LOCAL int rbdi_tasks_put_level(rbdi_tasks *k, int level) {
    int tasks = 0;

    rbdi_tasks_clear_squares(k);
    for (int i = 0; i < k->given->tasks; ++i) {
        if (k->given->task[i].level != level) continue;
        rbdi_tasks_put_task(k, &k->given->task[i]);
        ++tasks;
    }
    return tasks;
}

/* Whether a level above this one has tasks. */
RBDI_LOCAL int rbdi_tasks_goes_on(const rbdi_tasks *k, int level) {
    for (int i = 0; i < k->given->tasks; ++i)
        if (k->given->task[i].level > level) return 1;
    return 0;
}

/* Solves level by level. k->found is the answer, if there is any. */
RBDI_LOCAL rbd_tasks_status rbdi_tasks_descend(rbdi_tasks *k) {
    int solved = 0;

    for (int level = 0; level < RBD_TASK_LEVELS && k->n > 0; ++level) {
        const rbd_real primal = k->result->primal, dual = k->result->dual;
        const int rows = k->rows;
        rbd_qp_status status;
        if (!rbdi_tasks_put_level(k, level) && level > 0) continue;

        status = rbdi_tasks_solve_level(k, level, rows);
        if (status != RBD_QP_OK && solved) { /* the answer of the level before stands */
            k->result->primal = primal;
            k->result->dual = dual;
            return RBD_TASKS_INEXACT;
        }
        if (status == RBD_QP_INFEASIBLE) return RBD_TASKS_INFEASIBLE;
        if (!rbdi_tasks_has_answer(status)) {
            rbdi_tasks_refuse(k->result, RBD_ERR_NAN, NULL);
            return RBD_TASKS_ERROR;
        }

        rbdi_ik_copy(k->x, k->n, k->found);
        if (status != RBD_QP_OK) return RBD_TASKS_INEXACT;
        if (!rbdi_tasks_goes_on(k, level)) return RBD_TASKS_OK;
        solved = 1;
        rbdi_tasks_freeze(k, rows);
    }
    return RBD_TASKS_OK;
}

/* ==== src/tasks/blame.h ==== */
/* ---- contradictions [contradictions] ----
   The multipliers of a QP without solution are a proof: lambda' rows = 0, and yet the sides that they name
   would have the sum below 0. Each row counts by |lambda| (its length + |its side|): friction, whose side is
   0, counts by the first, a force or torque by the second. */

RBDI_LOCAL rbd_real rbdi_tasks_share(const rbdi_tasks *k, int row) {
    const rbd_real side = k->lambda[row] > 0 ? k->upper[row] : k->lower[row];
    rbd_real length = rbdi_set(RBD_C(1));
    if (!(k->lambda[row] < 0 || k->lambda[row] > 0)) return rbdi_zero();

    if (row >= k->n) {
        const rbd_real *c = &k->C[(ptrdiff_t)(row - k->n) * k->n];
        length = rbdi_sqrt(rbdi_qp_dot(c, c, k->n));
    }
    return rbdi_abs(k->lambda[row]) * (length + rbdi_abs(side));
}

/* Names the part that counts most, limits before contacts that are held and dofs without a motor; then the
   one that counts most of those of another kind. */
RBDI_LOCAL void rbdi_tasks_blame(rbdi_tasks *k, int rows) {
    rbd_tasks_result *result = k->result;

    for (int i = 0; i < 2; ++i) {
        rbd_real most = rbdi_zero();
        int firm = 1; /* whether the part so far is an equality */
        for (int row = 0; row < k->n + rows; ++row) {
            const rbdi_tasks_limit limit = rbdi_tasks_limit_of(k, row);
            const int equal = k->lower[row] >= k->upper[row];
            const rbd_real share = rbdi_tasks_share(k, row);
            if (!(share > 0) || (i && limit.part == result->part[0])) continue;
            if (equal > firm || (equal == firm && !(share > most))) continue;
            firm = equal;
            most = share;
            result->part[i] = limit.part;
            result->at[i] = limit.at;
        }
    }
}

/* ==== src/tasks/solve.h ==== */
/* ---- solve [code of tasks] ---- */

/* Rows of a task, at most. */
RBDI_LOCAL int rbdi_tasks_rows_of(const rbd_model *m, const rbd_task *t) {
    switch ((int)t->kind) {
    case RBD_TASK_POSE:
    case RBD_TASK_MOMENTUM:
    case RBD_TASK_RELATIVE: return 6;
    case RBD_TASK_POSTURE: return m->nv;
    case RBD_TASK_ROWS: return t->rows;
    default: return 3;
    }
}

/* Rows of all tasks, soft rows at most. */
RBDI_LOCAL int rbdi_tasks_count(const rbd_model *m, const rbd_tasks *p, int *soft) {
    int rows = 0;
    for (int i = 0; i < p->tasks; ++i) rows += rbdi_tasks_rows_of(m, &p->task[i]);
    *soft = (p->limit_weight > 0 ? m->nv : 0) + (p->torque_weight > 0 ? m->nv : 0);
    return rows;
}

RBDI_API size_t rbd_tasks_size(const rbd_model *m, const rbd_tasks *p) {
    int rows, soft;
    if (!m || !p || p->tasks < 0 || p->tasks > RBDI_TASKS_MOST || p->contacts < 0 ||
        p->contacts > RBDI_TASKS_MOST || (p->tasks && !p->task))
        return 0;
    for (int i = 0; i < p->tasks; ++i)
        if (p->task[i].kind == RBD_TASK_ROWS && (p->task[i].rows < 0 || p->task[i].rows > RBDI_TASKS_MOST))
            return 0;
    rows = rbdi_tasks_count(m, p, &soft);
    if (RBDI_TASKS_C(m->nv, rows, p->contacts) > RBDI_QP_MOST ||
        RBDI_TASKS_N(m->nv, p->contacts) + (size_t)soft > RBDI_QP_MOST)
        return 0;
    return RBD_TASKS_SIZE(m->nv, rows, p->contacts, soft);
}

/* Lays out the arrays in the memory. What is kept between ticks stands first. */
RBDI_LOCAL rbdi_tasks *rbdi_tasks_lay_out(const rbd_model *m, const rbd_tasks *p, void *memory) {
    const int nv = m->nv, n = nv + 3 * p->contacts;
    unsigned char *at = rbdi_aligned(memory);
    int soft;
    const int count = rbdi_tasks_count(m, p, &soft);
    const int rows = nv + count + (3 + RBDI_TASKS_SIDES) * p->contacts, all = n + rows;
    signed char *kept = RBDI_CUT(signed char, RBDI_TASKS_CHARS(nv, count, p->contacts));
    int16_t *contact = RBDI_CUT(int16_t, p->contacts);
    rbdi_tasks *k = RBDI_CUT(rbdi_tasks, 1);

    k->kept = kept;
    k->side = kept + RBD_TASK_LEVELS * RBDI_TASKS_LIMITS(nv, p->contacts);
    k->contact = contact;
    k->H = RBDI_CUT(rbd_real, RBDI_TASKS_SCALARS(nv, count, p->contacts));
    k->C = k->H + n * n;
    k->lower = k->C + rows * n;
    k->upper = k->lower + all;
    k->soft = k->upper + all;
    k->lambda = k->soft + all;
    k->f = k->lambda + all;
    k->x = k->f + n;
    k->found = k->x + n;
    k->bias = k->found + n;
    k->J = k->bias + nv;
    k->scratch = at;
    k->scratch_size = RBD_QP_SIZE(n, n, rows, soft);
    return k;
}

/* Makes a tick ready: closed contacts, bounds, rows of the robot. */
RBDI_LOCAL rbdi_tasks *rbdi_tasks_begin(const rbd_model *m, rbd_work *w, const rbd_tasks *p,
                                        const rbd_real *q, const rbd_real *v, int accelerations, void *memory,
                                        rbd_tasks_result *result) {
    rbdi_tasks *k = rbdi_tasks_lay_out(m, p, memory);
    k->m = m;
    k->w = w;
    k->given = p;
    k->q = q;
    k->v = v;
    k->result = result;
    k->accelerations = accelerations;
    k->nv = m->nv;
    k->missed = rbdi_zero();

    k->closed = 0;
    for (int i = 0; i < p->contacts; ++i)
        if (!p->contact[i].open) k->contact[k->closed++] = (int16_t)i;
    k->n = k->nv + (accelerations ? 3 * k->closed : 0);

    if (!p->warm)
        for (size_t i = 0; i < RBD_TASK_LEVELS * RBDI_TASKS_LIMITS(k->nv, p->contacts); ++i) k->kept[i] = 0;
    rbdi_tasks_bounds(k);
    rbdi_tasks_put_robot(k);
    return k;
}

/* Sets a result to nothing. */
RBDI_LOCAL void rbdi_tasks_clear_result(rbd_tasks_result *result) {
    result->steps = 0;
    result->level = 0;
    result->qp = RBD_QP_OK;
    result->primal = rbdi_zero();
    result->dual = rbdi_zero();
    for (int i = 0; i < 2; ++i) {
        result->part[i] = RBD_TASKS_NOTHING;
        result->at[i] = -1;
    }
    result->task = -1;
    result->contact = -1;
    result->dof = -1;
    rbdi_tasks_refuse(result, RBD_OK, NULL);
}

/* Solves a problem that is in order; k->found is the answer. */
RBDI_LOCAL rbd_tasks_status rbdi_tasks_run(rbdi_tasks *k) {
    const int rows = k->rows;
    const rbd_tasks_status status = rbdi_tasks_descend(k);
    if (status == RBD_TASKS_INFEASIBLE) rbdi_tasks_blame(k, rows);
    return status;
}

RBDI_API rbd_tasks_status rbd_tasks_velocity(const rbd_model *m, rbd_work *w, const rbd_tasks *p,
                                             const rbd_real *q, void *memory, size_t size, rbd_real *v,
                                             rbd_tasks_result *result) {
    rbd_tasks_status status;
    rbdi_tasks *k;
    if (!result) return RBD_TASKS_ERROR;

    rbdi_tasks_clear_result(result);
    if (rbdi_tasks_check(m, w, p, q && memory && v, 0, size, result) ||
        rbdi_tasks_check_state(m, p, q, p->acceleration ? v : NULL, result))
        return RBD_TASKS_ERROR;

    k = rbdi_tasks_begin(m, w, p, q, v, 0, memory, result);
    status = rbdi_tasks_run(k);
    if (status >= 0) rbdi_ik_copy(k->found, k->nv, v);
    return status;
}

/* Forces of the contacts, world axes, from those along the axes of their ground. */
RBDI_LOCAL void rbdi_tasks_put_forces(const rbdi_tasks *k, rbd_real *forces) {
    rbdi_clear(forces, 3 * k->given->contacts);
    for (int i = 0; i < k->closed; ++i) {
        const int contact = k->contact[i];
        const rbdi_v3 f = rbdi_load_vec(&k->found[k->nv + 3 * i], 1);
        rbdi_store_vec(&forces[3 * contact], 1,
                       rbdi_mul_t(rbdi_tasks_ground(&k->given->contact[contact]), f));
    }
}

RBDI_API rbd_tasks_status rbd_tasks_acceleration(const rbd_model *m, rbd_work *w, const rbd_tasks *p,
                                                 const rbd_real *q, const rbd_real *v, void *memory,
                                                 size_t size, rbd_real *a, rbd_real *forces, rbd_real *tau,
                                                 rbd_tasks_result *result) {
    rbd_tasks_status status;
    rbdi_tasks *k;
    if (!result) return RBD_TASKS_ERROR;

    rbdi_tasks_clear_result(result);
    if (rbdi_tasks_check(m, w, p, q && v && memory && a && tau, 1, size, result) ||
        rbdi_tasks_check_state(m, p, q, v, result))
        return RBD_TASKS_ERROR;

    k = rbdi_tasks_begin(m, w, p, q, v, 1, memory, result);
    status = rbdi_tasks_run(k);
    if (status < 0) return status;

    rbdi_ik_copy(k->found, k->nv, a);
    for (int i = 0; i < k->nv; ++i) {
        const rbd_real *row = &k->C[(ptrdiff_t)(k->dynamics + i) * k->n];
        tau[i] = rbdi_tasks_is_passive(k, i) ? rbdi_zero() : rbdi_qp_dot(row, k->found, k->n) + k->bias[i];
    }
    if (forces && p->contacts) rbdi_tasks_put_forces(k, forces);
    return status;
}

/* ==== src/tasks/text.h ==== */
/* ---- text [text of tasks] ---- */

RBDI_MESSAGES RBDI_PART const char *rbdi_tasks_sentence(rbd_tasks_status status) {
    switch (status) {
    case RBD_TASKS_OK: return "all limits are kept, and the tasks done as well as they allow";
    case RBD_TASKS_INEXACT: return "the quadratic program of a level did not end well";
    case RBD_TASKS_INFEASIBLE: return "contacts and limits contradict each other";
    case RBD_TASKS_ERROR: return "an error, and no result that says which";
    }
    return "unknown status";
}

/* A part, before the number of its dof or contact. */
RBDI_MESSAGES RBDI_PART const char *rbdi_tasks_part_name(rbd_tasks_part part) {
    switch (part) {
    case RBD_TASKS_NOTHING: break;
    case RBD_TASKS_HELD: return "the hold of contact ";
    case RBD_TASKS_FRICTION: return "the friction of contact ";
    case RBD_TASKS_FORCE: return "the least or largest force of contact ";
    case RBD_TASKS_PASSIVE: return "the missing motor of dof ";
    case RBD_TASKS_TORQUE_LIMIT: return "the torque limit of dof ";
    case RBD_TASKS_MOTION_LIMIT: return "the limit of motion of dof ";
    }
    return "nothing ";
}

/* The sentence of an error, where that of rbd_status_string speaks of a model. */
RBDI_MESSAGES RBDI_PART const char *rbdi_tasks_error_text(rbd_status error) {
    switch ((int)error) {
    case RBD_ERR_COUNT: return "below 0 or above 1000, or more than 20000 rows in all";
    case RBD_ERR_TYPE: return "unknown kind of task";
    case RBD_ERR_POSITION: return "not finite, or farther than 1e9 m";
    case RBD_ERR_AXIS: return "not finite, or of a length out of 1e-9 to 1e9";
    case RBD_ERR_MASS: return "a centre of mass or momentum, but the robot has no mass";
    case RBD_ERR_LIMITS: return "not a number, or the lower limit is above the upper one";
    case RBD_ERR_RANGE: return "not finite, negative, or out of range";
    case RBD_ERR_NAN: return "not finite, or the result overflows";
    default: return rbd_status_string(error);
    }
}

RBDI_API char *rbd_tasks_text(rbd_tasks_status status, const rbd_tasks_result *result, char *text,
                              size_t size) {
    const int failed = status == RBD_TASKS_ERROR && result;
    const int blamed = status == RBD_TASKS_INFEASIBLE && result && result->part[0] != RBD_TASKS_NOTHING;
    const char *piece[8];
    char digits[2][12];
    int n = 0;
    if (!text || size == 0) return text;

    if (failed && (result->task >= 0 || result->contact >= 0 || result->dof >= 0)) {
        const int at = result->task >= 0      ? result->task
                       : result->contact >= 0 ? result->contact
                                              : result->dof;
        piece[n++] = result->task >= 0 ? "task " : result->contact >= 0 ? "contact " : "dof ";
        piece[n++] = rbdi_decimal(at, digits[0]);
        piece[n++] = ", ";
    }
    if (failed && result->field) {
        piece[n++] = "field '";
        piece[n++] = result->field;
        piece[n++] = "': ";
    }
    if (blamed) {
        const int both = result->part[1] != RBD_TASKS_NOTHING;
        piece[n++] = rbdi_tasks_part_name(result->part[0]);
        piece[n++] = rbdi_decimal(result->at[0], digits[0]);
        piece[n++] = both ? " contradicts " : " cannot be kept";
        if (both) piece[n++] = rbdi_tasks_part_name(result->part[1]);
        if (both) piece[n++] = rbdi_decimal(result->at[1], digits[1]);
    } else {
        piece[n++] = failed ? rbdi_tasks_error_text(result->error) : rbdi_tasks_sentence(status);
    }
    return rbdi_join(piece, n, text, size);
}

/* ==== src/rbd_tasks.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("C")
#pragma pop_macro("E")
#pragma pop_macro("F")
#pragma pop_macro("H")
#pragma pop_macro("I")
#pragma pop_macro("J")
#pragma pop_macro("M")
#pragma pop_macro("V")
