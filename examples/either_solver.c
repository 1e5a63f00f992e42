/* either_solver.c - rbd_qp.h and DAQP (github.com/darnstrom/daqp) take the same arrays, so that a program may
   have either by a few lines: with -DDAQP and that library, this one solves its problem by both. Three
   springs in a row are pushed against a wall.

   cc -std=c99 -O2 -I.. either_solver.c -o either_solver -lm
   cc -std=c99 -O2 -I.. -DDAQP either_solver.c -o either_solver -ldaqp -lm */
#define RBD_IMPLEMENTATION
#include "rbd_qp.h"
#include "larger.h"

#ifdef DAQP
#include <daqp/api.h>
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 3, BOUNDS = 3, ROWS = 2, SIDES = BOUNDS + ROWS };

/* Places of three masses; x2 is behind x1, and x1 + x3 is held. */
static double H[N * N] = {2, -1, 0, -1, 2, -1, 0, -1, 1};
static double f[N] = {-1, 0, -3};
static double C[ROWS * N] = {-1, 1, 0, 1, 0, 1};
static double lower[SIDES] = {0, 0, 0, 0.25, 4};
static double upper[SIDES] = {2, 2, 2.5, RBD_QP_NONE, 4};

static int by_rbd(double *x, double *lambda) {
    static unsigned char memory[RBD_QP_SIZE(N, BOUNDS, ROWS, 0)];
    const rbd_qp_problem p = {
        .n = N, .bounds = BOUNDS, .rows = ROWS, .H = H, .f = f, .C = C, .lower = lower, .upper = upper};
    signed char side[SIDES];
    return rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, side, NULL) == RBD_QP_OK;
}

#ifdef DAQP
static int by_daqp(double *x, double *lambda) {
    int sense[SIDES] = {0}; /* an equality is active, and stays so */
    DAQPProblem p = {0};
    DAQPResult result = {0};

    for (int row = 0; row < SIDES; row++) sense[row] = lower[row] == upper[row] ? 1 + 4 : 0;
    p.n = N;
    p.m = SIDES;
    p.ms = BOUNDS;
    p.H = H;
    p.f = f;
    p.A = C;
    p.bupper = upper;
    p.blower = lower;
    p.sense = sense;
    result.x = x;
    result.lam = lambda;
    daqp_quadprog(&result, &p, NULL);
    return result.exitflag == 1;
}
#endif

int main(void) {
    double x[N], lambda[SIDES];
    if (!by_rbd(x, lambda)) return EXIT_FAILURE;
    printf("rbd_qp: x = (%.3f, %.3f, %.3f), the wall pushes with %.3f\n", x[0], x[1], x[2], lambda[2]);

#ifdef DAQP
    double other[N], other_lambda[SIDES], apart = 0;
    if (!by_daqp(other, other_lambda)) return EXIT_FAILURE;
    for (int i = 0; i < N; i++) apart = larger(apart, fabs(x[i] - other[i]));
    for (int row = 0; row < SIDES; row++) apart = larger(apart, fabs(lambda[row] - other_lambda[row]));
    printf("DAQP: the same, %s\n", apart < 1e-9 ? "to 1e-9" : "but not to 1e-9");
    if (!(apart < 1e-9)) return EXIT_FAILURE;
#endif
    return EXIT_SUCCESS;
}
