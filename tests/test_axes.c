/* test_axes.c - pairs of nearly parallel axes against the textbook: what is computed is right to rounding
   wherever the robot stands, whatever stands beside it and however its links differ in size.
   One source for both scalars: -DRBD_REAL=float, or nothing (double). */
#include "larger.h"
#include "rbd.h"

#include "textbook.h"

#include "quiet_check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the error of an entry of M over sqrt(M_ii M_jj), of a torque likewise. */
#define BOUND (100 * (sizeof(rbd_real) == sizeof(float) ? 6e-8 : 1.1e-16))

enum { LINKS = 7, MAX_NB = 2 * LINKS, MAX_NV = MAX_NB + 5, STATES = 3 };

static const double gravity[3] = {0, 0, -9.81};

/* Uniform by xorshift64* of Vigna; rounded to float, so that each scalar has the same states. */
static double uniform(uint64_t *seed, double low, double high) {
    *seed ^= *seed >> 12;
    *seed ^= *seed << 25;
    *seed ^= *seed >> 27;
    const uint64_t bits = *seed * UINT64_C(2685821657736338717) >> 11;
    return (float)(low + (high - low) * ((double)bits / 9007199254740992.0));
}

static void succeed(const char *what, rbd_status status) {
    ck_assert_msg(status == RBD_OK, "%s: %s", what, rbd_status_string(status));
}
#define RUN(call) succeed(#call, call)

/* ---- a model and its results at a state ---- */

typedef struct result {
    int nq, nv;
    double q[MAX_NV + 1], v[MAX_NV], a[MAX_NV], tau[MAX_NV]; /* the state */
    rbd_real M[MAX_NV * MAX_NV], torque[MAX_NV], acceleration[MAX_NV];
} result;

static void round_to(const double *x, int n, rbd_real *y) {
    for (int i = 0; i < n; i++) y[i] = (rbd_real)x[i];
}

static result evaluate(const rbd_body *bodies, int nb, uint64_t seed) {
    static unsigned char model_memory[RBD_MODEL_SIZE(MAX_NB)], work_memory[RBD_WORK_SIZE(MAX_NB, MAX_NV)];
    const rbd_model *m;
    rbd_work *w;
    rbd_real q[MAX_NV + 1], v[MAX_NV], a[MAX_NV], tau[MAX_NV];
    result r;
    RUN(rbd_model_build(bodies, nb, model_memory, sizeof model_memory, &m, NULL));
    RUN(rbd_work_init(m, work_memory, sizeof work_memory, &w));
    r.nq = rbd_nq(m);
    r.nv = rbd_nv(m);
    for (int i = 0; i < r.nq; i++) r.q[i] = uniform(&seed, -3, 3);
    for (int i = 0; i < r.nv; i++) {
        r.v[i] = uniform(&seed, -1, 1);
        r.a[i] = uniform(&seed, -1, 1);
        r.tau[i] = 0; /* of the size that gravity gives: small fingers would else dash off */
    }
    round_to(r.q, r.nq, q);
    round_to(r.v, r.nv, v);
    round_to(r.a, r.nv, a);
    round_to(r.tau, r.nv, tau);
    RUN(rbd_crba(m, w, q, r.M));
    RUN(rbd_rnea(m, w, q, v, a, NULL, r.torque));
    RUN(rbd_aba(m, w, q, v, tau, NULL, r.acceleration));
    return r;
}

/* ---- comparison ---- */

static const char *place;
static double angle;

static void judge(const char *what, tb_real error) {
    ck_assert_msg(error <= BOUND, "%s, %g rad, %s: error %.3g exceeds %.3g", place, angle, what,
                  (double)error, BOUND);
}

/* Torques: each over the root of its M_ii, as a share of the largest such torque or acceleration. */
static void compare_torque(const char *what, const result *r, const tb_real *M, const tb_real *expected,
                           const double *a, const tb_real *found) {
    double size = 0, error = 0;
    for (int i = 0; i < r->nv; i++) {
        const tb_real root = sqrtl(M[i * r->nv + i]);
        size = larger(size, larger((double)(fabsl(expected[i]) / root), (double)(fabsl(a[i]) * root)));
        error = larger(error, (double)(fabsl(found[i] - expected[i]) / root));
    }
    judge(what, error / size);
}

static void compare_mass_matrix(const rbd_body *bodies, int nb, const result *r, tb_real *M) {
    const int nv = r->nv;
    tb_mass_matrix(bodies, nb, r->q, M);
    for (int i = 0; i < nv; i++)
        for (int j = 0; j < nv; j++)
            judge("M",
                  fabsl((tb_real)r->M[i * nv + j] - M[i * nv + j]) / sqrtl(M[i * nv + i] * M[j * nv + j]));
}

static void compare(const rbd_body *bodies, int nb, const result *r) {
    static tb_real M[TB_MAX_DOFS * TB_MAX_DOFS];
    tb_real expected[TB_MAX_DOFS], found[TB_MAX_DOFS];
    double a[MAX_NV];
    const int nv = r->nv;
    compare_mass_matrix(bodies, nb, r, M);
    tb_rnea(bodies, nb, gravity, r->q, r->v, r->a, NULL, expected, NULL);
    for (int i = 0; i < nv; i++) found[i] = r->torque[i];
    compare_torque("rnea", r, M, expected, r->a, found);
    for (int i = 0; i < nv; i++) { /* the torque of the acceleration that was found is the one given */
        a[i] = (double)r->acceleration[i];
        expected[i] = r->tau[i];
    }
    tb_rnea(bodies, nb, gravity, r->q, r->v, a, NULL, found, NULL);
    compare_torque("aba", r, M, expected, a, found);
}

/* ---- the robots ---- */

/* A body of about this size, a box of ten times the density of water. */
static void set_mass(uint64_t *seed, double size, rbd_body *b) {
    double moment[3];
    b->mass = uniform(seed, 0.2, 5) * size * size * size;
    for (int k = 0; k < 3; k++) {
        b->com[k] = size * uniform(seed, -0.3, 0.3);
        moment[k] = size * size * b->mass * uniform(seed, 0.005, 0.05);
    }
    b->inertia[0] = moment[1] + moment[2];
    b->inertia[3] = moment[0] + moment[2];
    b->inertia[5] = moment[0] + moment[1];
}

/* A chain whose axes stand at this angle to each other, but now and then one aslant; from link `small` on a
   thousandth as large. */
static void chain(uint64_t seed, double twist, int small, rbd_body *b) {
    memset(b, 0, LINKS * sizeof *b);
    for (int i = 0; i < LINKS; i++, b++) {
        const double size = i < small ? 1 : 1e-3, turn = uniform(&seed, 0, 6.28);
        b->parent = i - 1;
        b->type = RBD_REVOLUTE;
        b->axis[0] = sin(twist) * cos(turn);
        b->axis[1] = sin(twist) * sin(turn);
        b->axis[2] = cos(twist);
        if (i == 3 && seed % 3 == 0) /* not by a right angle: within 1e-12 rad of one it is taken as one */
            b->axis[0] = 1, b->axis[1] = 0, b->axis[2] = 0.3;
        for (int k = 0; k < 3; k++) b->position[k] = uniform(&seed, -0.5, 0.5) * (i == small ? 1 : size);
        set_mass(&seed, size, b);
    }
}

typedef void robot_check(const rbd_body *chain, uint64_t seed);

static void for_chains(int small, robot_check *check) {
    for (int power = 1; power <= 7; power++)
        for (uint64_t seed = 1; seed <= 20; seed++) {
            rbd_body bodies[LINKS];
            angle = pow(10, -power);
            chain(seed, angle, small, bodies);
            check(bodies, seed);
        }
}

static void check_chain(const rbd_body *bodies, uint64_t seed) {
    const result r = evaluate(bodies, LINKS, seed);
    compare(bodies, LINKS, &r);
}

static void expect_same(const char *what, const rbd_real *x, const rbd_real *y, int n) {
    ck_assert_msg(memcmp(x, y, (size_t)n * sizeof *x) == 0, "%s, %g rad: %s differs", place, angle, what);
}

/* Where the root stands does not change a bit of the results. */
static void check_places(const rbd_body *bodies, uint64_t seed) {
    static const double places[] = {100, 1e4, 5e5};
    const result here = evaluate(bodies, LINKS, seed);
    compare(bodies, LINKS, &here);
    for (int i = 0; i < 3; i++) {
        rbd_body moved[LINKS];
        memcpy(moved, bodies, sizeof moved);
        moved[0].position[i] += places[i];
        const result there = evaluate(moved, LINKS, seed);
        expect_same("M", here.M, there.M, LINKS * LINKS);
        expect_same("torque", here.torque, there.torque, LINKS);
        expect_same("acceleration", here.acceleration, there.acceleration, LINKS);
    }
}

START_TEST(the_place_of_the_root_changes_nothing) {
    place = "one chain";
    for_chains(LINKS, check_places);
}
END_TEST

static void check_floating(const rbd_body *bodies, uint64_t seed) {
    rbd_body b[LINKS];
    memcpy(b, bodies, sizeof b);
    b[0].type = RBD_FLOATING;
    b[0].position[1] = 1e4;
    check_chain(b, seed);
}

START_TEST(on_a_floating_base) {
    place = "floating base";
    for_chains(LINKS, check_floating);
}
END_TEST

/* A second root far away, or a branch with far links on the first body. */
static void check_beside(const rbd_body *bodies, uint64_t seed) {
    rbd_body b[2 * LINKS];
    memcpy(b, bodies, LINKS * sizeof *b);
    chain(seed + 100, 1, LINKS, b + LINKS);
    for (int i = 1; i < LINKS; i++) b[LINKS + i].parent += LINKS;
    b[LINKS].position[0] = 5e5;
    b[LINKS + 1].position[1] = 1e4;
    const result r = evaluate(b, 2 * LINKS, seed);
    compare(b, 2 * LINKS, &r);
}

START_TEST(beside_a_far_second_root) {
    place = "far second root";
    for_chains(LINKS, check_beside);
}
END_TEST

START_TEST(small_finger_on_a_large_arm) {
    place = "small finger";
    for_chains(3, check_chain);
}
END_TEST

/* A heavy small hub whose child is light and far, its axis parallel, crossing, or nearly so: the hub's
   numbers must not be seen from where the child is. */
static void check_hub(double lean, double offset) {
    rbd_body b[3] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {1, 0, 0}, .mass = 100, .com = {0.01, 0.02, 0.01}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1e4, .com = {0.01, 0, 0}},
        {.parent = 1,
         .type = RBD_REVOLUTE,
         .axis = {sin(lean), 0, cos(lean)},
         .mass = 1e-6,
         .position = {0, offset, 1000},
         .com = {0.1, 0.1, 0}}};
    angle = lean;
    for (int i = 0; i < 3; i++) b[i].inertia[0] = b[i].inertia[3] = b[i].inertia[5] = 1e-4 * b[i].mass;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        const result r = evaluate(b, 3, seed);
        compare(b, 3, &r);
    }
}

START_TEST(heavy_hub_with_a_light_far_child) {
    static const double leans[] = {0, 1e-5, 1e-2, 0.5, 1.5707963267948966, 3.141592653589793};
    place = "heavy hub";
    for (int i = 0; i < 6; i++) {
        check_hub(leans[i], 0);
        check_hub(leans[i], 0.3);
    }
}
END_TEST

/* A small screw on a long link, far along its axis from where the other axis comes near: its inertia is a
   number of its own, no difference of large ones, and no singular one (evaluate). At two sizes. */
START_TEST(small_screw_far_along_its_axis) {
    static const double units[2] = {1, 1e-3};
    place = "small screw";
    angle = 1.5707963267948966;
    for (int i = 0; i < 2; i++) {
        const double l = units[i], I = l * l;
        const rbd_body b[2] = {{.parent = -1,
                                .type = RBD_REVOLUTE,
                                .axis = {1, 0, 0},
                                .mass = 10,
                                .com = {0, 0, 100 * l},
                                .inertia = {3e4 * I, 0, 0, 3e4 * I, 0, I}},
                               {.parent = 0,
                                .type = RBD_HELICAL,
                                .axis = {0, 0, 1},
                                .pitch = 1e-5 * l,
                                .mass = 1e-3,
                                .position = {0, 0, 200 * l},
                                .com = {1e-5 * l, 0, 0},
                                .inertia = {1e-14 * I, 0, 0, 2e-14 * I, 0, 3e-14 * I}}};
        tb_real M[4];
        for (uint64_t seed = 1; seed <= 20; seed++) {
            const result r = evaluate(b, 2, seed);
            compare_mass_matrix(b, 2, &r, M);
        }
    }
}
END_TEST

/* A hub so small and heavy that its inertia is a light arm's: a millionth of the arm aside its weight would
   drown the arm's. The unit of mass does not matter. */
START_TEST(heavy_hub_of_little_inertia) {
    static const double units[2] = {1, 1e-9};
    place = "heavy hub of little inertia";
    angle = 1.5707963267948966;
    for (int i = 0; i < 2; i++) {
        const double m = units[i], I = 1e-9 * m;
        const rbd_body b[3] = {
            {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1e-6 * m, .com = {0.1, 0, 0}},
            {.parent = 0,
             .type = RBD_REVOLUTE,
             .axis = {1, 0, 0},
             .mass = 1e6 * m,
             .com = {0, 1e-8, 1e-8},
             .inertia = {I, 0, 0, I, 0, I}},
            {.parent = 1,
             .type = RBD_REVOLUTE,
             .axis = {0, 1, 0},
             .mass = 1e-6 * m,
             .position = {1e-6, 1, 0},
             .com = {0.1, 0, 0.1}}};
        for (uint64_t seed = 1; seed <= 20; seed++) {
            const result r = evaluate(b, 3, seed);
            compare(b, 3, &r);
        }
    }
}
END_TEST

/* Links without mass, moved by their rotors: where they are is no worse known. */
START_TEST(massless_links_keep_their_places) {
    static unsigned char model_memory[RBD_MODEL_SIZE(2)], work_memory[RBD_WORK_SIZE(2, 2)];
    const rbd_body b[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {1e-7, 0, 1}, .position = {0, 1, 0}, .armature = {1}}};
    const double q[2] = {0.5, 0.75}, v[2] = {0};
    const rbd_real q_real[2] = {(rbd_real)0.5, (rbd_real)0.75};
    const rbd_model *m;
    rbd_work *w;
    tb_real tau[2];
    tb_motion expected;
    rbd_real p[3];
    place = "massless links";
    angle = 1e-7;
    RUN(rbd_model_build(b, 2, model_memory, sizeof model_memory, &m, NULL));
    RUN(rbd_work_init(m, work_memory, sizeof work_memory, &w));
    RUN(rbd_kinematics(m, w, q_real, NULL, NULL));
    RUN(rbd_body_pose(m, w, 1, NULL, p));
    tb_rnea(b, 2, gravity, q, v, v, NULL, tau, &expected);
    for (int k = 0; k < 3; k++) judge("position", fabsl((tb_real)p[k] - expected.p[1][k]));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("axes");
    TCase *c = tcase_create("nearly parallel");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, the_place_of_the_root_changes_nothing);
    tcase_add_test(c, on_a_floating_base);
    tcase_add_test(c, beside_a_far_second_root);
    tcase_add_test(c, small_finger_on_a_large_arm);
    tcase_add_test(c, heavy_hub_with_a_light_far_child);
    tcase_add_test(c, small_screw_far_along_its_axis);
    tcase_add_test(c, heavy_hub_of_little_inertia);
    tcase_add_test(c, massless_links_keep_their_places);
    suite_add_tcase(suite, c);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
