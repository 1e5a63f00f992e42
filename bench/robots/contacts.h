/* contacts.h - which bodies the constrained dynamics of the bench hold to the world, by name: rbd's own and
   that of other libraries. SPDX-License-Identifier: MIT */
#ifndef BENCH_CONTACTS_H
#define BENCH_CONTACTS_H

#include <stddef.h>
#include <string.h>
#include "../calls/library.h"

/* A point of a body, held by its position (3 rows) or, flat, with its surface (6). */
struct contact {
    const char *body;
    double point[3]; /* body axes */
    int flat;
};

struct contact_set {
    int algorithm, count, rows;
    struct contact contacts[4];
};

/* HyQ on its feet; Atlas on its feet, and with a hand. */
static const struct contact_set contact_sets[] = {
    {CONSTRAINED,
     4,
     12,
     {{"lf_lowerleg", {0.33, 0, 0}, 0},
      {"rf_lowerleg", {0.33, 0, 0}, 0},
      {"lh_lowerleg", {0.33, 0, 0}, 0},
      {"rh_lowerleg", {0.33, 0, 0}, 0}}},
    {CONSTRAINED, 2, 12, {{"l_foot", {0.05, 0, -0.08}, 1}, {"r_foot", {0.05, 0, -0.08}, 1}}},
    {CONSTRAINED_HAND,
     3,
     15,
     {{"l_foot", {0.05, 0, -0.08}, 1}, {"r_foot", {0.05, 0, -0.08}, 1}, {"l_hand", {0, 0, 0}, 0}}},
};

static inline int contact_body(const rbd_body *bodies, int nb, const char *name) {
    for (int i = 0; i < nb; i++)
        if (bodies[i].name && strcmp(bodies[i].name, name) == 0) return i;
    return -1;
}

/* The set of the algorithm whose bodies the robot all has, or NULL; a fixed base does not stand on feet. */
static inline const struct contact_set *contact_set_of(const rbd_body *bodies, int nb, int algorithm) {
    for (size_t k = 0; k < sizeof contact_sets / sizeof *contact_sets; k++) {
        const struct contact_set *s = &contact_sets[k];
        int found = s->algorithm == algorithm && nb > 0 && bodies[0].type == RBD_FLOATING;
        for (int i = 0; i < s->count; i++)
            found = found && contact_body(bodies, nb, s->contacts[i].body) >= 0;
        if (found) return s;
    }
    return NULL;
}

#endif
