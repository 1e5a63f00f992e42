#ifndef RBDI_API_ACTUATOR_H
#define RBDI_API_ACTUATOR_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

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

#endif
