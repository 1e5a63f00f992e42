/* test_joints.c - [joints]: each joint type against the same mechanism made of simpler ones. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "suites.h"
#include "support.h"

#define BOX .mass = 1.5, .com = {0.1, -0.2, 0.15}, .inertia = {0.2, 0.01, -0.02, 0.25, 0.03, 0.3}
#define PLACE .position = {0.3, -0.4, 0.5}, .rotation = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6}
#define ARM {.joint = "arm", .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, BOX}
#define HAND(on) {.joint = "hand", .parent = on, .type = RBD_REVOLUTE, .axis = {1, 0, 0}, PLACE, BOX}

/* Both descriptions have the same q and v; body_of[i] is the body of b that body i of a is. */
static void expect_same_dynamics(const char *what, const robot *a, const robot *b, const int *body_of) {
    uint64_t seed = 11;
    ck_assert_msg(a->nq == b->nq && a->nv == b->nv, "%s: other sizes", what);
    for (int number = 0; number < 20; number++) {
        state s;
        double f_ext[6 * MAX_BODIES] = {0}, x[MAX_V], y[MAX_V], M[MAX_V * MAX_V], N[MAX_V * MAX_V];
        draw_state(a, &seed, &s);
        expect_ok(what, b, number, rbd_set_gravity(b->w, s.gravity));
        for (int i = 0; i < a->nb; i++) memcpy(f_ext + 6 * body_of[i], s.f_ext + 6 * i, 6 * sizeof(double));
        expect_ok(what, a, number, rbd_rnea(a->m, a->w, s.q, s.v, s.a, s.f_ext, x));
        expect_ok(what, b, number, rbd_rnea(b->m, b->w, s.q, s.v, s.a, f_ext, y));
        expect_close(what, a, number, x, y, a->nv, 1e-13);
        expect_ok(what, a, number, rbd_crba(a->m, a->w, s.q, M));
        expect_ok(what, b, number, rbd_crba(b->m, b->w, s.q, N));
        expect_close(what, a, number, M, N, a->nv * a->nv, 1e-13);
        expect_ok(what, a, number, rbd_aba(a->m, a->w, s.q, s.v, s.tau, s.f_ext, x));
        expect_ok(what, b, number, rbd_aba(b->m, b->w, s.q, s.v, s.tau, f_ext, y));
        expect_close(what, a, number, x, y, a->nv, 1e-9); /* near an Euler joint's own singularity */
        expect_ok(what, a, number, rbd_kinematics(a->m, a->w, s.q, s.v, s.a));
        expect_ok(what, b, number, rbd_kinematics(b->m, b->w, s.q, s.v, s.a));
        for (int i = 0; i < a->nb; i++) {
            double A[6], B[6];
            expect_ok(what, a, number, rbd_body_acceleration_classical(a->m, a->w, i, A));
            expect_ok(what, b, number, rbd_body_acceleration_classical(b->m, b->w, body_of[i], B));
            expect_close(what, a, number, A, B, 6, 1e-12);
        }
    }
}

/* A joint between an arm and a hand, against a chain of simple joints with nothing between. */
static void expect_chain(const char *what, rbd_body joint, const rbd_body *links, int count) {
    const rbd_body box = {BOX}, place = {PLACE}, arm = ARM, hand = HAND(1), far_hand = HAND(count);
    rbd_body one[3] = {arm, joint, hand}, many[6] = {arm};
    const int body_of[3] = {0, count, count + 1};
    memcpy(one[1].position, place.position, sizeof place.position);
    memcpy(one[1].rotation, place.rotation, sizeof place.rotation);
    one[1].mass = box.mass;
    memcpy(one[1].com, box.com, sizeof box.com);
    memcpy(one[1].inertia, box.inertia, sizeof box.inertia);
    for (int i = 0; i < count; i++) {
        many[1 + i] = links[i];
        many[1 + i].parent = i;
        many[1 + i].armature[0] = joint.armature[i];
    }
    memcpy(many[1].position, place.position, sizeof place.position);
    memcpy(many[1].rotation, place.rotation, sizeof place.rotation);
    many[count].mass = box.mass;
    memcpy(many[count].com, box.com, sizeof box.com);
    memcpy(many[count].inertia, box.inertia, sizeof box.inertia);
    many[count + 1] = far_hand;
    robot a = robot_build(what, one, 3), b = robot_build("chain", many, count + 2);
    expect_same_dynamics(what, &a, &b, body_of);
    robot_free(&a);
    robot_free(&b);
}

#define TURN_X {.type = RBD_REVOLUTE, .axis = {1, 0, 0}}
#define TURN_Y {.type = RBD_REVOLUTE, .axis = {0, 1, 0}}
#define TURN_Z {.type = RBD_REVOLUTE, .axis = {0, 0, 1}}

START_TEST(cylindrical_is_a_revolute_and_a_prismatic) {
    const rbd_body links[2] = {{.type = RBD_REVOLUTE, .axis = {1, 2, -2}},
                               {.type = RBD_PRISMATIC, .axis = {1, 2, -2}}};
    const rbd_body joint = {.parent = 0, .type = RBD_CYLINDRICAL, .axis = {2, 4, -4}, .armature = {0.1, 0.2}};
    expect_chain("cylindrical", joint, links, 2);
}
END_TEST

START_TEST(universal_is_two_revolutes) {
    const rbd_body links[2] = {{.type = RBD_REVOLUTE, .axis = {1, 2, -2}},
                               {.type = RBD_REVOLUTE, .axis = {1, 0, 1}}}; /* not at a right angle */
    const rbd_body joint = {
        .parent = 0, .type = RBD_UNIVERSAL, .axis = {1, 2, -2}, .axis2 = {3, 0, 3}, .armature = {0.1, 0.2}};
    expect_chain("universal", joint, links, 2);
}
END_TEST

START_TEST(euler_is_three_revolutes_in_the_order_named) {
    const rbd_body zyx[3] = {TURN_Z, TURN_Y, TURN_X}, xyz[3] = {TURN_X, TURN_Y, TURN_Z};
    const rbd_body yxz[3] = {TURN_Y, TURN_X, TURN_Z}, zxy[3] = {TURN_Z, TURN_X, TURN_Y};
    rbd_body joint = {.parent = 0, .armature = {0.1, 0.2, 0.3}};
    joint.type = RBD_EULER_ZYX;
    expect_chain("euler_zyx", joint, zyx, 3);
    joint.type = RBD_EULER_XYZ;
    expect_chain("euler_xyz", joint, xyz, 3);
    joint.type = RBD_EULER_YXZ;
    expect_chain("euler_yxz", joint, yxz, 3);
    joint.type = RBD_EULER_ZXY;
    expect_chain("euler_zxy", joint, zxy, 3);
}
END_TEST

START_TEST(translation_is_three_prismatics) {
    const rbd_body links[3] = {{.type = RBD_PRISMATIC, .axis = {1, 0, 0}},
                               {.type = RBD_PRISMATIC, .axis = {0, 1, 0}},
                               {.type = RBD_PRISMATIC, .axis = {0, 0, 1}}};
    const rbd_body joint = {.parent = 0, .type = RBD_TRANSLATION, .armature = {0.1, 0.2, 0.3}};
    expect_chain("translation", joint, links, 3);
}
END_TEST

START_TEST(revolute_of_pitch_zero_is_helical) {
    const rbd_body links[1] = {{.type = RBD_REVOLUTE, .axis = {1, 2, -2}}};
    const rbd_body joint = {.parent = 0, .type = RBD_HELICAL, .axis = {1, 2, -2}};
    expect_chain("helical of pitch 0", joint, links, 1);
}
END_TEST

START_TEST(axis_of_any_length_is_the_same_joint) {
    const rbd_joint_type types[4] = {RBD_REVOLUTE, RBD_PRISMATIC, RBD_HELICAL, RBD_CONTINUOUS_CS};
    for (int i = 0; i < 4; i++) {
        const rbd_body links[1] = {{.type = types[i], .axis = {0.01, 0.02, -0.02}, .pitch = 0.1}};
        const rbd_body joint = {.parent = 0, .type = types[i], .axis = {100, 200, -200}, .pitch = 0.1};
        expect_chain("axis of any length", joint, links, 1);
    }
}
END_TEST

/* A helical joint moves like a slide that follows a turn by the pitch. */
START_TEST(helical_is_a_slide_that_follows_a_turn) {
    const rbd_body screw[3] = {
        ARM, {.parent = 0, .type = RBD_HELICAL, .axis = {1, 2, -2}, .pitch = 0.3, PLACE, BOX}, HAND(1)};
    const rbd_body pair[4] = {
        ARM,
        {.joint = "turn", .parent = 0, .type = RBD_REVOLUTE, .axis = {1, 2, -2}, PLACE},
        {.parent = 1, .type = RBD_PRISMATIC, .axis = {1, 2, -2}, BOX, .mimic = "turn", .mimic_ratio = 0.3},
        HAND(2)};
    const int body_of[3] = {0, 2, 3};
    robot a = BUILD(screw), b = BUILD(pair);
    expect_same_dynamics("helical as mimic", &a, &b, body_of);
    robot_free(&a);
    robot_free(&b);
}
END_TEST

/* ---- mimic joints ---- */

static const rbd_body followed[] = {
    {.joint = "a", .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, BOX, .armature = {0.1}},
    {.joint = "b",
     .parent = 0,
     .type = RBD_PRISMATIC,
     .axis = {1, 1, 0},
     PLACE,
     BOX,
     .armature = {0.2},
     .mimic = "d",
     .mimic_ratio = -0.5,
     .mimic_offset = 0.3},
    {.joint = "c",
     .parent = 1,
     .type = RBD_CONTINUOUS,
     .axis = {0, 0, 1},
     PLACE,
     BOX,
     .armature = {0.3},
     .mimic = "a",
     .mimic_ratio = 2,
     .mimic_offset = -1},
    {.joint = "d", .parent = 0, .type = RBD_HELICAL, .axis = {1, 0, 1}, .pitch = 0.1, PLACE, BOX},
    {.joint = "e",
     .parent = -1,
     .type = RBD_REVOLUTE,
     .axis = {1, 0, 0},
     PLACE,
     BOX,
     .mimic = "a",
     .mimic_ratio = -1.5},
};
/* coordinates of the free model = G q + offset, q = (a, d) */
static const double G[5][2] = {{1, 0}, {0, -0.5}, {2, 0}, {0, 1}, {-1.5, 0}};
static const double offset[5] = {0, 0.3, -1, 0, 0};

static void project(const double *x, double *out) {
    for (int k = 0; k < 2; k++) {
        out[k] = 0;
        for (int i = 0; i < 5; i++) out[k] += G[i][k] * x[i];
    }
}

static void expand(const double *q, const double *add, double *out) {
    for (int i = 0; i < 5; i++) out[i] = G[i][0] * q[0] + G[i][1] * q[1] + (add ? add[i] : 0);
}

static void check_mimic(const robot *r, const robot *freed, const state *s, int number) {
    double q[5], v[5], a[5], tau[5], projected[2], found[2], M[25], MG[10], GMG[4], found_M[4], back[2];
    expand(s->q, offset, q);
    expand(s->v, NULL, v);
    expand(s->a, NULL, a);
    RUN(rbd_set_gravity(freed->w, s->gravity));
    RUN(rbd_rnea(freed->m, freed->w, q, v, a, s->f_ext, tau));
    project(tau, projected);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, found));
    expect_close("mimic: tau = G' tau_x", r, number, found, projected, 2, 1e-13);
    RUN(rbd_crba(freed->m, freed->w, q, M));
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 2; k++) {
            const double column[5] = {G[0][k], G[1][k], G[2][k], G[3][k], G[4][k]};
            MG[2 * i + k] = dot(M + 5 * i, column, 5);
        }
    for (int k = 0; k < 2; k++) {
        const double column[5] = {MG[k], MG[2 + k], MG[4 + k], MG[6 + k], MG[8 + k]};
        double pair[2];
        project(column, pair);
        GMG[k] = pair[0];
        GMG[2 + k] = pair[1];
    }
    RUN(rbd_crba(r->m, r->w, s->q, found_M));
    expect_close("mimic: M = G' M_x G", r, number, found_M, GMG, 4, 1e-13);
    RUN(rbd_aba(r->m, r->w, s->q, s->v, found, s->f_ext, back));
    expect_close("mimic: aba undoes rnea", r, number, back, s->a, 2, 1e-12);
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, found, s->f_ext, back));
    expect_close("mimic: fd_cholesky undoes rnea", r, number, back, s->a, 2, 1e-12);
}

START_TEST(mimic_joints_are_a_constraint_on_the_free_model) {
    rbd_body unbound[LENGTH(followed)];
    uint64_t seed = 21;
    state s;
    memcpy(unbound, followed, sizeof followed);
    for (int i = 0; i < LENGTH(followed); i++) unbound[i].mimic = NULL;
    robot r = BUILD(followed), freed = BUILD(unbound);
    ck_assert_int_eq(r.nv, 2);
    ck_assert_int_eq(freed.nv, 5);
    for (int i = 0; i < 50; i++) {
        draw_state(&r, &seed, &s);
        check_mimic(&r, &freed, &s, i);
    }
    robot_free(&r);
    robot_free(&freed);
}
END_TEST

/* ---- fixed bodies, roots, order ---- */

START_TEST(fixed_bodies_are_merged_and_stay_as_frames) {
    /* Two point masses of 1 kg at +-0.5 z fixed to a hub are a rod with inertia 0.5 about x and y. */
    const rbd_body assembled[4] = {
        {.name = "hub",
         .parent = -1,
         .type = RBD_REVOLUTE,
         .axis = {0, 1, 0},
         .mass = 1,
         .inertia = {0.1, 0, 0, 0.1, 0, 0.1}},
        {.name = "bracket",
         .parent = 0,
         .type = RBD_FIXED,
         .position = {0, 0, 0.25},
         .rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1}},
        {.name = "top", .parent = 1, .type = RBD_FIXED, .position = {0, 0, 0.25}, .mass = 1},
        {.name = "bottom", .parent = 0, .type = RBD_FIXED, .mass = 1, .com = {0, 0, -0.5}}};
    const rbd_body whole[1] = {{.parent = -1,
                                .type = RBD_REVOLUTE,
                                .axis = {0, 1, 0},
                                .mass = 3,
                                .inertia = {0.6, 0, 0, 0.6, 0, 0.1}}};
    robot a = BUILD(assembled), b = BUILD(whole);
    const double q[1] = {0.7}, v[1] = {1.5}, expected_p[3] = {0.5 * sin(0.7), 0, 0.5 * cos(0.7)};
    const double expected_R[9] = {0, -cos(0.7), sin(0.7), 1, 0, 0, 0, sin(0.7), cos(0.7)};
    double M[2], p[3], R[9], f_ext[24] = {0}, f_hub[6] = {0}, tau[2];
    ck_assert_int_eq(rbd_crba(a.m, a.w, q, &M[0]), RBD_OK);
    ck_assert_int_eq(rbd_crba(b.m, b.w, q, &M[1]), RBD_OK);
    expect_close("merged M", &a, 0, &M[0], &M[1], 1, 1e-15);
    ck_assert_int_eq(rbd_kinematics(a.m, a.w, q, v, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(a.m, a.w, 2, R, p), RBD_OK);
    expect_close("frame p", &a, 0, p, expected_p, 3, 1e-15);
    expect_close("frame R", &a, 0, R, expected_R, 9, 1e-15);
    /* A force of 2 N along the frame's own -y is along the hub's x, half a metre above the axis. */
    f_ext[6 * 2 + 4] = -2;
    f_hub[1] = 1;
    f_hub[3] = 2;
    ck_assert_int_eq(rbd_rnea(a.m, a.w, q, v, v, f_ext, &tau[0]), RBD_OK);
    ck_assert_int_eq(rbd_rnea(b.m, b.w, q, v, v, f_hub, &tau[1]), RBD_OK);
    expect_close("wrench on a frame", &a, 0, &tau[0], &tau[1], 1, 1e-14);
    robot_free(&a);
    robot_free(&b);
}
END_TEST

START_TEST(bodies_fixed_to_the_world_carry_without_counting) {
    const rbd_body mounted[3] = {
        {.parent = -1, .type = RBD_FIXED, PLACE, .mass = 100},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .position = {0, 0, 1}, BOX},
        {.parent = 0, .type = RBD_FIXED, .position = {0, 0, 2}}};
    robot r = BUILD(mounted);
    const double q[1] = {0.4}, v[1] = {2}, mass = 1.5, zero[6] = {0};
    const double expected[3] = {0.3 - 0.8 * 2, -0.4, 0.5 + 0.6 * 2};
    double p[3], velocity[6], found = rbd_mass(r.m);
    expect_close("mass", &r, 0, &found, &mass, 1, 1e-15);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, v, v), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 2, NULL, p), RBD_OK);
    expect_close("fixed frame", &r, 0, p, expected, 3, 1e-15);
    ck_assert_int_eq(rbd_body_velocity(r.m, r.w, 2, velocity), RBD_OK);
    expect_close("fixed velocity", &r, 0, velocity, zero, 6, 0);
    robot_free(&r);
}
END_TEST

/* A model of fixed bodies only has nothing to compute and says so without fault. */
START_TEST(model_without_degree_of_freedom_is_a_model) {
    const rbd_body still[1] = {{.parent = -1, .type = RBD_FIXED, PLACE, BOX}};
    robot r = BUILD(still);
    const rbd_body *place = &still[0];
    double x[1] = {0}, p[3];
    ck_assert_int_eq(r.nq, 0);
    ck_assert_int_eq(r.nv, 0);
    ck_assert_int_eq(rbd_rnea(r.m, r.w, x, x, x, NULL, x), RBD_OK);
    ck_assert_int_eq(rbd_aba(r.m, r.w, x, x, x, NULL, x), RBD_OK);
    ck_assert_int_eq(rbd_fd_cholesky(r.m, r.w, x, x, x, NULL, x), RBD_OK);
    ck_assert_int_eq(rbd_crba(r.m, r.w, x, x), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, x, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, NULL, p), RBD_OK);
    expect_close("pose of a fixed model", &r, 0, p, place->position, 3, 1e-15);
    robot_free(&r);
}
END_TEST

/* Two robots in one description do not feel each other. */
START_TEST(several_roots_are_several_robots) {
    rbd_body both[MAX_BODIES];
    uint64_t seed = 31;
    const ref_model *first = reference_model(2), *second = reference_model(1);
    memcpy(both, first->bodies, (size_t)first->nb * sizeof *both);
    for (int i = 0; i < second->nb; i++) {
        both[first->nb + i] = second->bodies[i];
        if (second->bodies[i].parent >= 0) both[first->nb + i].parent += first->nb;
    }
    robot r = robot_build("two robots", both, first->nb + second->nb);
    robot a = robot_build(first->name, first->bodies, first->nb);
    robot b = robot_build(second->name, second->bodies, second->nb);
    for (int number = 0; number < 10; number++) {
        state s;
        double tau[MAX_V], expected[MAX_V];
        draw_state(&r, &seed, &s);
        ck_assert_int_eq(rbd_set_gravity(a.w, s.gravity), RBD_OK);
        ck_assert_int_eq(rbd_set_gravity(b.w, s.gravity), RBD_OK);
        ck_assert_int_eq(rbd_rnea(a.m, a.w, s.q, s.v, s.a, s.f_ext, expected), RBD_OK);
        ck_assert_int_eq(
            rbd_rnea(b.m, b.w, s.q + a.nq, s.v + a.nv, s.a + a.nv, s.f_ext + 6 * a.nb, expected + a.nv),
            RBD_OK);
        ck_assert_int_eq(rbd_rnea(r.m, r.w, s.q, s.v, s.a, s.f_ext, tau), RBD_OK);
        expect_close("two robots: rnea", &r, number, tau, expected, r.nv, 1e-13);
        ck_assert_int_eq(rbd_aba(r.m, r.w, s.q, s.v, tau, s.f_ext, tau), RBD_OK);
        expect_close("two robots: aba", &r, number, tau, s.a, r.nv, 1e-10);
        for (int i = 0; i < a.nv; i++) ck_assert_int_eq(rbd_packed_index(r.m, a.nv + i, i), -1);
    }
    robot_free(&r);
    robot_free(&a);
    robot_free(&b);
}
END_TEST

/* n entries from one array to another. A fixed joint has none, and begins at -1. */
static void copy_entries(double *to, int at, const double *from, int at_from, int n) {
    for (int i = 0; i < n; i++) to[at + i] = from[at_from + i];
}

/* The same tree with its bodies breadth first and depth first. Each body of `order` keeps its joint. */
static void check_order(const rbd_body *bodies, int nb, uint64_t *seed) {
    rbd_body sorted[MAX_BODIES];
    int order[MAX_BODIES], place[MAX_BODIES], count = 0, stack[MAX_BODIES], depth = 0;
    for (int root = 0; root < nb; root++) {
        if (bodies[root].parent >= 0) continue;
        stack[depth++] = root;
        while (depth > 0) {
            const int body = stack[--depth];
            place[body] = count;
            order[count++] = body;
            for (int i = body + 1; i < nb; i++)
                if (bodies[i].parent == body) stack[depth++] = i;
        }
    }
    for (int i = 0; i < nb; i++) {
        sorted[i] = bodies[order[i]];
        sorted[i].parent = sorted[i].parent < 0 ? -1 : place[sorted[i].parent];
    }
    robot a = robot_build("as given", bodies, nb), b = robot_build("depth first", sorted, nb);
    state s, t;
    draw_state(&a, seed, &s);
    draw_state(&b, seed, &t);
    ck_assert_int_eq(rbd_set_gravity(b.w, s.gravity), RBD_OK);
    double tau[MAX_V], expected[MAX_V], other[MAX_V];
    for (int i = 0; i < nb; i++) {
        rbd_joint_info from, to;
        ck_assert_int_eq(rbd_joint(a.m, i, &from), RBD_OK);
        ck_assert_int_eq(rbd_joint(b.m, place[i], &to), RBD_OK);
        copy_entries(t.q, to.iq, s.q, from.iq, from.nq);
        copy_entries(t.v, to.iv, s.v, from.iv, from.nv);
        copy_entries(t.a, to.iv, s.a, from.iv, from.nv);
        copy_entries(t.f_ext, 6 * place[i], s.f_ext, 6 * i, 6);
    }
    ck_assert_int_eq(rbd_rnea(a.m, a.w, s.q, s.v, s.a, s.f_ext, expected), RBD_OK);
    ck_assert_int_eq(rbd_rnea(b.m, b.w, t.q, t.v, t.a, t.f_ext, other), RBD_OK);
    for (int i = 0; i < nb; i++) {
        rbd_joint_info from, to;
        ck_assert_int_eq(rbd_joint(a.m, i, &from), RBD_OK);
        ck_assert_int_eq(rbd_joint(b.m, place[i], &to), RBD_OK);
        copy_entries(tau, from.iv, other, to.iv, from.nv);
    }
    expect_close("order of the bodies", &a, 0, tau, expected, a.nv, 1e-12);
    robot_free(&a);
    robot_free(&b);
}

START_TEST(order_of_bodies_does_not_matter) {
    uint64_t seed = 41;
    for (int i = 0; i < 100; i++) {
        rbd_body bodies[MAX_BODIES];
        const int nb = 2 + below(&seed, 20);
        random_tree(&seed, bodies, nb);
        check_order(bodies, nb, &seed);
    }
    check_order(reference_model(0)->bodies, reference_model(0)->nb, &seed); /* atlas: breadth first */
}
END_TEST

/* ---- every type anywhere, against the textbook ---- */

static void check_against_textbook(const char *what, const robot *r, const state *s, int number) {
    double x[MAX_V], M[MAX_V * MAX_V];
    tb_real expected[TB_MAX_DOFS], N[MAX_V * MAX_V];
    tb_rnea(r->bodies, r->nb, s->gravity, s->q, s->v, s->a, s->f_ext, expected, NULL);
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, x));
    expect_close_tb(what, r, number, x, expected, r->nv, 1e-12);
    tb_mass_matrix(r->bodies, r->nb, s->q, N);
    RUN(rbd_crba(r->m, r->w, s->q, M));
    expect_close_tb(what, r, number, M, N, r->nv * r->nv, 1e-12);
    const tb_real condition =
        tb_forward(r->bodies, r->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, expected);
    RUN(rbd_aba(r->m, r->w, s->q, s->v, s->tau, s->f_ext, x));
    expect_close_tb(what, r, number, x, expected, r->nv, inverse_bound((double)condition));
    RUN(rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, s->f_ext, x));
    expect_close_tb(what, r, number, x, expected, r->nv, inverse_bound((double)condition));
}

/* A chain of five revolutes with one of each type at each place, then all of that type. */
START_TEST(every_type_may_stand_anywhere) {
    uint64_t seed = 51;
    for (int type = RBD_FIXED; type < RBD_JOINT_TYPES; type++)
        for (int at = 0; at <= 5; at++) {
            rbd_body b[5];
            char name[64];
            state s;
            for (int i = 0; i < 5; i++) {
                const int special = at == i || at == 5;
                random_joint(&seed, b, i,
                             special && type < RBD_JOINT_TYPES ? (rbd_joint_type)type : RBD_REVOLUTE);
                b[i].parent = i - 1;
                random_mass(&seed, &b[i]);
            }
            if (type == RBD_FIXED && at == 5) continue;
            snprintf(name, sizeof name, "type %d at %d", type, at);
            robot r = robot_build(name, b, 5);
            draw_state(&r, &seed, &s);
            check_against_textbook("every type anywhere", &r, &s, 0);
            robot_free(&r);
        }
}
END_TEST

/* Nearly parallel axes have a common normal that is far away or anywhere. */
START_TEST(nearly_parallel_axes_lose_no_accuracy) {
    const double twists[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-13, 1e-15, 0};
    uint64_t seed = 61;
    for (int i = 0; i < LENGTH(twists); i++)
        for (int variant = 0; variant < 8; variant++) {
            rbd_body b[8];
            char name[64];
            state s;
            for (int k = 0; k < 8; k++) {
                random_joint(&seed, b, k, variant & 1 ? RBD_HELICAL : RBD_REVOLUTE);
                random_mass(&seed, &b[k]);
                const double t = twists[i] * uniform(&seed, 0.5, 1);
                const double turn[9] = {1, 0, 0, 0, cos(t), -sin(t), 0, sin(t), cos(t)};
                const double axis[3] = {0, 0, variant & 2 && k & 1 ? -1 : 1};
                memcpy(b[k].rotation, turn, sizeof turn);
                memcpy(b[k].axis, axis, sizeof axis);
                b[k].parent = k - 1;
                b[k].pitch = variant & 1 ? 0.1 : 0;
                for (int j = 0; j < 3; j++) b[k].position[j] = uniform(&seed, 0.2, 0.5);
            }
            if (variant & 4) {
                b[0].type = RBD_FLOATING;
                b[0].pitch = 0;
            }
            snprintf(name, sizeof name, "twist %.0e, variant %d", twists[i], variant);
            robot r = robot_build(name, b, 8);
            draw_state(&r, &seed, &s);
            check_against_textbook("nearly parallel axes", &r, &s, 0);
            robot_free(&r);
        }
}
END_TEST

/* ---- coordinates ---- */

/* A common normal that is nearer to the child than to its parent, whose frame would have to move far. */
START_TEST(common_normal_far_from_the_parent_alone_is_no_loss) {
    const double sine = 0.05, cosine = sqrt(1 - sine * sine);
    const rbd_body b[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, BOX},
        {.type = RBD_REVOLUTE, .axis = {sine, 0, cosine}, .position = {0.495, 0, 0.868}, BOX}};
    for (int side = -1; side <= 1; side += 2) {
        rbd_body sided[2] = {b[0], b[1]};
        uint64_t seed = 77;
        state s;
        sided[1].position[0] *= side;
        robot r = BUILD(sided);
        draw_state(&r, &seed, &s);
        check_against_textbook("far normal", &r, &s, side);
        robot_free(&r);
    }
}
END_TEST

/* A rotor is inertia without mass: wherever it stands, the links beside it keep their accuracy. */
START_TEST(rotor_beside_massive_links_is_no_loss) {
    const rbd_body b[4] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, BOX},
        {.type = RBD_REVOLUTE, .axis = {0.6, 0, 0.8}, .position = {0.3, 0.2, 0.5}, BOX},
        {.type = RBD_REVOLUTE, .axis = {0, 1, 0}, .position = {0, 0, 0.01}, .armature = {0.3}},
        {.parent = 1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .position = {0.1, 0.2, 0.3}, BOX}};
    uint64_t seed = 78;
    state s;
    robot r = BUILD(b);
    draw_state(&r, &seed, &s);
    check_against_textbook("rotor", &r, &s, 0);
    robot_free(&r);
}
END_TEST

START_TEST(angles_of_any_size_keep_their_accuracy) {
    const double angles[] = {-3.2, 7, -100, 1e3, -1e4, 123456.789, -999999, 1e6, 1.5e6, -1e9, 1e15};
    uint64_t seed = 71;
    rbd_body b[3];
    for (int i = 0; i < 3; i++) {
        random_joint(&seed, b, i, i == 1 ? RBD_CONTINUOUS : RBD_REVOLUTE);
        b[i].parent = i - 1;
        random_mass(&seed, &b[i]);
    }
    robot r = robot_build("large angles", b, 3);
    for (int i = 0; i < LENGTH(angles); i++) {
        state s;
        tb_real expected[TB_MAX_DOFS];
        double tau[3];
        draw_state(&r, &seed, &s);
        s.q[0] = -angles[i];
        s.q[1] = angles[i];
        tb_rnea(b, 3, s.gravity, s.q, s.v, s.a, s.f_ext, expected, NULL);
        ck_assert_int_eq(rbd_rnea(r.m, r.w, s.q, s.v, s.a, s.f_ext, tau), RBD_OK);
        /* a frame turned by a constant angle adds it to q: half a unit in the last place of q */
        expect_close_tb("large angles", &r, i, tau, expected, 3, 1e-13 + 1e-15 * fabs(angles[i]));
    }
    robot_free(&r);
}
END_TEST

/* The library's own sine and cosine, read off a rotation about z. */
START_TEST(sine_and_cosine_are_right_to_the_last_bits) {
    const rbd_body turn[1] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, BOX}};
    robot r = BUILD(turn);
    uint64_t seed = 81;
    double worst = 0;
    for (int i = 0; i < 200000; i++) {
        const double size = pow(10, uniform(&seed, -8, 6));
        const double q = i < 1000 ? (i - 500) * 0.78539816339744830962 : uniform(&seed, -size, size);
        double R[9];
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, &q, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, R, NULL), RBD_OK);
        worst = larger(worst, fabs((double)(R[0] - cosl(q))));
        worst = larger(worst, fabs((double)(R[3] - sinl(q))));
    }
    expect_small("sine and cosine", &r, 0, worst, 3e-16);
    robot_free(&r);
}
END_TEST

static int quaternion_of(const robot *r, int body, rbd_joint_info *info) {
    ck_assert_int_eq(rbd_joint(r->m, body, info), RBD_OK);
    if (info->type == RBD_SPHERICAL) return info->iq;
    return info->type == RBD_FLOATING ? info->iq + 3 : -1;
}

static void check_scaled(const robot *r, const state *s, int number) {
    const double scales[6] = {3, -1, -0.2, 1e-6, 1e6, 1e-14};
    double plain[MAX_V], scaled[MAX_V], q[MAX_Q], p[2][3];
    RUN(rbd_rnea(r->m, r->w, s->q, s->v, s->a, s->f_ext, plain));
    RUN(rbd_kinematics(r->m, r->w, s->q, s->v, NULL));
    RUN(rbd_body_pose(r->m, r->w, r->nb - 1, NULL, p[0]));
    for (int i = 0; i < 6; i++) {
        memcpy(q, s->q, sizeof q);
        for (int body = 0; body < r->nb; body++) {
            rbd_joint_info info;
            const int at = quaternion_of(r, body, &info);
            for (int k = 0; k < 4 && at >= 0; k++) q[at + k] *= scales[i];
        }
        RUN(rbd_rnea(r->m, r->w, q, s->v, s->a, s->f_ext, scaled));
        expect_close("scaled quaternion: rnea", r, number, scaled, plain, r->nv, 1e-13);
        RUN(rbd_aba(r->m, r->w, q, s->v, scaled, s->f_ext, scaled));
        expect_close("scaled quaternion: aba", r, number, scaled, s->a, r->nv, 1e-8);
        RUN(rbd_kinematics(r->m, r->w, q, s->v, NULL));
        RUN(rbd_body_pose(r->m, r->w, r->nb - 1, NULL, p[1]));
        expect_close("scaled quaternion: pose", r, number, p[1], p[0], 3, 1e-13);
    }
}

START_TEST(only_the_direction_of_a_quaternion_counts) { for_random_states(2, check_scaled); }
END_TEST

START_TEST(zero_quaternion_is_the_identity) {
    robot r = robot_build("hyq", reference_model(1)->bodies, reference_model(1)->nb);
    double q[MAX_Q], plain[MAX_V], zero[MAX_V], v[MAX_V];
    for (int k = 0; k < r.nv; k++) v[k] = 0.1 * k;
    ck_assert_int_eq(rbd_neutral(r.m, q), RBD_OK);
    ck_assert_int_eq(rbd_rnea(r.m, r.w, q, v, v, NULL, plain), RBD_OK);
    q[6] = 0;
    ck_assert_int_eq(rbd_rnea(r.m, r.w, q, v, v, NULL, zero), RBD_OK);
    expect_close("zero quaternion", &r, 0, zero, plain, r.nv, 0);
    ck_assert_int_eq(rbd_integrate(r.m, q, v, 0, q), RBD_OK);
    ck_assert(fabs(dot(q + 3, q + 3, 4) - 1) < 1e-15);
    robot_free(&r);
}
END_TEST

/* A single long component is enough to overflow the sum of squares, wherever it stands. */
START_TEST(quaternion_with_one_long_component_counts_by_direction) {
    const rbd_body ball[1] = {
        {.parent = -1, .type = RBD_SPHERICAL, .mass = 1, .inertia = {1, 0, 0, 2, 0, 3}}};
    robot r = BUILD(ball);
    for (int k = 0; k < 4; k++) {
        double unit[4] = {0}, q[4] = {0}, expected[9], R[9];
        unit[k] = 0.6, unit[(k + 1) % 4] = 0.8;
        for (int j = 0; j < 4; j++) q[j] = 1e200 * unit[j];
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, unit, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, expected, NULL), RBD_OK);
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, R, NULL), RBD_OK);
        expect_close("long quaternion", &r, k, R, expected, 9, 1e-15);
    }
    robot_free(&r);
}
END_TEST

/* ---- tolerances ---- */

/* An angle between axes that is 1e-12 rad off a multiple of 90 degrees is taken as that; a larger one is
   kept. */
START_TEST(angles_of_rounding_are_right_angles) {
    const double off[2] = {6e-13, 3e-12};
    for (int i = 0; i < 4; i++) {
        const double given = off[i / 2], kept = i / 2 ? given : 0;
        const double c = i % 2 ? -given : 1, s = i % 2 ? 1 : given; /* of 0 or 90 degrees and `given` */
        const rbd_body arm[2] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, BOX},
                                 {.parent = 0,
                                  .type = RBD_REVOLUTE,
                                  .axis = {0, 0, 1},
                                  .rotation = {1, 0, 0, 0, c, -s, 0, s, c},
                                  BOX}};
        const double q[2] = {0, 0};
        double R[9];
        robot r = BUILD(arm);
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, 1, R, NULL), RBD_OK);
        expect_small("beside a right angle", &r, i, fabs(fabs(i % 2 ? R[4] : R[7]) - kept), 1e-15);
        robot_free(&r);
    }
}
END_TEST

/* A quaternion of 1e-15 has a direction, a shorter one is none: the identity. */
START_TEST(shortest_quaternion_has_a_direction) {
    const rbd_body ball[1] = {{.parent = -1, .type = RBD_SPHERICAL, BOX}};
    const double lengths[2] = {2e-15, 7e-16};
    robot r = BUILD(ball);
    for (int i = 0; i < 2; i++) {
        const double q[4] = {lengths[i], 0, 0, 0}; /* half a turn about x */
        const double expected[9] = {1, 0, 0, 0, i ? 1 : -1, 0, 0, 0, i ? 1 : -1};
        double R[9];
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_body_pose(r.m, r.w, 0, R, NULL), RBD_OK);
        expect_close("short quaternion", &r, i, R, expected, 9, 1e-15);
    }
    robot_free(&r);
}
END_TEST

Suite *joints_suite(void) {
    Suite *suite = suite_create("joints");
    TCase *c = tcase_create("joints");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, cylindrical_is_a_revolute_and_a_prismatic);
    tcase_add_test(c, universal_is_two_revolutes);
    tcase_add_test(c, euler_is_three_revolutes_in_the_order_named);
    tcase_add_test(c, translation_is_three_prismatics);
    tcase_add_test(c, revolute_of_pitch_zero_is_helical);
    tcase_add_test(c, axis_of_any_length_is_the_same_joint);
    tcase_add_test(c, helical_is_a_slide_that_follows_a_turn);
    tcase_add_test(c, mimic_joints_are_a_constraint_on_the_free_model);
    tcase_add_test(c, fixed_bodies_are_merged_and_stay_as_frames);
    tcase_add_test(c, bodies_fixed_to_the_world_carry_without_counting);
    tcase_add_test(c, model_without_degree_of_freedom_is_a_model);
    tcase_add_test(c, several_roots_are_several_robots);
    tcase_add_test(c, order_of_bodies_does_not_matter);
    tcase_add_test(c, every_type_may_stand_anywhere);
    tcase_add_test(c, nearly_parallel_axes_lose_no_accuracy);
    tcase_add_test(c, common_normal_far_from_the_parent_alone_is_no_loss);
    tcase_add_test(c, rotor_beside_massive_links_is_no_loss);
    tcase_add_test(c, angles_of_any_size_keep_their_accuracy);
    tcase_add_test(c, sine_and_cosine_are_right_to_the_last_bits);
    tcase_add_test(c, only_the_direction_of_a_quaternion_counts);
    tcase_add_test(c, zero_quaternion_is_the_identity);
    tcase_add_test(c, quaternion_with_one_long_component_counts_by_direction);
    tcase_add_test(c, angles_of_rounding_are_right_angles);
    tcase_add_test(c, shortest_quaternion_has_a_direction);
    suite_add_tcase(suite, c);
    return suite;
}
