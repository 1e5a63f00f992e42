/* test_lookup.c - [lookup]: sizes, names, joints, degrees of freedom. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

static const rbd_body arm[] = {
    {.name = "base",
     .joint = "free",
     .parent = -1,
     .type = RBD_FLOATING,
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1}},
    {.name = "upper",
     .joint = "shoulder",
     .parent = 0,
     .type = RBD_REVOLUTE,
     .axis = {0, 1, 0},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1},
     .lower = -1,
     .upper = 2,
     .velocity = 3,
     .effort = 4},
    {.name = "tool", .joint = "flange", .parent = 1, .type = RBD_FIXED},
    {.parent = 1, .type = RBD_CONTINUOUS_CS, .axis = {0, 0, 1}, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
    {.name = "finger",
     .joint = "grip",
     .parent = 3,
     .type = RBD_PRISMATIC,
     .axis = {1, 0, 0},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1},
     .mimic = "shoulder",
     .mimic_ratio = 0.5},
    {.name = "shoulder",
     .joint = "upper",
     .parent = 0,
     .type = RBD_CYLINDRICAL,
     .axis = {0, 1, 0},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1}},
};
enum { ARM_NB = 6, ARM_NQ = 12, ARM_NV = 10 };

START_TEST(counts_are_those_of_the_description) {
    robot r = BUILD(arm);
    ck_assert_int_eq(rbd_nb(r.m), ARM_NB);
    ck_assert_int_eq(rbd_nq(r.m), ARM_NQ);
    ck_assert_int_eq(rbd_nv(r.m), ARM_NV);
    ck_assert_int_eq(rbd_nb(NULL), 0);
    ck_assert_int_eq(rbd_nq(NULL), 0);
    ck_assert_int_eq(rbd_nv(NULL), 0);
    robot_free(&r);
}
END_TEST

/* Link and joint names are two sets: the same word may stand in both. */
START_TEST(names_lead_to_bodies_and_back) {
    robot r = BUILD(arm);
    for (int i = 0; i < ARM_NB; i++) {
        if (!arm[i].name) {
            ck_assert_ptr_null(rbd_body_name(r.m, i));
            ck_assert_ptr_null(rbd_joint_name(r.m, i));
            continue;
        }
        ck_assert_int_eq(rbd_body_index(r.m, arm[i].name), i);
        ck_assert_int_eq(rbd_joint_index(r.m, arm[i].joint), i);
        ck_assert_str_eq(rbd_body_name(r.m, i), arm[i].name);
        ck_assert_str_eq(rbd_joint_name(r.m, i), arm[i].joint);
    }
    ck_assert_int_eq(rbd_body_index(r.m, "flange"), -1);
    ck_assert_int_eq(rbd_joint_index(r.m, "tool"), -1);
    ck_assert_int_eq(rbd_body_index(r.m, ""), -1);
    ck_assert_int_eq(rbd_body_index(r.m, "bas"), -1);
    ck_assert_int_eq(rbd_body_index(r.m, "base2"), -1);
    ck_assert_int_eq(rbd_body_index(r.m, NULL), -1);
    ck_assert_int_eq(rbd_joint_index(r.m, NULL), -1);
    ck_assert_int_eq(rbd_body_index(NULL, "base"), -1);
    ck_assert_int_eq(rbd_joint_index(NULL, "free"), -1);
    ck_assert_ptr_null(rbd_body_name(r.m, -1));
    ck_assert_ptr_null(rbd_body_name(r.m, ARM_NB));
    ck_assert_ptr_null(rbd_joint_name(r.m, -1));
    ck_assert_ptr_null(rbd_joint_name(r.m, ARM_NB));
    ck_assert_ptr_null(rbd_body_name(NULL, 0));
    ck_assert_ptr_null(rbd_joint_name(NULL, 0));
    robot_free(&r);
}
END_TEST

START_TEST(joints_know_their_place_and_limits) {
    static const rbd_joint_info expected[ARM_NB] = {
        {.type = RBD_FLOATING, .iq = 0, .nq = 7, .iv = 0, .nv = 6},
        {.type = RBD_REVOLUTE,
         .iq = 7,
         .nq = 1,
         .iv = 6,
         .nv = 1,
         .lower = -1,
         .upper = 2,
         .velocity = 3,
         .effort = 4},
        {.type = RBD_FIXED, .iq = 8, .nq = 0, .iv = 7, .nv = 0},
        {.type = RBD_CONTINUOUS_CS, .iq = 8, .nq = 2, .iv = 7, .nv = 1},
        {.type = RBD_PRISMATIC, .iq = 10, .nq = 0, .iv = 8, .nv = 0},
        {.type = RBD_CYLINDRICAL, .iq = 10, .nq = 2, .iv = 8, .nv = 2}};
    robot r = BUILD(arm);
    rbd_joint_info info;
    for (int i = 0; i < ARM_NB; i++) {
        const rbd_joint_info *e = &expected[i];
        ck_assert_int_eq(rbd_joint(r.m, i, &info), RBD_OK);
        ck_assert_int_eq(info.type, e->type);
        ck_assert_int_eq(info.nq, e->nq);
        ck_assert_int_eq(info.nv, e->nv);
        if (e->nq > 0) {
            ck_assert_int_eq(info.iq, e->iq);
            ck_assert_int_eq(info.iv, e->iv);
        }
        ck_assert_double_eq(info.lower, e->lower);
        ck_assert_double_eq(info.upper, e->upper);
        ck_assert_double_eq(info.velocity, e->velocity);
        ck_assert_double_eq(info.effort, e->effort);
    }
    ck_assert_int_eq(rbd_joint(r.m, -1, &info), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_joint(r.m, ARM_NB, &info), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_joint(NULL, 0, &info), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_joint(r.m, 0, NULL), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

/* What a description says of limits means the same in every call: of these joints, and swapped, none. */
START_TEST(limits_that_mean_none_are_none_everywhere) {
    for (int i = RBD_FIXED + 1; i < RBD_JOINT_TYPES; i++) {
        const rbd_joint_type type = (rbd_joint_type)i;
        const int has = type == RBD_REVOLUTE || type == RBD_PRISMATIC || type == RBD_HELICAL;
        rbd_body body = {.parent = -1, .type = type, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}};
        rbd_joint_info info;
        rbd_body row;
        body.axis[2] = body.axis2[0] = 1;
        body.lower = has ? 0.001 : -0.001, body.upper = has ? -0.001 : 0.001;
        robot r = robot_build("one joint", &body, 1);
        ck_assert_int_eq(rbd_joint(r.m, 0, &info), RBD_OK);
        ck_assert_int_eq(rbd_describe(r.m, 0, &row), RBD_OK);
        ck_assert(!(fabs(info.lower) + fabs(info.upper) > 0));
        ck_assert(!(fabs(row.lower) + fabs(row.upper) > 0));

        int beyond = 0;
        uint64_t seed = 1;
        double q[7];
        for (int k = 0; k < 10; k++) {
            ck_assert_int_eq(rbd_random(r.m, &seed, q), RBD_OK);
            beyond += fabs(q[0]) > 0.01;
        }
        ck_assert_int_gt(beyond, 5);
        robot_free(&r);
    }
}
END_TEST

START_TEST(degrees_of_freedom_lead_to_bodies) {
    const int body[ARM_NV] = {0, 0, 0, 0, 0, 0, 1, 3, 5, 5};
    robot r = BUILD(arm);
    for (int k = 0; k < ARM_NV; k++) ck_assert_int_eq(rbd_dof_body(r.m, k), body[k]);
    ck_assert_int_eq(rbd_dof_body(r.m, -1), -1);
    ck_assert_int_eq(rbd_dof_body(r.m, ARM_NV), -1);
    ck_assert_int_eq(rbd_dof_body(NULL, 0), -1);
    robot_free(&r);
}
END_TEST

/* Every joint of the reference models lies where their file says. */
START_TEST(joints_lie_where_the_reference_has_them) {
    for (int i = 0; i < reference_count; i++) {
        const ref_model *model = reference_model(i);
        robot r = robot_build(model->name, model->bodies, model->nb);
        for (int b = 0; b < model->nb; b++) {
            rbd_joint_info info;
            ck_assert_int_eq(rbd_joint(r.m, b, &info), RBD_OK);
            ck_assert_int_eq(info.nq, model->body_nq[b]);
            ck_assert_int_eq(info.nv, model->body_nv[b]);
            if (info.nv > 0) {
                ck_assert_int_eq(info.iq, model->body_iq[b]);
                ck_assert_int_eq(info.iv, model->body_iv[b]);
            }
        }
        robot_free(&r);
    }
}
END_TEST

/* ---- bodies read back ---- */

static void expect_equal(const double *found, const double *expected, int n, const char *what, int body) {
    for (int k = 0; k < n; k++)
        ck_assert_msg(fabs(found[k] - expected[k]) <= 0, "body %d, %s %d: %.17g", body, what, k, found[k]);
}

/* The nearest body towards the root that has a joint. */
static int carrier(const rbd_body *bodies, int b) {
    for (b = bodies[b].parent; b >= 0 && bodies[b].type == RBD_FIXED;) b = bodies[b].parent;
    return b;
}

static void unit_axis(const double axis[3], double unit[3]) {
    const double length = sqrt(dot(axis, axis, 3));
    for (int k = 0; k < 3; k++) unit[k] = axis[k] / length;
}

/* Whether a joint is described by an axis. Those that are not are named, so that a new type is. */
static int has_axis(rbd_joint_type type) {
    switch (type) {
    case RBD_FIXED:
    case RBD_SPHERICAL:
    case RBD_EULER_ZYX:
    case RBD_EULER_XYZ:
    case RBD_EULER_YXZ:
    case RBD_EULER_ZXY:
    case RBD_PLANAR:
    case RBD_TRANSLATION:
    case RBD_FLOATING: return 0;
    default: return 1;
    }
}

static void check_row(const robot *r, int b, const rbd_body *found) {
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const rbd_body *e = &r->bodies[b];
    const int dofs = e->mimic ? 1 : tb_nv(e);
    double axis[3] = {0}, axis2[3] = {0};
    ck_assert_ptr_eq(found->name, e->name);
    ck_assert_ptr_eq(found->joint, e->joint);
    ck_assert_int_eq(found->type, e->type);
    ck_assert_int_eq(found->parent, carrier(r->bodies, b));
    expect_equal(&found->mass, &e->mass, 1, "mass", b);
    expect_equal(found->com, e->com, 3, "com", b);
    expect_equal(found->inertia, e->inertia, 6, "inertia", b);
    expect_equal(found->armature, e->armature, dofs, "armature", b);
    expect_equal(found->damping, e->damping, dofs, "damping", b);
    expect_equal(found->friction, e->friction, dofs, "friction", b);
    for (int k = dofs; k < 6; k++)
        ck_assert(!(fabs(found->armature[k]) + fabs(found->damping[k]) + fabs(found->friction[k]) > 0));
    expect_equal(&found->lower, &e->lower, 1, "lower", b);
    expect_equal(&found->upper, &e->upper, 1, "upper", b);
    expect_equal(&found->velocity, &e->velocity, 1, "velocity", b);
    expect_equal(&found->effort, &e->effort, 1, "effort", b);
    expect_equal(&found->pitch, &e->pitch, 1, "pitch", b);
    ck_assert((found->mimic == NULL) == (e->mimic == NULL));
    if (e->mimic) {
        ck_assert_str_eq(found->mimic, e->mimic);
        expect_equal(&found->mimic_ratio, &e->mimic_ratio, 1, "mimic_ratio", b);
        expect_equal(&found->mimic_offset, &e->mimic_offset, 1, "mimic_offset", b);
    }
    if (has_axis(e->type)) unit_axis(e->axis, axis);
    if (dot(e->axis2, e->axis2, 3) > 0)
        unit_axis(e->axis2, axis2); /* random_joint gives it to types that have it */
    for (int k = 0; k < 3; k++)
        expect_small("axis read back", r, b,
                     fabs(found->axis[k] - axis[k]) + fabs(found->axis2[k] - axis2[k]), 1e-11);
    if (found->parent != e->parent) return;
    for (int k = 0; k < 3; k++)
        expect_small("position read back", r, b, fabs(found->position[k] - e->position[k]), 1e-11);
    for (int k = 0; k < 9; k++) {
        const double *R = largest(e->rotation, 9) > 0 ? e->rotation : identity;
        expect_small("rotation read back", r, b, fabs(found->rotation[k] - R[k]), 1e-11);
    }
}

/* Row by row, and as a whole: a model of the rows does the same. */
static void check_description(const robot *r, const state *s, int number) {
    static rbd_body rows[MAX_BODIES];
    double tau[2][MAX_V], R[2][9], p[2][3], gravity[3];
    for (int b = 0; b < r->nb; b++) {
        memset(&rows[b], 0xff, sizeof rows[b]);
        RUN(rbd_describe(r->m, b, &rows[b]));
        check_row(r, b, &rows[b]);
    }
    robot again = robot_build(r->name, rows, r->nb);
    ck_assert_int_eq(again.nq, r->nq);
    ck_assert_int_eq(again.nv, r->nv);
    RUN(rbd_get_gravity(r->w, gravity));
    expect_equal(gravity, s->gravity, 3, "gravity", 0);
    RUN(rbd_set_gravity(again.w, gravity));
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, tau[0]));
    RUN(rbd_rnea(again.m, again.w, s->q, s->v, s->a, s->f_ext, tau[1]));
    expect_close("rnea, read back", r, number, tau[1], tau[0], r->nv, 1e-10); /* of axes snapped by 1e-12 */
    RUN(rbd_kinematics(r->m, r->w, s->q, NULL, NULL));
    RUN(rbd_kinematics(again.m, again.w, s->q, NULL, NULL));
    for (int b = 0; b < r->nb; b++) {
        RUN(rbd_body_pose(r->m, r->w, b, R[0], p[0]));
        RUN(rbd_body_pose(again.m, again.w, b, R[1], p[1]));
        expect_close("R, read back", r, number, R[1], R[0], 9, 1e-11);
        expect_close("p, read back", r, number, p[1], p[0], 3, 1e-10);
    }
    robot_free(&again);
}

START_TEST(bodies_are_read_back) {
    for_random_states(1, check_description);
    for_random_trees(200, check_description);
}
END_TEST

START_TEST(what_is_not_there_is_not_read_back) {
    robot r = BUILD(arm);
    double g[3];
    rbd_body row;
    ck_assert_int_eq(rbd_describe(NULL, 0, &row), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_describe(r.m, 0, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_describe(r.m, -1, &row), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_describe(r.m, ARM_NB, &row), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_get_gravity(NULL, g), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_get_gravity(r.w, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_get_gravity(r.w, g), RBD_OK);
    expect_equal(g, earth, 3, "gravity", 0);
    robot_free(&r);
}
END_TEST

Suite *lookup_suite(void) {
    Suite *suite = suite_create("lookup");
    TCase *c = tcase_create("lookup");
    tcase_add_test(c, counts_are_those_of_the_description);
    tcase_add_test(c, names_lead_to_bodies_and_back);
    tcase_add_test(c, joints_know_their_place_and_limits);
    tcase_add_test(c, limits_that_mean_none_are_none_everywhere);
    tcase_add_test(c, degrees_of_freedom_lead_to_bodies);
    tcase_add_test(c, joints_lie_where_the_reference_has_them);
    tcase_add_test(c, bodies_are_read_back);
    tcase_add_test(c, what_is_not_there_is_not_read_back);
    suite_add_tcase(suite, c);
    return suite;
}
