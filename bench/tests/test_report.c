/* A table of made-up times marks the threads that took longer than one core, disturbed rows, and no other
   row. SPDX-License-Identifier: MIT */
#include "../bench.h"
#include <stdlib.h>
#include <string.h>

enum { ROWS = 4, SIZE = 4096 };

/* The table of rows whose means are these: run-time, lanes, and 2 and 4 threads; one of them disturbed, or
   none. Returns text. */
static char *table(const double mean[ROWS], int disturbed, char text[SIZE]) {
    static const struct robot robot = {.name = "iiwa", .title = "iiwa"};
    static const struct library library = {.name = "rbd", .version = "0", .scalar = "double", .lanes = 4};
    static const struct instance instance = {.robot = &robot, .library = &library};
    static const char name[] = "test_report.txt";
    struct row rows[ROWS] = {{.variant = RUN_TIME, .threads = 1},
                             {.variant = LANES, .threads = 1},
                             {.variant = THREADS, .threads = 2},
                             {.variant = THREADS, .threads = 4}};
    const struct options options = {.output = name, .format = FORMAT_TABLE};
    for (int i = 0; i < ROWS; i++) {
        rows[i].instance = &instance;
        rows[i].mean = mean[i];
        rows[i].disturbed = i == disturbed;
    }
    FILE *f = report_by(report_times, &options, rows, ROWS) == 0 ? fopen(name, "r") : NULL;
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

/* Whether the line that has this word ends with the mark. */
static bool marked(const char *text, const char *word, const char *mark) {
    const char *line = strstr(text, word);
    expect(line, word);
    const char *end = strchr(line, '\n');
    return end && strncmp(end - strlen(mark), mark, strlen(mark)) == 0;
}

int main(void) {
    char text[SIZE];
    table((const double[ROWS]){100, 30, 16e6, 9}, -1, text);
    expect(marked(text, "threads 2", " *"), "threads that waited are marked");
    expect(!marked(text, "threads 4", " *"), "threads that did not are not");
    expect(!marked(text, "run-time", " *") && !marked(text, "lanes 4", " *"), "other variants are not");
    expect(strstr(text, "\n* longer than lanes on one core"), "a note says what the mark means");
    table((const double[ROWS]){100, 30, 16, 9}, -1, text);
    expect(!strstr(text, " *\n") && !strstr(text, "\n*"), "without a mark there is no note");
    expect(!strstr(text, "disturbed"), "nothing is called disturbed that is not");
    table((const double[ROWS]){100, 30, 16, 9}, 1, text);
    expect(marked(text, "lanes 4", " disturbed"), "a disturbed row is marked");
    expect(!marked(text, "run-time", " disturbed"), "others are not");
    expect(strstr(text, "\ndisturbed: the least time did not come twice"), "a note says what that means");
    return EXIT_SUCCESS;
}
