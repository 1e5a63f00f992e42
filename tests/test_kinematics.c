/* test_kinematics.c - [kinematics]: poses, velocities, accelerations, energy, centre of mass. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

/* All that rbd_kinematics knows of the bodies, in arrays like the reference's. */
typedef struct bodies {
    double R[9 * MAX_BODIES], p[3 * MAX_BODIES];
    double velocity[6 * MAX_BODIES], acceleration[6 * MAX_BODIES], classical[6 * MAX_BODIES];
} bodies;

static void read_bodies(const robot *r, int number, bodies *b) {
    for (int i = 0; i < r->nb; i++) {
        RUN(rbd_body_pose(r->m, r->w, i, b->R + 9 * i, b->p + 3 * i));
        RUN(rbd_body_velocity(r->m, r->w, i, b->velocity + 6 * i));
        RUN(rbd_body_acceleration(r->m, r->w, i, b->acceleration + 6 * i));
        RUN(rbd_body_acceleration_classical(r->m, r->w, i, b->classical + 6 * i));
    }
}

static void check_reference(const robot *r, const ref_model *model, const ref_state *s, int number) {
    const int nb = model->nb;
    bodies b;
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->vdot));
    read_bodies(r, number, &b);
    expect_close("pose: R", r, number, b.R, s->body_R, 9 * nb, 1e-14);
    expect_close("pose: p", r, number, b.p, s->body_p, 3 * nb, 1e-14);
    expect_close("velocity", r, number, b.velocity, s->body_vel, 6 * nb, 1e-14);
    expect_close("acceleration", r, number, b.acceleration, s->body_acc, 6 * nb, 1e-14);
    for (int i = 0; i < nb; i++) {
        expect_close("classical: angular", r, number, b.classical + 6 * i, s->body_acc + 6 * i, 3, 1e-12);
        expect_close("classical: linear", r, number, b.classical + 6 * i + 3, s->body_acc_classical + 3 * i,
                     3, 1e-12);
    }
}

START_TEST(motion_of_bodies_matches_the_reference) { for_reference_states(check_reference); }
END_TEST

static void check_reference_totals(const robot *r, const ref_model *model, const ref_state *s, int number) {
    double kinetic, potential, com[3], velocity[3], acceleration[3];
    const double mass = rbd_mass(r->m);
    (void)model;
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->vdot));
    RUN(rbd_energy(r->m, r->w, &kinetic, &potential));
    RUN(rbd_com(r->m, r->w, com, velocity, acceleration));
    expect_close("kinetic energy", r, number, &kinetic, &s->kinetic, 1, 1e-14);
    expect_close("potential energy", r, number, &potential, &s->potential, 1, 1e-13);
    expect_close("mass", r, number, &mass, &s->mass, 1, 1e-14);
    expect_close("com", r, number, com, s->com, 3, 1e-14);
    expect_close("com velocity", r, number, velocity, s->com_vel, 3, 3e-14);
    expect_close("com acceleration", r, number, acceleration, s->com_acc, 3, 1e-14);
}

START_TEST(energy_and_com_match_the_reference) { for_reference_states(check_reference_totals); }
END_TEST

static void check_textbook(const robot *r, const state *s, int number) {
    tb_real tau[TB_MAX_DOFS];
    tb_motion m;
    bodies b;
    double kinetic, potential, com[3], velocity[3], acceleration[3];
    const double mass = rbd_mass(r->m);
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, s->a, NULL, tau, &m);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    read_bodies(r, number, &b);
    expect_close_tb("pose: R, textbook", r, number, b.R, m.R[0], 9 * r->nb, 1e-13);
    expect_close_tb("pose: p, textbook", r, number, b.p, m.p[0], 3 * r->nb, 1e-13);
    expect_close_tb("velocity, textbook", r, number, b.velocity, m.velocity[0], 6 * r->nb, 1e-13);
    expect_close_tb("acceleration, textbook", r, number, b.acceleration, m.acceleration[0], 6 * r->nb, 1e-13);
    expect_close_tb("classical, textbook", r, number, b.classical, m.classical[0], 6 * r->nb, 1e-13);
    RUN(rbd_energy(r->m, r->w, &kinetic, &potential));
    RUN(rbd_com(r->m, r->w, com, velocity, acceleration));
    expect_close_tb("kinetic energy, textbook", r, number, &kinetic, &m.kinetic, 1, 1e-12);
    const tb_real scale = m.mass > 0 ? m.mass * 10 : 1; /* of a potential that may cancel */
    expect_small("potential energy, textbook", r, number,
                 fabs((double)((potential - m.potential) / (scale + fabsl(m.potential)))), 1e-13);
    expect_close_tb("mass, textbook", r, number, &mass, &m.mass, 1, 1e-14);
    expect_close_tb("com, textbook", r, number, com, m.com, 3, 1e-12);
    expect_close_tb("com velocity, textbook", r, number, velocity, m.com_velocity, 3, 1e-12);
    expect_close_tb("com acceleration, textbook", r, number, acceleration, m.com_acceleration, 3, 1e-12);
}

START_TEST(motion_matches_the_textbook_on_random_trees) { for_random_trees(300, check_textbook); }
END_TEST

/* The configuration that the motion (v, a) reaches after t, up to third order in t. */
static void advance(const robot *r, const state *s, int number, double t, double *q, double *v) {
    double step[MAX_V];
    for (int k = 0; k < r->nv; k++) {
        v[k] = s->v[k] + t * s->a[k];
        step[k] = s->v[k] + t / 2 * s->a[k];
    }
    RUN(rbd_integrate(r->m, s->q, step, t, q));
}

/* Central difference of body quantities with step h, extrapolated from h and h / 2 (Richardson). */
static void differentiate(const robot *r, const state *s, int number, double *R, double *p,
                          double *velocity) {
    enum { COUNT = 18 * MAX_BODIES };
    double rate[2][COUNT];
    const int nb = r->nb;
    for (int half = 0; half < 2; half++) {
        const double h = half ? 5e-4 : 1e-3;
        bodies b[2];
        for (int side = 0; side < 2; side++) {
            double q[MAX_Q], v[MAX_V];
            advance(r, s, number, side ? h : -h, q, v);
            RUN(rbd_kinematics(r->m, r->w, q, v, NULL));
            read_bodies(r, number, &b[side]);
        }
        for (int i = 0; i < 9 * nb; i++) rate[half][i] = (b[1].R[i] - b[0].R[i]) / (2 * h);
        for (int i = 0; i < 3 * nb; i++) rate[half][9 * nb + i] = (b[1].p[i] - b[0].p[i]) / (2 * h);
        for (int i = 0; i < 6 * nb; i++)
            rate[half][12 * nb + i] = (b[1].velocity[i] - b[0].velocity[i]) / (2 * h);
    }
    for (int i = 0; i < 18 * nb; i++) rate[1][i] += (rate[1][i] - rate[0][i]) / 3;
    memcpy(R, rate[1], 9 * (size_t)nb * sizeof *R);
    memcpy(p, rate[1] + 9 * nb, 3 * (size_t)nb * sizeof *p);
    memcpy(velocity, rate[1] + 12 * nb, 6 * (size_t)nb * sizeof *velocity);
}

/* dR/dt = R [omega]x, dp/dt = R v, d(velocity)/dt = acceleration component by component. */
static void check_derivatives(const robot *r, const state *s, int number) {
    double R[9 * MAX_BODIES], p[3 * MAX_BODIES], velocity[6 * MAX_BODIES];
    double R_rate[9 * MAX_BODIES], p_rate[3 * MAX_BODIES];
    bodies b;
    differentiate(r, s, number, R, p, velocity);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    read_bodies(r, number, &b);
    for (int i = 0; i < r->nb; i++) {
        const double *w = b.velocity + 6 * i;
        const double W[9] = {0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0};
        for (int j = 0; j < 3; j++) {
            const double *row = b.R + 9 * i + 3 * j;
            for (int k = 0; k < 3; k++)
                R_rate[9 * i + 3 * j + k] = row[0] * W[k] + row[1] * W[3 + k] + row[2] * W[6 + k];
            p_rate[3 * i + j] = dot(row, w + 3, 3);
        }
    }
    expect_close("dR/dt by difference", r, number, R, R_rate, 9 * r->nb, 1e-7);
    expect_close("dp/dt by difference", r, number, p, p_rate, 3 * r->nb, 1e-7);
    expect_close("d velocity/dt by difference", r, number, velocity, b.acceleration, 6 * r->nb, 1e-7);
}

START_TEST(velocities_and_accelerations_are_time_derivatives) { for_random_states(4, check_derivatives); }
END_TEST

/* classical = spatial + (0; omega x v) */
static void check_classical(const robot *r, const state *s, int number) {
    bodies b;
    double expected[6 * MAX_BODIES];
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    read_bodies(r, number, &b);
    for (int i = 0; i < r->nb; i++) {
        const double *w = b.velocity + 6 * i, *v = w + 3;
        double *e = expected + 6 * i;
        memcpy(e, b.acceleration + 6 * i, 6 * sizeof *e);
        e[3] += w[1] * v[2] - w[2] * v[1];
        e[4] += w[2] * v[0] - w[0] * v[2];
        e[5] += w[0] * v[1] - w[1] * v[0];
    }
    expect_close("classical = spatial + w x v", r, number, b.classical, expected, 6 * r->nb, 1e-13);
}

START_TEST(classical_acceleration_is_the_origin_s) { for_random_states(5, check_classical); }
END_TEST

static void compare_kinetic(const robot *r, const state *s, int number, double bound) {
    double M[MAX_V * MAX_V], momentum[MAX_V], kinetic;
    RUN(rbd_crba(r->m, r->w, s->q, M));
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_energy(r->m, r->w, &kinetic, NULL));
    multiply(M, s->v, r->nv, r->nv, momentum);
    const double expected = dot(s->v, momentum, r->nv) / 2;
    expect_close("kinetic = v' M v / 2", r, number, &kinetic, &expected, 1, bound);
}

static void check_kinetic(const robot *r, const state *s, int number) {
    compare_kinetic(r, s, number, 1e-13);
}

START_TEST(kinetic_energy_is_that_of_the_mass_matrix) {
    for_random_states(5, check_kinetic);
    for_random_trees(50, check_kinetic);
}
END_TEST

/* ---- rotations as files have them ---- */

static double from_orthonormal(const double R[9]) {
    double error = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) error = larger(error, fabs(dot(R + 3 * i, R + 3 * j, 3) - (i == j)));
    return error;
}

enum { ROUNDED_NB = 5 };

/* A body on a joint of each kind, three of them on the world; body i has rotation i % count. */
static void rounded_bodies(uint64_t *seed, double rotations[][9], int count, rbd_body b[ROUNDED_NB]) {
    const rbd_joint_type types[ROUNDED_NB] = {RBD_FLOATING, RBD_SPHERICAL, RBD_FIXED, RBD_FIXED,
                                              RBD_REVOLUTE};
    const int parents[ROUNDED_NB] = {-1, -1, -1, 0, 1};
    for (int i = 0; i < ROUNDED_NB; i++) {
        random_joint(seed, b, i, types[i]);
        random_mass(seed, &b[i]);
        b[i].parent = parents[i];
        memcpy(b[i].rotation, rotations[i % count], sizeof b[i].rotation);
    }
}

/* All poses are rotations, and kinematics and dynamics have the same ones. */
static void check_rounded(const char *name, const rbd_body *b, uint64_t *seed) {
    robot r = robot_build(name, b, ROUNDED_NB);
    double q[MAX_Q], R[9];
    state s;
    ck_assert_int_eq(rbd_neutral(r.m, q), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    for (int i = 0; i < ROUNDED_NB; i++) {
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, i, R, NULL), RBD_OK);
        const double factors = b[i].parent < 0 ? 1 : 2;
        expect_small("R R' = 1 for a rounded rotation", &r, i, from_orthonormal(R), factors * 1e-15);
    }
    for (int i = 0; i < 5; i++) {
        draw_state(&r, seed, &s);
        compare_kinetic(&r, &s, i, 1e-14);
    }
    robot_free(&r);
}

START_TEST(rounded_rotations_become_exact) {
    const double h = 0.707107; /* six digits of the root of one half */
    double eighths[3][9] = {
        {h, -h, 0, h, h, 0, 0, 0, 1}, {1, 0, 0, 0, h, h, 0, -h, h}, {-h, 0, h, 0, -1, 0, h, 0, h}};
    double turned[ROUNDED_NB][9];
    rbd_body b[ROUNDED_NB];
    uint64_t seed = 77;
    for (int i = 0; i < 100; i++) {
        rounded_bodies(&seed, eighths, 3, b);
        check_rounded("six digits of 45 degrees", b, &seed);
        for (int k = 0; k < ROUNDED_NB; k++) {
            random_rotation(&seed, turned[k]);
            for (int j = 0; j < 9; j++) turned[k][j] = floor(turned[k][j] * 1e7 + 0.5) / 1e7;
        }
        rounded_bodies(&seed, turned, ROUNDED_NB, b);
        check_rounded("seven decimals", b, &seed);
    }
}
END_TEST

/* A turn of the axes onto each other, by quarters, has no digit to lose. */
START_TEST(exact_rotations_stay_as_they_are) {
    int rotations = 0;
    for (int code = 0; code < 48; code++) {
        const int x = code % 3, y = (x + 1 + code / 3 % 2) % 3, z = 3 - x - y, sign = code / 6;
        rbd_body b[1] = {{.parent = -1, .type = RBD_FIXED}};
        b->rotation[x] = sign & 1 ? -1 : 1;
        b->rotation[3 + y] = sign & 2 ? -1 : 1;
        b->rotation[6 + z] = sign & 4 ? -1 : 1;
        const int even = y == (x + 1) % 3;
        if ((b->rotation[x] * b->rotation[3 + y] * b->rotation[6 + z] > 0) != even) continue; /* a mirror */
        robot r = BUILD(b);
        const double none[1] = {0};
        double R[9];
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, none, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, R, NULL), RBD_OK);
        for (int k = 0; k < 9; k++) ck_assert_double_eq(R[k], b->rotation[k]);
        robot_free(&r);
        rotations++;
    }
    ck_assert_int_eq(rotations, 24);
}
END_TEST

/* Nor have the right angles between the joints of HyQ. */
START_TEST(right_angles_between_joints_are_exact) {
    const ref_model *hyq = NULL;
    double q[MAX_Q], R[9];
    for (int i = 0; i < reference_count; i++)
        if (!strcmp(reference_model(i)->name, "hyq")) hyq = reference_model(i);
    ck_assert_ptr_nonnull(hyq);
    robot r = robot_build(hyq->name, hyq->bodies, hyq->nb);
    ck_assert_int_eq(rbd_neutral(r.m, q), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    for (int i = 0; i < r.nb; i++) {
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, i, R, NULL), RBD_OK);
        for (int k = 0; k < 9; k++)
            ck_assert_msg(R[k] == 0 || R[k] == 1 || R[k] == -1, "body %d, entry %d: %.17g", i, k, R[k]);
    }
    robot_free(&r);
}
END_TEST

static void same(const char *what, const double *found, const double *expected, int n) {
    ck_assert_msg(!(relative_error(found, expected, n) > 0), "%s", what);
}

static void check_null(const robot *r, const state *s, int number) {
    const double zero[MAX_V] = {0};
    bodies given, missing;
    memset(&given, 0, sizeof given);
    memset(&missing, 0, sizeof missing);
    RUN(rbd_kinematics(r->m, r->w, s->q, zero, zero));
    read_bodies(r, number, &given);
    RUN(rbd_kinematics(r->m, r->w, s->q, NULL, NULL));
    read_bodies(r, number, &missing);
    same("velocity for v NULL", missing.velocity, given.velocity, 6 * r->nb);
    same("acceleration for a NULL", missing.acceleration, given.acceleration, 6 * r->nb);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, zero));
    read_bodies(r, number, &given);
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    read_bodies(r, number, &missing);
    same("acceleration for a NULL alone", missing.acceleration, given.acceleration, 6 * r->nb);
}

START_TEST(missing_rates_are_zero) { for_random_states(2, check_null); }
END_TEST

/* The results stay until the next rbd_kinematics, whatever runs between. */
static void check_kept(const robot *r, const state *s, int number) {
    bodies before, after;
    double out[MAX_V], energy[4], com[2][9], M[MAX_V * MAX_V];
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    read_bodies(r, number, &before);
    RUN(rbd_energy(r->m, r->w, &energy[0], &energy[1]));
    RUN(rbd_com(r->m, r->w, com[0], com[0] + 3, com[0] + 6));
    RUN(rbd_rnea(r->m, r->w, s->q, s->a, s->v, s->f_ext, out));
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, NULL, out));
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, NULL, out));
    RUN(rbd_crba(r->m, r->w, s->q, M));
    read_bodies(r, number, &after);
    RUN(rbd_energy(r->m, r->w, &energy[2], &energy[3]));
    RUN(rbd_com(r->m, r->w, com[1], com[1] + 3, com[1] + 6));
    same("R is kept", after.R, before.R, 9 * r->nb);
    same("p is kept", after.p, before.p, 3 * r->nb);
    same("velocity is kept", after.velocity, before.velocity, 6 * r->nb);
    same("acceleration is kept", after.acceleration, before.acceleration, 6 * r->nb);
    same("classical is kept", after.classical, before.classical, 6 * r->nb);
    same("energy is kept", energy + 2, energy, 2);
    same("com is kept", com[1], com[0], 9);
}

START_TEST(results_stay_until_the_next_kinematics) { for_random_states(2, check_kept); }
END_TEST

static robot iiwa(void) { return robot_build("iiwa", reference_model(2)->bodies, reference_model(2)->nb); }

START_TEST(reading_before_kinematics_is_refused) {
    robot r = iiwa();
    const double q[MAX_Q] = {0};
    double x[9];
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, x, NULL), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_body_velocity(r.m, r.w, 0, x), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_body_acceleration(r.m, r.w, 0, x), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_body_acceleration_classical(r.m, r.w, 0, x), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_energy(r.m, r.w, x, x), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_com(r.m, r.w, x, x, x), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, x, NULL), RBD_OK);
    robot_free(&r);
}
END_TEST

/* Whether body i is `last` or one of those between it and the world. */
static int on_path(const robot *r, int i, int last) {
    while (last > i) last = r->bodies[last].parent;
    return last == i;
}

/* The kinematics of one body are those of all, for it and its ancestors; bodies that other joints move are
   refused. */
static int refused, checked;
static void check_path(const robot *r, const state *s, int number) {
    const double *v = checked % 3 == 0 ? NULL : s->v, *a = checked % 2 == 0 ? NULL : s->a;
    double J[2][6 * MAX_V], p[3], h[6], out[MAX_V + 12], other[MAX_Q];
    bodies all;
    checked++;
    rbd_neutral(r->m, other);
    for (int last = 0; last < r->nb; last++) {
        RUN(rbd_kinematics(r->m, r->w, s->q, v, a));
        read_bodies(r, number, &all);
        RUN(rbd_jacobian(r->m, r->w, last, NULL, RBD_LINK_AXES, J[0]));
        RUN(rbd_kinematics(r->m, r->w, other, s->a, s->v));               /* of another state */
        if (last % 2) RUN(rbd_kinematics(r->m, r->w, other, NULL, NULL)); /* which rests */
        RUN(rbd_body_kinematics(r->m, r->w, last, s->q, v, a));
        RUN(rbd_jacobian(r->m, r->w, last, NULL, RBD_LINK_AXES, J[1]));
        same("Jacobian of one body", J[1], J[0], 6 * r->nv);
        for (int i = 0; i < r->nb; i++) {
            const rbd_status status = rbd_body_pose(r->m, r->w, i, out, out + 9);
            if (on_path(r, i, last)) ck_assert_int_eq(status, RBD_OK);
            if (status) {
                refused++;
                ck_assert_int_eq(status, RBD_ERR_ORDER);
                ck_assert_int_eq(rbd_point_position(r->m, r->w, i, NULL, p), RBD_ERR_ORDER);
                ck_assert_int_eq(rbd_relative_jacobian(r->m, r->w, last, NULL, i, RBD_WORLD_AXES, J[1]),
                                 RBD_ERR_ORDER);
                continue;
            }
            same("R of one body", out, all.R + 9 * i, 9);
            same("p of one body", out + 9, all.p + 3 * i, 3);
            RUN(rbd_body_velocity(r->m, r->w, i, h));
            same("velocity of one body", h, all.velocity + 6 * i, 6);
            RUN(rbd_body_acceleration(r->m, r->w, i, h));
            same("acceleration of one body", h, all.acceleration + 6 * i, 6);
        }
        ck_assert_int_eq(rbd_momentum(r->m, r->w, h, NULL), RBD_ERR_ORDER);
        ck_assert_int_eq(rbd_com(r->m, r->w, p, NULL, NULL), RBD_ERR_ORDER);
        ck_assert_int_eq(rbd_energy(r->m, r->w, p, NULL), RBD_ERR_ORDER);
    }
}

START_TEST(kinematics_of_one_body_are_those_of_all) {
    refused = checked = 0;
    for_random_trees(100, check_path);
    ck_assert_int_gt(refused, OF_TREES(1000));
}
END_TEST

/* Also of one that is fixed to the world. */
START_TEST(kinematics_of_a_body_on_the_world) {
    static const rbd_body bodies[] = {
        {.parent = -1,
         .position = {0.1, 0.2, 0.3},
         .mass = 2,
         .com = {0, 0.1, 0},
         .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, -1}}};
    robot r = BUILD(bodies);
    uint64_t seed = 3;
    state s;
    draw_state(&r, &seed, &s);
    check_path(&r, &s, 0);
    robot_free(&r);
}
END_TEST

START_TEST(kinematics_of_one_body_refuse_bad_arguments) {
    robot r = iiwa();
    const double q[MAX_Q] = {0};
    double x[9];
    ck_assert_int_eq(rbd_body_kinematics(r.m, r.w, -1, q, NULL, NULL), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_body_kinematics(r.m, r.w, 7, q, NULL, NULL), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_body_kinematics(r.m, r.w, 0, NULL, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_kinematics(NULL, r.w, 0, q, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, x, NULL), RBD_ERR_ORDER);
    robot_free(&r);
}
END_TEST

START_TEST(bodies_out_of_range_are_refused) {
    const int wrong[3] = {-1, 7, 1000000};
    robot r = iiwa();
    const double q[MAX_Q] = {0};
    double x[9];
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, wrong[i], x, NULL), RBD_ERR_INDEX);
        ck_assert_int_eq(rbd_body_velocity(r.m, r.w, wrong[i], x), RBD_ERR_INDEX);
        ck_assert_int_eq(rbd_body_acceleration(r.m, r.w, wrong[i], x), RBD_ERR_INDEX);
        ck_assert_int_eq(rbd_body_acceleration_classical(r.m, r.w, wrong[i], x), RBD_ERR_INDEX);
    }
    robot_free(&r);
}
END_TEST

START_TEST(null_arguments_are_refused) {
    robot r = iiwa();
    const double q[MAX_Q] = {0};
    double x[9], p[3];
    ck_assert_int_eq(rbd_kinematics(NULL, r.w, q, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_kinematics(r.m, NULL, q, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, NULL, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(NULL, r.w, 0, x, p), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_pose(r.m, NULL, 0, x, p), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_velocity(NULL, r.w, 0, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_velocity(r.m, NULL, 0, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_velocity(r.m, r.w, 0, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_acceleration(NULL, r.w, 0, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_acceleration(r.m, NULL, 0, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_acceleration(r.m, r.w, 0, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_acceleration_classical(NULL, r.w, 0, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_acceleration_classical(r.m, NULL, 0, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_body_acceleration_classical(r.m, r.w, 0, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_energy(NULL, r.w, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_energy(r.m, NULL, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_com(NULL, r.w, x, x, x), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_com(r.m, NULL, x, x, x), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

START_TEST(outputs_may_be_left_out) {
    robot r = iiwa();
    const double q[MAX_Q] = {0.3, -0.4, 0.5, 0.6, 0.7, -0.8, 0.9};
    double R[9], p[3], only[9], kinetic, potential, com[9];
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, q, q), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 6, R, p), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 6, only, NULL), RBD_OK);
    same("R alone", only, R, 9);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 6, NULL, only), RBD_OK);
    same("p alone", only, p, 3);
    ck_assert_int_eq(rbd_energy(r.m, r.w, &kinetic, &potential), RBD_OK);
    ck_assert_int_eq(rbd_energy(r.m, r.w, only, NULL), RBD_OK);
    same("kinetic alone", only, &kinetic, 1);
    ck_assert_int_eq(rbd_energy(r.m, r.w, NULL, only), RBD_OK);
    same("potential alone", only, &potential, 1);
    ck_assert_int_eq(rbd_com(r.m, r.w, com, com + 3, com + 6), RBD_OK);
    ck_assert_int_eq(rbd_com(r.m, r.w, NULL, only, NULL), RBD_OK);
    same("com velocity alone", only, com + 3, 3);
    ck_assert_int_eq(rbd_com(r.m, r.w, NULL, NULL, only), RBD_OK);
    same("com acceleration alone", only, com + 6, 3);
    robot_free(&r);
}
END_TEST

/* Nothing moves or has mass: everything is zero, nothing is divided by it. */
START_TEST(massless_model_has_its_com_at_zero) {
    const rbd_body rows[2] = {{.parent = -1, .type = RBD_FIXED, .mass = 2},
                              {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}}};
    robot r = BUILD(rows);
    const double q[1] = {1}, zero[3] = {0};
    double com[3], velocity[3], acceleration[3];
    ck_assert(!(rbd_mass(r.m) > 0));
    ck_assert(!(rbd_mass(NULL) > 0));
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, NULL, com), RBD_ERR_ORDER); /* fixed to the world, too */
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, q, q), RBD_OK);
    ck_assert_int_eq(rbd_com(r.m, r.w, com, velocity, acceleration), RBD_OK);
    same("com", com, zero, 3);
    same("com velocity", velocity, zero, 3);
    same("com acceleration", acceleration, zero, 3);
    robot_free(&r);
}
END_TEST

Suite *kinematics_suite(void) {
    Suite *suite = suite_create("kinematics");
    TCase *c = tcase_create("kinematics");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, motion_of_bodies_matches_the_reference);
    tcase_add_test(c, energy_and_com_match_the_reference);
    tcase_add_test(c, motion_matches_the_textbook_on_random_trees);
    tcase_add_test(c, velocities_and_accelerations_are_time_derivatives);
    tcase_add_test(c, classical_acceleration_is_the_origin_s);
    tcase_add_test(c, kinetic_energy_is_that_of_the_mass_matrix);
    tcase_add_test(c, rounded_rotations_become_exact);
    tcase_add_test(c, exact_rotations_stay_as_they_are);
    tcase_add_test(c, right_angles_between_joints_are_exact);
    tcase_add_test(c, missing_rates_are_zero);
    tcase_add_test(c, results_stay_until_the_next_kinematics);
    tcase_add_test(c, reading_before_kinematics_is_refused);
    tcase_add_test(c, kinematics_of_one_body_are_those_of_all);
    tcase_add_test(c, kinematics_of_a_body_on_the_world);
    tcase_add_test(c, kinematics_of_one_body_refuse_bad_arguments);
    tcase_add_test(c, bodies_out_of_range_are_refused);
    tcase_add_test(c, null_arguments_are_refused);
    tcase_add_test(c, outputs_may_be_left_out);
    tcase_add_test(c, massless_model_has_its_com_at_zero);
    suite_add_tcase(suite, c);
    return suite;
}
