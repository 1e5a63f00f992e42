/* hyq_feet.h - HyQ as a problem for ilqr.h whose four feet stand, fly, or land in knots that are given: the
   dynamics and its derivatives, and those of the forces under the feet. SPDX-License-Identifier: MIT */
#ifndef HYQ_FEET_H
#define HYQ_FEET_H

#include "rbd_derivatives.h"

#include "rbd_constraints.h"

#include "ilqr.h"

#include "models/hyq_model.h"

enum {
    NQ = HYQ_NQ,
    NV = HYQ_NV,
    NU = 12, /* all joints have motors, the base has none */
    NZ = ILQR_NZ(NV, NU),
    FEET = 4,
    ROWS = 3 * FEET,
    MOST_KNOTS = 120, /* of the horizon */
    SCHEDULE = 400    /* knots of which it is known who stands */
};

typedef enum phase { STAND, FLY, IMPACT } phase; /* an impact takes no time */

static const double tick = 0.01; /* s, of a knot but of the impact */
static const int leg[FEET] = {HYQ_BODY_LF_LOWERLEG, HYQ_BODY_RF_LOWERLEG, HYQ_BODY_LH_LOWERLEG,
                              HYQ_BODY_RH_LOWERLEG};
static const double toe[3] = {0.33, 0, 0};

static rbd_work *w;
static rbd_derivatives *d;
static rbd_constraint_set *feet;
static phase schedule[SCHEDULE];
static const phase *phases = schedule; /* from the horizon's beginning on */
static double tried[MOST_KNOTS][ROWS]; /* forces under the feet by the last steps; */
static double force[MOST_KNOTS][ROWS], force_z[MOST_KNOTS][ROWS][NZ]; /* those of the trajectory that was
                                        linearised last; of an impact its impulse over one tick, N */

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* HyQ, and its feet as constraints: with their places for rbd_assemble, without stiffness. A standing
   foot loses its remaining velocity in one tick. */
static void prepare_feet(void) {
    static unsigned char work_memory[HYQ_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(HYQ_NB, NV)],
        set_memory[RBD_CONSTRAINT_SET_SIZE(NV, ROWS)];
    rbd_constraint list[FEET];
    for (int i = 0; i < FEET; i++) {
        const double place[3] = {i < 2 ? 0.37 : -0.37, i % 2 ? -0.32 : 0.32, 0};
        list[i] = rbd_point_contact(leg[i], toe, place);
        list[i].kd = 1 / tick;
    }
    check(rbd_work_init(&hyq_model, work_memory, sizeof work_memory, &w));
    check(rbd_derivatives_init(&hyq_model, w, memory, sizeof memory, &d));
    check(rbd_constraint_set_init(&hyq_model, w, list, FEET, set_memory, sizeof set_memory, &feet, NULL));
}

/* Stands there, the trunk 0.5 m above, and the torques that hold it. */
static void stand(double *q, double *hold) {
    double weight[NV], still[NV] = {0}, tau[NV], near[NQ];
    check(rbd_neutral(&hyq_model, near));
    near[HYQ_Q_ROOT_Z] = 0.5;
    near[HYQ_Q_LF_HFE_JOINT] = near[HYQ_Q_RF_HFE_JOINT] = 0.7;
    near[HYQ_Q_LF_KFE_JOINT] = near[HYQ_Q_RF_KFE_JOINT] = -1.4;
    near[HYQ_Q_LH_HFE_JOINT] = near[HYQ_Q_RH_HFE_JOINT] = -0.7;
    near[HYQ_Q_LH_KFE_JOINT] = near[HYQ_Q_RH_KFE_JOINT] = 1.4;
    for (int i = 0; i < NV; i++) weight[i] = i < 6 ? 1000 : 1; /* the trunk stays, the legs move */
    check(rbd_assemble(&hyq_model, feet, near, NULL, weight, q, NULL));
    check(rbd_constrained_id(&hyq_model, feet, q, still, still, NULL, NULL, NULL, tau, NULL));
    memcpy(hold, tau + 6, sizeof *hold * NU);
}

static void torques(const double *u, double *tau) {
    for (int i = 0; i < NV; i++) tau[i] = i < 6 ? 0 : u[i - 6];
}

static rbd_status step(void *user, int k, const double *q, const double *v, const double *u, double *v_next) {
    double tau[NV], a[NV] = {0};
    rbd_status status;
    (void)user;
    torques(u, tau);
    if (phases[k] == IMPACT) {
        status = rbd_impact(&hyq_model, feet, q, v, 0, v_next, tried[k]);
        for (int i = 0; i < ROWS; i++) tried[k][i] /= tick;
        return status;
    }
    status = phases[k] == STAND ? rbd_constrained_fd(&hyq_model, feet, q, v, tau, NULL, a, tried[k])
                                : rbd_aba(&hyq_model, w, q, v, tau, NULL, a);
    for (int i = 0; i < NV; i++) v_next[i] = v[i] + tick * a[i];
    return status;
}

/* Y += A B, rows x NV times NV x NV; of Y every row is ld long. */
static void add_product(int rows, const double *A, const double *B, int ld, double *Y) {
    for (int i = 0; i < rows; i++) ilqr_product(NV, A + i * NV, 1, 1, B, NV, NV, 0, Y + i * ld, ld);
}

static double by_q[NV * NV], by_v[NV * NV], by_tau[NV * NV], force_q[ROWS * NV], force_v[ROWS * NV],
    force_tau[ROWS * NV];

/* Derivatives of the feet's forces in a knot in contact. */
static void put_forces(double (*f_z)[NZ]) {
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < NV; j++) {
            f_z[i][j] = force_q[i * NV + j], f_z[i][NV + j] = force_v[i * NV + j];
            if (j >= 6) f_z[i][2 * NV + j - 6] = force_tau[i * NV + j];
        }
}

/* The impact is a constrained acceleration from rest: M a + g = tau + J' impulse with J a = 0 and the torque
   tau = M v + g has the solution a = v_next. So its derivatives are by_q + by_tau dtau/dq and by_tau M. */
static rbd_status differentiate_impact(const double *q, const double *v, double *f_z, double *forces,
                                       double (*forces_z)[NZ]) {
    static const double zero[NV];
    double tau[NV], tau_q[NV * NV], M[NV * NV];
    rbd_status status = rbd_rnea(&hyq_model, w, q, zero, v, NULL, tau);
    if (status == RBD_OK) status = rbd_id_derivatives(&hyq_model, d, q, zero, v, NULL, tau_q, NULL, M);
    if (status == RBD_OK)
        status = rbd_constrained_fd_derivatives(&hyq_model, feet, d, q, zero, tau, NULL,
                                                &(rbd_constrained_fd_results){.lambda = forces,
                                                                              .da_dq = by_q,
                                                                              .da_dtau = by_tau,
                                                                              .dlambda_dq = force_q,
                                                                              .dlambda_dtau = force_tau});
    memset(f_z, 0, sizeof *f_z * NV * NZ);
    for (int i = 0; i < NV; i++) memcpy(f_z + i * NZ, by_q + i * NV, sizeof *f_z * NV);
    add_product(NV, by_tau, tau_q, NZ, f_z);
    add_product(NV, by_tau, M, NZ, f_z + NV);
    for (int i = 0; i < ROWS; i++) {
        memcpy(forces_z[i], force_q + i * NV, sizeof *f_z * NV);
        add_product(1, force_tau + i * NV, tau_q, NZ, forces_z[i]);
        add_product(1, force_tau + i * NV, M, NZ, forces_z[i] + NV);
        for (int j = 0; j < NZ; j++) forces_z[i][j] /= tick;
        forces[i] /= tick;
    }
    return status;
}

static rbd_status derivatives(void *user, const double *q, const double *v, const double *u, double *f_z) {
    const ilqr_problem *p = user;
    rbd_status status = RBD_OK;
    memset(force_z, 0, sizeof force_z);
    for (int k = 0; k < p->knots && status == RBD_OK; k++, q += NQ, v += NV, u += NU, f_z += NV * NZ) {
        double tau[NV];
        torques(u, tau);
        if (phases[k] == IMPACT) {
            status = differentiate_impact(q, v, f_z, force[k], force_z[k]);
            continue;
        }
        if (phases[k] == STAND) {
            status = rbd_constrained_fd_derivatives(&hyq_model, feet, d, q, v, tau, NULL,
                                                    &(rbd_constrained_fd_results){.lambda = force[k],
                                                                                  .da_dq = by_q,
                                                                                  .da_dv = by_v,
                                                                                  .da_dtau = by_tau,
                                                                                  .dlambda_dq = force_q,
                                                                                  .dlambda_dv = force_v,
                                                                                  .dlambda_dtau = force_tau});
            put_forces(force_z[k]);
        } else {
            status = rbd_fd_derivatives(&hyq_model, d, q, v, tau, NULL, NULL, by_q, by_v, by_tau);
        }
        ilqr_accelerations(p, 6, tick, by_q, by_v, by_tau, f_z);
    }
    return status;
}

#endif
