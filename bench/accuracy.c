/* Errors of rounding: results against those of another scalar, from the same input.
   SPDX-License-Identifier: MIT */
#include "bench.h"
#include <math.h>

/* How many of the random states are computed in quad precision, which takes some fifty times as long. */
enum { QUAD_SAMPLES = 200 };

rbd_status sample_error(const struct instance *tested, const struct instance *arbiter, int algorithm, int k,
                        double *error) {
    const struct robot *r = tested->robot;
    const int n = algorithm_results(algorithm, r);
    rbd_status status = algorithm_run(algorithm, tested, &tested->states, k, 1, tested->out);
    if (status != RBD_OK)
        return status;
    instance_take_sample(arbiter, tested, k);
    status = algorithm_run(algorithm, arbiter, &arbiter->input, 0, 1, arbiter->out);
    if (status != RBD_OK)
        return status;
    tested->library->to_double(tested->out, (size_t)n, r->numbers);
    *error = arbiter->library->relative_error(r->numbers, arbiter->out, n);
    return RBD_OK;
}

static int measure_row(struct row *row, int samples) {
    const struct robot *r = row->instance->robot;
    row->quad_error = 0;
    for (int k = 0; k < samples && k < QUAD_SAMPLES; k++) {
        double error = 0;
        rbd_status status = sample_error(row->instance, &r->instances[QUAD], row->algorithm, k, &error);
        if (status != RBD_OK)
            return row_error(row, "random state %d, against quad: %s", k, rbd_status_string(status));
        row->quad_error = fmax(row->quad_error, error);
    }
    return 0;
}

int measure_accuracy(struct row *rows, int n, int samples) {
    if (!libraries[QUAD])
        fprintf(stderr, "rbd-bench: this compiler has no __float128: the quad error stays empty\n");
    for (int i = 0; i < n; i++) {
        rows[i].quad_error = -1;
        progress("against quad: %s, %s", rows[i].instance->robot->title, algorithms[rows[i].algorithm].title);
        if (libraries[QUAD] && measure_row(&rows[i], samples) != 0)
            return -1;
    }
    return 0;
}
