/* Runs, under callgrind, the calls whose instructions instructions.sh counts; README.md has the method.
   SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <valgrind/callgrind.h>
#include "rbd.h"
#include "../models/iiwa.h"
#include "../models/hyq.h"
#include "../models/atlas.h"

enum { STATES = 64 };
enum { MAX_NB = ATLAS_NB, MAX_NQ = ATLAS_NQ, MAX_NV = ATLAS_NV }; /* the largest robot's */

/* Static, so that every run has them at the same addresses. */
static unsigned char model_memory[RBD_MODEL_SIZE(MAX_NB)], work_memory[RBD_WORK_SIZE(MAX_NB, MAX_NV)];
static rbd_real q[STATES * MAX_NQ], v[STATES * MAX_NV], a[STATES * MAX_NV], tau[STATES * MAX_NV];
static rbd_real out[MAX_NV * MAX_NV];

/* ---- robots ---- */

struct robot {
    const char *name;
    const rbd_body *bodies;
    int nb;
    const rbd_model *model;
    rbd_work *work;
    int nq, nv;
};

static struct robot robots[] = {
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

static rbd_status draw_states(const struct robot *r) {
    uint64_t seed_q = 1, seed = 2;
    for (int k = 0; k < STATES; k++) {
        rbd_status status = rbd_random(r->model, &seed_q, q + k * r->nq);
        if (status != RBD_OK)
            return status;
    }
    fill_uniform(v, STATES * r->nv, 2, &seed);
    fill_uniform(a, STATES * r->nv, 3, &seed);
    fill_uniform(tau, STATES * r->nv, 20, &seed);
    return RBD_OK;
}

/* Builds the robot's model in the memory that all robots share, and draws its states. */
static rbd_status robot_open(struct robot *r) {
    rbd_status status = rbd_model_build(r->bodies, r->nb, model_memory, sizeof model_memory, &r->model, NULL);
    if (status == RBD_OK)
        status = rbd_work_init(r->model, work_memory, sizeof work_memory, &r->work);
    if (status != RBD_OK)
        return status;
    r->nq = rbd_nq(r->model);
    r->nv = rbd_nv(r->model);
    return r->nq <= MAX_NQ && r->nv <= MAX_NV ? draw_states(r) : RBD_ERR_MEMORY;
}

/* ---- algorithms ---- */

typedef rbd_status matrix_call(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *M);
typedef rbd_status dynamics_call(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                                 const rbd_real *x, const rbd_real *f_ext, rbd_real *out);

/* One of the two calls is given. */
struct algorithm {
    const char *name;
    matrix_call *matrix;
    dynamics_call *dynamics;
    const rbd_real *x; /* the third vector of dynamics */
};

static const struct algorithm algorithms[] = {
    {.name = "id", .dynamics = rbd_rnea, .x = a},
    {.name = "mm", .matrix = rbd_crba},
    {.name = "mm_packed", .matrix = rbd_crba_packed},
    {.name = "fd", .dynamics = rbd_aba, .x = tau},
    {.name = "fd_cholesky", .dynamics = rbd_fd_cholesky, .x = tau},
};

/* The counted loops; what they need lies in locals, so that little but the calls is counted. */

static rbd_status run_matrix(matrix_call *call, const struct robot *r) {
    const rbd_model *m = r->model;
    rbd_work *w = r->work;
    const rbd_real *qk = q, *end = q + STATES * r->nq;
    const int nq = r->nq;
    rbd_status status = RBD_OK;
    for (; qk < end && status == RBD_OK; qk += nq)
        status = call(m, w, qk, out);
    return status;
}

static rbd_status run_dynamics(dynamics_call *call, const struct robot *r, const rbd_real *x) {
    const rbd_model *m = r->model;
    rbd_work *w = r->work;
    const rbd_real *qk = q, *vk = v, *xk = x, *end = q + STATES * r->nq;
    const int nq = r->nq, nv = r->nv;
    rbd_status status = RBD_OK;
    for (; qk < end && status == RBD_OK; qk += nq, vk += nv, xk += nv)
        status = call(m, w, qk, vk, xk, NULL, out);
    return status;
}

static rbd_status run(const struct algorithm *g, const struct robot *r) {
    return g->matrix ? run_matrix(g->matrix, r) : run_dynamics(g->dynamics, r, g->x);
}

/* ---- counting ---- */

/* Counts one round of calls, and has callgrind write it down as "ROBOT,ALGORITHM,CALLS". */
static rbd_status count(const struct algorithm *g, const struct robot *r) {
    char cell[64];
    snprintf(cell, sizeof cell, "%s,%s,%d", r->name, g->name, STATES);
    rbd_status status = run(g, r); /* not counted: the first call of a libm function binds it */
    if (status != RBD_OK)
        return status;
    CALLGRIND_ZERO_STATS;
    CALLGRIND_TOGGLE_COLLECT;
    status = run(g, r);
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT(cell);
    return status;
}

static int fail(const char *robot, const char *what, rbd_status status) {
    fprintf(stderr, "instructions: %s, %s: %s\n", robot, what, rbd_status_string(status));
    return 1;
}

int main(void) {
    for (size_t i = 0; i < sizeof robots / sizeof *robots; i++) {
        struct robot *r = &robots[i];
        rbd_status status = robot_open(r);
        if (status != RBD_OK)
            return fail(r->name, "model", status);
        for (size_t j = 0; j < sizeof algorithms / sizeof *algorithms; j++) {
            status = count(&algorithms[j], r);
            if (status != RBD_OK)
                return fail(r->name, algorithms[j].name, status);
        }
    }
    return 0;
}
