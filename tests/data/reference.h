/* reference.h - layout of the reference results; README.md has their origin. Include rbd.h before.
   SPDX-License-Identifier: MIT. Written by convert.py: change that instead. */
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
    const char *name;        /* as in the name of the .inc file */
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
    int nstates;             /* 5 to 10 */
    const ref_state *states; /* nstates */
} ref_model;

#endif
