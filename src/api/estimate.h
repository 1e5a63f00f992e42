#ifndef RBDI_API_ESTIMATE_H
#define RBDI_API_ESTIMATE_H
#include "api/derivatives.h"

#define rbd_estimate_text RBDI_SYMBOL(rbd_estimate_text)
#define rbd_observer_init RBDI_SYMBOL(rbd_observer_init)
#define rbd_observer_size RBDI_SYMBOL(rbd_observer_size)
#define rbd_observer_reset RBDI_SYMBOL(rbd_observer_reset)
#define rbd_observer_step RBDI_SYMBOL(rbd_observer_step)
#define rbd_estimate_init RBDI_SYMBOL(rbd_estimate_init)
#define rbd_estimate_size RBDI_SYMBOL(rbd_estimate_size)
#define rbd_estimate_add RBDI_SYMBOL(rbd_estimate_add)
#define rbd_estimate_solve RBDI_SYMBOL(rbd_estimate_solve)
#define rbd_estimate_deviations RBDI_SYMBOL(rbd_estimate_deviations)
#define rbd_estimate_grip RBDI_SYMBOL(rbd_estimate_grip)
#define rbd_estimate_release RBDI_SYMBOL(rbd_estimate_release)

/* ---- friction and bad input [friction] ---- */

/* Friction of a degree of freedom that moves at v: offset + coulomb sign(v) + viscous v, against the motor.
   At rest the dry part is anything between -coulomb and coulomb. */
typedef struct rbd_joint_friction {
    rbd_real coulomb; /* N m or N, 0 or more */
    rbd_real viscous; /* N m s/rad or N s/m, 0 or more */
    rbd_real offset;  /* N m or N: of a sensor, say */
} rbd_joint_friction;

/* Which input was refused. */
typedef struct rbd_estimate_fault {
    const char *field; /* the argument, or the field of a struct; NULL: none */
    int at;            /* index in it, as of a dof; -1: it is a single number */
} rbd_estimate_fault;

/* Writes a status and its fault as a sentence, e.g. "tau[3]: not finite", cut to fit, always terminated.
   fault: may be NULL. text: size bytes. Returns text. */
RBDI_API char *rbd_estimate_text(rbd_status status, const rbd_estimate_fault *fault, char *text, size_t size);

/* ---- external torque [observer] ---- */

typedef struct rbd_observer rbd_observer; /* see rbd_observer_init */

typedef struct rbd_observer_options {
    rbd_real gain;  /* 1/s, above 0: the felt torque follows with a time constant of 1 / gain */
    rbd_real slow;  /* rad/s or m/s: a slower dof counts as at rest; 0: 0.02 */
    rbd_real share; /* of the friction below that may be wrong, 0 to 1 */
    rbd_real least; /* N m: of the band, for what the model and the sensors lack */
    const rbd_joint_friction *friction; /* nv, or NULL: none. It must stay, and may change between steps */
} rbd_observer_options;

/* Prepares an observer of the torques that act on the joints beside the motors.
   memory    size bytes of any alignment; RBD_OBSERVER_SIZE(nv)
   observer  receives the structure, which lies inside memory; NULL after an error
   fault     may be NULL
   Errors: RBD_ERR_NULL, _MEMORY; _RANGE, an option that `fault` names. */
RBDI_API rbd_status rbd_observer_init(const rbd_model *m, const rbd_observer_options *options, void *memory,
                                      size_t size, rbd_observer **observer, rbd_estimate_fault *fault);

/* Bytes that rbd_observer_init needs for this model. */
RBDI_API size_t rbd_observer_size(const rbd_model *m);

/* Forgets the past: the next step begins anew, with a felt torque of 0. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_observer_reset(rbd_observer *observer);

/* One tick: the torque r that acts on each joint beside the motor and the friction, such as J' f of a push.
   r follows it as a filter of first order, r += gain dt (torque - r) / (1 + gain dt), stable for each gain
   and dt. The first step after init or reset takes the state alone, and r is 0.
   w       a work of the model
   q, v    nq, nv: the state at the end of the tick
   tau     nv: of the motors, constant in the tick. Of a floating base 0, or J' f of the known contacts
   dt      s, above 0: since the last step
   r       nv: the felt torque, N m; or NULL
   band    nv: how much of r may be friction: an alarm is |r| > band; or NULL. It follows, as r does,

               share (coulomb + viscous |v|) + coulomb of a dof at rest + least,

           so that r is off by no more, if friction is known to that share. A dof that turns back counts as
           at rest
   fault   may be NULL
   De Luca and Mattone (2005), with an implicit step. Errors, after which the observer and its results are as
   they were: RBD_ERR_NULL; _WORK; _NAN, an entry of q, v or tau, or all of it overflows; _RANGE, dt or
   friction. */
RBDI_API rbd_status rbd_observer_step(const rbd_model *m, rbd_work *w, rbd_observer *observer,
                                      const rbd_real *q, const rbd_real *v, const rbd_real *tau, rbd_real dt,
                                      rbd_real *r, rbd_real *band, rbd_estimate_fault *fault);

/* ---- friction and payload [estimate] ---- */

typedef struct rbd_estimate rbd_estimate; /* see rbd_estimate_init */

/* 0 is the default in brackets. */
typedef struct rbd_estimate_options {
    rbd_real mass;         /* kg: as heavy as a payload may be [5] */
    rbd_real reach;        /* m: as far as it may be from the body's origin [0.2] */
    rbd_real friction;     /* N m, N m s/rad: as large as friction and offset may be [100] */
    rbd_real forgetting;   /* what a sample leaves of the weight of those before, 0.5 to 1 [0.998] */
    rbd_real slow;         /* rad/s or m/s: a slower dof counts as at rest, and tells nothing [0.03] */
    const rbd_real *noise; /* nv, N m, above 0: standard deviations of tau; NULL: 0.1 of each dof */
    const unsigned char *left_out; /* nv flags: not 0 where tau is not known, as of a base on unknown
                                      contacts; NULL: none */
} rbd_estimate_options;

/* Prepares a recursive estimate of the friction of each degree of freedom, but those of floating joints, and
   of the payload of a body.
   body     that carries the payload, as the hand does; -1: friction alone
   options  NULL: all defaults. Its arrays need not stay
   memory   size bytes of any alignment; RBD_ESTIMATE_SIZE(nv)
   e        receives the structure, which lies inside memory; NULL after an error
   fault    may be NULL
   Errors: RBD_ERR_NULL, _MEMORY; _INDEX, a body; _RANGE, an option that `fault` names. */
RBDI_API rbd_status rbd_estimate_init(const rbd_model *m, int body, const rbd_estimate_options *options,
                                      void *memory, size_t size, rbd_estimate **e, rbd_estimate_fault *fault);

/* Bytes that rbd_estimate_init needs for this model. */
RBDI_API size_t rbd_estimate_size(const rbd_model *m);

/* Takes in one sample: tau = rbd_rnea(q, v, a) + friction + torque of the payload. A dof at rest tells
   nothing, since friction hides what holds it. A joint's friction is forgotten only while the joint moves.
   d           memory of rbd_derivatives_init, of the model without the payload
   q, v, a     nq, nv, nv: measured. Noise in a biases the estimate: filter all of them alike
   tau         nv: of the motors, and of a floating base what holds it
   fault       may be NULL
   Errors, after which the estimate is as it was: RBD_ERR_NULL; _WORK; _NAN, an entry of q, v, a or tau;
   _RANGE, numbers too large to compute with. */
RBDI_API rbd_status rbd_estimate_add(const rbd_model *m, rbd_derivatives *d, rbd_estimate *e,
                                     const rbd_real *q, const rbd_real *v, const rbd_real *a,
                                     const rbd_real *tau, rbd_estimate_fault *fault);

/* The estimate from all samples so far. A body can always be like that (Wensing, Kim and Slotine 2018).
   If samples tell little of the payload, some 15 rounds, 50 at most, find the nearest
   such body.
   payload   10: parameters as those of rbd_set_parameters, link axes; 0 after rbd_estimate_release; or NULL
   friction  nv; or NULL
   misfit    what the estimate leaves of the samples, over their `noise`: near 1 if the model and the noise
             are right; 0 before there are enough samples; or NULL
   Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_estimate_solve(rbd_estimate *e, rbd_const payload[10], rbd_joint_friction *friction,
                                       rbd_real *misfit);

/* Standard deviations of what rbd_estimate_solve gives, from the noise of tau alone. What the samples do not
   tell has those of the options mass, reach and friction. Either array may be NULL. Errors: RBD_ERR_NULL. */
RBDI_API rbd_status rbd_estimate_deviations(const rbd_estimate *e, rbd_const payload[10],
                                            rbd_joint_friction *friction);

/* The hand took something, or changed it: the payload is unknown from here on; friction stays known. Takes as
   long as rbd_estimate_solve. Errors: RBD_ERR_NULL; _INDEX, the estimate has no body. */
RBDI_API rbd_status rbd_estimate_grip(rbd_estimate *e);

/* The hand is empty: the payload is 0, and samples tell of friction alone. Errors: as rbd_estimate_grip. */
RBDI_API rbd_status rbd_estimate_release(rbd_estimate *e);

#endif
