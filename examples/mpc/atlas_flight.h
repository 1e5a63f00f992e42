/* atlas_flight.h - Atlas in flight as a problem for ilqr.h: joints driven within their limits, nothing that
   touches it, and so an angular momentum that no step may change. SPDX-License-Identifier: MIT */
#ifndef ATLAS_FLIGHT_H
#define ATLAS_FLIGHT_H

#include "ilqr.h"

#include "models/atlas_model.h"

enum { NQ = ATLAS_NQ, NV = ATLAS_NV, NU = 30, NZ = ILQR_NZ(NV, NU) };

static const double dt = 0.02; /* s, of a knot */

/* Of the joints, in the order of the controls: rad, rad, rad/s, N m. */
static const struct limits {
    double lower, upper, velocity, effort;
} limits[NU] = {
    {-0.663225, 0.663225, 12, 106}, /* back_bkz */
    {-0.174358, 0.786794, 12, 275}, /* l_leg_hpz */
    {-0.786794, 0.174358, 12, 275}, /* r_leg_hpz */
    {-0.219388, 0.538783, 9, 445},  /* back_bky */
    {-0.523599, 0.523599, 12, 530}, /* l_leg_hpx */
    {-0.523599, 0.523599, 12, 530}, /* r_leg_hpx */
    {-0.523599, 0.523599, 12, 300}, /* back_bkx */
    {-1.61234, 0.65764, 12, 840},   /* l_leg_hpy */
    {-1.61234, 0.65764, 12, 840},   /* r_leg_hpy */
    {-1.5708, 0.785398, 12, 87},    /* l_arm_shz */
    {-0.602139, 1.14319, 6.28, 25}, /* neck_ay */
    {-0.785398, 1.5708, 12, 87},    /* r_arm_shz */
    {0, 2.35637, 12, 890},          /* l_leg_kny */
    {0, 2.35637, 12, 890},          /* r_leg_kny */
    {-1.5708, 1.5708, 12, 99},      /* l_arm_shx */
    {-1.5708, 1.5708, 12, 99},      /* r_arm_shx */
    {-1, 0.7, 12, 740},             /* l_leg_aky */
    {-1, 0.7, 12, 740},             /* r_leg_aky */
    {0, 3.14159, 12, 63},           /* l_arm_ely */
    {0, 3.14159, 12, 63},           /* r_arm_ely */
    {-0.8, 0.8, 12, 360},           /* l_leg_akx */
    {-0.8, 0.8, 12, 360},           /* r_leg_akx */
    {0, 2.35619, 12, 112},          /* l_arm_elx */
    {-2.35619, 0, 12, 112},         /* r_arm_elx */
    {-3.011, 3.011, 10, 25},        /* l_arm_uwy */
    {-3.011, 3.011, 10, 25},        /* r_arm_uwy */
    {-1.7628, 1.7628, 10, 25},      /* l_arm_mwx */
    {-1.7628, 1.7628, 10, 25},      /* r_arm_mwx */
    {-2.9671, 2.9671, 10, 25},      /* l_arm_lwy */
    {-2.9671, 2.9671, 10, 25},      /* r_arm_lwy */
};

static rbd_work *w;
static rbd_derivatives *d;
static double spin[3]; /* the angular momentum, world axes */

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* The base's velocity that goes with that of the joints, v_6 and on: Euler's method would let the angular
   momentum drift, and optimal control makes use of that. In a frame that falls with the centre of mass, in
   which there is no gravity, the momentum of the whole is (h; 0) about any point, and M v of a velocity v
   has it in the base's rows: hybrid dynamics from rest, with v in place of the acceleration. */
static rbd_status conserve(const double *q, const double *momentum, double *v) {
    static const double still[NV];
    unsigned char given[NV];
    double tau[NV] = {0};
    for (int i = 0; i < NV; i++) given[i] = i >= 6;
    memcpy(tau, momentum, sizeof *momentum * 6);
    return rbd_hybrid(&atlas_model, w, q, still, given, v, tau, NULL);
}

/* (h; 0) in the axes of the base. */
static void momentum_of_base(const double *q, double *momentum) {
    const double *e = q + ATLAS_Q_ROOT_QX;
    double t[3];
    for (int i = 0; i < 3; i++) /* x - 2 e x (w x - e x x), (e, w) the quaternion */
        t[i] = 2 * (e[(i + 1) % 3] * spin[(i + 2) % 3] - e[(i + 2) % 3] * spin[(i + 1) % 3]);
    for (int i = 0; i < 3; i++) {
        momentum[i] =
            spin[i] - e[3] * t[i] + e[(i + 1) % 3] * t[(i + 2) % 3] - e[(i + 2) % 3] * t[(i + 1) % 3];
        momentum[3 + i] = 0;
    }
}

static rbd_status step(void *user, int k, const double *q, const double *v, const double *u, double *v_next) {
    double tau[NV] = {0}, a[NV], momentum[6];
    (void)user, (void)k;
    memcpy(tau + 6, u, sizeof *u * NU);
    rbd_status status = rbd_aba(&atlas_model, w, q, v, tau, NULL, a);
    for (int i = 0; i < NV; i++) v_next[i] = v[i] + dt * a[i];
    momentum_of_base(q, momentum);
    if (status == RBD_OK) status = conserve(q, momentum, v_next);
    return status;
}

static void add_row(double factor, const double *x, double *y) {
    for (int i = 0; i < NZ; i++) y[i] += factor * x[i];
}

/* The base's rows of f_z, from those of the joints: M_bb dv_b = d(h; 0) - d(M v)_b at fixed v - M_bj dv_j. A
   turn of the base by e changes h in its axes by h x e. */
static rbd_status differentiate_base(const double *q, const double *v_next, double *f_z) {
    static const double still[NV];
    static double Mv_q[NV * NV], M[NV * NV], side[6 * NZ];
    double momentum[6];
    rbd_status status = rbd_id_derivatives(&atlas_model, d, q, still, v_next, NULL, Mv_q, NULL, M);
    memset(side, 0, sizeof side);
    momentum_of_base(q, momentum);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < NV; j++) side[i * NZ + j] = -Mv_q[i * NV + j];
        for (int j = 6; j < NV; j++) add_row(-M[i * NV + j], f_z + j * NZ, side + i * NZ);
    }
    for (int i = 0; i < 3; i++) {
        side[i * NZ + (i + 2) % 3] += momentum[(i + 1) % 3];
        side[i * NZ + (i + 1) % 3] -= momentum[(i + 2) % 3];
    }
    memset(f_z, 0, sizeof *f_z * 6 * NZ);
    for (int j = 0; j < 6 && status == RBD_OK; j++) { /* column j of the inverse of M_bb */
        double unit[6] = {0}, column[NV] = {0};
        unit[j] = 1;
        status = conserve(q, unit, column);
        for (int i = 0; i < 6; i++) add_row(column[i], side + j * NZ, f_z + i * NZ);
    }
    return status;
}

static rbd_status derivatives(void *user, const double *q, const double *v, const double *u, double *f_z) {
    const ilqr_problem *p = user;
    rbd_status status = RBD_OK;
    for (int k = 0; k < p->knots && status == RBD_OK; k++, q += NQ, v += NV, u += NU, f_z += NV * NZ) {
        static double by_q[NV * NV], by_v[NV * NV], by_tau[NV * NV];
        double tau[NV] = {0};
        memcpy(tau + 6, u, sizeof *u * NU);
        status = rbd_fd_derivatives(&atlas_model, d, q, v, tau, NULL, NULL, by_q, by_v, by_tau);
        ilqr_accelerations(p, 6, dt, by_q, by_v, by_tau, f_z);
        if (status == RBD_OK) status = differentiate_base(q, v + NV, f_z);
    }
    return status;
}

/* In a frame that falls with it: without gravity. */
static void prepare_flight(void) {
    static unsigned char work_memory[ATLAS_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(ATLAS_NB, NV)];
    const double none[3] = {0};
    check(rbd_work_init(&atlas_model, work_memory, sizeof work_memory, &w));
    check(rbd_derivatives_init(&atlas_model, w, memory, sizeof memory, &d));
    check(rbd_set_gravity(w, none));
}

#endif
