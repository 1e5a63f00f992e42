/* reference.h - layout of the reference results; README.md has their origin. Include rbd.h before.
   packed.py reads this file: a comment begins with the shape, and has the word NULL where a member may lack.
   SPDX-License-Identifier: MIT */
#ifndef REFERENCE_H
#define REFERENCE_H

/* One state of a model: inputs and results. Conventions are rbd's; arrays are row-major. */
typedef struct ref_state {
    const double *gravity;            /* 3: world axes */
    const double *q;                  /* nq */
    const double *v;                  /* nv */
    const double *vdot;               /* nv: the acceleration given to inverse dynamics */
    const double *tau;                /* nv: the torque given to forward dynamics */
    const double *f_ext;              /* nb x 6: external wrenches, for the two _ext results only */
    const double *tau_rnea;           /* nv: inverse dynamics of q, v, vdot, without wrenches */
    const double *tau_rnea_ext;       /* nv: and with them */
    const double *g;                  /* nv: gravity torque */
    const double *c;                  /* nv: bias: inverse dynamics at vdot = 0, without wrenches */
    const double *M;                  /* nv x nv: mass matrix */
    const double *Minv;               /* nv x nv: its inverse */
    const double *qdd;                /* nv: forward dynamics of q, v, tau, without wrenches */
    const double *qdd_ext;            /* nv: and with them */
    double kinetic;                   /* energy, with the rotors' */
    double potential;                 /* energy, zero at the world origin */
    double mass;                      /* of all bodies that a joint moves */
    const double *com;                /* 3: their centre of mass, world axes */
    const double *com_vel;            /* 3: its velocity */
    const double *com_acc;            /* 3: its acceleration, for vdot */
    const double *body_R;             /* nb x 9: rotations, link to world axes */
    const double *body_p;             /* nb x 3: link origins in the world */
    const double *body_vel;           /* nb x 6: spatial velocities, link axes */
    const double *body_acc;           /* nb x 6: spatial accelerations for vdot, link axes, no gravity */
    const double *body_acc_classical; /* nb x 3: accelerations of link origins for vdot, link axes */
    int jac_body;                     /* the body of the Jacobians */
    const double *J_local;            /* 6 x nv: J_local v = body_vel */
    const double *J_world;            /* 6 x nv: at the link origin, world axes */
    const double *Jdot_v_world;       /* 6: d J_world / dt v */
    const double *h;                  /* 6: centroidal momentum (angular about the com; linear), world axes */
    const double *A_h;                /* 6 x nv: centroidal momentum matrix, A_h v = h */
    const double *h_dot;              /* 6: dh / dt for vdot */
    const double *dtau_dq;            /* nv x nv: d tau_rnea / tangent step of q; row = torque */
    const double *dtau_dv;            /* nv x nv: d tau_rnea / dv */
    const double *dqdd_dq;            /* nv x nv: d qdd / tangent step of q; row = acceleration */
    const double *dqdd_dv;            /* nv x nv: d qdd / dv */
    const double *Y;                  /* nv x nb x 10: regressor: tau_rnea = Y pi + armature vdot */
    double dt;                        /* step of q_next */
    const double *q_next;             /* nq: integrate(q, v dt) */
    const double *world_wrench;       /* 6: put on the world by all roots, about its origin, for vdot */
    double cond_M;                    /* condition number of M */
} ref_state;

/* A model with its states. */
typedef struct ref_model {
    const char *name;        /* as in the name of the .bin file */
    const char *about;       /* for a person */
    int nb;                  /* bodies */
    int nq;                  /* length of q */
    int nv;                  /* degrees of freedom */
    const rbd_body *bodies;  /* nb */
    const double *pi;        /* nb x 10: m, m com, inertia xx xy xz yy yz zz about the link origin */
    const int *body_iq;      /* nb: where the joint lies in q */
    const int *body_nq;      /* nb: how much of q it has */
    const int *body_iv;      /* nb: where it lies in v */
    const int *body_nv;      /* nb: how much of v it has */
    int nstates;             /* 3; a control model's states are elsewhere: 0 */
    const ref_state *states; /* nstates; NULL */
} ref_model;

/* ---- what controllers ask; README.md has the definitions ---- */

/* A point fixed in a link. */
typedef struct ref_point {
    int body;                          /* the link */
    const double *p;                   /* 3: the point, fixed in the link, link axes */
    const double *point_J;             /* 6 x nv: angular velocity; velocity of the point; world axes */
    const double *point_J_link;        /* 6 x nv: the same in link axes */
    const double *point_pos;           /* 3: world */
    const double *point_vel;           /* 6: point_J v */
    const double *point_acc_classical; /* 6: d point_vel / dt for vdot */
    const double *point_bias;          /* 6: the same for vdot = 0: d point_J / dt v */
} ref_point;

/* Frame 1 held to frame 2; R1, R2 turn frame vectors into the body's axes. */
typedef struct ref_constraint {
    int body1;
    double R1[9], p1[3];
    int body2; /* -1: the world */
    double R2[9], p2[3];
    int axes[6]; /* held: omega_x omega_y omega_z v_x v_y v_z, along the axes of frame 2 */
} ref_constraint;

/* Constraints that hold together. */
typedef struct ref_constraint_set {
    const char *name;
    int count;                         /* of constraints */
    const ref_constraint *constraints; /* count */
    double kp;                         /* 1/s^2, of Baumgarte's method */
    double kd;                         /* 1/s */
    double restitution;                /* 0.5 */
    const double *v_minus;             /* nv: velocity before the impact */
    int rows;                          /* axes held, of all the constraints */
    int rank;                          /* of J_c */
    double cond;                       /* largest over smallest non-zero singular value of J_c Minv J_c' */
    const double *J_c;                 /* rows x nv: J_c v = velocity of frame 1 seen from 2 */
    const double *gamma;               /* rows: dJ_c / dt v */
    const double *e;                   /* rows: position error */
    const double *qdd_c;               /* nv: a of M a + c = tau + J_c' lambda, J_c a + gamma = 0 */
    const double *lambda;              /* rows */
    const double *qdd_b;               /* nv: the same with J_c a + gamma = -kd (J_c v) - kp e */
    const double *lambda_b;            /* rows */
    const double *qdd_c_ext;           /* nv: as qdd_c, with the wrenches */
    const double *lambda_ext;          /* rows */
    const double *v_plus;              /* nv: M (v_plus - v_minus) = J_c' impulse, J_c v_plus = 0 */
    const double *impulse;             /* rows */
    const double *v_plus_r;            /* nv: the same with J_c v_plus = -restitution J_c v_minus */
    const double *impulse_r;           /* rows */
    const double *dqdd_c_dq;           /* nv x nv: derivatives; NULL where rank < rows */
    const double *dqdd_c_dv;           /* nv x nv; NULL likewise */
    const double *dqdd_c_dtau;         /* nv x nv; NULL likewise */
    const double *dlambda_dq;          /* rows x nv; NULL likewise */
    const double *dlambda_dv;          /* rows x nv; NULL likewise */
    const double *dlambda_dtau;        /* rows x nv; NULL likewise */
    const double *dqdd_b_dq;           /* nv x nv; NULL likewise */
    const double *dqdd_b_dv;           /* nv x nv; NULL likewise */
    const double *dlambda_b_dq;        /* rows x nv; NULL likewise */
    const double *dlambda_b_dv;        /* rows x nv; NULL likewise */
} ref_constraint_set;

/* One state: inputs and results. */
typedef struct ref_control_state {
    const double *gravity;                     /* 3: world axes */
    const double *q;                           /* nq */
    const double *v;                           /* nv */
    const double *vdot;                        /* nv: the acceleration given to inverse dynamics */
    const double *tau;                         /* nv: the torque given to forward dynamics */
    const double *f_ext;                       /* nb x 6: external wrenches, for the two _ext results only */
    const double *tau_rnea;                    /* nv: inverse dynamics of q, v, vdot, without wrenches */
    const double *tau_rnea_ext;                /* nv: and with them */
    const double *qdd;                         /* nv: forward dynamics of q, v, tau, without wrenches */
    const double *qdd_ext;                     /* nv: and with them */
    const double *c;                           /* nv: bias: inverse dynamics at vdot = 0, without wrenches */
    const double *g;                           /* nv: gravity torque */
    const double *M;                           /* nv x nv: mass matrix */
    const double *Minv;                        /* nv x nv: its inverse */
    const double *dtau_dq;                     /* nv x nv: d tau_rnea / tangent step of q; row = torque */
    const double *dtau_dv;                     /* nv x nv: d tau_rnea / dv */
    const double *dqdd_dq;                     /* nv x nv: d qdd / tangent step of q; row = acceleration */
    const double *dqdd_dv;                     /* nv x nv: d qdd / dv */
    const double *dtau_dq_ext;                 /* nv x nv: of tau_rnea_ext, wrenches held in link axes */
    const double *dtau_dv_ext;                 /* nv x nv */
    const double *dqdd_dq_ext;                 /* nv x nv: of qdd_ext, likewise */
    const double *dqdd_dv_ext;                 /* nv x nv */
    const double *C;                           /* nv x nv: Coriolis matrix: C v = c - g */
    const double *Mdot;                        /* nv x nv: dM / dt along v, which is C + C' */
    int npoints;                               /* 3 */
    const ref_point *points;                   /* npoints */
    const double *J_com;                       /* 3 x nv: J_com v = com_vel */
    const double *A_h;                         /* 6 x nv: centroidal momentum matrix, A_h v = h */
    const double *h;                           /* 6: centroidal momentum, world axes */
    const double *h_dot;                       /* 6: dh / dt for vdot */
    const double *A_h_dot_v;                   /* 6: h_dot - A_h vdot */
    const int *hybrid_given;                   /* nv: 1 where a is given by vdot, 0 where tau is given */
    const double *hybrid_a;                    /* nv: the full result: M a + c = tau */
    const double *hybrid_tau;                  /* nv */
    double kinetic;                            /* energy, with the rotors' */
    double potential;                          /* energy, zero at the world origin */
    const double *Y;                           /* nv x nb x 10: as before; NULL in the last states */
    const double *Y_kinetic;                   /* nb x 10: kinetic = Y_kinetic pi + sum armature v^2 / 2 */
    const double *Y_potential;                 /* nb x 10: potential = Y_potential pi */
    const double *integrate_d;                 /* nv: a tangent step from q */
    const double *integrate_q_plus;            /* nq: integrate(q, d) */
    const double *integrate_d_dq;              /* nv x nv: d q_plus / tangent step of q */
    const double *integrate_d_dd;              /* nv x nv: d q_plus / dd */
    const double *difference_q1;               /* nq */
    const double *difference_d;                /* nv: difference(q, q1): q1 = integrate(q, d) */
    const double *difference_d_dq0;            /* nv x nv: d d / tangent step of q */
    const double *difference_d_dq1;            /* nv x nv: d d / tangent step of q1 */
    int nconstraint_sets;                      /* 1 to 3 */
    const ref_constraint_set *constraint_sets; /* nconstraint_sets: each for itself */
    double cond_M;                             /* condition number of M */
} ref_control_state;

/* A model with its states. */
typedef struct ref_control {
    const ref_model *model;          /* another one than those above, without states */
    int nstates;                     /* 4 */
    const ref_control_state *states; /* nstates */
} ref_control;

#endif
