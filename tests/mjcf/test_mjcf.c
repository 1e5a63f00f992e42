/* test_mjcf.c - rbd_mjcf.h beside MuJoCo: every joint, frame and inertia of MJCF, names, equalities.
   usage: test_mjcf, with the folder of the project in the environment as RBD_ROOT.
   SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>

#include "../larger.h"
#include "compare.h"

enum { MAX = 100 };

static const char *path_of(const char *name) {
    static char path[1000];
    snprintf(path, sizeof path, "%s/tests/mjcf/%s.xml", getenv("RBD_ROOT"), name);
    return path;
}

static mjModel *compiled(const char *name) {
    char error[1000] = "";
    mjModel *m = mj_loadXML(path_of(name), NULL, error, sizeof error);
    ck_assert_msg(m != NULL, "%s: %s", name, error);
    return m;
}

/* Arrays for a robot that is loaded. */
typedef struct room {
    rbd_body bodies[MAX];
    rbd_mjcf_frame frames[MAX];
    rbd_mjcf_place places[MAX];
    rbd_constraint constraints[MAX];
    rbd_mjcf_finding warnings[MAX];
    char names[10000];
} room;

static rbd_mjcf with_room(room *x) {
    rbd_mjcf r;
    memset(&r, 0, sizeof r);
    r.bodies = x->bodies;
    r.frames = x->frames;
    r.places = x->places;
    r.constraints = x->constraints;
    r.warnings = x->warnings;
    r.names = x->names;
    r.bodies_max = r.frames_max = r.places_max = r.constraints_max = r.warnings_max = MAX;
    r.names_max = sizeof x->names;
    return r;
}

static rbd_mjcf_status parse(rbd_mjcf *r, const char *text, const rbd_mjcf_options *options) {
    return rbd_mjcf_parse(text, strlen(text), options, r);
}

static rbd_mjcf loaded_from(room *x, const char *name, const rbd_mjcf_options *options) {
    rbd_mjcf r = with_room(x);
    ck_assert_msg(rbd_mjcf_load(path_of(name), options, &r) == RBD_MJCF_OK, "%s: %s", name, r.error.text);
    return r;
}

static const rbd_body *body_of(const rbd_mjcf *r, const char *joint) {
    for (int i = 0; i < r->nb; i++)
        if (strcmp(r->bodies[i].joint, joint) == 0) return &r->bodies[i];
    ck_abort_msg("no joint %s", joint);
    return NULL;
}

static const rbd_mjcf_frame *frame_of(const rbd_mjcf *r, const char *link) {
    for (int i = 0; i < r->nframes; i++)
        if (strcmp(r->frames[i].link, link) == 0) return &r->frames[i];
    ck_abort_msg("no link %s", link);
    return NULL;
}

/* ---- dynamics ---- */

static const char *const files[] = {"joints", "forms", "geoms", "equalities"};
static const char *const kept[] = {"plate", "on_turret", NULL};
static const rbd_mjcf_lock held_joints[] = {{"roll", 0.7}, {"cart_y", -0.3}, {NULL, 0}};
static const rbd_mjcf_lock held_leader[] = {{"left_a", 0.4}, {NULL, 0}};

static const struct {
    const char *file;
    rbd_mjcf_options options;
} ways[] = {
    {"joints", {.keep_all = 1}},       {"joints", {.keep = kept}},
    {"joints", {.lock = held_joints}}, {"joints", {.keep_all = 1, .lock = held_joints}},
    {"forms", {.keep_all = 1}},        {"equalities", {.free_mimics = 1}},
    {"equalities", {.keep_all = 1}},
};
enum { FILES = sizeof files / sizeof *files, WAYS = sizeof ways / sizeof *ways };

static void assert_equal_to_mujoco(const char *name, const rbd_mjcf_options *options) {
    mjModel *m = compiled(name);
    const differences x = compare(m, options, 20);
    ck_assert_msg(x.reason[0] == 0, "%s: %s", name, x.reason);
    ck_assert_double_le(x.mass, 1e-12);
    ck_assert_double_le(x.bias, 1e-12);
    ck_assert_double_le(x.poses, 1e-12);
    ck_assert_double_le(x.kinetic, 1e-12);
    ck_assert_double_le(x.potential, 1e-12);
    ck_assert_double_le(x.coordinates, 1e-12);
    mj_deleteModel(m);
}

START_TEST(dynamics_are_those_of_mujoco) { assert_equal_to_mujoco(files[_i], NULL); }
END_TEST

START_TEST(dynamics_are_those_of_mujoco_with_options) {
    assert_equal_to_mujoco(ways[_i].file, &ways[_i].options);
}
END_TEST

START_TEST(no_coordinate_is_lost) {
    mjModel *m = compiled("joints");
    const differences x = compare(m, NULL, 1);
    ck_assert_int_eq(x.nq, m->nq);
    ck_assert_int_eq(x.nv, m->nv);
    ck_assert_int_eq(x.nwarnings, 0);
    mj_deleteModel(m);
}
END_TEST

/* ---- rows ---- */

START_TEST(joints_have_what_the_file_says) {
    static room x;
    const rbd_mjcf r = loaded_from(&x, "joints", NULL);
    const rbd_body *turn = body_of(&r, "turn"), *drawer = body_of(&r, "drawer"),
                   *ball = body_of(&r, "joint_6");
    ck_assert_str_eq(r.name, "joints");
    ck_assert_int_eq(turn->type, RBD_REVOLUTE);
    ck_assert_double_eq(turn->lower, -1);
    ck_assert_double_eq(turn->upper, 2);
    ck_assert_double_eq(turn->damping[0], 0.7);
    ck_assert_double_eq(turn->friction[0], 0.3);
    ck_assert_double_eq(turn->armature[0], 0.05);
    ck_assert_int_eq(drawer->type, RBD_PRISMATIC);
    ck_assert_double_eq(drawer->upper, 0.5);
    ck_assert_double_eq(drawer->axis[1], 2 * drawer->axis[0]);
    ck_assert_int_eq(body_of(&r, "yaw")->type, RBD_CONTINUOUS);
    ck_assert_int_eq(body_of(&r, "flight")->type, RBD_FLOATING);
    ck_assert_int_eq(ball->type, RBD_SPHERICAL);
    for (int i = 0; i < 3; i++) {
        ck_assert_double_eq(ball->damping[i], 0.2);
        ck_assert_double_eq(ball->armature[i], 0.01);
    }
    ck_assert_double_eq(r.gravity[0], 0.5);
    ck_assert_double_eq(r.gravity[2], -9.5);
    ck_assert_double_eq(r.fixed_mass, 3);
}
END_TEST

/* MuJoCo has the lengths of a free joint first, rbd the angles. */
START_TEST(dofs_of_a_free_joint_are_in_order) {
    mjModel *m = compiled("joints");
    const int first = m->jnt_dofadr[mj_name2id(m, mjOBJ_JOINT, "flight")];
    static room x;
    rbd_mjcf r = with_room(&x);
    for (int i = 0; i < 6; i++) {
        m->dof_damping[first + i] = i + 1;
        m->dof_frictionloss[first + i] = i + 10;
    }
    ck_assert_int_eq(rbd_mjcf_convert(m, NULL, &r), RBD_MJCF_OK);
    for (int i = 0; i < 6; i++) {
        ck_assert_double_eq(body_of(&r, "flight")->damping[i], (i + 3) % 6 + 1);
        ck_assert_double_eq(body_of(&r, "flight")->friction[i], (i + 3) % 6 + 10);
    }
    mj_deleteModel(m);
}
END_TEST

START_TEST(a_joint_is_as_strong_as_its_actuators) {
    static room x;
    rbd_mjcf r = with_room(&x);
    const char *text =
        "<mujoco><worldbody><body><joint name='a'/><joint name='b' axis='1 0 0'/><geom size='1'/></body>"
        "</worldbody><actuator><motor joint='a'/>"
        "<motor joint='a' forcelimited='true' forcerange='-1 1'/>"
        "<general joint='b' gainprm='3' ctrllimited='true' ctrlrange='-2 1' gear='4'/></actuator></mujoco>";
    ck_assert_msg(parse(&r, text, NULL) == RBD_MJCF_OK, "%s", r.error.text);
    ck_assert_double_eq(body_of(&r, "a")->effort, 0); /* one has no limit */
    ck_assert_double_eq(body_of(&r, "b")->effort, 3 * 2 * 4);
#if mjVERSION_HEADER >= 300
    text = "<mujoco><worldbody><body><joint name='a' actuatorfrclimited='true' actuatorfrcrange='-5 "
           "2'/><geom size='1'/>"
           "</body></worldbody><actuator><motor joint='a' forcelimited='true' forcerange='-9 "
           "9'/></actuator></mujoco>";
    ck_assert_msg(parse(&r, text, NULL) == RBD_MJCF_OK, "%s", r.error.text);
    ck_assert_double_eq(body_of(&r, "a")->effort, 5);
#endif
}
END_TEST

START_TEST(links_and_frames_have_names) {
    static room x;
    rbd_mjcf r = loaded_from(&x, "joints", NULL);
    ck_assert_str_eq(r.frames[0].link, "world");
    ck_assert_ptr_null(r.frames[0].joint);
    ck_assert_int_eq(frame_of(&r, "pedestal")->body, -1);
    ck_assert_str_eq(r.bodies[frame_of(&r, "on_plate")->body].name, "turret");
    ck_assert_str_eq(r.frames[frame_of(&r, "wrist")->parent].link, "yaw_link");
    ck_assert_str_eq(body_of(&r, "pitch")->name, "pitch_link");
    ck_assert_str_eq(body_of(&r, "body_7_fixed")->name, "body_7");
    ck_assert_str_eq(body_of(&r, "saddle")->name, "rider");
    const rbd_mjcf_options options = {.keep = kept};
    r = loaded_from(&x, "joints", &options);
    ck_assert_int_eq(body_of(&r, "on_turret_fixed")->type, RBD_FIXED);
    ck_assert_str_eq(r.bodies[frame_of(&r, "on_plate")->body].name, "plate");
}
END_TEST

START_TEST(names_that_are_taken_get_underscores) {
    static room x;
    rbd_mjcf r = with_room(&x);
    const char *text = "<mujoco><worldbody><body name='a_link'><joint name='a' pos='1 0 0'/><geom size='1'/>"
                       "<site name='a_link'/><site name='b'/>"
                       "<body name='body_2'><joint name='joint_2'/><geom size='1'/><body><joint/><joint/>"
                       "<joint name='a_link_fixed' axis='1 0 0'/><geom size='1'/></body></body>"
                       "</body></worldbody></mujoco>";
    ck_assert_msg(parse(&r, text, NULL) == RBD_MJCF_OK, "%s", r.error.text);
    ck_assert_str_eq(body_of(&r, "a")->name, "a_link_");
    ck_assert_str_eq(body_of(&r, "a_link_fixed_")->name, "a_link");
    ck_assert_str_eq(frame_of(&r, "a_link_site")->joint, "a_link_site_fixed");
    ck_assert_str_eq(body_of(&r, "joint_2_")->name, "joint_2__link");
    ck_assert_str_eq(body_of(&r, "a_link_fixed")->name, "body_3");
}
END_TEST

START_TEST(classes_and_degrees_are_resolved) {
    static room x;
    const rbd_mjcf r = loaded_from(&x, "forms", NULL);
    const rbd_body *a = body_of(&r, "a"), *d = body_of(&r, "d");
    ck_assert_double_eq_tol(a->lower, -acos(-1) / 2, 1e-15);
    ck_assert_double_eq_tol(a->upper, acos(-1) * 2 / 3, 1e-15);
    ck_assert_double_eq(a->damping[0], 2);
    ck_assert_double_eq(a->friction[0], 0.4);
    ck_assert_double_eq(a->armature[0], 0.02);
    ck_assert_int_eq(d->type, RBD_PRISMATIC);
    ck_assert_double_eq(d->damping[0], 7);
    ck_assert_double_eq(d->lower, -0.1);
    ck_assert_double_eq(body_of(&r, "g")->damping[0], 0.1);
    ck_assert_ptr_nonnull(body_of(&r, "j"));
}
END_TEST

START_TEST(the_total_mass_is_set) {
    static room x;
    const rbd_mjcf r = loaded_from(&x, "geoms", NULL);
    double mass = 0;
    for (int i = 0; i < r.nb; i++) mass += r.bodies[i].mass;
    ck_assert_double_eq_tol(mass, 42, 1e-12);
    ck_assert_double_eq(r.gravity[0], 9.81);
}
END_TEST

START_TEST(gravity_can_be_off_or_given) {
    static room x;
    static const double given[3] = {1, 2, 3}, bad[3] = {1, NAN, 3};
    const char *text =
        "<mujoco><option gravity='0 0 -3'><flag gravity='disable'/></option><worldbody><body><joint/>"
        "<geom size='1'/></body></worldbody></mujoco>";
    rbd_mjcf_options options = {.gravity = given};
    rbd_mjcf r = with_room(&x);
    ck_assert_int_eq(parse(&r, text, NULL), RBD_MJCF_OK);
    ck_assert_double_eq(r.gravity[2], 0);
    ck_assert_int_eq(parse(&r, text, &options), RBD_MJCF_OK);
    ck_assert_double_eq(r.gravity[2], 3);
    options.gravity = bad;
    ck_assert_int_eq(parse(&r, text, &options), RBD_MJCF_ERR_OPTION);
}
END_TEST

/* ---- equalities ---- */

START_TEST(joint_equalities_are_mimics) {
    static room x;
    const rbd_mjcf r = loaded_from(&x, "equalities", NULL);
    const rbd_body *pair = body_of(&r, "right_a"), *chain = body_of(&r, "right_b");
    ck_assert_str_eq(pair->mimic, "left_a");
    ck_assert_double_eq(pair->mimic_ratio, -1.5);
    ck_assert_double_eq_tol(pair->mimic_offset, 0.1 + 0.3, 1e-15);
    ck_assert_str_eq(chain->mimic, "left_a");
    ck_assert_double_eq_tol(chain->mimic_ratio, 0.1 * -1.5, 1e-15);
    ck_assert_double_eq_tol(chain->mimic_offset, 0.05 + 0.02 + 0.1 * 0.3, 1e-15);
    ck_assert_int_eq(body_of(&r, "still")->type, RBD_FIXED);
    ck_assert_ptr_null(body_of(&r, "third")->mimic);
    ck_assert_ptr_null(body_of(&r, "left_b")->mimic);
    const rbd_mjcf_options options = {.free_mimics = 1};
    const rbd_mjcf all_free = loaded_from(&x, "equalities", &options);
    ck_assert_ptr_null(body_of(&all_free, "right_a")->mimic);
    ck_assert_int_eq(body_of(&all_free, "still")->type, RBD_PRISMATIC);
}
END_TEST

START_TEST(circles_of_equalities_are_cut) {
    static room x;
    rbd_mjcf r = with_room(&x);
    const char *text =
        "<mujoco><worldbody><body><joint name='a'/><geom size='1'/></body>"
        "<body><joint name='b'/><geom size='1'/></body><body><joint name='c'/><geom size='1'/></body>"
        "</worldbody><equality><joint joint1='a' joint2='b'/><joint joint1='b' joint2='a'/>"
        "<joint joint1='c' joint2='b'/><joint joint1='c' joint2='a'/></equality></mujoco>";
    ck_assert_msg(parse(&r, text, NULL) == RBD_MJCF_OK, "%s", r.error.text);
    ck_assert_int_eq(r.nwarnings, 2);
    ck_assert_str_eq(r.warnings[0].text,
                     "equality 'equality_3': joint 'c' follows by another equality too; this one is "
                     "left out");
    ck_assert_str_eq(r.warnings[1].text,
                     "joint 'a' follows itself by a circle of equalities; it is left free");
    ck_assert_str_eq(body_of(&r, "b")->mimic, "a");
    ck_assert_str_eq(body_of(&r, "c")->mimic, "a");
}
END_TEST

/* The first of MuJoCo's rows of an equality. */
static int first_row(const mjData *d, int equality) {
    int row = 0;
    while (row < d->nefc && !(d->efc_type[row] == mjCNSTR_EQUALITY && d->efc_id[row] == equality)) row++;
    ck_assert_int_lt(row, d->nefc);
    return row;
}

/* J' J of n rows: the rotation of their axes does not change it. */
static void square(const double *J, int n, int nv, double *JJ) {
    for (int i = 0; i < nv * nv; i++) {
        JJ[i] = 0;
        for (int k = 0; k < n; k++) JJ[i] += J[k * nv + i / nv] * J[k * nv + i % nv];
    }
}

/* Compares three rows of rbd's with three of MuJoCo's, J T, whose length may be another one. */
static double row_difference(const loaded *r, const double *own, const double *J, int rows, const double *T,
                             double length) {
    enum { NV = 30 };
    static double JT[3 * NV], A[NV * NV], B[NV * NV];
    const int nv = rbd_nv(r->model);
    double worst = 0, scale = 0;
    for (int i = 0; i < 3 * nv; i++) {
        JT[i] = 0;
        for (int k = 0; k < rows; k++) JT[i] += length * J[i / nv * rows + k] * T[k * nv + i % nv];
    }
    square(own, 3, nv, A);
    square(JT, 3, nv, B);
    for (int i = 0; i < nv * nv; i++) {
        scale = larger(scale, fabs(A[i]));
        worst = larger(worst, fabs(A[i] - B[i]));
    }
    ck_assert_double_gt(scale, 1e-3);
    return worst / scale;
}

/* Where rbd's constraint holds, MuJoCo's equality does, and their rows are the same but for the directions of
   axes. MuJoCo's rows of rotation are those of half the quaternion. */
static void compare_constraint(const mjModel *m, mjData *d, const loaded *r, int i) {
    static double T[900], J[6 * 30], e[6], q[40], q_near[40], memory[30000];
    const rbd_constraint *k = &r->robot.constraints[i];
    const int is_weld = k->axes[0];
    rbd_constraint_set *c;
    int row, status = RBD_ERR_INFEASIBLE;
    ck_assert_int_eq(rbd_constraint_set_init(r->model, r->w, k, 1, memory, sizeof memory, &c, NULL), RBD_OK);
    for (int tries = 0; tries < 100 && status != RBD_OK; tries++) {
        random_qpos(m, d->qpos);
        d->qpos[m->jnt_qposadr[mj_name2id(m, mjOBJ_JOINT, "still")]] = 0.55;
        rbd_mjcf_q_of_qpos(&r->robot, d->qpos, q);
        status = rbd_assemble(r->model, c, q, NULL, NULL, q_near, NULL);
    }
    ck_assert_int_eq(status, RBD_OK);
    rbd_mjcf_qpos_of_q(&r->robot, q_near, d->qpos);
    mj_fwdPosition(m, d);
    velocity_matrix(r, d->qpos, (int)m->nv, T);
    rbd_constraint_jacobian(r->model, c, q_near, NULL, J, NULL, e);

    row = first_row(d, mj_name2id(m, mjOBJ_EQUALITY, k->name));
    for (int n = 0; n < (is_weld ? 6 : 3); n++) ck_assert_double_lt(fabs(d->efc_pos[row + n]), 1e-8);
    ck_assert_double_lt(
        row_difference(r, J + (is_weld ? 3 * rbd_nv(r->model) : 0), d->efc_J + row * m->nv, (int)m->nv, T, 1),
        1e-7);
    if (is_weld)
        ck_assert_double_lt(row_difference(r, J, d->efc_J + (row + 3) * m->nv, (int)m->nv, T, 2), 1e-7);
}

START_TEST(connect_and_weld_are_those_of_mujoco) {
    mjModel *m = compiled("equalities");
    mjData *d;
    loaded r;
    char reason[500];
    m->opt.jacobian = mjJAC_DENSE;
    d = mj_makeData(m);
    ck_assert_int_eq(load_robot(&r, m, NULL, reason), 0);
    ck_assert_int_eq(r.robot.nconstraints, 4);
    for (int i = 0; i < 4; i++) compare_constraint(m, d, &r, i);
    ck_assert_double_eq(r.robot.constraints[1].kp, 900);
    ck_assert_double_eq(r.robot.constraints[1].kd, 50);
    ck_assert_double_eq_tol(r.robot.constraints[2].kp, 1 / (0.05 * 0.05 * 0.7 * 0.7), 1e-10);
    ck_assert_double_eq_tol(r.robot.constraints[2].kd, 2 / 0.05, 1e-12);
    ck_assert_str_eq(r.robot.constraints[3].name, "turned");
    mj_deleteData(d);
    mj_deleteModel(m);
    free_robot(&r);
}
END_TEST

/* Without relpose a weld holds what there is at the reference: no error there, in rotation either. With it,
   the rotation is the file's. */
START_TEST(welds_hold_the_reference) {
    mjModel *m = compiled("equalities");
    static double J[40 * 30], e[40], q[40];
    const double *weld = m->eq_data + 3 * mjNEQDATA;
    loaded r;
    char reason[500], memory[200000];
    rbd_constraint_set *c;
    double R[9];
    ck_assert_int_eq(load_robot(&r, m, NULL, reason), 0);
    ck_assert_int_eq(
        rbd_constraint_set_init(r.model, r.w, r.robot.constraints, 4, memory, sizeof memory, &c, NULL),
        RBD_OK);
    rbd_mjcf_q_of_qpos(&r.robot, m->qpos0, q);
    rbd_constraint_jacobian(r.model, c, q, NULL, J, NULL, e);
    for (int k = 0; k < 6; k++) ck_assert_double_eq_tol(e[rbd_constraint_first(c, 2) + k], 0, 1e-12);
    ck_assert_double_eq_tol(weld[6], 0.5, 1e-12);
    mju_quat2Mat(R, weld + 6);
    ck_assert_int_eq(r.robot.constraints[3].axes[0], 1);
    ck_assert_int_eq(r.robot.constraints[0].axes[0], 0);
    const rbd_mjcf_frame *tip = frame_of(&r.robot, "left_tip");
    for (int i = 0; i < 9; i++) {
        double turned = 0;
        for (int k = 0; k < 3; k++) turned += tip->rotation[i / 3 * 3 + k] * R[3 * k + i % 3];
        ck_assert_double_eq_tol(r.robot.constraints[3].rotation1[i], turned, 1e-14);
    }
    mj_deleteModel(m);
    free_robot(&r);
}
END_TEST

/* ---- what is left out ---- */

static int has_warning(const rbd_mjcf *r, rbd_mjcf_status status, const char *text) {
    for (int i = 0; i < r->nwarnings; i++)
        if (r->warnings[i].status == status && strcmp(r->warnings[i].text, text) == 0) return 1;
    for (int i = 0; i < r->nwarnings; i++) printf("%d %s\n", (int)r->warnings[i].status, r->warnings[i].text);
    return 0;
}

START_TEST(what_is_left_out_is_named) {
    static room x;
    const rbd_mjcf r = loaded_from(&x, "left_out", NULL);
    static const struct {
        rbd_mjcf_status status;
        const char *text;
    } expected[] = {
        {RBD_MJCF_WARN_FORCE, "springs of joints (stiffness) are left out: 'sprung'"},
        {RBD_MJCF_WARN_LIMIT, "limits of ball joints are left out: 'ball'"},
        {RBD_MJCF_WARN_ARMATURE,
         "armature of a free joint acts in body axes, MuJoCo's in world axes: bias forces differ: 'f'"},
        {RBD_MJCF_WARN_MOCAP, "mocap bodies are read as fixed to the world: 'm'"},
        {RBD_MJCF_WARN_TENDON, "tendons are left out: 'rope', 'couple'"},
        {RBD_MJCF_WARN_ACTUATOR, "actuators that act at no joint are left out: 'winch', 'puller'"},
        {RBD_MJCF_WARN_ACTUATOR,
         "activation of actuators (dyntype) is left out: tau is the torque at the joint: 'slow'"},
        {RBD_MJCF_WARN_ACTUATOR,
         "laws of servos (gaintype, biastype) are left out: tau is the torque at the joint: 'servo'"},
        {RBD_MJCF_WARN_ACTUATOR,
         "gears are left out: tau is the torque at the joint, gear times the actuator's: 'gears'"},
        {RBD_MJCF_WARN_FORCE, "forces of the medium (density, viscosity, wind) are left out"},
        {RBD_MJCF_WARN_EQUALITY, "equality 'taut' holds what rbd has not, such as tendons; it is left out"},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
        ck_assert_msg(has_warning(&r, expected[i].status, expected[i].text), "%s", expected[i].text);
    ck_assert_int_eq(r.nwarnings, (int)(sizeof expected / sizeof *expected));
    ck_assert_double_eq(body_of(&r, "driven")->effort, 4 + 5 + 1);
    ck_assert_double_eq(body_of(&r, "geared")->effort, 50 * 2);
    ck_assert_double_eq(body_of(&r, "sprung")->effort, 0);
    const rbd_mjcf_options options = {.strict = 1};
    rbd_mjcf strict = with_room(&x);
    ck_assert_int_gt(rbd_mjcf_load(path_of("left_out"), &options, &strict), 0);
    ck_assert_str_eq(strict.error.text, strict.warnings[0].text);
}
END_TEST

/* What has no name is called by its kind and MuJoCo's number, an actuator by what it acts at too. */
START_TEST(nameless_things_are_called_by_their_kind) {
    static room x;
    rbd_mjcf r = with_room(&x);
    const char *text =
        "<mujoco><worldbody><body name='leg'><joint name='hip' axis='1 0 0'/><geom size='1'/><site "
        "name='end'/>"
        "<body name='foot'><joint stiffness='3'/><geom size='1'/></body></body><body "
        "mocap='true'/></worldbody>"
        "<tendon><fixed name='rope'><joint joint='hip' coef='1'/></fixed>"
        "<fixed><joint joint='hip' coef='2'/></fixed></tendon>"
        "<equality><tendon tendon1='rope'/><weld body1='leg'/><connect body1='foot' anchor='0 0 "
        "0'/></equality>"
        "<actuator><motor joint='hip' gear='5'/><position joint='hip' name='servo'/><position joint='hip'/>"
        "<motor joint='hip' gear='6'/><motor tendon='rope'/><motor site='end'/></actuator></mujoco>";
    static const char *const expected[] = {
        "are left out: 'joint_1'",
        "fixed to the world: 'body_3'",
        "tendons are left out: 'rope', tendon 1",
        "at no joint are left out: actuator 4 of 'rope', actuator 5 of 'end'",
        "laws of servos (gaintype, biastype) are left out: tau is the torque at the joint: 'servo', actuator "
        "2 of joint 'hip'",
        "the actuator's: actuator 0 of joint 'hip', actuator 3 of joint 'hip'",
        "equality 'equality_0' holds what rbd has not",
    };
    enum { N = sizeof expected / sizeof *expected };

    ck_assert_msg(parse(&r, text, NULL) == RBD_MJCF_OK, "%s", r.error.text);
    ck_assert_int_eq(r.nwarnings, N);
    for (int i = 0; i < N; i++) {
        int found = 0;
        for (int k = 0; k < r.nwarnings; k++) found |= strstr(r.warnings[k].text, expected[i]) != NULL;
        ck_assert_msg(found, "%s", expected[i]);
    }
    ck_assert_int_eq(r.nconstraints, 2);
    ck_assert_str_eq(r.constraints[0].name, "weld_1");
    ck_assert_str_eq(r.constraints[1].name, "connect_2");
}
END_TEST

START_TEST(long_lists_of_names_are_counted) {
    static room x;
    static char text[20000] = "<mujoco><worldbody>";
    rbd_mjcf r = with_room(&x);
    for (int i = 0; i < 60; i++)
        sprintf(text + strlen(text),
                "<body pos='%d 0 0'><joint name='joint_number_%d' stiffness='1'/><geom size='1'/></body>",
                3 * i, i);
    strcat(text, "</worldbody></mujoco>");
    ck_assert_msg(parse(&r, text, NULL) == RBD_MJCF_OK, "%s", r.error.text);
    ck_assert_int_eq(r.nwarnings, 1);
    ck_assert_ptr_nonnull(strstr(r.warnings[0].text, "'joint_number_0', 'joint_number_1'"));
    ck_assert_ptr_nonnull(strstr(r.warnings[0].text, " more"));
}
END_TEST

/* ---- states ---- */

START_TEST(states_are_converted) {
    static room x;
    rbd_mjcf r = with_room(&x);
    const char *text =
        "<mujoco><worldbody><body><freejoint/><geom size='1'/><body><joint type='ball'/><geom size='1'/>"
        "</body></body></worldbody></mujoco>";
    /* A quarter turn about z: the world's x is the body's -y. */
    const double h = sqrt(0.5);
    const double qpos[11] = {1, 2, 3, h, 0, 0, h, 0.8, 0.6, 0, 0}, qvel[9] = {4, 5, 6, 7, 8, 9, 10, 11, 12};
    const double q_is[11] = {1, 2, 3, 0, 0, h, h, 0.6, 0, 0, 0.8}, v_is[9] = {7, 8, 9, 5, -4, 6, 10, 11, 12};
    double q[11], v[9], qpos_again[11] = {0}, qvel_again[9] = {0};
    ck_assert_int_eq(parse(&r, text, NULL), RBD_MJCF_OK);
    rbd_mjcf_q_of_qpos(&r, qpos, q);
    rbd_mjcf_v_of_qvel(&r, qpos, qvel, v);
    rbd_mjcf_qpos_of_q(&r, q, qpos_again);
    rbd_mjcf_qvel_of_v(&r, qpos, v, qvel_again);
    for (int i = 0; i < 11; i++) {
        ck_assert_double_eq(q[i], q_is[i]);
        ck_assert_double_eq(qpos_again[i], qpos[i]);
    }
    for (int i = 0; i < 9; i++) {
        ck_assert_double_eq_tol(v[i], v_is[i], 1e-14);
        ck_assert_double_eq_tol(qvel_again[i], qvel[i], 1e-14);
    }
    r.places = NULL;
    rbd_mjcf_q_of_qpos(&r, qpos, NULL);
    rbd_mjcf_qvel_of_v(&r, qpos, v, NULL);
}
END_TEST

/* ---- errors ---- */

START_TEST(errors_say_what_is_wrong) {
    static room x;
    static const char *const absent[] = {"nobody", NULL};
    static const struct {
        const char *text;
        rbd_mjcf_options options;
        rbd_mjcf_status status;
        int line;
        const char *part;
    } cases[] = {
        {"", {0}, RBD_MJCF_ERR_COMPILER, 0, "empty"},
        {"<mujoco>\n<worldbody>\n<boody/>\n</worldbody></mujoco>", {0}, RBD_MJCF_ERR_COMPILER, 3, "boody"},
        {"<mujoco>\n<worldbody>\n<boody/>\n</worldbody></mujoco>",
         {0},
         RBD_MJCF_ERR_COMPILER,
         3,
         "newer MuJoCo?"},
        {"<mujoco><worldbody><body><joint/></body></worldbody></mujoco>",
         {0},
         RBD_MJCF_ERR_COMPILER,
         0,
         "mass"},
        {"<mujoco><worldbody><body><geom size='1'/></body></worldbody></mujoco>",
         {0},
         RBD_MJCF_ERR_ROBOT,
         0,
         "moves"},
        {"<mujoco><worldbody><body><joint name='a'/><geom size='1'/></body></worldbody></mujoco>",
         {.keep = absent},
         RBD_MJCF_ERR_OPTION,
         0,
         "'nobody'"},
        {"<mujoco><worldbody><body><joint name='a'/><geom size='1'/></body></worldbody></mujoco>",
         {.lock = held_joints},
         RBD_MJCF_ERR_OPTION,
         0,
         "'roll'"},
        {"<mujoco><worldbody><body><joint name='roll' type='ball'/><geom "
         "size='1'/></body></worldbody></mujoco>",
         {.lock = held_joints},
         RBD_MJCF_ERR_OPTION,
         0,
         "0.7"},
        {"<mujoco><worldbody><body><geom type='mesh' mesh='m'/></body></worldbody></mujoco>",
         {0},
         RBD_MJCF_ERR_COMPILER,
         0,
         "'m'"},
        {"no xml at all", {0}, RBD_MJCF_ERR_COMPILER, 1, "MuJoCo"},
        {"<mujoco>\n<worldbody>\n<body\n</worldbody></mujoco>", {0}, RBD_MJCF_ERR_COMPILER, 3, "MuJoCo"},
        {"<mujoco>\n<worldbody>\n<body>\n<joint type='free'/><joint/>\n<geom "
         "size='1'/></body></worldbody></mujoco>",
         {0},
         RBD_MJCF_ERR_COMPILER,
         3,
         "dofs"},
        {"<mujoco><option gravity='0 0 nan'/><worldbody><body><joint/><geom "
         "size='1'/></body></worldbody></mujoco>",
         {0},
         RBD_MJCF_ERR_MODEL,
         0,
         "gravity"},
        {"<mujoco><worldbody><body name='b'><joint/><geom size='1'/></body></worldbody><equality><connect "
         "name='pin' "
         "body1='b' anchor='0 0 0' solref='nan 1'/></equality></mujoco>",
         {0},
         RBD_MJCF_ERR_MODEL,
         0,
         "'pin': solref"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rbd_mjcf r = with_room(&x);
        ck_assert_int_eq(parse(&r, cases[i].text, &cases[i].options), cases[i].status);
        ck_assert_int_eq(r.error.status, cases[i].status);
        ck_assert_msg(strstr(r.error.text, cases[i].part) != NULL, "%s", r.error.text);
        if (cases[i].line) ck_assert_int_eq(r.error.line, cases[i].line);
        ck_assert_str_ne(rbd_mjcf_status_string(r.error.status), "unknown status");
    }
}
END_TEST

START_TEST(bad_calls_are_refused) {
    static room x;
    rbd_mjcf r = with_room(&x);
    const rbd_mjcf_options held = {.lock = held_leader};
    ck_assert_int_eq(rbd_mjcf_load("x.xml", NULL, NULL), RBD_MJCF_ERR_NULL);
    ck_assert_int_eq(rbd_mjcf_parse("", 0, NULL, NULL), RBD_MJCF_ERR_NULL);
    ck_assert_int_eq(rbd_mjcf_convert(NULL, NULL, NULL), RBD_MJCF_ERR_NULL);
    ck_assert_int_eq(rbd_mjcf_load(NULL, NULL, &r), RBD_MJCF_ERR_NULL);
    ck_assert_int_eq(rbd_mjcf_parse(NULL, 1, NULL, &r), RBD_MJCF_ERR_NULL);
    ck_assert_int_eq(rbd_mjcf_convert(NULL, NULL, &r), RBD_MJCF_ERR_NULL);
    ck_assert_int_eq(rbd_mjcf_load("/no/such.xml", NULL, &r), RBD_MJCF_ERR_FILE);
    ck_assert_str_eq(r.error.text, "the file '/no/such.xml' cannot be read: No such file or directory");
    ck_assert_int_eq(rbd_mjcf_load("/", NULL, &r), RBD_MJCF_ERR_FILE);
    ck_assert_int_eq(rbd_mjcf_load("/dev/null", NULL, &r), RBD_MJCF_ERR_COMPILER);
    r = loaded_from(&x, "equalities", &held);
    ck_assert_int_eq(body_of(&r, "right_b")->type, RBD_FIXED); /* it mimics one that is held */
    static const rbd_mjcf_lock mimic[] = {{"right_a", 0}, {NULL, 0}};
    const rbd_mjcf_options wrong = {.lock = mimic};
    ck_assert_int_eq(rbd_mjcf_load(path_of("equalities"), &wrong, &r), RBD_MJCF_ERR_OPTION);
    ck_assert_str_eq(r.error.text, "lock: joint 'right_a' mimics 'left_a': hold that one still");
    ck_assert_str_eq(rbd_mjcf_status_string((rbd_mjcf_status)99), "unknown status");
}
END_TEST

START_TEST(short_arrays_are_refused) {
    static room x;
    rbd_mjcf count, r;
    memset(&count, 0, sizeof count);
    ck_assert_int_eq(rbd_mjcf_load(path_of("equalities"), NULL, &count), RBD_MJCF_OK);
    r = loaded_from(&x, "equalities", NULL);
    ck_assert_int_eq(count.nb, r.nb);
    ck_assert_int_eq(count.nframes, r.nframes);
    ck_assert_int_eq(count.nconstraints, r.nconstraints);
    ck_assert_int_eq(count.nwarnings, r.nwarnings);
    ck_assert_int_eq((int)count.names_size, (int)r.names_size);
    for (int i = 0; i < 6; i++) {
        r = with_room(&x);
        r.bodies_max = count.nb - (i == 1);
        r.names_max = count.names_size - (i == 2);
        r.frames_max = count.nframes - (i == 3);
        r.places_max = count.nb - (i == 4);
        r.constraints_max = count.nconstraints - (i == 5);
        ck_assert_int_eq(rbd_mjcf_load(path_of("equalities"), NULL, &r), i ? RBD_MJCF_ERR_ROOM : RBD_MJCF_OK);
    }
    for (int i = 0; i < 4; i++) {
        r = with_room(&x);
        *(i == 0 ? &r.bodies_max : i == 1 ? &r.frames_max : i == 2 ? &r.places_max : &r.constraints_max) = -1;
        ck_assert_int_eq(rbd_mjcf_load(path_of("equalities"), NULL, &r), RBD_MJCF_ERR_ROOM);
    }
}
END_TEST

/* Any beginning of a file, and a file with any piece taken out, gives a result or an error. */
START_TEST(broken_files_are_refused) {
    static room x;
    static char text[20000], broken[20000];
    FILE *file = fopen(path_of(files[_i]), "rb");
    size_t length;
    int errors = 0;
    ck_assert_ptr_nonnull(file);
    length = fread(text, 1, sizeof text, file);
    fclose(file);
    for (size_t cut = 1; cut < length; cut += 37) {
        rbd_mjcf r = with_room(&x);
        const size_t gap = cut % 23 + 1, rest = length > cut + gap ? length - cut - gap : 0;
        errors += rbd_mjcf_parse(text, cut, NULL, &r) != RBD_MJCF_OK;
        memcpy(broken, text, cut);
        memcpy(broken + cut, text + cut + gap, rest);
        if (rbd_mjcf_parse(broken, cut + rest, NULL, &r) != RBD_MJCF_OK) ck_assert_str_ne(r.error.text, "");
    }
    ck_assert_int_gt(errors, 20);
}
END_TEST

/* ---- MuJoCo's handlers ---- */

static int allocations_left;
static void *scarce(size_t size) {
    return allocations_left-- > 0 ? aligned_alloc(64, (size + 63) / 64 * 64) : NULL;
}
static void foreign_handler(const char *text) { (void)text; }

/* MuJoCo ends the program when it has no memory, unless its error is caught. The handlers come back. */
START_TEST(errors_of_mujoco_end_no_program) {
    static room x;
    rbd_mjcf r = with_room(&x);
    int errors = 0;
    mju_user_error = foreign_handler;
    mju_user_warning = foreign_handler;
    mju_user_malloc = scarce;
    mju_user_free = free;
    for (int n = 0; n < 3; n++) {
        allocations_left = n;
        errors += rbd_mjcf_load(path_of("geoms"), NULL, &r) == RBD_MJCF_ERR_COMPILER;
    }
    ck_assert_int_gt(errors, 0);
    ck_assert(mju_user_error == foreign_handler);
    ck_assert(mju_user_warning == foreign_handler);
    mju_user_malloc = NULL;
    mju_user_free = NULL;
}
END_TEST

int main(void) {
    Suite *s = suite_create("mjcf");
    TCase *c = tcase_create("mjcf"), *scarcity = tcase_create("scarce");
    SRunner *runner;
    int failed;
    tcase_set_timeout(c, 100);
    tcase_add_loop_test(c, dynamics_are_those_of_mujoco, 0, FILES);
    tcase_add_loop_test(c, dynamics_are_those_of_mujoco_with_options, 0, WAYS);
    tcase_add_test(c, no_coordinate_is_lost);
    tcase_add_test(c, joints_have_what_the_file_says);
    tcase_add_test(c, dofs_of_a_free_joint_are_in_order);
    tcase_add_test(c, a_joint_is_as_strong_as_its_actuators);
    tcase_add_test(c, links_and_frames_have_names);
    tcase_add_test(c, names_that_are_taken_get_underscores);
    tcase_add_test(c, classes_and_degrees_are_resolved);
    tcase_add_test(c, the_total_mass_is_set);
    tcase_add_test(c, gravity_can_be_off_or_given);
    tcase_add_test(c, joint_equalities_are_mimics);
    tcase_add_test(c, circles_of_equalities_are_cut);
    tcase_add_test(c, connect_and_weld_are_those_of_mujoco);
    tcase_add_test(c, welds_hold_the_reference);
    tcase_add_test(c, what_is_left_out_is_named);
    tcase_add_test(c, nameless_things_are_called_by_their_kind);
    tcase_add_test(c, long_lists_of_names_are_counted);
    tcase_add_test(c, states_are_converted);
    tcase_add_test(c, errors_say_what_is_wrong);
    tcase_add_test(c, bad_calls_are_refused);
    tcase_add_test(c, short_arrays_are_refused);
    tcase_add_loop_test(c, broken_files_are_refused, 0, FILES);
    tcase_add_test(scarcity, errors_of_mujoco_end_no_program);
    suite_add_tcase(s, c);
    suite_add_tcase(s, scarcity);
    runner = srunner_create(s);
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
