#ifndef RBDI_ACTUATOR_LAYOUT_H
#define RBDI_ACTUATOR_LAYOUT_H
#include "base/types.h"
#include "algebra/types.h"
#include "api/actuator.h"

/* ---- method [method] ----
   Each drive is a shaft with angle g(q) and speed x = G v on the joints' side; t there is the torque t' G of
   the joints. Everything between command and joint is a law p(x) of one shaft, monotone: at the end of a step
   of length dt the joint gets the impulse p, and a larger speed x never a larger p. Such laws make no energy
   whatever dt is.

   A law is piecewise linear, p / dt = s - slope x, but for dry friction, which is vertical at x = 0. A step
   is told s and slope of the piece (the branch) at the last known x. If no shaft is on another branch at the
   speeds that come out, they are those of the laws themselves, exactly. Else the step is made again with the
   branches that were found; from the fourth time on, of those half way to the new speeds. A shaft with dry
   friction goes from one direction of sliding to the other by way of sticking.

   Shafts that a transmission couples have the damping A = G' diag(slope) G, which is no diagonal. The step is
   told a diagonal above it, L_jj = sum |A_jk|, and the torque (L - A) v of the v before: repeated, it
   converges for every A. */

#define RBDI_ACTUATOR_MOST RBD_C(1e9)     /* of a field, a command, q and v */
#define RBDI_ACTUATOR_LARGEST RBD_C(1e12) /* N m: torques in a level of friction; their squares are finite */
#define RBDI_ACTUATOR_UNLIMITED RBD_C(1e15) /* A: of a motor without limit of current */
#define RBDI_ACTUATOR_MOST_MOTORS 1000
#define RBDI_ACTUATOR_MOST_DELAY 1000
#define RBDI_ACTUATOR_REPEATS 50
#define RBDI_ACTUATOR_SOFT 3            /* repeats after which speeds go half way */
#define RBDI_ACTUATOR_SLOPE RBD_C(1e-3) /* least slope of the inverse's equation: that of load_motor 0.999 */
#define RBDI_ACTUATOR_DEAD RBD_C(1e-6) /* of crank times length: a rod nearer to its dead centre is refused */
#define RBDI_ACTUATOR_HOTTEST RBD_C(1e6) /* degrees: no winding gets there */
#define RBDI_ACTUATOR_WARM RBD_C(25)     /* degrees at which resistances are given */
#if RBDI_KIND(RBD_CONST) == 2
#define RBDI_ACTUATOR_CREEP RBD_C(1e-6) /* rad/s: a rigid shaft under its level of friction creeps so fast */
#define RBDI_ACTUATOR_SETTLED RBD_C(1e-5)
#else
#define RBDI_ACTUATOR_CREEP RBD_C(1e-9)
#define RBDI_ACTUATOR_SETTLED \
    RBD_C(1e-12) /* of the torque of coupled shafts, that a repeat may still change */
#endif

/* A shaft. */
typedef struct rbdi_act_shaft {
    int16_t dof, at;   /* that it moves directly, and its coordinate in q; -1: a transmission does */
    int16_t saturated; /* as in rbd_drive */
    int16_t branch;    /* of its law: of dry friction -1, 0, 1; of a spring see rbdi_act_elastic_law */
    int16_t oldest;    /* command of the ring */

    /* state */
    rbd_real angle, speed;     /* of the rotor */
    rbd_real winding, housing; /* degrees above the air */
    rbd_real bristle;          /* N m: of the bristle, or 0 */
    rbd_real motor, joint; /* N m, of the last step: the motor's torque, the shaft's on the joint's side */

    /* of the step */
    rbd_real g, x, bias; /* angle and speed of the joint's side at its beginning; G' v */
    rbd_real t, braking; /* the motor's torque is t - braking speed at the step's end */
    rbd_real now;        /* N m: the motor's torque at its beginning */
    rbd_real gain, rate; /* its slopes by angle and speed in continuous time, both negative there */
    rbd_real cogging;    /* N m, a part of t that no current makes: cogging - cogging_slope speed */
    rbd_real cogging_slope;
    rbd_real level;    /* of dry friction */
    rbd_real told;     /* speed whose branch the step was told */
    rbd_real s, slope; /* what it was told: the torque s - slope x */
} rbdi_act_shaft;

/* Joints that motors move together. */
typedef struct rbdi_act_group {
    const rbd_transmission *by;
    int16_t n, first; /* shafts */
    int16_t dof[3];   /* of the joints */
    int16_t at[3];    /* their coordinates in q */
    rbdi_mat turn[2]; /* rods: joint frames at q = 0 in the frame before: axes, origin, joint axis */
    rbdi_v3 origin[2], axis[2];
    rbd_real G[9];       /* n x n: shaft speeds by joint speeds */
    rbd_real H[8];       /* rods, n x n x n: G by q */
    rbd_real inverse[9]; /* of G */
    rbd_real v[3];       /* speeds that the step was told last */
} rbdi_act_group;

struct rbd_actuators {
    const rbd_motor *motor;
    int n, groups, nq, nv, ring; /* ring: commands that each motor keeps */
    int fault;                   /* see rbd_actuators_fault */
    int begun, repeats;
    rbd_real dt, air;
    rbd_real share; /* of the way of a step that v_next makes: 1, or 1/2 */
    rbdi_act_shaft *shaft;
    rbdi_act_group *group;
    rbd_command *commands; /* n x ring */
};

#define RBDI_ACTUATORS_BYTES(n, groups, delay) \
    (RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_actuators)) + RBDI_ROUND((size_t)(n) * sizeof(rbdi_act_shaft)) + \
     RBDI_ROUND((size_t)(groups) * sizeof(rbdi_act_group)) + \
     RBDI_ROUND((size_t)(n) * (size_t)(delay) * sizeof(rbd_command)))

/* Bytes that rbd_actuators_init needs for n motors and so many transmissions; a constant. delay: the largest
   of the motors' */
#define RBD_ACTUATORS_SIZE(n, groups, delay) RBDI_ACTUATORS_BYTES(n, groups, delay)

#endif
