/* The robots and their random states. SPDX-License-Identifier: MIT */
#include "bench.h"
#include <stdlib.h>
#include "../models/iiwa.h"
#include "../models/hyq.h"
#include "../models/atlas.h"
#include "../tests/data/iiwa.inc"
#include "../tests/data/hyq.inc"
#include "../tests/data/atlas.inc"

struct description {
    const char *title;
    const rbd_body *bodies;
    int nb;
    const ref_model *reference;
};

const char *const robot_names[] = {"iiwa", "hyq", "atlas", NULL};

static const struct description descriptions[] = {
    {"iiwa", iiwa_bodies, IIWA_NB, &ref_iiwa},
    {"HyQ", hyq_bodies, HYQ_NB, &ref_hyq},
    {"Atlas", atlas_bodies, ATLAS_NB, &ref_atlas},
};

/* ---- the model ---- */

static int build_model(struct robot *r, const struct description *d) {
    rbd_report report;
    size_t size = rbd_model_size(d->bodies, d->nb);
    r->model_memory = malloc(size);
    if (rbd_model_build(d->bodies, d->nb, r->model_memory, size, &r->model, &report) != RBD_OK) {
        char text[200];
        fprintf(stderr, "rbd-bench: %s: %s\n", r->title, rbd_finding_text(&report.error, text, sizeof text));
        return -1;
    }
    r->nq = rbd_nq(r->model);
    r->nv = rbd_nv(r->model);
    return 0;
}

static int init_work(struct robot *r) {
    size_t size = rbd_work_size(r->model);
    r->work_memory = malloc(size);
    rbd_status status = rbd_work_init(r->model, r->work_memory, size, &r->work);
    if (status != RBD_OK)
        fprintf(stderr, "rbd-bench: %s: %s\n", r->title, rbd_status_string(status));
    return status == RBD_OK ? 0 : -1;
}

/* ---- random states ---- */

/* Steele, Lea, Flood: Fast splittable pseudorandom number generators (2014). */
static uint64_t splitmix64(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static void fill_uniform(double *x, size_t n, double bound, uint64_t *state) {
    for (size_t i = 0; i < n; i++)
        x[i] = bound * (2 * ((double)(splitmix64(state) >> 11) * 0x1p-53) - 1);
}

/* q by rbd_random, the rest uniform in the ranges of the reference states. */
static int draw_states(struct robot *r, int samples, uint64_t seed) {
    const size_t n = (size_t)samples, nq = (size_t)r->nq, nv = (size_t)r->nv;
    double *q = calloc(n, (nq + 3 * nv) * sizeof *q);
    double *v = q + n * nq, *a = v + n * nv, *tau = a + n * nv;
    r->out = calloc(nv * nv, sizeof *r->out);
    r->state_memory = q;
    if (!q || !r->out) {
        fprintf(stderr, "rbd-bench: %s: not enough memory for %d states\n", r->title, samples);
        return -1;
    }
    uint64_t state_q = seed, state = ~seed; /* rbd_random's generator may be this one: give each its own */
    for (size_t k = 0; k < n; k++)
        rbd_random(r->model, &state_q, q + k * nq);
    fill_uniform(v, n * nv, 2, &state);
    fill_uniform(a, n * nv, 3, &state);
    fill_uniform(tau, n * nv, 20, &state);
    r->states = (struct states){q, v, a, tau};
    return 0;
}

/* ---- together ---- */

int robot_open(struct robot *r, int index, int samples, uint64_t seed) {
    const struct description *d = &descriptions[index];
    *r = (struct robot){.name = robot_names[index], .title = d->title, .reference = d->reference};
    if (build_model(r, d) != 0 || init_work(r) != 0)
        return -1;
    if (r->nq != d->reference->nq || r->nv != d->reference->nv) {
        fprintf(stderr, "rbd-bench: %s: the model has nq = %d, nv = %d, the reference %d, %d\n", r->title,
                r->nq, r->nv, d->reference->nq, d->reference->nv);
        return -1;
    }
    return draw_states(r, samples, seed);
}

void robot_close(struct robot *r) {
    free(r->model_memory);
    free(r->work_memory);
    free(r->state_memory);
    free(r->out);
}
