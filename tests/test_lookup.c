/* test_lookup.c - [lookup]: sizes, names, joints, degrees of freedom. */
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

Suite *lookup_suite(void) {
    Suite *suite = suite_create("lookup");
    TCase *c = tcase_create("lookup");
    tcase_add_test(c, counts_are_those_of_the_description);
    tcase_add_test(c, names_lead_to_bodies_and_back);
    tcase_add_test(c, joints_know_their_place_and_limits);
    tcase_add_test(c, degrees_of_freedom_lead_to_bodies);
    tcase_add_test(c, joints_lie_where_the_reference_has_them);
    suite_add_tcase(suite, c);
    return suite;
}
