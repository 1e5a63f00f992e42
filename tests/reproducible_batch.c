/* reproducible_batch.c - RBD_REPRODUCIBLE: a batch call gives each of its states the bits of the single call.
   Linked with batch.c, of any number of lanes. */
#ifndef RBD_REPRODUCIBLE
#define RBD_REPRODUCIBLE
#endif
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "rbd_derivatives.h"

#include "rbd_batch.h"

#include "models/atlas_model.h"
#include "models/hyq_model.h"
#include "models/iiwa_model.h"

#include <stdio.h>
#include <stdlib.h>

#define WORLD_LONG_DOUBLE /* nothing is computed with it here */
#include "fuzz/robots.c"

int world_nv(const rbd_body *b) { return rbdi_joint_facts(b->type)->nv; }
int world_nq(const rbd_body *b) { return rbdi_joint_facts(b->type)->nq; }

enum { STATES = 11 }; /* not whole batches */

static int failures, checks;

/* Inputs of all states; results of the single calls and of the batch, up to four arrays of each. */
typedef struct arrays {
    RBD_REAL *q, *v, *a, *f_ext, *one, *many;
    size_t width[4];
} arrays;

static RBD_REAL *of_state(const arrays *x, RBD_REAL *from, int array, int state) {
    size_t at = 0;
    for (int k = 0; k < array; k++) at += x->width[k] * STATES;
    return from + at + x->width[array] * (size_t)state;
}

static void set_widths(arrays *x, int a, int b, int c, int d) {
    x->width[0] = (size_t)a, x->width[1] = (size_t)b, x->width[2] = (size_t)c, x->width[3] = (size_t)d;
}

static void compare(const char *robot, const char *call, const arrays *x, const rbd_status *status) {
    for (int s = 0; s < STATES; s++)
        for (int k = 0; k < 4 && !status[s]; k++) {
            checks++;
            if (!memcmp(of_state(x, x->one, k, s), of_state(x, x->many, k, s),
                        x->width[k] * sizeof(RBD_REAL)))
                continue;
            failures++;
            printf("FAILED: %s: %s, state %d: other bits\n", robot, call, s);
        }
}

/* single: of state s, into ONE(0) and on; batch: into ALL(0) and on. */
#define ONE(k) of_state(x, x->one, k, s)
#define ALL(k) of_state(x, x->many, k, 0)
#define COMPARE(call, single, batch) \
    do { \
        rbd_status status[STATES]; \
        for (int s = 0; s < STATES; s++) { \
            const RBD_REAL *q = x->q + s * rbd_nq(m), *v = x->v + s * rbd_nv(m), *a = x->a + s * rbd_nv(m); \
            const RBD_REAL *f = x->f_ext + 6 * s * rbd_nb(m); \
            (void)v, (void)a, (void)f; \
            status[s] = single; \
        } \
        { \
            const RBD_REAL *q = x->q, *v = x->v, *a = x->a, *f = x->f_ext; \
            const int n = STATES; \
            (void)v, (void)a, (void)f; \
            (void)batch; \
        } \
        compare(robot, call, x, status); \
    } while (0)

static void compare_dynamics(const char *robot, const rbd_model *m, rbd_work *w, rbd_batch *b, arrays *x) {
    const int nv = rbd_nv(m), last = rbd_nb(m) - 1;
    const RBD_REAL point[3] = {(RBD_REAL)0.125, (RBD_REAL)-0.25, (RBD_REAL)0.5};
    set_widths(x, nv, 0, 0, 0);
    COMPARE("rnea", rbd_rnea(m, w, q, v, a, f, ONE(0)), rbd_batch_rnea(m, b, n, q, v, a, f, ALL(0)));
    COMPARE("bias", rbd_bias(m, w, q, v, f, ONE(0)), rbd_batch_bias(m, b, n, q, v, f, ALL(0)));
    COMPARE("aba", rbd_aba(m, w, q, v, a, f, ONE(0)), rbd_batch_aba(m, b, n, q, v, a, f, ALL(0)));
    COMPARE("fd_cholesky", rbd_fd_cholesky(m, w, q, v, a, f, ONE(0)),
            rbd_batch_fd_cholesky(m, b, n, q, v, a, f, ALL(0)));
    set_widths(x, rbd_packed_size(m), 0, 0, 0);
    COMPARE("crba_packed", rbd_crba_packed(m, w, q, ONE(0)), rbd_batch_crba_packed(m, b, n, q, ALL(0)));
    set_widths(x, nv * nv, 0, 0, 0);
    COMPARE("crba", rbd_crba(m, w, q, ONE(0)), rbd_batch_crba(m, b, n, q, ALL(0)));
    COMPARE("minverse", rbd_minverse(m, w, q, ONE(0)), rbd_batch_minverse(m, b, n, q, ALL(0)));
    set_widths(x, 6 * nv, 0, 0, 0);
    COMPARE("jacobian",
            (rbd_kinematics(m, w, q, NULL, NULL), rbd_jacobian(m, w, last, point, RBD_LINK_AXES, ONE(0))),
            rbd_batch_jacobian(m, b, n, q, last, point, RBD_LINK_AXES, ALL(0)));
    set_widths(x, 6, 6, 0, 0);
    COMPARE("momentum", (rbd_kinematics(m, w, q, v, a), rbd_momentum(m, w, ONE(0), ONE(1))),
            rbd_batch_momentum(m, b, n, q, v, a, ALL(0), ALL(1)));
}

static void compare_derivatives(const char *robot, const rbd_model *m, rbd_work *w, rbd_batch *b, arrays *x) {
    const size_t size = rbd_derivatives_size(m), batch_size = rbd_batch_derivatives_size(m);
    void *memory = malloc(size), *batch_memory = malloc(batch_size);
    const int nv = rbd_nv(m);
    rbd_derivatives *d;
    rbd_batch_derivatives *bd;
    rbd_derivatives_init(m, w, memory, size, &d);
    rbd_batch_derivatives_init(m, b, batch_memory, batch_size, &bd);
    set_widths(x, 6 * nv, 6, 0, 0);
    COMPARE("momentum_matrix", rbd_momentum_matrix(m, d, q, v, ONE(0), ONE(1)),
            rbd_batch_momentum_matrix(m, bd, n, q, v, ALL(0), ALL(1)));
    set_widths(x, nv * nv, nv * nv, nv * nv, 0);
    COMPARE("coriolis", rbd_coriolis(m, d, q, v, ONE(0)), rbd_batch_coriolis(m, bd, n, q, v, ALL(0)));
    COMPARE("id_derivatives", rbd_id_derivatives(m, d, q, v, a, f, ONE(0), ONE(1), ONE(2)),
            rbd_batch_id_derivatives(m, bd, n, q, v, a, f, ALL(0), ALL(1), ALL(2)));
    set_widths(x, nv, nv * nv, nv * nv, nv * nv);
    COMPARE("fd_derivatives", rbd_fd_derivatives(m, d, q, v, a, f, ONE(0), ONE(1), ONE(2), ONE(3)),
            rbd_batch_fd_derivatives(m, bd, n, q, v, a, f, ALL(0), ALL(1), ALL(2), ALL(3)));
    set_widths(x, 10 * rbd_nb(m) * nv, 0, 0, 0);
    COMPARE("regressor", rbd_regressor(m, d, q, v, a, ONE(0)),
            rbd_batch_regressor(m, bd, n, q, v, a, ALL(0)));
    free(memory), free(batch_memory);
}

static void compare_constraints(const char *robot, const rbd_model *m, rbd_work *w, rbd_batch *b, arrays *x) {
    const double place[3] = {0.125, 0, 0.25};
    rbd_constraint list[1] = {rbd_point_contact(rbd_nb(m) - 1, place, NULL)};
    const size_t size = rbd_constraint_set_size(m, list, 1),
                 batch_size = rbd_batch_constraint_set_size(m, list, 1);
    void *memory = malloc(size), *batch_memory = malloc(batch_size);
    rbd_constraint_set *c;
    rbd_batch_constraint_set *bc;
    rbd_constraint_set_init(m, w, list, 1, memory, size, &c, NULL);
    rbd_batch_constraint_set_init(m, b, list, 1, batch_memory, batch_size, &bc, NULL);
    set_widths(x, rbd_nv(m), 3, 0, 0);
    COMPARE("constrained_fd", rbd_constrained_fd(m, c, q, v, a, f, ONE(0), ONE(1)),
            rbd_batch_constrained_fd(m, bc, n, q, v, a, f, ALL(0), ALL(1)));
    free(memory), free(batch_memory);
}

/* In steps of 2^-20, that float has too. */
static void draw_numbers(uint64_t *seed, double size, RBD_REAL *x, int n) {
    for (int i = 0; i < n; i++) x[i] = (RBD_REAL)(size * (below(seed, 2097152) - 1048576) / 1048576);
}

static void compare_calls(const char *robot, const rbd_model *m) {
    const int nb = rbd_nb(m), nq = rbd_nq(m), nv = rbd_nv(m);
    const size_t size = rbd_work_size(m), batch_size = rbd_batch_size(m),
                 room = (size_t)(3 * nv * nv + 10 * nb * nv + 10 * nv + 12) * STATES;
    void *memory = malloc(size), *batch_memory = malloc(batch_size);
    uint64_t seed = 1;
    arrays all, *x = &all;
    rbd_work *w;
    rbd_batch *b;
    x->q = (RBD_REAL *)malloc(sizeof(RBD_REAL) * ((size_t)((nq + 2 * nv + 6 * nb) * STATES) + 2 * room));
    x->v = x->q + nq * STATES, x->a = x->v + nv * STATES, x->f_ext = x->a + nv * STATES;
    x->one = x->f_ext + 6 * nb * STATES, x->many = x->one + room;
    memset(x->one, 0, 2 * room * sizeof(RBD_REAL));
    if (rbd_work_init(m, memory, size, &w) || rbd_batch_init(m, batch_memory, batch_size, &b)) abort();
    draw_numbers(&seed, 3, x->v, nv * STATES);
    draw_numbers(&seed, 50, x->a, nv * STATES); /* torques too */
    draw_numbers(&seed, 30, x->f_ext, 6 * nb * STATES);
    for (int s = 0; s < STATES; s++) {
        rbd_random(m, &seed, x->q + s * nq);
        if (s == 7) rbd_integrate(m, x->q + s * nq, x->v + s * nv, 1 << 16, x->q + s * nq); /* large angles */
    }
    compare_dynamics(robot, m, w, b, x);
    compare_derivatives(robot, m, w, b, x);
    compare_constraints(robot, m, w, b, x);
    free(memory), free(batch_memory), free(x->q);
}

/* A rod at the end of two joints, almost in line with the first: its pivot is in doubt. Blocks, and the
   accelerations in the array of the torques. */
static void compare_in_place(void) {
    static const rbd_body bodies[2] = {
        {.name = "yoke", .joint = "turn", .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}},
        {.name = "rod",
         .joint = "tilt",
         .parent = 0,
         .type = RBD_REVOLUTE,
         .axis = {0, 1, 0},
         .mass = 1,
         .com = {0, 0, 1}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(2)], work_memory[RBD_WORK_SIZE(2, 2)];
    const double close = sizeof(RBD_REAL) == 4 ? 1 / 128. : 1 / 16384.;
    const rbd_model *m;
    rbd_work *w;
    rbd_batch *b;
    if (rbd_model_build(bodies, 2, model_memory, sizeof model_memory, &m, NULL)) abort();
    if (rbd_work_init(m, work_memory, sizeof work_memory, &w)) abort();
    const int lanes = rbd_batch_lanes();
    const size_t size = rbd_batch_size(m), row = (size_t)lanes * sizeof(RBD_REAL), bytes = 2 * row;
    unsigned char *memory = malloc(size), *room = calloc(1, 4 * bytes);
    const size_t skip = (row - (uintptr_t)room % row) % row; /* the quick path asks for whole vectors */
    RBD_REAL *q = (RBD_REAL *)(void *)(room + skip), *v = q + 2 * lanes, *tau = v + 2 * lanes;
    if (rbd_batch_init(m, memory, size, &b) || rbd_batch_set_layout(b, RBD_BLOCKS)) abort();
    for (int s = 0; s < lanes; s++) {
        q[lanes + s] = (RBD_REAL)(s == 0 ? close : 0.25 * s);
        v[s] = v[lanes + s] = (RBD_REAL)0.5;
        tau[s] = (RBD_REAL)(1 / 1024.), tau[lanes + s] = (RBD_REAL)(1 + s);
    }
    if (rbd_batch_aba(m, b, lanes, q, v, tau, NULL, tau)) failures++, printf("FAILED: in place\n");
    for (int s = 0; s < lanes; s++) {
        const RBD_REAL own_q[2] = {0, q[lanes + s]}, own_v[2] = {v[s], v[lanes + s]},
                       own_tau[2] = {(RBD_REAL)(1 / 1024.), (RBD_REAL)(1 + s)};
        RBD_REAL a[2];
        checks++;
        if (rbd_aba(m, w, own_q, own_v, own_tau, NULL, a) == RBD_OK && a[0] == tau[s] &&
            a[1] == tau[lanes + s])
            continue;
        failures++;
        printf("FAILED: rbd_batch_aba in place, state %d: other bits\n", s);
    }
    free(memory), free(room);
}

int main(void) {
    static sample s;
    compare_in_place();
    compare_calls("iiwa", &iiwa_model);
    compare_calls("hyq", &hyq_model);
    compare_calls("atlas", &atlas_model);
    for (int class_number = 0; class_number < CLASSES; class_number++)
        for (int i = 0; i < 3; i++) {
            rbd_model const *m;
            draw_robot(&s, class_number, i);
            const size_t size = rbd_model_size(s.bodies, s.nb);
            void *memory = malloc(size);
            if (!rbd_model_build(s.bodies, s.nb, memory, size, &m, NULL) && rbd_nv(m) > 0)
                compare_calls(class_names[class_number], m);
            free(memory);
        }
    printf("%d results compared, %d failed\n", checks, failures);
    return failures > 0 || checks == 0;
}
