#include "rbd_derivatives.h"

#include "models/hyq_model.h"

const rbd_model *m = &hyq_model;
unsigned char work_memory[HYQ_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(HYQ_NB, HYQ_NV)];
rbd_work *w;
rbd_derivatives *d;
rbd_status status;
double q[HYQ_NQ], v[HYQ_NV], a[HYQ_NV], tau[HYQ_NV];
double x_q[HYQ_NV * HYQ_NV], x_v[HYQ_NV * HYQ_NV], M[HYQ_NV * HYQ_NV];

void example_rbd_derivatives_init(void) {
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    if (status == RBD_OK) status = rbd_derivatives_init(m, w, memory, sizeof memory, &d);
    if (status == RBD_OK) status = rbd_neutral(m, q);
    if (rbd_derivatives_size(m) > sizeof memory) status = RBD_ERR_MEMORY;
}

void example_rbd_momentum_matrix(void) {
    double A[6 * HYQ_NV], rate[6];
    status = rbd_momentum_matrix(m, d, q, v, A, rate);
}

void example_rbd_com_jacobian(void) {
    double J[3 * HYQ_NV];
    status = rbd_com_jacobian(m, d, q, J);
}

void example_rbd_jacobian_derivative(void) {
    static double J_dot[6 * HYQ_NV];
    const int foot = rbd_body_index(m, "lf_lowerleg"), trunk = 0;
    status = rbd_kinematics(m, w, q, v, NULL); /* no rbd_derivatives is needed */
    if (status == RBD_OK) status = rbd_jacobian_derivative(m, w, foot, NULL, RBD_WORLD_AXES, J_dot);
    if (status == RBD_OK)
        status = rbd_relative_jacobian_derivative(m, w, foot, NULL, trunk, RBD_LINK_AXES, J_dot);
}

void example_rbd_coriolis(void) { status = rbd_coriolis(m, d, q, v, x_v); }

void example_rbd_id_free_base(void) {
    for (int i = 0; i < 6; i++) tau[i] = 0;      /* in: nothing holds the trunk */
    for (int i = 6; i < HYQ_NV; i++) a[i] = 0.1; /* in: accelerations of the legs */
    status = rbd_id_free_base(m, d, q, v, a, tau, NULL);
}

void example_rbd_id_derivatives(void) {
    status = rbd_id_derivatives(m, d, q, v, a, NULL, x_q, x_v, M); /* any of the three may be NULL */
}

void example_rbd_gravity_torque_derivatives(void) {
    status = rbd_gravity_torque_derivatives(m, d, q, x_q); /* stiffness of the robot under its weight */
}

void example_rbd_keep_zeros(void) {
    for (int i = 0; i < HYQ_NV * HYQ_NV; i++) x_v[i] = 0; /* cleared once */
    status = rbd_keep_zeros(d, 1);
    if (status == RBD_OK) status = rbd_coriolis(m, d, q, v, x_v);
    if (status == RBD_OK) status = rbd_keep_zeros(d, 0);
}

void example_rbd_fd_derivatives(void) {
    status = rbd_fd_derivatives(m, d, q, v, tau, NULL, a, x_q, x_v, NULL);
}

void example_rbd_regressor(void) {
    static double Y[HYQ_NV * 10 * HYQ_NB], kinetic[10 * HYQ_NB], potential[10 * HYQ_NB];
    status = rbd_regressor(m, d, q, v, a, Y);
    if (status == RBD_OK) status = rbd_energy_regressors(m, d, q, v, kinetic, potential);
}

void example_rbd_body_parameters(void) {
    double pi[10];
    rbd_body body;
    status = rbd_describe(m, 0, &body);
    if (status == RBD_OK) status = rbd_body_parameters(m, 0, pi);
    pi[0] *= 1.01; /* from an identification */
    if (status == RBD_OK) status = rbd_check_parameters(pi);
    if (status == RBD_OK) status = rbd_set_parameters(&body, pi);
}

void example_rbd_integrate_derivatives(void) {
    status = rbd_integrate_derivatives(m, v, 0.01, x_q, x_v); /* the linearisation of a step */
}

void example_rbd_difference_derivatives(void) { status = rbd_difference_derivatives(m, q, q, x_q, x_v); }
