/* tables.c - the built models of models/, as tables, against the same descriptions built at run time: every
   result has the same bits. Compiled with -ffp-contract=off, as the tables were (models/meson.build);
   with -DSCALAR_FLOAT for float. */
#ifdef SCALAR_FLOAT
#define RBD_REAL float
#endif
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "models/atlas.h"
#include "models/atlas_model.h"
#include "models/cart_pole.h"
#include "models/cart_pole_model.h"
#include "models/double_pendulum.h"
#include "models/double_pendulum_model.h"
#include "models/hyq.h"
#include "models/hyq_model.h"
#include "models/iiwa.h"
#include "models/iiwa_model.h"
#include "models/pendulum.h"
#include "models/pendulum_model.h"

#include "quiet_check.h"
#include <stdlib.h>
#include <string.h>

enum { MAX_NB = 40, MAX_NV = 40, MAX_NQ = MAX_NV + 4, STATES = 20 };

typedef struct robot {
    const char *name;
    const rbd_body *bodies;
    int nb;
    const rbd_model *table;
    size_t work_size; /* that the table states */
} robot;

static const robot robots[] = {
    {"iiwa", iiwa_bodies, IIWA_NB, &iiwa_model, IIWA_WORK_SIZE},
    {"hyq", hyq_bodies, HYQ_NB, &hyq_model, HYQ_WORK_SIZE},
    {"atlas", atlas_bodies, ATLAS_NB, &atlas_model, ATLAS_WORK_SIZE},
    {"pendulum", pendulum_bodies, PENDULUM_NB, &pendulum_model, PENDULUM_WORK_SIZE},
    {"double_pendulum", double_pendulum_bodies, DOUBLE_PENDULUM_NB, &double_pendulum_model,
     DOUBLE_PENDULUM_WORK_SIZE},
    {"cart_pole", cart_pole_bodies, CART_POLE_NB, &cart_pole_model, CART_POLE_WORK_SIZE},
};
enum { ROBOTS = sizeof robots / sizeof robots[0] };

typedef struct inputs {
    rbd_real q[MAX_NQ], v[MAX_NV], a[MAX_NV], f_ext[6 * MAX_NB];
} inputs;

/* All that a model has to say of a state. Only arrays of one type: no padding between. */
typedef struct results {
    rbd_real tau[MAX_NV], M[MAX_NV * MAX_NV], packed[MAX_NV * MAX_NV], aba[MAX_NV], cholesky[MAX_NV];
    rbd_real body[MAX_NB][9 + 3 + 6 + 6], energy[2], com[9], passive[MAX_NV];
} results;

static void draw(rbd_real *x, int n, rbd_real size) {
    for (int i = 0; i < n; i++) x[i] = size * ((rbd_real)(rand() % 20001 - 10000) / 10000);
}

#define RUN(call) ck_assert_msg((call) == RBD_OK, "%s: %s", robots[index].name, #call)

static void run(int index, const rbd_model *m, const inputs *in, results *out) {
    void *memory = malloc(rbd_work_size(m));
    rbd_work *w;
    memset(out, 0, sizeof *out);
    RUN(rbd_work_init(m, memory, rbd_work_size(m), &w));
    RUN(rbd_rnea(m, w, in->q, in->v, in->a, in->f_ext, out->tau));
    RUN(rbd_crba(m, w, in->q, out->M));
    RUN(rbd_crba_packed(m, w, in->q, out->packed));
    RUN(rbd_aba(m, w, in->q, in->v, in->a, in->f_ext, out->aba));
    RUN(rbd_fd_cholesky(m, w, in->q, in->v, in->a, in->f_ext, out->cholesky));
    RUN(rbd_passive(m, w, in->v, out->passive));
    RUN(rbd_kinematics(m, w, in->q, in->v, in->a));
    for (int i = 0; i < rbd_nb(m); i++) {
        rbd_real *body = out->body[i];
        RUN(rbd_body_pose(m, w, i, body, body + 9));
        RUN(rbd_body_velocity(m, w, i, body + 12));
        RUN(rbd_body_acceleration(m, w, i, body + 18));
    }
    RUN(rbd_energy(m, w, &out->energy[0], &out->energy[1]));
    RUN(rbd_com(m, w, out->com, out->com + 3, out->com + 6));
    free(memory);
}

static void expect_same(int index, const char *what, const rbd_real *table, const rbd_real *built, size_t n) {
    for (size_t i = 0; i < n; i++)
        ck_assert_msg(memcmp(&table[i], &built[i], sizeof *table) == 0,
                      "%s, %s: %.17g from the table, %.17g built", robots[index].name, what, (double)table[i],
                      (double)built[i]);
}
#define SAME(member) \
    expect_same(index, #member, table.member, built.member, sizeof table.member / sizeof(rbd_real))

START_TEST(tables_give_the_bits_of_the_build) {
    const int index = _i;
    const robot *r = &robots[index];
    const size_t size = rbd_model_size(r->bodies, r->nb);
    void *memory = malloc(size);
    const rbd_model *m;
    uint64_t seed = 11;
    static inputs in;
    static results table, built;
    RUN(rbd_model_build(r->bodies, r->nb, memory, size, &m, NULL));
    ck_assert_int_le(rbd_nb(m), MAX_NB);
    ck_assert_int_le(rbd_nv(m), MAX_NV);
    for (int i = 0; i < STATES; i++) {
        RUN(rbd_random(m, &seed, in.q));
        draw(in.v, MAX_NV, 2);
        draw(in.a, MAX_NV, 20);
        draw(in.f_ext, 6 * MAX_NB, 10);
        run(index, r->table, &in, &table);
        run(index, m, &in, &built);
        SAME(tau);
        SAME(M);
        SAME(packed);
        SAME(aba);
        SAME(cholesky);
        SAME(passive);
        expect_same(index, "bodies", table.body[0], built.body[0], sizeof table.body / sizeof(rbd_real));
        SAME(energy);
        SAME(com);
    }
    free(memory);
}
END_TEST

START_TEST(tables_state_their_work_size) {
    const robot *r = &robots[_i];
    ck_assert_msg(r->work_size == rbd_work_size(r->table), "%s", r->name);
}
END_TEST

START_TEST(tables_know_names_and_limits) {
    const robot *r = &robots[_i];
    for (int i = 0; i < r->nb; i++) {
        const rbd_body *b = &r->bodies[i];
        rbd_joint_info info;
        ck_assert_int_eq(rbd_joint(r->table, i, &info), RBD_OK);
        ck_assert_int_eq(info.type, b->type);
        ck_assert_double_eq(info.lower, (rbd_const)b->lower);
        ck_assert_double_eq(info.upper, (rbd_const)b->upper);
        if (b->name) ck_assert_int_eq(rbd_body_index(r->table, b->name), i);
        if (b->joint) ck_assert_int_eq(rbd_joint_index(r->table, b->joint), i);
    }
}
END_TEST

START_TEST(tables_describe_their_bodies) {
    const double bound = sizeof(rbd_const) == sizeof(double) ? 1e-11 : 1e-6;
    const robot *r = &robots[_i];
    for (int i = 0; i < r->nb; i++) {
        const rbd_body *b = &r->bodies[i];
        rbd_body row;
        ck_assert_int_eq(rbd_describe(r->table, i, &row), RBD_OK);
        ck_assert_int_eq(row.parent, b->parent);
        for (int k = 0; k < 3; k++) {
            ck_assert_double_eq_tol(row.position[k], b->position[k], bound);
            ck_assert_double_eq_tol(row.axis[k], b->axis[k], bound);
            ck_assert_double_eq_tol(row.com[k], b->com[k], bound);
        }
        ck_assert_double_eq((rbd_const)row.mass, (rbd_const)b->mass);
        for (int k = 0; k < 6; k++) ck_assert_double_eq((rbd_const)row.inertia[k], (rbd_const)b->inertia[k]);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("tables");
    TCase *c = tcase_create("tables");
    tcase_add_loop_test(c, tables_give_the_bits_of_the_build, 0, ROBOTS);
    tcase_add_loop_test(c, tables_state_their_work_size, 0, ROBOTS);
    tcase_add_loop_test(c, tables_know_names_and_limits, 0, ROBOTS);
    tcase_add_loop_test(c, tables_describe_their_bodies, 0, ROBOTS);
    suite_add_tcase(suite, c);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
