/* rbd_actuator.h - what stands between a motor's command and a joint's torque, on rbd.h.
   Made by src/amalgamate.py from src/rbd_actuator.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Motors with limits and heat, drives, gears with friction, springs and play, transmissions by matrix or
   rods, as const tables. One way for controllers: from wanted joint torques to currents. The other way for
   simulations: from commands to joint torques. Implemented by the same RBD_IMPLEMENTATION as rbd.h, in the
   same file. The currents that move an arm as planned:

       #define RBD_IMPLEMENTATION
       #include "rbd_actuator.h"

       static const rbd_motor motors[2] = {
           {.joint = "shoulder", .gear = 50, .constant = RBD_C(0.06), .inertia = RBD_C(1e-5),
            .friction = {.coulomb = RBD_C(0.4), .viscous = RBD_C(0.1)}},
           {.joint = "elbow", .gear = 30, .constant = RBD_C(0.06), .inertia = RBD_C(1e-5),
            .friction = {.coulomb = RBD_C(0.2), .viscous = RBD_C(0.05)}}};
       static unsigned char memory[RBD_ACTUATORS_SIZE(2, 0, 0)];
       rbd_actuators *a;
       rbd_drive drives[2];
       rbd_actuators_init(m, motors, 2, NULL, 0, memory, sizeof memory, &a, &report);

       rbd_rnea(m, w, q, v, acc, NULL, tau);   // of the plan
       rbd_actuators_inverse(a, q, v, acc, tau, drives);
       send(drives[0].current, drives[1].current);

   CONTENTS (search for the tag)
     [conventions] [configuration] [guarantees] [limits]
     [tables] [actuators] [inverse] [forward] [rotors]
     --- stop here if you only use it ---
     [method] [exponential] [friction code] [motor code] [cogging] [drive code] [rods] [transmission code]
     [inverse code] [laws of shafts] [search] [coupled shafts] [foretelling] [learning] [forward code]
     [derivatives code] [checks] [tables code] [rotors code] [text code]

   [conventions] Those of rbd.h, beyond them:
     shaft        the output of one motor's gear, in the data sheet's coordinate. Its angle times gear is the
                  rotor's. Torques, speeds, friction and gains of a motor are those at its shaft
     joint side   of a shaft: behind its spring, or the shaft itself if it is rigid. Without a transmission it
                  is the joint, with the same sign
     rigid        without a stiffness

   [configuration] That of rbd.h. RBD_LANES and RBD_REAL_CUSTOM do not go with it: friction branches on its
     data. With __float128 the part of friction at rest has the accuracy of double.

   [guarantees]
     Finite input gives finite output. Friction, springs and play add no energy in a step that settles,
     whatever its order and length are, but for rounding. No motor passes its limits at the step's end. A
     rotor that friction holds on a spring stays to the bit. The bits are the same on every machine with
     RBD_REPRODUCIBLE.

   [limits]
     A rigid shaft that its friction holds creeps by 1e-9 rad/s at most (float: 1e-6), in the step that stops
     it also by a rounding of its speed, 2e-15 of it (float: 1e-6), in the step in which it turns back by a
     thousandth, or gives way as its bristle says. The level of friction is that of the state before a step,
     and of the loads of the last one. Steps settle by repeats, of which there are 50 at most: then the last
     speeds count, which are finite, and some shaft has not the torque of its law. Cogging gives its own
     height of energy at most while teeth gear^2 cogging dt^2 is below twice the inertia that the shaft moves,
     and a drive's kd up to dt kd v^2 / 8, v the speed before, in a step of second order in which a shaft
     turns around. Not here: inductance, whose time constant is a millisecond or less, and the dynamics of the
     current's loop, rods with mass, tendons with slack, hysteresis of strain-wave gears, friction by
     temperature. That actuators belong to another robot cannot be seen: no call but the first takes a model.
*/
#include "rbd.h"

#ifndef RBD_ACTUATOR_H
#define RBD_ACTUATOR_H

#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd: rbd_actuator.h is of another version than rbd.h"
#endif

#if defined RBD_LANES || defined RBD_REAL_CUSTOM
#error "rbd: rbd_actuator.h needs a scalar, without RBD_LANES and RBD_REAL_CUSTOM"
#endif

RBDI_EXTERN_C_BEGIN

/* ==== src/api/actuator.h ==== */
#define rbd_friction_level RBDI_SYMBOL(rbd_friction_level)
#define rbd_actuators_init RBDI_SYMBOL(rbd_actuators_init)
#define rbd_actuators_size RBDI_SYMBOL(rbd_actuators_size)
#define rbd_actuators_finding_text RBDI_SYMBOL(rbd_actuators_finding_text)
#define rbd_actuators_map RBDI_SYMBOL(rbd_actuators_map)
#define rbd_actuators_fault RBDI_SYMBOL(rbd_actuators_fault)
#define rbd_actuators_inverse RBDI_SYMBOL(rbd_actuators_inverse)
#define rbd_actuators_reset RBDI_SYMBOL(rbd_actuators_reset)
#define rbd_actuators_begin RBDI_SYMBOL(rbd_actuators_begin)
#define rbd_actuators_again RBDI_SYMBOL(rbd_actuators_again)
#define rbd_actuators_get RBDI_SYMBOL(rbd_actuators_get)
#define rbd_actuators_derivatives RBDI_SYMBOL(rbd_actuators_derivatives)
#define rbd_rotor_torque RBDI_SYMBOL(rbd_rotor_torque)

/* ---- tables [tables] ----
   Constants of drives: const tables, which firmware keeps in flash. In float write RBD_C(0.05) or 0.05f. */

/* Friction of a gear, at its shaft. The level of dry friction at speed x, with torque t_m of the motor and
   t_x of the joint on the shaft, S = exp(-|x / speed|^power):

       coulomb + |load_joint t_x - load_motor t_m| + S (rest + |rest_joint t_x - rest_motor t_m| + Q)

   Q = square_joint t_x^2 if |t_x| < |t_m|, square_motor t_m^2 if |t_x| > |t_m|, and only where t_x and t_m do
   not have the same sign. It is M6 of Duclusaud and Passault (2024, arXiv 2410.08650); with fewer fields M1
   to M5. An efficiency eta is load_motor = 1 - eta; with load_joint = 1 the joint cannot drive the motor.
   Zero is a sensible default for every field. */
typedef struct rbd_gear_friction {
    rbd_const coulomb;                    /* N m: without load, at any speed */
    rbd_const viscous;                    /* N m s: times the speed, beside the level */
    rbd_const load_motor, load_joint;     /* shares of both torques: 0 to 0.999, 0 to 10 */
    rbd_const rest;                       /* N m more at rest: Stribeck's effect */
    rbd_const rest_motor, rest_joint;     /* the same at rest; load_motor + rest_motor to 0.999 */
    rbd_const square_motor, square_joint; /* 1/(N m): at rest, of the squares of both torques */
    rbd_const speed, power; /* rad/s, and 0.1 to 10: how the part of rest fades; needed if there is one */
    rbd_const bristle;      /* N m/rad: stiffness before it slips; 0: rigid */
    rbd_const still; /* rad/s: the inverse compensates slower motion in proportion; 0: in full at any speed */
} rbd_gear_friction;

/* A motor with drive, gear and, perhaps, a spring or play behind the gear. The shaft is the gear's output:
   its angle is that of the rotor divided by gear. Zero is a sensible default for all but gear, constant and,
   without a transmission, joint. For joints that slide read m for rad and N for N m. */
typedef struct rbd_motor {
    const char *name;     /* for findings; NULL = nameless */
    const char *joint;    /* name of the joint that it moves; NULL if a transmission moves it */
    rbd_const gear;       /* turns of the rotor for a turn of the shaft, or rad/m; signed, not 0 */
    rbd_const constant;   /* N m/A at the rotor; 1 for a drive that takes torques. Not 0 */
    rbd_const inertia;    /* kg m^2, of the rotor about its axis. 0 if the model has it as armature */
    rbd_const resistance; /* ohm */
    rbd_const current;    /* A: limit; 0: none */
    rbd_const voltage;    /* V: limit; with the resistance it gives the torque-speed line; 0: none */
    rbd_const copper;     /* 1/K: growth of the resistance above 25 degrees; copper 0.0039 */
    rbd_const heat_winding, heat_case; /* J/K; both 0: no heat; heat_case 0: the case is as cold as the air */
    rbd_const flow_winding, flow_case; /* K/W: from the winding to the case, from there to the air */
    rbd_const hot, hottest;          /* degrees: the limit of current falls between them to 0; both 0: none */
    rbd_const cogging, teeth, phase; /* N m at the rotor, periods in a turn of the rotor, rad */
    rbd_const step, offset;          /* rad at the shaft: of the encoder, its resolution and its error */
    rbd_const stiffness, damping; /* N m/rad, N m s/rad: of a spring from the gear to the joint; 0: rigid */
    rbd_const backlash;           /* rad: play of the spring; needs a stiffness */
    int delay;                    /* steps that a command takes to arrive, at most 1000 */
    int by_voltage; /* 1: the drive sets volts, as of a hobby servo, and needs a resistance; 0: the current */
    int sampled;    /* 1: the drive is as slow as the step, and may be unstable; 0: much faster, implicit */
    rbd_gear_friction friction;
} rbd_motor;

/* A crank on the rods' base, and a rod from its end to a point of the body that the joints move. */
typedef struct rbd_rod {
    rbd_const place[3];      /* of the crank's axis, m, axes of the base: the body before the first joint */
    rbd_const axis[3];       /* of the crank, of unit length, base's axes */
    rbd_const zero[3];       /* direction of the crank at angle 0, of unit length, across the axis. Angles are
                                within -pi and pi: the crank must not pass the opposite direction */
    rbd_const crank, length; /* m */
    rbd_const point[3];      /* m, of the last joint's body, link axes */
    int elbow;               /* 1 or -1: which of the two angles that the rod allows */
} rbd_rod;

typedef enum rbd_transmission_kind {
    RBD_BY_MATRIX, /* shaft speeds = matrix times joint speeds: differentials, belts across joints */
    RBD_BY_RODS    /* a crank and a rod for each of one or two joints in series: ankles, crank-rockers */
} rbd_transmission_kind;

/* As many motors as joints that move together: shaft speeds x = G(q) v, joint torques G' t. */
typedef struct rbd_transmission {
    const char *name; /* for findings; NULL = nameless */
    rbd_transmission_kind kind;
    int n;                /* motors and joints, 1 to 3; by rods 1 or 2 */
    int motor;            /* the first of its motors, which stand together in the table */
    const char *joint[3]; /* names of the joints; by rods from the base outwards */
    rbd_const matrix[9];  /* n x n, row-major: RBD_BY_MATRIX */
    rbd_rod rod[2];       /* n: RBD_BY_RODS */
} rbd_transmission;

/* The level of dry friction at a shaft's speed, N m.
   speed           rad/s, of the shaft
   motor, joint    N m at the shaft: torques of the motor and of the joint on it; at rest they cancel, joint =
                   -motor
   Returns 0 without a friction. */
RBDI_API rbd_real rbd_friction_level(const rbd_gear_friction *friction, rbd_real speed, rbd_real motor,
                                     rbd_real joint);

/* ---- actuators [actuators] ---- */

typedef struct rbd_actuators rbd_actuators; /* of one robot: its tables, and the state of each shaft */

/* Checks motors and transmissions, and prepares them in the caller's memory.
   motors          n of them, 1 or more; they must stay
   transmissions   `groups` of them, they must stay; may be NULL if groups is 0
   memory          size bytes of any alignment: RBD_ACTUATORS_SIZE or rbd_actuators_size
   a               receives the actuators, inside memory: do not move it; NULL after an error
   report          receives the error; may be NULL. body: the motor's index, or n + the transmission's;
                   field: of rbd_motor, rbd_gear_friction, rbd_transmission or rbd_rod
   Errors: RBD_ERR_NULL, _WORK, _MEMORY; _COUNT, n or groups, or a transmission's n; _INDEX, a joint that does
   not exist, has not one degree of freedom, or moves twice; motors that a transmission has not, or joints of
   rods that do not follow each other; _TYPE, a kind; _RANGE, a field that is missing, negative, not finite,
   out of range, or does nothing without another; _AXIS, of a crank; _ARMATURE, the model has the rotor's
   inertia too; _SINGULAR, a matrix. All shafts are at rest at angle 0, at 25 degrees: rbd_actuators_reset. */
RBDI_API rbd_status rbd_actuators_init(const rbd_model *m, const rbd_motor *motors, int n,
                                       const rbd_transmission *transmissions, int groups, void *memory,
                                       size_t size, rbd_actuators **a, rbd_report *report);

/* Bytes that rbd_actuators_init needs; 0 if a number is out of range.
   delay   the largest of the motors' */
RBDI_API size_t rbd_actuators_size(int n, int groups, int delay);

/* As rbd_finding_text, e.g. "motor 3 'elbow', field 'gear': missing".
   n   number of motors: the transmissions behind them are transmission 0, 1, ... */
RBDI_API char *rbd_actuators_finding_text(const rbd_finding *finding, int n, char *text, size_t size);

/* Shaft angles and speeds of a state of the robot, as encoders on the shafts see them where these are rigid.
   The calls below do it themselves.
   q, v           nq, nv; v may be NULL for zero
   angle, speed   n, rad and rad/s; each may be NULL
   Errors: RBD_ERR_NULL; _NAN, q or v is not finite or above 1e9; _INFEASIBLE, a rod does not reach;
   _SINGULAR, a rod at its dead centre: rbd_actuators_fault has the transmission; _ORDER, within a step:
   from rbd_actuators_begin to the rbd_actuators_again that returns 0, or to rbd_actuators_reset. */
RBDI_API rbd_status rbd_actuators_map(rbd_actuators *a, const rbd_real *q, const rbd_real *v, rbd_real *angle,
                                      rbd_real *speed);

/* The transmission at which the last rbd_actuators_map, _inverse, _reset or _begin failed; -1: none. */
RBDI_API int rbd_actuators_fault(const rbd_actuators *a);

/* ---- inverse [inverse] ---- */

/* What a motor shall do. */
typedef struct rbd_drive {
    rbd_real torque;  /* N m at the shaft, of the motor; within its limits */
    rbd_real current; /* A */
    rbd_real voltage; /* V, at the terminals: resistance times current, and the back-EMF */
    rbd_real angle;   /* rad, of the shaft on the motor's side of a spring, beyond the play: for a position
                         controller */
    int saturated;    /* 1 or -1: a limit cut the torque at its upper or lower end; else 0 */
    rbd_real by_torque, by_speed, by_acceleration; /* slopes of the uncut torque by what the joints ask of the
                                                      shaft: its torque, viscous speed and acceleration */
} rbd_drive;

/* Motor torques, currents and voltages for wanted joint torques: adds friction, the rotors' inertia and
   cogging, and obeys the limits at the present temperatures.
   q        nq
   v, acc   nv: the planned velocities and accelerations. With measured ones in place of planned, friction
            that is compensated in full makes a limit cycle: then at most 80 %
   tau      nv: wanted joint torques, as from rbd_rnea
   drives   n
   Errors: as rbd_actuators_map, _NAN of acc and tau too. */
RBDI_API rbd_status rbd_actuators_inverse(rbd_actuators *a, const rbd_real *q, const rbd_real *v,
                                          const rbd_real *acc, const rbd_real *tau, rbd_drive *drives);

/* ---- forward [forward] ----
   A step of a simulation:

       rbd_actuators_begin(a, commands, q, v, dt, 0, tau, damping);
       do rbd_contact_step(m, c, q, v, tau, NULL, damping, dt, q_next, v_next);
       while (rbd_actuators_again(a, v_next, tau, damping));

   Any other step that takes a damping will do. It starts each time from the same q and v, so q_next and
   v_next are other arrays. Other torques are added behind each of both calls. */

/* A command to the drive of a shaft, which gives torque + kp (q - angle) + kd (v - speed). With by_voltage it
   sets a voltage at the motor's terminals in place of a torque, and the gains add volts to it, so that they
   turn the shaft the same way. The current is then (volts - gear constant speed) / resistance. */
typedef struct rbd_command {
    rbd_real q, v;    /* rad, rad/s, of the shaft */
    rbd_real kp, kd;  /* N m/rad, N m s/rad, or V/rad, V s/rad; not negative */
    rbd_real torque;  /* N m at the shaft; 0 by voltage */
    rbd_real voltage; /* V, positive as the rotor turns; 0 if not by voltage */
} rbd_command;

/* Puts all shafts at rest where q has them, and their temperatures at that of the air. Commands under way are
   0, and a step that has begun is forgotten.
   q     nq
   air   degrees Celsius, -273 to 1000
   Errors: as rbd_actuators_map; RBD_ERR_RANGE, air. */
RBDI_API rbd_status rbd_actuators_reset(rbd_actuators *a, const rbd_real *q, rbd_real air);

/* Begins a step: what the shafts do to the joints, linear in the speeds at the step's end.
   commands       n
   first_order    how the step moves q. Not 0: by v_next alone, as rbd_contact_step with its option
                  first_order does; 0: half of the way by v, as it does without, and as rbd_free_step does.
                  Springs that are so stiff that they would vibrate faster than the step are damped by the
                  first, and ring with the second
   tau, damping   nv: torques tau - damping v_next; 0 where there is no motor
   A step that was begun before and has not ended is forgotten: its commands are taken back.
   Errors: as rbd_actuators_map but _ORDER; RBD_ERR_RANGE, dt not between 1e-9 and 1e3, or a command negative
   where it must not be, not finite or above 1e9, with a torque by voltage or a voltage by torque. */
RBDI_API rbd_status rbd_actuators_begin(rbd_actuators *a, const rbd_command *commands, const rbd_real *q,
                                        const rbd_real *v, rbd_real dt, int first_order, rbd_real *tau,
                                        rbd_real *damping);

/* Ends a step, and returns 0, if all shafts have at v_next the torques that the step was told. Else returns
   1: the step must be made again with the new tau and damping. After 50 repeats it takes what there is.
   v_next         nv: the speeds that came out. Where they are not finite or above 1e9, it returns 0; the
                  shafts, and the commands under way, stay as they were. Of coupled shafts it asks once more
                  before, without what it learnt of their inertia
   tau, damping   nv, as of rbd_actuators_begin
   Returns 0 also if a pointer is NULL or no step has begun. */
RBDI_API int rbd_actuators_again(rbd_actuators *a, const rbd_real *v_next, rbd_real *tau, rbd_real *damping);

/* A shaft after its last step that has ended. */
typedef struct rbd_actuator_state {
    rbd_real angle, speed; /* rad, rad/s: of the rotor, divided by gear */
    rbd_real motor, joint; /* N m at the shaft: torques of the motor, and of the shaft on the joint's side */
    rbd_real friction;     /* N m: the level of dry friction in the step */
    rbd_real current;      /* A */
    rbd_real winding, housing; /* degrees */
    int saturated;             /* as in rbd_drive */
    int repeats;               /* of the step; 50: it did not settle */
} rbd_actuator_state;

/* The state of a motor's shaft. Within a step, `friction` and `repeats` are those of this step so far.
   motor   its index in the table
   Errors: RBD_ERR_NULL, _INDEX. */
RBDI_API rbd_status rbd_actuators_get(const rbd_actuators *a, int motor, rbd_actuator_state *state);

/* Derivatives of the joint torques in the state at which rbd_actuators_begin was called, in continuous time:
   the drives' gains or springs that are in touch, viscous friction, and the transmissions. The level of dry
   friction counts as constant; cogging, the bias of the rotors' inertia and delayed commands are left out.
   dq, dv     nv x nv: by positions, in the sense of v, and by velocities; each may be NULL
   dcommand   nv x n, by the commands' torques, or voltages; may be NULL
   Errors: RBD_ERR_NULL; _ORDER, but between rbd_actuators_begin and the first rbd_actuators_again. */
RBDI_API rbd_status rbd_actuators_derivatives(const rbd_actuators *a, rbd_real *dq, rbd_real *dv,
                                              rbd_real *dcommand);

/* ---- rotors [rotors] ---- */

/* A rotor on a body, which is round about its axis. Its mass and its inertia at a standstill belong to the
   body; gear^2 inertia to the armature of the joint. */
typedef struct rbd_rotor {
    int body;          /* that it is mounted on; -1: the world */
    int dof;           /* index into v, that turns it */
    rbd_const axis[3]; /* body's axes, of any length; of a positive turn where gear is positive */
    rbd_const gear;    /* turns of the rotor relative to the body for a unit of v; not 0 */
    rbd_const inertia; /* kg m^2, about the axis */
} rbd_rotor;

/* Inverse dynamics as rbd_rnea, with what armature leaves out of n spinning rotors: their gyroscopic torques,
   and those by accelerations of the bodies that carry them. Featherstone (2008) section 9.6; Murphy, Wen and
   Saridis (1990). It calls rbd_kinematics with q, v and a.
   q, v, a, tau   nq, nv, nv, nv
   f_ext          nb x 6, in: external wrenches as for rbd_rnea, 0 without; out: with those of the rotors
   Errors: RBD_ERR_NULL, _WORK; _COUNT, n below 0; _INDEX, a body or dof; _AXIS; _RANGE, gear or inertia. */
RBDI_API rbd_status rbd_rotor_torque(const rbd_model *m, rbd_work *w, const rbd_rotor *rotors, int n,
                                     const rbd_real *q, const rbd_real *v, const rbd_real *a, rbd_real *f_ext,
                                     rbd_real *tau);

/* ==== src/rbd_actuator.h ==== */
RBDI_EXTERN_C_END

#endif /* RBD_ACTUATOR_H */

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

/* ==== src/base/letters_begin.h ==== */
#pragma push_macro("A")
#undef A
#pragma push_macro("E")
#undef E
#pragma push_macro("G")
#undef G
#pragma push_macro("H")
#undef H
#pragma push_macro("J")
#undef J
#pragma push_macro("K")
#undef K
#pragma push_macro("L")
#undef L
#pragma push_macro("P")
#undef P
#pragma push_macro("S")
#undef S
#pragma push_macro("T")
#undef T
#pragma push_macro("X")
#undef X

/* ==== src/rbd_actuator.h ==== */
#ifndef RBDI_ACTUATOR_LAYOUT
#define RBDI_ACTUATOR_LAYOUT

/* ==== src/actuator/layout.h ==== */
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

/* ==== src/rbd_actuator.h ==== */
#endif /* RBDI_ACTUATOR_LAYOUT */

#if defined RBD_IMPLEMENTATION && !defined RBDI_ACTUATOR_IMPLEMENTED
#define RBDI_ACTUATOR_IMPLEMENTED

RBDI_CODE_BEGIN

/* ==== src/actuator/exponential.h ==== */
/* ---- exponential [exponential] ----
   Exponential and logarithm from sums and products alone, as libm's differ between machines. Errors are below
   4 roundings. */

#define RBDI_LOG2_HIGH RBD_C(0.693145751953125) /* log 2 in two parts: multiples of the first are exact */
#define RBDI_LOG2_LOW RBD_C(1.42860682030941723e-6)
#if RBDI_REAL_KIND == 2
#define RBDI_EXP_TERMS 7
#define RBDI_LOG_TERMS 5
#else
#define RBDI_EXP_TERMS 14
#define RBDI_LOG_TERMS 12
#endif

/* 2^k for |k| <= 127. */
RBDI_PART rbd_real rbdi_act_power_of_two(int k) {
    rbd_real power = rbdi_set(RBD_C(1)), base = rbdi_set(k < 0 ? RBD_C(0.5) : RBD_C(2));
    for (int n = k < 0 ? -k : k; n > 0; n /= 2) {
        if (n % 2) power = power * base;
        base = base * base;
    }
    return power;
}

/* exp(x) for x up to 80; 0 below -80: 2^k and the result are finite and normal in float. */
RBDI_PART rbd_real rbdi_act_exponential(rbd_real x) {
    rbd_real r, sum = rbdi_set(RBD_C(1));
    int k;
    if (!(x > RBD_C(-80))) return rbdi_zero();

    /* x = k log 2 + r, |r| <= log(2) / 2;  exp(r) = 1 + r (1 + r/2 (1 + r/3 (...))) */
    k = (int)(x * RBD_C(1.4426950408889634) + (x < 0 ? RBD_C(-0.5) : RBD_C(0.5)));
    r = (x - (rbd_real)k * RBDI_LOG2_HIGH) - (rbd_real)k * RBDI_LOG2_LOW;
    for (int n = RBDI_EXP_TERMS; n > 0; --n) sum = 1 + sum * r / (rbd_real)n;
    return sum * rbdi_act_power_of_two(k);
}

/* log(x) for x from 1e-30 to 1e30. */
RBDI_PART rbd_real rbdi_act_logarithm(rbd_real x) {
    const rbd_const power[7] = {RBD_C(18446744073709551616.0), RBD_C(4294967296.0), 65536, 256, 16, 4, 2};
    rbd_real f, square, sum = rbdi_zero();
    int k = 0;

    /* x = 2^k y, y from sqrt(1/2) to sqrt(2); power[i] = 2^(64 >> i) */
    for (int i = 0; i < 7; ++i) {
        if (x >= power[i]) {
            x = x / power[i];
            k += 64 >> i;
        } else if (x * power[i] < 2) {
            x = x * power[i];
            k -= 64 >> i;
        }
    }
    if (x > RBD_C(1.4142135623730951)) {
        x = x / 2;
        k += 1;
    }

    /* log y = 2 (f + f^3/3 + f^5/5 + ...), f = (y - 1) / (y + 1) */
    f = (x - 1) / (x + 1);
    square = f * f;
    for (int n = RBDI_LOG_TERMS; n >= 0; --n) sum = sum * square + 1 / (rbd_real)(2 * n + 1);
    return (2 * f * sum + (rbd_real)k * RBDI_LOG2_LOW) + (rbd_real)k * RBDI_LOG2_HIGH;
}

/* ==== src/actuator/friction.h ==== */
/* ---- friction [friction code] ---- */

RBDI_INLINE rbd_real rbdi_act_clamp(rbd_real x, rbd_real lower, rbd_real upper) {
    return x < lower ? lower : x > upper ? upper : x;
}

/* -1, 0 or 1. */
RBDI_INLINE int rbdi_act_sign(rbd_real x) { return (x > 0) - (x < 0); }

/* Whether friction at rest differs from that of motion. */
RBDI_INLINE int rbdi_act_has_rest(const rbd_gear_friction *f) {
    return f->rest > 0 || f->rest_motor > 0 || f->rest_joint > 0 || f->square_motor > 0 ||
           f->square_joint > 0;
}

/* S = exp(-|x / speed|^power) = exp(-exp(power log |x / speed|)): the share of friction at rest. The
   logarithm takes 1e-30 to 1e30. Below, S is 1: with the least power, 0.1, it is 1e-3 off. Where the power
   of the ratio is above exp(5), S is below exp(-148), 0 in float and nothing beside 1. */
RBDI_PART rbd_real rbdi_act_rest_share(const rbd_gear_friction *f, rbd_real x) {
    rbd_real ratio;
    if (!rbdi_act_has_rest(f)) return rbdi_zero();
    ratio = rbdi_abs(x) / f->speed;
    if (!(ratio > RBD_C(1e-30))) return rbdi_set(RBD_C(1));
    if (ratio > RBD_C(1e30)) return rbdi_zero();
    ratio = f->power * rbdi_act_logarithm(ratio);
    return ratio > 5 ? rbdi_zero() : rbdi_act_exponential(-rbdi_act_exponential(ratio));
}

/* The level of rbd_gear_friction, where S is known. */
RBDI_PART rbd_real rbdi_act_level(const rbd_gear_friction *f, rbd_real S, rbd_real motor, rbd_real joint) {
    const rbd_real most = rbdi_set(RBDI_ACTUATOR_LARGEST);
    const rbd_real t_m = rbdi_act_clamp(motor, -most, most), t_x = rbdi_act_clamp(joint, -most, most);
    rbd_real level = f->coulomb + rbdi_abs(f->load_joint * t_x - f->load_motor * t_m);
    rbd_real rest;
    if (!(S > 0)) return level;

    rest = f->rest + rbdi_abs(f->rest_joint * t_x - f->rest_motor * t_m);
    if (rbdi_act_sign(t_x) != rbdi_act_sign(t_m)) {
        if (rbdi_abs(t_x) < rbdi_abs(t_m)) rest = rest + f->square_joint * t_x * t_x;
        if (rbdi_abs(t_x) > rbdi_abs(t_m)) rest = rest + f->square_motor * t_m * t_m;
    }
    level = level + S * rest;
    return level < most ? level : most;
}

RBDI_API rbd_real rbd_friction_level(const rbd_gear_friction *friction, rbd_real speed, rbd_real motor,
                                     rbd_real joint) {
    if (!friction) return rbdi_zero();
    return rbdi_act_level(friction, rbdi_act_rest_share(friction, speed), motor, joint);
}

/* ==== src/actuator/motor.h ==== */
/* ---- motor [motor code] ---- */

/* Torque at the shaft for an ampere; volts for a rad/s. */
RBDI_INLINE rbd_real rbdi_act_torque_constant(const rbd_motor *m) { return (rbd_real)m->gear * m->constant; }

/* Inertia of the rotor at the shaft. */
RBDI_INLINE rbd_real rbdi_act_rotor_inertia(const rbd_motor *m) {
    return (rbd_real)m->gear * m->gear * m->inertia;
}

/* Resistance of a winding of so many degrees. A cold one keeps a tenth of it: the line of copper would be 0
   at -231 degrees, and no motor works below -200. */
RBDI_INLINE rbd_real rbdi_act_resistance(const rbd_motor *m, rbd_real winding) {
    const rbd_real factor = 1 + m->copper * (winding - RBDI_ACTUATOR_WARM);
    return m->resistance * (factor > RBD_C(0.1) ? factor : rbdi_set(RBD_C(0.1)));
}

/* The limit of current at a temperature of the winding. */
RBDI_PART rbd_real rbdi_act_most_current(const rbd_motor *m, rbd_real winding) {
    const rbd_real most = m->current > 0 ? m->current : RBDI_ACTUATOR_UNLIMITED;
    if (!(m->hottest > m->hot)) return most;
    return most *
           rbdi_act_clamp((m->hottest - winding) / (m->hottest - m->hot), rbdi_zero(), rbdi_set(RBD_C(1)));
}

/* Least and largest current at shaft speed x: |I| <= most and |R I + K x| <= voltage. */
RBDI_PART void rbdi_act_current_range(const rbd_motor *m, rbd_real winding, rbd_real x, rbd_real *lower,
                                      rbd_real *upper) {
    const rbd_real most = rbdi_act_most_current(m, winding);
    const rbd_real back = rbdi_act_torque_constant(m) * x;
    *lower = -most;
    *upper = most;
    if (m->voltage > 0) {
        const rbd_real conductance = 1 / rbdi_act_resistance(m, winding);
        *lower = rbdi_act_clamp((-m->voltage - back) * conductance, -most, most);
        *upper = rbdi_act_clamp((m->voltage - back) * conductance, -most, most);
    }
}

/* ---- cogging [cogging] ----
   The torque gear cogging sin(theta), theta = teeth gear angle + phase, is that of the potential
   cogging / teeth cos(theta). In a step its work is what the potential loses if it is its mean over the way
   dt x of the shaft,

       gear cogging sin(theta + d/2) sin(d/2) / (d/2),   d = teeth gear dt x

   It is told at the speed x before the step and, where it holds the rotor back and d is within a radian, so
   that the torque changes evenly, implicit. The step's own way differs, and the work with it. The difference,
   s->lent, is paid back: above a tenth of a tooth's height, cogging has no torque in steps where it would add
   to that. So what it gives beyond its potential is bounded by a tooth's height while teeth gear^2 cogging
   dt^2 is below twice the inertia that the shaft moves (tests/test_actuator.c). */

/* Torque of cogging at the shaft. */
RBDI_PART rbd_real rbdi_act_cogging(const rbd_motor *m, rbd_real angle) {
    rbd_real sine, cosine;
    if (!(m->cogging > 0)) return rbdi_zero();
    rbdi_sincos((rbd_real)m->teeth * m->gear * angle + m->phase, &sine, &cosine);
    return (rbd_real)m->gear * m->cogging * sine;
}

/* How much energy cogging takes from its least to its largest, J. */
RBDI_INLINE rbd_real rbdi_act_tooth(const rbd_motor *m) { return 2 * (rbd_real)m->cogging / m->teeth; }

/* Adds to s->lent the work of cogging on the way from the shaft's angle, less what its potential loses. */
RBDI_PART void rbdi_act_lend(const rbd_motor *m, rbdi_act_shaft *s, rbd_real way) {
    const rbd_real rate = (rbd_real)m->teeth * m->gear;
    const rbd_real begin = rate * s->angle + m->phase;
    const rbd_real torque = s->cogging - s->cogging_slope * s->speed;
    rbd_real sine, before, after;
    if (!(m->cogging > 0)) return;

    rbdi_sincos(begin, &sine, &before);
    rbdi_sincos(begin + rate * way, &sine, &after);
    s->lent = s->lent + torque * way - rbdi_act_tooth(m) / 2 * (before - after);
}

/* Cogging in a step. */
RBDI_PART void rbdi_act_cog(const rbd_motor *m, rbdi_act_shaft *s, rbd_real dt, rbd_real share) {
    const rbd_real most = (rbd_real)m->gear * m->cogging;
    const rbd_real rate = (rbd_real)m->teeth * m->gear;
    const rbd_real half = rate * dt * s->speed / 2;
    rbd_real sine, cosine, mean = rbdi_set(RBD_C(1));
    s->cogging = s->cogging_slope = rbdi_zero();
    if (!(m->cogging > 0)) return;

    if (rbdi_abs(half) > 0) {
        rbdi_sincos(half, &sine, &cosine);
        mean = sine / half;
    }
    rbdi_sincos(rate * s->angle + m->phase + half, &sine, &cosine);
    s->cogging = most * sine * mean;

    if (rbdi_abs(s->lent) > rbdi_act_tooth(m) / 10 && s->lent * s->cogging * s->speed > 0) {
        s->cogging = rbdi_zero();
        return;
    }
    if (!(rate * most * cosine < 0) || rbdi_abs(half) > RBD_C(0.5)) return;
    s->cogging_slope = -most * rate * cosine * dt * share / 2;
    s->cogging = s->cogging + s->cogging_slope * s->speed;
}

/* A step of heat by implicit Euler; C_w, C_c capacities, g_w, g_c conductances, T above the air:

       C_w (T_w' - T_w) / dt = I^2 R - g_w (T_w' - T_c')
       C_c (T_c' - T_c) / dt = g_w (T_w' - T_c') - g_c T_c' */
RBDI_PART void rbdi_act_heat(const rbd_motor *m, rbdi_act_shaft *s, rbd_real current, rbd_real air,
                             rbd_real dt) {
    const rbd_real most = rbdi_set(RBDI_ACTUATOR_MOST), hottest = rbdi_set(RBDI_ACTUATOR_HOTTEST);
    rbd_real power, g_w, g_c, a_ww, a_cc, b_w, b_c, determinant;
    if (!(m->heat_winding > 0)) return;

    current = rbdi_act_clamp(current, -most, most);
    power = current * current * rbdi_act_resistance(m, s->winding + air);
    g_w = 1 / (rbd_real)m->flow_winding;
    a_ww = m->heat_winding / dt + g_w;
    b_w = m->heat_winding / dt * s->winding + power;
    if (!(m->heat_case > 0)) {
        s->winding = rbdi_act_clamp(b_w / a_ww, -hottest, hottest);
        return;
    }

    g_c = 1 / (rbd_real)m->flow_case;
    a_cc = m->heat_case / dt + g_w + g_c;
    b_c = m->heat_case / dt * s->housing;
    determinant = m->heat_winding / dt * a_cc + g_w * (m->heat_case / dt + g_c); /* a_ww a_cc - g_w^2 */
    s->winding = rbdi_act_clamp((a_cc * b_w + g_w * b_c) / determinant, -hottest, hottest);
    s->housing = rbdi_act_clamp((g_w * b_w + a_ww * b_c) / determinant, -hottest, hottest);
}

/* ---- drive [drive code] ---- */

/* What the encoder says: (angle + offset) in whole steps. */
RBDI_PART rbd_real rbdi_act_encoder(const rbd_motor *m, rbd_real angle) {
    const rbd_real seen = angle + m->offset;
    rbd_real steps;
    if (!(m->step > 0)) return seen;

    steps = seen / m->step;
    if (!(rbdi_abs(steps) < RBD_C(1e9))) return seen; /* beyond int32_t */
    return (rbd_real)(int32_t)(steps + (steps < 0 ? RBD_C(-0.5) : RBD_C(0.5))) * m->step;
}

/* A line t - braking x of a motor's torque by its speed. */
typedef struct rbdi_act_line {
    rbd_real t, braking;
    int saturated; /* as in rbd_drive */
} rbdi_act_line;

/* The line within the limits at speed x, which all fall with the speed:

       |t| <= most,   |t + droop x| <= stall */
RBDI_PART rbdi_act_line rbdi_act_limit(const rbdi_act_shaft *s, rbdi_act_line line, rbd_real x) {
    const rbd_real asked = line.t - line.braking * x;
    rbd_real given;
    line.saturated = 0;
    if (asked > s->stall - s->droop * x) line.saturated = 1;
    if (asked < -s->stall - s->droop * x) line.saturated = -1;
    if (line.saturated) {
        line.t = (rbd_real)line.saturated * s->stall;
        line.braking = s->droop;
    }

    given = line.t - line.braking * x;
    if (given <= s->most && given >= -s->most) return line;
    if (!line.saturated) line.saturated = given > 0 ? 1 : -1;
    line.t = given > 0 ? s->most : -s->most;
    line.braking = rbdi_zero();
    return line;
}

/* The motor's line at the speed x of its shaft at the step's end, without cogging. */
RBDI_PART rbdi_act_line rbdi_act_motor_at(const rbdi_act_shaft *s, rbd_real x) {
    rbdi_act_line line;
    line.t = s->t;
    line.braking = s->braking;
    line.saturated = 0;
    return rbdi_act_limit(s, line, x);
}

/* The limits at the winding's temperature. */
RBDI_PART void rbdi_act_note_limits(const rbd_motor *m, rbdi_act_shaft *s, rbd_real winding) {
    const rbd_real constant = rbdi_abs(rbdi_act_torque_constant(m));
    s->most = constant * rbdi_act_most_current(m, winding);
    s->stall = constant * RBDI_ACTUATOR_UNLIMITED;
    s->droop = rbdi_zero();
    if (m->voltage > 0 || m->by_voltage)
        s->droop = rbdi_act_clamp(constant * constant / rbdi_act_resistance(m, winding), rbdi_zero(),
                                  rbdi_set(RBDI_ACTUATOR_UNLIMITED));
    if (m->voltage > 0) s->stall = constant * m->voltage / rbdi_act_resistance(m, winding);
}

/* The torque that the drive asks for, at the angle and speed of its rotor:

       torque + kp (q - angle) + kd (v - speed)

   A drive by voltage sets volts, which are the torque K volts / R - droop speed. A quick drive has the angle
   and the speed of the step's end, angle + dt ((1 - share) speed + share x); one that samples those of its
   beginning. */
RBDI_PART void rbdi_act_drive_motor(const rbd_motor *m, rbdi_act_shaft *s, const rbd_command *c, rbd_real air,
                                    rbd_real dt, rbd_real share) {
    const rbd_real winding = s->winding + air, constant = rbdi_act_torque_constant(m);
    rbd_real kp = c->kp, kd = c->kd, droop = rbdi_zero(), feed = c->torque;
    rbdi_act_line line;

    rbdi_act_cog(m, s, dt, share);
    rbdi_act_note_limits(m, s, winding);
    s->pass = rbdi_set(RBD_C(1));
    if (m->by_voltage) {
        const rbd_real conductance = 1 / rbdi_act_resistance(m, winding);
        s->pass = constant * conductance;
        feed = s->pass * c->voltage;
        kp = rbdi_abs(s->pass) * kp;
        kd = rbdi_abs(s->pass) * kd;
        droop = s->droop;
    }

    s->t = feed + kp * (c->q - rbdi_act_encoder(m, s->angle)) + kd * c->v;
    s->now = s->t - (kd + droop) * s->speed;
    s->gain = kp;
    s->rate = kd + droop;
    if (m->sampled) {
        s->t = s->t - kd * s->speed;
        s->braking = droop;
    } else {
        s->t = s->t - kp * dt * (1 - share) * s->speed;
        s->braking = kd + droop + kp * dt * share;
    }

    /* in continuous time, at the step's beginning */
    line.t = s->now;
    line.braking = rbdi_zero();
    line = rbdi_act_limit(s, line, s->speed);
    s->now = line.t - line.braking * s->speed + s->cogging;
    if (!line.saturated) return;
    s->pass = s->gain = rbdi_zero();
    s->rate = line.braking;
}

/* ==== src/actuator/rods.h ==== */
/* ---- rods [rods] ----
   The rod of length L joins the crank's end C(theta) = place + c (zero cos + across sin), across = axis x
   zero, to the point P(q). With r = P - place, r_x = r.zero, r_y = r.across, rho = r_x^2 + r_y^2, |P - C| = L
   is

       r_x cos + r_y sin = h,   h = (r.r + c^2 - L^2) / (2 c)

   with d = P - C, primes by theta and indices by q:

       theta_k = d.P_k / w,  w = d.C'
       theta_jk = (d_k.P_j + d.P_jk - theta_j (d_k.C' + d.C'' theta_k)) / w,   d_k = P_k - C' theta_k
       P_k = e_k x (P - o_k),  P_jk = e_j x P_k, j the joint nearer to the base */

/* The rotation about the unit vector e whose sine and cosine are these. */
RBDI_LOCAL rbdi_mat rbdi_act_turn_about(rbdi_v3 e, rbd_real s, rbd_real c) {
    const rbdi_v3 u = rbdi_scale(1 - c, e);
    return rbdi_mat_of(c + u.x * e.x, u.x * e.y - s * e.z, u.x * e.z + s * e.y, u.y * e.x + s * e.z,
                       c + u.y * e.y, u.y * e.z - s * e.x, u.z * e.x - s * e.y, u.z * e.y + s * e.x,
                       c + u.z * e.z);
}

RBDI_INLINE rbdi_v3 rbdi_act_vec_of(const rbd_const x[3]) { return rbdi_vec(x[0], x[1], x[2]); }

/* The joints at q: where they are, and the pose of the last one's body; in the base's axes. */
typedef struct rbdi_act_rod_joints {
    int n;
    rbdi_v3 origin[2], axis[2];
    rbdi_mat turn;
} rbdi_act_rod_joints;

RBDI_LOCAL rbdi_act_rod_joints rbdi_act_place_joints(const rbdi_act_group *g, const rbd_real *q) {
    rbdi_act_rod_joints J;
    rbdi_v3 at = rbdi_vec0();
    J.n = g->n;
    J.turn = rbdi_mat_of(1, 0, 0, 0, 1, 0, 0, 0, 1);
    J.origin[1] = J.axis[1] = at;
    for (int j = 0; j < g->n; ++j) {
        rbd_real s, c;
        at = rbdi_add(at, rbdi_mul(J.turn, g->origin[j]));
        J.turn = rbdi_mul_mat(J.turn, g->turn[j]);
        J.origin[j] = at;
        J.axis[j] = rbdi_mul(J.turn, g->axis[j]);

        rbdi_sincos(q[g->at[j]], &s, &c);
        J.turn = rbdi_mul_mat(J.turn, rbdi_act_turn_about(g->axis[j], s, c));
    }
    return J;
}

/* Cosine and sine of the crank, for the rod's end at r from its axis. Whether it reaches. */
RBDI_LOCAL int rbdi_act_find_crank(const rbd_rod *rod, rbdi_v3 r, rbdi_v3 zero, rbdi_v3 across,
                                   rbd_real *cosine, rbd_real *sine) {
    const rbd_real c = rod->crank, L = rod->length, r_x = rbdi_dot(r, zero), r_y = rbdi_dot(r, across);
    const rbd_real rho = r_x * r_x + r_y * r_y;
    const rbd_real h = (rbdi_dot(r, r) + (c - L) * (c + L)) / (2 * c);
    const rbd_real left = rho - h * h;
    rbd_real root;
    if (!(left >= 0) || !(rho > 0)) return 0;

    root = rod->elbow < 0 ? -rbdi_sqrt(left) : rbdi_sqrt(left);
    *cosine = (h * r_x - root * r_y) / rho;
    *sine = (h * r_y + root * r_x) / rho;
    return 1;
}

/* Row i of G, its derivatives in H, and the crank's angle. */
RBDI_LOCAL rbd_status rbdi_act_map_rod(rbdi_act_group *g, const rbdi_act_rod_joints *J, int i,
                                       rbd_real *angle) {
    const rbd_rod *rod = &g->by->rod[i];
    const rbdi_v3 zero = rbdi_act_vec_of(rod->zero), across = rbdi_cross(rbdi_act_vec_of(rod->axis), zero);
    const rbdi_v3 P = rbdi_add(J->origin[J->n - 1], rbdi_mul(J->turn, rbdi_act_vec_of(rod->point)));
    const rbdi_v3 r = rbdi_sub(P, rbdi_act_vec_of(rod->place));
    rbdi_v3 C1, C2, d, P_j[2];
    rbd_real cosine, sine, w, *G = &g->G[i * J->n];
    if (!rbdi_act_find_crank(rod, r, zero, across, &cosine, &sine)) return RBD_ERR_INFEASIBLE;

    C2 = rbdi_scale(-(rbd_real)rod->crank, rbdi_add(rbdi_scale(cosine, zero), rbdi_scale(sine, across)));
    C1 = rbdi_scale(rod->crank, rbdi_sub(rbdi_scale(cosine, across), rbdi_scale(sine, zero)));
    d = rbdi_add(r, C2);
    w = rbdi_dot(d, C1);
    if (!(rbdi_abs(w) > RBDI_ACTUATOR_DEAD * rod->crank * rod->length)) return RBD_ERR_SINGULAR;

    *angle = rbdi_signed_angle(sine, cosine);
    for (int j = 0; j < J->n; ++j) {
        P_j[j] = rbdi_cross(J->axis[j], rbdi_sub(P, J->origin[j]));
        G[j] = rbdi_dot(d, P_j[j]) / w;
    }
    for (int j = 0; j < J->n; ++j)
        for (int k = 0; k < J->n; ++k) {
            const int nearer = j < k ? j : k, farther = j < k ? k : j;
            const rbdi_v3 P_jk = rbdi_cross(J->axis[nearer], P_j[farther]);
            const rbdi_v3 d_k = rbdi_sub(P_j[k], rbdi_scale(G[k], C1));
            const rbd_real turns = rbdi_dot(d_k, C1) + rbdi_dot(d, C2) * G[k];
            g->H[(i * J->n + j) * J->n + k] = (rbdi_dot(d_k, P_j[j]) + rbdi_dot(d, P_jk) - G[j] * turns) / w;
        }
    return RBD_OK;
}

/* G, H and the cranks' angles at q. */
RBDI_LOCAL rbd_status rbdi_act_map_rods(rbdi_act_group *g, const rbd_real *q, rbd_real *angle) {
    const rbdi_act_rod_joints J = rbdi_act_place_joints(g, q);
    rbd_status status = RBD_OK;
    for (int i = 0; i < g->n && !status; ++i) status = rbdi_act_map_rod(g, &J, i, &angle[i]);
    return status;
}

/* ==== src/actuator/transmission.h ==== */
/* ---- transmission [transmission code] ---- */

/* The inverse of G, n x n. Gauss and Jordan's method with row pivots. */
RBDI_LOCAL int rbdi_act_invert_small(const rbd_real *G, int n, rbd_real *inverse) {
    rbd_real a[9], largest = rbdi_zero();
    for (int i = 0; i < n * n; ++i) {
        a[i] = G[i];
        inverse[i] = rbdi_set(i % (n + 1) ? RBD_C(0) : RBD_C(1));
        if (rbdi_abs(a[i]) > largest) largest = rbdi_abs(a[i]);
    }

    for (int k = 0; k < n; ++k) {
        rbd_real pivot;
        int best = k;
        for (int i = k + 1; i < n; ++i)
            if (rbdi_abs(a[n * i + k]) > rbdi_abs(a[n * best + k])) best = i;
        if (!(rbdi_abs(a[n * best + k]) > RBDI_ACTUATOR_DEAD * largest) || largest < RBDI_ACTUATOR_DEAD)
            return 0;

        for (int j = 0; j < n; ++j) {
            const rbd_real x = a[n * k + j], y = inverse[n * k + j];
            a[n * k + j] = a[n * best + j];
            inverse[n * k + j] = inverse[n * best + j];
            a[n * best + j] = x;
            inverse[n * best + j] = y;
        }

        pivot = 1 / a[n * k + k];
        for (int j = 0; j < n; ++j) {
            a[n * k + j] = pivot * a[n * k + j];
            inverse[n * k + j] = pivot * inverse[n * k + j];
        }
        for (int i = 0; i < n; ++i) {
            const rbd_real factor = a[n * i + k];
            for (int j = 0; j < n && i != k; ++j) {
                a[n * i + j] = a[n * i + j] - factor * a[n * k + j];
                inverse[n * i + j] = inverse[n * i + j] - factor * inverse[n * k + j];
            }
        }
    }
    return 1;
}

/* G, its inverse, shaft angles and speeds of a group; bias: dG/dt v. */
RBDI_LOCAL rbd_status rbdi_act_map_group(const rbd_actuators *a, rbdi_act_group *g, const rbd_real *q,
                                         const rbd_real *v) {
    rbdi_act_shaft *s = &a->shaft[g->first];
    rbd_real angle[3] = {0, 0, 0};
    const int n = g->n;
    if (g->by->kind == RBD_BY_RODS) {
        const rbd_status status = rbdi_act_map_rods(g, q, angle);
        if (status) return status;
        if (!rbdi_act_invert_small(g->G, n, g->inverse)) return RBD_ERR_SINGULAR;
    }

    for (int i = 0; i < n; ++i) {
        s[i].phi = angle[i];
        s[i].x = rbdi_zero();
        s[i].bias = rbdi_zero();
        for (int j = 0; j < n; ++j) {
            if (g->by->kind != RBD_BY_RODS) s[i].phi = s[i].phi + g->G[n * i + j] * q[g->at[j]];
            if (v) s[i].x = s[i].x + g->G[n * i + j] * v[g->dof[j]];
            for (int k = 0; k < n && v && g->by->kind == RBD_BY_RODS; ++k)
                s[i].bias = s[i].bias + g->H[(n * i + j) * n + k] * v[g->dof[j]] * v[g->dof[k]];
        }
    }
    return RBD_OK;
}

/* Whether all are finite and can be computed with: their squares' sum is; not of NaN. */
RBDI_PART int rbdi_act_all_moderate(const rbd_real *x, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + x[i] * x[i];
    return sum <= RBDI_ACTUATOR_MOST * RBDI_ACTUATOR_MOST;
}

/* Angles and speeds of all shafts; v may be NULL. */
RBDI_LOCAL rbd_status rbdi_act_map(rbd_actuators *a, const rbd_real *q, const rbd_real *v) {
    a->fault = -1;
    if (!rbdi_act_all_moderate(q, a->nq) || (v && !rbdi_act_all_moderate(v, a->nv))) return RBD_ERR_NAN;

    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        if (s->dof < 0) continue;
        s->phi = q[s->at];
        s->x = v ? v[s->dof] : rbdi_zero();
    }
    for (int i = 0; i < a->groups; ++i) {
        const rbd_status status = rbdi_act_map_group(a, &a->group[i], q, v);
        if (status) a->fault = i;
        if (status) return status;
    }
    return RBD_OK;
}

/* Speed of shaft i of a group at joint speeds v. */
RBDI_INLINE rbd_real rbdi_act_shaft_speed(const rbdi_act_group *g, int i, const rbd_real *v) {
    rbd_real x = rbdi_zero();
    for (int j = 0; j < g->n; ++j) x = x + g->G[g->n * i + j] * v[g->dof[j]];
    return x;
}

RBDI_API rbd_status rbd_actuators_map(rbd_actuators *a, const rbd_real *q, const rbd_real *v, rbd_real *angle,
                                      rbd_real *speed) {
    rbd_status status;
    if (!a || !q) return RBD_ERR_NULL;
    if (a->begun) return RBD_ERR_ORDER;
    status = rbdi_act_map(a, q, v);
    for (int i = 0; i < a->n && !status; ++i) {
        if (angle) angle[i] = a->shaft[i].phi;
        if (speed) speed[i] = a->shaft[i].x;
    }
    return status;
}

RBDI_API int rbd_actuators_fault(const rbd_actuators *a) { return a ? a->fault : -1; }

/* ==== src/actuator/inverse.h ==== */
/* ---- inverse [inverse code] ---- */

/* What the joints ask of a shaft. side: direction of its friction, -1 to 1. */
typedef struct rbdi_act_wanted {
    rbd_real torque, speed, acceleration, side;
} rbdi_act_wanted;

/* Newton's method for u = base + side F(u, -t), F the level at rest share S. It is linear in pieces but for
   the squares: two steps do as a rule, and each further one passes a bend of the level, of which there are
   fewer than eight. Writes the slopes by t, base and so on. */
RBDI_PART rbd_real rbdi_act_carry_load(const rbd_gear_friction *f, rbd_real S, const rbdi_act_wanted *want,
                                       rbd_real base, rbd_real *slope, rbd_real *by_torque) {
    const rbd_real t = want->torque, one = rbdi_set(RBD_C(1));
    rbd_real u = base;
    *slope = one;
    *by_torque = one;
    for (int k = 0; k < 8; ++k) {
        const rbd_real error = u - base - want->side * rbdi_act_level(f, S, u, -t);
        const rbd_real moving = (rbd_real)rbdi_act_sign(f->load_joint * t + f->load_motor * u);
        const rbd_real resting = S * (rbd_real)rbdi_act_sign(f->rest_joint * t + f->rest_motor * u);
        const int driven = t * u > 0 && rbdi_abs(u) < rbdi_abs(t);
        const int drives = t * u > 0 && rbdi_abs(u) > rbdi_abs(t);
        const rbd_real of_u = moving * f->load_motor + resting * f->rest_motor +
                              (driven ? 2 * S * f->square_motor * u : rbdi_zero());
        const rbd_real of_t = moving * f->load_joint + resting * f->rest_joint +
                              (drives ? 2 * S * f->square_joint * t : rbdi_zero());

        *slope = one - want->side * of_u;
        if (*slope < RBDI_ACTUATOR_SLOPE) *slope = rbdi_set(RBDI_ACTUATOR_SLOPE);
        *by_torque = one + want->side * of_t;
        if (!(rbdi_abs(error) > 4 * RBDI_EPS * (rbdi_abs(u) + rbdi_abs(base)))) break;
        u = u - error / *slope;
    }
    return u;
}

/* How far the motor's side of a spring is ahead of the joint's where it gives torque t: it is beyond half of
   the play. */
RBDI_PART rbd_real rbdi_act_winding_of(const rbd_motor *m, rbd_real t) {
    if (!(m->stiffness > 0)) return rbdi_zero();
    return t / m->stiffness + (rbd_real)rbdi_act_sign(t) * (m->backlash / 2);
}

/* One shaft: u = t + J x' + viscous x + side F - cogging, within the limits. */
RBDI_ONCE void rbdi_act_invert_shaft(const rbd_motor *m, const rbdi_act_shaft *s, const rbdi_act_wanted *want,
                                     rbd_real air, rbd_drive *drive) {
    const rbd_gear_friction *f = &m->friction;
    const rbd_real constant = rbdi_act_torque_constant(m), J = rbdi_act_rotor_inertia(m),
                   winding = s->winding + air;
    rbd_real u = want->torque + J * want->acceleration + f->viscous * want->speed;
    rbd_real slope = rbdi_set(RBD_C(1)), by_torque = slope, current, lower, upper;

    if (f->load_motor > 0 || f->load_joint > 0 || rbdi_act_has_rest(f)) {
        const rbd_real S = rbdi_act_rest_share(f, want->speed);
        u = rbdi_act_carry_load(f, S, want, u, &slope, &by_torque);
    } else {
        u = u + want->side * f->coulomb;
    }
    drive->by_torque = by_torque / slope;
    drive->by_speed = f->viscous / slope;
    drive->by_acceleration = J / slope;
    drive->angle = s->phi + rbdi_act_winding_of(m, want->torque);

    if (m->cogging > 0) u = u - rbdi_act_cogging(m, drive->angle);
    current = u / constant;
    rbdi_act_current_range(m, winding, want->speed, &lower, &upper);
    drive->saturated = 0;
    if (current > upper) {
        drive->saturated = constant > 0 ? 1 : -1;
        current = upper;
    }
    if (current < lower) {
        drive->saturated = constant > 0 ? -1 : 1;
        current = lower;
    }
    drive->current = current;
    drive->torque = drive->saturated ? current * constant : u;
    drive->voltage = rbdi_act_resistance(m, winding) * current + constant * want->speed;
}

/* The direction of friction at a planned speed. */
RBDI_INLINE rbd_real rbdi_act_side(const rbd_gear_friction *f, rbd_real x) {
    if (!(f->still > 0)) return (rbd_real)rbdi_act_sign(x);
    return rbdi_act_clamp(x / f->still, rbdi_set(RBD_C(-1)), rbdi_set(RBD_C(1)));
}

/* Of the shaft in the mapped state, where the joints ask for this torque and acceleration. */
RBDI_LOCAL void rbdi_act_invert_at(const rbd_actuators *a, int i, rbd_real torque, rbd_real acceleration,
                                   rbd_drive *drives) {
    const rbdi_act_shaft *s = &a->shaft[i];
    rbdi_act_wanted want;
    want.torque = torque;
    want.speed = s->x;
    want.acceleration = acceleration;
    want.side = rbdi_act_side(&a->motor[i].friction, s->x);
    rbdi_act_invert_shaft(&a->motor[i], s, &want, a->air, &drives[i]);
}

/* The shafts of a transmission: t = G^-T tau, x' = G v' + bias. */
RBDI_LOCAL void rbdi_act_invert_group(const rbd_actuators *a, const rbdi_act_group *g, const rbd_real *acc,
                                      const rbd_real *tau, rbd_drive *drives) {
    for (int i = 0; i < g->n; ++i) {
        const rbd_real acceleration = a->shaft[g->first + i].bias + rbdi_act_shaft_speed(g, i, acc);
        rbd_real torque = rbdi_zero();
        for (int j = 0; j < g->n; ++j) torque = torque + g->inverse[g->n * j + i] * tau[g->dof[j]];
        rbdi_act_invert_at(a, g->first + i, torque, acceleration, drives);
    }
}

RBDI_API rbd_status rbd_actuators_inverse(rbd_actuators *a, const rbd_real *q, const rbd_real *v,
                                          const rbd_real *acc, const rbd_real *tau, rbd_drive *drives) {
    rbd_status status;
    if (!a || !q || !v || !acc || !tau || !drives) return RBD_ERR_NULL;
    if (a->begun) return RBD_ERR_ORDER;
    status = rbdi_act_map(a, q, v);
    if (status) return status;
    if (!rbdi_act_all_moderate(acc, a->nv) || !rbdi_act_all_moderate(tau, a->nv)) return RBD_ERR_NAN;

    for (int i = 0; i < a->n; ++i) {
        const int dof = a->shaft[i].dof;
        if (dof >= 0) rbdi_act_invert_at(a, i, tau[dof], acc[dof], drives);
    }
    for (int i = 0; i < a->groups; ++i) rbdi_act_invert_group(a, &a->group[i], acc, tau, drives);
    return RBD_OK;
}

/* ==== src/actuator/laws.h ==== */
/* ---- laws [laws of shafts] ----
   The motor's torque m(y) at its speed y of the step's end is what the drive asks for within its limits,
   rbdi_act_motor_at, and cogging; it falls with y. A rigid shaft, whose rotor turns with the joint, gives at
   the end's speed x = y the torque

       m(x) - J ((x - x_0) / dt + bias) - viscous (x - still) - dry,   dry = clamp(F (x - still) / w, -F, F)

   with the level F and the speed before the step x_0. Its work is that times the mean speed by which the
   joint moves, x_m = (1 - share) x_0 + share x. In a step of first order, share = 1, still is 0. Else
   friction at the end's speed makes energy where a shaft turns around: there x and x_m are against each
   other. So

       still = clamp(x, -turn, 0) or clamp(x, 0, -turn),   turn = x_0 (1 - share) / share

   which lies between the speeds at which x and x_m vanish: friction is 0 or against both of them, so that it
   takes dt friction x_m >= 0 whatever dt is. In between the shaft coasts. It is the law of the bounded rows
   of rbd_contact_step, but for the width w: what sticks creeps here, at most by w = RBDI_ACTUATOR_CREEP, and
   what turned around, still = -turn, has w = RBDI_ACTUATOR_BEND turn more. A bristle of stiffness k that has
   the torque b makes dry = clamp(b + k dt x_m, -F, F).

   A shaft with a spring, whose rotor has an angle and a speed y of its own. With delta = angle - phi,
   play 2 h, K = dt k + d, r = y - x_m the joint gets the impulse

       p = max(0, dt k (delta - h) + dt K r) + min(0, dt k (delta + h) + dt K r)
       J (y - y_0) = dt (m(y) - viscous y) - p + p_f,   p_f = -dt F sign(y), or less at y = 0

   Both are solved exactly for each line of m: first with y = 0; if friction cannot hold the rotor so, with
   p_f = +-dt F. The line is the right one if it is that of m at the y that comes out. The energy of the
   spring changes by p r at most, that of the joints by p x_m, and that of the rotor by (p_f - p) y at most:
   together they do not grow. */

/* A piece of a law: the torque start - slope x. */
typedef struct rbdi_act_piece {
    rbd_real start, slope;
} rbdi_act_piece;

RBDI_INLINE rbd_real rbdi_act_torque_of(rbdi_act_piece piece, rbd_real x) {
    return piece.start - piece.slope * x;
}

/* Mean speed of a step on the joint's side. */
RBDI_INLINE rbd_real rbdi_act_mean(const rbd_actuators *a, const rbdi_act_shaft *s, rbd_real x) {
    return (1 - a->share) * s->x + a->share * x;
}

/* The speed `still` of [laws of shafts], and whether the shaft coasts. */
typedef struct rbdi_act_turning {
    rbd_real still;
    int coasts;
} rbdi_act_turning;

RBDI_INLINE rbdi_act_turning rbdi_act_turning_at(const rbd_actuators *a, const rbdi_act_shaft *s,
                                                 rbd_real x) {
    const rbd_real turned = -s->x * (1 - a->share) / a->share;
    const rbd_real least = turned < 0 ? turned : rbdi_zero();
    const rbd_real most = turned > 0 ? turned : rbdi_zero();
    rbdi_act_turning turning;
    turning.still = rbdi_act_clamp(x, least, most);
    turning.coasts = x > least && x < most;
    return turning;
}

/* How well a step that begins with the shaft's speed tells the speed of its end. */
RBDI_INLINE rbd_real rbdi_act_speed_rounding(const rbdi_act_shaft *s) {
    return RBDI_ACTUATOR_ROUNDING * rbdi_abs(s->x);
}

/* The dry friction of a rigid shaft at speed x. */
RBDI_PART rbdi_act_piece rbdi_act_dry(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                      const rbd_actuators *a) {
    const rbdi_act_turning turning = rbdi_act_turning_at(a, s, x);
    rbdi_act_piece dry;
    rbd_real torque;
    if (m->friction.bristle > 0) {
        dry.start = -(s->bristle + m->friction.bristle * a->dt * (1 - a->share) * s->x);
        dry.slope = m->friction.bristle * a->dt * a->share;
    } else {
        const rbd_real width =
            RBDI_ACTUATOR_CREEP + rbdi_act_speed_rounding(s) + RBDI_ACTUATOR_BEND * rbdi_abs(turning.still);
        dry.slope = turning.coasts ? rbdi_zero() : s->level / width;
        dry.start = dry.slope * turning.still;
    }

    torque = rbdi_act_torque_of(dry, x);
    if (torque <= s->level && torque >= -s->level) return dry;
    dry.start = torque > 0 ? s->level : -s->level;
    dry.slope = rbdi_zero();
    return dry;
}

/* -1 or 1 where dry friction slides at the speed before the step, 0 where it sticks. */
RBDI_PART int rbdi_act_slides(const rbd_motor *m, const rbdi_act_shaft *s, const rbd_actuators *a) {
    const rbdi_act_piece dry = rbdi_act_dry(m, s, s->x, a);
    return dry.slope > 0 ? 0 : -rbdi_act_sign(dry.start);
}

/* A rigid shaft without its dry friction. */
RBDI_PART rbdi_act_piece rbdi_act_rigid_without(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                                const rbd_actuators *a) {
    const rbdi_act_line line = rbdi_act_motor_at(s, x);
    const rbdi_act_turning turning = rbdi_act_turning_at(a, s, x);
    const rbd_real viscous = turning.coasts ? rbdi_zero() : rbdi_set(m->friction.viscous);
    const rbd_real J = rbdi_act_rotor_inertia(m);
    rbdi_act_piece piece;
    piece.start = line.t + s->cogging + viscous * turning.still + J * (s->x / a->dt - s->bias);
    piece.slope = line.braking + s->cogging_slope + viscous + J / a->dt;
    return piece;
}

RBDI_PART rbdi_act_piece rbdi_act_rigid_law(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                            const rbd_actuators *a) {
    const rbdi_act_piece dry = rbdi_act_dry(m, s, x, a);
    rbdi_act_piece piece = rbdi_act_rigid_without(m, s, x, a);
    piece.start = piece.start + dry.start;
    piece.slope = piece.slope + dry.slope;
    return piece;
}

/* What a spring does: the impulse on the joint, its slope by -x_m, the rotor's speed. */
typedef struct rbdi_act_spring {
    rbd_real p, slope, y;
} rbdi_act_spring;

/* K of [laws of shafts]: what the spring's torque gains in a step by each rad/s. */
RBDI_INLINE rbd_real rbdi_act_spring_slope(const rbd_motor *m, rbd_real dt) {
    return dt * m->stiffness + m->damping;
}

/* How far the spring is wound beyond the play, on its side 1 or -1. */
RBDI_INLINE rbd_real rbdi_act_wound(const rbd_motor *m, const rbdi_act_shaft *s, int side) {
    return s->angle - s->phi - (rbd_real)side * (m->backlash / 2);
}

/* The spring where the rotor's speed would be r + x_m without it, and falls by e for each unit of p. */
RBDI_PART rbd_real rbdi_act_mesh(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real r, rbd_real e,
                                 rbd_real dt) {
    const rbd_real K = rbdi_act_spring_slope(m, dt);
    const rbd_real up = dt * (m->stiffness * rbdi_act_wound(m, s, 1) + K * r) / (1 + dt * K * e);
    const rbd_real down = dt * (m->stiffness * rbdi_act_wound(m, s, -1) + K * r) / (1 + dt * K * e);
    return up > 0 ? up : down < 0 ? down : rbdi_zero();
}

/* The speed y of a rotor that gets the impulse `given` and gives p to the spring: with w, what the spring is
   wound,

       J_t y = given - p,   p = dt (k w + K (y - x_m))

   If it is light and the spring is stiff, the difference given - p is rounding. So p is put in. */
RBDI_PART rbd_real rbdi_act_meshed_speed(const rbd_motor *m, const rbdi_act_shaft *s,
                                         const rbdi_act_spring *spring, rbd_real given, rbd_real J_t,
                                         rbd_real x_m, rbd_real dt) {
    const int side = rbdi_act_sign(spring->p);
    const rbd_real wound = rbdi_act_wound(m, s, side);
    const rbd_real K = rbdi_act_spring_slope(m, dt);
    return side ? (given + dt * (K * x_m - m->stiffness * wound)) / (J_t + dt * K) : given / J_t;
}

/* The spring's law at the speed x of the joint's side, if this is the motor's line. */
RBDI_PART rbdi_act_spring rbdi_act_spring_by(const rbd_motor *m, const rbdi_act_shaft *s, rbdi_act_line line,
                                             rbd_real x, const rbd_actuators *a) {
    const rbd_real dt = a->dt, x_m = rbdi_act_mean(a, s, x), most = dt * s->level;
    const rbd_real t = line.t + s->cogging;
    const rbd_real braking = line.braking + s->cogging_slope;
    const rbd_real J = rbdi_act_rotor_inertia(m);
    const rbd_real J_t = J + dt * (braking + m->friction.viscous);
    const rbd_real K = rbdi_act_spring_slope(m, dt);
    const rbd_real given = J * s->speed + dt * t;
    rbdi_act_spring spring;

    spring.y = rbdi_zero();
    spring.slope = K;
    spring.p = rbdi_act_mesh(m, s, -x_m, rbdi_zero(), dt);
    if (rbdi_abs(spring.p - given) > most) {
        const rbd_real friction = spring.p > given ? most : -most;
        spring.slope = K / (1 + dt * K / J_t);
        spring.p = rbdi_act_mesh(m, s, (given + friction) / J_t - x_m, 1 / J_t, dt);
        spring.y = rbdi_act_meshed_speed(m, s, &spring, given + friction, J_t, x_m, dt);
    }
    if (!(rbdi_abs(spring.p) > 0)) spring.slope = rbdi_zero();
    return spring;
}

/* The lines of a motor: what the drive asks for, the limits of the current and of the voltage. */
RBDI_PART rbdi_act_line rbdi_act_line_of(const rbdi_act_shaft *s, int number) {
    rbdi_act_line line;
    line.saturated = number == 0 ? 0 : number % 2 ? 1 : -1;
    line.t = number == 0 ? s->t : (rbd_real)line.saturated * (number > 2 ? s->stall : s->most);
    line.braking = number == 0 ? s->braking : number > 2 ? s->droop : rbdi_zero();
    return line;
}

/* With the line that is the motor's at the rotor's speed. As all laws are monotone, one is. */
RBDI_PART rbdi_act_spring rbdi_act_spring_at(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                             const rbd_actuators *a) {
    rbdi_act_spring best;
    rbd_real least = rbdi_zero();
    for (int k = 0; k < 5; ++k) {
        const rbdi_act_line line = rbdi_act_line_of(s, k);
        const rbdi_act_spring spring = rbdi_act_spring_by(m, s, line, x, a);
        const rbdi_act_line there = rbdi_act_motor_at(s, spring.y);
        const rbd_real off =
            rbdi_abs(line.t - line.braking * spring.y - (there.t - there.braking * spring.y));
        if (k == 0 || off < least) {
            least = off;
            best = spring;
        }
        if (!(least > 0)) break;
    }
    return best;
}

/* The piece of a shaft's law at the speed x of its joint's side. */
RBDI_PART rbdi_act_piece rbdi_act_law(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                      const rbd_actuators *a) {
    rbdi_act_piece piece;
    rbdi_act_spring spring;
    if (!(m->stiffness > 0)) return rbdi_act_rigid_law(m, s, x, a);

    spring = rbdi_act_spring_at(m, s, x, a);
    piece.slope = a->share * spring.slope;
    piece.start = spring.p / a->dt + piece.slope * x;
    return piece;
}

/* The torque of a shaft's law at the speed x of its joint's side. */
RBDI_PART rbd_real rbdi_act_law_at(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real x,
                                   const rbd_actuators *a) {
    return rbdi_act_torque_of(rbdi_act_law(m, s, x, a), x);
}

/* By how much the joint's torque T at speed x is not that of the law. The speed is known to its rounding in
   a step that begins with s->x and, of coupled shafts, to a->speed_rounding. A coupled shaft may have any
   torque within the level of friction while it sticks: there x is rounding. */
RBDI_PART rbd_real rbdi_act_off(const rbd_motor *m, const rbdi_act_shaft *s, rbd_real T, rbd_real x,
                                const rbd_actuators *a) {
    const int sticks = s->dof < 0 && !(m->stiffness > 0) && !(m->friction.bristle > 0);
    const rbd_real creep = sticks ? RBDI_ACTUATOR_CREEP * (1 + s->scale) : rbdi_zero();
    const rbd_real rounding = a->speed_rounding + rbdi_act_speed_rounding(s);
    const rbd_real slower = x - rounding;
    const rbd_real faster = x + rounding;
    rbd_real least, most;
    if (!sticks) {
        least = rbdi_act_law_at(m, s, faster, a);
        most = rbdi_act_law_at(m, s, slower, a);
    } else {
        least = rbdi_act_torque_of(rbdi_act_rigid_without(m, s, faster, a), faster) +
                rbdi_act_torque_of(rbdi_act_dry(m, s, faster + creep, a), faster + creep);
        most = rbdi_act_torque_of(rbdi_act_rigid_without(m, s, slower, a), slower) +
               rbdi_act_torque_of(rbdi_act_dry(m, s, slower - creep, a), slower - creep);
    }
    return T - rbdi_act_clamp(T, least, most);
}

/* The size of what the law adds up at the new speed, N m; not so small that rounding is another. A spring
   passes on the share slope / (dt stiffness + damping) of what it adds up. */
RBDI_PART rbd_real rbdi_act_size(const rbd_motor *m, const rbdi_act_shaft *s, const rbd_actuators *a) {
    const rbdi_act_piece law = rbdi_act_law(m, s, s->next, a);
    const rbd_real wound = rbdi_abs(s->angle - s->phi) + m->backlash;
    const rbd_real speeds = rbdi_abs(s->x) + rbdi_abs(s->next) + rbdi_abs(s->speed);
    const rbd_real K = rbdi_act_spring_slope(m, a->dt);
    rbd_real size = rbdi_abs(law.start) + rbdi_abs(law.slope * s->next) + rbdi_abs(s->force) +
                    rbdi_abs(s->t) + rbdi_abs(s->cogging) + s->level + RBDI_ACTUATOR_NOTHING;
    if (K > 0) size = size + law.slope / (a->share * K) * (m->stiffness * wound + K * speeds);
    return size;
}

/* The state of the shaft at the end of the step, where the joint's side has speed x and gets s->force. */
RBDI_PART void rbdi_act_end_shaft(const rbd_motor *m, rbdi_act_shaft *s, rbd_real x, const rbd_actuators *a) {
    rbdi_act_line line;
    rbd_real t, way;
    s->joint = s->force;
    if (m->stiffness > 0) {
        const rbdi_act_spring spring = rbdi_act_spring_at(m, s, x, a);
        s->joint = spring.p / a->dt;
        s->speed = spring.y;
        way = a->dt * spring.y;
    } else {
        s->speed = x;
        way = a->dt * rbdi_act_mean(a, s, x);
        if (m->friction.bristle > 0) s->bristle = -rbdi_act_torque_of(rbdi_act_dry(m, s, x, a), x);
    }

    rbdi_act_lend(m, s, way);
    s->angle = s->angle + way;

    line = rbdi_act_motor_at(s, s->speed);
    t = line.t - line.braking * s->speed;
    s->saturated = (int16_t)line.saturated;
    s->motor = t + (s->cogging - s->cogging_slope * s->speed);
    s->current = t / rbdi_act_torque_constant(m);
    rbdi_act_heat(m, s, s->current, a->air, a->dt);
}

/* ==== src/actuator/search.h ==== */
/* ---- search [search] ----
   The way from the points of the shafts to new speeds, `next`, where the joints ask for `force`. */

/* Slope of the function of [method] at the share c of the way. */
RBDI_LOCAL rbd_real rbdi_act_growth(const rbd_actuators *a, rbd_real c) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real d = s->next - s->point;
        const rbd_real x = s->point + c * d;
        const rbd_real T = s->base + c * (s->force - s->base);
        sum = sum + (T - rbdi_act_law_at(&a->motor[i], s, x, a)) * d;
    }
    return sum;
}

/* Whether the function grows at the new speeds by a quarter of what it falls at the points. */
RBDI_LOCAL int rbdi_act_overshoots(const rbd_actuators *a) {
    const rbd_real falls = -rbdi_act_growth(a, rbdi_zero());
    return falls > 0 && rbdi_act_growth(a, rbdi_set(RBD_C(1))) > RBD_C(0.25) * falls;
}

/* The share of the way at which the function is least. */
RBDI_LOCAL rbd_real rbdi_act_least(const rbd_actuators *a) {
    rbd_real least = rbdi_zero(), most = rbdi_set(RBD_C(1));
    const rbd_real half = rbdi_set(RBD_C(0.5));
    for (int k = 0; k < RBDI_ACTUATOR_HALVINGS; ++k) {
        const rbd_real middle = half * (least + most);
        if (rbdi_act_growth(a, middle) > 0)
            most = middle;
        else
            least = middle;
    }
    return half * (least + most);
}

/* Moves the points to the new speeds or, where `searches` and the function grows there, to where it is least
   on the way. */
RBDI_LOCAL void rbdi_act_move_points(rbd_actuators *a, int searches) {
    const int stops = searches && rbdi_act_overshoots(a);
    const rbd_real share = stops ? rbdi_act_least(a) : rbdi_zero();
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        s->base = stops ? s->base + share * (s->force - s->base) : s->force;
        s->point = stops ? s->point + share * (s->next - s->point) : s->next;
    }
}

/* ==== src/actuator/coupled.h ==== */
/* ---- coupled shafts [coupled shafts] ----
   If there are transmissions, the motion of the joints is learnt for all n shafts of the robot together. At
   the speeds x of the shafts the joints ask of them the torques

       T = seen_T + M / dt (x - seen_x)

   with speeds and torques (seen_x, seen_T) of a step that was made, and a mass M, n x n, symmetric and
   positive definite. */

/* Speed of joint j of a group where its shafts have those of their points. */
RBDI_INLINE rbd_real rbdi_act_joint_speed(const rbdi_act_group *g, int j, const rbdi_act_shaft *s) {
    rbd_real v = rbdi_zero();
    for (int i = 0; i < g->n; ++i) v = v + g->inverse[g->n * j + i] * s[i].point;
    return v;
}

/* Tells the joints of a group torques and dampings with which they have the torques G'T at the speeds x of
   the shafts' points. The dampings are a diagonal D that is at least A = G' diag(smooth) G:

       D_jj = sum |A_jk|,   start = G'T + D G^-1 x */
RBDI_LOCAL void rbdi_act_tell_group(const rbd_actuators *a, rbdi_act_group *g) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    const int n = g->n;
    for (int j = 0; j < n; ++j) {
        rbd_real torque = rbdi_zero(), bound = rbdi_zero();
        for (int i = 0; i < n; ++i) torque = torque + g->G[n * i + j] * s[i].base;
        for (int k = 0; k < n; ++k) {
            rbd_real A = rbdi_zero();
            for (int i = 0; i < n; ++i) A = A + g->G[n * i + j] * s[i].smooth * g->G[n * i + k];
            bound = bound + rbdi_abs(A);
        }
        g->start[j] = torque + bound * rbdi_act_joint_speed(g, j, s);
        g->damping[j] = bound;
    }
}

/* Notes speeds and torques of a group's shafts at joint speeds v, and how large the terms of both are. */
RBDI_LOCAL void rbdi_act_note_group(const rbd_actuators *a, const rbdi_act_group *g, const rbd_real *v) {
    rbdi_act_shaft *s = &a->shaft[g->first];
    for (int i = 0; i < g->n; ++i) {
        s[i].next = rbdi_act_shaft_speed(g, i, v);
        s[i].force = s[i].scale = s[i].size = rbdi_zero();
        for (int j = 0; j < g->n; ++j) {
            const rbd_real share = g->inverse[g->n * j + i];
            s[i].force = s[i].force + share * (g->start[j] - g->damping[j] * v[g->dof[j]]);
            s[i].size = s[i].size + rbdi_abs(share * g->start[j]);
            s[i].scale = s[i].scale + rbdi_abs(g->G[g->n * i + j] * v[g->dof[j]]);
        }
    }
}

/* Notes the rounding of the set: of speeds and, after those, of torques, which all round each other by the
   joints. The size of a coupled shaft's torque is that of its law, of what its joints were told, and of their
   momentum. */
RBDI_LOCAL void rbdi_act_note_rounding(rbd_actuators *a) {
    a->speed_rounding = a->torque_rounding = rbdi_zero();
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        if (s->dof >= 0) {
            s->scale = rbdi_abs(s->next);
            s->size = rbdi_zero();
        }
        a->speed_rounding = a->speed_rounding + RBDI_ACTUATOR_ROUNDING * s->scale;
    }
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->size = s->size + rbdi_act_size(&a->motor[i], s, a);
        a->torque_rounding = a->torque_rounding + RBDI_ACTUATOR_ROUNDING * s->size;
        if (s->dof >= 0) continue;
        s->size = s->size + s->smooth * s->scale;
        for (int k = 0; k < a->n && a->known; ++k)
            s->size = s->size + rbdi_abs(a->mass[a->n * i + k]) / a->dt * a->shaft[k].scale;
    }
}

/* ---- foretelling [foretelling] ----
   The speeds at which the joints, by what was learnt of them, ask for the torques of all laws: the method of
   the repeats, with this motion in place of a step. */

/* Solves A x = b by L D L', A = a->system symmetric and positive definite; b becomes x. Returns 0 if A is not
   positive definite. */
RBDI_LOCAL int rbdi_act_solve_system(const rbd_actuators *a, rbd_real *b) {
    const int n = a->n;
    rbd_real *A = a->system;
    for (int k = 0; k < n; ++k) {
        if (!(A[n * k + k] > 0)) return 0;
        for (int i = k + 1; i < n; ++i) {
            const rbd_real factor = A[n * i + k] / A[n * k + k];
            for (int j = k + 1; j <= i; ++j) A[n * i + j] = A[n * i + j] - factor * A[n * j + k];
            b[i] = b[i] - factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j) b[k] = b[k] - A[n * j + k] * b[j];
        b[k] = b[k] / A[n * k + k];
    }
    return 1;
}

/* The pieces of all shafts at their points. */
RBDI_LOCAL void rbdi_act_take_pieces(rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        const rbdi_act_piece piece = rbdi_act_law(&a->motor[i], s, s->point, a);
        s->start = piece.start;
        s->slope = piece.slope;
    }
}

/* Finds the speeds, `next`, at which the joints ask for the torques of the pieces, `force`. Returns 0 if
   there are none within bounds.

       (M / dt + slope) x = start - seen_T + M / dt seen_x */
RBDI_LOCAL int rbdi_act_solve_pieces(rbd_actuators *a) {
    const int n = a->n;
    rbd_real *x = a->solution;
    for (int i = 0; i < n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        x[i] = s->start - s->seen_T;
        for (int k = 0; k < n; ++k) {
            a->system[n * i + k] = a->mass[n * i + k] / a->dt;
            x[i] = x[i] + a->system[n * i + k] * a->shaft[k].seen_x;
        }
        a->system[(n + 1) * i] = a->system[(n + 1) * i] + s->slope;
    }
    if (!rbdi_act_solve_system(a, x)) return 0;

    for (int i = 0; i < n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->next = x[i];
        s->force = s->seen_T;
        for (int k = 0; k < n; ++k)
            s->force = s->force + a->mass[n * i + k] / a->dt * (x[k] - a->shaft[k].seen_x);
        if (!(rbdi_abs(s->force) <= RBDI_ACTUATOR_LARGEST && rbdi_abs(s->next) <= RBDI_ACTUATOR_MOST))
            return 0;
    }
    return 1;
}

/* Whether the laws have at `next` the torques of the pieces. */
RBDI_LOCAL int rbdi_act_pieces_hold(const rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        const rbd_motor *m = &a->motor[i];
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real law = rbdi_act_law_at(m, s, s->next, a);
        const rbd_real off = rbdi_abs(s->start - s->slope * s->next - law);
        if (off > RBDI_ACTUATOR_SETTLED * rbdi_act_size(m, s, a)) return 0;
    }
    return 1;
}

/* Moves the points to where, by what was learnt, the step ends: there the joints ask for `base`. A search
   stops at the bend of one law at least, and most laws have one that matters. Returns 0 without a solution
   within bounds. */
RBDI_LOCAL int rbdi_act_foretell(rbd_actuators *a) {
    for (int k = 0; k < a->n + RBDI_ACTUATOR_SEARCHES; ++k) {
        int held;
        rbdi_act_take_pieces(a);
        if (!rbdi_act_solve_pieces(a)) return 0;
        held = rbdi_act_pieces_hold(a);
        rbdi_act_move_points(a, !held);
        if (held) break;
    }
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->base = s->base - rbdi_act_off(&a->motor[i], s, s->base, s->point, a);
    }
    return 1;
}

/* ==== src/actuator/learning.h ==== */
/* ---- learning [learning] ----
   Each repeat tells a change d of the shafts' speeds and the impulse y that made it: M d = y. M is corrected
   by BFGS (Nocedal and Wright 2006, section 6.1):

       M + y y' / (y'd) - M d (M d)' / (d'M d)

   Pairs of the same step are made conjugate first: d less what the pairs before it, d_k and y_k, have of it,

       d - sum d_k (y_k'd) / (y_k'd_k),   y - sum y_k (y_k'd) / (y_k'd_k)

   Then a correction keeps M d_k = y_k, so that after n of them M is exact where the joints' motion is linear,
   and it stays positive definite (Schnabel 1983, Quasi-Newton methods using multiple secant equations). */

RBDI_INLINE rbd_real rbdi_act_dot(const rbd_real *x, const rbd_real *y, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + x[i] * y[i];
    return sum;
}

/* A first guess of the mass, a diagonal in kg m^2: the impulse of the step over the largest change of speed
   that it can have made. No pair tells of it. The least torque, 1e-3 N m, keeps it above 0. */
RBDI_LOCAL void rbdi_act_guess_mass(rbd_actuators *a) {
    for (int i = 0; i < a->n * a->n; ++i) a->mass[i] = rbdi_zero();
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real change = rbdi_abs(s->x) + rbdi_abs(s->next) + a->dt; /* by 1 rad/s^2 at least */
        const rbd_real torque = rbdi_abs(s->force) + s->level + RBD_C(1e-3);
        a->mass[(a->n + 1) * i] = a->dt * torque / change + rbdi_act_rotor_inertia(&a->motor[i]);
    }
    a->pairs = 0;
    a->known = 1;
}

/* Adds factor x x' to M. */
RBDI_LOCAL void rbdi_act_add_square(rbd_actuators *a, rbd_real factor, const rbd_real *x) {
    for (int i = 0; i < a->n; ++i)
        for (int j = 0; j < a->n; ++j) a->mass[a->n * i + j] = a->mass[a->n * i + j] + factor * x[i] * x[j];
}

/* a->solution = M d. */
RBDI_LOCAL void rbdi_act_mass_times(const rbd_actuators *a, const rbd_real *d) {
    for (int i = 0; i < a->n; ++i) a->solution[i] = rbdi_act_dot(a->mass + a->n * i, d, a->n);
}

/* The pair (d, y) of the last repeat. */
RBDI_LOCAL void rbdi_act_take_pair(const rbd_actuators *a, rbd_real *d, rbd_real *y) {
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        d[i] = s->next - s->seen_x;
        y[i] = a->dt * (s->force - s->seen_T);
    }
}

/* Makes the pair (d, y) conjugate to those before it. */
RBDI_LOCAL void rbdi_act_conjugate(const rbd_actuators *a, rbd_real *d, rbd_real *y) {
    const int n = a->n;
    for (int k = 0; k < a->pairs; ++k) {
        const rbd_real *d_k = a->pair + 2 * n * k;
        const rbd_real *y_k = d_k + n;
        const rbd_real share = rbdi_act_dot(y_k, d, n) / rbdi_act_dot(y_k, d_k, n);
        for (int i = 0; i < n; ++i) {
            d[i] = d[i] - share * d_k[i];
            y[i] = y[i] - share * y_k[i];
        }
    }
}

/* If the speeds should have changed by d and did not, but for rounding, the mass there is ten times as large
   at least: M + 9 M d (M d)' / (d'M d). */
RBDI_LOCAL void rbdi_act_stiffen(rbd_actuators *a) {
    rbd_real *d = a->pair, work;
    a->pairs = 0;
    for (int i = 0; i < a->n; ++i) d[i] = a->shaft[i].point - a->shaft[i].seen_x;
    rbdi_act_mass_times(a, d);
    work = rbdi_act_dot(d, a->solution, a->n);
    if (work > 0) rbdi_act_add_square(a, 9 / work, a->solution);
}

/* Corrects the mass by the last repeat. Pairs before it are forgotten if it tells nothing that they did not,
   which is so where the joints' motion is not linear. */
RBDI_LOCAL void rbdi_act_learn(rbd_actuators *a) {
    const int n = a->n;
    rbd_real *d = a->pair + 2 * n * a->pairs;
    rbd_real *y = d + n;
    rbd_real work, square;
    rbdi_act_take_pair(a, d, y);
    work = rbdi_act_dot(d, y, n);
    if (!(rbdi_act_dot(d, d, n) > RBDI_ACTUATOR_ACROSS * a->speed_rounding * a->speed_rounding) ||
        !(work > 0)) {
        rbdi_act_stiffen(a);
        return;
    }

    rbdi_act_conjugate(a, d, y);
    if (!(rbdi_act_dot(d, y, n) > RBDI_ACTUATOR_TELLING * work)) {
        a->pairs = 0;
        d = a->pair;
        y = d + n;
        rbdi_act_take_pair(a, d, y);
    }

    rbdi_act_mass_times(a, d);
    square = rbdi_act_dot(d, a->solution, n);
    rbdi_act_add_square(a, 1 / rbdi_act_dot(d, y, n), y);
    rbdi_act_add_square(a, -1 / square, a->solution);
    a->pairs = (a->pairs + 1) % n;
}

/* Guesses for the next step the torque that the joints ask for at the speeds of its beginning: that of this
   step's beginning. */
RBDI_LOCAL void rbdi_act_foresee(rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        s->base = s->force;
        for (int k = 0; k < a->n; ++k)
            s->base = s->base - a->mass[a->n * i + k] / a->dt * (a->shaft[k].next - a->shaft[k].x);
    }
}

/* ==== src/actuator/step.h ==== */
/* ---- forward [forward code] ---- */

/* All shafts at rest at their angles phi, as warm as the air. */
RBDI_LOCAL void rbdi_act_rest(rbd_actuators *a, rbd_real air) {
    a->air = air;
    a->begun = 0;
    a->repeats = a->noted = a->pairs = 0;
    a->speed_rounding = a->torque_rounding = rbdi_zero();
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        s->angle = s->phi;
        s->speed = s->winding = s->housing = s->bristle = rbdi_zero();
        s->motor = s->joint = s->current = s->level = rbdi_zero();
        s->cogging = s->cogging_slope = s->lent = rbdi_zero();
        s->t = s->now = s->braking = s->gain = s->rate = rbdi_zero();
        s->most = s->stall = s->droop = s->pass = rbdi_zero();
        s->start = s->slope = s->point = s->base = s->next = s->force = s->scale = rbdi_zero();
        s->branch = s->saturated = s->oldest = 0;
    }
    a->known = 0;
    for (int i = 0; i < a->n * a->ring; ++i) {
        rbd_command *c = &a->commands[i];
        c->q = c->v = c->kp = c->kd = c->torque = c->voltage = rbdi_zero();
    }
}

RBDI_API rbd_status rbd_actuators_reset(rbd_actuators *a, const rbd_real *q, rbd_real air) {
    rbd_status status;
    if (!a || !q) return RBD_ERR_NULL;
    if (!(air >= -273 && air <= 1000)) return RBD_ERR_RANGE;
    status = rbdi_act_map(a, q, NULL);
    if (!status) rbdi_act_rest(a, air);
    return status;
}

/* Puts a command into the motor's ring, and takes out the one that arrives. */
RBDI_LOCAL rbd_command rbdi_act_delay(rbd_actuators *a, int i, const rbd_command *given) {
    rbdi_act_shaft *s = &a->shaft[i];
    rbd_command *oldest = &a->commands[i * a->ring + s->oldest];
    s->arrived = *given;
    if (a->motor[i].delay < 1) return *given;
    s->arrived = *oldest;
    *oldest = *given;
    s->oldest = (int16_t)((s->oldest + 1) % a->motor[i].delay);
    return s->arrived;
}

/* Puts the commands back of a step that has not ended: the oldest into the ring, the new one out. */
RBDI_LOCAL void rbdi_act_take_back(rbd_actuators *a) {
    for (int i = 0; i < a->n && a->begun; ++i) {
        const int delay = a->motor[i].delay;
        rbdi_act_shaft *s = &a->shaft[i];
        if (delay < 1) continue;
        s->oldest = (int16_t)((s->oldest + delay - 1) % delay);
        a->commands[i * a->ring + s->oldest] = s->arrived;
    }
    a->begun = 0;
}

/* Whether a command suits the motor: finite, no negative gain, no torque by voltage and no voltage else. */
RBDI_LOCAL int rbdi_act_is_command(const rbd_motor *m, const rbd_command *c) {
    const rbd_real other = m->by_voltage ? c->torque : c->voltage;
    const rbd_real x[6] = {c->q, c->v, c->kp, c->kd, c->torque, c->voltage};
    return rbdi_act_all_moderate(x, 6) && c->kp >= 0 && c->kd >= 0 && other >= 0 && other <= 0;
}

/* Tells the step the pieces of all shafts at their points or, if the mass is known, at the speeds that will
   come out. */
RBDI_LOCAL void rbdi_act_tell_all(rbd_actuators *a, rbd_real *tau, rbd_real *damping) {
    a->known = a->known && rbdi_act_foretell(a);
    rbdi_act_take_pieces(a);
    rbdi_clear(tau, a->nv);
    rbdi_clear(damping, a->nv);
    for (int i = 0; i < a->n; ++i) {
        rbdi_act_shaft *s = &a->shaft[i];
        const rbd_motor *m = &a->motor[i];
        if (s->dof < 0) {
            s->smooth = m->stiffness > 0 ? s->slope : rbdi_act_rigid_without(m, s, s->point, a).slope;
            if (!a->known) s->base = s->start - s->slope * s->point;
        } else {
            tau[s->dof] = s->start;
            damping[s->dof] = s->slope;
        }
    }
    for (rbdi_act_group *g = a->group; g < a->group + a->groups; ++g) {
        rbdi_act_tell_group(a, g);
        for (int j = 0; j < g->n; ++j) {
            tau[g->dof[j]] = g->start[j];
            damping[g->dof[j]] = g->damping[j];
        }
    }
}

RBDI_API rbd_status rbd_actuators_begin(rbd_actuators *a, const rbd_command *commands, const rbd_real *q,
                                        const rbd_real *v, rbd_real dt, int first_order, rbd_real *tau,
                                        rbd_real *damping) {
    rbd_status status;
    if (!a || !commands || !q || !v || !tau || !damping) return RBD_ERR_NULL;
    rbdi_act_take_back(a);
    if (!(dt >= RBD_C(1e-9) && dt <= RBD_C(1e3))) return RBD_ERR_RANGE;
    for (int i = 0; i < a->n; ++i)
        if (!rbdi_act_is_command(&a->motor[i], &commands[i])) return RBD_ERR_RANGE;
    status = rbdi_act_map(a, q, v);
    if (status) return status;

    a->dt = dt;
    a->share = rbdi_set(first_order ? RBD_C(1) : RBD_C(0.5));
    a->begun = 1;
    a->repeats = a->noted = a->pairs = 0;
    for (int i = 0; i < a->n; ++i) {
        const rbd_motor *m = &a->motor[i];
        rbdi_act_shaft *s = &a->shaft[i];
        const rbd_command c = rbdi_act_delay(a, i, &commands[i]);
        if (!(m->stiffness > 0)) {
            s->angle = s->phi;
            s->speed = s->x;
        }
        rbdi_act_drive_motor(m, s, &c, a->air, dt, m->stiffness > 0 ? rbdi_set(RBD_C(1)) : a->share);
        s->level = rbd_friction_level(&m->friction, s->speed, s->motor, -s->joint);
        s->point = s->seen_x = s->x;
        s->seen_T = s->base;
        s->branch = (int16_t)rbdi_act_slides(m, s, a);
    }
    for (rbdi_act_group *g = a->group; g < a->group + a->groups; ++g)
        for (int j = 0; j < g->n; ++j) g->v[j] = v[g->dof[j]];
    rbdi_act_tell_all(a, tau, damping);
    return RBD_OK;
}

/* Notes the shafts' speeds at joint speeds v, and the torques that the joints have there. */
RBDI_LOCAL void rbdi_act_note_speeds(rbd_actuators *a, const rbd_real *v) {
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        if (s->dof < 0) continue;
        s->next = v[s->dof];
        s->force = s->start - s->slope * s->next;
    }
    for (int i = 0; i < a->groups; ++i) rbdi_act_note_group(a, &a->group[i], v);
    if (a->groups > 0) rbdi_act_note_rounding(a);
}

/* By how much the torque of a shaft may differ from its law, N m: by rounding and, where it was told a slope,
   by that of the speed. */
RBDI_LOCAL rbd_real rbdi_act_bound(const rbd_actuators *a, int i) {
    const rbdi_act_shaft *s = &a->shaft[i];
    if (s->dof < 0) return RBDI_ACTUATOR_SETTLED * s->size + a->torque_rounding;
    return RBDI_ACTUATOR_ROUNDING * rbdi_act_size(&a->motor[i], s, a) +
           s->slope * rbdi_act_speed_rounding(s) + a->torque_rounding;
}

/* Whether all shafts have the torques of their laws at the new speeds. */
RBDI_LOCAL int rbdi_act_all_settle(const rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbd_real off = rbdi_act_off(&a->motor[i], s, s->force, s->next, a);
        if (rbdi_abs(off) > rbdi_act_bound(a, i)) return 0;
    }
    return 1;
}

/* Ends the step at the speeds that were noted. */
RBDI_LOCAL void rbdi_act_end_step(rbd_actuators *a) {
    for (int i = 0; i < a->n; ++i) rbdi_act_end_shaft(&a->motor[i], &a->shaft[i], a->shaft[i].next, a);
    if (a->known) rbdi_act_foresee(a);
}

/* Learns from the new speeds, moves the points there, and tells the step the pieces. */
RBDI_LOCAL void rbdi_act_repeat(rbd_actuators *a, rbd_real *tau, rbd_real *damping) {
    ++a->repeats;
    ++a->noted;
    if (a->groups > 0 && !a->known)
        rbdi_act_guess_mass(a);
    else if (a->groups > 0 && a->noted > 1)
        rbdi_act_learn(a);
    rbdi_act_move_points(a, a->groups == 0 && a->noted > 1);
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) {
        s->seen_x = s->point;
        s->seen_T = s->base;
    }
    rbdi_act_tell_all(a, tau, damping);
}

/* Begins the step anew without the masses that were learnt, which made speeds without bound. Returns 0 if
   there are none. */
RBDI_LOCAL int rbdi_act_forget(rbd_actuators *a, rbd_real *tau, rbd_real *damping) {
    if (!a->known) return 0;
    a->known = 0;
    ++a->repeats;
    a->noted = a->pairs = 0;
    for (rbdi_act_shaft *s = a->shaft; s < a->shaft + a->n; ++s) s->point = s->x;
    rbdi_act_tell_all(a, tau, damping);
    return 1;
}

RBDI_API int rbd_actuators_again(rbd_actuators *a, const rbd_real *v_next, rbd_real *tau, rbd_real *damping) {
    if (!a || !v_next || !tau || !damping || !a->begun) return 0;
    if (!rbdi_act_all_moderate(v_next, a->nv)) {
        if (a->repeats < RBDI_ACTUATOR_REPEATS && rbdi_act_forget(a, tau, damping)) return 1;
        rbdi_act_take_back(a);
        return 0;
    }

    rbdi_act_note_speeds(a, v_next);
    if (a->repeats < RBDI_ACTUATOR_REPEATS && !rbdi_act_all_settle(a)) {
        rbdi_act_repeat(a, tau, damping);
        return 1;
    }
    rbdi_act_end_step(a);
    a->begun = 0;
    return 0;
}

RBDI_API rbd_status rbd_actuators_get(const rbd_actuators *a, int motor, rbd_actuator_state *state) {
    const rbdi_act_shaft *s;
    if (!a || !state) return RBD_ERR_NULL;
    if (motor < 0 || motor >= a->n) return RBD_ERR_INDEX;

    s = &a->shaft[motor];
    state->angle = s->angle;
    state->speed = s->speed;
    state->motor = s->motor;
    state->joint = s->joint;
    state->friction = s->level;
    state->current = s->current;
    state->winding = s->winding + a->air;
    state->housing = s->housing + a->air;
    state->saturated = s->saturated;
    state->repeats = a->repeats;
    return RBD_OK;
}

/* ==== src/actuator/derivatives.h ==== */
/* ---- derivatives [derivatives code] ---- */

/* The torque on the joint's side of a shaft, and how it falls with its angle and speed there. */
typedef struct rbdi_act_slopes {
    rbd_real torque, by_angle, by_speed;
} rbdi_act_slopes;

RBDI_LOCAL rbdi_act_slopes rbdi_act_slopes_of(const rbd_motor *m, const rbdi_act_shaft *s) {
    rbdi_act_slopes out;
    if (m->stiffness > 0) {
        const rbd_real k = m->stiffness, d = m->damping, half = m->backlash / 2;
        const rbd_real free = k * (s->angle - s->phi) + d * (s->speed - s->x);
        const int side = free > k * half ? 1 : free < -k * half ? -1 : 0;
        out.torque = side ? free - (rbd_real)side * k * half : rbdi_zero();
        out.by_angle = side ? k : rbdi_zero();
        out.by_speed = side ? d : rbdi_zero();
        return out;
    }
    out.by_angle = s->gain;
    out.by_speed = s->rate + m->friction.viscous;
    out.torque = s->now - m->friction.viscous * s->x;
    if (s->branch) out.torque = out.torque - (rbd_real)s->branch * s->level;
    return out;
}

/* Of a transmission: with slopes K by angle, D by speed and torques t of its shafts

       dtau/dq = sum t_i H_i - G' (K G + D H v),   dtau/dv = -G' D G,   dtau/dcommand = G' */
RBDI_LOCAL void rbdi_act_group_derivatives(const rbd_actuators *a, const rbdi_act_group *g, int j, int k,
                                           rbd_real *dq, rbd_real *dv) {
    const int n = g->n;
    *dq = *dv = rbdi_zero();
    for (int i = 0; i < n; ++i) {
        const int at = g->first + i;
        const rbdi_act_slopes s = rbdi_act_slopes_of(&a->motor[at], &a->shaft[at]);
        const rbd_real G_ij = g->G[n * i + j], G_ik = g->G[n * i + k];
        rbd_real H_v = rbdi_zero();
        if (g->by->kind == RBD_BY_RODS) {
            for (int l = 0; l < n; ++l) H_v = H_v + g->H[(n * i + l) * n + k] * g->v[l];
            *dq = *dq + s.torque * g->H[(n * i + j) * n + k];
        }
        *dq = *dq - G_ij * (s.by_angle * G_ik + s.by_speed * H_v);
        *dv = *dv - G_ij * s.by_speed * G_ik;
    }
}

/* How the joint's torque changes with the torque or voltage of a command, in the same step: 0 if a spring
   lies between, a limit cuts the command, or it arrives later. */
RBDI_LOCAL rbd_real rbdi_act_passes(const rbd_actuators *a, int i) {
    const rbd_motor *m = &a->motor[i];
    return m->stiffness > 0 || m->delay > 0 ? rbdi_zero() : a->shaft[i].pass;
}

RBDI_API rbd_status rbd_actuators_derivatives(const rbd_actuators *a, rbd_real *dq, rbd_real *dv,
                                              rbd_real *dcommand) {
    if (!a) return RBD_ERR_NULL;
    if (!a->begun || a->repeats) return RBD_ERR_ORDER;
    if (dq) rbdi_clear(dq, a->nv * a->nv);
    if (dv) rbdi_clear(dv, a->nv * a->nv);
    if (dcommand) rbdi_clear(dcommand, a->nv * a->n);

    for (int i = 0; i < a->n; ++i) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const rbdi_act_slopes slopes = rbdi_act_slopes_of(&a->motor[i], s);
        if (s->dof < 0) continue;
        if (dq) dq[(a->nv + 1) * s->dof] = -slopes.by_angle;
        if (dv) dv[(a->nv + 1) * s->dof] = -slopes.by_speed;
        if (dcommand) dcommand[a->n * s->dof + i] = rbdi_act_passes(a, i);
    }
    for (const rbdi_act_group *g = a->group; g < a->group + a->groups; ++g)
        for (int j = 0; j < g->n; ++j)
            for (int k = 0; k < g->n; ++k) {
                rbd_real by_q, by_v;
                rbdi_act_group_derivatives(a, g, j, k, &by_q, &by_v);
                if (dq) dq[a->nv * g->dof[j] + g->dof[k]] = by_q;
                if (dv) dv[a->nv * g->dof[j] + g->dof[k]] = by_v;
                if (dcommand)
                    dcommand[a->n * g->dof[j] + g->first + k] =
                        rbdi_act_passes(a, g->first + k) * g->G[g->n * k + j];
            }
    return RBD_OK;
}

/* ==== src/actuator/check.h ==== */
/* ---- checks [checks] ---- */

/* Ranges are wider than any drive's, and so narrow that products of three fields are finite in float. */
#define RBDI_ACTUATOR_MOST_GEAR RBD_C(1e6)
#define RBDI_ACTUATOR_MOST_INERTIA RBD_C(1e3)      /* kg m^2 */
#define RBDI_ACTUATOR_LEAST RBD_C(1e-9)            /* of what divides */
#define RBDI_ACTUATOR_LEAST_REFLECTED RBD_C(1e-12) /* kg m^2: of a rotor behind a spring, at the shaft */

/* A field and its range, and whether 0 means that it is not used. */
typedef struct rbdi_act_field {
    const char *name;
    rbd_const value, least, most;
    int optional;
} rbdi_act_field;

/* Where a finding is: the motor or, behind them, the transmission. */
typedef struct rbdi_act_where {
    rbd_report *report;
    int at;
    const char *name;
} rbdi_act_where;

RBDI_LOCAL rbd_status rbdi_act_refuse_field(const rbdi_act_where *where, rbd_status status, const char *field,
                                            const char *sentence) {
    return rbdi_refuse_saying(where->report, status, where->at, where->name, field, sentence);
}

/* Checks n fields; one that is 0 and must not be is missing. */
RBDI_LOCAL rbd_status rbdi_act_check_fields(const rbdi_act_where *where, const rbdi_act_field *field, int n) {
    for (int i = 0; i < n; ++i) {
        const rbd_const x = field[i].value;
        if (x <= 0 && x >= 0 && field[i].optional) continue;
        if (x <= 0 && x >= 0 && field[i].least > 0)
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, field[i].name, "missing");
        if (!(x >= field[i].least && x <= field[i].most))
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, field[i].name, NULL);
    }
    return RBD_OK;
}

#define RBDI_ACTUATOR_FIELDS(where, list) \
    rbdi_act_check_fields(where, list, (int)(sizeof(list) / sizeof((list)[0])))

RBDI_LOCAL rbd_status rbdi_act_check_friction(const rbdi_act_where *where, const rbd_gear_friction *f) {
    const rbd_const most = RBDI_ACTUATOR_MOST, least = RBDI_ACTUATOR_LEAST;
    const int rest = rbdi_act_has_rest(f);
    /* At rest friction must grow more slowly than the motor's torque, or no torque begins to move. */
    const rbd_const of_motor = RBD_C(0.999);
    const rbdi_act_field field[] = {{"coulomb", f->coulomb, 0, most, 1},
                                    {"viscous", f->viscous, 0, most, 1},
                                    {"load_motor", f->load_motor, 0, of_motor, 1},
                                    {"load_joint", f->load_joint, 0, 10, 1},
                                    {"rest", f->rest, 0, most, 1},
                                    {"rest_motor", f->rest_motor, 0, of_motor - f->load_motor, 1},
                                    {"rest_joint", f->rest_joint, 0, 10, 1},
                                    {"square_motor", f->square_motor, 0, RBD_C(1e6), 1},
                                    {"square_joint", f->square_joint, 0, RBD_C(1e6), 1},
                                    {"bristle", f->bristle, least, most, 1},
                                    {"still", f->still, least, most, 1},
                                    {"speed", f->speed, least, most, !rest},
                                    {"power", f->power, RBD_C(0.1), 10, !rest}};
    return RBDI_ACTUATOR_FIELDS(where, field);
}

/* Resistance, limits and heat. */
RBDI_LOCAL rbd_status rbdi_act_check_electric(const rbdi_act_where *where, const rbd_motor *m) {
    const rbd_const most = RBDI_ACTUATOR_MOST, least = RBDI_ACTUATOR_LEAST;
    const int network = m->heat_case > 0 || m->flow_winding > 0 || m->flow_case > 0;
    const int heat = m->heat_winding > 0, limit = !(m->hot <= 0 && m->hottest <= 0);
    const rbdi_act_field field[] = {
        {"current", m->current, 0, most, 1},
        {"voltage", m->voltage, 0, most, 1},
        {"copper", m->copper, 0, 1, 1},
        {"heat_winding", m->heat_winding, least, RBD_C(1e6), !limit && !network},
        {"heat_case", m->heat_case, least, RBD_C(1e6), 1},
        {"flow_winding", m->flow_winding, least, RBD_C(1e6), !heat},
        {"flow_case", m->flow_case, least, RBD_C(1e6), !(heat && m->heat_case > 0)},
        {"hot", m->hot, least, RBD_C(1e4), !limit},
        {"hottest", m->hottest, least, RBD_C(1e4), !limit},
        {"resistance", m->resistance, least, most, !heat && !(m->voltage > 0) && !m->by_voltage}};
    const rbd_status status = RBDI_ACTUATOR_FIELDS(where, field);
    if (status) return status;
    if (limit && !(m->hottest > m->hot))
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "hottest", "not above 'hot'");
    if (limit && !(m->current > 0))
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "current", "missing: heat lowers this limit");
    return RBD_OK;
}

/* Rotor, drive and spring. */
RBDI_LOCAL rbd_status rbdi_act_check_mechanical(const rbdi_act_where *where, const rbd_motor *m) {
    const rbd_const most = RBDI_ACTUATOR_MOST, least = RBDI_ACTUATOR_LEAST;
    const rbd_const gear = m->gear < 0 ? -m->gear : m->gear;
    const int spring = m->stiffness > 0, springs = m->damping > 0 || m->backlash > 0;
    const rbdi_act_field field[] = {{"gear", gear, RBD_C(1e-6), RBDI_ACTUATOR_MOST_GEAR, 0},
                                    {"constant", m->constant, least, most, 0},
                                    {"inertia", m->inertia, 0, RBDI_ACTUATOR_MOST_INERTIA, 1},
                                    {"cogging", m->cogging, 0, most, 1},
                                    {"teeth", m->teeth, RBD_C(1), RBD_C(1e6), !(m->cogging > 0)},
                                    {"phase", m->phase, -most, most, 1},
                                    {"step", m->step, least, most, 1},
                                    {"offset", m->offset, -most, most, 1},
                                    {"stiffness", m->stiffness, least, most, !springs},
                                    {"damping", m->damping, 0, most, 1},
                                    {"backlash", m->backlash, 0, most, 1}};
    const rbd_status status = RBDI_ACTUATOR_FIELDS(where, field);
    if (status) return status;
    if (m->delay < 0 || m->delay > RBDI_ACTUATOR_MOST_DELAY)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "delay", "below 0 or above 1000");
    if (m->by_voltage != 0 && m->by_voltage != 1)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "by_voltage", "neither 0 nor 1");
    if (m->sampled != 0 && m->sampled != 1)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "sampled", "neither 0 nor 1");
    if (spring && !(gear * gear * m->inertia >= RBDI_ACTUATOR_LEAST_REFLECTED))
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "inertia",
                                     "missing: a rotor on a spring needs it");
    if (spring && m->friction.bristle > 0)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "bristle", "not beside a stiffness");
    return RBD_OK;
}

/* The coordinate and dof of a joint: it must have one of each, and no motor yet. */
RBDI_LOCAL rbd_status rbdi_act_find_joint(const rbd_model *m, const rbdi_act_where *where, const char *joint,
                                          const rbd_motor *motor, int16_t *dof, int16_t *at) {
    const rbdi_frame *u;
    int body = -1;
    for (int b = 0; b < m->nb; ++b)
        if (rbdi_same(m->frame[b].joint, joint)) body = b;
    if (body < 0) return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint", "no such joint");

    u = &m->frame[body];
    if (u->nv != 1 || u->nq != 1)
        return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint",
                                     "has not one coordinate and one degree of freedom of its own");
    if (motor->inertia > 0 && m->dof[u->iv].armature > 0)
        return rbdi_act_refuse_field(where, RBD_ERR_ARMATURE, "inertia",
                                     "the rotor counts twice: the model has it as armature of the joint");
    if (motor->stiffness > 0 && m->dof[u->iv].armature > 0)
        return rbdi_act_refuse_field(where, RBD_ERR_ARMATURE, "stiffness",
                                     "the model has the rotor as armature, but a spring lies between");
    *dof = u->iv;
    *at = u->iq;
    return RBD_OK;
}

RBDI_INLINE int rbdi_act_is_used(rbd_const x) { return x > 0 || x < 0; }

/* Fields that do nothing without others. */
RBDI_LOCAL rbd_status rbdi_act_check_partners(const rbdi_act_where *where, const rbd_motor *m) {
    const rbd_gear_friction *f = &m->friction;
    const int rest = rbdi_act_has_rest(f),
              dry = rest || f->coulomb > 0 || f->load_motor > 0 || f->load_joint > 0;
    const struct {
        const char *name;
        int lonely;
        const char *sentence;
    } field[] = {{"teeth", m->teeth > 0 && !(m->cogging > 0), "does nothing without 'cogging'"},
                 {"phase", rbdi_act_is_used(m->phase) && !(m->cogging > 0), "does nothing without 'cogging'"},
                 {"flow_case", m->flow_case > 0 && !(m->heat_case > 0), "does nothing without 'heat_case'"},
                 {"copper", m->copper > 0 && !(m->resistance > 0), "does nothing without 'resistance'"},
                 {"speed", f->speed > 0 && !rest, "does nothing without friction at rest"},
                 {"power", f->power > 0 && !rest, "does nothing without friction at rest"},
                 {"bristle", f->bristle > 0 && !dry, "does nothing without dry friction"},
                 {"still", f->still > 0 && !dry, "does nothing without dry friction"}};
    for (int i = 0; i < (int)(sizeof field / sizeof *field); ++i)
        if (field[i].lonely)
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, field[i].name, field[i].sentence);
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_act_check_motor(const rbdi_act_where *where, const rbd_motor *m) {
    rbd_status status = rbdi_act_check_mechanical(where, m);
    if (!status) status = rbdi_act_check_electric(where, m);
    if (!status) status = rbdi_act_check_friction(where, &m->friction);
    return status ? status : rbdi_act_check_partners(where, m);
}

RBDI_LOCAL int rbdi_act_is_vector(const rbd_const x[3]) {
    for (int i = 0; i < 3; ++i)
        if (!(rbdi_abs((rbd_real)x[i]) <= RBD_C(1e6))) return 0;
    return 1;
}

RBDI_LOCAL rbd_real rbdi_act_dot_of(const rbd_const a[3], const rbd_const b[3]) {
    return (rbd_real)a[0] * b[0] + (rbd_real)a[1] * b[1] + (rbd_real)a[2] * b[2];
}

/* A crank's directions are of unit length and across to 1e-6: six decimals in a file will do. */
RBDI_LOCAL rbd_status rbdi_act_check_rod(const rbdi_act_where *where, const rbd_rod *rod) {
    const rbd_real off = RBD_C(RBDI_ORTHONORMAL), one = rbdi_set(RBD_C(1));
    const rbdi_act_field field[] = {{"crank", rod->crank, RBDI_ACTUATOR_LEAST, RBD_C(1e6), 0},
                                    {"length", rod->length, RBDI_ACTUATOR_LEAST, RBD_C(1e6), 0}};
    const rbd_status status = RBDI_ACTUATOR_FIELDS(where, field);
    if (status) return status;
    if (!rbdi_act_is_vector(rod->place)) return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "place", NULL);
    if (!rbdi_act_is_vector(rod->point)) return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "point", NULL);
    if (!rbdi_act_is_vector(rod->axis) || !(rbdi_abs(rbdi_act_dot_of(rod->axis, rod->axis) - one) <= off))
        return rbdi_act_refuse_field(where, RBD_ERR_AXIS, "axis", "not of unit length");
    if (!rbdi_act_is_vector(rod->zero) || !(rbdi_abs(rbdi_act_dot_of(rod->zero, rod->zero) - one) <= off))
        return rbdi_act_refuse_field(where, RBD_ERR_AXIS, "zero", "not of unit length");
    if (!(rbdi_abs(rbdi_act_dot_of(rod->axis, rod->zero)) <= off))
        return rbdi_act_refuse_field(where, RBD_ERR_AXIS, "zero", "not across the axis");
    if (rod->elbow != 1 && rod->elbow != -1)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "elbow", "neither 1 nor -1");
    return RBD_OK;
}

/* A transmission beside n motors; its joints are checked where they are looked up. */
RBDI_LOCAL rbd_status rbdi_act_check_transmission(const rbdi_act_where *where, const rbd_transmission *t,
                                                  const rbd_motor *motors, int n) {
    const int kind = (int)t->kind, most = t->kind == RBD_BY_RODS ? 2 : 3;
    if (kind < 0 || kind > (int)RBD_BY_RODS)
        return rbdi_act_refuse_field(where, RBD_ERR_TYPE, "kind", "unknown kind of transmission");
    if (t->n < 1 || t->n > most)
        return rbdi_act_refuse_field(where, RBD_ERR_COUNT, "n", "below 1 or above 3, or above 2 by rods");
    if (t->motor < 0 || t->motor > n - t->n)
        return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "motor", "the table has no such motors");
    for (int i = 0; i < t->n; ++i)
        if (motors[t->motor + i].joint)
            return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "motor",
                                         "one of its motors has a joint of its own");

    for (int i = 0; i < t->n * t->n && t->kind == RBD_BY_MATRIX; ++i)
        if (!(rbdi_abs((rbd_real)t->matrix[i]) <= RBD_C(1e6)))
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "matrix", NULL);
    for (int i = 0; i < t->n && t->kind == RBD_BY_RODS; ++i) {
        const rbd_status status = rbdi_act_check_rod(where, &t->rod[i]);
        if (status) return status;
    }
    return RBD_OK;
}

/* ==== src/actuator/init.h ==== */
/* ---- tables [tables code] ---- */

RBDI_LOCAL int rbdi_act_is_number_of(int n, int groups, int delay) {
    return n >= 1 && n <= RBDI_ACTUATOR_MOST_MOTORS && groups >= 0 && groups <= n && delay >= 0 &&
           delay <= RBDI_ACTUATOR_MOST_DELAY;
}

RBDI_API size_t rbd_actuators_size(int n, int groups, int delay) {
    return rbdi_act_is_number_of(n, groups, delay) ? RBDI_ACTUATORS_BYTES(n, groups, delay) : 0;
}

/* Lays out the arrays in the memory. */
RBDI_LOCAL rbd_actuators *rbdi_act_lay_actuators(const rbd_model *m, const rbd_motor *motors, int n,
                                                 int groups, int ring, void *memory) {
    unsigned char *at = rbdi_aligned(memory);
    rbd_actuators *a = RBDI_CUT(rbd_actuators, 1);
    const int all = groups ? n : 0; /* shafts of which the motion is learnt */
    a->shaft = RBDI_CUT(rbdi_act_shaft, n);
    a->group = RBDI_CUT(rbdi_act_group, groups);
    a->commands = RBDI_CUT(rbd_command, n * ring);
    a->mass = RBDI_CUT(rbd_real, (4 * all + 1) * all);
    a->system = a->mass + all * all;
    a->pair = a->system + all * all;
    a->solution = a->pair + 2 * all * all;
    a->motor = motors;
    a->n = n;
    a->groups = groups;
    a->nq = m->nq;
    a->nv = m->nv;
    a->ring = ring;
    a->fault = -1;
    a->begun = 0;
    a->dt = rbdi_zero();
    return a;
}

/* Whether a shaft or group before moves the dof. */
RBDI_LOCAL int rbdi_act_is_moved(const rbd_actuators *a, int dof, int groups) {
    for (int i = 0; i < a->n; ++i)
        if (a->shaft[i].dof == dof) return 1;
    for (int k = 0; k < groups; ++k)
        for (int j = 0; j < a->group[k].n; ++j)
            if (a->group[k].dof[j] == dof) return 1;
    return 0;
}

/* The shafts that move a joint directly. A motor without a joint must be in one transmission. */
RBDI_LOCAL rbd_status rbdi_act_place_motors(const rbd_model *m, rbd_actuators *a, const rbd_transmission *t,
                                            int groups, rbd_report *report) {
    for (int i = 0; i < a->n; ++i) {
        a->shaft[i].dof = a->shaft[i].at = -1;
        a->shaft[i].phi = a->shaft[i].x = a->shaft[i].bias = rbdi_zero();
    }
    for (int i = 0; i < a->n; ++i) {
        const rbd_motor *motor = &a->motor[i];
        const rbdi_act_where where = {report, i, motor->name};
        int16_t dof, at;
        rbd_status status;
        int moves = 0;
        for (int k = 0; k < groups; ++k) moves += i >= t[k].motor && i < t[k].motor + t[k].n;
        if (moves > 1) return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, NULL, "in two transmissions");
        if (moves) continue;
        if (!motor->joint)
            return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, "joint",
                                         "missing, and no transmission has the motor");

        status = rbdi_act_find_joint(m, &where, motor->joint, motor, &dof, &at);
        if (status) return status;
        if (rbdi_act_is_moved(a, dof, 0))
            return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, "joint", "another motor moves this joint");
        a->shaft[i].dof = dof;
        a->shaft[i].at = at;
    }
    return RBD_OK;
}

/* Frame of a body on its link: x_body = E (x_link - r); of the world itself without one. */
RBDI_LOCAL rbdi_pose rbdi_act_body_frame(const rbd_model *m, int body) {
    rbdi_pose X = rbdi_world_pose();
    if (body < 0) return X;
    X.E = rbdi_mat_c(m->frame[body].E);
    X.r = rbdi_vec_c(m->frame[body].r);
    return X;
}

/* The joint j of rods at q = 0, in the axes of the body before, and the axis in its own body's. */
RBDI_LOCAL void rbdi_act_place_rod_joint(const rbd_model *m, rbdi_act_group *g, int j, int before) {
    const int body = m->dof[g->dof[j]].body;
    const rbdi_link *l = &m->link[m->frame[body].link];
    const rbdi_pose base = rbdi_act_body_frame(m, before), own = rbdi_act_body_frame(m, body);
    rbdi_trig trig;
    rbdi_pose X;
    trig.c = rbdi_set(l->cg);
    trig.s = rbdi_set(l->sg);
    trig.d = rbdi_set(l->d);
    X = rbdi_pose_step(l, l->flags & ~RBDI_ROOT, trig, rbdi_world_pose());

    /* origin = E_before (X.r + X.E' r_body - r_before),  turn = E_before X.E' E_body' */
    g->origin[j] = rbdi_mul(base.E, rbdi_sub(rbdi_add(X.r, rbdi_mul_t(X.E, own.r)), base.r));
    g->turn[j] = rbdi_mul_mat(base.E, rbdi_mul_mat(rbdi_transpose(X.E), rbdi_transpose(own.E)));
    g->axis[j] = rbdi_mul(own.E, rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_set(l->rho)));
}

RBDI_LOCAL rbd_status rbdi_act_place_rods(const rbd_model *m, const rbdi_act_where *where,
                                          rbdi_act_group *g) {
    int before = m->frame[m->dof[g->dof[0]].body].parent;
    for (int j = 0; j < g->n; ++j) {
        const int body = m->dof[g->dof[j]].body;
        const rbdi_frame *u = &m->frame[body];
        if (m->link[u->link].kind != RBDI_REVOLUTE)
            return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint", "a joint of rods does not turn");
        if (m->link[u->link].parent != (before < 0 ? -1 : m->frame[before].link))
            return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint",
                                         "joints of rods do not follow each other");
        rbdi_act_place_rod_joint(m, g, j, before);
        before = body;
    }
    return RBD_OK;
}

/* Checks a transmission, and looks its joints up. */
RBDI_LOCAL rbd_status rbdi_act_place_transmission(const rbd_model *m, rbd_actuators *a,
                                                  const rbd_transmission *t, int k, rbd_report *report) {
    const rbdi_act_where where = {report, a->n + k, t->name};
    rbdi_act_group *g = &a->group[k];
    g->by = t;
    g->n = 0;
    g->first = (int16_t)t->motor;
    for (int j = 0; j < t->n; ++j) {
        const rbd_status status =
            rbdi_act_find_joint(m, &where, t->joint[j], &a->motor[t->motor + j], &g->dof[j], &g->at[j]);
        int twice;
        if (status) return status;
        twice = rbdi_act_is_moved(a, g->dof[j], k);
        for (int i = 0; i < j; ++i) twice |= g->dof[i] == g->dof[j];
        if (twice)
            return rbdi_act_refuse_field(&where, RBD_ERR_INDEX, "joint", "another motor moves this joint");
    }
    g->n = (int16_t)t->n;
    if (t->kind == RBD_BY_RODS) return rbdi_act_place_rods(m, &where, g);

    for (int i = 0; i < t->n * t->n; ++i) g->G[i] = rbdi_set(t->matrix[i]);
    if (rbdi_act_invert_small(g->G, t->n, g->inverse)) return RBD_OK;
    return rbdi_act_refuse_field(&where, RBD_ERR_SINGULAR, "matrix", "singular: some motion has no motor");
}

/* Checks the tables by themselves. ring: the largest delay. */
RBDI_LOCAL rbd_status rbdi_act_check_tables(const rbd_motor *motors, int n,
                                            const rbd_transmission *transmissions, int groups, int *ring,
                                            rbd_report *report) {
    for (int i = 0; i < n; ++i) {
        const rbdi_act_where where = {report, i, motors[i].name};
        const rbd_status status = rbdi_act_check_motor(&where, &motors[i]);
        if (status) return status;
        if (motors[i].delay > *ring) *ring = motors[i].delay;
    }
    for (int k = 0; k < groups; ++k) {
        const rbdi_act_where where = {report, n + k, transmissions[k].name};
        const rbd_status status = rbdi_act_check_transmission(&where, &transmissions[k], motors, n);
        if (status) return status;
    }
    return RBD_OK;
}

RBDI_API rbd_status rbd_actuators_init(const rbd_model *m, const rbd_motor *motors, int n,
                                       const rbd_transmission *transmissions, int groups, void *memory,
                                       size_t size, rbd_actuators **a, rbd_report *report) {
    rbd_report own;
    rbd_status status;
    rbd_actuators *x;
    int ring = 0;
    if (!report) report = &own;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);
    if (a) *a = NULL;
    if (!m || !motors || (!transmissions && groups) || !memory || !a)
        return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (!rbdi_supported(m)) return rbdi_refuse(report, RBD_ERR_WORK, -1, NULL, NULL);
    if (!rbdi_act_is_number_of(n, groups, 0))
        return rbdi_refuse_saying(report, RBD_ERR_COUNT, -1, NULL, NULL,
                                  "below 1 or above 1000 motors, or more transmissions than motors");
    status = rbdi_act_check_tables(motors, n, transmissions, groups, &ring, report);
    if (status) return status;
    if (size < rbd_actuators_size(n, groups, ring))
        return rbdi_refuse(report, RBD_ERR_MEMORY, -1, NULL, NULL);

    x = rbdi_act_lay_actuators(m, motors, n, groups, ring, memory);
    status = rbdi_act_place_motors(m, x, transmissions, groups, report);
    for (int k = 0; k < groups && !status; ++k)
        status = rbdi_act_place_transmission(m, x, &transmissions[k], k, report);
    if (status) return status;
    rbdi_act_rest(x, RBDI_ACTUATOR_WARM);
    *a = x;
    return RBD_OK;
}

/* ==== src/actuator/rotor.h ==== */
/* ---- rotors [rotors code] ----
   A rotor with inertia I about its axis s, that spins with W = gear v relative to its body, which turns with
   omega: its angular momentum is I W s beside that of the locked rotor, which the body has. The body gets the
   moment -(I W' s + omega x I W s), and the shaft's motor gives gear I s.omega' beside gear^2 I v', which is
   the armature's. */

RBDI_LOCAL rbd_status rbdi_act_check_rotor(const rbd_model *m, const rbd_rotor *r) {
    rbd_real square = rbdi_zero();
    if (r->body < -1 || r->body >= m->nb || r->dof < 0 || r->dof >= m->nv) return RBD_ERR_INDEX;
    for (int i = 0; i < 3; ++i) square = square + (rbd_real)r->axis[i] * r->axis[i];
    if (!(square > RBD_C(1e-18) && square < RBD_C(1e18))) return RBD_ERR_AXIS;
    if (!(r->inertia >= 0 && r->inertia <= RBDI_ACTUATOR_MOST)) return RBD_ERR_RANGE;
    return rbdi_abs(r->gear) > 0 && rbdi_abs(r->gear) <= RBDI_ACTUATOR_MOST ? RBD_OK : RBD_ERR_RANGE;
}

/* The axis, of unit length. */
RBDI_INLINE rbdi_v3 rbdi_act_rotor_axis(const rbd_rotor *r) {
    const rbdi_v3 s = rbdi_vec(r->axis[0], r->axis[1], r->axis[2]);
    return rbdi_scale(1 / rbdi_sqrt(rbdi_dot(s, s)), s);
}

/* Adds the moment on the rotor's body to f_ext, after rbd_kinematics. */
RBDI_LOCAL void rbdi_act_add_rotor(const rbd_model *m, const rbd_work *w, const rbd_rotor *r, rbd_real spin,
                                   rbd_real rate, rbd_real *f_ext) {
    const rbdi_v3 s = rbdi_act_rotor_axis(r);
    rbd_real velocity[6];
    rbdi_v3 moment;
    (void)rbd_body_velocity(m, w, r->body, velocity);

    moment = rbdi_cross(rbdi_load_vec(velocity, 1), rbdi_scale(spin, s));
    moment = rbdi_scale(-(rbd_real)r->inertia, rbdi_add(moment, rbdi_scale(rate, s)));
    f_ext[0] = f_ext[0] + moment.x;
    f_ext[1] = f_ext[1] + moment.y;
    f_ext[2] = f_ext[2] + moment.z;
}

RBDI_API rbd_status rbd_rotor_torque(const rbd_model *m, rbd_work *w, const rbd_rotor *rotors, int n,
                                     const rbd_real *q, const rbd_real *v, const rbd_real *a, rbd_real *f_ext,
                                     rbd_real *tau) {
    rbd_status status = rbdi_check(m, w, (rotors || !n) && q && v && a && f_ext && tau);
    if (status) return status;
    if (n < 0) return RBD_ERR_COUNT;
    for (int i = 0; i < n; ++i) {
        status = rbdi_act_check_rotor(m, &rotors[i]);
        if (status) return status;
    }

    (void)rbd_kinematics(m, w, q, v, a);
    for (int i = 0; i < n; ++i) {
        const rbd_rotor *r = &rotors[i];
        if (r->body < 0) continue;
        rbdi_act_add_rotor(m, w, r, r->gear * v[r->dof], r->gear * a[r->dof], &f_ext[6 * r->body]);
    }
    (void)rbd_rnea(m, w, q, v, a, f_ext, tau);

    for (int i = 0; i < n; ++i) {
        const rbd_rotor *r = &rotors[i];
        rbd_real acceleration[6];
        if (r->body < 0) continue;
        (void)rbd_body_acceleration(m, w, r->body, acceleration);
        tau[r->dof] = tau[r->dof] + (rbd_real)r->gear * r->inertia *
                                        rbdi_dot(rbdi_act_rotor_axis(r), rbdi_load_vec(acceleration, 1));
    }
    return RBD_OK;
}

/* ==== src/actuator/text.h ==== */
/* ---- text [text code] ---- */

RBDI_API char *rbd_actuators_finding_text(const rbd_finding *finding, int n, char *text, size_t size) {
    rbd_finding behind;
    if (!finding || finding->body < n) return rbdi_write_finding(finding, "motor", text, size);
    behind = *finding;
    behind.body = finding->body - n;
    return rbdi_write_finding(&behind, "transmission", text, size);
}

/* ==== src/rbd_actuator.h ==== */
RBDI_CODE_END

#endif /* RBD_IMPLEMENTATION */

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("E")
#pragma pop_macro("G")
#pragma pop_macro("H")
#pragma pop_macro("J")
#pragma pop_macro("K")
#pragma pop_macro("L")
#pragma pop_macro("P")
#pragma pop_macro("S")
#pragma pop_macro("T")
#pragma pop_macro("X")
