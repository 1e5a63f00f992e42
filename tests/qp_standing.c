/* qp_standing.c - rbd_qp.h and the contact step agree: HyQ stands still, pushed sideways. A quadratic program
   chooses forces of the feet within friction, torques follow, and rbd_contact_step finds the same forces. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "larger.h"
#include "rbd_contact.h"
#include "rbd_qp.h"

#define HYQ_MODEL_IMPLEMENTATION
#include "models/hyq_model.h"

enum { NV = HYQ_NV, FEET = 4, N = 3 * FEET, BASE = 6, PYRAMID = 4 * FEET, ROWS = BASE + PYRAMID };

static const double mu = 0.5, dt = 1e-3;
static unsigned char memory[HYQ_WORK_SIZE], contact_memory[100000];
static rbd_work *w;
static rbd_contact_set *contacts;
static double q[HYQ_NQ];

static void check(rbd_status status) {
    if (status != RBD_OK) exit((printf("FAIL %s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* Feet on z = 0, at rest. */
static void stand(void) {
    static const double toe[3] = {0.33, 0, 0};
    const rbd_contact_options options = {.tolerance = 1e-12, .iterations = 1000};
    rbd_contact foot[FEET] = {{0}};
    double p[3];

    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    check(rbd_neutral(&hyq_model, q));
    for (int i = 0; i < FEET; i++) {
        q[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7 : -0.7;
        q[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4 : 1.4;
        foot[i].body1 = HYQ_BODY_LF_LOWERLEG + i;
        foot[i].body2 = -1;
        for (int k = 0; k < 3; k++) foot[i].point[k] = toe[k];
        foot[i].friction = mu;
    }
    check(rbd_kinematics(&hyq_model, w, q, NULL, NULL));
    check(rbd_point_position(&hyq_model, w, foot[0].body1, toe, p));
    q[HYQ_Q_ROOT_Z] -= p[2];
    check(rbd_contact_set_init(&hyq_model, w, foot, FEET, NULL, 0, &options, contact_memory,
                               sizeof contact_memory, &contacts, NULL));
}

/* Least forces f and torques tau that hold HyQ against f_ext, within friction or not. */
static rbd_qp_status share(const double *f_ext, int friction, double *f, double *tau) {
    static unsigned char qp_memory[RBD_QP_SIZE(N, 0, ROWS, 0)];
    static double H[N * N], zero[N], C[ROWS * N], lower[ROWS], upper[ROWS], J[FEET][6 * NV];
    const double rest[NV] = {0}, toe[3] = {0.33, 0, 0};
    const rbd_qp_problem p = {
        .n = N, .rows = friction ? ROWS : BASE, .H = H, .f = zero, .C = C, .lower = lower, .upper = upper};
    double lambda[ROWS];
    signed char side[ROWS];
    rbd_qp_status status;

    /* M 0 + h = tau + J'f: the base has no torque */
    check(rbd_rnea(&hyq_model, w, q, rest, rest, f_ext, tau));
    check(rbd_kinematics(&hyq_model, w, q, rest, NULL));
    for (int i = 0; i < FEET; i++) {
        check(rbd_jacobian(&hyq_model, w, HYQ_BODY_LF_LOWERLEG + i, toe, RBD_WORLD_AXES, J[i]));
        for (int k = 0; k < 3; k++) {
            H[(3 * i + k) * N + 3 * i + k] = 1;
            for (int r = 0; r < BASE; r++) C[r * N + 3 * i + k] = J[i][(3 + k) * NV + r];
        }
        for (int k = 0; k < 4; k++) { /* |f_x|, |f_y| <= 0.99 mu f_z / sqrt(2) */
            double *row = C + (BASE + 4 * i + k) * N + 3 * i;
            row[k / 2] = k % 2 ? -1 : 1;
            row[2] = -0.99 * mu / sqrt(2);
            lower[BASE + 4 * i + k] = -RBD_QP_NONE;
        }
    }
    for (int r = 0; r < BASE; r++) lower[r] = upper[r] = tau[r];
    status = rbd_qp_solve(&p, NULL, qp_memory, sizeof qp_memory, f, lambda, side, NULL);

    for (int r = 0; r < NV; r++)
        for (int i = 0; i < FEET; i++)
            for (int k = 0; k < 3; k++) tau[r] -= J[i][(3 + k) * NV + r] * f[3 * i + k];
    return status;
}

/* How far the forces of a step with tau are from f, N; *slips: feet that bear something and do not
   stick; at the tip of the cone, where a foot bears nothing, it may be called either. */
static double apart(const double *f_ext, const double *f, const double *tau, int *slips) {
    const double rest[NV] = {0};
    double next_q[HYQ_NQ], next_v[NV], force[3], most = 0;

    rbd_contact_reset(contacts);
    check(rbd_contact_step(&hyq_model, contacts, q, rest, tau, f_ext, NULL, dt, next_q, next_v));
    *slips = 0;
    for (int i = 0; i < FEET; i++) {
        const rbd_contact_state state = rbd_contact_get(contacts, i, NULL, force);
        *slips += state != RBD_STICKS && force[2] > 1e-6;
        for (int k = 0; k < 3; k++) most = larger(most, fabs(force[k] - f[3 * i + k]));
    }
    return most;
}

int main(void) {
    int failed = 0;
    stand();
    for (int push = 0; push <= 250; push += 50) {
        double f_ext[6 * HYQ_NB] = {0}, f[N], tau[NV];
        int slips, least_slips;
        f_ext[6 * HYQ_BODY_BASE_LINK_0 + 4] = push;

        const rbd_qp_status status = share(f_ext, 1, f, tau);
        const double off = apart(f_ext, f, tau, &slips);
        printf("%3d N: the step's forces differ by %.1e N, %d feet slip", push, off, slips);
        failed |= status != RBD_QP_OK || !(off < 1e-6) || slips;

        share(f_ext, 0, f, tau);
        apart(f_ext, f, tau, &least_slips);
        printf("; with least forces %d slip\n", least_slips);
        failed |= push == 250 && least_slips == 0;
    }
    printf("%s\n", failed ? "FAIL" : "they agree");
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
