/* nearest.h - the name that a mistyped one may stand for. SPDX-License-Identifier: MIT */
#ifndef TOOLS_NEAREST_H
#define TOOLS_NEAREST_H

#include <stddef.h>

/* The best of the names seen so far. */
typedef struct nearest {
    const char *name; /* that is missing */
    size_t least;     /* how many characters the best differs by */
    char best[100];   /* "" if there is none */
} nearest;

nearest nearest_to(const char *name);

/* Compares one that is there: its first `length` characters. */
void nearest_see(nearest *n, const char *known, size_t length);

/* The same, and its beginnings up to each '_', which count as one character further away. */
void nearest_see_words(nearest *n, const char *known, size_t length);

/* All options "  --NAME" of a help text: those that begin with the name come near, too. */
void nearest_see_options(nearest *n, const char *help);

/* "; did you mean 'BEST'?", or "" if nothing comes near, in text. */
const char *nearest_hint(const nearest *n, char text[140]);

#endif
