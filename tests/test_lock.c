/* test_lock.c - joints held still at a pose: rbd_lock_joints. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

static const double pi = 3.14159265358979323846;

/* A robot with some joints held, and the state that is left; the whole robot's state with these at rest. */
typedef struct held {
    robot r;
    rbd_body rows[MAX_BODIES];
    unsigned char locked[MAX_BODIES], given[MAX_V];
    double q[MAX_Q], v[MAX_V], a[MAX_V], tau[MAX_V];
    double whole_v[MAX_V], whole_a[MAX_V];
    int dof[MAX_V]; /* of the whole robot, for each of those that are left */
} held;

/* Flags of a third of the joints, or of all, and the state of the others. */
static void choose(held *h, const robot *r, const state *s, int number, uint64_t *seed) {
    for (int i = 0; i < r->nb; i++)
        h->locked[i] = !r->bodies[i].mimic && (number % 5 == 4 || below(seed, 3) == 0);
    RUN(rbd_lock_joints(r->bodies, r->nb, h->locked, s->q, h->rows, NULL));
    h->r = robot_build(r->name, h->rows, r->nb);
    ck_assert_int_eq(rbd_set_gravity(h->r.w, s->gravity), RBD_OK);
    for (int k = 0; k < r->nv; k++) h->given[k] = 1, h->whole_v[k] = h->whole_a[k] = 0;
    for (int i = 0; i < r->nb; i++) {
        rbd_joint_info whole, left;
        RUN(rbd_joint(r->m, i, &whole));
        RUN(rbd_joint(h->r.m, i, &left));
        for (int k = 0; k < left.nq; k++) h->q[left.iq + k] = s->q[whole.iq + k];
        for (int k = 0; k < left.nv; k++) {
            const int to = left.iv + k, from = whole.iv + k;
            h->dof[to] = from;
            h->given[from] = 0;
            h->v[to] = h->whole_v[from] = s->v[from];
            h->a[to] = h->whole_a[from] = s->a[from];
            h->tau[to] = s->tau[from];
        }
    }
}

/* Motions of all bodies, torques and M are those of the textbook's whole robot; accelerations those of hybrid
   dynamics, where the held joints' are given. */
static void check_tree(const robot *r, const state *s, int number) {
    static tb_motion tb;
    static tb_real whole_M[TB_MAX_DOFS * TB_MAX_DOFS];
    static double M[MAX_V * MAX_V], expected_M[MAX_V * MAX_V];
    uint64_t seed = 7 + 31 * (uint64_t)number + (uint64_t)r->nb;
    tb_real whole_tau[TB_MAX_DOFS];
    double tau[MAX_V], expected[MAX_V], a[MAX_V], whole_a[MAX_V], x[6], R[9], p[3];
    held h;
    choose(&h, r, s, number, &seed);
    const int n = h.r.nv;

    tb_rnea(r->bodies, r->nb, s->gravity, s->q, h.whole_v, h.whole_a, s->f_ext, whole_tau, &tb);
    RUN(rbd_kinematics(h.r.m, h.r.w, h.q, h.v, h.a));
    for (int b = 0; b < r->nb; b++) {
        RUN(rbd_body_pose(h.r.m, h.r.w, b, R, p));
        expect_close_tb("R of a body", r, number, R, tb.R[b], 9, 1e-13);
        expect_close_tb("place of a body", r, number, p, tb.p[b], 3, 1e-12);
        RUN(rbd_body_velocity(h.r.m, h.r.w, b, x));
        expect_close_tb("velocity of a body", r, number, x, tb.velocity[b], 6, 1e-11);
        RUN(rbd_body_acceleration(h.r.m, h.r.w, b, x));
        expect_close_tb("acceleration of a body", r, number, x, tb.acceleration[b], 6, 1e-11);
    }
    if (n == 0) {
        robot_free(&h.r);
        return;
    }
    double size = 1;
    for (int k = 0; k < r->nv; k++) size = larger(size, fabs((double)whole_tau[k]));
    RUN(rbd_rnea(h.r.m, h.r.w, h.q, h.v, h.a, s->f_ext, tau));
    for (int k = 0; k < n; k++)
        expect_small("torque", r, number, fabs(tau[k] - (double)whole_tau[h.dof[k]]) / size, 1e-12);

    tb_mass_matrix(r->bodies, r->nb, s->q, whole_M);
    RUN(rbd_crba(h.r.m, h.r.w, h.q, M));
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) expected_M[n * i + j] = (double)whole_M[h.dof[i] * r->nv + h.dof[j]];
    expect_close("block of M", r, number, M, expected_M, n * n, 1e-12);

    const double condition =
        (double)tb_forward(h.rows, r->nb, s->gravity, h.q, h.v, h.tau, s->f_ext, (tb_real[TB_MAX_DOFS]){0});
    memcpy(whole_a, h.whole_a, sizeof whole_a);
    memcpy(expected, s->tau, sizeof expected);
    if (condition > 0 && condition < 1e9 &&
        rbd_hybrid(r->m, r->w, s->q, h.whole_v, h.given, whole_a, expected, s->f_ext) == RBD_OK) {
        RUN(rbd_aba(h.r.m, h.r.w, h.q, h.v, h.tau, s->f_ext, a));
        for (int k = 0; k < n; k++) expected[k] = whole_a[h.dof[k]];
        expect_close("forward dynamics", r, number, a, expected, n, 10 * inverse_bound(condition));
    }
    robot_free(&h.r);
}

START_TEST(a_held_robot_is_the_whole_one_at_rest_there) {
    for_random_trees(200, check_tree);
    for_random_states(5, check_tree);
}
END_TEST

/* Every joint type by itself, at several places, with quaternions of any length: the pose is that of
   rbd_kinematics. */
START_TEST(every_joint_type_can_be_held) {
    uint64_t seed = 11;
    for (int type = RBD_FIXED; type < RBD_JOINT_TYPES; type++)
        for (int i = 0; i < 20; i++) {
            rbd_body bodies[2], rows[2];
            const unsigned char locked[2] = {1, 0};
            double q[16], R[2][9], p[2][3];
            random_joint(&seed, bodies, 0, (rbd_joint_type)type);
            random_joint(&seed, bodies, 1, RBD_REVOLUTE);
            for (int b = 0; b < 2; b++) random_mass(&seed, &bodies[b]);
            bodies[1].parent = 0;
            robot r = robot_build("one joint", bodies, 2);
            for (int k = 0; k < r.nq; k++) q[k] = uniform(&seed, -4, 4) * (i == 0 ? 0 : i == 1 ? 1e200 : 1);
            if (i == 1 && type != RBD_SPHERICAL && type != RBD_CONTINUOUS_CS) q[0] = q[1] = q[2] = 0.5;
            if (i == 1 && type == RBD_FLOATING) q[2] = 0.25;
            if (i == 1) q[r.nq - 1] = 0.5;
            ck_assert_int_eq(rbd_lock_joints(bodies, 2, locked, q, rows, NULL), RBD_OK);
            ck_assert_int_eq(rows[0].type, RBD_FIXED);
            ck_assert(memcmp(&rows[1], &bodies[1], sizeof rows[1]) == 0);
            robot h = robot_build("held", rows, 2);
            ck_assert_int_eq(h.nv, 1);
            ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
            ck_assert_int_eq(rbd_kinematics(h.m, h.w, &q[r.nq - 1], NULL, NULL), RBD_OK);
            ck_assert_int_eq(rbd_body_pose(r.m, r.w, 1, R[0], p[0]), RBD_OK);
            ck_assert_int_eq(rbd_body_pose(h.m, h.w, 1, R[1], p[1]), RBD_OK);
            expect_close("R", &r, 100 * type + i, R[1], R[0], 9, 1e-14);
            expect_close("p", &r, 100 * type + i, p[1], p[0], 3, 1e-14);
            robot_free(&r);
            robot_free(&h);
        }
}
END_TEST

/* A rod about z, held at an angle. */
static void hold_rod(double angle, double R[9]) {
    rbd_body rod[1] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {1, 0, 0}}};
    const unsigned char locked[1] = {1};
    ck_assert_int_eq(rbd_lock_joints(rod, 1, locked, &angle, rod, NULL), RBD_OK);
    memcpy(R, rod[0].rotation, sizeof rod[0].rotation);
}

/* Angles of any size, to a rounding of the angle; right angles exactly. */
START_TEST(angles_of_any_size_can_be_held) {
    const double angles[12] = {0, 1e-9, 0.7, 0.79, 2, 3.15, 4, 5.6, 6.2, 1000.25, 1e6, 1e12};
    double R[9];
    for (int i = 0; i < 12; i++)
        for (int sign = -1; sign <= 1; sign += 2) {
            const double angle = sign * angles[i], bound = 2.3e-16 * (2 + fabs(angle));
            hold_rod(angle, R);
            ck_assert_msg(fabs(R[0] - cos(angle)) < bound && fabs(R[3] - sin(angle)) < bound &&
                              fabs(R[1] + sin(angle)) < bound && fabs(R[4] - cos(angle)) < bound,
                          "angle %g: cos %.17g, sin %.17g", angle, R[0], R[3]);
            ck_assert(fabs(R[0] * R[0] + R[3] * R[3] - 1) < 5e-16);
        }
    for (int quarter = -8; quarter <= 8; quarter++) {
        const double c[4] = {1, 0, -1, 0};
        hold_rod(quarter * (pi / 2), R);
        ck_assert_msg(!(fabs(R[0] - c[(quarter + 16) % 4]) > 0) && !(fabs(R[3] - c[(quarter + 15) % 4]) > 0),
                      "%d right angles: %g %g", quarter, R[0], R[3]);
    }
    hold_rod(1e300, R); /* no more digit is known, but it is a turn */
    ck_assert(fabs(R[0] * R[0] + R[3] * R[3] - 1) < 5e-16);
}
END_TEST

static const rbd_body gripper[4] = {
    {.name = "hand",
     .joint = "wrist",
     .parent = -1,
     .type = RBD_FLOATING,
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1}},
    {.name = "left",
     .joint = "b",
     .parent = 0,
     .type = RBD_PRISMATIC,
     .axis = {0, 1, 0},
     .mass = 1,
     .mimic = "drive",
     .mimic_ratio = -2,
     .mimic_offset = 0.5},
    {.name = "right", .joint = "drive", .parent = 0, .type = RBD_PRISMATIC, .axis = {0, 1, 0}, .mass = 1},
    {.name = "tip",
     .joint = "t",
     .parent = 2,
     .type = RBD_REVOLUTE,
     .axis = {1, 0, 0},
     .mass = 1,
     .com = {0, 0, 1},
     .lower = -1,
     .upper = 1,
     .damping = {1},
     .armature = {2}}};

/* Followers of a held joint are held where it leaves them; a follower can be held alone. */
START_TEST(followers_are_held_with_their_leader) {
    const double q[9] = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, 0.25, NAN}; /* of others it is not read */
    for (int only_follower = 0; only_follower < 2; only_follower++)
        for (int in_place = 0; in_place < 2; in_place++) {
            const unsigned char locked[4] = {0, only_follower != 0, !only_follower, 0};
            rbd_body rows[4];
            if (in_place) memcpy(rows, gripper, sizeof rows);
            ck_assert_int_eq(rbd_lock_joints(in_place ? rows : gripper, 4, locked, q, rows, NULL), RBD_OK);
            ck_assert_int_eq(rows[1].type, RBD_FIXED);
            ck_assert_int_eq(rows[2].type, only_follower ? RBD_PRISMATIC : RBD_FIXED);
            ck_assert_ptr_eq(rows[1].mimic, NULL);
            ck_assert(!(fabs(rows[1].position[1] - (0.5 - 2 * 0.25)) > 0));
            ck_assert(!(fabs(rows[2].position[1] - (only_follower ? 0 : 0.25)) > 0));
            ck_assert(memcmp(&rows[0], &gripper[0], sizeof rows[0]) == 0);
            ck_assert(memcmp(&rows[3], &gripper[3], sizeof rows[3]) == 0);
            robot h = robot_build("gripper", rows, 4);
            ck_assert_int_eq(h.nv, only_follower ? 8 : 7);
            ck_assert_int_eq(rbd_joint_index(h.m, "drive"), 2);
            ck_assert_int_eq(rbd_body_index(h.m, "left"), 1);
            robot_free(&h);
        }
}
END_TEST

/* Without a flag nothing changes; a held row keeps its body and no part of its joint but the name. */
START_TEST(rows_keep_their_bodies) {
    const double q[9] = {1, 2, 3, 0, 0, 0, 1, 0.25, 1.25};
    const unsigned char none[4] = {0}, tip[4] = {0, 0, 0, 255};
    rbd_body rows[4], expected = gripper[3];
    rbd_report report;
    ck_assert_int_eq(rbd_lock_joints(gripper, 4, none, q, rows, &report), RBD_OK);
    ck_assert(memcmp(rows, gripper, sizeof rows) == 0);
    ck_assert_int_eq(report.error.status, RBD_OK);
    ck_assert_int_eq(report.warnings, 3); /* as of the build: no inertia */
    ck_assert_int_eq(rbd_lock_joints(gripper, 4, tip, q, rows, NULL), RBD_OK);
    expected.type = RBD_FIXED;
    expected.axis[0] = expected.lower = expected.upper = expected.damping[0] = expected.armature[0] = 0;
    memcpy(expected.rotation, rows[3].rotation, sizeof expected.rotation);
    ck_assert_str_eq(rows[3].joint, "t");
    ck_assert(memcmp(&rows[3], &expected, sizeof expected) == 0);
    ck_assert(fabs(rows[3].rotation[7] - sin(1.25)) < 1e-15); /* beyond its limits */
}
END_TEST

/* What rbd_describe reads from a model can be held too. */
START_TEST(a_built_model_can_be_held) {
    const ref_model *hyq = reference_model(1);
    robot r = robot_build(hyq->name, hyq->bodies, hyq->nb);
    rbd_body rows[MAX_BODIES];
    unsigned char locked[MAX_BODIES] = {0};
    const int knee = r.nb - 1;
    double M[2][MAX_V * MAX_V];
    state s;
    uint64_t seed = 3;
    draw_state(&r, &seed, &s);
    for (int b = 0; b < r.nb; b++) ck_assert_int_eq(rbd_describe(r.m, b, &rows[b]), RBD_OK);
    locked[knee] = 1;
    ck_assert_int_eq(rbd_lock_joints(rows, r.nb, locked, s.q, rows, NULL), RBD_OK);
    robot h = robot_build("HyQ, a knee held", rows, r.nb);
    ck_assert_int_eq(h.nv, r.nv - 1);
    ck_assert_int_eq(rbd_crba(r.m, r.w, s.q, M[0]), RBD_OK);
    ck_assert_int_eq(rbd_crba(h.m, h.w, s.q, M[1]), RBD_OK); /* the knee's q is the last */
    for (int i = 0; i < h.nv; i++)
        for (int j = 0; j < h.nv; j++)
            ck_assert(fabs(M[1][i * h.nv + j] - M[0][i * r.nv + j]) < 1e-12 * largest(M[0], r.nv * r.nv));
    robot_free(&r);
    robot_free(&h);
}
END_TEST

static void expect_refused(rbd_status status, const rbd_body *bodies, const unsigned char *locked,
                           const double *q, const char *text) {
    rbd_body rows[4];
    rbd_report report;
    char found[200];
    memcpy(rows, bodies, sizeof rows);
    ck_assert_int_eq(rbd_lock_joints(rows, 4, locked, q, rows, &report), status);
    ck_assert_int_eq(rbd_lock_joints(rows, 4, locked, q, rows, NULL), status);
    ck_assert_str_eq(rbd_finding_text(&report.error, found, sizeof found), text);
    ck_assert(memcmp(rows, bodies, sizeof rows) == 0);
}

START_TEST(errors_have_their_names) {
    const double good[9] = {1, 2, 3, 0, 0, 0, 1, 0.25, 0}, bad[3] = {NAN, INFINITY, -INFINITY};
    const unsigned char hand[4] = {1, 0, 0, 0}, drive[4] = {0, 0, 1, 0}, left[4] = {0, 1, 0, 0};
    rbd_body rows[4];
    double q[9];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 8; k++) {
            memcpy(q, good, sizeof q);
            q[k] = bad[i];
            if (k < 7)
                expect_refused(RBD_ERR_RANGE, gripper, hand, q,
                               "body 0 'hand', field 'q': a coordinate of its joint, which shall be held, is "
                               "not finite");
            else
                expect_refused(RBD_ERR_RANGE, gripper, left, q,
                               "body 1 'left', field 'q': a coordinate of its joint, which shall be held, is "
                               "not finite");
        }
    q[7] = 1e308; /* twice that is infinite */
    expect_refused(RBD_ERR_RANGE, gripper, drive, q,
                   "body 1 'left', field 'q': a coordinate of its joint, which shall be held, is not finite");
    memcpy(rows, gripper, sizeof rows);
    rows[3].axis[0] = 0;
    expect_refused(RBD_ERR_AXIS, rows, drive, good,
                   "body 3 'tip', field 'axis': zero or not finite; axis2 of a universal joint also if "
                   "parallel to axis");
    memcpy(rows, gripper, sizeof rows);
    rows[1].mimic = "nobody";
    ck_assert_int_eq(rbd_lock_joints(rows, 4, drive, good, rows, NULL), RBD_ERR_MIMIC);
    ck_assert_int_eq(rbd_lock_joints(NULL, 4, drive, good, rows, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_lock_joints(gripper, 4, NULL, good, rows, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_lock_joints(gripper, 4, drive, NULL, rows, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_lock_joints(gripper, 4, drive, good, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_lock_joints(gripper, 0, drive, good, rows, NULL), RBD_ERR_COUNT);
    ck_assert_int_eq(rbd_lock_joints(gripper, RBD_MAX_BODIES + 1, drive, good, rows, NULL), RBD_ERR_COUNT);
}
END_TEST

Suite *lock_suite(void) {
    Suite *suite = suite_create("lock");
    TCase *c = tcase_create("lock");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, a_held_robot_is_the_whole_one_at_rest_there);
    tcase_add_test(c, every_joint_type_can_be_held);
    tcase_add_test(c, angles_of_any_size_can_be_held);
    tcase_add_test(c, followers_are_held_with_their_leader);
    tcase_add_test(c, rows_keep_their_bodies);
    tcase_add_test(c, a_built_model_can_be_held);
    tcase_add_test(c, errors_have_their_names);
    suite_add_tcase(suite, c);
    return suite;
}
