/* recorder.h - a flight recorder for a controller: a ring of its last ticks, and their dump as text.
   SPDX-License-Identifier: MIT

   A tick is what the controller read (inputs), what it kept from the tick before (states), and what it
   returned (outputs): scalars, so many of each as the recorder says. Memory is the caller's. In every tick:

       tau = recorder_push(&r, inputs, states);   // before the controller changes its states
       controller(inputs, states, tau);           // writes its outputs into the ring

   When something went wrong: recorder_dump(&r, putchar), or a function that puts a byte on a UART. No push
   may run meanwhile. replay.c reads the dump. Each line ends with a checksum. Other lines are skipped:

       rbd-recording 01 rbd VERSION scalar 04 model HASH configuration HASH (the same line goes on)
           inputs 001c states 0007 outputs 0007 first NUMBER ticks NUMBER CHECKSUM
       tick NUMBER INPUTS STATES OUTPUTS CHECKSUM   (the oldest tick first)

   Numbers are hexadecimal, of a fixed length, scalars are their bits. */
#ifndef RECORDER_H
#define RECORDER_H

#include <string.h>

#include "rbd.h"

#if RBD_MODEL_VERSION != 6
#error "recorder.h: recorder_model is for another version of the model"
#endif

#define RECORDER_FORMAT 1
/* Scalars of memory for a ring. */
#define RECORDER_SIZE(inputs, states, outputs, ticks) ((ticks) * ((inputs) + (states) + (outputs)))

typedef struct recorder {
    rbd_real *ring;                     /* RECORDER_SIZE scalars */
    int inputs, states, outputs, ticks; /* scalars of a tick; ticks that the ring holds */
    uint64_t model, configuration;      /* hashes: recorder_model, recorder_hash_scalars */
    uint64_t pushed;                    /* ticks until now */
    int next;                           /* where in the ring the next one goes */
} recorder;

static inline int recorder_words(const recorder *r) { return r->inputs + r->states + r->outputs; }

/* Records what a tick begins with and returns where its outputs go, which are 0 until then. */
static inline rbd_real *recorder_push(recorder *r, const rbd_real *inputs, const rbd_real *states) {
    rbd_real *to = r->ring + r->next * recorder_words(r);
    for (int i = 0; i < r->inputs; i++) *to++ = inputs[i];
    for (int i = 0; i < r->states; i++) *to++ = states[i];
    for (int i = 0; i < r->outputs; i++) to[i] = 0;
    r->next = r->next + 1 < r->ticks ? r->next + 1 : 0;
    r->pushed++;
    return to;
}

/* ---- hashes: FNV-1a of 64 bits, over values from their least byte on, the same on every machine ---- */

static const uint64_t recorder_hash_start = 0xcbf29ce484222325u;

static inline uint64_t recorder_hash(uint64_t hash, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) hash = (hash ^ (value >> 8 * i & 0xff)) * 0x100000001b3u;
    return hash;
}

/* The bits of a scalar. */
static inline uint64_t recorder_bits(rbd_real x) {
    uint32_t half;
    uint64_t whole = 0;
    if (sizeof x == sizeof whole)
        memcpy(&whole, &x, sizeof x);
    else
        memcpy(&half, &x, sizeof half), whole = half;
    return whole;
}

static inline uint64_t recorder_hash_scalars(uint64_t hash, const rbd_real *x, int n) {
    for (int i = 0; i < n; i++) hash = recorder_hash(hash, recorder_bits(x[i]), (int)sizeof *x);
    return hash;
}

static inline uint64_t recorder_hash_integers(uint64_t hash, const int32_t *x, int n) {
    for (int i = 0; i < n; i++) hash = recorder_hash(hash, (uint32_t)x[i], 4);
    return hash;
}

#define RECORDER_SCALARS(...) \
    (hash = recorder_hash_scalars(hash, (const rbd_real[]){__VA_ARGS__}, \
                                  (int)(sizeof((const rbd_real[]){__VA_ARGS__}) / sizeof(rbd_real))))
#define RECORDER_INTEGERS(...) \
    (hash = recorder_hash_integers(hash, (const int32_t[]){__VA_ARGS__}, \
                                   (int)(sizeof((const int32_t[]){__VA_ARGS__}) / sizeof(int32_t))))
#define RECORDER_VECTOR(v) (v).x, (v).y, (v).z
#define RECORDER_SYMMETRIC(S) (S).xx, (S).xy, (S).xz, (S).yy, (S).yz, (S).zz

/* Hash of all constants of a built model, but for the names. */
static inline uint64_t recorder_model(const rbd_model *m) {
    uint64_t hash = recorder_hash_start;
    RECORDER_INTEGERS(m->version, m->nb, m->nq, m->nv, m->nl, m->nblock, m->nbranch, m->nmimic, m->nh, m->nhx,
                      (int32_t)m->features);
    RECORDER_SCALARS(RECORDER_VECTOR(m->gravity));
    for (const rbdi_link *l = m->link; l < m->link + m->nl; l++) {
        RECORDER_INTEGERS(l->parent, l->iq, l->iv, l->block, l->branch, l->first, l->end, l->kind, l->flags);
        RECORDER_SCALARS(l->cg, l->sg, l->quarters, l->gamma, l->ca, l->sa, l->cb, l->sb,
                         RECORDER_VECTOR(l->r), l->d, l->rho, l->kappa, RECORDER_SYMMETRIC(l->Sigma),
                         RECORDER_VECTOR(l->h), l->mass, l->subtree_mass);
    }
    for (const rbdi_block *b = m->block; b < m->block + m->nblock; b++) {
        RECORDER_INTEGERS(b->type, b->first, b->n, b->identity);
        hash = recorder_hash_scalars(hash, b->E, 9);
    }
    for (const rbdi_dof *d = m->dof; d < m->dof + m->nv + m->nmimic; d++) {
        RECORDER_INTEGERS(d->body, d->lambda, d->row, d->depth, d->before, d->level);
        RECORDER_SCALARS(d->armature, d->damping, d->friction, d->scale);
    }
    for (const rbdi_order *o = m->order; o < m->order + m->nv + m->nmimic; o++)
        RECORDER_INTEGERS(o->dof, o->row);
    for (const rbdi_node *n = m->node; n < m->node + m->nv; n++)
        RECORDER_INTEGERS(n->dof, n->descendants, n->row);
    for (const rbdi_mimic *c = m->mimic; c < m->mimic + m->nmimic; c++) {
        RECORDER_INTEGERS(c->source_q, c->source_v);
        RECORDER_SCALARS(c->ratio, c->offset);
    }
    for (const rbdi_frame *f = m->frame; f < m->frame + m->nb; f++) {
        RECORDER_INTEGERS(f->link, f->parent, f->type, f->iq, f->nq, f->iv, f->nv);
        hash = recorder_hash_scalars(hash, f->E, 9);
        RECORDER_SCALARS(RECORDER_VECTOR(f->r), f->mass, RECORDER_VECTOR(f->com), RECORDER_SYMMETRIC(f->I),
                         f->lower, f->upper, f->velocity, f->effort);
    }
    return hash;
}

/* ---- the dump ---- */

typedef struct recorder_line { /* that is being written */
    int (*put)(int);
    uint64_t hash;
} recorder_line;

static inline void recorder_text(recorder_line *line, const char *text) {
    for (; *text != 0; text++) {
        line->hash = recorder_hash(line->hash, (unsigned char)*text, 1);
        line->put((unsigned char)*text);
    }
}

static inline void recorder_hex(recorder_line *line, uint64_t value, int bytes) {
    for (int i = 2 * bytes - 1; i >= 0; i--) {
        const char digit[2] = {"0123456789abcdef"[value >> 4 * i & 15], 0};
        recorder_text(line, digit);
    }
}

static inline void recorder_field(recorder_line *line, const char *name, uint64_t value, int bytes) {
    recorder_text(line, name);
    recorder_hex(line, value, bytes);
}

static inline void recorder_end_line(recorder_line *line) {
    recorder_text(line, " ");
    recorder_hex(line, line->hash, 8);
    line->put('\n');
    line->hash = recorder_hash_start;
}

/* Writes the ticks that the ring has. put is called with one character after another. */
static inline void recorder_dump(const recorder *r, int (*put)(int)) {
    recorder_line line = {put, recorder_hash_start};
    const int words = recorder_words(r), full = r->pushed >= (uint64_t)r->ticks;
    const int ticks = full ? r->ticks : r->next;
    const uint64_t first = r->pushed - (uint64_t)ticks;
    recorder_field(&line, "rbd-recording ", RECORDER_FORMAT, 1);
    recorder_text(&line, " rbd " RBD_VERSION);
    recorder_field(&line, " scalar ", sizeof(rbd_real), 1);
    recorder_field(&line, " model ", r->model, 8);
    recorder_field(&line, " configuration ", r->configuration, 8);
    recorder_field(&line, " inputs ", (uint64_t)r->inputs, 2);
    recorder_field(&line, " states ", (uint64_t)r->states, 2);
    recorder_field(&line, " outputs ", (uint64_t)r->outputs, 2);
    recorder_field(&line, " first ", first, 8);
    recorder_field(&line, " ticks ", (uint64_t)ticks, 4);
    recorder_end_line(&line);
    for (int i = 0, at = full ? r->next : 0; i < ticks; i++, at = at + 1 < r->ticks ? at + 1 : 0) {
        recorder_field(&line, "tick ", first + (uint64_t)i, 8);
        for (int k = 0; k < words; k++) {
            if (k == 0 || k == r->inputs || k == r->inputs + r->states) recorder_text(&line, " ");
            recorder_hex(&line, recorder_bits(r->ring[at * words + k]), (int)sizeof(rbd_real));
        }
        recorder_end_line(&line);
    }
}

#endif
