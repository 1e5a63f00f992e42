/* replay.c - on a PC: reads a recording of recorded_control.c, computes each tick again, compares to the bit.
   A recording of recorded_servos.c takes -DCONTROLLER='"servo_controller.h"' when this is compiled.
   usage: replay RECORDING [TABLE.csv]    the table is for replay.gp
   Exit status: 0 all the same bits; 1 a tick differs; 2 the recording is not whole, its ticks have the same
   bits; 3 nothing was replayed. SPDX-License-Identifier: MIT */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#ifndef CONTROLLER
#define CONTROLLER "recorded_controller.h"
#endif
#include CONTROLLER

enum { SAME, DIFFERS, DAMAGED, UNUSABLE, WORDS = INPUTS + STATES + OUTPUTS, LONGEST = 1024, MOST = 1 << 24 };

typedef struct tick {
    rbd_real in[INPUTS], state[STATES], tau[OUTPUTS];
    int present;
} tick;

typedef struct recording {
    uint64_t first;
    int ticks, missing;
    tick *tick;
} recording;

static int cannot(const char *what, const char *path) {
    printf("%s '%s': %s: nothing was replayed\n", what, path, strerror(errno));
    return UNUSABLE;
}

static int unusable(const char *sentence) {
    printf("%s: nothing was replayed\n", sentence);
    return UNUSABLE;
}

/* Reads a line without its end. Returns 0 if there is none. A longer one comes in parts. */
static int read_line(FILE *file, char *line) {
    if (!fgets(line, LONGEST, file)) return 0;
    line[strcspn(line, "\r\n")] = 0;
    return 1;
}

/* Whether a line ends with its checksum, which is cut off. */
static int whole(char *line) {
    const size_t length = strlen(line);
    uint64_t sum;
    char *last = length > 17 ? line + length - 16 : line, *end;
    uint64_t hash = recorder_hash_start;
    for (const char *c = line; c < last; c++) hash = recorder_hash(hash, (unsigned char)*c, 1);
    sum = strtoull(last, &end, 16);
    if (last == line || last[-1] != ' ' || *end != 0 || sum != hash) return 0;
    last[-1] = 0;
    return 1;
}

/* Reads `count` scalars of hexadecimal bits without blanks between them. Returns what follows, or NULL. */
static const char *read_scalars(const char *text, rbd_real *x, int count) {
    enum { DIGITS = 2 * sizeof(rbd_real) };
    if (!text || *text++ != ' ') return NULL;
    for (int i = 0; i < count; i++, text += DIGITS) {
        char digits[DIGITS + 1] = {0}, *end;
        strncpy(digits, text, DIGITS);
        const uint64_t bits = strtoull(digits, &end, 16);
        const uint32_t half = (uint32_t)bits;
        if (end != digits + DIGITS) return NULL;
        if (sizeof *x == sizeof half)
            memcpy(&x[i], &half, sizeof *x);
        else
            memcpy(&x[i], &bits, sizeof *x);
    }
    return text;
}

/* Reads the first line. Says in a sentence why a recording cannot be replayed. */
static int read_header(FILE *file, recording *r) {
    static char line[LONGEST], say[LONGEST];
    char version[16];
    unsigned format, scalar, inputs, states, outputs, ticks;
    uint64_t model, configuration;
    if (!read_line(file, line)) return unusable("the recording is empty");
    while (strncmp(line, "rbd-recording ", 14) != 0)
        if (!read_line(file, line)) return unusable("not a recording: no line begins with rbd-recording");
    if (sscanf(line, "rbd-recording %2x", &format) == 1 && format != RECORDER_FORMAT) {
        snprintf(say, sizeof say, "a recording of format %u, this program reads %d", format, RECORDER_FORMAT);
        return unusable(say);
    }
    if (!whole(line)) return unusable("the first line of the recording is damaged or cut off");
    if (sscanf(line,
               "rbd-recording %2x rbd %15s scalar %2x model %16" SCNx64 " configuration %16" SCNx64
               " inputs %4x states %4x outputs %4x first %16" SCNx64 " ticks %8x",
               &format, version, &scalar, &model, &configuration, &inputs, &states, &outputs, &r->first,
               &ticks) != 10)
        return unusable("the first line of the recording cannot be read");
    say[0] = 0;
    if (strcmp(version, RBD_VERSION) != 0)
        snprintf(say, sizeof say, "recorded with rbd %s, this program has %s", version, RBD_VERSION);
    else if (scalar != sizeof(rbd_real))
        snprintf(say, sizeof say, "recorded with scalars of %u bytes, this program has %d", scalar,
                 (int)sizeof(rbd_real));
    else if (inputs != INPUTS || states != STATES || outputs != OUTPUTS)
        snprintf(say, sizeof say,
                 "recorded with %u inputs, %u states and %u outputs, this program has %d, %d and %d", inputs,
                 states, outputs, INPUTS, STATES, OUTPUTS);
    else if (model != recorder_model(&iiwa_model))
        snprintf(say, sizeof say,
                 "recorded with another model: hash %016" PRIx64 ", this program has %016" PRIx64, model,
                 recorder_model(&iiwa_model));
    else if (configuration != controller_configuration())
        snprintf(say, sizeof say,
                 "recorded with another configuration (gains, limit, period): hash %016" PRIx64
                 ", this program has %016" PRIx64,
                 configuration, controller_configuration());
    else if (ticks == 0 || ticks > MOST || !(r->tick = calloc(ticks, sizeof *r->tick)))
        snprintf(say, sizeof say, "%u ticks: none, or too many for the memory", ticks);
    r->ticks = (int)ticks;
    return say[0] != 0 ? unusable(say) : SAME;
}

/* Reads all ticks that are whole; counts those that are not. */
static int read_ticks(FILE *file, recording *r) {
    char line[LONGEST];
    int last = -1, first_missing = 0;
    while (read_line(file, line)) {
        char *end;
        if (strncmp(line, "tick ", 5) != 0 || !whole(line)) continue;
        const uint64_t at = strtoull(line + 5, &end, 16) - r->first;
        tick t = {.present = 1};
        const char *rest =
            read_scalars(read_scalars(read_scalars(end, t.in, INPUTS), t.state, STATES), t.tau, OUTPUTS);
        if (rest && *rest == 0 && at < (uint64_t)r->ticks) r->tick[at] = t;
    }
    r->missing = 0;
    for (int i = 0; i < r->ticks; i++) {
        if (r->tick[i].present)
            last = i;
        else if (r->missing++ == 0)
            first_missing = i;
    }
    if (r->missing == r->ticks)
        return unusable("truncated: the recording has its first line and no whole tick");
    if (r->missing == 0) return SAME;
    if (last < first_missing)
        printf("truncated: the first %d of %d ticks are there\n", r->ticks - r->missing, r->ticks);
    else
        printf("damaged: %d of %d ticks are missing or have a wrong checksum, the first is tick %" PRIu64
               "\n",
               r->missing, r->ticks, r->first + (uint64_t)first_missing);
    return DAMAGED;
}

/* Same bits; of numbers that are none IEEE 754 leaves the bits open. */
static int same(rbd_real x, rbd_real y) { return recorder_bits(x) == recorder_bits(y) || (x != x && y != y); }

/* Compares n scalars; the first difference of all is said. */
static int differs(const char *what, uint64_t number, const rbd_real *recorded, const rbd_real *again, int n,
                   int said) {
    for (int i = 0; i < n; i++) {
        if (same(recorded[i], again[i])) continue;
        if (!said)
            printf("tick %" PRIu64 ", joint %d: %s recorded %.9g (bits %08" PRIx64
                   "), computed again %.9g (%08" PRIx64 ")\n",
                   number, i + 1, what, (double)recorded[i], recorder_bits(recorded[i]), (double)again[i],
                   recorder_bits(again[i]));
        return 1;
    }
    return 0;
}

static void write_row(FILE *table, uint64_t number, const tick *t, const rbd_real *tau) {
    fprintf(table, "%.3f", (double)number * (double)gains[PERIOD_S]);
    for (int i = 0; i < N; i++) fprintf(table, ",%.6g", (double)(t->in[WANTED_Q + i] - t->in[Q + i]));
    for (int i = 0; i < N; i++) fprintf(table, ",%.9g", (double)t->tau[i]);
    for (int i = 0; i < N; i++) fprintf(table, ",%.9g", (double)tau[i]);
    fputc('\n', table);
}

/* Every tick from its own inputs and states, so that one that differs does not spoil the next. Returns how
   many differ. */
static int replay(const recording *r, rbd_work *w, FILE *table) {
    int differing = 0;
    for (int i = 0; i < r->ticks; i++) {
        const tick *t = &r->tick[i];
        const uint64_t number = r->first + (uint64_t)i;
        rbd_real state[STATES], tau[OUTPUTS];
        if (!t->present) continue;
        memcpy(state, t->state, sizeof state);
        controller_tick(w, t->in, state, tau);
        int bad = differs(OUTPUT, number, t->tau, tau, OUTPUTS, differing);
        if (!bad && i + 1 < r->ticks && t[1].present)
            bad = differs("state after it", number, t[1].state, state, STATES, differing);
        differing += bad;
        if (table) write_row(table, number, t, tau);
    }
    return differing;
}

int main(int argc, char **argv) {
    static unsigned char memory[IIWA_WORK_SIZE];
    rbd_work *w;
    recording r = {0};
    if (argc < 2 || argc > 3) return unusable("usage: replay RECORDING [TABLE.csv]");
    FILE *file = fopen(argv[1], "rb"), *table = NULL;
    if (!file) return cannot("cannot open the recording", argv[1]);
    int status = read_header(file, &r);
    if (status == SAME) status = read_ticks(file, &r);
    fclose(file);
    if (status != UNUSABLE && argc == 3 && !(table = fopen(argv[2], "w")))
        status = cannot("cannot write the table", argv[2]);
    rbd_status refused = rbd_work_init(&iiwa_model, memory, sizeof memory, &w);
    if (refused == RBD_OK) refused = controller_start();
    if (status != UNUSABLE && refused != RBD_OK) status = unusable(rbd_status_string(refused));
    if (status != UNUSABLE) {
        const int differing = replay(&r, w, table), there = r.ticks - r.missing;
        if (differing > 0) {
            printf("%d of %d ticks differ\n", differing, there);
            status = DIFFERS;
        } else
            printf("%d ticks from tick %" PRIu64 " on: all the same bits\n", there, r.first);
    }
    if (table && fclose(table) != 0) {
        printf("the table could not be written\n");
        status = UNUSABLE;
    }
    free(r.tick);
    return status;
}
