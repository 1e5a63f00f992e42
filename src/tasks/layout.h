#ifndef RBDI_TASKS_LAYOUT_H
#define RBDI_TASKS_LAYOUT_H
#include "model/work.h"
#include "api/tasks.h"

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

#endif
