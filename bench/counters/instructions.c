/* Runs, under callgrind, the calls whose instructions instructions.sh counts; ../README.md has the method.
   SPDX-License-Identifier: MIT */
#include <string.h>
#include <valgrind/callgrind.h>
#include "../bench.h"
#include "rbd_derivatives.h"
#include "rbd_constraints.h"
#include "../../models/iiwa.h"
#include "../../models/hyq.h"
#include "../../models/atlas.h"

enum { STATES = BATCH, MAX_LANES = 8 };
enum { MAX_NB = ATLAS_NB, MAX_NQ = ATLAS_NQ, MAX_NV = ATLAS_NV }; /* the largest robot's */

/* Static, so that every run has them at the same addresses. */
static unsigned char model_memory[RBD_MODEL_SIZE(MAX_NB)];
static unsigned char
    variant_memory[2 * (MAX_LANES + 1) *
                   (RBD_WORK_SIZE(MAX_NB, MAX_NV) + RBD_DERIVATIVES_SIZE(MAX_NB, MAX_NV) +
                    RBD_CONSTRAINT_SET_SIZE(MAX_NV, 12) + RBD_CONSTRAINT_SET_SIZE(MAX_NV, 15))];
static rbd_real q[STATES * MAX_NQ], v[STATES * MAX_NV], a[STATES * MAX_NV], tau[STATES * MAX_NV];
static rbd_real out[STATES * MAX_NV * 10 * MAX_NB];

/* ---- robots ---- */

struct counted_robot {
    const char *name;
    const rbd_body *bodies;
    int nb;
    const rbd_model *model;
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
    if (status != RBD_OK) return status;
    r->nq = rbd_nq(r->model);
    r->nv = rbd_nv(r->model);
    return r->nq <= MAX_NQ && r->nv <= MAX_NV ? draw_states(r) : RBD_ERR_MEMORY;
}

/* ---- the calls, by the tables of calls/library.c ---- */

extern const struct library PLAIN_LIBRARY, LANES_LIBRARY;
#ifdef GENERATED_LIBRARIES
extern const struct library library_iiwa_code, library_hyq_code, library_atlas_code, library_iiwa_code_lanes,
    library_hyq_code_lanes, library_atlas_code_lanes;
#endif

static const struct library *const variants[] = {
    &PLAIN_LIBRARY,           &LANES_LIBRARY,
#ifdef GENERATED_LIBRARIES
    &library_iiwa_code,       &library_hyq_code,       &library_atlas_code,
    &library_iiwa_code_lanes, &library_hyq_code_lanes, &library_atlas_code_lanes,
#endif
};

static const struct {
    const char *name;
    const rbd_real *x; /* what it takes besides q and v */
} algorithms_counted[ALGORITHMS] = {
    [ID] = {"id", a},
    [MM] = {"mm", tau},
    [MM_PACKED] = {"mm_packed", tau},
    [FD] = {"fd", tau},
    [FD_CHOLESKY] = {"fd_cholesky", tau},
    [HYBRID] = {"hybrid", a},
    [FREE_BASE] = {"id_free_base", a},
    [MINV] = {"minv", tau},
    [JACOBIAN] = {"jacobian", tau},
    [BODY_JACOBIAN] = {"body_jacobian", tau},
    [MOMENTUM_MATRIX] = {"momentum_matrix", tau},
    [CORIOLIS] = {"coriolis", tau},
    [REGRESSOR] = {"regressor", a},
    [ID_DERIVATIVES] = {"id_derivatives", a},
    [ID_DERIVATIVES_MM] = {"id_derivatives_mm", a},
    [FD_DERIVATIVES] = {"fd_derivatives", tau},
    [CONSTRAINED] = {"constrained_fd", tau},
    [CONSTRAINED_HAND] = {"constrained_fd_hand", tau},
};

/* ---- counting ---- */

/* One thing to count: an algorithm of a variant. */
struct cell {
    const struct counted_robot *robot;
    const struct library *library;
    int algorithm;
    void *work;
};

/* The counted loop; what it needs lies in locals, so that little but the calls is counted. */
static rbd_status run(const struct cell *c) {
    library_call *const call = c->library->call[c->algorithm];
    const void *const m = c->robot->model;
    void *const work = c->work;
    const int n = c->library->width, nq = n * c->robot->nq, nv = n * c->robot->nv;
    const rbd_real *qk = q, *vk = v, *xk = algorithms_counted[c->algorithm].x,
                   *end = q + STATES * c->robot->nq;
    rbd_status status = RBD_OK;
    for (; qk < end && status == RBD_OK; qk += nq, vk += nv, xk += nv)
        status = call(m, work, n, qk, vk, xk, out);
    return status;
}

/* "ROBOT,ALGORITHM,CALLS,VARIANT", which callgrind writes down with the counts. */
static void describe(const struct cell *c, char *text, size_t size) {
    static const char *const names[VARIANTS] = {[RUN_TIME] = "run-time",
                                                [GENERATED] = "generated",
                                                [LANES] = "lanes",
                                                [BLOCKS] = "blocks",
                                                [GENERATED_LANES] = "generated-lanes",
                                                [GENERATED_BLOCKS] = "generated-blocks"};
    const struct library *l = c->library;
    char variant[32];
    if (l->lanes > 1)
        snprintf(variant, sizeof variant, "%s %d", names[l->variant], l->lanes);
    else
        snprintf(variant, sizeof variant, "%s", names[l->variant]);
    snprintf(text, size, "%s,%s,%d,%s", c->robot->name, algorithms_counted[c->algorithm].name, STATES,
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

static rbd_status count_variant(const struct counted_robot *r, const struct library *l) {
    const double gravity[3] = {0, 0, -9.81};
    struct cell c = {.robot = r, .library = l};
    rbd_status status = l->work_init(r->model, variant_memory, sizeof variant_memory, &c.work);
    if (status == RBD_OK) status = l->set_gravity(c.work, gravity);
    for (; c.algorithm < ALGORITHMS && status == RBD_OK; c.algorithm++)
        if (l->call[c.algorithm] && (!l->can || l->can(r->model, c.algorithm))) status = count(&c);
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
        if (status == RBD_OK) status = count_variants(r);
        if (status != RBD_OK) {
            fprintf(stderr, "instructions: %s: %s\n", r->name, rbd_status_string(status));
            return 1;
        }
    }
    return 0;
}
