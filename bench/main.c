/* rbd-bench: verifies and times rbd's algorithms on three robots; see README.md.
   SPDX-License-Identifier: MIT */
#include "bench.h"
#include <stdlib.h>
#include <string.h>

struct bench {
    struct robot robots[MAX_ROBOTS];
    int robot_count;
    struct row *rows;
    int row_count;
};

static int open_robots(struct bench *b, const struct options *o) {
    for (int i = 0; robot_names[i] && b->robot_count < (o->model ? 1 : MAX_ROBOTS); i++) {
        if (o->robot != ALL && o->robot != i) continue;
        progress("drawing %d states: %s", o->samples, o->model ? o->model : robot_names[i]);
        if (robot_open(&b->robots[b->robot_count++], i, o) != 0) return -1;
    }
    return 0;
}

static void close_bench(struct bench *b) {
    for (int i = 0; i < b->robot_count; i++) robot_close(&b->robots[i]);
    free(b->rows);
}

/* ---- rows ---- */

static int add_row(struct bench *b, struct row row) {
    struct row *rows = realloc(b->rows, ((size_t)b->row_count + 1) * sizeof *rows);
    if (!rows) {
        fprintf(stderr, "rbd-bench: not enough memory\n");
        return -1;
    }
    b->rows = rows;
    b->rows[b->row_count++] = row;
    return 0;
}

/* Rows for 2, 4, 8, ... and all threads. */
static int add_threads(struct bench *b, struct row row) {
    const int all = row.instance->workers;
    row.variant = THREADS;
    for (int threads = 2; threads < 2 * all; threads *= 2) {
        row.threads = threads < all ? threads : all;
        if (add_row(b, row) != 0) return -1;
    }
    return 0;
}

/* The rows of one library. */
static int add_rows(struct bench *b, const struct options *o, const struct instance *instance,
                    int algorithm) {
    const int variant = instance->library->variant;
    const struct row row = {.instance = instance, .algorithm = algorithm, .variant = variant, .threads = 1};
    const struct library *l = instance->library;
    if (!l->call[algorithm] || (l->can && !l->can(instance->model, algorithm)) ||
        !library_wanted(l, instance->robot, o))
        return 0;
    if ((o->variant == ALL || o->variant == variant) && add_row(b, row) != 0) return -1;
    if (variant == LANES && (o->variant == ALL || o->variant == THREADS)) return add_threads(b, row);
    return 0;
}

/* The rows of a robot, scalar and algorithm: what to compare stands together. */
static int add_variants(struct bench *b, const struct options *o, const struct robot *r, int scalar,
                        int algorithm) {
    for (int l = 0; l < TIMED; l++) {
        const struct instance *instance = &r->instances[l];
        if (instance->library && strcmp(instance->library->scalar, scalar_names[scalar]) == 0 &&
            add_rows(b, o, instance, algorithm) != 0)
            return -1;
    }
    return 0;
}

static int make_rows(struct bench *b, const struct options *o) {
    for (int i = 0; i < b->robot_count; i++)
        for (int s = 0; s < SCALARS; s++)
            for (int a = 0; a < ALGORITHMS; a++)
                if ((o->scalar == ALL || o->scalar == s) && (o->algorithm == ALL || o->algorithm == a) &&
                    add_variants(b, o, &b->robots[i], s, a) != 0)
                    return -1;
    return 0;
}

/* ---- the course ---- */

/* Measures what has been verified, and reports. */
static int finish(struct bench *b, const struct options *o) {
    if (o->states) return report_by(write_states, o, b->rows, b->row_count);
    if (o->count == COUNT_CALLGRIND) return count_by_callgrind(b->rows, b->row_count, o->samples);
    if (o->count == COUNT_PERF) return report_by(count_by_perf, o, b->rows, b->row_count);
    if (measure_accuracy(b->rows, b->row_count, o->no_quad ? 0 : o->samples) != 0 ||
        (o->cold ? measure_by(b->rows, b->row_count, o->samples, o->experiments, time_cold)
                 : measure(b->rows, b->row_count, o->samples, o->experiments)) != 0)
        return -1;
    return report_by(report_times, o, b->rows, b->row_count);
}

static int run(struct bench *b, const struct options *o) {
    const double gravity[3] = {0, 0, o->gravity ? -9.81 : 0};
    if (o->output && report_check_output(o->output) != 0) return EXIT_USAGE;
    if (open_robots(b, o) != 0) return EXIT_FAILURE;
    if (make_rows(b, o) != 0) return EXIT_FAILURE;
    if (b->row_count == 0)
        return usage_error("nothing to time: %s", o->variant == THREADS
                                                      ? "this build has no OpenMP, or the machine "
                                                        "one core"
                                                      : "no such variant of this scalar");
    if (verify(b->rows, b->row_count, gravity, o->samples) != 0) return EXIT_FAILURE;
    return finish(b, o) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv) {
    struct options o;
    int status = options_read(&o, argc, argv);
    if (status >= 0) return status;
    static struct bench b;
    status = run(&b, &o);
    close_bench(&b);
    return status;
}
