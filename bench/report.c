/* Output for the user: the progress line and the report. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#if defined __clang__
#define COMPILER "clang " TEXT(__clang_major__) "." TEXT(__clang_minor__) "." TEXT(__clang_patchlevel__)
#elif defined __GNUC__
#define COMPILER "gcc " TEXT(__GNUC__) "." TEXT(__GNUC_MINOR__) "." TEXT(__GNUC_PATCHLEVEL__)
#else
#define COMPILER "unknown"
#endif
#ifndef BENCH_FLAGS /* what the compiler was given; the build says it */
#define BENCH_FLAGS ""
#endif

/* ---- progress ---- */

void progress(const char *format, ...) {
    if (!isatty(STDERR_FILENO)) return;
    va_list arguments;
    va_start(arguments, format);
    fputs("\r\033[K", stderr); /* start of the line, erase it */
    vfprintf(stderr, format, arguments);
    fflush(stderr);
    va_end(arguments);
}

const char *row_variant(const struct row *row, char text[NAME_SIZE]) {
    const char *name = variant_names[row->variant], *form = row->instance->library->form;
    const int lanes = row->instance->library->lanes;
    if (row->variant == THREADS || lanes > 1)
        snprintf(text, NAME_SIZE, "%s %d", name, row->variant == THREADS ? row->threads : lanes);
    else
        snprintf(text, NAME_SIZE, "%s%s%s", name, form ? " " : "", form ? form : "");
    return text;
}

/* The same for people: of another library, its name and version. */
static const char *row_title(const struct row *row, char text[NAME_SIZE]) {
    const struct library *l = row->instance->library;
    if (library_is_ours(l)) return row_variant(row, text);
    snprintf(text, NAME_SIZE, "%s %s%s%s", l->name, l->version, l->form ? " " : "", l->form ? l->form : "");
    return text;
}

/* The compiler of a library. */
static const char *build_of(const struct library *l) {
    return l->conventions ? l->conventions->build : COMPILER;
}

int row_error(const struct row *row, const char *format, ...) {
    va_list arguments;
    char variant[NAME_SIZE];
    progress("");
    fprintf(stderr, "rbd-bench: %s, %s, %s, %s: ", row->instance->robot->title,
            row->instance->library->scalar, algorithms[row->algorithm].title, row_title(row, variant));
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return -1;
}

/* ---- facts ---- */

/* The processor as Linux names it, or "unknown". */
static const char *cpu_name(char *text, int size) {
    FILE *f = fopen("/proc/cpuinfo", "r");
    while (f && fgets(text, size, f)) {
        char *value = strchr(text, ':');
        if (strncmp(text, "model name", 10) == 0 && value) {
            fclose(f);
            value[strcspn(value, "\n")] = 0;
            return value + 1 + strspn(value + 1, " ");
        }
    }
    if (f) fclose(f);
    return "unknown";
}

static const char *date_utc(char *text, size_t size) {
    time_t now = time(NULL);
    struct tm utc;
    if (!gmtime_r(&now, &utc) || strftime(text, size, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) return "unknown";
    return text;
}

/* The quad_error of a row in text: unknown, or the number. */
static const char *quad_error(const struct row *row, const char *unknown, const char *format, char text[32]) {
    if (row->quad_error < 0) return unknown;
    snprintf(text, 32, format, row->quad_error);
    return text;
}

/* ---- table ---- */

/* rbd's row of the variant, among the first n, that the row is to be compared with, or NULL. */
static const struct row *row_beside(const struct row *rows, int n, const struct row *row, int variant) {
    for (int i = 0; i < n; i++)
        if (rows[i].variant == variant && library_is_ours(rows[i].instance->library) &&
            rows[i].algorithm == row->algorithm && rows[i].instance->robot == row->instance->robot &&
            strcmp(rows[i].instance->library->scalar, row->instance->library->scalar) == 0)
            return &rows[i];
    return NULL;
}

/* How many times as fast as the run-time model, by the least times, in text; empty if it is not measured. */
static const char *speed_up(const struct row *rows, int n, const struct row *row, char text[32]) {
    const struct row *run_time = row_beside(rows, n, row, RUN_TIME);
    *text = 0;
    if (run_time && run_time != row) snprintf(text, 32, "%.3g", run_time->min / row->min);
    return text;
}

/* Whether the threads of the row, if any, took longer than a single one: they waited, for a core or each
 * other. */
static bool has_waited(const struct row *rows, int n, const struct row *row) {
    const struct row *lanes = row->variant == THREADS ? row_beside(rows, n, row, LANES) : NULL;
    return lanes && row->mean > lanes->mean;
}

/* The columns that name a row, and how wide they must be. */
struct names {
    int robot, scalar, algorithm, variant;
};

static void widen(int *width, const char *text) {
    const int length = (int)strlen(text);
    if (length > *width) *width = length;
}

static struct names names_of(const struct row *rows, int n) {
    struct names w = {0, 0, 0, 0};
    char variant[NAME_SIZE];
    widen(&w.robot, "robot"), widen(&w.scalar, "scalar");
    widen(&w.algorithm, "algorithm"), widen(&w.variant, "variant");
    for (int i = 0; i < n; i++) {
        const struct instance *r = rows[i].instance;
        widen(&w.robot, r->robot->title), widen(&w.scalar, r->library->scalar);
        widen(&w.algorithm, algorithms[rows[i].algorithm].title);
        widen(&w.variant, row_title(&rows[i], variant));
    }
    return w;
}

static void write_names(FILE *f, struct names w, const char *robot, const char *scalar, const char *algorithm,
                        const char *variant) {
    fprintf(f, "%-*s %-*s %-*s %-*s", w.robot, robot, w.scalar, scalar, w.algorithm, algorithm, w.variant,
            variant);
}

static void write_table_row(FILE *f, struct names w, const struct row *rows, int n, int i) {
    char quad[32], variant[NAME_SIZE], speed[32];
    const struct row *row = &rows[i], *above = i > 0 ? row - 1 : NULL;
    const struct instance *r = row->instance;
    const bool same_robot = above && above->instance->robot == r->robot;
    const bool same_scalar = same_robot && strcmp(above->instance->library->scalar, r->library->scalar) == 0;
    const bool same_algorithm = same_scalar && above->algorithm == row->algorithm;
    if (above && !same_scalar) fputc('\n', f);
    write_names(f, w, same_robot ? "" : r->robot->title, same_scalar ? "" : r->library->scalar,
                same_algorithm ? "" : algorithms[row->algorithm].title, row_title(row, variant));
    fprintf(f, " %9.1f %9s %9.1f %9.1f %10.1e %10s%s%s\n", row->min, speed_up(rows, n, row, speed), row->mean,
            row->stddev, row->max_error, quad_error(row, "", "%.1e", quad),
            row->disturbed ? " disturbed" : "", has_waited(rows, n, row) ? " *" : "");
}

/* Whether it was compiled from source here, by GCC; of generated code rbd's is too. */
static bool is_by_gcc(const struct row *row) {
    const struct library *l = row->instance->library;
    return !library_is_ours(l) && l->variant == RUN_TIME && strncmp(build_of(l), "gcc ", 4) == 0;
}

/* Explains the columns. */
static void write_legend(FILE *f) {
    fputs("\nmin, mean, std dev: ns per state, over the experiments; compare by min\n"
          "speed-up: times as fast as rbd's run-time model\n"
          "max error: largest difference to another method, relative to the largest entry\n"
          "quad error: the same to the result in quad precision\n"
          "variant: run-time: any robot; generated: code for this one; lanes, blocks: many states at once\n",
          f);
}

/* Explains the marks that the table has. */
static void write_table_notes(FILE *f, const struct row *rows, int n) {
    bool waited = false, disturbed = false, by_gcc = false;
    for (int i = 0; i < n; i++) {
        by_gcc = by_gcc || is_by_gcc(&rows[i]);
        waited = waited || has_waited(rows, n, &rows[i]);
        disturbed = disturbed || rows[i].disturbed;
    }
    if (waited)
        fputs("\n* longer than lanes on one core: other programs kept the cores busy, or the states are too "
              "few "
              "to share\n",
              f);
    if (by_gcc)
        fputs(
            "\nPinocchio is compiled by g++ here; clang makes it 1.35 to 1.8 times as fast: install it and\n"
            "configure anew, with CXX=clang++\n",
            f);
    if (disturbed)
        fputs("\ndisturbed: the least time did not come twice to 3 %, however often it was measured; it may "
              "be too "
              "large\n",
              f);
}

static void write_table(FILE *f, const struct options *o, const struct row *rows, int n) {
    char cpu[256];
    fprintf(f, "rbd %s, %s%s%s\n", RBD_VERSION, COMPILER, *BENCH_FLAGS ? " " : "", BENCH_FLAGS);
    fprintf(f, "%s\n", cpu_name(cpu, sizeof cpu));
    fprintf(f, "%d random states (seed %llu) x %d experiments, gravity %s%s; ns per state\n\n", o->samples,
            (unsigned long long)o->seed, o->experiments, o->gravity ? "on" : "off",
            o->fixed_base ? ", bases fixed" : "");
    const struct names w = names_of(rows, n);
    write_names(f, w, "robot", "scalar", "algorithm", "variant");
    fprintf(f, " %9s %9s %9s %9s %10s %10s\n", "min", "speed-up", "mean", "std dev", "max error",
            "quad error");
    for (int i = 0; i < n; i++) write_table_row(f, w, rows, n, i);
    write_legend(f);
    write_table_notes(f, rows, n);
}

/* ---- CSV and JSON ---- */

static void write_csv(FILE *f, const struct options *o, const struct row *rows, int n) {
    fputs("library,version,compiler,scalar,robot,algorithm,samples,experiments,"
          "mean_ns,stddev_ns,min_ns,max_error,quad_error,variant,disturbed\n",
          f);
    for (int i = 0; i < n; i++) {
        char quad[32], variant[NAME_SIZE];
        const struct row *row = &rows[i];
        const struct instance *r = row->instance;
        fprintf(f, "%s,%s,%s,%s,%s,%s,%d,%d,%.3f,%.3f,%.3f,%.3e,%s,%s,%d\n", r->library->name,
                r->library->version, build_of(r->library), r->library->scalar, r->robot->name,
                algorithms[row->algorithm].name, o->samples, o->experiments, row->mean, row->stddev, row->min,
                row->max_error, quad_error(row, "", "%.3e", quad), row_variant(row, variant), row->disturbed);
    }
}

static void write_json_string(FILE *f, const char *text) {
    fputc('"', f);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') fputc('\\', f);
        if ((unsigned char)*text >= ' ') fputc(*text, f);
    }
    fputc('"', f);
}

static void write_json_fact(FILE *f, const char *key, const char *value) {
    fprintf(f, "    \"%s\": ", key);
    write_json_string(f, value);
    fputs(",\n", f);
}

static void write_json_row(FILE *f, const struct options *o, const struct row *row) {
    char quad[32], variant[NAME_SIZE];
    const struct instance *r = row->instance;
    fprintf(f,
            "    {\"library\": \"%s\", \"version\": \"%s\", \"compiler\": \"%s\", \"scalar\": \"%s\", "
            "\"robot\": \"%s\", \"algorithm\": \"%s\", \"samples\": %d, \"experiments\": %d, "
            "\"mean_ns\": %.3f, \"stddev_ns\": %.3f, \"min_ns\": %.3f, \"max_error\": %.3e, "
            "\"quad_error\": %s, \"variant\": \"%s\", \"disturbed\": %s}",
            r->library->name, r->library->version, build_of(r->library), r->library->scalar, r->robot->name,
            algorithms[row->algorithm].name, o->samples, o->experiments, row->mean, row->stddev, row->min,
            row->max_error, quad_error(row, "null", "%.3e", quad), row_variant(row, variant),
            row->disturbed ? "true" : "false");
}

static void write_json(FILE *f, const struct options *o, const struct row *rows, int n) {
    char cpu[256], date[32];
    fputs("{\n  \"machine\": {\n", f);
    write_json_fact(f, "cpu", cpu_name(cpu, sizeof cpu));
    write_json_fact(f, "compiler", COMPILER);
    write_json_fact(f, "flags", BENCH_FLAGS);
    write_json_fact(f, "date", date_utc(date, sizeof date));
    fprintf(f, "    \"seed\": %llu,\n    \"gravity\": %s\n  },\n  \"rows\": [\n", (unsigned long long)o->seed,
            o->gravity ? "true" : "false");
    for (int i = 0; i < n; i++) {
        write_json_row(f, o, &rows[i]);
        fputs(i + 1 < n ? ",\n" : "\n", f);
    }
    fputs("  ]\n}\n", f);
}

int report_times(FILE *f, const struct options *o, const struct row *rows, int n) {
    static void (*const write[])(FILE *, const struct options *, const struct row *, int) = {
        [FORMAT_TABLE] = write_table, [FORMAT_CSV] = write_csv, [FORMAT_JSON] = write_json};
    write[o->format](f, o, rows, n);
    return 0;
}

/* ---- the file: a regular one is written beside its place and then renamed into it ---- */

struct target {
    const char *name;
    char *temporary; /* NULL: written in place, as a device, pipe or link must be */
};

static int output_error(const char *output) {
    usage_error("--output: cannot write '%s': %s", output, strerror(errno));
    return -1;
}

static FILE *target_open(struct target *t, const char *output, const char *mode) {
    struct stat info;
    *t = (struct target){output, NULL};
    if (lstat(output, &info) == 0 && !S_ISREG(info.st_mode)) return fopen(output, mode);
    size_t size = strlen(output) + 32;
    t->temporary = malloc(size);
    if (!t->temporary) return NULL;
    snprintf(t->temporary, size, "%s.%ld.tmp", output, (long)getpid());
    return fopen(t->temporary, mode);
}

/* Closes the file and puts it in its place, or removes it. f: as target_open gave it, even NULL. */
static int target_close(struct target *t, FILE *f, bool keep) {
    bool failed = !f || ferror(f);
    if (f && fclose(f) != 0) failed = true;
    if (!failed && keep && t->temporary) failed = rename(t->temporary, t->name) != 0;
    int status = failed ? output_error(t->name) : 0;
    if (f && t->temporary && (failed || !keep)) remove(t->temporary);
    free(t->temporary);
    return status;
}

int report_check_output(const char *output) {
    struct target t;
    FILE *f = target_open(&t, output, "a");
    return target_close(&t, f, false);
}

int report_by(report_writer *write, const struct options *o, const struct row *rows, int n) {
    if (!o->output) {
        int status = write(stdout, o, rows, n);
        if (fflush(stdout) == 0 && !ferror(stdout)) return status;
        perror("rbd-bench: standard output");
        return -1;
    }
    struct target t;
    FILE *f = target_open(&t, o->output, "w");
    int status = f ? write(f, o, rows, n) : -1;
    return target_close(&t, f, status == 0) == 0 ? status : -1;
}
