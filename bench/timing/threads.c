/* Rows on several threads: the batches of the library, shared out by OpenMP. SPDX-License-Identifier: MIT */
#include "../bench.h"
#ifdef _OPENMP
#include <omp.h>
#endif

int thread_share(int count, int t, int threads) { return (int)((int64_t)count * t / threads); }

/* Runs thread t's share of a row. */
static rbd_status run_share(const struct row *row, int t, int first, int count) {
    const struct instance *r = row->instance;
    const int begin = thread_share(count, t, row->threads), end = thread_share(count, t + 1, row->threads);
    return algorithm_run(row->algorithm, r, &r->worker[t], &r->states, first + begin, end - begin);
}

#ifdef _OPENMP

int threads_available(void) { return omp_get_num_procs(); }

static rbd_status run_shares(const struct row *row, int first, int count) {
    int failed = RBD_OK;
#pragma omp parallel for num_threads(row->threads) schedule(static, 1) reduction(min : failed)
    for (int t = 0; t < row->threads; t++) {
        const int status = run_share(row, t, first, count);
        failed = status < failed ? status : failed;
    }
    return (rbd_status)failed;
}

#else

int threads_available(void) { return 1; }

static rbd_status run_shares(const struct row *row, int first, int count) {
    return run_share(row, 0, first, count);
}

#endif

rbd_status row_run(const struct row *row, int first, int count) {
    return row->threads > 1 ? run_shares(row, first, count) : run_share(row, 0, first, count);
}
