#ifndef RBDI_BASE_PIECES_H
#define RBDI_BASE_PIECES_H
#include "base/compiler.h"

/* ---- pieces [pieces] ----
   Pieces of a caller's memory, and of a sentence. */

/* Takes count objects of size bytes from the front of the memory. */
RBDI_PART void *rbdi_take(unsigned char **memory, int count, size_t size) {
    unsigned char *taken = *memory;
    *memory += (size_t)count * size;
    return taken;
}

/* Takes n objects from the memory at `at`, a variable of the caller. */
#define RBDI_CUT(type, n) ((type *)rbdi_take(&at, 1, RBDI_ROUND((size_t)(n) * sizeof(type))))

/* Writes n, which is not negative, into the end of `digits`; returns where it begins. */
RBDI_PART const char *rbdi_decimal(int n, char digits[12]) {
    int at = 11;

    digits[at] = 0;
    do {
        digits[--at] = (char)('0' + n % 10);
        n = n / 10;
    } while (n);
    return &digits[at];
}

/* Writes n pieces one behind the other, cut to fit in size bytes, always terminated. Returns text. */
RBDI_PART char *rbdi_join(const char *const *piece, int n, char *text, size_t size) {
    size_t at = 0;

    for (int k = 0; k < n; ++k)
        for (const char *c = piece[k]; *c && at + 1 < size; ++c) text[at++] = *c;
    text[at] = 0;
    return text;
}

#endif
