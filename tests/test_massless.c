/* test_massless.c - models for kinematics alone: joints that move no mass. */
#include <string.h>

#include "rbd_contact.h"
#include "rbd_derivatives.h"
#include "rbd_ik.h"

#include "suites.h"
#include "support.h"

/* A robot built for kinematics alone; the bodies must stay. */
static robot build_kinematic(const char *name, const rbd_body *bodies, int nb) {
    robot r = {.name = name, .bodies = bodies, .nb = nb};
    rbd_report report;
    char text[200];
    const size_t size = rbd_model_size(bodies, nb);
    r.memory[0] = malloc(size);
    const rbd_status status = rbd_model_build_kinematic(bodies, nb, r.memory[0], size, &r.m, &report);
    ck_assert_msg(status == RBD_OK, "%s: %s", name, rbd_finding_text(&report.error, text, sizeof text));
    r.nq = rbd_nq(r.m);
    r.nv = rbd_nv(r.m);
    r.memory[1] = malloc(rbd_work_size(r.m));
    ck_assert_int_eq(rbd_work_init(r.m, r.memory[1], rbd_work_size(r.m), &r.w), RBD_OK);
    return r;
}

/* ---- kinematics does not know of masses ---- */

enum { MAX_J = 6 * MAX_V };

/* The pose, velocity and acceleration of a body, and its Jacobian in world axes. */
static void motions(const robot *r, const state *s, int number, int body, double x[24], double *J) {
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, s->a));
    RUN(rbd_body_pose(r->m, r->w, body, x, x + 9));
    RUN(rbd_body_velocity(r->m, r->w, body, x + 12));
    RUN(rbd_body_acceleration(r->m, r->w, body, x + 18));
    RUN(rbd_jacobian(r->m, r->w, body, NULL, RBD_WORLD_AXES, J));
}

/* A random tree without masses moves as the same tree with them. */
static void check_motions(const robot *r, const state *s, int number) {
    rbd_body bare[MAX_BODIES];
    memcpy(bare, r->bodies, (size_t)r->nb * sizeof *bare);
    for (int i = 0; i < r->nb; i++) {
        bare[i].mass = 0;
        memset(bare[i].inertia, 0, sizeof bare[i].inertia);
        memset(bare[i].armature, 0, sizeof bare[i].armature);
    }
    robot other = build_kinematic("without masses", bare, r->nb);
    for (int i = 0; i < r->nb; i++) {
        double of_heavy[24], of_bare[24], J_heavy[MAX_J], J_bare[MAX_J];
        motions(r, s, number, i, of_heavy, J_heavy);
        motions(&other, s, number, i, of_bare, J_bare);
        expect_close("massless: motion", r, number, of_bare, of_heavy, 24, 1e-11);
        expect_close("massless: Jacobian", r, number, J_bare, J_heavy, 6 * r->nv, 1e-11);
    }
    if (r->nv) ck_assert_int_ge(rbd_singular_dof(other.w), 0);
    robot_free(&other);
}

START_TEST(trees_without_masses_move_as_with_them) { for_random_trees(100, check_motions); }
END_TEST

/* ---- an arm without masses, with a gripper of which one finger mimics the other ---- */

enum { SHOULDER, ELBOW, LEFT, RIGHT, NB };
static const rbd_body arm[NB] = {
    {.name = "upper", .joint = "shoulder", .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}},
    {.name = "lower",
     .joint = "elbow",
     .parent = 0,
     .type = RBD_REVOLUTE,
     .axis = {0, 1, 0},
     .position = {0.4, 0, 0.1},
     .lower = -2,
     .upper = 2},
    {.name = "left",
     .joint = "finger",
     .parent = 1,
     .type = RBD_PRISMATIC,
     .axis = {0, 1, 0},
     .position = {0.5, 0, 0}},
    {.name = "right",
     .parent = 1,
     .type = RBD_PRISMATIC,
     .axis = {0, -1, 0},
     .position = {0.5, 0, 0},
     .mimic = "finger",
     .mimic_ratio = 1}};

static void give_mass(rbd_body *b) {
    b->mass = 1;
    b->inertia[0] = b->inertia[3] = b->inertia[5] = 0.1;
}

static rbd_status build(const rbd_body *bodies, int kinematic, rbd_report *report) {
    static unsigned char memory[RBD_MODEL_SIZE(NB)];
    const rbd_model *m;
    return kinematic ? rbd_model_build_kinematic(bodies, NB, memory, sizeof memory, &m, report)
                     : rbd_model_build(bodies, NB, memory, sizeof memory, &m, report);
}

START_TEST(other_errors_are_those_of_any_build) {
    rbd_body b[NB];
    rbd_report report;
    memcpy(b, arm, sizeof b);
    b[LEFT].mimic = NULL;
    b[RIGHT].mimic = NULL; /* a leaf of its own */
    ck_assert_int_eq(build(b, 0, &report), RBD_ERR_LEAF);
    ck_assert_int_eq(build(b, 1, &report), RBD_OK);
    b[ELBOW].mass = -1;
    ck_assert_int_eq(build(b, 1, &report), RBD_ERR_MASS);
    ck_assert_int_eq(report.error.body, ELBOW);
    ck_assert_int_eq(rbd_model_build_kinematic(b, NB, NULL, 0, NULL, &report), RBD_ERR_NULL);
}
END_TEST

/* Inverse kinematics reaches what forward kinematics says, and refuses a centre of mass. */
START_TEST(inverse_kinematics_needs_no_mass) {
    static unsigned char memory[RBD_IK_SIZE(3, 4, 1)];
    robot r = build_kinematic("arm", arm, NB);
    const double there[3] = {0.3, -0.7, 0.02};
    double q[3] = {0, 0, 0.01}, place[3], found[3];
    rbd_ik_target target = {.kind = RBD_IK_POINT, .body = LEFT};
    rbd_ik_result result;
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, there, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, LEFT, NULL, place), RBD_OK);
    memcpy(target.position, place, sizeof place);
    ck_assert_int_eq(rbd_ik(r.m, r.w, &target, 1, NULL, memory, sizeof memory, q, &result), RBD_IK_REACHED);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, LEFT, NULL, found), RBD_OK);
    for (int i = 0; i < 3; i++) ck_assert_double_eq_tol(found[i], place[i], 1e-7);

    target.kind = RBD_IK_COM;
    ck_assert_int_eq(rbd_ik(r.m, r.w, &target, 1, NULL, memory, sizeof memory, q, &result), RBD_IK_ERROR);
    ck_assert_int_eq(result.error, RBD_ERR_MASS);
    robot_free(&r);

    rbd_body partly[NB]; /* only the upper arm is known */
    memcpy(partly, arm, sizeof partly);
    give_mass(&partly[SHOULDER]);
    r = build_kinematic("arm, partly", partly, NB);
    ck_assert_int_eq(rbd_ik(r.m, r.w, &target, 1, NULL, memory, sizeof memory, q, &result), RBD_IK_ERROR);
    ck_assert_int_eq(result.error, RBD_ERR_MASSLESS);
    robot_free(&r);
}
END_TEST

/* ---- calls that need masses refuse, and name the joint ---- */

#define REFUSED(call) ck_assert_msg((call) == RBD_ERR_MASSLESS, "%s", #call)

/* Every call of rbd.h that needs masses. */
static void refuse_dynamics(const robot *r) {
    const double q[3] = {0.3, -0.7, 0.02}, v[3] = {1, 2, 3}, t = 1e-3;
    const unsigned char given[3] = {1, 0, 0};
    const rbd_model *m = r->m;
    rbd_work *w = r->w;
    double a[3] = {0}, x[3] = {0}, y[36];
    REFUSED(rbd_rnea(m, w, q, v, v, NULL, y));
    REFUSED(rbd_bias(m, w, q, v, NULL, y));
    REFUSED(rbd_gravity_torque(m, w, q, y));
    REFUSED(rbd_generalized_momentum(m, w, q, v, y, y));
    REFUSED(rbd_crba(m, w, q, y));
    REFUSED(rbd_crba_packed(m, w, q, y));
    REFUSED(rbd_aba(m, w, q, v, v, NULL, y));
    REFUSED(rbd_fd_cholesky(m, w, q, v, v, NULL, y));
    REFUSED(rbd_hybrid(m, w, q, v, given, a, x, NULL));
    REFUSED(rbd_minverse(m, w, q, y));
    REFUSED(rbd_cholesky_factor(m, w, y, y));
    REFUSED(rbd_cholesky_factor_packed(m, w, y));
    REFUSED(rbd_free_step(m, w, q, v, v, NULL, NULL, t, a, x));
    REFUSED(rbd_joint_wrench(m, w, q, v, v, NULL, y));
    ck_assert_int_eq(rbd_kinematics(m, w, q, v, NULL), RBD_OK);
    REFUSED(rbd_energy(m, w, &a[0], &a[1]));
    REFUSED(rbd_com(m, w, a, NULL, NULL));
    REFUSED(rbd_momentum(m, w, y, NULL));
    ck_assert_int_eq(rbd_passive(m, w, v, a), RBD_OK); /* damping and friction are no masses */
}

/* Those of rbd_derivatives.h; derivatives of Jacobians are kinematics. */
static void refuse_derivatives(const robot *r) {
    const double q[3] = {0.3, -0.7, 0.02}, v[3] = {1, 2, 3};
    const rbd_model *m = r->m;
    void *memory = malloc(rbd_derivatives_size(m));
    rbd_derivatives *d;
    double x[3], y[60];
    ck_assert_int_eq(rbd_derivatives_init(m, r->w, memory, rbd_derivatives_size(m), &d), RBD_OK);
    REFUSED(rbd_momentum_matrix(m, d, q, NULL, y, NULL));
    REFUSED(rbd_com_jacobian(m, d, q, y));
    REFUSED(rbd_coriolis(m, d, q, v, y));
    REFUSED(rbd_id_derivatives(m, d, q, v, v, NULL, x, y, y + 9));
    REFUSED(rbd_gravity_torque_derivatives(m, d, q, y));
    ck_assert_int_eq(rbd_kinematics(m, r->w, q, v, NULL), RBD_OK);
    ck_assert_int_eq(rbd_jacobian_derivative(m, r->w, LEFT, NULL, RBD_WORLD_AXES, y), RBD_OK);
    free(memory);
}

/* Those of constraints and contacts; rows and assembly are kinematics. */
static void refuse_constraints(const robot *r) {
    const double q[3] = {0.3, -0.7, 0.02}, v[3] = {1, 2, 3}, origin[3] = {0, 0, 0};
    const double near[3] = {0.4, -0.6, 0.03};
    double place[3];
    ck_assert_int_eq(rbd_kinematics(r->m, r->w, near, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r->m, r->w, LEFT, NULL, place), RBD_OK);
    const rbd_constraint pin = rbd_point_contact(LEFT, origin, place);
    const rbd_contact touch = {.body1 = LEFT, .body2 = -1, .normal = {0, 0, 1}};
    const size_t size = rbd_constraint_set_size(r->m, &pin, 1);
    const size_t more = rbd_contact_set_size(r->m, 1, NULL, 0, NULL);
    void *memory = malloc(size), *contact_memory = malloc(more);
    rbd_constraint_set *c;
    rbd_contact_set *contacts;
    double a[3], x[3], J[9];
    ck_assert_int_eq(rbd_constraint_set_init(r->m, r->w, &pin, 1, memory, size, &c, NULL), RBD_OK);
    ck_assert_int_eq(rbd_constraint_jacobian(r->m, c, q, NULL, J, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_assemble(r->m, c, q, NULL, NULL, a, NULL), RBD_OK);
    REFUSED(rbd_constrained_fd(r->m, c, q, v, v, NULL, a, NULL));
    REFUSED(rbd_impact(r->m, c, q, v, 0, a, NULL));
    REFUSED(rbd_constrained_id(r->m, c, q, v, v, NULL, NULL, NULL, a, NULL));

    ck_assert_int_eq(
        rbd_contact_set_init(r->m, r->w, &touch, 1, NULL, 0, NULL, contact_memory, more, &contacts, NULL),
        RBD_OK);
    REFUSED(rbd_contact_step(r->m, contacts, q, v, v, NULL, NULL, 1e-3, a, x));
    REFUSED(rbd_contact_fd(r->m, contacts, q, v, v, NULL, NULL, 1e-3, a));
    free(contact_memory);
    free(memory);
}

START_TEST(dynamics_is_refused) {
    robot r = build_kinematic("arm", arm, NB);
    refuse_dynamics(&r);
    refuse_derivatives(&r);
    refuse_constraints(&r);
    robot_free(&r);
}
END_TEST

/* The first dof that moves no mass, -1 if dynamics is computed. */
static int refused_at(const rbd_body *bodies) {
    robot r = build_kinematic("arm", bodies, NB);
    const double q[3] = {0.3, -0.7, 0.02};
    double M[9];
    const rbd_status status = rbd_crba(r.m, r.w, q, M);
    const int dof = rbd_singular_dof(r.w);
    ck_assert_int_eq(status, dof < 0 ? RBD_OK : RBD_ERR_MASSLESS);
    robot_free(&r);
    return dof;
}

START_TEST(the_first_joint_that_moves_no_mass_is_named) {
    rbd_body b[NB];
    memcpy(b, arm, sizeof b);
    ck_assert_int_eq(refused_at(b), 0);
    b[ELBOW].armature[0] = 1; /* a rotor of the elbow: the shoulder does not turn it about its own axis */
    ck_assert_int_eq(refused_at(b), 0);
    b[SHOULDER].armature[0] = 1;
    ck_assert_int_eq(refused_at(b), 2);
    b[RIGHT].armature[0] = 1; /* which moves as the left finger does */
    ck_assert_int_eq(refused_at(b), -1);
    memcpy(b, arm, sizeof b);
    give_mass(&b[ELBOW]); /* the shoulder moves it too */
    ck_assert_int_eq(refused_at(b), 2);
    give_mass(&b[RIGHT]);
    ck_assert_int_eq(refused_at(b), -1);

    memcpy(b, arm, sizeof b);
    b[ELBOW].inertia[0] = b[ELBOW].inertia[3] = b[ELBOW].inertia[5] =
        0.1; /* and inertia without mass counts */
    ck_assert_int_eq(refused_at(b), 2);

    memcpy(b, arm, sizeof b);
    give_mass(&b[LEFT]); /* the right finger mimics it */
    ck_assert_int_eq(refused_at(b), -1);
    memcpy(b, arm, sizeof b);
    give_mass(&b[ELBOW]);
    b[RIGHT].joint = "right finger"; /* which leads now: its dof is named, though the left one comes first */
    b[RIGHT].mimic = NULL;
    b[LEFT].mimic = "right finger";
    b[LEFT].mimic_ratio = 1;
    ck_assert_int_eq(refused_at(b), 2);
}
END_TEST

/* A body that is fixed to another gives it its mass; a free base without any is the first to be named. */
START_TEST(fixed_bodies_and_bases_count) {
    rbd_body b[NB];
    memcpy(b, arm, sizeof b);
    b[LEFT].type = b[RIGHT].type = RBD_FIXED;
    memset(b[LEFT].axis, 0, sizeof b[LEFT].axis);
    memset(b[RIGHT].axis, 0, sizeof b[RIGHT].axis);
    b[RIGHT].mimic = NULL;
    ck_assert_int_eq(refused_at(b), 0);
    give_mass(&b[RIGHT]);
    ck_assert_int_eq(refused_at(b), -1);
    memcpy(b, arm, sizeof b);
    b[SHOULDER].type = RBD_FLOATING;
    memset(b[SHOULDER].axis, 0, sizeof b[SHOULDER].axis);
    robot r = build_kinematic("free arm", b, NB);
    ck_assert_int_eq(rbd_singular_dof(r.w), 0);
    robot_free(&r);
}
END_TEST

/* ---- a robot whose joints all move mass is what rbd_model_build makes ---- */

static void check_same(const robot *r, const state *s, int number) {
    double tau[MAX_V], other_tau[MAX_V];
    robot other = build_kinematic(r->name, r->bodies, r->nb);
    if (rbd_singular_dof(other.w) < 0) { /* of random trees some joints move no mass */
        RUN(rbd_set_gravity(other.w, s->gravity));
        RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, tau));
        RUN(rbd_rnea(other.m, other.w, s->q, s->v, s->a, s->f_ext, other_tau));
        ck_assert_mem_eq(tau, other_tau, (size_t)r->nv * sizeof *tau);
    }
    robot_free(&other);
}

START_TEST(robots_with_masses_are_as_ever) { for_random_states(2, check_same); }
END_TEST

/* A work tells the joint without mass: so it is of no use for a model that has masses, and the reverse. */
START_TEST(a_work_of_the_other_kind_is_refused) {
    rbd_body b[NB];
    memcpy(b, arm, sizeof b);
    robot bare = build_kinematic("arm", arm, NB);
    for (int i = 0; i < NB; i++) give_mass(&b[i]);
    robot heavy = build_kinematic("heavy", b, NB);
    const double q[3] = {0};
    double g[3];
    ck_assert_int_eq(rbd_gravity_torque(heavy.m, bare.w, q, g), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_gravity_torque(bare.m, heavy.w, q, g), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_kinematics(bare.m, heavy.w, q, NULL, NULL), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_gravity_torque(heavy.m, heavy.w, q, g), RBD_OK);
    robot_free(&bare);
    robot_free(&heavy);
}
END_TEST

/* A payload makes no model with dynamics of one for kinematics alone, even if each joint moves mass then; its
   body has it, and poses stay. A new build has dynamics. */
START_TEST(a_payload_gives_no_dynamics) {
    const double com[3] = {0.1, 0.2, 0.3}, q[3] = {0.3, -0.7, 0.02}, inertia[6] = {0.1, 0, 0, 0.1, 0, 0.1};
    robot r = build_kinematic("arm", arm, NB);
    double before[3], after[3], pi[10], g[3];
    rbd_report report;
    rbd_body b[NB];

    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, LEFT, NULL, before), RBD_OK);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], LEFT, 2, com, inertia), RBD_OK);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], RIGHT, 2, com, inertia), RBD_OK);
    REFUSED(rbd_gravity_torque(r.m, r.w, q, g));
    refuse_dynamics(&r);

    ck_assert_int_eq(rbd_body_parameters(r.m, LEFT, pi), RBD_OK);
    ck_assert_double_eq_tol(pi[0], 2, 1e-15);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, LEFT, NULL, after), RBD_OK);
    for (int i = 0; i < 3; i++) ck_assert_double_eq(after[i], before[i]);

    for (int i = 0; i < NB; i++) ck_assert_int_eq(rbd_describe(r.m, i, &b[i]), RBD_OK);
    ck_assert_int_eq(build(b, 0, &report), RBD_OK);
    robot_free(&r);
}
END_TEST

Suite *massless_suite(void) {
    Suite *suite = suite_create("massless");
    TCase *c = tcase_create("massless");
    tcase_add_test(c, trees_without_masses_move_as_with_them);
    tcase_add_test(c, other_errors_are_those_of_any_build);
    tcase_add_test(c, inverse_kinematics_needs_no_mass);
    tcase_add_test(c, dynamics_is_refused);
    tcase_add_test(c, the_first_joint_that_moves_no_mass_is_named);
    tcase_add_test(c, fixed_bodies_and_bases_count);
    tcase_add_test(c, robots_with_masses_are_as_ever);
    tcase_add_test(c, a_work_of_the_other_kind_is_refused);
    tcase_add_test(c, a_payload_gives_no_dynamics);
    suite_add_tcase(suite, c);
    return suite;
}
