/* test_payload.c - mass added to a built model, against a new build. */
#include <math.h>
#include <string.h>

#include "suites.h"
#include "support.h"

enum { MAX_M = MAX_V * MAX_V };

typedef struct payload {
    double mass, com[3], inertia[6];
} payload;

/* A body with a payload, about the origin: sums, and back to the common centre of mass. */
static void merge(rbd_body *b, const payload *load) {
    const double mass[2] = {b->mass, load->mass}, *com[2] = {b->com, load->com},
                 *inertia[2] = {b->inertia, load->inertia};
    long double m = 0, h[3] = {0}, I[6] = {0};
    for (int j = 0; j < 2; j++) {
        const double *c = com[j];
        m += mass[j];
        for (int k = 0; k < 3; k++) h[k] += (long double)mass[j] * c[k];
        for (int a = 0, k = 0; a < 3; a++)
            for (int d = a; d < 3; d++, k++)
                I[k] += inertia[j][k] +
                        mass[j] * ((a == d ? (long double)c[0] * c[0] + c[1] * c[1] + c[2] * c[2] : 0) -
                                   (long double)c[a] * c[d]);
    }
    b->mass = (double)m;
    for (int k = 0; k < 3; k++) h[k] /= m;
    for (int k = 0; k < 3; k++) b->com[k] = (double)h[k];
    for (int a = 0, k = 0; a < 3; a++)
        for (int d = a; d < 3; d++, k++)
            b->inertia[k] =
                (double)(I[k] - m * ((a == d ? h[0] * h[0] + h[1] * h[1] + h[2] * h[2] : 0) - h[a] * h[d]));
}

/* The same results of all algorithms, by two models. */
static void expect_alike(const robot *r, const robot *expected, const state *s, int number, double bound) {
    double M[2][MAX_M], x[2][6 * MAX_BODIES], e[2][2];
    const robot *both[2] = {expected, r};
    rbd_status status[2];
    for (int i = 0; i < 2; i++) {
        rbd_set_gravity(both[i]->w, s->gravity);
        RUN(rbd_crba(both[i]->m, both[i]->w, s->q, M[i]));
        RUN(rbd_rnea(both[i]->m, both[i]->w, s->q, s->v, s->a, s->f_ext, x[i]));
    }
    expect_close("payload: crba", r, number, M[1], M[0], r->nv * r->nv, bound);
    expect_close("payload: rnea", r, number, x[1], x[0], r->nv, bound);
    for (int i = 0; i < 2; i++)
        RUN(rbd_joint_wrench(both[i]->m, both[i]->w, s->q, s->v, s->a, s->f_ext, x[i]));
    expect_close("payload: joint wrench", r, number, x[1], x[0], 6 * r->nb, bound);
    for (int i = 0; i < 2; i++) RUN(rbd_energy(both[i]->m, both[i]->w, &e[i][0], &e[i][1]));
    expect_close("payload: energy", r, number, e[1], e[0], 2, bound);
    for (int i = 0; i < 2; i++) RUN(rbd_com(both[i]->m, both[i]->w, x[i], x[i] + 3, x[i] + 6));
    expect_close("payload: com", r, number, x[1], x[0], 9, bound);
    for (int i = 0; i < 2; i++) RUN(rbd_generalized_momentum(both[i]->m, both[i]->w, s->q, s->v, x[i], NULL));
    expect_close("payload: momentum", r, number, x[1], x[0], r->nv, bound);
    tb_real a[TB_MAX_DOFS];
    const double condition =
        (double)tb_forward(expected->bodies, expected->nb, s->gravity, s->q, s->v, s->tau, s->f_ext, a);
    for (int i = 0; i < 2; i++)
        status[i] = rbd_aba(both[i]->m, both[i]->w, s->q, s->v, s->tau, s->f_ext, x[i]);
    if (condition > 0 && condition < 1e9) {
        ck_assert_int_eq(status[0], RBD_OK);
        ck_assert_int_eq(status[1], RBD_OK);
        expect_close("payload: aba", r, number, x[1], x[0], r->nv, inverse_bound(condition));
    }
}

static void draw_payload(uint64_t *seed, payload *load) {
    rbd_body b = {.mass = 0};
    random_mass(seed, &b);
    load->mass = b.mass;
    memcpy(load->com, b.com, sizeof load->com);
    memcpy(load->inertia, b.inertia, sizeof load->inertia);
}

static void check_tree(const robot *r, const state *s, int number) {
    uint64_t seed = 77 + (uint64_t)number;
    rbd_body bodies[MAX_BODIES];
    payload load;
    const int body = below(&seed, r->nb);
    memcpy(bodies, r->bodies, (size_t)r->nb * sizeof *bodies);
    draw_payload(&seed, &load);
    merge(&bodies[body], &load);
    robot rebuilt = robot_build("rebuilt", bodies, r->nb), before = robot_build("before", r->bodies, r->nb);
    ck_assert_int_eq(rbd_add_payload(r->memory[0], body, load.mass, load.com, load.inertia), RBD_OK);
    expect_alike(r, &rebuilt, s, number, 1e-12);
    for (int k = 0; k < r->nv; k++) { /* of the same size; where frames stand may differ */
        const double ratio = r->m->dof[k].scale / rebuilt.m->dof[k].scale;
        ck_assert_msg(1. / 64 < ratio && ratio < 64, "%s: bound of pivot %d: %g", r->name, k, ratio);
    }
    for (int i = 0; i < r->m->nl && !r->m->nmimic; i++) { /* of a slide it is the mass that slides */
        const rbdi_link *l = &r->m->link[i];
        const rbdi_dof *d = &r->m->dof[l->iv], *expected = &rebuilt.m->dof[l->iv];
        if (l->kind == RBDI_SCREW && l->rho <= 0)
            ck_assert_msg(fabs(d->scale - expected->scale) <= 1e-12 * expected->scale, "%s: slide %d",
                          r->name, i);
    }
    for (int k = 0; k < 6; k++) load.inertia[k] = -load.inertia[k];
    ck_assert_int_eq(rbd_add_payload(r->memory[0], body, -load.mass, load.com, load.inertia), RBD_OK);
    expect_alike(r, &before, s, number, 1e-12);
    robot_free(&rebuilt);
    robot_free(&before);
}

START_TEST(results_are_those_of_a_new_build) {
    for_random_trees(25, check_tree);
    for_random_states(2, check_tree);
}
END_TEST

/* Every type, alone and inside; on a fixed body; on what a mimic joint moves. */
START_TEST(every_joint_type_passes_it_on) {
    for (int type = RBD_FIXED; type < RBD_JOINT_TYPES; type++)
        for (int trial = 0; trial < 4; trial++) {
            uint64_t seed = (uint64_t)(100 * type + trial + 1);
            rbd_body b[3];
            state s;
            const rbd_joint_type types[3] = {RBD_REVOLUTE, (rbd_joint_type)type,
                                             trial % 2 ? RBD_FIXED : RBD_REVOLUTE};
            for (int k = 0; k < 3; k++) {
                random_joint(&seed, b, k, types[k]);
                random_mass(&seed, &b[k]);
                b[k].parent = k - 1;
            }
            robot r = robot_build("type", b, 3);
            draw_state(&r, &seed, &s);
            for (int number = 0; number < 3; number++) check_tree(&r, &s, number);
            robot_free(&r);
        }
}
END_TEST

static void expect_refused(const robot *r, rbd_status status, int body, double mass, const double *com,
                           const double *inertia) {
    const size_t size = rbd_model_size(r->bodies, r->nb);
    unsigned char *copy = malloc(size);
    memcpy(copy, r->memory[0], size);
    ck_assert_int_eq(rbd_add_payload(r->memory[0], body, mass, com, inertia), status);
    ck_assert_msg(memcmp(copy, r->memory[0], size) == 0, "the model changed");
    free(copy);
}

START_TEST(errors_have_their_names) {
    const rbd_body arm[2] = {
        {.parent = -1, .type = RBD_FIXED, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 2, .inertia = {1, 0, 0, 1, 0, 1}}};
    const double none[3] = {0}, far[3] = {0, 0, 3}, nan3[3] = {0, (double)NAN, 0},
                 inf[6] = {(double)INFINITY}, less[6] = {-2};
    unsigned char zeros[RBD_MODEL_SIZE(2)] = {0};
    robot r = BUILD(arm);
    ck_assert_int_eq(rbd_add_payload(NULL, 1, 1, none, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_add_payload(zeros, 1, 1, none, NULL), RBD_ERR_VERSION);
    expect_refused(&r, RBD_ERR_NULL, 1, 1, NULL, NULL);
    expect_refused(&r, RBD_ERR_INDEX, -1, 1, none, NULL);
    expect_refused(&r, RBD_ERR_INDEX, 2, 1, none, NULL);
    expect_refused(&r, RBD_ERR_MASS, 1, (double)NAN, none, NULL);
    expect_refused(&r, RBD_ERR_MASS, 1, -2.1, none, NULL);
    expect_refused(&r, RBD_ERR_COM, 1, 1, nan3, NULL);
    expect_refused(&r, RBD_ERR_INERTIA, 1, 1, none, inf);
    expect_refused(&r, RBD_ERR_INERTIA, 1, 1, none, less);
    expect_refused(&r, RBD_ERR_INERTIA, 1, -1, far, NULL);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 0, 1, far, NULL), RBD_OK); /* fixed in the world */
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 1, 0.1, far, NULL), RBD_OK);
    ck_assert(fabs(rbd_mass(r.m) - 2.1) < 1e-15);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 1, -0.1, far, NULL), RBD_OK);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 1, -2, none, NULL), RBD_OK); /* its inertia is left */
    ck_assert(rbd_mass(r.m) <= 0);
    robot_free(&r);
}
END_TEST

/* Numbers far from a robot's reach the remaining branches. */
START_TEST(extremes_are_judged_too) {
    const rbd_body arm[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .armature = {1}},
        {.parent = 0, .type = RBD_FIXED}};
    const double none[3] = {0}, away[3] = {1, 0, 0}, far[3] = {1e200, 0, 0}, inertia[6] = {1, 0, 0, 1, 0, 1},
                 minus[6] = {-1, 0, 0, -1, 0, -1};
    robot r = BUILD(arm);
    rbd_model *m = (rbd_model *)(uintptr_t)r.m;
    expect_refused(&r, RBD_ERR_INERTIA, 0, 1, far, NULL); /* it overflows */
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 1, 0, none, NULL), RBD_OK);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 0, 0, none, inertia), RBD_OK);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 0, 0, none, minus), RBD_OK);
    /* so heavy that the arm is lost in its rounding: the bound of the pivot is not below the rotor */
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 0, 1e17, away, NULL), RBD_OK);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 0, -1e17, away, NULL), RBD_OK);
    ck_assert_double_ge(m->dof[0].scale, m->dof[0].armature);
    m->scalar = 4;
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 0, 1, none, NULL), RBD_ERR_VERSION);
    m->scalar = sizeof(rbd_const);
    robot_free(&r);
}
END_TEST

/* On what follows another joint: its source carries it as well. */
START_TEST(followers_pass_it_on) {
    const rbd_body hand[3] = {{.joint = "source",
                               .parent = -1,
                               .type = RBD_REVOLUTE,
                               .axis = {0, 1, 0},
                               .mass = 1,
                               .com = {0, 0, 0.5},
                               .inertia = {0.1, 0, 0, 0.1, 0, 0.1}},
                              {.joint = "knuckle",
                               .parent = 0,
                               .type = RBD_REVOLUTE,
                               .axis = {1, 0, 0},
                               .position = {0, 0, 1},
                               .mass = 1,
                               .com = {0, 0.2, 0.3},
                               .inertia = {0.1, 0, 0, 0.1, 0, 0.1}},
                              {.joint = "follower",
                               .parent = 1,
                               .type = RBD_REVOLUTE,
                               .axis = {0, 1, 0},
                               .position = {0, 0, 1},
                               .mass = 1,
                               .com = {0.1, 0, 0.5},
                               .inertia = {0.1, 0, 0, 0.1, 0, 0.1},
                               .mimic = "source",
                               .mimic_ratio = 2}};
    rbd_body loaded[3];
    const payload load = {3, {0.1, 0.2, 0.3}, {0.2, 0, 0, 0.2, 0, 0.2}};
    uint64_t seed = 1;
    state s;
    memcpy(loaded, hand, sizeof loaded);
    merge(&loaded[2], &load);
    robot r = BUILD(hand), expected = BUILD(loaded);
    ck_assert_int_eq(rbd_add_payload(r.memory[0], 2, load.mass, load.com, load.inertia), RBD_OK);
    draw_state(&r, &seed, &s);
    expect_alike(&r, &expected, &s, 0, 1e-12);
    const double ratio = r.m->dof[0].scale / expected.m->dof[0].scale;
    ck_assert_msg(0.99 < ratio && ratio < 1.03, "%g", ratio); /* the source's bound of pivots */
    robot_free(&r);
    robot_free(&expected);
}
END_TEST

Suite *payload_suite(void) {
    Suite *suite = suite_create("payload");
    TCase *c = tcase_create("payload");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, results_are_those_of_a_new_build);
    tcase_add_test(c, every_joint_type_passes_it_on);
    tcase_add_test(c, errors_have_their_names);
    tcase_add_test(c, extremes_are_judged_too);
    tcase_add_test(c, followers_pass_it_on);
    suite_add_tcase(suite, c);
    return suite;
}
