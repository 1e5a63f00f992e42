/* The robots and their random states. SPDX-License-Identifier: MIT */
#include "bench.h"
#include <stdlib.h>
#include <string.h>
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

/* ---- model and work, in the scalar of a library ---- */

static int build_model(struct instance *r) {
    const struct robot *robot = r->robot;
    if (r->library == libraries[QUAD]) { /* it judges by the very constants of the double results */
        r->model = robot->instances[DOUBLE].model;
        return 0;
    }
    rbd_report report;
    size_t size = r->library->model_size(robot->bodies, robot->nb);
    r->model_memory = malloc(size);
    if (r->library->model_build(robot->bodies, robot->nb, r->model_memory, size, &r->model, &report) !=
        RBD_OK) {
        char text[200];
        fprintf(stderr, "rbd-bench: %s: %s\n", robot->title,
                rbd_finding_text(&report.error, text, sizeof text));
        return -1;
    }
    return 0;
}

static int status_error(const struct robot *robot, rbd_status status) {
    if (status == RBD_OK)
        return 0;
    fprintf(stderr, "rbd-bench: %s: %s\n", robot->title, rbd_status_string(status));
    return -1;
}

/* Bytes of the results of a call, whatever the algorithm, and some that keep threads apart. */
static size_t out_size(const struct instance *r) {
    const size_t nv = (size_t)r->robot->nv;
    return (size_t)r->library->width * nv * nv * r->library->size + 128;
}

static int open_worker(struct instance *r, struct worker *w) {
    const size_t size = r->library->work_size(r->model);
    w->memory = malloc(size + 128);
    w->out = calloc(1, out_size(r));
    if (!w->memory || !w->out)
        return status_error(r->robot, RBD_ERR_MEMORY);
    return status_error(r->robot, r->library->work_init(r->model, w->memory, size, &w->work));
}

static int open_workers(struct instance *r) {
    r->workers = r->library->variant == LANES ? threads_available() : 1;
    r->worker = calloc((size_t)r->workers, sizeof *r->worker);
    for (int t = 0; r->worker && t < r->workers; t++)
        if (open_worker(r, &r->worker[t]) != 0)
            return -1;
    return r->worker ? 0 : status_error(r->robot, RBD_ERR_MEMORY);
}

void robot_set_gravity(const struct robot *r, const double gravity[3]) {
    for (int i = 0; i < LIBRARIES; i++)
        for (int t = 0; t < r->instances[i].workers; t++)
            r->instances[i].library->set_gravity(r->instances[i].worker[t].work, gravity);
}

/* ---- states ---- */

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

/* Numbers in a state. */
static size_t state_length(const struct robot *r) {
    return (size_t)r->nq + 3 * (size_t)r->nv;
}

/* Room for n states; all q come first, then all v, a and tau. */
static void *make_states(const struct instance *r, size_t n, struct states *states) {
    const size_t size = r->library->size;
    const size_t q_size = n * (size_t)r->robot->nq * size, v_size = n * (size_t)r->robot->nv * size;
    char *q = calloc(n, state_length(r->robot) * size);
    if (q)
        *states = (struct states){q, q + q_size, q + q_size + v_size, q + q_size + 2 * v_size};
    return q;
}

/* q by rbd_random, the rest uniform in the ranges of the reference states. */
static void draw_states(const struct instance *r, int samples, uint64_t seed) {
    const size_t n = (size_t)samples, nq = (size_t)r->robot->nq, nv = (size_t)r->robot->nv;
    double *q = r->state_memory, *v = q + n * nq, *a = v + n * nv, *tau = a + n * nv;
    uint64_t state_q = seed, state = ~seed; /* rbd_random's generator may be this one: give each its own */
    for (size_t k = 0; k < n; k++)
        rbd_random(r->model, &state_q, q + k * nq);
    fill_uniform(v, n * nv, 2, &state);
    fill_uniform(a, n * nv, 3, &state);
    fill_uniform(tau, n * nv, 20, &state);
}

void instance_take_sample(const struct instance *to, const struct instance *from, int k) {
    const struct robot *robot = to->robot;
    const struct states *s = &from->states;
    const void *const source[4] = {s->q, s->v, s->a, s->tau};
    char *target = to->input_memory;
    for (int i = 0; i < 4; i++) {
        const size_t n = (size_t)(i == 0 ? robot->nq : robot->nv);
        const char *x = (const char *)source[i] + (size_t)k * n * from->library->size;
        from->library->to_double(x, n, robot->numbers);
        to->library->from_double(robot->numbers, n, target);
        target += n * to->library->size;
    }
}

/* ---- together ---- */

static int out_of_memory(const struct robot *r, int samples) {
    fprintf(stderr, "rbd-bench: %s: not enough memory for %d states\n", r->title, samples);
    return -1;
}

/* Model, work and room for results and a state. */
static int instance_open(struct instance *r, const struct robot *robot, const struct library *library) {
    *r = (struct instance){.robot = robot, .library = library};
    if (build_model(r) != 0 || open_workers(r) != 0)
        return -1;
    r->input_memory = make_states(r, 1, &r->input);
    return r->input_memory ? 0 : out_of_memory(robot, 1);
}

static int open_double(struct robot *r, int samples, uint64_t seed) {
    struct instance *d = &r->instances[DOUBLE];
    const size_t nv = (size_t)r->nv;
    r->numbers = calloc(nv * nv + state_length(r), sizeof *r->numbers);
    if (!r->numbers)
        return out_of_memory(r, 1);
    if (instance_open(d, r, libraries[DOUBLE]) != 0)
        return -1;
    if (r->nq != rbd_nq(d->model) || r->nv != rbd_nv(d->model)) {
        fprintf(stderr, "rbd-bench: %s: the model has nq = %d, nv = %d, the reference %d, %d\n", r->title,
                rbd_nq(d->model), rbd_nv(d->model), r->nq, r->nv);
        return -1;
    }
    r->packed = rbd_packed_size(d->model);
    d->state_memory = make_states(d, (size_t)samples, &d->states);
    if (!d->state_memory)
        return out_of_memory(r, samples);
    draw_states(d, samples, seed);
    return 0;
}

/* The open instance whose states are those that this one needs, if there is one. */
static const struct instance *like_states(const struct robot *r, const struct instance *other) {
    for (int i = 0; i < TIMED; i++) {
        const struct instance *s = &r->instances[i];
        if (s != other && s->states.q && strcmp(s->library->scalar, other->library->scalar) == 0)
            return s;
    }
    return NULL;
}

/* Another library that is timed: the states are those of double, rounded. */
static int open_other(struct robot *r, int library, int samples) {
    const size_t n = (size_t)samples;
    struct instance *other = &r->instances[library];
    if (instance_open(other, r, libraries[library]) != 0)
        return -1;
    const struct instance *like = like_states(r, other);
    if (like) {
        other->states = like->states;
        return 0;
    }
    other->state_memory = make_states(other, n, &other->states);
    if (!other->state_memory)
        return out_of_memory(r, samples);
    const double *drawn = r->instances[DOUBLE].state_memory;
    other->library->from_double(drawn, n * state_length(r), other->state_memory);
    return 0;
}

int robot_open(struct robot *r, int index, const struct options *o) {
    const struct description *d = &descriptions[index];
    *r = (struct robot){.name = robot_names[index], .title = d->title, .bodies = d->bodies, .nb = d->nb};
    r->reference = d->reference;
    r->nq = d->reference->nq;
    r->nv = d->reference->nv;
    if (open_double(r, o->samples, o->seed) != 0)
        return -1;
    for (int i = DOUBLE + 1; i < TIMED; i++)
        if (library_wanted(libraries[i], r, o) && open_other(r, i, o->samples) != 0)
            return -1;
    return libraries[QUAD] ? instance_open(&r->instances[QUAD], r, libraries[QUAD]) : 0;
}

static void instance_close(struct instance *r) {
    for (int t = 0; r->worker && t < r->workers; t++) {
        free(r->worker[t].memory);
        free(r->worker[t].out);
    }
    free(r->worker);
    free(r->model_memory);
    free(r->state_memory);
    free(r->input_memory);
}

void robot_close(struct robot *r) {
    for (int i = 0; i < LIBRARIES; i++)
        instance_close(&r->instances[i]);
    free(r->numbers);
}
