/* A table of made-up times: the least first, the speed-up of the least, names of any length in their
   columns, marks at threads that took longer than one core, at disturbed rows, and at no other row; and what
   is not on a terminal sees no progress. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "../bench.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROWS = 7, OURS = 4, SIZE = 4096 };

/* run-time, lanes, 2 and 4 threads, and rows of a library compiled by GCC: its generated code, and its
   run-time calls in two ways. */
static const struct conventions others = {.build = "gcc 1.2"};
static const struct library ours = {.name = "rbd", .version = "0", .scalar = "double", .lanes = 4},
                            code = {.name = "Another",
                                    .version = "1",
                                    .scalar = "double",
                                    .variant = GENERATED,
                                    .form = "code",
                                    .conventions = &others},
                            peer = {.name = "Another",
                                    .version = "1",
                                    .scalar = "double",
                                    .conventions = &others},
                            form = {.name = "Another",
                                    .version = "1",
                                    .scalar = "double",
                                    .form = "with a very long name of its form",
                                    .conventions = &others};
static const struct robot robot = {.name = "iiwa", .title = "a robot with quite a title"};
static const struct instance instances[4] = {{.robot = &robot, .library = &ours},
                                             {.robot = &robot, .library = &code},
                                             {.robot = &robot, .library = &peer},
                                             {.robot = &robot, .library = &form}};

/* The table of the first n rows, whose means and least times are these; one of them disturbed, or none.
   Returns text. */
static char *table(const double mean[ROWS], const double min[ROWS], int n, int disturbed, char text[SIZE]) {
    static const char name[] = "test_report.txt";
    static const int variant[ROWS] = {RUN_TIME, LANES, THREADS, THREADS, GENERATED, RUN_TIME, RUN_TIME};
    struct row rows[ROWS] = {{0}};
    const struct options options = {.output = name, .format = FORMAT_TABLE};
    for (int i = 0; i < n; i++) {
        rows[i].instance = &instances[i < OURS ? 0 : i - OURS + 1];
        rows[i].variant = variant[i];
        rows[i].threads = variant[i] == THREADS ? 2 * (i - 1) : 1;
        rows[i].mean = mean[i];
        rows[i].min = min[i];
        rows[i].disturbed = i == disturbed;
    }
    FILE *f = report_by(report_times, &options, rows, n) == 0 ? fopen(name, "r") : NULL;
    text[f ? fread(text, 1, SIZE - 1, f) : 0] = 0;
    if (f) fclose(f);
    remove(name);
    return text;
}

static void expect(bool fact, const char *what) {
    if (fact) return;
    fprintf(stderr, "not so: %s\n", what);
    exit(EXIT_FAILURE);
}

/* The line that has this word. */
static const char *line_of(const char *text, const char *word) {
    const char *line = strstr(text, word);
    expect(line, word);
    while (line > text && line[-1] != '\n') line--;
    return line;
}

/* Whether the line that has this word ends with the mark. */
static bool marked(const char *text, const char *word, const char *mark) {
    const char *end = strchr(line_of(text, word), '\n');
    return end && strncmp(end - strlen(mark), mark, strlen(mark)) == 0;
}

/* The number of the line that has this word in the column of this title: what ends where the title ends. */
static double number(const char *text, const char *word, const char *title) {
    const char *head = line_of(text, "speed-up"), *line = line_of(text, word), *column = strstr(head, title);
    const size_t end = (size_t)(column - head) + strlen(title);
    char last = line[end], copy[SIZE];
    expect((last == ' ' || last == '\n') && line[end - 1] != ' ', "what a title names ends where it ends");
    memcpy(copy, line, end);
    copy[end] = 0;
    const char *begin = strrchr(copy, ' ');
    return strtod(begin ? begin : copy, NULL);
}

static void check_columns(void) {
    char text[SIZE];
    const double mean[ROWS] = {200, 40, 30, 20, 50, 900, 800};
    const double min[ROWS] = {100, 25, 20, 12.5, 45, 800, 400};
    table(mean, min, ROWS, -1, text);
    const char *head = line_of(text, "speed-up");
    expect(strstr(head, "min") < strstr(head, "speed-up") && strstr(head, "speed-up") < strstr(head, "mean"),
           "the least time stands first, then the speed-up");
    expect(number(text, "lanes 4", "min") == 25 && number(text, "lanes 4", "mean") == 40,
           "times are in their columns");
    expect(number(text, "lanes 4", "speed-up") == 4, "the speed-up is that of the least times");
    expect(number(text, "threads 4", "speed-up") == 8, "of threads too");
    expect(number(text, "Another 1 with a very long name of its form", "min") == 400 &&
               number(text, "Another 1 with a very long name of its form", "speed-up") == 0.25,
           "a long name moves its row's numbers out of no column");
    expect(number(text, "a robot with quite a title", "min") == 100, "nor does a long title");
    expect(number(text, "Another 1 code", "min") == 45, "code of another library is named so");
    expect(strstr(text, "by g++ here; clang"), "a note says that another library is compiled by GCC");
    expect(!strstr(table(mean, min, OURS + 1, -1, text), "g++"),
           "and not where its code alone is, as rbd's is");
}

static void check_marks(void) {
    char text[SIZE];
    const double min[ROWS] = {9, 9, 9, 9, 9, 9, 9};
    table((const double[ROWS]){100, 30, 16e6, 9}, min, OURS, -1, text);
    expect(marked(text, "threads 2", " *"), "threads that waited are marked");
    expect(!marked(text, "threads 4", " *"), "threads that did not are not");
    expect(!marked(text, "run-time", " *") && !marked(text, "lanes 4", " *"), "other variants are not");
    expect(strstr(text, "\n* longer than lanes on one core"), "a note says what the mark means");
    table((const double[ROWS]){100, 30, 16, 9}, min, OURS, -1, text);
    expect(!strstr(text, " *\n") && !strstr(text, "\n*"), "without a mark there is no note");
    expect(!strstr(text, "disturbed"), "nothing is called disturbed that is not");
    table((const double[ROWS]){100, 30, 16, 9}, min, OURS, 1, text);
    expect(marked(text, "lanes 4", " disturbed"), "a disturbed row is marked");
    expect(!marked(text, "run-time", " disturbed"), "others are not");
    expect(strstr(text, "\ndisturbed: the least time did not come twice"), "a note says what that means");
}

static void check_progress(void) {
    int ends[2];
    char text[16] = "";
    const int saved = dup(STDERR_FILENO);
    expect(pipe(ends) == 0 && saved >= 0 && dup2(ends[1], STDERR_FILENO) >= 0, "stderr is a pipe");
    progress("half of it is done");
    fputs("end", stderr);
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(ends[1]);
    expect(read(ends[0], text, sizeof text - 1) == 3 && strcmp(text, "end") == 0, "a pipe gets no progress");
}

int main(void) {
    check_columns();
    check_marks();
    check_progress();
    return EXIT_SUCCESS;
}
