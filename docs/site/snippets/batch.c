#include "rbd_constraints.h"

#include "rbd_derivatives.h"

#include "rbd_batch.h"

#include "models/hyq_model.h"

enum { STATES = 10, NQ = HYQ_NQ, NV = HYQ_NV, FEET = 2, ROWS = 3 * FEET };
const rbd_model *m = &hyq_model;
unsigned char memory[500000], derivatives_memory[2000000], set_memory[500000];
rbd_batch *b;
rbd_batch_derivatives *d;
rbd_batch_constraint_set *c;
rbd_status status;
double q[STATES * NQ], v[STATES * NV], a[STATES * NV], tau[STATES * NV]; /* state after state */

void example_rbd_batch_init(void) {
    uint64_t seed = 1;
    for (int s = 0; s < STATES && status == RBD_OK; s++) status = rbd_random(m, &seed, q + s * NQ);
    if (rbd_batch_size(m) > sizeof memory) status = RBD_ERR_MEMORY;
    if (status == RBD_OK) status = rbd_batch_init(m, memory, sizeof memory, &b);
}

void example_rbd_batch_lanes(void) {
    if (STATES % rbd_batch_lanes() != 0) tau[0] = 0; /* the last vector is not full: it takes as long */
}

void example_rbd_batch_set_gravity(void) {
    const double moon[3] = {0, 0, -1.62};
    status = rbd_batch_set_gravity(b, moon);
}

void example_rbd_batch_rnea(void) { status = rbd_batch_rnea(m, b, STATES, q, v, a, NULL, tau); }

void example_rbd_batch_bias(void) { status = rbd_batch_bias(m, b, STATES, q, v, NULL, tau); }

void example_rbd_batch_crba(void) {
    static double M[STATES * NV * NV];
    status = rbd_batch_crba(m, b, STATES, q, M); /* state s has M + s * NV * NV */
}

void example_rbd_batch_crba_packed(void) {
    static double packed[STATES * NV * (NV + 1) / 2];
    status = rbd_batch_crba_packed(m, b, STATES, q, packed);
}

void example_rbd_batch_aba(void) { status = rbd_batch_aba(m, b, STATES, q, v, tau, NULL, a); }

void example_rbd_batch_fd_cholesky(void) { status = rbd_batch_fd_cholesky(m, b, STATES, q, v, tau, NULL, a); }

void example_rbd_batch_singular(void) {
    int dof, state;
    status = rbd_batch_aba(m, b, STATES, q, v, tau, NULL, a);
    state = rbd_batch_singular(b, &dof); /* -1: none */
    if (status == RBD_ERR_SINGULAR && state >= 0) tau[state * NV + dof] = 0;
}

void example_rbd_batch_minverse(void) {
    static double Minv[STATES * NV * NV];
    status = rbd_batch_minverse(m, b, STATES, q, Minv);
}

void example_rbd_batch_jacobian(void) {
    static double J[STATES * 6 * NV];
    const double toe[3] = {0.33, 0, 0};
    status = rbd_batch_jacobian(m, b, STATES, q, HYQ_BODY_LF_LOWERLEG, toe, RBD_WORLD_AXES, J);
}

void example_rbd_batch_momentum(void) {
    double h[STATES * 6];
    status = rbd_batch_momentum(m, b, STATES, q, v, a, h, NULL);
}

void example_rbd_batch_set_layout(void) {
    static double q_blocks[STATES * NQ], tau_blocks[STATES * NV], zero[STATES * NV];
    const int lanes = rbd_batch_lanes(), n = STATES - STATES % lanes; /* full blocks here */
    for (int s = 0; s < n; s++)
        for (int k = 0; k < NQ; k++) q_blocks[(s / lanes * NQ + k) * lanes + s % lanes] = q[s * NQ + k];
    status = rbd_batch_set_layout(b, RBD_BLOCKS); /* a state's coordinate k beside the next state's */
    if (status == RBD_OK) status = rbd_batch_rnea(m, b, n, q_blocks, zero, zero, NULL, tau_blocks);
    if (status == RBD_OK) status = rbd_batch_set_layout(b, RBD_ROWS);
}

void example_rbd_batch_derivatives_init(void) {
    if (rbd_batch_derivatives_size(m) > sizeof derivatives_memory) status = RBD_ERR_MEMORY;
    if (status == RBD_OK)
        status = rbd_batch_derivatives_init(m, b, derivatives_memory, sizeof derivatives_memory, &d);
}

void example_rbd_batch_id_derivatives(void) {
    static double by_q[STATES * NV * NV], by_v[STATES * NV * NV];
    status = rbd_batch_id_derivatives(m, d, STATES, q, v, a, NULL, by_q, by_v, NULL);
}

void example_rbd_batch_fd_derivatives(void) {
    static double by_q[STATES * NV * NV], by_v[STATES * NV * NV], by_tau[STATES * NV * NV];
    status = rbd_batch_fd_derivatives(m, d, STATES, q, v, tau, NULL, a, by_q, by_v, by_tau);
}

void example_rbd_batch_coriolis(void) {
    static double C[STATES * NV * NV];
    status = rbd_batch_coriolis(m, d, STATES, q, v, C);
}

void example_rbd_batch_momentum_matrix(void) {
    static double A[STATES * 6 * NV];
    status = rbd_batch_momentum_matrix(m, d, STATES, q, v, A, NULL);
}

void example_rbd_batch_regressor(void) {
    static double Y[STATES * NV * 10 * HYQ_NB];
    status = rbd_batch_regressor(m, d, STATES, q, v, a, Y);
}

void example_rbd_batch_constraint_set_init(void) {
    const double toe[3] = {0.33, 0, 0};
    const rbd_constraint feet[FEET] = {rbd_point_contact(HYQ_BODY_LF_LOWERLEG, toe, NULL),
                                       rbd_point_contact(HYQ_BODY_RH_LOWERLEG, toe, NULL)};
    if (rbd_batch_constraint_set_size(m, feet, FEET) > sizeof set_memory) status = RBD_ERR_MEMORY;
    if (status == RBD_OK)
        status = rbd_batch_constraint_set_init(m, b, feet, FEET, set_memory, sizeof set_memory, &c, NULL);
}

void example_rbd_batch_constrained_fd(void) {
    static double lambda[STATES * ROWS];
    status = rbd_batch_constrained_fd(m, c, STATES, q, v, tau, NULL, a, lambda);
}
