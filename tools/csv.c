/* Tables of comma-separated values. SPDX-License-Identifier: MIT */
#include "csv.h"
#include "robot.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int csv_error(const csv *c, const char *format, ...) {
    va_list arguments;
    fprintf(stderr, "%s: %s%srow %d: ", program, c->name ? c->name : "", c->name ? ": " : "", c->line);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\n");
    return -1;
}

int csv_separators(const csv *header) {
    return csv_error(header, "it has %s and no commas: cells are parted by commas, numbers have points",
                     strchr(header->cells[0], ';') ? "semicolons" : "tabs");
}

/* Reads a line into text, without its end. Returns 1, 0 at the end of the input, or -1 after a message. */
static int read_line(csv *c) {
    size_t length = 0;
    FILE *const from = c->from ? c->from : stdin;
    int character;
    for (;;) {
        if (length + 1 >= c->room) c->text = grown(c->text, c->room = 2 * c->room + 1000);
        character = getc(from);
        if (character == EOF || character == '\n') break;
        c->text[length++] = (char)character;
    }
    c->line++;
    c->text[length] = 0;
    if (ferror(from)) return csv_error(c, "it cannot be read: %s", strerror(errno));
    if (strlen(c->text) != length)
        return csv_error(c, "it has a zero byte%s",
                         c->line == 1 ? "; a text in UTF-16 must be saved as UTF-8" : "");
    return character != EOF || length > 0;
}

static char *trimmed(char *start, char *end) {
    while (start < end && strchr(" \t\r", *start)) start++;
    while (end > start && strchr(" \t\r", end[-1])) end--;
    *end = 0;
    return start;
}

/* Takes the cell that begins at p out of the text; *next is where the next one begins, NULL after the last.
 */
static char *take_cell(csv *c, char *p, char **next) {
    char *end;
    p += strspn(p, " \t");
    if (*p != '"') {
        end = p + strcspn(p, ",");
        *next = *end ? end + 1 : NULL;
        return trimmed(p, end);
    }
    char *to = end = ++p;
    for (; *end && (*end != '"' || end[1] == '"'); end++) {
        end += *end == '"'; /* two stand for one */
        *to++ = *end;
    }
    if (!*end) {
        csv_error(c, "a quote is not closed");
        return NULL;
    }
    end += 1 + strspn(end + 1, " \t\r");
    if (*end && *end != ',') {
        csv_error(c, "something follows a closing quote");
        return NULL;
    }
    *next = *end ? end + 1 : NULL;
    *to = 0;
    return p;
}

int csv_read(csv *c) {
    char *next;
    do {
        const int status = read_line(c);
        if (status <= 0) return status;
        next = c->text;
        if (c->line == 1 && strncmp(next, "\xef\xbb\xbf", 3) == 0) next += 3;
    } while (next[strspn(next, " \t\r")] == 0);
    for (c->n = 0; next; c->n++) {
        if (c->n == c->max)
            c->cells = grown(c->cells, (size_t)(c->max = 2 * c->max + 100) * sizeof *c->cells);
        c->cells[c->n] = take_cell(c, next, &next);
        if (!c->cells[c->n]) return -1;
    }
    return 1;
}

void csv_free(csv *c) {
    free(c->cells);
    free(c->text);
}

void csv_print(const char *cell, int first) {
    if (!first) putchar(',');
    if (!cell[strcspn(cell, ",\"")]) {
        fputs(cell, stdout);
        return;
    }
    putchar('"');
    for (; *cell; cell++) {
        if (*cell == '"') putchar('"');
        putchar(*cell);
    }
    putchar('"');
}
