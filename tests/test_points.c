/* test_points.c - [points]: Jacobians, motion and wrenches of points; momentum. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "suites.h"
#include "support.h"

enum { MAX_J = 6 * MAX_V };
#define EACH_AXES for (int axes = RBD_WORLD_AXES; axes <= RBD_LINK_AXES; axes++)

static const char *const axes_name[2] = {"world", "link"};

/* "what, world axes" */
static const char *label(const char *what, int axes) {
    static char text[48];
    snprintf(text, sizeof text, "%s, %s axes", what, axes_name[axes]);
    return text;
}

/* p + R point, and R, of the motion that rbd_kinematics left */
static void pose_of_point(const robot *r, int number, int b, const double *point, double R[9], double p[3]) {
    RUN(rbd_body_pose(r->m, r->w, b, R, p));
    for (int k = 0; k < 3; k++) p[k] += dot(R + 3 * k, point, 3);
}

/* ---- the reference ---- */

static void check_reference_jacobian(const robot *r, const ref_model *model, const ref_state *s, int number) {
    double J[MAX_J], bias[6];
    const int b = s->jac_body;
    (void)model;
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_jacobian(r->m, r->w, b, NULL, RBD_LINK_AXES, J));
    expect_close("J, link axes", r, number, J, s->J_local, 6 * r->nv, 1e-14);
    RUN(rbd_jacobian(r->m, r->w, b, NULL, RBD_WORLD_AXES, J));
    expect_close("J, world axes", r, number, J, s->J_world, 6 * r->nv, 1e-14);
    RUN(rbd_point_acceleration(r->m, r->w, b, NULL, RBD_WORLD_AXES, bias));
    expect_close("dJ/dt v", r, number, bias, s->Jdot_v_world, 6, 1e-13);
}

START_TEST(jacobians_match_the_reference) { for_reference_states(check_reference_jacobian); }
END_TEST

static void check_control_points(const robot *r, const ref_control_state *s, int number) {
    double J[MAX_J], found[6], place[3];
    for (int i = 0; i < s->npoints; i++) {
        const ref_point *e = &s->points[i];
        RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->vdot));
        RUN(rbd_point_position(r->m, r->w, e->body, e->p, place));
        expect_close("place of a point", r, number, place, e->point_pos, 3, 1e-14);
        RUN(rbd_jacobian(r->m, r->w, e->body, e->p, RBD_WORLD_AXES, J));
        expect_close("J of a point, world axes", r, number, J, e->point_J, 6 * r->nv, 1e-14);
        RUN(rbd_jacobian(r->m, r->w, e->body, e->p, RBD_LINK_AXES, J));
        expect_close("J of a point, link axes", r, number, J, e->point_J_link, 6 * r->nv, 1e-14);
        RUN(rbd_point_velocity(r->m, r->w, e->body, e->p, RBD_WORLD_AXES, found));
        expect_close("velocity of a point", r, number, found, e->point_vel, 6, 1e-13);
        RUN(rbd_point_acceleration(r->m, r->w, e->body, e->p, RBD_WORLD_AXES, found));
        expect_close("acceleration of a point", r, number, found, e->point_acc_classical, 6, 1e-13);
        RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
        RUN(rbd_point_acceleration(r->m, r->w, e->body, e->p, RBD_WORLD_AXES, found));
        expect_close("bias of a point", r, number, found, e->point_bias, 6, 1e-13);
    }
}

START_TEST(points_match_the_reference) { for_control_states(check_control_points); }
END_TEST

static void check_control_momentum(const robot *r, const ref_control_state *s, int number) {
    double h[6], rate[6];
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->vdot));
    RUN(rbd_momentum(r->m, r->w, h, rate));
    expect_close("momentum", r, number, h, s->h, 6, 1e-13);
    expect_close("momentum rate", r, number, rate, s->h_dot, 6, 1e-13);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_momentum(r->m, r->w, NULL, rate));
    expect_close("momentum rate, a = NULL", r, number, rate, s->A_h_dot_v, 6, 1e-13);
}

/* n about the origin, of a wrench about c */
static void about_the_origin(const double c[3], const double f[6], double out[6]) {
    out[0] = f[0] + c[1] * f[5] - c[2] * f[4];
    out[1] = f[1] + c[2] * f[3] - c[0] * f[5];
    out[2] = f[2] + c[0] * f[4] - c[1] * f[3];
    memcpy(out + 3, f + 3, 3 * sizeof *out);
}

static void check_reference_momentum(const robot *r, const ref_model *model, const ref_state *s, int number) {
    double h[6], rate[6], c[3], world[6];
    (void)model;
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->vdot));
    RUN(rbd_momentum(r->m, r->w, h, rate));
    expect_close("momentum", r, number, h, s->h, 6, 1e-13);
    expect_close("momentum rate", r, number, rate, s->h_dot, 6, 1e-13);
    RUN(rbd_com(r->m, r->w, c, NULL, NULL));
    for (int k = 0; k < 3; k++) rate[3 + k] -= rbd_mass(r->m) * s->gravity[k];
    about_the_origin(c, rate, world);
    for (int k = 0; k < 6; k++) world[k] = -world[k];
    expect_close("wrench on the world", r, number, world, s->world_wrench, 6, 1e-13);
}

START_TEST(momentum_matches_the_reference) {
    for_reference_states(check_reference_momentum);
    for_control_states(check_control_momentum);
}
END_TEST

/* ---- Jacobians of random trees ---- */

static int draw_point(const robot *r, int number, double point[3]) {
    uint64_t seed = 31 * (uint64_t)number + (uint64_t)r->nb;
    for (int k = 0; k < 3; k++) point[k] = uniform(&seed, -1, 1);
    return below(&seed, r->nb);
}

/* Six rows out = R' rows, both halves. */
static void turn_rows(const double R[9], const double *rows, int n, double *out) {
    for (int half = 0; half < 2; half++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < n; k++) {
                const double *x = rows + 3 * half * n + k;
                out[(3 * half + i) * n + k] = R[i] * x[0] + R[3 + i] * x[n] + R[6 + i] * x[2 * n];
            }
}

/* Column k is the motion of the point for unit velocity of dof k; both axes see the same. */
static void check_columns(const robot *r, const state *s, int number) {
    double J[MAX_J], local[MAX_J], expected[MAX_J], turned[MAX_J], point[3], R[9], p[3];
    const int b = draw_point(r, number, point), nv = r->nv;
    for (int k = 0; k < nv; k++) {
        double unit[MAX_V] = {0}, motion[6];
        unit[k] = 1;
        RUN(rbd_kinematics(r->m, r->w, s->q, unit, NULL));
        RUN(rbd_point_velocity(r->m, r->w, b, point, RBD_WORLD_AXES, motion));
        for (int j = 0; j < 6; j++) expected[j * nv + k] = motion[j];
    }
    memset(J, 0xff, sizeof J);
    memset(local, 0xff, sizeof local);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    RUN(rbd_jacobian(r->m, r->w, b, point, RBD_WORLD_AXES, J));
    RUN(rbd_jacobian(r->m, r->w, b, point, RBD_LINK_AXES, local));
    expect_close("columns of J", r, number, J, expected, 6 * nv, 1e-13);
    pose_of_point(r, number, b, point, R, p);
    turn_rows(R, J, nv, turned);
    expect_close("J, link axes, turned", r, number, local, turned, 6 * nv, 1e-13);
}

START_TEST(columns_are_the_motion_of_one_dof) {
    for_random_trees(200, check_columns);
    for_random_states(2, check_columns);
}
END_TEST

/* Pose of the point by steps of q alone, Richardson from steps h and h / 2. */
static void difference_column(const robot *r, const state *s, int number, int b, const double *point, int k,
                              double column[6]) {
    double rate[2][12], R[9], p[3], W[9];
    for (int half = 0; half < 2; half++) {
        const double h = half ? 5e-4 : 1e-3;
        double side[2][12];
        for (int i = 0; i < 2; i++) {
            double q[MAX_Q], unit[MAX_V] = {0};
            unit[k] = 1;
            RUN(rbd_integrate(r->m, s->q, unit, i ? h : -h, q));
            RUN(rbd_kinematics(r->m, r->w, q, NULL, NULL));
            pose_of_point(r, number, b, point, side[i], side[i] + 9);
        }
        for (int i = 0; i < 12; i++) rate[half][i] = (side[1][i] - side[0][i]) / (2 * h);
    }
    for (int i = 0; i < 12; i++) rate[1][i] += (rate[1][i] - rate[0][i]) / 3;
    RUN(rbd_kinematics(r->m, r->w, s->q, NULL, NULL));
    pose_of_point(r, number, b, point, R, p);
    for (int i = 0; i < 3; i++) /* [omega]x = dR/dt R' */
        for (int j = 0; j < 3; j++) W[3 * i + j] = dot(rate[1] + 3 * i, R + 3 * j, 3);
    column[0] = (W[7] - W[5]) / 2, column[1] = (W[2] - W[6]) / 2, column[2] = (W[3] - W[1]) / 2;
    memcpy(column + 3, rate[1] + 9, 3 * sizeof *column);
}

static void check_differences(const robot *r, const state *s, int number) {
    double J[MAX_J], expected[MAX_J], point[3];
    const int b = draw_point(r, number, point), nv = r->nv;
    for (int k = 0; k < nv; k++) {
        double column[6];
        difference_column(r, s, number, b, point, k, column);
        for (int j = 0; j < 6; j++) expected[j * nv + k] = column[j];
    }
    RUN(rbd_jacobian(r->m, r->w, b, point, RBD_WORLD_AXES, J));
    expect_close("J by differences", r, number, J, expected, 6 * nv, 1e-9);
}

START_TEST(jacobians_are_derivatives_of_the_pose) { for_random_trees(60, check_differences); }
END_TEST

/* J v is the textbook's velocity, J a + dJ/dt v its acceleration; J' f without J. */
static void check_motion(const robot *r, const state *s, int number) {
    static tb_motion tb;
    tb_real tau[TB_MAX_DOFS];
    double J[MAX_J], Jv[6], Ja[6], bias[6], found[6], point[3], f[6], expected[MAX_V], torque[MAX_V];
    const int b = draw_point(r, number, point), nv = r->nv;
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, s->a, NULL, tau, &tb);
    memcpy(f, s->f_ext, sizeof f);
    EACH_AXES {
        RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
        RUN(rbd_jacobian(r->m, r->w, b, point, (rbd_axes)axes, J));
        RUN(rbd_point_velocity(r->m, r->w, b, point, (rbd_axes)axes, found));
        RUN(rbd_point_acceleration(r->m, r->w, b, point, (rbd_axes)axes, bias));
        multiply(J, s->v, 6, nv, Jv);
        multiply(J, s->a, 6, nv, Ja);
        expect_close(label("J v", axes), r, number, Jv, found, 6, 1e-12);
        RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
        RUN(rbd_point_acceleration(r->m, r->w, b, point, (rbd_axes)axes, found));
        for (int k = 0; k < 6; k++) Ja[k] += bias[k];
        expect_close(label("J a + dJ/dt v", axes), r, number, Ja, found, 6, 1e-12);
        RUN(rbd_jacobian_transpose(r->m, r->w, b, point, (rbd_axes)axes, f, torque));
        for (int k = 0; k < nv; k++) {
            expected[k] = 0;
            for (int j = 0; j < 6; j++) expected[k] += J[j * nv + k] * f[j];
        }
        expect_close(label("J' f", axes), r, number, torque, expected, nv, 1e-13);
    }
    RUN(rbd_point_velocity(r->m, r->w, b, NULL, RBD_LINK_AXES, found));
    expect_close_tb("velocity of a point, textbook", r, number, found, tb.velocity[b], 6, 1e-12);
    RUN(rbd_point_acceleration(r->m, r->w, b, NULL, RBD_LINK_AXES, found));
    expect_close_tb("acceleration of a point, textbook", r, number, found, tb.classical[b], 6, 1e-12);
}

START_TEST(motion_is_the_jacobian_s) { for_random_trees(200, check_motion); }
END_TEST

/* The row of f_ext does to inverse dynamics what J' f does. */
static void check_wrench(const robot *r, const state *s, int number) {
    double rows[6 * MAX_BODIES] = {0}, point[3], tau[MAX_V], torque[MAX_V], plain[MAX_V];
    const int b = draw_point(r, number, point);
    RUN(rbd_kinematics(r->m, r->w, s->q, NULL, NULL));
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, NULL, plain));
    EACH_AXES {
        RUN(rbd_point_wrench(r->m, r->w, b, point, (rbd_axes)axes, s->f_ext, rows + 6 * b));
        RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, rows, tau));
        RUN(rbd_jacobian_transpose(r->m, r->w, b, point, (rbd_axes)axes, s->f_ext, torque));
        for (int k = 0; k < r->nv; k++) torque[k] = plain[k] - torque[k];
        expect_close(label("wrench at a point", axes), r, number, tau, torque, r->nv, 1e-12);
    }
    memcpy(rows, s->f_ext, 6 * sizeof *rows);
    RUN(rbd_point_wrench(r->m, r->w, b, NULL, RBD_LINK_AXES, rows, rows));
    ck_assert(memcmp(rows, s->f_ext, 6 * sizeof *rows) == 0);
}

START_TEST(wrenches_work_on_the_columns) { for_random_trees(100, check_wrench); }
END_TEST

/* ---- seen from another body ---- */

/* Where a point of body b is from body `reference`: x = R2' (p - p2). */
static void seen_from(const robot *r, int number, int b, const double *point, int reference, double x[3]) {
    double R[9], p[3], R2[9], p2[3];
    pose_of_point(r, number, b, point, R, p);
    RUN(rbd_body_pose(r->m, r->w, reference, R2, p2));
    for (int i = 0; i < 3; i++) {
        x[i] = 0;
        for (int k = 0; k < 3; k++) x[i] += R2[3 * k + i] * (p[k] - p2[k]);
    }
}

/* The difference of two plain Jacobians at one place, zero against itself; the rate of x. */
static void check_relative(const robot *r, const state *s, int number) {
    static double J[MAX_J], J2[MAX_J], relative[MAX_J], turned[MAX_J];
    double point[3], R[9], p[3], R2[9], p2[3], x[2][3], rate[3];
    const int b = draw_point(r, number, point), nv = r->nv, reference = (b + number * 7 + r->nb / 2) % r->nb;
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_jacobian(r->m, r->w, b, point, RBD_WORLD_AXES, J));
    RUN(rbd_relative_jacobian(r->m, r->w, b, point, -1, RBD_WORLD_AXES, relative));
    ck_assert(memcmp(J, relative, 6 * (size_t)nv * sizeof *J) == 0);
    RUN(rbd_relative_jacobian(r->m, r->w, b, point, -1, RBD_LINK_AXES, relative));
    ck_assert(memcmp(J, relative, 6 * (size_t)nv * sizeof *J) == 0);
    pose_of_point(r, number, b, point, R, p);
    RUN(rbd_body_pose(r->m, r->w, reference, R2, p2));
    double place[3] = {0}; /* of the point, in the reference's axes */
    seen_from(r, number, b, point, reference, place);
    RUN(rbd_jacobian(r->m, r->w, reference, place, RBD_WORLD_AXES, J2));
    for (int i = 0; i < 6 * nv; i++) J[i] -= J2[i];
    RUN(rbd_relative_jacobian(r->m, r->w, b, point, reference, RBD_WORLD_AXES, relative));
    const double scale = 1 + largest(J2, 6 * nv);
    for (int i = 0; i < 6 * nv; i++)
        expect_small("relative J", r, number, fabs(relative[i] - J[i]) / scale, 1e-13);
    turn_rows(R2, relative, nv, turned);
    RUN(rbd_relative_jacobian(r->m, r->w, b, point, reference, RBD_LINK_AXES, relative));
    expect_close("relative J, link axes", r, number, relative, turned, 6 * nv, 1e-13);
    if (b == reference) ck_assert(!(largest(relative, 6 * nv) > 0));
    const double h = 1e-5;
    for (int i = 0; i < 2; i++) {
        double q[MAX_Q];
        RUN(rbd_integrate(r->m, s->q, s->v, i ? h : -h, q));
        RUN(rbd_kinematics(r->m, r->w, q, NULL, NULL));
        seen_from(r, number, b, point, reference, x[i]);
    }
    multiply(relative + 3 * nv, s->v, 3, nv, rate);
    for (int k = 0; k < 3; k++)
        expect_small("relative J by differences", r, number,
                     fabs((x[1][k] - x[0][k]) / (2 * h) - rate[k]) / scale, 1e-6);
}

START_TEST(relative_jacobian_is_the_motion_between) {
    for_random_trees(150, check_relative);
    for_random_states(3, check_relative);
}
END_TEST

/* Two arms on one base: the base moves neither against the other. */
START_TEST(common_ancestors_do_not_count) {
    const rbd_body rows[3] = {{.parent = -1, .type = RBD_FLOATING, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
                              {.parent = 0,
                               .type = RBD_REVOLUTE,
                               .axis = {0, 0, 1},
                               .position = {1, 0, 0},
                               .mass = 1,
                               .com = {1, 0, 0}},
                              {.parent = 0, .type = RBD_PRISMATIC, .axis = {0, 1, 0}, .mass = 1}};
    const double q[9] = {1, 2, 3, 0.1, 0.2, 0.3, 0.9, 0, 0.5}, point[3] = {2, 0, 0};
    const double expected[6][2] = {{0, 0}, {0, 0}, {1, 0}, {0, 0}, {2, -1}, {0, 0}};
    robot r = BUILD(rows);
    double J[6 * 8];
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_relative_jacobian(r.m, r.w, 1, point, 2, RBD_LINK_AXES, J), RBD_OK);
    for (int j = 0; j < 6; j++) {
        for (int k = 0; k < 6; k++) ck_assert(!(fabs(J[8 * j + k]) > 0));
        for (int k = 0; k < 2; k++) ck_assert(fabs(J[8 * j + 6 + k] - expected[j][k]) < 1e-14);
    }
    robot_free(&r);
}
END_TEST

/* ---- momentum ---- */

/* Sum over the bodies, from their poses and motions; and h_dot by differences of h. */
static void check_momentum(const robot *r, const state *s, int number) {
    double h[6], rate[6], sum[6] = {0}, side[2][6], c[3], scale = 1e-3;
    const double step = 1e-5;
    for (int i = 0; i < 2; i++) {
        double q[MAX_Q], v[MAX_V], way[MAX_V];
        const double t = i ? step : -step;
        for (int k = 0; k < r->nv; k++) v[k] = s->v[k] + t * s->a[k], way[k] = s->v[k] + t / 2 * s->a[k];
        RUN(rbd_integrate(r->m, s->q, way, t, q));
        RUN(rbd_kinematics(r->m, r->w, q, v, NULL));
        RUN(rbd_momentum(r->m, r->w, side[i], NULL));
    }
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    RUN(rbd_momentum(r->m, r->w, h, NULL));
    RUN(rbd_momentum(r->m, r->w, NULL, rate));
    RUN(rbd_com(r->m, r->w, c, NULL, NULL));
    for (int b = 0; b < r->nb; b++) {
        const rbd_body *row = &r->bodies[b];
        const double *I = row->inertia;
        double R[9], p[3], V[6], f[6], x[3];
        pose_of_point(r, number, b, row->com, R, p);
        RUN(rbd_point_velocity(r->m, r->w, b, row->com, RBD_WORLD_AXES, V));
        for (int k = 0; k < 3; k++) x[k] = R[k] * V[0] + R[3 + k] * V[1] + R[6 + k] * V[2], p[k] -= c[k];
        const double n[3] = {I[0] * x[0] + I[1] * x[1] + I[2] * x[2], I[1] * x[0] + I[3] * x[1] + I[4] * x[2],
                             I[2] * x[0] + I[4] * x[1] + I[5] * x[2]};
        for (int k = 0; k < 3; k++) f[k] = dot(R + 3 * k, n, 3), f[3 + k] = row->mass * V[3 + k];
        about_the_origin(p, f, f);
        for (int k = 0; k < 6; k++) sum[k] += f[k];
        scale += largest(f, 6);
    }
    for (int k = 0; k < 6; k++) {
        expect_small("momentum, summed", r, number, fabs(h[k] - sum[k]) / scale, 1e-13);
        expect_small("momentum rate by differences", r, number,
                     fabs((side[1][k] - side[0][k]) / (2 * step) - rate[k]) / (scale + largest(rate, 6)),
                     1e-7);
    }
}

START_TEST(momentum_is_that_of_the_bodies) { for_random_trees(150, check_momentum); }
END_TEST

/* Far from the world's origin no digit of the angular momentum is lost but those of the coordinates. */
START_TEST(momentum_does_not_depend_on_the_place) {
    const ref_model *hyq = reference_model(1);
    uint64_t seed = 5;
    robot r = robot_build(hyq->name, hyq->bodies, hyq->nb);
    double near[6], far[6];
    state s;
    draw_state(&r, &seed, &s);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, s.q, s.v, s.a), RBD_OK);
    ck_assert_int_eq(rbd_momentum(r.m, r.w, near, NULL), RBD_OK);
    for (int k = 0; k < 3; k++) s.q[k] += 1048576;
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, s.q, s.v, s.a), RBD_OK);
    ck_assert_int_eq(rbd_momentum(r.m, r.w, far, NULL), RBD_OK);
    expect_close("momentum 1000 km away", &r, 0, far, near, 6, 1e-9);
    robot_free(&r);
}
END_TEST

/* A speck 1000 km away, which is the first link, costs the others' centre of mass no digits. */
START_TEST(a_far_root_does_not_blur_the_others) {
    const rbd_body rows[2] = {
        {.parent = -1,
         .type = RBD_PRISMATIC,
         .axis = {0, 0, 1},
         .position = {1048576},
         .mass = 1.0 / 1048576},
        {.parent = -1, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .position = {0.3, 0.7, 0.1}, .mass = 1}};
    const double mass = 1 + rows[0].mass, com[3] = {1.3 / mass, 0.7 / mass, 0.1 / mass}, g[3] = {3, -2, 1};
    const double potential = -(3 * 1.3 - 2 * 0.7 + 0.1), q[2] = {0};
    double found[3], energy;
    robot r = robot_build("two roots", rows, 2);
    rbd_set_gravity(r.w, g);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_com(r.m, r.w, found, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_energy(r.m, r.w, NULL, &energy), RBD_OK);
    expect_close("centre of mass", &r, 0, found, com, 3, 1e-15);
    expect_close("potential energy", &r, 0, &energy, &potential, 1, 2e-15);
    robot_free(&r);
}
END_TEST

/* The torque of its base holds a floating robot: the momentum's rate less the weight. */
static void check_base(const robot *r, const state *s, int number) {
    double tau[MAX_V], rate[6], c[3], f[6], torque[MAX_V], R[9], p[3], x[3];
    int roots = 0;
    for (int b = 0; b < r->nb; b++) roots += r->bodies[b].parent < 0;
    if (roots > 1 || r->bodies[0].type != RBD_FLOATING) return;
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, NULL, tau));
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    RUN(rbd_momentum(r->m, r->w, NULL, rate));
    RUN(rbd_com(r->m, r->w, c, NULL, NULL));
    RUN(rbd_body_pose(r->m, r->w, 0, R, p));
    for (int k = 0; k < 3; k++) rate[3 + k] -= rbd_mass(r->m) * s->gravity[k];
    for (int i = 0; i < 3; i++) {
        x[i] = 0;
        for (int k = 0; k < 3; k++) x[i] += R[3 * k + i] * (c[k] - p[k]);
    }
    RUN(rbd_point_wrench(r->m, r->w, 0, x, RBD_WORLD_AXES, rate, f));
    RUN(rbd_jacobian_transpose(r->m, r->w, 0, NULL, RBD_LINK_AXES, f, torque));
    for (int k = 0; k < 6; k++) torque[k] += r->bodies[0].armature[k] * s->a[k];
    expect_close("wrench on a floating base", r, number, torque, tau, 6, 1e-11);
}

START_TEST(rate_of_momentum_is_the_force_on_the_base) {
    for_random_trees(300, check_base);
    for_random_states(3, check_base);
}
END_TEST

/* ---- edges ---- */

START_TEST(what_is_fixed_to_the_world_does_not_move) {
    double turn[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
    rbd_body rows[2] = {{.parent = -1, .type = RBD_FIXED, .position = {1, 2, 3}, .mass = 2},
                        {.parent = -1, .type = RBD_FIXED, .mass = 1}};
    const double zero[6] = {0}, f[6] = {1, 2, 3, 4, 5, 6}, point[3] = {1, 0, 0};
    const double row[6] = {2, -1, 3 - 4, 5, -4, 6}; /* turned by R', n + point x f */
    double x[6], J[1], h[6], rate[6];
    memcpy(rows[0].rotation, turn, sizeof turn);
    robot r = BUILD(rows);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, zero, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_point_velocity(r.m, r.w, 0, point, RBD_WORLD_AXES, x), RBD_OK);
    ck_assert(memcmp(x, zero, sizeof zero) == 0);
    ck_assert_int_eq(rbd_point_acceleration(r.m, r.w, 0, point, RBD_LINK_AXES, x), RBD_OK);
    ck_assert(memcmp(x, zero, sizeof zero) == 0);
    EACH_AXES {
        ck_assert_int_eq(rbd_jacobian(r.m, r.w, 0, point, (rbd_axes)axes, J), RBD_OK);
        ck_assert_int_eq(rbd_relative_jacobian(r.m, r.w, 0, point, 1, (rbd_axes)axes, J), RBD_OK);
        ck_assert_int_eq(rbd_jacobian_transpose(r.m, r.w, 0, point, (rbd_axes)axes, f, J), RBD_OK);
    }
    ck_assert_int_eq(rbd_point_wrench(r.m, r.w, 0, point, RBD_WORLD_AXES, f, x), RBD_OK);
    const double expected[6] = {row[0], row[1] - x[5], 3 + x[4], row[3], row[4], row[5]};
    for (int k = 0; k < 6; k++) ck_assert_msg(fabs(x[k] - expected[k]) < 1e-15, "row %d: %g", k, x[k]);
    ck_assert_int_eq(rbd_momentum(r.m, r.w, h, rate), RBD_OK);
    ck_assert(memcmp(h, zero, sizeof zero) == 0 && memcmp(rate, zero, sizeof zero) == 0);
    robot_free(&r);
}
END_TEST

/* A call with this status for every function of the section. */
#define EXPECT_ALL(status, m, w, b) \
    do { \
        ck_assert_int_eq(rbd_jacobian(m, w, b, NULL, RBD_WORLD_AXES, J), status); \
        ck_assert_int_eq(rbd_relative_jacobian(m, w, b, NULL, 0, RBD_WORLD_AXES, J), status); \
        ck_assert_int_eq(rbd_jacobian_transpose(m, w, b, NULL, RBD_WORLD_AXES, x, J), status); \
        ck_assert_int_eq(rbd_point_position(m, w, b, NULL, x), status); \
        ck_assert_int_eq(rbd_point_velocity(m, w, b, NULL, RBD_WORLD_AXES, x), status); \
        ck_assert_int_eq(rbd_point_acceleration(m, w, b, NULL, RBD_WORLD_AXES, x), status); \
        ck_assert_int_eq(rbd_point_wrench(m, w, b, NULL, RBD_WORLD_AXES, x, x), status); \
    } while (0)

START_TEST(errors_have_their_names) {
    const ref_model *iiwa = reference_model(2), *hyq = reference_model(1);
    robot r = robot_build(iiwa->name, iiwa->bodies, iiwa->nb);
    robot other = robot_build(hyq->name, hyq->bodies, hyq->nb);
    const double q[MAX_Q] = {0};
    const int wrong[3] = {-1, 7, 1000000};
    double J[42], x[6] = {0};
    EXPECT_ALL(RBD_ERR_ORDER, r.m, r.w, 0);
    ck_assert_int_eq(rbd_momentum(r.m, r.w, x, NULL), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    EXPECT_ALL(RBD_OK, r.m, r.w, 6);
    EXPECT_ALL(RBD_ERR_NULL, NULL, r.w, 0);
    EXPECT_ALL(RBD_ERR_NULL, r.m, NULL, 0);
    EXPECT_ALL(RBD_ERR_WORK, other.m, r.w, 0);
    ck_assert_int_eq(rbd_momentum(NULL, r.w, x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_momentum(r.m, NULL, x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_momentum(other.m, r.w, x, NULL), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_momentum(r.m, r.w, NULL, NULL), RBD_OK);
    for (int i = 0; i < 3; i++) EXPECT_ALL(RBD_ERR_INDEX, r.m, r.w, wrong[i]);
    ck_assert_int_eq(rbd_relative_jacobian(r.m, r.w, 0, NULL, -2, RBD_WORLD_AXES, J), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_relative_jacobian(r.m, r.w, 0, NULL, 7, RBD_WORLD_AXES, J), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_jacobian(r.m, r.w, 0, NULL, RBD_WORLD_AXES, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_relative_jacobian(r.m, r.w, 0, NULL, 1, RBD_WORLD_AXES, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_jacobian_transpose(r.m, r.w, 0, NULL, RBD_WORLD_AXES, NULL, J), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_jacobian_transpose(r.m, r.w, 0, NULL, RBD_WORLD_AXES, x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_point_position(r.m, r.w, 0, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_point_velocity(r.m, r.w, 0, NULL, RBD_WORLD_AXES, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_point_acceleration(r.m, r.w, 0, NULL, RBD_WORLD_AXES, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_point_wrench(r.m, r.w, 0, NULL, RBD_WORLD_AXES, NULL, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_point_wrench(r.m, r.w, 0, NULL, RBD_WORLD_AXES, x, NULL), RBD_ERR_NULL);
    robot_free(&r);
    robot_free(&other);
}
END_TEST

Suite *points_suite(void) {
    Suite *suite = suite_create("points");
    TCase *c = tcase_create("points");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, jacobians_match_the_reference);
    tcase_add_test(c, points_match_the_reference);
    tcase_add_test(c, momentum_matches_the_reference);
    tcase_add_test(c, columns_are_the_motion_of_one_dof);
    tcase_add_test(c, jacobians_are_derivatives_of_the_pose);
    tcase_add_test(c, motion_is_the_jacobian_s);
    tcase_add_test(c, wrenches_work_on_the_columns);
    tcase_add_test(c, relative_jacobian_is_the_motion_between);
    tcase_add_test(c, common_ancestors_do_not_count);
    tcase_add_test(c, momentum_is_that_of_the_bodies);
    tcase_add_test(c, momentum_does_not_depend_on_the_place);
    tcase_add_test(c, a_far_root_does_not_blur_the_others);
    tcase_add_test(c, rate_of_momentum_is_the_force_on_the_base);
    tcase_add_test(c, what_is_fixed_to_the_world_does_not_move);
    tcase_add_test(c, errors_have_their_names);
    suite_add_tcase(suite, c);
    return suite;
}
