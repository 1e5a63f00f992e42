/* test_larger.c - larger.h: the larger of two numbers, and NaN, wherever it comes, stays infinite. */
#include "larger.h"

#include <stdio.h>

static int failures;

static void expect(const char *what, double found, double expected) {
    if (found <= expected && found >= expected) return;
    failures++;
    printf("%s: %g, not %g\n", what, found, expected);
}

/* The largest of n numbers, as tests keep it. */
static double largest_of(const double *x, int n) {
    double largest = 0;
    for (int i = 0; i < n; i++) largest = larger(largest, x[i]);
    return largest;
}

int main(void) {
    expect("the second is larger", larger(1, 2), 2);
    expect("the first is larger", larger(2, 1), 2);
    expect("both are negative", larger(-2, -1), -1);
    expect("both are the same", larger(3, 3), 3);
    expect("the second is infinite", larger(1, HUGE_VAL), HUGE_VAL);
    expect("the first is infinite", larger(HUGE_VAL, 1), HUGE_VAL);
    expect("both are infinite", larger(HUGE_VAL, HUGE_VAL), HUGE_VAL);
    expect("the first is minus infinity", larger(-HUGE_VAL, 1), 1);

    expect("the second is NaN", larger(1, NAN), HUGE_VAL);
    expect("the first is NaN", larger(NAN, 1), HUGE_VAL);
    expect("both are NaN", larger(NAN, NAN), HUGE_VAL);
    expect("NaN and infinity", larger(NAN, -HUGE_VAL), HUGE_VAL);

    for (int at = 0; at < 3; at++) {
        double x[3] = {0.25, 0.5, 0.125};
        expect("the largest of three", largest_of(x, 3), 0.5);
        x[at] = NAN;
        expect("the largest of three, one of which is NaN", largest_of(x, 3), HUGE_VAL);
    }
    return failures > 0;
}
