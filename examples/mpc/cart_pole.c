/* cart_pole.c - swing-up: from rest, with no force as the first guess, iterative LQR finds how a cart
   swings up the pole that hangs from it, with a motor too weak to push it up at once. SPDX-License-
   Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "check.h"

#include "swing_up.h"
#include "../larger.h"

#include <stdio.h>
#include <stdlib.h>

enum { NQ = CART_POLE_NQ, NV = SWING_UP_NV, NU = SWING_UP_NU, N = SWING_UP_N };

static ilqr s;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* Everything in static memory; from rest at the origin, hanging. */
static void prepare(void) {
    static unsigned char work_memory[CART_POLE_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(CART_POLE_NB, NV)];
    static double reals[ILQR_REALS(NQ, NV, NU, N)], dt[N];
    static swing_up x;
    static ilqr_problem p = {.m = &cart_pole_model,
                             .knots = N,
                             .nu = NU,
                             .dt = dt,
                             .lower = &swing_up_least,
                             .upper = &swing_up_most,
                             .user = &x,
                             .step = swing_up_step,
                             .derivatives = swing_up_derivatives,
                             .cost = swing_up_cost};
    const double q[NQ] = {0}, v[NV] = {0};
    for (int k = 0; k < N; k++) dt[k] = 0.02;
    x.p = &p;
    check(rbd_work_init(&cart_pole_model, work_memory, sizeof work_memory, &x.w));
    check(rbd_derivatives_init(&cart_pole_model, x.w, memory, sizeof memory, &x.d));
    check(ilqr_init(&s, &p, reals, sizeof reals / sizeof *reals));
    check(ilqr_start(&s, q, v));
}

/* Iterates until no better trajectory is found; returns the iterations, or -1 if the cost did not fall in
   each. */
static int converge(void) {
    int iterations = 0, better = 1, falling = 1;
    s.tolerance = 1e-6;
    printf("iteration  0: cost %8.2f\n", s.cost);
    while (better && iterations < 200) {
        const double before = s.cost;
        check(ilqr_iterate(&s, &better));
        falling = falling && (better ? s.cost < before : s.cost == before);
        iterations += better;
        if (better && iterations % 5 == 0) printf("iteration %2d: cost %8.2f\n", iterations, s.cost);
    }
    return better || !falling ? -1 : iterations;
}

int main(void) {
    static double scratch[2 * (NQ + 2 * NV + NU)];
    prepare();
    const int iterations = converge();
    const double *q = s.q + N * NQ, *v = s.v + N * NV, error = ilqr_derivative_error(&s, scratch);
    const double away =
        larger(larger(fabs(q[0]), fabs(q[1] - swing_up_angle)), larger(fabs(v[0]), fabs(v[1])));
    double most = 0;
    int limited = 0;
    for (int k = 0; k < N; k++) {
        most = larger(most, fabs(s.u[k]));
        limited += fabs(s.u[k]) >= swing_up_most;
    }
    printf("converged after %d iterations, the cost fell in each: %s\n", iterations,
           iterations > 0 ? "yes" : "no");
    printf("upright and still to %.3f; at the limit of %.0f N in %d of %d knots, never beyond: %s\n", away,
           swing_up_most, limited, N, most <= swing_up_most ? "yes" : "no");
    printf("derivatives agree with differences to 1e-6: %s\n", error < 1e-6 ? "yes" : "no");
    return iterations > 0 && away < 0.05 && most <= swing_up_most && error < 1e-6 ? EXIT_SUCCESS
                                                                                  : EXIT_FAILURE;
}
