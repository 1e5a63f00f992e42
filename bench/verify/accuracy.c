/* Errors of rounding: results against those of another library, from the same input.
   SPDX-License-Identifier: MIT */
#include "../../tests/larger.h"
#include "../bench.h"
#include <math.h>

/* How many of the random states are computed in quad precision, which takes some fifty times as long. */
enum { QUAD_SAMPLES = 200 };

/* Brings the parts of a result of rbd's together; place: of its state in the call. */
static void take_parts(const struct row *row, const char *out, int place, double *numbers) {
    const struct library *l = row->instance->library;
    int size[MAX_PARTS];
    const int parts = algorithm_parts(row->algorithm, row->instance->robot, size);
    for (int k = 0; k < parts; k++) {
        take_numbers(l, out, size[k], place, numbers);
        out += (size_t)(l->width * size[k]) * l->size;
        numbers += size[k];
    }
}

/* The result of the row for random state k, in double and rbd's conventions, in r->numbers. */
static void take_result(const struct row *row, int k, const void *out, int place) {
    const struct instance *tested = row->instance;
    const struct robot *r = tested->robot;
    const struct conventions *others = tested->library->conventions;
    const struct state state = robot_state(r, k);
    if (others)
        others->result(tested->model, row->algorithm, &state, out, r->numbers);
    else
        take_parts(row, out, place, r->numbers);
}

/* The error of one result of the row, that of random state k. */
static rbd_status result_error(const struct row *row, const struct instance *arbiter, int k, const void *out,
                               int place, double *error) {
    const struct instance *tested = row->instance;
    const struct robot *r = tested->robot;
    const int n = algorithm_results(row->algorithm, r);
    const struct worker *w = &arbiter->worker[0];
    /* The very input of the tested library, which may be rounded; in rbd's conventions. */
    instance_take_sample(arbiter, library_is_ours(tested->library) ? tested : &r->instances[DOUBLE], k);
    rbd_status status = algorithm_run(row->algorithm, arbiter, w, &arbiter->input, 0, 1);
    if (status != RBD_OK) return status;
    take_result(row, k, out, place);
    *error = larger(*error, arbiter->library->relative_error(r->numbers, w->out, n));
    return RBD_OK;
}

int block_length(const struct row *row) { return row->threads * row->instance->library->width; }

rbd_status block_error(const struct row *row, const struct instance *arbiter, int first, int count,
                       double *error) {
    const struct instance *tested = row->instance;
    *error = 0;
    rbd_status status = row_run(row, first, count);
    for (int t = 0; t < row->threads; t++) {
        const int begin = thread_share(count, t, row->threads),
                  end = thread_share(count, t + 1, row->threads);
        for (int k = begin; k < end && status == RBD_OK; k++)
            status = result_error(row, arbiter, first + k, tested->worker[t].out, k - begin, error);
    }
    return status;
}

static int measure_row(struct row *row, int samples) {
    const struct robot *r = row->instance->robot;
    const int end = samples < QUAD_SAMPLES ? samples : QUAD_SAMPLES, length = block_length(row);
    row->quad_error = 0;
    for (int k = 0; k < end; k += length) {
        double error = 0;
        const int count = end - k < length ? end - k : length;
        rbd_status status = block_error(row, &r->instances[QUAD], k, count, &error);
        if (status != RBD_OK)
            return row_error(row, "random states from %d on, against quad: %s", k, rbd_status_string(status));
        row->quad_error = larger(row->quad_error, error);
    }
    return 0;
}

int measure_accuracy(struct row *rows, int n, int samples) {
    const bool wanted = libraries[QUAD] && samples > 0;
    if (!libraries[QUAD] && samples > 0)
        fprintf(stderr, "rbd-bench: this compiler has no __float128: the quad error stays empty\n");
    for (int i = 0; i < n; i++) {
        rows[i].quad_error = -1;
        if (!wanted) continue;
        progress("against quad: %s, %s", rows[i].instance->robot->title, algorithms[rows[i].algorithm].title);
        if (measure_row(&rows[i], samples) != 0) return -1;
    }
    return 0;
}
