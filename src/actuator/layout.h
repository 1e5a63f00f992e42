#ifndef RBDI_ACTUATOR_LAYOUT_H
#define RBDI_ACTUATOR_LAYOUT_H
#include "algebra/types.h"
#include "base/tolerances.h"
#include "api/actuator.h"

/* ---- method [method] ----
   Each drive is a shaft with angle phi(q) and speed x = G v on the joints' side; t there is the torque t' G
   of the joints. Everything between command and joint is a law t(x) of one shaft, monotone: at the end of a
   step of length dt the joint gets the impulse dt t, and a larger speed x never a larger t. Such laws make no
   energy whatever dt is.

   A law is piecewise linear, t = start - slope x; dry friction is steep at x = 0. A step is told start and
   slope of the piece at a point of speeds x_p. If each law has at the speeds that come out the torque that
   the step was told, they are those of the laws themselves, exactly. Else the step is made again with another
   point.
   This is Newton's method for the least value of a convex function: that of the joints' motion, which is
   quadratic, and for each shaft the integral of -t(x). From the second time on the point is where this
   function is least on the way from the last point to the new speeds. There, at the share c of the way d,

       sum over shafts (T + c (T_new - T) - t(x_p + c d)) d = 0

   with the torque T by which the joints are in motion at the point. It is known, since the step was told it.
   So the repeats end for all laws, however steep.

   Shafts that a transmission couples have slopes G' diag(slope) G, which are no diagonal, and what sticks is
   no joint. So if there is a transmission, the motion of the joints is learnt for all shafts at once:
   T = T_p + P (x - x_p) with a matrix P, which each repeat corrects. With P the same method finds the speeds
   of all shafts without a step. The step is told the torques that belong to them, and a damping that is a
   diagonal. P is kept from step to step. */

#define RBDI_ACTUATOR_MOST RBD_C(1e9)     /* of a field, a command, q and v */
#define RBDI_ACTUATOR_LARGEST RBD_C(1e12) /* N m: torques in a level of friction; their squares are finite */
#define RBDI_ACTUATOR_UNLIMITED RBD_C(1e15) /* A: of a motor without limit of current */
#define RBDI_ACTUATOR_MOST_MOTORS 1000
#define RBDI_ACTUATOR_MOST_DELAY 1000
#define RBDI_ACTUATOR_REPEATS 50        /* of a step: few random robots need more */
#define RBDI_ACTUATOR_SEARCHES 20       /* beyond one for each shaft */
#define RBDI_ACTUATOR_HALVINGS 55       /* that find the least value on a way: to rounding of double */
#define RBDI_ACTUATOR_SLOPE RBD_C(1e-3) /* least slope of the inverse's equation: that of load_motor 0.999 */
#define RBDI_ACTUATOR_BEND RBD_C(1e-3)  /* see [laws of shafts]: no steeper than float can compute */
#define RBDI_ACTUATOR_DEAD RBD_C(1e-6) /* of crank times length: a rod nearer to its dead centre is refused */
#define RBDI_ACTUATOR_HOTTEST RBD_C(1e6)      /* degrees: no winding gets there */
#define RBDI_ACTUATOR_WARM RBD_C(25)          /* degrees at which resistances are given */
#define RBDI_ACTUATOR_ROUNDING (8 * RBDI_EPS) /* of the size of a sum: a law adds up about eight terms */
#define RBDI_ACTUATOR_NOTHING RBD_C(1e-9)     /* N m: torques round as this one at least */
#define RBDI_ACTUATOR_ACROSS 14           /* times the square of its rounding: a change of speeds above it */
#define RBDI_ACTUATOR_TELLING RBD_C(1e-7) /* of its work: what a repeat must tell beside those before it */
#if RBDI_KIND(RBD_CONST) == 2
#define RBDI_ACTUATOR_CREEP RBD_C(1e-6) /* rad/s: a rigid shaft under its level of friction creeps so fast */
#define RBDI_ACTUATOR_SETTLED \
    RBD_C(2e-6) /* of the torque of coupled shafts, that a repeat may still change */
#else
#define RBDI_ACTUATOR_CREEP RBD_C(1e-9)
#define RBDI_ACTUATOR_SETTLED RBD_C(1e-12)
#endif

/* A shaft. */
typedef struct rbdi_act_shaft {
    int16_t dof, at;   /* that it moves directly, and its coordinate in q; -1: a transmission does */
    int16_t saturated; /* as in rbd_drive */
    int16_t branch;    /* of dry friction at the step's beginning: -1, 1 where it slides */
    int16_t oldest;    /* command of the ring */

    /* state */
    rbd_real angle, speed;     /* of the rotor */
    rbd_real winding, housing; /* degrees above the air */
    rbd_real bristle;          /* N m: of the bristle, or 0 */
    rbd_real lent;             /* J: see [cogging] */
    rbd_real motor, joint; /* N m, of the last step: the motor's torque, the shaft's on the joint's side */
    rbd_real current;      /* A, of the last step */

    /* of the step */
    rbd_command arrived;
    rbd_real phi, x, bias; /* angle and speed of the joint's side at its beginning; (dG/dt) v */
    rbd_real t, braking; /* the drive asks for the torque t - braking speed, at the speed of the step's end */
    rbd_real most;       /* N m: limit of the current */
    rbd_real stall, droop; /* limits of the voltage: stall - droop speed, -stall - droop speed */
    rbd_real now;          /* N m: the motor's torque at its beginning */
    rbd_real gain, rate;   /* its slopes by angle and speed in continuous time, both negative there */
    rbd_real pass;         /* its slope by the command's torque or voltage */
    rbd_real cogging;      /* N m, that no current makes: cogging - cogging_slope speed */
    rbd_real cogging_slope;
    rbd_real level;        /* of dry friction */
    rbd_real point, base;  /* the speed whose piece the step was told, and the joints' torque there */
    rbd_real start, slope; /* what it was told: the torque start - slope x */
    rbd_real next;         /* the speed that came out, or is foretold */
    rbd_real force;        /* the torque that the joints have there */

    /* of the step, if there are transmissions */
    rbd_real seen_x, seen_T; /* see [coupled shafts] */
    rbd_real smooth;         /* the slope without dry friction */
    rbd_real scale;          /* rad/s: the joints' shares in the speed that came out */
    rbd_real size;           /* N m: what its torque adds up */
} rbdi_act_shaft;

/* Joints that motors move together. */
typedef struct rbdi_act_group {
    const rbd_transmission *by;
    int16_t n, first; /* shafts */
    int16_t dof[3];   /* of the joints */
    int16_t at[3];    /* their coordinates in q */
    rbdi_mat turn[2]; /* rods: joint frames at q = 0 in the frame before: axes, origin, joint axis */
    rbdi_v3 origin[2], axis[2];
    rbd_real G[9];                 /* n x n: shaft speeds by joint speeds */
    rbd_real H[8];                 /* rods, n x n x n: G by q */
    rbd_real inverse[9];           /* of G */
    rbd_real v[3];                 /* of the joints at the step's beginning */
    rbd_real start[3], damping[3]; /* what the joints were told */
} rbdi_act_group;

struct rbd_actuators {
    const rbd_motor *motor;
    int n, groups, nq, nv, ring; /* ring: commands that each motor keeps */
    int fault;                   /* see rbd_actuators_fault */
    int begun, repeats;
    int noted; /* speeds that came out since the points were those of the step's beginning */
    rbd_real dt, air;
    rbd_real share; /* of the way of a step that v_next makes: 1, or 1/2 */
    rbdi_act_shaft *shaft;
    rbdi_act_group *group;
    rbd_command *commands; /* n x ring */

    /* if there are transmissions, of all shafts: see [coupled shafts] */
    int known;                /* whether there is a mass */
    int pairs;                /* that this step told */
    rbd_real *mass;           /* n x n, kg m^2 by the shafts' speeds */
    rbd_real *system;         /* n x n: that is solved */
    rbd_real *pair;           /* n x 2 x n: d_k, y_k of [learning] */
    rbd_real *solution;       /* n */
    rbd_real speed_rounding;  /* rad/s */
    rbd_real torque_rounding; /* N m */
};

#define RBDI_ACTUATORS_BYTES(n, groups, delay) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_actuators)) + RBDI_ROUND((size_t)(n) * sizeof(rbdi_act_shaft)) + \
     RBDI_ROUND((size_t)(groups) * sizeof(rbdi_act_group)) + \
     RBDI_ROUND((size_t)(n) * (size_t)(delay) * sizeof(rbd_command)) + \
     ((groups) > 0 ? RBDI_ROUND((4 * (size_t)(n) + 1) * (size_t)(n) * sizeof(rbd_real)) : 0))

/* Bytes that rbd_actuators_init needs for n motors and so many transmissions; a constant. delay: the largest
   of the motors' */
#define RBD_ACTUATORS_SIZE(n, groups, delay) RBDI_ACTUATORS_BYTES(n, groups, delay)

#endif
