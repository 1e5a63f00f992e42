/* csv.h - tables of comma-separated values. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CSV_H
#define TOOLS_CSV_H

#include <stddef.h>
#include <stdio.h>

/* A reader; all zero to begin with, but what is not standard input. */
typedef struct csv {
    FILE *from;       /* NULL: standard input */
    const char *name; /* of that file */
    int line;         /* number of the row in cells, from 1 */
    char **cells;     /* of the row read last, without the spaces around them */
    int n, max;
    char *text; /* of the row; cells point into it */
    size_t room;
} csv;

/* Reads the next row that is not empty; ends of lines may be LF or CRLF, cells may be in
   quotes. Returns 1, 0 at the end, or -1 after a message. */
int csv_read(csv *c);
void csv_free(csv *c);

/* Prints a message with the row's number to standard error; returns -1. */
int csv_error(const csv *c, const char *format, ...);

/* The message for a header of one cell that has semicolons or tabs in place of commas; returns -1. */
int csv_separators(const csv *header);

/* Prints a cell, in quotes where it needs them; all but the first of a row with a comma before. */
void csv_print(const char *cell, int first);

#endif
