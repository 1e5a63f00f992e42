/* Counting instead of timing: by the processor's counters, or by marking the loops for callgrind.
   SPDX-License-Identifier: MIT */
#include "../bench.h"
#include "perf.h"
#include <string.h>
#ifdef BENCH_VALGRIND
#include <valgrind/callgrind.h>
#endif

/* Threads have the counts of lanes. */
static bool is_counted(const struct row *row) { return row->threads == 1; }

/* "library,version,variant,scalar,robot,algorithm" */
static const char *row_key(const struct row *row, char text[160]) {
    char variant[NAME_SIZE];
    const struct library *l = row->instance->library;
    snprintf(text, 160, "%s,%s,%s,%s,%s,%s", l->name, l->version, row_variant(row, variant), l->scalar,
             row->instance->robot->name, algorithms[row->algorithm].name);
    return text;
}

/* ---- the processor's ---- */

static rbd_status count_group(FILE *f, const struct row *row, const struct perf_group *group, int samples) {
    char key[160];
    struct perf_run r;
    rbd_status status = row_run(row, 0, samples); /* warm */
    perf_open(&r, group);
    perf_start(&r);
    if (status == RBD_OK) status = row_run(row, 0, samples);
    perf_stop(&r);
    perf_close(&r);
    for (int i = 0; i < PERF_GROUP && status == RBD_OK; i++)
        if (r.fd[i] >= 0 && r.share > 0)
            fprintf(f, "perf,%s,%s,%.4f,%.3f\n", row_key(row, key), group->counter[i].name,
                    r.count[i] / samples, r.share);
    return status;
}

int count_by_perf(FILE *f, const struct options *o, const struct row *rows, int n) {
    char text[256];
    if (!perf_available(text, sizeof text)) fprintf(stderr, "rbd-bench: %s\n", text);
    fputs("source,library,version,variant,scalar,robot,algorithm,counter,per_state,share\n", f);
    for (int i = 0; i < n; i++) {
        progress("counting %d of %d", i + 1, n);
        for (int g = 0; g < perf_group_count && is_counted(&rows[i]); g++) {
            const struct perf_group *group = &perf_groups[g];
            if (group->scalar && strcmp(group->scalar, rows[i].instance->library->scalar) != 0) continue;
            rbd_status status = count_group(f, &rows[i], group, o->samples);
            if (status != RBD_OK) return row_error(&rows[i], "%s", rbd_status_string(status));
        }
    }
    progress("");
    return 0;
}

/* ---- callgrind's ---- */

#ifdef BENCH_VALGRIND
static rbd_status mark(const struct row *row, int samples) {
    char key[160], text[200];
    snprintf(text, sizeof text, "%s,%d", row_key(row, key), samples);
    rbd_status status =
        row_run(row, 0, samples); /* not counted: the first call of a libm function binds it */
    if (status != RBD_OK) return status;
    CALLGRIND_ZERO_STATS;
    CALLGRIND_TOGGLE_COLLECT;
    status = row_run(row, 0, samples);
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS_AT(text);
    return status;
}

int count_by_callgrind(const struct row *rows, int n, int samples) {
    if (!RUNNING_ON_VALGRIND) {
        fprintf(stderr, "rbd-bench: --count callgrind: not running under valgrind --tool=callgrind\n");
        return -1;
    }
    for (int i = 0; i < n; i++) {
        rbd_status status = is_counted(&rows[i]) ? mark(&rows[i], samples) : RBD_OK;
        if (status != RBD_OK) return row_error(&rows[i], "%s", rbd_status_string(status));
    }
    return 0;
}
#else
int count_by_callgrind(const struct row *rows, int n, int samples) {
    (void)rows, (void)n, (void)samples;
    fprintf(stderr, "rbd-bench: --count callgrind: built without valgrind's headers\n");
    return -1;
}
#endif
