/* test_wrench.c - what joints transmit, against Newton and Euler for each body alone. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

/* y += k (x turned by R, or by its transpose) */
static void add_turned(const tb_real *R, int transposed, tb_real k, const double *x, tb_real *y) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) y[i] += k * R[transposed ? 3 * j + i : 3 * i + j] * x[j];
}

static void add_cross(const tb_real *a, const tb_real *b, tb_real *y) {
    for (int i = 0; i < 3; i++) y[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* A wrench in link axes at the link's origin, times k, added to one in world axes about the point `about`. */
static void add_wrench(const tb_motion *t, int body, tb_real k, const double *wrench, const tb_real *about,
                       tb_real *sum) {
    tb_real f[3] = {0, 0, 0}, arm[3];
    add_turned(t->R[body], 0, k, wrench + 3, f);
    add_turned(t->R[body], 0, k, wrench, sum);
    for (int i = 0; i < 3; i++) {
        arm[i] = t->p[body][i] - about[i];
        sum[3 + i] += f[i];
    }
    add_cross(arm, f, sum);
}

/* The rate of a body's momentum about its centre of mass c (world axes), less its weight. */
static void own_rate(const rbd_body *b, const tb_motion *t, int body, const double gravity[3], tb_real c[3],
                     tb_real rate[6]) {
    static const int entry[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const tb_real *omega = t->velocity[body], *turn = t->classical[body], *acc = turn + 3;
    tb_real com[3], local[6] = {0}, L[3] = {0}, rest[3] = {0}, twice[3] = {0};
    for (int i = 0; i < 3; i++) com[i] = b->com[i];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            L[i] += b->inertia[entry[3 * i + j]] * omega[j];
            local[i] += b->inertia[entry[3 * i + j]] * turn[j];
        }
    add_cross(omega, L, local);
    add_cross(omega, com, rest);
    add_cross(omega, rest, twice);
    add_cross(turn, com, twice);
    for (int i = 0; i < 3; i++) local[3 + i] = b->mass * (acc[i] + twice[i]);
    for (int i = 0; i < 3; i++) {
        c[i] = t->p[body][i];
        rate[i] = 0;
        rate[3 + i] = -b->mass * (tb_real)gravity[i];
        for (int j = 0; j < 3; j++) {
            c[i] += t->R[body][3 * i + j] * com[j];
            rate[i] += t->R[body][3 * i + j] * local[j];
            rate[3 + i] += t->R[body][3 * i + j] * local[3 + j];
        }
    }
}

static double size_of(const double *wrench, int n) { return fmax(1, largest(wrench, n)); }

static void check_bodies(const robot *r, const state *s, int number) {
    static tb_motion t;
    static double wrench[6 * MAX_BODIES];
    tb_real tau[TB_MAX_DOFS];
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, s->a, s->f_ext, tau, &t);
    RUN(rbd_joint_wrench(r->m, r->w, s->q, s->v, s->a, s->f_ext, wrench));
    for (int b = 0; b < r->nb; b++) {
        tb_real c[3], rate[6], sum[6] = {0};
        own_rate(&r->bodies[b], &t, b, s->gravity, c, rate);
        add_wrench(&t, b, 1, wrench + 6 * b, c, sum);
        add_wrench(&t, b, 1, s->f_ext + 6 * b, c, sum);
        for (int k = b + 1; k < r->nb; k++)
            if (r->bodies[k].parent == b) add_wrench(&t, k, -1, wrench + 6 * k, c, sum);
        for (int i = 0; i < 6; i++)
            expect_small("joint wrench: Newton and Euler", r, number,
                         (double)fabsl(sum[i] - rate[i]) / size_of(wrench, 6 * r->nb), 1e-12);
    }
}

START_TEST(every_body_obeys_newton_and_euler) {
    for_random_trees(150, check_bodies);
    for_random_states(3, check_bodies);
}
END_TEST

/* Along the axis it is the torque, but for what turns the rotor. Mimic joints' torque is not their own. */
static void check_axes(const robot *r, const state *s, int number) {
    static double wrench[6 * MAX_BODIES];
    double tau[MAX_V];
    for (int b = 0; b < r->nb; b++)
        if (r->bodies[b].mimic) return;
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, tau));
    RUN(rbd_joint_wrench(r->m, r->w, s->q, s->v, s->a, s->f_ext, wrench));
    for (int b = 0; b < r->nb; b++) {
        const rbd_body *body = &r->bodies[b];
        const double *F = wrench + 6 * b, length = sqrt(dot(body->axis, body->axis, 3));
        const double moment = dot(F, body->axis, 3) / length, force = dot(F + 3, body->axis, 3) / length;
        rbd_joint_info info;
        double along[6];
        int n = 1;
        RUN(rbd_joint(r->m, b, &info));
        switch (body->type) {
        case RBD_REVOLUTE:
        case RBD_CONTINUOUS:
        case RBD_CONTINUOUS_CS: along[0] = moment; break;
        case RBD_PRISMATIC: along[0] = force; break;
        case RBD_HELICAL: along[0] = moment + body->pitch * force; break;
        case RBD_CYLINDRICAL: along[0] = moment, along[1] = force, n = 2; break;
        case RBD_SPHERICAL: memcpy(along, F, 3 * sizeof *F), n = 3; break;
        case RBD_FLOATING: memcpy(along, F, 6 * sizeof *F), n = 6; break;
        default: n = 0; break;
        }
        for (int k = 0; k < n; k++)
            expect_small("joint wrench: torque", r, number,
                         fabs(along[k] + body->armature[k] * s->a[info.iv + k] - tau[info.iv + k]) /
                             size_of(wrench, 6 * r->nb),
                         1e-12);
    }
}

START_TEST(along_the_axis_it_is_the_torque) {
    for_random_trees(150, check_axes);
    for_random_states(3, check_axes);
}
END_TEST

/* The sum over the roots is what the world takes, with the other sign. */
static void check_roots(const robot *r, const ref_model *model, const ref_state *s, int number) {
    static double wrench[6 * MAX_BODIES];
    double sum[6] = {0};
    RUN(rbd_joint_wrench(r->m, r->w, s->q, s->v, s->vdot, NULL, wrench));
    for (int b = 0; b < r->nb; b++) {
        const double *F = wrench + 6 * b;
        double R[9], p[3], f[3];
        if (model->bodies[b].parent >= 0) continue;
        RUN(rbd_body_pose(r->m, r->w, b, R, p));
        multiply(R, F + 3, 3, 3, f);
        for (int i = 0; i < 3; i++) {
            sum[i] -=
                dot(R + 3 * i, F, 3) + p[(i + 1) % 3] * f[(i + 2) % 3] - p[(i + 2) % 3] * f[(i + 1) % 3];
            sum[3 + i] -= f[i];
        }
    }
    expect_close("joint wrench: the world's", r, number, sum, s->world_wrench, 6, 1e-12);
}

START_TEST(roots_carry_all) { for_reference_states(check_roots); }
END_TEST

/* Fixed joints in a row and side by side, far from the world's origin: a sensor under a hand. */
START_TEST(fixed_joints_transmit_too) {
    const rbd_body arm[5] = {
        {.parent = -1, .name = "plinth", .type = RBD_FIXED, .position = {1e6, 0, 0}, .mass = 5},
        {.parent = 0, .name = "link", .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 2},
        {.parent = 1, .name = "sensor", .type = RBD_FIXED, .position = {0, 0, 1}, .mass = 0.5},
        {.parent = 2, .name = "hand", .type = RBD_FIXED, .position = {0.1, 0, 0.1}, .mass = 1},
        {.parent = 3, .name = "finger", .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 0.25}};
    const double q[2] = {0, 0.2}, g = 9.81;
    const double expected[30] = {0, -g * (1 * 0.1 + 0.25 * 0.3),
                                 0, 0,
                                 0, g * 8.75, /* plinth */
                                 0, -g * (1 * 0.1 + 0.25 * 0.3),
                                 0, 0,
                                 0, g * 3.75, /* link */
                                 0, -g * (1 * 0.1 + 0.25 * 0.3),
                                 0, 0,
                                 0, g * 1.75, /* sensor */
                                 0, -g * 0.25 * 0.2,
                                 0, 0,
                                 0, g * 1.25, /* hand */
                                 0, 0,
                                 0, 0,
                                 0, g * 0.25};
    double wrench[30];
    robot r = BUILD(arm);
    ck_assert_int_eq(rbd_joint_wrench(r.m, r.w, q, NULL, NULL, NULL, wrench), RBD_OK);
    expect_close("fixed joints", &r, 0, wrench + 6, expected + 6, 24, 1e-15);
    expect_close("plinth", &r, 0, wrench, expected, 6, 1e-10); /* its arm is a difference of 1e6 m */
    robot_free(&r);
}
END_TEST

START_TEST(errors_have_their_names) {
    robot r = robot_build("atlas", reference_model(0)->bodies, reference_model(0)->nb),
          other = robot_build("other", reference_model(3)->bodies, reference_model(3)->nb);
    const double x[MAX_Q] = {0};
    double wrench[6 * MAX_BODIES];
    ck_assert_int_eq(rbd_joint_wrench(NULL, r.w, x, x, x, NULL, wrench), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_joint_wrench(r.m, NULL, x, x, x, NULL, wrench), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_joint_wrench(r.m, r.w, NULL, x, x, NULL, wrench), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_joint_wrench(r.m, r.w, x, x, x, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_joint_wrench(r.m, other.w, x, x, x, NULL, wrench), RBD_ERR_WORK);
    robot_free(&r);
    robot_free(&other);
}
END_TEST

Suite *wrench_suite(void) {
    Suite *suite = suite_create("wrench");
    TCase *c = tcase_create("wrench");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, every_body_obeys_newton_and_euler);
    tcase_add_test(c, along_the_axis_it_is_the_torque);
    tcase_add_test(c, roots_carry_all);
    tcase_add_test(c, fixed_joints_transmit_too);
    tcase_add_test(c, errors_have_their_names);
    suite_add_tcase(suite, c);
    return suite;
}
