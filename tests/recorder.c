/* recorder.c - examples/firmware/recorder.h. With a number of ticks: the dump of a ring of four after so many
   ticks, for replay.py. Without: each byte of a model's constants changes its hash. Every byte of an array is
   flipped; as many must change the hash as the fields have. The others are padding and names. */
#include <stdio.h>
#include <stdlib.h>

#define RBD_IMPLEMENTATION
#include "examples/firmware/recorder.h"
#include "models/hyq.h"

static int failures;

static void expect(int holds, const char *what) {
    if (holds) return;
    printf("FAILED: %s\n", what);
    failures++;
}

/* Flips each byte of an array of the model. */
static void flip(const rbd_model *m, const char *name, const void *array, size_t length, size_t size,
                 size_t fields) {
    unsigned char *bytes = (unsigned char *)(uintptr_t)array;
    const uint64_t hash = recorder_model(m);
    size_t seen = 0;
    for (size_t i = 0; i < length * size; i++) {
        bytes[i] ^= 1;
        seen += recorder_model(m) != hash;
        bytes[i] ^= 1;
    }
    if (seen != length * fields)
        printf("%s: %lu of %lu\n", name, (unsigned long)seen, (unsigned long)(length * fields));
    expect(length > 0 && seen == length * fields, "each byte of a constant changes the hash");
    expect(recorder_model(m) == hash, "a model has one hash");
}

static void check_model(void) {
    enum { S = sizeof(rbd_const), I = sizeof(int16_t), J = sizeof(int32_t), NB = HYQ_NB + 1 };
    static unsigned char memory[RBD_MODEL_SIZE(NB)];
    rbd_body bodies[NB];
    const rbd_model *built;
    memcpy(bodies, hyq_bodies, sizeof hyq_bodies);
    bodies[NB - 1] = (rbd_body){.name = "tail",
                                .joint = "tail",
                                .parent = 0,
                                .type = RBD_REVOLUTE,
                                .axis = {0, 1, 0},
                                .mass = 1,
                                .com = {0.1, 0, 0.2},
                                .mimic = bodies[1].joint,
                                .mimic_ratio = 2};
    const rbd_status status = rbd_model_build(bodies, NB, memory, sizeof memory, &built, NULL);
    expect(status == RBD_OK, rbd_status_string(status));
    if (status != RBD_OK) return;
    rbd_model *m = (rbd_model *)(uintptr_t)built;
    const size_t n = (size_t)(m->nv + m->nmimic);
    flip(m, "gravity", &m->gravity, 1, sizeof m->gravity, 3 * S);
    flip(m, "link", m->link, (size_t)m->nl, sizeof *m->link, 9 * I + 25 * S);
    flip(m, "block", m->block, (size_t)m->nblock, sizeof *m->block, 4 * I + 9 * S);
    flip(m, "dof", m->dof, n, sizeof *m->dof, 5 * I + J + 4 * S);
    flip(m, "order", m->order, n, sizeof *m->order, I + J);
    flip(m, "node", m->node, (size_t)m->nv, sizeof *m->node, 2 * I + J);
    flip(m, "mimic", m->mimic, (size_t)m->nmimic, sizeof *m->mimic, 2 * I + 2 * S);
    flip(m, "frame", m->frame, (size_t)m->nb, sizeof *m->frame, 7 * I + 26 * S);
    const uint64_t hash = recorder_model(m);
    m->features ^= 1;
    expect(recorder_model(m) != hash, "the features change the hash");
}

/* Two inputs, states and outputs; of tick k they are k + 0.5 and -k, k / 4 and k / 8, 8 k and 16 k. */
static void record(int ticks) {
    rbd_real ring[RECORDER_SIZE(2, 2, 2, 4)];
    recorder r = {.ring = ring,
                  .inputs = 2,
                  .states = 2,
                  .outputs = 2,
                  .ticks = 4,
                  .model = 0x123,
                  .configuration = 0x456};
    for (int k = 0; k < ticks; k++) {
        const rbd_real in[2] = {k + 0.5, -k}, state[2] = {k / 4.0, k / 8.0};
        rbd_real *out = recorder_push(&r, in, state);
        expect(out[0] == 0 && out[1] == 0, "outputs begin as 0");
        out[0] = 8 * k, out[1] = 16 * k;
    }
    recorder_dump(&r, putchar);
}

int main(int argc, char **argv) {
    if (argc > 1)
        record(atoi(argv[1]));
    else
        check_model();
    return failures != 0;
}
