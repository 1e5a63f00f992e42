/* qp.c - random quadratic programs for rbd_qp.h, each judged by its own conditions (tests/qp_problems.h).

   usage: qp --problems N | --seconds N [--seed N]     so many problems of each kind

   Prints a table. Fails if an answer with RBD_QP_OK is off by more than 1e-9 of its terms (float: 3e-3), or
   its gradient by more than 2e-9 of the cost's (float: 2e-4), a proof by more than 1e-9 (float: 3e-3), or a
   status is not one that the kind may have. Each failure is printed with its seed. */
#define RBD_IMPLEMENTATION
#include "rbd_qp.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "../qp_problems.h"

enum { CONTRADICTION = KINDS, WARM, ALL };

typedef struct tally {
    long problems, ok, infeasible, iterations, inaccurate, other, failures;
    double worst, steps;
    int most;
} tally;

/* After a solution: the same problem with other f and sides, from the rows that held. */
static rbd_qp_status solve_warm(rbd_qp_problem *p) {
    const rbd_qp_options warm = {0, 1, 0, 0};
    for (int i = 0; i < p->n; i++) f[i] += (rbd_real)(.1 * normal());
    for (int row = 0; row < p->bounds + p->rows; row++) {
        const rbd_real shift = (rbd_real)(.02 * fabs(normal()));
        if (lower[row] == upper[row]) continue;
        if (lower[row] > -NONE) lower[row] -= shift;
        if (upper[row] < NONE) upper[row] += shift;
    }
    return rbd_qp_solve(p, &warm, memory, sizeof memory, x, lambda, side, &result);
}

static void run(int of, uint64_t start, tally *t) {
    const double allowed = sizeof(rbd_real) == 4 ? 3e-3 : 1e-9;
    judgement worst = {0, "none", -1};
    rbd_qp_status status;
    rbd_qp_problem p;
    int failed = 0;

    seed = start;
    p = of == CONTRADICTION ? contradiction() : random_problem(of == WARM ? CONVEX : (kind)of);
    if (of == SCALED) scale(&p);
    status = solve(&p);
    if (of == WARM && status == RBD_QP_OK) status = solve_warm(&p);

    t->problems++;
    t->steps += result.steps;
    t->most = result.steps > t->most ? result.steps : t->most;
    t->ok += status == RBD_QP_OK;
    t->infeasible += status == RBD_QP_INFEASIBLE;
    t->iterations += status == RBD_QP_ITERATIONS;
    t->inaccurate += status == RBD_QP_INACCURATE;
    if (status == RBD_QP_OK) worst = judge_solution(&p);
    if (status == RBD_QP_INFEASIBLE) worst = judge_proof(&p);
    t->worst = larger(t->worst, worst.share);

    failed |= !(worst.share <= allowed);
    failed |= status == RBD_QP_OK && (of == CONTRADICTION || !(gradient_share(&p) <= 20 * RBDI_QP_ACCURACY));
    failed |= status == RBD_QP_INFEASIBLE && of != CONTRADICTION;
    failed |= status < RBD_QP_INACCURATE || status == RBD_QP_UNBOUNDED;
    failed |= sizeof(rbd_real) == 8 && status == RBD_QP_INACCURATE;
    for (int i = 0; i < p.n; i++) failed |= !(fabs((double)x[i]) < RBD_QP_NONE);
    if (!failed) return;
    t->failures++;
    printf("kind %d, --seed %llu: status %d, %s, at %d, is off by %g\n", of, (unsigned long long)start,
           status, worst.condition, worst.at, worst.share);
}

int main(int count, char **arguments) {
    static const char *const names[] = {"contradiction", "warm"};
    long problems = 1000, seconds = 0, failures = 0;
    uint64_t start = 1;
    static tally tallies[ALL];
    const time_t begin = time(NULL);

    for (int i = 1; i + 1 < count; i += 2) {
        if (!strcmp(arguments[i], "--problems")) problems = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seconds")) seconds = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seed")) start = strtoull(arguments[i + 1], NULL, 10);
    }
    for (long k = 0; seconds ? time(NULL) - begin < seconds : k < problems; k++)
        for (int of = 0; of < ALL; of++) run(of, start + (uint64_t)k * 1000003u, &tallies[of]);

    printf("%-14s %9s %9s %10s %10s %10s %9s %11s %10s\n", "kind", "problems", "OK", "INFEASIBLE",
           "ITERATIONS", "INACCURATE", "failures", "off by", "steps");
    for (int of = 0; of < ALL; of++) {
        const tally *t = &tallies[of];
        printf("%-14s %9ld %9ld %10ld %10ld %10ld %9ld %11.1e %6.1f %d\n",
               of < KINDS ? kind_names[of] : names[of - KINDS], t->problems, t->ok, t->infeasible,
               t->iterations, t->inaccurate, t->failures, t->worst, t->steps / (double)t->problems, t->most);
        failures += t->failures;
    }
    return failures > 0 || tallies[0].problems == 0;
}
