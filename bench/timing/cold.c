/* Calls out of cold caches, as those of a control loop are that does other work between two of them.
   SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "../bench.h"
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

/* Of a level-2 cache whose size the system does not tell. */
enum { USUAL_CACHE = 1 << 20, LINE = 64 };

static size_t cache_bytes(void) {
#ifdef _SC_LEVEL2_CACHE_SIZE
    const long size = sysconf(_SC_LEVEL2_CACHE_SIZE);
    if (size > 0) return (size_t)size;
#endif
    return USUAL_CACHE;
}

/* Other code, more of it than a level-1 cache holds: what is read as data need not displace code there. */
static void run_other_code(void) {
#ifdef __GNUC__
    __asm__ volatile(".rept 131072\n\tnop\n\t.endr");
#endif
}

/* Reads and writes twice what the level-2 cache holds. Returns 0, or -1 if there is no memory. */
static int displace(void) {
    static volatile unsigned char *other;
    static size_t size;
    if (!other) {
        size = 2 * cache_bytes();
        other = calloc(size, 1);
        if (!other) return -1;
    }
    for (size_t i = 0; i < size; i += LINE) other[i]++;
    run_other_code();
    return 0;
}

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

rbd_status time_cold(const struct row *row, int first, int count, double *ns) {
    const int length = block_length(row);
    rbd_status status = RBD_OK;
    *ns = 0;
    for (int k = first; k < first + count && status == RBD_OK; k += length) {
        const int n = first + count - k < length ? first + count - k : length;
        if (displace() != 0) return RBD_ERR_MEMORY;
        const double start = now_ns();
        status = row_run(row, k, n);
        *ns += now_ns() - start;
    }
    return status;
}
