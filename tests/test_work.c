/* test_work.c - [work]: memory of the algorithms, gravity. */
#include <fenv.h>
#include <string.h>

#include "suites.h"
#include "support.h"

START_TEST(memory_one_byte_too_small_is_refused) {
    for (int i = 0; i < reference_count; i++) {
        const ref_model *model = reference_model(i);
        robot r = robot_build(model->name, model->bodies, model->nb);
        rbd_work *w = r.w;
        const size_t size = rbd_work_size(r.m);
        ck_assert_uint_gt(size, 0);
        ck_assert_msg(size <= RBD_WORK_SIZE((size_t)r.nb, (size_t)r.nv), "%s", r.name);
        void *memory = malloc(size); /* exact, so that a sanitizer sees the byte beyond */
        ck_assert_int_eq(rbd_work_init(r.m, memory, size - 1, &w), RBD_ERR_MEMORY);
        ck_assert_ptr_null(w);
        ck_assert_int_eq(rbd_work_init(r.m, memory, 0, &w), RBD_ERR_MEMORY);
        ck_assert_int_eq(rbd_work_init(r.m, memory, size, &w), RBD_OK);
        free(memory);
        robot_free(&r);
    }
}
END_TEST

/* The sizes for arrays suffice for the memory that the exact figures ask for. */
static void expect_bounds(const robot *r) {
    const size_t nb = (size_t)r->nb, nv = (size_t)r->nv, work = rbd_work_size(r->m);
    int mimics = 0;
    for (int i = 0; i < r->nb; i++) mimics += r->bodies[i].mimic != NULL;
    const size_t bound = mimics ? RBD_WORK_SIZE_MIMIC(nb, nv) : RBD_WORK_SIZE(nb, nv);
    ck_assert_msg(work <= bound, "%s: work of %zu bytes, %zu promised", r->name, work, bound);
    ck_assert_uint_le(work, RBD_WORK_SIZE_MIMIC(nb, nv));
    ck_assert_uint_le(rbd_model_size(r->bodies, r->nb), RBD_MODEL_SIZE(nb));
}

static void check_bounds(const robot *r, const state *s, int number) {
    (void)s, (void)number;
    expect_bounds(r);
}

START_TEST(sizes_at_compile_time_suffice) {
    for_random_trees(500, check_bounds);
    for (int type = RBD_FIXED; type < RBD_JOINT_TYPES; type++) /* the dearest: all of one type */
        for (int nb = 1; nb <= 10; nb++) {
            uint64_t seed = 31;
            rbd_body b[10];
            for (int i = 0; i < nb; i++) {
                random_joint(&seed, b, i, (rbd_joint_type)type);
                random_mass(&seed, &b[i]);
            }
            robot r = robot_build("bodies on one type of joint", b, nb);
            expect_bounds(&r);
            robot_free(&r);
        }
}
END_TEST

static void run_everything(const rbd_model *m, rbd_work *w, double *out) {
    static double M[MAX_V * MAX_V];
    double q[MAX_Q], v[MAX_V] = {0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7}, f_ext[6 * MAX_BODIES] = {1, 2, 3};
    uint64_t seed = 3;
    ck_assert_int_eq(rbd_random(m, &seed, q), RBD_OK);
    ck_assert_int_eq(rbd_rnea(m, w, q, v, v, f_ext, out), RBD_OK);
    ck_assert_int_eq(rbd_crba(m, w, q, M), RBD_OK);
    ck_assert_int_eq(rbd_fd_cholesky(m, w, q, v, out, f_ext, out), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(m, w, q, v, v), RBD_OK);
    ck_assert_int_eq(rbd_aba(m, w, q, v, v, f_ext, out), RBD_OK);
}

/* Memory of any alignment and any content; nothing is written outside it, nor into the model. */
START_TEST(memory_of_any_alignment_and_content_suffices) {
    const ref_model *model = reference_model(1);
    robot r = robot_build(model->name, model->bodies, model->nb);
    const size_t size = rbd_work_size(r.m), model_size = rbd_model_size(model->bodies, model->nb);
    unsigned char *memory = malloc(size + 64), *before = malloc(model_size);
    double first[MAX_V], out[MAX_V];
    memcpy(before, r.memory[0], model_size);
    run_everything(r.m, r.w, first);
    for (size_t shift = 0; shift < 32; shift++) {
        rbd_work *w;
        memset(memory, 0xff, size + 64); /* as double: NaN */
        ck_assert_int_eq(rbd_work_init(r.m, memory + shift, size, &w), RBD_OK);
        run_everything(r.m, w, out);
        ck_assert_int_eq(memcmp(out, first, (size_t)r.nv * sizeof(double)), 0);
        for (size_t i = 0; i < size + 64; i++)
            if (i < shift || i >= shift + size)
                ck_assert_msg(memory[i] == 0xff, "byte %d is written", (int)i);
    }
    ck_assert_msg(memcmp(before, r.memory[0], model_size) == 0, "the model is written");
    free(memory);
    free(before);
    robot_free(&r);
}
END_TEST

#ifdef FE_INVALID
/* Nor does what was there before get into the arithmetic, where it could trap: signalling NaNs. */
START_TEST(memory_raises_no_floating_point_exception) {
    const uint64_t nan = UINT64_C(0x7ff0000000000001);
    for (int i = 0; i < reference_count; i++) {
        const ref_model *model = reference_model(i);
        robot r = robot_build(model->name, model->bodies, model->nb);
        const size_t size = rbd_work_size(r.m);
        unsigned char *memory = malloc(size);
        double out[MAX_V];
        rbd_work *w;
        for (size_t at = 0; at + sizeof nan <= size; at += sizeof nan) memcpy(memory + at, &nan, sizeof nan);
        ck_assert_int_eq(rbd_work_init(r.m, memory, size, &w), RBD_OK);
        feclearexcept(FE_ALL_EXCEPT);
        run_everything(r.m, w, out);
        ck_assert_msg(!fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), "%s", r.name);
        free(memory);
        robot_free(&r);
    }
}
END_TEST
#endif

START_TEST(null_arguments_are_refused) {
    robot r = robot_build("iiwa", reference_model(2)->bodies, reference_model(2)->nb);
    static unsigned char memory[RBD_WORK_SIZE(7, 7)];
    rbd_work *w = r.w;
    ck_assert_int_eq(rbd_work_init(NULL, memory, sizeof memory, &w), RBD_ERR_NULL);
    ck_assert_ptr_null(w);
    w = r.w;
    ck_assert_int_eq(rbd_work_init(r.m, NULL, sizeof memory, &w), RBD_ERR_NULL);
    ck_assert_ptr_null(w);
    ck_assert_int_eq(rbd_work_init(r.m, memory, sizeof memory, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_set_gravity(NULL, earth), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_set_gravity(r.w, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_singular_dof(NULL), -1);
    ck_assert_int_eq(rbd_singular_dof(r.w), -1);
    ck_assert_uint_eq(rbd_work_size(NULL), 0);
    robot_free(&r);
}
END_TEST

/* ---- nothing moves: nv = 0 ---- */

enum { STILL_NB = 3 };
static const rbd_body still[STILL_NB] = {
    {.name = "mast", .parent = -1, .position = {0, 0, 2}, .mass = 3, .inertia = {1, 0, 0, 1, 0, 1}},
    {.name = "arm",
     .parent = 0,
     .position = {1, 0, 0},
     .rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1},
     .mass = 1,
     .inertia = {1, 0, 0, 1, 0, 1}},
    {.name = "camera", .parent = 1, .position = {0, 0.5, 0}}};

/* Coordinates: an array of none, so that a sanitizer sees any access. */
static void still_dynamics(const robot *r, double *none, double *f_ext) {
    const int number = 0;
    RUN(rbd_rnea(r->m, r->w, none, none, none, NULL, none));
    RUN(rbd_rnea(r->m, r->w, none, none, none, f_ext, none));
    RUN(rbd_bias(r->m, r->w, none, none, f_ext, none));
    RUN(rbd_gravity_torque(r->m, r->w, none, none));
    RUN(rbd_crba(r->m, r->w, none, none));
    RUN(rbd_crba_packed(r->m, r->w, none, none));
    RUN(rbd_aba(r->m, r->w, none, none, none, f_ext, none));
    RUN(rbd_fd_cholesky(r->m, r->w, none, none, none, f_ext, none));
    RUN(rbd_cholesky_factor(r->m, r->w, none, none));
    RUN(rbd_cholesky_factor_packed(r->m, r->w, none));
    RUN(rbd_cholesky_solve(r->m, r->w, none, none, none));
    RUN(rbd_cholesky_solve_many(r->m, r->w, none, 2, none, none));
    RUN(rbd_minverse(r->m, r->w, none, none));
    RUN(rbd_passive(r->m, r->w, none, none));
    ck_assert_int_eq(rbd_singular_dof(r->w), -1);
    ck_assert_int_eq(rbd_packed_size(r->m), 0);
    ck_assert_int_eq(rbd_packed_index(r->m, 0, 0), -1);
}

static void still_kinematics(const robot *r, double *none) {
    const int number = 0;
    const double place[STILL_NB][3] = {{0, 0, 2}, {1, 0, 2}, {0.5, 0, 2}}, zero[9] = {0};
    double p[3], x[6], energy[2], com[9];
    RUN(rbd_kinematics(r->m, r->w, none, none, none));
    RUN(rbd_kinematics(r->m, r->w, none, NULL, NULL));
    for (int i = 0; i < STILL_NB; i++) {
        RUN(rbd_body_pose(r->m, r->w, i, NULL, p));
        expect_close("what is fixed: p", r, i, p, place[i], 3, 1e-15);
        RUN(rbd_body_velocity(r->m, r->w, i, x));
        ck_assert(!(largest(x, 6) > 0));
        RUN(rbd_body_acceleration(r->m, r->w, i, x));
        ck_assert(!(largest(x, 6) > 0));
        RUN(rbd_body_acceleration_classical(r->m, r->w, i, x));
        ck_assert(!(largest(x, 6) > 0));
    }
    RUN(rbd_energy(r->m, r->w, &energy[0], &energy[1])); /* of what a joint moves */
    RUN(rbd_com(r->m, r->w, com, com + 3, com + 6));
    expect_close("what is fixed: energy", r, 0, energy, zero, 2, 1e-15);
    expect_close("what is fixed: com", r, 0, com, zero, 9, 1e-15);
    ck_assert(!(rbd_mass(r->m) > 0));
}

START_TEST(fixed_bodies_alone_are_a_model) {
    robot r = BUILD(still); /* whose work has exactly rbd_work_size bytes, not written before */
    const int number = 0;
    double edge[1] = {0}, f_ext[6 * STILL_NB] = {1, 2, 3, 4, 5, 6};
    double *none = edge + 1;
    uint64_t seed = 1;
    ck_assert_int_eq(r.nq, 0);
    ck_assert_int_eq(r.nv, 0);
    still_dynamics(&r, none, f_ext);
    still_kinematics(&r, none);
    expect_ok("neutral", &r, number, rbd_neutral(r.m, none));
    expect_ok("integrate", &r, number, rbd_integrate(r.m, none, none, 0.1, none));
    expect_ok("difference", &r, number, rbd_difference(r.m, none, none, none));
    expect_ok("random", &r, number, rbd_random(r.m, &seed, none));
    robot_free(&r);
}
END_TEST

/* Memory that was never built has no version. */
START_TEST(what_is_not_a_model_is_refused) {
    static const double nothing[RBD_MODEL_SIZE(1) / sizeof(double)] = {0};
    static unsigned char memory[RBD_WORK_SIZE(1, 1)];
    rbd_work *w;
    ck_assert_int_eq(rbd_work_init((const rbd_model *)(const void *)nothing, memory, sizeof memory, &w),
                     RBD_ERR_VERSION);
}
END_TEST

START_TEST(gravity_is_earth_s_until_set) {
    const ref_model *model = reference_model(0);
    robot r = robot_build(model->name, model->bodies, model->nb);
    const double moon[3] = {0.1, 0.2, -1.62};
    double g[MAX_V], expected[MAX_V], lunar[MAX_V];
    tb_real tb[TB_MAX_DOFS];
    const double rest[MAX_V] = {0}, *q = model->states[1].q;
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, q, g), RBD_OK);
    tb_rnea(r.bodies, r.nb, earth, q, rest, rest, NULL, tb, NULL);
    expect_close_tb("gravity by default", &r, 1, g, tb, r.nv, 1e-13);
    ck_assert_int_eq(rbd_set_gravity(r.w, moon), RBD_OK);
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, q, lunar), RBD_OK);
    tb_rnea(r.bodies, r.nb, moon, q, rest, rest, NULL, tb, NULL);
    expect_close_tb("gravity that was set", &r, 1, lunar, tb, r.nv, 1e-13);
    ck_assert_int_eq(rbd_set_gravity(r.w, earth), RBD_OK);
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, q, expected), RBD_OK);
    ck_assert_int_eq(memcmp(g, expected, (size_t)r.nv * sizeof *g), 0);
    robot_free(&r);
}
END_TEST

/* Two threads' works on one model do not know of each other. */
START_TEST(works_are_independent) {
    const ref_model *model = reference_model(0);
    robot r = robot_build(model->name, model->bodies, model->nb);
    const double none[3] = {0, 0, 0}, *q = model->states[1].q;
    double p[3], g[MAX_V];
    void *memory = malloc(rbd_work_size(r.m));
    rbd_work *other;
    ck_assert_int_eq(rbd_work_init(r.m, memory, rbd_work_size(r.m), &other), RBD_OK);
    ck_assert_int_eq(rbd_set_gravity(other, none), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(r.m, other, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, NULL, p), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_gravity_torque(r.m, other, q, g), RBD_OK);
    ck_assert(!(largest(g, r.nv) > 0));
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, q, g), RBD_OK);
    ck_assert(largest(g, r.nv) > 1);
    free(memory);
    robot_free(&r);
}
END_TEST

/* Else one model's calls would write beyond another's arrays. */
START_TEST(work_of_another_model_is_refused) {
    const ref_model *small = reference_model(0), *large = reference_model(2);
    robot r = robot_build(small->name, small->bodies, small->nb);
    robot other = robot_build(large->name, large->bodies, large->nb);
    double x[MAX_V * MAX_V] = {0}, *y = x;
    ck_assert_int_ne(r.nv, other.nv);
    ck_assert_int_eq(rbd_rnea(other.m, r.w, x, x, x, NULL, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_bias(other.m, r.w, x, x, NULL, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_gravity_torque(other.m, r.w, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_crba(other.m, r.w, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_crba_packed(other.m, r.w, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_aba(other.m, r.w, x, x, x, NULL, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_fd_cholesky(other.m, r.w, x, x, x, NULL, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_cholesky_factor(other.m, r.w, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_cholesky_factor_packed(other.m, r.w, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_cholesky_solve(other.m, r.w, x, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_cholesky_solve_many(other.m, r.w, x, 1, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_minverse(other.m, r.w, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_passive(other.m, r.w, x, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_kinematics(other.m, r.w, x, NULL, NULL), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_body_pose(other.m, r.w, 0, NULL, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_energy(other.m, r.w, y, y), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_com(other.m, r.w, y, y, y), RBD_ERR_WORK);
    robot_free(&other);
    robot_free(&r);
}
END_TEST

static rbd_body massive(rbd_joint_type type, int parent) {
    const rbd_body b = {.parent = parent,
                        .type = type,
                        .axis = {0, 0, 1},
                        .axis2 = {1, 0, 0},
                        .mass = 1,
                        .com = {0.1, 0.2, 0.3},
                        .inertia = {1, 0, 0, 1, 0, 1}};
    return b;
}

static void chain(rbd_body *b, const rbd_joint_type *types, int nb) {
    for (int i = 0; i < nb; i++) b[i] = massive(types[i], i - 1);
}

/* Two models that differ in one of the numbers that a work's arrays depend on, and in none before it. */
static void expect_apart(const char *number, const rbd_body *a, int a_nb, const rbd_body *b, int b_nb) {
    robot r = robot_build(number, a, a_nb), other = robot_build(number, b, b_nb);
    double q[MAX_Q] = {0}, g[MAX_V];
    ck_assert_msg(rbd_gravity_torque(r.m, other.w, q, g) == RBD_ERR_WORK, "%s", number);
    ck_assert_msg(rbd_gravity_torque(other.m, r.w, q, g) == RBD_ERR_WORK, "%s", number);
    robot_free(&r);
    robot_free(&other);
}

START_TEST(works_of_models_that_differ_in_one_number_are_refused) {
    rbd_body a[5], b[5];
    a[0] = massive(RBD_CONTINUOUS, -1), b[0] = massive(RBD_CONTINUOUS_CS, -1);
    b[1] = massive(RBD_FIXED, 0);
    b[1].axis[2] = 0;
    expect_apart("nb", a, 1, b, 2);
    expect_apart("nq", a, 1, b, 1);
    a[0] = massive(RBD_CYLINDRICAL, -1);
    expect_apart("nv", a, 1, b, 1);
    a[0] = massive(RBD_PLANAR, -1), b[0] = massive(RBD_EULER_XYZ, -1);
    expect_apart("nl", a, 1, b, 1);
    const rbd_joint_type balls[5] = {RBD_SPHERICAL, RBD_SPHERICAL, RBD_PLANAR, RBD_PLANAR, RBD_PLANAR};
    const rbd_joint_type free[5] = {RBD_FLOATING, RBD_FLOATING, RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE};
    chain(a, balls, 5), chain(b, free, 5);
    expect_apart("nblock", a, 5, b, 5);
    const rbd_joint_type hinges[5] = {RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE};
    chain(a, hinges, 3), chain(b, hinges, 3);
    b[2].parent = 0;
    expect_apart("nbranch", a, 3, b, 3);
    chain(a, hinges, 5), chain(b, hinges, 5);
    a[0].type = RBD_FLOATING, b[0].type = RBD_SPHERICAL;
    a[1].joint = "leader";
    for (int i = 2; i < 5; i++) a[i].mimic = "leader", a[i].mimic_ratio = 0.5;
    expect_apart("nmimic", a, 5, b, 5);
    chain(a, hinges, 2), chain(b, hinges, 2);
    b[1].parent = -1;
    expect_apart("nh", a, 2, b, 2);
}
END_TEST

START_TEST(model_of_another_version_or_scalar_is_refused) {
    robot r = robot_build("iiwa", reference_model(2)->bodies, reference_model(2)->nb);
    rbd_model other = *r.m;
    rbd_work *w;
    ck_assert_int_eq(rbd_work_init(&other, r.memory[1], rbd_work_size(r.m), &w), RBD_OK);
    other.version++;
    ck_assert_int_eq(rbd_work_init(&other, r.memory[1], rbd_work_size(r.m), &w), RBD_ERR_VERSION);
    other = *r.m;
    other.scalar = (int16_t)sizeof(float);
    ck_assert_int_eq(rbd_work_init(&other, r.memory[1], rbd_work_size(r.m), &w), RBD_ERR_VERSION);
    robot_free(&r);
}
END_TEST

/* A const table that two files include is there twice. */
START_TEST(work_serves_every_copy_of_its_model) {
    const ref_model *model = reference_model(0);
    robot r = robot_build(model->name, model->bodies, model->nb);
    robot copy = robot_build(model->name, model->bodies, model->nb);
    const double *q = model->states[1].q;
    double g[MAX_V], expected[MAX_V];
    ck_assert_ptr_ne(r.m, copy.m);
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, q, expected), RBD_OK);
    ck_assert_int_eq(rbd_gravity_torque(copy.m, r.w, q, g), RBD_OK);
    ck_assert_int_eq(memcmp(g, expected, (size_t)r.nv * sizeof *g), 0);
    robot_free(&copy);
    robot_free(&r);
}
END_TEST

/* The same address is not the same model. */
START_TEST(work_of_a_model_built_over_is_refused) {
    const ref_model *small = reference_model(0), *large = reference_model(2);
    const rbd_body mast = {.parent = -1, .mass = 1}, *bodies[] = {large->bodies, small->bodies, &mast};
    const int nb[] = {large->nb, small->nb, 1};
    void *memory = malloc(RBD_MODEL_SIZE(MAX_BODIES)), *work = malloc(RBD_WORK_SIZE(MAX_BODIES, MAX_V));
    double x[MAX_V * MAX_V] = {0}, y[MAX_V * MAX_V];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const rbd_status expected = i == j ? RBD_OK : RBD_ERR_WORK;
            const rbd_model *first, *second;
            rbd_work *w;
            ck_assert_int_eq(
                rbd_model_build(bodies[i], nb[i], memory, RBD_MODEL_SIZE(MAX_BODIES), &first, NULL), RBD_OK);
            ck_assert_int_eq(rbd_work_init(first, work, rbd_work_size(first), &w), RBD_OK);
            ck_assert_int_eq(
                rbd_model_build(bodies[j], nb[j], memory, RBD_MODEL_SIZE(MAX_BODIES), &second, NULL), RBD_OK);
            ck_assert_ptr_eq(first, second);
            ck_assert_int_eq(rbd_gravity_torque(second, w, x, y), expected);
            ck_assert_int_eq(rbd_crba(second, w, x, y), expected);
            ck_assert_int_eq(rbd_kinematics(second, w, x, NULL, NULL), expected);
        }
    free(work);
    free(memory);
}
END_TEST

/* Whatever the length of one array depends on. */
START_TEST(work_of_a_model_that_differs_in_one_count_is_refused) {
    enum { NB = 4 };
    const rbd_body rod = {.type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0.1, 0, 1}};
    /* rows: parents and types of as many bodies; the first is what the others are compared with */
    static const struct {
        int nb, parent[NB];
        rbd_joint_type type[NB];
        int mimics; /* the last body follows the first */
    } trees[] = {
        {3, {-1, 0, 1}, {RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE}, 0},
        {4, {-1, 0, 1, 2}, {RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE, RBD_FIXED}, 0}, /* nb */
        {3, {-1, 0, 1}, {RBD_REVOLUTE, RBD_REVOLUTE, RBD_CONTINUOUS_CS}, 0},          /* nq */
        {3, {-1, 0, 1}, {RBD_REVOLUTE, RBD_REVOLUTE, RBD_FIXED}, 0},                  /* nv, nl, nh */
        {3, {-1, 0, 0}, {RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE}, 0},               /* nbranch, nh */
        {3, {-1, -1, 1}, {RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE}, 0},              /* nh */
        {3, {-1, 0, 1}, {RBD_REVOLUTE, RBD_REVOLUTE, RBD_REVOLUTE}, 1},               /* nmimic */
        {3, {-1, 0, 1}, {RBD_TRANSLATION, RBD_FIXED, RBD_FIXED}, 0},                  /* nblock, nl */
    };
    enum { TREES = sizeof trees / sizeof *trees };
    void *memory[TREES];
    const rbd_model *m[TREES];
    double x[6] = {1, 0, 0, 0}, y[6];
    for (int t = 0; t < TREES; t++) {
        rbd_body b[NB];
        for (int i = 0; i < trees[t].nb; i++) {
            b[i] = rod;
            b[i].parent = trees[t].parent[i];
            b[i].type = trees[t].type[i];
            if (b[i].type == RBD_FIXED || b[i].type == RBD_TRANSLATION) b[i].axis[1] = 0;
        }
        b[0].joint = "first";
        if (trees[t].mimics) b[trees[t].nb - 1].mimic = "first", b[trees[t].nb - 1].mimic_ratio = 1;
        memory[t] = malloc(RBD_MODEL_SIZE(NB));
        ck_assert_int_eq(rbd_model_build(b, trees[t].nb, memory[t], RBD_MODEL_SIZE(NB), &m[t], NULL), RBD_OK);
    }
    for (int s = 0; s < TREES; s++)
        for (int t = 0; t < TREES; t++) {
            rbd_work *w;
            void *work = malloc(rbd_work_size(m[s]));
            ck_assert_int_eq(rbd_work_init(m[s], work, rbd_work_size(m[s]), &w), RBD_OK);
            ck_assert_msg(rbd_gravity_torque(m[t], w, x, y) == (s == t ? RBD_OK : RBD_ERR_WORK), "%d, %d", s,
                          t);
            free(work);
        }
    for (int t = 0; t < TREES; t++) free(memory[t]);
}
END_TEST

Suite *work_suite(void) {
    Suite *suite = suite_create("work");
    TCase *c = tcase_create("work");
    tcase_add_test(c, memory_one_byte_too_small_is_refused);
    tcase_add_test(c, sizes_at_compile_time_suffice);
#ifdef FE_INVALID
    tcase_add_test(c, memory_raises_no_floating_point_exception);
#endif
    tcase_add_test(c, null_arguments_are_refused);
    tcase_add_test(c, fixed_bodies_alone_are_a_model);
    tcase_add_test(c, what_is_not_a_model_is_refused);
    tcase_add_test(c, gravity_is_earth_s_until_set);
    tcase_add_test(c, works_are_independent);
    tcase_add_test(c, work_of_another_model_is_refused);
    tcase_add_test(c, work_of_a_model_built_over_is_refused);
    tcase_add_test(c, work_of_a_model_that_differs_in_one_count_is_refused);
    tcase_add_test(c, works_of_models_that_differ_in_one_number_are_refused);
    tcase_add_test(c, model_of_another_version_or_scalar_is_refused);
    tcase_add_test(c, work_serves_every_copy_of_its_model);
    suite_add_tcase(suite, c);
    TCase *bytes = tcase_create("bytes"); /* compares padding too, to which valgrind objects */
    tcase_add_test(bytes, memory_of_any_alignment_and_content_suffices);
    suite_add_tcase(suite, bytes);
    return suite;
}
