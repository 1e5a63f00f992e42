/* Runs, under callgrind, the calls whose instructions instructions.sh counts; ../README.md has the method.
   SPDX-License-Identifier: MIT */
#include <string.h>
#include <valgrind/callgrind.h>
#include "../bench.h"
#include "../../models/iiwa.h"
#include "../../models/hyq.h"
#include "../../models/atlas.h"

enum { STATES = BATCH, MAX_LANES = 8 };
enum { MAX_NB = ATLAS_NB, MAX_NQ = ATLAS_NQ, MAX_NV = ATLAS_NV }; /* the largest robot's */

/* Static, so that every run has them at the same addresses. */
static unsigned char model_memory[RBD_MODEL_SIZE(MAX_NB)], work_memory[RBD_WORK_SIZE(MAX_NB, MAX_NV)];
static unsigned char lanes_memory[MAX_LANES * sizeof work_memory];
static rbd_real q[STATES * MAX_NQ], v[STATES * MAX_NV], a[STATES * MAX_NV], tau[STATES * MAX_NV];
static rbd_real out[STATES * MAX_NV * MAX_NV];

/* ---- robots ---- */

struct counted_robot {
    const char *name;
    const rbd_body *bodies;
    int nb;
    const rbd_model *model;
    rbd_work *work;
    int nq, nv;
};

static struct counted_robot robots[] = {
    {.name = "iiwa", .bodies = iiwa_bodies, .nb = IIWA_NB},
    {.name = "hyq", .bodies = hyq_bodies, .nb = HYQ_NB},
    {.name = "atlas", .bodies = atlas_bodies, .nb = ATLAS_NB},
};

/* Uniform in [-bound, bound), by Knuth's linear congruential generator (MMIX). */
static void fill_uniform(rbd_real *x, int n, double bound, uint64_t *seed) {
    for (int i = 0; i < n; i++) {
        *seed = *seed * 6364136223846793005u + 1442695040888963407u;
        x[i] = (rbd_real)(bound * ((double)(*seed >> 11) * 0x1p-52 - 1));
    }
}

static rbd_status draw_states(const struct counted_robot *r) {
    uint64_t seed_q = 1, seed = 2;
    for (int k = 0; k < STATES; k++) {
        rbd_status status = rbd_random(r->model, &seed_q, q + k * r->nq);
        if (status != RBD_OK) return status;
    }
    fill_uniform(v, STATES * r->nv, 2, &seed);
    fill_uniform(a, STATES * r->nv, 3, &seed);
    fill_uniform(tau, STATES * r->nv, 20, &seed);
    return RBD_OK;
}

/* Builds the robot's model in the memory that all robots share, and draws its states. */
static rbd_status open_robot(struct counted_robot *r) {
    rbd_status status = rbd_model_build(r->bodies, r->nb, model_memory, sizeof model_memory, &r->model, NULL);
    if (status == RBD_OK) status = rbd_work_init(r->model, work_memory, sizeof work_memory, &r->work);
    if (status != RBD_OK) return status;
    r->nq = rbd_nq(r->model);
    r->nv = rbd_nv(r->model);
    return r->nq <= MAX_NQ && r->nv <= MAX_NV ? draw_states(r) : RBD_ERR_MEMORY;
}

/* ---- calls for a model known at run time ---- */

typedef rbd_status matrix_call(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *M);
typedef rbd_status dynamics_call(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                 const rbd_real *x, const rbd_real *f_ext, rbd_real *out);

/* One of the two calls is given. */
struct plain_call {
    const char *name;
    matrix_call *matrix;
    dynamics_call *dynamics;
    const rbd_real *x; /* the third vector of dynamics */
};

static const struct plain_call plain_calls[] = {
    {.name = "id", .dynamics = rbd_rnea, .x = a},
    {.name = "mm", .matrix = rbd_crba},
    {.name = "mm_packed", .matrix = rbd_crba_packed},
    {.name = "fd", .dynamics = rbd_aba, .x = tau},
    {.name = "fd_cholesky", .dynamics = rbd_fd_cholesky, .x = tau},
};

/* The counted loops; what they need lies in locals, so that little but the calls is counted. */

static rbd_status run_matrix(matrix_call *call, const struct counted_robot *r) {
    const rbd_model *m = r->model;
    rbd_work *w = r->work;
    const rbd_real *qk = q, *end = q + STATES * r->nq;
    const int nq = r->nq;
    rbd_status status = RBD_OK;
    for (; qk < end && status == RBD_OK; qk += nq) status = call(m, w, qk, out);
    return status;
}

static rbd_status run_dynamics(dynamics_call *call, const struct counted_robot *r, const rbd_real *x) {
    const rbd_model *m = r->model;
    rbd_work *w = r->work;
    const rbd_real *qk = q, *vk = v, *xk = x, *end = q + STATES * r->nq;
    const int nq = r->nq, nv = r->nv;
    rbd_status status = RBD_OK;
    for (; qk < end && status == RBD_OK; qk += nq, vk += nv, xk += nv)
        status = call(m, w, qk, vk, xk, NULL, out);
    return status;
}

static rbd_status run_plain(const struct plain_call *g, const struct counted_robot *r) {
    return g->matrix ? run_matrix(g->matrix, r) : run_dynamics(g->dynamics, r, g->x);
}

/* ---- calls of the other variants, by the tables of calls/library.c ---- */

extern const struct library LANES_LIBRARY;
#ifdef COMPILE_TIME_LIBRARIES
extern const struct library library_iiwa, library_hyq, library_atlas;
#endif

static const struct library *const variants[] = {
    &LANES_LIBRARY,
#ifdef COMPILE_TIME_LIBRARIES
    &library_iiwa,
    &library_hyq,
    &library_atlas,
#endif
};

static const char *const names[ALGORITHMS] = {
    [ID] = "id", [MM] = "mm", [MM_PACKED] = "mm_packed", [FD] = "fd", [FD_CHOLESKY] = "fd_cholesky"};

static rbd_status run_variant(const struct library *l, int algorithm, const struct counted_robot *r,
                              void *work) {
    const rbd_real *x = algorithm == ID ? a : tau;
    rbd_status status = RBD_OK;
    for (int k = 0; k < STATES && status == RBD_OK; k += l->width)
        status =
            l->call[algorithm](r->model, work, l->width, q + k * r->nq, v + k * r->nv, x + k * r->nv, out);
    return status;
}

/* ---- counting ---- */

/* One thing to count: a plain call, or an algorithm of a variant. */
struct cell {
    const struct counted_robot *robot;
    const struct plain_call *plain;
    const struct library *library;
    int algorithm;
    void *work;
};

static rbd_status run(const struct cell *c) {
    return c->plain ? run_plain(c->plain, c->robot)
                    : run_variant(c->library, c->algorithm, c->robot, c->work);
}

/* "ROBOT,ALGORITHM,CALLS,VARIANT", which callgrind writes down with the counts. */
static void describe(const struct cell *c, char *text, size_t size) {
    const struct library *l = c->library;
    char variant[32] = "run-time";
    if (l && l->variant == LANES)
        snprintf(variant, sizeof variant, "lanes %d", l->lanes);
    else if (l)
        snprintf(variant, sizeof variant, "compile-time");
    snprintf(text, size, "%s,%s,%d,%s", c->robot->name, l ? names[c->algorithm] : c->plain->name, STATES,
             variant);
}

/* Counts one round of calls. */
static rbd_status count(const struct cell *c) {
    char text[96];
    describe(c, text, sizeof text);
    rbd_status status = run(c); /* not counted: the first call of a libm function binds it */
    if (status != RBD_OK) {
        fprintf(stderr, "instructions: %s: %s\n", text, rbd_status_string(status));
        return status;
    }
    CALLGRIND_ZERO_STATS;
    CALLGRIND_TOGGLE_COLLECT;
    status = run(c);
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT(text);
    return status;
}

static rbd_status count_plain(const struct counted_robot *r) {
    rbd_status status = RBD_OK;
    for (size_t i = 0; i < sizeof plain_calls / sizeof *plain_calls && status == RBD_OK; i++)
        status = count(&(struct cell){.robot = r, .plain = &plain_calls[i]});
    return status;
}

static rbd_status count_variant(const struct counted_robot *r, const struct library *l) {
    const double gravity[3] = {0, 0, -9.81};
    struct cell c = {.robot = r, .library = l};
    rbd_status status = l->work_init(r->model, lanes_memory, sizeof lanes_memory, &c.work);
    if (status == RBD_OK) status = l->set_gravity(c.work, gravity);
    for (; c.algorithm < ALGORITHMS && status == RBD_OK; c.algorithm++) status = count(&c);
    return status;
}

static rbd_status count_variants(const struct counted_robot *r) {
    rbd_status status = RBD_OK;
    for (size_t i = 0; i < sizeof variants / sizeof *variants && status == RBD_OK; i++)
        if (!variants[i]->robot || strcmp(variants[i]->robot, r->name) == 0)
            status = count_variant(r, variants[i]);
    return status;
}

int main(void) {
    for (size_t i = 0; i < sizeof robots / sizeof *robots; i++) {
        struct counted_robot *r = &robots[i];
        rbd_status status = open_robot(r);
        if (status == RBD_OK) status = count_plain(r);
        if (status == RBD_OK) status = count_variants(r);
        if (status != RBD_OK) {
            fprintf(stderr, "instructions: %s: %s\n", r->name, rbd_status_string(status));
            return 1;
        }
    }
    return 0;
}
