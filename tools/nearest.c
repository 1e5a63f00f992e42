/* nearest.c - see nearest.h; rbd_urdf.h has the same rule. SPDX-License-Identifier: MIT */
#include "nearest.h"
#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST = 99 }; /* the time goes with the square */

nearest nearest_to(const char *name) {
    nearest n = {name, strlen(name) / 3 + 1, ""};
    return n;
}

static int alike(char a, char b) { return tolower((unsigned char)a) == tolower((unsigned char)b); }

/* How many characters must be put in, left out, changed, or swapped with the next one, to make one of the
   other (Damerau, Levenshtein; no character twice); upper and lower case are the same. */
static size_t difference(const char *a, const char *b, size_t length) {
    size_t rows[3][LONGEST + 1], *before = rows[0], *last = rows[1], *row = rows[2];
    for (size_t k = 0; k <= length; k++) row[k] = k;
    for (size_t i = 1; a[i - 1]; i++) {
        size_t *free_row = before;
        before = last;
        last = row;
        row = free_row;
        row[0] = i;
        for (size_t k = 1; k <= length; k++) {
            const size_t changed = last[k - 1] + !alike(a[i - 1], b[k - 1]);
            const size_t shorter = last[k] < row[k - 1] ? last[k] : row[k - 1];
            const int swapped = i > 1 && k > 1 && alike(a[i - 1], b[k - 2]) && alike(a[i - 2], b[k - 1]);
            row[k] = changed < shorter + 1 ? changed : shorter + 1;
            if (swapped && before[k - 2] + 1 < row[k]) row[k] = before[k - 2] + 1;
        }
    }
    return row[length];
}

static void take(nearest *n, const char *known, size_t length, size_t d) {
    if (d >= n->least) return;
    n->least = d;
    memcpy(n->best, known, length);
    n->best[length] = 0;
}

void nearest_see(nearest *n, const char *known, size_t length) {
    if (length <= LONGEST && strlen(n->name) <= LONGEST)
        take(n, known, length, difference(n->name, known, length));
}

void nearest_see_words(nearest *n, const char *known, size_t length) {
    nearest_see(n, known, length);
    if (length > LONGEST || strlen(n->name) > LONGEST) return;
    for (size_t k = 1; k < length; k++)
        if (known[k] == '_') take(n, known, length, 1 + difference(n->name, known, k));
}

void nearest_see_options(nearest *n, const char *help) {
    const size_t given = strlen(n->name);
    while ((help = strstr(help, "  --")) != NULL) {
        const size_t length = strcspn(help += 4, " ,\n");
        if (given >= 3 && given < length && strncmp(n->name, help, given) == 0) take(n, help, length, 1);
        nearest_see(n, help, length);
    }
}

const char *nearest_hint(const nearest *n, char text[140]) {
    text[0] = 0;
    if (*n->best) snprintf(text, 140, "; did you mean '%s'?", n->best);
    return text;
}
