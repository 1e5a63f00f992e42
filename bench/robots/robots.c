/* The robots and their random states. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "../bench.h"
#include <stdlib.h>
#include <string.h>
#include "../../models/iiwa.h"
#include "../../models/hyq.h"
#include "../../models/atlas.h"
#include "robots_models.h" /* written by tests/data/unpack.py */

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

/* Memory of zeros where blocks of lanes may stand; NULL if there is none. */
static void *zeros(size_t size) {
    void *memory = NULL;
    if (posix_memalign(&memory, 64, size) != 0) return NULL;
    return memset(memory, 0, size);
}

/* ---- model and work, in the scalar of a library ---- */

static int build_model(struct instance *r) {
    const struct robot *robot = r->robot;
    if (r->library == libraries[QUAD]) { /* it judges by the very constants of the double results */
        r->model = robot->instances[DOUBLE].model;
        return 0;
    }
    char text[160] = "";
    size_t size = r->library->model_size(robot->bodies, robot->nb);
    r->model_memory = malloc(size);
    if (r->library->model_build(robot->bodies, robot->nb, r->model_memory, size, &r->model, text) != RBD_OK) {
        fprintf(stderr, "rbd-bench: %s, %s: %s\n", robot->title, r->library->name, text);
        r->model = NULL;
        return -1;
    }
    return 0;
}

static int status_error(const struct robot *robot, rbd_status status) {
    if (status == RBD_OK) return 0;
    fprintf(stderr, "rbd-bench: %s: %s\n", robot->title, rbd_status_string(status));
    return -1;
}

/* Bytes of the results of a call, whatever the algorithm, and some that keep threads apart. */
static size_t out_size(const struct instance *r) {
    return (size_t)r->library->width * (size_t)algorithm_largest(r->robot) * r->library->size + 128;
}

static int open_worker(struct instance *r, struct worker *w) {
    const size_t size = r->library->work_size(r->model);
    w->memory = malloc(size + 128);
    w->out = zeros(out_size(r));
    if (!w->memory || !w->out) return status_error(r->robot, RBD_ERR_MEMORY);
    return status_error(r->robot, r->library->work_init(r->model, w->memory, size, &w->work));
}

static int open_workers(struct instance *r) {
    const bool threads = r->library->variant == LANES && r->library != libraries[LANES_DOUBLE_4];
    r->workers = threads ? threads_available() : 1;
    r->worker = calloc((size_t)r->workers, sizeof *r->worker);
    for (int t = 0; r->worker && t < r->workers; t++)
        if (open_worker(r, &r->worker[t]) != 0) return -1;
    return r->worker ? 0 : status_error(r->robot, RBD_ERR_MEMORY);
}

rbd_work *instance_work(const struct instance *r) {
    const struct rbd_memory *memory = r->worker[0].work;
    return memory->work;
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
    for (size_t i = 0; i < n; i++) x[i] = bound * (2 * ((double)(splitmix64(state) >> 11) * 0x1p-53) - 1);
}

/* Numbers in a state. */
static size_t state_length(const struct instance *r) { return (size_t)r->nq + 3 * (size_t)r->nv; }

/* So many states, and those that fill their last block. */
static size_t with_last_block(const struct library *l, size_t n) {
    const size_t block = l->blocks ? (size_t)l->lanes : 1;
    return (n + block - 1) / block * block;
}

/* Room for n states; all q come first, then all v, a and tau. */
static void *make_states(const struct instance *r, size_t n, struct states *states) {
    const size_t size = r->library->size, room = with_last_block(r->library, n);
    const size_t q_size = room * (size_t)r->nq * size, v_size = room * (size_t)r->nv * size;
    char *q = zeros(room * state_length(r) * size);
    if (q) *states = (struct states){q, q + q_size, q + q_size + v_size, q + q_size + 2 * v_size};
    return q;
}

/* q by rbd_random, the rest uniform in the ranges of the reference states. */
static void draw_states(const struct instance *r, int samples, uint64_t seed) {
    const size_t n = (size_t)samples, nq = (size_t)r->robot->nq, nv = (size_t)r->robot->nv;
    double *q = r->state_memory, *v = q + n * nq, *a = v + n * nv, *tau = a + n * nv;
    uint64_t state_q = seed, state = ~seed; /* rbd_random's generator may be this one: give each its own */
    for (size_t k = 0; k < n; k++) rbd_random(r->model, &state_q, q + k * nq);
    fill_uniform(v, n * nv, 2, &state);
    fill_uniform(a, n * nv, 3, &state);
    fill_uniform(tau, n * nv, 20, &state);
}

/* State k among n that lie as make_states has them. */
static struct state state_at(double *memory, size_t n, size_t k, size_t nq, size_t nv) {
    double *v = memory + n * nq, *a = v + n * nv, *tau = a + n * nv;
    return (struct state){memory + k * nq, v + k * nv, a + k * nv, tau + k * nv};
}

struct state robot_state(const struct robot *r, int k) {
    const struct instance *d = &r->instances[DOUBLE];
    return state_at(d->state_memory, (size_t)r->samples, (size_t)k, (size_t)d->nq, (size_t)d->nv);
}

size_t number_place(const struct library *l, int numbers, int k, int i) {
    const int block = l->blocks ? l->lanes : 1;
    return ((size_t)(k / block) * (size_t)numbers + (size_t)i) * (size_t)block + (size_t)(k % block);
}

void take_numbers(const struct library *l, const void *array, int numbers, int k, double *x) {
    for (int i = 0; i < numbers; i++)
        l->to_double((const char *)array + number_place(l, numbers, k, i) * l->size, 1, &x[i]);
}

/* One array of all random states, rounded, in the library's places; the last state fills the last block. */
static void place_numbers(const struct instance *other, const double *x, int numbers, const void *array) {
    const struct library *l = other->library;
    const int n = other->robot->samples;
    char *y = (char *)other->state_memory + ((const char *)array - (const char *)other->states.q);
    for (int k = 0; k < (int)with_last_block(l, (size_t)n); k++)
        for (int i = 0; i < numbers; i++)
            l->from_double(&x[(size_t)(k < n ? k : n - 1) * (size_t)numbers + (size_t)i], 1,
                           y + number_place(l, numbers, k, i) * l->size);
}

static void place_states(const struct instance *other) {
    const struct robot *r = other->robot;
    const struct states *from = &r->instances[DOUBLE].states, *to = &other->states;
    place_numbers(other, from->q, r->nq, to->q);
    place_numbers(other, from->v, r->nv, to->v);
    place_numbers(other, from->a, r->nv, to->a);
    place_numbers(other, from->tau, r->nv, to->tau);
}

/* All random states, in the conventions of another library. */
static void convert_states(const struct instance *other) {
    const struct robot *r = other->robot;
    for (int k = 0; k < r->samples; k++) {
        const struct state from = robot_state(r, k);
        const struct state to = state_at(other->state_memory, (size_t)r->samples, (size_t)k,
                                         (size_t)other->nq, (size_t)other->nv);
        other->library->conventions->state(other->model, &from, &to);
    }
}

void instance_take_sample(const struct instance *to, const struct instance *from, int k) {
    const struct robot *robot = to->robot;
    const struct states *s = &from->states;
    const void *const source[4] = {s->q, s->v, s->a, s->tau};
    char *target = to->input_memory;
    for (int i = 0; i < 4; i++) {
        const int n = i == 0 ? robot->nq : robot->nv;
        take_numbers(from->library, source[i], n, k, robot->numbers);
        to->library->from_double(robot->numbers, (size_t)n, target);
        target += (size_t)n * to->library->size;
    }
}

/* ---- together ---- */

static int out_of_memory(const struct robot *r, int samples) {
    fprintf(stderr, "rbd-bench: %s: not enough memory for %d states\n", r->title, samples);
    return -1;
}

static void instance_close(struct instance *r) {
    for (int t = 0; r->worker && t < r->workers; t++) {
        if (r->library->work_free && r->worker[t].work) r->library->work_free(r->worker[t].work);
        free(r->worker[t].memory);
        free(r->worker[t].out);
    }
    if (r->model && r->library->model_free) r->library->model_free(r->model);
    free(r->worker);
    free(r->model_memory);
    free(r->state_memory);
    free(r->input_memory);
    *r = (struct instance){.library = NULL};
}

/* Model, work and room for results and a state. */
static int instance_open(struct instance *r, const struct robot *robot, const struct library *library) {
    *r = (struct instance){.robot = robot, .library = library, .nq = robot->nq, .nv = robot->nv};
    if (build_model(r) != 0) return -1;
    if (library->conventions) library->conventions->size(r->model, &r->nq, &r->nv);
    if (open_workers(r) != 0) return -1;
    r->input_memory = make_states(r, 1, &r->input);
    return r->input_memory ? 0 : out_of_memory(robot, 1);
}

static int open_double(struct robot *r, uint64_t seed) {
    struct instance *d = &r->instances[DOUBLE];
    if (instance_open(d, r, libraries[DOUBLE]) != 0) return -1;
    r->numbers = calloc((size_t)algorithm_largest(r) + state_length(d), sizeof *r->numbers);
    if (!r->numbers) return out_of_memory(r, 1);
    if (r->nq != rbd_nq(d->model) || r->nv != rbd_nv(d->model)) {
        fprintf(stderr, "rbd-bench: %s: the model has nq = %d, nv = %d, the reference %d, %d\n", r->title,
                rbd_nq(d->model), rbd_nv(d->model), r->nq, r->nv);
        return -1;
    }
    r->packed = rbd_packed_size(d->model);
    d->state_memory = make_states(d, (size_t)r->samples, &d->states);
    if (!d->state_memory) return out_of_memory(r, r->samples);
    draw_states(d, r->samples, seed);
    return 0;
}

/* The open instance whose states are those that this one needs, if there is one. */
static const struct instance *like_states(const struct robot *r, const struct instance *other) {
    for (int i = 0; i < TIMED && library_is_ours(other->library); i++) {
        const struct instance *s = &r->instances[i];
        if (s != other && s->states.q && library_is_ours(s->library) &&
            s->library->blocks == other->library->blocks &&
            strcmp(s->library->scalar, other->library->scalar) == 0)
            return s;
    }
    return NULL;
}

/* Gives another library that is timed the states of double, rounded or converted. */
static int give_states(struct robot *r, struct instance *other) {
    const size_t n = (size_t)r->samples;
    const struct instance *like = like_states(r, other);
    if (like) {
        other->states = like->states;
        return 0;
    }
    other->state_memory = make_states(other, n, &other->states);
    if (!other->state_memory) return out_of_memory(r, r->samples);
    if (library_is_ours(other->library))
        place_states(other);
    else
        convert_states(other);
    return 0;
}

static bool has_mimic(const struct robot *r) {
    for (int i = 0; i < r->nb; i++)
        if (r->bodies[i].mimic) return true;
    return false;
}

/* Another library that is timed. One that is not rbd may be without this robot. */
static int open_other(struct robot *r, const struct library *library, struct instance *other) {
    if (!library_is_ours(library) && has_mimic(r)) {
        fprintf(stderr, "rbd-bench: %s, %s: left out, it would not know the mimic joints\n", r->title,
                library->name);
        return 0;
    }
    if (instance_open(other, r, library) == 0) return give_states(r, other);
    if (library_is_ours(library)) return -1;
    instance_close(other);
    return 0;
}

int robot_take_lengths(struct robot *r) {
    const size_t size = rbd_model_size(r->bodies, r->nb);
    const rbd_model *m;
    void *memory = malloc(size);
    const int good = memory && rbd_model_build(r->bodies, r->nb, memory, size, &m, NULL) == RBD_OK;
    if (good) {
        r->nq = rbd_nq(m);
        r->nv = rbd_nv(m);
    }
    free(memory);
    return good ? 0 : -1;
}

/* Has the world hold the base still. There are no stored results of such a robot. */
static int hold_base(struct robot *r) {
    const size_t size = (size_t)r->nb * sizeof *r->held;
    if (r->bodies[0].type != RBD_FLOATING) return 0;
    r->held = malloc(size);
    if (!r->held) return out_of_memory(r, r->samples);
    memcpy(r->held, r->bodies, size);
    r->held[0].type = RBD_FIXED;
    r->bodies = r->held;
    r->reference = NULL;
    return robot_take_lengths(r);
}

/* A robot of the table. */
static void describe(struct robot *r, int index) {
    const struct description *d = &descriptions[index];
    *r = (struct robot){.name = robot_names[index], .title = d->title, .bodies = d->bodies, .nb = d->nb};
    r->reference = d->reference;
    r->nq = d->reference->nq;
    r->nv = d->reference->nv;
}

int robot_open(struct robot *r, int index, const struct options *o) {
    if (!o->model)
        describe(r, index);
    else if (robot_load(r, o) != 0)
        return -1;
    r->samples = o->samples;
    if (o->fixed_base && hold_base(r) != 0) return -1;
    if (open_double(r, o->seed) != 0) return -1;
    for (int i = DOUBLE + 1; i < TIMED; i++)
        if (library_wanted(libraries[i], r, o) && open_other(r, libraries[i], &r->instances[i]) != 0)
            return -1;
    return libraries[QUAD] ? instance_open(&r->instances[QUAD], r, libraries[QUAD]) : 0;
}

void robot_close(struct robot *r) {
    for (int i = 0; i < LIBRARIES; i++) instance_close(&r->instances[i]);
    free(r->numbers);
    free(r->held);
}
