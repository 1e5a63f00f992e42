/* least.h - the two least of several times: they tell an undisturbed time from a disturbed one.
   SPDX-License-Identifier: MIT */
#ifndef LEAST_H
#define LEAST_H

#include <math.h>
#include <stdbool.h>

/* A program can only be delayed, and delays differ: a least time that has come twice is what the machine
 * needs. */
struct least {
    double first, second;
};

#define LEAST_NONE ((struct least){HUGE_VAL, HUGE_VAL})

static inline void least_take(struct least *l, double time) {
    if (time < l->first) {
        l->second = l->first;
        l->first = time;
    } else if (time < l->second) {
        l->second = time;
    }
}

/* Whether the least time has come twice, to 3 %. */
static inline bool least_repeats(struct least l) { return l.second <= 1.03 * l.first; }

#endif
