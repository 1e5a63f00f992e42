#include "rbd.h"

#include "models/hyq_model.h"

#include <stdio.h>

const rbd_model *m = &hyq_model;
unsigned char memory[HYQ_WORK_SIZE];
rbd_work *w;
rbd_status status;
double q[HYQ_NQ], v[HYQ_NV], a[HYQ_NV], tau[HYQ_NV], f_ext[6 * HYQ_NB];

void example_rbd_work_init(void) {
    status = rbd_work_init(m, memory, sizeof memory, &w); /* once, before the loop */
    if (status == RBD_OK) status = rbd_neutral(m, q);
}

void example_rbd_set_gravity(void) {
    const double moon[3] = {0, 0, -1.62};
    double before[3];
    status = rbd_get_gravity(w, before);
    if (status == RBD_OK) status = rbd_set_gravity(w, moon);
    if (status == RBD_OK) status = rbd_set_gravity(w, before);
}

void example_rbd_rnea(void) {
    for (int i = 0; i < HYQ_NV; i++) a[i] = -10 * v[i];
    status = rbd_rnea(m, w, q, v, a, NULL, tau); /* NULL: no external wrenches */
}

void example_rbd_bias(void) {
    double c[HYQ_NV];
    f_ext[5] = 100; /* 100 N on body 0, along its z axis */
    status = rbd_bias(m, w, q, v, f_ext, c);
}

void example_rbd_gravity_torque(void) { status = rbd_gravity_torque(m, w, q, tau); }

void example_rbd_generalized_momentum(void) {
    double p[HYQ_NV], ctv[HYQ_NV];
    status = rbd_generalized_momentum(m, w, q, v, p, ctv);
}

void example_rbd_crba(void) {
    static double M[HYQ_NV * HYQ_NV]; /* row i, column j: M[i * HYQ_NV + j] */
    status = rbd_crba(m, w, q, M);
}

void example_rbd_crba_packed(void) {
    static double packed[HYQ_NV * (HYQ_NV + 1) / 2];
    const int at = rbd_packed_index(m, HYQ_NV - 1, 0); /* of M(row, column); row below column */
    status = rbd_crba_packed(m, w, q, packed);
    if (status == RBD_OK)
        printf("%d numbers; the last joint and the trunk share %g\n", rbd_packed_size(m), packed[at]);
}

void example_rbd_aba(void) {
    status = rbd_aba(m, w, q, v, tau, NULL, a);
    if (status == RBD_ERR_SINGULAR) printf("degree of freedom %d moves no inertia\n", rbd_singular_dof(w));
}

void example_rbd_fd_cholesky(void) { status = rbd_fd_cholesky(m, w, q, v, tau, NULL, a); }

void example_rbd_hybrid(void) {
    unsigned char given[HYQ_NV] = {0};                       /* the trunk's torque is given: 0 in flight */
    for (int i = 6; i < HYQ_NV; i++) given[i] = 1, a[i] = 0; /* the legs' accelerations are */
    for (int i = 0; i < 6; i++) tau[i] = 0;
    status = rbd_hybrid(m, w, q, v, given, a, tau, NULL);
}

void example_rbd_cholesky_solve(void) {
    static double M[HYQ_NV * HYQ_NV], factor[HYQ_NV * (HYQ_NV + 1) / 2];
    double b[HYQ_NV] = {1}, x[HYQ_NV];
    status = rbd_crba(m, w, q, M);
    if (status == RBD_OK) status = rbd_cholesky_factor(m, w, M, factor);
    if (status == RBD_OK) status = rbd_cholesky_solve(m, w, factor, b, x);
}

void example_rbd_cholesky_solve_many(void) {
    static double packed[HYQ_NV * (HYQ_NV + 1) / 2], b[2 * HYQ_NV], x[2 * HYQ_NV];
    status = rbd_crba_packed(m, w, q, packed);
    if (status == RBD_OK) status = rbd_cholesky_factor_packed(m, w, packed); /* in place */
    if (status == RBD_OK) status = rbd_cholesky_solve_many(m, w, packed, 2, b, x);
}

void example_rbd_minverse(void) {
    static double Minv[HYQ_NV * HYQ_NV];
    status = rbd_minverse(m, w, q, Minv);
}

void example_rbd_passive(void) {
    double passive[HYQ_NV];
    status = rbd_passive(m, w, v, passive);
    for (int i = 0; i < HYQ_NV; i++) tau[i] += passive[i]; /* before forward dynamics */
}

void example_rbd_kinematics(void) {
    double R[9], p[3], velocity[6], acceleration[6];
    const int foot = rbd_body_index(m, "lf_lowerleg");
    status = rbd_kinematics(m, w, q, v, a); /* the calls below read what it left */
    if (status == RBD_OK) status = rbd_body_pose(m, w, foot, R, p);
    if (status == RBD_OK) status = rbd_body_velocity(m, w, foot, velocity);
    if (status == RBD_OK) status = rbd_body_acceleration(m, w, foot, acceleration);
    if (status == RBD_OK) status = rbd_body_acceleration_classical(m, w, foot, acceleration);
}

void example_rbd_body_kinematics(void) {
    static double J[6 * HYQ_NV];
    const int foot = rbd_body_index(m, "lf_lowerleg");
    status = rbd_body_kinematics(m, w, foot, q, NULL, NULL); /* trunk and this leg, not the others */
    if (status == RBD_OK) status = rbd_jacobian(m, w, foot, NULL, RBD_WORLD_AXES, J);
}

void example_rbd_com(void) {
    double kinetic, potential, c[3], c_dot[3];
    status = rbd_kinematics(m, w, q, v, NULL);
    if (status == RBD_OK) status = rbd_energy(m, w, &kinetic, &potential);
    if (status == RBD_OK) status = rbd_com(m, w, c, c_dot, NULL);
    if (status == RBD_OK)
        printf("%g kg at a height of %g m, with %g J\n", rbd_mass(m), c[2], kinetic + potential);
}

void example_rbd_joint_wrench(void) {
    static double wrench[6 * HYQ_NB]; /* a row for each body */
    status = rbd_joint_wrench(m, w, q, v, a, NULL, wrench);
}

void example_rbd_jacobian(void) {
    static double J[6 * HYQ_NV];
    const double toe[3] = {0.33, 0, 0}, push[6] = {0, 0, 0, 0, 0, 50}; /* 50 N upwards */
    const int foot = rbd_body_index(m, "lf_lowerleg");
    status = rbd_kinematics(m, w, q, NULL, NULL);
    if (status == RBD_OK) status = rbd_jacobian(m, w, foot, toe, RBD_WORLD_AXES, J);
    if (status == RBD_OK) status = rbd_jacobian_transpose(m, w, foot, toe, RBD_WORLD_AXES, push, tau);
}

void example_rbd_relative_jacobian(void) {
    static double J[6 * HYQ_NV];
    const int foot = rbd_body_index(m, "lf_lowerleg"), trunk = 0;
    status = rbd_kinematics(m, w, q, NULL, NULL);
    if (status == RBD_OK) status = rbd_relative_jacobian(m, w, foot, NULL, trunk, RBD_LINK_AXES, J);
}

void example_rbd_point_position(void) {
    const double toe[3] = {0.33, 0, 0};
    double place[3], velocity[6], bias[6];
    const int foot = rbd_body_index(m, "lf_lowerleg");
    status = rbd_kinematics(m, w, q, v, NULL); /* without a: the acceleration is dJ/dt v */
    if (status == RBD_OK) status = rbd_point_position(m, w, foot, toe, place);
    if (status == RBD_OK) status = rbd_point_velocity(m, w, foot, toe, RBD_WORLD_AXES, velocity);
    if (status == RBD_OK) status = rbd_point_acceleration(m, w, foot, toe, RBD_WORLD_AXES, bias);
}

void example_rbd_point_wrench(void) {
    const double push[6] = {0, 0, 0, 30, 0, 0}, point[3] = {0.2, 0, 0};
    const int trunk = 0;
    status = rbd_kinematics(m, w, q, NULL, NULL);
    if (status == RBD_OK)
        status = rbd_point_wrench(m, w, trunk, point, RBD_WORLD_AXES, push, &f_ext[6 * trunk]);
    if (status == RBD_OK) status = rbd_aba(m, w, q, v, tau, f_ext, a);
}

void example_rbd_momentum(void) {
    double h[6], h_dot[6];
    status = rbd_kinematics(m, w, q, v, a);
    if (status == RBD_OK) status = rbd_momentum(m, w, h, h_dot);
}

void example_rbd_step(void) {
    const double dt = 1e-3;
    status = rbd_aba(m, w, q, v, tau, NULL, a);
    if (status == RBD_OK) status = rbd_step(m, q, v, a, dt, q, v);
}

void example_rbd_free_step(void) {
    for (int k = 0; k < 1000 && status == RBD_OK; k++)
        status = rbd_free_step(m, w, q, v, tau, NULL, NULL, 1e-3, q, v);
}

void example_rbd_integrate(void) {
    double next[HYQ_NQ], d[HYQ_NV];
    status = rbd_integrate(m, q, v, 0.01, next);
    if (status == RBD_OK) status = rbd_difference(m, q, next, d); /* d = 0.01 v */
}

void example_rbd_interpolate(void) {
    double home[HYQ_NQ], between[HYQ_NQ];
    status = rbd_neutral(m, home);
    if (status == RBD_OK) status = rbd_interpolate(m, q, home, 0.25, between); /* a quarter of the way */
}

void example_rbd_distance(void) {
    double home[HYQ_NQ], weight[HYQ_NV], distance;
    for (int i = 0; i < HYQ_NV; i++) weight[i] = i >= 6; /* the legs; the trunk may be anywhere */
    status = rbd_neutral(m, home);
    if (status == RBD_OK) status = rbd_distance(m, q, home, weight, &distance); /* rad */
}

void example_rbd_rates_from_velocity(void) {
    double rates[HYQ_NQ];
    status = rbd_rates_from_velocity(m, q, v, rates);
    if (status == RBD_OK) status = rbd_velocity_from_rates(m, q, rates, v);
}

void example_rbd_random(void) {
    uint64_t seed = 1; /* the same seed gives the same states */
    status = rbd_random(m, &seed, q);
}

void example_rbd_joint(void) {
    rbd_joint_info info;
    const int knee = rbd_joint_index(m, rbd_joint_name(m, 3));
    status = rbd_joint(m, knee, &info);
    if (status == RBD_OK && info.nv == 1) q[info.iq] = 0.5 * (info.lower + info.upper);
}

void example_rbd_body_name(void) {
    for (int body = 0; body < rbd_nb(m); body++) printf("body %d is %s\n", body, rbd_body_name(m, body));
    for (int i = 0; i < rbd_nv(m); i++) printf("v[%d] moves body %d\n", i, rbd_dof_body(m, i));
    printf("q has %d numbers; the left fore foot is body %d\n", rbd_nq(m), rbd_body_index(m, "lf_lowerleg"));
}

void example_rbd_model_build(void) {
    static const rbd_body rod[1] = {{.name = "rod",
                                     .joint = "hinge",
                                     .parent = -1,
                                     .type = RBD_REVOLUTE,
                                     .axis = {0, 1, 0},
                                     .mass = 1,
                                     .com = {0, 0, -0.5},
                                     .inertia = {1. / 12, 0, 0, 1. / 12, 0, 0}}};
    static unsigned char room[RBD_MODEL_SIZE(1)];
    const double end[3] = {0, 0, -1};
    const rbd_model *pendulum;
    rbd_report report;
    rbd_body row;
    char text[240];
    status = rbd_model_build(rod, 1, room, sizeof room, &pendulum, &report);
    if (status != RBD_OK) rbd_finding_text(&report.error, text, sizeof text); /* body, field and reason */
    if (status == RBD_OK) status = rbd_add_payload(room, 0, 0.5, end, NULL);
    if (status == RBD_OK) status = rbd_describe(pendulum, 0, &row);
    printf("%s; the model takes %u bytes\n", rbd_status_string(status), (unsigned)rbd_model_size(rod, 1));
}

void example_rbd_model_build_kinematic(void) {
    static const rbd_body arm[2] = {
        {.name = "upper", .joint = "shoulder", .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}},
        {.name = "lower",
         .joint = "elbow",
         .parent = 0,
         .type = RBD_REVOLUTE,
         .axis = {0, 0, 1},
         .position = {0.4, 0, 0}}};
    static unsigned char room[RBD_MODEL_SIZE(2)], work[RBD_WORK_SIZE(2, 2)];
    const rbd_model *bare; /* no masses: poses and Jacobians alone */
    rbd_work *at;
    double p[3], torque[2];
    status = rbd_model_build_kinematic(arm, 2, room, sizeof room, &bare, NULL);
    if (status == RBD_OK) status = rbd_work_init(bare, work, sizeof work, &at);
    if (status == RBD_OK) status = rbd_kinematics(bare, at, q, NULL, NULL);
    if (status == RBD_OK) status = rbd_body_pose(bare, at, 1, NULL, p);
    if (status == RBD_OK && rbd_gravity_torque(bare, at, q, torque) != RBD_ERR_MASSLESS)
        status = RBD_ERR_MASS;
    if (status == RBD_OK && rbd_singular_dof(at) != 0) status = RBD_ERR_MASS; /* the shoulder moves no mass */
}

void example_rbd_lock_joints(void) {
    static rbd_body rows[HYQ_NB];
    static unsigned char room[RBD_MODEL_SIZE(HYQ_NB)];
    unsigned char locked[HYQ_NB] = {1}; /* the trunk in its place, over a table */
    const rbd_model *held;
    for (int i = 0; i < HYQ_NB; i++) rbd_describe(m, i, &rows[i]);
    status = rbd_lock_joints(rows, HYQ_NB, locked, q, rows, NULL);
    if (status == RBD_OK) status = rbd_model_build(rows, HYQ_NB, room, sizeof room, &held, NULL);
}

void example_rbd_work_size(void) {
    printf("a work of this robot takes %u bytes\n", (unsigned)rbd_work_size(m)); /* HYQ_WORK_SIZE */
}
