/* rbd-bench: verifies and times rbd's algorithms on three robots; see README.md.
   SPDX-License-Identifier: MIT */
#include "bench.h"
#include <stdlib.h>

struct bench {
    struct robot robots[MAX_ROBOTS];
    int robot_count;
    struct row rows[MAX_ROBOTS * TIMED * ALGORITHMS];
    int row_count;
};

static int open_robots(struct bench *b, const struct options *o) {
    for (int i = 0; robot_names[i] && b->robot_count < MAX_ROBOTS; i++) {
        if (o->robot != ALL && o->robot != i)
            continue;
        progress("drawing %d states: %s", o->samples, robot_names[i]);
        if (robot_open(&b->robots[b->robot_count++], i, o->scalar, o->samples, o->seed) != 0)
            return -1;
    }
    return 0;
}

static void close_robots(struct bench *b) {
    for (int i = 0; i < b->robot_count; i++)
        robot_close(&b->robots[i]);
}

static void make_rows_of(struct bench *b, const struct options *o, const struct instance *instance) {
    for (int a = 0; a < ALGORITHMS; a++)
        if (o->algorithm == ALL || o->algorithm == a)
            b->rows[b->row_count++] = (struct row){.instance = instance, .algorithm = a};
}

/* A row for each robot, scalar and algorithm that the options ask for. */
static void make_rows(struct bench *b, const struct options *o) {
    for (int i = 0; i < b->robot_count; i++)
        for (int l = 0; l < TIMED; l++)
            if (o->scalar == ALL || o->scalar == l)
                make_rows_of(b, o, &b->robots[i].instances[l]);
}

static int run(struct bench *b, const struct options *o) {
    const double gravity[3] = {0, 0, o->gravity ? -9.81 : 0};
    if (o->output && report_check_output(o->output) != 0)
        return EXIT_USAGE;
    if (open_robots(b, o) != 0)
        return EXIT_FAILURE;
    make_rows(b, o);
    if (verify(b->rows, b->row_count, gravity, o->samples) != 0 ||
        measure_accuracy(b->rows, b->row_count, o->samples) != 0 ||
        measure(b->rows, b->row_count, o->samples, o->experiments) != 0)
        return EXIT_FAILURE;
    return report_write(o, b->rows, b->row_count) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv) {
    struct options o;
    int status = options_read(&o, argc, argv);
    if (status >= 0)
        return status;
    static struct bench b;
    status = run(&b, &o);
    close_robots(&b);
    return status;
}
